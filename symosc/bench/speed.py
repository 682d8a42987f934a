"""Benchmarks of what users call, measured in one run.

Calls of a group are measured in turns, because some machines change their pace every second. Times
are the best of the turns, ratios within a group their medians. The unit c is the time of an event
of fig5 that `simulate_many` only counts, on one core. One evaluation of the closed form is timed
too: less than that no event can cost.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, partial
from importlib.util import find_spec
from math import cos, exp, pi, sin
from statistics import median
from tempfile import TemporaryDirectory
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np
from tabulate import tabulate

from symosc.analysis.fitting.fit import fit
from symosc.base.aliases import Number, Record
from symosc.bench import Progress, machine, peers_heyoka, peers_scan, sentence
from symosc.bench.solvers import REFERENCE_DIGITS
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.batch import PIECE_COLUMNS
from symosc.grazing.window import grazing_window, grazing_windows
from symosc.mappings.compiled import compiled_residual
from symosc.mappings.equations import residual
from symosc.model import OSCILLATOR_NAMES, Belt, Oscillator, Parameters, by_name
from symosc.orbits.find import find_orbit
from symosc.scenes import Scene, load_scene
from symosc.simulation.batch import warm
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.loops import CHOICE
from symosc.simulation.motion import Motion
from symosc.simulation.problems import ParameterSets
from symosc.simulation.simulate import read_start, simulate
from symosc.simulation.tables import EventTable
from symosc.simulation.tangents import NAMES
from symosc.simulation.trajectory import Trajectory

FLOOR_EVALUATIONS = 30_000
#: Periods of the motions of an ensemble; samples per period and tolerance of the scan.
PERIODS = 50
SCAN_POINTS = 20
SCAN_ACCURACY = 1e-13
#: The tolerance of heyoka's batches; a looser one saves hardly anything, since callbacks take most
#: of the time.
BATCH_TOLERANCE = 2e-13
ONE_CORE: Record = {"use_numba": True, "workers": 1}
COUNTS = ("events",)
# Seconds: what takes longer is measured once, what takes less several times in a turn.
LONG = 5.0
SHORT = 0.01
MOST_CALLS = 20
CORNERS = (1, 4, 16)


class Call(NamedTuple):
    """A call to measure: the function `action`, called `what` in tables.

    Its time is divided by its number of `units`.

    `per` names a unit, such as an event.
    """

    what: str
    per: str
    action: Callable[[], Any]
    #: None: the events of the result.
    units: float | None = None
    #: Whether the first call is of interest; else a call is made before it is measured.
    once: bool = False


class Group(NamedTuple):
    """Calls that are measured in turns; times are also given as multiples of the first call's."""

    title: str
    calls: Iterable[Call]
    clock: Callable[[], float] = time.process_time


class Sizes(NamedTuple):
    """How large the tasks of the groups are: numbers of events, motions and points."""

    events: int
    starts: int
    derivatives: int
    single_events: int
    stick_ends: int
    stick_motions: int
    points: int
    sweep: int


SIZES = Sizes(200_000, 10_000, 2_000, 100_000, 4, 100, 1_000_000, 300_000)
QUICK_SIZES = Sizes(100_000, 2_000, 500, 10_000, 2, 20, 100_000, 4_000)


def closed_form(count, h, w, Om, P, Q, R, S):
    """Evaluate the underdamped x and x' `count` times, to be timed, and return a sum.

    `h` to `S` are constants of both.
    """
    total = 0.0
    for i in range(count):
        tau = 1e-3 * (i % 3000)
        decay = exp(-h * tau)
        s = sin(w * tau)
        c = cos(w * tau)
        sO = sin(Om * tau)
        cO = cos(Om * tau)
        x = P * sO + Q * cO + decay * (R * c + S * s)
        v = Om * (P * cO - Q * sO) + decay * ((S * w - R * h) * c - (R * w + S * h) * s)
        total += x + v
    return total


