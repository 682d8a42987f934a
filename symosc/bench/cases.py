"""Run all solvers on the reference cases: the score of each, and whether symosc keeps its error bound.

A solver follows a case at its finest tolerance, in a process of its own and within a limit of processor time, so that
other work on the machine changes no score. In the hard cases (`symosc.reference.cases`) symosc's own errors must be
within max(1e-12, 100 * condition * 1e-16) at every event: as good as the rounding of the case's numbers allows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any

from tabulate import tabulate

from symosc import plot
from symosc.aliases import Record
from symosc.bench import machine, sentence
from symosc.bench.solvers import (
    FIRST_LIMIT,
    HANG,
    OURS,
    PROCESSES,
    Job,
    Outcome,
    Solver,
    all_solvers,
    in_parallel,
    processor_limit,
)
from symosc.files import write_text
from symosc.reference.case import ReferenceCase
from symosc.reference.cases import GROUPS, SET_VERSION, hard_cases, reference_cases
from symosc.reference.compare import SCORE_TOLERANCE, FoundEvents
from symosc.reference.folder import stored
from symosc.reference.results import CaseResult, GivenEvent
from symosc.reference.score import (
    Score,
    as_markdown,
    by_group,
    case_table,
    group_cell,
    group_table,
    judge_case,
    legend,
    verdict,
)

#: Seconds of processor time for a case, the solver's preparation included.
CASE_LIMIT = 4.0
#: The error that symosc may have in a hard case, unless 100 units (condition * 1e-16) are more.
OUR_TOLERANCE = 1e-12
KNOWN = "known"


def hard_ones(quick: bool = False) -> list[ReferenceCase]:
    """Return the reference cases that are hard for solvers; with `quick` only those for `symosc bench --quick`."""
    return [case for case in hard_cases() if case.quick or not quick]


def run(
    progress: Callable[[Sequence[Any]], Iterable[Any]] = iter,
    solvers: Sequence[Solver] | None = None,
    cases: Sequence[ReferenceCase] | None = None,
    limit: float = CASE_LIMIT,
    with_derivatives: bool = False,
) -> Record:
    """Run solvers (None: all) on cases (None: all) and judge their events."""
    # `progress` gets a sequence of steps and returns it as an iterable that may show how far it is; `limit` is in
    # seconds of processor time. Keys: scores and ours (lists of `symosc.reference.score.Score`; the second one with
    # OUR_TOLERANCE, of the hard cases and symosc's own solvers), violations (where those did not keep the bound), ok,
    # limit_s, skipped (solver: why it cannot run), machine.
    solvers = all_solvers() if solvers is None else solvers
    chosen = list(reference_cases() if cases is None else cases)
    able = [solver for solver in solvers if not solver.missing]
    steps = iter(progress(range(len(chosen) * (1 + len(able)))))
    chunks = [
        [Job((KNOWN, i), stored, (chosen[i], with_derivatives)) for i in range(k, len(chosen), PROCESSES)]
        for k in range(PROCESSES)
    ]
    known = {i: _value(outcome) for (_, i), outcome in in_parallel(chunks, FIRST_LIMIT, None, steps).items()}
    jobs = [[Job((s.name, i), found_by, (s, case, limit)) for i, case in enumerate(chosen)] for s in able]
    # The limit by the clock is this many times that of processor time; it ends what Python cannot interrupt.
    outcomes = in_parallel(jobs, 10.0 * limit, FIRST_LIMIT, steps)
    next(steps, None)  # lets a progress bar come to its end
    made = {key: _result(outcome, limit) for key, outcome in outcomes.items()}

    def score(solver: Solver, numbers: Iterable[int], tolerance: float) -> Score:
        return Score(solver.name, tolerance, [judge_case(known[i], made[solver.name, i], tolerance) for i in numbers])

    judged = [i for i, case in enumerate(chosen) if case.group in GROUPS]
    ours = [score(solver, judged, OUR_TOLERANCE) for solver in able if solver in OURS]
    violations = [
        f"{each.name}: {case.name}: {case.wrong[0] if case.wrong else case.note}"
        for each in ours
        for case in each.cases
        if case.wrong or (case.note and not case.note.startswith(">"))  # what took too long is left out
    ]
    return {
        "machine": machine(),
        "limit_s": limit,
        "skipped": {solver.name: solver.missing for solver in solvers if solver.missing},
        "scores": [score(solver, range(len(chosen)), SCORE_TOLERANCE) for solver in able],
        "ours": ours,
        "ok": not violations,
        "violations": violations,
    }


def found_by(solver: Solver, case: ReferenceCase, limit: float) -> list[FoundEvents] | None:
    """Return the events that a solver finds in a case; None if it takes longer than `limit`."""
    try:
        with processor_limit(limit):
            return list(solver.prepare(case.scene, solver.tolerances[-1])())
    except TimeoutError:
        return None


def _result(outcome: Outcome, limit: float) -> CaseResult:
    """Convert the outcome of a solver's call to its events, or to a note that says why it found none."""
    if outcome.failure == HANG or (not outcome.failure and outcome.value is None):
        return CaseResult(note=f"> {limit:g} s")
    if outcome.failure:
        return CaseResult(note="chatters" if "chatters" in outcome.failure else "gives up")
    finite = sorted((row for row in outcome.value if isfinite(row[0]) and isfinite(row[1])), key=lambda row: row[:2])
    if len(finite) < len(outcome.value):
        return CaseResult(note="not finite")
    return CaseResult([GivenEvent(Fraction(t), Fraction(x), *words) for t, x, *words in finite])


