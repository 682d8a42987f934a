"""Branches of periodic orbits: pseudo-arclength continuation, and why a branch ends.

The closing equations plus one for the arclength are solved by Newton's method from a point on the tangent. No general
package is used. These branches end at inequalities (a graze, the birth of a stick), which continuation codes for smooth
systems do not know. The smooth part is Newton's method on a small block system, which is there already.

The equations stay smooth where an orbit ceases to be one (the root goes on as an inadmissible one). So every reason to
end is a change of sign of a smooth function along the branch. A step is accepted if the point halfway is where the
cubic of its two ends says, and if no margin can reach 0 between them (`symosc.orbits.curve`). Otherwise it is halved.
So a gap in a branch is found however narrow it is compared with the steps, and its end is located by the same halving.
Multipliers need no test: no multiplier of an orbit is larger than 1 (`symosc.orbits.floquet`), so there are no folds,
period doublings or Neimark-Sacker bifurcations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import DataFrame, NumberLike, Progress, Record
from symosc.arguments import public
from symosc.display.drawable import Drawable
from symosc.display.frames import imported
from symosc.display.progress import Advance, late_bar
from symosc.errors import ParameterError, SymoscError, meant
from symosc.exact import read_exact, show, whole_number
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.admissibility import FLIGHT_VANISHING, MARGINAL, Condition, conditions, failures
from symosc.orbits.closing_equations import solve
from symosc.orbits.curve import BranchPoint, Curve, no_margin_vanishes, word_beyond
from symosc.orbits.find import find_orbit
from symosc.orbits.floquet import NEAR_ONE
from symosc.orbits.periodic_orbit import PeriodicOrbit, SwitchingPoint
from symosc.scenes import ParametersLike
from symosc.words import WordLike, read_word

RANGE, NO_CONVERGENCE, MOST = "end of the range", "no convergence", "max_points"

# Steps in the arclength of (x/size, phase, parameter/range).
FIRST_STEP, LONGEST_STEP, SHORTEST_STEP = 0.02, 0.04, 1e-10
BENT = 1e-2  # how far a step may be from its cubic, as a part of its length
# What a margin must have fallen to at an end, as a part of what it was a step before, to count as 0.
VANISHED_PART = 1e-5
REST_PART = 1e-6  # so near to the border of rest, as a part of its terms, flights are too short for steps
UNDECIDED_PART = 1e-3  # the same where doubles cannot decide on which side of 0 a margin is
RESOLUTION = 1e-12  # of the arclength, to which ends are located; closer by, rounding would decide what has happened
# So near to a change, a gap before it that is shorter cannot be seen, and nothing is proven on the way.
NO_GAP, NEAR_CHANGE = 1e-7, 1e-4
MARGINAL_START, AWAY = 1e-6, (1e-6, 1e-5, 1e-4)  # below which a start is at an end, and how far from it to begin
FAR_BEHIND = 1e-3  # arclength before an end at which margins are what they are compared with there
MOST_BACK = 12  # an end is moved back by at most RESOLUTION 4^MOST_BACK


class BranchError(SymoscError, ValueError):
    """Raised if a branch cannot be started because its first root is not an orbit.

    Attributes
    ----------
    orbit : PeriodicOrbit

    Examples
    --------
    >>> from symosc import BranchError, continue_orbit, load_scene
    >>> try:
    ...     continue_orbit(load_scene("fig5").parameters, "P32", "Omega", (0.9, 1.1))
    ... except BranchError as error:
    ...     print(error.orbit.failures[0].text)
    F^(2) > 0 where P2 crosses v1 (Theorem 5)
    """

    def __init__(self, orbit: PeriodicOrbit) -> None:
        self.orbit = orbit
        super().__init__(f"the branch of {orbit.word} has no first orbit: {orbit.message}")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.orbit,)


class BranchEnd(NamedTuple):
    """Location and reason of a branch's end.

    Attributes
    ----------
    kind : str
        "grazing", "birth of a stick", "vanishing of a stick", "birth of a slip", "vanishing of a slip", "vanishing of a
        flight", "end of the range", "no convergence" or "max_points".
    value : float
        The parameter there: the last value with an orbit, to the resolution of doubles.
    message : str
        Which inequality it is, and when in the orbit.
    points : tuple of SwitchingPoint
        The orbit there.
    conditions : tuple of Condition
        The inequalities that pass 0, the one that explains the others first, where they do.
    beyond : str or None
        The word of the orbit just beyond the end: one was found and verified there, as near as 1e-9 of the range. None
        at the end of the range, where the motion has no word (the message says what it does), or if none was found.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> end = branch.ends[0]
    >>> end.kind, f"{end.value:.6f}", end.beyond
    ('birth of a stick', '3.288576', 'P132')
    """

    kind: str
    value: float
    message: str
    points: tuple[SwitchingPoint, ...]
    conditions: tuple[Condition, ...]
    beyond: str | None = None


class Branch(Drawable):
    """A branch of periodic orbits over one parameter.

    Attributes
    ----------
    word : str
    labels : tuple of str
        Its mappings in order of time.
    parameter : str
    values : (m,) array
        The parameter, point by point along the branch.
    points : (m, n, 2) array
        (t, x) of the n switching points.
    multipliers : (m, 2) complex array
    stable : (m,) bool array
        True where damping proves it, or both multipliers are clearly inside the unit circle (`symosc.orbits.floquet`).
    periods : int
        Number of forcing periods.
    ends : tuple of two BranchEnd
        Why it ends at its first and its last point.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.9, 4.1))
    >>> branch.labels, bool(branch.stable.all())
    (('P2', 'P3'), True)
    """

    def __init__(
        self, orbit: PeriodicOrbit, parameter: str, path: list[BranchPoint], ends: tuple[BranchEnd, BranchEnd]
    ) -> None:
        self._orbit = orbit
        self.word, self.labels, self.periods, self.parameter = orbit.word, orbit.labels, orbit.periods, parameter
        self.ends = ends
        self.values = np.array([point.value for point in path])
        Omega = self.values if parameter == "Omega" else np.full(len(path), float(orbit.parameters.Omega))
        x, theta = np.moveaxis(np.array([point.points for point in path]), -1, 0)
        self.points = np.stack([theta / Omega[:, None], x], axis=-1)
        self.multipliers = np.array([point.multipliers for point in path])
        damped = np.array([self.parameters(i).c > 0 for i in range(len(path))])
        self.stable = damped | (np.abs(self.multipliers).max(axis=1) < 1 - NEAR_ONE)

    @public
    def parameters(self, i: int) -> Parameters:
        """Return the parameters of the branch's i-th point; i as for a list, so that -1 is the last one."""
        return self._orbit.parameters.replace(**{self.parameter: float(self.values[self._index(i)])})

    @public
    def orbit(self, i: int, digits: int | None = None) -> PeriodicOrbit:
        """Return the orbit at the branch's i-th point; `digits` as for `symosc.find_orbit`."""
        return find_orbit(self.parameters(i), self.word, self.points[self._index(i)], digits, periods=self.periods)

    def _index(self, i: int) -> int:
        """Return a nonnegative index for i."""
        return whole_number("i", i, -len(self.values), len(self.values) - 1)

    def as_dict(self) -> Record:
        """Return everything as plain values."""

        def plain(end: BranchEnd) -> Record:
            points = [list(map(float, point)) for point in end.points]
            return end._asdict() | {"points": points, "conditions": [c._asdict() for c in end.conditions]}

        return {
            "word": self.word,
            "parameters": self._orbit.parameters.as_dict(),
            "parameter": self.parameter,
            "periods": self.periods,
            "values": self.values.tolist(),
            "points": self.points.tolist(),
            "multipliers": [[[value.real, value.imag] for value in pair] for pair in self.multipliers.tolist()],
            "stable": self.stable.tolist(),
            "ends": [plain(end) for end in self.ends],
        }

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per point of the branch; MissingExtraError if pandas is not installed."""
        columns = {self.parameter: self.values}
        for i in range(self.points.shape[1]):
            columns |= {f"t{i}": self.points[:, i, 0], f"x{i}": self.points[:, i, 1]}
        columns |= {f"multiplier{i}": self.multipliers[:, i] for i in (0, 1)}
        return imported("pandas").DataFrame(columns | {"stable": self.stable})

    def to_xarray(self) -> Any:
        """Return a Dataset over `point`, `switching` and `which`; MissingExtraError if xarray is not installed."""
        columns: Record = {name: (("point", "switching"), self.points[..., i]) for i, name in enumerate(("t", "x"))}
        for name, part in (("re", self.multipliers.real), ("im", self.multipliers.imag)):
            columns[f"multiplier_{name}"] = ("point", "which"), part  # no file format has complex numbers
        columns["stable"] = ("point",), self.stable
        places = {self.parameter: ("point", self.values), "map": ("switching", list(self.labels))}
        about = {"word": self.word, "periods": self.periods, "ends": [end.kind for end in self.ends]}
        return imported("xarray").Dataset(columns, coords=places, attrs=about)

    def __eq__(self, other: object) -> bool:
        """Whether both are the same branch: word, parameters, points, multipliers and ends."""
        if not isinstance(other, Branch):
            return NotImplemented
        return self.as_dict() == other.as_dict()

    def __hash__(self) -> int:
        return hash((self._orbit.parameters, self.word, self.parameter, len(self.values)))

    def __repr__(self) -> str:
        ends = ", ".join(f"{end.kind} at {end.value:.8g}" for end in self.ends)
        return f"<Branch of {self.word} in {self.parameter}, {len(self.values)} points: {ends}>"


@public
def continue_orbit(
    parameters: ParametersLike,
    word: WordLike,
    parameter: str,
    range: tuple[NumberLike, NumberLike],
    guess: PeriodicOrbit | ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    *,
    periods: int | None = None,
    max_points: int = 2000,
    progress: Progress = False,
) -> Branch:
    """Follow a periodic orbit as one parameter changes, both ways, until it ends or leaves the range.

    Parameters
    ----------
    parameters : Parameters, or a Scene, its name or its file
        Where the branch is begun; the parameter's value must lie in the range.
    word : str or sequence of str
        The mapping structure, read right to left.
    parameter : str
        "Omega", "A0", "FN", ...: any name of Parameters.
    range : (low, high)
    guess, periods : optional
        As for `find_orbit`.
    max_points : int
        Of each of the two directions, at least 2.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a function of two
        numbers: the part of the range that is done, and 1.

    Returns
    -------
    Branch

    Raises
    ------
    WordError, ConvergenceError
        As `find_orbit`.
    ParameterError
        If there is no such parameter, or the range is empty, not allowed or does not contain the parameter's value.
    BranchError
        If the first root is not an orbit.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> [end.kind for end in branch.ends]
    ['birth of a stick', 'end of the range']
    """
    read_word(word)
    low, high = read_range(parameters, parameter, range)
    orbit = find_orbit(parameters, word, guess, periods=periods)
    if not orbit.admissible:
        raise BranchError(orbit)
    curve = Curve(orbit, parameter, low, high)
    most = whole_number("max_points", max_points, 2)
    with late_bar(progress, f"{orbit.word} over {parameter}", "orbits") as advance:
        down, first = _follow(curve, -1.0, most, advance)
        up, last = _follow(curve, 1.0, most, advance, len(down))
    return Branch(orbit, parameter, [*reversed(down[1:]), *up], (first, last))


def _follow(
    curve: Curve, direction: float, most: int, advance: Advance, before: int = 0
) -> tuple[list[BranchPoint], BranchEnd]:
    """Follow the curve in one direction; return its points and why they end. `before`: points of the other one."""
    path, length = _first_points(curve, direction), FIRST_STEP
    current, reached = path[-1], 0.0
    done = curve.value - curve.low if before else 0.0  # the other way is done, wherever it ended

    def end(kind: str, message: str, conditions: tuple[Condition, ...] = ()) -> BranchEnd:
        return BranchEnd(kind, path[-1].value, message, _switchings(curve, path[-1]), conditions)

    while True:
        if current.value == (curve.high if direction > 0 else curve.low):
            return path, end(RANGE, "the orbit goes on")
        following = curve.step(current, length)
        scanned = None if following is None else _scan(curve, current, following)
        if scanned is None:
            length /= 2
            if length < SHORTEST_STEP:
                nearest = min(current.conditions, key=lambda condition: condition.value)
                if (belt := _begins_to_rest(curve.equations(current.value).parameters)) is not None:
                    message = (
                        f"the flights vanish at mu{belt} FN = |B0|; beyond it the mass may rest on belt {belt} for ever"
                    )
                    return path, end(FLIGHT_VANISHING, message, (nearest,))
                message = f"the steps became too short; nearest to failing: {nearest.text} (by {nearest.value:.3g})"
                return path, end(NO_CONVERGENCE, message, (nearest,))
            continue
        points, failed = scanned
        path += points
        reached = max(reached, abs(path[-1].value - curve.value))
        if advance:
            advance(min(1.0, (done + reached) / (curve.high - curve.low)), before + len(path))
        if len(path) > most:
            del path[most:]
            return path, end(MOST, f"stopped after {most} points")
        if failed is not None:
            return _with_end(curve, path, failed, direction)
        current, length = path[-1], min(1.5 * length, LONGEST_STEP)


def _begins_to_rest(p: Parameters) -> int | None:
    """Return the belt on which the mass nearly may rest for ever, or nearly may not; None if there is none."""
    slow = [belt for belt in (1, 2) if p.belt(belt) == 0]
    sizes = ((belt, (p.mu1, p.mu2)[belt - 1] * p.FN, abs(p.B0)) for belt in slow)
    return next((belt for belt, holds, drives in sizes if abs(holds - drives) < REST_PART * drives), None)


def _first_points(curve: Curve, direction: float) -> list[BranchPoint]:
    """Return the first point, and one just after it if the first is at an end, where margins are rounding noise."""
    # On the way between the two nothing is proven (as before an end, see NO_GAP).
    first = curve.first(direction)
    if all(condition.value > MARGINAL_START * condition.scale for condition in first.conditions):
        return [first]
    for length in AWAY:
        point = curve.step(first, length)
        if point is not None and not point.failures and not _verified(curve, point).failures:
            return [first, point]
    return [first]


def _scan(
    curve: Curve, a: BranchPoint, b: BranchPoint, around: float = np.inf
) -> tuple[list[BranchPoint], BranchPoint | None] | None:
    """Divide a piece of a branch after its point a; return its orbits, and the first point that is none, or None."""
    # None if the points do not lie on one smooth curve. `around` is the length of the shortest piece around it that is
    # known to end in a change.
    length, changed = curve.distance(a, b), bool(b.failures)
    around = min(around, length) if changed else around
    if changed and length < NO_GAP:
        return _located(curve, a, b)
    m = curve.middle(a, b)
    if m is None or not _smooth(curve, a, m, b):
        return None
    if not changed and not m.failures:
        if _proven(curve, a, m, b):
            b = _verified(curve, b)  # and so is m: between two orbits nothing has changed
            if not b.failures:
                return [m, b], None
        # Length of a piece on which a margin that cannot be bounded away from 0 is taken to touch it
        elif length < 1e-9:  # all is rounding noise here; next to a change it says nothing
            if around <= NEAR_CHANGE:
                return [m], None
            # A margin is so small that doubles cannot tell whether it passes 0.
            return [], replace(m, failures=(min(m.conditions, key=lambda c: c.value / c.scale),))
    first = _scan(curve, a, m, around)
    if first is None or first[1] is not None:
        return first
    second = _scan(curve, first[0][-1], b, around)
    return None if second is None else (first[0] + second[0], second[1])


def _smooth(curve: Curve, a: BranchPoint, m: BranchPoint, b: BranchPoint) -> bool:
    """Return whether the middle point lies on the cubic through the other two."""
    away = curve.level(curve.of(m) - curve.halfway(a, b))
    along = curve.level(m.tangent)
    away = away - (away @ along) * along
    return bool(np.linalg.norm(away) <= BENT * curve.distance(a, b) + RESOLUTION)


def _proven(curve: Curve, a: BranchPoint, m: BranchPoint, b: BranchPoint) -> bool:
    """Return whether no margin can reach 0 between a and b."""
    nodes, margins = [], []
    for point in (a, curve.halfway(a, m), m, curve.halfway(m, b), b):
        if isinstance(point, BranchPoint):
            nodes.append((curve.equations(point.value), point.points))
            margins.append(point.conditions)
        else:
            points, value = curve.split(point)
            nodes.append((curve.equations(value), points))
            margins.append(tuple(conditions(*nodes[-1])))
    return no_margin_vanishes(nodes, margins)


def _verified(curve: Curve, point: BranchPoint) -> BranchPoint:
    """Decide the failures of a branch point anew, with more digits and by following it with the engine."""
    return replace(point, failures=tuple(failures(curve.equations(point.value), point.points)))


def _located(curve: Curve, good: BranchPoint, bad: BranchPoint) -> tuple[list[BranchPoint], BranchPoint]:
    """Bisect for a change between two points; return the last point before it (none if given) and the first after."""
    begin = good
    while curve.distance(good, bad) > RESOLUTION:
        m = curve.middle(good, bad)
        if m is None:
            break
        good, bad = (good, m) if m.failures else (m, bad)
    return ([] if good is begin else [good]), bad


def _with_end(
    curve: Curve, path: list[BranchPoint], failed: BranchPoint, direction: float
) -> tuple[list[BranchPoint], BranchEnd]:
    """Describe the end of a branch by the conditions that vanish or fail there; return its path and BranchEnd."""
    far = [point for point in path if curve.distance(point, failed) > FAR_BEHIND]
    before = far[-1] if far else path[0]
    pairs = zip(before.conditions, failed.conditions, strict=True)
    touches = any(condition.value > 0 for condition in failed.failures)
    part = UNDECIDED_PART if touches else VANISHED_PART
    zero = [c for was, c in pairs if c.value < part * min(was.value, 1e300) or c.value < MARGINAL * c.scale]
    zero = sorted(zero, key=lambda condition: condition.rank) or list(failed.failures)
    kind = zero[0].event
    reasons = tuple(condition for condition in zero if condition.event == kind)
    message = "; ".join(f"{c.text} no longer holds at t = {c.t:.10g}" for c in reasons)
    path[-1] = last = _inside(curve, path[-1])
    outward = float(np.sign(failed.value - before.value)) or direction
    word, instead = word_beyond(curve, last, outward)
    message += f"; beyond it {instead}" if instead else ""
    return path, BranchEnd(kind, last.value, message, _switchings(curve, last), reasons, word)


def _inside(curve: Curve, last: BranchPoint) -> BranchPoint:
    """Return the last point of a branch that more digits confirm as an orbit: `last`, or one just before it."""
    for back in (0.0, *(RESOLUTION * 4.0**j for j in range(MOST_BACK))):
        z = curve.of(last) - back * last.tangent
        point = last if back == 0.0 else curve.accepted(curve.correct(z, last.tangent), last)
        if point is not None:
            equations = curve.equations(point.value)
            again = solve(equations, point.points)
            if again.converged and not failures(equations, again.points):
                return point
    return last


def _switchings(curve: Curve, point: BranchPoint) -> tuple[SwitchingPoint, ...]:
    """Return the switching points of a branch point as (t, x)."""
    Omega = point.value if curve.parameter == "Omega" else float(curve.orbit.parameters.Omega)
    return tuple(SwitchingPoint(float(theta / Omega), float(x)) for x, theta in point.points)


def read_range(parameters: Parameters, parameter: str, limits: Any) -> tuple[float, float]:
    """Return the limits of the parameter as numbers."""
    if not isinstance(parameter, str) or parameter not in PARAMETER_NAMES:
        known = f"must be one of {', '.join(PARAMETER_NAMES)}"
        raise ParameterError("parameter", parameter, known + meant(parameter, PARAMETER_NAMES))
    try:
        low, high = (None, None) if isinstance(limits, str) else limits
    except (TypeError, ValueError):
        low = None
    if low is None or high is None:
        raise ParameterError("range", limits, "must be a pair (low, high)")
    low, high = read_exact("range", low), read_exact("range", high)
    value = getattr(parameters, parameter)
    if not low < high or not low <= value <= high:
        allowed = f"must be low < high, with the value {parameter} = {show(value)} in between"
        raise ParameterError("range", f"{show(low)}:{show(high)}", allowed)
    for limit in (low, high):
        parameters.replace(**{parameter: limit})
    return float(low), float(high)
