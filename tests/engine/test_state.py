"""What the engine passes on means what its words say: states of random motions, against the equation of motion."""

from __future__ import annotations

import random
from fractions import Fraction
from math import cos, sin
from typing import Any

import mpmath
import pytest
from agreement import BASE
from touches import tenths

from symosc import Parameters, load_scene
from symosc.engine import state
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.next_event import advance
from symosc.engine.start import Start, first_state
from symosc.engine.state import CROSS, END, GRAZE, MOVED, ON_BELT, REST, SLIP, STICK, State
from symosc.kernels.entire import EPS
from symosc.model import MODE_NAMES, NEIGHBOURS
from symosc.simulation.motion import Motion

SPEED_OF = {1: "v1", 2: "v2"}


def random_path(rng: random.Random, digits: int | None) -> Motion:
    """Return a motion of random parameters from a random start between the belts, before its first step."""
    p = BASE.replace(
        m=tenths(rng, 3, 30), c=tenths(rng, 0, 20), k=tenths(rng, 0, 40), B0=tenths(rng, -60, 60), A0=tenths(rng, -9, 9)
    ).replace(Omega=tenths(rng, 3, 30), mu1=tenths(rng, 1, 9), mu2=tenths(rng, 1, 9))
    t0, x0, v0 = tenths(rng, -90, 90), tenths(rng, -20, 20), tenths(rng, -9, 14)
    return Motion(Start(p, t0, x0, v0, t0 + 40), digits)


def acceleration(p: Parameters, domain: int, s: State) -> Any:
    """Return the right-hand side of the equation of motion, of a domain, at a state."""
    numbers = {name: mpmath.mpf(Fraction(getattr(p, name)).numerator) / getattr(p, name).denominator for name in "mck"}
    A, B0 = (mpmath.mpf(value.numerator) / value.denominator for value in (p.A(domain), p.B0))
    x, v, theta = map(mpmath.mpf, (s.x, s.v, s.theta))
    return (A + B0 * mpmath.cos(theta) - numbers["c"] * v - numbers["k"] * x) / numbers["m"]


def check_state(start: Start, s: State, eps: float) -> None:
    """Compare all entries of a state with the parameters and with each other; periods count from the start's."""
    p = start.parameters
    turns = s.n + mpmath.floor(
        mpmath.mpf((p.Omega * start.t0).numerator) / (p.Omega * start.t0).denominator / (2 * mpmath.pi)
    )
    angle = p.Omega.numerator * (mpmath.mpf(s.t) + mpmath.mpf(s.t_low)) / p.Omega.denominator
    assert 0 <= s.theta < 2 * mpmath.pi
    assert abs(s.s - mpmath.sin(s.theta)) < 40 * eps
    assert abs(s.c - mpmath.cos(s.theta)) < 40 * eps
    assert abs(2 * mpmath.pi * turns + s.theta - angle) < 300 * eps * (1 + abs(angle))
    forces = {domain: acceleration(p, domain, s) for domain in (1, 2, 3)}
    size = 1 + max(map(abs, forces.values()))
    assert s.S.S11 >= 0 <= s.S.S22
    assert s.S.S12**2 <= s.S.S11 * s.S.S22 * (1 + 1e-9)
    if s.mode > ON_BELT:
        belt = s.mode - ON_BELT
        assert MODE_NAMES[s.mode] == f"belt{belt}"
        assert (s.at, float(s.v)) == (belt, float(getattr(p, SPEED_OF[belt])))
        assert abs(s.Fb - forces[belt]) < 300 * eps * size
        assert abs(s.Fa - forces[belt + 1]) < 300 * eps * size
        assert s.Fb > 0 > s.Fa
    else:
        assert MODE_NAMES[s.mode] == f"Omega{s.mode}"
        assert s.Fb == s.Fa
        assert abs(s.Fb - forces[s.mode]) < 300 * eps * size
        assert s.mode == 1 or s.v >= float(p.belt(s.mode - 1))
        assert s.mode == 3 or s.v <= float(p.belt(s.mode))
        assert s.at == 0 or float(s.v) == float(p.belt(s.at))


@pytest.mark.parametrize("digits", [None, 30])
def test_states_and_codes_are_what_they_say(digits: int | None) -> None:
    """At each step: phase and time agree, forces are those of the equation, and the code tells the change of mode."""
    rng, seen = random.Random(17), set()
    with mpmath.workdps(50):
        for _ in range(6 if digits else 60):
            path = random_path(rng, digits)
            eps = 2.0**-53 if digits is None else 10.0**-digits
            check_state(path.start, path.state, eps)
            while not path.ended and len(path.events) < 30:
                before = path.state
                path.step()
                code, after = path.code, path.state
                seen.add(code)
                if code != SLIP:  # its forces are those of the end of the stick, which are 0 as far as it is known
                    check_state(path.start, after, 1e3 * eps)
                if code in (MOVED, END, REST):
                    assert after.mode == before.mode
                    continue
                belt = path.events[-1].boundary
                assert after.at == belt
                assert after.t >= before.t
                assert code in (CROSS, STICK, SLIP, GRAZE)
                modes = before.mode, after.mode
                assert (code == STICK) == (modes[0] in NEIGHBOURS[belt] and modes[1] == ON_BELT + belt)
                assert (code == SLIP) == (modes[0] == ON_BELT + belt and modes[1] in NEIGHBOURS[belt])
                assert (code == CROSS) == (sorted(modes) == list(NEIGHBOURS[belt]))
    assert seen >= {CROSS, STICK, SLIP, MOVED, END}


@pytest.mark.parametrize(
    "names",
    [
        "CROSS STICK SLIP GRAZE MOVED END REST FAILED RUNNING FULL IN_DOUBT INEXACT",  # a batch has both in one column
        "NOTHING HIT TANGENCY STALLED LOST",
        "DOMAIN_BELOW DOMAIN_ABOVE BELT",
    ],
)
def test_codes_of_one_column_differ(names: str) -> None:
    codes = [getattr(state, name) for name in names.split()]
    assert len(set(codes)) == len(codes)


def test_directions_are_those_of_the_velocity() -> None:
    """A search returns sides as signs of the velocity; where a motion goes has the same signs."""
    assert (state.DOMAIN_BELOW, state.BELT, state.DOMAIN_ABOVE) == (-1, 0, 1)


def test_the_errors_of_sine_and_cosine_do_not_add_up() -> None:
    """After thousands of events they are those of the phase, but for a few rounding errors."""
    scene = load_scene("fig5")
    arithmetic, start = Arithmetic(scene.parameters), Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end)
    now, worst = first_state(start, arithmetic), 0.0
    for _ in range(6000):
        now = advance(now, 1e7, 0.0, arithmetic.K).state
        worst = max(worst, abs(now.s * now.s + now.c * now.c - 1.0))
        assert abs(now.s - sin(now.theta)) + abs(now.c - cos(now.theta)) < 32 * EPS
    assert EPS < worst < 16 * EPS
