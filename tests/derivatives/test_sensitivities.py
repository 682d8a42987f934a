"""Derivatives of motions against differences of motions in many digits, and of an independent program."""

from __future__ import annotations

import random
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from random import Random
from typing import Any

import fuzz
import numpy as np
import pytest
from fast_oracle import DIGITS as QUADRUPLE
from fast_oracle import simulate_fast
from oracle import simulate_oracle
from regimes import hundredths, regime_of_seed
from scene_families import FuzzScene
from verdicts import label

from symosc import (
    ParameterError,
    Parameters,
    Trajectory,
    find_orbit,
    load_scene,
    sensitivities,
    simulate,
    simulate_many,
)
from symosc.model import PARAMETER_NAMES

NAMES = (*PARAMETER_NAMES, "t0", "x0", "v0")
STEP = Fraction(1, 10**14)


def scene(seed: int) -> tuple[Parameters, dict[str, Fraction], Fraction]:
    """Return parameters of all regimes of damping, a start beside the belts, and an end."""
    dice = random.Random(seed)
    p = regime_of_seed(dice, seed)
    t0 = hundredths(dice, -3, 3)
    x0 = hundredths(dice, -3, 3)
    v0 = hundredths(dice, -4, 4) + Fraction(1, 997)
    return p, {"t0": t0, "x0": x0, "v0": v0}, t0 + hundredths(dice, 4, 10)


def changed(
    p: Parameters, start: dict[str, Any], name: str, by: Fraction
) -> tuple[Parameters, dict[str, Any]]:
    if name in start:
        return p, start | {name: start[name] + by}
    return p.replace(**{name: getattr(p, name) + by}), start


def differences(
    p: Parameters, start: dict[str, Any], t_end: Any, name: str, sides: Any = (1, -1)
) -> Any:
    """Return the difference quotients of the times and positions of events, and both motions."""
    motions: list[Trajectory] = []
    for side in sides:
        q, begin = changed(p, start, name, side * STEP)
        motions.append(simulate(q, **begin, t_end=t_end, digits=40))
    a, b = motions
    width = (sides[0] - sides[1]) * STEP
    pairs = zip(a.events, b.events, strict=True)
    return np.array(
        [[float((x.t - y.t) / width), float((x.x - y.x) / width)] for x, y in pairs]
    ).reshape(-1, 2), motions


@pytest.mark.full(10)
@pytest.mark.quick(3)
@pytest.mark.parametrize("seed", range(16))
def test_derivatives_are_those_of_differences(seed: int) -> None:
    p, start, t_end = scene(seed)
    changes = sensitivities(p, NAMES, **start, t_end=t_end)
    for i, name in enumerate(NAMES):
        if name in ("c", "k", "mu1", "mu2") and getattr(p, name) == 0:
            continue
        quotients, motions = differences(p, start, t_end, name)
        assert [event.kind for event in motions[0].events] == [
            event.kind for event in changes.trajectory.events
        ]
        size = 1 + abs(quotients).max(initial=0)
        np.testing.assert_allclose(
            changes.dt[:, i], quotients[:, 0], rtol=0, atol=1e-9 * size, err_msg=name
        )
        np.testing.assert_allclose(
            changes.dx[:, i], quotients[:, 1], rtol=0, atol=1e-9 * size, err_msg=name
        )
        times = np.linspace(float(start["t0"]), float(t_end), 9)[1:]
        apart = min(
            (abs(times - float(event.t)).min() for event in changes.trajectory.events), default=1
        )
        if apart > 1e-4:  # so wide a step that doubles resolve it
            wide = []
            for side in (1, -1):
                q, begin = changed(p, start, name, side * Fraction(1, 10**6))
                wide.append(simulate(q, **begin, t_end=t_end))
            slopes = (np.asarray(wide[0](times)) - np.asarray(wide[1](times))) / 2e-6
            scale = 1 + abs(slopes).max()
            np.testing.assert_allclose(
                changes(times)[:, :, i], slopes, rtol=0, atol=1e-4 * scale, err_msg=name
            )


#: Steps by the digits of the motions; None: those of the independent oracle.
STEPS = {None: Fraction(1, 10**11), 60: Fraction(1, 10**25), 110: Fraction(1, 10**45)}
WRONG = 1e-9  # of the largest derivative of the column so far, or of 1
KINK = 1e-3  # by which one-sided quotients differ, relative to the same
EPS = 1e-16
#: Relative errors of the input of so many EPS are no fault of a derivative.
ROUNDINGS = 100.0


