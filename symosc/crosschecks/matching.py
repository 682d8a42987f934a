"""Events of the samples, or of a list, against the exact ones: in order, each one once, within the tolerance."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from symosc.crosschecks.events import CODES, WINDOW, FoundEvent
from symosc.crosschecks.reach import Reach
from symosc.simulation.trajectory import Event, Trajectory

# What a list may say within the tolerance, where events at one belt are too close to be distinguished: the kinds, by
# where they lead. A passage to the next domain, or back to where the motion came from:
PASSES = {("cross",), ("stick", "slip")}
RETURNS = {(), ("graze",), ("stick", "slip"), ("cross", "cross")}
# ... and a stick that is left and met again.
STAYS: set[tuple[str, ...]] = {(), ("slip", "stick")}


@dataclass(frozen=True)
class Match:
    """An exact event and the time at which the samples have it.

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


@dataclass(frozen=True)
class Matching:
    """How events of the samples fit the exact ones; the words are those of `CrossCheck`."""

    matched: list[Match] = field(default_factory=list)
    missed: list[Event] = field(default_factory=list)
    invented: list[FoundEvent] = field(default_factory=list)
    unresolved: list[Event | FoundEvent] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


class Matcher:
    """Exact events and those of the samples, and which of them have no partner yet.

    Parameters
    ----------
    trajectory : Trajectory
        The exact motion.
    exact : sequence of Event
        Its events, and those shortly after the last sample.
    found : sequence of FoundEvent
    given : bool
        Whether `found` is a list that the solver reported.
    reach : Reach
    label : (n,) int array
        Codes of what the samples do.
    wrong : (n - 1,) bool array
        Wrong steps.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        exact: Sequence[Event],
        found: Sequence[FoundEvent],
        given: bool,
        reach: Reach,
        label: np.ndarray,
        wrong: np.ndarray,
    ) -> None:
        self.trajectory, self.exact, self.found, self.given = trajectory, exact, found, given
        self.reach, self.steps, self.label, self.wrong = reach, reach.steps, label, wrong
        self.times = np.array([float(event.t) for event in exact])
        self.reaches = np.array([reach.of(event) for event in exact])
        self.local = [self._local(event, time) for event, time in zip(exact, self.times.tolist(), strict=True)]
        self.free, self.open = set(range(len(exact))), set(range(len(found)))
        self.result = Matching()

    def match(self) -> Matching:
        """Match the events, and say what those without a partner are."""
        self._pair()
        if self.given:
            self._start()
            self._neighbours()
            self._clusters()
            self._touches()
        self._leave_exact()
        self._leave_found()
        self.result.matched.sort(key=lambda match: float(match.event.t))
        return self.result

    def _local(self, event: Event, time: float) -> int | None:
        """Return which event of the exact motion over a right step is this event, or None."""
        events, window = self.steps.events, WINDOW * self.steps.K.period
        low, high = np.searchsorted(events.t, [time - window, time + window])
        rows = np.arange(low, high)
        same = (events.kind[rows] == CODES[event.kind]) & (events.boundary[rows] == event.boundary)
        rows = rows[same & ~self.wrong[events.step[rows]]]
        return int(rows[np.argmin(np.abs(events.t[rows] - time))]) if len(rows) else None

    def _pair(self) -> None:
        """Pair events of one kind that are within reach of each other, in order, as many as possible."""
        pairs = []
        most = float(np.max(self.reaches, initial=0.0)) + WINDOW * self.steps.K.period
        for j, event in enumerate(self.found):
            slack = event.spread + self.reach.listed[j] if self.given else event.spread
            low, high = np.searchsorted(self.times, [event.t - most - slack, event.t + most + slack])
            for i in range(int(low), int(high)):
                own = self.exact[i]
                if own.kind != event.kind or event.boundary not in (0, own.boundary):
                    continue
                distance = abs(self.times[i] - event.t)
                row = self.local[i]
                if row is not None:  # where the samples' own path has it
                    distance = min(distance, abs(float(self.steps.events.t[row]) - event.t))
                if distance <= self.reaches[i] + slack:
                    pairs.append((i, j, float(distance)))
        for i, j in in_order(pairs):
            self.free.remove(i)
            self.open.remove(j)
            self.result.matched.append(Match(self.exact[i], self.found[j].t, self.found[j]))

    def _start(self) -> None:
        """Allow one event at a start on a belt: it is not an event, but solvers list it."""
        boundary = int(self.label[0]) - 3
        if boundary <= 0 or not self.open:
            return
        first, t0 = min(self.open), float(self.steps.t[0])
        if abs(self.found[first].t - t0) <= self.reach.of_start(boundary) + self.reach.listed[first]:
            self.open.remove(first)
            time = f"t = {self.found[first].t:.10g}"
            self.result.notes.append(f"the list's event at {time} is the start on belt {boundary}")

    def _neighbours(self) -> None:
        """Set aside listed events that only the samples' own path has."""
        events = self.steps.events
        used = {row for row in self.local if row is not None}
        for j in sorted(self.open):
            event = self.found[j]
            reach = WINDOW * self.steps.K.period
            low, high = np.searchsorted(events.t, [event.t - reach, event.t + reach])
            for row in range(int(low), int(high)):
                own = events.kind[row] == CODES[event.kind] and row not in used and not self._is_exact(row)
                if own and not self.wrong[events.step[row]]:
                    distance = abs(float(events.t[row]) - event.t)
                    if distance <= self.reach.of_row(row) + self.reach.listed[j]:
                        used.add(row)
                        self.open.remove(j)
                        self.result.unresolved.append(event)
                        break

    def _is_exact(self, row: int) -> bool:
        """Tell whether an event over a step is an exact one: then it is no other event of the samples' path."""
        events = self.steps.events
        near = np.flatnonzero(np.abs(self.times - events.t[row]) <= self.reaches + self.reach.of_row(row))
        return any(
            CODES[self.exact[i].kind] == events.kind[row] and self.exact[i].boundary == events.boundary[row]
            for i in near.tolist()
        )

    def _clusters(self) -> None:
        """Set aside what differs only within the tolerance, where events are too close to be told apart."""
        partner = {id(match.event): match.found for match in self.result.matched}
        index = {id(event): j for j, event in enumerate(self.found)}
        for cluster in self._close_events():
            low = min(self.times[i] - self.reaches[i] for i in cluster)
            high = max(self.times[i] + self.reaches[i] for i in cluster)
            loose = [j for j in self.open if low <= self.found[j].t <= high]
            if not (loose or self.free & set(cluster)) or self._is_wrong(low, high):
                continue
            own = [partner[id(self.exact[i])] for i in cluster if id(self.exact[i]) in partner]
            there = sorted([*loose, *(index[id(event)] for event in own)])
            if tuple(self.found[j].kind for j in there) in _equivalents([self.exact[i] for i in cluster]):
                self._set_aside(loose, self.free & set(cluster))

    def _close_events(self) -> list[list[int]]:
        clusters: list[list[int]] = []
        for i, event in enumerate(self.exact):
            before = clusters[-1][-1] if clusters else i
            gap = self.times[i] - self.times[before] if event.boundary == self.exact[before].boundary else np.inf
            if i > before and gap <= self.reaches[i] + self.reaches[before]:
                clusters[-1].append(i)
            else:
                clusters.append([i])
        return clusters

    def _touches(self) -> None:
        """Set aside listed contacts where the exact motion nearly touches a belt, closer than the tolerance."""
        runs: list[list[int]] = []
        for j in sorted(self.open):
            time = self.found[j].t
            width = self.reach.of_touch(self.trajectory, time)
            # Next to an exact event it is that one.
            if width is None or np.any(np.abs(self.times - time) <= self.reaches + width):
                continue
            if self._is_wrong(time - width, time + width):
                continue
            if runs and self.found[j].t - self.found[runs[-1][-1]].t <= 2.0 * width:
                runs[-1].append(j)
            else:
                runs.append([j])
        for run in runs:
            if tuple(self.found[j].kind for j in run) in RETURNS:
                self._set_aside(run, ())

    def _set_aside(self, found: Iterable[int], exact: Iterable[int]) -> None:
        exact, found = sorted(exact), sorted(found)
        self.free -= set(exact)
        self.open -= set(found)
        self.result.unresolved.extend([self.exact[i] for i in exact] + [self.found[j] for j in found])

    def _is_wrong(self, low: float, high: float) -> bool:
        first, last = self.steps.at(low)[0], self.steps.at(high)[1]
        return bool(self.wrong[first : last + 1].any())

    def _leave_exact(self) -> None:
        """Say what exact events without a partner are: missed, inside a step, or not on the samples' path."""
        slack, window = 1e-6 * self.steps.K.period, WINDOW * self.steps.K.period
        for i in sorted(self.free):
            own, time = self.exact[i], float(self.times[i])
            if time > self.steps.t[-1]:
                continue
            if self._is_at_an_end(i):
                self.result.unresolved.append(own)
                continue
            first, last = self.steps.at(time, slack)
            inside = self._inside(i, first, last, slack)
            near = inside is not None and abs(inside - time) <= window
            if self.wrong[first : last + 1].any() or (self.given and near and own.kind != "graze"):
                if own.kind != "graze":  # nothing changes at a graze: it cannot be missed
                    self.result.missed.append(own)
            elif near and inside is not None:
                self.result.matched.append(Match(own, inside, None))
            else:
                self.result.unresolved.append(own)

    def _is_at_an_end(self, i: int) -> bool:
        """Tell whether a listed event may as well be before the first sample or after the last one."""
        start, end = float(self.steps.t[0]), float(self.steps.t[-1])
        reach = self.reaches[i]
        return self.given and bool(self.times[i] >= end - reach or self.times[i] <= start + reach)

    def _inside(self, i: int, first: int, last: int, slack: float) -> float | None:
        """Return when the exact motion over right steps has this event, or None."""
        row = self.local[i]
        if row is not None:
            return float(self.steps.events.t[row])
        nearest = first + int(np.argmin(np.abs(self.steps.t[first : last + 2] - self.times[i])))
        there = abs(self.steps.t[nearest] - self.times[i]) <= slack
        # A contact that is a sample is inside no step.
        return float(self.steps.t[nearest]) if there and self.label[nearest] == 3 + self.exact[i].boundary else None

    def _leave_found(self) -> None:
        """Say what events of the samples without a partner are: invented, or only on the samples' own path."""
        for j in sorted(self.open):
            event = self.found[j]
            rows = self.steps.events.rows(event.step, event.last_step)
            same = self.steps.events.kind[rows] == CODES[event.kind]
            same &= (self.steps.events.boundary[rows] == event.boundary) | (event.boundary == 0)
            if self.given or self.wrong[event.step : event.last_step + 1].any():
                self.result.invented.append(event)
            elif same.any() or not len(same):
                # Otherwise it is what several events in a step, which are matched one by one, look like from outside.
                self.result.unresolved.append(event)


