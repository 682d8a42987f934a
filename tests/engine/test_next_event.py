"""One step: how errors are carried along, the phase and the time, units, and steps in many digits."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from math import cos, sin, sqrt
from typing import Any

import mpmath
import numpy as np
import pytest
from agreement import BASE
from touches import tenths
from units import UNITS, Units

from symosc import Parameters, load_scene, simulate
from symosc.engine import first_exit as exits
from symosc.engine import next_event
from symosc.engine.arithmetic import Arithmetic, MpArithmetic
from symosc.engine.flow import Constants, state_at
from symosc.engine.next_event import advance, carried_error, passing_time
from symosc.engine.start import Start, first_state, rounded
from symosc.engine.state import (
    CROSS,
    END,
    GRAZE,
    MOVED,
    ON_BELT,
    REST,
    SLIP,
    STICK,
    Covariance,
    Launch,
    NextEvent,
    State,
)
from symosc.kernels.entire import EPS
from symosc.model import MODE_NAMES, NEIGHBOURS
from symosc.simulation import motion
from symosc.simulation.motion import Motion
from symosc.simulation.trajectory import Event

pytestmark = pytest.mark.usefixtures("interpreted")


def random_constants(rng: random.Random) -> Constants:
    """Return constants of all dampings, with and without a spring."""
    k = rng.choice([Fraction(0), tenths(rng, 1, 60)])
    return Arithmetic(BASE.replace(m=tenths(rng, 2, 30), c=tenths(rng, 0, 60), k=k, Omega=tenths(rng, 3, 40))).K


def flow(tau: float, x: float, v: float, theta: float, K: Constants) -> tuple[float, float]:
    s, c = sin(theta), cos(theta)
    a = K.A2 + K.f0 * c - K.cm * v - K.w0sq * x
    now = state_at(tau, Launch(v, a, s, c), K)
    return x + now.dx, v + now.dv


def test_a_covariance_is_carried_as_two_nearby_flows_part() -> None:
    """S(tau) = J S J^T with J from differences; x and v of the start may be correlated, either way."""
    rng = random.Random(4)
    for _ in range(100):
        K = random_constants(rng)
        x, v, theta, tau = rng.uniform(-3, 3), rng.uniform(-2, 2), rng.uniform(0, 6), 10 ** rng.uniform(-2, 0.7)
        middle, push = np.array(flow(tau, x, v, theta, K)), 1e-3
        J = np.column_stack(
            [
                (np.array(flow(tau, x + push, v, theta, K)) - middle) / push,
                (np.array(flow(tau, x, v + push, theta, K)) - middle) / push,
            ]
        )
        correlation = rng.uniform(-1, 1)
        S = np.array([[4.0, 2 * 0.5 * correlation], [2 * 0.5 * correlation, 0.25]])
        now = state_at(tau, Launch(v, 0.0, 0.0, 1.0), K)
        found = carried_error(Covariance(S[0, 0], S[0, 1], S[1, 1]), now, 0.3, 0.2, K)
        expected = J @ S @ J.T + np.diag([0.09, 0.04])
        scale = np.abs(expected).max()
        assert found == pytest.approx((expected[0, 0], expected[0, 1], expected[1, 1]), abs=1e-9 * scale, rel=1e-8)


def test_the_tolerance_of_a_gap_is_the_error_of_its_velocity() -> None:
    rng = random.Random(5)
    for _ in range(100):
        K = random_constants(rng)
        tau, correlation = 10 ** rng.uniform(-2, 0.7), rng.uniform(-1, 1)
        start, S = Launch(0.0, 0.0, 0.0, 1.0), Covariance(4.0, correlation, 0.25)
        now = state_at(tau, start, K)
        expected = sqrt(carried_error(S, now, 0.0, 0.0, K).S22)
        assert exits.tolerance(now, 0.0, start, S, K) == pytest.approx(K.sigmas * expected, rel=1e-9)
        rounding = exits.tolerance(now, 3.0, start, Covariance(0.0, 0.0, 0.0), K._replace(fB=0.0))
        assert rounding == pytest.approx(exits.ROUNDING * exits.EPS * 3.0, rel=1e-12, abs=0)


# -- how long a quantity may take to pass 0 ---------------------------------------------------------------------------


def passes(error: float, first: float, second: float, third: float) -> list[float]:
    """Return by how much the root of a cubic moves to either side if the cubic is off by `error`, the nearest roots."""
    moved = []
    for shift in (error, -error):
        roots = np.roots([third / 6, second / 2, first, shift])
        moved += [abs(root.real) for root in roots if abs(root.imag) < 1e-12 * (1 + abs(root.real))]
    return moved


def test_a_passage_at_a_slope() -> None:
    K = Arithmetic(BASE).K
    for first, error in ((2.0, 1e-12), (-3e-3, 1e-10), (1e5, 1e-3)):
        time = passing_time(error, first, 0.5 * abs(first), -0.7 * abs(first), K)
        assert time == pytest.approx(error / abs(first), rel=1e-3)


def test_a_passage_near_a_turn_and_near_an_inflection() -> None:
    """The quadratic and the cubic term shorten it; what a term alone allows is an upper bound, the least one counts."""
    K = Arithmetic(BASE).K
    error = 1e-12
    assert passing_time(error, 0.0, 3.0, 0.0, K) == pytest.approx(sqrt(2 * error / 3))
    assert passing_time(error, 0.0, -3.0, 0.0, K) == pytest.approx(sqrt(2 * error / 3))
    assert passing_time(error, 0.0, 0.0, 5.0, K) == pytest.approx((6 * error / 5) ** (1 / 3))
    assert passing_time(error, 0.0, 0.0, -5.0, K) == pytest.approx((6 * error / 5) ** (1 / 3))
    assert passing_time(error, 1e-9, 3.0, 5.0, K) == pytest.approx(sqrt(2 * error / 3))
    assert passing_time(error, 1e-5, 3.0, 5.0, K) == pytest.approx(1e-7, rel=0.02)
    assert passing_time(error, 1e-12, 1e-9, 5.0, K) == pytest.approx((6 * error / 5) ** (1 / 3))
    assert passing_time(error, 0.0, 1e-3, 5.0, K) == pytest.approx(sqrt(2e-9), rel=1e-6)


def test_a_passage_is_never_underestimated() -> None:
    """Against the roots of the cubic itself, over all sizes of its terms; and not by more than a few times over."""
    K = Arithmetic(BASE.replace(Omega="1e-30")).K
    rng = random.Random(6)
    for _ in range(500):
        error = 1e-10
        terms = [rng.choice([-1, 1]) * 10 ** rng.uniform(-9, 1) for _ in range(3)]
        time = passing_time(error, *terms, K)
        assert any(0.2 * time <= moved <= 5 * time for moved in passes(error, *terms)), terms
        bounds = [error / abs(terms[0]), sqrt(2 * error / abs(terms[1])), (6 * error / abs(terms[2])) ** (1 / 3)]
        assert time == pytest.approx(min(bounds), rel=1e-2)


def test_a_passage_lasts_no_longer_than_the_drive_stands_still() -> None:
    K = Arithmetic(BASE).K
    assert passing_time(1e-12, 0.0, 0.0, 0.0, K) == 1 / K.Om
    assert passing_time(1.0, 1e-9, 1e-9, 1e-9, K) == 1 / K.Om
    assert passing_time(0.0, 0.0, 0.0, 0.0, K) == 0.0
    assert passing_time(0.0, 1.0, 1.0, 1.0, K) == 0.0


# -- what is handed out ------------------------------------------------------------------------------------------------


def test_the_errors_of_an_event_are_those_at_a_fixed_time_and_of_the_clock() -> None:
    K = Arithmetic(BASE.replace(Omega=2)).K  # a double: the clock gains nothing
    for v in (3.0, -3.0):
        t, t_error, x_error = next_event.handed_out(-1e6, 0.0, -1e6, -1e9, v, 1e-8, 4e-18, K)
        assert (t, t_error) == (-1e6, pytest.approx(1e-8 + next_event.EPS * 1e6, rel=1e-12))
        assert x_error == pytest.approx(3e-8 + 2e-9 + next_event.EPS * 1e9, rel=1e-12)
        t, t_error, x_error = next_event.handed_out(0.0, 1e-9, -1e9, 0.0, v, 1e-8, 4e-18, K)
        assert (t, t_error) == (1e-9, pytest.approx(1e-8 + next_event.EPS * 2.5e8, rel=1e-6))
        assert x_error == pytest.approx(3e-8 + 2e-9)


def test_the_clock_gives_back_what_rounding_took_from_omega() -> None:
    """The phase of a motion goes on with the double next to Omega: after 1e9 that is 3e-8 at Omega = 4.1."""
    Omega = Fraction("4.1")
    K = Arithmetic(BASE.replace(Omega=Omega)).K
    t, _, _ = next_event.handed_out(0.0, 0.0, -1e9, 0.0, 1.0, 0.0, 0.0, K)
    assert t == pytest.approx(float(Fraction(10**9) * (Fraction(float(Omega)) / Omega - 1)), rel=1e-9)
    assert abs(t) > 1e-9


def test_rounding_an_event_adds_to_its_errors() -> None:
    context = motion.mp_context(30)
    for t, x in (("1e6", "-3e9"), ("-1e6", "3e9")):
        numbers = (context.mpf(t) / 3, context.mpf(x) / 7, context.mpf(2), context.mpf(1))
        event = Event(*numbers, "cross", 1, "Omega1", "Omega2", 1e-25, 1e-24)
        rounded = motion.rounded_event(event)
        assert isinstance(rounded.t, float)
        assert rounded.t_error == pytest.approx(2.0**-53 * 1e6 / 3)
        assert rounded.x_error == pytest.approx(2.0**-53 * 3e9 / 7)
        cut = motion.cut_event(event, motion.mp_context(10))
        half = float(motion.mp_context(10).eps) / 2
        assert (cut.t_error, cut.x_error) == pytest.approx((half * 1e6 / 3, half * 3e9 / 7))
        assert cut.t.context.dps == 10
        assert motion.rounded_event(rounded) is rounded


def shifted(p: Parameters, x0: Fraction, v0: Fraction, push: Fraction, t_end: int) -> Any:
    return simulate(p, t0=0, x0=x0 + push, v0=v0, t_end=t_end, digits=25).events


@pytest.mark.slow
def test_errors_travel_through_events_as_pushed_starts_do() -> None:
    """A start error of x alone: each event's estimate is what a push of the start does to it, through all kinds."""
    rng, push, kinds = random.Random(7), Fraction(1, 10**9), set()
    for _ in range(12):
        p = BASE.replace(c=tenths(rng, 0, 9), k=tenths(rng, 5, 40), mu1=tenths(rng, 1, 5), mu2=tenths(rng, 0, 5))
        x0, v0 = tenths(rng, -30, 30), tenths(rng, -9, 14)
        found = simulate(p, t0=0, x0=x0, v0=v0, t_end=6, start_error=(0, push, 0), digits=25).events
        plain, moved = (shifted(p, x0, v0, amount, 6) for amount in (Fraction(0), push / 1000))
        for event, other, further in zip(found, plain, moved, strict=True):
            kinds.add(event.kind)
            at_event = 1000 * float(abs(further.t - other.t))
            assert event.t_error == pytest.approx(sqrt(3) * at_event, rel=1e-3, abs=1e-20)
            x_moved = 1000 * float(abs(further.x - other.x))
            assert event.x_error >= 0.999 * sqrt(3) * x_moved - 1e-20
            assert event.x_error <= 1.001 * sqrt(3) * (x_moved + 2 * abs(float(event.v)) * at_event) + 1e-20
    assert kinds == {"cross", "stick", "slip"}


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_a_crossing_that_is_none_is_moved_to_the_touch_behind(mode: int) -> None:
    """By Newton's step to where the acceleration is 0, but not past the end: position, phase and time go with it."""
    rng, K = random.Random(15), Arithmetic(BASE).K
    for _ in range(60):
        F, G1 = 10 ** rng.uniform(-6, -2) * rng.choice([-1, 1]), rng.choice([-1, 1]) * rng.uniform(0.3, 3)
        x, v, theta, t = rng.uniform(-3, 3), rng.uniform(-2, 2), rng.uniform(0, 6), rng.uniform(0, 50)
        S, tau = Covariance(1e-20, 0.0, 4e-20), rng.uniform(0.1, 2)
        left = tau + rng.choice([1.0, 0.25 * abs(F / G1)])
        there = State(mode, 2, 3, theta, x, v, F, F, S, t, 1e-18, sin(theta), cos(theta), 0.0)
        found = next_event.touch_belt(there, G1, 0.5, 0.25, 1e-12, tau, left, K)
        shift = min(-F / G1, left - tau) if F * G1 < 0 else 0.0
        now = found.state
        assert (found.code, found.boundary, found.decided) == (next_event.GRAZE, 2, False)
        assert (now.mode, now.at, now.Fb, now.Fa, now.v, now.S) == (mode, 2, 0.0, 0.0, v, S)
        assert now.t + now.t_low == pytest.approx(t + shift, rel=1e-15)
        assert (now.s, now.c) == pytest.approx((sin(now.theta), cos(now.theta)), abs=1e-15)
        assert 2 * np.pi * (now.n - 3) + now.theta == pytest.approx(theta + K.Om * shift, rel=1e-14)
        assert now.x == pytest.approx(x + v * shift + F * shift**2 / 2 + G1 * shift**3 / 6, rel=1e-14)
        assert found.t_error == passing_time(K.rate * (2e-10 + 1e-12), G1, 0.5, 0.25, K)
    vague = next_event.touch_belt(there, 1e-300, 0.0, 0.0, 1e-12, 1e-3, 1.0, K)
    assert vague.code == next_event.FAILED  # it may be anywhere in the flight


