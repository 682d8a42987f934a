"""The files of claims: complete, and refused with a reason where they are wrong."""

from __future__ import annotations

import re
from typing import Any

import pytest
from stand_in_claims import CLAIM

from symosc.derive.chapters import CHAPTERS
from symosc.derive.records import RecordsError
from symosc.paper.claims import CLAIMS_FOLDER, PARTS, UNJUDGED, read_claims
from symosc.paper.pictures import PICTURES

CLAIMS = read_claims(PICTURES)


def test_every_figure_of_the_paper_is_shown_by_a_claim() -> None:
    shown = {PICTURES[key].paper_figure for claim in CLAIMS for key in claim.figures}
    assert shown >= set(range(1, 11))
    assert {key for claim in CLAIMS for key in claim.figures} == set(PICTURES)


def test_parts_are_the_files() -> None:
    assert {path.stem for path in CLAIMS_FOLDER.glob("*.toml")} == {*PARTS, UNJUDGED}


def test_derivations_that_claims_name_are_chapters() -> None:
    text = "\n".join(path.read_text(encoding="utf-8") for path in CLAIMS_FOLDER.glob("*.toml"))
    assert set(re.findall(r'^derivation = "(.*)"', text, re.MULTILINE)) <= set(CHAPTERS)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (("id = ", "ident = "), "id is missing"),
        (('verdict = "confirmed"', 'verdict = "true"'), "verdict = 'true': must be one of confirmed, "),
        (('verdict = "confirmed"', 'verdict = "not as printed"'), "correction is missing"),
        (('verdict = "confirmed"', 'verdict = "confirmed"\ncorrection = "no"'), "although its verdict is 'confirmed'"),
        (('verdict = "confirmed"', 'verdict = "by definition"\nerrata = ["a"]'), "erratum = 'a': must be one of"),
        (('verdict = "confirmed"', 'verdict = "not as printed"\ncorrection = "2"'), "errata are missing"),
        (('verdict = "confirmed"', 'verdict = "confirmed"\nfigures = ["fig11"]'), "figure = 'fig11': must be one of"),
        (('verdict = "confirmed"', 'verdict = "confirmed"\nfigures = "fig1"'), "must be a list of texts"),
        (
            ('verdict = "confirmed"', 'verdict = "confirmed"\nderivation = "none"'),
            "derivation = 'none': must be one of motion",
        ),
        (('verdict = "confirmed"', 'verdict = "confirmed"\nnote = "x"'), "note is unknown; known are id, "),
        (("stand_ins.right", "stand_ins.left"), "check = 'stand_ins.left': there is no such function"),
        (("stand_ins.right", "stand_outs.right"), "check = 'stand_outs.right': there is no such function"),
        (("stand_ins.right", "right"), "check = 'right': there is no such function"),
        (('says = "1 < 2"', "says = 3"), "says = 3: must be text"),
        (('id = "one"', 'id = "One!"'), "must be kebab case"),
        (("[[claim]]", "[[clam]]"), r"may only have \[\[claim\]\] tables, not clam"),
        (("[[claim]]", "[[claim]"), "cannot be read"),
    ],
)
def test_a_wrong_claim_is_refused(read: Any, change: tuple[str, str], complaint: str) -> None:
    text = CLAIM.format(id="one", check="right")
    assert read(text)
    with pytest.raises(RecordsError, match=complaint):
        read(text.replace(*change))


def test_claims_are_in_order_and_unique(read: Any) -> None:
    read(CLAIM.format(id="two", check="right"), "theorems")
    assert [claim.id for claim in read(CLAIM.format(id="one", check="right"))] == ["one", "two"]
    with pytest.raises(RecordsError, match=r"theorems.toml: id 'one' is there twice"):
        read(CLAIM.format(id="one", check="right"), "theorems")
    with pytest.raises(RecordsError, match=r"extras.toml: is no part"):
        read(CLAIM.format(id="three", check="right"), "extras")
