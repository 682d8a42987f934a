"""The linearised motion: derivatives of events with respect to parameters and the start, for every
kind of number.

This file is executed with other globals: see symosc/kernels/rebind.py.

Between two events the end of a flight is a function of its launch, of both phases and of the
parameters; the generated kernels have its partial derivatives in closed form. What ends it (a
belt's speed is reached, or a force on the belt vanishes) gives the derivative of the event's time
by the implicit function theorem. So the derivatives of all events follow from each other, through
crossings and sticks; nothing is differenced.

A motion needs no more than its columns of events: `tangents` runs over those of many motions. Each
column of derivatives has a code: the number of a parameter in `symosc.model.PARAMETER_NAMES`,
MU_S1 or MU_S2 for a static coefficient of its own, or T0, X0, V0. `codes` are those asked for, and
`deep` says whether m, c, k or Omega is among them. `work` is scratch space, with a row for each of
DT to BY_V. `starts` are rows of mode, t, theta, x, v; `sets` are indices of the motions' constants
in `table` and of their parameters in `letters`.
"""

from __future__ import annotations

from math import floor, inf, log, pi
from typing import NamedTuple

from symosc.base.aliases import Number
from symosc.engine.flow import belt_at, constant_force, drag
from symosc.engine.state import GRAZE, ON_BELT, STICK
from symosc.kernels._generated import (
    acceleration,
    flight_jacobian,
    flight_parameters,
    flight_phase,
    motion,
    stick_jacobian,
    stick_parameters,
)
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import EPS, basis
from symosc.kernels.mapping import repeated
from symosc.kernels.rebind import outlined

TWO_PI = 2.0 * pi
# A gap is not moved by what changes it by less than this part of the terms of its derivative.
UNMOVED = 1e-9
# What decides an event vanishes where it is smaller than so many roundings of its terms.
VANISHES = 1e4
# Where it is smaller than so many, derivatives keep less than ten digits.
SMALL = 1e10
# A part of a flight that is no whole number of its periods, however many it lasts.
GOLDEN = 0.6180339887498949
# Codes of columns.
M, C, K_, A0, B0, OMEGA, V1, V2, MU1, MU2, FN, MU_S1, MU_S2, T0, X0, V0 = range(16)
PARAMETERS = 13
# Marks of a derivative beside 1, regular, and 0: at a graze, whether it opens for larger or for
# smaller values.
OPENS_ABOVE = 2
OPENS_BELOW = 3
# Why a derivative does not exist from an event on; ROUGH: it does, but what it is divided by is
# small.
REGULAR, KINK, ROUGH, NO_SLOPE, FLAT_CONTACT, NO_FORCE = range(6)
# Rows of `work`: derivatives of t, x and v at the launch; of x and v at a fixed time at the end,
# with the size of the latter's terms; and derivatives of both by the parameters alone, of which
# there is a column for each parameter.
DT, DX, DV, END_X, END_V, SIZE, BY_X, BY_V = range(8)


class LaunchPoint(NamedTuple):
    """The start of a piece of a motion: mode, time, phase with its sine and cosine, position and
    velocity.
    """

    mode: int
    t: Number
    theta: Number
    s: Number
    c: Number
    x: Number
    v: Number


class Letters(NamedTuple):
    """The parameters by which forces are differentiated and that `Constants` lacks: m, mu1, mu2 and
    FN.
    """

    m: Number
    mu1: Number
    mu2: Number
    FN: Number


def launch_at(mode, t, theta, x, v):
    """Return the start of a piece of a motion as a `LaunchPoint`."""
    return LaunchPoint(int(mode), t, theta, sin(theta), cos(theta), x, v)


def letters_of(row):
    """Return four parameter values, in the order m, mu1, mu2, FN, as `Letters`."""
    return Letters(row[0], row[1], row[2], row[3])


def phase_between(start, t, theta, K):
    """Return the phase gained, whole turns included, from `start` to the time `t`, at which the
    phase is `theta`.
    """
    turn = theta - start.theta
    return turn + TWO_PI * floor((K.Om * (t - start.t) - turn) / TWO_PI + 0.5)


