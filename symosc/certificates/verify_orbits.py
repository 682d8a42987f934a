#!/usr/bin/env python3
"""Prove a certificate of an orbit, a branch or a window once more: ``python verify_orbits.py FILE``.

Needs verify.py beside it, python-flint, and nothing of symosc. verify.py has the equation and how a motion is followed
from event to event, for all starts of a box at once.

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

"""

from __future__ import annotations

import sys

from flint import arb, arb_mat, fmpq

if __package__:
    from . import verify as base
else:
    import verify as base
Stop, OPEN, FALSE, BAD, MODES = base.Stop, base.OPEN, base.FALSE, base.BAD, base.MODES
require, number = base.require, base.number

LABELS = {
    (1, 4, 1): 1,
    (1, 1, 1): 2,
    (1, 2, 1): 3,
    (2, 5, 2): 4,
    (2, 2, 2): 5,
    (2, 3, 2): 6,
    (2, 2, 1): 7,
    (1, 2, 2): 8,
}


def read(data):
    """Return parameters, rows and the number of periods of an orbit or a branch; refuse a word that is not the rows'."""
    p = {name: number(data["parameters"][name]) for name in base.NAMES}
    if min(p["m"], p["Omega"], p["v2"] - p["v1"]) <= 0 or min(p[name] for name in ("c", "k", "mu1", "mu2", "FN")) < 0:
        raise Stop(BAD, "parameters out of range")
    periods, rows = data["periods"], data["events"]
    if type(periods) is not int or not 0 < periods < 10_000 or len(rows) < 2:
        raise Stop(BAD, "a number of periods and two events at least")
    modes = [(row["boundary"], MODES.index(row["target"], 1)) for row in rows]
    labels = [LABELS.get((belt, mode, after[0])) for (belt, mode), after in zip(modes, modes[1:], strict=False)]
    word, found = data["word"], "".join(map(str, reversed(labels)))
    if word[0] != "P" or len(word) != len(found) + 1 or word[1:] not in found * 2:
        raise Stop(FALSE, f"the word {word[:40]}, of events that say {found[:40]}")
    return p, rows, periods


def wider(row, reach):
    """Return a row whose times may be off by `reach`."""
    t = [number(each) for each in row["t"]]
    return base.read_row(row | {"t": [str(t[0] - reach), str(t[1] + reach)]})


def follow(p, rows, centre, errors):
    """Return the motions from a box of t and x around the first event, behind every event up to the last."""
    belt, mode = rows[0][1], rows[0][3]
    columns, leaves = [(errors[0], arb(0), arb(0)), (arb(0), errors[1], arb(0))], {belt: 1} if mode < 4 else {}
    modes = {i: base.Mode(p, i) for i in (1, 2, 3, 4, 5)}
    motions = [base.Motion(modes, mode, belt, [*centre, arb(p[f"v{belt}"])], columns, leaves)]
    for row in rows[1:]:
        motions.append(motions[-1].behind(row))
    return motions


def fixed_point(p, motions, centre, errors, periods):
    """Return where the only fixed point may be (1 above), and the matrix D."""
    last = motions[-1]
    D = arb_mat([[last.columns[j][i] / errors[j] for j in (0, 1)] for i in (0, 1)])
    moved = [last.centre[0] - 2 * periods * arb.pi() / arb(p["Omega"]) - centre[0], last.centre[1] - centre[1]]
    try:
        off = (arb_mat([[1, 0], [0, 1]]) - D).solve(arb_mat([[each] for each in moved]))
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
    require(abs(square), "two multipliers that may be one")
    root = abs(square).sqrt()
    if square < 0:
        return (T / 2, root), (T / 2, -root)
    require(abs(T), "which multiplier is the larger one")
    return (T / 2 + (root if T > 0 else -root), arb(0)), (T / 2 - (root if T > 0 else -root), arb(0))


def orbit(data):
    """Prove that there is the orbit stated, with its multipliers, and no other beside it."""
    p, stated, periods = read(data)
    rows = [base.read_row(row) for row in stated]
    centre = [arb((low + high) / 2) for low, high in rows[0][-1]]
    errors = [arb(number(each)) for each in data["alone_within"]]
    for error in errors:
        require(error, "a box of no width")
    for scale in (1, fmpq(1, 10**15), 0):  # the box stated; a smaller one; one with the events as stated
        motions = follow(p, [wider(row, number(row["reach"]) * scale) for row in stated], centre, errors)
        off, D = fixed_point(p, motions, centre, errors, periods)
        for each, error in zip(off, errors, strict=True):
            require(error - abs(each), "1 above")
        root = [c + each for c, each in zip(centre, off, strict=True)]
        centre, errors = [each.mid() for each in root], [(2 * each.rad()).mid() for each in root]
    for motion, row in zip(motions, stated, strict=True):
        inside(motion.t, row["t"])
        inside(motion.first[0, 0], row["x"])
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
    return f"an orbit {data['word']} of {periods} periods, {len(rows) - 1} events, alone within its box"


base.KINDS.update(orbit=orbit)


if __name__ == "__main__":
    code, line = base.verify(sys.argv[1]) if len(sys.argv) == 2 else (BAD, "usage: python verify_orbits.py FILE")
    print(" ".join(line.split()), file=sys.stderr if code else sys.stdout)
    sys.exit(code)
