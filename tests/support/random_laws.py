"""Random oscillators with belts as a test draws them, and problems whose events are clear."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from stiction_solver import Solved, UnclearError, solved

from symosc import Belt, Oscillator

Rng = np.random.Generator
Start = tuple[float, float, float]
Problem = tuple[Oscillator, Start, float, Solved, Rng]


def driven(rng: Rng, belts: list[Belt]) -> Oscillator:
    """Return an oscillator with these belts, in four of five cases with a drive."""
    drive: dict[str, Any] = {}
    if rng.random() < 0.8:
        drive = {"B0": round(rng.uniform(0.1, 2.0), 2), "Omega": round(rng.uniform(0.3, 3.0), 2)}
    return Oscillator(
        m=round(rng.uniform(0.3, 2.0), 2),
        c=round(rng.choice([0.0, rng.uniform(0.0, 0.4)]), 2),
        k=round(rng.uniform(0.5, 4.0), 2),
        A0=round(rng.uniform(-0.3, 0.3), 2),
        belts=belts,
        **drive,
    )


def clear_problems(
    seed: int, draw: Callable[[Rng], Oscillator], ends: tuple[float, float]
) -> Iterator[Problem]:
    """Yield random problems whose events are clear, with the solution of a careful user of scipy.

    They end between the times `ends`.
    """
    rng = np.random.default_rng(seed)
    while True:
        p = draw(rng)
        start = (0.0, round(rng.uniform(-1.5, 1.5), 3), round(rng.uniform(-1.0, 1.0), 3))
        t_end = round(rng.uniform(*ends), 1)
        try:
            right = solved(p, start, t_end)
        except UnclearError:
            continue
        if right.events:
            yield p, start, t_end, right, rng
