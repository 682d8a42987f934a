"""Ways to differentiate events, as careful users of other tools set them up, and their score on the
reference cases.

Where a tool has no derivatives through events, its flights have them, at a fixed duration;
`through_events` does for all such tools what an event does to them (implicit function theorem,
saltation). diffrax differentiates through its events itself; finite differences run the motion 28
times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, partial
from math import cos, pi, sin
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from tabulate import tabulate

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.base.files import write_text
from symosc.bench import (
    Progress,
    cases,
    event_logic,
    not_run,
    peers_heyoka,
    peers_numba,
    peers_scipy,
    sentence,
)
from symosc.bench.event_logic import (
    ONE_STEP_OFFSET,
    STEPS_PER_PERIOD,
    force,
    problem,
    runner,
    start_mode,
)
from symosc.bench.peers_numba import (
    E3,
    E5,
    STAGE_TIMES,
    STAGE_WEIGHTS,
    STAGES,
    STEP_EXPONENT,
    STEP_SAFETY,
)
from symosc.bench.solvers import FoundEvent, Prepare, Solver, events_of
from symosc.engine.flow import friction_signs
from symosc.kernels.rebind import bind
from symosc.model import NEIGHBOURS, PARAMETER_NAMES, Parameters, by_name
from symosc.reference.case import ReferenceCase
from symosc.reference.cases import SET_VERSION, reference_cases
from symosc.reference.score import CaseScore, Score, as_markdown, by_group
from symosc.scenes import Scene
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.tangents import NAMES

#: Tolerance of the tools, and relative step of central differences: the cube root of the error of a
#: run, about.
TOLERANCE = 1e-12
DIFFERENCE = 1e-4
#: ``jacobian(m, c, k, A, B, Omega, phase, x, v, duration)`` returns the gradients of x and v, in
#: the order of COLUMNS.
Jacobian = Callable[..., tuple[np.ndarray, np.ndarray]]
X, V, OF_M, OF_C, OF_K, OF_A, OF_B, OF_OMEGA, OF_PHASE = COLUMNS = range(9)


def found_changes(event: FoundEvent, dt: Sequence[float], dx: Sequence[float]) -> FoundEvent:
    """Return an event with the derivatives `dt` of its time and `dx` of its position stored by
    name, without NaN.
    """
    rows = (("dt", dt), ("dx", dx))
    changes = {
        f"{of}_{name}": float(d)
        for of, row in rows
        for name, d in zip(NAMES, row, strict=True)
        if d == d
    }
    return event._replace(changes=changes)


# -- derivatives of flights, and what events do to them --------------------------------------------

#: The derivatives of each parameter and start value with respect to all of them.
ONE = dict(zip(NAMES, np.eye(len(NAMES)), strict=True))


def pieces(scene: Scene, events: Iterable[FoundEvent]) -> Iterator[tuple[Any, ...]]:
    """Yield each event with the flight or stick that leads to it; a graze does not end a flight."""
    # Of that: mode, t, x, v and boundary (or 0) of its start; the side where it ends, the next
    # mode.
    q = problem(scene.parameters, scene.t0)
    t = float(scene.t0)
    x = float(scene.x0)
    v = float(scene.v0)
    t0 = t
    (mode, boundary) = start_mode(q, x, v)
    for event in events:
        at = event.boundary
        if event.boundary == 1:
            speed = q.v1
        else:
            speed = q.v2
        if mode < 4:
            if at == mode:
                side = 1
            else:
                side = -1
            if event.kind == "stick":
                after = 3 + at
            elif event.kind == "graze":
                after = mode
            else:
                after = 2 * at + 1 - mode
        else:
            below, above = (abs(force(q, n, event.t - t0, event.x, speed)) for n in NEIGHBOURS[at])
            if above < below:
                side = 1
                after = at + 1
            else:
                side = -1
                after = at
        yield event, mode, t, x, v, boundary, side, after
        if event.kind != "graze":
            mode = after
            boundary = at
            t = event.t
            x = event.x
            v = speed


def through_events(
    scene: Scene, events: Iterable[FoundEvent], jacobian: Jacobian
) -> Iterator[FoundEvent]:
    """Yield the events of a motion with their derivatives, by the chain rule from the derivatives
    of its flights.
    """
    p = scene.parameters
    q = problem(scene.parameters, scene.t0)
    t0 = float(scene.t0)
    number = by_name(p, float)
    m, c, k, B0, Omega = (number[name] for name in ("m", "c", "k", "B0", "Omega"))

    def gradient_of_A(domain: int) -> np.ndarray:
        """Return the derivatives of A, the constant force in a domain, with respect to all
        parameters.
        """
        one, two = friction_signs(domain)
        by_mu = number["FN"] * (one * ONE["mu1"] + two * ONE["mu2"])
        return ONE["A0"] + by_mu + (one * number["mu1"] + two * number["mu2"]) * ONE["FN"]

    # at fixed times
    dx = ONE["x0"]
    dv = ONE["v0"]
    for n, (event, mode, t, x, v, _, _, after) in enumerate(pieces(scene, events)):
        if n == 0:
            dx = dx - v * ONE["t0"]
            dv = dv - (force(q, mode, 0.0, x, v) if mode < 4 else 0.0) * ONE["t0"]
        duration = event.t - t
        speed = number[f"v{event.boundary}"]
        belt = ONE[f"v{event.boundary}"]
        if mode < 4:
            phase = (q.theta + Omega * (t - t0)) % (2 * pi)
            dx_end, dv_end = (
                d[X] * dx + d[V] * dv + d[OF_M] * ONE["m"] + d[OF_C] * ONE["c"] + d[OF_K] * ONE["k"]
                + d[OF_A] * gradient_of_A(mode) + d[OF_B] * ONE["B0"] + (d[OF_OMEGA] + t * d[OF_PHASE]) * ONE["Omega"]
                for d in jacobian(m, c, k, float(p.A(mode)), B0, Omega, phase, x, v, duration)
            )  # fmt: skip
            dt = (belt - dv_end) / force(q, mode, event.t - t0, event.x, speed)
        else:
            dx_end = dx + dv * duration
            phase = q.theta + Omega * (event.t - t0)
            change = (
                gradient_of_A(after)
                + cos(phase) * ONE["B0"]
                - B0 * event.t * sin(phase) * ONE["Omega"]
            )
            change = change - event.x * ONE["k"] - k * dx_end - speed * ONE["c"] - c * belt
            dt = change / (k * speed + B0 * Omega * sin(phase))
        yield found_changes(event, dt, dx_end + speed * dt)
        if event.kind != "graze":
            if after < 4:
                a = force(q, after, event.t - t0, event.x, speed)
            else:
                a = 0.0
            dx = dx_end
            dv = belt - a * dt


def by_flights(
    follow: Prepare, jacobian_of: Callable[[float], Jacobian], scene: Scene, tolerance: float
) -> Callable[[], list[FoundEvent]]:
    """Return a function that finds events by `follow` and differentiates them by the Jacobians of
    their flights.
    """
    run = follow(scene, tolerance)
    jacobian = jacobian_of(tolerance)
    return lambda: list(through_events(scene, run(), jacobian))


@lru_cache(maxsize=1)
def heyoka_jacobian(tolerance: float) -> Jacobian:
    """Return a function that differentiates a flight's end by heyoka's variational equations."""
    import heyoka as hy

    x, v = hy.make_vars("x", "v")
    m, c, k, A, B, Omega, phase = (hy.par[i] for i in range(7))
    equations = [(x, v), (v, (A + B * hy.cos(Omega * hy.time + phase) - k * x - c * v) / m)]
    system = hy.var_ode_sys(equations, hy.var_args.vars | hy.var_args.params, order=1)
    integrator = hy.taylor_adaptive(
        system, [0.0, 0.0], pars=[1.0] * 7, tol=tolerance, fast_math=True
    )
    begin = np.array(integrator.state)

    def jacobian(*values: float) -> tuple[np.ndarray, np.ndarray]:
        *pars, x, v, duration = values
        integrator.time = 0.0
        integrator.pars[:] = pars
        integrator.state[:] = begin
        integrator.state[0] = x
        integrator.state[1] = v
        integrator.propagate_until(duration)
        found = np.array(integrator.state[2:])
        return found[:9], found[9:]

    return jacobian


@lru_cache(maxsize=1)
def cvodes_jacobian(tolerance: float) -> Jacobian:
    """Return a function that differentiates a flight's end by CVODES (from casadi), over a time
    scaled to [0, 1].
    """
    import casadi as ca

    y = ca.SX.sym("y", 2)
    p = ca.SX.sym("p", 8)
    s = ca.SX.sym("s")
    m, c, k, A, B, Omega, phase, duration = (p[i] for i in range(8))
    push = A + B * ca.cos(Omega * duration * s + phase) - k * y[0] - c * y[1]
    equations = {"x": y, "p": p, "t": s, "ode": duration * ca.vertcat(y[1], push / m)}
    options = {"abstol": tolerance * 1e-1, "reltol": tolerance, "max_num_steps": 1_000_000}
    integrator = ca.integrator("flight", "cvodes", equations, 0, 1, options)
    slopes = integrator.factory("slopes", ["x0", "p"], ["jac:xf:x0", "jac:xf:p"])

    def jacobian(*values: float) -> tuple[np.ndarray, np.ndarray]:
        *pars, x, v, duration = values
        by_start, by_parameters = map(np.array, slopes([x, v], [*pars, duration]))
        found = np.hstack([by_start, by_parameters[:, :7]])
        return found[0], found[1]

    return jacobian


def tangent_steps(m, c, k, A, B, Omega, phase, x, v, duration, tolerance):
    """Return x, v and derivatives by start and parameters after a flight, by DOP853 on the
    variational equations.
    """
    y = np.zeros(20)
    K = np.zeros((STAGES + 1, 20))
    new = np.zeros(20)
    t = 0.0
    y[0] = x
    y[1] = v
    y[2 + 2 * X] = 1.0
    y[3 + 2 * V] = 1.0
    longest = duration / max(
        1.0, np.ceil(duration * max(Omega, np.sqrt(k / m)) * STEPS_PER_PERIOD / (2 * pi))
    )
    h = longest / 4.0
    while t < duration:
        h = min(h, longest, duration - t)
        for stage in range(STAGES + 1):
            new[:] = y
            for j in range(stage):
                new += h * STAGE_WEIGHTS[stage, j] * K[j]
            now = t + h * STAGE_TIMES[stage]
            push = (A + B * cos(Omega * now + phase) - k * new[0] - c * new[1]) / m
            K[stage, 2::2] = new[3::2]
            K[stage, 3::2] = -(k * new[2::2] + c * new[3::2]) / m
            K[stage, 0] = new[1]
            K[stage, 1] = push
            K[stage, 3 + 2 * OF_M] -= push / m
            K[stage, 3 + 2 * OF_C] -= new[1] / m
            K[stage, 3 + 2 * OF_K] -= new[0] / m
            K[stage, 3 + 2 * OF_A] += 1.0 / m
            K[stage, 3 + 2 * OF_B] += cos(Omega * now + phase) / m
            K[stage, 3 + 2 * OF_OMEGA] -= B * sin(Omega * now + phase) * now / m
            K[stage, 3 + 2 * OF_PHASE] -= B * sin(Omega * now + phase) / m
        scale = tolerance * np.maximum(1e-3, np.maximum(np.abs(y), np.abs(new)))
        third = np.sum((E3 @ K / scale) ** 2)
        fifth = np.sum((E5 @ K / scale) ** 2)
        if fifth == 0.0:
            error = 0.0
        else:
            error = h * fifth / np.sqrt((fifth + 0.01 * third) * 20.0)
        if error < 1.0 or t + h == t:
            if h >= duration - t:
                t = duration
            else:
                t = t + h
            y[:] = new
        if error == 0.0:
            h *= 5.0
        else:
            h *= min(5.0, max(0.2, STEP_SAFETY * error**STEP_EXPONENT))
    return y


@lru_cache(maxsize=1)
def dop853_jacobian(tolerance: float) -> Jacobian:
    """Return a function that differentiates a flight's end by DOP853 with tangents, compiled by
    numba.
    """
    from numba import njit

    steps: Any = njit(tangent_steps)

    def jacobian(*values: float) -> tuple[np.ndarray, np.ndarray]:
        found = steps(*map(float, values), tolerance)
        return found[2::2], found[3::2]

    jacobian(*[1.0] * 10)  # compiles
    return jacobian


def differences(scene: Scene, tolerance: float) -> Callable[[], list[FoundEvent]]:
    """Prepare differences of events found by scipy's DOP853: central, or forward if a parameter
    cannot be decreased.
    """
    follow = partial(peers_scipy.prepare, "DOP853")

    def moved(name: str, by: float) -> list[FoundEvent] | None:
        start = name not in PARAMETER_NAMES
        try:
            changed = {name: getattr(scene if start else scene.parameters, name) + Fraction(by)}
            if not start:
                changed = {"parameters": scene.parameters.replace(**changed)}
            return list(follow(replace(scene, **changed), tolerance)())
        except (ParameterError, event_logic.PeerError):
            return None

    def run() -> list[FoundEvent]:
        events = list(follow(scene, tolerance)())
        slopes = np.full((2, len(events), len(NAMES)), np.nan)
        for j, name in enumerate(NAMES):
            value = float(getattr(scene.parameters if name in PARAMETER_NAMES else scene, name))
            h = DIFFERENCE * (abs(value) or 1.0)
            more = moved(name, h)
            less = moved(name, -h)
            if less is None:
                low = events
                width = h
            else:
                low = less
                width = 2 * h
            for n, (event, a, b) in enumerate(zip(events, more or [], low, strict=False)):
                if not event[2:] == a[2:] == b[2:]:
                    break
                slopes[:, n, j] = (a.t - b.t) / width, (a.x - b.x) / width
        return [found_changes(event, *slopes[:, n]) for n, event in enumerate(events)]

    return run


# -- diffrax ---------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def diffrax_pieces(tolerance: float) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return two functions: one follows a flight or stick to its event, the other differentiates
    that event by JAX.
    """
    # The arguments are the parameters; t, x, v and the phase at the start; the duration, the signs
    # of the friction, whether it flies, and the event function: of v, of the force, and of both
    # belt speeds.
    import diffrax
    import jax
    import jax.numpy as jnp
    import optimistix

    jax.config.update("jax_enable_x64", True)

    def rate(t: Any, y: Any, args: Any) -> Any:
        p, phase, one, two, flies = args
        F = (
            p[3]
            + (one * p[8] + two * p[9]) * p[10]
            + p[4] * jnp.cos(phase + p[5] * t)
            - p[2] * y[0]
            - p[1] * y[1]
        ) / p[0]
        return jnp.stack([y[1], flies * F])

    def piece(p, t, x, v, phase, duration, longest, one, two, flies, of_v, of_F, of_v1, of_v2):
        phase = phase + p[5] * t - jax.lax.stop_gradient(p[5] * t)

        def gap(t: Any, y: Any, args: Any, **_: Any) -> Any:
            F = rate(t, y, (p, phase, one, two, 1.0))[1]
            return of_v * y[1] + of_F * F + of_v1 * p[6] + of_v2 * p[7]

        control = diffrax.PIDController(rtol=tolerance, atol=1e-3 * tolerance, dtmax=longest)
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(rate), diffrax.Dopri8(), 0.0, duration, longest / 8, jnp.stack([x, v]),
            args=(p, phase, one, two, flies), stepsize_controller=control, saveat=diffrax.SaveAt(t1=True),
            event=diffrax.Event(gap, optimistix.Newton(1e-14, 1e-14), direction=False),
            adjoint=diffrax.ForwardMode(), max_steps=100_000, throw=False,
        )  # fmt: skip
        return jnp.stack([found.ts[0], found.ys[0, 0]]), found.event_mask

    return jax.jit(piece), jax.jit(jax.jacfwd(lambda *args: piece(*args)[0], argnums=(0, 1, 2, 3)))


