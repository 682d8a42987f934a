"""Which numbered equations, lemmas, theorems, figures and sections of the paper the claims are on.

It is read from the sources of the claims, which say where in the paper a statement stands: "Theorem 4 (i), eqs. (26),
(32)" is on Theorem 4 and on two equations. "after eq. (19)" is a place, and no statement on (19).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from symosc.paper.claims import Claim, Unjudged


class Item(NamedTuple):
    """A numbered part of the paper, such as ("equation", 26); a section without a number has 0."""

    kind: str
    number: int

    @property
    def label(self) -> str:
        """Its name in the text, such as (26) or Lemma 1."""
        if self.kind == "equation":
            return f"({self.number})"
        return {("section", 0): "Abstract"}.get(self, f"{NAMES[self.kind]} {self.number}")


NAMES = {"section": "Section", "equation": "eq.", "lemma": "Lemma", "theorem": "Theorem", "figure": "Fig."}
#: The first and the last number of each kind.
EXTENT = {"section": (0, 7), "equation": (1, 66), "lemma": (1, 3), "theorem": (4, 7), "figure": (1, 10)}
#: All that there is in the paper.
PAPER = tuple(Item(kind, number) for kind, (first, last) in EXTENT.items() for number in range(first, last + 1))

WORDS = {
    "Sections?": "section",
    "eqs?[.]": "equation",
    "Lemmas?": "lemma",
    "Theorems?": "theorem",
    "Figs?[.]": "figure",
}
PLACE = re.compile(rf"(?:before|after) (?:{'|'.join(WORDS)}) [(]?\d+[)]?")
# One number of a list, with what joins it to the one before: "(26)", ", (32)", " and 5", " to (48)", ", (55.2)".
NUMBER = re.compile(r"(?P<joint>,? and |, | to | )[(]?(?P<number>\d+)(?:[.]\d+)?[)]?")


@dataclass
class Coverage:
    """What there is on an item: ids of claims, and reasons why a part of it gets no verdict."""

    claims: list[str] = field(default_factory=list)
    unjudged: list[Unjudged] = field(default_factory=list)

    def __bool__(self) -> bool:
        return bool(self.claims or self.unjudged)


def items_of(source: str) -> list[Item]:
    """Return the items that a source names: sections, equations, lemmas, theorems, figures.

    Examples
    --------
    >>> [item.label for item in items_of("Theorem 4 (i), eqs. (26), (32) to (34)")]
    ['(26)', '(32)', '(33)', '(34)', 'Theorem 4']
    >>> [item.label for item in items_of("Section 5, before eq. (54)")]
    ['Section 5']
    """
    found = [Item("section", 0)] if "Abstract" in source else []
    source = PLACE.sub("", source)
    for word, kind in WORDS.items():
        for start in re.finditer(rf"\b{word}", source):
            found += [Item(kind, number) for number in _numbers(source, start.end())]
    return list(dict.fromkeys(found))


def _numbers(source: str, at: int) -> Iterator[int]:
    last = 0
    while match := NUMBER.match(source, at):
        number, at = int(match["number"]), match.end()
        yield from range(last + 1, number) if match["joint"] == " to " else ()
        yield number
        last = number


def coverage(claims: Iterable[Claim], unjudged: Iterable[Unjudged] = ()) -> dict[Item, Coverage]:
    """Return what there is on each item of the paper, in the paper's order."""
    found = {item: Coverage() for item in PAPER}
    for claim in claims:
        for item in items_of(claim.source):
            found[item].claims.append(claim.id)
    for part in unjudged:
        for item in items_of(part.source):
            found[item].unjudged.append(part)
    return found
