"""H.-K. Hong and C.-S. Liu, J. Sound Vib. 229 (2000) 1171-1192: stops per cycle for c = 0.

The abstract names the counts 0, 1, 2, 4, ..., 14; the map of borders was not at hand. At a border a
slide comes to rest for a moment on its way ("graze": v = x'' = 0, a stop without length appears),
or a stop lasts until the drive just reaches what would move the mass ("birth" of a slide, at
x = F - 1).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from wall import MP, Border, Row, Slides, find_border, show, slides_seen, wall

#: Omega, and two values of F/P between which the number of stops per cycle changes.
BORDERS = (
    ("0.1", "0.120", "0.121"),
    ("0.1", "0.373", "0.374"),
    ("0.1", "0.505", "0.506"),
    ("0.1", "0.804", "0.805"),
    ("0.04", "0.263", "0.264"),
    ("0.04", "0.379", "0.380"),
    ("0.04", "0.439", "0.440"),
    ("0.04", "0.457", "0.458"),
)


def solve_border(Omega: str, border: Border) -> Any:
    """Return F/P at a border by equations, on its side with fewer stops."""
    few, count = min(
        (border.low, border.below), (border.high, border.above), key=lambda side: side[1]
    )
    n = count // 2
    runs = slides_seen(wall(few, Omega), n)
    slides = Slides(Omega)
    _, kind, j, moment = min(candidates(runs, few))

    def equations(F: Any, *unknowns: Any) -> list[Any]:
        phases = unknowns[:n]
        closed = slides.equations(F, phases, unknowns[n : 2 * n])
        if kind == "birth":
            return [*closed, slides.ends(F, phases)[j] - F + 1]
        touch = (F, phases[j], unknowns[-1])
        return [*closed, slides.state(*touch)[1], slides.acceleration(*touch)]

    guess = [few, *(phase for phase, _, _ in runs), *(time for _, time, _ in runs)]
    if kind == "graze":
        guess.append(moment)
    return MP.findroot(equations, guess)[0]


def candidates(runs: list[Any], F: float) -> Iterator[tuple[float, str, int, float]]:
    """Yield what may happen next on simulated slides: distance, kind, slide, time on it."""
    for j, (_, _, (slip, stick, path)) in enumerate(runs):
        yield abs(stick.x - F + 1), "birth", j, 0.0
        times = np.linspace(slip.t, stick.t, 2001)[20:-20]
        speeds = path(times)[1]
        inner = speeds[1:-1]
        for i in np.flatnonzero((inner > speeds[:-2]) & (inner >= speeds[2:])) + 1:
            yield -float(speeds[i]), "graze", j, float(times[i] - slip.t)


def borders() -> Iterator[Row]:
    """Where the number of stops per cycle changes; run: bisection of simulations."""
    for Omega, low, high in BORDERS:
        border = find_border(low, high, Omega)
        formula = solve_border(Omega, border)
        yield Row("F/P", f"Omega = {Omega}", formula, border.middle, 7, 1e-7, border.note)


if __name__ == "__main__":
    show(borders)
