"""A branch of orbits, proven for every value of a parameter between two, and up to the ends of the branch."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import floor, log10
from typing import NamedTuple

from symosc.aliases import Record
from symosc.certificates.balls import FLINT_VERSION, Undecided, ball, outward, working_bits
from symosc.certificates.certificate import Certificate, confirmed
from symosc.certificates.closing import ClosingBalls, Values
from symosc.certificates.course import prove_course
from symosc.certificates.ends import violated
from symosc.certificates.family import Family
from symosc.certificates.flow import Oscillator
from symosc.certificates.multipliers import stability
from symosc.certificates.orbit import switchings
from symosc.display.progress import reporting
from symosc.exact import show
from symosc.model import Parameters
from symosc.orbits.branch import Branch
from symosc.orbits.closing_equations import OrbitPiece, pieces_of
from symosc.words import Word

BRANCH_BITS = 128
#: Digits of the enclosures in a file.
BRANCH_DIGITS = 16
#: Half-width of the enclosure of an end, as a part of its value or of the range.
END_WIDTH = Fraction(1, 10**11)
#: The first interval, as a part of the range; by how much the next one is wider.
FIRST_WIDTH, GROWTH = Fraction(1, 50), Fraction(8, 5)
MOST_BOXES, LEAST_WIDTH = 100_000, Fraction(1, 10**16)
END_OF_RANGE = "end of the range"

Progress = Callable[[float], None]


class BranchToProve(NamedTuple):
    """What is to be proven: parameters, the one that varies, labels, periods, and what is known near each end.

    Attributes
    ----------
    ends : two tuples (kind, value, points)
        At the lowest and the highest value; the points are (t, x) near the orbit there.
    """

    p: Parameters
    name: str
    labels: tuple[str, ...]
    periods: int
    ends: tuple[tuple[str, Fraction, Values], tuple[str, Fraction, Values]]


class Box(NamedTuple):
    """An interval of the parameter, and enclosures of the points of the orbit for all values in it."""

    family: Family
    points: Values


class ProvenEnd(NamedTuple):
    """An end: its kind, a value inside at which all inequalities hold, one outside at which one of them fails.

    And that inequality, the time at which it fails, and enclosures of the points for all values between the two.
    """

    kind: str
    inside: Fraction
    outside: Fraction
    inequality: str = ""
    at: str = ""
    box: Box | None = None


def prove_branch(branch: Branch, progress: Progress | bool | None = None) -> Certificate:
    """Prove a branch; see `symosc.certify`."""
    ends = []
    for i in (0, -1):
        points = [ball(Fraction(float(each))) for t, x in branch.points[i] for each in (t, x)]
        ends.append((branch.ends[i].kind, Fraction(str(float(branch.values[i]))), points))
    first, last = sorted(ends, key=lambda end: end[1])
    task = BranchToProve(branch.parameters(0), branch.parameter, branch.labels, branch.periods, (first, last))
    if not isinstance(progress, bool):
        return certify_branch(task, progress)
    with reporting(progress, 0, 1, "proven", "") as report:
        return certify_branch(task, lambda part: report(part, 1))


def certify_branch(task: BranchToProve, progress: Progress | None = None) -> Certificate:
    """Prove every orbit between the ends of a branch, and the ends."""
    with working_bits(BRANCH_BITS):
        pieces, boxes, ends = pieces_of(Word(task.labels)), [], []
        try:
            for side, (kind, value, points) in zip((-1, 1), task.ends, strict=True):
                ends.append(_end(task, pieces, kind, value, side, points))
            low, high = (end.inside for end in ends)
            boxes = _cover(task, pieces, low, high, progress or (lambda part: None))
        except Undecided as undecided:
            near = "" if not boxes else f" near {task.name} = {float(boxes[-1].family.high):.12g}"
            message = f"the branch of {Word(task.labels)} in {task.name}: not decided: {undecided.what}{near}"
            return Certificate("branch", False, message)
        return _certificate(task, ends, boxes)


def _closing(task: BranchToProve, pieces: tuple[OrbitPiece, ...], value: Fraction) -> ClosingBalls:
    return ClosingBalls(Oscillator(task.p.replace(**{task.name: value})), pieces, task.periods)


def _end(
    task: BranchToProve, pieces: tuple[OrbitPiece, ...], kind: str, value: Fraction, side: int, near: Values
) -> ProvenEnd:
    """Prove an end: one root for all values around it, and an inequality that fails beyond it.

    That all inequalities hold on its inner side is proven with the branch.
    """
    if kind == END_OF_RANGE:
        return ProvenEnd(kind, value, value)
    width = Fraction(10) ** floor(log10(END_WIDTH * max(abs(value), task.ends[1][1] - task.ends[0][1])))
    value = round(value / width) * width
    inside, outside = value - side * width, value + side * width
    family = Family(task.p, task.name, min(inside, outside), max(inside, outside), pieces, task.periods)
    box = Box(family, family.prove(near))
    within = _closing(task, pieces, inside)
    prove_course(within, _narrow(within, family, inside))
    thin = _closing(task, pieces, outside)
    points = _narrow(thin, family, outside)
    broken = violated(thin, points)
    if broken is None:
        raise Undecided(f"which inequality fails beyond the {kind} at {task.name} = {float(value):.12g}")
    return ProvenEnd(broken.kind, inside, outside, broken.text, broken.t.mid().str(BRANCH_DIGITS, radius=False), box)


def _narrow(thin: ClosingBalls, family: Family, value: Fraction) -> Values:
    """Return a narrow enclosure of the family's root at one value of the parameter."""
    for root in thin.boxes(thin.polished([each.mid() for each in family.near(value)])):
        if family.holds(value, root.points):
            return root.points
    raise Undecided("whether the roots of two intervals of the parameter are one")


