"""Bad input of orbits, branches, words and grazing functions: one clear line that names the argument."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from bad_values import refused

import symosc
from symosc import Scene, find_orbit, load_scene, read_word
from symosc.errors import ParameterError, SceneError
from symosc.exact import read_start_error
from symosc.words import WordError

P = load_scene("fig9").parameters
ORBIT = find_orbit(P, "P32")
DEEP: Any = 1
for _ in range(50):
    DEEP = [DEEP]


@cache
def branch() -> symosc.Branch:
    return symosc.continue_orbit(P, "P32", "Omega", ("3.99", "4.01"), ORBIT)


#: Nothing of this is a number of digits.
NO_DIGITS = [0, 4, -5, 10**9, 10**400, 20.0, "20", "", True, 1j, [20], (), {}, np.array([5, 6]), np.array([20]), DEEP]
NO_DIGITS += [np.array(["20"]), np.array([None, 1]), np.float64(20), float("nan"), float("inf"), mpmath.mpf(20), int]
DIGITS: dict[str, Callable[[Any], Any]] = {
    "simulate": lambda digits: symosc.simulate("fig5", digits=digits),
    "find_orbit": lambda digits: find_orbit(P, "P32", digits=digits),
    "Branch.orbit": lambda digits: branch().orbit(0, digits=digits),
    "grazing_start": lambda digits: symosc.grazing_start(P, "P2", "3.1", digits=digits),
    "solve_grazing": lambda digits: symosc.solve_grazing(P, "P2", theta_j=3, digits=digits),
}


@pytest.mark.parametrize("name", DIGITS)
def test_digits(name: str) -> None:
    for value in NO_DIGITS:
        refused(lambda value=value: DIGITS[name](value), "digits")  # type: ignore[misc]


NO_GUESSES = [5, "ab", b"ab", (None, None), {}, object(), 10**400, [10**400, 1], [[True, 1], [2, 1]], [1j, 2], DEEP]
NO_GUESSES += [["1", "2"], [["1_0", "2"], ["20", "3"]], [["１", "2"]], np.array(["1", "2"]), np.array([True, False])]
NO_GUESSES += [np.array(3.0), np.array([1.0, 2.0, 3.0]), np.zeros((2, 3)), [[0, float("nan")], [1, 1]], [[1], [1, 2]]]


@pytest.mark.parametrize("value", NO_GUESSES, ids=lambda value: repr(value)[:20])
def test_guesses(value: Any) -> None:
    refused(lambda: find_orbit(P, "P32", value), "guess")


def test_guesses_in_every_form() -> None:
    (t0, x0), (t1, x1) = ORBIT.points
    rng = random.Random(1)
    for convert in (float, np.float64, mpmath.mpf, lambda value: round(value, rng.randint(4, 9))):
        guess = [[convert(t0), convert(x0)], [convert(t1), convert(x1)]]
        for given in (guess, tuple(map(tuple, guess)), np.array(guess)):
            assert np.allclose(np.array(find_orbit(P, "P32", given).points), np.array(ORBIT.points))


# --- words and names ---


@pytest.mark.parametrize(
    "value", ["9" * 10_000, "P" + "9" * 500, 10**800, DEEP, "a\0b\nc", load_scene("fig5"), ["P2"] * 900]
)
def test_messages_about_words_and_scenes_are_short_and_can_be_printed(value: Any) -> None:
    for call in (
        lambda: read_word(value),
        lambda: Scene("s", P, 0, 0, 0, 1, structure=value),
        lambda: load_scene(value),
    ):
        with pytest.raises((WordError, SceneError, ParameterError)) as caught:
            call()
        assert str(caught.value).isprintable()
        assert len(str(caught.value)) < 420


# --- grazing, arrays ---


@pytest.mark.parametrize(
    "value",
    [None, "", 5, [], ["k", "k"], ["k", "c", "m"], {}, np.array([1, 2]), np.array(["k", "v"]), True, float("nan")],
)
def test_names_of_parameters(value: Any) -> None:
    refused(lambda: symosc.values_containing(P, "P2", value, 1), "name")
    refused(lambda: symosc.values_containing(None, "P2", value), "name")
    refused(lambda: symosc.values_empty(P, "P2", value), "name")
    refused(lambda: symosc.values_everything(P, "P2", value), "name")


NO_ARRAYS = [None, "1", ["1", 2], [True, 1.0], np.array([True]), np.array([1, True], dtype=object), [1j], 10**400]
NO_ARRAYS += [[10**400], [[1], [1, 2]], {}, object(), [float("nan")], [1, float("inf")], np.array(["1"])]


@pytest.mark.parametrize("value", NO_ARRAYS, ids=lambda value: repr(value)[:20])
def test_arrays(value: Any) -> None:
    refused(lambda: symosc.grazing_windows(P, "P2", B0=value), "B0")
    refused(lambda: symosc.residual(P, "P3", (value, 0.0), (1.0, np.array([9.0]))), "x_i")
    refused(lambda: symosc.jacobian(P, "P3", (1.0, 0.0), (value, np.array([9.0]))), "x_j")
    refused(lambda: symosc.solve_map(P, "P2", value, 1.0), "x_i")


def test_an_array_without_dimensions_is_a_number() -> None:
    assert read_start_error(np.array(0.5)) == read_start_error(0.5)
    refused(lambda: read_start_error(np.array("a")), "start_error")
    refused(lambda: read_start_error(np.array([1, 2])), "start_error")
