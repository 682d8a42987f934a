"""Kinds of fault in somebody's solution.

Samples that are wrong in a known way, and what that is called.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from types import SimpleNamespace
from typing import Any

import careful_solver
import numpy as np
from fault_scenes import Case
from faulty_solver import CURVES, METHODS, Flaw, Solver, smoothed, without_events

from symosc import Parameters, simulate
from symosc.crosschecks.compare import STEP_TOLERANCE

# A solution is wrong if it is further from the exact motion than this, relative to the largest |x|
# and |v|.
WRONG = 2e-8
Rng = np.random.Generator
Causes = tuple[tuple[str, str], ...]
#: What a fault is called that is none of those with a name, and these faults.
UNKNOWN = ("unknown", "")
OTHERS = (
    "two coefficients",
    "quadratic drag",
    "friction that falls with speed",
    "linear resampling",
    "events by interpolation",
    "stick left early",
    "weights beyond one",
)


@dataclass(frozen=True)
class Spoilt:
    """A wrong solution, and what it may be called.

    Pairs of cause and subject, where the subject "" is any.
    """

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    causes: Causes
    events: list[tuple[float, str]] | None = None
    always: bool = False  # it is a fault even where the samples are exact
    twin: bool = False  # another fault makes the same samples


#: Make a wrong solution of a scene at times of a sampling; None if it cannot be.
Maker = Callable[[Case, np.ndarray, str, Rng], Spoilt | None]


def finer(t: np.ndarray, n: int) -> np.ndarray:
    """Return times with every step cut into n."""
    parts = np.linspace(0.0, 1.0, n, endpoint=False)
    return np.append((t[:-1, None] + np.diff(t)[:, None] * parts).ravel(), t[-1])


def either(rng: Rng, low: float, high: float) -> float:
    """Return a number between two, of either sign."""
    return float(rng.choice([-1, 1])) * rng.uniform(low, high)


def other(
    case: Case, t: np.ndarray, p: Parameters, ahead: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return x, v of a motion of other parameters, its clock ahead of the scene's."""
    x0, v0 = case.start
    motion = simulate(p, t0=float(t[0]) + ahead, x0=x0, v0=v0, t_end=float(t[-1]) + ahead + 1e-9)
    x, v = motion(np.minimum(t + ahead, float(motion.t_end)))
    return x, v


def are_alike(columns: np.ndarray, others: np.ndarray) -> bool:
    """Return whether two programs make the same samples within the tolerance of a check."""
    if columns.shape != others.shape:
        return False
    off = np.max(np.abs(columns - others), axis=1)
    return bool(np.all(off <= STEP_TOLERANCE * np.max(np.abs(columns), axis=1)))


# -- other parameters --------------------------------------------------------------------------------------------------


def near(
    p: Parameters, rng: Rng, names: tuple[str, ...], low: float, high: float
) -> dict[str, float]:
    """Return one of some parameters, off by a part of itself."""
    name = str(rng.choice(names))
    return {name: float(f"{float(getattr(p, name)) * (1.0 + either(rng, low, high)):.6g}")}


def belt_speed(p: Parameters, rng: Rng) -> dict[str, float]:
    name = str(rng.choice(["v1", "v2"]))
    return {
        name: float(f"{float(getattr(p, name)) + float(p.v2 - p.v1) * either(rng, 0.01, 0.1):.6g}")
    }


def factor_of_two(p: Parameters, rng: Rng) -> dict[str, Any]:
    name = str(rng.choice(["FN", "k", "B0", "A0", "m"]))
    return {name: getattr(p, name) * int(rng.choice([2, 3])) / 2}


