"""Small campaigns of the fuzzer, and checks of what the fuzzer itself takes for true.

Larger ones: python tests/support/fuzz.py --scenes 2000 --seed 1
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import fuzz
import mpmath
import pytest
import scene_families as plain
import touching_families as touching
from fast_oracle import program, simulate_fast
from oracle import OracleRun, flow_oracle, simulate_oracle
from samples import few
from verdicts import Verdict, compare, label, truth_of

from symosc import simulate

#: Half of the scenes are followed by compiled loops too, and some need pairs for thousands of events.
pytestmark = pytest.mark.compiled("pairs")

QUICK = 2  # scenes of each family, and more of those that touch a belt, or nearly
TOUCHING = ("graze", "near", "approach", "limit", "creep", "settle", "aimed", "shallow", "undriven")
SLOW = 60
PARTS = {"graze": Fraction(1, 6), "long": Fraction(1, 12), "undriven": Fraction(1, 2)}


@pytest.mark.quick(4)
@pytest.mark.parametrize("number", few(range(QUICK), 0))  # of even number: compiled
@pytest.mark.parametrize("family", fuzz.FAMILIES)
def test_random_scenes_of_every_family(family: str, number: int) -> None:
    assert_no_faults(family, range(number, number + 1), PARTS.get(family, Fraction(1)))


@pytest.mark.slow
@pytest.mark.parametrize("family", TOUCHING)
def test_more_scenes_that_touch(family: str) -> None:
    """Of number 5 with 20 digits too; more of them are a campaign."""
    assert_no_faults(family, range(QUICK, 7), PARTS.get(family, Fraction(1)))


@pytest.mark.parametrize("task", [("aimed", 112643, 120), ("shallow", 1, 163), ("shallow", 3, 382)])
def test_touches_that_a_rounded_phase_hides(task: tuple[str, int, int]) -> None:
    """The phase of t0, rounded to a double, makes the force at launch so wrong that the belt seems out of reach."""
    family, seed, number = task
    assert_no_faults(family, range(number, number + 1), seed=seed)


@pytest.mark.parametrize("task", [("digits", 20281, 7), ("long", 112642, 1)])
def test_errors_are_as_large_as_said(task: tuple[str, int, int]) -> None:
    """A flight of 5e-4 near x = 0, whose last step is as long.

    1,747 time units, in which phases are rounded anew.
    """
    family, seed, number = task
    assert_no_faults(family, range(number, number + 1), seed=seed)


@pytest.mark.campaign
@pytest.mark.parametrize("family", fuzz.FAMILIES)
def test_many_random_scenes_of_every_family(family: str) -> None:
    assert_no_faults(family, range(QUICK, SLOW))


def assert_no_faults(
    family: str, numbers: range, part: Fraction = Fraction(1), seed: int = 1000
) -> None:
    failed = []
    for number in numbers:
        verdict = fuzz.verdict_of((family, seed, number), part)
        verdict.faults = [
            fault for fault in verdict.faults if fault[0] != "slow"
        ]  # a matter of the machine
        if verdict.faults:
            failed += [verdict]
        else:
            failed += []
    assert not failed, "\n".join(fuzz.report(verdict, seed) for verdict in failed)


# -- the truth of the constructed families ----------------------------------------------------------------------------


@pytest.mark.quick(2)
@pytest.mark.parametrize("number", range(6))
def test_exact_grazes_solve_the_equation(number: int) -> None:
    """The matrix exponential of the equation, from the scene's start, touches where the closed form says."""
    scene = fuzz.scene_of("graze", 77, number)
    truth = scene.truth()
    assert truth.events
    for event in (truth.events[0], truth.events[-1]):
        x, v, a = flow(scene, truth, to_fraction(event.t), 50)
        assert abs(x - event.x) < 1e-40 * max(1, abs(event.x))
        assert abs(v - event.v) < 1e-40 * max(1, abs(event.v))
        assert abs(a) < 1e-40 * float(1 + abs(scene.p.B0 / scene.p.m))


