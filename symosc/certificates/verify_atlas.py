#!/usr/bin/env python3
"""Prove an atlas, the words of a plane of two parameters, once more: ``python verify_atlas.py FILE``.

It needs verify.py and verify_orbits.py beside it, python-flint, and nothing of symosc; it proves all kinds. For c > 0
and k > 0 an orbit with a flight attracts all other motions (the energy of a difference of two motions never grows), so
that a point of the plane has one word. Balls (arb) prove, for all parameters of a box at once, that its word has an
orbit:

1. Between two events x'' + (c/m) x' + (k/m) x = (A + B0 cos theta)/m. With the roots l, l' of l^2 + (c/m) l + k/m and
   X(a, b) = (exp(a s) - exp(b s))/(a - b) = s exp((a + b) s/2) sinh(w)/w, w = (a - b) s/2, it is S = X(l, l') for a
   unit of velocity at the start, and Z = (X(l, i Omega) - X(l', i Omega))/(l - l') for the drive exp(i Omega s)/m.
   sinh(w)/w = 0F1(3/2; w^2/4) is entire: nothing is special at resonance.
2. Unknowns u: of each flight the phase at its start, its duration, and x at its start, unless it follows a stick:
   there F = 0 says x. r(u) = 0: v is that of the belt at its end, and x and the phase fit to the next flight. If word
   and oscillator are symmetric about A0/k, half a period is enough (a belt without friction is seen in the image too).
3. u(d) is a polynomial of degree 2 in the place d in the box, |d_i| <= 1 (it proves nothing). By Taylor's theorem
   r(u(d)) is r_0 + ... + r_3 with r_0, r_1, r_2 at the middle, and r_3, a cubic form, somewhere in the box: from series
   in four directions. J, the derivatives of r by u, is that at the middle and its change, from series in sums of two
   directions. Let p >= |Y r| and N >= |1 - Y J| for |u - u(d)| <= e. If p + N e < e there is one root for each d
   (Krawczyk).
4. The inequalities of the word, by the same series to second order: each flight and stick lasts; at the end of a flight
   F on both sides of the belt says what follows; during a stick both forces hold it: they are monotone between the
   turns, where k v + B0 Omega sin theta = 0, so it is enough to look there and at its ends.
5. In a flight back to its belt the distance g has m (g'' + (c/m) g' + (k/m) g) = q = -side (k v + B0 Omega sin theta).
   Over a time less than pi/|Im l| no solution y of the equation with q = 0 has two zeros (Polya). So g > 0 where q < 0
   between two times with g >= 0. Where q > 0, g >= y with the value and slope of g at one time: g > 0 after
   g = 0 <= g', before g = 0 >= g', and around a time as far as y > 0. Elsewhere, and at the other belt, by short steps.
6. "rest": a belt has the speed 0, and mu FN >= |B0|: the mass may rest on it, and no orbit has a flight.
7. The boxes are in the range and do not overlap; their part of its area is the share. With the open boxes they fill it.
   What is "found" is not proven; but no point of a border may be inside a box, where the word does not change.
"""

import sys
from bisect import bisect_left, bisect_right, insort
from importlib import import_module
from itertools import pairwise
from math import inf
from typing import Any

from flint import acb, acb_series, arb, arb_mat, arb_series, ctx

try:
    orbits = import_module(".verify_orbits" if __package__ else "verify_orbits", __package__)
except ImportError as error:
    print(f"no certificate was read: verify_orbits.py has to be beside verify_atlas.py ({error})", file=sys.stderr)
    sys.exit(2)
base = orbits.base
OPEN, BAD, check, require, Stop, number = base.OPEN, base.BAD, base.check, base.require, base.Stop, base.number
verify, judge = base.verify, base.judge

BOX_BITS, MOST_PARTS, NEWTON_STEPS, NEAR, MOST_CUTS, MOST_TURNS = 64, 1024, 12, 1e-14, 16, 1000
SIDES = ((1, 0), (0, 1), (1, 1), (1, -1))
BOX = ((number, number), (number, number))


def curves(value, where):
    """Read the points of all borders that were found, in order; the rest is not looked at."""
    try:
        points = [tuple(map(float, point)) for border in value.get("borders", ()) for point in border["points"]]
    except (AttributeError, LookupError, TypeError, ValueError):
        points = [()]
    check(all(len(each) == 2 and abs(sum(each)) < 1e99 for each in points), f"{where}: the points of a border", BAD)
    return sorted(points)


