"""simulate and simulate_many, compiled or not, are one engine.

The same events and statuses, numbers within errors.
"""

from __future__ import annotations

import csv
import math
import random
import sys
import threading
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from effort import PATIENCE
from fuzz import FAMILIES, scene_of
from samples import sample_of
from scene_families import shortened

from symosc import (
    MissingExtraError,
    OutputError,
    ParameterError,
    Parameters,
    Trajectory,
    load_scene,
    scene_names,
    simulate,
    simulate_many,
)
from symosc.engine.arithmetic import interpreted_pairs
from symosc.engine.batch import EventRows
from symosc.simulation.batch import CancelToken, in_chunks
from symosc.simulation.loops import CHOICE
from symosc.simulation.simulate import in_doubles, read_start
from symosc.simulation.tables import EventTable

Problem = tuple[Parameters, tuple[Any, Any, Any], Any]  # parameters, start, end


def assert_same(table: EventTable, number: int, alone: Trajectory, about: Any = None) -> None:
    """Compare the events of one trajectory in a table with those of `simulate`.

    The same, numbers within errors.
    """
    mine = table[number]
    assert mine.status == [alone.status], about
    for name in ("kind", "boundary", "source", "target"):
        assert getattr(mine, name).tolist() == [getattr(event, name) for event in alone.events], (
            about
        )
    for name in ("t", "x"):
        value, error = (
            np.array([getattr(event, n) for event in alone.events]) for n in (name, f"{name}_error")
        )
        assert (abs(getattr(mine, name) - value) <= 8 * error).all(), about
        np.testing.assert_allclose(
            getattr(mine, f"{name}_error"), error, rtol=0.1, err_msg=str(about)
        )


def assert_one_engine(problem: Problem, use_numba: bool, **options: Any) -> Any:
    p, (t0, x0, v0), t_end = problem
    trajectory = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end, **options)
    table = simulate_many(p, [t0, x0, v0], t_end, use_numba=use_numba, **options)
    assert_same(table, 0, trajectory, problem)
    return trajectory


COMPILED = pytest.param(True, marks=[pytest.mark.slow, pytest.mark.compiled("doubles")])
ENGINES = pytest.mark.parametrize("use_numba", [False, COMPILED], ids=["interpreted", "compiled"])


def available(use_numba: bool) -> None:
    if use_numba:
        pytest.importorskip("numba", reason="numba is the extra `fast`")


@pytest.mark.full(4)
@pytest.mark.quick(3)
@ENGINES
@pytest.mark.parametrize("name", scene_names())
def test_shipped_scenes(name: str, use_numba: bool) -> None:
    available(use_numba)
    scene = load_scene(name)
    problem = (scene.parameters, (scene.t0, scene.x0, scene.v0), scene.t_end)
    for options in ({}, {"accuracy": math.inf}, {"max_events": 2}):
        assert_one_engine(problem, use_numba, start_error=scene.start_error, **options)


@pytest.mark.slow
@ENGINES
def test_a_batch_is_its_trajectories_one_by_one(use_numba: bool) -> None:
    """Mixed parameters, some of them twice, some undecided, in any order.

    Every row is where it belongs.
    """
    available(use_numba)
    scenes = [
        shortened(scene_of(family, 1001, n), Fraction(1, 8)) for family in FAMILIES for n in (0, 1)
    ]
    work: list[Problem] = [
        (scene.p, (scene.t0, scene.x0, scene.v0), scene.t_end) for scene in scenes
    ] * 2
    work += [
        (p, start, start[0] + 25) for p, starts in map(fig8_like, range(2)) for start in starts[:3]
    ]
    sets, starts, ends = (list(column) for column in zip(*work, strict=True))
    table = simulate_many(sets, starts, ends, use_numba=use_numba, max_events=40)
    assert table.trajectory.tolist() == sorted(table.trajectory.tolist())
    for number, (p, (t0, x0, v0), t_end) in enumerate(work):
        assert_same(
            table, number, simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end, max_events=40), number
        )
    assert {"t_end", "equilibrium", "max_events"} <= set(table.status)
    order = random.Random(1).sample(range(len(work)), len(work))
    mixed = simulate_many(
        *([column[i] for i in order] for column in (sets, starts, ends)), use_numba=use_numba
    )
    whole = simulate_many(sets, starts, ends, use_numba=use_numba)
    assert all(mixed[place] == whole[i] for place, i in enumerate(order))