@dataclass
class Judged:
    """A derivative: what was found, and whether it exists.

    `allowed` is the error that rounding the input makes.
    """

    scene: FuzzScene
    name: str
    event: int
    regular: bool
    smooth: bool
    error: float
    allowed: float
    clear: bool = False  # said to be regular by 30 digits, where doubles cannot tell

    @property
    def verdict(self) -> str:
        if not self.smooth:
            if self.regular:
                return "kink missed"
            return "kink named"
        if not self.regular:
            if self.clear:
                return "not told by doubles"
            return "said to be a kink"
        if self.error <= WRONG:
            return "right"
        if self.error <= self.allowed:
            return "right for doubles"
        return "wrong"


def moved(scene: FuzzScene, name: str, by: Fraction, digits: int | None) -> Any:
    """Return the events of a scene with a changed number."""
    p = scene.p
    start = {name: getattr(scene, name) for name in ("t0", "x0", "v0")}
    if name in start:
        start[name] += by
    elif name:
        p = p.replace(**{name: getattr(p, name) + by})
    if digits is None:
        return simulate_fast(p, *start.values(), scene.t_end, scene.dps).events
    return simulate(p, **start, t_end=scene.t_end, digits=digits).events


def quotients(scene: FuzzScene, name: str, base: Any, digits: int | None) -> Any:
    """Yield for each event of `base` by differences dt, dx and how one-sided ones differ.

    None from where events do.
    """
    own = abs(getattr(scene if name in ("t0", "x0", "v0") else scene.p, name))
    h = STEPS[digits] * (own or 1)
    more, less = (moved(scene, name, sign * h, digits) for sign in (1, -1))
    same = True
    for n, event in enumerate(base):
        same = (
            same
            and n < min(len(more), len(less))
            and label(more[n]) == label(less[n]) == label(event)
        )
        if same:
            triples = [
                [getattr(item[n], axis) for item in (more, base, less)] for axis in ("t", "x")
            ]
        else:
            triples = ()
        rows = [
            (float(a - c) / (2 * float(h)), float(a - 2 * b + c) / float(h), float(own) or 1.0)
            for a, b, c in triples
        ]
        yield rows or None


def judged(scene: FuzzScene, names: tuple[str, ...]) -> list[Judged]:
    """Judge all derivatives of a scene."""
    start = {name: getattr(scene, name) for name in ("t0", "x0", "v0", "t_end")}
    s = sensitivities(scene.p, names, **start)
    base = cache(lambda digits: moved(scene, "", Fraction(0), digits))
    results: list[Judged] = []
    for j, name in enumerate(names):
        rows: list[Judged] = []
        with suppress(ParameterError):  # a step to values that are not allowed
            for digits in list(STEPS)[scene.dps > QUADRUPLE :]:
                rows = column(scene, s, j, name, base(digits), digits)
                if all(row.verdict in ("right", "kink named") for row in rows):
                    break
            results += rows
    if any(row.verdict == "said to be a kink" for row in results) and any(
        "rounding" in (r or "") for r in s.reasons
    ):
        exact = sensitivities(scene.p, names, **start, digits=30)
        for row in results:
            row.clear = row.event < len(exact.dt) and bool(
                exact.regular[row.event, names.index(row.name)]
            )
    wrong = [row for row in results if row.verdict == "wrong"]
    if wrong:
        rounded(scene, s, names, wrong)
    return results


def rounded(scene: FuzzScene, s: Any, names: tuple[str, ...], rows: list[Judged]) -> None:
    """Set the errors that are allowed to those which relative errors of EPS in all numbers make, times ROUNDINGS."""
    start = {name: getattr(scene, name) for name in ("t0", "x0", "v0")}
    dice = Random(1)
    belt = next((name for name in ("v1", "v2") if getattr(scene.p, name) == scene.v0), "")

    def nearby(by: Fraction) -> Any:
        p = scene.p.replace(
            **{q: getattr(scene.p, q) * (1 + dice.choice((-1, 1)) * by) for q in PARAMETER_NAMES}
        )
        moved = {each: value * (1 + dice.choice((-1, 1)) * by) for each, value in start.items()}
        # a start on a belt stays there
        if belt:
            moved |= {"v0": getattr(p, belt)}
        else:
            moved |= {}
        return sensitivities(p, names, **moved, t_end=scene.t_end, digits=30)

    exact, *beside = map(nearby, (Fraction(0), *[Fraction(1, 10**16)] * 3))
    for row in rows:
        j = names.index(row.name)
        n = row.event
        scale = max(
            1.0, float(abs(exact.dt[: n + 1, j]).max()), float(abs(exact.dx[: n + 1, j]).max())
        )
        near = [item for item in beside if n < len(item.dt)]  # the last event may be at t_end
        off = [
            abs(getattr(item, axis)[n, j] - getattr(exact, axis)[n, j])
            for item in near
            for axis in ("dt", "dx")
        ]
        row.allowed = ROUNDINGS * float(max(off)) / scale


