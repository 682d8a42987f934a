"""The exact motion over each step, and how far right samples may be off."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from careful_solver import random_parameters
from oracle import flow_oracle

from symosc import load_scene, simulate
from symosc.crosschecks import steps
from symosc.crosschecks.events import CODES
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.steps import follow_steps, phases, propagated, quiet_ends, sample_errors
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.events import KIND_NAMES
from symosc.engine.start import start_rows
from symosc.model import MODE_NAMES

# -- steps -------------------------------------------------------------------------------------------------------------


def test_phases_at_large_times() -> None:
    rng = np.random.default_rng(7)
    p = load_scene("fig10").parameters.replace(Omega="1/3")
    t = np.concatenate([10.0 ** rng.uniform(-3, 14, 200), [0.0, -1.5]])
    theta = phases(p, t)
    import mpmath

    with mpmath.workdps(50):
        exact = [float(mpmath.fmod(mpmath.mpf(time) / 3, 2 * mpmath.pi)) for time in t]
    np.testing.assert_allclose(theta, exact, rtol=0, atol=2e-15)


# -- steps one by one --------------------------------------------------------------------------------------------------


def test_steps_are_those_of_single_motions() -> None:
    """Random samples of random systems, on belts and off, with times that are repeated: each step on its own."""
    rng, kinds = np.random.default_rng(3), set()
    for _ in range(8):
        p = random_parameters(rng)
        belts = [float(p.v1), float(p.v2)]
        t = np.sort(rng.uniform(0, 12, 14))
        t[[4, 9]] = t[[5, 10]]  # pairs of one time
        t = np.sort(t)
        x, v = rng.uniform(-4, 4, 14), rng.choice([*belts, *rng.uniform(-4, 4, 3)], 14)
        steps = follow_steps(p, t, x, v, 0.0, np.ones(2))
        for i in range(13):
            if t[i] == t[i + 1]:
                kinds.add("jump")
                assert steps.defects[i] == pytest.approx([x[i] - x[i + 1], v[i] - v[i + 1]], abs=0)
                assert steps.first[i] == steps.last[i] == steps.last[i - 1]
                continue
            motion = simulate(p, t0=float(t[i]), x0=float(x[i]), v0=float(v[i]), t_end=float(t[i + 1]))
            assert steps.defects[i] == pytest.approx(motion(t[i + 1]) - [x[i + 1], v[i + 1]], abs=1e-10)
            modes = [MODE_NAMES[code] for code in (steps.first[i], steps.last[i])]
            assert modes == [motion.segments[0].mode, motion.segments[-1].mode]
            rows = steps.events.rows(i, i)
            assert steps.events.t[rows] == pytest.approx([float(event.t) for event in motion.events], abs=1e-9)
            assert [MODE_NAMES[code] for code in steps.events.target[rows]] == [event.target for event in motion.events]
            assert steps.events.boundary[rows].tolist() == [event.boundary for event in motion.events]
            assert [KIND_NAMES[code] for code in steps.events.kind[rows]] == [event.kind for event in motion.events]
            kinds |= {event.kind for event in motion.events}
    assert kinds >= {"jump", "stick", "slip", "cross"}


def test_a_sample_beside_a_belt_is_where_the_next_sample_says() -> None:
    """Within `near` both are tried: of samples that are on the belt but for noise, and of such that fly beside it."""
    rng, p = np.random.default_rng(4), load_scene("fig5").parameters
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


def test_a_time_belongs_to_its_step_and_with_slack_to_its_neighbours() -> None:
    t = np.array([0.0, 1.0, 1.0, 2.0, 4.0])
    p = load_scene("fig9").parameters
    steps = follow_steps(p, t, np.zeros(5), np.zeros(5), 0.0, np.ones(2))
    for time, slack, right in (
        (-1, 0, (0, 0)), (0, 0, (0, 0)), (0.5, 0, (0, 0)), (1.0, 0, (2, 2)), (1.5, 0.6, (0, 3)), (1.5, 0.4, (2, 2)),
        (2.1, 0.2, (2, 3)), (4.0, 0, (3, 3)), (9.0, 0, (3, 3)), (9.0, 7.5, (2, 3)),
    ):  # fmt: skip
        assert steps.at(time, slack) == right


def test_a_flight_is_that_of_its_domain_alone() -> None:
    rng, p = np.random.default_rng(5), load_scene("fig10").parameters
    t = np.array([0.0, 0.4, 0.7])
    steps = follow_steps(p, t, rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3), 0.0, np.ones(2))
    for domain in (1, 2, 3):
        for i, j in ((0, 1), (0, 2), (1, 2)):
            found = steps.flight(domain, np.array([i]), np.array([j]))[0]
            start = Fraction(float(t[i])), Fraction(float(steps.x[i])), Fraction(float(steps.v[i]))
            right = flow_oracle(p, domain, *start, Fraction(float(t[j])) - start[0], dps=25)[:2]
            assert found == pytest.approx([float(value) for value in right], abs=1e-12)


@pytest.mark.parametrize(("name", "t_end", "doubtful"), [("fig5", 6.0, False), ("fig7-exact", 8.0, True)])
def test_only_what_doubles_leave_open_is_followed_by_itself(
    name: str, t_end: float, doubtful: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A contact within rounding, such as that of a motion that grazes: its step, and no other one."""
    scene, alone = load_scene(name), []
    exact = simulate(scene, t_end=t_end)
    t = np.linspace(float(scene.t0), t_end, 31)
    x, v = exact(t)
    follow_one = steps._follow_one

    def followed(batch: Any, rows: Any, i: int, K: Any) -> Any:
        alone.append(i)
        return follow_one(batch, rows, i, K)

    monkeypatch.setattr(steps, "_follow_one", followed)
    found = follow_steps(scene.parameters, t, x, v, 1e-9, np.ones(2))
    assert np.abs(found.defects).max() < 1e-11
    assert found.events.t == pytest.approx([float(event.t) for event in exact.events])
    assert found.events.kind.tolist() == [CODES[event.kind] for event in exact.events]
    assert len(alone) == doubtful


