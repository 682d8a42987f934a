"""J. P. Den Hartog, Phil. Mag. 9 (1930) 801-817, and Trans. ASME 53 (1931) 107-115.

Amplitude of the symmetric motion without stops, where it ends, growth at resonance, free decay.
His charts were not at hand: the formulas are derived anew and compared with runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise

from wall import MP, Row, Symmetric, find_border, number, show, wall

from symosc import find_orbit, simulate

#: (c, F, Omega): also critically damped and overdamped.
CASES = (
    ("0", "0.4", "1.5"),
    ("0.2", "0.4", "1.5"),
    ("0.1", "0.25", "0.6"),
    ("2", "0.1", "0.8"),
    ("3", "0.1", "0.7"),
)
#: (c, Omega), and two values of F/P between which the motions without stops end.
BORDERS = (
    ("0", "1.5", "0.646", "0.647"),
    ("0", "0.8", "0.817", "0.818"),
    ("0", "0.3", "0.086", "0.087"),
    ("0.2", "1.5", "0.598", "0.599"),
)


def amplitudes() -> Iterator[Row]:
    """Amplitude; run: the highest point of the orbit P32 with 30 digits."""
    for c, F, Omega in CASES:
        orbit = find_orbit(wall(F, Omega, c), "P32", digits=30)
        highest = max(point.x for point in orbit.points)
        yield Row(
            "x_0", f"c = {c}, F = {F}, Omega = {Omega}", Symmetric(F, Omega, c).highest, highest
        )


def borders() -> Iterator[Row]:
    """Where the motions without stops end; run: bisection by the number of stops per cycle."""
    for c, Omega, low, high in BORDERS:
        border = find_border(low, high, Omega, c)
        formula = Symmetric(0, Omega, c).largest_force_ratio()
        case = f"c = {c}, Omega = {Omega}"
        yield Row("F/P", case, formula, border.middle, 7, 1e-7, border.note)


def growth() -> Iterator[Row]:
    """Rise of the highest point in a cycle at resonance; run: the cycle that differs most."""
    for F, P in (("0.5", "1"), ("0.3", "0.5")):
        start = Fraction(P) / 2 - Fraction(F)  # from here the mass turns at theta = pi/2 + n pi
        path = simulate(wall(F, 1, P=P), t0=0, x0=start, v0=5, t_end=40, digits=30)
        turns = [event.x for event in path.events if event.kind == "cross"]
        rises = [number(after) - number(before) for before, after in pairwise(turns[::2])]
        formula = MP.pi * number(P) - 4 * number(F)
        worst = max(rises, key=lambda rise: abs(rise - formula))
        yield Row("rise", f"P = {P}, F = {F}", formula, worst, note=f"{len(rises)} cycles")


def decay() -> Iterator[Row]:
    """Free motion from x = 0.95, F = 0.1, c = 0: each turn is 2 F nearer to 0."""
    x = Fraction("0.95")
    F = Fraction("0.1")
    path = simulate(wall(F, 1, P=0), t0=0, x0=x, v0=0, t_end=40)
    for i, event in enumerate(path.events, 1):
        nearer = x - 2 * F if x > 0 else x + 2 * F
        x = -nearer
        yield Row(f"x_{i}", "", x, event.x, note="here it stays" * (event.kind == "stick"))


if __name__ == "__main__":
    for rows in (amplitudes, borders, growth, decay):
        show(rows)
