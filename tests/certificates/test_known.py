"""Events of a scene as a reference: proven, or why not."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from symosc import Scene, certify, load_scene, simulate
from symosc.certificates.known import known_events


def test_the_events_lie_in_the_middle_of_the_proven_ones() -> None:
    scene = replace(load_scene("fig5"), t_end=Fraction(12))
    known, rows = known_events(scene), certify(scene).statement["events"]
    assert (known.reason, len(known.events)) == ("", len(rows))
    exact = simulate(scene, digits=40).events
    for event, row, other in zip(known.events, rows, exact, strict=True):
        assert (event.kind, event.boundary) == (row["kind"], row["boundary"]) == (other.kind, other.boundary)
        for name in "tx":
            low, high = map(Fraction, row[name])
            assert low < getattr(event, name) < high
            assert high - low < Fraction(1, 10**22)


def test_what_is_not_proven_says_why() -> None:
    p = load_scene("fig5").parameters.replace(A0=0, B0=2, c=0, k=4, mu1=0, mu2=0, v1="2/3", v2=5)
    scene = Scene("steady", p, Fraction(0), Fraction(2, 3), Fraction(0), Fraction(9))
    known = known_events(scene)  # v = -(2/3) sin t touches v1 in every period
    assert known.events == ()
    assert "a touch" in known.reason
