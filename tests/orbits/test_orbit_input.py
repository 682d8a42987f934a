"""Bad input of orbits and branches: one clear line that names the argument."""

from __future__ import annotations

import random
from typing import Any

import mpmath
import numpy as np
import pytest
from bad_values import refused

from symosc import find_orbit, load_scene

P = load_scene("fig9").parameters
ORBIT = find_orbit(P, "P32")
DEEP: Any = 1
for _ in range(50):
    DEEP = [DEEP]


#: Nothing of this is a number of digits.
NO_DIGITS = [
    0,
    4,
    -5,
    10**9,
    10**400,
    20.0,
    "20",
    "",
    True,
    1j,
    [20],
    (),
    {},
    np.array([5, 6]),
    np.array([20]),
    DEEP,
]
NO_DIGITS += [
    np.array(["20"]),
    np.array([None, 1]),
    np.float64(20),
    float("nan"),
    float("inf"),
    mpmath.mpf(20),
    int,
]


def test_digits() -> None:
    for value in NO_DIGITS:
        refused(lambda value=value: find_orbit(P, "P32", digits=value), "digits")  # type: ignore[misc]


NO_GUESSES = [
    5,
    "ab",
    b"ab",
    (None, None),
    {},
    object(),
    10**400,
    [10**400, 1],
    [[True, 1], [2, 1]],
    [1j, 2],
    DEEP,
]
NO_GUESSES += [
    ["1", "2"],
    [["1_0", "2"], ["20", "3"]],
    [["１", "2"]],
    np.array(["1", "2"]),
    np.array([True, False]),
]
NO_GUESSES += [
    np.array(3.0),
    np.array([1.0, 2.0, 3.0]),
    np.zeros((2, 3)),
    [[0, float("nan")], [1, 1]],
    [[1], [1, 2]],
]


@pytest.mark.parametrize("value", NO_GUESSES, ids=lambda value: repr(value)[:20])
def test_guesses(value: Any) -> None:
    refused(lambda: find_orbit(P, "P32", value), "guess")


def test_guesses_in_every_form() -> None:
    (t0, x0), (t1, x1) = ORBIT.points
    rng = random.Random(1)
    for convert in (float, np.float64, mpmath.mpf, lambda value: round(value, rng.randint(4, 9))):
        guess = [[convert(t0), convert(x0)], [convert(t1), convert(x1)]]
        for arguments in (guess, tuple(map(tuple, guess)), np.array(guess)):
            assert np.allclose(
                np.array(find_orbit(P, "P32", arguments).points), np.array(ORBIT.points)
            )


def test_periods_follow_from_the_guess() -> None:
    assert find_orbit(P, "P32", ORBIT.points[0]).periods == 1  # from a motion that begins there
    turn = float(ORBIT.period)
    (t0, x0), (t1, x1) = ORBIT.points
    twice = [
        (t0, x0),
        (t1, x1),
        (t0 + turn, x0),
        (t1 + turn, x1),
    ]  # less than a period from the second to the last
    assert find_orbit(P, "P3232", twice).periods == 2
