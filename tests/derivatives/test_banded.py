"""Derivatives under laws with curves and many belts: against differences of motions in many digits,
and against plain laws that make the same motion.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import log
from typing import Any

import numpy as np
import pytest
from law_families import scene_of
from law_fuzz import oscillator_of
from mpmath import mpf

from symosc import (
    Belt,
    Oscillator,
    ParameterError,
    load_scene,
    sensitivities,
    simulate,
    simulate_many,
)
from symosc.model import OSCILLATOR_NAMES
from symosc.simulation.law_gradients import LawGradients, with_all_points

STEP = Fraction(1, 10**15)
EVENTS = 12
LAW: dict[str, Any] = {"m": 1, "c": "1/10", "k": 1, "B0": "9/10", "Omega": "11/10"}
#: Friction that falls up to the relative speed 1, and rises again beyond.
STRIBECK = Oscillator(
    **LAW | {"m": "5/4", "FN": "8/9", "A0": "1/20", "B0": "1/2"},
    belts=[
        Belt("-6/5", "1/7"),
        Belt("1/2", curve=[(0, "1/2"), (1, "1/5"), ("3/2", "1/4")], slope="1/30", mu_s="7/10"),
        Belt("11/5", curve=[(0, "1/10"), ("1/3", "1/20")]),
    ],
)
START: dict[str, Any] = {"t0": "1/10", "x0": 1, "v0": "3/10"}


def names_of(model: Oscillator) -> tuple[str, ...]:
    tied = [f"mu_s{n}" for n, belt in enumerate(model.belts, 1) if not belt.has_static]
    return (*(name for name in model.numbers() if name not in tied), "t0", "x0", "v0")


def moved(model: Oscillator, start: dict[str, Any], name: str, step: Fraction) -> np.ndarray | None:
    """Return t and x of all events if a number is changed, None if it must not be."""
    start = dict(start)
    try:
        if name in start:
            start[name] = Fraction(start[name]) + step
        else:
            model = model.replace(**{name: model.numbers()[name] + step})
    except ParameterError:
        return None
    motion = simulate(model, **start, max_events=EVENTS, digits=40)
    return np.array([[event.t, event.x] for event in motion.events], dtype=object)


def differences(model: Oscillator, start: dict[str, Any], name: str) -> np.ndarray:
    """Return the derivatives of t and x of all events by a number, by differences in 40 digits.

    At the end of the range of the number they are one-sided.
    """
    ahead = moved(model, start, name, STEP)
    behind = moved(model, start, name, -STEP)
    here = moved(model, start, name, Fraction(0))
    steps = mpf(10) ** -15 * ((ahead is not None) + (behind is not None))
    return ((here if ahead is None else ahead) - (here if behind is None else behind)) / steps


def largest_error(model: Oscillator, start: dict[str, Any], names: tuple[str, ...]) -> float:
    """Return the largest error of dt and dx, relative to the largest derivative by the same number
    so far.
    """
    found = sensitivities(model, names, **start, max_events=EVENTS)
    assert found.regular.all()
    errors = [0.0]
    for n, name in enumerate(names):
        own = np.stack([found.dt[:, n], found.dx[:, n]], axis=1)
        scale = np.maximum.accumulate(np.maximum(abs(own).max(axis=1), 1e-3))
        exact = differences(model, start, name).astype(float)
        errors.append((abs(own - exact) / scale[:, None]).max())
    return max(errors)


@pytest.mark.parametrize("part", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_differences_by_every_number(part: int) -> None:
    """Of the oscillator, of three belts and their curves, and of the start."""
    start = START | {"t_end": 25}
    motion = simulate(STRIBECK, **start, max_events=EVENTS)
    assert {event.kind for event in motion.events} == {"cross", "stick", "slip"}
    names = names_of(STRIBECK)
    assert {"w2_1", "mu2_2", "slope2", "slope3", "mu_s2", "mu1", "FN", "m"} <= set(names)
    some = [
        name for name in names if (name in ("m", "w2_1", "mu2_1", "mu_s2", "t0")) == (part == 0)
    ]
    assert largest_error(STRIBECK, start, tuple(some)) < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("belts", [1, 2, 3])
@pytest.mark.parametrize("number", [3, 4, 5])
def test_differences_of_random_laws(number: int, belts: int) -> None:
    scene = scene_of("curved", 11, number, belts)
    model = oscillator_of(scene)
    start = {"t0": scene.t0, "x0": scene.x0, "v0": scene.v0, "t_end": scene.t_end}
    names = names_of(model)
    step = max(1, len(names) // 8)
    assert largest_error(model, start, names[number % step :: step]) < 1e-9


def test_many_digits_and_doubles_agree() -> None:
    names = names_of(STRIBECK)
    start = START | {"t_end": 20}
    exact = sensitivities(STRIBECK, names, **start, digits=30)
    found = sensitivities(STRIBECK, names, **start)
    assert hasattr(exact.dt[0, 0], "_mpf_")
    assert abs(found.dt - exact.dt.astype(float)).max() < 1e-11
    assert abs(found.dx - exact.dx.astype(float)).max() < 1e-11
    times = [0.4, 7.7, 15.1]
    assert abs(found(times) - exact(times).astype(float)).max() < 1e-11


def test_the_state_at_any_time() -> None:
    """In flights, beyond corners and in sticks: against differences of states."""
    names = ("x0", "v0", "t0", "Omega", "mu2_1", "w2_1", "slope2", "v2", "FN", "m")
    start = START | {"t_end": 12}
    found = sensitivities(STRIBECK, names, **start)
    times = np.linspace(0.3, 11.9, 37)
    modes = set(simulate(STRIBECK, **start).mode(times))
    assert len(modes) >= 3
    assert any(mode.startswith("belt") for mode in modes)
    step = Fraction(1, 10**5)
    own = found(times)
    for n, name in enumerate(names):
        states = []
        for by in (step, -step):
            model = STRIBECK
            begin = dict(start)
            if name in begin:
                begin[name] = Fraction(begin[name]) + by
            else:
                model = model.replace(**{name: model.numbers()[name] + by})
            states.append(simulate(model, **begin)(times))
        difference = (states[0] - states[1]) / (2 * float(step))
        assert abs(own[:, :, n] - difference).max() < 1e-6 * max(1, abs(own[:, :, n]).max()), name


@pytest.mark.parametrize("name", ["fig5", "fig6", "fig8-exact", "fig9"])
def test_a_belt_that_is_never_met_changes_nothing(name: str) -> None:
    """Three belts have bands, two have none: grazes and starts on belts too."""
    scene = load_scene(name)
    p = scene.parameters
    shared = {letter: getattr(p, letter) for letter in OSCILLATOR_NAMES}
    three = Oscillator(**shared, belts=[*p.oscillator.belts, Belt(60, 0)])
    names = (*p.numbers(), "t0", "x0", "v0")
    plain = sensitivities(scene, names)
    banded = sensitivities(replace(scene, parameters=three), names)
    assert len(plain.dt) > 0
    assert abs(plain.dt - banded.dt).max() < 1e-12 * max(1, abs(plain.dt).max())
    assert abs(plain.dx - banded.dx).max() < 1e-12 * max(1, abs(plain.dx).max())
    assert (plain.regular == banded.regular).all()
    assert plain.reasons == banded.reasons
    assert banded.lyapunov.tolist() == pytest.approx(plain.lyapunov.tolist(), abs=1e-10)
    middle = (float(scene.t0) + float(scene.t_end)) / 2
    assert abs(plain(middle) - banded(middle)).max() < 1e-9


def test_starts_on_a_belt_are_marked_as_under_a_plain_law() -> None:
    p = load_scene("fig5").parameters
    shared = {letter: getattr(p, letter) for letter in OSCILLATOR_NAMES}
    three = Oscillator(**shared, belts=[*p.oscillator.belts, Belt(60, 0)])
    for x0, v0 in ((0, 1), (3, 5), (-40, 1)):
        start = {"x0": x0, "v0": v0, "t_end": 8}
        plain = sensitivities(p, ("v0", "v1", "v2", "x0", "k"), **start)
        banded = sensitivities(three, ("v0", "v1", "v2", "x0", "k"), **start)
        assert plain.reasons == banded.reasons
        assert not plain.regular.all()
        assert (plain.regular == banded.regular).all()


def test_points_on_a_straight_line() -> None:
    """Each of them makes a corner if it moves; together they are the plain law."""
    start = START | {"t_end": 20}
    other = Belt(2, "1/10")
    plain = Oscillator(**LAW, belts=[Belt("1/2", "2/5", mu_s="3/5"), other])
    points = [(0, "2/5"), ("3/10", "2/5"), ("11/10", "2/5")]
    flat = Oscillator(**LAW, belts=[Belt("1/2", curve=points, mu_s="3/5"), other])
    assert sensitivities(plain, "mu1", **start).dt.shape[0] > 5
    whole = sensitivities(plain, ("mu1", "k", "v1", "FN"), **start)
    names = ("mu1", "mu1_1", "mu1_2", "w1_1", "k", "v1", "FN")
    parts = sensitivities(flat, names, **start)
    assert abs(parts.dt[:, :3]).max(axis=0).min() > 0.1
    assert abs(whole.dt[:, 0] - parts.dt[:, :3].sum(axis=1)).max() < 1e-12
    assert abs(whole.dt[:, 1:] - parts.dt[:, 4:]).max() < 1e-12
    assert abs(parts.dt[:, 3]).max() == 0.0
    assert largest_error(flat, start, ("mu1_1", "mu1_2", "slope1")) < 1e-10


def test_gradients_of_bands_are_those_of_exact_differences() -> None:
    """Damping and constant force of each band, from `Oscillator.bands`."""
    model = STRIBECK.replace(slope3="1/50")
    wrt = [name for name in model.numbers() if name not in ("mu_s1", "mu_s3")]
    gradients = LawGradients(model, wrt)
    step = Fraction(1, 10**20)
    for n, name in enumerate(wrt):
        bands = [model.replace(**{name: model.numbers()[name] + by}).bands for by in (step, -step)]
        for row, (ahead, behind) in enumerate(zip(*bands, strict=True)):
            own = gradients.of_row(row, Fraction, object)[:, n]
            assert abs(own[1] - (ahead.c - behind.c) / (2 * step)) < Fraction(1, 10**30)
            assert abs(own[3] - (ahead.A - behind.A) / (2 * step)) < Fraction(1, 10**30)


def test_a_corner_between_points_of_a_line_only_where_they_move() -> None:
    points = [(0, "2/5"), (1, "3/10"), (2, "1/5")]
    model = Oscillator(**LAW, belts=[Belt(0, curve=points)])
    assert len(model.bands) == 4
    assert len(with_all_points(model).bands) == 6
    assert not LawGradients(model, ("k", "FN", "v1", "x0")).bends_a_line
    assert LawGradients(model, ("k", "mu1_1")).bends_a_line


def test_a_corner_on_another_belt() -> None:
    """Whether the force that ends a stick there rises or falls with v1 depends on the side."""
    law = LAW | {"B0": "1/2"}
    curve = [(0, "1/10"), ("3/2", "1/20")]
    model = Oscillator(**law, belts=[Belt("1/2", "1/2", mu_s="3/2"), Belt(2, curve=curve)])
    found = sensitivities(model, ("v1", "k", "w2_1", "mu2_1"), **START, t_end=20)
    slips = [n for n, event in enumerate(found.trajectory.events) if event.kind == "slip"]
    n = next(n for n in slips if found.trajectory.events[n].boundary == 1)
    assert found.regular[n:].tolist() == [[False, True, False, True]] * len(found.regular[n:])
    assert "belt 1 has the speed of a corner" in str(found.reasons[n])
    assert found.regular[:n].all()


def test_exponents_are_those_of_differences_of_motions() -> None:
    """A motion through corners, and across a belt of which nothing sticks."""
    fast = Oscillator(
        m=1, c="1/10", k=1, B0=4, Omega="3/2",
        belts=[Belt("1/5", curve=[(0, "1/10"), (1, "1/20"), (2, "1/4")], slope="1/10")],
    )  # fmt: skip
    start = {"x0": 1, "v0": 3, "t_end": 30}
    found = sensitivities(fast, "x0", **start)
    kinds = {event.kind for event in found.trajectory.events}
    assert kinds == {"cross"}
    step = 1e-6
    columns = []
    for name in ("x0", "v0"):
        ends = [
            simulate(fast, **start | {name: Fraction(start[name]) + Fraction(sign, 10**6)})(30)
            for sign in (1, -1)
        ]
        columns.append((ends[0] - ends[1]) / (2 * step))
    stretches = np.linalg.svd(np.array(columns))[1]
    exponents = [log(stretch) / 30 for stretch in stretches]
    assert found.lyapunov.tolist() == pytest.approx(exponents, abs=1e-7)


def test_the_sum_of_exponents_without_a_belt_in_reach_is_the_mean_damping() -> None:
    """Both are -c_j/(2m) where a motion stays in one band; it grows where friction falls."""
    falling = Oscillator(m=2, c=0, k=2, belts=[Belt(9, curve=[(0, 1), (20, "1/2")])])
    found = sensitivities(falling, "x0", x0="1/4", v0=0, t_end=60)
    assert len(found.dt) == 0
    assert sum(found.lyapunov) == pytest.approx(1 / 40 / 2, rel=1e-12)
    assert found.lyapunov[0] > 0


@pytest.mark.slow
def test_exponent_of_a_stick_slip_motion() -> None:
    """After a stick one exponent is -inf; the other one is that of differences, between sticks."""
    found = sensitivities(STRIBECK, "x0", **START, t_end=300)
    assert found.lyapunov[1] == -np.inf
    assert found.lyapunov_error > 0
    short = sensitivities(STRIBECK, "x0", **START, t_end=20)
    ends = [
        simulate(STRIBECK, **START | {"x0": 1 + Fraction(sign, 10**6)}, t_end=20)(20)
        for sign in (1, -1)
    ]
    by_x0 = (ends[0] - ends[1]) / 2e-6
    assert short(20.0)[:, 0] == pytest.approx(by_x0, abs=1e-7)


def test_many_motions_at_once() -> None:
    """Against differences of runs with 40 digits, and the same bits as one motion."""
    names = ("w2_1", "mu_s2", "v2", "x0")
    plain = STRIBECK.replace(belts=[Belt("-6/5", "1/7"), Belt("1/2", "1/3", mu_s="1/2")])
    rows = [("1/10", 1, "3/10"), (0, -1, 0), ("1/5", "1/2", 2)]
    table = simulate_many(STRIBECK, rows, 15, wrt=names, use_numba=False)
    for number, (t0, x0, v0) in enumerate(rows):
        start = {"t0": t0, "x0": x0, "v0": v0, "t_end": 15}
        own = table[number]
        alone = sensitivities(STRIBECK, names, **start)
        assert own.t.tolist() == [event.t for event in alone.trajectory.events]
        assert len(own) >= 6
        assert (own.dt == alone.dt).all()
        assert (own.dx == alone.dx).all()
        assert own.regular.all()
        for n, name in enumerate(names):
            exact = differences(STRIBECK, start, name).astype(float)
            found = np.stack([own.dt[:, n], own.dx[:, n]], axis=1)[: len(exact)]
            assert abs(found - exact).max() < 1e-10 * max(1, abs(exact).max())
    several = [plain, STRIBECK.replace(belts=STRIBECK.belts[:2])]
    both = simulate_many(several, [(0, 1, 0)] * 2, 15, wrt=("mu2", "x0"), use_numba=False)
    for number, model in enumerate(several):
        alone = sensitivities(model, ("mu2", "x0"), x0=1, t_end=15)
        assert abs(both[number].dt - alone.dt).max() < 1e-12
        assert abs(both[number].dt).max() > 0
    none = simulate_many(STRIBECK, np.zeros((0, 3)), 15, wrt=names, use_numba=False)
    assert none.dt.shape == (0, 4)


def test_many_motions_by_a_number_that_one_of_them_lacks() -> None:
    flat = STRIBECK.replace(belts=[Belt(0, 1)])
    curved = STRIBECK.replace(belts=[Belt(0, curve=[(0, 1), (1, "1/2")])])
    with pytest.raises(ParameterError, match=r"parameters\[1\] has no number w1_1"):
        simulate_many([curved, flat], (0, 0, 0), 1, wrt="w1_1", use_numba=False)


def test_names_are_those_of_the_curve() -> None:
    with pytest.raises(ParameterError, match=r"wrt.*w2_3.*must be one of .*w2_2, mu2_2"):
        sensitivities(STRIBECK, "w2_3", t_end=1)
