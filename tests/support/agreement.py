"""What it means that a trajectory of symosc agrees with the oracle, and the parameter sets that several tests share."""

from __future__ import annotations

from typing import Any

import mpmath
from oracle import OracleRun, exact, simulate_oracle

from symosc import Parameters, simulate

TOLERANCE = 1e-12

BASE = Parameters(
    m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3
)

NEAR = Parameters(
    m=1, c="0.3", k=1, A0="0.2", B0=3, Omega=1, v1="-0.5", v2="0.8", mu1="0.4", mu2="0.3", FN=2
)
# mapping: domain, belt, side of the belt that is beyond, and a time t_m = theta where a contact
# from there grazes
CONTACTS = {
    "P2": (1, 1, 1, "0.9"),
    "P3": (2, 1, -1, "4.1"),
    "P5": (2, 2, 1, "1.2"),
    "P6": (3, 2, -1, "4.6"),
}


def assert_event_agrees(event: Any, expected: Any, tolerance: float = TOLERANCE) -> None:
    """Kind, boundary, source and target are equal; t and x agree relative to max(1, |value|)."""
    assert (event.kind, event.boundary, event.source, event.target) == expected[1:5], (
        event,
        expected,
    )
    for name in ("t", "x", "v"):
        error = abs(mpmath.mpf(getattr(event, name)) - getattr(expected, name))
        assert error <= tolerance * max(1, abs(getattr(expected, name))), (
            name,
            float(error),
            event,
            expected,
        )


def assert_agrees(trajectory: Any, run: OracleRun, tolerance: float = TOLERANCE) -> None:
    """The same events in the same order, none missed and none invented."""
    with mpmath.workdps(60):
        for event, expected in zip(trajectory.events, run.events, strict=False):
            assert_event_agrees(event, expected, tolerance)
    assert len(trajectory.events) == len(run.events), (
        trajectory.status,
        list(trajectory.events)[-1:],
        run.events[-1:],
    )


def oracle_and_condition(
    p: Any, t0: Any, x0: Any, v0: Any, t_end: Any, dps: int = 50, push: float = 1e-10
) -> tuple[OracleRun, list[float], bool]:
    """Return the oracle's run, the condition of every event, and whether pushed starts have the same events.

    The condition is how far t or x of an event moves, per unit of a push of the start, relative to
    max(1, |value|). Where a push changes the events themselves the list ends: from there on the
    start does not determine them.
    """
    x0 = exact(x0)
    v0 = exact(v0)
    amount = exact(push)
    run = simulate_oracle(p, t0, x0, v0, t_end, dps)
    # on a belt the start stays there
    if v0 in (p.v1, p.v2):
        pushes = [(amount, 0)]
    else:
        pushes = [(amount, 0), (0, amount)]
    pushed = [simulate_oracle(p, t0, x0 + dx, v0 + dv, t_end, dps) for dx, dv in pushes]
    conditions: list[float] = []
    for i, event in enumerate(run.events):
        others = [other.events[i] if i < len(other.events) else None for other in pushed]
        if any(other is None or other[1:5] != event[1:5] for other in others):
            return run, conditions, False
        moved = max(
            abs(getattr(other, name) - getattr(event, name)) / max(1, abs(getattr(event, name)))
            for other in others
            for name in ("t", "x")
        )
        conditions.append(float(moved) / push)
    return run, conditions, all(len(other.events) == len(run.events) for other in pushed)


def oracle_of(p: Parameters, start: tuple[Any, Any, Any, Any], dps: int = 50) -> OracleRun:
    t0, x0, v0, t_end = start
    return simulate_oracle(p, t0, x0, v0, t_end, dps)


def simulated(p: Parameters, start: tuple[Any, Any, Any, Any]) -> Any:
    t0, x0, v0, t_end = start
    trajectory = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end)
    assert trajectory.status in ("t_end", "equilibrium")
    return trajectory
