"""The grazing conditions with one unknown given: equations (54) with F = 0 at the end of the map.

Three equations and an inequality have four unknowns (x_i, Omega t_i, x_j, Omega t_j), the start of a map and its end,
which is the tangency. A given theta_j or x_j fixes the tangency in closed form; x_i or Omega t_i is looked up on the
grazing curve.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.grazing import grazing_window
from symosc.grazing_curves import EPS, POINTS, STRIDE, GrazingCurve, grazing_curve
from symosc.grazing_orbits import PERIODS, GrazingStart, grazing_start, number_of, phase_of, read_angle
from symosc.model import Parameters
from symosc.numerics import mp_context
from symosc.windows import place

UNKNOWNS = ("x_i", "theta_i", "x_j", "theta_j", "theta_m")


def solve_grazing(p: Parameters, mapping: str, *, n: int = POINTS, **given: Any) -> list[GrazingStart]:
    """Solve the grazing conditions of a mapping with one of the unknowns given.

    The map leads from (x_i, theta_i) to the tangency (x_j, theta_j), theta = Omega t mod 2 pi; theta_j is theta_m.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6".
    n : int
        Samples of the curve for x_i and theta_i (`grazing_curve`).
    **given : number
        Exactly one of x_i, theta_i, x_j, theta_j, theta_m.

    Returns
    -------
    list of GrazingStart
        Every solution, in order of theta_m.

    Raises
    ------
    ParameterError
        If not exactly one unknown is given, or the mapping has no grazing.
    """
    if len(given) != 1 or next(iter(given)) not in UNKNOWNS:
        raise ParameterError("given", ", ".join(given) or None, f"give exactly one of {', '.join(UNKNOWNS)}")
    name, value = next(iter(given.items()))
    window = grazing_window(p, mapping)
    if name in ("theta_m", "theta_j"):
        phases = [value]
    elif name == "x_j":
        phases = _phases_of_contact(p, mapping, value)
    else:
        wanted = float(number_of(read_angle(name, value), mp_context(30)))
        phases = _phases_on_curve(grazing_curve(p, mapping, n), name, wanted)
    inside = [phase for phase in phases if window.contains(phase_of(read_angle("theta", phase)))]
    starts = [grazing_start(p, mapping, phase) for phase in inside]
    return sorted((start for start in starts if start.found), key=lambda start: float(start.theta_m))


def _phases_of_contact(p: Parameters, mapping: str, value: Any) -> list[Any]:
    """Return the phases theta with x_m(theta) = value, exactly."""
    import sympy

    if p.k == 0 or p.B0 == 0:
        raise ParameterError("x_j", value, "k = 0 or B0 = 0: x_m does not fix the phase")
    where = place(mapping)
    cosine = (p.k * read_exact("x_j", value) + p.c * p.belt(where.boundary) - p.A(where.domain)) / p.B0
    if abs(cosine) > 1:
        return []
    theta = sympy.acos(sympy.Rational(cosine.numerator, cosine.denominator))
    return [theta] if cosine in (1, -1) else [theta, 2 * sympy.pi - theta]


def _phases_on_curve(curve: GrazingCurve, name: str, wanted: float) -> list[float]:
    """Return the phases theta_m at which x_i or theta_i has the wanted value."""
    from scipy.optimize import brentq

    attribute = "x" if name == "x_i" else "theta"
    roots: list[float] = []
    for piece in curve.pieces:
        values, slopes = getattr(piece, attribute), getattr(piece, f"slope_{attribute}")
        turns = 2 * pi * np.arange(-PERIODS, 2) if attribute == "theta" else np.zeros(1)
        low, high = values.min() - STRIDE, values.max() + STRIDE
        for target in wanted + turns[(wanted + turns >= low) & (wanted + turns <= high)]:

            def gap(theta_m: float, target: float = target) -> float:
                return float(getattr(curve.sample(theta_m), attribute)) - target

            for i in range(len(values) - 1):
                points = [float(piece.theta_m[i]), float(piece.theta_m[i + 1])]
                if slopes[i] * slopes[i + 1] < 0:  # an extremum between: it may touch or pass the target
                    points.insert(1, brentq(lambda at: getattr(curve.sample(at), f"slope_{attribute}"), *points))
                for first, last in pairwise(points):
                    ends = gap(first), gap(last)
                    if ends[0] == 0:
                        roots.append(first)
                    elif ends[0] * ends[1] < 0:
                        roots.append(brentq(gap, first, last, xtol=1e-15, rtol=8 * EPS))
    return _distinct(roots)


def _distinct(roots: list[float]) -> list[float]:
    """Return phases mod 2 pi, each once (the ends of a closed curve are one)."""
    kept: list[float] = []
    for root in sorted(root % (2 * pi) for root in roots):
        if not kept or (root - kept[-1] > 1e-9 and root - kept[0] < 2 * pi - 1e-9):
            kept.append(root)
    return kept
