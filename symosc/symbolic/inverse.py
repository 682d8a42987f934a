"""Theorem 7 inverted: the parameter values for which the window of a map has a property.

The sign function side (k v_lambda + B0 Omega sin theta) is linear in each of Omega, B0, k and
v_lambda, and its extreme over theta in |B0|. So each answer is a half line or an interval whose end
is known in closed form:

    contains theta   iff side (k v_lambda + B0 Omega sin theta) > 0
    empty            iff side k v_lambda <= -|B0| Omega
    everything       iff side k v_lambda >= |B0| Omega and side k v_lambda > 0    (order 1: > |B0| Omega)

In full order (see `symosc.grazing.window.grazing_window`) equality counts too where theta is at the
top or bottom of the sine, if side k v_lambda > 0: that is the tangency of fourth order.

An interval of phases is in the window iff the phases with the smallest and the largest sine of it
are. One at an open end of the interval may be an end of the window, as long as something in between
is inside.

For two parameters the same inequalities are written down as a region, k v_lambda on the left and
the drive on the right. Points of it are decided exactly.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import sympy as sp

from symosc.base.aliases import Expr, NumberLike, Order
from symosc.base.arguments import (
    NAMES,
    NUMBER,
    ORDER,
    TEXT,
    public,
    require,
    require_or_none,
    row_of,
)
from symosc.base.display.drawable import Drawable
from symosc.base.display.latex import LatexAnswer, latex_table
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact
from symosc.kernels.theorem7_cases import Place, place
from symosc.model import Parameters
from symosc.scenes import ParametersLike, parameters_for
from symosc.symbolic.latex import latex
from symosc.symbolic.theorem7 import rational, real, sign_of

#: The letters of questions without numbers: v_lambda is the map's belt speed; v_1 and v_2 only
#: bound its range.
QUERY_LETTERS = {
    "k": sp.Symbol("k", nonnegative=True),
    "v": sp.Symbol("v_lambda", real=True),
    "B0": sp.Symbol("B_0", real=True),
    "Omega": sp.Symbol("Omega", positive=True),
    "v1": sp.Symbol("v_1", real=True),
    "v2": sp.Symbol("v_2", real=True),
}
THETA = sp.Symbol("theta", real=True)


#: Booleans `a > b` and `a >= b` that sympy keeps as they are written.
OPEN_REGION = sp.StrictGreaterThan
CLOSED_REGION = sp.GreaterThan
#: A phase at which the sine over an interval is extreme, and whether the interval contains it (no
#: open end).
Extreme = tuple[Expr, bool]


# --- intervals of phases ---


class PhaseInterval(NamedTuple):
    """An interval of phases from `low` to `high`, at most 2 pi long.

    Either end may be excluded (open).
    """

    low: Expr
    high: Expr
    low_open: bool = False
    high_open: bool = False

    def deciding(self, signs: Sequence[int]) -> list[Extreme]:
        """Return phases that decide for all others: the whole interval is in a window if these are.

        They have the least (-1 in `signs`) or largest (1) sine; if an open end has it, a phase
        inside is added.
        """
        extremes = [self._extreme(sign) for sign in signs]
        if not all(attained for _, attained in extremes):
            # A phase inside whose sine is neither extreme: one of these three.
            inside = (self.low + (self.high - self.low) / divisor for divisor in (2, 3, 5))
            both_extremes = [self._extreme(sign) for sign in (-1, 1)]
            sines = [sp.sin(theta) for theta, _ in both_extremes]
            between = next(
                theta for theta in inside if all(sign_of(sp.sin(theta) - sine) for sine in sines)
            )
            extremes.append((between, True))
        return extremes

    def _extreme(self, sign: int) -> Extreme:
        """Return the phase with the largest (sign 1) or smallest sine (-1), and whether the
        interval contains it.
        """
        # sign * sin is largest at sign pi/2 + 2 pi n; the first of these phases after the low end
        # may be inside.
        top = sign * sp.pi / 2
        first = top + 2 * sp.pi * sp.ceiling((self.low - top) / (2 * sp.pi))
        if sign_of(first - self.low) > 0 and sign_of(self.high - first) > 0:
            return first, True
        low = (self.low, not self.low_open)
        high = (self.high, not self.high_open)
        difference = sign_of(sign * (sp.sin(self.high) - sp.sin(self.low)))
        # If both ends are equally extreme, prefer one that the interval contains.
        if difference > 0 or (difference == 0 and self.low_open and not self.high_open):
            return high
        return low


def read_phases(name: str, value: Any) -> Expr | PhaseInterval:
    """Read `value` as a phase (a sympy expression) or as an interval of phases.

    Error messages call it `name`.
    """
    if isinstance(value, sp.Interval):
        ends = (value.start, value.end)
        open_ends = (bool(value.left_open), bool(value.right_open))
    elif isinstance(value, tuple | list):
        if len(value) != 2:
            allowed = (
                "must be a phase, or an interval of phases: a pair (low, high) with low < high, or"
            )
            raise ParameterError(name, value, f"{allowed} a sympy Interval")
        ends = tuple(value)
        open_ends = (False, False)
    else:
        return real(name, value)
    low, high = (real(name, end) for end in ends)
    if low.free_symbols or high.free_symbols:
        raise ParameterError(name, value, "the ends of an interval must be numbers")
    if sign_of(high - low) <= 0:
        allowed = "the interval must go from a lower to a higher phase; (7*pi/4, 9*pi/4) has 0 in"
        raise ParameterError(name, value, allowed)
    if sign_of(high - low - 2 * sp.pi) > 0:
        raise ParameterError(name, value, "the interval is longer than a turn")
    return PhaseInterval(low, high, *open_ends)


# --- answers ---


class GrazingQuestion(NamedTuple):
    """The question for which parameter values a map's window contains phases, is empty or has all
    phases.

    Attributes
    ----------
    mapping : str
    names : tuple of str
        The one or two parameters whose values are asked for.
    asked : {"contains", "empty", "everything"}
    theta : sympy expression, PhaseInterval or None

    Examples
    --------
    >>> from symosc import load_scene, values_containing
    >>> print(values_containing(load_scene("fig9").parameters, "P2", "Omega", "pi").question.text())
    P2 grazes at theta = pi
    """

    mapping: str
    names: tuple[str, ...]
    asked: str
    theta: Any = None

    def text(self) -> str:
        """Return the property asked for, such as that a window contains a phase, as text."""
        if self.asked != "contains":
            return f"{self.mapping} grazes at {'no' if self.asked == 'empty' else 'every'} phase"
        if isinstance(self.theta, PhaseInterval):
            return (
                f"{self.mapping} grazes at every theta in {interval_text(sp.Interval(*self.theta))}"
            )
        return f"{self.mapping} grazes at theta = {self.theta}"

    def latex(self) -> str:
        """Return the property as LaTeX."""
        name = f"P_{{{self.mapping.removeprefix('P')}}}"
        if self.asked == "empty":
            return rf"{name} \text{{ grazes at no phase}}"
        if self.asked == "everything":
            return rf"{name} \text{{ grazes at every phase}}"
        if isinstance(self.theta, PhaseInterval):
            interval = latex(sp.Interval(*self.theta))
            return rf"{name} \text{{ grazes at every }}\theta \in {interval}"
        return rf"{name} \text{{ grazes at }}\theta = {latex(self.theta)}"


def interval_text(values: Expr) -> str:
    """Return a set in the notation of the paper."""
    if values.is_empty:
        return "the empty set"
    if isinstance(values, sp.Interval):
        return (
            f"{'(' if values.left_open else '['}{values.start}, "
            f"{values.end}{')' if values.right_open else ']'}"
        )
    for kind, sign in ((sp.Union, " U "), (sp.Intersection, " & ")):
        if isinstance(values, kind):
            return sign.join(interval_text(part) for part in values.args)
    return str(values)


def condition_text(condition: Expr) -> str:
    """Return a condition as text."""
    if isinstance(condition, sp.Eq):
        return f"{condition.lhs} = {condition.rhs}"
    if isinstance(condition, sp.And):
        texts = ((condition_text(part), isinstance(part, sp.Or)) for part in condition.args)
        return " and ".join(sorted(f"({text})" if joined else text for text, joined in texts))
    if isinstance(condition, sp.Or):
        parts = [(condition_text(part), isinstance(part, sp.And)) for part in condition.args]
        return " or ".join(sorted(f"({text})" if joined else text for text, joined in parts))
    return str(condition)


class Answer(NamedTuple):
    """The values of the parameter that is asked for, under a condition on the other parameters.

    Attributes
    ----------
    condition : sympy Boolean
        The condition on the other parameters.
    values : sympy Set
        The values that have the property where the condition holds.

    Examples
    --------
    >>> from symosc import values_empty
    >>> values_empty(None, "P3", "B0")[0]
    Answer(condition=k*v_lambda > 0, values=Interval(-k*v_lambda/Omega, k*v_lambda/Omega))
    """

    condition: Expr
    values: Expr

    def latex(self) -> str:
        """Return "condition: values" as LaTeX (no dollar signs)."""
        return rf"{latex(self.condition)}:\quad {latex(self.values)}"


class Answers(tuple[Answer, ...], LatexAnswer):
    """The values of one parameter where the others are letters: an Answer for each condition on
    those letters.

    Attributes
    ----------
    question : GrazingQuestion

    Examples
    --------
    >>> from symosc import values_everything
    >>> answers = values_everything(None, "P2", "Omega")
    >>> answers.question.text()
    'P2 grazes at every phase'
    >>> len(answers)
    4
    """

    question: GrazingQuestion

    def text(self) -> str:
        """Return question and answers as text, one line for each condition."""
        name = QUERY_LETTERS[self.question.names[0]]
        lines = [
            f"  if {condition_text(answer.condition)}: {name} in {interval_text(answer.values)}"
            for answer in self
        ]
        return "\n".join([f"{self.question.text()}:", *lines])

    def latex(self) -> str:
        """Return the answers as a table in LaTeX (an array, no dollar signs)."""
        name = latex(QUERY_LETTERS[self.question.names[0]])
        rows = ((latex(answer.condition), latex(answer.values)) for answer in self)
        return latex_table([self.question.latex(), rf"{name} \in"], rows)


class ParameterValues(LatexAnswer):
    """The values of one parameter that have a property.

    Works like the sympy Set `values`, and prints itself.

    Attributes
    ----------
    question : GrazingQuestion
    values : sympy Set

    Examples
    --------
    >>> from symosc import load_scene, values_containing
    >>> found = values_containing(load_scene("fig9").parameters, "P2", "Omega", "7*pi/6")
    >>> print(found.text())
    P2 grazes at theta = 7*pi/6 for Omega in (0, 2/3)
    >>> "1/2" in found, 1 in found
    (True, False)
    """

    def __init__(self, question: GrazingQuestion, values: Expr) -> None:
        self.question = question
        self.values = values

    def text(self) -> str:
        """Return question and answer as text."""
        name = self.question.names[0]
        if self.values.is_empty:
            where = f"no {name}"
        else:
            where = f"{name} in {interval_text(self.values)}"
        return f"{self.question.text()} for {where}"

    def latex(self) -> str:
        """Return question and answer as LaTeX (no dollar signs)."""
        name = latex(QUERY_LETTERS[self.question.names[0]])
        return rf"{self.question.latex()}:\quad {name} \in {latex(self.values)}"

    @public
    def __contains__(self, value: NumberLike) -> bool:
        require(NUMBER, value=value)
        name = self.question.names[0]
        if isinstance(value, sp.Basic) and value.free_symbols:
            raise ParameterError(name, value, "must be a number")
        if isinstance(value, sp.Basic):
            exact = value
        else:
            exact = rational(read_exact(name, value))
        return bool(self.values.contains(exact) == sp.true)

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the sympy Set `values`, such as boundary, is_subset or measure."""
        if name.startswith("__") or name in ("question", "values"):
            raise AttributeError(name)
        return getattr(self.values, name)

    def _sympy_(self) -> Expr:
        return self.values

    def __bool__(self) -> bool:
        return not self.values.is_empty

    def __eq__(self, other: object) -> bool:
        return bool(self.values == (other.values if isinstance(other, ParameterValues) else other))

    def __hash__(self) -> int:
        return hash(self.values)

    def __repr__(self) -> str:
        return repr(self.values)


