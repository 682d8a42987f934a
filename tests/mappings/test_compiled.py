"""Compiled residuals: against the same equations in 40 digits, in every regime.

Words, sticks, a user's own loop.
"""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from map_points import REGIMES, Size, draw, draw_points, sizes
from mpmath import mp

from symosc import (
    ParameterError,
    WordError,
    compiled_residual,
    find_orbit,
    jacobian,
    load_scene,
    residual,
)

pytest.importorskip("numba")


def points_of(rng: random.Random, p: Any, count: int) -> np.ndarray:
    return np.array([draw_points(rng, p) for _ in range(count)]).T


def found(p: Any, label: str, point: list[Any], exit: str | None) -> np.ndarray:
    """Return f1, f2 and their derivatives one point at a time, without compiled code."""
    ends = (point[:2], point[2:], exit)
    return np.array([*residual(p, label, *ends), *jacobian(p, label, *ends).ravel()])


#: Compiling the formulas of flights takes ten seconds, those of sticks for all regimes two.
LABELS = [pytest.param(label, marks=pytest.mark.slow) for label in ("P1", "P3", "P4", "P8")]


@pytest.mark.full(2)
@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("label", LABELS)
def test_every_regime_agrees_with_many_digits(regime: str, label: str) -> None:
    rng = random.Random(f"compiled {regime} {label}")
    if label in ("P1", "P4"):
        exit = rng.choice(("below", "above"))
    else:
        exit = None
    errors = []
    before = []
    for _ in range(2):
        p = draw(rng, regime)
        z = points_of(rng, p, 8)
        f1, f2, J = compiled_residual(p, label, jacobian=True, exit=exit)(*z)
        assert np.array_equal((f1, f2), compiled_residual(p, label, exit=exit)(*z))
        for n, point in enumerate(z.T.tolist()):
            plain = found(p, label, point, exit)
            with mp.workdps(40):
                true = found(p, label, [mp.mpf(value) for value in point], exit)
            sizes_here = [
                Size(size).value + 1e-300
                for part in sizes(p, label, point, exit)[:2]
                for size in np.ravel(part)
            ]
            errors += list(np.abs([f1[n], f2[n], *J[:, :, n].ravel()] - true) / sizes_here)
            before += list(np.abs(plain - true) / sizes_here)
    assert max(errors) < 1e-13
    assert np.quantile(errors, 0.9) < max(1e-15, 1.2 * np.quantile(before, 0.9))


@pytest.mark.slow
def test_phases_beyond_our_own_sine_use_the_librarys() -> None:
    p = load_scene("fig9").parameters
    theta_i = np.array([0.5, 3e6, 1e12, 0.25])
    x_i = np.full(4, 4.5)
    x_j = np.full(4, -4.0)
    theta_j = theta_i + np.array([3.5, 3.5, 3.5, 1.7e6])
    residuals = compiled_residual(p, "P2")(x_i, theta_i, x_j, theta_j)
    expected = [
        residual(p, "P2", (a, b), (c, d))
        for a, b, c, d in zip(x_i, theta_i, x_j, theta_j, strict=True)
    ]
    np.testing.assert_allclose(residuals, np.transpose(expected), rtol=0, atol=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "word"), [("fig9", "P32"), ("fig10", "P6454")])
def test_a_word_vanishes_on_its_orbit_and_its_blocks_are_those_of_its_maps(
    scene: str, word: str
) -> None:
    p = load_scene(scene).parameters
    orbit = find_orbit(p, word)
    f = compiled_residual(p, word, jacobian=True)
    x = np.array([[point.x] for point in orbit.points])
    theta = np.array([[point.t * float(p.Omega)] for point in orbit.points])
    if len(x) == len(f.maps):  # the first point comes again after a period
        x = np.vstack([x, x[:1]])
        theta = np.vstack([theta, theta[:1] + 2 * np.pi])
    values, blocks = f(x, theta)
    assert values.shape == (2 * len(f.maps), 1)
    assert np.abs(values).max() < 1e-10
    for n, label in enumerate(f.maps):
        start = (x[n, 0], theta[n, 0])
        end = (x[n + 1, 0], theta[n + 1, 0])
        np.testing.assert_allclose(
            blocks[n, ..., 0], jacobian(p, label, start, end), rtol=0, atol=1e-11
        )


def test_bad_input_is_named() -> None:
    p = load_scene("fig9").parameters
    z = [np.array([value]) for value in (4.5, 0.5, -4.0, 4.0)]
    with pytest.raises(ParameterError, match="must be Parameters"):
        compiled_residual(None, "P3")  # type: ignore[arg-type]
    with pytest.raises(WordError, match="P99"):
        compiled_residual(p, "P99")
    with pytest.raises(ParameterError, match="exit"):
        compiled_residual(p, "P3", exit="below")
    f = compiled_residual(p, "P2")
    for columns in (
        [z[0], z[1], z[2], np.zeros(0)],
        z[:3],
        [np.ones((1, 1))] * 4,
        [z[0], z[1], z[2], ["a"]],
    ):
        with pytest.raises(ParameterError, match="points"):
            f(*columns)
    with pytest.raises(ParameterError, match="unwrapped"):
        f(z[0], z[3], z[2], z[1])
    word = compiled_residual(p, "P32")
    with pytest.raises(ParameterError, match="3 rows"):
        word(np.ones((2, 1)), np.ones((2, 1)))
    with pytest.raises(ParameterError, match="must be a single map, not a word"):
        _ = word.scalar
