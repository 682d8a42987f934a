"""Lanes: numba types of several doubles, or flags, side by side in registers.

Each computes as a double alone does.

A number of lanes goes with floats in all operators; comparisons give flags, which go with `&`, `|`,
`^`, `~` and `select`. No operation is contracted or reordered: results have the same bits in any
lane, at any width, and on any processor, whose registers LLVM uses as they come. This module needs
numba.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from itertools import count
from typing import Any

import numba
from numba.core import cgutils, types
from numba.core.cgutils import ir
from numba.core.codegen import get_host_cpu_features
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, overload, register_model

from symosc.kernels.elementary import TO_INTEGER

BIT = ir.IntType(1)
LONG = ir.IntType(64)
DOUBLE = ir.DoubleType()
PLACE = ir.IntType(32)


class LanesType(types.Type):
    """The numba type of lanes, a SIMD register: `width` doubles or flags that are computed
    together.
    """

    def __init__(self, width: int, flags: bool = False) -> None:
        self.width = width
        self.flags = flags
        super().__init__(name=f"lanes({width}, {'flags' if flags else 'doubles'})")

    def holds(self, scalar: Any) -> bool:
        """Return whether numba's type `scalar` can be copied into all lanes of this type."""
        return isinstance(scalar, types.Boolean if self.flags else (types.Float, types.Integer))

    def can_convert_from(self, typingctx: Any, scalar: Any) -> Any:
        """Tell numba whether a value of type `scalar` may be passed where lanes are expected (None:
        no).
        """
        if self.holds(scalar):
            return Conversion.promote
        return None

    def unify(self, typingctx: Any, scalar: Any) -> Any:
        """Tell numba the type of a variable that is lanes in one branch and of type `scalar` in
        another.
        """
        if self.holds(scalar):
            return self
        return None


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    """The memory layout of lanes: a vector of LLVM."""

    def __init__(self, manager: Any, declared: Any) -> None:
        super().__init__(
            manager, declared, ir.VectorType(BIT if declared.flags else DOUBLE, declared.width)
        )


@lower_cast(types.Float, LanesType)
@lower_cast(types.Integer, LanesType)
@lower_cast(types.Boolean, LanesType)
def _spread(context: Any, builder: Any, declared: Any, wanted: Any, value: Any) -> Any:
    """Return LLVM code that copies a scalar `value` into all lanes of the type `wanted`."""
    scalar = types.boolean if wanted.flags else types.float64
    value = context.cast(builder, value, declared, scalar)
    # LLVM's idiom: the value goes into lane 0 of a vector, then all lanes are copies of lane 0.
    nothing = ir.Constant(context.get_value_type(wanted), ir.Undefined)
    only_first = builder.insert_element(nothing, value, ir.Constant(PLACE, 0))
    lane_0_for_all = ir.Constant(ir.VectorType(PLACE, wanted.width), [0] * wanted.width)
    return builder.shuffle_vector(only_first, nothing, lane_0_for_all)


def lanes_among(arguments: Any, flags: bool) -> Any:
    """Return the type of lanes (of flags if `flags`) in which an operation on `arguments` is
    computed, else None.
    """
    lanes = [argument for argument in arguments if isinstance(argument, LanesType)]
    if not lanes or lanes[0].flags is not flags:
        return None
    if all(argument == lanes[0] or lanes[0].holds(argument) for argument in arguments):
        return lanes[0]
    return None


def _operator(
    name: Callable[..., Any], of_flags: bool, to_flags: bool, code: Callable[..., Any]
) -> None:
    """Register an operator on lanes, from flags (`of_flags`) or to flags (`to_flags`).

    `code` makes its LLVM code.
    """

    @infer_global(name)
    class LaneTyping(AbstractTemplate):
        def generic(self, arguments: Any, keywords: Any) -> Any:
            lanes = lanes_among(arguments, of_flags)
            if lanes:
                return signature(LanesType(lanes.width, to_flags), *(lanes for _ in arguments))
            return None

    if name in (operator.neg, operator.invert):
        operands = 1
    else:
        operands = 2

    @lower_builtin(name, *[LanesType] * operands)
    def lowered(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        return code(builder, *arguments)


for _name in ("add", "sub", "mul", "truediv"):
    _code = getattr(ir.IRBuilder, {"truediv": "fdiv"}.get(_name, f"f{_name}"))
    _operator(getattr(operator, _name), False, False, _code)
    _operator(getattr(operator, f"i{_name}"), False, False, _code)
_operator(operator.neg, False, False, ir.IRBuilder.fneg)
for _name, _sign in {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "=="}.items():
    _operator(
        getattr(operator, _name),
        False,
        True,
        lambda b, x, y, sign=_sign: b.fcmp_ordered(sign, x, y),
    )
_operator(
    operator.ne, False, True, lambda b, x, y: b.fcmp_unordered("!=", x, y)
)  # true for a NaN, as in IEEE 754
for _name in ("and_", "or_", "xor"):
    _operator(getattr(operator, _name), True, True, getattr(ir.IRBuilder, _name))
_operator(operator.invert, True, True, ir.IRBuilder.not_)


def _llvm_intrinsic(name: str) -> Any:
    """Return a numba function of lanes that calls the LLVM intrinsic `name`, such as "sqrt"."""

    def function(typingctx: Any, x: Any) -> Any:
        def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
            (lanes,) = arguments
            kind = lanes.type
            llvm_function = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(kind, [kind]), f"llvm.{name}.v{x.width}f64"
            )
            return builder.call(llvm_function, arguments)

        return x(x), code

    return intrinsic(function)


