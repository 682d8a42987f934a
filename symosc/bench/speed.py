"""Benchmarks of speed and error: motions, formulas, digits, ensembles and sweeps, measured in one run.

The unit is one evaluation of the closed-form flow: one exp, the sine and cosine of two angles, and the arithmetic that
makes position and velocity of them. It is timed in the same process, right after what is measured, because some
machines change their pace every second. Times are the best of several repeats, ratios their median; a first call, which
compiles or loads the compiled code, is reported apart. Each table below shows what the `measure_` function before it
returns.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache, partial
from importlib.util import find_spec
from math import cos, exp, inf, pi, sin
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from textwrap import fill
from typing import Any

import numpy as np
from tabulate import tabulate

from symosc.aliases import Number, Record
from symosc.bench import machine, sentence
from symosc.engine.arithmetic import compiled
from symosc.errors import MissingExtraError
from symosc.grazing.window import grazing_window, grazing_windows
from symosc.mappings.compiled import compiled_residual
from symosc.mappings.equations import residual
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.find import find_orbit
from symosc.reference.compare import REFERENCE_DIGITS
from symosc.scenes import load_scene
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.simulate import simulate

FLOOR_EVALUATIONS = 30_000


def floor(count, h, w, Om, P, Q, R, S):
    """Evaluate the closed form x = P sin + Q cos + exp (R cos + S sin), and its derivative, `count` times."""
    total = 0.0
    for i in range(count):
        tau = 1e-3 * (i % 3000)
        decay, s, c, sO, cO = exp(-h * tau), sin(w * tau), cos(w * tau), sin(Om * tau), cos(Om * tau)
        x = P * sO + Q * cO + decay * (R * c + S * s)
        v = Om * (P * cO - Q * sO) + decay * ((S * w - R * h) * c - (R * w + S * h) * s)
        total += x + v
    return total


@lru_cache(maxsize=1)
def compiled_floor() -> Callable[..., float]:
    """Return `floor`, compiled if numba is there, as the event loop is."""
    try:
        import numba
    except ImportError:
        return floor
    return numba.njit(floor)


def floor_s() -> float:
    """Return the seconds per evaluation of the closed form at present."""
    evaluate, arguments = compiled_floor(), (0.5, 0.866, 1.0, 1.0, 2.0, 3.0, 4.0)
    evaluate(10, *arguments)
    return best(lambda: evaluate(FLOOR_EVALUATIONS, *arguments), 1) / FLOOR_EVALUATIONS


def best(action: Callable[[], object], repeats: int) -> float:
    """Return the shortest time of several calls, in seconds."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return min(times)


def in_turns(repeats: int, *actions: Callable[[], Any]) -> list[list[float]]:
    """Return the seconds of processor time of each action, measured in turns after a first call of each."""

    def seconds(action: Callable[[], Any]) -> float:
        begin = time.process_time()
        action()
        return time.process_time() - begin

    for action in actions:
        action()
    rounds = [[seconds(action) for action in actions] for _ in range(repeats)]
    return [list(column) for column in zip(*rounds, strict=True)]


def ratio(above: list[float], below: list[float]) -> float:
    """Return the median ratio of times that were measured in turns."""
    return median(a / b for a, b in zip(above, below, strict=True))


# -- single motions, and the start of a process ------------------------------------------------------------------------


def run(quick: bool = False) -> Record:
    """Measure single motions; with `quick` fewer repeats and events.

    Keys: machine, floor_ns, cold_start, formulas (`measure_formulas`), and rows with scene, events, ns_per_event,
    floor_ns, evaluations_per_event (in units of the floor), first_call_s, python_us_per_event, max_error (of event
    times and positions, relative to max(1, |value|), against 40 digits), max_error_estimate (what the events say) and
    compared (the number of events that were compared).
    """
    repeats, events = (3, 100_000) if quick else (7, 200_000)
    rows = [_motion(name, events, repeats) for name in ("fig5", "fig9", "fig10")]
    commands = {"import_numpy_s": ["-c", "import numpy"], "simulate_fig5_s": ["-m", "symosc", "simulate", "fig5"]}
    cold = {
        name: best(partial(subprocess.run, [sys.executable, *each], check=True, capture_output=True), repeats)
        for name, each in commands.items()
    }
    unit = min(row["floor_ns"] for row in rows)
    return {
        "machine": machine(),
        "floor_ns": unit,
        "rows": rows,
        "cold_start": cold,
        "formulas": measure_formulas(quick),
    }


