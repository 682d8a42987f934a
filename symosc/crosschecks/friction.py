"""Faults at the belts as causes: smoothed friction, static friction or its curve missing, and drift
in sticks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise, product
from math import atan, cos, pi, sqrt, tanh
from typing import NamedTuple

import numpy as np

from symosc.belts import Belt
from symosc.crosschecks.causes import Diagnosis, Explanation, FaultySteps, fitted, larger
from symosc.crosschecks.models import rounded
from symosc.engine.state import ON_BELT, SLIP
from symosc.kernels._generated import acceleration
from symosc.model import Oscillator
from symosc.simulation.tables import counted

#: Curves f(z) that replace sign(z), z = (v - v_belt)/width.
CURVES: dict[str, Callable[[float], float]] = {
    "tanh": tanh,
    "arctan": lambda z: atan(z) * (2.0 / pi),
    "z/sqrt(1 + z^2)": lambda z: z / sqrt(1.0 + z * z),
}
# Widths that are tried, in units of the distance of the belts; a wider curve is no smoothed sign.
WIDTHS = np.geomspace(1e-6, 3.0, 14)
# Steps to which a width, or a rate of drift, is fitted first, the digits of the fit, and the part by
# which the widths of these steps may differ.
FITTED_STEPS = 3
WIDTH_DIGITS = 1e-9
SAME_WIDTH = 0.01
# Newton steps to the time at which friction gives way.
SLIP_ROUNDS = 2
# Right steps with a stick on which drift is tried beside the wrong ones.
MOST_RIGHT = 60


# -- smoothed friction -----------------------------------------------------------------------------


def smoothed(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis of smoothed friction: a curve in place of the sign explains the steps."""
    steps = case.telling
    largest = steps[np.argsort(-case.sizes[steps])[:FITTED_STEPS]]
    for name, curve in CURVES.items():
        fitted_widths = [_width(case, i, curve) for i in largest.tolist()]
        known = np.array([width is not None for width in fitted_widths])
        if not known.any():
            continue
        widths = np.array([width for width in fitted_widths if width is not None])
        width = float(widths[0])
        # A defect that is hardly larger than the allowed one shows the width less well.
        apart = SAME_WIDTH + 0.5 / case.sizes[largest[known]]
        if np.any(np.abs(widths - width) > apart * width):
            continue
        spread = float(np.ptp(widths))
        sizes = larger(case.integrated(_smoothed_force(case, width, curve), steps))
        fits = int(np.sum(sizes <= case.limits()[steps]))
        error = max(spread, WIDTH_DIGITS * width)
        law = f"{name}((v - v_belt)/{rounded(width, error)})"
        words = f"friction is smoothed: like {law} in place of a sign"
        over = counted(len(steps), "step")
        evidence = f"the equation with it, integrated over {over}, explains {fits} of them"
        diagnosis = Diagnosis("smoothed friction", name, words, evidence, width, error)
        yield Explanation(diagnosis, left=case.leaving(sizes, steps))


def _smoothed_force(
    case: FaultySteps, width: float, curve: Callable[[float], float]
) -> Callable[[float, float, float], float]:
    """Return the acceleration with friction of a curve of the given width."""
    K = case.steps.K
    without_friction = 0.5 * (K.A1 + K.A3)

    def force(x: float, v: float, phase: float) -> float:
        """Return the acceleration: J is the jump at a belt, from plus to minus its friction."""
        jump_1 = K.belt1.J * curve((v - K.belt1.v) / width)
        jump_2 = K.belt2.J * curve((v - K.belt2.v) / width)
        A = without_friction - 0.5 * (jump_1 + jump_2)
        return float(acceleration(x, v, cos(phase), A, K.cm, K.w0sq, K.f0))

    return force


def _width(case: FaultySteps, i: int, curve: Callable[[float], float]) -> float | None:
    """Return the width of a curve with which step `i` is right; None if there is none."""
    from scipy.optimize import brentq

    step = np.array([i])
    defect = case.steps.defects[i] / case.allowed[i]

    def left(log_width: float) -> float:
        """Return which part of the defect is left with a curve of this width."""
        force = _smoothed_force(case, float(np.exp(log_width)), curve)
        (miss,) = case.integrated(force, step)
        return float(miss @ defect / (defect @ defect))

    # The wider the curve, the larger its effect: 1 is left with a narrow one, and less than 0 with
    # one that is too wide.
    v1, v2 = case.steps.belts
    logs = np.log(WIDTHS * float(v2 - v1)).tolist()
    left_before = left(logs[0])
    for before, after in pairwise(logs):
        left_after = left(after)
        if left_before > 0.0 >= left_after:
            return float(np.exp(brentq(left, before, after, xtol=WIDTH_DIGITS)))
        left_before = left_after
    return None


