#!/usr/bin/env python3
"""Prove a certificate of symosc once more: ``python verify.py FILE``. Needs python-flint and nothing of symosc.

Exit code 0: the file is proven. 1: it is false, or not proven here. 2: it is no certificate. The equation is m x'' + c
x' + k x = A + B0 cos(Omega t), A being A0 + (mu1 + mu2) FN where v = x' < v1 (Omega1), A0 - (mu1 - mu2) FN where v1 < v
< v2 (Omega2), A0 - (mu1 + mu2) FN where v > v2 (Omega3). F is x'' by it. At a belt, v = v1 or v2, the motion sticks if
F > 0 below and F < 0 above it, until one of them is 0; it passes if both have one sign. A "trajectory" states for a
start ("all" within start_error; "some": the only one with a free number between low and high that touches) that until
t_end these are its events, each within its times and positions. Balls (arb) prove it:

1. z = (x, v, 1, cos Omega t, sin Omega t) solves z' = M z in each mode, so z(t + s) = exp(s M) z(t). A mode ends when
   a function f = row z reaches 0: the distance of v from a belt, or, on a belt, F below it or -F above it.
2. f > 0 from a to b = a + h if f > 0 and f + f' h - B h^2/2 > 0 at a, |f''| < B; or if f > 0 > f' at b, and f' < 0 or
   f'' > 0 all the way. After a start with f = f' = ... = 0, f > 0 while the next derivative is > 0.
3. In an event one f has different signs at two times, and f' one sign between them; the others are > 0 there.
4. A graze: for all starts from low to high f > 0 > f' at a time, f > 0 at a later one, and f'' > 0 between them. The
   least f is > 0 for one of low and high, < 0 for the other, and its derivative by the start (that of f) is not 0: one
   start touches. If c = B0 = 0, v^2 + v'^2 m/k is constant: if it is the belt's speed squared, f = 0 where f' = 0.
5. With a start_error the states behind an event are f(centre) + D (start - centre), D the derivatives of all starts.
"""

import json
import re
import sys
from fractions import Fraction
from functools import cache
from math import frexp

from flint import arb, arb_mat, ctx, fmpq, fmpq_mat

NUMBER = re.compile(r"-?\d{1,2000}(/\d{1,2000}|(\.\d{1,2000})?(e[+-]?\d{1,3})?)", re.ASCII)
NAMES = ("m", "c", "k", "A0", "B0", "Omega", "v1", "v2", "mu1", "mu2", "FN")
START = ("t0", "x0", "v0")
MODES = ("", "Omega1", "Omega2", "Omega3", "belt1", "belt2")
MOST_STEPS, ORDERS, NEAR, TINY, (OPEN, FALSE, BAD) = 50_000, 7, 2.0**-20, fmpq(1, 10**100), range(3)


class Stop(Exception):
    """An end without a proof: OPEN (more bits may decide it), FALSE (or not proven here), BAD (no certificate)."""


def check(good, what, code=FALSE):
    """Go on only if something is so."""
    if not good:
        raise Stop(code, what)


def require(value, what):
    """Go on only if all numbers in a ball are > 0."""
    check(value > 0, what, FALSE if value < 0 else OPEN)


def sharper(f, found, slope, rounds):
    """Return a sharper enclosure of the zero of f in `found`, where f' is in `slope`, if known (interval Newton)."""
    for _ in range(rounds):
        step = found.mid() - f(found.mid())[0] / (f(found)[1] if slope is None else slope)
        check(step.overlaps(found), "where an event is", OPEN)
        found = step.intersection(found)
    return found


