"""A box of two parameters, proven: for all of its values one word has an orbit, which is the attracting motion.

The equations are those of `symosc.certificates.orbit` with as few unknowns as possible: of each flight its phase at the
start, its duration, and its position if it starts with a crossing; where a stick ends, the force says the position. If
oscillator and word are symmetric, half a period is enough: the rest is its mirror image.

Let delta be the place in the box, each component in [-1, 1], and c(delta) a polynomial of degree 2 near the surface of
roots. By Taylor's theorem along the line from the middle f(c(delta), delta) is a polynomial of degree 2, all of whose
coefficients are nearly 0, plus a cubic form with coefficients at another place of the box. The forms are found from
exact directions, so that what cancels in them does so before the place is a ball. The Jacobian is that at the middle
plus its change along both sides. The rest is Krawczyk's proof, as in `symosc.certificates.branch`.

The inequalities of the word follow from a few numbers (`Flights.margins`), by Taylor's theorem of order 2:

- At the end of a flight the acceleration says how v meets the belt, and whether it crosses or sticks.
- During a stick the forces are monotone between the turns (Theta_cr), so their values there suffice.
- During a flight the gap g has m L g = drift, of one sign between the turns, and on a part shorter than half a period
  of the free motion a solution y of L y = 0 has one zero at most (Polya). So g > 0 where L g <= 0 if g >= 0 at both
  ends of the part. Where L g >= 0, g is not below the y with the same value and slope at one point: g > 0 after a start
  with g = 0 <= g', before an end with g = 0 >= g', and where the y of a point between is > 0 at both ends of the part.
  Where this does not do, short steps do.

With c > 0 an admissible orbit attracts all motions (`symosc.orbits.floquet`): a point of the box has this word and no
other. On a belt with the speed 0 the mass may rest where mu FN >= |B0|, and only there; rational numbers decide that.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from itertools import pairwise
from math import ceil, factorial
from typing import NamedTuple

from flint import acb, acb_series, arb, arb_mat, arb_series, ctx

from symosc.certificates.balls import Ball, Undecided, ball
from symosc.certificates.flow import Jet, Oscillator
from symosc.certificates.orbit import Margin, Values, column, prove_positive, unit_matrix
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.closing_equations import OrbitPiece, pieces_of
from symosc.words import Word

BOX_BITS = 64
MOST_NEWTON, CONVERGED = 12, 1e-13
MOST_INFLATIONS, INFLATION = 5, 1.1
#: The part of half a period of the free motion that a cut flight's parts may have.
SHORTER = 0.95
MOST_CUTS = 12
#: The directions in a box in which series are computed.
DIRECTIONS = ((1, 0), (0, 1), (1, 1), (1, -1))

#: Where (exp(z) - 1)/z is computed by its series: |z| at most, and the terms of exp and of its derivatives.
NEAR, EXP_ERROR = 3.0, 1e-18
EXP_TERMS = [1 / arb(factorial(n)) for n in range(40)]
EXP_OVER = [[term / (n + k + 1) for n, term in enumerate(EXP_TERMS)] for k in range(4)]
_kept: deque[tuple[Ball, list[Ball]]] = deque(maxlen=4)

Rectangle = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]


class NotInBox(Exception):
    """Raised if a box cannot be proven: along which side to divide it, and how many times too large it is."""

    def __init__(self, what: str, along: int | None = None, excess: float = 1) -> None:
        self.what, self.along, self.excess = what, along, excess
        super().__init__(what)


class Leg(NamedTuple):
    """A flight of a word: its piece, the indices of its unknowns, and the stick after it."""

    piece: OrbitPiece
    at: int
    stick: OrbitPiece | None


class Flown(NamedTuple):
    """A flight from its start to its end; balls, or power series."""

    x0: Ball
    a0: Ball
    x: Ball
    v: Ball
    a: Ball
    drive: Drive


def mirrors(p: Parameters, names: Sequence[str] = ()) -> dict[int, int]:
    """Return the modes' mirror images in an oscillator that is symmetric about A0/k, or nothing."""
    # It is if both belts are alike, or if one of them is transparent and the speed of the other one is 0; the
    # parameters in `names` may have any values.
    free = set(names)
    if not free & {"v1", "v2", "mu1", "mu2"} and p.v1 == -p.v2 and p.mu1 == p.mu2:
        return {1: 3, 2: 2, 3: 1, 4: 5, 5: 4}
    for belt, other in ((1, 2), (2, 1)):
        if not free & {f"v{belt}", f"mu{other}"} and p.belt(belt) == 0 == getattr(p, f"mu{other}"):
            return {belt: belt + 1, belt + 1: belt, 3 + belt: 3 + belt}
    return {}


