"""Random parameters of windows, and their ends to 50 digits."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import mpmath

from symosc.model import Parameters


def parameters(rng: random.Random) -> Parameters:
    """Random rational parameters.

    About a third at or next to |k v| = |B0| Omega, on one of the belts, or at zero.
    """

    def number(low: int, high: int) -> Fraction:
        return Fraction(rng.randint(low, high), rng.randint(1, 30))

    values = {
        "m": number(1, 90),
        "c": number(0, 40),
        "k": number(0, 90),
        "A0": number(-99, 99),
        "B0": number(-99, 99),
    }
    values |= {
        "Omega": number(1, 90),
        "v1": number(-90, 60),
        "mu1": number(0, 30),
        "mu2": number(0, 30),
    }
    values |= {"FN": number(0, 90)}
    values["v2"] = values["v1"] + number(1, 90)
    style = rng.randrange(12)
    belt = values[rng.choice(["v1", "v2"])]
    if style < 6 and values["k"] * belt:
        off = [0, 0, 0, 0, Fraction(1, 10**9), Fraction(-1, 10**20)][style]
        values["B0"] = rng.choice([1, -1]) * values["k"] * belt / values["Omega"] * (1 + off)
    if style == 6:
        values[rng.choice(["k", "B0", "v1", "v2"])] = Fraction(0)
        values["v2"] = max(values["v2"], values["v1"] + 1)
    return Parameters(**values)


def exact_ends(level: Any, swing: Any) -> set[Any]:
    """Return theta_cr, pi - theta_cr and theta_cr + 2 pi with 100 digits."""
    big = mpmath.mp.clone()
    big.dps = 150
    level = big.mpf(level.numerator) / level.denominator
    swing = big.mpf(swing.numerator) / swing.denominator
    cut = big.asin(-level / swing)
    return {cut, big.pi - cut, cut + 2 * big.pi}


def ulps(found: float, ends: set[Any]) -> float:
    return float(min(abs(found - end) for end in ends) / math.ulp(found))
