"""An orbit for every value of a parameter in an interval: Krawczyk about a curve instead of a point.

Let delta be the change of the parameter from the middle of the interval, in D = [-h, h], and c(delta) a polynomial
near the curve of roots (Newton's method for power series gives it; nothing rests on it). By Taylor's theorem

    f(c(delta), delta)  lies in  f_0 + f_1 delta + ... + f_(N-1) delta^(N-1) + f_N(D) delta^N

with the coefficients f_j of its power series at 0, and those of order N at all delta in D. Both come from arithmetic
with power series whose coefficients are balls. Let F be an enclosure of this, of order h^N, R a box about 0, J the
Jacobian over all c(delta) + R, and Y any matrix. If - Y F + (1 - Y J) R lies inside R, then for every delta there is
exactly one root in c(delta) + R. Then 1 - Y J has a norm below 1, so f is one-to-one where J is: the root is the only
one there too.
"""

from __future__ import annotations

from fractions import Fraction
from math import comb

from flint import arb, arb_mat, arb_series, ctx

from symosc.certificates.balls import Ball, Undecided, ball, hull
from symosc.certificates.closing import ClosingBalls, Values
from symosc.certificates.flow import Oscillator
from symosc.model import Parameters
from symosc.orbits.closing_equations import OrbitPiece

#: Coefficients of the curve.
ORDER = 3
MOST_INFLATIONS = 8
INFLATION = 1.2
#: How much wider the balls are in which a root is the only one: those that are stated; those that are proven, so that
#: somebody whose balls are a little wider proves the others.
STATED_WIDTH, PROVEN_WIDTH = 1.2, 1.5


class Family:
    """The closing equations of one word over an interval of one parameter.

    Parameters
    ----------
    p : Parameters
    name : str
        The parameter that varies.
    low, high : Fraction
    pieces : tuple of OrbitPiece
    periods : int
    """

    def __init__(
        self, p: Parameters, name: str, low: Fraction, high: Fraction, pieces: tuple[OrbitPiece, ...], periods: int
    ) -> None:
        self.p, self.name, self.pieces, self.periods = p.replace(**{name: (low + high) / 2}), name, pieces, periods
        self.low, self.high, self.middle = low, high, ball((low + high) / 2)
        self.range = hull(ball(low), ball(high))
        self.change = self.range - self.middle
        self.thin = ClosingBalls(Oscillator(self.p), pieces, periods)
        self.wide = ClosingBalls(Oscillator(self.p, {name: self.range}), pieces, periods)
        self.curve: list[Values] = []
        self.tube: Values = []
        #: Balls in which the root is the only one, for every value of the parameter.
        self.stated: Values = []

    def _coefficients(self, value: Ball, curve: list[Values], order: int) -> list[Values]:
        """Return the first coefficients of f about a value of the parameter, along a curve given there."""
        if ctx.cap < order:
            ctx.cap = order
        series = Oscillator(self.p, {self.name: arb_series([value, 1], prec=order)})
        closing = ClosingBalls(series, self.pieces, self.periods)
        values = [arb_series(list(each), prec=order) for each in zip(*curve, strict=True)]
        end, found = closing.ends(values), list[Ball]()
        for i in range(len(self.pieces)):
            found += closing.left(i, values, end)
        return [[each[j] for each in found] for j in range(order)]

    def prove(self, near: Values) -> Values:
        """Prove that there is one root for every value of the parameter; return enclosures of all of them.

        Raises
        ------
        Undecided
        """
        start = self.thin.polished(near)
        try:
            Y = self.thin.jacobian(start).mid().inv().mid()
        except ZeroDivisionError:
            raise Undecided("singular closing equations") from None
        curve = self._curve(start, Y)
        enclosed = _horner([*self._coefficients(self.middle, curve, ORDER), self._remainder(curve)], self.change)
        pushed = [-each for each in (Y * arb_mat([[each] for each in enclosed])).entries()]
        along = _horner(curve, self.change)
        unit = arb_mat([[int(i == j) for j in range(len(start))] for i in range(len(start))])
        box = pushed
        for _ in range(MOST_INFLATIONS):
            box = [_inflated(each) for each in box]
            whole = [c + r for c, r in zip(along, box, strict=True)]
            J = self.wide.jacobian([_scaled(each, PROVEN_WIDTH) for each in whole])
            turned = ((unit - Y * J) * arb_mat([[each] for each in box])).entries()
            image = [a + b for a, b in zip(pushed, turned, strict=True)]
            if all(r.contains_interior(each) for r, each in zip(box, image, strict=True)):
                self.curve, self.tube, self.stated = curve, box, [_scaled(each, STATED_WIDTH) for each in whole]
                return [c + each for c, each in zip(along, image, strict=True)]
            if not all(each.is_finite() for each in image):
                break
            box = image
        raise Undecided("one root for every value of the parameter")

    def near(self, value: Fraction) -> Values:
        """Return the curve at a value of the parameter; it may be outside the interval."""
        return _horner(self.curve, ball(value) - self.middle)

    def holds(self, value: Fraction, points: Values) -> bool:
        """Return whether points at a value of the parameter are all in the tube in which it has one root."""
        return all((c + r).contains(each) for c, r, each in zip(self.near(value), self.tube, points, strict=True))

    def _curve(self, start: Values, Y: arb_mat) -> list[Values]:
        curve = [start]
        for order in range(2, ORDER + 1):
            left = self._coefficients(self.middle, [*curve, [arb(0)] * len(start)], order)[-1]
            curve.append([(-each).mid() for each in (Y * arb_mat([[each] for each in left])).entries()])
        return curve

    def _remainder(self, curve: list[Values]) -> Values:
        """Return the coefficients of order ORDER about every value of the parameter."""
        shifted = [
            _horner([[comb(k, j) * each for each in curve[k]] for k in range(j, ORDER)], self.change)
            for j in range(ORDER)
        ]
        return self._coefficients(self.range, shifted, ORDER + 1)[-1]


def _horner(coefficients: list[Values], at: Ball) -> Values:
    total = coefficients[-1]
    for row in reversed(coefficients[:-1]):
        total = [a + at * b for a, b in zip(row, total, strict=True)]
    return total


def _scaled(value: Ball, factor: float) -> Ball:
    """Return a ball with the same middle and a radius that is larger by a factor."""
    return value.mid() + arb(0, (factor * value.rad()).mid())


def _inflated(value: Ball) -> Ball:
    """Return a ball about 0 that contains a ball with something to spare."""
    return arb(0, (INFLATION * abs(value).upper()).mid()) + arb(0, arb(2) ** (8 - ctx.prec))
