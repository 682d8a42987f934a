"""Whether events are at the wrong times: double roots that are missed, events that are seen late."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues
from symosc.engine.state import SLIP

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
    if np.all(s.events.kind[rows][fits] == SLIP):
        return  # sticks that end late are a matter of their own
    share = float(np.sum(fits)) / len(chosen) * len(wrong[has]) / len(wrong)
    room = s.t[chosen + 1] - s.events.t[rows]
    unseen = fits & (delay >= 0.999 * room) & (clues.label[chosen + 1] == s.first[chosen])
    mean, spread, largest = float(np.mean(delay[fits])), float(np.std(delay[fits])), float(np.max(delay[fits]))
    if 2 * np.sum(unseen) > np.sum(fits):
        words = f"belts are met and left within a step, and that is not seen ({int(np.sum(unseen))} times)"
        yield Diagnosis("double root", "", words, "without these contacts the steps are right", share=share)
        return
    evidence = f"{int(np.sum(fits))} events are late by {mean:.3g} on average (spread {spread:.2g})"
    words = f"events are not located: they happen up to {largest:.3g} late, at the end of the solver's step"
    yield Diagnosis("late events", "", words, evidence, mean, spread, share)


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
