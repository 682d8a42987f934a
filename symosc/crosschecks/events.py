"""Match the events of samples, or of a list, with the exact events.

In order, one to one, within the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import cos, sin, sqrt

import numpy as np

from symosc.crosschecks.match import in_order as in_order  # until score and bench use match_events
from symosc.crosschecks.match import match_events
from symosc.crosschecks.steps import ExactSteps
from symosc.engine.events import KIND_NAMES
from symosc.engine.flow import derivatives
from symosc.engine.next_event import passing_time
from symosc.kernels._generated import acceleration
from symosc.model import MODE_NAMES, NEIGHBOURS
from symosc.simulation.trajectory import Event, Trajectory

CODES, MODES = ({name: code for code, name in names.items()} for names in (KIND_NAMES, MODE_NAMES))
# An event of the samples belongs to an exact one that is at most this part of the forcing period
# away.
WINDOW = 0.05
# Times are estimated from the leading derivatives: twice that is surely enough.
REACH_SAFETY = 2.0
# Where events at one belt are too close to be distinguished, a list may have these kinds: for a
# passage to the next domain, or back to where the motion came from, and for a stick that ends and
# begins again.
PASSES = {("cross",), ("stick", "slip")}
RETURNS = {(), ("graze",), ("stick", "slip"), ("cross", "cross")}
STAYS: set[tuple[str, ...]] = {(), ("slip", "stick")}
# The events at which v becomes that of a belt; an event function v - v_belt finds these.
CONTACTS = ("cross", "stick")


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


# -- events that samples show ------------------------------------------------------------------------------------------


def labels(steps: ExactSteps, near: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """Return the mode code of each sample.

    1 to 3 for the domain that it is in, 4 at belt 1, 5 at belt 2.

    A sample is at a belt, sticking or passing, if its v differs from the belt's speed by at most
    `near`. Beside a step in which the exact motion sticks to the belt `drift` is enough, since
    solvers let v drift off in a stick.
    """
    v = steps.v
    K = steps.K
    label = np.int8(1) + (v > K.belt1.v) + (v > K.belt2.v)
    for boundary, speed in ((1, K.belt1.v), (2, K.belt2.v)):
        gap = np.abs(v - speed)
        sticks = steps.last == 3 + boundary
        held = np.append(sticks, False) | np.append(False, sticks)
        label[(gap <= near) | ((gap <= drift) & held)] = 3 + boundary
    return label


def find_events(
    steps: ExactSteps, label: np.ndarray, wrong: np.ndarray
) -> tuple[list[FoundEvent], np.ndarray]:
    """Return the events that the mode codes `label` of the samples show, in order of time, and corrected codes.

    The corrected codes are 0 for samples at a belt that only pass or graze it, and those of `label`
    for all others. `wrong` marks the wrong steps.
    """
    modes = label.copy()
    starts = np.flatnonzero(
        (np.diff(label, prepend=0) != 0) | _reached_by_flight(steps, label, wrong)
    )
    ends = np.append(starts[1:], len(label)) - 1
    found: list[FoundEvent] = []
    reader = _Reader(steps, wrong)
    # the last mode of the samples, and the last sample in it
    now = 0
    since = 0

    def move_to(domain: int, sample: int) -> None:
        """Record the slip and the crosses that lead from the last mode to `domain`, where the mass is at `sample`."""
        nonlocal now
        if now > 3:
            entered = min((now - 3, now - 2), key=lambda d: abs(d - domain))
            found.append(reader.event("slip", now - 3, now, entered, since, since, since))
            now = entered
        if now:
            if domain > now:
                way = 1
            else:
                way = -1
            # No domain is between a domain and itself.
            found.extend(
                reader.event("cross", min(a, b), a, b, since, sample - 1, None)
                for a, b in pairwise(range(now, domain + way, way))
                if now != domain
            )
        now = domain

    for first, last in zip(starts.tolist(), ends.tolist(), strict=True):
        mode = int(label[first])
        if mode <= 3:
            move_to(mode, first)
        elif reader.is_stick(mode, first, last):
            if now:
                if now > 3:
                    before = now - 2.5
                else:
                    before = now
                move_to(min((mode - 3, mode - 2), key=lambda d: abs(d - before)), first)
                found.append(reader.event("stick", mode - 3, now, mode, first - 1, first, first))
            now = mode
        else:
            modes[first : last + 1] = 0
            if last == len(wrong) or wrong[last] or (first and wrong[first - 1]):
                continue
            # Where the steps are right, the exact motion shows what happens at the contact.
            source = int(steps.last[first - 1])
            target = int(steps.first[last])
            if not now:  # a start on the belt is not an event
                source = now = target
            if {source, target} == {mode - 3, mode - 2}:
                move_to(source, first)
                found.append(
                    reader.event("cross", mode - 3, source, target, first - 1, last, first)
                )
                now = target
            elif now > 3 or target != now:
                continue
        since = last
    return found, modes


def _reached_by_flight(steps: ExactSteps, label: np.ndarray, wrong: np.ndarray) -> np.ndarray:
    """Mark samples at the same belt as the sample before if the step between is right and does not stick to it."""
    held = (steps.first == label[:-1]) | (steps.last == label[:-1])
    held[steps.events.step[steps.events.target == label[steps.events.step]]] = True
    flown = (label[:-1] > 3) & (label[1:] == label[:-1]) & ~held & ~wrong & (np.diff(steps.t) > 0.0)
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
        """Return whether samples `first` to `last`, all at one belt, stick to it, and do not only cross or graze it."""
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
        self, kind: str, boundary: int, source: int, target: int, step: int, last_step: int, sample: int | None
    ) -> FoundEvent:  # fmt: skip
        """Return an event; its time is that of the exact motion over the steps, or of `sample`, or estimated by v."""
        last_step = min(last_step, len(self.first) - 1)
        i = step
        j = last_step + 1
        events = self.steps.events
        times: list[float] = []
        if self.begin[i] < self.begin[j]:
            rows = slice(self.begin[i], self.begin[j])
            same = (events.kind[rows] == CODES[kind]) & (events.boundary[rows] == boundary)
            times = events.t[rows][same].tolist()
        if times:
            spread = 0.0
        else:
            spread = self.t[j] - self.t[i]
        if times:
            time = times[0]
        elif sample is not None:
            time = self.t[sample]
        else:
            time = self._estimated_time(i, j, self.belts[boundary - 1])
        names = MODE_NAMES[source], MODE_NAMES[target]
        return FoundEvent(time, kind, boundary, *names, step, last_step, spread)

    def _estimated_time(self, i: int, j: int, speed: float) -> float:
        """Return when v has a belt's speed between samples i and j.

        At a sample between, or on a line.
        """
        gaps = [v - speed for v in self.v[i : j + 1]]
        nearest = i + min(range(len(gaps)), key=lambda k: abs(gaps[k]))
        if i < nearest < j:
            return float(self.t[nearest])
        if gaps[0] * gaps[-1] < 0.0:
            part = gaps[0] / (gaps[0] - gaps[-1])
        else:
            part = 0.5
        return float(self.t[i] + part * (self.t[j] - self.t[i]))


def given_events(steps: ExactSteps, pairs: Iterable[tuple[float, str]]) -> list[FoundEvent]:
    """Convert the pairs (t, kind) of a solver's list of events to `FoundEvent`."""
    return [
        FoundEvent(time, kind, 0, "", "", step, step)
        for time, kind in pairs
        for step in [steps.at(time)[0]]
    ]