base.SHAPES["atlas"] = {
    "parameters": base.MOTION["parameters"],
    "over": (set(base.NAMES), set(base.NAMES)),
    "range": BOX,
    "share": number,
    "boxes": [{"word": str, "range": BOX, "phases": [number], "x": [number]}],
    "open": [BOX],
    "found": curves,
}


def coefficient(value, order):
    """Return a coefficient of a series; a ball is a constant."""
    return value[order] if isinstance(value, arb_series) else value if order == 0 else arb(0)


def lifted(value):
    """Return a real ball or series as a complex one."""
    return acb_series(value) if isinstance(value, arb_series) else acb(value)


def times_i(value):
    """Return i times a real ball or series."""
    return acb_series([acb(0, 1)]) * acb_series(value) if isinstance(value, arb_series) else acb(0, value)


def real(value):
    """Return the real part of a complex ball or series."""
    return arb_series([each.real for each in value], prec=value.prec) if isinstance(value, acb_series) else value.real


def sinhc(z):
    """Return sinh(w)/w of z = w^2/4, a complex ball or series, by its derivatives."""
    if not isinstance(z, acb_series):
        return z.hypgeom_0f1(acb(1.5))
    change, found = acb_series([0, *list(z)[1:]], prec=z.prec), list[Any]()
    total, divisor = acb_series([0], prec=z.prec), arb(1)
    for j in range(z.prec):
        found.append(z[0].hypgeom_0f1(acb(1.5) + j) / divisor)
        divisor *= (arb(1.5) + j) * (j + 1)
    for each in reversed(found):
        total = total * change + acb_series([each], prec=z.prec)
    return total


class Plane:
    """The oscillator with balls or series as parameters."""

    def __init__(self, q):
        self.m, self.c, self.k, A0, self.B0, self.Om, v1, v2, mu1, mu2, FN = (q[name] for name in base.NAMES)
        self.A, self.belts = [A0, A0 + (mu1 + mu2) * FN, A0 + (mu2 - mu1) * FN, A0 - (mu1 + mu2) * FN], [None, v1, v2]
        self.jump = [None, 2 * mu1 * FN / self.m, 2 * mu2 * FN / self.m]
        self.h, self.km = self.c / (2 * self.m), self.k / self.m
        self.square = self.h * self.h - self.km
        root = lifted(self.square).sqrt()
        self.roots = root - lifted(self.h), -root - lifted(self.h)

    def free(self, s):
        """Return S, S' and the real parts of the derivatives of exp(i phase) Z as a function (1 above)."""
        first_root, other = self.roots
        s, drive = lifted(s), times_i(self.Om)

        def X(a, b):
            """Return X(a, b)."""
            half = (a - b) * s / 2
            if abs(half[0] if isinstance(half, acb_series) else half) > 1:
                return ((a * s).exp() - (b * s).exp()) / (a - b)
            return s * ((a + b) * s / 2).exp() * sinhc(half * half / 4)

        first, second, difference = X(first_root, drive), X(other, drive), first_root - other
        S = X(first_root, other)
        S1 = (first_root * s).exp() + other * S
        # The derivative of X(a, b) by s is exp(b s) + a X(a, b).
        return real(S), real(S1), (first - second) / difference, (first_root * first - other * second) / difference

    def part(self):
        """Return a time that is surely shorter than half a period of the free motion."""
        most = (-coefficient(self.square, 0)).upper()
        return (arb.pi() / most.sqrt()).lower() if most > 0 else arb.pos_inf()


