"""One step of a trajectory: find the next event, move there, resolve it.

A step takes a `State` and returns a `NextEvent` (`symosc.engine.state`).
"""

from __future__ import annotations

from math import acos, cos, sin, sqrt

from symosc.engine.first_exit import first_exit
from symosc.engine.flow import constant_force, derivatives, speeds_around, state_at, velocity_scale
from symosc.engine.rests import beside_a_wall, creeps_for_ever, never_leaves
from symosc.engine.state import (
    BELT,
    CROSS,
    DOMAIN_ABOVE,
    DOMAIN_BELOW,
    END,
    FAILED,
    GRAZE,
    HIT,
    MOVED,
    NOTHING,
    ON_BELT,
    REST,
    SLIP,
    STALLED,
    STICK,
    TANGENCY,
    Covariance,
    FlightEnd,
    Hold,
    Launch,
    NextEvent,
    State,
    Walls,
)
from symosc.engine.stick_exit import belt_exit, force_noise
from symosc.engine.switching import carried_error, resolve
from symosc.kernels._generated import acceleration
from symosc.kernels.double_double import rest_of_product
from symosc.kernels.entire import EPS, SERIES_BELOW, SIXTH

TWO_PI = 2.0 * acos(-1.0)
TWO_PI_REST = 2.4492935982947064e-16  # 2 pi - TWO_PI
MANY_TURNS = 64.0
# A search ends a little later than the motion: a contact exactly at its end would else not be found, nor excluded.
PAST_END = 1e-9
# A force on a belt is compared with its rounding error when it is smaller than this part of the friction's jump.
NEAR_FORCE = 0.5


def advance(state, t_end, t_end_low, K):
    """Advance a state to its next event, or to the end of a stretch without events.

    Parameters
    ----------
    state : State
    t_end, t_end_low : time at which the simulation ends, in two parts.
    K : Constants

    Returns
    -------
    NextEvent
        Its code is CROSS, STICK, SLIP, GRAZE (an event on `boundary`), MOVED (no event, the search goes on from here),
        END, REST (no event will come any more; at rest or in a steady motion: the state is the last start, from which
        the end is reached in one piece) or FAILED.
    """
    left = (t_end - state.t) + (t_end_low - state.t_low)
    if state.mode > ON_BELT:
        return advance_stick(state, left, K)
    return advance_flight(state, left, K)


def advance_flight(state, left, K):
    """Advance through a domain, for the time `left` at most; see `advance`."""
    if K.creeps and creeps_for_ever(state, K):
        return NextEvent(REST, 0, True, 0.0, state)
    start, walls = launched(state, K)
    tau_max = reach_of(left if left < K.chunk else K.chunk, left)
    end = first_exit(tau_max, start, walls, state.S, K)
    if end.code == NOTHING and tau_max < left:
        end = apart_from_walls(end, tau_max, left, state, start, walls, K)
    return after_flight(state, end, start, left, K)


def launched(state, K):
    """Return the launch of a flight, and the walls around it."""
    mode, at, v = state.mode, state.at, state.v
    lower, upper = speeds_around(mode, K)
    walls = Walls(v - lower, upper - v, mode > 1, mode < 3, at > 0 and at == mode - 1, at == mode)
    return Launch(v, state.Fb, state.s, state.c), walls


def after_flight(state, end, start, left, K):
    """Return the next event of a flight from `state`, given its `start` and how its search ended; see `advance`."""
    mode, at, n, theta, x, v, F, _, S, t, t_low, s, c, theta_low = state
    lower, upper = speeds_around(mode, K)
    if end.now.tau > left and end.code != STALLED:
        end = FlightEnd(NOTHING, 0, point_at_end(left, start, K))
    code, side, now = end
    x_noise, v_noise = flight_noise(state, now, K)
    S = carried_error(S, now, x_noise, v_noise, K)
    turns, theta, theta_low = later(0, theta, theta_low, now.tau, K)
    n, s, c = n + turns, now.s, now.c
    if turns > 0:
        s, c = sine_and_cosine_of(theta)
    t, t_low = added(t, t_low, now.tau, K)
    x, F = x + now.dx, now.F
    if code == NOTHING:
        there = State(mode, 0, n, theta, x, v + now.dv, F, F, S, t, t_low, s, c, theta_low)
        return no_contact(state, there, now, left, lower, upper, K)
    boundary = mode - 1 if side < 0 else mode
    v = K.belt1.v if boundary == 1 else K.belt2.v
    if code == STALLED:
        return NextEvent(
            FAILED, boundary, False, 0.0, State(mode, at, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low)
        )
    if code == TANGENCY:
        F = 0.0 * F
    elif now.tau * K.rate > SERIES_BELOW:  # after short flights `F` is the more accurate one: it grew from F0
        F = acceleration(x, v, now.c, constant_force(mode, K), K.cm, K.w0sq, K.f0)
    return meet_belt(State(mode, boundary, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low), end, v_noise, left, K)


