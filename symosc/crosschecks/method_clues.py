"""Whether steps are those of a known method with a fixed step, or have errors like those of some method."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues
from symosc.kernels._generated import acceleration

State = tuple[Any, Any]
Force = Callable[[Any, Any, Any], Any]
# Samples may be so many steps of the method apart.
SUBSTEPS = (1, 2, 3, 4, 5, 8, 10, 16, 20, 25, 32, 40, 50, 100)
MOST_REPEATED = 60
# A method is known by leaving so little of the defects.
REPEATED_TO = 0.005


def euler(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one explicit step of order 1."""
    return x + h * v, v + h * a(t, x, v)


def semi_implicit(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step that uses the new velocity for the position."""
    v = v + h * a(t, x, v)
    return x + h * v, v


def midpoint(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of order 2, by the slope in the middle."""
    middle = v + 0.5 * h * a(t, x, v)
    return x + h * middle, v + h * a(t + 0.5 * h, x + 0.5 * h * v, middle)


def heun(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of order 2, by the mean of two slopes."""
    first = a(t, x, v)
    ahead = v + h * first
    return x + 0.5 * h * (v + ahead), v + 0.5 * h * (first + a(t + h, x + h * v, ahead))


def rk4(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
    """Return the state after one step of the classical Runge-Kutta method."""
    slopes = [(v, a(t, x, v))]
    for part in (0.5, 0.5, 1.0):
        dx, dv = slopes[-1]
        ahead = v + part * h * dv
        slopes.append((ahead, a(t + part * h, x + part * h * dx, ahead)))
    weights = (1.0, 2.0, 2.0, 1.0)
    dx, dv = (sum(w * slope[i] for w, slope in zip(weights, slopes, strict=True)) / 6.0 for i in (0, 1))
    return x + h * dx, v + h * dv


#: "exact" is the closed form, with the force of the domain at the beginning of the step.
FIXED_STEP_METHODS = {
    "exact": None,
    "Euler": euler,
    "semi-implicit Euler": semi_implicit,
    "midpoint": midpoint,
    "Heun": heun,
    "RK4": rk4,
}


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
            events, others = (_share_repeated(clues, chosen, method, count) for chosen in (at_events, flights))
            h = float(np.median(clues.steps.t[wrong + 1] - clues.steps.t[wrong])) / count
            if (
                (passed or (len(at_events) and method is None))
                and events >= 0.8
                and (others >= 0.8 or len(flights) < 3)
            ):
                unseen = clues.label[at_events + 1] == clues.label[at_events]
                yield _not_located(clues, name, h, events, count == 1 and 2 * np.sum(unseen) > len(unseen))
                return
            if len(flights) >= 3 and others >= 0.8:
                words = f"the steps are those of the method {name} with a step of {h:.4g}"
                evidence = f"{others:.0%} of {len(flights)} steps inside a domain are repeated by it"
                yield Diagnosis("truncation", name, words, evidence, h, 0.0, others)
                return


def _not_located(clues: Clues, name: str, h: float, share: float, unseen: bool) -> Diagnosis:
    """Return that a method with a fixed step goes over events; in sticks that is chatter."""
    evidence = f"{name} with steps of {h:.4g} and the friction of each stage's v repeats {share:.0%} of the steps"
    if name == "exact" and unseen:
        words = "belts are met and left within a step, and that is not seen"
        return Diagnosis("double root", "", words, "without these contacts the steps are right", share=share)
    if name == "exact":
        words = f"events are not located: they happen at the end of steps of {h:.4g}"
        evidence = f"right flights with the force at the beginning of steps of {h:.4g} repeat {share:.0%} of the steps"
        return Diagnosis("late events", name, words, evidence, h, 0.0, share)
    if np.any(clues.wrong & (clues.steps.last > 3)):
        words = f"v jumps to and fro about a belt's speed: {name} with a step of {h:.4g} goes over the events"
        return Diagnosis("chatter", name, words, evidence, h, 0.0, share)
    words = f"events are not located: {name} with a step of {h:.4g} goes over them"
    return Diagnosis("late events", name, words, evidence, h, 0.0, share)


def _share_repeated(clues: Clues, chosen: np.ndarray, method: Callable[..., State] | None, count: int) -> float:
    if not len(chosen):
        return 0.0
    return float(np.mean(_repeated(clues, chosen, method, count) <= clues.limits(REPEATED_TO)[chosen]))


def truncation(clues: Clues) -> Iterator[Diagnosis]:
    """Yield errors like those of some method, with their size and order."""
    wrong = clues.inside[clues.wrong[clues.inside]]
    if len(wrong) < 3:
        return
    size = float(np.median(np.max(np.abs(clues.steps.defects[wrong]) / clues.scales, axis=1)))
    words = f"steps without events have errors of about {size:.1e} of the largest |x|, |v|: a tolerance of the method"
    order = _order(clues, wrong)
    more = f"; they grow like the step to the power {order[0]:.1f} ± {order[1]:.1g}" if order else ""
    yield Diagnosis("truncation", "", words, f"no coefficient explains them{more}", size, None,
                    0.6 * clues.flights_wrong)  # fmt: skip


def _repeated(clues: Clues, chosen: np.ndarray, method: Callable[..., State] | None, count: int) -> np.ndarray:
    """Return what a method with so many steps from sample to sample misses, in units of what is allowed."""
    s, K = clues.steps, clues.steps.K
    h = (s.t[chosen + 1] - s.t[chosen]) / count
    forces = np.array([K.A1, K.A2, K.A3])

    def force(t: Any, x: Any, v: Any) -> Any:
        A = forces[(v > K.belt1.v).astype(int) + (v > K.belt2.v)]
        return acceleration(x, v, np.cos(s.theta[chosen] + K.Om * t), A, K.cm, K.w0sq, K.f0)

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
                x, v = method(force, t, x, v, h)
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
