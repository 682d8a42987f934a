"""Z. Iklodi and Z. Dombovari, Nonlinear Dynamics (2024), doi:10.1007/s11071-024-10188-8.

The ends of the branch of motions without stops with the parameters of their demo: c = 0.1, P = 1.5,
F = 1, static friction 1.1 times the kinetic one. The code of the demo was at hand; it prints no
numbers. A motion without stops turns with a force beyond the static limit. The branch ends where
that force has fallen to the limit; with static friction equal to kinetic friction it ends farther
out.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import pi
from typing import Any

from wall import MP, Row, Symmetric, number, show, wall

from symosc import Belt, Oscillator, Summary, continue_orbit, simulate_many

#: Static friction beyond kinetic friction.
EXCESS = "0.1"
#: Two values of Omega, without and with stops, that enclose each end.
ENCLOSED = ((Fraction(3, 4), Fraction(74, 100)), (Fraction(12, 10), Fraction(121, 100)))
#: Periods after which a motion from rest has settled, and those that are looked at.
SETTLED = 100
WATCHED = 20


def demo(Omega: Any) -> Oscillator:
    """Return the oscillator of the demo at a frequency."""
    return Oscillator(m=1, c="0.1", k=1, B0="1.5", Omega=Omega, belts=[Belt(0, mu=1, mu_s="1.1")])


def settled(Omega: Any) -> Summary:
    """Return the summary of 20 settled periods of the motion from rest."""
    period = 2 * pi / float(Omega)
    summary: Summary = simulate_many(
        demo(Omega),
        (0, 0, 0),
        (SETTLED + WATCHED) * period,
        skip=SETTLED * period,
        record=("sticks", "stuck", "x_max"),
    )
    return summary


def end_of_branch(near: Any) -> Symmetric:
    """Return the motion that turns just at the static limit."""

    def excess(Omega: Any) -> Any:
        motion = Symmetric(1, Omega, "0.1", "1.5")
        return motion.acceleration_after_turning() + number(EXCESS)

    Omega = MP.findroot(excess, (number(near), number(near) + MP.mpf("1e-4")), solver="secant")
    return Symmetric(1, Omega, "0.1", "1.5")


def end_by_running(without: Fraction, with_stops: Fraction) -> Fraction:
    """Bisect Omega between a motion without stops and one with stops, to 1e-9."""
    while abs(with_stops - without) > Fraction(1, 10**9):
        middle = (without + with_stops) / 2
        if settled(middle).sticks[0]:
            with_stops = middle
        else:
            without = middle
    return without


def ends() -> Iterator[Row]:
    """Where the motions without stops end, P = 1.5, c = 0.1, F = 1, static friction 1.1; run: simulate_many."""
    for without, with_stops in ENCLOSED:
        motion = end_of_branch(without)
        run = end_by_running(without, with_stops)
        yield Row("Omega", "", motion.Omega, run, 8, 2e-9)
        highest = settled(run).x_max[0]
        yield Row("x_0", "there", motion.highest, highest, 8, 1e-8)


def stops() -> Iterator[Row]:
    """How many stops per period beside the ends and between them: counted by a run and expected."""
    cases = (("0.6", 2), ("0.7486", 2), ("0.7487", 0), ("1", 0), ("1.2062", 0), ("1.2063", 2))
    for Omega, expected in cases:
        summary = settled(Fraction(Omega))
        counted = int(summary.sticks[0]) / WATCHED
        note = f"sticks {100 * summary.stuck[0]:.4f} % of the time"
        yield Row("stops", f"Omega = {Omega}", expected, counted, 0, note=note)


def coulomb_ends() -> Iterator[Row]:
    """Where it ends if static friction equals kinetic friction; run: continue_orbit."""

    def excess(Omega: Any) -> Any:
        return Symmetric(0, Omega, "0.1").largest_force_ratio() * MP.mpf("1.5") - 1

    branch = continue_orbit(wall(1, 1, "0.1", P="1.5"), "P32", "Omega", ("0.6", "1.5"))
    for end in branch.ends:
        Omega = MP.findroot(excess, (end.value, end.value + 1e-4), solver="secant")
        highest = Symmetric(1, Omega, "0.1", "1.5").highest
        yield Row("Omega", "s = F", Omega, end.value, note=end.kind)
        yield Row("x_0", "there", highest, max(point.x for point in end.points), 10, 1e-10)


if __name__ == "__main__":
    for rows in (ends, stops, coulomb_ends):
        show(rows)
