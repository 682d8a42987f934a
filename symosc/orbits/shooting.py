"""Shooting: periodic orbits of any friction law, stable or not, with a drive or without.

A motion near an orbit chooses a section that it passes through in a flight
(`symosc.orbits.return_maps`). Newton's method with the exact derivatives of the return map, damped,
leads to the orbit. It is then followed over one period once more, by the law itself without the
section: only what closes there is an orbit.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, pi, sqrt

import numpy as np

from symosc.base.aliases import Number
from symosc.base.exact import read_digits
from symosc.model import Model
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.followed_orbit import FollowedOrbit, followed_orbit
from symosc.orbits.rests import rest_at
from symosc.orbits.return_maps import Closed, Shooting, SpeedSection, section_through
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

#: After how many forcing periods, or passages of a free motion, an orbit may close that is looked
#: for without saying so.
MOST_TRIED = 8
#: Motions that return nearer than this part of their size and period are tried first, the shortest
#: ones before others.
NEARLY_CLOSED = 0.1
#: So many of the others are tried, the nearest first.
MOST_FAR = 2
#: Two passages of one orbit differ by more than this part of its size, unless it is a shorter orbit
#: that is run through several times.
SAME_ORBIT = 1e-8


def orbit_near(
    model: Model,
    t: Number,
    x: Number,
    v: Number,
    periods: int | None = None,
    digits: int | None = None,
) -> FollowedOrbit:
    """Return the periodic orbit that Newton's method finds from a state near it, or the rest there.

    Parameters
    ----------
    model : Parameters or Oscillator
    t, x, v : number
        A state near the orbit.
    periods : int, optional
        After how many forcing periods the orbit closes. None: after at most MOST_TRIED, the best
        first. Without a drive: after how many passages through the section.
    digits : int, optional

    Returns
    -------
    FollowedOrbit
        One that runs several times through a shorter orbit is returned as that.

    Raises
    ------
    ConvergenceError
        If no orbit is found.
    """
    digits = read_digits(digits)
    t = _early(model, float(t))
    rest = rest_at(model, t, x, v, digits)
    if rest is not None:
        return rest
    run = simulate(
        model, t0=t, x0=x, v0=v, t_end=float(t) + search_span(model, periods), accuracy=inf
    )
    section = section_through(run, _first_loop(model))
    if section is None:
        raise ConvergenceError("", (), periods or 1, inf, "the motion from the state never flies")
    reason = "the motion from the state does not come back near to where it was"
    for shooting, first, span in _returns(section, run, periods):
        closed = shooting.solve(*first, span)
        if closed is None:
            reason = "Newton's method finds no orbit near the motion from the state"
            continue
        shooting, closed = _shortest(shooting, closed)
        if digits is not None:
            closed = shooting.polish(closed, digits)
            if closed is None:
                reason = f"it is not found to {digits} digits"
                continue
        orbit = followed_orbit(
            section, closed.t, closed.x, closed.span, shooting.periods, closed.changes,
            closed.residual, closed.steps, digits,
        )  # fmt: skip
        if orbit is not None:
            return orbit
        reason = "the motion that Newton's method finds does not close"
    raise ConvergenceError("", (), periods or 1, inf, reason)


def search_span(model: Model, periods: int | None = None) -> float:
    """Return a time in which a motion should come back: `periods` forcing periods, or some turns of
    a free motion.
    """
    if model.B0 != 0:
        return 2 * pi / float(model.Omega) * (periods or MOST_TRIED)
    return (periods or MOST_TRIED) * free_period(model)


def free_period(model: Model) -> float:
    """Return a time that a turn of a motion without a drive hardly exceeds, with its sticks."""
    turn = 2 * pi * sqrt(model.m / model.k)
    speeds = [abs(float(belt.v)) for belt in model.law.belts]
    held = [
        2 * float(model.law.kinetic(n) + model.law.excess(n)) / (float(model.k) * speed)
        for n, speed in enumerate(speeds, 1)
        if speed
    ]
    return 2 * turn + max(held, default=0.0)


def _early(model: Model, t: float) -> float:
    """Return the time in the first forcing period that has the phase of t, so that times are exact;
    0 without a drive.
    """
    if model.B0 == 0:
        return 0.0
    return t % (2 * pi / float(model.Omega))


def _first_loop(model: Model) -> float:
    """Return a time in which an orbit passes through every speed that it ever has, if it closes
    after the shortest time.
    """
    if model.B0 != 0:
        return 2 * pi / float(model.Omega)
    return free_period(model)


def _returns(
    section: SpeedSection, run: Trajectory, periods: int | None
) -> Iterator[tuple[Shooting, tuple[float, float], float]]:
    """Yield the equations of an orbit near a motion, its first passage, and the time after which it
    returns: what nearly closes after the shortest time first.
    """
    model = section.law
    piece = run._pieces[:, 0]
    x0, v0 = float(piece[3]), float(piece[4])
    begin = float(run.t_start)
    motion = section.motion(begin, x0, v0, 1.2 * (float(run.t_end) - begin))
    passages = [
        (float(motion.events[n].t), float(motion.events[n].x)) for n in section.passages(motion)
    ]
    if not passages:
        return
    first = passages[0]
    times = np.linspace(begin, float(run.t_end), 257)
    size = float(np.ptp(run(times)[0])) or 1.0
    found = list[tuple[bool, float, int, float]]()
    if model.B0 != 0:
        turn = 2 * pi / float(model.Omega)
        for count in [periods] if periods else range(1, MOST_TRIED + 1):
            expected = first[0] + count * turn
            t, x = min(passages, key=lambda passage: abs(passage[0] - expected))
            miss = abs(t - expected) / turn * 2 * pi + abs(x - first[1]) / size
            found.append((miss > NEARLY_CLOSED, miss, count, count * turn))
    else:
        turn = 0.0
        for count, (t, x) in enumerate(passages[1 : MOST_TRIED + 1], 1):
            if periods in (None, count):
                miss = abs(x - first[1]) / size
                found.append((miss > NEARLY_CLOSED, miss, count, t - first[0]))
    nearly = sorted((item for item in found if not item[0]), key=lambda item: item[2])
    others = sorted(item for item in found if item[0])
    for _, _, count, span in [*nearly, *others[:MOST_FAR]]:
        pace = (turn or span) / (2 * pi)
        yield Shooting(section, count if turn else 0, size, pace), first, span


def _shortest(shooting: Shooting, closed: Closed) -> tuple[Shooting, Closed]:
    """Return an orbit that does not run several times through a shorter one."""
    section = shooting.section
    motion = section.motion(closed.t, closed.x, section.speed, 1.02 * closed.span)
    passages = [motion.events[n] for n in section.passages(motion)]
    if shooting.periods:
        counts = [n for n in range(1, shooting.periods) if shooting.periods % n == 0]
        spans = [closed.span * n / shooting.periods for n in counts]
    else:
        counts = [0] * len(passages)
        spans = [event.t - closed.t for event in passages]
    for count, span in zip(counts, spans, strict=True):
        if span > 0.9 * closed.span:
            break
        event = min(passages, key=lambda event: abs(event.t - closed.t - span))
        residual = event.t - closed.t - span, event.x - closed.x
        if shooting.measured(residual) < SAME_ORBIT:
            shorter = Shooting(section, count, shooting.size, shooting.pace)
            again = shorter.solve(closed.t, closed.x, span)
            if again is not None:
                return shorter, again
    return shooting, closed
