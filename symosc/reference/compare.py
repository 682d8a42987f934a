"""Compare a solver's events with those of a reference: errors, missed and invented events.

The two lists are aligned as sequences: events of one kind on one boundary match within a window of time, in the order
of both lists. Of the alignments with the most matches the nearest is taken: so one missed event does not shift all
later ones, and of repeated reports of an event the nearest counts and the others are invented.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite, pi, ulp
from typing import Any, NamedTuple

from symosc.aliases import Number, Record
from symosc.crosschecks.events import WINDOW, in_order
from symosc.scenes import Scene
from symosc.simulation.trajectory import Event

#: What `relative_error` is, for readers of tables.
ERRORS = "of event times relative to max(1, t - t0), of positions to max(1, |x|)"
#: The error that an event may have in a score.
SCORE_TOLERANCE = 1e-9
#: The unit of errors, per condition; and how many units an error may have where that is more than the tolerance.
ROUNDING_UNIT, UNITS_ALLOWED = 1e-16, 100.0
#: An event of a wrong kind stands for a missed one if it is nearer to it than this, in forcing periods.
KIND_WINDOW = 0.005
#: Digits of the runs that errors are measured against.
REFERENCE_DIGITS = 40


class FoundEvent(NamedTuple):
    """A switching event as a solver reports it, in the words of `symosc.Event`; dt_mu1, ... are in `changes`."""

    t: float
    x: float
    kind: str
    boundary: int
    changes: Mapping[str, float] = {}


def compare(found: Iterable[FoundEvent], scene: Scene, exact: Sequence[Event]) -> Record:
    """Compare a solver's events with the exact ones of a scene: largest errors, and how many are missed or invented."""
    # Keys: error_t, error_x, error (the larger one; None if nothing can be compared), missed and invented (numbers),
    # missed_grazes (which do not count as missed), and first_wrong (the time of the first missed or invented event).
    given, times = list(found), [float(event.t) for event in exact]
    ordered = sorted((event for event in given if isfinite(event.t) and isfinite(event.x)), key=lambda event: event.t)
    pairs = align(ordered, exact, times, WINDOW * 2 * pi / float(scene.parameters.Omega))
    unmatched = set(range(len(exact))) - {i for i, _ in pairs}
    missed = [times[i] for i in unmatched if exact[i].kind != "graze"]
    invented = [ordered[j].t for j in set(range(len(ordered))) - {j for _, j in pairs}]
    of_t = [relative_error(ordered[j].t, exact[i].t, float(scene.t0)) for i, j in pairs]
    of_x = [relative_error(ordered[j].x, exact[i].x) for i, j in pairs]
    return {
        "error": max(of_t + of_x, default=None),
        "error_t": max(of_t, default=None),
        "error_x": max(of_x, default=None),
        "missed": len(missed),
        "invented": len(given) - len(pairs),
        "missed_grazes": len(unmatched) - len(missed),
        "first_wrong": min(missed + invented, default=None),
    }


def relative_error(value: Number, exact: Number, start: Number = 0) -> float:
    """Return |value - exact| relative to max(1, |exact - start|)."""
    # For a time `start` is t0: a late start is no excuse for a late event. What rounding t0 to a double does is no
    # error.
    rounding = ulp(float(start)) if start else 0
    return float(max(0, abs(exact - value) - rounding) / max(1, abs(exact - start)))


def align(
    found: Sequence[Any], reference: Sequence[Any], times: Sequence[float], window: float
) -> list[tuple[int, int]]:
    """Return the pairs (reference, found) of the best alignment: as many as possible, and of these the nearest."""
    # Events have a kind and a boundary. Those found have a t, and are in order of it; `times` are those of the
    # reference, and no pair is farther apart than the window.
    found_times, pairs = [float(event.t) for event in found], []
    for i, (event, time) in enumerate(zip(reference, times, strict=True)):
        for j in range(bisect_left(found_times, time - window), bisect_right(found_times, time + window)):
            if (found[j].kind, found[j].boundary) == (event.kind, event.boundary):
                pairs.append((i, j, abs(found_times[j] - time)))
    return in_order(pairs)
