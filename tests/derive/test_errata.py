"""One list of errata: complete and in order, and the supplement, the report and the letter have all of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from symosc.derive import document
from symosc.derive.chapters import errata as chapter_of_errata
from symosc.derive.errata import SEVERITIES, Erratum, read_errata
from symosc.derive.numbering import REFERENCE
from symosc.derive.records import RecordsError
from symosc.derive.scope import Scope
from symosc.derive.steps import Prose

FOUND = read_errata()
ERRATUM = """
[[erratum]]
id = "one"
severity = "typo"
where = "Eq. (1)"
printed = "a"
holds = "b"
proof = "c"
"""
COMMITTED = Path(__file__).parents[2] / "derivations"


def test_each_has_its_number_and_is_short() -> None:
    assert [erratum.number for erratum in FOUND] == list(range(1, len(FOUND) + 1))
    assert {erratum.severity for erratum in FOUND} == set(SEVERITIES)
    for erratum in (each.in_unicode() for each in FOUND):
        assert len(erratum.proof) <= 340, erratum.id
        assert len(erratum.printed) + len(erratum.holds) <= 340, erratum.id


def in_supplement() -> list[tuple[str, str, str]]:
    """Return number, place and severity of each erratum in the printed chapter."""
    text = (COMMITTED / document.FRAGMENTS_FOLDER / "errata.tex").read_text(encoding="utf-8")
    return re.findall(r"^\\textbf\{(\d+)\.\}~(.*?) \((\w+)\)\. \\emph\{Printed:\}", text, re.MULTILINE)


def test_the_supplement_has_each_erratum_once_with_its_number_and_severity() -> None:
    assert in_supplement() == [(str(each.number), each.where, each.severity) for each in FOUND]


def test_the_supplement_counts_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many as there are in the list, by severity, whatever the list is."""

    def made_up() -> tuple[Erratum, ...]:
        return (*FOUND[:3], Erratum(4, "new", "wrong", "Eq. (99)", "p", "h", "q"))

    monkeypatch.setattr(chapter_of_errata, "read_errata", made_up)
    first, *rest = [item.text for item in chapter_of_errata._list() if isinstance(item, Prose)]
    assert "the 4 distinct" in first
    counted = {word: int(count) for count, word in re.findall(r"(\d+) are \\emph\{(\w+)\}", first)}
    assert counted == {key: sum(each.severity == key for each in made_up()) for key in SEVERITIES}
    assert rest[-1].startswith(r"\textbf{4.}~Eq. (99) (wrong). \emph{Printed:} p \emph{Right:} h \emph{Proof.} q")


def test_what_shows_an_erratum_is_in_the_supplement() -> None:
    text = "".join(path.read_text(encoding="utf-8") for path in (COMMITTED / document.FRAGMENTS_FOLDER).glob("*.tex"))
    labels = set(re.findall(r"\\label\{([^{}]*)\}", text))
    named = [label for erratum in FOUND for _, label in REFERENCE.findall(erratum.shown)]
    assert len(named) > 10
    assert set(named) <= labels


@pytest.mark.parametrize("form", ["html", "markdown", "text"])
def test_every_format_has_all_of_them(form: str) -> None:
    checked = document.Checked("errata", "Errata", [document.Part(each, ()) for each in chapter_of_errata._list()])
    text = document.FORMATS[form](checked, Scope())
    assert re.findall(r"(?:\*\*|<strong>|^)(\d+)\.(?:\*\*|</strong>)?(?:&nbsp;| )", text, re.MULTILINE)[
        -len(FOUND) :
    ] == [str(each.number) for each in FOUND]
    assert "\\" not in re.sub(r"\$[^$]*\$", "", text)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (('"typo"', '"slip"'), "severity = 'slip': must be one of wrong, gap, typo"),
        (('proof = "c"', ""), "must have id, severity, where, printed, holds, proof"),
        (('proof = "c"', 'proof = "c"\nseen = "d"'), "must have id, severity, where, printed, holds, proof"),
        (('proof = "c"', 'proof = " "'), "must be text"),
        (('id = "one"', 'id = "One!"'), "must be kebab case"),
        (("[[erratum]]", "[[error]]"), "may only have"),
    ],
)
def test_wrong_errata_are_refused(tmp_path: Path, change: tuple[str, str], complaint: str) -> None:
    path = tmp_path / "errata.toml"
    path.write_text(ERRATUM, encoding="utf-8")
    assert [erratum.id for erratum in read_errata(path)] == ["one"]
    path.write_text(ERRATUM.replace(*change), encoding="utf-8")
    with pytest.raises(RecordsError, match=complaint):
        read_errata(path)
    path.write_text(ERRATUM * 2, encoding="utf-8")
    with pytest.raises(RecordsError, match="twice"):
        read_errata(path)
