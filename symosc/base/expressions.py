"""Text such as "3*pi/2" as a number: the one parser of expressions, for parameters and for phases.

Numbers, pi, + - * / ^ and parentheses stay exact as long as the value is a + b pi with rational a
and b. Beyond that, as with sqrt, sin, cos and exp, the value is an enclosing interval.
"""

from __future__ import annotations

import ast
import re
from fractions import Fraction
from typing import Any, NamedTuple

from symosc.base.aliases import Context, Expr, Number
from symosc.base.errors import ParameterError
from symosc.base.exact import LARGEST, read_exact

#: Most characters of an expression, largest power, and most bits of the numerator and denominator
#: of an exact value.
LONGEST_EXPRESSION = 200
MOST_POWER = 100
LARGEST_BITS = 4000
#: Bits with which an interval is computed.
ENCLOSURE_BITS = 400

_LETTERS = re.compile(r"[\d.\s()+\-*/^]|pi|π|sqrt|sin|cos|exp|(?<=\d)[eE](?=[+-]?\d)", re.ASCII)
#: A number right before pi, which it multiplies, as in "2π" and "2 pi". In "1/2π" and "2^3π" it is
#: not clear what is the factor.
_FACTOR_OF_PI = re.compile(
    r"((?<![\d.^/])(?<!\*\*)(?<![/^]\s)(?:\d+\.?\d*|\.\d+)) *(?:pi|π)", re.ASCII
)


class ExactPhase(NamedTuple):
    """A phase known exactly, the number rest + multiple * pi with rational rest and multiple."""

    rest: Fraction
    multiple: Fraction = Fraction(0)

    def symbolic(self) -> Expr:
        """Return the phase as a sympy number."""
        import sympy

        rest = sympy.Rational(self.rest.numerator, self.rest.denominator)
        multiple = sympy.Rational(self.multiple.numerator, self.multiple.denominator)
        return rest + multiple * sympy.pi

    def number(self, context: Context) -> Number:
        """Return the phase as an mpf of a context."""
        rest = context.mpf(self.rest.numerator) / self.rest.denominator
        multiple = context.mpf(self.multiple.numerator) / self.multiple.denominator
        return rest + multiple * context.pi

    def scaled(self, factor: Fraction) -> ExactPhase:
        """Return the phase times a rational number."""
        return ExactPhase(self.rest * factor, self.multiple * factor)


def evaluated(name: str, text: str, forms: str) -> Any:
    """Return the value of an expression: an `ExactPhase`, or an interval of mpmath.

    A ParameterError calls it `name`, and says `forms` where the text is no expression.
    """
    source = _FACTOR_OF_PI.sub(r"\1*pi", text.strip()).replace("π", "pi").replace("^", "**")
    if len(source) > LONGEST_EXPRESSION or _LETTERS.sub("", source):
        raise ParameterError(name, text, forms)
    try:
        return _Evaluator(name, text, source, forms).value(ast.parse(source, mode="eval").body)
    except (SyntaxError, RecursionError, MemoryError):
        raise ParameterError(name, text, forms) from None
    except (ZeroDivisionError, OverflowError):
        allowed = f"the expression has no value of at most {float(LARGEST):g} in size"
        raise ParameterError(name, text, allowed) from None


def enclosed(value: Any) -> Any:
    """Return an exact value as an interval, and an interval as it is."""
    from mpmath import iv

    iv.prec = ENCLOSURE_BITS
    if isinstance(value, ExactPhase):
        return value.number(iv)
    return value