def _equivalents(cluster: Sequence[Event]) -> set[tuple[str, ...]]:
    """Return the kinds of events that a list may have in place of events too close to be told apart."""
    source, target = cluster[0].source, cluster[-1].target
    if source.startswith("belt"):
        return STAYS if source == target else set()
    if target.startswith("belt"):
        return set()
    return RETURNS if source == target else PASSES


def in_order(pairs: Iterable[tuple[int, int, float]]) -> list[tuple[int, int]]:
    """Return the longest chain of pairs (i, j, cost) in which i and j both increase; of several, the cheapest."""
    rows = sorted(pairs, key=lambda pair: (pair[0], -pair[1]))
    # A Fenwick tree over j: the best chain (length, -cost, its last row) that ends before a given j.
    tree = [(0, 0.0, -1)] * (max((j for _, j, _ in rows), default=-1) + 2)
    links = []

    def best_before(j: int) -> tuple[int, float, int]:
        best = tree[0]
        while j > 0:
            best, j = max(best, tree[j]), j & (j - 1)
        return best

    for row, (_, j, cost) in enumerate(rows):
        length, gain, link = best_before(j)
        links.append(link)
        entry, k = (length + 1, gain - cost, row), j + 1
        while k < len(tree):
            tree[k], k = max(tree[k], entry), k + (k & -k)
    chain, row = [], best_before(len(tree) - 1)[2]
    while row >= 0:
        chain.append(rows[row][:2])
        row = links[row]
    return chain[::-1]
