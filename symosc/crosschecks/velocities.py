"""Velocities for positions given without them.

Those with which the exact motion leads from one position to the next.

In one domain, or band of a law that has bands, the displacement over a step is linear in the
velocity at its start, so each step has one velocity for each domain or band, and on a belt that of
the belt. Where two steps agree about the sample
between them, that is its velocity. The exact motion leads over steps with an event, which agree
with none. Where positions are rounded, over short steps, it is the velocity of an exact motion
within their rounding at all times: the scene's own, or one with a fitted start.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import chain
from typing import NamedTuple, TypeGuard

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.crosschecks.bands import Bands, bands_of
from symosc.crosschecks.rounding import digits_of
from symosc.crosschecks.samples import Samples, fastest_rate
from symosc.crosschecks.steps import follow_from, phases
from symosc.engine.flow import Constants
from symosc.kernels import entire_array
from symosc.kernels._generated import acceleration, motion
from symosc.model import Model
from symosc.scenes import STARTS, Scene, model_of
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

NOTE = (
    "velocities were not given: they are those with which the exact motion leads from one position "
    "to the next"
)
NOTE_OF_LEFT_OUT = (
    "samples at the beginning that are left out, since the positions do not tell their velocity"
)
NOTE_OF_ROUNDED = (
    "velocities were not given: they are those of an exact motion that has the rounded positions"
)
# Longest step, in units of 1/rate, over which a velocity is found without that of the sample
# before.
LONGEST_FLIGHT = 1.0
# Shortest step, in the same units, over which positions tell a velocity
# (test_positions_at_any_spacing), if there are so many steps.
TELLING_STEP = 1e-2
FEWEST_STEPS = 50
# The search for a motion ends when it misses the positions by at most this many times their
# rounding.
GOOD_FIT = 1.1
# A motion that misses them by more is none, and a start that misses the positions of a short time
# by HOPELESS times as much is not fitted to those of a longer one.
WORST_FIT = 4.0
HOPELESS = 10.0
# Initial velocities that are tried on a grid, and how many of the best ones are fitted.
GRID_OF_GUESSES = 41
MOST_GUESSES = 4
# Positions to which a start is fitted, Gauss-Newton steps, and a velocity's change for differences,
# as a part of the size of x times the fastest rate.
MOST_FITTED = 1_000
FIT_STEPS = 3
TICK = 1e-4
# Unknown velocities in a row that are continued one after another; gaps are shorter as a rule.
MOST_CONTINUED = 100
# Fewest samples with a velocity on both sides, from which on none that agree shows a wrong motion.
FEWEST_PAIRS = 20


def with_velocities(samples: Samples, scene: Scene | Model, tolerance: float) -> Samples:
    """Return samples that have positions alone with computed velocities, and bounds of their
    errors; ParameterError if the positions are too far apart in time to determine them.
    """
    p = model_of(scene)
    bands = bands_of(p)
    digits = digits_of(samples, "x")
    rounded = np.zeros(len(samples.x)) if digits is None else digits.units
    telling = _telling_samples(p, samples.t)
    if digits is not None:  # rounded positions: one motion through all of them is better
        off = tolerance * float(np.max(np.abs(samples.x)))
        half_units = (0.5 + 1e-9) * rounded
        fitted = _fit_motion(samples, scene, half_units, off, telling)
        if fitted is not None:
            return fitted
    few = replace(samples, t=samples.t[telling], x=samples.x[telling])
    computed = _from_positions(few, scene, bands, tolerance, rounded[telling])
    if len(telling) == len(samples.t):
        return computed
    left_out = len(telling) - len(computed.t)  # at the beginning
    return _filled(bands, p, samples, computed, telling[left_out:])


def _telling_samples(p: Model, t: np.ndarray) -> np.ndarray:
    """Return the numbers of samples that are far enough apart in time for positions to tell a
    velocity.
    """
    # Rounding of x and errors far below the tolerance, divided by a tiny step, are no small
    # velocity.
    least = min(TELLING_STEP / fastest_rate(p), float(t[-1] - t[0]) / FEWEST_STEPS)
    if np.min(np.diff(t)) >= least:
        return np.arange(len(t))
    chosen = [0]
    while True:
        after = int(np.searchsorted(t, t[chosen[-1]] + least))
        if after >= len(t):
            return np.array(chosen)
        chosen.append(after)


def _filled(bands: Bands, p: Model, samples: Samples, few: Samples, telling: np.ndarray) -> Samples:
    """Return samples with the velocities of `few`, which are those numbered `telling`, and between
    them.

    Between them the exact motion leads from the one before to a sample.
    """
    since = int(telling[0])
    t = samples.t[since:]
    x = samples.x[since:]
    numbers = telling - since
    v = np.empty(len(t))
    v[numbers] = few.v
    bounds = np.zeros(len(t)) if few.v_off is None else np.empty(len(t))
    between = np.delete(np.arange(len(t)), numbers)
    row = np.searchsorted(numbers, between, "right") - 1  # in `few`, of the sample before each
    before = numbers[row]
    v_before = few.v[row]
    # Pairs of samples, one after another: the one before, and one between with the same v. The
    # defect in v of a step from the first to the second is then the change of v.
    pair_t, pair_x = (
        np.column_stack([values[before], values[between]]).ravel() for values in (t, x)
    )
    pairs = np.array([pair_t, pair_x, np.repeat(v_before, 2), phases(p, pair_t)])
    later = np.flatnonzero(t[between] > t[before])
    on = bands.belts_at(v_before)
    changes = follow_from(bands, pairs, 2 * later, on[later]).defects_of_v
    reached = v_before.copy()
    reached[later] += np.where(np.isfinite(changes), changes, 0.0)
    v[between] = reached
    if few.v_off is not None:
        bounds[numbers] = few.v_off
        bounds[between] = few.v_off[row]
    return replace(few, t=t, x=x, v=v, v_off=bounds)


def _from_positions(
    samples: Samples,
    scene: Scene | Model,
    bands: Bands,
    tolerance: float,
    rounded: np.ndarray,
) -> Samples:
    """Return samples, `rounded` to these units, with the velocities that neighbouring positions
    tell.
    """
    p = model_of(scene)
    t = samples.t
    x = samples.x
    tau = np.diff(t)
    theta = phases(p, t)
    size = float(np.max(np.abs(x)))
    starts, ends = _flight_velocities(t, x, theta, bands)
    flights = len(starts)
    # The error of v by unit of the error of x. Inner samples have a step on both sides.
    per_x = _errors_per_x(tau)
    allowed = per_x * (tolerance * size + rounded)
    gaps = _nearest(starts, ends).gaps
    is_flown = gaps <= 4.0 * allowed[1:-1]
    if is_flown.any():
        noise = 20.0 * float(np.median((gaps / per_x[1:-1])[is_flown]))
    else:
        noise = tolerance * size
    noise += 8.0 * float(np.spacing(size))
    # A step that moves as far as a belt can be a stick; both its ends have the belt's velocity.
    belts = np.array([[float(belt.v)] for belt in p.law.belts])
    errors_x = noise + rounded
    keeps_up = np.abs(np.diff(x) - belts * tau) <= errors_x[:-1] + errors_x[1:]
    held = np.where(keeps_up & (tau > 0.0), belts, np.nan)
    starts = np.concatenate([starts, held])
    ends = np.concatenate([ends, held])
    off = np.minimum(per_x * errors_x, allowed)
    nearest = _nearest(starts, ends)
    agree = nearest.gaps <= 2.0 * off[1:-1]
    v = _agreed(starts, ends, nearest, np.flatnonzero(agree), flights)
    if _is_start(scene, samples, tolerance * size + rounded[0]):
        # A stick may begin in the first step, so early that positions do not show it.
        off_x = float(errors_x[0] + errors_x[1])
        hides = bool(keeps_up[:, 0].any()) and _passes(scene, float(t[1]), float(x[1]), off_x)
        if np.isnan(v[0]) or hides:
            v[0] = float(scene.v0)
    pairs = np.flatnonzero(np.isfinite(nearest.gaps))
    if np.isnan(v).all() and len(pairs) >= FEWEST_PAIRS:
        # These are positions of no exact motion: velocities of the first steps show that.
        v = _agreed(starts, ends, nearest, pairs[:1], flights)
    if np.isnan(v).all():
        raise ParameterError(
            "v", None, "is missing, and the positions are too far apart to tell it: give velocities"
        )
    # Before the first known velocity an event hides that at which the first step began.
    known = int(np.argmax(~np.isnan(v)))
    notes = (*samples.notes, NOTE)
    if known:
        notes = (*notes, f"{NOTE_OF_LEFT_OUT}: {known}")
    v = _continued(bands, t, x, v, theta)
    # Inside a stick v is that of the belt; at its ends the mass may be just before or after it.
    on = bands.belts_at(v) > 0
    stays_on = on & np.append(True, on[:-1]) & np.append(on[1:], True)
    off = np.where(stays_on, 0.0, off)
    return replace(samples, t=t[known:], x=x[known:], v=v[known:], v_off=off[known:], notes=notes)


def _errors_per_x(tau: np.ndarray) -> np.ndarray:
    """Return for each sample how far v is off if both ends of the shorter step beside it, of those
    that take time, are off by one unit.
    """
    shortest = np.minimum(np.append(tau, np.inf), np.insert(tau, 0, np.inf))
    longest = np.maximum(np.append(tau, 0.0), np.insert(tau, 0, 0.0))
    return 2.0 / np.where(shortest > 0.0, shortest, np.where(longest > 0.0, longest, 1.0))


def _fit_motion(
    samples: Samples, scene: Scene | Model, half: np.ndarray, off: float, telling: np.ndarray
) -> Samples | None:
    """Return samples with the velocities of one exact motion through all positions.

    None if none is found.

    The motion may miss each position by `half`, half a unit of its last place, and by the tolerance
    `off`.
    """
    t = samples.t
    x = samples.x
    p = model_of(scene)
    digits = digits_of(samples, "t")
    if digits is None:
        clock = np.zeros(len(t))
    else:
        clock = 0.5 * digits.units

    everywhere = np.arange(len(t))

    def misfit(motion: Trajectory | None, numbers: np.ndarray = everywhere) -> float:
        """Return the largest miss of the samples `numbers`, in units of what is allowed."""
        times = t[numbers]
        if motion is None or motion.t_end < times[-1]:
            return np.inf
        exact_x, exact_v = motion(np.maximum(times, float(motion.t_start)))
        allowed = half[numbers] + off + np.abs(exact_v) * clock[numbers]
        return float(np.max(np.abs(exact_x - x[numbers]) / allowed))

    if _is_start(scene, samples, off + half[0], clock[0]):
        motion = _motion(scene, t[-1])
    else:
        motion = None
    best = misfit(motion)
    if best > GOOD_FIT:
        guesses = _first_guesses(p, t[telling], x[telling])
        as_guessed = (_motion(p, t[-1], t[0], x[0], v0) for v0 in guesses)
        as_fitted = (_fitted(p, t, x, v0, misfit) for v0 in guesses)
        for candidate in chain(as_guessed, as_fitted):  # a fit costs more than a guess
            size = misfit(candidate)
            if size < best:
                motion = candidate
                best = size
            if best <= GOOD_FIT:
                break
    if motion is None or best > WORST_FIT:
        return None
    _, v = motion(np.maximum(t, float(motion.t_start)))
    return replace(samples, v=v, v_off=half, notes=(*samples.notes, NOTE_OF_ROUNDED))


def _motion(scene: Scene | Model, t_end: float, *start: float) -> Trajectory | None:
    """Return the exact motion of a scene, or from a start t0, x0, v0.

    None if the model does not allow it.
    """
    numbers: Record = dict(zip(STARTS, map(float, start), strict=False))
    try:
        return simulate(scene, t_end=float(t_end), max_events=20_000, **numbers)
    except ParameterError:
        return None


def _passes(scene: Scene, t: float, x: float, off: float) -> bool:
    """Return whether the scene's motion is at the position `x` at the time `t`, up to `off`."""
    motion = _motion(scene, t)
    return motion is not None and bool(motion.t_end >= t and abs(motion(t)[0] - x) <= off)


