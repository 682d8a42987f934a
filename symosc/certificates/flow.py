"""The motion in one mode, enclosed: velocity, acceleration and position at a time after its start.

With L = D^2 + (c/m) D + k/m the velocity solves L v = -(B0 Omega/m) sin(Omega t) in every domain.
It is a steady motion, of rational amplitudes, and a free one, which E (L E = 0, E(0) = 0, E'(0) =
1) and phi = E' + (c/m) E (phi(0) = 1, phi'(0) = 0) carry. Friction enters only through the
acceleration at the start. Damping regime and resonance are decided in rational numbers.

The gap g = v - v_belt has L g = drift/m in every domain, with the drift -(k v_belt + B0 Omega
sin(Omega t)), which is also m dF/dt of both forces on the belt. It turns at the phases Theta_cr of
Theorem 7; between the turns its sign is known from their order and needs no evaluation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from flint import acb_series, arb, arb_series

from symosc.certificates.balls import Ball, Undecided, ball, sure_sign
from symosc.model import Parameters, by_name

#: A family counts as critically damped unless its frequency is at least so many times its error.
ROUGH = 32


def coefficient(value: Ball, order: int = 0) -> Ball:
    """Return the coefficient of a given `order` in a power series.

    A ball counts as a constant series.
    """
    if isinstance(value, arb_series):
        return value[order]
    if order:
        return arb(0)
    return value


def entire_0f1(b: Ball, z: Ball) -> Ball:
    """Return the hypergeometric function 0F1(b; z) of a real or complex ball or power series z."""
    # 0F1(1/2; w^2/4) is cosh w, and 0F1(3/2; w^2/4) is sinh w/w, where w^2 may have any sign. The
    # derivative is 0F1(b + 1; z)/b, which gives the Taylor series.
    if not isinstance(z, arb_series | acb_series):
        return z.hypgeom_0f1(b)
    kind: Any = type(z)
    change, total, factor = (kind(each, prec=z.prec) for each in ([0, *list(z)[1:]], [0], [1]))
    for j in range(z.prec):
        total = total + factor * z[0].hypgeom_0f1(b + j)
        factor = factor * change / ((b + j) * (j + 1))
    return total


class Oscillator:
    """The constants of an oscillator as balls, with its damping regime and whether it is at
    resonance.
    """

    # `ranges` replaces parameters of `p` by a ball, or by a power series in a change of one
    # parameter (arb_series), whose first coefficient may be a ball: a family of oscillators.
    # Undecided if it may be at resonance without damping.

    def __init__(self, p: Parameters, ranges: Mapping[str, Ball] | None = None) -> None:
        self.p = p
        ranges = ranges or {}
        b = by_name(p, ball) | dict(ranges)
        self.B0, self.c, self.k, self.m, self.Omega = (
            b[name] for name in ("B0", "c", "k", "m", "Omega")
        )
        self.h = self.c / (2 * self.m)
        self.cm = self.c / self.m
        self.km = self.k / self.m
        self.drive = self.B0 * self.Omega / self.m
        #: The sign of (c/2m)^2 - k/m, 0 if undecided, and the root of its size: the damped
        #: frequency or its twin.
        free = ranges.keys() & {"m", "c", "k"}
        if free:
            self.kappa = self.h * self.h - self.km
            self.damping = sure_sign(coefficient(self.kappa))
        else:
            exact = p.c * p.c / (4 * p.m * p.m) - p.k / p.m
            self.damping = (exact > 0) - (exact < 0)
            self.kappa = ball(exact)
        self.omega_d = (self.kappa if self.damping >= 0 else -self.kappa).sqrt()
        frequency = coefficient(self.omega_d)
        if not frequency > ROUGH * frequency.rad():  # it is critical, or nearly so in the family
            self.damping = 0
        if self.damping > 0:
            self.fast = -(self.h + self.omega_d)
            self.slow = self.km / self.fast
        friction = {1: b["mu1"] + b["mu2"], 2: b["mu2"] - b["mu1"], 3: -b["mu1"] - b["mu2"]}
        self.A = {domain: b["A0"] + part * b["FN"] for domain, part in friction.items()}
        self.speed = {1: b["v1"], 2: b["v2"]}
        #: The jump of the acceleration at each belt, F^(below) - F^(above).
        self.jump = {boundary: 2 * b[f"mu{boundary}"] * b["FN"] / self.m for boundary in (1, 2)}
        driven = p.B0 != 0 or "B0" in ranges
        tuned = not free and "Omega" not in ranges
        self.resonant = driven and tuned and p.c == 0 and p.k == p.m * p.Omega**2
        if self.resonant:
            self.growth = self.B0 / (2 * self.m * self.Omega)
        elif not driven:
            self.steady_c = self.steady_s = arb(0)
        elif tuned and "B0" not in ranges:
            pull = p.k / p.m - p.Omega**2
            drag = p.c * p.Omega / p.m
            gain = p.B0 * p.Omega / p.m / (pull * pull + drag * drag)
            self.steady_c = ball(gain * drag)
            self.steady_s = ball(-gain * pull)
        else:
            pull = self.km - self.Omega * self.Omega
            drag = self.cm * self.Omega
            square = pull * pull + drag * drag
            if not coefficient(square) > 0:
                raise Undecided("whether the family is at resonance")
            gain = self.drive / square
            self.steady_c = gain * drag
            self.steady_s = -gain * pull
        self.turns = cache(lambda boundary: Turns(p, boundary))

    def entire(self, tau: Ball) -> tuple[Ball, Ball, Ball]:
        """Return E, E' and phi = E' + (c/m) E at the time `tau`: E is the free motion with E(0) = 0
        and E'(0) = 1.
        """
        if self.damping > 0:
            fast = (self.fast * tau).exp()
            slow = (self.slow * tau).exp()
            width = 2 * self.omega_d
            E = (slow - fast) / width
            E1 = (self.slow * slow - self.fast * fast) / width
        else:
            decay = (-self.h * tau).exp()
            if self.damping == 0:
                z = self.kappa * tau * tau / 4
                E = decay * tau * entire_0f1(arb(1.5), z)
                E1 = decay * entire_0f1(arb(0.5), z) - self.h * E
            else:
                s, c = (self.omega_d * tau).sin_cos()
                E = decay * s / self.omega_d
                E1 = decay * c - self.h * E
        return E, E1, E1 + self.cm * E

    def steady(self, tau: Ball, s: Ball, c: Ball) -> tuple[Ball, Ball]:
        """Return v and v' of the steady motion (at resonance it grows).

        `s`, `c` are sine and cosine of the phase.
        """
        if self.resonant:
            turn = self.Omega * tau
            return self.growth * (s + turn * c), self.growth * self.Omega * (2 * c - turn * s)
        P = self.steady_c
        R = self.steady_s
        Omega = self.Omega
        return P * c + R * s, Omega * (R * c - P * s)

    def force(self, domain: int, t: Ball, x: Ball, v: Ball) -> Ball:
        """Return the force per mass, which is the acceleration, in a domain at time t, position x
        and velocity v.
        """
        return (
            self.A[domain] + self.B0 * (self.Omega * t).cos() - self.k * x - self.c * v
        ) / self.m


class Jet(NamedTuple):
    """The value g of a function at a time tau after a start, with its first two derivatives dg and
    ddg.
    """

    tau: Ball
    g: Ball
    dg: Ball
    ddg: Ball


Curve = Callable[[Ball], Jet]


class FlightPoint(NamedTuple):
    """A point of a flight, a time tau after its start: v, a, sine s and cosine c of the phase, E,
    E1 = E' and phi.

    E and phi are the motions without drive of `Oscillator.entire`.
    """

    tau: Ball
    v: Ball
    a: Ball
    s: Ball
    c: Ball
    E: Ball
    E1: Ball
    phi: Ball


class Flight:
    """The motion in one domain that starts at time `t` with position `x` and velocity `v`, which
    may be wide balls.
    """

    def __init__(self, oscillator: Oscillator, domain: int, t: Ball, x: Ball, v: Ball) -> None:
        self.oscillator = oscillator
        self.domain = domain
        self.t0 = t
        self.x0 = x
        self.v0 = v
        self.s0, self.c0 = (oscillator.Omega * t).sin_cos()
        self.a0 = oscillator.force(domain, t, x, v)
        steady_v, steady_a = oscillator.steady(arb(0), self.s0, self.c0)
        self.free_v = v - steady_v
        self.free_a = self.a0 - steady_a

    def at(self, tau: Ball) -> FlightPoint:
        """Return the point of the flight a time tau after its start."""
        o = self.oscillator
        s, c = (o.Omega * (self.t0 + tau)).sin_cos()
        E, E1, phi = o.entire(tau)
        v, a = o.steady(tau, s, c)
        v = v + self.free_v * phi + self.free_a * E
        a = a - o.km * E * self.free_v + self.free_a * E1
        return FlightPoint(tau, v, a, s, c, E, E1, phi)

    def jerk(self, there: FlightPoint) -> Ball:
        """Return the derivative of the acceleration at a point of the flight."""
        o = self.oscillator
        return -o.cm * there.a - o.km * there.v - o.drive * there.s

    def x(self, there: FlightPoint) -> Ball:
        """Return the position at a point of the flight, by the balance of forces or, if k = 0, that
        of momentum.
        """
        o = self.oscillator
        p = self.oscillator.p
        if p.k > 0:
            change = (
                o.B0 * (there.c - self.c0) - o.c * (there.v - self.v0) - o.m * (there.a - self.a0)
            )
            return self.x0 + change / o.k
        push = o.A[self.domain] * there.tau + o.B0 / o.Omega * (there.s - self.s0)
        if p.c > 0:
            return self.x0 + (push - o.m * (there.v - self.v0)) / o.c
        swing = (there.c - self.c0) / o.Omega + self.s0 * there.tau
        way = o.A[self.domain] * there.tau * there.tau / 2 - o.B0 / o.Omega * swing
        return self.x0 + self.v0 * there.tau + way / o.m

    def moved(self, there: FlightPoint, change: Sequence[Ball]) -> tuple[Ball, Ball]:
        """Return the derivatives of x and v at a point, at a fixed time, by a `change` (dt, dx, dv)
        of the start.
        """
        # A later start by dt is one at the same time with x lower by v dt and v lower by a dt.
        dt, dx, *rest = change
        x = dx - self.v0 * dt
        v = (rest[0] if rest else arb(0)) - self.a0 * dt
        return there.phi * x + there.E * v, there.E1 * v - self.oscillator.km * there.E * x

    def speed_bound(self, there: FlightPoint) -> Ball:
        """Return a bound of |v| after a point, by the energy of the motion without drive.

        Infinity if it gives none.
        """
        # The free motion y loses energy: y^2 + (m/k) y'^2 never grows.
        o = self.oscillator
        if o.resonant or o.p.k == 0:
            return arb.pos_inf()
        v, a = o.steady(there.tau, there.s, there.c)
        free_v = there.v - v
        free_a = there.a - a
        free = (free_v * free_v + free_a * free_a / o.km).nonnegative_part().sqrt()
        return free + (o.steady_c * o.steady_c + o.steady_s * o.steady_s).sqrt()

    def side(self, boundary: int) -> int:
        """Return 1 if the flight is in a domain above the speed of a belt (`boundary`), -1 if it is
        in one below.
        """
        if self.domain > boundary:
            return 1
        return -1

    def gap(self, boundary: int) -> Curve:
        """Return the gap to a belt, which is how far v is from its speed, as a function from the
        time to a `Jet`.
        """
        speed = self.oscillator.speed[boundary]
        side = self.side(boundary)

        def gap(tau: Ball) -> Jet:
            there = self.at(tau)
            return Jet(tau, side * (there.v - speed), side * there.a, side * self.jerk(there))

        return gap


def holding_force(o: Oscillator, boundary: int, domain: int, t: Ball, x: Ball) -> Curve:
    """Return a function from a time after (t, x), where a stick begins, to the `Jet` of a force per
    mass that holds it.

    While that force is > 0, the mass does not slip from the belt into `domain`.
    """
    speed = o.speed[boundary]
    if domain == boundary:
        side = 1
    else:
        side = -1

    def force(tau: Ball) -> Jet:
        s, c = (o.Omega * (t + tau)).sin_cos()
        value = (o.A[domain] + o.B0 * c - o.k * (x + speed * tau) - o.c * speed) / o.m
        return Jet(
            tau, side * value, -side * (o.km * speed + o.drive * s), -side * o.drive * o.Omega * c
        )

    return force


class Turns:
    """The times (turns) at which the drift of a belt's forces, m dF/dt = -(k v + B0 Omega sin(Omega
    t)), changes sign.

    If the drift never changes its sign, there are no turns, and `constant` is that sign; otherwise
    `constant` is None.
    """

    def __init__(self, p: Parameters, boundary: int) -> None:
        bias = p.k * p.belt(boundary)
        amplitude = p.B0 * p.Omega
        self.Omega = ball(p.Omega)
        self.constant = None
        self.rising = (p.B0 > 0) - (p.B0 < 0)
        #: Whether the forces on the belt repeat with the drive.
        self.repeats = bias == 0
        if abs(bias) >= abs(amplitude):
            self.constant = (bias < 0) - (bias > 0)
        else:
            ratio: Fraction = -bias / amplitude
            self.angle = ball(ratio).asin()

    def time(self, index: int) -> Ball:
        """Return the time of the turn with an index.

        Sin(Omega t) rises there if the index is even, else it falls.
        """
        turn, odd = divmod(index, 2)
        if odd:
            angle = arb.pi() - self.angle
        else:
            angle = self.angle
        return (angle + 2 * turn * arb.pi()) / self.Omega

    def after(self, t: Ball) -> Iterator[tuple[Ball | None, int]]:
        """Yield the time of each turn after t and the drift's sign before it; without turns, (None,
        its sign) once.
        """
        if self.constant is not None:
            yield None, self.constant
            return
        phase = (self.Omega * t).mid()
        index = 2 * int((phase / (2 * arb.pi())).mid().floor().unique_fmpz()) - 2
        while not (time := self.time(index)) > t:
            if not time <= t:
                raise Undecided("a start near a turn of the forces", t)
            index += 1
        while True:
            turn_before_is_even = index % 2 == 1
            yield self.time(index), (-self.rising if turn_before_is_even else self.rising)
            index += 1
