"""Summaries against a slow reference: the trajectory of `simulate`, sampled.

Compiled or not, whole or in parts.
"""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from regimes import hundredths, regime_of_seed
from slow_summary import oracle_extremes, slow_summary

from symosc import Parameters, load_scene, simulate, simulate_many

FIG9 = load_scene("fig9").parameters


def scene(seed: int) -> tuple[Parameters, tuple[Any, ...], Fraction]:
    """Return parameters of all regimes of damping, a start that may be on a belt, and an end."""
    dice = random.Random(seed)
    p = regime_of_seed(dice, seed)
    t0 = dice.choice((Fraction(0), hundredths(dice, -3, 3)))
    x0 = hundredths(dice, -3, 3)
    v0 = dice.choice((p.v1, p.v2, hundredths(dice, -4, 4)))
    return p, (t0, x0, v0), t0 + hundredths(dice, 10, 40)


def compare(computed: dict[str, Any], expected: dict[str, Any], where: object) -> None:
    exact = ("status", "events", "sticks", "mode", "word", "multiplicity")
    assert {name: computed[name] for name in exact} == {name: expected[name] for name in exact}, (
        where
    )
    scale = 1 + max(abs(expected[name]) for name in ("x_min", "x_max", "v_min", "v_max"))
    for name in ("t", "x", "v", "stuck", "x_min", "x_max", "v_min", "v_max"):
        assert abs(computed[name] - expected[name]) <= 1e-8 * scale, (
            name,
            computed[name],
            expected[name],
            where,
        )
    np.testing.assert_allclose(computed["section"], expected["section"], rtol=0, atol=1e-9 * scale)


@pytest.mark.full(12)
@pytest.mark.quick(3)
@pytest.mark.parametrize("seed", range(24))
def test_a_summary_says_what_a_trajectory_shows(seed: int) -> None:
    p, (t0, x0, v0), t_end = scene(seed)
    skip = random.Random(seed).choice((0, 0, Fraction(7, 3)))
    summary = simulate_many(
        p, (t0, x0, v0), t_end, record="summary", skip=skip, sections=3, use_numba=False
    )
    trajectory = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end)
    compare(summary[0], slow_summary(p, trajectory, float(skip), 3), seed)


@pytest.mark.full(3)
@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(6))
def test_extremes_are_those_of_the_equation(seed: int) -> None:
    p, start, _ = scene(seed)
    end = start[0] + 4
    summary = simulate_many(
        p, start, end, record=("x_min", "x_max", "v_min", "v_max"), use_numba=False
    )
    expected = oracle_extremes(p, start, end)
    for name in "xv":
        size = abs(expected[f"{name}_min"]) + abs(expected[f"{name}_max"])
        for what in (f"{name}_min", f"{name}_max"):
            assert abs(getattr(summary, what)[0] - expected[what]) <= 1e-14 * size, (seed, what)


def test_what_doubles_leave_open_is_counted_from_more_digits() -> None:
    """Of grazes; and of fig8, whose errors grow."""
    exact = load_scene("fig8-exact")
    for scene, end in ((exact, exact.t_end), (load_scene("fig8"), Fraction(35))):
        arguments: Any = {
            "skip": 0,
            "sections": 2,
            "start_error": scene.start_error,
            "use_numba": False,
        }
        summary = simulate_many(
            scene.parameters, (scene.t0, scene.x0, scene.v0), end, record="summary", **arguments
        )
        compare(
            summary[0],
            slow_summary(scene.parameters, simulate(scene, t_end=end), 0.0, 2),
            scene.name,
        )


def test_a_motion_that_ends_at_its_last_event() -> None:
    summary = simulate_many(FIG9, (0, 0, 0), 100, record="summary", max_events=7, use_numba=False)[
        0
    ]
    alone = simulate(FIG9, t0=0, x0=0, v0=0, t_end=100, max_events=7)
    assert (summary["status"], summary["events"]) == ("max_events", 7)
    assert (summary["t"], summary["x"], summary["v"]) == pytest.approx(
        (alone.events[-1].t, alone.events[-1].x, 1.0)
    )


@pytest.mark.parametrize(("word", "periods"), [("P32", 1), ("P6454", 1)])
def test_orbits_repeat(word: str, periods: int) -> None:
    scene = load_scene({"P32": "fig9-orbit", "P6454": "fig10-orbit"}[word])
    end = scene.t0 + 60
    summary = simulate_many(
        scene.parameters, (scene.t0, scene.x0, scene.v0), end, record="summary", use_numba=False
    )
    assert summary.multiplicity.tolist() == [periods]
    assert summary.word[0] == word


def test_flights_of_a_drifting_mass_do_not_repeat() -> None:
    """Without a spring the velocity repeats to the last bit, and the mass goes on.

    Its turning points do not repeat.
    """
    p = Parameters(m=1, c=0, k=0, A0=0, B0=8, Omega=2, v1=-1, v2="-0.5", mu1=0, mu2=0, FN=1)
    summary = simulate_many(p, (0, 0, "0.01"), 60, record=("x_min", "x_max"), use_numba=False)
    trajectory = simulate(p, t0=0, x0=0, v0="0.01", t_end=60)
    x = trajectory(np.linspace(0, 60, 200_001))[0]
    assert summary.x_max[0] == pytest.approx(x.max(), abs=1e-7)
    assert summary.x_min[0] == pytest.approx(x.min(), abs=1e-7)


@pytest.mark.slow
def test_a_period_of_three() -> None:
    """Found by a search over Omega; each period has a word of its own."""
    p = FIG9.replace(Omega="1.3", FN=3)
    ends = [2 * math.pi / float(p.Omega) * n for n in (60, 61, 62, 63)]
    summary = simulate_many(p, (0, 0, 0), ends, record="summary", use_numba=False, sections=1)
    m = int(summary.multiplicity[0])
    expected = slow_summary(p, simulate(p, t0=0, x0=0, v0=0, t_end=ends[0]), 0.0, 1)
    assert m == expected["multiplicity"]


@pytest.mark.slow
def test_ends_that_are_whole_periods_count_however_they_are_rounded() -> None:
    ends = np.array([n * 2 * math.pi / 4 for n in range(2, 40)])
    ends = np.concatenate([np.nextafter(ends, 0), ends, np.nextafter(ends, 99)])
    summary = simulate_many(FIG9, (0, 0, 0), ends, record="summary", use_numba=False)
    once, again, third = summary.section.reshape(3, -1, 2)
    np.testing.assert_allclose(once, again, rtol=0, atol=1e-12)
    np.testing.assert_allclose(third, again, rtol=0, atol=1e-12)
    assert not np.isnan(summary.section).any()


def many() -> tuple[list[Parameters], list[tuple[Any, ...]], list[Fraction]]:
    sets, starts, ends = zip(*map(scene, range(30)), strict=True)
    return list(sets), list(starts), list(ends)


def test_each_column_alone_is_that_of_all() -> None:
    """What is not asked for is not kept, and changes nothing else.

    With a transient left out, and motions at rest.
    """
    sets, starts, ends = (column[:12] for column in many())
    arguments: Any = {"skip": 2.5, "sections": 3, "use_numba": False}
    whole = simulate_many(sets, starts, ends, record="summary", **arguments)
    assert set(whole.status.tolist()) == {"t_end", "equilibrium"}
    for name, column in whole.columns().items():
        alone = getattr(simulate_many(sets, starts, ends, record=(name,), **arguments), name)
        assert np.array_equal(alone, column, equal_nan=column.dtype.kind == "f"), name
        assert alone.dtype == column.dtype
