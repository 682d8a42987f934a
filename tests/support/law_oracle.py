"""An independent oracle for oscillators on belts with piecewise-linear friction and stiction.

    m x'' + c x' + k x = A0 + B0 cos(Omega t) - sum over belts of sgn(x' - V) FN mu(|x' - V|)

with a static limit FN mu_s on each belt. `follow` takes exact numbers and answers in mpmath's.

- A flight is stepped with the power series of the velocity, whose recurrence is the ODE itself;
  its closed form appears nowhere. Roots of v - V on a step are isolated by signs of Bernstein
  coefficients in doubles (Descartes: no change of sign, no root; one change, one root). What doubles
  leave open, a tangency or nearly one, is decided with all digits by the chain of derivatives.
- On a belt x is linear in time, and the needed force is monotone between the phases where its
  derivative vanishes: signs at those find each exit.
- The mass sticks while the needed force is at most static. At equality the first derivative
  along the stick that does not vanish decides; a force that only touches the limit holds.

A number that decides and is within 10**(4 - digits) of zero, relative to its terms, counts as zero.
Within 10**(-0.42 digits) of it (1e-25 of 60 digits) the run ends as "undecided". Corners of a curve
are no events and decide nothing: a touch of one changes the motion by less than the digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from math import ceil, comb, factorial, isfinite, lgamma, log, log10, sqrt
from typing import Any, NamedTuple

import mpmath
import numpy as np

REACH = 3.917  # fastest rate times the length of a step: no round number, so no event ends a step
SPLIT = 0.4871  # where an interval is divided, for the same reason
DEGREE = 33  # of the polynomials in doubles: REACH**34/34! is below their last bit
UNSURE = 1e-13  # part of the sum of |coefficients| that a sign in doubles must exceed
DEPTH = 12  # divisions in doubles before all digits are asked
MOST_DERIVATIVES = 7  # in the chain that isolates a multiple root
GUARD = 14  # digits beyond those asked for
FIRM = 1e-9  # a node of a stick as far as that inside the limits needs no more digits


class LawBelt(NamedTuple):
    """A belt: kinetic coefficient `mu`, or a `curve` of (w, mu) with `slope` beyond; static `mu_s`."""

    v: Any
    mu: Any = None
    mu_s: Any = None
    curve: Any = None
    slope: Any = 0


class LawEvent(NamedTuple):
    """One event. `tie`: a force or a distance of exactly zero decided what it is."""

    t: Any
    x: Any
    v: Any
    kind: str
    boundary: int
    source: str
    target: str
    tie: bool


@dataclass
class LawRun:
    """Events, and where and why the run ended: "t_end", "max_events" or "undecided".

    Attributes
    ----------
    ties : list
        Times at which a number of exactly zero decided, with its name.
    """

    events: list[LawEvent] = field(default_factory=list)
    status: str = ""
    message: str = ""
    mode: str = ""
    t: Any = None
    x: Any = None
    v: Any = None
    ties: list[tuple[Any, str]] = field(default_factory=list)


class UndecidedError(ArithmeticError):
    """A number that decides is too close to zero to be told from it."""


class Edge(NamedTuple):
    """A velocity at which the law changes: a belt (`belt` from 1) or a corner (0)."""

    V: Fraction
    J: Fraction
    E: Fraction
    belt: int


class Band(NamedTuple):
    """Between two edges: m x'' + c x' + k x = A + B0 cos(Omega t); `domain` counts belts below."""

    c: Fraction
    A: Fraction
    domain: int


def exact(value: Any) -> Fraction:
    """Read a number as tests write them: floats as the decimal they print as."""
    if isinstance(value, Fraction):
        return value
    return Fraction(str(value))


