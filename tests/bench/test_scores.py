"""The page of scores of all solvers."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from effort import PATIENCE
from small_set import small_set

from symosc.bench import scores
from symosc.bench.peers import SOLVERS
from symosc.bench.solvers import Solver
from symosc.bench.time_limit import HANG, Outcome, processor_limit
from symosc.reference.compare import FoundEvents


@pytest.mark.slow
def test_solvers_are_judged_and_the_page_says_how_it_was_made(tmp_path: Path) -> None:
    wanted = [solver for solver in SOLVERS if solver.name in ("symosc, compiled", "scipy DOP853")]
    assert len(wanted) == 2
    result = scores.run(solvers=wanted, cases=small_set()[:3], limit=PATIENCE)
    ours, theirs = result["scores"]
    assert [case.name for case in ours.cases] == [case.name for case in small_set()[:3]]
    assert ours.ok
    assert max(case.units for case in ours.cases if case.units) < 100
    assert len(theirs.given) == 3
    page, picture = scores.write(tmp_path / "scores.md", result)
    text = page.read_text()
    assert f"`symosc bench --scores {page.as_posix()}`" in text
    assert f"]({picture.name})" in text
    assert picture.is_file()
    assert "paper-fig5" in text
    assert "scipy DOP853" in scores.table(result)


def test_what_did_not_end_is_a_note() -> None:
    assert scores._result(Outcome(failure=HANG), 8.0).note == "> 8 s"
    assert scores._result(Outcome(value=None), 8.0).note == "> 8 s"
    assert scores._result(Outcome(failure="exception: PeerError: chatters at t = 3"), 8.0).note == "chatters"
    assert scores._result(Outcome(failure="crash: the process ended with exit code -11"), 8.0).note == "gives up"
    assert scores._result(Outcome(value=[(float("nan"), 0.0, "cross", 1)]), 8.0).note == "not finite"
    (event,) = scores._result(Outcome(value=[(0.5, 0.25, "cross", 1)]), 8.0).events
    assert (event.t, event.kind, event.boundary) == (0.5, "cross", 1)


def test_processor_time_is_what_is_limited() -> None:
    case = small_set()[0]

    def slow(*_: object) -> None:
        while True:
            pass

    solver = Solver("slow", lambda *_: slow, (0.0,))  # type: ignore[arg-type, return-value]
    assert scores.found_by(solver, case, 0.1) is None
    quick = Solver("quick", lambda *_: lambda: [FoundEvents(1.0, 2.0, "stick", 1)], (0.0,))
    assert scores.found_by(quick, case, PATIENCE) == [(1.0, 2.0, "stick", 1)]
    with pytest.raises(ZeroDivisionError), processor_limit(PATIENCE):
        _ = 1 / 0
    assert signal.getitimer(signal.ITIMER_PROF) == (0.0, 0.0)
