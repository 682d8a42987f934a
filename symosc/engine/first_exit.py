"""The first exit from a domain or a belt.

This file is executed with other globals: see symosc/kernels/rebind.py.

In real arithmetic no crossing is missed, however near to a graze.

Flights. In a domain the gap g = +-(v - v_lambda) between the velocity and a wall is smooth. At a
time tau its derivatives up to the third are evaluated, and the fourth is bounded for all later
times (`fourth_derivative_bound`):

    |d^4 v/dt^4| <= M4 = V0 Omega^4 + sqrt(G3^2 + w0^2 G2^2)

with V0 the amplitude of the steady velocity and G2, G3 the third and fourth derivative of the
transient, whose energy G3^2 + w0^2 G2^2 never grows. Near undamped resonance the two parts cannot
be separated; then the same argument for the whole derivative gives M4 = sqrt(G3^2 + w0^2 G2^2) +
|B0| Omega^3/m over the next 1/Omega of time. In a band with negative damping, h < 0, the root of
this energy grows by at most exp(2 |h| tau), which is less than `K.growth` as long as one search
lasts; all that is bounded by it is multiplied by that factor, which is 1 elsewhere. Hence

    g(tau + s) >= P(s) = g + g' s + g'' s^2/2 + g''' s^3/6 - M4 s^4/24

and g has no root before the first root of P. A step goes no further than that (`safe_step`), and
the steps converge on a simple root from the left; once P shows that the first root is the only one
nearby, its place is improved with the true derivatives (`sharpened`). At a start on the wall the
known root is divided out of P. Where the closed form is cheap, `march` goes ahead with the same
bound in fixed steps, and mostly finds the one step in which a wall is met.

Near a tangency the minimum of the gap ahead is compared with its error, from rounding and from the
start (`tolerance`). If it is clearly positive, the bound taken at the minimum, backward, excludes a
root on the way to it; if clearly negative there is a crossing, which the steps find. If neither,
the contact is undecided and returned as a tangency.

Sticks. On belt lambda both forces change alike, so that after a time tau

    F^(below) = F_below + Delta(tau),   F^(above) = F_above + Delta(tau),
    Delta(tau) = -(k/m) v_lambda tau + (B0/m) (cos(theta + Omega tau) - cos(theta)).

The stick ends when F^(below) falls to 0 or F^(above) rises to 0, (52) and (53) of the paper. Delta
is monotone between the phases with sin(theta) = -k v_lambda/(B0 Omega): each such piece is decided
by the value at its end.

The bound and the steps are a proof in real arithmetic, derived in the chapter on events. Evaluated
with rounding, decisions must exceed ROUNDING errors, and marching steps MARCH_SLACK of the size of
the gap; we have measured, not proved, that these margins suffice in double precision
(tests/simulation/test_fuzz.py compares random scenes with an independent search).

Arguments that many functions share: `start` is the Launch of a flight, with velocity `v0`; `now`
and `there` are points of it (`Flown`), `tau` a time since the launch, and `tau_max` the end of the
search. `walls` are the gaps at launch, and `side` is -1 for the lower wall and 1 for the upper one.
`M4` is the bound above, and `S` the covariance of the errors at launch. `slack` is what a gap must
exceed in a march, `margin` what the errors can do to it, `thin` the square below which it is
compared with its error. `over` is what is to become 0: in a flight v - v_lambda, which is the gap of
the lower wall and minus the gap of the upper one; in a stick the force. For sticks, `held` is the
State at the beginning, `s0` and `c0` are sine and cosine of the phase then, `s` and `c` those now.
`K` are the Constants.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on pairs and
mpmath numbers; `0.0 * tau` is a zero of the same kind of number as `tau`.
"""

from __future__ import annotations

from math import acos, sqrt
from typing import NamedTuple

from symosc.base.aliases import Number
from symosc.engine.flow import derivatives, fifth_derivative, state_at, turned, velocity_scale
from symosc.engine.state import (
    HIT,
    LOST,
    NOTHING,
    STALLED,
    TANGENCY,
    FlightEnd,
    Flown,
    StickEnd,
    Walls,
)
from symosc.kernels._generated import next_derivative, stick_acceleration
from symosc.kernels.elementary import cos, select, sin
from symosc.kernels.entire import EPS, SIXTH
from symosc.kernels.rebind import outlined

PI = acos(-1.0)
# What a decision must exceed, in units of EPS times the sum of the sizes of the terms. Gaps are
# wrong by at most 6 such units (measured by test_gaps_are_wrong_by_few_roundings).
ROUNDING = 64.0
# A root is taken from the local polynomial when that is sure to place it within ISOLATED / rate:
# one step of Halley's method (`sharpened`) leaves the cube of that, 2e-4, which is below NEAR.
ISOLATED = 6e-2
# A shift below NEAR / rate is made by Taylor's formula: what that leaves out, NEAR^5/720 of the
# first term, is below EPS.
NEAR = 2.0 * EPS**0.2
FAR = 1e300  # larger than any root
# How far a safe step stays before the root that it aims at, as a part of the step: more than what
# Halley's method leaves (FIRM^3).
SHRINK = 1e-3
# A root of P is taken as found when Halley's last step was shorter than this part of it: the next
# would be its cube.
FIRM = 1e-2
# A root after which the gap gets deeper than this part of its size is no touch: 1e-9 is some
# million roundings.
DEEP = 1e-9
# What a gap must exceed while marching, as a part of its size: a million roundings, where each step
# adds a few.
MARCH_SLACK = 1e-10
# A gap of so many times what a stride needs, about 50^4, allows a step of 50 strides: the bound
# grows with the fourth power.
WIDE_GAP = 6e6
# Steps shorter than this, times 1/rate, are a sign of a tangency ahead. The value decides about the
# time only: no step passes a contact.
SHORT_STEP = 4e-3
# A gap smaller than this part of the velocities in question, some million roundings, is compared
# with its error.
THIN = 1e-9
# An error of the start that is smaller than THIN times the root of this part of the velocities, a
# thousand roundings, is rounding.
FAINT = 1e-8
# A gap within its error that leaves it within this time, times 1/rate, is on its way through 0.
SOON = 1e-2
SAME_PHASE = 64.0  # phases closer than this times EPS are one, as in ROUNDING
# Limits of loops that come to their end by themselves, unless a number is NaN.
MOST_STEPS = 20000
MOST_STICK_STEPS = 20000
MOST_NEWTON = 200
MOST_DESCENTS = 400
MOST_HALVINGS = 400
# Steps towards a minimum that do not get shorter: the gap dies away, without a minimum.
MOST_EVEN = 12
# Corrections of a time with many digits: each makes five times as many digits right.
MOST_CORRECTIONS = 8
# Short steps on which no minimum of the gap was found ahead, before the search is given up. Beside
# a gap that has 1e-30 of its usual size, and hardly bends, it takes a hundred to get away
# (test_a_near_miss_beside_which_the_gap_hardly_bends_is_decided).
MOST_STALLS = 150


# --- bounds of a gap ---


def fourth_derivative_bound(G2, G3, s, c, K):
    """Return a bound M4 of |v''''| from now on, given G2 = v''', G3 = v'''' and the phase.

    It holds for the rest of the search if `K.steady`, else for 1/Omega.
    """
    if not K.steady:
        return (sqrt(G3 * G3 + K.w0sq * G2 * G2) + abs(K.fB) * K.Om * K.Om) * K.growth
    Om3 = K.Om * K.Om * K.Om
    G2_transient = G2 - Om3 * (K.Sc * s - K.Ss * c)
    G3_transient = G3 - Om3 * K.Om * (K.Ss * s + K.Sc * c)
    energy = G3_transient * G3_transient + K.w0sq * G2_transient * G2_transient
    return K.V0 * Om3 * K.Om + sqrt(energy) * K.growth


