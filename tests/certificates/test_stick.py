"""Ends of sticks: the first of both exits, and sticks that never end."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from problems import ordinary

from symosc.certificates.balls import Undecided, ball, working_bits
from symosc.certificates.flow import Oscillator
from symosc.certificates.stick import FOR_EVER, Slip, StickStart, end_of_stick, force_on_belt
from symosc.certificates.turns import Turns


def test_a_stick_ends_at_the_first_of_both_exits() -> None:
    rng, sides = random.Random(2), set()
    with working_bits(128):
        for _ in range(60):
            p, start = ordinary(rng, FN=10, mu1=1, mu2=1)
            o, boundary, t = Oscillator(p), rng.choice([1, 2]), ball(Fraction(start["t0"]))
            middle = (p.A(boundary) + p.A(boundary + 1)) / 2 - p.c * p.belt(boundary)
            x = (ball(middle) + o.B0 * (o.Omega * t).cos()) / o.k  # the forces are equal and opposite
            hold = StickStart(boundary, t, x)
            slip = end_of_stick(o, hold, Turns(p, boundary), arb(6))
            forces = [force_on_belt(o, hold, boundary + i, side) for i, side in ((0, 1), (1, -1))]
            times = np.linspace(0, 6, 300)
            last = float(slip.tau.mid()) if isinstance(slip, Slip) else 6.0
            assert all(force(arb(float(tau))).g > 0 for force in forces for tau in times if tau < last)
            if isinstance(slip, Slip):
                out = slip.domain - boundary
                sides.add(out)
                assert forces[out](slip.tau).g.contains(0)
                assert forces[1 - out](slip.tau).g > 0
                assert (slip.slope > 0) == (out == 1)
    assert sides == {0, 1}


def test_a_stick_on_a_belt_at_rest_may_last_for_ever() -> None:
    p, _ = ordinary(random.Random(2), m=1, k=1, c=1, A0=0, B0="0.1", v1=0, v2=10, mu1=1, mu2="0.1", FN=1)
    with working_bits(128):
        for x in ("-0.6", "0", "0.5"):
            hold = StickStart(1, arb(0), ball(Fraction(x)))
            assert end_of_stick(Oscillator(p), hold, Turns(p, 1), arb(10) ** 9) == FOR_EVER
        hold = StickStart(1, arb(0), ball(Fraction("1.05")))  # F^(2) reaches 0 where B0 cos(t) falls to -0.05
        assert isinstance(end_of_stick(Oscillator(p), hold, Turns(p, 1), arb(10) ** 9), Slip)


def test_a_force_that_touches_0_where_it_turns_is_open() -> None:
    p, _ = ordinary(random.Random(2), m=1, k=1, c=1, A0=0, B0="0.1", v1=0, v2=10, mu1=1, mu2=0, FN=1)
    with working_bits(128), pytest.raises(Undecided):  # F^(1) = 1 - x - 0.1 cos(t + pi) is 0 once a period
        end_of_stick(Oscillator(p), StickStart(1, arb(1), ball(Fraction("0.9"))), Turns(p, 1), arb(100))
