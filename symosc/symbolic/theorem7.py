"""Theorem 7 exactly: the phases at which a flow that touches a boundary grazes it (eqs. (55) to (58)).

A contact at the phase theta has F = 0 and G^(1) = -(gamma + amplitude sin theta), with gamma = (c/m) x'' + (k/m) x' and
amplitude = B0 Omega/m. From below (P2, P5) it grazes iff G^(1) < 0, from above (P3, P6) iff G^(1) > 0 (Theorem 6).
So |gamma|, |amplitude| and their signs make the cases. Signs of numbers are decided exactly, and each case's set is
written down: sympy's inequality solvers open ends wrongly on [0, 2 pi) and cannot do symbols.

Phases are points of the circle [0, 2 pi): where the paper writes [0, a) U (b, 2 pi], the point 2 pi is 0.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import NamedTuple

import sympy as sp

from symosc.aliases import Expr, NumberLike, Order
from symosc.arguments import public
from symosc.errors import ParameterError
from symosc.exact import NUMBER_FORMS, read_exact
from symosc.mappings.latex import table
from symosc.mappings.phase import has_pi, read_text
from symosc.mappings.theorem7_cases import (
    ALL_BUT_ONE,
    EMPTY,
    EVERYTHING,
    WRAPPED_ARC,
    Place,
    case_label,
    place,
    window_kind,
)
from symosc.symbolic.grazing_latex import latex

GAMMA, AMPLITUDE = sp.symbols("gamma a", real=True)
CIRCLE = sp.Interval.Ropen(0, 2 * sp.pi)
TOP, BOTTOM = sp.pi / 2, sp.pi + sp.pi / 2  # where the sine is 1 and -1

# Digits for the sign of a number that is known not to be 0; only a number nearer to 0 than this stays undecided.
MOST_SIGN_DIGITS = 2000


class Case(NamedTuple):
    """One case of Theorem 7.

    Attributes
    ----------
    label : str
        "(55.1)" is the first case of (55). Letters mark cases that the paper lacks, see `theorem7_cases.case_label`.
    condition : sympy Boolean
        When it holds, in gamma and the amplitude.
    phases : sympy Set
        The phases theta in [0, 2 pi) at which a contact grazes.

    Examples
    --------
    >>> from sympy import Symbol
    >>> from symosc import theorem7
    >>> theorem7("P3", Symbol("gamma", positive=True), 1)[0]
    Case(label='(56.1)', condition=gamma < 1, phases=Interval.open(asin(gamma) + pi, -asin(gamma) + 2*pi))
    """

    label: str
    condition: Expr
    phases: Expr

    def latex(self) -> str:
        """Return "condition: phases" as LaTeX (no dollar signs)."""
        return rf"{latex(self.condition)}:\quad \mathrm{{mod}}(\Omega t_m, 2\pi) \in {latex(self.phases)}"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


class Theorem7Cases(tuple[Case, ...]):
    """The cases of Theorem 7 for symbols: a tuple of Case that can be printed and computed with.

    Examples
    --------
    >>> from sympy import symbols
    >>> from symosc import theorem7
    >>> gamma, a = symbols("gamma a", real=True)
    >>> cases = theorem7("P2", gamma, a)
    >>> cases[0].label, len(cases)
    ('(55.1)', 16)
    >>> cases.piecewise().subs({gamma: 3, a: 5})
    Union(Interval.Ropen(0, asin(3/5) + pi), Interval.open(-asin(3/5) + 2*pi, 2*pi))
    """

    def piecewise(self) -> Expr:
        """Return the cases as one sympy Piecewise, whose values are the sets of phases."""
        return sp.Piecewise(*((case.phases, case.condition) for case in self), evaluate=False)

    def latex(self) -> str:
        """Return the cases as a table in LaTeX (an array, no dollar signs)."""
        heads = [r"\text{case}", r"\text{condition}", r"\mathrm{mod}(\Omega t_m, 2\pi) \in"]
        rows = ((_label_latex(case.label), latex(case.condition), latex(case.phases)) for case in self)
        return table(heads, rows)

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


def _label_latex(label: str) -> str:
    number, shifted, _ = label.partition(" shifted by pi")
    return rf"{number}\text{{, shifted by }}\pi" if shifted else number


@public
def theorem7(
    mapping: str, gamma: NumberLike = GAMMA, amplitude: NumberLike = AMPLITUDE, order: Order = "full"
) -> Expr | Theorem7Cases:
    """Return the phases at which a contact of `mapping` with its boundary grazes (Theorem 7, eqs. (55) to (58)).

    Parameters
    ----------
    mapping : {"P2", "P3", "P5", "P6"}
        P2: domain 1 at belt 1. P3: domain 2 at belt 1. P5: domain 2 at belt 2. P6: domain 3 at belt 2.
    gamma : number or sympy expression, optional
        (c/m) x'' + (k/m) x' at the contact, which is k v_lambda/m there. Default: the letter gamma.
    amplitude : number or sympy expression, optional
        B0 Omega/m, of any sign. Default: the letter a.
    order : {"full", "paper"}
        "paper" is the theorem as printed, which stops at G^(1). "full" goes on to the first G-function that does not
        vanish: it adds the tangency of fourth order at |gamma| = |amplitude|.

    Returns
    -------
    sympy Set, or Theorem7Cases
        For numbers (as for Parameters, or real numbers of sympy such as sqrt(2)) the exact set in [0, 2 pi). With
        symbols, which stand for real numbers, every case that is left with its condition; exactly one holds. The cases
        are a tuple of Case, with ``latex()`` for a table and ``piecewise()`` for a sympy Piecewise.

    Raises
    ------
    ParameterError
        For a map without grazing, or if a value is not a real number.

    Examples
    --------
    >>> from symosc import theorem7
    >>> theorem7("P3", 3, 5)
    Interval.open(asin(3/5) + pi, -asin(3/5) + 2*pi)
    """
    where, full = place(mapping), order == "full"
    gamma, amplitude = real("gamma", gamma), real("amplitude", amplitude)
    if gamma.free_symbols or amplitude.free_symbols:
        return _cases(where, gamma, amplitude, full)
    return window_phases(where, gamma, amplitude, full)


def window_phases(where: Place, gamma: Expr, amplitude: Expr, full: bool) -> Expr:
    """Return the set for numbers; see `theorem7`."""
    gamma_sign, amplitude_sign, excess_sign = signs(gamma, amplitude)
    kind = window_kind(where.side, gamma_sign, amplitude_sign, excess_sign, full)
    if kind in (EMPTY, EVERYTHING):
        return CIRCLE if kind == EVERYTHING else sp.S.EmptySet
    above = where.side * amplitude_sign > 0
    if kind == ALL_BUT_ONE:
        return _all_but(above)
    return _arc(sp.asin(-gamma / amplitude), kind, above)


def signs(gamma: Expr, amplitude: Expr) -> tuple[int, int, int]:
    """Return the signs of gamma, amplitude and |gamma| - |amplitude|."""
    gamma_sign, amplitude_sign = sign_of(gamma), sign_of(amplitude)
    return gamma_sign, amplitude_sign, sign_of(gamma_sign * gamma - amplitude_sign * amplitude)


def critical_phase(gamma: Expr, amplitude: Expr) -> Expr | None:
    """Return Theta_cr = asin(-gamma/amplitude), or None if it does not exist (eqs. (55) to (58))."""
    _, amplitude_sign, excess_sign = signs(gamma, amplitude)
    return None if amplitude_sign == 0 or excess_sign > 0 else sp.asin(-gamma / amplitude)


# --- the sets ---


def _arc(theta_cr: Expr, kind: int, above: bool) -> Expr:
    """Return where sin(theta) > sin(theta_cr), or < if not `above`."""
    turned, wrapped = sp.pi - theta_cr, 2 * sp.pi + theta_cr
    if kind == WRAPPED_ARC:
        return _through_zero(turned, wrapped) if above else _through_zero(theta_cr, turned)
    return _interval(theta_cr, turned) if above else _interval(turned, wrapped)


def _all_but(above: bool) -> Expr:
    """Return the circle without the point where sin(theta) = -1, or 1 if not `above`."""
    point = BOTTOM if above else TOP
    return _through_zero(point, point)


def _through_zero(first: Expr, last: Expr) -> Expr:
    """Return the arc from `last` through 0 to `first`, both excluded."""
    # Known to be disjoint, which sympy finds out slowly, and with symbols not at all.
    return sp.Union(_interval(sp.S.Zero, first, closed=True), _interval(last, 2 * sp.pi), evaluate=False)


def _interval(low: Expr, high: Expr, closed: bool = False) -> Expr:
    """Return the interval without `high`, and without `low` unless `closed`; low < high is known."""
    # What sp.Interval returns, without its comparison of the ends by many digits.
    return sp.Basic.__new__(sp.Interval, low, high, sp.false if closed else sp.true, sp.true)


# --- the cases, for symbols ---


def _cases(where: Place, gamma: Expr, amplitude: Expr, full: bool) -> Theorem7Cases:
    values = {GAMMA: gamma, AMPLITUDE: amplitude}
    found = []
    for case in all_cases(where, full):
        condition = case.condition.subs(values, simultaneous=True)
        if condition != sp.false:
            # The sets are written for the signs that the condition demands.
            phases = _substituted(case.phases, values)
            found.append(Case(case.label, condition, phases))
    return Theorem7Cases(found)


def _substituted(phases: Expr, values: dict[Expr, Expr]) -> Expr:
    if isinstance(phases, sp.Union):
        return sp.Union(*(_substituted(part, values) for part in phases.args), evaluate=False)
    return phases.subs(values, simultaneous=True)


@cache
def all_cases(where: Place, full: bool) -> tuple[Case, ...]:
    """Return every case in the real symbols gamma and a = B0 Omega/m, those with a > 0 first, in the paper's order."""
    g, a = GAMMA, AMPLITUDE
    found = [
        Case(*_case(where, g, a, amplitude_sign, gamma_sign, excess_sign, condition, full))
        for amplitude_sign in (1, -1)
        for gamma_sign, excess_sign, condition in _conditions(where, g, amplitude_sign * a)
    ]
    nothing, everything = (g <= 0, g > 0) if where.side > 0 else (g >= 0, g < 0)
    for gamma_sign, condition in ((where.side, everything), (0, nothing)):
        found.append(Case(*_case(where, g, a, 0, gamma_sign, gamma_sign, condition, full)))
    return tuple(found)


