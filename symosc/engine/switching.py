"""What happens at a boundary: Theorems 4, 5 and 6, continued to any order of the G-functions.

At a point of the boundary with domain `below` and domain `above` (n = (0, 1), so that G^(0) is the acceleration)

- stick (Theorem 4) iff F^(below) > 0 > F^(above);
- passing (Theorem 5) iff both forces have one sign: upward if positive, downward if negative;
- where a force vanishes, the sign of its first G-function that does not vanish takes its place (Luo): it is the
  sign that the force has immediately afterwards.

A tangency from below (Theorem 6) has F^(below) = 0 and a negative first G-function of odd order, one from above a
positive one.
"""

from __future__ import annotations

from symosc.engine.state import BELT, DOMAIN_ABOVE, DOMAIN_BELOW, Covariance
from symosc.kernels._generated import next_derivative
from symosc.kernels.entire import EPS

# Orders that are looked at before a force is taken to vanish for ever. The recurrence of the G-functions has four
# terms of history (position in the plane and two of the drive), so more than five zeros in a row mean all.
HIGHEST_ORDER = 6
# A G-function below this times EPS and the sum of its terms is taken as 0: its zero is the exact case in question.
G_ROUNDING = 32.0


def following_sign(v, F, s, c, K):
    """Return the sign (-1, 0, 1) of the first G-function that does not vanish at a contact, and its order.

    Parameters
    ----------
    v, F : velocity of the belt and acceleration; F is exact, F = 0 means that it vanishes.
    s, c : sine and cosine of the phase.
    K : Constants
    """
    if F != 0.0:
        return (1 if F > 0.0 else -1), 0
    before, now = v, F
    drive_s, drive_c = K.fB * s, K.fB * c
    for order in range(1, HIGHEST_ORDER):
        forcing = drive_s
        after = next_derivative(now, before, forcing, K.cm, K.w0sq)
        size = abs(forcing) + abs(K.cm * now) + abs(K.w0sq * before)
        if abs(after) > G_ROUNDING * EPS * (size + abs(K.fB) * power(K.Om, order - 1)):
            return (1 if after > 0.0 else -1), order
        before, now = now, 0.0 * after
        drive_s, drive_c = K.Om * drive_c, -K.Om * drive_s
    return 0, HIGHEST_ORDER


def power(base, exponent):
    """Return base**exponent for a small whole exponent, by multiplication."""
    result = 1.0
    for _ in range(exponent):
        result = result * base
    return result


def resolve(v, F_below, F_above, s, c, K):
    """Return where the motion goes from a point of a boundary: DOMAIN_BELOW, BELT or DOMAIN_ABOVE (Theorems 4 and 5).

    F_below - F_above = 2 mu FN/m >= 0 always, so the flow cannot leave on both sides at once.
    """
    below, _ = following_sign(v, F_below, s, c, K)
    above, _ = following_sign(v, F_above, s, c, K)
    if above > 0:
        return DOMAIN_ABOVE
    if below < 0:
        return DOMAIN_BELOW
    return BELT


def carried_error(S, now, x_noise, v_noise, K):
    """Return the covariance of (x, v) at the time of `now` (`Flown`), after a launch with covariance S.

    Perturbations obey the unforced equation in every domain, so the entire functions carry them: dx gains E1 dv,
    dv gains -(k/m) E1 dx. The rounding errors of the step are added.
    """
    E0, E1, S11, S12, S22 = now.E0, now.E1, S.S11, S.S12, S.S22
    C, D = 1.0 - K.w0sq * now.E2, -K.w0sq * E1
    return Covariance(
        C * C * S11 + 2.0 * C * E1 * S12 + E1 * E1 * S22 + x_noise * x_noise,
        C * D * S11 + (C * E0 + E1 * D) * S12 + E1 * E0 * S22,
        D * D * S11 + 2.0 * D * E0 * S12 + E0 * E0 * S22 + v_noise * v_noise,
    )
