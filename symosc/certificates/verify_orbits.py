#!/usr/bin/env python3
"""Prove a certificate of an orbit or of a branch of orbits once more: ``python verify_orbits.py FILE``.

It needs verify.py beside it, python-flint, and nothing of symosc; it proves all kinds. verify.py has the equation and
how a motion is followed from event to event, for all starts of a box at once. Balls (arb) prove:

1. "orbit": let P be the motion from the times and positions at the first event to those at the last, less the periods,
   and D its derivatives over a box c + [-e, e]. A fixed point c + u has u = (P(c) - c) + D u (mean value theorem). If
   the solution w of (1 - D) w = P(c) - c is unique and lies in [-e, e], for all matrices in D, there is exactly one
   fixed point in the box, and it is in c + w (interval Newton). It is done for the box stated, and again for one or two
   small boxes around the fixed point, to know it better.
2. The multipliers are the eigenvalues of D at the fixed point: the roots of z^2 - T z + d, with its trace T and its
   determinant d (0 if the motion sticks). Both are inside the unit circle if and only if |d| < 1 and |T| < 1 + d.
3. A motion with a smaller period of N/q forcing periods does the same events after 1/q of them: it has not, if their
   kinds differ, or t or x at the event where it would begin again. (A period is a multiple of the forcing period: for
   B0 = 0 no orbit is alone.) On a branch one box is enough: two roots where J is regular never meet.

A "branch", for an interval of a parameter at once:

4. x = A/k + a cos(Omega t) + b sin(Omega t) + y, a + i b = B0/(k - m Omega^2 - i c Omega), y'' + 2 h y' + (k/m) y = 0,
   h = c/(2m). So y(s) = y(0) C + (y'(0) + h y(0)) S, with C and S = exp(-h s) times cosh(w s) and sinh(w s)/w, and
   w^2 = h^2 - k/m of any sign. A mode ends where a function f is 0: the distance of v from a belt; on a belt F or -F.
5. u = (t_0, x_0, t_1, ...) is on an orbit only if r(u) = 0: each mode leads from one (t_i, x_i) to the next, f = 0
   there, and the last is the first again. Let J contain the derivatives of r over a box X and an interval of the
   parameter, and c be in X for each of its values. If J has no singular matrix and c - J^-1 r(c) lies in X, then for
   each value r has exactly one root in X, and it is in c - J^-1 r(c) (interval Newton). c is a polynomial in the
   change d of the parameter, and r(c) = r_0 + r_1 d + ... + r_n d^n with r_n of all its values (Taylor).
6. The modes follow each other as F on both sides of a belt says, and f > 0 between two events.
7. An end: from `inside`, a value that the boxes contain, to `outside` r has one root in a box. It is the branch's at
   `inside`, where all inequalities hold; at `outside` the one named fails (a distance or a force on a belt: at the time
   `at`). Both sides of it are continuous: in between it becomes an equality. Which one is the first is not proven.
"""

import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from itertools import pairwise
from math import comb
from typing import Any, NamedTuple

from flint import arb, arb_mat, arb_series, ctx, fmpq

try:
    base = import_module(".verify" if __package__ else "verify", __package__)
except ImportError as error:
    print(f"no certificate was read: verify.py has to be beside verify_orbits.py ({error})", file=sys.stderr)
    sys.exit(2)
Stop, OPEN, BAD, check, require, inside = base.Stop, base.OPEN, base.BAD, base.check, base.require, base.inside
number, interval, verify, judge, MODES = base.number, base.interval, base.verify, base.judge, base.MODES

PIECES = ((1, 4, 1), (1, 1, 1), (1, 2, 1), (2, 5, 2), (2, 2, 2), (2, 3, 2), (2, 2, 1), (1, 2, 2))  # from, mode, to
LABELS = {piece: number for number, piece in enumerate(PIECES, 1)}
SMALL, KNOWN = fmpq(1, 10**15), 1e-16
ORDER, MOST_PARTS, NEWTON_STEPS, RANGE_END = 3, 256, 4, "end of the range"

EVENT, POINTS = base.WHAT | {"t": interval, "x": interval}, {"t": [interval], "x": [interval]}
ORBIT = {"parameters": base.MOTION["parameters"], "word": str, "periods": int}
END = {"kind": {RANGE_END}, "inside": number, "outside": number}


