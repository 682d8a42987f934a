"""What a chapter is made of beside steps, headings and prose: theorems with proofs, tables, figures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from symosc.derive.steps import Prose, Step

#: Environments with a number, in one count; a proof has none.
KINDS = {
    "definition": "Definition",
    "lemma": "Lemma",
    "proposition": "Proposition",
    "theorem": "Theorem",
    "corollary": "Corollary",
    "remark": "Remark",
    "example": "Example",
    "proof": "Proof",
}


class Begin(NamedTuple):
    """The begin of an environment.

    Attributes
    ----------
    kind : str
        A key of `KINDS`.
    title : str
        LaTeX text in parentheses behind the number, or of whom a proof is.
    label : str
        Its name for references, such as "thm:passing".
    """

    kind: str
    title: str = ""
    label: str = ""


class End(NamedTuple):
    """The end of an environment."""

    kind: str


class Table(NamedTuple):
    """A table.

    Attributes
    ----------
    label, caption : str
    heads : tuple of str
    rows : tuple of tuple of (str or Step)
        LaTeX texts; a step shows its right side, and its check has to pass.
    facts : tuple of Step
        Checks of what the texts say.
    columns : str
        LaTeX's letters for the columns; default: all as wide as their contents.
    """

    label: str
    caption: str
    heads: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]
    facts: tuple[Step, ...] = ()
    columns: str = ""


class Illustration(NamedTuple):
    """A figure: a key of `symosc.derive.figures.FIGURES`, its label, its caption and how wide it is (1: the text)."""

    key: str
    label: str
    caption: str
    width: float = 1.0


def block(kind: str, *parts: Any, title: str = "", label: str = "") -> Iterator[Any]:
    """Yield an environment with its parts; a text is a paragraph."""
    yield Begin(kind, title, label)
    yield from paragraphs(parts)
    yield End(kind)


def proof(*parts: Any, of: str = "") -> Iterator[Any]:
    """Yield a proof."""
    yield from block("proof", *parts, title=of)


def paragraphs(parts: Iterable[Any]) -> Iterator[Any]:
    """Yield parts, with texts as paragraphs and generators unrolled."""
    for part in parts:
        if isinstance(part, str):
            yield Prose(part)
        elif isinstance(part, Iterator):
            yield from paragraphs(part)
        else:
            yield part


def steps_of(item: Any) -> tuple[Step, ...]:
    """Return the steps of an item that have to be checked, in order."""
    if isinstance(item, Step):
        return (item,)
    if isinstance(item, Prose):
        return item.facts
    if isinstance(item, Table):
        return tuple(cell for row in item.rows for cell in row if isinstance(cell, Step)) + item.facts
    return ()
