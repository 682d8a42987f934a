"""Where the flow into a tangency came from: the oracle's flow from there ends in it."""

from __future__ import annotations

import pickle
from fractions import Fraction

import mpmath
import pytest
from grazing_starts import BELT, DOMAIN
from oracle import flow_oracle

from symosc import ParameterError, grazing_window, load_scene
from symosc.grazing import origin
from symosc.grazing.backward_flow import CONTACT, LONG, REACHED, Arrival, BackwardState
from symosc.grazing.flight import Flights
from symosc.grazing.origin import Origins

FIG9 = load_scene("fig9").parameters.replace(v2="1.5")  # low enough for P6 to graze


@pytest.mark.quick(4)
@pytest.mark.parametrize("part", ["0.2", "0.5", "0.9"])
@pytest.mark.parametrize("mapping", sorted(BELT))
def test_the_flow_from_an_origin_ends_in_the_tangency(mapping: str, part: str) -> None:
    low, high = map(Fraction, grazing_window(FIG9, mapping).intervals[0][:2])
    origins, theta = Origins(FIG9, mapping), low + (high - low) * Fraction(part)
    arrival, flights = origins.exact(theta, 1, lambda flights: flights.number(Fraction(1, 4)), 40)
    assert arrival.kind in (CONTACT, REACHED)
    x_m = flights.contact(flights.number(theta))
    t_m, tau = theta / FIG9.Omega, Fraction(mpmath.nstr(arrival.tau, 60))
    x0, v0 = (Fraction(mpmath.nstr(value, 60)) for value in (x_m + arrival.dx, arrival.v))
    x, v, a = flow_oracle(FIG9, DOMAIN[mapping], t_m - tau, x0, v0, tau, 60)[:3]
    assert abs(x - x_m) < 1e-35
    assert abs(v - flights.number(FIG9.belt(BELT[mapping]))) < 1e-35
    assert abs(a) < 1e-35
    assert max(arrival.x_error, arrival.v_error) < 1e-40
    rough = origins.arrival(theta, far=0.25)
    assert rough.kind == arrival.kind
    assert float(rough.tau) == pytest.approx(float(arrival.tau), abs=1e-12)


@pytest.mark.slow
def test_origins_go_to_other_processes() -> None:
    origins = Origins(FIG9, "P5")
    again = pickle.loads(pickle.dumps(origins))
    assert (again.p, again.mapping) == (origins.p, origins.mapping)
    assert again.arrival(5.5, far=1.0) == origins.arrival(5.5, far=1.0)


def test_flights_are_made_once() -> None:
    origins = Origins(FIG9, "P5")
    assert origins.flights(30) is origins.flights(30)
    assert origins.flights(30).digits == 30
    assert origins.flights(31) is not origins.flights(30)


def test_without_a_spring_and_without_a_graze() -> None:
    with pytest.raises(ParameterError, match=r"^k = .*must be > 0"):
        Origins(FIG9.replace(k=0), "P2")
    with pytest.raises(ParameterError, match="leads from v2 to v1"):
        Origins(FIG9, "P7")


@pytest.mark.parametrize("lacking", [1, 5])
def test_a_digit_that_is_missing_is_computed(lacking: int, monkeypatch: pytest.MonkeyPatch) -> None:
    low, high = map(Fraction, grazing_window(FIG9, "P2").intervals[0][:2])
    origins, missing = Origins(FIG9, "P2"), iter([lacking, 0])
    monkeypatch.setattr(Flights, "missing_digits", lambda self, arrival, wanted: next(missing))
    _, flights = origins.exact((low + high) / 2, 1, lambda flights: flights.number(Fraction(1, 4)), 20)
    assert next(missing, None) is None
    assert flights.digits >= 20 + 20 + lacking


def test_a_contact_just_at_the_end_of_the_search_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """With all digits: one that comes later than asked for is none, and the end of the time is polished instead."""
    origins = Origins(load_scene("fig9").parameters, "P2")
    theta = Fraction(1)
    found = origins.arrival(theta, 1)
    assert found.kind == CONTACT
    exact, _ = origins.exact(theta, 1, lambda each: each.number(2) * each.number(found.tau), 20)
    at_end, _ = origins.exact(theta, 1, lambda each: each.number(exact.tau), 20)
    assert (at_end.kind, at_end.boundary, at_end.tau) == (CONTACT, exact.boundary, exact.tau)
    monkeypatch.setattr(origins, "arrival", lambda *_, **__: found)  # doubles do not tell
    before, _ = origins.exact(theta, 1, lambda each: each.number(exact.tau) * (1 - each.number(1) / 10**18), 20)
    assert (before.kind, before.boundary) == (REACHED, 0)
    assert before.tau < exact.tau


def test_a_search_that_has_looked_often_enough_ends_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """An end like others, with the bounds of its errors; until then it goes on from the state that was found."""
    monkeypatch.setattr(origin, "MOST_LOOKS", 2)
    origins = Origins(FIG9, "P2")
    state = BackwardState(0.5, -0.25, 1.5, 2.5, 1e-9, 2e-9, 3e-9)
    monkeypatch.setattr(Flights, "look", lambda *_: (None, state))
    look = origins._look(Fraction(1), 1, 30, 2)
    assert look(0.0) == (None, state)
    arrival, at = look(0.0)
    assert at == state
    assert arrival == Arrival(LONG, 0, 0.5, -0.25, 1.5, 2.5, 2e-9, 3e-9)
