"""simulate and simulate_many, compiled or not, are one engine: the same events, errors and status, bit for bit."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import creeping
import problems
import pytest
import touches
from samples import few
from touches import tenths

from symosc import ParameterError, Parameters, load_scene, scene_names, simulate, simulate_many
from symosc.simulation import chunks, ladder
from symosc.simulation.ensemble import EventTable

COLUMNS = ("t", "x", "v", "theta", "t_error", "x_error", "boundary", "kind", "source", "target")
Problem = tuple[Parameters, tuple[Any, Any, Any], Any]  # parameters, start, end


def of_estimates(family: str, rng: random.Random) -> Problem:
    p, start = problems.FAMILIES[family](rng)
    return p, (start["t0"], start["x0"], start["v0"]), start["t_end"]


def of_touches(make: Any, rng: random.Random) -> Problem:
    scene = make(rng, rng.choice(list(touches.NEIGHBOURS)))
    return scene.p, (0, scene.x0, scene.v0), scene.t_end


def of_creeping(make: Any, rng: random.Random, *arguments: Any) -> Problem:
    scene = make(rng, rng.choice(list(creeping.AHEAD)), *arguments)
    return scene.p, (0, scene.x0, scene.v0), scene.t_end


def close_belts(rng: random.Random) -> Problem:
    """Return belts a few units of rounding apart: two events that round to one t."""
    p, start = problems.ordinary(rng)
    apart = Fraction(rng.randint(1, 99), 10 ** rng.randint(12, 17))
    p = p.replace(v2=p.v1 + apart, mu1=rng.choice([0, "0.3"]), mu2=rng.choice([0, "0.2"]))
    t0 = start["t0"] + rng.choice([0, 0, 10**5])
    return p, (t0, start["x0"], start["v0"]), t0 + 10


def undriven(rng: random.Random) -> Problem:
    v1 = tenths(rng, -20, 0)
    p, start = problems.ordinary(rng, B0=0, v1=v1, v2=rng.choice([max(Fraction(0), v1 + 1), v1 + 3]))
    return p, (start["t0"], start["x0"], start["v0"]), start["t_end"] + 80


FAMILIES: dict[str, Callable[[random.Random], Problem]] = {
    **{name: lambda rng, name=name: of_estimates(name, rng) for name in problems.FAMILIES},
    **{f"touches, {make.__name__}": lambda rng, make=make: of_touches(make, rng)
       for make in (touches.ordinary, touches.wild, touches.undriven, touches.free)},
    "belt at rest": lambda rng: of_creeping(creeping.to_a_belt_at_rest, rng, Fraction(rng.choice([0, -1, 1]), 9)),
    "limit speed": lambda rng: of_creeping(creeping.to_a_limit_speed, rng, Fraction(rng.choice([0, 1]), 10**9)),
    "tiny drive": lambda rng: of_creeping(creeping.with_a_tiny_drive, rng, 12),
    "close belts": close_belts,
    "undriven": undriven,
}  # fmt: skip


def rows(table: EventTable, number: int = 0) -> list[tuple[Any, ...]]:
    mine = table.trajectory == number
    return list(zip(*(getattr(table, name)[mine].tolist() for name in COLUMNS), strict=True))


def assert_one_engine(problem: Problem, use_numba: bool, **options: Any) -> Any:
    """Compare all numbers of all events, and the status; NaN nowhere."""
    p, (t0, x0, v0), t_end = problem
    trajectory = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end, **options)
    table = simulate_many(p, [t0, x0, v0], t_end, use_numba=use_numba, **options)
    events = [tuple(getattr(event, name) for name in COLUMNS) for event in trajectory.events]
    assert rows(table) == events, problem
    assert table.status == [trajectory.status], problem
    return trajectory


COMPILED = pytest.param(True, marks=[pytest.mark.slow, pytest.mark.compiled("doubles")])
ENGINES = pytest.mark.parametrize("use_numba", [False, COMPILED], ids=["interpreted", "compiled"])


def available(use_numba: bool) -> None:
    if use_numba:
        pytest.importorskip("numba", reason="numba is the extra `fast`")


@pytest.mark.full(22)
@pytest.mark.quick(3)
@ENGINES
@pytest.mark.parametrize("seed", few([0, 1], 1))
@pytest.mark.parametrize("family", FAMILIES)
def test_bit_for_bit(family: str, seed: int, use_numba: bool) -> None:
    available(use_numba)
    assert_one_engine(FAMILIES[family](random.Random(f"{family} {seed}")), use_numba)


@pytest.mark.campaign
@ENGINES
@pytest.mark.parametrize("family", FAMILIES)
def test_bit_for_bit_in_many_scenes(family: str, use_numba: bool) -> None:
    available(use_numba)
    for seed in range(100, 160):
        problem = FAMILIES[family](random.Random(f"{family} {seed}"))
        for options in ({}, {"accuracy": 1e-9}, {"accuracy": math.inf}, {"max_events": 3}):
            assert_one_engine(problem, use_numba, **options)


@pytest.mark.quick(4)
@ENGINES
@pytest.mark.parametrize("name", scene_names())
def test_shipped_scenes_bit_for_bit(name: str, use_numba: bool) -> None:
    available(use_numba)
    scene = load_scene(name)
    problem = (scene.parameters, (scene.t0, scene.x0, scene.v0), scene.t_end)
    for options in ({}, {"accuracy": 1e-9}, {"accuracy": math.inf}, {"max_events": 1}, {"max_events": 2}):
        assert_one_engine(problem, use_numba, start_error=scene.start_error, **options)


@pytest.mark.full(3)
@pytest.mark.quick(3)
@ENGINES
@pytest.mark.parametrize("accuracy", few([1e-9, 1e-12, math.inf, 1e-15], 1e-15))
def test_any_accuracy_bit_for_bit(accuracy: float, use_numba: bool) -> None:
    available(use_numba)
    for family in ("ordinary", "late", "resonant", "touches, ordinary"):
        assert_one_engine(FAMILIES[family](random.Random(f"{family} accuracy")), use_numba, accuracy=accuracy)


@pytest.mark.slow
@ENGINES
def test_a_batch_is_its_trajectories_one_by_one(use_numba: bool) -> None:
    """Mixed parameters, some of them twice, some in doubt: every row is where it belongs."""
    available(use_numba)
    problems = [FAMILIES[family](random.Random(f"{family} batch")) for family in list(FAMILIES) * 2]
    sets, starts, ends = (list(column) for column in zip(*problems, strict=True))
    table = simulate_many(sets, starts, ends, use_numba=use_numba, max_events=40)
    assert table.trajectory.tolist() == sorted(table.trajectory.tolist())
    for number, (p, (t0, x0, v0), t_end) in enumerate(problems):
        alone = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end, max_events=40)
        assert rows(table, number) == [tuple(getattr(event, name) for name in COLUMNS) for event in alone.events]
        assert table.status[number] == alone.status
    assert {"t_end", "equilibrium", "max_events"} <= set(table.status)


# -- every way to end --------------------------------------------------------------------------------------------------


@ENGINES
@pytest.mark.parametrize("most", [1, 2, 5])
def test_max_events(most: int, use_numba: bool) -> None:
    available(use_numba)
    for name in ("fig5", "fig8", "fig9", "fig10"):
        scene = load_scene(name)
        problem = (scene.parameters, (scene.t0, scene.x0, scene.v0), 1000)
        trajectory = assert_one_engine(problem, use_numba, max_events=most)
        assert (trajectory.status, len(trajectory.events)) == ("max_events", most)
        assert trajectory.t_end == trajectory.events[-1].t


@ENGINES
def test_exactly_as_many_events_as_there_are(use_numba: bool) -> None:
    """The limit counts only if the motion would go on."""
    available(use_numba)
    scene = load_scene("fig5")
    count = len(simulate(scene).events)
    problem = (scene.parameters, (scene.t0, scene.x0, scene.v0), scene.t_end)
    for most in (count - 1, count, count + 1):
        trajectory = assert_one_engine(problem, use_numba, max_events=most)
        assert len(trajectory.events) == min(most, count)
        assert trajectory.status == ("t_end" if most > count else "max_events")


@ENGINES
def test_a_motion_that_comes_to_rest(use_numba: bool) -> None:
    available(use_numba)
    base = {"m": 1, "c": 3, "k": 1, "A0": 0, "B0": 0, "Omega": 1, "mu1": "0.3", "mu2": "0.3", "FN": 1}
    cases = {
        "on a belt": (Parameters(**base, v1=0, v2=1), (0, "0.1", 0), "equilibrium"),
        "between belts": (Parameters(**base, v1=-1, v2=1), (0, 5, "0.2"), "equilibrium"),
        "carried on for ever": (Parameters(**(base | {"k": 0, "c": 0}), v1=1, v2=2), (0, 0, 1), "t_end"),
        "beside a belt": (Parameters(**base, v1=-1, v2=0), (0, 5, "-1/5"), "equilibrium"),
    }
    for name, (p, start, status) in cases.items():
        for t_end in (40, 10**9):
            assert assert_one_engine((p, start, t_end), use_numba).status == status, name


@ENGINES
def test_a_belt_for_ever(use_numba: bool) -> None:
    """More periods than are followed, but none of them needs to be: the forces repeat."""
    available(use_numba)
    p = Parameters(m=1, c=1, k=0, A0=0, B0="0.5", Omega=5, v1=1, v2=2, mu1=2, mu2=2, FN=3)
    trajectory = assert_one_engine((p, (0, 0, 1), 10**9), use_numba)
    assert (trajectory.status, list(trajectory.events)) == ("t_end", [])
    x, v = trajectory(1e9)
    assert (x, v) == (1e9, 1.0)


@ENGINES
def test_more_periods_than_are_followed(use_numba: bool) -> None:
    """Both refuse, with the same words; unless the motion ends before."""
    available(use_numba)
    p = Parameters(m=1, c=0, k=1, A0=0, B0=0, Omega=10**9, v1=-5, v2=5, mu1=1, mu2=1, FN=1)
    assert assert_one_engine((p, (0, 1, 0), 1), use_numba).status == "t_end"
    messages = []
    for run in (
        lambda: simulate(p, t0=0, x0=1, v0=0, t_end=10**6, max_events=10),
        lambda: simulate_many(p, [0, 1, 0], 10**6, max_events=10, use_numba=use_numba),
    ):
        try:
            run()
            messages.append("")
        except ParameterError as error:
            messages.append(str(error))
    assert messages[0] == messages[1]


@pytest.mark.slow
@ENGINES
def test_a_motion_that_doubles_cannot_follow(use_numba: bool) -> None:
    available(use_numba)
    scene = load_scene("fig8")
    problem = (scene.parameters, (scene.t0, scene.x0, scene.v0), 160)
    trajectory = assert_one_engine(problem, use_numba)
    assert (trajectory.status, len(trajectory.events)) == ("undecidable", 72)
    assert trajectory.t_end == pytest.approx(62.83, abs=0.01)


@ENGINES
def test_two_events_that_round_to_one_time(use_numba: bool) -> None:
    """Belts 1e-11 apart at t = 1e5: both crossings are reported, in order, and no contact was in doubt."""
    available(use_numba)
    p = Parameters(
        m="579/1000", c="593/10000", k="387/100", A0=0, B0="507/100", Omega="209/100", v1=-3,
        v2="-299999999997/100000000000", mu1=0, mu2="19/25", FN="4/25",
    )  # fmt: skip
    start = ("500439/5", "-169/2000", "-299999999997/100000000000")
    trajectory = assert_one_engine((p, start, "100107531/1000"), use_numba)
    assert trajectory.status == "t_end"
    times = [event.t for event in trajectory.events]
    assert times == sorted(times)
    assert len(set(times)) < len(times)
    for before, after in zip(trajectory.events, trajectory.events[1:], strict=False):
        assert before.target == after.source


@pytest.mark.quick(1)
@ENGINES
def test_grazes_that_only_the_batch_once_missed(use_numba: bool) -> None:
    available(use_numba)
    p = Parameters(
        m="5.008", k=1, c=0, Omega=".8999", A0="-.07014", B0=0, FN=".1406", mu1=".7495", mu2=0, v1=".01733",
        v2=".0173300000493",
    )  # fmt: skip
    trajectory = assert_one_engine((p, (0, 0, p.v2), "3619/50"), use_numba)
    assert sum(event.kind == "graze" for event in trajectory.events) == 5


@ENGINES
@pytest.mark.parametrize("t0", [0, 10**8, -(10**8)])
def test_a_batch_in_which_all_is_clear_needs_no_closer_look(
    t0: int, use_numba: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A late or early clock is coarse, but in proportion to t."""
    available(use_numba)

    def refuse(*arguments: Any) -> Any:
        raise AssertionError("a closer look")

    monkeypatch.setattr(chunks, "in_doubles", refuse)
    monkeypatch.setattr(ladder, "climb", refuse)
    for name in ("fig5", "fig6", "fig9", "fig10"):
        scene = load_scene(name)
        table = simulate_many(scene.parameters, [t0, scene.x0, scene.v0], t0 + 20, use_numba=use_numba)
        assert len(table) >= 1
        assert table.status == ["t_end"]
