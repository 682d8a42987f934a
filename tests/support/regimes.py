"""Parameter sets of all regimes: any damping, resonance, no spring, no drive."""

from __future__ import annotations

import random
from fractions import Fraction

from symosc import Parameters


def random_sets(seed: int, count: int) -> list[Parameters]:
    """Return sets of all regimes.

    One in three is at critical damping, at resonance, or without spring or drive.
    """
    dice = random.Random(seed)

    def number(low: float, high: float) -> Fraction:
        digits = 10 ** dice.choice((1, 2, 16))
        return Fraction(dice.randint(int(low * digits), int(high * digits)), digits)

    def one() -> Parameters:
        m = number(0.1, 3)
        k = number(0.1, 9)
        c = number(0, 5)
        Om = number(0.1, 6)
        low = number(-5, 5)
        kind = dice.randrange(12)
        if kind == 0:
            # critical damping
            k = m * Om * Om / 4
            c = m * Om
        if kind == 1:
            # resonance
            k = m * Om * Om
            c = Fraction(0)
        k, c, B0 = (
            Fraction(0) if kind == n else value for n, value in ((2, k), (3, c), (4, number(-9, 9)))
        )
        if kind == 5:
            B0 = -k * low / Om  # on belt 1 the slope touches 0 and keeps its sign
        others = {name: number(0, 2) for name in ("mu1", "mu2", "FN")}
        return Parameters(
            m=m,
            c=c,
            k=k,
            A0=number(-9, 9),
            B0=B0,
            Omega=Om,
            v1=low,
            v2=low + number(0.1, 3) + 1,
            **others,
        )

    return [one() for _ in range(count)]


def hundredths(dice: random.Random, low: float, high: float) -> Fraction:
    """Return a whole number of hundredths between two bounds."""
    return Fraction(dice.randint(int(low * 100), int(high * 100)), 100)


def regime_of_seed(dice: random.Random, seed: int) -> Parameters:
    """Return a set whose numbers are hundredths.

    One in four is at critical damping, every eleventh seed has no spring unless it is, and every
    seventh has no drive.
    """
    m = hundredths(dice, 0.2, 2)
    k = hundredths(dice, 0.5, 6)
    Omega = hundredths(dice, 0.5, 4)
    low = hundredths(dice, -2, 1)
    critical = 2 * m * Omega
    c = dice.choice((Fraction(0), hundredths(dice, 0, 1), critical, hundredths(dice, 3, 9)))
    if c == critical:
        k = m * Omega * Omega
    elif seed % 11 == 3:
        k = Fraction(0)
    if seed % 7 == 5:
        B0 = Fraction(0)
    else:
        B0 = hundredths(dice, 1, 9)
    mu1 = hundredths(dice, 0, 1)
    mu2 = hundredths(dice, 0, 1)
    A0 = hundredths(dice, -2, 2)
    v2 = low + hundredths(dice, 0.5, 3)
    return Parameters(
        m=m, c=c, k=k, A0=A0, B0=B0, Omega=Omega, v1=low, v2=v2, mu1=mu1, mu2=mu2, FN=2
    )
