"""Ground truth for the theorems: the flow of eq. (5) near a contact, in rational numbers.

Parameters, place and the sine and cosine of the phase are all rational, so whether a force vanishes is decided exactly,
and so is on which side of the belt's speed the flow of a domain is a short time before and after. Nothing here uses the
package's kernels, G-functions or rules of switching: the motion comes from the power series of (5) itself.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import factorial

from symosc.model import NEIGHBOURS, Parameters

#: Time before and after a contact, and the terms of the power series. The first term that does not vanish has order 4
#: at most here, and numbers of few digits: it is many orders of magnitude larger than all that is left out.
SHORT = Fraction(1, 10**8)
SUM_TERMS = 6

#: Sines and cosines of phases: the quarters of the circle, and rational points between them.
QUARTER_POINTS = ((0, 1), (1, 0), (0, -1), (-1, 0))
TRIPLES = ((3, 4, 5), (5, 12, 13))
RATIONAL_PHASES = tuple((Fraction(s), Fraction(c)) for s, c in QUARTER_POINTS) + tuple(
    (Fraction(a * x, hyp), Fraction(b * y, hyp))
    for leg, other, hyp in TRIPLES
    for x, y in ((leg, other), (other, leg))
    for a in (1, -1)
    for b in (1, -1)
)


def sign(number: Fraction) -> int:
    """Return -1, 0 or 1."""
    return (number > 0) - (number < 0)


def velocity_series(
    p: Parameters, constant: Fraction, x: Fraction, v: Fraction, s: Fraction, c: Fraction
) -> list[Fraction]:
    """Return the Taylor coefficients of x'(tau) for m x'' + c x' + k x = constant + B0 cos(theta + Omega tau).

    Parameters
    ----------
    p : Parameters
    constant : Fraction
        A0 and the friction force of the domain.
    x, v : Fraction
        State at the contact.
    s, c : Fraction
        Sine and cosine of the phase theta there.

    Returns
    -------
    list of Fraction
        SUM_TERMS coefficients, the first one is v.
    """
    place = [x, v]
    wave, turned = c, -s  # cos(theta) and its derivative by theta
    scale = Fraction(1)  # Omega^n/n!
    for n in range(SUM_TERMS - 1):
        drive = p.B0 * wave * scale + (constant if n == 0 else 0)
        place.append((drive - p.c * (n + 1) * place[n + 1] - p.k * place[n]) / (p.m * (n + 1) * (n + 2)))
        wave, turned = turned, -wave
        scale = scale * p.Omega / (n + 1)
    return [(n + 1) * place[n + 1] for n in range(SUM_TERMS)]


@dataclass(frozen=True)
class RationalContact:
    """A point of a boundary: x' is the speed of the belt.

    Attributes
    ----------
    p : Parameters
    boundary : int
    x : Fraction
    s, c : Fraction
        Sine and cosine of the phase.
    """

    p: Parameters
    boundary: int
    x: Fraction
    s: Fraction
    c: Fraction

    @property
    def speed(self) -> Fraction:
        """Speed of the belt."""
        return self.p.belt(self.boundary)

    def force(self, alpha: int) -> Fraction:
        """Return F^(alpha) by Newton's law with Coulomb's friction of both belts."""
        p = self.p
        return (p.A0 + friction_on_mass(p, alpha) + p.B0 * self.c - p.k * self.x - p.c * self.speed) / p.m

    def slope(self, alpha: int) -> Fraction:
        """Return G^(1,alpha) = dF^(alpha)/dt along the flow of the domain."""
        p = self.p
        return -(p.c * self.force(alpha) + p.k * self.speed + p.B0 * p.Omega * self.s) / p.m

    def side(self, alpha: int, after: bool) -> int:
        """Return the sign of x' - v_lambda a short time before or after, along the flow of domain `alpha`."""
        t, slope = (SHORT if after else -SHORT), Fraction(0)
        for coefficient in reversed(self._series(alpha)[1:]):
            slope = slope * t + coefficient
        return sign(slope * t)

    def derivatives(self, alpha: int) -> tuple[Fraction, ...]:
        """Return the first four derivatives of x' along the flow of domain `alpha`, from its power series."""
        return tuple(factorial(n) * a for n, a in enumerate(self._series(alpha)[:5]) if n)

    @cached_property
    def _known(self) -> dict[int, list[Fraction]]:
        return {}

    def _series(self, alpha: int) -> list[Fraction]:
        if alpha not in self._known:
            constant = self.p.A0 + friction_on_mass(self.p, alpha)
            self._known[alpha] = velocity_series(self.p, constant, self.x, self.speed, self.s, self.c)
        return self._known[alpha]

    @property
    def next_mode(self) -> str:
        """Where the motion goes on, in the words of `Trajectory.mode`."""
        lo, hi = NEIGHBOURS[self.boundary]
        if self.side(hi, after=True) > 0:
            return f"Omega{hi}"
        return f"Omega{lo}" if self.side(lo, after=True) < 0 else f"belt{self.boundary}"

    @property
    def sticks(self) -> bool:
        """Whether neither domain's flow leads away from the belt."""
        return self.next_mode.startswith("belt")

    @property
    def passes(self) -> bool:
        """Whether the flow arrives from one domain and leaves into the other."""
        lo, hi = NEIGHBOURS[self.boundary]
        up = self.side(lo, after=False) < 0 < self.side(hi, after=True)
        return up or self.side(lo, after=True) < 0 < self.side(hi, after=False)

    def grazes(self, alpha: int) -> bool:
        """Whether the flow of a domain is in that domain both before and after."""
        own = -1 if alpha == self.boundary else 1
        return self.side(alpha, after=False) == self.side(alpha, after=True) == own


