"""Wrong solutions are called by the name of their fault."""

from __future__ import annotations

from collections import Counter
from itertools import islice
from typing import Any

import numpy as np
import pytest
from evidence import false_sentences
from excerpts import crosscheck
from fault_kinds import KINDS, finer
from fault_matrix import SEED, drawn, judge, run, table, whole
from fault_scenes import cases
from faulty_solver import METHODS, Flaw, Solver, softened, solved, without_events
from samples import sample_of

from symosc import load_scene, simulate
from symosc.crosschecks import steps
from symosc.crosschecks.causes import CAUSES, ENOUGH, Diagnosis, explained_share
from symosc.model import PARAMETER_NAMES

pytestmark = pytest.mark.compiled("doubles")  # a diagnosis follows thousands of steps

# -- diagnosis -------------------------------------------------------------------------------------


# Steps that are followed, and integrated, at most: measured by the test of the work.
MOST_FOLLOWED = 15_000
MOST_INTEGRATED = 600


#: LSODA takes minutes for the second one; the whole matrix, a campaign, has both.
SLOW_KINDS = ("smoothed friction", "friction that falls with speed")


@pytest.mark.full(5)
@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in SLOW_KINDS])
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
    assert all(diagnosis.cause in CAUSES for diagnosis in check.diagnosis)
    assert false_sentences(check) == []
    if kind == "double root":  # the micro stick of fig8
        assert "events are missed" in check.diagnosis[0].words
    if check.first_wrong:  # where it goes wrong first, and by how much
        assert f"first wrong step: {check.first_wrong.step}, " in check.summary()


@pytest.mark.campaign
def test_the_whole_matrix(capsys: pytest.CaptureFixture[str]) -> None:
    """All kinds of fault, thirty scenes, four samplings."""
    assert len(whole()) == len(KINDS) * 30 * 4
    counts = run(SEED, whole())
    with capsys.disabled():
        print("\n" + table(counts))
    judge_counts(counts)


@pytest.mark.campaign
def test_some_of_the_matrix(capsys: pytest.CaptureFixture[str]) -> None:
    counts = run(SEED, drawn(6, 7))
    with capsys.disabled():
        print("\n" + table(counts))
    judge_counts(counts)


def judge_counts(counts: Counter[tuple[str, str]]) -> None:
    for kinds in ("named kinds", "others"):
        faults = counts[kinds, "faults"]
        assert faults > 0
        assert counts[kinds, "found"] >= 0.99 * faults
        assert counts[kinds, "named"] >= 0.95 * faults
        assert counts[kinds, "false"] == 0


# -- causes on thin evidence -----------------------------------------------------------------------


def test_a_cause_explains_the_first_wrong_step_and_the_largest_one() -> None:
    before = np.array([0.5, 2e4, 0.5, 5e6, 3e4, 0.5])
    left = np.where(before > 1.0, 0.0, before)
    assert explained_share(before, left) == 1.0
    for step in (1, 3):  # the first, the largest
        few = left.copy()
        few[step] = 0.01 * before[step]
        assert explained_share(before, few) == 0.0
    few = left.copy()
    few[4] = before[4]
    assert explained_share(before, few) == pytest.approx(2 / 3)
    few[4] = np.nan  # not tried
    assert explained_share(before, few) == 1.0
    assert explained_share(before, np.full(6, 1.5)) == 0.0  # right steps become wrong


def test_one_of_many_wrong_steps_shows_no_cause() -> None:
    before = np.append(1e5, np.full(60, 1e4))
    assert explained_share(before, np.where(before > 5e4, 0.0, before)) < ENOUGH


def test_a_clock_that_jumps_is_no_friction() -> None:
    """Exact samples, whose times are late by 0.3 of a step from row 400 of 800 on."""
    t = np.linspace(0, 20, 800)
    x, v = simulate("fig5", t_end=20)(t)
    jump = 0.3 * (t[1] - t[0])
    check = crosscheck("fig5", t + jump * (np.arange(800) >= 400), x, v)
    (diagnosis,) = check.diagnosis
    assert diagnosis.cause == "time shift"
    assert diagnosis.value == pytest.approx(jump, rel=1e-5)
    assert f"after t = {t[399]:.10g}" in diagnosis.words
    assert "all 799 steps are right" in diagnosis.evidence


