"""The first exit from a domain: in real arithmetic no crossing is missed, however near to a graze.

Why nothing can be missed
-------------------------
In a domain the gap g = +-(v - v_lambda) between the velocity and a wall is smooth, and v obeys a linear equation whose
derivatives are known in closed form. At a time tau the derivatives up to the third are evaluated, and the fourth is
bounded for all later times:

    |d^4 v/dt^4| <= M4 = V0 Omega^4 + sqrt(G3^2 + w0^2 G2^2)

with V0 the amplitude of the steady velocity and G2, G3 the third and fourth derivative of the transient, whose energy
G3^2 + w0^2 G2^2 never grows (it obeys the unforced equation, and damping only takes energy away). Near undamped
resonance the two parts are not told apart; then the same energy argument for the whole derivative gives
M4 = sqrt(G3^2 + w0^2 G2^2) + |B0| Omega^3/m over the next 1/Omega of time, and no step is longer than that. Hence

    g(tau + s) >= P(s) = g + g' s + g'' s^2/2 + g''' s^3/6 - M4 s^4/24

and g has no root before the first root of P. A step goes no further than that: P > 0 on [0, s] is shown by its
Bernstein coefficients, which are all positive. Near a simple root P tells its place to fourth order, so the steps
converge on it from the left; once P shows that the first root is the only one nearby, its place is improved with the
true derivatives (`sharpened`), so that one evaluation of the flow makes it exact. At a start on the wall the known root
is divided out of P (one factor s for each derivative that vanishes), so a start is never mistaken for a hit and an
immediate return is not missed. Where the closed form is cheap, `march` goes ahead with the same bound in fixed steps.

Near a tangency the steps shrink; then the minimum of the gap ahead is found and compared with the rounding error of the
gap plus what is known of the error of the start (`tolerance`). If it is clearly positive, the polynomial bound taken
at the minimum, backward, excludes a root on the way to it. If it is clearly negative there is a crossing, which the
steps find. If neither, the contact cannot be decided in this precision and is returned as a tangency.

What is proven, and what is measured: the bound and the steps are a proof in real arithmetic. Evaluated with rounding,
each gap is known to a few EPS times its terms only, so decisions must exceed ROUNDING such errors, and the marching
steps MARCH_SLACK of the gap's size. That these margins are wide enough in doubles was measured, not proven.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on mpmath numbers.
"""

from __future__ import annotations

from math import sqrt

from symosc.engine.flow import derivatives, fifth_derivative, state_at
from symosc.engine.gap_bounds import (
    CLEAR_DEPTH,
    ISOLATED,
    NEAR,
    fourth_derivative_bound,
    gap_polynomial,
    is_near,
    positive_on,
    quartic_start,
    safe_step,
)
from symosc.engine.touches import HIT, LOST, NOTHING, ROUNDING, STALLED, TANGENCY, closest_approach, hidden
from symosc.kernels.entire import EPS, SIXTH

# Steps shorter than this (times 1/rate) are a sign of a tangency ahead.
SHORT_STEP = 4e-3
MOST_STEPS = 20000
# Short steps on which no minimum of the gap was found ahead, before the search is given up.
MOST_STALLS = 30
# Steps to a contact in its bracket (halving alone takes as many as there are bits).
MOST_HALVINGS = 400
MOST_NEWTON = 200
# What a gap must exceed while marching, as a part of its size.
MARCH_SLACK = 1e-10
# A gap of so many times what a stride needs (its fourth power counts) allows a step of 50 strides.
PATIENCE = 6e6
# A gap smaller than this part of the velocities in question is compared with its error.
THIN = 1e-9
# An error of the start that is smaller than THIN times the root of this part of the velocities is rounding.
FAINT = 1e-8


