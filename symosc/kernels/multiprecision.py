"""mpmath contexts whose precision is fixed, and whose numbers can be pickled.

An mpmath context keeps its precision in one place for all threads, and raising it for a while, as ``workdps`` does,
raises it for everybody. So nothing here changes a precision: whoever needs more digits takes the context that has
them, and rounds the result into its own. Such contexts can be shared by all threads.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

from symosc.kernels import interrupts

with interrupts.held_back():
    from mpmath.ctx_mp import MPContext
    from mpmath.libmp import from_pickable, to_pickable

from symosc.aliases import Number

BITS_PER_DIGIT = math.log2(10)


@lru_cache(maxsize=256)
def mp_context(digits: int) -> FixedContext:
    """Return the mpmath context with that many decimal digits; its precision cannot be changed."""
    return FixedContext(digits)


def with_bits(bits: int) -> FixedContext:
    """Return a context with at least that many bits."""
    return mp_context(math.ceil(bits / BITS_PER_DIGIT))


class FixedContext(MPContext):
    """An mpmath context of fixed precision.

    Its numbers are mpf and mpc as in mpmath; they can be pickled and copied, and keep all their digits.

    Parameters
    ----------
    digits : int
        Decimal digits of its precision.
    """

    def __init__(self, digits: int) -> None:
        super().__init__()
        self._set_dps(digits)
        self.mpf.__reduce__ = self.constant.__reduce__ = lambda number: (_real, (digits, to_pickable(number._mpf_)))
        self.mpc.__reduce__ = lambda number: (_complex, (digits, *map(to_pickable, number._mpc_)))

    def _refuse(self, value: int) -> None:
        raise AttributeError("the precision of this context is fixed, as others share it; change that of its .clone()")

    prec = property(lambda self: self._prec, _refuse)
    dps = property(lambda self: self._dps, _refuse)

    def enter(self) -> None:
        """Do nothing: these numbers know their precision (`symosc.kernels.mpfr`)."""

    leave = staticmethod(lambda before: None)

    def own(self, number: Any) -> Any:
        """Return an mpf of another context as one of this, with all its digits."""
        return self.make_mpf(number._mpf_)

    @staticmethod
    def rounded(numbers: Any, context: Any) -> tuple[Any, ...]:
        """Return real numbers as those of another mpmath context, rounded to its precision."""
        return tuple(+context.make_mpf(number._mpf_) for number in numbers)

    def lu_solve(self, A: Any, b: Any) -> Any:
        """Solve A x = b, A square, in this precision; mpmath's own raises it for a while."""
        factors, order = self.LU_decomp(self.matrix(A))
        return self.U_solve(factors, self.L_solve(factors, self.matrix(b), order))

    def clone(self) -> MPContext:
        """Return a new mpmath context of the same precision, which may be changed."""
        context = MPContext()
        context.dps = self.dps
        return context

    def __reduce__(self) -> tuple[object, ...]:
        return mp_context, (self.dps,)


def _real(digits: int, parts: object) -> Number:
    return mp_context(digits).make_mpf(from_pickable(parts))


def _complex(digits: int, real: object, imag: object) -> Number:
    return mp_context(digits).make_mpc((from_pickable(real), from_pickable(imag)))