def positive_on(s, P):
    """Return whether a polynomial is proven positive on [0, s], by its Bernstein coefficients.

    `P` holds its coefficients p0 to p4.
    """
    # On [0, s] a polynomial is a mean of its Bernstein coefficients: here first p0 and the next two,
    # then the last two.
    p0, p1, p2, p3, p4 = P
    t1 = p1 * s
    t2 = p2 * s * s
    t3 = p3 * s * s * s
    if p0 <= 0.0 or p0 + 0.25 * t1 <= 0.0 or p0 + 0.5 * t1 + SIXTH * t2 <= 0.0:
        return False
    return (
        p0 + 0.75 * t1 + 0.5 * t2 + 0.25 * t3 > 0.0 and p0 + t1 + t2 + t3 + p4 * s * s * s * s > 0.0
    )


def safe_step(cap, P):
    """Return (s, root): a step s <= cap on which the polynomial `P` stays positive, and an estimate
    of its first root.

    `P` holds the coefficients p0 to p4; the estimate is at most cap.
    """
    # First the root of the quadratic, then Halley's method; the result is checked before it is
    # used. The estimate is `cap` where Halley's method did not settle (`is_firm`).
    p0, p1, p2, p3, p4 = P
    if p0 <= 0.0:
        return 0.0 * cap, cap
    root = cap
    is_firm = False
    square = p1 * p1 - 4.0 * p0 * p2
    if square > 0.0 and (p1 < 0.0 or p2 < 0.0):
        denominator = sqrt(square) - p1
        if 2.0 * p0 < cap * denominator:
            root = 2.0 * p0 / denominator
    for _ in range(4):
        value = p0 + (p1 + (p2 + (p3 + p4 * root) * root) * root) * root
        slope = p1 + (2.0 * p2 + (3.0 * p3 + 4.0 * p4 * root) * root) * root
        half_bend = p2 + (3.0 * p3 + 6.0 * p4 * root) * root
        halley = slope * slope - value * half_bend
        if slope >= 0.0 or halley <= 0.0:  # no root is ahead
            break
        shift = value * slope / halley
        if shift >= root:
            break
        root = root - shift
        if root >= cap:
            root = cap
            break
        is_firm = abs(shift) < FIRM * root
        if is_firm:
            break
    if is_firm:
        s = root - SHRINK * root
    else:
        s = root
    while s > 0.0 and not positive_on(s, P):
        s = 0.5 * s
        is_firm = False
    return s, root if is_firm else cap


def gap_to(side, now, walls):
    """Return the distance of v at point `now` from the lower (`side` -1) or upper (1) of the
    `walls` of a flight.
    """
    return select(side < 0, walls.below + now.dv, walls.above - now.dv)


def gap_bound(side, now, M4, margin, walls):
    """Return (P, degree): P, times s^(4 - degree), is a lower bound of the gap on `side` at the time s
    after `now`.

    `P` holds the coefficients p0 to p4 of a polynomial in s.
    """
    # The gap of the lower wall (side -1) grows with v, that of the upper one falls. The margin for the
    # error of the start is held back from the gap, or half the gap if that is not much larger. At a
    # start on the wall P is divided by its root there.
    g = gap_to(side, now, walls)
    g1 = -side * now.F
    g2 = -side * now.G1
    g3 = -side * now.G2
    top = -0.25 * SIXTH * M4
    zero = 0.0 * g
    if not (now.tau == 0.0 and (walls.on_below if side < 0 else walls.on_above)):
        if margin > 0.0:
            if g > 2.0 * margin:
                g = g - margin
            else:
                g = 0.5 * g
        return (g, g1, 0.5 * g2, SIXTH * g3, top), 4
    if g1 > 0.0:
        return (g1, 0.5 * g2, SIXTH * g3, top, zero), 3
    if g2 > 0.0:
        return (0.5 * g2, SIXTH * g3, top, zero, zero), 2
    return (SIXTH * g3, top, zero, zero, zero), 1


def is_near(root, P, degree, M4, size, K):
    """Return three flags of the gap beside the `root` of its bound `P`: it has just one root there
    (near); so near that Taylor's formula reaches it (close); and no touch (deep).
    """
    # One root near `root`, and only one: the gap there is known to be within `missing` of 0, and
    # its slope keeps its sign up to there and over what makes up for `missing` (Kantorovich, who
    # asks for a factor of 2 where 8 is). The gap exceeds P by twice P's last term at most.
    p0, p1, p2, p3, p4 = P
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
    # With this slope and bend a gap gets slope^2/(2 bend) deep behind its root.
    depth = slope * slope
    for _ in range(4 - degree):  # back from the divided polynomial to the gap
        depth = depth * root
    return near, missing * K.rate < NEAR * slope, depth > 2.0 * DEEP * size * bend


def local_root(over, F, G1, G2, G3, resolution):
    """Return the root s near 0 of over + F s + G1 s^2/2 + G2 s^3/6 + G3 s^4/24 (FAR if none), to
    `resolution`.
    """
    # The inverted series places a near simple root to `resolution`, as its error says; else Newton's
    # method goes on from there, or from 0 if the bend is too large for the series.
    s = 0.0 * resolution
    if abs(over * G1) < 0.1 * F * F:
        s, missing = root_by_series(over, F, G1, G2, G3)
        if missing <= resolution:
            return s
    return newton_root(s, over, F, G1, G2, G3, resolution)


def root_by_series(over, F, G1, G2, G3):
    """Estimate the root near 0 of the polynomial of `local_root` by the inverse series.

    Return the root and a bound of its error.
    """
    # With e = over/F (`linear`), B = G1 e/(2 F) and W = G2 e^2/(6 F) the root is
    # -e (1 + B + 2 B^2 - W + ...). The next terms are 5 B (B^2 - W) and G3 e^3/(24 F).
    inverse = 1.0 / F
    linear = over * inverse
    B = 0.5 * G1 * inverse * linear
    W = SIXTH * G2 * inverse * linear * linear
    missing = 8.0 * abs(B) * (B * B + abs(W)) + abs(G3 * inverse * linear * linear * linear)
    return -linear * ((1.0 + B) + (2.0 * B * B - W)), abs(linear) * missing


@outlined
def newton_root(s, over, F, G1, G2, G3, resolution):
    """Find the root near `s` of the polynomial of `local_root` by Newton's method.

    FAR or more: none.
    """
    for _ in range(MOST_NEWTON):
        slope = F + (G1 + (0.5 * G2 + SIXTH * G3 * s) * s) * s
        if slope == 0.0:
            return s
        change = (over + (F + (0.5 * G1 + SIXTH * (G2 + 0.25 * G3 * s) * s) * s) * s) / slope
        s = s - change
        bend = G1 + (G2 + 0.5 * G3 * s) * s
        third = G2 + G3 * s
        # The next step would be shorter than that.
        if change * change * (abs(bend) + abs(third * change)) <= resolution * abs(slope):
            return s
    return FAR + s


# --- marching in fixed steps, which cost no exp, sin or cos ---


