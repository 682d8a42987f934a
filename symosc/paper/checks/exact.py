"""Ground truth independent of the engine: rational contacts, a second closed form of the flow, and
DOP853.
"""

from __future__ import annotations

import cmath
import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from math import factorial
from operator import mul
from typing import Any

import numpy as np

from symosc.friction import NEIGHBOURS
from symosc.model import Parameters

# Parameters, place and the sine and cosine of the phase are all rational, so whether a force
# vanishes is decided exactly, and so is on which side of the belt's speed the flow of a domain is a
# short time before and after.

#: Time before and after a contact, and the terms of the power series. The first term that does not
#: vanish has order 4 at most here, and numbers of few digits: it is many orders of magnitude larger
#: than all that is left out.
SHORT = Fraction(1, 10**8)
SERIES_TERMS = 6
#: t^n / n! for the times before (False) and after (True) a contact.
POWERS = {
    after: tuple(t**n / factorial(n) for n in range(1, SERIES_TERMS))
    for after, t in ((False, -SHORT), (True, SHORT))
}
#: Sines and cosines of phases: the quarters of the circle, and rational points between them.
QUARTER_POINTS = ((0, 1), (1, 0), (0, -1), (-1, 0))
RATIONAL_PHASES = tuple((Fraction(s), Fraction(c)) for s, c in QUARTER_POINTS) + tuple(
    (Fraction(sign_s * s, hypotenuse), Fraction(sign_c * c, hypotenuse))
    for short, long, hypotenuse in ((3, 4, 5), (5, 12, 13))
    for s, c in ((short, long), (long, short))
    for sign_s in (1, -1)
    for sign_c in (1, -1)
)


def friction_on_mass(p: Parameters, alpha: int) -> Fraction:
    """Return the sum of mu FN sgn(v_belt - x') over both belts, for x' inside domain `alpha`."""
    return ((1 if alpha == 1 else -1) * p.mu1 + (-1 if alpha == 3 else 1) * p.mu2) * p.FN


