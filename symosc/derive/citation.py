"""How to cite symosc and the paper that it recomputes: the home of all bibliographic data.

CITATION.cff says the same for machines; a test compares the two.
"""

from __future__ import annotations

from symosc import __version__

SYMOSC = {
    "author": "{the symosc developers}",
    "title": "symosc: exact event-driven solutions of the double-belt friction oscillator",
    "year": "2026",
    "note": f"Version {__version__}",
}
PAPER = {
    "author": "Chen, Ge and Fan, Jinjun",
    "title": "Analysis of dynamical behaviors of a double belt friction-oscillator model",
    "journal": "WSEAS Transactions on Mathematics",
    "volume": "15",
    "year": "2016",
    "pages": "357--373",
    "issn": "2224-2880",
}


def bibtex() -> str:
    """Return BibTeX entries of symosc and of the paper.

    Examples
    --------
    >>> print(bibtex().splitlines()[0])
    @misc{symosc,
    """
    return f"{_entry('misc', 'symosc', SYMOSC)}\n\n{_entry('article', 'chen2016', PAPER)}"


def paper_reference(title: str = "{}", space: str = " ", dash: str = "\N{EN DASH}") -> str:
    r"""Return the paper as a line of a list of references.

    Parameters
    ----------
    title : str
        What to put around the title, such as ``r"\emph{{{}}}"`` in LaTeX.
    space, dash : str
        Between initials and names, and between the page numbers.

    Examples
    --------
    >>> paper_reference(title="*{}*", dash="-")[:51]
    'G. Chen and J. Fan, *Analysis of dynamical behavior'
    """
    people = [person.split(", ") for person in PAPER["author"].split(" and ")]
    authors = " and ".join(f"{given[0]}.{space}{family}" for family, given in people)
    pages = PAPER["pages"].replace("--", dash)
    journal = f"{PAPER['journal']} {PAPER['volume']} ({PAPER['year']})"
    return f"{authors}, {title.format(PAPER['title'])}, {journal}, {pages}"


def _entry(kind: str, key: str, fields: dict[str, str]) -> str:
    lines = [f"  {name:<7} = {{{value}}}," for name, value in fields.items()]
    return "\n".join([f"@{kind}{{{key},", *lines, "}"])
