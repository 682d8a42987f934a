#!/usr/bin/env python3
"""Prove a certificate of symosc once more: ``python verify.py FILE``. Needs python-flint and nothing of symosc.

Exit code 0: all that the file states is proven. 1: it is false, or not proven here. 2: the file is no certificate.
The equation is m x'' + c x' + k x = A + B0 cos(Omega t), A being A0 + (mu1 + mu2) FN where v = x' < v1 (Omega1), A0 -
(mu1 - mu2) FN where v1 < v < v2 (Omega2), A0 - (mu1 + mu2) FN where v > v2 (Omega3). F is x'' by it. At a belt, v = v1
or v2, the motion sticks if F > 0 in the domain below and F < 0 in the one above, until one of them is 0; it passes if
both have one sign. A "trajectory" states for a start ("all": all within start_error; "some": one whose free number is
between low and high) that until t_end these are its events, no others, each within its times and positions. It is
proven in balls that contain the exact numbers (arb), with as many bits as it takes:

1. z = (x, v, 1, cos Omega t, sin Omega t) solves z' = M z in each mode, so z(t + s) = exp(s M) z(t). A mode ends when
   a function f = row z reaches 0: the distance of v from a belt, or, on a belt, F below it or -F above it.
2. f > 0 on an interval T around m, of half-width h, if f(m) - |f'(m)| h - |f''(T)| h^2/2 > 0, or if f' < 0 on T and
   f > 0 at its end. After a start in T with f = f' = ... = 0, f > 0 if the next derivative is > 0 on T.
3. In an event one f has different signs at two times, and f' one sign between them; the others are > 0 there.
4. A graze: for all starts from low to high f > 0 at two times, and f'' > 0 between them. There the least f is > 0 for
   one of low and high and < 0 for the other. It is continuous, so for some start between them it is 0. If c = B0 = 0,
   v^2 + v'^2 m/k is constant and often rational: if it is the belt's speed squared, f = 0 where f' becomes > 0.
5. With a start_error the states behind an event are f(centre) + D (start - centre), D the derivatives of all starts.
"""

from __future__ import annotations

import json
import re
import sys
from fractions import Fraction
from math import frexp

from flint import arb, arb_mat, ctx, fmpq, fmpq_mat

NUMBER = re.compile(r"-?\d{1,2000}(/\d{1,2000}|(\.\d{1,2000})?(e[+-]?\d{1,3})?)", re.ASCII)
NAMES = ("m", "c", "k", "A0", "B0", "Omega", "v1", "v2", "mu1", "mu2", "FN")
START = ("t0", "x0", "v0")
MODES = ("", "Omega1", "Omega2", "Omega3", "belt1", "belt2")
MOST_STEPS, SHORT_STEPS, ORDERS, TINY, (OPEN, FALSE, BAD) = 50_000, 1000, 7, Fraction(1, 10**100), range(3)


class Stop(Exception):
    """An end without a proof: OPEN (more bits may decide it), FALSE (or not proven here), BAD (no certificate)."""


def require(value, what):
    """Go on only if all numbers in a ball are > 0."""
    if not value > 0:
        raise Stop(FALSE if value < 0 else OPEN, what)


def sharper(f, found, slope, rounds):
    """Return a sharper enclosure of the zero of f in `found`, where f' is in `slope` (interval Newton)."""
    for _ in range(rounds):
        step = found.mid() - f(found.mid())[0] / slope
        if not step.overlaps(found):
            raise Stop(OPEN, "where an event is")
        found = step.intersection(found)
    return found


