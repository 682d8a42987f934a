"""Where the drift of a belt turns: zeros of k v + B0 Omega sin(Omega t), and its sign between them."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import islice

import pytest
from flint import arb
from problems import ordinary

from symosc.certificates.balls import ball, sure_sign, working_bits
from symosc.certificates.turns import Turns


@pytest.mark.parametrize("sign", [1, -1])
def test_turns_are_zeros_and_the_drift_has_its_sign_between_them(sign: int) -> None:
    rng = random.Random(sign)
    with working_bits(128):
        for _ in range(30):
            p, start = ordinary(rng, B0=sign * Fraction(rng.randint(1, 90), 10))
            boundary, t = rng.choice([1, 2]), ball(Fraction(start["t0"]) * 10 ** rng.randint(0, 6))
            turns = Turns(p, boundary)

            def drift(time: object, p: object = p, boundary: int = boundary) -> object:
                bias, swing = ball(p.k * p.belt(boundary)), ball(p.B0 * p.Omega)  # type: ignore[attr-defined]
                return -bias - swing * (ball(p.Omega) * time).sin()  # type: ignore[attr-defined]

            before = t
            for turn, side in islice(turns.pieces(t), 5):
                if turn is None:
                    assert sure_sign(drift(t + rng.random())) == side == turns.constant
                    break
                assert turn > before
                assert drift(turn).contains(0)  # type: ignore[attr-defined]
                assert sure_sign(drift((before + turn) / 2)) == side
                before = turn


def test_a_turn_exactly_at_the_start_is_behind() -> None:
    p, _ = ordinary(random.Random(1), k=0, B0=1, Omega=1)
    with working_bits(128):
        turn, side = next(Turns(p, 1).pieces(arb(0)))
        assert turn is not None
        assert (float(turn.mid()), side) == (pytest.approx(3.14159265), -1)


def test_a_drift_that_touches_0_keeps_its_sign() -> None:
    p, _ = ordinary(random.Random(1), k=2, B0=4, Omega=1, v1=2, v2=3)
    assert list(islice(Turns(p, 1).pieces(arb(1)), 2)) == [(None, -1)]
    p, _ = ordinary(random.Random(1), k=0, B0=0, v1=2, v2=3)
    assert list(islice(Turns(p, 1).pieces(arb(1)), 2)) == [(None, 0)]
