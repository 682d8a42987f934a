"""Certificates with one thing changed, and whether what they state is still true, judged in 45 digits."""

from __future__ import annotations

import copy
import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from symosc import Parameters, simulate

Document = dict[str, Any]
Change = Callable[[random.Random, Document], object]
MODES = ("Omega1", "Omega2", "Omega3", "belt1", "belt2")
EVENT = ("kind", "boundary", "source", "target")


def is_true(document: Document) -> bool:
    """Whether a trajectory's certificate for one exact start states what happens."""
    p = Parameters(**document["parameters"])
    run = simulate(p, **document["start"], t_end=document["t_end"], digits=45)
    if len(run.events) != len(document["events"]) or run.segments[0].mode != document["mode"]:
        return False
    for event, row in zip(run.events, document["events"], strict=True):
        if any(getattr(event, name) != row[name] for name in EVENT):
            return False
        for name in "tx":
            low, high = map(Fraction, row[name])
            if not low <= Fraction(str(getattr(event, name))) <= high:
                return False
    return True


def another(*path: str, among: Sequence[Any]) -> Change:
    """Return a change of a key, the last of a path through lists of objects, to another value."""

    def change(rng: random.Random, document: Document) -> None:
        place: Any = document
        for name in path[:-1]:
            place = rng.choice(place[name])
        place[path[-1]] = rng.choice([each for each in among if each != place[path[-1]]])

    return change


def number_in(where: str) -> Change:
    """Return a change of one of several numbers by a power of ten."""

    def change(rng: random.Random, document: Document) -> None:
        name = rng.choice(list(document[where]))
        step = Fraction(rng.choice([-1, 1]), 10 ** rng.randint(1, 12))
        document[where][name] = str(Fraction(document[where][name]) + step)

    return change


def interval(
    change: Callable[[random.Random, Fraction, Fraction], tuple[Fraction, Fraction]],
) -> Change:
    """Return a change of an interval of an event."""

    def changed(rng: random.Random, document: Document) -> None:
        row = rng.choice(document["events"])
        name = rng.choice("tx")
        row[name] = list(map(str, change(rng, *map(Fraction, row[name]))))

    return changed


def another_digit(text: str, rng: random.Random, last: int = 6) -> str:
    """Return a number with another digit among its last ones."""
    place = rng.choice([i for i, letter in enumerate(text) if letter.isdigit()][-last:])
    other = rng.choice([each for each in "0123456789" if each != text[place]])
    return text[:place] + other + text[place + 1 :]


def digit(last: int) -> Change:
    """Return a change of a digit among the last ones of an end."""

    def change(rng: random.Random, document: Document) -> None:
        ends = rng.choice(document["events"])[rng.choice("tx")]
        i = rng.randrange(2)
        ends[i] = another_digit(ends[i], rng, last)

    return change


def moved(rng: random.Random, low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    step = (high - low) * Fraction(
        rng.choice([-1, 1]) * rng.randint(2, 10 ** rng.randint(1, 22)), 2
    )
    return low + step, high + step


def wider(rng: random.Random, low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    more = (high - low) * 10 ** rng.randint(0, 12)
    return low - more, high + more


def narrower(rng: random.Random, low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    cut = low + Fraction(rng.randint(1, 999), 1000) * (high - low)
    if rng.random() < 0.5:
        return (low, cut)
    return (cut, high)


def add_event(rng: random.Random, document: Document) -> None:
    i = rng.randrange(len(document["events"]))
    row = copy.deepcopy(document["events"][i])
    if rng.random() < 0.5:
        row["t"] = [str(Fraction(end) + Fraction(1, 10)) for end in row["t"]]
        i += 1
    document["events"].insert(i, row)


def swap(rng: random.Random, rows: list[Any]) -> None:
    i = rng.randrange(len(rows))
    rows[i], rows[i - 1] = rows[i - 1], rows[i]


def change_end(rng: random.Random, document: Document) -> None:
    document["t_end"] = str(Fraction(document["t_end"]) * Fraction(rng.randint(5, 20), 10))


CHANGES: dict[str, Change] = {
    "digit": digit(6),
    "any digit": digit(40),
    "sign": interval(lambda rng, low, high: (-high, -low)),
    "box moved": interval(moved),
    "box wider": interval(wider),
    "box narrower": interval(narrower),
    "event dropped": lambda rng, it: it["events"].pop(rng.randrange(len(it["events"]))),
    "event added": add_event,
    "events swapped": lambda rng, it: swap(rng, it["events"]),
    "kind": another("events", "kind", among=("cross", "stick", "slip", "graze")),
    "source": another("events", "source", among=MODES),
    "target": another("events", "target", among=MODES),
    "boundary": another("events", "boundary", among=(1, 2)),
    "parameter": number_in("parameters"),
    "start": number_in("start"),
    "end": change_end,
    "first mode": another("mode", among=MODES),
}
