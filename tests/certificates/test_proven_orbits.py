"""Orbits, the list that ships, branches and windows.

What their proofs enclose, and what they must not prove.
"""

from __future__ import annotations

import itertools
import random
from fractions import Fraction
from functools import cache

import pytest
from collect_orbits import collect, line
from mpmath import mp
from orbit_list import listed_orbits, prove_list

from symosc import Parameters, certify, continue_orbit, find_orbit, grazing_window, load_scene
from symosc.certificates.propose_orbits import (
    ALL_PHASES,
    BUT_ONE_PHASE,
    NO_PHASE,
    ON_AN_ARC,
    BranchProposal,
    ProposedEnd,
    certify_orbit,
)
from symosc.orbits.branch import Branch
from symosc.orbits.periodic_orbit import PeriodicOrbit

DIGITS = 40


COULOMB = {"m": 1, "k": 1, "A0": 0, "B0": 1, "v1": 0, "v2": 100, "mu2": 0, "FN": 1}


def orbit_of(name: str, digits: int | None = None) -> PeriodicOrbit:
    scene = load_scene(name)
    return find_orbit(scene.parameters, scene.structure, digits=digits)


def within(value: object, ends: tuple[str, str]) -> bool:
    low, high = map(Fraction, ends)
    return low <= Fraction(mp.nstr(value, DIGITS - 3)) <= high or (
        low == high == 0 and abs(value) < 1e-30
    )


@pytest.mark.parametrize("name", ["fig9", "fig10"])
def test_orbits_of_the_paper(name: str) -> None:
    exact = orbit_of(name, DIGITS)
    proof = certify(orbit_of(name))
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
    points = [(float(t[0]), float(x[0])) for t, x in listed.prove().points]
    exact = find_orbit(listed.p, listed.word, points, digits=DIGITS, periods=1)
    proof = certify(exact)
    turn = (
        round(float((exact.points[0].t - mp.mpf(proof.points[0][0][0])) / exact.period))
        * exact.period
    )
    for point, (t, x) in zip(exact.points, proof.points, strict=True):
        assert within(point.t - turn, t)
        assert within(point.x, x)
    for value, (re, im) in zip(exact.multipliers, proof.multipliers, strict=True):
        assert within(value.real, re)
        assert within(value.imag, im)
    assert proof.stable is exact.stable


def test_a_member_of_a_continuum_is_not_unique() -> None:
    """Csernak, Stepan and Shaw (2007).

    Without damping, at Omega = 1/(2 n), orbits are not isolated.
    """
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
        proof = certify_orbit(p, labels, 1, points)
        assert not proof.proven, labels


def test_a_root_that_is_no_orbit_is_not_proven() -> None:
    root = find_orbit(load_scene("fig5").parameters, "P32")
    assert not root.admissible
    proof = certify(root)
    assert not proof.proven
    assert "F^(2) > 0 where P2 crosses v1 (Theorem 5) fails" in proof.message


@pytest.mark.parametrize("labels", [("P3", "P2"), ("P2", "P1"), ("P1", "P3"), ("P5", "P6")])
def test_another_word_at_the_points_of_an_orbit(labels: tuple[str, ...]) -> None:
    orbit = orbit_of("fig9")
    points = tuple((float(t), float(x)) for t, x in orbit.points)
    assert not certify_orbit(orbit.parameters, labels, 1, points).proven


@pytest.mark.slow
def test_several_periods_of_an_orbit_are_no_orbit_of_that_many() -> None:
    orbit = orbit_of("fig9")
    points = [(float(t), float(x)) for t, x in orbit.points]
    later = [(t + float(orbit.period), x) for t, x in points]
    proof = certify_orbit(orbit.parameters, orbit.labels * 2, 2, points + later)
    assert not proof.proven
    assert proof.message.endswith("that the least period is 2 forcing periods, not 1")
    once = certify(orbit)
    assert proof.points[:2] == once.points


REGIMES = {"underdamped", "overdamped", "critically damped", "undamped"}


def test_there_are_many_of_all_kinds() -> None:
    orbits = listed_orbits()
    assert len({orbit.p for orbit in orbits}) == len(orbits) >= 1000
    assert len({orbit.cycle for orbit in orbits}) >= 20
    assert min(sum(orbit.regime == regime for orbit in orbits) for regime in REGIMES) >= 200


def test_a_sample_is_proven() -> None:
    orbits = listed_orbits()[::100]
    proofs = [orbit.prove() for orbit in orbits]
    assert [proof.message for proof in proofs if not proof.proven] == []
    assert all(proof.stable for orbit, proof in zip(orbits, proofs, strict=True) if orbit.p.c > 0)


def test_the_seed_gives_the_list() -> None:
    assert [*map(line, collect(3, 17))] == [*map(line, listed_orbits()[:3])]


@pytest.mark.slow
def test_processes_prove_their_files_again() -> None:
    first = listed_orbits()[0]
    orbits = [*listed_orbits()[:25], first._replace(p=first.p.replace(B0=first.p.B0 / 100))]
    answers = prove_list(orbits, workers=2, again=True)  # of 25 at a time
    assert answers[:25] == [""] * 25
    assert orbits[-1].word in answers[-1]
    assert "not proven" in answers[-1]


@cache
def branch(name: str, low: str, high: str) -> Branch:
    scene = load_scene(name)
    middle = str((Fraction(low) + Fraction(high)) / 2)
    return continue_orbit(
        scene.parameters.replace(Omega=middle), scene.structure, "Omega", (low, high)
    )


