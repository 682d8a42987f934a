#!/usr/bin/env python3
"""Prove a certificate of an orbit or a window once more: ``python verify_orbits.py FILE``.

Needs verify.py beside it, python-flint, and nothing of symosc. verify.py has the equation and how a motion is followed
from event to event, for all starts of a box at once: an orbit is such motions, and a fixed point of them. So it is not
written again here; the rest is too much for one file that can be read at a sitting.

An "orbit" states events, the last of them the first one again, `periods` periods of the drive later. It is a periodic
motion, within the times and positions stated, and the only one that starts within `alone_within` (of t, and of x) about
the middle of the first. Let P be the motion from the times and positions at the first event to those at the last, less
the periods, and D its derivatives over a box c + [-e, e]. A fixed point c + u has u = (P(c) - c) + D u (mean value
theorem). So

1. if the solution w of (1 - D) w = P(c) - c is unique and lies in [-e, e], for all matrices in the ball D, there is
   exactly one fixed point in the box, and it is in c + w (interval Newton). It is done for the box stated, where events
   may be off by `reach`, and again for a small box around the fixed point, where the events have to be where stated.
2. The multipliers are the eigenvalues of D at the fixed point: the roots of z^2 - T z + d, with its trace T and its
   determinant d (0 if the motion sticks). Both are inside the unit circle if and only if |d| < 1 and |T| < 1 + d.

A "window" states at which phases theta = Omega t a motion that meets a belt with F = 0 turns back there: with g as in
verify.py, g = g' = 0 at the contact, and m g'' = s, s = side (k v + B0 Omega sin theta), side = 1 below the belt and -1
above it. It grazes where s > 0, not where s < 0. At a zero of s with cos theta != 0 the third derivative is not 0 and
the motion passes. Where |k v| = |B0| Omega, s = 0 at one phase, and m times the fourth derivative is Omega^2 side k v:
its sign decides in the "full" order; in the "paper" order nothing grazes at that phase.
"""

import sys
from functools import cache
from importlib import import_module
from itertools import pairwise

from flint import arb, arb_mat, arb_series, fmpq

try:
    base = import_module(".verify" if __package__ else "verify", __package__)
except ImportError as error:
    print(f"no certificate was read: verify.py has to be beside verify_orbits.py ({error})", file=sys.stderr)
    sys.exit(2)
Stop, OPEN, FALSE, BAD = base.Stop, base.OPEN, base.FALSE, base.BAD
check, require, number, verify, MODES = base.check, base.require, base.number, base.verify, base.MODES

PIECES = ((1, 4, 1), (1, 1, 1), (1, 2, 1), (2, 5, 2), (2, 2, 2), (2, 3, 2), (2, 2, 1), (1, 2, 2))  # from, mode, to
LABELS = {piece: number for number, piece in enumerate(PIECES, 1)}
ALL_BUT_ONE, MOST_PARTS, SMALL, KNOWN = "everywhere but at one phase", 2_000, fmpq(1, 10**15), 1e-16


def parameters(data):
    """Return the parameters of a file."""
    p = {name: number(data["parameters"][name]) for name in base.NAMES}
    if min(p["m"], p["Omega"], p["v2"] - p["v1"]) <= 0 or min(p[name] for name in ("c", "k", "mu1", "mu2", "FN")) < 0:
        raise Stop(BAD, "parameters out of range")
    return p


def read(data):
    """Return parameters, rows and the number of periods of an orbit; refuse a word that is not that of the rows."""
    p = parameters(data)
    periods, rows = data["periods"], data["events"]
    if type(periods) is not int or not 0 < periods < 10_000 or len(rows) < 2:
        raise Stop(BAD, "a number of periods and two events at least")
    modes = [(row["boundary"], MODES.index(row["target"], 1)) for row in rows]
    labels = [LABELS.get((belt, mode, after[0])) for (belt, mode), after in pairwise(modes)]
    word, found = data["word"], "".join(map(str, reversed(labels)))
    if word[0] != "P" or len(word) != len(found) + 1 or word[1:] not in found * 2:
        raise Stop(FALSE, f"the word {word[:40]}, of events that say {found[:40]}")
    return p, rows, periods


def chain(rows):
    """Return kind, boundary, source and target of events, if they follow each other and come back to the first."""
    found = [(r["kind"], r["boundary"], *(MODES.index(r[name], 1) for name in ("source", "target"))) for r in rows]
    for before, (kind, belt, source, target) in pairwise(found):
        made = "slip" if source > 3 else "stick" if target > 3 else "cross"
        if (kind, source) != (made, before[3]) or not {source, target} <= {belt, belt + 1, belt + 3}:
            raise Stop(FALSE, "events that follow each other")
    if found[0] != found[-1] or len(found) < 3 or any(source == target for *_, source, target in found):
        raise Stop(FALSE, "a last event that is the first one again")
    return found