class Flights:
    """The closing equations of a word in few unknowns: phase, duration and, after a crossing, x of each flight."""

    # `labels` begin with a flight, and with the half whose mirror image is the rest if there is one.

    def __init__(self, labels: tuple[str, ...], mirror: dict[int, int]) -> None:
        pieces = pieces_of(Word(labels))
        first = next(i for i, piece in enumerate(pieces) if not piece.sticks)
        pieces = pieces[first:] + pieces[:first]
        half, odd = divmod(len(pieces), 2)
        modes = [piece.mode for piece in pieces]
        self.mirrored = not odd and [mirror.get(mode) for mode in modes[:half]] == modes[half:]
        #: The image of one belt at rest; the other belt is not symmetric.
        self.beside = self.mirrored and mirror.get(1) != 3
        self.labels = tuple(piece.label for piece in pieces)
        used = pieces[:half] if self.mirrored else pieces
        #: Half-periods of the drive.
        self.turns, self.legs, at = 2 - self.mirrored, list[Leg](), 0
        for i, piece in enumerate(used):
            if not piece.sticks:
                after = used[i + 1] if i + 1 < len(used) else None
                self.legs.append(Leg(piece, at, after if after and after.sticks else None))
                at += 3 - piece.after_stick
        self.count = at

    def unknowns(self, Omega: float, points: Sequence[tuple[float, float]]) -> list[float]:
        """Return the unknowns of an orbit by its switching points (phase, x), those of `labels`."""
        times, found, period = [phase for phase, _ in points], list[float](), 2 * float(arb.pi())
        times = [*(each + period * (each < times[0]) for each in times), times[0] + period]
        flights = [i for i, piece in enumerate(pieces_of(Word(self.labels))) if not piece.sticks][: len(self.legs)]
        for i, leg in zip(flights, self.legs, strict=True):
            found += [times[i]] + ([] if leg.piece.after_stick else [points[i][1]])
            found.append((times[i + 1] - times[i]) / Omega)
        return found

    def points(self, o: Oscillator, u: Values) -> list[tuple[float, float]]:
        """Return phase and position at the switchings of `labels`."""
        found = list[tuple[float, float]]()
        for leg in self.legs:
            there = self.fly(o, leg, u)
            found.append((float(u[leg.at]), float(there.x0)))
            if leg.stick:
                found.append((float(u[leg.at] + o.Omega * u[leg.at + 2 - leg.piece.after_stick]), float(there.x)))
        if self.mirrored:
            twice = float((o.A[1] + o.A[3]) / o.k)
            found += [(phase + float(arb.pi()), twice - x) for phase, x in found]
        return found

    def fly(self, o: Oscillator, leg: Leg, u: Values) -> Flown:
        """Follow a flight from its unknowns in `u`, balls or power series, to its end."""
        piece, (phase, *place, tau) = leg.piece, u[leg.at : leg.at + 3 - leg.piece.after_stick]
        speed = o.speed[piece.start]
        if place:
            x0, a0 = place[0], (o.A[piece.mode] + o.B0 * phase.cos() - o.k * place[0] - o.c * speed) / o.m
        else:
            x0, a0 = (o.A[piece.mode] + o.B0 * phase.cos() - o.c * speed) / o.k, arb(0)
        there = Drive(o, phase, tau)
        v = speed * there.phi + a0 * there.E - o.drive * there.sine
        a = a0 * there.E1 - speed * o.km * there.E - o.drive * there.sine1
        x = x0 + (o.B0 * there.change - o.c * (v - speed) - o.m * (a - a0)) / o.k
        return Flown(x0, a0, x, v, a, there)

    def onto(self, o: Oscillator, i: int, u: Values, flown: Sequence[Flown]) -> tuple[Ball, Ball]:
        """Return phase and position at the start of the flight after flight i."""
        if i + 1 < len(self.legs):
            return u[self.legs[i + 1].at], flown[i + 1].x0
        x = flown[0].x0
        return u[0] + self.turns * arb.pi(), (o.A[1] + o.A[3]) / o.k - x if self.mirrored else x

    def residuals(self, o: Oscillator, u: Values) -> tuple[list[Flown], Values]:
        """Return the flights, and the residuals of the closing equations."""
        flown, found = [self.fly(o, leg, u) for leg in self.legs], list[Ball]()
        for i, (leg, there) in enumerate(zip(self.legs, flown, strict=True)):
            speed, (phase, x) = o.speed[leg.piece.end], self.onto(o, i, u, flown)
            start, tau = u[leg.at], u[leg.at + 2 - leg.piece.after_stick]
            if leg.stick:
                found += [there.v - speed, there.x + speed * ((phase - start) / o.Omega - tau) - x]
            else:
                found += [there.v - speed, there.x - x, start + o.Omega * tau - phase]
        return flown, found

    def slopes(self, o: Oscillator, leg: Leg, u: Values, part: float = 1) -> dict[str, Values]:
        """Return the derivatives of the numbers of `fly` by the unknowns of a flight, followed for a part of it."""
        phase, *place, tau = u[leg.at : leg.at + 3 - leg.piece.after_stick]
        s0, s1 = phase.sin(), (phase + o.Omega * tau * part).sin()
        there = self.fly(o, leg, [*u[: leg.at], phase, *place, tau * part])
        d = there.drive
        jerk, E, E1, phi = -o.cm * there.a - o.km * there.v - o.drive * s1, d.E, d.E1, d.phi
        x0, a0 = (arb(0), -o.B0 * s0 / o.m) if place else (-o.B0 * s0 / o.k, arb(0))
        v, a = a0 * E - o.drive * d.cosine, a0 * E1 - o.drive * d.cosine1
        x = x0 - (o.B0 * (s1 - s0) + o.c * v + o.m * (a - a0)) / o.k
        rows = {"x0": [x0], "x": [x], "v": [v], "a": [a]}
        if place:
            by_x = {"x0": arb(1), "x": phi, "v": -o.km * E, "a": -o.km * E1}
            rows = {name: [*row, by_x[name]] for name, row in rows.items()}
        last = {"x0": arb(0), "x": there.v * part, "v": there.a * part, "a": jerk * part}
        return {name: [*row, last[name]] for name, row in rows.items()}

    def jacobian(self, o: Oscillator, u: Values) -> tuple[list[dict[str, Values]], list[Values]]:
        """Return the slopes of the flights, and the derivatives of the residuals; balls, or power series."""
        slopes = [self.slopes(o, leg, u) for leg in self.legs]
        rows = list[Values]()
        for i, (leg, by) in enumerate(zip(self.legs, slopes, strict=True)):
            last, follows = i + 1 == len(self.legs), (i + 1) % len(self.legs)
            then, sign = self.legs[follows].at, -1 if last and self.mirrored else 1
            meets, joins, meeting = ([arb(0)] * self.count for _ in range(3))
            for j, entry in enumerate(by["v"], leg.at):
                meets[j] = entry
            for j, entry in enumerate(by["x"], leg.at):
                joins[j] = entry
            for j, entry in enumerate(slopes[follows]["x0"], then):
                joins[j] -= sign * entry
            tau = leg.at + len(by["x"]) - 1
            if leg.stick:
                speed = o.speed[leg.piece.end]
                joins[then] += speed / o.Omega
                joins[leg.at] -= speed / o.Omega
                joins[tau] -= speed
                rows += [meets, joins]
            else:
                meeting[leg.at] += 1
                meeting[tau] += o.Omega
                meeting[then] -= 1
                rows += [meets, joins, meeting]
        return slopes, rows

    # -- the inequalities ----------------------------------------------------------------------------------------------

    def turn(self, o: Oscillator, belt: int, index: int) -> Ball:
        """Return the phase of a turn of the forces on a belt; B0 sin theta rises through one of even index."""
        if isinstance(o.speed[belt], arb) and o.speed[belt].is_zero():
            return index * arb.pi()
        angle = (-o.k * o.speed[belt] / o.drive / o.m).asin()
        return index * arb.pi() + (-angle if index % 2 else angle)

    def turns_between(self, o: Oscillator, belt: int, low: Ball, high: Ball) -> list[int]:
        """Return the indices of all turns that may lie between two phases."""
        bias = o.k * o.speed[belt]
        if abs(bias) > abs(o.B0 * o.Omega):
            return []
        if not abs(bias) < abs(o.B0 * o.Omega):
            raise NotInBox("whether the forces turn")
        first, last = int(float(low) / float(arb.pi())) - 3, int(float(high) / float(arb.pi())) + 3
        turns = [(index, self.turn(o, belt, index)) for index in range(first, last)]
        return [index for index, phase in turns if not phase < low and not phase > high]

    def drift(self, o: Oscillator, belt: int, phase: Ball) -> Ball:
        """Return the drift k v + B0 Omega sin(theta) of a belt: -m times the derivative of both forces on it."""
        return o.k * o.speed[belt] + o.B0 * o.Omega * phase.sin()

    def sections(self, o: Oscillator, leg: Leg, u: Values) -> tuple[list[int], Values] | None:
        """Return the signs of L g of a flight from a belt back to it, and the times that divide them; None: unknown."""
        phase, tau, belt = u[leg.at], u[leg.at + 2 - leg.piece.after_stick], leg.piece.start
        end = phase + o.Omega * tau
        turns = [self.turn(o, belt, index) for index in self.turns_between(o, belt, phase, end)]
        if not all(phase < turn < end for turn in turns):
            return None
        cuts = [phase, *turns, end]
        side, signs = 1 if leg.piece.mode > belt else -1, []
        for a, b in pairwise(cuts):
            value = self.drift(o, belt, ((a + b) / 2).mid())
            if not abs(value) > 0:
                return None
            signs.append(-side if value > 0 else side)
        return signs, [arb(0), *((each - phase) / o.Omega for each in turns), tau]

    def plan(self, o: Oscillator, u: Values) -> Plan:
        """Return the turns in each stick, and where each flight is cut; balls that contain all unknowns in a box."""
        flown = [self.fly(o, leg, u) for leg in self.legs]
        turns, cuts = list[tuple[int, ...]](), list[tuple[Cut, ...] | None]()
        for i, leg in enumerate(self.legs):
            end = self.onto(o, i, u, flown)[0]
            begin = u[leg.at] + o.Omega * u[leg.at + 2 - leg.piece.after_stick]
            turns.append(tuple(self.turns_between(o, leg.piece.end, begin, end)) if leg.stick else ())
            cuts.append(self.cuts(o, leg, u) if leg.piece.start == leg.piece.end else None)
        return Plan(turns, cuts)

    def cuts(self, o: Oscillator, leg: Leg, u: Values) -> tuple[Cut, ...] | None:
        """Return the times at which the gap of a flight back to its belt is evaluated; None: in short steps instead."""
        found, longest = self.sections(o, leg, u), longest_part(o)
        if found is None:
            return None
        signs, times = found
        tau, cuts, spare = float(times[-1]), list[Cut](), 2 * max(float(each.rad()) for each in times)
        for i, sign in enumerate(signs):
            low, high = float(times[i]), float(times[i + 1])
            if high - low > MOST_CUTS * longest:  # a stiff spring
                return None
            if sign < 0:
                count = int((high - low) / (SHORTER * longest))
                cuts += [Cut(low + j * (high - low) / (count + 1), 0.0) for j in range(1, count + 1)]
                continue
            low += SHORTER * longest * (i == 0)
            high -= SHORTER * longest * (i + 1 == len(signs))
            if low < high:
                count = ceil(4 * (high - low) / longest)
                half = (high - low) / count / 2
                cuts += [Cut(low + (2 * j + 1) * half, 1.05 * half + spare + tau / 1000) for j in range(count)]
        if len(cuts) > MOST_CUTS:
            return None
        return tuple(Cut(round(cut.part / tau * 1024) / 1024, cut.reach) for cut in cuts)

    def stays(self, o: Oscillator, leg: Leg, u: Values, cuts: tuple[Cut, ...]) -> bool:
        """Return whether a flight with a positive gap at the cuts has one all the time, by the signs of L g."""
        found, longest = self.sections(o, leg, u), longest_part(o)
        if found is None:
            return False
        signs, times = found
        tau, left = times[-1], list(cuts)
        for i, (sign, low, high) in enumerate(zip(signs, times[:-1], times[1:], strict=True)):
            inside = [cut for cut in left if float(tau) * cut.part < float(high)]
            left = left[len(inside) :]
            marks = [tau * cut.part for cut in inside]
            if sign < 0:
                spans = [b - a for a, b in zip([low, *marks], [*marks, high], strict=True)]
                if any(cut.reach for cut in inside) or not all(0 < span < longest for span in spans):
                    return False
                continue
            known = low + longest if i == 0 else low
            for mark, (_, reach) in zip(marks, inside, strict=True):
                if not (low < mark < high and mark - reach < known and 2 * reach < longest and reach > 0):
                    return False
                known = mark + reach
            if not known > (high - longest if i + 1 == len(signs) else high):
                return False
        return not left

    def margins(
        self, o: Oscillator, u: Values, flown: Sequence[Flown], plan: Plan, slopes: Sequence[dict[str, Values]] = ()
    ) -> list[Inequality]:
        """Return the quantities that must be positive, with derivatives if those of the flights are given."""
        found = list[Inequality]()

        def add(text: str, value: Ball, *parts: tuple[int, Values]) -> None:
            row = [arb(0)] * self.count
            for at, entries in parts if slopes else ():
                for j, entry in enumerate(entries, at):
                    row[j] += entry
            found.append(Inequality(text, value, row))

        for i, (leg, there) in enumerate(zip(self.legs, flown, strict=True)):
            piece, (phase, _), by = leg.piece, self.onto(o, i, u, flown), slopes[i] if slopes else {}
            n, then = len(by.get("a", ())), self.legs[(i + 1) % len(self.legs)].at
            side, belt = 1 if piece.mode > piece.end else -1, piece.end
            tau, jump = u[leg.at + 2 - piece.after_stick], o.jump[belt]
            speed = [-side * each for each in by.get("a", ())]
            add(f"{piece.label} lasts", tau, (leg.at + n - 1, [arb(1)]))
            add(f"{piece.label} meets belt {belt}", -side * there.a, (leg.at, speed))
            if leg.stick:
                s = 1 if leg.stick.side < 0 else -1
                lasts = (phase - u[leg.at]) / o.Omega - tau
                add(
                    f"{leg.stick.label} lasts",
                    lasts,
                    (leg.at, [-1 / o.Omega]),
                    (leg.at + n - 1, [arb(-1)]),
                    (then, [1 / o.Omega]),
                )
                add(f"{leg.stick.label} begins", jump + side * there.a, (leg.at, [-each for each in speed]))
                by_phase = [s * o.B0 * o.Omega * phase.cos()] if slopes else []
                add(f"{leg.stick.label} ends", s * self.drift(o, belt, phase), (then, by_phase))
                for index in plan.turns[i]:
                    turn = self.turn(o, belt, index)
                    force = (
                        s * (o.B0 * (turn.cos() - phase.cos()) + o.k * o.speed[belt] * (phase - turn) / o.Omega) / o.m
                    )
                    changes = [s * self.drift(o, belt, phase) / (o.Omega * o.m)] if slopes else []
                    add(f"{leg.stick.label} holds", force, (then, changes))
                    add(f"{leg.stick.label} holds", jump - force, (then, [-each for each in changes]))
            else:
                add(f"{piece.label} crosses belt {belt}", -side * there.a - jump, (leg.at, speed))
            for part, reach in plan.cuts[i] or ():
                then_there = self.fly(o, leg, [*u[: leg.at + 2 - piece.after_stick], tau * part])
                rates = self.slopes(o, leg, u, part) if slopes else {"v": [], "a": []}
                for later in (reach, -reach) if reach else (0.0,):
                    E, _, phi = o.entire(arb(later))
                    ahead = side * ((then_there.v - o.speed[belt]) * phi + then_there.a * E)
                    changes = [side * (v * phi + a * E) for v, a in zip(rates["v"], rates["a"], strict=True)]
                    add(f"v meets belt {belt} during {piece.label}", ahead, (leg.at, changes))
        return found

    def prove_flights(self, o: Oscillator, u: Values, plan: Plan) -> None:
        """Prove that no flight meets a belt before its end, given that all margins are positive; else Undecided."""
        for leg, cuts in zip(self.legs, plan.cuts, strict=True):
            piece, tau = leg.piece, u[leg.at + 2 - leg.piece.after_stick]
            sides = {belt: 1 if piece.mode > belt else -1 for belt in (piece.mode - 1, piece.mode) if belt in (1, 2)}
            speeds = {belt: o.speed[belt] for belt in sides}
            if self.beside and piece.mode != 2:  # its mirror image is between both belts
                other = 2 if piece.mode == 1 else 1
                sides[other], speeds[other] = (1 if piece.mode == 1 else -1), -o.speed[other]
            for belt, side in sides.items():
                own = belt == piece.start == piece.end
                if own and cuts is not None and self.stays(o, leg, u, cuts):
                    continue
                if belt not in (piece.start, piece.end) and self.far(o, leg, u, side * speeds[belt]):
                    continue
                zeros = 0 if belt != piece.start else 2 if piece.after_stick else 1
                gap = self.gap(o, leg, u, side, speeds[belt])
                prove_positive(Margin(piece.label, gap, zeros, belt == piece.end), tau)

    def far(self, o: Oscillator, leg: Leg, u: Values, least: Ball) -> bool:
        """Return whether the energy of its free motion keeps a flight from a belt."""
        there = self.fly(o, leg, [*u[: leg.at + 2 - leg.piece.after_stick], arb(0)])
        s0, c0 = u[leg.at].sin_cos()
        v = o.speed[leg.piece.start] - o.steady_c * c0 - o.steady_s * s0
        a = there.a0 - o.Omega * (o.steady_s * c0 - o.steady_c * s0)
        most = (v * v + a * a / o.km).upper().sqrt() + (
            o.steady_c * o.steady_c + o.steady_s * o.steady_s
        ).upper().sqrt()
        return bool(most < -least)

    def gap(self, o: Oscillator, leg: Leg, u: Values, side: int, speed: Ball) -> Callable[[Ball], Jet]:
        """Return the gap of a flight from a velocity, above it (side 1) or below it (-1)."""
        at = leg.at + 2 - leg.piece.after_stick

        def gap(tau: Ball) -> Jet:
            there = self.fly(o, leg, [*u[:at], tau])
            jerk = -o.cm * there.a - o.km * there.v - o.drive * (u[leg.at] + o.Omega * tau).sin()
            return Jet(tau, side * (there.v - speed), side * there.a, side * jerk)

        return gap


