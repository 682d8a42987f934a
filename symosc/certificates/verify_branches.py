#!/usr/bin/env python3
"""Prove a certificate of a branch of orbits once more: ``python verify_branches.py FILE``.

Needs verify.py and verify_orbits.py beside it, python-flint, and nothing of symosc. It proves all kinds, the others by
those two. A "branch" states the events of an orbit, boxes of their times t_i and positions x_i for intervals of a
parameter that follow each other, and two ends. For every value in an interval there is exactly one orbit with these
events and its (t_i, x_i) in the box, the same one where two intervals meet. Balls (arb) contain all values:

1. x = A/k + a cos(Omega t) + b sin(Omega t) + y, a + i b = B0/(k - m Omega^2 - i c Omega), y'' + 2 h y' + (k/m) y = 0,
   h = c/(2m). So y(s) = y(0) C + (y'(0) + h y(0)) S, with C and S = exp(-h s) times cosh(w s) and sinh(w s)/w, and
   w^2 = h^2 - k/m of any sign. A mode ends where a function f is 0: the distance of v from a belt; on a belt F or -F.
2. u = (t_0, x_0, t_1, ...) is on an orbit only if r(u) = 0: each mode leads from one (t_i, x_i) to the next, f = 0
   there, and the last is the first again. Let J contain the derivatives of r over a box X and an interval of the
   parameter, and c be in X for each of its values. If J has no singular matrix and c - J^-1 r(c) lies in X, then for
   each value r has exactly one root in X, and it is in c - J^-1 r(c) (interval Newton). c is a polynomial in the
   change d of the parameter, and r(c) = r_0 + r_1 d + ... + r_n d^n with r_n of all its values (Taylor).
3. The modes follow each other as F on both sides of a belt says, and f > 0 between two events (the rules of verify.py).
4. It is stable if the derivatives of one period have a trace T and a determinant D with |D| < 1 and |T| < 1 + D.
5. An end: from `inside`, a value that the boxes contain, to `outside` r has one root in a box. It is the branch's at
   `inside`, where all inequalities hold; at `outside` the one named fails (a distance or a force on a belt: at the time
   `at`). Both sides of it are continuous: in between it becomes an equality.
"""

import sys
from functools import partial
from importlib import import_module
from itertools import pairwise
from math import comb

from flint import arb, arb_mat, arb_series, ctx

try:
    orbits = import_module(".verify_orbits" if __package__ else "verify_orbits", __package__)
except ImportError as error:
    print(f"no certificate was read: verify_orbits.py has to be beside verify_branches.py ({error})", file=sys.stderr)
    sys.exit(2)
base, verify, column, level, horner = orbits.base, orbits.verify, orbits.column, orbits.level, orbits.horner
Stop, OPEN, FALSE, check, require, number = base.Stop, base.OPEN, base.FALSE, base.check, base.require, base.number

ORDER, MOST_PARTS, MOST_STEPS, NEWTON_STEPS, RANGE_END = 3, 256, 500, 4, "end of the range"
CROSSING, ONSET, TIME, FLIGHT, STICK = range(5)  # where an inequality stands, and what an end by it may be called:
ENDS = [["birth of a stick"], ["birth of a slip"], ["vanishing of a stick", "vanishing of a flight"]]
ENDS += [["grazing", "vanishing of a slip"], ["birth of a slip", "vanishing of a slip"]]


class Equation:
    """The equation where one parameter is a ball, or a series in a change of it."""

    def __init__(self, p, name, value):
        q = {each: arb(p[each]) for each in base.NAMES} | {name: value}
        self.m, self.c, self.k, A0, self.B0, self.Om, *belts, mu1, mu2, FN = (q[each] for each in base.NAMES)
        self.A, self.belts = [A0 + each * FN for each in (0, mu1 + mu2, mu2 - mu1, -mu1 - mu2)], [None, *belts]
        self.h, self.km, self.drive = self.c / (2 * self.m), self.k / self.m, self.B0 * self.Om / self.m
        pull, drag, square = self.k - self.m * self.Om * self.Om, self.c * self.Om, self.h * self.h - self.km
        size, self.square, self.over = pull * pull + drag * drag, square, level(square) > 0
        self.a, self.b, self.turn = self.B0 * pull / size, self.B0 * drag / size, 2 * arb.pi() / self.Om
        self.w = (square if self.over else -square).sqrt()
        self.critical = not level(self.w) > 32 * level(self.w).rad()  # or nearly so

    def free(self, s):
        """Return C and S (1 above)."""
        decay, ws, z = (-self.h * s).exp(), self.w * s, self.square * s * s / 4
        if self.critical:
            return decay * orbits.entire(arb(0.5), z), decay * s * orbits.entire(arb(1.5), z)
        up, down = (ws.exp(), (-ws).exp()) if self.over else (ws, ws)
        sine, cosine = ((up - down) / 2, (up + down) / 2) if self.over else ws.sin_cos()
        return decay * cosine, decay * sine / self.w


