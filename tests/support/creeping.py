"""Motions that creep up to a belt's speed, and whether they get there."""

from __future__ import annotations

import random
from fractions import Fraction
from math import log
from typing import NamedTuple

from touches import tenths

from symosc import Parameters

# domain of the flight, belt ahead, and the side on which that is
AHEAD = {"Omega1 up": (1, 1, 1), "Omega2 down": (2, 1, -1), "Omega2 up": (2, 2, 1), "Omega3 down": (3, 2, -1)}


class Creeping(NamedTuple):
    """A start whose velocity creeps up to a belt, and when it gets there, if it does."""

    p: Parameters
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    contact: float | None


def parameters(rng: random.Random, flight: str, speed: Fraction, m: Fraction, c: Fraction, k: Fraction) -> Parameters:
    _, boundary, _ = AHEAD[flight]
    away = tenths(rng, 120, 300)
    low, high = (speed, speed + away) if boundary == 1 else (speed - away, speed)
    friction = {"mu1": tenths(rng, 0, 10), "mu2": tenths(rng, 0, 10), "FN": tenths(rng, 1, 40)}
    Omega = Fraction(rng.choice(["1/1000", "1/100", "1/10", "1", "3/2", "5"]))
    return Parameters(m=m, c=c, k=k, A0=tenths(rng, -30, 30), B0=0, Omega=Omega, v1=low, v2=high, **friction)


def to_a_belt_at_rest(rng: random.Random, flight: str, push: Fraction, critical: bool = False) -> Creeping:
    """Return an overdamped start without drive, with rational roots -r1, -r2, towards a belt at rest.

    With the gap g = |v| it is u = g' + r2 g = `push` at the start; g = 0 comes only if that is negative.
    """
    alpha, _, side = AHEAD[flight]
    r1 = Fraction(rng.randint(1, 40), 20)
    r2 = r1 if critical else r1 * Fraction(rng.randint(11, 100), 10)
    m, gap = tenths(rng, 2, 30), tenths(rng, 1, 50)
    p = parameters(rng, flight, Fraction(0), m, m * (r1 + r2), m * r1 * r2)
    v0, a0 = -side * gap, -side * (push - r2 * gap)
    x0 = (p.A(alpha) - p.c * v0 - m * a0) / p.k
    if push >= 0:
        return Creeping(p, x0, v0, 100 / r1, None)
    ratio = float(gap / -push)
    t = ratio if critical else log(1 + float(r2 - r1) * ratio) / float(r2 - r1)
    return Creeping(p, x0, v0, Fraction(str(round(1.5 * t, 3))), t)


def to_a_limit_speed(rng: random.Random, flight: str, beyond: Fraction) -> Creeping:
    """Return a start without spring and drive whose velocity tends to a point `beyond` a belt's speed."""
    alpha, _, side = AHEAD[flight]
    m, c, speed = tenths(rng, 1, 50), tenths(rng, 1, 50), tenths(rng, -50, 50)
    p = parameters(rng, flight, speed, m, c, Fraction(0))
    p = p.replace(A0=p.A0 + c * (speed + side * beyond) - p.A(alpha))
    gap = tenths(rng, 1, 50)
    t = float(m / c) * log(1 + float(gap / beyond)) if beyond else None
    t_end = Fraction(str(round(1.5 * t, 3))) if t else 200 * m / c
    return Creeping(p, tenths(rng, -30, 30), speed - side * gap, t_end, t)


def with_a_tiny_drive(rng: random.Random, flight: str, size: int) -> Creeping:
    """Return an overdamped start towards a belt at rest, with a drive of 1e-size, followed till that counts."""
    alpha, _, side = AHEAD[flight]
    r1 = tenths(rng, 10, 40)
    r2, m = r1 * Fraction(rng.randint(11, 40), 10), tenths(rng, 2, 30)
    p = parameters(rng, flight, Fraction(0), m, m * (r1 + r2), m * r1 * r2)
    p = p.replace(B0=rng.choice([-1, 1]) * Fraction(rng.randint(1, 9), 10**size), Omega=rng.choice(["1/2", "1", "2"]))
    v0 = -side * tenths(rng, 1, 30)
    x0 = (p.A(alpha) - p.c * v0 + m * r1 * v0) / p.k  # about on the slow manifold
    return Creeping(p, x0, v0, Fraction(round(2.4 * size / float(r1))) + 6, None)
