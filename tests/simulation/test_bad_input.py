"""Bad input in Python: one clear line that names the argument, never a raw error and never a silent acceptance."""

from __future__ import annotations

import random
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from bad_values import NO_NUMBERS, refused

from symosc import Scene, load_scene, simulate, simulate_many
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact

P = load_scene("fig5").parameters
START = {"t0": 0, "x0": 0, "v0": 0, "t_end": 5}
TRAJECTORY = simulate("fig5", t_end=5)


# --- numbers ---


@pytest.mark.parametrize(
    "value",
    [*NO_NUMBERS, None],
    ids=lambda value: repr(value)[:30] if not isinstance(value, int) else "int",
)
def test_what_is_no_number_is_no_number_anywhere(value: Any) -> None:
    refused(lambda: read_exact("k", value), "k")
    refused(lambda: P.replace(k=value), "k")
    refused(lambda: Scene("s", P, **(START | {"x0": value})), "x0")
    if value is not None:
        refused(lambda: simulate(P, **(START | {"v0": value})), "v0")
    with pytest.raises(ParameterError, match=r"^(starts|x0) = "):
        simulate_many(P, [[0, value, 0]], 5)


@pytest.mark.slow
def test_numbers_are_read_as_they_are_written() -> None:
    rng = random.Random(1)
    for _ in range(150):
        sign = rng.choice(["", "+", "-"])
        whole = rng.randrange(10 ** rng.randint(1, 20))
        part = rng.randrange(10**9)
        exponent = rng.randint(-25, 25)
        for text in (
            f"{sign}{whole}",
            f"{sign}{whole}.{part}",
            f"{sign}.{part}",
            f"{sign}{whole}.",
            f"{sign}{whole}/7",
        ):
            assert read_exact("k", f" {text}\n") == Fraction(text)
            if "/" not in text:
                assert read_exact("k", f"{text}e{exponent}") == Fraction(f"{text}e{exponent}")
        text = f"{whole}.{part}"
        for place in range(1, len(text)):
            for letter in "_ １,'":
                refused(lambda bad=text[:place] + letter + text[place:]: read_exact("k", bad), "k")  # type: ignore[misc]


# --- simulate, simulate_many ---


@pytest.mark.parametrize(
    "value", [None, 5, "", [], [[]], [0, 0], [[0, 0]], [[0, 0, 0], [1]], {}, [[[0, 0, 0]]]]
)
def test_starts_of_many(value: Any) -> None:
    refused(lambda: simulate_many(P, value, 5), "starts")


@pytest.mark.parametrize(
    "value", [None, "", [], [[5]], [5, 5], {}, float("nan"), True, 0, -1, [5, [5]]]
)
def test_ends_of_many(value: Any) -> None:
    with pytest.raises(ParameterError, match=r"^t_end(\[\d\])? = "):
        simulate_many(P, [[0, 0, 0]] * 3, value)


# --- a trajectory ---


@pytest.mark.parametrize(
    "value",
    [
        None,
        "",
        "abc",
        1j,
        True,
        [True],
        {},
        [1, None],
        [[1], [1, 2]],
        [1, float("nan")],
        -1e-9,
        5.1,
        10**400,
        b"1",
    ],
)
def test_times_of_a_trajectory(value: Any) -> None:
    for call in (TRAJECTORY, TRAJECTORY.mode, lambda t: TRAJECTORY.force(1, t)):
        refused(lambda call=call: call(value), "t")  # type: ignore[misc]


def test_times_may_be_any_numbers_in_any_shape() -> None:
    for t in (
        Fraction(1, 3),
        "1/3",
        Decimal("0.25"),
        mpmath.mpf("0.3"),
        np.float32(0.5),
        3,
        np.int8(1),
    ):
        assert TRAJECTORY(t).shape == (2,)
    assert TRAJECTORY("1/3").tolist() == TRAJECTORY(1 / 3).tolist()
    assert TRAJECTORY([[1, "2", Fraction(1, 2)]]).shape == (2, 1, 3)
    assert TRAJECTORY([]).shape == (2, 0)


def test_the_force_of_each_domain() -> None:
    rng = np.random.default_rng(3)
    for t in rng.uniform(0, 5, 20):
        (x, v) = TRAJECTORY(t)
        p = P
        for alpha in (1, 2, 3):
            force = (
                float(p.A(alpha))
                + float(p.B0) * np.cos(float(p.Omega) * t)
                - float(p.c) * v
                - float(p.k) * x
            ) / float(p.m)
            assert TRAJECTORY.force(alpha, t) == pytest.approx(force, abs=1e-12)