def fill_parameters(work, row, domain, letters, by_m, by_c, by_k, by_A, by_B, by_Om):
    """Write a quantity's derivatives by all parameters into a row of `work`, from those by m, c, k,
    A, B0, Omega.
    """
    drag1 = drag(1, domain)
    drag2 = drag(2, domain)
    work[row, M] = by_m
    work[row, C] = by_c
    work[row, K_] = by_k
    work[row, A0] = by_A
    work[row, B0] = by_B
    work[row, OMEGA] = by_Om
    work[row, V1] = 0.0 * by_A
    work[row, V2] = 0.0 * by_A
    work[row, MU1] = drag1 * letters.FN * by_A
    work[row, MU2] = drag2 * letters.FN * by_A
    work[row, FN] = (drag1 * letters.mu1 + drag2 * letters.mu2) * by_A
    work[row, MU_S1] = 0.0 * by_A
    work[row, MU_S2] = 0.0 * by_A


def hold_with_static(row, domain, boundary, letters, by_A, K, work):
    """Turn derivatives of a force at a belt, written by `fill_parameters`, into those of the force
    that decides whether the belt holds the mass: there static friction of this belt takes the place
    of kinetic friction.
    """
    belt = belt_at(boundary, K)
    if belt.E > 0.0:
        sign = drag(boundary, domain)
        work[row, MU1 + boundary - 1] = 0.0 * by_A
        work[row, MU_S1 + boundary - 1] = sign * letters.FN * by_A
        # mu_s - mu = E m/FN
        work[row, FN] += sign * (belt.E * letters.m / letters.FN) * by_A