class ParameterRegion(Drawable, LatexAnswer):
    """The region in the plane of two parameters where a window has the property asked for.

    `plot` draws it.

    Attributes
    ----------
    question : GrazingQuestion
    condition : sympy Boolean
        The condition in the letters of both parameters; the others are numbers.
    parameters : Parameters

    Examples
    --------
    >>> from symosc import load_scene, values_containing
    >>> region = values_containing(load_scene("fig9").parameters, "P2", ("Omega", "k"), "7*pi/6")
    >>> print(region.text())
    P2 grazes at theta = 7*pi/6 where k > 9*Omega/2
    >>> region.contains(Omega="1/5", k=1), region.contains(Omega=1, k=1)
    (True, False)
    """

    _drawn_by = "region_figure"
    _made_by = "values_containing(...) for two parameters"

    def __init__(self, question: GrazingQuestion, condition: Expr, parameters: Parameters) -> None:
        self.question = question
        self.condition = condition
        self.parameters = parameters

    @property
    def allowed(self) -> Expr:
        """The ranges that Parameters allows for the two parameters, as a sympy Boolean."""
        ranges = {
            "k": sp.GreaterThan(QUERY_LETTERS["k"], 0, evaluate=False),
            "Omega": sp.StrictGreaterThan(QUERY_LETTERS["Omega"], 0, evaluate=False),
            "B0": sp.true,
            "v1": QUERY_LETTERS["v1"] < rational(self.parameters.v2),
            "v2": QUERY_LETTERS["v2"] > rational(self.parameters.v1),
        }
        return sp.And(
            *(ranges[name] for name in self.question.names if ranges[name] != sp.true),
            evaluate=False,
        )

    @property
    def letters(self) -> tuple[Expr, Expr]:
        """The symbols of both parameters."""
        first, second = (QUERY_LETTERS[name] for name in self.question.names)
        return first, second

    @public
    def contains(self, **values: NumberLike) -> bool:
        """Return whether a point of the plane is in the region, decided exactly.

        Raises
        ------
        ParameterError
            Unless both parameters are given, as values that Parameters allows.
        """
        require(NUMBER, **values)
        if set(values) != set(self.question.names):
            raise ParameterError(
                "values", ", ".join(values) or None, f"give {' and '.join(self.question.names)}"
            )
        allowed = self.parameters.replace(**values)
        numbers = {
            QUERY_LETTERS[name]: rational(getattr(allowed, name)) for name in self.question.names
        }
        return holds(self.condition, numbers)

    def text(self) -> str:
        """Return question and answer as text."""
        where = {sp.true: "everywhere", sp.false: "nowhere"}
        return (
            f"{self.question.text()} "
            f"{where.get(self.condition) or f'where {condition_text(self.condition)}'}"
        )

    def latex(self) -> str:
        """Return the region as LaTeX (no dollar signs)."""
        names = ", ".join(latex(letter) for letter in self.letters)
        region = {sp.true: latex(self.allowed), sp.false: r"\text{nowhere}"}
        condition = latex(self.condition)
        if isinstance(self.condition, sp.Or):
            condition = rf"\left({condition}\right)"
        inside = region.get(self.condition, rf"{latex(self.allowed)},\ {condition}")
        return rf"{self.question.latex()}:\quad \left\{{({names}) : {inside}\right\}}"

    def __repr__(self) -> str:
        return f"<ParameterRegion: {self.text()}>"


