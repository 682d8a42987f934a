"""Matching of events: as many pairs as possible, in order of time, and then the nearest."""

from __future__ import annotations

from itertools import combinations, pairwise, product
from typing import NamedTuple

import numpy as np
import pytest

from symosc.crosschecks.match import in_order, match_events


class Heard(NamedTuple):
    """An event that somebody reports."""

    t: float
    kind: str
    boundary: int


def chains_of(cells: list[tuple[int, int]]) -> list[tuple[tuple[int, int], ...]]:
    """Return all rows of cells in which both numbers increase."""
    return [
        chain
        for count in range(len(cells) + 1)
        for chain in combinations(cells, count)
        if all(a[0] < b[0] and a[1] < b[1] for a, b in pairwise(chain))
    ]


def test_the_longest_chain_is_the_best_of_all() -> None:
    rng = np.random.default_rng(6)
    for _ in range(200):
        cells = [(i, j) for i, j in product(range(4), range(4)) if rng.random() < 0.4]
        pairs = [(i, j, float(rng.integers(1, 9))) for i, j in cells]
        cost = {pair[:2]: pair[2] for pair in pairs}
        best = min(
            chains_of(cells), key=lambda chain: (-len(chain), sum(cost[pair] for pair in chain))
        )
        chosen = in_order(pairs)
        assert set(chosen) <= set(cells)
        assert all(a[0] < b[0] and a[1] < b[1] for a, b in pairwise(chosen))
        assert (len(chosen), sum(cost[pair] for pair in chosen)) == (
            len(best),
            sum(cost[pair] for pair in best),
        )


def test_events_are_matched_as_the_best_of_all_choices() -> None:
    rng = np.random.default_rng(7)

    def events(kinds: list[str], belts: list[int]) -> list[Heard]:
        times = sorted(rng.uniform(0.0, 3.0, rng.integers(0, 5)).tolist())
        return [Heard(t, str(rng.choice(kinds)), int(rng.choice(belts))) for t in times]

    for _ in range(200):
        theirs = events(["stick", "slip", ""], [0, 1, 2])
        ours = events(["stick", "slip"], [1, 2])
        allowed = rng.uniform(0.1, 1.0, len(ours))
        spreads = rng.choice([0.0, 0.3], len(theirs))
        seconds = [
            event.t + float(rng.uniform(-0.5, 0.5)) if rng.random() < 0.4 else None
            for event in ours
        ]

        def distance(j: int, i: int) -> float:
            own = (ours[i].t, seconds[i])  # noqa: B023  called at once
            return min(abs(t - theirs[j].t) for t in own if t is not None)  # noqa: B023

        cells = [
            (j, i)
            for j, i in product(range(len(theirs)), range(len(ours)))
            if theirs[j].kind in ("", ours[i].kind)
            and theirs[j].boundary in (0, ours[i].boundary)
            and distance(j, i) <= allowed[i] + spreads[j]
        ]
        best = min(
            chains_of(cells),
            key=lambda chain: (-len(chain), sum(distance(*pair) for pair in chain)),
        )
        matching = match_events(theirs, ours, allowed, spreads=spreads, second_times=seconds)
        assert set(matching.matched) <= set(cells)
        assert len(matching.matched) == len(best)
        total = sum(distance(*pair) for pair in matching.matched)
        assert total == pytest.approx(sum(distance(*pair) for pair in best))
        matched_theirs = {j for j, _ in matching.matched}
        assert sorted(matched_theirs | {*matching.invented}) == [*range(len(theirs))]
        assert not matched_theirs & {*matching.invented}
        matched_ours = {i for _, i in matching.matched}
        assert sorted(matched_ours | {*matching.missed}) == [*range(len(ours))]
        assert not matched_ours & {*matching.missed}


def test_a_missed_event_shifts_no_other_and_of_two_reports_the_nearer_counts() -> None:
    ours = [Heard(float(t), "cross", 1) for t in range(5)]
    theirs = [Heard(t, "cross", 1) for t in (0.01, 2.0, 2.03, 3.0, 4.0)]
    assert match_events(theirs, ours, 0.1) == ([(0, 0), (1, 2), (3, 3), (4, 4)], [1], [2])
    assert match_events([], ours, 0.1) == ([], [0, 1, 2, 3, 4], [])
    assert match_events(theirs, [], 0.1) == ([], [], [0, 1, 2, 3, 4])
