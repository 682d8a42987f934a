"""Whether a root of the closing equations is an orbit: its inequalities, decided, and the engine's own verdict.

Three things are asked, in this order.

1. Do all inequalities hold (`symosc.orbits.admissibility`)? Where a margin is too small for doubles the root is refined
to FINE_DIGITS digits first. If a margin is 0 there, it is not an orbit: a piece has no length, or a belt is only
touched.
2. Does the motion from a switching point of the root do what the word says? It is simulated over the whole period by
   the engine, always: no margin is too small or too large for that. (In real arithmetic its first exits are proven to
   be the first; what rounding may do was measured. See `symosc.engine.first_exit`.)
3. Does it close? Every event has to be where and when the root says, the last one a period after the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, pi

import numpy as np

from symosc.aliases import Number, Points
from symosc.kernels.entire import EPS
from symosc.model import MODE_NAMES, NEIGHBOURS
from symosc.orbits.admissibility import (
    ENGINE,
    FLIGHT_LASTS,
    GRAZING,
    SLIP_BIRTH,
    STICK_LASTS,
    Condition,
    conditions,
    failing,
    scales,
)
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.newton import Solution, polish
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

# A margin below this part of the terms that it is a difference of is decided in more digits ...
MARGINAL = 1e-9
SUSPECT = 1e-6  # ... may be what fails where the root is too ill-conditioned to tell if it is below this part
FINE_DIGITS = 50
# ... and is 0 if it is below this part of them even there.
NOTHING_LEFT = 1e-25
# Digits that the engine is asked for where the margins are small.
ENGINE_DIGITS = (30, 60)
# How far the engine's events may be from the orbit's, as a part of a period and of the size of the positions. A start
# that is rounded to doubles moves an arrival with a margin of MARGINAL by 1e-7.
SAME_POINT = 1e-6
VANISHING_PART = 1e-2  # a duration that Newton's method in more digits reduces to this part of itself goes to 0
SAME_EXACTLY = 1e-12


def failures(equations: ClosingEquations, points: Points) -> list[Condition]:
    """Return what keeps a root from being an orbit, the condition that explains the others first; empty for an orbit.

    Parameters
    ----------
    equations : ClosingEquations
        In double precision.
    points : (n, 2) array of (x, theta)
    """
    found = conditions(equations, points)
    small = any(abs(condition.value) < MARGINAL * condition.scale for condition in found)
    if not small and not ill_conditioned(equations, points):
        failed = failing(found)
        if failed:
            return failed
        if agrees(equations, points, None):
            return []
    fine, root = refined(equations, points)
    if not root.converged:
        gone = _vanishing(equations, points, found, fine, root)
        if gone or small or failing(found):
            return gone or _undecided(found)
        return [] if agrees(equations, points, None) else _undecided(found) or [_contradiction(equations, points)]
    failed = failing([_cleaned(condition) for condition in conditions(fine, root.points)])
    if failed:
        return failed
    if any(agrees(fine, root.points, digits) for digits in ENGINE_DIGITS):
        return []
    return [_contradiction(equations, points)]


def ill_conditioned(equations: ClosingEquations, points: Points) -> bool:
    """Return whether rounding errors of the residuals move the phases of the root by more than MARGINAL."""
    sizes, rows = scales(equations, points), []
    x_size = max(abs(float(x)) for x, _ in points)
    for piece, duration in zip(equations.pieces, equations.durations(np.asarray(points)), strict=True):
        rows += [x_size, sizes.a if piece.sticks else sizes.v]
        if piece.zeros:
            rows[-1] *= (abs(duration) / equations.K.Om) ** -piece.zeros * min(1.0, abs(duration))
    try:
        inverse = np.linalg.inv(equations.matrix(points))
    except np.linalg.LinAlgError:
        return True
    return bool((np.abs(inverse[1::2]) @ np.array(rows)).max() * EPS > MARGINAL)


def _cleaned(condition: Condition) -> Condition:
    """Return the condition with the value 0 where it is 0 to FINE_DIGITS digits."""
    return condition._replace(value=0.0) if abs(condition.value) < NOTHING_LEFT * condition.scale else condition


def refined(equations: ClosingEquations, points: Points) -> tuple[ClosingEquations, Solution]:
    """Return equations and root in FINE_DIGITS digits; `converged` says whether Newton's method finds it."""
    fine = equations.with_digits(FINE_DIGITS)
    try:
        return fine, polish(fine, points)
    except (ZeroDivisionError, ValueError):  # a flight lost all its length on the way
        return fine, Solution(points, inf, 0, False, "a piece has no length")


