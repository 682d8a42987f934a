"""The engine for each kind of numbers (doubles, pairs, many digits): its functions, bound to their
arithmetic.

The inner loop (SOURCES) is plain functions on numbers, which `symosc.kernels.rebind` copies with
other globals (mpmath's sin, cos and precision, or compiled functions), and which
`symosc.kernels.compiling` lets numba compile: nothing is written twice. So there are

- `Arithmetic`: doubles, as CPython runs the source; `compiled` has the same functions compiled by
  numba;
- `MpArithmetic`: any number of digits, by mpmath, and by MPFR where gmpy2 is installed;
- double-double numbers, 30 digits (`symosc.kernels.pairs`): `compiled_pairs`, at a few microseconds
  an event, or `interpreted_pairs`, at a few milliseconds. Both give the same bits. These need
  numba.
"""

from __future__ import annotations

import math
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from functools import cache, cached_property, lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Number
from symosc.base.errors import MissingExtraError
from symosc.engine import (
    batch,
    events,
    first_exit,
    flow,
    lanes,
    next_event,
    state,
    summary,
    tangent,
)
from symosc.engine.flow import (
    NESTED,
    ROW,
    ConstantRows,
    Constants,
    constants,
    constants_in,
    pair_table_of,
    with_march,
)
from symosc.engine.state import TUPLES_IN_FOLLOWED, Followed, NextEvent, State
from symosc.kernels import (
    _generated,
    double_double,
    elementary,
    entire,
    entire_array,
    mapping,
    pair_programs,
)
from symosc.kernels.compiling import compile_modules, is_compiled
from symosc.kernels.rebind import bind, functions_of, outlined_in
from symosc.model import Model

SOURCES = (_generated, entire, state, flow, first_exit, next_event, events, batch)
# Summaries are of doubles only.
IN_DOUBLES_ONLY = (double_double, elementary, summary, lanes)

# What decisions must exceed with many digits, instead of `first_exit.ROUNDING` and `flow.SIGMAS`:
# digits are cheap there, wrong decisions are not.
MP_ROUNDING = 2**16
MP_SIGMAS = 2**10
# In pairs errors are estimated from 64 times the rounding of one operation, as an entire function
# loses a digit or two.
PAIR_EPS = Fraction(1, 2**100)
# Digits from which constants and starts are rounded to pairs.
ROUNDED_FROM = 50

#: The compiled functions for doubles that Python calls.
ENTRIES = (
    "march_rows",
    "follow_all",
    "follow_lanes",
    "settle",
    "search_row",
    "doubt_row",
    "block",
)

# --- numbers in tuples ---


def converted(value: Any, number: Callable[[Any], Any]) -> Any:
    """Apply the function `number` to a value, or to each entry of a tuple and of the tuples in it."""
    if not isinstance(value, tuple):
        return number(value)
    entries = [converted(entry, number) for entry in value]
    if hasattr(value, "_fields"):
        return type(value)(*entries)
    return tuple(entries)