def holds(condition: Expr, numbers: dict[Expr, Expr]) -> bool:
    """Return whether a condition holds with numbers put in; each comparison is decided exactly."""
    if condition in (sp.true, sp.false):
        return bool(condition)
    if isinstance(condition, sp.And | sp.Or):
        parts = (holds(part, numbers) for part in condition.args)
        if isinstance(condition, sp.And):
            return all(parts)
        return any(parts)
    sign = sign_of((condition.lhs - condition.rhs).subs(numbers))
    return {sp.Gt: sign > 0, sp.Ge: sign >= 0, sp.Lt: sign < 0, sp.Le: sign <= 0, sp.Eq: sign == 0}[
        condition.func
    ]


# --- questions ---


@public
def values_containing(
    p: ParametersLike | None,
    mapping: str,
    name: str | Sequence[str],
    theta: NumberLike | tuple[NumberLike, NumberLike] | sp.Interval | None = None,
    order: Order = "full",
) -> Any:
    """Return the values of one or two parameters for which a map's window contains a phase, or an
    interval.

    Parameters
    ----------
    p : Parameters, a Scene, its name or its file, or None
        The other parameters; the value of `name` in it is not used. None: `QUERY_LETTERS` in place
        of numbers.
    mapping : {"P2", "P3", "P5", "P6"}
    name : {"Omega", "B0", "k", "v1", "v2", "v_lambda"}, or a pair of them
        The parameter that is asked for; v_lambda is the map's belt, v1 or v2.
    theta : number, text, sympy expression, or an interval
        The phase, exactly: "3*pi/2" as text, the rest as for `symosc.theorem7`. A pair (low, high),
        or a sympy Interval: every phase of it, ends included unless the Interval is open; it may go
        through 0, as (-1, 1) does. With p = None it is one phase, and may be left out: the letter
        theta.
    order : {"full", "paper"}
        See `symosc.grazing_window`.

    Returns
    -------
    ParameterValues, Answers or ParameterRegion
        The values that Parameters allows and that have the property, as a sympy Set with ``text()``
        and ``latex()``. With letters: one Answer for each condition on the others; exactly one
        condition holds. For two parameters: the region, as a condition.

    Raises
    ------
    ParameterError
        For a map without grazing, a parameter on which its window does not depend, or a phase that
        is not a number.

    Examples
    --------
    >>> from symosc import load_scene, values_containing
    >>> p = load_scene("fig9").parameters
    >>> values_containing(p, "P2", "Omega", "7*pi/6")
    Interval.open(0, 2/3)
    >>> values_containing(p, "P2", "Omega", ("pi", "5*pi/4"))
    Interval.open(0, sqrt(2)/3)
    """
    if p is not None:
        p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(*NAMES, name=name)
    require_or_none(NUMBER, row_of(2, NUMBER), sp.Interval, theta=theta)
    require(ORDER, order=order)
    names = _read_names(mapping, name, p)
    full = order == "full"
    if theta is None and p is None:
        phases = THETA
    else:
        phases = read_phases("theta", theta)
    if p is None and isinstance(phases, PhaseInterval):
        raise ParameterError(
            "theta", theta, "must be a single phase when the parameters are symbolic"
        )
    if p is not None and not isinstance(phases, PhaseInterval) and phases.free_symbols:
        raise ParameterError("theta", theta, "must be a number when the parameters are numbers")
    return _answer(p, GrazingQuestion(mapping, names, "contains", phases), full)


