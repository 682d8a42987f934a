"""The list of references: read from one BibTeX file, printed for each document without running BibTeX."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from symosc.derive.citation import bibtex
from symosc.derive.numbering import CITATION

ENTRY = re.compile(r"@(\w+)\{(\w+),\n(.*?)\n\}", re.DOTALL)
FIELD = re.compile(r"^\s*(\w+)\s*=\s*\{(.*)\},?$", re.MULTILINE)
ACCENT = {r"{\'o}": "ó", r"{\'a}": "á", r"{\'e}": "é"}


class Reference(NamedTuple):
    """An entry: its kind, its key, its fields."""

    kind: str
    key: str
    fields: dict[str, str]


def source() -> str:
    """Return the BibTeX of all references, symosc and the paper included."""
    return bibtex() + "\n\n" + files("symosc.derive").joinpath("references.bib").read_text(encoding="utf-8")


@cache
def entries() -> dict[str, Reference]:
    """Return all references by their keys."""
    found = (Reference(kind, key, dict(FIELD.findall(body))) for kind, key, body in ENTRY.findall(source()))
    return {each.key: each for each in found}


def cited(text: str) -> list[str]:
    """Return the keys that a LaTeX text cites, in the order of the list of references.

    Raises
    ------
    KeyError
        If one is not in the BibTeX file.
    """
    keys = {key.strip() for _, group in CITATION.findall(text) for key in group.split(",")}
    for key in keys:
        entries()[key]
    return sorted(keys, key=lambda key: (_family(key).lower(), entries()[key].fields["year"]))


def _family(key: str) -> str:
    return _plain(entries()[key].fields["author"]).strip("{}").removeprefix("the ").split(",")[0]


def line(key: str) -> str:
    """Return an entry as a line of LaTeX."""
    reference = entries()[key]
    get = reference.fields.get
    title = rf"\emph{{{get('title')}}}"
    if reference.kind == "article":
        place = f"{get('journal')} {get('volume')} ({get('year')}), {get('pages')}"
    elif reference.kind == "book":
        place = f"{get('publisher')}, {get('address')}, {get('year')}"
    else:
        place = f"{get('note')}, {get('year')}"
    doi = f", doi:{get('doi')}" if get("doi") else ""
    return f"{_authors(reference.fields['author'])}, {title}, {place}{doi}."


def _authors(text: str) -> str:
    if text.startswith("{"):
        return text.strip("{}")
    people = []
    for person in text.split(" and "):
        family, _, given = person.partition(", ")
        names = (part.split("-") for part in given.split(" "))
        initials = "~".join("-".join(each if each.endswith(".") else f"{each[0]}." for each in part) for part in names)
        people.append(f"{initials}~{family}")
    return people[0] if len(people) == 1 else f"{', '.join(people[:-1])} and {people[-1]}"


def environment(keys: list[str]) -> str:
    """Return the list of references as LaTeX."""
    rows = [rf"\bibitem{{{key}}} {line(key)}" for key in keys]
    return "\n".join([r"\begin{thebibliography}{99}", *rows, r"\end{thebibliography}"])


def _plain(text: str) -> str:
    for accent, letter in ACCENT.items():
        text = text.replace(accent, letter)
    return text


def plain_line(key: str) -> str:
    """Return an entry for HTML and Markdown: LaTeX text without accents as commands."""
    return re.sub(r"\{([A-Z])\}", r"\1", _plain(line(key)))
