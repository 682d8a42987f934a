"""One step of a trajectory: find the next event, move there, resolve it.

The state between events is a plain tuple of numbers:

    mode         1, 2, 3 a domain; 4, 5 a stick on belt 1, 2
    at           1, 2 if the state is on that belt at the beginning of a flight, else 0
    n, theta     phase: forcing periods completed, and Omega t mod 2 pi
    x, v         position and velocity
    Fb, Fa       acceleration; on a belt the accelerations F^(below) and F^(above) of both sides
    S11 S12 S22  covariance of the error of (x, v) at a fixed time
    t, t_low     time, in two parts whose sum is right to far below an ulp

Phase and time are carried one beside the other: Omega t never loses digits however large t becomes, and t none however
slow the drive is.
"""

from __future__ import annotations

from math import acos, cos, sin, sqrt

from symosc.engine.first_exit import first_exit
from symosc.engine.flow import derivatives, state_at, velocity_scale
from symosc.engine.rests import beside_a_wall, creeps_for_ever, never_leaves
from symosc.engine.stick_exit import belt_exit, force_noise
from symosc.engine.switching import BELT, DOMAIN_ABOVE, DOMAIN_BELOW, carried_error, resolve
from symosc.engine.touches import HIT, NOTHING, STALLED, TANGENCY
from symosc.kernels._generated import acceleration
from symosc.kernels.entire import EPS, SERIES_BELOW, SIXTH

# What a step ends with; the first four are the kinds of events.
CROSS, STICK, SLIP, GRAZE, MOVED, END, REST, FAILED = 1, 2, 3, 4, 5, 6, 7, 8

TWO_PI = 2.0 * acos(-1.0)
TWO_PI_REST = 2.4492935982947064e-16  # 2 pi - TWO_PI
MANY_TURNS = 64.0
# A search ends a little later than the motion: a contact exactly at its end would else not be found, nor excluded.
PAST_END = 1e-9
# A force on a belt is compared with its rounding error when it is smaller than this part of the friction's jump.
NEAR_FORCE = 0.5


def advance(mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, t_end, t_end_low, K):
    """Advance a state to its next event, or to the end of a stretch without events.

    Parameters
    ----------
    mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low : the state, see the module's docstring.
    t_end, t_end_low : time at which the simulation ends, in two parts.
    K : Constants

    Returns
    -------
    (code, boundary, decided, t_error, state...)
        code CROSS, STICK, SLIP, GRAZE (an event on `boundary`), MOVED (no event, the search goes on from here), END,
        REST (no event will come any more; at rest or in a steady motion) or FAILED. `decided` is False when the outcome
        depends on less than the rounding error. t_error is the standard error of the event's time. The new state has
        the same thirteen entries.
    """
    left = (t_end - t) + (t_end_low - t_low)
    tau_max = left if left < K.chunk else K.chunk
    if mode > 3:
        return advance_stick(mode, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, left, tau_max, K)
    return advance_flight(mode, at, n, theta, x, v, Fb, S11, S12, S22, t, t_low, left, tau_max, K)


