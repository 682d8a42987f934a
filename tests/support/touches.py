"""Motions that touch a belt at known times, exactly: every number of a scene is rational, every time a closed form."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from math import pi, sqrt
from typing import Any, NamedTuple

import mpmath

from symosc import Parameters

# mapping: domain, belt, and the side of the belt that the motion does not reach
NEIGHBOURS = {"P2": (1, 1, 1), "P3": (2, 1, -1), "P5": (2, 2, 1), "P6": (3, 2, -1)}
# (R, Q) with R^2 + Q^2 = 1: the steady motion x = p + R cos(Omega t) + Q sin(Omega t)
PYTHAGORAS = [(0, 1), (3, 4), (5, 12), (-3, 4), (-8, 15), (20, 21), (4, 3)]


class Touching(NamedTuple):
    """A scene and the times of all its events, which are touches of `boundary` from `domain`."""

    p: Parameters
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    times: list[float]
    boundary: int
    domain: int


def tenths(rng: random.Random, low: int, high: int) -> Fraction:
    return Fraction(rng.randint(low, high), 10)


def belts(rng: random.Random, mapping: str, touched: Fraction, away: Fraction) -> dict[str, Fraction]:
    """Return belt speeds and friction, with one belt at `touched` and the other `away` from it."""
    alpha, boundary, _ = NEIGHBOURS[mapping]
    below = alpha == 1 or (alpha == 2 and boundary == 1)
    low, high = (touched, touched + away) if below else (touched - away, touched)
    mu1, mu2 = tenths(rng, 0, 10), tenths(rng, 0, 10)
    return {"v1": low, "v2": high, "mu1": mu1, "mu2": mu2, "FN": tenths(rng, 1, 40)}


def steady(
    rng: random.Random,
    mapping: str,
    *,
    m: Fraction,
    c: Fraction,
    Omega: Fraction,
    radius: Fraction,
    direction: tuple[Any, Any],
    touches: int = 3,
) -> Touching | None:
    """Return the steady motion of a driven and damped mass; its velocity just reaches a belt once a period.

    With k - m Omega^2 = kappa R and c Omega = kappa Q it is x = p + R cos(Omega t) + Q sin(Omega t) for
    B0 = kappa (R^2 + Q^2). None if k would be negative.
    """
    alpha, boundary, side = NEIGHBOURS[mapping]
    R, Q = direction[0] * radius, direction[1] * radius
    kappa = c * Omega / Q
    k = m * Omega**2 + kappa * R
    if k < 0:
        return None
    peak = Omega * radius
    numbers = belts(rng, mapping, side * peak, peak * tenths(rng, 21, 60))
    A0 = tenths(rng, -30, 30) if k else Fraction(0)
    p = Parameters(m=m, c=c, k=k, A0=A0, B0=kappa * radius**2, Omega=Omega, **numbers)
    p = p if k else p.replace(A0=-p.A(alpha))
    first, period = float(phase_of_touch(side * R, side * Q)) / float(Omega), 2 * pi / float(Omega)
    times = [first + n * period for n in range(touches)]
    x0 = (p.A(alpha) / k if k else 0) + R
    return Touching(p, x0, Omega * Q, Fraction(times[-1] + period / 2), times, boundary, alpha)


def phase_of_touch(R: Fraction, Q: Fraction, digits: int = 40) -> Any:
    """Return the phase in (0, 2 pi] at which Q cos(theta) - R sin(theta) is largest."""
    with mpmath.workdps(digits):
        angle = mpmath.atan2(-mpmath.mpf(R.numerator) / R.denominator, mpmath.mpf(Q.numerator) / Q.denominator)
        return angle if angle > 0 else angle + 2 * mpmath.pi


def unit(pair: tuple[int, int]) -> tuple[Fraction, Fraction]:
    """Return a whole-number pair of whole length, divided by its length."""
    length = sqrt(pair[0] ** 2 + pair[1] ** 2)
    return Fraction(pair[0], round(length)), Fraction(pair[1], round(length))


def ordinary(rng: random.Random, mapping: str) -> Touching:
    """Return a steady motion that touches, with rates of the order of 1."""
    ranges = {"m": (2, 30), "c": (1, 80), "Omega": (3, 40), "radius": (5, 30)}
    return _drawn(rng, mapping, lambda name: tenths(rng, *ranges[name]))


def wild(rng: random.Random, mapping: str) -> Touching:
    """Return a steady motion that touches, with rates and sizes over many decades."""
    decades = {"m": (-4, 1), "c": (-6, 2), "Omega": (-3, 2), "radius": (-3, 3)}
    return _drawn(rng, mapping, lambda name: Fraction(f"{10 ** rng.uniform(*decades[name]):.3g}"))


def _drawn(rng: random.Random, mapping: str, number: Callable[[str], Fraction]) -> Touching:
    found = None
    while found is None:
        numbers = {name: number(name) for name in ("m", "c", "Omega", "radius")}
        found = steady(rng, mapping, **numbers, direction=unit(rng.choice(PYTHAGORAS)))
    return found


def at_a_seam(rng: random.Random, mapping: str, offset: float, length: int = 50) -> Touching:
    """Return a lightly damped motion whose first touch lies `offset` beside the end of one search and the next's start.

    A search is `length` over the natural frequency long (`symosc.engine.flow.LONGEST_PHASE`); so the spring is chosen.
    """
    side = NEIGHBOURS[mapping][2]
    n = rng.randint(1000, 9000)  # R/Q large: the motion is nearly that of a spring without a damper
    R, Q = Fraction(n * n - 1, n * n + 1), Fraction(2 * n, n * n + 1)
    Omega, m, searches = tenths(rng, 3, 40), tenths(rng, 2, 30), rng.randint(1, 4)
    with mpmath.workdps(50):
        touch = phase_of_touch(side * R, side * Q, 50) * Omega.denominator / Omega.numerator
        square = Fraction(mpmath.nstr((length * searches / (touch + mpmath.mpf(offset))) ** 2, 40))
    c = (square - Omega**2) * m * Q / (R * Omega)
    found = steady(rng, mapping, m=m, c=c, Omega=Omega, radius=tenths(rng, 5, 30), direction=(R, Q), touches=2)
    assert found is not None
    assert c**2 < 4 * m * found.p.k
    return found


def undriven(rng: random.Random, mapping: str) -> Touching:
    """Return an undamped mass without drive that leaves its belt with F = 0: it is back there once a period."""
    alpha, boundary, side = NEIGHBOURS[mapping]
    m, k, speed = tenths(rng, 1, 50), tenths(rng, 1, 90), side * tenths(rng, 1, 60)
    away = 2 * abs(speed) + tenths(rng, 1, 50)
    p = Parameters(
        m=m, c=0, k=k, A0=tenths(rng, -50, 50), B0=0, Omega=tenths(rng, 1, 40), **belts(rng, mapping, speed, away)
    )
    period = 2 * pi * sqrt(m / k)
    times = [n * period for n in range(1, 7)]
    return Touching(p, p.A(alpha) / k, speed, Fraction(times[-1] + period / 2), times, boundary, alpha)


def free(rng: random.Random, mapping: str) -> Touching:
    """Return a mass without spring and damper: v = v0 + B0/(m Omega) sin(Omega t)."""
    alpha, boundary, side = NEIGHBOURS[mapping]
    m, Omega, v0 = tenths(rng, 1, 50), tenths(rng, 3, 40), tenths(rng, -20, 20)
    B0 = tenths(rng, 1, 60) * rng.choice([-1, 1])
    swing = abs(B0) / (m * Omega)
    numbers = belts(rng, mapping, v0 + side * swing, 2 * swing + tenths(rng, 1, 30))
    p = Parameters(m=m, c=0, k=0, A0=0, B0=B0, Omega=Omega, **numbers)
    p, period = p.replace(A0=-p.A(alpha)), 2 * pi / float(Omega)
    phase = 0.25 if side * B0 > 0 else 0.75
    times = [(n + phase) * period for n in range(4)]
    return Touching(p, tenths(rng, -20, 20), v0, Fraction(times[-1] + period / 4), times, boundary, alpha)