class Mode:
    """One mode of an oscillator: z' = M z, and for each f that ends it rows with f = rows[0] z, f' = rows[1] z, ..."""

    def __init__(self, p, mode):
        m, c, k, A0, B0, Om, *_, mu1, mu2, FN = (p[name] for name in NAMES)
        friction = {1: mu1 + mu2, 2: mu2 - mu1, 3: -mu1 - mu2}
        F = {i: [q / m for q in (-k, -c, A0 + friction[i] * FN, B0, fmpq(0))] for i in friction}
        self.p, self.number, self.flies, self.powers = p, mode, mode < 4, {}
        if self.flies:  # the distance from each belt around the domain
            self.ends = {i: [0, s, -s * p[f"v{i}"], 0, 0] for i, s in ((mode - 1, 1), (mode, -1)) if i in (1, 2)}
        else:  # F below the belt, and -F above it
            self.ends = {mode - 3: F[mode - 3], mode - 2: [-q for q in F[mode - 2]]}
        self.exact = fmpq_mat([[0, 1, 0, 0, 0], F.get(mode, [0] * 5), [0] * 5, [0, 0, 0, 0, -Om], [0, 0, 0, Om, 0]])
        self.M, ends = arb_mat(self.exact), fmpq_mat(list(self.ends.values()))
        self.rows = [arb_mat(ends * self.exact**order) for order in range(ORDERS)]
        # |f''| after a time is at most `swing` + the sum of |calm z| there: a steady motion, and one that decays.
        q, a, b, w0 = (c / m / 2) ** 2 - k / m, k - m * Om * Om, c * Om, arb(k / m).sqrt()
        self.calm, self.swing, self.rate = arb_mat(1, 5), arb(abs(B0) * Om * Om / m), arb(Om)
        if self.flies:
            self.rate = arb(Om + c / m) + w0
            if q == 0 or a == b == 0:
                self.swing = arb.pos_inf()
            else:
                gain, h, w = B0 * Om / (a * a + b * b), arb(c / m / 2), arb(abs(q)).sqrt()
                y = arb_mat(fmpq_mat([[0, 1, 0, -gain * b, gain * a]]))  # v less the steady one
                slow, fast = (w - h, -w - h) if q > 0 else (arb(0), arb(0))
                pair = [(y * self.M - y * fast) * (slow * slow / w), (y * self.M - y * slow) * (fast * fast / w)]
                pair = [row / 2 for row in pair] if q > 0 else [y * (k / m), (y * self.M + y * h) / w * (k / m)]
                self.calm = arb_mat([[row[0, i] for i in range(5)] for row in pair])
                self.swing = arb(abs(gain) * Om * Om) * arb(a * a + b * b).sqrt()


