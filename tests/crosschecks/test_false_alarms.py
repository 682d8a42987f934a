"""Right solutions are never called wrong: exact ones, rounded ones, and those of scipy at fine tolerances."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest
from careful_solver import solve
from excerpts import crosscheck
from fault_scenes import SAMPLINGS, Case, cases

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
        pytest.param(37, marks=pytest.mark.slow),
        pytest.param(1, marks=pytest.mark.campaign),
    ],
)
def test_right_solutions_are_right(every: int) -> None:
    assert list(alarms(everything()[3::every])) == []


@pytest.mark.parametrize(
    "every", [pytest.param(40, marks=pytest.mark.slow), pytest.param(1, marks=pytest.mark.campaign)]
)
def test_scipy_at_fine_tolerances_is_right(every: int) -> None:
    """... unless it misses a contact, as it does where a stick is shorter than its step: then it is off, or told so."""
    chosen = list(product(cases(), ("DOP853", "RK45"), (1e-9, 1e-10, 1e-11, 1e-12)))[1::every]
    wrong = []
    for case, method, rtol in chosen:
        run = solve(case.scene, case.t_end, method=method, rtol=rtol, atol=0.1 * rtol)
        tolerance = max(1e-8, 1000.0 * rtol)
        t = np.minimum(run.t, case.t_end)
        off = np.max(np.abs(case.exact(t) - [run.x, run.v]), axis=1) / np.max(np.abs(case.exact(t)), axis=1)
        check = crosscheck(case.scene, run.t, run.x, run.v, events=run.events, tolerance=tolerance)
        there = sum(event.kind != "graze" for event in case.exact.events)
        told = len(run.events) < there and len(check.missed) == there - len(run.events) and not check.invented
        if not check.ok and np.max(off) < 10.0 * tolerance and not told:
            wrong.append(f"{case.scene.name}, {method}, {rtol}: {check.summary()}")
    assert wrong == []
