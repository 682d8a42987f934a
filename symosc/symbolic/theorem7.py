"""Theorem 7 exactly: the phases at which a flow that touches a boundary grazes it (eqs. (55) to
(58)).

A contact at the phase theta has F = 0 and G^(1) = -(gamma + amplitude sin theta), with gamma =
(c/m) x'' + (k/m) x' and amplitude = B0 Omega/m. From below (P2, P5) it grazes iff G^(1) < 0, from
above (P3, P6) iff G^(1) > 0 (Theorem 6). So |gamma|, |amplitude| and their signs make the cases.
Signs of numbers are decided exactly, and each case's set is written down: sympy's inequality
solvers open ends wrongly on [0, 2 pi) and cannot do symbols.

Phases are points of the circle [0, 2 pi): where the paper writes [0, a) U (b, 2 pi], the point 2 pi
is 0.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import NamedTuple

import sympy as sp

from symosc.base.aliases import Expr, NumberLike, Order
from symosc.base.arguments import NUMBER, ORDER, TEXT, public, require
from symosc.base.display.latex import LatexAnswer, latex_table
from symosc.base.errors import ParameterError
from symosc.base.phases import read_angle, symbolic
from symosc.kernels import theorem7_cases as cases
from symosc.symbolic.latex import latex

GAMMA, AMPLITUDE = sp.symbols("gamma a", real=True)
CIRCLE = sp.Interval.Ropen(0, 2 * sp.pi)
# where the sine is 1 and -1
TOP = sp.pi / 2
BOTTOM = sp.pi + sp.pi / 2

# Digits in which the sign of a number is looked for, one after another. Algebra decides after the
# first whether it is 0; only a number nearer to 0 than the last shows stays undecided.
FEW_SIGN_DIGITS = 30
MORE_SIGN_DIGITS = 200
MOST_SIGN_DIGITS = 2000


class Case(NamedTuple):
    """One case of Theorem 7: a condition and its phases.

    Attributes
    ----------
    label : str
        "(55.1)" is the first case of (55). Letters mark cases that the paper lacks, see
        `theorem7_cases.case_label`.
    condition : sympy Boolean
        The condition for this case on gamma = k v_lambda/m and the amplitude B0 Omega/m.
    phases : sympy Set
        The phases theta in [0, 2 pi) at which a contact grazes.

    Examples
    --------
    >>> from sympy import Symbol
    >>> from symosc import theorem7
    >>> case = theorem7("P3", Symbol("gamma", positive=True), 1)[0]
    >>> case.label, case.condition
    ('(56.1)', gamma < 1)
    >>> case.phases
    Interval.open(asin(gamma) + pi, -asin(gamma) + 2*pi)
    """

    label: str
    condition: Expr
    phases: Expr

    def latex(self) -> str:
        """Return "condition: phases" as LaTeX (no dollar signs)."""
        return (
            rf"{latex(self.condition)}:\quad \mathrm{{mod}}(\Omega t_m, 2\pi) \in "
            rf"{latex(self.phases)}"
        )

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


class Theorem7Cases(tuple[Case, ...], LatexAnswer):
    """The cases of Theorem 7 for symbols: a tuple of Case with formatted output.

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
        rows = [(case.label, latex(case.condition), latex(case.phases)) for case in self]
        return latex_table(heads, rows).replace(" shifted by pi", r"\text{, shifted by }\pi")


