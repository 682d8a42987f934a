"""Forged files about other friction laws than the paper's.

Each is refused by the checker, and gets through where one of its requirements is dropped.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from certificate_files import Document, document, moved, put

from symosc import Belt, Certificate, Oscillator, Scene, certify, find_orbit

FREE: Any = {"m": 1, "c": 0, "k": 1}
#: Damping -9/5 below the belt, about the equilibrium at x = 28000.2: there motions grow.
GROWING = Oscillator(m=1, c=1, k=1, belts=[Belt(1, curve=[(0, 28003), (10_000, 3)])])


def made(law: Oscillator, start: tuple[Any, Any, Any], t_end: Any) -> Document:
    """Return a certificate without its message."""
    scene = Scene("forged", law, *map(Fraction, start), Fraction(t_end))
    found: Certificate = certify(scene)
    assert found.proven, found.message
    whole = dict(found.as_dict())
    del whole["message"]
    return whole


def first(whole: Document, count: int, spare: str = "1e-3") -> Document:
    """Return a file with its first events only, up to a little after the last one."""
    rows = whole["events"][:count]
    return whole | {"events": rows, "t_end": moved(rows[-1]["t"], spare)[1]}


def crossing_through_static_friction() -> Document:
    """A crossing with F above = 1.1, on a belt that holds 2 more than kinetic friction."""
    law = Oscillator(**FREE, belts=[Belt(1, mu="1/10")])
    law = law.replace(belts=[*law.belts, Belt(90, mu=0, mu_s="1/100")])  # no law of the paper
    whole = first(made(law, (0, -2, 0), 1), 1)
    assert whole["events"][0]["kind"] == "cross"
    return put(whole, "parameters", "belts", 0, "mu_s", "5")


def slip_against_static_friction() -> Document:
    """A slip where kinetic friction ends to hold."""
    law = Oscillator(**FREE, belts=[Belt("1/5", mu="1/2"), Belt(90, mu=0, mu_s="1/100")])
    whole = first(made(law, (0, 0, "1/5"), 4), 1)
    assert whole["events"][0]["kind"] == "slip"
    return put(whole, "parameters", "belts", 0, "mu_s", "1/2")


def slip_of_kinetic_friction() -> Document:
    """The same with more static friction than that."""
    return put(slip_against_static_friction(), "parameters", "belts", 0, "mu_s", "1")


def growing(x0: str, t_end: Any) -> Document:
    """A motion that is said to meet no belt until a time."""
    whole = made(GROWING, (0, x0, 0), "1/100")
    return whole | {"t_end": str(t_end)}


def hidden_growth() -> list[Document]:
    """Say that nothing happens, until several times, while v grows beyond the belt and comes back."""
    return [growing("28000.1942", Fraction(t, 8)) for t in range(100, 112)]


def growth_that_settles() -> Document:
    return growing("28000.1999", 15)


def constant_friction_with_a_curve() -> Document:
    """The motion of constant friction, stated for a curve that falls."""
    law = Oscillator(**FREE, belts=[Belt(1, mu="2/5"), Belt(90, mu=0, mu_s="1/100")])
    whole = first(made(law, (0, -1, "1/2"), 1), 1)
    return put(whole, "parameters", "belts", 0, "curve", [["0", "2/5"], ["1", "1/5"]])


def graze_of_static_friction() -> Document:
    """The exact graze of a belt that would hold the mass."""
    whole = document("circle")
    p = dict(whole["parameters"])
    belts = [
        {"v": p.pop(f"v{n}"), "curve": [["0", p[f"mu{n}"]]], "slope": "0", "mu_s": p.pop(f"mu{n}")}
        for n in (1, 2)
    ]
    belts[0]["mu_s"] = "1/5"
    p["belts"] = belts
    return whole | {"parameters": p}


def arrival_at_the_limit_that_crosses() -> Document:
    whole = first(document("law S3"), 1)
    row = whole["events"][0] | {"kind": "cross", "target": "Omega2"}
    return whole | {"events": [row]}


def arrival_beyond_the_limit_that_sticks() -> Document:
    """The force is a little more than what static friction holds, and soon less."""
    law = Oscillator(**FREE, belts=[Belt("3/2", mu="1/2", mu_s=1)])
    whole = made(law, (0, "-1.6214", 0), 3)
    whole = first(whole, 1)
    assert whole["events"][0]["kind"] == "cross"
    row = whole["events"][0] | {"kind": "stick", "target": "belt1"}
    return whole | {"events": [row]}


def rest_that_slips() -> Document:
    law = Oscillator(m=1, c=0, k=1, B0="6/5", Omega=1, belts=[Belt(0, mu="1/2", mu_s=1)])
    whole = made(law, (0, "4/5", 0), "1/10")
    return whole | {"t_end": "40"}


def belt_without_number() -> Document:
    return put(document("law S1"), "events", 0, "boundary", 0)


def belts_not_met(*path: Any) -> Document:
    """A motion far from its belt, with a number of the belt that is not one of the model."""
    law = Oscillator(**FREE, belts=[Belt(50, curve=[(0, "2/5"), (1, "1/5")], mu_s=1)])
    return put(made(law, (0, 0, "1/2"), 1), "parameters", "belts", 0, *path)


def other_way_in() -> Document:
    """An orbit whose first event comes from the other side than its last one."""
    return put(document("law-orbit stick-slip"), "events", 0, "source", "Omega2")


def cycle_between_0_and_0() -> Document:
    """A cycle that begins at t = 0, of which an open interval from 0 to 0 is stated."""
    whole = document("law-orbit stick-slip")
    rows = whole["events"]
    begin = sum(map(Fraction, rows[0]["t"])) / 2
    shifted = [row | {"t": moved(row["t"], -begin)} for row in rows]
    return whole | {"events": [shifted[0] | {"t": ["0", "0"]}, *shifted[1:]]}


def twice_round_a_cycle() -> Document:
    whole = document("law-orbit stick-slip")
    rows = whole["events"]
    period = Fraction(rows[-1]["t"][0]) - Fraction(rows[0]["t"][0])
    again = [row | {"t": moved(row["t"], period, "1e-20")} for row in rows[1:]]
    return whole | {"events": rows + again, "word": "S1∘B1∘S1∘B1"}


def steady_motion_beyond_a_belt() -> Document:
    """The steady motion of a band, which would be larger than the speed of the belt."""
    law = Oscillator(m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt(30, 1, mu_s=2)])
    whole = dict(certify(find_orbit(law, x0=1)).as_dict())
    del whole["message"]
    return put(whole, "parameters", "belts", 0, "v", "1/10")


def drive_left_out() -> Document:
    """An orbit with a drive that is said to be a cycle without one."""
    whole = document("law-orbit falling")
    wide = {"re": ["-9", "9"], "im": ["-9", "9"]}
    rows = [
        row | {name: moved(row[name], 0, "1e-20") for name in "tx"} | {"reach": "1e-10"}
        for row in whole["events"]
    ]
    return whole | {
        "events": rows,
        "periods": 0,
        "alone_within": ["0", whole["alone_within"][1]],
        "multipliers": [wide, wide],
        "stable": None,
    }
