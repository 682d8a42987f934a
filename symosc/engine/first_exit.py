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
immediate return is not missed. Where the closed form is cheap, `march` goes ahead with the same bound in fixed steps,
and mostly finds the one step in which a wall is met, so that no search of the kind above is needed.

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

from symosc.engine.flow import derivatives, fifth_derivative, state_at, turned
from symosc.engine.gap_bounds import (
    CLEAR_DEPTH,
    ISOLATED,
    NEAR,
    fourth_derivative_bound,
    gap_bound,
    gap_to,
    is_near,
    local_root,
    positive_on,
    quartic_start,
    safe_step,
)
from symosc.engine.march import march, whole
from symosc.engine.state import HIT, LOST, NOTHING, STALLED, TANGENCY, FlightEnd, Flown
from symosc.engine.touches import ROUNDING, closest_approach, hidden
from symosc.kernels.entire import EPS, SIXTH

# Steps shorter than this (times 1/rate) are a sign of a tangency ahead.
SHORT_STEP = 4e-3
MOST_STEPS = 20000
# Short steps on which no minimum of the gap was found ahead, before the search is given up.
MOST_STALLS = 30
# Steps to a contact in its bracket (halving alone takes as many as there are bits).
MOST_HALVINGS = 400
# A gap smaller than this part of the velocities in question is compared with its error.
THIN = 1e-9
# An error of the start that is smaller than THIN times the root of this part of the velocities is rounding.
FAINT = 1e-8


def first_exit(tau_max, start, walls, S, K):
    """Return the first contact of a flight with a wall within tau_max, a `FlightEnd`.

    Its code is NOTHING (at tau_max), HIT, TANGENCY or STALLED. A contact is returned even if the last correction moved
    it past tau_max. `start` is a Launch, `walls` are Walls, S is the Covariance of the errors of the start.
    """
    now, flat = search_start(tau_max, start, walls, K)
    margins = error_margins(start, S, K)
    if K.apart and not flat:
        now, M4, side, there = march(tau_max, start.v, now, walls, margins[1], K)
        if side != 0:
            tau = between(now, there, side, start.v, walls, K)
            return polish(tau, now.tau, there.tau, side, start, walls, K)
    else:
        M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
    return stepped(tau_max, now, M4, margins, start, walls, S, K)


def stepped(tau_max, now, M4, margins, start, walls, S, K):
    """Return what `first_exit` returns, by safe steps from `now` on: where marching has not decided."""
    thin, margin = margins
    code, tau, low, high = STALLED, now.tau, now.tau, now.tau  # what was found, where, and in which bracket
    crossing, tau_deep, stalled = 0, now.tau, 0  # the side on which the gap is known to be negative, and where
    for _ in range(MOST_STEPS):
        side = hidden_side(now, thin, start, walls, S, K)
        if side != 0 or now.tau >= tau_max:
            code = STALLED if side != 0 else NOTHING
            break
        cap = tau_max - now.tau
        if not K.steady and cap * K.Om > 1.0:
            cap = 1.0 / K.Om
        side, step, root, P = nearest_root(cap, now, M4, margin, walls)
        known, near, close, clear = crossing == side, False, False, True
        if root < cap:
            near, close, clear = is_near(root, P, M4, size_of_gap(side, root, now, margin, walls), K)
        if near and (clear or known):
            low, high = now.tau, tau_deep if known else now.tau + 2.0 * (root + ISOLATED * K.moment)
            code, tau = HIT, now.tau + (root if close else sharpened(root, side, now, walls, K))
            break
        short = step < cap and step * K.rate < SHORT_STEP
        if (short or not clear or is_beside(side, now, margin, walls)) and not known and may_touch(side, now, walls):
            verdict, tau = touch_ahead(now, side, step, M4, start, walls, S, K)
            if verdict in (TANGENCY, LOST):
                code = TANGENCY if verdict == TANGENCY else STALLED
                break
            if verdict == HIT:
                crossing, tau_deep = side, tau
            elif verdict == NOTHING:
                step = tau - now.tau if tau - now.tau < cap else cap
            elif short:
                stalled = stalled + 1
        if step <= 0.0 or stalled > MOST_STALLS:
            break
        low = now.tau
        now = state_at(low + step if step < tau_max - low else tau_max, start, K)
        M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
        behind = side_behind(now, walls)
        if behind != 0:
            side, high = behind, now.tau
            code, tau = (HIT, high) if crossing == side else overshot(now, low, side, M4, start, walls, S, K)
            break
    if code == TANGENCY:
        return FlightEnd(TANGENCY, side, state_at(tau, start, K))
    return polish(tau, low, high, side, start, walls, K) if code == HIT else FlightEnd(code, side, now)