def friction_table(c: Any, A0: Any, FN: Any, belts: Sequence[Any]) -> tuple[list[Edge], list[Band]]:
    """Return the edges, and the bands below, between and above them, all exact."""
    laws = sorted((_curve_of(belt, exact(FN)) for belt in belts), key=lambda law: law[0])
    speeds = sorted({V for V, _, _, _ in laws})
    corners = {V + side * w for V, points, _, _ in laws for w, _ in points[1:] for side in (1, -1)}
    edges = []
    for V in sorted(corners | set(speeds)):
        here = [(points[0][1], static) for speed, points, _, static in laws if speed == V]
        J = sum((2 * kinetic for kinetic, _ in here), Fraction(0))
        E = sum((static - kinetic for kinetic, static in here), Fraction(0))
        belt = speeds.index(V) + 1 if here else 0
        edges.append(Edge(V, J, E, belt))
    bands = []
    for number in range(len(edges) + 1):
        inside = _inside([edge.V for edge in edges], number)
        damping = exact(c)
        constant = exact(A0)
        for V, points, last, _ in laws:
            value, slope = _line_at(points, last, abs(inside - V))
            side = 1 if inside > V else -1
            damping += slope
            constant += slope * V - side * value
        domain = 1 + sum(speed < inside for speed in speeds)
        bands.append(Band(damping, constant, domain))
    return edges, bands


def _curve_of(
    belt: Any, FN: Fraction
) -> tuple[Fraction, list[tuple[Fraction, Fraction]], Any, Any]:
    """Return speed, points (w, kinetic force), last slope and static force of a belt."""
    if isinstance(belt, dict):
        belt = LawBelt(**belt)
    curve = [(0, belt.mu)] if belt.curve is None else belt.curve
    points = [(exact(w), FN * exact(mu)) for w, mu in curve]
    static = points[0][1] if belt.mu_s is None else FN * exact(belt.mu_s)
    return exact(belt.v), points, FN * exact(belt.slope or 0), static


def _inside(places: list[Fraction], number: int) -> Fraction:
    """Return a velocity inside band `number`."""
    if not places:
        return Fraction(0)
    if number == 0:
        return places[0] - 1
    if number == len(places):
        return places[-1] + 1
    return (places[number - 1] + places[number]) / 2


def _line_at(points: list[Any], last: Fraction, w: Fraction) -> tuple[Fraction, Fraction]:
    """Return a and b of the line a + b w that the curve is at w."""
    number = sum(place < w for place, _ in points) - 1
    place, value = points[number]
    slope = last
    if number + 1 < len(points):
        further, next_value = points[number + 1]
        slope = (next_value - value) / (further - place)
    return value - slope * place, slope


def follow(
    m: Any,
    c: Any,
    k: Any,
    A0: Any,
    B0: Any,
    Omega: Any,
    FN: Any,
    belts: Sequence[Any],
    t0: Any,
    x0: Any,
    v0: Any,
    t_end: Any,
    max_events: int = 10_000,
    digits: int = 60,
    motion: type[Motion] | None = None,
) -> LawRun:
    """Follow one motion of a law; belts are LawBelts, or mappings with their names.

    Another `motion` than Motion is how tests make mistakes.
    """
    law = (m, c, k, A0, B0, 1 if Omega is None else Omega, FN)
    follower = (motion or Motion)(*map(exact, law), belts, digits)
    return follower.run(exact(t0), exact(x0), exact(v0), exact(t_end), max_events)


def first_peak(
    m: Any, c: Any, k: Any, A0: Any, B0: Any, Omega: Any, FN: Any, belts: Sequence[Any],
    t0: Any, x0: Any, v0: Any, digits: int = 50,
) -> Any:  # fmt: skip
    """Return the first maximum of the velocity in the band of the start, or None if none comes soon.

    Corners and belts are not looked for: none may be met before.
    """
    law = (m, c, k, A0, B0, 1 if Omega is None else Omega, FN)
    motion = Motion(*map(exact, law), belts, digits)
    return motion.first_peak(exact(t0), exact(x0), exact(v0))


