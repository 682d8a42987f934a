"""Guesses why a step is wrong: a step that is made wrong in a known way is called so."""

from __future__ import annotations

import numpy as np
import pytest

from symosc import crosscheck, load_scene, simulate
from symosc.crosschecks.faults import REASONS

T = np.linspace(0.5, 8, 801)


def samples(name: str = "fig9") -> tuple[np.ndarray, np.ndarray]:
    x, v = simulate(name, t_end=8)(T)
    return x.copy(), v.copy()


def flying(name: str, domain: str, least: int = 10) -> int:
    """Return a sample in the middle of a flight, far from its events."""
    motion = simulate(name, t_end=8)
    modes = [motion.mode(float(t)) for t in T]
    for i in range(least, len(T) - least):
        if set(modes[i - least : i + least]) == {domain}:
            return i
    raise AssertionError(domain)


@pytest.mark.parametrize(("name", "domain"), [("fig9", "Omega1"), ("fig9", "Omega2"), ("fig10", "Omega2")])
def test_one_sample_off_is_an_outlier(name: str, domain: str) -> None:
    x, v = samples(name)
    i = flying(name, domain)
    x[i] += 0.01
    result = crosscheck(name, T, x, v)
    assert result.wrong_steps.tolist() == [i - 1, i]
    fault = result.first_wrong
    assert fault is not None
    assert (fault.reason, fault.step, fault.t, fault.t_next) == ("outlier", i - 1, T[i - 1], T[i])
    assert (fault.expected, fault.found) == (domain, domain)
    assert not fault.wrong_decision
    assert fault.words == f"without sample {i} the step from {i - 1} to {i + 1} is right"
    assert (fault.defect_x, fault.defect_v) == pytest.approx((-0.01, 0), abs=1e-10)


@pytest.mark.parametrize(("here", "force"), [("Omega1", 2), ("Omega2", 1)])
def test_the_force_of_another_domain_is_named(here: str, force: int) -> None:
    """From a sample on, over one step, with the friction of another domain; from there on the true motion."""
    scene = load_scene("fig9")
    x, v = samples()
    i = flying("fig9", here)
    p, mine = scene.parameters, int(here[-1])
    # The same force is that of a system whose friction differs: A_mine of the other is A_force of this.
    step = T[i + 1] - T[i]
    push = float(p.A(force) - p.A(mine)) / float(p.m)
    rest = simulate(p, t0=float(T[i + 1]), x0=x[i] + (x[i + 1] - x[i]), v0=v[i + 1], t_end=8)
    assert rest.status == "t_end"
    # Its effect in a linear system: the response to a constant push, here by its series.
    c, k = float(p.c / p.m), float(p.k / p.m)
    dv = push * (step - c * step**2 / 2 + (c * c - k) * step**3 / 6 - (c**3 - 2 * c * k) * step**4 / 24)
    dx = push * (step**2 / 2 - c * step**3 / 6 + (c * c - k) * step**4 / 24)
    after = simulate(p, t0=float(T[i + 1]), x0=x[i + 1] + dx, v0=v[i + 1] + dv, t_end=8)
    x[i + 1 :], v[i + 1 :] = after(T[i + 1 :])
    fault = crosscheck(scene, T, x, v).first_wrong
    assert fault is not None
    assert (fault.step, fault.reason) == (i, "wrong force")
    assert fault.words == f"the force of Omega{force} explains the step, which lies in {here}"


@pytest.mark.slow
def test_a_jump_where_two_pieces_are_joined() -> None:
    x, v = samples()
    i = flying("fig9", "Omega2")
    t, x, v = (np.insert(column, i + 1, column[i]) for column in (T, x, v))
    x[i + 1 :] += 1e-5
    fault = crosscheck("fig9", t, x, v).first_wrong
    assert fault is not None
    assert (fault.step, fault.reason) == (i, "jump")
    assert fault.words == f"samples {i} and {i + 1} are at one time and differ"


def test_a_step_too_far_is_a_local_error() -> None:
    """All later samples are those of the motion from there: nothing but the one step is wrong."""
    x, v = samples()
    i = flying("fig9", "Omega2")
    after = simulate(load_scene("fig9").parameters, t0=float(T[i]), x0=x[i] + 1e-4, v0=v[i], t_end=8)
    x[i:], v[i:] = after(T[i:])
    result = crosscheck("fig9", T, x, v)
    assert result.wrong_steps.tolist() == [i - 1]
    assert result.first_wrong is not None
    assert result.first_wrong.reason == "local error"
    assert result.first_switching is None


def test_every_reason_has_words() -> None:
    assert all(len(words) > 5 for words in REASONS.values())
