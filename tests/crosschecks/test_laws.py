"""Cross-checks of oscillators with static friction, and of those with one belt.

Right solutions are never blamed, wrong ones are never right, whoever made them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
import pytest
from law_reference import REFERENCES
from random_laws import Problem, clear_problems, driven
from samples import sample_of
from solution_ways import blamed_solutions, even, off_by, scene_of, told
from stiction_solver import Mistakes, UnclearError, regularised, solved

from symosc import Belt, Oscillator, Scene, crosscheck, simulate

Rng = np.random.Generator
Start = tuple[float, float, float]
#: The chaotic scene S4: twins separate at the rate 0.0213.
CHAOS = Oscillator(
    m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="1.26")]
)
TOUCH = Oscillator(m=1, c=0, k=1, B0="3/2", Omega="1/2", belts=[Belt(1, mu="1/2", mu_s=1)])


def random_oscillator(rng: Rng) -> Oscillator:
    """Return an oscillator with one or two belts, most with static friction and a drive."""
    belts = []
    for n in range(int(rng.choice([1, 1, 2]))):
        mu = round(rng.uniform(0.05, 0.8), 2)
        more = 0.0 if rng.random() < 0.15 else round(rng.uniform(0.02, 0.8), 2)
        v = round(rng.uniform(-0.5, 0.8) + n * rng.uniform(0.9, 2.0), 3)
        belts.append(Belt(v, mu=mu, mu_s=round(mu + more, 2)))
    return driven(rng, belts)


def problems(seed: int) -> Iterator[Problem]:
    return clear_problems(seed, random_oscillator, (10.0, 40.0))


# -- right solutions -------------------------------------------------------------------------------


@pytest.mark.slow
@sample_of(10, 200)
def test_right_solutions_are_never_blamed(count: int) -> None:
    blamed = blamed_solutions(islice(problems(3), count))
    assert blamed == [], f"{len(blamed)} of {count}"


@pytest.mark.parametrize(
    "name", [r.name for r in REFERENCES if not any("curve" in b for b in r.belts)]
)
def test_exact_samples_of_reference_values_are_right(name: str) -> None:
    reference = next(r for r in REFERENCES if r.name == name)
    p = Oscillator(**reference.law, belts=[Belt(**belt) for belt in reference.belts])
    scene = Scene(name, p, *reference.start, reference.t_end)
    motion = simulate(scene)
    for count, digits in ((30, None), (300, None), (300, 9)):
        t = np.linspace(0.0, float(scene.t_end), count)
        x, v = motion(t)
        if digits:
            x, v = np.round([x, v], digits)
        check = crosscheck(scene, t, x, v)
        assert check.ok, f"{count} {digits}: {told(check)}"
        if name != "S3b-":  # its start is a double of another motion
            assert len(check.matched) == len(motion.events)


# -- chaos -----------------------------------------------------------------------------------------


def test_no_right_solution_of_a_chaotic_motion_is_blamed() -> None:
    t = np.linspace(0.0, 900.0, 9001)
    start = {"x0": "0.3", "v0": 0, "t_end": 900}
    own = simulate(CHAOS, **start)(t)
    twin = simulate(CHAOS, **start | {"x0": "0.3000001"})(t)
    scene = Scene("chaos", CHAOS, 0, "0.3", 0, 900)
    assert np.max(np.abs(own - twin)) > 0.01  # the two have moved apart
    check = crosscheck(scene, t, *twin)
    assert check.ok, check.summary()
    assert len(check.wrong_steps) == 0
    assert any("moves away" in note or "apart" in note for note in check.notes)
    assert check.compared_until < 900.0


def test_errors_that_add_up_are_no_chaos() -> None:
    """A damper that is wrong by a part of 1e3 makes no wrong step where samples are dense."""
    p = Oscillator(m=1, c="0.1", k=1, B0="0.2", Omega=2, belts=[Belt(-2, mu="0.1", mu_s="0.2")])
    wrong = p.replace(c="0.1001")
    t = np.linspace(0.0, 12.0, 120_001)
    scene = Scene("dense", p, 0, 1, 0, 12)
    check = crosscheck(scene, t, *simulate(wrong, x0=1, v0=0, t_end=12)(t))
    assert len(check.wrong_steps) == 0
    assert not check.ok


# -- wrong solutions -------------------------------------------------------------------------------

MISTAKES: dict[str, Callable[[Oscillator, Rng], Mistakes]] = {
    "mu_s = mu": lambda p, rng: Mistakes(kinetic_only=True),
    "Filippov": lambda p, rng: Mistakes(crosses=True),
    "late": lambda p, rng: Mistakes(delay=10.0 ** rng.uniform(-3, -1)),
    "mu_s too large": lambda p, rng: Mistakes(static=1.01),
    "mu_s too small": lambda p, rng: Mistakes(static=0.99),
    "short sticks": lambda p, rng: Mistakes(shortest=0.3),
    "blind": lambda p, rng: Mistakes(blind=1e-2),
}


def wrong_solutions(seed: int) -> Iterator[tuple[str, Scene, np.ndarray, float]]:
    """Yield wrong solutions, and by how many times what is allowed they are wrong."""
    kinds = [*MISTAKES, "tanh"]
    number = 0
    for p, start, t_end, right, rng in problems(seed):
        for _ in range(4):
            kind = kinds[number % len(kinds)]
            number += 1
            t = even(t_end, rng)
            if kind == "tanh":
                states = regularised(p, start, t, 10.0 ** rng.uniform(-3, -2))
            else:
                try:
                    solution = solved(p, start, t_end, MISTAKES[kind](p, rng))
                except UnclearError:
                    continue
                if rng.random() < 0.3:
                    t = solution.own_steps[0]
                    states = solution.own_steps[1:]
                    t, first = np.unique(t, return_index=True)
                    states = states[:, first]
                else:
                    states = solution(t)
            yield kind, scene_of(p, start, t_end), np.vstack([t, states]), off_by(right, t, states)


@pytest.mark.slow
@sample_of(10, 200)
def test_wrong_solutions_are_never_right(count: int) -> None:
    passed = []
    for kind, scene, samples, off in islice(
        (case for case in wrong_solutions(5) if case[3] > 10.0), count
    ):
        check = crosscheck(scene, *samples)
        if check.ok:
            passed.append(f"{kind}, {off:.3g} times what is allowed: {scene}\n{told(check)}")
    assert passed == [], f"{len(passed)} of {count}"


def test_a_graze_that_flew_on_is_wrong() -> None:
    """The exact motion touches the belt at 3 pi and sticks."""
    scene = Scene("touch", TOUCH, 0, "5/2", 0, 20)
    missed = simulate(TOUCH.replace(B0="1.499999999998"), x0="2.499999999996", v0=0, t_end=20)
    for count in (41, 401, 4001):
        t = np.linspace(0.0, 20.0, count)
        check = crosscheck(scene, t, *missed(t))
        assert not check.ok, count


def test_missing_static_friction_is_named() -> None:
    p = Oscillator(
        m=1, c="0.1", k=1, B0="0.3", Omega="2.1", belts=[Belt("0.1", mu="0.4", mu_s="0.7")]
    )
    t = np.linspace(0.0, 16.0, 400)
    wrong = simulate(p.replace(mu_s1="0.4"), x0=0, v0=0, t_end=16)(t)
    check = crosscheck(p, t, *wrong)
    assert not check.ok
    assert check.diagnosis[0].cause == "static friction"
    assert "mu_s = mu" in check.summary()
    assert check.first_wrong is not None
    assert check.first_wrong.expected == "belt1"


# -- one belt, and the rest of the interface -------------------------------------------------------


def test_one_belt_without_static_friction() -> None:
    p = Oscillator(m=1, c="0.1", k=1, B0="0.8", Omega="1.3", belts=[Belt("0.2", mu="0.4")])
    scene = Scene("one", p, 0, 1, 0, 30)
    t = np.linspace(0.0, 30.0, 500)
    x, v = simulate(scene)(t)
    assert crosscheck(scene, t, x, v).ok
    assert crosscheck(scene, t, x).ok
    v[200] += 1e-3
    check = crosscheck(scene, t, x, v)
    assert not check.ok
    assert check.wrong_steps.tolist() == [199, 200]


def test_two_coulomb_belts_are_judged_as_parameters() -> None:
    two = Oscillator(
        m=1, c=1, k=1, A0=-15, B0=10, Omega=1, FN=10, belts=[Belt(1, mu="0.8"), Belt(5, mu="0.6")]
    )
    t = np.linspace(0.0, 7.0, 200)
    x, v = simulate(two, t_end=7)(t)
    v[100] += 0.1
    assert crosscheck(two, t, x, v).as_dict() == crosscheck(two.parameters, t, x, v).as_dict()


def test_own_start_partial_summary_and_figures_with_one_belt() -> None:
    pytest.importorskip("matplotlib")
    from symosc import plot

    scene = Scene("touch", TOUCH, 0, "5/2", 0, 30)
    t = np.linspace(0.0, 12.0, 200)
    x, v = simulate(scene)(t)
    assert not crosscheck(scene, t, x, v).ok
    assert crosscheck(scene, t, x, v, partial=True).ok
    moved = simulate(TOUCH, x0=2, v0=0, t_end=30)
    t = np.linspace(0.0, 30.0, 200)
    assert not crosscheck(scene, t, *moved(t)).ok
    check = crosscheck(scene, t, *moved(t), own_start=True)
    assert check.ok
    assert check.summary().startswith("ok: 200 samples")
    assert len(plot.crosscheck_figure(check).axes) == 3
    assert len(plot.step_figure(check).axes) == 2
