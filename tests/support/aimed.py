"""Starts whose velocity peaks at a belt's speed, in 110 digits."""

from __future__ import annotations

import random
from fractions import Fraction
from functools import lru_cache
from math import cos, sin
from typing import Any, NamedTuple

import mpmath
from agreement import CONTACTS
from oracle import flow_oracle
from touches import tenths

from symosc import Parameters


class Aimed(NamedTuple):
    """A start from which the velocity peaks at a belt's speed, plus `height`, at t_m.

    X0 and v0 have 110 digits.
    """

    p: Parameters
    t0: Fraction
    x0: Any
    v0: Any
    t_m: Fraction


def speeds_before(
    p: Parameters, alpha: int, t: float, x: float, v: float, flight: float, steps: int = 20
) -> list[float]:
    """Return the speeds on the way back from a state, roughly: by the midpoint rule."""
    m, c, k, A, B0, Omega = map(float, (p.m, p.c, p.k, p.A(alpha), p.B0, p.Omega))
    h = -flight / steps
    speeds = []
    for _ in range(steps):
        a = (A + B0 * cos(Omega * t) - k * x - c * v) / m
        x_mid = x + h / 2 * v
        v_mid = v + h / 2 * a
        t_mid = t + h / 2
        x = x + h * v_mid
        v = v + h * (A + B0 * cos(Omega * t_mid) - k * x_mid - c * v_mid) / m
        t = t + h
        speeds.append(v)
    return speeds[3:]


@lru_cache
def scene_with_a_peak(seed: str, mapping: str) -> tuple[Parameters, Fraction, Fraction]:
    """Return parameters, t_m and the length of a flight that peaks at the belt then, and is away from belts before."""
    rng = random.Random(seed)
    alpha, boundary, beyond, _ = CONTACTS[mapping]
    while True:
        ranges = {
            "m": (2, 30),
            "c": (0, 20),
            "k": (2, 60),
            "A0": (-30, 30),
            "B0": (10, 90),
            "Omega": (3, 40),
        }
        ranges |= {"v1": (-40, -5), "v2": (5, 40), "mu1": (1, 10), "mu2": (1, 10), "FN": (1, 40)}
        p = Parameters(**{name: tenths(rng, *limits) for name, limits in ranges.items()})
        t_m = tenths(rng, 1, 60)
        flight = tenths(rng, 1, 4)
        v = p.belt(boundary)
        angle = float(p.Omega * t_m)
        if (float(p.k * v) + float(p.B0 * p.Omega) * sin(angle)) * beyond < 0.1:
            continue
        x = (p.A(alpha) + p.B0 * Fraction(cos(angle)) - p.c * v) / p.k
        before = speeds_before(p, alpha, float(t_m), float(x), float(v), float(flight))
        inside = alpha != 2 or all(
            float(p.v1) + 0.1 < speed < float(p.v2) - 0.1 for speed in before
        )
        if inside and all(beyond * (float(v) - speed) > 0 for speed in before):
            return p, t_m, flight


def aimed(seed: str, mapping: str, height: Fraction = Fraction(0)) -> Aimed:
    (p, t_m, flight) = scene_with_a_peak(seed, mapping)
    (alpha, boundary, beyond, _) = CONTACTS[mapping]
    v = p.belt(boundary) + beyond * height
    with mpmath.workdps(120):
        cosine = mpmath.cos(
            mpmath.mpf(t_m.numerator) / t_m.denominator * p.Omega.numerator / p.Omega.denominator
        )
        x = (p.A(alpha) + p.B0 * Fraction(mpmath.nstr(cosine, 110)) - p.c * v) / p.k
    x0, v0, _ = flow_oracle(p, alpha, t_m, x, v, -flight, 110)
    return Aimed(p, t_m - flight, x0, v0, t_m)


def text(value: Any, digits: int) -> str:
    with mpmath.workdps(120):
        return mpmath.nstr(value, digits, strip_zeros=False)