def _conditions(where: Place, g: Expr, size: Expr) -> list[tuple[int, int, Expr]]:
    """Return the signs of gamma and |gamma| - size with what says so; size = |amplitude| > 0."""
    small = [(1, -1, (g > 0) & (g < size)), (0, -1, sp.Eq(g, 0)), (-1, -1, (g < 0) & (g > -size))]
    if where.side > 0:
        return [
            small[0],
            (1, 0, sp.Eq(g, size)),
            (1, 1, g > size),
            *small[1:],
            (-1, 1, g < -size),
            (-1, 0, sp.Eq(g, -size)),
        ]
    return [small[0], (1, 0, g >= size), *small[1:], (-1, 0, sp.Eq(g, -size)), (-1, 1, g < -size)]


def _case(
    where: Place,
    g: Expr,
    a: Expr,
    amplitude_sign: int,
    gamma_sign: int,
    excess_sign: int,
    condition: Expr,
    full: bool,
) -> tuple[str, Expr, Expr]:
    label = case_label(where, gamma_sign, amplitude_sign, excess_sign)
    condition &= {1: a > 0, 0: sp.Eq(a, 0), -1: a < 0}[amplitude_sign]
    kind = window_kind(where.side, gamma_sign, amplitude_sign, excess_sign, full)
    above = where.side * amplitude_sign > 0
    if kind in (EMPTY, EVERYTHING):
        return label, condition, CIRCLE if kind == EVERYTHING else sp.S.EmptySet
    if kind == ALL_BUT_ONE:
        return label, condition, _all_but(above)
    theta_cr = sp.asin(-g / a) if gamma_sign else sp.S.Zero
    return label, condition, _arc(theta_cr, kind, above)