# -- tolerances of event times -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TimeTolerances:
    """How far the times of events in a solution may be from the exact ones, as the errors of its samples allow."""

    steps: ExactSteps
    errors: np.ndarray  # allowed errors of the samples in x and v, (n, 2)
    allowed_v: float  # the tolerance as a velocity
    tolerance: float
    listed: np.ndarray  # rounding of the times of a list

    def of_event(self, event: Event) -> float:
        """Return by how much a solver's time of an exact event may be off."""
        t = float(event.t)
        x = float(event.x)
        theta = float(event.theta)
        return self._tolerance(t, x, theta, event.boundary, MODES[event.source])

    def of_row(self, row: int) -> float:
        """Return by how much a solver's time of the exact event in one `row` of `steps.events` may be off."""
        events = self.steps.events
        step = int(events.step[row])
        boundary = int(events.boundary[row])
        starts = row == 0 or events.step[row - 1] != step
        source = int(self.steps.first[step] if starts else events.target[row - 1])
        if events.kind[row] == CODES["slip"]:
            source = 3 + boundary
        else:
            source = min(source, 3)
        return self._tolerance(
            float(events.t[row]), float(events.x[row]), float(events.theta[row]), boundary, source
        )

    def of_start(self, boundary: int) -> float:
        """Return how long after the first sample a solver may list its start on a belt as an event."""
        t = float(self.steps.t[0])
        x = float(self.steps.x[0])
        theta = float(self.steps.theta[0])
        return max(
            self._tolerance(t, x, theta, boundary, domain) for domain in NEIGHBOURS[boundary]
        )

    def of_near_graze(self, trajectory: Trajectory, time: float) -> float | None:
        """Return how long before and after a time v is within tolerance of a belt's speed.

        None if it is not.
        """
        inside = float(trajectory.t_start) <= time <= float(trajectory.t_end)
        if inside:
            mode = MODES[trajectory.mode(time)]
        else:
            mode = 4
        if mode > 3:
            return None
        K = self.steps.K
        (x, v) = (float(value) for value in trajectory(time))
        # The phase of the samples' clock does not lose digits at large times.
        step = self.steps.at(time)[0]
        theta = float(self.steps.theta[step] + K.Om * (time - self.steps.t[step]))
        a = self._acceleration(x, v, theta, mode)
        b = float(derivatives(v, a, sin(theta), cos(theta), K)[0])
        spread = self._spread(time)[1] + self.allowed_v
        gap = min(abs(v - belt.v) for belt in (K.belt1, K.belt2))
        if b == 0.0 or gap > REACH_SAFETY * spread or a * a > 2.0 * REACH_SAFETY * spread * abs(b):
            return None
        return REACH_SAFETY * sqrt(2.0 * spread / abs(b))

    def _acceleration(self, x: float, v: float, theta: float, domain: int) -> float:
        """Return the acceleration of the mass at a state x, v and phase theta, with the force of a domain."""
        K = self.steps.K
        return float(
            acceleration(x, v, cos(theta), (K.A1, K.A2, K.A3)[domain - 1], K.cm, K.w0sq, K.f0)
        )

    def _spread(self, time: float) -> tuple[float, float]:
        """Return bounds of the errors of x and v around a time.

        The second bounds all later errors of v too.
        """
        # For the differences X, V of two motions V^2 + (k/m) X^2 never grows: an error of x may
        # become one of v.
        j = int(np.searchsorted(self.steps.t, time))
        dx, dv = (float(value) for value in np.max(self.errors[max(j - 2, 0) : j + 2], axis=0))
        return dx, sqrt(dv * dv + self.steps.K.w0sq * dx * dx)

    def _tolerance(self, time: float, x: float, theta: float, boundary: int, source: int) -> float:
        """Return how far the time of an event at x, theta and a belt may be off.

        `source` is the mode that it ends.
        """
        K = self.steps.K
        (dx, dv) = self._spread(time)
        v = (K.belt1, K.belt2)[boundary - 1].v
        s = sin(theta)
        c = cos(theta)
        rate = max(K.Om, sqrt(K.w0sq))
        if source > 3:  # the force passes 0, with known derivatives
            error = K.w0sq * dx + rate * self.allowed_v
            slopes = -(K.w0sq * v + K.fB * s), -K.fB * K.Om * c, K.fB * K.Om * K.Om * s
        else:  # the velocity passes the belt's
            error = dv + self.allowed_v
            a = self._acceleration(x, v, theta, source)
            slopes = (a, *derivatives(v, a, s, c, K)[:2])
        passing = REACH_SAFETY * float(passing_time(error, *slopes, K))
        return passing + self.tolerance / rate + 4.0 * float(np.spacing(abs(time)))


