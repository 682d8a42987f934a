"""Runs of the benchmark: calls with a time limit, their rows, tables, pictures and pages."""

from __future__ import annotations

import json
import os
import pickle
import signal
from dataclasses import replace
from fractions import Fraction
from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bench_fakes import FAKES, PatientWorker, fail, loop_for_ever, moody, talk
from effort import PATIENCE
from once import alone
from small_set import small_set

from symosc import load_scene, simulate
from symosc.bench import cases, error_map, machine, results, sentence, solvers, speed, work
from symosc.bench.solvers import HANG, OURS, Outcome, Solver, Worker, all_solvers, processor_limit
from symosc.engine.flow import constants
from symosc.errors import OutputError
from symosc.kernels import entire
from symosc.reference.case import ReferenceCase
from symosc.reference.compare import FoundEvents
from symosc.reference.score import CaseScore, Score

MARKED = "# Title\n\n<!-- results: begin -->\nold\n<!-- results: end -->\n\nend\n"
ROWS: list[dict[str, Any]] = [
    {"what": "fig5", "per": "event", "s": 2.05e-7, "over_first": 1.0, "over_c": 1.0},
    {"what": "fig9", "per": "event", "s": 1.8e-7, "over_first": 0.9057, "over_c": 0.9057},
]
SPEED: dict[str, Any] = {
    "machine": {"processor": "P", "cores": "2", "date": "today", "python": "3"},
    "floor_ns": 27.7,
    "c_ns": 205.0,
    "errors": [{"scene": "fig5", "events": 16, "error": 1.4e-15, "estimate": 2.2e-15}],
    "groups": [{"title": "One long motion, events counted", "rows": ROWS}],
}


@pytest.fixture(scope="session")
def measured() -> dict[str, Any]:
    """One small run of work and precision for all tests."""
    with alone("work-precision") as path:
        if not path.exists():
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(work, "Worker", PatientWorker)
                patch.setattr(work, "SPAN_LIMIT", PATIENCE)
                patch.setattr(work, "BUDGET", 0.01)
                made = work.run(solvers=FAKES, scenes={"fig5": (6, 9, 12), "fig9": (5, 5, 5)})
            path.write_bytes(pickle.dumps(made))
        found: dict[str, Any] = pickle.loads(path.read_bytes())
    return found


def rows(measured: dict[str, Any], solver: str, scene: str) -> list[dict[str, Any]]:
    return [row for row in measured["rows"] if (row["solver"], row["scene"]) == (solver, scene)]


# -- calls -------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_calls_are_bounded_and_what_goes_wrong_is_said(capfd: pytest.CaptureFixture[str]) -> None:
    with Worker() as worker:
        first = worker.call(PATIENCE, talk)
        assert (first.failure, first.warnings) == ("", ("careful",))
        assert first.value not in (None, os.getpid())
        raised = worker.call(PATIENCE, fail)
        assert (raised.failure, raised.value, raised.lost) == ("exception: ValueError: no", None, False)
        assert worker.call(PATIENCE, talk).value == first.value  # one process for all
        hanging = worker.call(0.5, loop_for_ever)
        assert (hanging.failure, hanging.lost) == (HANG, True)
        died = worker.call(PATIENCE, os.abort)
        assert (died.failure, died.lost) == ("crash: the process ended with exit code -6", True)
        assert worker.call(PATIENCE, divmod, 7, 2).value == (3, 1)
    assert capfd.readouterr() == ("", "")


def test_processor_time_is_what_is_limited() -> None:
    case = ReferenceCase("a", "easy", load_scene("fig5"), "nothing")
    slow = Solver("slow", lambda *_: loop_for_ever, (0.0,))  # type: ignore[arg-type, return-value]
    assert cases.found_by(slow, case, 0.1) is None
    quick = Solver("quick", lambda *_: lambda: [FoundEvents(1.0, 2.0, "stick", 1)], (0.0,))
    assert cases.found_by(quick, case, PATIENCE) == [(1.0, 2.0, "stick", 1)]
    with pytest.raises(ZeroDivisionError), processor_limit(PATIENCE):
        _ = 1 / 0
    assert signal.getitimer(signal.ITIMER_PROF) == (0.0, 0.0)


