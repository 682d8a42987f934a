"""Motions of all regimes one by one and together.

Events, states between them, summaries, files and statuses.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from math import inf
from typing import Any
from unittest.mock import patch

import numpy as np
import scene_families
from paper_orbits import FIG9
from problems import FAMILIES
from regimes import random_sets
from said import errors_of, written
from touches import steady

from symosc import OtherModel, Parameters, Scene, Trajectory, simulate, simulate_many
from symosc.simulation.loops import CHOICE
from symosc.simulation.problems import NumberColumn, Problems

SHIFTED = OtherModel(
    m=2, k="8.5", c="0.4", Omega="3/2", FN="1.5", mu1="0.8", v1=0, v2=1, mu2="0.3", Y="0.7", joined=True, A0=1,
    Y_phase="0.3",
)  # fmt: skip


def told(motion: Trajectory) -> Iterator[Any]:
    """Yield the events of a motion line by line, its status, and states between its events."""
    yield [str(each) for each in (motion.status, motion.message, " ".join(motion.word))]
    for e in motion.events:
        yield [
            e.kind,
            e.boundary,
            e.source,
            e.target,
            *(float(each) for each in (e.t, e.x, e.theta)),
            e.t_error,
            e.x_error,
        ]
    times = np.linspace(float(motion.t_start), float(motion.t_end), 40)
    yield motion(times)
    yield motion(times[3::12])
    yield [*motion.mode(times[::3]), motion.mode(times[7])]
    yield np.array([motion.force(alpha, times) for alpha in (1, 2, 3)])
    yield motion.force(2, times[5])


def families() -> Iterator[Any]:
    """Yield the beginnings of random motions of each family, and how they end."""
    for name in ("wide", "late", "digits", "coincide", "extreme", "onbelt", "rest", "undriven"):
        rng = random.Random(name)
        for number in range(5):
            scene = getattr(scene_families, name)(rng, number)
            given = {"t0": scene.t0, "x0": scene.x0, "v0": scene.v0, "t_end": scene.t_end}
            motion = simulate(scene.p, **given, max_events=12)
            yield f"{name} {number} {motion.status} {' '.join(motion.word)}"
            for event in motion.events[::4]:
                yield [
                    event.kind,
                    event.boundary,
                    event.source,
                    event.target,
                    event.t,
                    event.x,
                    event.v,
                ]
            yield motion(
                motion.t_start + (motion.t_end - motion.t_start) * np.array([0.1, 0.5, 1.0])
            )


def touching() -> Iterator[Any]:
    """Yield motions that touch a belt exactly, alone and together, which take more digits."""
    rng = random.Random("touches")
    found = []
    while len(found) < 3:
        scene = steady(
            rng, rng.choice(["P2", "P3", "P5", "P6"]), m=FIG9.m * rng.randint(2, 9), c=FIG9.c * rng.randint(1, 5),
            Omega=FIG9.Omega / rng.randint(1, 5), radius=FIG9.FN / 7, direction=(FIG9.k / 5, FIG9.k * 4 / 15),
        )  # fmt: skip
        if scene:
            found += [scene]
        else:
            found += []
    for scene in found:
        start = {"t0": 0, "x0": scene.x0, "v0": scene.v0, "t_end": scene.t_end}
        yield [(e.kind, e.boundary, e.source, e.t, e.x) for e in simulate(scene.p, **start).events]
        many = simulate_many(
            scene.p, [(0, scene.x0 + k * FIG9.m, scene.v0) for k in range(2)], scene.t_end
        )
        yield many.columns()
        for use_numba in (
            None,
            False,
        ):  # what doubles do not decide goes to pairs, or is followed alone
            how: dict[str, Any] = {"record": "summary", "sections": 2, "use_numba": use_numba}
            yield simulate_many(scene.p, (0, scene.x0, scene.v0), scene.t_end, **how).columns()
    scene = found[0]
    yield [
        e.kind
        for e in simulate(
            scene.p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, accuracy=inf
        ).events
    ]
    yield told(simulate(scene.p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, digits=12))


def interpreted(make: Callable[[], Iterator[Any]]) -> list[Any]:
    """Return what a case yields, without a compiler, however many events were followed before."""
    with (
        patch.object(CHOICE.doubles, "events", 250_000),
        patch.object(CHOICE.pairs, "events", 25_000),
    ):
        return list(make())


def exact() -> Iterator[Any]:
    """Yield motions with digits, with errors of the start, and with an end before t_end."""
    with_digits = simulate("fig5", t_end=7, digits=22)
    yield with_digits.as_dict()
    yield told(with_digits)
    yield told(simulate("fig8-exact", t_end=9, digits=15))
    yield told(simulate("fig9", t_end=3, start_error="0.001"))
    yield told(simulate("fig10", t_end=4, start_error=["1e-9", 0, "1e-7"], max_events=3))
    yield simulate("fig10", t_end=4, digits=15, max_events=3).message
    yield simulate("fig8", t_end=9, digits=20).message
    # Without a spring v tends to a speed that is so little above that of belt 1; it is there at t =
    # 92 or 923.
    for nines, t_end, digits in ((40, 100, 10), (40, 100, 50), (401, 1000, 10)):
        limit = Parameters(
            m=1, c=1, k=0, A0=f"-0.{'9' * nines}", B0=0, Omega=1, v1=1, v2=5, mu1="0.5", mu2="0.5", FN=2
        )  # fmt: skip
        motion = simulate(limit, t_end=t_end, digits=digits)
        yield [motion.status, *(float(event.t) for event in motion.events), len(motion.segments)]


def original() -> Iterator[Any]:
    """Yield a motion of another model, in its own coordinates and those of the oscillator."""
    motion = simulate(SHIFTED, x0=1, v0="0.5", t_end=8)
    yield told(motion)
    yield motion.as_dict()
    yield told(motion.reduced)
    scene = Scene("mine", SHIFTED, t0=1, x0=1, v0=0, t_end=9, start_error="1e-6")
    yield told(simulate(scene, t_end="1T"))


def files() -> Iterator[Any]:
    """Yield what motions look like in files and other forms."""
    motion = simulate("fig5", t_end=4)
    yield from written(motion.to_csv).splitlines()
    yield from written(motion.to_json).splitlines()
    yield [repr(motion), repr(simulate("fig9", t_end=1, max_events=2)), *map(repr, motion.segments)]
    found = motion.to_scipy()
    yield {
        name: found[name]
        for name in ("t", "y", "t_events", "y_events", "status", "message", "success")
    }
    table = simulate_many("fig9", [(0, 0, 0), (0, 1, 2)], 2, wrt=("mu1", "x0"), use_numba=False)
    yield from written(table.to_csv).splitlines()
    words = simulate_many("fig9", (0, 0, 0), 3, record="word", use_numba=False)
    yield [repr(table), repr(table[1]), len(table[0]), repr(words)]


@cache
def summary() -> Any:
    """Return a summary of motions of each family, with all of its columns."""
    rng = random.Random("summary")
    problems = []
    for family in FAMILIES.values():
        problems += [family(rng) for _ in range(3)]
    starts = [[each[name] for name in ("t0", "x0", "v0")] for _, each in problems]
    ends = [min(each["t_end"], each["t0"] + 40 / float(p.Omega)) for p, each in problems]
    sets = [p for p, _ in problems]
    return simulate_many(
        sets, starts, ends, record="summary", skip=0.5, sections=3, max_events=300, use_numba=False
    )


def summaries() -> Iterator[Any]:
    """Yield summaries: of all families, of orbits of one and more periods, of rests, and of parts of them."""
    for i in range(len(summary())):
        row = summary()[i]
        section = row.pop("section")
        yield [*row.values()]
        yield section
    yield [repr(summary()), repr(summary()[:3]), len(summary()[[0, 2]])]
    names = ("word", "multiplicity", "stuck", "mode", "status", "section")
    sets = [FIG9.replace(Omega=Omega) for Omega in ("0.5", 1, "1.5", 3, 4)]
    yield simulate_many(
        sets, (0, 0, 0), "20T", record=names, skip=4, sections=2, use_numba=False
    ).columns()
    rest = Parameters(
        m=1, c="0.1", k=1, A0=0, B0=0, Omega=1, v1=0, v2=5, mu1="0.3", mu2="0.2", FN=1
    )
    yield simulate_many(
        rest, [(0, 3, 1), (0, 0, 0), (0, "0.2", 0)], 60, record="summary", use_numba=False
    ).columns()

    still = rest.replace(v1=-2, c=3)
    names = ("status", "t", "mode", "stuck")
    yield simulate_many(
        still, [(0, still.A(2), 0), (0, 1, 0)], 60, record=names, use_numba=False
    ).columns()


def many() -> Iterator[Any]:
    """Yield tables of events, from parameters and starts in each form, with derivatives."""
    columns: dict[str, Any] = {name: float(value) for name, value in FIG9.as_dict().items()}
    columns |= {"Omega": np.linspace(2, 5, 30), "FN": 10, "c": "1/5"}
    starts = {"t0": np.linspace(-1, 1, 30), "x0": np.linspace(-3, 3, 30), "v0": 1}
    found = simulate_many(columns, starts, 4, use_numba=False)
    yield vars(found)
    table = simulate_many(
        columns, starts, "1T", wrt=("Omega", "k", "FN", "v0", "t0"), use_numba=False
    )
    yield vars(table)
    yield vars(simulate_many(columns, starts, 2, start_error="0.01", use_numba=False))
    yield vars(simulate_many(columns, starts, 2, accuracy=inf, max_events=4, use_numba=False))
    yield vars(simulate_many(FIG9, (0, 0, 0), 1, max_events=2**64, use_numba=False))
    yield vars(simulate_many(FIG9, [(0, 0.3, 25), (5, "1/3", 1)], [2, 7], use_numba=False))
    for p in random_sets(5, 6):
        yield vars(
            simulate_many(p, (0, 1, p.v1), 5, max_events=20, wrt=("m", "v1", "x0"), use_numba=False)
        )


def frames() -> Iterator[Any]:
    """Yield results as tables of pandas and xarray."""
    table = simulate_many("fig9", [(0, 0, 0), (0, 1, 2)], 2, wrt=("mu1", "x0"), use_numba=False)
    whole = simulate_many(
        "fig9", [(0, 0, 0), (0, 1, 2)], 9, record="summary", sections=3, use_numba=False
    )
    short = simulate_many("fig9", (0, 0, 0), 9, record=("word", "x"), use_numba=False)
    for each in (
        table,
        whole,
        short,
        simulate("fig5", t_end=4),
        simulate("fig5", t_end=2, digits=20),
    ):
        yield from each.to_pandas().to_csv().splitlines()
        dataset = each.to_xarray()
        yield [str(dict(dataset.sizes)), *map(str, dataset.attrs.items())]
        for name in (*dataset.data_vars, *dataset.coords):
            yield [
                str(name),
                str(dataset[name].dims),
                *map(str, dataset[name].values.ravel().tolist()),
            ]


WRONG_NUMBERS: tuple[Any, ...] = (
    [1, 2, float("nan")], np.array([1.0, inf]), np.array([1.0, 1e60, 1e70]), [1, True], [1, [2]], "one",
    np.zeros((2, 2)),
)  # fmt: skip
COLUMNS = {name: getattr(FIG9, name) for name in FIG9.as_dict()}
WRONG_SETS: tuple[Any, ...] = (
    {"m": [1, 0, 1]}, {"c": np.array([0.0, 1.0, -1.0])}, {"v1": [1, 2, 25]}, {"Omega": [1, 2], "m": [1, 2, 3]},
    {"v1": [1, 2, FIG9.v2 - Fraction(1, 10**40)], "Omega": [1, 2, 0]}, {"omega": 1},
)  # fmt: skip
WRONG_STARTS: tuple[tuple[Any, Any], ...] = (
    ({"t0": 0, "x0": 1}, 1), ({"t0": 0, "x0": [1, 2], "v0": [1, 2, 3]}, 1), ([[0, 0]], 1), ([[0, 0, 0]] * 2, [1, 2, 3]),
    ([2, 0, 0], 1), (np.zeros((3, 3)), [1, 2, 0]), (np.zeros((3, 3)), [[1, 2, 3]]), ([[0, 0, 0], [0, np.nan, 0]], 1),
)  # fmt: skip
WRONG_QUESTIONS: tuple[dict[str, Any], ...] = (
    {"record": "words"}, {"record": ("word", "colour")}, {"record": 3}, {"record": "summary", "skip": -1},
    {"record": "summary", "skip": 3}, {"record": "summary", "skip": [0, 1, 2]}, {"record": "summary", "skip": [0, 5]},
    {"record": "summary", "sections": -1}, {"skip": 1}, {"sections": 2},
)  # fmt: skip

CASES: dict[str, Callable[[], object]] = {
    "figure 5": lambda: told(simulate("fig5", t_end=12)),
    "figure 6": lambda: told(simulate("fig6", t_end=60)),
    "figure 8": lambda: told(simulate("fig8", t_end=12)),
    "figure 9": lambda: told(simulate("fig9", t_end="2T")),
    "figure 10": lambda: told(simulate("fig10")),
    "families": families,
    "touching": lambda: interpreted(touching),
    "exact": exact,
    "another model": original,
    "files": files,
    "summaries": summaries,
    "many": many,
    "frames": frames,
    "errors": lambda: errors_of(
        [
            lambda: simulate(FIG9),
            lambda: simulate("fig9", digits=20, accuracy=1e-9),
            lambda: simulate("fig9", t_end=0),
            lambda: simulate("fig9", t_end="3 T", max_events=0),
            lambda: simulate("fig9")(99),
            lambda: simulate_many(FIG9, [(0, 0, 0), (5, 0, 0)], [1, 2]),
            lambda: simulate_many(FIG9, [(0, 0, 0)] * 3, [1, 2]),
            lambda: simulate_many([FIG9, FIG9], [(0, 0, 0)] * 3, 1),
            *(
                lambda given=given: simulate_many(FIG9, [(0, 0, 0)] * 2, 3, **given)
                for given in WRONG_QUESTIONS
            ),
            lambda: simulate_many([FIG9, FIG9], [(0, 0, 0)] * 3, "1T"),
            *(lambda given=given: NumberColumn("x", given) for given in WRONG_NUMBERS),
            *(lambda given=given: Problems(COLUMNS | given, (0, 0, 0), 1) for given in WRONG_SETS),
            *(
                lambda given=given: Problems(given, (0, 0, 0), 1)
                for given in ({"m": 1}, [FIG9, "fig9"], 3)
            ),
            *(lambda given=given: Problems(FIG9, *given) for given in WRONG_STARTS),
            lambda: simulate_many(FIG9, (0, 0, 0), 1, record="summary", wrt="m"),
        ]
    ),
}
