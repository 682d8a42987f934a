"""One answer of each kind, small ones, by names that say what they are, for tests of what answers look like."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from excerpts import crosscheck

from symosc import (
    continue_border,
    continue_orbit,
    find_orbit,
    grazing_window,
    load_scene,
    simulate,
    simulate_many,
)
from symosc.certificates.certificate import Certificate

P = load_scene("fig9").parameters
STARTS = [(0, x, 1) for x in range(12)]
#: What a certificate of `fig6` says of its first event; no python-flint is needed for it.
PROVEN = Certificate(
    "trajectory",
    True,
    "1 event until t = 2",
    (
        (
            "slip",
            "belt2",
            "Omega2",
            ("1.58260582141", "1.58260582143"),
            ("7.91302910705", "7.91302910706"),
        ),
    ),
    multipliers=(
        (("-0.0168", "-0.0167"), ("0", "0")),
        (("0.25", "0.2500001"), ("-0.5", "-0.4999999")),
    ),
    stable=True,
    statement={"made_by": "a test"},
)


def _check(shift: float) -> Any:
    t = np.linspace(0, 7, 200)
    x, v = simulate("fig5", t_end=7)(t)
    return crosscheck("fig5", t, x, v + shift * (t > 5))


MANY: dict[str, Any] = {"t_end": 9, "use_numba": False}
MAKERS: dict[str, Callable[[], Any]] = {
    "scene": lambda: load_scene("fig5"),
    "trajectory": lambda: simulate("fig5", t_end=7),
    "trajectory without events": lambda: simulate("fig5", t_end="0.1"),
    "trajectory in digits": lambda: simulate("fig8-exact", digits=30, t_end=6),
    "orbit": lambda: find_orbit(P, "P32"),
    "branch": lambda: continue_orbit(P, "P32", "Omega", (3.9, 4.1)),
    "border": lambda: continue_border(
        continue_orbit(P, "P32", "Omega", (3.2, 4)), 0, "FN", (9, 11), step="0.1"
    ),
    "window": lambda: grazing_window(P, "P2"),
    "empty window": lambda: grazing_window(P.replace(k=0, B0=0), "P2"),
    "check": lambda: _check(0.0),
    "failed check": lambda: _check(0.1),
    "certificate": lambda: PROVEN,
    "open certificate": lambda: Certificate(
        "branch", False, "open at Omega = 4", (("cross", "Omega2", "Omega1"),)
    ),
    "events": lambda: simulate_many(P, STARTS, **MANY),
    "no events": lambda: simulate_many(P, (0, 0, 0), t_end="0.001", use_numba=False),
    "summary": lambda: simulate_many(P, STARTS, record="summary", sections=2, **MANY),
    "summary of words": lambda: simulate_many(P, STARTS[:2], record="word", **MANY),
}


@cache
def answer(kind: str) -> Any:
    """Return the answer of this kind, which is made when it is first asked for."""
    return MAKERS[kind]()
