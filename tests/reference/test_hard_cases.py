"""The hard cases: what they say of themselves, and their references."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import mpmath
import pytest
from oracle import flow_oracle, simulate_oracle

from symosc import load_scene, simulate
from symosc.exact import show
from symosc.mappings.theorem7_cases import place
from symosc.reference.compare import relative_error
from symosc.reference.hard_cases import (
    GROUPS,
    LATE_PERIODS,
    PEAKS,
    HardCase,
    hard_cases,
    start_before_a_dip,
    start_before_a_peak,
)

CASES = {(case.group, case.name): case for case in hard_cases()}

ONE_OF_EACH = {case.group: case for case in hard_cases() if case.quick}


def test_every_group_has_cases_and_a_quick_one() -> None:
    assert {case.group for case in hard_cases()} == set(GROUPS) == set(ONE_OF_EACH)
    assert len(CASES) == len(hard_cases())
    for case in hard_cases():
        if not case.periods:  # nobody loses digits in reading them
            assert max(len(show(getattr(case.scene, name)).strip("-0.")) for name in ("t0", "x0", "v0")) <= 18, (
                case.name
            )


@pytest.mark.quick(10)
@pytest.mark.parametrize(("base", "mapping", "t_m", "t0", "exponent"), [(*row[:4], e) for row in PEAKS for e in row[5]])
@pytest.mark.parametrize("side", [1, -1])
def test_peaks_are_as_far_from_the_belt_as_said(
    base: str, mapping: str, t_m: str, t0: str, exponent: int, side: int
) -> None:
    """By the exponential of the ODE's matrix: v there, and where the acceleration is 0."""
    p, where = load_scene(base).parameters, place(mapping)
    height = Fraction(side, 10**exponent)
    start = start_before_a_peak(p, mapping, height, t_m, t0)
    with mpmath.workdps(50):
        _, v, a = flow_oracle(p, where.domain, *start, Fraction(t_m) - Fraction(t0))
        beyond = (v - mpmath.mpf(p.belt(where.boundary).numerator)) * (1 if where.domain == where.boundary else -1)
        assert abs(beyond - mpmath.mpf(height.numerator) / height.denominator) < 4e-16
        assert abs(a) < 1e-14


def test_a_peak_without_a_flight_before_it_is_refused() -> None:
    p = load_scene("fig10").parameters
    with pytest.raises(ValueError, match=r"no flight from t = 0.5 peaks at t = 1: .*belt 1"):
        start_before_a_peak(p, "P5", Fraction(1, 10**8), "1", "0.5")


@pytest.mark.parametrize("height", ["-1e-6", "1e-12"])
def test_dips_are_as_deep_as_said(height: str) -> None:
    p = load_scene("fig5").parameters  # m = c = k = v1 = 1, B0 = 10, Omega = 1
    t0, x0, _ = start_before_a_dip(p, height, "2.5")
    with mpmath.workdps(40):
        least = mpmath.pi + mpmath.asin(mpmath.mpf(1) / 10)  # where d/dt (10 cos(t) - t) = 0 and rises
        x = mpmath.mpf(x0) + least - mpmath.mpf(t0)
        force = mpmath.mpf(p.A(1).numerator) / p.A(1).denominator + 10 * mpmath.cos(least) - x - 1
        assert abs(force - mpmath.mpf(height)) < 1e-15


# The oracle's power series takes seconds to minutes for these rates; the next stiffest cases are with it.
TOO_STIFF = {"m = 1e-5", "m = 1e-8"}

FOR_THE_ORACLE = [case for case in hard_cases() if not case.periods and case.name not in TOO_STIFF]


@pytest.mark.slow
@pytest.mark.parametrize("case", FOR_THE_ORACLE, ids=lambda case: case.name)
def test_references_agree_with_the_oracle(case: HardCase) -> None:
    scene, most = case.scene, 6
    reference = case.reference()[:most]
    end = min(scene.t_end, Fraction(str(reference[-1].t)) + 1) if reference else scene.t_end
    run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, end, 45, max_events=most)
    assert len(run.events) >= len(reference)
    for event, expected in zip(reference, run.events, strict=False):
        assert (event.kind, event.boundary, event.source, event.target) == expected[1:5]
        assert max(relative_error(event.t, expected.t), relative_error(event.x, expected.x)) < 1e-34


def test_long_runs_end_with_the_orbit() -> None:
    """After few periods the motion is the orbit to many digits: the same events as in any later period."""
    case = CASES["1e5 periods", "fig10-orbit"]
    period = 2 * mpmath.pi / mpmath.mpf("1.75")
    end = case.scene.t0 + Fraction(str(20.05 * period))
    early = replace(case.scene, t_end=end)
    expected = simulate(early, digits=20).events
    assert len(expected) == 20 * 4
    for event, other in zip(case.reference(early, 30), expected[-4:], strict=True):
        assert (event.kind, event.boundary) == (other.kind, other.boundary)
        assert max(relative_error(event.t, other.t), relative_error(event.x, other.x)) < 1e-19
    turns = (case.scene.t_end - case.scene.t0) / Fraction(str(period))
    assert LATE_PERIODS < turns < LATE_PERIODS + 0.1
    last = case.reference()[-1]
    assert 0 < case.scene.t_end - Fraction(float(last.t)) < Fraction(1)