def _motion(name: str, events: int, repeats: int) -> Record:
    scene, python_events = load_scene(name), 2_000
    start, far = [float(scene.t0), float(scene.x0), float(scene.v0)], float(scene.t0) + 1e7

    def many(count: int, use_numba: bool) -> Any:
        return simulate_many(scene.parameters, start, far, max_events=count, use_numba=use_numba)

    row: Record = {"scene": name}
    try:
        compiled()
        row["first_call_s"] = best(lambda: many(10, True), 1)
        pairs = [(best(lambda: many(events, True), 1), floor_s()) for _ in range(repeats)]
        times, floors = ([pair[i] for pair in pairs] for i in (0, 1))
        row |= {"events": events, "ns_per_event": min(times) / events * 1e9, "floor_ns": min(floors) * 1e9}
        row["evaluations_per_event"] = ratio(times, floors) / events
    except MissingExtraError:
        row |= {"first_call_s": None, "events": 0, "ns_per_event": None, "evaluations_per_event": None}
        row["floor_ns"] = floor_s() * 1e9
    row["python_us_per_event"] = best(lambda: many(python_events, False), 2) / python_events * 1e6

    def error(value: float, exact: Number) -> float:
        return float(abs(exact - value) / max(1, abs(exact)))

    compared = list(zip(simulate(scene).events, simulate(scene, digits=REFERENCE_DIGITS).events, strict=True))
    row["max_error"] = max(max(error(a.t, b.t), error(a.x, b.x)) for a, b in compared)
    row["max_error_estimate"] = max(
        max(a.t_error / max(1, abs(a.t)), a.x_error / max(1, abs(a.x))) for a, _ in compared
    )
    return row | {"compared": len(compared)}


def table(result: Record) -> str:
    """Return the result of `run` as text."""
    rows = [
        [row["scene"], row["events"]]
        + ["needs numba" if row[key] is None else format(row[key], form) for key, form in COLUMNS.items()]
        for row in result["rows"]
    ]
    heads = ["scene", "events", "flow evaluations per event", "ns per event", "first call [s]"]
    heads += ["CPython [us per event]", "largest error", "estimated error"]
    cold, other = result["cold_start"], result["formulas"]
    times = []
    for kind in ("numpy", "compiled"):
        if f"{kind}_s" in other:
            ratios = (f"{other[f'{kind}_speedup_over_lambdify{suffix}']:.1f}" for suffix in ("", ", cse"))
            times.append([f"residual of P3, {kind}", *ratios, f"{other[f'{kind}_s']:.3f} s"])
    time_heads = [f"{other['residuals']} evaluations", "times as fast as lambdify", "with cse", "time"]
    lines = [
        tabulate(rows, heads, disable_numparse=True, colalign=("left", *["right"] * 7)),
        "",
        f"one closed-form flow evaluation: {result['floor_ns']:.1f} ns (the unit of the third column)",
        f"errors: against {REFERENCE_DIGITS} digits over the scene, relative to max(1, |value|)",
        f"cold start: simulate fig5 {cold['simulate_fig5_s']:.2f} s, import numpy {cold['import_numpy_s']:.2f} s",
        "",
        tabulate(times, time_heads, disable_numparse=True, colalign=("left", "right", "right", "right")),
        "",
    ]
    if "compiled_error" in other:
        lines.append(
            f"residual of P3 with its Jacobian, compiled: {other['with_jacobian_over_residual']:.2f} times the "
            f"residual; largest error {other['compiled_error']:.1e} of the largest residual\n"
        )
    lines += [
        f"periodic orbit P4645 of fig10: {other['newton_P4645_ms']:.2f} ms from a guess with one decimal, "
        f"{other['orbit_P4645_without_guess_ms']:.0f} ms without a guess",
        f"grazing window: {other['exact_window_ms']:.2f} ms exact, "
        f"{other['float_window_ns']:.0f} ns in a sweep of floats",
    ]
    return "\n".join([*lines, "", sentence(result["machine"])])


#: Columns of `table` after the events, and their formats.
COLUMNS = {"evaluations_per_event": ".1f", "ns_per_event": ".0f", "first_call_s": ".2f", "python_us_per_event": ".0f"}
COLUMNS |= {"max_error": ".1e", "max_error_estimate": ".1e"}


def wrapped(text: str) -> str:
    """Return a paragraph in lines of at most 120 characters."""
    return fill(" ".join(text.split()), 120, break_long_words=False, break_on_hyphens=False)