def end_of_branch(value, where):
    """Read an end of a branch."""
    at_range = type(value) is dict and value.get("kind") == RANGE_END
    return base.read(value, END if at_range else END | POINTS | {"kind": str, "inequality": str, "at": number}, where)


base.SHAPES["orbit"] = ORBIT | {
    "events": [EVENT | {"reach": number}],
    "alone_within": (number, number),
    "multipliers": ({"re": interval, "im": interval},) * 2,
    "stable": {True, False, None},
}
base.SHAPES["branch"] = ORBIT | {
    "parameter": set(base.NAMES),
    "range": (number, number),
    "stable": {True, None},
    "ends": (end_of_branch,) * 2,
    "events": [base.WHAT],
    "boxes": [POINTS | {"value": (number, number)}],
}


def course(data):
    """Prove that the events follow each other, return to the first, and have the stated word."""
    rows = data["events"]
    check(0 < data["periods"] < 10_000 and len(rows) > 2, "a number of periods, and three events at least", BAD)
    found = [tuple(base.what(row)) for row in rows]
    for before, (kind, belt, source, target) in pairwise([found[-2], *found]):
        made = "slip" if source > 3 else "stick" if target > 3 else "cross"
        near = source != target and {source, target} <= {belt, belt + 1, belt + 3}
        check(near and (kind, source) == (made, before[3]), "events that do not follow each other")
    check(found[0] == found[-1], "a last event that is not the first one again")
    labels = [LABELS.get((belt, mode, after[1])) for (_, belt, _, mode), after in pairwise(found)]
    word, shown = data["word"], "".join(map(str, reversed(labels)))
    right = word[:1] == "P" and len(word) == len(shown) + 1 and word[1:] in shown * 2
    check(right, f"the word {word[:40]!r}, of events that say {shown[:40]}")
    return found


