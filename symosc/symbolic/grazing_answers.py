"""Answers to questions about parameters: what was asked, the values or the region, in print and in words."""

from __future__ import annotations

from typing import Any, NamedTuple

import sympy as sp

from symosc.aliases import Expr, NumberLike
from symosc.arguments import public
from symosc.display.drawable import Drawable
from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.mappings.latex import table
from symosc.model import Parameters
from symosc.symbolic.grazing_latex import latex
from symosc.symbolic.phase_interval import PhaseInterval
from symosc.symbolic.theorem7 import rational, sign_of

#: The letters of questions without numbers. v_lambda is the belt of the map, v_1 and v_2 stand in its range only.
QUERY_LETTERS = {
    "k": sp.Symbol("k", nonnegative=True),
    "v": sp.Symbol("v_lambda", real=True),
    "B0": sp.Symbol("B_0", real=True),
    "Omega": sp.Symbol("Omega", positive=True),
    "v1": sp.Symbol("v_1", real=True),
    "v2": sp.Symbol("v_2", real=True),
}
ASKS_PHASES, ASKS_NOTHING, ASKS_EVERYTHING = "contains", "empty", "everything"


class GrazingQuestion(NamedTuple):
    """What is asked: for which values of parameters the window of a map contains phases, is empty or everything.

    Attributes
    ----------
    mapping : str
    names : tuple of str
        One parameter or two.
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
        """Return the property in words."""
        if self.asked != ASKS_PHASES:
            return f"{self.mapping} grazes at {'no' if self.asked == ASKS_NOTHING else 'every'} phase"
        if isinstance(self.theta, PhaseInterval):
            return f"{self.mapping} grazes at every theta in {interval_text(self.theta.set())}"
        return f"{self.mapping} grazes at theta = {self.theta}"

    def latex(self) -> str:
        """Return the property as LaTeX."""
        name = f"P_{{{self.mapping.removeprefix('P')}}}"
        if self.asked != ASKS_PHASES:
            return rf"{name} \text{{ grazes at {'no' if self.asked == ASKS_NOTHING else 'every'} phase}}"
        interval = isinstance(self.theta, PhaseInterval)
        phases = rf"\in {latex(self.theta.set())}" if interval else f"= {latex(self.theta)}"
        return rf"{name} \text{{ grazes at {'every ' if interval else ''}}}\theta {phases}"


def interval_text(values: Expr) -> str:
    """Return a set in the notation of the paper."""
    if values.is_empty:
        return "the empty set"
    if isinstance(values, sp.Interval):
        return f"{'(' if values.left_open else '['}{values.start}, {values.end}{')' if values.right_open else ']'}"
    for kind, sign in ((sp.Union, " U "), (sp.Intersection, " & ")):
        if isinstance(values, kind):
            return sign.join(interval_text(part) for part in values.args)
    return str(values)


def condition_text(condition: Expr) -> str:
    """Return a condition in words and signs."""
    if isinstance(condition, sp.Eq):
        return f"{condition.lhs} = {condition.rhs}"
    if isinstance(condition, sp.And):
        return " and ".join(sorted(condition_text(each) for each in condition.args))
    if isinstance(condition, sp.Or):
        parts = [(condition_text(each), isinstance(each, sp.And)) for each in condition.args]
        return " or ".join(sorted(f"({text})" if joined else text for text, joined in parts))
    return str(condition)


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

    def latex(self) -> str:
        """Return "condition: values" as LaTeX (no dollar signs)."""
        return rf"{latex(self.condition)}:\quad {latex(self.values)}"


class Answers(tuple[Answer, ...]):
    """Answers for letters: one for each condition on the other parameters, of which exactly one holds.

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

    @classmethod
    def to(cls, question: GrazingQuestion, answers: Any) -> Answers:
        """Return the answers to a question."""
        made = cls(answers)
        made.question = question
        return made

    def text(self) -> str:
        """Return question and answers in words, a line for each condition."""
        name = QUERY_LETTERS[self.question.names[0]]
        lines = [
            f"  if {condition_text(answer.condition)}: {name} in {interval_text(answer.values)}" for answer in self
        ]
        return "\n".join([f"{self.question.text()}:", *lines])

    def latex(self) -> str:
        """Return the answers as a table in LaTeX (an array, no dollar signs)."""
        name = latex(QUERY_LETTERS[self.question.names[0]])
        rows = ((latex(answer.condition), latex(answer.values)) for answer in self)
        return table([self.question.latex(), rf"{name} \in"], rows)

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


