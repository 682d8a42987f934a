"""B. F. Feeny and J. W. Liang, J. Sound Vib. 195 (1996) 149-154: decrements of a free motion.

With q = exp(-pi h / omega_d), h = c/2, half a cycle takes the turning point x > F to
-q x + (1 + q) F. The text was not at hand: the formula is derived anew.
"""

from __future__ import annotations

from collections.abc import Iterator

from wall import MP, Row, number, show, wall

from symosc import simulate


def decrements() -> Iterator[Row]:
    """Free motion from x = 1.5, c = 0.2, F = 0.1, P = 0: where it turns, and at last stays."""
    x = number("1.5")
    F = number("0.1")
    h = number("0.2") / 2
    q = MP.exp(-MP.pi * h / MP.sqrt(1 - h * h))
    path = simulate(wall("0.1", 1, "0.2", P=0), t0=0, x0="1.5", v0=0, t_end=40)
    for i, event in enumerate(path.events, 1):
        x = -q * x + (1 + q) * MP.sign(x) * F
        yield Row(f"x_{i}", "", x, event.x)


if __name__ == "__main__":
    show(decrements)
