"""The hard cases: what they say of themselves, condition numbers, our errors, the table, the error map."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from math import inf, isnan, nan
from typing import Any

import mpmath
import numpy as np
import pytest
from bench_moods import moody
from oracle import flow_oracle, simulate_oracle

from symosc import Parameters, Scene, load_scene, simulate
from symosc.bench import error_map, hard, hard_table, ours
from symosc.bench.condition import conditions, distance, shifted
from symosc.bench.hard_cases import (
    GROUPS,
    LATE_PERIODS,
    PEAKS,
    HardCase,
    hard_cases,
    start_before_a_dip,
    start_before_a_peak,
)
from symosc.bench.plot_error_map import figure
from symosc.bench.solvers import Solver
from symosc.engine.flow import constants
from symosc.exact import show
from symosc.kernels import entire
from symosc.mappings.theorem7_cases import place

CASES = {(case.group, case.name): case for case in hard_cases()}
ONE_OF_EACH = {case.group: case for case in hard_cases() if case.quick}


# -- the cases ---------------------------------------------------------------------------------------------------------


def test_every_group_has_cases_and_a_quick_one() -> None:
    assert {case.group for case in hard_cases()} == set(GROUPS) == set(ONE_OF_EACH)
    assert len(CASES) == len(hard_cases())
    for case in hard_cases():
        if not case.periods:  # nobody loses digits in reading them
            assert max(len(show(getattr(case.scene, name)).strip("-0.")) for name in ("t0", "x0", "v0")) <= 18, (
                case.name
            )


@pytest.mark.parametrize(("base", "mapping", "t_m", "t0", "exponent"), [(*row[:4], e) for row in PEAKS for e in row[5]])
@pytest.mark.parametrize("side", [1, -1])
def test_peaks_are_as_far_from_the_belt_as_said(
    base: str, mapping: str, t_m: str, t0: str, exponent: int, side: int
) -> None:
    """By the exponential of the ODE's matrix: v there, and where the acceleration is 0."""
    p, where = load_scene(base).parameters, place(mapping)
    height = Fraction(side, 10**exponent)
    start = start_before_a_peak(p, mapping, height, t_m, t0)
    with mpmath.workdps(50):
        _, v, a = flow_oracle(p, where.domain, *start, Fraction(t_m) - Fraction(t0))
        beyond = (v - mpmath.mpf(p.belt(where.boundary).numerator)) * (1 if where.domain == where.boundary else -1)
        assert abs(beyond - mpmath.mpf(height.numerator) / height.denominator) < 4e-16
        assert abs(a) < 1e-14


def test_a_peak_without_a_flight_before_it_is_refused() -> None:
    p = load_scene("fig10").parameters
    with pytest.raises(ValueError, match=r"no flight from t = 0.5 peaks at t = 1: .*belt 1"):
        start_before_a_peak(p, "P5", Fraction(1, 10**8), "1", "0.5")


@pytest.mark.parametrize("height", ["-1e-6", "1e-12"])
def test_dips_are_as_deep_as_said(height: str) -> None:
    p = load_scene("fig5").parameters  # m = c = k = v1 = 1, B0 = 10, Omega = 1
    t0, x0, _ = start_before_a_dip(p, height, "2.5")
    with mpmath.workdps(40):
        least = mpmath.pi + mpmath.asin(mpmath.mpf(1) / 10)  # where d/dt (10 cos(t) - t) = 0 and rises
        x = mpmath.mpf(x0) + least - mpmath.mpf(t0)
        force = mpmath.mpf(p.A(1).numerator) / p.A(1).denominator + 10 * mpmath.cos(least) - x - 1
        assert abs(force - mpmath.mpf(height)) < 1e-15


# The oracle's power series takes seconds to minutes for these rates; the next stiffest cases are with it.
TOO_STIFF = {"m = 1e-5", "m = 1e-8"}
FOR_THE_ORACLE = [case for case in hard_cases() if not case.periods and case.name not in TOO_STIFF]


