"""The events that samples show, and those of a solver's list."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from symosc.crosschecks.bands import BELT_OF, DOMAIN_CODES, DOMAIN_OF, STICK_CODES
from symosc.crosschecks.steps import ExactSteps
from symosc.engine.events import KIND_NAMES
from symosc.friction import ALL_MODE_NAMES
from symosc.simulation.trajectory import Event

#: The codes of kinds by their names.
CODES = {name: code for code, name in KIND_NAMES.items()}
# An event of the samples belongs to an exact one that is at most this part of the forcing period
# away.
WINDOW = 0.05
# Where events at one belt are too close to be distinguished, a list may have these kinds: for a
# passage to the next domain, or back to where the motion came from, and for a stick that ends and
# begins again.
PASSES = {("cross",), ("stick", "slip")}
RETURNS = {(), ("graze",), ("stick", "slip"), ("cross", "cross")}
STAYS: set[tuple[str, ...]] = {(), ("slip", "stick")}


@dataclass(frozen=True)
class FoundEvent:
    """An event found in the samples.

    Attributes
    ----------
    t : float
        Estimated time. If the exact motion over the step has the event, it is the time there; else
        it is read off the samples.
    kind : str
        "cross", "stick", "slip" or "graze".
    boundary : int
        The number of the belt; 0 if the event was given without one.
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


@dataclass(frozen=True)
class Match:
    """An exact event, and its time in the samples.

    Attributes
    ----------
    event : Event
        The exact one.
    t : float
        Its time in the samples, or in the list of events.
    found : FoundEvent or None
        What the samples show; None for an event inside a step that is right.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> match = crosscheck("fig5", t, x, v).matched[0]
    >>> match.event.kind, f"{match.t:.6f}"
    ('stick', '0.122303')
    """

    event: Event
    t: float
    found: FoundEvent | None

    @property
    def error(self) -> float:
        """Time in the samples minus exact time."""
        return self.t - float(self.event.t)


# -- events that samples show ----------------------------------------------------------------------


