"""Stability of a periodic orbit: its monodromy matrix from the exact derivative of every piece.

Perturbations (dx, dv) at a fixed time obey the unforced equation in every domain, so that a flight
of duration tau multiplies them by

    [[1 - (k/m) E2, E1], [-(k/m) E1, E0]],     of determinant exp(-(c/m) tau).

A crossing leaves dx and multiplies dv by F^(target)/F^(source), the saltation of a velocity whose
slope changes. At the onset of a stick dv becomes 0: the rank drops and one multiplier is 0. While
the mass sticks dx stays; where the stick ends the force vanishes on the side that it leaves to, so
nothing is added there.

What holds about uniqueness
---------------------------
Friction never grows with the velocity (A_1 >= A_2 >= A_3), so the difference y of two motions of
one system obeys

    E = m y'^2/2 + k y^2/2,   dE/dt <= -c y'^2 <= 0.

No difference grows. For c > 0 and k > 0 motions are bounded, so by Brouwer's theorem a periodic one
exists, with the period of the excitation. If E stays constant along two motions, y' = 0 and y = d
for all times. If d is not 0, the equations of the two differ by k d. So both have set-valued
friction at all times: both stick to the same belt for ever. They are bounded, so that belt is at
rest. Hence, for c > 0 and k > 0:

- An orbit with a flight of positive length is the only periodic motion, attracts all others, and
  both its multipliers lie inside the unit circle. All words have flights. So every admissible orbit
  with c > 0 is stable, and no other word has one at these parameters. Folds, period doublings,
  Neimark-Sacker bifurcations and subharmonics do not occur. A branch of orbits ends at a graze, or
  where a stick, a slip or a flight is born or vanishes.
- The exception is a belt at rest, v_lambda = 0, with mu_lambda FN >= |B0|. The mass may rest on it
  for ever, at every x of an interval of length 2 (mu_lambda FN - |B0|)/k (`rest_positions`). These
  motions are periodic, attract the others only as a set, and have the multiplier 1. They have no
  flight, so no word.

For c = 0 the argument gives |multiplier| <= 1 only. One of exactly 1 in size is possible: the orbit
is marginal, neither stable nor unstable. F^(target)/F^(source) is in [0, 1] on every orbit, so det
M = exp(-(c/m) T) times those ratios is at most 1.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from symosc.base.aliases import Number, Points
from symosc.friction import NEIGHBOURS
from symosc.kernels._generated import motion
from symosc.model import Parameters
from symosc.orbits.closing_equations import ClosingEquations, polish

# A multiplier this near to the unit circle is computed again with so many digits; it is on it if it
# is then still nearer than ON_CIRCLE.
NEAR_ONE = 1e-9
FINE_DIGITS = 50
ON_CIRCLE = 1e-25


def multipliers_of(equations: ClosingEquations, points: Points) -> tuple[Number, Number]:
    """Return the multipliers of the orbit through `points` (x, theta), in the arithmetic of
    `equations`.
    """
    # The matrix, with the rows (xx, xv) and (vx, vv), maps perturbations (dx, dv) just after the
    # first switching point to those just after the present one. A stick makes dv 0.
    K = equations.K
    pieces = equations.pieces
    determinant = 1
    xx = 1
    xv = 0
    vx = 0
    vv = 1
    for i, (piece, start, end, tau) in enumerate(equations.spans(points)):
        if piece.sticks:
            continue
        basis = equations.basis(tau, K)[:5]
        E0, E1, E2, _, _ = basis
        _, _, a = motion(*equations.start_of_flight(piece, start), K.cm, K.w0sq, K.f0, K.Om, *basis)
        # The flow of the flight has the rows (C, E1) and (D, E0); at its end dv jumps by the ratio
        # of the accelerations behind and before the belt.
        C = 1 - K.w0sq * E2
        D = -K.w0sq * E1
        following = pieces[(i + 1) % len(pieces)]
        ratio = 0  # a stick
        if not following.sticks:
            x, theta = end
            ratio = equations.force(following.mode, x, equations.belt(piece.end).v, theta) / a
        next_xx = C * xx + E1 * vx
        next_xv = C * xv + E1 * vv
        vx = ratio * (D * xx + E0 * vx)
        vv = ratio * (D * xv + E0 * vv)
        xx = next_xx
        xv = next_xv
        determinant = determinant * ratio
    # The flow of all flights, by Liouville's theorem. An orbit with a stick has the determinant 0.
    determinant = determinant * equations.exp(-K.cm * equations.turn / K.Om)
    context = equations.context

    def root(value: Number) -> Any:
        """Return a complex square root, in the arithmetic of the equations."""
        if context is None:
            return cmath.sqrt(value)
        return context.mpc(context.sqrt(value))

    return multipliers(xx + vv, determinant, root)


def multipliers(
    trace: Number, determinant: Number, root: Callable[[Number], Any]
) -> tuple[Number, Number]:
    """Return the eigenvalues of a 2x2 matrix, the larger one first.

    `root` is a function for complex square roots.
    """
    half = trace / 2
    square = half * half - determinant
    if square < 0:
        return half + root(square), half - root(square)
    # The larger one has no cancellation; the product of both is the determinant.
    large = half + (root(square) if half >= 0 else -root(square))
    small = determinant / large if large != 0 else 0 * large
    return large, small


def stability_margin(
    equations: ClosingEquations, points: Points, values: tuple[Number, Number]
) -> float | None:
    """Return 1 - max |value|, > 0 if the orbit with the multipliers `values` is stable; None if
    it is marginal (less than ON_CIRCLE).
    """
    gap = float(1 - max(abs(value) for value in values))
    if abs(gap) > NEAR_ONE:
        return gap
    fine = equations.with_digits(FINE_DIGITS)
    root = polish(fine, points)
    if not root.converged:  # orbits that are not isolated have a multiplier of 1
        return None
    gap = float(1 - max(abs(value) for value in multipliers_of(fine, root.points)))
    if abs(gap) < ON_CIRCLE:
        return None
    return gap


def rest_positions(parameters: Parameters, boundary: int) -> tuple[Fraction, Fraction] | None:
    """Return the lowest and highest x at which the mass may rest on a belt forever, or None if it
    cannot.
    """
    # The belt has to be at rest, and F^(below) >= 0 >= F^(above) has to hold at every phase.
    if parameters.belt(boundary) != 0 or parameters.k == 0:
        return None
    below, above = (parameters.A(domain) for domain in NEIGHBOURS[boundary])
    low, high = (
        (A + sign * abs(parameters.B0)) / parameters.k for A, sign in ((above, 1), (below, -1))
    )
    if low <= high:
        return (low, high)
    return None
