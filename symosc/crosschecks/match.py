"""Match the events of a solution with the exact ones: the one matcher of the project.

Cross-checks, scores and benchmarks say which events belong together and how far apart two times
may be; `match_events` pairs them.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from typing import NamedTuple, Protocol, SupportsFloat

import numpy as np
from numpy.typing import ArrayLike


class TimedEvent(Protocol):
    """What is matched: a time, a kind, and a belt."""

    @property
    def t(self) -> SupportsFloat:
        """The time."""
        ...

    @property
    def kind(self) -> str:
        """Such as "stick"; "" if it is not known."""
        ...

    @property
    def boundary(self) -> int:
        """The belt, 1 or 2; 0 if it is not known."""
        ...


class Matching(NamedTuple):
    """The numbers of events that belong together, and of those without partner.

    Attributes
    ----------
    matched : list of pairs
        Pairs (number in `theirs`, number in `ours`), in order of time.
    missed : list of int
        Numbers of `ours` without partner.
    invented : list of int
        Numbers of `theirs` without partner.
    """

    matched: list[tuple[int, int]]
    missed: list[int]
    invented: list[int]


def match_events(
    theirs: Sequence[TimedEvent],
    ours: Sequence[TimedEvent],
    allowed: ArrayLike,
    *,
    spreads: ArrayLike = 0.0,
    second_times: Sequence[float | None] | None = None,
) -> Matching:
    """Match a solver's events with ours.

    Two events may be partners if they are of one kind, at one belt, and not too far apart in time.
    The kind "" and the belt 0 stand for any. Pairs are in order of time on both sides; there are as
    many as possible and, among such choices, the sum of their distances is smallest. So a missed
    event does not shift all later ones, and of repeated reports the nearest counts.

    Parameters
    ----------
    theirs, ours : sequences of events with t, kind and boundary, in order of time
    allowed : float, or one for each of `ours`
        How far their time may be from ours.
    spreads : float, or one for each of `theirs`
        How far a time of theirs may be off beside that, because it was read off samples or rounded.
    second_times : sequence, optional
        Another time for each of `ours`, or None; the nearer one counts.
    """
    reaches = np.broadcast_to(np.asarray(allowed, dtype=float), len(ours))
    slacks = np.broadcast_to(np.asarray(spreads, dtype=float), len(theirs)).tolist()
    our_times = [float(event.t) for event in ours]
    seconds = [None] * len(ours) if second_times is None else second_times
    both_times = zip(seconds, our_times, strict=True)
    gaps = [abs(second - time) for second, time in both_times if second is not None]
    # No partner of an event is farther away from it than this.
    farthest = float(np.max(reaches, initial=0.0)) + max(gaps, default=0.0)
    pairs = []
    for j, event in enumerate(theirs):
        time = float(event.t)
        window = farthest + slacks[j]
        first = bisect_left(our_times, time - window)
        last = bisect_right(our_times, time + window)
        for i in range(first, last):
            if not _are_alike(event, ours[i]):
                continue
            distance = abs(our_times[i] - time)
            second = seconds[i]
            if second is not None:
                distance = min(distance, abs(second - time))
            if distance <= reaches[i] + slacks[j]:
                pairs.append((i, j, distance))
    matched = [(j, i) for i, j in in_order(pairs)]
    matched_theirs = {j for j, _ in matched}
    matched_ours = {i for _, i in matched}
    return Matching(
        matched,
        [i for i in range(len(ours)) if i not in matched_ours],
        [j for j in range(len(theirs)) if j not in matched_theirs],
    )


def _are_alike(event: TimedEvent, own: TimedEvent) -> bool:
    """Return whether two events may be the same: of one kind and at one belt."""
    return event.kind in ("", own.kind) and event.boundary in (0, own.boundary)


class Chain(NamedTuple):
    """The length of a chain of pairs, minus its cost, and the row of its last pair.

    The best chain is the greatest: the longest and, among those, the cheapest.
    """

    length: int
    minus_cost: float
    last_row: int


NO_CHAIN = Chain(0, 0.0, -1)


def in_order(pairs: Iterable[tuple[int, int, float]]) -> list[tuple[int, int]]:
    """Return the longest chain of pairs (i, j, cost) with i and j increasing.

    Among these, the cheapest.
    """
    # Of pairs with one i the largest j comes first, so that none of them follows another one.
    rows = sorted(pairs, key=lambda pair: (pair[0], -pair[1]))
    # `tree` is a Fenwick tree over j, for maxima: its entry k holds the best chain that ends with
    # one of the j from k minus the lowest bit of k up to k - 1.
    tree = [NO_CHAIN] * (max((j for _, j, _ in rows), default=-1) + 2)
    previous_rows = []

    def best_before(j: int) -> Chain:
        """Return the best chain among those that end before j."""
        best = NO_CHAIN
        while j > 0:
            best = max(best, tree[j])
            j = j & (j - 1)  # without its lowest bit
        return best

    def enter(j: int, chain: Chain) -> None:
        """Note a chain that ends with j in all entries whose range has j."""
        k = j + 1
        while k < len(tree):
            tree[k] = max(tree[k], chain)
            k += k & -k  # its lowest bit

    for row, (_, j, cost) in enumerate(rows):
        before = best_before(j)
        previous_rows.append(before.last_row)
        enter(j, Chain(before.length + 1, before.minus_cost - cost, row))
    # The best chain of all, from its last pair to its first.
    backwards = []
    row = best_before(len(tree) - 1).last_row
    while row >= 0:
        i, j, _ = rows[row]
        backwards.append((i, j))
        row = previous_rows[row]
    return backwards[::-1]
