"""Follow a border: pseudo-arclength continuation of the equations of `symosc.orbits.border_system`,
from a node to both ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from symosc.kernels import linear
from symosc.orbits.admissibility import Condition
from symosc.orbits.border_points import (
    LOCATED,
    SpecialPoint,
    between,
    end_between,
    failing,
    fold_between,
)
from symosc.orbits.border_system import BorderSystem, Node
from symosc.orbits.branch import MOST, NO_CONVERGENCE, RANGE

CLOSED = "closed"
# Points per check of the inequalities.
CHECKED = 8
# The farthest that a node may be from where it is looked for, as a part of the step.
FARTHEST = 0.1
# The least cosine of the angle between the tangents at both ends of a step.
STRAIGHT = 0.98
SHORTEST_STEP = 1e-9
GROWTH = 1.5
# Slopes of a line along an axis, which are rounding alone, differ by less.
LEAST_TURN = 1e-6
# A border along a bound of the range is not outside.
BOUND_ROUNDING = 1e-14


class BorderEnd(NamedTuple):
    """Where and why a border ends.

    Attributes
    ----------
    kind : str
        "codimension two", "end of the range", "closed", "no convergence" or "max_points".
    values : tuple of two floats
        The values of the two parameters at this end of the border.
    message : str

    Examples
    --------
    >>> from symosc import continue_border, continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> border = continue_border(branch, 0, "FN", (9, 11))
    >>> [end.kind for end in border.ends]
    ['end of the range', 'end of the range']
    """

    kind: str
    values: tuple[float, float]
    message: str


class Bound(NamedTuple):
    """A bound of the range that a border crosses: the number of its parameter, and its value."""

    j: int
    value: float


class Course(NamedTuple):
    """A border as it was followed: its nodes in order, both ends, and its special points."""

    path: list[Node]
    ends: tuple[BorderEnd, BorderEnd]
    special: list[SpecialPoint]


def followed(system: BorderSystem, first: Node, step: float, most: int) -> Course:
    """Follow a border both ways from its node `first`, by steps up to `step` to `most` points."""
    forward = Walk(system, first, step, most)
    last = forward.run()
    if last.kind == CLOSED:
        return Course(forward.path, (last, last), forward.special)
    backward = Walk(system, first._replace(tangent=-first.tangent), step, most)
    begin = backward.run()
    turned = [node._replace(tangent=-node.tangent) for node in reversed(backward.path[1:])]
    special = [*reversed(backward.special), *forward.special]
    return Course(turned + forward.path, (begin, last), special)


class Walk:
    """One run along a border: from a node, along its tangent, to an end or to `most` points."""

    def __init__(self, system: BorderSystem, first: Node, step: float, most: int) -> None:
        self.plane = system.plane
        self.system = system
        self.first = first
        self.longest = step
        self.most = most
        self.low = self.plane.low / self.plane.widths
        self.high = self.plane.high / self.plane.widths
        self.path = [first]
        self.special = list[SpecialPoint]()
        # The number of nodes up to which the inequalities are known to hold, and their margins
        # there.
        self.checked = 0
        self.margins: list[Condition] | None = None

    def run(self) -> BorderEnd:
        """Follow the border to its end and return it; nodes and special points are kept."""
        step = self.longest
        bend = 0.0 * self.first.z  # not known yet
        while True:
            here = self.path[-1]
            node = self._next_node(here, step, bend)
            if node is None:
                step /= 2
                if step < SHORTEST_STEP:
                    message = "the steps became too short: the equations are singular there"
                    return self._end(NO_CONVERGENCE, message)
                continue
            bend = (node.tangent - here.tangent) / linear.norm(node.z - here.z)
            bound = self._crossed_bound(here, node)
            if bound is not None:
                node = self._node_at(bound, here, node)
            self._add_folds(here, node)
            if bound is not None and linear.norm(node.z - here.z) < LOCATED:
                self.path.pop()  # it was there already
            self.path.append(node)
            end = self._end_here(here, bound)
            if end is not None:
                return end
            step = min(GROWTH * step, self.longest)

    def _end(self, kind: str, message: str) -> BorderEnd:
        """Return an end at the last node."""
        return BorderEnd(kind, self.system.values(self.path[-1].z), message)

    def _next_node(self, here: Node, step: float, bend: np.ndarray) -> Node | None:
        """Return the node a step further, or None if the step is too long for the curve."""
        # `bend` is how the tangent changes by length.
        guess = here.z + step * here.tangent + 0.5 * step * step * bend
        node = self.system.node(guess, here.tangent)
        if node is None or not linear.norm(node.z - guess) < FARTHEST * step:
            return None
        if linear.dot(node.tangent, here.tangent) < STRAIGHT:
            return None
        return node

    def _crossed_bound(self, here: Node, node: Node) -> Bound | None:
        """Return the bound of the range that lies between two nodes, the first one of several, or
        None.
        """
        crossed = list[tuple[float, Bound]]()
        ranges = zip(here.z[-2:], node.z[-2:], self.low, self.high, strict=True)
        for j, (before, value, low, high) in enumerate(ranges):
            if not low - BOUND_ROUNDING <= value <= high + BOUND_ROUNDING:
                bound = Bound(j, float(low if value < low else high))
                crossed.append((float((bound.value - before) / (value - before)), bound))
        return min(crossed, default=(0.0, None))[1]

    def _node_at(self, bound: Bound, here: Node, node: Node) -> Node:
        """Return the node at a bound between two nodes; `here` if it is not found."""
        column = -2 + bound.j  # of the parameter: they are the last two unknowns
        fraction = (bound.value - here.z[column]) / (node.z[column] - here.z[column])
        guess = between(here, node, float(fraction))
        guess[column] = bound.value
        return self.system.node(guess, here.tangent, np.eye(len(guess))[column]) or here

    def _add_folds(self, here: Node, node: Node) -> None:
        """Add the folds between two nodes to the path and to the special points."""
        for j in (0, 1):
            slopes = np.array([here.slope(j), node.slope(j)])
            if slopes.prod() < 0 and np.ptp(slopes) > LEAST_TURN:
                fold = fold_between(self.system, here, node, j)
                if fold is not None:
                    fold_node, special_point = fold
                    self.path.append(fold_node)
                    self.special.append(special_point)

    def _end_here(self, here: Node, bound: Bound | None) -> BorderEnd | None:
        """Return the end of the border if it is at the last node or before it, else None."""
        # The inequalities are checked first: the border ends where one fails, whatever comes later.
        closed = bound is None and self._is_closed(here)
        is_last = bound is not None or closed or len(self.path) > self.most
        if is_last or len(self.path) - self.checked > CHECKED:
            at = self._first_failure()
            if at is not None:
                return self._cut(at)
            self.checked = len(self.path) - 1
        if closed:
            self.path[-1] = self.first
            return self._end(CLOSED, "the curve is closed")
        if bound is not None:
            value = bound.value * self.plane.widths[bound.j]
            message = f"{self.plane.names[bound.j]} = {value:.10g}; the border goes on"
            return self._end(RANGE, message)
        if len(self.path) > self.most:
            return self._end(MOST, f"stopped after {self.most} points")
        return None

    def _is_closed(self, here: Node) -> bool:
        """Return whether the first node lies between `here` and the last node."""
        if len(self.path) <= CHECKED:
            return False
        to_first = self.first.z - here.z
        along = self.path[-1].z - here.z
        length = linear.norm(along)
        fraction = linear.dot(to_first, along) / length**2
        distance = linear.norm(to_first - fraction * along)  # from the chord
        return bool(0 <= fraction <= 1 and distance < FARTHEST * length)

    def _cut(self, at: int) -> BorderEnd:
        """End the path where an inequality vanishes, before the node with the number `at`."""
        last, point = end_between(self.system, self.path[at - 1], self.path[at])
        del self.path[at:]
        values = {self.system.values(node.z) for node in self.path}
        self.special = [fold for fold in self.special if fold.values in values]
        self.special.append(point)
        self.path.append(last)
        return self._end("codimension two", f"{point.kind}: {point.message}")

    def _first_failure(self) -> int | None:
        """Return the number of the first node after the last check at which an inequality fails, or
        None.
        """
        low = self.checked  # where all inequalities are known to hold
        high = len(self.path) - 1
        before = self.margins
        self.margins = self.system.margins(self.path[high].z)
        if all(condition.value > 0 for condition in self.margins):
            if _are_steady(before, self.margins):
                return None
            # They hold at both checks, but one may fail in between: every node is looked at.
            between_checks = range(low + 1, high)
            return next((i for i in between_checks if self._fails(i)), None)
        # One fails at the last node: bisected.
        while high - low > 1:
            middle = (low + high) // 2
            if self._fails(middle):
                high = middle
            else:
                low = middle
        return high

    def _fails(self, i: int) -> bool:
        """Return whether an inequality fails at the node with the number i."""
        return failing(self.system, self.path[i]) is not None


def _are_steady(before: Sequence[Condition] | None, after: Sequence[Condition]) -> bool:
    """Return whether no margin is likely to have been negative between two checks."""
    # A margin may dip between them: how it has changed tells how far.
    if before is None:
        return True
    for earlier, later in zip(before, after, strict=False):
        change = abs(earlier.value - later.value)
        if change and min(earlier.value, later.value) <= min(change, later.value / 2):
            return False
    return True
