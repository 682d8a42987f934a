"""Whole motions: the enclosures contain what an oracle of the differential equation finds, and nothing is guessed."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from effort import at_most
from flint import ctx
from oracle import simulate_oracle
from problems import FAMILIES

from symosc import Certificate, Parameters, Scene, certify, load_scene, simulate
from symosc.certificates import trajectory
from symosc.exact import read_exact
from symosc.reference.cases import hard_cases

PAPER = {"fig5": 16, "fig6": 3, "fig7": 0, "fig7-corrected": 2, "fig8": 22, "fig9": 12, "fig10": 44}


def scene_of(p: Parameters, start: dict[str, Any], **changes: Any) -> Scene:
    numbers = {name: Fraction(start[name]) for name in ("t0", "x0", "v0", "t_end")}
    return Scene("random", p, **(numbers | changes))


@pytest.mark.parametrize("name", PAPER)
def test_the_paper_s_motions_are_proven(name: str) -> None:
    certificate, run = certify(name), simulate(name)
    assert (certificate.proven, len(certificate.events)) == (True, PAPER[name]), certificate.message
    assert_same(certificate, run.events, 1e-13)


def fraction(value: Any) -> Fraction:
    """Return a float as the decimal that it prints as, and a number of mpmath exactly."""
    return Fraction(str(value)) if isinstance(value, float) else read_exact("value", value)


def assert_same(certificate: Certificate, events: Any, tolerance: float) -> None:
    """Both have the same events, and each is in its enclosure but for the tolerance."""
    assert len(certificate.events) == len(events), certificate.message
    for (kind, source, target, *boxes), event in zip(certificate.events, events, strict=True):
        assert (kind, source, target) == (event.kind, event.source, event.target)
        for (low, high), value in zip(boxes, (event.t, event.x), strict=True):
            exact = fraction(value)
            slack = Fraction(tolerance) * max(1, abs(exact))
            assert Fraction(low) - slack <= exact <= Fraction(high) + slack


def random_scenes(family: str, count: int, seed: int = 0) -> Iterator[Scene]:
    rng = random.Random(f"certify {family} {seed}")
    for _ in range(count):
        p, start = FAMILIES[family](rng)
        start.pop("max_events", None)
        scene = scene_of(p, start)
        run = simulate(scene, max_events=25)
        yield scene if run.status != "max_events" else scene.started({"t_end": run.events[-1].t + 1e-9})


@pytest.mark.quick(3)
@pytest.mark.parametrize("family", [family for family in FAMILIES if family not in ("slow", "light")])
def test_enclosures_contain_the_events_of_the_oracle(family: str) -> None:
    for scene in random_scenes(family, 1):
        certificate = certify(scene)
        assert certificate.proven, (certificate.message, scene)
        run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end, 40)
        assert_same(certificate, run.events, 1e-33)


@pytest.mark.campaign
@pytest.mark.parametrize("family", FAMILIES)
def test_ten_thousand_events(family: str) -> None:
    """The engine's 40 digits in place of the oracle's, which takes minutes; both are compared elsewhere."""
    events = 0
    for scene in random_scenes(family, 2000, 1):
        certificate = certify(scene)
        if not certificate.proven:  # with few digits and without a spring a force may be exactly 0 where it turns
            assert (scene.parameters.k, "where a force turns" in certificate.message) == (0, True), scene
            continue
        assert_same(certificate, simulate(scene, digits=40).events, 1e-38)
        events += len(certificate.events)
        if events > 1500:
            break


@pytest.mark.quick(1)
@pytest.mark.parametrize("family", ["ordinary", "stiff", "resonant"])
def test_the_engine_s_doubles_are_in_the_enclosures(family: str) -> None:
    for scene in random_scenes(family, 5, 2):
        certificate = certify(scene)
        assert certificate.proven, (certificate.message, scene)
        assert_same(certificate, simulate(scene).events, 1e-12)


@pytest.mark.slow
def test_all_hard_cases_are_proven() -> None:
    cases = hard_cases()
    proven = [certify(case.scene) for case in cases]
    assert len(cases) == 73
    assert not [case.name for case, certificate in zip(cases, proven, strict=True) if not certificate.proven]
    for case, certificate in list(zip(cases, proven, strict=True))[::7]:
        if not case.periods:  # of those tests/certificates/test_settled.py compares the last events
            assert_same(certificate, case.reference(), 1e-38)


def test_an_event_costs_less_than_5000_calls() -> None:
    """Some milliseconds."""
    certify("fig5", t_end=3)
    with at_most(5000 * sum(PAPER.values())):
        count = sum(len(certify(name).events) for name in PAPER)
    assert count == sum(PAPER.values())


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_all_starts_within_an_error(name: str) -> None:
    scene, error = load_scene(name), Fraction(1, 10**6)
    on_a_belt = scene.v0 in (scene.parameters.v1, scene.parameters.v2)
    errors = (error, error, 0 if on_a_belt else error)
    certificate = certify(name, start_error=errors, t_end=scene.t0 + 6)
    assert certificate.proven, certificate.message
    assert "every start" in certificate.message
    rng = random.Random(name)
    for _ in range(4):
        moved = {
            each: getattr(scene, each) + Fraction(rng.randint(-1000, 1000), 1000) * e
            for each, e in zip(("t0", "x0", "v0"), errors, strict=True)
        }
        assert_same(certificate, simulate(scene.parameters, **moved, t_end=scene.t0 + 6, digits=20).events, 1e-18)
    widths = [Fraction(high) - Fraction(low) for *_, (low, high), _ in certificate.events]
    assert max(widths) < 1000 * error  # no blow-up


def test_an_error_of_the_start_that_reaches_a_touch_is_open() -> None:
    certificate = certify("fig7-corrected", start_error="1e-4", t_end=4)
    assert not certificate.proven or certificate.statement["starts"] == "some"
    certificate = certify("fig8", start_error=["1e-3", "0", "0"], t_end=4)
    assert certificate.statement["starts"] in ("some", "all")


def test_the_precision_is_raised_until_it_suffices() -> None:
    """fig8's sticks shrink to 1e-20 of the first: the events before them are proven with fewer bits."""
    longer = certify("fig8", t_end=60)
    assert longer.proven, longer.message
    assert len(longer.events) > 60
    bits = int(longer.statement["made_by"].split(", ")[2].split()[0])
    assert bits > trajectory.FIRST_BITS
    boxes = [tuple(map(Fraction, event[3])) for event in longer.events]
    assert all(before[1] < after[0] for before, after in pairwise(boxes))


