"""Wrong input to the grazing functions costs one clear line that names the argument."""

from __future__ import annotations

import re
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
import sympy

from symosc import (
    ParameterError,
    check_grazing,
    grazing_curve,
    grazing_start,
    grazing_window,
    is_grazing,
    load_scene,
    solve_grazing,
    theorem7,
)
from symosc.grazing.sweep import grazing_windows

P = load_scene("fig10").parameters
NAN = float("nan")
NUMBERS: list[Any] = [
    "abc", "nan", NAN, np.float64("nan"), float("inf"), Decimal("NaN"), True, np.True_, [1], {}, 1j, b"1", object(),
    np.array([1.0, 2.0]), np.array(["a"]), sympy.I, sympy.zoo, sympy.nan, sympy.oo, sympy.Matrix([[1]]),
    sympy.Interval(0, 1), "pi/0", "pi pi", "(" * 100 + "pi", "9" * 6000 + "*pi",
]  # fmt: skip
WITH_NUMBER: dict[str, Callable[[Any], Any]] = {
    "theta": lambda value: grazing_start(P, "P6", value),
    "t_m": lambda value: grazing_start(P, "P6", t_m=value),
    "t0": lambda value: grazing_start(P, "P6", 4, t0=value),
    "digits": lambda value: grazing_start(P, "P6", 4, digits=value),
    "periods": lambda value: grazing_start(P, "P6", 4, periods=value),
    "x_i": lambda value: solve_grazing(P, "P6", n=8, x_i=value),
    "x_j": lambda value: solve_grazing(P, "P6", x_j=value),
    "theta_i": lambda value: solve_grazing(P, "P6", n=8, theta_i=value),
    "theta_m": lambda value: solve_grazing(P, "P6", theta_m=value),
    "x": lambda value: is_grazing(P, "P6", value, 1),
    "tolerance": lambda value: is_grazing(P, "P6", 1, 1, tolerance=value),
    "gamma": lambda value: theorem7("P6", value, 1),
}
COUNTS: list[Any] = [0, -1, 10**12, 1.5, True, np.True_, None, "10", NAN, [5], np.float64(20)]
WITH_COUNT: dict[str, Callable[[Any], Any]] = {
    "curve": lambda n: grazing_curve(P, "P6", n),
    "check": lambda n: check_grazing(P, "P6", n=n),
    "solve": lambda n: solve_grazing(P, "P6", n=n, x_i=1),
}


def assert_refused(name: str, call: Callable[[], Any]) -> None:
    with pytest.raises(ParameterError) as caught:
        call()
    assert caught.value.name == name
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("name", list(WITH_NUMBER))
def test_what_is_no_number(name: str) -> None:
    for value in NUMBERS:
        assert_refused(name, lambda value=value: WITH_NUMBER[name](value))


@pytest.mark.parametrize("function", list(WITH_COUNT))
def test_what_is_no_count(function: str) -> None:
    for n in COUNTS:
        assert_refused("n", lambda n=n: WITH_COUNT[function](n))
    WITH_COUNT[function](np.int64(8))


def test_phases_of_a_window() -> None:
    window = grazing_window(P, "P6")
    for theta in (sympy.Matrix([[1]]), None, [1], 1j, "abc", NAN, True):
        assert_refused("theta", lambda theta=theta: window.contains(theta))
        assert_refused("theta", lambda theta=theta: window.contact(theta))


def test_sweeps() -> None:
    for swept, name in (
        ({"k": [1.0, 2.0], "B0": [1.0, 2.0, 3.0]}, "swept"),
        ({"k": [1.0, 2.0], "B0": np.ones((3, 3))}, "swept"),
        ({"k": [[1.0], [1.0, 2.0]]}, "k"),
        ({"k": np.array([1j])}, "k"),
        ({"k": np.array([True])}, "k"),
        ({"k": b"1"}, "k"),
        ({"k": ["a"]}, "k"),
        ({"k": [-1.0]}, "k"),
        ({"c": [1.0]}, "c"),
    ):
        assert_refused(name, lambda swept=swept: grazing_windows(P, "P6", **swept))
    with pytest.raises(ParameterError, match=re.escape("k: (2,), B0: (3,)")):
        grazing_windows(P, "P6", k=[1.0, 2.0], B0=[1.0, 2.0, 3.0])


def test_seeds() -> None:
    for seed in (-1, 1.5, "a", None, NAN, [1], True):
        assert_refused("seed", lambda seed=seed: check_grazing(P, "P6", n=1, seed=seed))


@pytest.mark.slow
def test_windows_compare() -> None:
    columns = [grazing_windows(P, "P6", k=[0.0, 1.0, 5.0]) for _ in range(2)]
    assert (columns[0] == columns[1]) is True
    assert (columns[0] != grazing_windows(P, "P6", k=[0.0, 1.0, 6.0])) is True


def test_figures() -> None:
    from symosc.plot.windows import figure_grazing_curve, sweep_figure, window_figure

    for windows in (None, 5, "x", [], P, [None]):
        assert_refused("windows", lambda windows=windows: window_figure(windows))
    for curve in (None, 5, "x", []):
        assert_refused("curve", lambda curve=curve: figure_grazing_curve(curve))
    assert_refused("p", lambda: sweep_figure("fig9", "P2", "k"))  # type: ignore[arg-type]
    assert_refused("mapping", lambda: sweep_figure(P, ["P2"], "k"))  # type: ignore[arg-type]