@pytest.mark.slow
@pytest.mark.full(1)
@pytest.mark.parametrize(
    ("name", "low", "high"), [("fig9", "3.99", "4.01"), ("fig10", "1.74", "1.76")]
)
def test_orbits_lie_in_the_boxes(name: str, low: str, high: str) -> None:
    seen: list[float] = []
    found = certify(branch(name, low, high), progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1
    assert (found.kind, found.proven, found.stable) == ("branch", True, True)
    boxes = found.statement["boxes"]
    scene = load_scene(name)
    values = [Fraction(each) for box in boxes for each in box["value"]]
    assert values == sorted(values)
    assert (values[0], values[-1]) == (Fraction(low), Fraction(high))
    for part in (Fraction(1, 7), Fraction(1, 2), Fraction(9, 10)):
        value = Fraction(low) + part * (Fraction(high) - Fraction(low))
        orbit = find_orbit(scene.parameters.replace(Omega=value), scene.structure)
        box = next(
            each
            for each in boxes
            if Fraction(each["value"][0]) <= value <= Fraction(each["value"][1])
        )
        for row in zip(box["t"][:-1], box["x"][:-1], strict=True):
            (t0, t1), (x0, x1) = ([float(end) for end in ends] for ends in row)
            T = float(orbit.period)
            assert any(
                x0 <= x <= x1 and t0 <= t + turns * T <= t1
                for t, x in orbit.points
                for turns in (-1, 0, 1)
            ), (
                row,
                orbit.points,
            )


def test_an_end_that_is_put_elsewhere_is_not_proven() -> None:
    """P32 touches v2 at Omega = 5.0176, neither before nor after it."""
    scene = load_scene("fig9")
    orbit = find_orbit(scene.parameters.replace(Omega="5.01"), "P32")
    start = ProposedEnd("end of the range", Fraction("5.01"), orbit.points)
    for value in ("5.012", "5.02"):
        end = ProposedEnd("grazing", Fraction(value), orbit.points)
        proposal = BranchProposal(scene.parameters, "Omega", orbit.labels, 1, (start, end))
        found = proposal.certificate()
        assert not found.proven, end
        assert "not decided" in found.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "low", "high", "kind", "value", "inequality"),
    [
        pytest.param(
            *("fig9", "5.017619", "5.1", "grazing", "5.01761965804", "v < v2 during P3"),
            marks=pytest.mark.campaign,
        ),
        ("fig9", "3.2", "3.2887", "birth of a stick", "3.28857638277", "F^(1) < 0 where P3 ends"),
    ],
)
def test_ends_are_enclosed(
    name: str, low: str, high: str, kind: str, value: str, inequality: str
) -> None:
    scene = load_scene(name)
    if kind == "grazing":
        start = low
    else:
        start = high
    found = certify(
        continue_orbit(scene.parameters.replace(Omega=start), "P32", "Omega", (low, high))
    )
    assert found.proven, found.message
    (end,) = [each for each in found.statement["ends"] if each["kind"] == kind]
    first, last = sorted((Fraction(end["inside"]), Fraction(end["outside"])))
    assert first <= Fraction(value) <= last
    assert last - first < Fraction(1, 10**9)
    assert end["inequality"] == inequality


CHANGES: tuple[dict[str, int], ...] = ({}, {"B0": 0}, {"k": 0}, {"B0": -3})


def grazes(
    parameters: Parameters, mapping: str, order: str, statement: dict[str, object], theta: float
) -> bool:
    """Return what a certificate states about a phase."""
    if statement["grazes"] != ON_AN_ARC:
        return statement["grazes"] != NO_PHASE
    low, high = (float(end["phase"][0]) for end in statement["ends"])  # type: ignore[attr-defined]
    return (theta - low) % 6.283185307179586 < high - low


@pytest.mark.parametrize("order", ["full", "paper"])
def test_windows_say_what_their_phases_do(order: str) -> None:
    rng = random.Random(order)
    kinds = set()
    for name, mapping, change in itertools.product(
        ("fig5", "fig7", "fig8", "fig9", "fig10"), ("P2", "P3", "P5", "P6"), CHANGES
    ):
        window = grazing_window(load_scene(name).parameters.replace(**change), mapping, order)
        proof = certify(window)
        assert (proof.kind, proof.proven) == ("window", True)
        kinds.add(proof.statement["grazes"])
        for _ in range(10):
            theta = rng.uniform(0, 6.28)
            assert bool(window.contains(theta)) is grazes(
                window.parameters, mapping, order, proof.statement, theta
            )
    assert kinds == {NO_PHASE, ALL_PHASES, ON_AN_ARC} | (
        {BUT_ONE_PHASE} if order == "paper" else set()
    )


def test_ends_are_exact() -> None:
    window = grazing_window(load_scene("fig9").parameters, "P2")
    ends = certify(window).statement["ends"]
    assert [end["sine"] for end in ends] == ["-1/12", "-1/12"]
    for end, value in zip(ends, window.ends[::1], strict=True):
        low, high = map(Fraction, end["phase"])
        assert high - low < Fraction(1, 10**22)
        turns = round((float(low) - value) / 6.283185307179586)
        assert abs(float(low) - value - turns * 6.283185307179586) < 1e-14


def test_the_two_orders_differ_at_a_touch_of_fourth_order() -> None:
    p = load_scene("fig8").parameters
    full, paper = (certify(grazing_window(p, "P3", order)).statement for order in ("full", "paper"))
    assert (full["grazes"], paper["grazes"]) == (ALL_PHASES, BUT_ONE_PHASE)
    assert paper["ends"][0]["sine"] == "1"
