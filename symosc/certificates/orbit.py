"""A periodic orbit, proven: it exists, it is alone in a box, it has its word, and its multipliers are enclosed."""

from __future__ import annotations

from fractions import Fraction
from math import floor, log10
from typing import NamedTuple

from flint import arb, arb_mat

from symosc.aliases import Number, Record
from symosc.certificates.balls import FLINT_VERSION, Ball, Undecided, exact_ends, outward, working_bits
from symosc.certificates.certificate import Certificate, confirmed
from symosc.certificates.closing import ClosingBalls, Root, Values
from symosc.certificates.course import prove_course
from symosc.certificates.flow import Oscillator
from symosc.certificates.multipliers import Stability, stability
from symosc.model import MODE_NAMES, Parameters
from symosc.orbits.closing_equations import OrbitPiece, pieces_of
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.words import Word

LEAST_ORBIT_BITS, MOST_ORBIT_BITS = 128, 1024
#: Digits of the enclosures of points and of multipliers in a file; the radius that the first must have, relatively.
POINT_DIGITS, MULTIPLIER_PLACES = 25, 16
ACCURATE = 10.0 ** (-POINT_DIGITS - 2)
#: A singular system is called so if a multiplier is 1 to this part.
NEARLY_ONE = 1e-12
#: What part of the box in which an orbit is proven to be alone is stated: a way of proof with wider balls needs less.
STATED = arb(2) ** -24
#: By how much a hint is more than the first-order value; the least radius in a hint.
SPARE, LEAST_RADIUS = 32, Fraction(1, 10**60)


class OrbitToProve(NamedTuple):
    """What is to be proven: parameters, labels in order of time, periods, points (t, x) near it."""

    p: Parameters
    labels: tuple[str, ...]
    periods: int
    near: tuple[tuple[Number, Number], ...]


class OrbitProof(NamedTuple):
    """What is proven: the equations, the root, trace and determinant."""

    closing: ClosingBalls
    root: Root
    stability: Stability


def prove_orbit(orbit: PeriodicOrbit) -> Certificate:
    """Prove a periodic orbit; see `symosc.certify`."""
    near = tuple((t, x) for t, x in orbit.points)
    return certify_orbit(OrbitToProve(orbit.parameters, orbit.labels, orbit.periods, near))


def certify_orbit(task: OrbitToProve) -> Certificate:
    """Prove an orbit near the given points, with as many bits as it takes."""
    pieces, bits = pieces_of(Word(task.labels)), LEAST_ORBIT_BITS
    while True:
        with working_bits(bits):
            try:
                closing = ClosingBalls(Oscillator(task.p), pieces, task.periods)
                proof = prove_with_word(closing, [_exact(each) for point in task.near for each in point])
                if proof.stability.stable is not None or bits >= MOST_ORBIT_BITS:
                    return _certificate(task, proof, bits)
            except Undecided as undecided:
                if bits >= MOST_ORBIT_BITS:
                    return Certificate("orbit", False, _open(task, undecided, bits))
            bits *= 2


def _exact(number: Number) -> Ball:
    man_exp = getattr(number, "man_exp", None)  # an mpmath number has more digits than a float
    if man_exp is None:
        return arb(number)
    mantissa, exponent = (int(each) for each in man_exp)
    return arb((mantissa, exponent))


def prove_with_word(closing: ClosingBalls, near: Values) -> OrbitProof:
    """Prove a root near these points, its word, and enclose its multipliers.

    Raises
    ------
    Undecided
    """
    middle = closing.polished(near)
    reason = Undecided("the closing equations: no box in which their root is the only one")
    for root in closing.boxes(middle):
        try:
            prove_course(closing, root.box)
        except Undecided as undecided:
            reason = undecided
            continue
        if any(float(value.rad()) > ACCURATE * max(1.0, abs(float(value))) for value in root.points):
            raise Undecided("the digits of the switching points")
        return OrbitProof(closing, root, stability(closing, root.points))
    raise reason


# -- what is said about it ---------------------------------------------------------------------------------------------


def first_arrival(pieces: tuple[OrbitPiece, ...]) -> int:
    """Return the first switching point at the end of a flight: there the forces say how the motion goes on."""
    return next(i for i in range(len(pieces)) if not pieces[i - 1].sticks)


