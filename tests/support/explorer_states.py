"""Texts for the page of `symosc explore`."""

from __future__ import annotations

import random
from fractions import Fraction

from symosc import load_scene

FIG5 = load_scene("fig5")


def random_state(rng: random.Random) -> dict[str, str]:
    """Return texts of all kinds: whole numbers, decimals, fractions, with exponents."""

    def text(low: float, high: float) -> str:
        value = rng.uniform(low, high)
        return rng.choice(
            [
                f"{value:.3f}",
                f"{value:.2e}",
                f"{round(value * 7)}/7",
                f" {value!r} ",
                str(Fraction(value).limit_denominator(99)),
            ]
        )

    state = {name: text(-20, 20) for name in ("A0", "B0", "x0", "v0", "t0")}
    state |= {name: text(0.5, 9) for name in ("m", "c", "k", "Omega", "mu1", "mu2", "FN")}
    return state | {
        "mu_s1": "",
        "mu_s2": "",
        "v1": text(-9, -1),
        "v2": text(1, 9),
        "periods": text(0.6, 30),
        "scene": rng.choice(["mine", "fig9"]),
    }
