"""Balls, sets, flights, contacts, sticks, margins and multipliers enclose what an oracle or samples say."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from itertools import islice
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from oracle import flow_oracle
from problems import FAMILIES, ordinary

from symosc import Parameters, Scene, certify, load_scene
from symosc.certificates.balls import (
    Ball,
    StateSet,
    Undecided,
    around,
    ball,
    decided_sign,
    exact_ends,
    outward,
    sure_sign,
)
from symosc.certificates.flow import Flight, Jet, Oscillator, Turns, holding_force
from symosc.certificates.motion import belts_around, end_of_stick, first_zero, zero_in
from symosc.certificates.orbit import Margin, Stability, prove_positive


def test_a_comparison_is_true_only_if_it_is_certain() -> None:
    wide = arb(0, 1)
    assert not wide < 0
    assert not wide >= 0  # so "not x < 0" proves nothing
    assert (sure_sign(wide), sure_sign(wide + 2), sure_sign(wide - 2)) == (0, 1, -1)
    with pytest.raises(Undecided):
        decided_sign(wide, "a sign")
    assert sure_sign(arb.nan()) == 0


@pytest.mark.parametrize("digits", [5, 60])
def test_decimals_are_rounded_outward(digits: int) -> None:
    rng = random.Random(digits)
    with ctx.workprec(300):
        for _ in range(50):
            exact = Fraction(rng.randint(-(10**30), 10**30), 10 ** rng.randint(1, 40))
            value = around(ball(exact), ball(Fraction(1, 10 ** rng.randint(3, 70))))
            low, high = map(Fraction, outward(value, digits))
            below, above = exact_ends(value)
            assert low < below <= above < high
            unit = Fraction(10) ** (len(str(int(max(1, abs(below), abs(above))))) - digits)
            assert high - low <= above - below + 4 * unit


BASE: dict[str, Any] = {
    "m": 1,
    "c": "0.4",
    "k": 2,
    "A0": "0.5",
    "B0": 4,
    "Omega": "1.3",
    "v1": -1,
    "v2": "1.5",
}
BASE |= {"mu1": "0.4", "mu2": "0.3", "FN": 3}
REGIMES: dict[str, dict[str, Any]] = {
    "underdamped": {},
    "overdamped": {"c": 5},
    "critical": {"c": 2, "k": 1},
    "nearly critical": {"c": 2, "k": "0.99999999999999"},
    "nearly critical, below": {"c": 2, "k": "1.00000000000001"},
    "resonance": {"c": 0, "k": "1.69"},
    "nearly resonance": {"c": "1e-12", "k": "1.69"},
    "undamped": {"c": 0},
    "no spring": {"k": 0},
    "weak spring": {"k": "1e-15"},
    "free mass": {"k": 0, "c": 0},
    "stiff": {"m": "1e-5"},
    "no drive": {"B0": 0},
    "backwards": {"B0": -4},
}


def contains(value: Ball, number: Any) -> bool:
    """Whether a ball contains a number of mpmath that is right to 45 digits."""
    low, high = exact_ends(value)
    exact = Fraction(int(number.man)) * Fraction(2) ** int(number.exp) * (1 if number >= 0 else -1)
    slack = Fraction(1, 10**45) * (1 + abs(exact))
    return low - slack <= exact <= high + slack and high - low < Fraction(1, 10**20) * (
        1 + abs(exact)
    )


@pytest.mark.quick(5)
@pytest.mark.parametrize("regime", REGIMES)
def test_enclosures_contain_the_motion_and_its_derivatives_by_the_start(regime: str) -> None:
    p = Parameters(**BASE | REGIMES[regime])
    rng = random.Random(regime)
    scale = Fraction(1, 100 if regime == "stiff" else 1)
    small = Fraction(1, 10**30)
    way = (3, -2, 1)
    with ctx.workprec(300):
        oscillator = Oscillator(p)
        for domain in (1, 2, 3):
            t0, x0, v0 = (Fraction(rng.randint(-50, 50), 10) for _ in range(3))
            tau = Fraction(rng.randint(1, 300), 100) * scale
            flight = Flight(oscillator, domain, ball(t0), ball(x0), ball(v0))
            there = flight.at(ball(tau))
            x, v, a = flow_oracle(p, domain, t0, x0, v0, tau)
            for value, number in ((flight.x(there), x), (there.v, v), (there.a, a)):
                assert contains(value, number), (domain, value, number)
            ends = []
            for side in (-1, 1):
                start = [
                    ball(each + side * small * by)
                    for each, by in zip((t0, x0, v0), way, strict=True)
                ]
                beside = Flight(oscillator, domain, *start)
                then = beside.at(ball(t0 + tau) - start[0])
                ends.append((beside.x(then), then.v))
            later = flight.at(ball(tau + small))
            assert abs((later.a - there.a) / ball(small) - flight.jerk(there)) < 1e-15 * (
                1 + abs(flight.jerk(there))
            )
            for found, below, above in zip(
                flight.moved(there, list(map(arb, way))), *ends, strict=True
            ):
                assert abs((above - below) / ball(2 * small) - found) < 1e-18 * (1 + abs(found))


@pytest.mark.parametrize(
    "regime", ["underdamped", "overdamped", "critical", "undamped", "no drive"]
)
def test_a_bound_for_all_later_times_is_one(regime: str) -> None:
    p = Parameters(**BASE | REGIMES[regime])
    rng = random.Random(regime)
    with ctx.workprec(128):
        flight = Flight(Oscillator(p), 2, arb(0), arb(3), arb(1))
        for tau in (Fraction(0), Fraction(3, 2), Fraction(6)):
            bound = flight.speed_bound(flight.at(ball(tau)))
            assert bound.is_finite()
            later = [tau + Fraction(rng.randint(0, 400), 10) for _ in range(40)]
            assert not any(abs(flight.at(ball(time)).v) > bound for time in later)


@pytest.mark.parametrize("sign", [1, -1])
def test_turns_are_zeros_and_the_drift_has_its_sign_between_them(sign: int) -> None:
    rng = random.Random(sign)
    with ctx.workprec(128):
        for _ in range(30):
            p, start = ordinary(rng, B0=sign * Fraction(rng.randint(1, 90), 10))
            boundary = rng.choice([1, 2])
            t = ball(Fraction(start["t0"]) * 10 ** rng.randint(0, 6))
            turns = Turns(p, boundary)

            def drift(time: object, p: object = p, boundary: int = boundary) -> object:
                bias = ball(p.k * p.belt(boundary))
                swing = ball(p.B0 * p.Omega)
                return -bias - swing * (ball(p.Omega) * time).sin()  # type: ignore[attr-defined]

            before = t
            for turn, side in islice(turns.after(t), 5):
                if turn is None:
                    assert sure_sign(drift(t + rng.random())) == side == turns.constant
                    break
                assert turn > before
                assert drift(turn).contains(0)  # type: ignore[attr-defined]
                assert sure_sign(drift((before + turn) / 2)) == side
                before = turn


def _flight(p: Parameters, t0: Fraction, x0: Fraction, v0: Fraction) -> tuple[Flight, list[int]]:
    domain = 1 + (v0 > p.v1) + (v0 > p.v2)
    flight = Flight(Oscillator(p), domain, ball(t0), ball(x0), ball(v0))
    return flight, belts_around(domain)


@pytest.mark.quick(2)
@pytest.mark.parametrize("family", ["ordinary", "light", "stiff", "no spring", "resonant"])
def test_the_first_zero_is_where_samples_change_their_sign(family: str) -> None:
    rng = random.Random(family)
    with ctx.workprec(128):
        for _ in range(12):
            p, start = FAMILIES[family](rng)
            t0, x0, v0 = (Fraction(start[name]) for name in ("t0", "x0", "v0"))
            if v0 in (p.v1, p.v2):
                continue
            flight, walls = _flight(p, t0, x0, v0)
            for wall in walls:
                gap = flight.gap(wall)
                found = first_zero(flight, wall, arb(4), False)
                values = [gap(arb(float(tau))).g for tau in np.linspace(0, 4, 400)]
                if found is None:
                    low = 4.0
                else:
                    low = float(found[0].tau.mid())
                assert all(value > 0 for i, value in enumerate(values) if i * 4 / 399 < low)
                if found is not None:
                    tau = zero_in(gap, found[0].tau, found[1].tau, "a contact", flight.t0)
                    assert float(tau.rad()) < 1e-25
                    assert gap(tau).g.contains(0)
                    assert (
                        gap((tau.mid() - arb("1e-20")).mid()).g
                        > 0
                        > gap((tau.mid() + arb("1e-20")).mid()).g
                    )


@pytest.mark.parametrize("exponent", [3, 8, 13, 25, 31])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_belt_just_beside_the_peak_is_met_or_missed(exponent: int, sign: int) -> None:
    """fig7's orbit peaks at 5 exactly.

    A belt that is slower by 10**-n is met, and one that is faster is not.
    """
    scene = load_scene("fig7-exact")
    p = scene.parameters.replace(v1=5 + Fraction(sign, 10**exponent))
    with ctx.workprec(256):
        flight, (wall,) = _flight(p, scene.t0, scene.x0, scene.v0)
        assert (first_zero(flight, wall, arb(3), False) is None) == (sign > 0)


def test_a_dip_between_two_equal_slopes_is_found() -> None:
    """Its secant is no number.

    The gap falls as fast at both ends of the piece, a whole period apart.
    """
    numbers = {
        "m": "13/2",
        "c": 2,
        "k": "51597/2000000",
        "A0": "-670761/20000000",
        "B0": "-83349/12500000",
    }
    speeds = {
        "v1": "-166697999997/50000000000000",
        "v2": "2165849/25000000",
        "mu1": 0,
        "mu2": 0,
        "FN": "179/25",
    }
    p = Parameters(**numbers, Omega="63/1000", **speeds)
    scene = Scene(
        "dip", p, Fraction(0), Fraction("-1.3"), Fraction(-83349, 25000000), Fraction(300)
    )
    certificate = certify(scene)
    assert certificate.proven, certificate.message
    assert [event[0] for event in certificate.events] == ["cross"] * 7


def test_a_stick_ends_at_the_first_of_both_exits() -> None:
    rng = random.Random(2)
    sides = set()
    with ctx.workprec(128):
        for _ in range(60):
            p, start = ordinary(rng, FN=10, mu1=1, mu2=1)
            o = Oscillator(p)
            boundary = rng.choice([1, 2])
            t = ball(Fraction(start["t0"]))
            middle = (p.A(boundary) + p.A(boundary + 1)) / 2 - p.c * p.belt(boundary)
            x = (
                ball(middle) + o.B0 * (o.Omega * t).cos()
            ) / o.k  # the forces are equal and opposite
            slip = end_of_stick(o, boundary, t, x, arb(6))
            forces = [holding_force(o, boundary, boundary + i, t, x) for i in (0, 1)]
            times = np.linspace(0, 6, 300)
            if slip:
                last = float(slip[1].mid())
            else:
                last = 6.0
            assert all(
                force(arb(float(tau))).g > 0 for force in forces for tau in times if tau < last
            )
            if slip:
                domain, tau, slope = slip
                out = domain - boundary
                sides.add(out)
                assert forces[out](tau).g.contains(0)
                assert forces[1 - out](tau).g > 0
                assert (slope > 0) == (out == 1)
    assert sides == {0, 1}


def test_a_stick_on_a_belt_at_rest_may_last_for_ever() -> None:
    p, _ = ordinary(
        random.Random(2), m=1, k=1, c=1, A0=0, B0="0.1", v1=0, v2=10, mu1=1, mu2="0.1", FN=1
    )
    with ctx.workprec(128):
        for x in ("-0.6", "0", "0.5"):
            assert end_of_stick(Oscillator(p), 1, arb(0), ball(Fraction(x)), arb(10) ** 9) is None
        # F^(2) reaches 0 where B0 cos(t) falls to -0.05
        assert (
            end_of_stick(Oscillator(p), 1, arb(0), ball(Fraction("1.05")), arb(10) ** 9) is not None
        )


def test_a_force_that_touches_0_where_it_turns_is_open() -> None:
    p, _ = ordinary(
        random.Random(2), m=1, k=1, c=1, A0=0, B0="0.1", v1=0, v2=10, mu1=1, mu2=0, FN=1
    )
    with (
        ctx.workprec(128),
        pytest.raises(Undecided),
    ):  # F^(1) = 1 - x - 0.1 cos(t + pi) is 0 once a period
        end_of_stick(Oscillator(p), 1, arb(1), ball(Fraction("0.9")), arb(100))


def _inside(states: StateSet, point: list[Ball]) -> bool:
    """Whether a point is within the set: its coordinates in the orthogonal frame are in the box."""
    (p, minus_q), (q, _) = states.matrix
    off = [value - c for value, c in zip(point, states.centre, strict=True)]
    norm = p * p + q * q
    y = [(p * off[0] + q * off[1]) / norm, (p * off[1] - q * off[0]) / norm]
    assert (minus_q + q).contains(0)
    return all(box.overlaps(each) for box, each in zip(states.box, y, strict=True))


def test_an_image_contains_the_images_of_points() -> None:
    rng = random.Random(3)
    for _ in range(50):
        a, b, c, d, bend = (rng.uniform(-2, 2) for _ in range(5))

        def image(x: Ball, y: Ball, abcd: tuple[float, ...] = (a, b, c, d, bend)) -> list[Ball]:
            a, b, c, d, bend = abcd
            return [a * x + b * y + bend * x * x, c * x + d * y - bend * x * y]

        states = StateSet.of([arb(rng.uniform(-1, 1), 1e-3), arb(rng.uniform(-1, 1), 1e-5)])
        x, y = states.hull()
        jacobian = [[a + 2 * bend * x, arb(b)], [c - bend * y, d - bend * x]]
        after = states.image(image(*states.centre), jacobian)
        for _ in range(20):
            point = [value.mid() + value.rad() * rng.uniform(-1, 1) for value in (x, y)]
            there = image(*(each.mid() for each in point))
            assert _inside(after, there)
            assert all(box.overlaps(each) for box, each in zip(after.hull(), there, strict=True))


def test_a_thousand_turns_do_not_grow() -> None:
    """In boxes each turn by a radian would grow by |sin| + |cos|: to 10**120."""
    s = math.sin(1)
    c = math.cos(1)
    states = StateSet.of([arb(1, 1e-6), arb(0, 1e-6)])
    for _ in range(1000):
        x, y = states.centre
        states = states.image([c * x - s * y, s * x + c * y], [[arb(c), arb(-s)], [arb(s), arb(c)]])
    assert max(float(value.rad()) for value in states.hull()) < 3e-6


def margin(coefficients: list[object], at_start: int, at_end: bool) -> Margin:
    """Return a polynomial, the lowest power first."""

    def curve(tau: object) -> Jet:
        jets = []
        row = [arb(each) for each in coefficients]
        for _ in range(3):
            total = arb(0)
            for each in reversed(row):
                total = total * tau + each
            jets.append(total)
            row = [i * each for i, each in enumerate(row)][1:]
        return Jet(tau, *jets)

    return Margin("a polynomial", curve, at_start, at_end)


def product(*factors: list[object]) -> list[object]:
    total: list[object] = [arb(1)]
    for factor in factors:
        longer: list[object] = [arb(0)] * (len(total) + len(factor) - 1)
        for i, a in enumerate(total):
            for j, b in enumerate(factor):
                longer[i + j] += a * arb(b)
        total = longer
    return total


@pytest.mark.parametrize("gap", [1, 1e-3, 1e-9, 1e-25, 0, -1e-25, -1e-9, -1e-3])
def test_a_near_miss(gap: float) -> None:
    rng = random.Random(str(gap))
    for _ in range(5):
        place = rng.uniform(0.2, 0.8)
        with ctx.workprec(256):
            row = product([-arb(place), 1], [-arb(place), 1])
            row[0] += arb(gap)
            if gap > 0:
                prove_positive(margin(row, 0, False), arb(1))
            else:
                with pytest.raises(Undecided):
                    prove_positive(margin(row, 0, False), arb(1))


@pytest.mark.parametrize("at_start", [0, 1, 2])
def test_it_starts_and_ends_on_the_belt(at_start: int) -> None:
    start: list[list[object]] = [[0, 1]] * at_start
    good = product(*start, [1, -1], [2, 1])
    with ctx.workprec(128):
        prove_positive(margin(good, at_start, True), arb(1))
        for bad in (
            product(*start, [1, -1], [-0.5, 1], [-0.5, 1]),
            product(*start, [-1, 1]),
            product([0.25, -1], good),
        ):
            with pytest.raises(Undecided):
                prove_positive(margin(bad, at_start, True), arb(1))
        with pytest.raises(Undecided):  # it ends before the time that is asked for
            prove_positive(margin(good, at_start, False), arb(1.5))


def test_they_contain_the_roots_and_decide_stability() -> None:
    rng = random.Random(5)
    seen = set()
    with ctx.workprec(128):
        for _ in range(500):
            T = rng.uniform(-3, 3)
            D = rng.choice([0.0, rng.uniform(-1.5, 1.5), 1e-30])
            roots = np.roots([1, -T, D])
            found = Stability(arb(T), arb(D))
            for re, im in found.multipliers():
                near = min(
                    roots, key=lambda root: abs(complex(root) - complex(float(re), float(im)))
                )
                assert abs(complex(near) - complex(float(re), float(im))) < 1e-6
                value = arb(complex(near).real)
                assert (re + arb(0, 1e-7)).overlaps(value)
            assert found.stable is bool(max(abs(roots)) < 1)
            seen.add(found.stable)
    assert seen == {True, False}
