"""Whole cross-checks: right solutions pass, each mistake is found for what it is; summaries.

Several solutions.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from careful_solver import TIGHT, Run, random_parameters, solve
from excerpts import crosscheck
from samples import sample_of
from solution_files import COLUMNS, T, V, X
from units import UNITS, Units

from symosc import CrossCheck, ParameterError, Parameters, Scene, load_scene, simulate
from symosc.crosschecks import compare
from symosc.crosschecks.samples import checked
from symosc.crosschecks.velocities import NOTE, with_velocities

# -- compare ---------------------------------------------------------------------------------------


def check(name: str, t_end: float, **options: Any) -> tuple[Run, CrossCheck]:
    run = solve(load_scene(name), t_end, **options)
    return run, crosscheck(name, run.t, run.x, run.v)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("name", "t_end"), [("fig5", 20.0), ("fig9", 15.0), ("fig10", 15.0), ("fig6", 20.0)]
)
def test_a_tight_run_passes(name: str, t_end: float) -> None:
    run, result = check(name, t_end, **TIGHT)
    assert result.ok, result.summary()
    assert not result.wrong_steps.size
    assert max(result.max_error_x, result.max_error_v) < 1e-7
    exact = simulate(name, t_end=t_end).events
    assert [match.event for match in result.matched] == list(exact)
    assert max(abs(match.error) for match in result.matched) < 1e-7
    listed = crosscheck(name, run.t, run.x, run.v, events=run.events)
    assert listed.ok, listed.summary()
    assert len(listed.matched) == len(exact) == len(run.events)


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_exact_samples_without_event_points_pass(name: str, grid: Any) -> None:
    t, x, v = grid[name]
    for every in (1, 7, 40):  # coarse enough for two events in a step
        result = crosscheck(name, t[::every], x[::every], v[::every])
        assert result.ok, result.summary()
        assert np.max(np.abs(result.defects)) < 1e-12
        assert not result.unresolved
        assert len(result.matched) == len(simulate(name, t_end=float(t[::every][-1])).events)


@pytest.mark.slow
def test_a_solution_that_is_right_to_1e_10_is_right(grid: Any) -> None:
    """Noise decides on which side of a belt a sample is, in stick phases at every sample."""
    rng = np.random.default_rng(20261121)
    for name, (t, x, v) in grid.items():
        for _ in range(3):
            noise = 1e-10 * rng.standard_normal((2, len(t)))
            result = crosscheck(name, t, x + noise[0], v + noise[1])
            assert result.ok, result.summary()
            assert not result.invented + result.missed
        worse = crosscheck(name, t, x, v + 1e-6 * rng.standard_normal(len(t)))
        assert not worse.ok


def test_an_unknown_cause_explains_none_of_the_steps() -> None:
    """Here the steps are too long to tell: each lasts a hundred periods of the drive."""
    (diagnosis,) = crosscheck("fig5", [0, 700, 1400], [0, 1, 0], [0, 0, 0]).diagnosis
    assert (diagnosis.cause, diagnosis.share) == ("unknown", 0.0)


@pytest.mark.slow
def test_errors_that_add_up_fail_in_the_end() -> None:
    scene = load_scene("fig9")
    changed = scene.parameters.replace(k="3.000001")
    t = np.linspace(float(scene.t0), 8, 2001)
    x, v = simulate(changed, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=8)(t)
    result = crosscheck(scene, t, x, v)
    assert result.wrong_steps.size == 0
    assert crosscheck(scene, t, x, v, global_tolerance=1e-5).ok
    assert not crosscheck(scene, t, x, v, global_tolerance=1e-7).ok


def test_a_solution_starts_where_the_scene_does() -> None:
    """... or on its motion later; own_start allows another start."""
    t = np.linspace(0, 40, 800)
    x, v = simulate("fig5")(t)
    elsewhere = simulate("fig5", x0="0.1")(t)
    wrong = compare.crosscheck("fig5", t, *elsewhere)
    assert not wrong.ok
    assert not len(wrong.wrong_steps) + len(wrong.missed) + len(wrong.invented)
    said = "the solution starts at t0 = 0, x0 = 0.1, v0 = 0; fig5 starts at t0 = 0, x0 = 0, v0 = 0"
    assert f"wrong start: {said}" in wrong.summary()
    assert wrong.as_dict()["wrong_start"] == said
    assert [diagnosis.words for diagnosis in wrong.diagnosis] == [said]
    allowed = compare.crosscheck("fig5", t, *elsewhere, own_start=True)
    assert allowed.ok
    assert said in allowed.notes
    for first in (1, 100, 700):  # on the scene's motion, from later on
        assert compare.crosscheck("fig5", t[first:], x[first:], v[first:]).ok
        assert not compare.crosscheck("fig5", t[first:], x[first:] + 1e-3, v[first:]).ok
    assert not compare.crosscheck(
        "fig5", t - 0.1, *simulate("fig5", t0=-0.1, t_end=40)(t - 0.1), partial=True
    ).ok
    assert compare.crosscheck(load_scene("fig5").parameters, t[:400], *elsewhere[:, :400]).ok


def test_a_start_is_the_scenes_within_its_rounding_and_the_tolerance() -> None:
    scene = load_scene("fig9")  # x0 = 4.5447
    t = np.linspace(float(scene.t0), float(scene.t_end), 300)
    starts = (
        (0, 3, True),
        (0.0002, 3, True),
        (0.002, 3, False),
        (3e-6, 17, True),
        (3e-4, 17, False),
    )
    for shift, decimals, right in starts:
        x, v = np.round(simulate(scene, x0=float(scene.x0) + shift)(t), decimals)
        check = compare.crosscheck(scene, t, x, v)
        assert check.ok == right, (shift, decimals, check.summary())
        assert bool(check.wrong_start) != right


def test_a_solution_goes_on_to_the_end_of_the_scene() -> None:
    """... or to one of its steps before; partial allows an early end."""
    t = np.arange(0, 40, 0.05)
    x, v = simulate("fig5")(t)
    assert compare.crosscheck("fig5", t, x, v).ok
    for last in (3, 100, len(t) - 2):
        check = compare.crosscheck("fig5", t[:last], x[:last], v[:last])
        assert not check.ok
        said = f"the solution ends at t = {t[last - 1]:.10g}; the motion of fig5 goes on to t = 40"
        assert f"early end: {said}" in check.summary()
        assert check.as_dict()["early_end"] == said
        assert check.diagnosis == ()
        allowed = compare.crosscheck("fig5", t[:last], x[:last], v[:last], partial=True)
        assert allowed.ok
        assert said in allowed.notes
    assert not compare.crosscheck("fig5", [0, 20], *simulate("fig5")(np.array([0.0, 20.0]))).ok
    # The mass comes to rest: then its motion has an end of its own.
    p = load_scene("fig5").parameters.replace(B0=0, A0=0)
    resting = Scene("resting", p, Fraction(0), Fraction(0), Fraction(0), Fraction(200))
    assert simulate(resting).status == "equilibrium"
    assert compare.crosscheck(resting, simulate(resting)).ok


@pytest.mark.slow
@sample_of(8, 60)
def test_right_samples_of_random_systems_pass(count: int) -> None:
    """However coarse, with samples on events or without, at large times, and with noise of
    1e-10.
    """
    rng = np.random.default_rng(5)
    events = 0
    for _ in range(count):
        p = random_parameters(rng)
        t0 = float(rng.choice([0.0, 3.5, 1e6]))
        v0 = float(rng.choice([float(p.v1), float(p.v2), round(rng.uniform(-6, 8), 2)]))
        exact = simulate(p, t0=t0, x0=round(rng.uniform(-5, 5), 2), v0=v0, t_end=t0 + 20)
        own = [event.t for event in exact.events if rng.random() < 0.5]
        t = np.unique(
            [t0, *rng.uniform(t0, float(exact.t_end), int(rng.choice([15, 100, 400]))), *own]
        )
        x, v = exact(t)
        noise = 1e-10 * rng.standard_normal((2, len(t)))
        noise[:, 0] = 0
        assert crosscheck(p, t, x, v).ok
        assert crosscheck(p, t, x + noise[0], v + noise[1]).ok
        assert not crosscheck(p, t, x, v * (1 + 1e-6)).ok
        events += len(exact.events)
    assert events > 8 * count


# -- compare parts ---------------------------------------------------------------------------------


def test_arguments_are_read() -> None:
    t = np.linspace(0, 3, 9)
    x, v = simulate("fig5", t_end=3)(t)
    for name in ("tolerance", "global_tolerance"):
        for bad in (0, -1e-8, "0"):
            with pytest.raises(ParameterError, match=f"^{name} = "):
                crosscheck("fig5", t, x, v, **{name: bad})
    with pytest.raises(ParameterError, match="must be a Scene"):
        crosscheck(None, t, x, v)  # type: ignore[arg-type]
    result = crosscheck("fig5", t, x, v, tolerance="1e-6")  # type: ignore[arg-type]
    assert (result.tolerance, result.global_tolerance) == (1e-6, 1e-3)
    assert crosscheck("fig5", t, x, v, global_tolerance=0.5).global_tolerance == 0.5
    assert crosscheck("fig5", {"t": t, "x": x, "v": v}).ok
    listed = [(event.t, event.kind) for event in simulate("fig5", t_end=3).events]
    assert len(crosscheck("fig5", {"t": t, "x": x, "v": v}, events=listed).matched) == len(listed)


# -- many ------------------------------------------------------------------------------------------


WRONG = {**COLUMNS, "v": V + 0.1 * (T > 2)}
THREE = [COLUMNS, WRONG, np.column_stack([T, X])]


def test_results_as_tables() -> None:
    checks = crosscheck("fig9", THREE)
    frame = checks.to_pandas()
    assert frame["ok"].tolist() == [True, False, True]
    data = checks.to_xarray()
    assert dict(data.sizes) == {"solution": 3}
    assert data["samples"].sel(solution="1").item() == 60
    assert data["first_wrong_t"].isnull().values.tolist() == [True, False, True]


@pytest.mark.slow
def test_processes_find_the_same() -> None:
    calls: list[tuple[int, int]] = []
    checks = crosscheck("fig9", THREE, workers=2, progress=lambda *numbers: calls.append(numbers))
    assert list(checks) == list(crosscheck("fig9", THREE))
    assert calls == [(1, 3), (2, 3), (3, 3)]
    sparse = [COLUMNS, {"t": [0.2, 2.9], "x": [1.0, 2.0]}]
    for workers in (1, 2):
        with pytest.raises(
            ParameterError, match=r"too far apart to tell it: give velocities \(solution 1\)"
        ):
            crosscheck("fig9", sparse, workers=workers)


# -- units -----------------------------------------------------------------------------------------


@cache
def samples(name: str) -> tuple[Parameters, np.ndarray, CrossCheck]:
    """Return a scene's parameters, samples of its motion with several faults, and what a
    cross-check says of them.
    """
    scene = load_scene(name)
    t = np.linspace(float(scene.t0), float(scene.t0) + 8, 97)
    x, v = simulate(scene, t_end=9)(t)
    x = x + 1e-10 * np.sin(9 * t)
    v = v + 1e-10 * np.cos(7 * t)
    x[20] += 0.01
    v[40:] += 1e-3
    v[70] = float(scene.parameters.v1) - 0.3
    return scene.parameters, np.array([t, x, v]), crosscheck(scene.parameters, t, x, v)


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", UNITS, ids=str)
@pytest.mark.parametrize("name", ["fig5", "fig9"])
def test_a_cross_check_is_the_same(units: Units, name: str) -> None:
    """Errors and what is allowed, step by step.

    Events, reasons and words, for samples with several faults.
    """
    T = float(units.time)
    L = float(units.length)
    V = units.speed
    p, columns, one = samples(name)
    two = crosscheck(units.of(p), *(columns * np.array([[T], [L], [V]])))
    for kind in ("errors", "defects", "allowed"):
        found = getattr(two, kind) / [L, V]
        assert found == pytest.approx(
            getattr(one, kind), rel=1e-6, abs=1e-11 if kind != "allowed" else 0
        )
    assert two.scales == pytest.approx((one.scales[0] * L, one.scales[1] * V), rel=1e-9)
    assert two.wrong_steps.tolist() == one.wrong_steps.tolist()
    assert two.modes.tolist() == one.modes.tolist()
    said = [[(f.step, f.reason, f.expected, f.found) for f in each.faults] for each in (one, two)]
    assert said[0] == said[1]
    for name_of in ("missed", "invented", "unresolved"):
        found, right = (
            [(e.kind, e.boundary) for e in getattr(each, name_of)] for each in (two, one)
        )
        assert found == right
    assert [float(m.t) for m in two.matched] == pytest.approx(
        [float(m.t) * T for m in one.matched], rel=1e-9
    )
    assert len(one.faults) > 2


# -- velocities ------------------------------------------------------------------------------------


def test_velocities_are_those_of_the_motion() -> None:
    """Random systems and times: across events, in sticks, at the ends.

    Errors as far as they are said to be.
    """
    rng = np.random.default_rng(7)
    events = 0
    far = 0
    left_out = 0
    for _ in range(12):
        p = random_parameters(rng)
        motion = simulate(
            p, t0=0, x0=float(rng.uniform(-2, 2)), v0=float(rng.uniform(-4, 4)), t_end=8
        )
        if motion.status not in ("t_end", "equilibrium"):
            continue
        t = np.sort(rng.uniform(0, float(motion.t_end), 300))
        x, v = motion(t)
        computed = with_velocities(checked(t, x), p, 1e-8)
        assert computed.v_off is not None
        error = np.abs(computed.v - v[len(v) - len(computed.v) :])
        left_out += len(v) - len(computed.v)
        far += int(np.sum(error > computed.v_off + 1e-7))
        events += len(motion.events)
        assert np.median(error) < 1e-11
    assert events > 20
    assert left_out <= 4  # two motions have an event in their first step
    assert far == 0


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "count"), [("fig5", 400), ("fig9", 40), ("fig10", 200), ("fig5", 1000)]
)
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
    motion_ = simulate(
        scene.parameters.replace(mu1=scene.parameters.mu1 * 2),
        t0=scene.t0,
        x0=scene.x0,
        v0=scene.v0,
        t_end=9,
    )
    assert not crosscheck(scene, t, motion_(t)[0]).ok


def test_positions_that_are_too_far_apart_are_refused() -> None:
    p = load_scene("fig9").parameters
    with pytest.raises(ParameterError, match="too far apart to tell it: give velocities"):
        crosscheck(p, [0.0, 3.0, 6.0], [1.0, 2.0, 3.0])
    assert not crosscheck("fig9", np.linspace(0.1324, 5, 9), np.linspace(1, 9, 9)).ok


# -- faults ----------------------------------------------------------------------------------------
