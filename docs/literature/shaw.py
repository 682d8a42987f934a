"""S. W. Shaw, J. Sound Vib. 108 (1986) 305-325: the multipliers of the motion without stops.

Only the abstract was at hand. It has a coefficient of its own for static friction.
"""

from __future__ import annotations

from collections.abc import Iterator

from den_hartog import CASES
from wall import Row, Symmetric, show, wall

from symosc import find_orbit


def multipliers() -> Iterator[Row]:
    """Sum and product of the multipliers; run: those of the orbit P32 with 30 digits."""
    for c, F, Omega in CASES:
        first, second = find_orbit(wall(F, Omega, c), "P32", digits=30).multipliers
        total, product = Symmetric(F, Omega, c).multipliers()
        case = f"c = {c}, F = {F}, Omega = {Omega}"
        yield Row("rho_1 + rho_2", case, total, (first + second).real)
        if abs(product) > 1e-4:  # smaller ones have too few digits left in a table
            yield Row("rho_1 rho_2", case, product, (first * second).real)


if __name__ == "__main__":
    show(multipliers)
