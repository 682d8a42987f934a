"""The first exit from a domain, guaranteed: no crossing is missed, however near to a graze.

Why nothing can be missed
-------------------------
In a domain the gap g = +-(v - v_lambda) between the velocity and a wall is smooth, and v obeys a linear equation whose
derivatives are known in closed form. At a time tau the derivatives up to the third are evaluated, and the fourth is
bounded for all later times:

    |d^4 v/dt^4| <= M4 = V0 Omega^4 + sqrt(j^2 + w0^2 w^2)

with V0 the amplitude of the steady velocity and w, j the third and fourth derivative of the transient, whose energy
j^2 + w0^2 w^2 never grows (it obeys the unforced equation, and damping only takes energy away). Near undamped resonance
the two parts are not told apart; then the same energy argument for the whole derivative gives
M4 = sqrt(j^2 + w0^2 w^2) + |B0| Omega^2/m over the next 1/Omega of time, and no step is longer than that. Hence

    g(tau + s) >= P(s) = g + g' s + g'' s^2/2 + g''' s^3/6 - M4 s^4/24

and g has no root before the first root of P. A step goes no further than that: P > 0 on [0, s] is shown by its Bernstein
coefficients, which are all positive. Near a simple root P tells its place to fourth order, so the steps converge on
it from the left, and two of them suffice. At a start on the wall the known root is divided out of P (one factor s for
each derivative that vanishes), so a start is never mistaken for a hit and an immediate return is not missed.

Near a tangency the steps shrink; then the minimum of the gap ahead is found and compared with the rounding error of the
gap plus what is known of the error of the start (`tolerance`). If it is clearly positive, the polynomial bound taken
at the minimum, backward, excludes a root on the way to it. If it is clearly negative there is a crossing, which the
steps find. If neither, the contact cannot be decided in this precision and is returned as a tangency.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on mpmath numbers.
"""

from __future__ import annotations

from math import sqrt

from symosc.kernels._generated import motion, next_derivative
from symosc.kernels.entire import EPS, basis

# What a search ends with.
NOTHING, HIT, TANGENCY, STALLED = 0, 1, 2, 3

# A root is taken from the local polynomial when that places it within NEAR / rate: Taylor's formula then moves the
# state there to full precision.
NEAR = EPS ** (1.0 / 3.0)
# Steps shorter than this (times 1/rate) are a sign of a tangency ahead.
SHORT_STEP = 1e-3
# How far a safe step stays before the root that it aims at, as a part of the step.
SHRINK = 1e-3
# Error of the kernels, in units of EPS times the sum of the sizes of their terms (measured: at most 6).
ROUNDING = 16.0
MOST_STEPS = 20000
# A root behind which the gap gets deeper than this part of its size needs no closer look.
CLEAR_DEPTH = 1e-9
FAR = 1e300
TINY = 1e-300


