"""That nothing fails between two points of a branch: every margin is bounded there, not only compared at its ends.

A flight of duration tau stays in its domain exactly if tau > 0 and, for each boundary of the domain,

    q(u) = +-(v - v_lambda)/(time^j (1 - u)^e) > 0 on the whole of [0, 1].

Here time counts from its start, and u = time/tau. The known roots at its start are j (0 off the boundary, 1 on it, 2
after a stick), those at its end e. A stick has F/((1 - u) tau) for the force that ends it, and for the other force its
distance from 0. These functions are smooth in u and along the branch, ends included: q(0) and q(1) are accelerations.
All other conditions are smooth numbers.

Three points of the branch and two on its cubic between them cut a piece of it into four. Take a cell with the margins
f0, f1 > 0 at its ends, and C = h^2 max|f''|/2. At the part r of the cell the margin is at least (1 - r) f0 + r f1 - C r
(1 - r). That is positive for all r in [0, 1] if and only if

    sqrt(f0) + sqrt(f1) > sqrt(C).

h^2 f'' is taken from the second differences of the five values, times MARGIN_SAFETY. The bound holds as long as a
margin's second derivative is nowhere larger than MARGIN_SAFETY times its largest value at the inner points (for the
functions of u, also at the neighbouring u). Where it does not suffice the piece is halved. It is a bound in this sense,
not in the sense of interval arithmetic.
"""

from __future__ import annotations

import numpy as np

from symosc.aliases import Point, Points
from symosc.engine.flow import derivatives
from symosc.kernels._generated import motion
from symosc.kernels.entire_array import basis
from symosc.orbits.admissibility import SAMPLE, Condition
from symosc.orbits.closing_equations import ClosingEquations, OrbitPiece

MARGIN_SAFETY = 4.0
LEAST_PARTS, MOST_PARTS, REFINED = 12, 800, 8
DEEPEST = 30
Node = tuple[ClosingEquations, np.ndarray]


def clear(nodes: list[Node], margins: list[tuple[Condition, ...]]) -> bool:
    """Return whether no margin reaches 0 between the first and the last of five points of a branch.

    Parameters
    ----------
    nodes : list of (equations, points)
        At equal distances.
    margins : list of tuple of Condition
        Of each of them.
    """
    rows = [[c.value for c in row if not of_function(c)] for row in margins]
    if not _cells(np.array(rows)).all():
        return False
    equations, points = nodes[2]
    for i, duration in enumerate(equations.durations(points)):
        parts = duration / equations.K.Om * equations.K.rate / SAMPLE
        u = np.linspace(0.0, 1.0, 1 + int(min(MOST_PARTS, max(LEAST_PARTS, parts))))
        if not _clear_over(nodes, i, u, DEEPEST):
            return False
    return True


def of_function(condition: Condition) -> bool:
    """Return whether a condition is about the whole of a piece, not about its end or duration."""
    return " stays in " in condition.text or " during " in condition.text


def _cells(values: np.ndarray, deficit: float | np.ndarray = 0.0) -> np.ndarray:
    """Return for each column of (5, n) values whether it is proven positive between the rows."""
    bend = np.abs(np.diff(values, 2, axis=0)).max(axis=0)
    if bend.size > 2:
        bend[1:-1] = np.maximum(bend[1:-1], np.maximum(bend[:-2], bend[2:]))
    least = values - deficit
    roots = np.sqrt(np.maximum(least, 0.0))
    return (least > 0).all(axis=0) & (roots[:-1] + roots[1:] > np.sqrt(0.5 * MARGIN_SAFETY * bend)).all(axis=0)


def _clear_over(nodes: list[Node], i: int, u: np.ndarray, depth: int) -> bool:
    """Return whether the functions of piece i are positive for the parts u of its duration and all in between."""
    found = [functions(equations, points, i, u) for equations, points in nodes]
    for rows in zip(*found, strict=True):
        values = np.array(rows)
        bend = np.abs(np.diff(values, 2, axis=1)).max(axis=0)
        bend = np.concatenate([bend[:1], bend, bend[-1:]])
        bend[1:-1] = np.maximum(bend[1:-1], np.maximum(bend[:-2], bend[2:]))
        good = _cells(values, MARGIN_SAFETY / 8 * bend)
        if good.all():
            continue
        if depth == 0 or not _cells(values)[~good].all():
            return False
        for first, last in _runs(~good):
            low, high = u[max(first - 1, 0)], u[min(last + 1, len(u) - 1)]
            finer = np.linspace(low, high, 1 + REFINED * (last - first + 2))
            if finer[1] <= finer[0] or len(finer) > MOST_PARTS or not _clear_over(nodes, i, finer, depth - 1):
                return False
    return True


def _runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last index of every stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def functions(equations: ClosingEquations, points: Points, i: int, u: np.ndarray) -> list[np.ndarray]:
    """Return the functions of piece i that have to be positive, at parts u of its duration."""
    piece, start, end = equations.pieces[i], points[i], equations.ends(points)[i]
    tau = (end[1] - start[1]) / equations.K.Om
    return (_of_stick if piece.sticks else _of_flight)(equations, piece, start, end, tau, u)


def _of_flight(
    equations: ClosingEquations, piece: OrbitPiece, start: Point, end: Point, tau: float, u: np.ndarray
) -> list[np.ndarray]:
    K, times = equations.K, tau * u
    v, a, s, c = equations.start_of_flight(piece, start)
    _, dv, acceleration = motion(v, a, s, c, K.cm, K.w0sq, K.f0, K.Om, *basis(times, K)[:5])
    b = derivatives(v, a, s, c, K)[0]
    found = []
    for boundary, sign in ((piece.mode - 1, 1.0), (piece.mode, -1.0)):
        if boundary not in (1, 2):
            continue
        roots = 0 if boundary != piece.start else 2 if piece.after_stick else 1
        gap = sign * ((v - equations.belt(boundary).v) + dv)
        inner = u > 0 if roots else np.ones(len(u), dtype=bool)
        q = np.empty(len(u))
        q[inner] = gap[inner] / times[inner] ** roots
        q[~inner] = sign * (0.5 * b if roots == 2 else a)
        if boundary == piece.end:
            ends = u == 1
            q[~ends] /= 1 - u[~ends]
            q[ends] = -sign * acceleration[ends] * tau ** (1 - roots)
        found.append(q)
    return found


def _of_stick(
    equations: ClosingEquations, piece: OrbitPiece, start: Point, end: Point, tau: float, u: np.ndarray
) -> list[np.ndarray]:
    K, belt = equations.K, equations.belt(piece.start)
    before = -(1 - u) * tau  # time, counted from the end of the stick, where the force that ends it is 0
    half = 0.5 * K.Om * before
    force = -piece.side * (belt.drift * before - 2 * K.f0 * np.sin(end[1] + half) * np.sin(half))
    slope = piece.side * (belt.drift - K.fB * equations.sin(end[1]))
    ratio = np.where(u == 1, slope, force / np.where(u == 1, 1.0, -before))
    return [ratio, belt.J - force]
