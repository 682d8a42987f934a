"""Periodic orbits by shooting with the oracle of friction laws: 40 digits, derivatives by
differences, nothing of symosc.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

import law_oracle
import mpmath

DIGITS = 40
#: The push of a difference quotient, and the residual at which a state is periodic.
PUSH = Fraction(1, 10**22)
CLOSED = mpmath.mpf(10) ** -33
MOST_STEPS = 12


class OracleOrbit(NamedTuple):
    """A periodic state (x, v) at t, the period, and the multipliers, the larger one first."""

    t: Any
    x: Any
    v: Any
    period: Any
    multipliers: tuple[Any, Any]


def exact(value: Any) -> Fraction:
    """Return a number with all its digits."""
    if hasattr(value, "_mpf_"):
        sign, mantissa, exponent, _ = value._mpf_
        return Fraction(-mantissa if sign else mantissa) * Fraction(2) ** exponent
    return Fraction(value)


def flown(law: dict[str, Any], t: Any, x: Any, v: Any, span: Any) -> tuple[Any, Any]:
    """Return x and v some time after a state."""
    start = {"t0": exact(t), "x0": exact(x), "v0": exact(v), "t_end": exact(t) + exact(span)}
    run = law_oracle.follow(**law, **start, digits=DIGITS)
    assert run.status == "t_end", run.message
    return run.x, run.v


def periodic_orbit(law: dict[str, Any], t: Any, x: Any, v: Any, span: Any) -> OracleOrbit:
    """Return the periodic orbit beside a state in a flight.

    With a drive `span` is the period. Without one it is a guess of it, and v stays as it is.
    """
    with mpmath.workdps(DIGITS):
        driven = law["B0"] != 0
        if driven:
            turn = 2 * mpmath.pi / _mpf(law["Omega"])
            span = turn * round(float(span / turn))
        x, v, span = _mpf(exact(x)), _mpf(exact(v)), mpmath.mpf(span)
        for _ in range(MOST_STEPS):
            end = flown(law, t, x, v, span)
            miss = (end[0] - x, end[1] - v)
            slopes = matrix(law, t, x, v, span, end)
            if max(map(abs, miss)) < CLOSED:
                break
            (a, b), (c, d) = slopes
            if driven:
                dx, dv = solved(((a - 1, b), (c, d - 1)), miss)
                x -= dx
                v -= dv
            else:
                later = flown(law, t, x, v, span + _mpf(PUSH))
                rates = [(new - old) / _mpf(PUSH) for new, old in zip(later, end, strict=True)]
                dx, longer = solved(((a - 1, rates[0]), (c, rates[1])), miss)
                x -= dx
                span -= longer
        else:
            raise AssertionError(f"does not close: {miss}")
        (a, b), (c, d) = slopes
        half = (a + d) / 2
        root = mpmath.sqrt(mpmath.mpc(half**2 - (a * d - b * c)))
        pair = sorted((half + root, half - root), key=abs, reverse=True)
        return OracleOrbit(t, x, v, span, (pair[0], pair[1]))


def matrix(law: dict[str, Any], t: Any, x: Any, v: Any, span: Any, end: tuple[Any, Any]) -> Any:
    """Return the derivatives of the state after `span` by x and v, as differences."""
    columns = []
    for dx, dv in ((PUSH, 0), (0, PUSH)):
        pushed = flown(law, t, exact(x) + dx, exact(v) + dv, span)
        columns.append([(new - old) / _mpf(PUSH) for new, old in zip(pushed, end, strict=True)])
    return tuple(zip(*columns, strict=True))


def solved(rows: Any, right: Any) -> tuple[Any, Any]:
    """Return the solution of two linear equations."""
    (a, b), (c, d) = rows
    determinant = a * d - b * c
    return (d * right[0] - b * right[1]) / determinant, (a * right[1] - c * right[0]) / determinant


def _mpf(value: Any) -> Any:
    number = Fraction(value)
    return mpmath.mpf(number.numerator) / number.denominator
