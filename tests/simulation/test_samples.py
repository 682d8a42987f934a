"""MotionSamples of a motion: its closed form, the ends of its times, and what reads the table."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused

from symosc import OtherModel, Parameters, crosscheck, simulate

#: Free and without friction: x = cos t, v = -sin t, which meets both belts.
FREE = Parameters(m=1, c=0, k=1, A0=0, B0=0, Omega=1, v1="-1/2", v2="3/4", mu1=0, mu2=0, FN=1)
#: The base moves by cos(3t/2), and the belts are joined to it.
MOVED = OtherModel(m=1, k=1, Omega="3/2", FN="1/2", Y=1, joined=True)


def mode_of(v: float) -> str:
    """Return the domain of a velocity between the belts of FREE."""
    return f"Omega{1 + (v > -0.5) + (v > 0.75)}"


@pytest.mark.parametrize("digits", [None, 20])
def test_samples_are_those_of_the_closed_form(digits: int | None) -> None:
    samples = simulate(FREE, x0=1, t_end=9, digits=digits).samples(200)
    t = np.arange(200) * 9 / 199
    assert samples.t == pytest.approx(t, abs=1e-14)
    assert (samples.t[0], samples.t[-1]) == (0, 9)
    assert samples.x == pytest.approx(np.cos(t), abs=1e-13)
    assert samples.v == pytest.approx(-np.sin(t), abs=1e-13)
    assert samples.mode.tolist() == [mode_of(-np.sin(time)) for time in t.tolist()]


def test_times_are_taken_as_they_are_given() -> None:
    samples = simulate(FREE, x0=1, t_end=9).samples([8, "1/2", 8])
    assert samples.t.tolist() == [8, 0.5, 8]
    assert samples.x == pytest.approx(np.cos([8, 0.5, 8]), abs=1e-13)
    assert len(simulate(FREE, x0=1, t_end=9).samples(np.array(5))) == 5


def test_the_last_sample_is_at_the_end_though_the_start_is_far() -> None:
    motion = simulate(FREE, x0=1, t0="1e7", t_end="10000000.7")
    assert motion.samples(7).t[[0, -1]].tolist() == [1e7, 10000000.7]


def test_samples_of_another_model_are_in_its_coordinates() -> None:
    motion = simulate(MOVED, t_end=8)
    samples = motion.samples(50)
    x, v = motion(np.linspace(0, 8, 50))
    assert (samples.x.tolist(), samples.v.tolist()) == (x.tolist(), v.tolist())
    assert samples.mode.tolist() == motion.mode(samples.t).tolist()


def test_the_table_is_written_and_read(tmp_path: Path) -> None:
    samples = simulate("fig5", t_end=5).samples(300)
    samples.to_csv(tmp_path / "motion.csv")
    with (tmp_path / "motion.csv").open(encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header == ["t", "x", "v", "mode"] == list(samples.to_pandas())
    t, x, v, mode = zip(*rows, strict=True)
    for column, texts in {"t": t, "x": x, "v": v}.items():
        assert samples.columns()[column].tolist() == list(map(float, texts))
    assert samples.to_pandas()["mode"].tolist() == list(mode) == samples.mode.tolist()
    assert samples.to_xarray().x.sel(t=5.0).item() == samples.x[-1]
    assert samples == simulate("fig5", t_end=5).samples(300)
    assert samples != simulate("fig5", t_end=5).samples(299)
    assert repr(samples) == "<MotionSamples: 300 times from t = 0 to 5>"
    empty = simulate("fig5", t_end=5).samples([])
    assert (repr(empty), len(empty.to_pandas())) == ("<MotionSamples: none>", 0)


def test_samples_are_a_solution_that_is_checked() -> None:
    samples = simulate("fig5", t_end=5).samples(300)
    assert crosscheck("fig5", samples, partial=True).ok
    assert not crosscheck("fig6", samples, partial=True).ok


@pytest.mark.parametrize(
    ("times", "name"),
    [
        (1, "times"),
        (10**9, "times"),
        (2.5, "times"),
        ("5", "times"),
        (True, "times"),
        ([[0, 1]], "times"),
        ([None], "times"),
        ([6], "t"),
        ([np.nan], "t"),
    ],
)
def test_what_is_neither_a_count_nor_times(times: Any, name: str) -> None:
    refused(lambda: simulate("fig5", t_end=5).samples(times), name)