@pytest.mark.slow
@pytest.mark.parametrize("case", FOR_THE_ORACLE, ids=lambda case: case.name)
def test_references_agree_with_the_oracle(case: HardCase) -> None:
    scene, most = case.scene, 6
    reference = case.reference()[:most]
    end = min(scene.t_end, Fraction(str(reference[-1].t)) + 1) if reference else scene.t_end
    run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, end, 45, max_events=most)
    assert len(run.events) >= len(reference)
    for event, expected in zip(reference, run.events, strict=False):
        assert (event.kind, event.boundary, event.source, event.target) == expected[1:5]
        assert max(distance(event.t, expected.t), distance(event.x, expected.x)) < 1e-34


def test_long_runs_end_with_the_orbit() -> None:
    """After few periods the motion is the orbit to many digits: the same events as in any later period."""
    case = CASES["1e5 periods", "fig10-orbit"]
    period = 2 * mpmath.pi / mpmath.mpf("1.75")
    end = case.scene.t0 + Fraction(str(20.05 * period))
    early = replace(case.scene, t_end=end)
    expected = simulate(early, digits=20).events
    assert len(expected) == 20 * 4
    for event, other in zip(case.reference(early, 30), expected[-4:], strict=True):
        assert (event.kind, event.boundary) == (other.kind, other.boundary)
        assert max(distance(event.t, other.t), distance(event.x, other.x)) < 1e-19
    turns = (case.scene.t_end - case.scene.t0) / Fraction(str(period))
    assert LATE_PERIODS < turns < LATE_PERIODS + 0.1
    last = case.reference()[-1]
    assert 0 < case.scene.t_end - Fraction(float(last.t)) < Fraction(1)


# -- condition numbers -------------------------------------------------------------------------------------------------


def test_the_condition_of_a_constant_acceleration() -> None:
    """With A = A0 + (mu1 + mu2) FN, v = v0 + A t/m meets v1 after m (v1 - v0)/A, at x0 + m (v1^2 - v0^2)/(2 A)."""
    p = Parameters(m=3, c=0, k=0, A0=1, B0=0, Omega=1, v1=5, v2=9, mu1="0.3", mu2="0.2", FN=2)
    scene = Scene("constant", p, Fraction(7), Fraction(11), Fraction(-1), Fraction(30))
    m, A, v1, v0, x0, t0 = 3, 2, 5, -1, 11, 7
    passed, way = m * (v1 - v0) / A, m * (v1**2 - v0**2) / (2 * A)
    shares = (1, 0.6, 0.4, 1)  # A0, mu1 FN, mu2 FN, FN itself, as parts of A
    by_force = sum(shares) / A
    t = (t0 + passed * (1 + by_force) + m * (v1 + abs(v0)) / A) / (t0 + passed)
    x = (x0 + way * (1 + by_force) + m * (v1**2 + v0**2) / A) / (x0 + way)
    assert conditions(scene)[0] == pytest.approx(max(t, x), rel=1e-12)


@pytest.mark.slow
def test_near_a_graze_the_condition_grows_with_the_root_of_the_distance() -> None:
    worst = [max(conditions(CASES["peak beyond a belt", f"by 1e-{n} (P2, fig7-corrected)"].scene)) for n in (7, 11)]
    assert worst[1] / worst[0] == pytest.approx(100, rel=0.01)


def test_a_start_on_a_belt_moves_with_it() -> None:
    scene, step = load_scene("fig9"), Fraction(1, 8)
    assert shifted(scene, "v0", step) == scene
    moved = shifted(scene, "v1", step)
    assert moved.v0 == moved.parameters.v1 == Fraction(9, 8)
    assert shifted(scene, "v2", step).v0 == 1
    assert shifted(scene, "x0", step).x0 == scene.x0 * 9 / 8
    assert shifted(scene, "m", step).parameters == scene.parameters.replace(m="0.1125")


def test_numbers_that_are_zero_do_not_count() -> None:
    assert shifted(load_scene("fig5"), "t0", Fraction(1, 8)) == load_scene("fig5")


