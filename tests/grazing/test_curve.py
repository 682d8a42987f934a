"""Grazing curves: every piece, every point, and their figure."""

from __future__ import annotations

from copy import copy
from dataclasses import fields, replace
from math import sin
from typing import Any

import numpy as np
import pytest
from grazing_starts import assert_oracle_grazes

from symosc import ParameterError, Parameters, load_scene
from symosc.grazing import curve
from symosc.grazing.curve import CurvePiece, grazing_curve
from symosc.grazing.phase_runs import PhaseRun
from symosc.grazing.solve import solve_grazing
from symosc.grazing.start import grazing_start
from symosc.grazing.tracer import NOWHERE, OTHER, OWN, UNKNOWN, Tracer
from symosc.plot.windows import figure_grazing_curve


@pytest.mark.parametrize(("scene", "mapping"), [("fig10", "P5"), ("fig9", "P3"), ("fig6", "P2"), ("fig7-exact", "P2")])
def test_curve(scene: str, mapping: str) -> None:
    p = load_scene(scene).parameters
    curve = grazing_curve(p, mapping, 100)
    assert curve.pieces
    for piece in curve.pieces:
        middle = len(piece.theta_m) // 2
        for i in (3, middle, -4):
            start = grazing_start(p, mapping, float(piece.theta_m[i]))
            assert start.found
            assert abs(start.x - piece.x[i]) < 1e-8 * max(1.0, abs(start.x))
            assert abs(sin(0.5 * (start.theta - piece.theta[i]))) < 1e-8
        # the printed derivatives against differences
        at, step = float(piece.theta_m[middle]), 1e-5
        before, after = curve.sample(at - step), curve.sample(at + step)
        for name in ("x", "theta"):
            slope = (getattr(after, name) - getattr(before, name)) / (2 * step)
            assert abs(slope - getattr(piece, f"slope_{name}")[middle]) < 1e-5 * max(1.0, abs(slope))
        for end, inward in ((piece.low, 1), (piece.high, -1)):
            assert_end_is_located(p, mapping, end, inward, curve)


def assert_end_is_located(p: Parameters, mapping: str, end: Any, inward: int, curve: Any) -> None:
    """1e-7 inside the end there is a start, 1e-7 beyond there is none, or another one."""
    if end.reason == "closed":
        return
    inside = grazing_start(p, mapping, end.theta_m + inward * 1e-7)
    assert inside.found
    if end.reason == "end of the window":
        with pytest.raises(ParameterError):
            grazing_start(p, mapping, end.theta_m - inward * 1e-7)
        return
    beyond = grazing_start(p, mapping, end.theta_m - inward * 1e-7)
    if "on the way" in end.reason:
        assert abs((inside.t_m - inside.t) - (beyond.t_m - beyond.t)) > 1e-2
    else:
        assert not beyond.found


def test_solutions_with_one_unknown_given() -> None:
    p = load_scene("fig10").parameters
    known = grazing_start(p, "P6", 4)
    given = {"theta_m": 4, "theta_j": 4, "x_j": known.x_m, "theta_i": known.theta, "x_i": known.start["x0"]}
    for name, value in given.items():
        found = solve_grazing(p, "P6", n=100, **{name: value})
        assert any(abs(start.theta_m - 4) < 1e-9 and abs(start.x - known.x) < 1e-9 for start in found), name
    # a start of the same x that grazes at another phase: the curve has an extremum of x
    others = solve_grazing(p, "P6", n=100, x_i=known.start["x0"])
    assert len(others) == 2
    for start in others:
        assert_oracle_grazes(p, start)
    assert solve_grazing(p, "P6", n=100, x_i=1000) == []
    assert solve_grazing(p, "P6", x_j=1000) == []
    assert solve_grazing(p, "P6", theta_m=1) == []
    with pytest.raises(ParameterError):
        solve_grazing(p, "P6", x_i=1, x_j=1)


def test_curve_of_an_empty_window_and_its_figure() -> None:
    curve = grazing_curve(load_scene("fig8").parameters, "P2", 50)
    assert (curve.pieces, curve.gaps, curve.windows) == ((), (), ())
    assert len(figure_grazing_curve(curve).axes) == 2


def test_figure_shows_every_piece() -> None:
    curve = grazing_curve(load_scene("fig10").parameters, "P5", 50)
    plane, flight = figure_grazing_curve(curve).axes
    assert len(flight.lines) == sum(1 + 2 for _ in curve.pieces)  # a line and two ends each
    assert len(flight.patches) == len(curve.gaps)
    assert plane.get_title()


def test_pieces_are_equal_if_all_their_columns_and_ends_are() -> None:
    piece = grazing_curve(load_scene("fig9").parameters, "P2", 30).pieces[0]
    names = [each.name for each in fields(piece)]
    values = {name: getattr(piece, name) for name in names}
    assert piece == CurvePiece(**{name: copy(value) for name, value in values.items()})
    for name, value in values.items():
        other = replace(value, reason="another") if name in ("low", "high") else value + (np.arange(len(value)) == 3)
        assert piece != CurvePiece(**values | {name: other})
    assert piece != values


def test_a_curve_is_made_of_the_runs_from_its_belt_and_gaps_of_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    p = load_scene("fig9").parameters
    sample = Tracer(p, "P2").sample(1.0)
    runs = [
        PhaseRun([replace(sample, origin=origin)] * 2, (low, low + 0.5), ("begins", "ends"))
        for low, origin in ((0.0, OWN), (0.5, UNKNOWN), (1.0, OTHER), (1.5, OWN), (2.0, NOWHERE))
    ]
    monkeypatch.setattr(curve, "cut", lambda *_: runs)
    monkeypatch.setattr(curve, "filled", lambda tracer, run: run)
    found = grazing_curve(p, "P2", 8)
    assert found.gaps == ((0.5, 1.0, UNKNOWN), (1.0, 1.5, OTHER), (2.0, 2.5, NOWHERE))
    assert [(each.low.theta_m, each.high.theta_m) for each in found.pieces] == [(0.0, 0.5), (1.5, 2.0)]
    assert {(each.low.reason, each.high.reason, each.low.x) for each in found.pieces} == {("begins", "ends", sample.x)}


def test_progress_tells_the_part_of_the_phases() -> None:
    parts: list[float] = []
    p = load_scene("fig9").parameters
    curve = grazing_curve(p, "P2", 40, progress=lambda part, all: parts.append(part / all))
    assert curve == grazing_curve(p, "P2", 40)
    assert parts == [n / 40 for n in range(1, 41)]
    parts.clear()
    solve_grazing(p, "P2", x_i=4, n=40, progress=lambda part, all: parts.append(part / all))
    assert parts[-1] == 1.0