class Flight:
    """A flight: mode, belts at its start and end, if it follows a stick, the domain in which the next stick ends."""

    def __init__(self, piece, at, slips, stick):
        (self.belt, self.mode, self.onto), self.at, self.slips, self.stick = piece, at, slips, stick
        self.tau = at + 2 - slips
        self.side = 1 if self.mode > self.onto else -1

    def start(self, e, u):
        """Return x at the start of the flight, from the unknowns u."""
        if not self.slips:
            return u[self.at + 1]
        return (e.A[self.mode] + e.B0 * u[self.at].cos() - e.c * e.belts[self.belt]) / e.k

    def after(self, e, u, s):
        """Return x, v and v' of the flight after a time s, from the unknowns u."""
        x, v, A, phase = self.start(e, u), e.belts[self.belt], e.A[self.mode] / e.k, u[self.at]
        S, S1, Z, Z1 = e.free(s)
        turn = times_i(phase).exp() * lifted(e.B0 / e.m)
        y, E = x - A, S1 + 2 * e.h * S
        there = A + y * E + v * S + real(turn * Z)
        speed = v * S1 - e.km * S * y + real(turn * Z1)
        F = (e.A[self.mode] + e.B0 * (phase + e.Om * s).cos() - e.k * there - e.c * speed) / e.m
        return there, speed, F


class Word:
    """The flights of a word, and r (2 above)."""

    def __init__(self, text, mirror):
        self.text = text
        digits = text[1:]
        right = text[:1] == "P" and 0 < len(digits) <= 200 and set(digits) <= set("12345678")
        check(right, f"the word {text[:40]!r}", BAD)
        pieces = [orbits.PIECES[int(digit) - 1] for digit in reversed(digits)]
        check(any(mode < 4 for _, mode, _ in pieces), f"the word {text[:40]!r}, which has no flight", BAD)
        while pieces[0][1] > 3:
            pieces = pieces[1:] + pieces[:1]
        for (_, mode, end), (start, after, _) in zip(pieces, pieces[1:] + pieces[:1], strict=True):
            near = {mode, after} <= {start, start + 1, start + 3} and mode != after
            check(end == start and near, f"the word {text[:40]!r}, whose maps do not follow each other", BAD)
        self.count, half = len(pieces), len(pieces) // 2
        modes = [mode for _, mode, _ in pieces]
        self.half = len(modes) % 2 == 0 and [mirror.get(mode) for mode in modes[:half]] == modes[half:]
        self.alone = mirror.get(1) != 3  # one belt is at rest, and v = 0 divides the modes
        self.flights, size, self.rows = [], 0, []
        for i, piece in enumerate(pieces[:half] if self.half else pieces):
            if piece[1] < 4:
                slips, follows = pieces[i - 1][1] > 3, pieces[(i + 1) % len(pieces)][1] > 3
                stick = pieces[(i + 2) % len(pieces)][1] if follows else 0
                self.flights.append(Flight(piece, size, slips, stick))
                self.rows.append(i)
                size += 3 - slips
        self.size = size

    def unknowns(self, row, Om):
        """Return u approximately, from the phases and positions of a row."""
        check(len(row["phases"]) == len(row["x"]) == self.count, "a phase and an x at each event", BAD)
        phases, found = [float(arb(each)) for each in row["phases"]], []
        phases.append(phases[0] + 2 * float(arb.pi()))
        for flight, i in zip(self.flights, self.rows, strict=True):
            found += [phases[i]] + ([] if flight.slips else [float(arb(row["x"][i]))])
            found.append((phases[i + 1] - phases[i]) / Om)
        return [arb(each) for each in found]

    def next(self, e, i, u):
        """Return phase and x at the start of the flight after flight i; after the last, of flight 0 a turn later."""
        if i + 1 < len(self.flights):
            return u[self.flights[i + 1].at], self.flights[i + 1].start(e, u)
        x = self.flights[0].start(e, u)
        return (u[0] + arb.pi(), (e.A[1] + e.A[3]) / e.k - x) if self.half else (u[0] + 2 * arb.pi(), x)

    def r(self, e, u, plan=None):
        """Return the residuals r of the word, and its margins, which have to be > 0 (2 and 4 above)."""
        found, margins, self.looks = [], [], {}  # the margins by which a flight is looked at, and its number
        for i, flight in enumerate(self.flights):
            s, (phase, x), v = u[flight.tau], self.next(e, i, u), e.belts[flight.onto]
            there, speed, F = flight.after(e, u, s)
            end = u[flight.at] + e.Om * s
            if not flight.stick:
                found += [speed - v, there - x, end - phase]
            else:
                found += [speed - v, there + v * ((phase - end) / e.Om) - x]
            if plan is None:
                continue
            meets, jump = -flight.side * F, e.jump[flight.onto]
            margins += [s, meets, jump - meets if flight.stick else meets - jump]
            if flight.stick:
                sign = 1 if flight.stick == flight.onto else -1
                margins += [(phase - end) / e.Om, sign * (e.k * v + e.B0 * e.Om * phase.sin())]
                for n in plan[0][i]:
                    turn = turning(e, flight.onto, n)
                    force = sign * (e.B0 * (turn.cos() - phase.cos()) + e.k * v * (phase - turn) / e.Om) / e.m
                    margins += [force, jump - force]
            for part, reach in plan[1][i]:
                _, at, slope = flight.after(e, u, s * part)
                for later in (reach, -reach) if reach else (0.0,):
                    S, S1, _, _ = e.free(arb(later))
                    self.looks[len(margins)] = i
                    margins.append(flight.side * ((at - v) * (S1 + 2 * e.h * S) + slope * S))
        return found, margins

    def plan(self, e, u):
        """Return which turns may be in each stick, and where to evaluate each g (5 above); None: short steps."""
        turns, cuts, steps = [], list[Any](), []
        for i, flight in enumerate(self.flights):
            end = u[flight.at] + e.Om * u[flight.tau]
            turns.append(between(e, flight.onto, end, self.next(e, i, u)[0]) if flight.stick else [])
            found = signs(e, flight, u) if flight.belt == flight.onto else None
            cuts.append([])
            steps.append(found is None)
            if found:
                cuts[-1] = marks(found[0], found[1], e.part())
                steps[-1] = len(cuts[-1]) > MOST_CUTS
                cuts[-1] = [] if steps[-1] else cuts[-1]
        return turns, cuts, steps

    def stays(self, e, u, plan, problem):
        """Prove for all u in a box, where the margins are > 0, that no flight meets a belt before its end (5 above)."""
        for flight, cuts, steps in zip(self.flights, *plan[1:], strict=True):
            near = {flight.mode - 1, flight.mode} & {1, 2}
            sides = {belt: (1 if flight.mode > belt else -1, e.belts[belt]) for belt in near}
            if self.half and self.alone and flight.mode != 2:  # the mirror image is between both belts
                other = 2 if flight.mode == 1 else 1
                sides[other] = -flight.side, -e.belts[other]
            for belt, (side, speed) in sides.items():
                returns = belt == flight.belt == flight.onto
                if returns and not steps and short(e, flight, u, cuts):
                    continue
                if belt not in (flight.belt, flight.onto) and far(e, flight, u, side * speed):
                    continue
                order = (1 + flight.slips) * (belt == flight.belt)

                def f(s, flight=flight, side=side, speed=speed):
                    """Return the distance from a belt and its derivatives."""
                    _, v, a = flight.after(e, u, s)
                    jerk = -2 * e.h * a - e.km * v - e.B0 * e.Om / e.m * (u[flight.at] + e.Om * s).sin()
                    return side * (v - speed), side * a, side * jerk

                margin = orbits.Margin("a flight that meets no belt before its end", "", f, order, belt == flight.onto)
                orbits.positive(margin, u[flight.tau].upper(), problem)


