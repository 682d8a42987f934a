"""Benchmarks: how events are compared, how calls are bounded, and that nothing a solver does wrong is dropped."""

from __future__ import annotations

import json
import os
import random
import time
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from bench_fakes import careless, fail, failing_later, hanging, loop_for_ever, talk

from symosc import load_scene, simulate
from symosc.bench import plot_work, results, speed, work_precision, work_table
from symosc.bench.compare import FAR_MATCH, Comparison, _align, compare, window_of
from symosc.bench.ours import SOLVERS as OURS
from symosc.bench.peers import SOLVERS
from symosc.bench.solvers import FoundEvents, Solver
from symosc.bench.time_limit import HANG, Worker
from symosc.errors import OutputError
from symosc.machine import machine, sentence
from symosc.plot.figures import save

EXACT = simulate("fig5", digits=40).events
RIGHT = [FoundEvents(float(event.t), float(event.x), event.kind, event.boundary) for event in EXACT]
WINDOW = window_of(load_scene("fig5"))


# --- comparison ---


def moved(event: FoundEvents, by: float) -> FoundEvents:
    return event._replace(t=event.t + by)


def test_the_right_events_are_right() -> None:
    result = compare(RIGHT, EXACT, WINDOW)
    assert result.complete
    assert (result.matched, result.first_wrong) == (len(EXACT), None)
    assert result.error is not None
    assert result.error < 1e-15


def test_errors_are_relative_to_at_least_one() -> None:
    changed = list(RIGHT)
    changed[0] = moved(RIGHT[0], 1e-6)  # at t = 0.12
    changed[-1] = RIGHT[-1]._replace(x=RIGHT[-1].x * (1 + 1e-5))  # |x| > 1
    result = compare(changed, EXACT, WINDOW)
    assert abs(RIGHT[-1].x) > 1
    assert (result.error_t, result.error_x) == (pytest.approx(1e-6, rel=1e-6), pytest.approx(1e-5, rel=1e-6))
    assert result.error == result.error_x


def test_a_missed_event_does_not_shift_the_later_ones() -> None:
    result = compare(RIGHT[:3] + RIGHT[4:], EXACT, WINDOW)
    assert (result.missed, result.invented, result.matched) == (1, 0, len(EXACT) - 1)
    assert result.first_wrong == RIGHT[3].t
    assert result.error is not None
    assert result.error < 1e-15


def test_an_invented_and_a_repeated_event() -> None:
    extra = FoundEvents(2.0, 0.0, "cross", 2)
    result = compare([*RIGHT, extra, moved(RIGHT[5], 1e-3)], EXACT, WINDOW)
    assert (result.missed, result.invented) == (0, 2)
    assert result.first_wrong == 2.0
    assert result.error is not None
    assert result.error < 1e-15  # the nearer one of the two reports counts


@pytest.mark.parametrize("change", [{"kind": "cross"}, {"boundary": 2}, {"t": RIGHT[3].t + 1.01 * WINDOW}])
def test_another_kind_boundary_or_time_is_another_event(change: dict[str, Any]) -> None:
    changed = [*RIGHT[:3], RIGHT[3]._replace(**change), *RIGHT[4:]]
    result = compare(changed, EXACT, WINDOW)
    assert (result.missed, result.invented) == (1, 1)
    assert not result.complete


def test_no_events_and_events_that_are_no_numbers() -> None:
    assert compare([], [], WINDOW) == Comparison(None, None, 0, 0, 0, 0, None)
    nothing = compare([], EXACT, WINDOW)
    assert (nothing.missed, nothing.error, nothing.first_wrong) == (len(EXACT), None, RIGHT[0].t)
    broken = compare([RIGHT[0]._replace(x=float("nan")), *RIGHT[1:]], EXACT, WINDOW)
    assert (broken.missed, broken.invented) == (1, 1)


def test_a_graze_is_not_missed_but_a_stick_in_its_place_is_invented() -> None:
    scene = load_scene("fig8-exact")
    exact = simulate(scene, digits=20, t_end=4).events
    assert [event.kind for event in exact] == ["graze"]
    silent = compare([], exact, window_of(scene))
    assert (silent.complete, silent.missed_grazes) == (True, 1)
    t, x = float(exact[0].t), float(exact[0].x)
    sticking = compare([FoundEvents(t, x, "stick", 1), FoundEvents(t + 1e-6, x, "slip", 1)], exact, window_of(scene))
    assert (sticking.invented, sticking.missed, sticking.missed_grazes) == (2, 0, 1)
    assert compare([FoundEvents(t, x, "graze", 1)], exact, window_of(scene)).missed_grazes == 0