def search_start(tau_max, start, walls, K):
    """Return where the search begins, and whether that is behind a flat start: after a tangency or the end of a stick.

    A derivative within rounding of 0 is 0 there, its sign is noise. Near sin(theta) = +-1 that leaves cos(theta), and
    with it G2, uncertain by about sqrt(EPS).
    """
    v0, F0, s0, c0 = start
    zero = 0.0 * tau_max
    G1, G2, G3 = derivatives(v0, F0, s0, c0, K)
    at_rest = (walls.on_below or walls.on_above) and F0 == 0.0
    if at_rest and abs(G1) <= ROUNDING * EPS * (abs(K.w0sq * v0) + abs(K.fB)):
        G1 = zero
        if abs(G2) <= ROUNDING * sqrt(EPS) * abs(K.fB) * K.Om:
            return behind_flat_start(tau_max, G2, G3, start, K), True
    return Flown(zero, zero, zero, F0, G1, G2, G3, s0, c0, 1.0 + zero, zero, zero), False


def behind_flat_start(tau_max, G2, G3, start, K):
    """Return a point of a flight before which a gap that starts with its fourth power has no other root."""
    tau = quartic_start(G3, G2, start.s, start.c, K)
    return state_at(tau if tau < tau_max else tau_max, start, K)


def error_margins(start, S, K):
    """Return (thin, margin): a gap whose square is below `thin` is compared with its error; `margin` is held back.

    The margin is what the error of the start can do to a gap; where that is less than rounding `tolerance` sees to it.
    """
    speed = THIN * (abs(start.v) + (abs(start.F) + abs(K.f0)) * K.moment)
    variance = K.sigmas * K.sigmas * (S.S22 + K.w0sq * S.S11)
    return 4.0 * variance + speed * speed, sqrt(variance) if variance > FAINT * speed * speed else 0.0 * variance


def hidden_side(now, thin, start, walls, S, K):
    """Return the side of a wall whose gap is 0 as far as this precision tells, and stays so for a while; else 0."""
    below, above, has_below, has_above, on_below, on_above = walls
    below, above, away = below + now.dv, above - now.dv, now.tau > 0.0
    if has_below and below * below < thin and (away or not on_below) and hidden(now.tau, -1, start, walls, S, K):
        return -1
    if has_above and above * above < thin and (away or not on_above) and hidden(now.tau, 1, start, walls, S, K):
        return 1
    return 0


def nearest_root(cap, now, M4, margin, walls):
    """Return (side, step, root, P): the wall that allows the shorter safe step, and what `safe_step` says of it."""
    side = -1 if walls.has_below else 1
    P = gap_bound(side, now, M4, margin, walls)
    p0, p1, p2, p3, p4, _ = P
    step, root = safe_step(cap, p0, p1, p2, p3, p4)
    if walls.has_below and walls.has_above:  # the upper wall counts only if the lower one's step is too long for it
        Q = gap_bound(1, now, M4, margin, walls)
        p0, p1, p2, p3, p4, _ = Q
        if not positive_on(root if root < cap else step, p0, p1, p2, p3, p4):
            other, other_root = safe_step(cap, p0, p1, p2, p3, p4)
            if other < step:
                return 1, other, (cap if step < other_root else other_root), Q
            root = cap
    return side, step, root, P


def size_of_gap(side, root, now, margin, walls):
    """Return the size of the gap to a wall on the way to a root of its bound, and of what may be wrong with it."""
    start_gap = walls.below if side < 0 else walls.above
    return start_gap + abs(now.dv) + abs(now.F) * root + margin * (4.0 / CLEAR_DEPTH)


def is_beside(side, now, margin, walls):
    """Return whether a gap that shrinks is hardly larger than what the error of the start can do to it."""
    return margin > 0.0 and side * now.F > 0.0 and gap_to(side, now, walls) < 2.0 * margin


def may_touch(side, now, walls):
    """Return whether the gap to a wall may have a minimum ahead: not at a start on that wall."""
    return now.tau > 0.0 or (walls.below if side < 0 else walls.above) > 0.0


def touch_ahead(now, side, step, M4, start, walls, S, K):
    """Return what `closest_approach` says; STALLED where the other wall may come before."""
    verdict, tau_min = closest_approach(now.tau, now.tau, side, M4, start, walls, S, K)
    reach = tau_min - now.tau
    if walls.has_below and walls.has_above and verdict != STALLED and reach > step:
        p0, p1, p2, p3, p4, _ = gap_bound(-side, now, M4, 0.0 * step, walls)
        verdict = verdict if positive_on(reach, p0, p1, p2, p3, p4) else STALLED
    return verdict, tau_min


def side_behind(now, walls):
    """Return the side of a wall that is not ahead any more; else 0."""
    if walls.has_below and walls.below + now.dv <= 0.0:
        return -1
    return 1 if walls.has_above and walls.above - now.dv <= 0.0 else 0


