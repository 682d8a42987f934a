"""Stops per cycle of the oscillator with Coulomb friction: the border of motions without stops is the published one.

Den Hartog (Trans. ASME 53, 1931), in the form of Hong and Liu (J. Sound Vib. 229, 2000); m = k = F_N = P = 1, c = 0.
"""

from __future__ import annotations

from math import cos, pi, sin, sqrt, tan

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from symosc import Parameters, Scene, sweep

pytest.importorskip("xarray")
COULOMB = Parameters(m=1, c=0, k=1, A0=0, B0=1, Omega=1, v1=0, v2=1000, mu1=0, mu2=0, FN=1)
WALL = Scene("wall", COULOMB, t0=0, x0=0, v0=0, t_end=1)


def largest_friction(r: float) -> float:
    """Return F/P on the border for the frequency ratio r."""
    V, U = 1 / (1 - r * r), tan(pi / (2 * r)) / r

    def S(u: float) -> float:
        return r * r * (sin(u / r) / r + U * (cos(u) - cos(u / r))) / sin(u)

    grid = np.linspace(0, pi, 402)[1:-1]
    best = grid[np.argmax([S(u) for u in grid])]
    near = minimize_scalar(
        lambda u: -S(u), bounds=(max(best - 0.01, 1e-6), min(best + 0.01, pi - 1e-6)), method="bounded"
    )
    largest = max(1.0, -near.fun)  # at both ends of (0, pi) it tends to 1 at least
    return abs(V) / sqrt(U * U + (largest / r**2) ** 2)


def test_the_formula_gives_the_published_values() -> None:
    assert largest_friction(1.5) == pytest.approx(0.64657909, abs=1e-8)
    assert largest_friction(0.8) == pytest.approx(0.81740639, abs=1e-8)


@pytest.mark.slow
def test_the_border_of_the_map_is_the_formulas() -> None:
    over = {"Omega": "0.65:2:6", "mu1": "0.42:0.9:13"}
    found = sweep(WALL, over, record="sticks", t_end="61T", skip="60T")
    step = 0.04
    for ratio in found.Omega.values:
        stops = found.sticks.sel(Omega=ratio)
        free, stopping = stops.mu1.values[stops.values == 0], stops.mu1.values[stops.values > 0]
        border = largest_friction(ratio)
        assert free.max() < stopping.min()
        assert free.max() < border + 1e-9, ratio
        assert stopping.min() > border - 1e-9, ratio
        assert stopping.min() - free.max() < 1.5 * step


def test_more_stops_at_lower_frequencies() -> None:
    found = sweep(WALL, {"Omega": [0.1, 0.2, 0.45], "mu1": [0.1, 0.4, 0.6]}, record="sticks", t_end="21T", skip="20T")
    assert {0, 2, 4, 6} <= {*found.sticks.values.ravel().tolist()}
