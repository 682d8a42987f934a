"""Whether events are at the wrong times: double roots missed, events seen late, sticks left too early or too late."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues
from symosc.engine.state import SLIP
from symosc.kernels._generated import acceleration
from symosc.model import NEIGHBOURS

# Steps with events that are looked at.
MOST_DELAYS = 60
# The delay is searched on a grid of this many points, which is made finer so many times.
DELAY_GRID, DELAY_ZOOMS = 9, 8
# A delay explains a step if it leaves this part of the defect. Too early and too late differ by little.
DELAY_LEAVES = 0.005


def double_roots(clues: Clues) -> Iterator[Diagnosis]:
    """Yield belts met and left within one step, which signs at its ends do not show."""
    s = clues.steps
    source, target = clues.label[:-1], clues.label[1:]
    there = clues.wrong & (source > 0) & (source == target) & (s.first == source) & (s.last == source)
    there &= np.isin(np.arange(len(there)), s.events.step)
    chosen = np.flatnonzero(there)
    if not len(chosen):
        return
    kept = s.flight(source[chosen], chosen, chosen + 1) - np.column_stack([s.x, s.v])[chosen + 1]
    fits = np.max(np.abs(kept / clues.allowed[chosen]), axis=1) <= clues.limits()[chosen]
    count = int(np.sum(fits))
    if count:
        rows = s.events.rows(int(chosen[fits][0]), int(chosen[fits][0]))
        low, high = float(s.events.t[rows][0]), float(s.events.t[rows][-1])
        words = f"a belt is met and left within one step, and that is not seen ({count} times)"
        evidence = f"the first time at t = {low:.8g} to {high:.8g}; without these contacts the steps are right"
        yield Diagnosis("double root", "", words, evidence, share=count / int(np.sum(clues.wrong)))


def delays(clues: Clues) -> Iterator[Diagnosis]:
    """Yield events that happen later than they should, with the mean delay."""
    s = clues.steps
    wrong = np.flatnonzero(clues.wrong)
    first = np.searchsorted(s.events.step, wrong)
    has = first < len(s.events.step)
    has[has] = s.events.step[first[has]] == wrong[has]
    chosen = clues.some(wrong[has], MOST_DELAYS)
    if not len(chosen):
        return
    rows = np.searchsorted(s.events.step, chosen)
    delay, leaves = _best_delays(clues, chosen, rows)
    fits = leaves <= clues.limits(DELAY_LEAVES)[chosen]
    if not np.any(fits):
        return
    slips = s.events.kind[rows] == SLIP
    share = float(np.sum(fits)) / len(chosen) * len(wrong[has]) / len(wrong)
    mean, spread = float(np.mean(delay[fits])), float(np.std(delay[fits]))
    evidence = f"{int(np.sum(fits))} events are late by {mean:.3g} on average (spread {spread:.2g})"
    others_right = not np.any(~slips & fits) and _has_other_events(clues)
    if others_right:
        yield _left_late(clues, rows[fits], delay[fits], share, evidence)
    else:
        largest = float(np.max(delay[fits]))
        words = f"events are not located: they happen up to {largest:.3g} late, at the end of the solver's step"
        yield Diagnosis("late events", "", words, evidence, mean, spread, share)


def _has_other_events(clues: Clues) -> bool:
    """Return whether right steps hold events that are no slips: a solver that locates these is late on purpose."""
    events = clues.steps.events
    return bool(np.any((events.kind != SLIP) & ~clues.wrong[events.step])) or not np.any(events.kind != SLIP)


def _left_late(clues: Clues, rows: np.ndarray, delay: np.ndarray, share: float, evidence: str) -> Diagnosis:
    """Return sticks that are left too late, with the friction at which they are left."""
    held = np.array([_friction(clues, int(row), float(late)) for row, late in zip(rows, delay, strict=True)])
    ratio, spread = float(np.median(held)), float(np.std(held))
    error = spread / np.sqrt(len(held)) if len(held) > 1 else 0.1 * abs(ratio - 1.0)
    words = f"sticks are left too late: they hold up to {ratio:.4g} times the friction (static friction?)"
    evidence = f"{evidence}; friction there {ratio:.4g} ± {error:.1g} times the limit"
    return Diagnosis("stick left late", "", words, evidence, ratio, error, share)


def _friction(clues: Clues, row: int, late: float) -> float:
    """Return which part of the friction a stick needs some time after its end."""
    s, K = clues.steps, clues.steps.K
    boundary = int(s.events.boundary[row])
    belt, (below, above) = (K.belt1, K.belt2)[boundary - 1], NEIGHBOURS[boundary]
    x, theta = float(s.events.x[row]) + belt.v * late, float(s.events.theta[row]) + K.Om * late
    A = (K.A1, K.A2, K.A3)
    low, high = (float(acceleration(x, belt.v, np.cos(theta), A[d - 1], K.cm, K.w0sq, K.f0)) for d in (below, above))
    return abs(low + high) / belt.J


def _best_delays(clues: Clues, chosen: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the delay of the first event of each step that fits best, and the defect that it leaves."""
    room = clues.steps.t[chosen + 1] - clues.steps.events.t[rows]
    low, high = np.zeros(len(chosen)), np.ones(len(chosen))
    best, leaves = np.ones(len(chosen)), np.full(len(chosen), np.inf)
    for _ in range(DELAY_ZOOMS):
        for part in np.linspace(0.0, 1.0, DELAY_GRID):
            tried = low + part * (high - low)
            left = np.minimum(*(_with_delay(clues, chosen, rows, tried * room, onto) for onto in (False, True)))
            better = left < leaves
            best, leaves = np.where(better, tried, best), np.where(better, left, leaves)
        width = (high - low) / (DELAY_GRID - 1)
        low, high = np.maximum(best - width, 0.0), np.minimum(best + width, 1.0)
        if np.all(leaves <= clues.limits(DELAY_LEAVES)[chosen]):
            break
    return best * room, leaves


