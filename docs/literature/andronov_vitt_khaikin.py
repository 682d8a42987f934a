"""A. A. Andronov, A. A. Vitt and S. E. Khaikin, Theory of Oscillators (Pergamon, 1966): a mass on a
belt whose static friction s exceeds the kinetic friction f.

The book was not at hand, so the formulas are derived here. Without a damper the mass sticks until
the spring pulls with s, at x = s/k, and slips on a circle around f/k. With a = (s - f)/k and
w = sqrt(k/m) the radius is R = hypot(a, V/w), the belt is met again at f/k - a, and the period is
2a/V + 2/w (pi - atan(a w/V)). With a damper the cycle ends at the belt speed at which the slip just
touches the belt, v = V and v' = 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from wall import MP, Row, free, number, show

from symosc import Belt, Oscillator, continue_orbit, find_orbit, simulate

#: m, k, V, f, s.
SETS = (
    (1, 1, "1/5", "1/2", 1),
    (2, 3, "1/7", "1/3", "5/4"),
    (1, 9, 2, 1, 7),
    ("1/2", "4/3", "3/2", 0, "1/8"),
)
DIGITS = 30
DECIMALS = 25
CLOSE = 1e-27
DAMPING = Fraction(1, 10)
KINETIC = Fraction(1, 2)
STATIC = Fraction(1)
#: Belt speeds with and without a cycle.
ENCLOSED = (Fraction(1, 2), Fraction(3, 5))


def cycles() -> Iterator[Row]:
    """Stick-slip without a damper; run: simulate with 30 digits."""
    for m, k, V, f, s in SETS:
        case = f"m = {m}, k = {k}, V = {V}, f = {f}, s = {s}"
        # At a wall without friction the mass turns, which makes an event.
        belts = [Belt(0, mu=0), Belt(V, mu=f, mu_s=s)]
        model = Oscillator(m=m, c=0, k=k, belts=belts)
        mass, stiff, speed, kinetic, static = (number(Fraction(value)) for value in (m, k, V, f, s))
        a = (static - kinetic) / stiff
        w = MP.sqrt(stiff / mass)
        radius = MP.hypot(a, speed / w)
        slip = 2 / w * (MP.pi - MP.atan(a * w / speed))
        # From the unstressed spring: it sticks first for s/(k V), and then for 2 a/V.
        t_end = static / (stiff * speed) + 1.5 * (2 * a / speed + slip)
        motion = simulate(model, v0=V, t_end=Fraction(MP.nstr(t_end, 15)), digits=DIGITS)
        begin, farthest, nearest, met, again = motion.events[:5]
        period = number(again.t) - number(begin.t)
        yield Row("T", case, 2 * a / speed + slip, period, DECIMALS, CLOSE)
        yield Row("slip", "", slip, number(met.t) - number(begin.t), DECIMALS, CLOSE)
        yield Row("x_max", "", kinetic / stiff + radius, farthest.x, DECIMALS, CLOSE)
        yield Row("x_min", "", kinetic / stiff - radius, nearest.x, DECIMALS, CLOSE)


def graze() -> tuple[Any, Any]:
    """Return the belt speed and the duration of the slip that touches the belt, m = k = 1."""
    c = number(DAMPING)

    def touch(V: Any, time: Any) -> tuple[Any, Any]:
        # The spring pulls with s - c V at last; the slip is a free motion around f.
        x, v = free(c, time).carry(number(STATIC) - c * V - number(KINETIC), V)
        return v - V, -x - c * v

    speed, time = MP.findroot(touch, (MP.mpf("0.549"), MP.mpf("5.53")))
    return speed, time


def meets_belt(V: Fraction) -> bool:
    """Return whether the slip after a stick meets the belt again."""
    belt = Belt(V, mu=KINETIC, mu_s=STATIC)
    model = Oscillator(m=1, c=DAMPING, k=1, belts=[belt])
    stuck_at = STATIC - DAMPING * V - V  # one unit of time before it slips
    motion = simulate(model, x0=stuck_at, v0=V, t_end=8)
    return any(event.kind == "stick" for event in motion.events)


def end_of_cycle() -> Iterator[Row]:
    """Where the cycle ends, m = k = 1, c = 1/10, f = 1/2, s = 1; run: bisection, continue_orbit."""
    with_cycle, without = ENCLOSED
    while without - with_cycle > Fraction(1, 10**13):
        middle = (with_cycle + without) / 2
        if meets_belt(middle):
            with_cycle = middle
        else:
            without = middle
    speed, time = graze()
    yield Row("V", "", speed, with_cycle, note=f"the slip lasts {MP.nstr(time, 13)}")
    belt = Belt(ENCLOSED[0], mu=KINETIC, mu_s=STATIC)
    model = Oscillator(m=1, c=DAMPING, k=1, belts=[belt])
    cycle = find_orbit(model, v0=belt.v)
    _, end = continue_orbit(model, None, "v1", ENCLOSED, cycle).ends
    yield Row("V", "end of a branch", speed, end.value, note=end.kind)


if __name__ == "__main__":
    show(cycles)
    show(end_of_cycle)
