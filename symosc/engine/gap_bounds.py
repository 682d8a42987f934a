"""Lower bounds of the gap between the velocity and a wall: what makes the event search a proof.

See `symosc.engine.first_exit` for the argument. P stands for the polynomial p0 + p1 s + ... + p4 s^4 that bounds a gap
from below.
"""

from __future__ import annotations

from math import sqrt

from symosc.engine.flow import fifth_derivative
from symosc.kernels.entire import EPS, SIXTH

# A root is taken from the local polynomial when that is sure to place it within ISOLATED / rate, and Newton's method
# goes on from there. A shift below NEAR / rate is made by Taylor's formula, to full precision.
ISOLATED = 6e-2
NEAR = 2.0 * EPS**0.2
MOST_NEWTON = 200
FAR = 1e300
# How far a safe step stays before the root that it aims at, as a part of the step.
SHRINK = 1e-3
# A root of P is taken as found when Halley's last step was shorter than this part of it: the next would be its cube.
FIRM = 1e-2
# A root behind which the gap gets deeper than this part of its size needs no closer look.
CLEAR_DEPTH = 1e-9


def fourth_derivative_bound(G2, G3, s, c, K):
    """Return M4 >= |v''''| from here on, when K.steady; over the next 1/Omega otherwise."""
    if not K.steady:
        return sqrt(G3 * G3 + K.w0sq * G2 * G2) + abs(K.fB) * K.Om * K.Om
    Om3 = K.Om * K.Om * K.Om
    G2_transient = G2 - Om3 * (K.Sc * s - K.Ss * c)
    G3_transient = G3 - Om3 * K.Om * (K.Ss * s + K.Sc * c)
    return K.V0 * Om3 * K.Om + sqrt(G3_transient * G3_transient + K.w0sq * G2_transient * G2_transient)


def positive_on(s, p0, p1, p2, p3, p4):
    """Return whether p0 + p1 s + ... + p4 s^4 > 0 on [0, s] is shown by its Bernstein coefficients."""
    t1, t2, t3 = p1 * s, p2 * s * s, p3 * s * s * s
    if p0 <= 0.0 or p0 + 0.25 * t1 <= 0.0 or p0 + 0.5 * t1 + SIXTH * t2 <= 0.0:
        return False
    return p0 + 0.75 * t1 + 0.5 * t2 + 0.25 * t3 > 0.0 and p0 + t1 + t2 + t3 + p4 * s * s * s * s > 0.0


def safe_step(cap, p0, p1, p2, p3, p4):
    """Return (s, root): P > 0 on [0, s] with s <= cap; `root` estimates the first root of P, cap if none comes before.

    First the root of the quadratic, then Halley's method; whatever they give is checked before it is used.
    """
    if p0 <= 0.0:
        return 0.0 * cap, cap
    root, found = cap, False
    square = p1 * p1 - 4.0 * p0 * p2
    if square > 0.0 and (p1 < 0.0 or p2 < 0.0):
        denominator = sqrt(square) - p1
        if 2.0 * p0 < cap * denominator:
            root = 2.0 * p0 / denominator
    for _ in range(4):
        value = p0 + (p1 + (p2 + (p3 + p4 * root) * root) * root) * root
        slope = p1 + (2.0 * p2 + (3.0 * p3 + 4.0 * p4 * root) * root) * root
        half_bend = p2 + (3.0 * p3 + 6.0 * p4 * root) * root
        below = slope * slope - value * half_bend
        if slope >= 0.0 or below <= 0.0:
            break
        shift = value * slope / below
        if shift >= root:
            break
        root = root - shift
        if root >= cap:
            root = cap
            break
        found = abs(shift) < FIRM * root
        if found:
            break
    s = root - SHRINK * root if found else root
    while s > 0.0 and not positive_on(s, p0, p1, p2, p3, p4):
        s = 0.5 * s
        found = False
    return s, root if found else cap


def gap_polynomial(g, g1, g2, g3, M4, on_wall):
    """Return P's coefficients and degree, divided by the root at the start if that is `on_wall`."""
    top, zero = -0.25 * SIXTH * M4, 0.0 * g
    if not on_wall:
        return g, g1, 0.5 * g2, SIXTH * g3, top, 4
    if g1 > 0.0:
        return g1, 0.5 * g2, SIXTH * g3, top, zero, 3
    if g2 > 0.0:
        return 0.5 * g2, SIXTH * g3, top, zero, zero, 2
    return SIXTH * g3, top, zero, zero, zero, 1


def gap_to(side, now, walls):
    """Return the gap to the wall on a side (-1 below, 1 above) at the point `now` of a flight."""
    return walls.below + now.dv if side < 0 else walls.above - now.dv


