"""Work and precision: rows for every solver and tolerance, their tables, summary and picture."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from bench_work import FAKES, rows

from symosc import load_scene, simulate
from symosc.bench import plot_work, work_precision, work_table
from symosc.bench.ours import SOLVERS as OURS
from symosc.bench.peers import SOLVERS
from symosc.bench.time_limit import HANG
from symosc.plot.drawing import save

EXACT = simulate("fig5", digits=40).events


def test_a_span_ends_between_two_events() -> None:
    span = work_precision.span(load_scene("fig9"), 5, 3)
    events = simulate("fig9").events
    assert [float(event.t) for event in span.reference] == [pytest.approx(event.t) for event in events[:3]]
    assert events[2].t < span.until < events[3].t
    assert events[4].t < span.scene.t_end < events[5].t


@pytest.mark.slow
def test_our_row_has_times_and_errors(work: dict[str, Any]) -> None:
    _, row = rows(work, OURS[0].name, "fig5")  # the finer accuracy
    if row["failure"].startswith("exception: MissingExtraError"):
        pytest.skip("needs numba")
    assert (row["failure"], row["missed"], row["invented"], row["compared"]) == ("", 0, 0, 9)
    assert row["error"] < 1e-14
    assert row["over_ours"] == 1
    assert row["floor_ns"] >= work["floor_ns"] > 1
    assert 0 < row["over_floor"] <= 1e9 * max(row["times_s"]) / row["timed_events"] / row["floor_ns"] * (1 + 1e-12)


@pytest.mark.slow
def test_times_and_ratios_of_a_table_agree(work: dict[str, Any]) -> None:
    """Whatever the pace of the machine was when each was measured: 17 times our microseconds is not 11 times ours."""
    ours = {row["scene"]: row for row in work["rows"] if row["solver"] == OURS[0].name}
    timed = [row for row in work["rows"] if row["over_ours"]]
    assert len(timed) > 6
    for row in timed:
        quotient = row["us_per_event"] / ours[row["scene"]]["us_per_event"]
        assert row["over_ours"] == pytest.approx(quotient, rel=1e-12)


@pytest.mark.slow
def test_a_missed_event_is_in_the_row(work: dict[str, Any]) -> None:
    coarse, row = rows(work, "careless", "fig5")
    assert coarse["error_t"] == pytest.approx(1e-3, rel=1e-3)
    assert (row["tolerance"], row["failure"]) == (1e-6, "")
    assert (row["missed"], row["invented"], row["compared"], row["timed_events"]) == (1, 0, 9, 12)
    assert row["first_wrong"] == pytest.approx(float(EXACT[1].t))
    assert row["error_t"] == pytest.approx(1e-6, rel=1e-3)
    assert 1 <= len(row["times_s"]) <= work_precision.MOST_REPEATS


@pytest.mark.slow
def test_failures_are_rows(work: dict[str, Any]) -> None:
    for scene in ("fig5", "fig9"):
        (row,) = rows(work, "hanging", scene)
        assert (row["failure"], row["us_per_event"], row["missed"]) == (HANG, None, None)
    (row,) = rows(work, "failing later", "fig5")
    assert row["failure"] == "exception: ArithmeticError: too far (in 12 events, not in 6)"
    assert (row["missed"], row["compared"]) == (6, 6)
    assert list(work["skipped"]) == ["absent"]
    assert "no_such_module" in work["skipped"]["absent"]
    assert work["notes"] == {"careless": "looks away"}
    assert json.loads(json.dumps(work)) == work


@pytest.mark.slow
def test_quick_takes_the_finest_tolerance_and_no_raw_peers() -> None:
    result = work_precision.run(quick=True, solvers=FAKES[1:3], scenes={"fig9": (5, 5, 5)})
    assert [(row["solver"], row["tolerance"], row["over_ours"]) for row in result["rows"]] == [("careless", 1e-6, None)]


@pytest.mark.slow
@pytest.mark.parametrize("markdown", [False, True])
def test_the_table_shows_all_rows(work: dict[str, Any], markdown: bool) -> None:
    text = work_table.table(work, markdown)
    assert text.count("hang: more than 600 s") == 2
    assert "too far (in 12 events, not in 6)" in text
    assert "absent: skipped, no_such_module is not installed" in text
    lines = [line.replace("|", " ").split() for line in text.splitlines()]
    assert [line[-3:] for line in lines if line[:1] == ["careless"]] == [["9", "1", "0"]] * 2 + [["5", "1", "0"]] * 2
    assert sum(line[:1] == ["careless,"] for line in lines) == 2


@pytest.mark.slow
def test_the_summary_shows_each_solver_at_its_best(work: dict[str, Any]) -> None:
    changed = {**work, "rows": [dict(row) for row in work["rows"]]}
    exact = rows(changed, "careless", "fig5")[1]
    coarse = {**exact, "tolerance": 1e-3, "error": 1e-3, "missed": 3}
    changed["rows"] += [coarse, {**coarse, "missed": None, "invented": None, "us_per_event": None, "failure": HANG}]
    assert work_table.best_rows(changed)["careless", "fig5"] is exact
    text = work_table.summary(changed)
    line = next(line for line in text.splitlines() if line.startswith("| careless "))
    assert "missed 1" in line
    assert "missed 3" not in line
    assert "| hang" in next(line for line in text.splitlines() if line.startswith("| hanging "))


@pytest.mark.slow
def test_the_picture_marks_what_was_missed(work: dict[str, Any], tmp_path: Path) -> None:
    drawing = plot_work.figure(json.loads(json.dumps(work)))
    panel = drawing.axes[0]
    assert panel.get_title(loc="left") == "fig5"
    crosses = [point for line in panel.lines if line.get_marker() == "x" for point in line.get_xydata().tolist()]
    wrong = [row for row in work["rows"] if row["scene"] == "fig5" and row["missed"]]
    assert sorted(x for x, _ in crosses) == sorted(row["us_per_event"] for row in wrong)
    hollow = {line.get_markerfacecolor() for line in panel.lines if len(line.get_xdata()) and line.get_marker() != "x"}
    assert "white" in hollow
    assert [text.get_text() for text in panel.texts] == ["2 runs failed"]
    labels = [text.get_text() for text in drawing.axes[-1].get_legend().get_texts()]
    assert "careless" in labels
    assert "careless, raw" not in labels
    assert save(drawing, tmp_path / "work.svg").stat().st_size > 1000


def test_all_solvers_have_names_and_tolerances_of_their_own() -> None:
    names = [solver.name for solver in SOLVERS]
    assert len(set(names)) == len(names)
    assert work_precision.OURS is SOLVERS[0]
    assert names[:2] == [solver.name for solver in OURS]
    for solver in SOLVERS:
        assert list(solver.tolerances) == sorted(solver.tolerances, reverse=True), solver.name
        assert solver.raw == solver.name.endswith(plot_work.RAW), solver.name
        assert not solver.raw or solver.name.removesuffix(plot_work.RAW) in names
