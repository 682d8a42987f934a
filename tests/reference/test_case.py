"""A case's events and conditions."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction
from math import inf, pi

import pytest

from symosc import ReferenceCase, reference_cases, simulate
from symosc.reference.case import COMPUTED, described
from symosc.reference.condition import conditions
from symosc.reference.hard_cases import last_period

CASES = {case.name: case for case in reference_cases()}


def test_what_is_not_proven_is_between_decimals_too() -> None:
    case = CASES["continuum-1-2"]
    assert case.status == COMPUTED
    for i, event in enumerate(case.events):
        t_low, t_high, x_low, x_high = map(Fraction, (*event.t, *event.x))
        assert 0 <= t_high - t_low < Fraction(1, 10**38) * t_high
        t, x = case.events[i].middle
        assert t_low <= t <= t_high
        assert x == (x_low + x_high) / 2
        exact = Fraction(1, 10) + (1 if i % 2 else -1) * Fraction(4, 3)
        assert x_low <= exact <= x_high
        assert abs(float(t) - 2 * pi * (i + 1)) < 1e-13


@pytest.mark.parametrize("name", ["paper-fig6", "free-decay-2"])
def test_conditions_are_those_of_the_scene(name: str) -> None:
    assert CASES[name].conditions == tuple(conditions(CASES[name].scene))
    assert CASES[name].condition == max(CASES[name].conditions)


@pytest.mark.parametrize("name", ["graze-overdamped-P5", "graze-weak-spring-P2"])
def test_a_graze_has_no_condition_and_what_follows_it_has(name: str) -> None:
    """A start that is rounded to a double grazes no more; the events after it move by so much."""
    case = CASES[name]
    first, *others = case.conditions
    assert first == inf
    assert 0 < max(others) == case.condition < 100
    start = {each: float(getattr(case, each)) for each in ("t0", "x0", "v0")}
    found = [event for event in simulate(case.parameters, **start, t_end=case.t_end).events if event.kind != "graze"]
    near = [event for event in found if abs(event.t - float(case.events[0].middle[0])) > 1e-4]
    for event, known, condition in zip(near, case.events[1:], others, strict=True):
        assert (event.kind, event.boundary) == (known.kind, known.boundary)
        t, x = (float(each) for each in known.middle)
        error = max(abs(event.t - t) / max(1, t), abs(event.x - x) / max(1, abs(x)))
        assert error < 100 * condition * 1e-16


def test_a_very_long_run_has_the_events_of_its_last_period() -> None:
    pytest.importorskip("flint")
    case = CASES["1e5-periods-fig10-orbit"]
    assert (len(case.events), case.count) == (4, 400_000)
    assert case.proven
    assert case.certificate.kind == "settled"
    period = 2 * pi / float(case.parameters.Omega)
    assert all(case.t_end - Fraction(period) < event.middle[0] < case.t_end for event in case.events)
    for known, event in zip(case.events, last_period(case.scene, 50), strict=True):
        for (low, high), value in zip((known.t, known.x), (event.t, event.x), strict=True):
            assert Fraction(low) <= Fraction(value.context.nstr(value, 48)) <= Fraction(high)


def test_words_and_what_is_shown() -> None:
    case: ReferenceCase = CASES["paper-fig6"]
    assert [event.word for event in case.events] == ["P4", "P7", "P1"]
    assert repr(case) == "<ReferenceCase paper-fig6: 3 events, proven>"
    assert described(case) == "t0 = 0, x0 = 0, v0 = 5, t_end = 20"


@pytest.mark.slow
def test_cases_are_there_without_the_extra_that_proves_them() -> None:
    """The chapter on published results takes closed forms from here."""
    code = "import sys; sys.modules['flint'] = None; import symosc.reference.sets, symosc.derive.published"
    assert subprocess.run([sys.executable, "-c", code], check=False, capture_output=True).returncode == 0
