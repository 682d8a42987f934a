"""Find borders: a first node of each border that lies between two points of a plane of parameters."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from symosc.base.errors import SymoscError
from symosc.kernels import linear
from symosc.orbits import border_system
from symosc.orbits.admissibility import conditions
from symosc.orbits.border_points import MOST_HALVINGS, PlacedOrbit, motion_at, scaled_margin
from symosc.orbits.border_system import BorderPlane, BorderSystem, ClosedForm, Node, zeros_of
from symosc.orbits.closing_equations import ClosingEquations, Orbit

# Distances as parts of the ranges: from a border to where its words are looked at (or, for the loss
# of a word, as a part of the way), and from a border to where a narrow region behind it is looked
# for.
BESIDE = (1e-6, 1e-5, 1e-4, 1e-7)
BESIDE_PART = 1e-5
SHIFTS = (1e-9, 1e-8, 1e-7, 1e-6)
# The inequalities of a word that are tried, those that are nearest to 0 first.
TRIED = 6
# From a border's first node to a second one.
SECOND_NODE = 1e-4
# A segment is short enough for a border's equations at this part of the whole way, or of the
# ranges; it is not cut any more at the last of the three.
SHORT_PART = 1e-3
SHORT_LENGTH = 1e-6
LEAST_LENGTH = 1e-9
# How near the holding force is to the driving one on a border of closed form, as a part of it.
CLOSE_FORCES = 1e-6
# Where a border may cross the line of a segment, as parts of the segment.
CROSSING_PARTS = (-0.5, 1.5)

#: The equations of a border, and its first node.
Begun = tuple[BorderSystem, Node]


class BorderError(SymoscError, ArithmeticError):
    """Raised if the border at the end of a branch cannot be found or followed.

    Examples
    --------
    >>> from symosc import BorderError, Parameters, continue_border, continue_orbit
    >>> p = Parameters(m=1, c=0.5, k=1, A0=0, B0=1.2, Omega=1, v1=-1.9, v2=1.9, mu1=1, mu2=1, FN=1)
    >>> branch = continue_orbit(p, "P4817", "B0", (0.9, 1.3))
    >>> try:
    ...     continue_border(branch, 0, "v1", (-3, -1))
    ... except BorderError as error:
    ...     print(error)
    P7481 ends where both belts are met at once: two borders meet there
    """


def closed_form(
    plane: BorderPlane, place: np.ndarray, orbit: Orbit
) -> tuple[ClosedForm, Node] | None:
    """Return the border through `place` beyond which the motion of `orbit` rests or meets no belt,
    and its node.
    """
    p = plane.parameters(place)
    system = ClosedForm(plane, p, orbit)
    holds, drives = system.terms(place)
    # A line of speed 0 is a border where friction holds the mass; any other has equal terms.
    if system.line:
        is_there = holds > drives > 0
    else:
        is_there = abs(holds - drives) < CLOSE_FORCES * drives
    if not is_there:
        return None
    if p.v1 == -p.v2 and {"v1", "v2"} & {*plane.names}:
        raise BorderError(
            f"{orbit.cycle} ends where both belts are met at once: two borders meet there"
        )
    node = system.node(place / system.scale, system.along(place))
    if node is not None and all(c.value > 0 for c in system.margins(node.z)):
        return (system, node)
    return None


def crossed_borders(
    plane: BorderPlane, place: np.ndarray, orbit: Orbit, direction: np.ndarray
) -> Iterator[Begun]:
    """Yield the borders of an orbit's word that a line through `place` crosses nearby.

    `orbit` is an orbit at the parameters `place`, the line goes along `direction`, and each border
    comes with a node on it.
    """
    equations = ClosingEquations(plane.parameters(place), orbit.word, orbit.periods)
    points = orbit.points
    nearest = sorted(
        conditions(equations, points), key=lambda condition: abs(scaled_margin(condition))
    )
    zeros = [zero for near in nearest[:TRIED] for zero in zeros_of(equations, points, near)]
    for zero, phases in zeros:
        if zero.kind == border_system.AT_ARRIVAL:  # it belongs to the word with more pieces
            continue
        system = BorderSystem(plane, orbit, [zero])
        z = np.array([*np.ravel(points), *phases, *place]) / system.scale
        # The node is looked for on the line: in the hyperplane whose normal is normal to the line
        # (the two parameters are the last unknowns).
        normal = np.zeros(len(system.scale))
        along = direction / plane.widths
        along_x, along_y = along
        normal[-2:] = np.array([-along_y, along_x]) / linear.norm(along)
        first = system.node(z, normal)
        if first is None:
            continue
        # A second point tells which inequalities are 0 all along.
        second = system.node(first.z + SECOND_NODE * first.tangent, first.tangent)
        if second is None:
            continue
        system.hide([first.z, second.z])
        margins = map(scaled_margin, system.margins(first.z))
        if all(margin > -border_system.NOTHING for margin in margins):
            yield system, first


def first_crossing(plane: BorderPlane, start: PlacedOrbit, stop: PlacedOrbit) -> Begun | None:
    """Return the first border that crosses the segment from `start` to `stop` in the plane; None if
    none is found.
    """
    whole_length = float(np.abs((stop.values - start.values) / plane.widths).max())
    word = start.orbit.cycle
    low = start
    high = stop
    while word != stop.orbit.cycle:
        length = float(np.abs((high.values - low.values) / plane.widths).max())
        if length <= max(SHORT_PART * whole_length, SHORT_LENGTH):  # short enough for the equations
            begun = _crossing_of(plane, low, high)
            if begun is not None:
                return begun
        if length < LEAST_LENGTH:
            return None
        middle = _motion_between(plane, low, high)
        if middle is None:
            return None
        if middle.orbit.cycle == word:
            low = middle
        else:
            high = middle
    return None


def _crossing_of(plane: BorderPlane, low: PlacedOrbit, high: PlacedOrbit) -> Begun | None:
    """Return a border that crosses the short segment from `low` to `high`, with its first node, or
    None.
    """
    segment = high.values - low.values
    # A border's equations are those of the word with fewer pieces, so this end is tried first.
    by_pieces = sorted((low, high), key=lambda end: len(end.orbit.points))
    least, most = CROSSING_PARTS
    for values, orbit in by_pieces:
        for system, node in crossed_borders(plane, values, orbit, segment):
            from_low = system.values(node.z) - low.values
            # how far along the segment the node lies: 0 at `low`, 1 at `high`
            fraction = linear.dot(from_low, segment) / linear.dot(segment, segment)
            if least <= fraction <= most:
                return system, node
    return None


def _motion_between(plane: BorderPlane, low: PlacedOrbit, high: PlacedOrbit) -> PlacedOrbit | None:
    """Return a motion about halfway between two others, or None."""
    for fraction in (0.5, 0.4):  # the first may be on the border
        place = low.values + fraction * (high.values - low.values)
        orbit = motion_at(plane.parameters(place), low.orbit, high.orbit)
        if orbit is not None:
            return PlacedOrbit(place, orbit)
    return None


def all_crossings(plane: BorderPlane, start: PlacedOrbit, stop: PlacedOrbit) -> Iterator[Begun]:
    """Yield, in order, the borders at which the word of the motion changes along the segment from
    `start` to `stop`.
    """
    begun = first_crossing(plane, start, stop)
    if begun is None:
        return
    system, node = begun
    segment = stop.values - start.values
    direction = segment / np.abs(segment / plane.widths).max()
    crossing = system.values(node.z)
    own = system.orbit(node.z)
    if not 0 <= linear.dot(crossing - start.values, direction) <= linear.dot(segment, direction):
        return  # the border at the segment's end, where this search came from, once more
    # Step off the border to both sides, as little as shows two different words there, or as far as
    # the widest shift.
    for shift in SHIFTS:
        before = crossing - shift * direction
        after = crossing + shift * direction
        orbits = [
            motion_at(plane.parameters(beside), own, start.orbit, stop.orbit)
            for beside in (before, after)
        ]
        words = {orbit.cycle for orbit in orbits if orbit is not None}
        if len(words) == 2 and own.cycle in words:
            break
    orbit_before, orbit_after = orbits
    if orbit_before is not None and linear.dot(before - start.values, direction) > 0:
        yield from all_crossings(plane, start, PlacedOrbit(before, orbit_before))
    yield system, node
    if orbit_after is not None and linear.dot(stop.values - after, direction) > 0:
        yield from all_crossings(plane, PlacedOrbit(after, orbit_after), stop)


def loss_of_word(
    plane: BorderPlane, inside: PlacedOrbit, place: np.ndarray
) -> tuple[PlacedOrbit, Begun] | None:
    """Return the border between `inside`, a motion with a word, and `place`, where it has none.

    Return a motion beside the border, and the border; None if it is not found.
    """
    system = ClosedForm(plane, plane.parameters(place), inside.orbit)

    segment = inside.values - place

    def has_word(fraction: float) -> bool:
        """Return whether the motion has a word at this fraction of the way from `place` inside."""
        holds, drives = system.terms(place + fraction * segment)
        return bool(holds < drives)

    low = 0.0
    high = 1.0
    if has_word(low) or not has_word(high):
        return None
    for _ in range(MOST_HALVINGS):
        middle = (low + high) / 2
        if has_word(middle):
            high = middle
        else:
            low = middle
    at_border = place + high * segment
    # Beside the border, by a small part of the way inside.
    near = place + (high + (1 - high) * BESIDE_PART) * segment
    # The border's node gives a guess for the orbit beside it, whose word may differ from that of
    # `inside`; the border is then that of this orbit.
    begun = closed_form(plane, at_border, inside.orbit)
    if begun is None:
        return None
    system, node = begun
    beside = motion_at(plane.parameters(near), system.orbit(node.z))
    if beside is None:
        return None
    border = closed_form(plane, at_border, beside)
    if border is None:
        return None
    return PlacedOrbit(near, beside), border
