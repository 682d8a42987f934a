"""G. Csernak, G. Stepan and S. W. Shaw, Nonlinear Dynamics 50 (2007) 93-109: continua for c = 0.

At Omega = 1/(2 n) the symmetric motion without stops plus a free motion with the middle d is a
motion too, up to |d| = d*: `symosc derive undamped` proves it, and derives d*. Only the abstract was
at hand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import pi
from typing import Any

from wall import Row, show, wall

from symosc import PeriodicOrbit, Trajectory, find_orbit, simulate

#: n of Omega = 1/(2 n), F, and middles of the turning points.
CONTINUA = ((1, "0.1", ("-0.2", "0", "0.1")), (2, "0.02", ("0", "0.04")))


def amplitude(n: int) -> Fraction:
    """Return the amplitude at Omega = 1/(2 n): friction does not change it."""
    return 1 / (1 - Fraction(1, 4 * n * n))


def orbit(F: Any, n: int, middle: Fraction) -> PeriodicOrbit:
    """Return the orbit without stops around a middle."""
    # In doubles only: neighbours are orbits too, so more digits would find singular equations.
    guess = [(0, float(middle + amplitude(n))), (2 * pi * n, float(middle - amplitude(n)))]
    return find_orbit(wall(F, Fraction(1, 2 * n)), "P32", guess=guess)


def path(F: Any, n: int, middle: Fraction, cycles: Fraction) -> Trajectory:
    """Simulate the motion that starts at the highest point of `orbit`."""
    t_end = cycles * Fraction(4 * pi * n)
    x0 = middle + amplitude(n)
    return simulate(wall(F, Fraction(1, 2 * n)), t0=0, x0=x0, v0=0, t_end=t_end, accuracy=1e-6)


def largest_without_stops(n: int, motion: Callable[[Fraction], tuple[Any, Fraction]]) -> float:
    """Return the largest z in (0, 1) for which `path` with (F, middle) = motion(z) has no stops."""
    low = Fraction(0)
    high = Fraction(1)
    while high - low > 1e-9:
        z = (low + high) / 2
        F, middle = motion(z)
        events = path(F, n, middle, Fraction(9, 4)).events
        if [event.kind for event in events] == ["cross"] * 4:
            low = z
        else:
            high = z
    return float(low + high) / 2


def continua() -> Iterator[Row]:
    """Members of continua, which symosc calls marginal, and where a continuum ends (d*)."""
    for n, F, middles in CONTINUA:
        half = amplitude(n)
        end = half / (4 * n * n) - Fraction(F)
        case = f"Omega = 1/{2 * n}, F = {F}"
        for middle in map(Fraction, middles):
            member = orbit(F, n, middle)
            assert member.stable is None
            where = f"{case}, d = {float(middle):g}"
            highest, lowest = (point.x for point in member.points)
            product = (end**2 - middle**2) / ((end + 2 * Fraction(F)) ** 2 - middle**2)
            yield Row("x_max", where, middle + half, highest)
            yield Row("x_min", where, middle - half, lowest)
            yield Row("rho_2", where, product, member.multipliers[1].real)
        run = largest_without_stops(n, lambda z, F=F: (F, z))
        yield Row("d*", case, end, run, 7, 1e-7)


if __name__ == "__main__":
    show(continua)