def _cover(
    task: BranchToProve, pieces: tuple[OrbitPiece, ...], low: Fraction, high: Fraction, progress: Progress
) -> list[Box]:
    """Prove the orbits for all values from low to high, by intervals that fit themselves.

    Where two intervals meet both have the same root there.
    """
    whole, boxes = high - low, list[Box]()
    kind, value, near = task.ends[0]
    width = FIRST_WIDTH * whole if kind == END_OF_RANGE else (low - value) / 2
    at = low
    while at < high:
        end = min(high, at + _round(width))
        try:
            box = _box(task, pieces, at, end, near)
        except Undecided:
            width = (end - at) / 2
            if width < LEAST_WIDTH * whole:
                raise
            continue
        if boxes and not boxes[-1].family.holds(at, _narrow(_closing(task, pieces, at), box.family, at)):
            raise Undecided("whether the orbits of two intervals of the parameter are one")
        boxes.append(box)
        if len(boxes) > MOST_BOXES:
            raise Undecided(f"what comes after {MOST_BOXES} intervals")
        at, width = end, (end - at) * GROWTH
        near = [each.mid() for each in box.family.near(end)]
        progress(float((at - low) / whole))
    return boxes


def _round(width: Fraction) -> Fraction:
    """Return a width with few digits, so that the values of the parameter stay short."""
    return Fraction(f"{float(width):.1e}")


def _box(task: BranchToProve, pieces: tuple[OrbitPiece, ...], low: Fraction, high: Fraction, near: Values) -> Box:
    family = Family(task.p, task.name, low, high, pieces, task.periods)
    points = family.prove(near)
    prove_course(family.wide, points)
    return Box(family, points)


# -- what is said about it ---------------------------------------------------------------------------------------------


def _certificate(task: BranchToProve, ends: list[ProvenEnd], boxes: list[Box]) -> Certificate:
    rows = [{"value": [show(box.family.low), show(box.family.high)]} | _points(box) for box in boxes]
    course = [
        {"kind": kind, "boundary": boundary, "source": source, "target": target}
        for kind, boundary, source, target, _, _ in switchings(boxes[0].family.wide, boxes[0].points, 0)
    ]
    stable = all(stability(family.wide, points).stable for family, points in boxes)
    statement: Record = {
        "made_by": f"symosc, python-flint {FLINT_VERSION}, {BRANCH_BITS} bits",
        "parameters": task.p.as_dict(),
        "parameter": task.name,
        "range": [show(ends[0].inside), show(ends[1].inside)],
        "word": str(Word(task.labels)),
        "periods": task.periods,
        "stable": True if stable else None,
        "ends": [
            {"kind": end.kind, "inside": show(end.inside), "outside": show(end.outside)}
            | ({} if end.box is None else {"inequality": end.inequality, "at": end.at} | _points(end.box))
            for end in ends
        ],
        "events": course,
        "boxes": rows,
    }
    changes = tuple((row["kind"], row["source"], row["target"]) for row in course)
    return confirmed(Certificate("branch", True, "", changes, stable=True if stable else None, statement=statement))


def _points(box: Box) -> Record:
    """Return the enclosures of the points as a file has them."""
    events = switchings(box.family.wide, box.family.stated, 0)
    return {name: [list(outward(event[j], BRANCH_DIGITS)) for event in events] for name, j in (("t", 4), ("x", 5))}
