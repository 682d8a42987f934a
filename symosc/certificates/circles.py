"""Exact touches: with c = 0 and B0 = 0 a velocity goes round a circle, whose size is rational or not known.

In a domain v'' = -w^2 v, w^2 = k/m, so v = v0 cos(w tau) + (a0/w) sin(w tau) = R cos(w tau - angle) with
R^2 = v0^2 + a0^2/w^2. If v0 and a0 are rational, so is R^2. The velocity touches a belt if and only if R^2 = v_belt^2,
which is decided in rational numbers: then it turns there, F = 0 and x = A/k. Nothing is decided by balls but when it
is. Rational are v0 and a0 of an exact start, of the end of a stick (v0 = v_belt, a0 = F = 0) and of a touch (the same).
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import arb

from symosc.certificates.balls import Ball, ball
from symosc.certificates.contact import Wall
from symosc.model import Parameters


class Circle(NamedTuple):
    """The exact velocity and acceleration at the start of a flight."""

    v: Fraction
    a: Fraction


class ExactTouch(NamedTuple):
    """A wall that a flight touches, and the time after its start."""

    wall: Wall
    tau: Ball


def goes_round(p: Parameters) -> bool:
    """Return whether velocities go round circles."""
    return p.c == 0 and p.B0 == 0 and p.k > 0


def circle_of_start(p: Parameters, domain: int, x: Fraction, v: Fraction) -> Circle:
    """Return the circle of an exact start."""
    return Circle(v, (p.A(domain) - p.k * x) / p.m)


def exact_touches(p: Parameters, circle: Circle, walls: list[Wall]) -> list[ExactTouch]:
    """Return the walls that a flight touches, and when first after its start; there it neither passes nor sticks."""
    size, found = circle.v**2 + circle.a**2 * p.m / p.k, []
    for wall in walls:
        speed = p.belt(wall.boundary)
        if speed == 0 or speed**2 != size:
            continue
        w = (ball(p.k) / ball(p.m)).sqrt()
        if circle.a == 0:
            turn = 2 * arb.pi() if circle.v == speed else arb.pi()
        else:  # the angle from the start's direction (v0, a0/w) to that of the belt, the way the motion goes
            side = 1 if speed > 0 else -1
            turn = arb.atan2(side * ball(circle.a) / w, side * ball(circle.v))
            turn = turn if circle.a * side > 0 else turn + 2 * arb.pi()
        found.append(ExactTouch(wall, turn / w))
    return found
