"""What is wrong in a solution is called by its name: kinds of fault times scenes times samplings."""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fault_kinds import KINDS
from fault_matrix import is_named, judge, run, table, whole
from fault_scenes import cases

from symosc import crosscheck, load_scene, simulate
from symosc.crosschecks import diagnosis
from symosc.crosschecks.causes import CAUSES, Diagnosis
from symosc.crosschecks.clues import Clues, clue_samples

SEED = 1


@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "smoothed friction"])
def test_each_kind_of_fault_has_its_name(kind: str) -> None:
    name, sampling = ("fig8", "coarse") if kind == "double root" else ("fig10", "dense")
    case = next(case for case in cases() if case.scene.name == name)
    judged = judge(kind, case, sampling, SEED)
    assert judged is not None
    found, named, check, spoilt = judged
    assert found
    assert named, (spoilt.causes, check.diagnosis)
    assert is_named(check, spoilt, first_only=True)
    assert check.diagnosis[0].words
    assert check.diagnosis[0].evidence
    assert all(one.cause in CAUSES for one in check.diagnosis)


@pytest.mark.slow
def test_a_sample_of_the_matrix(capsys: pytest.CaptureFixture[str]) -> None:
    """One of every hundred or so; the whole is below."""
    counts = run(SEED, whole()[7::113])
    with capsys.disabled():
        print("\n" + table(counts))
    judge_counts(counts, 0.85)


@pytest.mark.campaign
def test_the_whole_matrix(capsys: pytest.CaptureFixture[str]) -> None:
    """Twenty kinds of fault, thirty scenes, four samplings."""
    assert len(whole()) == 20 * 30 * 4
    counts = run(SEED, whole())
    with capsys.disabled():
        print("\n" + table(counts))
    judge_counts(counts, 0.90)


def judge_counts(counts: Counter[tuple[str, str]], named: float) -> None:
    faults = counts["all", "faults"]
    assert faults > 0
    assert counts["all", "found"] >= 0.99 * faults
    assert counts["all", "named"] >= named * faults


def test_a_right_solution_has_no_diagnosis() -> None:
    t = np.linspace(0, 7, 100)
    x, v = simulate("fig5", t_end=7)(t)
    assert crosscheck("fig5", t, x, v).diagnosis == ()
    assert [one.cause for one in crosscheck("fig5", t, np.round(x, 6), np.round(v, 6)).diagnosis] == ["precision"]


@pytest.mark.slow
def test_what_is_not_known_says_so() -> None:
    """Two faults of different kinds at once: nothing explains most of the steps."""
    rng = np.random.default_rng(3)
    t = np.linspace(0, 7, 150)
    x, v = simulate("fig5", t_end=7)(t)
    x += np.cumsum(rng.uniform(0.0, 1e-3, len(t)))
    check = crosscheck("fig5", t, x, v)
    assert not check.ok
    assert {one.cause for one in check.diagnosis} & {"unknown", "noise", "truncation"}


def test_right_steps_from_another_start() -> None:
    scene = load_scene("fig9")
    t = np.linspace(float(scene.t0), 4, 60)
    x, v = simulate(scene, x0=scene.x0, v0=scene.v0, t_end=4)(t)
    check = crosscheck(scene, t, x + np.linspace(0.0, 3e-9, len(t)), v, global_tolerance=1e-10)
    assert not check.wrong_steps.size
    assert [one.cause for one in check.diagnosis] == ["start"]


@pytest.mark.parametrize("gap", [500.0, 2e3])
def test_steps_of_many_periods_tell_no_cause(gap: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each cause would be followed through all their events."""
    check = crosscheck("fig9", np.array([0.1324, gap]), np.array([4.5447, 1.0]), np.array([1.0, 1.0]))
    monkeypatch.setattr(Clues, "of", lambda _: pytest.fail("causes are tried"))
    assert [one.cause for one in check.diagnosis] == ["unknown"]


def test_causes_are_tried_until_one_explains_enough_and_those_as_good_are_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Made up: stages of causes with shares in eighths. The best one is named, with others as good, each name once."""
    rng, stages = random.Random(11), ("_simple", "_models", "_methods", "_sticks", "_delays", "_rest")
    for name, value in (("ENOUGH", 0.875), ("NAMED", 0.25), ("AS_GOOD", 0.125)):
        monkeypatch.setattr(diagnosis, name, value)
    answers = set()
    for _ in range(300):
        made = [
            [
                Diagnosis(
                    rng.choice(["noise", "drift", "sign"]), rng.choice("kc"), "", "", share=rng.randint(0, most) / 8
                )
                for _ in range(rng.randint(0, 2))
            ]
            for most in (rng.choice([1, 4, 8]) for _ in stages)
        ]
        ran: list[str] = []
        for name, causes in zip(stages, made, strict=True):

            def stage(*_: object, name: str = name, causes: list[Diagnosis] = causes, ran: list[str] = ran) -> Any:
                ran.append(name)
                return causes

            monkeypatch.setattr(diagnosis, name, stage)
        found = diagnosis._best(None, SimpleNamespace(first_wrong=None))  # type: ignore[arg-type]
        last = next((i for i in range(6) if any(one.share >= 0.875 for one in made[i])), 5)
        assert ran == list(stages[: last + 1])
        tried = sorted((one for causes in made[: last + 1] for one in causes), key=lambda one: -one.share)
        good = [one for one in tried if one.share >= 0.25 and one.share >= tried[0].share - 0.125]
        assert len(found) == 1
        if not good:
            assert (found[0].cause, found[0].share) == ("unknown", 0.0)
        else:
            names: dict[tuple[str, str], Diagnosis] = {}
            for one in good:
                names.setdefault((one.cause, one.subject if one.cause == "sign" else ""), one)
            assert [replace(found[0], alternatives=()), *found[0].alternatives] == list(names.values())
        answers.add((last < 5, len(found[0].alternatives), bool(good)))
    assert {(True, 0, True), (True, 1, True), (False, 0, True), (False, 0, False)} <= answers


@pytest.mark.parametrize("n", [2, 500, 3_001, 3_002, 9_000])
def test_the_samples_that_are_looked_at(n: int) -> None:
    """From shortly before the first wrong step, so many that can be followed, and as many as there are."""
    for first in (None, 0, 299, 300, 301, 2_000, n - 2):
        wrong = [] if first is None or first > n - 2 else [first]
        looked = np.arange(n)[clue_samples(SimpleNamespace(t=np.zeros(n), wrong_steps=wrong))]
        assert len(looked) == min(n, 3_001)
        if wrong:
            assert looked[0] == max(0, min(wrong[0] - 300, n - 3_001))
            assert looked[0] <= wrong[0] < looked[-1]