@public
def values_empty(p: ParametersLike | None, mapping: str, name: str | Sequence[str]) -> Any:
    """Return the values of one or two parameters for which a map's window is empty.

    See `values_containing`.

    The orders "full" and "paper" agree: at side k v_lambda = -|B0| Omega the tangency of fourth
    order does not graze.

    Examples
    --------
    >>> from symosc import load_scene, values_empty
    >>> values_empty(load_scene("fig9").parameters, "P3", "Omega")
    Interval.Lopen(0, 1/3)
    """
    if p is not None:
        p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(*NAMES, name=name)
    return _answer(p, GrazingQuestion(mapping, _read_names(mapping, name, p), "empty"), full=True)


@public
def values_everything(
    p: ParametersLike | None, mapping: str, name: str | Sequence[str], order: Order = "full"
) -> Any:
    """Return the values of one or two parameters for which a map's window has all phases.

    Examples
    --------
    >>> from symosc import load_scene, values_everything
    >>> values_everything(load_scene("fig9").parameters, "P2", "Omega", order="paper")
    Interval.open(0, 1/3)
    """
    if p is not None:
        p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(*NAMES, name=name)
    require(ORDER, order=order)
    return _answer(
        p, GrazingQuestion(mapping, _read_names(mapping, name, p), "everything"), order == "full"
    )


