"""A grazing window, proven for all phases: where a motion that meets a belt with F = 0 turns back,
and where not.

At the contact g = g' = 0 for the distance g from the belt, and m g'' = s = side (k v + B0 Omega sin
theta), side = 1 below the belt and -1 above it. It grazes where s > 0, and leaves its domain where
s < 0. If s has two zeros, one phase shows its sign on each arc, and at the ends the motion passes.
If it has one (|k v| = |B0| Omega, decided in rational numbers), the touch there is of fourth order,
which the paper's order leaves out (`symosc derive certificates`).
"""

from __future__ import annotations

from fractions import Fraction

from flint import arb, ctx

from symosc.base.exact import show
from symosc.certificates.balls import Ball, ball, decided_sign, made_by, outward
from symosc.certificates.certificate import Certificate, confirmed
from symosc.grazing.window import GrazingWindow

WINDOW_BITS = 128
WINDOW_PLACES = 25
NO_PHASE = "nowhere"
ALL_PHASES = "everywhere"
BUT_ONE_PHASE = "everywhere but at one phase"
ON_AN_ARC = "on an arc"


def prove_window(window: GrazingWindow) -> Certificate:
    """Prove at which phases a mapping that meets a belt with F = 0 grazes it.

    Return the certificate of that window.
    """
    p = window.parameters
    place = window.place
    bias = place.side * p.k * p.belt(place.boundary)
    swing = place.side * p.B0 * p.Omega
    statement = made_by(WINDOW_BITS) | {
        "parameters": p.as_dict(),
        "map": window.mapping,
        "order": window.order,
    }
    with ctx.workprec(WINDOW_BITS):
        statement["grazes"], ends = _positive_phases(bias, swing, window.order == "full")
        statement["ends"] = [
            {"phase": list(outward(phase, WINDOW_PLACES)), "sine": show(sine), "cosine": cosine}
            for phase, sine, cosine in ends
        ]
    return confirmed("window", statement)


def _positive_phases(
    bias: Fraction, swing: Fraction, full: bool
) -> tuple[str, list[tuple[Ball, Fraction, int]]]:
    """Return in words where bias + swing sin(theta) > 0 (`full`: a lone zero is no exception), and
    the ends of it.
    """
    # An arc reaches from its first end, with growing theta, to its second.
    if abs(bias) > abs(swing) or swing == 0:
        return (ALL_PHASES if bias > 0 else NO_PHASE), []
    sine = -bias / swing
    if abs(bias) == abs(swing):
        if bias < 0 or full:
            return (ALL_PHASES if bias > 0 else NO_PHASE), []
        return BUT_ONE_PHASE, [(arb.pi() * (1 if sine > 0 else 3) / 2, sine, 0)]
    rising = ball(sine).asin()
    falling = arb.pi() - ball(sine).asin()
    if swing > 0:
        low = (rising, 1)
        high = (falling, -1)
    else:
        low = (falling, -1)
        high = (rising, 1)
    first = low[0]
    second = high[0]
    if first < 0:
        first = first + 2 * arb.pi()
    while not second > first:
        second = second + 2 * arb.pi()
    for sign, phase in ((1, (first + second) / 2), (-1, (first + second) / 2 + arb.pi())):
        if (
            decided_sign(ball(bias) + ball(swing) * phase.sin(), "the sign of the drift", phase)
            != sign
        ):
            raise ArithmeticError("an arc on the wrong side of its ends")
    return ON_AN_ARC, [(first, sine, low[1]), (second, sine, high[1])]
