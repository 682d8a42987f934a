"""The data beside the chapters: references, the errata, and LaTeX as Unicode."""

from __future__ import annotations

import pickle
import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from project_files import PROJECT, cff, text

import symosc
from symosc.cli.app import main
from symosc.derive import citation, document
from symosc.derive.chapters import CHAPTERS
from symosc.derive.errata import SEVERITIES, RecordsError, latex_to_unicode, read_errata
from symosc.scenes import load_scene, scene_names

COMMITTED = Path(__file__).parents[2] / "derivations"
MAIN = (COMMITTED / document.MAIN).read_text(encoding="utf-8")
TEXTS = [(COMMITTED / document.CHAPTER_FOLDER / f"{key}.tex").read_text(encoding="utf-8") for key in CHAPTERS]
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
    tool, paper = cff(), cff("    ")
    assert {"cff-version", "message", "title", "version", "date-released"} <= set(tool)
    assert tool["version"] == symosc.__version__
    assert tool["title"] == citation.SYMOSC["title"]
    assert tool["license"] == PROJECT["license"]
    assert tool["date-released"][:4] == citation.SYMOSC["year"]
    assert f"{{{cff('  - ')['name']}}}" == citation.SYMOSC["author"]
    assert [cff("  - ")["name"]] == [author["name"] for author in PROJECT["authors"]]
    people = re.findall(r"family-names: (\w+)\n +given-names: (\w+)", text("CITATION.cff"))
    assert " and ".join(f"{family}, {given}" for family, given in people) == citation.PAPER["author"]
    assert f"{paper['start']}--{paper['end']}" == citation.PAPER["pages"]
    for name in ("title", "journal", "volume", "year", "issn"):
        assert paper[name] == citation.PAPER[name], name
    keywords = re.search(r"^keywords:\n((?:  - .+\n)+)", text("CITATION.cff"), re.M)
    assert keywords is not None
    assert re.findall(r"- (.+)", keywords[1]) == PROJECT["keywords"]


def test_cite_prints_both_entries() -> None:
    result = CliRunner().invoke(main, ["--cite"])
    assert (result.exit_code, result.stderr) == (0, "")
    for entry, fields in zip(result.stdout.split("\n\n"), (citation.SYMOSC, citation.PAPER), strict=True):
        assert dict(re.findall(r"^  (\w+) += \{(.*)\},$", entry, re.M)) == fields
        assert entry.count("{") == entry.count("}")
    assert f"Version {symosc.__version__}" in result.stdout


def test_every_text_cites_the_same_paper() -> None:
    start = citation.paper_reference().rpartition(",")[0]
    for name in scene_names():
        assert load_scene(name).source.startswith(start), name
    readme = " ".join(text("README.md").split())
    for name in ("title", "journal", "volume", "year"):
        assert citation.PAPER[name] in readme, name
    assert citation.paper_reference(r"\emph{{{}}}", "~", "--") in text("derivations/derivations.tex")


def test_every_citation_has_an_entry_and_every_entry_is_complete() -> None:
    cited = citation.cited("".join(TEXTS) + MAIN)
    assert set(cited) == set(citation.entries())
    assert re.findall(r"\\bibitem\{(\w+)\}", MAIN) == cited
    assert (COMMITTED / document.BIBTEX).read_text(encoding="utf-8") == citation.references_bib()
    for reference in citation.entries().values():
        needed = {"article": {"journal", "volume", "pages"}, "book": {"publisher", "address"}, "misc": {"note"}}
        assert set(reference.fields) >= {"author", "title", "year"} | needed[reference.kind], reference.key
        assert re.fullmatch(r"\d{4}", reference.fields["year"])
        doi = reference.fields.get("doi", "10.1/x")
        assert re.fullmatch(r"10\.\d+/\S+", doi), doi


def test_one_entry_as_a_line() -> None:
    assert citation.reference_line("luo2008") == (
        r"A.~C.~J.~Luo, \emph{A theory for flow switchability in discontinuous dynamical systems}, "
        r"Nonlinear Analysis: Hybrid Systems 2 (2008), 1030--1061."
    )
    assert citation.reference_line("hongliu2000").startswith("H.-K.~Hong and C.-S.~Liu,")
    assert citation.reference_line("dibernardo2008").startswith("M.~di Bernardo, C.~J.~Budd,")
    assert "Pólya" in citation.plain_line("polya1922")
    with pytest.raises(KeyError):
        citation.cited(r"\cite{nobody1900}")


def test_what_is_from_memory_is_marked_in_the_source_alone() -> None:
    """Every entry of others says what it was compared with, or that something of it was not; no print says it."""
    for key, reference in citation.entries().items():
        if key in ("symosc", "chen2016"):
            continue
        fields = dict(reference.fields)
        doubts = [word.strip() for word in fields.pop("unchecked", "").split(",") if word.strip()]
        assert fields.pop("checked", None) or "title" in doubts, key
        assert set(doubts) <= set(fields), key
    assert "unchecked" in citation.references_bib()
    assert "not checked" not in MAIN + "".join(map(citation.plain_line, citation.entries()))


# --- errata ---


def test_each_erratum_is_short() -> None:
    found = read_errata()
    assert {erratum.severity for erratum in found} == set(SEVERITIES)
    for erratum in (each.in_unicode() for each in found):
        assert len(erratum.proof) <= 340, erratum.id
        assert len(erratum.printed) + len(erratum.holds) <= 340, erratum.id


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (('"typo"', '"slip"'), "severity = 'slip': must be one of wrong, gap, typo"),
        (('proof = "c"', ""), "must have severity, where, printed, holds, proof"),
        (('proof = "c"', 'proof = "c"\nseen = "d"'), "must have severity, where, printed, holds, proof"),
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


@pytest.mark.parametrize(
    ("latex", "plain"),
    [
        (r"$\dot{x} - v_\lambda = F^{(\alpha)} \tau + \ldots$", "ẋ − v_λ = F⁽ᵅ⁾ τ + …"),
        (r"$B_0\Omega/\sqrt{(k - m\Omega^2)^2 + c^2\Omega^2} = \sqrt{20}$", "B₀Ω/√((k − mΩ²)² + c²Ω²) = √20"),
        (r"$\partial\Omega_{ij}$ in $\mathbb{R}^{n-1}$", "∂Ωᵢⱼ in Rⁿ⁻¹"),
        (r"$F_{s1} = -\mu_1 F_N$, $\Theta^{\mathrm{cr}}$, $e^{-2\pi}$", "Fₛ₁ = −μ₁ FN, Θcr, e^(−2π)"),
        (r"$F^{(1)} \times F^{(2)} > 0$", "F⁽¹⁾ × F⁽²⁾ > 0"),
        ("$P_{4645}$, Fig.~10, (55)--(58)", "P₄₆₄₅, Fig. 10, (55)–(58)"),
    ],
)
def test_as_unicode(latex: str, plain: str) -> None:
    assert latex_to_unicode(latex) == plain


@pytest.mark.parametrize("latex", [r"$\frac{1}{2}$", r"see \ref{a}", r"$x_$", r"$\foo$"])
def test_what_it_does_not_know_is_refused(latex: str) -> None:
    with pytest.raises(ValueError, match=r"unknown|only formulas|ends with"):
        latex_to_unicode(latex)
