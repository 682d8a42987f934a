"""The home of all bibliographic data: how to cite symosc and the paper, and the list of references.

The list is read from BibTeX and printed without running it. CITATION.cff says the same for
machines; a test compares.
"""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from symosc import __version__

#: A citation in a LaTeX text: what is written behind it, and its keys.
CITATION = re.compile(r"\\cite(?:\[([^\]]*)\])?\{([^{}]*)\}")
_ENTRY = re.compile(r"@(\w+)\{(\w+),\n(.*?)\n\}", re.DOTALL)
_FIELD = re.compile(r"^\s*(\w+)\s*=\s*\{(.*)\},?$", re.MULTILINE)
_ACCENTS = {r"{\'o}": "ó", r"{\'a}": "á", r"{\'e}": "é", r"{\"o}": "ö"}


def references_bib() -> str:
    """Return the BibTeX of all references, those of symosc and of the paper first."""
    return (
        files("symosc.derive")
        .joinpath("references.bib")
        .read_text(encoding="utf-8")
        .replace("VERSION", __version__)
    )


def bibtex() -> str:
    """Return BibTeX entries of symosc and of the paper."""
    return "\n\n".join(references_bib().split("\n\n")[:2])


def paper_reference(title: str = "{}", space: str = " ", dash: str = "\N{EN DASH}") -> str:
    """Return the paper's entry for a bibliography.

    `title` formats its title, `space` and `dash` replace ~ and --.
    """
    line = reference_line("chen2016").removesuffix(".").replace("~", space).replace("--", dash)
    return re.sub(r"\\emph\{(.*)\}", lambda match: title.format(match[1]), line)


class Reference(NamedTuple):
    """A BibTeX entry: its kind (such as "article"), its key, and its fields by name."""

    kind: str
    key: str
    fields: dict[str, str]


@cache
def entries() -> dict[str, Reference]:
    """Return all references by their keys."""
    matches = _ENTRY.findall(references_bib())
    return {key: Reference(kind, key, dict(_FIELD.findall(body))) for kind, key, body in matches}


def cited(text: str) -> list[str]:
    """Return the keys that a LaTeX text cites, sorted by author and year.

    KeyError for an unknown key.
    """

    def place(key: str) -> tuple[str, str]:
        fields = entries()[key].fields
        return plain_text(fields["author"]).strip("{}").removeprefix("the ").split(",")[
            0
        ].lower(), fields["year"]

    return sorted(
        {key.strip() for _, group in CITATION.findall(text) for key in group.split(",")}, key=place
    )


#: What stands behind the title of each kind of entry.
PLACES = {
    "article": "{journal} {volume} ({year}), {pages}",
    "book": "{publisher}, {address}, {year}",
    "misc": "{note}, {year}",
}


def reference_line(key: str) -> str:
    """Return a reference as a line of LaTeX: authors, title, place, doi."""
    kind, _, fields = entries()[key]
    if "doi" in fields:
        doi = f", doi:{fields['doi']}"
    else:
        doi = ""
    place = PLACES[kind].format_map(fields)
    return rf"{_authors_text(fields['author'])}, \emph{{{fields['title']}}}, {place}{doi}."


def _authors_text(text: str) -> str:
    """Return the author field of BibTeX, such as "Luo, Albert C. J. and Gegg, Brandon C.", as
    "A.~C.~J.~Luo and B.~C.~Gegg".
    """
    if text.startswith("{"):  # an organisation
        return text.strip("{}")
    people = []
    for person in text.split(" and "):
        family, _, forenames = person.partition(", ")
        initials = "~".join(map(_initials, forenames.split(" ")))
        people.append(f"{initials}~{family}")
    *others, last_person = people
    if not others:
        return last_person
    return f"{', '.join(others)} and {last_person}"


def _initials(forename: str) -> str:
    """Return the initials of a forename, such as J.-P. of Jean-Pierre."""
    words = forename.split("-")
    return "-".join(word if word.endswith(".") else f"{word[0]}." for word in words)


def reference_list(keys: list[str]) -> str:
    """Return the list of references as LaTeX."""
    rows = [rf"\bibitem{{{key}}} {reference_line(key)}" for key in keys]
    return "\n".join([r"\begin{thebibliography}{99}", *rows, r"\end{thebibliography}"])


def plain_line(key: str) -> str:
    """Return a reference for HTML and Markdown: its LaTeX line with accented letters instead of
    accent commands.
    """
    return re.sub(r"\{([A-Z])\}", r"\1", plain_text(reference_line(key)))


def plain_text(text: str) -> str:
    """Return LaTeX text in which accented letters replace the commands for accents."""
    for accent, letter in _ACCENTS.items():
        text = text.replace(accent, letter)
    return text


SYMOSC = entries()["symosc"].fields
PAPER = entries()["chen2016"].fields