def column(
    scene: FuzzScene, s: Any, j: int, name: str, base: Any, digits: int | None
) -> list[Judged]:
    """Judge the derivatives of all events by one number."""
    rows = []
    scale = [1.0, 1.0]
    for n, quotient in enumerate(quotients(scene, name, base, digits)):
        if n >= len(s.dt) or label(s.trajectory.events[n]) != label(base[n]):
            break
        for axis, value in enumerate((float(s.dt[n, j]), float(s.dx[n, j]))):
            smooth = quotient is not None
            error = 0.0
            allowed = 0.0
            if quotient is not None:
                middle, apart, size = quotient[axis]
                scale[axis] = max(scale[axis], abs(middle))
                h = size * float(STEPS[digits])
                smooth = abs(apart) <= KINK * scale[axis]
                error = abs(value - middle) / scale[axis]
                allowed = ROUNDINGS * EPS * abs(apart) / h * size / scale[axis]
            rows.append(Judged(scene, name, n, bool(s.regular[n, j]), smooth, error, allowed))
    return rows


def scene_of(family: str, seed: int, number: int, most_events: int) -> FuzzScene:
    """Return a scene of the fuzzer, up to so many events."""
    scene = fuzz.scene_of(family, seed, number)
    motion = simulate(scene.p, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end)
    if len(motion.events) <= most_events:
        return scene
    cut = Fraction(float(motion.events[most_events].t)).limit_denominator(10**6)
    return fuzz.plain.with_digits(scene, t_end=cut, truth=None)


@pytest.mark.full(6)
@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "family", [name for name in fuzz.FAMILIES if name not in ("aimed", "creep", "settle")]
)
def test_random_scenes_of_the_fuzzer(family: str) -> None:
    """Difference quotients of the independent oracle; where these are not sure, of many digits."""
    rows = judged(scene_of(family, 1000, 0, 6), ("m", "Omega", "v1", "mu1", "t0", "v0"))
    assert not [row for row in rows if row.verdict in ("wrong", "kink missed", "said to be a kink")]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mu1", "Omega", "x0", "m"])
def test_an_independent_program_has_the_same_derivatives(name: str) -> None:
    """Differences over 1e-20 of motions that another program finds with 50 digits, from the equation of motion."""
    one = load_scene("fig5")
    start = {"t0": one.t0, "x0": one.x0, "v0": one.v0}
    step = Fraction(1, 10**20)
    changes = sensitivities(one, (name,), t_end=9)
    runs = []
    for side in (1, -1):
        q, begin = changed(one.parameters, start, name, side * step)
        runs.append(simulate_oracle(q, begin["t0"], begin["x0"], begin["v0"], 9, 50))
    for i, (a, b) in enumerate(zip(runs[0].events, runs[1].events, strict=True)):
        assert changes.dt[i, 0] == pytest.approx(
            float((a.t - b.t) / (2 * step)), rel=1e-10, abs=1e-10
        )
        assert changes.dx[i, 0] == pytest.approx(
            float((a.x - b.x) / (2 * step)), rel=1e-10, abs=1e-10
        )


def test_many_digits() -> None:
    one = load_scene("fig5")
    doubles, exact = (sensitivities(one, NAMES, t_end=7, digits=digits) for digits in (None, 30))
    np.testing.assert_allclose(doubles.dt, exact.dt.astype(float), rtol=1e-10, atol=1e-10)
    step = Fraction(1, 10**20)
    base = {"t0": one.t0, "x0": one.x0, "v0": one.v0}
    runs = []
    for side in (1, -1):
        q, begin = changed(one.parameters, base, "mu1", side * step)
        runs.append(simulate(q, **begin, t_end=7, digits=60))
    a, b = (run.events[2].t for run in runs)
    assert abs(exact.dt[2, NAMES.index("mu1")] - (a - b) / (2 * step)) < 1e-25


