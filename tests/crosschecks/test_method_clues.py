"""Methods with a fixed step: which one it was, and with which step."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck
from faulty_solver import Flaw, Solver, without_events
from oracle import flow_oracle

from symosc import load_scene
from symosc.crosschecks import method_clues
from symosc.crosschecks.steps import follow_steps

NAMES = {"euler": "Euler", "heun": "Heun", "rk4": "RK4"}


@pytest.mark.quick(1)
@pytest.mark.parametrize(("method", "count"), [("rk4", 1), ("euler", 1), ("heun", 4)])
def test_a_method_and_its_step_are_named(method: str, count: int) -> None:
    scene = load_scene("fig5")
    run = Solver(scene.parameters, Flaw(method=method)).run(np.linspace(0, 20, 150 * count + 1), 0.0, 0.0)
    t, x, v = (column[::count] for column in run.arrays())
    first = crosscheck(scene, t, x, v).diagnosis[0]
    assert (first.cause, first.subject) == ("truncation", NAMES[method])
    assert first.value == pytest.approx(20 / 150 / count)


@pytest.mark.slow
def test_a_method_that_goes_over_events_chatters() -> None:
    scene = load_scene("fig5")
    t, x, v = without_events(scene.parameters, np.linspace(0, 20, 1601), 0.0, 0.0)
    first = crosscheck(scene, t[::4], x[::4], v[::4]).diagnosis[0]
    assert (first.cause, first.subject) == ("chatter", "RK4")
    assert first.value == pytest.approx(0.0125)


@pytest.mark.parametrize("method", ["euler", "rk4"])
def test_a_method_whose_events_are_samples_does_not_go_over_them(method: str) -> None:
    """Steps end and begin at the events, with v at the belt's speed: these are located, however wrong the flights."""
    scene = load_scene("fig6")
    run = Solver(scene.parameters, Flaw(method=method), joints=True).run(np.linspace(0, 20, 61), 0.0, 5.0)
    assert len(run.events) == 3
    first = crosscheck(scene, *run.arrays()).diagnosis[0]
    assert (first.cause, first.subject) == ("truncation", NAMES[method])


@pytest.mark.parametrize("power", [1.0, 4.0, 5.5])
def test_the_order_of_errors_is_seen_if_the_steps_differ_enough(power: float) -> None:
    rng = np.random.default_rng(int(power))
    for count, spread, enough in ((40, 3.0, True), (20, 1.1, True), (19, 3.0, False), (40, 0.99, False)):
        h = 0.01 * np.exp(np.append(rng.uniform(0, spread, count - 2), [0.0, spread]))
        wrong = np.arange(count)
        errors = np.exp(rng.uniform(-0.05, 0.05, count)) * h**power
        defects = np.column_stack([2.0 * errors, 0.5 * errors])
        clues: Any = SimpleNamespace(
            steps=SimpleNamespace(t=np.append(0.0, np.cumsum(h)), defects=defects), scales=np.array([2.0, 3.0])
        )
        found = method_clues._order(clues, wrong)
        assert (found is not None) == enough
        if found is not None:
            assert found[0] == pytest.approx(power, abs=0.1)
            assert abs(found[0] - power) < 5 * found[1] < 0.5


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("name", ["exact", "Euler", "RK4"])
def test_what_a_method_repeats_is_missed_by_nothing(name: str, count: int) -> None:
    """Samples that were made by the method itself, in steps of each domain, and others that are off."""
    scene = load_scene("fig10")
    p, rng = scene.parameters, np.random.default_rng(count)
    method = method_clues.FIXED_STEP_METHODS[name]
    t, v = np.cumsum(rng.uniform(0.01, 0.03, 13)), rng.uniform(-9, 9, 13)
    x = rng.uniform(-2, 2, 13)
    steps = follow_steps(p, t, x, v, 1e-9, np.ones(2))
    clues: Any = SimpleNamespace(steps=steps, allowed=np.tile([1e-3, 2e-3], (12, 1)))
    chosen = np.array([0, 4, 11])
    missed = []
    for i in chosen.tolist():
        state, h = (x[i], v[i]), (t[i + 1] - t[i]) / count
        for k in range(count):
            begin = t[i] + k * h
            domain = 1 + (state[1] > p.v1) + (state[1] > p.v2)

            def force(since: float, x: float, v: float, begin: float = begin) -> float:
                A = float(p.A(1 + (v > p.v1) + (v > p.v2)))
                drive = A + float(p.B0) * np.cos(float(p.Omega) * (begin + since))
                return float((drive - float(p.k) * x - float(p.c) * v) / float(p.m))

            if method is None:
                state = tuple(float(value) for value in flow_oracle(p, domain, begin, *state, h, 20)[:2])
            else:
                state = method(force, 0.0, *state, h)
        missed.append(max(abs(float(state[0]) - x[i + 1]) / 1e-3, abs(float(state[1]) - v[i + 1]) / 2e-3))
    assert method_clues._repeated(clues, chosen, method, count) == pytest.approx(np.array(missed), rel=1e-9)
