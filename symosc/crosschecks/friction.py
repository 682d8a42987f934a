"""Faults at the belts: smoothed friction, chatter, drift during a stick, sticks that end too early or too late."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from symosc.crosschecks.causes import Case, Diagnosis, best_between, fitted, larger
from symosc.crosschecks.methods import CLASSICAL, DELAY_GRID, DELAY_LEAVES, MOST_DELAYS, runge_kutta
from symosc.crosschecks.models import rounded
from symosc.crosschecks.steps import follow_steps
from symosc.engine.state import SLIP
from symosc.kernels._generated import acceleration
from symosc.model import NEIGHBOURS


class Curve(NamedTuple):
    """A curve f(z) that replaces sign(z), z = (v - v_belt)/width.

    F, its inverse, and an integral of f(z) - sign(z).
    """

    of: Callable[[Any], Any]
    inverse: Callable[[Any], Any]
    integral: Callable[[Any], Any]


CURVES = {
    "tanh": Curve(np.tanh, np.arctanh, lambda z: np.log1p(np.exp(-2.0 * np.abs(z))) - np.log(2.0)),
    "arctan": Curve(
        lambda z: np.arctan(z) * (2.0 / np.pi),
        lambda u: np.tan(np.pi * u / 2.0),
        lambda z: 2.0 / np.pi * (z * np.arctan(z) - 0.5 * np.log1p(z * z)) - np.abs(z),
    ),
    "z/sqrt(1 + z^2)": Curve(
        lambda z: z / np.sqrt(1.0 + z * z),
        lambda u: u / np.sqrt(1.0 - u * u),
        lambda z: 1.0 / (np.sqrt(1.0 + z * z) + np.abs(z)),
    ),
}
RK4 = runge_kutta(CLASSICAL, 1 / 6, 1 / 3, 1 / 3, 1 / 6)
# Widths that differ by less than this part are one, or friction is not smoothed by that curve. A
# curve that is wider than this many times the distance of the belts is no smoothed sign.
SAME_WIDTH = 0.2
WIDEST = 3.0
# Needed friction beyond this shows nothing: the curve is flat.
FLAT_ABOVE = 0.97
# Rates of drift that differ by less than this part are taken as one rate.
SAME_RATE = 0.1
# Pieces into which a step is cut, and the part of the defects that may be left if the effect is of
# first order.
PIECES = 48
FIRST_ORDER = 0.05
# Widths that are tried, in units of the distance of the belts.
WIDTHS_TRIED = np.geomspace(1e-3, 1.0, 31)
# Numbers that differ by less than this part from stick to stick are taken as one number.
ONE_NUMBER = 1e-6


def _smoothed(name: str, width: float, error: float, evidence: str, share: float) -> Diagnosis:
    """Return the diagnosis that friction is smoothed by the curve `name`, with its fitted width."""
    words = f"friction is smoothed: like {name}((v - v_belt)/{rounded(width, error)}) in place of a sign"
    return Diagnosis("smoothed friction", name, words, evidence, width, error, share)


def _median_and_deviation(values: np.ndarray) -> tuple[float, float]:
    """Return the median of values, and their standard deviation by the median absolute deviation (MAD)."""
    middle = float(np.median(values))
    return middle, 1.4826 * float(np.median(np.abs(values - middle)))


# -- smoothed friction, chatter and drift where the mass should stick --------------------------------------------------


def at_belts(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of samples that should be on a belt but are not.

    Smoothed friction, chatter or drift.
    """
    s = case.steps
    belts = case.steps.belts
    steps = case.moving_wrong[s.last[case.moving_wrong] > 3]
    gap = s.v[steps + 1] - belts[s.last[steps] - 4]
    steps = steps[(np.abs(gap) > 0.0) & (np.abs(gap) < 0.5 * (belts[1] - belts[0]))]
    if len(steps) < 3:
        return
    share = len(steps) / int(np.sum(case.wrong))
    boundary = s.last[steps] - 3
    gap = s.v[steps + 1] - belts[boundary - 1]
    curves = _widths_in_sticks(case, steps, boundary, gap)
    name, width, error, spread = min(curves, key=lambda curve: curve[3])
    # The growth rate of the gap in steps at or near the belt, and its relative spread.
    before = s.v[steps] - belts[boundary - 1]
    near = np.isin(steps - 1, steps) | (np.abs(before) <= case.near[steps])
    count = int(np.sum(near))
    rate = 0.0
    same = np.inf
    if count >= 2:
        rate, deviation = _median_and_deviation(
            ((gap - before) / (s.t[steps + 1] - s.t[steps]))[near]
        )
        if rate:
            same = deviation / abs(rate)
        else:
            same = np.inf
    agree = SAME_WIDTH * (1 - 2 / len(steps))  # a few samples agree by chance
    if spread <= agree and spread < same and width <= WIDEST * (belts[1] - belts[0]):
        evidence = f"in sticks v creeps off the belt by the {name} of the needed friction, {len(steps)} samples"
        yield _smoothed(name, width, error, evidence, 1.0)
        return
    runs = np.diff(steps) == 1
    if np.any(runs):
        turned = float(np.mean(gap[1:][runs] * gap[:-1][runs] < 0.0))
    else:
        turned = 0.0
    largest = float(np.max(np.abs(gap)))
    if same <= SAME_RATE:
        words = f"in a stick v drifts off the belt, by {rate:.3g} per unit of time"
        yield Diagnosis(
            "drift", "", words, f"one rate in all {count} steps", rate, same * abs(rate), 1.0
        )
    elif turned > 0.2:
        words = f"v jumps to and fro about the belt's speed, by up to {largest:.3g}, where the mass should stick"
        evidence = (
            f"{len(gap)} samples; {turned:.0%} of them are on the other side than the one before"
        )
        yield Diagnosis("chatter", "", words, evidence, largest, None, share)
    else:
        words = f"in a stick v drifts off the belt, by up to {largest:.3g}"
        yield Diagnosis(
            "drift", "", words, f"{len(gap)} samples, on one side of the belt", largest, None, share
        )


