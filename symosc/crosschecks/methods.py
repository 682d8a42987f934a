"""Faults of numerical methods as causes.

Events missed, late or gone over, and steps that are too large.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from symosc.crosschecks.causes import (
    ENOUGH,
    FITS,
    Diagnosis,
    Explanation,
    FaultySteps,
    best_between,
    larger,
)
from symosc.engine.state import ON_BELT
from symosc.kernels import entire_array
from symosc.kernels._generated import acceleration
from symosc.simulation.tables import counted

# Grid points for the time up to which an old mode goes on, and how often the grid is refined.
DELAY_GRID = 17
REFINEMENTS = 11
# Events of a step that may be late.
MOST_EVENTS = 4
# A delay by more than this part of what is left of the step is the whole step: the event is missed.
WHOLE = 0.999
# Of the steps that delays explain at least this part must say more than how long the delay is.
FEWEST_SHOWN = 0.25
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
    fit = _fit_delays(case, delays)
    best = fit.rows[fit.misses[fit.rows] <= 1.0]
    left = case.leaving(case.sizes[steps], steps)
    left[delays.step[best]] = 0.0
    # In a step that ends in a stick v is the belt's, and some delay always gives the right x.
    shows = (delays.target[best] <= ON_BELT) | (fit.shares[best] >= WHOLE)
    if len(best) and np.mean(shows) >= FEWEST_SHOWN:
        kept = Delays(*(column[best] for column in delays))
        share = fit.shares[best]
        delay = share * (s.t[kept.step + 1] - kept.begin)
        yield Explanation(_late_words(case, kept, delay, share >= WHOLE), left=left)


class FittedDelays(NamedTuple):
    """The best row of `Delays` for each step and, for all rows, the best delay as a share of what
    is left of the step, and what is missed with it: at most 1 if the step is explained.
    """

    rows: np.ndarray
    shares: np.ndarray
    misses: np.ndarray


def _fit_delays(case: FaultySteps, delays: Delays) -> FittedDelays:
    """Fit the delay of each row, and choose the best row of each step."""
    s = case.steps
    time_left = s.t[delays.step + 1] - delays.begin
    # Allowed in x and in v: what rounding does, or a small part of the step's own defect.
    allowed = np.maximum(1.0, FITS * np.abs(s.defects / case.allowed)[delays.step])

    def misses_with(share: np.ndarray) -> np.ndarray:
        """Return by how much steps are missed if the delays are this share of the time left."""
        misses = _delayed_misses(case, delays, delays.begin + share * time_left)
        return np.nan_to_num(larger(misses / allowed), nan=np.inf)

    zero = np.zeros(len(time_left))
    shares, misses = best_between(
        misses_with, zero, zero + 1.0, DELAY_GRID, zero + 0.5, REFINEMENTS
    )
    order = np.lexsort((misses, delays.step))  # by step, the best row of each first
    _, first_of_step = np.unique(delays.step[order], return_index=True)
    return FittedDelays(order[first_of_step], shares, misses)


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
        # A stick, which may have begun in the step before, or a flight that met the belt.
        modes = [ON_BELT + belt]
        if i > 0 and case.domain[i - 1] > 0:
            modes.append(int(case.domain[i - 1]))
        old_modes += [OldMode(mode, belt, s.t[i], state) for mode in modes if mode != s.first[i]]
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
        if _may_be_early(case, delays, delay):
            words = (
                f"sticks end at wrong times, too late or too early, by up to {float(np.max(delay)):.3g} "
                f"({first}): these samples do not show which"
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
    # With one mode before and after, the belt is not met at all.
    goes_on |= delays.target == delays.source
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


def _may_be_early(case: FaultySteps, delays: Delays, delay: np.ndarray) -> bool:
    """Return whether sticks that end too early by `delay`, not too late, explain the steps as
    well.

    To second order both change the velocity alike; x differs by the third power of the delay.
    """
    misses = _delayed_misses(case, delays, np.maximum(delays.begin - delay, delays.t))
    own = np.maximum(1.0, FITS * np.abs(case.steps.defects / case.allowed)[delays.step])
    return bool(np.all(larger(misses / own) <= 1.0))


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
# Crossings that show a method which goes over them, and the least response of v to an impulse that
# says how large it was.
FEWEST_PASSED = 3
LEAST_RESPONSE = 0.05
# A method's own steps are at most so many times the longest time for which a wrong force acts: the
# weights of Runge-Kutta methods make it act for a sixth of the step, or less.
OWN_STEP = 5.0
# The defects of flights are this part of those at events, if the method's order shows in flights.
FLIGHTS_LESS = 0.2
# Times in a step at which the effect of a force is computed.
SHARES = 65
# In a stick v turns back in this part of the steps, or it is no chatter but a slow change.
TURNED = 0.35


def gone_over(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that a method goes over events.

    Where the mass should stick, v jumps to and fro.
    """
    steps = case.telling
    fits, excess, sticks = _mixtures(case, steps)
    crossings = fits & ~sticks
    shown = _are_local(case, steps[crossings])
    if np.sum(crossings) >= FEWEST_PASSED:
        shown |= bool(np.median(np.abs(excess[crossings])) >= OTHER_PART)
    # A method that goes over crossings goes over sticks too: no sample is on a belt.
    in_sticks = shown and not np.any(case.domain[1:] == 0)
    if in_sticks:
        fits, excess, sticks = _mixtures(case, steps, any_stick=True)
    if not np.any(fits):
        return
    left = case.leaving(np.where(fits, 0.0, case.sizes[steps]), steps)
    # The method's steps may be too large for flights too, which then show less of it.
    at_events = case.sizes[np.setdiff1d(steps[fits], case.inside)]
    if case.flights_wrong > 0.5 and len(at_events) >= FEWEST_PASSED:
        is_less = np.median(case.sizes[case.inside]) <= FLIGHTS_LESS * np.median(at_events)
        if is_less and _like_truncation(case, case.inside):
            left[case.inside] = 0.0
    diagnosis = _gone_over_words(case, steps[fits], excess[fits], sticks[fits], (shown, in_sticks))
    if diagnosis is not None:
        yield Explanation(diagnosis, left=left)


