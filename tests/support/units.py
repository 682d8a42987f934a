"""Other units: the same motion with its times, lengths and masses told in other units, which are powers of 2.

A power of 2 changes no digit of a double. So what is computed in other units has to be the same
number to the last bit, times a power of 2, unless a formula adds or compares quantities of two
kinds.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from symosc import Parameters


class Units(NamedTuple):
    """How many of the new units make one of the old: of time, length and mass."""

    time: Fraction
    length: Fraction
    mass: Fraction

    def of(self, p: Parameters) -> Parameters:
        """Return the parameters of the same oscillator."""
        T, L, M = self
        force = M * L / T**2
        speed = L / T
        factors = {
            "m": M,
            "c": M / T,
            "k": M / T**2,
            "A0": force,
            "B0": force,
            "FN": force,
            "Omega": 1 / T,
        }
        factors |= {"v1": speed, "v2": speed}
        return p.replace(**{name: getattr(p, name) * factor for name, factor in factors.items()})

    @property
    def speed(self) -> float:
        """The factor of velocities."""
        return float(self.length / self.time)

    @property
    def force(self) -> float:
        """The factor of accelerations: forces are divided by the mass."""
        return float(self.length / self.time**2)


def power(exponent: int) -> Fraction:
    return Fraction(2) ** exponent


#: Each unit alone, far up and far down, and all of them together.
UNITS = [
    Units(power(20), power(0), power(0)),
    Units(power(-22), power(0), power(0)),
    Units(power(0), power(25), power(0)),
    Units(power(0), power(-18), power(0)),
    Units(power(0), power(0), power(17)),
    Units(power(-9), power(13), power(-5)),
]
