"""Touches that are exact: without damping and drive a velocity goes round a circle whose size is rational."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

from symosc import Parameters, Scene, certify, simulate
from symosc.certificates.certificate import Certificate
from symosc.certificates.verify import verify

#: Cosine and sine of rational angles.
ANGLES = (("3/5", "4/5"), ("5/13", "12/13"), ("-3/5", "4/5"), ("8/17", "-15/17"), ("-7/25", "-24/25"))
#: Far less than doubles see.
LITTLE = Fraction(1, 10**30)


def still(rng: random.Random, v1: Fraction, v2: Fraction) -> Parameters:
    """Return parameters without damping and drive, of a rational frequency."""
    m, w = Fraction(rng.randint(1, 9), 4), Fraction(rng.randint(2, 12), 4)
    mu1, mu2 = (Fraction(rng.randint(1, 9), 10) for _ in range(2))
    A0, FN = Fraction(rng.randint(-9, 9), 2), Fraction(rng.randint(1, 20), 2)
    return Parameters(m=m, c=0, k=m * w * w, A0=A0, B0=0, Omega=1, v1=v1, v2=v2, mu1=mu1, mu2=mu2, FN=FN)


def touching(seed: int) -> tuple[Scene, int]:
    """Return a scene whose first event is the touch of a belt, from a start in a domain, and the belt."""
    rng = random.Random(seed)
    speed = Fraction(rng.randint(1, 30), 7) * rng.choice([-1, 1])
    belt, beyond = rng.choice([1, 2]), Fraction(rng.randint(1, 40), 9)
    # Below belt 1 and above belt 2 there is no other belt. Between the belts the other one must be out of reach.
    outside = speed > 0 if belt == 1 else speed < 0
    other = beyond if outside else 2 * abs(speed) + beyond
    v1, v2 = (speed, speed + other) if belt == 1 else (speed - other, speed)
    domain = belt + (0 if outside else 1) if belt == 1 else belt + (1 if outside else 0)
    p = still(rng, v1, v2)
    cosine, sine = map(Fraction, rng.choice(ANGLES))
    w = Fraction(str((float(p.k / p.m)) ** 0.5)).limit_denominator(100)
    assert w * w == p.k / p.m
    v0, a0 = abs(speed) * cosine, abs(speed) * sine * w
    x0 = (p.A(domain) - p.m * a0) / p.k
    return Scene("touch", p, Fraction(0), x0, v0, Fraction(3 * rng.randint(3, 8)) / w), belt


def verified(certificate: Certificate, tmp_path: Path) -> int:
    certificate.to_json(tmp_path / "it.json")
    return verify(str(tmp_path / "it.json"))[0]


def agrees(certificate: Certificate, scene: Scene) -> None:
    """Check the events against those of 60 digits."""
    run = simulate(scene, digits=60)
    rows = certificate.statement["events"]
    assert [row["kind"] for row in rows] == [event.kind for event in run.events]
    for row, event in zip(rows, run.events, strict=True):
        assert row["boundary"] == event.boundary
        for name in "tx":
            low, high = map(Fraction, row[name])
            assert low <= Fraction(str(getattr(event, name))) <= high


@pytest.mark.quick(8)
@pytest.mark.parametrize("seed", range(30))
def test_a_start_that_touches_is_proven_to_and_verified(seed: int, tmp_path: Path) -> None:
    scene, belt = touching(seed)
    found = certify(scene)
    assert found.proven, found.message
    first = found.statement["events"][0]
    assert (first["kind"], first["boundary"]) == ("graze", belt)
    agrees(found, scene)
    assert verified(found, tmp_path) == 0


@pytest.mark.quick(6)
@pytest.mark.parametrize("seed", range(20))
def test_a_start_that_misses_by_a_little_does_not_touch(seed: int, tmp_path: Path) -> None:
    scene, _ = touching(seed)
    for step in (LITTLE, -LITTLE):
        moved = replace(scene, x0=scene.x0 + step)
        found = certify(moved)
        assert found.proven, found.message
        assert not found.events or found.events[0][0] != "graze"
        false = certify(scene).as_dict() | {"start": found.statement["start"]}
        (tmp_path / "false.json").write_text(json.dumps(false), encoding="utf-8")
        assert verify(str(tmp_path / "false.json"))[0] == 1


@pytest.mark.quick(4)
@pytest.mark.parametrize("seed", range(20))
def test_a_motion_touches_once_a_turn_after_a_stick(seed: int, tmp_path: Path) -> None:
    """A stick ends where F = 0. From there the velocity goes round at the belt's speed."""
    rng = random.Random(f"stick {seed}")
    v1 = Fraction(rng.randint(1, 20), 8)
    p = still(rng, v1, v1 + Fraction(rng.randint(9, 40), 8))
    x0 = p.A(2) / p.k + Fraction(rng.randint(-40, 40), 8)
    scene = Scene("stick", p, Fraction(0), x0, v1, Fraction(20))
    found = certify(scene)
    assert found.proven, found.message
    agrees(found, scene)
    assert verified(found, tmp_path) == 0
    for event, after in pairwise(found.events):
        if event[:3] == ("slip", "belt1", "Omega1"):
            assert after[:3] == ("graze", "Omega1", "Omega1")
