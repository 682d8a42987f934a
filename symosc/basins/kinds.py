"""What motions settle to beside periodic orbits: rests, and cycles that are only observed."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from symosc.base.display.drawable import Comparable
from symosc.model import Model, Oscillator, Parameters


def oscillator_of(model: Model) -> Oscillator:
    """Return a model as an `Oscillator`."""
    if isinstance(model, Parameters):
        return model.oscillator
    assert isinstance(model, Oscillator)
    return model


@dataclass(frozen=True)
class Rest:
    """All positions in which the mass may rest for ever: one attractor.

    Attributes
    ----------
    low, high : float
        The least and the greatest of these positions; equal unless a belt stands still.
    belt : int
        The number of the belt that holds the mass; 0: none does, the spring balances the forces.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, attractors
    >>> wall = Oscillator(m=1, c=0, k=1, belts=[Belt(0, mu="1/2")])
    >>> attractors(wall, [(0, 2, 0), (0, 5, 0)]).orbits[0]
    Rest(low=-0.5, high=0.5, belt=1)
    """

    low: float
    high: float
    belt: int

    @property
    def is_rest(self) -> bool:
        """Whether the mass rests."""
        return True

    @property
    def name(self) -> str:
        """A short name for legends."""
        if self.belt:
            return f"rest on belt {self.belt}"
        return "rest"


def rest_of(model: Model) -> Rest | None:
    """Return where the mass may rest whatever the drive does; None if nowhere."""
    law = oscillator_of(model)
    if law.k == 0:
        return None
    below, above = forces_at_rest(law)
    belt = law.law.boundary_of(0)
    if belt:
        excess = law.law.excess(belt)
    else:
        excess = 0 * law.k
    drive = abs(law.B0)
    low = above - excess + drive
    high = below + excess - drive
    if low > high:
        return None
    if not (below - above or excess):
        belt = 0
    return Rest(float(low / law.k), float(high / law.k), belt)


def forces_at_rest(law: Oscillator) -> tuple[Fraction, Fraction]:
    """Return the constant forces on the mass at velocities just below and just above 0."""
    band_below = next(band for band in law.bands if band.above is None or band.above >= 0)
    band_above = next(band for band in reversed(law.bands) if band.below is None or band.below <= 0)
    return band_below.A, band_above.A


@dataclass(frozen=True, eq=False, repr=False)
class ObservedCycle(Comparable):
    """A periodic motion to which starts settle, where Newton's method does not find it as a
    `PeriodicOrbit`.

    Attributes
    ----------
    points : (n, 2) float array
        Position and velocity at the ends of forcing periods or, without a drive, where v falls
        through 0.
    period : float
    periods : int
        Forcing periods; 0 without a drive.
    word : str
        Its mappings as a cycle.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, attractors
    >>> belt = Belt("1/5", mu="1/2", mu_s=1)
    >>> found = attractors(Oscillator(m=1, c=0, k=1, belts=[belt]), [(0, 3, 0)])
    >>> f"{float(found.orbits[0].period):.6f}"
    '8.902605'
    """

    points: np.ndarray
    period: float
    periods: int
    word: str

    @property
    def is_rest(self) -> bool:
        """Whether the mass rests: not in a cycle."""
        return False

    @property
    def name(self) -> str:
        """A short name for legends."""
        if self.periods:
            return f"period {self.periods}"
        return "cycle"

    def __repr__(self) -> str:
        return f"<ObservedCycle {self.word}: period {self.period:.6g}>"