class Marched(NamedTuple):
    """The result of a march in fixed steps: where it ended, and which wall the next step surely
    meets, if any.
    """

    now: Flown  # up to there no wall is met; without dx and the entire functions
    M4: Number  # the bound of the fourth derivative from there on
    # of the wall that the next step surely meets, and only once; 0: not known, or `march` ended
    # where `stepped` is faster
    side: int
    there: Flown  # the end of that step, without its last two derivatives (`with_derivatives`)


def march(tau_max, v0, now, walls, margin, K):
    """Follow a flight from `now` to `tau_max` by fixed steps, while they surely meet no wall.

    Return a `Marched`. Under a slow drive it ends, with side 0, also where the gaps get wide.
    """
    # Over a fixed step the transient is multiplied by a constant matrix and the steady state turns
    # by a constant angle, so the derivatives cost no exp, sin or cos. Their rounding errors are far
    # below the slack that the gaps are given. Strides are tried where the gaps look wide enough.
    #
    # Both ends of a step are known, and so is Hermite's cubic of a gap g between them. At the part
    # t of a step of length h its error is
    #
    #     |g - cubic| <= 6 t^2 (1 - t)^2 M4 h^4/144,
    #
    # at the most a sixteenth of the rest of Taylor's formula from one end (`is_free`).
    v_free, F_free, slack, beyond_below, beyond_above = free_motion(v0, now, walls, margin, K)
    has_below = walls.has_below and not beyond_below
    has_above = walls.has_above and not beyond_above
    walls = Walls(walls.below, walls.above, has_below, has_above, walls.on_below, walls.on_above)
    M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
    since = now.tau
    stride = K.stride.step
    wide_per_M4 = WIDE_GAP * 0.25 * SIXTH * (stride * stride) * (stride * stride)
    long = seems_free(stride, now, walls)
    while True:
        if long:
            M = K.stride
        else:
            M = K.march
        h = M.step
        there = now
        free_below = False
        free_above = False
        if now.tau + h < tau_max:
            v_next, F_next, there = marched(v_free, F_free, v0, now, M, K)
            lift = lifted(h, M4, slack)
            free_below = not has_below or is_free(-1, now, there, lift, slack, walls)
            free_above = not has_above or is_free(1, now, there, lift, slack, walls)
        if free_below and free_above:
            now = there
            v_free = v_next
            F_free = F_next
            long = seems_free(stride, now, walls)
            if not K.slow_drive:
                continue
        # A usual step failed, and a new bound cannot help: it is that of this point, or the step
        # does end beyond a wall.
        elif not long and (since == now.tau or not gaps_exceed(0.0, there.dv, walls)):
            now = with_derivatives(now, v0, K)
            M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
            side = wall_met(now, there, free_below, free_above, M4, slack, walls)
            return Marched(now, M4, side, there)
        else:  # once more, by a usual step or with a new bound
            long = False
        if since < now.tau:
            # The bound never grows: until here one of an earlier time was good enough.
            since = now.tau
            now = with_derivatives(now, v0, K)
            M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
        # with the free motion gone, steps of their own length go farther
        if K.slow_drive and gaps_exceed(wide_per_M4 * M4, now.dv, walls):
            return Marched(now, M4, 0, now)


def seems_free(stride, now, walls):
    """Return whether the gaps look open after a `stride` from point `now`: a guess, no proof."""
    return gaps_exceed(0.0, now.dv + (now.F + 0.5 * now.G1 * stride) * stride, walls)


def wall_met(now, there, free_below, free_above, M4, slack, walls):
    """Return the side of the wall that a step from `now` to `there` surely meets once, and none
    before; 0 if that is not sure.
    """
    if free_below and meets_once(1, now, there, M4, slack, walls):
        return 1
    if free_above and meets_once(-1, now, there, M4, slack, walls):
        return -1
    return 0


def free_motion(v0, now, walls, margin, K):
    """Return (v_free, F_free, slack, beyond_below, beyond_above): v and v' of the transient at `now`,
    what gaps must exceed, and which walls are out of reach.
    """
    v_free = v0 - (K.Ss * now.s + K.Sc * now.c)
    F_free = now.F - K.Om * (K.Ss * now.c - K.Sc * now.s)
    slack = MARCH_SLACK * (abs(v0) + K.V0 + abs(v_free) + abs(F_free) * K.swing) + margin
    # The steady amplitude and the energy of the transient bound v: walls beyond that do not count.
    # `far_below` and `far_above` are what the transient would have to reach; v0 - walls.below is the
    # speed of the lower belt, v0 + walls.above that of the upper one.
    energy = (F_free * F_free + K.w0sq * v_free * v_free) * (K.growth * K.growth)
    far_below = walls.below - v0 - K.V0 - slack
    far_above = v0 + walls.above - K.V0 - slack
    beyond_below = (far_below > 0.0) & (energy < K.w0sq * far_below * far_below)
    beyond_above = (far_above > 0.0) & (energy < K.w0sq * far_above * far_above)
    return v_free, F_free, slack, beyond_below, beyond_above


def marched(v_free, F_free, v0, now, M, K):
    """Advance a flight by a fixed step `M` from point `now`.

    Return v and v' of its transient, and the new point.
    """
    v_next = M.C * v_free + M.E1 * F_free
    F_next = M.D * v_free + M.E0 * F_free
    s = M.c * now.s + M.s * now.c
    c = M.c * now.c - M.s * now.s
    dv = v_next + (K.Ss * s + K.Sc * c) - v0
    F = F_next + K.Om * (K.Ss * c - K.Sc * s)
    G1 = next_derivative(F, v0 + dv, K.fB * s, K.cm, K.w0sq)
    return (
        v_next,
        F_next,
        Flown(now.tau + M.step, now.dx, dv, F, G1, now.G2, now.G3, s, c, now.E0, now.E1, now.E2),
    )


def lifted(h, M4, slack):
    """Return what a gap's middle Bernstein coefficient must exceed in a step `h` so that the gap
    exceeds `slack`: M4 h^4/144 more, as `is_free` derives.
    """
    return 0.25 * SIXTH * SIXTH * (h * h) * (h * h) * M4 + slack


def with_derivatives(now, v0, K):
    """Return the point `now` with v'', v''' and v'''' computed, except at tau = 0, where they are
    known.
    """
    if now.tau == 0.0:
        return now
    tau, dx, dv, F, _, _, _, s, c, E0, E1, E2 = now
    G1, G2, G3 = derivatives(v0 + dv, F, s, c, K)
    return Flown(tau, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2)


def gaps_exceed(least, dv, walls):
    """Return whether the gaps to all `walls` exceed `least` when the velocity has grown by `dv`
    since the launch.
    """
    return (not walls.has_below or walls.below + dv > least) and (
        not walls.has_above or walls.above - dv > least
    )


def is_free(side, now, there, lift, slack, walls):
    """Return whether a step from `now` to `there` surely meets no wall on `side`.

    `lift`, `slack`: see `stays_open`.
    """
    # The cubic less its error is a polynomial of degree four whose Bernstein coefficients are g0,
    # g0 + d0/4, (g0 + g1)/2 + (d0 - d1)/6 - M4 h^4/144, g1 - d1/4 and g1, with the values g0, g1
    # and the slopes times h, d0, d1, at both ends. If they are positive, so is the gap. At a start
    # on the wall, where g0 = 0, the other four show that it has no other root. Without a slope
    # there (d0 = 0) the bend b0 counts, times h^2: the coefficients of the cubic through g0, d0, b0
    # and g1, less t^3 (1 - t) M4 h^4/24, are 0, 0, b0/12, b0/8 + g1/4 - M4 h^4/96 and g1.
    h = there.tau - now.tau
    if side < 0:
        gap = walls.below
    else:
        gap = walls.above
    g0 = gap - side * now.dv
    d0 = -side * h * now.F
    g1 = gap - side * there.dv
    d1 = -side * h * there.F
    if now.tau == 0.0 and (walls.on_below if side < 0 else walls.on_above):
        return opens(d0, -side * h * h * now.G1, g1, d1, lift, slack)
    return stays_open(g0, d0, g1, d1, lift, slack)


