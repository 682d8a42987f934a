"""How a grazing curve is cut into pieces: curves that are made up, whose edges and jumps are known."""

from __future__ import annotations

import random
from itertools import pairwise
from math import copysign, cos, nan, pi
from types import SimpleNamespace

import numpy as np
import pytest

from symosc.grazing import phase_runs
from symosc.grazing.phase_runs import arcs_of
from symosc.grazing.tracer import NOWHERE, OTHER, OWN, UNKNOWN, Sample


class MadeUp:
    """A tracer whose flows come from where a list of stretches says; on its own belt theta is a formula of theta_m."""

    def __init__(self, stretches: list[tuple[float, str, float]], slope: float = 0.5) -> None:
        self.stretches, self.slope = stretches, slope  # (where it begins, origin, shift of theta)
        self.place = SimpleNamespace(boundary=1)
        self.asked = 0

    def sample(self, theta_m: float, careful: bool = True) -> Sample:
        self.asked += 1
        _, origin, shift = [each for each in self.stretches if each[0] <= theta_m][-1]
        if origin not in (OWN, OTHER):
            return Sample(theta_m, 0.0, origin, nan, nan, nan, nan)
        return Sample(theta_m, cos(theta_m), origin, theta_m**2, self.slope * theta_m - shift, 2 * theta_m, self.slope)


def runs_of(tracer: MadeUp, arc: tuple[float, float, bool], n: int) -> list[phase_runs.PhaseRun]:
    return phase_runs.cut(tracer, [tracer.sample(float(theta)) for theta in phase_runs.phases_of(*arc, n)], arc)  # type: ignore[arg-type]


@pytest.mark.parametrize("closed", [False, True])
def test_a_curve_is_cut_where_the_flow_comes_from_elsewhere_and_where_it_jumps(closed: bool) -> None:
    """Every stretch is found, its ends to rounding, with its reason; each sample is in the run of its origin."""
    rng = random.Random(1)
    for _ in range(60):
        low, high = (0.0, 2 * pi) if closed else (0.3, 5.1)
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
        ends = [*(each[0] for each in due[1:]), high]
        if closed and len(due) > 1 and due[0][1] == due[-1][1]:
            spans = [*zip((each[0] for each in due[1:-1]), ends[1:-1], strict=True), (due[-1][0], ends[0] + 2 * pi)]
            kinds = [*(each[1] for each in due[1:-1]), due[0][1]]
        else:
            spans = list(zip((each[0] for each in due), ends, strict=True))
            kinds = [each[1] for each in due]
        assert [run.origin for run in runs] == kinds
        for run, span in zip(runs, spans, strict=True):
            assert run.span == pytest.approx(span, abs=1e-12)
            phases = [sample.theta_m for sample in run.samples]
            assert phases == sorted(phases)
            assert span[0] - 1e-12 <= phases[0] <= phases[-1] <= span[1] + 1e-12
            assert {sample.origin for sample in run.samples} == {run.origin}
            assert len(phases) > 1


def test_reasons_say_what_is_beyond_each_end() -> None:
    beyond = {OTHER: "beyond, the flow comes from belt 2", NOWHERE: "beyond, the flow met no belt before"}
    beyond[UNKNOWN] = beyond[NOWHERE] + " (within the search)"
    for other, words in beyond.items():
        first, last = runs_of(MadeUp([(0, OWN, 1.0), (2.5, other, 1.0)]), (0.3, 5.1, False), 20)
        assert first.reasons == ("end of the window", words)
        assert last.reasons == ("beyond, the flow comes from belt 1", "end of the window")
        assert first.span[1] == last.span[0] == pytest.approx(2.5, abs=1e-2 if other == UNKNOWN else 1e-12)
    first, last = runs_of(MadeUp([(0, OWN, 1.0), (2.5, OWN, 2.0)]), (0.3, 5.1, False), 20)
    assert first.reasons[1] == last.reasons[0] == "the flow touches belt 1 on the way"
    assert first.span[1] == pytest.approx(2.5, abs=1e-12)
    (whole,) = runs_of(MadeUp([(-1, OWN, 1.0)]), (0.0, 2 * pi, True), 20)
    assert whole.reasons == ("closed", "closed")


