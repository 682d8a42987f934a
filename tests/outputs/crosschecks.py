"""Checks of solutions: right, wrong and rounded ones, lists of events, texts and objects.

What is said of faults.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cache, partial
from itertools import pairwise
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import careful_solver
import numpy as np
from faulty_solver import METHODS, Flaw, softened, solved, without_events
from said import empty_folder, outcome
from stored_outputs import PLACE, sampled

from symosc import Parameters, crosscheck, load_scene, simulate
from symosc.base.errors import ParameterError
from symosc.crosschecks import columns, friction, methods, models, steps
from symosc.crosschecks.causes import FaultySteps
from symosc.crosschecks.reading.solutions import read_solutions
from symosc.engine.arithmetic import Arithmetic
from symosc.kernels._generated import acceleration

Columns = tuple[np.ndarray, np.ndarray, np.ndarray]


# -- what is shown of a check ------------------------------------------------------------------------------------------


#: Steps are interpreted, however many checks there were before.
interpreted = patch.object(steps.FEW_STEPS, "events", 50_000)


def check_of(*given: Any, anywhere: bool = True, **options: Any) -> Any:
    """Return the check of a solution, which may begin and end anywhere."""
    return crosscheck(*given, own_start=anywhere, partial=anywhere, **options)


@interpreted
def judged(name: Any, t: Any, x: Any = None, v: Any = None, **options: Any) -> str:
    """Return all that a check says, the causes only if `why`.

    Of a solution that may begin and end anywhere.
    """
    anywhere = not options.pop("whole", False)
    why = options.pop("why", False)
    check = check_of(name, t, x, v, anywhere=anywhere, **options)
    if not why:
        vars(check)["diagnosis"] = ()
    said = re.sub(PLACE, r"\1", check.summary())
    lines = said.splitlines()
    plain = check.as_dict()
    for part in ("matched", "missed", "invented", "unresolved", "decisions"):
        rows = [" ".join(map(brief, row.values())) for row in plain[part]]
        lines.append(f"{part}: {'; '.join(rows[:9])} {len(rows)}")
    lines += [f"fault: {' '.join(map(brief, vars(fault).values()))}" for fault in check.faults[:4]]
    lines += [
        f"first: {fault.step} {fault.reason}"
        for fault in (check.first_wrong, check.first_switching)
        if fault
    ]
    for part in ("errors", "limits", "defects", "allowed", "wrong_steps", "wrong_spans"):
        lines.append(f"{part}: {sampled(getattr(check, part))}")
    lines.append(f"modes: {''.join(map(str, check.modes[:160]))}")
    lines.append(
        f"{check.scales} {check.compared_until} {check.tolerance} {check.global_tolerance} {check.own_start}"
    )
    if check.coarser is not None:
        vars(check.coarser)["diagnosis"] = ()
        lines += check.coarser.summary().splitlines()
    return "\n".join(lines)


def brief(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.9g}"
    return str(value)


@interpreted
def diagnosed(name: Any, *columns: Any) -> str:
    """Return what is said of a wrong solution in words."""
    check = check_of(name, *columns)
    found = [one for first in check.diagnosis for one in (first, *first.alternatives)]
    rows = [(o.cause, o.subject, o.words, o.evidence, o.value, o.error, o.share) for o in found]
    return "\n".join(" | ".join(map(brief, row)) for row in rows)


# -- solutions ---------------------------------------------------------------------------------------------------------


@cache
def exact(name: str = "fig10", t_end: float = 10.0, count: int = 161) -> Columns:
    """Return samples of the exact motion of a scene."""
    t = np.linspace(float(load_scene(name).t0), t_end, count)
    return t, *simulate(name, t_end=t_end)(t)


def spoilt(
    change: Callable[..., Any], name: str = "fig10", t_end: float = 6.0, count: int = 81
) -> Any:
    """Return a scene's name and its samples after a change of copies of t, x, v."""
    columns = [column.copy() for column in exact(name, t_end, count)]
    return name, *(change(*columns) or columns)


def moved(row: int, by: float, first: int = 50, last: int | None = None) -> Callable[..., None]:
    """Return what adds a number to some samples of the column number `row`."""

    def change(*columns: np.ndarray) -> None:
        columns[row][first:last] += by

    return change


def other(name: str = "fig10", t_end: float = 6.0, count: int = 81, **changes: Any) -> Any:
    """Return samples of the motion with other parameters."""
    scene = load_scene(name)
    p = scene.parameters
    t = np.linspace(float(scene.t0), t_end, count)
    changes = {
        each: value(getattr(p, each)) if callable(value) else value
        for each, value in changes.items()
    }
    motion = simulate(p.replace(**changes), t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=t_end)
    return name, t, *motion(t)


