"""Motions that touch a belt at known times, exactly.

Every number of a scene is rational, every time a closed form.
"""

from __future__ import annotations

import random
from fractions import Fraction
from math import pi
from typing import Any, NamedTuple

import mpmath

from symosc import Parameters

# mapping: domain, belt, and the side of the belt that the motion does not reach
NEIGHBOURS = {"P2": (1, 1, 1), "P3": (2, 1, -1), "P5": (2, 2, 1), "P6": (3, 2, -1)}


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


def belts(
    rng: random.Random, mapping: str, touched: Fraction, away: Fraction
) -> dict[str, Fraction]:
    """Return belt speeds and friction, with one belt at `touched` and the other `away` from it."""
    alpha, boundary, _ = NEIGHBOURS[mapping]
    below = alpha == 1 or (alpha == 2 and boundary == 1)
    if below:
        low, high = (touched, touched + away)
    else:
        low, high = (touched - away, touched)
    mu1 = tenths(rng, 0, 10)
    mu2 = tenths(rng, 0, 10)
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
    """Return the steady motion of a driven and damped mass.

    Its velocity just reaches a belt once a period.

    With k - m Omega^2 = kappa R and c Omega = kappa Q it is x = p + R cos(Omega t) + Q sin(Omega t)
    for B0 = kappa (R^2 + Q^2). None if k would be negative.
    """
    alpha, boundary, side = NEIGHBOURS[mapping]
    R = direction[0] * radius
    Q = direction[1] * radius
    kappa = c * Omega / Q
    k = m * Omega**2 + kappa * R
    if k < 0:
        return None
    peak = Omega * radius
    numbers = belts(rng, mapping, side * peak, peak * tenths(rng, 21, 60))
    if k:
        A0 = tenths(rng, -30, 30)
    else:
        A0 = Fraction(0)
    p = Parameters(m=m, c=c, k=k, A0=A0, B0=kappa * radius**2, Omega=Omega, **numbers)
    if not k:
        p = p.replace(A0=-p.A(alpha))
    first = float(phase_of_touch(side * R, side * Q)) / float(Omega)
    period = 2 * pi / float(Omega)
    times = [first + n * period for n in range(touches)]
    x0 = (p.A(alpha) / k if k else 0) + R
    return Touching(p, x0, Omega * Q, Fraction(times[-1] + period / 2), times, boundary, alpha)


def phase_of_touch(R: Fraction, Q: Fraction, digits: int = 40) -> Any:
    """Return the phase in (0, 2 pi] at which Q cos(theta) - R sin(theta) is largest."""
    with mpmath.workdps(digits):
        angle = mpmath.atan2(
            -mpmath.mpf(R.numerator) / R.denominator, mpmath.mpf(Q.numerator) / Q.denominator
        )
        if angle > 0:
            return angle
        return angle + 2 * mpmath.pi


def at_a_seam(rng: random.Random, mapping: str, offset: float, length: int = 50) -> Touching:
    """Return a lightly damped motion whose first touch lies `offset` beside the end of one search and the next's start.

    A search is `length` over the natural frequency long (`symosc.engine.flow.LONGEST_PHASE`); so
    the spring is chosen.
    """
    side = NEIGHBOURS[mapping][2]
    n = rng.randint(1000, 9000)  # R/Q large: the motion is nearly that of a spring without a damper
    R = Fraction(n * n - 1, n * n + 1)
    Q = Fraction(2 * n, n * n + 1)
    Omega = tenths(rng, 3, 40)
    m = tenths(rng, 2, 30)
    searches = rng.randint(1, 4)
    with mpmath.workdps(50):
        touch = phase_of_touch(side * R, side * Q, 50) * Omega.denominator / Omega.numerator
        square = Fraction(mpmath.nstr((length * searches / (touch + mpmath.mpf(offset))) ** 2, 40))
    c = (square - Omega**2) * m * Q / (R * Omega)
    found = steady(
        rng, mapping, m=m, c=c, Omega=Omega, radius=tenths(rng, 5, 30), direction=(R, Q), touches=2
    )
    assert found is not None
    assert c**2 < 4 * m * found.p.k
    return found
