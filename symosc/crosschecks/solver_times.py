"""Times at which a solver saw events, without their kinds: held against the exact events.

Such a list need not be whole: it has what the solver looked for. So an exact event that is not in it is judged by the
samples, and one that is in it, but is none, is invented.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symosc.crosschecks.events import WINDOW, FoundEvent
from symosc.crosschecks.matching import Match, Matcher, Matching


def with_times(matching: Matching, matcher: Matcher, times: Sequence[float]) -> Matching:
    """Return a matching in which the exact events have a solver's own times, as far as it lists any."""
    steps, exact = matcher.steps, matcher.exact
    if not len(times):
        return matching
    matched = {id(match.event): match for match in matching.matched}
    window, used, invented = WINDOW * steps.K.period, set[int](), list(matching.invented)
    for time in times:
        gaps = np.abs(matcher.times - time)
        nearest = int(np.argmin(gaps)) if len(gaps) else -1
        near = nearest >= 0 and gaps[nearest] <= window
        close = near and gaps[nearest] <= _allowed(matcher, nearest)
        if close and nearest not in used:
            used.add(nearest)
            event = exact[nearest]
            found = matched[id(event)].found if id(event) in matched else None
            matched[id(event)] = Match(event, time, found)
        elif not close and not _is_at_the_start(matcher, time):
            step = steps.at(time)[0]
            kind = exact[nearest].kind if near else "cross"
            invented.append(FoundEvent(time, kind, 0, "", "", step, step))
    ids = {id(exact[i]) for i in used}
    return replace(
        matching,
        matched=sorted(matched.values(), key=lambda match: float(match.event.t)),
        missed=[event for event in matching.missed if id(event) not in ids],
        invented=invented,
        unresolved=[event for event in matching.unresolved if id(event) not in ids],
    )


def _allowed(matcher: Matcher, i: int) -> float:
    """Return how far from its exact time an event may be: as far as that of the samples' own path is, and its reach."""
    row = matcher.local[i]
    own = 0.0 if row is None else abs(float(matcher.steps.events.t[row]) - float(matcher.times[i]))
    return float(matcher.reaches[i]) + own


def _is_at_the_start(matcher: Matcher, time: float) -> bool:
    start = float(matcher.steps.t[0])
    return any(abs(time - start) <= matcher.reach.of_start(boundary) for boundary in (1, 2))