class Drive:
    """The free motion after a time, and the response E * sin(theta) and E * cos(theta) to the drive from a phase on."""

    # With lambda = -h + i omega_d and X(lambda) = int exp(lambda (tau - s) + i Omega s) ds the response to exp(i Omega
    # s) is the difference quotient of X at lambda and its conjugate. Near resonance the first X is an entire function.

    def __init__(self, o: Oscillator, phase: Ball, tau: Ball) -> None:
        begins, turned, free = imaginary(phase).exp(), imaginary(o.Omega * tau).exp(), None
        if o.damping < 0:
            root = complexed(-o.h) + imaginary(o.omega_d)
            free, rate = (root * complexed(tau)).exp(), imaginary(o.Omega) - root
            other = complexed(-o.h) - imaginary(o.omega_d)
            z = rate * complexed(tau)
            middle = z[0] if isinstance(z, acb_series) else z
            near = float(abs(middle).upper()) < NEAR
            X = free * complexed(tau) * slope_of_exp(z) if near else (turned - free) / rate
            Y = (turned - (other * complexed(tau)).exp()) / (imaginary(o.Omega) - other)
            quotient = imaginary(2 * o.omega_d)
            Z, Z1 = (X - Y) / quotient, (root * X - other * Y) / quotient
            self.E, self.E1 = part(free, 1) / o.omega_d, part(root * free, 1) / o.omega_d
        else:
            self.E, self.E1, _ = o.entire(tau)
            pull = complexed(o.km - o.Omega * o.Omega) + imaginary(o.cm * o.Omega)
            E, E1, Omega = complexed(self.E), complexed(self.E1), imaginary(o.Omega)
            Z = (turned - E1 - (complexed(o.cm) + Omega) * E) / pull
            Z1 = (Omega * turned + complexed(o.km) * E - Omega * E1) / pull
        self.phi = self.E1 + o.cm * self.E
        Z, Z1 = begins * Z, begins * Z1
        self.sine, self.cosine, self.sine1, self.cosine1 = part(Z, 1), part(Z, 0), part(Z1, 1), part(Z1, 0)
        #: cos(theta) at the end less that at the start.
        self.change = part(begins * (turned - 1), 0)


