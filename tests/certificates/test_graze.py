"""Grazes as statements of existence: some start within the error touches."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx

from symosc import certify, grazing_start, load_scene
from symosc.certificates import graze
from symosc.scenes import Scene


@pytest.mark.parametrize(("name", "x"), [("fig7-exact", "-0.5855"), ("fig8-exact", "4.51425")])
def test_the_paper_s_grazes(name: str, x: str) -> None:
    certificate = certify(name)
    assert certificate.proven, certificate.message
    ((kind, source, target, (low, high), (x_low, x_high)),) = certificate.events
    assert (kind, source) == ("graze", target)
    assert Fraction(low) < Fraction("3.14159265358979323846264338327950288") < Fraction(high)
    assert Fraction(x_low) < Fraction(x) < Fraction(x_high)
    free, scene = certificate.statement["free"], load_scene(name)
    assert certificate.statement["starts"] == "some"
    assert scene.start_error is not None
    given = getattr(scene, free["name"])
    assert abs(Fraction(free["low"]) - given) <= scene.start_error[1]
    assert Fraction(free["low"]) < Fraction(free["high"])


def test_an_exact_start_has_no_graze_that_balls_could_prove() -> None:
    """The same digits as an exact start miss the belt, or meet it: what they do is proven, and it is no graze."""
    scene = load_scene("fig7-exact")
    exact = Scene("exact", scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end)
    certificate = certify(exact)
    assert certificate.proven
    assert "graze" not in [event[0] for event in certificate.events]
    assert certificate.statement["starts"] == "all"


def test_too_small_an_error_of_the_start_is_no_graze() -> None:
    certificate = certify("fig7-exact", start_error=["0", "1e-50", "1e-50"])
    assert certificate.proven
    assert "graze" not in [event[0] for event in certificate.events]


@pytest.mark.parametrize(("mapping", "t_m"), [("P2", "3.14"), ("P2", "3.3"), ("P3", "3.14")])
def test_starts_before_other_touches(mapping: str, t_m: str) -> None:
    p = load_scene("fig7-corrected" if mapping == "P2" else "fig8").parameters
    start = grazing_start(p, mapping, t_m=t_m, t0="2.5", digits=40).start
    exact = {name: Fraction(start[name]) for name in ("x0", "v0")}
    scene = Scene("touch", p, Fraction("2.5"), **exact, t_end=Fraction(4), start_error=("0", "1e-30", "1e-30"))
    certificate = certify(scene)
    assert certificate.proven, certificate.message
    kind, _, _, (low, high), _ = certificate.events[0]
    assert kind == "graze"
    assert abs(Fraction(low) - Fraction(t_m)) < Fraction(1, 10**22)
    assert Fraction(low) < Fraction(high)


@pytest.mark.parametrize("units", [-9, -2, 0, 2, 9])
def test_starts_beside_the_one_that_touches_have_no_zero(units: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Krawczyk's operator finds the zero of gap and acceleration only if it is between the two fractions."""
    free_value, shifted = graze._free_value, []

    def beside(*arguments: Any) -> Any:
        share, near = free_value(*arguments)
        shifted.append(share)
        return share + units * arb(10) ** -int(ctx.prec * 0.301 / 2.5 + 1), near

    monkeypatch.setattr(graze, "_free_value", beside)
    certificate = certify("fig7-exact")
    assert shifted
    assert certificate.proven is (units == 0)


@pytest.mark.slow
def test_a_touch_after_another_event() -> None:
    """The flight starts with a crossing before the belt that it grazes; only the velocity's error is not 0."""
    p = load_scene("fig9").parameters
    touching = certify(_after_a_crossing(p), start_error=["0", "0", "1e-20"])
    assert touching.proven, touching.message
    assert [event[0] for event in touching.events][:2] == ["cross", "graze"]
    assert touching.statement["free"]["name"] == "v0"


def _after_a_crossing(p: object) -> Scene:
    """Return a start whose second event is a touch of belt 2, found by halving v2 between a miss and a contact."""
    from symosc import simulate

    scene = load_scene("fig9")
    low, high = Fraction(2), Fraction(25)
    for _ in range(75):
        v2 = (low + high) / 2
        run = simulate(scene.parameters.replace(v2=v2), t0=scene.t0, x0=scene.x0, v0=0, t_end="2.2", digits=30)
        met = any(event.boundary == 2 for event in run.events)
        low, high = (v2, high) if met else (low, v2)
    digits = Fraction(round(low * 10**26), 10**26)
    return Scene("second", scene.parameters.replace(v2=digits), scene.t0, scene.x0, Fraction(0), Fraction("2.2"))
