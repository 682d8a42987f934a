"""The plan of a sweep: what it is named by, what it sends to workers, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest
from bad_values import refused

from symosc import load_scene
from symosc.sweeps import motions
from symosc.sweeps.grid import read_grid
from symosc.sweeps.plan import SweepPlan, read_duration, read_plan, read_record

FIG9 = load_scene("fig9")


def planned(scene: Any = FIG9, over: Any = None, **options: Any) -> SweepPlan:
    grid = read_grid(scene, over or {"FN": [1, 2], "Omega": "3:4:3"}, options.pop("starts", None))
    return read_plan(scene, grid, *({"record": "word", "t_end": "9T", "skip": 0} | options).values())


def test_the_name_is_that_of_the_content() -> None:
    same = [planned(), planned(over={"FN": ["1", 2.0], "Omega": [3, 3.5, 4]}), planned(t_end=" 9 T"), planned(skip="0")]
    same += [planned(replace(FIG9, name="mine", t_end=1000, source="another"))]
    assert len({plan.key for plan in same}) == 1
    others = [
        planned(over={"FN": [1, 3], "Omega": "3:4:3"}),
        planned(over={"Omega": "3:4:3", "FN": [1, 2]}),
        planned(over={"FN": [2, 1], "Omega": "3:4:3"}),
        planned(over={"FN": [1, 2], "k": "3:4:3"}),
        planned(starts=[(0, 0, 0), (0, 1, 0)]),
        planned(replace(FIG9, x0="4.5448")),
        planned(replace(FIG9, parameters=FIG9.parameters.replace(k="3.0000000000000000001"))),
        planned(replace(FIG9, start_error="1e-9")),
        planned(record=("word", "events")),
        planned(record="section:3"),
        planned(record="section:4"),
        planned(t_end=9),
        planned(t_end="9.5T"),
        planned(skip="1T"),
        planned(skip=1),
    ]
    keys = {plan.key for plan in [same[0], *others]}
    assert len(keys) == len(others) + 1


def test_changed_sources_and_versions_make_another_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    before = planned().key
    monkeypatch.setattr("symosc.sweeps.plan.kernels_hash", lambda: "another")
    changed = planned().key
    monkeypatch.setattr("symosc.__version__", "99")
    assert len({before, changed, planned().key}) == 3


def test_the_hash_of_the_sources_sees_the_engine_and_the_kernels() -> None:
    assert motions.kernels_hash() == motions.kernels_hash.__wrapped__()
    assert {"engine", "kernels", "simulation"} <= {*motions.DECISIVE}


def test_what_is_sent_has_the_exact_scene_and_the_cells() -> None:
    share = planned(t_end="9T", skip="4T").share(2, 5)
    assert share.motions == 3
    assert share.columns["k"] == FIG9.parameters.k
    assert share.columns["FN"].tolist() == [1, 2, 2]
    assert share.columns["Omega"].tolist() == [4, 3, 3.5]
    assert share.starts == (FIG9.t0, FIG9.x0, FIG9.v0)
    period = 2 * pi / np.array([4, 3, 3.5])
    assert share.t_end == pytest.approx(float(FIG9.t0) + 9 * period, rel=1e-15)
    assert share.skip == pytest.approx(4 * period, rel=1e-15)
    assert planned(t_end="1/3", skip="0.1").share(0, 1).t_end == planned(t_end="1/3").t_end.value


@pytest.mark.parametrize(
    ("given", "text"), [(9, "9"), ("9T", "9T"), (" 1.5 T ", "1.5T"), ("1/3T", "1/3T"), ("1e1", "10")]
)
def test_times_are_numbers_or_periods(given: Any, text: str) -> None:
    assert str(read_duration("t_end", given)) == text


@pytest.mark.parametrize("given", ["T", "xT", "-1T", "9 periods", "", None, [], "1e12T", "nanT", True])
def test_what_is_no_time(given: Any) -> None:
    refused(lambda: read_duration("t_end", given), "t_end")


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"t_end": "0T"}, "t_end"),
        ({"t_end": 0}, "t_end"),
        ({"t_end": FIG9.t0}, "t_end"),
        ({"over": {"t0": [0, 11]}, "t_end": 10}, "t_end"),
        ({"skip": -1}, "skip"),
        ({"skip": "9T"}, "skip"),
        ({"skip": 100}, "skip"),
        ({"skip": "4T", "t_end": 8}, "skip"),  # Omega = 3 has not ended its fourth period then
        ({"record": ()}, "record"),
        ({"record": "words"}, "record"),
        ({"record": ("word", "word")}, "record"),
        ({"record": ("section:2", "section:3")}, "record"),
        ({"record": "word:3"}, "record"),
        ({"record": "section:0"}, "section"),
        ({"record": "section:"}, "section"),
        ({"record": "section:x"}, "section"),
    ],
)
def test_what_is_refused(options: Any, name: str) -> None:
    refused(lambda: planned(**options), name)


def test_a_section_has_a_number_of_points() -> None:
    assert read_record("section:64") == (("section",), 64)
    assert read_record(["x", "section"])[1] > 1
    assert read_record("word") == (("word",), 0)
