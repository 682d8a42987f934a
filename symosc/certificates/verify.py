#!/usr/bin/env python3
"""Prove a certificate of symosc once more: ``python verify.py FILE``. Needs python-flint and nothing of symosc.

Exit code 0: all that the file states is proven. 1: it is false, or not proven here. 2: the file is no certificate.

The equation is m x'' + c x' + k x = A + B0 cos(Omega t), with A = A0 + (mu1 + mu2) FN where v = x' < v1 (Omega1),
A0 - (mu1 - mu2) FN where v1 < v < v2 (Omega2), A0 - (mu1 + mu2) FN where v > v2 (Omega3). F is x'' by it. At a belt,
v = v1 or v2, the motion sticks if F > 0 in the domain below and F < 0 in the one above, until one of them is 0; it
passes if both have one sign. A "trajectory" states for a start ("all": for all within start_error; "some": for one
whose free number is between low and high) that until t_end these are its events, no others, each within its times and
positions. It is proven from the start on, in balls that contain the exact numbers (arb), with as many bits as it takes:

1. z = (x, v, 1, cos Omega t, sin Omega t) solves z' = M z in each mode, so z(t + s) = exp(s M) z(t). What ends a mode is
   that a function f = row z reaches 0: the distance of v from a belt, or, on a belt, F below it or -F above it.
2. f > 0 on an interval T around m, of half-width h, if f(m) - |f'(m)| h - |f''(T)| h^2/2 > 0, or if f' < 0 on T and
   f > 0 at its end. After a start in T with f = f' = ... = 0, f > 0 if the next derivative is > 0 on T. Such intervals
   side by side, halved where they must be, show that nothing ends the mode before an event.
3. In the event one f has different signs at the two times stated, and f' one sign between them; the others are > 0.
4. A graze: for all starts from low to high f > 0 at the two times, and f'' > 0 between. There the least f is > 0 for
   one of low and high and < 0 for the other. It is continuous, so for some start between them it is 0.
5. With a start_error the states behind an event are f(centre) + D (start - centre), D the derivatives of all starts.
"""

from __future__ import annotations

import json
import re
import sys
from fractions import Fraction
from math import frexp

from flint import arb, arb_mat, ctx, fmpq

NUMBER = re.compile(r"-?\d{1,2000}(/\d{1,2000}|(\.\d{1,2000})?(e[+-]?\d{1,3})?)", re.ASCII)
NAMES = ("m", "c", "k", "A0", "B0", "Omega", "v1", "v2", "mu1", "mu2", "FN")
MODES = ("", "Omega1", "Omega2", "Omega3", "belt1", "belt2")
MOST_BYTES, MOST_STEPS, FIRST_BITS, MOST_BITS, ORDERS, LARGEST = 10**8, 200_000, 128, 8192, 7, 10**60
OPEN, FALSE, BAD = 0, 1, 2


class Stop(Exception):
    """An end without a proof: OPEN (more bits may decide it), FALSE (or not proven here), BAD (no certificate)."""


def require(value, what):
    """Go on only if all numbers in a ball are > 0."""
    if not value > 0:
        raise Stop(FALSE if value < 0 else OPEN, what)


def sign(value, what):
    """Return the sign of all numbers in a ball."""
    require(abs(value), what)
    return 1 if value > 0 else -1


def ball(number, high=None):
    """Return an enclosure of a fraction, or of all numbers between two."""
    if high is not None:
        return ball((number + high) / 2) + arb(0, ball((high - number) / 2).upper())
    return arb(fmpq(number.numerator, number.denominator))


