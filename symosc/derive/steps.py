"""A derivation is a list of steps: a statement, the reason for it in words, and the check that it has to pass.

The check is run on the statement itself, so what is printed is what was checked. A check ends as

    exact     sympy reduces a difference to 0, or the solution of an equation is verified exactly
    sign      the sign of an expression follows from the signs of its letters, or from exact numbers
    numeric   both sides agree with 50 digits at the root that is meant, or a printed decimal to its last digit

or it raises `StepError`: then nothing is printed.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import sympy as sp

from symosc.errors import SymoscError
from symosc.kernels.multiprecision import mp_context
from symosc.symbolic import solution

Expr = Any  # sympy ships no types

STEP_DIGITS = 50
CONTEXT = mp_context(STEP_DIGITS + 10)
STEP_POINTS = 24
# What two sides that are equal may differ by, relative to their largest term, with 10 guard digits.
STEP_AGREEMENT = CONTEXT.mpf(10) ** -45
# Enough to refute a wrong statement without a proof attempt.
REFUTATION_POINTS = 1
DIFFERENT = CONTEXT.mpf(10) ** -30


class StepError(SymoscError):
    """A step whose check failed or could not be decided.

    Attributes
    ----------
    statement : str
        What could not be shown.
    """

    def __init__(self, statement: str, reason: str) -> None:
        self.statement, self.reason = statement, reason
        super().__init__(f"{statement}: {reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.statement, self.reason)


class Relation(NamedTuple):
    """What a step states: left, one of = > < >= <= in, right (a set after "in")."""

    left: Expr
    op: str
    right: Expr

    def __str__(self) -> str:
        return f"{self.left} {self.op} {self.right}"


class StepEvidence(NamedTuple):
    """How a step was checked.

    Attributes
    ----------
    kind : {"exact", "sign", "numeric"}
    margin : str
        exact: "0". numeric: the largest relative difference. sign: what decided it.
    points : int
        Random points, 0 for a proof.
    """

    kind: str
    margin: str
    points: int = 0


class Check:
    """Base class of the checks; `run` returns the evidence or raises StepError."""

    def run(self, statement: Relation) -> StepEvidence:
        """Check a statement."""
        raise NotImplementedError


@dataclass(frozen=True)
class Step:
    """One displayed line. An empty reason continues the display of the step before.

    Attributes
    ----------
    statement : Relation
    reason : str
        LaTeX text that stands before the display.
    check : Check
    note : str
        LaTeX text behind the formula, such as a condition.
    decimals : bool
        Print numbers as decimals where they end, also outside scenes.
    label : str
        Its name for references, such as "motion-newton" (LaTeX: eq:motion-newton).
    """

    statement: Relation
    reason: str
    check: Check
    note: str = ""
    decimals: bool = False
    label: str = ""

    def verify(self) -> StepEvidence:
        """Run the check."""
        return self.check.run(self.statement)


class Heading(NamedTuple):
    """A subsection's title (LaTeX text)."""

    text: str


class Prose(NamedTuple):
    """A paragraph between steps (LaTeX text), with checks of the facts that it states in words."""

    text: str
    facts: tuple[Step, ...] = ()


def equation(left: Expr, right: Expr, reason: str, check: Check, note: str = "", label: str = "") -> Step:
    """Return the step left = right."""
    return Step(Relation(sp.sympify(left), "=", sp.sympify(right)), reason, check, note, label=label)


def fact(left: Expr, op: str, right: Expr, check: Check) -> Step:
    """Return a step that is checked but not displayed: what a sentence says."""
    return Step(Relation(sp.sympify(left), op, sp.sympify(right)), "", check)


# --- checks ---


@dataclass(frozen=True)
class Exact(Check):
    """The sides are equal once each name is replaced by what it stands for.

    Attributes
    ----------
    meaning : dict
        Name -> independent expression (or a function that returns it), applied again until nothing changes.
    tidy : callable
        Reduces a difference that vanishes to 0.
    independent : bool
        Whether the letters that are left are independent of each other, so that random values may refute a statement.
    """

    meaning: dict[Expr, Any] = field(default_factory=dict)
    tidy: Callable[[Expr], Expr] = sp.simplify
    independent: bool = True

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        difference = resolve(statement.left, self.meaning) - resolve(statement.right, self.meaning)
        if self.independent:
            _refute(statement, difference)
        rest = self.tidy(difference)
        if rest != 0 and sp.simplify(rest) != 0:
            raise StepError(str(statement), f"the difference {rest} does not vanish")
        return StepEvidence("exact", "0")