@pytest.mark.parametrize("slope", [0.1, 3.0, -40.0, 900.0])
def test_a_steep_curve_is_no_jump(slope: float) -> None:
    """Where the slopes explain the change; a jump that is larger than what the slope makes of a step is found."""
    assert len(runs_of(MadeUp([(-1, OWN, 1.0)], slope), (0.3, 5.1, False), 20)) == 1
    jump = -copysign(1.0 + 2.0 * abs(slope), slope)  # in the direction of the slope: it cannot cancel
    runs = runs_of(MadeUp([(-1, OWN, 1.0), (2.2, OWN, 1.0 + jump)], slope), (0.3, 5.1, False), 20)
    assert len(runs) == 2
    assert runs[0].span[1] == pytest.approx(2.2, abs=1e-9)


def test_jumps_of_flows_from_the_other_belt_are_no_edges_but_what_hides_there_is() -> None:
    tracer = MadeUp([(-1, OTHER, 1.0), (2.5, OTHER, 3.0)])
    assert [run.origin for run in runs_of(tracer, (0.3, 5.1, False), 20)] == [OTHER]
    hidden = MadeUp([(-1, OTHER, 1.0), (2.5, OWN, 2.0), (2.5001, OTHER, 3.0)])
    runs = runs_of(hidden, (0.3, 5.1, False), 20)
    assert [run.origin for run in runs] == [OTHER, OWN, OTHER]
    assert runs[1].span == pytest.approx((2.5, 2.5001), abs=1e-12)


def test_a_short_run_is_filled_with_samples() -> None:
    """... of its own origin, evenly and in order, so that enough lie away from its ends; not one shorter than 1e-6."""
    for length in (2.0, 1e-3, 1e-5, 5e-7):
        tracer = MadeUp([(-1, OTHER, 1.0), (2.5, OWN, 2.0), (2.5 + length, OTHER, 3.0)])
        samples = [tracer.sample(theta) for theta in (2.5, 2.5 + length * 0.999)]
        run = phase_runs.PhaseRun(samples, (2.5, 2.5 + length), ("", ""))
        filled = [each.theta_m for each in phase_runs.filled(tracer, run).samples]  # type: ignore[arg-type]
        assert filled == sorted(filled)
        if length < 1e-6:
            assert len(filled) == 2
            continue
        assert filled == pytest.approx(np.linspace(2.5, 2.5 + 0.999 * length, phase_runs.PIECE_POINTS), abs=1e-15)
        again = phase_runs.PhaseRun([tracer.sample(theta) for theta in np.linspace(2.5, 2.6, 60)], (2.5, 2.6), ("", ""))
        assert length < 2 or phase_runs.filled(tracer, again) is again  # type: ignore[arg-type]


def test_phases_of_an_arc() -> None:
    """Closed: even, both ends included. Open: inside, near its ends the closest, and none twice."""
    assert phase_runs.phases_of(0.0, 2 * pi, True, 8) == pytest.approx(np.arange(9) * pi / 4)
    for n in (8, 9, 400):
        found = phase_runs.phases_of(1.0, 4.0, False, n)
        assert len(found) == n
        assert (np.diff(found) > 0).all()
        assert (found[0] - 1, 4 - found[-1]) == pytest.approx((3e-7, 3e-7), rel=1e-6)
        assert np.diff(found) == pytest.approx(np.diff(found)[::-1], rel=1e-6)
        assert np.diff(found).max() < 6.0 / n * 2


def test_arcs_of_windows() -> None:
    turn = 2 * pi
    assert arcs_of([(0.0, turn, True, False)]) == [(0.0, turn, True)]
    assert arcs_of([(1.0, 2.0, False, False)]) == [(1.0, 2.0, False)]
    assert arcs_of([(0.0, 2.0, True, False), (5.0, turn, False, False)]) == [(5.0 - turn, 2.0, False)]
    assert arcs_of([(0.5, 2.0, False, False), (5.0, turn, False, False)]) == [
        (0.5, 2.0, False),
        (5.0, turn, False),
    ]
    assert arcs_of([(0.0, 2.0, True, False), (5.0, 6.0, False, False)]) == [
        (0.0, 2.0, False),
        (5.0, 6.0, False),
    ]
    assert arcs_of([]) == []
