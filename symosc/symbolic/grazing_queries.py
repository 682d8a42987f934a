"""Theorem 7 the other way round: for which values of one parameter has the window of a map a property?

The sign function side (k v_lambda + B0 Omega sin theta) is linear in each of Omega, B0, k and v_lambda, and its extreme
over theta in |B0|. So each answer is a half line or an interval whose end is known in closed form:

    contains theta   iff side (k v_lambda + B0 Omega sin theta) > 0
    empty            iff side k v_lambda <= -|B0| Omega
    everything       iff side k v_lambda >= |B0| Omega and side k v_lambda > 0    (order 1: > |B0| Omega)

In full order (see `symosc.grazing.window.grazing_window`) equality counts too where theta is at the top or bottom of
the sine, if side k v_lambda > 0: that is the tangency of fourth order.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import sympy as sp

from symosc.aliases import Expr, NumberLike
from symosc.errors import ParameterError
from symosc.mappings.theorem7_cases import Place, check_order, check_parameters, place
from symosc.model import Parameters
from symosc.symbolic.theorem7 import rational, real, sign_of

#: The letters of the answers without numbers. v_lambda is the belt of the map, v_1 and v_2 stand in its range only.
QUERY_LETTERS = {
    "k": sp.Symbol("k", nonnegative=True),
    "v": sp.Symbol("v_lambda", real=True),
    "B0": sp.Symbol("B_0", real=True),
    "Omega": sp.Symbol("Omega", positive=True),
    "v1": sp.Symbol("v_1", real=True),
    "v2": sp.Symbol("v_2", real=True),
}
THETA = sp.Symbol("theta", real=True)


class Answer(NamedTuple):
    """Values of the parameter that was asked for, under a condition on the others.

    Attributes
    ----------
    condition : sympy Boolean
        When it holds.
    values : sympy Set
        The values that have the property then.

    Examples
    --------
    >>> from symosc import values_empty
    >>> values_empty(None, "P3", "B0")[0]
    Answer(condition=k*v_lambda > 0, values=Interval(-k*v_lambda/Omega, k*v_lambda/Omega))
    """

    condition: Expr
    values: Expr


class _Problem(NamedTuple):
    where: Place
    name: str  # "k", "v", "B0" or "Omega"
    letters: dict[str, Expr]
    domain: Expr  # what Parameters allows for it

    @property
    def numeric(self) -> bool:
        return not any(self.letters[name].free_symbols for name in ("k", "v", "B0", "Omega"))

    @property
    def level(self) -> Expr:
        """side k v_lambda."""
        return self.where.side * self.letters["k"] * self.letters["v"]


def values_containing(
    p: Parameters | None, mapping: str, name: str, theta: NumberLike = None, order: str = "full"
) -> Expr:
    """Return for which values of a parameter the window of a map contains a phase.

    Parameters
    ----------
    p : Parameters or None
        The other parameters; the value of `name` in it is not used. None: `QUERY_LETTERS` in place of numbers.
    mapping : {"P2", "P3", "P5", "P6"}
    name : {"Omega", "B0", "k", "v1", "v2", "v_lambda"}
        The parameter that is asked for; v_lambda is the map's belt, v1 or v2.
    theta : number or sympy expression
        The phase, exactly as for `symosc.theorem7`. With p = None it may be left out and stays the letter theta.
    order : {"full", "paper"}
        See `symosc.grazing_window`.

    Returns
    -------
    sympy Set, or tuple of Answer
        The values that Parameters allows and that have the property. With letters: one Answer for each condition on the
        others; exactly one condition holds.

    Raises
    ------
    ParameterError
        For a map without grazing, a parameter on which its window does not depend, or a phase that is not a number.

    Examples
    --------
    >>> from sympy import pi
    >>> from symosc import load_scene, values_containing
    >>> values_containing(load_scene("fig9").parameters, "P2", "Omega", 7 * pi / 6)
    Interval.open(0, 2/3)
    """
    problem, full = _problem(p, mapping, name), check_order(order) == "full"
    if theta is None and p is None:
        theta = THETA
    theta = real("theta", theta)
    if p is not None and theta.free_symbols:
        raise ParameterError("theta", theta, "must be a number where the parameters are numbers")
    return _collected(problem, _containing(problem, theta, full))


def values_empty(p: Parameters | None, mapping: str, name: str) -> Expr:
    """Return for which values of a parameter the window of a map is empty; see `values_containing`.

    Both orders agree: at equality the tangency of fourth order bends to the other side.

    Examples
    --------
    >>> from symosc import load_scene, values_empty
    >>> values_empty(load_scene("fig9").parameters, "P3", "Omega")
    Interval.Lopen(0, 1/3)
    """
    problem = _problem(p, mapping, name)
    return _collected(problem, _reaching(problem, -problem.where.side, closed=True, at_zero=True))


def values_everything(p: Parameters | None, mapping: str, name: str, order: str = "full") -> Expr:
    """Return for which values of a parameter every phase is in the window of a map; see `values_containing`.

    Examples
    --------
    >>> from symosc import load_scene, values_everything
    >>> values_everything(load_scene("fig9").parameters, "P2", "Omega", order="paper")
    Interval.open(0, 1/3)
    """
    problem, full = _problem(p, mapping, name), check_order(order) == "full"
    return _collected(problem, _reaching(problem, problem.where.side, closed=full, at_zero=False))


def _problem(p: Parameters | None, mapping: str, name: str) -> _Problem:
    where = place(mapping)
    if p is not None:
        check_parameters(p)
    belt, other = f"v{where.boundary}", f"v{3 - where.boundary}"
    name = belt if isinstance(name, str) and name == "v_lambda" else name
    if not isinstance(name, str) or name not in ("Omega", "B0", "k", belt):
        known = f"the window of {mapping} depends on Omega, B0, k and {belt} (or v_lambda) only"
        raise ParameterError("name", name, known)
    if p is None:
        letters = QUERY_LETTERS
    else:
        letters = {each: rational(getattr(p, each)) for each in ("k", "B0", "Omega", other)}
        letters["v"] = rational(p.belt(where.boundary))
    limit = letters[other]
    domain = {
        "Omega": sp.Interval.open(0, sp.oo),
        "k": sp.Interval(0, sp.oo),
        "B0": sp.Interval(-sp.oo, sp.oo),
        "v1": sp.Interval.open(-sp.oo, limit),
        "v2": sp.Interval.open(limit, sp.oo),
    }[name]
    return _Problem(where, "v" if name == belt else name, letters, domain)


# --- the answers, case by case ---


def _containing(problem: _Problem, theta: Expr, full: bool) -> Iterator[Answer]:
    """Solve side (k v + B0 Omega sin theta) > 0, which is start + slope * parameter > 0."""
    letters, side, sine = problem.letters, problem.where.side, sp.sin(theta)
    if problem.name in ("Omega", "B0"):
        start = problem.level
        slope = side * letters["B0" if problem.name == "Omega" else "Omega"] * sine
        level = start  # side k v at the root
    else:
        start = side * letters["B0"] * letters["Omega"] * sine
        slope = side * letters["v" if problem.name == "k" else "k"]
        level = -start
    for slope_sign, sloped in _signs(slope):
        if slope_sign == 0:
            for positive, started in _positive(start):
                yield Answer(sloped & started, problem.domain if positive else sp.S.EmptySet)
            continue
        for closed, closing in _tangency(theta, level) if full else [(False, sp.true)]:
            yield Answer(sloped & closing, _half_line(-start / slope, slope_sign, closed))


def _tangency(theta: Expr, level: Expr) -> Iterator[tuple[bool, Expr]]:
    """Yield whether equality at theta is a tangency of fourth order from the map's domain, with the condition."""
    cosine = sp.cos(theta)
    if not cosine.free_symbols:
        yield from _positive(level) if sign_of(cosine) == 0 else [(False, sp.true)]
        return
    for positive, condition in _positive(level):
        turning = sp.Eq(cosine, 0)
        if positive:
            yield True, turning & condition
            yield False, sp.Not(turning) & condition
        else:
            yield False, condition