def reach_of(tau_max, left):
    """Return how far a search goes that is to reach `tau_max`, or the end of the motion if that is nearer."""
    if tau_max >= left:
        return left + PAST_END * left if left > 0.0 else left
    return tau_max


def apart_from_walls(end, tau_max, left, state, start, walls, K):
    """Return the end of a search that goes on until it is not near a belt: nobody would find a touch there.

    Two searches must not meet where a belt is: each would leave a touch there to the other.
    """
    while end.code == NOTHING and tau_max < left and tau_max <= 1.5 * K.chunk:
        if not ends_beside_wall(state, end.now, K):
            break
        tau_max = reach_of(tau_max + 0.125 * K.chunk, left)
        end = first_exit(tau_max, start, walls, state.S, K)
    return end


def ends_beside_wall(state, now, K):
    """Return whether a flight from `state` is so near a wall at the point `now` that a touch may be here."""
    v, (lower, upper) = state.v, speeds_around(state.mode, K)
    size = abs(v) + abs(now.dv) + (abs(state.Fb) + abs(K.f0)) * K.moment
    return beside_a_wall(v + now.dv, size, lower, upper)


def point_at_end(left, start, K):
    """Return where a flight is at the end of the motion, which a search has passed."""
    return state_at(left, start, K)


def no_contact(state, there, now, left, lower, upper, K):
    """Return what a flight from `state` ends with at `there` (`Flown` now) without a contact: see `advance`."""
    if now.tau >= left:
        return NextEvent(END, 0, True, 0.0, there)
    if never_leaves(Launch(there.v, there.Fb, now.s, now.c), there.S, lower, upper, there.mode, K):
        return NextEvent(REST, 0, True, 0.0, state)
    mode, at, n, theta, x, v, _, _, S, t, t_low, _, _, theta_low = there
    F = acceleration(x, v, now.c, constant_force(mode, K), K.cm, K.w0sq, K.f0)
    s, c = sine_and_cosine_of(theta)
    return NextEvent(MOVED, 0, True, 0.0, State(mode, at, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low))


def flight_noise(state, now, K):
    """Return the rounding errors that a flight from `state` to `now` adds to x and v."""
    tau, v0, F0, S = now.tau, state.v, state.Fb, state.S
    speed = abs(v0) + velocity_scale(tau, v0, F0, K)
    reach = tau if tau < K.swing else K.swing
    # terms of the acceleration; behind a stick friction's jump was one of them
    forces = abs(F0) + abs(constant_force(state.mode, K)) + abs(K.f0)
    if state.at > 0 and F0 == 0.0:
        forces = forces + (K.belt1.J if state.at == 1 else K.belt2.J)
    x_noise = 1.25 * EPS * (abs(state.x) + (speed + forces * reach) * reach + abs(v0) * tau)
    turned = 0.5 * K.w0 * tau * (abs(now.E0) + K.w0 * abs(now.E1))  # phase of the free oscillation, as far as it lasts
    v_noise = 1.25 * EPS * ((2.0 + turned) * speed + forces * reach)
    if K.lasting:  # then the errors of the constants, the same in every flight, add up: not as independent ones
        x_noise = sqrt(x_noise * (x_noise + 2.0 * sqrt(S.S11)))
        v_noise = sqrt(v_noise * (v_noise + 2.0 * sqrt(S.S22)))
    return x_noise, v_noise


