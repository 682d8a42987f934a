"""Faults of numerical methods as causes.

Events missed, late or gone over, and steps that are too large.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from symosc.crosschecks.causes import (
    FITS,
    Diagnosis,
    Explanation,
    FaultySteps,
    best_between,
    larger,
)
from symosc.engine.state import ON_BELT
from symosc.kernels._generated import acceleration
from symosc.simulation.tables import counted

# Grid points for the time up to which an old mode goes on, and how often the grid is refined.
DELAY_GRID = 9
REFINEMENTS = 12
# Events of a step that may be late, and ways to explain a step that are refined.
MOST_EVENTS = 4
LIKELY = 4
# A delay by more than this part of what is left of the step is the whole step: the event is missed.
WHOLE = 0.999
# Sticks that end under friction that differs by less than this part are left by one rule.
ONE_FRICTION = 1e-3


# -- events that are missed or late ----------------------------------------------------------------


class Delays(NamedTuple):
    """Explanations of steps by events that are late, as columns: in each row an old mode goes on
    from `begin` up to some time, then comes a new one.

    The old mode `source` begins at time, position, velocity and phase `t`, `x`, `v`, `theta`:
    those of the first sample of the step, or of an event in it. `source` and `target` are codes of
    MODE_NAMES; `onto` is the belt whose speed v takes when the new mode begins, or 0.
    """

    step: np.ndarray
    source: np.ndarray
    target: np.ndarray
    onto: np.ndarray
    begin: np.ndarray
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    theta: np.ndarray


def late_events(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis of events that happen too late or not at all.

    Up to then the old mode goes on.
    """
    s = case.steps
    steps = case.telling
    delays = _delays(case, steps)
    if not len(delays.step):
        return
    # A rough search for the delay leaves a few rows for each step, a finer one the best of them.
    likely = _fit_delays(case, delays, 1, LIKELY).rows
    delays = Delays(*(column[likely] for column in delays))
    fit = _fit_delays(case, delays, REFINEMENTS, 1)
    best = fit.rows[fit.misses[fit.rows] <= 1.0]
    left = case.leaving(case.sizes[steps], steps)
    left[delays.step[best]] = 0.0
    if len(best):
        kept = Delays(*(column[best] for column in delays))
        share = fit.shares[best]
        delay = share * (s.t[kept.step + 1] - kept.begin)
        yield Explanation(_late_words(case, kept, delay, share >= WHOLE), left=left)


class FittedDelays(NamedTuple):
    """The best rows of `Delays` for each step and, for all rows, the best delay as a share of what
    is left of the step, and what is missed with it: at most 1 if the step is explained.
    """

    rows: np.ndarray
    shares: np.ndarray
    misses: np.ndarray


def _fit_delays(case: FaultySteps, delays: Delays, rounds: int, most: int) -> FittedDelays:
    """Fit the delay of each row, in so many `rounds`, and choose the best rows of each step, at
    most `most`.
    """
    s = case.steps
    time_left = s.t[delays.step + 1] - delays.begin
    # Allowed in x and in v: what rounding does, or a small part of the step's own defect.
    allowed = np.maximum(1.0, FITS * np.abs(s.defects / case.allowed)[delays.step])

    def misses_with(share: np.ndarray) -> np.ndarray:
        """Return by how much steps are missed if the delays are this share of the time left."""
        misses = _delayed_misses(case, delays, delays.begin + share * time_left)
        return np.nan_to_num(larger(misses / allowed), nan=np.inf)

    zero = np.zeros(len(time_left))
    shares, misses = best_between(misses_with, zero, zero + 1.0, DELAY_GRID, zero + 0.5, rounds)
    order = np.lexsort((misses, delays.step))  # by step, the best row of each first
    _, first_of_step = np.unique(delays.step[order], return_index=True)
    places = np.arange(len(order))
    rank = places - first_of_step[np.searchsorted(first_of_step, places, "right") - 1]
    return FittedDelays(order[rank < most], shares, misses)