class Mode:
    """One mode of an oscillator: z' = M z, and for each f that ends it rows with f = rows[0] z, f' = rows[1] z, ..."""

    def __init__(self, p, mode):
        friction = {1: p["mu1"] + p["mu2"], 2: p["mu2"] - p["mu1"], 3: -p["mu1"] - p["mu2"]}
        forces = {i: [-p["k"], -p["c"], p["A0"] + friction[i] * p["FN"], p["B0"], 0] for i in friction}
        F = {i: [Fraction(q, p["m"]) for q in row] for i, row in forces.items()}
        self.p, self.number, self.flies, self.powers = p, mode, mode < 4, {}
        if self.flies:  # the distance from each belt around the domain
            sides = {i: 1 if mode > i else -1 for i in (1, 2) if mode - i in (0, 1)}
            self.ends = {i: [0, side, -side * p[f"v{i}"], 0, 0] for i, side in sides.items()}
        else:  # F below the belt, and -F above it
            self.ends = {mode - 3: F[mode - 3], mode - 2: [-q for q in F[mode - 2]]}
        self.exact = [[0, 1, 0, 0, 0], F[mode] if self.flies else [0] * 5, [0] * 5]
        self.exact += [[0, 0, 0, 0, -p["Omega"]], [0, 0, 0, p["Omega"], 0]]
        self.M, row = (arb_mat([[ball(q) for q in row] for row in rows]) for rows in (self.exact, self.ends.values()))
        self.rows = [row]
        while len(self.rows) < ORDERS:
            self.rows.append(self.rows[-1] * self.M)
        self.halvings = frexp(float(p["Omega"] + p["c"] / p["m"]) + float(p["k"] / p["m"]) ** 0.5)[1]

    def powers_of(self, n):
        """Return h = 2**-n, exp(h M), and an enclosure of exp(s M) for all |s| <= h."""
        if n not in self.powers:
            h = ball(Fraction(2) ** -n)
            self.powers[n] = h, (self.M * h).exp(), (self.M * arb(0, h)).exp()
        return self.powers[n]


class State:
    """Where a motion is: mode, belt, t, x, v of all its starts (a centre and D times [-1, 1]), and which f leave 0.

    `leaves` says of an f that is 0 at the start which derivative is the first that is not.
    """

    def __init__(self, mode, belt, centre, columns=(), leaves=None):
        self.mode, self.belt, self.centre, self.columns, self.leaves = mode, belt, centre, columns, leaves or {}
        self.hull = [c + sum((column[i] * arb(0, 1) for column in columns), arb(0)) for i, c in enumerate(centre)]


class Motion:
    """The motion in one mode, from a ball of starts t, x, v."""

    def __init__(self, mode, start):
        self.mode, (self.t, x, v) = mode, start
        s, c = (ball(mode.p["Omega"]) * self.t).sin_cos()
        self.first, self.origin = arb_mat([[x], [v], [1], [c], [s]]), self.t.lower()
        self.z0 = (mode.M * (self.origin - self.t)).exp() * self.first

    def step(self, t):
        """Return exp of M times the time from `origin` to t; the large part of that time is exact."""
        step = (self.mode.M * (t.mid() - self.origin)).exp()
        return step if t.is_exact() else (self.mode.M * (t - t.mid())).exp() * step

    def f(self, end, t):
        """Return f, f' and f'' at a time."""
        z, i = self.step(t) * self.z0, list(self.mode.ends).index(end)
        return [(row * z)[i, 0] for row in self.mode.rows[:3]]

    def positive(self, until, leaves):
        """Prove that all f are > 0 after the start, up to a time (2 above)."""
        mode, a, P, n, begins = self.mode, self.origin, self.step(self.origin), self.mode.halvings, True
        for _ in range(MOST_STEPS):
            h, whole, near = mode.powers_of(n)
            last = not a + 2 * h < until
            if last:
                h = (until - a) / 2
                whole, near = (mode.M * h).exp(), (mode.M * arb(0, h.upper())).exp()
            middle = whole * P
            z, b = middle * self.z0, a + 2 * h
            if (not begins or b >= self.t) and self._positive(z, near * z, whole * z, h, leaves if begins else {}):
                if last:
                    return
                a, P, n, begins = b, whole * middle, max(n - 1, mode.halvings - 2), False
            else:
                n = max(n, -frexp(float(h))[1]) + 1
            if n > 2 * ctx.prec:
                raise Stop(OPEN, "a touch or a near miss")
        raise Stop(BAD, f"an event or t_end is more than {MOST_STEPS} steps away")

    def _positive(self, z, inside, after, h, leaves):
        rows = self.mode.rows
        f, slope, bend, falls, f_after = rows[0] * z, rows[1] * z, rows[2] * inside, rows[1] * inside, rows[0] * after
        for i, end in enumerate(self.mode.ends):
            if end in leaves:
                sure = (rows[leaves[end]] * inside)[i, 0] > 0
            elif f_after[i, 0] < 0:
                raise Stop(FALSE, "the mode ends before the next event stated, or before t_end")
            else:
                least = f[i, 0] - abs(slope[i, 0]) * h - abs(bend[i, 0]) * h * h / 2
                sure = least > 0 or (falls[i, 0] < 0 and f_after[i, 0] > 0)
            if not sure:
                return False
        return True