@pytest.mark.parametrize("name", ["fig7-exact", "fig8-exact"])
def test_a_graze_is_a_kink_and_says_its_side(name: str) -> None:
    """On the side where the touch opens the motion goes on without a contact, and has these derivatives."""
    one = load_scene(name)
    changes = sensitivities(one, ("A0", "FN", "t0"))
    first = next(n for n, event in enumerate(changes.trajectory.events) if event.kind == "graze")
    assert not changes.regular[first:, 0].any()
    assert "after the graze at t = 3.14159" in str(changes.reasons[first])
    if "A0 larger" in str(changes.reasons[first]):
        side = 1
    else:
        side = -1
    step = side * Fraction(1, 10**6)
    times = np.linspace(float(one.t0), float(one.t_end), 7)[1:]
    moved = simulate(
        one.parameters.replace(A0=one.parameters.A0 + step),
        t0=one.t0,
        x0=one.x0,
        v0=one.v0,
        t_end=one.t_end,
    )
    assert "stick" not in [event.kind for event in moved.events[: first + 1]]
    still = simulate(one)
    slopes = (np.asarray(moved(times[:2])) - np.asarray(still(times[:2]))) / float(step)
    np.testing.assert_allclose(changes(times[:2])[:, :, 0], slopes, rtol=1e-3, atol=1e-3)


def test_a_graze_that_stays_one_is_none() -> None:
    """Without damping and drive a mass that has slipped from a belt comes back to its speed in any case."""
    p = Parameters(m=1, c=0, k=4, A0=0, B0=0, Omega=1, v1=-3, v2=1, mu1="0.3", mu2="0.7", FN=2)
    changes = sensitivities(p, NAMES, x0=-2, v0=2, t_end=40)
    grazes = [n for n, event in enumerate(changes.trajectory.events) if event.kind == "graze"]
    assert len(grazes) > 8
    for n in grazes:
        assert {
            name for name, there in zip(NAMES, changes.regular[n], strict=True) if not there
        } <= {
            "c",
            "B0",
        }


def test_a_start_on_a_belt_is_a_kink() -> None:
    changes = sensitivities("fig9", ("v0", "v1", "x0"))
    assert changes.regular[0].tolist() == [False, False, True]
    assert "the start is on a belt: by v0, v1 on the flight's side" in str(changes.reasons[0])
    assert changes.reasons[1] is None


@pytest.mark.parametrize("name", ["fig9", "fig10", "fig5"])
def test_exponents_of_a_settled_motion_are_those_of_its_orbit(name: str) -> None:
    orbit = find_orbit(name)
    (t, x) = orbit.points[0]
    belt = orbit.equations().pieces[0].start
    p = orbit.parameters
    periods = 40
    changes = sensitivities(
        p, ("x0",), t0=t, x0=x, v0=p.belt(belt), t_end=t + periods * orbit.period
    )
    expected = orbit.lyapunov
    assert changes.lyapunov[0] == pytest.approx(expected[0], rel=0.05)
    if expected[1] == -np.inf:
        assert changes.lyapunov[1] == -np.inf
    else:
        assert changes.lyapunov.sum() == pytest.approx(expected.sum(), rel=0.05)