class Mode:
    """One mode of an oscillator: z' = M z, and for each f that ends it rows with f = rows[0] z, f' = rows[1] z, ..."""

    def __init__(self, p, mode):
        m, c, k, A0, B0, Om, *_, mu1, mu2, FN = (p[name] for name in NAMES)
        friction = {1: mu1 + mu2, 2: mu2 - mu1, 3: -mu1 - mu2}
        F = {i: [q / m for q in (-k, -c, A0 + friction[i] * FN, B0, fmpq(0))] for i in friction}
        self.p, self.number, self.flies = p, mode, mode < 4
        if self.flies:  # the distance from each belt around the domain
            self.ends = {i: [0, s, -s * p[f"v{i}"], 0, 0] for i, s in ((mode - 1, 1), (mode, -1)) if i in (1, 2)}
        else:  # F below the belt, and -F above it
            self.ends = {mode - 3: F[mode - 3], mode - 2: [-q for q in F[mode - 2]]}
        self.exact = fmpq_mat([[0, 1, 0, 0, 0], F.get(mode, [0] * 5), [0] * 5, [0, 0, 0, 0, -Om], [0, 0, 0, Om, 0]])
        self.M, self.row = arb_mat(self.exact), fmpq_mat(list(self.ends.values()))
        self.rows = [arb_mat(self.row * self.exact**order) for order in range(ORDERS)]
        # |f''| after a time is at most `swing` + the sum of |calm z| there: a steady motion, and one that decays.
        q, a, b = (c / m / 2) ** 2 - k / m, k - m * Om * Om, c * Om
        rate = arb(Om + c / m) + arb(k / m).sqrt() if self.flies else arb(Om)
        self.calm, self.swing = arb_mat(1, 5), arb.pos_inf() if self.flies else arb(abs(B0) * Om * Om / m)
        if self.flies and q != 0 and (a != 0 or b != 0):
            gain, h, w = B0 * Om / (a * a + b * b), arb(c / m / 2), arb(abs(q)).sqrt()
            y = arb_mat(fmpq_mat([[0, 1, 0, -gain * b, gain * a]]))  # v less the steady one
            pair = [y * (k / m), (y * self.M + y * h) * (k / m / w)]
            if q > 0:
                pair = [(y * self.M + y * (h + s)) * ((s - h) * (s - h) / w / 2) for s in (w, -w)]
            self.calm = arb_mat([[row[0, i] for i in range(5)] for row in pair])
            self.swing = arb(abs(gain) * Om * Om) * arb(a * a + b * b).sqrt()
        self.least = frexp(float(rate))[1]  # steps of 2^-least are so short that M times them is not large
        self.jump = cache(lambda n: (self.M * arb(fmpq(2) ** -n)).exp())
        self.way = cache(lambda n: (self.M * (arb(fmpq(2) ** -n) * arb(0.5, 0.5))).exp())  # for all of it

    def bends(self, z):
        """Return bounds > 0 of |f''| of each end after a state z; if `swing` is not known, for a time of 2^-least."""
        bound, spare = self.swing + sum(abs(each) for each in (self.calm * z).entries()), arb(TINY)
        near = [bound] * len(self.ends) if bound.is_finite() else (self.rows[2] * (self.way(self.least) * z)).entries()
        return [abs(each) + spare for each in near]


