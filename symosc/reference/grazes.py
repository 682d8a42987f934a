"""Exact grazes: motions that touch a belt and nothing more, for each damping regime, belt and side."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from symosc.aliases import NumberLike
from symosc.grazing.start import grazing_start
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters
from symosc.reference.case import ReferenceCase
from symosc.scenes import Scene

GRAZES = "exact graze"
HARD = "a double root of the velocity: a step sees no change of sign, and rounding of the start makes two roots or none"
SOURCE = "Theorem 7 of the paper (symosc.grazing_start): the flow back from the tangency"
#: Digits of a start. Half of them are left at the touch, where the gap is a square.
TOUCH_DIGITS = 95
#: The exact v0 is within so many units of the last digit: those of x0 and its own.
UNITS_OF_V0 = 5
#: How long before the touch a motion starts, and how long it is followed.
BEFORE, FOLLOWED = Fraction(3, 10), 8

BASE = Parameters(m=1, c=1, k=2, A0=0, B0=4, Omega=1, v1=-1, v2="1/2", mu1="0.3", mu2="0.2", FN=5)
DAMPED: dict[str, dict[str, NumberLike]] = {
    "underdamped": {},
    "critically damped": {"c": 2, "k": 1},
    "overdamped": {"c": 5},
    "undamped": {"c": 0},
    "undamped resonance": {"c": 0, "k": 1},
    "near resonance": {"c": "1e-6", "k": 1},
    "weak spring": {"k": "1e-3"},
}
#: Times of the touches: in the window of Theorem 7, with a flight of `BEFORE` to them.
TOUCHES = {"P2": "1.1", "P3": "3.3", "P5": "0.55", "P6": "3.85"}


def grazes() -> Iterator[ReferenceCase]:
    """Yield the cases."""
    for regime, changes in DAMPED.items():
        p = BASE.replace(**changes)
        for mapping, t_m in TOUCHES.items():
            boundary, domain = place(mapping).boundary, place(mapping).domain
            t0 = Fraction(t_m) - BEFORE
            start = grazing_start(p, mapping, t_m=t_m, t0=t0, digits=TOUCH_DIGITS).start
            error = UNITS_OF_V0 * start["start_error"][2]
            name = f"graze-{regime.replace(' ', '-')}-{mapping}"
            yield ReferenceCase(
                name,
                GRAZES,
                Scene(name, p, t_end=t0 + FOLLOWED, **start | {"start_error": (0, 0, error)}),
                f"{HARD}; {regime}, belt {boundary} touched from domain {domain}",
                SOURCE,
                (f"t[0] = {t_m}",),
            )