def _reaching(problem: _Problem, direction: int, closed: bool, at_zero: bool) -> Iterator[Answer]:
    """Solve direction k v >= |B0| Omega, or > unless `closed`; whether equality at 0 counts is `at_zero`."""
    letters = problem.letters
    k, v, B0, Omega = (letters[each] for each in ("k", "v", "B0", "Omega"))
    if problem.name in ("Omega", "B0"):
        # |B0| Omega <= level
        level = direction * k * v
        for level_sign, levelled in _signs(level):
            if level_sign < 0 or (level_sign == 0 and not at_zero):
                yield Answer(levelled, sp.S.EmptySet)
            elif problem.name == "B0":
                end = level / Omega if level_sign else sp.S.Zero
                yield Answer(levelled, sp.Interval(-end, end, not closed, not closed))
            else:
                for B0_sign, signed in _signs(B0):
                    if B0_sign == 0:
                        yield Answer(levelled & signed, problem.domain)
                    elif level_sign == 0:  # Omega > 0
                        yield Answer(levelled & signed, sp.S.EmptySet)
                    else:
                        yield Answer(levelled & signed, _half_line(level / (B0_sign * B0), -1, closed))
        return
    # factor * parameter >= |B0| Omega
    factor = direction * (v if problem.name == "k" else k)
    for factor_sign, factored in _signs(factor):
        for B0_sign, signed in _signs(B0):
            condition = factored & signed
            if factor_sign == 0:
                yield Answer(condition, problem.domain if B0_sign == 0 and at_zero else sp.S.EmptySet)
            elif problem.name == "k" and factor_sign < 0:  # k >= 0
                yield Answer(condition, sp.FiniteSet(0) if B0_sign == 0 and at_zero else sp.S.EmptySet)
            elif B0_sign == 0:
                yield Answer(condition, _half_line(sp.S.Zero, factor_sign, at_zero))
            else:
                yield Answer(condition, _half_line(B0_sign * B0 * Omega / factor, factor_sign, closed))