def _read_names(mapping: str, names_given: Any, p: Any) -> tuple[str, ...]:
    """Check the parameter names `names_given` and return them, the belt's speed as "v" if p is
    None, else "v1" or "v2".
    """
    belt = f"v{place(mapping).boundary}"
    if isinstance(names_given, tuple | list):
        given_row = tuple(names_given)
    else:
        given_row = (names_given,)
    if p is None:
        belt_name = "v"
    else:
        belt_name = belt
    names = tuple(
        belt_name if isinstance(name, str) and name in (belt, "v_lambda") else name
        for name in given_row
    )
    for name, name_given in zip(names, given_row, strict=True):
        if not isinstance(name, str) or name not in ("Omega", "B0", "k", belt_name):
            allowed = (
                f"the window of {mapping} depends on Omega, B0, k and {belt} (or v_lambda) only"
            )
            raise ParameterError("name", name_given, allowed)
    if len(names) not in (1, 2) or len(set(names)) < len(names):
        raise ParameterError(
            "name", names_given, "give one parameter, or a pair of two different ones"
        )
    return names


def _answer(p: Parameters | None, question: GrazingQuestion, full: bool) -> Any:
    """Return the region of two parameters, or the allowed values of one, for which the question's
    property holds.
    """
    grazing_place = place(question.mapping)
    name = question.names[0]
    if len(question.names) == 2:
        return _region(p, grazing_place, question, full)
    belt = f"v{grazing_place.boundary}"
    second_belt = f"v{3 - grazing_place.boundary}"
    if p is None:
        values = QUERY_LETTERS
    else:
        values = {
            parameter: rational(getattr(p, parameter))
            for parameter in ("k", "B0", "Omega", second_belt)
        }
        values["v"] = rational(p.belt(grazing_place.boundary))
    # The values that Parameters allows; the belt's speed is "v" in formulas, v1 or v2 here.
    domains = {
        "Omega": sp.Interval.open(0, sp.oo),
        "k": sp.Interval(0, sp.oo),
        "B0": sp.Interval(-sp.oo, sp.oo),
        "v1": sp.Interval.open(-sp.oo, values[second_belt]),
        "v2": sp.Interval.open(values[second_belt], sp.oo),
    }
    if name in ("v", belt):
        domain = domains[belt]
        letter = "v"
    else:
        domain = domains[name]
        letter = name
    conditions: dict[Expr, Expr] = {}  # conditions with one answer are joined
    for condition, inside in _solved(question, letter, values, domain, grazing_place.side, full):
        if condition != sp.false:
            allowed = inside & domain
            conditions[allowed] = sp.Or(conditions.get(allowed, sp.false), condition)
    if p is not None:
        return ParameterValues(question, *conditions)
    answers = Answers(Answer(condition, inside) for inside, condition in conditions.items())
    answers.question = question
    return answers