def _free_acceleration(
    case: Case, x: np.ndarray, v: np.ndarray, theta: np.ndarray, boundary: np.ndarray
) -> np.ndarray:
    """Return the acceleration in states x, v, theta at the belts `boundary` if these belts had no friction."""
    K = case.steps.K
    below, above = np.array([NEIGHBOURS[b] for b in (1, 2)])[boundary - 1].T
    A = np.array([K.A1, K.A2, K.A3])
    mean = 0.5 * (A[below - 1] + A[above - 1])
    return np.asarray(acceleration(x, v, np.cos(theta), mean, K.cm, K.w0sq, K.f0))


def _half_jump(case: Case, boundary: np.ndarray) -> np.ndarray:
    """Return half the jump of the acceleration at each of the given boundaries."""
    return np.asarray(0.5 * np.array([case.steps.K.belt1.J, case.steps.K.belt2.J])[boundary - 1])


def _widths_in_sticks(
    case: Case, steps: np.ndarray, boundary: np.ndarray, gap: np.ndarray
) -> list[tuple[str, float, float, float]]:
    """Fit each of CURVES to samples in sticks whose v is off the belt's by `gap`.

    Return name, width, error, spread.

    Each sample alone gives a width. The result is their median, its standard deviation (the error),
    and the deviation of the single widths divided by the median (the spread).
    """
    s = case.steps
    K = case.steps.K
    i = steps + 1
    half = _half_jump(case, boundary)
    push = _free_acceleration(case, s.x[i], s.v[i], s.theta[i], boundary)
    slope = -K.w0sq * s.belts[boundary - 1] - K.fB * np.sin(s.theta[i])  # of the push, in a stick
    found = []
    for name, curve in CURVES.items():
        width = spread = np.nan
        needed = push / half
        for _ in range(4):  # the creep has an acceleration of its own
            good = (np.abs(needed) < FLAT_ABOVE) & (np.abs(needed) > 1.0 - FLAT_ABOVE)
            if np.sum(good) < 3:
                width = np.nan
                spread = np.inf
                break
            width, spread = _median_and_deviation(gap[good] / curve.inverse(needed[good]))
            spread /= abs(width)
            clipped = np.clip(needed, -FLAT_ABOVE, FLAT_ABOVE)
            steep = (curve.inverse(clipped + 1e-6) - curve.inverse(clipped)) / 1e-6
            needed = (push - width * steep * slope / half) / half
        if not width > 0.0:
            spread = np.inf
        found.append((name, width, float(spread * abs(width) / np.sqrt(len(steps))), spread))
    return found


