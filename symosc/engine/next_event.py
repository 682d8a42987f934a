"""One step of a trajectory: find the next event, move there, and decide what happens (Theorems 4, 5
and 6).

This file is executed with other globals: see symosc/kernels/rebind.py.

At a point of the boundary with domain `below` and domain `above` (n = (0, 1), so that G^(0) is the
acceleration)

- stick (Theorem 4) iff F^(below) + E > 0 > F^(above) - E, where E is what static friction adds to
  kinetic friction (0 in the paper);
- passing (Theorem 5) iff these two have one sign: upward if positive, downward if negative;
- where a force vanishes, the sign of its first G-function that does not vanish takes its place
  (Luo): it is the sign that the force has immediately afterwards.

A tangency from below (Theorem 6) has F^(below) = 0 and a negative first G-function of odd order,
one from above a positive one. Where E > 0 it lies inside the range of forces that hold the mass: a
graze of such a belt is the onset of a stick.

At a corner, where only the slope of the friction changes, the force and all G-functions that follow
from it agree on both sides: the motion goes on where they say, nothing sticks, and a touch is no
event, since both sides take it along the same way (`meet_corner`).

During a stick the state has F^(below) + E and F^(above) - E for forces (`held_forces`), in a flight
the acceleration: it begins with E, or -E, behind a stick.

A flight has no end if it meets no belt any more. Three arguments show that, each for all times to
come:

- the steady velocity and the energy of the transient bound the velocity (`never_leaves`);
- without a spring the transient is one exponential, which does the same;
- without a drive and without oscillation (B0 = 0, critical or overdamped) the gap g = +-(v -
  v_lambda) obeys L g = r with a constant r = -+(k/m) v_lambda. With the fast root l2 of L the
  function u = g' - l2 g obeys u' = l1 u + r. So u >= 0 and r >= 0 keep u >= 0, and g' >= l2 g keeps
  g > 0: the gap may shrink without end, but it never closes (`creeps_for_ever`). For k = 0 u is
  constant, a rational number whose sign is exact. About an exact start
  `symosc.engine.start.settles` decides the same in rational numbers, before anything is simulated.

Arguments that many functions share: `state` is the State before the step, `start` the Launch of its
flight, `walls` the gaps then, `now` a point of the flight and `there` the State at it. `remaining`
is the time from `state` to the end of the motion, t_end + t_end_low, and `tau_max` that to the end
of the search. `v_noise` is the rounding error of the velocity, `S` the covariance of the errors of
x and v, and `s`, `c` are sine and cosine of the phase.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on pairs and
mpmath numbers; `0.0 * F` is a zero of the same kind of number as F.
"""

from __future__ import annotations

from math import acos, inf, sqrt

from symosc.engine.first_exit import (
    MARCH_SLACK,
    ROUNDING,
    belt_exit,
    contact_at_dip,
    contact_near,
    first_exit,
    force_noise,
    march,
    search_begin,
    slip_near,
)
from symosc.engine.flow import (
    belt_at,
    clock_time,
    constant_force,
    derivatives,
    held_forces,
    sine_and_cosine,
    speeds_around,
    state_at,
    velocity_scale,
)
from symosc.engine.state import (
    BELT,
    CROSS,
    DOMAIN_ABOVE,
    DOMAIN_BELOW,
    END,
    FAILED,
    GRAZE,
    HIT,
    MIDDLE,
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
    Launch,
    NextEvent,
    State,
    Walls,
)
from symosc.kernels._generated import acceleration, next_derivative
from symosc.kernels.double_double import two_product
from symosc.kernels.elementary import select
from symosc.kernels.entire import EPS, SERIES_BELOW, SIXTH
from symosc.kernels.rebind import outlined

TWO_PI = 2.0 * acos(-1.0)
TWO_PI_REST = 2.4492935982947064e-16  # 2 pi - TWO_PI
MANY_TURNS = 64.0  # from so many on, whole turns are taken off a phase by a division
# A search ends a little later than the motion: a contact exactly at its end would else not be
# found, nor excluded.
PAST_END = 1e-9
# A force on a belt is compared with its rounding error when it is smaller than this part of the
# friction's jump.
NEAR_FORCE = 0.5
# A gap below this part of the velocities in question is too small to begin a new search with.
BESIDE = 1e-6
# G-functions are evaluated up to this order before a force is taken to vanish for ever: their
# recurrence has four terms of history (position in the plane and two of the drive), so more than
# five zeros in a row mean all.
HIGHEST_ORDER = 6
# A G-function below this times EPS and the sum of its terms is taken as 0: its zero is the exact
# case in question.
G_ROUNDING = 32.0
# With many digits a root is that of doubles if it is within twice the error that their decisions
# exceed (`symosc.engine.flow.SIGMAS`), and within this part of the time, which rounding takes.
SEARCH_SIGMAS = 16.0
TIME_ROUNDING = 2.0**-50
# Errors of x and v behind a slip are correlated but for this part of the variance.
UNCORRELATED = 2.0**-20
# A flight without an event is taken over from doubles if its search was not made longer
# (`apart_from_walls`, which adds eighths of `K.chunk`).
USUAL_LENGTH = 1.0625