def _solved(
    question: GrazingQuestion,
    name: str,
    values: dict[str, Expr],
    possible: Expr,
    side: int,
    full: bool,
) -> Iterator[Answer]:
    """Return the answers to a question in the parameter `name`: whether phases have
    side (k v + B0 Omega sin theta) > 0.
    """
    if question.asked == "empty":  # no phase has it
        return _solve_for_all_phases(name, values, possible, -side, closed=True, at_zero=True)
    if question.asked == "everything":
        return _solve_for_all_phases(name, values, possible, side, closed=full, at_zero=False)
    if isinstance(question.theta, PhaseInterval):
        # With numbers, as they are here, each phase has answers without further conditions.
        decided = [
            _containing(name, values, possible, side, extreme, full)
            for extreme in question.theta.deciding((-1, 1))
        ]
        sets = [answer.values for answers in decided for answer in answers]
        return iter([Answer(sp.true, sp.Intersection(*sets))])
    return _containing(name, values, possible, side, (question.theta, True), full)


# --- one parameter, case by case ---


def _containing(
    name: str, values: dict[str, Expr], possible: Expr, side: int, extreme: Extreme, full: bool
) -> Iterator[Answer]:
    """Solve side (k v + B0 Omega sin theta) > 0 for the parameter `name` at one phase.

    >= 0 if that is an open end.
    """
    theta, attained = extreme
    k, v, B0, Omega = (values[letter] for letter in ("k", "v", "B0", "Omega"))
    sine = sp.sin(theta)
    # The left side is start + slope * parameter; level is side k v at its root.
    if name in ("Omega", "B0"):
        start = side * k * v
        slope = side * (B0 if name == "Omega" else Omega) * sine
        level = start
    else:
        start = side * B0 * Omega * sine
        slope = side * (v if name == "k" else k)
        level = -start
    for slope_sign, slope_condition in _signs(slope):
        if slope_sign == 0:
            # The parameter does not matter: all its values, or none.
            if attained:
                signs: Any = _positive(start)
            else:
                signs = [(sign_of(start) >= 0, sp.true)]
            for positive, start_condition in signs:
                values_allowed = possible if positive else sp.S.EmptySet
                yield Answer(slope_condition & start_condition, values_allowed)
            continue
        if attained and full:
            cases: Any = _tangency_grazes(theta, level)
        else:
            cases = [(not attained, sp.true)]
        # The half line begins at the root; `closed` says whether it contains the root.
        for closed, end_condition in cases:
            half_line = _half_line(-start / slope, slope_sign, closed)
            yield Answer(slope_condition & end_condition, half_line)


