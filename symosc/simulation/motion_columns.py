"""What the derivatives of a motion need whatever its friction law is: its arithmetic, the loops of
`symosc.engine.tangent`, and how exponents follow from what they return.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, log, nan, sqrt
from typing import Any

import numpy as np

from symosc.engine.arithmetic import mp_context
from symosc.engine.flow import table_of
from symosc.kernels import linear
from symosc.mappings.equations import MapArithmetic, map_arithmetic
from symosc.simulation.loops import CHOICE
from symosc.simulation.trajectory import Trajectory

#: Digits beyond those that are asked for.
SPARE = 10
#: Parts of a motion whose exponents tell how much the mean of all scatters, and the least number of
#: events to divide.
PARTS = 16
LEAST_EVENTS = 4 * PARTS
#: With more events or times than this, compiled code is looked for on disk.
MANY = 2_000


class MotionColumns:
    """A motion whose derivatives are computed in columns of doubles or mpmath numbers."""

    def __init__(self, trajectory: Trajectory) -> None:
        self.trajectory = trajectory
        if trajectory.digits is None:
            self.kind: Any = float
        else:
            self.kind = object

    @property
    def context(self) -> Any:
        """The mpmath context of the numbers, None for doubles.

        It is not stored, as a context cannot be pickled.
        """
        digits = self.trajectory.digits
        if digits is None:
            return None
        return mp_context(digits + SPARE)

    def arithmetic(self, row: int = 0) -> MapArithmetic:
        """Return the constants in a row of the law, kernels by name and a conversion of Fractions,
        for doubles or for mpmath.
        """
        return map_arithmetic(self.trajectory.parameters, self.context, row)

    @property
    def numbers(self) -> MapArithmetic:
        """The arithmetic with the first row of constants."""
        return self.arithmetic()

    def loop(self, name: str, count: int, row: int = 0) -> tuple[Callable[..., None], Any]:
        """Return the function `name` of `symosc.engine.tangent` for `count` events or times, and
        the constants in a row of the law for it.
        """
        numbers = self.arithmetic(row)
        if self.context is None:
            compiled = CHOICE.of_derivatives_on_disk(count > MANY)
        else:
            compiled = None
        if compiled:
            return compiled[name], table_of([numbers.K])
        return numbers.of[name], [numbers.K]


def both_exponents(grown: float, last: np.ndarray, volume: float, span: float) -> np.ndarray:
    """Return the Lyapunov exponents of a motion that lasts for `span`, the larger one first.

    `grown` is the logarithm by which the derivatives of x and v by x0 and v0, at the end `last`,
    are to be multiplied, and `volume` that of the factor of areas.
    """
    stretch = linear.largest_stretch(last.astype(float))
    if stretch > 0.0:
        first = (grown + log(stretch)) / span
    else:
        first = -inf
    if volume > -inf:
        # Both exponents together are the growth of areas.
        second = volume / span - first
    else:
        second = -inf
    return np.array(sorted((first, second), reverse=True))


def cuts_of_parts(events: int) -> list[int]:
    """Return the numbers of events after which the parts of a motion end."""
    return np.linspace(0, events, PARTS + 1).astype(int)[1:].tolist()


def error_of_mean(grown: Sequence[float], times: Sequence[Any]) -> float:
    """Return the standard error of the first exponent, from what lengths have grown by at the ends
    of parts, and their times.
    """
    if len(times) < 2:
        return nan
    rates = np.diff(grown) / np.diff(np.array(times, dtype=float))
    return float(rates.std(ddof=1) / sqrt(PARTS))
