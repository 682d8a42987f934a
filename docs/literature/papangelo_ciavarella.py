"""A. Papangelo and M. Ciavarella, J. Sound Vib. 339 (2015) 280-289: slow drives.

The slower the drive, the more often the mass stops, while its highest point tends to that of a
quasi-static motion, P - F. Only the abstract was at hand, which has no numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

from wall import Row, from_rest, show, stop_positions, stops, wall


def highest_points() -> Iterator[Row]:
    """Highest points for F = 0.5 (quasi-static: 0.5); run: the settled motion."""
    for c, Omega in (("0", "0.2"), ("0", "0.1"), ("0", "0.05"), ("2", "0.02")):
        p = wall("0.5", Omega, c)
        settled = 58 * (2 * pi / float(p.Omega))
        run = max(event.x for event in from_rest(p, 60).events if event.t > settled)
        note = f"{stops(p)} stops per cycle"
        yield Row("x_max", f"c = {c}, Omega = {Omega}", stop_positions(p)[0], run, note=note)


if __name__ == "__main__":
    show(highest_points)