def stays_open(g0, d0, g1, d1, lift, slack):
    """Return whether a gap exceeds `slack` in a whole step, given its values g0, g1 and slopes d0,
    d1 at the ends.

    Slopes are multiplied by the length of the step, and `lift` is what `lifted` returns for it.
    """
    ends = (g0 > slack) & (g0 + 0.25 * d0 > slack) & (g1 > slack) & (g1 - 0.25 * d1 > slack)
    return ends & (0.5 * (g0 + g1) + SIXTH * (d0 - d1) > lift)


def opens(d0, b0, g1, d1, lift, slack):
    """Return what `stays_open` does after the start of a step where the gap is 0, with slope d0 and
    bend b0.
    """
    # The coefficients are those of `is_free` with g0 = 0; 1.5 lift makes M4 h^4/144 M4 h^4/96.
    steep = (d0 >= 0.0) & (g1 - 0.25 * d1 > slack) & (0.5 * g1 + SIXTH * (d0 - d1) > lift)
    flat = (d0 == 0.0) & (b0 >= 0.0) & (0.125 * b0 + 0.25 * g1 > 1.5 * lift)
    return (g1 > slack) & (steep | flat)


def meets_once(side, now, there, M4, slack, walls):
    """Return whether the gap on `side` is > `slack` at `now`, < -`slack` at `there`, and surely 0
    only once between.
    """
    # It is if its slope, d0 and d1 at the ends, is negative all the way, or if its bend, b0 and b1,
    # keeps its sign. The Bernstein coefficients of the slope, with its error, are d0, d0 + h b0/3,
    # (2 d0 + h b0 + d1)/3 + M4 h^3/18 and d1, those of the bend b0, (b0 + b1)/2 -+ M4 h^2/4 and b1.
    meets = (gap_to(side, there, walls) < -slack) & (gap_to(side, now, walls) > slack)
    h = there.tau - now.tau
    d0 = -side * now.F
    b0 = -side * now.G1
    d1 = -side * there.F
    b1 = -side * there.G1
    loose = SIXTH * h * h * M4
    slopes_fall = (d0 + 2.0 * SIXTH * h * b0 < 0.0) & (2.0 * d0 + h * b0 + d1 + loose * h < 0.0)
    falls = (d0 < 0.0) & (d1 < 0.0) & slopes_fall
    half = 0.5 * (b0 + b1)
    bend = 1.5 * loose
    bends = ((b0 < 0.0) & (b1 < 0.0) & (half + bend < 0.0)) | (
        (b0 > 0.0) & (b1 > 0.0) & (half - bend > 0.0)
    )
    return meets & (falls | bends)


# --- grazes: the minimum of a gap near a tangency, and how far a gap may be wrong there ---


@outlined
def tolerance(side, now, start, walls, S, K):
    """Return how far the gap on `side` (a velocity) may be wrong at point `now`, by rounding and by
    `K.sigmas` standard errors from the covariance `S` at launch.
    """
    # Errors of x and v at launch move v by -(k/m) E1 and E0 times themselves.
    if side < 0:
        start_gap = walls.below
    else:
        start_gap = walls.above
    pull = -K.w0sq * now.E1
    variance = pull * pull * S.S11 + 2.0 * pull * now.E0 * S.S12 + now.E0 * now.E0 * S.S22
    size = velocity_scale(now.tau, start.v, start.F, K) + start_gap
    # A force that is not 0 was rounded as its terms, which may be much larger; that of x counts in S.
    if start.F != 0.0:
        size = size + (abs(K.f0) + abs(K.cm * start.v)) * abs(now.E1)
    return ROUNDING * EPS * size + K.sigmas * sqrt(abs(variance))


@outlined
def closest_approach(tau, earliest, side, M4, start, walls, S, K):
    """Find the next minimum of the gap on `side` near `tau`; return a code, and its time.

    NOTHING: it is positive. HIT: negative. TANGENCY, LOST: 0 within its error, for a moment or for
    good. STALLED: it is not found, or comes before `earliest`. `M4` bounds the fourth derivative of
    v.
    """
    # NOTHING says that the gap is positive on the way there too, STALLED also that this is not
    # proven. Each step goes to the minimum of the local parabola.
    begin = tau
    sign = -side  # of the gap's derivatives against those of v
    last_shift = FAR
    depth_known = False
    even_steps = 0
    for _ in range(MOST_DESCENTS):
        now = state_at(tau, start, K)
        gap = gap_to(side, now, walls)
        slope = sign * now.F
        bend = sign * now.G1
        allowed = tolerance(side, now, start, walls, S, K)
        if bend <= 0.0 and not depth_known:
            return STALLED, tau
        if bend > 0.0:
            shift = -slope / bend
        else:
            shift = 0.0 * slope
        # The depth of the minimum is known if the next step would hardly change the gap, or if the
        # gap is clearly negative.
        if abs(slope * shift) <= 0.25 * allowed or gap < -2.0 * allowed:
            depth_known = True
        if depth_known:
            if gap < -allowed:
                return HIT, tau
            if gap > allowed:
                # the bound from here backward in time, where odd derivatives change their sign
                back = tau - begin
                third = -sign * SIXTH * now.G2
                free = positive_on(
                    back, (gap - allowed, -slope, 0.5 * bend, third, -0.25 * SIXTH * M4)
                )
                if K.growth > 1.0 and tau > 1.5 * K.chunk:  # so late M4 is no bound any more
                    free = False
                return (NOTHING if free and back > 0.0 else STALLED), tau
            if abs(shift) >= 0.9 * last_shift or shift == 0.0:  # as near as rounding allows
                return (TANGENCY if gap_reopens(tau, side, start, walls, S, K) else LOST), tau
        if abs(shift) >= 0.9 * last_shift:  # steps that hardly get shorter
            even_steps = even_steps + 1
        else:
            even_steps = 0
        last_shift = abs(shift)
        tau = tau + shift
        if tau < earliest or even_steps > MOST_EVEN:
            return STALLED, begin
    return LOST, tau


@outlined
def gap_reopens(tau, side, start, walls, S, K):
    """Return whether a gap that is 0 within its error at `tau` is clearly not 0 soon after: the
    contact is a touch.
    """
    for rate in (K.rate, K.beat):
        now = state_at(tau + 0.5 / rate, start, K)
        if abs(gap_to(side, now, walls)) > 4.0 * tolerance(side, now, start, walls, S, K):
            return True
    return False


@outlined
def gap_stays_zero(tau, side, start, walls, S, K):
    """Return whether a gap is 0 within its error at `tau`, and so slow that it stays so for
    SOON/`K.rate`.
    """
    now = state_at(tau, start, K)
    allowed = tolerance(side, now, start, walls, S, K)
    return gap_to(side, now, walls) <= allowed and abs(now.F) <= allowed * K.rate / SOON