def turning(e, belt, n):
    """Return the phase of a turn of the forces on a belt."""
    v = e.belts[belt]
    if isinstance(v, arb) and v.is_zero():
        return n * arb.pi()
    return n * arb.pi() + (-1) ** (n % 2) * (-e.k * v / (e.B0 * e.Om)).asin()


def between(e, belt, low, high):
    """Return the turns that may be between two phases."""
    bias, swing = abs(e.k * e.belts[belt]), abs(e.B0 * e.Om)
    if bias > swing:
        return []
    require(swing - bias, "whether the forces on a belt turn")
    first, last = (low / arb.pi()).lower().floor() - 1, (high / arb.pi()).upper().ceil() + 1
    check(last - first < MOST_TURNS, "few turns in a piece", OPEN)
    all_of = range(int(float(first)), int(float(last)) + 1)
    return [n for n in all_of if not turning(e, belt, n) < low and not turning(e, belt, n) > high]


def signs(e, flight, u):
    """Return if q > 0 on the parts of a flight back to its belt, and their ends (5 above); None: unknown."""
    phase, end = u[flight.at], u[flight.at] + e.Om * u[flight.tau]
    turns = [turning(e, flight.belt, n) for n in between(e, flight.belt, phase, end)]
    if not all(phase < turn < end for turn in turns):
        return None
    ups = []
    for a, b in pairwise([phase, *turns, end]):
        place = ((a + b) / 2).mid()
        q = -flight.side * (e.k * e.belts[flight.belt] + e.B0 * e.Om * place.sin())
        if not (a < place < b and abs(q) > 0):
            return None
        ups.append(int(q > 0))
    return ups, [arb(0), *((turn - phase) / e.Om for turn in turns), u[flight.tau]]