def test_the_machine_is_named_with_all_versions() -> None:
    about = machine()
    assert {"processor", "cores", "date", "symosc", "python", "numpy", "heyoka"} <= set(about)
    assert all(about.values())
    assert f"numpy {about['numpy']}" in sentence(about)


# -- work and precision ------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_rows_have_times_and_errors(measured: dict[str, Any]) -> None:
    _, row = rows(measured, OURS[0].name, "fig5")  # the finer accuracy
    assert (row["failure"], row["missed"], row["invented"], row["compared"]) == ("", 0, 0, 9)
    assert row["error"] < 1e-14
    assert row["over_ours"] == 1
    assert row["floor_ns"] >= measured["floor_ns"] > 1
    coarse, row = rows(measured, "careless", "fig5")
    assert coarse["error_t"] == pytest.approx(1e-3, rel=1e-3)
    assert (row["tolerance"], row["failure"]) == (1e-6, "")
    assert (row["missed"], row["invented"], row["compared"], row["timed_events"]) == (1, 0, 9, 12)
    assert row["first_wrong"] == pytest.approx(float(simulate("fig5").events[1].t))
    assert row["error_t"] == pytest.approx(1e-6, rel=1e-3)
    assert 1 <= len(row["times_s"]) <= work.MOST_REPEATS
    # Whatever the pace of the machine was when each was measured: 17 times our microseconds is not 11 times ours.
    ours = {row["scene"]: row for row in measured["rows"] if row["solver"] == OURS[0].name}
    timed = [row for row in measured["rows"] if row["over_ours"]]
    assert len(timed) > 6
    for row in timed:
        quotient = row["us_per_event"] / ours[row["scene"]]["us_per_event"]
        assert row["over_ours"] == pytest.approx(quotient, rel=1e-12)


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_failures_are_rows(measured: dict[str, Any]) -> None:
    for scene in ("fig5", "fig9"):
        (row,) = rows(measured, "hanging", scene)
        assert (row["failure"], row["us_per_event"], row["missed"]) == (HANG, None, None)
    (row,) = rows(measured, "failing later", "fig5")
    assert row["failure"] == "exception: ArithmeticError: too far (in 12 events, not in 6)"
    assert (row["missed"], row["compared"]) == (6, 6)
    assert list(measured["skipped"]) == ["absent"]
    assert "no_such_module" in measured["skipped"]["absent"]
    assert measured["notes"] == {"careless": "looks away"}
    assert json.loads(json.dumps(measured)) == measured


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_tables_and_the_picture_show_all_rows(measured: dict[str, Any]) -> None:
    for markdown in (False, True):
        text = work.table(measured, markdown)
        assert text.count("hang: more than 600 s") == 2
        assert "too far (in 12 events, not in 6)" in text
        assert "absent: skipped, no_such_module is not installed" in text
        lines = [line.replace("|", " ").split() for line in text.splitlines()]
        assert [line[-3:] for line in lines if line[:1] == ["careless"]] == [["9", "1", "0"]] * 2 + [
            ["5", "1", "0"]
        ] * 2
    exact = rows(measured, "careless", "fig5")[1]
    coarse = {**exact, "tolerance": 1e-3, "error": 1e-3, "missed": 3}
    failed = {**coarse, "missed": None, "invented": None, "us_per_event": None, "failure": HANG}
    changed = {**measured, "rows": [*measured["rows"], coarse, failed]}
    assert work.best_rows(changed)["careless", "fig5"] is exact
    text = work.summary(changed)
    line = next(line for line in text.splitlines() if line.startswith("| careless "))
    assert "missed 1" in line
    assert "missed 3" not in line
    assert "| hang" in next(line for line in text.splitlines() if line.startswith("| hanging "))
    drawing = work.figure(json.loads(json.dumps(measured)))
    panel = drawing.axes[0]
    assert panel.get_title(loc="left") == "fig5"
    crosses = [point for line in panel.lines if line.get_marker() == "x" for point in line.get_xydata().tolist()]
    wrong = [row for row in measured["rows"] if row["scene"] == "fig5" and row["missed"]]
    assert sorted(x for x, _ in crosses) == sorted(row["us_per_event"] for row in wrong)
    assert [text.get_text() for text in panel.texts] == ["2 runs failed"]
    assert "careless" in [text.get_text() for text in drawing.axes[-1].get_legend().get_texts()]


