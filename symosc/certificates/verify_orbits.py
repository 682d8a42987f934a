#!/usr/bin/env python3
"""Prove a certificate of an orbit, of a branch of orbits or of an atlas once more: ``python
verify_orbits.py FILE``.

It needs verify.py beside it, python-flint, and nothing of symosc; it proves all kinds. verify.py
has the equation and how a motion is followed from event to event, for all starts of a box at once.
Balls (arb) prove:

1. "orbit": let P be the motion from the times and positions at the first event to those at the
   last, less the periods, and D its derivatives over a box c + [-e, e]. A fixed point c + u has u =
   (P(c) - c) + D u (mean value theorem). If the solution w of (1 - D) w = P(c) - c is unique and
   lies in [-e, e], for all matrices in D, there is exactly one fixed point in the box, and it is in
   c + w (interval Newton). It is done for the box stated, and again for one or two small boxes
   around the fixed point, to know it better.
2. The multipliers are the eigenvalues of D at the fixed point: the roots of z^2 - T z + d, with its
   trace T and its determinant d (0 if the motion sticks). Both are inside the unit circle if and
   only if |d| < 1 and |T| < 1 + d.
3. A motion with a smaller period of N/q forcing periods does the same events after 1/q of them: it
   has not, if their kinds differ, or t or x at the event where it would begin again. On a branch
   one box is enough: two roots where J is regular never meet.

   A cycle without a drive (B0 = 0, of a law with `belts`) may begin at any time: P maps x to x, e_t
   = 0, and D is its derivative by x. The multipliers are 1 and D (0 if the motion sticks).

   An orbit without events is the steady motion of the band around v = 0, if its largest speed is
   less than those of the edges. D is the flow of y'' + (c/m) y' + (k/m) y = 0 over a forcing period.

A "branch", for an interval of a parameter at once:

4. x = A/k + a cos(Omega t) + b sin(Omega t) + y, a + i b = B0/(k - m Omega^2 - i c Omega), y'' + 2
   h y' + (k/m) y = 0, h = c/(2m). So y(s) = y(0) C + (y'(0) + h y(0)) S, with C and S = exp(-h s)
   times cosh(w s) and sinh(w s)/w, and w^2 = h^2 - k/m of any sign. A mode ends where a function f
   is 0: the distance of v from a belt; on a belt F or -F.
5. u = (t_0, x_0, t_1, ...) is on an orbit only if r(u) = 0: each mode leads from one (t_i, x_i) to
   the next, f = 0 there, and the last is the first again. Let J contain the derivatives of r over a
   box X and an interval of the parameter, and c be in X for each of its values. If J has no
   singular matrix and c - J^-1 r(c) lies in X, then for each value r has exactly one root in X, and
   it is in c - J^-1 r(c) (interval Newton). c is a polynomial in the change d of the parameter, and
   r(c) = r_0 + r_1 d + ... + r_n d^n with r_n of all its values (Taylor).
6. The modes follow each other as F on both sides of a belt says, and f > 0 between two events.
7. An end: from `inside`, a value that the boxes contain, to `outside` r has one root in a box. It
   is the branch's at `inside`, where all inequalities hold; at `outside` the one named fails (a
   distance or a force on a belt: at the time `at`). Both sides of it are continuous: in between it
   becomes an equality. Which one is the first is not proven.

An "atlas", for a box of two parameters at once. For c > 0 and k > 0 an orbit with a flight attracts
all other motions (the energy of a difference of two motions never grows), so that a point of the
plane has one word:

8. Between two events x'' + (c/m) x' + (k/m) x = (A + B0 cos theta)/m. With the roots l, l' of l^2 +
   (c/m) l + k/m and X(a, b) = (exp(a s) - exp(b s))/(a - b) = s exp((a + b) s/2) sinh(w)/w, w = (a
   - b) s/2, it is S = X(l, l') for a unit of velocity at the start, and Z = (X(l, i Omega) - X(l',
   i Omega))/(l - l') for the drive exp(i Omega s)/m. sinh(w)/w = 0F1(3/2; w^2/4) is entire: nothing
   is special at resonance.
9. Unknowns u: of each flight the phase at its start, its duration, and x at its start, unless it
   follows a stick: there F = 0 says x. r(u) = 0: v is that of the belt at its end, and x and the
   phase fit to the next flight. If word and oscillator are symmetric about A0/k, half a period is
   enough (a belt without friction is seen in the image too).
10. u(d) is a polynomial of degree 2 in the place d in the box, |d_i| <= 1 (it proves nothing). By
    Taylor's theorem
   r(u(d)) is r_0 + ... + r_3 with r_0, r_1, r_2 at the middle, and r_3, a cubic form, somewhere in
   the box: from series in four directions. J, the derivatives of r by u, is that at the middle and
   its change, from series in sums of two directions. Let p >= |Y r| and N >= |1 - Y J| for |u -
   u(d)| <= e. If p + N e < e there is one root for each d (Krawczyk).
11. The inequalities of the word, by the same series to second order: each flight and stick lasts;
    at the end of a
   flight F on both sides of the belt says what follows; during a stick both forces hold it: they
   are monotone between the turns, where k v + B0 Omega sin theta = 0, so it is enough to look there
   and at its ends.
12. In a flight back to its belt the distance g has m (g'' + (c/m) g' + (k/m) g) = q = -side (k v +
    B0 Omega sin theta).
   Over a time less than pi/|Im l| no solution y of the equation with q = 0 has two zeros (Polya).
   So g > 0 where q < 0 between two times with g >= 0. Where q > 0, g >= y with the value and slope
   of g at one time: g > 0 after g = 0 <= g', before g = 0 >= g', and around a time as far as y > 0.
   Elsewhere, and at the other belt, by short steps.
13. "rest": a belt has the speed 0, and mu FN >= |B0|: the mass may rest on it, and no orbit has a
    flight.
14. The boxes are in the range and do not overlap; their part of its area is the share. With the
    open boxes they fill
   it. What is "found" is not proven; but no point of a border may be inside a box, where the word
   does not change.

The letters of the code are those above; e is an `BallOscillator`, q in `Flight.parts` is that of 12,
and Y is a matrix near the inverse of J. `data`, `source`, `limits` and `where` are those of
verify.py.
"""

import sys
from bisect import bisect_left, bisect_right, insort
from collections.abc import Callable
from functools import cached_property, partial
from importlib import import_module
from itertools import pairwise
from math import comb, inf
from typing import Any, NamedTuple

from flint import acb, acb_series, arb, arb_mat, arb_series, ctx, fmpq

try:
    base = import_module(".verify" if __package__ else "verify", __package__)
except ImportError as error:
    print(
        f"no certificate was read: verify.py has to be beside verify_orbits.py ({error})",
        file=sys.stderr,
    )
    sys.exit(2)
Stop = base.Stop
OPEN = base.OPEN
BAD = base.BAD
check = base.check
require = base.require
inside = base.inside
number = base.number
interval = base.interval
verify = base.verify
judge = base.judge
MODES = base.MODES

PIECES = (
    (1, 4, 1),
    (1, 1, 1),
    (1, 2, 1),
    (2, 5, 2),
    (2, 2, 2),
    (2, 3, 2),
    (2, 2, 1),
    (1, 2, 2),
)  # from, mode, to
LABELS = {piece: number for number, piece in enumerate(PIECES, 1)}
# What P1 to P8 are called beside the labels of another number of belts.
PAPER_LABELS = ("S1", "B1", "A1", "S2", "B2", "A2", "D21", "U12")
# Boxes within the one stated are smaller by about this factor; D is known well enough if its radii
# are less than KNOWN.
SMALL = fmpq(1, 10**15)
KNOWN = 1e-16
RANGE_END = "end of the range"
# Of a branch: terms of the curve c, parts of an interval, steps of Newton's method to c.
ORDER = 3
MOST_PARTS = 256
NEWTON_STEPS = 4
# w = 0 is not excluded unless it is so many times its radius.
NEARLY_0 = 32
# The first step along a motion is this part of it.
FIRST_PART = 8
# Of an atlas: bits, parts of a box, steps of Newton's method to the middle and where it has arrived,
# a change of an unknown from which it does not come back.
BOX_BITS = 64
MOST_BOX_PARTS = 1024
BOX_NEWTON_STEPS = 12
NEAR = 1e-14
MOST_CHANGE = 10
# Of Krawczyk's proof: tubes that are tried, and by how much the first one and each one is wider than
# what it has to contain.
MOST_TUBES = 4
FIRST_INFLATION = 1.1
INFLATION = 1.15
# Of the cuts of a flight: how many there may be; how much of the longest part is used (all of it is
# excluded); how many parts there are to it where q > 0; by what part of their distance they reach
# (half is enough to meet); shares of the duration are multiples of 1/SHARES.
MOST_CUTS = 16
USABLE = 0.95
PARTS_OF_LONGEST = 4
REACH = 0.52
SHARES = 512
MOST_TURNS = 1000
# The rim of a box in which a point of a border may be, as a part of the sides of the range.
RIM = 1e-12
# Directions in a box: both sides, and both diagonals.
SIDES = ((1, 0), (0, 1), (1, 1), (1, -1))


class StatedEvent(NamedTuple):
    """An event of a file: its kind, its belt, and the numbers of the modes before and after it."""

    kind: str
    belt: int
    source: int
    target: int


def end_of_branch(value, where):
    """Read an end of a branch: its kind, the parameter just inside and just outside, and what fails
    outside.
    """
    shape = {"kind": {RANGE_END}, "inside": number, "outside": number}
    if not (type(value) is dict and value.get("kind") == RANGE_END):
        shape |= POINTS | {"kind": str, "inequality": str, "at": number}
    return base.read(value, shape, where)


def part_of_multiplier(value, where):
    """Read an enclosure of the real or imaginary part of a multiplier; two zeros: it is exactly 0."""
    if value == ["0", "0"]:
        return number("0", where), number("0", where)
    return interval(value, where)