def advance(state, t_end, t_end_low, K):
    """Advance `state` to its next event or, without one, to the end of a search interval.

    Return a `NextEvent`.
    """
    # Its code is CROSS, STICK, SLIP, GRAZE (an event on `boundary`), MOVED (no event, the search
    # goes on from here), END, REST (no event will come any more; at rest or in a steady motion: the
    # state is the last start, from which the end is reached in one piece) or FAILED. The simulation
    # ends at the time t_end + t_end_low.
    remaining = (t_end - state.t) + (t_end_low - state.t_low)
    if remaining < K.chunk:
        tau_max = remaining
    else:
        tau_max = K.chunk
    if state.mode > ON_BELT:
        belt = belt_at(state.mode - ON_BELT, K)
        return after_stick(state, belt_exit(tau_max, state, belt, K), remaining, K)
    if K.creeps and creeps_for_ever(state, K):
        return NextEvent(REST, 0, True, 0.0, state)
    if K.banded and rests_on_corner(state, K):
        return NextEvent(REST, 0, True, 0.0, state)
    start, walls = launched(state, K)
    tau_max = past_end(tau_max, remaining)
    end = first_exit(tau_max, start, walls, state.S, K)
    if end.code == NOTHING and tau_max < remaining:
        end = apart_from_walls(end, tau_max, remaining, state, start, walls, K)
    return after_flight(state, end, start, remaining, K)


# --- bands ---


def band_beyond(mode, K):
    """Return the way to the row of constants in which a motion goes on: -1 or 1 if it has left the
    middle domain of the row K, else 0.
    """
    if not K.banded or mode == MIDDLE or mode > ON_BELT:
        return 0
    return mode - MIDDLE


def entered(state, way):
    """Return a state that has left the middle domain of its row by `way`, as a state of the next
    row.
    """
    _, _, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low = state
    at = 1 if way > 0 else 2
    return State(MIDDLE, at, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)


# --- flights ---


def launched(state, K):
    """Return the Launch of a flight that begins in `state`, and its Walls (the gaps to the belts
    beside it).
    """
    mode = state.mode
    at = state.at
    v = state.v
    lower, upper = speeds_around(mode, K)
    on_below = at > 0 and at == mode - 1
    walls = Walls(v - lower, upper - v, lower > -inf, upper < inf, on_below, at == mode)
    return Launch(v, state.Fb, state.s, state.c), walls


def past_end(tau_max, remaining):
    """Return how far to search: `tau_max` or, if a motion ends before, to just behind its end in
    `remaining` time.
    """
    if tau_max >= remaining:
        if remaining > 0.0:
            return remaining + PAST_END * remaining
        return remaining
    return tau_max


@outlined
def apart_from_walls(end, tau_max, remaining, state, start, walls, K):
    """Prolong a flight's search if its `end`, at `tau_max`, is so near a wall that it may graze.

    Return the end.
    """
    # Two searches must not meet where a belt is: each would leave a touch there to the other.
    while end.code == NOTHING and tau_max < remaining and tau_max <= 1.5 * K.chunk:
        if not ends_beside_wall(state, end.now, K):
            break
        tau_max = past_end(tau_max + 0.125 * K.chunk, remaining)  # an eighth of a chunk further
        end = first_exit(tau_max, start, walls, state.S, K)
    return end


def ends_beside_wall(state, now, K):
    """Return whether point `now` of the flight from `state` is so near a wall that a graze is
    possible there.
    """
    v = state.v
    (lower, upper) = speeds_around(state.mode, K)
    size = abs(v) + abs(now.dv) + (abs(state.Fb) + abs(K.f0)) * K.moment
    return v + now.dv - lower <= BESIDE * size or upper - (v + now.dv) <= BESIDE * size


