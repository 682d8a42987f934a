"""The engine in double-double numbers, 30 digits: compiled by numba, at a few microseconds per event, or interpreted.

The source is that of doubles. Its literals and constants become pairs, rounded once from rational numbers or from
mpmath's 60 digits; operators and functions have their meaning from `symosc.kernels.pair_type` and `pair_functions`.
CPython and compiled code give the same bits, so nothing but time depends on which of them is used. An interpreted event
takes a few milliseconds. This module needs numba.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numba

from symosc.engine import binding, pair_loop, rounding, tally
from symosc.engine.arithmetic import IN_DIGITS_ONLY, MP_ROUNDING, SOURCES, many_digits, no_rest
from symosc.engine.arithmetic import compiled as in_doubles
from symosc.engine.constant_table import ConstantRows
from symosc.engine.flow import Constants
from symosc.engine.pair_loop import Going
from symosc.engine.paths import converted
from symosc.kernels import _generated, double_double, pair_functions, pair_type
from symosc.kernels.entire import INVERSES
from symosc.kernels.multiprecision import mp_context
from symosc.kernels.pair_type import Pair, pair_of
from symosc.model import Parameters

__all__ = ["Going", "as_complex", "compiled_pairs", "interpreted_pairs", "is_compiled", "pair_constants", "pair_phase"]

# What errors are estimated from: 64 times the rounding of one operation, as an entire function loses a digit or two.
PAIR_EPS = Fraction(1, 2**100)
# Digits from which constants and starts are rounded.
ROUNDED_FROM = 50


def least(a, b):
    """Return the smaller of two pairs."""
    return b if b < a else a


def greatest(a, b):
    """Return the larger of two pairs."""
    return b if b > a else a


def as_pair(z):
    """Return the pair that a complex number stands for."""
    return pair_type.from_complex(z)


class PairLoops(NamedTuple):
    """The functions of `symosc.engine.pair_loop`: how motions are begun and followed in double-double numbers."""

    first_pairs: Any
    follow_pairs: Any


MODULES = (*SOURCES, *IN_DIGITS_ONLY, pair_loop)


def _constants() -> dict[str, Any]:
    """Return the engine's constants as pairs."""
    two_pi = 2 * mp_context(70).pi
    return {
        "EPS": Pair(PAIR_EPS),
        "NEAR": Pair(Fraction(1, 2**20)),
        "PI": Pair(two_pi / 2),
        "TWO_PI": Pair(two_pi),
        "TWO_PI_REST": Pair(two_pi - Pair(two_pi).hi - Pair(two_pi).lo),
        "SIXTH": Pair(Fraction(1, 6)),
        "INVERSES": (Pair(0.0), *(Pair(Fraction(1, n)) for n in range(1, len(INVERSES)))),
        "ROUNDING": Pair(float(MP_ROUNDING)),
    }


@lru_cache(maxsize=1)
def compiled_pairs() -> PairLoops:
    """Return the loops compiled by numba: each when it is first called, and kept on disk."""
    callees = binding.bind((rounding,), {}, numba.njit)
    callees |= {"min": numba.njit(least), "max": numba.njit(greatest), "float": numba.njit(as_pair)}
    callees["rest_of_product"] = numba.njit(no_rest)
    plain = in_doubles()  # summaries are of doubles
    callees |= {name: plain[name] for name in ("tally_step", "leave_tally")}
    in_doubles_too = {"searched": "searched", "next_doubt": "next_doubt", "end_by_phase": "end"}
    in_doubles_too["write_event"] = "write_event"
    callees |= {f"{name}_in_doubles": plain[called] for called, name in in_doubles_too.items()}
    beside = (pair_type, pair_functions, double_double, tally)
    outlined = binding.functions_of(MODULES).keys() - binding.functions_of((_generated,)).keys() - {"derivatives"}
    functions = binding.compiled(MODULES, outlined, callees, _constants(), Pair, beside)
    return PairLoops(*(functions[name] for name in PairLoops._fields))


@lru_cache(maxsize=1)
def interpreted_pairs() -> PairLoops:
    """Return the loops as CPython runs them."""

    def number(z: Any) -> Any:
        return pair_of(float(z.real), float(z.imag)) if isinstance(z, complex) else z

    def whole(value: Any) -> int:
        return int(value.real if isinstance(value, complex) else value)

    def follow_pairs(
        chosen: Any, wanted: Any, pairs: Any, batch: Any, out: Any, K: Any, tally: Any, going: Going
    ) -> int:
        rows: Any = (ConstantRows(table) for table in going[3:])
        return functions["follow_pairs"](chosen, wanted, pairs, batch, out, K, tally, Going(*going[:3], *rows))

    bound = binding.bind((pair_functions,), {"pair": pair_of})
    replaced = _constants() | {name: bound[each.__name__] for name, each in pair_functions.FUNCTIONS.items()}
    replaced |= {"min": least, "max": greatest, "float": number, "int": whole, "rest_of_product": no_rest}
    replaced["from_complex"] = partial(converted, number=number)
    functions = binding.bind(MODULES, replaced, literal=Pair)
    return PairLoops(functions["first_pairs"], follow_pairs)


def is_compiled() -> bool:
    """Return whether both were compiled before, here or in an earlier program that left them on disk."""
    return all(map(binding.is_compiled, compiled_pairs()))


def as_complex(value: Any) -> Any:
    """Return an mpf as the complex number hi + i lo, or a tuple with some; what is none stays."""

    def number(entry: Any) -> Any:
        if not hasattr(entry, "_mpf_"):
            return entry
        high = float(entry)
        short = entry._mpf_[3] <= 53  # the bits of its mantissa
        return complex(high, 0.0 if short else float(entry - high))

    return converted(value, number)


@lru_cache(maxsize=1024)
def pair_constants(parameters: Parameters) -> Constants:
    """Return the constants as complex numbers hi + i lo, each rounded once."""
    return as_complex(many_digits(parameters, ROUNDED_FROM).K)


def pair_phase(parameters: Parameters, t: Fraction) -> complex:
    """Return the phase at a time, rounded once."""
    found: complex = as_complex(many_digits(parameters, ROUNDED_FROM).phase(t)[1])
    return found