@public
def theorem7(
    mapping: str,
    gamma: NumberLike = GAMMA,
    amplitude: NumberLike = AMPLITUDE,
    order: Order = "full",
) -> Expr | Theorem7Cases:
    """Return the phases at which a contact of `mapping` with its boundary grazes, by Theorem 7.

    They are given by equations (55) to (58) of the paper.

    Parameters
    ----------
    mapping : {"P2", "P3", "P5", "P6"}
        P2: domain 1 at belt 1. P3: domain 2 at belt 1. P5: domain 2 at belt 2. P6: domain 3 at belt
        2.
    gamma : number or sympy expression, optional
        (c/m) x'' + (k/m) x' at the contact, which is k v_lambda/m there. Default: the letter gamma.
    amplitude : number or sympy expression, optional
        B0 Omega/m, of any sign. Default: the letter a.
    order : {"full", "paper"}
        "paper" is the theorem as printed, which stops at G^(1). "full" goes on to the first
        G-function that does not vanish: it adds the tangency of fourth order at |gamma| =
        |amplitude|.

    Returns
    -------
    sympy Set, or Theorem7Cases
        For numbers (as for Parameters, or real numbers of sympy such as sqrt(2)) the exact set in
        [0, 2 pi). With symbols, which stand for real numbers, every case that is left with its
        condition; exactly one holds. The cases are a tuple of Case, with ``latex()`` for a table
        and ``piecewise()`` for a sympy Piecewise.

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
    require(TEXT, mapping=mapping)
    require(NUMBER, gamma=gamma, amplitude=amplitude)
    require(ORDER, order=order)
    grazing_place = cases.place(mapping)
    full = order == "full"
    gamma = real("gamma", gamma)
    amplitude = real("amplitude", amplitude)
    if not gamma.free_symbols and not amplitude.free_symbols:
        return window_phases(grazing_place, gamma, amplitude, full)

    def substituted(expr: Expr) -> Expr:
        """Return a condition or a set of a case for the given gamma and amplitude."""
        # Unions as `_through_zero` makes them: not evaluated, as sympy finds out slowly or not at
        # all that the parts are disjoint.
        if isinstance(expr, sp.Union):
            return sp.Union(*map(substituted, expr.args), evaluate=False)
        return expr.subs({GAMMA: gamma, AMPLITUDE: amplitude}, simultaneous=True)

    # A set is written for the signs that its condition demands. So cases with a false condition are
    # dropped before anything is substituted into their sets.
    conditioned = ((case, substituted(case.condition)) for case in all_cases(grazing_place, full))
    left = ((case, condition) for case, condition in conditioned if condition != sp.false)
    return Theorem7Cases(
        Case(case.label, condition, substituted(case.phases)) for case, condition in left
    )


def signs(gamma: Expr, amplitude: Expr) -> tuple[int, int, int]:
    """Return the signs of gamma, amplitude and |gamma| - |amplitude|."""
    gamma_sign = sign_of(gamma)
    amplitude_sign = sign_of(amplitude)
    return gamma_sign, amplitude_sign, sign_of(gamma_sign * gamma - amplitude_sign * amplitude)


def critical_phase(gamma: Expr, amplitude: Expr) -> Expr | None:
    """Return Theta_cr = asin(-gamma/amplitude), or None if it does not exist (eqs. (55) to (58))."""
    _, amplitude_sign, excess_sign = signs(gamma, amplitude)
    if amplitude_sign == 0 or excess_sign > 0:
        return None
    return sp.asin(-gamma / amplitude)


# --- the sets ---


def window_phases(
    grazing_place: cases.Place,
    gamma: Expr,
    amplitude: Expr,
    full: bool,
    known_signs: tuple[int, int, int] | None = None,
) -> Expr:
    """Return the set of phases at which a contact with the boundary of `grazing_place` grazes (Theorem 7).

    The signs of gamma and amplitude must be decidable, or given by `known_signs` (as `signs` returns
    them). `full` is the order "full" of `theorem7`, else it is "paper".
    """
    gamma_sign, amplitude_sign, excess_sign = known_signs or signs(gamma, amplitude)
    kind = cases.window_kind(grazing_place.side, gamma_sign, amplitude_sign, excess_sign, full)
    if kind == cases.EVERYTHING:
        return CIRCLE
    if kind == cases.EMPTY:
        return sp.S.EmptySet
    # It grazes where sin(theta) is above sin(theta_cr), or else where it is below.
    above = grazing_place.side * amplitude_sign > 0
    if kind == cases.ALL_BUT_ONE:
        if above:
            point = BOTTOM
        else:
            point = TOP
        return _through_zero(point, point)
    if gamma_sign:
        theta_cr = sp.asin(-gamma / amplitude)
    else:
        theta_cr = sp.S.Zero
    turned = sp.pi - theta_cr
    wrapped = 2 * sp.pi + theta_cr
    if kind == cases.WRAPPED_ARC:
        if above:
            return _through_zero(turned, wrapped)
        return _through_zero(theta_cr, turned)
    if above:
        return _interval(theta_cr, turned)
    return _interval(turned, wrapped)


def _through_zero(first: Expr, last: Expr) -> Expr:
    """Return the open arc of phases through 0 as a union: from 0 up to `first`, and from `last` up
    to 2 pi.
    """
    # The two are disjoint, which sympy finds out slowly, and with symbols not at all: hence no
    # evaluation.
    return sp.Union(
        _interval(sp.S.Zero, first, closed=True), _interval(last, 2 * sp.pi), evaluate=False
    )


def _interval(low: Expr, high: Expr, closed: bool = False) -> Expr:
    """Return the interval from `low` (excluded unless `closed`) to `high` (excluded).

    Low < high must be known.
    """
    # What sp.Interval returns, without its comparison of the ends by many digits.
    return sp.Basic.__new__(sp.Interval, low, high, sp.false if closed else sp.true, sp.true)


# --- the cases, for symbols ---


@cache
def all_cases(grazing_place: cases.Place, full: bool) -> tuple[Case, ...]:
    """Return the cases of Theorem 7 for a boundary, those with a = B0 Omega/m > 0 first.

    `full`: to all orders.
    """
    g = GAMMA
    a = AMPLITUDE
    rows_of_signs = []
    for amplitude_sign, amplitude_condition in ((1, a > 0), (-1, a < 0)):
        size = amplitude_sign * a
        # Each row: the signs of gamma and of |gamma| - |a|, and the condition for them, in the
        # order of (55).
        rows = [
            ((1, -1), (g > 0) & (g < size)),
            ((1, 0), sp.Eq(g, size)),
            ((1, 1), g > size),
            ((0, -1), sp.Eq(g, 0)),
            ((-1, -1), (g < 0) & (g > -size)),
            ((-1, 1), g < -size),
            ((-1, 0), sp.Eq(g, -size)),
        ]
        # In (56) the second and third are one, and the last two change places.
        if grazing_place.side < 0:
            first, _, _, zero, inside, outside, equal = rows
            rows = [first, ((1, 0), g >= size), zero, inside, equal, outside]
        rows_of_signs += [
            ((gamma_sign, amplitude_sign, excess), condition & amplitude_condition)
            for (gamma_sign, excess), condition in rows
        ]
    # Without a drive it grazes at all phases or at none, by the sign of gamma.
    if grazing_place.side > 0:
        nothing = g <= 0
        everything = g > 0
    else:
        nothing = g >= 0
        everything = g < 0
    for gamma_sign, condition in ((grazing_place.side, everything), (0, nothing)):
        rows_of_signs.append(((gamma_sign, 0, gamma_sign), condition & sp.Eq(a, 0)))
    return tuple(
        Case(
            cases.case_label(grazing_place, *known_signs),
            condition,
            window_phases(grazing_place, g, a, full, known_signs),
        )
        for known_signs, condition in rows_of_signs
    )


# --- exact numbers ---


def real(name: str, value: NumberLike) -> Expr:
    """Return `value` as an exact sympy expression, symbols unchanged.

    A ParameterError calls it `name`.
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
    return symbolic(read_angle(name, value))


def rational(value: Fraction) -> Expr:
    """Return a Fraction as a sympy Rational."""
    return sp.Rational(value.numerator, value.denominator)


def sign_of(number: Expr) -> int:
    """Return the exact sign of a real constant.

    ParameterError if it is undecided whether it is 0.
    """
    if number.is_Rational:
        return int(sp.sign(number))
    for digits in (FEW_SIGN_DIGITS, MORE_SIGN_DIGITS, MOST_SIGN_DIGITS):
        value = number.evalf(15, maxn=digits)
        if value.is_Float and value._prec > 1:  # precision 1 is sympy's way to say "0 or nearly so"
            if value > 0:
                return 1
            return -1
        # No digits show that a number is 0: algebra may, and is tried before more digits are.
        if digits == FEW_SIGN_DIGITS:
            expanded = sp.expand_trig(number)
            x = sp.Dummy("x")
            if expanded.is_algebraic:
                is_zero = sp.minimal_polynomial(expanded, x) == x
            else:
                is_zero = sp.simplify(expanded) == 0
            if is_zero:
                return 0
    raise ParameterError(
        "number", number, f"cannot be distinguished from 0 with {MOST_SIGN_DIGITS} digits"
    )