@dataclass(frozen=True)
class Each(Check):
    """The statement passes several checks: one for each thing that its letters stand for, such as the two belts."""

    checks: tuple[Check, ...]

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        kinds = {each.run(statement).kind for each in self.checks}
        kind = next(kind for kind in ("numeric", "sign", "exact") if kind in kinds)
        return StepEvidence(kind, f"{len(self.checks)} cases")


@dataclass(frozen=True)
class Solves(Check):
    """The right side, plus `shift`, is the solution y of D y = force with y(0), y'(0) given.

    With D = d^2/dtau^2 + cm d/dtau + w0sq. Only one function does this, so the check pins down every sign.
    """

    force: Expr
    start: Expr
    rate: Expr
    cm: Expr = solution.cm
    w0sq: Expr = solution.w0sq
    shift: Expr = sp.S.Zero
    general: bool = False
    meaning: dict[Expr, Expr] = field(default_factory=dict)

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        y = resolve(statement.right + self.shift, self.meaning)
        differentiate = solution.time_derivative if self.general else _by_tau
        first = differentiate(y)
        second = differentiate(first)
        at_start = solution.start_values() | {solution.tau: sp.Integer(0)}
        residuals = (
            second + self.cm * first + self.w0sq * y - resolve(self.force, self.meaning),
            y.subs(at_start) - self.start,
            first.subs(at_start) - self.rate,
        )
        tidy = solution.use_relations if self.general else modes
        for residual in residuals:
            if not self.general:
                _refute(statement, residual)
            rest = tidy(resolve(residual, self.meaning))
            if rest != 0 and sp.simplify(rest) != 0:
                raise StepError(str(statement), f"does not solve its equation: {rest} is left over")
        return StepEvidence("exact", "0")


def _by_tau(expr: Expr) -> Expr:
    return expr.diff(solution.tau)


def modes(expr: Expr) -> Expr:
    """Return 0 for an expression in modes (products of tau, exp, sin, ...) that vanishes, else their sum."""
    expr = sp.expand_trig(expr)
    found = sorted(expr.atoms(sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh), key=sp.default_sort_key)
    letters = dict(zip(found, (sp.Dummy() for _ in found), strict=True))
    # What vanishes for all values of its modes needs no more than its numerator.
    above, _ = sp.fraction(sp.together(expr.xreplace(letters)))
    return sp.S.Zero if sp.expand(above) == 0 else solution.collect_modes(expr)


@dataclass(frozen=True)
class Sign(Check):
    """An inequality that follows from the signs of the letters, or is between exact numbers."""

    meaning: dict[Expr, Any] = field(default_factory=dict)

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        difference = resolve(statement.left, self.meaning) - resolve(statement.right, self.meaning)
        difference = sp.factor(sp.simplify(difference))
        holds = {
            ">": difference.is_positive,
            "<": difference.is_negative,
            ">=": difference.is_nonnegative,
            "<=": difference.is_nonpositive,
        }[statement.op]
        if not holds:
            raise StepError(str(statement), f"the sign of {difference} is {'wrong' if holds is False else 'undecided'}")
        return StepEvidence("sign", str(difference) if difference.is_Rational else "by the signs of its letters")


@dataclass(frozen=True)
class Close(Check):
    """The printed decimal on the right is the computed value on the left to half a unit of its last digit."""

    value: Callable[[], Any]
    decimals: int

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        off = abs(CONTEXT.mpf(self.value()) - CONTEXT.mpf(statement.right.p) / statement.right.q)
        if not off <= CONTEXT.mpf(10) ** -self.decimals * CONTEXT.mpf("0.5000001"):
            raise StepError(str(statement), f"the value is off by {CONTEXT.nstr(off, 3)}")
        return StepEvidence("numeric", CONTEXT.nstr(off, 2), 1)


