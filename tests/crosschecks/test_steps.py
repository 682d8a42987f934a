"""The exact motion over each step, and how far right samples may be off."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from careful_solver import random_parameters
from oracle import flow_oracle

from symosc import load_scene, simulate
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.steps import follow_steps, propagated, sample_errors
from symosc.engine.events import KIND_NAMES
from symosc.friction import MODE_NAMES

# -- steps one by one ------------------------------------------------------------------------------


def test_steps_are_those_of_single_motions() -> None:
    """Random samples of random systems, on belts and off, with times that are repeated.

    Each step on its own.
    """
    rng = np.random.default_rng(3)
    kinds = set()
    for _ in range(8):
        p = random_parameters(rng)
        belts = [float(p.v1), float(p.v2)]
        t = np.sort(rng.uniform(0, 12, 14))
        t[[4, 9]] = t[[5, 10]]  # pairs of one time
        t = np.sort(t)
        x = rng.uniform(-4, 4, 14)
        v = rng.choice([*belts, *rng.uniform(-4, 4, 3)], 14)
        steps = follow_steps(p, t, x, v, 0.0, np.ones(2))
        for i in range(13):
            if t[i] == t[i + 1]:
                kinds.add("jump")
                assert steps.defects[i] == pytest.approx([x[i] - x[i + 1], v[i] - v[i + 1]], abs=0)
                assert steps.first[i] == steps.last[i] == steps.last[i - 1]
                continue
            motion = simulate(
                p, t0=float(t[i]), x0=float(x[i]), v0=float(v[i]), t_end=float(t[i + 1])
            )
            assert steps.defects[i] == pytest.approx(
                motion(t[i + 1]) - [x[i + 1], v[i + 1]], abs=1e-10
            )
            modes = [MODE_NAMES[code] for code in (steps.first[i], steps.last[i])]
            assert modes == [motion.segments[0].mode, motion.segments[-1].mode]
            rows = steps.events.rows(i, i)
            assert steps.events.t[rows] == pytest.approx(
                [float(event.t) for event in motion.events], abs=1e-9
            )
            assert [MODE_NAMES[code] for code in steps.events.target[rows]] == [
                event.target for event in motion.events
            ]
            assert steps.events.boundary[rows].tolist() == [
                event.boundary for event in motion.events
            ]
            assert [KIND_NAMES[code] for code in steps.events.kind[rows]] == [
                event.kind for event in motion.events
            ]
            kinds |= {event.kind for event in motion.events}
    assert kinds >= {"jump", "stick", "slip", "cross"}


def test_a_sample_beside_a_belt_is_where_the_next_sample_says() -> None:
    """Within `near` both are tried.

    Of samples that are on the belt but for noise, and of such that fly beside it.
    """
    rng = np.random.default_rng(4)
    p = load_scene("fig5").parameters
    motion = simulate("fig5", t_end=12)
    stick = next(segment for segment in motion.segments if segment.mode == "belt1")
    t = np.linspace(float(stick.t_start), float(stick.t_end), 9)[1:-1]
    x, v = motion(t)
    noise = 1e-7 * rng.standard_normal(len(t))
    for near, sticks in ((1e-5, True), (1e-9, False)):
        steps = follow_steps(p, t, x, v + noise, near, np.ones(2))
        assert (steps.first == 4).all() == sticks  # those above the belt fly down to it first
        if sticks:
            assert (steps.last == 4).all()
            assert not len(steps.events.t)
            assert np.abs(steps.defects[:, 1]) == pytest.approx(np.abs(noise[1:]), abs=1e-12)
    fig9 = load_scene("fig9").parameters  # it crosses: beside the belt it flies, whatever is near
    event = simulate("fig9", t_end=8).events[1]
    t = float(event.t) + np.array([-0.1, -1e-8, 0.1])
    x, v = simulate("fig9", t_end=8)(t)
    wide, narrow = (follow_steps(fig9, t, x, v, near, np.ones(2)) for near in (1e-4, 0.0))
    assert wide.defects == pytest.approx(narrow.defects, abs=1e-6)
    assert np.abs(wide.defects).max() < 1e-6


def test_a_flight_is_that_of_its_domain_alone() -> None:
    rng = np.random.default_rng(5)
    p = load_scene("fig10").parameters
    t = np.array([0.0, 0.4, 0.7])
    steps = follow_steps(p, t, rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3), 0.0, np.ones(2))
    for domain in (1, 2, 3):
        for i, j in ((0, 1), (0, 2), (1, 2)):
            ends = steps.flight(domain, np.array([i]), np.array([j]))[0]
            start = Fraction(float(t[i])), Fraction(float(steps.x[i])), Fraction(float(steps.v[i]))
            right = flow_oracle(p, domain, *start, Fraction(float(t[j])) - start[0], dps=25)[:2]
            assert ends == pytest.approx([float(value) for value in right], abs=1e-12)


def test_a_time_is_in_the_step_that_begins_with_it_and_outside_in_the_nearest() -> None:
    steps = follow_steps(
        load_scene("fig10").parameters,
        np.array([0, 0.5, 1, 1.5]),
        np.zeros(4),
        np.zeros(4),
        0.0,
        np.ones(2),
    )
    places = {time: steps.at(time) for time in (-9.0, 0.25, 0.5, 0.75, 1.5, 9.0)}
    assert places == {
        -9.0: (0, 0),
        0.25: (0, 0),
        0.5: (1, 1),
        0.75: (1, 1),
        1.5: (2, 2),
        9.0: (2, 2),
    }
    assert (steps.at(0.5, 0.125), steps.at(0.75, 0.5), steps.at(0.0, 0.125)) == (
        (0, 1),
        (0, 2),
        (0, 0),
    )


# -- allowed ---------------------------------------------------------------------------------------


def test_rounded_samples_may_be_off_by_their_rounding_and_that_of_their_times() -> None:
    """The exact state at the written time is as near to the sample as said."""
    rng = np.random.default_rng(2)
    for name in ("fig5", "fig9", "fig10"):
        exact = simulate(name)
        t = np.sort(rng.uniform(1, 9, 300))
        for decimals in (1, 2, 4):
            written = np.round(t, decimals)
            (x, v) = np.round(exact(t), decimals)
            half = np.full((3, 300), 0.5 * 10.0**-decimals)
            loose = sample_errors(exact.parameters, Samples(written, x, v), half)
            off = np.abs(np.column_stack([x, v]) - exact(written).T)
            assert (off <= loose + 1e-12).all()
            assert (np.max(off, axis=0) > 0.05 * np.max(loose, axis=0)).all()


@pytest.mark.slow
def test_exact_motions_stay_as_near_as_is_said() -> None:
    """Of random systems and starts, through switchings and sticks.

    A bound that is reached at some time.
    """
    rng = np.random.default_rng(3)
    nearest = 0.0
    for number in range(40):
        p = random_parameters(rng)
        if number % 10 == 0:
            p = p.replace(k=0)
        start = rng.uniform(-4, 4, 2)
        off = rng.uniform(0, 10.0 ** rng.uniform(-3, 0), 2)
        motion = simulate(p, t0=0, x0=start[0], v0=start[1], t_end=12)
        shifted = simulate(p, t0=0, x0=start[0] + off[0], v0=start[1] - off[1], t_end=12)
        t = np.linspace(0, min(motion.t_end, shifted.t_end), 400)
        most = propagated(p, off, t)
        apart = np.abs(motion(t) - shifted(t)).T
        assert (apart <= most * (1 + 1e-9) + 1e-12).all()
        nearest = max(nearest, float(np.max(apart[50:] / most[50:])))
    assert nearest > 0.95
    assert not propagated(p, np.zeros(2), 1.0).any()
