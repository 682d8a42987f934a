"""The friction law: belts, and the domains, boundaries, mappings and forces that follow from them.

Belts are numbered from 1, in order of speed. Belt b is the boundary b of the domains b and b + 1:
`belts` belts make `belts` + 1 domains. Whatever depends on how many belts there are, or on which
side of a belt a domain lies, asks this module; the paper's two belts are `TWO_BELTS`.

Where the friction of a belt depends on the relative speed, it is linear between the points of the
belt's curve. Such a point is a corner, a speed at which the slope of the friction changes. Belts
and corners are the edges of the law. Between two edges lies a band, in which the motion is linear;
a domain consists of one band or more.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
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
        return stick_code(boundary)


def domain_code(domain: int) -> int:
    """Return the code of a domain as the mode of a motion: the paper's are 1, 2 and 3."""
    if domain <= PAPER_BELTS + 1:
        return domain
    return 2 * domain - 2


def stick_code(boundary: int) -> int:
    """Return the code of a stick on a belt: those of the paper follow its domains, and further
    domains and belts take turns.
    """
    if boundary <= PAPER_BELTS:
        return PAPER_BELTS + 1 + boundary
    return 2 * boundary + 1


PAPER_BELTS = 2
#: So many belts have codes.
MOST_BELTS = 50
#: The paper's names, in the order in which `geometry` makes the mappings of two belts.
PAPER_LABELS = ("P1", "P2", "P3", "P4", "P5", "P6", "P7", "P8")


@cache
def geometry(belts: int) -> Geometry:
    """Return what follows from the number of belts.

    A mapping is a stick on a belt (S), a flight back to it from below (B) or above (A), or a passage
    between neighbouring belts, down (D) or up (U): 5n - 2 mappings of n belts. Their number in
    `maps`, from 1, does not depend on how many belts there are.
    """
    boundaries = tuple(range(1, belts + 1))
    domains = tuple(range(1, belts + 2))
    names = {domain_code(domain): f"Omega{domain}" for domain in domains}
    names |= {stick_code(boundary): f"belt{boundary}" for boundary in boundaries}
    # Name, planes (superscript, boundary) of the start and of the end, domain. The order is that of
    # the paper for two belts; what another belt adds comes behind.
    rows = []
    for belt in boundaries:
        rows += [
            (f"S{belt}", (0, belt), (0, belt), 0),
            (f"B{belt}", (1, belt), (1, belt), belt),
            (f"A{belt}", (2, belt), (2, belt), belt + 1),
        ]
        if belt > 1:
            rows += [
                (f"D{belt}{belt - 1}", (1, belt), (2, belt - 1), belt),
                (f"U{belt - 1}{belt}", (2, belt - 1), (1, belt), belt),
            ]
    maps = {}
    for i, (name, start, end, domain) in enumerate(rows):
        if belts == 2:
            label = PAPER_LABELS[i]
        else:
            label = name
        if domain:
            mode = domain_code(domain)
        else:
            mode = stick_code(start[1])
        maps[label] = Map(label, SwitchingPlane(*start), SwitchingPlane(*end), domain, mode)
    neighbours = {boundary: (boundary, boundary + 1) for boundary in boundaries}
    return Geometry(domains, boundaries, names, neighbours, maps)


#: The names of all modes by their codes.
ALL_MODE_NAMES = geometry(MOST_BELTS).mode_names
#: The paper's oscillator.
TWO_BELTS = geometry(2)
MODE_NAMES = TWO_BELTS.mode_names
NEIGHBOURS = TWO_BELTS.neighbours
MAPS = TWO_BELTS.maps


class BeltNumbers(NamedTuple):
    """The numbers of a belt: its speed v, its kinetic and its static coefficient of friction.

    They are numbers of any kind, or columns. Without `mu_s` the two coefficients are equal. `mu` is
    the kinetic coefficient at the belt's speed. Where it depends on the relative speed w, `curve`
    has its points (w, mu) from w = 0 on, and `slope` is that beyond the last one.
    """

    v: Any
    mu: Any
    mu_s: Any = None
    curve: Sequence[tuple[Any, Any]] = ()
    slope: Any = 0


#: The names of a belt's numbers without those of its curve. Those of belt 1 are called v1, mu1 and
#: mu_s1 wherever all numbers of an oscillator have names. The first two are required.
BELT_NAMES = tuple(name for name in BeltNumbers._fields if name not in ("curve", "slope"))
REQUIRED_OF_BELT = tuple(name for name in BELT_NAMES if name not in BeltNumbers._field_defaults)


class StraightPiece(NamedTuple):
    """A piece of a belt's kinetic friction coefficient: mu + slope w from a relative speed `begin`
    on.
    """

    begin: Any
    mu: Any
    slope: Any


def kinetic_pieces(belt: BeltNumbers) -> list[StraightPiece]:
    """Return a straight piece of a belt's kinetic friction for each point of its curve."""
    points = belt.curve or [(Fraction(0), belt.mu)]
    slopes = [(high - low) / (end - begin) for (begin, low), (end, high) in pairwise(points)]
    return [
        StraightPiece(begin, mu - slope * begin, slope)
        for (begin, mu), slope in zip(points, [*slopes, belt.slope], strict=True)
    ]


