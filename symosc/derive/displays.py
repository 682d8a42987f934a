"""Displays: steps that stand together under one reason, and the rows that each formula takes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from symosc.derive import line_breaks
from symosc.derive.latex import latex
from symosc.derive.numbering import equation_label
from symosc.derive.scope import Scope
from symosc.derive.steps import Relation, Step, StepEvidence
from symosc.derive.words import plain_words

#: How a step was checked, behind its number.
MARKS = {"exact": "e", "sign": "s", "numeric": "n"}


@dataclass(frozen=True)
class Numbered:
    """A displayed step: its number, its label, and how it was checked."""

    number: str
    label: str
    step: Step
    evidence: StepEvidence

    @property
    def mark(self) -> str:
        """The letter that tells how it was checked."""
        return MARKS[self.evidence.kind]


@dataclass
class Display:
    """Steps that share one display, and the words before it."""

    reason: str
    steps: list[Numbered]


def grouped(chapter: Any) -> Iterator[Any]:
    """Yield the parts of a checked chapter; steps without a reason join the display of the step before."""
    display: Display | None = None
    count = 0
    for part in chapter.parts:
        if not isinstance(part.item, Step):
            if display:
                yield display
            display = None
            yield part
            continue
        count += 1
        label = equation_label(part.item, chapter.key, count)
        entry = Numbered(
            f"{chapter.number}.{count}" if chapter.number else str(count), label, part.item, part.evidence[0]
        )
        if part.item.reason or display is None:
            if display:
                yield display
            display = Display(part.item.reason, [])
        display.steps.append(entry)
    if display:
        yield display


def marks(part: Any) -> str:
    """Return the letters of the checks behind a sentence or a table, each once, such as "e,n"."""
    return ",".join(dict.fromkeys(MARKS[evidence.kind] for evidence in part.evidence))


def shown(statement: Relation, scope: Scope) -> Relation:
    """Return a statement as it is printed in a scope."""
    return statement._replace(left=scope.shown(statement.left), right=scope.shown(statement.right))


def rows(display: Display, scope: Scope) -> list[tuple[list[str], Numbered]]:
    """Return for each step of a display the rows of LaTeX that it takes, `left &= right` first."""
    decimals = scope.decimal or any(each.step.decimals for each in display.steps)
    statements = [shown(each.step.statement, scope) for each in display.steps]
    left = max(line_breaks.width(latex(statement.left, decimals)) for statement in statements)
    found = []
    for each, statement in zip(display.steps, statements, strict=True):
        lines = line_breaks.lines(statement, decimals, left)
        if each.step.note:
            joined = rf"{lines[-1]} \quad\text{{{each.step.note}}}"
            if line_breaks.width(lines[-1]) + 0.7 * len(plain_words(each.step.note)) < line_breaks.LINE_WIDTH - 4:
                lines[-1] = joined
            else:
                lines.append(rf"&\quad \text{{{each.step.note}}}")
        found.append((lines, each))
    return found


def cell(value: Any, scope: Scope) -> str:
    """Return a cell of a table as LaTeX; a step shows its right side."""
    if not isinstance(value, Step):
        return str(value)
    decimals = scope.decimal or value.decimals
    return rf"$\displaystyle {latex(shown(value.statement, scope).right, decimals)}$"
