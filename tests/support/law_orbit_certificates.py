"""Certificates of orbits of other friction laws than the paper's, and whether a file about one states
what the shooting oracle finds.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from random import Random
from typing import Any

import law_oracle
import shooting_oracle
from certificate_files import Document
from certificate_files import document as document_of
from certificate_mutants import EVENT, Change
from law_certificates import LAW_CHANGES, OFF, exact
from law_oracle import LawBelt
from law_orbits import STICK_SLIP, driven
from orbit_mutants import ORBIT_CHANGES

from symosc import Belt, Oscillator, find_orbit

SHARED: Any = {"m": 1, "c": "1/10", "k": 1, "B0": 1, "Omega": "3/2"}
LAWS = {
    "stick-slip": STICK_SLIP,
    "driven": driven("0.98"),
    "falling": Oscillator(**SHARED, belts=[Belt("1/5", curve=[(0, "2/5"), (1, "1/5")])]),
    "contracting": Oscillator(
        **SHARED, belts=[Belt("1/5", curve=[(0, "2/5"), (1, "2/5"), (2, "4/5")])]
    ),
    "three": Oscillator(
        m=1, c="0.2", k=1, B0=3, Omega=2,
        belts=[Belt(-1, mu="0.5"), Belt(0, mu="0.5", mu_s="0.829"), Belt(1, mu="0.3")],
    ),
}  # fmt: skip


@cache
def orbit_of(name: str) -> Any:
    return find_orbit(LAWS[name])


def orbit_is_true(document: Document, name: str) -> bool:
    """Whether a file about an orbit states what the oracle finds; corners are not looked at."""
    original = document_of(f"law-orbit {name}")
    for key in ("word", "periods", "stable", "multipliers", "alone_within"):
        if document[key] != original[key]:
            return False
    rows = [row for row in document["events"] if row["kind"] != "corner"]
    p = dict(document["parameters"])
    p["belts"] = [
        LawBelt(belt["v"], None, belt["mu_s"], belt["curve"], belt["slope"])
        for belt in p.pop("belts")
    ]
    p = {key: value if key == "belts" else Fraction(value) for key, value in p.items()}
    orbit = orbit_of(name)
    t, x, v = orbit.start
    try:
        truth = shooting_oracle.periodic_orbit(p, t, x, v, float(orbit.period))
    except (AssertionError, ArithmeticError):
        return False
    numbers = (shooting_oracle.exact(value) for value in truth[:4])
    t, x, v, period = (Fraction(int(q.numerator), int(q.denominator)) for q in numbers)
    run = law_oracle.follow(**p, t0=t, x0=x, v0=v, t_end=t + 5 * period / 2, digits=40)
    for first in range(len(run.events) - len(rows) + 1):
        events = run.events[first : first + len(rows)]
        if all(
            row[key] == getattr(event, key)
            for row, event in zip(rows, events, strict=True)
            for key in EVENT
        ) and _has_points(rows, events, period, document["periods"]):
            return True
    return False


def _has_points(rows: list[Document], events: list[Any], period: Fraction, periods: int) -> bool:
    """Whether times and positions lie in the enclosures; without a drive the first time is any."""
    begin = sum(map(Fraction, rows[0]["t"])) / 2
    shift = begin - exact(events[0].t)
    spare = OFF
    if periods:
        shift = round(shift / period) * period
    else:
        spare += Fraction(rows[0]["t"][1]) - Fraction(rows[0]["t"][0])
    for row, event in zip(rows, events, strict=True):
        values = {"t": exact(event.t) + shift, "x": exact(event.x)}
        for key, value in values.items():
            low, high = map(Fraction, row[key])
            if not low - spare <= value <= high + spare:
                return False
    return True


def reach_too_small(rng: Random, document: Document) -> None:
    rng.choice(document["events"])["reach"] = "-1e-30"


def box_larger(rng: Random, document: Document) -> None:
    place = rng.randrange(2)
    document["alone_within"][place] = rng.choice(["1", "-1e-20", "1e5"])


ONLY_OF_MOTIONS = ("start", "end", "first mode")
LAW_ORBIT_CHANGES: dict[str, Change] = {
    name: change
    for name, change in (ORBIT_CHANGES | LAW_CHANGES).items()
    if name not in (*ONLY_OF_MOTIONS, "word")
} | {
    "another word": lambda rng, it: it.update(word=rng.choice(["S1", "B1∘B1", "P12", "", "A1∘S1"])),
    "no periods": lambda rng, it: it.update(periods=1 - it["periods"]),
    "reach": reach_too_small,
    "box larger": box_larger,
}
