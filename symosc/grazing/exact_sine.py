"""The sign of level + amplitude sin(phase), exactly, for a phase a + b pi with rational a and b.

The sine is rational in two cases only. If a is not 0 it is transcendental (Lindemann: exp(i a) is,
and exp(i b pi) is algebraic). If a is 0 it is algebraic, and rational only for the multiples of
pi/6 where it is 0, 1/2 or 1 in size (Niven). So level + amplitude sin is 0 in known cases only;
elsewhere enough digits show its sign.
"""

from __future__ import annotations

from fractions import Fraction

from symosc.base.expressions import ExactPhase
from symosc.base.phases import number_of
from symosc.engine.arithmetic import mp_context

#: The sines that are rational, by the phase in units of pi/6.
RATIONAL_SINES = {
    0: Fraction(0),
    1: Fraction(1, 2),
    3: Fraction(1),
    5: Fraction(1, 2),
    6: Fraction(0),
}
RATIONAL_SINES |= {7: Fraction(-1, 2), 9: Fraction(-1), 11: Fraction(-1, 2)}

# Digits that are tried first; a value counts if it exceeds 10^LOST_DIGITS units of the last one.
FIRST_DIGITS = 30
LOST_DIGITS = 5


def sine_sign(level: Fraction, amplitude: Fraction, phase: ExactPhase) -> int:
    """Return the sign of level + amplitude sin(phase), exactly."""
    sixths = phase.multiple * 6 % 12
    if phase.rest == 0 and sixths.denominator == 1:
        sine = RATIONAL_SINES.get(int(sixths))
    else:
        sine = None
    if sine is not None or amplitude == 0:
        total = level + amplitude * (sine or 0)
        return (total > 0) - (total < 0)
    digits = FIRST_DIGITS
    while True:
        # With as many more as the phase has before the point.
        context = mp_context(digits + len(str(int(max(map(abs, phase))))))
        value = context.sin(phase.number(context)) + number_of(level / amplitude, context)
        if abs(value) > context.mpf(10) ** (LOST_DIGITS - digits):
            if (value > 0) == (amplitude > 0):
                return 1
            return -1
        digits *= 2