@lru_cache(maxsize=1)
def compiled_closed_form() -> Callable[..., float]:
    """Return `closed_form`, compiled like the event loop."""
    import numba

    function: Callable[..., float] = numba.njit(closed_form)
    return function


def floor_s() -> float:
    """Measure the seconds that one evaluation of the closed form takes now."""
    evaluate = partial(compiled_closed_form(), h=0.5, w=0.866, Om=1.0, P=1.0, Q=2.0, R=3.0, S=4.0)
    evaluate(10)
    return _seconds(lambda: evaluate(FLOOR_EVALUATIONS), time.perf_counter) / FLOOR_EVALUATIONS


def _seconds(action: Callable[[], object], clock: Callable[[], float]) -> float:
    """Return the seconds that a call takes, by a clock."""
    begin = clock()
    action()
    return clock() - begin


# -- what is measured ------------------------------------------------------------------------------


def groups(quick: bool = False) -> Iterator[Group]:
    """Yield the groups of calls to measure.

    `quick`: with smaller tasks, and without compiling everything before.
    """
    if quick:
        sizes = QUICK_SIZES
    else:
        sizes = SIZES
        warm()
    each_start = f"starts of fig9, {PERIODS} periods each"
    yield Group("One long motion, events counted", _long_motions(sizes.events))
    yield Group(each_start.capitalize(), _ensemble(sizes.starts))
    yield Group(f"Derivatives, {each_start}", _derivatives(sizes.derivatives))
    for belts, title in ((1, "One belt"), (2, "Two belts")):
        yield Group(f"{title}, {each_start}, counted", _laws(sizes.starts, belts))
    yield Group("simulate", _single_motions(sizes.single_events))
    sticks = _shrinking_sticks(sizes.stick_ends, sizes.stick_motions)
    yield Group("fig8 in simulate_many, to t =", sticks)
    yield Group("Formulas", _residuals(sizes.points))
    yield Group("Orbits and windows", _orbits_and_windows(sizes.points))
    yield Group("Workers, time on the wall", _workers(sizes.starts), time.perf_counter)
    with TemporaryDirectory() as folder:
        if find_spec("xarray"):
            yield Group("Sweep of x0 in fig9", _sweep(sizes.sweep, folder))
        yield Group("New process", _processes(quick, folder), time.perf_counter)


def _long_motions(events: int) -> Iterator[Call]:
    """Yield calls of `simulate_many` that follow one motion for many events."""
    for name in ("fig5", "fig9", "fig10", "fig10, interpreted"):
        scene = load_scene(name.partition(",")[0])
        options = {"max_events": events, **ONE_CORE}
        if "interpreted" in name:
            options = {"max_events": 2_000, "use_numba": False}
        start = [scene.t0, scene.x0, scene.v0]
        far = scene.t0 + 10**7
        yield Call(
            name,
            "event",
            partial(simulate_many, scene.parameters, start, far, record=COUNTS, **options),
        )


def _starts(count: int, name: str = "fig9") -> tuple[Parameters, np.ndarray, np.ndarray]:
    """Return the parameters of a scene, random starts, and end times `PERIODS` periods of the drive
    later.
    """
    p = load_scene(name).parameters
    rng = np.random.default_rng(1)
    period = 2 * pi / float(p.Omega)
    starts = np.column_stack(
        [rng.uniform(0, period, count), rng.uniform(-5, 5, count), rng.uniform(-5, 5, count)]
    )
    return p, starts, starts[:, 0] + PERIODS * period