def meet_belt(there, end, v_noise, left, K):
    """Return what happens where a flight meets a belt.

    Parameters
    ----------
    there : State at the contact, in the domain that the flight comes from.
    end : FlightEnd
    v_noise : rounding error of the flight's velocity.
    left : time that was left at the start of the flight.
    K : Constants
    """
    F, now = there.Fb, end.now
    G1, G2, G3 = derivatives(there.v, F, now.s, now.c, K)
    t_error = passing_time(sqrt(there.S.S22), F, G1, G2, K)
    doubt = 2.0 * K.sigmas * t_error  # a gap that is F^2/(2 G1) deep is open if its error is as large as that
    # As far as this precision tells the acceleration is 0 here.
    vague = end.code == TANGENCY or abs(F) <= (abs(G1) + abs(G2) * doubt) * doubt
    if vague and not (end.side * G2 > abs(G3) * doubt and abs(G1) <= abs(G2) * doubt):
        return touch_belt(there, G1, G2, G3, v_noise, now.tau, left, K)
    return switch(there, end, vague, t_error, K)


def touch_belt(there, G1, G2, G3, v_noise, tau, left, K):
    """Return the graze at a contact `tau` after the start of a flight, with the derivatives of its acceleration."""
    mode, boundary, n, theta, x, v, F, _, S, t, t_low, s, c, theta_low = there
    if F * G1 < 0.0:  # from a crossing that is none as far as this precision tells to the touch behind
        shift = min(-F / G1, left - tau)
        x = x + (v + (0.5 * F + SIXTH * G1 * shift) * shift) * shift
        n, theta, theta_low = later(n, theta, theta_low, shift, K)
        t, t_low = added(t, t_low, shift, K)
        s, c = sin(theta), cos(theta)
    t_error = passing_time(K.rate * (sqrt(S.S22) + v_noise), G1, G2, G3, K)
    code = GRAZE if t_error < tau else FAILED  # a touch that may be anywhere in the flight is none
    F = 0.0 * F
    return NextEvent(
        code, boundary, False, t_error, State(mode, boundary, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low)
    )


def switch(there, end, vague, t_error, K):
    """Return the event at a contact by Theorems 4 and 5: a stick or a crossing.

    A `vague` contact is a triple root: the velocity goes on through that of the belt, as far as friction lets it.
    """
    mode, boundary, n, theta, x, v, F, _, S, t, t_low, s, c, theta_low = there
    belt, upward, now = (K.belt1 if boundary == 1 else K.belt2), end.side > 0, end.now
    if vague:
        F = 0.0 * F
    Fb, Fa = (F, F - belt.J) if upward else (F + belt.J, F)
    decided = not vague
    other = Fa if upward else Fb
    small = abs(other) < NEAR_FORCE * belt.J
    if small and abs(other) <= force_noise(F, now.tau, S.S11, belt, K) + K.sigmas * K.cm * sqrt(S.S22):
        decided = False
        Fb, Fa = (Fb, 0.0 * Fa) if upward else (0.0 * Fb, Fa)
    if vague:
        where = BELT if belt.J > 0.0 else DOMAIN_ABOVE if upward else DOMAIN_BELOW
    elif Fa > 0.0:
        where = DOMAIN_ABOVE
    elif Fb > 0.0 and Fa < 0.0:
        where = BELT
    elif Fb < 0.0:
        where = DOMAIN_BELOW
    else:
        where = resolve(v, Fb, Fa, now.s, now.c, K)
    if where == BELT:
        S = Covariance(S.S11, 0.0 * S.S12, 0.0 * S.S22)  # the belt takes the error of the velocity away
        held = State(ON_BELT + boundary, boundary, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)
        return NextEvent(STICK, boundary, decided, t_error, held)
    out = Fa if where == DOMAIN_ABOVE else Fb
    target = boundary + 1 if where == DOMAIN_ABOVE else boundary
    if target == mode:  # a hit whose speed is lost in rounding
        zero = 0.0 * F
        touched = State(mode, boundary, n, theta, x, v, zero, zero, S, t, t_low, s, c, theta_low)
        return NextEvent(GRAZE, boundary, False, t_error, touched)
    ratio = out / F if F != 0.0 else 1.0
    S = Covariance(S.S11, ratio * S.S12, ratio * ratio * S.S22)
    crossed = State(target, boundary, n, theta, x, v, out, out, S, t, t_low, s, c, theta_low)
    return NextEvent(CROSS, boundary, decided, t_error, crossed)


def advance_stick(state, left, K):
    """Advance along a belt, for the time `left` at most; see `advance`."""
    belt = K.belt1 if state.mode == ON_BELT + 1 else K.belt2
    end = belt_exit(left if left < K.chunk else K.chunk, held_by(state), state.S.S11, belt, K)
    return after_stick(state, end, left, K)