def section(result: Record) -> str:
    """Return the result of `run` as the README's Markdown."""
    keys = [key for key in COLUMNS if key != "first_call_s"]
    rows = [
        [row["scene"], *("" if row[key] is None else format(row[key], COLUMNS[key]) for key in keys)]
        for row in result["rows"]
    ]
    heads = ["scene", "units per event", "ns per event", "CPython, µs per event"]
    heads += ["largest error", "estimated error"]
    events = max(row["events"] for row in result["rows"])
    cold, other = result["cold_start"], result["formulas"]
    gains = [
        f"{other[f'{kind}_speedup_over_lambdify']:.1f} ({other[f'{kind}_speedup_over_lambdify, cse']:.1f})"
        for kind in ("numpy", "compiled")
        if f"{kind}_s" in other
    ]
    unit, program, numpy = result["floor_ns"], cold["simulate_fig5_s"], cold["import_numpy_s"]
    guessed, unguessed = other["newton_P4645_ms"], other["orbit_P4645_without_guess_ms"]
    exact, swept = other["exact_window_ms"], other["float_window_ns"]
    about = wrapped(
        f"One run of `symosc bench` ({sentence(result['machine'])}). The unit is one evaluation of the closed-form "
        f"flow, one exp and two sine-cosine pairs: {unit:.1f} ns, compiled, in the same run. All of `simulate_many` is "
        f"included, over {events:,} events."
    )
    return f"""\
{about}

{tabulate(rows, heads, tablefmt="github", disable_numparse=True)}

Errors are of event times and positions against {REFERENCE_DIGITS} digits, relative to max(1, |value|). From the shell
`symosc simulate fig5` takes {program:.2f} s, `import numpy` alone {numpy:.2f} s. A mapping's residual over
{other["residuals"]:,} points is {", compiled ".join(gains)} times as fast as sympy's lambdify of the same expression
(in brackets: with common subexpressions). The orbit P4645 takes {guessed:.2f} ms from a guess, {unguessed:.0f} ms
without one; a grazing window {exact:.2f} ms exactly, {swept:.0f} ns in a sweep of floats.
"""


# -- residuals, orbits and grazing windows -----------------------------------------------------------------------------


def measure_formulas(quick: bool = False) -> Record:
    """Measure residuals against sympy's lambdify of the same expression, a Newton solve and grazing windows."""
    points, repeats = (200_000, 2) if quick else (1_000_000, 4)
    return {**_residuals(points, repeats), **_newton(repeats), **_windows(points, repeats)}


def _residuals(points: int, repeats: int) -> Record:
    p = load_scene("fig9").parameters
    rng = np.random.default_rng(0)
    x_i, x_j = rng.uniform(-5, 5, (2, points))
    theta_i = rng.uniform(0, 6.28, points)
    theta_j = theta_i + float(p.Omega) * rng.uniform(0.01, 2, points)
    arguments = (x_i, theta_i, x_j, theta_j)
    plain, shared = _lambdified(p, cse=False), _lambdified(p, cse=True)
    times = {"lambdify": best(lambda: plain(*arguments), repeats)}
    times["lambdify, cse"] = best(lambda: shared(*arguments), repeats)
    row: Record = {"residuals": points, **{f"{name}_s": seconds for name, seconds in times.items()}}
    row["numpy_s"] = best(lambda: residual(p, "P3", (x_i, theta_i), (x_j, theta_j)), repeats)
    row |= {f"numpy_speedup_over_{name}": seconds / row["numpy_s"] for name, seconds in times.items()}
    try:
        compiled, slopes = compiled_residual(p, "P3"), compiled_residual(p, "P3", jacobian=True)
    except ImportError:
        return row
    alone, together = in_turns(2 * repeats + 1, lambda: compiled(*arguments), lambda: slopes(*arguments))
    row["with_jacobian_over_residual"] = ratio(together, alone)
    row["compiled_s"] = best(lambda: compiled(*arguments), repeats)
    row["compiled_error"] = _error(p, compiled, arguments)
    return row | {f"compiled_speedup_over_{name}": seconds / row["compiled_s"] for name, seconds in times.items()}