# -- the reference cases -----------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_solvers_are_judged_and_the_page_says_how_it_was_made(tmp_path: Path) -> None:
    wanted = [solver for solver in all_solvers() if solver.name in ("symosc, compiled", "scipy DOP853")]
    chosen = [*small_set()[:3], *(case for case in cases.hard_ones() if case.name == "easy-fig9")]
    result = cases.run(solvers=wanted, cases=chosen, limit=PATIENCE)
    ours, theirs = result["scores"]
    assert [case.name for case in ours.cases] == [case.name for case in chosen]
    assert ours.ok
    assert max(case.units for case in ours.cases if case.units) < 100
    assert len(theirs.given) == 4
    assert [[case.name for case in score.cases] for score in result["ours"]] == [["easy-fig9"]]
    assert result["ok"]
    assert "scipy DOP853" in cases.table(result)
    json.dumps(cases.as_json(result))
    page, picture = cases.write(tmp_path / "scores.md", result, "the command")
    text = page.read_text()
    assert "`the command`" in text
    assert f"]({picture.name})" in text
    assert picture.is_file()


@pytest.mark.slow
def test_failures_of_solvers_are_shown_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solvers, "Worker", PatientWorker)
    scene = replace(load_scene("fig9"), t_end=Fraction(3))
    names = ("works", "misses", "invents", "refuses", "chatters", "dies", "sleeps")
    chosen = [ReferenceCase(name, "easy", replace(scene, name=name), "nothing") for name in names]
    steps: list[Any] = []

    def progress(planned: Any) -> Any:
        for step in planned:
            steps.append(step)
            yield step

    # It stands for one of ours: the bound is kept where it works, and in the case that took too long.
    monkeypatch.setattr(cases, "OURS", (asked := Solver("moody", moody, (1e-3, 1e-9)),))
    absent = Solver("absent", moody, (0.0,), needs="no_such_module")
    result = cases.run(progress, solvers=[asked, absent], cases=chosen)
    assert len(steps) == 7 + 7
    table = cases.case_table(result["scores"])
    found = {line.split()[0]: " ".join(line.split()[3:]) for line in table.splitlines()[2:]}
    assert "missed 1" in found["misses"]
    assert "invented 1" in found["invents"]
    assert found["refuses"].startswith("gives up")
    assert found["dies"].startswith("gives up")
    assert found["chatters"].startswith("chatters")
    assert found["sleeps"].startswith("> 4 s")
    assert "Not run: absent: no_such_module is not installed (extra `bench`)." in cases.table(result)
    assert not result["ok"]
    violated = {line.split(": ")[1] for line in result["violations"]}
    assert violated == set(names) - {"sleeps"}  # an error of 1e-9 is more than 1e-12
    assert "Not within" in cases.our_verdict(result)


def test_what_did_not_end_is_a_note() -> None:
    assert cases._result(Outcome(failure=HANG), 8.0).note == "> 8 s"
    assert cases._result(Outcome(value=None), 8.0).note == "> 8 s"
    assert cases._result(Outcome(failure="exception: PeerError: chatters at t = 3"), 8.0).note == "chatters"
    assert cases._result(Outcome(failure="crash: the process ended with exit code -11"), 8.0).note == "gives up"
    assert cases._result(Outcome(value=[(nan, 0.0, "cross", 1)]), 8.0).note == "not finite"
    (event,) = cases._result(Outcome(value=[(0.5, 0.25, "cross", 1)]), 8.0).events
    assert (event.t, event.kind, event.boundary) == (0.5, "cross", 1)