#: What changes, and what it may be called besides a coefficient or a sign.
SYSTEMS: dict[str, tuple[Callable[[Parameters, Rng], dict[str, Any]], Causes]] = {
    "coefficient": (lambda p, rng: near(p, rng, ("m", "c", "k", "A0", "B0", "FN"), 0.01, 0.1), ()),
    "drive frequency": (lambda p, rng: near(p, rng, ("Omega",), 0.002, 0.03), ()),
    "belt friction": (lambda p, rng: near(p, rng, ("mu1", "mu2"), 0.02, 0.2), ()),
    "belt speed": (belt_speed, ()),
    "sign of A0": (lambda p, rng: {"A0": -p.A0}, ()),
    "swapped belts": (lambda p, rng: {"mu1": p.mu2, "mu2": p.mu1}, (("swapped belts", ""),)),
    "far frequency": (
        lambda p, rng: {"Omega": float(p.Omega) * float(rng.choice([2 * pi, 0.5 / pi, pi / 180, 180 / pi]))}, ()
    ),
    "mass divided twice": (lambda p, rng: {"m": p.m**2}, ()),
    # Where one belt alone acts, or the motion keeps to one side of it, it is that belt's friction,
    # or a force.
    "no friction": (lambda p, rng: {"FN": 0}, (("coefficient", "mu1"), ("coefficient", "mu2"))),
    "half damping": (lambda p, rng: {"c": p.c / 2}, ()),
    "factor of two": (factor_of_two, ()),
    "sign of B0": (lambda p, rng: {"B0": -p.B0}, (("phase", ""), ("time shift", ""))),
}  # fmt: skip