def after_flight(state, end, start, remaining, K):
    """Return the NextEvent that follows from `end`, the FlightEnd found for the flight from
    `state`.
    """
    mode, at, n, theta, x, v, F, _, S, t, t_low, s, c, theta_low = state
    if end.now.tau > remaining and end.code != STALLED:
        end = FlightEnd(NOTHING, 0, point_at_end(remaining, start, K))
    code, side, now = end
    x_noise, v_noise = flight_noise(state, now, K)
    S = carried_error(S, now, x_noise, v_noise, K)
    turns, theta, theta_low = advance_phase(0, theta, theta_low, now.tau, K)
    n = n + turns
    s = now.s
    c = now.c
    if turns > 0:
        s, c = sine_and_cosine(theta, theta_low)
    t, t_low = advance_time(t, t_low, now.tau, K)
    x = x + now.dx
    F = now.F
    if code == NOTHING:
        there = State(mode, 0, n, theta, x, v + now.dv, F, F, S, t, t_low, s, c, theta_low)
        return no_contact(state, there, now, remaining, K)
    if side < 0:
        boundary = mode - 1
    else:
        boundary = mode
    belt = belt_at(boundary, K)
    v = belt.v
    if code == STALLED:
        there = State(mode, at, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low)
        return NextEvent(FAILED, boundary, False, 0.0, there)
    if code == TANGENCY:
        F = 0.0 * F
    # After short flights `now.F` is the more accurate one: it grew from F0.
    elif now.tau * K.rate > SERIES_BELOW:
        F = acceleration(x, v, now.c, constant_force(mode, K), K.cm, K.w0sq, K.f0)
    return meet_belt(
        State(mode, boundary, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low),
        end,
        v_noise,
        remaining,
        K,
    )


@outlined
def point_at_end(remaining, start, K):
    """Return the point of the flight `start` after the `remaining` time, where the motion ends."""
    return state_at(remaining, start, K)


@outlined
def no_contact(state, there, now, remaining, K):
    """Return the NextEvent of a flight from `state` that met no wall up to the state `there` (the
    point `now`).
    """
    mode, _, n, theta, x, v, F, _, S, t, t_low, _, _, theta_low = there
    # Whether a motion without a drive settles must not depend on when the search was over.
    ends = now.tau >= remaining
    lower, upper = speeds_around(mode, K)
    ends_driven = ends and K.driven
    launch = Launch(v, F, now.s, now.c)
    if not ends_driven and never_leaves(launch, S, lower, upper, mode, K):
        return NextEvent(REST, 0, True, 0.0, state)
    if ends:
        return NextEvent(END, 0, True, 0.0, there)
    F = acceleration(x, v, now.c, constant_force(mode, K), K.cm, K.w0sq, K.f0)
    s, c = sine_and_cosine(theta, theta_low)
    return NextEvent(
        MOVED, 0, True, 0.0, State(mode, 0, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low)
    )


def never_leaves(start, S, lower, upper, domain, K):
    """Return whether v stays between two speeds forever, by the amplitudes of the steady motion and
    the transient.
    """
    # `lower` and `upper` are the speeds of the belts around the domain, -inf and inf where there is
    # none; S is the covariance of the errors of `start`.
    if not K.steady or (K.w0 == 0.0 and K.cm == 0.0) or K.growth > 1.0:
        return False
    v, F, s, c = start
    free = v - (K.Ss * s + K.Sc * c)
    if K.w0 == 0.0:
        mean = constant_force(domain, K) / K.cm
        free = free - mean
        highest = mean + K.V0 + (free if free > 0.0 else 0.0)
        lowest = mean - K.V0 + (free if free < 0.0 else 0.0)
    else:
        F_free = F - K.Om * (K.Ss * c - K.Sc * s)
        highest = K.V0 + sqrt(F_free * F_free + K.w0sq * free * free) / K.w0
        lowest = -highest
    # A swing that just touches a belt is an event.
    slack = MARCH_SLACK * (highest - lowest + abs(highest) + abs(v)) + K.sigmas * sqrt(
        S.S22 + K.w0sq * S.S11
    )
    return lowest - slack > lower and highest + slack < upper


