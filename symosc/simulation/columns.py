"""Numbers of many motions as columns: read exactly, checked all at once, and turned into objects one by one on demand.

A float is the decimal that it prints as (`symosc.exact`). In a column it is its double, and what that lacks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sized
from decimal import Context, Decimal
from fractions import Fraction
from math import ulp
from typing import Any

import numpy as np

from symosc.errors import ParameterError
from symosc.exact import LARGEST, read_exact, unmasked
from symosc.kernels.double_double import two_product
from symosc.kernels.entire import EPS
from symosc.kernels.pair_columns import PairColumn

# Decimal powers that are exact as doubles, and the sizes of numbers whose digits they reach.
POWERS = np.array([10.0**n for n in range(23)])
LEAST_IN_REACH, MOST_IN_REACH = 1e-5, 1e15
# A rest that is rounded to a double is off by a little less than half a unit of its last place.
HALF_UNIT = 0.5 * (1.0 - 2.0**-30)
# Enough digits for any double and the decimal that it prints as.
DECIMAL_CONTEXT = Context(prec=800)


class NumberColumn:
    """One number for all rows, or a number for each.

    Parameters
    ----------
    name : str
        What messages call it.
    given : number, sequence or array
        Numbers as `symosc.exact.read_exact` takes them.

    Attributes
    ----------
    parts : hi, lo and off, (1,) or (n,) float arrays
        The numbers as doubles, what these lack, and how far their sum may be from the exact number.
    hi : array

    Raises
    ------
    ParameterError
        If one is no finite number; the message names its row.
    """

    def __init__(self, name: str, given: Any) -> None:
        self.name, self.single = name, _is_single(given)
        self._exact: dict[int, Fraction] = {}
        if not self.single and isinstance(given, np.ndarray) and given.ndim != 1:
            raise ParameterError(name, given, f"must be a number or have shape (n,); it has {given.shape}")
        self._given = given = [given] if self.single else given if isinstance(given, np.ndarray) else list(given)
        if not isinstance(given, np.ndarray) and len(given) > 1 and all(type(value) is float for value in given):
            self._given = given = np.array(given)
        self._parts: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
        if len(given) == 1:  # a single motion asks for the exact number alone
            self._exact[0] = read_exact(self.called(0), given[0])
        else:
            self._parts = self._read()

    def _read(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        given = self._given
        if isinstance(given, np.ndarray) and given.dtype == np.float64:
            return self._of_doubles(given)
        return self._of_any(given)

    @property
    def parts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return hi, lo and off."""
        if self._parts is None:
            self._parts = self._read()
        return self._parts

    @property
    def hi(self) -> np.ndarray:
        """Return the numbers as doubles."""
        return self.parts[0]

    def _of_doubles(self, given: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        for bad, reason in ((~np.isfinite(given), "must be finite"), (abs(given) > float(LARGEST), SIZE)):
            if bad.any():
                row = int(bad.argmax())
                raise ParameterError(self.called(row), float(given[row]), reason)
        lo, sure = decimal_rest(given)
        for row in np.flatnonzero(~sure).tolist():
            value = float(given[row])
            lo[row] = float(DECIMAL_CONTEXT.subtract(Decimal(repr(value)), Decimal(value)))
        return np.array(given), lo, np.where(lo == 0.0, 0.0, HALF_UNIT * np.spacing(abs(lo)))

    def _of_any(self, given: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        known: dict[Any, tuple[float, float, float]] = {}
        rows = []
        for row, value in enumerate(given):
            # Numbers of two types may be equal and mean two fractions: the float 0.1 is 1/10, Fraction(0.1) is not.
            # A fraction is known by its identity: to hash it takes longer than to convert it.
            key = id(value) if isinstance(value, Fraction) else (type(value), value)
            try:
                parts = known.get(key)
            except TypeError:  # a list, or another thing that is no number
                parts = None
            if parts is None:
                exact = self._exact[row] = read_exact(self.called(row), value)
                parts = known[key] = in_parts(exact)
            rows.append(parts)
        hi, lo, off = np.array(rows, dtype=float).reshape(-1, 3).T
        return hi, lo, off

    def __len__(self) -> int:
        return len(self._given)

    def called(self, row: int) -> str:
        """Return what a message calls the number of a row."""
        return self.name if self.single else f"{self.name}[{row}]"

    def exact(self, row: int) -> Fraction:
        """Return the exact number of a row."""
        row = row if len(self) > 1 else 0
        if row not in self._exact:
            if len(self._exact) > 100_000:  # of a long column only a few are asked for again
                self._exact.clear()
            self._exact[row] = read_exact(self.called(row), self._given[row])
        return self._exact[row]

    def pairs(self, rows: slice = slice(None)) -> PairColumn:
        """Return some rows, or the one number, as exact numbers to compute with."""
        rows = rows if len(self) > 1 else slice(None)
        return PairColumn(*(part[rows] for part in self.parts))


def in_parts(exact: Fraction) -> tuple[float, float, float]:
    """Return a number as a double, what that lacks, and how far their sum may be from the number."""
    hi = float(exact)
    rest = exact - Fraction(hi)
    lo = float(rest)
    return hi, lo, 0.0 if lo == rest else HALF_UNIT * ulp(lo)


SIZE = f"must be at most {float(LARGEST):g} in size"


def _is_single(given: Any) -> bool:
    """Return whether something is one number, or no number at all, and not a row of them."""
    shape = getattr(given, "shape", None)
    if isinstance(shape, tuple):
        return shape == ()
    return isinstance(given, (str, bytes, Mapping)) or not isinstance(given, Sized)


def as_given(name: str, value: Any) -> Any:
    """Return a column of pandas or xarray, or an array without dimensions, as numpy has it; masked ones are refused."""
    unmasked(name, value)
    if isinstance(value, np.ndarray) or (hasattr(value, "__array__") and hasattr(value, "shape")):
        array = np.asarray(value)
        return array[()] if array.ndim == 0 else array
    return value


def named(name: str, given: Any, wanted: tuple[str, ...]) -> Any:
    """Return columns that have names in the order of `wanted`: of a mapping, a table, a row of one, or a record array.

    Without names, as pandas' tables have where only positions were given, it is returned as it is.

    Raises
    ------
    ParameterError
        If the names are others.
    """
    names = getattr(getattr(given, "dtype", None), "names", None)
    if isinstance(given, Mapping):
        names = list(given)
    elif names is None and hasattr(given, "__getitem__"):
        labels = getattr(given, "columns", getattr(given, "index", None))  # a list has a method of this name
        names = None if labels is None or callable(labels) else list(labels)
        names = names if names and any(isinstance(each, str) for each in names) else None
    if names is None:
        return given
    if sorted(map(str, names)) != sorted(wanted):
        said = f"must have the names {', '.join(wanted[:-1])} and {wanted[-1]}, and no other"
        raise ParameterError(name, [str(each) for each in names], said)
    return {each: given[each] for each in wanted}


def decimal_rest(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what doubles lack of the shortest decimals that they print as, rounded once, and where that is sure.

    The shortest decimal has 15, 16 or 17 digits: the first of them that is within half a unit of the double. Scaled by
    a power of ten that is exact as a double, its distance from the double is exact.
    """
    size = abs(values)
    inside = (size >= LEAST_IN_REACH) & (size < MOST_IN_REACH) & (np.frexp(size)[0] != 0.5)
    usual = np.where(inside, size, 3.0)
    exponent = np.floor(np.log10(usual)).astype(np.int64)
    unit = 0.5 * np.spacing(usual)
    rest, sure = np.zeros(len(values)), values == 0.0
    whole = inside | sure
    for digits in (15, 16, 17):
        power = POWERS[np.clip(digits - 1 - exponent, 0, 22)]
        high, low = two_product(usual, power)
        near = np.rint(high)
        over = (high - near) + low
        lacking = np.rint(over) - over
        found = inside & ~sure & (abs(lacking) < unit * power)
        rest = np.where(found, np.sign(values) * lacking / power, rest)
        sure = sure | found
    whole_power = ~whole & (size < 2.0**53) & (np.rint(size) == size)  # a power of two, as a rule 1, 2 or 4
    return rest, sure | whole_power


def same(a: NumberColumn, b: NumberColumn, i: int, j: int) -> bool:
    """Return whether row i of one column is exactly row j of another."""
    i, j = (i if len(a) > 1 else 0), (j if len(b) > 1 else 0)
    (hi, lo, off), (other, rest, reach) = ([part[n] for part in column.parts] for column, n in ((a, i), (b, j)))
    if hi != other or abs(lo - rest) > 2.0 * (off + reach) + EPS * abs(lo):
        return False
    return bool(off == 0.0 and reach == 0.0) or a.exact(i) == b.exact(j)