def first_exit(tau_max, v0, F0, s0, c0, below, above, has_below, has_above, on_below, on_above, S11, S12, S22, K):
    """Find the first contact of a flight with a wall.

    Parameters
    ----------
    tau_max : time to search.
    v0, F0, s0, c0 : velocity, acceleration, sine and cosine of the phase at the start.
    below, above : v0 minus the lower wall's velocity, the upper wall's minus v0 (>= 0); exact 0 at a start on a wall.
    has_below, has_above, on_below, on_above : whether there is such a wall, and whether the start is on it.
    S11, S12, S22 : covariance of the errors of the start.
    K : Constants

    Returns
    -------
    (code, side, tau, dx, dv, F, G1, s, c, E0, E1, E2)
        code NOTHING (state at tau_max), HIT, TANGENCY or STALLED; side -1 for the lower wall, +1 for the upper. A
        contact is returned even if the last correction moved it past tau_max.
    """
    zero = 0.0 * tau_max
    tau, dx, dv, F, s, c = zero, zero, zero, F0, s0, c0
    G1, G2, G3 = derivatives(v0, F0, s0, c0, K)
    E0, E1, E2 = 1.0 + zero, zero, zero
    side = -1 if has_below else 1
    crossing, tau_deep = 0, zero  # the side on which the gap ahead is known to be negative, and where
    stalled = 0
    flat = (on_below or on_above) and F0 == 0.0 and abs(G1) <= ROUNDING * EPS * (abs(K.w0sq * v0) + abs(K.fB))
    if flat:  # after a tangency or the end of a stick; a derivative within rounding of 0 is 0 there, its sign is noise
        G1 = zero  # near sin(theta) = +-1 that leaves cos(theta), and with it G2, uncertain by about sqrt(EPS)
        flat = abs(G2) <= ROUNDING * sqrt(EPS) * abs(K.fB) * K.Om
    if flat:
        tau = quartic_start(G3, G2, s0, c0, K)
        if tau > tau_max:
            tau = tau_max
        dx, dv, F, G1, G2, G3, s, c, E0, E1, E2 = state_at(tau, v0, F0, s0, c0, K)
    M4 = fourth_derivative_bound(G2, G3, s, c, K)
    speed = THIN * (abs(v0) + (abs(F0) + abs(K.f0)) * K.moment)
    variance = K.sigmas * K.sigmas * (S22 + K.w0sq * S11)
    thin = 4.0 * variance + speed * speed
    # What the error of the start can do to a gap; where that is less than rounding `tolerance` sees to it.
    margin = sqrt(variance) if variance > FAINT * speed * speed else zero
    if K.apart and not flat:
        tau, dv, F, G1, G2, G3, s, c, M4 = march(
            tau_max, v0, F0, G1, G2, G3, M4, s0, c0, below, above, has_below, has_above, on_below, on_above, margin, K
        )
    for _ in range(MOST_STEPS):
        thin_below = has_below and (below + dv) * (below + dv) < thin and (tau > 0.0 or not on_below)
        thin_above = has_above and (above - dv) * (above - dv) < thin and (tau > 0.0 or not on_above)
        if thin_below and hidden(tau, -1, v0, F0, s0, c0, below, above, S11, S12, S22, K):
            side = -1
            break
        if thin_above and hidden(tau, 1, v0, F0, s0, c0, below, above, S11, S12, S22, K):
            side = 1
            break
        if tau >= tau_max:
            return NOTHING, 0, tau, dx, dv, F, G1, s, c, E0, E1, E2
        cap = tau_max - tau
        if not K.steady and cap * K.Om > 1.0:
            cap = 1.0 / K.Om
        side = -1 if has_below else 1
        start_gap = below if side < 0 else above
        on_wall = tau == 0.0 and (on_below if side < 0 else on_above)
        gap = below + dv if side < 0 else above - dv
        gap = held_back(gap, margin)
        p0, p1, p2, p3, p4, degree = gap_polynomial(gap, -side * F, -side * G1, -side * G2, M4, on_wall)
        step, root = safe_step(cap, p0, p1, p2, p3, p4)
        if has_below and has_above:  # the upper wall counts only if the lower one's step is too long for it
            on_wall = tau == 0.0 and on_above
            q0, q1, q2, q3, q4, q_degree = gap_polynomial(held_back(above - dv, margin), -F, -G1, -G2, M4, on_wall)
            if not positive_on(root if root < cap else step, q0, q1, q2, q3, q4):
                q_step, q_root = safe_step(cap, q0, q1, q2, q3, q4)
                if q_step < step:
                    other, side, start_gap = step, 1, above
                    p0, p1, p2, p3, p4, degree, step, root = q0, q1, q2, q3, q4, q_degree, q_step, q_root
                    root = cap if other < q_root else root
                else:
                    root = cap
        near, close, clear = False, False, True
        if root < cap:
            size = start_gap + abs(dv) + abs(F) * root + margin * (4.0 / CLEAR_DEPTH)
            near, close, clear = is_near(root, p0, p1, p2, p3, p4, degree, M4, size, K)
        known = crossing == side
        if near and (clear or known):
            low = tau
            high = tau_deep if known else tau + 2.0 * (root + ISOLATED * K.moment)
            if not close:
                root = sharpened(root, below + dv if side < 0 else dv - above, F, G1, G2, G3, c, K)
            return polish(tau + root, low, high, side, v0, F0, s0, c0, below, above, K)
        short = step < cap and step * K.rate < SHORT_STEP
        near_by = margin > 0.0 and side * F > 0.0 and (below + dv if side < 0 else above - dv) < 2.0 * margin
        if (short or near_by or not clear) and not known and (start_gap > 0.0 or tau > 0.0):
            verdict, tau_min = closest_approach(tau, tau, side, M4, v0, F0, s0, c0, below, above, S11, S12, S22, K)
            reach = tau_min - tau
            if has_below and has_above and verdict != STALLED and reach > step:  # the other wall may come before
                other = above - dv if side < 0 else below + dv
                on_wall = tau == 0.0 and (on_above if side < 0 else on_below)
                q0, q1, q2, q3, q4, _ = gap_polynomial(other, side * F, side * G1, side * G2, M4, on_wall)
                verdict = verdict if positive_on(reach, q0, q1, q2, q3, q4) else STALLED
            if verdict == TANGENCY:
                dx, dv, F, G1, G2, G3, s, c, E0, E1, E2 = state_at(tau_min, v0, F0, s0, c0, K)
                return TANGENCY, side, tau_min, dx, dv, F, G1, s, c, E0, E1, E2
            if verdict == LOST:
                break
            if verdict == HIT:
                crossing, tau_deep = side, tau_min
            elif verdict == NOTHING:
                step = reach if reach < cap else cap
            elif short:
                stalled = stalled + 1
        if step <= 0.0 or stalled > MOST_STALLS:
            break
        before = tau
        tau = tau + step if step < tau_max - tau else tau_max
        dx, dv, F, G1, G2, G3, s, c, E0, E1, E2 = state_at(tau, v0, F0, s0, c0, K)
        M4 = fourth_derivative_bound(G2, G3, s, c, K)
        low_side, high_side = has_below and below + dv <= 0.0, has_above and above - dv <= 0.0
        if low_side or high_side:
            # By rounding: P has no root here. So there is a root within rounding, or a touch.
            side = -1 if low_side else 1
            if crossing != side:
                verdict, tau_min = closest_approach(
                    tau, before, side, M4, v0, F0, s0, c0, below, above, S11, S12, S22, K
                )
                if verdict == TANGENCY:
                    dx, dv, F, G1, G2, G3, s, c, E0, E1, E2 = state_at(tau_min, v0, F0, s0, c0, K)
                    return TANGENCY, side, tau_min, dx, dv, F, G1, s, c, E0, E1, E2
                if verdict == LOST:
                    break
            return polish(tau, before, tau, side, v0, F0, s0, c0, below, above, K)
    return STALLED, side, tau, dx, dv, F, G1, s, c, E0, E1, E2