class Motion:
    """A motion in one mode from starts t, x, v on, a centre + D [-1, 1]; f that are 0 there have `leaves`: orders."""

    def __init__(self, modes, mode, belt, centre, columns=(), leaves=None, size=None):
        self.modes, self.mode, self.belt, self.leaves = modes, modes[mode], belt, leaves or {}
        self.centre, self.columns, self.last = centre, columns, (None, None)
        self.t, x, v = (c + sum((column[i] * arb(0, 1) for column in columns), arb(0)) for i, c in enumerate(centre))
        s, c = (arb(self.mode.p["Omega"]) * self.t).sin_cos()
        self.first, self.origin, p = arb_mat([[x], [v], [1], [c], [s]]), self.t.lower(), self.mode.p
        self.size = p[f"v{belt}"] ** 2 if max(self.leaves.values(), default=0) > 1 and p["c"] == p["B0"] == 0 else size
        self.z0 = (self.mode.M * (self.origin - self.t)).exp() * self.first

    def step(self, t):
        """Return exp of M times the time from `origin` to t; the large part of that time is exact."""
        if self.last[0] is not t:
            step = (self.mode.M * (t.mid() - self.origin)).exp()
            self.last = t, step if t.is_exact() else (self.mode.M * (t - t.mid())).exp() * step
        return self.last[1]

    def f(self, end, t):
        """Return f, f' and f'' at a time."""
        z, i = self.step(t) * self.z0, list(self.mode.ends).index(end)
        return [(row * z)[i, 0] for row in self.mode.rows[:3]]

    def positive(self, until):
        """Prove that all f are > 0 after the start, up to a time (2 above)."""
        mode, a, P, n, leaves = self.mode, self.origin, None, frexp(float(self.mode.rate))[1], self.leaves
        require(until - self.t, "an event at a time after the one before it")
        for step in range(MOST_STEPS):
            P = P if step % 16 else self.step(a)  # rounding errors do not add up
            last = not a + arb(fmpq(2) ** (1 - n)) < until
            h = (until - a) / 2 if last else arb(fmpq(2) ** -n)
            if last or n not in mode.powers:
                mode.powers[None if last else n] = (mode.M * h).exp(), (mode.M * arb(0, h.upper())).exp()
            whole, near = mode.powers[None if last else n]
            half = whole * P
            z = half * self.z0
            inside, after, all_sure = near * z, whole * z, a > self.origin or a + 2 * h >= self.t
            values = [mode.rows[k] * y for k, y in ((0, z), (1, z), (2, inside), (1, inside), (0, after))]
            calm = mode.swing + sum(abs(each) for each in (mode.calm * P * self.z0).entries())
            for i, end in enumerate(mode.ends):
                value = [each[i, 0] for each in values]
                bend = abs(value[2]) if abs(value[2]) < calm else calm
                sure = value[0] - abs(value[1]) * h - bend * h * h / 2 > 0 or (value[3] < 0 and value[4] > 0)
                if end in leaves:
                    sure = (mode.rows[leaves[end]] * inside)[i, 0] > 0
                elif value[4] < 0:
                    raise Stop(FALSE, "the mode ends before the next event stated, or before t_end")
                all_sure = all_sure and sure
            if all_sure and last:
                return
            if all_sure:
                a, P, n, leaves = a + 2 * h, whole * half, n - 1, {}
            else:
                n = max(n, -frexp(float(h))[1]) + 1
            if n > 2 * ctx.prec or (2 * n > ctx.prec and step > SHORT_STEPS):  # short for want of bits
                raise Stop(OPEN, "a touch or a near miss")
        raise Stop(BAD, f"an event or t_end is more than {MOST_STEPS} steps away")

    def behind(self, row, limits=()):
        """Prove that the next event is that of a row, or a touch between two limits; return the motion behind it."""
        mode, p, (kind, belt, source, target, ((first, last), _)) = self.mode, self.mode.p, row
        end, touches, speed = belt if mode.flies else target, kind == "graze", p[f"v{belt}"]
        exact, meets = touches and not limits, mode.flies and (limits or self.size == speed**2)
        if end not in mode.ends or not (mode.flies or belt == self.belt) or (touches and not meets):
            raise Stop(FALSE, "an event at a belt that the motion is not at, or a graze of no start")
        turn, low, high = 1 if touches else -1, arb(first).lower(), arb(last).upper()
        f, g = self.f(end, low), self.f(end, high)
        while self.columns and not (f[0] > 0 and turn * g[0] > 0):  # the signs are rough
            first, last = 3 * first - 2 * last, 3 * last - 2 * first
            low, high = arb(first).lower(), arb(last).upper()
            f, g, _ = self.f(end, low), self.f(end, high), require(low - self.t, "the signs around an event")
        times = low.union(high)
        inside = {each: self.f(each, times) for each in mode.ends}
        slope, others = inside[end][1 + touches], [inside[each][0] for each in mode.ends if each != end]
        between = (-f[1], g[1], abs(arb(speed)) - inside[end][0]) if exact else ()
        for value in (f[0], turn * g[0], turn * slope, *others, *between):
            require(value, "the signs around an event, and no other one")
        self.positive(low)
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
        if (kind, source, target) != (made, mode.number, after):
            raise Stop(FALSE, f"a {kind} that is a {made} from {MODES[mode.number]} to {MODES[after]}")
        if not self.columns or touches:
            return type(self)(self.modes, after, belt, [when, z[0, 0], v], (), leaves)
        centre = Motion(self.modes, mode.number, self.belt, self.centre)
        slope, rate, columns = self.f(end, when)[1], mode.M * self.first, []
        then = sharper(lambda t: centre.f(end, t), when, slope, rounds)
        e = self.step(when) * (mode.M * (self.origin - self.t)).exp()
        for dt, dx, dv in self.columns:  # a later start is one at the same time with another x and v
            dz = e * arb_mat([[dx - rate[0, 0] * dt], [dv - rate[1, 0] * dt], [0], [0], [0]])
            late = -(mode.rows[0] * dz)[list(mode.ends).index(end), 0] / slope
            columns.append((late, dz[0, 0] + v * late, arb(0)))
        return type(self)(self.modes, after, belt, [then, (centre.step(then) * centre.z0)[0, 0], v], columns, leaves)


