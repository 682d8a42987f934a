"""A calculator for stick-slip of a pulled spring (novasolver.jp).

Its page was at hand. It gives t = mu_s m g/(k V) for the time that the mass sticks and
2 (mu_s - mu_k) m g/k for the length of a slip. In our letters, with the static friction s and the
kinetic friction f, these are s/(k V) and 2 (s - f)/k. The first is right for the first stick only,
which begins with an unstressed spring: each slip leaves the spring stressed to 2f - s, so the next
sticks last 2 (s - f)/(k V). The second is how far the spring relaxes. The mass slips as far only if
V tends to 0, since the end of the spring moves on.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from wall import MP, Row, number, show

from symosc import Belt, Oscillator, simulate

#: V, k, f, s: the values of the page's formula are 4, 1 and 9/2.
SETS = (("1/10", 2, "1/2", "4/5"), ("1/2", 1, "1/4", "1/2"), ("1/100", 20, "3/5", "9/10"))


def pulled() -> Iterator[Row]:
    """Sticks of a mass that a spring pulls, m = 1; run: a wall of speed -V as seen from its end."""
    for V, k, f, s in SETS:
        speed, stiff, kinetic, static = (number(Fraction(value)) for value in (V, k, f, s))
        belt = Belt(-Fraction(V), mu=f, mu_s=s)
        model = Oscillator(m=1, c=0, k=k, belts=[belt])
        first = static / (stiff * speed)
        a = (static - kinetic) / stiff
        w = MP.sqrt(stiff)
        slip = 2 / w * (MP.pi - MP.atan(a * w / speed))
        steady = 2 * a / speed
        t_end = Fraction(MP.nstr(first + 3 * (slip + steady), 15))
        events = simulate(model, v0=-Fraction(V), t_end=t_end).events
        case = f"V = {V}, k = {k}, f = {f}, s = {s}"
        yield Row("first stick", case, first, events[0].t, note="the page's formula")
        yield Row("second stick", "", steady, events[2].t - events[1].t)
        yield Row("third stick", "", steady, events[4].t - events[3].t)
        yield Row("slip", "", slip, events[1].t - events[0].t)
        # Seen from the floor the mass moves by V t more than from the end of the spring.
        moved = events[1].x - events[0].x + float(speed) * (events[1].t - events[0].t)
        yield Row("its length", "", 2 * a + speed * slip, moved, note=f"the page: {2 * a}")


if __name__ == "__main__":
    show(pulled)
