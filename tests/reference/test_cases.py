"""The set of cases: its content, the published closed forms, the hard cases, events and condition
numbers of a case.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace
from fractions import Fraction
from math import inf, pi
from pathlib import Path
from typing import Any

import mpmath
import pytest
from cli_runs import good, run
from oracle import flow_oracle, simulate_oracle

from symosc import Parameters, ReferenceCase, Scene, load_scene, reference_cases, simulate
from symosc.certificates.certificate import Certificate
from symosc.certificates.verify_orbits import verify
from symosc.kernels.theorem7_cases import place
from symosc.reference.case import COMPUTED, PROVEN, conditions, last_period, relative_error, shifted
from symosc.reference.cases import (
    CASE_GROUPS,
    DAMPED,
    GRAZE_TIMES,
    GRAZES,
    LATE_PERIODS,
    LONG_RUNS,
    PEAKS,
    SET_VERSION,
    amplitude,
    chosen,
    hard_cases,
    start_before_a_dip,
    start_before_a_peak,
    wall,
)
from symosc.reference.folder import exact_text

# -- sets ------------------------------------------------------------------------------------------


CASES = {case.name: case for case in reference_cases()}
LONG_ONES = [case for case in CASES.values() if case.group == LONG_RUNS]


#: The set of each version; a change needs a new version, and its sum here.
SUMS = {
    2: "6bafa391aa44ed1d3f2c893cc40f4f57d795494e3c380633a0e2489fedc2f9b7",
    1: "4077d4da02f059cf8fc3e1f13f4a7bfa9234b1b57ddf56a9bef3b65bab9739fa",
}


def test_a_changed_set_has_a_new_version() -> None:
    lines = []
    for case in CASES.values():
        start = (exact_text(getattr(case, name)) for name in ("t0", "x0", "v0", "t_end"))
        numbers = [*case.parameters.as_dict().values(), *start]
        lines.append(
            " ".join([case.name, *numbers, str(case.scene.start_error), str(case.periods)])
        )
    checksum = hashlib.sha256("\n".join(lines).encode()).hexdigest()
    assert checksum == SUMS.get(SET_VERSION), f"the sum of version {SET_VERSION} is {checksum}"


@pytest.mark.full(16)
@pytest.mark.quick(4)
@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.group != LONG_RUNS])
def test_cases_are_proven_or_say_why_not(name: str) -> None:
    case = CASES[name]
    assert case.proven == (not case.open)
    assert isinstance(case.certificate, Certificate)
    assert case.status == case.expected_status == (PROVEN if case.proven else COMPUTED)
    if case.proven:
        known = [(*event[2:3], *event[4:6], event.t, event.x) for event in case.events]
        assert known == [tuple(event) for event in case.certificate.events]


@pytest.mark.parametrize("form", [(), ("--json",)])
def test_a_list_of_the_cases_computes_none(
    form: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    def computed(_: object) -> None:
        raise AssertionError("a case is computed")

    for name in ("certificate", "events", "conditions", "derivatives"):
        monkeypatch.setattr(ReferenceCase, name, property(computed))
    listed = good("cases", *form)
    assert all(name in listed for name in CASES)
    assert form or listed.splitlines()[-1] == "167 cases, 164 of them proven"
    asked = run("cases", "--group", "easy", "--events", *form)
    assert isinstance(asked.exception, AssertionError)


@pytest.mark.slow
@pytest.mark.full(3)
@pytest.mark.parametrize("case", LONG_ONES, ids=lambda case: case.name)
def test_long_runs_are_long_and_proven(case: ReferenceCase) -> None:
    assert case.proven == (not case.open)
    assert len(case.events) >= 200


def value(text: str) -> mpmath.mpf:
    """Return the value of a closed form's expression."""
    names = {
        name: getattr(mpmath, name)
        for name in ("pi", "sqrt", "log", "sin", "cos", "tan", "atan", "sinh", "cosh")
    }
    exact = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e-?\d+)?)", r"mpf('\1')", text)
    return eval(exact, {"__builtins__": {}}, names | {"mpf": mpmath.mpf})


CLOSED = [name for name, case in CASES.items() if case.closed_form and case.group != LONG_RUNS]


def test_a_meeting_in_closed_form_has_its_form() -> None:
    """A velocity v = A/c (1 - exp(-c t/m)) meets belt 1 if A/c is beyond its speed, at log(1 + c
    v1/(A - c v1)) m/c.
    """
    times = [
        re.findall(r"t\[0\] = (.+)", " ".join(CASES[f"limit-speed-{i}"].closed_form))
        for i in (1, 2, 3, 4)
    ]
    assert [len(found) for found in times] == [1, 1, 0, 0]
    for (text,), beyond in zip(times[:2], ("1e-3", "1e-12"), strict=True):
        assert value(text) == pytest.approx(mpmath.log(1 + 1 / mpmath.mpf(beyond)) / 2, rel=1e-14)


