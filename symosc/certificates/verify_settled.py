#!/usr/bin/env python3
"""Prove a certificate of a motion that settles on an orbit once more: ``python verify_settled.py FILE``.

Needs verify.py (it has the equation, and how motions are followed) and verify_orbits.py beside it, python-flint, and
nothing of symosc. A "settled" file states for all starts within start_error: the first events are `events`; the last of
them is the first of `cycle`; the others of `cycle` follow, the last of which is the first again, `periods` forcing
periods later, and so on for ever: each event of `cycle` within its positions, and its times, `periods` later for each
time that it has come again. Until t_end there are `count` events, of which `last` are the last.

1. Let B be the box of times and positions of the first event of `cycle`, c its middle, e its half-widths, P the motion
   from B to the last event of `cycle`, less the periods. All motions from B are followed at once (verify.py, 5). If
   they have the events of `cycle`, and P(B) lies in B, then so has each motion that comes into B, again and again.
2. Let D contain the derivatives of P over B. If |D| e <= q e with q < 1, P is a contraction in the norm whose ball is
   B: it has one fixed point in B (its place is found as in verify_orbits.py), and after n cycles a motion is within
   2 q^n e of it. So the events after n cycles are known as well as those of the fixed point, by their derivatives.
3. `may_stick_until`, if it is no null: the start is on a belt, and F = 0 on one side of it within the start's error.
   All starts stick until then at most, or not at all, and leave the belt to that side: there F falls to 0 before that
   time, and on the other side it keeps its sign. The flights from there are followed, with f' >= 0 and f'' > 0 at
   their start. The end of that short stick is not among the events.
"""

import sys
from functools import cache
from importlib import import_module

from flint import arb

try:
    orbits = import_module(".verify_orbits" if __package__ else "verify_orbits", __package__)
except ImportError as error:
    print(f"no certificate was read: verify_orbits.py has to be beside verify_settled.py ({error})", file=sys.stderr)
    sys.exit(2)
base, verify, check, require, number = orbits.base, orbits.verify, orbits.check, orbits.require, orbits.number

MOST_LAST = 1000


def leave(modes, start, errors, until):
    """Return the flights from a belt of starts that may stick until a time (3 above)."""
    p, at = modes(1).p, 1 if start[2] == modes(1).p["v1"] else 2
    v, after = p[f"v{at}"], until - start[0] - errors[0]
    check(start[2] == v and errors[2] == 0 and after > 0, "a start on a belt, and a time after it")
    hold, centre = modes(3 + at), [arb(value) for value in start]

    def around(t, x):
        return [(arb(t), arb(0), arb(0)), (arb(0), arb(x), arb(0))]

    wide = around(until - start[0], errors[1] + abs(v) * (until - start[0] + errors[0]))
    F = hold.rows[0] * base.Motion(modes, 3 + at, at, centre, around(errors[0], errors[1])).first
    F_then, slope = (hold.rows[i] * base.Motion(modes, 3 + at, at, centre, wide).first for i in (0, 1))
    i = 0 if slope[0, 0] < 0 else 1  # F of this side ends the stick
    require(-slope[i, 0], "F on the belt that falls")
    require(F_then[1 - i, 0], "F on the other side of the belt")
    require(-F[i, 0] - slope[i, 0] * arb(after), "the end of a stick before the time stated")
    return base.Motion(modes, at + i, at, centre, wide, {at: 2})


def settled(data):
    """Prove what a motion does first, that it goes on for ever in a box, and its last events."""
    p, modes = orbits.parameters(data), cache(lambda i: base.Mode(p, i))
    start, errors = [number(data["start"][name]) for name in base.START], number(data["start_error"])
    t_end, until = number(data["t_end"]), data["may_stick_until"]
    rows, cycle, last = ([base.read_row(row) for row in data[name]] for name in ("events", "cycle", "last"))
    right = len(errors) == 3 and min(errors) >= 0 and t_end > start[0] and rows and len(cycle) > 2
    check(right and 0 < len(last) <= MOST_LAST, "start_error, t_end or events out of range", base.BAD)
    check(type(data["periods"]) is int and 0 < data["periods"] < 10_000, "a number of periods", base.BAD)
    check(type(data["count"]) is int, "a number of events", base.BAD)
    motion = base.begin(modes, start, errors) if until is None else leave(modes, start, errors, number(until))
    check(data["mode"] == base.MODES[motion.mode.number], "the mode that the motion starts in")
    for row in rows:  # 0: what it does first
        motion = motion.behind(row)
        within((motion.t, motion.first[0, 0]), row)
    check(rows[-1][:4] == cycle[0][:4] == cycle[-1][:4] and cycle[0][0] != "slip", "a cycle of the last event")
    within((motion.t, motion.first[0, 0]), cycle[0])

    centre, widths = ([arb((high + sign * low) / 2) for low, high in cycle[0][-1]] for sign in (1, -1))
    motions = orbits.follow(modes, cycle, centre, widths)  # 1
    for motion, row in zip(motions[1:], cycle[1:], strict=True):
        within((motion.t, motion.first[0, 0]), row)
    turn = 2 * data["periods"] * arb.pi() / arb(p["Omega"])
    within((motions[-1].t - turn, motions[-1].first[0, 0]), cycle[0])

    n, k = len(cycle) - 1, data["count"] - len(rows)
    ahead, behind = divmod(k, n), divmod(k + 1, n)
    check(k >= len(last), "a count of events that is not less than those stated")
    for (gone, j), sign in ((ahead, 1), (behind, -1)):
        ends = cycle[j][-1][0]
        require(sign * (arb(t_end) - (arb(ends[0]).union(arb(ends[1])) + gone * turn)), "so many events until t_end")

    u, D = orbits.fixed_point(p, motions, centre, widths, data["periods"])  # 2
    sums = [sum((abs(D[i, j]) * widths[j] for j in (0, 1)), arb(0)) / widths[i] for i in (0, 1)]
    q = sums[0].union(sums[1]).upper()
    require(1 - q, "a contraction in the norm of the box")
    for back, row in enumerate(reversed(last)):
        gone, j = divmod(k - back, n)
        parts = [each / width + 2 * q**gone * arb(0, 1) for each, width in zip(u, widths, strict=True)]
        t, x = (
            motions[j].centre[i] + sum((part * motions[j].columns[at][i] for at, part in enumerate(parts)), arb(0))
            for i in (0, 1)
        )
        check(row[:4] == cycle[j][:4], "the kinds of the last events")
        within((t + gone * turn, x), row)
    return f"{data['count']} events until t = {data['t_end']}, on a cycle of {n} from event {len(rows)} on"


def within(values, row):
    """Prove that t and x are between the ends stated in a row."""
    for value, (low, high) in zip(values, row[-1], strict=True):
        require(value - arb(low), "an event is not above the lower end stated")
        require(arb(high) - value, "an event is not below the upper end stated")


base.KINDS["settled"] = settled


if __name__ == "__main__":
    code, line = verify(sys.argv[1]) if len(sys.argv) == 2 else (base.BAD, "usage: python verify_settled.py FILE")
    print(" ".join(line.split()), file=sys.stderr if code else sys.stdout)
    sys.exit(code)
