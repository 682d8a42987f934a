"""Whether events are at the wrong times: double roots that are missed, events that are seen late."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import SURE, Clues
from symosc.engine.state import SLIP

# Steps with events that are looked at.
MOST_DELAYS = 60
# The delay is searched on a grid of this many points, which is made finer so many times.
DELAY_GRID, DELAY_ZOOMS = 9, 8
# A delay explains a step if it leaves this part of the defect. Too early and too late differ by little.
DELAY_LEAVES = 0.005


def double_roots(clues: Clues) -> Iterator[Diagnosis]:
    """Yield belts met within one step, which signs at its ends do not show: the samples keep to their domain."""
    s = clues.steps
    source, target = clues.label[:-1], clues.label[1:]
    there = clues.wrong & (source > 0) & (source == target) & (s.first == source)
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
        words = f"a belt is met within one step, and that is not seen ({count} times)"
        right = int(np.sum(np.max(np.abs(kept / clues.allowed[chosen]), axis=1) <= 1.0))
        evidence = (
            f"the first time at t = {low:.8g} to {high:.8g}; without the contacts {right} of these steps are right"
        )
        total = int(np.sum(clues.wrong))
        yield Diagnosis("double root", "", words, evidence, share=SURE if right == total else count / total)


def delays(clues: Clues) -> Iterator[Diagnosis]:
    """Yield events that happen later than they should, with the mean delay."""
    s = clues.steps
    any_step = np.ones(len(s.first), bool)
    chosen, rows = _first_events(clues, any_step)
    if not len(chosen):
        return
    delay, leaves = _best_delays(clues, chosen, rows)
    fits = leaves <= clues.limits(DELAY_LEAVES)[chosen]
    if not np.any(fits):
        return
    if np.all(s.events.kind[rows][fits] == SLIP):
        return  # sticks that end late are a matter of their own
    share = float(np.mean(fits)) * len(_with_events(clues, any_step)) / int(np.sum(clues.wrong))
    room = s.t[chosen + 1] - s.events.t[rows]
    unseen = fits & (delay >= 0.999 * room) & (clues.label[chosen + 1] == s.first[chosen])
    mean, spread, largest = float(np.mean(delay[fits])), float(np.std(delay[fits])), float(np.max(delay[fits]))
    if 2 * np.sum(unseen) > np.sum(fits):
        words = f"belts are met and left within a step, and that is not seen ({int(np.sum(unseen))} times)"
        yield Diagnosis(
            "double root", "", words, f"the force before them repeats {int(np.sum(unseen))} steps", share=share
        )
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


def interpolated(clues: Clues) -> Iterator[Diagnosis]:
    """Yield events located on the straight line between the ends of a step, from which the flight goes on."""
    s = clues.steps
    chosen, rows = _first_events(clues, s.first <= 3)
    if not len(chosen):
        return
    speed = np.array([s.K.belt1.v, s.K.belt2.v])[s.events.boundary[rows] - 1]
    whole = s.flight(s.first[chosen], chosen, chosen + 1)
    part = (speed - s.v[chosen]) / (whole[:, 1] - s.v[chosen])
    time = s.t[chosen] + part * (s.t[chosen + 1] - s.t[chosen])
    good = np.isfinite(part) & (part >= 0.0) & (part <= 1.0)
    if not np.any(good):
        return
    at_line = s.x[chosen] + part * (whole[:, 0] - s.x[chosen])
    twice = np.repeat(chosen, 2)
    pairs = np.column_stack([s.t[chosen], np.where(good, time, s.t[chosen + 1])]).ravel()
    path = replace(s, t=pairs, x=s.x[twice], v=s.v[twice], theta=s.theta[twice])
    even = np.arange(0, len(pairs), 2)
    at_flight = path.flight(s.first[chosen], even, even + 1)[:, 0]
    left = np.full(len(chosen), np.inf)
    for x in (at_line, at_flight):
        begin = np.column_stack([time, x, speed])
        begin[~good] = np.column_stack([s.t, s.x, s.v])[chosen[~good]]
        after = np.max(np.abs(clues.between(begin, chosen + 1, np.zeros(len(chosen))) / clues.allowed[chosen]), axis=1)
        left = np.fmin(left, np.where(good, after, np.inf))
    # Where the samples end with the event, the line from its sample to the end of the solver's step led there.
    left = np.fmin(left, _line_to_sample(clues, chosen, speed))
    fits = left <= clues.limits()[chosen]
    share = float(np.mean(fits)) * len(_with_events(clues, s.first <= 3)) / int(np.sum(clues.wrong))
    if np.sum(fits) >= 2 or np.all(fits):
        evidence = f"that repeats {int(np.sum(fits))} of {len(chosen)} wrong steps in which a flight meets a belt"
        words = "events are located by linear interpolation of v over a step"
        yield Diagnosis("event interpolation", "", words, evidence, share=share)


def _line_to_sample(clues: Clues, chosen: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Return what steps miss that end at the event, on the line from the sample to the end of a usual step."""
    s = clues.steps
    ends = np.abs(s.v[chosen + 1] - speed) <= clues.near[chosen + 1]
    usual = float(np.median(np.diff(s.t)))
    twice = np.repeat(chosen, 2)
    pairs = np.column_stack([s.t[chosen], s.t[chosen] + usual]).ravel()
    path = replace(s, t=pairs, x=s.x[twice], v=s.v[twice], theta=s.theta[twice])
    even = np.arange(0, len(pairs), 2)
    whole = path.flight(s.first[chosen], even, even + 1)
    part = (speed - s.v[chosen]) / (whole[:, 1] - s.v[chosen])
    time = s.t[chosen] + part * usual
    x = s.x[chosen] + part * (whole[:, 0] - s.x[chosen])
    late = np.abs(time - s.t[chosen + 1]) * np.maximum(np.abs(speed), np.abs(s.v[chosen])) / clues.allowed[chosen, 0]
    off = np.maximum(np.abs(x - s.x[chosen + 1]) / clues.allowed[chosen, 0], late)
    return np.where(ends & np.isfinite(off), off, np.inf)


def _with_events(clues: Clues, usable: np.ndarray) -> np.ndarray:
    """Return the wrong steps with an event."""
    steps = np.unique(clues.steps.events.step)
    return np.asarray(steps[clues.wrong[steps] & usable[steps]])


def _first_events(clues: Clues, usable: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return some wrong steps with an event, and the row of the first event of each."""
    chosen = clues.some(_with_events(clues, usable), MOST_DELAYS)
    return chosen, np.searchsorted(clues.steps.events.step, chosen)