# -- missing static friction -----------------------------------------------------------------------


def without_static(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that belts hold the mass with their kinetic friction alone."""
    p = case.parameters
    if not isinstance(p, Oscillator) or p.contracts:
        return
    kinetic = p.replace(**{f"mu_s{n}": belt.mu for n, belt in enumerate(p.belts, 1)})
    left = case.left_with(kinetic)
    if left is not None:
        words = (
            "static friction is missing: belts hold the mass only up to mu FN, as with mu_s = mu"
        )
        found = Diagnosis("static friction", "mu_s", words, "")
        yield Explanation(found, "with mu_s = mu", parameters=kinetic, left=left)


# -- a missing curve -------------------------------------------------------------------------------


def without_curve(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that friction does not depend on the speed although the law's does: that
    at the belt's speed, or that at large speeds, is taken for all.
    """
    p = case.parameters
    if not isinstance(p, Oscillator) or not any(belt.curve for belt in p.belts):
        return
    seen = {p}
    for place, which in (("at the belt's speed", 0), ("at the end of the curve", -1)):
        belts = []
        coefficients = []
        for number, belt in enumerate(p.belts, 1):
            if not belt.curve:
                belts.append(belt)
                continue
            _, mu = belt.curve[which]
            coefficients.append(f"mu{number} = {float(mu):.10g}")
            belts.append(Belt(belt.v, mu=mu, mu_s=max(belt.mu_s, mu)))
        constant = p.replace(belts=belts)
        left = None if constant in seen else case.left_with(constant)
        seen.add(constant)
        if left is not None:
            values = ", ".join(coefficients)
            words = (
                f"friction does not depend on the speed: {values} everywhere, which is that {place}"
            )
            found = Diagnosis("friction curve", "mu", words, "")
            yield Explanation(found, f"with {values} constant", parameters=constant, left=left)


# -- drift in sticks -------------------------------------------------------------------------------


class StickSteps(NamedTuple):
    """Steps with a stick, as columns: step, belt, time and state where the stick begins or goes on,
    and the time of its end.
    """

    # In a step that ends while the mass still sticks, `end` is the end of the step.

    step: np.ndarray
    boundary: np.ndarray
    begin: np.ndarray
    x: np.ndarray
    v: np.ndarray
    end: np.ndarray


def drift(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis of a velocity that drifts off the belt in sticks, at one rate."""
    sticks = _find_sticks(case)
    if sticks is None:
        return
    steps, numbers = np.unique(sticks.step, return_inverse=True)
    wrong = case.wrong[steps]

    def by_way(rate: float) -> np.ndarray:
        ways = product((0, 1), (False, True))
        return np.stack([_misses_with_drift(case, sticks, rate, *way) for way in ways])

    def misses(rate: np.ndarray) -> np.ndarray:
        rows = by_way(float(rate[0]))
        # Of the four ways of each step the one that misses least counts.
        step_numbers = np.tile(numbers, len(rows))
        rows = rows.reshape(-1, 2)
        order = np.lexsort((larger(rows), step_numbers))
        return rows[order[np.unique(step_numbers[order], return_index=True)[1]]]

    # Without drift all ways are alike. The rates that the largest defects ask for, each in one way,
    # show near which of them to fit.
    tick = 1e-6 * float(case.scales[1])
    slopes = (by_way(tick) - by_way(-tick)) / (2.0 * tick)
    asked = -np.sum(slopes * by_way(0.0), axis=2) / np.sum(slopes * slopes, axis=2)
    largest = steps[wrong][np.argsort(-case.sizes[steps[wrong]])[:FITTED_STEPS]]
    rates = asked[:, np.isin(sticks.step, largest)].ravel()
    starts = [
        (float(np.median(larger(misses(np.array([rate])))[wrong])), rate)
        for rate in rates[np.isfinite(rates)].tolist()
    ]
    if not starts:
        return
    start = np.array([min(starts)[1]])
    fit = fitted(lambda rate: misses(rate)[wrong], start, np.array([tick]))
    if fit is None:
        return
    rate = float(fit.value[0])
    error = float(fit.error[0])
    left = case.leaving(case.sizes[case.telling], case.telling)
    left[steps] = larger(misses(fit.value))
    count = int(np.sum((left <= case.limits())[steps[wrong]]))
    words = f"in sticks v drifts off the belt, by {rounded(rate, error)} per unit of time"
    evidence = (
        f"this rate explains {count} of {counted(int(np.sum(wrong)), 'wrong step')} with a stick"
    )
    yield Explanation(Diagnosis("drift", "", words, evidence, rate, error), left=left)


def _find_sticks(case: FaultySteps) -> StickSteps | None:
    """Return the telling steps with a stick, and some right ones; None if no wrong step has one."""
    s = case.steps
    # Steps in which the exact motion sticks at the start, at the end, or in between.
    at_ends = np.flatnonzero((s.first > ON_BELT) | (s.last > ON_BELT))
    stuck = np.union1d(at_ends, s.events.step[s.events.target > ON_BELT])
    stuck = stuck[np.diff(s.t)[stuck] > 0.0]
    wrong = np.intersect1d(stuck, case.telling)
    right = case.thinned(stuck[~case.wrong[stuck]], MOST_RIGHT)
    rows = list[tuple[float, ...]]()
    for i in np.union1d(wrong, right).tolist():
        in_step = s.events.rows(i, i)
        times = s.events.t[in_step]
        targets = s.events.target[in_step]
        belts = s.events.boundary[in_step]
        slips = np.flatnonzero(s.events.kind[in_step] == SLIP)
        if len(slips):
            end = float(times[slips[0]])
        else:
            end = float(s.t[i + 1])
        onsets = np.flatnonzero(targets > ON_BELT)
        if s.first[i] > ON_BELT:
            rows.append((i, int(s.first[i]) - ON_BELT, s.t[i], s.x[i], s.v[i], end))
        elif len(onsets):
            k = int(onsets[0])
            belt = int(belts[k])
            # Off the belt, the sample may be of a stick that goes on, or of a flight to the belt.
            rows.append((i, belt, s.t[i], s.x[i], s.v[i], end))
            rows.append((i, belt, times[k], s.events.x[in_step][k], s.belts[belt - 1], end))
    if not rows or not len(wrong):
        return None
    step, boundary, *others = np.array(rows).T
    return StickSteps(step.astype(int), boundary.astype(int), *others)


def _misses_with_drift(
    case: FaultySteps, sticks: StickSteps, rate: float, side: int, onto: bool
) -> np.ndarray:
    """Return by how much the ends of steps are missed if v drifts off the belt at a `rate` in
    sticks.

    Sticks that end in the step are followed by a flight below the belt (`side` 0) or above it (1).
    It begins with the velocity as it has drifted, or with that of the belt (`onto`).
    """
    s = case.steps
    K = case.steps.K
    speed = s.belts[sticks.boundary - 1]
    domain = sticks.boundary + side
    step_end = s.t[sticks.step + 1]
    time_left = step_end - sticks.begin
    time = sticks.end - sticks.begin  # in the stick
    ends = sticks.end < step_end
    A = np.take([K.A1, K.A2, K.A3], domain - 1)
    theta = s.theta[sticks.step] + K.Om * (sticks.begin - s.t[sticks.step])
    longest = 0.1 * (step_end - s.t[sticks.step])
    # Where the mass is elsewhere, the friction gives way at another time, perhaps just before the end
    # of a step in which it would have held.
    for _ in range(SLIP_ROUNDS):
        x = sticks.x + sticks.v * time + 0.5 * rate * time**2
        push = acceleration(x, speed, np.cos(theta + K.Om * time), A, K.cm, K.w0sq, K.f0)
        slope = -K.w0sq * speed - K.f0 * K.Om * np.sin(theta + K.Om * time)
        gives_way = push > 0.0 if side else push < 0.0
        is_slip = (ends | gives_way) & (slope != 0.0)
        shift = np.where(is_slip, -push / np.where(slope != 0.0, slope, 1.0), 0.0)
        moved = np.where(np.abs(shift) <= longest, np.clip(time + shift, 0.0, time_left), time)
        ends = ends | (moved < time_left)
        time = moved
    x = sticks.x + sticks.v * time + 0.5 * rate * time**2
    v = sticks.v + rate * time
    launch_v = speed if onto else v
    after = s.fly(domain, x, launch_v, theta + K.Om * time, time_left - time)
    return case.misses(np.where(ends[:, None], after, np.column_stack([x, v])), sticks.step)