def complexed(value: Ball) -> Ball:
    """Return a real ball or series as a complex one."""
    return acb_series(value) if isinstance(value, arb_series) else acb(value)


def imaginary(value: Ball) -> Ball:
    """Return i times a real ball or series."""
    return acb_series(value) * acb_series([acb(0, 1)]) if isinstance(value, arb_series) else acb(0, value)


def part(value: Ball, imaginary: int) -> Ball:
    """Return the real or the imaginary part."""
    if not isinstance(value, acb_series):
        return value.imag if imaginary else value.real
    return arb_series([each.imag if imaginary else each.real for each in value], prec=value.prec)


def slope_of_exp(z: Ball) -> Ball:
    """Return (exp(z) - 1)/z, an entire function, of a complex ball or series whose size is less than NEAR."""
    if not isinstance(z, acb_series):
        return _derivatives_of_slope(z, 1)[0]
    found = _derivatives_of_slope(z[0], z.prec)
    change = acb_series([0, *list(z)[1:]], prec=z.prec)
    total = acb_series([found[-1]], prec=z.prec)
    for k in range(z.prec - 1, 0, -1):
        total = acb_series([found[k - 1]], prec=z.prec) + total * change / k
    return total


def _derivatives_of_slope(z: Ball, count: int) -> list[Ball]:
    """Return the first derivatives of (exp(z) - 1)/z; what was computed last is kept."""
    for known, found in _kept:
        if len(found) >= count and known.contains(z) and z.contains(known):
            return found
    size = abs(z).upper()
    n = next(n for n in range(4, len(EXP_TERMS)) if float(size) ** n * float(EXP_TERMS[n]) < EXP_ERROR)
    rest = 2 * arb(0, size**n * EXP_TERMS[n])  # the terms fall by more than a half from there on
    found = []
    for k in range(count):
        total = acb(0)
        for j in range(n - 1, -1, -1):
            total = total * z + EXP_OVER[k][j]
        found.append(total + acb(rest, rest))
    _kept.append((z, found))
    return found