def _delays(case: FaultySteps, steps: np.ndarray) -> Delays:
    """Return the ways to explain each of `steps` by an event that is late."""
    rows = list[tuple[float, ...]]()
    for i in steps.tolist():
        for old in _old_modes(case, i):
            belt = old.belt
            # What may follow: a new mode, and the belt whose speed v takes (0: it keeps v).
            targets_and_onto = (
                (belt, 0),
                (belt + 1, 0),
                (ON_BELT + belt, belt),
                (belt, belt),
                (belt + 1, belt),
            )
            for target, onto in targets_and_onto:
                if (target, onto) != (old.mode, 0):  # that would be no event
                    rows.append((i, old.mode, target, onto, old.begin, *old.state))
    table = np.array(rows, dtype=float).reshape(-1, len(Delays._fields)).T
    step, source, target, onto = table[:4].astype(int)
    return Delays(step, source, target, onto, *table[4:])


class OldMode(NamedTuple):
    """A mode that may go on although an event at a belt ends it at the time `begin`; `state` has
    t, x, v and theta where the mode begins.
    """

    mode: int
    belt: int
    begin: float
    state: tuple[float, ...]


def _old_modes(case: FaultySteps, i: int) -> list[OldMode]:
    """Return the modes that may go on for too long in step `i`."""
    s = case.steps
    domain = int(case.domain[i])
    state: tuple[float, ...] = (s.t[i], s.x[i], s.v[i], s.theta[i])
    old_modes = list[OldMode]()
    # The step may begin after an event that the samples do not know of yet.
    if domain == 0:
        belt = 1 + int(np.argmin(np.abs(s.v[i] - s.belts)))
        if i == 0 or case.domain[i - 1] == 0:
            mode = ON_BELT + belt
        else:
            mode = int(case.domain[i - 1])
        if mode != s.first[i]:
            old_modes.append(OldMode(mode, belt, s.t[i], state))
    elif i > 0 and case.wrong[i - 1]:
        # The belt is the first on the way to the domain of the old mode.
        belts = {mode: domain - (mode < domain) for mode in (1, 2, 3) if mode != domain}
        old_modes += [OldMode(mode, belt, s.t[i], state) for mode, belt in belts.items()]
    mode = int(s.first[i])
    events = s.events.rows(i, i)
    for k in range(events.start, min(events.stop, events.start + MOST_EVENTS)):
        belt = int(s.events.boundary[k])
        old_modes.append(OldMode(mode, belt, s.events.t[k], state))
        mode = int(s.events.target[k])
        state = (s.events.t[k], s.events.x[k], s.belts[belt - 1], s.events.theta[k])
    return old_modes


def _delayed_misses(case: FaultySteps, delays: Delays, time: np.ndarray) -> np.ndarray:
    """Return by how much the ends of steps are missed if old modes go on up to a `time` each."""
    s = case.steps
    start = np.array([delays.x, delays.v])
    x, v = _moved(case, delays.source, start, delays.theta, time - delays.t)
    v = np.where(delays.onto > 0, s.belts[delays.onto - 1], v)
    theta = delays.theta + s.K.Om * (time - delays.t)
    x, v = _moved(case, delays.target, np.array([x, v]), theta, s.t[delays.step + 1] - time)
    return case.misses(np.column_stack([x, v]), delays.step)


def _moved(
    case: FaultySteps, mode: np.ndarray, state: np.ndarray, theta: np.ndarray, tau: np.ndarray
) -> np.ndarray:
    """Return x and v after times `tau` in the given modes, without any event."""
    s = case.steps
    x, v = state
    held = mode > ON_BELT
    speed = s.belts[np.where(held, mode - ON_BELT - 1, 0)]
    flown = s.fly(np.where(held, 1, mode), x, v, theta, tau).T
    return np.where(held, [x + speed * tau, speed], flown)