def border_points(value, where):
    """Read the points of all borders in an atlas, sorted by the first parameter.

    Ignore all else about borders.
    """
    try:
        points = [
            tuple(map(float, point))
            for border in value.get("borders", ())
            for point in border["points"]
        ]
    except (AttributeError, LookupError, TypeError, ValueError):
        points = [()]
    check(
        all(len(point) == 2 and abs(sum(point)) < 1e99 for point in points),
        f"{where}: the points of a border",
        BAD,
    )
    return sorted(points)


PARAMETERS = base.MOTION["parameters"]
POINTS = {"t": [interval], "x": [interval]}
BOX = ((number, number),) * 2
ORBIT = {"parameters": PARAMETERS, "word": str, "periods": int}
base.SHAPES["orbit"] = (
    ORBIT
    | {
        "events": [base.WHAT | {"t": interval, "x": interval, "reach": number}],
        "alone_within": (number, number),
    }
    | {
        "multipliers": ({"re": part_of_multiplier, "im": part_of_multiplier},) * 2,
        "stable": {True, False, None},
    }
)
base.LAW_SHAPES["orbit"] = lambda what: (
    base.SHAPES["orbit"]
    | {"parameters": base.LAW, "events": [what | base.ENCLOSED | {"reach": number}]}
)
base.SHAPES["branch"] = (
    ORBIT
    | {
        "parameter": set(base.NAMES),
        "range": (number, number),
        "stable": {True, None},
        "ends": (end_of_branch,) * 2,
    }
    | {"events": [base.WHAT], "boxes": [POINTS | {"value": (number, number)}]}
)
base.SHAPES["atlas"] = {
    "parameters": PARAMETERS,
    "over": (set(base.NAMES), set(base.NAMES)),
    "range": BOX,
    "share": number,
} | {
    "boxes": [{"word": str, "range": BOX, "phases": [number], "x": [number]}],
    "open": [BOX],
    "found": border_points,
}


# -- orbits ----------------------------------------------------------------------------------------


def label_between(before, after):
    """Return the label of what is between two events of a law, given their rows of the file: S, a
    stick; B or A, a flight back to a belt from below or above; U or D, one to the next belt.
    """
    belt = before["boundary"]
    other = after["boundary"]
    if before["target"] == f"belt{belt}":
        return f"S{belt}"
    if other == belt:
        letter = "B" if before["target"] == f"Omega{belt}" else "A"
        return f"{letter}{belt}"
    letter = "U" if other > belt else "D"
    return f"{letter}{belt}{other}"


def law_course(data):
    """Prove that the events of an orbit of a law follow each other and have its word; return them,
    and the corners between them.
    """
    rows = data["events"]
    if not rows:
        right = data["periods"] == 1 and data["word"] == "" and not any(data["alone_within"])
        check(right, "an orbit without events of one period, no word and no box", BAD)
        return []
    is_cycle = data["periods"] == data["parameters"]["B0"] == 0
    check(
        (is_cycle or 0 < data["periods"] < base.MOST_PERIODS) and len(rows) > 2,
        "a number of periods (0 without a drive), and three events at least",
        BAD,
    )
    steps = [base.what(row) for row in rows]
    events = [row for row in rows if row["kind"] != base.CORNER]
    first = "cross", "stick"
    check(not events or steps[0][0] in first, "a first event that is the end of a flight at a belt")
    check(steps[0] == steps[-1], "a last event that is not the first one again")
    if not events:  # an orbit that meets no belt has no word
        check(data["word"] == "", "the word of an orbit that meets no belt")
        return steps
    labels = [label_between(before, after) for before, after in pairwise(events)]
    # A word is read from the right, and may begin with any of its labels.
    word = data["word"]
    if len(data["parameters"]["belts"]) == 2:
        labels = [str(PAPER_LABELS.index(label) + 1) for label in labels if label in PAPER_LABELS]
        stated = list(word[1:])
        right = word[:1] == "P"
    else:
        stated = word.split("∘")
        right = True
    labels.reverse()
    right = right and any(stated == labels[i:] + labels[:i] for i in range(len(labels)))
    check(right, f"the word {word[:40]!r}, of events that say {' '.join(labels)[:40]}")
    return steps


def course(data):
    """Prove that an orbit's events follow each other and have its word; return them."""
    rows = data["events"]
    check(
        0 < data["periods"] < base.MOST_PERIODS and len(rows) > 2,
        "a number of periods, and three events at least",
        BAD,
    )
    events = []
    for row in rows:
        kind, belt, source, target = base.what(row)
        events.append(StatedEvent(kind, belt, MODES.index(source), MODES.index(target)))
    # The last event is the first one again, so that the last but one is before the first.
    for before, event in pairwise([events[-2], *events]):
        if event.source > 3:
            made = "slip"
        elif event.target > 3:
            made = "stick"
        else:
            made = "cross"
        modes_at_belt = {event.belt, event.belt + 1, event.belt + 3}
        near = event.source != event.target and {event.source, event.target} <= modes_at_belt
        follows = (event.kind, event.source) == (made, before.target)
        check(near and follows, "events that do not follow each other")
    check(events[0] == events[-1], "a last event that is not the first one again")
    labels = [
        LABELS.get((event.belt, event.target, after.belt)) for event, after in pairwise(events)
    ]
    # A word is read from the right, and may begin with any of its labels.
    word = data["word"]
    shown = "".join(map(str, reversed(labels)))
    right = word[:1] == "P" and len(word) == len(shown) + 1 and word[1:] in shown * 2
    check(right, f"the word {word[:40]!r}, of events that say {shown[:40]}")
    return events


