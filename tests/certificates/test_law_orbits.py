"""Orbits of any friction law: against closed forms and an oracle; changed files do not pass."""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from math import pi
from random import Random

import mpmath
import numpy as np
import pytest
import shooting_oracle
from certificate_files import document, judged
from law_orbit_certificates import (
    LAW_ORBIT_CHANGES,
    LAWS,
    orbit_is_true,
    orbit_of,
)
from law_orbits import DRIVEN, STICK_SLIP, TWO_BANDS, as_oracle, driven

from symosc import Belt, Oscillator, ParameterError, certify, continue_orbit, find_orbit, simulate
from symosc.orbits.shooting import orbit_near

STEADY = Oscillator(**DRIVEN, belts=[Belt(30, mu="0.7", mu_s=1)])


def test_the_stick_slip_cycle_is_that_of_its_closed_form() -> None:
    proof = certify(orbit_of("stick-slip"))
    assert (proof.proven, proof.stable, proof.kind) == (True, True, "orbit")
    first, slip, last = proof.statement["events"]
    with mpmath.workdps(40):
        flight = 2 * mpmath.pi - 2 * mpmath.atan(mpmath.mpf(5) / 2)
        period = Fraction(mpmath.nstr(5 + flight, 35))
    low = Fraction(last["t"][0]) - Fraction(first["t"][1])
    high = Fraction(last["t"][1]) - Fraction(first["t"][0])
    assert low < period < high < low + Fraction(1, 10**20)
    assert Fraction(slip["x"][0]) < 1 < Fraction(slip["x"][1])
    assert proof.multipliers[1] == (("0", "0"), ("0", "0"))
    assert "without a drive" in proof.message


@pytest.mark.parametrize("name", LAWS)
def test_orbits_are_proven_as_the_oracle_finds_them(name: str) -> None:
    whole = document(f"law-orbit {name}")
    assert judged(whole)[0] == 0
    assert orbit_is_true(whole, name)
    orbit = orbit_of(name)
    t, x, v = orbit.start
    truth = shooting_oracle.periodic_orbit(as_oracle(LAWS[name]), t, x, v, float(orbit.period))
    for value, row in zip(truth.multipliers, whole["multipliers"], strict=True):
        value = mpmath.mpc(value)
        for part, (low, high) in ((value.real, row["re"]), (value.imag, row["im"])):
            assert Fraction(low) - Fraction(1, 10**12) <= Fraction(float(part))
            assert Fraction(float(part)) <= Fraction(high) + Fraction(1, 10**12)


def test_an_unstable_orbit_in_chaos_is_proven_to_be_one() -> None:
    p = driven("1.26")
    motion = simulate(p, t_end="120T")
    times = 2 * pi / 1.4 * np.arange(20, 120)
    states = motion(times).T
    n = int(np.abs(states[1:] - states[:-1]).max(axis=1).argmin())
    proof = certify(orbit_near(p, times[n], *states[n].tolist(), 1))
    assert (proof.proven, proof.stable) == (True, False), proof.message
    assert proof.message.startswith("an unstable orbit S1∘B1 of 1 forcing period")
    other = deepcopy(proof.as_dict()) | {"stable": True}
    del other["message"]
    assert judged(other)[0] == 1


def test_the_unstable_cycle_born_at_a_corner_is_proven() -> None:
    """It meets no belt; period and multiplier are known from another program."""
    proof = certify(find_orbit(TWO_BANDS, guess=(0, 1, 2)))
    assert (proof.proven, proof.stable, proof.events) == (True, False, ())
    assert "which meets no belt, without a drive" in proof.message
    first, *_, last = (list(map(Fraction, row["t"])) for row in proof.statement["events"])
    period = Fraction("6.303840144088753120778267")
    assert last[0] - first[1] < period < last[1] - first[0]
    low, high = map(Fraction, proof.multipliers[0][0])
    assert abs((low + high) / 2 - Fraction("1.34838658643")) < Fraction(1, 10**11)


def test_a_steady_motion_that_meets_no_edge_is_proven() -> None:
    orbit = find_orbit(STEADY, x0=1)
    proof = certify(orbit)
    assert (proof.proven, proof.stable, proof.events) == (True, True, ())
    assert proof.message == (
        "a stable orbit of 1 forcing period, which meets no edge, the only such one in its band"
    )
    for value, (re, im) in zip(orbit.multipliers, proof.multipliers, strict=True):
        for part, (low, high) in ((value.real, re), (value.imag, im)):
            assert float(low) - 1e-11 < part < float(high) + 1e-11


def test_what_is_no_such_orbit_is_refused_by_name() -> None:
    wall = Oscillator(m=1, c=0, k=1, B0="0.3", Omega="0.58", belts=[Belt(0, mu="0.5", mu_s="0.8")])
    with pytest.raises(ParameterError, match="is a rest; certify a motion"):
        certify(find_orbit(wall, x0=5))
    branch = continue_orbit(STICK_SLIP, "S1 B1", "mu_s1", (1, "1.01"))
    with pytest.raises(ParameterError, match="static friction of belt 1"):
        certify(branch)


@pytest.mark.parametrize("change", LAW_ORBIT_CHANGES)
def test_a_changed_orbit_is_proven_only_if_it_is_still_true(change: str) -> None:
    judge_changed(change, Random(f"{change} of an orbit"), 2)


@pytest.mark.campaign
@pytest.mark.parametrize("change", LAW_ORBIT_CHANGES)
def test_many_changed_orbits(change: str) -> None:
    judge_changed(change, Random(f"many of {change}"), 25)


def judge_changed(change: str, rng: Random, count: int) -> None:
    for _ in range(count):
        name = rng.choice(list(LAWS))
        original = document(f"law-orbit {name}")
        other = deepcopy(original)
        LAW_ORBIT_CHANGES[change](rng, other)
        code, line = judged(other)
        assert code or other == original or orbit_is_true(other, name), (line, other)