def _error(p: Parameters, compiled: Callable[..., Any], arguments: tuple[Any, ...]) -> float:
    """Return the largest error of a sample of residuals against 40 digits, relative to the largest residual."""
    import mpmath

    sample = [column[:300] for column in arguments]
    found, error = compiled(*sample), 0.0
    with mpmath.workdps(40):
        for n, point in enumerate(zip(*sample, strict=True)):
            x_i, theta_i, x_j, theta_j = map(mpmath.mpf, point)
            true = residual(p, "P3", (x_i, theta_i), (x_j, theta_j))
            error = max(error, *(abs(float(f[n] - exact)) for f, exact in zip(found, true, strict=True)))
    return error / float(max(abs(f).max() for f in found))


def _lambdified(p: Parameters, cse: bool) -> Callable[..., Any]:
    """Return sympy's own printing of P3's residual: the closed form of the underdamped regime, with numbers put in."""
    import sympy

    from symosc.engine.flow import constants
    from symosc.symbolic import maps, solution

    K = constants(p)
    flow = solution.flow(solution.REGIMES["underdamped"])
    start = {solution.a_i: solution.acceleration(solution.x_i, solution.v_i, solution.theta_i)}
    numbers = {solution.h: K.h, solution.omega_d: K.omega_d, solution.Omega: K.Om, solution.f0: K.f0, solution.cm: K.cm}
    numbers |= {solution.w0sq: K.w0sq, solution.A_m: K.A2, solution.v_i: K.belt1.v, maps.v_j: K.belt1.v}
    tau = (maps.theta_j - solution.theta_i) / K.Om
    formulas = [flow.x.xreplace(start) - maps.x_j, flow.v.xreplace(start) - maps.v_j]
    formulas = [formula.xreplace(numbers).subs(solution.tau, tau) for formula in formulas]
    arguments = (solution.x_i, solution.theta_i, maps.x_j, maps.theta_j)
    lambdified: Callable[..., Any] = sympy.lambdify(arguments, formulas, "numpy", cse=cse)
    return lambdified


def _newton(repeats: int) -> Record:
    p = load_scene("fig10").parameters
    orbit = find_orbit(p, "P4645")
    guess = [(round(point.t, 1), round(point.x, 1)) for point in orbit.points]
    return {
        "newton_P4645_ms": 1e3 * best(lambda: find_orbit(p, "P4645", guess=guess), 3 * repeats),
        "orbit_P4645_without_guess_ms": 1e3 * best(lambda: find_orbit(p, "P4645"), repeats),
    }


def _windows(points: int, repeats: int) -> Record:
    def exact(p: Parameters) -> None:
        window = grazing_window(p, "P3")
        _ = window.phases, window.theta_cr, window.intervals

    p = load_scene("fig9").parameters
    speeds = np.random.default_rng(1).uniform(-20, 20, points)
    exact(p)  # loads sympy
    grazing_windows(p, "P3", v1=speeds[:9])
    changed = iter([p.replace(v1=f"{n + 1}/7") for n in range(40 * repeats)])
    return {
        "exact_window_ms": 1e3 * best(lambda: exact(next(changed)), 20 * repeats),
        "float_window_ns": 1e9 * best(lambda: grazing_windows(p, "P3", v1=speeds), repeats) / points,
    }


# -- more digits -------------------------------------------------------------------------------------------------------

DIGIT_SETS, DIGIT_PERIODS, ASKED_DIGITS = 300, 50, 30


def measure_digits(quick: bool = False) -> Record:
    """Measure the cost of more digits: motions that doubles cannot follow, compared with those that they can.

    Keys: fig5_us and fig8_us (per event in `simulate_many`, all of it), fig8_over_fig5; sweep_default_over_inf (values
    of Omega from 1 to 6 in fig9, at default accuracy and with ``math.inf``), sweep_sets_per_s; simulate_fig8_us (per
    event, one motion at default accuracy), simulate_fig8_as_doubles_us; digits, digits_us (per event with 30 digits).
    """
    repeats, motions, most = (3, 300, 100_000) if quick else (7, 2_000, 100_000)
    easy, hard = load_scene("fig5"), load_scene("fig8")
    starts = [(hard.t0, hard.x0, hard.v0)] * motions
    actions = (
        lambda: simulate_many(easy.parameters, (easy.t0, easy.x0, easy.v0), easy.t0 + 10**7, max_events=most),
        lambda: simulate_many(hard.parameters, starts, hard.t_end),
    )
    events = [len(action()) for action in actions]
    columns = in_turns(repeats, *actions)
    fig5, fig8 = ([time / count * 1e6 for time in column] for column, count in zip(columns, events, strict=True))
    p = load_scene("fig9").parameters
    sets = [p.replace(Omega=1 + Fraction(5 * n, DIGIT_SETS - 1)) for n in range(DIGIT_SETS)]
    ends = [DIGIT_PERIODS * 2 * pi / float(each.Omega) for each in sets]
    default, as_it_is = in_turns(
        repeats,
        lambda: simulate_many(sets, (0, 0, 0), ends),
        lambda: simulate_many(sets, (0, 0, 0), ends, accuracy=inf),
    )
    count = len(simulate(hard).events)
    single, doubles, digits = (
        min(column) / count * 1e6
        for column in in_turns(
            repeats,
            lambda: simulate(hard),
            lambda: simulate(hard, accuracy=inf),
            lambda: simulate(hard, digits=ASKED_DIGITS),
        )
    )
    return {
        "motions": motions,
        "fig5_us": min(fig5),
        "fig8_us": min(fig8),
        "fig8_over_fig5": ratio(fig8, fig5),
        "sweep_default_over_inf": ratio(default, as_it_is),
        "sweep_sets_per_s": DIGIT_SETS / min(default),
        "simulate_fig8_us": single,
        "simulate_fig8_as_doubles_us": doubles,
        "digits": ASKED_DIGITS,
        "digits_us": digits,
    }


