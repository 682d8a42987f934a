"""Double-double numbers: a class for CPython and a type for numba, whose operators and functions
give the same bits.

This file is executed with other globals: see symosc/kernels/rebind.py.

A pair is the unevaluated sum hi + lo with |lo| at most half a unit of hi: 106 bits. The operators
are the usual ones (Joldes, Muller and Popescu, ACM TOMS 44 (2017)): those of `Pair` by
`symosc.kernels.double_double`, those of numba's type as LLVM code, where fused multiply-add gives
the error of a product that CPython computes by splitting. Their relative errors, in units of 2^-106
= 1.2e-32: sum and difference 3, product 5, quotient 10, square root 4. Without hardware for it LLVM
calls the C library's fma: slower, with the same results. The errors of the functions are the
largest that were measured against mpmath over all arguments that their docstrings name.

There is no conversion to float64 or complex128 on purpose: numba would use it to choose a function
for doubles. Sums of infinities give no number in the low part, and low parts below 1e-308 vanish:
relative errors hold above 1e-290.

Numbers are kept in arrays as complex128, hi and lo as its two parts; `from_complex` and
`to_complex` cross that border. This module needs numba.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
from numba.core import cgutils, types
from numba.core.cgutils import ir
from numba.core.imputils import lower_constant
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import (
    intrinsic,
    lower_builtin,
    lower_cast,
    make_attribute_wrapper,
    models,
    overload,
    register_jitable,
    register_model,
    typeof_impl,
)

from symosc.kernels.double_double import pair_product, pair_quotient, pair_sum
from symosc.kernels.multiprecision import mp_context

DOUBLE = ir.DoubleType()


def _compared(name: str) -> Callable[[Any, Any], bool]:
    """Return the method of `Pair` for the comparison `name`, such as "lt": by hi, and by lo where
    hi is equal.
    """
    compare = getattr(operator, name)
    return lambda number, other: compare((number.hi, number.lo), _parts_of(other))


class Pair:
    """A double-double number hi + lo, made from a Fraction, float or mpf.

    CPython computes with it.
    """

    __slots__ = ("hi", "lo")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: Any) -> None:
        self.hi = float(value)
        self.lo = float(value - (Fraction(self.hi) if isinstance(value, Fraction) else self.hi))

    def __repr__(self) -> str:
        return f"Pair({self.hi!r}, {self.lo!r})"

    def __complex__(self) -> complex:
        return complex(self.hi, self.lo)

    def __int__(self) -> int:
        size = abs(self)
        integer = math.floor(size.hi)
        if integer == size.hi:  # else hi has a fraction, and lo is too small to change the result
            integer += math.floor(size.lo)
        if self.hi < 0.0:
            return -integer
        return integer

    def __neg__(self) -> Pair:
        return pair_of(-self.hi, -self.lo)

    def __abs__(self) -> Pair:
        if (self.hi, self.lo) < (0.0, 0.0):
            return -self
        return self

    def __add__(self, other: Any) -> Pair:
        return pair_of(*pair_sum(self.hi, self.lo, *_parts_of(other)))

    def __sub__(self, other: Any) -> Pair:
        return self + -other

    def __rsub__(self, other: Any) -> Pair:
        return -self + other

    def __mul__(self, other: Any) -> Pair:
        return pair_of(*pair_product(self.hi, self.lo, *_parts_of(other)))

    def __truediv__(self, other: Any) -> Pair:
        return pair_of(*pair_quotient(self.hi, self.lo, *_parts_of(other)))

    def __rtruediv__(self, other: Any) -> Pair:
        return pair_of(*pair_quotient(*_parts_of(other), self.hi, self.lo))

    def __pow__(self, other: Any) -> Pair:
        return pair_of(self.hi ** _parts_of(other)[0], 0.0)

    __radd__ = __add__
    __rmul__ = __mul__

    __lt__, __le__, __gt__, __ge__, __eq__ = map(_compared, ("lt", "le", "gt", "ge", "eq"))


def pair_of(hi: float, lo: float) -> Pair:
    """Return the pair hi + lo of two non-overlapping floats, as `pair` does in compiled code."""
    made = Pair.__new__(Pair)
    made.hi = hi
    made.lo = lo
    return made


def _parts_of(value: Any) -> tuple[float, float]:
    """Return hi and lo of a number: a Pair, int or float."""
    if type(value) is Pair:
        return (value.hi, value.lo)
    return (float(value), 0.0)


# --- numba's type ---


class PairType(types.Type):
    """The numba type of pairs; ints and floats are converted when combined with pairs."""

    def __init__(self) -> None:
        super().__init__(name="Pair")

    def can_convert_from(self, typingctx: Any, scalar: Any) -> Any:
        """Tell numba whether a value of type `scalar` may be passed where a pair is expected (None:
        no).
        """
        if isinstance(scalar, (types.Float, types.Integer)):
            return Conversion.promote
        return None

    def unify(self, typingctx: Any, scalar: Any) -> Any:
        """Tell numba the type of a variable that is a pair in one branch and of type `scalar` in
        another.
        """
        if isinstance(scalar, (types.Float, types.Integer)):
            return self
        return None


pair_type = PairType()
typeof_impl.register(Pair)(lambda value, context: pair_type)


@register_model(PairType)
class _PairModel(models.StructModel):
    """The memory layout of a pair: two doubles."""

    def __init__(self, manager: Any, declared: Any) -> None:
        super().__init__(manager, declared, [("hi", types.float64), ("lo", types.float64)])


make_attribute_wrapper(PairType, "hi", "hi")
make_attribute_wrapper(PairType, "lo", "lo")


def _packed(context: Any, builder: Any, hi: Any, lo: Any) -> Any:
    """Return LLVM code for the pair hi + lo."""
    made = cgutils.create_struct_proxy(pair_type)(context, builder)
    made.hi = hi
    made.lo = lo
    return made._getvalue()


def _parts(builder: Any, value: Any) -> tuple[Any, Any]:
    """Return LLVM code for hi and lo of a pair."""
    return builder.extract_value(value, 0), builder.extract_value(value, 1)


@lower_constant(PairType)
def _constant(context: Any, builder: Any, declared: Any, value: Pair) -> Any:
    """Return LLVM code for a constant pair."""
    return _packed(
        context,
        builder,
        *(context.get_constant(types.float64, part) for part in (value.hi, value.lo)),
    )


@lower_cast(types.Float, PairType)
@lower_cast(types.Integer, PairType)
def _cast(context: Any, builder: Any, declared: Any, wanted: Any, value: Any) -> Any:
    """Return LLVM code that converts an int or a float to a pair."""
    hi = context.cast(builder, value, declared, types.float64)
    return _packed(context, builder, hi, context.get_constant(types.float64, 0.0))


# --- the operators, as LLVM code ---


def _fma(b: Any, x: Any, y: Any, z: Any) -> Any:
    """Return LLVM code, made by the builder `b`, for the fused multiply-add x y + z."""
    declared = b.module.declare_intrinsic(
        "llvm.fma", [DOUBLE], ir.FunctionType(DOUBLE, [DOUBLE] * 3)
    )
    return b.call(declared, [x, y, z])


def _two_sum(b: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Return LLVM code for the rounded sum of two doubles, and for its rounding error (Knuth)."""
    s = b.fadd(x, y)
    rest = b.fsub(s, x)
    return s, b.fadd(b.fsub(x, b.fsub(s, rest)), b.fsub(y, rest))


