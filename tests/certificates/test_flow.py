"""Enclosures of the flow contain what the differential equation says (50 digits, from a matrix exponential)."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import arb
from oracle import flow_oracle

from symosc import Parameters
from symosc.certificates.balls import Ball, ball, exact_ends, working_bits
from symosc.certificates.flow import Flight, FlightStart, Oscillator

BASE: dict[str, Any] = {"m": 1, "c": "0.4", "k": 2, "A0": "0.5", "B0": 4, "Omega": "1.3", "v1": -1, "v2": "1.5"}
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
    return low - slack <= exact <= high + slack and high - low < Fraction(1, 10**20) * (1 + abs(exact))


@pytest.mark.quick(5)
@pytest.mark.parametrize("regime", REGIMES)
def test_enclosures_contain_the_motion(regime: str) -> None:
    p, rng = Parameters(**BASE | REGIMES[regime]), random.Random(regime)
    with working_bits(256):
        oscillator = Oscillator(p)
        for domain in (1, 2, 3):
            t0, x0, v0 = (Fraction(rng.randint(-50, 50), 10) for _ in range(3))
            tau = Fraction(rng.randint(1, 300), 100) * (Fraction(1, 100) if regime == "stiff" else 1)
            flight = Flight(oscillator, domain, FlightStart(ball(t0), ball(x0), ball(v0)))
            there = flight.at(ball(tau))
            x, v, a = flow_oracle(p, domain, t0, x0, v0, tau)
            for value, number in ((flight.x(there), x), (there.v, v), (there.a, a)):
                assert contains(value, number), (domain, value, number)
            drive = -(p.c * _exact(a) + p.k * _exact(v)) / p.m
            with mpmath.workdps(50):
                sine = mpmath.sin(mpmath.mpf(p.Omega.numerator) / p.Omega.denominator * _mpf(t0 + tau))
                jerk = _mpf(drive) - _mpf(p.B0 * p.Omega / p.m) * sine
            assert abs(float(flight.jerk(there).mid()) - float(jerk)) < 1e-12 * (1 + abs(float(jerk)))


def _exact(number: Any) -> Fraction:
    return Fraction(str(mpmath.nstr(number, 40)))


def _mpf(number: Fraction) -> Any:
    return mpmath.mpf(number.numerator) / number.denominator


@pytest.mark.parametrize("regime", REGIMES)
def test_entire_functions_carry_differences_of_motions(regime: str) -> None:
    """Two motions of a domain differ by dx phi + dv E in x, and by -(k/m) dx E + dv E' in v, exactly."""
    p, rng = Parameters(**BASE | REGIMES[regime]), random.Random(regime)
    tau = Fraction(rng.randint(1, 200), 100) * (Fraction(1, 100) if regime == "stiff" else 1)
    with working_bits(256):
        oscillator = Oscillator(p)
        E, E1, phi = oscillator.entire(ball(tau))
        dx, dv = ball(Fraction(rng.randint(-9, 9), 7)), ball(Fraction(rng.randint(-9, 9), 7))
        zero, start = arb(0), FlightStart(arb(1), arb(1), arb(1))
        here = Flight(oscillator, 2, start)
        there = Flight(oscillator, 2, FlightStart(arb(1), 1 + dx, 1 + dv))
        a, b = here.at(ball(tau)), there.at(ball(tau))
        assert (there.x(b) - here.x(a) - dx * phi - dv * E).overlaps(zero)
        assert (b.v - a.v + oscillator.km * dx * E - dv * E1).overlaps(zero)


@pytest.mark.parametrize("regime", REGIMES)
def test_derivatives_by_the_start_are_differences_of_flights(regime: str) -> None:
    p, (dt, dx, dv) = Parameters(**BASE | REGIMES[regime]), (Fraction(3, 7), Fraction(-2, 5), Fraction(1, 3))
    tau, small = Fraction(1, 2) * (Fraction(1, 100) if regime == "stiff" else 1), Fraction(1, 10**30)
    with working_bits(300):
        ends = []
        for side in (-1, 1):
            t, x, v = (ball(1 + side * small * each) for each in (dt, dx, dv))
            flight = Flight(Oscillator(p), 2, FlightStart(t, x, v))
            there = flight.at(1 + ball(tau) - t)
            ends.append((flight.x(there), there.v))
        middle = Flight(Oscillator(p), 2, FlightStart(arb(1), arb(1), arb(1)))
        derivatives = middle.moved(middle.at(ball(tau)), [ball(dt), ball(dx), ball(dv)])
        for found, below, above in zip(derivatives, *ends, strict=True):
            assert abs((above - below) / ball(2 * small) - found) < 1e-18 * (1 + abs(found))


@pytest.mark.parametrize("regime", ["underdamped", "overdamped", "critical", "undamped", "no drive"])
def test_a_bound_for_all_later_times_is_one(regime: str) -> None:
    p, rng = Parameters(**BASE | REGIMES[regime]), random.Random(regime)
    with working_bits(128):
        flight = Flight(Oscillator(p), 2, FlightStart(arb(0), arb(3), arb(1)))
        for tau in (Fraction(0), Fraction(3, 2), Fraction(6)):
            bound = flight.stays_within(flight.at(ball(tau)))
            assert bound.is_finite()
            later = [tau + Fraction(rng.randint(0, 400), 10) for _ in range(40)]
            assert not any(abs(flight.at(ball(time)).v) > bound for time in later)
