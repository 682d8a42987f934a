"""The search for a misprint finds one that was put in, and says so when there is none."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from symosc import find_orbit, load_scene
from symosc.paper.checks import starts
from symosc.paper.checks.periodic_figures import start_on_orbit
from symosc.paper.evidence import CONFIRMED, CORRECTED
from symosc.paper.misprints import search_parameters, search_start
from symosc.scenes import Scene

FIG9, FIG10 = load_scene("fig9"), load_scene("fig10")


def printed(orbit_scene: Scene) -> Scene:
    """Return the scene with the start that a paper would print: the orbit's first switching to four decimals."""
    t, x = find_orbit(orbit_scene.parameters, orbit_scene.structure).points[0]
    return replace(orbit_scene, t0=f"{t:.4f}", x0=f"{x:.4f}")


@pytest.mark.slow
@pytest.mark.parametrize(("name", "true"), [("Omega", "3.9"), ("c", "0.3"), ("mu1", "0.25")])
def test_a_misprinted_parameter_is_found(name: str, true: str) -> None:
    right = printed(replace(FIG9, parameters=FIG9.parameters.replace(**{name: true})))
    wrong = replace(right, parameters=FIG9.parameters)
    found, other = search_parameters(wrong, (name, "m"))
    assert found.name == name
    assert found.orbit
    assert found.distance <= starts.PRINTED_HALF_UNIT
    assert found.value == pytest.approx(float(true), abs=2e-3)
    assert found.searched[0] < float(true) < found.searched[1]
    assert other.distance > starts.PRINTED_HALF_UNIT


@pytest.mark.slow
@pytest.mark.parametrize(("name", "true"), [("Omega", "1.7"), ("mu2", "0.33")])
def test_a_misprinted_parameter_of_a_motion_with_sticks_is_found(name: str, true: str) -> None:
    right = printed(replace(FIG10, parameters=FIG10.parameters.replace(**{name: true})))
    (found,) = search_parameters(replace(right, parameters=FIG10.parameters), (name,))
    assert found.distance <= starts.PRINTED_HALF_UNIT
    assert found.value == pytest.approx(float(true), abs=2e-3)


@pytest.mark.parametrize("name", ["t0", "x0"])
def test_a_misprinted_start_is_found(name: str) -> None:
    right = printed(FIG9)
    wrong = replace(right, **{name: getattr(right, name) + Fraction(1, 2)})
    found = {each.name: each for each in search_start(wrong)}
    assert found[name].distance <= starts.PRINTED_HALF_UNIT
    assert found[name].value == pytest.approx(float(getattr(right, name)), abs=1e-4)
    assert all(each.distance > starts.PRINTED_HALF_UNIT for other, each in found.items() if other != name)


@pytest.mark.slow
def test_verdicts_follow_from_the_numbers() -> None:
    on_orbit = printed(FIG9)
    assert starts.start(on_orbit) == start_on_orbit(on_orbit)
    assert starts.misprint(on_orbit).verdict == CONFIRMED
    shifted = starts.start(replace(on_orbit, x0=on_orbit.x0 + 1))
    assert "The start is not on the periodic motion" in shifted.finding
    # A0 and mu2 shift the orbit in x, as x0 does: three explanations, and the evidence names them all.
    assert shifted.verdict == CORRECTED
    assert all(name in shifted.finding for name in ("A0 =", "mu2 =", "x0 ="))


def test_the_start_of_fig10_ends_a_stick_only_without_damping() -> None:
    scene = load_scene("fig10")
    numbers = starts._end_of_stick(scene)
    assert numbers["m F⁽²⁾ at the start"].startswith("-0.1995 ± 0.0007")
    assert numbers["m F⁽²⁾ without the damping c v₂"].startswith("+0.0005 ± 0.0007")
    remark = starts._remark(scene, search_start(scene))
    assert "x0 = 3.0737 differs from the printed 3.0837 in one digit" in remark
    assert "t0" not in remark
