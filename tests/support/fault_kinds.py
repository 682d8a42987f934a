"""Forty-three kinds of fault in somebody's solution: samples that are wrong in a known way, and what that is called."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi
from types import SimpleNamespace
from typing import Any

import careful_solver
import numpy as np
from fault_scenes import Case
from faulty_solver import CURVES, METHODS, Flaw, Solver, smoothed, without_events

from symosc import Parameters, simulate

# A solution is wrong if it is further from the exact motion than this, relative to the largest |x| and |v|.
WRONG = 2e-8


@dataclass(frozen=True)
class Spoilt:
    """A wrong solution.

    Attributes
    ----------
    t, x, v : arrays
    causes : tuple of pairs
        What it may be called: (cause, subject); subject "" is any.
    value : float or None
        What the number of the diagnosis should be.
    events : list of pairs or None
    always : bool
        It is a fault even where the samples are exact.
    """

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    causes: tuple[tuple[str, str], ...]
    value: float | None = None
    events: list[tuple[float, str]] | None = None
    always: bool = False


Maker = Callable[[Case, str, np.random.Generator], Spoilt | None]


def finer(t: np.ndarray, n: int) -> np.ndarray:
    """Return times with every step cut into n."""
    parts = np.linspace(0.0, 1.0, n, endpoint=False)
    return np.append((t[:-1, None] + np.diff(t)[:, None] * parts).ravel(), t[-1])


def other(case: Case, t: np.ndarray, p: Parameters, ahead: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return x, v of a motion of other parameters, its clock ahead of the scene's."""
    x0, v0 = case.start
    motion = simulate(p, t0=float(t[0]) + ahead, x0=x0, v0=v0, t_end=float(t[-1]) + ahead + 1e-9)
    x, v = motion(np.minimum(t + ahead, float(motion.t_end)))
    return x, v