# -- matching ----------------------------------------------------------------------------------------------------------


class Matcher:
    """Exact events paired with those of the samples or (if `given`) of a list, and verdicts on unpaired events."""

    # `exact` may have events shortly after the last sample too; `label` are the codes of `labels`;
    # `wrong` marks steps. `lists` are the times that a solver's event functions found: such a list
    # has no kinds, and claims less. The results `matched`, `missed`, `invented`, `unresolved` and
    # `notes` are those of `CrossCheck`.

    def __init__(
        self, trajectory: Trajectory, exact: Sequence[Event], found: Sequence[FoundEvent], given: bool,
        tolerances: TimeTolerances, label: np.ndarray, wrong: np.ndarray,
        lists: Sequence[Sequence[float]] | None = None,
    ) -> None:  # fmt: skip
        self.trajectory, self.exact, self.found, self.given = trajectory, exact, found, given
        self.tolerances, self.steps, self.label, self.wrong = (
            tolerances,
            tolerances.steps,
            label,
            wrong,
        )
        self.window = WINDOW * self.steps.K.period
        self.times = np.array([float(event.t) for event in exact])
        self.reaches = np.array([tolerances.of_event(event) for event in exact])
        self.local = [self._local(event) for event in exact]
        # Numbers of the exact events and of those found that have no partner yet.
        self.exact_free, self.found_free = set(range(len(exact))), set(range(len(found)))
        self.matched, self.missed, self.invented = list[Match](), list[Event](), list[FoundEvent]()
        self.unresolved, self.notes = list[Event | FoundEvent](), list[str]()
        self._pair()
        if lists is None:
            self.claims = None
        else:
            self.claims = self._claims(lists)
        if given:
            self._allow_start()
            if lists is not None:
                self._allow_repeats_and_sticks()
            self._allow_close_events()
            self._allow_events_of_the_samples()
            self._allow_near_grazes()
        self._judge_exact()
        self._judge_found()
        self.matched.sort(key=lambda match: float(match.event.t))

    def _local(self, event: Event) -> int | None:
        """Return the row in `steps.events` of an event of the exact motion.

        None if no right step has this event.
        """
        # In `steps.events` the motion begins anew at every sample.
        events = self.steps.events
        time = float(event.t)
        rows = np.arange(*np.searchsorted(events.t, [time - self.window, time + self.window]))
        same = (events.kind[rows] == CODES[event.kind]) & (events.boundary[rows] == event.boundary)
        rows = rows[same & ~self.wrong[events.step[rows]]]
        if len(rows):
            return int(rows[np.argmin(np.abs(events.t[rows] - time))])
        return None

    def _own_time(self, i: int) -> float | None:
        """Return when exact event number `i` occurs if the motion restarts at every sample, None if it does not."""
        if self.local[i] is None:
            return None
        return float(self.steps.events.t[self.local[i]])

    def _pair(self) -> None:
        """Pair as many events as possible.

        Of the same kind, in order of time, and within their time errors.
        """
        slacks = np.array([event.spread for event in self.found])
        if self.given:
            slacks = slacks + self.tolerances.listed
        own_times = [self._own_time(i) for i in range(len(self.exact))]
        matching = match_events(
            self.found, self.exact, self.reaches, spreads=slacks, second_times=own_times
        )
        for j, i in matching.matched:
            self.exact_free.remove(i)
            self.found_free.remove(j)
            self.matched.append(Match(self.exact[i], self.found[j].t, self.found[j]))

    def _claims(self, lists: Sequence[Sequence[float]]) -> set[tuple[int, str]]:
        """Return the contacts that lists of times claim to have.

        Pairs of a belt and the domain that the mass is in before.

        A list that has contacts at a belt claims all there, or, as an event function may look for
        one direction alone, all from the same side. An empty list beside such a list is that of the
        belt that no other one has.
        """
        contacts = {(e.boundary, e.source) for e in self.exact if e.kind in CONTACTS}
        by_time = {match.t: match.event for match in self.matched}
        claims = set[tuple[int, str]]()
        one_way = False
        for times in lists:
            events = [by_time[time] for time in times if time in by_time]
            own = {(e.boundary, e.source) for e in events if e.kind in CONTACTS}
            claims |= own
            belts = {belt for belt, _ in own}
            one_way |= own != {contact for contact in contacts if contact[0] in belts}
        if claims and any(not times for times in lists):
            for belt in {1, 2} - {belt for belt, _ in claims}:
                there = {contact for contact in contacts if contact[0] == belt}
                if len(there) > 1 or not one_way:
                    claims |= there
                else:
                    claims |= set()
        return claims

    def _allow_repeats_and_sticks(self) -> None:
        """Drop times at which a solver's event function is 0 again.

        At the same event, or all along a stick.
        """
        trajectory = self.trajectory
        for j in sorted(self.found_free):
            time = self.found[j].t
            near = np.abs(self.times - time) <= self.reaches + self.tolerances.listed[j]
            inside = float(trajectory.t_start) <= time <= float(trajectory.t_end)
            if np.any(near) or (inside and MODES[trajectory.mode(time)] > 3):
                self.found_free.remove(j)

    def _allow_start(self) -> None:
        """Drop a listed event that is the start on a belt.

        This is no event, but solvers list it.
        """
        boundary = int(self.label[0]) - 3
        if boundary <= 0 or not self.found_free:
            return
        first = min(self.found_free)
        time = self.found[first].t
        if (
            abs(time - float(self.steps.t[0]))
            <= self.tolerances.of_start(boundary) + self.tolerances.listed[first]
        ):
            self.found_free.remove(first)
            self.notes.append(
                f"the list's event at t = {time:.10g} is the start on belt {boundary}"
            )

    def _allow_events_of_the_samples(self) -> None:
        """Set aside listed events that the exact motion has only if it restarts at every sample, in a right step."""
        events = self.steps.events
        used = {row for row in self.local if row is not None}
        for j in sorted(self.found_free):
            event = self.found[j]
            low, high = np.searchsorted(events.t, [event.t - self.window, event.t + self.window])
            for row in range(int(low), int(high)):
                row_kind = KIND_NAMES[int(events.kind[row])]
                same = event.kind in ("", row_kind)
                if not same or row in used or self.wrong[events.step[row]]:
                    continue
                distance = abs(float(events.t[row]) - event.t)
                reach = self.tolerances.of_row(row)
                near = np.flatnonzero(
                    np.abs(self.times - events.t[row]) <= self.reaches + reach
                ).tolist()
                kind = row_kind, events.boundary[row]
                is_exact = any((self.exact[i].kind, self.exact[i].boundary) == kind for i in near)
                if not is_exact and distance <= reach + self.tolerances.listed[j]:
                    used.add(row)
                    self._set_aside([j], ())
                    break

    def _allow_close_events(self) -> None:
        """Set aside unpaired events among exact events at one belt that are too close in time to be told apart."""
        partner = {id(match.event): match.found for match in self.matched}
        index = {id(event): j for j, event in enumerate(self.found)}
        clusters: list[list[int]] = []
        for i, event in enumerate(self.exact):
            close = i > 0 and event.boundary == self.exact[i - 1].boundary
            if close and self.times[i] - self.times[i - 1] <= self.reaches[i] + self.reaches[i - 1]:
                clusters[-1].append(i)
            else:
                clusters.append([i])
        for cluster in clusters:
            low = min(self.times[i] - self.reaches[i] for i in cluster)
            high = max(self.times[i] + self.reaches[i] for i in cluster)
            loose = [j for j in self.found_free if low <= self.found[j].t <= high]
            if not (loose or self.exact_free & set(cluster)) or self._is_wrong(low, high):
                continue
            own = [partner[id(self.exact[i])] for i in cluster if id(self.exact[i]) in partner]
            there = sorted([*loose, *(index[id(event)] for event in own)])
            source = self.exact[cluster[0]].source
            target = self.exact[cluster[-1]].target
            if source.startswith("belt"):
                if source == target:
                    alike = STAYS
                else:
                    alike = set()
            else:
                if target.startswith("belt"):
                    alike = set()
                elif source == target:
                    alike = RETURNS
                else:
                    alike = PASSES
            if _fits([self.found[j].kind for j in there], alike):
                self._set_aside(loose, self.exact_free & set(cluster))

    def _allow_near_grazes(self) -> None:
        """Set aside listed contacts where the exact motion nearly touches a belt, closer than the tolerance."""
        runs: list[list[int]] = []
        for j in sorted(self.found_free):
            time = self.found[j].t
            width = self.tolerances.of_near_graze(self.trajectory, time)
            # A contact next to an exact event belongs to that event.
            if width is None or np.any(np.abs(self.times - time) <= self.reaches + width):
                continue
            if not self._is_wrong(time - width, time + width):
                if runs and self.found[j].t - self.found[runs[-1][-1]].t <= 2.0 * width:
                    runs[-1].append(j)
                else:
                    runs.append([j])
        for run in runs:
            if _fits([self.found[j].kind for j in run], RETURNS):
                self._set_aside(run, ())

    def _set_aside(self, found: Iterable[int], exact: Iterable[int]) -> None:
        """Set the events numbered `found` and `exact` aside as unresolved.

        They do not count in the verdict.
        """
        exact = sorted(exact)
        found = sorted(found)
        self.exact_free -= set(exact)
        self.found_free -= set(found)
        self.unresolved.extend([self.exact[i] for i in exact] + [self.found[j] for j in found])

    def _is_wrong(self, low: float, high: float) -> bool:
        """Return whether any step between two times is wrong."""
        return bool(self.wrong[self.steps.at(low)[0] : self.steps.at(high)[1] + 1].any())

    def _judge_exact(self) -> None:
        """Classify exact events without partner.

        Missed, matched as inside a right step, or else unresolved.
        """
        t = self.steps.t
        slack = 1e-6 * self.steps.K.period
        for i in sorted(self.exact_free):
            own = self.exact[i]
            time = float(self.times[i])
            reach = self.reaches[i]
            if time > t[-1]:
                continue
            if self.given and (
                time >= t[-1] - reach or time <= t[0] + reach
            ):  # it may be outside the samples
                self.unresolved.append(own)
                continue
            first, last = self.steps.at(time, slack)
            inside = self._own_time(i)
            if inside is None:  # a contact that is a sample is inside no step
                nearest = first + int(np.argmin(np.abs(t[first : last + 2] - time)))
                there = abs(t[nearest] - time) <= slack and self.label[nearest] == 3 + own.boundary
                if there:
                    inside = float(t[nearest])
                else:
                    inside = None
            near = inside is not None and abs(inside - time) <= self.window
            if self.claims is not None and (own.boundary, own.source) not in self.claims:
                continue
            if self.wrong[first : last + 1].any() or (self.given and near and own.kind != "graze"):
                if own.kind != "graze":  # nothing changes at a graze: it cannot be missed
                    self.missed.append(own)
            elif near and inside is not None:
                self.matched.append(Match(own, inside, None))
            else:
                self.unresolved.append(own)

    def _judge_found(self) -> None:
        """Classify found events without partner.

        Invented if listed or in a wrong step, else unresolved.
        """
        events = self.steps.events
        wrong_before = np.append(0, np.cumsum(self.wrong)).tolist()
        for j in sorted(self.found_free):
            event = self.found[j]
            if self.given or wrong_before[event.last_step + 1] > wrong_before[event.step]:
                self.invented.append(event)
                continue
            rows = events.rows(event.step, event.last_step)
            same = events.kind[rows] == CODES[event.kind]
            same &= (events.boundary[rows] == event.boundary) | (event.boundary == 0)
            if same.any() or not len(same):
                # Otherwise several events in a step, which are matched one by one, look like this
                # from outside.
                self.unresolved.append(event)

    def add_list(self, listed: Matcher) -> None:
        """Take over the verdicts on a solver's list of times without kinds.

        Its times replace those of the samples; events that it lacks are missed, and times without
        event invented.
        """
        shown = {id(match.event): match for match in self.matched}
        lacking = {id(event) for event in listed.missed}
        matched = {number: match for number, match in shown.items() if number not in lacking}
        for match in listed.matched:
            number = id(match.event)
            if number in shown:
                found = shown[number].found
            else:
                found = None
            matched[number] = Match(match.event, match.t, found)
        self.matched = sorted(matched.values(), key=lambda match: float(match.event.t))
        missed = {id(event): event for event in [*self.missed, *listed.missed]}
        missed = {number: event for number, event in missed.items() if number not in matched}
        self.missed = sorted(missed.values(), key=lambda event: float(event.t))
        for event in listed.invented:
            gaps = np.abs(self.times - event.t)
            near = len(gaps) > 0 and float(np.min(gaps)) <= self.window
            if near:
                kind = self.exact[int(np.argmin(gaps))].kind
            else:
                kind = "cross"
            self.invented.append(replace(event, kind=kind))
        judged = {*matched, *missed}
        both = {id(event): event for event in [*self.unresolved, *listed.unresolved]}
        self.unresolved = [
            event for number, event in both.items() if number not in judged and event.kind
        ]
        self.notes = [*self.notes, *listed.notes]


def _fits(kinds: Sequence[str], alike: set[tuple[str, ...]]) -> bool:
    """Return whether events of these kinds are a row in `alike`.

    Unknown kinds fit any, and need not have slips.
    """
    if "" not in kinds:
        return tuple(kinds) in alike
    lengths = {len(row) for row in alike}
    return len(kinds) in lengths | {len(row) - row.count("slip") for row in alike}