def _late_words(
    case: FaultySteps, delays: Delays, delay: np.ndarray, is_whole: np.ndarray
) -> Diagnosis:
    """Return the diagnosis of late events, which explain a step by each row of `delays` and its
    `delay`; `is_whole` marks delays up to the end of the step.
    """
    count = len(delay)
    first = f"the first wrong one begins at t = {float(case.steps.t[delays.step[0]]):.10g}"
    if np.all(delays.source > ON_BELT):
        words = (
            "sticks end too late: the samples go on with the belt where it does not hold any more "
            f"({first})"
        )
        ratio, spread = _friction_at_ends(case, delays, delay)
        evidence = f"{counted(count, 'step')} tried and explained by it"
        if count > 1 and spread <= ONE_FRICTION * ratio:
            words += (
                f", up to {ratio:.4g} times the friction of the flight, "
                "as if static friction were larger"
            )
            return Diagnosis("late events", "stick", words, evidence, ratio, spread)
        return Diagnosis("late events", "stick", words, evidence, float(np.max(delay)), None)
    # The event shows if it begins in the step, and the old mode does not go on to the next sample.
    begins_in_step = delays.begin > case.steps.t[delays.step]
    goes_on = is_whole & (case.domain[delays.step + 1] == delays.source)
    seen = begins_in_step & ~goes_on
    if 2 * np.sum(seen) <= count:
        words = f"events are missed: the motion goes on as if it had not met a belt ({first})"
        evidence = f"the force from before the event explains {counted(count, 'step')} tried"
        return Diagnosis("late events", "", words, evidence)
    late = delay[seen]
    words = f"events happen too late, by up to {float(np.max(late)):.3g} ({first})"
    evidence = (
        f"a delay of each explains {counted(count, 'step')} tried; "
        f"on average {float(np.mean(late)):.3g}"
    )
    return Diagnosis("late events", "", words, evidence, float(np.mean(late)), float(np.std(late)))


def _friction_at_ends(case: FaultySteps, delays: Delays, delay: np.ndarray) -> tuple[float, float]:
    """Return the median and the largest deviation of the friction where sticks end, divided by that
    of a flight.
    """
    s = case.steps
    K = case.steps.K
    ends_in_step = delays.begin + delay < s.t[delays.step + 1]
    ends = ends_in_step & (delay > 0.0)
    if not np.any(ends):
        return np.nan, np.inf
    time = (delays.begin + delay - delays.t)[ends]
    belt = delays.source[ends] - ON_BELT
    speed = s.belts[belt - 1]
    x = delays.x[ends] + speed * time
    # The friction of a flight is half the jump of the force; the force without friction, the mean
    # of those below and above the belt, is what friction has to hold.
    A = np.array([K.A1, K.A2, K.A3])
    half = 0.5 * (A[belt - 1] - A[belt])
    cosine = np.cos(delays.theta[ends] + K.Om * time)
    push = acceleration(x, speed, cosine, A[belt] + half, K.cm, K.w0sq, K.f0)
    ratio = np.abs(push) / half
    return float(np.median(ratio)), float(np.max(np.abs(ratio - np.median(ratio))))


# -- events that a method goes over, and chatter ---------------------------------------------------

# A method goes over the events of a step if the force below the belt has another part of the step
# than in the exact motion, by so much in the middle of all steps.
OTHER_PART = 0.02
# How far the part of the force below may be beyond its bounds, judged by v and by x, if flights are
# right; and if the method has errors in flights too, of which those of Euler's in x are half the
# step squared times the acceleration.
MARGINS = (0.06, 0.06)
WIDE_MARGINS = (0.2, 1.0)
# In a stick v turns back in this part of the steps, or it is no chatter but a slow change.
TURNED = 0.35