class Motion:
    """A motion in one mode from starts t, x, v on, a centre + D [-1, 1]; f that are 0 there have `leaves`: orders."""

    def __init__(self, modes, mode, belt, centre, columns=(), leaves=None, size=None, near=None):
        self.modes, self.mode, self.belt, self.centre, self.columns = modes, modes(mode), belt, centre, columns
        self.t, x, v = (c + sum((column[i] * arb(0, 1) for column in columns), arb(0)) for i, c in enumerate(centre))
        self.first = arb_mat([[x], [v], [1], *([u] for u in (arb(self.mode.p["Omega"]) * self.t).sin_cos()[::-1])])
        self.leaves, self.origin, p = leaves or {}, near[0] if near else self.t.lower(), self.mode.p
        self.beside = near[1] if near else (arb.pos_inf(), self.first)
        self.size = p[f"v{belt}"] ** 2 if max(self.leaves.values(), default=0) > 1 and p["c"] == p["B0"] == 0 else size
        self.z0 = (self.mode.M * (self.origin - self.t)).exp() * self.first

    def step(self, t):
        """Return exp of M times the time from `origin` to t, by way of a time beside it where that is known."""
        if not abs(t - self.beside[0]) < NEAR:
            self.beside = t.mid(), (self.mode.M * (t.mid() - self.origin)).exp()
        return (self.mode.M * (t - self.beside[0])).exp() * self.beside[1]

    def f(self, end, t):
        """Return f, f' and f'' at a time."""
        z, i = self.step(t) * self.z0, list(self.mode.ends).index(end)
        return [(row * z)[i, 0] for row in self.mode.rows[:3]]

    def holds(self, state, n, h, falls=None):
        """Say if surely all f > 0 for a time h of at most 2^-n after a state (2 above)."""
        (z, orders, *values), mode, near, sure = state, self.mode, n >= self.mode.least, True
        inside = [(row * (mode.way(n) * z)).entries() for row in mode.rows] if near else []
        for i, (end, f, slope, bend) in enumerate(zip(mode.ends, *values, strict=True)):
            if end in orders:
                sure = sure and near and inside[orders[end]][i] > 0
            elif not (near and end == falls and f > 0 and (inside[1][i] < 0 or inside[2][i] > 0)):
                sure = sure and f > 0 and (near or mode.swing.is_finite()) and f + slope * h - bend * h * h / 2 > 0
        return sure

    def positive(self, until, falls=None):
        """Prove that all f are > 0 after the start, up to a time (2 above); there f > 0 > f' for the end `falls`."""
        mode, a, P, n = self.mode, self.origin, None, self.mode.least
        require(until - self.t, "an event at a time after the one before it")
        for count in range(MOST_STEPS):
            P = P * mode.jump(n) if count % 16 else (mode.M * (a - self.origin)).exp()  # rounding does not add up
            z, left, orders = P * self.z0, until - a, {} if count else self.leaves
            state = z, orders, *((row * z).entries() for row in mode.rows[:2]), mode.bends(z)
            whole = -frexp(float(left.upper()))[1]  # 2^-whole is not less than what is left
            if self.holds(state, whole, left, falls):
                return
            n, sure = max(whole, n - 3), False
            while not sure:
                n, h = n + 1, arb(fmpq(2) ** (-n - 1))
                sure = self.holds(state, n, h) and (not orders or a + h > self.t)
                over = not sure and any(f < 0 for f in (mode.rows[0] * (mode.jump(n) * z)).entries())
                check(not over, "the mode ends before the next event stated, or before t_end")
                check(sure or n < max(whole, 0) + 2 * ctx.prec, "a touch or a near miss", OPEN)
            a += h
        raise Stop(BAD, f"an event or t_end is more than {MOST_STEPS} steps away")

    def behind(self, row, limits=()):
        """Prove that the next event is that of a row, or a touch between two limits; return the motion behind it."""
        mode, p, (kind, belt, source, target, ((first, last), _)) = self.mode, self.mode.p, row
        end, touches, speed = belt if mode.flies else target, kind == "graze", p[f"v{belt}"]
        exact, meets = touches and not limits, mode.flies and (limits or self.size == speed**2)
        right = end in mode.ends and (mode.flies or belt == self.belt)
        check(right and (meets or not touches), "an event at a belt that it is not at, or a graze of no start")
        turn, low, high = 1 if touches else -1, arb(first).lower(), arb(last).upper()
        f, g = self.f(end, low), self.f(end, high)
        while self.columns and not (f[0] > 0 and turn * g[0] > 0):  # the signs are rough
            first, last = 3 * first - 2 * last, 3 * last - 2 * first
            low, high = arb(first).lower(), arb(last).upper()
            f, g, _ = self.f(end, low), self.f(end, high), require(low - self.t, "the signs around an event")
        times = low.union(high)
        inside = {each: self.f(each, times) for each in mode.ends}
        slope, others = inside[end][1 + touches], [inside[each][0] for each in mode.ends if each != end]
        between = (-f[1], *((g[1], abs(arb(speed)) - inside[end][0]) if exact else ())) if touches else ()
        for value in (f[0], turn * g[0], turn * slope, *others, *between):
            require(value, "the signs around an event, and no other one")
        self.positive(low, end)
        least, v, rounds = [], arb(speed), 1 if self.columns and not touches else ctx.prec // 100
        for each in limits if touches else ():  # f'' > 0, so the least f is near f at the zero of f'
            f, rest, _ = each.f(end, sharper(lambda t, each=each: each.f(end, t)[1:], times, slope, rounds).mid())
            least.append(f if f < 0 else f - abs(rest) * (high - low))
        require(-least[0] * least[1] if least else arb(1), "one start that touches, and one that does not")
        when = sharper(lambda t: self.f(end, t)[touches:], times, slope, rounds)
        z, after, leaves = self.step(when) * self.z0, mode.number if touches else end, {belt: 2}
        if mode.flies and not touches:
            F, jump = (mode.M * z)[1, 0], 2 * p[f"mu{end}"] * p["FN"] / p["m"]
            both = F * (F + arb(jump if mode.number > end else -jump))
            require(abs(both), "F at a belt, and behind it")
            after, leaves = (2 * end + 1 - mode.number, {end: 1}) if both > 0 else (3 + end, {})
        made = "slip" if not mode.flies else "stick" if after > 3 else "graze" if touches else "cross"
        check((kind, source, target) == (made, mode.number, after), f"{made}: {MODES[mode.number]} to {MODES[after]}")
        e, rate, columns = self.step(when) * (mode.M * (self.origin - self.t)).exp(), mode.M * self.first, []
        slope, i = self.f(end, when)[1], list(mode.ends).index(end)
        for dt, dx, dv in self.columns:  # a later start is one at the same time with another x and v
            dz = e * arb_mat([[dx - rate[0, 0] * dt], [dv - rate[1, 0] * dt], [0], [0], [0]])
            df = (mode.rows[0] * dz)[i, 0]
            require(abs(df) if touches else arb(1), "that only one start touches")
            columns.append((-df / slope, dz[0, 0] - v * df / slope, arb(0)))
        if not columns or touches:
            return type(self)(self.modes, after, belt, [when, z[0, 0], v], (), leaves)
        centre = Motion(self.modes, mode.number, self.belt, self.centre, near=(self.origin, self.beside))
        then = sharper(lambda t: centre.f(end, t), when, None, 2)
        return type(self)(self.modes, after, belt, [then, (centre.step(then) * centre.z0)[0, 0], v], columns, leaves)


