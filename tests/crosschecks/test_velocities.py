"""Velocities of positions that were given without."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from careful_solver import random_parameters
from excerpts import crosscheck

from symosc import ParameterError, load_scene, simulate
from symosc.crosschecks import velocities
from symosc.crosschecks.samples import checked_positions
from symosc.crosschecks.velocities import NOTE, with_velocities
from symosc.engine.flow import constants


def test_velocities_are_those_of_the_motion() -> None:
    """Random systems and times: across events, in sticks, at the ends; errors as far as they are said to be."""
    rng, events, far, left_out = np.random.default_rng(7), 0, 0, 0
    for _ in range(12):
        p = random_parameters(rng)
        motion = simulate(p, t0=0, x0=float(rng.uniform(-2, 2)), v0=float(rng.uniform(-4, 4)), t_end=8)
        if motion.status not in ("t_end", "equilibrium"):
            continue
        t = np.sort(rng.uniform(0, float(motion.t_end), 300))
        x, v = motion(t)
        found = with_velocities(checked_positions(t, x), p, 1e-8)
        assert found.v_off is not None
        error = np.abs(found.v - v[len(v) - len(found.v) :])
        left_out += len(v) - len(found.v)
        far += int(np.sum(error > found.v_off + 1e-7))
        events += len(motion.events)
        assert np.median(error) < 1e-11
    assert events > 20
    assert left_out <= 4  # two motions have an event in their first step
    assert far == 0


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "count"), [("fig5", 400), ("fig9", 40), ("fig10", 200), ("fig5", 1000)])
def test_right_positions_pass_and_wrong_ones_do_not(name: str, count: int) -> None:
    scene = load_scene(name)
    t = np.linspace(float(scene.t0), float(scene.t0) + 8, count)
    x = simulate(scene, t_end=float(t[-1]))(t)[0]
    check = crosscheck(scene, t, x)
    assert check.ok, check.summary()
    assert NOTE in check.notes
    events = [event.kind for event in simulate(scene, t_end=float(t[-1])).events]
    assert [match.event.kind for match in check.matched] == events
    assert not crosscheck(scene, t, x + 1e-3 * (t > 5)).ok
    other = simulate(
        scene.parameters.replace(mu1=scene.parameters.mu1 * 2), t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=9
    )
    assert not crosscheck(scene, t, other(t)[0]).ok


def test_rounded_positions_pass() -> None:
    t = np.linspace(0.2, 6, 200)
    x = simulate("fig9", t_end=7)(t)[0]
    for digits in (4, 6, 9):
        assert crosscheck(load_scene("fig9").parameters, t, np.round(x, digits)).ok


def test_positions_that_are_too_far_apart_are_refused() -> None:
    p = load_scene("fig9").parameters
    with pytest.raises(ParameterError, match="too far apart to tell it: give velocities"):
        crosscheck(p, [0.0, 3.0, 6.0], [1.0, 2.0, 3.0])
    assert not crosscheck("fig9", np.linspace(0.1324, 5, 9), np.linspace(1, 9, 9)).ok


@pytest.mark.parametrize("decimals", [pytest.param(5, marks=pytest.mark.slow), 15])
def test_dense_positions_of_another_force_are_wrong(decimals: int) -> None:
    """Not too far apart: no two steps agree about a velocity, and no scene tells the first one."""
    p, t = load_scene("fig9").parameters.replace(v1=-500, v2=500), np.linspace(0, 10, 801)
    x = np.round(simulate(p.replace(A0=p.A0 + 1), t0=0, x0=1, v0=1, t_end=10)(t)[0], decimals)
    check = crosscheck(p, t, x)
    assert not check.ok
    assert len(check.t) == 801


def test_a_step_can_be_a_stick_if_it_moves_as_the_belt_does() -> None:
    """As far as both its ends are off; never at a joint of two pieces."""
    K = constants(load_scene("fig9").parameters)
    t = np.array([0.0, 1.0, 1.5, 1.5, 3.5])
    for number, belt in enumerate((K.belt1.v, K.belt2.v)):
        for off, part in itertools.product((0.25, np.array([0.5, 0.125, 0.25, 0.25, 1.0])), (-1.01, -0.99, 0.99, 1.01)):
            wide = np.broadcast_to(off, t.shape)
            x = belt * t
            x[1:] += np.cumsum(part * (wide[:-1] + wide[1:]))
            found = velocities._held(t, x, off, K)
            near = np.array([abs(part) < 1] * 2 + [False] + [abs(part) < 1])
            assert np.array_equal(found[number], np.where(near, belt, np.nan), equal_nan=True)


def test_two_steps_agree_where_their_candidates_are_nearest() -> None:
    """A belt's velocity is taken as it is, else the mean; the other ends of both steps are known too."""
    rng = np.random.default_rng(4)
    for _ in range(30):
        starts, ends = rng.uniform(-1, 1, (5, 6)), rng.uniform(-1, 1, (5, 6))
        starts[rng.random((5, 6)) < 0.3] = np.nan
        best, left, right = velocities._nearest(starts, ends)
        for n in range(5):
            gaps = np.abs(ends[:, n, None] - starts[None, :, n + 1])
            if np.isnan(gaps).all():
                assert best[n] == np.inf
                continue
            assert best[n] == np.nanmin(gaps) == gaps[left[n], right[n]]
        sure = np.flatnonzero(best < np.inf)[:1]
        v = velocities._agreed(starts, ends, left, right, sure)
        known = set()
        for n in sure.tolist():
            arrives, leaves = ends[left[n], n], starts[right[n], n + 1]
            middle = arrives if left[n] > 2 else leaves if right[n] > 2 else (arrives + leaves) / 2
            assert v[n + 1] == pytest.approx(middle)
            assert np.array_equal(v[[n, n + 2]], [starts[left[n], n], ends[right[n], n + 1]], equal_nan=True)
            known |= {n, n + 1, n + 2}
        assert np.isnan(v[[n for n in range(7) if n not in known]]).all()