class Motion:
    """The state (t, x, v), where it is, and what moves it."""

    def __init__(
        self,
        m: Fraction,
        c: Fraction,
        k: Fraction,
        A0: Fraction,
        B0: Fraction,
        Omega: Fraction,
        FN: Fraction,
        belts: Sequence[Any],
        digits: int,
    ) -> None:
        self.m = m
        self.k = k
        self.B0 = B0
        self.Omega = Omega
        self.digits = digits
        self.zero = 10.0 ** (4 - digits)
        self.doubt = 10.0 ** (-0.42 * digits)
        self.edges, self.bands = friction_table(c, A0, FN, belts)
        self.series: dict[int, _Series] = {}
        self.run_so_far = LawRun()
        self.tied = False

    # -- the whole motion --------------------------------------------------------------------------

    def run(
        self, t0: Fraction, x0: Fraction, v0: Fraction, t_end: Fraction, max_events: int
    ) -> LawRun:
        span = float(t_end - t0)
        growth = max(0.0, -float(min(band.c for band in self.bands) / (2 * self.m)) * span)
        size = 1 + abs(float(self.Omega * t_end)) + abs(float(self.Omega * t0)) + abs(float(x0))
        self.dps = self.digits + GUARD + ceil(log10(size)) + min(self.digits, ceil(growth / 2.3))
        self.span = span
        self.fastest = 0.0
        with mpmath.workdps(self.dps):
            self.t = _mpf(t0)
            self.x = _mpf(x0)
            self.v = _mpf(v0)
            self.end = _mpf(t_end)
            self.constants()
            result = self.run_so_far
            try:
                self.start(v0)
                self.go_on(max_events)
            except UndecidedError as error:
                result.status = "undecided"
                result.message = f"{error} at t = {mpmath.nstr(self.t, 20)}"
            result.mode = self.name()
            result.t = +self.t
            result.x = +self.x
            result.v = +self.v
        return result

    def first_peak(self, t0: Fraction, x0: Fraction, v0: Fraction) -> Any:
        self.dps = self.digits + GUARD
        self.span = 100.0
        with mpmath.workdps(self.dps):
            self.t = _mpf(t0)
            self.x = _mpf(x0)
            self.v = _mpf(v0)
            self.constants()
            self.start(v0)
            series = _Series(self, self.band)
            for _ in range(12):
                a = series.coefficients(self.t, self.x, self.v)
                slopes = [n * a[n] for n in range(1, len(a))]
                bends = [n * slopes[n] for n in range(1, len(slopes))]
                places = [mpmath.mpf(n) / 64 for n in range(65)]
                rates = [_horner(slopes, place) for place in places]
                for n in range(64):
                    if rates[n] > 0 >= rates[n + 1]:
                        place = _bracketed(
                            lambda s, slopes=slopes: _horner(slopes, s),
                            lambda s, bends=bends: _horner(bends, s),
                            places[n],
                            places[n + 1],
                            True,
                            self.dps,
                        )
                        return _horner(a, place)
                self.x += series.h * series.integral(a, mpmath.mpf(1))
                self.v = _horner(a, mpmath.mpf(1))
                self.t += series.h
        return None

    def constants(self) -> None:
        self.V = [_mpf(edge.V) for edge in self.edges]
        self.J = [_mpf(edge.J) for edge in self.edges]
        self.E = [_mpf(edge.E) for edge in self.edges]
        self.kV = [_mpf(self.k * edge.V) for edge in self.edges]
        self.k_mp = _mpf(self.k)
        self.B0_mp = _mpf(self.B0)
        self.Omega_mp = _mpf(self.Omega)
        self.drive_rate = _mpf(self.B0 * self.Omega)
        # needed on edge l: A of the band below it minus its c V; above it is less by J
        self.on_edge = [
            _mpf(self.bands[number].A - self.bands[number].c * edge.V)
            for number, edge in enumerate(self.edges)
        ]

    def start(self, v0: Fraction) -> None:
        """Find the band, or the edge, of the start."""
        self.contact = None  # the edge that a flight leaves
        self.stuck = None  # the edge on which the mass sticks
        self.band = sum(v0 > edge.V for edge in self.edges)
        edge = next((n for n, edge in enumerate(self.edges) if v0 == edge.V), None)
        if edge is not None:
            self.settle(edge)

    def name(self) -> str:
        if self.stuck is not None:
            return f"belt{self.edges[self.stuck].belt}"
        return f"Omega{self.bands[self.band].domain}"

    def go_on(self, max_events: int) -> None:
        result = self.run_so_far
        while self.t < self.end:
            if len(result.events) >= max_events:
                result.status = "max_events"
                return
            source = self.name()
            self.tied = False
            if self.stuck is not None:
                edge = self.stuck
                if not self.slide():
                    continue
                kind = "slip"
            else:
                edge = self.fly()
                if edge is None:
                    continue
                self.settle(edge)
                kind = "cross"
                if self.stuck is not None:
                    kind = "stick"
                elif self.name() == source:
                    kind = "graze"
            boundary = self.edges[edge].belt
            result.events.append(
                LawEvent(
                    +self.t, +self.x, +self.V[edge], kind, boundary, source, self.name(), self.tied
                )
            )
        result.status = "t_end"

    # -- decisions ---------------------------------------------------------------------------------

    def sign(self, value: Any, scale: Any, what: str) -> int:
        """Return the sign of a number that decides."""
        size = abs(value)
        if size <= self.zero * scale:
            self.tied = True
            self.run_so_far.ties.append((+self.t, what))
            return 0
        if size <= self.doubt * scale:
            raise UndecidedError(f"{what} of {mpmath.nstr(value, 5)}")
        return 1 if value > 0 else -1

    def needed(self, edge: int) -> tuple[Any, Any, Any]:
        """Return m times F(below) + E and F(above) - E on an edge, and the size of their terms."""
        spring = self.k_mp * self.x
        drive = self.B0_mp * mpmath.cos(self.Omega_mp * self.t)
        force = self.on_edge[edge] - spring + drive
        scale = (
            abs(self.on_edge[edge]) + abs(spring) + abs(self.B0_mp) + self.J[edge] + self.E[edge]
        )
        low = force + self.E[edge]
        return low, low - self.J[edge] - 2 * self.E[edge], scale

    def tendency(self, edge: int) -> int:
        """Return the sign of the first derivative of the needed force that is not zero on an edge."""
        theta = self.Omega_mp * self.t
        sine = mpmath.sin(theta)
        first = -(self.kV[edge] + self.drive_rate * sine)
        scale = abs(self.kV[edge]) + abs(self.drive_rate)
        if scale == 0:
            return 0
        direction = self.sign(first, scale, "a rate")
        if direction == 0 and self.B0 != 0:
            scale = abs(self.drive_rate)
            direction = self.sign(-self.drive_rate * mpmath.cos(theta), scale, "a bend")
            if direction == 0:
                direction = self.sign(self.drive_rate * sine, scale, "a third derivative")
        return direction

    def settle(self, edge: int) -> None:
        """Go on from an edge: on it, or in the band below or above."""
        self.v = self.V[edge]
        low, high, scale = self.needed(edge)
        if self.edges[edge].belt == 0:
            # A corner: only a start on it comes here. Where nothing moves, either band will do.
            upward = self.sign(low, scale, "a force at a corner") or self.tendency(edge) or 1
        elif (self.sign(high, scale, "F(above) - E") or self.tendency(edge)) > 0:
            upward = 1
        elif (self.sign(low, scale, "F(below) + E") or self.tendency(edge)) < 0:
            upward = -1
        else:
            upward = 0
        if upward == 0:
            self.stuck = edge
            self.contact = None
        else:
            self.leave(edge, upward)

    def leave(self, edge: int, upward: int) -> None:
        self.stuck = None
        self.contact = edge
        self.band = edge + (upward > 0)

    # -- on a belt ---------------------------------------------------------------------------------

    def slide(self) -> bool:
        """Stick to the exit, and leave the belt, or to the end of the motion."""
        edge = self.stuck
        assert edge is not None
        t0 = self.t
        x0 = self.x
        speed = self.V[edge]

        def limits(t: Any) -> tuple[Any, Any, Any]:
            self.t = t
            self.x = x0 + speed * (t - t0)
            return self.needed(edge)

        self.v = speed
        before = t0
        for node, cosine in self.turns(edge):
            last = node >= self.end
            stop = self.end if last else node
            if not last and self.holds_firmly(edge, t0, x0, node, cosine):
                before = node
                continue
            low, high, scale = limits(stop)
            if last:
                up = high > self.zero * scale
                down = low < -self.zero * scale
            else:
                up = self.sign(high, scale, "F(above) - E at a turn") > 0
                down = self.sign(low, scale, "F(below) + E at a turn") < 0
            if up or down:
                which = 1 if up else 0
                t = self.exit(edge, before, stop, limits, which)
                limits(t)
                self.leave(edge, 1 if up else -1)
                return True
            if last:
                return False
            before = node
        return False

    def turns(self, edge: int) -> Iterator[tuple[Any, Any]]:
        """Yield the times after now where the rate of the needed force vanishes, with cos there.

        The last one yielded is the end of the motion.
        """
        drive = self.B0 * self.Omega
        pull = self.k * self.edges[edge].V
        if drive == 0 or abs(pull) > abs(drive):
            yield self.end, None
            return
        first = mpmath.asin(-_mpf(pull / drive))
        cosine = mpmath.sqrt(_mpf(1 - (pull / drive) ** 2))
        phases = [(first, cosine)]
        if abs(pull) != abs(drive):
            phases.append((mpmath.pi - first, -cosine))
        period = int(mpmath.floor(self.Omega_mp * self.t / (2 * mpmath.pi))) - 1
        now = self.t
        count = 0
        while True:
            for phase, value in phases:
                node = (phase + 2 * mpmath.pi * period) / self.Omega_mp
                if node <= now:
                    continue
                if node >= self.end or (pull == 0 and count > 3):
                    # Without a pull the force repeats: what holds for a period holds for ever.
                    yield self.end, None
                    return
                count += 1
                yield node, value
            period += 1

    def holds_firmly(self, edge: int, t0: Any, x0: Any, node: Any, cosine: Any) -> bool:
        """Whether the needed force at a turn is inside the limits, as doubles tell."""
        spring = float(self.k_mp * (x0 + self.V[edge] * (node - t0)))
        drive = float(self.B0_mp * cosine)
        constant = float(self.on_edge[edge])
        low = constant - spring + drive + float(self.E[edge])
        width = float(self.J[edge] + 2 * self.E[edge])
        margin = FIRM * (abs(spring) + abs(drive) + abs(constant) + width)
        return low > margin and low - width < -margin

    def exit(self, edge: int, low: Any, high: Any, limits: Any, which: int) -> Any:
        """Return when the force reaches its limit between two turns, where it is monotone."""

        def force(t: Any) -> Any:
            return limits(t)[which]

        def rate(t: Any) -> Any:
            return -(self.kV[edge] + self.drive_rate * mpmath.sin(self.Omega_mp * t))

        at_low = limits(low)
        if abs(at_low[which]) <= self.zero * at_low[2]:
            # It was at its limit at the turn before: it held as long as it could.
            self.tied = True
            return low
        return _bracketed(force, rate, low, high, at_low[which] > 0, self.dps)

    # -- flights -----------------------------------------------------------------------------------

    def fly(self) -> int | None:
        """Move one step, or to its first edge; return the edge of a belt that is met."""
        number = self.band
        if number not in self.series:
            self.series[number] = _Series(self, number)
        series = self.series[number]
        a = series.coefficients(self.t, self.x, self.v)
        doubles = np.array([float(value) for value in a[: DEGREE + 1]])
        if self.at_rest(doubles):
            self.x += self.v * (self.end - self.t)
            self.t = self.end
            return None
        last = min(1.0, float((self.end - self.t) / series.h)) + 1e-9
        contacts = []
        for edge in (number - 1, number):
            if 0 <= edge < len(self.edges):
                place = self.first_contact(a, doubles, edge, last)
                if place is not None:
                    contacts.append((place, edge))
        place, edge = min(contacts, default=(mpmath.mpf(1), None))
        t = self.t + series.h * place
        if t >= self.end:
            place = (self.end - self.t) / series.h
            t = self.end
            edge = None
        elif edge is None:
            place = self.clear(a, place)
            t = self.t + series.h * place
        self.x += series.h * series.integral(a, place)
        self.t = t
        if edge is None:
            self.v = _horner(a, place)
            self.contact = None
            return None
        self.v = self.V[edge]
        if self.edges[edge].belt == 0:
            self.leave(edge, 1 if edge == number else -1)
            return None
        return edge

    def at_rest(self, doubles: Any) -> bool:
        """Whether no digit tells the velocity any more from a constant on an edge."""
        changes = float(np.abs(doubles[1:]).sum())
        self.fastest = max(self.fastest, abs(doubles[0]) + changes)
        gap = min((float(abs(self.v - V)) for V in self.V), default=np.inf)
        return gap + changes < 10.0**-self.digits * self.fastest

    def clear(self, a: list[Any], place: Any) -> Any:
        """End a step a little earlier if it would end next to an edge."""
        for _ in range(20):
            v = _horner(a, place)
            size = 1e-12 * (1 + float(abs(v)))
            if all(abs(v - V) > size for V in self.V):
                return place
            place = place * mpmath.mpf("0.9137")
        return place

    def first_contact(self, a: list[Any], doubles: Any, edge: int, last: float) -> Any:
        """Return where on (0, last] the velocity meets the edge, or None."""
        gap = list(a)
        gap[0] = a[0] - self.V[edge]
        rounded = doubles.copy()
        rounded[0] = float(gap[0])
        terms = abs(float(a[0])) + abs(float(self.V[edge])) + float(np.abs(doubles[1:]).sum())
        if edge == self.contact:
            # The motion begins on this edge: its root at 0 is divided out.
            size = REACH
            order = None
            for n in range(1, 8):
                if abs(gap[n]) > self.zero * terms * size**n / factorial(n):
                    order = n
                    break
            if order is None:
                return None
            gap = gap[order:]
            rounded = np.append(rounded[order:], np.zeros(order))
        belt = self.edges[edge].belt != 0
        slack = UNSURE * float(np.abs(rounded).sum())
        for low, high, sure in _brackets(rounded, slack, last):
            if sure:
                return _simple_root(gap, rounded, low, high, self.dps)
            place = self.chain(gap, rounded, low, high, terms, belt)
            if place is not None:
                return place
        return None

    def chain(
        self, gap: list[Any], rounded: Any, low: float, high: float, terms: float, belt: bool
    ) -> Any:
        """Return the first contact on [low, high] by derivatives of which one has no root."""
        order = _without_root(rounded, low, high)
        if order is None:
            raise UndecidedError("a contact too flat to be isolated")
        derivatives = [gap]
        for _ in range(order):
            top = derivatives[-1]
            derivatives.append([n * top[n] for n in range(1, len(top))])
        ends = [mpmath.mpf(low), mpmath.mpf(high)]
        cuts: list[Any] = []
        for n in range(order - 1, -1, -1):
            nodes = [ends[0], *cuts, ends[1]]
            values = [_horner(derivatives[n], place) for place in nodes]
            signs = [1 if value > 0 else -1 for value in values]
            for i in range(1, len(nodes) - 1):
                if n or not belt:
                    if abs(values[i]) <= self.zero * terms:
                        signs[i] = 0
                else:
                    signs[i] = self.sign(values[i], terms, "the distance to a belt")
            roots = []
            before = 0
            for i in range(1, len(nodes)):
                if signs[i] == 0:
                    if n or belt or signs[before] != signs[i + 1]:
                        roots.append(nodes[i])
                elif signs[i] != signs[before] and before == i - 1:
                    roots.append(
                        _bracketed(
                            lambda s, n=n: _horner(derivatives[n], s),
                            lambda s, n=n: _horner(derivatives[n + 1], s),
                            nodes[before],
                            nodes[i],
                            signs[before] > 0,
                            self.dps,
                        )
                    )
                if signs[i]:
                    before = i
            cuts = roots
        return cuts[0] if cuts else None


