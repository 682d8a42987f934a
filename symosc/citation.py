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

#: Published results on the oscillator with Coulomb friction that symosc is compared with, by BibTeX key.
LITERATURE = {
    "denhartog1930": {
        "author": "Den Hartog, Jacob Pieter",
        "title": "Forced vibrations with combined viscous and Coulomb damping",
        "journal": "Philosophical Magazine (Series 7)",
        "volume": "9",
        "number": "59",
        "year": "1930",
        "pages": "801--817",
    },
    "denhartog1931": {
        "author": "Den Hartog, Jacob Pieter",
        "title": "Forced vibrations with combined Coulomb and viscous friction",
        "journal": "Transactions of the American Society of Mechanical Engineers",
        "volume": "53",
        "number": "APM-53-9",
        "year": "1931",
        "pages": "107--115",
    },
    "shaw1986": {
        "author": "Shaw, Steven W.",
        "title": "On the dynamic response of a system with dry friction",
        "journal": "Journal of Sound and Vibration",
        "volume": "108",
        "number": "2",
        "year": "1986",
        "pages": "305--325",
        "doi": "10.1016/S0022-460X(86)80058-X",
    },
    "hongliu2000": {
        "author": "Hong, Hong-Ki and Liu, Chein-Shan",
        "title": "Coulomb friction oscillator: modelling and responses to harmonic loads and base excitations",
        "journal": "Journal of Sound and Vibration",
        "volume": "229",
        "number": "5",
        "year": "2000",
        "pages": "1171--1192",
    },
    "csernak2007": {
        "author": "Csernák, Gábor and Stépán, Gábor and Shaw, Steven W.",
        "title": "Sub-harmonic resonant solutions of a harmonically excited dry friction oscillator",
        "journal": "Nonlinear Dynamics",
        "volume": "50",
        "number": "1--2",
        "year": "2007",
        "pages": "93--109",
        "doi": "10.1007/s11071-006-9145-6",
    },
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
    return reference(PAPER, title, space, dash)


def reference(fields: dict[str, str], title: str = "{}", space: str = " ", dash: str = "\N{EN DASH}") -> str:
    """Return an article as a line of a list of references, its DOI last.

    Parameters
    ----------
    fields : dict
        `PAPER`, or an entry of `LITERATURE`.
    title, space, dash : str
        As in `paper_reference`.

    Examples
    --------
    >>> reference(LITERATURE["hongliu2000"])[:42]
    'H.-K. Hong and C.-S. Liu, Coulomb friction'
    """
    people = [person.split(", ") for person in fields["author"].split(" and ")]
    names = [space.join([*map(_initial, given.split()), family]) for family, given in people]
    authors = " and ".join([", ".join(names[:-1]), names[-1]] if names[1:] else names)
    pages = fields["pages"].replace("--", dash)
    journal = f"{fields['journal']} {fields['volume']} ({fields['year']})"
    doi = f", doi:{fields['doi']}" if "doi" in fields else ""
    return f"{authors}, {title.format(fields['title'])}, {journal}, {pages}{doi}"


def _initial(name: str) -> str:
    return "-".join(f"{part[0]}." for part in name.split("-"))


def _entry(kind: str, key: str, fields: dict[str, str]) -> str:
    lines = [f"  {name:<7} = {{{value}}}," for name, value in fields.items()]
    return "\n".join([f"@{kind}{{{key},", *lines, "}"])
