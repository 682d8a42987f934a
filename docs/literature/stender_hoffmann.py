"""M. Stender and N. Hoffmann, bSTAB, Nonlinear Dynamics 107 (2021), doi:10.1007/s11071-021-06786-5.

Their example of a mass on a belt, m = k = 1, c = 0.1, f = 0.5 + 0.5 exp(-w/0.5), has a rest and a
stick-slip cycle. Of 5000 random starts in [-2, 2] x [0, 2] a share comes to rest; these shares, for
several speeds V of the belt, were read in the results that bSTAB and pyBasin store.

The exact share is the part of the rectangle inside the unstable cycle between the two. The formula's
column has it for the smooth law, by scipy: in reversed time that cycle attracts. All printed shares
but one are within two standard errors. At V = 1.175 motions inside the cycle decay at the rate
0.0023, and bSTAB takes for a limit cycle what still moves with a velocity above 0.2 at t = 400. So
the rest gets the share of the starts that are slow enough by then, which the last row has.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import exp, sqrt
from typing import Any

import numpy as np
from falling_friction import falling
from scipy.integrate import solve_ivp
from wall import Row, show

from symosc import Belt, Oscillator, attractors

#: Speeds of the belt, and the printed shares of the rest.
PRINTED = {
    "1.175": 0.0132, "1.25": 0.08, "1.325": 0.1478, "1.4": 0.213, "1.475": 0.2776, "1.5": 0.304,
    "1.55": 0.3544, "1.625": 0.4202, "1.7": 0.4922, "1.775": 0.5678,
}  # fmt: skip
SLOW = "1.175"
STARTS = 5000
#: The law has so many pieces up to this relative speed, and the run so many starts in each direction.
PIECES = 32
UNTIL = 4
GRID = (100, 50)
#: A share of the grid is as exact as its starts are close. In LONG decay times motions from INSIDE
#: come, in reversed time, to the unstable cycle.
TOLERANCE = 0.035
LONG = 8
INSIDE = 0.4
#: When the code looks, and for which velocity it sees a limit cycle.
LATE = 400
MOVING = 0.2


def on_belt(V: str) -> Oscillator:
    """Return the oscillator on a belt of speed V."""
    belt = Belt.from_function(V, falling, UNTIL, pieces=PIECES)
    return Oscillator(m=1, c="1/10", k=1, belts=[belt])


def middles(low: float, high: float, count: int) -> np.ndarray:
    """Return the middles of as many equal parts of a range."""
    return low + (high - low) * (np.arange(count) + 0.5) / count


def decay(V: float) -> float:
    """Return the rate at which motions near the rest decay."""
    return (0.1 - exp(-2 * V)) / 2


def share_inside(V: float, amplitude: float, time: float) -> float:
    """Return the part of the rectangle from which the smooth law leads, in this time, to within an
    amplitude of the rest.
    """

    def backward(_: float, y: Any) -> Any:
        x, v = y
        return -v, -(falling(V - v) - v / 10 - x)

    def upward(_: float, y: Any) -> Any:
        return y[1]

    upward.direction = 1  # type: ignore[attr-defined]
    run = solve_ivp(
        backward, (0, time), (falling(V) + amplitude, 0.0), method="DOP853", events=upward,
        rtol=1e-9, atol=1e-9,
    )  # fmt: skip
    last = solve_ivp(
        backward, (0, 10), run.y_events[0][-1], method="DOP853", max_step=0.01, rtol=1e-9, atol=1e-9
    )
    x, v = last.y
    end = int(np.argmax(v[1:] < 0)) + 1  # the upper half of one turn
    order = np.argsort(x[:end])
    across = np.linspace(-2, 2, 20_001)
    heights = np.interp(across, x[:end][order], v[:end][order], left=0, right=0)
    return float(np.trapezoid(heights, across)) / 8


def shares() -> Iterator[Row]:
    """Shares of the starts that come to rest; formula: the smooth law, run: attractors."""
    for V, printed in PRINTED.items():
        exact = share_inside(float(V), INSIDE, LONG / decay(float(V)))
        x0, v0 = np.meshgrid(middles(-2, 2, GRID[0]), middles(0, 2, GRID[1]), indexing="ij")
        starts = {"t0": 0, "x0": x0.ravel(), "v0": v0.ravel()}
        found = attractors(on_belt(V), starts)
        assert sorted(found.names) == ["cycle", "rest"], found
        share = float(found.share[found.names.index("rest")])
        sigma = sqrt(exact * (1 - exact) / STARTS)
        off = (printed - exact) / sigma
        assert (abs(off) < 2) == (V != SLOW), off
        note = f"printed: {printed}, {off:+.1f} standard errors"
        yield Row("share", f"V = {V}", exact, share, 4, TOLERANCE, note)


def seen_late() -> Iterator[Row]:
    """Share with an amplitude below 0.2 at t = 400, which is printed for that of the rest; run: as printed."""
    share = share_inside(float(SLOW), MOVING, LATE)
    printed = PRINTED[SLOW]
    error = sqrt(share * (1 - share) / STARTS)
    note = f"{(printed - share) / error:+.1f} standard errors"
    yield Row("share", f"V = {SLOW}", share, printed, 4, 2 * error / share, note)


if __name__ == "__main__":
    show(shares)
    show(seen_late)