def _first_guesses(p: Model, t: np.ndarray, x: np.ndarray) -> list[float]:
    """Return initial velocities with which the exact motion is nearest to the first positions, best
    first.
    """
    # Positions over about one radian of the fastest motion, and a parabola through fewer of them.
    count = max(8, int(np.searchsorted(t, t[0] + 1.0 / fastest_rate(p))))
    tau = t[:count] - t[0]
    few = max(3, int(np.searchsorted(tau, 0.3 / fastest_rate(p))))
    *_, slope, _ = np.polyfit(tau[:few] / tau[-1], x[:few], min(2, len(tau) - 1))
    slope = slope / tau[-1]  # that of the parabola at its start
    moving = np.diff(tau) > 0.0
    chords = np.diff(x[:count])[moving] / np.diff(tau)[moving]
    # A belt that is much faster than all steps is not met in them.
    fastest = 2.0 * float(np.max(np.abs(chords)))
    speeds = [float(belt.v) for belt in p.law.belts if abs(float(belt.v)) <= 10.0 * fastest]
    most = fastest + sum(map(abs, speeds))

    def misses(v0: float) -> float:
        """Return the largest miss of these positions."""
        motion = _motion(p, t[0] + tau[-1], t[0], x[0], v0)
        if motion is None or motion.t_end < t[0] + tau[-1]:
            return np.inf
        exact_x, _ = motion(t[:count])
        return float(np.max(np.abs(exact_x - x[:count])))

    guesses = [float(slope), *speeds, *np.linspace(-most, most, GRID_OF_GUESSES).tolist()]
    return sorted(guesses, key=misses)[:MOST_GUESSES]


