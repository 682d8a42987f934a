"""Dense output of many times at once."""

from __future__ import annotations

import numpy as np
import pytest

from symosc import ParameterError, simulate
from symosc.simulation.trajectory import MANY_TIMES


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig8"])
def test_many_times_at_once_are_those_one_by_one(name: str) -> None:
    """In flights, in sticks, over long pieces, at events and at the ends."""
    motion = simulate(name, t_end=60)
    edges = [float(event.t) for event in motion.events] + [float(motion.t_start), float(motion.t_end)]
    rng = np.random.default_rng(2)
    times = rng.permutation([*edges, *rng.uniform(min(edges), max(edges), MANY_TIMES + len(edges) % 2)])
    single = np.array([motion(time) for time in times]).T
    np.testing.assert_allclose(motion(times), single, rtol=2e-13, atol=2e-13)
    np.testing.assert_array_equal(motion(times.reshape(2, -1)), motion(times).reshape(2, 2, -1))
    for wrong in (np.nan, float(motion.t_end) + 1e-9):
        with pytest.raises(ParameterError, match="must be within"):
            motion(np.append(times, wrong))
