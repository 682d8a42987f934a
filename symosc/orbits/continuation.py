"""Branches of periodic orbits: pseudo-arclength continuation, and why a branch ends.

The closing equations plus one for the arclength are solved by Newton's method from a point on the tangent. No general
package is used. These branches end at inequalities (a graze, the birth of a stick), which continuation codes for smooth
systems do not know. The smooth part is Newton's method on a small block system, which is there already.

The equations stay smooth where an orbit ceases to be one (the root goes on as an inadmissible one). So every reason to
end is a change of sign of a smooth function along the branch. A step is accepted if the point halfway is where the
cubic of its two ends says, and if no margin can reach 0 between them (`symosc.orbits.between`). Otherwise it is halved.
So a gap in a branch is found however narrow it is compared with the steps, and its end is located by the same halving.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import DataFrame, NumberLike, Progress
from symosc.arguments import public
from symosc.display.progress import Advance, late_bar
from symosc.errors import ParameterError, meant
from symosc.exact import read_exact, show, whole_number
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.admissibility import conditions
from symosc.orbits.behind import look_behind
from symosc.orbits.between import clear
from symosc.orbits.branch import Branch, BranchEnd, BranchError, BranchPoint, times_of
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.curve import Curve
from symosc.orbits.find import find_orbit
from symosc.orbits.newton import solve
from symosc.orbits.periodic_orbit import PeriodicOrbit, SwitchingPoint
from symosc.orbits.verification import MARGINAL, failures
from symosc.words import WordLike, read_word

FOLD, PERIOD_DOUBLING, NEIMARK_SACKER = "fold", "period doubling", "Neimark-Sacker"
MULTIPLIER_MESSAGES = {
    FOLD: "a multiplier is +1",
    PERIOD_DOUBLING: "a multiplier is -1",
    NEIMARK_SACKER: "two complex multipliers have the modulus 1",
}
RANGE, NO_CONVERGENCE, MOST = "end of the range", "no convergence", "max_points"

# Steps in the arclength of (x/size, phase, parameter/range).
FIRST_STEP, LONGEST_STEP, SHORTEST_STEP = 0.02, 0.04, 1e-10
BENT = 1e-2  # how far a step may be from its cubic, as a part of its length
VANISHED = 1e-5  # what a margin must have fallen to at an end, as a part of what it was a step before, to count as 0
TOUCHED = 1e-3  # the same where doubles do not tell on which side of 0 a margin is
RESOLUTION = 1e-12  # of the arclength, to which ends are located; closer by, rounding would decide what has happened
# So near to a change, a gap before it that is shorter cannot be seen, and nothing is proven on the way.
NO_GAP, NEAR_CHANGE = 1e-7, 1e-4
MARGINAL_START, AWAY = 1e-6, (1e-6, 1e-5, 1e-4)  # below which a start is at an end, and how far from it to begin
FAR_BEHIND = 1e-3  # arclength before an end at which margins are what they are compared with there
MOST_BACK = 12  # an end is moved back by at most RESOLUTION 4^MOST_BACK
TOUCH_LENGTH = 1e-9  # length of a piece on which a margin that cannot be bounded away from 0 is taken to touch it


@public
def continue_orbit(
    parameters: Parameters,
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
    parameters : Parameters
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
    curve = _curve(parameters, word, parameter, range, guess, periods)
    most = whole_number("max_points", max_points, 2)
    with late_bar(progress, f"{curve.orbit.word} over {parameter}", "orbits") as advance:
        down, first = _follow(curve, -1.0, most, _covered(curve, advance, 0))
        up, last = _follow(curve, 1.0, most, _covered(curve, advance, len(down)))
    return Branch(curve.orbit, parameter, [*reversed(down[1:]), *up], (first, last))


def _curve(parameters: Parameters, word: Any, parameter: str, range: Any, guess: Any, periods: int | None) -> Curve:
    """Return the curve that is followed, with the orbit that it begins with."""
    read_word(word)
    low, high = _read_range(parameters, parameter, range)
    orbit = find_orbit(parameters, word, guess, periods=periods)
    if not orbit.admissible:
        raise BranchError(orbit)
    return Curve(orbit, parameter, low, high)


def _covered(curve: Curve, advance: Advance, before: int) -> Callable[[float, int], None]:
    """Return what tells that the curve was followed up to a value, in so many points after those of the other way."""
    begin, reached = float(getattr(curve.orbit.parameters, curve.parameter)), [0.0]
    low = 0.0 if before == 0 else begin - curve.low  # the other way is done, wherever it ended

    def tell(value: float, count: int) -> None:
        reached[0] = max(reached[0], abs(value - begin))
        if advance:
            advance(min(1.0, (low + reached[0]) / (curve.high - curve.low)), before + count)

    return tell


def _follow(
    curve: Curve, direction: float, most: int, tell: Callable[[float, int], None]
) -> tuple[list[BranchPoint], BranchEnd]:
    """Follow the curve one way; return its points and why they end."""
    path, length = _begun(curve, direction), FIRST_STEP
    current = path[-1]
    while True:
        if current.value == (curve.high if direction > 0 else curve.low):
            return path, BranchEnd(RANGE, current.value, "the orbit goes on", _named(curve, current), ())
        following = curve.step(current, length)
        scanned = None if following is None else _scan(curve, current, following)
        if scanned is None:
            length /= 2
            if length < SHORTEST_STEP:
                return path, _stalled(curve, current)
            continue
        path += scanned.points
        tell(path[-1].value, len(path))
        if len(path) > most:
            path = path[:most]
            return path, BranchEnd(MOST, path[-1].value, f"stopped after {most} points", _named(curve, path[-1]), ())
        if scanned.failed is not None:
            return _ended(curve, path, scanned.failed, direction)
        current, length = path[-1], min(1.5 * length, LONGEST_STEP)


def _begun(curve: Curve, direction: float) -> list[BranchPoint]:
    """Return the first point, and one a little further on if the first is at an end, where margins are rounding noise.

    On the way between the two nothing is proven (as before an end, see NO_GAP).
    """
    first = curve.first(direction)
    if all(condition.value > MARGINAL_START * condition.scale for condition in first.conditions):
        return [first]
    for length in AWAY:
        point = curve.step(first, length)
        if point is not None and not _changes(curve, first, point) and not _verified(curve, point).failures:
            return [first, point]
    return [first]


class Scanned(NamedTuple):
    """The points of a step that are orbits, in order, and the first one after them that is not (None: all are)."""

    points: list[BranchPoint]
    failed: BranchPoint | None


def _scan(curve: Curve, a: BranchPoint, b: BranchPoint, around: float = np.inf) -> Scanned | None:
    """Look at a piece of the branch from its point a on; None if its points do not lie on one smooth curve.

    `around` is the length of the shortest piece around it that is known to end in a change.
    """
    length, changed = curve.distance(a, b), bool(_changes(curve, a, b))
    around = min(around, length) if changed else around
    if changed and length < NO_GAP:
        return Scanned(*_located(curve, a, b))
    m = curve.middle(a, b)
    if m is None or not _smooth(curve, a, m, b):
        return None
    if not changed and not _changes(curve, a, m):
        if _proven(curve, a, m, b):
            b = _verified(curve, b)  # and so is m: between two orbits nothing has changed
            if not b.failures:
                return Scanned([m, b], None)
        elif length < TOUCH_LENGTH:  # all is rounding noise here; next to a change it says nothing
            return Scanned([], _touching(m)) if around > NEAR_CHANGE else Scanned([m], None)
    first = _scan(curve, a, m, around)
    if first is None or first.failed is not None:
        return first
    second = _scan(curve, first.points[-1], b, around)
    return None if second is None else Scanned(first.points + second.points, second.failed)


def _smooth(curve: Curve, a: BranchPoint, m: BranchPoint, b: BranchPoint) -> bool:
    """Return whether the point in the middle is on the cubic of the other two, wherever along it."""
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
    return clear(nodes, margins)


def _verified(curve: Curve, point: BranchPoint) -> BranchPoint:
    """Return the point with what the engine objects to."""
    return replace(point, failures=tuple(failures(curve.equations(point.value), point.points)))


def _touching(point: BranchPoint) -> BranchPoint:
    """Return a point as failing where a margin is so small that doubles cannot tell whether it passes 0."""
    nearest = min(point.conditions, key=lambda condition: condition.value / condition.scale)
    return replace(point, failures=(nearest,))


def _located(curve: Curve, good: BranchPoint, bad: BranchPoint) -> tuple[list[BranchPoint], BranchPoint]:
    """Return the last point before a change, if it is not the given one, and the first one after it, by halving."""
    begin = good
    while curve.distance(good, bad) > RESOLUTION:
        m = curve.middle(good, bad)
        if m is None:
            break
        good, bad = (good, m) if _changes(curve, good, m) else (m, bad)
    return ([] if good is begin else [good]), bad


def _changes(curve: Curve | None, a: BranchPoint, b: BranchPoint) -> list[str]:
    """Return what happens between a point and one after it, what explains the rest first; empty if nothing does.

    Multipliers leave the unit circle only without damping (`symosc.orbits.floquet`).
    """
    found = [condition.event for condition in b.failures]
    if curve is not None and curve.equations(b.value).parameters.c > 0:
        return found
    plus, minus, one = zip(_multiplier_tests(a), _multiplier_tests(b), strict=True)
    if (a.tangent[-1] > 0) != (b.tangent[-1] > 0) or (plus[0] > 0) != (plus[1] > 0):
        found.append(FOLD)
    if (minus[0] > 0) != (minus[1] > 0):
        found.append(PERIOD_DOUBLING)
    if (one[0] > 0) != (one[1] > 0) and abs(b.trace) < 2:
        found.append(NEIMARK_SACKER)
    return found


def _multiplier_tests(point: BranchPoint) -> tuple[float, float, float]:
    """Return what vanishes where a multiplier is +1, where one is -1, and where their product is 1."""
    trace, determinant = point.trace, point.determinant
    return 1 - trace + determinant, 1 + trace + determinant, 1 - determinant


def _ended(
    curve: Curve, path: list[BranchPoint], failed: BranchPoint, direction: float
) -> tuple[list[BranchPoint], BranchEnd]:
    """Return the points and why they end: what fails after the last one, and what is practically 0 there."""
    far = [point for point in path if curve.distance(point, failed) > FAR_BEHIND]
    before = far[-1] if far else path[0]
    pairs = zip(before.conditions, failed.conditions, strict=True)
    touches = any(condition.value > 0 for condition in failed.failures)
    part = TOUCHED if touches else VANISHED
    zero = [c for was, c in pairs if c.value < part * min(was.value, 1e300) or c.value < MARGINAL * c.scale]
    zero = sorted(zero, key=lambda condition: condition.rank) or list(failed.failures)
    kind = zero[0].event if failed.failures else _changes(curve, path[-1], failed)[0]
    reasons = tuple(condition for condition in zero if condition.event == kind)
    message = MULTIPLIER_MESSAGES.get(kind, "")
    if kind not in MULTIPLIER_MESSAGES:
        message = "; ".join(f"{c.text} no longer holds at t = {c.t:.10g}" for c in reasons)
    path[-1] = last = _inside(curve, path[-1])
    outward = float(np.sign(failed.value - before.value)) or direction
    word, instead = look_behind(curve, last, outward)
    message += f"; beyond it {instead}" if instead else ""
    return path, BranchEnd(kind, last.value, message, _named(curve, last), reasons, word)


def _inside(curve: Curve, last: BranchPoint) -> BranchPoint:
    """Return the last point that is an orbit with all digits, a few roundings before one that is in doubles."""
    for back in (0.0, *(RESOLUTION * 4.0**j for j in range(MOST_BACK))):
        z = curve.of(last) - back * last.tangent
        point = last if back == 0.0 else curve.accepted(curve.correct(z, last.tangent), last)
        if point is not None and _is_found(curve.equations(point.value), point):
            return point
    return last


def _is_found(equations: ClosingEquations, point: BranchPoint) -> bool:
    """Return whether Newton's method finds a point again, and it is an orbit."""
    again = solve(equations, point.points)
    return again.converged and not failures(equations, again.points)


def _stalled(curve: Curve, point: BranchPoint) -> BranchEnd:
    nearest = min(point.conditions, key=lambda condition: condition.value)
    message = f"the steps became too short; nearest to failing: {nearest.text} (by {nearest.value:.3g})"
    return BranchEnd(NO_CONVERGENCE, point.value, message, _named(curve, point), (nearest,))


def _named(curve: Curve, point: BranchPoint) -> tuple[SwitchingPoint, ...]:
    times = times_of(curve.orbit.parameters, curve.parameter, point)
    return tuple(SwitchingPoint(float(t), float(x)) for t, x in times)


def _read_range(parameters: Parameters, parameter: str, limits: Any) -> tuple[float, float]:
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
