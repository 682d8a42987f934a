"""What is wrong in a solution is called by its name: kinds of fault times scenes times samplings."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from fault_kinds import KINDS
from fault_matrix import is_named, judge, run, table, whole
from fault_scenes import cases

from symosc import crosscheck, load_scene, simulate
from symosc.crosschecks.causes import CAUSES
from symosc.crosschecks.clues import Clues

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