DIGITS = 40
FINE = Fraction(1, 10**34)


def random_start(seed: int) -> Start:
    """Return a motion of any regime: with or without damping, spring and drive, stiff, resonant, from anywhere."""
    dice = random.Random(seed)
    c, k = dice.choice((0, 0.001, 0.1, 1, 4, 40)), dice.choice((0, 0.5, 4, 20, 80))
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


def pairs_of_steps(start: Start, most: int = 25) -> Iterator[tuple[Motion, Any, Any, State, NextEvent]]:
    """Yield what goes into a step with many digits, and take the step."""
    arithmetic, doubles = MpArithmetic(start.parameters, DIGITS), Arithmetic(start.parameters)
    path = Motion(start, arithmetic)
    end = motion.last_time(start, doubles)
    for _ in range(most):
        rough = rounded(path.state, start)
        yield path, path._state, path._end, rough, doubles.advance(rough, *end, doubles.K)
        path.step()
        if path.ended:
            return


def exact(number: Any) -> Fraction:
    """Return a number of any arithmetic as a fraction; mpmath's, where gmpy2 is missing, have no method for that."""
    if hasattr(number, "_mpf_"):
        return Fraction(*mpmath.libmp.to_rational(number._mpf_))
    return Fraction(*number.as_integer_ratio())