def digits_table(r: Record) -> str:
    """Return the result of `measure_digits` as text."""
    return (
        f"fig8 in simulate_many, {r['motions']} motions: {r['fig8_us']:.1f} us per event, "
        f"{r['fig8_over_fig5']:.1f} times fig5's {r['fig5_us']:.2f}\n"
        f"{DIGIT_SETS} values of Omega, {DIGIT_PERIODS} periods of fig9: {r['sweep_sets_per_s']:.0f} per second, "
        f"{r['sweep_default_over_inf']:.2f} times the time without more digits\n"
        f"simulate fig8: {r['simulate_fig8_us']:.0f} us per event, {r['simulate_fig8_as_doubles_us']:.0f} in doubles "
        f"alone, {r['digits_us']:.0f} with {r['digits']} digits"
    )


# -- many motions ------------------------------------------------------------------------------------------------------

#: Periods of all motions, and samples per period and tolerance of the scan.
PERIODS, SCAN_POINTS, SCAN_ACCURACY = 50, 20, 1e-13
#: What is recorded; the first is what all solvers are asked for.
COMPARED_RECORDS = {
    "counts": ("events",),
    "rows of events": "events",
    "words": ("events", "word", "multiplicity"),
    "all columns": "summary",
}


def measure_ensembles(quick: bool = False) -> Record:
    """Measure many motions of fig9, in processor time of one thread.

    Keys: motions, events; ns_per_event by what is recorded; per_s, trajectories whose events are counted per second of
    processor time; scan, which counts too, with per_s, over_ours and missed (events that it has less than ours, motion
    by motion); sets_over_starts (time per event of as many values of Omega as there are starts); two_workers (gain in
    wall time).
    """
    p, count, repeats = load_scene("fig9").parameters, 2_000 if quick else 10_000, 3 if quick else 5
    rng = np.random.default_rng(1)
    period = 2 * pi / float(p.Omega)
    starts = np.column_stack([rng.uniform(0, period, count), rng.uniform(-5, 5, count), rng.uniform(-5, 5, count)])
    ends = starts[:, 0] + PERIODS * period
    columns: Record = {name: float(getattr(p, name)) for name in PARAMETER_NAMES}
    columns["Omega"] = rng.uniform(0.9, 1.1, count) * float(p.Omega)
    options: Record = {"use_numba": True, "workers": 1}
    follow = partial(simulate_many, p, starts, ends, **options)
    count_events = partial(follow, record=COMPARED_RECORDS["counts"])
    sets_ends = PERIODS * 2 * pi / columns["Omega"]
    actions: Record = {name: partial(follow, record=record) for name, record in COMPARED_RECORDS.items()}
    actions["sets"] = partial(simulate_many, columns, (0, 0, 0), sets_ends, **options, record=("events",))
    actions["scan"] = scan_of_starts(p, starts, ends - starts[:, 0])
    times = dict(zip(actions, in_turns(repeats, *actions.values()), strict=True))
    counts, ours = count_events().events, times["counts"]
    events, set_events = int(counts.sum()), int(actions["sets"]().events.sum())

    missed = np.maximum(counts - actions["scan"](), 0)
    scan = {"per_s": count / min(times["scan"]), "over_ours": ratio(times["scan"], ours)}
    scan |= {"missed": int(missed.sum()), "motions": int((missed > 0).sum())}
    walls = [[best(partial(count_events, workers=n), 1) for n in (1, 2)] for _ in range(repeats + 2)]
    return {
        "motions": count,
        "events": events,
        "per_s": count / min(ours),
        "ns_per_event": {name: min(times[name]) / events * 1e9 for name in COMPARED_RECORDS},
        "sets_over_starts": ratio(times["sets"], ours) * events / set_events,
        "scan": scan,
        "two_workers": max(one / two for one, two in walls),
    }


