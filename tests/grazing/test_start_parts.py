"""What is made of the end of a search: the start, its decimals, and why there is none."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest

from symosc import load_scene
from symosc.engine.arithmetic import mp_context
from symosc.grazing import start
from symosc.grazing.backward_flow import CONTACT, LARGE, LONG, NEVER, REACHED, TOUCH, Arrival
from symosc.grazing.flight import Flights
from symosc.grazing.origin import OPEN_ORIGIN


def test_a_unit_of_the_last_decimal() -> None:
    for text, unit in (("1.5", "1/10"), ("-0.00230", "1/100000"), ("17", "0"), ("-3", "0"), ("0.0", "1/10")):
        assert start._unit(text) == Fraction(unit)


def test_a_decimal_has_so_many_digits_behind_the_point() -> None:
    """It is within a unit of its last place of the number, however large that is; no exponent, no digits dropped."""
    rng, context = random.Random(3), mp_context(80)
    for _ in range(60):
        value = context.mpf(rng.uniform(-1, 1)) * context.mpf(10) ** rng.randint(-12, 9) / 3
        digits = rng.randint(5, 40)
        text = start._text(value, digits, mp_context(60))
        assert "e" not in text
        assert len(text.partition(".")[2]) >= digits - 1
        exact = Fraction(text)
        assert abs(context.mpf(exact.numerator) / exact.denominator - value) <= context.mpf(10) ** (1 - digits)


def test_why_a_search_met_no_belt_is_said() -> None:
    arrival = Arrival("", 2, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for kind, words in (
        (NEVER, "never met a belt before: backward from t = -2.5 its velocity runs away from belt 1"),
        (REACHED, "met no belt in the 7 periods before; ask for more with periods="),
        (LARGE, "the search ended at t = -2.5: before that the velocity exceeds 1e+100"),
        (LONG, "the search ended at t = -2.5, after as many steps as it may take"),
        (OPEN_ORIGIN, "whether the flow meets belt 2 at t = -2.5 could not be decided"),
    ):
        found = start._no_end(arrival._replace(kind=kind), -2.5, 1, 7.0)
        assert found is not None
        assert words in found
    assert start._no_end(arrival._replace(kind=CONTACT), -2.5, 1, 7.0) is None
    assert start._no_end(arrival._replace(kind=TOUCH), -2.5, 1, 7.0) is None


def test_what_each_end_of_a_search_makes_of_a_start() -> None:
    """Found on the own belt only, or at t0 if that was asked for; undecided where the search gave up."""
    p = load_scene("fig9").parameters
    flights = Flights(p, "P2", 60)
    ends = [
        (CONTACT, 1),
        (TOUCH, 1),
        (CONTACT, 2),
        (TOUCH, 2),
        (OPEN_ORIGIN, 2),
        *((kind, 0) for kind in (REACHED, NEVER, LARGE, LONG)),
    ]
    for kind, boundary in ends:
        for to_time in (False, True):
            tau, dx, v = flights.number(0.75), flights.number(-0.5), flights.number(2.25)
            arrival = Arrival(kind, boundary, tau, dx, v, flights.number(1.5), 0 * tau, 0 * tau)
            found = start._result(arrival, flights, "P2", Fraction(3), Fraction(1), to_time, None, 100.0)
            own = kind in (CONTACT, TOUCH) and boundary == 1
            assert found.found == (kind == REACHED if to_time else own)
            assert (found.reason is None) == found.found
            if not found.found and boundary and kind != OPEN_ORIGIN:
                assert found.reason is not None
                verb = "touches" if kind == TOUCH else "comes from"
                assert f"the flow {verb} belt {boundary} at t = 2.25, x = " in found.reason
                assert found.reason.startswith("between t0 and t_m the flow" if to_time else "the flow")
            nowhere = kind in (NEVER, LARGE, LONG, OPEN_ORIGIN) or (kind == REACHED and not to_time)
            assert found.undecided == (nowhere and kind != NEVER)
            assert found.touch == (kind == TOUCH)
            assert (found.t_m, found.theta_m) == (3.0, 1.0)
            assert found.x_m == pytest.approx(float(flights.contact(flights.number(1))))
            if nowhere:
                assert (found.t, found.x, found.v, found.theta, found.boundary, found.start) == (*[None] * 4, 0, {})
                continue
            speed = float(p.belt(boundary)) if boundary else 2.25
            assert (found.t, found.v, found.boundary) == (2.25, speed, boundary)
            assert found.x == pytest.approx(found.x_m - 0.5)
            assert found.theta == pytest.approx((1 - 4 * 0.75) % (2 * math.pi))
            assert Fraction(found.start["v0"]) == Fraction(speed)
            errors = found.start["start_error"]
            assert errors[:2] == (start._unit(found.start["t0"]), start._unit(found.start["x0"]))
            assert errors[2] == (0 if boundary else start._unit(found.start["v0"]))
