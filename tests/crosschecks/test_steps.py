"""Exact steps from every sample."""

from __future__ import annotations

import numpy as np

from symosc import load_scene
from symosc.crosschecks.steps import phases


def test_phases_at_large_times() -> None:
    rng = np.random.default_rng(7)
    p = load_scene("fig10").parameters.replace(Omega="1/3")
    t = np.concatenate([10.0 ** rng.uniform(-3, 14, 200), [0.0, -1.5]])
    _, theta = phases(p, t)
    import mpmath

    with mpmath.workdps(50):
        exact = [float(mpmath.fmod(mpmath.mpf(time) / 3, 2 * mpmath.pi)) for time in t]
    np.testing.assert_allclose(theta, exact, rtol=0, atol=2e-15)
