"""Columns of problems: read exactly, begun as one by one, with errors that name the row."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from symosc import Parameters, load_scene
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.batch import row_of
from symosc.engine.start import first_state, last_time
from symosc.engine.state import STATE_ROW
from symosc.model import by_name
from symosc.simulation.loops import INTERPRETED
from symosc.simulation.problems import Problems, decimal_rest

FIG9 = load_scene("fig9").parameters


def begun(problems: Problems) -> np.ndarray:
    return problems.begin(slice(0, len(problems)), INTERPRETED.table)[0].states


def assert_begun_as_alone(problems: Problems) -> None:
    """Compare with the exact start.

    Mode, belt and forces that are 0 to the bit, numbers but for rounding.
    """
    states = begun(problems)
    for i in range(len(problems)):
        arithmetic = Arithmetic(problems[i].parameters)
        row = row_of(first_state(problems[i], arithmetic), *last_time(problems[i], arithmetic))
        alone = np.array([row], STATE_ROW)[0]
        for name in ("mode", "at", "n"):
            assert states[i][name] == alone[name]
        for name in ("Fb", "Fa"):
            assert (states[i][name] == 0.0) == (alone[name] == 0.0)
        np.testing.assert_allclose(states[i].item(), alone.item(), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_motions_begin_as_one_by_one(seed: int) -> None:
    """On and beside belts, at large times, at phases next to 0, with forces that are 0."""
    dice = random.Random(seed)
    sets = [
        FIG9.replace(Omega=dice.choice((4, 0.7, dice.uniform(1, 6))), mu1=dice.choice((0, 0.3)))
        for _ in range(60)
    ]
    starts: list[tuple[Any, ...]] = []
    for p in sets:
        t = dice.choice(
            (
                0,
                0.1,
                dice.uniform(-9, 9),
                10**8,
                dice.uniform(-1e9, 1e9),
                "6.28318530717958647692528676656",
            )
        )
        v = dice.choice(
            (p.v1, 25.0, dice.uniform(-9, 30), Fraction(p.v2) + Fraction(1, 10**25), 1.0)
        )
        rest = (
            p.A0 + (p.mu2 - p.mu1) * p.FN + p.B0 - p.c
        ) / p.k  # the force above belt 1 is 0 at t = 0
        starts.append((t, dice.choice((rest, dice.uniform(-9, 9), 0)), v))
    ends = [
        float(t) + 10 if isinstance(t, str) else t + dice.choice((1, 0.5)) for t, _, _ in starts
    ]
    assert_begun_as_alone(Problems(sets, starts, ends))
    assert_begun_as_alone(
        Problems(sets, starts, ends, (Fraction(0), Fraction(1, 10**9), Fraction(0)))
    )


@pytest.mark.parametrize("speed", ["0.1", "1/3", "1", "0.7000000000000001"])
def test_a_start_is_on_a_belt_if_the_exact_numbers_are_equal(speed: str) -> None:
    """Whatever types they have: doubles that are equal need not stand for equal numbers."""
    p = FIG9.replace(v1=speed)
    arguments = Fraction(speed)
    near = [
        arguments,
        arguments + Fraction(1, 10**20),
        arguments - Fraction(1, 10**40),
        float(arguments),
        speed,
        Fraction(float(arguments)),
    ]
    problems = Problems(p, {"t0": 0, "x0": "0.4", "v0": [*near, 2, 3]}, 5)
    expected = [int(problems[i].v0 == p.v1) for i in range(8)]
    assert begun(problems)["at"].tolist() == expected
    assert expected[:3] == [1, 0, 0]
    doubles = Problems(
        p, {"t0": 0, "x0": np.linspace(0, 1, 9), "v0": np.full(9, float(arguments))}, 5
    )
    assert begun(doubles)["at"].tolist() == [int(Fraction(repr(float(arguments))) == arguments)] * 9


def columns(**changes: Any) -> dict[str, Any]:
    return by_name(FIG9) | changes


def test_speeds_that_are_equal_as_doubles_may_differ() -> None:
    near = Fraction(25) - Fraction(1, 10**40)
    assert isinstance(Problems(columns(v1=[1, near, 2]), (0, 0, 0), 1)[1].parameters, Parameters)


def test_what_a_double_lacks_of_its_decimal() -> None:
    values = [0.1, 1 / 7, -2 / 3, 123.456, 1e14 / 7, 3e-4 / 7, 5.0, -0.3, 0.0]
    rest, sure = decimal_rest(np.array(values))
    assert sure.all()
    assert rest.tolist() == [float(Fraction(repr(value)) - Fraction(value)) for value in values]
