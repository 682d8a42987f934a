"""A summary computed the slow way.

From a trajectory of `simulate`, by sampling it and looking closer.

The extremes also to many digits, from the oracle alone.
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil, pi
from typing import Any

import mpmath
import numpy as np
from oracle import exact, flow_oracle, simulate_oracle
from scipy.linalg import expm
from scipy.optimize import minimize_scalar

from symosc import Parameters, Trajectory

MOST_REPEATS = 32
AT_SECTION = 1e-9


def extremes(trajectory: Trajectory, begin: float) -> dict[str, float]:
    """Return the extremes of x and v after a time.

    Each segment sampled, and searched around its best samples.
    """
    found: dict[str, float] = {}
    for number, name in enumerate("xv"):
        for sign, what in ((1, "min"), (-1, "max")):
            best = [
                _least(
                    trajectory,
                    number,
                    sign,
                    max(begin, float(segment.t_start)),
                    float(segment.t_end),
                )
                for segment in trajectory.segments
                if float(segment.t_end) > begin
            ]
            found[f"{name}_{what}"] = sign * min(best)
    return found


def _least(trajectory: Trajectory, number: int, sign: int, low: float, high: float) -> float:
    times = np.linspace(low, high, 12 + min(400, int(12 * (high - low))))
    values = sign * trajectory(times)[number]
    if number == 1 and high < float(
        trajectory.t_end
    ):  # at the end has the speed of the belt, or of the next segment
        times = times[:-1]
        values = values[:-1]
    walled = np.concatenate([[np.inf], values, [np.inf]])
    lowest = np.flatnonzero((walled[1:-1] <= walled[:-2]) & (walled[1:-1] <= walled[2:]))
    best = float(values.min())
    for place in lowest[np.argsort(values[lowest])][:3].tolist():
        around = times[max(place - 1, 0)], times[min(place + 1, len(times) - 1)]
        closer = minimize_scalar(
            lambda t: sign * trajectory(t)[number], bounds=around, method="bounded", options=XATOL
        )
        best = min(best, float(closer.fun))
    return best


XATOL = {"xatol": 1e-10}


def oracle_extremes(p: Parameters, start: tuple[Any, Any, Any], t_end: Any) -> dict[str, float]:
    """Return the extremes of a motion, those inside flights at the zeros of v and a to 25 digits."""
    run = simulate_oracle(p, *start, t_end)
    modes = [event.source for event in run.events] + [run.mode]
    launches = [tuple(map(exact, start))] + [
        tuple(map(_fraction, (event.t, event.x, event.v))) for event in run.events
    ]
    points = [(x, v) for _, x, v in launches] + [(_fraction(run.x), _fraction(run.v))]
    for mode, (t, x, v), end in zip(
        modes, launches, [*(launch[0] for launch in launches[1:]), exact(t_end)], strict=True
    ):
        if mode.startswith("Omega"):
            points += _stationary_points(p, int(mode[-1]), t, x, v, end - t)
    xs, vs = ([float(point[n]) for point in points] for n in (0, 1))
    return {"x_min": min(xs), "x_max": max(xs), "v_min": min(vs), "v_max": max(vs)}


def _fraction(value: Any) -> Fraction:
    sign, man, exponent, _ = value._mpf_
    return (-1) ** sign * Fraction(int(man)) * Fraction(2) ** exponent


def _stationary_points(
    p: Parameters, alpha: int, t: Any, x: Any, v: Any, tau: Any
) -> list[tuple[Any, Any]]:
    """Return x and v where v or a of a flight is 0.

    Bracketed by steps of a matrix exponential, by secants.
    """
    f = [float(value / p.m) for value in (p.k, p.c, p.B0, p.A(alpha))]
    Om = float(p.Omega)
    theta = float(p.Omega * t)
    matrix = np.zeros((5, 5))
    matrix[0, 1], matrix[1] = 1, (-f[0], -f[1], f[2], 0, f[3])
    matrix[2, 3], matrix[3, 2] = -Om, Om
    count = 20 + ceil(20 * float(tau) * (f[0] ** 0.5 + f[1] + Om))
    step = expm(matrix * (float(tau) / count))
    states = [np.array([float(x), float(v), np.cos(theta), np.sin(theta), 1])]
    for _ in range(count):
        states.append(step @ states[-1])
    # of x and of v
    rates = np.array(states) @ matrix[:2].T
    found = []
    for which in (0, 1):
        for n in np.flatnonzero(rates[:-1, which] * rates[1:, which] < 0).tolist():
            bracket = [tau * n / count, tau * (n + 1) / count]

            def rate(s: Any, which: int = which) -> Any:
                return flow_oracle(p, alpha, t, x, v, _fraction(mpmath.mpf(s)), 30)[1 + which]

            with mpmath.workdps(30):
                root = mpmath.findroot(
                    rate, [mpmath.mpf(s.numerator) / s.denominator for s in bracket], "anderson"
                )
                found.append(flow_oracle(p, alpha, t, x, v, _fraction(root), 30)[:2])
    return found


def slow_summary(
    p: Parameters, trajectory: Trajectory, skip: float, sections: int
) -> dict[str, Any]:
    """Return the columns of a summary of one motion."""
    t0 = float(trajectory.t_start)
    last = float(trajectory.t_end)
    Omega = float(p.Omega)
    begin = t0 + skip
    counted = [event for event in trajectory.events if float(event.t) >= begin]
    held = [s for s in trajectory.segments if s.mode.startswith("belt")]
    stuck = sum(max(0.0, float(s.t_end) - max(begin, float(s.t_start))) for s in held)
    first = Omega * t0 / (2 * pi)
    after = (Omega * last + AT_SECTION) / (2 * pi)
    numbers = np.arange(np.floor(first) + 1, np.floor(after) + 1)
    times = np.minimum(numbers * 2 * pi / Omega, last)
    if len(times):
        values = trajectory(times).T
    else:
        values = np.zeros((0, 2))
    words = _words(trajectory, numbers, Omega, whole=first == int(first))
    columns: dict[str, Any] = {"status": trajectory.status, "events": len(counted)}
    columns["sticks"] = sum(event.kind == "stick" for event in counted)
    columns |= extremes(trajectory, begin) | {"stuck": stuck / (last - begin)}
    if words and words[-1]:
        columns["word"] = _text(words[-1])
    else:
        columns["word"] = ""
    blank = np.full((sections, 2), np.nan)
    if sections:
        columns["section"] = np.concatenate([blank, values])[len(values) :]
    else:
        columns["section"] = blank
    columns |= {"t": last, "mode": trajectory.segments[-1].mode, "word_known": bool(words)}
    columns["x"], columns["v"] = trajectory(last)
    extent = np.array([columns[f"{name}_max"] - columns[f"{name}_min"] for name in "xv"])
    multiplicity = _multiplicity(words, values[len(values) - len(words) :], extent)
    if p.B0 == 0 and trajectory.status == "equilibrium":
        multiplicity = 1  # rest has every period, whatever Omega is
    return columns | {"multiplicity": multiplicity}


def _words(
    trajectory: Trajectory, numbers: np.ndarray, Omega: float, whole: bool
) -> list[list[str]]:
    """Return the mappings that ended in each whole period."""
    if len(numbers):
        begin = numbers[0] - whole
    else:
        begin = 0
    words: list[list[str]] = [[] for _ in numbers[(not whole) :]]
    for event, segment in zip(trajectory.events, trajectory.segments, strict=False):
        near = AT_SECTION + min(8 * Omega * event.t_error, 1e-3)
        period = int(np.floor((Omega * float(event.t) + near) / (2 * pi)) - begin)
        if segment.label and 0 <= period < len(words):
            words[period].append(segment.label)
    return words


def _text(labels: list[str]) -> str:
    """All rotations are one word: that which comes first in the order of the labels."""
    first = min([*labels[i:], *labels[:i]] for i in range(len(labels)))
    return "P" + "".join(label[1:] for label in reversed(first))


def _multiplicity(words: list[list[str]], sections: np.ndarray, extent: np.ndarray) -> int:
    for m in range(1, MOST_REPEATS + 1):
        if 2 * m <= len(words) and words[-m:] == words[-2 * m : -m]:
            gap = abs(sections[-m:] - sections[-2 * m : -m])
            if np.all(gap <= 1e-6 * extent + 1e-12):
                return m
    return 0
