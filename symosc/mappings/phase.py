"""Phases as exact numbers a + b pi with rational a and b: read from text, and signs decided without a rounded number.

The sine of such a phase is rational in two cases only. If a is not 0 it is transcendental (Lindemann: exp(i a) is, and
exp(i b pi) is algebraic). If a is 0 it is algebraic, and rational only for the multiples of pi/6 where it is 0, 1/2 or
1 in size (Niven). So level + amplitude sin is 0 in known cases only; elsewhere enough digits show its sign.
"""

from __future__ import annotations

import ast
import re
from fractions import Fraction
from typing import Any, NamedTuple, TypeGuard

from symosc.engine.arithmetic import mp_context
from symosc.errors import ParameterError
from symosc.exact import LARGEST, read_exact

# Longer texts are no angles that somebody means.
LONGEST_TEXT = 200
PHASE_FORMS = (
    "give a number, or a rational multiple of pi such as 'pi', '3*pi/2' or '-pi/4' (a rational number may be added)"
)
PHASE_NUMBER = re.compile(r"(?:\d+\.?\d*|\.\d+)", re.ASCII)
PHASE_TEXT = re.compile(r"(?:pi|[\d.\s()+\-*/])+", re.ASCII)
#: The sines that are rational, by the phase in units of pi/6.
RATIONAL_SINES = {0: Fraction(0), 1: Fraction(1, 2), 3: Fraction(1), 5: Fraction(1, 2), 6: Fraction(0)}
RATIONAL_SINES |= {7: Fraction(-1, 2), 9: Fraction(-1), 11: Fraction(-1, 2)}
SINE_DIGITS = 30


class ExactPhase(NamedTuple):
    """The number rest + multiple pi."""

    rest: Fraction
    multiple: Fraction

    def symbolic(self) -> Any:
        """Return it as a sympy number."""
        import sympy

        rest, multiple = (sympy.Rational(part.numerator, part.denominator) for part in self)
        return rest + multiple * sympy.pi

    def number(self, context: Any) -> Any:
        """Return it as an mpf of a context."""
        rest, multiple = (context.mpf(part.numerator) / part.denominator for part in self)
        return rest + multiple * context.pi


def has_pi(text: object) -> TypeGuard[str]:
    """Tell whether this is text with pi in it."""
    return isinstance(text, str) and ("pi" in text or "π" in text)


def read_text(name: str, text: str) -> ExactPhase:
    """Return the phase that a text such as "3*pi/2", "pi - 1/3" or "0.7" says.

    Raises
    ------
    ParameterError
        If it is neither a number nor a sum of a number and a rational multiple of pi.
    """
    if not has_pi(text):
        return ExactPhase(read_exact(name, text), Fraction(0))
    if len(text) > LONGEST_TEXT:
        raise ParameterError(name, f"{text[:20]}...", f"must have at most {LONGEST_TEXT} characters")
    plain = re.sub(r"(?<=[\d)])\s*pi", "*pi", text.strip().replace("π", "pi"))
    numbers = PHASE_NUMBER.findall(plain)
    if not PHASE_TEXT.fullmatch(plain) or "**" in plain or "//" in plain:
        raise ParameterError(name, text, PHASE_FORMS)
    names = iter(range(len(numbers)))
    try:
        tree = ast.parse(PHASE_NUMBER.sub(lambda _: f"n{next(names)}", plain), mode="eval").body
        phase = _value(tree, {"pi": ExactPhase(Fraction(0), Fraction(1))} | _named(numbers))
    except (SyntaxError, ValueError, ZeroDivisionError, RecursionError, MemoryError):
        raise ParameterError(name, text, PHASE_FORMS) from None
    if max(map(abs, phase)) > LARGEST:
        raise ParameterError(name, text, f"must be at most {float(LARGEST):g} in size")
    return phase


def _named(numbers: list[str]) -> dict[str, ExactPhase]:
    return {f"n{i}": ExactPhase(Fraction(number), Fraction(0)) for i, number in enumerate(numbers)}


def _value(node: ast.expr, known: dict[str, ExactPhase]) -> ExactPhase:
    """Return the value of an expression that is linear in pi; raises ValueError for another one."""
    if isinstance(node, ast.Name):
        return known[node.id] if node.id in known else _refuse()
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        return _scaled(_value(node.operand, known), Fraction(-1 if isinstance(node.op, ast.USub) else 1))
    if not isinstance(node, ast.BinOp):
        return _refuse()
    left, right = _value(node.left, known), _value(node.right, known)
    if isinstance(node.op, ast.Mult) and right.multiple != 0:
        left, right = right, left
    if isinstance(node.op, ast.Add | ast.Sub):
        right = _scaled(right, Fraction(1 if isinstance(node.op, ast.Add) else -1))
        return ExactPhase(left.rest + right.rest, left.multiple + right.multiple)
    if isinstance(node.op, ast.Mult | ast.Div) and right.multiple == 0:
        return _scaled(left, right.rest if isinstance(node.op, ast.Mult) else 1 / right.rest)
    return _refuse()


def _scaled(phase: ExactPhase, factor: Fraction) -> ExactPhase:
    return ExactPhase(phase.rest * factor, phase.multiple * factor)


def _refuse() -> ExactPhase:
    raise ValueError


def of_sympy(value: Any) -> ExactPhase | None:
    """Return a sympy number as a phase, None if it is not a + b pi with rational a and b."""
    import sympy

    multiple = value.coeff(sympy.pi)
    rest = value - multiple * sympy.pi
    if not (multiple.is_Rational and rest.is_Rational):
        return None
    return ExactPhase(Fraction(int(rest.p), int(rest.q)), Fraction(int(multiple.p), int(multiple.q)))


def rational_sine(phase: ExactPhase) -> Fraction | None:
    """Return the sine if it is rational, else None."""
    sixths = phase.multiple * 6 % 12
    return RATIONAL_SINES.get(int(sixths)) if phase.rest == 0 and sixths.denominator == 1 else None


def sine_sign(level: Fraction, amplitude: Fraction, phase: ExactPhase) -> int:
    """Return the sign of level + amplitude sin(phase), exactly."""
    sine = rational_sine(phase)
    if sine is not None or amplitude == 0:
        total = level + amplitude * (sine or 0)
        return (total > 0) - (total < 0)
    ratio, digits = level / amplitude, SINE_DIGITS
    while True:
        context = mp_context(digits + len(str(int(max(map(abs, phase))))))
        value = context.sin(phase.number(context)) + context.mpf(ratio.numerator) / ratio.denominator
        if abs(value) > context.mpf(10) ** (5 - digits):
            return 1 if (value > 0) == (amplitude > 0) else -1
        digits *= 2