@pytest.mark.slow
@sample_of(4, 9)
def test_a_belt_ignored_in_flight_is_a_missed_event(count: int) -> None:
    possible = (judge("belt ignored", case, "dense", SEED) for case in cases())
    for judged in islice(filter(None, possible), count):
        (diagnosis,) = judged[2].diagnosis
        # A belt whose speed the motion does not reach is the same.
        assert diagnosis.cause == "late events" or "all 400 steps are right" in diagnosis.evidence
        assert "stick" not in diagnosis.words


@pytest.mark.slow
@pytest.mark.parametrize("count", [201, 60])
def test_a_stick_that_is_held_too_long_does_not_drift(count: int) -> None:
    """One stick of fig5 is 5 % too long, with v on the belt; from its end on the motion is
    exact.
    """
    motion = simulate("fig5", t_end=9)
    stick = next(part for part in motion.segments if part.mode == "belt1")
    begin = float(stick.t_start)
    slip = float(stick.t_end)
    end = slip + 0.05 * (slip - begin)
    speed = float(load_scene("fig5").parameters.v1)
    place = float(motion(slip)[0])
    after = simulate(
        load_scene("fig5").parameters, t0=end, x0=place + speed * (end - slip), v0=speed, t_end=9
    )
    t = np.linspace(0, 9, count)
    x, v = np.where(t < end, motion(np.minimum(t, slip)), after(np.maximum(t, end)))
    held = (t > slip) & (t < end)
    x[held] = place + speed * (t[held] - slip)
    check = crosscheck("fig5", t, x, v)
    (diagnosis,) = check.diagnosis
    assert (diagnosis.cause, diagnosis.subject) == ("late events", "stick")
    assert "drift" not in check.summary()


def test_late_velocities_at_times_in_single_precision_are_late_velocities() -> None:
    """No tiny shift of a time is near to what any step asks for."""
    (case,) = (case for case in cases() if case.scene.name == "fig8-exact")
    judged = judge("v a sample late", case, "coarse", 29292)
    assert judged is not None
    assert judged[1]


def test_smoothed_friction_and_a_sample_that_is_off_are_not_smoothed_friction_alone() -> None:
    name, t, x, v = softened("tanh", 0.05, "fig9", 8, 200)
    assert crosscheck(name, t, x, v).diagnosis[0].cause == "smoothed friction"
    v[150] += 1.0
    (diagnosis,) = crosscheck(name, t, x, v).diagnosis
    assert diagnosis.cause == "unknown"


@pytest.mark.full(1)
@pytest.mark.parametrize("name", ["fig5", "fig9"])
def test_weights_beyond_one_are_no_large_steps(name: str) -> None:
    """On coarse, even samples any linear method errs by one linear map; smaller steps do not help
    this one.
    """
    (case,) = (case for case in cases() if case.scene.name == name)
    for kind, cause in (("weights beyond one", "unknown"), ("fixed step", "steps too large")):
        judged = judge(kind, case, "coarse", 91)
        assert judged is not None
        assert judged[2].diagnosis[0].cause == cause


def test_a_velocity_at_times_between_samples_is_no_noise() -> None:
    """In long, uneven steps its errors look like noise; the positions alone are right."""
    (case,) = (case for case in cases() if case.scene.name == "random-15")
    judged = judge("v half a sample late", case, "random", 91)
    assert judged is not None
    assert judged[2].diagnosis[0].cause == "columns"


def test_times_in_single_precision_are_no_noise() -> None:
    (case,) = (case for case in cases() if case.scene.name == "random-14")
    judged = judge("times in single precision", case, "random", 91)
    assert judged is not None
    assert judged[2].diagnosis[0].cause != "noise"