def held_back(gap, margin):
    """Return a gap less a margin that is kept for its error; half the gap where it is not much larger than that."""
    return gap - margin if gap > 2.0 * margin else 0.5 * gap if margin > 0.0 else gap


def march(tau_max, v0, F, G1, G2, G3, M4, s, c, below, above, has_below, has_above, on_below, on_above, margin, K):
    """Pass over times without a contact in whole fixed steps: the bound of `first_exit`, at a fraction of its cost.

    Over a fixed step the transient is multiplied by a constant matrix and the steady state turns by a constant angle,
    so the derivatives cost no exp, sin or cos. Their rounding errors are far below the slack that the gaps are given.
    Where the bound allows it, steps are strides.

    Returns
    -------
    (tau, dv, F, G1, G2, G3, s, c, M4)
        A time up to which no wall is met, and velocity gain, derivatives, sine and cosine of the phase and bound there.
    """
    M, long = K.march, False
    Om2 = K.Om * K.Om
    v_steady, u_steady = K.Ss * s + K.Sc * c, K.Ss * c - K.Sc * s
    v_free, F_free = v0 - v_steady, F - K.Om * u_steady
    slack = MARCH_SLACK * (abs(v0) + K.V0 + abs(v_free) + abs(F_free) * K.swing) + margin
    # A wall beyond the steady amplitude and what the transient's energy allows need not be looked at.
    energy = F_free * F_free + K.w0sq * v_free * v_free
    room_below, room_above = below - v0 - K.V0 - slack, v0 + above - K.V0 - slack
    has_below = has_below and not (room_below > 0.0 and energy < K.w0sq * room_below * room_below)
    has_above = has_above and not (room_above > 0.0 and energy < K.w0sq * room_above * room_above)
    square = K.stride.step * K.stride.step
    reach = 0.25 * SIXTH * square * square
    tau = 0.0 * tau_max
    dv = tau
    while tau + M.step < tau_max:
        free = True
        if has_below:
            p0, p1, p2, p3, p4, degree = gap_polynomial(below + dv, F, G1, G2, M4, on_below and tau == 0.0)
            free = positive_on(M.step, p0 - slack if degree == 4 else p0, p1, p2, p3, p4)
        if has_above and free:
            p0, p1, p2, p3, p4, degree = gap_polynomial(above - dv, -F, -G1, -G2, M4, on_above and tau == 0.0)
            free = positive_on(M.step, p0 - slack if degree == 4 else p0, p1, p2, p3, p4)
        if not free:
            if not long:
                break
            M, long = K.march, False
            continue
        tau = tau + M.step
        v_free, F_free = M.C * v_free + M.E1 * F_free, M.D * v_free + M.E0 * F_free
        s, c = M.c * s + M.s * c, M.c * c - M.s * s
        v_steady, u_steady = K.Ss * s + K.Sc * c, K.Ss * c - K.Sc * s
        G1_free = -K.cm * F_free - K.w0sq * v_free
        G2_free = -K.cm * G1_free - K.w0sq * F_free
        G3_free = -K.cm * G2_free - K.w0sq * G1_free
        M4 = K.V0 * Om2 * Om2 + sqrt(G3_free * G3_free + K.w0sq * G2_free * G2_free)
        dv = v_free + v_steady - v0
        F, G1, G2 = F_free + K.Om * u_steady, G1_free - Om2 * v_steady, G2_free - Om2 * K.Om * u_steady
        G3 = G3_free + Om2 * Om2 * v_steady
        least = reach * M4
        if K.patient:  # with the free motion gone, steps of their own length go farther
            room = PATIENCE * least
            if (not has_below or below + dv > room) and (not has_above or above - dv > room):
                break
        long = (
            (not has_below or below + dv + min(F, 0.0) * K.stride.step > least)
            and (not has_above or above - dv - max(F, 0.0) * K.stride.step > least)
            and tau + K.stride.step < tau_max
        )
        M = K.stride if long else K.march
    return tau, dv, F, G1, G2, G3, s, c, M4


