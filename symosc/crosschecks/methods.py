"""Numerical methods as causes.

A known one with fixed step, missed or delayed events, truncation errors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from symosc.crosschecks.causes import SURE, Case, Diagnosis, best_between, larger
from symosc.engine.state import SLIP
from symosc.kernels._generated import acceleration

State = tuple[Any, Any]
Force = Callable[[Any, Any, Any], Any]
Method = Callable[[Force, Any, Any, Any, Any], State]
MOST_REPEATED = 60
# No weight of a Runge-Kutta method is larger, also if somebody has not divided by 6.
LARGEST_WEIGHT = 3.0
# Number of steps with events on which delays are tried, and of grid points for the delay of each.
MOST_DELAYS = 60
DELAY_GRID = 9
# A delay explains a step if it leaves less than this part of the defect: an event too early fits
# nearly as well.
DELAY_LEAVES = 0.005


# -- methods with a fixed step: each returns the state after a step h, for the acceleration a(t, x, v) -----------------


def nystrom(
    stages: Sequence[tuple[float, float, Sequence[float], Sequence[float]]],
    x_weights: Any,
    v_weights: Any,
) -> Method:
    """Return an explicit Nyström method, given its stages and the weights of their accelerations in x and in v.

    A stage (time, way, x_row, v_row) is at t + time h, x + way h v + h^2 sum(x_row a), v + h
    sum(v_row a), where `a` are the accelerations of the stages before it.
    """

    def total(weights: Any, found: list[Any]) -> Any:
        return sum(weight * each for weight, each in zip(weights, found, strict=True))

    def step(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
        found: list[Any] = []
        for time, way, x_row, v_row in stages:
            there = x + way * h * v + h * h * total(x_row, found)
            found.append(a(t + time * h, there, v + h * total(v_row, found)))
        return x + h * v + h * h * total(x_weights, found), v + h * total(v_weights, found)

    return step


def runge_kutta(rows: Sequence[Sequence[float]], *weights: float) -> Method:
    """Return the explicit Runge-Kutta method with these `rows` and `weights` in its Butcher tableau."""
    A = np.array([[*row, *[0.0] * (len(rows) - len(row))] for row in rows])
    stages = [(sum(row), sum(row), (A @ A)[i, :i].tolist(), row) for i, row in enumerate(rows)]
    return nystrom(stages, (np.array(weights) @ A).tolist(), weights)


def implicit(part: float) -> Method:
    """Return the implicit rule that weights the slope at a step's end by `part`, that at its start by 1 - `part`."""

    def step(a: Force, t: Any, x: Any, v: Any, h: Any) -> State:
        first = a(t, x, v)
        ahead = v
        for _ in range(60):
            there = x + h * ((1.0 - part) * v + part * ahead)
            ahead = v + h * ((1.0 - part) * first + part * a(t + h, there, ahead))
        return x + h * ((1.0 - part) * v + part * ahead), ahead

    return step