def _are_local(case: FaultySteps, steps: np.ndarray) -> bool:
    """Return whether the defects of steps that pass a belt come from about the time of passing.

    There a method has, for a part of one of its own steps, the force of the wrong side.
    """
    s = case.steps
    rows = np.searchsorted(s.events.step, steps)
    is_single = np.searchsorted(s.events.step, steps, "right") == rows + 1
    rows = rows[is_single]
    steps = steps[is_single]
    if len(steps) < FEWEST_PASSED:
        return False
    A = np.array([s.K.A1, s.K.A2, s.K.A3])
    belt = s.events.boundary[rows]
    gap = A[belt - 1] - A[belt]
    # An impulse at the event, of the size of the force's jump, changes v by E0 and x by E1.
    E0, E1, *_ = entire_array.basis(s.t[steps + 1] - s.events.t[rows], s.K)
    dx, dv = s.defects[steps].T
    # The jump acts too long or too short by a part of the method's step, which is a part of the step
    # between samples.
    h = np.diff(s.t)[steps]
    lasts = np.abs(dv) / (gap * np.maximum(np.abs(E0), LEAST_RESPONSE))
    own_part = OWN_STEP * float(np.max(lasts / h))
    rest = np.abs(dx - dv * E1 / np.where(np.abs(E0) > LEAST_RESPONSE, E0, np.inf))
    local = rest <= gap * (own_part * h) ** 2 + case.allowed[steps, 0]
    return bool(np.mean(local) >= ENOUGH and own_part <= 1.0)


def _gone_over_words(
    case: FaultySteps,
    steps: np.ndarray,
    excess: np.ndarray,
    sticks: np.ndarray,
    shown: tuple[bool, bool],
) -> Diagnosis | None:
    """Return the diagnosis of steps that go over events; None if they show no pattern of it.

    `excess` and `sticks` are those of `Mixtures`; `shown` says whether crossings show the pattern,
    and whether no sample is on a belt either.
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
        if turned >= TURNED:
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
        if not shown[1]:
            return None
    if not shown[0]:
        return None
    words = f"events are not located: the method goes over them ({first})"
    off = float(np.median(np.abs(excess)))
    evidence = (
        f"in {counted(len(steps), 'step')} tried a force acts too long or too short, "
        f"by {100.0 * off:.2g}% of the step"
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
    # has: it acts last, or first, or in between.
    share = (end_v - above_v) / gap_v
    exact_share = (exact_v - above_v) / gap_v
    share_of_x = (end_x - above_x) / gap_x
    least, most = _parts_of_x(case, steps, share)
    is_bounded = (share_of_x >= least - in_x) & (share_of_x <= most + in_x)
    is_bounded &= (share >= -in_v) & (share <= 1.0 + in_v)
    return is_bounded, share - exact_share


def _parts_of_x(
    case: FaultySteps, steps: np.ndarray, part: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the largest part that a force can have in x if it has this `part` in v.

    It has the least if it acts at the end of the step, and the largest if it acts at the beginning.
    """
    # The effects of a force that lasts for a time u are E1(u) on v and E2(u) on x.
    tau = np.diff(case.steps.t)[steps]
    shares = np.linspace(0.0, 1.0, SHARES)
    _, E1, E2, *_ = entire_array.basis(np.outer(tau, shares), case.steps.K)
    on_v = E1 / E1[:, -1:]
    on_x = E2 / E2[:, -1:]
    part = np.clip(part, 0.0, 1.0)
    least = np.array([np.interp(*row) for row in zip(part, on_v, on_x, strict=True)])
    most = 1.0 - np.array([np.interp(*row) for row in zip(1.0 - part, on_v, on_x, strict=True)])
    return least, most