def column(values):
    """Return a matrix of one column."""
    return arb_mat(len(values), 1, values)


def horner(rows, at):
    """Return the values of polynomials whose coefficients are rows."""
    total = rows[-1]
    for row in reversed(rows[:-1]):
        total = [a + at * b for a, b in zip(row, total, strict=True)]
    return total


def level(value):
    """Return a ball, or the first coefficient of a series."""
    return value[0] if isinstance(value, arb_series) else value


def entire(b, z):
    """Return 0F1(b; z) of a ball or a series: cosh w for b = 1/2, sinh(w)/w for b = 3/2, z = w^2/4 of any sign."""
    if isinstance(z, arb):
        return z.hypgeom_0f1(b)
    total, factor = 0 * z, 1 + 0 * z
    for j in range(z.prec):  # by its derivative 0F1(b + 1; z)/b
        total, factor = total + factor * z[0].hypgeom_0f1(b + j), factor * (z - z[0]) / ((b + j) * (j + 1))
    return total


def wider(row, reach):
    """Return an event whose time may be off by `reach`."""
    *about, ((low, high), x) = row
    return *about, ((low - reach, high + reach), x)


#: A motion of which it is known that nothing happens between its events: it is one of more that are proven.
Within = type("Within", (base.Motion,), {"positive": lambda motion, *until: None})


def follow(modes, rows, centre, errors, kind=base.Motion):
    """Return the motions from a box of t and x around the first event, behind every event up to the last."""
    belt, mode = rows[0][1], rows[0][3]
    columns, leaves = [(errors[0], arb(0), arb(0)), (arb(0), errors[1], arb(0))], {belt: 1} if mode < 4 else {}
    motions = [kind(modes, mode, belt, [*centre, arb(modes(mode).p[f"v{belt}"])], columns, leaves)]
    for row in rows[1:]:
        motions.append(motions[-1].behind(row))
    return motions


def fixed_point(p, motions, centre, errors, periods):
    """Return where the only fixed point may be (1 above), and the matrix D."""
    last = motions[-1]
    D = arb_mat([[last.columns[j][i] / errors[j] for j in (0, 1)] for i in (0, 1)])
    moved = [last.centre[0] - 2 * periods * arb.pi() / arb(p["Omega"]) - centre[0], last.centre[1] - centre[1]]
    try:
        off = (arb_mat([[1, 0], [0, 1]]) - D).solve(column(moved))
    except ZeroDivisionError:
        raise Stop(OPEN, "1 - D, which may be singular") from None
    return [off[0, 0], off[1, 0]], D


def inside(value, ends):
    """Prove that a number is between two that are stated; both 0 state that it is 0."""
    low, high = (number(end) for end in ends)
    if not (low == high == 0 and value.is_zero()):
        require(value - arb(low), "a number is not above the lower end stated")
        require(arb(high) - value, "a number is not below the upper end stated")


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


def orbit(data):
    """Prove that there is the orbit stated, with its multipliers, and no other beside it."""
    p, stated, periods = read(data)
    rows = [base.read_row(row) for row in stated]
    if rows[0][:4] != rows[-1][:4]:
        raise Stop(FALSE, "a first event that is not the last one again")
    centre = [arb((low + high) / 2) for low, high in rows[0][-1]]
    errors = [arb(number(each)) for each in data["alone_within"]]
    for error in errors:
        require(error, "a box of no width")
    reaches, modes = [number(row["reach"]) for row in stated], cache(lambda i: base.Mode(p, i))
    whole, D = list(zip(centre, errors, strict=True)), arb_mat(2, 2)
    for scale in (fmpq(1), SMALL, SMALL**2):  # the box stated, and one or two in it, to know the fixed point better
        reached = [wider(row, reach * scale) for row, reach in zip(rows, reaches, strict=True)]
        motions = follow(modes, reached, centre, errors, base.Motion if scale == 1 else Within)
        off, D = fixed_point(p, motions, centre, errors, periods)
        for each, error, c, (about, most) in zip(off, errors, centre, whole, strict=True):
            require(error - abs(each), "1 above")
            check(scale == 1 or abs(c - about) + error < most, "a smaller box in the other", OPEN)
        if scale < SMALL or (scale < 1 and all(each.rad() < KNOWN for each in D.entries())):
            break
        root = [c + each for c, each in zip(centre, off, strict=True)]
        centre, errors = [each.mid() for each in root], [(2 * each.rad()).mid() for each in root]
    parts = [each / error for each, error in zip(off, errors, strict=True)]
    for motion, row in zip(motions, stated, strict=True):
        for i, name in enumerate("tx"):  # of the fixed point, by the derivatives
            moved = [part * column[i] for part, column in zip(parts, motion.columns, strict=True)]
            inside(motion.centre[i] + sum(moved, arb(0)), row[name])
    T, d = D[0, 0] + D[1, 1], D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0]
    d = arb(0) if any(row[0] == "stick" for row in rows) else d
    for parts, about in zip(eigenvalues(T, d), data["multipliers"], strict=True):
        for part, name in zip(parts, ("re", "im"), strict=True):
            inside(part, about[name])
    if data["stable"] is not None:
        for margin in (1 - abs(d), 1 + d - abs(T)):
            require(abs(margin), "whether it is stable")
        if data["stable"] is not bool(abs(d) < 1 and abs(T) < 1 + d):
            raise Stop(FALSE, "an orbit that is not as stable as it is said to be")
    length = f"{periods} forcing period{'s' * (periods > 1)}, {len(rows) - 1} events"
    return f"an orbit {data['word']} of {length}, alone within its box"


