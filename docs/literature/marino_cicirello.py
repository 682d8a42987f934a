"""L. Marino, A. Cicirello and D. A. Hills, Nonlinear Dynamics 98 (2019) 2595-2612, and L. Marino
and A. Cicirello, Nonlinear Dynamics 99 (2020) 1781-1799: base and wall in joint motion.

Base and wall move with cos(Omega t). The motion relative to them is the one of this folder with
P = Omega^2. Beyond a frequency ratio r, friction makes the absolute motion larger than
1/(r^2 - 1), its amplitude without friction; for weak friction that ratio is sqrt(2). Only the
abstracts were at hand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
from scipy import optimize
from wall import MP, Row, Symmetric, free, show, wall

from symosc import find_orbit, simulate


def transmissibility(F: Any, Omega: Any) -> Any:
    """Return the largest absolute displacement, by formula."""
    r = MP.mpf(Omega.numerator) / Omega.denominator
    motion = Symmetric(F, r, P=r * r)

    def absolute(angle: Any) -> Any:
        start = motion.highest - motion.p - motion.F
        x, _ = free(motion.c, angle / r).carry(start, -r * motion.q)
        # The base is the drive (1 - r^2) steady of the relative motion over r^2.
        steady = motion.p * MP.cos(angle) + motion.q * MP.sin(angle)
        return motion.F + steady / r**2 + x

    top = float(max(np.linspace(0, pi, 201), key=lambda angle: abs(absolute(angle))))
    return abs(absolute(MP.findroot(lambda angle: MP.diff(absolute, angle), top)))


def transmissibility_by_running(F: Any, Omega: Fraction) -> float:
    """Return the same by simulation: motion on P32 relative to the base, plus cos(Omega t)."""
    p = wall(F, Omega, P=Omega**2)
    orbit = find_orbit(p, "P32")
    t0, x0 = map(Fraction, orbit.points[0])
    path = simulate(p, t0=t0, x0=x0, v0=0, t_end=t0 + Fraction(orbit.period))

    def absolute(t: Any) -> Any:
        return -np.abs(path(t)[0] + np.cos(float(Omega) * t))

    times = np.linspace(path.t_start, path.t_end, 1001)[1:-1]
    top = times[int(np.argmin(absolute(times)))]
    step = times[1] - times[0]
    peak = optimize.minimize_scalar(
        absolute, bounds=(top - step, top + step), method="bounded", options={"xatol": 1e-9}
    )
    return -float(peak.fun)


def inversion(F: Any, height: Callable[[Any, Fraction], Any]) -> float:
    """Return the r at which the amplitude is as large as without friction."""

    def excess(r: float) -> float:
        return float(height(F, Fraction(r))) * (r * r - 1) - 1

    return float(optimize.brentq(excess, 1.38, 1.6, xtol=1e-13))


def inversions() -> Iterator[Row]:
    """Where friction begins to amplify; run: the absolute motion on the orbit P32."""
    for F in ("0.1", "0.5", "1"):
        formula = inversion(F, transmissibility)
        run = inversion(F, transmissibility_by_running)
        yield Row("r", f"F = {F}", formula, run, 10, 1e-10)


if __name__ == "__main__":
    show(inversions)
