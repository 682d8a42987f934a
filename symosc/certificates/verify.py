#!/usr/bin/env python3
"""Prove a certificate of a motion or of a grazing window once more: ``python verify.py FILE``.

It needs python-flint and nothing of symosc (orbits and branches: verify_orbits.py). The page "The
format of certificates" has the equation of motion, what each kind of file states, and the exit
codes. Balls (arb) prove it:

1. Friction is linear in v between edges, which are the speeds of belts and of the corners of
   friction curves. So in each band between two edges, and in each stick on a belt, z = (x, v, 1,
   cos Omega t, sin Omega t) solves z' = M z, and z(t + s) = exp(s M) z(t). Such a mode ends when a
   function f = row z reaches 0: the distance of v from an edge or, on a belt, E + F below it or E -
   F above it, where E is the excess of static over kinetic friction. (E = 0 and two edges for the
   eleven parameters.)
2. f > 0 from a to a + h if f + f' h - B h^2/2 > 0 at a and h, |f''| <= B all the way; and up to b
   as well if that is so for h = (b - a)/2, both from a onwards and from b backwards. After a start
   with f = ... = 0, f > 0 while the next derivative is > 0, which is shown in the same way. In
   flights u = f^(n) solves u'' + (c/m) u' + (k/m) u = r with
   |r| <= D = |B0| Omega^(n+1)/m, with the c of the band. For c < 0 it may grow, in a time h by g =
   exp(-c h/m), else g = 1. So |u| is at most g ((u^2 + (m/k) u'^2)^(1/2) + h D (m/k)^(1/2)) for a
   time h, by its energy; and, with l = g h, or the smaller one of h and m/c if c > 0, (|u| + g h
   |u'| + h l D)/(1 - h l k/m) if the divisor is > 0. On a belt |F^(n)| <= |B0| Omega^n/m, and it
   changes by h |B0| Omega^(n+1)/m at most; F without its drive changes by |k v| h/m.
3. In an event f > 0 at one time, f < 0 at a later one, f' < 0 between them. The other f is a
   constant less this one, so it grows. Where a flight meets a belt with F > 0 (it comes from
   below), it crosses if F above > E, and else sticks; at F above = E it sticks if that force then
   falls. A stick ends in a flight with F = -E below or E above the belt. An edge without belt is
   crossed.
4. A graze of a belt with E = 0 (another one holds what touches it): for all starts from low to high
   f > 0 > f' at one time, f > 0 and f' > 0 at a later one, and f'' > 0 between them. The least f is
   > 0 for one of low and high, < 0 for the other, and its derivative by the start (that of f) is
   not 0: one start touches. If c = B0 = 0, v^2 + v'^2 m/k is constant: if it is the belt's speed
   squared, f = 0 at a least f, as v is not beyond that speed; and it says v'^2 at a belt exactly.
5. With a start_error the states after an event are f(centre) + D (start - centre), D the
   derivatives of all starts.
6. "settled": let B be the box of the first event of `cycle`, c its middle, e its half-widths, P the
   motion from B to the last event of `cycle`, less the periods. If all motions from B have these
   events, and P(B) lies in B, each motion that comes into B has them again and again. If D contains
   the derivatives of P over B and |D| e <= q e, q < 1, P is a contraction: it has one fixed point c
   + u in B, u = (1 - D)^-1 (P(c) - c). After n cycles a motion is within 2 q^n e of it.
   `may_stick_until`: all starts leave the belt to one side, where F falls to 0, before that time.
7. Derivatives by a number q, of exact starts without a graze: z_q' = M z_q + M_q z at fixed times
   after an event, where x_q = dx - v dt, v_q = dv - v' dt. The next event has dt = -(row_q z + row
   z_q)/f', dx = x_q + v dt. They exist, as f' and the forces after an event are not 0 (3 above),
   nor is a force on the belt where a motion begins.
8. "window": with f = f' = 0 at a contact, m f'' = s, s = side (k v + B0 Omega sin theta), side = 1
   below the belt, -1 above it. It grazes where s > 0, not where s < 0. At a zero of s with cos
   theta != 0 the motion passes. Where |k v| =
   |B0| Omega, s = 0 at one phase, and there f'''' has the sign of side k v, which decides in the "full" order.

The letters of the code are those above. `data` is the content of a file, with its numbers read;
`source` is the same content as it is, with texts; `limits` has the most bytes, events and steps;
`where` names an entry of the file.
"""

import argparse
import json
import os
import re
import sys
from bisect import bisect_right
from fractions import Fraction
from functools import cache
from itertools import pairwise
from threading import RLock
from typing import Any, NamedTuple

from flint import arb, arb_mat, ctx, fmpq, fmpq_mat

FORMAT = "symosc certificate 1"
KINDS_OF_EVENTS = {"cross", "stick", "slip", "graze"}
CORNER = "corner"
# The most belts of a friction law, and points of all their curves.
MOST_BELTS = 50
MOST_POINTS = 20_000
NUMBER = re.compile(r"-?\d{1,2000}(/\d{1,2000}|(\.\d{1,2000})?(e[+-]?\d{1,3})?)", re.ASCII)
NAMES = ("m", "c", "k", "A0", "B0", "Omega", "v1", "v2", "mu1", "mu2", "FN")
START = ("t0", "x0", "v0")
MODES = ("", "Omega1", "Omega2", "Omega3", "belt1", "belt2")
LIMITS = {"bytes": 10**7, "events": 50_000, "steps": 2_000_000}
# Orders of the derivatives of f that are known, and of a force on a belt that may be exactly 0 at a
# start: `Mode.stays` takes three more orders than that by which v leaves the belt.
ORDERS = 12
MOST_ZEROS = ORDERS - 5
TINY = fmpq(1, 10**100)
# A step that is shorter fails because f < 0 soon, which is then looked at.
TOO_NEAR = 2.0**-20
# How often to look further away from an event for the signs of f there.
WIDENINGS = 40
# Of the precision, which is doubled from FIRST_BITS on where a sign is open.
FIRST_BITS = 256
MOST_BITS = 2048
MOST_BITS_IF_EXACT = 4096
# The most events stated of the end of a motion that settles, and the most forcing periods.
MOST_LAST = 1000
MOST_PERIODS = 10_000
OPEN, FALSE, BAD = range(3)
# The components of z.
X, V, ONE, COS, SIN = range(5)
#: Held while the precision of flint, which all threads share, is changed.
LOCK = RLock()


class Stop(Exception):
    """Raised if no proof is found.

    Its code: OPEN (more bits may decide), FALSE (false or unproven), BAD (bad file).
    """


def check(good, what, code=FALSE):
    """Raise Stop with a code and the text `what` unless the condition `good` holds."""
    if not good:
        raise Stop(code, what)


def require(value, what):
    """Raise Stop with the text `what` unless a ball is > 0.

    Its code is FALSE if all of the ball is < 0, else OPEN.
    """
    check(value > 0, what, FALSE if value < 0 else OPEN)


def inside(value, ends):
    """Raise Stop unless a ball is between the two `ends` that a file states; if both are 0, it must
    be exactly 0.
    """
    if not (ends[0] == ends[1] == 0 and value.is_zero()):
        require(value - arb(ends[0]), "a number is not above the lower end stated")
        require(arb(ends[1]) - value, "a number is not below the upper end stated")


# -- the shape of a file ---------------------------------------------------------------------------


def number(value, where):
    """Read a number given as text, a decimal or a fraction, as an exact fmpq.

    `where` names the entry of the file.
    """
    if type(value) is str and NUMBER.fullmatch(value):
        exact = fmpq(*Fraction(value).as_integer_ratio())
    else:
        exact = None
    right = exact is not None and (exact == 0 or TINY <= abs(exact) <= 1 / TINY)
    check(
        right,
        f"{where}: {str(value)[:40]!r} is no decimal or fraction between 1e-100 and 1e100",
        BAD,
    )
    return exact


def interval(value, where):
    """Read a list of two texts as the lower and the upper end of an enclosure, which is open.

    `where` names the entry of the file.
    """
    low, high = read(value, (number, number), where)
    check(low < high, f"{where}: the lower end is not below the upper one", BAD)
    return low, high


def read(value, shape, where):
    """Return a part of a file with its texts turned into numbers; raise Stop unless it has a
    `shape` as in SHAPES.

    A shape is a dict of shapes by key, a type, a set of the values allowed, a list with the shape
    of all its entries, a tuple with the shape of each entry, or a function that reads the value.
    """
    if isinstance(shape, dict):
        check(type(value) is dict, f"{where} is no object", BAD)
        wrong = sorted(value.keys() ^ shape.keys(), key=str)
        check(not wrong, f"{where}: a missing or an unknown key, {str(*wrong[:1])[:40]!r}", BAD)
        return {key: read(value[key], shape[key], f"{where}.{key}") for key in shape}
    if isinstance(shape, type):
        check(type(value) is shape, f"{where}: {str(value)[:40]!r} is no {shape.__name__}", BAD)
        return value
    if isinstance(shape, set):
        check(
            any(type(value) is type(allowed) and value == allowed for allowed in shape),
            f"{where}: {str(value)[:40]!r}",
            BAD,
        )
        return value
    if isinstance(shape, list | tuple):
        right = type(value) is list and (isinstance(shape, list) or len(value) == len(shape))
        check(right, f"{where} is no list, or not as long as it must be", BAD)
        shapes = shape * len(value) if isinstance(shape, list) else shape
        return [
            read(entry, of_entry, f"{where}[{i}]")
            for i, (entry, of_entry) in enumerate(zip(value, shapes, strict=True))
        ]
    return shape(value, where)