class _Series:
    """Coefficients of the recurrence of the velocity's series in one band, over a step of length h."""

    def __init__(self, motion: Motion, number: int) -> None:
        band = motion.bands[number]
        cm = float(band.c / motion.m)
        w2 = float(motion.k / motion.m)
        disc = cm * cm / 4 - w2
        rate = sqrt(w2) if disc < 0 else abs(cm) / 2 + sqrt(disc)
        if motion.B0 != 0:
            rate = max(rate, float(motion.Omega))
        longest = 1.0173 * motion.span
        length = min(REACH / rate, longest) if rate else longest
        reach = max(1e-3, rate * length)
        terms = 8
        while terms * log(reach) - lgamma(terms + 1) > -(motion.dps + 4) * log(10):
            terms += 1
        self.terms = max(terms + 8, DEGREE + 3)
        h = mpmath.mpf(length)
        self.h = h
        self.motion = motion
        self.damping = _mpf(band.c)
        self.constant = _mpf(band.A)
        ratio = -_mpf(band.c / motion.m) * h
        spring = -_mpf(motion.k / motion.m) * h * h
        drive = _mpf(motion.B0 / motion.m * motion.Omega) * h * h
        turn = motion.Omega_mp * h
        self.P = []
        self.Q = []
        self.D = []
        for n in range(self.terms):
            self.P.append(ratio / (n + 2))
            self.Q.append(spring / ((n + 1) * (n + 2)))
            self.D.append(drive / ((n + 1) * (n + 2)))
            drive = drive * turn / (n + 1)
        self.parts = [1 / mpmath.mpf(n + 1) for n in range(self.terms + 2)]

    def coefficients(self, t: Any, x: Any, v: Any) -> list[Any]:
        """Return a[n] of v(t + h s) = sum a[n] s**n."""
        motion = self.motion
        force = self.constant - self.damping * v - motion.k_mp * x
        a = [v]
        if motion.B0 == 0:
            a.append(self.h * force / _mpf(motion.m))
            for n in range(self.terms):
                a.append(self.P[n] * a[n + 1] + self.Q[n] * a[n])
            return a
        cosine, sine = mpmath.cos_sin(motion.Omega_mp * t)
        a.append(self.h * (force + motion.B0_mp * cosine) / _mpf(motion.m))
        turning = (-sine, -cosine, sine, cosine)
        for n in range(self.terms):
            a.append(self.P[n] * a[n + 1] + self.Q[n] * a[n] + self.D[n] * turning[n % 4])
        return a

    def integral(self, a: list[Any], place: Any) -> Any:
        """Return the integral of the series from 0 to `place`."""
        return place * _horner([a[n] * self.parts[n] for n in range(len(a))], place)


