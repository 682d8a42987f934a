"""Families of random problems: a set of parameters and a start."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from touches import tenths

from symosc import Parameters

Problem = tuple[Parameters, dict[str, Any]]
ORDINARY = {
    "m": (2, 30),
    "c": (0, 20),
    "k": (2, 60),
    "A0": (-30, 30),
    "B0": (10, 100),
    "Omega": (3, 40),
}
ORDINARY |= {"mu1": (0, 10), "mu2": (0, 10), "FN": (1, 150)}


def ordinary(rng: random.Random, **changes: Any) -> Problem:
    numbers = {name: tenths(rng, *limits) for name, limits in ORDINARY.items()}
    v1 = tenths(rng, -30, 20)
    p = Parameters(**(numbers | {"v1": v1, "v2": v1 + tenths(rng, 1, 40)} | changes))
    t0 = tenths(rng, -50, 50)
    return p, {"t0": t0, "x0": tenths(rng, -30, 30), "v0": tenths(rng, -40, 70), "t_end": t0 + 20}


def late(rng: random.Random) -> Problem:
    p, start = ordinary(rng)
    t0 = rng.choice([-1, 1]) * Fraction(f"{10 ** rng.uniform(3, 12):.9g}") + tenths(rng, 0, 9) / 3
    return p, start | {"t0": t0, "t_end": t0 + 20}


def slow(rng: random.Random) -> Problem:
    Omega = Fraction(f"{10 ** rng.uniform(-6, -2):.4g}")
    p, start = ordinary(
        rng, Omega=Omega, B0=tenths(rng, 100, 400), c=tenths(rng, 80, 120), k=tenths(rng, 1, 10)
    )
    return p, start | {"t_end": start["t0"] + 5 / Omega, "max_events": 60}


def light(rng: random.Random) -> Problem:
    p, start = ordinary(rng, m=Fraction(f"{10 ** rng.uniform(-4, -1):.4g}"))
    return p, start | {"max_events": 60}


def stiff(rng: random.Random) -> Problem:
    p, start = ordinary(rng, k=Fraction(f"{10 ** rng.uniform(1, 4):.4g}"))
    return p, start | {"max_events": 60}


def no_spring(rng: random.Random) -> Problem:
    return ordinary(rng, k=0, c=rng.choice([0, tenths(rng, 1, 9)]))


def resonant(rng: random.Random) -> Problem:
    m = tenths(rng, 2, 30)
    Omega = tenths(rng, 3, 40)
    return ordinary(rng, m=m, Omega=Omega, k=m * Omega**2, c=Fraction(rng.randint(0, 9), 1000))


FAMILIES: dict[str, Callable[[random.Random], Problem]] = {
    family.__name__.replace("_", " "): family
    for family in (ordinary, late, slow, light, stiff, no_spring, resonant)
}
