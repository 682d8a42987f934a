"""What motions settle to beside periodic orbits: rests, and cycles that are only observed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symosc.base.display.drawable import Comparable
from symosc.model import Model, Oscillator, Parameters
from symosc.orbits.rests import rests_of


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
    rests = rests_of(model)
    if rests is None:
        return None
    law = model.law
    holds = rests.belt and (law.kinetic(rests.belt) or law.excess(rests.belt))
    return Rest(float(rests.low), float(rests.high), rests.belt if holds else 0)


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
