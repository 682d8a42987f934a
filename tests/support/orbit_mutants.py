"""Certificates of orbits and windows with one thing changed, and whether what they state is still true."""

from __future__ import annotations

import copy
import json
import random
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any

from certificate_mutants import CHANGES, EVENT, Change, Document, another, another_digit
from mpmath import mp

from symosc import ConvergenceError, Parameters, find_orbit, grazing_window
from symosc.orbits.periodic_orbit import PeriodicOrbit

DIGITS = 40
#: What only a trajectory has.
OTHERS = ("start", "end", "first mode")
CYCLE = "P12345678"


@cache
def exact_orbit(parameters: str, word: str, near: str) -> PeriodicOrbit | None:
    """Return the orbit at these parameters to many digits, or None if there is none."""
    points = [tuple(map(float, point)) for point in json.loads(near)]
    try:
        found = find_orbit(
            Parameters(**json.loads(parameters)), word, points, digits=DIGITS, periods=1
        )
    except (ConvergenceError, ValueError):
        return None
    if found.admissible:
        return found
    return None


def orbit_is_true(document: Document, original: Document) -> bool:
    """Whether a changed certificate of an orbit states what is true.

    `original` is one that does.
    """
    near = json.dumps([[row["t"][0], row["x"][0]] for row in original["events"][:-1]])
    word = rotated(original)
    if not cyclic(document["word"], original["word"]) or document["periods"] != original["periods"]:
        return False
    orbit = exact_orbit(json.dumps(document["parameters"]), word, near)
    rows = document["events"]
    firsts = original["events"]
    if orbit is None or [[row[n] for n in EVENT] for row in rows] != [
        [row[n] for n in EVENT] for row in firsts
    ]:
        return False
    points = [(point.t, point.x) for point in orbit.points]
    points.append((points[0][0] + orbit.period, points[0][1]))
    shift = round(float((points[0][0] - mp.mpf(firsts[0]["t"][0])) / orbit.period)) * orbit.period
    for (t, x), row in zip(points, rows, strict=True):
        if not (within(t - shift, row["t"]) and within(x, row["x"])):
            return False
    pairs = zip(orbit.multipliers, document["multipliers"], strict=True)
    exact = all(
        within(value.real, each["re"]) and within(value.imag, each["im"]) for value, each in pairs
    )
    return exact and document["stable"] is orbit.stable


def within(value: Any, ends: list[str]) -> bool:
    low, high = (Fraction(end) for end in ends)
    return low <= Fraction(
        str(mp.nstr(value, DIGITS - 5, strip_zeros=False))
    ) <= high or low == high == round(value, 30)


def rotated(document: Document) -> str:
    """Return the word begun at the first event of a file."""
    maps = {
        (1, "belt1", 1): 1,
        (1, "Omega1", 1): 2,
        (1, "Omega2", 1): 3,
        (2, "belt2", 2): 4,
        (2, "Omega2", 2): 5,
    }
    maps |= {(2, "Omega3", 2): 6, (2, "Omega2", 1): 7, (1, "Omega2", 2): 8}
    rows = document["events"]
    labels = [maps[a["boundary"], a["target"], b["boundary"]] for a, b in pairwise(rows)]
    return "P" + "".join(map(str, reversed(labels)))


def cyclic(word: str, other: str) -> bool:
    return len(word) == len(other) and word[:1] == "P" and word[1:] in other[1:] * 2


def change_word(rng: random.Random, document: Document) -> None:
    word = document["word"]
    i = rng.randrange(1, len(word))
    document["word"] = (
        word[:i] + rng.choice([each for each in CYCLE[1:] if each != word[i]]) + word[i + 1 :]
    )


def change_word_length(rng: random.Random, document: Document) -> None:
    if rng.random() < 0.5:
        document["word"] = document["word"][:-1]
    else:
        document["word"] = document["word"] + document["word"][1:]