def sharpened(root, over, F, G1, G2, G3, c, K):
    """Return a root that a lower bound has placed, by one step of Halley's method on a polynomial of degree five.

    So one evaluation of the flow is enough to make it exact. All arguments belong to the time that it is counted from.
    """
    half, third, fourth = 0.5 * G1, SIXTH * G2, 0.25 * SIXTH * G3
    fifth = 0.05 * SIXTH * fifth_derivative(G3, G2, c, K)
    value = over + (F + (half + (third + (fourth + fifth * root) * root) * root) * root) * root
    slope = F + (G1 + (3.0 * third + (4.0 * fourth + 5.0 * fifth * root) * root) * root) * root
    half_bend = half + (3.0 * third + (6.0 * fourth + 10.0 * fifth * root) * root) * root
    below = slope * slope - value * half_bend
    shift = value * slope / below if below > 0.0 else 0.0 * value
    return root - shift if abs(shift) < 0.5 * root else root


def polish(tau, low, high, side, v0, F0, s0, c0, below, above, K):
    """Return the contact in [low, high], searched from `tau` on by roots of local polynomials of the exact flow.

    The gap is positive at `low`; a step that leaves the bracket, which narrows, is replaced by halving it.
    """
    slack = 4.0 * EPS * high
    for _ in range(MOST_HALVINGS):
        dx, dv, F, G1, G2, G3, s, c, E0, E1, E2 = state_at(tau, v0, F0, s0, c0, K)
        over = below + dv if side < 0 else dv - above
        if side * over < 0.0:
            low = tau if tau > low else low
        elif tau < high:
            high = tau
        shift = local_root(over, F, G1, G2, G3, EPS * tau)
        inside = low - slack <= tau + shift <= high + slack
        if not inside:
            shift = 0.5 * (low + high) - tau
        if abs(shift) * K.rate < NEAR and (inside or high - low <= slack):
            dx = dx + (v0 + dv + (0.5 * F + SIXTH * (G1 + 0.25 * G2 * shift) * shift) * shift) * shift
            fifth = fifth_derivative(G3, G2, c, K)
            F = F + (G1 + (0.5 * G2 + SIXTH * (G3 + 0.25 * fifth * shift) * shift) * shift) * shift
            s, c = turned(s, c, K.Om * shift)
            tau = tau + shift
            return HIT, side, tau, dx, dv, F, G1, s, c, E0, E1, E2
        tau = tau + shift
    return STALLED, side, tau, dx, dv, F, G1, s, c, E0, E1, E2