class Piece:
    """The motion in one mode from t and x at a belt on, and the functions f that are > 0 in it."""

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


class Course:
    """The equations r of an orbit with these events, and what else makes a root an orbit."""

    def __init__(self, events, periods, e):
        self.events, self.e, self.turn, self.count = events, e, periods * e.turn, len(events) - 1

    def piece(self, i, u, late=0):
        """Return the motion behind event i, how long it lasts, and until when."""
        until, t = u[2 * i + 2] if i + 1 < self.count else u[0] + self.turn, u[2 * i]
        return Piece(self.e, self.events[i][3], self.events[i][1], t, u[2 * i + 1], late), until - t, until

    def left(self, i, u, late=0):
        """Return both parts of r behind event i."""
        (piece, s, until), (_, belt, _, target) = self.piece(i, u, late), self.events[i + 1]
        sticks, onto = piece.mode > 3, u[(2 * i + 3) % len(u)]
        x, f = (piece.x + piece.v * s, piece.force(target, s, until)[0]) if sticks else piece.at(s, until)[:2]
        return x - onto, f if sticks else f - self.e.belts[belt]

    def r(self, u):
        """Return r."""
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
        """Yield what is > 0 behind event i: text, where, f; which derivative is at the start; if f is 0 at the end."""
        ((kind, belt, source, mode), after), (piece, s, _) = self.events[i : i + 2], self.piece(i, u)
        around = pairwise([self.events[i - 1 - (not i)], *self.events[i : i + 2]])
        previous, label = (f"P{orbits.LABELS[a[1], a[3], b[1]]}" for a, b in around)
        yield f"{label} lasts", TIME, lambda _: (s, arb(0), arb(0)), 0, False
        signs = {"stick": (1, -1), "slip": ()}.get(kind, (1, 1) if mode > source else (-1, -1))
        for domain, sign in zip((belt, belt + 1), signs, strict=False):
            F = sign * piece.force(domain, 0, piece.t)[0], arb(0), arb(0)
            text = f"F^({domain}) {'<>'[sign > 0]} 0 where {previous} ends"
            yield text, ONSET if mode > 3 else CROSSING, lambda _, F=F: F, 0, False
        for end, side in piece.ends.items():
            text = f"F^({end}) {'<>'[side > 0]} 0" if mode > 3 else f"v {'<>'[side > 0]} v{end}"
            order, zero = (0, after[3]) if mode > 3 else ((1 + (source > 3)) * (end == belt), after[1])
            yield f"{text} during {label}", FLIGHT + (mode > 3), partial(piece.f, end), order, end == zero

    def prove(self, u, stable):
        """Prove 3 above for all roots in u; and 4."""
        period, D, J = arb_mat([[1, 0], [0, 1]]), arb(1), self.jacobian(u)
        for i in range(self.count):
            for text, _, f, order, ends in self.margins(i, u):
                positive(f, self.piece(i, u)[1].upper(), order, ends, text)
            rows = [[J[j, (2 * i + k) % len(u)] for k in range(4)] for j in (2 * i, 2 * i + 1)]
            start, end = (arb_mat([row[k : k + 2] for row in rows]) for k in (0, 2))
            piece, s, until = self.piece(i, u)
            D *= (-2 * self.e.h * s).exp() * piece.a / (1 if piece.mode > 3 else piece.at(s, until)[2])
            period = -end.solve(start) * period
        for margin in (1 - abs(D), 1 + D - abs(period.trace())) if stable else ():
            require(margin, "stable")


def positive(f, until, order, ends, what):
    """Prove that f > 0 between 0 and a time, where it is 0 if `ends`; at 0 its derivative of that order is > 0."""
    a, step = arb(0), until / 8
    for _ in range(MOST_STEPS):
        last = not a + step < until
        b = until if last else (a + step).mid()
        m, T, h, touches = ((a + b) / 2).mid(), a.union(b), ((b - a) / 2).upper(), last and ends
        middle, inside = f(m), f(T)
        slope = middle[1] + inside[2] * arb(0, 1) * h
        sure = middle[0] - abs(middle[1]) * h - abs(inside[2]) * h * h / 2 > 0 or (slope > 0 and (order or a > 0))
        sure = sure or (order == 1 and inside[1] > 0) or (order and inside[2] > 0)
        sure = slope < 0 and not order if touches else sure
        check(touches or not middle[0] < 0, what)
        if sure and last:
            return
        a, order, step = (b, 0, step * 3 / 2) if sure else (a, order, h)
    raise Stop(OPEN, what)


