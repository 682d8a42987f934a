"""Work and precision: time per event and error of every solver, at every tolerance, on the shipped scenes.

All solvers get the same tasks, a scene followed from its start over a number of events, and are compared with the same
run in 40 digits. There are two spans. The errors are measured on a short one, which all solvers get. The times are
measured on a long one, so that the fixed cost of a call does not count, if a solver finishes it soon.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from math import nan
from statistics import median
from typing import Any

from symosc.aliases import Record
from symosc.bench.machine import machine
from symosc.bench.peers import OURS, SOLVERS
from symosc.bench.solvers import Solver
from symosc.bench.speed import floor_s
from symosc.bench.time_limit import FIRST_LIMIT, Outcome, Worker
from symosc.exact import read_exact
from symosc.reference.compare import REFERENCE_DIGITS, FoundEvents, compare, window_of
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

#: Scenes, and how many events the short span has; how many of the long span are compared, and how many it has. What
#: comes after fig8's first 20 events is beyond doubles: its sticks shrink by 3/8 each half period.
SCENE_SPANS = {"fig5": (24, 1000, 10_000), "fig6": (24, 1000, 10_000), "fig8": (20, 20, 20)}
SCENE_SPANS |= {"fig9": (24, 1000, 10_000), "fig10": (24, 1000, 10_000)}
QUICK_SCENE_SPANS = {"fig5": (24, 100, 4_000), "fig8": (20, 20, 20)}
#: Seconds that a solver may take for one span.
SPAN_LIMIT, QUICK_SPAN_LIMIT = 20.0, 6.0
# The long span is for solvers that need no more than this many seconds for it.
LONG_RUN = 0.3
# Calls are repeated until they have taken this many seconds ...
BUDGET, QUICK_BUDGET = 0.2, 0.05
# ... but not more often than that, not less than that if a call takes no longer than so many seconds, and not at all if
# it takes longer than a part of the limit.
MOST_REPEATS, LEAST_REPEATS, SHORT_CALL, LONG_CALL_PART = 25, 3, 0.3, 0.1


@dataclass(frozen=True)
class Span:
    """A task: a scene with `count` events, and the first of them, those before the time `until`, in 40 digits."""

    scene: Scene
    count: int
    reference: Sequence[Event]
    until: float


@dataclass(frozen=True)
class Timed:
    """What the worker process reports of a solver on a span; times in seconds.

    Right after each call one closed-form evaluation is timed: some machines change their pace by the second.
    """

    prepare_s: float
    first_call_s: float
    times_s: list[float]
    floors_s: list[float]
    found: list[FoundEvents]


def prepare(solver: Solver, scene: Scene, tolerance: float) -> None:
    """Prepare a solver, so that what is imported and compiled once is there."""
    floor_s()
    follow = solver.prepare(scene, tolerance)
    if solver == OURS:
        follow()  # numba compiles our event loop when it is first called


def measure(solver: Solver, scene: Scene, tolerance: float, until: float, limit: float, budget: float) -> Timed:
    """Prepare a solver and call it once, then again until `budget` seconds are spent; return events before `until`.

    Only what the call itself does is timed: events that it returns as an iterator are read afterwards.
    """
    begin = time.perf_counter()
    follow = solver.prepare(scene, tolerance)
    prepared = time.perf_counter()
    found = follow()
    first = time.perf_counter() - prepared
    least = 0 if first > LONG_CALL_PART * limit else 1 if first > SHORT_CALL else LEAST_REPEATS
    times: list[float] = []
    floors: list[float] = [floor_s()] if not least else []
    while len(times) < least or (least and sum(times) < budget and len(times) < MOST_REPEATS):
        again = time.perf_counter()
        found = follow()
        times.append(time.perf_counter() - again)
        floors.append(floor_s())
    return Timed(prepared - begin, first, times, floors, [event for event in found if not event.t > until])


def run(
    quick: bool = False,
    progress: Callable[[Sequence[Any]], Iterable[Any]] = iter,
    solvers: Sequence[Solver] = SOLVERS,
    scenes: dict[str, tuple[int, int, int]] | None = None,
) -> Record:
    """Measure and return plain data.

    Parameters
    ----------
    quick : bool
        Two scenes, only the finest tolerance of each peer, and no raw peers.
    progress : callable
        Gets the sequence of measurements and returns it as an iterable that may show how far it is.
    solvers, scenes : optional
        In place of all; scenes as in SCENE_SPANS.

    Returns
    -------
    dict
        machine; floor_ns, one closed-form evaluation; limit_s; skipped, solver: why it cannot run here; notes, solver:
        its precautions; and rows, one per scene, solver and tolerance, with
        scene, solver, raw, tolerance;
        failure: "" or what went wrong; the numbers that are then not known are None;
        prepare_s, first_call_s, times_s (all repeats), timed_events: of the longest span that the solver finished;
        floor_ns, over_floor: the floor as it was then (the best), and the median time per event as its multiple;
        us_per_event: so many floors, as long as the best one of the run; over_ours: that by ours;
        error, error_t, error_x: over the short span, the same for all solvers, as in `Comparison`;
        missed, invented, missed_grazes, first_wrong: as in `Comparison`, over the first `compared` events of the
        longest span;
        warnings: what the solver warned of.
    """
    chosen = scenes or (QUICK_SCENE_SPANS if quick else SCENE_SPANS)
    limit, budget = (QUICK_SPAN_LIMIT, QUICK_BUDGET) if quick else (SPAN_LIMIT, BUDGET)
    spans: dict[str, tuple[Span, Span]] = {}
    able = [solver for solver in solvers if not solver.missing and not (quick and solver.raw)]
    plan = [
        (name, solver, tolerance)
        for name in chosen
        for solver in able
        for tolerance in (solver.tolerances[-1:] if quick and solver != OURS else solver.tolerances)
    ]
    rows = []
    with Bench(limit, budget) as bench:
        for name, solver, tolerance in progress(plan):
            if name not in spans:
                spans[name] = _spans(load_scene(name), *chosen[name])
            row = {"scene": name, "solver": solver.name, "raw": solver.raw, "tolerance": tolerance}
            rows.append(row | bench.row(solver, tolerance, *spans[name]))
    floors = [row["floor_ns"] for row in rows if row["floor_ns"]]
    unit = min(floors, default=nan)
    _relate(rows, unit)
    skipped = {solver.name: solver.missing for solver in solvers if solver.missing}
    notes = {solver.name: solver.note for solver in able if solver.note}
    about = {"machine": machine(), "floor_ns": unit, "limit_s": limit}
    return {**about, "skipped": skipped, "notes": notes, "rows": rows}


def span(scene: Scene, count: int, compared: int) -> Span:
    """Return a scene cut off halfway between two events so that it has `count` of them, the first `compared` exact."""

    def until(events: Sequence[Event], number: int) -> float:
        return (float(events[number - 1].t) + float(events[number].t)) / 2

    far = scene.t0 + 10**6
    end = until(simulate(scene, t_end=far, max_events=count + 1).events, count)
    exact = simulate(scene, t_end=far, max_events=compared + 1, digits=REFERENCE_DIGITS).events
    return Span(replace(scene, t_end=read_exact("t_end", end)), count, exact[:compared], until(exact, compared))


def _spans(scene: Scene, short: int, compared: int, long: int) -> tuple[Span, Span]:
    first = span(scene, short, short)
    return first, first if short == long else span(scene, long, compared)


class Bench:
    """A worker process that measures solvers, and what it has already prepared.

    Parameters
    ----------
    limit : float
        Seconds that a solver may take for one span.
    budget : float
        Calls are repeated until they have taken this many seconds.
    """

    def __init__(self, limit: float, budget: float) -> None:
        self.worker, self.limit, self.budget = Worker(), limit, budget
        self.prepared: set[str] = set()  # by this process

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *error: object) -> None:
        self.worker.__exit__(*error)

    def row(self, solver: Solver, tolerance: float, short: Span, long: Span) -> Record:
        """Return the measured part of a row; see `run`."""
        outcome = self._call(solver, tolerance, short)
        row = _times(outcome, short) | _errors(outcome, short)
        failure, warnings = outcome.failure, outcome.warnings
        fast = not failure and row["us_per_event"] * long.count < 1e6 * LONG_RUN
        if fast and long is not short:
            longer = self._call(solver, tolerance, long)
            if longer.failure:
                failure = f"{longer.failure} (in {long.count} events, not in {short.count})"
            else:
                row |= _times(longer, long)
                errors = _errors(longer, long)
                row |= {name: value for name, value in errors.items() if not name.startswith("error")}
            warnings = tuple(dict.fromkeys((*warnings, *longer.warnings)))
        return row | {"failure": failure, "warnings": list(warnings)}

    def _call(self, solver: Solver, tolerance: float, span: Span) -> Outcome:
        if solver.name not in self.prepared:
            outcome = self.worker.call(FIRST_LIMIT, prepare, solver, span.scene, tolerance)
            if outcome.failure:
                return outcome
            self.prepared.add(solver.name)
        task = (solver, span.scene, tolerance, span.until, self.limit, self.budget)
        outcome = self.worker.call(self.limit, measure, *task)
        if outcome.lost:
            self.prepared.clear()
        return outcome


def _times(outcome: Outcome, span: Span) -> Record:
    names = ["prepare_s", "first_call_s", "times_s", "timed_events", "us_per_event", "floor_ns", "over_floor"]
    if outcome.failure:
        return dict.fromkeys(names)
    timed, count = outcome.value, span.count
    times = timed.times_s or [timed.first_call_s]
    per_event = 1e6 / count * median(times)
    multiple = median(a / b for a, b in zip(times, timed.floors_s, strict=True)) / count
    floor = 1e9 * min(timed.floors_s)
    values = (timed.prepare_s, timed.first_call_s, timed.times_s, count, per_event, floor, multiple)
    return dict(zip(names, values, strict=True))


def _errors(outcome: Outcome, span: Span) -> Record:
    names = ("error", "error_t", "error_x", "missed", "invented", "missed_grazes", "first_wrong")
    if outcome.failure:
        return {**dict.fromkeys(names), "compared": len(span.reference)}
    comparison = compare(outcome.value.found, span.reference, window_of(span.scene), float(span.scene.t0))
    return {**{name: getattr(comparison, name) for name in names}, "compared": len(span.reference)}


def _relate(rows: list[Record], unit: float) -> None:
    """Put our time on each scene beside the times, all in units of the floor of their moment, which takes `unit` ns.

    A machine may be half as fast in one minute as in the next, so seconds of different minutes do not compare.
    """
    ours = {row["scene"]: row["over_floor"] for row in rows if row["solver"] == OURS.name}
    for row in rows:
        own, mine = row["over_floor"], ours.get(row["scene"])
        row["over_ours"] = own / mine if own and mine else None
        row["us_per_event"] = 1e-3 * unit * own if own else None
