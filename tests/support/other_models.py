"""Other models drawn at random, and their own equations of motion, followed without anything of symosc."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from symosc import OtherModel

TURN = 2 * np.pi
#: What makes each model of the page: names of numbers that are drawn, and those that are given.
KINDS: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "any phase": (("B0", "phase", "c"), {}),
    "a sine, two belts": (("B0", "A0", "v1", "v2", "mu1", "mu2"), {"phase": "-pi/2"}),
    "base motion": (("Y", "Y_phase", "c"), {}),
    "joined wall": (("Y", "c"), {"joined": True}),
    "joined wall and force": (("Y", "Y_phase", "B0", "phase", "c"), {"joined": True}),
    "oscillating belts": (("W", "W_phase", "v1", "v2", "mu1", "mu2", "B0", "c"), {}),
    "incline": (("B0", "phase", "angle", "v1", "c"), {"FN": None, "g": "9.81", "mu1": "1/5"}),
    "pulled spring": (("pull", "c", "v1", "v2", "mu1", "mu2"), {}),
    "pulled wall": (("pull", "Y", "c"), {"joined": True}),
    "pulled and more": (("pull", "B0", "Y", "Y_phase", "W", "v1", "v2", "mu1", "mu2", "c"), {}),
    "all": (
        (
            "B0",
            "phase",
            "Y",
            "Y_phase",
            "W",
            "W_phase",
            "v1",
            "v2",
            "mu1",
            "mu2",
            "A0",
            "angle",
            "c",
        ),
        {"g": 2},
    ),
}


def drawn(kind: str, seed: int) -> OtherModel:
    """Return a random model of a kind."""
    dice = random.Random(f"{kind} {seed}")
    (names, given) = KINDS[kind]

    def number(low: float, high: float) -> Fraction:
        return Fraction(round(1000 * dice.uniform(low, high)), 1000)

    ranges = {
        "c": (0.05, 1),
        "v1": (-1, 0.5),
        "v2": (0.7, 2),
        "mu1": (0.1, 1),
        "mu2": (0.1, 1),
        "A0": (-1, 1),
    }
    ranges |= {
        "pull": (-0.5, 0.5),
        "angle": (0.05, 0.5),
        "B0": (0.5, 3),
        "Y": (0.5, 3),
        "W": (0.5, 3),
    }
    numbers: dict[str, Any] = {name: number(*ranges.get(name, (-4, 4))) for name in names}
    basic = {
        "m": number(0.5, 2),
        "k": number(0.5, 4),
        "Omega": number(0.4, 3),
        "FN": number(0.2, 1),
    }
    return OtherModel(**basic | numbers | given)


class Original:
    """A model's own equation of motion in doubles, x'' = right side, with belts whose speed changes."""

    def __init__(self, model: OtherModel) -> None:
        self.n = {
            name: float(getattr(model, name) or 0)
            for name in vars(model)
            if name in OtherModel.__annotations__ and name != "belts"
        }
        self.one_belt, self.step = (
            model.v2 is None,
            TURN / 100 / max(model.Omega, (model.k / model.m) ** 0.5),
        )
        if model.FN is None:
            self.n["FN"] = self.n["m"] * self.n["g"] * np.cos(self.n["angle"])

    def base(self, t: float) -> tuple[float, float, float]:
        """Return y, y' and y''."""
        Y = self.n["Y"]
        Om = self.n["Omega"]
        angle = self.n["Omega"] * t + self.n["Y_phase"]
        pull = self.n["pull"]
        y = Y * np.cos(angle) + pull * t
        return y, -Y * Om * np.sin(angle) + pull, -Y * Om**2 * np.cos(angle)

    def belts(self, t: float) -> tuple[list[float], float]:
        """Return the speeds of the belts, and their acceleration."""
        angle = self.n["Omega"] * t + self.n["W_phase"]
        n = self.n
        if n["joined"]:
            _, rate, second = self.base(t)
        else:
            _, rate, second = (0.0, 0.0, 0.0)
        more = n["W"] * np.cos(angle) + rate
        speeds = [n["v1"] + more] + ([] if self.one_belt else [n["v2"] + more])
        return speeds, second - n["W"] * n["Omega"] * np.sin(angle)

    def others(self, t: float, x: float, v: float) -> float:
        """Return all forces but friction."""
        n = self.n
        (y, rate, _) = self.base(t)
        given = (
            n["A0"]
            + n["B0"] * np.cos(n["Omega"] * t + n["phase"])
            + n["m"] * n["g"] * np.sin(n["angle"])
        )
        return float(given - n["c"] * (v - rate) - n["k"] * (x - y))

    def follow(
        self, t: float, x: float, v: float, t_end: float
    ) -> tuple[list[tuple[float, float, str]], Any]:
        """Return events (t, x, kind) and the states at 200 times, by DOP853 with its own events."""
        most = [self.n[mu] * self.n["FN"] for mu in ("mu1", "mu2")[: 1 if self.one_belt else 2]]
        sides = [
            1 if v > speed else -1 for speed in self.belts(t)[0]
        ]  # of the mass, seen from each belt
        stuck: int | None = None
        found = []
        parts = []

        def slip(t: float, z: np.ndarray) -> list[float]:
            friction = -sum(side * force for side, force in zip(sides, most, strict=True))
            return [z[1], (self.others(t, *z) + friction) / self.n["m"]]

        def stick(t: float, z: np.ndarray) -> list[float]:
            speeds, acceleration = self.belts(t)
            return [speeds[stuck], acceleration]

        def needed(t: float, z: np.ndarray) -> float:
            """Return the friction of the belt that the mass is stuck to, or would be."""
            other = -sum(
                side * force
                for i, (side, force) in enumerate(zip(sides, most, strict=True))
                if i != stuck
            )
            return self.n["m"] * self.belts(t)[1] - self.others(t, *z) - other

        while t < t_end:
            if stuck is None:
                ends = [lambda t, z, i=i: z[1] - self.belts(t)[0][i] for i in range(len(sides))]
                for end, side in zip(ends, sides, strict=True):
                    end.terminal, end.direction = True, -side  # type: ignore[attr-defined]
            else:
                ends = [lambda t, z, most=most[stuck]: most - abs(needed(t, z))]
                ends[0].terminal, ends[0].direction = True, -1  # type: ignore[attr-defined]
            run = solve_ivp(
                slip if stuck is None else stick, (t, t_end), [x, v], "DOP853",
                events=ends, rtol=1e-12, atol=1e-13, max_step=self.step, dense_output=True,
            )  # fmt: skip
            parts.append((t, run.sol))
            hit = next((i for i, times in enumerate(run.t_events) if len(times)), None)
            t = run.t[-1]
            (x, v) = run.y[:, -1]
            if hit is None:
                break
            if stuck is None:
                stuck = hit
                way = -sides[hit]
                if abs(needed(t, np.array([x, v]))) < most[hit]:
                    found.append((t, x, "stick"))
                else:
                    stuck = None
                    sides[hit] = way
                    found.append((t, x, "cross"))
            # friction is at its limit: the mass is faster than the belt if it cannot be held back
            else:
                if needed(t, np.array([x, v])) > 0:
                    sides[stuck] = -1
                else:
                    sides[stuck] = 1
                stuck = None
                found.append((t, x, "slip"))
        return found, lambda t: next(part for since, part in reversed(parts) if since <= t)(t)