def assert_alike(near: NextEvent, full: NextEvent) -> None:
    assert near[:3] == full[:3]
    for a, b in zip(near.state[:8] + near.state[9:], full.state[:8] + full.state[9:], strict=True):
        assert abs(exact(a) - exact(b)) <= FINE * max(1, abs(int(b)))


def compared(path: Motion, state: Any, end: Any, rough: State, found: NextEvent) -> NextEvent:
    """Check a step against one that searches with many digits, and return it."""
    before = path._paths.enter()
    try:
        near: NextEvent = path._paths.advance_near(state, rough, found, *end, path.K)
        assert_alike(near, path._paths.advance(state, *end, path.K))
    finally:
        path._paths.leave(before)
    return near


@pytest.mark.parametrize("seed", range(60))
def test_steps_are_those_of_a_search_with_many_digits(seed: int) -> None:
    for step in pairs_of_steps(random_start(seed)):
        compared(*step)


def shifted_by(found: NextEvent, part: float, rough: State) -> NextEvent:
    state = found.state
    return found._replace(state=state._replace(t=state.t + part * (state.t - rough.t)))


@pytest.mark.parametrize("seed", range(20))
def test_a_wrong_time_or_belt_is_not_believed(seed: int) -> None:
    for path, state, end, rough, found in pairs_of_steps(random_start(seed)):
        if found.code in (CROSS, STICK, SLIP):
            for part in (-0.3, -1e-6, 1e-6, 0.3):
                compared(path, state, end, rough, shifted_by(found, part, rough))
            compared(path, state, end, rough, found._replace(decided=False))
        if found.code in (CROSS, STICK):
            compared(path, state, end, rough, found._replace(boundary=3 - found.boundary))


