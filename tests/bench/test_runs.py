"""Runs of the benchmark: calls with a time limit, their rows, tables, pictures and pages."""

from __future__ import annotations

import json
import os
import pickle
import re
import signal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bench_fakes import FAKES, PatientWorker, fail, loop_for_ever, talk
from effort import PATIENCE
from once import alone
from small_set import small_set

from symosc import load_scene, simulate
from symosc.base.errors import OutputError
from symosc.bench import cases, machine, results, sentence, speed, work
from symosc.bench.solvers import HANG, OURS, SolverEvent, Worker, all_solvers, processor_limit


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


# -- calls -----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_calls_are_bounded_and_what_goes_wrong_is_said(capfd: pytest.CaptureFixture[str]) -> None:
    with Worker() as worker:
        first = worker.call(PATIENCE, talk)
        assert (first.failure, first.warnings) == ("", ("careful",))
        assert first.value not in (None, os.getpid())
        raised = worker.call(PATIENCE, fail)
        assert (raised.failure, raised.value) == ("exception: ValueError: no", None)
        assert worker.call(PATIENCE, talk).value == first.value  # one process for all
        assert worker.call(0.5, loop_for_ever).failure == HANG
        # It may be gone before the pool knows that it had begun, and with what exit code.
        assert re.fullmatch(
            "crash: the process ended( with exit code -6)?", worker.call(PATIENCE, os.abort).failure
        )
        assert worker.call(PATIENCE, divmod, 7, 2).value == (3, 1)
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_a_process_that_dies_between_two_calls_is_replaced() -> None:
    with Worker() as worker:
        first = worker.call(PATIENCE, os.getpid).value
        os.kill(first, signal.SIGKILL)
        for _ in range(3):  # what the pool has noticed by then may fail the first of them
            last = worker.call(PATIENCE, divmod, 7, 2)
        assert (last.value, last.failure) == ((3, 1), "")


def test_processor_time_is_limited() -> None:
    with processor_limit(5.0):
        pass
    with pytest.raises(TimeoutError, match="more than 0"), processor_limit(0.02):
        loop_for_ever()


def test_the_machine_is_named_with_all_versions() -> None:
    about = machine()
    assert {"processor", "cores", "date", "symosc", "python", "numpy", "heyoka"} <= set(about)
    assert all(about.values())
    assert f"numpy {about['numpy']}" in sentence(about)


# -- work and precision ----------------------------------------------------------------------------


COUNTED = ("missed", "invented", "missed_grazes")


def test_a_graze_is_not_missed_but_a_stick_in_its_place_is_invented() -> None:
    scene = load_scene("fig8-exact")
    exact = simulate(scene, digits=20, t_end=4).events
    assert [event.kind for event in exact] == ["graze"]
    silent = work.compare([], scene, exact)
    assert [silent[key] for key in COUNTED] == [0, 0, 1]
    t = float(exact[0].t)
    x = float(exact[0].x)
    sticking = work.compare(
        [SolverEvent(t, x, "stick", 1), SolverEvent(t + 1e-6, x, "slip", 1)], scene, exact
    )
    assert [sticking[key] for key in COUNTED] == [0, 2, 1]
    assert work.compare([SolverEvent(t, x, "graze", 1)], scene, exact)["missed_grazes"] == 0


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
    # Whatever the pace of the machine was when each was measured: 17 times our microseconds is not
    # 11 times ours.
    ours = {row["scene"]: row for row in measured["rows"] if row["solver"] == OURS[0].name}
    timed = [row for row in measured["rows"] if row["over_ours"]]
    assert len(timed) > 6
    for row in timed:
        quotient = row["us_per_event"] / ours[row["scene"]]["us_per_event"]
        assert row["over_ours"] == pytest.approx(quotient, rel=1e-12)


# -- the reference cases ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_solvers_are_judged_and_the_page_says_how_it_was_made(tmp_path: Path) -> None:
    wanted = [
        solver for solver in all_solvers() if solver.name in ("symosc, compiled", "scipy DOP853")
    ]
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


# -- speed -----------------------------------------------------------------------------------------