# --- exact numbers ---


def real(name: str, value: NumberLike) -> Expr:
    """Return `value` as a sympy expression: exact for numbers, as it is for real constants and symbols.

    Raises
    ------
    ParameterError
        If it is not a real number and cannot be one.
    """
    if isinstance(value, sp.Expr) and not value.is_Rational and not value.is_Float:
        if value.is_extended_real is False or value.is_infinite or value is sp.nan:
            raise ParameterError(name, value, "must be real and finite")
        if not value.free_symbols and not value.is_comparable:
            # A constant that is 0 is not `comparable` before it is simplified.
            value = sp.simplify(value)
            if not value.is_comparable:
                raise ParameterError(name, value, "must be a real number")
        return value
    if has_pi(value):
        return read_text(name, value).symbolic()
    try:
        return rational(read_exact(name, value))
    except ParameterError as error:
        if error.allowed.startswith(("must be", "has ")):  # a number, but too large or not finite
            raise
        raise ParameterError(name, value, f"{NUMBER_FORMS}, or a multiple of pi such as '3*pi/2'") from None


def rational(value: Fraction) -> Expr:
    """Return a Fraction as a sympy Rational."""
    return sp.Rational(value.numerator, value.denominator)


def sign_of(number: Expr) -> int:
    """Return the sign of a real constant, exactly.

    Raises
    ------
    ParameterError
        If a transcendental constant can be shown neither to be 0 nor not to be.
    """
    if number.is_Rational:
        return int(sp.sign(number))
    for digits in (30, 200):
        value = number.evalf(15, maxn=digits)
        if value.is_Float and value._prec > 1:  # precision 1 is sympy's way to say "0 or nearly so"
            return 1 if value > 0 else -1
        if _is_zero(number):
            return 0
    value = number.evalf(15, maxn=MOST_SIGN_DIGITS)
    if value.is_Float and value._prec > 1:
        return 1 if value > 0 else -1
    raise ParameterError("number", number, f"cannot be told from 0 with {MOST_SIGN_DIGITS} digits")


def _is_zero(number: Expr) -> bool:
    number = sp.expand_trig(number)
    if number.is_algebraic:
        x = sp.Dummy("x")
        return bool(sp.minimal_polynomial(number, x) == x)
    return bool(sp.simplify(number) == 0)