def test_what_stays_open_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trajectory, "MOST_BITS", 160)
    certificate = certify("fig8", t_end=60)
    assert not certificate.proven
    assert "is not decided with 160 bits" in certificate.message
    assert len(certificate.events) > 10
    monkeypatch.setattr(trajectory, "MOST_PROVEN_EVENTS", 5)
    certificate = certify("fig5")
    assert (certificate.proven, len(certificate.events)) == (False, 5)


REST = {"m": 1, "c": 1, "k": 1, "A0": 0, "B0": "0.1", "Omega": 1, "v1": 0, "v2": 10, "mu1": 1, "mu2": "0.1", "FN": 1}


@pytest.mark.parametrize("x0", ["0", "1/2", "-3/5"])
def test_rest_on_a_belt_lasts(x0: str) -> None:
    """Csernák's continuum: each of these starts rests, which is proven of one at a time, and of all within an error."""
    scene = Scene("rest", Parameters(**REST), Fraction(0), Fraction(x0), Fraction(0), Fraction(10) ** 12)
    for error in (None, ["0", "0.1", "0"]):
        certificate = certify(scene, start_error=error)
        assert (certificate.proven, certificate.events) == (True, ())
        assert certificate.statement["mode"] == "belt1"


def test_settling_between_the_belts_lasts() -> None:
    p = Parameters(**REST | {"v1": -1, "v2": 1, "B0": "0.5"})
    for t_end in (10, 10**9):
        assert certify(Scene("calm", p, Fraction(0), Fraction(0), Fraction(0), Fraction(t_end))).proven


def test_the_precision_of_the_process_is_given_back() -> None:
    before = ctx.prec
    certify("fig7-exact")
    assert ctx.prec == before