def _settings(p: Parameters, mode: int, side: int) -> tuple[float, ...]:
    """Return the seven signs and weights by which `diffrax_pieces` knows a motion in `mode` that
    exits on `side`.
    """
    if mode > 3:
        return *friction_signs(mode - 3 if side < 0 else mode - 2), 0.0, 0.0, -float(side), 0.0, 0.0
    if side > 0:
        boundary = mode
    else:
        boundary = mode - 1
    return (
        *friction_signs(mode),
        1.0,
        -float(side),
        0.0,
        *(side * float(boundary == n) for n in (1, 2)),
    )


def differentiated_by_diffrax(scene: Scene, tolerance: float) -> Callable[[], list[FoundEvent]]:
    """Prepare diffrax, which finds the events.

    JAX differentiates each flight or stick, with the event at its end.
    """
    p = scene.parameters
    (piece, slopes) = diffrax_pieces(tolerance)
    t0 = float(scene.t0)
    numbers = np.array([*by_name(p, float).values()])
    q = problem(p, scene.t0)
    longest = q.period / STEPS_PER_PERIOD
    offset = ONE_STEP_OFFSET * max(abs(q.v1), abs(q.v2))

    def leave(
        q: Any, s: None, mode: int, t: float, x: float, v: float, t_end: float
    ) -> tuple[int, float, float]:
        best = 0, t_end, x
        for side in peers_scipy.SIDES[mode]:
            (tau, at), hit = piece(
                numbers, t, x, v, q.theta, best[1], longest, *_settings(p, mode, side)
            )
            if bool(hit) or best[0] == 0:
                best = (side if bool(hit) else 0), float(tau), float(at)
        return best

    follow = runner(scene, bind((event_logic,), {"leave": leave}), None, ONE_STEP_OFFSET)

    def run() -> list[FoundEvent]:
        # of t, x, v at the start of a piece
        found = []
        at = np.stack([ONE["t0"], ONE["x0"], ONE["v0"]])
        for event, mode, t, x, v, boundary, side, _ in pieces(scene, follow()):
            if boundary and mode < 4:  # off the belt, as in `follow`
                if mode > boundary:
                    v += offset
                else:
                    v += -offset
            theta = event_logic.from_now(q, t - t0).theta
            args = (
                numbers,
                t,
                x,
                v,
                theta,
                2 * (event.t - t) + longest,
                longest,
                *_settings(p, mode, side),
            )
            by_p, *by_start = map(np.asarray, slopes(*args))
            change = by_p @ np.eye(len(NAMES))[:11] + np.stack(by_start, axis=1) @ at
            dt = at[0] + change[0]
            dx = change[1]
            found.append(found_changes(event, dt, dx))
            if event.kind != "graze":
                at = np.stack([dt, dx, ONE[f"v{event.boundary}"]])
        return found

    return run


