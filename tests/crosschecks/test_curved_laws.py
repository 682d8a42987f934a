"""Cross-checks of laws with friction curves and of laws with more than two belts.

Right solutions are never blamed, wrong ones are never right, and no wrong cause is named.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import islice
from math import cos, exp, tanh
from typing import Any

import law_families
import numpy as np
import pytest
from cli_runs import run
from random_laws import Problem, clear_problems, driven
from samples import sample_of
from scipy.integrate import solve_ivp
from solution_ways import blamed_solutions, even, off_by, scene_of, told
from stiction_solver import Mistakes, UnclearError, regularised, solved

from symosc import Belt, Oscillator, Scene, crosscheck, simulate
from symosc.scenes import as_toml

Rng = np.random.Generator
Start = tuple[float, float, float]
#: A mass on a spring, pulled by a belt with falling friction: stick-slip.
FALLING = Oscillator(
    m=1, c="0.05", k=1, B0="0.4", Omega="1.3",
    belts=[Belt("0.5", curve=[(0, "0.4"), ("0.3", "0.25"), ("1.5", "0.2")], mu_s="0.5")],
)  # fmt: skip
START = {"x0": 0, "v0": 0, "t_end": 40}
SCENE = Scene("falling", FALLING, 0, 0, 0, 40)
THREE = Oscillator(
    m=1, c="0.1", k=1, B0=3, Omega="1.3",
    belts=[Belt(-1, mu="0.3"), Belt(0, mu="0.2", mu_s="0.4"), Belt(1, mu="0.4", mu_s="0.6")],
)  # fmt: skip


def stribeck(w: float) -> float:
    return 0.2 + 0.2 * exp(-w / 0.3) + 0.02 * w


# -- random laws -----------------------------------------------------------------------------------


def random_curve(rng: Rng, mu: float) -> list[tuple[float, float]]:
    """Return points of a curve that mostly falls."""
    points = [(0.0, mu)]
    for _ in range(int(rng.integers(1, 6))):
        w, value = points[-1]
        points.append(
            (round(w + rng.uniform(0.05, 0.6), 3), round(value * rng.uniform(0.5, 1.2), 3))
        )
    return points


def random_oscillator(rng: Rng) -> Oscillator:
    """Return an oscillator with one to three belts, most with a curve and with static friction."""
    belts = []
    count = int(rng.choice([1, 1, 2, 3]))
    for n in range(count):
        mu = round(rng.uniform(0.05, 0.8), 2)
        more = 0.0 if rng.random() < 0.3 else round(rng.uniform(0.02, 0.6), 2)
        v = round(rng.uniform(-0.5, 0.8) + n * rng.uniform(0.9, 1.5) - (count == 3), 3)
        if rng.random() < 0.8:
            slope = 0 if rng.random() < 0.5 else round(rng.uniform(0, 0.3), 2)
            curve = random_curve(rng, mu)
            belts.append(Belt(v, curve=curve, slope=slope, mu_s=round(mu + more, 2)))
        else:
            belts.append(Belt(v, mu=mu, mu_s=round(mu + more, 2)))
    return driven(rng, belts)


def beyond_plain_laws(rng: Rng) -> Oscillator:
    """Return a random oscillator that has a curve or three belts."""
    while True:
        p = random_oscillator(rng)
        if len(p.belts) == 3 or any(belt.curve for belt in p.belts):
            return p


def problems(seed: int) -> Iterator[Problem]:
    return clear_problems(seed, beyond_plain_laws, (8.0, 25.0))


# -- right solutions -------------------------------------------------------------------------------


@pytest.mark.slow
@sample_of(16, 200)
def test_right_solutions_are_never_blamed(count: int) -> None:
    blamed = blamed_solutions(islice(problems(7), count))
    assert blamed == [], f"{len(blamed)} of {count}"


@pytest.mark.slow
@sample_of(8, 200)
def test_exact_motions_of_random_laws_are_right(count: int) -> None:
    blamed = []
    for number in range(count):
        family = ("curved", "cornered", "plain")[number % 3]
        made = law_families.scene_of(family, 11, number, 4)
        names = (*law_families.NUMBERS,)
        belts = [
            Belt(b.v, curve=b.curve, slope=b.slope, mu_s=b.mu_s)
            if b.curve
            else Belt(b.v, b.mu, mu_s=b.mu_s)
            for b in made.belts
        ]
        p = Oscillator(**{name: getattr(made, name) for name in names}, belts=belts)
        scene = Scene("random", p, made.t0, made.x0, made.v0, made.t_end)
        motion = simulate(scene, max_events=200)
        rng = np.random.default_rng(number)
        times = np.linspace(float(motion.t_start), float(motion.t_end), int(rng.integers(20, 400)))
        check = crosscheck(scene, times, *motion(times), partial=True)
        if not check.ok:
            blamed.append(f"{made.snippet()}\n{told(check)}")
    assert blamed == [], f"{len(blamed)} of {count}"


@pytest.mark.parametrize(("rtol", "tolerance"), [(1e-10, 1e-8), (1e-6, 1e-4)])
def test_stribeck_by_events_of_scipy(rtol: float, tolerance: float) -> None:
    """Somebody's own solver of a smooth law, beside a law of many pieces."""
    belt = Belt.from_function("0.8", stribeck, until=3, pieces=240, mu_s=stribeck(0))
    p = Oscillator(m=1, c="0.3", k=1, B0="0.2", Omega="1.3", belts=[belt])

    def slopes(t: float, y: Any) -> tuple[float, float]:
        x, v = y
        return v, 0.2 * cos(1.3 * t) - 0.3 * v - x + stribeck(0.8 - v)

    path = solve_ivp(
        slopes, (0, 12), (0, 0), "DOP853", rtol=rtol, atol=rtol * 0.1, dense_output=True
    )
    assert np.max(path.y[1]) < 0.8  # it never meets the belt
    t = np.linspace(0, 12, 300)
    check = crosscheck(p, t, *path.sol(t), tolerance=max(tolerance, 1e-5))
    assert check.ok, check.summary()
    assert any("241 points" in note for note in check.notes)


