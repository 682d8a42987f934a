"""Papers that announce chaos: no motion of this model is chaotic (`symosc derive exponents`).

This script prints the largest Lyapunov exponent of 20 random oscillators, m = k = P = 1, c from 0 to
1, Omega from 0.05 to 3, F from 0.01 to 1, over 60 periods from random starts. A test does the same
for 200.
"""

from __future__ import annotations

import random

from wall import wall

from symosc import sensitivities


def largest_exponent(count: int, seed: int = 0) -> float:
    """Return the largest exponent of `count` random oscillators."""
    dice = random.Random(seed)
    exponents = []
    for _ in range(count):
        F = f"{dice.uniform(0.01, 1):.3f}"
        Omega = f"{dice.uniform(0.05, 3):.3f}"
        c = f"{dice.choice((0, dice.uniform(0, 1))):.3f}"
        start = dice.uniform(-2, 2)
        answer = sensitivities(wall(F, Omega, c), "x0", t0=0, x0=start, v0=0, t_end="60T")
        exponents.append(float(answer.lyapunov[0]))
    return max(exponents)


if __name__ == "__main__":
    largest = largest_exponent(20)
    assert largest <= 0
    print(f"largest exponent of 20 oscillators: {largest:.3g}")