def followed(monkeypatch: pytest.MonkeyPatch, start: Start, digits: int | None, searches: bool) -> Any:
    with monkeypatch.context() as patch:
        if not searches:
            patch.setattr(Motion, "_in_digits", lambda self, state: self._paths.advance(state, *self._end, self.K))
        times = {"t0": start.t0, "x0": start.x0, "v0": start.v0, "t_end": start.t_end}
        accuracy = {"accuracy": 1e-15} if digits is None else {"digits": digits}
        return simulate(start.parameters, max_events=25, **times, **accuracy)  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(30))
def test_motions_are_the_same_with_and_without(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    start = random_start(seed)
    near, alone = (followed(monkeypatch, start, None, searches) for searches in (True, False))
    assert (near.events, near.status) == (alone.events, alone.status)
    digits = 30 if seed % 3 else 120  # with so many one evaluation of the flow is not enough
    near, alone = followed(monkeypatch, start, digits, True), followed(monkeypatch, start, digits + 15, False)
    assert near.status == alone.status
    assert len(near.events) == len(alone.events)
    for a, b in zip(near.events, alone.events, strict=True):
        assert (a.kind, a.boundary, a.target) == (b.kind, b.boundary, b.target)
        assert abs(a.t - b.t) <= b.t.context.mpf(10) ** (1 - digits) * max(1, abs(b.t))
        assert abs(a.x - b.x) <= b.t.context.mpf(10) ** (1 - digits) * max(1, abs(b.x))


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