@dataclass(frozen=True)
class RationalContact:
    """A contact of a motion with a boundary, in rational numbers: x, and s and c, the sine and
    cosine of Omega t.
    """

    p: Parameters
    boundary: int
    x: Fraction
    s: Fraction
    c: Fraction

    @cached_property
    def speed(self) -> Fraction:
        """Speed of the belt."""
        return self.p.belt(self.boundary)

    @property
    def domains(self) -> tuple[int, int]:
        """The domains below and above the belt's speed."""
        return NEIGHBOURS[self.boundary]

    @cached_property
    def forces(self) -> tuple[Fraction, Fraction]:
        """F^(alpha) of the domains below and above the belt's speed, at the contact."""
        return self.force(self.domains[0]), self.force(self.domains[1])

    def force(self, alpha: int) -> Fraction:
        """Return F^(alpha) by Newton's law with Coulomb's friction of both belts."""
        p = self.p
        return (
            p.A0 + friction_on_mass(p, alpha) + p.B0 * self.c - p.k * self.x - p.c * self.speed
        ) / p.m

    def slope(self, alpha: int) -> Fraction:
        """Return G^(1,alpha) = dF^(alpha)/dt along the flow of the domain."""
        _, _, _, third, *_ = self._motion[alpha]
        return third

    @cached_property
    def _motion(self) -> dict[int, list[Fraction]]:
        """For each domain at the belt, x and its time derivatives at the contact along the flow of
        this domain.
        """
        p = self.p
        derivatives = {}
        # cos(theta) and its derivatives with respect to theta
        waves = (self.c, -self.s, -self.c, self.s)
        for alpha in self.domains:
            x = [self.x, self.speed]
            constant = p.A0 + friction_on_mass(p, alpha)
            # The equation of motion, differentiated n times, gives derivative n + 2.
            for n in range(SERIES_TERMS - 1):
                force = p.B0 * p.Omega**n * waves[n % 4] + (constant if n == 0 else 0)
                x.append((force - p.c * x[n + 1] - p.k * x[n]) / p.m)
            derivatives[alpha] = x
        return derivatives

    def side(self, alpha: int, after: bool) -> int:
        """Return the sign of x' minus belt speed just before or `after` the contact, by the flow of
        domain `alpha`.
        """
        return self._sides[alpha, after]

    @cached_property
    def _sides(self) -> dict[tuple[int, bool], int]:
        """The answers of `side`: many claims ask for them."""
        sides = {}
        for alpha in self.domains:
            # The power series of x' - v_lambda: x'' t + x''' t^2/2 + ...
            _, _, *derivatives = self._motion[alpha]
            for after, powers in POWERS.items():
                value = sum(map(mul, derivatives, powers))
                sides[alpha, after] = (value > 0) - (value < 0)
        return sides

    def derivatives(self, alpha: int) -> tuple[Fraction, ...]:
        """Return the first four derivatives of x' along the flow of domain `alpha`."""
        return tuple(self._motion[alpha][2:6])

    @property
    def next_mode(self) -> str:
        """The mode after the contact, named as by `Trajectory.mode`."""
        lo, hi = self.domains
        if self.side(hi, after=True) > 0:
            return f"Omega{hi}"
        if self.side(lo, after=True) < 0:
            return f"Omega{lo}"
        return f"belt{self.boundary}"

    @property
    def goes_on(self) -> str:
        """What the motion does after the contact, as a phrase such as "goes on in Omega1"."""
        return f"goes on {'on' if self.sticks else 'in'} {self.next_mode}"

    @property
    def sticks(self) -> bool:
        """Whether neither domain's flow leads away from the belt."""
        return self.next_mode.startswith("belt")

    @property
    def passes(self) -> bool:
        """Whether the flow arrives from one domain and leaves into the other."""
        lo, hi = self.domains
        up = self.side(lo, after=False) < 0 < self.side(hi, after=True)
        return up or self.side(lo, after=True) < 0 < self.side(hi, after=False)

    def grazes(self, alpha: int) -> bool:
        """Return whether the flow of domain `alpha` is in this domain both just before and just
        after the contact.
        """
        if alpha == self.boundary:
            side_of_domain = -1
        else:
            side_of_domain = 1
        return self.side(alpha, after=False) == self.side(alpha, after=True) == side_of_domain

    def __str__(self) -> str:
        values = ", ".join(f"{name} = {value}" for name, value in self.p.as_dict().items())
        return f"{values}; x = {self.x}, sin = {self.s}, cos = {self.c}"


@cache
def contacts(
    boundary: int, count: int = 360, seed: int | None = None
) -> tuple[RationalContact, ...]:
    """Return `count` random rational contacts with a boundary.

    Some have F = 0 in a domain, some also G^(1) = 0.
    """
    # By default those of Theorems 4 to 6. Two kinds are generic; two have the force below or above
    # exactly 0; two have the phase such that G^(1) = 0 as well (at the top and the bottom of the
    # sine then G^(2) = 0 too). A fifth of them is at phase 0.
    draw = random.Random(boundary if seed is None else seed)

    def positive(top: int = 12) -> Fraction:
        return Fraction(draw.randint(1, top), draw.randint(1, 4))

    rational_contacts = []
    (lo, hi) = NEIGHBOURS[boundary]
    for number in range(count):
        # 0 (twice as often): generic; 1, 3: F = 0 above; 2, 4: F = 0 below; 3, 4: G^(1) = 0 too.
        kind = max(number % 6 - 1, 0)
        v1 = Fraction(draw.randint(-8, 8), draw.randint(1, 4))
        mu1 = positive(4)
        mu2 = positive(4)
        values = {name: positive() for name in ("m", "k", "B0", "Omega", "FN")}
        c = positive() - Fraction(1, 4)
        A0 = draw.randint(-20, 20)
        p = Parameters(**values, c=c, A0=A0, v1=v1, v2=v1 + positive(), mu1=mu1, mu2=mu2)
        if draw.random() > 0.2:
            s, c = draw.choice(RATIONAL_PHASES)
        else:
            s, c = RATIONAL_PHASES[0]
        if kind >= 3:  # the belt's speed for G^(1) = 0 where F = 0: k v = -B0 Omega sin
            v = -p.B0 * p.Omega * s / p.k
            if boundary == 1:
                p = p.replace(v1=v, v2=v + 1)
            else:
                p = p.replace(v1=v - 1, v2=v)
        # The force falls with x by k/m: at x = m F/k, with F taken at x = 0, it vanishes.
        origin = RationalContact(p, boundary, Fraction(0), s, c)
        at_origin = origin.force(hi if kind % 2 else lo)
        if kind == 0:  # anywhere from far below the two forces' zeros to far above them
            at_origin -= (origin.force(lo) - origin.force(hi)) * Fraction(draw.randint(-5, 10), 5)
        rational_contacts.append(RationalContact(p, boundary, p.m * at_origin / p.k, s, c))
    return tuple(rational_contacts)