def state_at(tau, v0, a0, s0, c0, K):
    """Return dx, dv, a, b, w, j, s, c, E0, E1, E2 at `tau` after a start.

    dx and dv are increments, a to j the derivatives of v, s and c the sine and cosine of the phase.
    """
    E0, E1, E2, R2, I2, s_Om, c_Om = basis(tau, K)
    dx, dv, a = motion(v0, a0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    s, c = s0 * c_Om + c0 * s_Om, c0 * c_Om - s0 * s_Om
    b, w, j = derivatives(v0 + dv, a, s, c, K)
    return dx, dv, a, b, w, j, s, c, E0, E1, E2


def derivatives(v, a, s, c, K):
    """Return v'', v''' and v'''' (that is G^(1), G^(2), G^(3)) from v, a and the sine and cosine of the phase."""
    b = next_derivative(a, v, K.fB * s, K.cm, K.w0sq)
    w = next_derivative(b, a, K.fB * K.Om * c, K.cm, K.w0sq)
    j = next_derivative(w, b, -K.fB * K.Om * K.Om * s, K.cm, K.w0sq)
    return b, w, j


def fourth_derivative_bound(w, j, s, c, K):
    """Return M4 >= |v''''| from here on, when K.steady; over the next 1/Omega otherwise."""
    if not K.steady:
        return sqrt(j * j + K.w0sq * w * w) + abs(K.fB) * K.Om * K.Om
    Om3 = K.Om * K.Om * K.Om
    w_transient = w - Om3 * (K.Sc * s - K.Ss * c)
    j_transient = j - Om3 * K.Om * (K.Ss * s + K.Sc * c)
    return K.V0 * Om3 * K.Om + sqrt(j_transient * j_transient + K.w0sq * w_transient * w_transient)


def positive_on(s, p0, p1, p2, p3, p4):
    """Return whether p0 + p1 s + ... + p4 s^4 > 0 on [0, s] is shown by its Bernstein coefficients."""
    t1, t2, t3 = p1 * s, p2 * s * s, p3 * s * s * s
    if p0 <= 0.0 or p0 + 0.25 * t1 <= 0.0 or p0 + 0.5 * t1 + t2 / 6.0 <= 0.0:
        return False
    return p0 + 0.75 * t1 + 0.5 * t2 + 0.25 * t3 > 0.0 and p0 + t1 + t2 + t3 + p4 * s * s * s * s > 0.0


def safe_step(cap, p0, p1, p2, p3, p4):
    """Return (s, root): P > 0 on [0, s] with s <= cap; `root` estimates the first root of P, cap if none comes before.

    The root of the quadratic whose last coefficient takes in the higher terms at the current estimate is iterated.
    """
    if p0 <= 0.0:
        return 0.0 * cap, cap
    root, found = cap, False
    for _ in range(3):
        top = p2 + (p3 + p4 * root) * root
        square = p1 * p1 - 4.0 * p0 * top
        if square < 0.0 or (top >= 0.0 and p1 >= 0.0):
            found = False
            break
        denominator = sqrt(square) - p1
        found = 2.0 * p0 < cap * denominator
        root = 2.0 * p0 / denominator if found else cap
    if positive_on(root, p0, p1, p2, p3, p4):
        return root, root if found else cap
    s = root - SHRINK * root
    while not positive_on(s, p0, p1, p2, p3, p4):
        s = 0.5 * s
        found = False
    return s, root if found else cap


def gap_step(cap, g, g1, g2, g3, M4, on_wall):
    """Return (s, root, error, depth) for a gap with these derivatives.

    The gap has no root on (0, s]. If its first root is near, `root` is that root up to `error`, and the gap would fall
    to about -`depth` behind it; otherwise `error` is FAR. `on_wall`: the gap starts at 0, and that root does not count.
    """
    top = -M4 / 24.0
    if not on_wall:
        p0, p1, p2, p3, p4, order = g, g1, 0.5 * g2, g3 / 6.0, top, 4
    elif g1 > 0.0:
        p0, p1, p2, p3, p4, order = g1, 0.5 * g2, g3 / 6.0, top, 0.0, 3
    elif g2 > 0.0:
        p0, p1, p2, p3, p4, order = 0.5 * g2, g3 / 6.0, top, 0.0, 0.0, 2
    else:
        p0, p1, p2, p3, p4, order = g3 / 6.0, top, 0.0, 0.0, 0.0, 1
    s, root = safe_step(cap, p0, p1, p2, p3, p4)
    if root >= cap or s < root - 2.0 * SHRINK * root:
        return s, cap, FAR, FAR
    slope = -(p1 + (2.0 * p2 + (3.0 * p3 + 4.0 * p4 * root) * root) * root)
    bend = abs(2.0 * p2 + (6.0 * p3 + 12.0 * p4 * root) * root)
    missing = M4 / 12.0
    for _ in range(order):
        missing = missing * root
    missing = missing + abs(p0 + (p1 + (p2 + (p3 + p4 * root) * root) * root) * root)
    # One root near `root`, and only one: the gap there is known to be within `missing` of 0, and its slope keeps its
    # sign on what the safe step leaves open and on what it takes to make up for `missing` (Kantorovich).
    if slope <= 0.0 or 8.0 * SHRINK * root * bend > slope or 8.0 * missing * (bend + slope / root) > slope * slope:
        return s, cap, FAR, FAR
    depth = slope * slope / (2.0 * bend + TINY)
    for _ in range(4 - order):  # back from the divided polynomial to the gap
        depth = depth * root
    return s, root, missing / slope, depth


def first_exit(tau_max, v0, a0, s0, c0, below, above, has_below, has_above, on_below, on_above, S11, S12, S22, K):
    """Find the first contact of a flight with a wall.

    Parameters
    ----------
    tau_max : time to search.
    v0, a0, s0, c0 : velocity, acceleration, sine and cosine of the phase at the start.
    below, above : v0 minus the lower wall's velocity, the upper wall's minus v0 (>= 0); exact 0 at a start on a wall.
    has_below, has_above, on_below, on_above : whether there is such a wall, and whether the start is on it.
    S11, S12, S22 : covariance of the errors of the start.
    K : Constants

    Returns
    -------
    (code, side, tau, dx, dv, a, b, s, c, E0, E1, E2)
        code NOTHING (state at tau_max), HIT, TANGENCY or STALLED; side -1 for the lower wall, +1 for the upper. A
        contact is returned even if the last correction moved it past tau_max.
    """
    zero = 0.0 * tau_max
    tau, dx, dv, a, s, c = zero, zero, zero, a0, s0, c0
    b, w, j = derivatives(v0, a0, s0, c0, K)
    E0, E1, E2 = 1.0 + zero, zero, zero
    crossing = False  # whether the minimum of the gap ahead is known to be negative
    if (on_below or on_above) and a0 == 0.0:
        # After a tangency or the end of a stick. A derivative within rounding of 0 is 0 there: its sign would be noise.
        if abs(b) <= ROUNDING * EPS * (abs(K.w0sq * v0) + abs(K.fB)):
            b = zero
        if b == 0.0 and abs(w) <= abs(j) * K.chunk * EPS * ROUNDING + NEAR * NEAR * abs(K.fB) * K.Om:
            tau = quartic_start(j, w, s0, c0, K)
            if tau > tau_max:
                tau = tau_max
            dx, dv, a, b, w, j, s, c, E0, E1, E2 = state_at(tau, v0, a0, s0, c0, K)
    for _ in range(MOST_STEPS):
        if tau >= tau_max:
            return NOTHING, 0, tau, dx, dv, a, b, s, c, E0, E1, E2
        M4 = fourth_derivative_bound(w, j, s, c, K)
        cap = tau_max - tau
        if not K.steady and cap * K.Om > 1.0:
            cap = 1.0 / K.Om
        step, root, error, depth, side = cap, cap, FAR, FAR, 0
        if has_below:
            step, root, error, depth = gap_step(cap, below + dv, a, b, w, M4, on_below and tau == 0.0)
            side = -1
        if has_above:
            step_up, root_up, error_up, depth_up = gap_step(cap, above - dv, -a, -b, -w, M4, on_above and tau == 0.0)
            if side == 0 or step_up < step:
                if side != 0 and step < root_up:
                    error_up = FAR
                step, root, error, depth, side = step_up, root_up, error_up, depth_up, 1
            elif step_up < root:
                error = FAR
        start_gap = below if side < 0 else above
        clear = crossing or depth > CLEAR_DEPTH * (start_gap + abs(dv) + abs(a) * root)
        if clear and error * K.rate < NEAR:
            return polish(tau + root, side, v0, a0, s0, c0, below, above, K)
        if (step * K.rate < SHORT_STEP or not clear) and not crossing and (start_gap > 0.0 or tau > 0.0):
            verdict, tau_min = closest_approach(tau, side, M4, v0, a0, s0, c0, below, above, S11, S12, S22, K)
            if verdict == TANGENCY:
                dx, dv, a, b, w, j, s, c, E0, E1, E2 = state_at(tau_min, v0, a0, s0, c0, K)
                return TANGENCY, side, tau_min, dx, dv, a, b, s, c, E0, E1, E2
            if verdict == HIT:
                crossing = True
            elif verdict == NOTHING and tau_min < tau_max:
                step = tau_min - tau
        if step <= 0.0:
            break
        tau = tau + step if step < tau_max - tau else tau_max
        dx, dv, a, b, w, j, s, c, E0, E1, E2 = state_at(tau, v0, a0, s0, c0, K)
        if (has_below and below + dv <= 0.0) or (has_above and above - dv <= 0.0):  # by rounding: the root is here
            return polish(tau, side, v0, a0, s0, c0, below, above, K)
    return STALLED, side, tau, dx, dv, a, b, s, c, E0, E1, E2


def quartic_start(j, w, s, c, K):
    """Return a time before which a gap that starts like j tau^4/24 has no other root; the fifth derivative is bounded."""
    Om4 = K.Om * K.Om * K.Om * K.Om
    fifth = next_derivative(j, w, -K.fB * K.Om * K.Om * K.Om * c, K.cm, K.w0sq)
    if K.steady:
        j_transient = j - Om4 * (K.Ss * s + K.Sc * c)
        fifth_transient = fifth - Om4 * K.Om * (K.Ss * c - K.Sc * s)
        M5 = K.V0 * Om4 * K.Om + sqrt(fifth_transient * fifth_transient + K.w0sq * j_transient * j_transient)
        return 4.0 * abs(j) / M5 if M5 > 0.0 else K.chunk
    bound = 4.0 * abs(j) / (sqrt(fifth * fifth + K.w0sq * j * j) + abs(K.fB) * K.Om * K.Om * K.Om)
    return bound if bound * K.Om < 1.0 else 1.0 / K.Om


def polish(tau, side, v0, a0, s0, c0, below, above, K):
    """Return the contact near `tau`, by Newton steps on the exact flow; the last one by Taylor's formula."""
    for _ in range(60):
        dx, dv, a, b, w, j, s, c, E0, E1, E2 = state_at(tau, v0, a0, s0, c0, K)
        over = below + dv if side < 0 else dv - above
        shift = -over / a if a != 0.0 else 0.0 * a
        if abs(shift) * K.rate < NEAR:
            for _ in range(4 if abs(b * shift) > 1e-4 * abs(a) else 2):
                slope = a + (b + 0.5 * w * shift) * shift
                if slope != 0.0:
                    shift = shift - (over + (a + (0.5 * b + w * shift / 6.0) * shift) * shift) / slope
            dx = dx + (v0 + dv + (0.5 * a + b * shift / 6.0) * shift) * shift
            a = a + (b + (0.5 * w + j * shift / 6.0) * shift) * shift
            tau = tau + shift
            return HIT, side, tau, dx, dv, a, b, s, c, E0, E1, E2
        tau = tau + shift
    return STALLED, side, tau, dx, dv, a, b, s, c, E0, E1, E2


def tolerance(tau, start_gap, v0, a0, s0, c0, S11, S12, S22, K):
    """Return how far a gap may be wrong `tau` after a start: rounding, plus what the errors of the start have become."""
    E0, E1, E2, R2, I2, _, _ = basis(tau, K)
    size = abs(a0 * E1) + K.w0sq * abs(v0) * E2 + abs(K.fB) * (abs(s0 * R2) + abs(c0 * I2)) + start_gap
    pull = -K.w0sq * E1
    variance = pull * pull * S11 + 2.0 * pull * E0 * S12 + E0 * E0 * S22
    return ROUNDING * EPS * size + K.sigmas * sqrt(abs(variance))


def closest_approach(tau, side, M4, v0, a0, s0, c0, below, above, S11, S12, S22, K):
    """Look for a minimum of the gap after `tau`, by Newton steps on its slope.

    Returns
    -------
    (verdict, tau_min)
        NOTHING: the gap is positive up to tau_min. HIT: it is negative at tau_min. TANGENCY: it touches 0 there as far
        as this precision tells. STALLED: no minimum was found nearby, or the way to it is not proven free.
    """
    start, sign = tau, -side
    last, depth_known = FAR, False
    for _ in range(400):
        _, dv, a, b, w, _, _, _, _, _, _ = state_at(tau, v0, a0, s0, c0, K)
        gap, slope, bend = (below + dv if side < 0 else above - dv), sign * a, sign * b
        allowed = tolerance(tau, below if side < 0 else above, v0, a0, s0, c0, S11, S12, S22, K)
        if bend <= 0.0 and not depth_known:
            return STALLED, tau
        shift = -slope / bend if bend > 0.0 else 0.0 * slope
        if abs(slope * shift) <= 0.25 * allowed or gap < -2.0 * allowed:
            depth_known = True
        if depth_known:
            if gap < -allowed:
                return HIT, tau
            if gap > allowed:
                back = tau - start
                free = positive_on(back, gap - allowed, -slope, 0.5 * bend, -sign * w / 6.0, -M4 / 24.0)
                return (NOTHING if free and back > 0.0 else STALLED), tau
            if abs(shift) >= 0.9 * last or shift == 0.0:  # as near as rounding allows
                return TANGENCY, tau
        last = abs(shift)
        tau = tau + shift
        if tau < start:
            return STALLED, start
    return STALLED, tau


def never_leaves(v, a, s, c, lower, upper, has_below, has_above, K):
    """Return whether v stays between the walls for ever, from the steady amplitude and the transient's energy."""
    if not K.steady or K.w0 == 0.0:
        return False
    v_transient = v - (K.Ss * s + K.Sc * c)
    a_transient = a - K.Om * (K.Ss * c - K.Sc * s)
    reach = K.V0 + sqrt(a_transient * a_transient + K.w0sq * v_transient * v_transient) / K.w0
    return not (has_below and -reach <= lower) and not (has_above and reach >= upper)
