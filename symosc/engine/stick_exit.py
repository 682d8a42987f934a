"""The end of a stick: the first of its two exits.

On belt lambda both forces change alike, dF/dt = -(k v_lambda + B0 Omega sin(theta))/m, so that after a time tau

    F^(below) = F_below + Delta(tau),   F^(above) = F_above + Delta(tau),
    Delta(tau) = -(k/m) v_lambda tau + (B0/m) (cos(theta + Omega tau) - cos(theta)).

The stick ends when F^(below) falls to 0 or F^(above) rises to 0 (the paper's (52) and (53) have one exit each).
Delta is monotone between the phases with sin(theta) = -k v_lambda/(B0 Omega), the Theta_cr of Theorem 7, where its
value needs no trigonometric function. So each monotone piece is decided by the value at its end. In real arithmetic no
exit is missed so, and the exit in a piece is its only root there. With rounding, a value within ROUNDING errors of 0 is
no decision; that this margin is wide enough in doubles was measured, not proven (`symosc.engine.first_exit`).
"""

from __future__ import annotations

from math import acos, cos, sin, sqrt

from symosc.engine.flow import turned
from symosc.engine.gap_bounds import NEAR, local_root
from symosc.engine.state import HIT, NOTHING, STALLED, TANGENCY, StickEnd, Stretch
from symosc.engine.touches import ROUNDING
from symosc.kernels._generated import stick_acceleration
from symosc.kernels.entire import EPS, SIXTH

PI = acos(-1.0)
MOST_STICK_STEPS = 20000
# Phases closer than this times EPS are one.
SAME_PHASE = 64.0


def gain(tau, s0, c0, belt, K):
    """Return Delta at tau, without cancellation at small tau, and the phase's sine and cosine; s0, c0: at the start."""
    half = 0.5 * K.Om * tau
    s, c = sin(half), cos(half)
    swing = -2.0 * (s0 * c + c0 * s) * s  # cos(theta + Omega tau) - cos(theta)
    Delta = stick_acceleration(0.0 * tau, belt.v, tau, swing, K.w0sq, K.f0)
    s_Om, c_Om = 2.0 * s * c, 1.0 - 2.0 * s * s
    return Delta, s0 * c_Om + c0 * s_Om, c0 * c_Om - s0 * s_Om


def slopes(s, c, belt, K):
    """Return Delta' and Delta'' at a phase."""
    return belt.drift - K.fB * s, -K.fB * K.Om * c


def wrapped(angle):
    """Return an angle moved into [0, 2 pi)."""
    while angle < 0.0:
        angle = angle + 2.0 * PI
    while angle >= 2.0 * PI:
        angle = angle - 2.0 * PI
    return angle


def ahead(angle):
    """Return how far a turning phase lies ahead, in [0, 2 pi); one within rounding is here, and its piece is behind."""
    angle = wrapped(angle)
    return 0.0 * angle if angle < SAME_PHASE * EPS or 2.0 * PI - angle < SAME_PHASE * EPS else angle


def belt_exit(tau_max, hold, S11, belt, K):
    """Find the end of a stick within `tau_max` <= one forcing period.

    Parameters
    ----------
    tau_max : time to search.
    hold : Hold
        Its accelerations are F^(below) >= 0 >= F^(above), its phase is in [0, 2 pi).
    S11 : variance of the error of the position.
    belt, K : BeltConstants, Constants

    Returns
    -------
    StickEnd
        NOTHING: the stick lasts (Delta at tau_max). HIT: it ends at tau into the domain below (side -1) or above (+1),
        where Delta has `slope` and `bend`. TANGENCY: a force touches 0 at tau as far as this precision tells.
    """
    zero = 0.0 * tau_max
    tau, Delta, s, c, c_end = zero, zero, hold.s, hold.c, hold.c
    first, second, c_first = turns_of(tau_max, hold.theta, belt, K)
    turns_at_period = belt.turns and (first == 0.0 or second == 0.0)
    for piece in range(3):
        end = first if piece == 0 else second if piece == 1 else tau_max
        if end > tau_max:
            end = tau_max
        if end <= tau:
            continue
        if belt.turns and end < tau_max:
            c_end = c_first if piece == 0 else -c_first
            Delta_end = stick_acceleration(zero, belt.v, end, c_end - hold.c, K.w0sq, K.f0)
        elif end == K.period:
            Delta_end = belt.drift * end
        else:
            Delta_end, _, _ = gain(end, hold.s, hold.c, belt, K)
        if Delta_end == Delta:  # constant forces
            tau = end
            continue
        rising = Delta_end > Delta
        force, side = (hold.Fa, 1) if rising else (hold.Fb, -1)
        over = force + Delta_end if rising else -force - Delta_end
        turning = end < tau_max or (turns_at_period and end == K.period)
        if turning and abs(over) <= force_noise(hold.Fb, end, S11, belt, K):
            return StickEnd(TANGENCY, side, end, Delta_end, zero, zero, zero, zero)
        if over >= 0.0:
            return exit_root(force, side, Stretch(tau, end, Delta, s, c), hold, belt, K)
        tau, Delta, s, c = end, Delta_end, belt.s_cr, c_end
    return StickEnd(NOTHING, 0, tau_max, Delta, zero, zero, zero, zero)


