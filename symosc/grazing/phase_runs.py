"""Samples over an arc of a window, cut where the flow comes from another place: the pieces of a grazing curve.

Between neighbours of which one comes from the mapping's belt and the other does not the edge is found by halving, and
so is a jump of the start. A stretch that is steep gets more samples, until its slopes explain it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from symosc.grazing.tracer import NOWHERE, OTHER, OWN, UNKNOWN, Sample, Tracer

PIECE_POINTS = 33
# Halvings of an interval of theta_m at whose ends the flow comes from different places: down to rounding.
CURVE_HALVINGS = 50
# ... but not where the search ends in one of them: that is not an end of the curve.
ROUGH_HALVINGS = 8
# Omega t_i changes by more than this between neighbours: there may be a jump between them, look closer ...
CURVE_STRIDE = 0.2
# ... unless the slopes explain it up to this part of it ...
CURVE_AGREEMENT = 0.25
# ... and it is one if so much is left of it at the end.
CURVE_JUMP = 1e-3
# Shorter pieces are not looked for: there double precision begins to take near contacts for touches.
FINEST_CURVE = 1e-6
# How near to an open end of the window the curve is sampled.
END_GAP = 1e-7


def arcs_of(intervals: Sequence[tuple[float, float, bool, bool]]) -> list[tuple[float, float, bool]]:
    """Return the arcs of a window as (low, high, closed), one through 0 in one piece with a negative low end."""
    arcs = [(low, high) for low, high, _, _ in intervals]
    if len(arcs) == 1 and arcs[0] == (0.0, 2 * pi):
        return [(0.0, 2 * pi, True)]
    if len(arcs) == 2 and arcs[0][0] == 0.0 and arcs[1][1] == 2 * pi:
        return [(arcs[1][0] - 2 * pi, arcs[0][1], False)]
    return [(low, high, False) for low, high in arcs]


def phases_of(low: float, high: float, closed: bool, n: int) -> np.ndarray:
    """Return n phases over an arc, both ends of a closed one included; near open ends they are closest."""
    if closed:
        return low + (high - low) * (np.arange(n + 1) / n)
    inner = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(pi * (np.arange(n - 2) + 0.5) / (n - 2))
    gap = END_GAP * (high - low)
    return np.concatenate([[low + gap], inner[(inner > low + gap) & (inner < high - gap)], [high - gap]])


@dataclass
class PhaseRun:
    """Neighbouring samples of one origin that move continuously, and the stretch of theta_m that they stand for."""

    samples: list[Sample]
    span: tuple[float, float]
    reasons: tuple[str, str]

    @property
    def origin(self) -> str:
        """Where the flow back from these tangencies comes from."""
        return self.samples[0].origin


def cut(tracer: Tracer, samples: list[Sample], arc: tuple[float, float, bool]) -> list[PhaseRun]:
    """Cut the samples over an arc where the origin changes or the start jumps."""
    low, high, closed = arc
    limit = "closed" if closed else "end of the window"
    runs: list[PhaseRun] = []
    run, begin, reason = [samples[0]], low, limit
    ahead = samples[:0:-1]
    while ahead:
        if _needs_middle(run[-1], ahead[-1]):
            ahead.append(tracer.sample(0.5 * (run[-1].theta_m + ahead[-1].theta_m)))
            continue
        edges = _edge(tracer, run[-1], ahead[-1])
        if edges is None:
            run.append(ahead.pop())
            continue
        before, behind, border = edges
        run += before
        runs.append(PhaseRun(run, (begin, border), (reason, _reason(tracer, run[-1], behind[-1]))))
        begin, reason = border, _reason(tracer, behind[-1], run[-1])
        ahead[-1:] = behind
        run = [ahead.pop()]
    runs.append(PhaseRun(run, (begin, high), (reason, limit)))
    return _joined(runs) if closed and len(runs) > 1 else runs


def _joined(runs: list[PhaseRun]) -> list[PhaseRun]:
    """Join the last run over a full circle with the first, a turn later, if they are one."""
    first, last = runs[0], runs[-1]
    if first.origin != last.origin:
        return runs
    turn = 2 * pi
    later = [replace(each, theta_m=each.theta_m + turn, theta=each.theta + turn) for each in first.samples[1:]]
    both = PhaseRun(last.samples + later, (last.span[0], first.span[1] + turn), (last.reasons[0], first.reasons[1]))
    return [*runs[1:-1], both]


def _continuous(left: Sample, right: Sample) -> bool:
    """Return whether Omega t_i moves between neighbours of one origin as their slopes say, or hardly."""
    change = right.theta - left.theta
    expected = 0.5 * (left.slope_theta + right.slope_theta) * (right.theta_m - left.theta_m)
    return not abs(change) > CURVE_STRIDE or abs(change - expected) <= CURVE_AGREEMENT * abs(change)


def _needs_middle(left: Sample, right: Sample) -> bool:
    """Return whether a steep stretch of the curve needs another sample."""
    if not left.origin == right.origin == OWN or _continuous(left, right):
        return False
    return right.theta_m - left.theta_m > FINEST_CURVE


def _edge(tracer: Tracer, left: Sample, right: Sample) -> tuple[list[Sample], list[Sample], float] | None:
    """Return what lies on both sides of the first change of origin found between two neighbours, or of a jump.

    That is: the samples visited behind `left`, those before `right` from it inward, and theta_m of the edge. None:
    there is no edge. Jumps among flows from the other belt are no edges, but something may hide behind them.
    """
    if left.origin == right.origin and _continuous(left, right):
        return None
    lefts: list[Sample] = []
    rights = [right]
    unknown = UNKNOWN in (left.origin, right.origin)
    for _ in range(ROUGH_HALVINGS if unknown else CURVE_HALVINGS):
        theta = 0.5 * (left.theta_m + right.theta_m)
        if not left.theta_m < theta < right.theta_m:
            break
        if left.origin == right.origin and abs(right.theta - left.theta) < CURVE_JUMP:
            return None
        middle = tracer.sample(theta, careful=False)
        to_left = middle.origin == left.origin
        if left.origin == right.origin:
            if not to_left and right.theta_m - left.theta_m < FINEST_CURVE:
                return None
            to_left = to_left and abs(middle.theta - left.theta) < abs(right.theta - middle.theta)
        if to_left:
            left = middle
            lefts.append(middle)
        else:
            right = middle
            rights.append(middle)
    if left.origin == right.origin and (left.origin != OWN or abs(right.theta - left.theta) < CURVE_JUMP):
        return None
    border = 0.5 * (left.theta_m + right.theta_m)
    return [each for each in lefts if not each.is_open], [each for each in rights if not each.is_open], border


def _reason(tracer: Tracer, here: Sample, beyond: Sample) -> str:
    own = tracer.place.boundary
    if beyond.origin == OTHER:
        return f"beyond, the flow comes from belt {3 - own}"
    if beyond.origin in (NOWHERE, UNKNOWN):
        return f"beyond, the flow met no belt before{' (within the search)' if beyond.origin == UNKNOWN else ''}"
    if here.origin != OWN:
        return f"beyond, the flow comes from belt {own}"
    return f"the flow touches belt {own} on the way"


def filled(tracer: Tracer, run: PhaseRun) -> PhaseRun:
    """Return a run with at least PIECE_POINTS samples away from its ends, where those of the edges gather."""
    first, last = run.samples[0].theta_m, run.samples[-1].theta_m
    margin = 0.1 * (last - first)
    if sum(first + margin < each.theta_m < last - margin for each in run.samples) >= PIECE_POINTS:
        return run
    if last - first < FINEST_CURVE:
        return run
    between = [tracer.sample(float(theta)) for theta in np.linspace(first, last, PIECE_POINTS)[1:-1]]
    inner = [each for each in between if each.origin == OWN]
    samples = sorted([*run.samples, *inner], key=lambda each: each.theta_m)
    return replace(run, samples=samples)