#: Faults of the matrix whose cause was not told, or another one: kind, scene, sampling, cause and
#: seed, with what the diagnosis has to see.
HARD = [
    # The onset of a stick fits any delay: one step with one shows no cause.
    ("one stick held too long", "random-29", "coarse", "unknown", 4401),
    ("events by interpolation", "random-14", "random", "unknown", 4401),
    # Both times of a step are wrong, and the phase at its start.
    ("times in single precision", "random-14", "random", "columns", 4401),
    # Most steps are right with any faster belt.
    ("belt speed", "random-22", "coarse", "coefficient", 4401),
    # One short stick, in one step; without drift all ways to go on are alike.
    ("drift on the belt", "random-17", "random", "drift", 4401),
    # Long steps with much damping: a force acts less at their beginning.
    ("chatter", "random-16", "random", "steps too large", 4401),
    # The first wrong step is a flight that is off by 1.5 tolerances, events by 1e5.
    ("chatter", "random-17", "own steps", "late events", 4401),
    # Forty steps of the solver for one of the samples; sticks are inside steps.
    ("chatter", "random-18", "coarse", "late events", 4401),
    # All flights are wrong too.
    ("no events located", "fig6", "coarse", "chatter", 4401),
    # Short steps are right.
    ("fixed step", "random-26", "random", "steps too large", 4401),
    # A step with two events is longer than all flights.
    ("wrong weights", "random-28", "random", "steps too large", 4401),
    # A step may begin on the belt in a stick that began in the step before.
    ("stick left late", "fig8", "dense", "late events", 9173),
    # The drift makes the stick end just before the end of a step in which it would hold.
    ("drift on the belt", "fig10-orbit", "coarse", "drift", 9173),
    # Two velocities are wrong, not the column.
    ("late events", "random-15", "own steps", "late events", 9173),
    # Positions too far apart in time to be judged alone; Euler's method moves by differences too.
    ("v by differences", "random-27", "random", "columns", 9173),
    ("fixed step", "random-19", "dense", "steps too large", 9173),
    # One width, or a delay for each step; the defects are hardly larger than allowed.
    ("smoothed friction", "random-28", "coarse", "smoothed friction", 9173),
    # Many powers of steps that are nearly all equal imitate an error of the first power.
    ("weights beyond one", "fig10-orbit", "own steps", "unknown", 81811),
    ("fixed step", "fig10", "random", "steps too large", 5),
    # The first wrong step that is not tiny is none of the largest: it has to be tried too.
    ("leapfrog", "random-21", "own steps", "steps too large", 81811),
]


@pytest.mark.slow
@pytest.mark.full(4)
@pytest.mark.parametrize(("kind", "name", "sampling", "cause", "seed"), HARD)
def test_a_hard_fault_has_its_cause(
    kind: str, name: str, sampling: str, cause: str, seed: int
) -> None:
    (case,) = (case for case in cases() if case.scene.name == name)
    judged = judge(kind, case, sampling, seed)
    assert judged is not None
    assert judged[2].diagnosis[0].cause == cause
    assert judged[2].first_wrong is not None


def test_a_first_wrong_step_that_is_tiny_beside_the_largest_does_not_count() -> None:
    before = np.array([1.5, 0.5, 2e4, 0.5, 5e3])
    left = np.where(before > 1e3, 0.0, before)
    assert explained_share(before, left) == 1.0
    before[0] = 25.0  # more than a thousandth of the largest
    left[0] = 25.0
    assert explained_share(before, left) == 0.0


@pytest.mark.slow
def test_a_belt_that_is_too_fast_to_be_met_is_one_that_is_gone_over() -> None:
    """A solver that ignores the belt makes the same samples; no delay of 0 is spoken of."""
    (case,) = (case for case in cases() if case.scene.name == "fig7-corrected")
    judged = judge("belt speed", case, "coarse", 9173)
    assert judged is not None
    _, named, check, spoilt = judged
    assert spoilt.twin
    assert named
    assert "events are missed" in check.diagnosis[0].words


@pytest.mark.slow
def test_a_stick_left_too_early_by_little_is_one_left_too_late() -> None:
    """To second order in the time both programs do the same: no sample shows which one it was."""
    scene = load_scene("fig5")
    t = np.linspace(0, 4, 161)
    near, far = 1e-3, 0.2
    runs = {
        part: np.array(Solver(scene.parameters, Flaw(early=part)).run(t, 0.0, 0.0).arrays()[1:])
        for part in (near, -near, far, -far)
    }
    exact = np.array(simulate(scene, t_end=4)(t))
    allowed = 1e-8 * np.max(np.abs(exact), axis=1)
    assert np.all(np.max(np.abs(runs[near] - runs[-near]), axis=1) <= allowed)
    assert np.any(np.max(np.abs(runs[near] - exact), axis=1) > allowed)
    assert np.all(np.max(np.abs(runs[far] - runs[-far]), axis=1) > 1e5 * allowed)
    for part in (near, -near):
        (diagnosis,) = crosscheck(scene, t, *runs[part], partial=True).diagnosis
        assert (diagnosis.cause, diagnosis.subject) == ("late events", "stick")
        assert "too late or too early" in diagnosis.words
    assert (
        "sticks end too late" in crosscheck(scene, t, *runs[-far], partial=True).diagnosis[0].words
    )
    assert crosscheck(scene, t, *runs[far], partial=True).diagnosis[0].cause == "unknown"