def scan_of_starts(p: Parameters, starts: np.ndarray, durations: np.ndarray) -> Callable[[], np.ndarray]:
    """Return a function that counts events by the closed form, a scan and a root finder, all compiled."""
    import numba

    from symosc.bench import peers_scan
    from symosc.bench.event_logic import problem

    q = problem(p)
    s, follow = peers_scan.scan_of(q, SCAN_POINTS, SCAN_ACCURACY), peers_scan.compiled()["follow"]

    @numba.njit
    def count_all(q, s, starts, durations, counts):
        for i in range(len(starts)):
            t, x, v = starts[i]
            mode = 1 if v < q.v1 else 2 if v < q.v2 else 3
            counts[i] = follow(q, s, t, x, v, mode, 0, 0.0, t + durations[i])[1]

    def run() -> np.ndarray:
        counts = np.zeros(len(starts), np.int64)
        count_all(q, s, starts, durations, counts)
        return counts

    return run


def ensembles_table(r: Record) -> str:
    """Return the result of `measure_ensembles` as text."""
    kinds = ", ".join(f"{name} {ns:.0f}" for name, ns in r["ns_per_event"].items())
    lines = [
        f"{r['motions']:,} starts, {PERIODS} periods of fig9, {r['events']:,} events counted, one core: "
        f"{r['per_s']:,.0f} trajectories per second; ns per event: {kinds}",
        f"as many values of Omega: {r['sets_over_starts']:.2f} times the time per event; "
        f"two workers: {r['two_workers']:.2f} times one",
    ]
    scan = r["scan"]
    lines.append(
        f"closed form, scan {SCAN_POINTS}, numba: {scan['per_s']:,.0f} per second, symosc {scan['over_ours']:.1f} "
        f"times that; misses {scan['missed']:,} events of {scan['motions']:,} motions"
    )
    return "\n".join(lines)


# -- sweeps ------------------------------------------------------------------------------------------------------------


def measure_sweeping(quick: bool = False) -> Record:
    """Measure the processor time of a sweep and of the direct call with the same motions, in turns.

    An empty dictionary without the extra `sweep`. Keys: motions, periods, motions_per_s (in the sweep, for each second
    of processor time), overhead (of the sweep over the bare call, each at its best of the turns). A sweep costs some
    hundredths of a second once, and 2 percent: the former shows in what is done in a second.
    """
    if not find_spec("xarray"):
        return {}
    from symosc.sweeps.sweep import sweep

    motions, record = 4_000 if quick else 300_000, ("word", "events")
    scene, values = load_scene("fig9"), np.linspace(-5, 5, motions)
    p: Record = {name: getattr(scene.parameters, name) for name in PARAMETER_NAMES}
    t_end = float(scene.t0) + PERIODS * 2 * pi / float(p["Omega"])
    starts = {"t0": scene.t0, "x0": values, "v0": scene.v0}
    with TemporaryDirectory() as folder:
        paths = (Path(folder) / f"{i}.nc" for i in range(4))
        bare, swept = in_turns(
            3,
            lambda: simulate_many(p, starts, t_end, record=(*record, "status")),
            lambda: sweep(scene, {"x0": values}, t_end=f"{PERIODS}T", record=record, path=next(paths)),
        )
    rate, overhead = motions / min(swept), min(swept) / min(bare) - 1
    return {"motions": motions, "periods": PERIODS, "motions_per_s": rate, "overhead": overhead}


def sweeping_table(r: Record) -> str:
    """Return the result of `measure_sweeping` as text."""
    if not r:
        return "sweeps: they need the extra sweep"
    return (
        f"sweep of {r['motions']:,} motions × {r['periods']} periods of fig9, written as netCDF: "
        f"{r['motions_per_s']:,.0f} motions per second of processor time, "
        f"{100 * r['overhead']:+.1f} % over the bare call"
    )