def tally(cases: Iterable[Any], questions: Mapping[str, Callable[[Any], Any]]) -> dict[str, Any]:
    """Return for each of the `questions`, under its name, the number of `cases` for which its
    function returns true.
    """
    cases = list(cases)
    return {
        name: sum(bool(question(case)) for case in cases) for name, question in questions.items()
    }


#: Roots that are closer than this part of their size are moved apart: the flow then is off by less
#: than 1e-8.
FAR_APART = 1e-8
#: What DOP853 is asked for, and may differ by from the exact motion, relative to the size of the
#: motion.
DOP853_TOLERANCE = 1e-12
DOP853_AGREEMENT = 1e-9


def flow(p: Parameters, A: Any, start: Sequence[Any], t: Any) -> tuple[Any, Any]:
    """Return x and x' at times t from start = (t0, x0, v0) by eq. (5), with A for the sum of A0 and
    friction; k > 0.
    """
    # In complex numbers, independent of the package's kernels; not for undamped resonance.
    m, c, k, B0, Omega = (float(getattr(p, name)) for name in ("m", "c", "k", "B0", "Omega"))
    t0, x0, v0 = map(float, start)
    half = cmath.sqrt(c * c - 4 * m * k) / (2 * m)
    # Roots that are closer are moved apart: two equal ones would need another formula.
    if abs(half) < FAR_APART * c / m:
        half = FAR_APART * c / m
    root_1 = -c / (2 * m) + half
    root_2 = -c / (2 * m) - half
    amplitude = B0 / (k - m * Omega**2 + 1j * c * Omega)

    def steady(time: Any) -> tuple[Any, Any]:
        turning = amplitude * np.exp(1j * Omega * np.asarray(time))
        return float(A) / k + turning.real, (1j * Omega * turning).real

    # The transient is a sum of exp(root t) with the values that the start demands.
    x_s, v_s = steady(t0)
    start_1 = (v0 - v_s - root_2 * (x0 - x_s)) / (root_1 - root_2)
    start_2 = x0 - x_s - start_1
    mode_1 = start_1 * np.exp(root_1 * (np.asarray(t) - t0))
    mode_2 = start_2 * np.exp(root_2 * (np.asarray(t) - t0))
    x, v = steady(t)
    return x + (mode_1 + mode_2).real, v + (root_1 * mode_1 + root_2 * mode_2).real


def dop853(
    p: Parameters,
    constant: Fraction,
    span: tuple[float, float],
    state: Any,
    until_speed: float | None = None,
) -> Any:
    """Return scipy's DOP853 solution over the times `span` from (x, v) = `state`, or until v is
    `until_speed`.

    It solves eq. (5) with `constant` for the sum of A0 and friction.
    """
    from scipy.integrate import solve_ivp

    A, m, c, k, B0, Omega = (float(value) for value in (constant, p.m, p.c, p.k, p.B0, p.Omega))

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        x, v = y
        return v, (A + B0 * np.cos(Omega * t) - k * x - c * v) / m

    def gap(t: float, y: np.ndarray) -> float:
        _, v = y
        return float(v - until_speed)

    gap.terminal = True  # type: ignore[attr-defined]
    tolerance = {"rtol": DOP853_TOLERANCE, "atol": DOP853_TOLERANCE}
    return solve_ivp(
        rates, span, state, "DOP853", events=None if until_speed is None else gap, **tolerance
    )