def local_root(over, F, G1, G2, G3, resolution):
    """Return the root near 0 of over + F s + G1 s^2/2 + G2 s^3/6 + G3 s^4/24, by Newton's method.

    A simple root so near that the inverted series has it to `resolution` needs no step, one farther off takes a step or
    two after the series, a multiple root as many as it needs.
    """
    s = 0.0 * resolution
    if abs(over * G1) < 0.1 * F * F:
        inverse = 1.0 / F
        linear = over * inverse
        B, W = 0.5 * G1 * inverse * linear, SIXTH * G2 * inverse * linear * linear
        s = -linear * (1.0 + B + 2.0 * B * B - W)
        missing = 8.0 * abs(B) * (B * B + abs(W)) + abs(G3 * inverse * linear * linear * linear)
        if abs(linear) * missing <= resolution:
            return s
    for _ in range(MOST_NEWTON):
        slope = F + (G1 + (0.5 * G2 + SIXTH * G3 * s) * s) * s
        if slope == 0.0:
            break
        change = (over + (F + (0.5 * G1 + SIXTH * (G2 + 0.25 * G3 * s) * s) * s) * s) / slope
        s = s - change
        bend, third = G1 + (G2 + 0.5 * G3 * s) * s, G2 + G3 * s
        # The next step would be shorter than that.
        if change * change * (abs(bend) + abs(third * change)) <= resolution * abs(slope):
            break
    return s


def turned(s, c, angle):
    """Return the sine and cosine of a phase that goes on by a small angle, by Taylor's formula."""
    half = 0.5 * angle
    sixth = SIXTH * angle * angle
    last = 0.25 * angle * sixth
    return s + (c - (s * half + c * sixth - s * last)) * angle, c - (s + (c * half - s * sixth - c * last)) * angle