def exact(case: Case, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return x, v of the exact motion."""
    x, v = case.exact(t)
    return x, v


def changed(case: Case, sampling: str, rng: np.random.Generator, name: str, low: float, high: float) -> Spoilt | None:
    """Return the motion with one parameter changed by a part of itself."""
    p, t = case.scene.parameters, case.times(sampling, rng)
    factor = 1.0 + float(rng.choice([-1, 1])) * rng.uniform(low, high)
    value = float(f"{float(getattr(p, name)) * factor:.6g}")
    if value == float(getattr(p, name)):
        return None
    return Spoilt(t, *other(case, t, p.replace(**{name: value})), (("coefficient", name),), value)


def coefficient(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    return changed(case, sampling, rng, str(rng.choice(["m", "c", "k", "A0", "B0", "FN"])), 0.01, 0.1)


def drive_frequency(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    return changed(case, sampling, rng, "Omega", 0.002, 0.03)


def belt_friction(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    return changed(case, sampling, rng, str(rng.choice(["mu1", "mu2"])), 0.02, 0.2)


def belt_speed(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    p, t, name = case.scene.parameters, case.times(sampling, rng), str(rng.choice(["v1", "v2"]))
    shift = float(p.v2 - p.v1) * float(rng.choice([-1, 1])) * rng.uniform(0.01, 0.1)
    value = float(f"{float(getattr(p, name)) + shift:.6g}")
    return Spoilt(t, *other(case, t, p.replace(**{name: value})), (("coefficient", name),), value)


def sign_of_a_column(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    x, v = case.exact(t)
    return Spoilt(t, -x, v, (("sign", "x"),)) if rng.random() < 0.5 else Spoilt(t, x, -v, (("sign", "v"),))


def sign_of_a0(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    p, t = case.scene.parameters, case.times(sampling, rng)
    return Spoilt(t, *other(case, t, p.replace(A0=-p.A0)), (("sign", "A0"),))


def swapped_belts(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    p, t = case.scene.parameters, case.times(sampling, rng)
    return Spoilt(t, *other(case, t, p.replace(mu1=p.mu2, mu2=p.mu1)), (("swapped belts", ""),))


def sign_of_friction(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    p, t = case.scene.parameters, case.times(sampling, rng)
    force = tuple(float((2 * p.A0 - p.A(alpha)) / p.m) for alpha in (1, 2, 3))
    return flawed(case, t, 4, Flaw(force=force), False, (("sign", "friction"),))  # type: ignore[arg-type]


def time_shift(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    shift = rng.uniform(0.002, 0.05) * 2.0 * pi / float(case.scene.parameters.Omega)
    if rng.random() < 0.5:  # the clock is fast
        return Spoilt(t + shift, *exact(case, t), (("time shift", ""),), shift)
    begin = float(case.exact.t_start)
    t = t[t <= case.t_end - shift]
    return Spoilt(t, *exact(case, np.maximum(t + shift, begin)), (("time shift", ""),), -shift)


def phase(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t, Omega = case.times(sampling, rng), float(case.scene.parameters.Omega)
    ahead = float(rng.choice([-pi / 2, rng.uniform(-2.5, 2.5)]))
    x, v = other(case, t, case.scene.parameters, ahead / Omega)
    return Spoilt(t, x, v, (("phase", ""),), ahead)


def smoothed_friction(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    p, t = case.scene.parameters, case.times(sampling, rng)
    width = float(p.v2 - p.v1) * 10.0 ** rng.uniform(-3.0, -1.0)
    t, x, v = smoothed(p, t, *case.start, width, str(rng.choice(list(CURVES))))
    return Spoilt(t, x, v, (("smoothed friction", ""),), width)


def chatter(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t, n = case.times(sampling, rng), {"coarse": 40}.get(sampling, 4)
    x, v = without_events(case.scene.parameters, finer(t, n), *case.start)[1:]
    # Without a stick there is nothing to chatter about: then events are late by parts of a step.
    return Spoilt(t, x[::n], v[::n], (("chatter", ""), ("late events", "")))


def flawed(
    case: Case, t: np.ndarray, n: int, flaw: Flaw, joints: bool, causes: tuple[tuple[str, str], ...], **more: Any
) -> Spoilt:
    """Return what a solver with a flaw makes of a scene, its grid n times as fine as the samples."""
    grid, kept = finer(t, n), slice(None) if joints else slice(None, None, n)
    run, plain = (Solver(case.scene.parameters, each, joints).run(grid, *case.start) for each in (flaw, Flaw()))
    times, x, v = run.arrays()
    # Where the flaw makes no difference, contacts between the points of the grid are missed, and nothing else.
    if np.array_equal(plain.x, run.x):
        causes = (("double root", ""),)
    return Spoilt(times[kept], x[kept], v[kept], causes, **more)


def late_events(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    n = {"coarse": 4}.get(sampling, int(rng.choice([1, 2])))
    return flawed(case, case.times(sampling, rng), n, Flaw(late=True), False, (("late events", ""),))


def double_root(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    t = t if sampling == "coarse" else t[:: int(rng.choice([3, 5, 8]))]
    return flawed(case, t, 1, Flaw(), sampling == "own steps", (("double root", ""),))


def left_early(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    flaw, joints = Flaw(early=rng.uniform(0.03, 0.3)), sampling == "own steps"
    n = 1 if joints else {"coarse": 40}.get(sampling, 8)
    return flawed(case, case.times(sampling, rng), n, flaw, joints, (("stick left early", ""),))


def left_late(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    flaw, joints = Flaw(static=1.0 + rng.uniform(0.03, 0.3)), sampling == "own steps"
    n = 1 if joints else {"coarse": 40}.get(sampling, 8)
    return flawed(case, case.times(sampling, rng), n, flaw, joints, (("stick left late", ""),), value=flaw.static)


def drift(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    p, n = case.scene.parameters, {"coarse": 40}.get(sampling, 8)
    rate = float(p.v2 - p.v1) * float(p.Omega) * float(rng.choice([-1, 1])) * 10.0 ** rng.uniform(-5.0, -3.0)
    return flawed(case, case.times(sampling, rng), n, Flaw(drift=rate), False, (("drift", ""),), value=rate)


def fixed_step(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    method, joints = str(rng.choice(["euler", "heun", "rk4"])), sampling == "own steps"
    n = 1 if joints else {"coarse": 20}.get(sampling, int(rng.choice([1, 2, 4])))
    return flawed(case, case.times(sampling, rng), n, Flaw(method=method), joints, (("truncation", ""),))


def precision(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    x, v = (column.copy() for column in case.exact(t))
    how = rng.integers(3)
    if how == 0:  # an analogue-digital converter
        bits = int(rng.integers(8, 17))
        x, v = (np.rint(a / q) * q for a in (x, v) for q in [float(np.max(np.abs(a))) / 2**bits])
    elif how == 1:
        x, v = np.float32(x).astype(float), np.float32(v).astype(float)
    else:
        places = int(rng.integers(2, 9))
        x, v = np.round(x, places), np.round(v, places)
    return Spoilt(t, x, v, (("precision", ""),), always=True)


def listed_events(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    begin, end = case.span
    events = [(float(event.t), event.kind) for event in case.exact.events if event.kind != "graze"]
    if events and rng.random() < 0.5:
        del events[int(rng.integers(len(events)))]
        cause = "missing events"
    else:
        time = rng.uniform(begin + 0.02 * (end - begin), end - 0.02 * (end - begin))
        events = sorted([*events, (time, str(rng.choice(["cross", "stick"])))])
        cause = "invented events"
    return Spoilt(t, *exact(case, t), ((cause, ""),), events=events, always=True)


def replaced(case: Case, sampling: str, rng: np.random.Generator, **values: Any) -> Spoilt | None:
    """Return the motion of a system that is far from the scene's: with one coefficient (or sign) of another size."""
    p, t = case.scene.parameters, case.times(sampling, rng)
    ((name, value),) = values.items()
    there = p.replace(**values)
    if there == p:
        return None
    return Spoilt(t, *other(case, t, there), (("coefficient", name), ("sign", name)), float(value))


def far_frequency(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    factor = float(rng.choice([2 * pi, 1 / (2 * pi), pi / 180, 180 / pi]))
    return replaced(case, sampling, rng, Omega=float(case.scene.parameters.Omega) * factor)


def mass_twice(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    return replaced(case, sampling, rng, m=case.scene.parameters.m**2)


def no_friction(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    found = replaced(case, sampling, rng, FN=0)
    # Where one belt alone acts, or the motion keeps to one side of it, it is that belt's friction, or a force.
    return found and replace(found, causes=(*found.causes, ("coefficient", "mu1"), ("coefficient", "mu2")), value=None)


def half_damping(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    return replaced(case, sampling, rng, c=case.scene.parameters.c / 2)


def factor_of_two(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    name = str(rng.choice(["FN", "k", "B0", "A0", "m"]))
    return replaced(case, sampling, rng, **{name: getattr(case.scene.parameters, name) * int(rng.choice([2, 3])) / 2})


def sign_of_b0(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    found = replaced(case, sampling, rng, B0=-case.scene.parameters.B0)
    return found and replace(found, causes=(("sign", "B0"), ("phase", ""), ("time shift", "")), value=None)


class PushingSpring:
    """Parameters with -k, which are no system."""

    def __init__(self, p: Parameters) -> None:
        self.p, self.k = p, -p.k

    def __getattr__(self, name: str) -> Any:
        return getattr(self.p, name)


def sign_of_k(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    """Only as long as the motion stays near: it is thrown out."""
    p = case.scene.parameters
    t = case.times(sampling, rng)
    end = float(t[0]) + 4.0 / max(float(p.k / p.m) ** 0.5, 0.1)
    t = t[t <= end]
    if not p.k or len(t) < 12:
        return None
    scene = SimpleNamespace(parameters=PushingSpring(p), t0=t[0], x0=case.scene.x0, v0=case.scene.v0)
    run = careful_solver.solve(scene, float(t[-1]), joined=True, **careful_solver.TIGHT)  # type: ignore[arg-type]
    return Spoilt(*(np.array(column) for column in (run.t, run.x, run.v)), (("sign", "k"),))


def never_moves(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    return Spoilt(t, np.full(len(t), case.start[0]), np.zeros(len(t)), (("columns", "x and v"),))


def late_velocity(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    x, v = exact(case, t)
    return Spoilt(t[1:], x[1:], v[:-1], (("columns", "v"),))


def half_late_velocity(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    middle = 0.5 * (t[1:] + t[:-1])
    return Spoilt(t[1:], exact(case, t[1:])[0], exact(case, middle)[1], (("columns", "v"),))


def velocity_by_differences(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    x = exact(case, t)[0]
    if rng.random() < 0.5:
        return Spoilt(t, x, np.gradient(x, t), (("columns", "v"),))
    return Spoilt(t[1:], x[1:], np.diff(x) / np.diff(t), (("columns", "v"),))


def single_times(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    return Spoilt(t.astype(np.float32).astype(float), *exact(case, t), (("columns", "t"),), always=False)


def other_times(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t, Omega = case.times(sampling, rng), float(case.scene.parameters.Omega)
    factor = float(rng.choice([1000.0, Omega if Omega != 1 else 1000.0, Omega / (2 * pi), 180 / pi * Omega]))
    return Spoilt(t * factor, *exact(case, t), (("columns", "t"),), factor, always=True)


def other_units(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t, factor = case.times(sampling, rng), float(rng.choice([1000.0, 100.0, 0.01, 0.001]))
    x, v = exact(case, t)
    how = str(rng.choice(["x", "v", "x and v"]))
    return Spoilt(t, x * factor if "x" in how else x, v * factor if "v" in how else v, (("columns", how),), factor)


def swapped_columns(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    return Spoilt(t, *exact(case, t)[::-1], (("columns", "x and v"),))


def frozen_sticks(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt | None:
    t = case.times(sampling, rng)
    x, v = (column.copy() for column in exact(case, t))
    for part in case.exact.segments:
        if part.mode.startswith("belt"):
            held = np.flatnonzero((t > float(part.t_start)) & (t < float(part.t_end)))
            x[held[1:]] = x[held[:1]]
    return Spoilt(t, x, v, (("columns", "x"),))


def resampled(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    few = case.times(sampling, rng)
    x, v = exact(case, few)
    t = finer(few, 4) if rng.random() < 0.5 else np.linspace(few[0], few[-1], 5 * len(few))
    return Spoilt(t, np.interp(t, few, x), np.interp(t, few, v), (("resampling", ""),))


def noise(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    x, v = exact(case, t)
    size = 10.0 ** rng.uniform(-5, -2)
    x, v = (column + size * np.max(np.abs(column)) * rng.standard_normal(len(t)) for column in (x, v))
    return Spoilt(t, x, v, (("noise", ""),))


def leapfrog(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    joints = sampling == "own steps"
    n = 1 if joints else {"coarse": 20}.get(sampling, int(rng.choice([1, 2])))
    flaw = Flaw(method=str(rng.choice(["leapfrog", "verlet"])))
    return flawed(case, case.times(sampling, rng), n, flaw, joints, (("truncation", ""),))


def wrong_weights(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    joints = sampling == "own steps"
    n = 1 if joints or rng.random() < 0.5 else 2
    flaw = Flaw(method=str(rng.choice(["rk4 1111", "rk4 2112", "rk4 1221/5"])))
    return flawed(case, case.times(sampling, rng), n, flaw, joints, (("truncation", ""),))


def interpolated_events(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    t = case.times(sampling, rng)
    return flawed(case, t, 1, Flaw(linear=True), False, (("event interpolation", ""),))


def no_events(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    """A fixed step over the events, with the friction at the beginning of each step or of each stage."""
    n = {"coarse": 10}.get(sampling, int(rng.choice([1, 3])))
    t, method = case.times(sampling, rng), str(rng.choice(["euler", "heun", "rk4", "leapfrog"]))
    x, v = without_events(case.scene.parameters, finer(t, n), *case.start, METHODS[method], rng.random() < 0.5)[1:]
    return Spoilt(t, x[::n], v[::n], (("late events", ""), ("chatter", ""), ("truncation", "")))


def loose_tolerance(case: Case, sampling: str, rng: np.random.Generator) -> Spoilt:
    rtol = 10.0 ** rng.uniform(-6, -3)
    options = {"method": str(rng.choice(["RK45", "RK23"])), "rtol": rtol, "atol": 0.1 * rtol, "max_step": 0.2}
    run = careful_solver.solve(case.scene, case.t_end, joined=True, **options)
    return Spoilt(*(np.array(column) for column in (run.t, run.x, run.v)), (("truncation", ""),))


KINDS: dict[str, Maker] = {
    "coefficient": coefficient,
    "drive frequency": drive_frequency,
    "belt friction": belt_friction,
    "belt speed": belt_speed,
    "sign of x or v": sign_of_a_column,
    "sign of A0": sign_of_a0,
    "sign of friction": sign_of_friction,
    "swapped belts": swapped_belts,
    "time shift": time_shift,
    "phase of the drive": phase,
    "smoothed friction": smoothed_friction,
    "chatter": chatter,
    "late events": late_events,
    "double root": double_root,
    "stick left early": left_early,
    "stick left late": left_late,
    "drift on the belt": drift,
    "fixed step": fixed_step,
    "precision": precision,
    "list of events": listed_events,
    "far frequency": far_frequency,
    "mass divided twice": mass_twice,
    "no friction": no_friction,
    "half damping": half_damping,
    "factor of two": factor_of_two,
    "sign of B0": sign_of_b0,
    "sign of k": sign_of_k,
    "no motion": never_moves,
    "v a sample late": late_velocity,
    "v half a sample late": half_late_velocity,
    "v by differences": velocity_by_differences,
    "times in single precision": single_times,
    "times in other units": other_times,
    "x or v in other units": other_units,
    "x and v swapped": swapped_columns,
    "x frozen in sticks": frozen_sticks,
    "linear resampling": resampled,
    "noise": noise,
    "leapfrog": leapfrog,
    "wrong weights": wrong_weights,
    "events by interpolation": interpolated_events,
    "no events located": no_events,
    "loose tolerance": loose_tolerance,
}


def spoil(kind: str, case: Case, sampling: str, seed: int) -> Spoilt | None:
    """Return a wrong solution; None if it is not wrong within the samples, or cannot be."""
    rng = np.random.default_rng([seed, *map(ord, f"{kind}/{case.scene.name}/{sampling}")])
    found = KINDS[kind](case, sampling, rng)
    if found is None or not np.all(np.isfinite([found.x, found.v])) or np.max(np.abs([found.x, found.v])) > 1e6:
        return None
    if found.always:
        return found
    inside = (found.t >= case.span[0]) & (found.t <= case.span[1])
    right = case.exact(found.t[inside])
    scales = np.max(np.abs(right), axis=1, keepdims=True)
    off = np.abs(right - [found.x[inside], found.v[inside]]) / np.where(scales > 0.0, scales, 1.0)
    return found if np.max(off) > WRONG else None
