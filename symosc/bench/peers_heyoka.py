"""heyoka: Taylor series of high order, compiled just in time, with events found on the series
itself.

One integrator does everything. Flights and sticks differ by its parameters, which the callbacks of
its two terminal events rewrite; so Python runs once per event. The drive is two more state
variables, which is cheaper than a cosine. It also keeps the steps short in a stick, where x and v
alone would let them grow past its end. Flights start off the belt and need no cool-down: in a step
that starts where an event function is exactly 0, heyoka 7.13 does not see the next root.

The state is x, v, and B0/m times the cosine and the sine of the drive. With parameters p, v' = p0
(a + p1) with a = (B0 cos - k x - c v)/m. The event functions are p2 v + p3 a + p4 and p5 v + p6 a +
p7: in flights the distances of v from both belts, in sticks the accelerations on both sides.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import starmap
from math import ceil, cos, log2, sin
from typing import Any, NamedTuple

import numpy as np

from symosc.bench.event_logic import (
    CHATTER,
    ON_BELT,
    ONE_STEP_OFFSET,
    PeerError,
    PeerProblem,
    problem,
    speed_scales,
    start_mode,
)
from symosc.bench.solvers import Solver, SolverEvent
from symosc.friction import NEIGHBOURS
from symosc.model import Parameters
from symosc.scenes import Scene


class Tables(NamedTuple):
    """What the callbacks look up: A_alpha/m by domain, belt speeds, the integrator's parameters by
    mode, and the velocities just off a belt by (belt, domain).
    """

    A: dict[int, float]
    belts: dict[int, float]
    parameters: dict[int, np.ndarray]
    starts: dict[tuple[int, int], float]


def tables(q: PeerProblem, x: float, v: float) -> Tables:
    """Return the tables of a problem, for motions from `x`, `v`."""
    A = {1: q.A1, 2: q.A2, 3: q.A3}
    belts = {1: q.v1, 2: q.v2}
    # The eight parameters of `equations`. In a flight the functions are v - v1 and v - v2, on a belt
    # the accelerations below and above it.
    scales = dict(zip(belts, speed_scales(q, x, v), strict=True))
    # heyoka's tolerance is relative to the largest number, among event functions too: the distance
    # from a belt far faster than the motion is shrunk, by a power of two, which rounds nothing.
    far = {boundary: scales[boundary] / scales[3 - boundary] for boundary in belts}
    s1, s2 = (2.0 ** -max(0, ceil(log2(far[boundary]))) for boundary in belts)
    parameters = {
        alpha: np.array([1.0, A[alpha], s1, 0.0, -q.v1 * s1, s2, 0.0, -q.v2 * s2]) for alpha in A
    }
    for boundary, (below, above) in NEIGHBOURS.items():
        parameters[ON_BELT + boundary] = np.array(
            [0.0, 0.0, 0.0, 1.0, A[below], 0.0, 1.0, A[above]]
        )
    starts = dict[tuple[int, int], float]()
    for boundary, speed in belts.items():
        offset = ONE_STEP_OFFSET * scales[boundary]
        starts[boundary, boundary] = speed - offset
        starts[boundary, boundary + 1] = speed + offset
    return Tables(A, belts, parameters, starts)


def equations(q: PeerProblem) -> tuple[list[Any], tuple[Any, Any]]:
    """Return heyoka's equations of motion and two event functions, whose zeros end a flight or
    stick.
    """
    import heyoka as hy

    x, v, C, S = hy.make_vars("x", "v", "C", "S")
    # p[0] is 1 in a flight and 0 on a belt, p[1] A_alpha/m; p[2] to p[4] are the factors of velocity
    # and acceleration without friction, and the constant, of the first function, p[5] to p[7] those
    # of the second. C and S are the drive, B0/m times cosine and sine of its phase.
    p = hy.par
    a = C - q.stiffness * x - q.damping * v
    rates = [(x, v), (v, p[0] * (a + p[1])), (C, -q.Omega * S), (S, q.Omega * C)]
    return rates, (p[2] * v + p[3] * a + p[4], p[5] * v + p[6] * a + p[7])


def prepare(scene: Scene, tolerance: float) -> Callable[[], Iterator[SolverEvent]]:
    """Return a function that follows the motion of a scene and returns its events, with the
    integrator built before.
    """
    import heyoka as hy

    q = problem(scene.parameters, scene.t0)
    x0 = float(scene.x0)
    v0 = float(scene.v0)
    A, belts, pars, starts = tables(q, x0, v0)
    stiffness = q.stiffness
    damping = q.damping
    t0 = float(scene.t0)
    # What the callbacks work on, set by `run`: the mode, `append` of the list of events, and views
    # of the integrator's state x, v, C, S (`item` reads a number of it) and parameters.
    now: int
    append: Any
    item: Any
    state: Any
    p_now: Any

    def callback(event: int) -> Callable[[Any, int], bool]:
        """Return the callback of event 1 or 2: in a flight, contact with belt 1 or 2; in a stick, a
        slip down or up.
        """
        # What does not change from call to call is looked up here, once.
        belt = belts[event]
        drag = damping * belt
        A_below = A[event]
        A_above = A[event + 1]
        v_below = starts[event, event]
        v_above = starts[event, event + 1]
        stick = pars[ON_BELT + event]

        def act(integrator: Any, sign: int) -> bool:
            nonlocal now
            x = item(0)
            source = now
            if source > ON_BELT:
                boundary = source - ON_BELT
                now = boundary + event - 1  # the domain below the belt (event 1), or above (2)
                state[1] = starts[boundary, now]
                p_now[:] = pars[now]
                append((t0 + integrator.time, x, "slip", boundary))
                return True
            # The acceleration without friction. With that on either side it says what follows.
            a = item(2) - stiffness * x - drag
            if a + A_above > 0.0:
                now = event + 1
                state[1] = v_above
                p_now[1] = A_above
            elif a + A_below < 0.0:
                now = event
                state[1] = v_below
                p_now[1] = A_below
            else:
                now = ON_BELT + event
                state[1] = belt
                p_now[:] = stick
            if now > ON_BELT:
                kind = "stick"
            elif now == source:
                kind = "graze"
            else:
                kind = "cross"
            append((t0 + integrator.time, x, kind, event))
            return True

        return act

    rates, functions = equations(q)
    events = [hy.t_event(f, callback=callback(n), cooldown=0.0) for n, f in enumerate(functions, 1)]
    integrator = hy.taylor_adaptive(
        rates, [0.0] * 4, pars=[0.0] * 8, t_events=events, tol=tolerance, fast_math=True
    )
    mode, boundary = start_mode(q, x0, v0)
    if boundary and mode <= ON_BELT:
        v = starts[boundary, mode]
    else:
        v = v0
    start = np.array([x0, v, q.swing * cos(q.theta), q.swing * sin(q.theta)])
    duration = float(scene.t_end - scene.t0)
    # Steps that a run may take: this number per period, and as many before the first one.
    most_steps = 100 * CHATTER * (1 + int(duration / q.period))

    def run() -> Iterator[SolverEvent]:
        nonlocal now, append, item, state, p_now
        rows: list[tuple[Any, ...]] = []
        now = mode
        append = rows.append
        integrator.time = 0.0
        state = integrator.state
        p_now = integrator.pars
        item = state.item
        p_now[:] = pars[mode]
        state[:] = start
        outcome, *_ = integrator.propagate_until(duration, max_steps=most_steps)
        # The integrator owns the callbacks: they must not own it.
        append = None
        item = None
        state = None
        p_now = None
        if outcome != hy.taylor_outcome.time_limit:
            raise PeerError(f"heyoka: {outcome} after {len(rows)} events")
        return starmap(SolverEvent, rows)

    return run


def count_many(
    p: Parameters, starts: np.ndarray, durations: np.ndarray, tolerance: float
) -> Callable[[], np.ndarray]:
    """Return a function that counts events of motions from (t, x, v), several at once in the
    processor's registers.
    """
    import heyoka as hy

    q = problem(p)
    width = hy.recommended_simd_size()
    farthest, fastest = np.max(np.abs(starts[:, 1:]), axis=0).tolist()
    A, belts, pars, v_starts = tables(q, farthest, fastest)
    stiffness = q.stiffness
    now = [0] * width
    counts = [0] * width

    def callback(event: int) -> Callable[[Any, int, int], bool]:
        """Return the callback of an event, as in `prepare`.

        It also takes the number of the motion in the batch.
        """
        belt = belts[event]
        drag = q.damping * belt
        A_below = A[event]
        A_above = A[event + 1]
        v_below = v_starts[event, event]
        v_above = v_starts[event, event + 1]
        stick = pars[ON_BELT + event]

        def act(_: Any, sign: int, i: int) -> bool:
            counts[i] += 1
            source = now[i]
            if source > ON_BELT:
                boundary = source - ON_BELT
                mode = boundary + event - 1  # the domain below the belt (event 1), or above (2)
                now[i] = mode
                v_now[i] = v_starts[boundary, mode]
                parameters[i][:] = pars[mode]
                return True
            # The acceleration without friction. With that on either side it says what follows.
            a = drive(i) - stiffness * position(i) - drag
            if a + A_above > 0.0:
                now[i] = event + 1
                v_now[i] = v_above
                force_now[i] = A_above
            elif a + A_below < 0.0:
                now[i] = event
                v_now[i] = v_below
                force_now[i] = A_below
            else:
                now[i] = ON_BELT + event
                v_now[i] = belt
                parameters[i][:] = stick
            return True

        return act

    rates, functions = equations(q)
    events = [
        hy.t_event_batch(f, callback=callback(n), cooldown=0.0) for n, f in enumerate(functions, 1)
    ]
    zeros = np.zeros((4, width))
    options = {"t_events": events, "tol": tolerance, "fast_math": True}
    integrator = hy.taylor_adaptive_batch(rates, zeros, pars=np.zeros((8, width)), **options)
    # Views, with a column for each motion: rows x, v, C, S of the state, and the parameters of
    # `equations`.
    state = integrator.state
    all_parameters = integrator.pars
    parameters = list(all_parameters.T)
    v_now = state[1]
    force_now = all_parameters[1]
    position = state[0].item
    drive = state[2].item

    def run() -> np.ndarray:
        totals = np.zeros(len(starts), np.int64)
        for first in range(0, len(starts), width):
            # The last batch begins again with the first motions.
            rows = np.arange(first, first + width) % len(starts)
            t0, x0, v0 = starts[rows].T
            theta = q.theta + q.Omega * t0
            state[:] = (x0, v0, q.swing * np.cos(theta), q.swing * np.sin(theta))
            integrator.set_time(0.0)
            for i, (_, x, v) in enumerate(starts[rows].tolist()):
                now[i], _ = start_mode(q, x, v)
                counts[i] = 0
                parameters[i][:] = pars[now[i]]
            integrator.propagate_until(durations[rows])
            outcomes = [outcome for outcome, *_ in integrator.propagate_res]
            if any(outcome != hy.taylor_outcome.time_limit for outcome in outcomes):
                raise PeerError(f"heyoka: {integrator.propagate_res}")
            totals[rows] = counts
        return totals

    return run


SOLVERS = (
    Solver(
        "heyoka",
        prepare,
        (1e-4, 1e-6, 1e-8, 1e-10, 2e-13, 1e-16),
        needs="heyoka",
        note="one integrator for flights and sticks, fast_math; flights start "
        f"{ONE_STEP_OFFSET:g} off the belt",
    ),
)