def switchings(closing: ClosingBalls, values: Values, begin: int) -> list[tuple[str, int, str, str, Ball, Ball]]:
    """Return kind, boundary, source, target, t and x from one switching up to the same one a period later."""
    pieces, n, rows = closing.pieces, len(closing.pieces), []
    for j in range(begin, begin + n + 1):
        i = j % n
        source, target = pieces[i - 1].mode, pieces[i].mode
        kind = "slip" if pieces[i - 1].sticks else "stick" if pieces[i].sticks else "cross"
        t = values[2 * i] + closing.turn if j >= n else values[2 * i]
        rows.append((kind, pieces[i].start, MODE_NAMES[source], MODE_NAMES[target], t, values[2 * i + 1]))
    return rows


def reaches(closing: ClosingBalls, root: Root) -> list[Ball]:
    """Return how far in time the motions from the box of the first arrival may be off at the events; a hint, no proof.

    It is many times the first-order value: whoever proves it uses balls that are wider than the set.
    """
    n, begin = len(closing.pieces), first_arrival(closing.pieces)
    values = [value.mid() for value in root.points]
    wide_t, wide_x = (STATED * value.rad().mid() for value in root.box[2 * begin : 2 * begin + 2])
    moved, found = arb_mat([[wide_t, 0], [0, wide_x]]), [2 * wide_t]
    for i in range(begin, begin + n):
        at_start, at_end = closing.blocks(i % n, values)
        moved = (-(at_end.solve(at_start)) * moved).mid()
        found.append(SPARE * (abs(moved[0, 0]) + abs(moved[0, 1])))
    return found


def statement_of(closing: ClosingBalls, root: Root) -> Record:
    """Return the switching points as a file has them, and how far around the first one the orbit is alone."""
    begin = first_arrival(closing.pieces)
    rows = [
        {"kind": kind, "boundary": boundary, "source": source, "target": target}
        | {"t": list(outward(t, POINT_DIGITS)), "x": list(outward(x, POINT_DIGITS)), "reach": one_digit(reach)}
        for (kind, boundary, source, target, t, x), reach in zip(
            switchings(closing, root.points, begin), reaches(closing, root), strict=True
        )
    ]
    alone = [one_digit(STATED * value.rad()) for value in root.box[2 * begin : 2 * begin + 2]]
    return {"periods": closing.periods, "events": rows, "alone_within": alone}


def _decimals(value: Ball) -> tuple[str, str]:
    return ("0", "0") if value.is_zero() else outward(value, MULTIPLIER_PLACES)


def one_digit(radius: Ball) -> str:
    """Return a decimal of one digit that is surely a little less than a radius."""
    most = max(exact_ends(radius)[0], LEAST_RADIUS) * Fraction(99, 100)
    power = floor(log10(most))
    return f"{most // Fraction(10) ** power}e{power}"


def _certificate(task: OrbitToProve, proof: OrbitProof, bits: int) -> Certificate:
    closing, root = proof.closing, proof.root
    pairs = [(_decimals(re), _decimals(im)) for re, im in proof.stability.multipliers()]
    stable = proof.stability.stable
    statement: Record = {
        "made_by": f"symosc, python-flint {FLINT_VERSION}, {bits} bits",
        "parameters": task.p.as_dict(),
        "word": str(Word(task.labels)),
        **statement_of(closing, root),
        "multipliers": [{"re": list(re), "im": list(im)} for re, im in pairs],
        "stable": stable,
    }
    rows = statement["events"]
    certificate = Certificate(
        "orbit",
        True,
        "",
        events=tuple((row["kind"], row["source"], row["target"], tuple(row["t"]), tuple(row["x"])) for row in rows),
        points=tuple(
            (outward(root.points[2 * i], POINT_DIGITS), outward(root.points[2 * i + 1], POINT_DIGITS))
            for i in range(len(closing.pieces))
        ),
        multipliers=tuple(pairs),
        stable=stable,
        statement=statement,
    )
    return confirmed(certificate)


def _open(task: OrbitToProve, undecided: Undecided, bits: int) -> str:
    near = "" if undecided.near is None else f" near t = {undecided.near.mid().str(15, radius=False)}"
    text = f"the orbit {Word(task.labels)}, with {bits} bits: not decided: {undecided.what}{near}"
    return text + _singular(task)


def _singular(task: OrbitToProve) -> str:
    """Return that an orbit is marginal, if the given points have a multiplier of 1 to many digits."""
    try:
        closing = ClosingBalls(Oscillator(task.p), pieces_of(Word(task.labels)), task.periods)
        values = [_exact(each) for point in task.near for each in point]
        T, D = stability(closing, values)
    except Undecided:
        return ""
    if not abs(float((1 - T + D).mid())) < NEARLY_ONE:
        return ""
    return "; it is marginal (a multiplier is 1, as nearly as can be seen), and need not be isolated: there may be many"
