r"""The parts of a chapter: LaTeX text, and steps, each with the check that it must pass.

A chapter has texts (also ``\subsection{...}``, ``\begin{theorem}[title]\label{...}`` and
``\end{theorem}``), `Step`, `facts` (checks of the paragraph before), `Table` and `Illustration`, in
tuples or lists nested as needed. Steps that follow each other share a display. A check is run on
the statement that is printed. It raises `StepError`, or ends as

    exact     sympy reduces a difference to 0, or the solution of an equation is verified exactly
    sign      the sign of an expression follows from the signs of its letters, or from exact numbers
    numeric   both sides agree with 50 digits at the given root, or a printed decimal to its last digit
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from inspect import isfunction
from typing import Any, NamedTuple

import sympy as sp
from sympy.core.function import AppliedUndef

from symosc.base.aliases import Expr
from symosc.base.errors import SymoscError
from symosc.kernels.multiprecision import mp_context
from symosc.symbolic import solution

Items = Iterable[Any]

STEP_DIGITS = 50
CONTEXT = mp_context(STEP_DIGITS + 10)
# What two sides that are equal may differ by, relative to their largest term, with 10 guard digits.
STEP_AGREEMENT = CONTEXT.mpf(10) ** -45
DIFFERENT = CONTEXT.mpf(10) ** -30
#: Functions that a numeric refutation can evaluate.
KNOWN = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.coth, sp.sign, sp.asin, sp.Abs)


class StepError(SymoscError):
    """Raised if the check of a step fails or cannot decide; `statement` is what was to be shown."""

    def __init__(self, statement: str, reason: str) -> None:
        self.statement = statement
        self.reason = reason
        super().__init__(f"{statement}: {reason}")


class StepEvidence(NamedTuple):
    """How a step was shown: kind ("exact", "sign", "numeric"), difference or reason, points tried
    (0: a proof).
    """

    kind: str
    margin: str
    points: int = 0


@dataclass(frozen=True)
class Step:
    """One displayed line: a statement, its check, its name for references in the chapter, and LaTeX
    text after it.
    """

    left: Expr
    op: str  # one of = > < >= <= in
    right: Expr  # a set after "in"
    check: Callable[[Step], StepEvidence]
    label: str = ""
    note: str = ""
    decimals: bool = False  # print numbers as decimals where they end, also outside scenes

    def __str__(self) -> str:
        return f"{self.left} {self.op} {self.right}"

    def verify(self) -> StepEvidence:
        """Check the step and return the evidence; StepError if it fails."""
        return self.check(self)


def step(
    left: Expr, op: str, right: Expr, check: Any = None, label: str = "", **options: Any
) -> Step:
    """Return the step ``left op right``, which has to pass a check."""
    if not isfunction(check):
        if isinstance(check, dict):
            meanings = check
        else:
            meanings = {left: check}
        check = exact({} if check is None else meanings)
    return Step(sp.sympify(left), op, sp.sympify(right), check, label, **options)


def equation(left: Expr, right: Expr, check: Any = None, label: str = "", **options: Any) -> Step:
    """Return the step left = right."""
    return step(left, "=", right, check, label, **options)


# --- the parts of a chapter ---

#: Environments with a number, in one count; a proof has none.
KINDS = ("definition", "lemma", "proposition", "theorem", "corollary", "remark", "example", "proof")
_MARKUP = re.compile(
    rf"\\(begin)\{{({'|'.join(KINDS)})\}}(?:\[([^]]*)\])?(?:\\label\{{([^{{}}]*)\}})?|\\(end)\{{({'|'.join(KINDS)})\}}"
    r"|\\(subsection)\{((?:[^{}]|\{[^{}]*\})*)\}"
)


class Markup(NamedTuple):
    """A LaTeX command: a subsection with its title, or the beginning or end of an environment such
    as a theorem.
    """

    command: str
    name: str
    title: str = ""
    label: str = ""


class Prose(NamedTuple):
    """A paragraph, with steps that check the facts that it states in words."""

    text: str
    facts: tuple[Step, ...] = ()


def facts(*steps: Step) -> Prose:
    """Return an item that attaches steps to the preceding paragraph, as checks of what it states in
    words.
    """
    return Prose("", steps)


class Table(NamedTuple):
    """A table; a cell is LaTeX text, or a step that shows its right side.

    `columns` is LaTeX's, such as "lrr".
    """

    label: str
    caption: str
    heads: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]
    facts: tuple[Step, ...] = ()
    columns: str = ""


class Illustration(NamedTuple):
    """A figure: its key in `symosc.derive.figures.FIGURES`, label, caption, and width as a part of
    the text's width.
    """

    key: str
    label: str
    caption: str
    width: float = 1.0


def flat(parts: Items) -> list[Any]:
    """Return the parts of a chapter as one flat list, with texts split into headings, environments
    and paragraphs.
    """
    items: list[Any] = []
    for part in parts:
        if isinstance(part, str):
            end_of_last = 0
            for mark in _MARKUP.finditer(part):
                items.append(Prose(part[end_of_last : mark.start()].strip()))
                begin, kind, title, label, end, ended, subsection, heading = (
                    group or "" for group in mark.groups()
                )
                items.append(
                    Markup(begin or end or subsection, kind or ended or heading, title, label)
                )
                end_of_last = mark.end()
            items.append(Prose(part[end_of_last:].strip()))
        elif isinstance(part, Prose):
            # Facts belong to the last paragraph before them.
            last = max(i for i, item in enumerate(items) if isinstance(item, Prose) and item.text)
            items[last] = Prose(items[last].text, part.facts)
        elif type(part) in (tuple, list) or isinstance(part, Iterator):
            items += flat(part)
        else:
            items.append(part)
    return [item for item in items if not isinstance(item, Prose) or item.text]


def steps_of(item: Any) -> tuple[Step, ...]:
    """Return the steps of an item that have to be checked, in order."""
    if isinstance(item, Step):
        return (item,)
    if isinstance(item, Table):
        all_cells = [cell for row in item.rows for cell in row]
        cells = [cell for cell in all_cells if isinstance(cell, Step)]
    else:
        cells = []
    return (*cells, *getattr(item, "facts", ()))


# --- checks: each returns the evidence for a step, or raises StepError ---

Check = Callable[[Step], StepEvidence]
Meaning = dict[Expr, Any]


def exact(
    meaning: Meaning | None = None,
    tidy: Callable[[Expr], Expr] = sp.expand,
    independent: bool = True,
) -> Check:
    """Return the check that both sides are equal once `meaning` has been put in for the symbols
    that it defines.

    `tidy` rewrites the difference, which has to become 0. Unless the symbols that are left are not
    `independent`, random values first try to refute the equality: of these symbols, and with a
    motion's true basis functions.
    """
    # `meaning` has an independent expression by its name, and is applied until nothing changes.
    # What `tidy` leaves is simplified.

    def check(statement: Step) -> StepEvidence:
        difference = resolve(statement.left, meaning) - resolve(statement.right, meaning)
        if independent:
            _refute(statement, difference)
        _vanish(statement, tidy(difference), "the difference {} does not vanish")
        return StepEvidence("exact", "0")

    return check


def cases(*checks: Check) -> Check:
    """Return a check that runs several checks, one for each meaning of the symbols, such as belt 1
    and belt 2.
    """

    def check(statement: Step) -> StepEvidence:
        kinds = {part(statement).kind for part in checks}
        kind = next(kind for kind in ("numeric", "sign", "exact") if kind in kinds)
        return StepEvidence(kind, f"{len(checks)} cases")

    return check


def solves(
    force: Expr,
    start: Expr,
    rate: Expr,
    cm: Expr = solution.cm,
    w0sq: Expr = solution.w0sq,
    meaning: Any = None,
) -> Check:
    """Return the check that y = right side solves y'' + cm y' + w0sq y = `force`, y(0) = `start`,
    y'(0) = `rate`.
    """
    # Only one function does this, so every sign is checked. `meaning` is as for `exact`.

    def check(statement: Step) -> StepEvidence:
        # Whether it is written in the basis functions, which are the same in all regimes.
        general = statement.right.has(*solution.BASIS)

        def differentiate(expr: sp.Expr) -> sp.Expr:
            if general:
                return solution.time_derivative(expr)
            return expr.diff(solution.tau)

        y = resolve(statement.right, meaning)
        first = differentiate(y)
        at_start = solution.start_values() | {solution.tau: sp.Integer(0)}
        residuals = (
            differentiate(first) + cm * first + w0sq * y - resolve(force, meaning),
            y.subs(at_start) - start,
            first.subs(at_start) - rate,
        )
        if general:
            tidy = solution.use_relations
        else:
            tidy = modes
        # A random point refutes a wrong statement at once, where the proof would take long.
        for residual in residuals:
            remainder = resolve(residual, meaning)
            _refute(statement, remainder)
            _vanish(statement, tidy(remainder), "does not solve its equation: {} remains")
        return StepEvidence("exact", "0")

    return check


def modes(expr: Expr) -> Expr:
    """Return a function of tau as a sum of modes (products of tau, exp, sin, ...), or 0 if it
    always vanishes.
    """
    expr = sp.expand_trig(expr)
    waves = sorted(expr.atoms(sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh), key=sp.default_sort_key)
    # Modes count as independent symbols here: the expression vanishes for all their values if its
    # numerator does.
    above, _ = sp.fraction(
        sp.together(expr.xreplace(dict(zip(waves, (sp.Dummy() for _ in waves), strict=True))))
    )
    if sp.expand(above) == 0:
        return sp.S.Zero
    return solution.collect_modes(expr)


def sign(meaning: Meaning | None = None) -> Check:
    """Return the check of an inequality that follows from the signs of its symbols, or holds
    between exact numbers.
    """

    def check(statement: Step) -> StepEvidence:
        difference = resolve(statement.left, meaning) - resolve(statement.right, meaning)
        difference = sp.factor(sp.simplify(difference))
        wanted = {">": "positive", "<": "negative", ">=": "nonnegative", "<=": "nonpositive"}[
            statement.op
        ]
        holds = getattr(difference, f"is_{wanted}")
        if not holds:
            raise StepError(
                str(statement),
                f"the sign of {difference} is {'wrong' if holds is False else 'undecided'}",
            )
        return StepEvidence(
            "sign", str(difference) if difference.is_Rational else "by the signs of its letters"
        )

    return check


def close(value: Callable[[], Any], decimals: int) -> Check:
    """Return the check that the decimal on the right is a computed value, up to half a unit of its
    last digit.
    """

    def check(statement: Step) -> StepEvidence:
        off = abs(CONTEXT.mpf(value()) - CONTEXT.mpf(statement.right.p) / statement.right.q)
        return _within(statement, off, CONTEXT.mpf(10) ** -decimals * CONTEXT.mpf("0.5000001"))

    return check


def decimal(
    name: str, number: Any, decimals: int, check: Check | None = None, **options: Any
) -> Step:
    """Return the step "name = number", with the number rounded to `decimals` decimals."""
    check = check or close(lambda: number, decimals)
    return step(
        sp.Symbol(name, real=True), "=", rounded(number, decimals), check, decimals=True, **options
    )


def at_root(meaning: Callable[[], Meaning], tolerance: Any = STEP_AGREEMENT) -> Check:
    """Return the check that a statement holds with 50 digits at the numbers that `meaning` returns,
    such as a root.
    """

    def check(statement: Step) -> StepEvidence:
        values = meaning()
        left, right = (evaluate(side, values) for side in (statement.left, statement.right))
        if statement.op == "=":
            return _within(statement, abs(left - right), tolerance)
        if not {">": left > right, "<": left < right}[statement.op]:
            raise StepError(
                str(statement), f"is wrong: {CONTEXT.nstr(left, 8)} and {CONTEXT.nstr(right, 8)}"
            )
        return StepEvidence("numeric", CONTEXT.nstr(abs(left - right), 5), 1)

    return check


def _within(statement: Step, off: Any, tolerance: Any) -> StepEvidence:
    """Return evidence if `off`, the difference of both sides, is within a tolerance; else raise
    StepError.
    """
    if not off <= tolerance:
        raise StepError(str(statement), f"the sides differ by {CONTEXT.nstr(off, 3)}")
    return StepEvidence("numeric", CONTEXT.nstr(off, 2), 1)


# --- tools ---


def resolve(expr: Expr, meaning: Meaning | None) -> Expr:
    """Replace names in an expression by their meanings until no such name is left."""
    expr = sp.sympify(expr)
    meanings = {name: sp.sympify(value) for name, value in (meaning or {}).items()}
    for _ in range(10):  # a meaning in its own terms would go on for ever
        if expr.free_symbols.isdisjoint(meanings):
            break
        expr = expr.xreplace(meanings)
        if expr.has(sp.Derivative):
            expr = expr.doit(deep=False)
    return expr


def points(expr: Expr, count: int) -> Iterator[dict[Expr, Any]]:
    """Yield random values of an expression's symbols that their assumptions allow, the same in
    every run.
    """
    letters = sorted(expr.free_symbols, key=str)
    dice = random.Random(20161031)
    for _ in range(count):
        point = {letter: sp.Rational(dice.randint(100, 4999), 1009) for letter in letters}
        yield {q: z if q.is_nonnegative else z * dice.choice((-1, 1)) for q, z in point.items()}


def evaluate(expr: Expr, point: dict[Expr, Any]) -> Any:
    """Evaluate an expression at a point with 60 digits."""
    value = expr.subs(point, simultaneous=True)
    if value.free_symbols:
        raise StepError(str(expr), f"{sorted(map(str, value.free_symbols))} have no value")
    number = sp.N(value, STEP_DIGITS + 10, maxn=400)
    if not number.is_real:
        raise StepError(str(expr), f"is not real at {point}")
    return CONTEXT.mpf(number._to_mpmath(CONTEXT.prec))


def number(value: Any) -> Any:
    """Return a number of any kind as an mpmath number of 60 digits."""
    if isinstance(value, Fraction):
        return CONTEXT.mpf(value.numerator) / value.denominator
    return CONTEXT.mpf(value)


def rounded(number: Any, decimals: int) -> Any:
    """Return a number rounded to some decimals, as an exact rational number."""
    return sp.Rational(int(CONTEXT.nint(CONTEXT.mpf(number) * 10**decimals)), 10**decimals)


def _vanish(statement: Step, rest: Expr, complaint: str) -> None:
    """Raise StepError unless the expression `rest` is 0.

    The message is `complaint` with `rest` for its {}.
    """
    if rest != 0 and sp.simplify(rest) != 0:
        raise StepError(str(statement), complaint.format(rest))


def _refute(statement: Step, difference: Expr) -> None:
    """Raise StepError if a difference that should vanish is not 0 at one random point; 0 there
    proves nothing.
    """
    difference = _sampled(difference)
    has_no_value = difference.atoms(sp.Function) - difference.atoms(*KNOWN)
    if difference == 0 or has_no_value or difference.has(sp.Derivative):
        return
    value = sp.N(difference.xreplace(next(points(difference, 1))), 40, maxn=120)
    if value.is_number and value.is_finite and abs(value) > DIFFERENT:
        raise StepError(str(statement), f"the sides differ, for example by {sp.N(value, 5)}")


@cache
def generic_basis() -> dict[Expr, Expr]:
    """Return the five basis functions of a flight, by their symbols, for two different
    characteristic roots.
    """
    mean = sp.Symbol("r", positive=True)
    half = sp.Symbol("q", positive=True)
    regime = solution.Regime("two roots", sp.true, -mean, half, {})
    return regime.basis() | regime.parameters()


@cache
def _motion_sample() -> dict[Expr, Expr]:
    """Return numbers for the basis functions and the letters that they depend on, all from one
    motion.
    """
    # The letters of `generic_basis`, and any rational numbers: nothing holds by accident.
    mean = sp.Symbol("r", positive=True)
    half = sp.Symbol("q", positive=True)
    letters = {mean: 37, half: 23, solution.tau: 11, solution.Omega: 29, solution.m: 17}
    numbers = {letter: sp.Rational(value, 19) for letter, value in letters.items()}
    values = {name: sp.N(value.subs(numbers), 60) for name, value in generic_basis().items()}
    c_over_m = generic_basis()[solution.cm].subs(numbers)
    k_over_m = generic_basis()[solution.w0sq].subs(numbers)
    values |= {solution.cm: c_over_m, solution.w0sq: k_over_m}
    values |= {
        solution.c: c_over_m * numbers[solution.m],
        solution.k: k_over_m * numbers[solution.m],
    }
    return values | {name: numbers[name] for name in (solution.tau, solution.Omega, solution.m)}


def _sampled(expr: Expr) -> Expr:
    """Return an expression with functions in place of their names.

    What holds for all holds for these.
    """
    if expr.has(*solution.BASIS):
        expr = expr.xreplace(_motion_sample())
    names = sorted(expr.atoms(AppliedUndef), key=str)
    # A different cubic for each function of a letter; its coefficients are any rational numbers.
    cubics = {}
    for n, name in enumerate(names):
        argument = name.args[0]
        if argument.is_Symbol:
            cubics[name] = sum(
                sp.Rational(3 * n + power + 2, 5 + power) * argument**power for power in range(4)
            )
    if cubics:
        return expr.subs(cubics).doit()
    return expr
