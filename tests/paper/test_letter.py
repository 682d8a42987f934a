"""The letter to the authors: it has what the run has shown, and counts that."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape

import pytest

from symosc.derive.errata import SEVERITIES, Erratum, read_errata
from symosc.paper.claims import Claim, read_claims
from symosc.paper.evidence import CONFIRMED, NOT_AS_PRINTED
from symosc.paper.letter import texts
from symosc.paper.pictures import PICTURES
from symosc.paper.run import ERROR, Judged, Results

CLAIMS, ERRATA = read_claims(PICTURES), tuple(erratum.in_unicode() for erratum in read_errata())


def judged(claim: Claim, verdict: str | None = None) -> Judged:
    return Judged(claim, verdict or claim.verdict, "Found.", {}, 0.0)


def results(*entries: Judged, errata: tuple[Erratum, ...] = ERRATA) -> Results:
    return Results(entries, {}, {}, {}, errata=errata)


def listed(letter: dict[str, str]) -> list[str]:
    """Return the ids of the errata in the HTML; in both letters each has the number that it has in the list."""
    found = re.findall(r'<li id="([^"]*)" value="(\d+)">', letter["letter.html"])
    numbers = {erratum.id: str(erratum.number) for erratum in ERRATA}
    assert all(numbers.get(key, number) == number for key, number in found)
    assert re.findall(r"^(\d+)\. ", letter["letter.txt"], re.MULTILINE) == [number for _, number in found]
    return [key for key, _ in found]


def counts(text: str) -> list[int]:
    """Return the numbers of the first paragraph: statements, those that hold, points, and these by their severity."""
    words = " ".join(re.sub(r"<[^>]*>", "", text).split())
    pattern = (
        r"Of (\d+) statements (\d+) hold as they stand; the others come down to the (\d+) points below: (\d+) that do"
        r" not hold, (\d+) in which something is left out, and (\d+) slips"
    )
    found = re.search(pattern, words)
    assert found, words[:400]
    return [int(number) for number in found.groups()]


def test_all_claims_as_committed_show_all_errata() -> None:
    letter = texts(results(*map(judged, CLAIMS)))
    assert listed(letter) == [erratum.id for erratum in ERRATA]
    by_severity = [sum(each.severity == severity for each in ERRATA) for severity in ("wrong", "gap", "typo")]
    assert set(SEVERITIES) == {"wrong", "gap", "typo"}
    for text in letter.values():
        assert counts(text)[2:] == [len(ERRATA), *by_severity]
        assert counts(text)[0] == len(CLAIMS)


@pytest.mark.quick(6)
@pytest.mark.parametrize("i", range(len(ERRATA)))
def test_an_erratum_stands_there_if_a_claim_has_shown_it_in_this_run(i: int) -> None:
    """Not if its claims were not run, hold after all, or failed; and once if several show it."""
    erratum = ERRATA[i]
    showing = [claim for claim in CLAIMS if erratum.id in claim.errata]
    rest = [judged(claim) for claim in CLAIMS if erratum.id not in claim.errata]
    assert erratum.id not in listed(texts(results(*rest)))
    for verdict, there in ((None, 1), (CONFIRMED, 0), (ERROR, 0)):
        letter = texts(results(*(judged(claim, verdict) for claim in showing)))
        assert listed(letter).count(erratum.id) == there
        assert sum(counts(letter["letter.txt"])[3:]) == counts(letter["letter.html"])[2] == len(listed(letter))
        shown = " ".join(letter["letter.txt"].split())
        assert shown.count(" ".join(f"Proof: {erratum.proof}".split())) == there


def test_what_holds_is_counted_without_what_shows_an_error() -> None:
    held = next(claim for claim in CLAIMS if not claim.errata)
    wrong = next(claim for claim in CLAIMS if claim.errata)
    letter = texts(results(judged(held), judged(held), judged(wrong)))
    assert counts(letter["letter.txt"])[:3] == [3, 2, len(wrong.errata)]


def test_a_text_with_signs_is_the_same_in_both_letters() -> None:
    said = {"where": "Eq. (1)", "printed": "a < b & c", "holds": "a <= {b}", "proof": 'say "d", not <d>'}
    erratum = Erratum(1, "one", "typo", **said)
    claim = replace(CLAIMS[0], errata=("one",), verdict=NOT_AS_PRINTED)
    letter = texts(results(judged(claim), errata=(erratum,)))
    for text in said.values():
        assert text in letter["letter.txt"]
        assert text.replace("<=", "≤") in unescape(re.sub(r"<[^>]*>", "", letter["letter.html"]))
