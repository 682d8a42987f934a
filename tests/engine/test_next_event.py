"""One step: how errors are carried along, the phase and the time, units, and steps in many digits."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from math import sqrt
from typing import Any

import mpmath
import pytest
from agreement import BASE
from touches import tenths
from units import UNITS, Units

from symosc import Parameters, load_scene, simulate
from symosc.engine.arithmetic import Arithmetic, MpArithmetic
from symosc.engine.batch import open_free_time
from symosc.engine.next_event import advance, time_with_errors
from symosc.engine.start import Start, first_state, last_time, rounded
from symosc.engine.state import END, FAILED, GRAZE, REST, NextEvent, State
from symosc.simulation.motion import Motion

pytestmark = pytest.mark.usefixtures("interpreted")


# -- how long a quantity may take to pass 0 ---------------------------------------------------------------------------


# -- what is handed out ------------------------------------------------------------------------------------------------


def shifted(p: Parameters, x0: Fraction, v0: Fraction, push: Fraction, t_end: int) -> Any:
    return simulate(p, t0=0, x0=x0 + push, v0=v0, t_end=t_end, digits=25).events


@pytest.mark.slow
def test_errors_travel_through_events_as_pushed_starts_do() -> None:
    """A start error of x alone.

    Each event's estimate is what a push of the start does to it, through all kinds.
    """
    rng = random.Random(7)
    push = Fraction(1, 10**9)
    kinds = set()
    for _ in range(12):
        p = BASE.replace(
            c=tenths(rng, 0, 9), k=tenths(rng, 5, 40), mu1=tenths(rng, 1, 5), mu2=tenths(rng, 0, 5)
        )
        x0 = tenths(rng, -30, 30)
        v0 = tenths(rng, -9, 14)
        motion = simulate(
            p, t0=0, x0=x0, v0=v0, t_end=6, start_error=(0, push, 0), digits=25
        ).events
        plain, moved = (shifted(p, x0, v0, amount, 6) for amount in (Fraction(0), push / 1000))
        for event, second, further in zip(motion, plain, moved, strict=True):
            kinds.add(event.kind)
            at_event = 1000 * float(abs(further.t - second.t))
            assert event.t_error == pytest.approx(sqrt(3) * at_event, rel=1e-3, abs=1e-20)
            x_moved = 1000 * float(abs(further.x - second.x))
            assert event.x_error >= 0.999 * sqrt(3) * x_moved - 1e-20
            assert (
                event.x_error
                <= 1.001 * sqrt(3) * (x_moved + 2 * abs(float(event.v)) * at_event) + 1e-20
            )
    assert kinds == {"cross", "stick", "slip"}


DIGITS = 40
FINE = Fraction(1, 10**34)


def random_start(seed: int) -> Start:
    """Return a motion of any regime.

    With or without damping, spring and drive, stiff, resonant, from anywhere.
    """
    dice = random.Random(seed)
    c = dice.choice((0, 0.001, 0.1, 1, 4, 40))
    k = dice.choice((0, 0.5, 4, 20, 80))
    p = Parameters(
        m=1,
        c=c,
        k=k,
        A0=dice.choice((0, dice.randint(-30, 30))),
        B0=dice.choice((0, dice.randint(1, 150))),
        Omega=dice.choice((2, Fraction(dice.randint(10, 800), 100))),
        v1=-Fraction(dice.randint(1, 40), 10),
        v2=Fraction(dice.randint(1, 40), 10),
        mu1=Fraction(dice.randint(0, 8), 10),
        mu2=Fraction(dice.randint(0, 8), 10),
        FN=dice.randint(0, 20),
    )
    v0 = dice.choice((p.v1, p.v2, Fraction(dice.randint(-60, 60), 10)))
    t0 = Fraction(dice.choice((0, dice.randint(0, 60))), 10)
    return Start(p, t0, Fraction(dice.randint(-30, 30), 10), v0, t0 + 9)


def pairs_of_steps(
    start: Start, most: int = 25
) -> Iterator[tuple[Motion, Any, Any, State, NextEvent]]:
    """Yield what goes into a step with many digits, and take the step."""
    arithmetic = MpArithmetic(start.parameters, DIGITS)
    doubles = Arithmetic(start.parameters)
    path = Motion(start, arithmetic)
    end = last_time(start, doubles)
    for _ in range(most):
        rough = rounded(path.state, float(start.t0), doubles.K.Om_gain)
        yield path, path._state, path._end, rough, doubles.advance(rough, *end)
        path.step()
        if path.ended:
            return


def exact(number: Any) -> Fraction:
    """Return a number of any arithmetic as a fraction.

    Mpmath's, where gmpy2 is missing, have no method for that.
    """
    if hasattr(number, "_mpf_"):
        return Fraction(*mpmath.libmp.to_rational(number._mpf_))
    return Fraction(*number.as_integer_ratio())


def assert_alike(near: NextEvent, full: NextEvent) -> None:
    assert near[:3] == full[:3]
    for a, b in zip(near.state[:8] + near.state[9:], full.state[:8] + full.state[9:], strict=True):
        assert abs(exact(a) - exact(b)) <= FINE * max(1, abs(int(b)))


def compared(path: Motion, state: Any, end: Any, rough: State, computed: NextEvent) -> NextEvent:
    """Check a step against one that searches with many digits, and return it."""
    free = open_free_time(computed, rough, Arithmetic(path.start.parameters).K)
    functions = path.arithmetic.following
    with path.arithmetic.precision():
        near: NextEvent = functions["advance_near"](state, rough, computed, free, *end, path.K)
        assert_alike(near, functions["advance"](state, *end, path.K))
    return near


@pytest.mark.parametrize("seed", range(60))
def test_steps_are_those_of_a_search_with_many_digits(seed: int) -> None:
    for step in pairs_of_steps(random_start(seed)):
        compared(*step)


MOTIONS = ["fig5", "fig6", "fig8", "fig9", "fig10", "fig8-exact", "fig7-exact"]


def drawn(rng: random.Random) -> tuple[Parameters, Fraction, Fraction, Fraction]:
    """Return parameters of any damping, with and without spring and drive, and a start."""
    p = BASE.replace(
        m=tenths(rng, 2, 30), c=rng.choice([Fraction(0), tenths(rng, 0, 60)]), Omega=tenths(rng, 3, 40),
        k=rng.choice([Fraction(0), tenths(rng, 1, 60)]), B0=rng.choice([Fraction(0), tenths(rng, -60, 60)]),
        A0=tenths(rng, -30, 30), FN=tenths(rng, 0, 40),
    )  # fmt: skip
    return (
        p,
        tenths(rng, 0, 30),
        tenths(rng, -40, 40),
        rng.choice([p.v1, p.v2, tenths(rng, -30, 30)]),
    )


def steps(start: Start, most: int) -> list[tuple[Any, ...]]:
    """Return what each step of the engine ends with, without asking for more digits."""
    own = Arithmetic(start.parameters)
    computed = list[tuple[Any, ...]]()
    K = own.K
    state = first_state(start, own)
    t0 = float(start.t0)
    t_end, low = last_time(start, own)
    low = low - (t_end - t0) * K.Om_gain
    errors = (0.0, 0.0)
    while len(computed) < most:
        code, _, decided, t_error, s = advance(state, t_end, low, K)
        if code <= GRAZE:
            _, *errors = time_with_errors(s.t, s.t_low, t0, s.x, s.v, t_error, s.S.S11, K)
        computed.append(
            (code, decided, s.mode, s.at, s.n, s.theta, s.x, s.v, s.Fb, s.Fa, *s.S, s.t, *errors)
        )
        if code in (END, REST, FAILED):
            break
        state = s
    return computed


def factors(units: Units) -> list[float]:
    """Return by what the numbers of a step are multiplied.

    Codes, state, covariance, time, and an event's errors.
    """
    T = float(units.time)
    L = float(units.length)
    V = units.speed
    F = units.force
    return [1, 1, 1, 1, 1, 1, L, V, F, F, L * L, L * V, V * V, T, T, L]


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", UNITS, ids=str)
def test_every_step_is_the_same_in_any_units(units: Units) -> None:
    """Of the paper's motions and of random ones.

    Codes, states and the covariance of their errors.
    """
    rng = random.Random(21)
    count = 0
    problems = [(s.parameters, s.t0, s.x0, s.v0) for s in map(load_scene, MOTIONS)]
    problems += [drawn(rng) for _ in range(25)]
    T, L, _ = units
    for p, t0, x0, v0 in problems:
        end = t0 + 12
        errors = rng.choice([None, (Fraction(0), Fraction(1, 2**20), Fraction(1, 2**22))])
        scaled = errors and (Fraction(0), errors[1] * L, errors[2] * L / T)
        plain = steps(Start(p, t0, x0, v0, end, errors), 25)
        second = steps(Start(units.of(p), t0 * T, x0 * L, v0 * L / T, end * T, scaled), 25)
        assert len(plain) == len(second)
        for first, two in zip(plain, second, strict=True):
            assert two == tuple(
                value * factor for value, factor in zip(first, factors(units), strict=True)
            )
        count += len(plain)
    assert count > 100