def test_the_verdict_on_ours() -> None:
    judged = [CaseScore("a", "easy", 2, 3.0, error_t=1e-16, error_x=3e-13), CaseScore("b", "easy", 2, 3.0, given=False)]
    result = {"violations": [], "ours": [Score("symosc", 1e-12, judged)]}
    assert "symosc 1 of 2, largest error 3e-13, 1 not finished." in cases.our_verdict(result)


@pytest.mark.slow
def test_the_quick_hard_cases_are_some_of_each_group() -> None:
    quick, every = cases.hard_ones(quick=True), cases.hard_ones()
    assert {case.group for case in quick} == {case.group for case in every} == set(cases.GROUPS)
    assert len(quick) < len(every) / 2


# -- speed -------------------------------------------------------------------------------------------------------------


def test_what_a_looser_accuracy_saves_is_said() -> None:
    times = {("fig5", 1e-9): 0.2, ("fig5", 1e-13): 0.2, ("fig8", 1e-9): 8, ("fig8", 1e-13): 2000}
    made = [
        {"scene": scene, "solver": OURS[0].name, "tolerance": tolerance, "us_per_event": time, "error": 2e-12}
        for (scene, tolerance), time in times.items()
    ]
    assert results.looser({"rows": made}).splitlines() == [
        "Where doubles cannot keep errors below 1e-13, more digits are taken, which cost time:",
        "fig8 takes 2000 µs per event with an error of 2e-12, and with",
        "`accuracy=1e-09` 8 µs with 2e-12.",
    ]
    assert results.looser({"rows": made[:2]}) == ""


