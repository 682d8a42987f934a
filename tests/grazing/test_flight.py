"""Flights into a tangency: their derivatives against differences, their contacts against the oracle's flow."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from grazing_starts import BELT, DOMAIN
from oracle import flow_oracle

from symosc import Parameters
from symosc.grazing.backward_flow import CONTACT, REACHED, TOUCH, Arrival
from symosc.grazing.flight import Flights, rounded

MAPS = sorted(BELT)
REGIMES = {"underdamped": "0.7", "overdamped": "7", "undamped": "0"}


def system(c: str) -> Parameters:
    return Parameters(
        m="1.3", c=c, k="2.1", A0="0.4", B0="6.3", Omega="1.7", v1="-1.1", v2="1.9", mu1="0.3", mu2="0.2", FN=4
    )


def number(value: Any) -> Fraction:
    return Fraction(mpmath.nstr(value, 60))


@pytest.mark.quick(3)
@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("mapping", MAPS)
def test_the_flight_leads_into_the_tangency(mapping: str, regime: str) -> None:
    """The oracle, from a point of the flight, arrives with the belt's speed at the contact, without acceleration."""
    p, rng = system(REGIMES[regime]), random.Random(mapping + regime)
    flights = Flights(p, mapping, 50)
    for _ in range(3):
        theta, tau = (
            flights.number(Fraction(rng.randint(0, 628), 100)),
            flights.number(Fraction(rng.randint(1, 80), 20)),
        )
        now, x_m = flights.instant(theta, tau), flights.contact(theta)
        t_m = theta / flights.number(p.Omega)
        begin = number(t_m - tau)
        x, v = flow_oracle(p, DOMAIN[mapping], begin, number(x_m + now.dx), number(now.v), number(tau), 60)[:2]
        size = max(1, abs(x_m), abs(now.v), abs(now.a))
        assert abs(x - x_m) < 1e-40 * size
        assert abs(v - flights.v) < 1e-40 * size


@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("mapping", MAPS)
def test_derivatives_are_differences(mapping: str, regime: str) -> None:
    p, rng = system(REGIMES[regime]), random.Random(mapping)
    flights = Flights(p, mapping, 50)
    theta, tau = flights.number(Fraction(rng.randint(0, 628), 100)), flights.number(Fraction(rng.randint(2, 60), 20))
    step = flights.number(Fraction(1, 10**15))
    low, now, high = (flights.instant(theta + n * step, tau) for n in (-1, 0, 1))
    moved = [flights.contact(theta + n * step) for n in (-1, 1)]
    assert abs((high.v - low.v) / (2 * step) - now.v_theta) < 1e-25 * (1 + abs(now.v_theta))
    assert abs((high.dx + moved[1] - low.dx - moved[0]) / (2 * step) - now.x_theta) < 1e-25 * (1 + abs(now.x_theta))
    # and by time: x' = v, v' = a, a' = b, b' = w; tau runs back
    before, after = (flights.instant(theta, tau + n * step) for n in (1, -1))
    for value, slope in (("dx", now.v), ("v", now.a), ("a", now.b), ("b", now.w)):
        found = (getattr(after, value) - getattr(before, value)) / (2 * step)
        assert abs(found - slope) < 1e-24 * (1 + abs(slope)), value


def test_a_contact_is_polished_to_all_digits() -> None:
    p = system("0.7")
    flights = Flights(p, "P2", 60)
    theta, wall = flights.number(Fraction(11, 2)), p.belt(1)
    taus = [flights.number(Fraction(n, 50)) for n in range(1, 400)]
    gaps = [flights.instant(theta, tau).v - flights.v for tau in taus]
    i = next(i for i in range(5, len(gaps)) if gaps[i - 1] * gaps[i] < 0)
    near = mpmath.findroot(lambda tau: flights.instant(theta, tau).v - flights.v, (taus[i - 1], taus[i]), "anderson")
    now = flights.instant(theta, near)
    found = Arrival(CONTACT, 1, float(near) * (1 + 1e-12), now.dx, now.v, float(now.a), 1e-9, 1e-9)
    polished = flights.polished(theta, found, flights.number(100))
    assert polished is not None
    assert polished.v == flights.number(wall)
    assert abs(flights.instant(theta, polished.tau).v - flights.number(wall)) < 1e-55
    assert abs(polished.tau - near) < 1e-11
    assert flights.missing_digits(polished, 40) <= 0 < flights.missing_digits(polished, 70)
    # Newton's method that leads elsewhere is no answer
    assert flights.polished(theta, found._replace(tau=float(near) * 1.05), flights.number(100)) is None


def test_what_was_reached_is_evaluated_there() -> None:
    flights = Flights(system("0.7"), "P5", 40)
    theta, far = flights.number(Fraction(3)), flights.number(Fraction(7, 3))
    found = Arrival(REACHED, 0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    polished = flights.polished(theta, found, far)
    now = flights.instant(theta, far)
    assert polished is not None
    assert (polished.tau, polished.dx, polished.v, polished.a) == (far, now.dx, now.v, now.a)


def test_rounding_a_state_adds_its_error() -> None:
    flights = Flights(system("0.7"), "P5", 40)
    state = flights.state(flights.number(Fraction(3)), flights.number(Fraction(7, 3)))
    doubles = rounded(state)
    for name, error in (("dx", "x_error"), ("v", "v_error")):
        lost = abs(flights.number(getattr(doubles, name)) - getattr(state, name))
        assert lost <= getattr(doubles, error) <= 1e-15 * (1 + abs(getattr(doubles, name)))
        assert getattr(doubles, error) > getattr(state, error)


@pytest.mark.parametrize("a", [4.0, -0.25, 0.0])
def test_a_polished_contact_is_near_the_one_in_doubles(a: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Within a part of a step and what the error of its velocity allows; a touch has no slope to divide that by."""
    flights = Flights(system("0.7"), "P2", 40)
    theta, tau = flights.number(Fraction(1)), flights.number(Fraction(2))
    reach = 1e-3 / float(flights.K.rate) + 0.01 / (abs(a) or 1.0)
    found = Arrival(CONTACT if a else TOUCH, 1, 2.0, 0.0, -1.1, a, 0.01, 0.0)
    for part in (-1.01, -0.99, 0.0, 0.99, 1.01):
        monkeypatch.setattr(flights, "_root", lambda *_, part=part: tau + flights.context.mpf(part * reach))
        polished = flights.polished(theta, found, tau)
        assert (polished is None) == (abs(part) > 1)
        if polished is not None:
            assert float(polished.tau) == pytest.approx(2.0 + part * reach)
            assert (polished.kind, polished.boundary, float(polished.v)) == (found.kind, 1, -1.1)
            assert polished.dx == flights.instant(theta, polished.tau).dx
    monkeypatch.setattr(flights, "_root", lambda *_: None)
    assert flights.polished(theta, found, tau) is None
