"""Double-double numbers: a class for CPython and a type for numba, whose operators give the same bits.

A pair is the unevaluated sum hi + lo with |lo| at most half a unit of hi: 106 bits. The operators are the usual ones
(Joldes, Muller and Popescu, ACM TOMS 44 (2017)): those of `Pair` by `symosc.kernels.double_double`, those of numba's
type as LLVM code, where fused multiply-add gives the error of a product that CPython computes by splitting. Their
relative errors, in units of 2^-106: sum and difference 3, product 5, quotient 10, square root 4. Without hardware for
it LLVM calls the C library's fma: slower, with the same results.

There is no conversion to float64 or complex128 on purpose: numba would use it to choose a function for doubles. Sums of
infinities give no number in the low part, and low parts below 1e-308 vanish: relative errors hold above 1e-290.

Numbers are kept in arrays as complex128, hi and lo as its two parts; `from_complex` and `to_complex` cross that border.
This module needs numba.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Any

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
    register_model,
    typeof_impl,
)

from symosc.kernels.double_double import pair_product, pair_quotient, pair_sum

DOUBLE = ir.DoubleType()


class Pair:
    """A number, and a constant in the source of compiled functions.

    Parameters
    ----------
    value : Fraction, float or mpf
        It is rounded once, to hi + lo.
    """

    __slots__ = ("hi", "lo")

    def __init__(self, value: Any) -> None:
        self.hi = float(value)
        self.lo = float(value - (Fraction(self.hi) if isinstance(value, Fraction) else self.hi))

    def __repr__(self) -> str:
        return f"Pair({self.hi!r}, {self.lo!r})"

    def __complex__(self) -> complex:
        return complex(self.hi, self.lo)

    def __int__(self) -> int:
        size = abs(self)
        high = math.floor(size.hi)
        below = high + (math.floor(size.lo) if high == size.hi else 0)
        return -below if self.hi < 0.0 else below

    def __neg__(self) -> Pair:
        return pair_of(-self.hi, -self.lo)

    def __abs__(self) -> Pair:
        return -self if self.hi < 0.0 or (self.hi == 0.0 and self.lo < 0.0) else self

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

    __radd__, __rmul__ = __add__, __mul__

    def __lt__(self, other: Any) -> bool:
        hi, lo = _parts_of(other)
        return self.hi < hi or (self.hi == hi and self.lo < lo)

    def __le__(self, other: Any) -> bool:
        hi, lo = _parts_of(other)
        return self.hi < hi or (self.hi == hi and self.lo <= lo)

    def __gt__(self, other: Any) -> bool:
        hi, lo = _parts_of(other)
        return self.hi > hi or (self.hi == hi and self.lo > lo)

    def __ge__(self, other: Any) -> bool:
        hi, lo = _parts_of(other)
        return self.hi > hi or (self.hi == hi and self.lo >= lo)

    def __eq__(self, other: Any) -> bool:
        hi, lo = _parts_of(other)
        return self.hi == hi and self.lo == lo

    __hash__ = None  # type: ignore[assignment]


def pair_of(hi: float, lo: float) -> Pair:
    """Return the pair hi + lo of two floats, which must not overlap: what `pair` does in compiled code."""
    made = Pair.__new__(Pair)
    made.hi, made.lo = hi, lo
    return made


def _parts_of(value: Any) -> tuple[float, float]:
    return (value.hi, value.lo) if type(value) is Pair else (float(value), 0.0)


class PairType(types.Type):
    """numba's type of such numbers; ints and floats become pairs where the two meet."""

    def __init__(self) -> None:
        super().__init__(name="Pair")

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:
        """Allow ints and floats where a pair is asked for."""
        return Conversion.promote if isinstance(other, (types.Float, types.Integer)) else None

    def unify(self, typingctx: Any, other: Any) -> Any:
        """Make pairs of what is a pair in one branch and an int or a float in another."""
        return self if isinstance(other, (types.Float, types.Integer)) else None


pair_type = PairType()
typeof_impl.register(Pair)(lambda value, context: pair_type)


