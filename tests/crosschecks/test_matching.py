"""Lists of events: right ones pass, and every kind of mistake in one is found."""

from __future__ import annotations

from itertools import combinations, pairwise, product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from careful_solver import TIGHT, random_parameters, solve
from excerpts import crosscheck

from symosc import ParameterError, Parameters, Scene, Trajectory, load_scene, simulate
from symosc.crosschecks.compare import CrossCheck
from symosc.crosschecks.matching import Matcher, Matching, in_order
from symosc.engine.events import KIND_NAMES

Pairs = list[tuple[float, str]]
KINDS = ("cross", "stick", "slip", "graze")


def listed(trajectory: Trajectory, until: float = np.inf) -> Pairs:
    return [(float(event.t), event.kind) for event in trajectory.events if event.t <= until]


def random_motion(rng: np.random.Generator) -> tuple[Parameters, Any, Trajectory]:
    """Return parameters, samples at random times (half of the events among them) and the exact motion."""
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


def spoiled(how: str, events: Pairs, i: int, rng: np.random.Generator, times: np.ndarray) -> Pairs | None:
    """Return a list with one mistake, at event `i` where there is a place, or None if there is no room for it."""
    events, (t, kind) = list(events), events[i]
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
        events[i] = (t, str(rng.choice([other for other in KINDS if other != kind])))
    elif i + 1 == len(events) or events[i + 1][0] - t < 1e-3 or events[i + 1][1] == kind:
        return None
    elif how == "wrong order":
        events[i : i + 2] = events[i + 1], events[i]
    elif how == "kinds swapped":
        events[i : i + 2] = (t, events[i + 1][1]), (events[i + 1][0], kind)
    return events if how == "wrong order" else sorted(events)


MISTAKES = ("duplicate", "five times", "late", "shifted", "missing", "invented", "wrong kind", "wrong order")


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
        # A graze changes nothing, and one beside the last sample may be left out: no place for a mistake.
        last = float(samples[0][-1]) - 1e-3
        places = [i for i, (t, kind) in enumerate(events) if kind != "graze" and samples[0][0] + 1e-6 < t < last]
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


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_the_mistakes_that_were_accepted_once(name: str) -> None:
    exact = simulate(name, t_end=8)
    t = np.linspace(float(load_scene(name).t0), 8, 801)
    events = listed(exact)
    samples = (t, *exact(t))
    assert crosscheck(name, *samples, events=events).ok
    five = crosscheck(name, *samples, events=[event for event in events for _ in range(5)])
    assert len(five.invented) == 4 * len(events)
    late = crosscheck(name, *samples, events=[(events[0][0] + 0.05, events[0][1]), *events[1:]])
    assert [event.t for event in late.missed] == [exact.events[0].t]
    assert [event.t for event in late.invented] == [events[0][0] + 0.05]
    shifted = crosscheck(name, *samples, events=[(time + 0.009, kind) for time, kind in events])
    assert len(shifted.missed) == len(shifted.invented) == len(events)
    with pytest.raises(ParameterError, match="finite"):
        crosscheck(name, *samples, events=[*events[:-1], (np.nan, events[-1][1])])


@pytest.mark.slow
def test_an_event_may_be_off_as_far_as_the_tolerance_moves_it() -> None:
    exact = simulate("fig9", t_end=8)
    t = np.linspace(0.1324, 8, 801)
    samples, event = (t, *exact(t)), exact.events[3]
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
    own, p = load_scene(scene), load_scene(scene).parameters
    exact = simulate(p, t0=own.t0, x0=own.x0, v0=own.v0, t_end=8)
    t = np.linspace(float(own.t0), 8, 801)
    x, v = exact(np.maximum(t - delay * np.minimum(1.0, (t - t[0]) / 4.0), t[0]))
    return (t, x, v), [(time + delay * min(1.0, (time - t[0]) / 4.0), kind) for time, kind in listed(exact)]


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
        for pairs in (events, events[:-1], [*events[:-1], (np.nextafter(events[-1][0], 9.0), event.kind)]):
            result = crosscheck("fig9", t, *exact(t), events=pairs)
            assert result.ok, result.summary()
        assert not crosscheck("fig9", t, *exact(t), events=[*events, events[-1]]).ok


