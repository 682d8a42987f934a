"""Sets of states contain the images of all their points, and do not grow where a map only turns them."""

from __future__ import annotations

import math
import random

from flint import arb

from symosc.certificates.balls import Ball
from symosc.certificates.sets import StateSet


def _inside(states: StateSet, point: list[Ball]) -> bool:
    """Whether a point is within the set: its coordinates in the orthogonal frame are in the box."""
    (p, minus_q), (q, _) = states.matrix
    off = [value - c for value, c in zip(point, states.centre, strict=True)]
    norm = p * p + q * q
    y = [(p * off[0] + q * off[1]) / norm, (p * off[1] - q * off[0]) / norm]
    assert (minus_q + q).contains(0)
    return all(box.overlaps(each) for box, each in zip(states.box, y, strict=True))


def test_an_image_contains_the_images_of_points() -> None:
    rng = random.Random(3)
    for _ in range(50):
        a, b, c, d, bend = (rng.uniform(-2, 2) for _ in range(5))

        def image(x: Ball, y: Ball, abcd: tuple[float, ...] = (a, b, c, d, bend)) -> list[Ball]:
            a, b, c, d, bend = abcd
            return [a * x + b * y + bend * x * x, c * x + d * y - bend * x * y]

        states = StateSet.of([arb(rng.uniform(-1, 1), 1e-3), arb(rng.uniform(-1, 1), 1e-5)])
        x, y = states.hull()
        jacobian = [[a + 2 * bend * x, arb(b)], [c - bend * y, d - bend * x]]
        after = states.mapped(image(*states.centre), jacobian)
        for _ in range(20):
            point = [value.mid() + value.rad() * rng.uniform(-1, 1) for value in (x, y)]
            there = image(*(each.mid() for each in point))
            assert _inside(after, there)
            assert all(box.overlaps(each) for box, each in zip(after.hull(), there, strict=True))


def test_a_thousand_turns_do_not_grow() -> None:
    """In boxes each turn by a radian would grow by |sin| + |cos|: to 10**120."""
    s, c = math.sin(1), math.cos(1)
    states = StateSet.of([arb(1, 1e-6), arb(0, 1e-6)])
    for _ in range(1000):
        x, y = states.centre
        states = states.mapped([c * x - s * y, s * x + c * y], [[arb(c), arb(-s)], [arb(s), arb(c)]])
    assert max(float(value.rad()) for value in states.hull()) < 3e-6


def test_a_contraction_to_a_line_shrinks() -> None:
    states = StateSet.of([arb(1, 1e-6), arb(0, 1e-6)])
    for _ in range(200):
        x, y = states.centre
        states = states.mapped([x / 2 + y / 2, x / 4 + y / 4], [[arb(0.5), arb(0.5)], [arb(0.25), arb(0.25)]])
    assert max(float(value.rad()) for value in states.hull()) < 1e-20