_sqrt = _llvm_intrinsic("sqrt")
_fabs = _llvm_intrinsic("fabs")
# numba compares the signatures of these with those of what they return: so no annotations.


@overload(math.sqrt)
def _root(x):
    """Provide numba's `math.sqrt` for lanes."""
    if isinstance(x, LanesType):
        return lambda x: _sqrt(x)
    return None


@overload(abs)
def _size(x):
    """Provide numba's `abs` for lanes."""
    if isinstance(x, LanesType):
        return lambda x: _fabs(x)
    return None


@intrinsic
def _power_of_two(typingctx: Any, n: Any) -> Any:
    """Return 2^n for a whole number n: n + 1023 becomes the bits of a double's exponent."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        (number,) = arguments
        kind = number.type
        in_lanes = isinstance(kind, ir.VectorType)
        if in_lanes:
            integer = ir.VectorType(LONG, kind.count)
        else:
            integer = LONG

        def constant(of: Any, value: Any) -> Any:
            return ir.Constant(of, [value] * kind.count if in_lanes else value)

        # A double has 52 bits of mantissa, and before them the exponent plus 1023. Adding TO_INTEGER
        # puts n into the last bits; with 1023 added and shifted by 52 it is the exponent.
        bits = builder.bitcast(builder.fadd(number, constant(kind, TO_INTEGER)), integer)
        bits = builder.shl(builder.add(bits, constant(integer, 1023)), constant(integer, 52))
        return builder.bitcast(bits, kind)

    return n(n), code


@numba.njit(forceinline=True)
def power_of_two(n):
    """Return 2^n for whole numbers n as doubles, in all lanes."""
    return _power_of_two(n)  # type: ignore[call-arg]


@intrinsic
def select(typingctx: Any, condition: Any, value: Any, fallback: Any) -> Any:
    """Return `value` in lanes where a condition holds, else `fallback`; also for scalars."""
    if isinstance(condition, LanesType):
        flags = [
            kind.flags if isinstance(kind, LanesType) else isinstance(kind, types.Boolean)
            for kind in (value, fallback)
        ]
        result = LanesType(condition.width, all(flags))
    else:
        result = typingctx.unify_types(value, fallback)

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        return builder.select(*arguments)

    return result(condition, result, result), code


@intrinsic
def any_of(typingctx: Any, flags: Any) -> Any:
    """Return whether a flag is set in any lane."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        (lanes,) = arguments
        integer = ir.IntType(flags.width)  # a bit for each lane
        return builder.icmp_unsigned("!=", builder.bitcast(lanes, integer), ir.Constant(integer, 0))

    return types.boolean(flags), code


@intrinsic
def bits_of(typingctx: Any, flags: Any) -> Any:
    """Return the flags of all lanes as the bits of a whole number, lane 0 as the lowest bit."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        (lanes,) = arguments
        return builder.zext(builder.bitcast(lanes, ir.IntType(flags.width)), LONG)

    return types.int64(flags), code


def _row_address(context: Any, builder: Any, array: Any, kind: Any, value: Any, row: Any) -> Any:
    """Return LLVM code for the address of row `row` of `array` (its value `value`), read as a
    vector of type `kind`.
    """
    data = context.make_array(array)(context, builder, value=value).data
    begin = builder.mul(row, ir.Constant(LONG, kind.count))
    return builder.bitcast(builder.gep(data, [begin]), kind.as_pointer())


def _address_in(context: Any, builder: Any, table: Any, value: Any, row: Any, n: Any) -> Any:
    """Return LLVM code for the address of the n-th number in a row of a table of doubles."""
    data = context.make_array(table)(context, builder, value=value).data
    data = builder.bitcast(data, DOUBLE.as_pointer())
    begin = builder.mul(row, ir.Constant(LONG, table.dtype.size // 8))
    return builder.gep(data, [builder.add(begin, n)])


@intrinsic
def number_in(typingctx: Any, table: Any, row: Any, n: Any) -> Any:
    """Return the n-th number in a row of a table whose fields are all doubles."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        return builder.load(_address_in(context, builder, table, *arguments))

    return types.float64(table, types.int64, types.int64), code


