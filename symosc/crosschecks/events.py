"""Switching events that samples show, and how they fit the exact ones."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from symosc.crosschecks.steps import ExactSteps
from symosc.engine.events import KIND_NAMES
from symosc.model import MODE_NAMES

CODES = {name: code for code, name in KIND_NAMES.items()}
# An event of the samples belongs to an exact one that is at most this part of the forcing period away.
WINDOW = 0.05
# A contact of the samples with a belt is a stick if they keep to it for this part of the period.
SHORTEST_STICK = 1e-9


@dataclass(frozen=True)
class FoundEvent:
    """An event of the samples.

    Attributes
    ----------
    t : float
        Estimated time. If the exact motion over the step has the event, it is the time there; else it is read off
        the samples.
    kind : str
        "cross", "stick", "slip" or "graze".
    boundary : int
        1 or 2; 0 if the event was given without one.
    source, target : str
        Modes before and after; "" if given without.
    step : int
        The event is between samples `step` and `last_step` + 1.
    last_step : int
    spread : float
        How far `t` may be wrong because it is read off the samples.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> event = crosscheck("fig5", t, x, v, events=[(2, "cross")]).invented[0]
    >>> event.kind, event.t
    ('cross', 2.0)
    """

    t: float
    kind: str
    boundary: int
    source: str
    target: str
    step: int
    last_step: int
    spread: float = 0.0


def labels(steps: ExactSteps, near: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """Return the mode code of each sample: 1 to 3 in a domain, 4 or 5 at a belt.

    At a belt is what is within `near` of it, and what is within `drift` while the exact motion would stick; both are
    velocities, one for each sample.
    """
    v, K = steps.v, steps.K
    label = np.int8(1) + (v > K.belt1.v) + (v > K.belt2.v)
    for boundary, belt in ((1, K.belt1), (2, K.belt2)):
        gap = np.abs(v - belt.v)
        sticks = steps.last == 3 + boundary
        held = np.append(sticks, False) | np.append(False, sticks)
        label[(gap <= near) | ((gap <= drift) & held)] = 3 + boundary
    return label


def find_events(steps: ExactSteps, label: np.ndarray, wrong: np.ndarray) -> tuple[list[FoundEvent], np.ndarray]:
    """Return the events that the labels of the samples show, in order of time, and the modes of the samples.

    `wrong` tells which steps are wrong. The modes are the labels, 0 for samples that only pass or touch a belt.
    """
    modes = label.copy()
    starts = np.flatnonzero((np.diff(label, prepend=0) != 0) | _flown(steps, label, wrong))
    ends = np.append(starts[1:], len(label)) - 1
    found: list[FoundEvent] = []
    now, left = 0, 0  # what the samples did last, and the last sample that did it

    def go(domain: int, sample: int) -> None:
        """Go from there to a domain, which the samples have reached at `sample`."""
        nonlocal now
        if now > 3:
            entered = min((now - 3, now - 2), key=lambda d: abs(d - domain))
            found.append(_event(steps, "slip", now - 3, now, entered, left, left, left))
            now = entered
        if now:
            found.extend(_crossings(steps, now, domain, left, sample))
        now = domain

    for first, last in zip(starts.tolist(), ends.tolist(), strict=True):
        mode = int(label[first])
        if mode <= 3:
            go(mode, first)
        elif _is_stick(steps, mode, first, last, wrong):
            if now:
                before = now - 2.5 if now > 3 else now
                go(min((mode - 3, mode - 2), key=lambda d: abs(d - before)), first)
                found.append(_event(steps, "stick", mode - 3, now, mode, first - 1, first, first))
            now = mode
        else:
            modes[first : last + 1] = 0
            if last == len(wrong) or wrong[last] or (first and wrong[first - 1]):
                continue
            # Where the steps are right, the exact motion tells what happens at the contact.
            source, target = int(steps.last[first - 1]), int(steps.first[last])
            if not now:  # a start on the belt is not an event
                source = now = target
            if {source, target} == {mode - 3, mode - 2}:
                go(source, first)
                found.append(_event(steps, "cross", mode - 3, source, target, first - 1, last, first))
                now = target
            elif now > 3 or target != now:
                continue
        left = last
    return found, modes


def _flown(steps: ExactSteps, label: np.ndarray, wrong: np.ndarray) -> np.ndarray:
    """Tell which samples at a belt were reached from one at the same belt by a flight, in a step that is right."""
    held = (steps.first == label[:-1]) | (steps.last == label[:-1])
    for i in np.flatnonzero((label[:-1] > 3) & ~held).tolist():
        held[i] = bool(np.any(steps.events.target[steps.events.rows(i, i)] == label[i]))
    flown = (label[:-1] > 3) & (label[1:] == label[:-1]) & ~held & ~wrong & (np.diff(steps.t) > 0.0)
    return np.append(False, flown)


def _is_stick(steps: ExactSteps, mode: int, first: int, last: int, wrong: np.ndarray) -> bool:
    """Tell whether samples first … last at a belt stick to it, in place of only passing or touching it."""
    inside = np.arange(first, min(last, len(wrong) - 1) + 1)
    sticks = (steps.first[inside] == mode) | (steps.last[inside] == mode)
    for i in inside[~sticks].tolist():
        rows = steps.events.rows(i, i)
        sticks[i - first] = bool(np.any(steps.events.target[rows] == mode))
    # Where a step is wrong the samples decide: two at the belt are on it, the last one has left it.
    held = np.where(wrong[inside], inside < last, sticks)
    duration = float(np.sum(np.diff(steps.t)[inside[held]]))
    return duration >= SHORTEST_STICK * steps.K.period


def _crossings(steps: ExactSteps, source: int, target: int, before: int, after: int) -> list[FoundEvent]:
    """Return the crossings on the way from one domain to another between two samples."""
    way = 1 if target > source else -1
    route = list(range(source, target + way, way)) if source != target else []
    return [_event(steps, "cross", min(a, b), a, b, before, after - 1, None) for a, b in pairwise(route)]


def _event(
    steps: ExactSteps,
    kind: str,
    boundary: int,
    source: int,
    target: int,
    step: int,
    last_step: int,
    sample: int | None,
) -> FoundEvent:
    last_step = min(last_step, len(steps.first) - 1)
    rows = steps.events.rows(step, last_step)
    same = (steps.events.kind[rows] == CODES[kind]) & (steps.events.boundary[rows] == boundary)
    times = steps.events.t[rows][same]
    spread = 0.0 if len(times) else float(steps.t[last_step + 1] - steps.t[step])
    if len(times):
        time = float(times[0])
    elif sample is not None:
        time = float(steps.t[sample])
    else:
        i, j = step, last_step + 1
        gaps = steps.v[i : j + 1] - (steps.K.belt1.v if boundary == 1 else steps.K.belt2.v)
        nearest = i + int(np.argmin(np.abs(gaps)))
        part = gaps[0] / (gaps[0] - gaps[-1]) if gaps[0] * gaps[-1] < 0.0 else 0.5
        between = steps.t[i] + part * (steps.t[j] - steps.t[i])
        time = float(steps.t[nearest] if i < nearest < j else between)
    return FoundEvent(time, kind, boundary, MODE_NAMES[source], MODE_NAMES[target], step, last_step, spread)


def given_events(steps: ExactSteps, pairs: Iterable[tuple[float, str]]) -> list[FoundEvent]:
    """Return given pairs (t, kind) as events of the samples."""
    last = len(steps.first) - 1
    found = []
    for time, kind in pairs:
        step = min(max(int(np.searchsorted(steps.t, time, "right")) - 1, 0), last)
        found.append(FoundEvent(time, kind, 0, "", "", step, step))
    return found
