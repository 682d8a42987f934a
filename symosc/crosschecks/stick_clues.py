"""Whether sticks end too early or too late, or drift, also where a stick lies within one step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues
from symosc.crosschecks.event_clues import DELAY_GRID, DELAY_LEAVES, DELAY_ZOOMS, MOST_DELAYS
from symosc.crosschecks.friction_clues import SAME_RATE
from symosc.engine.state import SLIP
from symosc.kernels._generated import acceleration
from symosc.model import NEIGHBOURS

# So many sticks are late at one friction, or it is no static friction.
FEWEST_HELD = 3
# What is not too late by this part of the step is not late.
ON_TIME = 1e-6
# A number that differs so little from stick to stick is one number.
ONE_NUMBER = 1e-6
# More than this part of the largest velocity is no drift.
LARGEST_DRIFT = 0.02


@dataclass(frozen=True)
class Sticks:
    """Wrong steps with a stick in them, one a row, and where it is.

    Attributes
    ----------
    step, boundary : int arrays
    begin, x : arrays
        Time and place at which it begins, within the step.
    end : array
        Its exact end, or that of the step.
    """

    step: np.ndarray
    boundary: np.ndarray
    begin: np.ndarray
    x: np.ndarray
    end: np.ndarray


def find_sticks(clues: Clues) -> Sticks | None:
    """Return the wrong steps that end in a flight after a stick, for the samples; None if there is none."""
    s, rows = clues.steps, []
    for i in clues.some(np.flatnonzero(clues.wrong & (clues.label[1:] > 0)), MOST_DELAYS).tolist():
        part = s.events.rows(i, i)
        kinds, times, targets = s.events.kind[part], s.events.t[part], s.events.target[part]
        slips, onsets = np.flatnonzero(kinds == SLIP), np.flatnonzero(targets > 3)
        end = float(times[slips[0]]) if len(slips) else float(s.t[i + 1])
        if s.first[i] > 3:
            boundary, begin, x = int(s.first[i]) - 3, float(s.t[i]), float(s.x[i])
        elif clues.label[i] == 0:  # the samples stick, the exact motion has left by now
            boundary, begin, x = int(_nearest_belt(clues, np.array([i]))[0]), float(s.t[i]), float(s.x[i])
            end = begin
        elif len(onsets):
            k = int(onsets[0])
            boundary, begin, x = int(targets[k]) - 3, float(times[k]), float(s.events.x[part][k])
        else:
            continue
        rows.append((i, boundary, begin, x, end))
    if not rows:
        return None
    table = np.array(rows)
    return Sticks(table[:, 0].astype(int), table[:, 1].astype(int), *table[:, 2:].T)


def _nearest_belt(clues: Clues, samples: np.ndarray) -> np.ndarray:
    v, K = clues.steps.v[samples], clues.steps.K
    return np.where(np.abs(v - K.belt1.v) <= np.abs(v - K.belt2.v), 1, 2)


def _kept_on(clues: Clues, steps: np.ndarray) -> np.ndarray:
    """Return which of the steps go on with a belt from beginning to end."""
    s = clues.steps
    speed = np.array([s.K.belt1.v, s.K.belt2.v])[_nearest_belt(clues, steps) - 1]
    x = s.x[steps] + speed * (s.t[steps + 1] - s.t[steps])
    misses = np.column_stack([x - s.x[steps + 1], speed - s.v[steps + 1]]) / clues.allowed[steps]
    return np.asarray((np.max(np.abs(misses), axis=1) <= clues.limits()[steps]) & (clues.label[steps] == 0))


def stick_ends(clues: Clues) -> Iterator[Diagnosis]:
    """Yield sticks that end too early or too late: then a flight with one force begins, without a cause."""
    sticks, total = find_sticks(clues), int(np.sum(clues.wrong))
    if sticks is None:
        yield from _kept_too_long(clues)
        return
    s, there = clues.steps, sticks.step
    early = _best_exit(clues, sticks, sticks.begin, sticks.end)
    late = _best_exit(clues, sticks, sticks.end, s.t[there + 1])
    is_late = late[1] < early[1]
    time, leaves = np.where(is_late, late[0], early[0]), np.where(is_late, late[1], early[1])
    fits = leaves <= clues.limits(DELAY_LEAVES)[there]
    fits &= np.abs(time - sticks.end) > ON_TIME * (s.t[there + 1] - s.t[there])
    if not np.any(fits):
        yield from _kept_too_long(clues)
        return
    rest = np.setdiff1d(np.flatnonzero(clues.wrong), there[fits])
    count, lasting = int(np.sum(fits)), time[fits] - sticks.end[fits]
    if 2 * np.sum(is_late[fits]) > count:
        held = _friction(clues, sticks, time)[fits & is_late]
        evidence = f"{count} sticks are late by {float(np.mean(lasting)):.3g} on average"
        yield _late(held, evidence, (count + int(np.sum(_kept_on(clues, rest)))) / total)
        return
    share = (count + _flights_without_cause(clues, rest)) / total
    words = f"sticks are left while the belt still holds, first at t = {float(time[fits][0]):.8g}"
    evidence = f"{count} sticks end up to {float(np.max(-lasting)):.3g} too early; flights without a cause follow"
    yield Diagnosis("stick left early", "", words, evidence, share=share)


def _kept_too_long(clues: Clues) -> Iterator[Diagnosis]:
    """Yield sticks that end too late, where the samples show their ends: only steps on the belt are wrong."""
    s, wrong = clues.steps, np.flatnonzero(clues.wrong)
    on = wrong[(clues.label[wrong] == 0) & (s.last[wrong] <= 3)]
    on = on[_kept_on(clues, on)]
    if len(on):
        ends = on[np.diff(on, append=-1) != 1] + 1
        zero = np.zeros(len(ends))
        sticks = Sticks(np.minimum(ends, len(s.first) - 1), _nearest_belt(clues, ends), s.t[ends],
                        s.x[ends], zero)  # fmt: skip
        evidence = f"{len(on)} steps go on with the belt where it does not hold any more"
        held = _friction(clues, sticks, s.t[ends])
        if np.median(held) > 1.0:
            yield _late(held, evidence, len(on) / len(wrong))


def _flights_without_cause(clues: Clues, steps: np.ndarray) -> int:
    """Return how many of the steps are flights with the force of one domain, be it the right one or not."""
    if not len(steps):
        return 0
    s = clues.steps
    misses = np.array([s.flight(d, steps, steps + 1) for d in (1, 2, 3)]) - np.column_stack([s.x, s.v])[steps + 1]
    left = np.min(np.max(np.abs(misses / clues.allowed[steps]), axis=2), axis=0)
    return int(np.sum(left <= clues.limits()[steps]))


def _late(held: np.ndarray, evidence: str, share: float) -> Diagnosis:
    """Return sticks that are left too late, with the friction at which they are left."""
    ratio, count = float(np.median(held)), len(held)
    alike = np.abs(held - ratio) <= SAME_RATE * abs(ratio - 1.0) + ONE_NUMBER
    if count >= FEWEST_HELD and 2 * np.sum(alike) < count:
        words = "events are not located: sticks end late, each by another friction, at the end of the solver's step"
        return Diagnosis("late events", "", words, evidence, share=share)
    error = float(np.std(held) / np.sqrt(count)) if count > 1 else 0.01 * abs(ratio)
    words = f"sticks are left too late: they hold up to {ratio:.4g} times the friction (static friction?)"
    evidence = f"{evidence}; friction there {ratio:.4g} ± {error:.1g} times the limit"
    return Diagnosis("stick left late", "", words, evidence, ratio, error, share)


def _friction(clues: Clues, sticks: Sticks, time: np.ndarray) -> np.ndarray:
    """Return which part of the friction each stick needs at a time."""
    K = clues.steps.K
    speed, jump = (np.array(pair)[sticks.boundary - 1] for pair in ((K.belt1.v, K.belt2.v), (K.belt1.J, K.belt2.J)))
    x = sticks.x + speed * (time - sticks.begin)
    A = np.array([K.A1, K.A2, K.A3])
    below, above = np.array([NEIGHBOURS[b] for b in (1, 2)])[sticks.boundary - 1].T
    mean, theta = 0.5 * (A[below - 1] + A[above - 1]), _phase(clues, sticks.step, time)
    push = acceleration(x, speed, np.cos(theta), mean, K.cm, K.w0sq, K.f0)
    return np.asarray(np.abs(push) / (0.5 * jump))


def _phase(clues: Clues, step: np.ndarray, time: np.ndarray) -> np.ndarray:
    s = clues.steps
    return np.asarray(s.theta[step] + s.K.Om * (time - s.t[step]))


def _left_at(
    clues: Clues,
    sticks: Sticks,
    time: np.ndarray,
    side: int,
    dx: np.ndarray | float = 0.0,
    dv: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Return what steps miss if their stick is left at a time, with a flight below (0) or above (1) it."""
    s = clues.steps
    speed = np.array([s.K.belt1.v, s.K.belt2.v])[sticks.boundary - 1]
    even, ends = np.arange(0, 2 * len(time), 2), sticks.step + 1
    path = replace(
        s,
        t=np.column_stack([time, s.t[ends]]).ravel(),
        x=np.repeat(sticks.x + speed * (time - sticks.begin) + dx, 2),
        v=np.repeat(speed + dv, 2),
        theta=np.repeat(_phase(clues, sticks.step, time), 2),
    )
    there = path.flight(sticks.boundary + side, even, even + 1)
    return np.asarray((there - np.column_stack([s.x, s.v])[ends]) / clues.allowed[sticks.step])


