"""The set of cases: what it must have, which events are not proven and why, and the published closed forms."""

from __future__ import annotations

import hashlib
import re
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest

from symosc import ParameterError, ReferenceCase, reference_cases
from symosc.certificates.certificate import Certificate
from symosc.certificates.verify_orbits import verify
from symosc.mappings.theorem7_cases import place
from symosc.reference.case import COMPUTED, PROVEN
from symosc.reference.coulomb import amplitude, wall
from symosc.reference.folder import exact_text
from symosc.reference.grazes import DAMPED, GRAZES, TOUCHES
from symosc.reference.hard_cases import hard_cases
from symosc.reference.rests import RESTS
from symosc.reference.sets import CASE_GROUPS, LONG_RUNS, PAPER_SCENES, SET_VERSION, chosen

CASES = {case.name: case for case in reference_cases()}
LONG_ONES = [case for case in CASES.values() if case.group == LONG_RUNS]


def test_what_the_set_has() -> None:
    assert len(CASES) == len(reference_cases()) >= 120
    assert list(dict.fromkeys(case.group for case in CASES.values())) == list(CASE_GROUPS)
    assert (
        sum(case.group in {each.group for each in hard_cases()} for case in CASES.values()) == len(hard_cases()) == 73
    )
    for case in CASES.values():
        assert re.fullmatch(r"[A-Za-z0-9]+(-[A-Za-z0-9]+)*", case.name)
        assert case.hard
        assert case.source
        assert "," not in case.group


#: The set of each version; a change needs a new version, and its sum here.
SUMS = {1: "4077d4da02f059cf8fc3e1f13f4a7bfa9234b1b57ddf56a9bef3b65bab9739fa"}


def test_a_changed_set_has_a_new_version() -> None:
    lines = []
    for case in CASES.values():
        numbers = [
            *case.parameters.as_dict().values(),
            *(exact_text(getattr(case, n)) for n in ("t0", "x0", "v0", "t_end")),
        ]
        lines.append(" ".join([case.name, *numbers, str(case.scene.start_error), str(case.periods)]))
    assert hashlib.sha256("\n".join(lines).encode()).hexdigest() == SUMS[SET_VERSION]


def test_a_group_is_chosen_by_name() -> None:
    assert [case.name for case in chosen("easy")] == ["easy-fig9", "easy-fig10"]
    assert len(chosen(None)) == len(CASES)
    with pytest.raises(ParameterError, match="group = 'hard': is none; there are: paper, easy"):
        chosen("hard")


@pytest.mark.quick(8)
@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.group != LONG_RUNS])
def test_cases_are_proven_or_say_why_not(name: str) -> None:
    case = CASES[name]
    assert case.proven == (not case.open)
    assert isinstance(case.certificate, Certificate)
    assert case.status == (PROVEN if case.proven else COMPUTED)
    if case.proven:
        known = [(*event[2:3], *event[4:6], event.t, event.x) for event in case.events]
        assert known == [tuple(event) for event in case.certificate.events]


@pytest.mark.slow
@pytest.mark.parametrize("case", LONG_ONES, ids=lambda case: case.name)
def test_long_runs_are_long_and_proven(case: ReferenceCase) -> None:
    assert case.proven == (not case.open)
    assert len(case.events) >= 200


def value(text: str) -> mpmath.mpf:
    """Return the value of a closed form's expression."""
    names = {name: getattr(mpmath, name) for name in ("pi", "sqrt", "log", "sin", "cos", "tan", "sinh", "cosh")}
    exact = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e-?\d+)?)", r"mpf('\1')", text)
    return eval(exact, {"__builtins__": {}}, names | {"mpf": mpmath.mpf})


CLOSED = [name for name, case in CASES.items() if case.closed_form and case.group != LONG_RUNS]


@pytest.mark.quick(10)
@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms_are_what_happens(name: str) -> None:
    assert_closed(CASES[name])


@pytest.mark.slow
@pytest.mark.parametrize("case", [case for case in LONG_ONES if case.closed_form], ids=lambda case: case.name)
def test_closed_forms_hold_after_hundreds_of_events(case: ReferenceCase) -> None:
    assert_closed(case)