def turns_of(tau_max, theta, belt, K):
    """Return the next two times at which Delta turns, and the cosine of the phase at the first; tau_max for none."""
    if not belt.turns:
        return tau_max, tau_max, belt.c_cr
    first, second = ahead(belt.angle - theta) / K.Om, ahead(PI - belt.angle - theta) / K.Om
    return (second, first, -belt.c_cr) if second < first else (first, second, belt.c_cr)


def force_noise(F_below, tau, S11, belt, K):
    """Return how far a force on the belt may be wrong `tau` after the start of the stick."""
    size = abs(F_below) + abs(belt.drift) * tau + 2.0 * abs(K.f0)
    return ROUNDING * EPS * size + K.sigmas * K.w0sq * sqrt(S11)


def exit_root(force, side, stretch, hold, belt, K):
    """Return the only root of force + Delta on a stretch, on which Delta is monotone, as `belt_exit` does.

    Steps to the root of the local parabola (Euler's method, which needs no slope), corrected for the third derivative,
    and `local_root` from nearby. Halving when a step leaves the bracket or the steps do not shrink.
    """
    tau, over, low, high, s, c = first_guess(force, side, stretch, hold, belt, K)
    slope, bend = slopes(s, c, belt, K)
    Om2 = K.Om * K.Om
    slack, step_before, exact = 4.0 * EPS * high, 2.0 * (high - low), False
    for _ in range(MOST_STICK_STEPS):
        third = Om2 * (belt.drift - slope)
        if exact:  # the first point is a guess, for which digits may have been lost
            if over == 0.0:
                return StickEnd(HIT, side, tau, -force, slope, bend, s, c)
            if abs(over * bend) < 0.1 * slope * slope:
                step = local_root(over, slope, bend, third, -Om2 * bend, EPS * tau)
                if abs(step) * K.Om < NEAR and low - slack <= tau + step <= high + slack:
                    return slips_at(tau, step, side, -force, s, c, belt, K)
        square = slope * slope - 2.0 * over * bend
        steepness = side * slope + sqrt(square) if square > 0.0 else 0.0 * square
        step = -2.0 * over * side / steepness if steepness > 0.0 else high - low
        incline = slope + (bend + 0.5 * third * step) * step
        if steepness > 0.0 and side * incline > 0.0:
            step = step - SIXTH * third * step * step * step / incline
        if tau + step >= high or tau + step <= low or 2.0 * abs(step) > step_before:
            step = 0.5 * (low + high) - tau
        step_before = abs(step) if exact else step_before
        if tau + step == tau:  # the bracket is as narrow as it gets
            return StickEnd(HIT, side, tau, -force, slope, bend, s, c)
        tau, exact = tau + step, True
        Delta, s, c = gain(tau, hold.s, hold.c, belt, K)
        slope, bend = slopes(s, c, belt, K)
        over = force + Delta
        if side * over > 0.0:
            high = tau
        else:
            low = tau
    return StickEnd(STALLED, side, tau, -force, slope, bend, s, c)


def slips_at(tau, step, side, Delta, s, c, belt, K):
    """Return the end of a stick at tau + step, from the sine and cosine of the phase at tau."""
    slope, bend = slopes(s, c, belt, K)
    third = K.Om * K.Om * (belt.drift - slope)
    incline = slope + (bend + 0.5 * third * step) * step
    s, c = turned(s, c, K.Om * step)
    return StickEnd(HIT, side, tau + step, Delta, incline, bend + third * step, s, c)


def first_guess(force, side, stretch, hold, belt, K):
    """Return where the search for the end of a stick begins: (tau, over, low, high, s, c), `over` being the force.

    From the beginning of the stretch or from the inflection of Delta (cos(theta) = 0), where it is steepest, whichever
    is nearer to the root: there sine and cosine of the phase, s and c, are known.
    """
    low, high, Delta, s, c = stretch
    sine = 1.0 if side * K.fB < 0.0 else -1.0
    inflection = wrapped(0.5 * sine * PI - hold.theta) / K.Om
    over = force + Delta
    if not low < inflection < high:
        return low, over, low, high, s, c
    there = stick_acceleration(force, belt.v, inflection, -hold.c, K.w0sq, K.f0)
    nearer = abs(there) < abs(over)
    tau, over, s, c = (inflection, there, sine + 0.0 * c, 0.0 * c) if nearer else (low, over, s, c)
    return (tau, over, low, inflection, s, c) if side * there > 0.0 else (tau, over, inflection, high, s, c)
