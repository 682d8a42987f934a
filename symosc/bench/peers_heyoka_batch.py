"""heyoka in batch mode: eight motions in the lanes of one integrator, which follows flights and sticks alike.

As in `symosc.bench.peers_heyoka`, at its best: the callbacks of the two terminal events rewrite the parameters of a
lane, so Python runs once per event.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from symosc.bench.event_logic import Motion
from symosc.bench.peers_heyoka import equations, tables
from symosc.model import Parameters

LANES = 8
HEYOKA_BATCH_TOLERANCE = 1e-16
MOST_BATCH_STEPS = 10_000_000


def count_by_heyoka(parameters: Parameters, starts: np.ndarray, duration: float) -> Callable[[], np.ndarray]:
    """Return a function that counts the events of motions, eight at a time, each for the same duration."""
    import heyoka as hy

    motion = Motion(parameters)
    stiffness, damping = motion.k / motion.m, motion.c / motion.m
    A, pars, offsets = tables(motion)
    counts, modes = np.zeros(LANES, np.int64), np.zeros(LANES, np.int64)

    def callback(event: int) -> Callable[[Any, int, int], bool]:
        belt = motion.belts[event]

        def act(integrator: Any, sign: int, lane: int) -> bool:
            state, p_now, source = integrator.state, integrator.pars, int(modes[lane])
            if source > 3:
                boundary = source - 3
                now = boundary + event - 1
                state[1, lane] = offsets[boundary, now]
            else:
                a = state[2, lane] - stiffness * state[0, lane] - damping * belt
                now = event + 1 if a + A[event + 1] > 0.0 else event if a + A[event] < 0.0 else 3 + event
                state[1, lane] = belt if now > 3 else offsets[event, now]
            modes[lane], p_now[:, lane] = now, pars[now]
            counts[lane] += 1
            return True

        return act

    rates, functions = equations(motion)
    events = [hy.t_event_batch(f, callback=callback(n), cooldown=0.0) for n, f in enumerate(functions, 1)]
    blank = np.zeros((4, LANES))
    integrator = hy.taylor_adaptive_batch(rates, blank, t_events=events, tol=HEYOKA_BATCH_TOLERANCE, fast_math=True,
                                          pars=np.zeros((8, LANES)))  # fmt: skip

    def run() -> np.ndarray:
        found = []
        for begin in range(0, len(starts), LANES):
            t, x, v = starts[begin : begin + LANES].T
            modes[:] = 1 + (v > motion.belts[1]) + (v > motion.belts[2])
            counts[:] = 0
            integrator.set_time(0.0)
            phase, swing = motion.Omega * t, motion.B0 / motion.m
            integrator.state[:] = x, v, swing * np.cos(phase), swing * np.sin(phase)
            integrator.pars[:] = np.array([pars[mode] for mode in modes.tolist()]).T
            integrator.propagate_until(duration, max_steps=MOST_BATCH_STEPS)
            found.append(counts.copy())
        return np.concatenate(found)

    return run
