"""Where friction that falls with speed makes a belt's equilibrium unstable, and where stick-slip ends.

Three sources, in our letters with the force f(w) of the relative speed w. At rest w is the speed V
of the belt, and the equilibrium is stable while c + f'(V) > 0. In symosc the law is piecewise linear:
the bands on either side of V say by their damping where its sign changes, and the finer the pieces,
the nearer to the smooth law.

- M. Stender and N. Hoffmann, bSTAB, Nonlinear Dynamics 107 (2021), doi:10.1007/s11071-021-06786-5:
  m = k = 1, c = 0.1, f = 0.5 + 0.5 exp(-w/0.5), static friction 1. Its code was read.
- G. Veraszto and G. Stepan, International Journal of Non-Linear Mechanics (2017),
  doi:10.1016/j.ijnonlinmec.2017.01.006, as read in a code that cites its tables: m = 0.538,
  c = 5.746, k = 6957, f = 2 + 4 exp(-10 w) + 0.2 w.
- J. J. Thomsen and A. Fidlin, International Journal of Non-Linear Mechanics 38 (2003), 389-403, of
  which the abstract was read: f = s - k1 w + k3 w^3 with k1 = 3 (s - f_m)/(2 v_m) and
  k3 = (s - f_m)/(2 v_m^3); here s = 0.4, f_m = 0.25, v_m = 0.5 and c = 0.04. Averaging says that
  below the speed V_1 of the onset a cycle without sticks has the amplitude 2 sqrt(V_1^2 - V^2), and
  that the mass sticks below sqrt(4/5) V_1. It is an approximation, and the runs are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import pairwise
from math import exp, log, sqrt
from typing import Any, NamedTuple

from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from wall import Row, show

from symosc import Belt, Oscillator, simulate


class Law(NamedTuple):
    """Mass, damper, spring, friction, and up to which relative speed it is followed."""

    m: Any
    c: Any
    k: Any
    friction: Callable[[float], float]
    until: Any

    def on_belt(self, V: Any, pieces: int) -> Oscillator:
        """Return the oscillator on a belt of speed V; at a wall without friction the mass turns,
        which makes an event.
        """
        belt = Belt.from_function(V, self.friction, self.until, pieces=pieces)
        return Oscillator(m=self.m, c=self.c, k=self.k, belts=[Belt(0, mu=0), belt])


def falling(w: float) -> float:
    """Return the friction of bSTAB's example."""
    return 0.5 + 0.5 * exp(-w / 0.5)


def with_viscous_part(w: float) -> float:
    """Return the friction of Veraszto and Stepan."""
    return 2 + 4 * exp(-10 * w) + 0.2 * w


def cubic(w: float) -> float:
    """Return the friction of Thomsen and Fidlin."""
    return 0.4 - 0.45 * w + 0.6 * w**3


BSTAB = Law(1, Fraction(1, 10), 1, falling, 4)
VERASZTO = Law("0.538", "5.746", 6957, with_viscous_part, 1)
THOMSEN = Law(1, "0.04", 1, cubic, Fraction(3, 2))
#: The onset of Thomsen and Fidlin: c + f' = 0.
FIRST = sqrt((0.45 - 0.04) / 1.8)
#: Speeds of the belt, as parts of FIRST, at which cycles are compared.
PARTS = ("0.95", "0.92")
LONG = 800
#: The speed of the belt and the duration of the slip from which the touch is searched.
NEAR_TOUCH = (1.8366, 6.0)
FINE = 60
PIECES = (100, 200)
#: The speed of the touch is searched to 1e-8, and amplitudes have 4 digits. Events that are accurate
#: enough for that take a twentieth of the time of those that have more digits.
ACCURACY = 1e-9


def onset(law: Law, pieces: int) -> float:
    """Return the relative speed at which the damping of the bands changes its sign.

    A band's damping is that of the smooth law in its middle, but for terms of second order.
    """
    belt = Belt.from_function(0, law.friction, law.until, pieces=pieces)
    bands = Oscillator(m=law.m, c=law.c, k=law.k, belts=[belt]).bands
    inner = [band for band in bands if band.below is not None and band.above is not None]
    points = [
        (float(band.below + band.above) / 2, float(band.c)) for band in inner if band.below >= 0
    ]
    crossed = (
        w - c * (after - w) / (c_after - c)
        for (w, c), (after, c_after) in pairwise(points)
        if c < 0 <= c_after
    )
    return next(crossed)


