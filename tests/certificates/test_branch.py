"""Proofs of branches: every orbit between two values lies in their boxes; their ends are where they are said to be."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import pytest
from flint import arb

from symosc import certify, continue_orbit, find_orbit, load_scene
from symosc.certificates.branch import BranchToProve, certify_branch
from symosc.certificates.certificate import Certificate
from symosc.orbits.branch import Branch


@cache
def branch(name: str, low: str, high: str) -> Branch:
    scene = load_scene(name)
    middle = str((Fraction(low) + Fraction(high)) / 2)
    return continue_orbit(scene.parameters.replace(Omega=middle), scene.structure, "Omega", (low, high))


#: What the progress of each proof was told.
TOLD: dict[str, list[float]] = {}


@cache
def proof(name: str, low: str, high: str) -> Certificate:
    return certify(branch(name, low, high), progress=TOLD.setdefault(name, []).append)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "low", "high"), [("fig9", "3.9", "4.1"), ("fig10", "1.7", "1.8")])
def test_orbits_lie_in_the_boxes(name: str, low: str, high: str) -> None:
    found = proof(name, low, high)
    assert (found.kind, found.proven, found.stable) == ("branch", True, True)
    boxes, scene = found.statement["boxes"], load_scene(name)
    values = [Fraction(each) for box in boxes for each in box["value"]]
    assert values == sorted(values)
    assert (values[0], values[-1]) == (Fraction(low), Fraction(high))
    for part in (Fraction(1, 7), Fraction(1, 2), Fraction(9, 10)):
        value = Fraction(low) + part * (Fraction(high) - Fraction(low))
        orbit = find_orbit(scene.parameters.replace(Omega=value), scene.structure)
        box = next(each for each in boxes if Fraction(each["value"][0]) <= value <= Fraction(each["value"][1]))
        for row in zip(box["t"][:-1], box["x"][:-1], strict=True):
            (t0, t1), (x0, x1) = ([float(end) for end in ends] for ends in row)
            T = float(orbit.period)
            assert any(x0 <= x <= x1 and t0 <= t + turns * T <= t1 for t, x in orbit.points for turns in (-1, 0, 1)), (
                row,
                orbit.points,
            )


def test_an_end_that_is_put_elsewhere_is_not_proven() -> None:
    """P32 touches v2 at Omega = 5.0176, neither before nor after it."""
    scene = load_scene("fig9")
    orbit = find_orbit(scene.parameters.replace(Omega="5.01"), "P32")
    points = [arb(float(each)) for point in orbit.points for each in point]
    start = ("end of the range", Fraction("5.01"), points)
    for end in (("grazing", Fraction("5.012"), points), ("grazing", Fraction("5.02"), points)):
        task = BranchToProve(scene.parameters, "Omega", orbit.labels, 1, (start, end))
        found = certify_branch(task)
        assert not found.proven, end
        assert "not decided" in found.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "low", "high", "kind", "value", "inequality"),
    [
        ("fig9", "5.017619", "5.1", "grazing", "5.01761965804", "v < v2 during P3"),
        ("fig9", "3.2", "3.2887", "birth of a stick", "3.28857638277", "F^(1) < 0 where P3 ends"),
    ],
)
def test_ends_are_enclosed(name: str, low: str, high: str, kind: str, value: str, inequality: str) -> None:
    scene = load_scene(name)
    start = low if kind == "grazing" else high
    found = certify(continue_orbit(scene.parameters.replace(Omega=start), "P32", "Omega", (low, high)))
    assert found.proven, found.message
    (end,) = [each for each in found.statement["ends"] if each["kind"] == kind]
    first, last = sorted((Fraction(end["inside"]), Fraction(end["outside"])))
    assert first <= Fraction(value) <= last
    assert last - first < Fraction(1, 10**9)
    assert end["inequality"] == inequality


def test_the_progress_goes_up_to_the_end() -> None:
    assert proof("fig10", "1.7", "1.8").proven
    seen = TOLD["fig10"]
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1, abs=0.5)
