"""The entire functions of `symosc.kernels.entire` in any number of digits.

Close roots cost digits in divided differences, and so do short times. How many is known beforehand, so they are
computed with as many more; coinciding roots are told from close ones in rational arithmetic. Very short times use the
Taylor series.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from symosc.aliases import Context, Mpf, Number
from symosc.kernels.multiprecision import with_bits
from symosc.model import Parameters

# Below this time, times `rate`, the series takes fewer operations than the differences, which lose a factor as small
# as this for each of three nodes.
MP_SERIES_BELOW = 2.0**-8
SERIES_GUARD_BITS, SHORT_TIME_BITS, ROOT_BITS = 10, 24, 200


class BasisMP:
    """Callable with the signature of `symosc.kernels.entire.basis`, for many digits.

    It computes in contexts of its own, which have more digits, and leaves the given one alone.

    Parameters
    ----------
    context : mpmath context or MpfrContext
        Its precision is the precision of the results.
    parameters : Parameters
    more : callable, optional
        Returns such a context with at least so many bits.
    """

    def __init__(self, context: Context, parameters: Parameters, more: Callable[[int], Context] = with_bits) -> None:
        self.context = context
        self.h = parameters.c / (2 * parameters.m)
        self.w0sq = parameters.k / parameters.m
        self.Om = parameters.Omega
        self.for_series = more(context.prec + SERIES_GUARD_BITS)
        self.for_differences = more(context.prec + SHORT_TIME_BITS + self._guard_bits())
        before = self.for_series.enter()
        self.constants = tuple(_number(q, self.for_series) for q in (2 * self.h, self.w0sq, self.Om))
        self.for_differences.enter()
        l1, l2, i_Om = self.roots = self._roots(self.for_differences)
        # For the differences over pairs of nodes; None where the nodes are the same.
        gaps = (l1 - l2, 0 * l1 - l1, i_Om - l1, 0 * l2 - l2, i_Om - l2)
        self.inverses: tuple[Any, ...] = tuple(1 / gap if gap != 0 else None for gap in gaps)
        self.for_differences.leave(before)

    def _roots(self, context: Context) -> tuple[Mpf, Mpf, Mpf]:
        """Return l1 (the slow root, or the one above the real axis), l2 and i Omega as numbers of a context."""
        h, w0sq, Om = (_number(q, context) for q in (self.h, self.w0sq, self.Om))
        square = self.w0sq - self.h * self.h
        w = context.sqrt(_number(abs(square), context))
        if square > 0:
            l1, l2 = context.mpc(-h, w), context.mpc(-h, -w)
        else:
            l1, l2 = -w0sq / (h + w) if h else context.mpf(0), -(h + w)
        if self.h == 0 and self.w0sq == self.Om * self.Om:  # undamped resonance, decided in rational numbers
            return context.mpc(0, Om), context.mpc(0, -Om), context.mpc(0, Om)
        if square == 0:  # so is critical damping: roots that differ by rounding would be divided by their difference
            return -h, -h, context.mpc(0, Om)
        return l1, l2, context.mpc(0, Om)

    def _guard_bits(self) -> int:
        context = with_bits(ROOT_BITS)
        nodes = (context.mpf(0), *self._roots(context))
        size = max(abs(node) for node in nodes)
        gaps = (abs(a - b) for i, a in enumerate(nodes) for b in nodes[:i])
        return 20 + sum(math.ceil(float(context.log(size / gap, 2))) for gap in gaps if gap)

    def __call__(self, tau: Mpf, K: Any) -> tuple[Mpf, ...]:
        """Return E0, E1, E2, R2, I2 and sin, cos of Omega tau for the constants `K`; tau of any sign."""
        tau = self.context.convert(tau)
        short = K.rate * abs(tau) < MP_SERIES_BELOW
        inner = self.for_series if short else self.for_differences
        before = inner.enter()
        try:
            values = self._series(inner.own(tau)) if short else self._divided_differences(inner.own(tau))
        finally:
            inner.leave(before)
        return inner.rounded(values, self.context)

    def _series(self, tau: Mpf) -> tuple[Mpf, ...]:
        context, (cm, w0sq, Om) = self.for_series, self.constants
        one, zero, eps = context.one, context.zero, +context.eps
        before, term, pull = zero, tau, w0sq * tau
        E0, E1, E2 = one, tau, tau * tau / 2
        r, i = E2, zero
        R2, I2 = r, i
        n, small_before = 0, False
        while True:
            n += 1
            slope = -cm * term - pull * before / n
            before, term = term, slope * tau / (n + 1)
            shorter = tau / (n + 2)
            r, i = (term - Om * i) * shorter, Om * r * shorter
            E0, E1, E2, R2, I2 = E0 + slope, E1 + term, E2 + term * shorter, R2 + r, I2 + i
            small = abs(slope) <= eps
            if small and small_before and abs(r) <= eps * R2 and abs(i) <= eps * abs(I2):
                wave = context.expj(Om * tau)
                return E0, E1, E2, R2, I2, wave.imag, wave.real
            small_before = small  # single terms may be 0 by accident

    def _divided_differences(self, tau: Mpf) -> tuple[Mpf, ...]:
        context, (l1, l2, i_Om) = self.for_differences, self.roots
        over_roots, over_0_l1, over_Om_l1, over_0_l2, over_Om_l2 = self.inverses
        wave = context.expj(i_Om.imag * tau)
        if l1.imag:  # then the other root is the conjugate, and l1 - l2 = 2 i w
            exp1 = context.exp(l1.real * tau) * context.expj(l1.imag * tau)
            over_w = -2 * over_roots.imag
            inner, slope = exp1.imag * over_w, (l1 * exp1).imag * over_w
        elif over_roots is not None:
            exp1, exp2 = context.exp(l1 * tau), context.exp(l2 * tau)
            inner, slope = (exp1 - exp2) * over_roots, (l1 * exp1 - l2 * exp2) * over_roots
        else:
            exp1 = context.exp(l1 * tau)
            inner, slope = tau * exp1, (1 + l1 * tau) * exp1
        # tau e[0, l1 tau] and tau e[i Omega tau, l1 tau]
        still = (context.one - exp1) * over_0_l1 if over_0_l1 is not None else tau * exp1
        driven = (wave - exp1) * over_Om_l1 if over_Om_l1 is not None else tau * exp1
        E2 = (still - inner) * over_0_l2 if over_0_l2 is not None else tau * tau / 2
        Z = (driven - inner) * over_Om_l2
        return slope, inner, E2.real, Z.real, Z.imag, wave.imag, wave.real


def _number(value: Fraction, context: Context) -> Number:
    return context.mpf(value.numerator) / value.denominator