def test_events_outside_the_samples_are_invented() -> None:
    exact = simulate("fig9", t_end=8)
    t = np.linspace(0.1324, 8, 300)
    for time in (-5.0, 0.1, 8.01, 1e9):
        result = crosscheck("fig9", t, *exact(t), events=sorted([*listed(exact), (time, "cross")]))
        assert [event.t for event in result.invented] == [time]


@pytest.mark.quick(2)
@pytest.mark.parametrize(("name", "t_end"), [("fig8", 9.0), ("fig8-exact", 6.0), ("fig7-exact", 8.0), ("fig7", 8.0)])
def test_touches_and_the_shortest_sticks(name: str, t_end: float) -> None:
    """A graze may be left out or seen as a contact of either kind, but not five times."""
    exact = simulate(name, t_end=t_end)
    t = np.linspace(2.5, t_end, 300)
    events, samples = listed(exact), (t, *exact(t))
    assert crosscheck(name, *samples, events=events).ok
    assert crosscheck(name, *samples, events=[event for event in events if event[1] != "graze"]).ok
    grazes = [i for i, (_, kind) in enumerate(events) if kind == "graze"]
    for i in grazes:
        for kinds, right in ((("stick", "slip"), True), (("cross", "cross"), True), (("graze",) * 5, False)):
            pairs = [(events[i][0], kind) for kind in kinds]
            assert crosscheck(name, *samples, events=[*events[:i], *pairs, *events[i + 1 :]]).ok == right
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
    """Tight DOP853, started anew at each event; also with the start listed and with both samples at each joint."""
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


def test_both_samples_of_each_joint_are_kept() -> None:
    for name in ("fig5", "fig9"):
        run = solve(load_scene(name), 10.0, joined=True, **TIGHT)
        assert np.sum(np.diff(run.t) == 0.0) >= len(run.events)
        result: CrossCheck = crosscheck(name, run.t, run.x, run.v, events=run.events)
        assert result.ok, result.summary()
        assert len(result.defects) == len(run.t) - 1
        assert crosscheck(name, run.t, run.x, run.v).ok


def test_a_jump_at_a_joint_is_a_wrong_step() -> None:
    run = solve(load_scene("fig9"), 6.0, joined=True, **TIGHT)
    joint = int(np.flatnonzero(np.diff(run.t) == 0.0)[3])
    run.x[joint + 1 :] = list(np.array(run.x[joint + 1 :]) + 1e-5)
    result = crosscheck("fig9", run.t, run.x, run.v, tolerance=1e-7, global_tolerance=1e-3)
    assert result.first_wrong is not None
    assert (result.first_wrong.step, result.first_wrong.reason) == (joint, "jump")
    assert result.defects[joint, 0] == pytest.approx(-1e-5, rel=1e-6)
    run.x[joint + 1 :] = list(np.array(run.x[joint + 1 :]) + 0.1)
    with pytest.raises(ParameterError, match=rf"t\[{joint + 1}\] .* is repeated with another state \(x jumps by 0.1"):
        crosscheck("fig9", run.t, run.x, run.v)


def test_the_longest_chain_is_the_best_of_all() -> None:
    rng = np.random.default_rng(6)
    for _ in range(200):
        cells = [(i, j) for i, j in product(range(4), range(4)) if rng.random() < 0.4]
        pairs = [(i, j, float(rng.integers(1, 9))) for i, j in cells]
        cost = {pair[:2]: pair[2] for pair in pairs}
        chains = [
            chain
            for n in range(5)
            for chain in combinations(cells, n)
            if all(a[0] < b[0] and a[1] < b[1] for a, b in pairwise(chain))
        ]
        best = min(chains, key=lambda chain: (-len(chain), sum(cost[pair] for pair in chain)))
        found = in_order(pairs)
        assert set(found) <= set(cells)
        assert all(a[0] < b[0] and a[1] < b[1] for a, b in pairwise(found))
        assert (len(found), sum(cost[pair] for pair in found)) == (len(best), sum(cost[pair] for pair in best))


