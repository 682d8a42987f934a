"""The end of a branch: where an inequality that holds inside it becomes an equality.

The roots of the closing equations go on beyond the end. One root is proven for every value of the parameter between one
just inside and one just outside. Inside all inequalities are proven. Outside one of them is proven to fail. Both of its
sides depend continuously on the root, so it becomes an equality between the two values.
"""

from __future__ import annotations

from typing import NamedTuple

from flint import arb

from symosc.certificates.balls import Ball, sure_sign
from symosc.certificates.closing import ClosingBalls, Values
from symosc.certificates.course import Margin, borders, forces_at, starts_with

#: Times of a piece that are looked at, and Newton steps from the lowest of them.
LOW_SAMPLES, MOST_LOW_STEPS = 96, 12
#: Nearest times to the start or the end of a piece, as negative powers of 2.
MOST_NEAR = 60


class Violation(NamedTuple):
    """An inequality that surely does not hold, in words, a time at which it does not, and the kind of the end."""

    text: str
    t: Ball
    kind: str


def violated(closing: ClosingBalls, values: Values) -> Violation | None:
    """Return an inequality that surely does not hold for the root in `values`; None if none is found."""
    ends = closing.ends(values)
    spans = [ends[2 * i] - values[2 * i] for i in range(len(closing.pieces))]
    for i, (piece, span) in enumerate(zip(closing.pieces, spans, strict=True)):
        if span < 0:
            kind = "stick" if piece.sticks else "slip" if piece.after_stick else "flight"
            return Violation(f"{piece.label} lasts", values[2 * i], f"vanishing of a {kind}")
    for i, piece in enumerate(closing.pieces):
        for domain, force, wanted in forces_at(closing, i, values):
            if sure_sign(force) == -wanted:
                far = domain != closing.pieces[i - 1].mode and not closing.oscillator.jump[piece.start].is_zero()
                kind = "grazing" if not far else "birth of a slip" if piece.sticks else "birth of a stick"
                return Violation(passage_text(closing, i, domain, wanted), values[2 * i], kind)
        for border in borders(closing, i, values):
            tau = below(border, spans[i]) if spans[i] > 0 else None
            if tau is not None:
                leaves = starts_with(border.curve(arb(0)), border.at_start)
                kind = "birth of a slip" if piece.sticks else "grazing" if leaves > 0 else "vanishing of a slip"
                return Violation(border.what, values[2 * i] + tau, kind)
    return None


def passage_text(closing: ClosingBalls, i: int, domain: int, wanted: int) -> str:
    """Return the condition on a force where piece i begins, in words."""
    return f"F^({domain}) {'>' if wanted > 0 else '<'} 0 where {closing.pieces[i - 1].label} ends"


def below(border: Margin, span: Ball) -> Ball | None:
    """Return a time between 0 and `span` at which a border is surely negative; None if none is found."""
    last = span.lower().mid()
    times = [(last * part / LOW_SAMPLES).mid() for part in range(1, LOW_SAMPLES)]
    tau = min(times, key=lambda time: float(border.curve(time).g))
    for _ in range(MOST_LOW_STEPS):
        there = border.curve(tau)
        if there.g < 0:
            return tau
        following = (tau - there.dg / there.ddg).mid()
        if not (following.is_finite() and 0 < following < last):
            break
        tau = following
    near = [last * arb(2) ** -power for power in range(8, MOST_NEAR)]  # right after the start, right before the end
    near = near if starts_with(border.curve(arb(0)), border.at_start) < 0 else [last - each for each in near]
    return next((each for each in near if border.curve(each).g < 0), None)
