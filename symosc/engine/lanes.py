"""Several motions side by side in the registers of a processor, one in each lane; compiled only.

This file is executed with other globals: see symosc/kernels/rebind.py.

A lane does what `symosc.engine.next_event.advance` does, with the same formulas in the same order,
on the common path: a flight that marches to the one step in which it meets a wall, or a stick that
slips within a forcing period, and what Theorems 4 and 5 decide there beyond doubt. Where anything
else happens, the lane's result is dropped, and the scalar loop makes this step. So results have the
same bits, whatever the number of lanes, and whichever motions are neighbours.

Why it stays, although it is the common path of the engine once more: `simulate_many` is half as
fast without it. An event of fig5 that is only counted takes 124 ns with eight lanes and 235 ns in
the scalar loop (one core), and counts, words and extremes of millions of events are what sweeps and
basins ask for. One source for both does not work: a lane cannot branch, and the scalar search
without branches would evaluate every case.

What it shares: every function that has no branch (`marched`, `stays_open`, `meets_once`,
`sharpened`, `shifted`, `carried_error`, the kernels ...) is called as it is, with lanes for
numbers. What is here are the loops and branches, with flags instead: the march and the search for
its root (`march`, `polish`), the pieces of a stick (`belt_exit`, `exit_root`), and what follows
from a contact (`after_flight`, `meet_belt`, `after_stick`). A change of one of these has its
counterpart here. To write the steps of a stick without branches for both costs CPython 5 % of a
motion.

What keeps it equal: tests/engine/test_lanes.py compares each lane's step with that of the scalar
source bit by bit, on random motions, at two widths, and beside other neighbours.

A wall that is not there has an infinite gap. Lanes without a result may hold any numbers; `good`
flags those with one. Flags that are all set, or none, are made from numbers (`zero == 0.0`, `zero !=
0.0`, `good & ~good`), as only these have the width of the lanes. Other arguments are those of the
scalar functions, one number for each lane.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np

from symosc.engine.batch import borrowed, follow_one, is_inexact, state_of
from symosc.engine.first_exit import (
    FAINT,
    NEAR,
    PI,
    ROUNDING,
    THIN,
    force_gain_at,
    force_noise,
    force_slopes,
    fourth_derivative_bound,
    free_motion,
    gap_to,
    is_beside,
    lifted,
    marched,
    meets_once,
    opens,
    part_to_root,
    phase_ahead,
    root_by_series,
    sharpened,
    shifted,
    slips_at,
    stays_open,
    wrap_phase,
)
from symosc.engine.flow import (
    ROW,
    BeltConstants,
    MarchConstants,
    constant_force,
    corrected,
    derivatives,
    held_forces,
)
from symosc.engine.next_event import (
    NEAR_FORCE,
    PAST_END,
    TWO_PI,
    TWO_PI_REST,
    advance_time,
    band_beyond,
    carried_error,
    error_after_slip,
    flight_noise,
    in_two_parts,
    passes_at_once,
    phase_after,
    time_with_errors,
)
from symosc.engine.state import (
    CROSS,
    MIDDLE,
    MOVED,
    NUMBERS_OF_FOLLOWED,
    NUMBERS_OF_STATE,
    ON_BELT,
    RUNNING,
    SLIP,
    STICK,
    Covariance,
    Flown,
    NextEvent,
    State,
    Walls,
)
from symosc.engine.summary import EVENTS_SO_FAR, SKIPPED, STICKS, tally_step
from symosc.kernels._generated import acceleration, basis_apart, motion, stick_acceleration
from symosc.kernels.elementary import WIDEST, exp, select, sine_cosine
from symosc.kernels.entire import APART_ABOVE, EPS, INVERSES, SERIES_BELOW, SIXTH
from symosc.kernels.rebind import outlined

# Here these names are placeholders: compiled code has those of `symosc.kernels.lane_types`, at its
# width.
placeholder: Any = None
any_of = bits_of = load_motion = load_constants = placeholder
store_tuple = number_in = put_number = placeholder
LANES = 0

# Numbers of a motion, and those of its state, which come first.
OF_MOTION = len(NUMBERS_OF_FOLLOWED)
OF_STATE = len(NUMBERS_OF_STATE)
# Rows of the results (`LaneResult`) behind those of a state.
KIND = OF_STATE
BELT_THERE = OF_STATE + 1
T_ERROR = OF_STATE + 2
OF_RESULT = OF_STATE + 3
# A block with fewer motions than this part of the lanes is slower than the scalar loop.
LEAST_PART = 4
# Steps after which the scalar loop goes on if not more than this part of them was on the common
# path.
PROBE = 1024
# With so many motions per lane of one parameter set these go alone, with the constants in
# registers.
FEW = 4
# The two queues of motions that wait for a lane.
FLYING = 0
STICKING = 1
# Numbers of a parameter set.
NUMBERS = ROW.itemsize // 8
# How often a root is evaluated before the scalar loop goes on: on the common path once, or twice.
MOST_EVALUATIONS = 3
# Steps of Newton's method to a root that the inverse series places roughly: mostly one, sometimes
# two.
NEWTON_STEPS = 2


class LaneResult(NamedTuple):
    """What a block finds in its lanes: the new states, codes and belts of the events, and the
    standard errors of their times.
    """

    state: State
    code: Any
    boundary: Any
    t_error: Any


def belts(boundary, K):
    """Return the BeltConstants for several motions at once, lane by lane: of belt 1 or 2 as
    `boundary` says.
    """
    first = boundary == 1
    belt1 = K.belt1
    belt2 = K.belt2
    v = select(first, belt1.v, belt2.v)
    J = select(first, belt1.J, belt2.J)
    E = select(first, belt1.E, belt2.E)
    hold = select(first, belt1.hold, belt2.hold)
    drift = select(first, belt1.drift, belt2.drift)
    turns = select(first, belt1.turns, belt2.turns) != 0.0
    s_cr = select(first, belt1.s_cr, belt2.s_cr)
    c_cr = select(first, belt1.c_cr, belt2.c_cr)
    angle = select(first, belt1.angle, belt2.angle)
    is_corner = select(first, belt1.is_corner, belt2.is_corner) != 0.0
    # Lanes do not ask for the other fields: v stands there.
    return BeltConstants(v, J, E, hold, drift, turns, s_cr, c_cr, angle, v, v, is_corner, v)


def suits_lanes(K):
    """Return whether motions with constants K suit lanes: underdamped, far from resonance, and no
    slow drive.
    """
    return K.apart != 0 and K.slow_drive == 0 and (K.omega_d + K.Om) * K.chunk < 0.5 * WIDEST


def end_of_group(begin, sets, table):
    """Return (end, alike): motions `begin` to `end` - 1 may be followed side by side.

    `alike`: they share a set, and go on to do so.
    """
    end = begin + 1
    count = sets.shape[0]
    K = table[sets[begin]]
    if not suits_lanes(K):
        return end, True
    while end < count and sets[end] == sets[begin]:
        end += 1
    if K.banded == 0 and (end == count or end - begin >= FEW * LANES):
        return end, True
    while end < count and suits_lanes(table[sets[end]]) and shares_flags(table[sets[end]], K):
        end += 1
    return end, False


def shares_flags(K, other):
    """Return whether two parameter sets have the same flags, which a block has once for all lanes;
    those that `suits_lanes` asks for are the same anyway.
    """
    return K.lasting == other.lasting and K.driven == other.driven and K.banded == other.banded


# --- flights ---


def fly(state, remaining, K):
    """Advance flights, one per lane, to next events (if `good`).

    Return (good, code, boundary, t_error, state).
    """
    mode, at, n, theta, x, v0, F0, _, S, t, t_low, s0, c0, theta_low = state
    tau_max = select(remaining <= K.chunk, remaining + PAST_END * remaining, K.chunk)
    # Domain 1 has no wall below it, domain 3 none above it.
    lower = select(mode == 1, -inf, select(mode == 2, K.belt1.v, K.belt2.v))
    upper = select(mode == 3, inf, select(mode == 2, K.belt2.v, K.belt1.v))
    on_below = (at > 0) & (at == mode - 1)
    on_above = at == mode
    walls = Walls(v0 - lower, upper - v0, True, True, on_below, on_above)
    zero = 0.0 * tau_max
    G1, G2, G3 = derivatives(v0, F0, s0, c0, K)
    begin = Flown(zero, zero, zero, F0, G1, G2, G3, s0, c0, 1.0 + zero, zero, zero)
    # what `search_begin` does; a flat start is left to the scalar loop
    flat = (
        (on_below | on_above)
        & (F0 == 0.0)
        & (abs(G1) <= ROUNDING * EPS * (abs(K.w0sq * v0) + abs(K.fB)))
    )
    speed = THIN * (abs(v0) + (abs(F0) + abs(K.f0)) * K.moment)
    variance = K.sigmas * K.sigmas * (S.S22 + K.w0sq * S.S11)
    margin = select(variance > FAINT * speed * speed, sqrt(variance), 0.0 * variance)
    hit, now, there, side = march_side_by_side(tau_max, v0, begin, walls, margin, K)
    good = hit & (remaining > 0.0) & ~flat
    if not any_of(good):
        return good, mode, mode, mode, state  # any numbers: no lane is good
    good, now = polish_side_by_side(good, now, there, side, v0, F0, s0, c0, walls, K)
    tau = now.tau
    good = good & (tau <= remaining)
    # what `after_flight` does
    x_noise, v_noise = flight_noise(state, now, K)
    S = carried_error(S, now, x_noise, v_noise, K)
    late, n, theta, theta_low, s, c = advance_phases(n, theta, theta_low, now.s, now.c, tau, K)
    t, t_low = advance_time(t, t_low, tau, K)
    x = x + now.dx
    upward = side > 0.0
    boundary = select(upward, mode, mode - 1.0)
    belt = belts(boundary, K)
    v = belt.v
    F = acceleration(x, v, now.c, constant_force(mode, K), K.cm, K.w0sq, K.f0)
    F = select(tau * K.rate > SERIES_BELOW, F, now.F)
    # what `meet_belt` does
    G1, G2, G3 = derivatives(v, F, now.s, now.c, K)
    t_error = sqrt(S.S22) / abs(F)
    uncertainty = 2.0 * K.sigmas * t_error
    vague = abs(F) <= (abs(G1) + abs(G2) * uncertainty) * uncertainty
    good = good & ~late & passes_at_once(sqrt(S.S22), abs(F), G1, G2) & ~vague
    Fb = select(upward, F, F + belt.J)
    Fa = select(upward, F - belt.J, F)
    held_below, held_above = held_forces(Fb, Fa, belt)
    far_force = select(upward, held_above, held_below)
    small = good & (abs(far_force) < NEAR_FORCE * belt.hold)
    if any_of(small):
        noise = force_noise(F, tau, S.S11, belt, K) + K.sigmas * abs(K.cm) * sqrt(S.S22)
        good = good & ~(small & (abs(far_force) <= noise))
    rises = held_above > 0.0
    sticks = (held_above < 0.0) & (held_below > 0.0)
    target = select(rises, boundary + 1.0, boundary)
    good = good & (rises | sticks | (held_below < 0.0)) & (sticks | (target != mode))
    out = select(rises, Fa, Fb)
    ratio = select(sticks, 0.0, out / F)
    S12 = ratio * S.S12
    S22 = ratio * ratio * S.S22
    S = Covariance(S.S11, select(sticks, 0.0 * S.S12, S12), select(sticks, 0.0 * S.S22, S22))
    Fb = select(sticks, held_below, out)
    Fa = select(sticks, held_above, out)
    mode = select(sticks, ON_BELT + boundary, target)
    after = State(mode, boundary, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)
    code = select(belt.is_corner, MOVED, select(sticks, STICK, CROSS))
    return good, code, boundary, t_error, after


def march_side_by_side(tau_max, v0, now, walls, margin, K):
    """March one flight per lane.

    Return (hit, now, there, side): if `hit`, the step that meets the wall on `side`.
    """
    v_free, F_free, slack, beyond_below, beyond_above = free_motion(v0, now, walls, margin, K)
    below = select(beyond_below, inf, walls.below)
    above = select(beyond_above, inf, walls.above)
    walls = Walls(below, above, True, True, walls.on_below, walls.on_above)
    M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
    since = now.tau
    stride = K.stride.step
    guess = now.dv + (now.F + 0.5 * now.G1 * stride) * stride
    long = (below + guess > 0.0) & (above - guess > 0.0)
    # At the launch tau is 0: all lanes are active, and none has hit a wall.
    active = now.tau == 0.0
    hit = now.tau < 0.0
    side = now.tau
    end = now
    while any_of(active):
        step = select(long, K.stride.step, K.march.step)
        C = select(long, K.stride.C, K.march.C)
        E1 = select(long, K.stride.E1, K.march.E1)
        D = select(long, K.stride.D, K.march.D)
        E0 = select(long, K.stride.E0, K.march.E0)
        s = select(long, K.stride.s, K.march.s)
        M = MarchConstants(step, C, E1, D, E0, s, select(long, K.stride.c, K.march.c))
        v_next, F_next, there = marched(v_free, F_free, v0, now, M, K)
        lift = lifted(M.step, M4, slack)
        within = there.tau < tau_max
        h = there.tau - now.tau
        # what `is_free` does for the lower wall, then for the upper one
        g0 = below + now.dv
        d0 = h * now.F
        g1 = below + there.dv
        d1 = h * there.F
        free_below = stays_open(g0, d0, g1, d1, lift, slack)
        if any_of(active & (now.tau == 0.0) & walls.on_below):
            opening = opens(d0, h * h * now.G1, g1, d1, lift, slack)
            free_below = select((now.tau == 0.0) & walls.on_below, opening, free_below)
        g0 = above - now.dv
        d0 = -h * now.F
        g1 = above - there.dv
        d1 = -h * there.F
        free_above = stays_open(g0, d0, g1, d1, lift, slack)
        if any_of(active & (now.tau == 0.0) & walls.on_above):
            opening = opens(d0, -h * h * now.G1, g1, d1, lift, slack)
            free_above = select((now.tau == 0.0) & walls.on_above, opening, free_above)
        go = active & within & free_below & free_above
        stuck = active & ~go
        if any_of(stuck):
            last_dv = select(within, there.dv, now.dv)
            near = (since == now.tau) | ~((below + last_dv > 0.0) & (above - last_dv > 0.0))
            # Where a march does not end, it tries a usual step or a new bound.
            ends = stuck & ~long & near
            renewed = stuck & (ends | (since < now.tau))
            if any_of(renewed):
                _, G2, G3 = derivatives(v0 + now.dv, now.F, now.s, now.c, K)
                G2 = select(renewed, G2, now.G2)
                G3 = select(renewed, G3, now.G3)
                now = Flown(
                    now.tau,
                    now.dx,
                    now.dv,
                    now.F,
                    now.G1,
                    G2,
                    G3,
                    now.s,
                    now.c,
                    now.E0,
                    now.E1,
                    now.E2,
                )
                M4 = select(renewed, fourth_derivative_bound(G2, G3, now.s, now.c, K), M4)
                since = select(renewed, now.tau, since)
            if any_of(ends):
                towards = select(free_below, 1.0, -1.0)
                meets = (
                    ends
                    & within
                    & (free_below ^ free_above)
                    & meets_once(towards, now, there, M4, slack, walls)
                )
                side = select(meets, towards, side)
                hit = hit | meets
                end = chosen(meets, there, end)
            active = active & ~ends
            long = long & ~stuck
        now = chosen(go, there, now)
        v_free = select(go, v_next, v_free)
        F_free = select(go, F_next, F_free)
        guess = now.dv + (now.F + 0.5 * now.G1 * stride) * stride
        long = select(go, (below + guess > 0.0) & (above - guess > 0.0), long)
    return hit, now, end, side


def chosen(which, point, fallback):
    """Return for each lane the point `point` where the flag `which` is set, else the point
    `fallback`.
    """
    tau = select(which, point.tau, fallback.tau)
    dv = select(which, point.dv, fallback.dv)
    F = select(which, point.F, fallback.F)
    G1 = select(which, point.G1, fallback.G1)
    s = select(which, point.s, fallback.s)
    c = select(which, point.c, fallback.c)
    return Flown(
        tau,
        fallback.dx,
        dv,
        F,
        G1,
        fallback.G2,
        fallback.G3,
        s,
        c,
        fallback.E0,
        fallback.E1,
        fallback.E2,
    )


def polish_side_by_side(good, now, there, side, v0, F0, s0, c0, walls, K):
    """Return (good, point): in `good` lanes, the contact with the wall on `side` between points
    `now` and `there`.
    """
    low = now.tau
    high = there.tau
    slack = 4.0 * EPS * high
    h = high - low
    part = part_to_root(now, there, side, walls)
    early = part < 0.5
    at = chosen(early, now, there)
    G1, G2, G3 = derivatives(v0 + at.dv, at.F, at.s, at.c, K)
    at = Flown(at.tau, at.dx, at.dv, at.F, G1, G2, G3, at.s, at.c, at.E0, at.E1, at.E2)
    tau = at.tau + sharpened(select(early, part * h, (part - 1.0) * h), side, at, walls, K)
    pending = good
    done = good & ~good
    shift = 0.0 * tau
    for _ in range(MOST_EVALUATIONS):
        now = flown_side_by_side(tau, v0, F0, s0, c0, K)
        gap = gap_to(side, now, walls)
        before = gap > 0.0
        low = select(before & (tau > low), tau, low)
        high = select(~before & (tau < high), tau, high)
        over = select(side < 0.0, gap, -gap)
        shift, missing = root_by_series(over, now.F, now.G1, now.G2, now.G3)
        sure = (abs(over * now.G1) < 0.1 * now.F * now.F) & (missing <= EPS * tau)
        inside = (low - slack <= tau + shift) & (tau + shift <= high + slack)
        # Where `flown_side_by_side` loses digits, the scalar loop goes on.
        accurate = (K.rate * tau < SERIES_BELOW) | (K.w0 * tau >= APART_ABOVE)
        pending = pending & sure & inside & accurate
        near = abs(shift) * K.rate < NEAR
        done = done | (pending & near)
        pending = pending & ~near
        if not any_of(pending):
            break
        tau = select(pending, tau + shift, tau)
    return done, shifted(now, shift, v0, K)


def flown_side_by_side(tau, v0, F0, s0, c0, K):
    """Return for each lane the point of a flight at `tau` after launch, by the closed form or, for
    tau below SERIES_BELOW/rate, by the series.

    Between that and APART_ABOVE/w0, if this is later, the closed form loses digits.
    """
    # `basis_apart` is for characteristic roots that are apart, from each other and from i Omega
    # (`suits_lanes` asks for `K.apart`). G1, G2, G3 are the second to fourth derivative of v.
    decay = exp(-K.h * tau)
    (s_w, c_w) = sine_cosine(K.omega_d * tau)
    (s_Om, c_Om) = sine_cosine(K.Om * tau)
    E0, E1, E2, R2, I2 = basis_apart(
        decay, s_w, c_w, s_Om, c_Om, K.h, K.omega_d, K.w0sq, K.Om, K.p, K.q
    )
    short = K.rate * tau < SERIES_BELOW
    if any_of(short):
        responses = series_in_lanes(tau, K.cm, K.w0sq, K.beat, short)
        E0 = select(short, responses[0], E0)
        E1 = select(short, responses[1], E1)
        E2 = select(short, responses[2], E2)
        R2 = select(short, responses[3], R2)
        I2 = select(short, responses[4], I2)
    dx, dv, F = motion(v0, F0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    s = s0 * c_Om + c0 * s_Om
    c = c0 * c_Om - s0 * s_Om
    G1, G2, G3 = derivatives(v0 + dv, F, s, c, K)
    return Flown(tau, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2)


def series_in_lanes(tau, cm, w0sq, Om, wanted):
    """Return E0, E1, E2, R2, I2 by Taylor series in the lanes that are `wanted`, as
    `symosc.kernels.entire.series` does for one motion.
    """
    zero = 0.0 * tau
    before = zero
    term = tau
    E0 = 1.0 + zero
    E1 = tau
    E2 = 0.5 * tau * tau
    r = E2
    i = zero
    R2 = r
    I2 = i
    small_before = wanted & ~wanted
    for n in range(1, 38):
        slope = -cm * term - w0sq * tau * INVERSES[n] * before
        before = term
        term = slope * tau * INVERSES[n + 1]
        shorter = tau * INVERSES[n + 2]
        r, i = (term - Om * i) * shorter, Om * r * shorter
        E0 = select(wanted, E0 + slope, E0)
        E1 = select(wanted, E1 + term, E1)
        E2 = select(wanted, E2 + term * shorter, E2)
        R2 = select(wanted, R2 + r, R2)
        I2 = select(wanted, I2 + i, I2)
        small = abs(slope) <= EPS
        done = small & small_before & (abs(r) <= EPS * R2) & (abs(i) <= EPS * abs(I2))
        wanted = wanted & ~done
        if not any_of(wanted):
            break
        small_before = small
    return E0, E1, E2, R2, I2


def advance_phases(n, theta, theta_low, s, c, tau, K):
    """Advance each lane's phase by `tau`.

    Return (late, n, theta, theta_low, s, c), no result where `late`.
    """
    theta, theta_low = phase_after(theta, theta_low, tau, K)
    passes = theta >= TWO_PI
    theta = select(passes, theta - TWO_PI, theta)
    theta_low = select(passes, theta_low - TWO_PI_REST, theta_low)
    late = (theta >= TWO_PI) | (tau == K.period)
    theta, theta_low = in_two_parts(theta, theta_low)
    if any_of(passes):
        sine, cosine = sine_cosine(theta)
        sine, cosine = corrected(sine, cosine, theta_low)
        s = select(passes, sine, s)
        c = select(passes, cosine, c)
    return late, select(passes, n + 1.0, n), theta, theta_low, s, c


# --- sticks ---


def slip(state, remaining, K):
    """Advance sticks, one per lane, to their ends (if `good`).

    Return (good, code, boundary, t_error, state).
    """
    mode, _, n, theta, x, v, Fb, _, S, t, t_low, _, _, theta_low = state
    boundary = mode - ON_BELT
    belt = belts(boundary, K)
    good, force, side, low, high, Delta, s, c = end_of_stick(state, belt, K)
    good = good & (remaining >= K.period) & (K.driven != 0)
    if not any_of(good):
        return good, mode, mode, mode, state  # any numbers: no lane is good
    good, tau, slope, bend, s, c = slip_side_by_side(
        good, force, side, low, high, Delta, s, c, state, belt, K
    )
    good = good & (tau <= remaining)
    # what `after_stick` does
    noise = EPS * (abs(x) + 2.0 * abs(v) * tau)
    zero = 0.0 * Fb
    S = Covariance(S.S11 + noise * noise, zero, zero)
    x = x + v * tau
    late, n, theta, theta_low, s, c = advance_phases(n, theta, theta_low, s, c, tau, K)
    t, t_low = advance_time(t, t_low, tau, K)
    down = side < 0.0
    target = select(down, boundary, boundary + 1.0)
    F = select(down, zero - belt.E, zero + belt.E)
    terms = abs(constant_force(target, K)) + belt.hold + abs(K.w0sq * x) + abs(K.cm * v) + abs(K.f0)
    x_force = K.w0sq * sqrt(S.S11)
    force_error = x_force + EPS * (abs(belt.drift) * tau + terms)
    good = good & ~late & passes_at_once(force_error, abs(slope), bend, K.fB * K.Om * K.Om)
    t_error = force_error / abs(slope)
    jumps = belt.E > 0.0
    if any_of(good & jumps):
        jumped = error_after_slip(S, x_force / force_error, belt.E * t_error)
        S = Covariance(S.S11, select(jumps, jumped.S12, S.S12), select(jumps, jumped.S22, S.S22))
    after = State(target, boundary, n, theta, x, v, F, F, S, t, t_low, s, c, theta_low)
    return good, SLIP + zero, boundary, t_error, after


def end_of_stick(held, belt, K):
    """Find for each lane the piece, from `low` to `high`, in which a force on the belt changes
    monotonically to 0.

    Return (good, force, side, low, high, Delta, s, c): what `belt_exit` hands to `exit_root`.
    """
    zero = 0.0 * held.theta
    period = K.period
    first = phase_ahead(belt.angle - held.theta) / K.Om
    second = phase_ahead(PI - belt.angle - held.theta) / K.Om
    swap = belt.turns & (second < first)
    earlier = select(swap, second, first)
    later = select(swap, first, second)
    first = select(belt.turns, earlier, period)
    second = select(belt.turns, later, period)
    c_first = select(swap, -belt.c_cr, belt.c_cr)
    at_period = belt.turns & ((first == 0.0) | (second == 0.0))
    tau = zero
    Delta = zero
    s = held.s
    c = held.c
    force = zero
    side = zero
    low = zero
    high = zero
    from_Delta = zero
    from_s = zero
    from_c = zero
    open_yet = zero == 0.0
    good = zero != 0.0
    for piece in range(3):
        end = select(piece == 0, first, select(piece == 1, second, period + zero))
        end = select(end > period, period, end)
        here = open_yet & (end > tau)
        turning = belt.turns & (end < period)
        c_end = select(turning, select(piece == 0, c_first, -c_first), held.c)
        Delta_end = stick_acceleration(zero, belt.v, end, c_end - held.c, K.w0sq, K.f0)
        Delta_end = select(turning, Delta_end, belt.drift * end)
        rising = Delta_end > Delta
        force_here = select(rising, held.Fa, held.Fb)
        excess = select(rising, force_here + Delta_end, -force_here - Delta_end)
        turning = (end < period) | (at_period & (end == period))
        unclear = turning & (abs(excess) <= force_noise(held.Fb, end, held.S.S11, belt, K))
        open_yet = open_yet & ~(here & (unclear | (Delta_end == Delta)))
        ends_here = here & open_yet & (excess >= 0.0)
        good = good | ends_here
        open_yet = open_yet & ~ends_here
        force = select(ends_here, force_here, force)
        side = select(ends_here, select(rising, 1.0, -1.0), side)
        low = select(ends_here, tau, low)
        high = select(ends_here, end, high)
        from_Delta = select(ends_here, Delta, from_Delta)
        from_s = select(ends_here, s, from_s)
        from_c = select(ends_here, c, from_c)
        tau = select(here, end, tau)
        Delta = select(here, Delta_end, Delta)
        s = select(here, belt.s_cr, s)
        c = select(here, c_end, c)
    return good, force, side, low, high, from_Delta, from_s, from_c


def slip_side_by_side(good, force, side, low, high, Delta, s, c, held, belt, K):
    """Return (good, tau, slope, bend, s, c): in `good` lanes, when a stick ends, the force's
    derivatives, the phase.
    """
    # what `exit_begin` does
    over = force + Delta
    sine = select(side * K.fB < 0.0, 1.0, -1.0)
    inflection = wrap_phase(0.5 * sine * PI - held.theta) / K.Om
    between = (low < inflection) & (inflection < high)
    there = stick_acceleration(force, belt.v, inflection, -held.c, K.w0sq, K.f0)
    better = between & (abs(there) < abs(over))
    tau = select(better, inflection, low)
    over = select(better, there, over)
    s = select(better, sine + 0.0 * c, s)
    c = select(better, 0.0 * c, c)
    beyond = side * there > 0.0
    low = select(between & ~beyond, inflection, low)
    high = select(between & beyond, inflection, high)
    slope, bend = force_slopes(s, c, belt, K)
    Om2 = K.Om * K.Om
    slack = 4.0 * EPS * high
    step_before = 2.0 * (high - low)
    pending = good
    done = good & ~good
    exact = False
    shift = 0.0 * tau
    for _ in range(MOST_EVALUATIONS + 1):  # the first point is a guess, as in `exit_root`
        third = Om2 * (belt.drift - slope)
        if exact:
            fast = is_beside(over, slope, bend, K)
            fourth = -Om2 * bend
            step, missing = root_by_series(over, slope, bend, third, fourth)
            pending = pending & (over != 0.0)
            rough = pending & fast & ~(missing <= EPS * tau)
            if any_of(rough):
                found, root = newton_root_in_lanes(
                    step, over, slope, bend, third, fourth, EPS * tau, rough
                )
                step = select(rough, root, step)
                pending = pending & (~rough | found)
            within = (
                (abs(step) * K.beat < NEAR)
                & (low - slack <= tau + step)
                & (tau + step <= high + slack)
            )
            ends = pending & fast & within
            shift = select(ends, step, shift)
            done = done | ends
            pending = pending & ~ends
            if not any_of(pending):
                break
        step = parabola_step_in_lanes(over, slope, bend, third, side, high - low)
        outside = (tau + step >= high) | (tau + step <= low) | (2.0 * abs(step) > step_before)
        step = select(outside, 0.5 * (low + high) - tau, step)
        if exact:
            step_before = select(pending, abs(step), step_before)
        pending = pending & (tau + step != tau)
        tau = select(pending, tau + step, tau)
        exact = True
        Delta, sine, cosine = force_gain_in_lanes(tau, held.s, held.c, belt, K)
        s = select(pending, sine, s)
        c = select(pending, cosine, c)
        slope, bend = force_slopes(s, c, belt, K)
        over = force + Delta
        beyond = side * over > 0.0
        low = select(pending & ~beyond, tau, low)
        high = select(pending & beyond, tau, high)
    end = slips_at(tau, shift, side, -force, s, c, belt, K)
    return done, end.tau, end.slope, end.bend, end.s, end.c


def newton_root_in_lanes(s, over, F, G1, G2, G3, resolution, wanted):
    """Return (found, root) for each lane that is `wanted`: the root near `s` that `newton_root`
    finds, if a few steps are enough.
    """
    found = wanted & ~wanted
    for _ in range(NEWTON_STEPS):
        slope = F + (G1 + (0.5 * G2 + SIXTH * G3 * s) * s) * s
        change = (over + (F + (0.5 * G1 + SIXTH * (G2 + 0.25 * G3 * s) * s) * s) * s) / slope
        s = select(found, s, s - change)
        bend = G1 + (G2 + 0.5 * G3 * s) * s
        third = G2 + G3 * s
        ends = change * change * (abs(bend) + abs(third * change)) <= resolution * abs(slope)
        found = found | (wanted & ends & (slope != 0.0))
        if not any_of(wanted & ~found):
            break
    return found, s


def parabola_step_in_lanes(over, slope, bend, third, side, width):
    """Return for each lane the step to the root of the local parabola, as `parabola_step` does."""
    square = slope * slope - 2.0 * over * bend
    steepness = select(square > 0.0, side * slope + sqrt(square), 0.0 * square)
    step = select(steepness > 0.0, -2.0 * over * side / steepness, width)
    incline = slope + (bend + 0.5 * third * step) * step
    bent = (steepness > 0.0) & (side * incline > 0.0)
    return select(bent, step - SIXTH * third * step * step * step / incline, step)


def force_gain_in_lanes(tau, s0, c0, belt, K):
    """Return for each lane Delta, the gain of both forces after `tau` of stick, and sine and cosine
    of the phase.
    """
    s, c = sine_cosine(0.5 * K.Om * tau)
    return force_gain_at(tau, s, c, s0, c0, belt, K)


# --- many motions ---


@outlined
def block(flights, motions, results, accuracy, K):
    """Advance a flight (`flights`) or stick per lane from the array `motions` to `results`.

    Return good lanes as bits.
    """
    return advance_side_by_side(flights, motions, results, accuracy, K)


@outlined
def block_of_sets(flights, motions, results, accuracy, constants):
    """Advance all lanes as `block` does, but each with its own parameter set, a column of the array
    `constants`.
    """
    return advance_side_by_side(flights, motions, results, accuracy, load_constants(constants))


def advance_side_by_side(flights, motions, results, accuracy, K):
    """Advance all lanes, for `block` and `block_of_sets`.

    A constant in K is one number or one for each lane.
    """
    motion = load_motion(motions)
    state = motion.state
    t_end = motion.t_end
    t0 = motion.t0
    t_end_low = motion.t_end_low - (t_end - t0) * K.Om_gain
    remaining = (t_end - state.t) + (t_end_low - state.t_low)
    if flights:
        good, code, boundary, t_error, after = fly(state, remaining, K)
    else:
        good, code, boundary, t_error, after = slip(state, remaining, K)
    clock = time_with_errors(after.t, after.t_low, t0, after.x, after.v, t_error, after.S.S11, K)
    good = good & ~is_inexact(clock[0], clock[1], after.x, clock[2], t0, accuracy)
    store_tuple(results, LaneResult(after, code, boundary, t_error))
    return bits_of(good)


@outlined
def follow_lanes(begin, batch, most, accuracy, out, pieces, tally, table):
    """Follow the trajectories of `batch` as `follow_all` does, with motions side by side where that
    is possible.
    """
    # Not in order: where a buffer is full, a trajectory may have ended before one of a smaller
    # number.
    rows = 0
    parts = 0
    count = batch.states.shape[0]
    _, sets, _, codes = batch
    side_by_side = tally.floats.shape[0] > 0 and pieces.shape[1] == 0
    # Numbers of motions in flight and on a belt; their states, constants and results, one column
    # for each lane.
    queue = np.zeros((2, 2 * LANES), np.int64)
    motions = np.zeros((OF_MOTION, LANES))
    space = queue, motions, np.zeros((NUMBERS, LANES)), np.zeros((OF_RESULT, LANES))
    while begin < count:
        if side_by_side:
            end, alike = end_of_group(begin, sets, table)
        else:
            end = begin + 1
            alike = True
        if end - begin >= LANES // LEAST_PART:
            rows = follow_group(
                begin, end, alike, rows, batch, most, accuracy, out, pieces, tally, table, space
            )
        else:
            end = begin + 1
            if codes[begin] == RUNNING:
                rows, parts = follow_one(
                    begin, False, rows, parts, batch, most, accuracy, out, pieces, tally, table
                )
        while begin < end and codes[begin] != RUNNING:
            begin += 1
        if begin < end:
            break
    return begin, rows, parts


@outlined
def follow_group(begin, end, alike, rows, batch, most, accuracy, out, pieces, tally, table, space):
    """Follow trajectories `begin` to `end` - 1 side by side in arrays `space`.

    Return `rows`, the events so far.
    """
    out, pieces, tally, table, batch, space = borrowed((out, pieces, tally, table, batch, space))
    queue, motions, constants, results = space
    states, sets, counts, codes = batch
    asked = tally.asked.extent or tally.asked.stuck or tally.asked.ring > 0
    banded = table[sets[begin]].banded != 0
    K = table[sets[begin]]
    fullest = out.floats.shape[1]
    # lengths of the queues; steps that lanes tried, and those whose result was kept
    waiting = np.zeros(2, np.int64)
    tried = 0
    kept = 0
    while rows < fullest and (tried < PROBE or LEAST_PART * kept > tried):
        while begin < end and waiting[FLYING] + waiting[STICKING] < 2 * LANES:
            if banded:
                rows = to_band_for_lanes(
                    begin, rows, batch, most, accuracy, out, pieces, tally, table
                )
            if codes[begin] == RUNNING:
                if states[begin].mode > ON_BELT:
                    which = STICKING
                else:
                    which = FLYING
                queue[which, waiting[which]] = begin
                waiting[which] += 1
            begin += 1
        if waiting[FLYING] >= waiting[STICKING]:
            which = FLYING
        else:
            which = STICKING
        if waiting[which] < LANES // LEAST_PART:
            break
        taken = min(waiting[which], LANES)
        first = waiting[which] - taken
        waiting[which] = first
        for lane in range(LANES):
            # Lanes that are left over repeat the first motion; their results are not looked at.
            i = queue[which, first + (lane if lane < taken else 0)]
            for n in range(OF_MOTION):
                motions[n, lane] = number_in(states, i, n)
            if not alike:
                for n in range(NUMBERS):
                    constants[n, lane] = number_in(table, sets[i], n)
        if alike:
            good = block(which == FLYING, motions, results, accuracy, K)
        else:
            good = block_of_sets(which == FLYING, motions, results, accuracy, constants)
        tried += taken
        if asked:
            tally_lanes(good, taken, queue[which, first:], results, batch, most, tally, table)
        for lane in range(taken):
            i = queue[which, first + lane]
            # A good lane's result counts; else the scalar loop makes this step.
            if (good >> lane) & 1 and counts[i] < most:
                is_event = results[KIND, lane] != MOVED
                if not asked:
                    put_state(states, i, results, lane)
                    now = states[i]
                    if is_event and (now.t - now.t0) + now.t_low >= tally.floats[i, SKIPPED]:
                        tally.ints[i, EVENTS_SO_FAR] += 1
                        tally.ints[i, STICKS] += results[KIND, lane] == STICK
                if banded:
                    enter_band(states, sets, i, table)
                if is_event:
                    rows += 1
                    counts[i] += 1
                kept += 1
            else:
                rows, _ = follow_one(
                    i, True, rows, 0, batch, most, accuracy, out, pieces, tally, table
                )
            if banded:
                rows = to_band_for_lanes(i, rows, batch, most, accuracy, out, pieces, tally, table)
            if codes[i] == RUNNING:
                if states[i].mode > ON_BELT:
                    next_queue = STICKING
                else:
                    next_queue = FLYING
                queue[next_queue, waiting[next_queue]] = i
                waiting[next_queue] += 1
    # What is still queued, or was not begun, goes on alone.
    for which in range(2):
        for n in range(waiting[which]):
            rows, _ = follow_one(
                queue[which, n], False, rows, 0, batch, most, accuracy, out, pieces, tally, table
            )
    for i in range(begin, end):
        if rows < fullest and codes[i] == RUNNING:
            rows, _ = follow_one(
                i, False, rows, 0, batch, most, accuracy, out, pieces, tally, table
            )
    return rows


@outlined
def to_band_for_lanes(i, rows, batch, most, accuracy, out, pieces, tally, table):
    """Follow trajectory `i` alone until it is in a band that suits lanes.

    Return `rows`, the events so far.
    """
    out, pieces, tally, table, batch = borrowed((out, pieces, tally, table, batch))
    while (
        batch.codes[i] == RUNNING
        and rows < out.floats.shape[1]
        and not suits_lanes(table[batch.sets[i]])
    ):
        rows, _ = follow_one(i, True, rows, 0, batch, most, accuracy, out, pieces, tally, table)
    return rows


def enter_band(states, sets, i, table):
    """Let trajectory `i` go on in the next row of constants if it has left the band of its own."""
    way = band_beyond(int(states[i].mode), table[sets[i]])
    if way != 0:
        states[i].mode = MIDDLE
        states[i].at = 1 if way > 0 else 2
        sets[i] += way


def put_state(states, i, results, lane):
    """Write the state that `results` has in a lane into row `i` of `states`."""
    for n in range(OF_STATE):
        put_number(states, i, n, results[n, lane])


@outlined
def tally_lanes(good, taken, members, results, batch, most, tally, table):
    """Add the steps of the first `taken` lanes, if their bits in `good` are set, to tallies of
    motions `members`, and write their states.
    """
    members, results, table, batch, tally = borrowed((members, results, table, batch, tally))
    states, sets, counts, _ = batch
    for lane in range(taken):
        i = members[lane]
        if (good >> lane) & 1 and counts[i] < most:
            step = int(results[KIND, lane])
            boundary = int(results[BELT_THERE, lane])
            before = state_of(states[i])
            put_state(states, i, results, lane)
            after = state_of(states[i])
            event = NextEvent(step, boundary, True, results[T_ERROR, lane], after)
            tally_step(i, before, event, states[i].t0, tally, table[sets[i]])
