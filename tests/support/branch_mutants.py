"""Certificates of branches with one thing changed, and whether what they state is still true, judged in 40 digits."""

from __future__ import annotations

import copy
import itertools
import json
import random
from collections.abc import Iterator
from fractions import Fraction

from certificate_mutants import CHANGES, EVENT, Change, Document, another
from orbit_mutants import OF_A_WORD, cyclic, exact_orbit, rotated, within

from symosc.model import PARAMETER_NAMES

#: What only a trajectory has, or is done otherwise here.
OTHERS = (
    "start",
    "end",
    "first mode",
    "event added",
    "digit",
    "any digit",
    "sign",
    "box moved",
    "box wider",
    "box narrower",
)
INEQUALITIES = (
    "v < v1 during P2",
    "v > v1 during P3",
    "v < v2 during P3",
    "F^(1) < 0 where P3 ends",
    "P3 has positive duration",
)
KINDS = (
    "grazing",
    "birth of a stick",
    "birth of a slip",
    "vanishing of a flight",
    "end of the range",
)


def branch_is_true(document: Document, original: Document) -> bool:
    """Whether a changed certificate of a branch states what is true, at three values of each box and at both ends."""
    for name in ("periods", "parameter"):
        if document[name] != original[name]:
            return False
    events = document["events"]
    rows = document["boxes"]
    if [[row[n] for n in EVENT] for row in events] != [
        [row[n] for n in EVENT] for row in original["events"]
    ]:
        return False
    if not cyclic(document["word"], original["word"]) or (
        document["stable"] and not original["stable"]
    ):
        return False
    values = [[Fraction(each) for each in row["value"]] for row in rows]
    whole = [values[0][0], values[-1][1]] == [Fraction(each) for each in document["range"]]
    if not whole or any(a[1] != b[0] for a, b in itertools.pairwise(values)):
        return False
    changed = document["parameters"] != original["parameters"]
    if any(_box_is_wrong(document, row) for row in rows if changed or row not in original["boxes"]):
        return False
    ends = zip(
        document["ends"], original["ends"], document["range"], (rows[0], rows[-1]), strict=True
    )
    return all(_end_is_true(document, *each, changed) for each in ends)


def _orbit_in(document: Document, row: Document, value: Fraction) -> bool:
    """Whether there is an orbit in a box at a value of the parameter."""
    parameters = document["parameters"] | {document["parameter"]: str(value)}
    middles = [[sum(map(Fraction, ends)) / 2 for ends in row[name][:-1]] for name in "tx"]
    near = json.dumps([[float(t), float(x)] for t, x in zip(*middles, strict=True)])
    orbit = exact_orbit(json.dumps(parameters), rotated(document), near)
    if orbit is None:
        return False
    points = [(point.t, point.x) for point in orbit.points]
    points.append((points[0][0] + orbit.period, points[0][1]))
    shift = round(float(points[0][0] - float(middles[0][0])) / float(orbit.period)) * orbit.period
    return all(
        within(t - shift, ts) and within(x, xs)
        for (t, x), ts, xs in zip(points, row["t"], row["x"], strict=True)
    )


def _box_is_wrong(document: Document, row: Document) -> bool:
    low, high = map(Fraction, row["value"])
    return not all(_orbit_in(document, row, value) for value in (low, (low + high) / 2, high))


def _end_is_true(
    document: Document, end: Document, first: Document, value: str, row: Document, changed: bool
) -> bool:
    if end == first and not changed:
        return True
    about = {name: each for name, each in end.items() if name in ("kind", "inequality")}
    if about != {name: first[name] for name in about} or end["inside"] != value:
        return False
    if end["kind"] == "end of the range":
        return end["outside"] == value
    beyond = {"t": row["t"], "x": row["x"], "value": row["value"]}
    wide = copy.deepcopy(beyond)
    for name in "tx":
        wide[name] = [[str(Fraction(low) - 1), str(Fraction(high) + 1)] for low, high in wide[name]]
    return _orbit_in(document, wide, Fraction(value)) and not _orbit_in(
        document, wide, Fraction(end["outside"])
    )


# -- changes -----------------------------------------------------------------------------------------------------------


def as_rows(document: Document) -> Iterator[Document]:
    """Yield the boxes, and those of the ends, as documents whose events have t and x."""
    for row in [*document["boxes"], *(end for end in document["ends"] if "t" in end)]:
        events = [{"t": t, "x": x} for t, x in zip(row["t"], row["x"], strict=True)]
        yield {"events": events, "row": row}


