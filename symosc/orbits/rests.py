"""Rests of an oscillator under any friction law, and whether deviations from them grow."""

from __future__ import annotations

import cmath
from fractions import Fraction
from itertools import pairwise
from math import inf, pi
from typing import Any, NamedTuple

from symosc.base.aliases import Number
from symosc.engine.arithmetic import mp_context
from symosc.model import Model
from symosc.orbits.floquet import NEAR_ONE
from symosc.orbits.followed_orbit import FollowedOrbit
from symosc.simulation.trajectory import Trajectory

#: A state within this part of the positions and speeds of a law is one of its rest.
AT_REST = 1e-9


class Rests(NamedTuple):
    """Where the mass may rest: from the lowest to the highest x, on a belt (0: on none).

    `dampings` are those in the bands at the speed 0: one, or two at a corner.
    """

    low: Fraction
    high: Fraction
    belt: int
    dampings: tuple[Fraction, ...]


def rests_of(model: Model) -> Rests | None:
    """Return where the mass may rest for ever, whatever the drive does; None if nowhere."""
    law = model.law
    if model.k == 0:
        return None
    belt = law.boundary_of(0)
    sides = []
    for below, above in pairwise([None, *(edge.v for edge in law.edges), None]):
        if (below is None or below <= 0) and (above is None or above >= 0):
            slope, force = law.line_between(below, above)
            sides.append((model.c + slope, (model.A0 + force) / model.k))
    dampings = tuple(damping for damping, _ in sides)
    if not belt:
        if model.B0 != 0:
            return None
        _, x = sides[0]
        return Rests(x, x, 0, dampings)
    excess = law.excess(belt) / model.k
    drive = abs(model.B0) / model.k
    (_, below), (_, above) = sides
    low = above - excess + drive
    high = below + excess - drive
    if low > high:
        return None
    return Rests(low, high, belt, dampings)


def rest_at(
    model: Model, t: Number, x: Number, v: Number, digits: int | None = None
) -> FollowedOrbit | None:
    """Return the rest at a state, None if the mass does not stay there.

    Without a drive a state within rounding of the one position of rest is taken for it.
    """
    rests = rests_of(model)
    if rests is None:
        return None
    size = max(abs(float(rests.low)), abs(float(rests.high)), abs(float(x)), 1e-300)
    if rests.belt:
        position = Fraction(float(x))
        rounded = AT_REST * Fraction(size)
        if float(v) != 0.0 or not rests.low - rounded <= position <= rests.high + rounded:
            return None
        return _rest(model, rests, t, x, digits)
    speed = size * float(model.k / model.m) ** 0.5
    if abs(float(x) - float(rests.low)) > AT_REST * size or abs(float(v)) > AT_REST * speed:
        return None
    return _rest(model, rests, t, rests.low, digits)


def rest_reached(motion: Trajectory, digits: int | None = None) -> FollowedOrbit | None:
    """Return the rest in which a motion ends, None if it does not end in one."""
    model = motion.parameters
    rests = rests_of(model)
    if rests is None or motion.status != "equilibrium":
        return None
    t = motion.t_end
    if not rests.belt:
        return _rest(model, rests, t, rests.low, digits)
    piece = motion._pieces[:, -1].tolist()
    _, _, _, x, v, *_ = piece
    if v != 0.0:
        return None
    if digits is not None and motion.events:
        x = motion.events[-1].x
    return rest_at(model, t, x, v, digits)


def _rest(
    model: Model, rests: Rests, t: Number, x: Number | Fraction, digits: int | None
) -> FollowedOrbit:
    """Return the orbit that is a rest at a position."""
    if digits is None:
        position: Number = float(x)
    else:
        context = mp_context(digits)
        if isinstance(x, Fraction):
            position = context.mpf(x.numerator) / x.denominator
        else:
            position = +context.convert(x)
    if model.B0 == 0:
        period: Number = 0 * position
    elif digits is None:
        period = 2 * pi / float(model.Omega)
    else:
        period = 2 * mp_context(digits).pi * model.Omega.denominator / model.Omega.numerator
    values, stable, message = _deviations(model, rests)
    return FollowedOrbit(
        parameters=model,
        word="",
        labels=(),
        points=(),
        period=period,
        periods=int(model.B0 != 0),
        multipliers=values,
        stable=stable,
        residual=0.0,
        admissible=True,
        failures=(),
        grazing_distance=inf,
        message=message,
        steps=0,
        digits=digits,
        start=(0.0, position, 0.0),
    )


def _deviations(model: Model, rests: Rests) -> tuple[tuple[Any, Any], bool | None, str]:
    """Return the multipliers of a rest, whether it is stable, and its message."""
    if rests.belt:
        low = float(rests.low)
        high = float(rests.high)
        message = f"a rest on belt {rests.belt}, one of every x from {low:.6g} to {high:.6g}"
        return (1.0 + 0j, 0j), None, message
    rates = [roots_of(model, damping) for damping in rests.dampings]
    where = f"a rest at x = {float(rests.low):.6g}"
    if len(rates) == 1:
        pair = rates[0]
    else:
        pair = _rates_at_corner(*rates)
        where += " on a corner of the friction curve"
    values = tuple(_power(rate) for rate in pair)
    growth = max(rate.real for rate in pair)
    stable = None if abs(growth) <= NEAR_ONE else growth < 0
    kind = {True: "stable", False: "unstable", None: "marginal"}[stable]
    message = f"{where}, {kind}: deviations change like exp({growth:.6g} t)"
    return (values[0], values[1]), stable, message


def roots_of(model: Model, damping: Fraction) -> tuple[complex, complex]:
    """Return the rates l of deviations exp(l t) in a band, the one of faster growth first."""
    half = float(damping) / (2 * float(model.m))
    root = cmath.sqrt(float(damping**2 - 4 * model.m * model.k) / (4 * float(model.m) ** 2))
    return -half + root, -half - root


def _rates_at_corner(
    below: tuple[complex, complex], above: tuple[complex, complex]
) -> tuple[complex, complex]:
    """Return the rates of deviations from a rest on a corner, between the bands below and above.

    Where both oscillate a deviation takes half a turn in each. In a band without oscillation it
    approaches the rest, or leaves it, without coming back: there the greater rate decides.
    """
    if all(pair[0].imag for pair in (below, above)):
        turn = pi / below[0].imag + pi / above[0].imag
        growth = (below[0].real * pi / below[0].imag + above[0].real * pi / above[0].imag) / turn
        rate = complex(growth, 2 * pi / turn)
        return rate, rate.conjugate()
    straight = [pair for pair in (below, above) if not pair[0].imag]
    return max(straight, key=lambda pair: pair[0].real)


def _power(rate: complex) -> complex:
    """Return exp(rate), the factor in a unit of time."""
    context = mp_context(25)
    return complex(context.exp(context.mpc(rate)))