def begin(modes, start, errors):
    """Return the motion from a start. Where F is rational and 0, its first derivative that is not 0 decides."""
    (t0, x0, v0), p, centre = start, modes(1).p, [arb(value) for value in start]
    columns = [[arb(error) if i == j else arb(0) for j in range(3)] for i, error in enumerate(errors) if error]
    if v0 not in (p["v1"], p["v2"]):
        mode, round_ = 1 + (v0 > p["v1"]) + (v0 > p["v2"]), not any(errors) and p["c"] == p["B0"] == 0 < p["k"]
        a = (modes(mode).exact * fmpq_mat([[x0], [v0], [1], [1], [0]]))[1, 0]
        return Motion(modes, mode, 0, centre, columns, {}, v0**2 + a**2 * p["m"] / p["k"] if round_ else None)
    check(errors[2] == 0, "a start on a belt whose velocity is known exactly", OPEN)
    at, found = 1 if v0 == p["v1"] else 2, []
    first = modes(3 + at).rows[0] * Motion(modes, 3 + at, at, centre, columns).first
    for i in (0, 1):
        order, value, z = 0, first[i, 0], fmpq_mat([[x0], [v0], [1], [1], [0]])
        while not any(errors) and (t0 == 0 or p["B0"] == 0) and order < ORDERS and value.contains(0):
            value, z = arb((modes(3 + at).row * z)[i, 0]), modes(3 + at).exact * z
            order += value == 0
        require(abs(value), "F on the belt at the start")
        found.append((1 if value > 0 else -1, order))
    if min(found)[0] > 0:
        return Motion(modes, 3 + at, at, centre, columns, {at + i: n for i, (_, n) in enumerate(found) if n})
    return Motion(modes, at + (found[0][0] > 0), at, centre, columns, {at: found[found[0][0] > 0][1] + 1})


def read_row(row):
    """Return kind, boundary, source, target of an event, and the ends of its t and x."""
    t, x = (number(row[name]) for name in "tx")
    right = row["boundary"] in (1, 2) and all(len(ends) == 2 and ends[0] < ends[1] for ends in (t, x))
    check(right, "an event has a boundary 1 or 2, and a lower and an upper end of t and x", BAD)
    return row["kind"], row["boundary"], *(MODES.index(row[name], 1) for name in ("source", "target")), (t, x)