def labels(steps: ExactSteps, near: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """Return the mode code of each sample: that of the domain that it is in, or of a stick at a
    belt.

    A sample is at a belt, sticking or passing, if its v differs from the belt's speed by at most
    `near`. Beside a step in which the exact motion sticks to the belt `drift` is enough, since
    solvers let v drift off in a stick.
    """
    v = steps.v
    label = DOMAIN_CODES[1 + np.sum(v[:, None] > steps.belts, axis=1)].astype(np.int8)
    for boundary, speed in enumerate(steps.belts.tolist(), 1):
        gap = np.abs(v - speed)
        code = STICK_CODES[boundary]
        sticks = steps.last == code
        held = np.append(sticks, False) | np.append(False, sticks)
        label[(gap <= near) | ((gap <= drift) & held)] = code
    return label


def find_events(
    steps: ExactSteps, label: np.ndarray, wrong: np.ndarray
) -> tuple[list[FoundEvent], np.ndarray]:
    """Return the events that the mode codes `label` of the samples show, in order of time, and
    corrected codes.

    The corrected codes are 0 for samples at a belt that only pass or graze it, and those of `label`
    for all others. `wrong` marks the wrong steps.
    """
    modes = label.copy()
    # Runs of samples with one code: a new one begins too where a flight leads back to its belt.
    begins_run = (np.diff(label, prepend=0) != 0) | _reached_by_flight(steps, label, wrong)
    starts = np.flatnonzero(begins_run)
    ends = np.append(starts[1:], len(label)) - 1
    course = _Course(_Reader(steps, wrong))
    for first, last in zip(starts.tolist(), ends.tolist(), strict=True):
        mode = int(label[first])
        belt = int(BELT_OF[mode])
        if not belt:
            course.move_to(int(DOMAIN_OF[mode]), first)
        elif course.reader.is_stick(mode, first, last):
            course.stick(belt, first)
        else:  # a contact: the belt is crossed or grazed
            modes[first : last + 1] = 0
            if not course.has_passed(belt, first, last):
                continue
        course.since = last
    return course.events, modes


class _Course:
    """The modes that samples go through, and the events between them.

    `domain` and `belt` are those of the last mode of the samples: the one or the other, 0 if it is
    none, and both 0 if none is known yet. `since` is the last sample in it.
    """

    def __init__(self, reader: _Reader) -> None:
        self.reader = reader
        self.events: list[FoundEvent] = []
        self.domain = 0
        self.belt = 0
        self.since = 0

    def move_to(self, domain: int, sample: int) -> None:
        """Record the slip and the crosses that lead from the last mode to `domain`, where the mass
        is at `sample`.
        """
        since = self.since
        if self.belt:
            belt = self.belt
            entered = min(belt, belt + 1, key=lambda d: abs(d - domain))
            modes = (STICK_CODES[belt], DOMAIN_CODES[entered])
            self.events.append(self.reader.event("slip", belt, modes, since, since, since))
            self._enter(entered)
        if self.domain and self.domain != domain:
            direction = 1 if domain > self.domain else -1
            for source, target in pairwise(range(self.domain, domain + direction, direction)):
                belt = min(source, target)  # belt n lies between domains n and n + 1
                modes = (DOMAIN_CODES[source], DOMAIN_CODES[target])
                cross = self.reader.event("cross", belt, modes, since, sample - 1, None)
                self.events.append(cross)
        self._enter(domain)

    def _enter(self, domain: int) -> None:
        """Note that the last mode is a domain."""
        self.domain = domain
        self.belt = 0

    def stick(self, belt: int, first: int) -> None:
        """Record that the mass sticks to a belt from sample `first` on, and how it came there."""
        if self.domain or self.belt:
            before = self.domain or self.belt + 0.5  # a belt lies between its two domains
            self.move_to(min(belt, belt + 1, key=lambda d: abs(d - before)), first)
            modes = (DOMAIN_CODES[self.domain], STICK_CODES[belt])
            self.events.append(self.reader.event("stick", belt, modes, first - 1, first, first))
        self.domain = 0
        self.belt = belt

    def has_passed(self, belt: int, first: int, last: int) -> bool:
        """Record the cross at a contact, samples `first` to `last`, where the steps are right: there
        the exact motion shows what happens. Return whether the mode at sample `last` is known.
        """
        wrong = self.reader.wrong
        if last == len(wrong) or wrong[last] or (first and wrong[first - 1]):
            return False
        source = int(DOMAIN_OF[self.reader.last[first - 1]])
        target = int(DOMAIN_OF[self.reader.first[last]])
        if not (self.domain or self.belt):  # a start on the belt is not an event
            source = target
            self.domain = target
            self.belt = int(BELT_OF[self.reader.first[last]])
        if {source, target} == {belt, belt + 1}:
            self.move_to(source, first)
            modes = (DOMAIN_CODES[source], DOMAIN_CODES[target])
            self.events.append(self.reader.event("cross", belt, modes, first - 1, last, first))
            self._enter(target)
            return True
        return self.domain > 0 and target == self.domain


def _reached_by_flight(steps: ExactSteps, label: np.ndarray, wrong: np.ndarray) -> np.ndarray:
    """Mark samples at the same belt as the sample before if the step between is right and does not
    stick to it.
    """
    held = (steps.first == label[:-1]) | (steps.last == label[:-1])
    begins_stick = steps.events.target == label[steps.events.step]
    held[steps.events.step[begins_stick]] = True
    at_same_belt = (BELT_OF[label[:-1]] > 0) & (label[1:] == label[:-1])
    takes_time = np.diff(steps.t) > 0.0
    flown = at_same_belt & ~held & ~wrong & takes_time
    return np.append(False, flown)


class _Reader:
    """Steps as plain lists: events are read off many short runs of samples, one by one."""

    def __init__(self, steps: ExactSteps, wrong: np.ndarray) -> None:
        self.steps = steps
        self.wrong = wrong.tolist()
        self.t = steps.t.tolist()
        self.v = steps.v.tolist()
        self.belts = steps.belts.tolist()
        self.first = steps.first.tolist()
        self.last = steps.last.tolist()
        # The rows of the events of step i in `steps.events` are begin[i] to begin[i + 1].
        self.begin = np.searchsorted(steps.events.step, np.arange(len(steps.first) + 1)).tolist()

    def is_stick(self, mode: int, first: int, last: int) -> bool:
        """Return whether samples `first` to `last`, all at one belt, stick to it, and do not only
        cross or graze it.
        """
        events = self.steps.events
        held = 0.0
        for i in range(first, min(last, len(self.wrong) - 1) + 1):
            if self.wrong[i]:
                # The samples decide: two at the belt are on it, the last one is about to leave it.
                sticks = i < last
            else:
                sticks = mode in (self.first[i], self.last[i])
                if not sticks and self.begin[i] < self.begin[i + 1]:
                    targets = events.target[self.begin[i] : self.begin[i + 1]]
                    sticks = bool(np.any(targets == mode))
            if sticks:
                held += self.t[i + 1] - self.t[i]
        return held >= 1e-9 * self.steps.K.period

    def event(
        self,
        kind: str,
        boundary: int,
        modes: tuple[int, int],
        step: int,
        last_step: int,
        sample: int | None,
    ) -> FoundEvent:
        """Return an event in the steps `step` to `last_step`, between two `modes`.

        Its time is that of the exact motion over these steps or, if it does not have the event
        there, that of `sample` or (None) an estimate by v.
        """
        last_step = min(last_step, len(self.first) - 1)
        i = step
        j = last_step + 1
        events = self.steps.events
        exact_times: list[float] = []
        if self.begin[i] < self.begin[j]:
            rows = slice(self.begin[i], self.begin[j])
            is_same = (events.kind[rows] == CODES[kind]) & (events.boundary[rows] == boundary)
            exact_times = events.t[rows][is_same].tolist()
        spread = self.t[j] - self.t[i]
        if exact_times:
            time = exact_times[0]
            spread = 0.0
        elif sample is not None:
            time = self.t[sample]
        else:
            time = self._estimated_time(i, j, self.belts[boundary - 1])
        source, target = modes
        names = ALL_MODE_NAMES[source], ALL_MODE_NAMES[target]
        return FoundEvent(time, kind, boundary, *names, step, last_step, spread)

    def _estimated_time(self, i: int, j: int, speed: float) -> float:
        """Return when v is nearest to a belt's speed between samples i and j: at a sample between
        them, or where the line through both of them has that speed.
        """
        gaps = [v - speed for v in self.v[i : j + 1]]
        nearest = i + min(range(len(gaps)), key=lambda k: abs(gaps[k]))
        if i < nearest < j:
            return float(self.t[nearest])
        first_gap = gaps[0]
        last_gap = gaps[-1]
        if first_gap * last_gap < 0.0:
            share = first_gap / (first_gap - last_gap)
        else:
            share = 0.5
        return float(self.t[i] + share * (self.t[j] - self.t[i]))


def given_events(steps: ExactSteps, pairs: Iterable[tuple[float, str]]) -> list[FoundEvent]:
    """Convert the pairs (t, kind) of a solver's list of events to `FoundEvent`."""
    events = []
    for time, kind in pairs:
        step, _ = steps.at(time)
        events.append(FoundEvent(time, kind, 0, "", "", step, step))
    return events
