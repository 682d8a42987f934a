"""Grazing curves: every piece, every point, and how they are cut where the flow comes from elsewhere."""

from __future__ import annotations

import random
from itertools import pairwise
from math import cos, nan, pi, sin
from types import SimpleNamespace
from typing import Any

import pytest
from grazing_starts import assert_oracle_grazes

from symosc import ParameterError, Parameters, load_scene
from symosc.grazing import curve
from symosc.grazing.curve import NOWHERE, OTHER, OWN, UNKNOWN, Sample, grazing_curve
from symosc.grazing.solve import solve_grazing
from symosc.grazing.start import grazing_start


@pytest.mark.parametrize(
    ("scene", "mapping"), [("fig10", "P5"), ("fig9", "P3"), ("fig6", "P2"), ("fig7-exact", "P2")]
)
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
        at = float(piece.theta_m[middle])
        step = 1e-5
        before = curve.sample(at - step)
        after = curve.sample(at + step)
        for name in ("x", "theta"):
            slope = (getattr(after, name) - getattr(before, name)) / (2 * step)
            assert abs(slope - getattr(piece, f"slope_{name}")[middle]) < 1e-5 * max(
                1.0, abs(slope)
            )
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
    arguments = {
        "theta_m": 4,
        "theta_j": 4,
        "x_j": known.x_m,
        "theta_i": known.theta,
        "x_i": known.start["x0"],
    }
    for name, value in arguments.items():
        solutions = solve_grazing(p, "P6", n=100, **{name: value})
        assert any(
            abs(start.theta_m - 4) < 1e-9 and abs(start.x - known.x) < 1e-9 for start in solutions
        ), name
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


class MadeUp:
    """A tracer whose flows come from where a list of stretches says.

    On its own belt theta is a formula of theta_m.
    """

    def __init__(self, stretches: list[tuple[float, str, float]], slope: float = 0.5) -> None:
        self.stretches, self.slope = stretches, slope  # (where it begins, origin, shift of theta)
        self.place = SimpleNamespace(boundary=1)
        self.asked = 0

    def sample(self, theta_m: float, careful: bool = True) -> Sample:
        self.asked += 1
        _, origin, shift = [item for item in self.stretches if item[0] <= theta_m][-1]
        if origin not in (OWN, OTHER):
            return Sample(theta_m, 0.0, origin, nan, nan, nan, nan)
        return Sample(
            theta_m,
            cos(theta_m),
            origin,
            theta_m**2,
            self.slope * theta_m - shift,
            2 * theta_m,
            self.slope,
        )


def runs_of(tracer: MadeUp, arc: tuple[float, float, bool], n: int) -> list[curve.PhaseRun]:
    return curve._cut(
        tracer, [tracer.sample(float(theta)) for theta in curve._phases_of(*arc, n)], arc
    )  # type: ignore[arg-type]


@pytest.mark.parametrize("closed", [False, True])
def test_a_curve_is_cut_where_the_flow_comes_from_elsewhere_and_where_it_jumps(
    closed: bool,
) -> None:
    """Every stretch is found, its ends to rounding, with its reason.

    Each sample is in the run of its origin.
    """
    rng = random.Random(1)
    for _ in range(60):
        if closed:
            low, high = (0.0, 2 * pi)
        else:
            low, high = (0.3, 5.1)
        cuts = sorted(rng.uniform(low, high) for _ in range(rng.randint(0, 4)))
        if any(b - a < 0.3 for a, b in pairwise([low, *cuts, high])):
            continue
        origins = [rng.choice([OWN, OWN, OTHER, NOWHERE]) for _ in range(len(cuts) + 1)]
        shifts = [1.0 + 0.7 * i for i in range(len(origins))]
        tracer = MadeUp(list(zip([low - 1, *cuts], origins, shifts, strict=True)))
        runs = runs_of(tracer, (low, high, closed), 25)
        # neighbours of one origin are one run, unless theta jumps on the own belt
        due = [[low, origins[0], shifts[0]]]
        for cut, origin, shift in zip(cuts, origins[1:], shifts[1:], strict=True):
            if origin == OWN or origin != due[-1][1]:
                due.append([cut, origin, shift])
        ends = [*(item[0] for item in due[1:]), high]
        if closed and len(due) > 1 and due[0][1] == due[-1][1]:
            spans = [
                *zip((item[0] for item in due[1:-1]), ends[1:-1], strict=True),
                (due[-1][0], ends[0] + 2 * pi),
            ]
            kinds = [*(item[1] for item in due[1:-1]), due[0][1]]
        else:
            spans = list(zip((item[0] for item in due), ends, strict=True))
            kinds = [item[1] for item in due]
        assert [run.origin for run in runs] == kinds
        for run, span in zip(runs, spans, strict=True):
            assert (
                span[1] <= 2 * pi or "closed" not in run.reasons
            )  # the last one is joined to the first
            assert run.span == pytest.approx(span, abs=1e-12)
            phases = [sample.theta_m for sample in run.samples]
            assert phases == sorted(phases)
            assert span[0] - 1e-12 <= phases[0] <= phases[-1] <= span[1] + 1e-12
            assert {sample.origin for sample in run.samples} == {run.origin}
            assert len(phases) > 1


def test_reasons_say_what_is_beyond_each_end() -> None:
    beyond = {
        OTHER: "beyond, the flow comes from belt 2",
        NOWHERE: "beyond, the flow met no belt before",
    }
    beyond[UNKNOWN] = beyond[NOWHERE] + " (within the search)"
    for other, words in beyond.items():
        first, last = runs_of(MadeUp([(0, OWN, 1.0), (2.5, other, 1.0)]), (0.3, 5.1, False), 20)
        assert first.reasons == ("end of the window", words)
        assert last.reasons == ("beyond, the flow comes from belt 1", "end of the window")
        assert (
            first.span[1]
            == last.span[0]
            == pytest.approx(2.5, abs=1e-2 if other == UNKNOWN else 1e-12)
        )
    first, last = runs_of(MadeUp([(0, OWN, 1.0), (2.5, OWN, 2.0)]), (0.3, 5.1, False), 20)
    assert first.reasons[1] == last.reasons[0] == "the flow touches belt 1 on the way"
    assert first.span[1] == pytest.approx(2.5, abs=1e-12)
    (whole,) = runs_of(MadeUp([(-1, OWN, 1.0)]), (0.0, 2 * pi, True), 20)
    assert whole.reasons == ("closed", "closed")
