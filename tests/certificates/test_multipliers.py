"""Multipliers from trace and determinant, against numpy."""

from __future__ import annotations

import random

import numpy as np
from flint import arb

from symosc.certificates.balls import working_bits
from symosc.certificates.multipliers import Stability


def test_they_contain_the_roots_and_decide_stability() -> None:
    rng, seen = random.Random(5), set()
    with working_bits(128):
        for _ in range(500):
            T, D = rng.uniform(-3, 3), rng.choice([0.0, rng.uniform(-1.5, 1.5), 1e-30])
            roots = np.roots([1, -T, D])
            found = Stability(arb(T), arb(D))
            for re, im in found.multipliers():
                near = min(roots, key=lambda root: abs(complex(root) - complex(float(re), float(im))))
                assert abs(complex(near) - complex(float(re), float(im))) < 1e-6
                value = arb(complex(near).real)
                assert (re + arb(0, 1e-7)).overlaps(value)
            assert found.stable is bool(max(abs(roots)) < 1)
            seen.add(found.stable)
    assert seen == {True, False}


def test_on_the_circle_it_is_open() -> None:
    with working_bits(128):
        for T, D in ((2, 1), (-2, 1), (1.5, 0.5), (-1.5, 0.5), (0.3, 1)):
            assert Stability(arb(T) + arb(0, 1e-20), arb(D) + arb(0, 1e-20)).stable is None


def test_double_multipliers_are_enclosed_together() -> None:
    with working_bits(128):
        for re, im in Stability(arb(1), arb(0.25)).multipliers():
            assert re.contains(0.5)
            assert im.contains(0)
            assert re.rad() < 1e-12
