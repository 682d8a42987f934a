"""A box of two parameters, proven: for all of its values one word has an orbit, which is the
attracting motion.

The closing equations of an orbit have as few unknowns as possible: of each flight its phase at the
start, its duration, and its position if it starts with a crossing; where a stick ends, the force
says the position. If oscillator and word are symmetric, half a period is enough: the rest is its
mirror image.

Let delta be the place in the box, each component in [-1, 1], and c(delta) a polynomial of degree 2
near the surface of roots. By Taylor's theorem along the line from the middle f(c(delta), delta) is
a polynomial of degree 2, all of whose coefficients are nearly 0, plus a cubic form with
coefficients at another place of the box. The forms are found from exact directions, so that what
cancels in them does so before the place is a ball. The Jacobian is that at the middle plus its
change along both sides. The rest is Krawczyk's proof.

The inequalities of the word follow from a few numbers (`BoxEquations.margins`), by Taylor's theorem of
order 2:

- At the end of a flight the acceleration says how v meets the belt, and whether it crosses or
  sticks.
- During a stick the forces are monotone between the turns (Theta_cr), so their values there
  suffice.
- During a flight the gap g has m L g = drift, of one sign between the turns, and on a part shorter
  than half a period of the free motion a solution y of L y = 0 has one zero at most (Polya). So g >
  0 where L g <= 0 if g >= 0 at both ends of the part. Where L g >= 0, g is not below the y with the
  same value and slope at one point: g > 0 after a start with g = 0 <= g', before an end with g = 0
  >= g', and where the y of a point between is > 0 at both ends of the part. Where this does not do,
  short steps do.

With c > 0 an admissible orbit attracts all motions (`symosc.orbits.floquet`): a point of the box
has this word and no other. On a belt with the speed 0 the mass may rest where mu FN >= |B0|, and
only there; rational numbers decide that.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import ceil
from typing import NamedTuple

from flint import acb, acb_series, arb, arb_mat, arb_series, ctx

from symosc.certificates.balls import (
    Ball,
    Jet,
    OscillatorInBalls,
    SignedGap,
    Undecided,
    Values,
    ball,
    belts_around,
    coefficient,
    column,
    entire_0f1,
    prove_positive,
    unit_matrix,
)
from symosc.friction import TWO_BELTS
from symosc.model import Parameters, by_name
from symosc.orbits.closing_equations import OrbitPiece, pieces_of
from symosc.words import Word

BOX_BITS = 64
MOST_NEWTON = 12
CONVERGED = 1e-13
#: A change of an unknown from which Newton's method does not come back.
MOST_CHANGE = 1e3
MOST_INFLATIONS = 5
#: A tube around the surface that is wider will not become narrow again.
MOST_TUBE = 10
INFLATION = 1.1
#: The longest part of a flight between two cuts, as a part of half a period of the free motion.
SHORTER = 0.95
MOST_CUTS = 12
#: Where L g >= 0: how many cuts there are to the longest part, and how much further than half their
#: distance they reach.
CUTS_OF_LONGEST = 4
REACH = 1.05
#: More turns on each side than are between two phases by rounding to multiples of pi: surely enough.
SPARE_TURNS = 3
#: The time of a cut is rounded to a multiple of 1/SHARES of the duration of its flight.
SHARES = 1024
#: The directions in a box in which series are computed.
DIRECTIONS = ((1, 0), (0, 1), (1, 1), (1, -1))

#: (exp(z) - 1)/z is computed without the division where |z| is less.
NEAR = 3.0

Rectangle = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]


class Cut(NamedTuple):
    """A point of a flight at which the proof looks at the gap g, after a `share` of its duration.

    Where L g <= 0 the gap itself must be > 0 there (`reach` is 0). Where L g >= 0 the free motion
    y with the value and slope of g must be > 0 for a time `reach` before and after it: g is not
    below y as long as Polya's theorem holds, that is over less than half a free period.
    """

    share: float
    reach: float


class Section(NamedTuple):
    """A part of a flight back to its belt between two turns: the sign of L g (of its gap g) there,
    and the times after the start of the flight at which it begins and ends.
    """

    sign: int
    begin: Ball
    end: Ball


class PositiveQuantity(NamedTuple):
    """A quantity that must be positive, and its derivatives with respect to the unknowns."""

    text: str
    value: Ball
    slopes: Values


class FlightChecks(NamedTuple):
    """Where the margins of a word are evaluated: at the turns in the stick after each flight, and at
    the cuts of each flight (None: short steps instead).
    """

    turns: list[list[int]]
    cuts: list[list[Cut] | None]


class MarginInParts(NamedTuple):
    """A margin: its text, its value, and its derivatives in `parts`, of which each has those by the
    unknowns from an index on.
    """

    text: str
    value: Ball
    parts: tuple[tuple[int, Values], ...]


class NotInBox(Exception):
    """Raised if a word cannot be proven in a box of two parameters.

    `along` is the side along which to divide the box, `excess` an estimate of how many times too
    large it is.
    """

    def __init__(self, what: str, along: int | None = None, excess: float = 1) -> None:
        self.along = along
        self.excess = excess
        super().__init__(what)


class Leg(NamedTuple):
    """A flight of a word, the indices of its phase and duration in the unknowns, and the stick
    after it, if any.
    """

    piece: OrbitPiece
    at: int
    tau: int
    stick: OrbitPiece | None

    @property
    def side(self) -> int:
        """The side from which the flight meets the belt at its end: 1 from above, -1 from below."""
        if self.piece.mode > self.piece.end:
            return 1
        return -1


def mirrors(p: Parameters, names: Sequence[str] = ()) -> dict[int, int]:
    """Return the mirror image of each mode if, for any `names`, x = A0/k and v = 0 is a centre of
    symmetry; else {}.
    """
    # It is symmetric if the belts are alike with opposite speeds, or if one has no friction and the
    # other no speed.
    stick = TWO_BELTS.stick_mode
    if not {"v1", "v2", "mu1", "mu2"} & set(names) and p.v1 == -p.v2 and p.mu1 == p.mu2:
        return {1: 3, 2: 2, 3: 1, stick(1): stick(2), stick(2): stick(1)}
    for belt, other in ((1, 2), (2, 1)):
        are_fixed = not {f"v{belt}", f"mu{other}"} & set(names)
        stands_still = p.belt(belt) == 0
        acts_alone = getattr(p, f"mu{other}") == 0
        if are_fixed and stands_still and acts_alone:
            return {belt: belt + 1, belt + 1: belt, stick(belt): stick(belt)}
    return {}


class BoxFlight:
    """A flight of a word, followed for a time `tau`: x0 and a0 at its start; x, v and a at its end.

    The unknowns `u` of the orbit are balls or power series. E, E1 = E' and phi are the motions
    without drive of `symosc.certificates.balls`. The response of v to the drive is the integral of
    E(tau - s) sin(theta(s)) over s. If the motion is underdamped, let lambda = -c/2m + i omega_d,
    and let X(lambda) be the integral of exp(lambda (tau - s) + i Omega s) over s. The response to
    exp(i Omega s) is (X(lambda) - X(-c/2m - i omega_d))/(2 i omega_d). Near resonance X(lambda) is
    computed without a division.
    """

    def __init__(self, o: OscillatorInBalls, leg: Leg, u: Values, tau: Ball) -> None:
        phase = u[leg.at]
        speed = o.speed[leg.piece.start]
        A = o.A[leg.piece.mode]
        begins = times_i(phase).exp()
        turned = times_i(o.Omega * tau).exp()
        if o.damping < 0:
            root, other = (complexed(-o.h) + times_i(side * o.omega_d) for side in (1, -1))
            free = (root * complexed(tau)).exp()
            rate = times_i(o.Omega) - root
            z = rate * complexed(tau)
            middle = z[0] if isinstance(z, acb_series) else z
            # X and Y are the integrals of the docstring for both roots, Z and Z1 the responses of v
            # and of its derivative, for a drive that begins with the phase 0.
            if float(abs(middle).upper()) < NEAR:
                # (exp(z) - 1)/z = exp(z/2) sinh(z/2)/(z/2)
                slope = (z / 2).exp() * entire_0f1(acb(1.5), z * z / 16)
                X = free * complexed(tau) * slope
            else:
                X = (turned - free) / rate
            Y = (turned - (other * complexed(tau)).exp()) / (times_i(o.Omega) - other)
            quotient = times_i(2 * o.omega_d)
            Z = (X - Y) / quotient
            Z1 = (root * X - other * Y) / quotient
            self.E = component(free, 1) / o.omega_d
            self.E1 = component(root * free, 1) / o.omega_d
        else:
            self.E, self.E1, _ = o.entire(tau)
            pull = complexed(o.km - o.Omega * o.Omega) + times_i(o.cm * o.Omega)
            E = complexed(self.E)
            E1 = complexed(self.E1)
            Omega = times_i(o.Omega)
            Z = (turned - E1 - (complexed(o.cm) + Omega) * E) / pull
            Z1 = (Omega * turned + complexed(o.km) * E - Omega * E1) / pull
        self.phi = self.E1 + o.cm * self.E
        Z = begins * Z
        Z1 = begins * Z1
        sine = component(Z, 1)
        self.cosine = component(Z, 0)
        sine1 = component(Z1, 1)
        self.cosine1 = component(Z1, 0)
        if leg.piece.after_stick:  # the force says the position
            self.x0 = (A + o.B0 * phase.cos() - o.c * speed) / o.k
            self.a0 = arb(0)
        else:
            self.x0 = u[leg.at + 1]
            self.a0 = (A + o.B0 * phase.cos() - o.k * self.x0 - o.c * speed) / o.m
        self.v = speed * self.phi + self.a0 * self.E - o.drive * sine
        self.a = self.a0 * self.E1 - speed * o.km * self.E - o.drive * sine1
        change = component(begins * (turned - 1), 0)  # of cos(theta)
        self.x = self.x0 + (o.B0 * change - o.c * (self.v - speed) - o.m * (self.a - self.a0)) / o.k

    def jerk(self, o: OscillatorInBalls, sine: Ball) -> Ball:
        """Return the derivative of the acceleration at the end of the flight.

        `sine` is the sine of the phase there.
        """
        return -o.cm * self.a - o.km * self.v - o.drive * sine


class BoxEquations:
    """The closing equations of a word in balls, to prove its orbits over a box of parameters.

    The unknowns are, for each flight, phase and x at its start and its duration. After a stick x is
    no unknown: it follows from the force, which is 0 where the stick ends.
    """

    # `labels` begin with a flight; if their second half is the mirror image of the first, only the
    # first is followed.

    def __init__(self, labels: tuple[str, ...], mirror: dict[int, int]) -> None:
        self.pieces = pieces_of(Word(labels))
        half, odd = divmod(len(labels), 2)
        modes = [piece.mode for piece in self.pieces]
        self.mirrored = not odd and [mirror.get(mode) for mode in modes[:half]] == modes[half:]
        #: The image of one belt at rest; the other belt is not symmetric.
        self.beside = self.mirrored and mirror.get(1) != 3
        if self.mirrored:
            used = self.pieces[:half]
        else:
            used = self.pieces
        self.legs = list[Leg]()
        self.count = 0
        for piece, after in zip(used, [*used[1:], None], strict=True):
            if not piece.sticks:
                # The unknowns of a flight: its phase, its x unless it follows a stick, its duration.
                tau = self.count + 2 - piece.after_stick
                stick = after if after and after.sticks else None
                self.legs.append(Leg(piece, self.count, tau, stick))
                self.count = tau + 1

    def unknowns(self, Omega: float, points: Sequence[tuple[float, float]]) -> list[float]:
        """Return the unknowns of an orbit from its switching points (phase, x), one for each label
        of the word.
        """
        # Phases that never decrease, that of the first point again at the end.
        starts, positions = zip(*points, strict=True)
        first = starts[0]
        period = 2 * float(arb.pi())
        phases = [*(phase + period * (phase < first) for phase in starts), first + period]
        flights = [i for i, piece in enumerate(self.pieces) if not piece.sticks][: len(self.legs)]
        unknowns = list[float]()
        for i, leg in zip(flights, self.legs, strict=True):
            unknowns.append(phases[i])
            if not leg.piece.after_stick:
                unknowns.append(positions[i])
            unknowns.append((phases[i + 1] - phases[i]) / Omega)
        return unknowns

    def points(self, o: OscillatorInBalls, u: Values) -> list[tuple[float, float]]:
        """Return phase and position of the switching point at which each label begins, from the
        unknowns `u`.
        """
        points = list[tuple[float, float]]()
        for leg, flight in zip(self.legs, self.flown(o, u), strict=True):
            points.append((float(u[leg.at]), float(flight.x0)))
            if leg.stick:
                points.append((float(u[leg.at] + o.Omega * u[leg.tau]), float(flight.x)))
        if self.mirrored:
            # The image of x is 2 A0/k - x, half a period later; A1 + A3 = 2 A0.
            twice_centre = float((o.A[1] + o.A[3]) / o.k)
            points += [(phase + float(arb.pi()), twice_centre - x) for phase, x in points]
        return points

    def flown(self, o: OscillatorInBalls, u: Values) -> list[BoxFlight]:
        """Return all flights of the oscillator `o`, with the unknowns `u` of an orbit, followed to
        their ends.
        """
        return [BoxFlight(o, leg, u, u[leg.tau]) for leg in self.legs]

    def next_start(
        self, o: OscillatorInBalls, i: int, u: Values, flown: Sequence[BoxFlight]
    ) -> tuple[Ball, Ball]:
        """Return phase and position at the start of the flight after flight i.

        `flown` has all flights.
        """
        if i + 1 < len(self.legs):
            return u[self.legs[i + 1].at], flown[i + 1].x0
        # The first flight again, a period later, or its mirror image, half a period later.
        x = flown[0].x0
        if self.mirrored:
            x = (o.A[1] + o.A[3]) / o.k - x
        return u[0] + (2 - self.mirrored) * arb.pi(), x

    def residuals(self, o: OscillatorInBalls, u: Values) -> tuple[list[BoxFlight], Values]:
        """Return the flights followed to their ends, and the residuals of the closing equations."""
        flown = self.flown(o, u)
        residuals = list[Ball]()
        for i, (leg, flight) in enumerate(zip(self.legs, flown, strict=True)):
            speed = o.speed[leg.piece.end]
            phase, x = self.next_start(o, i, u, flown)
            start = u[leg.at]
            tau = u[leg.tau]
            residuals.append(flight.v - speed)
            if leg.stick:
                # The belt carries the mass on until the next flight starts.
                residuals.append(flight.x + speed * ((phase - start) / o.Omega - tau) - x)
            else:
                residuals += [flight.x - x, start + o.Omega * tau - phase]
        return flown, residuals

    def slopes(
        self, o: OscillatorInBalls, leg: Leg, u: Values, share: float = 1
    ) -> dict[str, Values]:
        """Return a dict of derivatives by a flight's unknowns: of x0, and of x, v, a after a
        `share` of its time.
        """
        # A later start changes the drive, and what the flight starts with: x0 after a stick (there
        # the force is 0), else the acceleration a0.
        tau = u[leg.tau] * share
        d = BoxFlight(o, leg, u, tau)
        s0 = u[leg.at].sin()
        s1 = (u[leg.at] + o.Omega * tau).sin()
        crossed = not leg.piece.after_stick
        if crossed:
            x0 = arb(0)
            a0 = -o.B0 * s0 / o.m
        else:
            x0 = -o.B0 * s0 / o.k
            a0 = arb(0)
        v = a0 * d.E - o.drive * d.cosine
        a = a0 * d.E1 - o.drive * d.cosine1
        x = x0 - (o.B0 * (s1 - s0) + o.c * v + o.m * (a - a0)) / o.k
        by_phase = {"x0": x0, "x": x, "v": v, "a": a}
        if crossed:
            by_x = {"x0": arb(1), "x": d.phi, "v": -o.km * d.E, "a": -o.km * d.E1}
        else:
            by_x = {}
        by_tau = {"x0": arb(0), "x": d.v * share, "v": d.a * share, "a": d.jerk(o, s1) * share}
        return {name: [by[name] for by in (by_phase, by_x, by_tau) if by] for name in by_tau}

    def jacobian(
        self, o: OscillatorInBalls, u: Values
    ) -> tuple[list[dict[str, Values]], list[Values]]:
        """Return the `slopes` of all flights, and the Jacobian of the residuals as a list of rows."""
        slopes = [self.slopes(o, leg, u) for leg in self.legs]
        rows = list[Values]()
        for i, (leg, by) in enumerate(zip(self.legs, slopes, strict=True)):
            follows = (i + 1) % len(self.legs)
            next_phase = self.legs[follows].at  # its index in the unknowns
            if follows == 0 and self.mirrored:
                sign = -1  # x of a mirror image
            else:
                sign = 1
            # The rows of the residuals: v is that of the belt, x and (without stick) the phase join
            # on. First by the flight's own unknowns, which are next to each other.
            v_row, x_row, phase_row = ([arb(0)] * self.count for _ in range(3))
            own = slice(leg.at, leg.tau + 1)
            v_row[own] = by["v"]
            x_row[own] = by["x"]
            # Then by those of the next flight, where x has to be its x0 or the image of this.
            for j, entry in enumerate(slopes[follows]["x0"], next_phase):
                x_row[j] -= sign * entry
            rows += [v_row, x_row]
            # Last the time of the stick, which moves x on, or the phase that has to join on.
            if leg.stick:
                speed = o.speed[leg.piece.end]
                for j, entry in (
                    (next_phase, speed / o.Omega),
                    (leg.at, -speed / o.Omega),
                    (leg.tau, -speed),
                ):
                    x_row[j] += entry
            else:
                for j, entry in ((leg.at, 1), (leg.tau, o.Omega), (next_phase, -1)):
                    phase_row[j] += entry
                rows.append(phase_row)
        return slopes, rows

    # -- the inequalities --------------------------------------------------------------------------

    def turn(self, o: OscillatorInBalls, belt: int, index: int) -> Ball:
        """Return a phase at which k v + B0 Omega sin theta = 0 on a belt.

        Sin theta rises there for an even `index`.
        """
        angle = (-o.k * o.speed[belt] / o.drive / o.m).asin()
        return index * arb.pi() + (-angle if index % 2 else angle)

    def turns_between(self, o: OscillatorInBalls, belt: int, low: Ball, high: Ball) -> list[int]:
        """Return the indices of all turns of the forces on a belt that may lie between the phases
        `low` and `high`.
        """
        bias = abs(o.k * o.speed[belt])
        swing = abs(o.B0 * o.Omega)
        if bias > swing:
            return []
        if not bias < swing:
            raise NotInBox("whether the forces turn")
        # A turn is at most pi/2 away from index pi.
        first = int(float(low) / float(arb.pi())) - SPARE_TURNS
        last = int(float(high) / float(arb.pi())) + SPARE_TURNS
        turns = [(index, self.turn(o, belt, index)) for index in range(first, last)]
        return [index for index, phase in turns if not phase < low and not phase > high]

    def drift(self, o: OscillatorInBalls, belt: int, phase: Ball) -> Ball:
        """Return k v + B0 Omega sin(theta), that is -m dF/dt of both forces on a belt of speed v,
        at a phase theta.
        """
        return o.k * o.speed[belt] + o.B0 * o.Omega * phase.sin()

    def sections(self, o: OscillatorInBalls, leg: Leg, u: Values) -> list[Section] | None:
        """Return the parts of a flight back to its belt between the turns of the drift, or None if
        the order of the turns or a sign is undecided.
        """
        phase = u[leg.at]
        belt = leg.piece.start
        sections = list[Section]()
        end = phase + o.Omega * u[leg.tau]
        turns = [self.turn(o, belt, index) for index in self.turns_between(o, belt, phase, end)]
        if not all(phase < turn < end for turn in turns):
            return None
        times = [arb(0), *((turn - phase) / o.Omega for turn in turns), u[leg.tau]]
        for (first_phase, last_phase), (low, high) in zip(
            pairwise([phase, *turns, end]), pairwise(times), strict=True
        ):
            # The drift has one sign between two turns: its value in the middle shows it.
            value = self.drift(o, belt, ((first_phase + last_phase) / 2).mid())
            if not abs(value) > 0:
                return None
            sign = -leg.side if value > 0 else leg.side
            sections.append(Section(sign, low, high))
        return sections

    def plan(self, o: OscillatorInBalls, u: Values) -> FlightChecks:
        """Return how to prove the word for all unknowns in the balls u: turns in each stick, and
        cuts of each flight.

        A cut is a point of a flight at which the gap is shown to be > 0; a flight that needs short
        steps has None.
        """
        flown = self.flown(o, u)
        turns = list[list[int]]()
        cuts = list[list[Cut] | None]()
        for i, leg in enumerate(self.legs):
            end, _ = self.next_start(o, i, u, flown)
            begin = u[leg.at] + o.Omega * u[leg.tau]
            turns.append(self.turns_between(o, leg.piece.end, begin, end) if leg.stick else [])
            cuts.append(self.cuts(o, leg, u) if leg.piece.start == leg.piece.end else None)
        return FlightChecks(turns, cuts)

    def cuts(self, o: OscillatorInBalls, leg: Leg, u: Values) -> list[Cut] | None:
        """Return the points of a flight back to its belt at which to show that its gap is > 0, so
        that `stays` can conclude it for the whole flight; None if the flight needs short steps.
        """
        sections = self.sections(o, leg, u)
        longest = longest_part(o)
        if sections is None:
            return None
        tau = float(u[leg.tau])
        # Reaches must overlap although shares are rounded below (by tau/SHARES) and sections end at
        # balls of times.
        spare = 2 * max(float(section.end.rad()) for section in sections) + tau / 1000
        times_and_reaches = list[tuple[float, float]]()
        for i, section in enumerate(sections):
            low = float(section.begin)
            high = float(section.end)
            if high - low > MOST_CUTS * longest:  # a stiff spring
                return None
            if section.sign < 0:
                times_and_reaches += [(time, 0.0) for time in _dividing(low, high, longest)]
                continue
            # Near the start and the end of the flight g = 0 there already shows that g > 0.
            if i == 0:
                low += SHORTER * longest
            if i + 1 == len(sections):
                high -= SHORTER * longest
            if low < high:
                times_and_reaches += _reaching(low, high, longest, spare)
        if len(times_and_reaches) > MOST_CUTS:
            return None
        return [
            Cut(round(time / tau * SHARES) / SHARES, reach) for time, reach in times_and_reaches
        ]

    def stays(self, o: OscillatorInBalls, leg: Leg, u: Values, cuts: list[Cut]) -> bool:
        """Return whether the gap of a flight back to its belt is > 0 all the time, if it is > 0 at
        the `cuts`.
        """
        sections = self.sections(o, leg, u)
        longest = longest_part(o)
        tau = u[leg.tau]
        unused = list(cuts)
        if sections is None:
            return False
        for i, (sign, low, high) in enumerate(sections):
            inside = [
                (tau * share, reach) for share, reach in unused if float(tau) * share < float(high)
            ]
            unused = unused[len(inside) :]
            if sign < 0:
                # L g <= 0: by Polya's theorem g > 0 between two points less than `longest` apart.
                times = [low, *(time for time, _ in inside), high]
                are_short = all(0 < later - time < longest for time, later in pairwise(times))
                if any(reach for _, reach in inside) or not are_short:
                    return False
                continue
            # L g >= 0: up to `positive_until` the gap is > 0, at first for the time in which its
            # start with g = 0 shows that, then to where each cut reaches.
            positive_until = low
            if i == 0:
                positive_until = low + longest
            for time, reach in inside:
                is_joined = low < time < high and time - reach < positive_until
                if not (is_joined and 2 * reach < longest and reach > 0):
                    return False
                positive_until = time + reach
            # The end with g = 0 shows it for the time before.
            needed = high
            if i + 1 == len(sections):
                needed = high - longest
            if not positive_until > needed:
                return False
        return not unused

    def margins(
        self,
        o: OscillatorInBalls,
        u: Values,
        flown: Sequence[BoxFlight],
        plan: FlightChecks,
        slopes: Sequence[dict[str, Values]] = (),
    ) -> list[PositiveQuantity]:
        """Return the margins, which must be > 0 for the word: each one's text, value, and
        derivatives by the unknowns.

        `flown` has the flights, and `plan` the turns and cuts at which to look. Without `slopes`
        the derivatives are 0.
        """
        inequalities = list[PositiveQuantity]()
        for i, (leg, flight) in enumerate(zip(self.legs, flown, strict=True)):
            phase, _ = self.next_start(o, i, u, flown)
            # The flight meets the belt if its acceleration leads towards it.
            meets = -leg.side * flight.a
            by_meets = [-leg.side * slope for slope in slopes[i]["a"]] if slopes else []
            of_leg = [
                *self._margins_at_end(o, leg, u, meets, by_meets),
                *self._margins_of_stick(o, i, u, phase, meets, by_meets, plan.turns[i]),
                *self._margins_at_cuts(o, leg, u, plan.cuts[i] or (), bool(slopes)),
            ]
            for text, value, parts in of_leg:
                row = [arb(0)] * self.count
                for first, entries in parts if slopes else ():
                    for j, entry in enumerate(entries, first):
                        row[j] += entry
                inequalities.append(PositiveQuantity(text, value, row))
        return inequalities

    def _margins_at_end(
        self, o: OscillatorInBalls, leg: Leg, u: Values, meets: Ball, by_meets: Values
    ) -> Iterator[MarginInParts]:
        """Yield that a flight lasts, that it meets the belt at its end and, unless a stick follows,
        that it crosses the belt.

        `meets` is its acceleration towards the belt there, `by_meets` its derivatives.
        """
        label = leg.piece.label
        belt = leg.piece.end
        parts = ((leg.at, by_meets),)
        yield MarginInParts(f"{label} lasts", u[leg.tau], ((leg.tau, [arb(1)]),))
        yield MarginInParts(f"{label} meets belt {belt}", meets, parts)
        if not leg.stick:
            # The mass crosses if the acceleration exceeds the jump of the force, else it sticks.
            yield MarginInParts(f"{label} crosses belt {belt}", meets - o.jump[belt], parts)

    def _margins_of_stick(
        self,
        o: OscillatorInBalls,
        i: int,
        u: Values,
        phase: Ball,
        meets: Ball,
        by_meets: Values,
        turns: Sequence[int],
    ) -> Iterator[MarginInParts]:
        """Yield that the stick after flight i, if there is one, lasts, begins, ends at `phase`, and
        that both forces hold the mass at the `turns`.

        `meets` is the flight's acceleration towards the belt, `by_meets` its derivatives.
        """
        leg = self.legs[i]
        stick = leg.stick
        if stick is None:
            return
        next_phase = self.legs[(i + 1) % len(self.legs)].at  # its index in the unknowns
        belt = leg.piece.end
        jump = o.jump[belt]
        lasts = (phase - u[leg.at]) / o.Omega - u[leg.tau]
        by_lasts = (
            (leg.at, [-1 / o.Omega]),
            (leg.tau, [arb(-1)]),
            (next_phase, [1 / o.Omega]),
        )
        yield MarginInParts(f"{stick.label} lasts", lasts, by_lasts)
        by_begins = [-slope for slope in by_meets]
        yield MarginInParts(f"{stick.label} begins", jump - meets, ((leg.at, by_begins),))
        # The sign with which the drift of the force that ends the stick is > 0.
        sign = 1 if stick.side < 0 else -1
        drift = sign * self.drift(o, belt, phase)
        drift_slope = sign * o.B0 * o.Omega * phase.cos()
        yield MarginInParts(f"{stick.label} ends", drift, ((next_phase, [drift_slope]),))
        # The force that ends the stick is 0 at `phase`: so its value at a turn is its change from
        # there, and that on the other side of the belt is the jump less it.
        for turn in (self.turn(o, belt, index) for index in turns):
            rises = (
                o.B0 * (turn.cos() - phase.cos()) + o.k * o.speed[belt] * (phase - turn) / o.Omega
            )
            force = sign * rises / o.m
            change = drift / (o.Omega * o.m)
            yield MarginInParts(f"{stick.label} holds", force, ((next_phase, [change]),))
            yield MarginInParts(f"{stick.label} holds", jump - force, ((next_phase, [-change]),))

    def _margins_at_cuts(
        self, o: OscillatorInBalls, leg: Leg, u: Values, cuts: Sequence[Cut], with_slopes: bool
    ) -> Iterator[MarginInParts]:
        """Yield that the gap of a flight is > 0 at its cuts: that of the free motion with the value
        and slope at the cut, at both ends of its reach; without reach the gap at the cut itself.
        """
        belt = leg.piece.end
        text = f"v meets belt {belt} during {leg.piece.label}"
        for share, reach in cuts:
            cut = BoxFlight(o, leg, u, u[leg.tau] * share)
            if with_slopes:
                rates = self.slopes(o, leg, u, share)
            else:
                rates = {"v": [], "a": []}
            for later in (reach, -reach) if reach else (0.0,):
                E, _, phi = o.entire(arb(later))
                ahead = leg.side * ((cut.v - o.speed[belt]) * phi + cut.a * E)
                changes = [
                    leg.side * (v * phi + a * E)
                    for v, a in zip(rates["v"], rates["a"], strict=True)
                ]
                yield MarginInParts(text, ahead, ((leg.at, changes),))

    def prove_flights(self, o: OscillatorInBalls, u: Values, plan: FlightChecks) -> None:
        """Prove that no flight meets a belt before its end, if all margins are > 0.

        Raise Undecided if that fails.
        """
        for leg, cuts in zip(self.legs, plan.cuts, strict=True):
            piece = leg.piece
            # For each belt that it may meet: from which side, and the speed.
            sides = {
                belt: (1 if piece.mode > belt else -1, o.speed[belt])
                for belt in belts_around(piece.mode)
            }
            if self.beside and piece.mode != 2:
                # Its mirror image, with -v, is between both belts: it must not meet the other one.
                if piece.mode == 1:
                    sides[2] = 1, -o.speed[2]
                else:
                    sides[1] = -1, -o.speed[1]
            for belt, (side, speed) in sides.items():
                returns = belt == piece.start == piece.end
                if returns and cuts is not None and self.stays(o, leg, u, cuts):
                    continue
                # How many of g and g' are 0 where the flight starts; `SignedGap.at_start`.
                if belt != piece.start:
                    zeros = 0
                elif piece.after_stick:
                    zeros = 2
                else:
                    zeros = 1
                gap = partial(self.gap, o, leg, u, side, speed)
                prove_positive(SignedGap(piece.label, gap, zeros, belt == piece.end), u[leg.tau])

    def gap(
        self, o: OscillatorInBalls, leg: Leg, u: Values, side: int, speed: Ball, tau: Ball
    ) -> Jet:
        """Return how far a flight is above (side 1) or below (side -1) a velocity `speed` at a time
        after its start.
        """
        there = BoxFlight(o, leg, u, tau)
        jerk = there.jerk(o, (u[leg.at] + o.Omega * tau).sin())
        return Jet(tau, side * (there.v - speed), side * there.a, side * jerk)


def _dividing(low: float, high: float, longest: float) -> list[float]:
    """Return the times that divide the span from `low` to `high` into equal parts, each less than
    `longest` long.
    """
    count = int((high - low) / (SHORTER * longest))
    return [low + j * (high - low) / (count + 1) for j in range(1, count + 1)]


def _reaching(low: float, high: float, longest: float, spare: float) -> list[tuple[float, float]]:
    """Return times, and reaches around them, that together cover the span from `low` to `high`.

    A reach may be nearly longest/2 (Polya), but y bounds g worse the longer it is followed: these
    are about an eighth of `longest`.
    """
    count = ceil(CUTS_OF_LONGEST * (high - low) / longest)
    half = (high - low) / count / 2
    return [(low + (2 * j + 1) * half, REACH * half + spare) for j in range(count)]


def complexed(value: Ball) -> Ball:
    """Return a real ball or series as a complex one."""
    if isinstance(value, arb_series):
        return acb_series(value)
    return acb(value)


def times_i(value: Ball) -> Ball:
    """Return the imaginary unit times a real ball or series."""
    if isinstance(value, arb_series):
        return acb_series(value) * acb_series([acb(0, 1)])
    return acb(0, value)


def component(value: Ball, imaginary: int) -> Ball:
    """Return the real part of a complex ball or series or, if `imaginary`, its imaginary part."""
    if isinstance(value, acb_series):
        coefficients = [component(entry, imaginary) for entry in value]
        return arb_series(coefficients, prec=value.prec)
    if imaginary:
        return value.imag
    return value.real


def longest_part(o: OscillatorInBalls) -> float:
    """Return a time that is just less than half a period of the motion without drive (infinity if
    it has no period).
    """
    square = (-o.kappa).upper()
    if square > 0:
        return float((arb.pi() / square.sqrt()).lower()) * (1 - 1e-12)
    return float("inf")


@contextmanager
def box_arithmetic() -> Iterator[None]:
    """Set the precision for boxes in a with block; if Undecided or a division by 0 occurs in it,
    raise NotInBox.
    """
    before = ctx.cap  # which `Surface.directed` sets
    try:
        with ctx.workprec(BOX_BITS):
            yield
    except (Undecided, ZeroDivisionError) as undecided:
        raise NotInBox(str(undecided)) from None
    finally:
        ctx.cap = before


class Orbits(NamedTuple):
    """An oscillator, the unknowns of its orbit, and the flights of it: power series in the place."""

    o: OscillatorInBalls
    u: Values
    flown: list[BoxFlight]


class BoxRoot(NamedTuple):
    """A root u of the closing equations at the middle of a box, with the Jacobian J, Y near its
    inverse, and the flights: those just before the last step of Newton's method.
    """

    u: arb_mat
    J: arb_mat
    Y: arb_mat
    flown: list[BoxFlight]


class LinearPart(NamedTuple):
    """The least value on the box of the linear part of a margin, and the side along which it
    changes most.
    """

    least: Ball
    along: int


def _bounds_of_residuals(rounding: Values, cubes: Sequence[arb_mat]) -> Values:
    """Return bounds of Y f on the surface: what rounding leaves, and the terms of order 3.

    `cubes` has the values of the cubic form along the four DIRECTIONS.
    """
    # The form A a^3 + B a^2 b + C a b^2 + D b^3 has along them the values A, D, A + B + C + D and
    # A - B + C - D.
    A, D, plus, minus = cubes
    form = A, (plus - minus) / 2 - D, (plus + minus) / 2 - A, D
    parts = zip(rounding, *(cube.entries() for cube in form), strict=True)
    return [(total + sum(map(abs, values), arb(0))).upper() for total, *values in parts]


def _check_margins(
    margins: Sequence[PositiveQuantity],
    linear: Sequence[LinearPart],
    bends: Sequence[Values],
    tube: Values,
) -> None:
    """Raise NotInBox unless all margins are > 0 on the box, by Taylor's theorem of order 2.

    `linear` has the least of the linear part of each, `bends` its terms of order 2 along the four
    DIRECTIONS, `tube` how far each unknown may be from the surface.
    """
    bends_a, bends_b, bends_both, _ = bends
    for margin, part, bend_a, bend_b, bend_both in zip(
        margins, linear, bends_a, bends_b, bends_both, strict=True
    ):
        mixed = abs(bend_both - bend_a - bend_b)
        off_surface = sum(
            (abs(slope) * r for slope, r in zip(margin.slopes, tube, strict=True)), arb(0)
        )
        if not part.least + bend_a.min(0) + bend_b.min(0) - mixed - off_surface > 0:
            raise NotInBox(margin.text, part.along)


class Surface:
    """Approximate roots of the closing equations for all parameters of a box.

    The unknowns u(a, b) are quadratic polynomials of the place in the box, which has a and b in
    [-1, 1].
    """

    # Raises NotInBox if the orbit found from `near` at the middle of the box does not have the
    # word.

    def __init__(
        self,
        p: Parameters,
        names: Sequence[str],
        box: Rectangle,
        flights: BoxEquations,
        near: Sequence[float],
    ) -> None:
        self.p = p
        self.names = names
        self.flights = flights
        self.fixed = by_name(p, ball)
        self.middle = [ball((low + high) / 2) for low, high in box]
        self.half = [ball((high - low) / 2) for low, high in box]
        self.range = [ball(low).union(ball(high)) for low, high in box]
        self.slopes = list[arb_mat]()
        # `prove` sets slopes and squares; the root at the middle is all that is known before.
        o = self.oscillator(self.middle)
        root = self._root(o, column([arb(value) for value in near]))
        self.u = root.u
        self.J = root.J
        self.Y = root.Y
        plan = flights.plan(o, self.u.entries())
        margins = flights.margins(o, self.u.entries(), root.flown, plan)
        worst = min(margins, key=lambda margin: float(margin.value))
        if worst.value < 0:
            raise NotInBox(worst.text)

    def _root(self, o: OscillatorInBalls, u: arb_mat) -> BoxRoot:
        """Find the root of the closing equations of the oscillator `o` by Newton's method from `u`,
        or raise NotInBox.
        """
        for _ in range(MOST_NEWTON):
            flown, r = self.flights.residuals(o, u.entries())
            _, rows = self.flights.jacobian(o, u.entries())
            J = arb_mat(rows)
            Y = J.mid().inv().mid()
            step = (Y * column(r)).mid()
            u = (u - step).mid()
            size = max(abs(float(change)) for change in step.entries())
            if not size < MOST_CHANGE:  # or nan
                break
            if size < CONVERGED:
                return BoxRoot(u, J, Y, flown)
        raise NotInBox("a root of the closing equations")

    def oscillator(self, values: Sequence[Ball]) -> OscillatorInBalls:
        """Return the oscillator with the given values of both parameters of the plane."""
        return OscillatorInBalls(self.p, self.fixed | dict(zip(self.names, values, strict=True)))

    def directed(
        self,
        direction: tuple[int, int],
        coefficients: Sequence[arb_mat],
        count: int,
        from_whole_box: bool,
    ) -> tuple[OscillatorInBalls, Values]:
        """Return oscillator and unknowns as power series of `count` terms along a direction in the
        box.

        `coefficients` are those of all unknowns, order by order. The series begin at the middle or,
        if `from_whole_box`, at all of the box. This also sets flint's own limit for the length of
        series, which `box_arithmetic` resets.
        """
        # Series that are made of constants get as many terms as `ctx.cap` says, no series more.
        ctx.cap = count
        if from_whole_box:
            begins = self.range
        else:
            begins = self.middle
        parameters = [
            arb_series([begin, half * component], prec=count)
            for begin, half, component in zip(begins, self.half, direction, strict=True)
        ]
        by_order = (vector.entries() for vector in coefficients)
        unknowns = [arb_series(list(orders), prec=count) for orders in zip(*by_order, strict=True)]
        return self.oscillator(parameters), unknowns

    def near(self, a: float, b: float) -> tuple[float, ...]:
        """Return approximate unknowns at a place (a, b) in the box as floats."""
        if self.slopes:
            unknowns = self.at(arb(a), arb(b))
        else:  # `prove` has not found the polynomials
            unknowns = self.u
        return tuple(map(float, unknowns.entries()))

    def points(self) -> list[tuple[float, float]]:
        """Return phase and position of all switching points for the parameters at the middle of the
        box.
        """
        return self.flights.points(self.oscillator(self.middle), self.u.entries())

    def at(self, a: Ball, b: Ball) -> arb_mat:
        """Return the unknowns at a place (a, b) in the box, by their quadratic polynomials."""
        (da, db) = self.slopes
        (aa, ab, bb) = self.squares
        return self.u + a * (da + a * aa + b * ab) + b * (db + b * bb)

    def prove(self) -> None:
        """Prove that an orbit with the word exists for all parameters of the box.

        Raise NotInBox if that fails.
        """
        flights = self.flights
        place = arb(0, 1)
        rounding, thin = self._fit_surface()
        wide = self.oscillator(self.range)
        surface = self.at(place, place)
        plan = flights.plan(wide, surface.entries())
        linear = self._linear_parts(thin, plan)

        # The terms of order 3 of Y f, and the bends of the margins, for all places in the box.
        cubes = list[arb_mat]()
        bends = list[list[Ball]]()
        for d in DIRECTIONS:
            orders, series = self._coefficients(d, [surface, *self._derivatives(d, place)], 4, True)
            cubes.append(orders[3])
            margins = flights.margins(*series, plan)
            bends.append([coefficient(margin.value, 2) for margin in margins])
        pushed = _bounds_of_residuals(rounding, cubes)
        # If there is no proof, the side along which the cubic terms are larger is to be cut.
        cube_a, cube_b = cubes[:2]
        size_a, size_b = (
            max(float(abs(value) / p) for value, p in zip(cube.entries(), pushed, strict=True))
            for cube in (cube_a, cube_b)
        )
        along = int(size_b > size_a)
        tube, slopes = self._root_distances(surface, pushed, along)

        # The inequalities for all unknowns within that distance of the surface.
        whole = (surface + column([arb(0, r) for r in tube])).entries()
        if not all(
            set(new) <= set(old)
            for new, old in zip(flights.plan(wide, whole).turns, plan.turns, strict=True)
        ):
            raise NotInBox("which turns are in a stick", along)
        margins = flights.margins(wide, whole, flights.flown(wide, whole), plan, slopes)
        _check_margins(margins, linear, bends, tube)
        flights.prove_flights(wide, whole, plan)

    def _fit_surface(self) -> tuple[Values, list[Orbits]]:
        """Set slopes and squares of the surface so that Y f has no terms of order 1 and 2 but for
        rounding.

        Return bounds of what rounding leaves of the terms of order 0, 1 and 2, and the orbits as
        series from the middle of the box along the first three DIRECTIONS.
        """
        slopes = list[arb_mat]()
        for d in DIRECTIONS[:2]:
            (_, order_1), _ = self._coefficients(d, [self.u], 2, False)
            slopes.append(-order_1.mid())
        da, db = slopes
        thin = list[Orbits]()
        bends = list[arb_mat]()
        rounding = [arb(0)] * self.flights.count
        for a, b in DIRECTIONS[:3]:
            orders, series = self._coefficients((a, b), [self.u, a * da + b * db], 3, False)
            order_0, order_1, order_2 = orders
            bend = -order_2.mid()
            bends.append(bend)
            thin.append(series)
            # The bend, which is not in the series, changes Y f by Y J bend at order 2.
            for values in (order_0, order_1, order_2 + self.Y * (self.J * bend)):
                # 3 times suffices: on the box a form is at most |aa| + |both - aa - bb| + |bb|.
                rounding = [
                    total + 3 * abs(value)
                    for total, value in zip(rounding, values.entries(), strict=True)
                ]
        # The bend along (1, 1) is that of both sides together.
        aa, bb, both = bends
        self.slopes = [da, db]
        self.squares = (aa, both - aa - bb, bb)
        return rounding, thin

    def _linear_parts(self, thin: Sequence[Orbits], plan: FlightChecks) -> list[LinearPart]:
        """Return the least of the linear part of each margin on the box; raise NotInBox if one is
        < 0.
        """
        parts = list[LinearPart]()
        along_a, along_b = (self.flights.margins(*series, plan) for series in thin[:2])
        for by_a, by_b in zip(along_a, along_b, strict=True):
            change_a = abs(coefficient(by_a.value, 1))
            change_b = abs(coefficient(by_b.value, 1))
            least = coefficient(by_a.value, 0) - change_a - change_b
            along = int(change_b > change_a)
            parts.append(LinearPart(least, along))
            if least < 0:
                raise NotInBox(by_a.text, along)
        return parts

    def _coefficients(
        self,
        direction: tuple[int, int],
        coefficients: Sequence[arb_mat],
        count: int,
        from_whole_box: bool,
    ) -> tuple[list[arb_mat], Orbits]:
        """Return the coefficients of Y f (f: residuals, Y: nearly J^-1) along a direction, and the
        orbits that they are of.

        The arguments are those of `directed`.
        """
        o, u = self.directed(direction, coefficients, count, from_whole_box)
        flown, residuals = self.flights.residuals(o, u)
        orders = [
            self.Y * column([series[order] for series in residuals]) for order in range(count)
        ]
        return orders, Orbits(o, u, flown)

    def _derivatives(self, d: tuple[int, int], place: Ball) -> tuple[arb_mat, arb_mat]:
        """Return first and second Taylor coefficients of the unknowns u(a, b) along `d`, for all a
        and b in `place`.
        """
        (da, db) = self.slopes
        (aa, ab, bb) = self.squares
        i, j = d
        slope = i * (da + place * (2 * aa) + place * ab) + j * (db + place * (2 * bb) + place * ab)
        return slope, i * i * aa + i * j * ab + j * j * bb

    def _root_distances(
        self, surface: arb_mat, pushed: Values, along: int
    ) -> tuple[Values, list[dict[str, Values]]]:
        """Return a bound of each unknown's distance from `surface` at a root, if |Y f| <= `pushed`
        on the surface, and the slopes of all flights within these bounds (Krawczyk).
        """
        # `along` is the side to cut if there is no proof.
        flights = self.flights
        tube = [INFLATION * bound for bound in pushed]
        for _ in range(MOST_INFLATIONS):
            tube = [(INFLATION * radius).mid() for radius in tube]
            reach = column([arb(0, radius) for radius in tube])
            # 1 - Y J is its part at the middle and its changes along both sides: |1 - Y J| is at
            # most the sum of their sizes.
            _, rows = flights.jacobian(self.oscillator(self.middle), (self.u + reach).entries())
            parts = [unit_matrix(flights.count) - self.Y * arb_mat(rows)]
            for d in DIRECTIONS[:2]:
                slope, _ = self._derivatives(d, arb(0, 1))
                o, u = self.directed(d, [surface + reach, slope], 2, True)
                slopes, rows = flights.jacobian(o, u)
                changes = arb_mat([[coefficient(entry, 1) for entry in row] for row in rows])
                parts.append(self.Y * changes)
            entries = zip(*(part.entries() for part in parts), strict=True)
            sizes = [sum(map(abs, of_parts), arb(0)) for of_parts in entries]
            off_unit = arb_mat(flights.count, flights.count, sizes)
            image = (column(pushed) + off_unit * column(tube)).entries()
            if all(moved < radius for moved, radius in zip(image, tube, strict=True)):
                return tube, [
                    {name: [coefficient(z, 0) for z in row] for name, row in by.items()}
                    for by in slopes
                ]
            # If off_unit enlarges `pushed`, wider tubes hardly help.
            grown = (off_unit * column(pushed)).entries()
            excess = max(float(size) / float(p) for size, p in zip(grown, pushed, strict=True))
            tube = [moved.upper() for moved in image]
            if not excess < 1 or not all(radius < MOST_TUBE for radius in tube):
                break
        raise NotInBox("one root for all parameters", along, excess)
