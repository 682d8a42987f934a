"""Columns of exact numbers: pairs of doubles that know how far they may be off.

A rational formula on such columns gives the same doubles as on fractions, for thousands of numbers at once: each
operation keeps a bound of what it lost, and a number is rounded to a double, or compared, only where that bound leaves
no doubt. The rows in doubt are noted. They are left to fractions: a difference that is exactly 0, for instance.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np

from symosc.aliases import Number
from symosc.kernels.double_double import two_product, two_sum
from symosc.kernels.entire import EPS

# Bounds are computed in doubles, too.
BOUND_SLACK = 1.0 + 2.0**-40


class PairColumn:
    """Numbers hi + lo, each known to within `off`.

    Parameters
    ----------
    hi, lo, off : arrays that broadcast
    doubts : bool array, optional
        One per row, shared by all columns of a computation: True where a decision was open.
    """

    __slots__ = ("doubts", "hi", "lo", "off")

    def __init__(self, hi: Any, lo: Any = 0.0, off: Any = 0.0, doubts: np.ndarray | None = None) -> None:
        self.hi, self.lo, self.off, self.doubts = np.asarray(hi), lo, off, doubts

    def _with(self, other: Any) -> PairColumn:
        if isinstance(other, PairColumn):
            return other
        if isinstance(other, Fraction):
            hi = float(other)
            lo = float(other - Fraction(hi))
            return PairColumn(hi, lo, EPS * EPS * abs(hi) * (Fraction(hi) + Fraction(lo) != other))
        return PairColumn(np.asarray(other, dtype=float))

    def _made(self, other: PairColumn, hi: Any, lo: Any, off: Any) -> PairColumn:
        return PairColumn(hi, lo, off * BOUND_SLACK, self.doubts if other.doubts is None else other.doubts)

    def __neg__(self) -> PairColumn:
        return PairColumn(-self.hi, -self.lo, self.off, self.doubts)

    def __abs__(self) -> PairColumn:
        sign = np.where(self.hi < 0.0, -1.0, 1.0)
        return PairColumn(sign * self.hi, sign * self.lo, self.off, self.doubts)

    def __add__(self, other: Any) -> PairColumn:
        b = self._with(other)
        s, e = two_sum(self.hi, b.hi)
        t, f = two_sum(self.lo, b.lo)
        e, lost = two_sum(e, t)
        s, e = two_sum(s, e)
        e, more = two_sum(e, f)
        hi, lo = two_sum(s, e)
        return self._made(b, hi, lo, self.off + b.off + (abs(lost) + abs(more)))

    __radd__ = __add__

    def __sub__(self, other: Any) -> PairColumn:
        return self + -self._with(other)

    def __rsub__(self, other: Any) -> PairColumn:
        return -self + other

    def __mul__(self, other: Any) -> PairColumn:
        b = self._with(other)
        p, e = two_product(self.hi, b.hi)
        cross = abs(self.hi * b.lo) + abs(self.lo * b.hi)
        tail = e + (self.hi * b.lo + self.lo * b.hi)
        hi, lo = two_sum(p, tail)
        lost = np.where(cross == 0.0, 0.0, EPS * (3.0 * cross + abs(tail)) + abs(self.lo * b.lo))
        return self._made(b, hi, lo, lost + abs(self.hi) * b.off + (abs(b.hi) + b.off) * self.off)

    __rmul__ = __mul__

    def __pow__(self, exponent: int) -> PairColumn:
        return self * self if exponent == 2 else NotImplemented

    def __truediv__(self, other: Any) -> PairColumn:
        b = self._with(other)
        first = self.hi / b.hi
        rest = self - b * PairColumn(first)
        second = rest.hi / b.hi
        rest = rest - b * PairColumn(second)
        third = rest.hi / b.hi
        hi, lo = two_sum(first, second)
        lo, lost = two_sum(lo, third)
        hi, lo = two_sum(hi, lo)
        return self._made(b, hi, lo, 1.01 * rest.off / abs(b.hi) + 4.0 * EPS * abs(third) + abs(lost))

    def __rtruediv__(self, other: Any) -> PairColumn:
        return self._with(other) / self

    def _sign(self, other: Any) -> Any:
        """Return the sign of the difference."""
        gap = self - other
        self._doubt(gap, (gap.off != 0.0) & ~(abs(gap.hi) > 1.01 * gap.off))
        return np.sign(gap.hi)

    def _doubt(self, of: PairColumn, open_ones: Any) -> None:
        doubts = self.doubts if of.doubts is None else of.doubts
        if doubts is not None:
            doubts |= open_ones

    def __gt__(self, other: Any) -> Any:
        return self._sign(other) > 0.0

    def __ge__(self, other: Any) -> Any:
        return self._sign(other) >= 0.0

    def __lt__(self, other: Any) -> Any:
        return self._sign(other) < 0.0

    def __eq__(self, other: object) -> Any:
        return self._sign(other) == 0.0

    def __ne__(self, other: object) -> Any:
        return self._sign(other) != 0.0

    __hash__ = None  # type: ignore[assignment]

    def rounded(self) -> Any:
        """Return the nearest doubles; rows where two come into question are noted as doubts."""
        off = np.where(self.off > 0.0, self.off + EPS * abs(self.lo) * (self.lo != 0.0), 0.0)
        sure = (self.hi + (self.lo + off) == self.hi) & (self.hi + (self.lo - off) == self.hi)
        self._doubt(self, ~sure)
        return self.hi


def as_double(value: Any) -> Any:
    """Return a fraction, or a column, as the nearest doubles."""
    return value.rounded() if isinstance(value, PairColumn) else float(value)


def exactly(value: Any) -> Any:
    """Return a double, or an array of them, as an exact number to compute with."""
    return PairColumn(value) if isinstance(value, np.ndarray) else Fraction(value)


def either(condition: Any, one: Any, other: Any) -> Any:
    """Return `one` where a condition holds, else `other`: of single numbers, and of each row of columns."""
    if not isinstance(condition, np.ndarray):
        return one if condition else other
    if not isinstance(one, PairColumn) and not isinstance(other, PairColumn):
        return np.where(condition, one, other)
    some = one if isinstance(one, PairColumn) else other
    a, b = some._with(one), some._with(other)
    hi, lo, off = (np.where(condition, getattr(a, name), getattr(b, name)) for name in ("hi", "lo", "off"))
    return PairColumn(hi, lo, off, some.doubts)


def larger(a: Any, b: Any) -> Any:
    """Return the larger of two numbers, or of each row of two columns."""
    return either(b > a, b, a)


def each(function: Callable[..., float]) -> Callable[..., Any]:
    """Return a function of single numbers as one of arrays: numpy's own has other last bits on some processors."""

    def of_arrays(*columns: Number) -> Any:
        given = np.broadcast_arrays(*columns)
        values = map(function, *(column.ravel().tolist() for column in given))
        return np.fromiter(values, float, given[0].size).reshape(given[0].shape)

    return of_arrays
