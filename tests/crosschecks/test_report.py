"""What a cross-check says: every finding is in the summary and in the plain data, long lists are cut."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import load_scene, simulate


def test_a_right_solution_in_words() -> None:
    t = np.linspace(0, 7, 200)
    x, v = simulate("fig5", t_end=7)(t)
    result = crosscheck("fig5", t, x, v)
    lines = result.summary().splitlines()
    assert lines[0] == "ok: 200 samples, tolerance 1e-08 per step"
    assert "wrong steps: 0 of 199" in lines[1]
    assert lines[3] == f"events: {len(simulate('fig5', t_end=7).events)} matched, 0 missed, 0 invented, " + (
        "0 within the global error"
    )


def test_long_lists_are_cut_and_counted() -> None:
    t = np.linspace(0, 7, 200)
    x, v = simulate("fig5", t_end=7)(t)
    given = [(0.3 + 0.1 * i, "cross") for i in range(8)]
    result = crosscheck("fig5", t, x, v, events=given)
    exact = simulate("fig5", t_end=7).events
    assert not result.ok
    assert len(result.invented) == 8
    assert len(result.missed) == len(exact)
    lines = result.summary().splitlines()
    assert lines[0].startswith("FAILED")
    assert [line for line in lines if line.startswith("invented")] == [
        *(f"invented: cross at t = {time:.10g}" for time, _ in given[:5]),
        "invented: and 3 more",
    ]
    missed = [f"missed: {event.kind} on belt {event.boundary} at t = {event.t:.10g}" for event in exact]
    assert [line for line in lines if line.startswith("missed")] == missed[:5]


def test_plain_data_is_the_result() -> None:
    t = np.linspace(0, 7, 200)
    x, v = simulate("fig5", t_end=7)(t)
    v[100] += 0.1
    result = crosscheck("fig5", t, x, v)
    data = json.loads(json.dumps(result.as_dict()))
    assert data["ok"] is False
    assert data["wrong_steps"] == [99, 100]
    assert data["first_wrong"]["words"] == "without sample 100 the step from 99 to 101 is right"
    assert len(data["matched"]) == len(result.matched)
    assert (data["max_error_x"], data["max_error_v"]) == (result.max_error_x, result.max_error_v)
    assert [data["max_defect_x"], data["max_defect_v"]] == np.abs(result.defects).max(axis=0).tolist()
    assert data["max_defect_x"] != data["max_defect_v"]
    worst = f"{data['max_defect_x']:.2e} in x, {data['max_defect_v']:.2e} in v; wrong steps: 2 of 199"
    assert f"largest defect of a step: {worst}" in result.summary()
    assert f"first wrong step: {99}" in result.summary() or "without sample 100" in result.summary()


@pytest.mark.parametrize("which", [0, 2])
def test_the_largest_error_of_a_time_is_named(which: int) -> None:
    t = np.linspace(0, 7, 200)
    run = simulate("fig5", t_end=7)
    given = [(event.t + (-3e-9 if i == which else 1e-10), event.kind) for i, event in enumerate(run.events)]
    result = crosscheck("fig5", t, *run(t), events=given)
    assert result.ok
    assert len(result.matched) > 2
    worst = run.events[which]
    assert f"largest error of an event's time: 3.00e-09 at t = {worst.t:.10g}" in result.summary()


def test_what_is_probably_wrong_is_in_the_summary_with_its_evidence() -> None:
    """... and with what the samples cannot tell from it; that samples are rounded is a note already."""
    t = np.linspace(0, 7, 300)
    for k, digits in ((1.1, 15), (1, 5)):
        x, v = simulate(load_scene("fig5").parameters.replace(k=k), t0=0, x0=0, v0=0, t_end=7)(t)
        result = crosscheck("fig5", t, np.round(x, digits), np.round(v, digits))
        assert result.diagnosis
        told = [each for one in result.diagnosis if one.cause != "precision" for each in (one, *one.alternatives)]
        expected = [f"{each.words} ({each.evidence})" for each in told]
        lines = [line.partition(": ")[2] for line in result.summary().splitlines() if line.startswith("diagnosis: ")]
        assert [line.removeprefix("or: ") for line in lines] == expected
        assert bool(expected) == (digits == 15)


def test_a_start_that_is_rounded_is_the_scenes() -> None:
    scene = replace(load_scene("fig9"), t0=Fraction(0), x0=Fraction("0.123449"), v0=Fraction("0.654351"))
    t = np.linspace(0, 7, 300)
    x, v = simulate(scene, t_end=7)(t)
    for shift, told in ((0.0, False), (0.01, True)):
        result = crosscheck(scene, t, np.round(x + shift, 3), np.round(v, 3))
        assert any("the solution starts at t0 = 0, x0 = 0.13" in note for note in result.notes) == told
