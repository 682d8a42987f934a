"""Numerical stability: every solver at its finest tolerance on the hard cases, beside the condition of each case.

A solver follows a case in a process of its own, within a time limit. Its events are compared with the reference: the
proven enclosures of the events (`symosc.certify`), or 40 digits where there is no proof. What it makes of the case is
an error, or what went wrong. Ours must be within

    max(1e-12, 100 * condition * 1e-16)

at every event: as good as doubles can be where the case is well-conditioned, and elsewhere as good as the rounding of
its numbers allows.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from queue import Queue
from threading import Event as Flag
from time import perf_counter
from typing import Any, NamedTuple

from symosc.aliases import Number, Record
from symosc.bench import ours
from symosc.bench.hard_table import cell_text, legend, summary, table
from symosc.bench.machine import machine
from symosc.bench.peers import SOLVERS
from symosc.bench.solvers import Solver
from symosc.bench.time_limit import FIRST_LIMIT, HANG, Outcome, Worker
from symosc.certificates.certify import Known, ProvenMiddle, known_events
from symosc.engine.arithmetic import mp_context
from symosc.reference.case import conditions
from symosc.reference.cases import HardCase, hard_cases
from symosc.reference.compare import REFERENCE_DIGITS, FoundEvents, compare, relative_error, window_of
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

__all__ = ["judge", "legend", "run", "summary", "table"]

WELL = 1e-12
INPUT_ROUNDING, CONDITION_FACTOR = 1e-16, 100.0
#: Seconds for a case, the solver's preparation included.
CASE_LIMIT, QUICK_CASE_LIMIT = 4.0, 2.0
OURS_DIGITS = 20
PROCESSES = min(2, os.cpu_count() or 1)

MPMATH = ours.SOLVERS[1].name


def bound(condition: float) -> float:
    """Return the error that ours may have at an event with that condition number."""
    return max(WELL, CONDITION_FACTOR * condition * INPUT_ROUNDING)


# -- in the worker process ---------------------------------------------------------------------------------------------


@lru_cache(maxsize=256)
def proof_of(case: HardCase) -> Known:
    """Return the proven events of a case, or why there are none; a process computes them once."""
    return known_events(case.scene)


@lru_cache(maxsize=256)
def reference_of(case: HardCase) -> Sequence[Event | ProvenMiddle]:
    """Return the events of a case, proven if they can be; a process computes them once."""
    known, mp = proof_of(case), mp_context(REFERENCE_DIGITS)
    if known.reason:
        return case.reference()

    def number(value: Any) -> Number:
        return mp.mpf(value.numerator) / value.denominator

    return [event._replace(t=number(event.t), x=number(event.x)) for event in known.events]


def conditions_of(case: HardCase) -> list[float]:
    """Return the condition numbers of a case's events."""
    return conditions(case.scene, case.reference)


def about(case: HardCase) -> tuple[list[float], str]:
    """Return the condition numbers of a case's events, and why they are not proven ("" if they are)."""
    return conditions_of(case), proof_of(case).reason


def judge(solver: Solver, case: HardCase, allowed: Sequence[float]) -> Record:
    """Return how the events that a solver finds compare with the reference.

    Parameters
    ----------
    solver : Solver
    case : HardCase
    allowed : sequence of float
        The error that each event may have.

    Returns
    -------
    dict
        error (None if no event matched), missed, invented, found (how many events), worst (the largest ratio of an
        error to what is allowed; None if events are missed or invented) and undecidable (None, or how many events ours
        found before it said that it cannot go on).
    """
    if solver.name == MPMATH:  # unrounded
        found: Sequence[FoundEvents] = [
            FoundEvents(e.t, e.x, e.kind, e.boundary) for e in simulate(case.scene, digits=OURS_DIGITS).events
        ]
    else:
        found = solver.prepare(case.scene, solver.tolerances[-1])()
    reference = reference_of(case)
    absent = 0
    if case.periods:  # all events are counted, those of the last period are compared
        count, found = len(found), sorted(found, key=lambda event: event.t)[-len(reference) :]
        absent = case.periods * len(reference) - count
    t0 = float(case.scene.t0)
    result = compare(found, reference, window_of(case.scene), t0)
    worst = None
    if result.complete and not result.missed_grazes and not absent:
        pairs = zip(found, reference, strict=True)
        errors = [max(relative_error(a.t, b.t, t0), relative_error(a.x, b.x)) for a, b in pairs]
        worst = max((error / most for error, most in zip(errors, allowed, strict=True)), default=0.0)
    undecidable = None
    if solver in ours.SOLVERS and not result.complete and simulate(case.scene).status == "undecidable":
        undecidable = len(found)
    return {
        "error": result.error,
        "missed": result.missed + max(absent, 0),
        "invented": result.invented + max(-absent, 0),
        "found": len(found),
        "worst": worst,
        "undecidable": undecidable,
    }


# -- the run -----------------------------------------------------------------------------------------------------------


class Job(NamedTuple):
    """A call in a worker, and where its result goes."""

    key: Hashable
    function: Callable[..., Any]
    arguments: tuple[object, ...]