def gone_over(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that a method goes over events.

    Where the mass should stick, v jumps to and fro.
    """
    steps = case.telling
    mixtures = _mixtures(case, steps)
    fits = mixtures.fits
    if not np.any(fits):
        return
    left = case.leaving(np.where(fits, 0.0, case.sizes[steps]), steps)
    diagnosis = _gone_over_words(case, steps[fits], mixtures.excess[fits], mixtures.sticks[fits])
    if diagnosis is not None:
        yield Explanation(diagnosis, left=left)


def _gone_over_words(
    case: FaultySteps, steps: np.ndarray, excess: np.ndarray, sticks: np.ndarray
) -> Diagnosis | None:
    """Return the diagnosis of steps that go over events; None if they show no pattern of it.

    `excess` and `sticks` are those of `Mixtures`.
    """
    s = case.steps
    first = f"first at t = {float(s.t[steps[0]]):.10g}"
    if 2 * np.sum(sticks) >= len(steps):
        nearest_belt = np.argmin(np.abs(s.v[:, None] - s.belts), axis=1)
        gap = s.v - s.belts[nearest_belt]
        # Pairs of wrong steps, one after the other, that both end in a stick: v turns back in them.
        in_stick = case.wrong & (s.last > ON_BELT)
        pairs = np.flatnonzero(in_stick[1:] & in_stick[:-1])
        changes = np.diff(gap)
        turned = 0.0
        if len(pairs):
            turned = float(np.mean(changes[pairs] * changes[pairs + 1] < 0.0))
        if turned < TURNED:
            return None
        largest = float(np.max(np.abs(gap[steps[sticks] + 1])))
        words = (
            "where the mass should stick, v jumps to and fro about the belt's speed, "
            f"by up to {largest:.3g} ({first})"
        )
        evidence = (
            f"friction makes such jumps in {counted(len(steps), 'step')} tried; "
            f"v turns back in {turned:.0%} of the steps in sticks"
        )
        return Diagnosis("chatter", "", words, evidence, largest, None)
    if np.median(np.abs(excess[~sticks])) < OTHER_PART:
        return None
    words = f"events are not located: the method goes over them ({first})"
    off = float(np.median(np.abs(excess)))
    evidence = (
        f"in {counted(len(steps), 'step')} tried a force acts too long or too short, "
        f"by {off:.0%} of the step"
    )
    return Diagnosis("late events", "", words, evidence, off, None)


class Mixtures(NamedTuple):
    """Which steps a mixture of the forces on both sides of a belt explains.

    `excess` says how much longer the force below the belt acts than in the exact motion, as a share
    of the step; `sticks` marks steps in which the exact motion sticks.
    """

    fits: np.ndarray
    excess: np.ndarray
    sticks: np.ndarray


def _mixtures(case: FaultySteps, steps: np.ndarray, any_stick: bool = False) -> Mixtures:
    """Return which of `steps` a mixture of the forces on both sides of a belt explains.

    Where the exact motion sticks, v has to be about the belt's speed, unless `any_stick` allows all
    sticks.
    """
    s = case.steps
    sticks = (s.last[steps] > ON_BELT) | (s.first[steps] > ON_BELT)
    sticks |= np.isin(steps, s.events.step[s.events.target > ON_BELT])
    fits = np.zeros(len(steps), bool)
    excess = np.zeros(len(steps))
    begin = s.v[steps]
    end = s.v[steps + 1]
    for belt, speed in enumerate(s.belts.tolist(), 1):
        below, above = (s.flight(belt + side, steps, steps + 1) for side in (0, 1))
        gap_x, gap_v = (below - above).T
        is_bounded, excess_here = _shares_below(case, steps, above, gap_x, gap_v)
        passes = (begin - speed) * (end - speed) < 0.0
        passes |= np.isin(steps, s.events.step[s.events.boundary == belt])
        # Where the exact motion sticks in the step, a stick with a fault looks like a mixture too:
        # v has to be about the belt's speed, as near as at the ends of steps that end in a stick.
        reach = np.abs(gap_v)  # what friction can do within the step
        ends_near = (end != speed) & (np.abs(end - speed) <= reach)
        begins_near = (begin != speed) & (np.abs(begin - speed) <= reach)
        about = (s.last[steps] == ON_BELT + belt) & ends_near
        nearest = np.max(np.abs(end - speed)[about], initial=0.0)
        begins = sticks & (begin != speed) & (np.abs(begin - speed) <= nearest)
        about |= (s.last[np.maximum(steps - 1, 0)] == ON_BELT + belt) & begins_near
        passes &= ~sticks | begins | any_stick
        at_belt = is_bounded & (passes | about)
        excess[at_belt] = excess_here[at_belt]
        fits |= at_belt
    return Mixtures(fits, excess, sticks)


def _shares_below(
    case: FaultySteps, steps: np.ndarray, above: np.ndarray, gap_x: np.ndarray, gap_v: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return whether the ends of steps are possible with the force below a belt for a share of the
    step and that above it for the rest, and how much longer that is than in the exact motion.

    `above` are the ends with the force above alone; with the force below x and v are larger by
    `gap_x` and `gap_v`.
    """
    s = case.steps
    if case.flights_wrong > 0.5:
        in_v, in_x = WIDE_MARGINS
    else:
        in_v, in_x = MARGINS
    # Where the samples end, and the exact motion.
    end_x, end_v = s.states[steps + 1].T
    _, exact_v = (s.states[steps + 1] + s.defects[steps]).T
    above_x, above_v = above.T
    # For which share of the step the force below acts, by v; and which share of its effect on x it
    # has: share^2 if it acts last, 2 share - share^2 if it acts first, or something in between.
    share = (end_v - above_v) / gap_v
    exact_share = (exact_v - above_v) / gap_v
    share_of_x = (end_x - above_x) / gap_x
    is_bounded = (share_of_x >= share**2 - in_x) & (share_of_x <= 2.0 * share - share**2 + in_x)
    is_bounded &= (share >= -in_v) & (share <= 1.0 + in_v)
    return is_bounded, share - exact_share


# -- steps that are too large ----------------------------------------------------------------------

# The errors of a method are powers of the step times fixed combinations of x, v, cos, sin and 1,
# since flights are linear. Powers that are tried, as many at once where steps differ, and flights
# for each fitted number.
POWERS = range(2, 7)
TOGETHER = 3
PER_NUMBER = 3
MOST_FLIGHTS = 400
FEWEST_IN_DOMAIN = 6
# Steps that differ by less than this part are equal. Fewest wrong flights that show an order.
EQUAL = 1e-6
FEWEST_WRONG = 20
# What the fit may leave, in parts of a step's own defect or of half the largest one, whichever is
# more.
LEFT_BY_FIT = 0.03
# Up to this part of dx the errors of flights are like those of a wrong force.
LIKE_FORCE = 0.3
# An error of x by more than this part of h v is that of weights which do not add up to 1
# (test_weights_beyond_one_are_no_large_steps: 0.12; consistent methods there 0.02).
LIKE_WEIGHTS = 0.05
# The share of flights whose errors have to be as small as those of a method.
NEARLY_ALL = 0.95


def large_steps(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis of steps that are too large, if powers of the step explain the errors."""
    s = case.steps
    telling_flights = np.intersect1d(case.telling, case.inside)
    inside = np.union1d(case.thinned(case.inside, MOST_FLIGHTS), telling_flights)
    # A domain with few flights does not show a law.
    counts = np.bincount(case.domain[inside], minlength=4)
    flights = inside[counts[case.domain[inside]] >= FEWEST_IN_DOMAIN]
    if len(np.intersect1d(flights, case.inside_wrong)) < FEWEST_WRONG:
        return
    if case.flights_wrong < 0.5 or not _like_truncation(case, flights):
        return
    defects = s.defects[flights] / case.allowed[flights]
    sizes = larger(defects)
    h = np.diff(s.t)[flights]
    equal = np.ptp(h) <= EQUAL * np.max(h)
    choices = [tuple(range(power, power + TOGETHER)) for power in POWERS]
    if equal:
        # Nothing then shows how errors fall with the step, and any linear method fits.
        if _lost_way(case, flights) > LIKE_WEIGHTS:
            return
        choices = [(0,)]
    best = np.full(len(flights), np.inf)
    order = 0
    for powers in choices:
        missed = _left_by_powers(case, flights, defects, powers)
        if np.median(missed) < np.median(best):
            best = missed
            order = min(powers)
    limit = np.maximum(1.0, LEFT_BY_FIT * np.maximum(sizes, 0.5 * np.max(sizes)))
    fits = best <= limit
    left = case.leaving(np.where(fits, 0.0, sizes), flights)
    # Elsewhere the errors are as large, also if the method goes over events, or misses them.
    others = np.setdiff1d(case.telling, flights)
    most = 2.0 * float(np.max(sizes))
    without_event = s.flight(np.maximum(case.domain[others], 1), others, others + 1)
    is_explained = case.sizes[others] <= most
    is_explained |= case.miss_sizes(without_event, others) <= most
    is_explained |= _mixtures(case, others, any_stick=True).fits
    left[others] = np.where(is_explained, 0.0, case.sizes[others])
    size = float(np.median(np.max(np.abs(s.defects[case.inside_wrong]) / case.scales, axis=1)))
    words = (
        "the solver's steps are too large, or its tolerance: "
        f"a flight is off by about {size:.1e} of the largest |x|, |v| in each step"
    )
    if equal:
        law = "one linear map of x, v and the drive"
    else:
        law = f"powers of the step from {order} on"
    evidence = f"the errors of {int(np.sum(fits))} of {len(flights)} flights follow from {law}"
    yield Explanation(Diagnosis("steps too large", "", words, evidence, size, None), left=left)


def _like_truncation(case: FaultySteps, flights: np.ndarray) -> bool:
    """Return whether the errors of flights can be those of a method, and not those of a wrong
    force.
    """
    s = case.steps
    h = np.diff(case.steps.t)[flights]
    dx, dv = s.defects[flights].T
    # A wrong force changes x by half the step times the change of v.
    is_like_force = np.sum((dx - 0.5 * h * dv) ** 2) <= (LIKE_FORCE**2) * np.sum(dx**2)
    A = np.array([s.K.A1, s.K.A2, s.K.A3])[case.domain[flights] - 1]
    K = s.K
    a = acceleration(s.x[flights], s.v[flights], np.cos(s.theta[flights]), A, K.cm, K.w0sq, K.f0)
    # A bound of the derivative of a: even Euler's method makes no larger errors than these.
    slope = K.cm * np.max(np.abs(a)) + K.w0sq * np.max(np.abs(s.v)) + abs(K.f0) * K.Om
    are_small = (np.abs(dx) <= h**2 * np.max(np.abs(a))) & (np.abs(dv) <= h**2 * slope)
    return bool(not is_like_force and np.mean(are_small) > NEARLY_ALL)


def _lost_way(case: FaultySteps, flights: np.ndarray) -> float:
    """Return by which part of the step times v the solution moves too far or not far enough."""
    s = case.steps
    h = np.diff(s.t)[flights]
    basis = _linear_terms(case, flights) * h[:, None]
    defects_x, _ = s.defects[flights].T
    coefficients, *_ = np.linalg.lstsq(basis, defects_x, rcond=1e-12)
    _, of_v, *_ = coefficients  # in the order of `_linear_terms`
    return abs(float(of_v)) / float(np.max(np.abs(s.v[flights])))


def _linear_terms(case: FaultySteps, flights: np.ndarray) -> np.ndarray:
    """Return x, v, the drive and the domain of flights, each divided by its largest value."""
    s = case.steps
    theta = s.theta[flights]
    domains = [case.domain[flights] == d for d in np.unique(case.domain[flights])]
    terms = np.column_stack([s.x[flights], s.v[flights], np.cos(theta), np.sin(theta), *domains])
    return np.asarray(terms / np.maximum(np.max(np.abs(terms), axis=0), 1e-300))


def _left_by_powers(
    case: FaultySteps, flights: np.ndarray, defects: np.ndarray, powers: tuple[int, ...]
) -> np.ndarray:
    """Return what a fit to every second flight leaves of the defects of the others, for all
    flights.
    """
    h = np.diff(case.steps.t)[flights]
    basis = _linear_terms(case, flights)
    matrix = np.hstack([basis * (h[:, None] / np.max(h)) ** power for power in powers])
    left = np.full(len(flights), np.inf)
    if PER_NUMBER * matrix.shape[1] > len(flights):
        return left
    even = np.arange(len(flights)) % 2 == 0
    for used in (even, ~even):
        coefficients, *_ = np.linalg.lstsq(matrix[used], defects[used], rcond=1e-12)
        left[~used] = larger(matrix[~used] @ coefficients - defects[~used])
    return left