class _Evaluator(NamedTuple):
    """What computes the values of the parts of one expression."""

    name: str
    text: str
    source: str
    forms: str

    def value(self, node: ast.expr) -> Any:
        """Return the value of a part of the expression."""
        match node:
            case ast.Constant():
                return ExactPhase(read_exact(self.name, ast.get_source_segment(self.source, node)))
            case ast.Name("pi"):
                return ExactPhase(Fraction(0), Fraction(1))
            case ast.UnaryOp(ast.UAdd() | ast.USub() as sign, inside) if self._has_one_sign(node):
                operand = self.value(inside)
                if isinstance(sign, ast.UAdd):
                    return operand
                return _product(ExactPhase(Fraction(-1)), operand)
            case ast.BinOp(left, ast.Pow(), right):
                return _limited(self._power(self.value(left), self.value(right)))
            case ast.BinOp(left, operation, right):
                return _limited(self._combined(self.value(left), operation, self.value(right)))
            case ast.Call(ast.Name("sqrt" | "sin" | "cos" | "exp" as function), [inside], []):
                return _limited(self._called(function, enclosed(self.value(inside))))
        raise self._refused(self.forms)

    def _refused(self, allowed: str) -> ParameterError:
        return ParameterError(self.name, self.text, allowed)

    def _has_one_sign(self, node: ast.UnaryOp) -> bool:
        """Return whether a sign stands alone: "--2" is a slip, "-(-2)" is not."""
        inside = node.operand
        if not isinstance(inside, ast.UnaryOp):
            return True
        return "(" in self.source[node.col_offset + 1 : inside.col_offset]

    def _combined(self, first: Any, operation: ast.operator, second: Any) -> Any:
        """Return a sum, difference, product or quotient."""
        match operation:
            case ast.Add():
                return _sum(first, second)
            case ast.Sub():
                return _sum(first, _product(ExactPhase(Fraction(-1)), second))
            case ast.Mult():
                return _product(first, second)
            case ast.Div() if isinstance(second, ExactPhase) and second.multiple == 0:
                return _product(first, ExactPhase(1 / second.rest))
            case ast.Div() if second == ExactPhase(Fraction(0)):
                raise ZeroDivisionError
            case ast.Div():
                return enclosed(first) / enclosed(second)
        raise self._refused(self.forms)

    def _power(self, base: Any, power: Any) -> Any:
        """Return a power with a whole exponent."""
        exact = isinstance(power, ExactPhase) and power.multiple == 0
        if not exact or power.rest.denominator != 1 or abs(power.rest) > MOST_POWER:
            raise self._refused(f"a power must be a whole number up to {MOST_POWER} in size")
        exponent = int(power.rest)
        if isinstance(base, ExactPhase) and base.multiple == 0:
            return ExactPhase(base.rest**exponent)
        if exponent in (0, 1):
            return base if exponent else ExactPhase(Fraction(1))
        return enclosed(base) ** exponent

    def _called(self, function: str, argument: Any) -> Any:
        """Return the value of a function."""
        from mpmath import iv

        if function == "sqrt" and argument.a < 0:
            raise self._refused("the root of a negative number has no value")
        if function == "exp" and argument.b > LARGEST.numerator.bit_length():
            raise OverflowError
        return getattr(iv, function)(argument)


def _sum(first: Any, second: Any) -> Any:
    if isinstance(first, ExactPhase) and isinstance(second, ExactPhase):
        return ExactPhase(first.rest + second.rest, first.multiple + second.multiple)
    return enclosed(first) + enclosed(second)


def _product(first: Any, second: Any) -> Any:
    """Return a product, which is exact if one of its factors is rational."""
    if isinstance(second, ExactPhase) and second.multiple == 0:
        first, second = second, first
    if isinstance(first, ExactPhase) and isinstance(second, ExactPhase) and first.multiple == 0:
        return second.scaled(first.rest)
    return enclosed(first) * enclosed(second)


def _limited(value: Any) -> Any:
    """Return a value; raise OverflowError if it is too large, or too long to compute with."""
    if isinstance(value, ExactPhase):
        large = any(
            max(abs(part.numerator), part.denominator).bit_length() > LARGEST_BITS for part in value
        )
    else:
        # Not so either where it divides by an interval around 0.
        large = not (-LARGEST.numerator < value.a and value.b < LARGEST.numerator)
    if large:
        raise OverflowError
    return value
