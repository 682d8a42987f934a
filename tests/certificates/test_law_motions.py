"""Motions under any friction law: what is proven is what an oracle of the law finds, and no changed
file passes unless it is still true.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest
from certificate_files import document, judged
from law_certificates import (
    LAW_CHANGES,
    changed,
    judged_law,
    law_is_true,
    reference_scene,
    says_the_same,
)
from law_oracle import follow
from law_reference import REFERENCES, Reference

from symosc import Belt, Oscillator, Scene, certify

#: Exact touches, which no enclosure tells from a near miss: S2 of a belt, S6 of a corner.
TOUCHES = {"S2": "a touch has none", "S6": "a touch or a near miss"}


@pytest.mark.parametrize(
    "reference",
    [
        pytest.param(each, id=each.name, marks=[pytest.mark.campaign] if each.name == "S6" else [])
        for each in REFERENCES
    ],
)
def test_references_are_proven_or_touch(reference: Reference) -> None:
    found = certify(reference_scene(reference))
    assert found.proven is (reference.name not in TOUCHES), found.message
    if not found.proven:
        assert TOUCHES[reference.name] in found.message
        return
    assert len(found.events) == len(reference.events)
    for (*names, t, x), event in zip(found.events, reference.events, strict=True):
        assert names == [event.kind, event.source, event.target]
        for (low, high), text in ((t, event.t), (x, event.x)):
            off = Fraction(1, 10**22)
            assert Fraction(low) - off < Fraction(text) < Fraction(high) + off


@pytest.mark.parametrize("number", range(6))
def test_random_laws_are_proven_as_the_oracle_finds_them(number: int) -> None:
    found, run, _ = judged_law(7, number)
    assert found.proven, found.message
    assert says_the_same(found.statement["events"], run)
    assert judged(found.as_dict())[0] == 0


@pytest.mark.campaign
def test_many_random_laws_are_proven() -> None:
    """All 200 of seed 7 are, with 2,400 events."""
    proven = 0
    for number in range(200):
        found, run, _ = judged_law(7, number)
        proven += found.proven
        assert not found.proven or says_the_same(found.statement["events"], run), number
    assert proven >= 180


DOCUMENTS = ("S1", "S6c", "S3", "7 1", "7 7", "7 10")


@pytest.mark.parametrize("change", LAW_CHANGES)
def test_a_changed_file_is_proven_only_if_it_is_still_true(change: str) -> None:
    rng = Random(f"{change} of a law")
    for name in rng.sample(DOCUMENTS, 2):
        original = document(f"law {name}")
        other = changed(original, change, rng)
        code, line = judged(other)
        if code == 0:
            assert other == original or law_is_true(other), (line, other)


@pytest.mark.campaign
@pytest.mark.parametrize("change", LAW_CHANGES)
def test_many_changed_files(change: str) -> None:
    rng = Random(f"many: {change}")
    for _ in range(40):
        original = document(f"law {rng.choice(DOCUMENTS)}")
        other = changed(original, change, rng)
        code, line = judged(other)
        assert code or other == original or law_is_true(other), (line, other)


def corners_of(start: dict[str, Fraction], error: Fraction, rng: Random) -> dict[str, Fraction]:
    return {name: value + error * rng.choice([-1, 1]) for name, value in start.items()}


def test_all_starts_within_an_error_have_the_events() -> None:
    """Static friction and a falling curve; the error grows at each slip."""
    belts = [{"v": "1/10", "curve": [(0, "2/5"), ("1/2", "3/10"), (1, "1/2")], "mu_s": "7/10"}]
    law: Any = {"m": 1, "c": "1/10", "k": 1, "A0": 0, "B0": "3/10", "Omega": "21/10", "FN": 1}
    error = Fraction(1, 10**8)
    model = Oscillator(**law, belts=[Belt(**belt) for belt in belts])
    start = {"t0": Fraction(0), "x0": Fraction(0), "v0": Fraction(0)}
    scene = Scene("set", model, *start.values(), Fraction(9))
    found = certify(scene, start_error=error)
    assert found.proven, found.message
    assert "slip" in [event[0] for event in found.events]
    rng = Random("starts")
    for _ in range(3):
        corner = corners_of(start, error, rng)
        run = follow(**law, belts=belts, **corner, t_end=9, digits=40)
        assert says_the_same(found.statement["events"], run)


def test_the_file_has_corners_and_the_events_have_none() -> None:
    found = certify(reference_scene(next(each for each in REFERENCES if each.name == "S6c")))
    kinds = [row["kind"] for row in found.statement["events"]]
    assert (found.message, kinds.count("corner")) == ("5 events and 5 corners until t = 17.5", 5)
    assert "corner" not in [event[0] for event in found.events]