def side_of_zero_gap(now, thin, start, walls, S, K):
    """Return the side (-1, 1) on which a gap with a square below `thin` is and stays 0 within its
    error; else 0.
    """
    below = walls.below + now.dv
    above = walls.above - now.dv
    away = now.tau > 0.0  # at a launch from a wall the gap there is 0, and no contact
    thin_below = walls.has_below and below * below < thin and (away or not walls.on_below)
    thin_above = walls.has_above and above * above < thin and (away or not walls.on_above)
    if thin_below and gap_stays_zero(now.tau, -1, start, walls, S, K):
        return -1
    if thin_above and gap_stays_zero(now.tau, 1, start, walls, S, K):
        return 1
    return 0


# --- flights ---


def first_exit(tau_max, start, walls, S, K):
    """Find the first contact of the flight `start` with one of the `walls` within `tau_max`.

    Return a `FlightEnd`.
    """
    # Its code is NOTHING (at tau_max), HIT, TANGENCY or STALLED, where this precision does not decide
    # (`after_flight` returns FAILED then). A contact is returned even if the last correction moved
    # it past tau_max. S is the Covariance of the errors of the start.
    now, flat, thin, margin = search_begin(tau_max, start, walls, S, K)
    v0 = start.v
    if K.apart and not flat:
        now, M4, side, there = march(tau_max, v0, now, walls, margin, K)
        if side != 0:
            # The estimate is made exact from the nearer end of the step; `part` is the fraction of
            # it up to the wall.
            h = there.tau - now.tau
            part = part_to_root(now, there, side, walls)
            if part < 0.5:
                tau = now.tau + sharpened(part * h, side, now, walls, K)
            else:
                tau = there.tau + sharpened(
                    (part - 1.0) * h, side, with_derivatives(there, v0, K), walls, K
                )
            return polish(tau, now.tau, there.tau, side, start, walls, K)
    else:
        M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
    return stepped(tau_max, now, M4, thin, margin, start, walls, S, K)


def search_begin(tau_max, start, walls, S, K):
    """Return (now, flat, thin, margin): the point up to which there is no contact, and limits for
    the search after it.

    `flat`: a gap grows only as tau^4 from the launch, and `now` is later. `margin` is what the
    start's error can do to a gap; a gap is compared with its own error if its square is below
    `thin`.
    """
    # Where the margin is less than rounding, it is 0, and `tolerance` includes it. `thin` includes
    # the square of twice the start's error.
    v0, F0, s0, c0 = start
    zero = 0.0 * tau_max
    G1, G2, G3 = derivatives(v0, F0, s0, c0, K)
    now = Flown(zero, zero, zero, F0, G1, G2, G3, s0, c0, 1.0 + zero, zero, zero)
    # A flat start: after a tangency or the end of a stick. A derivative within rounding of 0 is 0
    # there, its sign is noise. Near sin(theta) = +-1 that leaves cos(theta), and with it G2,
    # uncertain by about sqrt(EPS).
    flat = False
    at_rest = (walls.on_below or walls.on_above) and F0 == 0.0
    if at_rest and abs(G1) <= ROUNDING * EPS * (abs(K.w0sq * v0) + abs(K.fB)):
        now = Flown(zero, zero, zero, F0, zero, G2, G3, s0, c0, 1.0 + zero, zero, zero)
        if abs(G2) <= ROUNDING * sqrt(EPS) * abs(K.fB) * K.Om:
            now = behind_flat_start(tau_max, G2, G3, start, K)
            flat = True
    speed = THIN * (abs(v0) + (abs(F0) + abs(K.f0)) * K.moment)
    variance = K.sigmas * K.sigmas * (S.S22 + K.w0sq * S.S11)
    thin = 4.0 * variance + speed * speed
    margin = 0.0 * variance
    if variance > FAINT * speed * speed:
        margin = sqrt(variance)
    return now, flat, thin, margin


@outlined
def behind_flat_start(tau_max, G2, G3, start, K):
    """Return the point of a flight up to which a gap that grows like tau^4 from 0 surely has no
    other root.
    """
    Om4 = K.Om * K.Om * K.Om * K.Om
    fifth = fifth_derivative(G3, G2, start.c, K)
    # With a bound M5 of the fifth derivative the gap is at least |G3| tau^4/24 - M5 tau^5/120, which
    # is positive up to 5 |G3|/M5; 4 |G3|/M5 is before that.
    if K.steady:
        G3_transient = G3 - Om4 * (K.Ss * start.s + K.Sc * start.c)
        fifth_transient = fifth - Om4 * K.Om * (K.Ss * start.c - K.Sc * start.s)
        energy = fifth_transient * fifth_transient + K.w0sq * G3_transient * G3_transient
        M5 = K.V0 * Om4 * K.Om + sqrt(energy) * K.growth
        if M5 > 0.0:
            tau = 4.0 * abs(G3) / M5
        else:
            tau = K.chunk
    else:
        energy = fifth * fifth + K.w0sq * G3 * G3
        M5 = (sqrt(energy) + abs(K.fB) * K.Om * K.Om * K.Om) * K.growth
        tau = 4.0 * abs(G3) / M5
        if not (tau * K.Om < 1.0):
            tau = 1.0 / K.Om
    return state_at(tau if tau < tau_max else tau_max, start, K)


@outlined
def stepped(tau_max, now, M4, thin, margin, start, walls, S, K):
    """Find the first contact after `now` by steps that surely meet no wall, given what
    `search_begin` returns.
    """
    # the end that was found: its code, its time, and the bracket around it
    code = STALLED
    tau = now.tau
    low = now.tau
    high = now.tau
    # the side on which the gap is known to be negative at a later time, and that time
    crossing = 0
    tau_deep = now.tau
    stalled = 0
    for _ in range(MOST_STEPS):
        side = side_of_zero_gap(now, thin, start, walls, S, K)
        if side != 0 or now.tau >= tau_max:
            if side != 0:
                code = STALLED
            else:
                code = NOTHING
            break
        cap = longest_step(tau_max - now.tau, K)
        side, step, root, P, degree = nearest_root(cap, now, M4, margin, walls)
        if side < 0:
            start_gap = walls.below
        else:
            start_gap = walls.above
        known = crossing == side
        # The last term makes `is_near` ask that the gap gets at least 4 margins deep, to be no touch.
        size = start_gap + abs(now.dv) + abs(now.F) * root + margin * (4.0 / DEEP)
        near, close, deep = root_ahead(root, cap, P, degree, M4, size, K)
        if near and (deep or known):
            low = now.tau
            if known:
                high = tau_deep
            else:
                high = now.tau + 2.0 * (root + ISOLATED * K.moment)
            code = HIT
            tau = now.tau + (root if close else sharpened(root, side, now, walls, K))
            break
        # No root is sure there: is a graze ahead? `short` steps are a sign of it.
        short = step < cap and step * K.rate < SHORT_STEP
        # a gap that shrinks and is hardly larger than what the error of the start can do to it
        beside = margin > 0.0 and side * now.F > 0.0 and gap_to(side, now, walls) < 2.0 * margin
        if (short or not deep or beside) and not known and (now.tau > 0.0 or start_gap > 0.0):
            verdict, tau = graze_ahead(now, side, step, M4, start, walls, S, K)
            if verdict == TANGENCY:
                code = TANGENCY
                break
            if verdict == LOST and tau <= tau_max:
                code = STALLED
                break
            if verdict == HIT:  # the gap is negative there: the steps go on to the root before
                crossing = side
                tau_deep = tau
            elif verdict == NOTHING:  # past the minimum, up to which the gap is positive
                step = tau - now.tau
                if step >= cap:
                    step = cap
            elif short:
                stalled = stalled + 1
        if step <= 0.0 or stalled > MOST_STALLS:
            break
        low = now.tau
        now = state_at(low + step if step < tau_max - low else tau_max, start, K)
        M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
        # A safe step ends before a wall, but for rounding.
        behind = wall_behind(now, walls)
        if behind != 0:
            side = behind
            high = now.tau
            if crossing == side:
                code = HIT
                tau = high
            else:
                code, tau = contact_by_rounding(high, low, side, M4, start, walls, S, K)
            break
    if code == TANGENCY:
        return FlightEnd(TANGENCY, side, state_at(tau, start, K))
    if code == HIT:
        return polish(tau, low, high, side, start, walls, K)
    return FlightEnd(code, side, now)


