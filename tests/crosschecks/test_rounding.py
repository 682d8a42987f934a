"""Rounded samples: recognised, judged at their precision; right ones pass and wrong ones do not."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice, product
from typing import Any

import numpy as np
import pytest
from careful_solver import solve
from excerpts import crosscheck
from fault_scenes import SAMPLINGS, Case, cases
from rounded_solutions import DEVIATION, right, wrong_solutions

from symosc import crosscheck as strict
from symosc import load_scene, simulate
from symosc.crosschecks.rounding import find_digits

# -- rounding --------------------------------------------------------------------------------------


Round = Callable[[Any], np.ndarray]


def decimals(count: int) -> tuple[Round, str]:
    return lambda values: np.array(
        [float(f"{value:.{count}f}") for value in values]
    ), f"{count} decimals"


def significant(count: int) -> tuple[Round, str]:
    words = f"{count} significant digits"
    return lambda values: np.array([float(f"{value:.{count - 1}e}") for value in values]), words


@pytest.mark.parametrize("count", [1, 2, 3, 6, 10])
@pytest.mark.parametrize("kind", [decimals, significant])
def test_digits_are_counted(kind: Any, count: int) -> None:
    rng = np.random.default_rng(count)
    cut, words = kind(count)
    sizes = [1.0, 1e-4, 1e6]
    if kind is decimals:
        sizes = [1.0, 0.5, 1e6 if count < 6 else 2.0]
    for size in sizes:
        values = rng.uniform(-9, 9, 300) * size * 10.0 ** rng.uniform(-1, 1, 300)
        digits = find_digits(cut(values))
        assert digits is not None
        assert digits.text == words
        # One unit of the last digit, which the rounding error never exceeds by half.
        assert np.all(np.abs(cut(values) - values) <= 0.5000001 * digits.units)
        assert np.max(np.abs(cut(values) - values) / digits.units) > 0.3


# -- rounded solutions -----------------------------------------------------------------------------


RUNS = [
    pytest.param(7, 500, id="few"),
    pytest.param(23, 800, marks=pytest.mark.slow),
    pytest.param(1_000, 4_000, marks=pytest.mark.campaign),
]


@pytest.mark.parametrize(("count", "samples"), RUNS)
def test_wrong_solutions_are_found(count: int, samples: int) -> None:
    """More than 20 last places off somewhere, with 0 to 5 decimals, against the scene or its
    parameters.
    """
    missed = []
    for number, wrong in enumerate(wrong_solutions(count, count, samples)):
        if number % 4:
            scene = wrong.scene
        else:
            scene = wrong.scene.parameters
        if strict(scene, wrong.t, wrong.x, wrong.v).ok:
            missed.append(
                f"{wrong.scene.name}: {wrong.kind}, {wrong.decimals} decimals, off by {wrong.off:.3g} places"
            )
    assert missed == []


@pytest.mark.parametrize(
    "count",
    [pytest.param(3, marks=pytest.mark.slow), pytest.param(100, marks=pytest.mark.campaign)],
)
def test_wrong_positions_are_found(count: int) -> None:
    """Without velocities: the positions alone are more than 20 last places off somewhere."""
    missed = []
    off = (wrong for wrong in wrong_solutions(count, 10 * count, 1_500) if wrong.off_x > DEVIATION)
    for number, wrong in enumerate(islice(off, count)):
        if number % 4:
            scene = wrong.scene
        else:
            scene = wrong.scene.parameters
        if strict(scene, wrong.t, wrong.x).ok:
            missed.append(
                f"{wrong.scene.name}: {wrong.kind}, {wrong.decimals} decimals, {wrong.off_x:.3g} places"
            )
    assert missed == []


@pytest.mark.parametrize(("count", "samples"), RUNS)
def test_right_solutions_are_not_blamed(count: int, samples: int) -> None:
    """Dense and sparse, with velocities and without, of the scene's start or of a rounded one."""
    rng = np.random.default_rng(count)
    blamed = []
    for number in range(count):
        rounded_samples = right(rng, samples)
        if number % 3:
            scene = rounded_samples.scene
        else:
            scene = rounded_samples.scene.parameters
        if number % 4 or rounded_samples.kind != "right":
            v = rounded_samples.v
        else:
            v = None
        check = strict(scene, rounded_samples.t, rounded_samples.x, v)
        if not check.ok:
            blamed.append(
                f"{rounded_samples.scene.name}, {rounded_samples.kind}, "
                f"{rounded_samples.decimals} decimals: {check.summary()}"
            )
    assert blamed == []


