"""Proposed enclosures of orbits, of branches of orbits and of grazing windows, for the checker to
prove.

As in `symosc.certificates.propose` nothing is proven here. The switching points and multipliers of
an orbit are roots of its closing equations in many digits. The box in which it is to be the only
one is made smaller until the checker proves it.

A branch is proposed as intervals of the parameter, with a box about the orbits of each. Orbits at
both ends of an interval and in its middle say how large the box must be. The checker is asked about
each interval alone, and the interval is halved if it refuses. Where a branch ends, the orbit just
outside of it, which is none, says which inequalities may fail there.

Where a grazing window begins and ends is a closed form: an arcsine of a rational number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from math import floor, log10
from typing import Any, NamedTuple

from symosc.base.aliases import Number, Record
from symosc.base.display.progress import reporting
from symosc.base.exact import show
from symosc.certificates.certificate import (
    FORMAT,
    Certificate,
    confirmed,
    made_by,
)
from symosc.certificates.propose import (
    DIGITS,
    Interval,
    NothingProposed,
    OrbitInDigits,
    around,
    fraction,
    known,
    one_digit,
    outward,
    show_decimal,
)
from symosc.certificates.verify_orbits import judge
from symosc.engine.arithmetic import mp_context
from symosc.grazing.window import GrazingWindow
from symosc.model import Parameters
from symosc.orbits.admissibility import clearances, conditions, failing, holding_forces
from symosc.orbits.branch import RANGE, Branch
from symosc.orbits.floquet import multipliers_of
from symosc.words import Word, of_belts

#: Digits of an orbit that are computed, tried one after another.
ORBIT_DIGITS = (50, 120)
#: Boxes to try, as parts of the period and of the largest position: the first one that the checker
#: proves is stated.
BOXES = (1e-14, 1e-18, 1e-24, 1e-32)
#: How many times the first-order value a hint for the checker is.
SPARE = 32
LEAST_REACH = Fraction(1, 10**60)
#: Decimal digits of a multiplier's enclosure.
MULTIPLIER_PLACES = 16
#: Multipliers that differ by less than twice this are enclosed together.
NEARLY_DOUBLE = Fraction(1, 2**45)
#: A multiplier that is nearer to the unit circle than this is neither inside nor outside.
MARGINAL = 1e-25
#: A multiplier that is 1 to this part makes the closing equations singular.
SINGULAR = 1e-12

#: Digits of the orbits of a branch that are computed.
BRANCH_DIGITS = 30
#: By how much a box is wider than the three orbits in it, as a part of their distance, and of the
#: second difference, by which a curve leaves them.
BOX_MARGIN = Fraction(1, 10)
BEND_MARGIN = Fraction(1, 3)
LEAST_MARGIN = Fraction(1, 10**20)
#: So many fewer digits than are computed the boxes of a branch have.
UNSTATED_DIGITS = 5
#: Steps that the checker may take for one interval of a branch, and beside an end, for each event of
#: the orbit.
STEPS = 500
STEPS_AT_END = 20_000
#: How far `inside` and `outside` are from a branch's end, as a part of its value or of the range:
#: the first one that is proven is stated.
END_WIDTHS = (Fraction(1, 10**11), Fraction(1, 10**10), Fraction(1, 10**9))
#: The first interval and the narrowest one, as parts of the range; how much wider the next one is.
FIRST_WIDTH = Fraction(1, 50)
LEAST_WIDTH = Fraction(1, 10**13)
GROWTH = Fraction(8, 5)
#: When a flight that leaves its belt to the wrong side is surely there, as a part of its duration.
SOON = 1000
MOST_BOXES = 100_000

#: Digits of a window's ends that are computed.
WINDOW_DIGITS = 45
NO_PHASE = "nowhere"
ALL_PHASES = "everywhere"
BUT_ONE_PHASE = "everywhere but at one phase"
ON_AN_ARC = "on an arc"

Points = Sequence[tuple[Any, Any]]


# -- orbits ----------------------------------------------------------------------------------------


def certify_orbit(
    p: Parameters, labels: Sequence[str], periods: int, points: Points
) -> Certificate:
    """Propose an orbit with `labels` and forcing `periods` near `points` (t, x), and let the checker
    prove it.

    Return its certificate.
    """
    word = Word(tuple(labels))
    reason = ""
    refused = None
    for digits in ORBIT_DIGITS:
        try:
            orbit = OrbitInDigits(p, word.labels, periods, points, digits)
        except NothingProposed as undecided:
            reason = f"not decided: {undecided.what}, in {digits} digits"
            continue
        failed = failing(conditions(orbit.equations, orbit.solution))
        if failed:
            reason = f"not decided: {failed[0].text} fails near t = {failed[0].t:.15g}"
            break
        for share in BOXES:
            certificate = _proposed_orbit(p, word, orbit, share, digits)
            if certificate.proven:
                return certificate
            refused = refused or certificate
        break
    if refused is not None:
        reason = refused.message
    message = f"the orbit {word.cycle}: {reason}"
    if _is_marginal(p, word, periods, points):
        message += (
            "; it is marginal (a multiplier is 1, as nearly as can be seen), and need not be "
            "isolated: there may be many"
        )
    if refused is None:
        return Certificate("orbit", False, message)
    return replace(refused, message=message)


def _proposed_orbit(
    p: Parameters, word: Word, orbit: OrbitInDigits, share: float, digits: int
) -> Certificate:
    """Return the certificate of an orbit that is to be alone in a box, a `share` of the period and
    of the largest position.
    """
    n = len(orbit.pieces)
    pieces = orbit.pieces
    # It begins at the end of a flight: there the forces say how the motion goes on.
    begin = next(i for i in range(n) if not pieces[i - 1].sticks)
    largest = 1 + max(abs(fraction(x)) for _, x in orbit.points)
    # Half-widths of the box in t and in x.
    half_t = one_digit(Fraction(share) * fraction(orbit.turn))
    half_x = one_digit(Fraction(share) * largest)
    rows: list[Record] = []
    reaches = _reaches_in_time(orbit, begin, half_t, half_x)
    for (head, t, x), reach in zip(orbit.switchings(begin), reaches, strict=True):
        enclosures = {"t": outward(around(t, 0), DIGITS), "x": outward(around(x, 0), DIGITS)}
        rows.append(head | enclosures | {"reach": one_digit(max(fraction(reach), LEAST_REACH))})
    both = multipliers_of(orbit.equations, orbit.solution)
    statement = made_by(digits) | {
        "parameters": p.as_dict(),
        "word": str(word.cycle),
        "periods": orbit.equations.periods,
        "events": rows,
        "alone_within": [half_t, half_x],
        "multipliers": proposed_multipliers(both),
        "stable": proposed_stability(both),
    }
    points = tuple(
        (tuple(outward(around(t, 0), DIGITS)), tuple(outward(around(x, 0), DIGITS)))
        for t, x in orbit.points
    )
    return confirmed("orbit", statement, points)


def _reaches_in_time(orbit: OrbitInDigits, begin: int, half_t: str, half_x: str) -> list[Number]:
    """Return how far apart in time motions from a box meet each event from `begin` on: a hint for
    the checker, whose balls are wider than the set.
    """
    n = len(orbit.pieces)
    slopes = orbit.slopes()
    number = orbit.context.convert
    # What each half-width moves: its columns are changes of (t, x), its first row those of t. The
    # first event is met within the box itself, twice its half-width wide.
    moved = orbit.context.matrix([[number(half_t), 0], [0, number(half_x)]])
    reaches = [2 * moved[0, 0]]
    for i in range(begin, begin + n):
        moved = slopes[i % n] * moved
        reaches.append(SPARE * (abs(moved[0, 0]) + abs(moved[0, 1])))
    return reaches


def proposed_multipliers(both: tuple[Number, Number]) -> list[Record]:
    """Return enclosures of both multipliers, as the file states them."""
    parts = [(fraction(multiplier.real), fraction(multiplier.imag)) for multiplier in both]
    (re, im), (re2, im2) = parts
    reach = NEARLY_DOUBLE
    if (re2 or im2) and max(abs(re - re2), abs(im - im2)) < 2 * reach:
        # Real or complex: the checker may not be able to tell.
        middle = (re + re2) / 2
        row = {"re": decimals((middle - reach, middle + reach)), "im": decimals((-reach, reach))}
        return [row, row]
    return [{"re": decimals((a, a)), "im": decimals((b, b))} for a, b in parts]


def decimals(ends: Interval) -> list[str]:
    """Return an enclosure of a part of a multiplier as decimals; exactly 0 as such."""
    if not any(ends):
        return ["0", "0"]
    return outward(ends, MULTIPLIER_PLACES)


def proposed_stability(both: tuple[Number, Number]) -> bool | None:
    """Return whether both multipliers are inside the unit circle; None if one is on it."""
    gap = float(1 - max(abs(multiplier) for multiplier in both))
    if abs(gap) < MARGINAL:
        return None
    return gap > 0


def _is_marginal(p: Parameters, word: Word, periods: int, points: Points) -> bool:
    """Return whether an orbit near `points` has a multiplier that is 1 to about 12 digits."""
    from symosc.orbits.closing_equations import ClosingEquations

    equations = ClosingEquations(p, word, periods)
    Omega = float(p.Omega)
    try:
        first, second = multipliers_of(equations, [(float(x), float(t) * Omega) for t, x in points])
    except (ZeroDivisionError, OverflowError, ValueError):
        return False
    return abs((1 - first) * (1 - second)) < SINGULAR


# -- branches --------------------------------------------------------------------------------------


class ProposedEnd(NamedTuple):
    """An end of a branch: its kind, the parameter's value there, and (t, x) of the orbit's points."""

    kind: str
    value: Fraction
    points: Points


class ProposedFamily(NamedTuple):
    """Orbits at both ends of an interval of the parameter, `low` to `high`, and in its middle.

    Each has its values: t and x of all events of a period.
    """

    low: Fraction
    high: Fraction
    values: tuple[list[Fraction], list[Fraction], list[Fraction]]
    last: OrbitInDigits

    def row(self) -> Record:
        """Return the interval and the box as a row of the file."""
        boxes = [_box(three) for three in zip(*self.values, strict=True)]
        # t of the first event a period later (the last but one value, before its x): the checker
        # adds the period to what it knows of the first.
        low, high = boxes[0]
        least_turn, most_turn = _box([values[-2] - values[0] for values in self.values])
        boxes[-2] = (low + least_turn, high + most_turn)
        texts = [known(ends, BRANCH_DIGITS - UNSTATED_DIGITS) for ends in boxes]
        value = [show(self.low), show(self.high)]
        return {"value": value, "t": texts[::2], "x": texts[1::2]}


def _box(three: Sequence[Fraction]) -> Interval:
    """Return an interval about a value at both ends of an interval of the parameter and in its
    middle.
    """
    first, middle, last = three
    low: Fraction = min(three)
    high: Fraction = max(three)
    spare = BOX_MARGIN * (high - low) + BEND_MARGIN * abs(first - 2 * middle + last)
    spare += LEAST_MARGIN * max(Fraction(1), abs(low), abs(high))
    return low - spare, high + spare


def certify_branch(
    branch: Branch, progress: Callable[[float], None] | bool | None = None
) -> Certificate:
    """Propose every orbit of a branch between its ends, and where and why it ends, and let the
    checker prove it.

    Return the certificate.
    """
    ends = [
        ProposedEnd(
            branch.ends[i].kind,
            Fraction(str(float(branch.values[i]))),
            [(float(t), float(x)) for t, x in branch.points[i]],
        )
        for i in (0, -1)
    ]
    ends.sort(key=lambda end: end.value)
    # Certificates are about two belts, of which the second one may never be met.
    labels = of_belts(Word(branch.labels), 2).labels
    p = branch.parameters(0).parameters
    proposal = BranchProposal(p, branch.parameter, labels, branch.periods, (ends[0], ends[1]))
    stable = bool(branch.stable.all()) or None
    if not isinstance(progress, bool):
        return proposal.certificate(stable, progress)
    with reporting(progress, 0, 1, "proven", "") as report:
        return proposal.certificate(stable, lambda part: report(part, 1))


class BranchProposal:
    """A proposal for a word's orbits for all values of the parameter `name` between both `ends`,
    the lower one first.
    """

    def __init__(
        self,
        p: Parameters,
        name: str,
        labels: Sequence[str],
        periods: int,
        ends: tuple[ProposedEnd, ProposedEnd],
    ) -> None:
        self.p = p
        self.name = name
        self.word = Word(tuple(labels))
        self.periods = periods
        self.ends = ends

    def orbit(self, value: Fraction, near: Points) -> OrbitInDigits:
        """Return the root of the closing equations at one value of the parameter."""
        return OrbitInDigits(
            self.p.replace(**{self.name: value}),
            self.word.labels,
            self.periods,
            near,
            BRANCH_DIGITS,
        )

    def family(self, low: Fraction, high: Fraction, near: OrbitInDigits | Points) -> ProposedFamily:
        """Return the orbits at both ends of an interval and in its middle.

        `near` is the orbit at its lower end, or has points near it.
        """
        first = near
        if not isinstance(first, OrbitInDigits):
            first = self.orbit(low, first)
        middle = self.orbit((low + high) / 2, first.points)
        # The upper end is about as far from the middle as the middle is from the lower end.
        ahead = [
            (2 * t - t_before, 2 * x - x_before)
            for (t_before, x_before), (t, x) in zip(first.points, middle.points, strict=True)
        ]
        last = self.orbit(high, ahead)
        values = tuple(_values(orbit) for orbit in (first, middle, last))
        return ProposedFamily(low, high, values, last)  # type: ignore[arg-type]

    def certificate(
        self, stable: bool | None = True, progress: Callable[[float], None] | None = None
    ) -> Certificate:
        """Propose every orbit of the branch and both of its ends; return the certificate."""
        try:
            return self._proposed(stable, progress)
        except NothingProposed as undecided:
            message = f"the branch of {self.word.cycle} in {self.name}: not decided: "
            return Certificate("branch", False, f"{message}{undecided.what}")

    def _proposed(
        self, stable: bool | None, progress: Callable[[float], None] | None
    ) -> Certificate:
        """Return the certificate, or raise NothingProposed."""
        ends = [self._end(end, side) for end, side in zip(self.ends, (-1, 1), strict=True)]
        low, high = (Fraction(end["inside"]) for end in ends)
        families, stable = self._cover(low, high, stable, progress)
        rows = [family.row() for family in families]
        return confirmed("branch", self._statement(rows, ends, stable, families[0]))

    def _statement(
        self, rows: list[Record], ends: list[Record], stable: bool | None, family: ProposedFamily
    ) -> Record:
        """Return the contents of a file with these rows and ends; `family` is one of the rows."""
        events = [switching.row for switching in family.last.switchings(0)]
        return made_by(BRANCH_DIGITS) | {
            "parameters": self.p.as_dict(),
            "parameter": self.name,
            "range": [rows[0]["value"][0], rows[-1]["value"][1]],
            "word": str(self.word.cycle),
            "periods": self.periods,
            "stable": stable,
            "ends": ends,
            "events": events,
            "boxes": rows,
        }

    def _refusal(self, family: ProposedFamily, ends: dict[int, Record], stable: bool | None) -> str:
        """Return why the checker does not prove a branch of one interval, or "".

        `ends` has what is not the end of the interval, by its side.
        """
        both = [
            ends.get(side, {"kind": RANGE, "inside": show(value), "outside": show(value)})
            for side, value in ((-1, family.low), (1, family.high))
        ]
        statement = self._statement([family.row()], both, stable, family)
        whole = {"format": FORMAT, "kind": "branch", "proven": True} | statement
        steps = STEPS_AT_END if ends else STEPS
        code, answer = judge(whole, steps=steps * len(self.word.labels))
        if code:
            return answer
        return ""

    def _cover(
        self,
        low: Fraction,
        high: Fraction,
        stable: bool | None,
        progress: Callable[[float], None] | None,
    ) -> tuple[list[ProposedFamily], bool | None]:
        """Return the families of intervals from end to end, each of which the checker proves by
        itself, or raise NothingProposed.

        Return also whether all orbits are proven to be stable: `stable`, or None.
        """
        whole = high - low
        width = FIRST_WIDTH * whole
        at = low
        near: OrbitInDigits | Points = self.ends[0].points
        families = list[ProposedFamily]()
        halved = False
        while at < high:
            # Few digits, so that the values stay short.
            end = min(high, at + Fraction(f"{float(width):.1e}"))
            reason = ""
            family = None
            try:
                family = self.family(at, end, near)
                reason = self._refusal(family, {}, stable)
            except NothingProposed as undecided:
                reason = undecided.what
            if reason:
                width = (end - at) / 2
                halved = True
                if width >= LEAST_WIDTH * whole:
                    continue
                # Only the stability is not proven here: then it is claimed nowhere.
                if stable and family is not None and not self._refusal(family, {}, None):
                    return self._cover(low, high, None, progress)
                raise NothingProposed(f"{reason}{self._near(families)}")
            assert family is not None
            families.append(family)
            if len(families) > MOST_BOXES:
                what = f"what comes after {MOST_BOXES} intervals"
                raise NothingProposed(f"{what}{self._near(families)}")
            # Towards a graze intervals get narrower and narrower: after a halving wider ones would be
            # refused.
            width = end - at
            if not halved:
                width = width * GROWTH
            halved = False
            at = end
            near = family.last
            if progress:
                progress(float((at - low) / whole))
        return families, stable

    def _near(self, families: Sequence[ProposedFamily]) -> str:
        """Return up to where the intervals reach, as the end of a message; "" if there are none."""
        if not families:
            return ""
        return f" near {self.name} = {float(families[-1].high):.12g}"

    def _end(self, end: ProposedEnd, side: int) -> Record:
        """Return the branch's lower (`side` -1) or upper (1) end as the checker proves it, or raise
        NothingProposed.
        """
        if end.kind == RANGE:
            return {"kind": RANGE, "inside": show(end.value), "outside": show(end.value)}
        for width in END_WIDTHS:
            span = self.ends[1].value - self.ends[0].value
            # The end, rounded to a power of 10 near the width: its decimals stay short.
            unit = Fraction(10) ** floor(log10(width * max(abs(end.value), span)))
            value = round(end.value / unit) * unit
            inside = value - side * unit
            outside = value + side * unit
            within = self.orbit(inside, end.points)
            # The interval inside of the end, beside which the checker proves it.
            next_to_it = self._between(inside, inside - side * unit, within.points)
            beyond = self._between(inside, outside, within.points)
            last = self.orbit(outside, within.points)
            box = beyond.row()
            for violation in broken(last):
                at = show_decimal(Fraction(f"{float(violation.t):.16g}"))
                row = {"kind": violation.kind, "inside": show(inside), "outside": show(outside)}
                row |= {"inequality": violation.text, "at": at}
                row |= {"t": box["t"], "x": box["x"]}
                if not self._refusal(next_to_it, {side: row}, None):
                    return row
        raise NothingProposed(
            f"which inequality fails beyond the {end.kind} at {self.name} = {float(end.value):.12g}"
        )

    def _between(self, value: Fraction, other: Fraction, near: Points) -> ProposedFamily:
        """Return the orbits between two values of the parameter, in either order."""
        return self.family(min(value, other), max(value, other), near)


def _values(orbit: OrbitInDigits) -> list[Fraction]:
    """Return t and x of all events of a period, the first one again at its end."""
    return [fraction(value) for _, t, x in orbit.switchings(0) for value in (t, x)]


class Violation(NamedTuple):
    """An inequality that a root violates, in the words of the checker: the kind of branch end where
    it first fails, the inequality, and the time at which it is violated.
    """

    kind: str
    text: str
    t: Number


def broken(orbit: OrbitInDigits) -> Iterator[Violation]:
    """Yield the inequalities that a root of the closing equations violates."""
    equations = orbit.equations
    Omega = equations.K.Om
    spans = equations.spans(orbit.solution)
    for i, span in enumerate(spans):
        piece, start, end, tau = span
        (_, start_theta) = start
        following = orbit.pieces[(i + 1) % len(spans)]
        label = piece.label
        if tau < 0:
            kind = "vanishing of a flight"
            if piece.sticks:
                kind = "vanishing of a stick"
            elif piece.after_stick:
                kind = "vanishing of a slip"
            yield Violation(kind, f"{label} lasts", start_theta / Omega)
            continue
        if piece.sticks:
            for hold, theta, domain in holding_forces(equations, span):
                if hold < 0:
                    sign = ">" if domain == piece.start else "<"
                    text = f"F^({domain}) {sign} 0 during {label}"
                    yield Violation("birth of a slip", text, theta / Omega)
            continue
        for gap, theta, belt in clearances(equations, span):
            if gap < 0:
                sign = ">" if piece.mode > belt else "<"
                yield Violation("grazing", f"v {sign} v{belt} during {label}", theta / Omega)
        if piece.after_stick:
            sign = ">" if piece.mode > piece.start else "<"
            text = f"v {sign} v{piece.start} during {label}"
            # If it leaves the belt to the wrong side, that is seen soon after the start.
            yield Violation("vanishing of a slip", text, start_theta / Omega + tau / SOON)
        yield from _broken_at_end(orbit, piece, following, end)


def _broken_at_end(
    orbit: OrbitInDigits, piece: Any, following: Any, end: tuple[Number, Number]
) -> Iterator[Violation]:
    """Yield the signs of forces that a root violates where a flight ends, as `broken` does."""
    equations = orbit.equations
    belt = piece.end
    v = equations.belt(belt).v
    x, theta = end
    forces = [equations.force(domain, x, v, theta) for domain in (belt, belt + 1)]
    # A crossing asks that both forces point along the motion, a stick for F below > 0 > F above.
    upward = piece.mode == belt
    below, above = forces
    has_no_jump = below == above
    for domain, force in zip((belt, belt + 1), forces, strict=True):
        sign = 1 if upward else -1
        if following.sticks:
            sign = 1 if domain == belt else -1
        if sign * force > 0:
            continue
        # The force of the flight's own domain says whether it meets the belt, that behind the belt
        # what follows.
        if domain == piece.mode or has_no_jump:
            kind = "grazing"
        elif following.sticks:
            kind = "birth of a slip"
        else:
            kind = "birth of a stick"
        relation = ">" if sign > 0 else "<"
        text = f"F^({domain}) {relation} 0 where {piece.label} ends"
        yield Violation(kind, text, theta / equations.K.Om)


# -- windows ---------------------------------------------------------------------------------------


def certify_window(window: GrazingWindow) -> Certificate:
    """Propose at which phases a mapping that meets a belt with F = 0 grazes it, and let the checker
    prove it.

    Return the certificate of that window.
    """
    where, ends = _grazing_phases(window)
    statement = made_by(WINDOW_DIGITS) | {
        "parameters": window.parameters.as_dict(),
        "map": window.mapping,
        "order": window.order,
        "grazes": where,
        "ends": [
            {"phase": outward(around(phase, 0), DIGITS), "sine": show(sine), "cosine": cosine}
            for phase, sine, cosine in ends
        ],
    }
    return confirmed("window", statement)


class WindowEnd(NamedTuple):
    """A phase at which s = 0, its exact sine, and the sign of its cosine."""

    phase: Number
    sine: Fraction
    cosine: int


def _grazing_phases(window: GrazingWindow) -> tuple[str, list[WindowEnd]]:
    """Return in words where a contact grazes, and the ends of an arc.

    An arc reaches from its first end, with growing theta, to its second.
    """
    # s = bias + swing sin(theta) is > 0 where it grazes.
    place = window.place
    p = window.parameters
    context = mp_context(WINDOW_DIGITS)
    bias = place.side * p.k * p.belt(place.boundary)
    swing = place.side * p.B0 * p.Omega
    always = ALL_PHASES if bias > 0 else NO_PHASE
    if abs(bias) > abs(swing) or swing == 0:
        return always, []
    sine = -bias / swing
    if abs(sine) == 1:
        if bias < 0 or window.order == "full":
            return always, []
        phase = context.pi * (1 if sine > 0 else 3) / 2
        return BUT_ONE_PHASE, [WindowEnd(phase, sine, 0)]
    rising = context.asin(context.mpf(sine.numerator) / sine.denominator)
    falling = context.pi - rising
    # s > 0 from where it rises through 0 to where it falls.
    first, second = rising, falling
    if swing < 0:
        first, second = falling, rising
    cosine = 1 if swing > 0 else -1  # the sign of the cosine at the first end
    if first < 0:
        first = first + 2 * context.pi
    while not second > first:
        second = second + 2 * context.pi
    return ON_AN_ARC, [WindowEnd(first, sine, cosine), WindowEnd(second, sine, -cosine)]
