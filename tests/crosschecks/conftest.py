"""Exact samples for all tests of cross-checks, and no compiler in the quick ones."""

from __future__ import annotations

import numpy as np
import pytest

from symosc import load_scene, simulate
from symosc.crosschecks import steps

#: Marks of tests that may compile the loop of events, which takes gigabytes.
MAY_COMPILE = ("compiled", "slow", "campaign", "full")


@pytest.fixture(autouse=True)
def interpreted_steps(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no quick test compile because earlier ones in its process have followed many steps."""
    if not any(request.node.get_closest_marker(mark) for mark in MAY_COMPILE):
        monkeypatch.setattr(steps.FEW_STEPS, "events", 10**9)


@pytest.fixture(scope="session")
def grid() -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Exact samples, which every test may spoil a copy of."""
    samples = {}
    for name, t_end in (("fig5", 12.0), ("fig9", 8.0), ("fig10", 10.0)):
        t = np.linspace(float(load_scene(name).t0), t_end, 801)
        samples[name] = (t, *simulate(name, t_end=t_end)(t))
    return samples
