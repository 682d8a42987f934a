"""How errors are carried along, event by event: against differences of two flows, and in each regime of a passage."""

from __future__ import annotations

import random
from fractions import Fraction
from math import cos, sin, sqrt
from typing import Any

import numpy as np
import pytest
from agreement import BASE
from touches import tenths

from symosc import Parameters, simulate
from symosc.engine import compiled_loop, next_event, touches
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import Constants, state_at
from symosc.engine.next_event import passing_time
from symosc.engine.state import Covariance, FlightEnd, Flown, Launch, State
from symosc.engine.switching import carried_error
from symosc.simulation import motion
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
        assert touches.tolerance(now, 0.0, start, S, K) == pytest.approx(K.sigmas * expected, rel=1e-9)
        rounding = touches.tolerance(now, 3.0, start, Covariance(0.0, 0.0, 0.0), K._replace(fB=0.0))
        assert rounding == pytest.approx(touches.ROUNDING * touches.EPS * 3.0, rel=1e-12, abs=0)


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
        t, t_error, x_error = compiled_loop.handed_out(-1e6, 0.0, -1e6, -1e9, v, 1e-8, 4e-18, K)
        assert (t, t_error) == (-1e6, pytest.approx(1e-8 + compiled_loop.EPS * 1e6, rel=1e-12))
        assert x_error == pytest.approx(3e-8 + 2e-9 + compiled_loop.EPS * 1e9, rel=1e-12)
        t, t_error, x_error = compiled_loop.handed_out(0.0, 1e-9, -1e9, 0.0, v, 1e-8, 4e-18, K)
        assert (t, t_error) == (1e-9, pytest.approx(1e-8 + compiled_loop.EPS * 2.5e8, rel=1e-6))
        assert x_error == pytest.approx(3e-8 + 2e-9)


def test_the_clock_gives_back_what_rounding_took_from_omega() -> None:
    """The phase of a motion goes on with the double next to Omega: after 1e9 that is 3e-8 at Omega = 4.1."""
    Omega = Fraction("4.1")
    K = Arithmetic(BASE.replace(Omega=Omega)).K
    t, _, _ = compiled_loop.handed_out(0.0, 0.0, -1e9, 0.0, 1.0, 0.0, 0.0, K)
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


# -- contacts that rounding hides -------------------------------------------------------------------------------------


def state_in(mode: int, v: float, a: float, p: Parameters = BASE) -> tuple[State, Constants]:
    """Return a state between the belts, and constants."""
    phase = sin(1.0), cos(1.0), 0.0
    return State(mode, 0, 0, 1.0, 0.0, v, a, a, Covariance(0.0, 0.0, 0.0), 0.0, 0.0, *phase), Arithmetic(p).K


def hit_at(side: int, tau: float, F: float, s: float = 0.0, c: float = 1.0) -> FlightEnd:
    """Return a hit with the acceleration F."""
    return FlightEnd(touches.HIT, side, Flown(tau, 0.0, float(side), F, 0.0, 0.0, 0.0, s, c, 1.0, 0.0, 0.0))


