"""Many problems in columns: the same starts as one by one, and errors that name the row."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError, Parameters, load_scene
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.batch import row_of
from symosc.engine.start import first_state
from symosc.model import PARAMETER_NAMES
from symosc.simulation.batch_loop import chosen_loops
from symosc.simulation.problems import Problems
from symosc.simulation.run import last_time

FIG9 = load_scene("fig9").parameters
TWO_PI = "6.28318530717958647692528676656"


def begun(problems: Problems) -> np.ndarray:
    loops = chosen_loops(False)
    return problems.begin(slice(0, len(problems)), loops.first_rows, loops.march_rows).batch.states


def alone(problems: Problems) -> list[list[float]]:
    rows = []
    for problem in problems:
        arithmetic = Arithmetic(problem.parameters)
        rows.append(row_of(first_state(problem, arithmetic), *last_time(problem, arithmetic)))
    return rows


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
    problems = Problems(sets, starts, ends)
    assert begun(problems).tolist() == alone(problems)
    with_error = Problems(sets, starts, ends, (Fraction(0), Fraction(1, 10**9), Fraction(0)))
    assert begun(with_error).tolist() == alone(with_error)


def test_what_is_never_reached_ends_before() -> None:
    problems = Problems(FIG9, (0, 0, 0), [1, 10**12] * 5)
    assert begun(problems).tolist() == alone(problems)
    assert begun(problems)[1, 13] < 1e12


def test_columns_of_starts() -> None:
    x0 = np.linspace(-1, 1, 9)
    rows = Problems(FIG9, np.column_stack([np.zeros(9), x0, np.ones(9)]), 3)
    named = Problems(FIG9, {"t0": 0, "x0": x0, "v0": 1}, np.full(9, 3.0))
    assert [named[i] for i in range(9)] == [rows[i] for i in range(9)]
    assert begun(named).tolist() == begun(rows).tolist()


def columns(**changes: Any) -> dict[str, Any]:
    return {name: getattr(FIG9, name) for name in PARAMETER_NAMES} | changes


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (columns(m=[1, 0, 1]), r"m\[1\] = '0': must be > 0"),
        (columns(c=np.array([0.0, 1.0, -1.0])), r"c\[2\] = '-1': must be >= 0"),
        (columns(v1=[1, 2, 25]), r"v1\[2\] = '25': must be less than v2 = 25"),
        (columns(v1=[1, 2, Fraction(25) - Fraction(1, 10**40)], Omega=[1, 2, 0]), r"Omega\[2\] = '0': must be > 0"),
        (columns(Omega=[1, "x", 2]), r"Omega\[1\]"),
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


def test_speeds_that_differ_by_less_than_doubles_tell_are_told_apart() -> None:
    near = Fraction(25) - Fraction(1, 10**40)
    assert isinstance(Problems(columns(v1=[1, near, 2]), (0, 0, 0), 1)[1].parameters, Parameters)


@pytest.mark.parametrize(
    ("starts", "t_end", "message"),
    [
        ({"t0": 0, "x0": 1}, 1, "must have the names t0, x0 and v0"),
        ({"t0": 0, "x0": 1, "v0": 2, "a0": 1}, 1, "must have the names t0, x0 and v0"),
        ({"t0": 0, "x0": [1, 2], "v0": [1, 2, 3]}, 1, "x0 = 2: must have 1 or 3 entries"),
        (np.zeros((3, 3)), [1, 2, 0], r"t_end\[2\] = '0': must be later than t0 = 0"),
        (np.zeros((3, 3)), [[1, 2, 3]], r"t_end.*shape \(n,\)"),
        (np.array([[0, 0, 0], [0, np.nan, 0]]), 1, r"x0\[1\] = nan: must be finite"),
    ],
)
def test_bad_starts_are_named_by_their_row(starts: Any, t_end: Any, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Problems(FIG9, starts, t_end)


def test_a_few_motions_begin_as_many_do() -> None:
    """A few are begun one by one, many in columns."""
    rng = np.random.default_rng(5)
    starts = np.column_stack([rng.uniform(-5, 5, 60), rng.uniform(-1, 1, 60), rng.choice([1.0, 25.0, 0.3], 60)])
    together = begun(Problems(FIG9, starts, 50.5))
    assert together.tolist() == [begun(Problems(FIG9, row, 50.5))[0].tolist() for row in starts]
