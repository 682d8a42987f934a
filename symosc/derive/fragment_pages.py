"""Fragments as LaTeX for an article that loads amsmath and nothing else, and as Markdown or text."""

from __future__ import annotations

import re
from typing import Any

import symosc
from symosc.derive import text_pages
from symosc.derive.blocks import Table, steps_of
from symosc.derive.displays import Display, cell, grouped, rows
from symosc.derive.document import Part
from symosc.derive.fragment_scope import FragmentScope
from symosc.derive.fragments import FRAGMENTS
from symosc.derive.latex import latex
from symosc.derive.numbering import Numbering
from symosc.derive.steps import Prose, Step, StepError, StepEvidence
from symosc.errors import ParameterError

ALONE = "\\documentclass{article}\n\\usepackage{amsmath}\n\\begin{document}\n"
PREFIX = "symosc"


class CheckedFragment:
    """A fragment whose steps have all passed; made like a chapter, but without a number."""

    number = 0

    def __init__(self, name: str, parts: list[Part]) -> None:
        self.key, self.title = name, FRAGMENTS[name].title
        self.parts = parts

    def steps(self) -> list[tuple[Step, StepEvidence]]:
        """Return every step with its evidence."""
        return [pair for part in self.parts for pair in zip(steps_of(part.item), part.evidence, strict=True)]


def check_fragment(name: str, scope: FragmentScope) -> CheckedFragment:
    """Build a fragment and check its steps.

    Raises
    ------
    ParameterError
        If there is no such fragment, or a number in it makes a formula meaningless.
    StepError
        If a check fails or cannot be decided.
    """
    if name not in FRAGMENTS:
        raise ParameterError("fragment", name, f"must be one of {', '.join(FRAGMENTS)}")
    parts = []
    numbers = ", ".join(f"${symbol} = {value}$" for symbol, value in scope.table())
    if numbers:
        several = len(scope.table()) > 1
        parts.append(Part(Prose(f"The {'numbers are' if several else 'number is'} {numbers}."), ()))
    for item in FRAGMENTS[name].items(scope):
        evidence = tuple(step.verify() for step in steps_of(item))
        parts.append(Part(item, evidence))
        for step in steps_of(item):
            _check_numbers(step, scope)
    return CheckedFragment(name, parts)


def _check_numbers(step: Step, scope: FragmentScope) -> None:
    import sympy as sp

    right = scope.shown(step.statement.right)
    if isinstance(right, sp.Expr) and right.has(sp.zoo, sp.nan, sp.oo):
        raise StepError(str(step.statement), "divides by 0 with these numbers")


def as_latex(
    fragment: CheckedFragment,
    scope: FragmentScope,
    prefix: str = PREFIX,
    paper_tags: bool = False,
    alone: bool = False,
) -> str:
    """Return a fragment as LaTeX.

    Parameters
    ----------
    prefix : str
        What its labels begin with: symosc:P3-f1.
    paper_tags : bool
        Give equations that are the paper's the paper's numbers, as hard tags.
    alone : bool
        Make it a document of its own.
    """
    if not re.fullmatch(r"[A-Za-z0-9.:_-]*", prefix):
        raise ParameterError("prefix", prefix, "may have letters, digits and . : _ - only")
    out = [_header(fragment, scope)]
    tags = FRAGMENTS[fragment.key].tags if paper_tags else {}
    out += [_piece(part, fragment, scope, prefix, tags) for part in grouped(fragment)]
    body = "\n".join(out).replace(r"\varnothing", r"\emptyset") + "\n"
    return f"{ALONE}{body}\\end{{document}}\n" if alone else body


def _header(fragment: CheckedFragment, scope: FragmentScope) -> str:
    numbers = " ".join(f"{name}={_shown(value)}" for name, value in scope.values)
    how = f"symosc derive {fragment.key}" + (f" --set {numbers.replace(' ', ' --set ')}" if numbers else "")
    how += f" --form {scope.form}" if scope.form != "entire" else ""
    how += f" --digits {scope.digits}" if scope.digits is not None else ""
    return (
        f"% {fragment.title.replace('$', '')}: {how} (symosc {symosc.__version__}).\n"
        "% Needs \\usepackage{amsmath}. Every formula was checked by machine before it was printed.\n"
    )


def _shown(value: Any) -> str:
    from symosc.exact import show

    return show(value)


def _label(label: str, fragment: CheckedFragment, prefix: str) -> str:
    return f"{prefix}{':' if prefix else ''}{fragment.key}-{label.removeprefix('eq:')}"


def _piece(part: Any, fragment: CheckedFragment, scope: FragmentScope, prefix: str, tags: dict[str, str]) -> str:
    if isinstance(part, Display):
        return _display(part, fragment, scope, prefix, tags)
    if isinstance(part.item, Prose):
        return str(part.item.text)
    table: Table = part.item
    lines = [" & ".join(cell(value, scope) for value in row) for row in table.rows]
    numbered = (tags.get(f"column{i}") for i in range(len(table.heads)))
    heads = [f"{head}, {tag}" if tag else head for head, tag in zip(table.heads, numbered, strict=True)]
    return "\n".join(
        [
            r"\begin{center}",
            rf"\begin{{tabular}}{{{'l' * len(table.heads)}}}",
            " & ".join(heads) + r" \\ \hline",
            *(line + (r" \\[8pt]" if r"\frac" in line else r" \\") for line in lines),
            r"\end{tabular}",
            r"\end{center}",
        ]
    )


def _display(
    display: Display, fragment: CheckedFragment, scope: FragmentScope, prefix: str, tags: dict[str, str]
) -> str:
    body = []
    for lines, each in rows(display, scope):
        tag = rf" \tag{{{tags[each.step.label]}}}" if each.step.label in tags else ""
        body += [rf"{line} \notag" for line in lines[:-1]]
        body.append(rf"{lines[-1]}{tag} \label{{{_label(each.label, fragment, prefix)}}}")
    joined = " \\\\\n".join(body)
    words = f"{display.reason}\n" if display.reason else ""
    return f"{words}\\begin{{align}}\n{joined}\n\\end{{align}}"


def as_markdown(fragment: CheckedFragment, scope: FragmentScope) -> str:
    """Return a fragment as Markdown."""
    return text_pages.markdown(fragment, scope, Numbering([]))


def as_text(fragment: CheckedFragment, scope: FragmentScope) -> str:
    """Return a fragment as plain text."""
    return text_pages.text(fragment, scope, Numbering([]))


def log(fragment: CheckedFragment) -> list[dict[str, Any]]:
    """Return what a program wants to know of each step."""
    return [
        {"statement": f"{latex(s.statement.left)} {s.statement.op} {latex(s.statement.right)}", **evidence._asdict()}
        for s, evidence in fragment.steps()
    ]