def held_back(gap, margin):
    """Return a gap less a margin that is kept for its error; half the gap where it is not much larger than that."""
    return gap - margin if gap > 2.0 * margin else 0.5 * gap if margin > 0.0 else gap


def gap_bound(side, now, M4, margin, walls):
    """Return the bound P (`gap_polynomial`) of the gap to the wall on a side, from the point `now` of a flight on."""
    on_wall = now.tau == 0.0 and (walls.on_below if side < 0 else walls.on_above)
    gap = held_back(gap_to(side, now, walls), margin)
    return gap_polynomial(gap, -side * now.F, -side * now.G1, -side * now.G2, M4, on_wall)


def is_near(root, P, M4, size, K):
    """Return (near, close, clear): is the first root `root` within ISOLATED or NEAR/rate; is the gap deep behind it?

    One root near `root`, and only one: the gap there is known to be within `missing` of 0, and its slope keeps its sign
    on what the safe step leaves open and on what makes up for `missing` (Kantorovich).
    """
    p0, p1, p2, p3, p4, degree = P
    slope = -(p1 + (2.0 * p2 + (3.0 * p3 + 4.0 * p4 * root) * root) * root)
    bend = abs(2.0 * p2 + (6.0 * p3 + 12.0 * p4 * root) * root)
    missing = 0.5 * SIXTH * M4
    for _ in range(degree):
        missing = missing * root
    missing = missing + abs(p0 + (p1 + (p2 + (p3 + p4 * root) * root) * root) * root)
    near = (
        slope > 0.0
        and missing * K.rate < ISOLATED * slope
        and 8.0 * SHRINK * root * bend < slope
        and 8.0 * missing * (bend * root + slope) < slope * slope * root
    )
    depth = slope * slope
    for _ in range(4 - degree):  # back from the divided polynomial to the gap
        depth = depth * root
    return near, missing * K.rate < NEAR * slope, depth > 2.0 * CLEAR_DEPTH * size * bend


def quartic_start(G3, G2, s, c, K):
    """Return a time before which a gap that starts like G3 tau^4/24 has no other root, by a bound like M4."""
    Om4 = K.Om * K.Om * K.Om * K.Om
    fifth = fifth_derivative(G3, G2, c, K)
    if K.steady:
        G3_transient = G3 - Om4 * (K.Ss * s + K.Sc * c)
        fifth_transient = fifth - Om4 * K.Om * (K.Ss * c - K.Sc * s)
        M5 = K.V0 * Om4 * K.Om + sqrt(fifth_transient * fifth_transient + K.w0sq * G3_transient * G3_transient)
        return 4.0 * abs(G3) / M5 if M5 > 0.0 else K.chunk
    bound = 4.0 * abs(G3) / (sqrt(fifth * fifth + K.w0sq * G3 * G3) + abs(K.fB) * K.Om * K.Om * K.Om)
    return bound if bound * K.Om < 1.0 else 1.0 / K.Om


def local_root(over, F, G1, G2, G3, resolution):
    """Return the root near 0 of over + F s + G1 s^2/2 + G2 s^3/6 + G3 s^4/24, by Newton's method.

    A simple root so near that the inverted series has it to `resolution` needs no step, one farther off takes a step or
    two after the series, a multiple root as many as it needs. FAR if none was found.
    """
    s = 0.0 * resolution
    if abs(over * G1) < 0.1 * F * F:
        inverse = 1.0 / F
        linear = over * inverse
        B, W = 0.5 * G1 * inverse * linear, SIXTH * G2 * inverse * linear * linear
        s = -linear * ((1.0 + B) + (2.0 * B * B - W))
        missing = 8.0 * abs(B) * (B * B + abs(W)) + abs(G3 * inverse * linear * linear * linear)
        if abs(linear) * missing <= resolution:
            return s
    return newton_root(s, over, F, G1, G2, G3, resolution)


def newton_root(s, over, F, G1, G2, G3, resolution):
    """Return the root that `local_root` looks for, by steps from `s` on."""
    for _ in range(MOST_NEWTON):
        slope = F + (G1 + (0.5 * G2 + SIXTH * G3 * s) * s) * s
        if slope == 0.0:
            return s
        change = (over + (F + (0.5 * G1 + SIXTH * (G2 + 0.25 * G3 * s) * s) * s) * s) / slope
        s = s - change
        bend, third = G1 + (G2 + 0.5 * G3 * s) * s, G2 + G3 * s
        # The next step would be shorter than that.
        if change * change * (abs(bend) + abs(third * change)) <= resolution * abs(slope):
            return s
    return FAR + s
