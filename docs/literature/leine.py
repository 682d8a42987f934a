"""R. I. Leine, D. H. van Campen, A. de Kraker and L. van den Steen, Stick-slip vibrations induced by
alternate friction models, Nonlinear Dynamics 16 (1998), 41-54, doi:10.1023/A:1008289604683.

The paper was not at hand; its example was read in the test code of IFDIFF (Bock, Kirches, Meyer and
Potschka), which begins in x = 1.133944669704, v = 0, "in maximal value of system": a mass on a belt,
m = k = 1, c = 0, V = 0.2, with the friction 1/(1 + 3 w) of the relative speed w. In symosc the law is
piecewise linear. With n pieces that get longer with w the error falls with 1/n^2; from 8 to 128
pieces, which end where the mass turns, `law_error` extrapolates it away. In place of a formula stands
the smooth law, integrated by scipy. Of the 12 digits of the test code 8 are right.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from scipy.integrate import solve_ivp
from wall import Row, number, show

from symosc import Belt, Oscillator, law_error, simulate

SPEED = Fraction(1, 5)
#: What is beyond the largest relative speed of the cycle.
UNTIL = Fraction(3, 2)
#: The largest relative speed, from `law_error(..., "v_min", ...)`.
TURNS = Fraction("1.0399022893")
PIECES = (8, 64, 256)


class Cycle(NamedTuple):
    """The largest position, the duration of the slip, and the period."""

    x_max: Any
    slip: Any
    period: Any


def friction(w: Any) -> Any:
    """Return the friction at a relative speed."""
    return 1 / (1 + 3 * w)


@cache
def smooth() -> Cycle:
    """Return the cycle of the smooth law: it slips from x = 1, where the spring pulls with 1."""
    V = float(SPEED)

    def turns(_: float, y: Any) -> Any:
        return y[1]

    def meets_belt(t: float, y: Any) -> Any:
        return y[1] - V if t > 1 else -1.0

    meets_belt.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(
        lambda t, y: [y[1], friction(V - y[1]) - y[0]], (0, 9), [1, V],
        method="DOP853", events=(turns, meets_belt), rtol=1e-13, atol=1e-14,
    )  # fmt: skip
    (slip,) = run.t_events[1]
    return Cycle(run.y_events[0][0, 0], slip, slip + (1 - run.y_events[1][0, 0]) / V)


@cache
def by_pieces(n: int) -> Cycle:
    """Return the cycle of the law with n pieces, the shortest of which are at the belt."""
    return cycle(n, UNTIL)


@cache
def cycle(n: int, until: Any) -> Cycle:
    """Return the cycle of the law with n pieces up to the relative speeds `until`."""
    belt = Belt.from_function(SPEED, friction, until, n)
    # At a wall without friction the mass turns, which makes an event.
    model = Oscillator(m=1, c=0, k=1, belts=[Belt(0, mu=0), belt])
    farthest, _, met, again = simulate(model, x0=1, v0=SPEED, t_end=13).events[:4]
    return Cycle(farthest.x, met.t, again.t)


def extrapolated() -> Cycle:
    """Return the cycle to which that of more and more pieces tends."""
    # Pieces end where the mass turns, in the frame of the belt and at rest.
    until = (SPEED, TURNS)
    return Cycle(*(
        law_error(lambda n: cycle(n, until), lambda run, name=name: getattr(run, name), 8, doublings=4)
        .extrapolated
        for name in Cycle._fields
    ))  # fmt: skip


def cycles() -> Iterator[Row]:
    """Stick-slip with falling friction; run: simulate with n pieces, and what they tend to."""
    exact = smooth()
    for n in PIECES:
        run = by_pieces(n)
        yield Row("x_max", f"n = {n}", exact.x_max, run.x_max, tolerance=0.1 / n**2)
        yield Row("T", "", exact.period, run.period, tolerance=0.1 / n**2)
    run = extrapolated()
    yield Row("x_max", "extrapolated", exact.x_max, run.x_max, tolerance=5e-12)
    yield Row("slip", "", exact.slip, run.slip, tolerance=1e-10)
    yield Row("T", "", exact.period, run.period, tolerance=1e-10)
    printed = number("1.133944669704")
    yield Row("x_max", "IFDIFF", exact.x_max, printed, tolerance=1e-8, note="run: as printed there")


if __name__ == "__main__":
    show(cycles)
