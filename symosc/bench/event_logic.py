"""Event logic for ODE integrators as a careful user writes it: floats, Theorems 4 to 6, independent
of the engine.

A solver gives ``leave(q, s, mode, t, x, v, t_end)``, which follows one flight or stick with the
solver's settings `s` and returns (side, t, x): side -1 or +1 where it was left, 0 where it lasts
until t_end, UNSOLVED where the solver gave up. `follow` decides from the forces on both sides of
the belt what comes next. All is in scalars, so that numba can compile it together with a solver;
solvers in Python call the same source.

The clock starts anew with each flight and stick (`from_now`): after many periods the rounding of
Omega t would be more than a fine tolerance allows. A contact without a change of sign is no event
to an integrator: only a flight that ends at a belt by so little that the forces send it back is a
"graze" here.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from fractions import Fraction
from math import cos, inf, pi, sin, sqrt
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import SymoscError
from symosc.bench.solvers import SolverEvent
from symosc.engine.arithmetic import mp_context
from symosc.friction import MODE_NAMES
from symosc.kernels.rebind import bind
from symosc.model import Parameters
from symosc.scenes import Scene

#: This oscillator never has so many events within one period (of `Problem`).
CHATTER = 100
EVENT_KINDS = ("cross", "stick", "slip", "graze")
#: Their places.
CROSSES, STICKS, SLIPS, GRAZES = range(4)
#: Modes up to this one are domains; ON_BELT + 1 and ON_BELT + 2 are sticks, as in the engine.
ON_BELT = 3
#: What `leave` returns as the side, but for -1 and 1: the mode lasts until t_end, or the solver gave
#: up.
LASTS = 0
UNSOLVED = 2
#: What `follow` returns as its outcome.
REACHED_END = 0
CHATTERS = 1
GAVE_UP = 2
# So many times are tried for a root at most.
MOST_TRIALS = 200
# A root is refined until its bracket is within this part of its time.
LAST_BIT = 2.0**-52
# A force, or a derivative of one, within this part of the sum of its terms is zero up to rounding;
# up to this many derivatives decide where a force vanishes.
FORCE_ROUNDING = 1e-15
MOST_DERIVATIVES = 5

# What careful users of step-by-step integrators set, found by trial on the shipped scenes and some
# hundred random ones:
#: Flights from a belt start this part of its `speed_scales` off it. Errors after a near graze are in
#: proportion (1e-12 costs two digits in fig8); from the belt itself, some flights come back at once
#: for ever.
ONE_STEP_OFFSET = 1e-15
#: Steps per period at least. With 4, DOP853 of scipy at 1e-4 loses 8 of the 18 events of fig8 up to
#: t = 20, with 8 none; with more than 8, fine tolerances gain nothing.
STEPS_PER_PERIOD = 8
#: atol by rtol. With atol = rtol the same error costs the same.
ATOL = 1e-3

#: What a solver's module defines under these names, and `bind` puts in their place: ``leave`` as
#: above, and ``margin(q, mode, side, piece, tau)``, how far a flight or stick is from being left on
#: one side after the time tau.
leave: Any = None
margin: Any = None


class PeerError(SymoscError, RuntimeError):
    """Raised if a peer solver cannot continue."""


class PeerProblem(NamedTuple):
    """A parameter set as floats: coefficients of eq. (9), belt speeds, shorter of drive period and
    free period.
    """

    A1: float
    A2: float
    A3: float
    swing: float
    Omega: float
    stiffness: float
    damping: float
    v1: float
    v2: float
    period: float
    theta: float  # the phase of the drive at t = 0


def problem(p: Parameters, origin: Fraction = Fraction(0)) -> PeerProblem:
    """Return a parameter set in floats with the time counted from `origin`, so that late times keep
    their digits.
    """
    m = float(p.m)
    Omega = float(p.Omega)
    stiffness = float(p.k) / m
    damping = float(p.c) / m
    period = 2 * pi / max(Omega, sqrt(max(0.0, stiffness - damping * damping / 4)))
    angle = p.Omega * origin
    # The phase is what is left of all turns: as many digits as these have, and 40.
    context = mp_context(40 + len(str(abs(angle.numerator))))
    theta = float(context.fmod(context.mpf(angle.numerator) / angle.denominator, 2 * context.pi))
    A1, A2, A3 = (float(p.A(alpha)) / m for alpha in (1, 2, 3))
    v1 = float(p.v1)
    v2 = float(p.v2)
    return PeerProblem(
        A1,
        A2,
        A3,
        swing=float(p.B0) / m,
        Omega=Omega,
        stiffness=stiffness,
        damping=damping,
        v1=v1,
        v2=v2,
        period=period,
        theta=theta,
    )


def from_now(q, t):
    """Return the problem `q` with its clock set to 0 at the time t."""
    theta = (q.theta + q.Omega * t) % (2.0 * pi)
    return PeerProblem(
        q.A1, q.A2, q.A3, q.swing, q.Omega, q.stiffness, q.damping, q.v1, q.v2, q.period, theta
    )


def force(q, alpha, t, x, v):
    """Return F^(alpha) of eq. (9), which is the acceleration in the domain `alpha`."""
    if alpha == 1:
        A = q.A1
    elif alpha == 2:
        A = q.A2
    else:
        A = q.A3
    return A + q.swing * cos(q.Omega * t + q.theta) - q.stiffness * x - q.damping * v


def margins(q, mode, t, x, v):
    """Return how far a motion is from leaving its mode downward and upward.

    Negative: it has left.
    """
    # In a flight these are the distances of v from the belts, in a stick F^(below) and -F^(above).
    if mode == 1:
        return inf, q.v1 - v
    if mode == 2:
        return v - q.v1, q.v2 - v
    if mode == 3:
        return v - q.v2, inf
    above = force(q, mode - ON_BELT + 1, t, x, v)
    if mode == ON_BELT + 1:
        return above + (q.A1 - q.A2), -above
    return above + (q.A2 - q.A3), -above


def turn(q, mode, t, x, v):
    """Return the time derivative of a mode's margins, up to its sign.

    Both margins turn only where it is 0.
    """
    if mode <= ON_BELT:
        return force(q, mode, t, x, v)
    return q.swing * q.Omega * sin(q.Omega * t + q.theta) + q.stiffness * v


def sign_of_force(q, alpha, t, x, v):
    """Return the sign of F^(alpha) at a boundary or, if F = 0, the sign of its first nonzero
    derivative (Theorem 6).
    """
    phase = q.Omega * t + q.theta
    swing = q.swing
    if alpha == 1:
        A = q.A1
    elif alpha == 2:
        A = q.A2
    else:
        A = q.A3
    size = (
        abs(A)
        + abs(swing * cos(phase))
        + abs(q.stiffness * x)
        + abs(q.damping * v)
        + abs(swing * phase)
    )
    before = v
    now = force(q, alpha, t, x, v)
    for order in range(MOST_DERIVATIVES):
        if abs(now) > FORCE_ROUNDING * size:
            if now > 0.0:
                return 1
            return -1
        # The next derivative of m v'' + c v' + k v = -B0 Omega sin(Omega t); v' and what follows is
        # 0 so far.
        swing *= q.Omega
        if order % 2 == 0:
            wave = sin(phase)
        else:
            wave = cos(phase)
        if order % 4 < 2:
            wave = -wave
        now = swing * wave - q.stiffness * before
        size = abs(swing) * (1.0 + abs(phase)) + abs(q.stiffness * before)
        before = 0.0
    return 0


def resolve(q, boundary, t, x):
    """Return the mode that follows at a point of a boundary: passing (Theorem 5) or else a stick
    (Theorem 4).
    """
    if boundary == 1:
        v = q.v1
    else:
        v = q.v2
    if sign_of_force(q, boundary + 1, t, x, v) > 0:
        return boundary + 1
    if sign_of_force(q, boundary, t, x, v) < 0:
        return boundary
    return ON_BELT + boundary


def speed_scales(q: PeerProblem, x: float, v: float) -> tuple[float, float]:
    """Return the speeds in proportion to which flights of a motion from `x`, `v` start off belt 1
    and off belt 2.
    """
    # It is the speed of the belt itself or, where that is slower than the motion, about that of the
    # motion, but no more than that of the other belt: the motion may not be as fast as these forces
    # let it be.
    speeds = abs(q.v1), abs(q.v2)
    push = abs(force(q, 2, 0.0, x, v)) + abs(q.swing) + 0.5 * (q.A1 - q.A3)
    motion = abs(v) + push / max(q.Omega, q.damping, sqrt(q.stiffness))
    slower = min(motion or inf, max(speeds))
    return max(speeds[0], slower), max(speeds[1], slower)


def start_mode(q, x, v):
    """Return the mode in which a motion starts at t = 0, and the boundary of its start, 0 if it is
    inside a domain.
    """
    if v == q.v1:
        boundary = 1
    elif v == q.v2:
        boundary = 2
    else:
        boundary = 0
    if boundary > 0:
        return resolve(q, boundary, 0.0, x), boundary
    return 1 + (v > q.v1) + (v > q.v2), 0


def root(q, mode, side, piece, a, b, fa, fb, tolerance):
    """Find the time between `a` and `b` at which a margin of a flight or stick is 0.

    It is `fa` at a and `fb` at b.
    """
    # Chandrupatla's method (1997): `a` is the newest time, `b` the other end of the bracket, and
    # `c` the end before; `part` says where between a and b the next time is.
    c = a
    fc = fa
    part = 0.5
    for _ in range(MOST_TRIALS):
        tau = a + part * (b - a)
        f = margin(q, mode, side, piece, tau)
        if (f < 0.0) == (fa < 0.0):
            c = a
            fc = fa
        else:
            c = b
            fc = fb
            b = a
            fb = fa
        a = tau
        fa = f
        if abs(fa) < abs(fb):
            best = a
            least = fa
        else:
            best = b
            least = fb
        smallest = (0.5 * tolerance + LAST_BIT * abs(best)) / abs(b - a)
        if smallest > 0.5 or least == 0.0:
            return best
        part = 0.5
        # Inverse quadratic interpolation where it is safe, else bisection.
        xi = (a - b) / (c - b)
        phi = (fa - fb) / (fc - fb)
        if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
            part = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (
                fc - fb
            )
        part = min(1.0 - smallest, max(smallest, part))
    return b


def follow(q, s, t, x, v, mode, boundary, offsets, t_end):
    """Follow a motion by a solver.

    Return rows of events, their count, how it ended, and the last mode.

    `s` has the settings of the solver. `boundary` is the belt at which the motion starts, 0 for
    none. A flight from a belt starts with a velocity that is off the belt's by that belt's number
    in `offsets`.
    """
    # A row is t, x, place in EVENT_KINDS, boundary; the outcome is REACHED_END, CHATTERS or
    # GAVE_UP.
    rows = np.empty((64, 4))
    count = 0
    while t < t_end:
        if boundary > 0 and mode <= ON_BELT:
            # The domain above the belt has the larger number.
            if mode > boundary:
                v += offsets[boundary - 1]
            else:
                v += -offsets[boundary - 1]
        here = from_now(q, t)
        side, tau, x = leave(here, s, mode, 0.0, x, v, t_end - t)
        t += tau
        if side == LASTS:
            break
        if side == UNSOLVED:
            return rows, count, GAVE_UP, mode
        source = mode
        kind = SLIPS
        if source > ON_BELT:
            boundary = source - ON_BELT
            # The domain above a belt has the number of the belt + 1, that below it the belt's own.
            if side > 0:
                mode = boundary + 1
            else:
                mode = boundary
        else:
            # Domain alpha has the belt alpha above it, and the belt alpha - 1 below.
            if side > 0:
                boundary = source
            else:
                boundary = source - 1
            mode = resolve(here, boundary, tau, x)
            if mode > ON_BELT:
                kind = STICKS
            elif mode == source:
                kind = GRAZES
            else:
                kind = CROSSES
        if boundary == 1:
            v = q.v1
        else:
            v = q.v2
        if count == len(rows):
            longer = np.empty((2 * count, 4))
            for i in range(count):  # a slice would make compiling three seconds longer
                for j in range(4):
                    longer[i, j] = rows[i, j]
            rows = longer
        rows[count, 0] = t
        rows[count, 1] = x
        rows[count, 2] = kind
        rows[count, 3] = boundary
        count += 1
        # More than CHATTER events within a period of the drive.
        if count > CHATTER and t - rows[count - 1 - CHATTER, 0] < q.period:
            return rows, count, CHATTERS, mode
    return rows, count, REACHED_END, mode


def with_solver(leave: Callable[..., tuple[int, float, float]]) -> Record:
    """Return the functions of this module by name, with `leave` in the place of its own."""
    return bind((sys.modules[__name__],), {"leave": leave})


def runner(
    scene: Scene, functions: Record, settings: Any, offset: float
) -> Callable[[], Iterator[SolverEvent]]:
    """Return a function that follows a scene and returns its events, or raises PeerError.

    `functions` are those of this module, by name, bound to the solver's function `leave`;
    `settings` are what it gets. A flight from a belt starts with a velocity that is off the belt's
    by `offset` times its number of `speed_scales`.
    """
    q = problem(scene.parameters, scene.t0)
    t0 = float(scene.t0)
    x = float(scene.x0)
    v = float(scene.v0)
    mode, boundary = start_mode(q, x, v)
    first, second = speed_scales(q, x, v)
    offsets = offset * first, offset * second
    # All arguments of `follow` but its last one, t_end. Its clock starts at 0.
    arguments = q, settings, 0.0, x, v, mode, boundary, offsets
    duration = float(scene.t_end - scene.t0)
    follow = functions["follow"]
    follow(*arguments, 0.0)  # compiles

    def events(rows: np.ndarray) -> Iterator[SolverEvent]:
        for t, x, kind, boundary in rows.tolist():
            yield SolverEvent(t0 + t, x, EVENT_KINDS[int(kind)], int(boundary))

    def run() -> Iterator[SolverEvent]:
        rows, count, outcome, last = follow(*arguments, duration)
        latest = t0
        if count:
            latest += rows[count - 1, 0]
        where = f"in {MODE_NAMES[last]} after t = {latest:.6g}"
        if outcome == CHATTERS:
            raise PeerError(f"chatters {where}: more than {CHATTER} events within one period")
        if outcome == GAVE_UP:
            raise PeerError(f"took too many steps {where}")
        return events(rows[:count])

    return run
