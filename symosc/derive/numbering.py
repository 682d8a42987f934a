"""Numbers of equations, theorems, tables and figures, and what references to them print.

LaTeX counts for itself, by the same rules (a test compares); the other formats need the numbers from here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

from symosc.derive.blocks import KINDS, Begin, Illustration, Table
from symosc.derive.chapters import CHAPTERS
from symosc.derive.steps import Step

REFERENCE = re.compile(r"\\(eqref|ref)\{([^{}]*)\}")
CITATION = re.compile(r"\\cite(?:\[([^\]]*)\])?\{([^{}]*)\}")
#: Label prefixes of environments; "thm:maps-flight" is in the chapter maps.
PREFIXES = ("eq", "thm", "tab", "fig", "sec")


class Numbering:
    """The number of every label in some chapters.

    Attributes
    ----------
    of : dict of str to str
        Label -> number, such as "eq:motion-newton" -> "1.2".
    """

    def __init__(self, chapters: Iterable[tuple[str, list[Any]]]) -> None:
        self.of: dict[str, str] = {}
        for key, items in chapters:
            self._count(key, items)

    def _count(self, key: str, items: list[Any]) -> None:
        number = chapter_number(key)
        self.of[f"sec:{key}"] = str(number)
        counts = {"eq": 0, "thm": 0, "tab": 0, "fig": 0}
        for item in items:
            for kind, label in _labels(item, key, counts):
                counts[kind] += 1
                if label in self.of:
                    raise ValueError(f"label {label} is used twice")
                self.of[label] = f"{number}.{counts[kind]}"

    def known(self, label: str) -> bool:
        """Tell whether a label is in these chapters."""
        return label in self.of


def chapter_number(key: str) -> int:
    """Return the number of a chapter in the whole document."""
    return list(CHAPTERS).index(key) + 1


def equation_label(step: Step, key: str, count: int) -> str:
    """Return the label of a displayed step that is the `count`-th of its chapter."""
    return f"eq:{step.label or f'{key}-{count}'}"


def _labels(item: Any, key: str, counts: dict[str, int]) -> list[tuple[str, str]]:
    if isinstance(item, Step):
        return [("eq", equation_label(item, key, counts["eq"] + 1))]
    if isinstance(item, Begin) and item.kind in KINDS and item.kind != "proof":
        return [("thm", item.label or f"thm:{key}-{counts['thm'] + 1}")]
    if isinstance(item, Table):
        return [("tab", item.label)]
    if isinstance(item, Illustration):
        return [("fig", item.label)]
    return []


def chapter_of(label: str) -> str:
    """Return the chapter that a label belongs to by its name."""
    return label.partition(":")[2].partition("-")[0]


def elsewhere(label: str) -> str:
    """Return what stands for a reference to a chapter that is not in this document."""
    return f"Chapter~{chapter_number(chapter_of(label))}"


#: "Theorem~\ref{...}" with its word, so that both are replaced where the target is in another document.
WORDED = re.compile(
    r"(?:(Theorem|Lemma|Definition|Corollary|Proposition|Remark|Example|Table|Figure|Section|Chapter|Eq\.)~)?"
    r"\\(eqref|ref)\{([^{}]*)\}"
)


def resolved(text: str, numbers: Numbering | None, link: Callable[[str, str], str] | None = None) -> str:
    """Return a text with its references replaced by numbers.

    Parameters
    ----------
    text : str
    numbers : Numbering or None
        None: every reference is to another document.
    link : callable, optional
        Makes of (label, shown) what is printed; None for targets elsewhere only, other references are left alone.
    """

    def replace(found: re.Match[str]) -> str:
        word, command, label = found.groups()
        if numbers is None or not numbers.known(label):
            return elsewhere(label)
        if link is None:
            return found[0]
        shown = f"({numbers.of[label]})" if command == "eqref" else numbers.of[label]
        return (f"{word}~" if word else "") + link(label, shown)

    return WORDED.sub(replace, text)