def sharper(f, found, slope):
    """Return a sharper enclosure of the zero of f in `found`, where f' is in `slope` (interval Newton)."""
    for _ in range(2):
        step = found.mid() - f(found.mid())[0] / slope
        if not step.overlaps(found):
            raise Stop(OPEN, "where an event is")
        found = step.intersection(found)
    return found


def next_state(modes, state, row):
    """Prove that the next event is that of a row: its end of the mode, between its times; return the state behind it."""
    mode, (low, high, times) = modes[state.mode], row.t
    motion, end, p = Motion(mode, state.hull), row.belt if mode.flies else row.target, mode.p
    if end not in mode.ends or not (mode.flies or row.belt == state.belt):
        raise Stop(FALSE, "an event at a belt that the motion is not at")
    require(motion.f(end, low)[0], "an event is not before its first time")
    require(-motion.f(end, high)[0], "an event is not after its last time")
    slope = motion.f(end, times)[1]
    require(-slope, "f falls in an event")
    motion.positive(low, state.leaves)
    for other in mode.ends:
        require(motion.f(other, times)[0] if other != end else arb(1), "no other event at the same time")
    when, v, after = sharper(lambda t: motion.f(end, t), times, slope), ball(p[f"v{row.belt}"]), end
    step, leaves = motion.step(when), {row.belt: 2}
    z = step * motion.z0
    if mode.flies:
        F, jump = (mode.M * z)[1, 0], 2 * p[f"mu{end}"] * p["FN"] / p["m"]
        behind = F + ball(jump if state.mode > end else -jump)
        passes = jump == 0 or sign(behind, "F behind a belt") == sign(F, "F at a belt")
        after, leaves = (2 * end + 1 - state.mode, {end: 1}) if passes else (3 + end, {})
    if not state.columns:
        return State(after, row.belt, [when, z[0, 0], v], (), leaves)
    centre, e = Motion(mode, state.centre), step * (mode.M * (motion.origin - motion.t)).exp()
    then, rate, columns = sharper(lambda t: centre.f(end, t), when, slope), mode.M * motion.first, []
    for dt, dx, dv in state.columns:  # a later start is one at the same time with another x and v
        dz = e * arb_mat([[dx - rate[0, 0] * dt], [dv - rate[1, 0] * dt], [0], [0], [0]])
        late = -(mode.rows[0] * dz)[list(mode.ends).index(end), 0] / slope
        columns.append((late, dz[0, 0] + v * late, arb(0)))
    return State(after, row.belt, [then, (centre.step(then) * centre.z0)[0, 0], v], columns, leaves)