def change_multiplier(rng: random.Random, document: Document) -> None:
    row = rng.choice(document["multipliers"])
    name = rng.choice(["re", "im"])
    low, high = map(Fraction, row[name])
    step = max(high - low, Fraction(1, 10**15)) * rng.choice([-1, 1]) * rng.randint(2, 10**9)
    row[name] = [str(low + step), str(high + step)]


def move_all(rng: random.Random, document: Document) -> None:
    step = Fraction(rng.choice([-1, 1]), 10 ** rng.randint(1, 22))
    for row in document["events"]:
        row["x"] = [str(Fraction(end) + step) for end in row["x"]]


#: What orbits and branches have in common.
OF_A_WORD: dict[str, Change] = {
    "word": change_word,
    "word length": change_word_length,
    "periods": another("periods", among=(1, 2, 3, 4, 5)),
    "stable": lambda rng, it: it.update(stable=not it["stable"]),
}
ORBIT_CHANGES = {name: change for name, change in CHANGES.items() if name not in OTHERS} | OF_A_WORD
ORBIT_CHANGES |= {
    "multiplier": change_multiplier,
    "multipliers swapped": lambda rng, it: it["multipliers"].reverse(),
    "all moved": move_all,
    "closes later": lambda rng, it: it["events"].append(copy.deepcopy(it["events"][1])),
}


def change_phase(rng: random.Random, document: Document) -> None:
    for end in document["ends"][-1:]:
        i = rng.randrange(2)
        end["phase"][i] = another_digit(end["phase"][i], rng)


def change_sine(rng: random.Random, document: Document) -> None:
    for end in document["ends"][:1]:
        end["sine"] = str(
            Fraction(end["sine"]) + Fraction(rng.choice([-1, 1]), 10 ** rng.randint(1, 20))
        )


def change_cosine(rng: random.Random, document: Document) -> None:
    for end in document["ends"][:1]:
        end["cosine"] = rng.choice([each for each in (-1, 0, 1) if each != end["cosine"]])


WINDOW_CHANGES: dict[str, Change] = {
    "grazes": another(
        "grazes", among=("nowhere", "everywhere", "everywhere but at one phase", "on an arc")
    ),
    "map": another("map", among=("P2", "P3", "P5", "P6")),
    "order": another("order", among=("full", "paper")),
    "phase": change_phase,
    "sine": change_sine,
    "cosine": change_cosine,
    "ends swapped": lambda rng, it: it["ends"].reverse(),
    "end dropped": lambda rng, it: it.update(ends=it["ends"][1:]),
    "parameter": CHANGES["parameter"],
}


def window_is_true(document: Document) -> bool:
    """Whether a changed certificate of a window states what is true, by the window's own ends and membership."""
    window = grazing_window(
        Parameters(**document["parameters"]), document["map"], document["order"]
    )
    kinds = {
        0: "nowhere",
        1: "everywhere",
        2: "everywhere but at one phase",
        3: "on an arc",
        4: "on an arc",
    }
    ends = document["ends"]
    if kinds[window.kind] != document["grazes"] or len(ends) != {2: 1, 3: 2, 4: 2}.get(
        window.kind, 0
    ):
        return False
    if not ends:
        return True
    with mp.workdps(DIGITS):
        sine = (
            -mp.mpf(window.gamma.numerator)
            / window.gamma.denominator
            / mp.mpf(window.amplitude.numerator)
        )
        sine *= window.amplitude.denominator
        rising = mp.asin(sine)
        falling = mp.pi - mp.asin(sine)
        up = window.place.side * window.amplitude > 0
        if up:
            wanted = [(rising, 1), (falling, -1)]
        else:
            wanted = [(falling, -1), (rising, 1)]
        if len(ends) == 1:
            wanted = [(rising, 0)]
        for (phase, cosine), end in zip(wanted, ends, strict=True):
            low, high = (mp.mpf(each) for each in end["phase"])
            turns = mp.nint((low - phase) / (2 * mp.pi))
            if not low <= phase + 2 * mp.pi * turns <= high or cosine != end["cosine"]:
                return False
            if Fraction(end["sine"]) != -window.gamma / window.amplitude:
                return False
    return True
