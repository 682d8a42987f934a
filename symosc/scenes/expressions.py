"""Expressions such as "3*pi/2" in scene files, read as numbers that are known to 40 digits.

Numbers, + - * / ^ and parentheses alone are exact. With pi, sqrt, sin, cos or exp an enclosure is computed, and
rounded to 40 digits, which are right; a value whose digits cancel is refused.
"""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from typing import Any

from symosc.errors import ParameterError
from symosc.exact import LARGEST, read_exact

#: Digits to which an expression with pi is known, and bits with which it is computed.
KNOWN_DIGITS = 40
ENCLOSURE_BITS = 400
LONGEST_EXPRESSION, MOST_POWER = 200, 100
#: Bits of the numerator and denominator of an exact value.
LARGEST_BITS = 4000
FORMS = (
    "give a number such as 0.8 or '4/5', a quantity such as '3 kg', or an expression such as '3*pi/2': numbers and pi "
    "with + - * / ^ ( ), sqrt(), sin(), cos() and exp()"
)
LETTERS = re.compile(r"[\d.\s()+\-*/^]|pi|π|sqrt|sin|cos|exp|(?<=\d)[eE](?=[+-]?\d)", re.ASCII)
OPERATORS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
KNOWN_FUNCTIONS = ("sqrt", "sin", "cos", "exp")


def read_expression(name: str, text: str) -> tuple[Fraction, bool]:
    """Return the value of an expression, and whether it is exact.

    Raises
    ------
    ParameterError
        If the text is no such expression, or its value is not known to 40 digits.
    """
    source = text.strip().replace("π", "pi").replace("^", "**")
    if len(source) > LONGEST_EXPRESSION or LETTERS.sub("", source):
        raise ParameterError(name, text, FORMS)
    try:
        tree = ast.parse(source, mode="eval").body
        value = _Reader(name, text, source).value(tree)
    except (SyntaxError, RecursionError, MemoryError):
        raise ParameterError(name, text, FORMS) from None
    except (ZeroDivisionError, OverflowError):
        raise ParameterError(name, text, f"has no value of at most {float(LARGEST):g} in size") from None
    exact = isinstance(value, Fraction)
    return value if exact else rounded(_middle(name, text, value)), exact


class _Reader:
    """Goes through an expression; fractions stay fractions, the rest is enclosed."""

    def __init__(self, name: str, text: str, source: str) -> None:
        self.name, self.text, self.source = name, text, source

    def value(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Constant):
            return read_exact(self.name, ast.get_source_segment(self.source, node))
        if isinstance(node, ast.Name) and node.id == "pi":
            return _enclosures().pi
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
            inside = self.value(node.operand)
            return -inside if isinstance(node.op, ast.USub) else inside
        if isinstance(node, ast.BinOp):
            return self._combined(node)
        if isinstance(node, ast.Call) and ast.unparse(node.func) in KNOWN_FUNCTIONS and len(node.args) == 1:
            return _limited(self._of(ast.unparse(node.func), self.value(node.args[0])))
        raise ParameterError(self.name, self.text, FORMS)

    def _combined(self, node: ast.BinOp) -> Any:
        left, right = self.value(node.left), self.value(node.right)
        if isinstance(node.op, ast.Pow):
            if not (isinstance(right, Fraction) and right.denominator == 1 and abs(right) <= MOST_POWER):
                raise ParameterError(self.name, self.text, f"a power must be a whole number up to {MOST_POWER} in size")
            return _limited(left ** int(right))
        combine = OPERATORS.get(type(node.op))
        if combine is None:
            raise ParameterError(self.name, self.text, FORMS)
        if isinstance(left, Fraction) and isinstance(right, Fraction):
            return _limited(combine(left, right))
        return _limited(combine(_enclosed(left), _enclosed(right)))

    def _of(self, function: str, argument: Any) -> Any:
        enclosed = _enclosed(argument)
        if function == "sqrt" and enclosed.a < 0:
            raise ParameterError(self.name, self.text, "has no value: the root of a negative number")
        if function == "exp" and enclosed.b > LARGEST.numerator.bit_length():
            raise OverflowError
        return getattr(_enclosures(), function)(enclosed)


def _limited(value: Any) -> Any:
    """Return a value that is not so large that what is made of it takes long; OverflowError for others."""
    if isinstance(value, Fraction):
        large = max(abs(value.numerator), value.denominator).bit_length() > LARGEST_BITS
    else:
        large = not (-LARGEST.numerator < value.a and value.b < LARGEST.numerator)  # where it divides by 0 too
    if large:
        raise OverflowError
    return value


def _enclosures() -> Any:
    """Return mpmath's intervals, with their precision set."""
    from mpmath import iv

    iv.prec = ENCLOSURE_BITS
    return iv


def _enclosed(value: Any) -> Any:
    return _enclosures().mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else value


def _middle(name: str, text: str, value: Any) -> Fraction:
    """Return the middle of an enclosure, which must be narrow enough."""
    low, high = (read_exact(name, _plain(end)) for end in (value.a, value.b))
    if (high - low) * 10 ** (KNOWN_DIGITS + 5) > min(abs(low), abs(high)):
        allowed = f"is not known to {KNOWN_DIGITS} digits, as they cancel; write it as a number, 0 if it is that"
        raise ParameterError(name, text, allowed)
    return (low + high) / 2


def _plain(end: Any) -> Any:
    """Return an end of an enclosure as a number of mpmath."""
    from mpmath import mp

    return mp.make_mpf(end._mpi_[0])


def rounded(value: Fraction) -> Fraction:
    """Return a number with 40 digits."""
    context = Context(prec=KNOWN_DIGITS, rounding=ROUND_HALF_EVEN)
    return Fraction(context.divide(Decimal(value.numerator), Decimal(value.denominator)))
