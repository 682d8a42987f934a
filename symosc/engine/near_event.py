"""The next event with many digits, searched in doubles: only its last step, and what follows from it, take the digits.

The engine in doubles knows when it is in doubt: its decisions exceed the rounding of the state that it starts from and
its own. Where it is sure which contact is the first and how it is met, many digits would find the same one. So they
begin at its time, take a step of Newton's method or two with the exact flow, and go on as after a search of their own.
They search themselves where doubles are in doubt, where the end found so is not the one expected, and where the end of
the search itself is the question.

All functions are scalar and run on pairs (numba) and, with other globals, on mpmath and MPFR numbers.
"""

from __future__ import annotations

from symosc.engine.first_exit import over_wall, shifted
from symosc.engine.flow import state_at
from symosc.engine.gap_bounds import NEAR, local_root
from symosc.engine.next_event import advance, after_flight, after_stick, ends_beside_wall, held_by, launched
from symosc.engine.state import CROSS, END, HIT, MOVED, NOTHING, ON_BELT, SLIP, STALLED, STICK, FlightEnd, StickEnd
from symosc.engine.stick_exit import gain, slips_at, slopes
from symosc.kernels.entire import EPS

# A root is that of doubles if it is within twice the error that their decisions exceed (`symosc.engine.flow.SIGMAS`),
# and within this part of the time, which rounding takes.
DOUBTS, TIME_ROUNDING = 16.0, 2.0**-50
# Each evaluation of the flow makes five times as many digits right.
MOST_CORRECTIONS = 8
# A flight without an event is taken over if its search was not made longer, see `symosc.engine.next_event`.
USUAL_LENGTH = 1.0625


def advance_near(state, rough, found, t_end, t_end_low, K):
    """Do what `advance` does, with what doubles found from the same state.

    Parameters
    ----------
    state : State
    rough : State
        The same in doubles, with the rounding as its error.
    found : NextEvent
        What `advance` in doubles says of that.
    t_end, t_end_low, K : as `advance` takes them.

    Returns
    -------
    NextEvent
    """
    code, boundary, decided, t_error, there = found
    tau = (there.t - rough.t) + (there.t_low - rough.t_low)
    if not decided or K.creeps or not tau > 0.0:
        return advance(state, t_end, t_end_low, K)
    left = (t_end - state.t) + (t_end_low - state.t_low)
    doubt = DOUBTS * t_error + TIME_ROUNDING * tau
    tau = 0.0 * left + tau  # as a number of the same kind
    if code == SLIP:
        belt = K.belt1 if boundary == 1 else K.belt2
        slip = slip_near(tau, doubt, -1 if there.mode == boundary else 1, held_by(state), belt, K)
        if slip.code == HIT:
            return after_stick(state, slip, left, K)
    elif state.mode <= ON_BELT and code in (CROSS, STICK):
        start, walls = launched(state, K)
        end = contact_near(tau, doubt, -1 if boundary < state.mode else 1, start, walls, K)
        if end.code == HIT:
            return after_flight(state, end, start, left, K)
    elif state.mode <= ON_BELT and code in (MOVED, END) and tau < USUAL_LENGTH * K.chunk:
        start, walls = launched(state, K)
        now = state_at(left if left < K.chunk else K.chunk, start, K)
        if not ends_beside_wall(state, now, K):
            return after_flight(state, FlightEnd(NOTHING, 0, now), start, left, K)
    return advance(state, t_end, t_end_low, K)


def contact_near(tau, doubt, side, start, walls, K):
    """Return the contact with the wall on a side within `doubt` of `tau`, as `first_exit` does; STALLED for none."""
    first = tau
    now = state_at(tau, start, K)
    for _ in range(MOST_CORRECTIONS):
        shift = local_root(over_wall(side, now, walls), now.F, now.G1, now.G2, now.G3, EPS * tau)
        if not (abs(tau + shift - first) <= doubt and side * now.F > 0.0):
            break
        if abs(shift) * K.rate < NEAR:
            return FlightEnd(HIT, side, shifted(now, shift, start.v, K))
        tau = tau + shift
        now = state_at(tau, start, K)
    return FlightEnd(STALLED, side, now)


def slip_near(tau, doubt, side, hold, belt, K):
    """Return the end of a stick within `doubt` of `tau`, as `belt_exit` does; STALLED for none."""
    first, force = tau, hold.Fa if side > 0 else hold.Fb
    Om2 = K.Om * K.Om
    for _ in range(MOST_CORRECTIONS):
        Delta, s, c = gain(tau, hold.s, hold.c, belt, K)
        slope, bend = slopes(s, c, belt, K)
        step = local_root(force + Delta, slope, bend, Om2 * (belt.drift - slope), -Om2 * bend, EPS * tau)
        if not (abs(tau + step - first) <= doubt and side * slope > 0.0):
            break
        if abs(step) * K.Om < NEAR:
            return slips_at(tau, step, side, -force, s, c, belt, K)
        tau = tau + step
    zero = 0.0 * tau
    return StickEnd(STALLED, side, tau, -force, zero, zero, zero, zero)