def test_what_rounding_hid() -> None:
    """Half of c in fig5 with 2 decimals, and velocities 0, 2, 0, 2, ...

    Each a nanosecond after the other.
    """
    t = np.linspace(0, 40, 8_001)
    p = load_scene("fig5").parameters
    x, v = np.round(simulate(p.replace(c=p.c / 2), t0=0, x0=0, v0=0, t_end=40)(t), 2)
    check = strict("fig5", t, x, v)
    assert not check.ok
    assert check.max_error_x > 3
    assert check.limits_there[0] < 0.02
    assert len(check.wrong_spans)
    t = np.arange(2_000) * 1e-9
    check = strict("fig5", t, 0 * t, np.arange(2_000) % 2 * 2.0, partial=True)
    assert len(check.wrong_steps) == 1_999


def test_the_global_tolerance_is_obeyed_beside_the_rounding() -> None:
    t = np.linspace(0, 40, 801)
    x, v = np.round(np.array(simulate("fig5")(t)) + [[3e-3], [0]] * np.minimum(t, 1), 4)
    assert not strict("fig5", t, x, v).ok
    for tolerance in (1e-12, 1e-4):
        check = strict("fig5", t, x, v, global_tolerance=tolerance)
        assert not check.ok
        rounding = 0.5e-4 * (1 + 2**0.5)  # of the sample, and of the start where k = m
        assert np.max(check.limits[:, 0]) <= tolerance * check.scales[0] + rounding * 1.001
    exact = np.round(simulate("fig5")(t), 4)
    assert strict("fig5", t, *exact, global_tolerance=1e-12).ok


# -- false alarms ----------------------------------------------------------------------------------


#: Significant digits, decimals, steps of a converter in bits; None: all digits.
WAYS = [
    None,
    *((what, n) for n in range(6, 17) for what in ("digits", "decimals")),
    *(("bits", n) for n in (8, 12, 16)),
]


def rounded(values: np.ndarray, way: tuple[str, int] | None) -> np.ndarray:
    if way is None:
        return values
    what, n = way
    if what == "digits":
        return np.array([float(f"{value:.{n - 1}e}") for value in values.tolist()])
    if what == "decimals":
        return np.round(values, n)
    step = float(np.max(np.abs(values))) / 2**n
    return np.rint(values / step) * step


def everything() -> list[tuple[Case, str, tuple[str, int] | None]]:
    return list(product(cases(), SAMPLINGS, WAYS))


def alarms(chosen: list[tuple[Case, str, tuple[str, int] | None]]) -> Iterator[str]:
    """Yield right solutions that are called wrong."""
    for case, sampling, way in chosen:
        t = case.times(sampling, np.random.default_rng([8, SAMPLINGS.index(sampling)]))
        x, v = case.exact(t)
        if way and way[0] != "bits" and sampling in ("own steps", "random"):
            t = rounded(t, way)
            if np.any(np.diff(t) <= 0.0):
                continue
        check = crosscheck(case.scene, t, rounded(x, way), rounded(v, way))
        if not check.ok:
            yield f"{case.scene.name}, {sampling}, {way}: {check.summary()}"


@pytest.mark.parametrize(
    "every",
    [
        pytest.param(211, id="few"),
        pytest.param(61, marks=pytest.mark.slow),
        pytest.param(1, marks=pytest.mark.campaign),
    ],
)
def test_right_solutions_are_right(every: int) -> None:
    assert list(alarms(everything()[3::every])) == []


@pytest.mark.parametrize(
    "every", [pytest.param(40, marks=pytest.mark.slow), pytest.param(1, marks=pytest.mark.campaign)]
)
def test_scipy_at_fine_tolerances_is_right(every: int) -> None:
    """... unless it misses a contact, as it does where a stick is shorter than its step.

    Then it is off, or told so.
    """
    chosen = list(product(cases(), ("DOP853", "RK45"), (1e-9, 1e-10, 1e-11, 1e-12)))[1::every]
    wrong = []
    for case, method, rtol in chosen:
        run = solve(case.scene, case.t_end, method=method, rtol=rtol, atol=0.1 * rtol)
        tolerance = max(1e-8, 1000.0 * rtol)
        t = np.minimum(run.t, case.t_end)
        off = np.max(np.abs(case.exact(t) - [run.x, run.v]), axis=1) / np.max(
            np.abs(case.exact(t)), axis=1
        )
        check = crosscheck(case.scene, run.t, run.x, run.v, events=run.events, tolerance=tolerance)
        there = sum(event.kind != "graze" for event in case.exact.events)
        told = (
            len(run.events) < there
            and len(check.missed) == there - len(run.events)
            and not check.invented
        )
        if not check.ok and np.max(off) < 10.0 * tolerance and not told:
            wrong.append(f"{case.scene.name}, {method}, {rtol}: {check.summary()}")
    assert wrong == []
