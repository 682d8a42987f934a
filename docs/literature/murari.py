"""D. Murari, C. Budd, E. Jansson and C.-B. Schoenlieb, Learning piecewise-smooth dynamical systems,
preprint (2026): two limit cycles, c = 0.1, F = 0.5.

The paper prints the parameters; the places of the stops are computed here.
"""

from __future__ import annotations

from collections.abc import Iterator

from wall import Row, show, stop_positions, stops, wall

from symosc import find_orbit


def limit_cycles() -> Iterator[Row]:
    """Where the mass stops; formula: the equations of all slides of half a cycle."""
    for Omega in ("0.3", "0.15"):
        p = wall("0.5", Omega, "0.1")
        upper = {round(x, 12): x for _, x in find_orbit(p).points if x > 0}
        runs = sorted(upper.values(), reverse=True)
        for n, (formula, run) in enumerate(zip(stop_positions(p), runs, strict=True), 1):
            yield Row(
                f"±x_{n}", f"Omega = {Omega}", formula, run, note=f"{stops(p)} stops per cycle"
            )


if __name__ == "__main__":
    show(limit_cycles)