@outlined
def creeps_for_ever(state, K):
    """Return whether a flight from `state` surely never meets a wall.

    It must have no drive and no oscillation.
    """
    mode = state.mode
    v = state.v
    F = state.Fb
    S = state.S
    # `kept` says that u = g' - l2 g >= 0 (see the top of the module), beyond doubt. At the lower belt
    # r is its drift, at the upper one minus its drift. Without a spring l2 = -c/m, and u is
    # (A_alpha - c v_lambda)/m or minus that: a limit, of which the sign is known.
    rates = abs(K.cm) + abs(K.l2)
    terms = abs(constant_force(mode, K)) + abs(K.w0sq * state.x) + rates * abs(v)
    noise = ROUNDING * EPS * terms + K.sigmas * (K.w0sq * sqrt(S.S11) + rates * sqrt(S.S22))
    slower, faster = speeds_around(mode, K)
    if slower > -inf:
        lower = belt_at(mode - 1, K)
        if K.w0 == 0.0:
            kept = lower.limit_above >= 0.0
        else:
            kept = F - K.l2 * (v - lower.v) > noise
        # or u begins with 0 and grows
        kept = kept or (v == lower.v and F == 0.0 and lower.drift > 0.0)
        if not kept or lower.drift < 0.0:
            return False
    if faster < inf:
        upper = belt_at(mode, K)
        if K.w0 == 0.0:
            kept = upper.limit_below <= 0.0
        else:
            kept = -F - K.l2 * (upper.v - v) > noise
        kept = kept or (v == upper.v and F == 0.0 and upper.drift < 0.0)
        if not kept or upper.drift > 0.0:
            return False
    return True


def flight_noise(state, now, K):
    """Return the rounding errors of x and v that accumulate on a flight from `state` to `now`."""
    # tau < 0: the last event was a rounding past the end
    tau = abs(now.tau)
    v0 = state.v
    F0 = state.Fb
    S = state.S
    speed = abs(v0) + velocity_scale(tau, v0, F0, K)
    reach = select(tau < K.swing, tau, K.swing)
    # terms of the acceleration; behind a stick the range of its forces was one of them
    forces = abs(F0) + abs(constant_force(state.mode, K)) + abs(K.f0)
    first = state.at == 1
    hold = select(first, K.belt1.hold, K.belt2.hold)
    E = select(first, K.belt1.E, K.belt2.E)
    forces = forces + select((state.at > 0) & (abs(F0) == E), hold, 0.0 * hold)
    gains = (speed + forces * reach) * reach * K.growth
    x_noise = 1.25 * EPS * (abs(state.x) + gains + abs(v0) * tau)
    # phase of the free oscillation, as far as it lasts
    turned = 0.5 * K.w0 * tau * (abs(now.E0) + K.w0 * abs(now.E1))
    v_noise = 1.25 * EPS * ((2.0 + turned) * speed + forces * reach * K.growth)
    if K.lasting:
        # The errors of the constants are the same in every flight: they add up, where independent
        # ones would add up in squares.
        x_noise = sqrt(x_noise * (x_noise + 2.0 * sqrt(S.S11)))
        v_noise = sqrt(v_noise * (v_noise + 2.0 * sqrt(S.S22)))
    return x_noise, v_noise


def carried_error(S, now, x_noise, v_noise, K):
    """Carry the covariance S of (x, v) from launch to point `now`, and add the rounding errors
    x_noise and v_noise.
    """
    # Perturbations obey the unforced equation in every domain, so the entire functions carry them:
    # dx gains E1 dv, dv gains -(k/m) E1 dx. The rounding errors of the step are added.
    E0 = now.E0
    E1 = now.E1
    S11 = S.S11
    S12 = S.S12
    S22 = S.S22
    C = 1.0 - K.w0sq * now.E2
    D = -K.w0sq * E1
    return Covariance(
        C * C * S11 + 2.0 * C * E1 * S12 + E1 * E1 * S22 + x_noise * x_noise,
        C * D * S11 + (C * E0 + E1 * D) * S12 + E1 * E0 * S22,
        D * D * S11 + 2.0 * D * E0 * S12 + E0 * E0 * S22 + v_noise * v_noise,
    )


# --- contacts ---


