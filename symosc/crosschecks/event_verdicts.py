"""Which of the exact events a solution has, which it misses, and which of its own are invented."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from symosc.crosschecks.bands import BELT_OF, MODES, STICK_CODES
from symosc.crosschecks.events import (
    CODES,
    PASSES,
    RETURNS,
    STAYS,
    WINDOW,
    FoundEvent,
    Match,
)
from symosc.crosschecks.match import match_events
from symosc.crosschecks.time_tolerances import TimeTolerances
from symosc.engine.events import KIND_NAMES
from symosc.simulation.trajectory import Event, Trajectory

# The events at which v becomes that of a belt; an event function v - v_belt finds these.
CONTACTS = ("cross", "stick")


class EventVerdicts:
    """Exact events paired with those of the samples or of a list, and verdicts on unpaired events.

    `matched`, `missed`, `invented`, `unresolved` and `notes` are those of a `CrossCheck`.

    Parameters
    ----------
    motion : Trajectory
        The exact motion.
    exact : sequence of Event
        Its events, perhaps some shortly after the last sample too.
    reported : sequence of FoundEvent
        What the samples show, or what the solver has listed.
    are_listed : bool
        Whether the solver has listed them.
    tolerances : TimeTolerances
    label : int array
        The mode codes of `labels`.
    wrong : bool array
        The wrong steps.
    lists : sequence of sequences of float, optional
        The times that a solver's event functions found: such a list has no kinds, and claims less.
    """

    def __init__(
        self,
        motion: Trajectory,
        exact: Sequence[Event],
        reported: Sequence[FoundEvent],
        are_listed: bool,
        tolerances: TimeTolerances,
        label: np.ndarray,
        wrong: np.ndarray,
        lists: Sequence[Sequence[float]] | None = None,
    ) -> None:
        self.motion = motion
        self.exact = exact
        self.reported = reported
        self.are_listed = are_listed
        self.tolerances = tolerances
        self.steps = tolerances.steps
        self.label = label
        self.wrong = wrong
        self.window = WINDOW * self.steps.K.period
        self.times = np.array([float(event.t) for event in exact])
        self.reaches = np.array([tolerances.of_event(event) for event in exact])
        self.local = [self._local(event) for event in exact]
        # Numbers of the exact and of the reported events that have no partner yet.
        self.exact_free = set(range(len(exact)))
        self.reported_free = set(range(len(reported)))
        self.matched = list[Match]()
        self.missed = list[Event]()
        self.invented = list[FoundEvent]()
        self.unresolved = list[Event | FoundEvent]()
        self.notes = list[str]()
        self._pair()
        self.claims = None if lists is None else self._claims(lists)
        if are_listed:
            self._allow_start()
            if lists is not None:
                self._allow_repeats_and_sticks()
            self._allow_close_events()
            self._allow_events_of_the_samples()
            self._allow_near_grazes()
        self._judge_exact()
        self._judge_reported()
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
        """Return when exact event number `i` occurs if the motion restarts at every sample, None if
        it does not.
        """
        if self.local[i] is None:
            return None
        return float(self.steps.events.t[self.local[i]])

    def _pair(self) -> None:
        """Pair as many events as possible that are of one kind, in order of time, and within their
        time errors.
        """
        slacks = np.array([event.spread for event in self.reported])
        if self.are_listed:
            slacks = slacks + self.tolerances.listed
        own_times = [self._own_time(i) for i in range(len(self.exact))]
        matching = match_events(
            self.reported, self.exact, self.reaches, spreads=slacks, second_times=own_times
        )
        for j, i in matching.matched:
            self.exact_free.remove(i)
            self.reported_free.remove(j)
            event = self.reported[j]
            self.matched.append(Match(self.exact[i], event.t, event))

    def _claims(self, lists: Sequence[Sequence[float]]) -> set[tuple[int, str]]:
        """Return the contacts that lists of times claim to have, as pairs of a belt and the domain
        that the mass is in before.

        A list that has contacts at a belt claims all there, or, as an event function may look for
        one direction alone, all from the same side. An empty list beside such a list is that of the
        belt that no other one has.
        """
        contacts = _contacts(self.exact)
        by_time = {match.t: match.event for match in self.matched}
        claims = set[tuple[int, str]]()
        some_from_one_side = False  # whether a list lacks the contacts from one side of its belt
        for times in lists:
            events = [by_time[time] for time in times if time in by_time]
            of_list = _contacts(events)
            claims |= of_list
            belts = {belt for belt, _ in of_list}
            at_its_belts = {(belt, source) for belt, source in contacts if belt in belts}
            some_from_one_side |= of_list != at_its_belts
        if claims and any(not times for times in lists):
            numbers = range(1, len(self.steps.belts) + 1)
            for unclaimed in {*numbers} - {belt for belt, _ in claims}:
                at_belt = {(belt, source) for belt, source in contacts if belt == unclaimed}
                # If lists are of one side, an empty one may be of the side without contacts.
                if len(at_belt) > 1 or not some_from_one_side:
                    claims |= at_belt
        return claims

    def _allow_repeats_and_sticks(self) -> None:
        """Drop times at which a solver's event function is 0 again, at the same event or all along
        a stick.
        """
        motion = self.motion
        for j in sorted(self.reported_free):
            time = self.reported[j].t
            near = np.abs(self.times - time) <= self.reaches + self.tolerances.listed[j]
            inside = float(motion.t_start) <= time <= float(motion.t_end)
            if np.any(near) or (inside and BELT_OF[MODES[motion.mode(time)]] > 0):
                self.reported_free.remove(j)

    def _allow_start(self) -> None:
        """Drop a listed event that is the start on a belt.

        This is no event, but solvers list it.
        """
        boundary = int(BELT_OF[self.label[0]])
        if boundary <= 0 or not self.reported_free:
            return
        first = min(self.reported_free)
        time = self.reported[first].t
        allowed = self.tolerances.of_start(boundary) + self.tolerances.listed[first]
        if abs(time - float(self.steps.t[0])) <= allowed:
            self.reported_free.remove(first)
            note = f"the list's event at t = {time:.10g} is the start on belt {boundary}"
            self.notes.append(note)

    def _allow_events_of_the_samples(self) -> None:
        """Set aside listed events that the exact motion has only if it restarts at every sample, in
        a right step.
        """
        events = self.steps.events
        used = {row for row in self.local if row is not None}
        for j in sorted(self.reported_free):
            event = self.reported[j]
            low, high = np.searchsorted(events.t, [event.t - self.window, event.t + self.window])
            for row in range(int(low), int(high)):
                row_kind = KIND_NAMES[int(events.kind[row])]
                same = event.kind in ("", row_kind)
                if not same or row in used or self.wrong[events.step[row]]:
                    continue
                distance = abs(float(events.t[row]) - event.t)
                reach = self.tolerances.of_row(row)
                gaps = np.abs(self.times - events.t[row])
                near = np.flatnonzero(gaps <= self.reaches + reach).tolist()
                row_contact = row_kind, events.boundary[row]
                is_exact = row_contact in [
                    (self.exact[i].kind, self.exact[i].boundary) for i in near
                ]
                if not is_exact and distance <= reach + self.tolerances.listed[j]:
                    used.add(row)
                    self._set_aside([j], ())
                    break

    def _allow_close_events(self) -> None:
        """Set aside unpaired events among exact events at one belt that are too close in time to be
        told apart.
        """
        partners = {id(match.event): match.found for match in self.matched}
        numbers = {id(event): j for j, event in enumerate(self.reported)}
        for cluster in self._clusters():
            low = min(self.times[i] - self.reaches[i] for i in cluster)
            high = max(self.times[i] + self.reaches[i] for i in cluster)
            unpaired = [j for j in self.reported_free if low <= self.reported[j].t <= high]
            unpaired_exact = self.exact_free & set(cluster)
            if not (unpaired or unpaired_exact) or self._is_wrong(low, high):
                continue
            # All reported events of the cluster: are they a row that the exact ones may look like?
            ids = [id(self.exact[i]) for i in cluster]
            paired = [numbers[id(partners[number])] for number in ids if number in partners]
            reported = sorted([*unpaired, *paired])
            alike = _alike(self.exact[cluster[0]].source, self.exact[cluster[-1]].target)
            if _fits([self.reported[j].kind for j in reported], alike):
                self._set_aside(unpaired, unpaired_exact)

    def _clusters(self) -> list[list[int]]:
        """Return runs of numbers of exact events at one belt, each within the time errors of the
        one before it.
        """
        clusters: list[list[int]] = []
        for i, event in enumerate(self.exact):
            is_at_belt = i > 0 and event.boundary == self.exact[i - 1].boundary
            reach = self.reaches[i] + self.reaches[i - 1]
            if is_at_belt and self.times[i] - self.times[i - 1] <= reach:
                clusters[-1].append(i)
            else:
                clusters.append([i])
        return clusters

    def _allow_near_grazes(self) -> None:
        """Set aside listed contacts where the exact motion nearly touches a belt, closer than the
        tolerance.
        """
        runs: list[list[int]] = []
        for j in sorted(self.reported_free):
            time = self.reported[j].t
            width = self.tolerances.of_near_graze(self.motion, time)
            # A contact next to an exact event belongs to that event.
            if width is None or np.any(np.abs(self.times - time) <= self.reaches + width):
                continue
            if self._is_wrong(time - width, time + width):
                continue
            is_next = False  # whether it belongs to the last run
            if runs:
                before = runs[-1][-1]
                is_next = time - self.reported[before].t <= 2.0 * width
            if is_next:
                runs[-1].append(j)
            else:
                runs.append([j])
        for run in runs:
            if _fits([self.reported[j].kind for j in run], RETURNS):
                self._set_aside(run, ())

    def _set_aside(self, reported: Iterable[int], exact: Iterable[int]) -> None:
        """Set the events with these numbers aside as unresolved: they do not count in the
        verdict.
        """
        numbers = sorted(exact)
        self.unresolved += [self.exact[i] for i in numbers]
        self.exact_free -= set(numbers)
        numbers = sorted(reported)
        self.unresolved += [self.reported[j] for j in numbers]
        self.reported_free -= set(numbers)

    def _is_wrong(self, low: float, high: float) -> bool:
        """Return whether any step between two times is wrong."""
        first, _ = self.steps.at(low)
        _, last = self.steps.at(high)
        return bool(self.wrong[first : last + 1].any())

    def _judge_exact(self) -> None:
        """Classify exact events without partner as missed, as matched (inside a right step), or as
        unresolved.
        """
        t = self.steps.t
        slack = 1e-6 * self.steps.K.period
        for i in sorted(self.exact_free):
            event = self.exact[i]
            time = float(self.times[i])
            reach = self.reaches[i]
            if time > t[-1]:
                continue
            is_at_an_end = time >= t[-1] - reach or time <= t[0] + reach
            if self.are_listed and is_at_an_end:  # it may be outside the samples
                self.unresolved.append(event)
                continue
            if self.claims is not None and (event.boundary, event.source) not in self.claims:
                continue
            first, last = self.steps.at(time, slack)
            inside = self._time_inside(i, slice(first, last + 2), slack)
            near = inside is not None and abs(inside - time) <= self.window
            is_graze = event.kind == "graze"
            is_in_wrong_step = self.wrong[first : last + 1].any()
            is_unlisted = self.are_listed and near and not is_graze
            if is_in_wrong_step or is_unlisted:
                if not is_graze:  # nothing changes at a graze: it cannot be missed
                    self.missed.append(event)
            elif near and inside is not None:
                self.matched.append(Match(event, inside, None))
            else:
                self.unresolved.append(event)

    def _time_inside(self, i: int, around: slice, slack: float) -> float | None:
        """Return when exact event number `i` is inside a right step, or in a sample `around` it."""
        inside = self._own_time(i)
        if inside is not None:
            return inside
        # A contact that is a sample is inside no step.
        gaps = np.abs(self.steps.t[around] - self.times[i])
        nearest = around.start + int(np.argmin(gaps))
        is_there = float(np.min(gaps)) <= slack
        if is_there and self.label[nearest] == STICK_CODES[self.exact[i].boundary]:
            return float(self.steps.t[nearest])
        return None

    def _judge_reported(self) -> None:
        """Classify reported events without partner as invented, if listed or in a wrong step, or
        as unresolved.
        """
        events = self.steps.events
        wrong_before = np.append(0, np.cumsum(self.wrong)).tolist()
        for j in sorted(self.reported_free):
            event = self.reported[j]
            in_wrong = wrong_before[event.last_step + 1] > wrong_before[event.step]
            if self.are_listed or in_wrong:
                self.invented.append(event)
                continue
            rows = events.rows(event.step, event.last_step)
            same = events.kind[rows] == CODES[event.kind]
            same &= (events.boundary[rows] == event.boundary) | (event.boundary == 0)
            if same.any() or not len(same):
                # Otherwise several events in a step, which are matched one by one, look like this
                # from outside.
                self.unresolved.append(event)

    def add_list(self, listed: EventVerdicts) -> None:
        """Take over the verdicts on a solver's list of times without kinds.

        Its times replace those of the samples; events that it lacks are missed, and times without
        event invented.
        """
        shown = {id(match.event): match for match in self.matched}
        lacking = {id(event) for event in listed.missed}
        matched = {number: match for number, match in shown.items() if number not in lacking}
        for match in listed.matched:
            number = id(match.event)
            in_samples = shown[number].found if number in shown else None
            matched[number] = Match(match.event, match.t, in_samples)
        self.matched = sorted(matched.values(), key=lambda match: float(match.event.t))
        missed = {id(event): event for event in [*self.missed, *listed.missed]}
        missed = {number: event for number, event in missed.items() if number not in matched}
        self.missed = sorted(missed.values(), key=lambda event: float(event.t))
        for event in listed.invented:
            gaps = np.abs(self.times - event.t)
            kind = "cross"
            if len(gaps) and float(np.min(gaps)) <= self.window:
                kind = self.exact[int(np.argmin(gaps))].kind
            self.invented.append(replace(event, kind=kind))
        judged = {*matched, *missed}
        both = {id(event): event for event in [*self.unresolved, *listed.unresolved]}
        self.unresolved = [
            event for number, event in both.items() if number not in judged and event.kind
        ]
        self.notes = [*self.notes, *listed.notes]


def _contacts(events: Iterable[Event]) -> set[tuple[int, str]]:
    """Return the belt of each contact among events, and the mode before it."""
    return {(event.boundary, event.source) for event in events if event.kind in CONTACTS}


def _alike(source: str, target: str) -> set[tuple[str, ...]]:
    """Return the rows of kinds that may stand for events that lead from one mode to another."""
    if source == target:
        return STAYS if source.startswith("belt") else RETURNS
    if source.startswith("belt") or target.startswith("belt"):
        return set()
    return PASSES


def _fits(kinds: Sequence[str], alike: set[tuple[str, ...]]) -> bool:
    """Return whether events of these kinds are a row in `alike`.

    Unknown kinds fit any, and need not have slips.
    """
    if "" not in kinds:
        return tuple(kinds) in alike
    lengths = {len(row) for row in alike}
    return len(kinds) in lengths | {len(row) - row.count("slip") for row in alike}