def held_by(state):
    """Return the beginning of a stick."""
    return Hold(state.Fb, state.Fa, state.theta, state.s, state.c)


def after_stick(state, end, left, K):
    """Return the next event of a stick from `state`, given how its search ended; see `advance`."""
    mode, boundary, n, theta, x, v, Fb, Fa, S, t, t_low, _, _, theta_low = state
    boundary, zero = mode - ON_BELT, 0.0 * Fb
    belt = K.belt1 if boundary == 1 else K.belt2
    code, side, tau, Delta, slope, bend, s, c = end
    if tau > left and code in (HIT, TANGENCY):
        code, tau = NOTHING, left
    if code == NOTHING and tau < left and belt.drift == 0.0 and tau >= K.period:
        return NextEvent(REST, 0, True, 0.0, state)  # the forces repeat: no exit in one period means none ever
    noise = EPS * (abs(x) + 2.0 * abs(v) * tau)
    S = Covariance(S.S11 + noise * noise, zero, zero)
    x = x + v * tau
    turns, theta, theta_low = later(0, theta, theta_low, tau, K)
    n = n + turns
    if code != HIT or turns > 0:
        s, c = sine_and_cosine_of(theta)
    t, t_low = added(t, t_low, tau, K)
    if code == NOTHING:
        held = State(mode, boundary, n, theta, x, v, Fb + Delta, Fa + Delta, S, t, t_low, s, c, theta_low)
        return NextEvent(END if tau >= left else MOVED, 0, True, 0.0, held)
    if code != HIT:
        Fb, Fa = (zero, -belt.J) if side < 0 else (belt.J, zero)
        held = State(mode, boundary, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)
        return NextEvent(MOVED if code == TANGENCY else FAILED, 0 if code == TANGENCY else boundary, False, 0.0, held)
    target = boundary if side < 0 else boundary + 1
    terms = abs(constant_force(target, K)) + belt.J + abs(K.w0sq * x) + abs(K.cm * v) + abs(K.f0)
    force_error = K.w0sq * sqrt(S.S11) + EPS * (abs(belt.drift) * tau + terms)
    t_error = passing_time(force_error, slope, bend, K.fB * K.Om * K.Om, K)
    slipped = State(target, boundary, n, theta, x, v, zero, zero, S, t, t_low, s, c, theta_low)
    return NextEvent(SLIP, boundary, True, t_error, slipped)


def later(n, theta, theta_low, tau, K):
    """Return the phase `tau` later, in two parts: what rounding takes from it would add up to a wrong time."""
    if tau == K.period:  # exactly
        return n + 1, theta, theta_low
    turn = K.Om * tau
    total = theta + turn
    part = total - theta
    low = (theta - (total - part)) + (turn - part)
    rest = rest_of_product(K.Om, tau)
    theta, theta_low = total, theta_low + (low + rest if abs(rest) < 1.0 else low)  # else out of the range of doubles
    if theta >= MANY_TURNS * TWO_PI:  # without a drive, see `symosc.engine.flow`
        turns = int(theta / TWO_PI) - 1
        theta = (theta - turns * TWO_PI) - turns * TWO_PI_REST
        n = n + turns
    while theta >= TWO_PI:
        theta, theta_low = theta - TWO_PI, theta_low - TWO_PI_REST
        n = n + 1
    total = theta + theta_low
    theta_low = theta_low - (total - theta)
    if total < 0.0:  # by the rest of 2 pi
        return n, 0.0 * total, theta_low + total
    return n, total, theta_low


def sine_and_cosine_of(theta):
    """Return the sine and the cosine of a phase, without rounding errors from before."""
    return sin(theta), cos(theta)


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
    return slow_passing_time(error, first, second, third, K)


def slow_passing_time(error, first, second, third, K):
    """Return what `passing_time` does where the first derivative alone does not decide."""
    best = 1.0 / K.Om
    if error == 0.0:
        return 0.0 * best
    if first != 0.0:
        best = min(best, error / abs(first))
    if second != 0.0:
        best = min(best, sqrt(2.0 * error / abs(second)))
    return min(best, (6.0 * error / abs(third)) ** (2.0 * SIXTH)) if third != 0.0 else best