def test_events_that_any_change_turns_into_others_have_no_condition() -> None:
    scene = load_scene("fig5")
    first, second, third = simulate(scene, digits=130, max_events=3).events

    def touching(neighbour: Scene, digits: int) -> Any:
        k = neighbour.parameters.k
        graze = replace(second, kind="graze" if k == scene.parameters.k else "stick")
        return [replace(first, t=first.t + digits_of(k - scene.parameters.k, first)), graze, third]

    def digits_of(value: Fraction, event: Any) -> Any:
        return event.t.context.mpf(value.numerator) / value.denominator

    found = conditions(scene, touching)
    assert found[0] == pytest.approx(float(1 / max(1, first.t)))
    assert found[1:] == [inf, inf]


# -- our errors --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("group", GROUPS)
def test_ours_keep_the_bound_in_every_group(group: str) -> None:
    case = ONE_OF_EACH[group]
    allowed = [hard.bound(condition) for condition in hard.conditions_of(case)]
    for solver in ours.SOLVERS:
        if solver.missing or (case.periods and "mpmath" in solver.name):
            continue
        cell = hard.judge(solver, case, allowed)
        assert (cell["missed"], cell["invented"], cell["undecidable"]) == (0, 0, None)
        assert cell["worst"] is not None
        assert cell["worst"] <= 1
        assert cell["error"] is None or 0 < cell["error"] < (1e-20 if "mpmath" in solver.name else 1e-12)


def test_the_bound() -> None:
    assert hard.bound(3.0) == 1e-12
    assert hard.bound(1e6) == pytest.approx(1e-8)
    assert hard.bound(inf) == inf


# -- the run and its table ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_failures_are_shown_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hard, "CASE_LIMIT", 1.5)
    scene = replace(load_scene("fig9"), t_end=Fraction(3))
    names = ("works", "misses", "invents", "refuses", "chatters", "dies", "sleeps")
    cases = [HardCase(name, "easy", replace(scene, name=name), name in ("works", "misses")) for name in names]
    solvers = [Solver("moody", moody, (1e-3, 1e-9)), Solver("as it comes", moody, (1e-6,), raw=True)]
    solvers += [Solver("absent", moody, (0.0,), needs="no_such_module"), ours.SOLVERS[1]]
    steps: list[Any] = []

    def progress(planned: Any) -> Any:
        for step in planned:
            steps.append(step)
            yield step

    result = hard.run(progress=progress, solvers=solvers, cases=cases)
    json.dumps(result)
    assert len(steps) == 7 + 7 + 2 + 7
    cells = {row["case"]: hard_table.cell_text(row["cells"]["moody"], 1.5) for row in result["rows"]}
    assert cells == {
        "works": "2e-10",
        "misses": "missed 1",
        "invents": "invented 1",
        "refuses": "exception: ValueError: not this one",
        "chatters": "chatters",
        "dies": "crash: the process ended with exit code 3",
        "sleeps": "> 1.5 s",
    }
    assert result["ok"]
    assert not result["violations"]
    text = hard.table(result)
    assert "ValueError [1]" in text
    assert "[1] exception: ValueError: not this one" in text
    assert "crash [2]" in text
    assert "2 of 7" not in text
    assert "1 of 7" in text
    raw = hard.table(result, "github", raw=True)
    assert "| `misses`" in raw
    assert "refuses" not in raw
    assert "1 of 2" in raw
    assert "1 of 7: 2e-10" in hard.summary(result)
    assert any("absent: no_such_module is not installed" in line for line in hard.legend(result))


def row(**cell: Any) -> dict[str, Any]:
    good = {"failure": "", "error": 1e-16, "missed": 0, "invented": 0, "found": 2, "worst": 0.1, "undecidable": None}
    cells = {solver.name: good | cell for solver in ours.SOLVERS[:1]}
    return {"group": "easy", "case": "a", "events": 2, "condition": 3.0, "cells": cells}


