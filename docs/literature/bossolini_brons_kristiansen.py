"""E. Bossolini, M. Brons and K. U. Kristiansen, Canards in stiction: on solutions of a friction
oscillator by regularization, SIAM J. Appl. Dyn. Syst. (2017), arXiv:1703.08437.

Only the abstract was read: some motions that obey the law of stiction are not unique. This is such a
start, with numbers of our own: x'' + x = cos(t)/2 + friction, kinetic friction 1/2, static friction
1. The mass rests at x_0 = -1/2, where the force on it, cos(t)/2 + 1/2, touches the limit 1 at
t = 0 and once in each period. Both to hold and to slip at t = 0 obey the law. symosc holds, because
the force has fallen again at once: at equality a stick lasts as long as it can. A hair below x_0
the limit is exceeded, and the mass slips.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from wall import MP, Row, number, show

from symosc import Belt, Oscillator, Trajectory, simulate

X_0 = Fraction(-1, 2)
HAIR = Fraction(1, 10**20)
MODEL = Oscillator(m=1, c=0, k=1, B0="1/2", Omega=1, belts=[Belt(0, mu="1/2", mu_s=1)])


def from_rest(x_0: Fraction) -> Trajectory:
    """Return the motion from rest over ten periods."""
    return simulate(MODEL, x0=x_0, t_end="10T")


def slip() -> tuple[Any, Any]:
    """Return how long the other motion slips, and where it stops: x = x_0 + t sin(t)/4."""

    def velocity(t: Any) -> Any:
        return (MP.sin(t) + t * MP.cos(t)) / 4

    time = MP.findroot(velocity, 2)
    return time, number(X_0) + time * MP.sin(time) / 4


def both() -> Iterator[Row]:
    """From rest at x_0 = -1/2, and a hair (1e-20) below; formula: the two motions that obey the law."""
    holding = from_rest(X_0)
    assert not holding.events
    yield Row("x at the end", "x_0", number(X_0), holding(holding.t_end)[0], note="holds")
    time, place = slip()
    slipping = from_rest(X_0 - HAIR)
    (stop,) = slipping.events
    yield Row("t where it stops", "x_0 - 1e-20", time, stop.t, note="slips at once")
    yield Row("x there", "", place, stop.x)


if __name__ == "__main__":
    show(both)