def run(
    quick: bool = False,
    progress: Callable[[Sequence[Any]], Iterable[Any]] = iter,
    solvers: Sequence[Solver] = SOLVERS,
    cases: Sequence[HardCase] | None = None,
) -> Record:
    """Run all solvers on all cases and return plain data.

    Parameters
    ----------
    quick : bool
        Fewer cases, a shorter time limit, and no raw peers (which get only these cases anyway).
    progress : callable
        Gets a sequence of steps and returns it as an iterable that may show how far it is.
    solvers, cases : optional
        In place of all.

    Returns
    -------
    dict
        machine, limit_s, solvers (name, raw, tolerance, note, ours), skipped
        (solver: why it cannot run here), rows, ok (whether ours kept the bound in every case) and violations (the
        cases where it did not). A row has group, case, events (of the reference, all events of a long run), condition
        (the largest of its events, None if there are none), open (why the reference is not proven) and cells: solver
        name to what `judge` returns, with failure ("" or what went wrong, as `symosc.bench.time_limit.Outcome` says)
        and seconds (with preparation).
    """
    limit = QUICK_CASE_LIMIT if quick else CASE_LIMIT
    chosen = [case for case in hard_cases() if case.quick or not quick] if cases is None else list(cases)
    able = [solver for solver in solvers if not solver.missing and not (quick and solver.raw)]
    chunks = [[Job(i, about, (chosen[i],)) for i in range(k, len(chosen), PROCESSES)] for k in range(PROCESSES)]
    plan = {s.name: [i for i, case in enumerate(chosen) if case.quick or not s.raw] for s in able}
    steps = iter(progress(range(len(chosen) + sum(map(len, plan.values())))))
    known = {i: _value(outcome) for i, outcome, _ in in_parallel(chunks, FIRST_LIMIT, None, steps)}
    allowed = [[bound(condition) for condition in known[i][0]] for i in range(len(chosen))]
    chunks = [[Job((i, s.name), judge, (s, chosen[i], allowed[i])) for i in plan[s.name]] for s in able]
    cells = {
        key: _cell(outcome) | {"seconds": time} for key, outcome, time in in_parallel(chunks, limit, FIRST_LIMIT, steps)
    }
    next(steps, None)  # lets a progress bar come to its end
    rows = [
        _row(case, known[i][0], known[i][1], {s.name: cells[i, s.name] for s in able if i in plan[s.name]})
        for i, case in enumerate(chosen)
    ]
    wrong = violations(rows)
    return {
        "machine": machine(),
        "limit_s": limit,
        "solvers": [
            {"name": s.name, "raw": s.raw, "tolerance": s.tolerances[-1], "note": s.note, "ours": s in ours.SOLVERS}
            for s in able
        ],
        "skipped": {solver.name: solver.missing for solver in solvers if solver.missing},
        "rows": rows,
        "ok": not wrong,
        "violations": wrong,
    }


def in_parallel(
    chunks: Sequence[Sequence[Job]], limit: float, first_limit: float | None, steps: Any
) -> list[tuple[Any, Outcome, float]]:
    """Run each chunk of jobs in a worker of its own, PROCESSES at a time; return keys, outcomes and seconds.

    With `first_limit` the first job of a new process may take that long: it imports and compiles. So the first job of
    a chunk is done again where a process was lost, and does not count.
    """
    results: Queue[Any] = Queue()
    stop = Flag()

    def follow(chunk: Sequence[Job]) -> None:
        with Worker() as worker:
            fresh = bool(first_limit)
            for job in chunk:
                if stop.is_set():
                    return
                if fresh and first_limit:
                    worker.call(first_limit, chunk[0].function, *chunk[0].arguments)
                begin = perf_counter()
                outcome = worker.call(limit, job.function, *job.arguments)
                seconds = perf_counter() - begin
                fresh = outcome.lost
                results.put((job.key, outcome, seconds))

    def guarded(chunk: Sequence[Job]) -> None:
        try:
            follow(chunk)
        except BaseException as error:  # the main thread is to see it, whatever it is
            results.put(error)

    done = []
    with ThreadPoolExecutor(PROCESSES) as pool:
        try:
            for chunk in chunks:
                pool.submit(guarded, chunk)
            for _ in range(sum(map(len, chunks))):
                next(steps, None)
                result = results.get()
                if isinstance(result, BaseException):
                    raise result
                done.append(result)
        finally:
            stop.set()
    return done


def _value(outcome: Outcome) -> Any:
    if outcome.failure:
        raise RuntimeError(f"no condition numbers: {outcome.failure}")
    return outcome.value


def _cell(outcome: Outcome) -> Record:
    names = ("error", "missed", "invented", "found", "worst", "undecidable")
    return {"failure": outcome.failure, **(outcome.value or dict.fromkeys(names))}


def _row(case: HardCase, known: Sequence[float], reason: str, cells: Record) -> Record:
    count = len(known) * max(case.periods, 1)
    condition = max(known, default=None)
    row = {"group": case.group, "case": case.name, "events": count, "condition": condition, "open": reason}
    return row | {"cells": cells}


def violations(rows: Sequence[Record]) -> list[str]:
    """Return where ours missed or invented an event or had too large an error; what took too long is left out."""
    found = []
    for row in rows:
        for solver in ours.SOLVERS:
            cell = row["cells"].get(solver.name)
            if cell is None or cell["failure"] == HANG:
                continue
            if cell["failure"] or cell["worst"] is None or cell["worst"] > 1:
                found.append(f"{solver.name}: {row['group']}, {row['case']}: {cell_text(cell, 0)}")
    return found
