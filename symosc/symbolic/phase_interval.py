"""Intervals of phases: where their sine is smallest and largest, and whether it is attained there, exactly."""

from __future__ import annotations

from typing import Any, NamedTuple

import sympy as sp

from symosc.aliases import Expr
from symosc.errors import ParameterError
from symosc.symbolic.theorem7 import real, sign_of

INTERVAL_FORMS = "must be a phase, or an interval of phases: a pair (low, high) with low < high, or a sympy Interval"


class Extreme(NamedTuple):
    """A phase where the sine over an interval is smallest or largest; not attained at an open end."""

    theta: Expr
    attained: bool


class PhaseInterval(NamedTuple):
    """An interval of phases, of any length up to a turn and with ends of any size.

    Attributes
    ----------
    low, high : sympy numbers
    low_open, high_open : bool
    """

    low: Expr
    high: Expr
    low_open: bool = False
    high_open: bool = False

    def set(self) -> Expr:
        """Return it as a sympy Interval."""
        return sp.Interval(self.low, self.high, self.low_open, self.high_open)

    def extremes(self) -> tuple[Extreme, Extreme]:
        """Return where the sine is smallest and where it is largest."""
        return self._extreme(-1), self._extreme(1)

    def between(self) -> Expr:
        """Return a phase inside, whose sine is neither the smallest nor the largest one."""
        sines = [sp.sin(each.theta) for each in self.extremes()]
        for parts in (2, 3, 5):
            theta = self.low + (self.high - self.low) / parts
            if all(sign_of(sp.sin(theta) - sine) for sine in sines):
                return theta
        raise AssertionError("three phases cannot all be extreme")

    def _extreme(self, sign: int) -> Extreme:
        """Return where sign sin(theta) is largest."""
        # Tops of sign sin are at sign pi/2 + 2 pi n. The first one after the low end may be inside.
        top = sign * sp.pi / 2
        first = top + 2 * sp.pi * sp.ceiling((self.low - top) / (2 * sp.pi))
        ends = [Extreme(self.low, not self.low_open), Extreme(self.high, not self.high_open)]
        if sign_of(first - self.low) > 0 and sign_of(self.high - first) > 0:
            return Extreme(first, True)
        difference = sign_of(sign * (sp.sin(self.high) - sp.sin(self.low)))
        if difference == 0:  # one of them is as good as the other: an attained one is wanted
            return max(ends, key=lambda end: end.attained)
        return ends[difference > 0]


def read_phases(name: str, value: Any) -> Expr | PhaseInterval:
    """Return a phase as a sympy expression, or an interval of them.

    Raises
    ------
    ParameterError
        For what is neither, an interval without length, and one that is longer than a turn.
    """
    if isinstance(value, sp.Interval):
        ends, open_ends = (value.start, value.end), (bool(value.left_open), bool(value.right_open))
    elif isinstance(value, tuple | list):
        if len(value) != 2:
            raise ParameterError(name, value, INTERVAL_FORMS)
        ends, open_ends = tuple(value), (False, False)
    else:
        return real(name, value)
    low, high = (real(name, end) for end in ends)
    if low.free_symbols or high.free_symbols:
        raise ParameterError(name, value, "the ends of an interval must be numbers")
    if sign_of(high - low) <= 0:
        raise ParameterError(
            name, value, "the interval must go from a lower to a higher phase; (7*pi/4, 9*pi/4) has 0 in"
        )
    if sign_of(high - low - 2 * sp.pi) > 0:
        raise ParameterError(name, value, "the interval is longer than a turn")
    return PhaseInterval(low, high, *open_ends)