class Plan(NamedTuple):
    """How the inequalities are proven: the turns in the stick after each flight, and where each flight is cut."""

    turns: list[tuple[int, ...]]
    cuts: list[tuple[Cut, ...] | None]


class Cut(NamedTuple):
    """A part of a flight with a gap > 0, and for how long before and after free motion from there has one."""

    part: float
    reach: float


class Inequality(NamedTuple):
    """A quantity that must be positive, and its derivatives by the unknowns."""

    text: str
    value: Ball
    by: Values


def longest_part(o: Oscillator) -> float:
    """Return a time surely shorter than half a period of the free motion."""
    square = (-o.kappa).upper()
    return float((arb.pi() / square.sqrt()).lower()) * (1 - 1e-12) if square > 0 else float("inf")


@contextmanager
def box_arithmetic() -> Iterator[None]:
    """Work with the precision for boxes; what cannot be decided is NotInBox."""
    before = ctx.cap
    try:
        with ctx.workprec(BOX_BITS):
            yield
    except (Undecided, ZeroDivisionError) as undecided:
        raise NotInBox(str(undecided)) from None
    finally:
        ctx.cap = before


class Surface:
    """Approximate roots for all parameters of a box: polynomials of degree 2 in the place in the box."""

    # NotInBox if the orbit near the unknowns `near` at the middle does not have the word.

    def __init__(
        self, p: Parameters, names: Sequence[str], box: Rectangle, flights: Flights, near: Sequence[float]
    ) -> None:
        self.p, self.names, self.flights = p, names, flights
        self.fixed = {name: ball(getattr(p, name)) for name in PARAMETER_NAMES}
        self.middle = [ball((low + high) / 2) for low, high in box]
        self.half = [ball((high - low) / 2) for low, high in box]
        self.range = [ball(low).union(ball(high)) for low, high in box]
        self.u = [arb(value) for value in near]
        self.slopes: list[Values] = []
        o = self.oscillator(self.middle)
        for _ in range(MOST_NEWTON):
            flown, r = flights.residuals(o, self.u)
            self.J = arb_mat(flights.jacobian(o, self.u)[1])
            self.Y = self.J.mid().inv().mid()
            step = [each.mid() for each in (self.Y * column(r)).entries()]
            self.u = [(each - change).mid() for each, change in zip(self.u, step, strict=True)]
            size = max(abs(float(each)) for each in step)
            if not size < 1e3:
                break
            if size < CONVERGED:
                worst = min(
                    flights.margins(o, self.u, flown, flights.plan(o, self.u)), key=lambda each: float(each.value)
                )
                if worst.value < 0:
                    raise NotInBox(worst.text)
                return
        raise NotInBox("a root of the closing equations")

    def oscillator(self, values: Sequence[Ball]) -> Oscillator:
        """Return the oscillator with values of both parameters."""
        return Oscillator(self.p, self.fixed | dict(zip(self.names, values, strict=True)))

    def directed(self, d: tuple[int, int], count: int, wide: bool) -> Oscillator:
        """Return the oscillator as series from the middle, or from everywhere in the box, in one direction."""
        ctx.cap = count
        base = self.range if wide else self.middle
        return self.oscillator([arb_series([b, h * e], prec=count) for b, h, e in zip(base, self.half, d, strict=True)])

    def near(self, a: float, b: float) -> tuple[float, ...]:
        """Return approximate unknowns at a place in the box."""
        return tuple(float(each) for each in (self.at(arb(a), arb(b)) if self.slopes else self.u))

    def points(self) -> list[tuple[float, float]]:
        """Return phase and position of the switchings at the middle of the box."""
        return self.flights.points(self.oscillator(self.middle), self.u)

    def at(self, a: Ball, b: Ball) -> Values:
        """Return the unknowns at a place in the box."""
        rows = zip(self.u, *self.slopes, *self.squares, strict=True)
        return [u + a * (da + a * aa + b * ab) + b * (db + b * bb) for u, da, db, aa, ab, bb in rows]

    def series(self, d: tuple[int, int], rows: Sequence[Values], count: int, wide: bool = False) -> Along:
        """Return the flights from the middle, or from all places in the box, in one direction; as power series."""
        o = self.directed(d, count, wide)
        u = [arb_series(list(each), prec=count) for each in zip(*rows, strict=True)]
        return Along(o, u, *self.flights.residuals(o, u))

    def prove(self) -> None:
        """Prove that there is an orbit for all parameters of the box, and that it has the word; NotInBox if not."""
        flights, Y, place = self.flights, self.Y, arb(0, 1)
        first = [_mids(_by(Y, [-each[1] for each in self.series(d, [self.u], 2).r])) for d in DIRECTIONS[:2]]
        thin, bends, rest = list[Along](), list[Values](), [arb(0)] * flights.count
        for d in DIRECTIONS[:3]:
            there = self.series(d, [self.u, [d[0] * a + d[1] * b for a, b in zip(*first, strict=True)]], 3)
            bends.append(_mids(_by(Y, [-each[2] for each in there.r])))
            last = [each[2] + more for each, more in zip(there.r, (self.J * column(bends[-1])).entries(), strict=True)]
            for part in ([each[0] for each in there.r], [each[1] for each in there.r], last):
                rest = [each + 3 * abs(more) for each, more in zip(rest, _by(Y, part), strict=True)]
            thin.append(there)
        self.slopes, (aa, bb, both) = first, bends
        self.squares = [aa, [c - a - b for a, b, c in zip(aa, bb, both, strict=True)], bb]
        wide, surface = self.oscillator(self.range), self.at(place, place)
        plan = flights.plan(wide, surface)
        low, rises = self._linear(thin, plan)

        cubes, curves = list[Values](), list[list[Ball]]()
        for d in DIRECTIONS:
            rows = [surface, *self._derivatives(d, place)]
            there = self.series(d, rows, 4, True)
            cubes.append(_by(Y, [each[3] for each in there.r]))
            curves.append([_part(each.value, 2) for each in flights.margins(there.o, there.u, there.flown, plan)])
        A, D = cubes[:2]
        B = [(s - m) / 2 - d for s, m, d in zip(*cubes[2:], D, strict=True)]
        C = [(s + m) / 2 - a for s, m, a in zip(*cubes[2:], A, strict=True)]
        pushed = [abs(r) + sum(map(abs, each), arb(0)) for r, *each in zip(rest, A, B, C, D, strict=True)]
        pushed = [each.upper() for each in pushed]
        sizes = [max(float(abs(a) / p) for a, p in zip(each, pushed, strict=True)) for each in (A, D)]
        along = int(sizes[1] > sizes[0])
        tube, slopes = self._tube(wide, surface, pushed, along)

        whole = [each + arb(0, r) for each, r in zip(surface, tube, strict=True)]
        again = flights.plan(wide, whole)
        if not all(set(new) <= set(old) for new, old in zip(again.turns, plan.turns, strict=True)):
            raise NotInBox("which turns are in a stick", along)
        flown = [flights.fly(wide, leg, whole) for leg in flights.legs]
        for i, each in enumerate(flights.margins(wide, whole, flown, plan, slopes)):
            bent = [curve[i] for curve in curves[:3]]
            mixed = abs(bent[2] - bent[0] - bent[1])
            near = sum((abs(by) * r for by, r in zip(each.by, tube, strict=True)), arb(0))
            if not low[i] + bent[0].min(arb(0)) + bent[1].min(arb(0)) - mixed - near > 0:
                raise NotInBox(each.text, rises[i])
        flights.prove_flights(wide, whole, plan)

    def _derivatives(self, d: tuple[int, int], place: Ball) -> tuple[Values, Values]:
        """Return the coefficients of the surface from anywhere in the box in a direction."""
        rows, (i, j) = list(zip(*self.slopes, *self.squares, strict=True)), d
        slopes = [
            i * (da + place * (2 * aa) + place * ab) + j * (db + place * (2 * bb) + place * ab)
            for da, db, aa, ab, bb in rows
        ]
        return slopes, [i * i * aa + i * j * ab + j * j * bb for _, _, aa, ab, bb in rows]

    def _linear(self, thin: Sequence[Along], plan: Plan) -> tuple[Values, list[int]]:
        """Return the least values of the margins without their second derivatives, and where each falls most."""
        low, rises = list[Ball](), list[int]()
        pairs = [self.flights.margins(each.o, each.u, each.flown, plan) for each in thin[:2]]
        for one, other in zip(*pairs, strict=True):
            a, b = (abs(_part(each.value, 1)) for each in (one, other))
            low.append(_part(one.value, 0) - a - b)
            rises.append(int(b > a))
            if low[-1] < 0:
                raise NotInBox(one.text, rises[-1])
        return low, rises

    def _tube(
        self, wide: Oscillator, surface: Values, pushed: Values, along: int
    ) -> tuple[Values, list[dict[str, Values]]]:
        """Return how far from the surface the roots may be, and the slopes of the flights there (Krawczyk)."""
        flights, tube = self.flights, [INFLATION * each for each in pushed]
        for _ in range(MOST_INFLATIONS):
            tube = [(INFLATION * each).mid() for each in tube]
            around = [arb(0, each) for each in tube]
            thin = flights.jacobian(self.oscillator(self.middle), [a + b for a, b in zip(self.u, around, strict=True)])[
                1
            ]
            parts = [unit_matrix(flights.count) - self.Y * arb_mat(thin)]
            for d in DIRECTIONS[:2]:
                ctx.cap = 2
                u = [
                    [a + b, slope]
                    for a, b, slope in zip(surface, around, self._derivatives(d, arb(0, 1))[0], strict=True)
                ]
                o = self.directed(d, 2, True)
                slopes, rows = flights.jacobian(o, [arb_series(each, prec=2) for each in u])
                parts.append(self.Y * arb_mat([[_part(each, 1) for each in row] for row in rows]))
            apart = [
                [sum(map(abs, each), arb(0)) for each in zip(*rows, strict=True)]
                for rows in zip(*(each.tolist() for each in parts), strict=True)
            ]
            image = [
                p + sum((entry * r for entry, r in zip(row, tube, strict=True)), arb(0))
                for p, row in zip(pushed, apart, strict=True)
            ]
            if all(each < r for each, r in zip(image, tube, strict=True)):
                slopes = [{name: [_part(each, 0) for each in row] for name, row in by.items()} for by in slopes]
                return tube, slopes
            excess = max(
                sum(float(e) * float(r) for e, r in zip(row, pushed, strict=True)) / float(p)
                for row, p in zip(apart, pushed, strict=True)
            )
            tube = [each.upper() for each in image]
            if not excess < 1 or not all(each < 10 for each in tube):
                break
        raise NotInBox("one root for all parameters", along, excess)


class Along(NamedTuple):
    """The flights of a word as power series in one direction."""

    o: Oscillator
    u: Values
    flown: list[Flown]
    r: Values


def _part(value: Ball, order: int) -> Ball:
    """Return a coefficient of a series; a ball is a constant."""
    return value[order] if isinstance(value, arb_series) else value if order == 0 else arb(0)


def _by(Y: arb_mat, values: Values) -> Values:
    """Return the product of a matrix and a vector."""
    entries: Values = (Y * column(values)).entries()
    return entries


def _mids(values: Values) -> Values:
    """Return the middles of balls."""
    return [each.mid() for each in values]