def marks(ups, times, most):
    """Choose at which parts of a flight to evaluate g, and for how long before and after; this proves nothing."""
    most, tau, found = 0.95 * float(most), float(times[-1]), []
    spare = 2 * max(float(each.rad()) for each in times) + tau / 500
    for i, (up, (a, b)) in enumerate(zip(ups, pairwise(map(float, times)), strict=True)):
        a, b = (a + most * (i == 0), b - most * (i + 1 == len(ups))) if up else (a, b)
        count = (int(4 * (b - a) / most) + 1 if a < b else 0) if up else int((b - a) / most)
        count = min(count, MOST_CUTS + 1)  # else there are too many
        step = (b - a) / max(count, 1) if up else (b - a) / (count + 1)
        found += [(a + (j + (0.5 if up else 1)) * step, 0.52 * step + spare if up else 0.0) for j in range(count)]
    return [(round(at / tau * 512) / 512, reach) for at, reach in found]


def short(e, flight, u, cuts):
    """Return whether g > 0 at the cuts proves it for a whole flight (5 above)."""
    found, most = signs(e, flight, u), e.part()
    if found is None:
        return False
    ups, times = found
    at = [(times[-1] * part, reach) for part, reach in cuts]
    for i, (up, (a, b)) in enumerate(zip(ups, pairwise(times), strict=True)):
        here, at = [each for each in at if each[0] < b], [each for each in at if not each[0] < b]
        if not all(a < mark for mark, _ in here):
            return False
        if not up:
            spans = [y - x for x, y in pairwise([a, *(mark for mark, _ in here), b])]
            if not all(0 < span < most for span in spans):
                return False
            continue
        until = a + most if i == 0 else a
        for mark, reach in here:
            if not (mark - reach < until and 2 * reach < most):
                return False
            until = mark + reach
        if not until > (b - most if i + 1 == len(ups) else b):
            return False
    return not at


def far(e, flight, u, least):
    """Return whether the velocity never comes to a belt: a steady motion, and a free one that loses energy."""
    pull, drag = e.km - e.Om * e.Om, 2 * e.h * e.Om
    size, phase, x = pull * pull + drag * drag, u[flight.at], flight.start(e, u)
    if not size > 0:
        return False
    a, b = (e.B0 / e.m * each / size for each in (pull, drag))
    y = x - e.A[flight.mode] / e.k - a * phase.cos() - b * phase.sin()
    dy = e.belts[flight.belt] - e.Om * (b * phase.cos() - a * phase.sin())
    ddy = -2 * e.h * dy - e.km * y
    most = (dy * dy + ddy * ddy / e.km).upper().sqrt() + abs(e.Om) * (a * a + b * b).upper().sqrt()
    return bool(most < -least)