def test_random_starts_are_followed_for_so_many_periods() -> None:
    p, starts, ends = speed._starts(9)
    assert ends - starts[:, 0] == pytest.approx(
        np.full(9, speed.PERIODS * 2 * np.pi / float(p.Omega))
    )
    assert (np.abs(starts) <= [2 * np.pi / float(p.Omega), 5, 5]).all()


# -- the pages of results --------------------------------------------------------------------------


def assert_same_figures(readme: str, page: str) -> None:
    """All that stands between the README's marks, but the link at its end, is on the page of
    results.
    """
    block = readme.partition("<!-- results: begin -->\n")[2].partition("<!-- results: end -->")[0]
    speed_text, _, rest = " ".join(block.partition("[All calls")[0].split()).partition("). ")
    times = re.findall(r"\d[\d.]* (?:ns|µs|ms|s)\b", speed_text)
    assert len(times) == 4
    for time in times:
        assert time in {row[1].removesuffix(" per event") for row in cells(page) if len(row) > 1}
    assert rest.strip() in " ".join(page.split())


def cells(table: str) -> list[list[str]]:
    lines = [line for line in table.splitlines() if line.startswith("|") and "|--" not in line]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]


def test_results_need_both_marks_once_and_in_order(tmp_path: Path) -> None:
    readme = tmp_path / "README.md"
    begin = "<!-- results: begin -->\n"
    end = "<!-- results: end -->\n"
    for text in (
        begin,
        end,
        begin + begin + end,
        begin + end + end,
        end + begin,
        2 * (begin + end),
    ):
        readme.write_text(text)
        with pytest.raises(OutputError, match="once each"):
            results.check(readme)
    readme.write_text(f"above\n{begin}old\n{end}below\n")
    assert results.check(readme) == f"above\n{begin}{end}below\n"


def test_readme_and_pages_of_results_say_the_same() -> None:
    """Those that are committed.

    The ratios are quotients of the times beside them, and all are of one table.
    """
    top = Path(__file__).parents[2]
    readme = (top / "README.md").read_text(encoding="utf-8")
    folder = top / results.RESULTS_FOLDER
    page = (folder / "README.md").read_text(encoding="utf-8")
    assert_same_figures(readme, page)
    best = {
        row[0]: row[1:]
        for row in cells(page.partition("## Work and precision")[2].partition("## Hard")[0])
    }
    scenes = best.pop("")
    compared = 0
    assert list(best) == [solver.name for solver in all_solvers()]
    for part in (folder / "work_precision.md").read_text(encoding="utf-8").split("\n**")[1:]:
        scene = part.partition("**")[0]
        (heads, *rows) = cells(part)
        assert heads[2:5] == ["time / ours", "us per event", "error"]
        timed = [(row[0], *map(float, row[2:5])) for row in rows if row[2] and row[4]]
        ours = [us for solver, _, us, _ in timed if solver == "symosc, compiled"][-1]
        assert [ratio for _, ratio, _, _ in timed] == pytest.approx(
            [us / ours for _, _, us, _ in timed], rel=0.02
        )
        for solver, shown in best.items():
            ratio, _, rest = shown[scenes.index(scene)].partition(" ×, ")
            if rest:
                error = float(rest.partition(",")[0])
                same = [row for row in timed if row[0] == solver and 0.6 < row[3] / error < 1.6]
                assert any(abs(row[1] / float(ratio) - 1) < 0.06 for row in same), (solver, scene)
                compared += 1
        heyoka = [ratio for solver, ratio, _, _ in timed if solver == "heyoka"][-1]
        assert any(
            f"{heyoka * part:.2g} ({scene}" in " ".join(readme.split())
            for part in (1, 1.001, 0.999)
        )
    assert compared > 40
    scores = cells((folder / "scores.md").read_text(encoding="utf-8"))
    summed = cells(page.partition("## Hard cases")[2])
    assert [(row[0].rpartition(" (")[0], *row[1:-1]) for row in summed[1:]] == [
        (row[0], *row[2:]) for row in scores if row[0] in cases.GROUPS
    ]
