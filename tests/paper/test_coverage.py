"""Nothing of the paper is left out, no error is counted twice, and what the coverage table says is computed."""

from __future__ import annotations

from pathlib import Path

import pytest

from symosc.derive.errata import SEVERITIES, read_errata
from symosc.derive.records import RecordsError
from symosc.paper.claims import FAULTY, UNJUDGED, read_claims, read_unjudged
from symosc.paper.coverage import PAPER, Item, coverage, items_of
from symosc.paper.evidence import CONFIRMED, DEFINITION
from symosc.paper.pictures import PICTURES

CLAIMS, PARTS = read_claims(PICTURES), read_unjudged()
FOUND = [erratum.in_unicode() for erratum in read_errata()]


def test_every_numbered_item_of_the_paper_has_a_claim() -> None:
    assert [item.label for item, on in coverage(CLAIMS).items() if not on.claims] == []
    assert len([item for item in PAPER if item.kind == "equation"]) == 66
    assert {item.label for item in PAPER} >= {"Abstract", "(1)", "(66)", "Lemma 3", "Theorem 4", "Fig. 10", "Section 7"}


def test_a_claim_that_is_taken_away_leaves_a_gap() -> None:
    table = coverage(claim for claim in CLAIMS if "(15)" not in claim.source)
    assert [item.label for item, on in table.items() if not on] == ["(15)", "(16)"]


def test_every_source_names_an_item_of_the_paper() -> None:
    for entry in (*CLAIMS, *PARTS):
        assert items_of(entry.source), entry.source
        assert set(items_of(entry.source)) <= set(PAPER), entry.source


@pytest.mark.parametrize(
    ("source", "labels"),
    [
        ("Section 4, after eq. (19)", ["Section 4"]),
        ("Sections 2, 5 and 6, Figs. 5 to 7", ["Section 2", "Section 5", "Section 6", "Fig. 5", "Fig. 6", "Fig. 7"]),
        ("Theorem 6 (i), eqs. (38) to (40)", ["(38)", "(39)", "(40)", "Theorem 6"]),
        ("Theorem 7, eqs. (55.2), (56.5)", ["(55)", "(56)", "Theorem 7"]),
        ("Section 6, Fig. 5(d), and Theorem 4", ["Section 6", "Theorem 4", "Fig. 5"]),
        ("Abstract; Section 6, Fig. 9(d) to (f)", ["Abstract", "Section 6", "Fig. 9"]),
        ("Lemma 2, eqs. (21), (22)", ["(21)", "(22)", "Lemma 2"]),
    ],
)
def test_sources_are_read(source: str, labels: list[str]) -> None:
    assert [item.label for item in items_of(source)] == labels
    assert items_of("Section 9") == [Item("section", 9)]


def test_each_erratum_is_shown_by_claims_and_no_other_claim_has_one() -> None:
    shown = {key for claim in CLAIMS for key in claim.errata}
    assert shown == {erratum.id for erratum in FOUND}
    for claim in CLAIMS:
        assert bool(claim.errata) == (claim.verdict in FAULTY), claim.id
        assert claim.remark is None or claim.verdict in (CONFIRMED, DEFINITION), claim.id
    assert {erratum.severity for erratum in FOUND} == set(SEVERITIES)
    assert len({erratum.printed for erratum in FOUND}) == len(FOUND) < sum(claim.verdict in FAULTY for claim in CLAIMS)


def test_errata_are_in_the_order_of_the_paper() -> None:
    sections = [item.number for erratum in FOUND for item in items_of(erratum.where)[:1] if item.kind == "equation"]
    assert sections == sorted(sections)


def test_proofs_are_short() -> None:
    for erratum in FOUND:
        assert len(erratum.proof) <= 340, erratum.id
        assert len(erratum.printed) + len(erratum.holds) <= 340, erratum.id


def test_what_is_not_judged_is_complete_and_may_be_missing(tmp_path: Path) -> None:
    assert read_unjudged(tmp_path) == ()
    (tmp_path / f"{UNJUDGED}.toml").write_text('[[part]]\nsource = "Section 1"\n', encoding="utf-8")
    with pytest.raises(RecordsError, match="must have source, says, why"):
        read_unjudged(tmp_path)