def longest_step(rest, K):
    """Return how far one step may go if the search ends after the time `rest`: as far as the bound
    of the fourth derivative holds.
    """
    if not K.steady and rest * K.Om > 1.0:
        return 1.0 / K.Om
    return rest


def root_ahead(root, cap, P, degree, M4, size, K):
    """Return what `is_near` does for the `root` of a gap's bound `P`, if that is before `cap`; else
    that there is none near, and no touch.
    """
    if root < cap:
        return is_near(root, P, degree, M4, size, K)
    return False, False, True


def wall_behind(now, walls):
    """Return the side (-1, 1) of a wall that the flight is on or beyond at point `now`, else 0."""
    if walls.has_below and walls.below + now.dv <= 0.0:
        return -1
    if walls.has_above and walls.above - now.dv <= 0.0:
        return 1
    return 0


def contact_by_rounding(high, low, side, M4, start, walls, S, K):
    """Return code and time of a contact at or before `high`, which a step met whose bound has no
    root: a root within rounding, or a touch.
    """
    verdict, tau = closest_approach(high, low, side, M4, start, walls, S, K)
    if verdict == TANGENCY:
        return TANGENCY, tau
    if verdict == LOST:
        return STALLED, high
    return HIT, high


def nearest_root(cap, now, M4, margin, walls):
    """Return (side, step, root, P, degree): the wall with the shorter safe step, and what `safe_step`
    and `gap_bound` return for it.
    """
    if walls.has_below:
        side = -1
    else:
        side = 1
    P, degree = gap_bound(side, now, M4, margin, walls)
    step, root = safe_step(cap, P)
    # The upper wall counts only if the lower one's step is too long for it.
    if walls.has_below and walls.has_above:
        Q, degree_above = gap_bound(1, now, M4, margin, walls)
        if not positive_on(root if root < cap else step, Q):
            step_above, root_above = safe_step(cap, Q)
            if step_above < step:
                return 1, step_above, (cap if step < root_above else root_above), Q, degree_above
            root = cap
    return side, step, root, P, degree


def graze_ahead(now, side, step, M4, start, walls, S, K):
    """Return what `closest_approach` does for the gap on `side`, but STALLED if the other wall may
    be met first.
    """
    verdict, tau_min = closest_approach(now.tau, now.tau, side, M4, start, walls, S, K)
    reach = tau_min - now.tau
    if walls.has_below and walls.has_above and verdict != STALLED and reach > step:
        P, _ = gap_bound(-side, now, M4, 0.0 * step, walls)
        if not positive_on(reach, P):
            verdict = STALLED
    return verdict, tau_min


def part_to_root(now, there, side, walls):
    """Estimate at which fraction of the time from point `now` to `there` the gap on `side`
    vanishes.
    """
    # `part` is the root of the secant. From there one step of Newton's method follows on Hermite's
    # cubic, with the secant's slope.
    h = there.tau - now.tau
    gap = gap_to(side, now, walls)
    beyond = -gap_to(side, there, walls)
    inverse = 1.0 / (gap + beyond)
    part = gap * inverse
    rest = 1.0 - part
    steeper = gap + beyond - side * h * now.F
    flatter = gap + beyond - side * h * there.F
    better = part + part * rest * (rest * steeper - part * flatter) * inverse
    return select((better > 0.0) & (better < 1.0), better, part)


def sharpened(root, side, now, walls, K):
    """Improve the estimate `root`, the time from `now` until the gap on `side` is 0, by one step of
    Halley's method.
    """
    # So one evaluation of the flow is enough to make it exact. The root is counted from `now`.
    half = 0.5 * now.G1
    third = SIXTH * now.G2
    fourth = 0.25 * SIXTH * now.G3
    fifth = 0.05 * SIXTH * fifth_derivative(now.G3, now.G2, now.c, K)
    gap = gap_to(side, now, walls)
    over = select(side < 0, gap, -gap)
    square = root * root  # terms in pairs: each waits for fewer others than in Horner's order
    value = (over + now.F * root) + square * (
        (half + third * root) + square * (fourth + fifth * root)
    )
    slope = (now.F + now.G1 * root) + square * (
        (3.0 * third + 4.0 * fourth * root) + square * (5.0 * fifth)
    )
    half_bend = (half + 3.0 * third * root) + square * (6.0 * fourth + 10.0 * fifth * root)
    halley = slope * slope - value * half_bend
    shift = value * slope / select(halley > 0.0, halley, FAR)
    return select(abs(shift) < 0.5 * abs(root), root - shift, root)


def polish(tau, low, high, side, start, walls, K):
    """Refine the time `tau` in [low, high] of a contact with the wall on `side` to full precision,
    as a `FlightEnd`.
    """
    # The gap is positive at `low`. A step that leaves the bracket is replaced by halving it; it
    # narrows. Mostly the first point is near enough. `local_root` is given v less the belt's speed,
    # whose derivatives are F to G3: the gap on side -1, minus the gap on side 1.
    now = state_at(tau, start, K)
    slack = 4.0 * EPS * high
    for _ in range(MOST_HALVINGS):
        gap = gap_to(side, now, walls)
        if gap > 0.0:  # before the contact
            if tau > low:
                low = tau
        else:
            if tau < high:
                high = tau
        shift = local_root(gap if side < 0 else -gap, now.F, now.G1, now.G2, now.G3, EPS * tau)
        inside = low - slack <= tau + shift <= high + slack
        if not inside:
            shift = 0.5 * (low + high) - tau
        if abs(shift) * K.rate < NEAR and (inside or high - low <= slack):
            return FlightEnd(HIT, side, shifted(now, shift, start.v, K))
        tau = tau + shift
        now = state_at(tau, start, K)
    return FlightEnd(STALLED, side, now)


def shifted(now, shift, v0, K):
    """Return the point `now` of a flight moved by a time `shift` that is short enough for Taylor's
    formula.
    """
    # E0 to E2, which carry errors only, stay as they are.
    _, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2 = now
    square = shift * shift
    last = 0.25 * SIXTH * (G2 + 0.2 * G3 * shift)  # short flights need the fifth power too
    dx = dx + ((v0 + dv) * shift + square * ((0.5 * F + SIXTH * G1 * shift) + square * last))
    fifth = fifth_derivative(G3, G2, c, K)
    F = F + (G1 + (0.5 * G2 + SIXTH * (G3 + 0.25 * fifth * shift) * shift) * shift) * shift
    s, c = turned(s, c, K.Om * shift)
    return Flown(now.tau + shift, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2)


