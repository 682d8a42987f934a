"""The engine computes the same in any units, to the last bit: every step, and the errors of events."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
from agreement import BASE
from touches import tenths
from units import UNITS, Units

from symosc import Parameters, load_scene
from symosc.engine.start import Start
from symosc.simulation.motion import Motion

MOTIONS = ["fig5", "fig6", "fig8", "fig9", "fig10", "fig8-exact", "fig7-exact"]


def drawn(rng: random.Random) -> tuple[Parameters, Fraction, Fraction, Fraction]:
    """Return parameters of any damping, with and without spring and drive, and a start."""
    p = BASE.replace(
        m=tenths(rng, 2, 30), c=rng.choice([Fraction(0), tenths(rng, 0, 60)]), Omega=tenths(rng, 3, 40),
        k=rng.choice([Fraction(0), tenths(rng, 1, 60)]), B0=rng.choice([Fraction(0), tenths(rng, -60, 60)]),
        A0=tenths(rng, -30, 30), FN=tenths(rng, 0, 40),
    )  # fmt: skip
    return p, tenths(rng, 0, 30), tenths(rng, -40, 40), rng.choice([p.v1, p.v2, tenths(rng, -30, 30)])


def steps(start: Start, most: int) -> list[tuple[Any, ...]]:
    """Return what each step of the engine ends with, without asking for more digits."""
    path, found = Motion(start), []
    while not path.ended and len(found) < most:
        path.step()
        s = path.state
        last = path.events[-1] if path.events else None
        errors = (last.t_error, last.x_error) if last else (0.0, 0.0)
        found.append((path.code, path.decided, s.mode, s.at, s.n, s.theta, s.x, s.v, s.Fb, s.Fa, *s.S, s.t, *errors))
    return found


def factors(units: Units) -> list[float]:
    """Return by what the numbers of a step are multiplied: codes, state, covariance, time, and an event's errors."""
    T, L, V, F = float(units.time), float(units.length), units.speed, units.force
    return [1, 1, 1, 1, 1, 1, L, V, F, F, L * L, L * V, V * V, T, T, L]


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", UNITS, ids=str)
def test_every_step_is_the_same_in_any_units(units: Units) -> None:
    """Of the paper's motions and of random ones: codes, states and the covariance of their errors."""
    rng, count = random.Random(21), 0
    problems = [(s.parameters, s.t0, s.x0, s.v0) for s in map(load_scene, MOTIONS)]
    problems += [drawn(rng) for _ in range(25)]
    T, L, _ = units
    for p, t0, x0, v0 in problems:
        end = t0 + 12
        errors = rng.choice([None, (Fraction(0), Fraction(1, 2**20), Fraction(1, 2**22))])
        scaled = errors and (Fraction(0), errors[1] * L, errors[2] * L / T)
        plain = steps(Start(p, t0, x0, v0, end, errors), 25)
        other = steps(Start(units.of(p), t0 * T, x0 * L, v0 * L / T, end * T, scaled), 25)
        assert len(plain) == len(other)
        for one, two in zip(plain, other, strict=True):
            assert two == tuple(value * factor for value, factor in zip(one, factors(units), strict=True))
        count += len(plain)
    assert count > 100
