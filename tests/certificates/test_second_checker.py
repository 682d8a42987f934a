"""A checker that shares nothing with the first one confirms what is proven, and refuses what is forged."""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from typing import Any

import law_forgeries as laws
import pytest
from certificate_files import document
from orbit_list import listed_orbits
from second_checker import program, second_opinion

from symosc import certify, find_orbit, load_scene, reference_cases

pytestmark = [pytest.mark.slow, pytest.mark.skipif(program() is None, reason="needs g++ with GMP")]
SCENES = (
    "fig5",
    "fig6",
    "fig7",
    "fig7-corrected",
    "fig7-exact",
    "fig8-exact",
    "fig9",
    "fig9-orbit",
)
#: Too stiff, too long or too late for its steps; a graze of exact starts, which it does not prove;
#: no proof.
MAY_STAY_UNDECIDED = (
    "light-mass-",
    "fast-and-slow-",
    "belts-B0-0-c-0",
    "creeping-",
    "rest-",
    "late-start-",
    "continuum-",
)
#: More than 30 events.
LEFT_OUT = ("paper-fig10", "fig8s-sticks-10-", "border-", "free-decay-3", "long-", "1e5-periods-")
CASES = [case for case in reference_cases() if not case.name.startswith(LEFT_OUT)]


@pytest.mark.full(2)
@pytest.mark.parametrize("name", SCENES)
def test_scenes_are_confirmed(name: str) -> None:
    assert second_opinion(certify(name).as_dict()) == "proven"


@pytest.mark.full(2)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_reference_cases_are_confirmed(case: Any) -> None:
    data = case.certificate.as_dict()
    if data["proven"]:
        answer = second_opinion(data)
    else:
        answer = "undecided"
    assert answer == "proven" or (
        answer.startswith("undecided") and case.name.startswith(MAY_STAY_UNDECIDED)
    )


@pytest.mark.full(1)
@pytest.mark.parametrize("first", range(20))
def test_most_short_orbits_are_confirmed_and_none_is_refused(first: int) -> None:
    """The others take more steps than it has."""
    short = [
        orbit
        for orbit in listed_orbits()
        if len(orbit.word) < 5 and orbit.p.c**2 < 4 * orbit.p.k * orbit.p.m
    ][:60]
    answers = [second_opinion(orbit.prove().as_dict()) for orbit in short[first::20]]
    assert not [each for each in answers if each.startswith("not proven")]
    assert answers.count("proven") >= 2


#: Files about other friction laws: static friction, curves, three belts, no drive.
LAWS = ("law S1", "law S8", "law 7 2", "law 7 10", "law-orbit stick-slip", "law-orbit falling")


@pytest.mark.full(3)
@pytest.mark.parametrize("name", LAWS)
def test_other_friction_laws_are_confirmed(name: str) -> None:
    assert second_opinion(document(name)) == "proven"


@pytest.mark.full(3)
@pytest.mark.parametrize(
    "forged",
    [
        laws.crossing_through_static_friction,
        laws.slip_of_kinetic_friction,
        laws.constant_friction_with_a_curve,
        laws.graze_of_static_friction,
        laws.arrival_beyond_the_limit_that_sticks,
        laws.belt_without_number,
        laws.other_way_in,
        laws.drive_left_out,
    ],
)
def test_what_is_forged_about_other_laws_is_not_confirmed(forged: Any) -> None:
    assert second_opinion(forged(), most_bits=256) != "proven"


def shifted(ends: list[str]) -> list[str]:
    """Return an interval of the same width beside the given one."""
    low, high = map(Fraction, ends)
    return [str(high), str(2 * high - low)]


def test_changed_numbers_and_kinds_are_refused() -> None:
    motion = certify("fig7-exact").as_dict()
    orbit = certify(find_orbit(load_scene("fig9").parameters, "P32")).as_dict()
    forged = []
    for data in (motion, orbit):
        for i in range(0, len(data["events"]), 9):
            forged.append(deepcopy(data))
            forged[-1]["events"][i]["tx"[i % 2]] = shifted(data["events"][i]["tx"[i % 2]])
        forged.append(deepcopy(data))
        del forged[-1]["events"][0]
        forged.append(deepcopy(data))
        forged[-1]["parameters"]["mu1"] = str(
            Fraction(data["parameters"]["mu1"]) + Fraction(1, 1000)
        )
    forged.append(orbit | {"stable": False})
    for i in (0, 1):
        for part in ("re", "im"):
            forged.append(deepcopy(orbit))
            forged[-1]["multipliers"][i][part] = shifted(orbit["multipliers"][i][part])
    forged.append(motion | {"t_end": "100"})
    forged.append(deepcopy(motion))
    low, high = (Fraction(motion["free"][name]) for name in ("low", "high"))
    forged[-1]["free"]["high"] = str(low + (high - low) / 1000)
    found = [second_opinion(data, most_bits=128) for data in forged]
    assert "proven" not in found