def overshot(now, before, side, M4, start, walls, S, K):
    """Return (code, tau) of the contact that a safe step has met: a root within rounding, or a touch.

    By rounding: the bound has no root there.
    """
    verdict, tau_min = closest_approach(now.tau, before, side, M4, start, walls, S, K)
    if verdict == TANGENCY:
        return TANGENCY, tau_min
    return (STALLED if verdict == LOST else HIT), now.tau


def over_wall(side, now, walls):
    """Return the velocity minus that of the wall on a side."""
    return walls.below + now.dv if side < 0 else now.dv - walls.above


def between(now, there, side, v0, walls, K):
    """Return about the time of the only root of a gap between two points.

    A step of Newton's method from the secant's root on Hermite's cubic, with the secant's slope; then `sharpened`.
    """
    h, gap, beyond = there.tau - now.tau, gap_to(side, now, walls), -gap_to(side, there, walls)
    inverse = 1.0 / (gap + beyond)
    part = gap * inverse
    rest = 1.0 - part
    steeper, flatter = gap + beyond - side * h * now.F, gap + beyond - side * h * there.F
    better = part + part * rest * (rest * steeper - part * flatter) * inverse
    part = better if 0.0 < better < 1.0 else part
    if part < 0.5:
        return now.tau + sharpened(part * h, side, now, walls, K)
    return there.tau + sharpened((part - 1.0) * h, side, whole(there, v0, K), walls, K)


def sharpened(root, side, now, walls, K):
    """Return a root that a lower bound has placed, by one step of Halley's method on a polynomial of degree five.

    So one evaluation of the flow is enough to make it exact. The root is counted from `now`.
    """
    half, third, fourth = 0.5 * now.G1, SIXTH * now.G2, 0.25 * SIXTH * now.G3
    fifth = 0.05 * SIXTH * fifth_derivative(now.G3, now.G2, now.c, K)
    over = over_wall(side, now, walls)
    square = root * root  # terms in pairs: each waits for fewer others than in Horner's order
    value = (over + now.F * root) + square * ((half + third * root) + square * (fourth + fifth * root))
    slope = (now.F + now.G1 * root) + square * ((3.0 * third + 4.0 * fourth * root) + square * (5.0 * fifth))
    half_bend = (half + 3.0 * third * root) + square * (6.0 * fourth + 10.0 * fifth * root)
    below = slope * slope - value * half_bend
    shift = value * slope / below if below > 0.0 else 0.0 * value
    return root - shift if abs(shift) < 0.5 * abs(root) else root


def polish(tau, low, high, side, start, walls, K):
    """Return the contact in [low, high], searched from `tau` on by roots of local polynomials of the exact flow.

    The gap is positive at `low`. Mostly the first point is near enough; what else there is to do is done apart.
    """
    now, slack = state_at(tau, start, K), 4.0 * EPS * high
    over = over_wall(side, now, walls)
    low, high = narrowed(low, high, tau, side * over)
    shift = local_root(over, now.F, now.G1, now.G2, now.G3, EPS * tau)
    if abs(shift) * K.rate < NEAR and low - slack <= tau + shift <= high + slack:
        return FlightEnd(HIT, side, shifted(now, shift, start.v, K))
    return halved(now, shift, (low, high, slack), side, start, walls, K)


def narrowed(low, high, tau, beyond):
    """Return a bracket [low, high] of a contact without what a point in it rules out; the gap there is `-beyond`."""
    if beyond < 0.0:
        return (tau if tau > low else low), high
    return low, (tau if tau < high else high)


def halved(now, shift, bracket, side, start, walls, K):
    """Go on with what `polish` began at the point `now`, from which the contact looks to be a `shift` away.

    A step that leaves the bracket by more than the third entry of it is replaced by halving it; it narrows.
    """
    low, high, slack = bracket
    for _ in range(MOST_HALVINGS):
        tau = now.tau
        inside = low - slack <= tau + shift <= high + slack
        if not inside:
            shift = 0.5 * (low + high) - tau
        if abs(shift) * K.rate < NEAR and (inside or high - low <= slack):
            return FlightEnd(HIT, side, shifted(now, shift, start.v, K))
        now = state_at(tau + shift, start, K)
        over = over_wall(side, now, walls)
        low, high = narrowed(low, high, now.tau, side * over)
        shift = local_root(over, now.F, now.G1, now.G2, now.G3, EPS * now.tau)
    return FlightEnd(STALLED, side, now)


def shifted(now, shift, v0, K):
    """Return a point of a flight moved by so short a time that Taylor's formula has full precision."""
    _, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2 = now
    square = shift * shift
    dx = dx + ((v0 + dv) * shift + square * ((0.5 * F + SIXTH * G1 * shift) + square * (0.25 * SIXTH * G2)))
    fifth = fifth_derivative(G3, G2, c, K)
    F = F + (G1 + (0.5 * G2 + SIXTH * (G3 + 0.25 * fifth * shift) * shift) * shift) * shift
    s, c = turned(s, c, K.Om * shift)
    return Flown(now.tau + shift, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2)