def _with_delay(clues: Clues, chosen: np.ndarray, rows: np.ndarray, delay: np.ndarray, onto: bool) -> np.ndarray:
    """Return what steps miss if their first event came later; `onto`: then the velocity is set to the belt's."""
    s = clues.steps
    time = np.minimum(s.events.t[rows] + delay, s.t[chosen + 1])
    source, belts = s.first[chosen], np.array([s.K.belt1.v, s.K.belt2.v])
    speed = belts[s.events.boundary[rows] - 1]
    # To the event as before, a flight on its own or on the belt.
    pairs = np.column_stack([s.t[chosen], time]).ravel()
    twice = np.repeat(chosen, 2)
    path = replace(s, t=pairs, x=s.x[twice], v=s.v[twice], theta=s.theta[twice])
    even = np.arange(0, len(pairs), 2)
    x, v = path.flight(np.minimum(source, 3), even, even + 1).T
    held = source > 3
    x = np.where(held, s.x[chosen] + speed * (time - s.t[chosen]), x)
    v = np.where(held | onto, speed, v)
    begin = np.column_stack([time, x, v])
    after = clues.between(begin, chosen + 1, np.zeros(len(chosen)))
    return np.asarray(np.max(np.abs(after / clues.allowed[chosen]), axis=1))


def left_early(clues: Clues) -> Iterator[Diagnosis]:
    """Yield sticks that end while the belt still holds: a flight with one force begins there."""
    s = clues.steps
    held = clues.wrong & (s.first > 3) & (clues.label[1:] > 0) & (np.diff(s.t) > 0.0)
    begins = np.flatnonzero(held)
    if not len(begins):
        return
    begins = clues.some(begins, MOST_DELAYS)
    part, leaves = _best_exits(clues, begins)
    fits = leaves <= clues.limits(DELAY_LEAVES)[begins]
    # What follows each is a flight with the force of that domain, also on the other side of the belt.
    wrong = np.flatnonzero(clues.wrong & ~held)
    flights = np.array([s.flight(d, wrong, wrong + 1) for d in (1, 2, 3)]) - np.column_stack([s.x, s.v])[wrong + 1]
    left = np.min(np.max(np.abs(flights / clues.allowed[wrong]), axis=2), axis=0)
    follows = left <= clues.limits()[wrong]
    share = float(np.mean(fits) * np.sum(held) + np.sum(follows)) / int(np.sum(clues.wrong))
    if np.any(fits):
        first = int(begins[fits][0])
        time = s.t[first] + part[fits][0] * (s.t[first + 1] - s.t[first])
        words = f"sticks are left while the belt still holds, first at t = {time:.8g}"
        evidence = f"{int(np.sum(fits))} of {len(begins)} such steps are a stick and then a flight without a cause"
        yield Diagnosis("stick left early", "", words, evidence, share=share)


def _best_exits(clues: Clues, begins: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return at which part of the step a flight off the belt begins, if that fits best, and what it leaves."""
    s, belts = clues.steps, np.array([clues.steps.K.belt1.v, clues.steps.K.belt2.v])
    boundary, length = s.first[begins] - 3, s.t[begins + 1] - s.t[begins]
    best, leaves = np.zeros(len(begins)), np.full(len(begins), np.inf)
    low, high = np.zeros(len(begins)), np.ones(len(begins))
    ahead = np.column_stack([s.x, s.v])[begins + 1]
    even = np.arange(0, 2 * len(begins), 2)
    for _ in range(DELAY_ZOOMS):
        for part in np.linspace(0.0, 1.0, 2 * DELAY_GRID):
            tried = low + part * (high - low)
            lead = tried * length
            x, v = s.x[begins] + belts[boundary - 1] * lead, belts[boundary - 1]
            path = replace(
                s, x=np.repeat(x, 2), v=np.repeat(v, 2), theta=np.repeat(s.theta[begins] + s.K.Om * lead, 2),
                t=np.column_stack([s.t[begins] + lead, s.t[begins + 1]]).ravel(),
            )  # fmt: skip
            for side in (0, 1):
                there = path.flight(boundary + side, even, even + 1)
                left = np.max(np.abs((there - ahead) / clues.allowed[begins]), axis=1)
                better = left < leaves
                best, leaves = np.where(better, tried, best), np.where(better, left, leaves)
        width = (high - low) / (2 * DELAY_GRID - 1)
        low, high = np.maximum(best - width, 0.0), np.minimum(best + width, 1.0)
    return best, leaves