@pytest.mark.full(12)
@pytest.mark.quick(5)
@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms_are_what_happens(name: str) -> None:
    assert_closed(CASES[name])


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [case for case in LONG_ONES if case.closed_form], ids=lambda case: case.name
)
def test_closed_forms_hold_after_hundreds_of_events(case: ReferenceCase) -> None:
    assert_closed(case)


def assert_closed(case: ReferenceCase) -> None:
    with mpmath.workdps(60):
        for form in case.closed_form:
            read = re.fullmatch(r"([tx])\[(\d+)\] = (.+)", form)
            assert read is not None
            number = case.events[int(read[2])].middle["tx".index(read[1])]
            exact = value(read[3])
            error = abs(mpmath.mpf(number.numerator) / number.denominator - exact) / max(
                1, abs(exact)
            )
            assert error < mpmath.mpf("1e-38") * (1 if case.group != GRAZES else 10), form


def test_den_hartogs_amplitudes_are_the_published_ones() -> None:
    """The values that are in print."""
    printed = {
        ("0", "0.4", "1.5"): "0.6531972647421811",
        ("0.1", "0.25", "0.6"): "1.487067086810845",
    }
    printed["0.2", "0.4", "1.5"] = "0.5488324917917096"
    with mpmath.workdps(30):
        for numbers, expected in printed.items():
            assert abs(value(amplitude(*numbers)) - mpmath.mpf(expected)) < 1e-15


@pytest.mark.slow
@pytest.mark.full(1)
@pytest.mark.parametrize("Omega", ["1-5", "0-8"])
def test_the_border_of_motions_without_stops_is_where_den_hartog_has_it(Omega: str) -> None:
    """The border is F = 0.64657909 at r = 1.5, 0.81740639 at r = 0.8."""
    border = {"1-5": Fraction("0.64657909"), "0-8": Fraction("0.81740639")}[Omega]
    below = CASES[f"border-{Omega}-below"]
    above = CASES[f"border-{Omega}-above"]
    assert below.parameters.mu1 < border < above.parameters.mu1
    assert {event.kind for event in below.events[-6:]} == {"cross"}
    assert {event.kind for event in above.events[-6:]} == {"stick", "slip"}


def test_the_continuum_ends_where_csernak_has_it() -> None:
    for case in CASES.values():
        if case.name.startswith("continuum"):
            F = case.parameters.mu1
            Omega = case.parameters.Omega
            stays = {event.kind for event in case.events} == {"cross"}
            middle = case.x0 - 1 / (1 - Omega**2)
            assert stays == (abs(middle) < Omega**2 / (1 - Omega**2) - F), case.name
    assert wall("0.1", "1/2").mu1 == Fraction(1, 10)


@pytest.mark.full(5)
@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", GRAZE_TIMES)
@pytest.mark.parametrize("regime", DAMPED)
def test_grazes_are_what_their_names_say(regime: str, mapping: str, tmp_path: object) -> None:
    case = CASES[f"graze-{regime.replace(' ', '-')}-{mapping}"]
    p = case.parameters
    touch = case.events[0]
    discriminant = p.c**2 - 4 * p.m * p.k
    detuned = p.k - p.m * p.Omega**2
    regimes = {
        "underdamped": p.c > 0 > discriminant,
        "critically damped": discriminant == 0,
        "overdamped": discriminant > 0 and p.k > Fraction(1, 100),
        "undamped": p.c == 0 and detuned != 0,
        "undamped resonance": p.c == 0 == detuned,
        "near resonance": 0 < p.c < Fraction(1, 1000) and detuned == 0,
        "weak spring": 0 < p.k < Fraction(1, 100),
    }
    assert regimes[regime]
    where = place(mapping)
    assert (touch.kind, touch.boundary, touch.source) == (
        "graze",
        where.boundary,
        f"Omega{where.domain}",
    )
    case.certificate.to_json(f"{tmp_path}/it.json")
    assert verify(f"{tmp_path}/it.json")[0] == 0


def test_the_page_about_the_set_counts_right() -> None:
    text = (Path(__file__).parents[2] / "docs" / "cases.md").read_text(encoding="utf-8")
    unproven = sum(bool(case.open) for case in CASES.values())
    assert (
        f"There are {len(CASES)}, in version {SET_VERSION} of the set. For {len(CASES) - unproven} of them the list"
        in text
    )
    assert f"The other {unproven} are computed" in text
    counts = {
        row[0]: int(row[1]) for row in re.findall(r"^\| ([^|]+) \| (\d+) \|", text, re.MULTILINE)
    }
    assert sum(counts.values()) == len(CASES)
    hard = {case.group for case in hard_cases()}
    for group in set(CASE_GROUPS) - hard:
        assert counts[group] == len(chosen(group))
    assert counts[f"hard cases, {len(hard)} groups"] == len(hard_cases())