def optional(value, where):
    """Read a number or, if the entry of the file is null, return None; `where` names the entry."""
    if value is None:
        return None
    return number(value, where)


WHAT = {
    "kind": KINDS_OF_EVENTS,
    "boundary": {1, 2},
    "source": set(MODES[1:]),
    "target": set(MODES[1:]),
}
ENCLOSED = {"t": interval, "x": interval}
EVENTS = [WHAT | ENCLOSED]
MOTION = {
    "parameters": dict.fromkeys(NAMES, number),
    "start": dict.fromkeys(START, number),
    "t_end": number,
}
MOTION |= {"start_error": (number,) * 3, "mode": set(MODES[1:]), "events": EVENTS}
ALL_STARTS = {"starts": {"all"}}
SOME_STARTS = {
    "starts": {"some"},
    "free": {"name": set(START), "low": number, "high": number},
}
SHAPES = {
    "trajectory": MOTION | ALL_STARTS,
    "some": MOTION | SOME_STARTS,
    "settled": MOTION
    | {"may_stick_until": optional, "cycle": EVENTS, "periods": int, "count": int, "last": EVENTS},
    "window": {
        "parameters": MOTION["parameters"],
        "map": {"P2", "P3", "P5", "P6"},
        "order": {"full", "paper"},
    }
    | {"grazes": {"nowhere", "everywhere", "everywhere but at one phase", "on an arc"}}
    | {"ends": [{"phase": interval, "sine": number, "cosine": {-1, 0, 1}}]},
}
CHANGES = {"wrt": [{*NAMES, *START}], "derivatives": [{"dt": [interval], "dx": [interval]}]}
SHAPES["derivatives"] = SHAPES["trajectory"] | CHANGES
# A law of any belts, in place of the eleven parameters, and the shapes of the files about it; these
# depend on how many belts there are.
BELT = {"v": number, "curve": [(number, number)], "slope": number, "mu_s": number}
LAW = dict.fromkeys(("m", "c", "k", "A0", "B0", "Omega", "FN"), number) | {"belts": [BELT]}


def law_what(belts):
    """Return the shape of the first entries of an event, by the number of belts of a law."""
    names = {f"Omega{n}" for n in range(1, belts + 2)} | {f"belt{n}" for n in range(1, belts + 1)}
    return {
        "kind": KINDS_OF_EVENTS | {CORNER},
        "boundary": int,
        "source": names,
        "target": names,
    }


def law_motion(what):
    """Return the shape of a motion of a law, given that of the first entries of an event."""
    return MOTION | {"parameters": LAW, "mode": what["source"], "events": [what | ENCLOSED]}


LAW_SHAPES = {
    "trajectory": lambda what: law_motion(what) | ALL_STARTS,
    "some": lambda what: law_motion(what) | SOME_STARTS,
}


# -- motions ---------------------------------------------------------------------------------------


class StatedEdge(NamedTuple):
    """A speed `v` at which friction jumps, or its slope: that of a belt, or of a corner.

    `belt` is the number of the belt, 0 at a corner; `excess` is by how much static friction exceeds
    kinetic friction, as an acceleration.
    """

    v: Any
    belt: int
    excess: Any


class StatedBand(NamedTuple):
    """Between two edges m x'' + c x' + k x = A + B0 cos(Omega t), in a domain between two belts."""

    c: Any
    A: Any
    domain: int


class StatedLaw:
    """The friction law that parameters state: edges in order of speed, and the bands between them.

    Edge i, from 1 on, is between bands i and i + 1. `belts` and `corners` have the edges of these.
    """

    def __init__(self, p):
        belts = belts_of(p)
        speeds = [belt["v"] for belt in belts]
        corners = {
            belt["v"] + side * w for belt in belts for w, _ in belt["curve"][1:] for side in (1, -1)
        }
        places = sorted(corners.union(speeds))
        bands = [band_between(p, *ends) for ends in pairwise([None, *places, None])]
        self.edges: list[Any] = [None]
        self.bands: list[Any] = [None, bands[0]]
        self.belts: list[int] = []
        self.corners: list[int] = []
        for speed, band in zip(places, bands[1:], strict=True):
            if speed in speeds:
                belt = belts[speeds.index(speed)]
                (_, mu) = belt["curve"][0]
                excess = (belt["mu_s"] - mu) * p["FN"] / p["m"]
                edge = StatedEdge(speed, speeds.index(speed) + 1, excess)
            elif band == self.bands[-1]:  # one equation on both sides: this is no corner
                continue
            else:
                edge = StatedEdge(speed, 0, fmpq(0))
            numbers = self.belts if edge.belt else self.corners
            numbers.append(len(self.edges))
            self.edges.append(edge)
            self.bands.append(band)

    @property
    def last(self):
        """The number of the last band, which is also that of all bands."""
        return len(self.bands) - 1

    def band_of(self, v):
        """Return the number of the band of a velocity that is not the speed of an edge."""
        return 1 + sum(v > edge.v for edge in self.edges[1:])

    def edge_of(self, v):
        """Return the number of the edge with the speed v, 0 if there is none."""
        return next((i for i, edge in enumerate(self.edges[1:], 1) if edge.v == v), 0)

    def name(self, number):
        """Return the name of the mode with a number: a band, or a stick at an edge, behind the bands."""
        if number <= self.last:
            return f"Omega{self.bands[number].domain}"
        return f"belt{self.edges[number - self.last].belt}"


def belts_of(p):
    """Return the belts of a law; those of the eleven parameters have friction that is constant."""
    if "belts" in p:
        return p["belts"]
    return [
        {"v": p[f"v{n}"], "curve": [(fmpq(0), mu)], "slope": fmpq(0), "mu_s": mu}
        for n, mu in ((1, p["mu1"]), (2, p["mu2"]))
    ]


def band_between(p, below, above):
    """Return the `StatedBand` between the speeds of two edges next to each other (None: there is none)."""
    if below is None:
        inside = above - 1
    elif above is None:
        inside = below + 1
    else:
        inside = (below + above) / 2
    c = p["c"]
    A = p["A0"]
    domain = 1
    for belt in belts_of(p):
        speed = belt["v"]
        if inside > speed:
            side = -1
            domain += 1
        else:
            side = 1
        # The force of the belt is side FN (mu + slope w), and w = side (speed - v).
        mu, slope = friction_line(belt, side * (speed - inside))
        c += p["FN"] * slope
        A += p["FN"] * (side * mu + slope * speed)
    return StatedBand(c, A, domain)


def friction_line(belt, w):
    """Return the numbers a and b of a belt's friction a + b w in the part of its curve that has w."""
    points = belt["curve"]
    i = bisect_right(points, w, key=lambda point: point[0]) - 1
    (begin, mu) = points[i]
    slope = belt["slope"]
    if i + 1 < len(points):
        (end, next_mu) = points[i + 1]
        slope = (next_mu - mu) / (end - begin)
    return mu - slope * begin, slope


def check_range(p):
    """Raise Stop unless the numbers of an oscillator are within the model."""
    least = min(p[name] for name in ("c", "k", "FN"))
    right = min(p["m"], p["Omega"]) > 0 <= least
    belts = belts_of(p)
    points = sum(len(belt["curve"]) for belt in belts)
    check(points <= MOST_POINTS, f"curves of more than {MOST_POINTS} points", BAD)
    for belt in belts:
        ws = [w for w, _ in belt["curve"]]
        right = right and ws[:1] == [0] and all(a < b for a, b in pairwise(ws))
        right = right and min(mu for _, mu in belt["curve"]) >= 0
        right = right and belt["slope"] >= 0 and belt["mu_s"] >= belt["curve"][0][1]
    right = right and all(a["v"] < b["v"] for a, b in pairwise(belts))
    what = "m, Omega > 0; c, k, FN and friction >= 0; belts in order of speed, static friction not"
    check(right, f"parameters out of range: {what} below kinetic friction", BAD)