def test_a_note_says_how_far_the_law_is_off_a_function() -> None:
    belt = Belt.from_function("0.8", stribeck, until=3, pieces=40)
    p = Oscillator(m=1, c="0.3", k=1, belts=[belt])
    t = np.linspace(0, 3, 50)
    (note,) = crosscheck(p, t, *simulate(p, t_end=3)(t)).notes
    said = re.search(r"off by up to about (\S+) in mu", note)
    assert said is not None
    w = np.linspace(0, 3, 20_001)
    points, values = np.array(belt.curve, dtype=float).T
    off = np.max(np.abs(np.interp(w, points, values) - [stribeck(speed) for speed in w]))
    assert 0.5 * off < float(said[1]) < 2.0 * off


def test_small_steps_of_a_regularised_belt_are_right_at_its_tolerance() -> None:
    """RK4 with tanh((v - v_belt)/1e-4) in place of the sign."""
    p = FALLING.replace(mu_s1="0.4")
    width = 1e-4
    h = 2e-4

    def push(t: float, x: float, v: float) -> float:
        w = abs(v - 0.5)
        if w < 0.3:
            mu = 0.4 - 0.5 * w
        elif w < 1.5:
            mu = 0.25 - (w - 0.3) / 24
        else:
            mu = 0.2
        return 0.4 * cos(1.3 * t) - 0.05 * v - x - mu * tanh((v - 0.5) / width)

    rows = [(0.0, 0.0, 0.0)]
    t = x = v = 0.0
    for number in range(1, 40_001):
        a1 = push(t, x, v)
        a2 = push(t + h / 2, x + h / 2 * v, v + h / 2 * a1)
        a3 = push(t + h / 2, x + h / 2 * (v + h / 2 * a1), v + h / 2 * a2)
        a4 = push(t + h, x + h * (v + h / 2 * a2), v + h * a3)
        x += h * (v + h / 6 * (a1 + a2 + a3))
        v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        t = number * h
        if number % 100 == 0:
            rows.append((t, x, v))
    check = crosscheck(p, *np.array(rows).T, tolerance=1e-3)
    assert check.ok, check.summary()
    assert check.matched


def test_three_belts_have_events_at_each() -> None:
    scene = Scene("three", THREE, 0, 0, 0, 40)
    motion = simulate(scene)
    for count in (41, 600):
        t = np.linspace(0, 40, count)
        check = crosscheck(scene, t, *motion(t))
        assert check.ok, check.summary()
        assert {match.event.boundary for match in check.matched} == {1, 2, 3}
        assert len(check.matched) == len(motion.events)
    x, v = motion(t)
    v[300] += 1e-3
    check = crosscheck(scene, t, x, v)
    assert check.wrong_steps.tolist() == [299, 300]
    listed = [(float(event.t), event.kind) for event in motion.events]
    assert crosscheck(scene, t, *motion(t), events=listed).ok
    assert not crosscheck(scene, t, *motion(t), events=listed[1:]).ok


@pytest.mark.parametrize("p", [FALLING, THREE], ids=["curve", "three belts"])
def test_faults_of_columns_are_named(p: Oscillator) -> None:
    t = np.linspace(0, 20, 400)
    x, v = simulate(p, t_end=20)(t)
    assert crosscheck(p, t, x).ok
    faults = {"sign": -v, "columns": np.gradient(x, t)}
    for cause, column in faults.items():
        named = crosscheck(p, t, x, column).diagnosis[0]
        assert (named.cause, named.subject) == (cause, "v")