START: tuple[float, float, Sequence[float], Sequence[float]] = (0.0, 0.0, (), ())
CLASSICAL = ((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0))
#: "exact" is the closed form, with the force of the domain at the beginning of the step.
FIXED_STEP_METHODS: dict[str, Method | None] = {
    "exact": None,
    "Euler": nystrom([START], (0.0,), (1.0,)),
    "semi-implicit Euler": nystrom([START], (1.0,), (1.0,)),
    "semi-implicit Euler, x first": nystrom([(0.0, 1.0, (), ())], (0.0,), (1.0,)),
    "constant acceleration": nystrom([START], (0.5,), (1.0,)),
    "midpoint": runge_kutta(((), (0.5,)), 0.0, 1.0),
    "Heun": runge_kutta(((), (1.0,)), 0.5, 0.5),
    "leapfrog (velocity Verlet)": nystrom(
        [START, (1.0, 1.0, (0.5,), (0.5,))], (0.5, 0.0), (0.5, 0.5)
    ),
    "velocity Verlet with the old v": nystrom(
        [START, (1.0, 1.0, (0.5,), (0.0,))], (0.5, 0.0), (0.5, 0.5)
    ),
    "velocity Verlet with a predicted v": nystrom(
        [START, (1.0, 1.0, (0.5,), (1.0,))], (0.5, 0.0), (0.5, 0.5)
    ),
    "leapfrog, x first": nystrom([(0.5, 0.5, (), ())], (0.5,), (1.0,)),
    "implicit Euler": implicit(1.0),
    "trapezoidal rule": implicit(0.5),
    "RK3": runge_kutta(((), (0.5,), (-1.0, 2.0)), 1 / 6, 4 / 6, 1 / 6),
    "RK4": runge_kutta(CLASSICAL, 1 / 6, 1 / 3, 1 / 3, 1 / 6),
    "RK4 with equal weights": runge_kutta(CLASSICAL, 1 / 4, 1 / 4, 1 / 4, 1 / 4),
    "RK4 with weights 1, 3, 3, 1 over 8": runge_kutta(CLASSICAL, 1 / 8, 3 / 8, 3 / 8, 1 / 8),
    "RK4 with weights 2, 1, 1, 2 over 6": runge_kutta(CLASSICAL, 1 / 3, 1 / 6, 1 / 6, 1 / 3),
    "RK4 with weights 1, 2, 1, 2 over 6": runge_kutta(CLASSICAL, 1 / 6, 1 / 3, 1 / 6, 1 / 3),
    "RK4 with weights 1, 1, 2, 2 over 6": runge_kutta(CLASSICAL, 1 / 6, 1 / 6, 1 / 3, 1 / 3),
    "RK4 with weights 2, 2, 1, 1 over 6": runge_kutta(CLASSICAL, 1 / 3, 1 / 3, 1 / 6, 1 / 6),
}
# Tried with few steps from sample to sample only.
RARE = {
    name
    for name in FIXED_STEP_METHODS
    if name.startswith(("RK4 with", "RK3", "implicit", "trapez", "constant"))
}