def test_a_cause_explains_the_largest_defect_wherever_it_is() -> None:
    """Also far from the first wrong step, where causes are tried first."""
    scene = load_scene("fig5")
    grid = np.linspace(0, 40, 4001)
    x, v = Solver(scene.parameters, Flaw(late=True)).run(grid, 0.0, 0.0).arrays()[1:]
    assert crosscheck(scene, grid, x, v).diagnosis[0].cause == "late events"
    v[3900] += 1.0
    assert crosscheck(scene, grid, x, v).diagnosis[0].cause != "late events"


@pytest.mark.slow
@pytest.mark.parametrize("count", [501, 4001])
def test_a_diagnosis_has_a_bounded_amount_of_work(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where nothing explains the samples, so everything is tried: counted in steps, not in
    seconds.
    """
    import scipy.integrate

    followed = 0
    integrated = 0
    follow = steps._follow_samples
    odeint = scipy.integrate.odeint

    def counted(K: Any, samples: np.ndarray, *rest: Any) -> Any:
        nonlocal followed
        followed += samples.shape[1] - 1
        return follow(K, samples, *rest)

    def counting(*given: Any, **more: Any) -> Any:
        nonlocal integrated
        integrated += 1
        return odeint(*given, **more)

    t = np.linspace(0, 40, count)
    x, v = simulate("fig5")(t)
    x = x + np.cumsum(np.random.default_rng(1).standard_normal(count)) * 1e-3
    check = crosscheck("fig5", t, x, v)
    monkeypatch.setattr(steps, "_follow_samples", counted)
    monkeypatch.setattr(scipy.integrate, "odeint", counting)
    assert check.diagnosis[0].cause == "unknown"
    assert 0 < followed < MOST_FOLLOWED
    assert 0 < integrated < MOST_INTEGRATED


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
        f"{diagnosis.cause} {diagnosis.words}"
        for first in judged[2].diagnosis
        for diagnosis in (first, *first.alternatives)
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
        assert "coefficient" not in {diagnosis.cause for diagnosis in (first, *first.alternatives)}


def leapfrogged(p: Any, t: np.ndarray, n: int = 1) -> tuple[np.ndarray, ...]:
    return tuple(
        column[::n]
        for column in without_events(p, finer(t, n), 4.5447, 1.0, METHODS["leapfrog"])[1:]
    )


def test_a_right_solution_has_no_diagnosis() -> None:
    t = np.linspace(0, 7, 100)
    x, v = simulate("fig5", t_end=7)(t)
    assert crosscheck("fig5", t, x, v).diagnosis == ()
    assert [
        diagnosis.cause
        for diagnosis in crosscheck("fig5", t, np.round(x, 6), np.round(v, 6)).diagnosis
    ] == ["precision"]


def test_right_steps_from_another_start() -> None:
    scene = load_scene("fig9")
    t = np.linspace(float(scene.t0), 4, 60)
    x, v = simulate(scene, x0=scene.x0, v0=scene.v0, t_end=4)(t)
    check = crosscheck(scene, t, x + np.linspace(0.0, 3e-9, len(t)), v, global_tolerance=1e-10)
    assert not check.wrong_steps.size
    assert [diagnosis.cause for diagnosis in check.diagnosis] == ["start"]


# -- data clues ------------------------------------------------------------------------------------


# -- other models ----------------------------------------------------------------------------------


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
    named = [
        diagnosis for diagnosis in diagnosed(scene, **{name: value}) if diagnosis.subject == name
    ]
    assert [diagnosis.cause for diagnosis in named] == ["coefficient"]
    assert named[0].share > 0.9
    assert named[0].value is not None
    assert named[0].error is not None
    assert named[0].value == pytest.approx(value, abs=max(6.0 * named[0].error, 1e-7 * abs(value)))
    assert named[0].error < 1e-3 * abs(value)


# -- numbers of the faults -------------------------------------------------------------------------


MEASURED: dict[str, tuple[Any, str, str | None, float | None, float]] = {
    "static friction": (
        lambda: solved(Flaw(static=1.3), t_end=9.4588, count=151),
        "late events",
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
@pytest.mark.full(4)
@pytest.mark.parametrize("what", MEASURED)
def test_the_number_of_a_fault_is_measured(what: str) -> None:
    make, cause, subject, value, part = MEASURED[what]
    name, t, x, v = make()
    first = crosscheck(name, t, x, v).diagnosis[0]
    assert first.cause == cause
    assert subject in (None, first.subject)
    if value is not None:
        assert first.value == pytest.approx(value, rel=part)