def test_the_command_judges_three_belts(tmp_path: Any) -> None:
    scene = tmp_path / "three.toml"
    scene.write_text(as_toml(Scene("three", THREE, 0, 0, 0, 10)) + "\n", encoding="utf-8")
    t = np.linspace(0, 10, 200)
    x, v = simulate(THREE, t_end=10)(t)
    samples = tmp_path / "run.csv"
    for wrong, code in ((0.0, 0), (1e-3, 1)):
        rows = np.column_stack([t, x, v + wrong * (t > 5)])
        np.savetxt(samples, rows, "%.17g", ",", header="t,x,v", comments="")
        ended = run("check", str(scene), str(samples))
        assert ended.exit_code == code, ended.stdout + ended.stderr


# -- wrong solutions -------------------------------------------------------------------------------


def with_curves(p: Oscillator, change: Callable[[Any], Any]) -> Oscillator:
    """Return an oscillator with other curves; static friction stays."""
    belts = []
    for belt in p.belts:
        if belt.curve:
            curve = change(belt.curve)
            belts.append(Belt(belt.v, curve=curve, slope=belt.slope, mu_s=belt.mu_s))
        else:
            belts.append(belt)
    return p.replace(belts=belts)


def steeper(curve: Any) -> Any:
    (_, first), *_ = curve
    return [(w, first + (mu - first) * 99 / 100) for w, mu in curve]


def without_a_corner(curve: Any) -> Any:
    return [curve[0], *curve[2:]] if len(curve) > 2 else [curve[0], (curve[1][0] * 2, curve[1][1])]


def coulomb(curve: Any) -> Any:
    return [(w, curve[0][1]) for w, _ in curve]


WRONG_LAWS: dict[str, Callable[[Oscillator], Oscillator]] = {
    "slope": lambda p: with_curves(p, steeper),
    "corner": lambda p: with_curves(p, without_a_corner),
    "Coulomb": lambda p: p.replace(
        belts=[Belt(belt.v, mu=belt.mu, mu_s=belt.mu_s) for belt in p.belts]
    ),
}
MISTAKES: dict[str, Callable[[Rng], Mistakes]] = {
    "curve in v": lambda rng: Mistakes(absolute=True),
    "mu_s = mu": lambda rng: Mistakes(kinetic_only=True),
    "late": lambda rng: Mistakes(delay=10.0 ** rng.uniform(-3, -1)),
    "early": lambda rng: Mistakes(static=0.99),
    "mu_s too large": lambda rng: Mistakes(static=1.01),
    "blind": lambda rng: Mistakes(blind=1e-2),
}
#: The causes that may be named, by the mistake; "unknown" always may.
CAUSES: dict[str, set[str]] = {
    "Coulomb": {"friction curve"},
    "mu_s = mu": {"static friction"},
}


def wrong_solutions(seed: int) -> Iterator[tuple[str, Scene, np.ndarray, float]]:
    """Yield wrong solutions, and by how many times what is allowed they are wrong."""
    kinds = [*WRONG_LAWS, *MISTAKES, "tanh"]
    number = 0
    for p, start, t_end, right, rng in problems(seed):
        for _ in range(4):
            kind = kinds[number % len(kinds)]
            number += 1
            t = even(t_end, rng)
            if kind == "tanh":
                states = regularised(p, start, t, 10.0 ** rng.uniform(-3, -2))
            elif kind in WRONG_LAWS:
                x0, v0 = start[1:]
                states = simulate(WRONG_LAWS[kind](p), x0=x0, v0=v0, t_end=t_end)(t)
            else:
                try:
                    solution = solved(p, start, t_end, MISTAKES[kind](rng))
                except UnclearError:
                    continue
                states = solution(t)
            yield kind, scene_of(p, start, t_end), np.vstack([t, states]), off_by(right, t, states)


@pytest.mark.slow
@sample_of(20, 200)
def test_wrong_solutions_are_never_right_and_no_wrong_cause_is_named(count: int) -> None:
    passed = []
    misled = []
    for kind, scene, samples, off in islice(
        (case for case in wrong_solutions(9) if case[3] > 10.0), count
    ):
        check = crosscheck(scene, *samples)
        if check.ok:
            passed.append(f"{kind}, {off:.3g} times what is allowed: {scene}\n{told(check)}")
        else:
            named = check.diagnosis[0]
            if named.cause not in {"unknown", *CAUSES.get(kind, ())}:
                misled.append(f"{kind}: {named} {scene}")
    assert passed == [], f"{len(passed)} of {count}"
    assert misled == [], f"{len(misled)} of {count}"