# -- every way to end --------------------------------------------------------------------------------------------------


@ENGINES
def test_max_events(use_numba: bool) -> None:
    """The limit counts only if the motion would go on."""
    available(use_numba)
    scene = load_scene("fig5")
    count = len(simulate(scene).events)
    problem = (scene.parameters, (scene.t0, scene.x0, scene.v0), scene.t_end)
    for most in (1, 5, count - 1, count, count + 1, 10**400):
        trajectory = assert_one_engine(problem, use_numba, max_events=most)
        assert len(trajectory.events) == min(most, count)
        assert trajectory.status == ("t_end" if most > count else "max_events")
        assert most > count or trajectory.t_end == trajectory.events[-1].t


@ENGINES
def test_a_motion_that_comes_to_rest(use_numba: bool) -> None:
    available(use_numba)
    base = {
        "m": 1,
        "c": 3,
        "k": 1,
        "A0": 0,
        "B0": 0,
        "Omega": 1,
        "mu1": "0.3",
        "mu2": "0.3",
        "FN": 1,
    }
    cases = {
        "on a belt": (Parameters(**base, v1=0, v2=1), (0, "0.1", 0), "equilibrium"),
        "between belts": (Parameters(**base, v1=-1, v2=1), (0, 5, "0.2"), "equilibrium"),
        "carried on for ever": (
            Parameters(**(base | {"k": 0, "c": 0}), v1=1, v2=2),
            (0, 0, 1),
            "t_end",
        ),
        "beside a belt": (Parameters(**base, v1=-1, v2=0), (0, 5, "-1/5"), "equilibrium"),
    }
    for name, (p, start, status) in cases.items():
        for t_end in (40, 10**9):
            assert assert_one_engine((p, start, t_end), use_numba).status == status, name
            many = simulate_many([p] * 9, start, t_end, use_numba=use_numba)
            assert many.status == [status] * 9


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
            messages.append(str(run().status))
        except ParameterError as error:
            messages.append(str(error))
    assert messages[0].strip("'[]") == messages[1].strip("'[]")


@pytest.mark.slow
@ENGINES
def test_a_motion_that_doubles_cannot_follow(use_numba: bool) -> None:
    available(use_numba)
    scene = load_scene("fig8")
    trajectory = assert_one_engine(
        (scene.parameters, (scene.t0, scene.x0, scene.v0), 160), use_numba
    )
    assert (trajectory.status, len(trajectory.events)) == ("t_end", 196)


@ENGINES
def test_two_events_that_round_to_one_time(use_numba: bool) -> None:
    """Belts 1e-11 apart at t = 1e5.

    Both crossings are reported, in order, and no contact was in doubt.
    """
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


# -- pairs of doubles, and more digits ---------------------------------------------------------------------------------


def fig8_like(seed: int) -> tuple[Parameters, list[tuple[Fraction, ...]]]:
    """Return parameters near those of fig8, whose errors grow, and starts on and beside belts."""
    dice = random.Random(seed)
    p = load_scene("fig8").parameters
    p = p.replace(
        A0=p.A0 + Fraction(dice.randint(-99, 99), 100),
        Omega=2 + Fraction(dice.randint(-50, 50), 100),
    )
    starts = [
        (Fraction(dice.randint(0, 50), 10), Fraction(dice.randint(-600, 600), 100))
        for _ in range(6)
    ]
    return p, [
        (t, x, dice.choice((p.v1, p.v2, Fraction(dice.randint(-300, 300), 100)))) for t, x in starts
    ]