# -- steps that are too large ----------------------------------------------------------------------

# The errors of a method are powers of the step times fixed combinations of x, v, cos, sin and 1,
# since flights are linear. Powers that are tried, as many at once where steps differ, and flights
# for each fitted number.
POWERS = range(2, 7)
TOGETHER = (3, 5)
PER_NUMBER = 3
MOST_FLIGHTS = 400
FEWEST_IN_DOMAIN = 6
# Part of the flights, the longest ones, that are in each fit.
LONGEST = 0.03
# Steps that differ by less than this part are equal. Fewest wrong flights that show an order.
EQUAL = 1e-6
FEWEST_WRONG = 20
# What the fit may leave, in parts of a step's own defect or of half the largest one, whichever is
# more.
LEFT_BY_FIT = 0.03
# Up to this part of dx the errors of flights are like those of a wrong force.
LIKE_FORCE = 0.3
# An error of x by more than this part of h v is that of weights which do not add up to 1
# (test_weights_beyond_one_are_no_large_steps: 0.12; consistent methods there 0.02). How many powers
# of unequal steps are fitted to tell it from other errors: the least part counts.
LIKE_WEIGHTS = 0.05
WAY_POWERS = 4
# A way that is h v to this part of the largest one is that of Euler's method.
EXACT_WAY = 1e-9
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
    h = np.diff(s.t)[flights]
    # Short steps may be right.
    is_long = h >= float(np.median(h[case.wrong[flights]]))
    if np.mean(case.wrong[flights][is_long]) < 0.5 or not _like_truncation(case, flights):
        return
    defects = s.defects[flights] / case.allowed[flights]
    sizes = larger(defects)
    equal = np.ptp(h) <= EQUAL * np.max(h)
    choices = [tuple(range(power, power + count)) for count in TOGETHER for power in POWERS]
    if _lost_way(case, flights, equal) > LIKE_WEIGHTS:
        return
    if equal:
        # Nothing then shows how errors fall with the step, and any linear method fits.
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
    # Elsewhere the errors are as large, in longer steps by the power larger, also if the method goes
    # over events, or misses them.
    others = np.setdiff1d(case.telling, flights)
    longer = np.maximum(1.0, np.diff(s.t)[others] / np.max(h))
    most = 2.0 * float(np.max(sizes)) * longer**order
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


def _lost_way(case: FaultySteps, flights: np.ndarray, equal: bool) -> float:
    """Return by which part of the step times v the solution moves too far or not far enough.

    If steps are not `equal`, errors with higher powers of the step are told apart from that.
    """
    s = case.steps
    h = np.diff(s.t)[flights]
    # Euler's methods move by h v, with v at the start or at the end of the step.
    ways = np.diff(s.x)[flights]
    for v in (s.v[flights], s.v[flights + 1]):
        if np.median(np.abs(ways - h * v)) <= EXACT_WAY * np.max(np.abs(h * v)):
            return 0.0
    terms = _linear_terms(case, flights) * h[:, None]
    longer = h[:, None] / np.max(h)
    defects_x, _ = s.defects[flights].T
    basis = np.empty((len(flights), 0))
    parts = list[float]()
    for power in range(1 if equal else WAY_POWERS):
        basis = np.hstack([basis, terms * longer**power])
        if parts and PER_NUMBER * basis.shape[1] > len(flights):
            break
        coefficients, *_ = np.linalg.lstsq(basis, defects_x, rcond=1e-12)
        _, of_v, *_ = coefficients  # in the order of `_linear_terms`
        parts.append(abs(float(of_v)) / float(np.max(np.abs(s.v[flights]))))
    return min(parts)


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

    The longest flights, beyond which no other shows the law, are in each fit.
    """
    h = np.diff(case.steps.t)[flights]
    basis = _linear_terms(case, flights)
    matrix = np.hstack([basis * (h[:, None] / np.max(h)) ** power for power in powers])
    left = np.full(len(flights), np.inf)
    if PER_NUMBER * matrix.shape[1] > len(flights):
        return left
    even = np.arange(len(flights)) % 2 == 0
    longest = h >= np.quantile(h, 1.0 - LONGEST)
    for half in (even, ~even):
        used = half | longest
        coefficients, *_ = np.linalg.lstsq(matrix[used], defects[used], rcond=1e-12)
        left[~half] = larger(matrix[~half] @ coefficients - defects[~half])
    return left
