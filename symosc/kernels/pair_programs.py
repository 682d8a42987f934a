"""Programs of pairs: formulas that are recorded once, then computed for thousands of rows by one
compiled loop.

This file is executed with other globals: see symosc/kernels/rebind.py.

`Recorder` makes numbers that note what is done to them: a function of columns
(`symosc.kernels.pair_columns`) that is called with them leaves a list of operations. `run_program`
does these to each row as columns do, with the same bits. So there is one source of the formulas,
and to change it compiles nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import copysign, sqrt
from typing import Any, NamedTuple

import numpy as np

from symosc.kernels.double_double import pair_product, pair_quotient, pair_sum
from symosc.kernels.rebind import outlined

# A sum that is smaller than this part of its terms, and not 0, has lost its digits.
CANCELLED = 2.0**-90
# Rows that are computed together: as many as hide what it costs to read an operation, and so few
# that all registers stay in the processor's nearest cache.
TOGETHER = 32

# Operations, by kind: `run_operation` tells the kinds by their order.
# On pairs; a sum that is watched flags rows that lost their digits.
SUM = 0
WATCHED_SUM = 1
PRODUCT = 2
QUOTIENT = 3
SIZE = 4
SIGN = 5
WIDE = 6  # a double as a pair
# On pairs, and on doubles.
NEGATIVE = 7
CHOICE = 8
# On doubles.
PLUS = 9
MINUS = 10
TIMES = 11
OVER = 12
ABSOLUTE = 13
ROOT = 14
# On doubles, with flags: 1.0 or 0.0.
ABOVE = 15
AT_LEAST = 16
SAME = 17
AND = 18
OR = 19
XOR = 20


class Angle(NamedTuple):
    """A result to be made of two doubles afterwards, by the C library: atan2(y, x)."""

    y: Recorded
    x: Recorded


class Program(NamedTuple):
    """A list of operations for `run_program`.

    Attributes
    ----------
    operations : numpy.ndarray
        Rows of the operation and the registers of its three operands. Its result is in the
        register of its number, behind those of the arguments and the constants.
    constants : numpy.ndarray
        Numbers in pairs; they are in the registers behind those of the arguments.
    results : numpy.ndarray
        The registers of the results.
    angles : list of tuple
        Which result is an angle, and which results are its y and x.
    """

    operations: np.ndarray
    constants: np.ndarray
    results: np.ndarray
    angles: list[tuple[int, int, int]]


class Recorder:
    """The maker of a program: numbers for its arguments, and what is noted of them."""

    # A register is the kind of what it holds ("argument", "constant" or "result") and a number
    # among those: the places are known when all is noted.

    def __init__(self) -> None:
        self._operations = list[tuple[int, Any, Any, Any]]()
        self._arguments = 0
        self._constants = dict[tuple[float, float, float, float], int]()

    def argument(self) -> Recorded:
        """Return the pair that is the next argument of the program."""
        self._arguments += 1
        return Recorded(self, ("argument", self._arguments - 1), is_pair=True, is_watched=True)

    def constant(self, value: Any) -> tuple[str, int]:
        """Return the register of a Fraction or another number."""
        hi = float(value)
        lo = float(value - Fraction(hi)) if isinstance(value, Fraction) else 0.0
        key = hi, lo, copysign(1.0, hi), copysign(1.0, lo)
        return "constant", self._constants.setdefault(key, len(self._constants))

    def register(self, value: Any) -> tuple[str, int]:
        """Return the register of a recorded number, or of a constant."""
        if isinstance(value, Recorded):
            return value.register
        return self.constant(value)

    def note(self, operation: int, *operands: Any) -> tuple[str, int]:
        """Note an operation, and return the register of its result."""
        # An operation has three operands; those that it does not use repeat the first.
        registers = [self.register(operand) for operand in operands]
        registers += registers[:1] * (3 - len(registers))
        self._operations.append((operation, *registers))  # type: ignore[arg-type]
        return "result", len(self._operations) - 1

    def program(self, results: Iterable[Any]) -> Program:
        """Return the program that computes `results`: recorded numbers, constants, or angles of
        which y and x are results too.
        """
        results = list(results)
        wanted = [
            self.register(result.y if isinstance(result, Angle) else result) for result in results
        ]
        angles = [
            (number, wanted.index(result.y.register), wanted.index(result.x.register))
            for number, result in enumerate(results)
            if isinstance(result, Angle)
        ]
        first = {"argument": 0, "constant": self._arguments}
        first["result"] = self._arguments + len(self._constants)
        operations = [
            (operation, *(first[kind] + index for kind, index in operands))
            for operation, *operands in self._operations
        ]
        return Program(
            np.array(operations, np.int64).reshape(-1, 4),
            np.array([key[:2] for key in self._constants], float).reshape(-1, 2),
            np.array([first[kind] + index for kind, index in wanted], np.int64),
            angles,
        )


class Recorded:
    """A pair, a double or a flag of a program that is being recorded.

    A pair is watched if it stands for a column with doubts.
    """

    __hash__ = None  # type: ignore[assignment]
    __slots__ = ("is_pair", "is_watched", "recorder", "register")

    def __init__(
        self,
        recorder: Recorder,
        register: tuple[str, int],
        is_pair: bool = False,
        is_watched: bool = False,
    ) -> None:
        self.recorder = recorder
        self.register = register
        self.is_pair = is_pair
        self.is_watched = is_watched

    def __bool__(self) -> bool:
        raise TypeError("a recorded number has no value: choose by `either`, not by `if`")

    def _pair(self, operation: int, *operands: Any) -> Recorded:
        """Note an operation whose result is a pair; return this pair."""
        is_watched = any(isinstance(entry, Recorded) and entry.is_watched for entry in operands)
        return Recorded(self.recorder, self.recorder.note(operation, *operands), True, is_watched)

    def _double(self, operation: int, *operands: Any) -> Recorded:
        """Note an operation whose result is a double or a flag; return this number."""
        return Recorded(self.recorder, self.recorder.note(operation, *operands))

    def _goes_in_pairs(self, other: Any) -> bool:
        """Return whether an operation with `other` is one of pairs."""
        if isinstance(other, Recorded):
            return self.is_pair or other.is_pair
        return self.is_pair

    def wide(self, value: Any) -> Any:
        """Return a number as a pair: a double needs a low part."""
        if isinstance(value, Recorded) and not value.is_pair:
            return self._pair(WIDE, value)
        return value

    def as_double(self) -> Recorded:
        """Return the pair rounded to a double."""
        return Recorded(self.recorder, self.register)

    def exactly(self) -> Recorded:
        """Return the double as a pair."""
        return self._pair(WIDE, self)

    def sign(self) -> Recorded:
        """Return the sign of a pair, -1, 0 or 1, as a pair that is not watched."""
        return Recorded(self.recorder, self.recorder.note(SIGN, self), True)

    def root(self) -> Recorded:
        """Return the square root of a double."""
        return self._double(ROOT, self)

    def either(self, value: Any, fallback: Any) -> Recorded:
        """Return `value` where this flag is set, else `fallback`."""
        if any(isinstance(entry, Recorded) and entry.is_pair for entry in (value, fallback)):
            return self._pair(CHOICE, self, self.wide(value), self.wide(fallback))
        return self._double(CHOICE, self, value, fallback)

    def __neg__(self) -> Recorded:
        if self.is_pair:
            return self._pair(NEGATIVE, self)
        return self._double(NEGATIVE, self)

    def __abs__(self) -> Recorded:
        if self.is_pair:
            return self._pair(SIZE, self)
        return self._double(ABSOLUTE, self)

    def __add__(self, other: Any) -> Recorded:
        if not self._goes_in_pairs(other):
            return self._double(PLUS, self, other)
        a = self.wide(self)
        b = self.wide(other)
        if a.is_watched or (isinstance(b, Recorded) and b.is_watched):
            return self._pair(WATCHED_SUM, a, b)
        return self._pair(SUM, a, b)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Recorded:
        if not self._goes_in_pairs(other):
            return self._double(MINUS, self, other)
        return self + self._pair(NEGATIVE, self.wide(other))

    def __rsub__(self, other: Any) -> Recorded:
        if not self.is_pair:
            return self._double(MINUS, other, self)
        return -self + other

    def _combined(self, in_pairs: int, in_doubles: int, a: Any, b: Any) -> Recorded:
        """Note an operation on a and b, in pairs if one of them is a pair."""
        if any(isinstance(entry, Recorded) and entry.is_pair for entry in (a, b)):
            return self._pair(in_pairs, self.wide(a), self.wide(b))
        return self._double(in_doubles, a, b)

    def __mul__(self, other: Any) -> Recorded:
        return self._combined(PRODUCT, TIMES, self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Recorded:
        return self._combined(QUOTIENT, OVER, self, other)

    def __rtruediv__(self, other: Any) -> Recorded:
        return self._combined(QUOTIENT, OVER, other, self)

    def __pow__(self, exponent: int) -> Recorded:
        if exponent == 2:
            return self * self
        return NotImplemented

    def _compared(self, other: Any, operation: int, exchanged: bool = False) -> Recorded:
        """Note a comparison; of pairs the difference is compared with 0."""
        a: Any = self
        b = other
        if self._goes_in_pairs(other):
            a = self - other
            b = 0.0
        if exchanged:
            return self._double(operation, b, a)
        return self._double(operation, a, b)

    def __gt__(self, other: Any) -> Recorded:
        return self._compared(other, ABOVE)

    def __ge__(self, other: Any) -> Recorded:
        return self._compared(other, AT_LEAST)

    def __lt__(self, other: Any) -> Recorded:
        return self._compared(other, ABOVE, exchanged=True)

    def __le__(self, other: Any) -> Recorded:
        return self._compared(other, AT_LEAST, exchanged=True)

    def __eq__(self, other: Any) -> Any:
        return self._compared(other, SAME)

    def __ne__(self, other: Any) -> Any:
        return self._compared(other, SAME) ^ True

    def __and__(self, other: Any) -> Recorded:
        return self._double(AND, self, other)

    def __or__(self, other: Any) -> Recorded:
        return self._double(OR, self, other)

    def __xor__(self, other: Any) -> Recorded:
        return self._double(XOR, self, other)

    __rand__ = __and__
    __ror__ = __or__
    __rxor__ = __xor__


def flat(values: Sequence[Any]) -> Iterable[Any]:
    """Yield the entries of a tuple and of the tuples in it, in order; an angle is one entry."""
    for value in values:
        if isinstance(value, tuple) and not isinstance(value, Angle):
            yield from flat(value)
        else:
            yield value


@outlined
def run_program(operations, constants, results, arguments, out, doubts):
    """Compute a program for all rows: `arguments` (arguments, 2, rows) are pairs, `out` (rows,
    results) takes the doubles, and `doubts` the flags of rows that lost digits.
    """
    # `r` holds the registers of some rows: by register, then high and low part, then row. Arguments
    # come first, then constants, then the results of the operations.
    first = arguments.shape[0]
    known = first + constants.shape[0]
    r = np.zeros((known + operations.shape[0], 2, TOGETHER))
    lost = np.zeros(TOGETHER, np.bool_)
    for n in range(constants.shape[0]):
        for i in range(TOGETHER):
            r[first + n, 0, i] = constants[n, 0]
            r[first + n, 1, i] = constants[n, 1]
    rows = out.shape[0]
    for begin in range(0, rows, TOGETHER):
        size = min(TOGETHER, rows - begin)
        for n in range(first):
            for i in range(size):
                r[n, 0, i] = arguments[n, 0, begin + i]
                r[n, 1, i] = arguments[n, 1, begin + i]
        for i in range(TOGETHER):
            lost[i] = False
        for n in range(operations.shape[0]):
            a = operations[n, 1]
            b = operations[n, 2]
            c = operations[n, 3]
            run_operation(operations[n, 0], r, lost, known + n, a, b, c)
        for i in range(size):
            doubts[begin + i] |= lost[i]
            for n in range(results.shape[0]):
                out[begin + i, n] = r[results[n], 0, i]


@outlined
def run_operation(operation, r, lost, to, a, b, c):
    """Do an operation on the registers a, b and c of `r`, for all its rows, and put the result in
    the register `to`.
    """
    if operation <= WATCHED_SUM:
        for i in range(TOGETHER):
            hi, lo = pair_sum(r[a, 0, i], r[a, 1, i], r[b, 0, i], r[b, 1, i])
            r[to, 0, i] = hi
            r[to, 1, i] = lo
        if operation == WATCHED_SUM:
            for i in range(TOGETHER):
                hi = r[to, 0, i]
                lost[i] |= (hi != 0.0) & (abs(hi) < CANCELLED * abs(r[a, 0, i]))
    elif operation == PRODUCT:
        for i in range(TOGETHER):
            hi, lo = pair_product(r[a, 0, i], r[a, 1, i], r[b, 0, i], r[b, 1, i])
            r[to, 0, i] = hi
            r[to, 1, i] = lo
    elif operation == QUOTIENT:
        for i in range(TOGETHER):
            hi, lo = pair_quotient(r[a, 0, i], r[a, 1, i], r[b, 0, i], r[b, 1, i])
            r[to, 0, i] = hi
            r[to, 1, i] = lo
    elif operation <= CHOICE:
        for i in range(TOGETHER):
            hi = r[a, 0, i]
            lo = r[a, 1, i]
            if operation == SIZE:
                sign = -1.0 if hi < 0.0 else 1.0
                hi = sign * hi
                lo = sign * lo
            elif operation == SIGN:
                if hi == hi:
                    hi = (1.0 if hi > 0.0 else 0.0) - (1.0 if hi < 0.0 else 0.0)
                lo = 0.0
            elif operation == WIDE:
                lo = 0.0
            elif operation == NEGATIVE:
                hi = -hi
                lo = -lo
            else:
                from_b = hi != 0.0
                hi = r[b, 0, i] if from_b else r[c, 0, i]
                lo = r[b, 1, i] if from_b else r[c, 1, i]
            r[to, 0, i] = hi
            r[to, 1, i] = lo
    else:
        for i in range(TOGETHER):
            r[to, 0, i] = double_operation(operation, r[a, 0, i], r[b, 0, i])


def double_operation(operation, x, y):
    """Return the result of an operation on doubles; flags are 1.0 or 0.0."""
    if operation == PLUS:
        return x + y
    if operation == MINUS:
        return x - y
    if operation == TIMES:
        return x * y
    if operation == OVER:
        return x / y
    if operation == ABSOLUTE:
        return abs(x)
    if operation == ROOT:
        return sqrt(x)
    if operation == ABOVE:
        holds = x > y
    elif operation == AT_LEAST:
        holds = x >= y
    elif operation == SAME:
        holds = x == y
    elif operation == AND:
        holds = (x != 0.0) & (y != 0.0)
    elif operation == OR:
        holds = (x != 0.0) | (y != 0.0)
    else:
        holds = x != y
    return 1.0 if holds else 0.0