@pytest.mark.full(2)
@pytest.mark.quick(1)
@pytest.mark.parametrize("numbers", few([range(2), range(2, 6)], range(2, 6)))
@pytest.mark.parametrize("family", ["settle", "approach"])
def test_approaches_stay_between_the_belts(family: str, numbers: range) -> None:
    for number in numbers:
        scene = fuzz.scene_of(family, 77, number)
        truth = scene.truth()
        walls = {
            "Omega1": (-1e99, scene.p.v1),
            "Omega2": (scene.p.v1, scene.p.v2),
            "Omega3": (scene.p.v2, 1e99),
        }
        low, high = map(Fraction, walls[truth.mode])
        for part in (Fraction(1, 50), Fraction(1, 3)):
            v = flow(scene, truth, scene.t_end * part, 200)[1]
            with mpmath.workdps(200):
                assert touching.number(low) < v < touching.number(high)


def flow(scene: plain.FuzzScene, truth: OracleRun, t: Fraction, dps: int) -> tuple:
    return flow_oracle(
        scene.p, int(truth.mode[-1]), scene.t0, scene.x0, scene.v0, t - scene.t0, dps
    )


def to_fraction(value: mpmath.mpf) -> Fraction:
    return Fraction(mpmath.nstr(value, 55))


def test_exact_grazes_are_what_the_oracle_finds() -> None:
    for number in range(6):
        scene = fuzz.scene_of("graze", 78, number)
        scene = plain.with_digits(
            scene, t_end=min(scene.t_end, scene.t0 + touching.periods(scene.p, 5.5))
        )
        events = [
            event for event in scene.truth().events if event.t <= touching.number(scene.t_end)
        ]
        run = simulate_oracle(scene.p, scene.t0, scene.x0, scene.v0, scene.t_end, 40)
        assert [label(event) for event in run.events] == [label(event) for event in events]
        assert all(
            abs(first.t - second.t) < 1e-25
            for first, second in zip(run.events, events, strict=True)
        )


@pytest.mark.quick(1)
@pytest.mark.skipif(program() is None, reason="needs g++ with quadruple precision")
@pytest.mark.parametrize(
    "family", few(["wide", "coincide", "late", "rest", "near"], "coincide", "late")
)
def test_both_oracles_agree(family: str) -> None:
    for number in range(4):
        scene = plain.with_digits(fuzz.scene_of(family, 79, number), dps=33)
        exact = truth_of(scene, simulate_oracle)
        fast = truth_of(scene, simulate_fast)
        assert [label(event) for event in exact.events] == [label(event) for event in fast.events]
        for first, second in zip(exact.events, fast.events, strict=True):
            assert abs(first.t - second.t) < 1e-20 * max(1, abs(first.t))
            assert abs(first.x - second.x) < 1e-20 * max(1, abs(first.x))


# -- the judge sees what is wrong -------------------------------------------------------------------------------------


class Answer:
    """A trajectory that somebody reports."""

    def __init__(self, events: list, status: str = "t_end") -> None:
        self.events, self.status, self.message, self.t_end = events, status, "", 0


@pytest.mark.slow
def test_the_judge_names_each_fault() -> None:
    scene = fuzz.scene_of("wide", 1, 0)
    truth = truth_of(scene)
    trajectory = simulate(scene.p, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end)
    events = list(trajectory.events)
    assert len(events) > 4

    def faults(changed: list, status: str = "t_end") -> set[str]:
        verdict = Verdict(scene)
        compare(verdict, Answer(changed, status), truth, simulate_oracle)
        return {fault for fault, _ in verdict.faults} - {"estimate"}

    late = replace(events[2], t=events[2].t * (1 + 1e-4))
    assert faults(events) == set()
    assert faults(events[:-1]) == {"missed"}
    assert faults(events[:2] + events[3:]) == {"missed"}
    assert faults([*events, replace(events[-1], t=events[-1].t + 0.1)]) == {"invented"}
    assert faults([*events[:2], events[1], *events[2:]]) == {"invented"}
    assert faults([*events[:2], replace(events[2], kind="graze"), *events[3:]]) == {"wrong kind"}
    assert faults([*events[:2], late, *events[3:]]) != set()
    assert faults(events[:3], "undecidable") == {"undecidable"}
    shifted = replace(events[2], t=events[2].t + 1e-10)
    verdict = Verdict(scene)
    compare(verdict, Answer([*events[:2], shifted, *events[3:]]), truth, simulate_oracle)
    assert {fault for fault, _ in verdict.faults} == {"estimate"}