def of_system(kind: str) -> Maker:
    """Return what makes the motion of other parameters."""
    change, more = SYSTEMS[kind]

    def make(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt | None:
        p = case.scene.parameters
        values = change(case.scene.parameters, rng)
        there = p.replace(**values)
        if len(values) > 1:
            names = ()
        else:
            names = tuple((cause, name) for name in values for cause in ("coefficient", "sign"))
        if there == p:
            return None
        samples = other(case, t, there)
        if kind == "belt speed":
            # A belt that the motion does not reach any more, and one that a solver goes over.
            ignoring = Solver(p, Flaw(ignored=int(next(iter(values))[1])))
            run = np.array(ignoring.run(finer(t, 4), *case.start).arrays())[:, ::4]
            if are_alike(run, np.array([t, *samples])):
                return Spoilt(t, *samples, (*names, *more, ("late events", "")), twin=True)
        return Spoilt(t, *samples, (*names, *more))

    return make


class PushingSpring:
    """Parameters with -k, which are no system."""

    def __init__(self, p: Parameters) -> None:
        self.p, self.k = p, -p.k

    def __getattr__(self, name: str) -> Any:
        return getattr(self.p, name)


def sign_of_k(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt | None:
    """Only as long as the motion stays near: it is thrown out."""
    p = case.scene.parameters
    t = t[t <= float(t[0]) + 4.0 / max(float(p.k / p.m) ** 0.5, 0.1)]
    if not p.k or len(t) < 12:
        return None
    scene = SimpleNamespace(
        parameters=PushingSpring(p), t0=t[0], x0=case.scene.x0, v0=case.scene.v0
    )
    run = careful_solver.solve(scene, float(t[-1]), joined=True, **careful_solver.TIGHT)  # type: ignore[arg-type]
    return Spoilt(*(np.array(column) for column in (run.t, run.x, run.v)), (("sign", "k"),))


def time_shift(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    shift = rng.uniform(0.002, 0.05) * 2.0 * pi / float(case.scene.parameters.Omega)
    if rng.random() < 0.5:  # the clock is fast
        return Spoilt(t + shift, *case.exact(t), (("time shift", ""),))
    t = t[t <= case.t_end - shift]
    return Spoilt(t, *case.exact(np.maximum(t + shift, case.span[0])), (("time shift", ""),))


def phase(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    p = case.scene.parameters
    ahead = float(rng.choice([-pi / 2, rng.uniform(-2.5, 2.5)]))
    return Spoilt(t, *other(case, t, p, ahead / float(p.Omega)), (("phase", ""),))


# -- other columns -----------------------------------------------------------------------------------------------------

Columns = tuple[np.ndarray, np.ndarray, np.ndarray]


def half_late(case: Case, t: np.ndarray, x: np.ndarray, v: np.ndarray, rng: Rng) -> Columns:
    return t[1:], x[1:], case.exact(0.5 * (t[1:] + t[:-1]))[1]


def other_times(case: Case, t: np.ndarray, x: np.ndarray, v: np.ndarray, rng: Rng) -> Columns:
    Omega = float(case.scene.parameters.Omega)
    return (
        t
        * float(
            rng.choice(
                [1000.0, Omega if Omega != 1 else 1000.0, Omega / (2 * pi), 180 / pi * Omega]
            )
        ),
        x,
        v,
    )


def frozen(case: Case, t: np.ndarray, x: np.ndarray, v: np.ndarray, rng: Rng) -> Columns:
    for part in case.exact.segments:
        if part.mode.startswith("belt"):
            held = np.flatnonzero((t > float(part.t_start)) & (t < float(part.t_end)))
            x[held[1:]] = x[held[:1]]
    return t, x, v


def resampled(case: Case, t: np.ndarray, x: np.ndarray, v: np.ndarray, rng: Rng) -> Columns:
    if rng.random() < 0.5:
        fine = finer(t, 4)
    else:
        fine = np.linspace(t[0], t[-1], 5 * len(t))
    return fine, np.interp(fine, t, x), np.interp(fine, t, v)


def noise(case: Case, t: np.ndarray, x: np.ndarray, v: np.ndarray, rng: Rng) -> Columns:
    size = 10.0 ** rng.uniform(-5, -2)
    x, v = (each + size * np.max(np.abs(each)) * rng.standard_normal(len(t)) for each in (x, v))
    return t, x, v


def few_digits(case: Case, t: np.ndarray, x: np.ndarray, v: np.ndarray, rng: Rng) -> Columns:
    bits = int(rng.integers(8, 17))
    places = int(rng.integers(2, 9))
    cut = [
        lambda a: (
            np.rint(a / np.max(np.abs(a)) * 2**bits) * (np.max(np.abs(a)) / 2**bits)
        ),  # of a converter
        lambda a: np.float32(a).astype(float),
        lambda a: np.round(a, places),
    ][rng.integers(3)]
    return t, cut(x), cut(v)


def times_factor(t: np.ndarray, x: np.ndarray, v: np.ndarray, rng: Rng, which: str) -> Columns:
    factor = float(rng.choice([1000.0, 100.0, 0.01, 0.001]))
    return t, x * factor if "x" in which else x, v * factor if "v" in which else v


#: What may be done with the columns of the exact motion (case, t, x, v, rng), and what that is
#: called.
COLUMNS: dict[str, tuple[tuple[Callable[..., Columns], tuple[str, str]], ...]] = {
    "sign of x or v": (
        (lambda case, t, x, v, rng: (t, -x, v), ("sign", "x")),
        (lambda case, t, x, v, rng: (t, x, -v), ("sign", "v")),
    ),
    "no motion": (
        (lambda case, t, x, v, rng: (t, 0 * x + case.start[0], 0 * v), ("columns", "x and v")),
    ),
    "v a sample late": ((lambda case, t, x, v, rng: (t[1:], x[1:], v[:-1]), ("columns", "v")),),
    "v half a sample late": ((half_late, ("columns", "v")),),
    "v by differences": (
        (lambda case, t, x, v, rng: (t, x, np.gradient(x, t)), ("columns", "v")),
        (lambda case, t, x, v, rng: (t[1:], x[1:], np.diff(x) / np.diff(t)), ("columns", "v")),
    ),
    "times in single precision": (
        (lambda case, t, x, v, rng: (np.float64(np.float32(t)), x, v), ("columns", "t")),
    ),
    "times in other units": ((other_times, ("columns", "t")),),
    "x or v in other units": tuple(
        (
            lambda case, t, x, v, rng, which=which: times_factor(t, x, v, rng, which),
            ("columns", which),
        )
        for which in ("x", "v", "x and v")
    ),
    "x and v swapped": ((lambda case, t, x, v, rng: (t, v, x), ("columns", "x and v")),),
    "x frozen in sticks": ((frozen, ("columns", "x")),),
    "linear resampling": ((resampled, UNKNOWN),),
    "noise": ((noise, ("noise", "")),),
    "few digits": ((few_digits, ("precision", "")),),
}
#: Faults even where the samples are exact.
ALWAYS = ("times in other units", "few digits")


def of_columns(kind: str) -> Maker:
    """Return what changes the columns of the exact motion."""

    def make(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
        change, cause = COLUMNS[kind][rng.integers(len(COLUMNS[kind]))]
        return Spoilt(*change(case, t, *case.exact(t), rng), (cause,), always=kind in ALWAYS)

    return make


def listed_events(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    begin, end = case.span
    events = [(float(event.t), event.kind) for event in case.exact.events if event.kind != "graze"]
    if events and rng.random() < 0.5:
        del events[int(rng.integers(len(events)))]
        cause = "missing events"
    else:
        time = rng.uniform(begin + 0.02 * (end - begin), end - 0.02 * (end - begin))
        events = sorted([*events, (time, str(rng.choice(["cross", "stick"])))])
        cause = "invented events"
    return Spoilt(t, *case.exact(t), ((cause, ""),), events=events, always=True)


# -- solvers with a flaw -----------------------------------------------------------------------------------------------


def turned_friction(p: Parameters, rng: Rng) -> Flaw:
    return Flaw(force=tuple(float((2 * p.A0 - p.A(alpha)) / p.m) for alpha in (1, 2, 3)))  # type: ignore[arg-type]


def drift(p: Parameters, rng: Rng) -> Flaw:
    return Flaw(
        drift=float(p.v2 - p.v1)
        * float(p.Omega)
        * float(rng.choice([-1, 1]))
        * 10.0 ** rng.uniform(-5.0, -3.0)
    )


def method(*names: str) -> Callable[[Parameters, Rng], Flaw]:
    return lambda p, rng: Flaw(method=str(rng.choice(names)))


#: The flaw, its cause, steps of the solver from sample to sample (coarse ones, others), and whether
#: its own are shown.
SOLVERS: dict[
    str, tuple[Callable[[Parameters, Rng], Flaw], str, str, int, tuple[int, ...], bool]
] = {
    "sign of friction": (turned_friction, "sign", "friction", 4, (4,), False),
    "late events": (lambda p, rng: Flaw(late=True), "late events", "", 4, (1, 2), False),
    "double root": (lambda p, rng: Flaw(), "late events", "", 1, (1,), True),
    "belt ignored": (
        lambda p, rng: Flaw(ignored=int(rng.integers(1, 3))),
        "late events",
        "",
        4,
        (1, 2),
        False,
    ),
    "stick left early": (
        lambda p, rng: Flaw(early=rng.uniform(0.03, 0.3)),
        "unknown",
        "",
        40,
        (8,),
        True,
    ),
    "stick left late": (
        lambda p, rng: Flaw(static=rng.uniform(1.03, 1.3)),
        "late events",
        "",
        40,
        (8,),
        True,
    ),
    "drift on the belt": (drift, "drift", "", 40, (8,), False),
    "fixed step": (method("euler", "heun", "rk4"), "steps too large", "", 20, (1, 2, 4), True),
    "leapfrog": (method("leapfrog", "verlet"), "steps too large", "", 20, (1, 2), True),
    "wrong weights": (method("rk4 1111", "rk4 2112"), "steps too large", "", 2, (1, 2), True),
    "weights beyond one": (method("rk4 1221/5"), "unknown", "", 2, (1, 2), True),
    "events by interpolation": (lambda p, rng: Flaw(linear=True), "unknown", "", 1, (1,), False),
}


#: What explains all steps of such a solution too: a belt with a speed that the motion never reaches.
SAME: dict[str, Causes] = {"belt ignored": (("sign", ""), ("coefficient", ""))}


def of_solver(kind: str) -> Maker:
    """Return what makes of a scene what a solver with a flaw does, its grid finer than the samples."""
    flaw, cause, subject, coarse, others, shown = SOLVERS[kind]

    def make(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
        p = case.scene.parameters
        joints = shown and sampling == "own steps"
        if kind == "double root" and sampling != "coarse":
            t = t[:: int(rng.choice([3, 5, 8]))]
        if joints:
            n = 1
        elif sampling == "coarse":
            n = coarse
        else:
            n = int(rng.choice(others))
        if joints:
            kept = slice(None)
        else:
            kept = slice(None, None, n)
        flawed = flaw(p, rng)
        run, plain = (
            Solver(p, each, joints).run(finer(t, n), *case.start) for each in (flawed, Flaw())
        )
        twins: Causes = ()
        if kind == "stick left early":
            late = Flaw(early=-flawed.early)
            other_run = Solver(p, late, joints).run(finer(t, n), *case.start)
            if are_alike(np.array(other_run.arrays()), np.array(run.arrays())):
                twins = (("late events", "stick"),)
        # Where the flaw makes no difference, contacts between the points of the grid are missed,
        # and nothing else.
        if np.array_equal(plain.x, run.x):
            name = ("late events", "")
        else:
            name = (cause, subject)
        causes = (name, *SAME.get(kind, ()), *twins)
        return Spoilt(*(column[kept] for column in run.arrays()), causes, twin=bool(twins))

    return make


def smoothed_friction(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    p = case.scene.parameters
    width = float(p.v2 - p.v1) * 10.0 ** rng.uniform(-3.0, -1.0)
    t, x, v = smoothed(p, t, *case.start, width, str(rng.choice(list(CURVES))))
    return Spoilt(t, x, v, (("smoothed friction", ""),))


def chatter(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    if sampling == "coarse":
        n = 40
    else:
        n = 4
    x, v = without_events(case.scene.parameters, finer(t, n), *case.start)[1:]
    # Without a stick there is nothing to chatter about: then events are late by parts of a step.
    return Spoilt(
        t, x[::n], v[::n], (("chatter", ""), ("late events", ""), ("steps too large", ""))
    )


def no_events(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    """A fixed step over the events, with the friction at the beginning of each step or of each stage."""
    if sampling == "coarse":
        n = 10
    else:
        n = int(rng.choice([1, 3]))
    name = str(rng.choice(["euler", "heun", "rk4", "leapfrog"]))
    x, v = without_events(
        case.scene.parameters, finer(t, n), *case.start, METHODS[name], rng.random() < 0.5
    )[1:]
    return Spoilt(
        t, x[::n], v[::n], (("late events", ""), ("chatter", ""), ("steps too large", ""))
    )


def loose_tolerance(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    rtol = 10.0 ** rng.uniform(-6, -3)
    options = {
        "method": str(rng.choice(["RK45", "RK23"])),
        "rtol": rtol,
        "atol": 0.1 * rtol,
        "max_step": 0.2,
    }
    run = careful_solver.solve(case.scene, case.t_end, joined=True, **options)
    return Spoilt(
        *(np.array(column) for column in (run.t, run.x, run.v)), (("steps too large", ""),)
    )


def clock_jumps(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    """From some sample on the clock is fast or slow by a part of a step."""
    x, v = case.exact(t)
    k = int(rng.integers(len(t) // 5, 4 * len(t) // 5))
    return Spoilt(t + np.where(np.arange(len(t)) >= k, either(rng, 0.1, 0.6) * (t[k] - t[k - 1]), 0.0), x, v,
                  (("time shift", ""),))  # fmt: skip


def stick_held(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt | None:
    """One stick is held 5 % too long, with v on the belt, and the motion goes on from there."""
    p = case.scene.parameters
    sticks = [
        part
        for part in case.exact.segments
        if part.mode.startswith("belt") and part.t_end < case.t_end
    ]
    sticks = [part for part in sticks if part.t_end > part.t_start]
    if not sticks:
        return None
    stick = sticks[int(rng.integers(len(sticks)))]
    begin = float(stick.t_start)
    slip = float(stick.t_end)
    end = slip + 0.05 * (slip - begin)
    speed = float(p.belt(int(stick.mode[-1])))
    x_slip = float(case.exact(slip)[0])
    x, v = case.exact(t)
    held = (t > slip) & (t <= end)
    after = t > end
    x[held], v[held] = x_slip + speed * (t[held] - slip), speed
    if np.any(after):
        motion = simulate(
            p, t0=end, x0=x_slip + speed * (end - slip), v0=speed, t_end=float(t[-1]) + 1e-9
        )
        x[after], v[after] = motion(t[after])
    return Spoilt(t, x, v, (("late events", ""),))


def two_coefficients(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
    p = case.scene.parameters
    values = near(p, rng, ("k", "m"), 0.01, 0.1) | near(p, rng, ("B0", "FN"), 0.01, 0.1)
    return Spoilt(t, *other(case, t, p.replace(**values)), (UNKNOWN,))


def other_law(law: Callable[[Parameters, float], float]) -> Maker:
    """Return what integrates a scene with one more acceleration, as a function of v."""

    def make(case: Case, t: np.ndarray, sampling: str, rng: Rng) -> Spoilt:
        p = case.scene.parameters
        t, x, v = smoothed(
            p, t, *case.start, 1e-7 * float(p.v2 - p.v1), "tanh", lambda v: law(p, v)
        )
        return Spoilt(t, x, v, (UNKNOWN,))

    return make


def drag(p: Parameters, v: float) -> float:
    return -0.02 * float(p.Omega) * v * abs(v) / max(abs(float(p.v1)), abs(float(p.v2)))


def stribeck(p: Parameters, v: float) -> float:
    """Static friction of both belts that falls off within a tenth of their distance."""
    width = 0.1 * float(p.v2 - p.v1)
    signs = ((float(mu) * np.sign(v - float(w)) * np.exp(-abs(v - float(w)) / width))
             for mu, w in ((p.mu1, p.v1), (p.mu2, p.v2)))  # fmt: skip
    return -0.3 * float(p.FN / p.m) * float(sum(signs))


KINDS: dict[str, Maker] = {
    "clock jumps": clock_jumps,
    "one stick held too long": stick_held,
    "two coefficients": two_coefficients,
    "quadratic drag": other_law(drag),
    "friction that falls with speed": other_law(stribeck),
    **{kind: of_system(kind) for kind in SYSTEMS},
    **{kind: of_columns(kind) for kind in COLUMNS},
    **{kind: of_solver(kind) for kind in SOLVERS},
    "sign of k": sign_of_k,
    "time shift": time_shift,
    "phase of the drive": phase,
    "list of events": listed_events,
    "smoothed friction": smoothed_friction,
    "chatter": chatter,
    "no events located": no_events,
    "loose tolerance": loose_tolerance,
}


def spoil(kind: str, case: Case, sampling: str, seed: int) -> Spoilt | None:
    """Return a wrong solution; None if it is not wrong within the samples, or cannot be."""
    rng = np.random.default_rng([seed, *map(ord, f"{kind}/{case.scene.name}/{sampling}")])
    found = KINDS[kind](case, case.times(sampling, rng), sampling, rng)
    if (
        found is None
        or not np.all(np.isfinite([found.x, found.v]))
        or np.max(np.abs([found.x, found.v])) > 1e6
    ):
        return None
    if found.always:
        return found
    inside = (found.t >= case.span[0]) & (found.t <= case.span[1])
    right = case.exact(found.t[inside])
    scales = np.max(np.abs(right), axis=1, keepdims=True)
    off = np.abs(right - [found.x[inside], found.v[inside]]) / np.where(scales > 0.0, scales, 1.0)
    if np.max(off) > WRONG:
        return found
    return None