class ParameterValues:
    """The values of one parameter that have a property; works like the sympy Set `values`, and prints itself.

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
        self.question, self.values = question, values

    def text(self) -> str:
        """Return question and answer in words."""
        if self.values.is_empty:
            return f"{self.question.text()} for no {self.question.names[0]}"
        return f"{self.question.text()} for {self.question.names[0]} in {interval_text(self.values)}"

    def latex(self) -> str:
        """Return question and answer as LaTeX (no dollar signs)."""
        name = latex(QUERY_LETTERS[self.question.names[0]])
        return rf"{self.question.latex()}:\quad {name} \in {latex(self.values)}"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"

    @public
    def __contains__(self, value: NumberLike) -> bool:
        name = self.question.names[0]
        if isinstance(value, sp.Basic) and value.free_symbols:
            raise ParameterError(name, value, "must be a number")
        exact = value if isinstance(value, sp.Basic) else rational(read_exact(name, value))
        return bool(self.values.contains(exact) == sp.true)

    def __getattr__(self, name: str) -> Any:
        """Return what the set has: boundary, is_subset, measure, ..."""
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


class ParameterRegion(Drawable):
    """The region of two parameters that has a property; `plot` draws it.

    Attributes
    ----------
    question : GrazingQuestion
    condition : sympy Boolean
        In the letters of both parameters; the others are numbers.
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

    def __init__(self, question: GrazingQuestion, condition: Expr, parameters: Parameters) -> None:
        self.question, self.condition, self.parameters = question, condition, parameters

    @property
    def allowed(self) -> Expr:
        """What Parameters allows for both, as a sympy Boolean; kept as it is written, though the letters know some."""
        found = {
            "k": sp.GreaterThan(QUERY_LETTERS["k"], 0, evaluate=False),
            "Omega": sp.StrictGreaterThan(QUERY_LETTERS["Omega"], 0, evaluate=False),
            "B0": sp.true,
            "v1": QUERY_LETTERS["v1"] < rational(self.parameters.v2),
            "v2": QUERY_LETTERS["v2"] > rational(self.parameters.v1),
        }
        return sp.And(*(found[name] for name in self.question.names if found[name] != sp.true), evaluate=False)

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
        if set(values) != set(self.question.names):
            raise ParameterError("values", ", ".join(values) or None, f"give {' and '.join(self.question.names)}")
        allowed = self.parameters.replace(**values)
        numbers = {QUERY_LETTERS[name]: rational(getattr(allowed, name)) for name in self.question.names}
        return holds(self.condition, numbers)

    def text(self) -> str:
        """Return question and answer in words."""
        where = f"where {condition_text(self.condition)}"
        where = {sp.true: "everywhere", sp.false: "nowhere"}.get(self.condition, where)
        return f"{self.question.text()} {where}"

    def latex(self) -> str:
        """Return the region as LaTeX (no dollar signs)."""
        names = ", ".join(latex(letter) for letter in self.letters)
        region = {sp.true: latex(self.allowed), sp.false: r"\text{nowhere}"}
        inside = region.get(self.condition, rf"{latex(self.allowed)},\ {latex(self.condition)}")
        return rf"{self.question.latex()}:\quad \left\{{({names}) : {inside}\right\}}"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"

    def __repr__(self) -> str:
        return f"<ParameterRegion: {self.text()}>"


def holds(condition: Expr, numbers: dict[Expr, Expr]) -> bool:
    """Return whether a condition holds for numbers; each comparison is decided exactly."""
    if condition in (sp.true, sp.false):
        return bool(condition)
    if isinstance(condition, sp.And):
        return all(holds(each, numbers) for each in condition.args)
    if isinstance(condition, sp.Or):
        return any(holds(each, numbers) for each in condition.args)
    sign = sign_of((condition.lhs - condition.rhs).subs(numbers))
    return {sp.Gt: sign > 0, sp.Ge: sign >= 0, sp.Lt: sign < 0, sp.Le: sign <= 0, sp.Eq: sign == 0}[condition.func]