def meet_belt(there, end, v_noise, remaining, K):
    """Return the NextEvent of a flight that meets a belt in state `there`: a graze, stick or
    crossing.
    """
    # `there` is the State at the contact, in the domain that the flight comes from, `end` its
    # FlightEnd, v_noise the rounding error of the velocity, and `remaining` the time to the end
    # from the start of the flight. A vague contact that is no touch is a triple root: the velocity
    # goes on through that of the belt, as far as friction lets it.
    mode, boundary, n, theta, x, v, F, _, S, t, t_low, s, c, theta_low = there
    belt = belt_at(boundary, K)
    if belt.is_corner:
        return meet_corner(there, belt, K)
    upward = end.side > 0
    now = end.now
    G1, G2, G3 = derivatives(v, F, now.s, now.c, K)
    t_error = passing_time(sqrt(S.S22), F, G1, G2, K)
    # A gap that is F^2/(2 G1) deep is open if its error is as large as that.
    uncertainty = 2.0 * K.sigmas * t_error
    # Whether the acceleration is 0 here, as far as this precision tells.
    vague = end.code == TANGENCY or abs(F) <= (abs(G1) + abs(G2) * uncertainty) * uncertainty
    if vague and not (end.side * G2 > abs(G3) * uncertainty and abs(G1) <= abs(G2) * uncertainty):
        return graze_belt(there, G1, G2, G3, v_noise, now.tau, remaining, K)
    if vague:
        F = 0.0 * F
    # F is the force on the side that the flight comes from.
    if upward:
        Fb = F
        Fa = F - belt.J
    else:
        Fb = F + belt.J
        Fa = F
    held_below, held_above = held_forces(Fb, Fa, belt)
    decided = not vague
    # The force beyond the belt decides between crossing and stick.
    if upward:
        far_force = held_above
    else:
        far_force = held_below
    vanishes = abs(far_force) < NEAR_FORCE * belt.hold
    if vanishes:
        noise = force_noise(F, now.tau, S.S11, belt, K)
        vanishes = abs(far_force) <= noise + K.sigmas * abs(K.cm) * sqrt(S.S22)
    if vanishes:
        decided = False
        if upward:
            held_above = 0.0 * held_above
            Fa = belt.E + held_above
        else:
            held_below = 0.0 * held_below
            Fb = held_below - belt.E
    if vague:
        if belt.hold > 0.0:
            where = BELT
        elif upward:
            where = DOMAIN_ABOVE
        else:
            where = DOMAIN_BELOW
    elif held_above > 0.0:
        where = DOMAIN_ABOVE
    elif held_below > 0.0 and held_above < 0.0:
        where = BELT
    elif held_below < 0.0:
        where = DOMAIN_BELOW
    else:
        where = resolve(v, held_below, held_above, now.s, now.c, K)
    if where == BELT:
        # The belt takes the error of the velocity away.
        S = Covariance(S.S11, 0.0 * S.S12, 0.0 * S.S22)
        mode = ON_BELT + boundary
        held = State(
            mode, boundary, n, theta, x, v, held_below, held_above, S, t, t_low, s, c, theta_low
        )
        return NextEvent(STICK, boundary, decided, t_error, held)
    if where == DOMAIN_ABOVE:
        out = Fa
        target = boundary + 1
    else:
        out = Fb
        target = boundary
    if target == mode:  # a hit whose speed is lost in rounding
        zero = 0.0 * F
        touched = State(mode, boundary, n, theta, x, v, zero, zero, S, t, t_low, s, c, theta_low)
        return NextEvent(GRAZE, boundary, False, t_error, touched)
    # An error of v shifts the crossing in time, and the force changes there from F to `out`.
    if F != 0.0:
        ratio = out / F
    else:
        ratio = 1.0
    S = Covariance(S.S11, ratio * S.S12, ratio * ratio * S.S22)
    crossed = State(target, boundary, n, theta, x, v, out, out, S, t, t_low, s, c, theta_low)
    return NextEvent(CROSS, boundary, decided, t_error, crossed)


@outlined
def meet_corner(there, corner, K):
    """Return the step (MOVED, with its boundary) of a flight that meets a corner in state `there`."""
    mode, boundary, n, theta, x, v, F, _, S, t, t_low, s, c, theta_low = there
    if corner.is_rest:
        terms = abs(constant_force(mode, K)) + abs(K.w0sq * x)
        if abs(F) <= ROUNDING * EPS * terms + K.sigmas * K.w0sq * sqrt(S.S11):
            F = 0.0 * F
    where = following_sign(v, F, s, c, K)
    if where > 0:
        mode = boundary + 1
    elif where < 0:
        mode = boundary
    moved = State(mode, boundary, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low)
    return NextEvent(MOVED, boundary, True, 0.0, moved)


def rests_on_corner(state, K):
    """Return whether a motion stays on the corner where it is: no derivative leads away."""
    return (
        state.at > 0
        and state.Fb == 0.0
        and belt_at(state.at, K).is_corner
        and following_sign(state.v, state.Fb, state.s, state.c, K) == 0
    )