def _ensemble(count: int) -> Iterator[Call]:
    """Yield calls of `simulate_many` and other solvers that count the events of many motions or
    return them.
    """
    p, starts, ends = _starts(count)
    follow = partial(simulate_many, p, starts, ends, **ONE_CORE)
    yield Call("events counted", "event", partial(follow, record=COUNTS))
    for name in ("fig5", "fig10"):
        counted = partial(simulate_many, *_starts(count, name), record=COUNTS, **ONE_CORE)
        yield Call(f"events counted, {name}", "event", counted)
    yield Call("rows of events", "event", follow)
    yield Call("words", "event", partial(follow, record=("events", "word", "multiplicity")))
    yield Call("all columns of a summary", "event", partial(follow, record="summary"))
    columns: Record = by_name(p, float)
    columns["Omega"] = np.random.default_rng(2).uniform(0.9, 1.1, count) * float(p.Omega)
    sets = ParameterSets(columns)
    loops = CHOICE.of_many(True).table
    made = partial(sets.table, slice(0, count), loops)
    yield Call("constants of as many values of Omega", "set", made, count)
    swept = partial(
        simulate_many, columns, (0, 0, 0), PERIODS * 2 * pi / columns["Omega"], **ONE_CORE
    )
    yield Call("as many values of Omega, counted", "event", partial(swept, record=COUNTS))
    yield Call("as many values of Omega, all columns", "event", partial(swept, record="summary"))
    t0, _, _ = starts.T
    durations = ends - t0
    scan = peers_scan.count_many(p, starts, durations, SCAN_POINTS, SCAN_ACCURACY)
    yield Call(f"closed form, scan of {SCAN_POINTS} points, numba", "event", scan)
    if find_spec("heyoka"):
        batches = peers_heyoka.count_many(p, starts, durations, BATCH_TOLERANCE)
        yield Call("heyoka, motions in batches, counted", "event", batches)


def _derivatives(count: int) -> Iterator[Call]:
    """Yield calls of `simulate_many` with and without derivatives, and a call of `fit` for three
    parameters.
    """
    follow = partial(simulate_many, *_starts(count), **ONE_CORE)
    yield Call("rows of events", "event", follow)
    for last in ("mu1", "Omega"):
        wrt = "t0", "x0", "v0", last
        yield Call(f"with derivatives by {', '.join(wrt)}", "event", partial(follow, wrt=wrt))
    yield Call("by all parameters and the start", "event", partial(follow, wrt=NAMES))
    scene = load_scene("fig5")
    far = simulate(scene, t_end=3_200).events[:1_000]
    noise = np.random.default_rng(1).normal(0, 1e-4, len(far)).tolist()
    data = [(event.t + error, event.kind) for event, error in zip(far, noise, strict=True)]
    first = {"mu1": 0.81, "c": float(scene.parameters.c) * 1.01}
    call = partial(fit, scene, data, ("mu1", "c", "FN"), sigma=1e-4, start=first)
    yield Call("fit of 3 parameters to 1,000 events of fig5", "call", call, 1)


def _laws(count: int, belts: int) -> Iterator[Call]:
    """Yield calls of `simulate_many` that count events with the belts of fig9, or the first of
    them: with Coulomb friction, static friction, and curves with more and more corners.
    """
    p, starts, ends = _starts(count)
    shared: Record = {name: getattr(p, name) for name in OSCILLATOR_NAMES}
    own = p.law.belts[:belts]
    laws = {
        "mu_s = mu": [Belt(belt.v, belt.mu) for belt in own],
        "static friction, mu_s = 1.1 mu": [
            Belt(belt.v, belt.mu, mu_s=Fraction(11, 10) * belt.mu) for belt in own
        ],
    }
    for corners in CORNERS:
        laws[f"curves with {corners} corners"] = [_with_corners(belt, corners) for belt in own]
    for what, of_law in laws.items():
        law = Oscillator(**shared, belts=of_law)
        crossed = _corners_crossed(law, starts[0], float(ends[0]))
        if crossed:
            what = f"{what}, {crossed:.2g} crossed an event"
        call = partial(simulate_many, law, starts, ends, record=COUNTS, **ONE_CORE)
        yield Call(what, "event", call)


def _with_corners(belt: Any, corners: int) -> Belt:
    """Return a belt whose friction falls by a tenth in so many unequal steps over one unit of speed."""
    points = [(Fraction(0), belt.mu)]
    for n in range(1, corners + 1):
        w = Fraction(n, corners)
        points.append((w, belt.mu * (1 - w * (2 - w) / 10)))
    return Belt(belt.v, curve=points)