@pytest.mark.parametrize("beside", ["1e-14", "1e-8", "-1e-10", "0"])
def test_near_critical_damping(beside: str) -> None:
    p = Parameters(
        m=1,
        c=2,
        k=1 + Fraction(beside),
        A0=1,
        B0=9,
        Omega="3/2",
        v1=-1,
        v2=2,
        mu1="2/5",
        mu2="3/10",
        FN=5,
    )
    doubles, exact = (
        sensitivities(p, ("m", "c", "k", "Omega"), t_end=9, digits=digits) for digits in (None, 40)
    )
    assert len(doubles.dt) > 3
    np.testing.assert_allclose(doubles.dt, exact.dt.astype(float), rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(doubles.dx, exact.dx.astype(float), rtol=1e-11, atol=1e-12)


def test_a_slow_drive_and_a_creeping_flight_keep_their_digits() -> None:
    """By Omega nothing cancels where it is small.

    Where a contact has hardly a slope 30 digits are taken.
    """
    slow = Parameters(
        m="0.1",
        c=0,
        k="3.5",
        A0=8,
        B0=20,
        Omega="8e-5",
        v1=30,
        v2=34,
        mu1="0.7",
        mu2="0.9",
        FN="1.6",
    )
    creeping = Parameters(
        m=1, c=3, k=1, A0="-1/2", B0="1e-6", Omega="1/30", v1=0, v2=1, mu1="0.8", mu2="0.2", FN=4
    )
    for p, start in ((slow, {"t0": 7, "x0": 2, "v0": 30}), (creeping, {"x0": "-1.5", "v0": "0.6"})):
        start |= {"t_end": 60}
        doubles, exact = (sensitivities(p, NAMES, **start, digits=digits) for digits in (None, 40))
        assert len(doubles.dt) > 0
        for result, known in (
            (doubles.dt, exact.dt.astype(float)),
            (doubles.dx, exact.dx.astype(float)),
        ):
            np.testing.assert_allclose(result, known, rtol=1e-9, atol=1e-12 * abs(known).max())


@pytest.mark.parametrize("t0", [10**4, 10**6, 17903280000])
def test_positions_of_late_events_keep_their_digits(t0: int) -> None:
    """All times depend much on Omega then, and dx is the small difference of what that makes."""
    p = Parameters(
        m="0.149", c="0.00206", k="0.0597", A0=0, B0="0.287", Omega="0.18", v1="-1.16", v2=0, mu1="0.528", mu2="0.935",
        FN="0.0964",
    )  # fmt: skip
    start: dict[str, Any] = {"t0": t0, "x0": "-0.3976", "v0": 0}
    known, _ = differences(
        p, {name: Fraction(value) for name, value in start.items()}, t0 + 40, "Omega"
    )
    changes = sensitivities(p, "Omega", **start, t_end=t0 + 40)
    assert len(known) > 3
    np.testing.assert_allclose(changes.dx[:, 0], known[:, 1], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(changes.dt[:, 0], known[:, 0], rtol=1e-9)


def test_exponents_are_those_of_more_digits() -> None:
    doubles, digits = (
        sensitivities("fig5", "x0", t_end="60T", digits=item).lyapunov for item in (None, 30)
    )
    np.testing.assert_allclose(doubles, digits, rtol=1e-10)


@pytest.mark.parametrize("name", ["fig9", "fig10", "fig5"])
def test_orbits_have_the_derivatives_of_branches_and_motions(name: str) -> None:
    """Against differences of orbits in doubles, and the motion on the orbit after many periods."""
    orbit = find_orbit(name)
    names = ("FN", "Omega", "k")
    h = 1e-6
    changes = orbit.sensitivities(names)
    for i, each in enumerate(names):
        value = float(getattr(orbit.parameters, each))
        beside = []
        for way in (1, -1):
            other = find_orbit(
                orbit.parameters.replace(**{each: value + way * h}), orbit.word, orbit
            )
            beside.append(
                np.array(
                    [*(p.t for p in other.points), *(p.x for p in other.points), *other.multipliers]
                )
            )
        quotients = (beside[0] - beside[1]) / (2 * h)
        n = len(orbit.points)
        np.testing.assert_allclose(changes.dt[:, i], quotients[:n].real, rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(
            changes.dx[:, i], quotients[n : 2 * n].real, rtol=1e-6, atol=1e-6
        )
        np.testing.assert_allclose(
            changes.dmultipliers[:, i], quotients[2 * n :], rtol=1e-5, atol=1e-6
        )
    (t, x) = orbit.points[0]
    belt = orbit.equations().pieces[0].start
    start = {"t0": t, "x0": x, "v0": orbit.parameters.belt(belt)}
    moved = sensitivities(orbit.parameters, "FN", **start, t_end=t + 30.5 * orbit.period)
    there = t + 30 * orbit.period
    last = min(range(len(moved.dt)), key=lambda n: abs(float(moved.trajectory.events[n].t) - there))
    assert moved.dt[last, 0] == pytest.approx(changes.dt[0, 0], abs=1e-7)
    assert moved.dx[last, 0] == pytest.approx(changes.dx[0, 0], abs=1e-7)


def test_ensembles_have_the_same_derivatives() -> None:
    """Of many parameter sets and starts, interpreted and compiled.

    The bits are those of single motions.
    """
    scenes = [scene(seed) for seed in range(12)]
    sets = [p for p, _, _ in scenes]
    starts = [[float(start[name]) for name in ("t0", "x0", "v0")] for _, start, _ in scenes]
    ends = [float(end) for _, _, end in scenes]
    tables = [simulate_many(sets, starts, ends, wrt=NAMES, use_numba=way) for way in (False, None)]
    assert tables[0] == tables[1]
    assert tables[0].dt.shape == (len(tables[0]), len(NAMES))
    for i, (t0, x0, v0) in enumerate(starts):
        alone = sensitivities(sets[i], NAMES, t0=t0, x0=x0, v0=v0, t_end=ends[i])
        mine = tables[0][i]
        np.testing.assert_allclose(mine.dt, alone.dt, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(mine.dx, alone.dx, rtol=1e-9, atol=1e-9)
        np.testing.assert_array_equal(mine.regular, alone.regular)