# -- quiet -------------------------------------------------------------------------------------------------------------


def test_quiet_steps_are_those_of_the_event_search() -> None:
    """Random systems, steps from far below a period to near the limit, samples near belts, on them and far away."""
    rng, seen, there = np.random.default_rng(11), {0: 0, 1: 0}, 0
    for _ in range(12):
        p = random_parameters(rng)
        K = Arithmetic(p).K._replace(sigmas=0.0)
        belts, count = np.array([K.belt1.v, K.belt2.v]), 150
        at = rng.integers(0, 3, count)
        beside = rng.choice(belts, count) + rng.choice([-1, 1], count) * 10.0 ** rng.uniform(-8, 1, count)
        v = np.where(at > 0, belts[at - 1], beside)
        theta, x, left = rng.uniform(0, 6.2, count), rng.uniform(-9, 9, count), 10.0 ** rng.uniform(-5, 0.5, count)
        rows, _ = start_rows(at, theta, x, v, (0.0, 0.0, left / K.rate, 0.0, 0.0), K)
        quiet, ends = quiet_ends(rows, left / K.rate, K)
        modes, exact, events = steps._follow(rows, left / K.rate, K)
        assert not np.isin(events.step, quiet).any()
        assert (modes[quiet] == rows[quiet, 0]).all()
        np.testing.assert_allclose(ends, exact[quiet], rtol=1e-13, atol=1e-13)
        there += len(np.unique(events.step))
        for held in (0, 1):
            seen[held] += int(np.sum((modes[quiet] > 3) == held))
    assert min(seen.values()) > 50
    assert there > 100


