"""The scores of all solvers on the reference cases, as a page: what `symosc score` would say of each.

A solver follows a case at its finest tolerance, in a process of its own and within a limit of processor time, so that
other work on the machine changes no score. The raw peers, as they come, are left out: the hard cases have them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any

from symosc import plot
from symosc.aliases import Record
from symosc.bench.hard import CASE_LIMIT, Job, in_parallel
from symosc.bench.machine import machine, sentence
from symosc.bench.peers import SOLVERS
from symosc.bench.solvers import Solver
from symosc.bench.time_limit import FIRST_LIMIT, HANG, Outcome, processor_limit
from symosc.files import write_text
from symosc.reference.case import ReferenceCase
from symosc.reference.cases import SET_VERSION, reference_cases
from symosc.reference.compare import SCORE_TOLERANCE
from symosc.reference.folder import stored
from symosc.reference.results import CaseResult, GivenEvent
from symosc.reference.score import Score, as_markdown, case_table, group_table, judge_case, legend, verdict

#: What is measured before a solver's results: a case as its files would have it.
KNOWN = "known"
#: The limit by the clock is this many times that of processor time; it ends what Python cannot interrupt.
CLOCK_FACTOR = 10.0
COMMAND = "symosc bench --scores"


def run(
    progress: Callable[[Sequence[Any]], Iterable[Any]] = iter,
    solvers: Sequence[Solver] = SOLVERS,
    cases: Sequence[ReferenceCase] | None = None,
    limit: float = CASE_LIMIT,
) -> Record:
    """Let all solvers follow all cases, and judge what they find.

    Parameters
    ----------
    progress : callable
        Gets a sequence of steps and returns it as an iterable that may show how far it is.
    solvers, cases : optional
        In place of all.
    limit : float
        Seconds of processor time that a solver may take for a case, with its preparation.

    Returns
    -------
    dict
        scores (a list of `symosc.reference.score.Score`), limit_s, skipped (solver: why it cannot run), machine.
    """
    chosen = list(reference_cases() if cases is None else cases)
    able = [solver for solver in solvers if not solver.missing and not solver.raw]
    steps = iter(progress(range(len(chosen) * (1 + len(able)))))
    chunks = [[Job((KNOWN, i), stored, (chosen[i],)) for i in range(k, len(chosen), 2)] for k in range(2)]
    known = {i: _value(outcome) for (_, i), outcome, _ in in_parallel(chunks, FIRST_LIMIT, None, steps)}
    jobs = [[Job((s.name, i), found_by, (s, case, limit)) for i, case in enumerate(chosen)] for s in able]
    made = {
        key: _result(outcome, limit) for key, outcome, _ in in_parallel(jobs, CLOCK_FACTOR * limit, FIRST_LIMIT, steps)
    }
    next(steps, None)  # lets a progress bar come to its end
    scores = [
        Score(s.name, SCORE_TOLERANCE, [judge_case(known[i], made[s.name, i], SCORE_TOLERANCE) for i in sorted(known)])
        for s in able
    ]
    skipped = {solver.name: solver.missing for solver in solvers if solver.missing}
    return {"scores": scores, "limit_s": limit, "skipped": skipped, "machine": machine()}


def found_by(solver: Solver, case: ReferenceCase, limit: float) -> list[tuple[Any, ...]] | None:
    """Return what a solver finds in a case (t, x, kind, boundary); None if it takes longer than `limit`."""
    try:
        with processor_limit(limit):
            events = solver.prepare(case.scene, solver.tolerances[-1])()
            return [(float(event.t), float(event.x), event.kind, event.boundary) for event in events]
    except TimeoutError:
        return None


def _result(outcome: Outcome, limit: float) -> CaseResult:
    """Return the result of a case, or one that says why there is none."""
    if outcome.failure == HANG or (not outcome.failure and outcome.value is None):
        return CaseResult(note=f"> {limit:g} s")
    if outcome.failure:
        return CaseResult(note="chatters" if "chatters" in outcome.failure else "gives up")
    finite = [row for row in outcome.value if isfinite(row[0]) and isfinite(row[1])]
    if len(finite) < len(outcome.value):
        return CaseResult(note="not finite")
    return CaseResult([GivenEvent(Fraction(t), Fraction(x), *words) for t, x, *words in sorted(finite)])


def _value(outcome: Outcome) -> Any:
    if outcome.failure:
        raise RuntimeError(f"no events of a reference case: {outcome.failure}")
    return outcome.value


def write(path: str | Path, result: Record) -> list[Path]:
    """Write the page, and the picture beside it; return both files.

    Raises
    ------
    OutputError
        If one cannot be written.
    """
    picture = Path(path).with_suffix(".svg")
    scores: list[Score] = result["scores"]
    more = [
        f"Made by `{COMMAND} {Path(path).as_posix()}`. Each solver of `symosc bench` at its finest tolerance, with at "
        f"most {result['limit_s']:g} s of processor time for a case. {sentence(result['machine'])}",
        f"![The largest error of each case, a mark per solver]({picture.name})",
        *(f"Not run: {name}: {reason}." for name, reason in result["skipped"].items()),
    ]
    page = as_markdown(scores, "Scores of solvers on the reference cases", SET_VERSION, more, with_faults=False)
    return [write_text(path, page), plot.save(plot.score_figure(scores), picture)]


def table(result: Record) -> str:
    """Return the result of `run` as text."""
    scores = result["scores"]
    return "\n\n".join([case_table(scores), group_table(scores), *legend(scores[0]), *map(verdict, scores)])