def test_the_speed_tables_have_the_numbers() -> None:
    for form in ("simple", "github"):
        lines = [line.replace("|", " ").split() for line in speed.table(SPEED, form).splitlines()]
        assert ["fig9", "180", "ns", "per", "event", "0.906", "0.906"] in lines
        assert ["fig5", "16", "1.4e-15", "2.2e-15"] in lines
    assert "One long motion, events counted: fig5 | 205 ns per event |" in speed.brief(SPEED)
    assert "c = 205 ns" in speed.about(SPEED)


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_what_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small tasks of every group run; times are positive, and ratios are those of the times beside them."""
    small = [
        speed.Group("long", [*speed._long_motions(500)][:3]),
        speed.Group("many", [*speed._ensemble(5)]),
        speed.Group("one", [*speed._single_motions(50)]),
        speed.Group("sticks", [*speed._shrinking_sticks(1, 2)]),
        speed.Group("formulas", [*speed._residuals(50)]),
        speed.Group("orbits", [*speed._orbits_and_windows(50)]),
        speed.Group("processes", [speed.Call("once", "call", lambda: None, once=True)]),
    ]
    monkeypatch.setattr(speed, "groups", lambda quick: iter(small))
    result = speed.run(quick=True)
    assert [[row["what"] for row in group["rows"]] for group in result["groups"]] == [
        [call.what for call in group.calls] for group in small
    ]
    rows = [row for group in result["groups"] for row in group["rows"]]
    assert all(row["s"] > 0 for row in rows[:-1])
    assert rows[0]["over_c"] == rows[0]["over_first"] == 1
    assert result["c_ns"] == pytest.approx(1e9 * rows[0]["s"])
    assert all(row["error"] < 1e-13 for row in result["errors"])


def test_sweeps_and_workers_are_measured_on_what_they_say(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    bare, written = speed._sweep(6, str(tmp_path))
    assert len(bare.action()) == written.action().sizes["x0"] == 6
    assert [len(call.action()) for call in speed._workers(3)] == [3, 3]


# -- the error map -----------------------------------------------------------------------------------------------------


def test_places_and_values_of_the_error_map() -> None:
    for text in ("1e-9", "0.3", "0.5", "0.75", "1", "1.5", "2", "70"):
        assert float(error_map.value_at(error_map.place_of(float(text)))) == pytest.approx(float(text), rel=1e-12)
    for beyond in (1e-9, -1e-9):
        value = error_map.value_at(error_map.place_of(1, beyond))
        assert float(value - 1) == pytest.approx(beyond, rel=1e-6)
    places = error_map.axis(-2, 2, 25)
    assert len(places) == 25
    assert np.all(np.diff(places) > 0)
    assert [float(error_map.value_at(place)) for place in places[[0, -1]]] == pytest.approx([0.01, 100])
    assert Fraction(1) in [error_map.value_at(place) for place in places]


def test_the_named_formula_is_the_one_that_is_taken() -> None:
    p = error_map.parameters(Fraction(1, 10), Fraction(1, 2))
    for parameters, tau, name in (
        (p, 3.0, "apart"),
        (p, 0.1, "series"),
        (p.replace(Omega=1, c=0), 3.0, "careful"),
        (p.replace(c=4), 3.0, "careful"),
    ):
        K = constants(parameters)
        assert error_map.formula_of(tau, K) == name
        cheap = error_map.closed_form(tau, K)[:5] if K.under and K.p else (nan,) * 5
        assert (entire.basis(tau, K)[:5] == cheap) == (name == "apart")


@pytest.mark.slow
def test_symosc_is_exact_all_over_the_map_and_the_border_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """On its side of the border the cheap formula is good to 50 ulp, on the other side it loses up to all digits."""
    monkeypatch.setattr(error_map, "BORDER_POINTS", 31)
    errors = error_map.run(quick=True)
    assert 2.0**-53 < errors["largest"] < 50 * 2.0**-52
    inside, outside = [], []
    for n, tau in enumerate(errors["taus"]):
        for i, zeta in enumerate(errors["zeta"]):
            for j, ratio in enumerate(errors["ratio"]):
                K = constants(error_map.parameters(error_map.value_at(zeta), error_map.value_at(ratio)))
                value = errors["cheap"][n][i][j]
                if not isnan(value):
                    (inside if error_map.formula_of(tau, K) == "apart" else outside).append((tau, value))
    assert max(value for _, value in inside) < 50 * 2.0**-52
    assert max(value for tau, value in outside if tau >= 1) > 1e-9
    assert max(value for _, value in outside) > 1
    assert len(inside) > 200
    drawing = error_map.figure(errors)
    panels = [ax for ax in drawing.axes if ax.get_title()]
    assert len(panels) == 2 * len(errors["taus"])
    assert {"cheap", "careful", "series"} <= {text.get_text() for ax in panels for text in ax.texts}


# -- the pages of results ----------------------------------------------------------------------------------------------


def test_only_what_is_between_the_marks_is_replaced(tmp_path: Path) -> None:
    text = results.replaced(MARKED.replace("begin", "begin; by hand"), "results", "new \\1\n")
    assert text == "# Title\n\n<!-- results: begin; by hand -->\nnew \\1\n<!-- results: end -->\n\nend\n"
    path, wrong_order = tmp_path / "README.md", "<!-- results: end -->\n<!-- results: begin -->\n"
    for text in ("", MARKED.replace("end -->", "-->"), MARKED + MARKED, wrong_order):
        path.write_text(text)
        with pytest.raises(OutputError, match=r"needs the lines '<!-- results: begin -->'"):
            results.check(path)
    with pytest.raises(OutputError, match="No such file"):
        results.check(tmp_path / "none.md")


def assert_same_figures(readme: str, page: str) -> None:
    """All that stands between the README's marks, but the link at its end, is on the page of results."""
    block = readme.partition("<!-- results: begin -->\n")[2].partition("<!-- results: end -->")[0]
    figures = block.partition("[All calls")[0]
    about, table, text = figures.strip().split("\n\n")
    assert about in page
    assert text in page
    for what, time in cells(table)[1:]:
        assert [what.partition(": ")[2], time] in [row[:2] for row in cells(page)]


def cells(table: str) -> list[list[str]]:
    lines = [line for line in table.splitlines() if line.startswith("|") and "|--" not in line]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]


