"""Rounded solutions of an independent solver: all wrong ones are found, no right one is blamed."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from rounded_solutions import DEVIATION, right, wrong_solutions

from symosc import crosscheck, load_scene, simulate

RUNS = [
    pytest.param(12, 600, id="few"),
    pytest.param(60, 1_000, marks=pytest.mark.slow),
    pytest.param(1_000, 4_000, marks=pytest.mark.campaign),
]


@pytest.mark.parametrize(("count", "samples"), RUNS)
def test_wrong_solutions_are_found(count: int, samples: int) -> None:
    """More than 20 last places off somewhere, with 0 to 5 decimals, against the scene or its parameters."""
    missed = []
    for number, wrong in enumerate(wrong_solutions(count, count, samples)):
        scene = wrong.scene if number % 4 else wrong.scene.parameters
        if crosscheck(scene, wrong.t, wrong.x, wrong.v).ok:
            missed.append(f"{wrong.scene.name}: {wrong.kind}, {wrong.decimals} decimals, off by {wrong.off:.3g} places")
    assert missed == []


@pytest.mark.parametrize(
    "count", [pytest.param(10, marks=pytest.mark.slow), pytest.param(100, marks=pytest.mark.campaign)]
)
def test_wrong_positions_are_found(count: int) -> None:
    """Without velocities: the positions alone are more than 20 last places off somewhere."""
    missed, off = [], (wrong for wrong in wrong_solutions(count, 10 * count, 1_500) if wrong.off_x > DEVIATION)
    for number, wrong in enumerate(islice(off, count)):
        scene = wrong.scene if number % 4 else wrong.scene.parameters
        if crosscheck(scene, wrong.t, wrong.x).ok:
            missed.append(f"{wrong.scene.name}: {wrong.kind}, {wrong.decimals} decimals, {wrong.off_x:.3g} places")
    assert missed == []


@pytest.mark.parametrize(("count", "samples"), RUNS)
def test_right_solutions_are_not_blamed(count: int, samples: int) -> None:
    """Dense and sparse, with velocities and without, of the scene's start or of a rounded one."""
    rng, blamed = np.random.default_rng(count), []
    for number in range(count):
        given = right(rng, samples)
        scene = given.scene if number % 3 else given.scene.parameters
        v = given.v if number % 4 or given.kind != "right" else None
        check = crosscheck(scene, given.t, given.x, v)
        if not check.ok:
            blamed.append(f"{given.scene.name}, {given.kind}, {given.decimals} decimals: {check.summary()}")
    assert blamed == []


def test_what_rounding_hid() -> None:
    """Half of c in fig5 with 2 decimals, and velocities 0, 2, 0, 2, ... each a nanosecond after the other."""
    t = np.linspace(0, 40, 8_001)
    p = load_scene("fig5").parameters
    x, v = np.round(simulate(p.replace(c=p.c / 2), t0=0, x0=0, v0=0, t_end=40)(t), 2)
    check = crosscheck("fig5", t, x, v)
    assert not check.ok
    assert check.max_error_x > 3
    assert check.limits_there[0] < 0.02
    assert f"(allowed there {check.limits_there[0]:.1e} and {check.limits_there[1]:.1e})" in check.summary()
    assert len(check.wrong_spans)
    t = np.arange(2_000) * 1e-9
    check = crosscheck("fig5", t, 0 * t, np.arange(2_000) % 2 * 2.0, partial=True)
    assert len(check.wrong_steps) == 1_999


def test_the_global_tolerance_is_obeyed_beside_the_rounding() -> None:
    t = np.linspace(0, 40, 4_001)
    x, v = np.round(np.array(simulate("fig5")(t)) + [[3e-3], [0]] * np.minimum(t, 1), 4)
    assert not crosscheck("fig5", t, x, v).ok
    for tolerance in (1e-12, 1e-4):
        check = crosscheck("fig5", t, x, v, global_tolerance=tolerance)
        assert not check.ok
        rounding = 0.5e-4 * (1 + 2**0.5)  # of the sample, and of the start where k = m
        assert np.max(check.limits[:, 0]) <= tolerance * check.scales[0] + rounding * 1.001
    exact = np.round(simulate("fig5")(t), 4)
    assert crosscheck("fig5", t, *exact, global_tolerance=1e-12).ok


def test_digits_that_are_cut_off_are_those_of_a_right_solution() -> None:
    t = np.linspace(0.1324, 10, 900)
    exact = simulate("fig9")(t)
    for cut, way in ((np.trunc, "cut off"), (np.floor, "rounded down")):
        check = crosscheck("fig9", t, *(cut(np.array(exact) * 1e3) / 1e3))
        assert check.ok, check.summary()
        assert any(f"the last digits are {way}" in note for note in check.notes)
