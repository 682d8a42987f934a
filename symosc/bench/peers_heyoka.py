"""heyoka: Taylor series of high order, compiled just in time, with events found on the series itself.

At its best, one integrator does everything. Flights and sticks differ by its parameters, which the callbacks of its two
terminal events rewrite; so Python runs once per event. The drive is two more state variables, which is cheaper than a
cosine. It also keeps the steps short in a stick, where x and v alone would let them grow past its end. Flights start
off the belt and need no cool-down.

As it comes, there is one integrator for each domain and belt, which is stopped by its terminal events and started
again on the belt. In a step that starts where an event function is exactly 0, heyoka 7.13 does not see the next root.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any

import numpy as np

from symosc.bench.event_logic import CHATTER, Exit, Motion, PeerError, Phase, follow
from symosc.bench.scalar_logic import ONE_STEP_OFFSET
from symosc.bench.solvers import Late, Solver
from symosc.model import NEIGHBOURS
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene

#: Steps that a run may take: this number per period, and as many before the first one.
MOST_HEYOKA_STEPS = 100 * CHATTER


def at_its_best(scene: Scene, tolerance: float) -> Callable[[], Late]:
    """Prepare one integrator for all modes.

    Notes
    -----
    State: x, v, and B0/m times the cosine and the sine of the drive. Parameters p: v' = p0 (a + p1) with a = (B0 cos -
    k x - c v)/m. The event functions are p2 v + p3 a + p4 and p5 v + p6 a + p7. In flights these are the distances of v
    from both belts, in sticks the accelerations on both sides.
    """
    import heyoka as hy

    motion = Motion(scene.parameters, scene.t0)
    stiffness, damping = motion.k / motion.m, motion.c / motion.m
    A, pars, starts = tables(motion)
    t0 = float(scene.t0)
    # What the callbacks work on: mode, event list, and views of state and parameters, made once per run.
    now: int
    append: Any
    item: Any
    state: Any
    p_now: Any

    def callback(event: int) -> Callable[[Any, int], bool]:
        """Return what the first or second event does: contact with belt 1 or 2, or a slip downward or upward."""
        belt = motion.belts[event]
        drag, A_below, A_above = damping * belt, A[event], A[event + 1]
        v_below, v_above, stick = starts[event, event], starts[event, event + 1], pars[3 + event]

        def act(integrator: Any, sign: int) -> bool:
            nonlocal now
            x, source = item(0), now
            if source > 3:
                boundary = source - 3
                now = boundary + event - 1
                state[1], p_now[:] = starts[boundary, now], pars[now]
                append((t0 + integrator.time, x, "slip", boundary))
                return True
            a = item(2) - stiffness * x - drag
            if a + A_above > 0.0:
                now, state[1], p_now[1] = event + 1, v_above, A_above
            elif a + A_below < 0.0:
                now, state[1], p_now[1] = event, v_below, A_below
            else:
                now, state[1], p_now[:] = 3 + event, belt, stick
            kind = "stick" if now > 3 else "graze" if now == source else "cross"
            append((t0 + integrator.time, x, kind, event))
            return True

        return act

    integrator = _integrator(motion, callback, tolerance)
    mode, start = _start(scene, motion, starts)
    duration = float(scene.t_end - scene.t0)
    most = MOST_HEYOKA_STEPS * (1 + int(duration / motion.period))

    def run() -> Late:
        nonlocal now, append, item, state, p_now
        rows: list[tuple[Any, ...]] = []
        now, append, integrator.time = mode, rows.append, 0.0
        state, p_now = integrator.state, integrator.pars
        state[:], p_now[:], item = start, pars[mode], state.item
        outcome = integrator.propagate_until(duration, max_steps=most)[0]
        append = item = state = p_now = None  # the integrator owns the callbacks: they must not own it
        found = Late(lambda: list(map(FoundEvents._make, rows)))
        if outcome != hy.taylor_outcome.time_limit:
            raise PeerError(f"heyoka: {outcome} after {len(found)} events", found)
        return found

    return run


def tables(motion: Motion) -> tuple[dict[int, float], dict[int, np.ndarray], dict[tuple[int, int], float]]:
    """Return A_alpha/m, the integrator's parameters by mode, and where flights start by boundary and domain."""
    A = {alpha: force / motion.m for alpha, force in motion.A.items()}
    v1, v2 = motion.belts.values()
    pars = {alpha: np.array([1.0, A[alpha], 1.0, 0.0, -v1, 1.0, 0.0, -v2]) for alpha in A}
    for boundary, (below, above) in NEIGHBOURS.items():
        pars[3 + boundary] = np.array([0.0, 0.0, 0.0, 1.0, A[below], 0.0, 1.0, A[above]])
    offset = ONE_STEP_OFFSET * motion.speed
    starts = {(boundary, boundary): v - offset for boundary, v in motion.belts.items()}
    starts |= {(boundary, boundary + 1): v + offset for boundary, v in motion.belts.items()}
    return A, pars, starts


