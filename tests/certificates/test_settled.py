"""A motion that settles on an orbit: the same events as those that are proven one by one, for any number of periods."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from symosc import certify, find_orbit, load_scene, simulate
from symosc.certificates.settled import prove_settled
from symosc.certificates.trajectory import EXACT, ToProve, prove_trajectory
from symosc.exact import read_start_error
from symosc.reference.cases import hard_cases

LONG = {case.name: case for case in hard_cases() if case.periods}


def task(name: str, periods: int, digits: int = 25, **start: Any) -> ToProve:
    scene = load_scene(name).started(start)
    t_end = scene.t0 + Fraction(f"{(periods + 0.05) * 6.283185307 / float(scene.parameters.Omega):.6f}")
    errors = EXACT if start else read_start_error(scene.start_error) or EXACT
    return ToProve(scene.parameters, (scene.t0, scene.x0, scene.v0), errors, t_end, digits)


def settled(what: ToProve, name: str) -> Any:
    scene = load_scene(name)
    return prove_settled(what, find_orbit(scene.parameters, scene.structure))


@pytest.mark.parametrize(("name", "count"), [("fig9-orbit", 200_000), ("fig10-orbit", 400_000)])
def test_a_hundred_thousand_periods_are_proven(name: str, count: int) -> None:
    case = LONG[name]
    certificate = certify(case.scene)
    assert (certificate.kind, certificate.proven, certificate.statement["count"]) == ("settled", True, count)
    expected = case.reference()
    assert len(certificate.events) == len(expected)
    for (kind, source, target, *ends), event in zip(certificate.events, expected, strict=True):
        assert (kind, source, target) == (event.kind, event.source, event.target)
        for (low, high), value in zip(ends, (event.t, event.x), strict=True):
            assert Fraction(low) < Fraction(str(value)) < Fraction(high)


@pytest.mark.parametrize(("name", "periods"), [("fig9-orbit", 7), ("fig9-orbit", 60), ("fig10", 40), ("fig9", 60)])
def test_its_last_events_are_those_that_are_proven_one_by_one(name: str, periods: int) -> None:
    """fig9 and fig10 start off the orbit, and come near it by and by."""
    what = task(name, periods)
    found, whole = settled(what, name.removesuffix("-orbit")), prove_trajectory(what)
    assert (found.proven, whole.proven) == (True, True), (found.message, whole.message)
    assert found.statement["count"] == len(whole.events)
    assert found.events
    for one, other in zip(found.events, whole.events[-len(found.events) :], strict=True):
        assert one[:3] == other[:3]
        for a, b in zip(one[3:], other[3:], strict=True):
            assert max(Fraction(a[0]), Fraction(b[0])) <= min(Fraction(a[1]), Fraction(b[1]))


@pytest.mark.parametrize("side", [-1, 1])
def test_starts_at_the_end_of_a_stick_leave_before_the_time_stated(side: int) -> None:
    what = task("fig10-orbit", 3)
    certificate = settled(what, "fig10")
    assert certificate.proven, certificate.message
    until = Fraction(certificate.statement["may_stick_until"])
    start = {name: c + side * e for name, c, e in zip(("t0", "x0", "v0"), what.start, what.errors, strict=True)}
    run = simulate(what.p, **start, t_end=what.t_end, digits=40)
    slips = [event for event in run.events if event.kind == "slip" and event.t < 1]
    assert all(Fraction(str(event.t)) < until for event in slips)
    assert len(run.events) - len(slips) == certificate.statement["count"]
    for event, (*_, t, _) in zip(run.events[-4:], certificate.events[-4:], strict=True):
        assert Fraction(t[0]) < Fraction(str(event.t)) < Fraction(t[1])


def test_a_motion_that_does_not_settle_on_the_orbit_is_not_proven() -> None:
    p = load_scene("fig9").parameters
    other = find_orbit(p.replace(A0="-2.001"), "P32")
    found = prove_settled(task("fig9-orbit", 30), replace(other, parameters=p, points=other.points))
    assert found.proven  # Newton's method leads from the points nearby to the orbit
    undamped = load_scene("fig9").parameters.replace(c=0)
    orbit = find_orbit(undamped, "P32")
    what = task("fig9-orbit", 30)._replace(p=undamped)
    assert not prove_settled(what, orbit).proven