def value_of_best(found: list[FoundEvents], reference: list[FoundEvents], window: float) -> float:
    """Return the value of the best alignment by trying all."""

    @lru_cache(None)
    def best(i: int, j: int) -> float:
        if i == len(reference) or j == len(found):
            return 0.0
        value = max(best(i + 1, j), best(i, j + 1))
        return max(value, best(i + 1, j + 1) + worth(reference[i], found[j], window))

    return best(0, 0)


def worth(one: FoundEvents, other: FoundEvents, window: float) -> float:
    if (one.kind, one.boundary) != (other.kind, other.boundary) or abs(one.t - other.t) > window:
        return -1.0
    return 1 - (1 - FAR_MATCH) * abs(one.t - other.t) / window


def test_the_alignment_is_the_best_one() -> None:
    rng = random.Random(6)

    def some() -> list[FoundEvents]:
        events = [
            FoundEvents(rng.uniform(0, 3), 0.0, rng.choice(["stick", "slip"]), 1) for _ in range(rng.randrange(9))
        ]
        return sorted(events)

    for _ in range(500):
        found, reference, window = some(), some(), rng.choice([0.1, 0.5, 2.0])
        pairs = _align(found, reference, [event.t for event in reference], window)  # type: ignore[arg-type]
        assert all(i < k and j < m for (i, j), (k, m) in pairwise(pairs))
        values = [worth(reference[i], found[j], window) for i, j in pairs]
        assert all(value > 0 for value in values)
        assert sum(values) == pytest.approx(value_of_best(found, reference, window))


# --- time limit ---


@pytest.mark.slow
def test_calls_are_bounded_and_what_goes_wrong_is_said(capfd: pytest.CaptureFixture[str]) -> None:
    with Worker() as worker:
        first = worker.call(20.0, talk)
        assert (first.failure, first.warnings) == ("", ("careful",))
        assert first.value not in (None, os.getpid())
        raised = worker.call(20.0, fail)
        assert (raised.failure, raised.value, raised.lost) == ("exception: ValueError: no", None, False)
        assert worker.call(20.0, talk).value == first.value  # one process for all
        begin = time.perf_counter()
        hanging = worker.call(0.5, loop_for_ever)
        assert time.perf_counter() - begin < 10
        assert (hanging.failure, hanging.lost) == (HANG, True)
        died = worker.call(20.0, os.abort)
        assert (died.failure, died.lost) == ("crash: the process ended with exit code -6", True)
        assert worker.call(20.0, divmod, 7, 2).value == (3, 1)
    assert capfd.readouterr() == ("", "")


# --- work and precision ---


FAKES = (
    OURS[0],
    Solver("careless", careless, (1e-3, 1e-6), note="looks away"),
    Solver("careless, raw", careless, (1e-2,), raw=True),
    Solver("hanging", hanging, (1e-3,)),  # type: ignore[arg-type]
    Solver("failing later", failing_later, (1e-3,)),
    Solver("absent", careless, (1e-3,), needs="no_such_module"),
)