def equations(motion: Motion) -> tuple[list[Any], tuple[Any, Any]]:
    """Return the differential equations and the two event functions of `at_its_best`."""
    import heyoka as hy

    x, v, C, S = hy.make_vars("x", "v", "C", "S")
    p, a = hy.par, C - motion.k / motion.m * x - motion.c / motion.m * v
    rates = [(x, v), (v, p[0] * (a + p[1])), (C, -motion.Omega * S), (S, motion.Omega * C)]
    return rates, (p[2] * v + p[3] * a + p[4], p[5] * v + p[6] * a + p[7])


def _integrator(motion: Motion, callback: Callable[[int], Callable[[Any, int], bool]], tolerance: float) -> Any:
    """Return the integrator of `at_its_best`, whose two events call what `callback` returns for them."""
    import heyoka as hy

    rates, functions = equations(motion)
    events = [hy.t_event(f, callback=callback(n), cooldown=0.0) for n, f in enumerate(functions, 1)]
    return hy.taylor_adaptive(rates, [0.0] * 4, pars=[0.0] * 8, t_events=events, tol=tolerance, fast_math=True)


def _start(scene: Scene, motion: Motion, starts: dict[tuple[int, int], float]) -> tuple[int, np.ndarray]:
    """Return the mode and the state that the motion starts with."""
    mode, boundary = motion.start(0.0, float(scene.x0), float(scene.v0))
    v = starts[boundary, mode] if boundary and mode < 4 else float(scene.v0)
    swing = motion.B0 / motion.m
    return mode, np.array([float(scene.x0), v, swing * cos(motion.theta), swing * sin(motion.theta)])


def as_it_comes(scene: Scene, tolerance: float) -> Callable[[], list[FoundEvents]]:
    """Prepare an integrator for each mode, to be stopped by terminal events and started again on the belt."""
    import heyoka as hy

    motion = Motion(scene.parameters)
    x, v = hy.make_vars("x", "v")

    def force(alpha: int) -> Any:
        drive = motion.B0 * hy.cos(motion.Omega * hy.time)
        return (motion.A[alpha] + drive - motion.k * x - motion.c * v) / motion.m

    v1, v2 = motion.belts.values()
    exits = {1: [v1 - v], 2: [v - v1, v2 - v], 3: [v - v2]}
    exits |= {3 + i: [force(below), -force(above)] for i, (below, above) in NEIGHBOURS.items()}
    integrators = {}
    for mode, functions in exits.items():
        events = [hy.t_event(f, direction=hy.event_direction.negative) for f in functions]
        rates = [(x, v), (v, force(mode) if mode < 4 else 0.0 * v)]
        integrators[mode] = hy.taylor_adaptive(rates, [0.0, 0.0], t_events=events, tol=tolerance)

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Exit:
        integrator = integrators[phase.mode]
        integrator.time, integrator.state[:] = t, (x, v)
        integrator.reset_cooldowns()
        outcome = integrator.propagate_until(t_end, max_steps=MOST_HEYOKA_STEPS)[0]
        if outcome == hy.taylor_outcome.time_limit:
            return Exit(0, t_end, integrator.state.item(0))
        event = -int(outcome) - 1
        if event >= len(phase.exits):
            raise PeerError(f"heyoka: {outcome}")
        return Exit(phase.exits[event][0], integrator.time, integrator.state.item(0))

    return lambda: follow(scene, motion, leave)


HEYOKA_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 2e-13, 1e-16)
SOLVERS = (
    Solver(
        "heyoka",
        at_its_best,
        HEYOKA_TOLERANCES,
        needs="heyoka",
        note=f"one integrator for flights and sticks, fast_math; flights start {ONE_STEP_OFFSET:g} off the belt",
    ),
    Solver(
        "heyoka, raw",
        as_it_comes,
        HEYOKA_TOLERANCES,
        needs="heyoka",
        raw=True,
        note="started on the belt it misses the next root in the same step; in sticks the step grows past their end",
    ),
)
