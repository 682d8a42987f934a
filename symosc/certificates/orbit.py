"""A periodic orbit, proven: it exists, is alone in a box, has its word, and its multipliers are
enclosed.

The unknowns are all switching points t_0, x_0, t_1, x_1, ..., and the equations f those of
`symosc.orbits`. Let c be the middle of a box X, J an enclosure of the Jacobian over X, Y any
matrix. If K(X) = c - Y f(c) + (1 - Y J) (X - c) lies inside X, then f has exactly one root in X,
and it lies in K(X) (Krawczyk 1969). Constants may be balls.

A root says that a piece ends on its belt, not that it comes there first. So for each belt around a
flight the gap g has to be positive between its start and its end, and for each stick both forces
that hold it. On a step one of these is enough, g > 0 being known where it begins, or g = 0 at a
start on the belt: g > 0; g' > 0; g'' > 0 if it begins with a flight that leaves a stick; g' < 0 if
it ends with the flight, where g = 0. The steps may begin and end anywhere.

Trace T and determinant D of the monodromy matrix give the multipliers. Both lie inside the unit
circle if and only if
|D| < 1 and |T| < 1 + D (Schur and Cohn). The proofs are in `symosc derive certificates`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import floor, log10
from typing import NamedTuple

from flint import arb, arb_mat, ctx

from symosc.base.aliases import Number, Record
from symosc.certificates.balls import Ball, Undecided, exact_ends, made_by, outward
from symosc.certificates.certificate import Certificate, confirmed
from symosc.certificates.flow import Curve, Flight, Oscillator, holding_force
from symosc.certificates.motion import ProvenEvent, belts_around
from symosc.friction import MODE_NAMES
from symosc.model import Parameters
from symosc.orbits.closing_equations import OrbitPiece, pieces_of
from symosc.words import Word

#: Boxes to try, as parts of the period and of the largest position: the first one that works is
#: stated.
BOXES = (1e-7, 1e-9, 1e-12, 1e-16, 1e-20, 1e-26, 1e-34)
#: First step, as a part of the piece; shortest step.
FIRST_COURSE_STEP = 1 / 8
SHORTEST_COURSE_STEP = 2.0**-60
#: Multipliers whose difference squared is less than this are enclosed together.
NEARLY_DOUBLE = arb(2) ** -90
LEAST_ORBIT_BITS = 128
MOST_ORBIT_BITS = 1024
#: Digits of the enclosures of points and of multipliers in a file; the radius that the first must
#: have, relatively.
POINT_DIGITS = 25
MULTIPLIER_PLACES = 16
ACCURATE = 10.0 ** (-POINT_DIGITS - 2)
#: This part of the box in which an orbit is proven to be alone is stated: a checker with wider
#: balls needs a margin.
STATED = arb(2) ** -24
#: How many times the first-order value a hint for the checker is; the least radius in a hint.
SPARE = 32
LEAST_RADIUS = Fraction(1, 10**60)

Values = list[Ball]


def unit_matrix(count: int) -> arb_mat:
    """Return the unit matrix with `count` rows and columns."""
    return arb_mat([[int(i == j) for j in range(count)] for i in range(count)])


def column(values: Sequence[Ball]) -> arb_mat:
    """Return a vector as a matrix with one column."""
    return arb_mat([[value] for value in values])


def krawczyk(box: Values, middle: Values, residuals: Values, J: arb_mat) -> Values | None:
    """Return the image of a box under Krawczyk's operator if it is inside the box, which proves one
    root; else None.
    """
    try:
        Y = J.mid().inv().mid()
    except ZeroDivisionError:
        return None
    moved = (unit_matrix(len(box)) - Y * J) * (column(box) - column(middle)) - Y * column(residuals)
    image = (column(middle) + moved).entries()
    if all(value.contains_interior(each) for value, each in zip(box, image, strict=True)):
        return image
    return None


class Margin(NamedTuple):
    """A quantity that must be > 0 for an orbit: a number, or a function of the time since a piece's
    start.
    """

    what: str
    curve: Curve | Ball
    at_start: int = 0  # 1 if g, 2 if g and g' are known to be 0 where the piece starts
    at_end: bool = False  # whether g is known to be 0 where it ends
    kind: str = ""  # how a branch ends where it is 0


class ClosingBalls:
    """The closing equations of an orbit, enclosed.

    Wide balls as constants stand for a family of oscillators.
    """

    def __init__(
        self, oscillator: Oscillator, pieces: tuple[OrbitPiece, ...], periods: int
    ) -> None:
        self.oscillator = oscillator
        self.pieces = pieces
        self.periods = periods
        self.turn = 2 * periods * arb.pi() / oscillator.Omega

    def ends(self, values: Values) -> Values:
        """Return [t_1, x_1, ..., t_0 + period, x_0], where pieces 0, 1, ...

        End, from `values` [t_0, x_0, t_1, ...].
        """
        return [*values[2:], values[0] + self.turn, values[1]]

    def flight(self, i: int, values: Values) -> Flight:
        """Return the flight that begins at switching point i."""
        piece = self.pieces[i]
        o = self.oscillator
        return Flight(o, piece.mode, values[2 * i], values[2 * i + 1], o.speed[piece.start])

    def slips_into(self, i: int) -> int:
        """Return the domain in which stick i ends."""
        return self.pieces[i].start + (self.pieces[i].side > 0)

    def residuals(self, values: Values) -> Values:
        """Return the residuals f of the closing equations, two for each piece, as balls or power
        series.
        """
        o = self.oscillator
        end = self.ends(values)
        found = list[Ball]()
        for i, piece in enumerate(self.pieces):
            (t0, x0) = values[2 * i : 2 * i + 2]
            (t1, x1) = end[2 * i : 2 * i + 2]
            if piece.sticks:
                speed = o.speed[piece.start]
                found += [x0 + speed * (t1 - t0) - x1, o.force(self.slips_into(i), t1, x1, speed)]
            else:
                flight = self.flight(i, values)
                there = flight.at(t1 - t0)
                found += [flight.x(there) - x1, there.v - o.speed[piece.end]]
        return found

    def _slopes(self, i: int, values: Values) -> tuple[Sequence[Ball], Sequence[Ball]]:
        """Return for both residuals of piece i their derivatives by t and x at its start, and by t
        and x at its end.
        """
        o = self.oscillator
        piece = self.pieces[i]
        t0 = values[2 * i]
        t1 = self.ends(values)[2 * i]
        v0 = o.speed[piece.start]
        one = arb(1)
        zero = arb(0)
        if piece.sticks:
            return (-v0, one, v0, -one), (zero, zero, -o.drive * (o.Omega * t1).sin(), -o.km)
        flight = self.flight(i, values)
        there = flight.at(t1 - t0)
        phi = there.phi
        E = there.E
        E1 = there.E1
        a0 = flight.a0
        return (-v0 * phi - a0 * E, phi, there.v, -one), (
            o.km * E * v0 - a0 * E1,
            -o.km * E,
            there.a,
            zero,
        )

    def jacobian(self, values: Values) -> arb_mat:
        """Return the Jacobian of the residuals with respect to t and x of all points."""
        count = len(values)
        J = arb_mat(count, count)
        for i in range(0, count, 2):
            for row, entries in enumerate(self._slopes(i // 2, values), i):
                for j, entry in enumerate(entries, i):
                    J[row, j % count] += entry
        return J

    def end_by_start(self, i: int, values: Values) -> arb_mat:
        """Return approximate derivatives of t and x at the end of piece i by t and x at its start,
        a 2 x 2 matrix.
        """
        rows = self._slopes(i, values)
        return -arb_mat([list(row[2:]) for row in rows]).solve(
            arb_mat([list(row[:2]) for row in rows])
        )

    # -- roots -------------------------------------------------------------------------------------

    def polished(self, values: Values) -> Values:
        """Return numbers (exact balls) near a root, by Newton's method without proof.

        May raise Undecided.
        """
        values = [value.mid() for value in values]
        for _ in range(12):
            try:
                step = self.jacobian(values).mid().solve(column(self.residuals(values)).mid())
            except ZeroDivisionError:
                break
            values = (column(values) - step).mid().entries()
            if not all(each.is_finite() for each in values):
                break
            scale = max(map(abs, values), key=float)
            if all(
                abs(each.mid()) <= scale * arb(2) ** (16 - ctx.prec * 3 // 4)
                for each in step.entries()
            ):
                return values
        raise Undecided("a root of the closing equations, which are singular or nearly so")

    def krawczyk(self, box: Values, middle: Values) -> Values | None:
        """Return the Krawczyk image of a box about `middle`, if it proves that one root is in the
        box; else None.
        """
        return krawczyk(box, middle, self.residuals(middle), self.jacobian(box))

    def roots(self, middle: Values) -> Iterator[tuple[Values, Values]]:
        """Yield boxes around `middle` with exactly one root, the widest first, each with an
        enclosure of the root.
        """
        sizes = self.turn.mid(), max(map(abs, middle[1::2]), key=float) + 1
        for part in BOXES:
            box = [value + arb(0, (part * sizes[j % 2]).mid()) for j, value in enumerate(middle)]
            root = self.krawczyk(box, middle)
            if root is None:
                continue
            for _ in range(4):
                before = root
                root = self.krawczyk(root, [each.mid() for each in root]) or root
                if all(
                    float(a.rad()) > 0.25 * float(b.rad())
                    for a, b in zip(root, before, strict=True)
                ):
                    break
            yield box, root

    # -- the course of the word --------------------------------------------------------------------

    def margins(self, i: int, values: Values) -> list[Margin]:
        """Return what must be > 0 on piece i: its duration, forces that decide its mode, and
        inequalities during it.
        """
        # None is needed at a start behind a stick: one force is 0 there, the other one is a margin
        # of the stick.
        o = self.oscillator
        piece = self.pieces[i]
        before = self.pieces[i - 1]
        (t, x) = values[2 * i : 2 * i + 2]
        if piece.sticks:
            kind = "stick"
        elif piece.after_stick:
            kind = "slip"
        else:
            kind = "flight"
        found = [
            Margin(
                f"{piece.label} lasts", self.ends(values)[2 * i] - t, kind=f"vanishing of a {kind}"
            )
        ]
        if not before.sticks:
            if piece.sticks:
                signs = (1, -1)
            elif before.mode == piece.start:
                signs = (1, 1)
            else:
                signs = (-1, -1)
            smooth = o.jump[piece.start].is_zero()
            for domain, sign in zip((piece.start, piece.start + 1), signs, strict=True):
                force = o.force(piece.start if smooth else domain, t, x, o.speed[piece.start])
                far = domain != before.mode and not smooth
                if not far:
                    kind = "grazing"
                elif piece.sticks:
                    kind = "birth of a slip"
                else:
                    kind = "birth of a stick"
                what = f"F^({domain}) {'>' if sign > 0 else '<'} 0 where {before.label} ends"
                found.append(Margin(what, sign * force, kind=kind))
        if piece.sticks:
            for domain in (piece.start, piece.start + 1):
                curve = holding_force(o, piece.start, domain, t, x)
                what = (
                    f"F^({domain}) {'>' if domain == piece.start else '<'} 0 during {piece.label}"
                )
                found.append(
                    Margin(what, curve, 0, domain == self.slips_into(i), "birth of a slip")
                )
            return found
        flight = self.flight(i, values)
        for boundary in belts_around(piece.mode):
            if boundary != piece.start:
                zeros = 0
            elif piece.after_stick:
                zeros = 2
            else:
                zeros = 1
            what = f"v {'>' if piece.mode > boundary else '<'} v{boundary} during {piece.label}"
            found.append(Margin(what, flight.gap(boundary), zeros, boundary == piece.end))
        return found

    def prove_course(self, values: Values) -> None:
        """Prove that all margins of the root in `values` are > 0, so that it follows its word, or
        raise Undecided.
        """
        for i in range(len(self.pieces)):
            span, *others = self.margins(i, values)
            for margin in (span, *others):
                if callable(margin.curve):
                    prove_positive(margin, span.curve)
                elif not margin.curve > 0:
                    raise Undecided(margin.what, values[2 * i])

    # -- multipliers -------------------------------------------------------------------------------

    def stability(self, values: Values) -> Stability:
        """Return trace and determinant of the monodromy matrix of the root in `values`."""
        o = self.oscillator
        ends = self.ends(values)
        monodromy = unit_matrix(2)
        determinant = (-o.cm * self.turn).exp()
        for i, piece in enumerate(self.pieces):
            if piece.sticks:
                continue
            there = self.flight(i, values).at(ends[2 * i] - values[2 * i])
            ratio = arb(0)
            following = self.pieces[(i + 1) % len(self.pieces)]
            if not following.sticks:
                force = o.force(following.mode, ends[2 * i], ends[2 * i + 1], o.speed[piece.end])
                ratio = force / there.a
            monodromy = (
                arb_mat([[there.phi, there.E], [-ratio * o.km * there.E, ratio * there.E1]])
                * monodromy
            )
            determinant = determinant * ratio
        return Stability(monodromy.trace(), determinant)


def prove_positive(margin: Margin, span: Ball) -> None:
    """Prove that a margin is > 0 from time 0 to any time in the ball `span`, or raise Undecided."""
    last = span.upper().mid()
    begin = arb(0)
    zeros = margin.at_start
    if zeros == 0 and not margin.curve(begin).g > 0:
        raise Undecided(f"{margin.what} at its start")
    step = (last * FIRST_COURSE_STEP).mid()
    for _ in range(4000):
        end = (begin + step).mid()
        final = bool(end >= last)
        over = begin.union(last if final else end)
        whole = margin.curve(over)
        there = margin.curve(over.mid())
        off = over - over.mid()
        slope = there.dg + whole.ddg * off
        if final and margin.at_end:
            sure = not zeros and slope < 0
        else:
            g = there.g + there.dg * off + whole.ddg * (off * off).nonnegative_part() / 2
            sure = g > 0 or whole.g > 0 or slope > 0 or (zeros == 2 and whole.ddg > 0)
        if sure and final:
            return
        if sure:
            begin = end
            zeros = 0
            step = (step * 1.5).mid()
        else:
            step = (((last if final else end) - begin) / 2).mid()
            if step <= last * SHORTEST_COURSE_STEP:
                break
    raise Undecided(margin.what, begin)


class Stability(NamedTuple):
    """Trace and determinant of the monodromy matrix, as balls."""

    trace: Ball
    determinant: Ball

    @property
    def stable(self) -> bool | None:
        """True if both multipliers are certainly inside the unit circle, False if one is outside,
        None if undecided.
        """
        T = self.trace
        D = self.determinant
        if abs(D) < 1 and abs(T) < 1 + D:
            return True
        if abs(D) > 1 or abs(T) > 1 + D:
            return False
        return None

    def multipliers(self) -> tuple[tuple[Ball, Ball], tuple[Ball, Ball]]:
        """Return real and imaginary parts of both multipliers, the larger one first if real."""
        half = self.trace / 2
        zero = arb(0)
        square = half * half - self.determinant
        if self.determinant.is_zero():
            return (self.trace, zero), (zero, zero)
        if abs(square) < NEARLY_DOUBLE:  # real or complex: a checker may not be able to tell
            square = (-NEARLY_DOUBLE).union(NEARLY_DOUBLE)
        if not abs(square) > 0:
            reach = abs(square).upper().sqrt()
            around = (-reach).union(reach)
            return ((half + around, around),) * 2
        root = abs(square).sqrt()
        if square < 0:
            return (half, root), (half, -root)
        if half.contains(0):
            return (half + root, zero), (half - root, zero)
        if half > 0:
            large = half + root
        else:
            large = half - root
        return (large, zero), (self.determinant / large, zero)


# -- the proof -------------------------------------------------------------------------------------


def certify_orbit(
    p: Parameters, labels: tuple[str, ...], periods: int, points: Sequence[tuple[Number, Number]]
) -> Certificate:
    """Prove an orbit with `labels` and forcing `periods` near `points` (t, x).

    Return its certificate.
    """
    word = Word(labels)
    bits = LEAST_ORBIT_BITS
    near = [arb(each) for point in points for each in point]
    while True:
        with ctx.workprec(bits):
            try:
                closing = ClosingBalls(Oscillator(p), pieces_of(word), periods)
                box, root = _prove_with_word(closing, near)
                stability = closing.stability(root)
                if stability.stable is not None or bits >= MOST_ORBIT_BITS:
                    return _certificate(p, word, closing, box, root, stability, bits)
            except Undecided as undecided:
                if bits >= MOST_ORBIT_BITS:
                    message = f"the orbit {word.cycle}, with {bits} bits: not decided: "
                    message += f"{undecided.what}{undecided.place()}"
                    return Certificate("orbit", False, message + _marginal(closing, near))
            bits *= 2


def _prove_with_word(closing: ClosingBalls, near: Values) -> tuple[Values, Values]:
    """Prove that a root near the points `near` follows its word.

    Return a box with no other root, and the root.
    """
    reason = Undecided("the closing equations: no box in which their root is the only one")
    for box, root in closing.roots(closing.polished(near)):
        try:
            closing.prove_course(box)
        except Undecided as undecided:
            reason = undecided
            continue
        if any(float(value.rad()) > ACCURATE * max(1.0, abs(float(value))) for value in root):
            raise Undecided("the digits of the switching points")
        return box, root
    raise reason


def _marginal(closing: ClosingBalls, near: Values) -> str:
    """Return a remark for a message if the orbit `near` has a multiplier that is 1 to about 12
    digits, otherwise "".
    """
    try:
        T, D = closing.stability(near)
    except Undecided:
        return ""
    if (
        not abs(float((1 - T + D).mid())) < 1e-12
    ):  # a multiplier that is 1 to this part makes it singular
        return ""
    return (
        "; it is marginal (a multiplier is 1, as nearly as can be seen), and need not be isolated: "
        "there may be many"
    )


# -- the certificate -------------------------------------------------------------------------------


def switchings(closing: ClosingBalls, values: Values, begin: int) -> list[ProvenEvent]:
    """Return all events of one period from event `begin` on, and at the end event `begin` again, a
    period later.
    """
    rows = []
    n = len(closing.pieces)
    pieces = closing.pieces
    for j in range(begin, begin + n + 1):
        before = pieces[j % n - 1]
        piece = pieces[j % n]
        (t, x) = values[2 * (j % n) : 2 * (j % n) + 2]
        if before.sticks:
            kind = "slip"
        elif piece.sticks:
            kind = "stick"
        else:
            kind = "cross"
        if j >= n:
            t = t + closing.turn
        rows.append(
            ProvenEvent(kind, piece.start, MODE_NAMES[before.mode], MODE_NAMES[piece.mode], t, x)
        )
    return rows


def one_digit(radius: Ball) -> str:
    """Round a radius down to a decimal with one digit, such as 3e-12, that a file can state."""
    most = max(exact_ends(radius)[0], LEAST_RADIUS) * Fraction(99, 100)
    power = floor(log10(most))
    return f"{most // Fraction(10) ** power}e{power}"


def _certificate(
    p: Parameters,
    word: Word,
    closing: ClosingBalls,
    box: Values,
    root: Values,
    stability: Stability,
    bits: int,
) -> Certificate:
    """Let the checker prove an orbit, a `root` that is the only one in its `box`.

    Return the certificate.
    """
    n = len(closing.pieces)
    pieces = closing.pieces
    # It begins at the end of a flight: there the forces say how the motion goes on.
    begin = next(i for i in range(n) if not pieces[i - 1].sticks)
    # A hint for the checker, not a proof: how far apart in time motions from the box meet each
    # event, many times the first-order value, as the checker uses balls that are wider than the
    # set.
    wide = [STATED * value.rad() for value in box[2 * begin : 2 * begin + 2]]
    middle = [each.mid() for each in root]
    moved = arb_mat([[wide[0].mid(), 0], [0, wide[1].mid()]])
    reaches = [2 * moved[0, 0]]
    for i in range(begin, begin + n):
        moved = (closing.end_by_start(i % n, middle) * moved).mid()
        reaches.append(SPARE * (abs(moved[0, 0]) + abs(moved[0, 1])))
    rows: list[Record] = [
        event.named()
        | {name: list(outward(getattr(event, name), POINT_DIGITS)) for name in "tx"}
        | {"reach": one_digit(reach)}
        for event, reach in zip(switchings(closing, root, begin), reaches, strict=True)
    ]

    def decimals(value: Ball) -> list[str]:
        if value.is_zero():
            return ["0", "0"]
        return list(outward(value, MULTIPLIER_PLACES))

    statement = made_by(bits) | {
        "parameters": p.as_dict(),
        "word": str(word.cycle),
        "periods": closing.periods,
        "events": rows,
        "alone_within": [one_digit(each) for each in wide],
        "multipliers": [
            {"re": decimals(re), "im": decimals(im)} for re, im in stability.multipliers()
        ],
        "stable": stability.stable,
    }
    enclosures = [outward(value, POINT_DIGITS) for value in root]
    return confirmed("orbit", statement, tuple(zip(enclosures[::2], enclosures[1::2], strict=True)))