def interpreted(function: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap an interpreted event loop so that any argument may be a numpy table of constants (dtype
    `ROW`).
    """

    def readable(argument: Any) -> Any:
        if getattr(argument, "dtype", None) == ROW:
            return ConstantRows(argument)
        return argument

    return lambda *arguments: function(*converted(arguments, readable))


def product_and_zero(a, b):
    """Return (a b, 0.0) for pairs or many digits, in place of the exact product `two_product` of
    two doubles.
    """
    return a * b, 0.0 * a


# --- doubles ---

#: The names of the source as they are: for floats.
IN_DOUBLES = {
    name: value
    for module in SOURCES
    for name, value in vars(module).items()
    if not name.startswith("__")
}


class Arithmetic:
    """Double precision: the constants `K`, number `row` of those of the law, conversion of numbers,
    and `advance`.

    Base class for pairs and many digits.
    """

    K: Constants
    # that the reduction of phases takes; more than doubles have, for phases next to 0 or 2 pi
    digits = 40
    number: Callable[[Fraction], Number] = staticmethod(float)  # rounds a Fraction to such a number
    rounded: Callable[[Number], Number] = staticmethod(float)  # rounds an mpf of any precision
    namespace = IN_DOUBLES

    def __init__(self, parameters: Model, row: int = 0) -> None:
        self.parameters = parameters
        self.row = row
        self.K = _float_constants(parameters, row)

    def phase(self, t: Fraction) -> tuple[Number, Number]:
        """Return the phase Omega t mod 2 pi, in [0, 2 pi), of an exact time in two parts: rounded,
        and the rest.
        """
        theta = _angle_in_turn(self.parameters.Omega * t, self.digits)
        if theta is None:
            return self.number(Fraction(0)), self.number(Fraction(0))
        rounded = self.rounded(theta)
        return rounded, self.rounded(theta - rounded)

    def time(self, t: Fraction) -> tuple[Number, Number]:
        """Return an exact time as the sum (high, low) of two numbers of this arithmetic."""
        high = float(t)
        return high, float(t - Fraction(high))

    def advance(self, state: State, t_end: Number, t_end_low: Number) -> NextEvent:
        """Return the NextEvent after `state`: the next event up to t_end + t_end_low, or why there
        is none yet.
        """
        event: NextEvent = next_event.advance(state, t_end, t_end_low, self.K)
        return event


@lru_cache(maxsize=1024)
def _float_constants(parameters: Model, row: int) -> Constants:
    """Return a row of the constants of `parameters` as floats, from a cache: to derive them exactly
    takes long.
    """
    return with_march(constants(parameters, row=row), entire.basis)


@lru_cache(maxsize=256)
def rows_in_doubles(parameters: Model) -> tuple[Constants, ...]:
    """Return all rows of the constants of `parameters` as floats, from a cache."""
    rows = [_float_constants(parameters, row) for row in range(len(parameters.law.rows))]
    # Lanes have motions in several rows side by side, and one such flag for all.
    lasting = any(K.lasting for K in rows)
    return tuple(K._replace(lasting=lasting) for K in rows)


@lru_cache(maxsize=256)
def _angle_in_turn(angle: Fraction, digits: int) -> Any:
    """Return an exact angle modulo 2 pi to `digits` digits, or None if the angle is 0.

    Results are cached.
    """
    if angle == 0:
        return None
    # The whole turns take as many digits as the angle has before the point; 20 are to spare.
    context = mp_context(digits + 20 + len(str(abs(int(angle)))))
    turns = context.mpf(angle.numerator) / angle.denominator / (2 * context.pi)
    return (turns - int(context.floor(turns))) * 2 * context.pi


@cache
def compiled(width: int = 0) -> dict[str, Any]:
    """Return the compiled engine for doubles, by name.

    It follows `width` motions at once (0: the best number).
    """
    try:
        from symosc.kernels import lane_types
    except ImportError:
        raise MissingExtraError("compiling", "fast") from None
    # 0: no lanes; then no function of lanes is ever called or compiled, and any width will do.
    usual = width or lane_types.usual_width()
    callees = {"borrowed": lane_types.borrowed, "power_of_two": lane_types.power_of_two}
    # the constants that are flags, which tables keep as 0.0 or 1.0
    flags = frozenset(
        name for name, hint in Constants.__annotations__.items() if "bool" in str(hint)
    )
    replaced = {
        name: getattr(lane_types, name)
        for name in ("any_of", "bits_of", "number_in", "put_number", "select", "store_tuple")
    }
    lanes_of = partial(lane_types.tuple_loader, usual or 8)
    replaced["LANES"] = usual or 8
    replaced["load_motion"] = lanes_of(Followed, TUPLES_IN_FOLLOWED)
    replaced["load_constants"] = lanes_of(Constants, NESTED, flags)
    modules = *SOURCES, *IN_DOUBLES_ONLY
    functions = compile_modules(
        modules, outlined_in(modules), callees, replaced, beside=(lane_types,), entries=ENTRIES
    )
    return functions | {"follow_all": functions["follow_lanes" if usual else "follow_all"]}


def loaded_loop() -> dict[str, Any] | None:
    """Return the compiled engine if its event loop `follow_all` has already run in this process,
    else None.
    """
    if compiled.cache_info().currsize:
        functions = compiled()
    else:
        functions = {}
    if functions and functions["follow_all"].overloads:
        return functions
    return None


@lru_cache(maxsize=1)
def compiled_tangents() -> dict[str, Any]:
    """Return the compiled functions for derivatives of events.

    Raise MissingExtraError without numba.
    """
    modules = mapping, tangent
    callees = dict(compiled())
    del callees["exp"]  # that of `mapping` is of complex numbers
    entries = ("tangents", "changes_at")
    return compile_modules(modules, outlined_in(modules), callees, entries=entries)


@lru_cache(maxsize=1)
def compiled_program() -> Callable[..., None]:
    """Return the compiled function that computes programs of pairs.

    Raise MissingExtraError without numba.
    """
    modules = double_double, pair_programs
    functions = compile_modules(modules, outlined_in(modules), entries=("run_program",))
    run: Callable[..., None] = functions["run_program"]
    return run


# --- columns ---


@lru_cache(maxsize=1)
def column_functions() -> dict[str, Any]:
    """Return sine, cosine, exp, expm1 and the basis (E0 to I2) for numpy arrays, the same bits on
    every processor.
    """
    powers = {"select": np.where, "power_of_two": lambda n: np.ldexp(1.0, n.astype(np.int64))}
    own = bind((elementary,), powers)
    short_sin = own["short_sin"]
    short_cos = own["short_cos"]
    widest = elementary.WIDEST
    own["sin"] = lambda x: np.where(abs(x) <= widest, short_sin(x), np.sin(x))
    own["cos"] = lambda x: np.where(abs(x) <= widest, short_cos(x), np.cos(x))
    # `entire_array` calls functions of `np`: of numpy, but for those that are written here.
    like_numpy = {name: getattr(np, name) for name in ("array", "empty", "shape")}
    like_numpy |= {name: own[name] for name in ("sin", "cos", "exp", "expm1")}
    return own | bind((entire_array,), {"np": types.SimpleNamespace(**like_numpy)})


# --- any number of digits ---


class MpArithmetic(Arithmetic):
    """Numbers with `digits` decimal digits.

    `context` is their mpmath context, and MPFR follows motions if `fast`.
    """

    # Motions are followed by MPFR where gmpy2 is installed, at the same precision and six times as
    # fast: `inward` and `outward` convert, and arithmetic on its numbers belongs into a block
    # ``with arithmetic.precision():``. Both round the four operations and the square root
    # correctly, so results differ, if at all, in the last bits of a sine. With `fast` False all is
    # done by mpmath, also the search for events.

    def __init__(self, parameters: Model, digits: int, fast: bool = True, row: int = 0) -> None:
        from symosc.kernels.multiprecision import BasisMP

        context = mp_context(digits)
        self.parameters = parameters
        self.row = row
        self.context = context
        self.digits = digits
        self.fast = fast
        self.rounded = context.mpf
        basis = BasisMP(context, parameters, row=row)
        exact = constants(
            parameters, self.number, context.sqrt, context.atan2, +context.pi, row=row
        )
        K = with_march(exact, basis)
        self.K = K._replace(sigmas=context.mpf(MP_SIGMAS))
        eps = context.ldexp(1, -context.prec)
        self._replaced = {
            name: getattr(context, name) for name in ("sin", "cos", "exp", "sqrt")
        } | {
            "EPS": eps,
            "NEAR": eps ** (context.mpf(1) / 5),
            "PI": +context.pi,
            "TWO_PI": 2 * context.pi,
            "TWO_PI_REST": context.mpf(0),
            "SIXTH": context.mpf(1) / 6,
            "ROUNDING": context.mpf(MP_ROUNDING),
            "basis": basis,
            "two_product": product_and_zero,
        }

    @cached_property
    def namespace(self) -> dict[str, Any]:  # type: ignore[override]
        """The engine's functions for mpmath numbers of this precision, by name."""
        return bind(SOURCES, self._replaced, literal=self.context.mpf)

    def number(self, value: Fraction) -> Number:
        """Round a Fraction to an mpf of this precision."""
        return self.context.mpf(value.numerator) / value.denominator

    def time(self, t: Fraction) -> tuple[Number, Number]:
        """Return a time as the pair (t, 0) of numbers with all digits."""
        return self.number(t), self.number(Fraction(0))

    @cached_property
    def _inner(self) -> Any:
        """The context that computes the motion: of MPFR if gmpy2 is installed and `fast` is set,
        else of mpmath.
        """
        try:
            from symosc.kernels.mpfr import mpfr_context
        except ImportError:
            return self.context
        if self.fast:
            return mpfr_context(self.context.prec)
        return self.context

    @cached_property
    def following(self) -> dict[str, Any]:
        """The engine's functions by name, for numbers of MPFR if these follow the motion, else of
        mpmath.
        """
        inner = self._inner
        if inner is self.context:
            return self.namespace
        from symosc.kernels.multiprecision import BasisMP

        replaced = {name: self.inward(value) for name, value in self._replaced.items()}
        replaced |= {name: getattr(inner, name) for name in ("sin", "cos", "exp", "sqrt")}
        return bind(
            SOURCES,
            replaced | {"basis": BasisMP(inner, self.parameters, inner.with_bits, self.row)},
            literal=inner.mpf,
        )

    @contextmanager
    def precision(self) -> Iterator[None]:
        """Return a context manager: within its block MPFR rounds to this precision, as the event
        loop needs.
        """
        before = self._inner.enter()
        try:
            yield
        finally:
            self._inner.leave(before)

    def advance(self, state: State, t_end: Number, t_end_low: Number) -> NextEvent:
        """Return the NextEvent after `state`: the next event up to t_end + t_end_low, or why there
        is none yet.
        """
        with self.precision():
            arguments = self.inward((state, t_end, t_end_low))
            event: NextEvent = self.outward(self.following["advance"](*arguments, self.inner_K))
            return event

    def inward(self, value: Any) -> Any:
        """Convert an mpmath number, or all in a tuple, to the numbers that the event loop computes
        with (MPFR's).
        """
        inner = self._inner
        if inner is self.context:
            return value
        with self.precision():
            return converted(
                value, lambda entry: inner.from_mpf(entry) if hasattr(entry, "_mpf_") else entry
            )

    @cached_property
    def inner_K(self) -> Constants:
        """The constants K as the numbers that the event loop computes with (MPFR's if gmpy2 is
        installed).
        """
        K: Constants = self.inward(self.K)
        return K

    def outward(self, value: Any, context: Any = None) -> Any:
        """Convert a number, or all in a tuple, to mpmath numbers of `context` (None: this
        arithmetic's own).
        """
        context = context or self.context
        inner = self._inner
        if inner is self.context:
            if context is inner:
                return value
            return converted(value, context.mpf)
        mpfr = inner.mpf
        to_mpf = inner.to_mpf
        if type(value) is tuple:  # the numbers of an event
            return tuple([to_mpf(entry, context) for entry in value])
        return converted(
            value, lambda entry: to_mpf(entry, context) if type(entry) is mpfr else entry
        )


@lru_cache(maxsize=256)
def many_digits(parameters: Model, digits: int, row: int = 0) -> MpArithmetic:
    """Return the arithmetic with `digits` decimal digits, from a cache: its constants take long to
    derive.
    """
    return MpArithmetic(parameters, digits, row=row)


def mp_context(digits: int) -> Any:
    """Return the mpmath context of fixed precision with `digits` digits.

    Mpmath is loaded at the first call.
    """
    from symosc.kernels.multiprecision import mp_context

    return mp_context(digits)


# --- double-double numbers ---

# What the loops of pairs compute in doubles: the name that they call, and the function for doubles
# that it stands for.
PLAIN_IN_PAIRS = {
    f"{name}_in_doubles": name
    for name in (
        "end_by_phase",
        "entered",
        "next_undecided",
        "open_free_time",
        "searched",
        "write_event",
        "write_piece",
    )
} | {
    name: name
    for name in ("is_below", "rounding_error", "rounded_covariance", "tally_step", "finish_tally")
}


class PairLoops(NamedTuple):
    """The two functions that start (`first_pairs`) and follow (`follow_pairs`) motions in
    double-double numbers.
    """

    first_pairs: Any
    follow_pairs: Any


def _pair_constants() -> dict[str, Any]:
    """Return the module constants of the engine's source (EPS, PI, ...) as pairs."""
    from symosc.kernels.pairs import Pair

    two_pi = 2 * mp_context(70).pi
    return {
        "EPS": Pair(PAIR_EPS),
        "NEAR": Pair(Fraction(1, 2**20)),  # PAIR_EPS to the power 1/5
        "PI": Pair(two_pi / 2),
        "TWO_PI": Pair(two_pi),
        "TWO_PI_REST": Pair(two_pi - Pair(two_pi).hi - Pair(two_pi).lo),
        "SIXTH": Pair(Fraction(1, 6)),
        "INVERSES": (Pair(0.0), *(Pair(Fraction(1, n)) for n in range(1, len(entire.INVERSES)))),
        "ROUNDING": Pair(float(MP_ROUNDING)),
    }


@lru_cache(maxsize=1)
def compiled_pairs() -> PairLoops:
    """Return the loops of double-double numbers compiled by numba, each at its first call, cached
    on disk.
    """
    import numba

    from symosc.kernels import pairs

    plain = compiled()
    callees = {name: plain[function] for name, function in PLAIN_IN_PAIRS.items()}
    # what the engine calls and pairs do otherwise than doubles, compiled as it is
    own = {
        "min": lambda a, b: b if b < a else a,
        "max": lambda a, b: b if b > a else a,
        "float": pairs.as_pair,
    }
    own |= {"two_product": product_and_zero, "select": elementary.select}
    callees |= {name: numba.njit(function) for name, function in own.items()}
    # Every function is called, but kernels and `derivatives`, which are copied into their callers.
    outlined = functions_of(SOURCES).keys() - functions_of((_generated,)).keys() - {"derivatives"}
    replaced = _pair_constants() | {name: getattr(math, name) for name in pairs.FUNCTIONS}
    replaced["from_complex"] = pairs.from_complex
    pairs.ROWS |= {kind._fields: kind for kind in (Constants, *NESTED.values())}
    beside = (pairs, double_double, summary)
    functions = compile_modules(
        SOURCES, outlined, callees, replaced, pairs.Pair, beside, PairLoops._fields
    )
    return PairLoops(*(functions[name] for name in PairLoops._fields))


@lru_cache(maxsize=1)
def interpreted_pairs() -> PairLoops:
    """Return the loops of double-double numbers as CPython runs them."""
    from symosc.kernels import pairs

    # In tables (PAIR_ROW) and constants a pair is a complex number: hi its real part, lo its
    # imaginary part.
    def number(value: Any) -> Any:
        if isinstance(value, complex):
            return pairs.pair_of(float(value.real), float(value.imag))
        return value

    def whole(value: Any) -> int:
        return int(value.real if isinstance(value, complex) else value)

    # What stands for names of the engine's source; no name is in two of these groups. First
    # constants, and functions such as `sin`, which themselves make pairs by numba's `pair`.
    bound = bind((pairs,), {"pair": pairs.pair_of})
    replaced = _pair_constants()
    replaced |= {name: bound[own.__name__] for name, own in pairs.FUNCTIONS.items()}
    replaced["two_product"] = product_and_zero

    def from_complex(value: Any) -> Any:
        if isinstance(value, np.void):
            value = constants_in(value)
        return converted(value, number)

    # The source reads the numbers of a row by float() and int(), and all constants at once.
    replaced |= {"float": number, "int": whole, "from_complex": from_complex}
    # What is computed in doubles beside pairs, such as the search for an event.
    replaced |= {name: IN_DOUBLES[function] for name, function in PLAIN_IN_PAIRS.items()}
    functions = bind(SOURCES, replaced, literal=pairs.Pair)
    return PairLoops(functions["first_pairs"], interpreted(functions["follow_pairs"]))


def pairs_are_compiled() -> bool:
    """Return whether both loops of `compiled_pairs` are compiled, in this process or on disk."""
    return all(map(is_compiled, compiled_pairs()))


def pairs_are_loaded() -> bool:
    """Return whether the loops of pairs are compiled, and the compiled loop of doubles has run in
    this process.
    """
    return loaded_loop() is not None and pairs_are_compiled()


def pairs_as_complex(value: Any) -> Any:
    """Convert the mpf numbers in a tuple of any depth to pairs, as complex numbers hi + i lo.

    Keep other entries.
    """

    def number(entry: Any) -> Any:
        if not hasattr(entry, "_mpf_"):
            return entry
        high = float(entry)
        short = entry._mpf_[3] <= 53  # the bits of its mantissa: a double has them all
        return complex(high, 0.0 if short else float(entry - high))

    return converted(value, number)


@lru_cache(maxsize=1024)
def pair_constants(parameters: Model) -> np.ndarray:
    """Return the table of the constants of a law as pairs, each stored as a complex number hi + i
    lo and rounded once, from 50 digits.
    """
    rows = range(len(rows_in_doubles(parameters)))
    return pair_table_of(
        pairs_as_complex(many_digits(parameters, ROUNDED_FROM, row).K) for row in rows
    )
