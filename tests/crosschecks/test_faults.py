"""Guesses why a step is wrong: a step that is made wrong in a known way is called so."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import load_scene, simulate
from symosc.crosschecks.faults import REASONS, explain

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


# --- one reason against the next, on steps that are made up ---


class Steps(SimpleNamespace):
    """Three samples and the steps between; `flight` misses the next sample by what is told for each domain."""

    def flight(self, domain: int, since: np.ndarray, until: np.ndarray) -> np.ndarray:
        gap = self.misses.get((domain, int(until[0])), (9.0, 9.0))
        return np.array([[self.x[until[0]] + gap[0], self.v[until[0]] + gap[1]]])


def made_up(**told: Any) -> tuple[str, str]:
    """Return the reason for a step from 0 to 1, and its words; nothing is odd about the step but what is told."""
    value = {
        "first": 2, "last": 2, "found": 2, "before": 2, "v": (0.5, 0.5, 0.5), "times": (), "targets": (), "misses": {},
        "size": 10.0, "defect": (1.0, 1.0), "near": 1e-3, "t": (0.0, 1.0, 2.0), "belts": (),
    } | told  # fmt: skip
    events = SimpleNamespace(
        target=np.array(value["targets"], int),
        t=np.array(value["times"], float),
        boundary=np.array(value["belts"] or [1] * len(value["times"]), int),
        rows=lambda first, last: slice(None),
    )
    K = SimpleNamespace(belt1=SimpleNamespace(v=0.0), belt2=SimpleNamespace(v=2.0), period=1.0)
    n = len(value["t"])
    steps = Steps(
        t=np.array(value["t"]), x=np.zeros(n), v=np.array(value["v"][:n]), first=np.full(n - 1, value["first"]),
        last=np.full(n - 1, value["last"]), defects=np.array([value["defect"]] * (n - 1)), events=events, K=K,
        misses=value["misses"],
    )  # fmt: skip
    modes, near = np.array([value["before"], value["found"], 2][:n]), np.full(n, value["near"])
    allowed = np.full((n - 1, 2), 0.1)
    (fault,) = explain(steps, [0], modes, np.full(n - 1, value["size"]), allowed, near)  # type: ignore[arg-type]
    assert fault.words
    assert (fault.defect_x, fault.defect_v) == pytest.approx(value["defect"], nan_ok=True)
    return fault.reason, fault.words


def test_a_force_explains_a_step_if_it_misses_by_a_fiftieth_of_it() -> None:
    """... or by what is allowed, if that is more: on both sides of the border, in x and in v."""
    for size, limit in ((10.0, 1.0), (50.0, 1.0), (1000.0, 20.0)):
        for part, explains in ((0.99, True), (1.01, False)):
            miss = 0.1 * limit * part
            for gap in ((miss, 0.0), (0.0, -miss)):
                reason, words = made_up(size=size, misses={(3, 1): gap})
                assert reason == ("wrong force" if explains else "local error")
                assert not explains or words == "the force of Omega3 explains the step, which lies in Omega2"
                assert made_up(size=size, misses={(2, 2): gap})[0] == ("outlier" if explains else "local error")


def test_the_reasons_come_in_their_order() -> None:
    """Each reason needs all its signs: without one of them the next reason that fits is given."""
    fits = {(3, 1): (0.0, 0.0)}
    event = {"times": (0.4,), "targets": (3,)}
    cases: list[tuple[dict[str, Any], str]] = [
        ({"size": np.nan, "t": (0.0, 0.0, 2.0)}, "undecidable"),
        ({"size": np.inf}, "undecidable"),
        ({"t": (0.0, 0.0, 2.0)}, "jump"),
        ({"last": 4, "found": 4, "v": (0.0, 1e-9, 0.0), "defect": (0.1, 1.0)}, "drift on the belt"),
        ({"last": 4, "found": 4, "v": (0.0, 1e-9, 0.0), "defect": (0.11, 1.0)}, "local error"),
        ({"last": 4, "found": 4, "v": (0.0, 0.0, 0.0), "defect": (0.0, 1.0)}, "local error"),
        ({"last": 4, "found": 5, "v": (0.0, 1e-9, 0.0), "defect": (0.0, 1.0)}, "local error"),
        ({"last": 5, "found": 5, "v": (2.0, 2.0, 2.0), "defect": (0.0, 1.0)}, "local error"),
        ({"last": 5, "found": 5, "v": (2.0, 2.1, 2.0), "defect": (0.0, 1.0)}, "drift on the belt"),
        ({"misses": fits}, "wrong force"),
        ({"misses": fits, "first": 3, "found": 3}, "wrong force"),
        ({"misses": fits, "first": 4, "found": 3}, "event at the start"),
        ({"misses": fits, "first": 4, "found": 4}, "local error"),
        ({"misses": fits, **event}, "double root"),
        ({"first": 4, "found": 3}, "event at the start"),
        ({"first": 5, "found": 1}, "event at the start"),
        ({"misses": fits, "v": (1e-3, 0.5, 0.5), "times": (1e-7,), "targets": (3,)}, "event at the start"),
        ({"misses": fits, "v": (2.001, 0.5, 0.5), "times": (1e-6,), "targets": (3,)}, "event at the start"),
        ({"misses": fits, "v": (2.002, 0.5, 0.5), "times": (1e-6,), "targets": (3,)}, "sign tolerance"),
        ({"misses": fits, "v": (1e-3, 0.5, 0.5), **event}, "double root"),
        ({"misses": fits, "v": (1e-3, 0.5, 0.5), "first": 4, "found": 4}, "event at the start"),
        ({"times": (1e-6,), "targets": (3,)}, "sign tolerance"),
        ({"times": (2e-6,), "targets": (3,)}, "double root"),
        ({"times": (1e-6,), "targets": (3,), "found": 4}, "crossing inside the step"),
        ({"times": (1e-6,), "targets": (3,), "first": 4, "found": 4}, "crossing inside the step"),
        ({"found": 4, "before": 4}, "sign tolerance"),
        ({"found": 4, "before": 2}, "local error"),
        ({"found": 4, "before": 4, "last": 5}, "local error"),
        (event, "double root"),
        ({**event, "last": 3}, "crossing inside the step"),
        ({**event, "found": 3}, "crossing inside the step"),
        ({"misses": {(2, 2): (0.0, 0.0)}}, "outlier"),
        ({"misses": {(2, 2): (0.0, 0.0)}, "t": (0.0, 1.0)}, "local error"),
        ({"misses": {(1, 2): (0.0, 0.0)}}, "local error"),
        ({"misses": {(2, 2): (0.0, 0.0)}, "first": 4, "found": 4}, "local error"),
        ({}, "local error"),
    ]
    for told, reason in cases:
        assert made_up(**told)[0] == reason, told


def test_words_name_the_belt_the_force_and_the_times() -> None:
    fits = {(1, 1): (0.0, 0.0)}
    assert made_up(first=5, found=2)[1].startswith("the mass sticks to belt 2 here, the samples leave it (v - v1 = 0.5")
    assert made_up(v=(1.75, 0.5, 0.5), found=5, before=5)[1] == (
        "the mass leaves belt 2, the samples stay on it (v - v2 = -0.25 at its start)"
    )
    assert made_up(last=4, found=4, v=(0.0, -2e-9, 0.0), defect=(0.0, 1.0))[1] == (
        "v should be v1 in the stick and is off by -2e-09"
    )
    twice = {"times": (0.25, 0.5), "targets": (4, 2), "belts": (2, 1)}
    assert made_up(**twice)[1] == (
        "the motion meets belt 2 at t = 0.25 and is back at t = 0.5; signs at the ends of the step do not show it"
    )
    assert made_up(**twice, last=1)[1] == "Omega2 -> belt1 at t = 0.25"
    assert made_up(**twice, last=1, misses=fits)[1] == "Omega2 -> belt1 at t = 0.25; the force of Omega1 was kept"
    assert "samples 0 and 1" in made_up(t=(0.0, 0.0, 2.0))[1]
    assert "without sample 1 the step from 0 to 2 is right" in made_up(misses={(2, 2): (0.0, 0.0)})[1]
    assert "motion in Omega3" in made_up(first=3, found=3)[1]
