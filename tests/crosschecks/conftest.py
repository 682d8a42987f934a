"""Exact samples for all tests of cross-checks."""

from __future__ import annotations

import numpy as np
import pytest

from symosc import load_scene, simulate


@pytest.fixture(scope="session")
def grid() -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Exact samples, which every test may spoil a copy of."""
    samples = {}
    for name, t_end in (("fig5", 12.0), ("fig9", 8.0), ("fig10", 10.0)):
        t = np.linspace(float(load_scene(name).t0), t_end, 801)
        samples[name] = (t, *simulate(name, t_end=t_end)(t))
    return samples