def _vanishing(
    equations: ClosingEquations, points: Points, found: list[Condition], fine: ClosingEquations, root: Solution
) -> list[Condition]:
    """Return that a piece has no length where its duration goes to 0 under Newton's method: a multiple root."""
    was, now = (
        [end[1] - start[1] for start, end in zip(each, of.ends(each), strict=True)]
        for of, each in ((equations, points), (fine, root.points))
    )
    gone = {i for i in range(len(was)) if abs(now[i]) < VANISHING_PART * abs(was[i])}
    lasts = [c for c in found if c.piece in gone and c.rank in (STICK_LASTS, FLIGHT_LASTS)]
    return [c._replace(value=0.0) for c in lasts]


def _undecided(found: list[Condition]) -> list[Condition]:
    """Return the conditions that fail or may fail, for a root that is not found with more digits."""
    failed = failing(found)
    if failed:
        return failed
    nearest = [c for c in found if abs(c.value) < SUSPECT * c.scale]
    text = " (it cannot be decided: the equations are singular there)"
    return [c._replace(text=c.text + text, value=0.0) for c in sorted(nearest, key=lambda c: c.rank)]


def agrees(equations: ClosingEquations, points: Points, digits: int | None) -> bool:
    """Return whether the engine, started on the root, follows the word and comes back after the period."""
    i = _start(equations, points)
    events = _simulated(equations, points, i, digits)
    due = _expected(equations, points, i)
    if len(events) < len(due):
        return False
    allowed, K = (SAME_POINT if digits is None else SAME_EXACTLY), equations.K
    size = max(abs(float(x)) for x, _ in points) + float(K.period) * max(abs(float(K.belt1.v)), abs(float(K.belt2.v)))
    for event, (boundary, mode, x, t) in zip(events, due, strict=False):
        if (event.boundary, event.target) != (boundary, MODE_NAMES[mode]) or event.kind == "graze":
            return False
        if abs(event.t - t) > allowed * K.period or abs(event.x - x) > allowed * max(size, 1e-300):
            return False
    return True


def _start(equations: ClosingEquations, points: Points) -> int:
    """Return the switching point at the end of a flight where the forces above and below the belt are clearest."""
    best, start = -inf, 0
    for i, piece in enumerate(equations.pieces):
        if equations.pieces[i - 1].sticks:
            continue
        (x, theta), v = points[i], equations.belt(piece.start).v
        clearest = min(abs(float(equations.force(domain, x, v, theta))) for domain in NEIGHBOURS[piece.start])
        if clearest > best:
            best, start = clearest, i
    return start


def _simulated(equations: ClosingEquations, points: Points, i: int, digits: int | None) -> Sequence[Event]:
    """Return the events of a little more than one period from switching point i."""
    p, (x, theta) = equations.parameters, points[i]
    number = equations.exact or float
    t = number(theta) / equations.K.Om
    end = t + equations.turn / equations.K.Om * (1 + (SAME_POINT if digits is None else SAME_EXACTLY))
    most = len(equations.pieces) + 1
    v = p.belt(equations.pieces[i].start)
    return simulate(p, t0=t, x0=number(x), v0=v, t_end=end, max_events=most, digits=digits).events


def _expected(equations: ClosingEquations, points: Points, i: int) -> list[tuple[int, int, Number, Number]]:
    """Return boundary, mode after it, x and t of every switching after point i, up to its own a period later."""
    n, pieces, number = len(equations.pieces), equations.pieces, equations.exact or float
    due = []
    for j in range(i + 1, i + n + 1):
        x, theta = points[j % n]
        phase = number(theta) + (equations.turn if j >= n else 0)
        due.append((pieces[j % n].start, pieces[j % n].mode, number(x), phase / equations.K.Om))
    return due


def _contradiction(equations: ClosingEquations, points: Points) -> Condition:
    """Return which piece the engine, started on the root, does not follow."""
    i, n = _start(equations, points), len(points)
    events, due = _simulated(equations, points, i, None), _expected(equations, points, i)
    K = equations.K
    for j, (boundary, mode, _, t) in enumerate(due):
        piece = equations.pieces[(i + j) % n]
        event = events[j] if j < len(events) else None
        late = inf if event is None else abs(event.t - t)
        if (
            event is None
            or (event.boundary, event.target) != (boundary, MODE_NAMES[mode])
            or late > SAME_POINT * K.period
        ):
            break
    when = t if event is None else event.t
    kind = SLIP_BIRTH if piece.sticks else GRAZING
    value = -min(late, float(equations.turn / K.Om))
    return Condition((i + j) % n, f"{piece.label} ends where it first can", value, float(when), kind, ENGINE, 2 * pi)
