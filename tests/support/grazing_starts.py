"""Grazing starts, judged by the oracle that knows only the ODE."""

from __future__ import annotations

from fractions import Fraction

from oracle import simulate_oracle

from symosc import Parameters, simulate
from symosc.grazing.start import GrazingStart

DOMAIN = {"P2": 1, "P3": 2, "P5": 2, "P6": 3}
BELT = {"P2": 1, "P3": 1, "P5": 2, "P6": 2}


def assert_oracle_grazes(p: Parameters, start: GrazingStart, dps: int = 45) -> None:
    """The oracle, from the start as printed, touches the belt at t_m and at no time before.

    Simulate says so too.
    """
    assert start.found, start.reason
    begin = start.start
    last = Fraction(str(start.t_m)) + Fraction(1, 1000)
    t0, x0, v0 = (Fraction(str(begin[name])) for name in ("t0", "x0", "v0"))
    # The start has 40 digits: a gap of the oracle below 1e-30 is a touch.
    run = simulate_oracle(p, t0, x0, v0, last, dps=dps - 10)
    first = run.events[0]
    boundary = BELT[start.mapping]
    domain = f"Omega{DOMAIN[start.mapping]}"
    assert (first.kind, first.boundary, first.source, first.target) == (
        "graze",
        boundary,
        domain,
        domain,
    ), run.events
    assert abs(float(first.t) - float(start.t_m)) < 1e-8 * max(1.0, abs(start.t_m))
    event = simulate(p, **begin, t_end=last).events[0]
    assert (event.kind, event.boundary, event.source) == ("graze", boundary, domain)
    assert abs(event.t - float(start.t_m)) < 1e-8 * max(1.0, abs(start.t_m))
