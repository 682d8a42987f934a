"""Proposed enclosures of periodic orbits of any friction law, for the checker to prove.

As in `symosc.certificates.propose_orbits` nothing is proven here. The orbit is found again in many
digits, and followed over one period with the corners that it passes. How far apart motions from a
box get is seen from two neighbours at the edges of the box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Number, Record
from symosc.base.errors import ParameterError
from symosc.certificates.certificate import Certificate, confirmed, law_entry, made_by
from symosc.certificates.corners import Step, corner_speed, steps_of
from symosc.certificates.propose import (
    DIGITS,
    NothingProposed,
    around,
    fraction,
    one_digit,
    outward,
)
from symosc.certificates.propose_orbits import (
    BOXES,
    LEAST_REACH,
    ORBIT_DIGITS,
    SPARE,
    proposed_multipliers,
    proposed_stability,
)
from symosc.engine.arithmetic import mp_context
from symosc.engine.start import Start
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit
from symosc.orbits.followed_orbit import FollowedOrbit
from symosc.simulation.simulate import simulate
from symosc.words import Word

#: What a motion over one period is followed for beyond it, and how late the last event may be, as
#: parts of the period.
BEYOND = Fraction(1, 1000)
CLOSED = Fraction(1, 10**20)
EVENT = ("kind", "boundary", "source", "target")
#: Samples of an orbit that tell whether it stays in one band: the checker proves it.
SAMPLES = 2000


class LoopInDigits(NamedTuple):
    """An orbit in many digits, from the end of a flight at a belt: the steps of one period, of which
    the last one is the end of this flight again, and the period.
    """

    orbit: FollowedOrbit
    t: Number
    x: Number
    v: Fraction
    steps: Sequence[Step]
    period: Fraction


def certify_law_orbit(orbit: FollowedOrbit) -> Certificate:
    """Propose an orbit of any law, and let the checker prove it.

    Return its certificate.
    """
    if orbit.is_rest:
        raise ParameterError("what", orbit, "is a rest; certify a motion that comes to rest")
    reason = ""
    refused = None
    if _stays_in_band(orbit):
        return _proposed_steady(orbit, ORBIT_DIGITS[0])
    for digits in ORBIT_DIGITS:
        try:
            loop = _loop(orbit, digits)
        except (ConvergenceError, NothingProposed, ParameterError) as undecided:
            reason = f"not decided: {undecided}"
            continue
        for share in BOXES:
            certificate = _proposed(loop, share, digits)
            if certificate is None:
                continue
            if certificate.proven:
                return certificate
            refused = refused or certificate
        break
    name = orbit.word or "without a belt"
    message = f"the orbit {name}: {refused.message if refused else reason}"
    if refused is None:
        return Certificate("orbit", False, message)
    return replace(refused, message=message)


def _stays_in_band(orbit: FollowedOrbit) -> bool:
    """Return whether an orbit meets neither a belt nor a corner."""
    if orbit.points:
        return False
    assert orbit.motion is not None
    speeds = [float(edge.v) for edge in orbit.parameters.law.edges]
    begin = float(orbit.motion.t_start)
    _, v = orbit.motion(np.linspace(begin, float(orbit.motion.t_end), SAMPLES))
    return len(set(np.searchsorted(speeds, v).tolist())) == 1


def _proposed_steady(orbit: FollowedOrbit, digits: int) -> Certificate:
    """Return the certificate of the steady motion of the band around v = 0."""
    if not orbit.periods:
        message = "the orbit without a belt: not decided: circles in a band, of which none is alone"
        return Certificate("orbit", False, message)
    p = orbit.parameters
    context = mp_context(digits)
    below = max((edge.v for edge in p.law.edges if edge.v < 0), default=None)
    above = min((edge.v for edge in p.law.edges if edge.v > 0), default=None)
    slope, _ = p.law.line_between(below, above)
    decay, stiffness, Omega = (
        context.mpf(value.numerator) / value.denominator
        for value in ((p.c + slope) / (2 * p.m), p.k / p.m, p.Omega)
    )
    root = context.sqrt(decay**2 - stiffness)
    turn = 2 * context.pi / Omega
    first, second = (context.exp((sign * root - decay) * turn) for sign in (1, -1))
    if first.imag < 0:
        first, second = second, first
    statement = made_by(digits) | {
        "parameters": law_entry(p),
        "word": "",
        "periods": orbit.periods,
        "events": [],
        "alone_within": ["0", "0"],
        "multipliers": proposed_multipliers((first, second)),
        "stable": proposed_stability((first, second)),
    }
    return confirmed("orbit", statement)


def _loop(orbit: FollowedOrbit, digits: int) -> LoopInDigits:
    """Return an orbit in so many digits, or raise NothingProposed."""
    periods = orbit.periods or None
    exact = find_orbit(orbit.parameters, guess=orbit.start, digits=digits, periods=periods)
    if not isinstance(exact, FollowedOrbit) or exact.labels != orbit.labels:
        raise NothingProposed(f"the orbit with {digits} digits has the word {exact.word}")
    loop = _beginning(exact, digits)
    t = loop.t
    x = loop.x
    period = loop.period
    steps = _steps(loop, fraction(t), fraction(x), digits)
    if any(step.kind == "graze" for step in steps):
        raise NothingProposed("an orbit that touches a belt")
    # The last event is the first one again, a period later.
    late = [abs(fraction(step.t) - fraction(t) - period) for step in steps]
    last = min(range(len(steps)), key=late.__getitem__, default=0)
    if not steps or late[last] > CLOSED * period:
        raise NothingProposed("an orbit whose motion does not close")
    return loop._replace(steps=steps[: last + 1])


def _beginning(orbit: FollowedOrbit, digits: int) -> LoopInDigits:
    """Return an orbit from the end of a flight at a belt or, if it meets none, from a corner."""
    period = fraction(orbit.period)
    p = orbit.parameters
    if orbit.points:
        maps = Word(orbit.labels).maps
        place = next(i for i in range(len(maps)) if not maps[i - 1].sticks)
        t, x = orbit.points[place]
        return LoopInDigits(orbit, t, x, p.belt(maps[place].start.boundary), (), period)
    t, x, v = map(fraction, orbit.start)
    loop = LoopInDigits(orbit, t, x, v, (), period)
    corner = _steps(loop, t, x, digits)[0]
    return loop._replace(t=corner.t, x=corner.x, v=corner_speed(p.law, corner.boundary))


def _steps(loop: LoopInDigits, t: Fraction, x: Fraction, digits: int) -> Sequence[Step]:
    """Return the steps of a motion that starts at t and x as the orbit does, for a period."""
    p = loop.orbit.parameters
    t_end = t + loop.period * (1 + BEYOND)
    run = simulate(p, t0=t, x0=x, v0=loop.v, t_end=t_end, digits=digits)
    return steps_of(run, Start(p, t, x, loop.v, t_end))


def _proposed(loop: LoopInDigits, share: float, digits: int) -> Certificate | None:
    """Return the certificate of an orbit that is to be alone in a box, a `share` of the period and
    of the largest position; None if motions from the box have other events.
    """
    orbit = loop.orbit
    p = orbit.parameters
    largest = 1 + max(abs(fraction(step.x)) for step in loop.steps)
    half_x = one_digit(Fraction(share) * largest)
    half_t = one_digit(Fraction(share) * loop.period) if orbit.periods else "0"
    reaches = _reaches(loop, Fraction(half_t), Fraction(half_x), digits)
    if reaches is None:
        return None
    last = loop.steps[-1]
    rows: list[Record] = []
    places = [(loop.t, loop.x), *((step.t, step.x) for step in loop.steps)]
    for step, (t, x), reach in zip([last, *loop.steps], places, reaches, strict=True):
        row: Record = {name: getattr(step, name) for name in EVENT}
        row |= {"t": outward(around(t, 0), DIGITS), "x": outward(around(x, 0), DIGITS)}
        rows.append(row | {"reach": one_digit(max(reach, LEAST_REACH))})
    statement = made_by(digits) | {
        "parameters": law_entry(p),
        "word": str(Word(orbit.labels).cycle),
        "periods": orbit.periods,
        "events": rows,
        "alone_within": [half_t, half_x],
        "multipliers": proposed_multipliers(orbit.multipliers),
        "stable": _stable(orbit),
    }
    points = tuple(
        (tuple(outward(around(t, 0), DIGITS)), tuple(outward(around(x, 0), DIGITS)))
        for t, x in orbit.points
    )
    return confirmed("orbit", statement, points)


def _stable(orbit: FollowedOrbit) -> bool | None:
    """Return whether an orbit is stable; without a drive its multiplier 1, of the phase, does not
    count.
    """
    if orbit.periods:
        return proposed_stability(orbit.multipliers)
    first, second = orbit.multipliers
    other = second if first == 1 else first
    return proposed_stability((other, other))


def _reaches(
    loop: LoopInDigits, half_t: Fraction, half_x: Fraction, digits: int
) -> list[Fraction] | None:
    """Return how far apart in time motions from a box meet each step: a hint for the checker, whose
    balls are wider than the set. None if they have other steps.
    """
    t = fraction(loop.t)
    x = fraction(loop.x)
    reaches = [2 * half_t, *(Fraction(0) for _ in loop.steps)]
    for later, further in ((half_t, 0), (0, half_x)):
        if not (later or further):
            continue
        steps = _steps(loop, t + later, x + further, digits)[: len(loop.steps)]
        if [step.kind for step in steps] != [step.kind for step in loop.steps]:
            return None
        for i, (step, own) in enumerate(zip(steps, loop.steps, strict=True), 1):
            reaches[i] += SPARE * abs(fraction(step.t) - fraction(own.t))
    return reaches
