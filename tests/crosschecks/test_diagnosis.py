"""Wrong solutions are called by the name of their fault."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
from evidence import false_sentences
from excerpts import crosscheck
from fault_kinds import KINDS, finer
from fault_matrix import judge, run, table, whole
from fault_scenes import cases
from faulty_solver import METHODS, Flaw, softened, solved, without_events

from symosc import load_scene, simulate
from symosc.crosschecks.causes import CAUSES, Diagnosis
from symosc.model import PARAMETER_NAMES

pytestmark = pytest.mark.compiled("doubles")  # a diagnosis follows thousands of steps

# -- diagnosis ---------------------------------------------------------------------------------------------------------


SEED = 1


@pytest.mark.full(8)
@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "smoothed friction"])
def test_each_kind_of_fault_has_its_name(kind: str) -> None:
    """In the first scene that can have it; what is said of a change is tried."""
    if kind == "double root":
        sampling = "coarse"
    else:
        sampling = "dense"
    if kind == "double root":
        first = "fig8"
    else:
        first = "fig10"
    order = sorted(
        cases(), key=lambda case: (case.scene.name != first, case.scene.name.startswith("fig"))
    )
    judged = next(
        found for case in order if (found := judge(kind, case, sampling, SEED)) is not None
    )
    found, named, check, spoilt = judged
    assert found
    assert named, (spoilt.causes, check.diagnosis)
    assert check.diagnosis[0].words
    assert check.diagnosis[0].evidence
    assert all(one.cause in CAUSES for one in check.diagnosis)
    assert false_sentences(check) == []
    if kind == "double root":  # the micro stick of fig8
        begin, end = (event.t for event in simulate("fig8", t_end=4).events)
        assert f"the first time at t = {begin:.8g} to {end:.8g}; " in check.diagnosis[0].evidence


@pytest.mark.campaign
def test_the_whole_matrix(capsys: pytest.CaptureFixture[str]) -> None:
    """43 kinds of fault, thirty scenes, four samplings."""
    assert len(whole()) == 43 * 30 * 4
    counts = run(SEED, whole())
    with capsys.disabled():
        print("\n" + table(counts))
    judge_counts(counts, 0.95)


def judge_counts(counts: Counter[tuple[str, str]], named: float) -> None:
    faults = counts["all", "faults"]
    assert faults > 0
    assert counts["all", "found"] >= 0.99 * faults
    assert counts["all", "named"] >= named * faults
    assert counts["all", "false"] == 0


@pytest.mark.slow
@pytest.mark.full(2)
@pytest.mark.parametrize(
    "kind",
    ["chatter", "late events", "no events located", "leapfrog", "smoothed friction", "noise"],
)
def test_no_stick_is_named_where_there_is_none(kind: str) -> None:
    """The motion of fig9 crosses its belts and never sticks."""
    (case,) = (case for case in cases() if case.scene.name == "fig9")
    assert not any(part.mode.startswith("belt") for part in case.exact.segments)
    judged = judge(kind, case, "dense", SEED)
    assert judged is not None
    said = " ".join(
        f"{one.cause} {one.words}"
        for first in judged[2].diagnosis
        for one in (first, *first.alternatives)
    )
    assert "stick" not in said
    assert "chatter" not in said


@pytest.mark.slow
def test_a_fitted_number_explains_the_defects_or_is_not_named() -> None:
    """A mass that never moves is not heavy, and the error of a method is no coefficient."""
    scene = load_scene("fig9")
    p = scene.parameters
    t = np.linspace(float(scene.t0), 8, 401)
    for x, v in ((np.full(401, 1.0), np.zeros(401)), leapfrogged(p, t), leapfrogged(p, t, 7)):
        first = crosscheck(p, t, x, v).diagnosis[0]
        assert "coefficient" not in {one.cause for one in (first, *first.alternatives)}


def leapfrogged(p: Any, t: np.ndarray, n: int = 1) -> tuple[np.ndarray, ...]:
    return tuple(
        column[::n]
        for column in without_events(p, finer(t, n), 4.5447, 1.0, METHODS["leapfrog"])[1:]
    )


@pytest.mark.slow
def test_weights_that_the_steps_do_not_determine_are_not_named() -> None:
    """Of rounded flights with another B0: weights such as 84, 40, -207, 84 repeated all of them."""
    scene = load_scene("fig10")
    p = scene.parameters.replace(
        m="1.86",
        c=0,
        k="3.9",
        A0="-0.9",
        B0=10,
        Omega="4.32",
        v1="-2.31",
        v2="4.99",
        mu1="0.32",
        mu2="0.48",
        FN="14.75",
    )
    t = np.linspace(3, 7.21, 301)
    x, v = np.round(simulate(p.replace(B0="9.8"), t0=3, x0="1.579", v0="-2.31", t_end=8)(t), 3)
    assert not any("weights" in one.words for one in crosscheck(p, t, x, v).diagnosis)


def test_a_right_solution_has_no_diagnosis() -> None:
    t = np.linspace(0, 7, 100)
    x, v = simulate("fig5", t_end=7)(t)
    assert crosscheck("fig5", t, x, v).diagnosis == ()
    assert [
        one.cause for one in crosscheck("fig5", t, np.round(x, 6), np.round(v, 6)).diagnosis
    ] == ["precision"]


def test_right_steps_from_another_start() -> None:
    scene = load_scene("fig9")
    t = np.linspace(float(scene.t0), 4, 60)
    x, v = simulate(scene, x0=scene.x0, v0=scene.v0, t_end=4)(t)
    check = crosscheck(scene, t, x + np.linspace(0.0, 3e-9, len(t)), v, global_tolerance=1e-10)
    assert not check.wrong_steps.size
    assert [one.cause for one in check.diagnosis] == ["start"]


# -- data clues --------------------------------------------------------------------------------------------------------


# -- other models ------------------------------------------------------------------------------------------------------


OTHER_MODELS_T = np.linspace(0.5, 12, 240)


def diagnosed(name: str, **changes: float) -> tuple[Diagnosis, ...]:
    """Return what is said of the motion of other parameters."""
    scene = load_scene(name)
    p = scene.parameters.replace(**changes)
    x, v = simulate(p, t0=0.5, x0=scene.x0, v0=scene.v0, t_end=12)(OTHER_MODELS_T)
    first = crosscheck(scene.parameters, OTHER_MODELS_T, x, v).diagnosis[0]
    return first, *first.alternatives


@pytest.mark.slow
@pytest.mark.full(4)
@pytest.mark.parametrize("name", PARAMETER_NAMES)
def test_a_wrong_coefficient_is_estimated(name: str) -> None:
    rng = np.random.default_rng([ord(letter) for letter in name])
    # where that belt is met
    if name == "v1":
        scene = "fig5"
    else:
        scene = "fig10"
    right = float(getattr(load_scene(scene).parameters, name))
    value = round(right * (1.0 + float(rng.choice([-1, 1])) * rng.uniform(0.01, 0.1)), 6)
    found = [one for one in diagnosed(scene, **{name: value}) if one.subject == name]
    assert [one.cause for one in found] == ["coefficient"]
    assert found[0].share > 0.9
    assert found[0].value is not None
    assert found[0].error is not None
    assert found[0].value == pytest.approx(value, abs=max(6.0 * found[0].error, 1e-7 * abs(value)))
    assert found[0].error < 1e-3 * abs(value)


# -- numbers of the faults ---------------------------------------------------------------------------------------------


MEASURED: dict[str, tuple[Any, str, str | None, float | None, float]] = {
    "static friction": (
        lambda: solved(Flaw(static=1.3), t_end=9.4588, count=151),
        "stick left late",
        None,
        1.3,
        1e-6,
    ),
    "drift": (
        lambda: solved(Flaw(drift=-2e-3), t_end=9.4588, count=151),
        "drift",
        None,
        -2e-3,
        1e-3,
    ),
    "drift in steps": (
        lambda: solved(Flaw(drift=-2e-3), "fig5", 9, 11, 60),
        "drift",
        None,
        -2e-3,
        1e-6,
    ),
    "drift in 3 steps": (
        lambda: solved(Flaw(drift=-2e-3), "fig10", 9.4588, 16, 40),
        "drift",
        None,
        -2e-3,
        1e-6,
    ),
    "tanh, narrow": (
        lambda: softened("tanh", 0.01, "fig5", 8, 400),
        "smoothed friction",
        "tanh",
        0.01,
        0.05,
    ),
    "tanh, narrowest": (
        lambda: softened("tanh", 1e-3, "fig5", 8, 400),
        "smoothed friction",
        "tanh",
        1e-3,
        1e-5,
    ),
    "arctan, wide": (
        lambda: softened("arctan", 7.2, "fig9", 8.1324, 60),
        "smoothed friction",
        "arctan",
        7.2,
        1e-3,
    ),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("what", MEASURED)
def test_the_number_of_a_fault_is_measured(what: str) -> None:
    make, cause, subject, value, part = MEASURED[what]
    name, t, x, v = make()
    first = crosscheck(name, t, x, v).diagnosis[0]
    assert first.cause == cause
    assert subject in (None, first.subject)
    if value is not None:
        assert first.value == pytest.approx(value, rel=part)