@dataclass(frozen=True)
class AtRoot(Check):
    """The sides agree with 50 digits at a given point; `tolerance` is absolute."""

    meaning: Callable[[], dict[Expr, Any]]
    tolerance: Any = STEP_AGREEMENT

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        values = self.meaning()
        left, right = (evaluate(side, values) for side in (statement.left, statement.right))
        if statement.op == "=":
            off = abs(left - right)
            if not off < self.tolerance:
                raise StepError(str(statement), f"the sides differ by {CONTEXT.nstr(off, 3)}")
            return StepEvidence("numeric", CONTEXT.nstr(off, 2), 1)
        if not {">": left > right, "<": left < right}[statement.op]:
            raise StepError(str(statement), f"is wrong: {CONTEXT.nstr(left, 8)} and {CONTEXT.nstr(right, 8)}")
        return StepEvidence("numeric", CONTEXT.nstr(abs(left - right), 5), 1)


@dataclass(frozen=True)
class Near(Check):
    """The sides are numbers that agree to so many decimals."""

    decimals: int

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        left, right = (evaluate(side, {}) for side in (statement.left, statement.right))
        off = abs(left - right)
        if not off < CONTEXT.mpf(10) ** -self.decimals * max(abs(right), 1):
            raise StepError(str(statement), f"the sides differ by {CONTEXT.nstr(off, 3)}")
        return StepEvidence("numeric", CONTEXT.nstr(off, 2), 1)


# --- tools ---


def resolve(expr: Expr, meaning: dict[Expr, Any]) -> Expr:
    """Replace names by their meanings until none is left."""
    expr = sp.sympify(expr)
    for _ in range(10):
        used = {name: value for name, value in meaning.items() if name in expr.free_symbols}
        if not used:
            return expr
        expr = expr.xreplace({name: sp.sympify(value() if callable(value) else value) for name, value in used.items()})
        expr = expr.doit(deep=False) if expr.has(sp.Derivative) else expr
    return expr


def points(expr: Expr, sample: Any = None, count: int = STEP_POINTS) -> Iterator[dict[Expr, Any]]:
    """Yield random points that the assumptions on the letters (or `sample`) allow, always the same ones."""
    letters = sorted(expr.free_symbols, key=lambda symbol: symbol.name)
    dice = random.Random(20161031)
    for _ in range(count):
        if sample is not None:
            point = sample(dice)
        else:
            point = {letter: sp.Rational(dice.randint(100, 4999), 1009) for letter in letters}
            point = {q: z if q.is_nonnegative else z * dice.choice((-1, 1)) for q, z in point.items()}
        yield point


def evaluate(expr: Expr, point: dict[Expr, Any]) -> Any:
    """Return an expression at a point with 60 digits."""
    value = expr.subs(point, simultaneous=True)
    if value.free_symbols:
        raise StepError(str(expr), f"{sorted(map(str, value.free_symbols))} have no value")
    number = sp.N(value, STEP_DIGITS + 10, maxn=400)
    if not number.is_real:
        raise StepError(str(expr), f"is not real at {point}")
    return CONTEXT.mpf(number._to_mpmath(CONTEXT.prec))


def rounded(number: Any, decimals: int) -> Any:
    """Return a number as an exact decimal."""
    return sp.Rational(int(CONTEXT.nint(CONTEXT.mpf(number) * 10**decimals)), 10**decimals)


def _refute(statement: Relation, difference: Expr) -> None:
    """Raise StepError if a difference that should vanish clearly does not: no proof is tried then."""
    if difference == 0 or difference.atoms(sp.Function) - difference.atoms(*KNOWN) or difference.has(sp.Derivative):
        return
    for point in points(difference, count=REFUTATION_POINTS):
        value = sp.N(difference.subs(point, simultaneous=True), 40, maxn=120)
        if value.is_number and value.is_finite and abs(value) > DIFFERENT:
            raise StepError(str(statement), f"the sides differ, for example by {sp.N(value, 5)}")


#: Functions that a numeric refutation can evaluate.
KNOWN = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.sign, sp.asin, sp.Abs)