def graze(modes, states, row):
    """Prove that some start touches the belt of a row between its times, and that nothing is before; return the state."""
    (state, *limits), (low, high, times) = states, row.t
    mode, motion = modes[state.mode], Motion(modes[state.mode], state.hull)
    if len(limits) != 2 or not mode.flies or row.belt not in mode.ends:
        raise Stop(FALSE, "a graze that no start is said to have")
    bend = motion.f(row.belt, times)[2]
    for value in (motion.f(row.belt, low)[0], motion.f(row.belt, high)[0], bend):
        require(value, "f > 0 beside a touch, and f'' > 0 in it")
    motion.positive(low, state.leaves)
    for other in mode.ends:
        require(motion.f(other, times)[0] if other != row.belt else arb(1), "no other event at the same time")
    least = []
    for flight in (Motion(mode, each.hull) for each in limits):
        middle = sharper(lambda t, flight=flight: flight.f(row.belt, t)[1:], times, bend).mid()
        f, slope, _ = flight.f(row.belt, middle)
        least.append(sign(f if f < 0 else f - abs(slope) * (high - low), "a start that touches or nearly"))
    if sum(least) != 0:
        raise Stop(FALSE, "a graze between two starts that both touch, or both do not")
    when = sharper(lambda t: motion.f(row.belt, t)[1:], times, bend)
    z = motion.step(when) * motion.z0
    return State(state.mode, row.belt, [when, z[0, 0], ball(mode.p[f"v{row.belt}"])], (), {row.belt: 2})


def first_state(modes, start, errors):
    """Return the state that a motion begins with. Where F is rational and 0, its first derivative that is not decides."""
    p, (t0, x0, v0) = modes[1].p, start
    columns = [[ball(error) if i == j else arb(0) for j in range(3)] for i, error in enumerate(errors) if error]
    at, centre = next((belt for belt in (1, 2) if v0 == p[f"v{belt}"]), 0), [ball(value) for value in start]
    if not at:
        return State(1 + (v0 > p["v1"]) + (v0 > p["v2"]), 0, centre, columns)
    if errors[2]:
        raise Stop(FALSE, "a start on a belt whose velocity is not known exactly")
    belt, signs, orders = modes[3 + at], [], []
    first = belt.rows[0] * Motion(belt, State(3 + at, at, centre, columns).hull).first
    for i, row in enumerate(belt.ends.values()):
        order, value, z = 0, first[i, 0], [x0, v0, 1, 1, 0]
        while not any(errors) and (t0 == 0 or p["B0"] == 0) and order < ORDERS and value.contains(0):
            value = ball(sum(q * each for q, each in zip(row, z)))
            z, order = [sum(q * each for q, each in zip(line, z)) for line in belt.exact], order + (value == 0)
        signs.append(sign(value, "F on the belt at the start"))
        orders.append(order)
    if min(signs) > 0:
        return State(3 + at, at, centre, columns, {at + i: order for i, order in enumerate(orders) if order})
    out = signs.index(-1)
    return State(at + out, at, centre, columns, {at: orders[out] + 1})


class Row:
    """An event as the file states it."""

    def __init__(self, row):
        self.kind, self.belt = row["kind"], row["boundary"]
        self.source, self.target = (MODES.index(row[name], 1) for name in ("source", "target"))
        ends = [[number(value) for value in row[name]] for name in "tx"]
        if type(self.belt) is not int or self.belt not in (1, 2) or not all(len(e) == 2 and e[0] < e[1] for e in ends):
            raise Stop(BAD, "an event has a boundary 1 or 2, and a lower and an upper end of t and x")
        self.stated = ends
        low, high = ball(ends[0][0]).lower(), ball(ends[0][1]).upper()
        self.t = low, high, low.union(high)

    def check(self, state, after):
        """Prove that what was found is what the row states."""
        kind = (
            "slip"
            if state.mode > 3
            else "stick"
            if after.mode > 3
            else "cross"
            if after.mode != state.mode
            else "graze"
        )
        if (self.kind, self.source, self.target, self.belt) != (kind, state.mode, after.mode, after.belt):
            raise Stop(FALSE, f"a {self.kind} that is a {kind} from {MODES[state.mode]} to {MODES[after.mode]}")
        for value, (low, high) in zip(after.hull, self.stated):
            require(value - ball(low), "an event is not above the lower end stated")
            require(ball(high) - value, "an event is not below the upper end stated")


