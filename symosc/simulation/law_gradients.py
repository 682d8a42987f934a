"""How the damping and the constant force in each band of a friction law depend on its numbers.

The formulas are those of `symosc.friction`, evaluated for numbers that know their derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from symosc.engine.tangent import A0, B0, K_, OMEGA, C, M
from symosc.friction import FrictionLaw, StraightPiece, kinetic_pieces
from symosc.model import OSCILLATOR_NAMES, Model, Oscillator, OtherNumbers

#: The numbers of one band by the codes of `symosc.engine.tangent`: the columns of its derivatives.
LOCAL_CODES = (M, C, K_, A0, B0, OMEGA)


class FirstOrder:
    """An exact number with its derivatives (`slopes`) by some names.

    Two of them are equal if their derivatives are too, so that pieces of a curve that lie in one
    line only as long as no number changes are told apart. They are ordered by value.
    """

    __slots__ = ("slopes", "value")

    def __init__(self, value: Fraction, slopes: dict[str, Fraction]) -> None:
        self.value = value
        self.slopes = {name: slope for name, slope in slopes.items() if slope}

    def _with(self, other: Any, value: Fraction, by_self: Any, by_other: Any) -> FirstOrder:
        """Return a function of two numbers, given its value and its derivatives by them."""
        names = self.slopes.keys() | other.slopes.keys()
        slopes = {
            name: by_self * self.slopes.get(name, 0) + by_other * other.slopes.get(name, 0)
            for name in names
        }
        return FirstOrder(value, slopes)

    def __add__(self, other: Any) -> FirstOrder:
        other = first_order(other)
        return self._with(other, self.value + other.value, 1, 1)

    def __sub__(self, other: Any) -> FirstOrder:
        other = first_order(other)
        return self._with(other, self.value - other.value, 1, -1)

    def __rsub__(self, other: Any) -> FirstOrder:
        return first_order(other) - self

    def __mul__(self, other: Any) -> FirstOrder:
        other = first_order(other)
        return self._with(other, self.value * other.value, other.value, self.value)

    def __truediv__(self, other: Any) -> FirstOrder:
        other = first_order(other)
        ratio = self.value / other.value
        return self._with(other, ratio, 1 / other.value, -ratio / other.value)

    __radd__ = __add__
    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        number = first_order(other)
        return self.value == number.value and self.slopes == number.slopes

    def __hash__(self) -> int:
        return hash(self.value)

    def __lt__(self, other: Any) -> bool:
        return self.value < first_order(other).value

    def __le__(self, other: Any) -> bool:
        return self.value <= first_order(other).value

    def __gt__(self, other: Any) -> bool:
        return self.value > first_order(other).value

    def __ge__(self, other: Any) -> bool:
        return self.value >= first_order(other).value


def first_order(number: Any) -> FirstOrder:
    """Return a number as one that knows its derivatives: a plain one has none."""
    if isinstance(number, FirstOrder):
        return number
    return FirstOrder(Fraction(number), {})


class LawOfAllPoints(FrictionLaw):
    """A friction law in which every point of a curve is a corner, one on a straight line too."""

    @cached_property
    def lines(self) -> list[list[StraightPiece]]:
        """The pieces of the kinetic friction of each belt, one for each point of its curve."""
        return [kinetic_pieces(belt) for belt in self.belts]


class OscillatorOfAllPoints(Oscillator):
    """An oscillator with a band between any two neighbouring points of its curves."""

    @cached_property
    def _law(self) -> FrictionLaw:  # type: ignore[override]
        return LawOfAllPoints(self.belts, self.FN)  # type: ignore[arg-type]


def with_all_points(model: Model) -> OscillatorOfAllPoints:
    """Return the same oscillator, with a band between any two neighbouring points of its curves."""
    shared = {name: getattr(model, name) for name in OSCILLATOR_NAMES}
    return OscillatorOfAllPoints(**shared, belts=model.law.belts)  # type: ignore[arg-type]


class LawGradients:
    """Derivatives of what a friction law adds to the equations of motion, by the numbers `wrt`.

    The names of `wrt` that are no numbers of the model, such as x0, change nothing.
    """

    def __init__(self, model: Model, wrt: Sequence[str]) -> None:
        self.wrt = wrt
        self._law = model.law
        self._numbers = {
            name: FirstOrder(value, {name: Fraction(1)} if name in wrt else {})
            for name, value in model.given_numbers().items()
        }
        self._own = OtherNumbers(self._numbers).law
        self._rows = dict[int, list[FirstOrder]]()

    @cached_property
    def bends_a_line(self) -> bool:
        """Whether a band of the law falls apart into several if one of the numbers changes."""
        return any(
            len(pieces) > len(lines)
            for pieces, lines in zip(self._own.lines, self._law.lines, strict=True)
        )

    def of_row(self, row: int, number: Callable[[Fraction], Any], kind: Any) -> np.ndarray:
        """Return the derivatives of m, c, k, A, B0 and Omega in a band, (6, wrt), as numbers of the
        type `kind`.
        """
        if row not in self._rows:
            self._rows[row] = self._row(row)
        return np.array([self._columns(entry, number) for entry in self._rows[row]], dtype=kind)

    def _row(self, row: int) -> list[FirstOrder]:
        """Return m, c, k, A, B0 and Omega in a band, with their derivatives."""
        edges = self._law.rows[row]
        slope, force = self._own.line_between(
            edges.below and edges.below.v, edges.above and edges.above.v
        )
        numbers = self._numbers
        local = [numbers[name] for name in ("m", "c", "k", "A0", "B0", "Omega")]
        local[LOCAL_CODES.index(C)] += slope
        local[LOCAL_CODES.index(A0)] += force
        return local

    def of_speed(self, belt: int, number: Callable[[Fraction], Any], kind: Any) -> np.ndarray:
        """Return the derivatives of a belt's speed."""
        return np.array(self._columns(self._own.belts[belt - 1].v, number), dtype=kind)

    def of_excess(self, belt: int, number: Callable[[Fraction], Any], kind: Any) -> np.ndarray:
        """Return the derivatives of the force by which static exceeds kinetic friction of a belt."""
        return np.array(self._columns(self._own.excess(belt), number), dtype=kind)

    def _columns(self, value: Any, number: Callable[[Fraction], Any]) -> list[Any]:
        """Return the derivatives of a value by `wrt`, in its order."""
        slopes = first_order(value).slopes
        return [number(slopes.get(name, Fraction(0))) for name in self.wrt]

    def corners_at(self, belt: int) -> frozenset[str]:
        """Return the names that move a corner of another belt's curve off the speed of a belt."""
        speed = first_order(self._own.belts[belt - 1].v)
        names = set[str]()
        for other, lines in zip(self._own.belts, self._own.lines, strict=True):
            for line in lines[1:]:
                for corner in (other.v - line.begin, other.v + line.begin):
                    gap = first_order(corner - speed)
                    if gap.value == 0:
                        names |= gap.slopes.keys()
        return frozenset(names)


@lru_cache(maxsize=32)
def law_gradients(model: Model, wrt: tuple[str, ...]) -> LawGradients:
    """Return the derivatives of a law, from a cache: many motions may share it."""
    return LawGradients(model, wrt)