class Family:
    """The roots of r in the box of a row, one for each value of the parameter from low to high (2 above)."""

    def __init__(self, problem, row, low, high):
        ends = [pair for both in zip(number(row["t"]), number(row["x"]), strict=True) for pair in both]
        right = len(ends) == 2 * len(problem[2]) and all(len(pair) == 2 and pair[0] < pair[1] for pair in ends)
        check(right, "a lower and an upper end of t and x at each event", base.BAD)
        self.course = lambda value: Course(problem[2], problem[3], Equation(problem[0], problem[1], value))
        self.box = [arb(a).union(arb(b)) for a, b in ends[:-2]]
        self.middle, every, c = arb((low + high) / 2), arb(low).union(arb(high)), [each.mid() for each in self.box]
        thin, self.all, self.change = self.course(self.middle), self.course(every), every - self.middle
        try:
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
        except ZeroDivisionError:
            raise Stop(OPEN, "an orbit that is alone in its box") from None
        self.within(row, self.points, self.all)

    def coefficients(self, value, curve, count):
        """Return that many coefficients of r about a value of the parameter, along a curve given there."""
        ctx.cap = max(ctx.cap, count)
        points = [arb_series(list(each), prec=count) for each in zip(*curve, strict=True)]
        r = self.course(arb_series([value, 1], prec=count)).r(points)
        return [[each[j] for each in r] for j in range(count)]

    def newton(self, c, r):
        """Return c - J^-1 r(c), and prove that c lies in the box."""
        for each, whole in zip(c, self.box, strict=True):
            require(arb(whole.rad()) - abs(each - whole.mid()), "a curve in the box")
        return (column(c) - self.YJ.solve(self.Y * column(r))).entries()

    def root(self, value):
        """Return the root at one value of the parameter, and the equations there."""
        c, course = [each.mid() for each in horner(self.curve, arb(value) - self.middle)], self.course(arb(value))
        return self.newton(c, course.r(c)), course

    def within(self, row, u, course):
        """Prove that all points in u are in a row of the file."""
        for name, values in (("t", [*u[::2], u[0] + course.turn]), ("x", [*u[1::2], u[1]])):
            for value, ends in zip(values, row[name], strict=True):
                orbits.inside(value, ends)


def families(problem, row, stable):
    """Prove a row, by parts of its interval; return the last of them."""
    parts = [number(row["value"])]
    for _ in range(MOST_PARTS):
        low, high = parts.pop()
        try:
            family = Family(problem, row, low, high)
            family.all.prove(family.points, stable)
        except Stop as stop:
            check(stop.args[0] == OPEN, stop.args[1], stop.args[0])
            parts += [[(low + high) / 2, high], [low, (low + high) / 2]]
        if not parts:
            return family
    raise Stop(FALSE, f"for all values from {row['value'][0]} to {row['value'][1]}")


def fails(family, end, row):
    """Prove that the inequality of an end fails at its outer value, for the root that is in a row at the inner one."""
    family.within(row, *family.root(number(end["inside"])))
    (u, course), at = family.root(number(end["outside"])), arb(number(end["at"]))
    for i in range(course.count):
        after, s = at - u[2 * i], course.piece(i, u)[1]
        for text, where, f, *_ in course.margins(i, u):
            stated = text == end["inequality"] and end["kind"] in ENDS[where]
            if stated and f(after)[0] < 0 and (where < FLIGHT or 0 < after < s):
                return
    raise Stop(FALSE, f"that {end['inequality'][:60]} fails at the outer value of the end, a {end['kind'][:40]}")


def branch(data):
    """Prove a branch: every row, that they go on as each other, and both ends."""
    name, rows, before = data["parameter"], data["boxes"], None
    span, values = number(data["range"]), [number(row["value"]) for row in rows]
    right = span == [values[0][0], values[-1][1]] and all(a[1] == b[0] for a, b in pairwise(values))
    check(right, "rows that follow each other from one end of the range to the other")
    right = all(low < high for low, high in values) and data["stable"] in (True, None) and name in base.NAMES
    check(right, "intervals from a lower to an upper value of a parameter", base.BAD)
    for value in data["range"]:
        p, stated, periods = orbits.read(data | {"parameters": data["parameters"] | {name: value}})
    problem = p, name, orbits.chain(stated), periods
    for row, (low, _) in zip(rows, values, strict=True):
        if before:
            before.within(row, *before.root(low))
        before = families(problem, row, data["stable"])
    for end, row, value, side in zip(data["ends"], (rows[0], rows[-1]), span, (-1, 1), strict=True):
        inside, outside = number(end["inside"]), number(end["outside"])
        right = inside == value and side * (outside - inside) >= 0 and (inside == outside) == (end["kind"] == RANGE_END)
        check(right, "an end of the range, or one outside of it")
        if inside != outside:
            fails(Family(problem, end, *sorted((inside, outside))), end, row)
    return f"an orbit {data['word']} for every {name} from {data['range'][0]} to {data['range'][1]}, {len(rows)} boxes"


base.KINDS["branch"] = branch


if __name__ == "__main__":
    code, line = verify(sys.argv[1]) if len(sys.argv) == 2 else (base.BAD, "usage: python verify_branches.py FILE")
    print(" ".join(line.split()), file=sys.stderr if code else sys.stdout)
    sys.exit(code)