@outlined
def graze_belt(there, G1, G2, G3, v_noise, tau, remaining, K):
    """Return the NextEvent of a touch in state `there`, at `tau` after launch: a graze or, if
    static friction holds the mass, a stick.

    G1 to G3 are v'' to v'''' there.
    """
    mode, boundary, n, theta, x, v, F, _, S, t, t_low, s, c, theta_low = there
    # From a crossing, which is none as far as this precision tells, to the touch behind it.
    if F * G1 < 0.0:
        shift = min(-F / G1, remaining - tau)
        x = x + (v + (0.5 * F + SIXTH * G1 * shift) * shift) * shift
        n, theta, theta_low = advance_phase(n, theta, theta_low, shift, K)
        t, t_low = advance_time(t, t_low, shift, K)
        s, c = sine_and_cosine(theta, theta_low)
    t_error = passing_time(K.rate * (sqrt(S.S22) + v_noise), G1, G2, G3, K)
    F = 0.0 * F
    Fb = F
    Fa = F
    belt = belt_at(boundary, K)
    if not t_error < tau:  # a touch that may be anywhere in the flight is none
        code = FAILED
    elif belt.E > 0.0:
        code = STICK
        if mode == boundary:  # from below
            Fb, Fa = held_forces(F, F - belt.J, belt)
        else:
            Fb, Fa = held_forces(F + belt.J, F, belt)
        mode = ON_BELT + boundary
        S = Covariance(S.S11, 0.0 * S.S12, 0.0 * S.S22)
    else:
        code = GRAZE
    touched = State(mode, boundary, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)
    return NextEvent(code, boundary, False, t_error, touched)


@outlined
def resolve(v, F_below, F_above, s, c, K):
    """Return where a motion goes on from a belt: DOMAIN_BELOW, BELT or DOMAIN_ABOVE (Theorems 4,
    5).
    """
    # F_below and F_above are those of `held_forces`. F_below >= F_above always, so the flow cannot
    # leave on both sides at once.
    if following_sign(v, F_above, s, c, K) > 0:
        return DOMAIN_ABOVE
    if following_sign(v, F_below, s, c, K) < 0:
        return DOMAIN_BELOW
    return BELT


def following_sign(v, F, s, c, K):
    """Return the sign of the force F on a belt or, if F = 0, of its first time derivative that is
    not 0; else 0.
    """
    # v is the velocity of the belt, F the acceleration, which is exact (F = 0 means that it
    # vanishes), and s, c are sine and cosine of the phase.
    if F != 0.0:
        if F > 0.0:
            return 1
        return -1
    # `before`, `now` and `after` are three G-functions in a row, and G^(n+1) follows from the two
    # before it and the drive. `power` is Omega^n; `drive_s` and `drive_c` are fB s and fB c,
    # differentiated as often.
    before = v
    now = F
    power = 1.0
    drive_s = K.fB * s
    drive_c = K.fB * c
    for _ in range(1, HIGHEST_ORDER):
        forcing = drive_s
        after = next_derivative(now, before, forcing, K.cm, K.w0sq)
        size = abs(forcing) + abs(K.cm * now) + abs(K.w0sq * before)
        if abs(after) > G_ROUNDING * EPS * (size + abs(K.fB) * power):
            if after > 0.0:
                return 1
            return -1
        before = now
        now = 0.0 * after
        power = power * K.Om
        forcing_after = K.Om * drive_c
        drive_c = -K.Om * drive_s
        drive_s = forcing_after
    return 0


# --- sticks ---