def advance_flight(mode, at, n, theta, x, v, F0, S11, S12, S22, t, t_low, left, tau_max, K):
    """Advance through a domain; see `advance`."""
    has_below, has_above = mode > 1, mode < 3
    lower, upper = (K.belt1 if mode == 2 else K.belt2), (K.belt1 if mode == 1 else K.belt2)
    if K.creeps and creeps_for_ever(v, F0, x, S11, S22, lower, upper, has_below, has_above, mode, K):
        return REST, 0, True, 0.0, mode, at, n, theta, x, v, F0, F0, S11, S12, S22, t, t_low
    s0, c0, A = sin(theta), cos(theta), (K.A1 if mode == 1 else K.A2 if mode == 2 else K.A3)
    on_below, on_above = at == mode - 1 and at > 0, at == mode
    while True:
        if tau_max >= left:
            tau_max = left + PAST_END * left if left > 0.0 else left
        code, side, tau, dx, dv, F, _, s, c, E0, E1, E2 = first_exit(
            tau_max, v, F0, s0, c0, v - lower.v, upper.v - v, has_below, has_above, on_below, on_above, S11, S12, S22, K
        )
        # Two searches must not meet where a belt is: each would leave a touch there to the other.
        if code != NOTHING or tau_max >= left or tau_max > 1.5 * K.chunk:
            break
        size = abs(v) + abs(dv) + (abs(F0) + abs(K.f0)) * K.moment
        if not beside_a_wall(v + dv, size, lower.v, upper.v, has_below, has_above):
            break
        tau_max = tau_max + 0.125 * K.chunk
    if tau > left and code != STALLED:
        code, tau = NOTHING, left
        dx, dv, F, _, _, _, s, c, E0, E1, E2 = state_at(left, v, F0, s0, c0, K)
    speed = abs(v) + velocity_scale(tau, v, F0, K)
    reach = tau if tau < K.swing else K.swing
    forces = abs(F0) + abs(A) + abs(K.f0)  # terms of the acceleration; behind a stick friction's jump was one of them
    if at > 0 and F0 == 0.0:
        forces = forces + (K.belt1.J if at == 1 else K.belt2.J)
    x_noise = 1.25 * EPS * (abs(x) + (speed + forces * reach) * reach + abs(v) * tau)
    turned = 0.5 * K.w0 * tau * (abs(E0) + K.w0 * abs(E1))  # phase of the free oscillation, as far as it lasts
    v_noise = 1.25 * EPS * ((2.0 + turned) * speed + forces * reach)
    if K.lasting:  # then the errors of the constants, the same in every flight, add up: not as independent ones
        x_noise = sqrt(x_noise * (x_noise + 2.0 * sqrt(S11)))
        v_noise = sqrt(v_noise * (v_noise + 2.0 * sqrt(S22)))
    S11, S12, S22 = carried_error(S11, S12, S22, E0, E1, E2, x_noise, v_noise, K)
    x = x + dx
    if code == NOTHING:
        if tau >= left:
            n, theta = later(n, theta, tau, K)
            t, t_low = added(t, t_low, tau, K)
            return END, 0, True, 0.0, mode, 0, n, theta, x, v + dv, F, F, S11, S12, S22, t, t_low
        if never_leaves(v + dv, F, s, c, S11, S22, lower.v, upper.v, has_below, has_above, mode, K):
            # The end is reached from the last start, in one piece.
            return REST, 0, True, 0.0, mode, at, n, theta, x - dx, v, F0, F0, S11, S12, S22, t, t_low
        n, theta = later(n, theta, tau, K)
        t, t_low = added(t, t_low, tau, K)
        v = v + dv
        F = acceleration(x, v, c, A, K.cm, K.w0sq, K.f0)
        return MOVED, 0, True, 0.0, mode, 0, n, theta, x, v, F, F, S11, S12, S22, t, t_low
    n, theta = later(n, theta, tau, K)
    t, t_low = added(t, t_low, tau, K)
    boundary = mode - 1 if side < 0 else mode
    belt = K.belt1 if boundary == 1 else K.belt2
    v = belt.v
    if code == STALLED:
        return FAILED, boundary, False, 0.0, mode, at, n, theta, x, v, F, F, S11, S12, S22, t, t_low
    if code == TANGENCY:
        F = 0.0 * F
    elif tau * K.rate > SERIES_BELOW:  # after short flights `F` is the more accurate one: it grew from F0
        F = acceleration(x, v, c, A, K.cm, K.w0sq, K.f0)
    G1, G2, G3 = derivatives(v, F, s, c, K)
    t_error = passing_time(sqrt(S22), F, G1, G2, K)
    doubt = 2.0 * K.sigmas * t_error  # a gap that is F^2/(2 G1) deep is open if its error is as large as that
    vague = abs(F) <= (abs(G1) + abs(G2) * doubt) * doubt  # as far as this precision tells the acceleration is 0 here
    if vague or code == TANGENCY:
        vague = True
        inflection = side * G2 > abs(G3) * doubt and abs(G1) <= abs(G2) * doubt
        speed_up, F = F, 0.0 * F
        if not inflection:
            if speed_up * G1 < 0.0:  # from a crossing that is none as far as this precision tells to the touch behind
                shift = min(-speed_up / G1, left - tau)
                x = x + (v + (0.5 * speed_up + SIXTH * G1 * shift) * shift) * shift
                n, theta = later(n, theta, shift, K)
                t, t_low = added(t, t_low, shift, K)
            t_error = passing_time(K.rate * (sqrt(S22) + v_noise), G1, G2, G3, K)
            touch = GRAZE if t_error < tau else FAILED  # a touch that may be anywhere in the flight is none
            return touch, boundary, False, t_error, mode, boundary, n, theta, x, v, F, F, S11, S12, S22, t, t_low
    Fb, Fa = (F, F - belt.J) if side > 0 else (F + belt.J, F)
    decided = not vague
    other = Fa if side > 0 else Fb
    small = abs(other) < NEAR_FORCE * belt.J
    if small and abs(other) <= force_noise(F, tau, S11, belt, K) + K.sigmas * K.cm * sqrt(S22):
        decided = False
        Fb, Fa = (Fb, 0.0 * Fa) if side > 0 else (0.0 * Fb, Fa)
    if vague:  # a triple root: the velocity goes on through that of the belt, as far as friction lets it
        where = BELT if belt.J > 0.0 else DOMAIN_ABOVE if side > 0 else DOMAIN_BELOW
    elif Fa > 0.0:
        where = DOMAIN_ABOVE
    elif Fb > 0.0 and Fa < 0.0:
        where = BELT
    else:
        where = resolve(v, Fb, Fa, s, c, K)
    if where == BELT:
        S12, S22 = 0.0 * S12, 0.0 * S22  # the belt takes the error of the velocity away
        return (
            STICK,
            boundary,
            decided,
            t_error,
            3 + boundary,
            boundary,
            n,
            theta,
            x,
            v,
            Fb,
            Fa,
            S11,
            S12,
            S22,
            t,
            t_low,
        )
    out = Fa if where == DOMAIN_ABOVE else Fb
    ratio = out / F if F != 0.0 else 1.0
    target = boundary + 1 if where == DOMAIN_ABOVE else boundary
    if target == mode:  # a hit whose speed is lost in rounding
        zero = 0.0 * F
        return GRAZE, boundary, False, t_error, mode, boundary, n, theta, x, v, zero, zero, S11, S12, S22, t, t_low
    S12, S22 = ratio * S12, ratio * ratio * S22
    return CROSS, boundary, decided, t_error, target, boundary, n, theta, x, v, out, out, S11, S12, S22, t, t_low