def assert_climbs(seed: int, most_starts: int, **arguments: Any) -> None:
    p, starts = fig8_like(seed)
    starts = starts[:most_starts]
    table = simulate_many(p, starts, [t + 30 for t, _, _ in starts], **arguments)
    for i, (t0, x0, v0) in enumerate(starts):
        alone = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t0 + 30, **arguments)
        assert_same(table, i, alone, (seed, i))
        assert table[i].t_error.tolist() == [event.t_error for event in alone.events]


@pytest.mark.compiled("pairs")
@pytest.mark.slow
@sample_of(4, 200)
def test_events_of_pairs_are_those_of_many_digits(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("numba")
    monkeypatch.setattr(CHOICE.pairs, "events", 0)
    monkeypatch.setattr(CHOICE.doubles, "events", 0)
    for seed in range(count):
        accuracy, most = random.Random(seed).choice(((1e-15, None), (5e-16, 40), (3e-16, 7)))
        assert_climbs(seed, 6, accuracy=accuracy, max_events=most)


@pytest.mark.compiled("pairs")
@pytest.mark.slow
def test_what_pairs_leave_open_is_left_to_more_digits() -> None:
    """A swing that just touches a belt, and starts that are known to so much only."""
    pytest.importorskip("numba")
    swing = Parameters(m=1, c=0, k=1, A0=0, B0=0, Omega=1, v1=-1, v2=5, mu1=0, mu2=0, FN=1)
    table = simulate_many(swing, [(0, 1, 0), (0, "0.999", 0)], 7)
    assert_same(table, 0, simulate(swing, t0=0, x0=1, v0=0, t_end=7))
    assert table.kind.tolist() == ["graze"]
    scene = load_scene("fig8-exact")
    start = (scene.t0, scene.x0, scene.v0)
    error = scene.start_error
    table = simulate_many(scene.parameters, [start] * 2, scene.t_end, start_error=error)
    for number in (0, 1):
        assert_same(table, number, simulate(scene))
    assert "graze" in table.kind.tolist()


def test_more_digits_from_the_start_need_not_step_as_pairs_did() -> None:
    pytest.importorskip("numba")
    """Pairs stop between events here, before a stick that digits from there know too little of."""
    p = Parameters(
        m="0.159", c="0.477", k="4293/12500", A0=0, B0="-1.2e-14", Omega="0.31", v1=0, v2="1.01412", mu1="0.348",
        mu2="0.054", FN="2.86",
    )  # fmt: skip
    start: dict[str, Any] = {"t0": 0, "x0": "-8915/2862", "v0": "0.8"}
    computed = in_doubles(
        read_start(p, {**start, "t_end": 50}, None), 10, 1e-13, loops=interpreted_pairs()
    )
    known = simulate(p, **start, t_end=50, digits=25)
    assert computed.status == "t_end"
    assert (
        [event.kind for event in computed.events]
        == [event.kind for event in known.events]
        == ["stick", "slip"]
    )
    for event, there in zip(computed.events, known.events, strict=True):
        assert event.t == pytest.approx(float(there.t), rel=1e-14)


@pytest.mark.compiled("pairs")
def test_accuracy_asks_for_more_digits_or_none() -> None:
    """In fig8 errors grow: a double knows its 20th event to some 1e-12, and says so."""
    scene = load_scene("fig8")
    start = [scene.t0, scene.x0, scene.v0]
    exact = simulate(scene, digits=25).events
    finer = simulate(scene)
    plain = simulate(scene, accuracy=math.inf)
    rough = simulate_many(scene.parameters, start, scene.t_end, accuracy=1e-9)
    assert (
        max(event.x_error for event in finer.events)
        < 1e-13
        < max(event.x_error for event in plain.events)
    )
    assert rough.x_error.tolist() == pytest.approx(
        [event.x_error for event in plain.events], rel=1e-6
    )
    for event, error, x in zip(exact, rough.x_error, rough.x, strict=True):
        assert abs(float(event.x - x)) < 8 * error + 1e-15
    in_t, in_x = ((error / np.maximum(1, np.abs(value))).max() for error, value in
                  ((rough.t_error, rough.t), (rough.x_error, rough.x)))  # fmt: skip
    assert in_t < in_x  # the position alone is reason enough
    by_x = simulate_many(scene.parameters, start, scene.t_end, accuracy=math.sqrt(in_t * in_x))
    assert by_x.x.tolist() == [event.x for event in finer.events]


# -- columns, tables and threads ---------------------------------------------------------------------------------------


def test_columns_are_rows_of_parameters() -> None:
    """Also where a decision of the constants is exact.

    Critical damping, resonance, forces that cancel.
    """
    p = load_scene("fig9").parameters
    for changes in (
        {},
        {"c": "0.2", "k": "0.01", "m": 1},
        {"k": 1, "m": 1, "c": 0},
        {"k": 0, "A0": "0.3", "B0": 0},
    ):
        q = p.replace(**changes)
        FN = np.linspace(3, 5, 20)
        columns = {name: getattr(q, name) for name in q.as_dict()} | {
            "FN": FN,
            "mu1": "0.1",
            "mu2": 0,
        }
        table = simulate_many(columns, (0, 0, 0), 5, use_numba=False)
        for i, force in enumerate(FN.tolist()):
            alone = simulate(q.replace(FN=force, mu1="0.1", mu2=0), t0=0, x0=0, v0=0, t_end=5)
            assert_same(table, i, alone, (changes, i))


def test_a_table_has_its_trajectories_by_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    p = load_scene("fig9").parameters
    table = simulate_many(p, [(0, 0, 0), (0, 1, 2), (0, 2, 0)], 5, use_numba=False)
    for number in (0, 2, -1):
        alone = table[number]
        rows = table.trajectory == number % 3
        assert alone.t.tolist() == table.t[rows].tolist()
        assert (set(alone.trajectory.tolist()), alone.status) == ({0}, ["t_end"])
    with pytest.raises(IndexError):
        table[3]
    with pytest.raises(AttributeError, match="no column 'kinds'; it has trajectory, t, x"):
        _ = table.kinds
    assert repr(table) == f"<EventTable of {len(table)} events of 3 motions (3 t_end)>"
    table.to_csv(tmp_path / "events.csv")
    rows = list(csv.DictReader((tmp_path / "events.csv").read_text().splitlines()))
    assert [float(row["t"]) for row in rows] == table.t.tolist()
    assert [row["kind"] for row in rows] == table.kind.tolist()
    with pytest.raises(OutputError):
        table.to_csv(tmp_path / "missing" / "events.csv")
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "pandas", None)
        with pytest.raises(MissingExtraError, match=r"a table of pandas.*symosc\[sweep\]"):
            table.to_pandas()
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    frame = table.to_pandas()
    dataset = table.to_xarray()
    assert frame["kind"].tolist() == dataset["kind"].values.tolist() == table.kind.tolist()
    assert dataset["status"].values.tolist() == table.status


@pytest.mark.parametrize("workers", [1, 3])
def test_progress_ends_with_all_rows(workers: int) -> None:
    told = list[tuple[int, int]]()
    chunks = in_chunks(
        1040, lambda rows, room, cancel: rows, workers, lambda done, of: told.append((done, of))
    )
    assert [i for rows in chunks for i in range(1040)[rows]] == list(range(1040))
    assert told == sorted(told)
    assert told[-1] == (1040, 1040)
    assert len(told) == len(chunks) > 1


@pytest.mark.parametrize("where", ["chunk", "caller"])
def test_an_interrupt_ends_all_threads(where: str) -> None:
    running = threading.Event()
    begun = []

    def work(rows: slice, room: EventRows, cancel: CancelToken) -> None:
        begun.append(rows.start)
        if rows.start == 0:
            assert running.wait(PATIENCE)
            if where == "chunk":
                raise KeyboardInterrupt
            return
        running.set()
        assert cancel.wait(PATIENCE), "nobody ends it"
        cancel.check()

    def interrupted(done: int, of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        in_chunks(40, work, 3, interrupted)
    assert (
        len(begun) <= 4 < 14
    )  # chunks: the thread that failed may take another one before the others are stopped
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("symosc")]