def least(events, periods, apart):
    """Prove that no smaller number of forcing periods is a period (3 above)."""
    # `apart` says whether t or x of an event surely differs from the first one's, that many forcing periods earlier.
    n = len(events) - 1
    for q in range(2, periods + 1):
        if periods % q == n % q == 0 and all(events[i] == events[(i + n // q) % n] for i in range(n)):
            less = periods // q
            check(apart(n // q, less), f"that the least period is {periods} forcing periods, not {less}", OPEN)


def column(values):
    """Return a matrix with one column."""
    return arb_mat(len(values), 1, values)


def eigenvalues(T, d):
    """Return real and imaginary parts of the roots of z^2 - T z + d, the larger one first if they are real."""
    if d.is_zero():
        return (T, arb(0)), (arb(0), arb(0))
    square = T * T / 4 - d
    root = abs(square).upper().sqrt()
    if not abs(square) > 0:
        around = root.union(-root)
        return ((T / 2 + around, around),) * 2
    root = abs(square).sqrt()
    if square < 0:
        return (T / 2, root), (T / 2, -root)
    require(abs(T), "which multiplier is the larger one")
    return (T / 2 + (root if T > 0 else -root), arb(0)), (T / 2 - (root if T > 0 else -root), arb(0))


#: A motion of which it is known that nothing happens between its events: it is one of more that are proven.
Within = type("Within", (base.Motion,), {"positive": lambda motion, *until: None})


def orbit(data, source, limits):
    """Prove that the stated orbit exists with its multipliers, and is unique in its box."""
    problem, periods, events = base.Problem(data["parameters"], limits), data["periods"], course(data)
    rows, turn = data["events"], 2 * periods * arb.pi() / arb(problem.p["Omega"])
    centre, widths = ([arb((row[1] + sign * row[0]) / 2) for row in (rows[0]["t"], rows[0]["x"])] for sign in (1, -1))
    widths = [arb(each) for each in data["alone_within"]]
    right = min(data["alone_within"]) > 0 <= min(row["reach"] for row in rows)
    check(right, "alone_within, or reach out of range", BAD)
    whole = list(zip(centre, widths, strict=True))
    for scale in (fmpq(1), SMALL, SMALL**2):  # the box stated, and one or two in it
        spare = [row["reach"] * scale for row in rows]
        wide = [row | {"t": (row["t"][0] - by, row["t"][1] + by)} for row, by in zip(rows, spare, strict=True)]
        motions = base.follow(problem, wide, (centre, widths), base.Motion if scale == 1 else Within)
        u, D = base.fixed_point(motions, (centre, widths), turn)
        for each, width, c, (about, most) in zip(u, widths, centre, whole, strict=True):
            require(width - abs(each), "that an orbit is in the box, and only one")
            check(scale == 1 or abs(c - about) + width < most, "a smaller box in the other", OPEN)
        if scale < SMALL or (scale < 1 and all(each.rad() < KNOWN for each in D.entries())):
            break
        root = [c + each for c, each in zip(centre, u, strict=True)]
        centre, widths = [each.mid() for each in root], [(2 * each.rad()).mid() for each in root]
    parts = [each / width for each, width in zip(u, widths, strict=True)]
    points = [motion.from_centre(parts) for motion in motions]  # of the fixed point, by the derivatives
    for (t, x), row in zip(points, rows, strict=True):
        inside(t, row["t"])
        inside(x, row["x"])

    def apart(i, earlier):
        """Return whether event i surely differs from the first one after that many forcing periods."""
        (t, x), (t0, x0) = points[i], points[0]
        return not ((t - t0) * periods).overlaps(earlier * turn) or not x.overlaps(x0)

    least(events, periods, apart)
    T, d = D[0, 0] + D[1, 1], D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0]
    d = arb(0) if any(row["kind"] == "stick" for row in rows) else d
    for (re, im), ends in zip(eigenvalues(T, d), data["multipliers"], strict=True):
        inside(re, ends["re"])
        inside(im, ends["im"])
    if data["stable"] is not None:
        margins = 1 - abs(d), 1 + d - abs(T)
        for margin in margins:
            require(abs(margin), "whether it is stable")
        stable = all(margin > 0 for margin in margins)
        check(data["stable"] is stable, "an orbit that is not as stable as it is said to be")
    kind = {True: "a stable orbit", False: "an unstable orbit", None: "an orbit"}[data["stable"]]
    first = f"{kind} {data['word']} of {periods} forcing period{'s' * (periods != 1)}, the only one within"
    first += " {} in t and {} in x".format(*source["alone_within"])
    shown = [f"multiplier: {' .. '.join(each['re'])} + i ({' .. '.join(each['im'])})" for each in source["multipliers"]]
    return [first, base.about(source["parameters"]), *base.table(source["events"]), *shown]


# -- branches ----------------------------------------------------------------------------------------------------------


def horner(rows, at):
    """Return the values of polynomials given by rows of coefficients."""
    total = rows[-1]
    for row in reversed(rows[:-1]):
        total = [a + at * b for a, b in zip(row, total, strict=True)]
    return total


def level(value):
    """Return a ball itself, or the first coefficient of a series."""
    return value[0] if isinstance(value, arb_series) else value


def entire(b, z):
    """Return 0F1(b; z) of a ball or a series: cosh w for b = 1/2, sinh(w)/w for b = 3/2, z = w^2/4 of any sign."""
    if isinstance(z, arb):
        return z.hypgeom_0f1(b)
    total, factor = 0 * z, 1 + 0 * z
    for j in range(z.prec):  # by its derivative 0F1(b + 1; z)/b
        total, factor = total + factor * z[0].hypgeom_0f1(b + j), factor * (z - z[0]) / ((b + j) * (j + 1))
    return total


class Equation:
    """The equation of motion with one parameter a ball, or a series in a change of it."""

    def __init__(self, p, name, value):
        q = {each: arb(p[each]) for each in base.NAMES} | {name: value}
        self.m, self.c, self.k, A0, self.B0, self.Om, *belts, mu1, mu2, FN = (q[each] for each in base.NAMES)
        self.A, self.belts = [A0 + each * FN for each in (0, mu1 + mu2, mu2 - mu1, -mu1 - mu2)], [None, *belts]
        self.friction = [None, mu1 * FN, mu2 * FN]
        self.h, self.km, self.drive = self.c / (2 * self.m), self.k / self.m, self.B0 * self.Om / self.m
        pull, drag, square = self.k - self.m * self.Om * self.Om, self.c * self.Om, self.h * self.h - self.km
        size, self.square, self.over = pull * pull + drag * drag, square, level(square) > 0
        self.a, self.b, self.turn = self.B0 * pull / size, self.B0 * drag / size, 2 * arb.pi() / self.Om
        self.w = (square if self.over else -square).sqrt()
        self.critical = not level(self.w) > 32 * level(self.w).rad()  # or nearly so

    def free(self, s):
        """Return C and S, the free motions from position 1 and from velocity 1, after a time s (1 above)."""
        decay, ws, z = (-self.h * s).exp(), self.w * s, self.square * s * s / 4
        if self.critical:
            return decay * entire(arb(0.5), z), decay * s * entire(arb(1.5), z)
        up, down = (ws.exp(), (-ws).exp()) if self.over else (ws, ws)
        sine, cosine = ((up - down) / 2, (up + down) / 2) if self.over else ws.sin_cos()
        return decay * cosine, decay * sine / self.w


class Piece:
    """The motion in one mode from t and x at a belt on, and the functions f that are > 0 during it."""

    def __init__(self, e, mode, belt, t, x, late):
        self.e, self.mode, self.t, self.x, self.v, self.ends = e, mode, t, x, e.belts[belt], {belt: 1, belt + 1: -1}
        self.a = self.force(mode, 0, t)[0] if mode < 4 else arb(0)
        self.x, self.v = x - self.v * late, self.v - self.a * late  # a later start is one with another x and v
        if mode < 4:
            self.ends = {i: 1 if mode > i else -1 for i in (1, 2) if mode - i in (0, 1)}
            sine, cosine = (e.Om * t).sin_cos()
            self.y = self.x - e.A[mode] / e.k - e.a * cosine - e.b * sine
            self.dy, force = self.v - e.Om * (e.b * cosine - e.a * sine), self.force(mode, 0, t)[0]
            self.ddy = force + e.Om * e.Om * (e.a * cosine + e.b * sine)

    def at(self, s, t):
        """Return x, v, v' and v'' after a time s of a flight, which is the time t."""
        e, (C, S) = self.e, self.e.free(s)
        sine, cosine = (e.Om * t).sin_cos()
        u, w, square = e.a * cosine + e.b * sine, e.Om * (e.b * cosine - e.a * sine), e.Om * e.Om
        y = C * self.y + S * (self.dy + e.h * self.y)
        dy, ddy = C * self.dy + S * (self.ddy + e.h * self.dy), C * self.ddy - S * (e.km * self.dy + e.h * self.ddy)
        return e.A[self.mode] / e.k + u + y, w + dy, ddy - square * u, -2 * e.h * ddy - e.km * dy - square * w

    def force(self, domain, s, t):
        """Return F of a domain on the belt after a time s, which is the time t, and its first two derivatives."""
        e = self.e
        sine, cosine = (e.Om * t).sin_cos()
        F = (e.A[domain] + e.B0 * cosine - e.k * (self.x + self.v * s) - e.c * self.v) / e.m
        return F, -e.drive * sine - e.km * self.v, -e.drive * e.Om * cosine

    def f(self, end, s):
        """Return f, f' and f'' of an end after a time s."""
        first, *others = self.force(end, s, self.t + s) if self.mode > 3 else self.at(s, self.t + s)[1:]
        return [self.ends[end] * each for each in (first if self.mode > 3 else first - self.e.belts[end], *others)]


class Margin(NamedTuple):
    """A function that must be > 0 on a piece: its text, the kind of branch end where it fails, and f."""

    text: str
    kind: str
    f: Callable[..., Any]
    order: int = 0  # which derivative of f is not 0 at the start
    zero: bool = False  # whether f is 0 at the end
    during: bool = False  # whether f is > 0 all the time between them


class Course:
    """The equations r of an orbit with these events, and the inequalities that make a root an orbit."""

    def __init__(self, events, periods, e):
        self.events, self.e, self.turn, self.count = events, e, periods * e.turn, len(events) - 1

    def piece(self, i, u, late=0):
        """Return the motion between event i and the next, its duration, and the time at its end."""
        until, t = u[2 * i + 2] if i + 1 < self.count else u[0] + self.turn, u[2 * i]
        return Piece(self.e, self.events[i][3], self.events[i][1], t, u[2 * i + 1], late), until - t, until

    def left(self, i, u, late=0):
        """Return both residuals r of the motion from event i to the next: of position, and of velocity or force."""
        (piece, s, until), (_, belt, _, target) = self.piece(i, u, late), self.events[i + 1]
        sticks, onto = piece.mode > 3, u[(2 * i + 3) % len(u)]
        x, f = (piece.x + piece.v * s, piece.force(target, s, until)[0]) if sticks else piece.at(s, until)[:2]
        return x - onto, f if sticks else f - self.e.belts[belt]

    def r(self, u):
        """Return the residuals r of all pieces, whose root is an orbit."""
        return [each for i in range(self.count) for each in self.left(i, u)]

    def jacobian(self, u):
        """Return the derivatives of r: the first coefficients of series."""
        J, none = arb_mat(len(u), len(u)), arb_series([0], prec=2)
        for i in range(self.count):
            for j in (j % len(u) for j in range(2 * i, 2 * i + 4)):
                moved = u if j == 2 * i else [*u[:j], arb_series([u[j], 1], prec=2), *u[j + 1 :]]
                parts = self.left(i, moved, arb_series([0, 1], prec=2) if j == 2 * i else 0)
                J[2 * i, j], J[2 * i + 1, j] = ((each + none)[1] for each in parts)
        return J

    def margins(self, i, u):
        """Return the functions that must be > 0 after event i."""
        ((made, belt, source, mode), after), (piece, s, _) = self.events[i : i + 2], self.piece(i, u)
        around = pairwise([self.events[i - 1 - (not i)], *self.events[i : i + 2]])
        previous, label = (f"P{LABELS[a[1], a[3], b[1]]}" for a, b in around)
        kind = "vanishing of a stick" if mode > 3 else "vanishing of a slip" if source > 3 else "vanishing of a flight"
        found = [Margin(f"{label} lasts", kind, lambda _: (s, arb(0), arb(0)))]
        signs = {"stick": (1, -1), "slip": ()}.get(made, (1, 1) if mode > source else (-1, -1))
        for domain, sign in zip((belt, belt + 1), signs, strict=False):
            F = sign * piece.force(domain, 0, piece.t)[0], arb(0), arb(0)
            text = f"F^({domain}) {'<>'[sign > 0]} 0 where {previous} ends"
            far = domain != source and level(self.e.friction[belt]) > 0
            kind = "grazing" if not far else "birth of a slip" if mode > 3 else "birth of a stick"
            found.append(Margin(text, kind, lambda _, F=F: F))
        for end, side in piece.ends.items():
            f = partial(piece.f, end)
            if mode > 3:
                text = f"F^({end}) {'<>'[side > 0]} 0 during {label}"
                found.append(Margin(text, "birth of a slip", f, zero=end == after[3], during=True))
            else:
                order = (1 + (source > 3)) * (end == belt)
                first = f(arb(0))[order]
                kind = "grazing" if first > 0 else "vanishing of a slip" if order == 2 and first < 0 else ""
                text = f"v {'<>'[side > 0]} v{end} during {label}"
                found.append(Margin(text, kind, f, order, end == after[1], True))
        return found

    def prove(self, u, stable, problem):
        """Prove all margins (6 above) for all roots in u, and, if `stable`, that both multipliers are inside 1 (2)."""
        period, D, J = arb_mat([[1, 0], [0, 1]]), arb(1), self.jacobian(u)
        for i in range(self.count):
            for margin in self.margins(i, u):
                positive(margin, self.piece(i, u)[1].upper(), problem)
            rows = [[J[j, (2 * i + k) % len(u)] for k in range(4)] for j in (2 * i, 2 * i + 1)]
            start, end = (arb_mat([row[k : k + 2] for row in rows]) for k in (0, 2))
            piece, s, until = self.piece(i, u)
            D *= (-2 * self.e.h * s).exp() * piece.a / (1 if piece.mode > 3 else piece.at(s, until)[2])
            period = -end.solve(start) * period
        for margin in (1 - abs(D), 1 + D - abs(period.trace())) if stable else ():
            require(margin, "stable")


def positive(margin, until, problem):
    """Prove that f > 0 between 0 and a time, by Taylor's theorem about the middles of steps."""
    a, step, order = arb(0), until / 8, margin.order
    while True:
        problem.step()
        last = not a + step < until
        b = until if last else (a + step).mid()
        m, T, h = ((a + b) / 2).mid(), a.union(b), ((b - a) / 2).upper()
        middle, around = margin.f(m), margin.f(T)
        slope = middle[1] + around[2] * arb(0, 1) * h
        if last and margin.zero:
            sure = slope < 0 and not order
        else:
            check(not middle[0] < 0, margin.text)
            sure = middle[0] - abs(middle[1]) * h - abs(around[2]) * h * h / 2 > 0
            sure = sure or (slope > 0 and (order or a > 0))  # f was > 0 at a, or 0 at the start
            sure = sure or (order and around[2] > 0)  # f' >= 0 at the start, by the forces there
        if sure and last:
            return
        a, order, step = (b, 0, step * 3 / 2) if sure else (a, order, h)
        check(step > until * arb(2) ** -ctx.prec, margin.text, OPEN)


class Family:
    """The roots of r in the box of a row, one for each value of the parameter from low to high (5 above)."""

    def __init__(self, problem, data, events, row, low, high):
        problem.step((2 * len(events)) ** 3 // 256)  # the work, and by it the size, of the matrices
        check(len(row["t"]) == len(row["x"]) == len(events), "t and x at each event", BAD)
        ends = [pair for both in zip(row["t"], row["x"], strict=True) for pair in both]
        self.course = lambda value: Course(events, data["periods"], Equation(problem.p, data["parameter"], value))
        self.box = [arb(a).union(arb(b)) for a, b in ends[:-2]]
        self.middle, every, c = arb((low + high) / 2), arb(low).union(arb(high)), [each.mid() for each in self.box]
        thin, self.all, self.change = self.course(self.middle), self.course(every), every - self.middle
        for _ in range(NEWTON_STEPS):  # it finds c and proves nothing
            self.Y = thin.jacobian(c).mid().inv().mid()
            c = (column(c) - self.Y * column(thin.r(c))).mid().entries()
        curve = [c]
        for order in range(1, ORDER):
            rest = self.coefficients(self.middle, [*curve, [arb(0)] * len(c)], order + 1)[-1]
            curve.append((-(self.Y * column(rest))).mid().entries())
        self.YJ = self.Y * self.all.jacobian(self.box)
        moved = [[[comb(k, j) * each for each in curve[k]] for k in range(j, ORDER)] for j in range(ORDER)]
        last = self.coefficients(every, [horner(rows, self.change) for rows in moved], ORDER + 1)[-1]
        r = horner([*self.coefficients(self.middle, curve, ORDER), last], self.change)
        self.curve, self.points = curve, self.newton(horner(curve, self.change), r)
        self.within(row, self.points, self.all)

    def coefficients(self, value, curve, count):
        """Return the first `count` Taylor coefficients of r along a curve, about a value of the parameter."""
        ctx.cap = max(ctx.cap, count)
        points = [arb_series(list(each), prec=count) for each in zip(*curve, strict=True)]
        r = self.course(arb_series([value, 1], prec=count)).r(points)
        return [[each[j] for each in r] for j in range(count)]

    def newton(self, c, r):
        """Enclose the root by a Newton step, c - J^-1 r(c), and prove that c lies in the box."""
        for each, whole in zip(c, self.box, strict=True):
            require(arb(whole.rad()) - abs(each - whole.mid()), "a curve in the box")
        return (column(c) - self.YJ.solve(self.Y * column(r))).entries()

    def root(self, value):
        """Return the root at one value of the parameter, and the equations there."""
        c, course = [each.mid() for each in horner(self.curve, arb(value) - self.middle)], self.course(arb(value))
        return self.newton(c, course.r(c)), course

    def within(self, row, u, course):
        """Prove that all points in u lie in a row of the file."""
        for name, values in (("t", [*u[::2], u[0] + course.turn]), ("x", [*u[1::2], u[1]])):
            for value, ends in zip(values, row[name], strict=True):
                inside(value, ends)

    def apart(self, i, earlier):
        """Return whether event i surely differs from the first one after that many forcing periods, for all values."""
        (t, x), (t0, x0) = self.points[2 * i : 2 * i + 2], self.points[:2]
        return not (t - t0).overlaps(earlier * self.all.e.turn) or not x.overlaps(x0)


def families(problem, data, events, row):
    """Prove the orbits of a row for all values of its interval, in parts; return the family of the last part."""
    parts, count = [row["value"]], 0
    while parts:
        low, high = parts.pop()
        count += 1
        try:
            family = Family(problem, data, events, row, low, high)
            family.all.prove(family.points, data["stable"], problem)
        except (Stop, ZeroDivisionError, ValueError) as stop:  # the latter two: a ball or a series may be 0
            check(not isinstance(stop, Stop) or stop.args[0] == OPEN, str(stop.args[-1]))
            parts += [((low + high) / 2, high), (low, (low + high) / 2)]
            check(count < MOST_PARTS, f"for all values from {row['value'][0]} to {row['value'][1]}")
    return family


def fails(problem, data, events, end, row):
    """Prove that an end's inequality fails at its outer value, for the root in a row at the inner one."""
    family = Family(problem, data, events, end, *sorted((end["inside"], end["outside"])))
    family.within(row, *family.root(end["inside"]))
    (u, course), at, kind = family.root(end["outside"]), arb(end["at"]), end["kind"]
    for i in range(course.count):
        after, s = at - u[2 * i], course.piece(i, u)[1]
        for margin in course.margins(i, u):
            if margin.text == end["inequality"] and margin.f(after)[0] < 0 and (not margin.during or 0 < after < s):
                check(margin.kind == kind, f"an end that is a {kind[:40]!r}, and not a {margin.kind or 'consequence'}")
                return
    raise Stop(base.FALSE, f"that {end['inequality'][:60]!r} fails at the outer value of the end")


def branch(data, source, limits):
    """Prove a branch: every row, that they join, and both ends."""
    name, rows, span, periods = data["parameter"], data["boxes"], data["range"], data["periods"]
    values, events, before = [row["value"] for row in rows], course(data), None
    right = values and span == [values[0][0], values[-1][1]] and all(a[1] == b[0] for a, b in pairwise(values))
    check(right, "rows that follow each other from one end of the range to the other")
    check(all(low < high for low, high in values), "intervals from a lower to an upper value of a parameter", BAD)
    for value in [*span, *(end["outside"] for end in data["ends"])]:
        problem = base.Problem(data["parameters"] | {name: value}, limits)
    tried = []
    for row in rows:
        if before:
            before.within(row, *before.root(row["value"][0]))
        before = families(problem, data, events, row)
        tried.append(before)
    least(events, periods, lambda *shift: any(family.apart(*shift) for family in tried))
    first = f"an orbit {data['word']} for every {name} from {source['range'][0]} to {source['range'][1]}"
    first += f", by {len(rows)} intervals"
    for end, row, inner, side, shown in zip(
        data["ends"], (rows[0], rows[-1]), span, (-1, 1), source["ends"], strict=True
    ):
        beyond = side * (end["outside"] - end["inside"])
        right = end["inside"] == inner and beyond >= 0 and (beyond == 0) == (end["kind"] == RANGE_END)
        check(right, "an end of the range, or one outside of it")
        if beyond:
            fails(problem, data, events, end, row)
            between = (shown["inside"], shown["outside"])[::side]
            first += "; {} between {} and {}: {}".format(end["kind"], *between, end["inequality"])
    stable = "stable for every value" if data["stable"] else "nothing is said of its stability"
    whole = f"{periods} forcing period{'s' * (periods != 1)}"
    about = base.about(source["parameters"] | {name: "(varies)"}, whole, stable)
    note = [f"that {end['inequality']} is the first to fail is not proven" for end in data["ends"] if "at" in end]
    shown = [f"{row['value'][0]} <= {name} <= {row['value'][1]}: {pairs(row)}" for row in source["boxes"]]
    return [first, about, *note, *base.table(source["events"]), *shown]


def pairs(row):
    """Return t and x of the events in a row of a branch, as text."""
    return "; ".join(
        f"{low} < {name}{i} < {high}"
        for i, both in enumerate(zip(row["t"], row["x"], strict=True), 1)
        for name, (low, high) in zip("tx", both, strict=True)
    )


base.KINDS.update(orbit=orbit, branch=branch)


if __name__ == "__main__":
    base.main()