def _value(outcome: Outcome) -> Any:
    """Return the value of an outcome, or raise RuntimeError for a failure."""
    if outcome.failure:
        raise RuntimeError(f"no events of a reference case: {outcome.failure}")
    return outcome.value


def our_verdict(result: Record) -> str:
    """Return a sentence: how many hard cases symosc solved within its bound; or list the cases where it did not."""
    bound = "1e-12, or 100 * condition * 1e-16 where that is more"
    if result["violations"]:
        return "\n".join([f"Not within {bound}:", *(f"  {each}" for each in result["violations"])])
    parts = []
    for score in result["ours"]:
        errors = [error for case in score.given for error in (case.error_t, case.error_x) if error is not None]
        largest = f", largest error {max(errors):.0e}" if errors else ""
        absent = len(score.cases) - len(score.given)
        unfinished = f", {absent} not finished" if absent else ""
        parts.append(f"{score.name} {len(score.given)} of {len(score.cases)}{largest}{unfinished}")
    return f"Hard cases solved within {bound}: {'; '.join(parts)}."


def table(result: Record) -> str:
    """Return the result of `run` as text: a row per case, a row per group, what the numbers mean, and the verdicts."""
    scores = result["scores"]
    not_run = [f"Not run: {name}: {reason}." for name, reason in result["skipped"].items()]
    parts = [case_table(scores), group_table(scores), *legend(scores[0]), "\n".join(map(verdict, scores))]
    return "\n\n".join([*parts, *not_run, our_verdict(result), sentence(result["machine"])])


def hard_summary(result: Record) -> str:
    """Return a Markdown table of the groups of hard cases: each solver's results, and the difficulty."""
    scores, rows = result["scores"], []
    for group, cases in by_group(scores[0].cases):
        if group in GROUPS:
            cells = (group_cell([case for case in score.cases if case.group == group]) for score in scores)
            rows.append([f"{group} ({len(cases)})", *cells, GROUPS[group]])
    heads = ["group (cases)", *(score.name for score in scores), "what is hard"]
    return tabulate(rows, heads, tablefmt="github", disable_numparse=True)


def as_json(result: Record) -> Record:
    """Return the results as plain data."""
    return result | {key: [score.as_dict() for score in result[key]] for key in ("scores", "ours")}


def write(path: str | Path, result: Record, command: str) -> list[Path]:
    """Write the page of all scores and its picture; return both files."""
    picture = Path(path).with_suffix(".svg")
    scores: list[Score] = result["scores"]
    more = [
        f"Made by `{command}`. Each solver of `symosc bench` at its finest tolerance, with at "
        f"most {result['limit_s']:g} s of processor time for a case. {sentence(result['machine'])}",
        f"![The largest error of each case, a mark per solver]({picture.name})",
        *(f"Not run: {name}: {reason}." for name, reason in result["skipped"].items()),
    ]
    page = as_markdown(scores, "Scores of solvers on the reference cases", SET_VERSION, more, with_faults=False)
    return [write_text(path, page), plot.save(plot.score_figure(scores), picture)]
