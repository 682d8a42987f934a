"""The data beside the chapters: references, the errata, and LaTeX as Unicode."""

from __future__ import annotations

import pickle
import re
from pathlib import Path

import pytest
from project_files import PROJECT, cff, text

import symosc
from symosc.derive import citation, document
from symosc.derive.chapters import CHAPTERS
from symosc.derive.errata import RecordsError, read_errata

COMMITTED = Path(__file__).parents[2] / "derivations"
MAIN = (COMMITTED / document.MAIN).read_text(encoding="utf-8")
TEXTS = [
    (COMMITTED / document.CHAPTER_FOLDER / f"{key}.tex").read_text(encoding="utf-8")
    for key in CHAPTERS
]
ERRATUM = """
[one]
severity = "typo"
where = "Eq. (1)"
printed = "a"
holds = "b"
proof = "c"
"""


# --- references ---


def test_citation_file_and_bibtex_agree() -> None:
    tool = cff()
    paper = cff("    ")
    assert {"cff-version", "message", "title", "version", "date-released"} <= set(tool)
    assert tool["version"] == symosc.__version__
    assert tool["title"] == citation.SYMOSC["title"]
    assert tool["license"] == PROJECT["license"]
    assert tool["date-released"][:4] == citation.SYMOSC["year"]
    assert f"{{{cff('  - ')['name']}}}" == citation.SYMOSC["author"]
    assert [cff("  - ")["name"]] == [author["name"] for author in PROJECT["authors"]]
    people = re.findall(r"family-names: (\w+)\n +given-names: (\w+)", text("CITATION.cff"))
    assert (
        " and ".join(f"{family}, {forenames}" for family, forenames in people)
        == citation.PAPER["author"]
    )
    assert f"{paper['start']}--{paper['end']}" == citation.PAPER["pages"]
    for name in ("title", "journal", "volume", "year", "issn"):
        assert paper[name] == citation.PAPER[name], name
    keywords = re.search(r"^keywords:\n((?:  - .+\n)+)", text("CITATION.cff"), re.M)
    assert keywords is not None
    assert re.findall(r"- (.+)", keywords[1]) == PROJECT["keywords"]


def test_every_citation_has_an_entry_and_every_entry_is_complete() -> None:
    cited = citation.cited("".join(TEXTS) + MAIN)
    assert set(cited) == set(citation.entries())
    assert re.findall(r"\\bibitem\{(\w+)\}", MAIN) == cited
    assert (COMMITTED / document.BIBTEX).read_text(encoding="utf-8") == citation.references_bib()
    for reference in citation.entries().values():
        needed = {
            "article": {"journal", "volume", "pages"},
            "book": {"publisher", "address"},
            "misc": {"note"},
        }
        assert set(reference.fields) >= {"author", "title", "year"} | needed[reference.kind], (
            reference.key
        )
        assert re.fullmatch(r"\d{4}", reference.fields["year"])
        doi = reference.fields.get("doi", "10.1/x")
        assert re.fullmatch(r"10\.\d+/\S+", doi), doi


# --- errata ---


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (('"typo"', '"slip"'), "severity = 'slip': must be one of wrong, gap, typo"),
        (('proof = "c"', ""), "must have severity, where, printed, holds, proof"),
        (
            ('proof = "c"', 'proof = "c"\nseen = "d"'),
            "must have severity, where, printed, holds, proof",
        ),
        (('proof = "c"', "proof = 3"), "proof = 3: must be text"),
        (("[one]", '["One!"]'), "must be kebab case"),
        (("[one]", "[one"), "cannot be read"),
    ],
)
def test_wrong_errata_are_refused(tmp_path: Path, change: tuple[str, str], complaint: str) -> None:
    path = tmp_path / "errata.toml"
    path.write_text(ERRATUM, encoding="utf-8")
    assert [erratum.id for erratum in read_errata(path)] == ["one"]
    path.write_text(ERRATUM.replace(*change), encoding="utf-8")
    with pytest.raises(RecordsError, match=complaint) as caught:
        read_errata(path)
    assert "\n" not in str(caught.value)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