def onsets() -> Iterator[Row]:
    """Speeds of the belt below which the equilibrium is unstable; run: bands of n pieces."""
    for case, law, exact in (
        ("bSTAB", BSTAB, log(10) / 2),
        ("Veraszto and Stepan", VERASZTO, log(10 * 4 / (5.746 + 0.2)) / 10),
        ("Thomsen and Fidlin", THOMSEN, FIRST),
    ):
        for n in (16, 64, 256, 1024):
            yield Row("V", f"{case}, n = {n}", exact, onset(law, n), 10, 20 / n**2)


def meets_belt(V: Fraction, pieces: int) -> bool:
    """Return whether the slip after a stick in bSTAB's example meets the belt again."""
    stuck_at = 1 - V / 10 - V / 2  # half a unit of time before it slips
    motion = simulate(BSTAB.on_belt(V, pieces), x0=stuck_at, v0=V, t_end=9, accuracy=ACCURACY)
    return any(event.kind == "stick" and event.t > 1 for event in motion.events)


def end_of_cycle(pieces: int) -> Fraction:
    """Return the speed of the belt above which the slip does not meet it again."""
    with_cycle, without = Fraction(3, 2), Fraction(2)
    while without - with_cycle > Fraction(1, 10**8):
        middle = (with_cycle + without) / 2
        if meets_belt(middle, pieces):
            with_cycle = middle
        else:
            without = middle
    return with_cycle


def touch() -> float:
    """Return the speed of the belt that the slip of the smooth law just touches: v = V, v' = 0."""

    def miss(unknown: Any) -> Any:
        V, time = unknown
        run = solve_ivp(
            lambda t, y: [y[1], falling(V - y[1]) - y[1] / 10 - y[0]], (0, time), [1 - V / 10, V],
            method="DOP853", rtol=1e-13, atol=1e-14,
        )  # fmt: skip
        x, v = run.y[:, -1]
        return v - V, 1 - v / 10 - x

    speed, _ = fsolve(miss, NEAR_TOUCH, xtol=1e-12)
    return float(speed)


def ends() -> Iterator[Row]:
    """Speeds of the belt above which bSTAB's stick-slip is gone; run: bisection of motions."""
    exact = touch()
    coarse, fine = (float(end_of_cycle(n)) for n in PIECES)
    for n, run in zip(PIECES, (coarse, fine), strict=True):
        yield Row("V", f"n = {n}", exact, run, 8, 1e-3)
    yield Row("V", "from both", exact, fine + (fine - coarse) / 3, 8, 1e-5)


def swings(part: str) -> tuple[float, int]:
    """Return the amplitude of the cycle at a part of the speed of the onset, and its sticks."""
    V = round(float(part) * FIRST, 9)
    x0 = cubic(V) + 2 * sqrt(FIRST**2 - V**2)  # by averaging the cycle, which attracts slowly
    points = [(Fraction(i, FINE), cubic(i / FINE)) for i in range(FINE + 1)]
    belts = [Belt(0, mu=0), Belt(V, curve=points, slope=1)]
    model = Oscillator(m=1, c=THOMSEN.c, k=1, belts=belts)
    motion = simulate(model, x0=round(x0, 9), v0=0, t_end=LONG, accuracy=ACCURACY)
    late = [event for event in motion.events if event.t > 0.9 * LONG]
    positions = [event.x for event in late if event.boundary == 1]  # where it turns
    return (max(positions) - min(positions)) / 2, sum(event.kind == "stick" for event in late)


def cycles() -> Iterator[Row]:
    """Cycles of Thomsen and Fidlin below the onset; formula: averaging; run: simulate."""
    for part in PARTS:
        V = float(part) * FIRST
        amplitude, sticks = swings(part)
        averaged = 2 * sqrt(FIRST**2 - V**2)
        yield Row("amplitude", f"V = {part} V_1", averaged, amplitude, 4, 0.03, f"{sticks} sticks")
    for part, expected in (("0.90", 0), ("0.89", 1)):
        _, sticks = swings(part)
        yield Row("sticks", f"V = {part} V_1", expected, int(sticks > 0), 0, 0)


if __name__ == "__main__":
    show(onsets)
    show(ends)
    show(cycles)