@pytest.mark.parametrize(
    ("cell", "text"),
    [
        ({"worst": 1.5, "error": 2e-12}, "2e-12"),
        ({"worst": None, "missed": 2, "undecidable": 1}, "undecidable after 1"),
        ({"worst": None, "missed": 2, "invented": 1}, "missed 2, invented 1"),
        ({"worst": None, "failure": "exception: ZeroDivisionError"}, "exception: ZeroDivisionError"),
    ],
)
def test_what_ours_must_not_do(cell: dict[str, Any], text: str) -> None:
    assert hard.violations([row(), row(error=None), row(failure="hang", worst=None)]) == []
    assert hard.violations([row(), row(**cell)]) == [f"{ours.SOLVERS[0].name}: easy, a: {text}"]


def test_the_verdict_names_violations() -> None:
    name = ours.SOLVERS[0].name
    result = {"rows": [row(), row(error=3e-13)], "violations": [], "solvers": [{"name": name, "ours": True}]}
    assert f"{name} in 2 of 2 cases, largest error 3e-13" in hard_table.verdict(result)
    result["violations"] = [f"{name}: easy, a: 2e-12"]
    assert hard_table.verdict(result).startswith("Not within")
    assert "easy, a: 2e-12" in hard_table.verdict(result)


# -- the error map -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def errors() -> dict[str, Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(error_map, "BORDER_POINTS", 31)
        return error_map.run(quick=True)


def test_places_and_values() -> None:
    for text in ("1e-9", "0.3", "0.5", "0.75", "1", "1.5", "2", "70"):
        assert float(error_map.value_at(error_map.place_of(float(text)))) == pytest.approx(float(text), rel=1e-12)
    for beyond in (1e-9, -1e-9):
        value = error_map.value_at(error_map.place_of(1, beyond))
        assert float(value - 1) == pytest.approx(beyond, rel=1e-6)
    places = error_map.axis(-2, 2, 25)
    assert len(places) == 25
    assert np.all(np.diff(places) > 0)
    assert [float(error_map.value_at(place)) for place in places[[0, -1]]] == pytest.approx([0.01, 100])
    assert Fraction(1) in [error_map.value_at(place) for place in places]


@pytest.mark.slow
def test_symosc_is_exact_all_over_the_map(errors: dict[str, Any]) -> None:
    assert errors["largest"] < 50 * 2.0**-52
    assert np.nanmax(errors["symosc"]) == errors["largest"]
    assert errors["largest"] > 2.0**-53  # it is measured


@pytest.mark.slow
def test_the_border_is_needed(errors: dict[str, Any]) -> None:
    """On its side of the border the cheap formula is good to 50 ulp, on the other side it loses up to all digits."""
    inside, outside = [], []
    for n, tau in enumerate(errors["taus"]):
        for i, zeta in enumerate(errors["zeta"]):
            for j, ratio in enumerate(errors["ratio"]):
                K = constants(error_map.parameters(error_map.value_at(zeta), error_map.value_at(ratio)))
                value = errors["cheap"][n][i][j]
                if not isnan(value):
                    (inside if error_map.formula_of(tau, K) == "apart" else outside).append((tau, value))
    assert max(value for _, value in inside) < 50 * 2.0**-52
    assert max(value for tau, value in outside if tau >= 1) > 1e-9
    assert max(value for _, value in outside) > 1
    assert len(inside) > 200


def test_the_named_formula_is_the_one_that_is_taken() -> None:
    p = error_map.parameters(Fraction(1, 10), Fraction(1, 2))
    for parameters, tau, name in (
        (p, 3.0, "apart"),
        (p, 0.1, "series"),
        (p.replace(Omega=1, c=0), 3.0, "careful"),
        (p.replace(c=4), 3.0, "careful"),
    ):
        K = constants(parameters)
        assert error_map.formula_of(tau, K) == name
        cheap = error_map.closed_form(tau, K)[:5] if K.under and K.p else (nan,) * 5
        assert (entire.basis(tau, K)[:5] == cheap) == (name == "apart")


@pytest.mark.slow
def test_the_picture_of_the_map(errors: dict[str, Any]) -> None:
    drawing = figure(errors)
    panels = [ax for ax in drawing.axes if ax.get_title()]
    assert len(panels) == 2 * len(errors["taus"])
    words = {text.get_text() for ax in panels for text in ax.texts}
    assert {"cheap", "careful", "series"} <= words
    drawing.draw_without_rendering()
