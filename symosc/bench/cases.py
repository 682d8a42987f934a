"""Run all solvers on the reference cases: the score of each, and whether symosc keeps its error
bound.

A solver follows a case at its finest tolerance, in a process of its own and within a limit of
processor time, so that other work on the machine changes no score. In the hard cases
(`symosc.reference.cases`) symosc's own errors must be within max(1e-12, 100 * condition * 1e-16) at
every event: as good as the rounding of the case's numbers allows.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any

from tabulate import tabulate

from symosc import plot
from symosc.base.aliases import Record
from symosc.base.files import write_text
from symosc.bench import Progress, machine, not_run, sentence
from symosc.bench.solvers import (
    HANG,
    OURS,
    PROCESSES,
    Outcome,
    Solver,
    all_solvers,
    in_parallel,
    processor_limit,
)
from symosc.model import Parameters
from symosc.reference import score
from symosc.reference.case import ReferenceCase, with_known
from symosc.reference.cases import GROUPS, SET_VERSION, hard_cases, reference_cases
from symosc.reference.results import CaseResult, GivenEvent
from symosc.reference.score import SCORE_TOLERANCE, Score

#: The first character of the note of a case that took longer than its limit.
TOO_LONG = ">"
#: Seconds of processor time for a case, the solver's preparation included.
CASE_LIMIT = 4.0
#: The error that symosc may have in a hard case, unless 100 units (condition * 1e-16) are more.
OUR_TOLERANCE = 1e-12


def hard_ones(quick: bool = False) -> list[ReferenceCase]:
    """Return the reference cases that are hard for solvers; with `quick` only those for `symosc
    bench --quick`.
    """
    return [case for case in hard_cases() if case.quick or not quick]


def run(
    progress: Progress = iter,
    solvers: Sequence[Solver] | None = None,
    cases: Sequence[ReferenceCase] | None = None,
    limit: float = CASE_LIMIT,
) -> Record:
    """Run solvers (None: all) on reference cases (None: all), at most `limit` seconds of processor
    time each, and score their events.

    The keys of the record that is returned:

    - machine: where it ran; limit_s: the `limit`;
    - skipped: by the name of a solver, why it cannot run;
    - scores: a Score of each solver;
    - ours: the same with OUR_TOLERANCE, of symosc's own solvers and the hard cases;
    - violations: texts that say where those did not keep the bound; ok: whether there are none.
    """
    if solvers is None:
        solvers = all_solvers()
    if cases is None:
        cases = [case for case in reference_cases() if isinstance(case.parameters, Parameters)]
    chosen = list(cases)
    able = [solver for solver in solvers if not solver.missing]
    steps = iter(progress(range(len(chosen) * (1 + len(able)))))
    jobs = [(i, answers_of, case) for i, case in enumerate(chosen)]
    known = in_parallel([jobs[first::PROCESSES] for first in range(PROCESSES)], steps)
    for outcome in known.values():
        if outcome.failure:
            raise RuntimeError(f"no events of a reference case: {outcome.failure}")
    chunks = [
        [((s.name, i), found_by, s, case, limit) for i, case in enumerate(chosen)] for s in able
    ]
    # The limit by the clock is this many times that of processor time; it ends what Python cannot
    # interrupt.
    outcomes = in_parallel(chunks, steps, 10.0 * limit)
    next(steps, None)  # lets a progress bar come to its end

    def judged(solver: Solver, numbers: Iterable[int], tolerance: float) -> Score:
        pairs = [
            (with_known(chosen[i], **known[i].value), _result(outcomes[solver.name, i], limit))
            for i in numbers
        ]
        return Score(
            solver.name,
            tolerance,
            [score.judge_case(case, result, tolerance) for case, result in pairs],
        )

    hard = [i for i, case in enumerate(chosen) if case.group in GROUPS]
    ours = [judged(solver, hard, OUR_TOLERANCE) for solver in able if solver in OURS]
    violations = [violation for own in ours for violation in _violations(own)]
    return {
        "machine": machine(),
        "limit_s": limit,
        "skipped": {solver.name: solver.missing for solver in solvers if solver.missing},
        "scores": [judged(solver, range(len(chosen)), SCORE_TOLERANCE) for solver in able],
        "ours": ours,
        "ok": not violations,
        "violations": violations,
    }


def _violations(own: Score) -> list[str]:
    """Return a line for each case in which a solver of symosc's own did not keep the bound.

    Cases that took too long are left out.
    """
    lines = []
    for case in own.cases:
        if case.wrong:
            lines.append(f"{own.name}: {case.name}: {case.wrong[0]}")
        elif case.note and not case.note.startswith(TOO_LONG):
            lines.append(f"{own.name}: {case.name}: {case.note}")
    return lines


def answers_of(case: ReferenceCase) -> Record:
    """Return a case's known events and condition numbers.

    Solvers give no derivatives here, so those of the case are not computed.
    """
    return {
        "events": case.events,
        "conditions": case.conditions,
        "derivatives": ({},) * len(case.events),
    }


def found_by(solver: Solver, case: ReferenceCase, limit: float) -> list[Any] | None:
    """Return the events that a solver finds in a case; None if it takes longer than `limit`."""
    try:
        with processor_limit(limit):
            return list(solver.prepare(case.scene, solver.tolerances[-1])())
    except TimeoutError:
        return None


def _result(outcome: Outcome, limit: float) -> CaseResult:
    """Return the events in a solver's outcome, or a note why there are none, such as more than
    `limit` seconds.
    """
    if outcome.failure == HANG or (not outcome.failure and outcome.value is None):
        return CaseResult(note=f"{TOO_LONG} {limit:g} s")
    if "chatters" in outcome.failure:
        return CaseResult(note="chatters")
    if outcome.failure:
        return CaseResult(note="gives up")
    if not all(isfinite(event.t) and isfinite(event.x) for event in outcome.value):
        return CaseResult(note="not finite")
    events = sorted(outcome.value, key=lambda event: (event.t, event.x))
    return CaseResult(
        [
            GivenEvent(Fraction(event.t), Fraction(event.x), event.kind, event.boundary)
            for event in events
        ]
    )


def our_verdict(result: Record) -> str:
    """Return a sentence: how many hard cases symosc solved within its bound; or list the cases
    where it did not.
    """
    bound = "1e-12, or 100 * condition * 1e-16 where that is more"
    if result["violations"]:
        lines = [f"  {violation}" for violation in result["violations"]]
        return "\n".join([f"Not within {bound}:", *lines])
    parts = []
    for own in result["ours"]:
        text = f"{own.name} {len(own.given)} of {len(own.cases)}"
        errors = [error for case in own.given for error in (case.error_t, case.error_x)]
        measured = [error for error in errors if error is not None]
        if measured:
            text += f", largest error {max(measured):.0e}"
        absent = len(own.cases) - len(own.given)
        if absent:
            text += f", {absent} not finished"
        parts.append(text)
    return f"Hard cases solved within {bound}: {'; '.join(parts)}."


def table(result: Record) -> str:
    """Return the result of `run` as text: a row per case, a row per group, what the numbers mean,
    and the verdicts.
    """
    scores = result["scores"]
    parts = [score.case_table(scores), score.group_table(scores), *score.legend(scores[0])]
    parts += ["\n".join(map(score.verdict, scores)), *not_run(result)]
    return "\n\n".join([*parts, our_verdict(result), sentence(result["machine"])])


def hard_summary(result: Record) -> str:
    """Return a Markdown table with a row per group of hard cases: each solver's score, and what is
    hard about them.
    """
    scores = result["scores"]
    rows = []
    for group, cases in score.by_group(scores[0].cases):
        if group in GROUPS:
            cells = [
                score.group_cell([case for case in of_solver.cases if case.group == group])
                for of_solver in scores
            ]
            rows.append([f"{group} ({len(cases)})", *cells, GROUPS[group]])
    heads = ["group (cases)", *(of_solver.name for of_solver in scores), "what is hard"]
    return tabulate(rows, heads, tablefmt="github", disable_numparse=True)


def as_json(result: Record) -> Record:
    """Return the result of `run` with its scores as dicts, so that it can be written as JSON."""
    plain = {key: [scores.as_dict() for scores in result[key]] for key in ("scores", "ours")}
    return result | plain


def write(path: str | Path, result: Record, command: str) -> list[Path]:
    """Write a page of all scores, which names `command` as its origin, and a plot of all errors.

    Return both paths.
    """
    picture = Path(path).with_suffix(".svg")
    scores = result["scores"]
    parts = [
        "# Scores of solvers on the reference cases",
        f"Set of reference cases: version {SET_VERSION}.",
        f"Made by `{command}`. Each solver of `symosc bench` at its finest tolerance, with at "
        f"most {result['limit_s']:g} s of processor time for a case. {sentence(result['machine'])}",
        f"![The largest error of each case, a mark per solver]({picture.name})",
        *not_run(result),
        "\n".join(f"- {score.verdict(verdict)}" for verdict in scores),
        *score.legend(scores[0]),
        score.group_table(scores, "github"),
        "## All cases",
        score.case_table(scores, "github"),
    ]
    page = "\n\n".join(parts) + "\n"
    return [write_text(path, page), plot.save(plot.score_figure(scores), picture)]
