"""A checked chapter as Markdown (formulas between double dollars) and as plain text."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from symosc.derive.bibliography import entries, plain_line
from symosc.derive.blocks import KINDS, Begin, End, Illustration, Table
from symosc.derive.displays import Display, cell, grouped, marks, rows, shown
from symosc.derive.latex import plain
from symosc.derive.numbering import CITATION, Numbering, resolved
from symosc.derive.scope import Scope
from symosc.derive.steps import Heading, Prose
from symosc.derive.words import plain_words

Words = Callable[[str], str]


def markdown(checked: Any, scope: Scope, numbers: Numbering) -> str:
    """Return a chapter as Markdown."""
    return _chapter(checked, scope, numbers, markdown_words, _markdown_display, _markdown_heading)


def text(checked: Any, scope: Scope, numbers: Numbering) -> str:
    """Return a chapter as plain text."""
    return _chapter(checked, scope, numbers, plain_words, _text_display, _underlined)


def _markdown_heading(text: str, level: int) -> str:
    return f"{'#' * level} {text}"


def _underlined(text: str, level: int) -> str:
    return f"{text}\n{('=', '-')[level - 1] * len(text)}"


def markdown_words(text: str) -> str:
    """Return a LaTeX paragraph as Markdown."""
    text = re.sub(r"\\emph\{([^{}]*)\}", r"*\1*", text)
    text = re.sub(r"\\textbf\{([^{}]*)\}", r"**\1**", text)
    text = re.sub(r"\\texttt\{([^{}]*)\}", r"`\1`", text)
    text = re.sub(r"\\textsc\{([^{}]*)\}", r"\1", text).replace(r"P\'olya", "Pólya")
    text = text.replace("-{}-", "\0").replace("~", " ").replace("--", "–").replace("\0", "--")
    return text.replace("``", '"').replace("''", '"').replace(r"\ ", " ")


def _chapter(
    checked: Any,
    scope: Scope,
    numbers: Numbering,
    words: Words,
    display: Callable[..., str],
    heading: Callable[[str, int], str],
) -> str:
    def said(text: str) -> str:
        return words(_referred(text, numbers))

    number = f"{checked.number}. " if checked.number else ""
    out, counts = [heading(number + said(checked.title), 1)], [0, 0, 0]
    cited: list[str] = []
    for part in grouped(checked):
        cited += [key for key in _cited(part) if key not in cited]
        if isinstance(part, Display):
            out.append(display(part, scope, said))
            continue
        item = part.item
        if isinstance(item, Heading):
            out.append(heading(said(item.text), 2))
        elif isinstance(item, Prose):
            out.append(said(item.text) + (f" [{marks(part)}]" if part.evidence else ""))
        elif isinstance(item, Begin):
            out.append(_opening(item, checked.number, counts, said, bold="**" if words is markdown_words else ""))
        elif isinstance(item, End):
            out += ["∎" if item.kind == "proof" else ""] if words is markdown_words else []
        elif isinstance(item, Table):
            counts[1] += 1
            out.append(_table(item, f"Table {checked.number}.{counts[1]}", marks(part), scope, said))
        elif isinstance(item, Illustration):
            counts[2] += 1
            out.append(f"Figure {checked.number}.{counts[2]}. {said(item.caption)}")
    references = [f"[{key}] {words(plain_line(key))}" for key in cited]
    return "\n\n".join(piece for piece in [*out, *references] if piece) + "\n"


def _opening(item: Begin, number: int, counts: list[int], said: Words, bold: str) -> str:
    title = f" ({said(item.title)})" if item.title else ""
    if item.kind == "proof":
        return f"*Proof{title}.*" if bold else f"Proof{title}."
    counts[0] += 1
    return f"{bold}{KINDS[item.kind]} {number}.{counts[0]}{title}.{bold}"


def _referred(text: str, numbers: Numbering) -> str:
    text = resolved(text, numbers, lambda label, number: number)
    return CITATION.sub(lambda found: f"[{found[2]}{', ' + found[1] if found[1] else ''}]", text)


def _cited(part: Any) -> list[str]:
    texts = [part.reason] if isinstance(part, Display) else [str(getattr(part.item, "text", ""))]
    if not isinstance(part, Display) and isinstance(part.item, Begin | Illustration | Table):
        texts = [str(value) for value in part.item]
    keys = [key.strip() for text in texts for _, group in CITATION.findall(text) for key in group.split(",")]
    return [key for key in keys if key in entries()]


def _markdown_display(display: Display, scope: Scope, said: Words) -> str:
    found = rows(display, scope)
    numbers = ", ".join(f"{each.number} {each.evidence.kind}" for _, each in found)
    body = " \\\\\n".join(line for lines, _ in found for line in lines)
    formula = f"$$\n\\begin{{aligned}}\n{body}\n\\end{{aligned}}\n$$\n\n({numbers})"
    return f"{said(display.reason)}\n\n{formula}" if display.reason else formula


def _text_display(display: Display, scope: Scope, said: Words) -> str:
    found = [said(display.reason)] if display.reason else []
    for each in display.steps:
        statement = shown(each.step.statement, scope)
        note = f"   {said(each.step.note)}" if each.step.note else ""
        line = f"{plain(statement.left)} {statement.op} {plain(statement.right)}"
        found.append(f"    {line}{note}   ({each.number} {each.evidence.kind})")
    return "\n".join(found)


def _table(table: Table, name: str, checked: str, scope: Scope, said: Words) -> str:
    from tabulate import tabulate

    body = [[said(cell(value, scope)) for value in row] for row in table.rows]
    form = "simple" if said("$x_i$") == "x_i" else "github"
    shown_table = tabulate(body, [said(head) for head in table.heads], tablefmt=form, disable_numparse=True)
    return f"{name}. {said(table.caption)}{f' [{checked}]' if checked else ''}\n\n{shown_table}"
