"""Cross-checks: right solutions pass, and each kind of mistake is found for what it is."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from careful_solver import TIGHT, Run, random_parameters, solve
from excerpts import crosscheck
from samples import sample_of

from symosc import ParameterError, Scene, load_scene, simulate
from symosc.crosschecks import compare
from symosc.crosschecks.compare import CrossCheck


def check(name: str, t_end: float, **options: Any) -> tuple[Run, CrossCheck]:
    run = solve(load_scene(name), t_end, **options)
    return run, crosscheck(name, run.t, run.x, run.v)


@pytest.mark.quick(2)
@pytest.mark.parametrize(("name", "t_end"), [("fig5", 20.0), ("fig9", 15.0), ("fig10", 15.0), ("fig6", 20.0)])
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


@pytest.mark.slow
def test_a_default_run_of_fig8_misses_the_micro_stick() -> None:
    run, result = check("fig8", 3.6)
    assert run.events == []
    assert not result.ok
    assert [event.kind for event in result.missed] == ["stick", "slip"]
    assert [float(event.t) for event in result.missed] == pytest.approx([3.139006, 3.141588], abs=1e-6)
    assert not result.matched
    assert not result.invented
    assert "missed: stick on belt 1 at t = 3.139" in result.summary()


def test_listed_events_of_that_run_lack_it_too() -> None:
    run = solve(load_scene("fig8"), 3.6)
    result = crosscheck("fig8", run.t, run.x, run.v, events=run.events)
    assert [event.kind for event in result.missed] == ["stick", "slip"]


def test_a_double_root_inside_a_step_is_called_so() -> None:
    result = check("fig8", 3.6, **TIGHT)[1]
    assert [event.kind for event in result.missed] == ["stick", "slip"]
    assert result.first_wrong is not None
    assert result.first_wrong.reason == "double root"
    assert result.first_wrong.t < 3.139006 < result.first_wrong.t_next
    assert result.first_wrong == result.first_switching


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_exact_samples_without_event_points_pass(name: str, grid: Any) -> None:
    t, x, v = grid[name]
    for every in (1, 7, 40):  # coarse enough for two events in a step
        result = crosscheck(name, t[::every], x[::every], v[::every])
        assert result.ok, result.summary()
        assert np.max(np.abs(result.defects)) < 1e-12
        assert not result.unresolved
        assert len(result.matched) == len(simulate(name, t_end=float(t[::every][-1])).events)


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_an_invented_event(name: str, grid: Any) -> None:
    t, x, v = (values.copy() for values in grid[name])
    exact = simulate(name, t_end=float(t[-1]))
    speed = float(exact.parameters.v1)
    times = np.array([event.t for event in exact.events])
    # A sample in the domain above belt 1, far from every event and from both ends, is moved just below it.
    far = np.min(np.abs(t[:, None] - np.concatenate([times, t[[0, -1]]])), axis=1)
    moved = int(np.argmax(np.where((v > speed + 0.05) & (v < float(exact.parameters.v2)), far, 0.0)))
    assert 0 < moved < len(t) - 1
    v[moved] = speed - 0.01
    result = crosscheck(name, t, x, v)
    assert not result.ok
    assert [event.kind for event in result.invented] == ["cross", "cross"]
    assert [(event.source, event.target) for event in result.invented] == [("Omega2", "Omega1"), ("Omega1", "Omega2")]
    assert all(t[moved - 1] <= event.t <= t[moved + 1] for event in result.invented)
    assert not result.missed
    assert result.wrong_steps.tolist() == [moved - 1, moved]
    assert result.first_wrong is not None
    assert result.first_wrong.reason == "outlier"
    assert result.decisions[0].expected == "Omega2"
    assert result.decisions[0].found == "Omega1"


@pytest.mark.parametrize("name", ["fig5", "fig9"])
def test_the_force_of_another_domain(name: str) -> None:
    run = solve(load_scene(name), 6.0, wrong_domain={1: 2}, **TIGHT)
    result = crosscheck(name, run.t, run.x, run.v)
    assert not result.ok
    assert result.first_wrong is not None
    assert result.first_wrong.step == 0
    assert result.first_wrong.reason == "wrong force"
    assert "the force of Omega2 explains the step, which lies in Omega1" in result.first_wrong.words


def test_a_drift_off_the_belt(grid: Any) -> None:
    t, x, v = (values.copy() for values in grid["fig5"])
    stick = next(segment for segment in simulate("fig5", t_end=12).segments if segment.mode == "belt1")
    inside = np.flatnonzero((t > stick.t_start) & (t < stick.t_end))
    assert len(inside) > 20
    drift = 1e-6 * (t[inside] - t[inside[0]]) / (t[inside[-1]] - t[inside[0]])
    v[inside] += drift
    result = crosscheck("fig5", t, x, v)
    assert not result.ok
    assert result.first_wrong is not None
    assert {fault.reason for fault in result.faults} == {"drift on the belt"}
    assert set(result.wrong_steps) <= set(inside)
    assert np.max(np.abs(result.defects[:, 1])) == pytest.approx(1e-6, rel=1e-6)
    # It is a drift, not a slip.
    assert not result.invented
    assert not result.missed


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


def test_passing_where_it_sticks_is_a_wrong_decision() -> None:
    """A crossing taken for every contact: what a solver without the stick condition does."""
    scene = load_scene("fig5")
    onset = simulate(scene, t_end=3).events[0]
    p = scene.parameters
    t = np.linspace(0, float(onset.t), 30)
    x, v = simulate(scene, t_end=3)(t)
    after = np.linspace(0, 0.4, 20)[1:]
    force = float(p.A(2)) + float(p.B0) * np.cos(onset.t) - float(p.k) * onset.x - float(p.c) * onset.v
    assert onset.kind == "stick"
    assert force < 0
    # It goes on below the belt, with the wrong force, in place of keeping to the belt.
    result = crosscheck(
        scene,
        np.append(t, onset.t + after),
        np.append(x, onset.x + onset.v * after + force * after**2 / 2),
        np.append(v, onset.v + force * after),
    )
    assert not result.ok
    assert result.first_wrong is not None
    assert result.first_wrong.step == 29
    assert result.decisions[0].expected == "belt1"
    assert result.decisions[0].found == "Omega1"
    assert result.first_wrong.reason == "event at the start"


def test_keeping_to_a_belt_too_long_is_found() -> None:
    exact = simulate("fig5", t_end=6)
    slip = exact.events[1]
    t = np.linspace(0, 6, 601)
    x, v = exact(t)
    late = (t > slip.t) & (t < slip.t + 0.5)
    x[late], v[late] = slip.x + slip.v * (t[late] - slip.t), slip.v
    result = crosscheck("fig5", t, x, v)
    assert not result.ok
    assert any(fault.found == "belt1" and fault.expected == "Omega1" for fault in result.decisions)
    assert result.first_wrong is not None
    assert abs(result.first_wrong.t - slip.t) < 0.05
    assert result.first_wrong.reason in ("sign tolerance", "crossing inside the step")


@pytest.mark.slow
def test_errors_that_add_up_fail_in_the_end() -> None:
    scene = load_scene("fig9")
    other = scene.parameters.replace(k="3.000001")
    t = np.linspace(float(scene.t0), 8, 2001)
    x, v = simulate(other, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=8)(t)
    result = crosscheck(scene, t, x, v)
    assert result.wrong_steps.size == 0
    assert crosscheck(scene, t, x, v, global_tolerance=1e-5).ok
    assert not crosscheck(scene, t, x, v, global_tolerance=1e-7).ok


@pytest.mark.slow
def test_the_end_of_the_exact_motion_is_the_end_of_the_comparison() -> None:
    exact = simulate("fig8", t_end=70)
    assert exact.status == "undecidable"
    t = np.linspace(2.5, float(exact.t_end), 500)
    x, v = exact(t)
    extra = float(exact.t_end) + 0.01 * np.arange(1, 100)
    result = crosscheck("fig8", np.append(t, extra), np.append(x, 0 * extra), np.append(v, 0 * extra))
    assert result.compared_until == exact.t_end
    assert np.isnan(result.errors[500:]).all()
    assert result.max_error_x < 1e-10
    assert any("only steps" in note for note in result.notes)


def test_a_solution_starts_where_the_scene_does() -> None:
    """... or on its motion later; own_start allows another start."""
    t = np.linspace(0, 40, 800)
    x, v = simulate("fig5")(t)
    other = simulate("fig5", x0="0.1")(t)
    wrong = compare.crosscheck("fig5", t, *other)
    assert not wrong.ok
    assert not len(wrong.wrong_steps) + len(wrong.missed) + len(wrong.invented)
    said = "the solution starts at t0 = 0, x0 = 0.1, v0 = 0; fig5 starts at t0 = 0, x0 = 0, v0 = 0"
    assert f"wrong start: {said}" in wrong.summary()
    assert wrong.as_dict()["wrong_start"] == said
    assert [one.words for one in wrong.diagnosis] == [said]
    allowed = compare.crosscheck("fig5", t, *other, own_start=True)
    assert allowed.ok
    assert said in allowed.notes
    for first in (1, 100, 700):  # on the scene's motion, from later on
        assert compare.crosscheck("fig5", t[first:], x[first:], v[first:]).ok
        assert not compare.crosscheck("fig5", t[first:], x[first:] + 1e-3, v[first:]).ok
    assert not compare.crosscheck("fig5", t - 0.1, *simulate("fig5", t0=-0.1, t_end=40)(t - 0.1), partial=True).ok
    assert compare.crosscheck(load_scene("fig5").parameters, t[:400], *other[:, :400]).ok


def test_a_start_is_the_scenes_within_its_rounding_and_the_tolerance() -> None:
    scene = load_scene("fig9")  # x0 = 4.5447
    t = np.linspace(float(scene.t0), float(scene.t_end), 300)
    starts = ((0, 3, True), (0.0002, 3, True), (0.002, 3, False), (3e-6, 17, True), (3e-4, 17, False))
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


def test_units_are_the_largest_values_and_at_least_those_of_the_belts() -> None:
    rng = np.random.default_rng(5)
    p = load_scene("fig9").parameters
    fastest = max(abs(float(p.v1)), abs(float(p.v2)))
    rate = max(float(p.Omega), float(p.k / p.m) ** 0.5)
    for size_x, size_v in ((1e-6, 1e-6), (1e3, 1e-6), (1e-6, 1e3), (1e3, 1e3)):
        exact = np.array([size_x, size_v])[:, None] * rng.uniform(-1, 1, (2, 50))
        x, v = compare._scales(p, exact)
        assert v == max(np.abs(exact[1]).max(), fastest)
        assert x == max(np.abs(exact[0]).max(), v / rate)


def test_a_wrong_decision_behind_many_wrong_steps_is_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first wrong steps are explained, and of all others those with an event, or where the mode is another one."""
    n, most = 40, 5
    modes = np.full(n + 1, 2)
    steps = SimpleNamespace(t=np.arange(n + 1.0), last=modes[1:].copy())
    sizes = np.full(n, 2.0)
    sizes[[10, 25]] = 0.5
    steps.last[[20, 30]] = 5  # the samples fly where the exact motion sticks
    modes[33] = 0  # where they only pass a belt there is no mode to compare
    matching = SimpleNamespace(invented=[SimpleNamespace(step=15), SimpleNamespace(step=25)], missed=[])
    monkeypatch.setattr(compare, "MOST_FAULTS", most)
    monkeypatch.setattr(compare, "explain", lambda steps, chosen, *_: tuple(chosen))
    assert compare._faults(steps, modes, sizes, None, None, matching) == (0, 1, 2, 3, 4, 15, 20, 30)
    matching.missed.append(SimpleNamespace(t=18.5))
    assert compare._faults(steps, modes, sizes, None, None, matching) == (0, 1, 2, 3, 4, 15, 18, 20, 30)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t, x, v: (t[::-1], x, v), "times must increase"),
        (lambda t, x, v: (np.append(t[:-1], t[-2]), x, v), "is repeated"),
        (lambda t, x, v: (t, np.append(x[:-1], np.nan), v), r"x\[800\] = nan"),
        (lambda t, x, v: (t, x[:-1], v), "one length"),
        (lambda t, x, v: (t[:1], x[:1], v[:1]), "at least 2"),
        (lambda t, x, v: (t, np.array([x, x]), v), "one-dimensional"),
        (lambda t, x, v: (t, ["a"] * len(t), v), "'a': is not a number"),
    ],
)
def test_bad_samples(change: Any, words: str, grid: Any) -> None:
    with pytest.raises(ParameterError, match=words):
        crosscheck("fig5", *change(*grid["fig5"]))


