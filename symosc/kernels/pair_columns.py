"""Columns of numbers in pairs of doubles, about 30 digits: rational formulas for thousands of
numbers at once.

A difference that cancels almost all digits, but not all, may be 0 in truth: such rows are noted for
exact arithmetic.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from math import atan2
from typing import Any

import numpy as np

from symosc.kernels.double_double import pair_product, pair_quotient, pair_sum
from symosc.kernels.pair_programs import CANCELLED, Angle, Recorded


def _comparison(name: str) -> Callable[[Any, Any], Any]:
    """Return a method that compares two columns row by row by the operator `name`, such as "gt"."""
    compare = getattr(operator, name)
    return lambda column, other: compare((column - other).hi, 0.0)


class PairColumn:
    """A column of double-double numbers hi + lo.

    `doubts` flags rows that lost digits, to be computed exactly.
    """

    __slots__ = ("doubts", "hi", "lo")

    def __init__(self, hi: Any, lo: Any = 0.0, doubts: np.ndarray | None = None) -> None:
        self.hi = np.asarray(hi)
        self.lo = lo
        self.doubts = doubts

    @staticmethod
    def _as_column(other: Any) -> PairColumn:
        """Convert an operand (a column, a Fraction, a number or an array) to a column of pairs."""
        if isinstance(other, PairColumn):
            return other
        if isinstance(other, Fraction):
            return PairColumn(float(other), float(other - Fraction(float(other))))
        return PairColumn(np.asarray(other, dtype=float))

    def _with_doubts(self, other: PairColumn, hi: Any, lo: Any) -> PairColumn:
        """Return hi + lo, computed from this column and `other`, as a column with the doubts of
        both.
        """
        return PairColumn(hi, lo, self.doubts if other.doubts is None else other.doubts)

    def __neg__(self) -> PairColumn:
        return PairColumn(-self.hi, -self.lo, self.doubts)

    def __abs__(self) -> PairColumn:
        sign = np.where(self.hi < 0.0, -1.0, 1.0)
        return PairColumn(sign * self.hi, sign * self.lo, self.doubts)

    def __add__(self, other: Any) -> PairColumn:
        b = self._as_column(other)
        made = self._with_doubts(b, *pair_sum(self.hi, self.lo, b.hi, b.lo))
        if made.doubts is not None:
            made.doubts |= (made.hi != 0.0) & (abs(made.hi) < CANCELLED * abs(self.hi))
        return made

    __radd__ = __add__

    def __sub__(self, other: Any) -> PairColumn:
        return self + -self._as_column(other)

    def __rsub__(self, other: Any) -> PairColumn:
        return -self + other

    def __mul__(self, other: Any) -> PairColumn:
        b = self._as_column(other)
        return self._with_doubts(b, *pair_product(self.hi, self.lo, b.hi, b.lo))

    __rmul__ = __mul__

    def __pow__(self, exponent: int) -> PairColumn:
        if exponent == 2:
            return self * self
        return NotImplemented

    def __truediv__(self, other: Any) -> PairColumn:
        b = self._as_column(other)
        return self._with_doubts(b, *pair_quotient(self.hi, self.lo, b.hi, b.lo))

    def __rtruediv__(self, other: Any) -> PairColumn:
        return self._as_column(other) / self

    __gt__, __ge__, __lt__, __eq__, __ne__ = map(_comparison, ("gt", "ge", "lt", "eq", "ne"))
    __hash__ = None  # type: ignore[assignment]


def as_double(value: Any) -> Any:
    """Convert a Fraction, or a column of pairs, to doubles."""
    if isinstance(value, PairColumn):
        return value.hi
    if isinstance(value, Recorded):
        return value.as_double()
    return float(value)


def exactly(value: Any) -> Any:
    """Convert a double to a Fraction, or an array of doubles to a column of pairs, without
    rounding.
    """
    if isinstance(value, np.ndarray):
        return PairColumn(value)
    if isinstance(value, Recorded):
        return value.exactly()
    return Fraction(value)


def either(condition: Any, value: Any, fallback: Any) -> Any:
    """Return `value` where a condition holds, else `fallback`, for single numbers or row by row."""
    if isinstance(condition, Recorded):
        return condition.either(value, fallback)
    if not isinstance(condition, np.ndarray):
        if condition:
            return value
        return fallback
    if not isinstance(value, PairColumn) and not isinstance(fallback, PairColumn):
        return np.where(condition, value, fallback)
    if isinstance(value, PairColumn):
        some = value
    else:
        some = fallback
    a = some._as_column(value)
    b = some._as_column(fallback)
    return some._with_doubts(b, np.where(condition, a.hi, b.hi), np.where(condition, a.lo, b.lo))


def sign(value: Any) -> Any:
    """Return the sign -1, 0 or 1 of a number as a Fraction, or of each row of a column as a column."""
    if isinstance(value, PairColumn):
        return PairColumn(np.sign(value.hi))
    if isinstance(value, Recorded):
        return value.sign()
    return Fraction(int(value > 0) - int(value < 0))


def larger(a: Any, b: Any) -> Any:
    """Return the larger of two numbers, or the row-by-row maximum of two columns."""
    return either(b > a, b, a)


def atan2_of_columns(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return atan2 row by row; numpy's own differs in the last bits on some processors."""
    return np.asarray(np.frompyfunc(atan2, 2, 1)(y, x), float)


def root_of_columns(value: Any) -> Any:
    """Return the square root of a column of doubles, or of a recorded double."""
    if isinstance(value, Recorded):
        return value.root()
    return np.sqrt(value)


def angle_of_columns(y: Any, x: Any) -> Any:
    """Return atan2 of columns of doubles, or of recorded doubles."""
    if isinstance(y, Recorded):
        return Angle(y, x)
    return atan2_of_columns(y, x)
