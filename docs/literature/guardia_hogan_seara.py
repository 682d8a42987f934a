"""M. Guardia, S. J. Hogan and T. M. Seara, SIAM J. Appl. Dyn. Syst. 9 (2010) 769-798, and
P. Kowalczyk and P. T. Piiroinen, Physica D 237 (2008) 1053-1073: points where borders meet.

For c = 0 they are A_n, F/P = 1/(4 n^2 - 1) at Omega = 1/(2 n), and B_n, F = 0 at
Omega = 1/(2 n + 1): `symosc derive undamped` proves it. With damping A_1 becomes a point where the
mass turns at a peak of the drive and begins to stick. The text of both papers was not at hand.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
from csernak_stepan_shaw import largest_without_stops
from scipy import optimize
from wall import MP, Row, Symmetric, find_border, show, wall

from symosc import find_orbit

#: c, and where to look for (Omega, F).
MEETINGS = (("0.1", (0.4759, 0.2483)), ("0.001", (0.4998, 0.3324)))


def undamped() -> Iterator[Row]:
    """Points for c = 0; run: bisection by whether the symmetric motion stops."""
    for n in (1, 2, 3):
        run = largest_without_stops(n, lambda F: (F, Fraction(0)))
        formula = Fraction(1, 4 * n * n - 1)
        yield Row("F/P", f"A_{n}: Omega = 1/{2 * n}", formula, run, 7, 1e-7)
    formula = Symmetric(0, "0.32").largest_force_ratio()
    run = find_border("0.031", "0.033", "0.32").middle
    yield Row("F/P", "near B_1: Omega = 0.32", formula, run, 7, 1e-7)


def damped() -> Iterator[Row]:
    """Where A_1 goes with damping; run: from the turning points of P32 alone."""
    for c, guess in MEETINGS:

        def by_formula(Omega: Any, F: Any, c: str = c) -> tuple[Any, Any]:
            motion = Symmetric(F, Omega, c)
            return motion.acceleration_after_turning(), motion.drive_at_peak()

        def by_running(point: Any, c: str = c) -> tuple[float, float]:
            Omega, F = map(float, point)
            t, x = max(find_orbit(wall(F, Omega, c), "P32").points, key=lambda turn: turn.x)
            return np.cos(Omega * t) - x + F, np.sin(Omega * t)

        formulas = MP.findroot(by_formula, guess)
        runs = optimize.root(by_running, guess, tol=1e-12, options={"eps": 1e-8}).x
        for name, formula, run in zip(("Omega", "F"), formulas, runs, strict=True):
            yield Row(name, f"c = {c}", formula, run, 10, 1e-10)


if __name__ == "__main__":
    show(undamped)
    show(damped)