def _fast_sum(b: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Return LLVM code as `_two_sum` does, in fewer operations, for |x| >= |y| (Dekker)."""
    s = b.fadd(x, y)
    return s, b.fsub(y, b.fsub(s, x))


def _sum(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    """Return LLVM code for the sum of two pairs."""
    s, e = _two_sum(b, xh, yh)
    t, f = _two_sum(b, xl, yl)
    s, e = _fast_sum(b, s, b.fadd(e, t))
    return _fast_sum(b, s, b.fadd(e, f))


def _difference(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    """Return LLVM code for the difference of two pairs."""
    return _sum(b, xh, xl, b.fneg(yh), b.fneg(yl))


def _product(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    """Return LLVM code for the product of two pairs."""
    p = b.fmul(xh, yh)
    e = _fma(b, xh, yh, b.fneg(p))
    return _fast_sum(b, p, b.fadd(e, b.fadd(b.fmul(xh, yl), b.fmul(xl, yh))))


def _quotient(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    """Return LLVM code for the quotient of two pairs."""
    q = b.fdiv(xh, yh)
    rest = _fma(b, b.fneg(q), yh, xh)  # exact
    rest = b.fadd(rest, b.fsub(xl, b.fmul(q, yl)))
    return _fast_sum(b, q, b.fdiv(rest, yh))


def _comparison(sign: str) -> Callable[..., Any]:
    """Return a function that builds LLVM code to compare high parts and, where they are equal, low
    parts.
    """

    def code(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> Any:
        # By the high parts, strictly (the first character of "<="), or by the low parts if those are
        # equal.
        low = b.fcmp_ordered(sign, xl, yl)
        if sign == "==":
            return b.and_(b.fcmp_ordered("==", xh, yh), low)
        if sign == "!=":
            return b.or_(b.fcmp_unordered("!=", xh, yh), b.fcmp_unordered("!=", xl, yl))
        return b.or_(b.fcmp_ordered(sign[0], xh, yh), b.and_(b.fcmp_ordered("==", xh, yh), low))

    return code


def _operator(name: Callable[..., Any], result: Any, code: Callable[..., Any]) -> None:
    """Register the operator `name` on pairs with numba.

    `code` makes its LLVM code, `result` is its type.
    """

    @infer_global(name)
    class PairTyping(AbstractTemplate):
        def generic(self, arguments: Any, keywords: Any) -> Any:
            numbers = all(
                isinstance(argument, (PairType, types.Float, types.Integer))
                for argument in arguments
            )
            if numbers and pair_type in arguments:
                return signature(result, pair_type, pair_type)
            return None

    @lower_builtin(name, pair_type, pair_type)
    def lowered(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        parts = code(builder, *_parts(builder, arguments[0]), *_parts(builder, arguments[1]))
        if result is pair_type:
            return _packed(context, builder, *parts)
        return parts


for _name, _code in {
    "add": _sum,
    "sub": _difference,
    "mul": _product,
    "truediv": _quotient,
}.items():
    _operator(getattr(operator, _name), pair_type, _code)
    _operator(getattr(operator, f"i{_name}"), pair_type, _code)
for _name, _sign in {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}.items():
    _operator(getattr(operator, _name), types.boolean, _comparison(_sign))


# --- between pairs and other kinds of numbers; for mypy intrinsics are functions of what numba
# passes to them ---


def _pair(typingctx: Any, hi: Any, lo: Any) -> Any:
    """Compile the construction of a pair from two non-overlapping floats (numba intrinsic)."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        return _packed(context, builder, *arguments)

    return pair_type(types.float64, types.float64), code


#: The named tuples that rows of tables become, by the names of their entries.
ROWS: dict[tuple[str, ...], type] = {}


def _with_pairs(declared: Any) -> Any:
    """Return a numba type with its complex numbers replaced by pairs, and rows of tables by the
    named tuples of ROWS.
    """
    if isinstance(declared, types.Complex):
        return pair_type
    if isinstance(declared, types.Record):
        entries = [_with_pairs(declared.typeof(name)) for name in declared.fields]
        return types.BaseTuple.from_types(entries, ROWS[tuple(declared.fields)])
    if isinstance(declared, types.NamedTuple):
        return types.NamedTuple([_with_pairs(entry) for entry in declared], declared.instance_class)
    if isinstance(declared, types.NamedUniTuple):
        return types.NamedUniTuple(
            _with_pairs(declared.dtype), declared.count, declared.instance_class
        )
    return declared


def _from_complex(typingctx: Any, value: Any) -> Any:
    """Convert complex numbers, also in a named tuple or in a row of a table, to pairs: hi is the
    real, lo the imaginary part.
    """
    wanted = _with_pairs(value)

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        def made(kind: Any, part: Any) -> Any:
            if isinstance(kind, types.Complex):
                return _packed(context, builder, *_parts(builder, part))
            if isinstance(kind, types.Record):
                entries = list[Any]()
                for name in kind.fields:
                    read = context.get_getattr(kind, name)
                    entry = read(context, builder, kind, part, name)
                    entries.append(made(kind.typeof(name), entry))
                return context.make_tuple(builder, _with_pairs(kind), entries)
            if isinstance(kind, types.BaseTuple):
                kinds = list(iter(kind))  # type: ignore[call-overload]
                entries = [
                    made(inner, builder.extract_value(part, i)) for i, inner in enumerate(kinds)
                ]
                return context.make_tuple(builder, _with_pairs(kind), entries)
            return part

        return made(value, arguments[0])

    return wanted(value), code


@lower_cast(PairType, types.Complex)
def _as_complex(context: Any, builder: Any, declared: Any, wanted: Any, value: Any) -> Any:
    """Return LLVM code for a pair as the complex number hi + i lo.

    So compiled code stores a pair in a row of complex numbers: ``row.x = pair``.
    """
    made = context.make_complex(builder, wanted)
    hi, lo = _parts(builder, value)
    made.real = hi
    made.imag = lo
    return made._getvalue()


def _to_complex(typingctx: Any, value: Any) -> Any:
    """Convert a pair to the complex number hi + i lo."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        return context.cast(builder, arguments[0], pair_type, types.complex128)

    return types.complex128(pair_type), code


pair: Any = intrinsic(_pair)
from_complex: Any = intrinsic(_from_complex)
to_complex: Any = intrinsic(_to_complex)


def as_pair(z):
    """Return the pair stored in a complex number.

    Compiled code of pairs calls this for `float(z)`.
    """
    return from_complex(z)


# numba compares the signatures of these with those of what they return: so no annotations.


@overload(operator.neg)
def _minus(x):
    """Provide numba's negation of a pair."""
    if x is pair_type:
        return lambda x: pair(-x.hi, -x.lo)
    return None


@overload(abs)
def _absolute(x):
    """Provide numba's `abs` for a pair."""
    if x is pair_type:
        return lambda x: -x if x.hi < 0.0 or (x.hi == 0.0 and x.lo < 0.0) else x
    return None


@overload(int)
def _whole(x):
    """Provide numba's `int` for a pair: its integer part."""

    def whole(x):
        size = abs(x)
        high = math.floor(size.hi)
        integer = int(high)
        if high == size.hi:  # else hi has a fraction, and lo is too small to change the result
            integer += math.floor(size.lo)
        if x.hi < 0.0:
            return -integer
        return integer

    if isinstance(x, types.Complex):  # a whole number among those in an array
        return lambda x: int(x.real)
    if x is pair_type:
        return whole
    return None


@overload(operator.pow)
def _power(x, y):
    """Return x^y of pairs to 16 digits, sufficient for error estimates."""
    if x is pair_type and y is pair_type:
        return lambda x, y: pair(x.hi**y.hi, 0.0)
    return None


# --- square root, exponential, sine and cosine: one source for numba and, with its own `pair`,
# CPython ---

EXACT = mp_context(70)
# Angles are reduced by multiples of pi over this, a power of two.
PER_PI = 1024
QUARTER = PER_PI // 2
# exp is computed at a part of its argument, halved so often.
HALVINGS = 9
PART = 0.5**HALVINGS
# Below the first exp is 0, as low parts would no longer be exact; above the second it is infinite.
LEAST_POWER = -670.0
LARGEST_POWER = 709.0
SMALL = 0.34  # expm1 needs no reduction below this


def _three_parts(value: Any) -> tuple[Pair, Pair, Pair]:
    """Return three pairs, each a single float, whose sum approximates an mpf to a relative 2^-160."""
    first = float(value)
    second = float(value - first)
    return Pair(first), Pair(second), Pair(float(value - first - second))


# sin(j pi/1024) for a quarter of a turn, and the coefficients of Taylor's series, each rounded
# once.
_SINES = [Pair(EXACT.sin(j * EXACT.pi / PER_PI)) for j in range(QUARTER + 1)]
SINES_HIGH = np.array([sine.hi for sine in _SINES])
SINES_LOW = np.array([sine.lo for sine in _SINES])
TURN1, TURN2, TURN3 = _three_parts(EXACT.pi / PER_PI)
LOG1, LOG2, LOG3 = _three_parts(+EXACT.ln2)
PER_TURN = float(PER_PI / EXACT.pi)
PER_LOG = float(1 / EXACT.ln2)
F2, F3, F4, F5 = (Pair(Fraction(1, math.factorial(n))) for n in range(2, 6))
F6, F7, F8, F9 = (1.0 / math.factorial(n) for n in range(6, 10))


@register_jitable
def root(x):
    """Return the square root of a pair, with a relative error of at most 3 x 2^-106."""
    if not x.hi > 0.0:
        return pair(0.0 if x.hi == 0.0 else math.nan, 0.0)
    first = math.sqrt(x.hi)
    near = pair(first, 0.0)
    rest = x - near * near
    return near + pair(rest.hi / (2.0 * first), 0.0)


@register_jitable
def turned_sine(x, quarters):
    """Return the sine of an angle plus quarter turns: absolute error at most 1.8e-32 for angles up
    to 1e6.
    """
    # The angle is a multiple j of pi/1024, which the table has, and a rest of at most pi/2048, for
    # which Taylor's series takes five terms; only their first coefficients need two doubles.
    steps = math.floor(x.hi * PER_TURN + 0.5)
    # pi/1024 has three parts, so that the difference loses no digits.
    many = pair(float(steps), 0.0)
    rest = ((x - many * TURN1) - many * TURN2) - many * TURN3
    square = rest * rest
    q = square.hi
    s = rest + rest * square * (-F3 + square * (F5 + pair(q * (-F7 + q * F9), 0.0)))
    c = square * (-F2 + square * (F4 + pair(q * (-F6 + q * F8), 0.0)))  # cos - 1
    j = int(steps) + quarters * QUARTER
    i = j & (QUARTER - 1)
    sine = pair(float(SINES_HIGH[i]), float(SINES_LOW[i]))
    cosine = pair(float(SINES_HIGH[QUARTER - i]), float(SINES_LOW[QUARTER - i]))
    if j & QUARTER:  # in the second or fourth quarter: sin(a + pi/2) = cos a
        sine, cosine = cosine, -sine
    value = sine + (sine * c + cosine * s)  # sin(a + r) = sin a + sin a (cos r - 1) + cos a sin r
    if j & (2 * QUARTER):  # in the second half turn
        return -value
    return value


@register_jitable
def sine(x):
    """Return the sine of an angle in radians, with an absolute error of at most 1.8e-32 up to 1e6."""
    return turned_sine(x, 0)


@register_jitable
def cosine(x):
    """Return the cosine of an angle in radians, with an absolute error of at most 1.8e-32 up to
    1e6.
    """
    return turned_sine(x, 1)


@register_jitable
def small_expm1(x):
    """Return exp(x) - 1 for |x| up to log(2)/2: Taylor's series at x/2^9, then nine doublings of
    the argument.
    """
    m = pair(x.hi * PART, x.lo * PART)
    q = m.hi
    tail = pair(q * (F6 + q * (F7 + q * (F8 + q * F9))), 0.0)
    s = m + m * m * (F2 + m * (F3 + m * (F4 + m * (F5 + tail))))
    for _ in range(HALVINGS):
        s = pair(2.0 * s.hi, 2.0 * s.lo) + s * s
    return s


@register_jitable
def exponential(x):
    """Return exp(x): relative error at most 3e-32 from -670 to 709; 0 below, infinite above."""
    if x.hi < LEAST_POWER:
        return pair(0.0, 0.0)
    if x.hi > LARGEST_POWER:
        return pair(math.inf, 0.0)
    steps = math.floor(x.hi * PER_LOG + 0.5)
    many = pair(float(steps), 0.0)
    rest = ((x - many * LOG1) - many * LOG2) - many * LOG3
    value = pair(1.0, 0.0) + small_expm1(rest)
    return pair(math.ldexp(value.hi, int(steps)), math.ldexp(value.lo, int(steps)))


@register_jitable
def exponential_minus_1(x):
    """Return exp(x) - 1: relative error at most 8e-32."""
    if abs(x.hi) < SMALL:
        return small_expm1(x)
    return exponential(x) - pair(1.0, 0.0)


#: The functions of `math` that these are to the engine.
FUNCTIONS = {
    "sqrt": root,
    "sin": sine,
    "cos": cosine,
    "exp": exponential,
    "expm1": exponential_minus_1,
}


def _overload(name: str, function: Any) -> None:
    """Register `function` as numba's implementation of `name` for pairs."""
    overload(getattr(math, name))(lambda x: function if x is pair_type else None)


for _name, _function in FUNCTIONS.items():
    _overload(_name, _function)
