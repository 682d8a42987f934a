"""The first contact: found, proven to be the first, or called open; compared with samples and with near touches."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from problems import FAMILIES

from symosc import Parameters, Scene, certify, load_scene
from symosc.certificates.balls import Undecided, ball, working_bits
from symosc.certificates.contact import Wall, first_zero, gap_of, sharper, zero_in
from symosc.certificates.flow import Flight, FlightStart, Oscillator
from symosc.certificates.turns import Turns


def _flight(p: Parameters, t0: Fraction, x0: Fraction, v0: Fraction) -> tuple[Flight, list[Wall]]:
    domain = 1 + (v0 > p.v1) + (v0 > p.v2)
    flight = Flight(Oscillator(p), domain, FlightStart(ball(t0), ball(x0), ball(v0)))
    return flight, [Wall(b, 1 if domain > b else -1, Turns(p, b)) for b in (1, 2) if domain - b in (0, 1)]


@pytest.mark.quick(2)
@pytest.mark.parametrize("family", ["ordinary", "light", "stiff", "no spring", "resonant"])
def test_the_first_zero_is_where_samples_change_their_sign(family: str) -> None:
    rng = random.Random(family)
    with working_bits(128):
        for _ in range(12):
            p, start = FAMILIES[family](rng)
            t0, x0, v0 = (Fraction(start[name]) for name in ("t0", "x0", "v0"))
            if v0 in (p.v1, p.v2):
                continue
            flight, walls = _flight(p, t0, x0, v0)
            for wall in walls:
                gap, found = gap_of(flight, wall), first_zero(flight, wall, arb(4), False)
                values = [gap(arb(float(tau))).g for tau in np.linspace(0, 4, 400)]
                low = 4.0 if found is None else float(found[0].tau.mid())
                assert all(value > 0 for i, value in enumerate(values) if i * 4 / 399 < low)
                if found is not None:
                    tau = zero_in(gap, found[0].tau, found[1].tau, "a contact", flight.start.t)
                    assert float(tau.rad()) < 1e-25
                    assert gap(tau).g.contains(0)
                    assert gap((tau.mid() - arb("1e-20")).mid()).g > 0 > gap((tau.mid() + arb("1e-20")).mid()).g


@pytest.mark.parametrize("exponent", [3, 8, 13, 25, 31])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_belt_just_beside_the_peak_is_met_or_missed(exponent: int, sign: int) -> None:
    """fig7's orbit peaks at 5 exactly: a belt that is slower by 10**-n is met, and one that is faster is not."""
    scene = load_scene("fig7-exact")
    p = scene.parameters.replace(v1=5 + Fraction(sign, 10**exponent))
    with working_bits(256):
        flight, (wall,) = _flight(p, scene.t0, scene.x0, scene.v0)
        assert (first_zero(flight, wall, arb(3), False) is None) == (sign > 0)


def test_a_touch_is_open_however_many_bits_there_are() -> None:
    scene = load_scene("fig7-exact")
    for bits in (64, 128):  # the start is given to 45 digits, and touches as far as those tell
        with working_bits(bits):
            flight, (wall,) = _flight(scene.parameters, scene.t0, scene.x0, scene.v0)
            with pytest.raises(Undecided) as open_contact:
                first_zero(flight, wall, arb(3), False)
            assert open_contact.value.touch is not None
            boundary, tau = open_contact.value.touch
            assert boundary == 1
            assert float(tau.mid()) == pytest.approx(3.14159265358979 - 2.5, abs=1e-4)


def test_a_dip_between_two_equal_slopes_is_found() -> None:
    """Its secant is no number: the gap falls as fast at both ends of the piece, a whole period apart."""
    numbers = {"m": "13/2", "c": 2, "k": "51597/2000000", "A0": "-670761/20000000", "B0": "-83349/12500000"}
    speeds = {"v1": "-166697999997/50000000000000", "v2": "2165849/25000000", "mu1": 0, "mu2": 0, "FN": "179/25"}
    p = Parameters(**numbers, Omega="63/1000", **speeds)
    scene = Scene("dip", p, Fraction(0), Fraction("-1.3"), Fraction(-83349, 25000000), Fraction(300))
    certificate = certify(scene)
    assert certificate.proven, certificate.message
    assert [event[0] for event in certificate.events] == ["cross"] * 7


def test_a_start_on_the_wall_is_not_a_contact() -> None:
    p = load_scene("fig9").parameters
    with working_bits(128):
        flight = Flight(Oscillator(p), 1, FlightStart(arb(0), arb(4), ball(p.v1)))
        assert flight.a0 < 0
        wall = Wall(1, -1, Turns(p, 1))
        found = first_zero(flight, wall, arb(5), True)
        assert found is not None
        assert found[1].tau > 0.1
        with pytest.raises(Undecided):
            first_zero(flight, wall, arb(5), False)


def test_a_sharper_zero_lies_in_the_first_one() -> None:
    p = load_scene("fig9").parameters
    with working_bits(128):
        flight, walls = _flight(p, Fraction(0), Fraction(4), Fraction(-3))
        found = first_zero(flight, walls[0], arb(5), False)
        assert found is not None
        gap = gap_of(flight, walls[0])
        tau = zero_in(gap, found[0].tau, found[1].tau, "a contact", flight.start.t)
        wide = tau + arb(0, 1e-6)
        again = sharper(gap, wide, gap(wide).dg)
        assert wide.contains(again)
        assert again.overlaps(tau)
        assert float(again.rad()) < 1e-18
