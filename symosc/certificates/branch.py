"""A branch of orbits, proven for every value of a parameter between two, and up to the ends of the
branch.

It is Krawczyk's proof about a curve instead of a point. Let delta be the change of the parameter
from the middle of an interval, and c(delta) a polynomial near the curve of roots (Newton's method
for power series gives it; nothing rests on it). By Taylor's theorem f(c(delta), delta) is enclosed
by its first N coefficients at 0 and that of order N at all delta: F, of order N in the width. Let R
be a box about 0, J the Jacobian over all c(delta) + R, and Y any matrix. If
- Y F + (1 - Y J) R lies inside R, there is exactly one root in c(delta) + R for every delta, the
  only one where J is.

A branch ends where an inequality that holds inside it becomes an equality: one root is proven for
every value of the parameter between one just inside, where all inequalities are proven, and one
just outside, where one of them is proven to fail. The proofs are in `symosc derive certificates`.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import comb, floor, log10

from flint import arb, arb_mat, arb_series, ctx

from symosc.base.aliases import Record
from symosc.base.display.progress import reporting
from symosc.base.exact import show
from symosc.certificates.balls import Ball, Undecided, ball, made_by, outward
from symosc.certificates.certificate import Certificate, confirmed
from symosc.certificates.flow import Oscillator
from symosc.certificates.orbit import ClosingBalls, Margin, Values, column, switchings, unit_matrix
from symosc.model import Parameters
from symosc.orbits.branch import Branch
from symosc.orbits.closing_equations import pieces_of
from symosc.words import Word

BRANCH_BITS = 128
#: Digits of the enclosures in a file; coefficients of the curve.
BRANCH_DIGITS = 16
ORDER = 3
MOST_INFLATIONS = 8
INFLATION = 1.2
#: How much wider the balls are in which a root is the only one: those that are stated; those that
#: are proven, so that a checker whose balls are a little wider proves the others.
STATED_WIDTH = 1.2
PROVEN_WIDTH = 1.5
#: How far `inside` and `outside` are from a branch's end, as a part of its value or of the range.
END_WIDTH = Fraction(1, 10**11)
#: The width of the first interval, as a part of the range; the factor by which the next one is
#: wider.
FIRST_WIDTH = Fraction(1, 50)
GROWTH = Fraction(8, 5)
MOST_BOXES = 100_000
LEAST_WIDTH = Fraction(1, 10**16)
END_OF_RANGE = "end of the range"
#: Times of a piece at which a margin is sampled, Newton steps from the lowest of them, and the
#: powers of 1/2 of a piece by which the others are off its start or end.
LOW_SAMPLES = 96
MOST_LOW_STEPS = 12
NEAR_POWERS = range(8, 60)

#: The kind of an end of a branch, the parameter's value there, and t_0, x_0, ... of the orbit,
#: approximately.
GivenEnd = tuple[str, Fraction, Values]


class Family:
    """All orbits of one word for an interval of one parameter: closing equations, and enclosures of
    their roots.

    The constructor proves that there is one root for every value of the parameter; it raises
    Undecided if it cannot.
    """

    def __init__(self, prover: BranchProver, low: Fraction, high: Fraction, near: Values) -> None:
        self.prover = prover
        self.low = low
        self.high = high
        self.middle = ball((low + high) / 2)
        every = ball(low).union(ball(high))
        change = every - self.middle
        thin = prover.at((low + high) / 2)
        self.wide = ClosingBalls(
            Oscillator(thin.oscillator.p, {prover.name: every}), prover.pieces, prover.periods
        )
        start = thin.polished(near)
        try:
            Y = thin.jacobian(start).mid().inv().mid()
        except ZeroDivisionError:
            raise Undecided("singular closing equations") from None
        self.curve = [column(start)]
        for order in range(2, ORDER + 1):
            rest = self._coefficients(self.middle, [*self.curve, 0 * self.curve[0]], order)[-1]
            self.curve.append(-(Y * rest).mid())
        # The remainder: the coefficients of order ORDER of the residuals, about all values of the
        # parameter at once.
        shifted = [
            _horner([comb(k, j) * self.curve[k] for k in range(j, ORDER)], change)
            for j in range(ORDER)
        ]
        remainder = self._coefficients(every, shifted, ORDER + 1)[-1]
        enclosed = _horner([*self._coefficients(self.middle, self.curve, ORDER), remainder], change)
        box = pushed = (-(Y * enclosed)).entries()
        along = _horner(self.curve, change).entries()
        for _ in range(MOST_INFLATIONS):
            wider = [(INFLATION * abs(each).upper()).mid() for each in box]
            box = [arb(0, each) + arb(0, arb(2) ** (8 - ctx.prec)) for each in wider]
            whole = [c + r for c, r in zip(along, box, strict=True)]
            J = self.wide.jacobian([_scaled(each, PROVEN_WIDTH) for each in whole])
            turned = ((unit_matrix(len(start)) - Y * J) * column(box)).entries()
            image = [a + b for a, b in zip(pushed, turned, strict=True)]
            if all(r.contains_interior(each) for r, each in zip(box, image, strict=True)):
                self.tube = box
                self.points = [c + each for c, each in zip(along, image, strict=True)]
                events = switchings(self.wide, [_scaled(each, STATED_WIDTH) for each in whole], 0)
                #: The enclosures of t and x at all events, as decimals for the file.
                self.row: Record = {
                    n: [list(outward(getattr(each, n), BRANCH_DIGITS)) for each in events]
                    for n in "tx"
                }
                return
            if not all(each.is_finite() for each in image):
                break
            box = image
        raise Undecided("one root for every value of the parameter")

    def _coefficients(self, value: Ball, curve: list[arb_mat], order: int) -> list[arb_mat]:
        """Return the first `order` Taylor coefficients of the residuals along a `curve` of
        unknowns, about `value`.
        """
        ctx.cap = max(ctx.cap, order)
        wide = self.wide
        series = Oscillator(
            wide.oscillator.p, {self.prover.name: arb_series([value, 1], prec=order)}
        )
        values = [
            arb_series(list(each), prec=order)
            for each in zip(*(row.entries() for row in curve), strict=True)
        ]
        found = ClosingBalls(series, wide.pieces, wide.periods).residuals(values)
        return [column([each[j] for each in found]) for j in range(order)]

    def near(self, value: Fraction) -> Values:
        """Return the approximate root at a parameter value, even outside the interval, by the
        family's polynomial.
        """
        return list(_horner(self.curve, ball(value) - self.middle).entries())

    def holds(self, value: Fraction, points: Values) -> bool:
        """Return whether `points` are in the box, about the approximate root at `value`, that has
        exactly one root.
        """
        return all(
            (c + r).contains(each)
            for c, r, each in zip(self.near(value), self.tube, points, strict=True)
        )

    def root(self, value: Fraction) -> tuple[ClosingBalls, Values]:
        """Return the closing equations at a value of the parameter, and a narrow enclosure of their
        root.
        """
        thin = self.prover.at(value)
        for _, points in thin.roots(thin.polished([each.mid() for each in self.near(value)])):
            if self.holds(value, points):
                return thin, points
        raise Undecided("whether the roots of two intervals of the parameter are one")


def _horner(coefficients: list[arb_mat], at: Ball) -> arb_mat:
    """Evaluate several polynomials at `at` by Horner's scheme.

    `coefficients[i]` is a column of those of order i.
    """
    total = coefficients[-1]
    for row in reversed(coefficients[:-1]):
        total = column([a + at * b for a, b in zip(row.entries(), total.entries(), strict=True)])
    return total


def _scaled(value: Ball, factor: float) -> Ball:
    """Return a ball with the same middle and its radius multiplied by a factor."""
    return value.mid() + arb(0, (factor * value.rad()).mid())


def violated(closing: ClosingBalls, values: Values) -> tuple[str, Ball, str] | None:
    """Return an inequality that a root certainly violates, or None if none is found."""
    margins = [closing.margins(i, values) for i in range(len(closing.pieces))]
    durations = [(i, span) for i, (span, *_) in enumerate(margins)]
    for i, margin in durations + [
        (i, margin) for i, (_, *others) in enumerate(margins) for margin in others
    ]:
        span: Ball = margins[i][0].curve
        curve = margin.curve
        kind = margin.kind
        if not callable(curve):
            if curve < 0:
                tau = arb(0)
            else:
                tau = None
        else:
            if span > 0:
                tau = _below(margin, span)
            else:
                tau = None
            leaves = curve(arb(0))[1 + margin.at_start] > 0
            kind = kind or ("grazing" if leaves else "vanishing of a slip")
        if tau is not None:
            return margin.what, values[2 * i] + tau, kind
    return None


def _below(margin: Margin, span: Ball) -> Ball | None:
    """Return a time (0 to `span`) after a piece's start at which its `margin` is certainly < 0,
    None if not found.
    """
    last = span.lower().mid()
    curve = margin.curve
    tau = min(
        ((last * part / LOW_SAMPLES).mid() for part in range(1, LOW_SAMPLES)),
        key=lambda t: float(curve(t).g),
    )
    for _ in range(MOST_LOW_STEPS):
        there = curve(tau)
        if there.g < 0:
            return tau
        following = (tau - there.dg / there.ddg).mid()
        if not (following.is_finite() and 0 < following < last):
            break
        tau = following
    near = [
        last * arb(2) ** -power for power in NEAR_POWERS
    ]  # right after the start, right before the end
    if not (curve(arb(0))[1 + margin.at_start] < 0):
        near = [last - each for each in near]
    return next((each for each in near if curve(each).g < 0), None)


def prove_branch(
    branch: Branch, progress: Callable[[float], None] | bool | None = None
) -> Certificate:
    """Prove every orbit of a branch between its ends, and where and why it ends.

    Return the certificate.
    """
    ends = []
    for i in (0, -1):
        points = [ball(Fraction(float(each))) for t, x in branch.points[i] for each in (t, x)]
        ends.append((branch.ends[i].kind, Fraction(str(float(branch.values[i]))), points))
    first, last = sorted(ends, key=lambda end: end[1])
    prover = BranchProver(
        branch.parameters(0), branch.parameter, branch.labels, branch.periods, (first, last)
    )
    if not isinstance(progress, bool):
        return prover.certificate(progress)
    with reporting(progress, 0, 1, "proven", "") as report:
        return prover.certificate(lambda part: report(part, 1))


class BranchProver:
    """A prover of a word's orbits for all values of the parameter `name` between both `ends`, the
    lower one first.
    """

    def __init__(
        self,
        p: Parameters,
        name: str,
        labels: tuple[str, ...],
        periods: int,
        ends: tuple[GivenEnd, GivenEnd],
    ) -> None:
        self.p = p
        self.name = name
        self.word = Word(labels)
        self.periods = periods
        self.ends = ends
        self.pieces = pieces_of(self.word)
        self.families = list[Family]()

    def at(self, value: Fraction) -> ClosingBalls:
        """Return the closing equations at one value of the parameter."""
        return ClosingBalls(
            Oscillator(self.p.replace(**{self.name: value})), self.pieces, self.periods
        )

    def certificate(self, progress: Callable[[float], None] | None = None) -> Certificate:
        """Prove every orbit of the branch and both of its ends; return the certificate."""
        with ctx.workprec(BRANCH_BITS):
            try:
                rows = [self._end(*end, side) for side, end in zip((-1, 1), self.ends, strict=True)]
                low, high = (Fraction(row["inside"]) for row in rows)
                self._cover(low, high, progress)
            except Undecided as undecided:
                if not self.families:
                    near = ""
                else:
                    near = f" near {self.name} = {float(self.families[-1].high):.12g}"
                message = (
                    f"the branch of {self.word.cycle} in {self.name}: not decided: "
                    f"{undecided.what}{near}"
                )
                return Certificate("branch", False, message)
            first = self.families[0]
            changes = [event.named() for event in switchings(first.wide, first.points, 0)]
            stable = (
                all(family.wide.stability(family.points).stable for family in self.families) or None
            )
        statement = made_by(BRANCH_BITS) | {
            "parameters": self.p.as_dict(),
            "parameter": self.name,
            "range": [row["inside"] for row in rows],
            "word": str(self.word.cycle),
            "periods": self.periods,
            "stable": stable,
            "ends": rows,
            "events": changes,
            "boxes": [
                {"value": [show(each.low), show(each.high)]} | each.row for each in self.families
            ],
        }
        return confirmed("branch", statement)

    def _end(self, kind: str, value: Fraction, near: Values, side: int) -> Record:
        """Prove the branch's lower (`side` -1) or upper (1) end at `value`, with the orbit `near`.

        Return its row.
        """
        if kind == END_OF_RANGE:
            return {"kind": kind, "inside": show(value), "outside": show(value)}
        width = Fraction(10) ** floor(
            log10(END_WIDTH * max(abs(value), self.ends[1][1] - self.ends[0][1]))
        )
        value = round(value / width) * width
        inside = value - side * width
        outside = value + side * width
        family = Family(self, min(inside, outside), max(inside, outside), near)
        within, root = family.root(inside)
        within.prove_course(root)
        broken = violated(*family.root(outside))
        if broken is None:
            raise Undecided(
                f"which inequality fails beyond the {kind} at {self.name} = {float(value):.12g}"
            )
        text, t, kind = broken
        row = {"kind": kind, "inside": show(inside), "outside": show(outside), "inequality": text}
        return row | {"at": t.mid().str(BRANCH_DIGITS, radius=False)} | family.row

    def _cover(
        self, low: Fraction, high: Fraction, progress: Callable[[float], None] | None
    ) -> None:
        """Prove the orbits for all values from `low` to `high` by intervals, and that the roots of
        neighbours join.
        """
        whole = high - low
        (kind, value, near) = self.ends[0]
        at = low
        if kind == END_OF_RANGE:
            width = FIRST_WIDTH * whole
        else:
            width = (low - value) / 2
        while at < high:
            end = min(
                high, at + Fraction(f"{float(width):.1e}")
            )  # few digits, so that the values stay short
            try:
                family = Family(self, at, end, near)
                family.wide.prove_course(family.points)
            except Undecided:
                width = (end - at) / 2
                if width < LEAST_WIDTH * whole:
                    raise
                continue
            if self.families and not self.families[-1].holds(at, family.root(at)[1]):
                raise Undecided("whether the orbits of two intervals of the parameter are one")
            self.families.append(family)
            if len(self.families) > MOST_BOXES:
                raise Undecided(f"what comes after {MOST_BOXES} intervals")
            width = (end - at) * GROWTH
            at = end
            near = [each.mid() for each in family.near(end)]
            if progress:
                progress(float((at - low) / whole))