# -- hard cases ------------------------------------------------------------------------------------


@pytest.mark.quick(5)
@pytest.mark.parametrize(
    ("base", "mapping", "t_m", "t0", "exponent"), [(*row[:4], e) for row in PEAKS for e in row[5]]
)
@pytest.mark.parametrize("side", [1, -1])
def test_peaks_are_as_far_from_the_belt_as_said(
    base: str, mapping: str, t_m: str, t0: str, exponent: int, side: int
) -> None:
    """By the exponential of the ODE's matrix: v there, and where the acceleration is 0."""
    p = load_scene(base).parameters
    where = place(mapping)
    height = Fraction(side, 10**exponent)
    start = start_before_a_peak(p, mapping, height, t_m, t0)
    with mpmath.workdps(50):
        _, v, a = flow_oracle(p, where.domain, *start, Fraction(t_m) - Fraction(t0))
        beyond = (v - mpmath.mpf(p.belt(where.boundary).numerator)) * (
            1 if where.domain == where.boundary else -1
        )
        assert abs(beyond - mpmath.mpf(height.numerator) / height.denominator) < 4e-16
        assert abs(a) < 1e-14


@pytest.mark.parametrize("height", ["-1e-6", "1e-12"])
def test_dips_are_as_deep_as_said(height: str) -> None:
    p = load_scene("fig5").parameters  # m = c = k = v1 = 1, B0 = 10, Omega = 1
    t0, x0, _ = start_before_a_dip(p, height, "2.5")
    with mpmath.workdps(40):
        least = mpmath.pi + mpmath.asin(
            mpmath.mpf(1) / 10
        )  # where d/dt (10 cos(t) - t) = 0 and rises
        x = mpmath.mpf(x0) + least - mpmath.mpf(t0)
        force = mpmath.mpf(p.A(1).numerator) / p.A(1).denominator + 10 * mpmath.cos(least) - x - 1
        assert abs(force - mpmath.mpf(height)) < 1e-15


# The oracle's power series takes seconds to minutes for these rates; the next stiffest cases are
# with it.
TOO_STIFF = {"light-mass-m-1e-5", "light-mass-m-1e-8"}

FOR_THE_ORACLE = [case for case in hard_cases() if not case.periods and case.name not in TOO_STIFF]


@pytest.mark.slow
@pytest.mark.full(30)
@pytest.mark.parametrize("case", FOR_THE_ORACLE, ids=lambda case: case.name)
def test_references_agree_with_the_oracle(case: ReferenceCase) -> None:
    scene = case.scene
    most = 6
    reference = simulate(scene, digits=40).events[:most]
    if reference:
        end = min(scene.t_end, Fraction(str(reference[-1].t)) + 1)
    else:
        end = scene.t_end
    run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, end, 45, max_events=most)
    assert len(run.events) >= len(reference)
    for event, expected in zip(reference, run.events, strict=False):
        assert (event.kind, event.boundary, event.source, event.target) == expected[1:5]
        assert max(relative_error(event.t, expected.t), relative_error(event.x, expected.x)) < 1e-34


def test_long_runs_end_with_the_orbit() -> None:
    """After few periods the motion is the orbit to many digits.

    The same events as in any later period.
    """
    case = CASES["1e5-periods-fig10-orbit"]
    period = 2 * mpmath.pi / mpmath.mpf("1.75")
    end = case.scene.t0 + Fraction(str(20.05 * period))
    early = replace(case.scene, t_end=end)
    expected = simulate(early, digits=20).events
    assert len(expected) == 20 * 4
    for event, other in zip(last_period(early, 30), expected[-4:], strict=True):
        assert (event.kind, event.boundary) == (other.kind, other.boundary)
        assert max(relative_error(event.t, other.t), relative_error(event.x, other.x)) < 1e-19
    turns = (case.scene.t_end - case.scene.t0) / Fraction(str(period))
    assert LATE_PERIODS < turns < LATE_PERIODS + 0.1
    last = last_period(case.scene, 40)[-1]
    assert 0 < case.scene.t_end - Fraction(float(last.t)) < Fraction(1)


# -- case ------------------------------------------------------------------------------------------