# --- sticks ---


def force_gain(tau, s0, c0, belt, K):
    """Return Delta, the gain of both forces in a stick of length `tau` from phase s0, c0, and the
    phase's s, c then.
    """
    half = 0.5 * K.Om * tau
    return force_gain_at(tau, sin(half), cos(half), s0, c0, belt, K)


def force_gain_at(tau, s, c, s0, c0, belt, K):
    """Return the gain of both forces in a stick and the new phase, as `force_gain`.

    `s`, `c`: of half its turn.
    """
    swing = -2.0 * (s0 * c + c0 * s) * s  # cos(theta + Omega tau) - cos(theta)
    Delta = stick_acceleration(0.0 * tau, belt.v, tau, swing, K.w0sq, K.f0)
    s_Om = 2.0 * s * c
    c_Om = 1.0 - 2.0 * s * s
    return Delta, s0 * c_Om + c0 * s_Om, c0 * c_Om - s0 * s_Om


def force_slopes(s, c, belt, K):
    """Return the first and second time derivative of the force on a belt at the phase with sine
    `s`, cosine `c`.
    """
    return belt.drift - K.fB * s, -K.fB * K.Om * c


def wrap_phase(angle):
    """Return an angle between -4 pi and 4 pi moved into [0, 2 pi)."""
    angle = select(angle < 0.0, angle + 2.0 * PI, angle)
    angle = select(angle < 0.0, angle + 2.0 * PI, angle)
    return select(angle >= 2.0 * PI, angle - 2.0 * PI, angle)


def phase_ahead(angle):
    """Return a phase difference moved into [0, 2 pi); one within rounding of a whole turn becomes
    0.
    """
    angle = wrap_phase(angle)
    return select(
        (angle < SAME_PHASE * EPS) | (2.0 * PI - angle < SAME_PHASE * EPS), 0.0 * angle, angle
    )


def belt_exit(tau_max, held, belt, K):
    """Find when the stick that begins in state `held` ends, within `tau_max` <= one period.

    Return a `StickEnd`.
    """
    # `held` is the State at its beginning, with F^(below) >= 0 >= F^(above). NOTHING: the stick
    # lasts (Delta at tau_max). HIT: it ends at tau into the domain below (side -1) or above (+1),
    # where Delta has `slope` and `bend`. TANGENCY: a force is 0 within its error at tau.
    zero = 0.0 * tau_max
    c_end = held.c
    c = held.c
    s = held.s
    Delta = zero
    tau = zero
    # the next two times at which Delta turns
    first = tau_max
    second = tau_max
    c_first = belt.c_cr
    if belt.turns:
        first = phase_ahead(belt.angle - held.theta) / K.Om
        second = phase_ahead(PI - belt.angle - held.theta) / K.Om
        if second < first:
            first, second, c_first = second, first, -belt.c_cr
    # Delta turns where the stick begins, and so a period later too.
    turns_at_period = belt.turns and (first == 0.0 or second == 0.0)
    for piece in range(3):
        if piece == 0:
            end = first
        elif piece == 1:
            end = second
        else:
            end = tau_max
        if end > tau_max:
            end = tau_max
        if end <= tau:
            continue
        if belt.turns and end < tau_max:
            if piece == 0:
                c_end = c_first
            else:
                c_end = -c_first
            Delta_end = stick_acceleration(zero, belt.v, end, c_end - held.c, K.w0sq, K.f0)
        elif end == K.period:
            Delta_end = belt.drift * end  # the drive is where it began
        else:
            Delta_end, _, _ = force_gain(end, held.s, held.c, belt, K)
        if Delta_end == Delta:  # constant forces
            tau = end
            continue
        # Forces that rise can only lift F^(above) to 0, forces that fall only lower F^(below);
        # `excess` is how far beyond 0 that force is at the end of this piece.
        rising = Delta_end > Delta
        if rising:
            force = held.Fa
            side = 1
            excess = force + Delta_end
        else:
            force = held.Fb
            side = -1
            excess = -force - Delta_end
        turning = end < tau_max or (turns_at_period and end == K.period)
        if turning and abs(excess) <= force_noise(held.Fb, end, held.S.S11, belt, K):
            return StickEnd(TANGENCY, side, end, Delta_end, zero, zero, zero, zero)
        if excess >= 0.0:
            return exit_root(force, side, tau, end, Delta, s, c, held, belt, K)
        tau = end
        Delta = Delta_end
        s = belt.s_cr
        c = c_end
    return StickEnd(NOTHING, 0, tau_max, Delta, zero, zero, zero, zero)


def force_noise(F_below, tau, S11, belt, K):
    """Return how wrong a force may be `tau` after a stick began with the force F_below and the
    variance S11 of x.
    """
    size = abs(F_below) + abs(belt.drift) * tau + 2.0 * abs(K.f0)
    return ROUNDING * EPS * size + K.sigmas * K.w0sq * sqrt(S11)


def exit_root(force, side, low, high, Delta, s, c, held, belt, K):
    """Find the end of a stick: the only time from `low` to `high` at which force + Delta = 0, with
    Delta monotone.
    """
    # Delta, s and c are those at `low`. Steps to the root of the local parabola (Euler's method,
    # which needs no slope), corrected for the third derivative, and `local_root` from nearby.
    # Halving when a step leaves the bracket or the steps do not shrink.
    tau, over, s, c, low, high = exit_begin(force, side, low, high, Delta, s, c, held, belt, K)
    slope, bend = force_slopes(s, c, belt, K)
    Om2 = K.Om * K.Om
    slack = 4.0 * EPS * high
    step_before = 2.0 * (high - low)
    exact = False
    for _ in range(MOST_STICK_STEPS):
        third = Om2 * (belt.drift - slope)
        if exact:  # the first point is a guess, for which digits may have been lost
            if over == 0.0:
                return StickEnd(HIT, side, tau, -force, slope, bend, s, c)
            if is_beside(over, slope, bend, K):
                step = local_root(over, slope, bend, third, -Om2 * bend, EPS * tau)
                if abs(step) * K.beat < NEAR and low - slack <= tau + step <= high + slack:
                    return slips_at(tau, step, side, -force, s, c, belt, K)
        step = parabola_step(over, slope, bend, third, side, high - low)
        if tau + step >= high or tau + step <= low or 2.0 * abs(step) > step_before:
            step = 0.5 * (low + high) - tau
        if exact:
            step_before = abs(step)
        if tau + step == tau:  # the bracket is as narrow as it gets
            return StickEnd(HIT, side, tau, -force, slope, bend, s, c)
        tau = tau + step
        exact = True
        Delta, s, c = force_gain(tau, held.s, held.c, belt, K)
        slope, bend = force_slopes(s, c, belt, K)
        over = force + Delta
        if side * over > 0.0:
            high = tau
        else:
            low = tau
    return StickEnd(STALLED, side, tau, -force, slope, bend, s, c)


def exit_begin(force, side, low, high, Delta, s, c, held, belt, K):
    """Return (tau, over, s, c, low, high), where to begin the search for the end of a stick: time,
    force, sine and cosine of the phase, and the bracket.
    """
    # The inflection of Delta (cos(theta) = 0), where it is steepest and s and c are known, is often
    # nearer to the root. The slope is drift - fB sin(theta): steepest towards `side` where
    # sin(theta) is 1 or -1 with the sign of -side fB.
    tau = low
    over = force + Delta
    if side * K.fB < 0.0:
        sine = 1.0
    else:
        sine = -1.0
    inflection = wrap_phase(0.5 * sine * PI - held.theta) / K.Om
    if K.driven and low < inflection < high:
        there = stick_acceleration(force, belt.v, inflection, -held.c, K.w0sq, K.f0)
        if abs(there) < abs(over):
            tau = inflection
            over = there
            s = sine + 0.0 * c
            c = 0.0 * c
        if side * there > 0.0:
            high = inflection
        else:
            low = inflection
    return tau, over, s, c, low, high


