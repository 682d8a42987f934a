"""What mappings, orbits and grazing windows cost: the second half of `symosc bench`."""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.grazing.window import grazing_window, grazing_windows
from symosc.mappings.compiled import compiled_residual
from symosc.mappings.equations import residual
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.scenes import load_scene

BATCH_POINTS = 1_000_000
QUICK_BATCH_POINTS = 200_000


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


def run(quick: bool = False) -> Record:
    """Measure residuals against sympy's lambdify of the same expression, a Newton solve and grazing windows.

    Parameters
    ----------
    quick : bool
        Fewer points and repeats.
    """
    points, repeats = (QUICK_BATCH_POINTS, 2) if quick else (BATCH_POINTS, 4)
    return {**_residuals(points, repeats), **_newton(repeats), **_windows(points, repeats)}


def _residuals(points: int, repeats: int) -> Record:
    p = load_scene("fig9").parameters
    rng = np.random.default_rng(0)
    x_i, x_j = rng.uniform(-5, 5, (2, points))
    theta_i = rng.uniform(0, 6.28, points)
    theta_j = theta_i + float(p.Omega) * rng.uniform(0.01, 2, points)
    arguments = (x_i, theta_i, x_j, theta_j)
    generated = best(lambda: residual(p, "P3", (x_i, theta_i), (x_j, theta_j)), repeats)
    plain, shared = _lambdified(p, cse=False), _lambdified(p, cse=True)
    times = {"lambdify": best(lambda: plain(*arguments), repeats)}
    times["lambdify, cse"] = best(lambda: shared(*arguments), repeats)
    row: Record = {"residuals": points, "numpy_s": generated, **{f"{k}_s": t for k, t in times.items()}}
    row |= {f"numpy_speedup_over_{name}": seconds / generated for name, seconds in times.items()}
    try:
        compiled, slopes = compiled_residual(p, "P3"), compiled_residual(p, "P3", jacobian=True)
    except ImportError:
        return row
    alone, together = in_turns(2 * repeats + 1, lambda: compiled(*arguments), lambda: slopes(*arguments))
    row["with_jacobian_over_residual"] = median(b / a for a, b in zip(alone, together, strict=True))
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
    p = load_scene("fig9").parameters
    speeds = np.random.default_rng(1).uniform(-20, 20, points)
    _exact_window(p)  # loads sympy
    grazing_windows(p, "P3", v1=speeds[:9])
    changed = iter([p.replace(v1=f"{n + 1}/7") for n in range(40 * repeats)])
    return {
        "exact_window_ms": 1e3 * best(lambda: _exact_window(next(changed)), 20 * repeats),
        "float_window_ns": 1e9 * best(lambda: grazing_windows(p, "P3", v1=speeds), repeats) / points,
    }


def _exact_window(p: Parameters) -> None:
    window = grazing_window(p, "P3")
    _ = window.phases, window.theta_cr, window.intervals


def _jacobian_line(result: Record) -> list[str]:
    if "compiled_error" not in result:
        return []
    return [
        f"residual of P3 with its Jacobian, compiled: {result['with_jacobian_over_residual']:.2f} times the residual; "
        f"largest error {result['compiled_error']:.1e} of the largest residual",
        "",
    ]


def table(result: Record) -> str:
    """Return the result of `run` as text."""
    from tabulate import tabulate

    rows = []
    for kind in ("numpy", "compiled"):
        if f"{kind}_s" in result:
            ratios = (result[f"{kind}_speedup_over_lambdify{suffix}"] for suffix in ("", ", cse"))
            seconds = f"{result[f'{kind}_s']:.3f} s"
            rows.append([f"residual of P3, {kind}", *(f"{ratio:.1f}" for ratio in ratios), seconds])
    lines = [
        tabulate(
            rows,
            [f"{result['residuals']} evaluations", "times as fast as lambdify", "with cse", "time"],
            disable_numparse=True,
            colalign=("left", "right", "right", "right"),
        ),
        "",
        *_jacobian_line(result),
        f"periodic orbit P4645 of fig10: {result['newton_P4645_ms']:.2f} ms from a guess with one decimal, "
        f"{result['orbit_P4645_without_guess_ms']:.0f} ms without a guess",
        f"grazing window: {result['exact_window_ms']:.2f} ms exact, "
        f"{result['float_window_ns']:.0f} ns in a sweep of floats",
    ]
    return "\n".join(lines)
