"""solve_map: where a mapping leads."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from map_points import draw
from oracle import simulate_oracle

from symosc import Parameters, load_scene, simulate
from symosc.errors import ParameterError
from symosc.mappings.equations import jacobian
from symosc.mappings.solve import MapError, solve_map
from symosc.simulation.trajectory import MAP_LABELS
from symosc.words import MAPS


@pytest.mark.parametrize("name", ["fig6", "fig9", "fig10", "fig9-orbit", "fig10-orbit"])
def test_solve_map_follows_the_simulator(name: str) -> None:
    scene = load_scene(name)
    p, Omega = scene.parameters, float(scene.parameters.Omega)
    events = simulate(scene, max_events=12).events
    for before, after in itertools.pairwise(events):
        label = MAP_LABELS[before.boundary, before.target, after.boundary]
        found = solve_map(p, label, before.x, before.theta + 4 * np.pi)
        assert found.x == pytest.approx(after.x, abs=1e-10)
        assert found.theta - before.theta - 4 * np.pi == pytest.approx(Omega * (after.t - before.t), abs=1e-10)
        assert (found.exit is not None) == (after.kind == "slip")


@pytest.fixture
def p() -> Parameters:
    return load_scene("fig10").parameters


@pytest.mark.parametrize(
    "start", [("a", 0), (None, 0), (1, None), (1j, 0), (1, "0"), (float("nan"), 0), (np.ones(2), 0)]
)
def test_solve_map_names_what_is_no_number(p: Parameters, start: Any) -> None:
    with pytest.raises(ParameterError, match=r"x_i|theta_i"):
        solve_map(p, "P5", *start)


def starts(rng: random.Random) -> Iterator[tuple[Parameters, Fraction, Fraction, str, Any]]:
    """Yield random starts on a belt with the map that the equation of motion follows there, and its end."""
    while True:
        p = draw(rng, rng.choice(["underdamped", "overdamped", "undamped", "critical"]))
        x, theta = Fraction(f"{rng.uniform(-8, 8):.6g}"), Fraction(f"{rng.uniform(-40, 40):.6g}")
        belt = rng.choice([1, 2])
        # A time after which the clock of the oracle starts at a phase of this size.
        run = simulate_oracle(p, theta / p.Omega, x, p.belt(belt), theta / p.Omega + 30, 25, max_events=1)
        if run.events and run.events[0].kind != "graze":
            event = run.events[0]
            yield p, x, theta, MAP_LABELS[belt, event.source, event.boundary], event


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [None, 25])
def test_a_map_is_what_the_equation_of_motion_does(digits: int | None) -> None:
    """From random points of both belts, at phases of many turns and below 0: the end, the exit, and other labels."""
    rng, context = random.Random(6), mpmath.mp.clone()
    context.dps = digits or 15
    source, said = starts(rng), set()
    for _ in range(25 if digits is None else 4):
        p, x, theta, label, event = next(source)
        number = float if digits is None else lambda q: context.mpf(q.numerator) / q.denominator
        found = solve_map(p, label, number(x), number(theta))
        allowed = 1e-9 if digits is None else 1e-18
        with mpmath.workdps(40):
            assert abs(found.x - event.x) < allowed * (1 + abs(float(event.x)))
            assert abs(found.theta - event.t * p.Omega.numerator / p.Omega.denominator) < allowed * 100
        slips = event.kind == "slip"
        assert found.exit == (None if not slips else "above" if int(event.target[-1]) > event.boundary else "below")
        assert not found.grazing
        said.add(label)
        right = MAPS[label]
        for row in (row for row in MAPS.values() if row.start.boundary == right.start.boundary and row != right):
            with pytest.raises(MapError) as caught:
                solve_map(p, row.label, number(x), number(theta))
            error = caught.value
            assert error.label == row.label
            if row.mode == right.mode:
                assert error.actual == label
                assert f"ends on belt {event.boundary}: that is {label}" in str(error)
            else:
                goes = f"the motion {'stays on' if right.sticks else 'goes into'} {event.source} there, since F^("
                assert error.actual is None
                assert f"{goes}{row.start.boundary}) = " in str(error)
    assert len(said) >= (6 if digits is None else 2)


def test_derivatives_are_those_of_the_equation_of_motion() -> None:
    """By differences of the oracle's ends, in x and in the phase."""
    source, h = starts(random.Random(7)), Fraction(1, 10**9)
    for _ in range(6):
        p, x, theta, label, _ = next(source)
        found = solve_map(p, label, float(x), float(theta)).derivative
        assert found is not None
        belt, columns = MAPS[label].start.boundary, []
        for dx, dtheta in ((h, 0), (0, h)):
            ends = []
            for sign in (1, -1):
                t = (theta + sign * dtheta) / p.Omega
                run = simulate_oracle(p, t, x + sign * dx, p.belt(belt), t + 30, 30, max_events=1)
                ends.append((run.events[0].x, run.events[0].t * p.Omega.numerator / p.Omega.denominator))
            columns.append([float((a - b) / (2 * mpmath.mpf(10) ** -9)) for a, b in zip(*ends, strict=True)])
        size = 1 + np.abs(found).max()
        assert found == pytest.approx(np.array(columns).T, abs=1e-5 * size)


@pytest.mark.parametrize("digits", [None, 30])
def test_a_start_may_be_at_0(digits: int | None) -> None:
    """x = 0 and theta = 0 are numbers like others: the end is that of a start beside them."""
    context = mpmath.mp.clone()
    context.dps = digits or 15
    number = float if digits is None else context.mpf
    p = load_scene("fig9").parameters
    found, beside = (solve_map(p, "P3", number(x), number(0)) for x in (0, 1e-9))
    assert abs(found.x - beside.x) < 1e-7
    assert abs(found.theta - beside.theta) < 1e-7


def test_derivatives_keep_all_digits() -> None:
    """Also those of sticks, whose matrix has whole numbers in it: they are not rounded to doubles."""
    context = mpmath.mp.clone()
    context.dps = 40
    p = load_scene("fig10").parameters
    for label in ("P1", "P4", "P2", "P6"):
        x, theta = context.mpf(1) / 3, context.mpf(2) / 7
        found = jacobian(p, label, (x, theta), (context.mpf(-1) / 7, theta + context.mpf(1) / 3))
        assert found.dtype == object
        exact = [entry for entry in found.ravel() if hasattr(entry, "_mpf_") and entry != int(entry)]
        assert len(exact) >= 3
        assert all(entry != float(entry) for entry in exact)


def test_points_are_equal_by_where_they_are() -> None:
    p = load_scene("fig9").parameters
    one, same, other = (solve_map(p, "P2", 4.5, theta) for theta in (0.5, 0.5, 0.6))
    assert (one == same, one != same) == (True, False)
    assert (one == other, one != other) == (False, True)