@register_model(PairType)
class _PairModel(models.StructModel):
    def __init__(self, manager: Any, declared: Any) -> None:
        super().__init__(manager, declared, [("hi", types.float64), ("lo", types.float64)])


make_attribute_wrapper(PairType, "hi", "hi")
make_attribute_wrapper(PairType, "lo", "lo")


def _packed(context: Any, builder: Any, hi: Any, lo: Any) -> Any:
    made = cgutils.create_struct_proxy(pair_type)(context, builder)
    made.hi, made.lo = hi, lo
    return made._getvalue()


def _parts(builder: Any, value: Any) -> tuple[Any, Any]:
    return builder.extract_value(value, 0), builder.extract_value(value, 1)


@lower_constant(PairType)
def _constant(context: Any, builder: Any, declared: Any, value: Pair) -> Any:
    hi, lo = (context.get_constant(types.float64, part) for part in (value.hi, value.lo))
    return _packed(context, builder, hi, lo)


@lower_cast(types.Float, PairType)
@lower_cast(types.Integer, PairType)
def _cast(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    hi = context.cast(builder, value, given, types.float64)
    return _packed(context, builder, hi, context.get_constant(types.float64, 0.0))


# -- the operators, as LLVM code ---------------------------------------------------------------------------------------


def _fma(b: Any, x: Any, y: Any, z: Any) -> Any:
    declared = b.module.declare_intrinsic("llvm.fma", [DOUBLE], ir.FunctionType(DOUBLE, [DOUBLE] * 3))
    return b.call(declared, [x, y, z])


def _two_sum(b: Any, x: Any, y: Any) -> tuple[Any, Any]:
    s = b.fadd(x, y)
    rest = b.fsub(s, x)
    return s, b.fadd(b.fsub(x, b.fsub(s, rest)), b.fsub(y, rest))


def _fast_sum(b: Any, x: Any, y: Any) -> tuple[Any, Any]:
    s = b.fadd(x, y)
    return s, b.fsub(y, b.fsub(s, x))


def _sum(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    s, e = _two_sum(b, xh, yh)
    t, f = _two_sum(b, xl, yl)
    s, e = _fast_sum(b, s, b.fadd(e, t))
    return _fast_sum(b, s, b.fadd(e, f))


def _difference(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    return _sum(b, xh, xl, b.fneg(yh), b.fneg(yl))


def _product(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    p = b.fmul(xh, yh)
    e = _fma(b, xh, yh, b.fneg(p))
    return _fast_sum(b, p, b.fadd(e, b.fadd(b.fmul(xh, yl), b.fmul(xl, yh))))


def _quotient(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> tuple[Any, Any]:
    q = b.fdiv(xh, yh)
    rest = _fma(b, b.fneg(q), yh, xh)  # exact
    rest = b.fadd(rest, b.fsub(xl, b.fmul(q, yl)))
    return _fast_sum(b, q, b.fdiv(rest, yh))


def _operator(name: Callable[..., Any], result: Any, code: Callable[..., Any]) -> None:
    """Give an operator a meaning for two pairs, and for a pair and an int or float."""

    @infer_global(name)
    class Typing(AbstractTemplate):
        def generic(self, arguments: Any, keywords: Any) -> Any:
            numbers = all(isinstance(each, (PairType, types.Float, types.Integer)) for each in arguments)
            return signature(result, pair_type, pair_type) if numbers and pair_type in arguments else None

    @lower_builtin(name, pair_type, pair_type)
    def lowered(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        found = code(builder, *_parts(builder, arguments[0]), *_parts(builder, arguments[1]))
        return _packed(context, builder, *found) if result is pair_type else found


def _comparison(sign: str) -> Callable[..., Any]:
    """Return code that compares the high parts and, where they are equal, the low ones."""

    def code(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> Any:
        strict = sign[0] if sign in ("<=", ">=") else sign
        low = b.fcmp_ordered(sign, xl, yl)
        if sign == "==":
            return b.and_(b.fcmp_ordered("==", xh, yh), low)
        if sign == "!=":
            return b.or_(b.fcmp_unordered("!=", xh, yh), b.fcmp_unordered("!=", xl, yl))
        return b.or_(b.fcmp_ordered(strict, xh, yh), b.and_(b.fcmp_ordered("==", xh, yh), low))

    return code


for _name, _code in (
    (operator.add, _sum),
    (operator.sub, _difference),
    (operator.mul, _product),
    (operator.truediv, _quotient),
    (operator.iadd, _sum),
    (operator.isub, _difference),
    (operator.imul, _product),
    (operator.itruediv, _quotient),
):
    _operator(_name, pair_type, _code)
for _name, _sign in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.eq, "=="),
    (operator.ne, "!="),
):
    _operator(_name, types.boolean, _comparison(_sign))


@infer_global(operator.neg)
class _MinusTyping(AbstractTemplate):
    def generic(self, arguments: Any, keywords: Any) -> Any:
        return signature(pair_type, pair_type) if arguments == (pair_type,) else None


@lower_builtin(operator.neg, pair_type)
def _minus(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
    return _packed(context, builder, *(builder.fneg(part) for part in _parts(builder, arguments[0])))


# -- between pairs and other kinds of numbers --------------------------------------------------------------------------


def _pair(typingctx: Any, hi: Any, lo: Any) -> Any:
    """Return the pair hi + lo of two floats, which must not overlap."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        return _packed(context, builder, *arguments)

    return pair_type(types.float64, types.float64), code


def _with_pairs(declared: Any) -> Any:
    """Return a type with pairs for the complex numbers in it."""
    if isinstance(declared, types.Complex):
        return pair_type
    if isinstance(declared, types.NamedTuple):
        return types.NamedTuple([_with_pairs(entry) for entry in declared], declared.instance_class)
    if isinstance(declared, types.NamedUniTuple):
        return types.NamedUniTuple(_with_pairs(declared.dtype), declared.count, declared.instance_class)
    return declared


def _from_complex(typingctx: Any, value: Any) -> Any:
    """Return complex numbers, also those in a named tuple, as pairs: real part and imaginary part are hi and lo."""
    wanted = _with_pairs(value)

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        def made(kind: Any, given: Any) -> Any:
            if isinstance(kind, types.Complex):
                return _packed(context, builder, *_parts(builder, given))
            if isinstance(kind, types.BaseTuple):
                kinds = list(iter(kind))  # type: ignore[call-overload]
                entries = [made(each, builder.extract_value(given, i)) for i, each in enumerate(kinds)]
                return context.make_tuple(builder, _with_pairs(kind), entries)
            return given

        return made(value, arguments[0])

    return wanted(value), code


def _to_complex(typingctx: Any, value: Any) -> Any:
    """Return a pair as the complex number hi + i lo."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        made = context.make_complex(builder, types.complex128)
        made.real, made.imag = _parts(builder, arguments[0])
        return made._getvalue()

    return types.complex128(pair_type), code


# For mypy these are functions of what numba passes to them.
pair: Any = intrinsic(_pair)
from_complex: Any = intrinsic(_from_complex)
to_complex: Any = intrinsic(_to_complex)


# numba compares the signatures of these with those of what they return: so no annotations.


@overload(abs)
def _absolute(x):
    return (lambda x: -x if x.hi < 0.0 or (x.hi == 0.0 and x.lo < 0.0) else x) if x is pair_type else None


@overload(int)
def _whole(x):
    def whole(x):
        size = abs(x)
        high = math.floor(size.hi)
        below = int(high) + (math.floor(size.lo) if high == size.hi else 0)
        return -below if x.hi < 0.0 else below

    if isinstance(x, types.Complex):  # a whole number among those in an array
        return lambda x: int(x.real)
    return whole if x is pair_type else None


@overload(operator.setitem)
def _stored(array, index, value):
    if isinstance(array, types.Array) and array.dtype is types.complex128 and value is pair_type:

        def stored(array, index, value):
            array[index] = to_complex(value)

        return stored
    return None