def unlocated(
    method: str, held: bool = False, name: str = "fig10", t_end: float = 10.0, every: int = 3
) -> Any:
    scene = load_scene(name)
    grid = np.linspace(float(scene.t0), t_end, 160 * every + 1)
    start = float(scene.x0), float(scene.v0)
    run = without_events(scene.parameters, grid, *start, METHODS[method], held)
    return name, *(column[::every] for column in run)


def noisy(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    noise = np.random.RandomState(3).standard_normal((2, len(t)))
    return t, x + 1e-3 * noise[0], v + 1e-3 * noise[1]


#: Wrong solutions by name: what makes a scene and columns t, x, v.
WRONG: dict[str, Callable[[], Any]] = {
    "other B0": lambda: other("fig5", 12, 101, B0=10.3),
    "Omega in degrees": lambda: other(Omega=lambda Om: float(Om) * np.pi / 180),
    "other k, far": lambda: other(k=lambda k: k * 20),
    "other v1": lambda: other("fig5", 12, v1=1.1),
    "other v2": lambda: other(v2=lambda v: v * 1.03),
    "no friction": lambda: other(FN=0),
    "swapped belts": lambda: other(
        mu1=load_scene("fig10").parameters.mu2, mu2=load_scene("fig10").parameters.mu1
    ),
    "m not divided": lambda: other("fig9", 8, A0=0, B0=9),
    "-x, -v": lambda: spoilt(lambda t, x, v: (t, -x, -v)),
    "x and v in km": lambda: spoilt(lambda t, x, v: (t, x / 1000, v / 1000)),
    "v late": lambda: spoilt(lambda t, x, v: (t[1:], x[1:], v[:-1])),
    "v half early": lambda: spoilt(half_early, "fig9", 6),
    "v by gradient": lambda: spoilt(lambda t, x, v: (t, x, np.gradient(x, t)), "fig9", 6),
    "v by differences": lambda: spoilt(
        lambda t, x, v: (t[1:], x[1:], np.diff(x) / np.diff(t)), "fig9", 6
    ),
    "no motion": lambda: spoilt(lambda t, x, v: (t, 0 * x + 1, 0 * v)),
    "x stands in sticks": lambda: spoilt(stands),
    "x stands and goes on": lambda: spoilt(stands_and_goes_on),
    "other FN in few steps": lambda: other("fig5", 12, 19, FN=10),
    "forces of another law": lambda: solved(Flaw(force=(130.0, 25.0, -28.0)), every=1),
    "weights of nobody": lambda: solved(Flaw(method="rk4 1221/5"), "fig9", 6, every=1),
    "x first": lambda: stepped(lambda x, v, a, h: (x + h * v, v + h * a(x + h * v, v))),
    "lines between others": lambda: spoilt(on_lines),
    "times rounded": lambda: spoilt(lambda t, x, v: (np.round(t, 4), x, v), "fig9", 6, 118),
    "times in single precision": lambda: spoilt(
        lambda t, x, v: (np.float64(np.float32(t**1.01)), *again(t**1.01))
    ),
    "clock fast": lambda: spoilt(lambda t, x, v: (t + 0.03, x, v), "fig9", 6),
    "sine for cosine": lambda: sine("fig9", 6),
    "outlier": lambda: spoilt(moved(1, 0.01, 40, 41)),
    "two outliers": lambda: spoilt(lambda t, x, v: (t, x + 0.01 * (np.arange(81) % 30 == 10), v)),
    "noise": lambda: spoilt(noisy),
    "sign of friction": lambda: solved(turned("fig10")),
    "late events": lambda: solved(Flaw(late=True), every=2),
    "early sticks": lambda: solved(Flaw(early=0.25)),
    "static friction": lambda: solved(Flaw(static=1.3)),
    "static friction, ends shown": lambda: solved(
        Flaw(static=1.1), every=1, count=301, joints=True
    ),
    "drift": lambda: solved(Flaw(drift=-2e-3)),
    "drift in steps": lambda: solved(Flaw(drift=-2e-3), "fig5", 12, 21, 40),
    "Euler": lambda: solved(Flaw(method="euler"), "fig9", 6),
    "Heun": lambda: solved(Flaw(method="heun"), "fig5", 12),
    "wrong weights": lambda: solved(Flaw(method="rk4 2112"), "fig9", 6, every=1),
    "linear events": lambda: solved(Flaw(linear=True), every=1),
    "double root": lambda: solved(Flaw(), "fig8", 5, 61, 1, joints=True),
    "chatter": lambda: unlocated("rk4"),
    "exact with held friction": lambda: unlocated("rk4", True, every=6),
    "tanh": lambda: softened("tanh", 0.01),
    "arctan in sticks": lambda: softened("arctan", 0.05),
    "loose tolerance": lambda: loose(),
    "root": lambda: softened("root", 0.02, "fig9", 6),
}


def again(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x, v = simulate("fig10", t_end=float(t[-1]) + 1)(np.maximum(t, float(load_scene("fig10").t0)))
    return x, v


def half_early(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    return t[:-1], x[:-1], simulate("fig9", t_end=6)((t[1:] + t[:-1]) / 2)[1]


def stands(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    held = np.append(False, (np.diff(v) == 0.0) & np.isin(v[1:], (0.5, *map(float, exact_belts()))))
    return t, x[np.maximum.accumulate(np.where(held, 0, np.arange(len(t))))], v


def stands_and_goes_on(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    """Return samples of a solver that goes on from where x stood in a stick."""
    return (
        t,
        x
        - np.cumsum(
            np.append(
                0.0, np.where(np.isin(v[1:], list(map(float, exact_belts()))), np.diff(x), 0.0)
            )
        ),
        v,
    )


def stepped(step: Callable[..., tuple[float, float]]) -> Any:
    """Return samples of fig9 by a method with a fixed step, with the force of the domain below belt 1."""
    K = Arithmetic(load_scene("fig9").parameters).K
    rows = [(4.0, -30.0)]
    t = np.linspace(0.1324, 0.5, 41)
    for time, after in pairwise(t.tolist()):

        def a(x: float, v: float, time: float = time) -> float:
            return float(acceleration(x, v, np.cos(K.Om * time), K.A1, K.cm, K.w0sq, K.f0))

        rows.append(step(*rows[-1], a, after - time))
    return load_scene("fig9").parameters, t, *np.array(rows).T


def exact_belts(name: str = "fig10") -> tuple[Any, Any]:
    p = load_scene(name).parameters
    return p.v1, p.v2


def on_lines(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    return t, np.interp(t, t[::5], x[::5]), np.interp(t, t[::5], v[::5])


def sine(name: str, t_end: float) -> Any:
    scene = load_scene(name)
    t = exact(name, t_end)[0]
    back = np.pi / 2 / float(scene.parameters.Omega)
    motion = simulate(
        scene.parameters, t0=float(t[0]) - back, x0=scene.x0, v0=scene.v0, t_end=t_end
    )
    return name, t, *motion(t - back)


def loose() -> Any:
    run = careful_solver.solve(
        load_scene("fig9"), 6, joined=True, method="RK45", rtol=1e-4, atol=1e-5, max_step=0.2
    )
    return "fig9", run.t, run.x, run.v


def turned(name: str) -> Flaw:
    p = load_scene(name).parameters
    return Flaw(force=tuple(float((2 * p.A0 - p.A(alpha)) / p.m) for alpha in (1, 2, 3)))  # type: ignore[arg-type]


#: Those whose diagnosis is quick.
SAID = (
    "Omega in degrees", "no friction", "m not divided", "-x, -v", "x and v in km", "v late", "v by gradient",
    "no motion", "outlier", "two outliers", "lines between others", "sine for cosine",
)  # fmt: skip


# -- what each cause explains of some wrong solutions ------------------------------------------------------------------

CHEAP: tuple[Callable[..., Any], ...] = (
    columns.outliers,
    columns.noise,
    columns.even_times,
    columns.single_times,
    columns.velocity_column,
    columns.frozen_positions,
    methods.late_events,
    methods.gone_over,
    methods.large_steps,
    friction.drift,
)
#: Wrong solutions, and the expensive causes that are asked about each, beside the cheap ones.
ASKED: dict[str, tuple[Callable[..., Any], ...]] = {
    "other B0": (models.phases_of_drive, models.coefficients, models.other_systems),
    "other v1": (models.coefficients,),
    "other v2": (models.coefficients,),
    "other k, far": (models.far_coefficients,),
    "noise": (),
    "sign of friction": (models.other_systems,),
    "late events": (columns.other_columns,),
    "early sticks": (),
    "static friction": (),
    "static friction, ends shown": (),
    "drift": (),
    "drift in steps": (),
    "Heun": (),
    "wrong weights": (),
    "linear events": (),
    "double root": (columns.other_columns,),
    "chatter": (),
    "exact with held friction": (),
    "tanh": (friction.smoothed,),
    "arctan in sticks": (friction.smoothed,),
    "root": (friction.smoothed,),
    "loose tolerance": (),
    "x stands in sticks": (),
    "x stands and goes on": (),
    "lines between others": (),
    "times rounded": (),
    "times in single precision": (),
    "v half early": (),
    "v by differences": (),
    "outlier": (),
    "clock fast": (models.phases_of_drive, models.jumps_of_clock),
    "swapped belts": (models.other_systems,),
    "other FN in few steps": (models.coefficients, models.phases_of_drive),
    "forces of another law": (),
    "Euler": (),
    "weights of nobody": (),
    "x first": (),
}


@interpreted
def explained(name: str) -> str:
    """Return what each cause explains of the wrong steps of a solution, also where others explain more."""
    check = check_of(*WRONG[name]())
    case = FaultySteps(check, int(check.wrong_steps[0]))
    with np.errstate(all="ignore"):
        asked = (*ASKED[name], *(() if name in ("other v1", "other v2") else CHEAP))
        found = [each for alternatives in asked for each in alternatives(case)]
    rows = []
    for candidate in found:
        o = candidate.diagnosis
        share = o.share
        if candidate.left is not None:
            share = case.share(candidate.left)
        numbers = f"{brief(o.value)} {brief(o.error)} {share:.6f}"
        rows.append(f"{o.cause} {o.subject}: {o.words}; {o.evidence}; {candidate.words} {numbers}")
    return "\n".join(rows)


def changed_columns() -> str:
    """Return all changes of columns that are tried, and what they make of some samples."""
    lines = []
    for name, few in (("fig10", slice(60, 63)), ("fig5", slice(2, 5))):
        t, x, v = (column[few] for column in exact(name))
        for each in columns.changed_columns(load_scene(name).parameters, t, x, v):
            made = " ".join(f"{value:.9g}" for column in each.columns(t, x, v) for value in column)  # type: ignore[misc]
            lines.append(f"{each.diagnosis.words} {each.words} {each.diagnosis.value}: {made}")
    return "\n".join(lines)


def mistaken_systems() -> str:
    """Return all mistakes in parameters that are tried."""
    rows = models._systems(load_scene("fig9").parameters)
    return "\n".join(
        f"{cause} {words} {change} {numbers}" for cause, _, words, change, numbers in rows
    )


# -- lists of events, roundings, starts and ends -----------------------------------------------------------------------


def listed(
    change: Callable[[list[tuple[float, str]]], Any],
    name: str = "fig5",
    t_end: float = 12.0,
    **more: Any,
) -> str:
    """Return what is said of right samples with a list of events after a change of this list."""
    events = [(float(event.t), event.kind) for event in simulate(name, t_end=t_end).events]
    return judged(name, *exact(name, t_end, 121), events=change(events) or events, why=True, **more)


def rounded(
    way: Callable[[np.ndarray], np.ndarray], name: str = "fig5", count: int = 121, **options: Any
) -> Any:
    """Return what is said of samples, right ones or of other parameters, whose x and v are rounded in some way."""
    scene = load_scene(name)
    changes = options.pop("changes", {})
    if changes:
        t, x, v = other(name, 8.0, count, **changes)[1:]
    else:
        t, x, v = exact(name, 8.0, count)
    cut = options.pop("cut", lambda t: t)
    return judged(scene, cut(t), way(x), way(v), **options)


def decimals(n: int) -> Callable[[np.ndarray], np.ndarray]:
    return lambda values: np.round(values, n)


def significant(n: int) -> Callable[[np.ndarray], np.ndarray]:
    return lambda values: np.array([float(f"{value:.{n}g}") for value in values])


def single(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32).astype(float)


def converted(values: np.ndarray) -> np.ndarray:
    return np.rint(values * 300.0) / 300.0


def result(**more: Any) -> SimpleNamespace:
    """Return what a solver returns: its own steps, and times of events."""
    t, x, v = exact("fig5", 8.0, 101)
    return SimpleNamespace(t=t, y=np.array([x, v]), **{"success": True, "message": "done", **more})


def solver_events(*times: float, off: float = 0.0) -> Any:
    """Return a solver's result with lists of times.

    Of the events, and of others, some of them away from the belts.
    """
    exactly = np.array([float(event.t) for event in simulate("fig5", t_end=8.0).events])
    states = [[[0.0, 1.0]] * len(exactly), [[0.0, 1.0 + (time > 7)] for time in times]]
    return result(t_events=[exactly + off, np.array(times)], y_events=states)


def positions(name: str, count: int, places: int | None = None, t_end: float = 6.0) -> Any:
    """Return what is said of positions without velocities."""
    t, x, _ = exact(name, t_end, count)
    return judged(name, t, x if places is None else np.round(x, places))


def ended() -> Any:
    """Return what is said of samples that go on after the exact motion has come to rest."""
    p = Parameters(m=1, c=4, k=3, A0=0, B0=0, Omega=1, v1=0, v2=50, mu1="0.2", mu2="0.1", FN=1)
    motion = simulate(p, t0=0, x0=2, v0=-1, t_end=30)
    t = np.linspace(0, 30, 121)
    x, v = motion(np.minimum(t, float(motion.t_end)))
    return judged(p, t, x + 0.01 * (t > 29), v)


def several() -> Any:
    """Return what is said of several solutions, as text and as columns."""
    t, x, v = exact("fig5", 8.0, 101)
    table = {"id": ["a"] * 101 + ["b"] * 101 + ["c"] * 101, "t": [*t, *t, *t]}
    table |= {"x": [*x, *x, *(x + (t > 5))], "v": [*v, *-v, *v]}
    checks = crosscheck("fig5", table, partial=True)
    for check in checks:
        vars(check)["diagnosis"] = ()
    tiny = crosscheck(
        "fig5",
        [{"t": t[:4], "x": x[:4], "v": v[:4] + i * (t[:4] > 0.1)} for i in range(23)],
        partial=True,
    )
    found = {
        "text": checks.summary().splitlines(),
        "repr": [repr(checks), repr(checks[0]), repr(tiny)],
    }
    return found | {
        "columns": checks.columns(),
        "more": tiny.summary().splitlines()[-4:],
        "plain": checks.as_dict()["ok"],
    }


def texts(*sources: str, columns: Any = None, suffix: str = "csv") -> str:
    """Return what is read from texts, or said of those that hold no solution."""
    with empty_folder() as folder:
        path = folder / f"run.{suffix}"
        lines = []
        for source in sources:
            path.write_text(source.replace("|", "\n"), encoding="utf-8")
            lines.append(read(path, columns).replace(str(path), "FILE"))
    return "\n".join(lines)


def read(source: Any, columns: Any = None) -> str:
    """Return what is read from a file or an object, or why there is no solution."""
    found = outcome(lambda: read_solutions(source, columns, load_scene("fig5")), ParameterError)
    if isinstance(found, str):
        return found
    shown = [
        (each.t[:4], each.x[:4], each.v[:4], len(each.t), each.events, each.notes) for each in found
    ]
    return "; ".join(
        f"{each.name}: {' '.join(map(str, row))}" for each, row in zip(found, shown, strict=True)
    )


def objects() -> Iterator[Any]:
    """Yield objects that are solutions, and others that are not."""
    t = [0.0, 1.0, 2.0]
    x = [1.0, 2.0, 4.0]
    v = [3.0, 5.0, 7.0]
    rows = list(zip(t, x, v, strict=True))
    yield from (
        {"t": t, "x": x, "v": v},
        {"Time": t, "Position": x, "vel": v},
        rows,
        np.array(rows),
        np.array(rows)[:, :2],
    )
    yield from (
        [{"t": a, "x": b, "v": c} for a, b, c in rows],
        {"t": t, "x": x, "v": v, "events": [(1, "cross")]},
    )
    yield {"t": t * 2, "x": x + v, "v": v + x, "id": [1, 1, 1, 2, 2, 2]}
    yield {"t": t * 2, "x": x + v, "v": v + x, "id": [1, 1, 1, 2, 2, 2], "events": [(1, "cross")]}
    yield {"t": [*t, 0.5], "x": [*x, 1], "v": [*v, 1], "run": ["b", "a", "a", "b"]}
    yield {"t": t, "x": np.array([x, v]), "v": np.array([v, x])}
    yield {"t": t, "x": np.array([x, v]).T, "v": np.array([v, x]).T}
    yield {"t": np.array([t, t]), "x": np.array([x, v]), "v": np.array([v, x])}
    yield {"t": np.array([t]), "x": np.array([x]), "v": np.array([v])}
    yield {"t": t, "x": np.array([x, v]), "v": v}
    yield {"t": np.array([t, t, t]), "x": np.array([x, v]), "v": np.array([v, x])}
    yield from (
        {"t": t, "y": np.array([x, v])},
        {"t": t, "y": np.array([x, v]).T},
        {"ts": t, "ys": {"x": x, "v": v}},
    )
    yield {"t": np.array(t)[:, None], "y": np.array([x, v]).T}
    yield from (
        {"t": t, "y": np.array([x, v, x])},
        {"t": [*t, np.inf], "y": np.array([[*x, 0], [*v, 0]])},
    )
    yield from (
        {"t": np.array([t, t]), "y": np.array([[x, v], [v, x]])},
        {"time": t, "state": np.array([x, v])},
    )
    yield from (
        [{"t": t, "x": x, "v": v}, {"t": [2.0, 3.0], "x": [4.0, 5.0], "v": [7.0, 8.0]}],
        [rows, rows],
    )
    yield [{"t": t, "x": x, "v": v}, {"t": [2.0, 3.0], "x": [4.0, 5.0]}]
    yield np.rec.fromarrays([t, x, v], names="time,pos,speed")
    yield from (dense, lambda t: (t, 2 * t), lambda t: t[0], lambda t: 1 / 0, lambda t: (1, 2, 3))
    yield from (
        5,
        "nothing.csv",
        [],
        [1, 2],
        [rows, 3],
        [[1, 2, 3], [1, 2]],
        {},
        {"t": t},
        {"t": t, "x": x, "w": v},
        np.ones(3),
    )
    yield from (
        np.ones((3, 4)),
        {"t": t, "x": x[:2]},
        {"t": t, "x": x, "v": [1, "a", 2]},
        {"t": t, "x": x, "v": [True, 1, 2]},
    )
    yield from (
        {"t": t[::-1], "x": x, "v": v},
        {"t": [1, 1], "x": [1, 2], "v": [1, 2]},
        {"t": t, "x": x, "v": [1, 2e50, 1]},
    )
    yield from (
        {"t": t, "x": x, "v": [1, 1j, 2]},
        {"t": t, "x": np.ma.masked_greater(x, 3)},
        {"t": t, "x": np.ones((3, 3, 3))},
    )
    yield from (
        result(t_events=[[1.0], None]),
        result(t_events=[[1.0]], y_events=[[]]),
        result(t_events=[["a"]]),
    )
    yield from (
        result(t_events=[[0.5, 0.5 + 1e-12, 0.7]]),
        SimpleNamespace(t=t, y=np.ones((3, 3))),
        SimpleNamespace(t=t),
    )


TEXTS = """\
t,x,v|0,1,2|1,2,3
t;x;v|0,5;1;2|1,5;2;3d-1
0 1 2|1 2 3
# a comment|% t x v|0 1 2|1 2 3
t,x|0,1|1,2
id,"t",x,v|a,0,1,2|b,0,3,4|a,1,1,2|b,2,3,4
Time (s),a,b|0,1,2|1,2,3
time,a,b,x|0,1,2,9|1,2,3,9
t,x,v|0,1,2|1,2
t,x,v|0,1,two|1,2,3
t,x,v
t,x,x|1,2,3|2,3,4
1,2|2,3
1|2
t,x,v|1,2,3|0,1,2
t,x,v|1,2,3|1,2,3
t,pos,position,v|1,2,3,4|2,3,4,5
sep=;|t;x;v|0;1;2|1;2;3
t,x,v|0,1,1_0|1,2,3
t,x,v|0,nan,2|1,2,3
t,x,w|0,1,2|1,2,3
9 0 5 1|9 1 6 2
1.5D-03 1.D0 2d+1|1.5 2 3
t,x,v|0,1,2||1,2
a,b,c|0,1,2
t,x,1|0,1,2|1,2,3
t x v|0 1 2|// why|1 2 3
t	x	v|0	1,5	2|1	2	3
 |
""".splitlines()
JSON = """\
{"t": [0, 1], "x": [1, 2], "v": [2, 3], "events": [[0.5, "cross"]], "note": "text"}
[{"t": 0, "x": 1, "v": 2}, {"t": 1, "x": 2, "v": 3}]
[[0, 1, 2], [1, 2, 3]]
{"t": [0, 1], "y": [[1, 2], [3, 4]]}
[{"t": [0, 1], "x": [1, 2], "v": [2, 3]}, {"t": [2, 3], "x": [1, 2], "v": [2, 3]}]
5
[1, 2]
[{"t": 0}, [1, 2]]
{"t": [0, 1], "x": [1, 2], "x": [2, 3]}
{"t": [0, 1], "a": [1, 2], "a": [2, 3]}
{"t": [0, 1], "x": [1, [2]], "v": [2, 3]}
{"t": [0, 1], "x": [1, 2], "v": [2, 3], "events": [[0.5, "jump"]]}
{"t": [0, 1], "x": [1, 2], "v": [2, 3], "events": 5}
""".splitlines()
#: What Octave saves as text: a matrix, ranges, a scalar, strings, a cell, other kinds.
OCTAVE = (
    "# Created by Octave|# name: t|# type: range|# base, limit, increment|0 1 0.5|# name: x|# type: matrix|# rows: 3|"
    "# columns: 1| 1| 2| 3|# name: v|# type: matrix|# rows: 1|# columns: 3| 4 5 6|",
    "# Created by Octave|# name: sol|# type: scalar struct|# name: t|# type: matrix|# ndims: 2| 1 2|1|2|"
    "# name: x|# type: double_range|# base, limit, increment|3 1 -2|# name: note|# type: string|# elements: 1|"
    "# length: 4|text|",
    "# Created by Octave|# name: c|# type: cell|# rows: 1|# columns: 2|# name: <cell-element>|# type: scalar|5|"
    "# name: <cell-element>|# type: bool|1|# name: z|# type: complex matrix|# rows: 1|# columns: 1| (1,2)|",
    "# Created by Octave|# name: a|# type: matrix|# rows: 2|# columns: 3| 0 1 2| 1 2 3|",
    "# Created by Octave|# name: t|# type: matrix|# rows: x|",
)
#: Checks of all kinds of solution.
CHECKS: dict[str, Callable[[], object]] = {
    "right, one belt": lambda: judged("fig5", *exact("fig5", 40.0, 201), whole=True),
    "right, both belts, few samples": lambda: judged("fig10", *exact("fig10", 10.0, 41)),
    "right, a long way off": lambda: judged(
        "fig9", *exact("fig9", 8.0, 12), tolerance=1e-6, global_tolerance=1e-3
    ),
    "of parameters": lambda: judged(load_scene("fig9").parameters, *exact("fig9", 8.0, 101)),
    "a jump": lambda: judged(*spoilt(moved(2, 0.05))),
    "an outlier on a belt": lambda: judged(*spoilt(moved(2, -0.3, 30, 31), "fig5", 12)),
    "an outlier across a belt": lambda: judged(
        *spoilt(lambda t, x, v: v.__setitem__(12, 0.9), "fig9", 8)
    ),
    "a sample far off": lambda: judged(*spoilt(moved(1, 0.01, 30, 31), "fig9", 8, 201)),
    "a step too far": lambda: judged(*too_far()),
    "a drift off a belt": lambda: judged(*spoilt(drifting, "fig5", 12)),
    "on a belt too long": lambda: judged(*too_long()),
    "a force of another domain": lambda: judged(*other_force()),
    "a missed stick": lambda: judged(
        "fig8", *exact("fig8", 5.0, 41)[:2], exact("fig8", 5.0, 41)[2] * (1 + 1e-7)
    ),
    "wrong friction": lambda: judged(*other("fig5", 12, 121, mu1=0.85)),
    "late events": lambda: judged(*WRONG["late events"]()),
    "early sticks": lambda: judged(*WRONG["early sticks"]()),
    "drift": lambda: judged(*WRONG["drift"](), tolerance=1e-4),
    "chatter": lambda: judged(
        *(each if isinstance(each, str) else each[:90] for each in WRONG["chatter"]())
    ),
    "an outlier and why": lambda: judged(*spoilt(moved(1, 0.01, 40, 41)), why=True),
    "few digits and why": lambda: rounded(decimals(5), why=True),
    "two samples": lambda: judged("fig5", [0, 1], [0, 0.5], [0, 1]),
    "wrong by far": lambda: judged("fig5", [0.0, 1.0, 2.0, 3.0], [0, 1e40, 0, 0], [0, 1, 1, 2]),
    "list: right": lambda: listed(lambda events: None),
    "list: one missing": lambda: listed(lambda events: events[:2] + events[3:]),
    "list: last missing": lambda: listed(lambda events: events[:-1], "fig10", 10),
    "list: one invented": lambda: listed(lambda events: sorted([*events, (8.0, "cross")])),
    "list: one late": lambda: listed(
        lambda events: [(t + 0.02 * (i == 1), kind) for i, (t, kind) in enumerate(events)]
    ),
    "list: out of order": lambda: listed(lambda events: events[::-1]),
    "list: another kind": lambda: listed(
        lambda events: [(t, "graze") for t, _ in events[:1]] + events[1:]
    ),
    "list: empty": lambda: listed(lambda events: [(50.0, "cross")], "fig9", 6),
    "list: with a start on a belt": lambda: listed(
        lambda events: [(0.0, "stick"), *events], "fig6", 12
    ),
    "list: with contacts at a graze": lambda: listed(
        lambda events: [
            (t + h, k) for t, _ in events for h, k in ((-1e-6, "stick"), (1e-6, "slip"))
        ],
        "fig8-exact",
        4,
    ),
    "list: without a short stick": lambda: listed(
        lambda events: events[2:] or [(3.2, "graze")], "fig8", 5
    ),
    "list: a short stick by the tolerance": lambda: listed(
        lambda events: events[2:], "fig8", 9, tolerance=1e-3
    ),
    "list: a short stick as crossings": lambda: listed(
        lambda events: [(t, "cross") for t, _ in events[:2]] + events[2:], "fig8", 9, tolerance=1e-4
    ),
    "list: half of a short stick": lambda: listed(
        lambda events: events[1:], "fig8", 9, tolerance=1e-3
    ),
    "list: rounded": lambda: listed(
        lambda events: [(round(t, 3), kind) for t, kind in events], "fig10", 10
    ),
    "3 decimals": lambda: rounded(decimals(3)),
    "6 decimals, both belts": lambda: rounded(decimals(6), "fig10"),
    "tens of thousandths": lambda: rounded(decimals(4), "fig9", 301, changes={"A0": -2.001}),
    "wrong, 3 decimals": lambda: rounded(decimals(3), "fig9", 801, changes={"A0": -2.1}),
    "4 significant digits": lambda: rounded(significant(4)),
    "4 significant digits, no 0": lambda: rounded(significant(4), "fig9"),
    "single precision": lambda: rounded(single, "fig9", cut=single),
    "a converter": lambda: rounded(converted),
    "cut off": lambda: rounded(lambda values: np.trunc(values * 1000) / 1000, "fig9"),
    "rounded down": lambda: rounded(lambda values: np.floor(values * 1000) / 1000, "fig9"),
    "times too": lambda: rounded(decimals(4), "fig9", cut=decimals(3)),
    "multiples of 10": lambda: judged(
        "fig9", [0.1324, 1, 2, 3, 4], [0, 20, 30, -40, 10], [10, 70, 30, 20, 50]
    ),
    "another start": lambda: judged(
        "fig9", *other("fig9", 6, 61)[1:2], *exact_from("fig9", 1.5), whole=True
    ),
    "a start on the motion, an early end": lambda: judged(
        "fig5", *(a[20:] for a in exact("fig5", 12, 121)), whole=True
    ),
    "an end before the motion": lambda: judged("fig5", *exact("fig5", 39.0, 131), whole=True),
    "a motion that rests": lambda: ended(),
    "positions": lambda: positions("fig10", 161),
    "positions, 5 decimals": lambda: positions("fig9", 161, 5),
    "positions at rounded times": lambda: judged(
        "fig9", *(np.round(a, 4) for a in exact("fig9", 6.0, 161)[:2])
    ),
    "positions, few": lambda: positions("fig5", 31),
    "positions without a scene": lambda: judged(
        load_scene("fig5").parameters, *exact("fig5", 6, 121)[:2]
    ),
    "a function": lambda: judged(
        "fig9", np.linspace(0.1324, 3, 50), lambda t: simulate("fig9", t_end=3)(t)
    ),
    "a trajectory": lambda: judged("fig9", simulate("fig9", t_end=2)),
    "a solver's events": lambda: judged("fig5", solver_events()),
    "a solver's late events": lambda: judged("fig5", solver_events(2.5, 7.5, 7.6, off=1e-3)),
    "a solver that failed": lambda: judged(
        "fig5", result(success=False, message="no\nmore", sol=dense)
    ),
    "pieces": lambda: judged("fig5", [{"t": t, "x": x, "v": v} for t, x, v in pieces()]),
    "several": several,
    "texts": lambda: texts(*TEXTS),
    "texts of JSON": lambda: texts(*JSON, suffix="json"),
    "texts of Octave": lambda: texts(*OCTAVE, suffix="txt"),
    "objects": lambda: "\n".join(re.sub(r" at 0x\w+", "", read(each)) for each in objects()),
    "texts without v": lambda: texts(*TEXTS[:4], columns={"v": None}),
    "texts by number": lambda: texts(
        TEXTS[-8], TEXTS[-4], TEXTS[2], columns={"t": "2", "x": "1", "v": "3"}
    ),
    "texts with other names": lambda: texts(
        *TEXTS[:2], *TEXTS[6:8], columns={"t": "time", "x": "a", "v": "b"}
    ),
}


def drifting(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    return t, x, np.where((t > 4.8) & (t < 5.75), v + 1e-6 * (t - 4.8), v)


def too_far() -> Any:
    """Return samples that go on by the exact motion after one step that leads elsewhere."""
    t, x, v = (column.copy() for column in exact("fig9", 8.0, 101))
    after = simulate(
        load_scene("fig9").parameters, t0=float(t[30]), x0=x[30] + 1e-4, v0=v[30], t_end=8
    )
    x[30:], v[30:] = after(t[30:])
    return "fig9", t, x, v


def too_long() -> Any:
    """Return samples that keep to a belt for a while where the exact motion has left it."""
    t, x, v = (column.copy() for column in exact("fig5", 6.0, 121))
    slip = simulate("fig5", t_end=6).events[1]
    late = (t > slip.t) & (t < slip.t + 0.5)
    x[late], v[late] = slip.x + slip.v * (t[late] - slip.t), slip.v
    return "fig5", t, x, v


def other_force() -> Any:
    """Return samples of fig9 whose flights below belt 1 have the force above it."""
    K = Arithmetic(load_scene("fig9").parameters).K
    return solved(Flaw(force=(K.A2, K.A2, K.A3)), "fig9", 4, 61)


def exact_from(name: str, x0: float) -> Any:
    scene = load_scene(name)
    motion = simulate(scene.parameters, t0=scene.t0, x0=x0, v0=scene.v0, t_end=6)
    x, v = motion(np.linspace(float(scene.t0), 6, 61))
    return x, v


def dense(t: np.ndarray) -> np.ndarray:
    return simulate("fig5", t_end=8.0)(t) + 1e-3 * np.sin(t)


def pieces() -> Iterator[Columns]:
    t, x, v = exact("fig5", 8.0, 101)
    for part in (slice(0, 41), slice(40, 81), slice(80, 101)):
        yield t[part], x[part], v[part] * (1 + 1e-6 * (part.start == 80))


CASES: dict[str, Callable[[], object]] = {
    **CHECKS,
    "changed columns": changed_columns,
    "mistaken systems": mistaken_systems,
    **{f"said of: {name}": partial(lambda name: diagnosed(*WRONG[name]()), name) for name in SAID},
    **{f"causes of: {name}": partial(explained, name) for name in ASKED},
}
