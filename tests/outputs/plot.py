"""Figures: of motions, orbits, branches, grazing windows, sweeps and judged solutions."""

from __future__ import annotations

from collections.abc import Callable

from symosc import plot

CASES: dict[str, Callable[[], object]] = {
    "fig5": lambda: plot.figure("fig5", t_end=9),
    "fig8 with magnified sticks": lambda: plot.figure("fig8", t_end=9, panels="abg"),
}