def in_a_box(name: str) -> Change:
    """Return a change of one enclosure in one box."""

    def change(rng: random.Random, document: Document) -> None:
        box = rng.choice(list(as_rows(document)))
        CHANGES[name](rng, box)
        box["row"]["t"], box["row"]["x"] = (
            [event[each] for event in box["events"]] for each in "tx"
        )

    return change


def add_event(rng: random.Random, document: Document) -> None:
    rows = document["events"]
    i = rng.randrange(len(rows))
    rows.insert(i, copy.deepcopy(rows[i]))


def repeat_box(rng: random.Random, document: Document) -> None:
    i = rng.randrange(len(document["boxes"]))
    document["boxes"].insert(i, copy.deepcopy(document["boxes"][i]))


def swap_boxes(rng: random.Random, document: Document) -> None:
    rows = document["boxes"]
    i = rng.randrange(1, len(rows))
    rows[i]["t"], rows[i - 1]["t"] = rows[i - 1]["t"], rows[i]["t"]


def move_value(rng: random.Random, document: Document) -> None:
    """Let a box reach further, or less far, than the next one begins."""
    row = rng.choice(document["boxes"])
    i = rng.randrange(2)
    low, high = map(Fraction, row["value"])
    row["value"][i] = str(
        Fraction(row["value"][i]) + (high - low) * Fraction(rng.choice([-1, 1]), rng.randint(2, 9))
    )


def move_meeting(rng: random.Random, document: Document) -> None:
    """Let two boxes meet at another value."""
    rows = document["boxes"]
    i = rng.randrange(1, len(rows))
    low, high = map(Fraction, rows[i]["value"])
    rows[i]["value"][0] = rows[i - 1]["value"][1] = str(
        low + (high - low) * Fraction(rng.choice([-1, 1]), 10)
    )


def move_range(rng: random.Random, document: Document) -> None:
    i = rng.randrange(2)
    low, high = map(Fraction, document["range"])
    value = str(
        (low, high)[i] + (high - low) * Fraction(rng.choice([-1, 1]), 10 ** rng.randint(1, 6))
    )
    document["range"][i] = document["boxes"][-i]["value"][i] = document["ends"][i]["inside"] = value


def change_end(name: str) -> Change:
    """Return a change of a value at an end.

    To the other side of it, a little or much further away.
    """

    def change(rng: random.Random, document: Document) -> None:
        end = rng.choice([end for end in document["ends"] if name in end])
        width = abs(Fraction(end["inside"]) - Fraction(end["outside"])) or Fraction(1, 100)
        end[name] = str(
            Fraction(end[name]) + width * rng.choice([-1, 1]) * Fraction(rng.randint(1, 30), 10)
        )

    return change


def change_at(rng: random.Random, document: Document) -> None:
    end = rng.choice([end for end in document["ends"] if "at" in end])
    end["at"] = str(Fraction(end["at"]) + Fraction(rng.choice([-1, 1]), 10 ** rng.randint(0, 2)))


def change_inequality(rng: random.Random, document: Document) -> None:
    end = rng.choice([end for end in document["ends"] if "at" in end])
    end["inequality"] = rng.choice([each for each in INEQUALITIES if each != end["inequality"]])


BRANCH_CHANGES: dict[str, Change] = {
    name: change for name, change in CHANGES.items() if name not in OTHERS
} | OF_A_WORD
BRANCH_CHANGES |= {name: in_a_box(name) for name in OTHERS[4:]} | {
    "event added": add_event,
    "box dropped": lambda rng, it: it["boxes"].pop(rng.randrange(len(it["boxes"]))),
    "box repeated": repeat_box,
    "boxes swapped": swap_boxes,
    "value moved": move_value,
    "meeting moved": move_meeting,
    "range moved": move_range,
    "inside moved": change_end("inside"),
    "outside moved": change_end("outside"),
    "at moved": change_at,
    "inequality": change_inequality,
    "kind of an end": another("ends", "kind", among=KINDS),
    "ends swapped": lambda rng, it: it["ends"].reverse(),
    "parameter's name": another("parameter", among=PARAMETER_NAMES),
}
#: Changes that may leave a certificate true.
HARMLESS = {
    "digit",
    "any digit",
    "box moved",
    "box wider",
    "box narrower",
    "parameter",
    "meeting moved",
    "range moved",
}
HARMLESS |= {"inside moved", "outside moved", "at moved", "value moved"}
