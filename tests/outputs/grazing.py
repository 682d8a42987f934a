"""Grazing windows, starts, curves, solutions and checks; the mappings and their derivatives.

Exact phases.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import mpmath
import numpy as np
from paper_orbits import FIG9, FIG10
from parameter_sets import FREE, OVER
from said import errors_of, outcome
from window_samples import parameters

from symosc import (
    GrazingCurve,
    GrazingSolutions,
    Parameters,
    check_grazing,
    grazing_curve,
    grazing_start,
    grazing_window,
    grazing_windows,
    is_grazing,
    jacobian,
    load_scene,
    parameter_jacobian,
    residual,
    solve_grazing,
    solve_map,
)
from symosc.base.display.latex import latex_number
from symosc.base.expressions import ExactPhase
from symosc.base.phases import read_phase_text
from symosc.grazing.backward import first_root
from symosc.grazing.exact_sine import sine_sign
from symosc.grazing.window import critical_text, phases_text

MAPS = ("P2", "P3", "P5", "P6")
FIG6, FIG7, FIG8 = (load_scene(name).parameters for name in ("fig6", "fig7-exact", "fig8"))


def plain(value: Any) -> Any:
    """Return numbers with more than double precision as text."""
    if hasattr(value, "_mpf_"):
        return str(value)
    return value


def windows() -> Iterator[str]:
    """Yield windows of random parameters, a third of them at the equality, in both orders."""
    rng = random.Random(20)
    flat = Parameters(m=1, c=1, k=1, A0=0, B0=1, Omega=1, v1=1, v2=2, mu1=1, mu2=1, FN=1)
    for k in ("1/2", "1", "0"):
        yield phases_text(grazing_window(flat.replace(k=k), "P2", "paper"))
    for i in range(28):
        p = parameters(rng)
        mapping = MAPS[i % 4]
        for order in ("full", "paper"):
            window = grazing_window(p, mapping, order)
            yield f"{window!r} {window.case} {phases_text(window)} {critical_text(window)} {window.intervals}"


def exact_windows() -> Iterator[str]:
    """Yield what sympy and LaTeX say of a window, and phases in it."""
    for p, mapping in (
        (FIG9, "P2"),
        (FIG10, "P6"),
        (FIG10.replace(B0=-5), "P3"),
        (FIG9.replace(k=0), "P3"),
    ):
        window = grazing_window(p, mapping)
        yield f"{window.phases}; {window.theta_cr}; {window.contact_phases}"
        yield window.latex()
        yield " ".join(
            str(window.contains(theta)) for theta in ("pi/2", "3*pi/2", 1, 4.5, "-1/3", "pi - 2")
        )
    yield str(grazing_window(FIG9, "P2").contact("pi/3"))
    yield str(
        [
            grazing_window(FIG9, "P2").contact(1.0),
            *grazing_window(FIG9, "P2").contact(np.array([0.5, 2.0])),
        ]
    )


def many_windows() -> Iterator[Any]:
    """Yield the columns of windows over arrays of parameters."""
    speeds = np.linspace(-4, 4, 17)
    yield grazing_windows(FIG9, "P2", v1=speeds, B0=np.array([[-3.0], [0.0], [3.0]]))
    yield grazing_windows(FIG9, "P6", "paper", k=np.linspace(0, 8, 9), v2=2.0, B0=2.0, Omega=4.0)
    yield grazing_windows(FIG10, "P5")
    one, other = (grazing_windows(FIG9, "P2", v1=[0.0, 1.0, v1]) for v1 in (2.0, 3.0))
    yield [one == one, one == other, one != other, one == 3]


def starts() -> Iterator[Any]:
    """Yield the starts of flows into tangencies, and why there is none."""
    asked: list[tuple[Parameters, str, dict[str, Any]]] = [
        (FIG9, "P2", {"theta": 1}),
        (FIG9, "P2", {"theta": "pi/2", "digits": 25}),
        (FIG9, "P2", {"t_m": "0.3"}),
        (FIG9, "P2", {"theta": 1, "t0": "2.5"}),
        (FIG9, "P2", {"t_m": "0.3", "t0": "-1.5"}),
        (FIG9, "P3", {"theta": 4}),
        (FIG10, "P5", {"theta": "0.8"}),
        (FIG10, "P6", {"theta": 4}),
        (FIG10, "P6", {"theta": "5.5"}),
        (FIG6, "P2", {"theta": 1}),
        (FIG7, "P2", {"theta": 4, "periods": "0.01"}),
        (OVER, "P3", {"theta": "3.9"}),
        (OVER, "P6", {"theta": 4}),
        (FREE, "P2", {"theta": 1}),
    ]
    for p, mapping, given in asked:
        if grazing_window(p, mapping).contains(given.get("theta", 1)):
            found = grazing_start(p, mapping, **given)
            yield {name: plain(value) for name, value in vars(found).items() if name != "start"}
            yield [*map(str, found.start.values()), found.latex()]
    yield grazing_start(FIG9, "P2", theta=1).to_dict()


def verdicts() -> Iterator[Any]:
    """Yield whether states graze, by G-functions of each order."""
    flat = Parameters(
        m=1, c="0.5", k=2, A0=0, B0=6, Omega=1, v1=3, v2=9, mu1="0.5", mu2="0.2", FN=1
    )
    quartic = grazing_window(flat, "P2").contact("3*pi/2")
    for p, mapping, x, theta in (
        (FIG9, "P2", 0, 1),
        (FIG9, "P2", grazing_window(FIG9, "P2").contact("1"), "1"),
        (FIG9, "P2", grazing_window(FIG9, "P2").contact(1.0), 1.0),
        (flat, "P2", quartic, "3*pi/2"),
        (flat, "P3", quartic, "3*pi/2"),
        (FIG9, "P2", (FIG9.A(1) - FIG9.c * FIG9.v1) / FIG9.k, "3*pi/2"),
        (FIG9.replace(v1=0), "P3", (FIG9.A(2) + FIG9.B0) / FIG9.k, 0),
        (FIG7, "P2", "-0.5855", "pi"),
        (FIG7, "P2", "4.4145", "3*pi/2"),
        (FREE.replace(v1=0, k=1), "P2", "2.6", 0),
        (FREE.replace(v1=0, k=1), "P3", "0.2", 0),
    ):
        found = is_grazing(p, mapping, x, theta)
        yield found
        yield found.latex()
    yield from (is_grazing(FIG9, "P2", 0, 1, tolerance=tolerance) for tolerance in ("0.9", "0.96"))


@cache
def curve(scene: str, mapping: str) -> GrazingCurve:
    return grazing_curve(load_scene(scene).parameters, mapping, 60)


def curves() -> Iterator[Any]:
    """Yield grazing curves with their ends and gaps."""
    endless = grazing_curve(OVER, "P6", 40)
    yield [(end.theta_m, end.reason) for piece in endless.pieces for end in (piece.low, piece.high)]
    yield [endless.gaps, vars(endless.sample(3.9))]
    regimes = grazing_curve(FREE, "P2", 40), grazing_curve(FIG9.replace(B0=-9), "P3", 40)
    for each in (*(curve(*given) for given in CURVES), *regimes):
        yield repr(each)
        yield each.latex()
        yield each.gaps
        yield each.windows
        for piece in each.pieces:
            yield [piece.low, piece.high]
            middle = len(piece.theta_m) // 2
            yield vars(each.sample(float(piece.theta_m[middle])))


CURVES = (
    ("fig10", "P5"),
    ("fig9", "P3"),
    ("fig6", "P2"),
    ("fig7-exact", "P2"),
    ("fig10", "P6"),
    ("fig9", "P2"),
)


def solutions() -> Iterator[Any]:
    """Yield the solutions of the grazing conditions for each given unknown, and why there is none."""
    known = grazing_start(FIG10, "P6", 4)
    asked = [
        (FIG10, "P6", {"theta_m": 4}),
        (FIG10, "P6", {"theta_j": 1}),
        (FIG10, "P6", {"x_j": known.x_m}),
        (FIG10, "P6", {"x_j": 1000}),
        (FIG10, "P6", {"theta_i": known.theta, "digits": 20}),
        (FIG10, "P6", {"x_i": known.start["x0"]}),
        (FIG10, "P6", {"x_i": 1000}),
        (FIG10, "P6", {"x_i": "-6.33"}),
        (FIG10, "P6", {"x_i": "-6.3303309"}),
        (FIG9, "P3", {"x_i": -4}),
        (FIG7, "P2", {"theta_i": 2}),
        (FIG8, "P2", {"x_i": 1}),
        (FIG8, "P5", {"theta_m": 0}),
        (FREE, "P2", {"theta_i": 1}),
        (OVER, "P6", {"x_i": 3}),
    ]
    for p, mapping, given in asked:
        found: GrazingSolutions = solve_grazing(p, mapping, n=60, **given)
        yield [mapping, *map(str, given), found.complete, found.message]
        yield [
            plain(number)
            for each in found
            for number in (each.x, each.theta, each.x_m, each.theta_m)
        ]
        yield found.latex()


def checks() -> Iterator[Any]:
    """Yield what the checks of windows say, but for what depends on the errors of DOP853."""
    for p, mapping in ((FIG9, "P2"), (FIG10.replace(B0=-5), "P6")):
        report = check_grazing(p, mapping, n=40, seed=3)
        yield [
            line
            for line in report.summary().splitlines()
            if "DOP853" not in line and " s" not in line[-3:]
        ]
        about = report.to_dict() | {"seconds": 0}
        for name in ("agreements", "undecided", "closest"):
            about[name] = {way: value for way, value in about[name].items() if way != "DOP853"}
        yield about
        wrong = replace(
            report, mismatches=({"theta": "1", "why": "of a test"},) * 21, finely=0, seconds=0
        )
        yield [line for line in wrong.summary().splitlines() if "mismatch" in line]


def maps() -> Iterator[Any]:
    """Yield residuals and derivatives of all mappings at random points, in doubles and with digits."""
    rng = random.Random("maps")
    for i, p in enumerate((FIG9, FIG10, OVER, FREE)):
        for label in (f"P{1 + (j + i) % 8}" for j in range(0, 8, 2 - i % 2)):
            start = rng.uniform(-3, 3), rng.uniform(0, 6)
            end = rng.uniform(-3, 3), start[1] + rng.uniform(0, 5)
            for exit in ("below", "above", None) if label in ("P1", "P4") else (None,):
                yield [label, str(exit), *residual(p, label, start, end, exit)]
                yield jacobian(p, label, start, end, exit)
                yield parameter_jacobian(p, label, start, end, exit)
    with mpmath.workdps(25):
        yield [str(each) for each in residual(FIG9, "P2", (mpmath.mpf("4.5"), 0.5), (-4, 4))]
    columns = np.linspace(0, 1, 3)
    yield residual(FIG9, "P1", (columns, 0.5), (-4, 4 + columns))
    yield jacobian(FIG10, "P6", (columns, 0.5), (-4, 4 + columns))


def next_points() -> Iterator[Any]:
    """Yield the ends of mappings, or where the motion goes instead."""

    def end(p: Parameters, label: str, x: Any, theta: Any) -> Any:
        point = solve_map(p, label, x, theta)
        return [
            label,
            point.x,
            point.theta,
            str(point.exit),
            point.grazing,
            *np.ravel(point.derivative),
        ]

    tries = [
        (p, f"P{n}", x, theta)
        for p in (FIG9, FIG10)
        for n in range(1, 9)
        for x in (-3, 4)
        for theta in (1, 14.5, -4)
    ]
    for given in tries:
        yield outcome(lambda given=given: end(*given), ArithmeticError, ValueError)  # type: ignore[misc]
    with mpmath.workdps(25):
        point = solve_map(FIG9, "P2", mpmath.mpf("4.5"), mpmath.mpf("0.5"))
        yield [str(point.x), str(point.theta)]


def phases() -> Iterator[str]:
    """Yield phases read from text, and signs of level + amplitude sin."""
    for text in (
        "3*pi/2",
        "pi - 1/3",
        "0.7",
        "-(pi + 1)/3",
        "2 pi",
        "π/4 + 0.25*2",
        "+pi",
        "(1 + 2)*pi/(3 - 1)",
    ):
        yield f"{text}: {read_phase_text('theta', text)} {read_phase_text('theta', text).symbolic()}"
    for sixths in range(-13, 14):
        phase = ExactPhase(FIG9.FN * 0, FIG9.m * 10 * sixths / 6)
        yield f"{sixths}: {[sine_sign(FIG9.mu1 * level, FIG9.m * 6, phase) for level in (-2, -1, 0, 1, 2)]}"
    yield " ".join(map(latex_number, (1.5, 1e-30, 2.5e20, mpmath.mpf("1.25"), -3e-7)))


def roots() -> Iterator[Any]:
    """Yield first roots of polynomials that are known within a noise."""
    rng = random.Random("roots")
    for _ in range(40):
        at = sorted(rng.uniform(-0.3, 1.4) for _ in range(rng.choice([2, 3, 4])))
        p = np.array([1.0])
        for root in (*at, at[-1] + rng.choice([0, 1e-9, 1e-3])):
            p = np.convolve(p, [-root, 1.0])
        p = (p if p[0] > 0 else -p).tolist()
        touch, sigma = first_root(p, rng.choice([1e-15, 1e-12, 1e-6]), 2.0**-52)
        if touch:
            places = 4
        else:
            places = 9
        if sigma is None:
            yield [touch, -1.0]
        else:
            yield [touch, round(sigma, places)]


CASES: dict[str, Callable[[], object]] = {
    "windows": lambda: "\n".join(windows()),
    "exact windows": lambda: "\n".join(exact_windows()),
    "many windows": many_windows,
    "starts": starts,
    "verdicts": verdicts,
    "curves": curves,
    "solutions": solutions,
    "checks": checks,
    "maps": maps,
    "next points": next_points,
    "phases": lambda: "\n".join(phases()),
    "first roots": roots,
    "errors": lambda: errors_of(
        [
            lambda: grazing_window(FIG9, "P1"),
            lambda: grazing_window(FIG9, "P2").contact("3*pi/2"),
            lambda: grazing_window(FIG9, "P2").contact(np.array([1.0, 4.0])),
            lambda: grazing_window(FIG9, "P2").contains(np.array([1.0, np.inf])),
            lambda: grazing_windows(FIG9, "P2", FN=[1.0]),
            lambda: grazing_windows(FIG9, "P2", k=[1.0, -1.0]),
            lambda: grazing_windows(FIG9, "P2", k=[1.0, 2.0], B0=[1.0, 2.0, 3.0]),
            lambda: grazing_start(FIG9, "P2", theta=1, periods=0),
            lambda: grazing_start(FIG9, "P2"),
            lambda: is_grazing(FIG9, "P2", 0, 1, tolerance=1),
            lambda: grazing_curve(FIG9.replace(k=0), "P2"),
            lambda: grazing_curve(FIG9, "P2", 3),
            lambda: solve_grazing(FIG9, "P2", x_i=1, x_j=1),
            lambda: check_grazing(FIG9, "P2", n=0),
            lambda: jacobian(FIG9, "P9", (1, 2), (1, 3)),
            lambda: jacobian(FIG9, "P1", (1, 2), (1, 3), "left"),
            lambda: residual(FIG9, "P2", ([1, 2], 2), ([1, 2, 3], 3)),
            lambda: residual(FIG9, "P2", (float("inf"), 2), (1, 3)),
            lambda: residual(FIG9, "P2", (True, 2), (1, 3)),
            lambda: solve_map(FIG9, "P2", [1, 2], 2),
            lambda: grazing_window(FIG9.replace(k=0), "P2").contact("pi/2"),
            lambda: grazing_start(FIG9, "P2", theta=4.7),
            lambda: grazing_start(FIG9, "P2", t_m=2, t0=3),
            lambda: grazing_start(FIG9, "P2", t_m=2, t0=2),
            lambda: grazing_start(FIG9, "P2", theta=1, t_m=1),
            lambda: grazing_start(FIG9, "P2", theta="one"),
            lambda: grazing_start(FIG9, "P2", theta=2, digits=2),
            lambda: grazing_start(FIG9.replace(k=0), "P2", theta="pi/2"),
            lambda: check_grazing(FIG9, "P4", n=5),
            lambda: check_grazing(FIG9, "P2", n=2.5),  # type: ignore[arg-type]
            lambda: check_grazing(FIG9, "P2", n=1_000_001),
            lambda: check_grazing(FIG9, "P2", n=5, seed=-1),
            lambda: grazing_windows(FIG9, "P6", k=np.array([1j])),
            lambda: grazing_windows(FIG9, "P6", k=["a"]),
            lambda: grazing_window(FIG9, "P2").contains("three"),
            lambda: check_grazing(FIG9.replace(k=0), "P2"),
            lambda: check_grazing(FREE.replace(v1=0), "P2"),
            lambda: solve_grazing(FREE, "P2", x_i=1),
            lambda: residual(FIG9, "P2", (1, 3), (1, 2)),
            lambda: residual(FIG9, "P2", (1, 2), (1, 3), "below"),
            lambda: read_phase_text("theta", "pi*pi"),
        ]
    ),
}
