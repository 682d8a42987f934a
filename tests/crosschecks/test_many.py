"""Several solutions at once."""

from __future__ import annotations

from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck
from solution_files import COLUMNS, T, V, X

from symosc import MissingExtraError, ParameterError
from symosc.crosschecks import many
from symosc.crosschecks.many import RESULT_COLUMNS, CrossChecks
from symosc.display import frames

WRONG = {**COLUMNS, "v": V + 0.1 * (T > 2)}
THREE = [COLUMNS, WRONG, np.column_stack([T, X])]


@pytest.mark.slow
def test_a_list_of_results_with_a_summary() -> None:
    calls: list[tuple[int, int]] = []
    checks = crosscheck("fig9", THREE, progress=lambda *numbers: calls.append(numbers))
    assert isinstance(checks, list)
    assert [check.ok for check in checks] == [True, False, True]
    assert not checks.ok
    assert calls == [(1, 3), (2, 3), (3, 3)]
    assert repr(checks) == "<CrossChecks of 3 solutions: 2 ok, 1 failed>"
    assert checks.summary().startswith("FAILED: 3 solutions, 1 failed\n")
    assert f"\n1: {len(checks[1].wrong_steps)} wrong steps" in checks.summary()
    assert "velocities were not given" in checks.summary()
    assert [each["name"] for each in checks.as_dict()["checks"]] == ["0", "1", "2"]
    alone = crosscheck("fig9", WRONG)
    assert checks[1] == alone


def test_results_as_tables() -> None:
    checks = crosscheck("fig9", THREE)
    frame = checks.to_pandas()
    assert list(frame.columns) == ["solution", *RESULT_COLUMNS]
    assert frame["ok"].tolist() == [True, False, True]
    assert frame["max_error_v"].tolist() == [check.max_error_v for check in checks]
    assert frame["wrong_steps"].tolist() == [len(check.wrong_steps) for check in checks]
    assert frame["reason"].tolist()[0] == ""
    data = checks.to_xarray()
    assert dict(data.sizes) == {"solution": 3}
    assert data["samples"].sel(solution="1").item() == 60
    assert data["first_wrong_t"].isnull().values.tolist() == [True, False, True]


def test_tables_need_their_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    def none_of(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(frames, "import_module", none_of)
    checks = CrossChecks([crosscheck("fig9", COLUMNS)], ["0"])
    for call in (checks.to_pandas, checks.to_xarray):
        with pytest.raises(MissingExtraError):
            call()


@pytest.mark.slow
def test_processes_find_the_same() -> None:
    calls: list[tuple[int, int]] = []
    checks = crosscheck("fig9", THREE, workers=2, progress=lambda *numbers: calls.append(numbers))
    assert list(checks) == list(crosscheck("fig9", THREE))
    assert calls == [(1, 3), (2, 3), (3, 3)]
    sparse = [COLUMNS, {"t": [0.2, 2.9], "x": [1.0, 2.0]}]
    for workers in (1, 2):
        with pytest.raises(ParameterError, match=r"too far apart to tell it: give velocities \(solution 1\)"):
            crosscheck("fig9", sparse, workers=workers)


def test_arguments() -> None:
    for options in ({"workers": 0}, {"workers": "two"}, {"progress": 5}, {"events": [(1.0, "cross")]}):
        with pytest.raises(ParameterError):
            crosscheck("fig9", THREE, **options)
    with pytest.raises(ParameterError, match="workers"):  # one solution has no use for them
        crosscheck("fig9", COLUMNS, workers=0)


def test_a_row_says_what_its_check_says() -> None:
    checks = crosscheck("fig9", THREE)
    rows = zip(*(checks.columns()[name] for name in ("solution", *RESULT_COLUMNS)), strict=True)
    for i, (row, check) in enumerate(zip(rows, checks, strict=True)):
        fault = check.first_wrong
        found = dict(zip(("solution", *RESULT_COLUMNS), row, strict=True))
        expected = {name: getattr(check, name) for name in ("ok", "max_error_x", "max_error_v", "compared_until")}
        expected |= {"solution": str(i), "samples": len(check.t), "t_first": min(check.t), "t_last": max(check.t)}
        expected |= {f"max_defect_{name}": max(abs(check.defects[:, k])) for k, name in enumerate("xv")}
        expected |= {name: len(getattr(check, name)) for name in ("matched", "missed", "invented", "unresolved")}
        expected |= {"wrong_steps": len(check.wrong_steps), "reason": fault.reason if fault else ""}
        first = found.pop("first_wrong_t")
        assert found == expected
        assert (first == fault.t) if fault else np.isnan(first)
    assert len({len(check.t) for check in checks} | {len(check.matched) for check in checks}) > 1


def test_progress_begins_with_nothing_done(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def reporting(*what: Any) -> Any:
        asked.append(what)
        return nullcontext(lambda *numbers: asked.append(numbers))

    monkeypatch.setattr(many, "reporting", reporting)
    crosscheck("fig9", [COLUMNS, COLUMNS])
    assert asked == [(False, 0, 2, "check", "solutions"), (1, 2), (2, 2)]