def kinetic_lines(belt: BeltNumbers) -> list[StraightPiece]:
    """Return the straight pieces of a belt's kinetic friction, from the relative speed 0 on."""
    lines = list[StraightPiece]()
    for piece in kinetic_pieces(belt):
        if not lines or piece.slope != lines[-1].slope:  # no corner between two pieces of one line
            lines.append(piece)
    return lines


class EdgeOfLaw(NamedTuple):
    """A speed at which the friction force or its slope jumps.

    J is by how much the force below exceeds the force above, E by how much static friction exceeds
    kinetic friction; `belt` is the number of the belt, 0 at a corner.
    """

    v: Any
    J: Any
    E: Any
    belt: int


class RowOfLaw(NamedTuple):
    """What the engine follows with one set of constants: three neighbouring domains of equal
    damping, of which it may use the middle one only.

    Attributes
    ----------
    slope : number or None
        What friction adds to the damping c; None: nothing.
    forces : tuple
        The friction forces in the three domains.
    below, above : EdgeOfLaw or None
        The edges between them; None: there is none.
    domain : int
        The domain of the law to which the middle one belongs.
    """

    slope: Any
    forces: tuple[Any, Any, Any]
    below: EdgeOfLaw | None
    above: EdgeOfLaw | None
    domain: int


class PlaceInLaw(NamedTuple):
    """Where a velocity lies: the number of its row, there its domain (1, 2 or 3), and the edge that
    has this velocity (1 below the middle domain, 2 above it, 0 none; then `domain` is below it).
    """

    row: int
    domain: int
    edge: int


def kinetic_coefficient(belt: BeltNumbers) -> Any:
    """Return the kinetic friction of a belt as a part of the normal force."""
    return belt.mu


def static_coefficient(belt: BeltNumbers) -> Any:
    """Return the static friction of a belt that has its own, as a part of the normal force."""
    return belt.mu_s


@dataclass(frozen=True, eq=False)
class FrictionLaw:
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

    @cached_property
    def has_curves(self) -> bool:
        """Whether the friction of a belt depends on the relative speed."""
        return any(belt.curve or belt.slope for belt in self.belts)

    @cached_property
    def is_plain(self) -> bool:
        """Whether one row of constants is enough: at most two belts, whose friction does not depend
        on the relative speed.
        """
        return len(self.belts) <= len(TWO_BELTS.boundaries) and not self.has_curves

    @cached_property
    def lines(self) -> list[list[StraightPiece]]:
        """The straight pieces of the kinetic friction of each belt."""
        return [kinetic_lines(belt) for belt in self.belts]

    @cached_property
    def edges(self) -> list[EdgeOfLaw]:
        """The belts and corners, in order of speed."""
        found = {
            belt.v: EdgeOfLaw(belt.v, 2 * self.kinetic(n), self.excess(n), n)
            for n, belt in enumerate(self.belts, 1)
        }
        corners = {
            speed
            for belt, lines in zip(self.belts, self.lines, strict=True)
            for line in lines
            for speed in (belt.v - line.begin, belt.v + line.begin)
        }
        for speed in corners - found.keys():
            # the corners of two belts may make up for each other
            found[speed] = EdgeOfLaw(speed, Fraction(0), Fraction(0), 0)
        return [found[speed] for speed in sorted(found)]

    @cached_property
    def rows(self) -> list[RowOfLaw]:
        """The rows of constants: one if the law is plain, else one for each band."""
        if self.is_plain:
            lower, *others = (
                EdgeOfLaw(belt.v, 2 * self.kinetic(n), self.excess(n), n)
                for n, belt in enumerate(self.belts, 1)
            )
            upper = others[0] if others else None
            forces = (self.force(1), self.force(2), self.force(3))
            return [RowOfLaw(None, forces, lower, upper, 2)]
        edges = self.edges
        rows = []
        domain = 1
        for below, above in pairwise([None, *edges, None]):
            if below is not None and below.belt:
                domain += 1
            slope, force = self.line_between(below and below.v, above and above.v)
            forces = (
                force + (below.J if below else 0),
                force,
                force - (above.J if above else 0),
            )
            rows.append(RowOfLaw(slope, forces, below, above, domain))
        return rows

    def damping(self, c: Any, row: int) -> Any:
        """Return the damping in a row of constants: the damper's c, and what friction adds."""
        slope = self.rows[row].slope
        if slope is None:
            return c
        return c + slope

    def line_between(self, below: Any, above: Any) -> tuple[Any, Any]:
        """Return what friction adds to the damping, and its constant part, between the speeds of two
        neighbouring edges (None: there is none).
        """
        total_slope = Fraction(0)
        total_force = Fraction(0)
        for belt, lines in zip(self.belts, self.lines, strict=True):
            if above is not None and above <= belt.v:  # the belt is faster, and drags forward
                side = 1
                nearest = belt.v - above
            else:
                side = -1
                nearest = below - belt.v
            line = lines[bisect(lines, nearest, key=lambda line: line.begin) - 1]
            total_slope += line.slope * self.FN
            total_force += (side * line.mu + line.slope * belt.v) * self.FN
        return total_slope, total_force

    def place_of(self, v: Any) -> PlaceInLaw:
        """Return where a velocity lies."""
        if self.is_plain:
            return PlaceInLaw(0, self.domain_of(v), self.boundary_of(v))
        speeds = [edge.v for edge in self.edges]
        row = sum(v > speed for speed in speeds)
        return PlaceInLaw(row, 2, 2 if v in speeds else 0)

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
