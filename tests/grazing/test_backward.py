"""The way back from a tangency, against the oracle that knows only the ODE.

The search for the first root.
"""

from __future__ import annotations

import random
from fractions import Fraction
from math import pi, sqrt
from typing import Any

import mpmath
import numpy as np
import pytest
from grazing_starts import BELT, DOMAIN
from oracle import flow_oracle
from units import UNITS, Units

from symosc import Parameters, grazing_curve, grazing_start, grazing_window, load_scene
from symosc.grazing.backward import CONTACT, REACHED, Flights, Origins, first_root
from symosc.grazing.check import Ways

BASE = Parameters(
    m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3
)


def test_a_flow_that_touches_the_other_belt_on_the_way() -> None:
    # fig8's orbit to which all motions tend grazes both belts, half a period apart
    start = grazing_start(load_scene("fig8").parameters, "P5", 0)
    assert (start.found, start.touch, start.boundary) == (False, True, 1)
    assert abs(start.t + pi / 2) < 1e-12
    assert "touches belt 1" in str(start.reason)


def test_unforced_overdamped_flow_runs_away() -> None:
    # v'' + 3 v' + 2 v = 0 from v = -1, a = 0: v = -2 e^{-t} + e^{-2t}, backward -> +infinity; belt
    # 1 at -1 is met at the root of e^{2s} - 2 e^s + 1 = (e^s - 1)^2: only s = 0, so domain 2 is
    # left through belt 2
    p = BASE.replace(c=3, k=2, B0=0)
    start = grazing_start(p, "P3", 1)
    s = _log_root(float(p.v2))
    assert (start.found, start.boundary) == (False, 2)
    assert abs(float(start.t_m) - float(start.t) - s) < 1e-12
    # P5, from v = 1.5 below belt 2: v = 3 e^{-t} - 1.5 e^{-2t}: falls backward through belt 1
    start = grazing_start(p, "P5", 1)
    assert (start.found, start.boundary) == (False, 1)
    # P2 with v1 > 0: v = 2 v1 e^{-t} - v1 e^{-2t} runs away downward and never was on belt 1
    start = grazing_start(p.replace(v1=1), "P2", 1)
    assert (start.found, start.t, start.boundary, start.start) == (False, None, 0, {})
    assert "never met a belt" in str(start.reason)


def _log_root(v: float) -> float:
    # e^{2s} - 2 e^s = v
    return float(mpmath.log(1 + sqrt(1 + v)))


MAPS = sorted(BELT)
REGIMES = {"underdamped": "0.7", "overdamped": "7", "undamped": "0"}


def system(c: str) -> Parameters:
    return Parameters(
        m="1.3",
        c=c,
        k="2.1",
        A0="0.4",
        B0="6.3",
        Omega="1.7",
        v1="-1.1",
        v2="1.9",
        mu1="0.3",
        mu2="0.2",
        FN=4,
    )


def number(value: Any) -> Fraction:
    return Fraction(mpmath.nstr(value, 60))


@pytest.mark.quick(3)
@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("mapping", MAPS)
def test_the_flight_leads_into_the_tangency(mapping: str, regime: str) -> None:
    """The oracle, from a point of the flight, arrives with the belt's speed at the contact, without acceleration."""
    p = system(REGIMES[regime])
    rng = random.Random(mapping + regime)
    flights = Flights(p, mapping, 50)
    for _ in range(3):
        theta = flights.number(Fraction(rng.randint(0, 628), 100))
        tau = flights.number(Fraction(rng.randint(1, 80), 20))
        now = flights.instant(theta, tau)
        x_m = flights.contact(theta)
        t_m = theta / flights.number(p.Omega)
        begin = number(t_m - tau)
        x, v = flow_oracle(
            p, DOMAIN[mapping], begin, number(x_m + now.dx), number(now.v), number(tau), 60
        )[:2]
        size = max(1, abs(x_m), abs(now.v), abs(now.a))
        assert abs(x - x_m) < 1e-40 * size
        assert abs(v - flights.v) < 1e-40 * size


@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("mapping", MAPS)
def test_derivatives_are_differences(mapping: str, regime: str) -> None:
    p = system(REGIMES[regime])
    rng = random.Random(mapping)
    flights = Flights(p, mapping, 50)
    theta = flights.number(Fraction(rng.randint(0, 628), 100))
    tau = flights.number(Fraction(rng.randint(2, 60), 20))
    step = flights.number(Fraction(1, 10**15))
    low, now, high = (flights.instant(theta + n * step, tau) for n in (-1, 0, 1))
    moved = [flights.contact(theta + n * step) for n in (-1, 1)]
    assert abs((high.v - low.v) / (2 * step) - now.v_theta) < 1e-25 * (1 + abs(now.v_theta))
    assert abs((high.dx + moved[1] - low.dx - moved[0]) / (2 * step) - now.x_theta) < 1e-25 * (
        1 + abs(now.x_theta)
    )
    # and by time: x' = v, v' = a, a' = b, b' = w; tau runs back
    before, after = (flights.instant(theta, tau + n * step) for n in (1, -1))
    for value, slope in (("dx", now.v), ("v", now.a), ("a", now.b), ("b", now.w)):
        result = (getattr(after, value) - getattr(before, value)) / (2 * step)
        assert abs(result - slope) < 1e-24 * (1 + abs(slope)), value


FIG9 = load_scene("fig9").parameters.replace(v2="1.5")  # low enough for P6 to graze