# -- numbers and roots -----------------------------------------------------------------------------


def _mpf(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def _horner(series: Sequence[Any], place: Any) -> Any:
    total = series[-1]
    for coefficient in reversed(series[:-1]):
        total = total * place + coefficient
    return total


def _bracketed(value: Any, slope: Any, low: Any, high: Any, positive: bool, dps: int) -> Any:
    """Return the root between two places of opposite signs, the first `positive` or not.

    Newton's method, and a bisection wherever it leaves the bracket or does not halve it.
    """
    small = mpmath.mpf(10) ** (4 - dps)
    place = (low + high) / 2
    for _ in range(12 * dps):
        here = value(place)
        if here == 0:
            return place
        if (here > 0) == positive:
            low = place
        else:
            high = place
        steep = slope(place)
        following = place - here / steep if steep else low
        # A bracket that has shrunk to the rounding of its ends is a root.
        if abs(following - place) <= small * (1 + abs(place)) or high - low <= small * abs(high):
            return min(max(following, low), high)
        if not low < following < high:
            following = (low + high) / 2
        place = following
    raise UndecidedError("a root that does not converge")


def _simple_root(gap: list[Any], rounded: Any, low: float, high: float, dps: int) -> Any:
    """Return the only root in an interval: in doubles, then with all digits."""
    doubles = rounded.tolist()
    falling = [n * doubles[n] for n in range(1, len(doubles))]
    left = low
    right = high
    positive = _horner(doubles, low) > 0
    start = (low + high) / 2
    for _ in range(60):
        here = _horner(doubles, start)
        if (here > 0) == positive:
            left = start
        else:
            right = start
        steep = _horner(falling, start)
        following = start - here / steep if steep else left
        if not left < following < right:
            following = (left + right) / 2
        if abs(following - start) <= 1e-15 * start:
            break
        start = following
    place = mpmath.mpf(start)
    slopes = [n * gap[n] for n in range(1, len(gap))]
    small = mpmath.mpf(10) ** (-dps)
    for _ in range(12):
        step = _horner(gap, place) / _horner(slopes, place)
        place -= step
        if not low <= place <= high:
            break
        if abs(step) <= mpmath.sqrt(small) * abs(place) / 1000:
            return place
    return _bracketed(
        lambda s: _horner(gap, s),
        lambda s: _horner(slopes, s),
        mpmath.mpf(low),
        mpmath.mpf(high),
        positive,
        dps,
    )


@cache
def _bernstein() -> tuple[Any, Any, Any]:
    """Return what makes Bernstein coefficients of a power series, and those of its two parts."""
    n = DEGREE
    made = np.array([[comb(i, j) / comb(n, j) for j in range(n + 1)] for i in range(n + 1)])
    left = np.zeros((n + 1, n + 1))
    right = np.zeros((n + 1, n + 1))
    for i in range(n + 1):
        for j in range(i + 1):
            weight = comb(i, j) * SPLIT**j * (1 - SPLIT) ** (i - j)
            left[i, j] = weight
            right[n - i, n - i + j] = weight
    return made, left, right


def _brackets(series: Any, slack: float, last: float) -> Iterator[tuple[float, float, bool]]:
    """Yield intervals of [0, last] that hold one root, or (False) that doubles cannot judge."""
    made, left, right = _bernstein()
    waiting = [(0.0, 1.0, made @ series, 0)]
    while waiting:
        low, high, values, depth = waiting.pop()
        if low > last or values.min() > slack or values.max() < -slack:
            continue
        if np.abs(values).min() > slack:
            signs = values > 0
            if np.count_nonzero(signs[1:] != signs[:-1]) == 1:
                yield low, high, True
                continue
        if depth >= DEPTH:
            yield low, high, False
            continue
        middle = low + SPLIT * (high - low)
        waiting.append((middle, high, right @ values, depth + 1))
        waiting.append((low, middle, left @ values, depth + 1))


def _without_root(series: Any, low: float, high: float) -> int | None:
    """Return the order of the first derivative whose sign is sure on [low, high]."""
    width = high - low
    size = float(np.abs(series).sum())
    shifted = []
    derivative = series
    for n in range(MOST_DERIVATIVES + 12):
        shifted.append(float(np.polyval(derivative[::-1], low)) * width**n / factorial(n))
        derivative = derivative[1:] * np.arange(1, len(derivative))
    for n in range(MOST_DERIVATIVES):
        rest = sum(comb(j, n) * abs(shifted[j]) for j in range(n + 1, len(shifted)))
        slack = UNSURE * size * (width * DEGREE) ** n
        if isfinite(rest) and abs(shifted[n]) > rest + slack:
            return n
    return None