def known_methods(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis that the samples were made by one of FIXED_STEP_METHODS, which reproduces the wrong steps."""
    wrong = case.moving_wrong
    inside = case.inside_wrong
    at_events = case.thinned(np.setdiff1d(wrong, inside), MOST_REPEATED)
    flights = case.thinned(inside, MOST_REPEATED)
    # Where most steps with events have a sample on the belt at an end, the events are located.
    passed = 2 * np.sum((case.domain[at_events] > 0) & (case.domain[at_events + 1] > 0)) > len(
        at_events
    )
    # From one sample to the next the method may have made `count` steps.
    for count in (*range(1, 11), 12, 15, 16, 20, 24, 25, 30, 32, 40, 50, 64, 100):
        for name, method in FIXED_STEP_METHODS.items():
            if name in RARE and count > 10:
                continue
            others = _share_repeated(case, flights, method, count)
            if len(flights) >= 3 and others < 0.8:
                continue
            events, held = max(
                (_share_repeated(case, at_events, method, count, held), held)
                for held in (False, method is not None)
            )
            h = float(np.median(case.steps.t[wrong + 1] - case.steps.t[wrong])) / count
            over_events = (passed or (len(at_events) and method is None)) and events >= 0.8
            if over_events:
                unseen = case.domain[at_events + 1] == case.domain[at_events]
                yield _not_located(
                    case, name, h, events, count == 1 and 2 * np.sum(unseen) > len(unseen), held
                )
            if len(flights) >= 3 and not (over_events and method is None):
                words = f"the steps are those of the method {name} with a step of {h:.4g}"
                evidence = (
                    f"{others:.0%} of {len(flights)} steps inside a domain are repeated by it"
                )
                yield Diagnosis("truncation", name, words, evidence, h, 0.0, others)
            if over_events or len(flights) >= 3:
                return
    yield from _other_weights(case, flights)


def _other_weights(case: Case, flights: np.ndarray) -> Iterator[Diagnosis]:
    """Yield the diagnosis of the classical Runge-Kutta method with wrong weights, which are fitted."""
    if len(flights) < 8:
        return
    s = case.steps
    force = _force(case, flights)
    slopes = list[State]()
    h = s.t[flights + 1] - s.t[flights]

    def noted(t: Any, x: Any, v: Any) -> Any:
        slopes.append((v, force(t, x, v)))
        return slopes[-1][1]

    runge_kutta(CLASSICAL, 0.0, 0.0, 0.0, 0.0)(noted, 0.0 * h, s.x[flights], s.v[flights], h)
    J = (
        np.transpose(np.array(slopes) * h, (2, 1, 0)) / case.allowed[flights][:, :, None]
    )  # step, x or v, stage
    wanted = np.diff(s.states, axis=0)[flights] / case.allowed[flights]
    if not np.all(np.isfinite(J)):
        return
    weights = np.linalg.lstsq(J.reshape(-1, 4), wanted.ravel(), rcond=1e-9)[0]
    share = float(np.mean(larger(J @ weights - wanted) <= case.limits(1e-4)[flights]))
    if (
        share >= 0.8 and np.max(np.abs(weights)) <= LARGEST_WEIGHT
    ):  # others say that they are not determined
        values = ", ".join(f"{weight:.4f}" for weight in weights)
        total = np.sum(weights)
        words = f"the steps are those of RK4 with wrong weights: {values}, which should be 1, 2, 2, 1 over 6"
        evidence = f"fitted: these weights, whose sum is {total:.6g}, repeat {share:.0%} of {len(flights)} steps"
        yield Diagnosis(
            "truncation", "Runge-Kutta weights", words, evidence, float(total), 0.0, share
        )


def _not_located(
    case: Case, name: str, h: float, share: float, unseen: bool, held: bool
) -> Diagnosis:
    """Return the diagnosis that the method `name` does not locate events, or makes chatter where the mass should stick.

    With steps `h` it reproduces the fraction `share` of the steps with events. `unseen` says that
    most of these end on the side of the belt where they began, `held` that each step keeps the
    friction of its beginning.
    """
    if name == "exact" and unseen:
        words = "belts are met and left within a step, and that is not seen"
        evidence = f"the force at the beginning repeats {share:.0%} of the steps with events"
        return Diagnosis("double root", "", words, evidence, share=share)
    if name == "exact":
        words = f"events are not located: they happen at the end of steps of {h:.4g}"
        evidence = f"right flights with the force at the beginning of steps of {h:.4g} repeat {share:.0%} of the steps"
        return Diagnosis("late events", name, words, evidence, h, 0.0, share)
    if held:
        friction = "the friction at its beginning"
    else:
        friction = "the friction of each stage's v"
    evidence = (
        f"{name} with steps of {h:.4g} and {friction} repeats {share:.0%} of the steps with events"
    )
    cause = "late events"
    words = f"events are not located: {name} with a step of {h:.4g} goes over them"
    if case.sticks and np.any(case.wrong & (case.steps.last > 3)):
        cause = "chatter"
        words = f"v jumps to and fro about a belt's speed: {name} with a step of {h:.4g} goes over the events"
    return Diagnosis(cause, name, words, evidence, h, 0.0, share)


def _share_repeated(
    case: Case, chosen: np.ndarray, method: Method | None, count: int, held: bool = False
) -> float:
    """Return the fraction of the steps `chosen` that `count` substeps of a method (None: exact flights) reproduce.

    Friction is that of each stage's v, or if `held` that at the beginning of each substep.
    """
    if not len(chosen):
        return 0.0
    s = case.steps
    K = case.steps.K
    h = (s.t[chosen + 1] - s.t[chosen]) / count
    t = np.zeros(len(chosen))
    x = s.x[chosen]
    v = s.v[chosen]
    with np.errstate(all="ignore"):
        for _ in range(count):
            domain = 1 + (v > K.belt1.v) + (v > K.belt2.v)
            if method is None:
                x, v = s.fly(domain, x, v, s.theta[chosen] + K.Om * t, h).T
            else:
                x, v = method(_force(case, chosen, domain if held else None), t, x, v, h)
            t = t + h
        sizes = np.nan_to_num(case.miss_sizes(np.column_stack([x, v]), chosen), nan=np.inf)
    return float(np.mean(sizes <= case.limits(0.005)[chosen]))  # of the defects is left


def _force(case: Case, chosen: np.ndarray, domain: np.ndarray | None = None) -> Force:
    """Return the acceleration in the chosen steps as a function of t, x, v, in given domains or in the domain of v."""
    s = case.steps
    K = case.steps.K

    def force(t: Any, x: Any, v: Any) -> Any:
        if domain is None:
            here = 1 + (v > K.belt1.v) + (v > K.belt2.v)
        else:
            here = domain
        A = np.array([K.A1, K.A2, K.A3])[here - 1]
        return acceleration(x, v, np.cos(s.theta[chosen] + K.Om * t), A, K.cm, K.w0sq, K.f0)

    return force


def truncation(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of truncation errors, with their size and order."""
    wrong = case.inside_wrong
    if len(wrong) < 3:
        return
    errors = np.max(np.abs(case.steps.defects[wrong]) / case.scales, axis=1)
    size = float(np.median(errors))
    more = ""
    words = f"steps without events have errors of about {size:.1e} of the largest |x|, |v|: a tolerance of the method"
    h = np.log(np.diff(case.steps.t)[wrong])
    if np.ptp(h) >= 1.0 and len(h) >= 20:  # the steps differ enough to show an order
        (slope, _), matrix = np.polyfit(h, np.log(errors), 1, cov=True)
        more = f"; they grow like the step to the power {slope:.1f} ± {np.sqrt(matrix[0, 0]):.1g}"
    evidence = f"no coefficient, sign, column or method of those tried explains them{more}"
    yield Diagnosis("truncation", "", words, evidence, size, None, 0.6 * case.flights_wrong)


# -- events that are missed, late, or on a straight line ---------------------------------------------------------------


def double_roots(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis that v crosses a belt's speed and comes back within a step, and that this goes unnoticed."""
    s = case.steps
    source = case.domain[:-1]
    target = case.domain[1:]
    there = case.wrong & (source > 0) & (source == target) & (s.first == source)
    chosen = np.flatnonzero(there & np.isin(np.arange(len(there)), s.events.step))
    if not len(chosen):
        return
    sizes = case.miss_sizes(s.flight(source[chosen], chosen, chosen + 1), chosen)
    fits = sizes <= case.limits()[chosen]
    count = int(np.sum(fits))
    right = int(np.sum(sizes <= 1.0))
    total = int(np.sum(case.wrong))
    if count:
        times = s.events.t[s.events.rows(int(chosen[fits][0]), int(chosen[fits][0]))]
        low = float(times[0])
        high = float(times[-1])
        words = f"a belt is met within one step, and that is not seen ({count} times)"
        first = f"the first time at t = {low:.8g} to {high:.8g}"
        evidence = f"{first}; without the contacts {right} of these steps are right"
        yield Diagnosis(
            "double root", "", words, evidence, share=SURE if right == total else count / total
        )


def delays(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of events that occur too late, with the mean delay."""
    s = case.steps
    chosen, rows, every = _first_events(case, np.ones(len(s.first), bool))
    if not len(chosen):
        return
    room = s.t[chosen + 1] - s.events.t[rows]
    limits = case.limits(DELAY_LEAVES)[chosen]

    def misses(part: np.ndarray) -> np.ndarray:
        return np.minimum(
            *(_with_delay(case, chosen, rows, part * room, onto) for onto in (False, True))
        )

    part, leaves = best_between(
        misses, np.zeros(len(chosen)), np.ones(len(chosen)), DELAY_GRID, limits
    )
    delay = part * room
    fits = leaves <= limits
    if not np.any(fits) or np.all(
        s.events.kind[rows][fits] == SLIP
    ):  # late ends of sticks are another cause
        return
    share = float(np.mean(fits)) * every / int(np.sum(case.wrong))
    unseen = int(
        np.sum(fits & (delay >= 0.999 * room) & (case.domain[chosen + 1] == s.first[chosen]))
    )
    if 2 * unseen > np.sum(fits):
        words = f"belts are met and left within a step, and that is not seen ({unseen} times)"
        yield Diagnosis(
            "double root", "", words, f"the force before them repeats {unseen} steps", share=share
        )
        return
    mean = float(np.mean(delay[fits]))
    spread = float(np.std(delay[fits]))
    largest = float(np.max(delay[fits]))
    evidence = f"{int(np.sum(fits))} events are late by {mean:.3g} on average (spread {spread:.2g})"
    words = f"events are not located: they happen up to {largest:.3g} late, at the end of the solver's step"
    yield Diagnosis("late events", "", words, evidence, mean, spread, share)


def _with_delay(
    case: Case, chosen: np.ndarray, rows: np.ndarray, delay: np.ndarray, onto: bool
) -> np.ndarray:
    """Return by how much the exact motion misses the ends of steps if the first event of each is late by `delay`.

    `rows` are the rows of these events in the `StepEvents`. If `onto`, v is set to the belt's speed
    at the late event.
    """
    # Up to its delayed end a mode goes on as before the event.
    s = case.steps
    time = np.minimum(s.events.t[rows] + delay, s.t[chosen + 1])
    source = s.first[chosen]
    tau = time - s.t[chosen]
    speed = s.belts[s.events.boundary[rows] - 1]
    # Up to the delayed end the motion is that before the event: a flight, or a stick on the belt.
    x, v = s.fly(np.minimum(source, 3), s.x[chosen], s.v[chosen], s.theta[chosen], tau).T
    held = source > 3
    x = np.where(held, s.x[chosen] + speed * tau, x)
    return _misses_from(case, chosen, time, x, np.where(held | onto, speed, v))


def _misses_from(
    case: Case, chosen: np.ndarray, time: np.ndarray, x: np.ndarray, v: np.ndarray
) -> np.ndarray:
    """Return by how much the exact motion from states time, x, v inside the steps `chosen` misses their ends."""
    return larger(
        case.defects_from(np.column_stack([time, x, v]), chosen + 1, 0.0) / case.allowed[chosen]
    )


def interpolated(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis that events are located by linear interpolation over a step."""
    s = case.steps
    chosen, rows, every = _first_events(case, s.first <= 3)
    if not len(chosen):
        return
    t = s.t[chosen]
    x = s.x[chosen]
    v = s.v[chosen]
    theta = s.theta[chosen]
    first = s.first[chosen]
    speed = s.belts[s.events.boundary[rows] - 1]
    whole = s.flight(first, chosen, chosen + 1)
    part = (speed - v) / (whole[:, 1] - v)
    time = t + part * (s.t[chosen + 1] - t)
    good = np.isfinite(part) & (part >= 0.0) & (part <= 1.0)
    if not np.any(good):
        return
    at_line = x + part * (whole[:, 0] - x)
    at_flight = s.fly(first, x, v, theta, np.where(good, time, s.t[chosen + 1]) - t)[:, 0]
    left = np.full(len(chosen), np.inf)
    for place in (at_line, at_flight):
        after = _misses_from(
            case,
            chosen,
            np.where(good, time, t),
            np.where(good, place, x),
            np.where(good, speed, v),
        )
        left = np.fmin(left, np.where(good, after, np.inf))
    # Where the samples end with the event, the line from its sample to the end of the solver's
    # usual step led there.
    usual = float(np.median(np.diff(s.t)))
    whole = s.fly(first, x, v, theta, (t + usual) - t)
    part = (speed - v) / (whole[:, 1] - v)
    late = np.abs(t + part * usual - s.t[chosen + 1]) * np.maximum(np.abs(speed), np.abs(v))
    off = (
        np.maximum(np.abs(x + part * (whole[:, 0] - x) - s.x[chosen + 1]), late)
        / case.allowed[chosen, 0]
    )
    ends = np.abs(s.v[chosen + 1] - speed) <= case.near[chosen + 1]
    left = np.fmin(left, np.where(ends & np.isfinite(off), off, np.inf))
    fits = left <= case.limits()[chosen]
    share = float(np.mean(fits)) * every / int(np.sum(case.wrong))
    if np.sum(fits) >= 2 or np.all(fits):
        evidence = f"that repeats {int(np.sum(fits))} of {len(chosen)} wrong steps in which a flight meets a belt"
        words = "events are located by linear interpolation of v over a step"
        yield Diagnosis("event interpolation", "", words, evidence, share=share)


def _first_events(case: Case, usable: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Return at most MOST_DELAYS wrong steps with events, the row of each first event, and how many steps there are.

    `usable` marks the steps that may be taken.
    """
    steps = np.unique(case.steps.events.step)
    steps = steps[case.wrong[steps] & usable[steps]]
    chosen = case.thinned(steps, MOST_DELAYS)
    return chosen, np.searchsorted(case.steps.events.step, chosen), len(steps)