def _corners_crossed(law: Oscillator, start: np.ndarray, t_end: float) -> float:
    """Return how many corners a motion crosses per event."""
    t0, x0, v0 = start.tolist()
    motion = simulate(law, t0=t0, x0=x0, v0=v0, t_end=t_end)
    corners = [float(edge.v) for edge in law.edges if not edge.belts]
    begins = motion._pieces[PIECE_COLUMNS.index("v")]
    return np.count_nonzero(np.isin(begins, corners)) / len(motion.events)


def _single_motions(most: int) -> Iterator[Call]:
    """Yield the calls that follow one motion, the longest one with `most` events."""
    fig5 = load_scene("fig5")
    fig8 = load_scene("fig8")
    far = replace(fig5, t_end=fig5.t0 + 10**7)
    for count in (10, 1_000, most):
        yield Call(f"fig5, {count:,} events", "event", partial(simulate, far, max_events=count))
    yield Call("fig5 by its name, 16 events", "call", partial(simulate, "fig5"), 1)
    yield Call("fig5, 30 digits", "event", partial(simulate, fig5, digits=30))
    yield Call(
        "fig5, as many digits, all by mpmath",
        "event",
        partial(_in_mpmath, fig5, 40),
        len(simulate(fig5).events),
    )
    yield Call("fig8", "event", partial(simulate, fig8))
    yield Call("fig8, accuracy=1e-9", "event", partial(simulate, fig8, accuracy=1e-9))


def _in_mpmath(scene: Scene, digits: int) -> None:
    """Follow a motion with mpmath's numbers throughout, also in the search for events."""
    of_scene = dict.fromkeys(("t0", "x0", "v0", "t_end"))
    arithmetic = MpArithmetic(scene.parameters, digits, fast=False)
    motion = Motion(read_start(scene, of_scene, None), arithmetic)
    while not motion.ended:
        motion.step()


