"""Constants of random parameters, for the pieces of the event search."""

from __future__ import annotations

import random

from symosc import Parameters
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import Constants


def constants_of(rng: random.Random, **fixed: object) -> Constants:
    """Return constants of random parameters: under- and overdamped, near resonance and far from it."""
    numbers = {name: round(10 ** rng.uniform(-1, 1), 6) for name in ("m", "c", "k", "B0", "Omega", "FN")}
    if rng.random() < 0.3:
        numbers |= {"k": numbers["m"] * numbers["Omega"] ** 2, "c": round(10 ** rng.uniform(-9, -2), 12)}
    p = Parameters(**(numbers | {"A0": 1, "v1": -1, "v2": 1, "mu1": 0.3, "mu2": 0.2} | fixed))
    return Arithmetic(p).K
