"""The list of references: one BibTeX file, every citation with a complete entry."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from symosc.derive import bibliography, document
from symosc.derive.chapters import CHAPTERS
from symosc.derive.numbering import CITATION

COMMITTED = Path(__file__).parents[2] / "derivations"
TEXTS = {key: (COMMITTED / document.FRAGMENTS_FOLDER / f"{key}.tex").read_text(encoding="utf-8") for key in CHAPTERS}
MAIN = (COMMITTED / document.MAIN).read_text(encoding="utf-8")


def test_every_citation_has_an_entry_and_every_entry_is_complete() -> None:
    cited = bibliography.cited("".join(TEXTS.values()) + MAIN)
    assert {"chen2016", "filippov1988", "luo2008", "polya1922", "mccurdy1984", "denhartog1931"} <= set(cited)
    assert set(cited) == set(bibliography.entries())
    for reference in bibliography.entries().values():
        needed = {"article": {"journal", "volume", "pages"}, "book": {"publisher", "address"}, "misc": {"note"}}
        assert set(reference.fields) >= {"author", "title", "year"} | needed[reference.kind], reference.key
        assert re.fullmatch(r"\d{4}", reference.fields["year"])
        doi = reference.fields.get("doi", "10.1/x")
        assert re.fullmatch(r"10\.\d+/\S+", doi), doi


def test_the_list_of_references_is_the_one_of_the_bibtex_file() -> None:
    listed = re.findall(r"\\bibitem\{(\w+)\}", MAIN)
    assert listed == bibliography.cited("".join(TEXTS.values()) + MAIN)
    assert (COMMITTED / document.BIBTEX).read_text(encoding="utf-8") == bibliography.source()


def test_an_unknown_citation_is_refused() -> None:
    with pytest.raises(KeyError):
        bibliography.cited(r"\cite{nobody1900}")
    assert CITATION.findall(r"\cite[Chapter 2]{filippov1988}") == [("Chapter 2", "filippov1988")]


def test_one_entry_as_a_line() -> None:
    assert bibliography.line("luo2008") == (
        r"A.~C.~J.~Luo, \emph{A theory for flow switchability in discontinuous dynamical systems}, "
        r"Nonlinear Analysis: Hybrid Systems 2 (2008), 1030--1061."
    )
    assert bibliography.line("hongliu2000").startswith("H.-K.~Hong and C.-S.~Liu,")
    assert bibliography.line("dibernardo2008").startswith("M.~di Bernardo, C.~J.~Budd,")
    assert bibliography.line("denhartog1930").startswith("J.~P.~Den Hartog,")
    assert "Pólya" in bibliography.plain_line("polya1922")


def test_what_is_from_memory_is_marked_in_the_source_alone() -> None:
    """Every entry of others says what it was compared with, or that something of it was not; no print says it."""
    for key, reference in bibliography.entries().items():
        if key in ("symosc", "chen2016"):
            continue
        fields = dict(reference.fields)
        doubts = [word.strip() for word in fields.pop("unchecked", "").split(",") if word.strip()]
        assert fields.pop("checked", None) or "title" in doubts, key
        assert set(doubts) <= set(fields), key
    assert "unchecked" in bibliography.source()
    assert "not checked" not in MAIN + "".join(map(bibliography.plain_line, bibliography.entries()))