def assert_closed(case: ReferenceCase) -> None:
    with mpmath.workdps(60):
        for form in case.closed_form:
            read = re.fullmatch(r"([tx])\[(\d+)\] = (.+)", form)
            assert read is not None
            number = case.events[int(read[2])].middle["tx".index(read[1])]
            exact = value(read[3])
            error = abs(mpmath.mpf(number.numerator) / number.denominator - exact) / max(1, abs(exact))
            assert error < mpmath.mpf("1e-38") * (1 if case.group != GRAZES else 10), form


def test_there_are_closed_forms_of_each_kind() -> None:
    assert len([case for case in CASES.values() if case.closed_form]) >= 50
    for kind in ("den-hartog", "resonance-growth", "free-decay", "continuum", "creeping", "limit-speed", "graze"):
        assert any(case.name.startswith(kind) and case.closed_form for case in CASES.values()), kind


def test_den_hartogs_amplitudes_are_the_published_ones() -> None:
    """The values that are in print."""
    printed = {("0", "0.4", "1.5"): "0.6531972647421811", ("0.1", "0.25", "0.6"): "1.487067086810845"}
    printed["0.2", "0.4", "1.5"] = "0.5488324917917096"
    with mpmath.workdps(30):
        for numbers, expected in printed.items():
            assert abs(value(amplitude(*numbers)) - mpmath.mpf(expected)) < 1e-15


@pytest.mark.slow
@pytest.mark.parametrize("Omega", ["1-5", "0-8"])
def test_the_border_of_motions_without_stops_is_where_den_hartog_has_it(Omega: str) -> None:
    """The border is F = 0.64657909 at r = 1.5, 0.81740639 at r = 0.8."""
    border = {"1-5": Fraction("0.64657909"), "0-8": Fraction("0.81740639")}[Omega]
    below, above = CASES[f"border-{Omega}-below"], CASES[f"border-{Omega}-above"]
    assert below.parameters.mu1 < border < above.parameters.mu1
    assert {event.kind for event in below.events[-6:]} == {"cross"}
    assert {event.kind for event in above.events[-6:]} == {"stick", "slip"}


def test_the_continuum_ends_where_csernak_has_it() -> None:
    for case in CASES.values():
        if case.name.startswith("continuum"):
            F, Omega = case.parameters.mu1, case.parameters.Omega
            stays = {event.kind for event in case.events} == {"cross"}
            middle = case.x0 - 1 / (1 - Omega**2)
            assert stays == (abs(middle) < Omega**2 / (1 - Omega**2) - F), case.name
    assert wall("0.1", "1/2").mu1 == Fraction(1, 10)


@pytest.mark.quick(4)
@pytest.mark.parametrize("mapping", TOUCHES)
@pytest.mark.parametrize("regime", DAMPED)
def test_grazes_are_what_their_names_say(regime: str, mapping: str, tmp_path: object) -> None:
    case = CASES[f"graze-{regime.replace(' ', '-')}-{mapping}"]
    p, touch = case.parameters, case.events[0]
    discriminant, detuned = p.c**2 - 4 * p.m * p.k, p.k - p.m * p.Omega**2
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
    assert (touch.kind, touch.boundary, touch.source) == ("graze", where.boundary, f"Omega{where.domain}")
    case.certificate.to_json(f"{tmp_path}/it.json")
    assert verify(f"{tmp_path}/it.json")[0] == 0


def test_rests_stay_and_what_is_beyond_the_edge_slips() -> None:
    for case in CASES.values():
        if case.group == RESTS and case.name.startswith("rest-"):
            assert bool(case.events) == (case.name == "rest-edge-slips")


def test_the_papers_scenes_are_all_there() -> None:
    assert len(chosen(PAPER_SCENES)) == 11


def test_the_page_about_the_set_counts_right() -> None:
    text = (Path(__file__).parents[2] / "docs" / "cases.md").read_text(encoding="utf-8")
    unproven = sum(bool(case.open) for case in CASES.values())
    assert f"There are {len(CASES)}, in version {SET_VERSION} of the set. Of {len(CASES) - unproven} the list" in text
    assert f"The other {unproven} are computed" in text
    counts = {row[0]: int(row[1]) for row in re.findall(r"^\| ([^|]+) \| (\d+) \|", text, re.MULTILINE)}
    assert sum(counts.values()) == len(CASES)
    hard = {case.group for case in hard_cases()}
    for group in set(CASE_GROUPS) - hard:
        assert counts[group] == len(chosen(group))
    assert counts[f"hard cases, {len(hard)} groups"] == len(hard_cases())