def _fitted(
    p: Model, t: np.ndarray, x: np.ndarray, v0: float, misfit: Callable[..., float]
) -> Trajectory | None:
    """Fit a start to positions, from the velocity `v0` and over longer and longer times.

    Return the motion or None. `misfit` says by how much a motion misses the samples of some
    numbers, in units of their rounding.
    """
    start = np.array([x[0], v0])
    span = 1.0 / fastest_rate(p)
    ticks = TICK * np.array([1.0, fastest_rate(p)]) * max(float(np.ptp(x)), 1e-300)
    while True:
        count = max(6, int(np.searchsorted(t, t[0] + span, "right")))
        chosen = np.unique(np.linspace(0, min(count, len(t)) - 1, MOST_FITTED).astype(int))

        def missed(state: np.ndarray, chosen: np.ndarray = chosen) -> np.ndarray:
            """Return by how much the motion from a start x, v misses each position."""
            times = t[chosen]
            motion = _motion(p, times[-1], t[0], *state)
            if motion is None or motion.t_end < times[-1]:
                return np.full(len(times), np.nan)
            exact_x, _ = motion(times)
            return np.asarray(exact_x - x[chosen])

        for _ in range(FIT_STEPS):
            residuals = missed(start)
            slopes = np.column_stack(
                [(missed(start + step) - residuals) / step.max() for step in np.diag(ticks)]
            )
            if not (np.isfinite(residuals).all() and np.isfinite(slopes).all()):
                return None
            change, *_ = np.linalg.lstsq(slopes, residuals, rcond=1e-6)
            start = start - change
        motion = _motion(p, t[chosen[-1]], t[0], *start)
        if count >= len(t):
            return motion
        if misfit(motion, chosen) > HOPELESS * WORST_FIT:
            return None
        span *= 2.0