# -- all of them -----------------------------------------------------------------------------------


def compiled(scene: Scene, tolerance: float) -> Callable[[], list[FoundEvent]]:
    """Prepare symosc's compiled derivatives of events; those that do not exist are left out."""
    start = [scene.t0, scene.x0, scene.v0]
    known = scene.start_error

    def run() -> list[FoundEvent]:
        table = simulate_many(scene.parameters, start, scene.t_end, start_error=known, wrt=NAMES)
        dt, dx = (np.where(table.regular, each, np.nan) for each in (table.dt, table.dx))
        return [
            found_changes(event, *rows)
            for event, *rows in zip(events_of(table), dt, dx, strict=True)
        ]

    return run


def solvers() -> tuple[Solver, ...]:
    """Return all ways to differentiate events: those of symosc and of other tools."""
    heyoka = partial(by_flights, peers_heyoka.prepare, heyoka_jacobian)
    dop853 = partial(by_flights, peers_numba.prepare, dop853_jacobian)
    cvodes = partial(by_flights, partial(peers_scipy.prepare, "Adams"), cvodes_jacobian)
    flights = "derivatives of flights; what an event does to them is the user's"
    ours = "JAX goes through its events"
    return (
        Solver("symosc", compiled, (0.0,), needs="numba"),
        Solver("heyoka, variational", heyoka, (1e-16,), "heyoka", flights),
        Solver("numba DOP853, tangents", dop853, (1e-14,), "numba", flights),
        Solver(
            "casadi, CVODES",
            cvodes,
            (TOLERANCE,),
            "casadi",
            f"{flights}; events by scikit-sundae",
            "gradients",
        ),
        Solver(
            "diffrax, jacfwd", differentiated_by_diffrax, (TOLERANCE,), "diffrax", ours, "gradients"
        ),
        Solver(
            "scipy DOP853, differences",
            differences,
            (TOLERANCE,),
            note=f"relative step {DIFFERENCE:g}",
        ),
    )


