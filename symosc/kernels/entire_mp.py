"""The entire functions of `symosc.kernels.entire` in any number of digits.

Close roots cost digits in divided differences. How many is known beforehand, so they are computed with as many more;
coinciding roots are told from close ones in rational arithmetic. Short times use the Taylor series.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

from symosc.aliases import Context, Mpf, Number
from symosc.kernels.multiprecision import with_bits
from symosc.model import Parameters

MP_SERIES_BELOW = 1
SERIES_GUARD_BITS, ROOT_BITS = 10, 200


class BasisMP:
    """Callable with the signature of `symosc.kernels.entire.basis`, for an mpmath context.

    It computes in contexts of its own, which have more digits, and leaves the given one alone.

    Parameters
    ----------
    context : mpmath context
        Its precision is the precision of the results.
    parameters : Parameters
    """

    def __init__(self, context: Context, parameters: Parameters) -> None:
        self.context = context
        self.h = parameters.c / (2 * parameters.m)
        self.w0sq = parameters.k / parameters.m
        self.Om = parameters.Omega
        self.for_series = with_bits(context.prec + SERIES_GUARD_BITS)
        self.constants = tuple(_number(q, self.for_series) for q in (2 * self.h, self.w0sq, self.Om))
        self.for_differences = with_bits(context.prec + self._guard_bits())
        self.roots = self._roots(self.for_differences)

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
        values = self._series(tau) if K.rate * abs(tau) < MP_SERIES_BELOW else self._divided_differences(tau)
        make = self.context.make_mpf
        return tuple(+make(value._mpf_) for value in values)

    def _series(self, tau: Mpf) -> tuple[Mpf, ...]:
        context, (cm, w0sq, Om) = self.for_series, self.constants
        tau, one, zero, eps = context.make_mpf(tau._mpf_), context.one, context.zero, +context.eps
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
        tau, one = context.make_mpf(tau._mpf_), context.one
        wave = context.exp(i_Om * tau)
        exp1 = context.exp(l1 * tau)
        if l1 == l2:
            inner, slope = tau * exp1, (1 + l1 * tau) * exp1
        else:
            exp2 = context.conj(exp1) if context.im(l1) else context.exp(l2 * tau)
            inner, slope = (exp1 - exp2) / (l1 - l2), (l1 * exp1 - l2 * exp2) / (l1 - l2)

        def first(a: Number, exp_a: Number) -> Number:
            """Return tau e[a tau, l1 tau]."""
            return tau * exp1 if a == l1 else (exp_a - exp1) / (a - l1)

        E2 = tau * tau / 2 if l2 == 0 else (first(0 * one, one) - inner) / (0 - l2)
        Z = (first(i_Om, wave) - inner) / (i_Om - l2)
        return context.re(slope), context.re(inner), context.re(E2), context.re(Z), context.im(Z), wave.imag, wave.real


def _number(value: Fraction, context: Context) -> Number:
    return context.mpf(value.numerator) / value.denominator