class Told(Matcher):
    """A matcher of events that are told: exact ones, those of a list, and how far each of them reaches."""

    def __init__(self, found: Pairs, exact: Pairs = (), reaches: float = 0.0, wrong: tuple[int, ...] = ()) -> None:  # type: ignore[assignment]
        self.found = [SimpleNamespace(t=t, kind=kind) for t, kind in found]  # type: ignore[misc]
        self.exact = [SimpleNamespace(t=t, kind=kind, boundary=1) for t, kind in exact]  # type: ignore[misc]
        self.times = np.array([t for t, _ in exact])
        self.reaches = np.full(len(exact), reaches)
        self.wrong = np.isin(np.arange(10), wrong)
        self.steps: Any = SimpleNamespace(at=lambda time: (int(time), int(time)))
        self.open, self.free = set(range(len(found))), set(range(len(exact)))
        self.result, self.trajectory = Matching(), None  # type: ignore[assignment]


@pytest.mark.parametrize("kinds", [("graze",), ("stick", "slip"), ("cross", "cross"), ("stick",), ("slip", "stick")])
def test_contacts_near_a_touch_are_set_aside_together(kinds: tuple[str, ...]) -> None:
    """As far apart as the touch is wide they are one visit to the belt, which has to lead back whence it came."""
    width = 0.01
    for part, together in ((0.9, True), (1.1, False)):
        found = [(3.0 + 2 * part * width * i, kind) for i, kind in enumerate(kinds)]
        for near, wrong, left_alone in ((9.0, (), False), (3.0, (), True), (9.0, (3,), True), (9.0, (4,), False)):
            own = Told([*found, (5.0, "graze")], [(near, "cross")], 0.5 * width, wrong)
            own.reach = SimpleNamespace(of_touch=lambda _, time: width if time < 4 else None)  # type: ignore[assignment]
            own._touches()
            one_visit = kinds in (("graze",), ("stick", "slip"), ("cross", "cross")) and (together or len(kinds) == 1)
            aside = set(range(len(kinds))) if one_visit and not left_alone else set()
            if near == 3.0 and len(kinds) == 2 and part > 0.8:  # the second one is clear of the exact event
                aside = set()
            assert own.open == set(range(len(kinds) + 1)) - aside
            assert [event.t for event in own.result.unresolved] == [t for t, _ in found] * bool(aside)


def test_exact_events_are_close_if_their_reaches_meet_and_they_are_at_one_belt() -> None:
    rng = np.random.default_rng(3)
    for _ in range(40):
        times, belts = np.sort(rng.uniform(0, 1, 9)), rng.integers(1, 3, 9)
        own = Told([], [(float(t), "cross") for t in times])
        own.reaches = rng.uniform(0, 0.1, 9)
        for event, belt in zip(own.exact, belts, strict=True):
            event.boundary = belt  # type: ignore[misc]
        right = [[0]]
        for i in range(1, 9):
            meets = belts[i] == belts[i - 1] and times[i] - own.reaches[i] <= times[i - 1] + own.reaches[i - 1]
            right = [*right[:-1], [*right[-1], i]] if meets else [*right, [i]]
        assert own._close_events() == right


def test_what_is_left_of_a_list_or_of_wrong_steps_is_invented() -> None:
    """Of right steps it is open, where the step has such an event at that belt, or none; several are something else."""
    cross, stick = (next(code for code, name in KIND_NAMES.items() if name == kind) for kind in ("cross", "stick"))
    inside = {0: [], 1: [(cross, 1)], 2: [(cross, 2)], 3: [(stick, 1), (cross, 2)], 4: [(stick, 1)]}
    rows = [row for step in inside for row in inside[step]]
    starts = np.cumsum([0, *(len(each) for each in inside.values())])
    events = SimpleNamespace(
        kind=np.array([kind for kind, _ in rows]),
        boundary=np.array([boundary for _, boundary in rows]),
        rows=lambda first, last: slice(starts[first], starts[last + 1]),
    )
    for step, boundary in product(range(5), range(3)):
        for given, wrong in product((False, True), ((), (step,))):
            own = Told([(0.5, "cross")], wrong=wrong)
            own.given, own.steps = given, SimpleNamespace(events=events)
            vars(own.found[0]).update(step=step, last_step=step, boundary=boundary)
            own._leave_found()
            same = any(kind == cross and boundary in (0, belt) for kind, belt in inside[step])
            assert own.result.invented == (own.found if given or wrong else [])
            is_open = not given and not wrong and (same or not inside[step])
            assert own.result.unresolved == (own.found if is_open else [])