def advance_stick(mode, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, left, tau_max, K):
    """Advance along a belt; see `advance`."""
    boundary = mode - 3
    belt = K.belt1 if boundary == 1 else K.belt2
    s0, c0 = sin(theta), cos(theta)
    zero = 0.0 * Fb
    code, side, tau, Delta, slope, bend = belt_exit(tau_max, Fb, Fa, theta, s0, c0, S11, belt, K)
    if tau > left and code in (HIT, TANGENCY):
        code, tau = NOTHING, left
    noise = EPS * (abs(x) + 2.0 * abs(v) * tau)
    S11 = S11 + noise * noise
    x = x + v * tau
    if code == NOTHING:
        if tau >= left:
            Fb, Fa = Fb + Delta, Fa + Delta
            n, theta = later(n, theta, tau, K)
            t, t_low = added(t, t_low, tau, K)
            return END, 0, True, 0.0, mode, boundary, n, theta, x, v, Fb, Fa, S11, zero, zero, t, t_low
        if belt.drift == 0.0 and tau >= K.period:  # the forces repeat: no exit in one period means none ever
            return REST, 0, True, 0.0, mode, boundary, n, theta, x - v * tau, v, Fb, Fa, S11, zero, zero, t, t_low
        n, theta = later(n, theta, tau, K)
        t, t_low = added(t, t_low, tau, K)
        return MOVED, 0, True, 0.0, mode, boundary, n, theta, x, v, Fb + Delta, Fa + Delta, S11, zero, zero, t, t_low
    n, theta = later(n, theta, tau, K)
    t, t_low = added(t, t_low, tau, K)
    Fb, Fa = (zero, -belt.J) if side < 0 else (belt.J, zero)
    if code == STALLED:
        return FAILED, boundary, False, 0.0, mode, boundary, n, theta, x, v, Fb, Fa, S11, zero, zero, t, t_low
    if code == TANGENCY:
        return MOVED, 0, False, 0.0, mode, boundary, n, theta, x, v, Fb, Fa, S11, zero, zero, t, t_low
    A = K.A1 if side < 0 and boundary == 1 else K.A3 if side > 0 and boundary == 2 else K.A2
    terms = abs(A) + belt.J + abs(K.w0sq * x) + abs(K.cm * v) + abs(K.f0)
    force_error = K.w0sq * sqrt(S11) + EPS * (abs(belt.drift) * tau + terms)
    t_error = passing_time(force_error, slope, bend, K.fB * K.Om * K.Om, K)
    target = boundary if side < 0 else boundary + 1
    return SLIP, boundary, True, t_error, target, boundary, n, theta, x, v, zero, zero, S11, zero, zero, t, t_low


def later(n, theta, tau, K):
    """Return the phase `tau` later; a whole period leaves theta as it is, exactly."""
    if tau == K.period:
        return n + 1, theta
    theta = theta + K.Om * tau
    if theta >= MANY_TURNS * TWO_PI:  # without a drive, see `symosc.engine.flow`
        turns = int(theta / TWO_PI) - 1
        theta = (theta - turns * TWO_PI) - turns * TWO_PI_REST
        n = n + turns
    while theta >= TWO_PI:
        theta = (theta - TWO_PI) - TWO_PI_REST
        n = n + 1
    if theta < 0.0:  # by the rest of 2 pi
        theta = 0.0 * theta
    return n, theta


def added(t, t_low, tau, K):
    """Return t + t_low + tau in two parts (Knuth's sum)."""
    if tau == K.period:
        t_low = t_low + K.period_low
    total = t + tau
    part = total - t
    low = t_low + ((t - (total - part)) + (tau - part))
    t = total + low
    return t, low - (t - total)


def passing_time(error, first, second, third, K):
    """Return the time within which a quantity passes 0, given its error and its derivatives there."""
    speed = abs(first)
    if error * abs(second) < 1e-3 * speed * speed and error * error * abs(third) < 1e-3 * speed * speed * speed:
        return error / speed
    best = 1.0 / K.Om
    if error == 0.0:
        return 0.0 * best
    if first != 0.0:
        best = min(best, error / abs(first))
    if second != 0.0:
        best = min(best, sqrt(2.0 * error / abs(second)))
    return min(best, (6.0 * error / abs(third)) ** (2.0 * SIXTH)) if third != 0.0 else best