def piece_changes(start, t, turn, codes, deep, letters, K, work):
    """Write derivatives by `codes` of x and v at time `t`, a phase `turn` after `start`, into
    `work`; return v'.
    """
    # The phase has gone on by `turn`. `deep` says whether any column needs the functions of
    # repeated roots: those for m, c, k and Omega. `codes` are the numbers of the parameters and
    # start values, one for each column.
    if start.mode > ON_BELT:
        belt = V1 + start.mode - ON_BELT - 1  # the code of the belt's speed
        for j in range(len(codes)):
            if codes[j] == belt:
                work[END_V, j] = 1.0 + 0.0 * t
            else:
                work[END_V, j] = 0.0 * t
            work[END_X, j] = work[DX, j] + work[END_V, j] * (turn / K.Om) - start.v * work[DT, j]
            work[SIZE, j] = work[END_V, j]
        return 0.0 * t
    A = constant_force(start.mode, K)
    tau = turn / K.Om
    zero = 0.0 * turn
    E0, E1, E2, R2, I2, s, c = basis(tau, K)
    a0 = acceleration(start.x, start.v, start.c, A, K.cm, K.w0sq, K.f0)
    _, dv, a = motion(start.v, a0, start.s, start.c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    x_x0, x_th0, _, v_x0, v_th0, _ = flight_jacobian(
        start.v, a0, start.v + dv, a, K.w0sq, K.Om, E0, E1, E2
    )
    x_ph, v_ph = flight_phase(start.s, start.c, K.f0, K.Om, E1, R2, I2)
    U0 = zero
    U1 = zero
    U2 = zero
    V = zero
    W = zero
    P = zero
    Q = zero
    if deep:
        U0, U1, U2, V, W, P, Q = repeated(tau, E0, E1, E2, R2, I2, s, c, K)
    x_m, v_m, x_c, v_c, x_k, v_k, x_A, v_A, x_B, v_B, x_Om, v_Om, x_v0, _ = flight_parameters(
        start.x, start.v, a0, start.s, start.c, letters.m,
        K.cm, K.w0sq, K.f0, K.Om, E1, E2, R2, I2, U0, U1, U2, V, W, P, Q,
    )  # fmt: skip
    x_Om = x_Om + x_ph * start.t
    v_Om = v_Om + v_ph * start.t
    fill_parameters(work, BY_X, start.mode, letters, x_m, x_c, x_k, x_A, x_B, x_Om)
    fill_parameters(work, BY_V, start.mode, letters, v_m, v_c, v_k, v_A, v_B, v_Om)
    x_t0 = x_th0 * K.Om
    v_t0 = v_th0 * K.Om
    for j in range(len(codes)):
        dt = work[DT, j]
        dx = work[DX, j]
        dv0 = work[DV, j]
        # The derivative of v by v at the launch is E0, which may be small.
        of_x = v_x0 * dx
        of_t = v_t0 * dt
        of_v = E0 * dv0
        work[END_X, j] = x_x0 * dx + x_t0 * dt + x_v0 * dv0
        work[END_V, j] = of_x + of_t + of_v
        work[SIZE, j] = abs(of_x) + abs(of_t) + abs(of_v)
        if codes[j] < PARAMETERS:
            work[END_X, j] += work[BY_X, codes[j]]
            work[END_V, j] += work[BY_V, codes[j]]
            work[SIZE, j] += abs(work[BY_V, codes[j]])
    return a


def force(domain, now, K):
    """Return F, the acceleration (force/m) in a domain at a point (a Launch), and the size of its
    rounding error.
    """
    A = constant_force(domain, K)
    F = acceleration(now.x, now.v, now.c, A, K.cm, K.w0sq, K.f0)
    return F, EPS * (abs(A) + abs(K.cm * now.v) + abs(K.w0sq * now.x) + abs(K.f0))


def deciding_force(domain, boundary, now, K):
    """Return the force in a domain beside a belt that decides whether the belt holds the mass, 0
    where this changes, and the size of its rounding error.
    """
    F, rounding = force(domain, now, K)
    E = belt_at(boundary, K).E
    return F + drag(boundary, domain) * E, rounding + EPS * E


def vanishes(domain, boundary, now, K):
    """Return whether the deciding force is 0 up to rounding at the point `now`."""
    F, rounding = deciding_force(domain, boundary, now, K)
    return abs(F) <= VANISHES * rounding


def force_changes(domain, boundary, now, codes, letters, K, work):
    """Write the deciding force's derivatives by `codes` into row SIZE of `work`.

    Return its rates in time by the motion and by the drive.
    """
    # Rows END_X and END_V have the derivatives of x and v at this time.
    F, rounding = deciding_force(domain, boundary, now, K)
    if abs(F) <= VANISHES * rounding:
        F = 0.0 * F
    of_c, of_k, of_A, of_B, of_v, of_m, _, _ = stick_parameters(
        now.v, 0.0 * now.t, now.x, now.c, F, letters.m, K.cm, K.Om
    )
    _, _, of_x, of_theta = stick_jacobian(now.v, now.s, K.w0sq, K.f0, K.Om)
    fill_parameters(work, BY_V, domain, letters, of_m, of_c, of_k, of_A, of_B, of_theta * now.t)
    hold_with_static(BY_V, domain, boundary, letters, of_A, K, work)
    for j in range(len(codes)):
        work[SIZE, j] = of_x * work[END_X, j] + of_v * work[END_V, j]
        if codes[j] < PARAMETERS:
            work[SIZE, j] += work[BY_V, codes[j]]
    return of_x * now.v, of_theta * K.Om


def vanishing_times(domain, boundary, now, codes, letters, K, work):
    """Write derivatives by `codes` of the time when a deciding force passes 0 into `work`.

    Return REGULAR, or what is wrong.
    """
    # Rows END_X and END_V have the derivatives of x and v at this fixed time. `force_changes` leaves
    # those of the force in row SIZE.
    by_motion, by_drive = force_changes(domain, boundary, now, codes, letters, K, work)
    rate = by_motion + by_drive
    rounding = EPS * (abs(by_motion) + abs(K.f0 * K.Om))
    flat = abs(rate) <= VANISHES * rounding
    for j in range(len(codes)):
        work[DT, j] = -work[SIZE, j] / (1.0 if flat else rate)
    if flat:
        return NO_SLOPE
    if abs(rate) <= SMALL * rounding:
        return ROUGH
    return REGULAR


def contact_times(domain, boundary, now, a, codes, K, work):
    """Write derivatives by `codes` of when a flight meets a belt with v' = `a`.

    Return as `vanishing_times` does.
    """
    # `a` is the acceleration that the flight arrives with: the balance of forces at a rounded point
    # may know it worse.
    belt = V1 + boundary - 1  # the code of the belt's speed
    for j in range(len(codes)):
        if codes[j] == belt:
            own = 1.0  # the belt's speed itself changes
        else:
            own = 0.0
        work[DT, j] = (own - work[END_V, j]) / (1.0 if a == 0.0 else a)
    F, rounding = force(domain, now, K)
    if abs(F) <= VANISHES * rounding:
        return FLAT_CONTACT
    if domain == boundary:
        far_domain = boundary + 1
    else:
        far_domain = boundary
    if vanishes(far_domain, boundary, now, K):
        return NO_FORCE
    if abs(F) <= SMALL * rounding:
        return ROUGH
    return REGULAR


def kinks(above, belt, codes, marks, n, regular, before, work):
    """Mark in row `n` of `marks` which of `codes` turn a graze into a crossing or a miss.

    Return whether any does.
    """
    has_kink = False
    for j in range(len(regular)):
        if codes[j] == belt:
            own = 1.0  # the belt's speed itself changes
        else:
            own = 0.0
        moved = work[END_V, j] - own
        if abs(moved) > UNMOVED * (work[SIZE, j] + before[SIZE, j] + own):
            if (moved > 0.0) == above:
                marks[n, j] = OPENS_ABOVE
            else:
                marks[n, j] = OPENS_BELOW
            regular[j] = False
            has_kink = True
    return has_kink


@outlined
def tangents(motions, cuts, starts, sets, rows, codes, deep, letters, table, out, work):
    """Write derivatives of t and x at all events of `motions` into `out`, by the parameters and
    starts in `codes`.
    """
    # `cuts` are the first rows of the motions and the end of the last one, `starts` rows of mode,
    # t, theta, x, v. `rows` are t, theta, x, v of the events and their kind, boundary and target.
    # `out` has dt, dx, marks and reasons of the events, and for each motion the logarithms of what
    # its last columns and its areas have grown by: columns beyond those of dt are kept near 1 and
    # counted there.
    times, thetas, xs, vs, kinds_, boundaries, targets = rows
    dts, dxs, marks, reasons, growth = out
    count = dts.shape[1]
    for i in motions:
        K = table[sets[i]]
        own_letters = letters_of(letters[sets[i]])
        start = launch_at(starts[i, 0], starts[i, 1], starts[i, 2], starts[i, 3], starts[i, 4])
        regular = begin(start, codes, count, own_letters, K, work)
        for n in range(cuts[i], cuts[i + 1]):
            now = launch_at(targets[n], times[n], thetas[n], xs[n], vs[n])
            turn = phase_between(start, now.t, now.theta, K)
            boundary = boundaries[n]
            kind = kinds_[n]
            belt = V1 + boundary - 1  # the code of the belt's speed
            kept = work
            touched = False
            # What is usual on the way to a graze is the scale of what vanishes there.
            if kind == GRAZE:
                piece_changes(
                    start,
                    start.t + GOLDEN * (now.t - start.t),
                    GOLDEN * turn,
                    codes,
                    deep,
                    own_letters,
                    K,
                    work,
                )
                kept = work[: SIZE + 1].copy()
            a = piece_changes(start, now.t, turn, codes, deep, own_letters, K, work)
            if kind == GRAZE:
                touched = kinks(start.mode != boundary, belt, codes, marks, n, regular, kept, work)
                vanishing_times(start.mode, boundary, now, codes, own_letters, K, work)
                if touched:
                    reason = KINK
                else:
                    reason = REGULAR
            elif start.mode > ON_BELT:
                reason = vanishing_times(now.mode, boundary, now, codes, own_letters, K, work)
            else:
                reason = contact_times(start.mode, boundary, now, a, codes, K, work)
            reasons[n] = reason
            for j in range(len(codes)):
                work[DX, j] = work[END_X, j] + now.v * work[DT, j]
                if codes[j] == belt:
                    work[DV, j] = 1.0 + 0.0 * now.t
                else:
                    work[DV, j] = 0.0 * now.t
            for j in range(count):
                regular[j] = regular[j] and reason <= ROUGH
                dts[n, j] = work[DT, j]
                dxs[n, j] = work[DX, j]
                if not touched or marks[n, j] == 0:
                    if regular[j]:
                        marks[n, j] = 1
                    else:
                        marks[n, j] = 0
            if kind == GRAZE:  # the flight goes on from its launch
                work[: SIZE + 1] = kept
                continue
            if len(codes) > count:
                grow(i, start, now, kind, turn, growth, count, len(codes), K, work)
            start = now


@outlined
def changes_at(times, pieces, starts, launched, codes, deep, letters, table, out, work):
    """Write derivatives of x and v at fixed `times` by `codes` into `out`, from those where pieces
    are `launched`.
    """
    # `pieces` are the numbers of the pieces in which the times lie. Pieces begin at `starts`, rows
    # as in `tangents`; `launched` (3, pieces, columns) are the derivatives of t, x and v where they
    # begin.
    K = table[0]
    own_letters = letters_of(letters[0])
    for n in range(len(times)):
        i = pieces[n]
        start = launch_at(starts[i, 0], starts[i, 1], starts[i, 2], starts[i, 3], starts[i, 4])
        for j in range(len(codes)):
            for row in range(DV + 1):
                work[row, j] = launched[row, i, j]
        piece_changes(
            start, times[n], K.Om * (times[n] - start.t), codes, deep, own_letters, K, work
        )
        for j in range(len(codes)):
            out[0, n, j] = work[END_X, j]
            out[1, n, j] = work[END_V, j]


def begin(start, codes, count, letters, K, work):
    """Write derivatives of t, x, v at a start by `codes` into `work`.

    Return which of the first `count` are valid.
    """
    # On a belt a column is not valid if its number takes the start off the belt, or may change a force
    # that is 0 there.
    regular = [True] * count
    for j in range(len(codes)):
        for row in range(DV + 1):
            if codes[j] == T0 + row:
                work[row, j] = 1.0 + 0.0 * start.t
            else:
                work[row, j] = 0.0 * start.t
    for boundary in range(1, ON_BELT):
        belt = V1 + boundary - 1  # the code of its speed
        if start.v != belt_at(boundary, K).v:
            continue
        for j in range(count):
            regular[j] = codes[j] != V0 and codes[j] != belt
        for domain in (boundary, boundary + 1):
            if not vanishes(domain, boundary, start, K):
                continue
            for j in range(count):
                work[END_X, j] = work[DX, j]
                work[END_V, j] = 0.0 * start.t
            by_motion, by_drive = force_changes(
                domain, boundary, start, codes[:count], letters, K, work
            )
            fixed = is_kept_in_time(by_motion, by_drive, start, K)
            for j in range(count):
                if work[SIZE, j] != 0.0 or (codes[j] == T0 and not fixed):
                    regular[j] = False
    return regular


def is_kept_in_time(by_motion, by_drive, start, K):
    """Return whether a force that is 0 at a start decides the same if the start is a little earlier
    or later.

    So it is at a turn of the drive only, where the force changes as cos(Omega t) bends.
    """
    turns = abs(by_drive) <= UNMOVED * abs(K.f0 * K.Om)
    return turns and by_motion * start.c * K.f0 <= 0.0


def grow(i, start, now, kind, turn, growth, count, columns, K, work):
    """Scale columns of derivatives from `count` on to size 1.

    Add logs of this and of the areas' factor to `growth`.
    """
    size = 0.0
    for row in range(DV + 1):
        for j in range(count, columns):
            size = max(size, abs(float(work[row, j])))
    if size > 0.0:
        growth[i, 0] += log(size)
        for row in range(DV + 1):
            for j in range(count, columns):
                work[row, j] = work[row, j] / size
    if start.mode > ON_BELT or kind == STICK:  # a belt takes the velocity away: no area is left
        growth[i, 1] = -inf
    else:
        before = force(start.mode, now, K)[0]
        after = force(now.mode, now, K)[0]
        if before != 0.0:
            ratio = abs(float(after / before))
        else:
            ratio = 1.0
        # a flight shrinks areas by exp(-(c/m) time), a crossing changes them by the forces' ratio
        growth[i, 1] += (log(ratio) if ratio > 0.0 else 0.0) - float(K.cm * turn / K.Om)