def test_readme_and_pages_of_results_say_the_same() -> None:
    """Those that are committed: the ratios are quotients of the times beside them, and all are of one table."""
    top = Path(__file__).parents[2]
    readme, folder = (top / "README.md").read_text(encoding="utf-8"), top / results.RESULTS_FOLDER
    page = (folder / "README.md").read_text(encoding="utf-8")
    assert_same_figures(readme, page)
    best = {row[0]: row[1:] for row in cells(page.partition("## Work and precision")[2].partition("## Hard")[0])}
    scenes, compared = best.pop(""), 0
    assert list(best) == [solver.name for solver in all_solvers()]
    for part in (folder / "work_precision.md").read_text(encoding="utf-8").split("\n**")[1:]:
        scene, (heads, *rows) = part.partition("**")[0], cells(part)
        assert heads[2:5] == ["time / ours", "us per event", "error"]
        timed = [(row[0], *map(float, row[2:5])) for row in rows if row[2] and row[4]]
        ours = [us for solver, _, us, _ in timed if solver == "symosc, compiled"][-1]
        assert [ratio for _, ratio, _, _ in timed] == pytest.approx([us / ours for _, _, us, _ in timed], rel=0.02)
        for solver, shown in best.items():
            ratio, _, rest = shown[scenes.index(scene)].partition(" ×, ")
            if rest:
                error = float(rest.partition(",")[0])
                same = [row for row in timed if row[0] == solver and 0.6 < row[3] / error < 1.6]
                assert any(abs(row[1] / float(ratio) - 1) < 0.06 for row in same), (solver, scene)
                compared += 1
        heyoka = [ratio for solver, ratio, _, _ in timed if solver == "heyoka"][-1]
        assert any(f"{heyoka * part:.2g} ({scene}" in " ".join(readme.split()) for part in (1, 1.001, 0.999))
    assert compared > 50
    scores = cells((folder / "scores.md").read_text(encoding="utf-8"))
    summed = cells(page.partition("## Hard cases")[2])
    assert [(row[0].rpartition(" (")[0], *row[1:-1]) for row in summed[1:]] == [
        (row[0], *row[2:]) for row in scores if row[0] in cases.GROUPS
    ]


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_results_are_written_into_the_readme(
    measured: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "README.md"
    path.write_text(MARKED)
    heyoka = [
        {**rows(measured, "careless", scene)[1], "solver": "heyoka", "over_ours": 17.4} for scene in ("fig5", "fig9")
    ]
    judged = [Score("symosc", 1e-12, [CaseScore("a", "easy", 2, 3.0, error_t=1e-16, error_x=3e-13, units=0.5)])]
    scores = {"machine": SPEED["machine"], "limit_s": 6.0, "skipped": {}, "ok": True, "violations": []}
    monkeypatch.setattr(error_map, "figure", lambda result: work.figure(measured))
    result = {"quick": True, "work_precision": {**measured, "rows": [*measured["rows"], *heyoka]}, "speed": SPEED}
    result |= {"scores": scores | {"scores": judged, "ours": judged}, "error_map": {}}
    written = results.write(path, result)
    text = path.read_text()
    assert text.startswith("# Title\n\n<!-- results: begin -->\nOne run of `symosc bench`")
    assert text.endswith("<!-- results: end -->\n\nend\n")
    assert "old" not in text
    assert max(map(len, text.splitlines())) <= 120
    said = " ".join(text.split())
    assert "heyoka at its finest tolerance takes 17 (fig5), 17 (fig9) times as long as symosc." in said
    page = tmp_path / results.RESULTS_FOLDER / "README.md"
    assert text.split("](")[1].partition(")")[0] == f"{results.RESULTS_FOLDER}/README.md"
    assert page.read_text().startswith("# Results\n\nWritten by one run of `symosc bench --quick --results README.md`")
    assert_same_figures(text, page.read_text())
    links = [part.partition(")")[0] for part in page.read_text().split("](")[1:]]
    made = {file for file in written[1:] if file not in (page, page.with_name("scores.svg"))}
    assert {page.parent / link for link in links} == made
    assert all(file.stat().st_size > 100 for file in written)
    assert "hang: more than 600 s" in (tmp_path / results.RESULTS_FOLDER / "work_precision.md").read_text()
    before = [file.read_bytes() for file in written]
    results.write(path, result)
    assert [file.read_bytes() for file in written] == before