def _tangency_grazes(theta: Expr, level: Expr) -> Iterator[tuple[bool, Expr]]:
    """Yield (grazes, condition) where G^(1) = 0: a contact grazes iff cos(theta) = 0 and `level`,
    side k v, is > 0.
    """
    cosine = sp.cos(theta)
    if not cosine.free_symbols:
        if sign_of(cosine) == 0:
            yield from _positive(level)
        else:
            yield False, sp.true
        return
    turning = sp.Eq(cosine, 0)
    for positive, condition in _positive(level):
        if positive:
            yield True, turning & condition
            yield False, sp.Not(turning) & condition
        else:
            yield False, condition


def _solve_for_all_phases(
    name: str, values: dict[str, Expr], possible: Expr, direction: int, closed: bool, at_zero: bool
) -> Iterator[Answer]:
    """Solve direction k v > |B0| Omega, true for all phases, for the parameter `name`, which is in
    `possible`; `closed`: >=.

    `at_zero`: also if both sides are 0.
    """
    if name in ("Omega", "B0"):
        return _solve_for_drive(name, values, possible, direction, closed, at_zero)
    return _solve_for_level(name, values, possible, direction, closed, at_zero)


# In both, each letter may be a formula of unknown sign: `_signs` gives the signs that it may have,
# each with its condition.


def _solve_for_drive(
    name: str, values: dict[str, Expr], possible: Expr, direction: int, closed: bool, at_zero: bool
) -> Iterator[Answer]:
    """Do what `_solve_for_all_phases` does for the parameters Omega and B0."""
    # |B0| Omega <= level
    k, v, B0, Omega = (values[letter] for letter in ("k", "v", "B0", "Omega"))
    level = direction * k * v
    for level_sign, levelled in _signs(level):
        # No value; else an interval about 0 of B0, or an interval from 0 of Omega.
        if level_sign < 0 or (level_sign == 0 and not at_zero):
            yield Answer(levelled, sp.S.EmptySet)
        elif name == "B0":
            if level_sign:
                end = level / Omega
            else:
                end = sp.S.Zero
            yield Answer(levelled, sp.Interval(-end, end, not closed, not closed))
        else:
            for B0_sign, signed in _signs(B0):
                allowed = possible
                if B0_sign:  # Omega > 0, and so is the end if the level is
                    end = level / (B0_sign * B0)
                    if level_sign:
                        allowed = sp.Interval(0, end, left_open=True, right_open=not closed)
                    else:
                        allowed = sp.S.EmptySet
                yield Answer(levelled & signed, allowed)


