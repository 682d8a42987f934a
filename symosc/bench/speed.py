"""How fast, and how exact: the figures that the README quotes, measured in one run.

The unit is one evaluation of the closed-form flow: one exp, the sine and cosine of two angles, and the arithmetic that
makes position and velocity of them. It is timed in the same process, right after what is measured, because some
machines change their pace every second. Times are the best of several repeats, ratios their median; a first call, which
compiles or loads the compiled code, is reported apart.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from functools import lru_cache, partial
from math import cos, exp, sin
from statistics import median
from textwrap import fill
from typing import Any

from symosc.aliases import Number, Record
from symosc.bench import formulas, gains
from symosc.bench.formulas import best
from symosc.bench.machine import machine, sentence
from symosc.engine.arithmetic import compiled
from symosc.errors import MissingExtraError
from symosc.reference.compare import REFERENCE_DIGITS
from symosc.scenes import load_scene
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.simulate import simulate

TIMED_SCENES = ("fig5", "fig9", "fig10")
TIMED_EVENTS = 200_000
QUICK_TIMED_EVENTS = 100_000
PYTHON_EVENTS = 2_000
FLOOR_EVALUATIONS = 30_000
REPEATS = 7


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


def run(quick: bool = False) -> Record:
    """Measure and return a plain dictionary: machine, floor and one row per scene.

    Parameters
    ----------
    quick : bool
        Fewer repeats and events.

    Notes
    -----
    Keys of a row of `rows`: scene, events, ns_per_event, floor_ns, evaluations_per_event (in units of the floor),
    first_call_s, python_us_per_event, max_error (of event times and positions, relative to max(1, |value|), against 40
    digits), max_error_estimate (what the event estimates say) and compared (the number of events that were compared).
    `formulas` and `gains` are the results of `run` in the modules of these names.
    """
    repeats, events = (3, QUICK_TIMED_EVENTS) if quick else (REPEATS, TIMED_EVENTS)
    rows = [_scene(name, events, repeats) for name in TIMED_SCENES]
    unit = min(row["floor_ns"] for row in rows)
    result = {"machine": machine(), "floor_ns": unit, "rows": rows, "cold_start": _cold_start(3 if quick else 5)}
    return result | {"formulas": formulas.run(quick), "gains": gains.run(quick)}


@lru_cache(maxsize=1)
def compiled_floor() -> Callable[..., float]:
    """Return `floor`, compiled if numba is there, as the event loop is."""
    try:
        import numba
    except ImportError:
        return floor
    return numba.njit(floor)


def floor_s() -> float:
    """Return the seconds that one evaluation of the closed form takes now."""
    evaluate, arguments = compiled_floor(), (0.5, 0.866, 1.0, 1.0, 2.0, 3.0, 4.0)
    evaluate(10, *arguments)
    return best(lambda: evaluate(FLOOR_EVALUATIONS, *arguments), 1) / FLOOR_EVALUATIONS


def beside_floor(action: Callable[[], object], repeats: int) -> tuple[list[float], list[float]]:
    """Return the seconds of several calls, and after each of them those of one closed-form evaluation."""
    pairs = [(best(action, 1), floor_s()) for _ in range(repeats)]
    return [pair[0] for pair in pairs], [pair[1] for pair in pairs]


def _scene(name: str, events: int, repeats: int) -> Record:
    scene = load_scene(name)
    start, far = [float(scene.t0), float(scene.x0), float(scene.v0)], float(scene.t0) + 1e7

    def many(count: int, use_numba: bool) -> Any:
        return simulate_many(scene.parameters, start, far, max_events=count, use_numba=use_numba)

    row: Record = {"scene": name}
    try:
        compiled()
        begin = time.perf_counter()
        many(10, True)
        row["first_call_s"] = time.perf_counter() - begin
        times, floors = beside_floor(lambda: many(events, True), repeats)
        row |= {"events": events, "ns_per_event": min(times) / events * 1e9, "floor_ns": min(floors) * 1e9}
        row["evaluations_per_event"] = median(a / b for a, b in zip(times, floors, strict=True)) / events
    except MissingExtraError:
        row |= {"first_call_s": None, "events": 0, "ns_per_event": None, "evaluations_per_event": None}
        row["floor_ns"] = floor_s() * 1e9
    row["python_us_per_event"] = best(lambda: many(PYTHON_EVENTS, False), 2) / PYTHON_EVENTS * 1e6
    exact, double = simulate(scene, digits=REFERENCE_DIGITS), simulate(scene)
    pairs = list(zip(double.events, exact.events, strict=True))
    row["max_error"] = max(max(_error(a.t, b.t), _error(a.x, b.x)) for a, b in pairs)
    row["max_error_estimate"] = max(max(a.t_error / max(1, abs(a.t)), a.x_error / max(1, abs(a.x))) for a, _ in pairs)
    row["compared"] = len(pairs)
    return row


def _error(value: float, exact: Number) -> float:
    return float(abs(exact - value) / max(1, abs(exact)))


def _cold_start(repeats: int) -> dict[str, float]:
    """Return seconds of a new process: importing numpy, and `symosc simulate fig5` from the shell."""
    commands = {"import_numpy_s": ["-c", "import numpy"], "simulate_fig5_s": ["-m", "symosc", "simulate", "fig5"]}

    def call(arguments: list[str]) -> None:
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True)

    return {name: best(partial(call, arguments), repeats) for name, arguments in commands.items()}


def table(result: Record) -> str:
    """Return the result of `run` as text."""
    from tabulate import tabulate

    def number(value: float | None, form: str) -> str:
        return "needs numba" if value is None else format(value, form)

    rows = [
        [
            row["scene"],
            row["events"],
            number(row["evaluations_per_event"], ".1f"),
            number(row["ns_per_event"], ".0f"),
            number(row["first_call_s"], ".2f"),
            format(row["python_us_per_event"], ".0f"),
            format(row["max_error"], ".1e"),
            format(row["max_error_estimate"], ".1e"),
        ]
        for row in result["rows"]
    ]
    heads = ["scene", "events", "flow evaluations per event", "ns per event", "first call [s]"]
    heads += ["CPython [us per event]", "largest error", "estimated error"]
    cold = result["cold_start"]
    return "\n".join(
        [
            tabulate(rows, heads, disable_numparse=True, colalign=("left", *["right"] * 7)),
            "",
            f"one closed-form flow evaluation: {result['floor_ns']:.1f} ns (the unit of the third column)",
            f"errors: against {REFERENCE_DIGITS} digits over the scene, relative to max(1, |value|)",
            f"cold start: simulate fig5 {cold['simulate_fig5_s']:.2f} s, import numpy {cold['import_numpy_s']:.2f} s",
            "",
            formulas.table(result["formulas"]),
            "",
            gains.table(result["gains"]),
            "",
            sentence(result["machine"]),
        ]
    )


def wrapped(text: str) -> str:
    """Return a paragraph in lines of at most 120 characters."""
    return fill(" ".join(text.split()), 120, break_long_words=False, break_on_hyphens=False)


def section(result: Record) -> str:
    """Return the result of `run` as the README's Markdown."""
    from tabulate import tabulate

    rows = [
        [
            row["scene"],
            "" if row["evaluations_per_event"] is None else f"{row['evaluations_per_event']:.1f}",
            "" if row["ns_per_event"] is None else f"{row['ns_per_event']:.0f}",
            f"{row['python_us_per_event']:.0f}",
            f"{row['max_error']:.1e}",
            f"{row['max_error_estimate']:.1e}",
        ]
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
