"""Theorem 7 the other way round: for which values of parameters has the window of a map a property?

The sign function side (k v_lambda + B0 Omega sin theta) is linear in each of Omega, B0, k and v_lambda, and its extreme
over theta in |B0|. So each answer is a half line or an interval whose end is known in closed form:

    contains theta   iff side (k v_lambda + B0 Omega sin theta) > 0
    empty            iff side k v_lambda <= -|B0| Omega
    everything       iff side k v_lambda >= |B0| Omega and side k v_lambda > 0    (order 1: > |B0| Omega)

In full order (see `symosc.grazing.window.grazing_window`) equality counts too where theta is at the top or bottom of
the sine, if side k v_lambda > 0: that is the tangency of fourth order.

An interval of phases is in the window iff the phases with the smallest and the largest sine of it are. One at an open
end of the interval may be an end of the window, as long as something in between is inside.

For two parameters the same inequalities are a region (`symosc.symbolic.grazing_regions`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import sympy as sp

from symosc.aliases import Expr, NumberLike, Order
from symosc.arguments import public
from symosc.errors import ParameterError
from symosc.mappings.theorem7_cases import Place, place
from symosc.model import Parameters
from symosc.symbolic.grazing_answers import (
    ASKS_EVERYTHING,
    ASKS_NOTHING,
    ASKS_PHASES,
    QUERY_LETTERS,
    Answer,
    Answers,
    GrazingQuestion,
    ParameterValues,
)
from symosc.symbolic.grazing_regions import region
from symosc.symbolic.phase_interval import Extreme, PhaseInterval, read_phases
from symosc.symbolic.theorem7 import rational, sign_of

THETA = sp.Symbol("theta", real=True)


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


@public
def values_containing(
    p: Parameters | None,
    mapping: str,
    name: str | Sequence[str],
    theta: NumberLike | tuple[NumberLike, NumberLike] | sp.Interval | None = None,
    order: Order = "full",
) -> Any:
    """Return for which values of a parameter, or of two, the window of a map contains a phase, or an interval of them.

    Parameters
    ----------
    p : Parameters or None
        The other parameters; the value of `name` in it is not used. None: `QUERY_LETTERS` in place of numbers.
    mapping : {"P2", "P3", "P5", "P6"}
    name : {"Omega", "B0", "k", "v1", "v2", "v_lambda"}, or a pair of them
        The parameter that is asked for; v_lambda is the map's belt, v1 or v2.
    theta : number, text, sympy expression, or an interval
        The phase, exactly: "3*pi/2" as text, the rest as for `symosc.theorem7`. A pair (low, high), or a sympy
        Interval: every phase of it, ends included unless the Interval is open; it may go through 0, as (-1, 1) does.
        With p = None it is one phase, and may be left out: the letter theta.
    order : {"full", "paper"}
        See `symosc.grazing_window`.

    Returns
    -------
    ParameterValues, Answers or ParameterRegion
        The values that Parameters allows and that have the property, as a sympy Set with ``text()`` and ``latex()``.
        With letters: one Answer for each condition on the others; exactly one condition holds. For two parameters: the
        region, as a condition.

    Raises
    ------
    ParameterError
        For a map without grazing, a parameter on which its window does not depend, or a phase that is not a number.

    Examples
    --------
    >>> from symosc import load_scene, values_containing
    >>> p = load_scene("fig9").parameters
    >>> values_containing(p, "P2", "Omega", "7*pi/6")
    Interval.open(0, 2/3)
    >>> values_containing(p, "P2", "Omega", ("pi", "5*pi/4"))
    Interval.open(0, sqrt(2)/3)
    """
    where, names, full = place(mapping), _names(mapping, name, p), order == "full"
    phases = THETA if theta is None and p is None else read_phases("theta", theta)
    if p is None and isinstance(phases, PhaseInterval):
        raise ParameterError("theta", theta, "must be one phase where the parameters are letters")
    if p is not None and not isinstance(phases, PhaseInterval) and phases.free_symbols:
        raise ParameterError("theta", theta, "must be a number where the parameters are numbers")
    question = GrazingQuestion(mapping, names, ASKS_PHASES, phases)
    if len(names) == 2:
        return region(p, where, question, full)
    problem = _problem(p, where, names[0])
    if isinstance(phases, PhaseInterval):
        return ParameterValues(question, _containing_all(problem, phases, full))
    return _collected(problem, question, _containing(problem, phases, full))


@public
def values_empty(p: Parameters | None, mapping: str, name: str | Sequence[str]) -> Any:
    """Return for which values of a parameter, or of two, the window of a map is empty; see `values_containing`.

    Both orders agree: at equality the tangency of fourth order bends to the other side.

    Examples
    --------
    >>> from symosc import load_scene, values_empty
    >>> values_empty(load_scene("fig9").parameters, "P3", "Omega")
    Interval.Lopen(0, 1/3)
    """
    where, names = place(mapping), _names(mapping, name, p)
    question = GrazingQuestion(mapping, names, ASKS_NOTHING)
    if len(names) == 2:
        return region(p, where, question, True)
    problem = _problem(p, where, names[0])
    return _collected(problem, question, _reaching(problem, -where.side, closed=True, at_zero=True))


@public
def values_everything(p: Parameters | None, mapping: str, name: str | Sequence[str], order: Order = "full") -> Any:
    """Return for which values of a parameter, or of two, every phase is in the window; see `values_containing`.

    Examples
    --------
    >>> from symosc import load_scene, values_everything
    >>> values_everything(load_scene("fig9").parameters, "P2", "Omega", order="paper")
    Interval.open(0, 1/3)
    """
    where, names, full = place(mapping), _names(mapping, name, p), order == "full"
    question = GrazingQuestion(mapping, names, ASKS_EVERYTHING)
    if len(names) == 2:
        return region(p, where, question, full)
    problem = _problem(p, where, names[0])
    return _collected(problem, question, _reaching(problem, where.side, closed=full, at_zero=False))


def _names(mapping: str, given: Any, p: Any) -> tuple[str, ...]:
    """Return the names of one parameter or two; the belt is "v" among letters, v1 or v2 among numbers."""
    belt = f"v{place(mapping).boundary}"
    known = f"the window of {mapping} depends on Omega, B0, k and {belt} (or v_lambda) only"
    asked = tuple(given) if isinstance(given, tuple | list) else (given,)
    own = "v" if p is None else belt
    names = tuple(own if isinstance(name, str) and name in (belt, "v_lambda") else name for name in asked)
    for name, asked_name in zip(names, asked, strict=True):
        if not isinstance(name, str) or name not in ("Omega", "B0", "k", own):
            raise ParameterError("name", asked_name, known)
    if len(names) not in (1, 2) or len(set(names)) < len(names):
        raise ParameterError("name", given, "give one parameter, or a pair of two different ones")
    return names


def _problem(p: Parameters | None, where: Place, name: str) -> _Problem:
    belt, other = f"v{where.boundary}", f"v{3 - where.boundary}"
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
    }[belt if name == "v" else name]
    return _Problem(where, "v" if name == belt else name, letters, domain)


# --- the answers, case by case ---


def _containing(problem: _Problem, theta: Expr, full: bool) -> Iterator[Answer]:
    """Solve side (k v + B0 Omega sin theta) > 0, which is start + slope * parameter > 0."""
    start, slope, level = _line(problem, sp.sin(theta))
    for slope_sign, sloped in _signs(slope):
        if slope_sign == 0:
            for positive, started in _positive(start):
                yield Answer(sloped & started, problem.domain if positive else sp.S.EmptySet)
            continue
        for closed, closing in _tangency(theta, level) if full else [(False, sp.true)]:
            yield Answer(sloped & closing, _half_line(-start / slope, slope_sign, closed))


def _line(problem: _Problem, sine: Expr) -> tuple[Expr, Expr, Expr]:
    """Return start, slope and side k v at the root of side (k v + B0 Omega sine), linear in the parameter."""
    letters, side = problem.letters, problem.where.side
    if problem.name in ("Omega", "B0"):
        slope = side * letters["B0" if problem.name == "Omega" else "Omega"] * sine
        return problem.level, slope, problem.level
    start = side * letters["B0"] * letters["Omega"] * sine
    return start, side * letters["v" if problem.name == "k" else "k"], -start


def _containing_all(problem: _Problem, phases: PhaseInterval, full: bool) -> Expr:
    """Return the values for which every phase of an interval grazes."""
    extremes = phases.extremes()
    values = [_containing_extreme(problem, each, full) for each in extremes]
    if not all(each.attained for each in extremes):
        values.append(_containing_extreme(problem, Extreme(phases.between(), True), False))
    return sp.Intersection(problem.domain, *values)


def _containing_extreme(problem: _Problem, extreme: Extreme, full: bool) -> Expr:
    """Return the values, allowed or not, for which a phase grazes, or is an end of the window if not attained."""
    start, slope, level = _line(problem, sp.sin(extreme.theta))
    slope_sign = sign_of(slope)
    if slope_sign == 0:
        return sp.S.Reals if sign_of(start) >= (1 if extreme.attained else 0) else sp.S.EmptySet
    touching = full and sign_of(sp.cos(extreme.theta)) == 0 and sign_of(level) > 0
    return _half_line(-start / slope, slope_sign, touching or not extreme.attained)


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
                        end = level / (B0_sign * B0)  # > 0 under these conditions
                        yield Answer(levelled & signed, sp.Interval(0, end, True, not closed))
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


def _collected(problem: _Problem, question: GrazingQuestion, answers: Iterator[Answer]) -> Any:
    """Cut answers to the allowed values, join conditions with one answer, return values if there is no condition."""
    found: dict[Expr, Expr] = {}
    for condition, values in answers:
        if condition == sp.false:
            continue
        inside = values & problem.domain
        found[inside] = sp.Or(found.get(inside, sp.false), condition)
    if problem.numeric and len(found) == 1:
        return ParameterValues(question, next(iter(found)))
    return Answers.to(question, (Answer(condition, values) for values, condition in found.items()))
