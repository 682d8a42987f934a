"""Random fits: a motion whose events tell some of its numbers, and first values that are off."""

from __future__ import annotations

import random
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from symosc import Fit, Parameters, Scene, load_scene, sensitivities, simulate

#: What is fitted.
FREE: list[tuple[str, ...]] = [
    ("k",),
    ("k",),
    ("c",),
    ("mu1",),
    ("mu2",),
    ("Omega",),
    ("FN",),
    ("B0",),
    ("A0",),
]
FREE += [("k", "c"), ("mu1", "c"), ("mu1", "mu2"), ("k", "mu1"), ("Omega", "k"), ("mu1", "c", "k")]
SIGMA = 0.002


@dataclass(frozen=True)
class FitSet:
    """A fit to be made: `scene` has the right numbers, `events` are exact."""

    scene: Scene
    free: tuple[str, ...]
    truth: dict[str, float]
    start: dict[str, float]
    events: list[tuple[float, str]]
    slopes: np.ndarray  # of the times of events by the numbers

    @property
    def inverse(self) -> np.ndarray:
        """The covariance of numbers fitted to events with errors of size 1."""
        return np.asarray(np.linalg.inv(self.slopes.T @ self.slopes))

    def noisy(self, dice: np.random.Generator, sigma: float = SIGMA) -> list[tuple[float, str]]:
        return [(t + sigma * dice.normal(), kind) for t, kind in self.events]

    def with_outlier(self, dice: np.random.Generator) -> tuple[list[tuple[float, str]], int]:
        """Return noisy events of which one is far off, and its row.

        The others can do without it: what alone tells a number cannot be seen to be wrong.
        """
        events = self.noisy(dice)
        leverage = np.einsum("ij,jk,ik->i", self.slopes, self.inverse, self.slopes)
        row = int(dice.choice(np.flatnonzero(leverage < 0.5)))
        off = dice.choice([-1, 1]) * dice.uniform(0.03, 0.5)
        events[row] = (events[row][0] + off, events[row][1])
        return events, row

    def is_right(self, found: Fit, most: float = 5.0) -> bool:
        """Return whether all fitted numbers are within so many errors of the right ones."""
        return all(
            abs(found.values[name] - value) <= most * found.errors[name]
            for name, value in self.truth.items()
        )


def hundredth(dice: random.Random, low: float, high: float) -> Fraction:
    return Fraction(dice.randint(round(100 * low), round(100 * high)), 100)


def fit_set(seed: int, off: float) -> FitSet:
    """Return a random set with first values off by up to the part `off`, half of them just so."""
    dice = random.Random(seed)
    while True:
        scene = _scene(dice)
        motion = simulate(scene)
        free = dice.choice(FREE)
        truth = {name: float(getattr(scene.parameters, name)) for name in free}
        if not 8 <= len(motion.events) <= 120 or min(map(abs, truth.values())) < 0.05:
            continue
        slopes = sensitivities(scene, free).dt
        if np.linalg.matrix_rank(slopes) < len(free):
            continue
        inverse = np.linalg.inv(slopes.T @ slopes)
        errors = SIGMA * np.sqrt(np.diag(inverse))
        if np.all(errors < 0.02 * np.abs(list(truth.values()))):
            break
    start = {}
    for name, value in truth.items():
        part = dice.choice([1.0, dice.random()])
        start[name] = value * (1.0 + off * part * dice.choice([-1, 1]))
    events = [(float(event.t), event.kind) for event in motion.events]
    return FitSet(scene, free, truth, start, events, slopes)


def _scene(dice: random.Random) -> Scene:
    """Return a random scene of a few periods."""
    v1 = hundredth(dice, -6, 1)
    p = Parameters(
        m=hundredth(dice, 0.3, 2),
        c=hundredth(dice, 0.1, 2),
        k=hundredth(dice, 1, 10),
        A0=hundredth(dice, -6, 6),
        B0=hundredth(dice, 2, 12),
        Omega=hundredth(dice, 0.3, 2.5),
        mu1=hundredth(dice, 0.1, 0.8),
        mu2=hundredth(dice, 0.1, 0.8),
        FN=hundredth(dice, 0.5, 4),
        v1=v1,
        v2=v1 + hundredth(dice, 0.5, 6),
    )
    t0 = hundredth(dice, 0, 5)
    x0 = hundredth(dice, -3, 3)
    v0 = hundredth(dice, -6, 6)
    return Scene("random", p, t0, x0, v0, t0 + dice.choice([20, 44, 60]))


def sampled(
    seed: int, decimals: int | None, noise: float, columns: str = "xv", count: int = 300
) -> tuple[Scene, dict[str, np.ndarray]]:
    """Return fig5 with mu1 and c a little different, and samples of it, with noise and rounded."""
    dice = np.random.default_rng(seed)
    fig5 = load_scene("fig5")
    p = fig5.parameters.replace(
        mu1=repr(0.8 + 0.02 * dice.uniform(-1, 1)), c=repr(1.0 + 0.02 * dice.uniform(-1, 1))
    )
    scene = Scene("random", p, fig5.t0, fig5.x0, fig5.v0, Fraction(20))
    t = np.linspace(0, 20, count + 1)[1:]
    data = {"t": t}
    for name, values in zip("xv", simulate(scene)(t), strict=True):
        if name in columns:
            measured = values + noise * dice.normal(size=count)
            data[name] = measured if decimals is None else np.round(measured, decimals)
    return scene, data


def pulls(scene: Scene, found: Fit) -> list[float]:
    """Return by how many of its errors each fitted parameter is off."""
    p = scene.parameters
    return [
        (value - float(getattr(p, name))) / found.errors[name]
        for name, value in found.values.items()
    ]