@pytest.mark.quick(4)
@pytest.mark.parametrize("part", ["0.2", "0.5", "0.9"])
@pytest.mark.parametrize("mapping", sorted(BELT))
def test_the_flow_from_an_origin_ends_in_the_tangency(mapping: str, part: str) -> None:
    low, high = map(Fraction, grazing_window(FIG9, mapping).intervals[0][:2])
    origins = Origins(FIG9, mapping)
    theta = low + (high - low) * Fraction(part)
    arrival, flights = origins.refined_arrival(
        theta, 1, lambda flights: flights.number(Fraction(1, 4)), 40
    )
    assert arrival.kind in (CONTACT, REACHED)
    x_m = flights.contact(flights.number(theta))
    t_m = theta / FIG9.Omega
    tau = Fraction(mpmath.nstr(arrival.tau, 60))
    x0, v0 = (Fraction(mpmath.nstr(value, 60)) for value in (x_m + arrival.dx, arrival.v))
    x, v, a = flow_oracle(FIG9, DOMAIN[mapping], t_m - tau, x0, v0, tau, 60)[:3]
    assert abs(x - x_m) < 1e-35
    assert abs(v - flights.number(FIG9.belt(BELT[mapping]))) < 1e-35
    assert abs(a) < 1e-35
    assert max(arrival.x_error, arrival.v_error) < 1e-40
    rough = origins.arrival(theta, far=0.25)
    assert rough.kind == arrival.kind
    assert float(rough.tau) == pytest.approx(float(arrival.tau), abs=1e-12)


def least_on(p: list[float], low: float, high: float) -> float:
    """Return the least value of a polynomial on an interval, from all zeros of its slope."""
    slope = np.polynomial.Polynomial(p).deriv()
    inner = [float(z.real) for z in slope.roots() if abs(z.imag) < 1e-9 and low < z.real < high]
    return min(float(np.polynomial.Polynomial(p)(item)) for item in (low, high, *inner))


def drawn(rng: random.Random) -> list[float]:
    """Return a polynomial that is positive at 0.

    About half of them come near to 0 and part again.
    """
    if rng.random() < 0.5:
        bottom = rng.uniform(0.05, 0.95)
        depth = rng.choice([-1, 1]) * 10 ** rng.uniform(-9, -1)
        degree = rng.randint(0, 3)
        curve = np.polynomial.Polynomial([bottom**2 + depth, -2 * bottom, 1.0])
        for _ in range(degree):
            curve = curve * np.polynomial.Polynomial([1.0, rng.uniform(-0.4, 0.4)])
        result = curve.coef.tolist()
    else:
        result = [rng.uniform(0.1, 1), *(rng.uniform(-2, 2) for _ in range(rng.randint(1, 7)))]
    if result[0] > 0:
        return result
    return [abs(result[0]), *result[1:]]


def test_what_is_said_holds_for_every_polynomial_within_the_noise() -> None:
    """No root: all are positive. A root: all are positive before it and have one there.

    A touch: it is open.
    """
    rng = random.Random(8)
    said = {"none": 0, "root": 0, "touch": 0}
    for _ in range(700):
        p = drawn(rng)
        noise = 10 ** rng.uniform(-12, -2)
        if p[0] <= noise:
            continue
        touch, sigma = first_root(p, noise, 2.0**-53)
        if sigma is None:
            assert not touch
            assert least_on(p, 0.0, 1.0) > noise * (1 - 1e-9)
            said["none"] += 1
            continue
        assert 0 < sigma <= 1
        value = float(np.polynomial.Polynomial(p)(sigma))
        if touch:
            assert abs(value) <= noise * (1 + 1e-6) + 1e-15
            assert least_on(p, 0.0, sigma) >= -noise * (1 + 1e-6)
            said["touch"] += 1
            continue
        assert abs(value) < 1e-12
        assert least_on(p, 0.0, sigma * (1 - 1e-6)) > -1e-12  # it is the first one ...
        assert least_on(p, 0.0, 1.0) < -noise  # ... and no polynomial within the noise is without
        said["root"] += 1
    assert min(said.values()) > 40


SCENES = [load_scene(name).parameters for name in ("fig5", "fig8", "fig9", "fig10")]


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", UNITS, ids=str)
@pytest.mark.parametrize(
    ("p", "mapping"), [(SCENES[2], "P2"), (SCENES[3], "P5")], ids=["fig9", "fig10"]
)
def test_windows_curves_and_starts_are_the_same(units: Units, p: Parameters, mapping: str) -> None:
    q = units.of(p)
    L = float(units.length)
    one = grazing_window(p, mapping)
    two = grazing_window(q, mapping)
    assert (one.intervals, one.case, one.theta_cr) == (two.intervals, two.case, two.theta_cr)
    theta = np.linspace(*one.intervals[0][:2], 9)[1:-1]
    assert two.contact(theta) == pytest.approx(one.contact(theta) * L, rel=1e-12)
    assert Ways(two).slope(theta) == pytest.approx(Ways(one).slope(theta), rel=1e-12)
    (a, *_), (b, *_) = (grazing_curve(item, mapping, 24).pieces for item in (p, q))
    assert b.theta_m == pytest.approx(a.theta_m, rel=1e-12)
    assert b.theta == pytest.approx(a.theta, rel=1e-9)
    assert b.x == pytest.approx(a.x * L, rel=1e-9)
    assert b.slope_x == pytest.approx(a.slope_x * L, rel=1e-6)
    start, other = (grazing_start(item, mapping, float(theta[3])) for item in (p, q))
    assert other.x == pytest.approx(start.x * L, rel=1e-12)
    assert other.t == pytest.approx(start.t * float(units.time), rel=1e-12)