def _half_line(end: Expr, direction: int, closed: bool) -> Expr:
    """Return the half line from `end` upwards (direction 1) or downwards (-1)."""
    return sp.Interval(end, sp.oo, not closed, True) if direction > 0 else sp.Interval(-sp.oo, end, True, not closed)


def _signs(expr: Expr) -> Iterator[tuple[int, Expr]]:
    """Yield the signs that an expression can have, each with its condition."""
    if not expr.free_symbols:
        yield sign_of(expr), sp.true
        return
    if expr.could_extract_minus_sign():  # conditions without needless minus signs
        yield from ((-sign, condition) for sign, condition in _signs(-expr))
        return
    for sign, condition in ((1, expr > 0), (0, sp.Eq(expr, 0)), (-1, expr < 0)):
        if condition != sp.false:
            yield sign, condition


def _positive(expr: Expr) -> Iterator[tuple[bool, Expr]]:
    """Yield whether an expression is > 0, with the condition."""
    if not expr.free_symbols:
        yield sign_of(expr) > 0, sp.true
        return
    flipped = expr.could_extract_minus_sign()
    conditions = (-expr < 0, -expr >= 0) if flipped else (expr > 0, expr <= 0)
    for positive, condition in zip((True, False), conditions, strict=True):
        if condition != sp.false:
            yield positive, condition


def _collected(problem: _Problem, answers: Iterator[Answer]) -> Expr:
    """Cut answers to the allowed values, join conditions with one answer, and return a set if there is no condition."""
    found: dict[Expr, Expr] = {}
    for condition, values in answers:
        if condition == sp.false:
            continue
        inside = values & problem.domain
        found[inside] = sp.Or(found.get(inside, sp.false), condition)
    if problem.numeric and len(found) == 1:
        return next(iter(found))
    return tuple(Answer(condition, values) for values, condition in found.items())