def _best_exit(clues: Clues, sticks: Sticks, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the time between two limits at which a stick that ends there fits best, and what that leaves."""
    best, leaves = low.copy(), np.full(len(low), np.inf)
    begin, end = low, high
    for _ in range(DELAY_ZOOMS):
        for part in np.linspace(0.0, 1.0, 2 * DELAY_GRID):
            tried = begin + part * (end - begin)
            for side in (0, 1):
                left = np.max(np.abs(_left_at(clues, sticks, tried, side)), axis=1)
                better = left < leaves
                best, leaves = np.where(better, tried, best), np.where(better, left, leaves)
        width = (end - begin) / (2 * DELAY_GRID - 1)
        begin, end = np.maximum(best - width, low), np.minimum(best + width, high)
    return best, leaves


def drift_within_steps(clues: Clues) -> Iterator[Diagnosis]:
    """Yield a velocity that drifts off the belt in sticks within one step: it shows in what follows."""
    sticks = find_sticks(clues)
    if sticks is None:
        return
    T = sticks.end - sticks.begin
    best, leaves = np.zeros(len(T)), np.full(len(T), np.inf)
    unit = clues.scales[1] / np.maximum(T, 1e-300) * 1e-6
    for side in (0, 1):
        base = _left_at(clues, sticks, sticks.end, side)
        slope = (_left_at(clues, sticks, sticks.end, side, 0.5 * unit * T * T, unit * T) - base) / unit[:, None]
        rate = -np.sum(slope * base, axis=1) / np.maximum(np.sum(slope * slope, axis=1), 1e-300)
        left = np.max(np.abs(base + slope * rate[:, None]), axis=1)
        best, leaves = np.where(left < leaves, rate, best), np.minimum(left, leaves)
    fits = (leaves <= clues.limits(0.1)[sticks.step]) & (np.abs(best) * T <= LARGEST_DRIFT * clues.scales[1])
    if not np.any(fits):
        return
    rate = float(np.median(best[fits]))
    spread = 1.4826 * float(np.median(np.abs(best[fits] - rate)))
    if spread <= SAME_RATE * abs(rate):
        # One number for all sticks says more than an end for each.
        surely = 0.01 if spread <= ONE_NUMBER * abs(rate) else 0.0
        share = surely + float(np.sum(fits)) / int(np.sum(clues.wrong))
        words = f"in a stick v drifts off the belt, by {rate:.3g} per unit of time"
        evidence = f"one rate explains what follows {int(np.sum(fits))} sticks"
        yield Diagnosis("drift", "", words, evidence, rate, spread if np.sum(fits) > 1 else None, share)