def after_stick(state, end, remaining, K):
    """Return the NextEvent that follows from `end`, the StickEnd found for the stick that begins in
    `state`.
    """
    mode, boundary, n, theta, x, v, Fb, Fa, S, t, t_low, _, _, theta_low = state
    boundary = mode - ON_BELT
    zero = 0.0 * Fb
    belt = belt_at(boundary, K)
    code, side, tau, Delta, slope, bend, s, c = end
    if tau > remaining and code in (HIT, TANGENCY):
        code = NOTHING
        tau = remaining
    # Forces that do not change, or repeat and lead to no exit in one period, lead to none ever.
    if K.driven:
        lasts = K.period <= tau < remaining
    else:
        lasts = remaining > 0.0
    if code == NOTHING and belt.drift == 0.0 and lasts:
        return NextEvent(REST, 0, True, 0.0, state)
    noise = EPS * (abs(x) + 2.0 * abs(v) * tau)
    S = Covariance(S.S11 + noise * noise, zero, zero)
    x = x + v * tau
    turns, theta, theta_low = advance_phase(0, theta, theta_low, tau, K)
    n = n + turns
    if code != HIT or turns > 0:
        s, c = sine_and_cosine(theta, theta_low)
    t, t_low = advance_time(t, t_low, tau, K)
    if code == NOTHING:
        held = State(
            mode, boundary, n, theta, x, v, Fb + Delta, Fa + Delta, S, t, t_low, s, c, theta_low
        )
        return NextEvent(END if tau >= remaining else MOVED, 0, True, 0.0, held)
    if code != HIT:  # undecided: the force that may end the stick is set to 0
        if side < 0:
            Fb = zero
            Fa = -belt.hold
        else:
            Fb = belt.hold
            Fa = zero
        held = State(mode, boundary, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)
        return NextEvent(
            MOVED if code == TANGENCY else FAILED,
            0 if code == TANGENCY else boundary,
            False,
            0.0,
            held,
        )
    if side < 0:
        target = boundary
        F = zero - belt.E
    else:
        target = boundary + 1
        F = zero + belt.E
    terms = abs(constant_force(target, K)) + belt.hold + abs(K.w0sq * x) + abs(K.cm * v) + abs(K.f0)
    x_force = K.w0sq * sqrt(S.S11)
    force_error = x_force + EPS * (abs(belt.drift) * tau + terms)
    t_error = passing_time(force_error, slope, bend, K.fB * K.Om * K.Om, K)
    if belt.E > 0.0:
        S = error_after_slip(S, x_force / force_error, belt.E * t_error)
    slipped = State(target, boundary, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low)
    return NextEvent(SLIP, boundary, True, t_error, slipped)


@outlined
def error_after_slip(S, part, v_error):
    """Return the covariance of x and v behind a slip that begins with an acceleration E > 0.

    A change dx moves the slip by dt = (k/m) dx/|slope|, and so the velocity at a fixed time by
    -E dt, on either side. `v_error` is E times the error of the slip's time, and `part` the
    fraction of that error that comes from the error of x.
    """
    # A little more than S12^2/S11, as the determinant must not get below 0 by rounding.
    variance = v_error * v_error
    S22 = variance + UNCORRELATED * variance
    return Covariance(S.S11, S.S12 - part * v_error * sqrt(S.S11), S22)


# --- phase and time ---


def advance_phase(n, theta, theta_low, tau, K):
    """Advance the phase theta + theta_low by the time `tau`.

    Return (n, theta, theta_low), `n` counts whole periods.
    """
    if tau == K.period:  # exactly
        return n + 1, theta, theta_low
    theta, theta_low = phase_after(theta, theta_low, tau, K)
    if theta >= MANY_TURNS * TWO_PI:  # without a drive, see `symosc.engine.flow`
        turns = int(theta / TWO_PI) - 1  # the last ones are left to the loop
        theta = (theta - turns * TWO_PI) - turns * TWO_PI_REST
        n = n + turns
    while theta >= TWO_PI:
        theta = theta - TWO_PI
        theta_low = theta_low - TWO_PI_REST
        n = n + 1
    return n, *in_two_parts(theta, theta_low)


def phase_after(theta, theta_low, tau, K):
    """Return the phase theta + theta_low advanced by the time `tau`, in two parts and not reduced
    modulo 2 pi.
    """
    turn = K.Om * tau
    total = theta + turn
    part = total - theta
    low = (theta - (total - part)) + (turn - part)  # what rounding took from the sum (Knuth)
    _, rest = two_product(K.Om, tau)  # and from the product
    # A rest that is larger is out of the range of doubles.
    return total, theta_low + select(abs(rest) < 1.0, low + rest, low)


def in_two_parts(theta, theta_low):
    """Return a phase theta + theta_low as (rounded, rest), with rounded >= 0.

    Only the rest may be negative.
    """
    total = theta + theta_low
    theta_low = theta_low - (total - theta)
    return select(total < 0.0, 0.0 * total, total), select(
        total < 0.0, theta_low + total, theta_low
    )


def advance_time(t, t_low, tau, K):
    """Return t + t_low + tau in two parts (Knuth's sum)."""
    t_low = select(tau == K.period, t_low + K.period_low, t_low)
    total = t + tau
    part = total - t
    low = t_low + ((t - (total - part)) + (tau - part))
    t = total + low
    return t, low - (t - total)


def passing_time(error, first, second, third, K):
    """Return how uncertain the time is when a quantity with `error` and derivatives `first` to
    `third` passes 0.
    """
    if passes_at_once(error, abs(first), second, third):
        return error / abs(first)
    return slow_passing_time(error, first, second, third, K)