def keeps(bias, swing, low, high, side):
    """Prove that side (bias + swing sin theta) > 0 for all theta from low to high, in parts that are halved."""
    parts = [(low, high)]
    for _ in range(MOST_PARTS):
        if not parts:
            return
        a, b = parts.pop()
        s = side * (arb(bias) + arb(swing) * a.union(b).sin())
        if not s > 0:
            if s < 0:
                raise Stop(FALSE, "a window with phases on the wrong side of its ends")
            middle = ((a + b) / 2).mid()
            parts += [(a, middle), (middle, b)]
    raise Stop(FALSE, "the sign of s near an end of the window stays open")


def window(data):
    """Prove at which phases a contact with F = 0 grazes."""
    p, ends, where = parameters(data), data["ends"], data["grazes"]
    belt, side = {"P2": (1, 1), "P3": (1, -1), "P5": (2, 1), "P6": (2, -1)}[data["map"]]
    bias, swing = side * p["k"] * p[f"v{belt}"], side * p["B0"] * p["Omega"]
    if data["order"] not in ("full", "paper") or len(ends) != {"on an arc": 2, ALL_BUT_ONE: 1}.get(where, 0):
        raise Stop(BAD, "an order full or paper, and two ends of an arc, or one phase")
    touch = swing != 0 and abs(bias) == abs(swing)  # s = bias (1 -+ sin theta), 0 at one phase, of fourth order there
    if where in ("nowhere", "everywhere", ALL_BUT_ONE):
        sign = -1 if where == "nowhere" else 1
        if where == ALL_BUT_ONE and not (touch and data["order"] == "paper"):
            raise Stop(FALSE, "a window that leaves out a phase at which nothing is special")
        if touch and (bias * sign < 0 or (where == "everywhere" and data["order"] == "paper")):
            raise Stop(FALSE, "a window that is not so at the phase where s is 0, or elsewhere")
        if not touch and not (bias == swing == 0 and where == "nowhere"):
            keeps(bias, swing, arb(0), 2 * arb.pi(), sign)
    elif where == "on an arc":
        (a, b), (c, d) = ([arb(number(each)) for each in end["phase"]] for end in ends)
        for x, y in ((a, b), (b, c), (c, d), (d, a + 2 * arb.pi())):
            require(y - x, "ends in another order")
        keeps(bias, swing, b, c, 1)
        keeps(bias, swing, d, a + 2 * arb.pi(), -1)
    else:
        raise Stop(BAD, "a window of no known kind")
    for end in ends:
        low, high = (arb(number(each)) for each in end["phase"])
        cosine, sine = end["cosine"], number(end["sine"])
        if bias + swing * sine != 0 or cosine not in ((0,) if where == ALL_BUT_ONE else (-1, 1)):
            raise Stop(FALSE, "an end where s is not 0, or where its derivative is")
        require(high - low, "an enclosure of no width")
        require(1 - (high - low), "an enclosure of many phases")
        if cosine:
            require(cosine * low.union(high).cos(), "the cosine at an end")
            require(cosine * (high.sin() - arb(sine)), "an end below its enclosure")
            require(cosine * (arb(sine) - low.sin()), "an end above its enclosure")
        else:
            phase = (2 - arb(sine)) * arb.pi() / 2
            require(phase - low, "a phase below its enclosure")
            require(high - phase, "a phase above its enclosure")
    return f"{data['map']} grazes {where}, order {data['order']}, for all phases"


base.KINDS.update(orbit=orbit, window=window)


if __name__ == "__main__":
    code, line = verify(sys.argv[1]) if len(sys.argv) == 2 else (BAD, "usage: python verify_orbits.py FILE")
    print(" ".join(line.split()), file=sys.stderr if code else sys.stdout)
    sys.exit(code)