def _is_start(
    scene: Scene | Model, samples: Samples, off: float, clock: float = 0.0
) -> TypeGuard[Scene]:
    """Return whether the first sample is the scene's start, up to an error `off` of x and `clock`
    of t.
    """
    if not isinstance(scene, Scene):
        return False
    near = abs(float(scene.x0) - float(samples.x[0])) <= off + abs(float(scene.v0)) * clock
    return near and bool(np.isclose(samples.t[0], float(scene.t0), rtol=1e-14, atol=1e-14 + clock))


class FlightRow(NamedTuple):
    """The flights in one domain, or in one band of a law that has bands: the constants, the constant
    force, and the velocities between which they lie.
    """

    K: Constants
    A: float
    low: float
    high: float


def _flight_rows(bands: Bands) -> list[FlightRow]:
    """Return the flights that a law has."""
    if not bands.is_plain:
        return [FlightRow(K, K.A2, K.belt1.v, K.belt2.v) for K in bands.rows]
    (K,) = bands.rows
    return [
        FlightRow(K, K.A1, -np.inf, K.belt1.v),
        FlightRow(K, K.A2, K.belt1.v, K.belt2.v),
        FlightRow(K, K.A3, K.belt2.v, np.inf),
    ]


def _flight_velocities(
    t: np.ndarray, x: np.ndarray, theta: np.ndarray, bands: Bands
) -> tuple[np.ndarray, np.ndarray]:
    """Return velocities at the starts and at the ends of flights over all steps, with a row for each
    of `_flight_rows`.
    """
    tau = np.diff(t)
    s = np.sin(theta[:-1])
    c = np.cos(theta[:-1])
    starts = []
    ends = []
    for K, A, low, high in _flight_rows(bands):
        usable = (tau > 0.0) & (K.rate * tau < LONGEST_FLIGHT)
        E0, E1, E2, R2, I2, _, _ = entire_array.basis(
            np.where(usable, tau, 0.5 * LONGEST_FLIGHT / K.rate), K
        )
        responses = (K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        # dx is linear in v: its slope is (E1 + cm E2) - cm E2 = E1.
        from_rest = acceleration(x[:-1], 0.0, c, A, K.cm, K.w0sq, K.f0)
        dx_from_rest, _, _ = motion(0.0, from_rest, s, c, *responses)
        v = (np.diff(x) - dx_from_rest) / E1
        a = acceleration(x[:-1], v, c, A, K.cm, K.w0sq, K.f0)
        _, dv, _ = motion(v, a, s, c, *responses)
        end = v + dv
        # A flight that begins or ends elsewhere is none with this force.
        inside = usable & (v >= low) & (v <= high)
        inside &= (end >= low) & (end <= high)
        starts.append(np.where(inside, v, np.nan))
        ends.append(np.where(inside, end, np.nan))
    return np.array(starts), np.array(ends)


class NearestVelocities(NamedTuple):
    """How nearly a flight to a sample and one from it agree about its velocity, for inner samples.

    `gaps` has the smallest difference; `before` and `after` have the rows of the flight to the
    sample and of that from it (the force or the belt) that differ by it.
    """

    gaps: np.ndarray
    before: np.ndarray
    after: np.ndarray


def _nearest(starts: np.ndarray, ends: np.ndarray) -> NearestVelocities:
    """Return which flights over the steps on both sides of each inner sample agree best.

    `starts` and `ends` have the velocities at both ends of flights over steps, a row for each force
    or belt.
    """
    inner = starts.shape[1] - 1
    gaps = np.full(inner, np.inf)
    before = np.zeros(inner, np.int8)
    after = np.zeros(inner, np.int8)
    for i in range(len(ends)):
        for j in range(len(starts)):
            gap = np.abs(ends[i, :-1] - starts[j, 1:])
            closer = gap < gaps
            gaps[closer] = gap[closer]
            before[closer] = i
            after[closer] = j
    return NearestVelocities(gaps, before, after)


def _agreed(
    starts: np.ndarray,
    ends: np.ndarray,
    nearest: NearestVelocities,
    sure: np.ndarray,
    flights: int,
) -> np.ndarray:
    """Return the velocities of samples at which a flight to and one from them agree, and of their
    neighbours; else NaN.

    `sure` are the numbers of these samples, counted from the second one. `starts`, `ends` and
    `nearest` are those of `_nearest`; their first rows, so many as `flights`, are of flights, the
    others of sticks.
    """
    v = np.full(starts.shape[1] + 1, np.nan)
    # Step i leads from sample i to i + 1: the steps before and after these samples.
    step_before = sure
    step_after = sure + 1
    row_before = nearest.before[sure]
    row_after = nearest.after[sure]
    # Positions hardly show when in a step a stick begins. A later sample has its v from the steps
    # before it too. The second one has not: the exact motion tells it. The first one has nothing else
    # but the scene's start.
    flown_to = (row_before < flights) | (sure != 1)
    v[step_before[flown_to]] = starts[row_before, step_before][flown_to]
    v[step_after + 1] = ends[row_after, step_after]
    arrives = ends[row_before, step_before]
    leaves = starts[row_after, step_after]
    # A belt's velocity is exact.
    is_on_belt = row_before >= flights
    leaves_belt = row_after >= flights
    mean = 0.5 * (arrives + leaves)
    v[step_after] = np.where(is_on_belt, arrives, np.where(leaves_belt, leaves, mean))
    return v


def _continued(
    bands: Bands, t: np.ndarray, x: np.ndarray, v: np.ndarray, theta: np.ndarray
) -> np.ndarray:
    """Fill in unknown velocities by the exact motion from the sample before.

    Where it cannot be followed, the velocity before is held, or else interpolated.
    """
    for _ in range(MOST_CONTINUED):
        steps = np.flatnonzero(np.isnan(v[1:]) & ~np.isnan(v[:-1]))
        if not len(steps):
            break
        on = bands.belts_at(v[steps])
        # Unknown velocities count as 0, so that their defects are the exact velocities themselves.
        samples = np.array([t, x, np.where(np.isnan(v), 0.0, v), theta])
        followed = follow_from(bands, samples, steps, on).defects_of_v
        v[steps + 1] = np.where(np.isnan(followed), v[steps], followed)
    unknown = np.isnan(v)
    if np.any(unknown):
        v[unknown] = np.interp(t[unknown], t[~unknown], v[~unknown])
    return v
