"""Proofs of periodic orbits: what they enclose, and what they must not prove."""

from __future__ import annotations

from fractions import Fraction

import pytest
from mpmath import mp

from symosc import ParameterError, Parameters, certify, find_orbit, load_scene
from symosc.certificates.orbit import OrbitToProve, certify_orbit
from symosc.certificates.orbit_list import listed_orbits, prove_listed
from symosc.orbits.periodic_orbit import PeriodicOrbit

DIGITS = 40
COULOMB = {"m": 1, "k": 1, "A0": 0, "B0": 1, "v1": 0, "v2": 100, "mu2": 0, "FN": 1}


def orbit_of(name: str, digits: int | None = None) -> PeriodicOrbit:
    scene = load_scene(name)
    return find_orbit(scene.parameters, scene.structure, digits=digits)


def within(value: object, ends: tuple[str, str]) -> bool:
    low, high = map(Fraction, ends)
    return low <= Fraction(mp.nstr(value, DIGITS - 3)) <= high or (low == high == 0 and abs(value) < 1e-30)


@pytest.mark.parametrize("name", ["fig9", "fig10"])
def test_orbits_of_the_paper(name: str) -> None:
    exact, proof = orbit_of(name, DIGITS), certify(orbit_of(name))
    assert (proof.kind, proof.proven, proof.stable) == ("orbit", True, True)
    for point, ends in zip(exact.points, proof.points, strict=True):
        assert within(point.t, ends[0])
        assert within(point.x, ends[1])
        assert all(Fraction(high) - Fraction(low) < Fraction(1, 10**22) for low, high in ends)
    for value, (re, im) in zip(exact.multipliers, proof.multipliers, strict=True):
        assert within(value.real, re)
        assert within(value.imag, im)


@pytest.mark.quick(2)
@pytest.mark.parametrize("i", [0, 7, 250, 501, 902])
def test_enclosures_contain_many_digits_in_all_regimes(i: int) -> None:
    listed = listed_orbits()[i]
    proof = prove_listed(listed)
    points = [(float(t[0]), float(x[0])) for t, x in proof.points]
    exact = find_orbit(listed.p, listed.word, points, digits=DIGITS, periods=1)
    turn = round(float((exact.points[0].t - mp.mpf(proof.points[0][0][0])) / exact.period)) * exact.period
    for point, (t, x) in zip(exact.points, proof.points, strict=True):
        assert within(point.t - turn, t)
        assert within(point.x, x)
    for value, (re, im) in zip(exact.multipliers, proof.multipliers, strict=True):
        assert within(value.real, re)
        assert within(value.imag, im)
    assert proof.stable is exact.stable


def test_a_member_of_a_continuum_is_not_unique() -> None:
    """Csernak, Stepan and Shaw (2007): without damping, at Omega = 1/(2 n), orbits are not isolated."""
    orbit = find_orbit(Parameters(**COULOMB, c=0, Omega="0.5", mu1="0.1"), "P32")
    proof = certify(orbit)
    assert (proof.proven, proof.stable) == (False, None)
    assert "marginal" in proof.message
    assert "need not be isolated" in proof.message
    beside = certify(find_orbit(orbit.parameters.replace(Omega="0.501"), "P32"))
    assert (beside.proven, beside.stable) == (True, True)


def test_a_mass_at_rest_has_no_orbit_to_prove() -> None:
    p = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=10, mu1=1, mu2="1/10", FN=1)
    for labels in (("P1", "P2"), ("P2", "P3"), ("P1", "P3")):
        points = tuple((0.5 + 3 * i, 0.1 * i) for i in range(len(labels)))
        proof = certify_orbit(OrbitToProve(p, labels, 1, points))
        assert not proof.proven, labels


def test_a_root_that_is_no_orbit_is_not_proven() -> None:
    root = find_orbit(load_scene("fig5").parameters, "P32")
    assert not root.admissible
    proof = certify(root)
    assert not proof.proven
    assert "F^(1) < 0 where P3 ends" in proof.message


@pytest.mark.parametrize("labels", [("P3", "P2"), ("P2", "P1"), ("P1", "P3"), ("P5", "P6")])
def test_another_word_at_the_points_of_an_orbit(labels: tuple[str, ...]) -> None:
    orbit = orbit_of("fig9")
    points = tuple((float(t), float(x)) for t, x in orbit.points)
    assert not certify_orbit(OrbitToProve(orbit.parameters, labels, 1, points)).proven


def test_several_periods_of_an_orbit_are_no_orbit_of_that_many() -> None:
    orbit = orbit_of("fig9")
    points = [(float(t), float(x)) for t, x in orbit.points]
    later = [(t + float(orbit.period), x) for t, x in points]
    proof = certify_orbit(OrbitToProve(orbit.parameters, orbit.labels * 2, 2, tuple(points + later)))
    assert not proof.proven
    assert proof.message.endswith("that the least period is 2 forcing periods, not 1")
    once = certify(orbit)
    assert proof.points[:2] == once.points


def test_a_motion_has_an_end_and_an_orbit_has_none() -> None:
    with pytest.raises(ParameterError, match="t_end = 3: is for a scene only"):
        certify(orbit_of("fig9"), t_end=3)