def least(events, periods, apart):
    """Prove that no smaller number of forcing periods is a period of the orbit.

    `apart(i, n)` says whether t or x of event i surely differs from those of event 0, n forcing
    periods later.
    """
    n = len(events) - 1
    for q in range(2, periods + 1):
        # A period 1/q as long must have the same events again after 1/q of them.
        is_whole = periods % q == n % q == 0
        if is_whole and all(events[i] == events[(i + n // q) % n] for i in range(n)):
            shorter = periods // q
            check(
                apart(n // q, shorter),
                f"that the least period is {periods} forcing periods, not {shorter}",
                OPEN,
            )


def least_cycle(steps, points):
    """Prove that no part of an orbit without a drive is the whole orbit."""
    n = len(steps) - 1
    for q in range(2, n + 1):
        if n % q == 0 and all(steps[i] == steps[(i + n // q) % n] for i in range(n)):
            ((_, x), (_, x0)) = (points[n // q], points[0])
            check(not x.overlaps(x0), "that no part of the cycle is all of it", OPEN)


def eigenvalues(T, d):
    """Return real and imaginary parts of both eigenvalues of a matrix with trace T and determinant
    d, largest first.
    """
    # They are T/2 +- the root of `square`, imaginary where that is < 0.
    zero = arb(0)
    square = T * T / 4 - d
    if d.is_zero():
        return (T, zero), (zero, zero)
    if not abs(square) > 0:  # its sign is undecided
        root = abs(square).upper().sqrt()
        around = root.union(-root)
        return ((T / 2 + around, around),) * 2
    root = abs(square).sqrt()
    if square < 0:
        return (T / 2, root), (T / 2, -root)
    require(abs(T), "which multiplier is the larger one")
    if not (T > 0):
        root = -root
    return (T / 2 + root, zero), (T / 2 - root, zero)


#: A motion from a smaller set of starts than one already proven to have no events in between: this
#: is not proven again.
Within = type("Within", (base.VerifiedMotion,), {"positive": lambda motion, *until: None})


def orbit(data, source, limits):
    """Prove that the stated orbit exists with its multipliers, and is unique in its box.

    Return lines of text.
    """
    problem = base.StatedOscillator(data["parameters"], limits)
    periods = data["periods"]
    events = law_course(data) if "belts" in data["parameters"] else course(data)
    rows = data["events"]
    if not rows:
        return steady_orbit(problem, data, source)
    turn = None
    if periods:
        turn = 2 * periods * arb.pi() / arb(problem.p["Omega"])
    (within_t, within_x) = data["alone_within"]
    right = within_x > 0 <= min(row["reach"] for row in rows)
    right = right and (within_t > 0 if periods else within_t == 0)
    check(right, "alone_within, or reach out of range", BAD)
    D, points = fixed_point(problem, data, turn)
    for (t, x), row in zip(points, rows, strict=True):
        inside(t, row["t"])
        inside(x, row["x"])

    def apart(i, later):
        """Return whether t or x of event i surely differs from that of event 0, `later` forcing
        periods later.
        """
        # `turn` is the time of all `periods` forcing periods.
        (t, x) = points[i]
        (t0, x0) = points[0]
        return not ((t - t0) * periods).overlaps(later * turn) or not x.overlaps(x0)

    check_multipliers(data, D)
    kind = {True: "a stable orbit", False: "an unstable orbit", None: "an orbit"}[data["stable"]]
    (in_t, in_x) = source["alone_within"]
    if periods:
        least(events, periods, apart)
        time = f"of {periods} forcing period{'s' * (periods != 1)}"
        alone = f"the only one within {in_t} in t and {in_x} in x"
    else:
        least_cycle(events, points)
        time = "without a drive"
        alone = f"the only one within {in_x} in x"
    name = f" {data['word']}" if data["word"] else ", which meets no belt,"
    first = f"{kind}{name} {time}, {alone}"
    shown = multiplier_lines(source)
    return [first, base.about(source["parameters"]), *base.table(source["events"]), *shown]


def steady_orbit(problem, data, source):
    """Prove that the steady motion of a band is an orbit, with its multipliers; return lines of text."""
    p = problem.p
    law = problem.law
    check(
        p["B0"] != 0 < p["k"] and not law.edge_of(0), "a drive, a spring, and a band around v = 0"
    )
    band = problem.mode(law.band_of(0))
    c = law.bands[band.number].c
    pull = arb(p["k"] - p["m"] * p["Omega"] ** 2)
    drag = arb(c * p["Omega"])
    size = (pull * pull + drag * drag).sqrt()
    require(size, "that there is a steady motion")
    most = arb(abs(p["B0"]) * p["Omega"]) / size  # its largest speed
    for edge in band.ends:
        require(arb(abs(law.edges[edge].v)) - most, "that the steady motion stays in its band")
    turn = 2 * arb.pi() / arb(p["Omega"])
    D = (turn * arb_mat([[0, 1], [-p["k"] / p["m"], -c / p["m"]]])).exp()
    # 1 is no multiplier: no other motion of the band is periodic with the drive.
    apart = 1 - D[0, 0] - D[1, 1] + D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0]
    require(abs(apart), "that the orbit is the only one in its band")
    check_multipliers(data, D)
    kind = {True: "a stable orbit", False: "an unstable orbit", None: "an orbit"}[data["stable"]]
    first = f"{kind} of 1 forcing period, which meets no edge, the only such one in its band"
    return [first, base.about(source["parameters"]), *multiplier_lines(source)]


def multiplier_lines(source):
    """Return the multipliers of a file as lines of text."""
    return [
        f"multiplier: {' .. '.join(ends['re'])} + i ({' .. '.join(ends['im'])})"
        for ends in source["multipliers"]
    ]


def fixed_point(problem, data, turn):
    """Prove that exactly one orbit is in the box stated; return the derivatives D of the motion
    over a period, and t and x of the orbit at each event (1 above).
    """
    rows = data["events"]
    centre = [arb(sum(rows[0][name]) / 2) for name in "tx"]
    widths = [arb(width) for width in data["alone_within"]]
    stated_box = list(zip(centre, widths, strict=True))
    # The box stated, and one or two in it; `centre` and `widths` are those of the box at hand.
    for scale in (fmpq(1), SMALL, SMALL**2):
        # The events of all starts in the box, not only of the orbit, are within `reach` of it.
        wide = []
        for row in rows:
            reach = row["reach"] * scale
            low, high = row["t"]
            wide.append(row | {"t": (low - reach, high + reach)})
        # Motions from a box within the one stated have its events and no others.
        motion_kind = base.VerifiedMotion if scale == 1 else Within
        motions, u, D = base.period(problem, wide, centre, widths, turn, motion_kind)
        for shift, width, c, (middle, most) in zip(u, widths, centre, stated_box, strict=True):
            if turn is None and most == 0:  # any time will do
                continue
            require(width - abs(shift), "that an orbit is in the box, and only one")
            check(scale == 1 or abs(c - middle) + width < most, "a smaller box in the other", OPEN)
        are_known = all(entry.rad() < KNOWN for entry in D.entries())
        if scale < SMALL or (scale < 1 and are_known):
            break
        root = [c + shift for c, shift in zip(centre, u, strict=True)]
        centre = [coordinate.mid() for coordinate in root]
        widths = [(2 * coordinate.rad()).mid() for coordinate in root]
    # Where the fixed point is at each event, by the derivatives.
    factors = [
        shift / width if width > 0 else arb(0) for shift, width in zip(u, widths, strict=True)
    ]
    return D, [motion.from_centre(factors) for motion in motions]


def check_multipliers(data, D):
    """Raise Stop unless the eigenvalues of D and the stability are those that the file states (2
    above).
    """
    # After a stick the time of its end alone says what follows.
    sticks = any(row["kind"] == "stick" for row in data["events"])
    if data["periods"]:
        T = D[0, 0] + D[1, 1]
        d = D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0]
    else:
        d = arb(0) if sticks else D[1, 1]
        T = 1 + d  # of the multipliers 1 and d
    if sticks:
        d = arb(0)
    for (re, im), ends in zip(eigenvalues(T, d), data["multipliers"], strict=True):
        inside(re, ends["re"])
        inside(im, ends["im"])
    if data["stable"] is not None:
        margins = [1 - abs(d), 1 + d - abs(T)]
        if not data["periods"]:
            del margins[1]  # the multiplier 1 is that of the phase
        for margin in margins:
            require(abs(margin), "whether it is stable")
        stable = all(margin > 0 for margin in margins)
        check(data["stable"] is stable, "an orbit that is not as stable as it is said to be")


# -- the oscillator with parameters that vary ------------------------------------------------------


def column(values):
    """Return a vector as a matrix with one column."""
    return arb_mat(len(values), 1, values)


def horner(rows, at):
    """Return the values of several polynomials at `at`.

    Rows[i] is a column with the i-th coefficient of each.
    """
    total = rows[-1]
    for row in reversed(rows[:-1]):
        total = row + at * total
    return total


def coefficient(value, order=0):
    """Return a coefficient of a power series; a ball counts as a constant series."""
    if isinstance(value, arb_series):
        return value[order]
    if order:
        return arb(0)
    return value


def lifted(value):
    """Return a real ball or series as a complex one."""
    if isinstance(value, arb_series):
        return acb_series(value)
    return acb(value)


def times_i(value):
    """Return i times a real ball or series."""
    if isinstance(value, arb_series):
        return acb_series([acb(0, 1)]) * acb_series(value)
    return acb(0, value)


def real(value):
    """Return the real part of a complex ball or series."""
    if isinstance(value, acb_series):
        return arb_series([entry.real for entry in value], prec=value.prec)
    return value.real


def entire(b, z):
    """Return the hypergeometric function 0F1(b; z) of a ball or a power series z."""
    if isinstance(z, arb | acb):
        return z.hypgeom_0f1(b)
    # Taylor's series about the constant term; the derivative of 0F1(b; z) is 0F1(b + 1; z)/b.
    kind: Any = type(z)
    change = kind([0, *list(z)[1:]], prec=z.prec)
    total = kind([0], prec=z.prec)
    factor = kind([1], prec=z.prec)  # change^j / (b (b + 1) ... (b + j - 1) j!)
    for j in range(z.prec):
        total = total + factor * z[0].hypgeom_0f1(b + j)
        factor = factor * change / ((b + j) * (j + 1))
    return total


class Frequency(NamedTuple):
    """Whether w^2 = (c/(2m))^2 - k/m is > 0, the root w of |w^2|, and whether w may be 0 or
    nearly.
    """

    is_overdamped: bool
    w: Any
    is_nearly_0: bool


class Driven(NamedTuple):
    """The motions S and Z of 8 at a time, and their derivatives S1 and Z1."""

    S: Any
    S1: Any
    Z: Any
    Z1: Any


class BallOscillator:
    """The oscillator with balls or series as parameters.

    h = c/(2m), and A has the constant force in each domain; belts, jump and A begin at index 1.
    """

    def __init__(self, q):
        self.m, self.c, self.k, A0, self.B0, self.Om, *belts, mu1, mu2, FN = (
            q[name] for name in base.NAMES
        )
        self.A = [A0 + mu * FN for mu in (0, mu1 + mu2, mu2 - mu1, -mu1 - mu2)]
        self.belts = [None, *belts]
        self.jump = [None, *(2 * mu * FN / self.m for mu in (mu1, mu2))]
        self.h = self.c / (2 * self.m)
        self.km = self.k / self.m
        self.drive = self.B0 * self.Om / self.m
        self.square = self.h * self.h - self.km

    @cached_property
    def steady(self):
        """Return a and b of the steady motion, whose x is a cos(Omega t) + b sin(Omega t) and a
        constant.
        """
        pull = self.k - self.m * self.Om * self.Om
        drag = self.c * self.Om
        size = pull * pull + drag * drag
        return self.B0 * pull / size, self.B0 * drag / size

    @cached_property
    def frequency(self):
        """Return what the motion without drive does: `Frequency`."""
        is_overdamped = coefficient(self.square) > 0
        w = (self.square if is_overdamped else -self.square).sqrt()
        is_surely_not_0 = coefficient(w) > NEARLY_0 * coefficient(w).rad()
        return Frequency(is_overdamped, w, not is_surely_not_0)

    def free(self, s):
        """Return C and S at a time s: a motion without drive or friction is y(s) = y(0) C + (y'(0)
        + h y(0)) S.
        """
        decay = (-self.h * s).exp()
        if self.frequency.is_nearly_0:  # cosh(w s) and sinh(w s)/w without a division by w
            z = self.square * s * s / 4
            return decay * entire(arb(0.5), z), decay * s * entire(arb(1.5), z)
        ws = self.frequency.w * s
        if self.frequency.is_overdamped:
            up = ws.exp()
            down = (-ws).exp()
            sine = (up - down) / 2
            cosine = (up + down) / 2
        else:
            sine, cosine = ws.sin_cos()
        return decay * cosine, decay * sine / self.frequency.w

    @cached_property
    def roots(self):
        """Return the characteristic roots l and l', complex, of l^2 + (c/m) l + k/m."""
        root = lifted(self.square).sqrt()
        return root - lifted(self.h), -root - lifted(self.h)

    def driven(self, s):
        """Return S, S', Z, Z' at a time s: S is x after x = 0, v = 1.

        Z is x due to the drive exp(i Omega s).
        """
        (first_root, other) = self.roots
        s = lifted(s)
        drive = times_i(self.Om)

        def X(a, b):
            """Return (exp(a s) - exp(b s))/(a - b) at the time s of `driven`, also where a and b
            are close.
            """
            half = (a - b) * s / 2
            constant = half[0] if isinstance(half, acb_series) else half
            if abs(constant) > 1:  # the division loses nothing
                return ((a * s).exp() - (b * s).exp()) / (a - b)
            return s * ((a + b) * s / 2).exp() * entire(acb(1.5), half * half / 4)

        first = X(first_root, drive)
        second = X(other, drive)
        difference = first_root - other
        S = X(first_root, other)
        # The derivative of X(a, b) with respect to s is exp(a s) + b X(a, b), as X(a, b) = X(b, a),
        # and exp(b s) + a X(a, b): in Z1 the terms exp(i Omega s) of both cancel.
        S1 = (first_root * s).exp() + other * S
        Z = (first - second) / difference
        Z1 = (first_root * first - other * second) / difference
        return Driven(real(S), real(S1), Z, Z1)

    def longest_part(self):
        """Return a time that is surely shorter than half a period of the free motion."""
        most = (-coefficient(self.square)).upper()
        if most > 0:
            return (arb.pi() / most.sqrt()).lower()
        return arb.pos_inf()


class Inequality(NamedTuple):
    """A function f of time that must be > 0 on a piece of an orbit, and the `kind` of branch end at
    which f = 0.
    """

    text: str
    kind: str
    f: Callable[..., Any]
    order: int = 0  # of the first derivative of f that is not 0 at the start
    zero: bool = False  # whether f is 0 at the end
    during: bool = False  # whether f is > 0 all the time between them


def positive(margin, until, problem):
    """Prove that a margin's f > 0 between the times 0 and `until`, step by step with Taylor's
    theorem.
    """
    a = arb(0)
    step = until / FIRST_PART
    order = margin.order
    while True:
        problem.step()
        is_last = not a + step < until
        if is_last:
            b = until
        else:
            b = (a + step).mid()
        middle = ((a + b) / 2).mid()
        h = ((b - a) / 2).upper()
        f, slope, _ = margin.f(middle)
        _, _, bend = margin.f(a.union(b))  # f'' from a to b
        slopes = slope + bend * arb(0, 1) * h  # f' from a to b
        if is_last and margin.zero:
            sure = slopes < 0 and not order
        else:
            check(not f < 0, margin.text)
            sure = f - abs(slope) * h - abs(bend) * h * h / 2 > 0
            sure = sure or (slopes > 0 and (order or a > 0))  # f was > 0 at a, or 0 at the start
            sure = sure or (order and bend > 0)  # f' >= 0 at the start, by the forces there
        if sure and is_last:
            return
        if sure:  # a longer step next
            a = b
            order = 0  # f > 0 where the next step starts
            step = step * 3 / 2
        else:
            step = h
        check(step > until * arb(2) ** -ctx.prec, margin.text, OPEN)


def in_parts(prove, whole, most, what):
    """Call `prove` for the box `whole` or, where it fails, for halves, at most `most` times.

    Return the last result.
    """
    parts = [whole]
    count = 0
    result = None
    while parts:
        part = parts.pop()
        count = count + 1
        try:
            result = prove(part)
        except (Stop, ZeroDivisionError, ValueError) as stop:
            # The latter two: a ball or a series may be 0.
            check(not isinstance(stop, Stop) or stop.args[0] == OPEN, str(stop.args[-1]))
            check(count < most, what)
            # Halve the side that is the largest share of the whole one.
            shares = [
                (high - low) / (b - a) for (low, high), (a, b) in zip(part, whole, strict=True)
            ]
            i = shares.index(max(shares))
            low, high = part[i]
            middle = (low + high) / 2
            for side in ((middle, high), (low, middle)):
                parts.append((*part[:i], side, *part[i + 1 :]))
    return result


# -- branches --------------------------------------------------------------------------------------


class CheckedPiece:
    """The motion in one mode that starts on a belt at t and x, and the functions f that are > 0
    while it lasts.
    """

    def __init__(self, e, mode, belt, t, x, late):
        self.e = e
        self.mode = mode
        self.t = t
        self.x = x
        self.v = e.belts[belt]
        # `force` uses x and v, which are those of the start until here.
        if mode < 4:
            self.a, _, _ = self.force(mode, 0, t)
        else:
            self.a = arb(0)
        # A start that is later by `late` is one at t with another x and v.
        self.x = x - self.v * late
        self.v = self.v - self.a * late
        # By the domain or belt where the mode ends: the sign of F or of v less the belt's speed.
        if mode > 3:
            self.ends = {belt: 1, belt + 1: -1}
        else:
            self.ends = {i: 1 if mode > i else -1 for i in (1, 2) if mode - i in (0, 1)}
            # y = x less the steady motion, and its derivatives at the start
            (a, b) = e.steady
            sine, cosine = (e.Om * t).sin_cos()
            self.y = self.x - e.A[mode] / e.k - a * cosine - b * sine
            force, _, _ = self.force(mode, 0, t)
            self.dy = self.v - e.Om * (b * cosine - a * sine)
            self.ddy = force + e.Om * e.Om * (a * cosine + b * sine)

    def at(self, s, t):
        """Return x, v, v' and v'' of a flight at the time t, which is a time s after its start."""
        (a, b) = self.e.steady
        (C, S) = self.e.free(s)
        e = self.e
        sine, cosine = (e.Om * t).sin_cos()
        # The steady motion less its constant, and its velocity.
        steady_x = a * cosine + b * sine
        steady_v = e.Om * (b * cosine - a * sine)
        square = e.Om * e.Om
        # dy solves the same equation as y, which says the third derivative of y too.
        y = C * self.y + S * (self.dy + e.h * self.y)
        dy = C * self.dy + S * (self.ddy + e.h * self.dy)
        ddy = C * self.ddy - S * (e.km * self.dy + e.h * self.ddy)
        x = e.A[self.mode] / e.k + steady_x + y
        jerk = -2 * e.h * ddy - e.km * dy - square * steady_v
        return x, steady_v + dy, ddy - square * steady_x, jerk

    def force(self, domain, s, t):
        """Return F, F' and F'' at the time t, a time s after the start.

        F is a domain's force per mass at the belt.
        """
        (sine, cosine) = (self.e.Om * t).sin_cos()
        e = self.e
        F = (e.A[domain] + e.B0 * cosine - e.k * (self.x + self.v * s) - e.c * self.v) / e.m
        return F, -e.drive * sine - e.km * self.v, -e.drive * e.Om * cosine

    def f(self, end, s):
        """Return f, f' and f'' a time s after the start, for an `end` of the mode: the mode ends
        there where f = 0.
        """
        if self.mode > 3:
            derivatives = self.force(end, s, self.t + s)
        else:
            _, v, slope, bend = self.at(s, self.t + s)
            derivatives = v - self.e.belts[end], slope, bend
        return [self.ends[end] * derivative for derivative in derivatives]


class ClosingEvents:
    """The equations r(u) = 0 that an orbit with given events solves, and the inequalities that a
    root must satisfy.
    """

    def __init__(self, events, periods, e):
        self.events = events
        self.e = e
        self.count = len(events) - 1
        self.forcing = 2 * arb.pi() / e.Om
        self.turn = periods * self.forcing

    def piece(self, i, u, late=0):
        """Return the motion from event i, begun `late` later, its duration, and when it ends, from
        the unknowns u = (t_0, x_0, t_1, ...).
        """
        t = u[2 * i]
        x = u[2 * i + 1]
        if i + 1 < self.count:
            until = u[2 * i + 2]
        else:
            until = u[0] + self.turn
        event = self.events[i]
        piece = CheckedPiece(self.e, event.target, event.belt, t, x, late)
        return piece, until - t, until

    def residual(self, i, u, late=0):
        """Return two residuals of the motion from event i (begun `late` later): of x, and of v or,
        after a stick, F.
        """
        (piece, s, until) = self.piece(i, u, late)
        event = self.events[i + 1]
        next_x = u[(2 * i + 3) % len(u)]
        if piece.mode > 3:
            x = piece.x + piece.v * s
            F, _, _ = piece.force(event.target, s, until)
            return x - next_x, F
        x, v, _, _ = piece.at(s, until)
        return x - next_x, v - self.e.belts[event.belt]

    def r(self, u):
        """Return the residuals of all pieces at the unknowns u = (t_0, x_0, t_1, ...).

        They are 0 on an orbit.
        """
        return [residual for i in range(self.count) for residual in self.residual(i, u)]

    def jacobian(self, u):
        """Return the derivatives of r with respect to u, as the first coefficients of power series."""
        J = arb_mat(len(u), len(u))
        for i in range(self.count):
            # The residuals of a piece depend on t and x at both its ends alone.
            for j in (j % len(u) for j in range(2 * i, 2 * i + 4)):
                if j == 2 * i:  # t at its start: `late` moves x and v instead, and keeps t a ball
                    residuals = self.residual(i, u, arb_series([0, 1], prec=2))
                else:
                    moved = [*u[:j], arb_series([u[j], 1], prec=2), *u[j + 1 :]]
                    residuals = self.residual(i, moved)
                J[2 * i, j], J[2 * i + 1, j] = (coefficient(value, 1) for value in residuals)
        return J

    def margins(self, i, u):
        """Return the margins after event i: functions that must be > 0 at the event, or from it to
        the next one.
        """
        (piece, s, _) = self.piece(i, u)
        event, after = self.events[i : i + 2]
        # The last event is the first one again: before event 0 comes the last but one.
        before = self.events[i - 1] if i else self.events[-2]
        previous = f"P{LABELS[before.belt, before.target, event.belt]}"
        label = f"P{LABELS[event.belt, event.target, after.belt]}"
        if event.target > 3:
            kind = "vanishing of a stick"
        elif event.source > 3:
            kind = "vanishing of a slip"
        else:
            kind = "vanishing of a flight"
        lasts = Inequality(f"{label} lasts", kind, lambda _: (s, arb(0), arb(0)))
        margins = [lasts, *self.forces_at(piece, event, previous)]
        for end, side in piece.ends.items():
            f = partial(piece.f, end)
            if event.target > 3:
                text = f"F^({end}) {'<>'[side > 0]} 0 during {label}"
                is_end = end == after.target
                margins.append(Inequality(text, "birth of a slip", f, zero=is_end, during=True))
                continue
            # On the belt where the flight starts f = 0 and, after a stick, f' = 0 too: `order` is
            # that of the first derivative that is not 0.
            if end != event.belt:
                order = 0
            elif event.source > 3:
                order = 2
            else:
                order = 1
            # How it may fail: later on; at once, as the slip leaves to the wrong side; or as a
            # consequence of another failure.
            first = f(arb(0))[order]
            if first > 0:
                kind = "grazing"
            elif order == 2 and first < 0:
                kind = "vanishing of a slip"
            else:
                kind = ""
            text = f"v {'<>'[side > 0]} v{end} during {label}"
            margins.append(Inequality(text, kind, f, order, zero=end == after.belt, during=True))
        return margins

    def forces_at(self, piece, event, previous):
        """Return the inequalities of F on both sides of the belt at an event, which say what
        follows; `previous` is the label that ends there.
        """
        if event.kind == "slip":  # F = 0 at the end of a stick
            return []
        if event.kind == "stick":
            signs = (1, -1)
        elif event.target > event.source:
            signs = (1, 1)
        else:
            signs = (-1, -1)
        margins = []
        for domain, sign in zip((event.belt, event.belt + 1), signs, strict=True):
            F, _, _ = piece.force(domain, 0, piece.t)
            forces = sign * F, arb(0), arb(0)  # f, f', f'': it is at one time
            text = f"F^({domain}) {'<>'[sign > 0]} 0 where {previous} ends"
            is_behind = domain != event.source and coefficient(self.e.jump[event.belt]) > 0
            if not is_behind:
                kind = "grazing"
            elif event.target > 3:
                kind = "birth of a slip"
            else:
                kind = "birth of a stick"
            margins.append(Inequality(text, kind, lambda _, forces=forces: forces))
        return margins

    def prove(self, u, stable, problem):
        """Prove all margins for all unknowns in u and, if `stable`, that the multipliers are inside
        the unit circle.
        """
        # The derivatives of t and x after a period by those at its start, and their determinant d.
        period = arb_mat([[1, 0], [0, 1]])
        d = arb(1)
        J = self.jacobian(u)
        for i in range(self.count):
            piece, s, until = self.piece(i, u)
            for margin in self.margins(i, u):
                positive(margin, s.upper(), problem)
            # J has the derivatives of this piece's residuals by t and x at its start and its end.
            rows = [[J[j, (2 * i + k) % len(u)] for k in range(4)] for j in (2 * i, 2 * i + 1)]
            by_start = arb_mat([row[:2] for row in rows])
            by_end = arb_mat([row[2:] for row in rows])
            # Liouville: the flow contracts (x, v) by exp(-c s/m); dv = v' dt on a belt at both ends.
            if piece.mode > 3:
                slope_at_end = 1
            else:
                _, _, slope_at_end, _ = piece.at(s, until)
            d *= (-2 * self.e.h * s).exp() * piece.a / slope_at_end
            period = -by_end.solve(by_start) * period
        if stable:
            for margin in (1 - abs(d), 1 + d - abs(period.trace())):
                require(margin, "stable")


class OrbitFamily:
    """A family of orbits, one for each parameter value from `low` to `high`, proven by interval
    Newton.

    The unknowns of each are the only root of the equations r(u) = 0 in the box that a row of the
    file states.
    """

    def __init__(self, problem, data, events, row, low, high):
        problem.step((2 * len(events)) ** 3 // 256)  # the work, and by it the size, of the matrices
        check(len(row["t"]) == len(row["x"]) == len(events), "t and x at each event", BAD)
        ends = [pair for both in zip(row["t"], row["x"], strict=True) for pair in both]
        p = problem.p
        fixed = {name: arb(p[name]) for name in base.NAMES}
        parameter = data["parameter"]
        periods = data["periods"]
        self.course = lambda value: ClosingEvents(
            events, periods, BallOscillator(fixed | {parameter: value})
        )
        self.box = [arb(a).union(arb(b)) for a, b in ends[:-2]]  # the last event is the first again
        self.middle = arb((low + high) / 2)
        every = arb(low).union(arb(high))
        thin = self.course(self.middle)
        self.all = self.course(every)
        change = every - self.middle
        c = column(self.box).mid()
        for _ in range(NEWTON_STEPS):  # it finds c and proves nothing
            self.Y = thin.jacobian(c.entries()).mid().inv().mid()
            c = (c - self.Y * column(thin.r(c.entries()))).mid()
        # The next coefficient of the curve cancels that of r(curve): Y r changes by it.
        curve = [c]
        for order in range(1, ORDER):
            uncancelled = self.coefficients(self.middle, [*curve, 0 * c], order + 1)[-1]
            curve.append(-(self.Y * uncancelled).mid())
        self.YJ = self.Y * self.all.jacobian(self.box)
        # The curve about any value of the parameter, for Taylor's remainder r_n (5 above).
        moved = [[comb(k, j) * curve[k] for k in range(j, ORDER)] for j in range(ORDER)]
        about_every = [horner(rows, change) for rows in moved]
        remainder = self.coefficients(every, about_every, ORDER + 1)[-1]
        r = horner([*self.coefficients(self.middle, curve, ORDER), remainder], change)
        self.points = self.newton(horner(curve, change), r)
        self.curve = curve
        self.within(row, self.points, self.all)

    def coefficients(self, value, curve, count):
        """Return the first `count` Taylor coefficients of the residuals r along a curve of
        unknowns, about `value`.
        """
        ctx.cap = max(ctx.cap, count)  # else flint cuts series of constants off
        by_unknown = zip(*(vector.entries() for vector in curve), strict=True)
        u = [arb_series(list(orders), prec=count) for orders in by_unknown]
        r = self.course(arb_series([value, 1], prec=count)).r(u)
        return [column([residual[order] for residual in r]) for order in range(count)]

    def newton(self, c, r):
        """Prove that `c` is in the box stated.

        Return c - J^-1 r (r: the residuals there), which contains the root.
        """
        for value, side in zip(c.entries(), self.box, strict=True):
            require(arb(side.rad()) - abs(value - side.mid()), "a curve in the box")
        return (c - self.YJ.solve(self.Y * r)).entries()

    def root(self, value):
        """Return an enclosure of the root at one value of the parameter, and the equations
        (`ClosingEvents`) there.
        """
        c = horner(self.curve, arb(value) - self.middle).mid()
        course = self.course(arb(value))
        return self.newton(c, column(course.r(c.entries()))), course

    def within(self, row, u, course):
        """Prove that t and x of all events, from the unknowns u, lie within those stated in a row
        of the file.
        """
        for name, values in (("t", [*u[::2], u[0] + course.turn]), ("x", [*u[1::2], u[1]])):
            for value, ends in zip(values, row[name], strict=True):
                inside(value, ends)

    def apart(self, i, later):
        """Return whether t or x of event i surely differs from that of event 0, `later` forcing
        periods later.
        """
        (t, x) = self.points[2 * i : 2 * i + 2]
        (t0, x0) = self.points[:2]
        return not (t - t0).overlaps(later * self.all.forcing) or not x.overlaps(x0)


def family(problem, data, events, row, part):
    """Prove the orbits of a row of a branch for all parameter values in a part of the row's range.

    Return the OrbitFamily. `part` has one side, as `in_parts` wants it.
    """
    ((low, high),) = part
    orbits = OrbitFamily(problem, data, events, row, low, high)
    orbits.all.prove(orbits.points, data["stable"], problem)
    return orbits


def fails(problem, data, events, end, row):
    """Prove that the inequality which an end of a branch names fails just outside of the branch."""
    found = OrbitFamily(problem, data, events, end, *sorted((end["inside"], end["outside"])))
    found.within(row, *found.root(end["inside"]))
    (u, course) = found.root(end["outside"])
    at = arb(end["at"])
    kind = end["kind"]
    for i in range(course.count):
        after = at - u[2 * i]
        _, s, _ = course.piece(i, u)
        for margin in course.margins(i, u):
            if margin.text != end["inequality"]:
                continue
            is_in_time = not margin.during or 0 < after < s
            if margin.f(after)[0] < 0 and is_in_time:
                check(
                    margin.kind == kind,
                    f"an end that is a {kind[:40]!r}, and not a {margin.kind or 'consequence'}",
                )
                return
    raise Stop(base.FALSE, f"that {end['inequality'][:60]!r} fails at the outer value of the end")


def branch(data, source, limits):
    """Prove a branch: every row, that the rows join, and both ends.

    Return what is proven, as lines of text.
    """
    name = data["parameter"]
    rows = data["boxes"]
    span = data["range"]
    periods = data["periods"]
    values = [row["value"] for row in rows]
    events = course(data)
    tried = list[Any]()
    right = (
        values
        and span == [values[0][0], values[-1][1]]
        and all(a[1] == b[0] for a, b in pairwise(values))
    )
    check(right, "rows that follow each other from one end of the range to the other")
    check(
        all(low < high for low, high in values),
        "intervals from a lower to an upper value of a parameter",
        BAD,
    )
    for value in [*span, *(end["outside"] for end in data["ends"])]:
        problem = base.StatedOscillator(data["parameters"] | {name: value}, limits)
    for row in rows:
        if tried:
            tried[-1].within(row, *tried[-1].root(row["value"][0]))
        box = (row["value"],)
        what = "for all values from {} to {}".format(*row["value"])
        tried.append(in_parts(partial(family, problem, data, events, row), box, MOST_PARTS, what))
    least(events, periods, lambda *shift: any(orbits.apart(*shift) for orbits in tried))
    first = (
        f"an orbit {data['word']} for every {name} from {source['range'][0]} to "
        f"{source['range'][1]}"
    )
    first += f", by {len(rows)} intervals"
    first += "".join(proven_ends(problem, data, source, events))
    if data["stable"]:
        stable = "stable for every value"
    else:
        stable = "nothing is said of its stability"
    whole = f"{periods} forcing period{'s' * (periods != 1)}"
    about = base.about(source["parameters"] | {name: "(varies)"}, whole, stable)
    note = [
        f"that {end['inequality']} is the first to fail is not proven"
        for end in data["ends"]
        if "at" in end
    ]
    shown = [
        f"{row['value'][0]} <= {name} <= {row['value'][1]}: {pairs(row)}" for row in source["boxes"]
    ]
    return [first, about, *note, *base.table(source["events"]), *shown]


def proven_ends(problem, data, source, events):
    """Prove both ends of a branch, and yield a text about each one that is not an end of the
    range.
    """
    rows = data["boxes"]
    sides = data["ends"], (rows[0], rows[-1]), data["range"], (-1, 1), source["ends"]
    for end, row, inner, side, shown in zip(*sides, strict=True):
        beyond = side * (end["outside"] - end["inside"])
        is_of_range = end["kind"] == RANGE_END
        right = end["inside"] == inner and beyond >= 0 and (beyond == 0) == is_of_range
        check(right, "an end of the range, or one outside of it")
        if beyond:
            fails(problem, data, events, end, row)
            low, high = (shown["inside"], shown["outside"])[::side]
            yield f"; {end['kind']} between {low} and {high}: {end['inequality']}"


def pairs(row):
    """Return the lower and upper ends of t and x of all events in a row of a branch, as text."""
    return "; ".join(
        f"{low} < {name}{i} < {high}"
        for i, both in enumerate(zip(row["t"], row["x"], strict=True), 1)
        for name, (low, high) in zip("tx", both, strict=True)
    )


# -- atlases ---------------------------------------------------------------------------------------


class Flight:
    """A flight of a word: mode, belts at its start and end, whether it follows a stick, and what
    comes after it.

    If a stick follows, `stick` is the domain into which the mass slips after it; otherwise `stick`
    is 0.
    """

    def __init__(self, piece, at, slips, stick):
        (self.belt, self.mode, self.onto) = piece
        # The indices in the unknowns of its phase and of its duration; x is between them, unless
        # the flight `slips`, that is follows a stick.
        self.at = at
        self.tau = at + 2 - slips
        self.slips = slips
        self.stick = stick
        if self.mode > self.onto:
            self.side = 1
        else:
            self.side = -1

    def start(self, e, u):
        """Return x at the start of the flight: one of the unknowns u or, after a stick, the x where
        the force is 0.
        """
        if not self.slips:
            return u[self.at + 1]
        return (e.A[self.mode] + e.B0 * u[self.at].cos() - e.c * e.belts[self.belt]) / e.k

    def after(self, e, u, s):
        """Return x, v and v' of a flight of the oscillator `e`, a time s after its start, from the
        unknowns u.
        """
        A = e.A[self.mode]
        phase = u[self.at]
        start_v = e.belts[self.belt]
        from_centre = self.start(e, u) - A / e.k
        (S, S1, Z, Z1) = e.driven(s)
        drive = times_i(phase).exp() * lifted(e.B0 / e.m)
        x = A / e.k + from_centre * (S1 + 2 * e.h * S) + start_v * S + real(drive * Z)
        v = start_v * S1 - e.km * S * from_centre + real(drive * Z1)
        return x, v, (A + e.B0 * (phase + e.Om * s).cos() - e.k * x - e.c * v) / e.m

    def end(self, e, u):
        """Return the phase at the end of a flight of the oscillator `e`, from the unknowns u of the
        orbit.
        """
        return u[self.at] + e.Om * u[self.tau]

    def parts(self, e, u):
        """Return the parts of a flight back to its belt between the zeros of q (12 above); None if
        the zeros or the signs of q are undecided.
        """
        phase = u[self.at]
        end = self.end(e, u)
        parts = []
        turns = [turning(e, self.belt, n) for n in between(e, self.belt, phase, end)]
        if not all(phase < turn < end for turn in turns):
            return None
        times = [arb(0), *((turn - phase) / e.Om for turn in turns), u[self.tau]]
        for (a, b), ends in zip(pairwise([phase, *turns, end]), pairwise(times), strict=True):
            # q has one sign between two zeros: its value in the middle shows it.
            middle = ((a + b) / 2).mid()
            q = -self.side * (e.k * e.belts[self.belt] + e.B0 * e.Om * middle.sin())
            if not (a < middle < b and abs(q) > 0):
                return None
            parts.append(PartOfFlight(q > 0, *ends))
        return parts

    def stays_off(self, e, u, cuts):
        """Return whether a flight back to its belt surely stays off it until its end, if all margins
        at the `cuts` are > 0 (12 above).
        """
        parts = self.parts(e, u)
        longest = e.longest_part()
        unused = [(u[self.tau] * share, reach) for share, reach in cuts]
        if parts is None:
            return False
        for i, part in enumerate(parts):
            inside_part = [(time, reach) for time, reach in unused if time < part.end]
            unused = [(time, reach) for time, reach in unused if not time < part.end]
            times = [time for time, _ in inside_part]
            if not all(part.begin < time for time in times):
                return False
            if not part.rises:
                # q < 0: g > 0 between two points of it that are near enough (Polya).
                spans = [later - time for time, later in pairwise([part.begin, *times, part.end])]
                if not all(0 < span < longest for span in spans):
                    return False
                continue
            # q > 0: g > 0 up to `until`, by its start with g = 0 and by the reach of each cut ...
            if i == 0:
                until = part.begin + longest
            else:
                until = part.begin
            for time, reach in inside_part:
                if not (time - reach < until and 2 * reach < longest):
                    return False
                until = time + reach
            # ... and for some time before its end with g = 0.
            needed = part.end - longest if i + 1 == len(parts) else part.end
            if not until > needed:
                return False
        return not unused


class PartOfFlight(NamedTuple):
    """A part of a flight between two zeros of q: whether q > 0, and the times of its ends."""

    rises: bool
    begin: Any
    end: Any


def turning(e, belt, n):
    """Return the n-th phase at which the forces on a belt of the oscillator `e` begin to fall or to
    rise.
    """
    return n * arb.pi() + (-1) ** (n % 2) * (-e.k * e.belts[belt] / (e.B0 * e.Om)).asin()


def between(e, belt, low, high):
    """Return the numbers n of all turns of a belt's forces (`turning`) that may lie between two
    phases.
    """
    bias = abs(e.k * e.belts[belt])
    swing = abs(e.B0 * e.Om)
    if bias > swing:
        return []
    require(swing - bias, "whether the forces on a belt turn")
    first = (low / arb.pi()).lower().floor() - 1
    last = (high / arb.pi()).upper().ceil() + 1
    check(last - first < MOST_TURNS, "few turns in a piece", OPEN)
    numbers = range(int(float(first)), int(float(last)) + 1)
    turns = [(n, turning(e, belt, n)) for n in numbers]
    return [n for n, phase in turns if not phase < low and not phase > high]


def marks(parts, longest):
    """Return the cuts of a flight with these `parts`: the shares of its duration at which to show
    that it is off its belt, and the reach of each.

    `longest` is the `longest_part` of the oscillator.
    """
    usable = USABLE * float(longest)
    tau = float(parts[-1].end)
    cuts = []
    # Reaches must overlap although shares are rounded below and parts end at balls of times.
    spare = 2 * max(float(part.end.rad()) for part in parts) + tau / 500
    for i, part in enumerate(parts):
        a = float(part.begin)
        b = float(part.end)
        if part.rises:
            # Near the start and the end of the flight g = 0 there shows that g > 0.
            a = a + usable * (i == 0)
            b = b - usable * (i + 1 == len(parts))
            if a < b:
                count = int(PARTS_OF_LONGEST * (b - a) / usable) + 1
            else:
                count = 0
        else:
            count = int((b - a) / usable)
        count = min(count, MOST_CUTS + 1)  # else there are too many
        if part.rises:  # in the middle of equal spans, each reaching over its own
            step = (b - a) / max(count, 1)
            cuts += [(a + (j + 0.5) * step, REACH * step + spare) for j in range(count)]
        else:  # between equal spans
            step = (b - a) / (count + 1)
            cuts += [(a + (j + 1) * step, 0.0) for j in range(count)]
    return [(round(time / tau * SHARES) / SHARES, reach) for time, reach in cuts]


class WordChecks(NamedTuple):
    """Where the margins of a word are evaluated: the turns of the forces in the stick after each
    flight, and the cuts of each flight (None: short steps instead).
    """

    turns: Any
    cuts: Any


def pieces_of_word(text):
    """Return the pieces (from, mode, to) of a word in order of time, a flight first; raise Stop if
    they cannot follow each other.
    """
    digits = text[1:]
    what = f"the word {text[:40]!r}"
    is_word = text[:1] == "P" and 0 < len(digits) <= 200 and set(digits) <= set("12345678")
    check(is_word, what, BAD)
    pieces = [PIECES[int(digit) - 1] for digit in reversed(digits)]
    check(any(mode < 4 for _, mode, _ in pieces), f"{what}, which has no flight", BAD)
    while pieces[0][1] > 3:
        pieces = pieces[1:] + pieces[:1]
    for (_, mode, end), (start, after, _) in zip(pieces, pieces[1:] + pieces[:1], strict=True):
        modes_at_belt = {start, start + 1, start + 3}
        near = {mode, after} <= modes_at_belt and mode != after
        check(end == start and near, f"{what}, whose maps do not follow each other", BAD)
    return pieces


class LabelCycle:
    """A word: its flights, and the equations r(u) = 0 for the unknowns u of its orbit (phases, x,
    durations).
    """

    def __init__(self, text, mirror):
        pieces = pieces_of_word(text)
        self.text = text
        self.count = len(pieces)
        half = len(pieces) // 2
        modes = [mode for _, mode, _ in pieces]
        # If the second half is the mirror image of the first, only the first is followed.
        self.half = (
            len(modes) % 2 == 0 and [mirror.get(mode) for mode in modes[:half]] == modes[half:]
        )
        self.alone = mirror.get(1) != 3  # one belt is at rest, and v = 0 divides the modes
        self.flights = []
        self.rows = []  # of each flight: the number of its piece
        self.size = 0  # how many unknowns there are
        for i in range(half if self.half else self.count):
            if modes[i] < 4:
                slips = modes[i - 1] > 3
                if modes[(i + 1) % self.count] > 3:
                    stick = modes[(i + 2) % self.count]
                else:
                    stick = 0
                self.flights.append(Flight(pieces[i], self.size, slips, stick))
                self.rows.append(i)
                self.size += 3 - slips

    def unknowns(self, row, Om):
        """Return approximate unknowns u from the phases and positions in a row of the file."""
        check(
            len(row["phases"]) == len(row["x"]) == self.count, "a phase and an x at each event", BAD
        )
        phases = [float(arb(phase)) for phase in row["phases"]]
        phases.append(phases[0] + 2 * float(arb.pi()))
        u = []
        for flight, i in zip(self.flights, self.rows, strict=True):
            u.append(phases[i])
            if not flight.slips:
                u.append(float(arb(row["x"][i])))
            u.append((phases[i + 1] - phases[i]) / Om)
        return [arb(unknown) for unknown in u]

    def next(self, e, i, u):
        """Return phase and x at the start of the flight after flight i, for the oscillator `e` and
        the unknowns u.
        """
        if i + 1 < len(self.flights):
            return u[self.flights[i + 1].at], self.flights[i + 1].start(e, u)
        # The first flight again, a period later, or its image about A0/k = (A1 + A3)/(2 k).
        x = self.flights[0].start(e, u)
        if self.half:
            return (u[0] + arb.pi(), (e.A[1] + e.A[3]) / e.k - x)
        return (u[0] + 2 * arb.pi(), x)

    def r(self, e, u, plan=None):
        """Return the residuals r of oscillator `e` at unknowns u and, with a `plan` of turns and
        cuts, the margins (11 above).

        This sets `looks`: by the number of a margin at a cut, the number of its flight.
        """
        residuals = []
        margins = []
        self.looks = {}
        for i, flight in enumerate(self.flights):
            s = u[flight.tau]
            (next_phase, next_x) = self.next(e, i, u)
            speed = e.belts[flight.onto]
            end = flight.end(e, u)
            x, v, F = flight.after(e, u, s)
            if not flight.stick:
                residuals += [v - speed, x - next_x, end - next_phase]
            else:
                residuals += [v - speed, x + speed * ((next_phase - end) / e.Om) - next_x]
            if plan is None:
                continue
            meets = -flight.side * F
            jump = e.jump[flight.onto]
            margins += [s, meets, jump - meets if flight.stick else meets - jump]
            if flight.stick:
                margins += self.stick_margins(e, flight, end, next_phase, plan.turns[i])
            for share, reach in plan.cuts[i] or ():
                _, v_at_cut, slope = flight.after(e, u, s * share)
                # The solution y with q = 0 of 12, at both ends of its reach, or g itself.
                for later in (reach, -reach) if reach else (0.0,):
                    S, S1, _, _ = e.driven(arb(later))
                    self.looks[len(margins)] = i
                    y = (v_at_cut - speed) * (S1 + 2 * e.h * S) + slope * S
                    margins.append(flight.side * y)
        return residuals, margins

    def stick_margins(self, e, flight, begin, end, turns):
        """Return the margins of the stick after a flight, between the phases `begin` and `end`: it
        lasts, the force that ends it falls there, and both forces hold at the `turns`.
        """
        if flight.stick == flight.onto:
            sign = 1
        else:
            sign = -1
        v = e.belts[flight.onto]
        jump = e.jump[flight.onto]
        margins = [(end - begin) / e.Om, sign * (e.k * v + e.B0 * e.Om * end.sin())]
        for n in turns:
            turn = turning(e, flight.onto, n)
            # The force is 0 at the end of the stick: its value at a turn is its change from there.
            force = sign * (e.B0 * (turn.cos() - end.cos()) + e.k * v * (end - turn) / e.Om) / e.m
            margins += [force, jump - force]
        return margins

    def plan(self, e, u):
        """Return, for the unknowns `u`, the turns of the forces in each stick and each flight's
        cuts or None.
        """
        turns = list[Any]()
        cuts = list[Any]()
        for i, flight in enumerate(self.flights):
            next_phase, _ = self.next(e, i, u)
            if flight.stick:
                turns.append(between(e, flight.onto, flight.end(e, u), next_phase))
            else:
                turns.append([])
            parts = None
            if flight.belt == flight.onto:
                parts = flight.parts(e, u)
            cuts_of_flight = None
            if parts is not None:
                cuts_of_flight = marks(parts, e.longest_part())
                if len(cuts_of_flight) > MOST_CUTS:
                    cuts_of_flight = None
            cuts.append(cuts_of_flight)
        return WordChecks(turns, cuts)

    def stays(self, e, u, plan, problem):
        """Prove that no flight meets a belt before its end, for all unknowns in u, if all margins
        are > 0.
        """
        for flight, cuts in zip(self.flights, plan.cuts, strict=True):
            near = {flight.mode - 1, flight.mode} & {1, 2}
            sides = {belt: (1 if flight.mode > belt else -1, e.belts[belt]) for belt in near}
            # The mirror image, with -v, is then between both belts.
            if self.half and self.alone and flight.mode != 2:
                if flight.mode == 1:
                    other = 2
                else:
                    other = 1
                sides[other] = -flight.side, -e.belts[other]
            for belt, (side, speed) in sides.items():
                returns = belt == flight.belt == flight.onto
                if returns and cuts is not None and flight.stays_off(e, u, cuts):
                    continue

                def f(s, flight=flight, side=side, speed=speed):
                    """Return the distance of v from a belt a time s after the start, and its first
                    two derivatives.
                    """
                    _, v, a = flight.after(e, u, s)
                    jerk = -2 * e.h * a - e.km * v - e.drive * (u[flight.at] + e.Om * s).sin()
                    return side * (v - speed), side * a, side * jerk

                order = (1 + flight.slips) * (belt == flight.belt)
                margin = Inequality(
                    "a flight that meets no belt before its end", "", f, order, belt == flight.onto
                )
                positive(margin, u[flight.tau].upper(), problem)


class Box:
    """A box of two parameters.

    The constructor proves that a word has one orbit for all of them, or raises Stop.
    """

    def __init__(self, p, over, word, box, u, problem):
        self.p = p
        self.over = over
        self.word = word
        self.u = column(u)
        self.problem = problem
        self.middle = [arb((low + high) / 2) for low, high in box]
        self.half = [arb((high - low) / 2) for low, high in box]
        self.wide = [arb(low).union(arb(high)) for low, high in box]
        problem.step(word.size)
        self.newton()
        self.surface()

    def plane(self, values):
        """Return the oscillator with the given values of both parameters of the plane."""
        return BallOscillator(self.p | dict(zip(self.over, values, strict=True)))

    def series(self, side, rows, count, wide=False, plan=None):
        """Return the first `count` Taylor coefficients of Y r in the direction `side`, and all
        margins as series.

        r are the residuals, Y is near the inverse of their Jacobian, and `rows` has the
        coefficients of the unknowns as a series. All series begin at the middle of the box or, if
        `wide`, at all of its points at once.
        """
        ctx.cap = count
        if wide:
            start = self.wide
        else:
            start = self.middle
        values = [
            arb_series([begin, half * component], prec=count)
            for begin, half, component in zip(start, self.half, side, strict=True)
        ]
        e = self.plane(values)
        by_unknown = zip(*(vector.entries() for vector in rows), strict=True)
        u = [arb_series(list(orders), prec=count) for orders in by_unknown]
        r, margins = self.word.r(e, u, plan)
        orders = [self.Y * column([residual[order] for residual in r]) for order in range(count)]
        return orders, margins

    def columns(self, e, u, plan=None):
        """Return for each unknown the derivatives by it of the residuals r and, given a `plan`, of
        the margins.
        """
        derivatives = []
        u = u.entries()
        ctx.cap = 2
        self.problem.step(len(u) * len(self.word.flights) // 2)
        for j in range(len(u)):
            moved = [*u[:j], arb_series([u[j], 1], prec=2), *u[j + 1 :]]
            residuals, margins = self.word.r(e, moved, plan)
            derivatives.append(
                (
                    [coefficient(residual, 1) for residual in residuals],
                    [coefficient(margin, 1) for margin in margins],
                )
            )
        return derivatives

    def newton(self):
        """Find the unknowns u of the orbit at the box's middle, the Jacobian J, and Y near its
        inverse; no proof.
        """
        e = self.plane(self.middle)
        for _ in range(BOX_NEWTON_STEPS):
            derivatives = self.columns(e, self.u)
            self.J = arb_mat([of_residuals for of_residuals, _ in derivatives]).transpose()
            self.Y = self.J.mid().inv().mid()
            residuals, _ = self.word.r(e, self.u.entries())
            step = (self.Y * column(residuals)).mid()
            if all(abs(change) < NEAR for change in step.entries()):
                return  # J is that at u
            self.u = (self.u - step).mid()
            check(
                all(abs(change) < MOST_CHANGE for change in step.entries()),
                "a root at the middle of a box",
                OPEN,
            )
        raise Stop(OPEN, "a root at the middle of a box")

    def surface(self):
        """Prove that for all places d in the box the word has one orbit, whose unknowns are near a
        polynomial u(d).
        """
        word = self.word
        zero = arb(0)
        place = arb(0, 1)
        # u(d) = u + a d_1 + b d_2 + aa d_1^2 + ab d_1 d_2 + bb d_2^2 cancels r_1 and r_2, and `p`
        # bounds what rounding leaves of Y r_0, Y r_1 and Y r_2 (10 above).
        p = [arb(0)] * word.size
        bends = []
        lines = []
        slopes_at_middle = []
        for side in SIDES[:2]:
            (_, order_1), _ = self.series(side, [self.u], 2)
            slopes_at_middle.append(-order_1.mid())
        a, b = slopes_at_middle
        for i, j in SIDES[:3]:
            line = [self.u, i * a + j * b]
            lines.append(line)
            (order_0, order_1, order_2), _ = self.series((i, j), line, 3)
            bend = -order_2.mid()
            bends.append(bend)
            for values in (order_0, order_1, order_2 + self.Y * (self.J * bend)):
                # 3 times suffices: on the box a form is at most |aa| + |both - aa - bb| + |bb|.
                p = [
                    total + 3 * abs(value) for total, value in zip(p, values.entries(), strict=True)
                ]
        aa, bb, both = bends
        ab = both - aa - bb
        u = self.u + place * (a + place * aa + place * ab) + place * (b + place * bb)

        def slopes(i, j):
            """Return first and second Taylor coefficients of u(d) in the direction (i, j), for all
            d in the box.
            """
            first = i * (a + 2 * place * aa + place * ab) + j * (b + 2 * place * bb + place * ab)
            return first, i * i * aa + j * j * bb + i * j * ab

        cubes = []
        bends_of_margins = []
        plan = word.plan(self.plane(self.wide), u.entries())
        for side in SIDES:
            orders, margins = self.series(side, [u, *slopes(*side)], 4, True, plan)
            cubes.append(orders[3])
            bends_of_margins.append([coefficient(margin, 2) for margin in margins])
        # The form A d_1^3 + B d_1^2 d_2 + C d_1 d_2^2 + D d_2^3 has along the SIDES the values A,
        # D, A + B + C + D and A - B + C - D.
        A, D, plus, minus = cubes
        form = A, (plus - minus) / 2 - D, (plus + minus) / 2 - A, D
        parts = zip(p, *(cube.entries() for cube in form), strict=True)
        p = [(total + sum(map(abs, values), zero)).upper() for total, *values in parts]
        along_sides = [slopes(*side) for side in SIDES[:2]]
        tube = self.contract(p, u, [slope for slope, _ in along_sides])
        around = u + column([arb(0, radius) for radius in tube])
        self.prove_margins(around, tube, plan, lines, bends_of_margins)

    def prove_margins(self, around, tube, plan, lines, bends):
        """Prove all margins for the unknowns `around` u(d), by Taylor's theorem of order 2.

        `tube` has their greatest distance from u(d), `lines` the unknowns along both sides from the
        middle, `bends` the terms of order 2 of the margins along the SIDES.
        """
        word = self.word
        zero = arb(0)
        e = self.plane(self.wide)
        same = all(
            set(new) <= set(old)
            for new, old in zip(word.plan(e, around.entries()).turns, plan.turns, strict=True)
        )
        check(same, "which turns are in a stick", OPEN)
        by_u = [of_margins for _, of_margins in self.columns(e, around, plan)]
        margins_along = []
        for side, rows in zip(SIDES[:2], lines, strict=False):
            _, margins = self.series(side, rows, 2, False, plan)
            margins_along.append(margins)
        along_a, along_b = margins_along
        for i, (by_a, by_b) in enumerate(zip(along_a, along_b, strict=True)):
            bend_a, bend_b, bend_both = (of_margins[i] for of_margins in bends[:3])
            least = coefficient(by_a) - abs(coefficient(by_a, 1)) - abs(coefficient(by_b, 1))
            least += bend_a.min(zero) + bend_b.min(zero) - abs(bend_both - bend_a - bend_b)
            off_surface = zip(by_u, tube, strict=True)
            least -= sum((abs(slopes[i]) * radius for slopes, radius in off_surface), zero)
            if i in word.looks and not least > 0:
                plan.cuts[word.looks[i]] = None  # by short steps, then
                continue
            # Smaller boxes may decide it.
            check(least > 0, "an inequality of a word in a box", OPEN)
        word.stays(e, around.entries(), plan, self.problem)

    def contract(self, p, u, slopes):
        """Return how far, for each unknown, a root is from u(d) at most, for all places d in the
        box (Krawczyk).
        """
        indices = range(self.word.size)
        tube = [arb(FIRST_INFLATION) * bound for bound in p]
        # Slopes along unit vectors are taken `scales` long, as long as those of u(d): what cancels
        # in `mixed` is then of one size.
        sizes = zip(*(slope.entries() for slope in slopes), tube, strict=True)
        scales = [
            max((abs(by_a).upper(), abs(by_b).upper(), radius), key=float).mid()
            for by_a, by_b, radius in sizes
        ]
        units = [column([scales[j] if i == j else arb(0) for i in indices]) for j in indices]
        for _ in range(MOST_TUBES):
            tube = [(arb(INFLATION) * radius).mid() for radius in tube]
            near = column([arb(0, radius) for radius in tube])
            # N[j][i] bounds entry (i, j) of 1 - Y J: first at the middle of the box ...
            derivatives = self.columns(self.plane(self.middle), self.u + near)
            at_middle = [(self.Y * column(by_u)).entries() for by_u, _ in derivatives]
            N = [
                [abs(arb(int(i == j)) - entry) for i, entry in enumerate(row)]
                for j, row in enumerate(at_middle)
            ]
            # ... then its change along both sides: the mixed terms of r by the side and unknown j,
            # from the squares of sums of two directions.
            alone = [self.squares((0, 0), u + near, unit) for unit in units]
            for side, slope in zip(SIDES[:2], slopes, strict=False):
                own = self.squares(side, u + near, slope)
                for j, unit in enumerate(units):
                    mixed = self.squares(side, u + near, slope + unit) - own - alone[j]
                    N[j] = [
                        bound + abs(change) / scales[j]
                        for bound, change in zip(N[j], mixed.entries(), strict=True)
                    ]
            image = (column(p) + arb_mat(N).transpose() * column(tube)).entries()
            if all(moved < radius for moved, radius in zip(image, tube, strict=True)):
                return tube
            tube = [moved.upper() for moved in image]
            if not all(radius < MOST_CHANGE for radius in tube):
                break
        raise Stop(OPEN, "one root for all parameters of a box")

    def squares(self, side, u, slope):
        """Return second Taylor coefficients of Y r along `side`, all over the box, if u changes at
        the rate `slope`.
        """
        (_, _, order_2), _ = self.series(side, [u, slope, 0 * slope], 3, True)
        return order_2


def rests(p, over, box):
    """Prove that the mass may rest on a belt for all parameters of a box: v = 0 and mu FN >= |B0|."""
    ends = {name: (p[name], p[name]) for name in base.NAMES} | dict(zip(over, box, strict=True))
    drive = max(abs(end) for end in ends["B0"])
    least_FN, _ = ends["FN"]
    holds = []
    for belt in "12":
        least_mu, _ = ends["mu" + belt]
        holds.append(ends["v" + belt] == (0, 0) and least_mu * least_FN >= drive)
    check(any(holds), "that the mass may rest on a belt")


def check_disjoint(boxes):
    """Prove that no two boxes overlap: a vertical line moves across, and the boxes that it cuts are
    compared.
    """
    # Where the line reaches both an end and a beginning of boxes, the end is first: False < True.
    ends = []
    for i, ((left, right), _) in enumerate(boxes):
        ends += [(left, True, i), (right, False, i)]
    cut = list[Any]()  # sorted, and without overlaps: neighbours are enough to compare with
    for _, begins, i in sorted(ends):
        _, (low, high) = boxes[i]
        at = bisect_left(cut, (low, high, i))
        if not begins:
            del cut[at]
            continue
        for low_of, high_of, _ in cut[max(at - 1, 0) : at + 1]:
            check(high_of <= low or high <= low_of, "boxes that overlap")
        insort(cut, (low, high, i))


def clear(boxes, points, whole):
    """Raise Stop if a point of a border is inside a proven box.

    A RIM is left out; `whole` is the range.
    """
    away = [RIM * float(high - low) for low, high in whole]
    for box in boxes:
        (left, right), (low, high) = (
            (float(a) + by, float(b) - by) for (a, b), by in zip(box, away, strict=True)
        )
        # The points are sorted by x.
        first = bisect_right(points, (left, inf))
        end = bisect_left(points, (right,))
        for x, y in points[first:end]:
            check(not low < y < high, f"a border at {x:.6g}, {y:.6g}, in a box of one word")


def mirror_of(p, over):
    """Return the mirror image of each mode if, for any `over`, x = A0/k and v = 0 is a centre of
    symmetry; else {}.
    """
    if not {"v1", "v2", "mu1", "mu2"} & set(over) and p["v1"] == -p["v2"] and p["mu1"] == p["mu2"]:
        return {1: 3, 2: 2, 3: 1, 4: 5, 5: 4}
    for belt, other in ((1, 2), (2, 1)):
        free = {f"v{belt}", f"mu{other}"} & set(over)
        if not free and p[f"v{belt}"] == 0 == p[f"mu{other}"]:
            return {belt: belt + 1, belt + 1: belt, 3 + belt: 3 + belt}
    return {}


def area(boxes):
    """Return the sum of the areas of boxes."""
    return sum((right - left) * (high - low) for (left, right), (low, high) in boxes)


def atlas(data, source, limits):
    """Prove an atlas: all boxes, that they do not overlap, and their share of the area.

    Return lines of text.
    """
    over = data["over"]
    whole = data["range"]
    p = data["parameters"]
    check(over[0] != over[1], "two different parameters", BAD)
    for corner in ((x, y) for x in whole[0] for y in whole[1]):
        problem = base.StatedOscillator(p | dict(zip(over, corner, strict=True)), limits)
        check(min(problem.p["c"], problem.p["k"]) > 0, "a damper and a spring in the whole range")
    boxes = [row["range"] for row in data["boxes"]]
    for box in [whole, *boxes, *data["open"]]:
        check(all(low < high for low, high in box), "sides from a lower to an upper value", BAD)
        inner = all(low <= a and b <= high for (a, b), (low, high) in zip(box, whole, strict=True))
        check(inner, "a box beyond the range")
    check_disjoint([*boxes, *data["open"]])
    clear(boxes, data["found"], whole)
    full_area, proven, unproven = (
        area(rectangles) for rectangles in ([whole], boxes, data["open"])
    )
    stated = f"a share of {source['share'][:40]}, where the boxes have {proven / full_area}"[:160]
    check(proven == data["share"] * full_area, stated)
    check(proven + unproven == full_area, "boxes and open ones that fill the range")
    mirror = mirror_of(p, over)
    words = dict[str, LabelCycle]()
    with ctx.workprec(BOX_BITS):
        values = {name: arb(problem.p[name]) for name in base.NAMES}
        for row, shown in zip(data["boxes"], source["boxes"], strict=True):
            text = row["word"]
            box = row["range"]
            problem.step()
            if text == "rest":
                check(not row["phases"] and not row["x"], "a rest with switchings", BAD)
                rests(p, over, box)
                continue
            word = words[text] = words.get(text) or LabelCycle(text, mirror)
            middle = dict(zip(over, (sum(side) / 2 for side in box), strict=True))
            near = word.unknowns(row, float(arb(middle.get("Omega", p["Omega"]))))
            what = f"the word {text} in the box {shown['range']}, in {MOST_BOX_PARTS} parts"
            prove = partial(Box, values, over, word, u=near, problem=problem)
            in_parts(prove, box, MOST_BOX_PARTS, what)
    share = f"{float((data['share'] * 10**6).floor()) / 1e6:.6f}"  # rounded down
    named = ", ".join(sorted({row["word"] for row in data["boxes"]}))
    spans = [
        f"{name} from {low} to {high}"
        for name, (low, high) in zip(over, source["range"], strict=True)
    ]
    count = f"{len(boxes)} box{'' if len(boxes) == 1 else 'es'}"
    first = f"the words of {count}, {share} of the area, {', '.join(spans)}: {named}"
    return [first, base.about(source["parameters"] | dict.fromkeys(over, "(varies)"))]


base.KINDS.update(orbit=orbit, branch=branch, atlas=atlas)


if __name__ == "__main__":
    base.main()