def friction_on_mass(p: Parameters, alpha: int) -> Fraction:
    """Return the sum of mu FN sgn(v_belt - x') over both belts, for x' inside domain `alpha`."""
    drags = (1, 1) if alpha == 1 else (-1, 1) if alpha == 2 else (-1, -1)
    return (drags[0] * p.mu1 + drags[1] * p.mu2) * p.FN


def contacts(boundary: int, count: int, seed: int = 0) -> Iterator[RationalContact]:
    """Yield contacts at random rational parameters, in turn of six kinds.

    Two are generic; two have the force below or above exactly 0; and two have the phase such that G^(1) = 0 as well
    (at the top and the bottom of the sine then G^(2) = 0 too). A fifth of them is at phase 0.
    """
    draw = random.Random(seed)

    def positive(top: int = 12) -> Fraction:
        return Fraction(draw.randint(1, top), draw.randint(1, 4))

    lo, hi = NEIGHBOURS[boundary]
    for number in range(count):
        kind = max(number % 6 - 1, 0)
        v1 = Fraction(draw.randint(-8, 8), draw.randint(1, 4))
        frictions = positive(4), positive(4)
        values = {name: positive() for name in ("m", "k", "B0", "Omega", "FN")}
        p = Parameters(
            **values, c=positive() - Fraction(1, 4), A0=draw.randint(-20, 20), v1=v1, v2=v1 + positive(),
            mu1=frictions[0], mu2=frictions[1],
        )  # fmt: skip
        s, c = draw.choice(RATIONAL_PHASES) if draw.random() > 0.2 else RATIONAL_PHASES[0]
        if kind >= 3:  # G^(1) = 0 where F = 0: k v = -B0 Omega sin
            v = -p.B0 * p.Omega * s / p.k
            p = p.replace(v1=v, v2=v + 1) if boundary == 1 else p.replace(v1=v - 1, v2=v)
        origin = RationalContact(p, boundary, Fraction(0), s, c)
        held = origin.force(hi if kind % 2 else lo)
        if kind == 0:  # anywhere from far below the two forces' zeros to far above them
            held -= (origin.force(lo) - origin.force(hi)) * Fraction(draw.randint(-5, 10), 5)
        yield RationalContact(p, boundary, p.m * held / p.k, s, c)


def as_text(contact: RationalContact) -> str:
    """Return a contact with its parameters as text that reads back exactly."""
    values = ", ".join(f"{name} = {value}" for name, value in contact.p.as_dict().items())
    return f"{values}; x = {contact.x}, sin = {contact.s}, cos = {contact.c}"
