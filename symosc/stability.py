"""Stability of a periodic orbit: its monodromy matrix from the exact derivative of every piece.

Perturbations (dx, dv) at a fixed time obey the unforced equation in every domain, so that a flight of duration tau
multiplies them by

    [[1 - (k/m) E2, E1], [-(k/m) E1, E0]],     of determinant exp(-(c/m) tau).

A crossing leaves dx and multiplies dv by F^(target)/F^(source), the saltation of a velocity whose slope changes. At
the onset of a stick dv becomes 0: the rank drops and one multiplier is 0. While the mass sticks dx stays; where the
stick ends the force vanishes on the side that it leaves to, so nothing is added there.

Why no smooth bifurcation is met
--------------------------------
Friction never grows with the velocity (A_1 >= A_2 >= A_3), so the difference y of two motions of one system obeys

    d/dt (m y'^2/2 + k y^2/2) <= -c y'^2.

With c > 0 and k > 0 all motions approach each other: there is one periodic motion, it has the period of the excitation,
and both multipliers lie inside the unit circle. Folds, period doublings, Neimark-Sacker bifurcations and subharmonics
need c = 0; a branch of orbits of one word ends at a graze, or where a stick or a slip is born or vanishes. For the same
reason F^(target)/F^(source) is in [0, 1], and det M = exp(-(c/m) T) times those ratios is at most 1.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from symosc.closing import ClosingEquations
from symosc.kernels._generated import motion


class Monodromy(NamedTuple):
    """What one period makes of a perturbation of (x, v) just after the first switching point.

    Attributes
    ----------
    matrix : ((xx, xv), (vx, vv))
    trace, determinant : number
        The determinant comes from its factors, not from the matrix: it keeps its digits however small it is.
    """

    matrix: Any
    trace: Any
    determinant: Any


def monodromy(equations: ClosingEquations, points: Any) -> Monodromy:
    """Return the monodromy matrix of the orbit through `points` (x, theta), in the arithmetic of `equations`."""
    K, pieces = equations.K, equations.pieces
    xx, xv, vx, vv = 1, 0, 0, 1
    determinant = 1
    for i, (piece, start, end) in enumerate(zip(pieces, points, equations.ends(points), strict=True)):
        if piece.sticks:
            continue
        tau = (end[1] - start[1]) / K.Om
        basis = E0, E1, E2, _, _ = equations.basis(tau, K)[:5]
        _, _, a = motion(*equations.start_of_flight(piece, start), K.cm, K.w0sq, K.f0, K.Om, *basis)
        C, D = 1 - K.w0sq * E2, -K.w0sq * E1
        following = pieces[(i + 1) % len(pieces)]
        ratio = 0
        if not following.sticks:
            ratio = equations.force(following.mode, end[0], equations.belt(piece.end).v, end[1]) / a
        xx, xv, vx, vv = C * xx + E1 * vx, C * xv + E1 * vv, ratio * (D * xx + E0 * vx), ratio * (D * xv + E0 * vv)
        determinant = determinant * ratio
    determinant = determinant * equations.exp(-K.cm * equations.turn / K.Om)
    return Monodromy(((xx, xv), (vx, vv)), xx + vv, determinant)


def multipliers(trace: Any, determinant: Any, root: Any) -> tuple[Any, Any]:
    """Return the eigenvalues, the larger one first, from trace and determinant; `root` is a complex square root."""
    half = trace / 2
    square = half * half - determinant
    if square < 0:
        return half + root(square), half - root(square)
    large = half + (root(square) if half >= 0 else -root(square))
    return large, determinant / large if large != 0 else 0 * large
