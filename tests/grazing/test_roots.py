"""The search for the first root."""

from __future__ import annotations

import random
from itertools import pairwise
from math import sqrt

from symosc.grazing.backward_flow import first_root


def test_first_root_of_products() -> None:
    rng = random.Random(7)
    for _ in range(300):
        roots = sorted(rng.uniform(0.02, 1.5) for _ in range(rng.randrange(1, 6)))
        if any(b - a < 1e-3 for a, b in pairwise(roots)):
            continue
        p = [1.0]
        for root in roots:
            p = [(p[i] if i < len(p) else 0.0) - (p[i - 1] / root if i else 0.0) for i in range(len(p) + 1)]
        touch, found = first_root(p, 1e-15, 2.0**-53)
        assert not touch
        assert (found is None) == (roots[0] > 1)
        assert found is None or abs(found - roots[0]) < 1e-9


def test_first_root_tells_touches_and_near_misses() -> None:
    for depth in (1e-10, 0.0, -1e-10):  # (x - 0.6)^2 + depth
        touch, found = first_root([0.36 + depth, -1.2, 1.0], 1e-15, 2.0**-53)
        assert touch == (depth == 0.0)
        assert (found is None) == (depth > 0.0)
        if depth <= 0.0:
            assert abs(found - (0.6 - sqrt(-depth))) < 1e-8