def trajectory(data):
    """Prove that a motion has the events that are stated, and no others until t_end."""
    p = {name: number(data["parameters"][name]) for name in NAMES}
    start, errors = [number(data["start"][name]) for name in START], number(data["start_error"])
    t_end, starts, rows = number(data["t_end"]), [(start, errors)], [read_row(row) for row in data["events"]]
    positive, others = (p["m"], p["Omega"], p["v2"] - p["v1"], t_end - start[0]), ("c", "k", "mu1", "mu2", "FN")
    right = min(positive) > 0 <= min(*(p[name] for name in others), *errors) and len(errors) == 3
    check(right, "parameters, start_error or t_end out of range", BAD)
    if {"all": False, "some": True}[data["starts"]]:
        i, low, high = START.index(data["free"]["name"]), number(data["free"]["low"]), number(data["free"]["high"])
        check(start[i] - errors[i] <= low < high <= start[i] + errors[i], "a free number within the start's error")
        near = ((low + high) / 2, (high - low) / 2), (low, fmpq(0)), (high, fmpq(0))
        starts = [([*start[:i], s, *start[i + 1 :]], [e * (j == i) for j in range(3)]) for s, e in near]
    modes = cache(lambda i: Mode(p, i))
    motions = [begin(modes, *each) for each in starts]
    check(data["mode"] == MODES[motions[0].mode.number], f"the motion starts in {MODES[motions[0].mode.number]}")
    for row in rows:
        motions = [m.behind(row, motions[1:] * (not i)) for i, m in enumerate(motions) if not i or row[0] != "graze"]
        for value, (low, high) in zip((motions[0].t, motions[0].first[0, 0]), row[-1], strict=True):
            require(value - arb(low), "an event is not above the lower end stated")
            require(arb(high) - value, "an event is not below the upper end stated")
    motions[0].positive(arb(t_end).upper())
    return f"{len(rows)} events until t = {data['t_end']}, for {'all' if len(starts) == 1 else 'some'} starts"


def number(value):
    """Return a number of the file, which is text, as a fraction; and of a list of them all."""
    if isinstance(value, list):
        return [number(each) for each in value]
    found = fmpq(*Fraction(value).as_integer_ratio()) if type(value) is str and NUMBER.fullmatch(value) else None
    right = found is not None and (found == 0 or TINY <= abs(found) <= 1 / TINY)
    check(right, f"{str(value)[:40]!r} is no decimal or fraction between 1e-100 and 1e100", BAD)
    return found


KINDS = {"trajectory": trajectory}


def verify(path):
    """Return an exit code and one line about a file."""
    before, ctx.prec = ctx.prec, 256
    try:
        with open(path, "rb") as file:
            data = json.loads(file.read(3 * 10**7))
        check(data["format"] == "symosc certificate 1" and type(data["proven"]) is bool, "an unknown format", BAD)
        check(data["kind"] in KINDS, f"{str(data['kind'])[:20]!r}: of that kind this checker proves none", BAD)
        most = 4096 if all(error == "0" for error in data.get("start_error", "-")) else 512  # it is not exact then
        while data["proven"]:
            try:
                return 0, f"proven: {KINDS[data['kind']](data)}"
            except Stop as stop:
                if stop.args[0] != OPEN or ctx.prec >= most:
                    raise
            ctx.prec *= 2
        return FALSE, "not proven: the file does not say so"
    except Stop as stop:
        return stop.args[0] or FALSE, ("no certificate: " if stop.args[0] == BAD else "not proven: ") + stop.args[1]
    except (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        return BAD, f"no certificate: {type(error).__name__}, {str(error)[:100]}"
    finally:
        ctx.prec = before


if __name__ == "__main__":
    code, line = verify(sys.argv[1]) if len(sys.argv) == 2 else (BAD, "usage: python verify.py FILE")
    print(" ".join(line.split()), file=sys.stderr if code else sys.stdout)
    sys.exit(code)
