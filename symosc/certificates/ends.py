"""The end of a branch: where an inequality that holds inside it becomes an equality.

The roots of the closing equations go on beyond the end. One root is proven for every value of the parameter between one
just inside and one just outside. Inside all inequalities are proven. Outside one of them is proven to fail. Both of its
sides depend continuously on the root, so it becomes an equality between the two values.
"""

from __future__ import annotations

from flint import arb

from symosc.certificates.balls import Ball, sure_sign
from symosc.certificates.closing import ClosingBalls, Values
from symosc.certificates.course import Margin, borders, forces_at, starts_with

#: Times of a piece that are looked at, and Newton steps from the lowest of them.
LOW_SAMPLES, MOST_LOW_STEPS = 96, 12


def violated(closing: ClosingBalls, values: Values) -> str | None:
    """Return an inequality that surely does not hold for the root in `values`, in words; None if none is found."""
    ends = closing.ends(values)
    spans = [ends[2 * i] - values[2 * i] for i in range(len(closing.pieces))]
    for piece, span in zip(closing.pieces, spans, strict=True):
        if span < 0:
            return f"{piece.label} lasts"
    for i in range(len(closing.pieces)):
        for domain, force, wanted in forces_at(closing, i, values):
            if sure_sign(force) == -wanted:
                return passage_text(closing, i, domain, wanted)
        for border in borders(closing, i, values):
            if spans[i] > 0 and falls_below(border, spans[i]):
                return border.what
    return None


def passage_text(closing: ClosingBalls, i: int, domain: int, wanted: int) -> str:
    """Return the condition on a force where piece i begins, in words."""
    return f"F^({domain}) {'>' if wanted > 0 else '<'} 0 where {closing.pieces[i - 1].label} ends"


def falls_below(border: Margin, span: Ball) -> bool:
    """Return whether a border is surely negative somewhere between 0 and `span`."""
    last = span.lower().mid()
    first = border.curve(arb(0))
    if starts_with(first, border.at_start) < 0 or (border.at_end and border.curve(span).dg > 0):
        return True
    times = [(last * part / LOW_SAMPLES).mid() for part in range(1, LOW_SAMPLES)]
    tau = min(times, key=lambda time: float(border.curve(time).g))
    for _ in range(MOST_LOW_STEPS):
        there = border.curve(tau)
        if there.g < 0:
            return True
        following = (tau - there.dg / there.ddg).mid()
        if not (following.is_finite() and 0 < following < last):
            return False
        tau = following
    return False