def test_what_is_not_proven_is_between_decimals_too() -> None:
    case = replace(CASES["continuum-1-2"], open="it is taken for one that is not proven")
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


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["graze-overdamped-P5", "graze-weak-spring-P2"])
def test_a_graze_has_no_condition_and_what_follows_it_has(name: str) -> None:
    """A start that is rounded to a double grazes no more; the events after it move by so much."""
    case = CASES[name]
    first, *conditions_after = case.conditions
    assert first == inf
    assert 0 < max(conditions_after) == case.condition < 100
    start = {name: float(getattr(case, name)) for name in ("t0", "x0", "v0")}
    motion = simulate(case.parameters, **start, t_end=case.t_end)
    regular = [event for event in motion.events if event.kind != "graze"]
    touch = float(case.events[0].middle[0])
    later = [event for event in regular if abs(event.t - touch) > 1e-4]
    for event, known, condition in zip(later, case.events[1:], conditions_after, strict=True):
        assert (event.kind, event.boundary) == (known.kind, known.boundary)
        t, x = map(float, known.middle)
        error = max(abs(event.t - t) / max(1, t), abs(event.x - x) / max(1, abs(x)))
        assert error < 100 * condition * 1e-16


def test_a_very_long_run_has_the_events_of_its_last_period() -> None:
    pytest.importorskip("flint")
    case = CASES["1e5-periods-fig10-orbit"]
    assert (len(case.events), case.count) == (4, 400_000)
    assert case.proven
    assert case.certificate.kind == "settled"
    period = 2 * pi / float(case.parameters.Omega)
    assert all(
        case.t_end - Fraction(period) < event.middle[0] < case.t_end for event in case.events
    )
    for known, event in zip(case.events, last_period(case.scene, 50), strict=True):
        for (low, high), value in zip((known.t, known.x), (event.t, event.x), strict=True):
            assert Fraction(low) <= Fraction(value.context.nstr(value, 48)) <= Fraction(high)


# -- condition -------------------------------------------------------------------------------------


def in_many_digits(scene: Scene, digits: int) -> Any:
    return simulate(scene, digits=digits).events


def test_the_condition_of_a_constant_acceleration() -> None:
    """With A = A0 + (mu1 + mu2) FN, v = v0 + A t/m meets v1 after m (v1 - v0)/A, at x0 + m (v1^2 -
    v0^2)/(2 A).
    """
    p = Parameters(m=3, c=0, k=0, A0=1, B0=0, Omega=1, v1=5, v2=9, mu1="0.3", mu2="0.2", FN=2)
    scene = Scene("constant", p, Fraction(7), Fraction(11), Fraction(-1), Fraction(30))
    m = 3
    A = 2
    v1 = 5
    v0 = -1
    x0 = 11
    t0 = 7
    passed = m * (v1 - v0) / A
    way = m * (v1**2 - v0**2) / (2 * A)
    shares = (1, 0.6, 0.4, 1)  # A0, mu1 FN, mu2 FN, FN itself, as parts of A
    by_force = sum(shares) / A
    t = (t0 + passed * (1 + by_force) + m * (v1 + abs(v0)) / A) / (t0 + passed)
    x = (x0 + way * (1 + by_force) + m * (v1**2 + v0**2) / A) / (x0 + way)
    assert conditions(scene, in_many_digits)[0] == pytest.approx(max(t, x), rel=1e-12)


@pytest.mark.slow
def test_near_a_graze_the_condition_grows_with_the_root_of_the_distance() -> None:
    scenes = [CASES[f"peak-beyond-a-belt-by-1e-{n}-P2-fig7-corrected"].scene for n in (7, 11)]
    worst = [max(conditions(scene, in_many_digits)) for scene in scenes]
    assert worst[1] / worst[0] == pytest.approx(100, rel=0.01)


def test_a_start_on_a_belt_moves_with_it() -> None:
    scene = load_scene("fig9")
    step = Fraction(1, 8)
    assert shifted(scene, "v0", step) == scene
    moved = shifted(scene, "v1", step)
    assert moved.v0 == moved.parameters.v1 == Fraction(9, 8)
    assert shifted(scene, "v2", step).v0 == 1
    assert shifted(scene, "x0", step).x0 == scene.x0 * 9 / 8
    assert shifted(scene, "m", step).parameters == scene.parameters.replace(m="0.1125")


def test_events_that_any_change_turns_into_others_have_no_condition() -> None:
    scene = load_scene("fig5")
    first, second, third = simulate(scene, digits=130, max_events=3).events

    def touching(neighbour: Scene, digits: int) -> Any:
        k = neighbour.parameters.k
        graze = replace(second, kind="graze" if k == scene.parameters.k else "stick")
        return [replace(first, t=first.t + digits_of(k - scene.parameters.k, first)), graze, third]

    def digits_of(value: Fraction, event: Any) -> Any:
        return event.t.context.mpf(value.numerator) / value.denominator

    numbers = conditions(scene, touching)
    assert numbers[0] == pytest.approx(float(1 / max(1, first.t)))
    assert numbers[1:] == [inf, inf]