def run(progress: Progress = iter, chosen: Sequence[ReferenceCase] | None = None) -> Record:
    """Judge the derivatives that each way to differentiate finds in the reference cases.

    Return plain data.
    """
    some = [case for case in (reference_cases() if chosen is None else chosen) if not case.periods]
    return cases.run(progress, solvers(), some, with_derivatives=True)


def table(scores: Sequence[Score]) -> str:
    """Return a Markdown table: how many derivatives of each group are right."""

    def total(found: Iterable[CaseScore], name: str) -> int:
        return sum(getattr(case, name) for case in found)

    def right(found: Sequence[CaseScore]) -> str:
        return f"{total(found, 'derivatives') - total(found, 'wrong_derivatives'):,}"

    rows = []
    for group, first in (*by_group(scores[0].cases), ("all", scores[0].cases)):
        if known := total(first, "known_derivatives"):
            of_group = (
                [case for case in each.cases if group in ("all", case.group)] for each in scores
            )
            rows.append([group, f"{known:,}", *map(right, of_group)])
    rows.append(
        ["wrong", "", *(f"{total(score.cases, 'wrong_derivatives'):,}" for score in scores)]
    )
    largest = [
        [case.error_d for case in score.cases if case.error_d is not None] for score in scores
    ]
    rows.append(
        [
            "largest error of a case: median",
            "",
            *(f"{median(each):.0e}" if each else "" for each in largest),
        ]
    )
    return tabulate(
        rows,
        ["group", "derivatives", *(each.name for each in scores)],
        "github",
        disable_numparse=True,
    )


def write(path: str | Path, result: Record, command: str) -> list[Path]:
    """Write a page of the scores of derivatives, which names `command` as its origin.

    Return its path in a list.
    """
    notes = "; ".join(f"{solver.name}: {solver.note}" for solver in solvers() if solver.note)
    more = [
        f"Made by `{command}`. Each way differentiates all events by all eleven parameters and "
        "by t0, x0, v0, with at "
        f"most {result['limit_s']:g} s of processor time for a case. {sentence(result['machine'])}",
        f"What is compared: {notes}.",
        *not_run(result),
        "How many derivatives are right. An error of dt is relative to max(1, |dt|), that of dx "
        "to max(1, |x|, |dt|, "
        "|dx|). It may be 1e-9, or 100 * condition^2 * 1e-16 where that is more. What is neither "
        "right nor wrong was "
        "not given.",
        table(result["scores"]),
    ]
    page = as_markdown(
        result["scores"], "Scores of derivatives", SET_VERSION, more, with_faults=False
    )
    return [write_text(path, page)]
