"""Z. Iklodi and Z. Dombovari, Nonlinear Dynamics (2024), doi:10.1007/s11071-024-10188-8.

The ends of the branch of motions without stops with the parameters of their demo, c = 0.1, P = 1.5,
F = 1. The demo has static friction 1.1 times the kinetic one, and prints no numbers. With that
friction the mass would also stop for Omega in [0.7227, 0.7487] and in [1.2062, 1.2357].
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from wall import MP, Row, Symmetric, show, wall

from symosc import continue_orbit


def ends() -> Iterator[Row]:
    """Where the branch ends in Omega, and its amplitude there; run: continue_orbit."""

    def excess(Omega: Any) -> Any:
        return Symmetric(0, Omega, "0.1").largest_force_ratio() * MP.mpf("1.5") - 1

    branch = continue_orbit(wall(1, 1, "0.1", P="1.5"), "P32", "Omega", ("0.6", "1.5"))
    for end in branch.ends:
        Omega = MP.findroot(excess, (end.value, end.value + 1e-4), solver="secant")
        highest = Symmetric(1, Omega, "0.1", "1.5").highest
        yield Row("Omega", "", Omega, end.value, note=end.kind)
        yield Row("x_0", "there", highest, max(point.x for point in end.points), 10, 1e-10)


if __name__ == "__main__":
    show(ends)
