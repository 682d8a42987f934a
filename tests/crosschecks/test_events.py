"""Events of samples and lists against the exact ones, and how far off they may be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from careful_solver import TIGHT, random_parameters, solve
from excerpts import crosscheck

from symosc import ParameterError, Parameters, Scene, Trajectory, load_scene, simulate
from symosc.crosschecks.events import find_events, labels
from symosc.crosschecks.steps import follow_steps
from symosc.friction import MODE_NAMES

# -- events ----------------------------------------------------------------------------------------

WHAT = ("kind", "boundary", "source", "target")


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_events_and_modes_are_those_of_the_motion(name: str) -> None:
    t = np.linspace(float(load_scene(name).t0), 12.0, 700)
    exact = simulate(name, t_end=12)
    check = crosscheck(name, t, *exact(t))
    # The first sample may be on a belt that the motion leaves at once.
    assert [MODE_NAMES[code] for code in check.modes[1:].tolist()] == [
        exact.mode(float(time)) for time in t[1:]
    ]
    assert MODE_NAMES.get(int(check.modes[0]), exact.mode(float(t[0]))) == exact.mode(float(t[0]))
    for match, event in zip(check.matched, exact.events, strict=True):
        shown = match.found
        assert shown is not None
        assert [getattr(shown, each) for each in WHAT] == [getattr(event, each) for each in WHAT]
        assert t[shown.step] <= float(event.t) <= t[shown.last_step + 1]
        assert (shown.t, shown.spread) == (pytest.approx(float(event.t), abs=1e-9), 0)


def test_steps_that_are_wrong_show_crossings_between_their_samples() -> None:
    """From one domain to the last but one.

    Both belts are crossed, in order, at times read off the samples.
    """
    scene = load_scene("fig9")
    p = scene.parameters
    t = np.array([0.0, 0.01, 0.02, 0.03])
    below = float(p.v1) - 1
    above = float(p.v2) + 1
    steps = follow_steps(
        p, t, np.zeros(4), np.array([below, below, above, below]), 1e-9, np.ones(2)
    )
    near = np.full(4, 1e-9)
    events, modes = find_events(steps, labels(steps, near, near), np.ones(3, bool))
    assert [(e.kind, e.boundary, e.source, e.target) for e in events] == [
        ("cross", 1, "Omega1", "Omega2"),
        ("cross", 2, "Omega2", "Omega3"),
        ("cross", 2, "Omega3", "Omega2"),
        ("cross", 1, "Omega2", "Omega1"),
    ]
    assert [e.step for e in events] == [1, 1, 2, 2]
    speeds = {1: float(p.v1), 2: float(p.v2)}
    # What the exact motion over the step does not do is read off: v is a straight line.
    for event in events:
        v0, v1 = (below, above) if event.step == 1 else (above, below)
        line = t[event.step] + 0.01 * (speeds[event.boundary] - v0) / (v1 - v0)
        assert t[event.step] <= event.t <= t[event.step + 1]
        assert event.spread == 0 or (
            event.spread == pytest.approx(0.01) and event.t == pytest.approx(line, abs=1e-12)
        )
    assert sum(event.spread > 0 for event in events) >= 2
    assert modes.tolist() == [1, 1, 3, 1]


# -- matching --------------------------------------------------------------------------------------


Pairs = list[tuple[float, str]]
KINDS = ("cross", "stick", "slip", "graze")


def listed(trajectory: Trajectory, until: float = np.inf) -> Pairs:
    return [(float(event.t), event.kind) for event in trajectory.events if event.t <= until]


def random_motion(rng: np.random.Generator) -> tuple[Parameters, Any, Trajectory]:
    """Return parameters, samples at random times (half of the events among them) and the exact
    motion.
    """
    p = random_parameters(rng)
    t0 = float(rng.choice([0.0, 3.5, 1e6]))
    v0 = float(rng.choice([float(p.v1), float(p.v2), round(rng.uniform(-6, 8), 2)]))
    exact = simulate(p, t0=t0, x0=round(rng.uniform(-5, 5), 2), v0=v0, t_end=t0 + 6)
    own = [float(event.t) for event in exact.events if rng.random() < 0.5]
    end = float(exact.t_end)
    if own and rng.random() < 0.3:
        end = own[-1]  # the last sample is an event
    t = np.unique([t0, *rng.uniform(t0, end, int(rng.choice([15, 100, 300]))), *own, end])
    return p, (t, *exact(t)), exact


def spoiled(
    how: str, events: Pairs, i: int, rng: np.random.Generator, times: np.ndarray
) -> Pairs | None:
    """Return a list with one mistake, at event `i` where there is a place, or None if there is no
    room for it.
    """
    (t, kind) = events[i]
    events = list(events)
    shift = float(rng.choice([-1, 1])) * 10.0 ** rng.uniform(-4, -1.3)
    if how == "duplicate":
        events.insert(i, events[i])
    elif how == "five times":
        events = [event for event in events for _ in range(5)]
    elif how == "late":
        events[i] = (t + shift, kind)
    elif how == "shifted":
        events = [(time + shift, kind) for time, kind in events]
    elif how == "missing":
        del events[i]
    elif how == "invented":
        new = rng.uniform(times[0], times[-1], 50)
        far = np.min(np.abs(new[:, None] - [times[0], *(time for time, _ in events)]), axis=1)
        if np.max(far) < 1e-3:
            return None
        events.append((float(new[np.argmax(far)]), str(rng.choice(KINDS))))
    elif how == "wrong kind":
        events[i] = (t, str(rng.choice([second for second in KINDS if second != kind])))
    elif i + 1 == len(events) or events[i + 1][0] - t < 1e-3 or events[i + 1][1] == kind:
        return None
    elif how == "wrong order":
        events[i : i + 2] = events[i + 1], events[i]
    elif how == "kinds swapped":
        events[i : i + 2] = (t, events[i + 1][1]), (events[i + 1][0], kind)
    if how == "wrong order":
        return events
    return sorted(events)


MISTAKES = (
    "duplicate",
    "five times",
    "late",
    "shifted",
    "missing",
    "invented",
    "wrong kind",
    "wrong order",
)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.campaign)])
def test_every_mistake_in_a_list_is_found_and_none_where_there_is_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tried = dict.fromkeys([*MISTAKES, "kinds swapped"], 0)
    for _ in range(8 if seed == 1 else 60):
        p, samples, exact = random_motion(rng)
        events = listed(exact, samples[0][-1])
        result = crosscheck(p, *samples, events=events)
        assert result.ok, (p, result.summary())
        assert len(result.matched) + len(result.unresolved) == len(events)
        # A graze changes nothing, and one beside the last sample may be left out: no place for a
        # mistake.
        last = float(samples[0][-1]) - 1e-3
        places = [
            i
            for i, (t, kind) in enumerate(events)
            if kind != "graze" and samples[0][0] + 1e-6 < t < last
        ]
        for how in tried if places else ():
            wrong = spoiled(how, events, int(rng.choice(places)), rng, samples[0])
            if wrong is None:
                continue
            tried[how] += 1
            result = crosscheck(p, *samples, events=wrong)
            assert not result.ok, (how, p, samples[0][0], events, wrong)
            if how in ("late", "shifted", "wrong kind"):
                assert result.missed
                assert result.invented
    assert min(tried.values()) >= 3


@pytest.mark.slow
def test_an_event_may_be_off_as_far_as_the_tolerance_moves_it() -> None:
    exact = simulate("fig9", t_end=8)
    t = np.linspace(0.1324, 8, 801)
    samples = (t, *exact(t))
    event = exact.events[3]
    # One side of the belt: the velocity changes by 1e-4 of its scale in about that time.
    speed = abs(float(np.diff(exact([event.t - 2e-6, event.t - 1e-6])[1])[0])) / 1e-6
    for tolerance in (1e-8, 1e-6, 1e-4):
        moved = tolerance * crosscheck("fig9", *samples).scales[1] / speed
        for part, right in ((0.5, True), (10.0, False)):
            events = listed(exact)
            events[3] = (events[3][0] + part * moved, events[3][1])
            assert crosscheck("fig9", *samples, events=events, tolerance=tolerance).ok == right


def late_solution(scene: str, delay: float) -> tuple[Any, Pairs]:
    """Return samples of a motion that is everywhere late, with its events."""
    own = load_scene(scene)
    p = load_scene(scene).parameters
    exact = simulate(p, t0=own.t0, x0=own.x0, v0=own.v0, t_end=8)
    t = np.linspace(float(own.t0), 8, 801)
    x, v = exact(np.maximum(t - delay * np.minimum(1.0, (t - t[0]) / 4.0), t[0]))
    return (t, x, v), [
        (time + delay * min(1.0, (time - t[0]) / 4.0), kind) for time, kind in listed(exact)
    ]


def test_a_list_that_fits_its_own_samples_is_not_blamed_for_their_error() -> None:
    samples, events = late_solution("fig9", 1e-6)
    assert crosscheck("fig9", *samples, events=events, tolerance=1e-6).ok
    assert not crosscheck("fig9", *samples, events=events, tolerance=1e-6, global_tolerance=1e-9).ok


def test_a_start_on_a_belt_may_be_listed_once() -> None:
    for name, kind in (("fig9", "cross"), ("fig10", "cross"), ("fig6", "stick")):
        scene = load_scene(name)
        exact = simulate(name, t_end=6)
        t = np.linspace(float(scene.t0), 6, 301)
        start = (float(scene.t0), kind)
        result = crosscheck(name, t, *exact(t), events=[start, *listed(exact)])
        assert result.ok, result.summary()
        assert any("is the start on belt" in note for note in result.notes)
        twice = crosscheck(name, t, *exact(t), events=[start, start, *listed(exact)])
        assert [event.t for event in twice.invented] == [start[0]]
    t = np.linspace(0, 6, 301)
    # fig5 starts between no belts.
    assert crosscheck("fig5", t, *simulate("fig5", t_end=6)(t), events=[(0.0, "cross")]).invented


@pytest.mark.slow
def test_an_event_at_the_last_sample_may_be_listed_or_not() -> None:
    exact = simulate("fig9", t_end=8)
    for event in exact.events:
        t = np.append(np.linspace(0.1324, float(event.t), 200)[:-1], event.t)
        events = listed(exact, float(event.t))
        for pairs in (
            events,
            events[:-1],
            [*events[:-1], (np.nextafter(events[-1][0], 9.0), event.kind)],
        ):
            result = crosscheck("fig9", t, *exact(t), events=pairs)
            assert result.ok, result.summary()
        assert not crosscheck("fig9", t, *exact(t), events=[*events, events[-1]]).ok


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("name", "t_end"), [("fig8", 9.0), ("fig8-exact", 6.0), ("fig7-exact", 8.0), ("fig7", 8.0)]
)
def test_touches_and_the_shortest_sticks(name: str, t_end: float) -> None:
    """A graze may be left out or seen as a contact of either kind, but not five times."""
    exact = simulate(name, t_end=t_end)
    t = np.linspace(2.5, t_end, 300)
    events = listed(exact)
    samples = (t, *exact(t))
    assert crosscheck(name, *samples, events=events).ok
    assert crosscheck(name, *samples, events=[event for event in events if event[1] != "graze"]).ok
    grazes = [i for i, (_, kind) in enumerate(events) if kind == "graze"]
    for i in grazes:
        for kinds, right in (
            (("stick", "slip"), True),
            (("cross", "cross"), True),
            (("graze",) * 5, False),
        ):
            pairs = [(events[i][0], kind) for kind in kinds]
            assert (
                crosscheck(name, *samples, events=[*events[:i], *pairs, *events[i + 1 :]]).ok
                == right
            )
    if name == "fig8":
        # 5e-5 deep, 2.6 ms long: a matter of the tolerance.
        assert not crosscheck(name, *samples, events=events[2:]).ok
        assert crosscheck(name, *samples, events=events[2:], tolerance=1e-3).ok


def test_a_near_touch_may_be_listed_as_one() -> None:
    """The exact motion misses the belt by less than the tolerance."""
    scene = load_scene("fig8-exact")
    own = {name: float(getattr(scene, name)) for name in ("t0", "x0", "v0")}
    exact = simulate(scene.parameters, **own | {"x0": own["x0"] - 1e-9}, t_end=3.5)
    t = np.linspace(2.5, 3.5, 101)
    samples = (t, *exact(t))
    assert not exact.events
    for kinds, right in (
        (("graze",), True),
        (("stick", "slip"), True),
        (("graze", "graze"), False),
        (("stick",), False),
    ):
        result = crosscheck(scene.parameters, *samples, events=[(np.pi, kind) for kind in kinds])
        assert result.ok == right, result.summary()
    assert not crosscheck(scene.parameters, *samples, events=[(np.pi + 0.01, "graze")]).ok


@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.campaign)])
def test_lists_of_a_careful_solver_pass(seed: int) -> None:
    """Tight DOP853, started anew at each event.

    Also with the start listed and with both samples at each joint.
    """
    rng = np.random.default_rng(seed)
    for _ in range(3 if seed == 3 else 15):
        p = random_parameters(rng)
        v0 = str(rng.choice([str(p.v1), str(p.v2), "0.5"]))
        scene = Scene("random", p, "0", str(round(rng.uniform(-5, 5), 2)), v0, "30")
        joined = bool(rng.random() < 0.5)
        # Short steps: without them even a careful solver passes over two roots at a time.
        run = solve(scene, 5.0, joined=joined, max_step=0.02, **TIGHT)
        on_belt = float(scene.v0) in (float(p.v1), float(p.v2))
        for events in (None, run.events, [(0.0, "cross"), *run.events] if on_belt else run.events):
            result = crosscheck(scene, run.t, run.x, run.v, events=events)
            assert result.ok, (p, scene, result.summary())


def test_a_jump_at_a_joint_is_a_wrong_step() -> None:
    run = solve(load_scene("fig9"), 6.0, joined=True, **TIGHT)
    joint = int(np.flatnonzero(np.diff(run.t) == 0.0)[3])
    run.x[joint + 1 :] = list(np.array(run.x[joint + 1 :]) + 1e-5)
    result = crosscheck("fig9", run.t, run.x, run.v, tolerance=1e-7, global_tolerance=1e-3)
    assert result.first_wrong is not None
    assert (result.first_wrong.step, result.first_wrong.reason) == (joint, "jump")
    assert result.defects[joint, 0] == pytest.approx(-1e-5, rel=1e-6)
    run.x[joint + 1 :] = list(np.array(run.x[joint + 1 :]) + 0.1)
    with pytest.raises(
        ParameterError,
        match=rf"t\[{joint + 1}\] .* is repeated with another state \(x jumps by 0.1",
    ):
        crosscheck("fig9", run.t, run.x, run.v)
