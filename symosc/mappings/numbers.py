"""Switching points and exact phases of maps and grazing: read, compared and written as LaTeX.

An exact phase is a Fraction, a real constant of sympy, or an `ExactPhase` a + b pi with rational a
and b. The sine of an `ExactPhase` is rational in two cases only. If a is not 0 it is transcendental
(Lindemann: exp(i a) is, and exp(i b pi) is algebraic). If a is 0 it is algebraic, and rational only
for the multiples of pi/6 where it is 0, 1/2 or 1 in size (Niven). So level + amplitude sin is 0 in
known cases only; elsewhere enough digits show its sign.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from symosc.base.aliases import Angle, Context, Expr, Number
from symosc.base.errors import ParameterError, brief
from symosc.base.exact import LARGEST, NUMBER_FORMS, read_exact, scalar_of, unmasked
from symosc.engine.arithmetic import mp_context

# --- switching points ---

POINT_NAMES = ("x_i", "theta_i", "x_j", "theta_j")
REAL_NUMBER = "must be a finite real number: a float, an int or an mpmath number"


def is_array(value: Any) -> bool:
    """Return whether a value is an array or a sequence of numbers."""
    try:
        return np.ndim(value) > 0
    except (ValueError, RuntimeError):  # lists of different lengths, or nested deeply
        return True


def scalar(name: str, value: Any, convert: Callable[[Any], Number]) -> Number:
    """Convert a number by `convert`, and check that it is a finite real number."""
    value = scalar_of(name, value)
    if isinstance(value, bool | np.bool_ | str | bytes | complex | None) or is_array(value):
        raise ParameterError(name, value, REAL_NUMBER)
    try:
        number = convert(value)
        finite = not hasattr(number, "_mpc_") and abs(number) < math.inf
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(name, value, REAL_NUMBER) from None
    if not finite:
        raise ParameterError(
            name, value, REAL_NUMBER if hasattr(number, "_mpc_") else "must be finite"
        )
    if abs(number) > float(LARGEST):  # squares of it must not overflow
        raise ParameterError(name, value, f"must be at most {float(LARGEST):g} in size")
    return number


def point_columns(given: list[object]) -> list[np.ndarray]:
    """Return x_i, theta_i, x_j, theta_j as four arrays, broadcast to one shape."""
    allowed = "must be an array of real numbers (arrays and mpmath numbers do not mix)"
    columns = [
        real_array(name, value, allowed) for name, value in zip(POINT_NAMES, given, strict=True)
    ]
    try:
        return [np.array(column) for column in np.broadcast_arrays(*columns)]
    except (ValueError, RuntimeError):  # RuntimeError: more dimensions than numpy broadcasts
        shapes = tuple(column.shape for column in columns)
        raise ParameterError(
            "points", shapes, "must be arrays whose shapes fit together (broadcast)"
        ) from None


def real_array(name: str, value: object, allowed: str) -> np.ndarray:
    """Return finite real numbers as an array of floats; for others raise ParameterError with the
    text `allowed`.
    """
    unmasked(name, value)
    try:
        array = np.asarray(value)
        plain = array is value and array.dtype.kind != "O"
        if plain:
            entries = []
        else:
            entries = np.asarray(value, dtype=object).ravel().tolist()
        if array.dtype.kind not in "iufO" or any(
            isinstance(each, bool | np.bool_ | str | bytes) for each in entries
        ):
            raise TypeError  # numpy and float() would read text and booleans as numbers
        array = array.astype(float)
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(name, value, allowed) from None
    if not np.isfinite(array).all():
        raise ParameterError(name, array[~np.isfinite(array)].flat[0], "must be finite everywhere")
    return array


# --- phases a + b pi ---

PHASE_FORMS = (
    "give a number, or a rational multiple of pi such as 'pi', '3*pi/2' or '-pi/4' "
    "(a rational number may be added)"
)
PHASE_NUMBER = re.compile(r"(?:\d+\.?\d*|\.\d+)", re.ASCII)
PHASE_TEXT = re.compile(r"(?:pi|[\d.\s()+\-*/])+", re.ASCII)
#: The sines that are rational, by the phase in units of pi/6.
RATIONAL_SINES = {
    0: Fraction(0),
    1: Fraction(1, 2),
    3: Fraction(1),
    5: Fraction(1, 2),
    6: Fraction(0),
}
RATIONAL_SINES |= {7: Fraction(-1, 2), 9: Fraction(-1), 11: Fraction(-1, 2)}


class ExactPhase(NamedTuple):
    """A phase known exactly, the number rest + multiple * pi with rational rest and multiple."""

    rest: Fraction
    multiple: Fraction = Fraction(0)

    def symbolic(self) -> Expr:
        """Return the phase as a sympy number."""
        import sympy

        return symbolic(self.rest) + symbolic(self.multiple) * sympy.pi

    def number(self, context: Context) -> Number:
        """Return the phase as an mpf of a context."""
        return number_of(self.rest, context) + number_of(self.multiple, context) * context.pi

    def scaled(self, factor: Fraction) -> ExactPhase:
        """Return the phase times a rational number."""
        return ExactPhase(self.rest * factor, self.multiple * factor)


def has_pi(text: object) -> TypeGuard[str]:
    """Return whether a value is text that contains pi."""
    return isinstance(text, str) and ("pi" in text or "π" in text)


def read_phase_text(name: str, text: str) -> ExactPhase:
    """Read a phase from a text such as "3*pi/2", "pi - 1/3" or "0.7"."""
    if not has_pi(text):
        try:
            return ExactPhase(read_exact(name, text))
        except ParameterError as error:
            allowed = f"{NUMBER_FORMS}, or a multiple of pi such as '3*pi/2'"
            raise ParameterError(
                name, text, allowed if error.allowed == NUMBER_FORMS else error.allowed
            ) from None
    if len(text) > 200:  # no angle that somebody means
        raise ParameterError(name, f"{text[:20]}...", "must have at most 200 characters")
    plain = re.sub(r"(?<=[\d)])\s*pi", "*pi", text.strip().replace("π", "pi"))
    if not PHASE_TEXT.fullmatch(plain) or "**" in plain or "//" in plain:
        raise ParameterError(name, text, PHASE_FORMS)
    # Decimals are kept as text, which is exact, under the names n0, n1, ...
    known = {
        f"n{i}": ExactPhase(Fraction(number))
        for i, number in enumerate(PHASE_NUMBER.findall(plain))
    }
    names = iter(known)
    try:
        tree = ast.parse(PHASE_NUMBER.sub(lambda _: next(names), plain), mode="eval").body
        phase = _value(tree, known | {"pi": ExactPhase(Fraction(0), Fraction(1))})
    except (SyntaxError, KeyError, ValueError, ZeroDivisionError, RecursionError, MemoryError):
        raise ParameterError(name, text, PHASE_FORMS) from None
    if max(map(abs, phase)) > LARGEST:
        raise ParameterError(name, text, f"must be at most {float(LARGEST):g} in size")
    return phase


def _value(node: ast.expr, known: dict[str, ExactPhase]) -> ExactPhase:
    """Return the value of an expression linear in the names of `known` (pi).

    Raise ValueError for any other.
    """
    match node:
        case ast.Name(name):
            return known[name]
        case ast.UnaryOp(ast.USub() | ast.UAdd() as sign, operand):
            return _value(operand, known).scaled(Fraction(-1 if isinstance(sign, ast.USub) else 1))
        case ast.BinOp(first, operator, second):
            left = _value(first, known)
            right = _value(second, known)
            if isinstance(operator, ast.Add | ast.Sub):
                right = right.scaled(Fraction(1 if isinstance(operator, ast.Add) else -1))
                return ExactPhase(left.rest + right.rest, left.multiple + right.multiple)
            if isinstance(operator, ast.Mult) and right.multiple != 0:
                left, right = right, left
            if isinstance(operator, ast.Mult | ast.Div) and right.multiple == 0:
                return left.scaled(right.rest if isinstance(operator, ast.Mult) else 1 / right.rest)
    raise ValueError


def of_sympy(value: Expr) -> ExactPhase | None:
    """Return a sympy number as a phase, or None if it is not a + b pi with rational a and b."""
    import sympy

    multiple = value.coeff(sympy.pi)
    rest = value - multiple * sympy.pi
    if not (multiple.is_Rational and rest.is_Rational):
        return None
    return ExactPhase(
        Fraction(int(rest.p), int(rest.q)), Fraction(int(multiple.p), int(multiple.q))
    )


def sine_sign(level: Fraction, amplitude: Fraction, phase: ExactPhase) -> int:
    """Return the sign of level + amplitude sin(phase), exactly."""
    sixths = phase.multiple * 6 % 12
    if phase.rest == 0 and sixths.denominator == 1:
        sine = RATIONAL_SINES.get(int(sixths))
    else:
        sine = None
    if sine is not None or amplitude == 0:
        total = level + amplitude * (sine or 0)
        return (total > 0) - (total < 0)
    digits = 30
    while True:
        context = mp_context(digits + len(str(int(max(map(abs, phase))))))
        value = context.sin(phase.number(context)) + number_of(level / amplitude, context)
        if abs(value) > context.mpf(10) ** (5 - digits):
            if (value > 0) == (amplitude > 0):
                return 1
            return -1
        digits *= 2


# --- phases and times: fractions, or real constants of sympy such as 3 pi/2 ---


def read_phase(name: str, value: object) -> Angle:
    """Read a phase like `read_angle`, but take a float as its exact binary value, not as the
    decimal it prints as.
    """
    if isinstance(value, float | np.floating) and math.isfinite(value):
        value = Fraction(float(value))
    return read_angle(name, value)


def read_angle(name: str, value: Any) -> Angle:
    """Read a number, a text such as "3*pi/2" or a sympy expression as a Fraction or a sympy
    constant.

    A float is read as the decimal that it prints as.
    """
    forms = f"{NUMBER_FORMS}, or a real constant such as sympy.pi or '3*pi/2'"
    if has_pi(value):
        return read_phase_text(name, value).symbolic()
    if (
        getattr(value, "is_Float", None) is False and not value.is_Rational
    ):  # of sympy, and no plain number
        plain = hasattr(value, "is_real") and not value.free_symbols and value.is_number
        if not (plain and value.is_real is not False and value.evalf().is_Float):
            raise ParameterError(name, value, forms)
        return value
    try:
        return read_exact(name, value)
    except ParameterError as error:
        raise ParameterError(
            name, value, error.allowed if "finite" in error.allowed else forms
        ) from None


def number_of(value: Angle, context: Context) -> Number:
    """Return a Fraction or a sympy constant as an mpf of a context."""
    if isinstance(value, Fraction):
        return context.mpf(value.numerator) / value.denominator
    return context.mpf(str(value.evalf(context.dps + 5)))


def reduced(angle: Angle) -> Angle:
    """Return an exact angle modulo 2 pi, in [0, 2 pi), again exact."""
    if isinstance(angle, Fraction) and 0 <= angle < 6:
        return angle
    import sympy

    angle = symbolic(angle)
    return angle - 2 * sympy.pi * sympy.floor(angle / (2 * sympy.pi))


def symbolic(value: Angle) -> Expr:
    """Return a Fraction as a sympy number, and other values unchanged."""
    import sympy

    if isinstance(value, Fraction):
        return sympy.Rational(value.numerator, value.denominator)
    return value


def times(value: Angle, factor: Fraction) -> Angle:
    """Return an exact angle, a Fraction or a sympy constant, times a rational number."""
    if isinstance(value, Fraction):
        return value * factor
    return value * symbolic(factor)


# --- LaTeX ---


def latex_number(value: Any) -> str:
    """Return a number as LaTeX: a decimal, with a power of ten where it is very large or small."""
    # Digits of a float in print; an mpmath number has those that its digits= asked for.
    if isinstance(value, float):
        text = f"{value:.10g}"
    else:
        text = str(value)
    mantissa, _, exponent = text.partition("e")
    if exponent:
        return rf"{mantissa} \cdot 10^{{{int(exponent)}}}"
    return mantissa


def latex_point(letter: str, theta: Any, x: Any) -> str:
    """Return the equation (Omega t, x)_letter = (theta, x) as LaTeX."""
    return rf"(\Omega t_{letter}, x_{letter}) = ({latex_number(theta)}, {latex_number(x)})"


#: What of a text LaTeX reads as something else than the letter that it is: commands, and signs
#: that it joins.
_NO_PLAIN_LETTER = re.compile(r"[^A-Za-z0-9 .,:;!?()\[\]/+*=@\-À-ÖØ-öø-ÿ]|-(?=-)|,(?=,)")


def latex_text(text: str) -> str:
    r"""Return a text of a user's, such as the name of a scene, for LaTeX to set letter by letter.

    It is set in ``\texttt``. The document needs a command ``\letter``: what has no place in fonts
    of LaTeX is printed by its number.
    """

    def plain(sign: re.Match[str]) -> str:
        number = ord(sign[0])
        if number < 128:
            return rf"\symbol{{{number}}}"
        escape = sign[0].encode("ascii", "backslashreplace").decode("ascii")[1:]
        return rf"\letter{{{number}}}{{{escape}}}"

    return _NO_PLAIN_LETTER.sub(plain, brief(text).replace("…", "..."))


def latex_words(text: str | None) -> str:
    """Return a text of symosc's own for a LaTeX formula, with special characters escaped."""
    return r"\text{" + re.sub(r"([_%&#${}])", r"\\\1", text or "").replace("^", r"\^{}") + "}"


def latex_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a LaTeX array with a line below its column heads."""
    lines = [" & ".join(heads) + r" \\ \hline", *(" & ".join(row) + r" \\" for row in rows)]
    return "\n".join([rf"\begin{{array}}{{{'l' * len(heads)}}}", *lines, r"\end{array}"])


class LatexAnswer:
    """Base class of results that notebooks show as a formula.

    Each class writes its own in the method `latex`.
    """

    __slots__ = ()

    def latex(self) -> str:
        """Return the result as LaTeX (no dollar signs)."""
        raise NotImplementedError

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"