class StatedOscillator:
    """An oscillator: its parameters `p`, its friction law, its modes by their number, and the limits
    of the work spent on a proof.
    """

    def __init__(self, p, limits):
        check_range(p)
        self.p = p
        self.limits = limits
        corners = 2 * sum(len(belt["curve"]) - 1 for belt in belts_of(p))
        if corners:  # a step for the band behind each of them
            self.step(corners)
        self.law = StatedLaw(p)
        self.mode = cache(lambda i: Mode(p, self.law, i))

    def step(self, count=1):
        """Add `count` steps to the work done; raise Stop if that is more than the limit."""
        self.limits["left"] -= max(1, count) * max(1, ctx.prec // FIRST_BITS)
        check(self.limits["left"] > 0, f"more than {self.limits['steps']} steps (--steps)")

    def edge(self, row):
        """Return the number of the edge of a row of the file: of a belt, or of a corner."""
        numbers = self.law.belts
        if row["kind"] == CORNER:
            numbers = self.law.corners
        known = 0 < row["boundary"] <= len(numbers)
        check(known, "an event at a belt or a corner that there is not")
        return numbers[row["boundary"] - 1]

    def amplitude_of_slip(self, edge, band):
        """Return the `amplitude` of a motion that slips from a belt into a band, None if it is not
        constant: v' is the excess of static friction in size.
        """
        if not self.circles(self.mode(band)):
            return None
        (v, _, excess) = self.law.edges[edge]
        return v**2 + excess**2 * self.p["m"] / self.p["k"]

    def circles(self, mode):
        """Return whether v and v' go round an ellipse in a mode: it flies without damping and drive."""
        return mode.flies and self.law.bands[mode.number].c == self.p["B0"] == 0 < self.p["k"]


class Mode:
    """A mode of motion: the state z = (x, v, 1, cos Omega t, sin Omega t) solves z' = M z, until a
    function f is 0.

    Each f is a row times z: the distance of v from an edge or, on a belt, the force F below it plus
    the excess of static friction, or that excess less the force F above it. The products rows[n] z
    are the n-th derivatives of all f. `ends` are the edges of a flight, or the bands into which a
    stick ends.
    """

    # a bound of the steady velocity, if there is one; `free` is then the row of v less the steady
    # one
    steady = None

    def __init__(self, p, law, number):
        m, k, B0, Om = (p[name] for name in ("m", "k", "B0", "Omega"))

        def force(band):
            """Return the row of F = v' in a band."""
            (c, A, _) = law.bands[band]
            return [-k / m, -c / m, A / m, B0 / m, fmpq(0)]

        self.number = number
        self.name = law.name(number)
        self.flies = number <= law.last
        if self.flies:  # the distance from each edge around the band
            rows = {
                edge: [0, side, -side * law.edges[edge].v, 0, 0]
                for edge, side in ((number - 1, 1), (number, -1))
                if 0 < edge < law.last
            }
            F = force(number)
            c = law.bands[number].c
        else:  # by the band into which the mass then slips
            edge = number - law.last
            excess = law.edges[edge].excess
            held = [0, 0, excess, 0, 0]
            rows = {
                edge: [f + e for f, e in zip(force(edge), held, strict=True)],
                edge + 1: [e - f for f, e in zip(force(edge + 1), held, strict=True)],
            }
            F = [0] * 5
            c = fmpq(0)
        self.ends = list(rows)
        self.row = fmpq_mat(list(rows.values()))
        self.exact = fmpq_mat([[0, 1, 0, 0, 0], F, [0] * 5, [0, 0, 0, 0, -Om], [0, 0, 0, Om, 0]])
        self.M = arb_mat(self.exact)
        # rows[n] of the n-th derivative, drive[n] a bound of that of the drive; `lag` is m/c.
        self.rows = [arb_mat(self.row * self.exact**order) for order in range(ORDERS)]
        self.km = arb(k / m)
        if c > 0:
            self.lag = arb(m / c)
        else:
            self.lag = arb.pos_inf()
        # what is without damping, or grows: the rate at which it may grow
        self.growth = arb(max(-c, fmpq(0)) / m)
        self.drive = [arb(abs(B0) * Om**order / m) for order in range(ORDERS + 1)]
        pull = k - m * Om * Om
        drag = c * Om
        square = pull * pull + drag * drag
        # The steady motion is the answer to the drive; a flight tends to it where k > 0 and c >= 0.
        if self.flies and k > 0 and square > 0 and c >= 0:
            self.steady = arb(abs(B0) * Om) / arb(square).sqrt()
            self.free = arb_mat(
                fmpq_mat([[0, 1, 0, -B0 * Om * drag / square, B0 * Om * pull / square]])
            )

    def bound(self, z, n, h):
        """Return a number that |f^(n)|, n > 1, does not exceed for a time `h` after the state z,
        for each f.
        """
        # All f of a mode have the same derivatives but for the sign: f^(n) and f^(n+1) at z.
        u, u_slope = (abs((rows * z)[0, 0]).upper() for rows in self.rows[n : n + 2])
        D = self.drive[n + 1]
        if not self.flies:
            return self.drive[n].min(u + h * D)
        grown = (h * self.growth).exp()  # g in 2 above
        lag = grown * h.min(self.lag)  # l in 2 above, as `divisor` and both bounds
        divisor = 1 - h * lag * self.km
        by_energy = arb.pos_inf()
        if self.km > 0:
            by_energy = (u * u + u_slope * u_slope / self.km).sqrt() + h * D / self.km.sqrt()
            by_energy = grown * by_energy
        if divisor > 0:
            return by_energy.min((u + grown * h * u_slope + h * lag * D) / divisor)
        return by_energy

    def settles(self, z):
        """Return whether a flight certainly never meets a belt after the state z, by a bound of its
        velocity.
        """
        if self.steady is None:
            return False
        # w = v less the steady velocity; w^2 + w'^2 m/k, an energy, does not grow.
        w, rate = (abs((row * z)[0, 0]).upper() for row in (self.free, self.free * self.M))
        most = self.steady + (w * w + rate * rate / self.km).sqrt()
        # f is +-v plus a constant, so it is not below the constant less `most`.
        return all(arb(self.row[i, ONE]) - most > 0 for i in range(len(self.ends)))

    def stays(self, z, h, orders, after=None):
        """Return whether the mode certainly lasts for a time `h` after the state z, as all its f
        stay > 0.

        `orders` has, by the ends of the mode, the order of the first derivative that is not 0 of
        each f that is 0 at z. `after` is the state at the end of that time, if it is known.
        """
        # With both ends known each one vouches for the half of the time next to it.
        if after is None:
            half = h
        else:
            half = h / 2
        for i, end in enumerate(self.ends):
            n = orders.get(end, 0)  # f, or its first derivative that is not 0
            f = (self.rows[n] * z)[i, 0]
            slope = (self.rows[n + 1] * z)[i, 0]
            bend = self.bound(z, n + 2, h)
            sure = f > 0 and f + slope * half - bend * half * half / 2 > 0
            if not (self.flies or n):  # F at its least: the drive against it, and x from now on
                row = self.rows[0]
                least = f - row[i, COS] * z[COS, 0] - self.drive[0] - abs(row[i, X] * z[V, 0]) * h
                if least > 0:
                    continue
            if sure and after is not None:
                f = (self.rows[n] * after)[i, 0]
                slope = (self.rows[n + 1] * after)[i, 0]
                sure = f > 0 and f - slope * half - bend * half * half / 2 > 0
            if not sure:
                return not orders and self.settles(z)
        return True


class Around(NamedTuple):
    """A ball of times around an event, and f, f' and f'' at its lower end, at its upper end, and on
    all of it.
    """

    times: Any
    before: Any
    behind: Any
    during: Any


class Starts(NamedTuple):
    """A set of starts (t, x, v), as in `VerifiedMotion`."""

    centre: Any
    columns: Any
    rest: Any


class Next(NamedTuple):
    """What follows an event: its kind, the number of the next mode, and `leaves` of the next
    motion.
    """

    kind: str
    mode: int
    leaves: Any


class VerifiedMotion:
    """The motions in one mode from a set of starts (t, x, v): `centre` plus each side times any
    number in [-1, 1].
    """

    # The sides are vectors: `columns` contain the derivatives with respect to the first start; or,
    # if there is a `rest` of sides, exact numbers near them, so that the set of a long motion does
    # not grow by what is not known of the derivatives. `leaves` are the ends whose f is 0 at the
    # start, and the order of the first derivative that is not. `amplitude` is v^2 + v'^2 m/k, where
    # that is constant and known. `rests` is True where the mass surely rests on a belt for ever.

    rests = False

    def __init__(
        self, problem, mode, edge, centre, columns=(), leaves=None, amplitude=None, rest=None
    ):
        self.problem = problem
        self.mode = problem.mode(mode)
        self.edge = edge
        self.centre = centre
        self.columns = columns
        self.rest = rest
        sides = [*columns, *(rest or ())]
        self.t, x, v = (
            c + sum((side[i] * arb(0, 1) for side in sides), arb(0)) for i, c in enumerate(centre)
        )
        p = problem.p
        self.origin = self.t.lower()
        self.leaves = leaves or {}
        self.x = x
        cosine, sine = (arb(p["Omega"]) * self.t).sin_cos()[::-1]
        self.first = arb_mat([[x], [v], [1], [cosine], [sine]])
        # All motions are followed from one time on, the earliest start: z0 encloses the states that
        # they come from there.
        back = (self.origin - self.t).union(arb(0))
        rate = self.mode.M * self.first
        bend = self.mode.M * (self.mode.M * back).exp() * rate
        # By Taylor's theorem: where F is small, so is its error.
        self.z0 = self.first + rate * back + bend * (back * back / 2)
        # After a graze (f = f' = 0) v' is 0 at the belt's speed: the amplitude is its square.
        if problem.circles(self.mode) and max(self.leaves.values(), default=0) > 1:
            self.amplitude = problem.law.edges[edge].v ** 2
        else:
            self.amplitude = amplitude

    def at(self, t):
        """Return the state z = (x, v, 1, cos, sin) at a time, or an enclosure of it for a ball of
        times.
        """
        self.problem.step()
        z = (self.mode.M * (t.mid() - self.origin)).exp() * self.z0
        if t.is_exact():
            return z
        return (self.mode.M * (t - t.mid())).exp() * z

    def f(self, end, t):
        """Return f (0 where the mode ends at `end`), f' and f'' at a time or, by Taylor's theorem,
        on a ball.
        """
        i = self.mode.ends.index(end)
        z = self.at(t.mid())
        change = t - t.mid()
        f = [(row * z)[i, 0] for row in self.mode.rows[:4]]
        if t.is_exact():
            return f[:3]
        flow = (self.mode.M * change).exp()
        # Derivatives of z, so that what cancels in them does so before the times differ.
        z = self.mode.M * z
        bend = []
        for _ in range(3):
            z = self.mode.M * z
            bend.append((self.mode.rows[0] * (flow * z))[i, 0] * change * change / 2)
        return [f[n] + f[n + 1] * change + bend[n] for n in range(3)]

    def positive(self, until):
        """Prove that the mode lasts from the start until a time, as all f (distances or forces) are
        > 0.
        """
        require(until - self.t, "an event or the end is not after the event before it")
        if self.rests:
            return
        a = self.origin
        orders = self.leaves  # of the first step alone: from then on all f are > 0
        last = self.at(until)
        h = until - self.origin
        while True:
            z = self.at(a)
            h = 4 * h  # try a longer step than the last one, then halves of it
            while True:
                ends = not a + h < until
                if ends:
                    b = until
                else:
                    b = (a + h).mid()
                after = last if ends and not orders else None
                if self.mode.stays(z, b - a, orders, after):
                    break
                h = ((b - a) / 2).mid()
                # So short a step fails where f < 0 soon: then more bits are no help.
                if h < TOO_NEAR:
                    beyond = self.mode.rows[0] * self.at((a + 4 * h).min(until).mid())
                    check(
                        not any(f < 0 for f in beyond.entries()),
                        "the mode ends before the next event or t_end",
                    )
                check(a + h > a and h > arb(2) ** (-ctx.prec // 2), "a touch or a near miss", OPEN)
            if ends and not orders:
                return
            orders = {}
            h = b - a
            a = b

    def zero(self, end, order, times):
        """Narrow the enclosure `times` of the time at which f (order 0) or f' (order 1) of an end
        of the mode is 0, by interval Newton.
        """
        while True:
            step = times.mid() - self.f(end, times.mid())[order] / self.f(end, times)[order + 1]
            check(step.overlaps(times), "where an event is", OPEN)
            before = times
            times = step.intersection(times)
            if not times.rad() < before.rad() / 2:
                return times

    def moved(self, t, sides):
        """Return how the state z at a time changes if the start moves along each of `sides`,
        vectors (dt, dx, dv).
        """
        e = (self.mode.M * (t - self.t)).exp()
        rate = self.mode.M * self.first
        # A start that is later by dt is one at the same time with another x and v.
        return [
            e * arb_mat([[dx - rate[X, 0] * dt], [dv - rate[V, 0] * dt], [0], [0], [0]])
            for dt, dx, dv in sides
        ]

    def after_event(self, row, limits=()):
        """Prove that the event in a `row` of the file is next.

        Return the motion after it (`limits`: see `graze`).
        """
        if row["kind"] == "graze":
            return self.graze(row, limits)
        mode = self.mode
        law = self.problem.law
        edge = self.problem.edge(row)
        if mode.flies:
            end = edge
            check(end in mode.ends, "an event at a belt that is not beside the domain")
            once = "that v meets a belt once at an event"
        else:
            bands = {law.name(band): band for band in mode.ends}
            check(
                row["target"] in bands and edge == self.edge, "the end of a stick on another belt"
            )
            edge = self.edge
            end = bands[row["target"]]
            once = "that F meets 0 once at the end of a stick"
        around = self.around(end, row, -1)
        (_, slope, _) = around.during
        require(-slope, once)
        when = self.zero(end, 0, around.times)
        starts = self.arrive(end, edge, when)
        amplitude = None
        if mode.flies:
            kind, then, leaves = self.follows_exactly(edge) or self.follows(edge, starts)
        else:
            kind = "slip"
            then = end
            leaves = {edge: order_of_leaving(law.edges[edge], 1)}
            amplitude = self.problem.amplitude_of_slip(edge, then)
        self.require_row(row, kind, then)
        return type(self)(
            self.problem,
            then,
            edge,
            starts.centre,
            starts.columns,
            leaves=leaves,
            amplitude=amplitude,
            rest=starts.rest,
        )

    def follows_exactly(self, edge):
        """Return what follows where a flight meets an edge with exactly the force up to which the
        belt holds; None if it has another one, or is not known so well.
        """
        mode = self.mode
        law = self.problem.law
        if self.amplitude is None or not self.problem.circles(mode):
            return None
        beyond = 2 * edge + 1 - mode.number
        onward = 1 if mode.number == edge else -1
        v = law.edges[edge].v
        # How large F is that the other side of the edge and static friction just hold.
        (here, there) = (law.bands[band] for band in (mode.number, beyond))
        drop = onward * ((here.A - here.c * v) - (there.A - there.c * v)) / self.problem.p["m"]
        limit = drop + law.edges[edge].excess
        square = (self.amplitude - v * v) * self.problem.p["k"] / self.problem.p["m"]
        if square != limit * limit or v == 0:
            return None
        # From now on the spring pulls more by k v, if the mass sticks.
        if onward * v > 0:
            return Next("stick", law.last + edge, {beyond: 1})
        return Next("cross", beyond, {edge: order_of_leaving(law.edges[edge], 1)})

    def follows(self, edge, starts):
        """Return what follows where a flight meets an edge: the kind of event, the next mode, and
        its `leaves`.
        """
        mode = self.mode
        law = self.problem.law
        there = VerifiedMotion(
            self.problem, mode.number, edge, starts.centre, starts.columns, rest=starts.rest
        ).first
        # F on this side of the edge, and on the other side, where friction is another one. If both
        # push the mass on, and the latter more than the excess of static friction holds it back,
        # the mass crosses, from one of the bands beside the edge, whose numbers are `edge` and
        # `edge + 1`, into the other.
        beyond = 2 * edge + 1 - mode.number
        onward = 1 if mode.number == edge else -1
        F = onward * (mode.M * there)[V, 0]
        F_beyond = onward * (self.problem.mode(beyond).M * there)[V, 0]
        both = F * (F_beyond - arb(law.edges[edge].excess))
        require(abs(both), "F at a belt, and behind it")
        if both > 0:
            kind = "cross" if law.edges[edge].belt else CORNER
            return Next(kind, beyond, {edge: 1})
        return Next("stick", law.last + edge, {})

    def around(self, end, row, turn):
        """Return a ball of times around an event and its f (`Around`), of which the signs are
        proven.

        The event is where f of the mode's `end` is 0. f > 0 is proven before it, and turn * f > 0
        after it.
        """
        low = arb(row["t"][0]).lower()
        high = arb(row["t"][1]).upper()
        for _ in range(WIDENINGS):
            first = self.f(end, low)
            last = self.f(end, high)
            are_as_stated = first[0] > 0 and turn * last[0] > 0
            if not self.columns or are_as_stated:
                break  # else the signs are rough, as the starts are a box: look further away
            # Five times as wide.
            low, high = (3 * low - 2 * high).mid(), (3 * high - 2 * low).mid()
        require(first[0], "the sign of f before an event")
        require(turn * last[0], "the sign of f behind an event (a touch has none)")
        self.positive(low)
        return Around(low.union(high), first, last, self.f(end, low.union(high)))

    def arrive(self, end, edge, when):
        """Return the set of the states (t, x, v), at times in `when`, in which the mode ends: the
        function f of that end is 0.
        """
        v = arb(self.problem.law.edges[edge].v)
        sides = []
        (_, slope, _) = self.f(end, when)
        i = self.mode.ends.index(end)
        count = len(self.columns)
        # Where z moves by dz, f is 0 later by dt (implicit function theorem).
        for dz in self.moved(when, [*self.columns, *(self.rest or ())]):
            dt = -(self.mode.rows[0] * dz)[i, 0] / slope
            sides.append((dt, dz[X, 0] + v * dt, arb(0)))
        columns = sides[:count]
        thin = VerifiedMotion(self.problem, self.mode.number, self.edge, self.centre)
        t = thin.zero(end, 0, when)
        x = thin.at(t)[X, 0]
        centre = t, x, v
        if self.rest is None:
            return Starts(centre, columns, None)
        # Exact numbers from here on; the radii that they lose are sides of the rest.
        lost_t, lost_x = (
            sum((vector[i].rad() for vector in (centre, *columns)), arb(0)).upper() for i in (0, 1)
        )
        rest = [*sides[count:], (lost_t, arb(0), arb(0)), (arb(0), lost_x, arb(0))]
        exact = [[component.mid() for component in side] for side in columns]
        return Starts([t.mid(), x.mid(), v], exact, frame(rest))

    def graze(self, row, limits):
        """Prove that the next event is a graze, as stated in a row of the file.

        Return the motion after it.

        If only one start grazes, `limits` has the motions from the lowest and the highest start.
        """
        end = self.problem.edge(row)
        mode = self.mode
        check(mode.flies and end in mode.ends, "a graze of a belt that is not beside the domain")
        speed = self.problem.law.edges[end].v
        check(
            self.problem.law.edges[end].excess == 0,
            "a graze of a belt with static friction, which holds what touches it",
        )
        check(limits or self.amplitude == speed**2, "a graze of no start")
        around = self.around(end, row, 1)
        times = around.times
        (_, falls, _) = around.before
        (_, rises, _) = around.behind
        (_, _, bend) = around.during
        require(-falls, "that v comes nearer to a belt before a graze")
        require(rises, "that v goes away from a belt after a graze")
        require(bend, "that v turns once at a graze")
        when = self.zero(end, 1, times)
        self.require_row(row, "graze", mode.number)
        x = self.at(when)[X, 0]
        if limits:
            low, high = (motion.distance_at_turn(end, times) for motion in limits)
            require(-low * high, "that one start goes beyond the belt, and one does not reach it")
            (dz,) = self.moved(when, self.columns)
            require(
                abs((mode.rows[0] * dz)[mode.ends.index(end), 0]), "that only one start touches"
            )
        else:
            x = arb(-mode.exact[V, ONE] / mode.exact[V, X])  # where F = 0
        centre = [when, x, arb(speed)]
        columns = []
        if self.columns or limits:
            centre = [when.mid(), x.mid(), arb(speed)]
            columns = [(arb(when.rad()), arb(0), arb(0)), (arb(0), arb(x.rad()), arb(0))]
        return VerifiedMotion(
            self.problem, mode.number, end, centre, columns, leaves={end: 2}, rest=[]
        )

    def distance_at_turn(self, end, times):
        """Enclose the distance f of v from the belt `end` at the one time in `times` at which f' is
        0.

        It is the least distance if f'' > 0 in `times`, which `graze` proves.
        """
        when = self.zero(end, 1, times)
        f_at_middle = self.f(end, when.mid())[0]
        (_, slope, _) = self.f(end, when)
        return f_at_middle + slope * (when - when.mid())

    def require_row(self, row, kind, then):
        """Raise Stop unless a row of the file states an event of this kind, from this mode to the
        mode `then`.
        """
        stated = row["kind"], row["source"], row["target"]
        then = self.problem.law.name(then)
        check(stated == (kind, self.mode.name, then), f"{kind}: {self.mode.name} to {then}")

    def within(self, row):
        """Prove that t and x of the start lie between the ends stated in a row of the file.

        Return this motion.
        """
        inside(self.t, row["t"])
        inside(self.x, row["x"])
        return self

    def from_centre(self, factors):
        """Return t and x of one start: the centre plus each of the columns times its factor."""
        moved = [
            [factor * component for component in column]
            for factor, column in zip(factors, self.columns, strict=True)
        ]
        return [sum((column[i] for column in moved), c) for i, c in enumerate(self.centre[:2])]


def order_of_leaving(edge, order):
    """Return the order of the first derivative of the distance from an edge that is not 0 when the
    mass leaves it, given that of the force that no longer holds it.
    """
    # F is v': v leaves one order later; but where static friction ends F is its excess.
    if edge.excess > 0:
        return 1
    return order + 1


def frame(sides):
    """Return two orthogonal sides of a rectangle that contains all sums of `sides`, each times a
    number in [-1, 1].
    """
    # (p, q) is the direction (dt, dx) of the longest side.
    longest = max(sides, key=lambda side: (abs(side[0]) + abs(side[1])).upper())
    p, q, _ = (component.mid() for component in longest)
    if p == q == 0:
        p = arb(1)
    square = p * p + q * q
    along = sum((abs((t * p + x * q) / square).upper() for t, x, _ in sides), arb(0)).upper()
    across = sum((abs((x * p - t * q) / square).upper() for t, x, _ in sides), arb(0)).upper()
    return [((along * p), (along * q), arb(0)), (-across * q, across * p, arb(0))]


def begin(problem, start, errors, rest=None):
    """Return the motion from a start (t0, x0, v0) with errors.

    On a belt forces decide its mode (`rest`: `VerifiedMotion`).
    """
    (t0, x0, v0) = start
    p = problem.p
    law = problem.law
    centre = [arb(value) for value in start]
    columns = [
        [arb(error) if i == j else arb(0) for j in range(3)]
        for i, error in enumerate(errors)
        if error
    ]
    z = fmpq_mat([[x0], [v0], [1], [1], [0]])  # where t0 or B0 is 0
    edge = law.edge_of(v0)
    # Off the edges the band follows from v.
    if not edge:
        mode = problem.mode(law.band_of(v0))
        if not any(errors) and problem.circles(mode):
            amplitude = v0**2 + (mode.exact * z)[V, 0] ** 2 * p["m"] / p["k"]
        else:
            amplitude = None
        return VerifiedMotion(
            problem, mode.number, 0, centre, columns, leaves={}, amplitude=amplitude, rest=rest
        )
    check(errors[2] == 0, "a start on a belt or corner whose velocity is known exactly")
    exact_state = z if not any(errors) and (t0 == 0 or p["B0"] == 0) else None
    below, above = forces_at_start(problem, edge, centre, columns, exact_state)
    # It sticks; or slips into the band below, whose number is that of the edge; or into that above.
    if below.holds and above.holds:
        mode = law.last + edge
        leaves = {edge + i: force.order for i, force in enumerate((below, above)) if force.order}
    else:
        mode = edge
        order = below.order
        if below.holds:
            mode = edge + 1
            order = above.order
        leaves = {edge: order_of_leaving(law.edges[edge], order)}
    motion = VerifiedMotion(problem, mode, edge, centre, columns, leaves=leaves, rest=rest)
    motion.rests = v0 == 0 and not any(errors) and rests_at(motion.mode, x0)
    return motion


def rests_at(mode, x):
    """Return whether a mass that sticks at x on a belt at rest is held for ever: no force f falls
    below 0, whatever the drive does.
    """
    if mode.flies:
        return False
    row = mode.row
    least = [row[i, X] * x + row[i, ONE] - abs(row[i, COS]) for i in range(len(mode.ends))]
    return min(least) >= 0


class HoldingForce(NamedTuple):
    """Whether a force holds the mass on a belt, by its first derivative that is not 0, and the
    order of this derivative.
    """

    holds: Any
    order: int


def forces_at_start(problem, edge, centre, columns, exact_state):
    """Return the `HoldingForce` of F below an edge, and that of -F above it, at a start on the edge.

    `exact_state` is z if it is rational: then a force may be exactly 0.
    """
    hold = problem.mode(problem.law.last + edge)
    stuck = VerifiedMotion(problem, hold.number, edge, centre, columns).first
    forces = []
    for i in (0, 1):
        order = 0
        value = (hold.rows[0] * stuck)[i, 0]
        while exact_state is not None and value.contains(0) and order < MOST_ZEROS:
            value = arb((hold.row * hold.exact**order * exact_state)[i, 0])
            order += value == 0
        require(abs(value), "F on the belt at the start")
        forces.append(HoldingForce(value > 0, order))
    return forces


def leave(problem, start, errors, until):
    """Prove that all starts within the errors leave the belt before `until`.

    Return the set of their flights.
    """
    (t0, _, v0) = start
    (error_t, error_x, error_v) = errors
    law = problem.law
    edge = law.edge_of(v0)
    after = until - t0 - error_t
    check(
        edge in law.belts and error_v == 0 and after > 0, "a start on a belt, and a time after it"
    )

    def motion(mode, t, x, leaves=None):
        """Return the motion in a mode from all starts within a time `t` and a distance `x` of
        `start`.
        """
        columns = [(arb(t), arb(0), arb(0)), (arb(0), arb(x), arb(0))]
        centre = [arb(value) for value in start]
        return VerifiedMotion(problem, mode, edge, centre, columns, leaves)

    # How far from `start` t and x may be up to `until`, while the mass sticks.
    until_then = until - t0, error_x + abs(v0) * (until - t0 + error_t)
    hold = problem.mode(law.last + edge)
    F = hold.rows[0] * motion(hold.number, error_t, error_x).first
    state_then = motion(hold.number, *until_then).first
    F_then = hold.rows[0] * state_then
    slope = hold.rows[1] * state_then
    # F of this side (0: below the belt, 1: above it) ends the stick. Both change alike, but for the
    # sign with which they hold.
    if slope[0, 0] < 0:
        i = 0
    else:
        i = 1
    require(-slope[i, 0], "F on the belt that falls")
    require(F_then[1 - i, 0], "F on the other side of the belt")
    require(-F[i, 0] - slope[i, 0] * arb(after), "the end of a stick before the time stated")
    return motion(edge + i, *until_then, {edge: order_of_leaving(law.edges[edge], 1)})


# -- what the files state --------------------------------------------------------------------------


def about(p, *more):
    """Return the line of the answer that says what a proof is about: the parameters `p`, and the
    texts in `more`.
    """
    names = [name for name in NAMES if name in p]
    belts = []
    for n, belt in enumerate(p.get("belts", ()), 1):
        points = " ".join(f"({w}, {mu})" for w, mu in belt["curve"])
        numbers = [f"{name} = {belt[name]}" for name in ("v", "slope", "mu_s")]
        belts.append(f"belt {n} with {', '.join(numbers)} and mu = {points}")
    if belts:
        belts = [f"belts = {'; '.join(belts)}"]
    return ", ".join([f"{name} = {p[name]}" for name in names] + belts + list(more))


def what(row):
    """Return kind, belt, source and target mode of an event, given its row of the file."""
    return [row[name] for name in WHAT]


def table(rows):
    """Yield each event of a file as a line of text: kind, belt, modes, ends of t and x."""
    for i, row in enumerate(rows, 1):
        ends = [f"{row[name][0]} < {name} < {row[name][1]}" for name in "tx" if name in row]
        kind, boundary, *modes = what(row)
        if kind == CORNER:
            event = f"corner {boundary}"
        else:
            event = f"{kind} at belt {boundary}"
        yield "; ".join(["{}: {}, {} to {}".format(i, event, *modes), *ends])


def table_of_derivatives(rows, names):
    """Yield the ends of dt and dx of each event of a file by each of the `names`, as a line of text."""
    for i, row in enumerate(rows, 1):
        for name, of_t, of_x in zip(names, row["dt"], row["dx"], strict=True):
            t_low, t_high = of_t
            x_low, x_high = of_x
            yield f"{i}: {t_low} < dt/d{name} < {t_high}; {x_low} < dx/d{name} < {x_high}"


def read_start(data, source):
    """Read a motion's start and its errors.

    Return them, and a line of text that states them and the parameters.
    """
    start = [data["start"][name] for name in START]
    errors = data["start_error"]
    check(min(errors) >= 0, "start_error: a negative number", BAD)
    check(data["t_end"] - start[0] - errors[0] > 0, "t_end is not after the start", BAD)
    shown = [
        f"{name} = {source['start'][name]} +- {e}"
        for name, e in zip(START, source["start_error"], strict=True)
    ]
    return start, errors, about(source["parameters"], *shown) + f"; it begins in {source['mode']}"


def varied(problem, number, name):
    """Return the derivatives by `name` of M and of the rows of mode `number`, where z' = M z and f
    = row z.
    """
    if name in START:
        return fmpq_mat(5, 5), fmpq_mat(2, 5)
    p = problem.p
    # M and the rows are linear in each parameter but m, and in 1/m: differences from a changed
    # parameter are exact derivatives, for m (made 2m, where 1/m is halved) after a factor. Belts
    # stay in order of speed.
    if name == "m":
        by = p["m"]
        factor = 2 / p["m"]
    else:
        by = (p["v2"] - p["v1"]) / 2
        factor = 1 / by
    mode = problem.mode(number)
    changed = p | {name: p[name] + by}
    other = Mode(changed, StatedLaw(changed), number)
    return (other.exact - mode.exact) * factor, (other.row - mode.row) * factor


def changes(problem, motions, rows, name):
    """Return enclosures of the derivatives dt and dx of all events with respect to `name`, a
    parameter or start value.

    `rows` has the events in the file, `motions` the motions before, between and after them.
    """
    dt, dx, dv = (arb(int(name == number)) for number in START)
    derivatives = []
    for motion, row, after in zip(motions, rows, motions[1:], strict=False):
        problem.step(5)
        mode = motion.mode
        z = motion.first
        M_by, row_by = (arb_mat(matrix) for matrix in varied(problem, mode.number, name))
        rate = mode.M * z
        if name == "Omega":  # the phase Omega t changes by t where the motion begins
            turned = motion.t
        else:
            turned = arb(0)
        z_by_at_start = [
            dx - rate[X, 0] * dt,
            dv - rate[V, 0] * dt,
            arb(0),
            -z[SIN, 0] * turned,
            z[COS, 0] * turned,
        ]
        z_by = derivative_of_state(mode.M, M_by, z_by_at_start, z, after.t - motion.t)
        belt = row["boundary"]
        edge = problem.edge(row)
        speed = problem.law.edges[edge].v
        i = mode.ends.index(edge if mode.flies else after.mode.number)
        z_then = arb_mat([[after.x], [speed], [1], [after.first[COS, 0]], [after.first[SIN, 0]]])
        slope = (mode.rows[1] * z_then)[i, 0]
        require(abs(slope), "the slope at an event")
        dt = -((row_by * z_then)[i, 0] + (mode.rows[0] * z_by)[i, 0]) / slope
        dx = z_by[X, 0] + speed * dt
        dv = arb(int(name == f"v{belt}"))
        derivatives.append((dt, dx))
    return derivatives


def derivative_of_state(M, M_by, z_by, z, time):
    """Return z_q after a `time`, where z' = M z and z_q' = M z_q + M_q z (7 above), from z_q (a
    list) and z at its start.
    """
    # (z_q, z)' = ((M, M_q), (0, M)) (z_q, z)
    none = [arb(0)] * 5
    upper = [[*row, *row_by] for row, row_by in zip(M.tolist(), M_by.tolist(), strict=True)]
    lower = [[*none, *row] for row in M.tolist()]
    flow = (time * arb_mat(upper + lower)).exp()
    both = flow * arb_mat(10, 1, [*z_by, *z.entries()])
    return arb_mat(both.tolist()[:5])


def differentiated(problem, data, motions):
    """Prove that the derivatives of all events lie between the ends that the file states, or raise
    Stop.
    """
    first = motions[0]
    names = data["wrt"]
    stated = data["derivatives"]
    check(not any(data["start_error"]), "derivatives of a start that is not exact", BAD)
    check(names and len({*names}) == len(names), "wrt: no names, or one twice", BAD)
    right = len(stated) == len(data["events"]) and all(
        len(row[d]) == len(names) for row in stated for d in row
    )
    check(right, "derivatives: not as many as events and names", BAD)
    check(all(row["kind"] != "graze" for row in data["events"]), "derivatives behind a graze")
    speeds = [f"v{n}" for n in (1, 2) if data["start"]["v0"] == problem.p[f"v{n}"]]
    check(
        not {"v0", *speeds} & {*names} or not speeds,
        "a derivative by what takes the start off its belt",
    )
    check(
        max(first.leaves.values(), default=0) <= first.mode.flies,
        "derivatives where a force is 0 at the start",
    )
    for j, name in enumerate(names):
        derivatives = changes(problem, motions, data["events"], name)
        for (dt, dx), row in zip(derivatives, stated, strict=True):
            inside(dt, row["dt"][j])
            inside(dx, row["dx"][j])


def some_starts(start, errors, free):
    """Return three starts with their errors: all starts between two values of the free number, the
    lowest one, and the highest one.
    """
    name, low, high = (free[key] for key in ("name", "low", "high"))
    i = START.index(name)
    check(
        start[i] - errors[i] <= low < high <= start[i] + errors[i],
        "a free number within the start's error",
    )
    middles_and_errors = (
        ((low + high) / 2, (high - low) / 2),
        (low, fmpq(0)),
        (high, fmpq(0)),
    )
    return [
        ([*start[:i], middle, *start[i + 1 :]], [error * (j == i) for j in range(3)])
        for middle, error in middles_and_errors
    ]


def trajectory(data, source, limits):
    """Prove that a motion has the stated events, and no others until t_end.

    Return what is proven, as lines of text.
    """
    problem = StatedOscillator(data["parameters"], limits)
    start, errors, shown = read_start(data, source)
    starts = [(start, errors)]
    if any(errors):
        suffix = ", for every start within the error"
    else:
        suffix = ""
    if data["starts"] == "some":
        name = data["free"]["name"]
        starts = some_starts(start, errors, data["free"])
        suffix = f", for some {name} within the error of the start"
        shown += "; {name} is between {low} and {high}, and one value between them touches".format(
            **source["free"]
        )
    # Without a `rest` the columns enclose derivatives: by them `graze` shows that one start touches.
    motion, *others = [
        begin(problem, start, errors, None if i == 0 < len(starts) - 1 else [])
        for i, (start, errors) in enumerate(starts)
    ]
    check(data["mode"] == motion.mode.name, f"the motion begins in {motion.mode.name}")
    motions = [motion]
    for row in data["events"]:
        motion = motion.after_event(row, others).within(row)
        if row["kind"] == "graze":
            others = []
        else:
            others = [other.after_event(row) for other in others]
        motions.append(motion)
    check(not others, "a graze that only one start has, and no graze is stated")
    motion.positive(arb(data["t_end"]).upper())
    corners = sum(row["kind"] == CORNER for row in data["events"])
    count = len(data["events"]) - corners
    lines = []
    if "wrt" in data:
        differentiated(problem, data, motions)
        suffix = f", with derivatives by {', '.join(data['wrt'])}"
        lines = list(table_of_derivatives(source["derivatives"], data["wrt"]))
    between = f" and {corners} corner{'s' * (corners != 1)}" if corners else ""
    first = f"{count} event{'s' * (count != 1)}{between} until t = {source['t_end']}{suffix}"
    return [first, shown, *table(source["events"]), *lines]


class Period(NamedTuple):
    """The motions of a box from event to event, the fixed point u of their map P from the centre of
    the box, and D, which encloses the derivatives of P.
    """

    motions: Any
    u: Any
    D: Any


def box_through(problem, rows, centre, widths, kind):
    """Follow a box of t and x at the first event through all events in `rows`; return its motions."""
    (dt, dx) = widths
    law = problem.law
    edge = problem.edge(rows[0])
    modes = [
        mode
        for mode in (edge, edge + 1, law.last + edge)
        if law.name(mode) == rows[0]["target"] and (rows[0]["kind"] != CORNER or mode <= law.last)
    ]
    check(modes, "a first event that leads to a mode beside its belt")
    columns = [(dt, arb(0), arb(0)), (arb(0), dx, arb(0))]
    stops = []
    for mode in modes:  # two at a corner: it is passed upwards or downwards
        leaves = {edge: 1} if mode <= law.last else {}
        motions = [kind(problem, mode, edge, [*centre, arb(law.edges[edge].v)], columns, leaves)]
        try:
            for row in rows[1:]:
                motions.append(motions[-1].after_event(row))
            check(
                motions[-1].mode.number == mode, "a last event that leads where the first one does"
            )
            return motions
        except Stop as stop:
            stops.append(stop)
    raise min(stops, key=lambda stop: stop.args[0])  # more bits may decide


def period(problem, rows, centre, widths, turn, kind=VerifiedMotion):
    """Follow a box of t and x at the first event through all events in `rows`, and return the
    `Period`.

    Let P map t and x at the first event to those at the last, with t less by `turn`, the time of
    the periods. D encloses the Jacobian of P over the box `centre` +- `widths`; if centre + u is
    inside, it is P's only fixed point. Without a drive `turn` is None, and P maps x alone: the width
    in t is 0, and D has the derivative of x by x only.
    """
    (_, dx) = widths
    motions = box_through(problem, rows, centre, widths, kind)
    last = motions[-1]
    (t, x, _) = last.centre
    if turn is None:
        slope = last.columns[1][1] / dx
        require(abs(1 - slope), "1 less the derivative of x by x")
        D = arb_mat([[0, 0], [0, slope]])
        return Period(motions, [arb(0), (x - centre[1]) / (1 - slope)], D)
    D = arb_mat([[last.columns[j][i] / widths[j] for j in (0, 1)] for i in (0, 1)])
    moved = arb_mat([[t - turn - centre[0]], [x - centre[1]]])
    try:
        u = (arb_mat([[1, 0], [0, 1]]) - D).solve(moved).entries()
        return Period(motions, u, D)
    except ZeroDivisionError:
        raise Stop(OPEN, "1 - D, which may be singular") from None


def settled(data, source, limits):
    """Prove that a motion has its first events, then a cycle of events again and again, and the
    last events stated.
    """
    problem = StatedOscillator(data["parameters"], limits)
    until = data["may_stick_until"]
    start, errors, shown = read_start(data, source)
    events = data["events"]
    cycle = data["cycle"]
    last = data["last"]
    right = events and len(cycle) > 2 and 0 < len(last) <= MOST_LAST
    right = right and 0 < data["periods"] < MOST_PERIODS
    check(right, "events, cycle, last or periods out of range", BAD)
    if until is None:
        motion = begin(problem, start, errors, [])
    else:
        motion = leave(problem, start, errors, until)
    check(data["mode"] == motion.mode.name, f"the motion begins in {motion.mode.name}")
    for row in events:
        motion = motion.after_event(row).within(row)
    ends = [what(row) for row in (events[-1], cycle[0], cycle[-1])]
    check(
        ends[0] == ends[1] == ends[2] and cycle[0]["kind"] in ("cross", "stick"),
        "a cycle from the last event on",
    )
    motion.within(cycle[0])
    turn = 2 * data["periods"] * arb.pi() / arb(problem.p["Omega"])
    box = [cycle[0][name] for name in "tx"]
    widths = [arb((high - low) / 2) for low, high in box]
    around = closed_cycle(problem, cycle, box, widths, turn)
    on_cycle = data["count"] - len(events)
    check(on_cycle >= len(last), "a count of events that is not less than those stated")
    last_on_time(cycle, on_cycle, turn, arb(data["t_end"]))
    last_on_cycle(cycle, last, on_cycle, turn, around, widths)
    first = (
        f"{data['count']} events until t = {source['t_end']}, the last {on_cycle} of them on a "
        f"cycle of {len(cycle) - 1}"
    )
    lines = [
        line for name in ("events", "cycle", "last") for line in [f"{name}:", *table(source[name])]
    ]
    if until is None:
        stuck = []
    else:
        stuck = [f"all have left the belt at t = {source['may_stick_until']}"]
    return [first, shown, *stuck, f"a cycle takes {data['periods']} forcing periods", *lines]


def closed_cycle(problem, cycle, box, widths, turn):
    """Prove that all motions from the box of the first event have the events of the cycle, and come
    back into the box; return their `Period`.
    """
    centre = [arb((high + low) / 2) for low, high in box]
    around = period(problem, cycle, centre, widths, turn)
    for motion, row in zip(around.motions[1:], cycle[1:], strict=True):
        motion.within(row)
    last = around.motions[-1]
    inside(last.t - turn, cycle[0]["t"])  # P(B) lies in B
    inside(last.x, cycle[0]["x"])
    return around


def last_on_time(cycle, on_cycle, turn, t_end):
    """Raise Stop unless exactly `on_cycle` events of the motion on the cycle are before t_end."""
    n = len(cycle) - 1
    for number, sign in ((on_cycle, 1), (on_cycle + 1, -1)):
        low, high = cycle[number % n]["t"]
        require(
            sign * (t_end - arb(low).union(arb(high)) - number // n * turn),
            "so many events until t_end",
        )


def last_on_cycle(cycle, last, on_cycle, turn, around, widths):
    """Raise Stop unless the events `last` are those that a contraction leads to (6 above)."""
    # |D| e <= q e for the half-widths e.
    D = around.D
    width_t, width_x = widths
    q_t = (abs(D[0, 0]) * width_t + abs(D[0, 1]) * width_x) / width_t
    q_x = (abs(D[1, 0]) * width_t + abs(D[1, 1]) * width_x) / width_x
    q = q_t.max(q_x).upper()
    require(1 - q, "a contraction in the norm of the box")
    for back, row in enumerate(reversed(last)):
        cycles, j = divmod(on_cycle - back, len(cycle) - 1)
        # Where in the box of the first event: at the fixed point, up to 2 q^n of the half-widths.
        factors = [
            shift / width + 2 * q**cycles * arb(0, 1)
            for shift, width in zip(around.u, widths, strict=True)
        ]
        check(what(row) == what(cycle[j]), "the kinds of the last events")
        t, x = around.motions[j].from_centre(factors)
        inside(t + cycles * turn, row["t"])
        inside(x, row["x"])


def keeps_sign(bias, swing, low, high):
    """Raise Stop unless s = bias + swing sin theta is > 0 for all phases theta from `low` to
    `high`.
    """
    # s falls to its least value, bias - |swing|, and rises from there, once a turn: between two
    # phases of its least value it is least at an end.
    if bias > abs(swing):
        return
    for end in (low, high):
        require(arb(bias) + arb(swing) * end.sin(), "phases on the wrong side of a window's ends")
    turn = 2 * arb.pi()
    least = arb.pi() * (3 if swing > 0 else 1) / 2  # sin theta is -1 or 1 there
    before = int(((low - least) / turn).mid().floor().unique_fmpz())  # whole turns from it to `low`
    outside = "a window with phases at which s is least"
    require(low - least - before * turn, outside)
    require(least + (before + 1) * turn - high, outside)


def window(data, source, limits):
    """Prove at which phases a contact with a force F = 0 is a graze, as the file states.

    Return lines of text.
    """
    problem = StatedOscillator(data["parameters"], limits)
    grazes = data["grazes"]
    ends = data["ends"]
    p = problem.p
    (belt, side) = {"P2": (1, 1), "P3": (1, -1), "P5": (2, 1), "P6": (2, -1)}[data["map"]]
    bias = side * p["k"] * p[f"v{belt}"]
    swing = side * p["B0"] * p["Omega"]
    count = {"on an arc": 2, "everywhere but at one phase": 1}.get(grazes, 0)
    check(len(ends) == count, "two ends of an arc, or one", BAD)
    grazing_phases(data, bias, swing)
    for end in ends:
        end_of_window(end, bias, swing, grazes == "on an arc")
    first = f"{data['map']} grazes {grazes}, order {data['order']}"
    shown = source["ends"]
    if grazes == "on an arc":
        balls = [arb(low).union(arb(high)) for low, high in (end["phase"] for end in ends)]
        first += " from {} to {}".format(
            *(phase.str(12, radius=phase.rad() > 1e-12) for phase in balls)
        )
    if ends:
        first += f", the sine being {shown[0]['sine']} there"
    phases = [
        f"{i}: {end['phase'][0]} < theta < {end['phase'][1]}" for i, end in enumerate(shown, 1)
    ]
    return [f"{first}, for all phases", about(source["parameters"]), *phases]


def grazing_phases(data, bias, swing):
    """Raise Stop unless s = bias + swing sin theta is > 0 at the phases at which the file states
    grazes, and < 0 at the others.
    """
    grazes = data["grazes"]
    circle = (arb(0), 2 * arb.pi())
    # s = bias (1 -+ sin theta) is 0 at one phase, of fourth order there
    touches_0 = swing != 0 and abs(bias) == abs(swing)
    if grazes == "on an arc":
        # Enclosures of both ends: the arc is from the first one to the second.
        first, second = ([arb(phase) for phase in end["phase"]] for end in data["ends"])
        again = first[0] + 2 * arb.pi()
        for x, y in pairwise((*first, *second, again)):
            require(y - x, "ends in another order")
        keeps_sign(bias, swing, first[1], second[0])
        keeps_sign(-bias, -swing, second[1], again)
    elif touches_0:
        if data["order"] == "full":
            above = "everywhere"
        else:
            above = "everywhere but at one phase"
        if bias < 0:
            right = "nowhere"
        else:
            right = above
        check(grazes == right, "a window that is not so at the phase where s is 0, or elsewhere")
    elif grazes == "nowhere" and not bias == swing == 0:
        keeps_sign(-bias, -swing, *circle)
    elif grazes != "nowhere":
        check(
            grazes == "everywhere", "a window that leaves out a phase at which nothing is special"
        )
        keeps_sign(bias, swing, *circle)


def end_of_window(end, bias, swing, of_arc):
    """Raise Stop unless s = bias + swing sin theta has its zero at the phase that an end states."""
    (low, high) = [arb(phase) for phase in end["phase"]]
    sine = end["sine"]
    cosine = end["cosine"]
    check(bias + swing * sine == 0, "an end where s is not 0")
    require(1 - (high - low), "an enclosure of many phases")
    if of_arc:
        # sin theta - sine has one sign change between `low` and `high`, where cos has one sign.
        check(cosine in (-1, 1), "an end where the derivative of s is 0")
        require(cosine * low.union(high).cos(), "the cosine at an end")
        require(cosine * (high.sin() - arb(sine)), "an end below its enclosure")
        require(cosine * (arb(sine) - low.sin()), "an end above its enclosure")
    else:
        check(cosine == 0, "a phase where the derivative of s is 0")
        # sine is 1 or -1, at pi/2 or 3 pi/2
        inside((2 - arb(sine)) * arb.pi() / 2, end["phase"])


KINDS = {"trajectory": trajectory, "settled": settled, "window": window}
BESIDE = ("orbit", "branch", "atlas")


# -- the answer ------------------------------------------------------------------------------------


def unique(pairs):
    """Return the dict of a JSON object's (key, value) pairs; raise Stop if a key occurs twice."""
    check(len(dict(pairs)) == len(pairs), "a key that is twice in an object", BAD)
    return dict(pairs)


def shape_of(kind, data):
    """Return the shape that the content `data` of a file of this kind must have.

    A trajectory has another one with "some" of the starts or with derivatives.
    """
    if kind == "trajectory":
        if data.get("starts") == "some":
            kind = "some"
        elif "wrt" in data:
            kind = "derivatives"
    p = data.get("parameters")
    if not (type(p) is dict and "belts" in p):
        return SHAPES[kind]
    belts = p["belts"]
    right = type(belts) is list and 0 < len(belts) <= MOST_BELTS
    check(right, f"belts: no list of 1 to {MOST_BELTS}", BAD)
    check(kind in LAW_SHAPES, f"{kind!r}: of a law of any belts no checker proves that", BAD)
    return LAW_SHAPES[kind](law_what(len(belts)))


def prove(data, limits):
    """Prove a certificate and return what is proven, as lines of text.

    `limits` has the most events and steps.
    """
    check(type(data) is dict and data.get("format") == FORMAT, "an unknown format", BAD)
    kind = data.get("kind")
    proven = data.get("proven")
    author = data.get("made_by", "")
    check(
        type(author) is str and len(author) <= 200,
        "made_by is no text of 200 characters at most",
        BAD,
    )
    check(
        type(proven) is bool and type(kind) is str,
        "no kind, or proven is neither true nor false",
        BAD,
    )
    check(proven, "the file itself says that it is not proven")
    if kind in BESIDE:
        more = " verify_orbits.py proves it"
    else:
        more = ""
    check(kind in KINDS, f"{kind[:20]!r}: of that kind this checker proves none.{more}", BAD)
    source = {
        key: entry
        for key, entry in data.items()
        if key not in ("format", "kind", "proven", "message", "made_by")
    }
    counted = sum(len(entry) for entry in source.values() if type(entry) is list)
    check(counted <= limits["events"], f"more than {limits['events']} events and boxes (--events)")
    content = read(source, shape_of(kind, data), kind)
    limits["left"] = limits["steps"]
    lines = None
    is_exact = kind == "trajectory" and not any(content["start_error"])
    most_bits = MOST_BITS_IF_EXACT if is_exact else MOST_BITS
    while not lines:
        try:
            lines = KINDS[kind](content, source, limits)
        except Stop as stop:
            code = stop.args[0]
            if code != OPEN or ctx.prec >= most_bits:
                raise
            ctx.prec *= 2
    check(
        data.get("message", lines[0]) == lines[0],
        f"a message that says something else than {lines[0]}",
    )
    return lines


def judge(data, **limits):
    """Prove the contents of a file, read from JSON, again; return an exit code and the answer."""
    with LOCK:
        before = (ctx.prec, ctx.cap)
        ctx.prec = FIRST_BITS
        try:
            return 0, "proven: " + "\n  ".join(prove(data, LIMITS | limits))
        except Stop as stop:
            code, text = stop.args
            code = code or FALSE  # OPEN is 0, the exit code of what is proven
            verdict = "no certificate" if code == BAD else "not proven"
            return code, " ".join(f"{verdict}: {text}".split())
        except (ValueError, LookupError, TypeError, ArithmeticError, RecursionError) as error:
            return (
                BAD,
                f"no certificate: {type(error).__name__}, {' '.join(str(error).split())[:100]}",
            )
        finally:
            ctx.prec, ctx.cap = before


def verify(path, **limits):
    """Prove a file again; return an exit code and the answer in words."""
    most = (LIMITS | limits)["bytes"]
    try:
        with open(path, "rb") as file:
            content = file.read(most + 1)
        check(len(content) <= most, f"more than {most} bytes (--bytes)", BAD)
        check(not content.startswith(b"\xef\xbb\xbf"), "a byte order mark, no JSON in UTF-8", BAD)
        data = json.loads(content.decode("utf-8"), object_pairs_hook=unique)
        return judge(data, **limits)
    except Stop as stop:
        what = stop.args[1]
    except OSError as error:
        what = f"{path} cannot be read: {error.strerror or error}"
    except UnicodeDecodeError:
        what = f"{path} is no text in UTF-8"
    except (ValueError, RecursionError) as error:
        what = f"{path} is not the JSON that symosc certify writes ({error})"
    return BAD, f"no certificate: {' '.join(what.split())[:200]}"


def say(text, stream, name):
    """Write a line to a stream, whose name is for messages.

    Return why it cannot be written, or "".
    """
    if stream is None:
        return f"{name} is closed"
    try:
        print(text, file=stream, flush=True)
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # else it fails again at exit
        # A reader that has seen enough closes the pipe.
        if isinstance(error, BrokenPipeError):
            return ""
        return f"{name}: {error.strerror}"
    return ""


def main():
    """Run the program: read the command line, print the answer, and exit with its code."""
    parser = argparse.ArgumentParser(description="Prove a certificate once more.")
    parser.add_argument("file")
    for name, most in LIMITS.items():
        parser.add_argument(
            f"--{name}", type=int, default=most, help=f"at most so many (default: {most})"
        )
    arguments = vars(parser.parse_args())
    code, answer = verify(arguments.pop("file"), **arguments)
    if code:
        say(answer, sys.stderr, "standard error")
    else:
        lost = say(answer, sys.stdout, "standard output")
        if lost:
            code = BAD
            say(lost, sys.stderr, "standard error")
    sys.exit(code)


if __name__ == "__main__":
    main()