def _solve_for_level(
    name: str, values: dict[str, Expr], possible: Expr, direction: int, closed: bool, at_zero: bool
) -> Iterator[Answer]:
    """Do what `_solve_for_all_phases` does for the parameters k and v."""
    # factor * parameter >= |B0| Omega
    k, v, B0, Omega = (values[letter] for letter in ("k", "v", "B0", "Omega"))
    factor = direction * (v if name == "k" else k)
    for factor_sign, factored in _signs(factor):
        for B0_sign, signed in _signs(B0):
            # The left side is never > 0 (k is >= 0): at most both sides are 0.
            if factor_sign == 0 or (name == "k" and factor_sign < 0):
                if factor_sign == 0:
                    reached = possible
                else:
                    reached = sp.FiniteSet(0)
                if B0_sign == 0 and at_zero:
                    allowed = reached
                else:
                    allowed = sp.S.EmptySet
            else:
                if B0_sign:
                    end = B0_sign * B0 * Omega / factor
                else:
                    end = sp.S.Zero
                allowed = _half_line(end, factor_sign, closed if B0_sign else at_zero)
            yield Answer(factored & signed, allowed)


def _half_line(end: Expr, direction: int, closed: bool) -> Expr:
    """Return the half line from `end` upwards (direction 1) or downwards (-1), with `end` if
    `closed`.
    """
    if direction > 0:
        return sp.Interval(end, sp.oo, left_open=not closed, right_open=True)
    return sp.Interval(-sp.oo, end, left_open=True, right_open=not closed)


def _signs(expr: Expr) -> Iterator[tuple[int, Expr]]:
    """Yield each possible sign of an expression, with the condition under which it has this sign."""
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
    """Yield True with the condition under which an expression is > 0, and False with that under
    which it is not.
    """
    if not expr.free_symbols:
        yield sign_of(expr) > 0, sp.true
        return
    if expr.could_extract_minus_sign():
        conditions = (-expr < 0, -expr >= 0)
    else:
        conditions = (expr > 0, expr <= 0)
    for positive, condition in zip((True, False), conditions, strict=True):
        if condition != sp.false:
            yield positive, condition


# --- two parameters ---


def _region(
    p: Parameters | None, grazing_place: Place, question: GrazingQuestion, full: bool
) -> ParameterRegion:
    """Return the region of two parameters where the window has the property asked for.

    `full`: by the order "full".
    """
    if p is None:
        raise ParameterError(
            "p", p, "must be Parameters where a region of two parameters is asked for"
        )
    belt = f"v{grazing_place.boundary}"
    values = {name: rational(getattr(p, name)) for name in ("k", "B0", "Omega", belt)}
    values |= {name: QUERY_LETTERS[name] for name in question.names}
    level = grazing_place.side * values["k"] * values[belt]
    coefficient, _ = level.as_coeff_Mul()
    scale = abs(coefficient) or sp.S.One  # k > 2, not 25 k > 50
    level = level / scale
    Omega = values["Omega"] / scale
    drive = grazing_place.side * values["B0"] * Omega
    size = sp.Abs(values["B0"]) * Omega
    if question.asked == "contains":
        # The smallest value is where the sine is smallest if drive > 0, and where it is largest if
        # drive < 0.
        signs = [-1] * (not drive.is_negative) + [1] * (not drive.is_positive)
        theta = question.theta
        if isinstance(theta, PhaseInterval):
            decided = theta.deciding(signs)
        else:
            decided = [(theta, True)]
        condition = sp.And(*(_region_at(level, drive, extreme, full) for extreme in decided))
    elif question.asked == "empty":
        condition = CLOSED_REGION(-level, size)
    else:
        if full:
            condition = CLOSED_REGION(level, size)
        else:
            condition = OPEN_REGION(level, size)
        if full and not size.is_positive:
            condition = sp.And(condition, OPEN_REGION(level, 0))
    return ParameterRegion(question, condition, p)


def _region_at(level: Expr, drive: Expr, extreme: Extreme, full: bool) -> Expr:
    """Return the condition for a graze at a phase, `level` > -`drive` sin(theta).

    >= if the phase is an open end.
    """
    theta, attained = extreme
    left = level
    right = -drive * sp.sin(theta)
    if not attained:  # an open end
        return CLOSED_REGION(left, right)
    if full and sign_of(sp.cos(theta)) == 0 and not right.is_nonpositive:
        # The tangency of fourth order, where k v_lambda has the right sign.
        if right.is_positive:
            return CLOSED_REGION(left, right)
        return sp.Or(
            OPEN_REGION(left, right), sp.And(CLOSED_REGION(left, right), OPEN_REGION(left, 0))
        )
    return OPEN_REGION(left, right)
