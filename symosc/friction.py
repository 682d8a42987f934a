"""The friction law: belts, and the domains, boundaries, mappings and forces that follow from them.

Belts are numbered from 1, in order of speed. Belt b is the boundary b of the domains b and b + 1:
`belts` belts make `belts` + 1 domains. Whatever depends on how many belts there are, or on which
side of a belt a domain lies, asks this module; the paper's two belts are `TWO_BELTS`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple


class SwitchingPlane(NamedTuple):
    """A switching plane of the paper, by the number of its belt (`boundary`) and its side
    (`superscript`).

    The `superscript` is 0 for sticking on the belt, 1 for velocities just below the belt's speed
    and 2 for just above.
    """

    superscript: int
    boundary: int

    def __str__(self) -> str:
        return f"Σ{'⁰¹²'[self.superscript]}({self.boundary})"


class Map(NamedTuple):
    """One mapping of the paper: its label, the planes where it starts and ends, its domain (0 for a
    stick), and the code of that domain or of the belt.
    """

    label: str
    start: SwitchingPlane
    end: SwitchingPlane
    domain: int
    mode: int

    @property
    def sticks(self) -> bool:
        """Whether the map is a stick on a belt."""
        return self.domain == 0

    @property
    def returns(self) -> bool:
        """Whether the map is a flight that ends in the plane where it starts, so that it can graze
        there.
        """
        return not self.sticks and self.start == self.end

    @property
    def side(self) -> int:
        """1 if the map ends at a belt from below, -1 if from above, 0 if it sticks."""
        return (0, 1, -1)[self.end.superscript]


class Geometry(NamedTuple):
    """What follows from the number of belts alone.

    Attributes
    ----------
    domains, boundaries : tuple of int
    mode_names : dict
        The states of motion, by the code that the fast paths use: first the domains, then the
        sticks.
    neighbours : dict
        The domains below and above each boundary.
    maps : dict
        All mappings by label: those of two belts are the paper's P1 to P8.
    """

    domains: tuple[int, ...]
    boundaries: tuple[int, ...]
    mode_names: dict[int, str]
    neighbours: dict[int, tuple[int, int]]
    maps: dict[str, Map]

    def stick_mode(self, boundary: int) -> int:
        """Return the code of a stick on the belt at `boundary`."""
        return len(self.domains) + boundary


#: The paper's names, in the order in which `geometry` makes the mappings of two belts.
PAPER_LABELS = ("P1", "P2", "P3", "P4", "P5", "P6", "P7", "P8")


@cache
def geometry(belts: int) -> Geometry:
    """Return what follows from the number of belts.

    A mapping is a stick on a belt (S), a flight back to it from below (B) or above (A), or a passage
    between neighbouring belts, down (D) or up (U): 5n - 2 mappings of n belts.
    """
    boundaries = tuple(range(1, belts + 1))
    domains = tuple(range(1, belts + 2))
    names = {domain: f"Omega{domain}" for domain in domains}
    names |= {len(domains) + boundary: f"belt{boundary}" for boundary in boundaries}
    # Name, planes (superscript, boundary) of the start and of the end, domain.
    rows = []
    for belt in boundaries:
        rows += [
            (f"S{belt}", (0, belt), (0, belt), 0),
            (f"B{belt}", (1, belt), (1, belt), belt),
            (f"A{belt}", (2, belt), (2, belt), belt + 1),
        ]
    for lower, upper in pairwise(boundaries):
        rows += [
            (f"D{upper}{lower}", (1, upper), (2, lower), upper),
            (f"U{lower}{upper}", (2, lower), (1, upper), upper),
        ]
    maps = {}
    for i, (name, start, end, domain) in enumerate(rows):
        if belts == 2:
            label = PAPER_LABELS[i]
        else:
            label = name
        mode = domain or len(domains) + start[1]  # a stick has the code of its belt
        maps[label] = Map(label, SwitchingPlane(*start), SwitchingPlane(*end), domain, mode)
    neighbours = {boundary: (boundary, boundary + 1) for boundary in boundaries}
    return Geometry(domains, boundaries, names, neighbours, maps)


#: The paper's oscillator.
TWO_BELTS = geometry(2)
MODE_NAMES = TWO_BELTS.mode_names
NEIGHBOURS = TWO_BELTS.neighbours
MAPS = TWO_BELTS.maps


class BeltNumbers(NamedTuple):
    """The numbers of a belt: its speed v, its kinetic and its static coefficient of friction.

    They are numbers of any kind, or columns. Without `mu_s` the two coefficients are equal.
    """

    v: Any
    mu: Any
    mu_s: Any = None


#: The names of a belt's numbers; those of belt 1 are called v1, mu1 and mu_s1 wherever all numbers
#: of an oscillator have names. The first two are required.
BELT_NAMES = BeltNumbers._fields
REQUIRED_OF_BELT = tuple(name for name in BELT_NAMES if name not in BeltNumbers._field_defaults)


def kinetic_coefficient(belt: BeltNumbers) -> Any:
    """Return the kinetic friction of a belt as a part of the normal force."""
    return belt.mu


def static_coefficient(belt: BeltNumbers) -> Any:
    """Return the static friction of a belt that has its own, as a part of the normal force."""
    return belt.mu_s


class FrictionLaw(NamedTuple):
    """The belts in order of speed, and the normal force FN that presses the mass between them."""

    belts: Sequence[BeltNumbers]
    FN: Any

    @property
    def boundaries(self) -> range:
        """The numbers of the belts, which are those of the boundaries."""
        return range(1, len(self.belts) + 1)

    @property
    def domains(self) -> range:
        """The numbers of the domains between the belts."""
        return range(1, len(self.belts) + 2)

    def domain_of(self, v: Any) -> int:
        """Return the domain of a velocity that is not the speed of a belt."""
        return 1 + sum(v > belt.v for belt in self.belts)

    def boundary_of(self, v: Any) -> int:
        """Return the number of the belt that has the speed v, 0 if none has."""
        for boundary, belt in enumerate(self.belts, 1):
            if belt.v == v:
                return boundary
        return 0

    def force(self, domain: int) -> Any:
        """Return the sum of all friction forces on the mass in a domain (eq. (5)).

        A belt that is faster than the mass drags it forward, a slower one holds it back.
        """
        coefficient: Any = 0
        for boundary, belt in enumerate(self.belts, 1):
            if boundary >= domain:
                coefficient = coefficient + kinetic_coefficient(belt)
            else:
                coefficient = coefficient - kinetic_coefficient(belt)
        return coefficient * self.FN

    def kinetic(self, boundary: int) -> Any:
        """Return mu FN, the kinetic friction of the belt at a boundary."""
        return kinetic_coefficient(self.belts[boundary - 1]) * self.FN

    def excess(self, boundary: int) -> Any:
        """Return (mu_s - mu) FN, by how much static friction of a belt exceeds its kinetic friction."""
        belt = self.belts[boundary - 1]
        if belt.mu_s is None:
            return Fraction(0)
        return (static_coefficient(belt) - kinetic_coefficient(belt)) * self.FN
