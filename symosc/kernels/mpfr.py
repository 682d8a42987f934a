"""Numbers of any fixed precision by MPFR (gmpy2), with the methods of an mpmath context that the
kernels need.

gmpy2 rounds to the precision of its current context, which each thread has for itself. Here a
precision is current only between `enter` and `leave`, and what was current before comes back. A
context belongs to one precision and is shared by all threads: nothing in it changes but MPFR's
flags, which nobody reads.

This module needs gmpy2 (extra `fast`).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from symosc.kernels.multiprecision import interrupts_held_back

with interrupts_held_back():
    import gmpy2
    from mpmath.libmp import MPZ, from_man_exp

mpfr = gmpy2.mpfr
mpc = gmpy2.mpc


@lru_cache(maxsize=4096)
def _power_of_two(exponent: int) -> Any:
    """Return 2^exponent as an mpfr."""
    return mpfr(2) ** exponent


def from_mpf(number: Any) -> Any:
    """Return an mpf as an mpfr, rounded to the current precision."""
    sign, mantissa, exponent, _ = number._mpf_
    if not mantissa:  # mpmath's way to write 0, the infinities and what is no number
        return mpfr(float(number))
    size = gmpy2.mpz(mantissa) * _power_of_two(exponent)
    if sign:
        return -size
    return size


def to_mpf(number: Any, context: Any) -> Any:
    """Return an mpfr as a number of an mpmath context, rounded if that has fewer digits."""
    if not gmpy2.is_finite(number):
        return context.mpf(float(number))
    mantissa, exponent = number.as_mantissa_exp()
    return context.make_mpf(from_man_exp(MPZ(mantissa), int(exponent), context.prec, "n"))


@lru_cache(maxsize=256)
def mpfr_context(bits: int) -> MpfrContext:
    """Return the shared context of MPFR with `bits` bits."""
    return MpfrContext(bits)


class MpfrContext:
    """A fixed precision of MPFR, of `prec` bits, with the largest range of exponents."""

    # Division by 0 and results that are no numbers raise, as they do with mpmath.

    sin, cos, exp, sqrt = (
        staticmethod(getattr(gmpy2, name)) for name in ("sin", "cos", "exp", "sqrt")
    )
    mpf = mpfr
    mpc = mpc
    from_mpf = staticmethod(from_mpf)
    to_mpf = staticmethod(to_mpf)
    with_bits = staticmethod(mpfr_context)

    def __init__(self, prec: int) -> None:
        self.prec = prec
        largest = {"emax": gmpy2.get_emax_max(), "emin": gmpy2.get_emin_min()}
        self._context = gmpy2.context(
            precision=prec, trap_divzero=True, trap_invalid=True, **largest
        )
        before = self.enter()
        self.zero = mpfr(0)
        self.one = mpfr(1)
        self.eps = gmpy2.div_2exp(mpfr(1), prec - 1)
        self.pi = gmpy2.const_pi()
        self.leave(before)

    def enter(self) -> Any:
        """Make this precision MPFR's current one in this thread.

        Return the context that was current before.
        """
        before = gmpy2.get_context()
        gmpy2.set_context(self._context)
        return before

    @staticmethod
    def leave(before: Any) -> None:
        """Make the context `before`, which `enter` has returned, current again."""
        gmpy2.set_context(before)

    @staticmethod
    def own(number: Any) -> Any:
        """Return `number` unchanged: unlike one of mpmath, a number of MPFR belongs to no context."""
        return number

    @staticmethod
    def rounded(numbers: Any, context: MpfrContext) -> tuple[Any, ...]:
        """Return `numbers` rounded to MPFR's current precision.

        `context` must be the current one.
        """
        return tuple([+number for number in numbers])

    convert = staticmethod(mpfr)

    @staticmethod
    def cos_sin(angle: Any) -> tuple[Any, Any]:
        """Return cosine and sine of an angle."""
        s, c = gmpy2.sin_cos(angle)
        return c, s

    @staticmethod
    def expj(angle: Any) -> Any:
        """Return exp(i angle)."""
        s, c = gmpy2.sin_cos(angle)
        return mpc(c, s)
