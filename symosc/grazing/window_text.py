"""Grazing windows as exact text, without sympy: their ends are multiples of pi, or asin of a rational number and these.

sympy takes longer to load than all else that `symosc grazing` does. What it would print is compared in a test.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from symosc.grazing.window import GrazingWindow
from symosc.mappings.theorem7_cases import ALL_BUT_ONE, EMPTY, EVERYTHING, WRAPPED_ARC

#: Rational sines with a rational multiple of pi (Niven), all of them in [-pi/2, pi/2].
NIVEN = {Fraction(0): Fraction(0), Fraction(1, 2): Fraction(1, 6), Fraction(1): Fraction(1, 2)}
NIVEN |= {-sine: -part for sine, part in NIVEN.items()}


class ArcsineAngle(NamedTuple):
    """The angle ``sign asin(sine) + turns pi``, where sine > 0; sign 0: ``turns pi``."""

    sign: int
    sine: Fraction
    turns: Fraction

    def text(self) -> str:
        """Return it as sympy prints it."""
        if not self.sign:
            return _pi_text(self.turns)
        arcsine = f"asin({self.sine})"
        if self.sign < 0 and self.turns == 1:
            return f"pi - {arcsine}"
        return ("-" if self.sign < 0 else "") + arcsine + (f" + {_pi_text(self.turns)}" if self.turns else "")

    def plus(self, turns: int) -> ArcsineAngle:
        """Return it turned by a multiple of pi."""
        return self._replace(turns=self.turns + turns)

    def mirrored(self) -> ArcsineAngle:
        """Return the angle times -1."""
        return ArcsineAngle(-self.sign, self.sine, -self.turns)


def _pi_text(turns: Fraction) -> str:
    if turns == 0:
        return "0"
    top = {1: "pi", -1: "-pi"}.get(turns.numerator, f"{turns.numerator}*pi")
    return top if turns.denominator == 1 else f"{top}/{turns.denominator}"


def critical_angle(window: GrazingWindow) -> ArcsineAngle | None:
    """Return Theta_cr, None where it does not exist."""
    if window.amplitude == 0 or window.signs[2] > 0:
        return None
    sine = -window.gamma / window.amplitude
    if sine in NIVEN:
        return ArcsineAngle(0, Fraction(0), NIVEN[sine])
    return ArcsineAngle(1 if sine > 0 else -1, abs(sine), Fraction(0))


def critical_text(window: GrazingWindow) -> str:
    """Return Theta_cr as text, "none" where it does not exist."""
    angle = critical_angle(window)
    return "none" if angle is None else angle.text()


def phases_text(window: GrazingWindow) -> str:
    """Return the window in the notation of the paper, "empty" for the empty one."""
    if window.kind in (EMPTY, EVERYTHING):
        return "[0, 2*pi)" if window.kind == EVERYTHING else "empty"
    above = window.place.side * window.signs[1] > 0
    angle = critical_angle(window)
    if window.kind == ALL_BUT_ONE or angle is None:
        point = ArcsineAngle(0, Fraction(0), Fraction(3 if above else 1, 2))
        return _through_zero(point, point)
    turned, wrapped = angle.mirrored().plus(1), angle.plus(2)
    if window.kind == WRAPPED_ARC:
        return _through_zero(turned, wrapped) if above else _through_zero(angle, turned)
    low, high = (angle, turned) if above else (turned, wrapped)
    return f"({low.text()}, {high.text()})"


def _through_zero(high: ArcsineAngle, low: ArcsineAngle) -> str:
    """Return the arc from `low` through 0 to `high`."""
    return f"[0, {high.text()}) U ({low.text()}, 2*pi)"
