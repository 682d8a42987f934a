"""Exact steps from every sample."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import load_scene, simulate
from symosc.crosschecks import steps
from symosc.crosschecks.steps import phases
from symosc.simulation import batch


def test_phases_at_large_times() -> None:
    rng = np.random.default_rng(7)
    p = load_scene("fig10").parameters.replace(Omega="1/3")
    t = np.concatenate([10.0 ** rng.uniform(-3, 14, 200), [0.0, -1.5]])
    _, theta = phases(p, t)
    import mpmath

    with mpmath.workdps(50):
        exact = [float(mpmath.fmod(mpmath.mpf(time) / 3, 2 * mpmath.pi)) for time in t]
    np.testing.assert_allclose(theta, exact, rtol=0, atol=2e-15)


def test_periods_and_phase_are_the_time() -> None:
    """Just before the end of a period the phase rounds to 2 pi, which is 0 of the next one."""
    p = load_scene("fig10").parameters.replace(Omega=1)
    ends = 2 * np.pi * np.arange(1, 40)
    times = np.concatenate([ends, np.nextafter(ends, 0), np.nextafter(ends, 1e3), [-1e-17, 0.0, 3.0]])
    periods, theta = phases(p, times)
    assert np.all((theta >= 0) & (theta < 2 * np.pi))
    assert (periods[0], theta[0]) == (1, 0.0)  # the double 2 pi is 2.4e-16 too small
    np.testing.assert_allclose(2 * np.pi * periods + theta, times, rtol=4e-16, atol=4e-16)


def test_many_steps_do_not_wait_for_a_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    """To compile takes twenty seconds, to interpret some thousand steps a part of one."""
    pytest.importorskip("numba")
    batch.chosen_loops(None)  # binds the functions that are compiled, once, before one is another
    interpreted, loop = [], batch.FOLLOW

    def noted(begin: int, *rest: Any) -> Any:
        interpreted.append(begin)
        return loop(begin, *rest)

    monkeypatch.setattr(batch, "FOLLOW", noted)
    monkeypatch.setattr(batch, "is_compiled", lambda _: False)
    monkeypatch.setattr(batch, "DOUBLES", batch.InterpretBudget(1_000_000))
    monkeypatch.setattr(steps, "COMPILE_FROM", 300)
    monkeypatch.setattr(steps, "quiet_ends", lambda *_: (np.empty(0, int), np.empty((0, 2))))
    scene = load_scene("fig9")
    t = np.linspace(float(scene.t0), 8, 301)
    exact = simulate(scene, t_end=8)
    result = crosscheck(scene, t, *exact(t))
    assert result.ok
    assert [match.event for match in result.matched] == list(exact.events)
    assert set(range(300)) <= set(interpreted)


def test_few_steps_again_and_again_are_a_matter_of_the_compiler_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first ones are interpreted and count; when there were many, compiled code is asked for."""
    asked, choose = [], batch.chosen_loops

    def noted(use_numba: bool | None) -> batch.Loops:
        asked.append(use_numba)
        return choose(False)

    monkeypatch.setattr(steps, "chosen_loops", noted)
    monkeypatch.setattr(steps, "FEW_STEPS", batch.InterpretBudget(1))
    t = np.linspace(0.0, 7.0, 100)
    crosscheck("fig5", t, *simulate("fig5", t_end=7)(t))
    assert set(asked) == {False}
    assert steps.FEW_STEPS.events < 0
    crosscheck("fig5", t, *simulate("fig5", t_end=7)(t))
    assert asked[-1] is None
