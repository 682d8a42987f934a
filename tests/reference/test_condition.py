"""Condition numbers: how much an event moves with the numbers that the problem is given in."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import inf
from typing import Any

import pytest

from symosc import Parameters, Scene, load_scene, simulate
from symosc.reference.condition import conditions, shifted
from symosc.reference.hard_cases import (
    hard_cases,
)

CASES = {(case.group, case.name): case for case in hard_cases()}


def test_the_condition_of_a_constant_acceleration() -> None:
    """With A = A0 + (mu1 + mu2) FN, v = v0 + A t/m meets v1 after m (v1 - v0)/A, at x0 + m (v1^2 - v0^2)/(2 A)."""
    p = Parameters(m=3, c=0, k=0, A0=1, B0=0, Omega=1, v1=5, v2=9, mu1="0.3", mu2="0.2", FN=2)
    scene = Scene("constant", p, Fraction(7), Fraction(11), Fraction(-1), Fraction(30))
    m, A, v1, v0, x0, t0 = 3, 2, 5, -1, 11, 7
    passed, way = m * (v1 - v0) / A, m * (v1**2 - v0**2) / (2 * A)
    shares = (1, 0.6, 0.4, 1)  # A0, mu1 FN, mu2 FN, FN itself, as parts of A
    by_force = sum(shares) / A
    t = (t0 + passed * (1 + by_force) + m * (v1 + abs(v0)) / A) / (t0 + passed)
    x = (x0 + way * (1 + by_force) + m * (v1**2 + v0**2) / A) / (x0 + way)
    assert conditions(scene)[0] == pytest.approx(max(t, x), rel=1e-12)


@pytest.mark.slow
def test_near_a_graze_the_condition_grows_with_the_root_of_the_distance() -> None:
    worst = [max(conditions(CASES["peak beyond a belt", f"by 1e-{n} (P2, fig7-corrected)"].scene)) for n in (7, 11)]
    assert worst[1] / worst[0] == pytest.approx(100, rel=0.01)


def test_a_start_on_a_belt_moves_with_it() -> None:
    scene, step = load_scene("fig9"), Fraction(1, 8)
    assert shifted(scene, "v0", step) == scene
    moved = shifted(scene, "v1", step)
    assert moved.v0 == moved.parameters.v1 == Fraction(9, 8)
    assert shifted(scene, "v2", step).v0 == 1
    assert shifted(scene, "x0", step).x0 == scene.x0 * 9 / 8
    assert shifted(scene, "m", step).parameters == scene.parameters.replace(m="0.1125")


def test_numbers_that_are_zero_do_not_count() -> None:
    assert shifted(load_scene("fig5"), "t0", Fraction(1, 8)) == load_scene("fig5")


def test_events_that_any_change_turns_into_others_have_no_condition() -> None:
    scene = load_scene("fig5")
    first, second, third = simulate(scene, digits=130, max_events=3).events

    def touching(neighbour: Scene, digits: int) -> Any:
        k = neighbour.parameters.k
        graze = replace(second, kind="graze" if k == scene.parameters.k else "stick")
        return [replace(first, t=first.t + digits_of(k - scene.parameters.k, first)), graze, third]

    def digits_of(value: Fraction, event: Any) -> Any:
        return event.t.context.mpf(value.numerator) / value.denominator

    found = conditions(scene, touching)
    assert found[0] == pytest.approx(float(1 / max(1, first.t)))
    assert found[1:] == [inf, inf]