@pytest.fixture(scope="module")
def work() -> dict[str, Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(work_precision, "LIMIT", 1.0)
        patch.setattr(work_precision, "BUDGET", 0.01)
        return work_precision.run(solvers=FAKES, scenes={"fig5": (6, 9, 12), "fig9": (5, 5, 5)})


def rows(work: dict[str, Any], solver: str, scene: str) -> list[dict[str, Any]]:
    return [row for row in work["rows"] if (row["solver"], row["scene"]) == (solver, scene)]


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
    assert row["us_fastest"] <= row["us_per_event"] <= row["us_slowest"]
    assert row["over_ours"] == 1
    assert row["floor_ns"] >= work["floor_ns"] > 1
    assert 0 < row["over_floor"] <= 1e3 * row["us_slowest"] / row["floor_ns"] * (1 + 1e-12)


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
    assert text.count("hang: more than 1 s") == 2
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


# --- machine and README ---


def test_machine_names_the_versions() -> None:
    about = machine()
    assert {"processor", "cores", "date", "symosc", "python", "numpy", "heyoka"} <= set(about)
    assert all(about.values())
    assert f"numpy {about['numpy']}" in sentence(about)


MARKED = "# Title\n\n<!-- results: begin -->\nold\n<!-- results: end -->\n\nend\n"


def test_only_what_is_between_the_marks_is_replaced() -> None:
    text = results.replaced(MARKED.replace("begin", "begin; by hand"), "results", "new \\1\n")
    assert text == "# Title\n\n<!-- results: begin; by hand -->\nnew \\1\n<!-- results: end -->\n\nend\n"


@pytest.mark.parametrize(
    "text",
    ["", MARKED.replace("end -->", "-->"), MARKED + MARKED, "<!-- results: end -->\n<!-- results: begin -->\n"],
    ids=["none", "no end", "twice", "wrong order"],
)
def test_a_readme_without_a_place_for_results_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "README.md"
    path.write_text(text)
    with pytest.raises(OutputError, match=r"needs the lines '<!-- results: begin -->'"):
        results.check(path)
    assert path.read_text() == text


def test_a_readme_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file"):
        results.check(tmp_path / "none.md")


SPEED: dict[str, Any] = {
    "machine": {"processor": "P", "cores": "2", "date": "today", "python": "3"},
    "floor_ns": 27.7,
    "rows": [
        {"scene": "fig5", "events": 200000, "evaluations_per_event": 9.1, "ns_per_event": 253.0}
        | {"python_us_per_event": 17.0, "max_error": 1.4e-15, "max_error_estimate": 1.2e-15}
    ],
    "cold_start": {"simulate_fig5_s": 0.24, "import_numpy_s": 0.14},
    "formulas": {"residuals": 1000, "numpy_s": 1.0, "numpy_speedup_over_lambdify": 4.2}
    | {"numpy_speedup_over_lambdify, cse": 1.1, "newton_P4645_ms": 2.9, "orbit_P4645_without_guess_ms": 12.0}
    | {"exact_window_ms": 0.11, "float_window_ns": 125.0},
}


@pytest.mark.slow
def test_results_are_written_into_the_readme(
    work: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "README.md"
    path.write_text(MARKED)
    heyoka = [{**rows(work, "careless", scene)[1], "solver": "heyoka", "over_ours": 17.4} for scene in ("fig5", "fig9")]
    measured = {**work, "rows": [*work["rows"], *heyoka]}
    case = {"failure": "", "error": 1e-14, "missed": 0, "invented": 0, "found": 3, "worst": 0.1, "undecidable": None}
    hard = {"machine": SPEED["machine"], "limit_s": 6.0, "skipped": {}, "ok": True, "violations": []}
    hard["solvers"] = [{"name": "symosc", "raw": False, "tolerance": 0.0, "note": "", "ours": True}]
    hard["rows"] = [{"group": "near-grazing", "case": "c", "events": 3, "condition": 2.0, "cells": {"symosc": case}}]
    monkeypatch.setattr(results.plot_error_map, "figure", lambda result: plot_work.figure(work))
    result = {"quick": True, "work_precision": measured, "speed": SPEED, "hard": hard, "error_map": {}}
    written = results.write(path, result)
    text = path.read_text()
    assert text.startswith("# Title\n\n<!-- results: begin -->\nOne run of `symosc bench`")
    assert text.endswith("<!-- results: end -->\n\nend\n")
    assert "old" not in text
    assert max(map(len, text.splitlines())) <= 120
    assert "heyoka at its finest tolerance takes 17 (fig5), 17 (fig9) times as long as symosc." in " ".join(
        text.split()
    )
    page = tmp_path / results.FOLDER / "README.md"
    assert text.split("](")[1].partition(")")[0] == f"{results.FOLDER}/README.md"
    assert page.read_text().startswith("# Results\n\nOne run of `symosc bench --quick --results README.md`")
    links = [part.partition(")")[0] for part in page.read_text().split("](")[1:]]
    assert sorted(page.parent / link for link in links) == sorted(written[2:])
    assert all(file.stat().st_size > 100 for file in written)
    assert "hang: more than 1 s" in (tmp_path / results.FOLDER / "work_precision.md").read_text()
    before = [file.read_bytes() for file in written]
    results.write(path, result)
    assert [file.read_bytes() for file in written] == before


def test_what_a_looser_accuracy_saves_is_said() -> None:
    times = {("fig5", 1e-9): 0.2, ("fig5", 1e-13): 0.2, ("fig8", 1e-9): 8, ("fig8", 1e-13): 2000}
    rows = [
        {"scene": scene, "solver": OURS[0].name, "tolerance": tolerance, "us_per_event": time, "error": 2e-12}
        for (scene, tolerance), time in times.items()
    ]
    assert results.looser({"rows": rows}).splitlines() == [
        "Where doubles cannot keep errors below 1e-13, symosc takes more digits, and its time.",
        "With `accuracy=1e-09` fig8 takes 8 instead of 2000 µs per event,",
        "and has an error of 2e-12.",
    ]
    assert results.looser({"rows": rows[:2]}) == ""


def test_the_speed_section_has_the_numbers() -> None:
    text = speed.section(SPEED)
    assert "| fig5" in text
    assert "9.1" in text
    assert "200,000 events" in text
    assert "4.2 (1.1) times as fast" in text
