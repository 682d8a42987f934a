"""Columns of problems: read exactly, begun as one by one, with errors that name the row."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError, Parameters, load_scene
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.batch import row_of
from symosc.engine.start import first_state, last_time
from symosc.simulation.batch import INTERPRETED
from symosc.simulation.problems import NumberColumn, Problems, decimal_rest

FIG9 = load_scene("fig9").parameters


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([1, 2, float("nan")], r"x\[2\] = nan: must be finite"),
        (np.array([1.0, np.inf]), r"x\[1\] = inf: must be finite"),
        (np.array([1.0, 1e60, 1e70]), r"x\[1\] = 1e\+60: must be at most"),
        ([1, True], r"x\[1\] = True: give an int"),
        ([1, [2]], r"x\[1\] = \[2\]: give an int"),
        ("one", r"x = 'one': give a number"),
        (np.zeros((2, 2)), r"must be a number or have shape \(n,\)"),
    ],
)
def test_bad_numbers_are_named_by_their_row(given: Any, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        NumberColumn("x", given)


def begun(problems: Problems) -> np.ndarray:
    return problems.begin(slice(0, len(problems)), INTERPRETED.march_rows)[0].states


def assert_begun_as_alone(problems: Problems) -> None:
    """Compare with the exact start: mode, belt and forces that are 0 to the bit, numbers but for rounding."""
    states = begun(problems)
    for i in range(len(problems)):
        arithmetic = Arithmetic(problems[i].parameters)
        alone = row_of(first_state(problems[i], arithmetic), *last_time(problems[i], arithmetic))
        assert states[i, :3].tolist() == alone[:3]
        assert ((states[i, 6:8] == 0.0) == (np.array(alone[6:8]) == 0.0)).all()
        np.testing.assert_allclose(states[i], np.array(alone, float), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_motions_begin_as_one_by_one(seed: int) -> None:
    """On and beside belts, at large times, at phases next to 0, with forces that are 0."""
    dice = random.Random(seed)
    sets = [FIG9.replace(Omega=dice.choice((4, 0.7, dice.uniform(1, 6))), mu1=dice.choice((0, 0.3))) for _ in range(60)]
    starts: list[tuple[Any, ...]] = []
    for p in sets:
        t = dice.choice(
            (0, 0.1, dice.uniform(-9, 9), 10**8, dice.uniform(-1e9, 1e9), "6.28318530717958647692528676656")
        )
        v = dice.choice((p.v1, 25.0, dice.uniform(-9, 30), Fraction(p.v2) + Fraction(1, 10**25), 1.0))
        rest = (p.A0 + (p.mu2 - p.mu1) * p.FN + p.B0 - p.c) / p.k  # the force above belt 1 is 0 at t = 0
        starts.append((t, dice.choice((rest, dice.uniform(-9, 9), 0)), v))
    ends = [float(t) + 10 if isinstance(t, str) else t + dice.choice((1, 0.5)) for t, _, _ in starts]
    assert_begun_as_alone(Problems(sets, starts, ends))
    assert_begun_as_alone(Problems(sets, starts, ends, (Fraction(0), Fraction(1, 10**9), Fraction(0))))


@pytest.mark.parametrize("speed", ["0.1", "1/3", "1", "0.7000000000000001"])
def test_a_start_is_on_a_belt_if_the_exact_numbers_are_equal(speed: str) -> None:
    """Whatever types they have: doubles that are equal need not stand for equal numbers."""
    p, given = FIG9.replace(v1=speed), Fraction(speed)
    near = [
        given,
        given + Fraction(1, 10**20),
        given - Fraction(1, 10**40),
        float(given),
        speed,
        Fraction(float(given)),
    ]
    problems = Problems(p, {"t0": 0, "x0": "0.4", "v0": [*near, 2, 3]}, 5)
    expected = [int(problems[i].v0 == p.v1) for i in range(8)]
    assert begun(problems)[:, 1].tolist() == expected
    assert expected[:3] == [1, 0, 0]
    doubles = Problems(p, {"t0": 0, "x0": np.linspace(0, 1, 9), "v0": np.full(9, float(given))}, 5)
    assert begun(doubles)[:, 1].tolist() == [int(Fraction(repr(float(given))) == given)] * 9


def columns(**changes: Any) -> dict[str, Any]:
    return FIG9.by_name() | changes


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (columns(m=[1, 0, 1]), r"m\[1\] = '0': must be > 0"),
        (columns(c=np.array([0.0, 1.0, -1.0])), r"c\[2\] = '-1': must be >= 0"),
        (columns(v1=[1, 2, 25]), r"v1\[2\] = '25': must be less than v2 = 25"),
        (columns(v1=[1, 2, Fraction(25) - Fraction(1, 10**40)], Omega=[1, 2, 0]), r"Omega\[2\] = '0': must be > 0"),
        (columns(Omega=[1, 2], m=[1, 2, 3]), r"Omega = 2: must have 1 or 3 entries"),
        (columns(omega=1), "omega = 1: is no parameter"),
        ({"m": 1}, "c is missing"),
        ([FIG9, "fig9"], "give Parameters, a sequence of them, or a mapping"),
        (3, "give Parameters"),
    ],
)
def test_bad_parameters_are_named_by_their_row(parameters: Any, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Problems(parameters, (0, 0, 0), 1)


def test_speeds_that_are_equal_as_doubles_may_differ() -> None:
    near = Fraction(25) - Fraction(1, 10**40)
    assert isinstance(Problems(columns(v1=[1, near, 2]), (0, 0, 0), 1)[1].parameters, Parameters)


@pytest.mark.parametrize(
    ("starts", "t_end", "message"),
    [
        ({"t0": 0, "x0": 1}, 1, "must have the names t0, x0 and v0"),
        ({"t0": 0, "x0": [1, 2], "v0": [1, 2, 3]}, 1, "x0 = 2: must have 1 or 3 entries"),
        ([[0, 0]], 1, "starts"),
        ([[0, 0, 0]] * 2, [1, 2, 3], "starts"),
        ([2, 0, 0], 1, "t_end"),
        (np.zeros((3, 3)), [1, 2, 0], r"t_end\[2\] = '0': must be later than t0 = 0"),
        (np.zeros((3, 3)), [[1, 2, 3]], r"t_end.*shape \(n,\)"),
        (np.array([[0, 0, 0], [0, np.nan, 0]]), 1, r"x0\[1\] = nan: must be finite"),
    ],
)
def test_bad_starts_are_named_by_their_row(starts: Any, t_end: Any, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Problems(FIG9, starts, t_end)


def test_what_a_double_lacks_of_its_decimal() -> None:
    values = [0.1, 1 / 7, -2 / 3, 123.456, 1e14 / 7, 3e-4 / 7, 5.0, -0.3, 0.0]
    rest, sure = decimal_rest(np.array(values))
    assert sure.all()
    assert rest.tolist() == [float(Fraction(repr(value)) - Fraction(value)) for value in values]