@pytest.mark.parametrize(
    ("events", "words"), [([(1.0, "jump")], "kind one of"), ([1.0], "pair"), ([(np.nan, "cross")], "finite")]
)
def test_bad_events(events: Any, words: str, grid: Any) -> None:
    with pytest.raises(ParameterError, match=words):
        crosscheck("fig5", *grid["fig5"], events=events)


def test_an_invented_event_of_a_list(grid: Any) -> None:
    t, x, v = grid["fig9"]
    own = [(event.t, event.kind) for event in simulate("fig9", t_end=8).events]
    assert crosscheck("fig9", t, x, v, events=own).ok
    result = crosscheck("fig9", t, x, v, events=[*own, (5.2, "stick")])
    assert [(event.t, event.kind) for event in result.invented] == [(5.2, "stick")]
    assert not result.ok
    result = crosscheck("fig9", t, x, v, events=own[1:])
    assert [event.t for event in result.missed] == [own[0][0]]


@pytest.mark.slow
@sample_of(8, 60)
def test_right_samples_of_random_systems_pass(count: int) -> None:
    """However coarse, with samples on events or without, at large times, and with noise of 1e-10."""
    rng = np.random.default_rng(5)
    events = 0
    for _ in range(count):
        p = random_parameters(rng)
        t0 = float(rng.choice([0.0, 3.5, 1e6]))
        v0 = float(rng.choice([float(p.v1), float(p.v2), round(rng.uniform(-6, 8), 2)]))
        exact = simulate(p, t0=t0, x0=round(rng.uniform(-5, 5), 2), v0=v0, t_end=t0 + 20)
        own = [event.t for event in exact.events if rng.random() < 0.5]
        t = np.unique([t0, *rng.uniform(t0, float(exact.t_end), int(rng.choice([15, 100, 400]))), *own])
        x, v = exact(t)
        noise = 1e-10 * rng.standard_normal((2, len(t)))
        noise[:, 0] = 0
        assert crosscheck(p, t, x, v).ok
        assert crosscheck(p, t, x + noise[0], v + noise[1]).ok
        assert not crosscheck(p, t, x, v * (1 + 1e-6)).ok
        events += len(exact.events)
    assert events > 8 * count
