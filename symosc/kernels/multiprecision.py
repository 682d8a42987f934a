"""Numbers with any number of digits by mpmath: contexts of fixed precision, and the entire
functions in them.

An mpmath context keeps its precision in one place for all threads, and raising it for a while, as
``workdps`` does, raises it for everybody. So nothing here changes a precision: code that needs more
digits takes the context that has them, and rounds the result into its own. Such contexts can be
shared by all threads.
"""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

from symosc.base.aliases import Context, Mpf, Number
from symosc.kernels._generated import basis_apart
from symosc.model import Model


@contextmanager
def interrupts_held_back() -> Iterator[None]:
    """Return a context manager that delays an interrupt (Ctrl-C) until the end of its block."""
    # gmpy2, which mpmath loads too, drops every exception of some lines that it runs while it is
    # imported.
    usual = signal.getsignal(signal.SIGINT)
    if usual is None or threading.current_thread() is not threading.main_thread():
        # handlers can be set by the main thread only, and one that is not Python's cannot be put
        # back
        yield
        return
    came: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
        if came:
            signal.raise_signal(signal.SIGINT)


with interrupts_held_back():
    from mpmath.ctx_mp import MPContext
    from mpmath.libmp import from_pickable, to_pickable

BITS_PER_DIGIT = math.log2(10)
# Below this time, times `rate`, the series takes fewer operations than the differences, which lose
# a factor as small as this for each of three nodes.
MP_SERIES_BELOW = 2.0**-8
SERIES_GUARD_BITS = 10  # with which the series is computed beyond those of the result
SHORT_TIME_BITS = 24  # that differences lose at the shortest time: 8 for each of three nodes
ROOT_BITS = 200  # in which the gaps between nodes are measured


@lru_cache(maxsize=256)
def mp_context(digits: int) -> FixedContext:
    """Return the shared mpmath context with `digits` decimal digits.

    Its precision cannot be changed.
    """
    return FixedContext(digits)


def with_bits(bits: int) -> FixedContext:
    """Return the shared mpmath context of fixed precision with at least `bits` bits."""
    return mp_context(math.ceil(bits / BITS_PER_DIGIT))


class FixedContext(MPContext):
    """An mpmath context of fixed precision.

    Its mpf and mpc keep all digits when pickled and copied.
    """

    def __init__(self, digits: int) -> None:
        super().__init__()
        self._set_dps(digits)
        self.mpf.__reduce__ = self.constant.__reduce__ = lambda number: (
            _real,
            (digits, to_pickable(number._mpf_)),
        )
        self.mpc.__reduce__ = lambda number: (_complex, (digits, *map(to_pickable, number._mpc_)))

    def _refuse(self, value: int) -> None:
        """Raise an error: the precision of this context is fixed."""
        raise AttributeError(
            "the precision of this context is fixed, as others share it; change that of its "
            ".clone()"
        )

    prec = property(lambda self: self._prec, _refuse)
    dps = property(lambda self: self._dps, _refuse)

    def enter(self) -> None:
        """Do nothing: here mpmath keeps its precision per context, where MPFR has to set a current
        one.
        """

    leave = staticmethod(lambda before: None)

    def own(self, number: Any) -> Any:
        """Return an mpf of another context as one of this context, with all its digits."""
        return self.make_mpf(number._mpf_)

    @staticmethod
    def rounded(numbers: Any, context: Any) -> tuple[Any, ...]:
        """Return real numbers rounded to the precision of another mpmath context."""
        return tuple(+context.make_mpf(number._mpf_) for number in numbers)

    def lu_solve(self, A: Any, b: Any) -> Any:
        """Solve A x = b, A square, in this precision.

        The method of mpmath itself changes the precision meanwhile.
        """
        factors, order = self.LU_decomp(self.matrix(A))
        return self.U_solve(factors, self.L_solve(factors, self.matrix(b), order))

    def clone(self) -> MPContext:
        """Return a new mpmath context with the precision of this one, which can be changed there."""
        context = MPContext()
        context.dps = self.dps
        return context

    def __reduce__(self) -> tuple[object, ...]:
        return mp_context, (self.dps,)


def _real(digits: int, parts: object) -> Number:
    """Rebuild a pickled mpf of a context with `digits` digits."""
    return mp_context(digits).make_mpf(from_pickable(parts))


def _complex(digits: int, real: object, imag: object) -> Number:
    """Rebuild a pickled mpc of a context with `digits` digits."""
    return mp_context(digits).make_mpc((from_pickable(real), from_pickable(imag)))


