"""Whether steps are those of a known method with a fixed step, or have errors like those of some method."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues
from symosc.kernels._generated import acceleration

State = tuple[Any, Any]
Force = Callable[[Any, Any, Any], Any]
# Samples may be so many steps of the method apart.
SUBSTEPS = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 16, 20, 24, 25, 30, 32, 40, 50, 64, 100)
MOST_REPEATED = 60
# A method is known by leaving so little of the defects; its fitted weights by less.
REPEATED_TO, WEIGHTS_TO = 0.005, 1e-4
IMPLICIT_ROUNDS = 60
FEWEST_WEIGHTED = 8


def semi_implicit(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step that uses the new velocity for the position."""
    v = v + h * a(t, x, v)
    return x + h * v, v


def kick_first(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of the leapfrog (Verlet): half a kick, a drift, half a kick."""
    middle = v + 0.5 * h * a(t, x, v)
    x = x + h * middle
    return x, middle + 0.5 * h * a(t + h, x, middle)


def kick_with_v(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of velocity Verlet, with the force at the velocity at the beginning."""
    first = a(t, x, v)
    x = x + h * v + 0.5 * h * h * first
    return x, v + 0.5 * h * (first + a(t + h, x, v))


def kick_predicted(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of velocity Verlet, with the force at a predicted velocity."""
    first = a(t, x, v)
    x = x + h * v + 0.5 * h * h * first
    return x, v + 0.5 * h * (first + a(t + h, x, v + h * first))


def drift_first(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of the leapfrog: half a drift, a kick, half a drift."""
    middle = x + 0.5 * h * v
    after = v + h * a(t + 0.5 * h, middle, v)
    return middle + 0.5 * h * after, after


def position_first(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step that uses the new position for the velocity."""
    x = x + h * v
    return x, v + h * a(t, x, v)


def taylor(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step with a constant acceleration."""
    first = a(t, x, v)
    return x + h * v + 0.5 * h * h * first, v + h * first


def implicit_euler(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one implicit step of order 1."""
    return _implicit(a, t, x, v, h, 1.0)


def trapezium(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of the implicit rule of order 2 (Crank-Nicolson, Newmark)."""
    return _implicit(a, t, x, v, h, 0.5)


def _implicit(a: Force, t: Any, x: Any, v: Any, h: Any, part: float) -> State:
    first, ahead = a(t, x, v), v
    for _ in range(IMPLICIT_ROUNDS):
        there = x + h * ((1.0 - part) * v + part * ahead)
        ahead = v + h * ((1.0 - part) * first + part * a(t + h, there, ahead))
    return x + h * ((1.0 - part) * v + part * ahead), ahead


def runge_kutta(rows: Sequence[Sequence[float]], weights: Sequence[float]) -> Callable[..., State]:
    """Return an explicit Runge-Kutta method from its tableau."""

    def step(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
        slopes = stages(rows, a, t, x, v, h)
        dx, dv = (sum(w * slope[i] for w, slope in zip(weights, slopes, strict=True)) for i in (0, 1))
        return x + h * dx, v + h * dv

    return step


def stages(rows: Sequence[Sequence[float]], a: Force, t: Any, x: Any, v: Any, h: Any) -> list[State]:
    """Return the slopes of x and v at the stages of an explicit Runge-Kutta method."""
    slopes: list[State] = []
    for row in rows:
        dx, dv = (sum(part * slope[i] for part, slope in zip(row, slopes, strict=True)) for i in (0, 1))
        ahead = v + h * dv
        slopes.append((ahead, a(t + sum(row) * h, x + h * dx, ahead)))
    return slopes


CLASSICAL = ((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0))
#: "exact" is the closed form, with the force of the domain at the beginning of the step.
FIXED_STEP_METHODS = {
    "exact": None,
    "Euler": runge_kutta(((),), (1.0,)),
    "semi-implicit Euler": semi_implicit,
    "semi-implicit Euler, x first": position_first,
    "constant acceleration": taylor,
    "midpoint": runge_kutta(((), (0.5,)), (0.0, 1.0)),
    "Heun": runge_kutta(((), (1.0,)), (0.5, 0.5)),
    "leapfrog (velocity Verlet)": kick_first,
    "velocity Verlet with the old v": kick_with_v,
    "velocity Verlet with a predicted v": kick_predicted,
    "leapfrog, x first": drift_first,
    "implicit Euler": implicit_euler,
    "trapezoidal rule": trapezium,
    "RK3": runge_kutta(((), (0.5,), (-1.0, 2.0)), (1 / 6, 4 / 6, 1 / 6)),
    "RK4": runge_kutta(CLASSICAL, (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
    "RK4 with equal weights": runge_kutta(CLASSICAL, (1 / 4, 1 / 4, 1 / 4, 1 / 4)),
    "RK4 with weights 1, 3, 3, 1 over 8": runge_kutta(CLASSICAL, (1 / 8, 3 / 8, 3 / 8, 1 / 8)),
    "RK4 with weights 2, 1, 1, 2 over 6": runge_kutta(CLASSICAL, (1 / 3, 1 / 6, 1 / 6, 1 / 3)),
    "RK4 with weights 1, 2, 1, 2 over 6": runge_kutta(CLASSICAL, (1 / 6, 1 / 3, 1 / 6, 1 / 3)),
    "RK4 with weights 1, 1, 2, 2 over 6": runge_kutta(CLASSICAL, (1 / 6, 1 / 6, 1 / 3, 1 / 3)),
    "RK4 with weights 2, 2, 1, 1 over 6": runge_kutta(CLASSICAL, (1 / 3, 1 / 3, 1 / 6, 1 / 6)),
}
# Tried with at most so many steps from sample to sample.
RARE = {name for name in FIXED_STEP_METHODS if name.startswith(("RK4 with", "RK3", "implicit", "trapez", "constant"))}
MOST_RARE = 10


def repeated(clues: Clues) -> Iterator[Diagnosis]:
    """Yield the method that repeats the wrong steps: with events located, or with the friction of each stage's v."""
    wrong = np.flatnonzero(clues.wrong & (np.diff(clues.steps.t) > 0.0))
    inside = clues.inside[clues.wrong[clues.inside]]
    at_events = clues.some(np.setdiff1d(wrong, inside), MOST_REPEATED)
    flights = clues.some(inside, MOST_REPEATED)
    # Where most steps with events have a sample on the belt at an end, the events are located.
    passed = 2 * np.sum((clues.label[at_events] > 0) & (clues.label[at_events + 1] > 0)) > len(at_events)
    for count in SUBSTEPS:
        for name, method in FIXED_STEP_METHODS.items():
            if name in RARE and count > MOST_RARE:
                continue
            others = _share_repeated(clues, flights, method, count)
            if len(flights) >= 3 and others < 0.8:
                continue
            events, held = max(
                (_share_repeated(clues, at_events, method, count, held), held) for held in (False, method is not None)
            )
            h = float(np.median(clues.steps.t[wrong + 1] - clues.steps.t[wrong])) / count
            over_events = (passed or (len(at_events) and method is None)) and events >= 0.8
            if over_events:
                unseen = clues.label[at_events + 1] == clues.label[at_events]
                yield _not_located(clues, name, h, events, count == 1 and 2 * np.sum(unseen) > len(unseen), held)
            if len(flights) >= 3 and not (over_events and method is None):
                words = f"the steps are those of the method {name} with a step of {h:.4g}"
                evidence = f"{others:.0%} of {len(flights)} steps inside a domain are repeated by it"
                yield Diagnosis("truncation", name, words, evidence, h, 0.0, others)
            if over_events or len(flights) >= 3:
                return
    yield from _other_weights(clues, flights)


def _other_weights(clues: Clues, flights: np.ndarray) -> Iterator[Diagnosis]:
    """Yield the classical Runge-Kutta method with weights that are fitted."""
    if len(flights) < FEWEST_WEIGHTED:
        return
    s, force = clues.steps, _force(clues, flights)
    h = s.t[flights + 1] - s.t[flights]
    slopes = np.array(stages(CLASSICAL, force, 0.0 * h, s.x[flights], s.v[flights], h)) * h  # stage, x or v, step
    J = np.moveaxis(slopes, 0, -1).transpose(1, 0, 2) / clues.allowed[flights][:, :, None]
    wanted = np.column_stack([np.diff(s.x), np.diff(s.v)])[flights] / clues.allowed[flights]
    if not np.all(np.isfinite(J)):
        return
    weights = np.linalg.lstsq(J.reshape(-1, 4), wanted.ravel(), rcond=1e-9)[0]
    left = np.max(np.abs(J @ weights - wanted), axis=1)
    share = float(np.mean(left <= clues.limits(WEIGHTS_TO)[flights]))
    if share >= 0.8:
        shown = ", ".join(f"{weight:.4f}" for weight in weights)
        words = f"the steps are those of RK4 with wrong weights: {shown}, which should be 1, 2, 2, 1 over 6"
        evidence = (
            f"fitted: these weights, whose sum is {np.sum(weights):.6g}, repeat {share:.0%} of {len(flights)} steps"
        )
        yield Diagnosis("truncation", "Runge-Kutta weights", words, evidence, float(np.sum(weights)), 0.0, share)


def _not_located(clues: Clues, name: str, h: float, share: float, unseen: bool, held: bool) -> Diagnosis:
    """Return that a method with a fixed step goes over events; in sticks that is chatter."""
    friction = "the friction at its beginning" if held else "the friction of each stage's v"
    evidence = f"{name} with steps of {h:.4g} and {friction} repeats {share:.0%} of the steps with events"
    if name == "exact" and unseen:
        words = "belts are met and left within a step, and that is not seen"
        evidence = f"the force at the beginning repeats {share:.0%} of the steps with events"
        return Diagnosis("double root", "", words, evidence, share=share)
    if name == "exact":
        words = f"events are not located: they happen at the end of steps of {h:.4g}"
        evidence = f"right flights with the force at the beginning of steps of {h:.4g} repeat {share:.0%} of the steps"
        return Diagnosis("late events", name, words, evidence, h, 0.0, share)
    if clues.sticks and np.any(clues.wrong & (clues.steps.last > 3)):
        words = f"v jumps to and fro about a belt's speed: {name} with a step of {h:.4g} goes over the events"
        return Diagnosis("chatter", name, words, evidence, h, 0.0, share)
    words = f"events are not located: {name} with a step of {h:.4g} goes over them"
    return Diagnosis("late events", name, words, evidence, h, 0.0, share)


def _share_repeated(
    clues: Clues, chosen: np.ndarray, method: Callable[..., State] | None, count: int, held: bool = False
) -> float:
    if not len(chosen):
        return 0.0
    return float(np.mean(_repeated(clues, chosen, method, count, held) <= clues.limits(REPEATED_TO)[chosen]))


def truncation(clues: Clues) -> Iterator[Diagnosis]:
    """Yield errors like those of some method, with their size and order."""
    wrong = clues.inside[clues.wrong[clues.inside]]
    if len(wrong) < 3:
        return
    size = float(np.median(np.max(np.abs(clues.steps.defects[wrong]) / clues.scales, axis=1)))
    words = f"steps without events have errors of about {size:.1e} of the largest |x|, |v|: a tolerance of the method"
    order = _order(clues, wrong)
    more = f"; they grow like the step to the power {order[0]:.1f} ± {order[1]:.1g}" if order else ""
    evidence = f"no coefficient, sign, column or method of those tried explains them{more}"
    yield Diagnosis("truncation", "", words, evidence, size, None, 0.6 * clues.flights_wrong)


def _force(clues: Clues, chosen: np.ndarray, held: bool = False) -> Force:
    """Return the acceleration in some steps, at times since they began; `held`: in the domain at their beginning."""
    s, K = clues.steps, clues.steps.K
    forces = np.array([K.A1, K.A2, K.A3])
    domain: list[np.ndarray] = []

    def force(t: Any, x: Any, v: Any) -> Any:
        here = (v > K.belt1.v).astype(int) + (v > K.belt2.v)
        if held and not domain:
            domain.append(here)
        theta = s.theta[chosen] + K.Om * t
        return acceleration(x, v, np.cos(theta), forces[domain[0] if held else here], K.cm, K.w0sq, K.f0)

    return force


def _repeated(
    clues: Clues, chosen: np.ndarray, method: Callable[..., State] | None, count: int, held: bool = False
) -> np.ndarray:
    """Return what a method with so many steps from sample to sample misses, in units of what is allowed.

    `held`: with the friction at the beginning of each of its steps, else with that of each stage's v.
    """
    s, K = clues.steps, clues.steps.K
    h = (s.t[chosen + 1] - s.t[chosen]) / count
    t, x, v = np.zeros(len(chosen)), s.x[chosen], s.v[chosen]
    even = np.arange(0, 2 * len(chosen), 2)
    with np.errstate(all="ignore"):
        for _ in range(count):
            if method is None:
                theta = np.repeat(s.theta[chosen] + K.Om * t, 2)
                path = replace(
                    s, t=np.column_stack([0.0 * h, h]).ravel(), x=np.repeat(x, 2), v=np.repeat(v, 2), theta=theta
                )
                x, v = path.flight(1 + (v > K.belt1.v) + (v > K.belt2.v), even, even + 1).T
            else:
                x, v = method(_force(clues, chosen, held), t, x, v, h)
            t = t + h
        misses = (np.column_stack([x, v]) - np.column_stack([s.x, s.v])[chosen + 1]) / clues.allowed[chosen]
    return np.asarray(np.nan_to_num(np.max(np.abs(misses), axis=1), nan=np.inf))


def _order(clues: Clues, wrong: np.ndarray) -> tuple[float, float] | None:
    """Return the power of the step with which the errors grow, and its error, if the steps differ enough."""
    h = np.log(np.diff(clues.steps.t)[wrong])
    if np.ptp(h) < 1.0 or len(h) < 20:
        return None
    e = np.log(np.max(np.abs(clues.steps.defects[wrong]) / clues.scales, axis=1))
    (slope, _), matrix = np.polyfit(h, e, 1, cov=True)
    return float(slope), float(np.sqrt(matrix[0, 0]))