@intrinsic
def put_number(typingctx: Any, table: Any, row: Any, n: Any, number: Any) -> Any:
    """Write the n-th number in a row of a table whose fields are all doubles."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        *address, value = arguments
        builder.store(value, _address_in(context, builder, table, *address))

    return types.void(table, types.int64, types.int64, types.float64), code


def tuple_loader(
    width: int, kind: Any, nested: dict[str, Any], alike: frozenset[str] = frozenset()
) -> Any:
    """Return the function that loads a NamedTuple of type `kind` in lanes from an array, a row for
    each number.

    The fields `nested` are tuples themselves; those of `kind` in `alike`, the same in all lanes,
    become single numbers.
    """

    def typed(of: Any, single: frozenset[str]) -> Any:
        def entry(name: str) -> Any:
            if name in nested:
                return typed(nested[name], frozenset())
            if name in single:
                return types.float64
            return LanesType(width)

        return types.BaseTuple.from_types(tuple(map(entry, of._fields)), of)

    wanted = typed(kind, alike)

    def load_tuple(typingctx: Any, array: Any) -> Any:
        def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
            rows = count()

            def made(of: Any) -> Any:
                if isinstance(of, types.BaseTuple):
                    kinds = list(iter(of))  # type: ignore[call-overload]
                    return context.make_tuple(builder, of, list(map(made, kinds)))
                of_llvm = ir.VectorType(DOUBLE, width)
                place = _row_address(
                    context, builder, array, of_llvm, arguments[0], ir.Constant(LONG, next(rows))
                )
                if of == types.float64:
                    place = builder.bitcast(place, DOUBLE.as_pointer())
                return builder.load(place, align=8)

            return made(wanted)

        return wanted(array), code

    return intrinsic(load_tuple)


@intrinsic
def store_tuple(typingctx: Any, array: Any, values: Any) -> Any:
    """Store a tuple of lanes, and the tuples in it, as rows of an array, as `tuple_loader` loads
    them.
    """

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        rows = count()

        def put(kind: Any, value: Any) -> None:
            if isinstance(kind, types.BaseTuple):
                for n, entry in enumerate(list(iter(kind))):  # type: ignore[call-overload]
                    put(entry, builder.extract_value(value, n))
                return
            row = ir.Constant(LONG, next(rows))
            place = _row_address(context, builder, array, value.type, arguments[0], row)
            builder.store(value, place, align=8)

        put(values, arguments[1])

    return types.void(array, values), code


@intrinsic
def _without_owner(typingctx: Any, arrays: Any) -> Any:
    """Return arrays, and those in tuples, as views without an owner whose references numba counts."""

    def code(context: Any, builder: Any, declared: Any, arguments: Any) -> Any:
        def without(kind: Any, value: Any) -> Any:
            if isinstance(kind, types.BaseTuple):
                kinds = list(iter(kind))  # type: ignore[call-overload]
                parts = [
                    without(part, builder.extract_value(value, n)) for n, part in enumerate(kinds)
                ]
                return context.make_tuple(builder, kind, parts)
            if not isinstance(kind, types.Array):
                return value
            view = context.make_array(kind)(context, builder, value=value)
            view.meminfo = cgutils.get_null_value(view.meminfo.type)
            view.parent = cgutils.get_null_value(view.parent.type)
            return view._getvalue()

        return without(arrays, arguments[0])

    return arrays(arrays), code


@numba.njit(forceinline=True)
def borrowed(arrays):
    """Return views of `arrays` whose references numba does not count.

    The caller must keep the arrays alive.

    Numba counts references wherever a function takes an array, by instructions that wait for
    memory. They would take a fifth of the time of an event.
    """
    return _without_owner(arrays)  # type: ignore[call-arg]


def usual_width() -> int:
    """Return the number of lanes with which this processor is fastest; 0 where lanes are of no use."""
    features = get_host_cpu_features().split(",")
    if "+avx512f" in features:
        return 16
    if "+avx2" in features:
        return 8
    return 0