class FreeMotion(NamedTuple):
    """The constants that `basis_apart` takes last, in its order."""

    h: Mpf
    w: Mpf
    w0sq: Mpf
    Om: Mpf
    p: Mpf
    q: Mpf


class BasisMP:
    """The responses E0, E1, E2 (to an impulse), R2, I2 (to the drive) in many digits, as a function
    of time tau.
    """

    # Close roots cost digits in divided differences, and so do short times. How many is known
    # beforehand, so they are computed with as many more, in contexts of their own; coinciding roots
    # are found in rational arithmetic. Very short times use the Taylor series. The precision of
    # `context` (of mpmath, or a `symosc.kernels.mpfr.MpfrContext`) is that of the results; `more`
    # returns such a context with at least that many bits, and `row` is the number of a row of
    # constants (`symosc.friction.FrictionLaw.rows`).

    def __init__(
        self,
        context: Context,
        parameters: Model,
        more: Callable[[int], Context] = with_bits,
        row: int = 0,
    ) -> None:
        self.context = context
        self.h = parameters.law.damping(parameters.c, row) / (2 * parameters.m)
        self.w0sq = parameters.k / parameters.m
        self.Om = parameters.Omega
        # A difference over two nodes loses as many bits as their gap is smaller than the nodes; 20 bits
        # are to spare.
        near = with_bits(ROOT_BITS)
        nodes = (near.mpf(0), *self._roots(near))
        size = max(abs(node) for node in nodes)
        gaps = [abs(a - b) for i, a in enumerate(nodes) for b in nodes[:i]]
        guard_bits = 20 + sum(math.ceil(float(near.log(size / gap, 2))) for gap in gaps if gap)
        self.for_series = more(context.prec + SERIES_GUARD_BITS)
        self.for_differences = more(context.prec + SHORT_TIME_BITS + guard_bits)
        before = self.for_series.enter()
        # Without a drive its response is of no use, and the series would be long.
        if parameters.B0 != 0:
            wave = self.Om
        else:
            wave = Fraction(0)
        self.constants = tuple(_number(q, self.for_series) for q in (2 * self.h, self.w0sq, wave))
        self.for_differences.enter()
        l1, l2, i_Om = self.roots = self._roots(self.for_differences)
        # For the differences over pairs of nodes; None where the nodes are the same. 0 * l1 is the
        # node 0, as a number of the same kind.
        gaps = [l1 - l2, 0 * l1 - l1, i_Om - l1, 0 * l2 - l2, i_Om - l2]
        self.inverses: tuple[Any, ...] = tuple(1 / gap if gap != 0 else None for gap in gaps)
        # For the closed form, if the roots are complex and no nodes are the same.
        h, w0sq, Om = (_number(q, self.for_differences) for q in (self.h, self.w0sq, self.Om))
        self.has_closed_form = self.w0sq > self.h * self.h and None not in self.inverses
        self.closed = FreeMotion(h, l1.imag, w0sq, Om, p=w0sq - Om * Om, q=2 * h * Om)
        self.for_differences.leave(before)

    def _roots(self, context: Context) -> tuple[Mpf, Mpf, Mpf]:
        """Return l1, l2, i Omega in a context.

        The roots l1, l2 of the free motion are the slow and the fast one or, if they are complex,
        the one with positive imaginary part first.
        """
        h, w0sq, Om = (_number(q, context) for q in (self.h, self.w0sq, self.Om))
        square = self.w0sq - self.h * self.h
        w = context.sqrt(_number(abs(square), context))
        if square > 0:
            l1 = context.mpc(-h, w)
            l2 = context.mpc(-h, -w)
        else:
            if self.h < 0:
                l2 = w - h
            else:
                l2 = -(h + w)
            if l2 != 0:
                l1 = w0sq / l2
            else:
                l1 = context.mpf(0)
        # Equal roots are decided in rational numbers: those that differ by rounding would be divided
        # by their difference.
        if self.h == 0 and self.w0sq == self.Om * self.Om:  # undamped resonance
            return context.mpc(0, Om), context.mpc(0, -Om), context.mpc(0, Om)
        if square == 0:  # critical damping
            return -h, -h, context.mpc(0, Om)
        return l1, l2, context.mpc(0, Om)

    def __call__(self, tau: Mpf, K: Any) -> tuple[Mpf, ...]:
        """Return E0, E1, E2, R2, I2 (responses to an impulse and to the drive) and sin, cos of
        Omega tau.
        """
        tau = self.context.convert(tau)
        short = K.rate * abs(tau) < MP_SERIES_BELOW
        if short:
            inner = self.for_series
        else:
            inner = self.for_differences
        before = inner.enter()
        try:
            if short:
                compute = self._series
            elif self.has_closed_form:
                compute = self._closed_form
            else:
                compute = self._divided_differences
            values = compute(inner.own(tau))
        finally:
            inner.leave(before)
        return inner.rounded(values, self.context)

    def _series(self, tau: Mpf) -> tuple[Mpf, ...]:
        """Return E0, E1, E2, R2, I2 and sine, cosine of Omega tau, by Taylor series in tau."""
        # `slope` and `term` are the n-th terms of E0 and E1 = its integral, by E0' = -cm E0 - w0sq
        # E1; r and i are those of R2 and I2, the parts of the integral of E1 exp(i Om t).
        context = self.for_series
        cm, w0sq, Om = self.constants
        unit = context.one
        zero = context.zero
        eps = +context.eps
        before = zero
        term = tau
        pull = w0sq * tau
        E0 = unit
        E1 = tau
        E2 = tau * tau / 2
        r = E2
        i = zero
        R2 = r
        I2 = i
        n = 0
        small_before = False
        while True:
            n += 1
            slope = -cm * term - pull * before / n
            before = term
            term = slope * tau / (n + 1)
            shorter = tau / (n + 2)
            r, i = (term - Om * i) * shorter, Om * r * shorter
            E0 = E0 + slope
            E1 = E1 + term
            E2 = E2 + term * shorter
            R2 = R2 + r
            I2 = I2 + i
            small = abs(slope) <= eps
            if small and small_before and abs(r) <= eps * R2 and abs(i) <= eps * abs(I2):
                wave = context.expj(Om * tau)
                return E0, E1, E2, R2, I2, wave.imag, wave.real
            small_before = small  # single terms may be 0 by accident

    def _closed_form(self, tau: Mpf) -> tuple[Mpf, ...]:
        """Return E0, E1, E2, R2, I2 and sine, cosine of Omega tau, by the closed form that sympy
        generated.
        """
        context = self.for_differences
        constants = self.closed
        decay = context.exp(-constants.h * tau)
        c_w, s_w = context.cos_sin(constants.w * tau)
        c, s = context.cos_sin(constants.Om * tau)
        return *basis_apart(decay, s_w, c_w, s, c, *constants), s, c

    def _divided_differences(self, tau: Mpf) -> tuple[Mpf, ...]:
        """Return E0, E1, E2, R2, I2 and sine, cosine of Omega tau, by divided differences of exp."""
        context = self.for_differences
        (l1, l2, i_Om) = self.roots
        over_roots, over_0_l1, over_Om_l1, over_0_l2, over_Om_l2 = self.inverses
        wave = context.expj(i_Om.imag * tau)
        if l1.imag:  # then the other root is the conjugate, and l1 - l2 = 2 i w
            exp1 = context.exp(l1.real * tau) * context.expj(l1.imag * tau)
            over_w = -2 * over_roots.imag
            inner = exp1.imag * over_w
            slope = (l1 * exp1).imag * over_w
        elif over_roots is not None:
            exp1 = context.exp(l1 * tau)
            exp2 = context.exp(l2 * tau)
            inner = (exp1 - exp2) * over_roots
            slope = (l1 * exp1 - l2 * exp2) * over_roots
        else:
            exp1 = context.exp(l1 * tau)
            inner = tau * exp1
            slope = (1 + l1 * tau) * exp1
        # tau e[0, l1 tau] and tau e[i Omega tau, l1 tau]; over equal nodes a difference of exp is
        # its derivative.
        if over_0_l1 is not None:
            still = (context.one - exp1) * over_0_l1
        else:
            still = tau * exp1
        if over_Om_l1 is not None:
            driven = (wave - exp1) * over_Om_l1
        else:
            driven = tau * exp1
        if over_0_l2 is not None:
            E2 = (still - inner) * over_0_l2
        else:
            E2 = tau * tau / 2
        Z = (driven - inner) * over_Om_l2
        return slope, inner, E2.real, Z.real, Z.imag, wave.imag, wave.real


def _number(value: Fraction, context: Context) -> Number:
    """Return a fraction as a number of an mpmath or MPFR context."""
    return context.mpf(value.numerator) / value.denominator