# -- smoothed friction in flights --------------------------------------------------------------------------------------


def smoothed_flights(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of smoothed friction if integration with one curve and width reproduces the wrong steps."""
    wrong = case.moving_wrong[np.isfinite(case.sizes[case.moving_wrong])]
    if len(wrong) < 2:
        return
    few = case.thinned(wrong, 12)
    more = case.thinned(wrong, 60)
    distance = float(np.diff(case.steps.belts)[0])
    tried = []
    for name, curve in CURVES.items():
        sizes = np.max(
            np.abs(_misses_with_smoothing(case, few, WIDTHS_TRIED * distance, curve)), axis=2
        )
        left = np.median(np.fmin(sizes / case.sizes[few], np.inf), axis=1)
        best = int(np.argmin(left))
        tried.append((float(left[best]), float(WIDTHS_TRIED[best] * distance), name))
    for left_best, width, name in sorted(tried):
        if left_best > 2.0:
            return

        def misses(value: np.ndarray, curve: Curve = CURVES[name]) -> np.ndarray:
            return _misses_with_smoothing(case, more, np.exp(value), curve)[0]

        fit = fitted(misses, np.log([width]), np.array([1e-4]))
        if fit is None:
            part = np.inf
        else:
            part = np.nanmedian(fit.sizes / case.sizes[more])
        if (
            fit is not None
            and part <= 0.01
            and (width := float(np.exp(fit.value[0]))) <= WIDEST * distance
        ):
            evidence = f"the equation with it, integrated over {len(more)} steps, leaves {part:.1e} of their defects"
            yield _smoothed(
                name, width, width * float(fit.error[0]), evidence, case.share(fit.sizes, more)
            )
            return


def _misses_with_smoothing(
    case: Case, steps: np.ndarray, widths: np.ndarray, curve: Curve
) -> np.ndarray:
    """Return the misses of `steps` integrated with smoothed friction of each width, shape (widths, steps, 2)."""
    s = case.steps
    K = case.steps.K
    length = s.t[steps + 1] - s.t[steps]
    pull = max(
        K.belt1.J, K.belt2.J, 2.0 * float(np.max(np.abs(s.v[steps + 1] - s.v[steps]) / length))
    )
    rate = pull / np.min(widths) + np.sqrt(K.w0sq) + K.cm + K.Om
    count = int(np.clip(6.0 * rate * np.max(length), 16, 384))  # steps of the Runge-Kutta method
    h = length / count
    middle = 0.5 * (K.A1 + K.A3)
    width = widths[:, None]

    def force(t: Any, x: Any, v: Any) -> Any:
        friction = K.belt1.J * curve.of((v - K.belt1.v) / width) + K.belt2.J * curve.of(
            (v - K.belt2.v) / width
        )
        cosine = np.cos(s.theta[steps] + K.Om * t)
        return acceleration(x, v, cosine, middle, K.cm, K.w0sq, K.f0) - 0.5 * friction

    x, v = (np.broadcast_to(each[steps], (len(widths), len(steps))) for each in (s.x, s.v))
    for i in range(count):
        x, v = RK4(force, i * h, x, v, h)
    return case.misses(np.stack([x, v], axis=2), steps)


def smoothed_passages(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of smoothed friction by its first-order effect on flights and crossings near belts."""
    s = case.steps
    usable = (
        case.wrong & (s.first < 4) & (s.last < 4) & (np.diff(s.t) > 0.0) & np.isfinite(case.sizes)
    )
    usable[s.events.step[s.events.target > 3]] = False
    steps = np.flatnonzero(usable)
    steps = steps[np.argsort(-case.sizes[steps])[:40]]
    if len(steps) < 3:
        return
    time, velocity = _paths(case, steps)
    tried = []
    for name, curve in CURVES.items():
        for width in (s.K.belt2.v - s.K.belt1.v) * np.geomspace(1e-6, 1.0, 121):
            made = _smoothing_effect(case, time, velocity, width, curve)
            left = larger((made + s.defects[steps]) / case.allowed[steps]) / case.sizes[steps]
            tried.append((float(np.median(left)), name, float(width), left))
    middle, name, width, left = min(tried, key=lambda each: each[0])
    if middle <= SAME_WIDTH:
        evidence = f"to first order it leaves {middle:.0%} of the defects of {len(steps)} steps"
        # One width that fits all steps is a stronger explanation than a delay for each step.
        share = float(np.mean(left < 2.0 * SAME_WIDTH)) + 0.01
        if not (middle <= FIRST_ORDER):
            share = share * (1.0 - middle / SAME_WIDTH)
        yield _smoothed(name, width, 2.0 * max(middle, FIRST_ORDER) * width, evidence, share)


def _paths(case: Case, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cut each step into PIECES.

    Return times from the step's start and exact velocities at the ends of the pieces.
    """
    s = case.steps
    order = np.argsort(steps)
    time = np.outer(s.t[steps + 1] - s.t[steps], np.linspace(0.0, 1.0, PIECES + 1))
    velocity = np.repeat(s.v[steps][:, None], PIECES + 1, axis=1)
    for k, i in enumerate(
        steps.tolist()
    ):  # the path has a kink at each event: it is the end of a piece
        for after in (s.events.t[s.events.rows(i, i)] - s.t[i]).tolist():
            time[k, 1 + int(np.argmin(np.abs(time[k, 1:-1] - after)))] = after
    i = steps[order]
    for j in range(1, PIECES + 1):
        times = np.maximum.accumulate(np.column_stack([s.t[i], s.t[i] + time[order, j]]).ravel())
        there = follow_steps(
            case.parameters, times, np.repeat(s.x[i], 2), np.repeat(s.v[i], 2), 0.0, case.scales
        )
        velocity[order, j] += there.defects[::2, 1]
    return time, velocity


def _smoothing_effect(
    case: Case, time: np.ndarray, velocity: np.ndarray, width: float, curve: Curve
) -> np.ndarray:
    """Return the effect of smoothed friction on x and v at the ends of steps, to first order along their `_paths`."""
    K = case.steps.K
    push = np.zeros((len(time), PIECES))
    for belt in (K.belt1, K.belt2):
        gap = velocity - belt.v
        change = np.diff(gap, axis=1)
        steep = np.abs(change) > 1e-12 * (np.abs(gap[:, 1:]) + width)
        total = width * np.diff(curve.integral(gap / width), axis=1)
        push -= 0.5 * belt.J * np.where(steep, total / np.where(steep, change, 1.0), 0.0)
    impulse = push * np.diff(time, axis=1)
    left = time[:, -1:] - 0.5 * (time[:, 1:] + time[:, :-1])
    decay = np.exp(-0.5 * K.cm * left)
    frequency = np.sqrt(complex(K.w0sq - 0.25 * K.cm**2))
    if frequency:
        wave = np.real(np.sin(frequency * left) / frequency)
    else:
        wave = left
    level = np.real(np.cos(frequency * left))
    return np.column_stack([
        np.sum(impulse * decay * wave, axis=1),
        np.sum(impulse * decay * (level - 0.5 * K.cm * wave), axis=1),
    ])  # fmt: skip


# -- sticks that end too early or too late, or drift within a step -----------------------------------------------------


class StickSteps(NamedTuple):
    """Wrong steps with a stick, as columns.

    Step, belt, time and position where the stick begins, time of its end.
    """

    # In a step that ends while the mass still sticks, `end` is the end of the step.

    step: np.ndarray
    boundary: np.ndarray
    begin: np.ndarray
    x: np.ndarray
    end: np.ndarray


def _find_sticks(case: Case) -> StickSteps | None:
    """Return the wrong steps in which the samples end a stick, too early or too late.

    None if there are none.
    """
    s = case.steps
    rows = []
    for i in case.thinned(np.flatnonzero(case.wrong & (case.domain[1:] > 0)), MOST_DELAYS).tolist():
        part = s.events.rows(i, i)
        times = s.events.t[part]
        targets = s.events.target[part]
        slips = np.flatnonzero(s.events.kind[part] == SLIP)
        onsets = np.flatnonzero(targets > 3)
        boundary = int(s.first[i]) - 3
        begin = s.t[i]
        x = s.x[i]
        if len(slips):
            end = times[slips[0]]
        else:
            end = s.t[i + 1]
        if (
            s.first[i] <= 3 and case.domain[i] == 0
        ):  # the samples stick, the exact motion has gone by now
            boundary = int(_nearest_belt(case, np.array([i]))[0])
            end = begin
        elif s.first[i] <= 3 and len(onsets):
            k = int(onsets[0])
            boundary = int(targets[k]) - 3
            begin = times[k]
            x = s.events.x[part][k]
        elif s.first[i] <= 3:
            continue
        rows.append((i, boundary, begin, x, end))
    if not rows:
        return None
    table = np.array(rows)
    return StickSteps(table[:, 0].astype(int), table[:, 1].astype(int), *table[:, 2:].T)


def _nearest_belt(case: Case, samples: np.ndarray) -> np.ndarray:
    """Return the belt nearest to each sample."""
    return np.asarray(1 + np.argmin(np.abs(case.steps.v[samples, None] - case.steps.belts), axis=1))


def _kept_on(case: Case, steps: np.ndarray) -> np.ndarray:
    """Mark those of `steps` in which the samples begin on a belt and move with it up to the next sample."""
    s = case.steps
    speed = s.belts[_nearest_belt(case, steps) - 1]
    ends = np.column_stack([s.x[steps] + speed * (s.t[steps + 1] - s.t[steps]), speed])
    return np.asarray(
        (case.miss_sizes(ends, steps) <= case.limits()[steps]) & (case.domain[steps] == 0)
    )


def stick_ends(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of sticks that end too early or too late, followed by a flight in one domain."""
    sticks = _find_sticks(case)
    total = int(np.sum(case.wrong))
    s = case.steps
    if sticks is None:
        yield from _kept_too_long(case)
        return
    there = sticks.step

    def misses(time: np.ndarray) -> np.ndarray:
        return np.fmin(*(larger(_misses_at(case, sticks, time, side)) for side in (0, 1)))

    never = np.full(len(there), -1.0)
    early = best_between(misses, sticks.begin, sticks.end, 2 * DELAY_GRID, never)
    late = best_between(misses, sticks.end, s.t[there + 1], 2 * DELAY_GRID, never)
    is_late = late[1] < early[1]
    time, leaves = np.where(is_late, late, early)
    fits = leaves <= case.limits(DELAY_LEAVES)[there]
    fits &= np.abs(time - sticks.end) > 1e-6 * (s.t[there + 1] - s.t[there])
    if not np.any(fits):
        yield from _kept_too_long(case)
        return
    rest = np.setdiff1d(np.flatnonzero(case.wrong), there[fits])
    count = int(np.sum(fits))
    lasting = time[fits] - sticks.end[fits]
    if 2 * np.sum(is_late[fits]) > count:
        held = _needed_friction(case, sticks, time)[fits & is_late]
        evidence = f"{count} sticks are late by {float(np.mean(lasting)):.3g} on average"
        yield _diagnose_late_end(
            held, evidence, (count + int(np.sum(_kept_on(case, rest)))) / total
        )
        return
    words = f"sticks are left while the belt still holds, first at t = {float(time[fits][0]):.8g}"
    evidence = f"{count} sticks end up to {float(np.max(-lasting)):.3g} too early; flights without a cause follow"
    # Flights with the force of one domain, right or wrong, follow from that.
    left = np.min([case.miss_sizes(s.flight(d, rest, rest + 1), rest) for d in (1, 2, 3)], axis=0)
    share = (count + int(np.sum(left <= case.limits()[rest]))) / total
    yield Diagnosis("stick left early", "", words, evidence, share=share)


def _kept_too_long(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of sticks that end too late, from wrong steps in which samples just move on with the belt."""
    s = case.steps
    wrong = np.flatnonzero(case.wrong)
    on = wrong[(case.domain[wrong] == 0) & (s.last[wrong] <= 3)]
    on = on[_kept_on(case, on)]
    if len(on):
        ends = on[np.diff(on, append=-1) != 1] + 1
        steps = np.minimum(ends, len(s.first) - 1)
        time = s.t[ends]
        held = _needed_friction(
            case, StickSteps(steps, _nearest_belt(case, ends), time, s.x[ends], time), time
        )
        if np.median(held) > 1.0:
            evidence = f"{len(on)} steps go on with the belt where it does not hold any more"
            yield _diagnose_late_end(held, evidence, len(on) / len(wrong))


def _diagnose_late_end(held: np.ndarray, evidence: str, share: float) -> Diagnosis:
    """Return the diagnosis of sticks that end late.

    `held` is the friction there divided by the largest possible.
    """
    ratio = float(np.median(held))
    count = len(held)
    alike = np.abs(held - ratio) <= SAME_RATE * abs(ratio - 1.0) + ONE_NUMBER
    if count >= 3 and 2 * np.sum(alike) < count:
        words = "events are not located: sticks end late, each by another friction, at the end of the solver's step"
        return Diagnosis("late events", "", words, evidence, share=share)
    if count > 1:
        error = float(np.std(held) / np.sqrt(count))
    else:
        error = 0.01 * abs(ratio)
    words = f"sticks are left too late: they hold up to {ratio:.4g} times the friction (static friction?)"
    evidence = f"{evidence}; friction there {ratio:.4g} ± {error:.1g} times the limit"
    return Diagnosis("stick left late", "", words, evidence, ratio, error, share)


def _needed_friction(case: Case, sticks: StickSteps, time: np.ndarray) -> np.ndarray:
    """Return the friction that keeps the mass on the belt at a time of each stick, divided by the largest possible."""
    speed = case.steps.belts[sticks.boundary - 1]
    push = _free_acceleration(
        case,
        sticks.x + speed * (time - sticks.begin),
        speed,
        _phase(case, sticks, time),
        sticks.boundary,
    )
    return np.asarray(np.abs(push) / _half_jump(case, sticks.boundary))


def _phase(case: Case, sticks: StickSteps, time: np.ndarray) -> np.ndarray:
    """Return the phase of the drive at a time of each stick."""
    s = case.steps
    return np.asarray(s.theta[sticks.step] + s.K.Om * (time - s.t[sticks.step]))


def _misses_at(
    case: Case, sticks: StickSteps, time: np.ndarray, side: int, dx: Any = 0.0, dv: Any = 0.0
) -> np.ndarray:
    """Return by how much flights that begin where sticks end, at `time`, miss the next samples.

    They are all below the belt (`side` 0) or above it (1), and begin with errors `dx` of x and `dv`
    of v.
    """
    s = case.steps
    speed = case.steps.belts[sticks.boundary - 1]
    x = sticks.x + speed * (time - sticks.begin) + dx
    tau = s.t[sticks.step + 1] - time
    return case.misses(
        s.fly(sticks.boundary + side, x, speed + dv, _phase(case, sticks, time), tau), sticks.step
    )


def drift_within_steps(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of a velocity that drifts off the belt in sticks, visible in the next flight."""
    sticks = _find_sticks(case)
    if sticks is None:
        return
    T = sticks.end - sticks.begin
    best = np.zeros(len(T))
    leaves = np.full(len(T), np.inf)
    unit = case.scales[1] / np.maximum(T, 1e-300) * 1e-6
    for side in (0, 1):
        base = _misses_at(case, sticks, sticks.end, side)
        slope = (
            _misses_at(case, sticks, sticks.end, side, 0.5 * unit * T * T, unit * T) - base
        ) / unit[:, None]
        rate = -np.sum(slope * base, axis=1) / np.maximum(np.sum(slope * slope, axis=1), 1e-300)
        left = larger(base + slope * rate[:, None])
        best = np.where(left < leaves, rate, best)
        leaves = np.minimum(left, leaves)
    fits = (leaves <= case.limits(0.1)[sticks.step]) & (
        np.abs(best) * T <= 0.02 * case.scales[1]
    )  # more is no drift
    if np.any(fits):
        middle, spread = _median_and_deviation(best[fits])
    else:
        middle, spread = (0.0, np.inf)
    if spread <= SAME_RATE * abs(middle):
        # One rate that fits all sticks is a stronger explanation than an end for each stick.
        count = int(np.sum(fits))
        if spread <= ONE_NUMBER * abs(middle):
            surely = 0.01
        else:
            surely = 0.0
        words = f"in a stick v drifts off the belt, by {middle:.3g} per unit of time"
        evidence = f"one rate explains what follows {count} sticks"
        if count > 1:
            error = spread
        else:
            error = None
        yield Diagnosis(
            "drift", "", words, evidence, middle, error, surely + count / int(np.sum(case.wrong))
        )