class Box:
    """A word for all parameters of a box (3 above)."""

    def __init__(self, p, over, word, box, u, problem):
        self.p, self.over, self.word, self.u = {name: arb(p[name]) for name in base.NAMES}, over, word, u
        self.problem = problem
        self.middle = [arb((low + high) / 2) for low, high in box]
        self.half = [arb((high - low) / 2) for low, high in box]
        self.wide = [arb(low).union(arb(high)) for low, high in box]
        problem.step(word.size)
        self.newton()
        self.surface(problem)

    def plane(self, values):
        """Return the oscillator with values of both parameters."""
        return Plane(self.p | dict(zip(self.over, values, strict=True)))

    def series(self, side, rows, count, wide=False, plan=None):
        """Return r and the margins as power series in one direction, from the middle or from all places of the box."""
        ctx.cap = count
        start = self.wide if wide else self.middle
        e = self.plane([arb_series([b, h * i], prec=count) for b, h, i in zip(start, self.half, side, strict=True)])
        return self.word.r(e, [arb_series(list(each), prec=count) for each in zip(*rows, strict=True)], plan)

    def columns(self, e, u, plan=None):
        """Return the derivatives of r and of the margins by each unknown; balls."""
        found, ctx.cap = [], 2
        self.problem.step(len(u) * len(self.word.flights) // 2)
        for j in range(len(u)):
            parts = self.word.r(e, [*u[:j], arb_series([u[j], 1], prec=2), *u[j + 1 :]], plan)
            found.append([[coefficient(each, 1) for each in part] for part in parts])
        return found

    def newton(self):
        """Find the root at the middle; it proves nothing."""
        e = self.plane(self.middle)
        for _ in range(NEWTON_STEPS):
            self.J = arb_mat([column[0] for column in self.columns(e, self.u)]).transpose()
            self.Y = self.J.mid().inv().mid()
            step = self.by([each.mid() for each in self.word.r(e, self.u)[0]])
            if all(abs(each) < NEAR for each in step):
                return  # J is that at u
            self.u = [(each - change).mid() for each, change in zip(self.u, step, strict=True)]
            check(all(abs(each) < 10 for each in step), "a root at the middle of a box", OPEN)
        raise Stop(OPEN, "a root at the middle of a box")

    def by(self, values):
        """Return Y times a vector."""
        return (self.Y * orbits.column(values)).entries()

    def surface(self, problem):
        """Prove that for all parameters of the box the word has one orbit."""
        word, size = self.word, self.word.size
        first = [
            [-each.mid() for each in self.by([r[1] for r in self.series(side, [self.u], 2)[0]])] for side in SIDES[:2]
        ]
        second, thin, p = [], [], [arb(0)] * size
        for side in SIDES[:3]:
            rows = [self.u, [side[0] * a + side[1] * b for a, b in zip(*first, strict=True)]]
            r, _ = self.series(side, rows, 3)
            second.append([-each.mid() for each in self.by([each[2] for each in r])])
            bend = (self.J * orbits.column(second[-1])).entries()
            thin.append(rows)
            for part in (
                [each[0] for each in r],
                [each[1] for each in r],
                [each[2] + b for each, b in zip(r, bend, strict=True)],
            ):
                p = [each + 3 * abs(more) for each, more in zip(p, self.by(part), strict=True)]
        a, b = first
        aa, bb, ab = second[0], second[1], [z - x - y for x, y, z in zip(*second, strict=True)]
        d = arb(0, 1)
        u = [
            u + d * (a + d * aa + d * ab) + d * (b + d * bb)
            for u, a, b, aa, bb, ab in zip(self.u, a, b, aa, bb, ab, strict=True)
        ]

        def slopes(i, j):
            """Return the first and second coefficients of u(d) in a direction, somewhere in the box."""
            rows = [
                (i * (p + 2 * d * pp + d * pq) + j * (q + 2 * d * qq + d * pq), i * i * pp + j * j * qq + i * j * pq)
                for p, q, pp, qq, pq in zip(a, b, aa, bb, ab, strict=True)
            ]
            return [list(each) for each in zip(*rows, strict=True)]

        e = self.plane(self.wide)
        plan = word.plan(e, u)
        cubes, bends = [], []
        for side in SIDES:
            r, margins = self.series(side, [u, *slopes(*side)], 4, True, plan)
            cubes.append(self.by([each[3] for each in r]))
            bends.append([coefficient(each, 2) for each in margins])
        A, D, both, apart = cubes
        for j in range(size):
            B, C = (both[j] - apart[j]) / 2 - D[j], (both[j] + apart[j]) / 2 - A[j]
            p[j] = (p[j] + abs(A[j]) + abs(B) + abs(C) + abs(D[j])).upper()
        tube = self.contract(p, u, [slopes(*side)[0] for side in SIDES[:2]])
        around = [each + arb(0, by) for each, by in zip(u, tube, strict=True)]
        again = word.plan(e, around)
        same = all(set(new) <= set(old) for new, old in zip(again[0], plan[0], strict=True))
        check(same, "which turns are in a stick", OPEN)
        by_u = [column[1] for column in self.columns(e, around, plan)]
        lines = [self.series(side, rows, 2, False, plan)[1] for side, rows in zip(SIDES[:2], thin, strict=False)]
        for i, (one, other) in enumerate(zip(*lines, strict=True)):
            bend, zero = [each[i] for each in bends[:3]], arb(0)
            least = coefficient(one, 0) - abs(coefficient(one, 1)) - abs(coefficient(other, 1))
            least += bend[0].min(zero) + bend[1].min(zero) - abs(bend[2] - bend[0] - bend[1])
            least -= sum((abs(column[i]) * by for column, by in zip(by_u, tube, strict=True)), arb(0))
            if i in word.looks and not least > 0:
                plan[2][word.looks[i]] = True  # by short steps, then
                continue
            check(least > 0, "an inequality of a word in a box", OPEN)  # smaller boxes may decide it
        word.stays(e, around, plan, problem)

    def contract(self, p, u, slopes):
        """Return e with p + N e < e (3 above)."""
        size, tube = self.word.size, [arb(1.1) * each for each in p]
        scales = [
            max((abs(a).upper(), abs(b).upper(), t), key=float).mid() for a, b, t in zip(*slopes, tube, strict=True)
        ]
        for _ in range(4):
            tube = [(arb(1.15) * each).mid() for each in tube]
            ball = [arb(0, each) for each in tube]
            at = self.columns(self.plane(self.middle), [x + y for x, y in zip(self.u, ball, strict=True)])
            N = [
                [abs(arb(int(i == j)) - each) for i, each in enumerate(self.by(column[0]))]
                for j, column in enumerate(at)
            ]
            around = [x + y for x, y in zip(u, ball, strict=True)]
            units = [[scales[j] if i == j else arb(0) for i in range(size)] for j in range(size)]
            alone = [self.squares((0, 0), around, unit) for unit in units]
            for side, slope in zip(SIDES[:2], slopes, strict=False):
                own = self.squares(side, around, slope)
                for j, unit in enumerate(units):
                    both = self.squares(side, around, [x + y for x, y in zip(slope, unit, strict=True)])
                    mixed = self.by([x - y - z for x, y, z in zip(both, own, alone[j], strict=True)])
                    N[j] = [x + abs(y) / scales[j] for x, y in zip(N[j], mixed, strict=True)]
            image = [p[i] + sum((N[j][i] * tube[j] for j in range(size)), arb(0)) for i in range(size)]
            if all(each < by for each, by in zip(image, tube, strict=True)):
                return tube
            tube = [each.upper() for each in image]
            if not all(each < 10 for each in tube):
                break
        raise Stop(OPEN, "one root for all parameters of a box")

    def squares(self, side, u, slope):
        """Return the second coefficients of r in a direction, from everywhere in the box."""
        return [coefficient(each, 2) for each in self.series(side, [u, slope, [arb(0)] * len(u)], 3, True)[0]]


def rests(p, over, box):
    """Prove that the mass may rest on a belt for all parameters of a box (6 above)."""
    ends = {name: (p[name], p[name]) for name in base.NAMES} | dict(zip(over, box, strict=True))
    drive = max(abs(each) for each in ends["B0"])
    for belt in "12":
        if ends["v" + belt] == (0, 0) and ends["mu" + belt][0] * ends["FN"][0] >= drive:
            return
    raise Stop(base.FALSE, "that the mass may rest on a belt")


def apart(boxes):
    """Prove that no two boxes overlap: from left to right, those at one place in order."""
    events = sorted((box[0][side], side == 0, i) for i, box in enumerate(boxes) for side in (0, 1))
    there = list[Any]()
    for _, begins, i in events:
        low, high = boxes[i][1]
        at = bisect_left(there, (low, high, i))
        if not begins:
            del there[at]
            continue
        for low_of, high_of, _ in there[max(at - 1, 0) : at + 1]:
            check(high_of <= low or high <= low_of, "boxes that overlap")
        insort(there, (low, high, i))


def clear(boxes, points, whole):
    """Check that no point of a border is inside a box, by more than rounding errors."""
    away = [1e-12 * float(high - low) for low, high in whole]
    for box in boxes:
        (left, right), (low, high) = ((float(a) + by, float(b) - by) for (a, b), by in zip(box, away, strict=True))
        for x, y in points[bisect_right(points, (left, inf)) : bisect_left(points, (right,))]:
            check(not low < y < high, f"a border at {x:.6g}, {y:.6g}, in a box of one word")


def mirror_of(p, over):
    """Return the mirror images of the modes of a symmetric oscillator (2 above)."""
    if not {"v1", "v2", "mu1", "mu2"} & set(over) and p["v1"] == -p["v2"] and p["mu1"] == p["mu2"]:
        return {1: 3, 2: 2, 3: 1, 4: 5, 5: 4}
    for belt, other in ((1, 2), (2, 1)):
        free = {f"v{belt}", f"mu{other}"} & set(over)
        if not free and p[f"v{belt}"] == 0 == p[f"mu{other}"]:
            return {belt: belt + 1, belt + 1: belt, 3 + belt: 3 + belt}
    return {}


def parted(problem, over, word, row, box, u):
    """Prove a box, divided into parts if necessary."""
    parts, count = [(box, u)], 0
    while parts:
        part, near = parts.pop()
        count += 1
        try:
            Box(problem.p, over, word, part, near, problem)
        except (Stop, ZeroDivisionError, ValueError) as stop:
            check(not isinstance(stop, Stop) or stop.args[0] == OPEN, str(stop.args[-1]))
            check(count < MOST_PARTS, f"the word {word.text} in the box {row['range']}, in {MOST_PARTS} parts")
            sides = [(high - low) / (b - a) for (low, high), (a, b) in zip(part, box, strict=True)]
            along = int(sides[1] > sides[0])
            low, high = part[along]
            halves = (low, (low + high) / 2), ((low + high) / 2, high)
            parts += [((half, part[1]) if along == 0 else (part[0], half), u) for half in halves]
    return count


def atlas(data, source, limits):
    """Prove an atlas: every box, that they do not overlap, and the share of the area."""
    over, whole, p = data["over"], data["range"], data["parameters"]
    check(over[0] != over[1], "two different parameters", BAD)
    for corner in ((x, y) for x in whole[0] for y in whole[1]):
        problem = base.Problem(p | dict(zip(over, corner, strict=True)), limits)
        check(min(problem.p["c"], problem.p["k"]) > 0, "a damper and a spring in the whole range")
    boxes = [row["range"] for row in data["boxes"]]
    for box in [whole, *boxes, *data["open"]]:
        check(all(low < high for low, high in box), "sides from a lower to an upper value", BAD)
        inner = all(low <= a and b <= high for (a, b), (low, high) in zip(box, whole, strict=True))
        check(inner, "a box beyond the range")
    apart([*boxes, *data["open"]])
    clear(boxes, data["found"], whole)
    all_of, proven, rest = (
        sum((b - a) * (d - c) for (a, b), (c, d) in each) for each in ([whole], boxes, data["open"])
    )
    check(
        proven == data["share"] * all_of,
        f"a share of {source['share'][:40]}, where the boxes have {proven / all_of}"[:160],
    )
    check(proven + rest == all_of, "boxes and open ones that fill the range")
    mirror, words, parts = mirror_of(p, over), {}, 0
    with ctx.workprec(BOX_BITS):
        for row, shown in zip(data["boxes"], source["boxes"], strict=True):
            text = row["word"]
            problem.step()
            if text == "rest":
                check(not row["phases"] and not row["x"], "a rest with switchings", BAD)
                rests(p, over, row["range"])
                continue
            if text not in words:
                words[text] = Word(text, mirror)
            word = words[text]
            middle = dict(zip(over, ((low + high) / 2 for low, high in row["range"]), strict=True))
            Om = float(arb(middle.get("Omega", p["Omega"])))
            parts += parted(problem, over, word, shown, row["range"], word.unknowns(row, Om))
    share = f"{float((data['share'] * 10**6).floor()) / 1e6:.6f}"  # rounded down
    named = ", ".join(sorted({row["word"] for row in data["boxes"]}))
    spans = [f"{name} from {low} to {high}" for name, (low, high) in zip(over, source["range"], strict=True)]
    first = f"the words of {len(boxes)} boxes, {share} of the area, {', '.join(spans)}: {named}"
    return [first, base.about(source["parameters"] | dict.fromkeys(over, "(varies)"))]


base.KINDS.update(atlas=atlas)


if __name__ == "__main__":
    base.main()