def test_events_that_only_the_samples_own_path_has_are_set_aside() -> None:
    """Each once: of a right step, of the kind, within reach, no exact event, and no partner of one."""
    cross, stick = (next(code for code, name in KIND_NAMES.items() if name == kind) for kind in ("cross", "stick"))
    base: dict[str, Any] = {
        "kind": cross,
        "t": 3.0,
        "step": 3,
        "exact": False,
        "used": False,
        "wrong": (),
        "reach": 0.01,
    }
    for change, aside in (
        ({}, True), ({"kind": stick}, False), ({"t": 3.02}, False), ({"t": 3.009}, True), ({"exact": True}, False),
        ({"used": True}, False), ({"wrong": (3,)}, False), ({"reach": 0.0, "t": 3.001}, False),
        ({"t": 3.02, "listed": 0.02}, True),
    ):  # fmt: skip
        told = base | {"listed": 0.0} | change
        own = Told([(3.0, "cross"), (3.0, "cross")], wrong=told["wrong"])
        events = SimpleNamespace(t=np.array([told["t"]]), kind=np.array([told["kind"]]), step=np.array([told["step"]]))
        own.steps = SimpleNamespace(events=events, K=SimpleNamespace(period=6.0))
        own.local = [0 if told["used"] else None, None]
        own._is_exact = lambda row, told=told: told["exact"]  # type: ignore[method-assign]
        listed = np.full(2, told["listed"])
        own.reach = SimpleNamespace(of_row=lambda row, told=told: told["reach"], listed=listed)  # type: ignore[assignment]
        own._neighbours()
        assert own.open == ({1} if aside else {0, 1}), change
        assert own.result.unresolved == (own.found[:1] if aside else [])


def test_an_event_of_right_steps_is_the_nearest_of_its_kind_within_a_twentieth_of_a_period() -> None:
    """At its belt; of wrong steps none. What is left is missed, matched by that, or not on the samples' path."""
    codes = {name: code for code, name in KIND_NAMES.items()}
    rows = [(2.75, "cross", 1), (2.9, "stick", 1), (3.2, "cross", 2), (3.25, "cross", 1), (3.4, "cross", 1)]
    events = SimpleNamespace(
        t=np.array([t for t, _, _ in rows]), kind=np.array([codes[kind] for _, kind, _ in rows]),
        boundary=np.array([belt for _, _, belt in rows]), step=np.arange(5),
    )  # fmt: skip
    own = Told([], [(3.0, "cross")])
    for period, wrong, right in ((6.0, (), 3), (4.0, (), None), (4.3, (0,), 3), (6.0, (3,), 0), (9.0, (0, 3), 4),
                                 (6.0, (0, 3), None), (4.1, (), None)):  # fmt: skip
        own.steps = SimpleNamespace(events=events, K=SimpleNamespace(period=period))
        own.wrong = np.isin(np.arange(5), wrong)
        event: Any = SimpleNamespace(kind="cross", boundary=1)
        assert own._local(event, 3.04) == right, (period, wrong)


@pytest.mark.parametrize("given", [False, True])
def test_an_exact_event_without_a_partner_is_missed_or_inside_a_step_or_open(given: bool) -> None:
    for kind, wrong, inside, at_end, time in product(
        ("cross", "graze"), ((), (3,)), (None, 3.2, 3.4), (False, True), (3.1, 9.5)
    ):
        own = Told([], [(time, kind)], wrong=wrong)
        own.given = given
        own.steps = SimpleNamespace(
            t=np.arange(10.0), K=SimpleNamespace(period=5.0), at=lambda time, slack: (int(time), int(time))
        )
        own._is_at_an_end = lambda i, at_end=at_end: at_end  # type: ignore[method-assign]
        own._inside = lambda *_, inside=inside: inside  # type: ignore[method-assign]
        own._leave_exact()
        near = inside == 3.2
        said = own.result.missed, [match.event for match in own.result.matched], own.result.unresolved
        if time > 9:
            right = 3
        elif at_end:
            right = 2
        elif wrong or (given and near and kind != "graze"):
            right = 0 if kind != "graze" else 3
        else:
            right = 1 if near else 2
        assert [len(each) for each in said] == [int(right == k) for k in range(3)], (kind, wrong, inside, at_end, time)