@pytest.mark.parametrize(("mode", "side"), [(1, 1), (2, -1), (2, 1), (3, -1)])
def test_a_hit_whose_speed_is_lost_in_rounding_is_in_doubt(
    mode: int, side: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The search says that a belt is hit, but the acceleration there points away from it: so it can only be a touch."""
    belt = BASE.belt(mode - 1 if side < 0 else mode)
    state, K = state_in(mode, float(belt) - side, 0.0)
    away = -side * 1e-3
    hit = hit_at(side, 1e-3 / K.rate, away, 1.0, 0.0)
    monkeypatch.setattr(next_event, "first_exit", lambda *_: hit)
    code, boundary, decided, _, after = next_event.advance(state, 9.0, 0.0, K)
    assert (code, boundary, decided) == (next_event.GRAZE, mode - 1 if side < 0 else mode, False)
    assert (after.mode, after.at) == (mode, boundary)
    assert after.Fb == after.Fa == 0.0


@pytest.mark.parametrize(("mode", "side"), [(1, 1), (2, -1), (2, 1), (3, -1)])
def test_a_force_on_the_far_side_within_its_error_is_in_doubt(
    mode: int, side: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A clear hit, but beyond the belt the force is 0 as far as is known: stick or crossing is not decided."""
    boundary = mode - 1 if side < 0 else mode
    p = BASE
    K = Arithmetic(p).K
    J = (K.belt1 if boundary == 1 else K.belt2).J
    state, K = state_in(mode, float(p.belt(boundary)) - side, 0.0)
    for error, decided in ((0.0, True), (1e-3, False)):
        a = side * J * (1 + 1e-6)  # what is left beyond the belt: 1e-6 of the friction
        hit = hit_at(side, 1e-3 / K.rate, a, 1.0, 0.0)
        monkeypatch.setattr(next_event, "first_exit", lambda *_, hit=hit: hit)
        with_error = state._replace(S=Covariance(error**2 / K.w0sq**2, 0.0, 0.0))
        found = next_event.advance(with_error, 9.0, 0.0, K)
        assert found.decided is decided
        if decided:
            assert found.code == next_event.CROSS
        for towards in (1, -1):  # a force of 0 there: the next G-function decides
            s = -side * towards * 1.0  # B0 Omega > k |v|: G^(1) has the sign of -sin(theta)
            turning = hit_at(side, 1e-3 / K.rate, a, s, 0.0)
            monkeypatch.setattr(next_event, "first_exit", lambda *_, hit=turning: hit)
            found = next_event.advance(with_error, 9.0, 0.0, K)
            assert found.code == (next_event.CROSS if decided or towards > 0 else next_event.STICK)


@pytest.mark.parametrize(("mode", "side"), [(1, 1), (2, -1), (2, 1), (3, -1)])
def test_a_triple_contact_leaves_no_acceleration(mode: int, side: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the acceleration is 0 as far as is known it is 0: the force of the domain that the motion came from too."""
    boundary = mode - 1 if side < 0 else mode
    v = float(BASE.belt(boundary))
    state, K = state_in(mode, v - side, 0.0)
    F, s, c = side * 1e-12, -K.w0sq * v / K.fB, -float(side)  # G1 = 0, G2 on the side of the belt
    hit = hit_at(side, 1.0 / K.rate, F, s, c)
    monkeypatch.setattr(next_event, "first_exit", lambda *_: hit)
    monkeypatch.setattr(next_event, "acceleration", lambda *_: F)
    found = next_event.advance(state._replace(S=Covariance(0.0, 0.0, 1e-18)), 9.0, 0.0, K)
    assert found[:3] == (next_event.STICK, boundary, False)
    assert (found.state.Fb if side > 0 else found.state.Fa) == 0.0


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


def test_sine_and_cosine_are_made_anew_in_each_period_that_ends_in_a_stick() -> None:
    """Those that the search for its end has carry the rounding errors of all steps before."""
    turned = 0
    for seed in range(40):
        rng = random.Random(seed)
        p = BASE.replace(Omega=tenths(rng, 3, 40), B0=tenths(rng, 10, 90), FN=tenths(rng, 20, 90))
        K = Arithmetic(p).K
        off = sin(6.2) * (1 + 1e-12), cos(6.2) * (1 - 1e-12), 0.0
        held = State(5, 2, 0, 6.2, 0.1, K.belt2.v, 1.0, -1.0, Covariance(0.0, 0.0, 0.0), 0.0, 0.0, *off)
        found = next_event.advance(held, 1e3, 0.0, K)
        if found.code == next_event.SLIP and found.state.n == 1:
            turned += 1
            assert (found.state.s, found.state.c) == (sin(found.state.theta), cos(found.state.theta))
    assert turned > 5