def _shrinking_sticks(ends: int, motions: int) -> Iterator[Call]:
    """Yield calls for fig8 up to `ends` end times: its sticks shrink, and later need more digits."""
    scene = load_scene("fig8")
    for t_end in (9, 27, 60, 200)[:ends]:
        if t_end < 30:
            count = motions
        else:
            count = max(motions // 20, 1)
        starts = [(scene.t0, scene.x0, scene.v0)] * count
        follow = partial(simulate_many, scene.parameters, starts, t_end, **ONE_CORE)
        yield Call(str(t_end), "event", follow)


def _residuals(points: int) -> Iterator[Call]:
    """Yield calls that evaluate the residuals of P3 at many points."""
    p = load_scene("fig9").parameters
    rng = np.random.default_rng(0)
    x_i, x_j = rng.uniform(-5, 5, (2, points))
    theta_i = rng.uniform(0, 6.28, points)
    theta_j = theta_i + float(p.Omega) * rng.uniform(0.01, 2, points)
    arguments = (x_i, theta_i, x_j, theta_j)
    by_sympy = "by sympy's lambdify, "
    functions: dict[str, Callable[..., Any]] = {
        f" {by_sympy}with common subexpressions": lambdified(p, cse=True),
        f" {by_sympy}as it stands": lambdified(p, cse=False),
        "": lambda *_: residual(p, "P3", (x_i, theta_i), (x_j, theta_j)),
        ", compiled": compiled_residual(p, "P3", jacobian=False),
        ", compiled, with its Jacobian": compiled_residual(p, "P3", jacobian=True),
    }
    for name, function in functions.items():
        yield Call(f"residual of P3{name}", "point", partial(function, *arguments), points)


def lambdified(p: Parameters, cse: bool) -> Callable[..., Any]:
    """Return P3's residual, compiled by sympy's lambdify from the underdamped closed form with
    numbers put in.
    """
    import sympy

    from symosc.engine.flow import constants
    from symosc.symbolic import maps, solution

    K = constants(p)
    flow = solution.flow(solution.REGIMES["underdamped"])
    start = {solution.a_i: solution.acceleration(solution.x_i, solution.v_i, solution.theta_i)}
    numbers = {
        solution.h: K.h,
        solution.omega_d: K.omega_d,
        solution.Omega: K.Om,
        solution.f0: K.f0,
        solution.cm: K.cm,
    }
    numbers |= {
        solution.w0sq: K.w0sq,
        solution.A_m: K.A2,
        solution.v_i: K.belt1.v,
        maps.v_j: K.belt1.v,
    }
    tau = (maps.theta_j - solution.theta_i) / K.Om
    formulas = [flow.x.xreplace(start) - maps.x_j, flow.v.xreplace(start) - maps.v_j]
    formulas = [formula.xreplace(numbers).subs(solution.tau, tau) for formula in formulas]
    arguments = (solution.x_i, solution.theta_i, maps.x_j, maps.theta_j)
    function: Callable[..., Any] = sympy.lambdify(arguments, formulas, "numpy", cse=cse)
    return function


def _orbits_and_windows(points: int) -> Iterator[Call]:
    """Yield calls that find an orbit or grazing windows."""
    p = load_scene("fig10").parameters
    guess = [(round(point.t, 1), round(point.x, 1)) for point in find_orbit(p, "P6454").points]
    yield Call(
        "orbit P6454 of fig10 from a guess of one decimal",
        "call",
        partial(find_orbit, p, "P6454", guess=guess),
        1,
    )
    yield Call("without a guess", "call", partial(find_orbit, p, "P6454"), 1)
    q = load_scene("fig9").parameters
    speeds = np.random.default_rng(1).uniform(-20, 20, points)
    changed = (q.replace(v1=Fraction(n, 7)) for n in range(1, 10**6))

    def exact() -> None:
        window = grazing_window(next(changed), "P3")
        _ = window.phases, window.theta_cr, window.intervals

    yield Call("grazing window, exact", "call", exact, 1)
    yield Call(
        "grazing windows of floats", "window", partial(grazing_windows, q, "P3", v1=speeds), points
    )


def _workers(count: int) -> Iterator[Call]:
    """Yield the same call of `simulate_many` with one and with two threads."""
    p, starts, ends = _starts(count)
    for workers in (1, 2):
        call = partial(
            simulate_many, p, starts, ends, record=COUNTS, use_numba=True, workers=workers
        )
        name = "1 worker" if workers == 1 else f"{workers} workers"
        yield Call(name, "motion", call, count)


def _sweep(motions: int, folder: str) -> Iterator[Call]:
    """Yield the calls that follow many motions: without a sweep, and as one that writes files."""
    from symosc.sweeps.sweep import sweep

    scene = load_scene("fig9")
    values = np.linspace(-5, 5, motions)
    record = ("word", "events")
    p: Record = by_name(scene.parameters)
    starts = {"t0": scene.t0, "x0": values, "v0": scene.v0}
    t_end = float(scene.t0) + PERIODS * 2 * pi / float(p["Omega"])
    paths = (f"{folder}/{i}.nc" for i in range(100))
    bare = partial(simulate_many, p, starts, t_end, record=(*record, "status"))
    yield Call("the bare call of simulate_many", "motion", bare, motions)

    def written() -> object:
        file = next(paths)
        return sweep(scene, {"x0": values}, t_end=f"{PERIODS}T", record=record, path=file)

    yield Call("sweep, written as netCDF", "motion", written, motions)


def _processes(quick: bool, cache: str) -> Iterator[Call]:
    """Yield calls of commands in new processes.

    Unless `quick`, one must compile all code, into the folder `cache`.
    """
    many = (
        "import symosc; symosc.simulate_many(symosc.load_scene('fig9').parameters, (0, 0, 0), 30, "
        "use_numba=True)"
    )
    commands: list[tuple[str, tuple[str, ...], dict[str, str]]] = [
        ("import numpy", ("-c", "import numpy"), {}),
        ("symosc simulate fig5", ("-m", "symosc", "simulate", "fig5"), {}),
        ("a first simulate_many, compiled loops in the cache", ("-c", many), {}),
        ("a first simulate_many, no cache", ("-c", many), {"NUMBA_CACHE_DIR": cache}),
    ]
    if quick:
        commands = commands[:3]
    for what, arguments, changes in commands:
        options: Record = {"check": True, "capture_output": True, "env": os.environ | changes}
        yield Call(
            what,
            "call",
            partial(subprocess.run, [sys.executable, *arguments], **options),
            1,
            bool(changes),
        )


# -- measuring -------------------------------------------------------------------------------------


def run(quick: bool = False, progress: Progress = iter) -> Record:
    """Return times of all `groups` and errors of `simulate` as plain data.

    `quick`: fewer repeats, smaller tasks.
    """
    # Keys: machine; floor_ns, one evaluation of the closed form; c_ns, the time of a counted event
    # of fig5; errors (`measure_errors`); groups, each with a title and rows: what, per (the unit),
    # s (seconds per unit), over_c, and over_first (as a multiple of the group's first row).
    repeats = 3 if quick else 7
    measured = [_measured(group, repeats, progress) for group in groups(quick)]
    # The first call of the first group counts the events of fig5: its unit is an event.
    c = measured[0]["rows"][0]["s"]
    for row in (row for group in measured for row in group["rows"]):
        row["over_c"] = row["s"] / c
    about = {
        "machine": machine(),
        "floor_ns": 1e9 * min(floor_s() for _ in range(20)),
        "c_ns": 1e9 * c,
    }
    return about | {"errors": measure_errors(), "groups": measured}


def _measured(group: Group, repeats: int, progress: Progress) -> Record:
    """Measure the calls of a group in turns, after a first call of each."""
    calls = list(group.calls)
    clock = group.clock
    units = list[float]()  # how many each call has
    lengths = list[float]()  # seconds of each call
    for call in calls:
        begin = clock()
        result = call.action()
        first = clock() - begin
        if call.units is None:
            units.append(_events_of(result))
        else:
            units.append(call.units)
        if call.once:
            lengths.append(first)
        else:
            lengths.append(max(_seconds(call.action, clock), 1e-6))
    times: list[list[float]] = [[] for _ in calls]  # of each call, seconds per unit in each turn
    for turn in progress(range(repeats)):
        for call, length, unit, call_times in zip(calls, lengths, units, times, strict=True):
            if call.once:
                call_times.append(length / unit)
            elif turn == 0 or length <= LONG:
                # A short call is made again: the best of several is hardly disturbed.
                count = min(MOST_CALLS, 1 + int(SHORT / length))
                call_times.append(min(_seconds(call.action, clock) for _ in range(count)) / unit)
    rows = []
    for call, call_times in zip(calls, times, strict=True):
        # Ratios of the same turn: the machine's pace is then that of both.
        ratio = median(time / first for time, first in zip(call_times, times[0], strict=False))
        row = {"what": call.what, "per": call.per, "s": min(call_times), "over_first": ratio}
        rows.append(row)
    return {"title": group.title, "rows": rows}


def _events_of(result: Any) -> int:
    """Return the number of events of a motion, a table of events, a summary or counts."""
    if isinstance(result, EventTable):
        return len(result)
    if isinstance(result, Trajectory):
        return len(result.events)
    return int(np.sum(getattr(result, "events", result)))


def measure_errors() -> list[Record]:
    """Return, for four scenes, the largest error of `simulate` against 40 digits, and its largest
    error estimate.
    """
    # Errors are of times and positions, relative to max(1, |value|).

    def relative(error: Number, value: Number) -> float:
        return float(abs(error) / max(1, abs(value)))

    rows = []
    for name in ("fig5", "fig8", "fig9", "fig10"):
        scene = load_scene(name)
        events = simulate(scene).events
        exact_events = simulate(scene, digits=REFERENCE_DIGITS).events
        errors = []
        estimates = []
        for event, exact in zip(events, exact_events, strict=True):
            errors.append(relative(event.t - exact.t, exact.t))
            errors.append(relative(event.x - exact.x, exact.x))
            estimates.append(relative(event.t_error, event.t))
            estimates.append(relative(event.x_error, event.x))
        row: Record = {"scene": name, "events": len(events)}
        rows.append(row | {"error": max(errors), "estimate": max(estimates)})
    return rows


# -- tables ----------------------------------------------------------------------------------------


def duration(seconds: float) -> str:
    """Return a time in the unit that fits it, such as "12.3 ms"."""
    for unit, name in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= unit:
            return f"{float(f'{seconds / unit:.3g}'):g} {name}"
    return f"{1e9 * seconds:.3g} ns"


def measurement_note(result: Record) -> str:
    """Return the paragraph below the speed tables: the machine, and the times of an event and of
    one closed form.
    """
    text = (
        f"One run of `symosc bench` ({sentence(result['machine'])}). "
        f"c = {result['c_ns']:.0f} ns is the cost of one event when `simulate_many` merely counts "
        "the events of fig5, on one core; one closed form (an exp, two sine-cosine pairs) takes "
        f"{result['floor_ns']:.1f} ns."
    )
    return fill(text, 120, break_long_words=False, break_on_hyphens=False)


#: What the README says of the speed: group, row, and how a sentence calls that.
BRIEF = (
    ("One long motion, events counted", "fig5", "where a long motion is only counted"),
    ("simulate", "fig5, 1,000 events", "in `simulate`"),
    ("simulate", "fig5, 30 digits", "with 30 digits"),
    ("New process", "symosc simulate fig5", "for `symosc simulate fig5` as a whole"),
)


def brief(result: Record) -> str:
    """Return the README's sentence about speed, which has only the rows listed in BRIEF."""
    measured = {
        (group["title"], row["what"]): row for group in result["groups"] for row in group["rows"]
    }
    times = [
        f"{_time_text(measured[title, what])} {words}"
        for title, what, words in BRIEF
        if (title, what) in measured
    ]
    about = result["machine"]
    return (
        f"Fig. 5 of the paper takes {', '.join(times)} ({about['processor']}, one core, "
        f"{about['date']})."
    )


def _time_text(row: Record) -> str:
    if row["per"] == "call":
        return duration(row["s"])
    return f"{duration(row['s'])} per {row['per']}"


def table(result: Record, form: str = "simple") -> str:
    """Return the result of `run` as text, in a form of tabulate: a table of all groups, and one of
    errors.
    """
    markdown = form == "github"
    rows = []
    for group in result["groups"]:
        if markdown:
            title = f"**{group['title']}**"
        else:
            title = f"{group['title']}:"
        rows.append([title, "", "", ""])
        for row in group["rows"]:
            ratios = (f"{float(f'{row[key]:.3g}'):g}" for key in ("over_first", "over_c"))
            rows.append([row["what"], _time_text(row), *ratios])
    errors = [
        [row["scene"], row["events"], f"{row['error']:.1e}", f"{row['estimate']:.1e}"]
        for row in result["errors"]
    ]
    heads = ["scene", "events compared", "largest error", "estimated error"]
    options: Record = {
        "tablefmt": form,
        "disable_numparse": True,
        "colalign": ("left", "right", "right", "right"),
    }
    parts = []
    if not markdown:
        parts.append(measurement_note(result))
    parts += [tabulate(rows, ["", "time", "times the group's first", "times c"], **options)]
    parts += [tabulate(errors, heads, **options)]
    parts.append(
        f"Errors of times and positions against {REFERENCE_DIGITS} digits, relative to "
        "max(1, |value|)."
    )
    return "\n\n".join(parts)