def parabola_step(over, slope, bend, third, side, width):
    """Return the step to the root of the parabola through `over` with `slope` and `bend`, corrected
    for the `third` derivative; `width` if it has none on this side.
    """
    square = slope * slope - 2.0 * over * bend
    if square > 0.0:
        steepness = side * slope + sqrt(square)
    else:
        steepness = 0.0 * square
    if steepness > 0.0:
        step = -2.0 * over * side / steepness
    else:
        step = width
    incline = slope + (bend + 0.5 * third * step) * step
    if steepness > 0.0 and side * incline > 0.0:
        step = step - SIXTH * third * step * step * step / incline
    return step


def is_beside(over, slope, bend, K):
    """Return whether a force `over`, with derivatives `slope`, `bend`, is so near 0 that its root
    needs no search.
    """
    # the first condition is that of `local_root`: the inverted series is of use
    return (abs(over * bend) < 0.1 * slope * slope) & (abs(over) * K.beat < 2.0 * NEAR * abs(slope))


def slips_at(tau, step, side, Delta, s, c, belt, K):
    """Return the `StickEnd` at the time tau + step.

    `Delta`: the force's gain, s and c: sine and cosine at `tau`.
    """
    slope, bend = force_slopes(s, c, belt, K)
    third = K.Om * K.Om * (belt.drift - slope)
    incline = slope + (bend + 0.5 * third * step) * step
    s, c = turned(s, c, K.Om * step)
    return StickEnd(HIT, side, tau + step, Delta, incline, bend + third * step, s, c)


# --- with many digits: near a time that doubles have found ---


def contact_at_dip(tau, free, side, start, walls, S, K):
    """Find the first zero of a gap that dips below 0 near `tau`, as a `FlightEnd`.

    Up to the time `free` there is none. Its code is HIT, or STALLED where that is not sure:
    `advance_near` then searches the whole flight.
    """
    # First the bottom of the dip, where v' = 0.
    now = state_at(tau, start, K)
    for _ in range(MOST_CORRECTIONS):
        third = SIXTH * now.G3
        fourth = 0.25 * SIXTH * fifth_derivative(now.G3, now.G2, now.c, K)
        shift = 0.0 * tau
        for _ in range(3):  # Newton's method on the polynomial of the acceleration
            rise = (
                now.F + (now.G1 + (0.5 * now.G2 + (third + fourth * shift) * shift) * shift) * shift
            )
            slope = now.G1 + (now.G2 + (3.0 * third + 4.0 * fourth * shift) * shift) * shift
            if slope != 0.0:
                shift = shift - rise / slope
        if not NEAR <= abs(shift) * K.rate < 1.0:
            break
        tau = tau + shift
        now = state_at(tau, start, K)
    gap = gap_to(side, now, walls)
    bend = -side * now.G1
    fall = (
        now.F + (0.5 * now.G1 + SIXTH * (now.G2 + 0.25 * now.G3 * shift) * shift) * shift
    ) * shift
    depth = side * fall - gap  # `fall` is what v gains up to the bottom
    allowed = tolerance(side, now, start, walls, S, K)
    if not (abs(shift) * K.rate < NEAR and free > 0.0 and bend > 0.0 and depth > 2.0 * allowed):
        return FlightEnd(STALLED, side, now)
    # Then the zero before the bottom.
    before = shift - sqrt(2.0 * depth / bend)
    before = newton_root(
        before, gap if side < 0 else -gap, now.F, now.G1, now.G2, now.G3, EPS * tau
    )
    if abs(before) * K.rate < NEAR:
        end = FlightEnd(HIT, side, shifted(now, before, start.v, K))
    else:
        end = contact_near(tau + before, 0.5 * abs(before), side, start, walls, K)
    # It is the first one if the polynomial bound of the gap to each wall, taken backward from it, is
    # positive as far as the flight is not known to be `free`. The gap to this wall is 0 here: its
    # bound is divided by the time.
    back = end.now.tau - free
    now = end.now
    G1, G2, G3 = derivatives(start.v, start.F, start.s, start.c, K)
    top = -0.25 * SIXTH * fourth_derivative_bound(G2, G3, start.s, start.c, K)
    G1, G2, _ = derivatives(start.v + now.dv, now.F, now.s, now.c, K)
    rise = side * now.F
    half = -0.5 * side * G1
    third = side * SIXTH * G2
    first = back > 0.0 and positive_on(back, (rise, half, third, top, 0.0 * top))
    if first and walls.has_below and walls.has_above:
        first = positive_on(back, (gap_to(-side, now, walls), -rise, -half, -third, top))
    if first:
        return end
    return FlightEnd(STALLED, side, now)


def contact_near(tau, uncertainty, side, start, walls, K):
    """Find the contact with the wall on `side` within `uncertainty` of the time `tau`.

    Return a `FlightEnd`. Its code is HIT, or STALLED where none is found there, or not within
    MOST_CORRECTIONS: `advance_near` then searches the whole flight.
    """
    # `local_root` is given v less the belt's speed: the gap on side -1, minus the gap on side 1. A
    # wall is met while v moves towards it, so side * F > 0: a root on the way back is another contact.
    first = tau
    now = state_at(tau, start, K)
    for _ in range(MOST_CORRECTIONS):
        gap = gap_to(side, now, walls)
        shift = local_root(gap if side < 0 else -gap, now.F, now.G1, now.G2, now.G3, EPS * tau)
        if not (abs(tau + shift - first) <= uncertainty and side * now.F > 0.0):
            break
        if abs(shift) * K.rate < NEAR:
            return FlightEnd(HIT, side, shifted(now, shift, start.v, K))
        tau = tau + shift
        now = state_at(tau, start, K)
    return FlightEnd(STALLED, side, now)


def slip_near(tau, uncertainty, side, held, belt, K):
    """Find when the stick that began in state `held` ends, within `uncertainty` of `tau`.

    Return a `StickEnd`. Its code is HIT, or STALLED where it does not end there, or is not found
    within MOST_CORRECTIONS: `advance_near` then searches the whole stick.
    """
    # F^(above) ends a stick (side 1) as it rises through 0, F^(below) (side -1) as it falls.
    first = tau
    if side > 0:
        force = held.Fa
    else:
        force = held.Fb
    Om2 = K.Om * K.Om
    for _ in range(MOST_CORRECTIONS):
        Delta, s, c = force_gain(tau, held.s, held.c, belt, K)
        slope, bend = force_slopes(s, c, belt, K)
        step = local_root(
            force + Delta, slope, bend, Om2 * (belt.drift - slope), -Om2 * bend, EPS * tau
        )
        if not (abs(tau + step - first) <= uncertainty and side * slope > 0.0):
            break
        if abs(step) * K.beat < NEAR:
            return slips_at(tau, step, side, -force, s, c, belt, K)
        tau = tau + step
    zero = 0.0 * tau
    return StickEnd(STALLED, side, tau, -force, zero, zero, zero, zero)
