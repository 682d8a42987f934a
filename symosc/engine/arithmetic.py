"""The same scalar source as CPython floats, as compiled code and in any number of digits.

The fast paths (SOURCES) are plain functions on numbers. Here they are
bound (`symosc.engine.binding`) to mpmath's sin, cos, sqrt and precision, or to compiled versions of each other.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

from symosc.aliases import Number
from symosc.engine import (
    binding,
    compiled_loop,
    events,
    extremes,
    first_exit,
    flow,
    gap_bounds,
    march,
    near_event,
    next_event,
    rests,
    settled,
    state,
    stick_exit,
    switching,
    tally,
    touches,
)
from symosc.engine.flow import Constants, constants, with_march
from symosc.engine.paths import Paths
from symosc.kernels import _generated, double_double, entire
from symosc.model import Parameters

SOURCES = (
    _generated,
    entire,
    state,
    flow,
    switching,
    gap_bounds,
    touches,
    march,
    first_exit,
    rests,
    stick_exit,
    next_event,
    events,
    compiled_loop,
)
# What is done with many digits only.
IN_DIGITS_ONLY = (near_event,)
# What is done with motions in doubles only.
IN_DOUBLES_ONLY = (double_double, extremes, tally, settled)


# What decisions must exceed with mpmath, instead of `touches.ROUNDING` and `flow.SIGMAS`.
MP_ROUNDING = 2**16
MP_SIGMAS = 2**10

# Called from several places and rarely: not worth a copy in each.
OUTLINED = {
    "closest_approach",
    "quartic_start",
    "series",
    "careful",
    "stiff_derivatives",
    "stepped",
    "halved",
    "newton_root",
    "behind_flat_start",
    "apart_from_walls",
    "point_at_end",
    "no_contact",
    "creeps_for_ever",
    "touch_belt",
    "slow_passing_time",
    "sine_and_cosine_of",
    "resolve",
    "tolerance",
    "parts_again",
    "hidden",
    "follow_all",
    "next_doubt",
    "search_row",
    "searched",
    "march_rows",
    "tally_stretch",
    "flight_extremes",
    "covered",
    "within",
    "cut_at",
    "stationary",
    "leave_tally",
    "rest_stretches",
    "flown",
    "settle",
    "periods",
    "section",
}


#: The fast paths' names as they are: for floats.
IN_DOUBLES = {name: value for module in SOURCES for name, value in vars(module).items() if not name.startswith("__")}
#: Those of them that follow a motion.
FLOAT_PATHS = Paths(IN_DOUBLES)


class Arithmetic:
    """Numbers of one kind, with the fast paths bound to them.

    Attributes
    ----------
    parameters : Parameters
    K : Constants
    number : callable
        Rounds a Fraction to such a number.
    """

    K: Constants
    digits = 40  # that the reduction of phases takes; more than doubles have, for phases next to 0 or 2 pi

    def __init__(self, parameters: Parameters) -> None:
        self.parameters = parameters
        self.K = _float_constants(parameters)
        self.namespace: dict[str, Any] = IN_DOUBLES

    @property
    def paths(self) -> Paths:
        """What follows motions with these numbers."""
        return FLOAT_PATHS

    number: Callable[[Fraction], Number] = staticmethod(float)

    def phase(self, t: Fraction) -> tuple[int, Number]:
        """Return (periods, theta) with Omega t = 2 pi periods + theta, theta in [0, 2 pi), correctly rounded."""
        periods, theta = _reduced(self.parameters.Omega * t, self.digits)
        return periods, self.rounded(theta) if theta else self.number(Fraction(0))

    def time(self, t: Fraction) -> tuple[Number, Number]:
        """Return a time as the sum of two such numbers."""
        high = float(t)
        return high, float(t - Fraction(high))

    def rounded(self, value: Number) -> Number:
        """Round an mpf to such a number."""
        return float(value)


class MpArithmetic(Arithmetic):
    """The fast paths with `digits` decimal digits (mpmath)."""

    def __init__(self, parameters: Parameters, digits: int) -> None:
        from symosc.kernels.entire_mp import BasisMP

        context = mp_context(digits)
        self.parameters, self.context, self.digits = parameters, context, digits
        basis = BasisMP(context, parameters)
        K = with_march(constants(parameters, self.number, context.sqrt, context.atan2, +context.pi), basis)
        self.K = K._replace(sigmas=context.mpf(MP_SIGMAS))
        eps = context.ldexp(1, -context.prec)
        replaced = {name: getattr(context, name) for name in ("sin", "cos", "exp", "sqrt")}
        replaced |= {"EPS": eps, "NEAR": eps ** (context.mpf(1) / 5), "PI": +context.pi, "SIXTH": context.mpf(1) / 6}
        replaced |= {"ROUNDING": context.mpf(MP_ROUNDING)}  # digits are cheap here, wrong decisions are not
        replaced |= {"TWO_PI": 2 * context.pi, "TWO_PI_REST": context.mpf(0), "basis": basis}
        replaced["rest_of_product"] = no_rest
        self.namespace = binding.bind((*SOURCES, *IN_DIGITS_ONLY), replaced, literal=context.mpf)
        self._replaced = replaced

    @cached_property
    def paths(self) -> Paths:
        """What follows motions with these numbers: by MPFR where gmpy2 is installed, else by mpmath."""
        try:
            from symosc.engine.mpfr_arithmetic import MpfrPaths
        except ImportError:
            return Paths(self.namespace)
        return MpfrPaths(self.parameters, self.context, (*SOURCES, *IN_DIGITS_ONLY), self._replaced)

    def number(self, value: Fraction) -> Number:
        """Round a Fraction to an mpf of this precision."""
        return self.context.mpf(value.numerator) / value.denominator

    def time(self, t: Fraction) -> tuple[Number, Number]:
        """Return a time and 0."""
        return self.number(t), self.number(Fraction(0))

    def rounded(self, value: Number) -> Number:
        """Round an mpf of any precision to one of this precision."""
        return self.context.mpf(value)


def no_rest(a, b):
    """Return 0, for `symosc.kernels.double_double.rest_of_product`."""
    return 0.0 * a


@lru_cache(maxsize=64)
def many_digits(parameters: Parameters, digits: int) -> MpArithmetic:
    """Return the arithmetic with that many digits; it is shared, and kept, as its constants take a while."""
    return MpArithmetic(parameters, digits)


@lru_cache(maxsize=1024)
def _float_constants(parameters: Parameters) -> Constants:
    """Return the constants in floats; their derivation in rational numbers takes longer than many a short run."""
    return with_march(constants(parameters), entire.basis)


@lru_cache(maxsize=256)
def _reduced(angle: Fraction, digits: int) -> tuple[int, Any]:
    """Return (turns, rest) of an angle; many starts have the same."""
    if angle == 0:
        return 0, None
    context = mp_context(digits + 20 + len(str(abs(int(angle)))))
    turns = context.mpf(angle.numerator) / angle.denominator / (2 * context.pi)
    periods = int(context.floor(turns))
    return periods, (turns - periods) * 2 * context.pi


def mp_context(digits: int) -> Any:
    """Return an mpmath context of fixed precision (`symosc.kernels.multiprecision`, which loads mpmath)."""
    from symosc.kernels.multiprecision import mp_context

    return mp_context(digits)


@lru_cache(maxsize=1)
def compiled() -> dict[str, Any]:
    """Return the fast paths compiled by numba.

    Raises
    ------
    MissingExtraError
        If numba is not installed.
    """
    return binding.compiled((*SOURCES, *IN_DOUBLES_ONLY), OUTLINED)
