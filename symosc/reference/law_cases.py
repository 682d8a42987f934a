"""Reference cases under other friction laws: static friction, and friction that depends on speed.

A test follows each case by a program that shares nothing with this one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from symosc.base.exact import read_exact
from symosc.belts import Belt
from symosc.model import Oscillator
from symosc.reference.case import ReferenceCase
from symosc.scenes import Scene

STATIC = "static friction"
CURVES = "friction curve"
LAW_GROUPS = {
    STATIC: "a stick ends with a jump of the force, and a contact holds where kinetic friction "
    "would not",
    CURVES: "friction that falls and rises with the relative speed: corners, and negative damping",
}
#: A belt at which friction falls, then rises again.
STRIBECK = Belt(
    "1/2", curve=[(0, "1/2"), ("1/2", "3/10"), ("3/2", "1/4")], slope="1/20", mu_s="3/5"
)


def _law_case(
    name: str, group: str, law: dict[str, Any], start: tuple[Any, Any, Any], t_end: Any, hard: str,
    source: str = "", closed: tuple[str, ...] = (),
) -> ReferenceCase:  # fmt: skip
    """Return a case with a start (t0, x0, v0)."""
    oscillator: Any = Oscillator(**{"m": 1, "c": 0, "k": 1, "Omega": 1} | law)
    t0, x0, v0, end = (read_exact("start", value) for value in (*start, t_end))
    scene = Scene(name, oscillator, t0, x0, v0, end)
    return ReferenceCase(name, group, scene, hard, source, closed)


def law_cases() -> Iterator[ReferenceCase]:
    """Yield the cases under other friction laws, all with at most two belts."""
    yield from _static_cases()
    yield from _curve_cases()


def _static_cases() -> Iterator[ReferenceCase]:
    """Yield motions with static friction above kinetic friction."""
    pulled = {"belts": [Belt("1/5", "1/2", mu_s=1)]}
    yield _law_case(
        "static-cycle", STATIC, pulled, (0, "1/2", "1/5"), 40,
        "stick and slip on a running belt, in closed form", "classical",
        (
            "t[0] = 5/2", "x[0] = 1", "t[1] = 5/2 + 2*pi - 2*atan(5/2)", "x[1] = 0",
            "t[2] = 15/2 + 2*pi - 2*atan(5/2)", "t[3] = 15/2 + 4*pi - 4*atan(5/2)",
        ),
    )  # fmt: skip
    driven = {
        "c": "1/10",
        "B0": "3/10",
        "Omega": "21/10",
        "belts": [Belt("1/10", "2/5", mu_s="7/10")],
    }
    yield _law_case(
        "static-driven", STATIC, driven, (0, 0, 0), "16.5",
        "a drive between slips that begin with a jump of the force",
    )  # fmt: skip
    two = {
        "c": "1/20", "B0": "1/2", "Omega": "7/10",
        "belts": [Belt("-2/5", "1/5", mu_s="2/5"), Belt("3/5", "3/10", mu_s="3/5")],
    }  # fmt: skip
    yield _law_case(
        "static-two-belts", STATIC, two, (0, 1, 0), 30, "two belts that both hold and let go"
    )
    arrives = {"belts": [Belt(2, "1/2", mu_s=1)]}
    yield _law_case(
        "static-arrival", STATIC, arrives, (0, "29/10", 0), 30,
        "a contact at which the force that is needed lies between kinetic and static friction: it "
        "holds",
    )  # fmt: skip


def _curve_cases() -> Iterator[ReferenceCase]:
    """Yield motions under friction that depends on the relative speed."""
    driven = {"c": "1/20", "B0": "3/10", "Omega": "7/10", "belts": [STRIBECK]}
    yield _law_case(
        "curve-stribeck", CURVES, driven, (0, 1, 0), 60,
        "falling friction with static friction: each slip passes corners",
    )  # fmt: skip
    with_second = {
        "c": "1/10",
        "B0": "2/5",
        "Omega": "11/10",
        "belts": [STRIBECK, Belt("-3/4", "1/5")],
    }
    yield _law_case(
        "curve-two-belts",
        CURVES,
        with_second,
        (0, "1/3", 1),
        30,
        "a falling curve beside a Coulomb belt",
    )
    growing = {"belts": [Belt(1, curve=[(0, "1/2"), (2, "3/10")])]}
    yield _law_case(
        "curve-growing", CURVES, growing, (0, 0, 0), 60,
        "negative damping: an oscillation grows until it meets the belt",
    )  # fmt: skip
    viscous = {"B0": 2, "Omega": "4/5", "belts": [Belt("1/4", "1/5", slope="3/10")]}
    yield _law_case(
        "curve-viscous",
        CURVES,
        viscous,
        (0, 0, 1),
        40,
        "friction that grows with the relative speed",
    )
    slopes = {"belts": [Belt.from_function("1/5", lambda w: 1 / (1 + 3 * w), "3/2", pieces=8)]}
    yield _law_case(
        "curve-leine", CURVES, slopes, (0, "9/10", "1/5"), 40,
        "eight straight pieces of 1/(1 + 3 w)", "Leine, van Campen, de Kraker, van den Steen 1998",
    )  # fmt: skip