def passes_at_once(error, speed, second, third):
    """Return whether `passing_time` is just error/speed, since the derivatives `second` and `third`
    are too small.
    """
    # Each of them alone then changes the time by less than a thousandth of it.
    limit = 1e-3 * speed * speed
    return (error * abs(second) < limit) & (error * error * abs(third) < limit * speed)


@outlined
def slow_passing_time(error, first, second, third, K):
    """Return the least time in which one of three derivatives alone makes up for an `error`.

    At most 1/`K.beat`.
    """
    best = 1.0 / K.beat
    if error == 0.0:
        return 0.0 * best
    if first != 0.0:
        best = min(best, error / abs(first))
    if second != 0.0:
        best = min(best, sqrt(2.0 * error / abs(second)))
    if third != 0.0:
        return min(best, (6.0 * error / abs(third)) ** (2.0 * SIXTH))  # the cube root
    return best


def time_with_errors(t, t_low, t0, x, v, t_error, S11, K):
    """Return the true time of an event (`clock_time`), and the standard errors of t and x, rounding
    included.
    """
    # What a motion is locked to is the phase: the rounding of Omega is taken back in the time that
    # it stands for.
    out = clock_time(t, t_low, t0, K)
    x_error = abs(v) * t_error + sqrt(S11) + EPS * abs(x)
    return out, t_error + EPS * (abs(out) + 0.25 * (t - t0)), x_error


# --- with many digits: doubles search, and only the last step and its results take the digits ---


@outlined
def advance_near(state, rough, rough_event, free, t_end, t_end_low, K):
    """Advance `state` to its next event with many digits, beside `rough_event`, which doubles find
    from `rough`.

    `rough` is `state` in doubles. If `rough_event` is undecided, no wall is met for the time `free`
    after `rough`.
    """
    # Doubles decide by more than the rounding of their start and their own. Where they are sure
    # which contact is the first and how it is met, many digits would find the same one. So these
    # begin at its time, take a step of Newton's method or two with the exact flow, and go on as
    # after a search of their own. Where doubles see a touch they begin there too
    # (`contact_at_dip`). They search themselves (the last line) where the end found so is not the
    # one expected (STALLED), where doubles cannot decide otherwise, and where the end of the search
    # is the question. The rounding of `rough` is a part of its error.
    code, boundary, decided, t_error, there = rough_event
    tau = (there.t - rough.t) + (there.t_low - rough.t_low)
    if K.creeps or not tau > 0.0:
        return advance(state, t_end, t_end_low, K)
    remaining = (t_end - state.t) + (t_end_low - state.t_low)
    uncertainty = SEARCH_SIGMAS * t_error + TIME_ROUNDING * tau
    tau = 0.0 * remaining + tau  # as a number of the same kind
    if decided and code == SLIP:
        belt = belt_at(boundary, K)
        slip = slip_near(tau, uncertainty, -1 if there.mode == boundary else 1, state, belt, K)
        if slip.code == HIT:
            return after_stick(state, slip, remaining, K)
    elif state.mode <= ON_BELT and boundary > 0:
        start, walls = launched(state, K)
        if boundary < state.mode:
            side = -1
        else:
            side = 1
        if decided:
            end = contact_near(tau, uncertainty, side, start, walls, K)
        else:
            end = contact_at_dip(tau, free + 0.0 * tau, side, start, walls, state.S, K)
        if end.code == HIT:
            return after_flight(state, end, start, remaining, K)
    elif (
        decided and state.mode <= ON_BELT and code in (MOVED, END) and tau < USUAL_LENGTH * K.chunk
    ):
        start, walls = launched(state, K)
        now = state_at(remaining if remaining < K.chunk else K.chunk, start, K)
        if not ends_beside_wall(state, now, K):
            return after_flight(state, FlightEnd(NOTHING, 0, now), start, remaining, K)
    return advance(state, t_end, t_end_low, K)


@outlined
def free_time(state, K):
    """Return a time during which the flight from `state` surely meets no wall, by fixed steps; 0 if
    they fail.
    """
    if state.mode > ON_BELT or not K.apart:
        return 0.0 * state.v
    start, walls = launched(state, K)
    begin, flat, _, margin = search_begin(K.chunk, start, walls, state.S, K)
    if flat:
        return 0.0 * state.v
    return march(K.chunk, start.v, begin, walls, margin, K).now.tau