def trajectory(data):
    """Prove that a motion has the events that are stated, and no others until t_end."""
    p = {name: number(data["parameters"][name]) for name in NAMES}
    start, errors = [number(data["start"][i]) for i in ("t0", "x0", "v0")], [number(e) for e in data["start_error"]]
    t_end, starts, rows = number(data["t_end"]), [start], [Row(row) for row in data["events"]]
    lawful = min(p["m"], p["Omega"], p["v2"] - p["v1"], t_end - start[0]) > 0 and len(errors) == 3
    if not lawful or min(*(p[i] for i in ("c", "k", "mu1", "mu2", "FN")), *errors) < 0:
        raise Stop(BAD, "parameters, start_error or t_end out of range")
    if data["starts"] == "some":
        free, i = data["free"], ("t0", "x0", "v0").index(data["free"]["name"])
        low, high = number(free["low"]), number(free["high"])
        if not start[i] - errors[i] <= low < high <= start[i] + errors[i]:
            raise Stop(FALSE, "the free number leaves the error of the start")
        starts = [[*start[:i], value, *start[i + 1 :]] for value in ((low + high) / 2, low, high)]
        errors = [(high - low) / 2 if j == i else Fraction(0) for j in range(3)]
    elif data["starts"] != "all":
        raise Stop(BAD, "starts are all or some")
    modes = {i: Mode(p, i) for i in (1, 2, 3, 4, 5)}
    states = [first_state(modes, each, [0, 0, 0] if n else errors) for n, each in enumerate(starts)]
    if data["mode"] != MODES[states[0].mode]:
        raise Stop(FALSE, f"the motion starts in {MODES[states[0].mode]}")
    for row in rows:
        if row.stated[0][1] >= t_end:
            raise Stop(FALSE, "an event after t_end")
        after = [graze(modes, states, row)] if row.kind == "graze" else [next_state(modes, s, row) for s in states]
        row.check(states[0], after[0])
        states = after
    Motion(modes[states[0].mode], states[0].hull).positive(ball(t_end).upper(), states[0].leaves)
    return f"{len(rows)} events until t = {data['t_end']}, for {data['starts']} starts"


def number(value):
    """Return a number of the file, which is text, as a fraction."""
    if not isinstance(value, str) or not NUMBER.fullmatch(value) or abs(Fraction(value)) > LARGEST:
        raise Stop(BAD, f"{str(value)[:40]!r} is no decimal or fraction within 1e60")
    return Fraction(value)


KINDS = {"trajectory": trajectory}


def verify(path):
    """Return an exit code and one line about a file."""
    before = ctx.prec
    try:
        with open(path, "rb") as file:
            data = json.loads(file.read(MOST_BYTES))
        if data["format"] != "symosc certificate 1" or data["kind"] not in KINDS or type(data["proven"]) is not bool:
            raise Stop(BAD, "an unknown format or kind")
        if not data["proven"]:
            raise Stop(FALSE, "it does not say that it is proven")
        ctx.prec = FIRST_BITS
        while True:
            try:
                return 0, "proven: " + KINDS[data["kind"]](data)
            except Stop as stop:
                if stop.args[0] != OPEN or ctx.prec >= MOST_BITS:
                    raise
            ctx.prec *= 2
    except Stop as stop:
        code, what = stop.args
        return (BAD, f"no certificate: {what}") if code == BAD else (FALSE, f"not proven: {what}")
    except (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        return BAD, f"no certificate: {type(error).__name__}, {str(error)[:100]}"
    finally:
        ctx.prec = before


if __name__ == "__main__":
    code, line = verify(sys.argv[1]) if len(sys.argv) == 2 else (BAD, "usage: python verify.py FILE")
    print(" ".join(line.split()), file=sys.stderr if code else sys.stdout)
    sys.exit(code)