def test_most_steps_of_a_fine_run_are_quiet() -> None:
    rng = np.random.default_rng(5)
    p = random_parameters(rng)
    K = Arithmetic(p).K
    theta, x, v = rng.uniform(0, 6.2, 2000), rng.uniform(-5, 5, 2000), rng.uniform(-5, 5, 2000)
    left = np.full(2000, 1e-4 / K.rate)
    rows, _ = start_rows(np.zeros(2000, int), theta, x, v, (0.0, 0.0, left, 0.0, 0.0), K)
    quiet, _ = quiet_ends(rows, left, K)
    assert len(quiet) > 1900


def test_a_stick_that_ends_between_the_ends_of_a_step_is_not_quiet() -> None:
    """A force that passes 0 and is back, aimed at: at both ends of the step the mass would stick."""
    rng, there = np.random.default_rng(6), 0
    for _ in range(100):
        K = Arithmetic(random_parameters(rng)).K
        at = int(rng.integers(1, 3))
        belt = (K.belt1, K.belt2)[at - 1]
        if not belt.turns or K.w0sq == 0.0:
            continue
        left = rng.uniform(0.05, 0.45) / K.rate
        middle = rng.choice([belt.angle, np.pi - belt.angle])
        turned = np.cos(middle + np.array([-0.5, 0.5]) * K.Om * left)
        side = 1 if (turned - np.cos(middle)).max() * K.f0 < 0 else 0
        A, small = (K.A1, K.A2, K.A3)[at - 1 + side], rng.uniform(1e-6, 1e-3) * abs(K.f0) * (K.Om * left) ** 2
        force = small if side else -small
        x = (A + np.cos(middle) * K.f0 - belt.v * K.cm - force) / K.w0sq - 0.5 * belt.v * left
        ones = np.ones(1)
        theta = (middle - 0.5 * K.Om * left) % (2 * np.pi)
        rows, _ = start_rows(np.array([at]), theta * ones, x * ones, belt.v * ones, (0.0, 0.0, left, 0.0, 0.0), K)
        events = steps._follow(rows, left * ones, K)[2]
        there += rows[0, 0] > 3 and len(events.step) > 0
        if len(events.step):
            assert len(quiet_ends(rows, left * ones, K)[0]) == 0
    assert there > 10


# -- allowed -----------------------------------------------------------------------------------------------------------


def test_rounded_samples_may_be_off_by_their_rounding_and_that_of_their_times() -> None:
    """The exact state at the written time is as near to the sample as said."""
    rng = np.random.default_rng(2)
    for name in ("fig5", "fig9", "fig10"):
        exact = simulate(name)
        t = np.sort(rng.uniform(1, 9, 300))
        for decimals in (1, 2, 4):
            written, (x, v) = np.round(t, decimals), np.round(exact(t), decimals)
            half = np.full((3, 300), 0.5 * 10.0**-decimals)
            loose = sample_errors(exact.parameters, Samples(written, x, v), half)
            off = np.abs(np.column_stack([x, v]) - exact(written).T)
            assert (off <= loose + 1e-12).all()
            assert (np.max(off, axis=0) > 0.05 * np.max(loose, axis=0)).all()


@pytest.mark.slow
def test_exact_motions_stay_as_near_as_is_said() -> None:
    """Of random systems and starts, through switchings and sticks; a bound that is reached at some time."""
    rng, nearest = np.random.default_rng(3), 0.0
    for number in range(40):
        p = random_parameters(rng)
        p = p.replace(k=0) if number % 10 == 0 else p
        start, off = rng.uniform(-4, 4, 2), rng.uniform(0, 10.0 ** rng.uniform(-3, 0), 2)
        one = simulate(p, t0=0, x0=start[0], v0=start[1], t_end=12)
        other = simulate(p, t0=0, x0=start[0] + off[0], v0=start[1] - off[1], t_end=12)
        t = np.linspace(0, min(one.t_end, other.t_end), 400)
        most = propagated(p, off, t)
        apart = np.abs(one(t) - other(t)).T
        assert (apart <= most * (1 + 1e-9) + 1e-12).all()
        nearest = max(nearest, float(np.max(apart[50:] / most[50:])))
    assert nearest > 0.95
    assert not propagated(p, np.zeros(2), 1.0).any()