def begin(p, start, errors):
    """Return the motion from a start. Where F is rational and 0, its first derivative that is not 0 decides."""
    t0, x0, v0 = start
    modes, centre = {i: Mode(p, i) for i in (1, 2, 3, 4, 5)}, [arb(value) for value in start]
    columns = [[arb(error) if i == j else arb(0) for j in range(3)] for i, error in enumerate(errors) if error]
    if v0 not in (p["v1"], p["v2"]):
        mode, round_ = 1 + (v0 > p["v1"]) + (v0 > p["v2"]), not any(errors) and p["c"] == p["B0"] == 0 < p["k"]
        a = (modes[mode].exact * fmpq_mat([[x0], [v0], [1], [1], [0]]))[1, 0]
        return Motion(modes, mode, 0, centre, columns, {}, v0**2 + a**2 * p["m"] / p["k"] if round_ else None)
    require(arb(errors[2] == 0) - arb(0.5), "a start on a belt whose velocity is known exactly")
    at, found = 1 if v0 == p["v1"] else 2, []
    row = fmpq_mat(list(modes[3 + at].ends.values()))
    first = modes[3 + at].rows[0] * Motion(modes, 3 + at, at, centre, columns).first
    for i in (0, 1):
        order, value, z = 0, first[i, 0], fmpq_mat([[x0], [v0], [1], [1], [0]])
        while not any(errors) and (t0 == 0 or p["B0"] == 0) and order < ORDERS and value.contains(0):
            value, z = arb((row * z)[i, 0]), modes[3 + at].exact * z
            order += value == 0
        require(abs(value), "F on the belt at the start")
        found.append((1 if value > 0 else -1, order))
    if min(found)[0] > 0:
        return Motion(modes, 3 + at, at, centre, columns, {at + i: n for i, (_, n) in enumerate(found) if n})
    return Motion(modes, at + (found[0][0] > 0), at, centre, columns, {at: found[found[0][0] > 0][1] + 1})


def read_row(row):
    """Return kind, boundary, source, target of an event, and the ends of its t and x."""
    t, x = (number(row[name]) for name in "tx")
    if row["boundary"] not in (1, 2) or not all(len(ends) == 2 and ends[0] < ends[1] for ends in (t, x)):
        raise Stop(BAD, "an event has a boundary 1 or 2, and a lower and an upper end of t and x")
    return row["kind"], row["boundary"], *(MODES.index(row[name], 1) for name in ("source", "target")), (t, x)


def trajectory(data):
    """Prove that a motion has the events that are stated, and no others until t_end."""
    p = {name: number(data["parameters"][name]) for name in NAMES}
    start, errors = [number(data["start"][name]) for name in START], number(data["start_error"])
    t_end, starts, rows = number(data["t_end"]), [(start, errors)], [read_row(row) for row in data["events"]]
    positive, others = (p["m"], p["Omega"], p["v2"] - p["v1"], t_end - start[0]), ("c", "k", "mu1", "mu2", "FN")
    if min(positive) <= 0 or min(*(p[name] for name in others), *errors) < 0 or len(errors) != 3:
        raise Stop(BAD, "parameters, start_error or t_end out of range")
    if data["starts"] != "all":
        i, low, high = START.index(data["free"]["name"]), number(data["free"]["low"]), number(data["free"]["high"])
        if not start[i] - errors[i] <= low < high <= start[i] + errors[i]:
            raise Stop(FALSE, "the free number leaves the error of the start")
        near = ((low + high) / 2, (high - low) / 2), (low, fmpq(0)), (high, fmpq(0))
        starts = [([*start[:i], s, *start[i + 1 :]], [e * (j == i) for j in range(3)]) for s, e in near]
    motions = [begin(p, *each) for each in starts]
    if data["mode"] != MODES[motions[0].mode.number]:
        raise Stop(FALSE, f"the motion starts in {MODES[motions[0].mode.number]}")
    for row in rows:
        if row[-1][0][1] >= t_end:
            raise Stop(FALSE, "an event after t_end")
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
    if type(value) is not str or not NUMBER.fullmatch(value) or not TINY <= abs(Fraction(value) or TINY) <= 1 / TINY:
        raise Stop(BAD, f"{str(value)[:40]!r} is no decimal or fraction between 1e-100 and 1e100")
    return fmpq(*Fraction(value).as_integer_ratio())


KINDS = {"trajectory": trajectory}


def verify(path):
    """Return an exit code and one line about a file."""
    before, ctx.prec = ctx.prec, 256
    try:
        with open(path, "rb") as file:
            data = json.loads(file.read(10**8))
        if data["format"] != "symosc certificate 1" or type(data["proven"]) is not bool:
            raise Stop(BAD, "an unknown format")
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
