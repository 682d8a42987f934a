"""How many stops per cycle the mass on a wall makes, and where their number changes: by running and by equations."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import pi
from typing import Any, NamedTuple

import numpy as np

from symosc.derive.published import MP, as_function, wall
from symosc.errors import ParameterError, SymoscError
from symosc.model import Parameters
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution
from symosc.symbolic.solution import Omega, tau
from symosc.symbolic.theorem7 import rational

#: A border is bisected to this width, relative to F/P.
WIDTH = 1e-8
#: Cycles after which a motion is looked at, and what it may then still change by in a cycle.
SEEN_AFTER = 20
SETTLING, SETTLED_DIFFERENCE = (8, 30, 120, 480), 1e-12


@cache
def stops(parameters: Parameters) -> int | None:
    """Return how many stops the motion from rest at 0 has per cycle when it has settled; None: it does not settle."""
    turn = 2 * pi / float(parameters.Omega)
    for cycles in SETTLING:
        path = simulate(parameters, t0=0, x0=0, v0=0, t_end=Fraction((cycles + 2) * turn), accuracy=1e-6)
        before, after = path((cycles + 0.5) * turn), path((cycles + 1.5) * turn)
        if np.abs(after - before).max() < SETTLED_DIFFERENCE * (1 + np.abs(after).max()):
            onsets = [event.t / turn for event in path.events if event.kind == "stick"]
            return sum(cycles + 0.5 <= onset < cycles + 1.5 for onset in onsets)
    return None


def stops_in_cycle(parameters: Parameters, cycle: int) -> int:
    """Return how many stops begin in a cycle of the motion from rest at 0, settled or not."""
    turn = 2 * pi / float(parameters.Omega)
    path = simulate(parameters, t0=0, x0=0, v0=0, t_end=Fraction((cycle + 1) * turn), accuracy=1e-6)
    return sum(event.kind == "stick" and event.t >= cycle * turn for event in path.events)


class Border(NamedTuple):
    """Where the number of stops changes: F/P on its two sides, and the numbers there."""

    low: float
    high: float
    below: int
    above: int

    @property
    def middle(self) -> float:
        """F/P halfway between the sides."""
        return (self.low + self.high) / 2


def stops_at(ratio: Fraction, Omega: Any, c: Any = 0) -> int | None:
    """Return the number of stops per cycle at F/P = ratio: F = 1, and P is the forced amplitude."""
    return stops(wall(1, Omega, c, P=1 / ratio))


@cache
def find_border(low: Any, high: Any, Omega: Any, c: Any = 0) -> Border:
    """Bisect the forced amplitude between two values of F/P with different numbers of stops."""
    a, b = Fraction(low), Fraction(high)
    below, above = stops_at(a, Omega, c), stops_at(b, Omega, c)
    if below == above:
        raise ParameterError("low, high", (str(low), str(high)), "must have different numbers of stops")
    while b - a > WIDTH * a:
        middle = (a + b) / 2
        count = stops_at(middle, Omega, c)
        if count is None:
            raise SymoscError(f"the motion at F/P = {float(middle)!r} does not settle")
        if count == below:
            a = middle
        else:
            b, above = middle, count
    assert below is not None
    assert above is not None
    return Border(float(a), float(b), below, above)


# --- the same borders by equations ---


class Meeting(NamedTuple):
    """A border of two numbers of stops by equations: F/P, which event makes it, and in which slide of half a cycle."""

    ratio: Any
    kind: str
    slide: int


def meeting(Omega: Any, border: Border) -> Meeting:
    """Solve for the F/P near a border (c = 0) at which a stop, or a slide, is born.

    With P = k = 1 half a cycle is n slides down. Each starts where a stop ends, x = cos(theta) + F, and ends at rest,
    the last one at minus the first one's start: 2 n equations for n phases and n durations. The border is where

    - "touch": a slide comes to rest on the way without staying, v = x'' = 0: a stop of no length (with its time, two
      more equations for two more unknowns, the other one being F);
    - "birth": a stop lasts to theta = pi, where the drive just reaches what would move it, x = F - 1: a slide of no
      length.
    """
    few, count = min((border.low, border.below), (border.high, border.above), key=lambda side: side[1])
    p = wall(Fraction(few), Omega)
    slides, touches, births = _seen(p, count // 2)
    _, kind, j, at = min(touches + births)
    n = len(slides)
    x, v, a = _slide(p)

    def equations(*z: Any) -> list[Any]:
        F, phases, times = z[0], z[1 : n + 1], z[n + 1 : 2 * n + 1]
        starts = [MP.cos(phase) + F for phase in phases]
        ends = [*starts[1:], -starts[0]]
        rows = list(zip(starts, phases, times, ends, strict=True))
        found = [v(phase, time) for _, phase, time, _ in rows]
        found += [x(start, phase, time) - end for start, phase, time, end in rows]
        if kind == "birth":
            return [*found, ends[j] - F + 1]
        return [*found, v(phases[j], z[-1]), a(phases[j], z[-1])]

    guess = [few, *(phase for phase, _ in slides), *(time for _, time in slides)]
    return Meeting(MP.findroot(equations, guess + [at] * (kind == "touch"))[0], kind, j + 1)


def _slide(p: Parameters) -> tuple[Callable[..., Any], ...]:
    """Return x, v, x'' of a slide that starts at rest and without acceleration, of phase and time since then."""
    flow = solution.flow(solution.REGIMES["undamped"])
    at = {solution.v_i: 0, solution.a_i: 0, solution.omega_0: 1, solution.f0: 1, Omega: rational(p.Omega)}
    x, v, a = (expr.xreplace(at) for expr in flow)
    start, phase = solution.x_i, solution.theta_i
    return as_function(x, (start, phase, tau)), as_function(v, (phase, tau)), as_function(a, (phase, tau))


def _seen(p: Parameters, count: int) -> tuple[list[tuple[float, float]], list[Any], list[Any]]:
    """Return (phase, duration) of each slide down in half a settled cycle, its near touches, and the near births."""
    Omega, force = float(p.Omega), float(p.mu1)
    turn = 2 * pi / Omega
    path = simulate(p, t0=0, x0=0, v0=0, t_end=Fraction((SEEN_AFTER + 2) * turn), accuracy=1e-6)
    late = [event for event in path.events if event.t > SEEN_AFTER * turn]
    pairs = [(a, b) for a, b in pairwise(late) if a.kind == "slip"]
    first = next(
        i for i in range(1, len(pairs)) if pairs[i - 1][0].target == "Omega2" and pairs[i][0].target == "Omega1"
    )
    slides = pairs[first : first + count]
    births = [(abs(end.x - force + 1), "birth", j, 0.0) for j, (_, end) in enumerate(slides)]
    touches = []
    for j, (start, end) in enumerate(slides):
        times = np.linspace(start.t, end.t, 2001)[20:-20]
        speeds = path(times)[1]
        peaks = np.flatnonzero((speeds[1:-1] > speeds[:-2]) & (speeds[1:-1] >= speeds[2:])) + 1
        touches += [(-float(speeds[i]), "touch", j, float(times[i] - start.t)) for i in peaks]
    return [(Omega * start.t, end.t - start.t) for start, end in slides], touches, births
