"""Certificates with one thing changed, and whether what they state is still true, judged in 45 digits."""

from __future__ import annotations

import copy
import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from symosc import Parameters, simulate

Document = dict[str, Any]
Change = Callable[[random.Random, Document], None]
MODES = ("Omega1", "Omega2", "Omega3", "belt1", "belt2")


def is_true(document: Document) -> bool:
    """Whether a trajectory's certificate for one exact start states what happens."""
    p = Parameters(**document["parameters"])
    run = simulate(p, **document["start"], t_end=document["t_end"], digits=45)
    if len(run.events) != len(document["events"]) or run.segments[0].mode != document["mode"]:
        return False
    for event, row in zip(run.events, document["events"], strict=True):
        if any(getattr(event, name) != row[name] for name in ("kind", "boundary", "source", "target")):
            return False
        for name in "tx":
            low, high = map(Fraction, row[name])
            if not low <= Fraction(str(getattr(event, name))) <= high:
                return False
    return True


def row_of(rng: random.Random, document: Document) -> Document:
    return rng.choice(document["events"])


def digit(text: str, rng: random.Random, last: int = 6) -> str:
    """Return a number with another digit among its last ones."""
    places = [i for i, letter in enumerate(text) if letter.isdigit()][-last:]
    place = rng.choice(places)
    other = rng.choice([each for each in "0123456789" if each != text[place]])
    return text[:place] + other + text[place + 1 :]


def change_digit(rng: random.Random, document: Document) -> None:
    ends = row_of(rng, document)[rng.choice("tx")]
    i = rng.randrange(2)
    ends[i] = digit(ends[i], rng)


def change_any_digit(rng: random.Random, document: Document) -> None:
    ends = row_of(rng, document)[rng.choice("tx")]
    i = rng.randrange(2)
    ends[i] = digit(ends[i], rng, 40)


def change_sign(rng: random.Random, document: Document) -> None:
    row = row_of(rng, document)
    low, high = map(Fraction, row["x"])
    row["x"] = [str(-high), str(-low)]


def move_box(rng: random.Random, document: Document) -> None:
    row, name = row_of(rng, document), rng.choice("tx")
    low, high = map(Fraction, row[name])
    step = (high - low) * Fraction(rng.choice([-1, 1]) * rng.randint(2, 10 ** rng.randint(1, 22)), 2)
    row[name] = [str(low + step), str(high + step)]


def widen_box(rng: random.Random, document: Document) -> None:
    row, name = row_of(rng, document), rng.choice("tx")
    low, high = map(Fraction, row[name])
    more = (high - low) * 10 ** rng.randint(0, 12)
    row[name] = [str(low - more), str(high + more)]


def narrow_box(rng: random.Random, document: Document) -> None:
    row, name = row_of(rng, document), rng.choice("tx")
    low, high = map(Fraction, row[name])
    share = Fraction(rng.randint(1, 999), 1000)
    cut = low + share * (high - low)
    row[name] = [str(low), str(cut)] if rng.random() < 0.5 else [str(cut), str(high)]


def drop_event(rng: random.Random, document: Document) -> None:
    del document["events"][rng.randrange(len(document["events"]))]


def add_event(rng: random.Random, document: Document) -> None:
    i = rng.randrange(len(document["events"]))
    row = copy.deepcopy(document["events"][i])
    if rng.random() < 0.5:
        row["t"] = [str(Fraction(end) + Fraction(1, 10)) for end in row["t"]]
        i += 1
    document["events"].insert(i, row)


def swap_events(rng: random.Random, document: Document) -> None:
    rows = document["events"]
    i = rng.randrange(len(rows))
    rows[i], rows[i - 1] = rows[i - 1], rows[i]


def change_kind(rng: random.Random, document: Document) -> None:
    row = row_of(rng, document)
    row["kind"] = rng.choice([kind for kind in ("cross", "stick", "slip", "graze") if kind != row["kind"]])


def change_mode(rng: random.Random, document: Document) -> None:
    row, name = row_of(rng, document), rng.choice(["source", "target"])
    row[name] = rng.choice([mode for mode in MODES if mode != row[name]])


def change_boundary(rng: random.Random, document: Document) -> None:
    row = row_of(rng, document)
    row["boundary"] = 3 - row["boundary"]


def change_parameter(rng: random.Random, document: Document) -> None:
    values, name = document["parameters"], rng.choice(list(document["parameters"]))
    change = Fraction(rng.choice([-1, 1]), 10 ** rng.randint(1, 12))
    values[name] = str(Fraction(values[name]) + change)


def change_start(rng: random.Random, document: Document) -> None:
    name = rng.choice(list(document["start"]))
    document["start"][name] = str(
        Fraction(document["start"][name]) + Fraction(rng.choice([-1, 1]), 10 ** rng.randint(1, 12))
    )


def change_end(rng: random.Random, document: Document) -> None:
    document["t_end"] = str(Fraction(document["t_end"]) * Fraction(rng.randint(5, 20), 10))


def change_first_mode(rng: random.Random, document: Document) -> None:
    document["mode"] = rng.choice([mode for mode in MODES if mode != document["mode"]])


CHANGES: dict[str, Change] = {
    "digit": change_digit,
    "any digit": change_any_digit,
    "sign": change_sign,
    "box moved": move_box,
    "box wider": widen_box,
    "box narrower": narrow_box,
    "event dropped": drop_event,
    "event added": add_event,
    "events swapped": swap_events,
    "kind": change_kind,
    "mode": change_mode,
    "boundary": change_boundary,
    "parameter": change_parameter,
    "start": change_start,
    "end": change_end,
    "first mode": change_first_mode,
}
