"""Windows as text without sympy: what sympy prints of the exact set, over random parameters of all cases."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from symosc import Parameters, grazing_window
from symosc.grazing.window_text import critical_text, phases_text
from symosc.mappings.theorem7_cases import ORDERS, PLACES
from symosc.symbolic.grazing_answers import interval_text


@pytest.mark.parametrize("seed", range(4))
def test_the_text_is_that_of_sympy(seed: int) -> None:
    rng = random.Random(seed)
    kinds = set()
    for _ in range(8):
        p = Parameters(
            m=1,
            c=1,
            A0=0,
            mu1=1,
            mu2=1,
            FN=1,
            k=Fraction(rng.randint(0, 12), rng.randint(1, 9)),
            B0=rng.choice([0, 1, 2, 5, -3, 12]),
            Omega=Fraction(rng.randint(1, 6), rng.randint(1, 3)),
            v1=rng.choice([-3, -1, 0, 1, "1/2"]),
            v2=rng.choice([2, 3, "5/2", 12]),
        )
        for mapping in PLACES:
            window = grazing_window(p, mapping, rng.choice(ORDERS))
            theta_cr, phases = window.theta_cr, window.phases
            kinds.add(window.kind)
            assert critical_text(window) == ("none" if theta_cr is None else str(theta_cr))
            assert phases_text(window) == ("empty" if phases.is_empty else interval_text(phases))
    assert len(kinds) >= 4


@pytest.mark.parametrize(
    ("k", "text"), [("1/2", "[0, 7*pi/6) U (11*pi/6, 2*pi)"), ("1", "[0, 3*pi/2) U (3*pi/2, 2*pi)"), ("0", "(0, pi)")]
)
def test_rational_multiples_of_pi(k: str, text: str) -> None:
    p = Parameters(m=1, c=1, k=k, A0=0, B0=1, Omega=1, v1=1, v2=2, mu1=1, mu2=1, FN=1)
    window = grazing_window(p, "P2", "paper")
    assert phases_text(window) == interval_text(window.phases) == text
