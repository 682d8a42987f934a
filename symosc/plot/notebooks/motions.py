"""Pages of motions: one, and many in columns."""

from __future__ import annotations

from typing import Any

import numpy as np

from symosc.display.html import MOST_POINTS, curve, ends, facts, page, shown, table
from symosc.simulation.tables import EventTable, Summary, counted, statuses
from symosc.simulation.trajectory import Trajectory

HEADS = ("t", "x", "v", "kind", "belt", "from", "to", "t error")
#: Characters of a word, and of a number with many digits, that a page shows.
LONGEST_SHOWN, LONGEST_NUMBER = 60, 24
#: Events that have a dot in the picture, at most.
MOST_DOTS = 60


def trajectory_page(path: Trajectory) -> str:
    """Return the page of a motion: its events, how it ended, and x against t."""
    begin, end = float(path.t_start), float(path.t_end)
    line = f"t = {begin:g} … {end:g}, {counted(len(path.events), 'event')}: {path.status}"
    rows = [_row(path, i) for i in ends(len(path.events))]
    times = np.clip(np.linspace(begin, end, MOST_POINTS), begin, end)
    dots = [(float(event.t), float(event.x)) for event in path.events] if len(path.events) <= MOST_DOTS else []
    drawn = curve(f"x against t, from {begin:g} to {end:g}", times, path(times)[0], dots)
    about = facts({"word": cut(" ".join(path.word) or "none"), "ended": path.message, "digits": path.digits})
    return page("Trajectory", line, table(HEADS, rows, len(path.events)) if rows else "", drawn, about)


def _row(path: Trajectory, i: int) -> list[Any]:
    event = path.events[i]
    numbers = (event.t, event.x, event.v)
    texts = [shown(float(n)) if path.digits is None else n.context.nstr(n, LONGEST_NUMBER) for n in numbers]
    return [*texts, event.kind, event.boundary, event.source, event.target, f"{event.t_error:.0e}"]


def events_page(events: EventTable) -> str:
    """Return the page of the events of many motions."""
    heads = ("motion", *HEADS)
    names = ("trajectory", "t", "x", "v", "kind", "boundary", "source", "target", "t_error")
    some = np.array(ends(len(events)), dtype=int)
    few = events.rows(some, [])
    columns = [getattr(few, name) for name in names]
    rows = [[*row[:-1], f"{row[-1]:.0e}"] for row in zip(*columns, strict=True)]
    line = f"{counted(len(events), 'event')} of {counted(len(events.status), 'motion')}"
    return page(
        "EventTable", line, table(heads, rows, len(events)) if rows else "", facts({"ended": statuses(events.status)})
    )


def summary_page(summary: Summary) -> str:
    """Return the page of what became of many motions: a row each, and the words from the most frequent on."""
    columns = {name: column for name, column in summary.columns().items() if name != "section"}
    some = ends(len(summary))
    rows = [[i, *(cut(str(shown(column[i]))) for column in columns.values())] for i in some]
    ended = statuses(summary.status) if len(summary.status) else None
    kept = counted(summary.section.shape[1], "point") if isinstance(summary.section, np.ndarray) else None
    about = facts({"ended": ended, "words": _frequent(summary.word), "section": kept})
    return page("Summary", counted(len(summary), "motion"), table(["motion", *columns], rows, len(summary)), about)


def _frequent(words: Any) -> str | None:
    """Return the most frequent words with how often they are there."""
    if not len(words):
        return None
    names, counts = np.unique(words, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:5]
    more = f", and {len(names) - 5} more" if len(names) > 5 else ""
    said = (f"{cut(str(names[i])) or 'no event'} ({counts[i]:,})" for i in order)
    return ", ".join(said) + more


def cut(text: str) -> str:
    """Return text that is not longer than a page has room for."""
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"
