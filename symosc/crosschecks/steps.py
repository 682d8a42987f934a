"""The exact motion over each step of samples, restarted from every sample, and the error bounds of
right samples.

Two motions of one scene whose law contracts never move apart: without static friction, and where
damper and friction together grow with the velocity. For the differences X and V of two motions
X' = V and V' = -(c/m) V - (k/m) X - (a force with the sign of V), through sticks and crossings as
well; c is the least damping of all bands. Hence

    V^2 + (k/m) X^2 never grows,   |V(t)| <= max(|V(0)|, (k/c) max |X|),   |V(t)| <= |V(0)| + (k/m) t max |X|.

With static friction they may: an error of x moves a slip, behind which the acceleration jumps by E,
and decides whether a belt holds the mass. So they may where friction falls more steeply than the
damper grows. What the exact motion makes of an error is then followed from the corners of a box
about the sample (`spread_of_steps`).

In most steps surely nothing happens, and these are done all at once. Over a short step of length
tau the velocity stays near the chord between its two ends: it is off by at most tau^2/8 max |b|,
where b is its second derivative. In a flight

    v'' + (c/m) v' + (k/m) v = -(B0 Omega/m) sin(theta),   r^2 = v'^2 + (k/m) v^2,   dr/dtau <= |B0 Omega/m|,

so that r, and b with it, are bounded over the step (where c < 0, r may grow by exp(|c| tau/m)
besides). If the chord, so widened, stays between the belts, or between the edges of its band, then
the flight meets none of them. On a belt the same is done with the two forces: their
second derivative is at most |B0| Omega^2/m.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from symosc.base.errors import MissingExtraError
from symosc.crosschecks.bands import BELT_OF, DOMAIN_CODES, DOMAIN_OF, Bands, bands_of, groups
from symosc.crosschecks.samples import Samples
from symosc.engine.arithmetic import loaded_loop, mp_context
from symosc.engine.batch import Batch, batch_of, joined, keep_state, state_of
from symosc.engine.events import event_codes
from symosc.engine.flow import Constants, table_of
from symosc.engine.next_event import TWO_PI, advance, band_beyond, entered
from symosc.engine.state import END, FAILED, GRAZE, MOVED, ON_BELT, REST
from symosc.kernels import entire_array
from symosc.kernels._generated import acceleration, motion, stick_acceleration
from symosc.kernels.compiling import is_compiled
from symosc.kernels.double_double import two_product
from symosc.kernels.entire import EPS
from symosc.model import Model
from symosc.simulation.batch import follow_batch
from symosc.simulation.loops import CHOICE, INTERPRETED, Budget

# Number of steps followed in small calls before compiled code is loaded, which takes a second.
FEW_STEPS = Budget(50_000)
# So many in one call are followed by compiled code, where the disk has it.
MANY_STEPS = 2_000
MOST_STEP_EVENTS = 10_000  # in one step
# Steps that are followed together: their data, besides the result, stay in the processor's cache.
STEPS_TOGETHER = 1 << 16
# A motion whose distance from a belt, or from a stick's end, is a smaller part of its size needs
# the event search.
CLEARANCE = 1e-9
# Corners of a box, and middles of its edges, in units of its half-widths in x and v.
BOX_POINTS = [(x, v) for x in (-1, 0, 1) for v in (-1, 0, 1) if x or v]


# -- how far right samples may be off --------------------------------------------------------------


def propagated(p: Model, off: np.ndarray, tau: Any) -> np.ndarray:
    """Bound the difference [x, v] of two exact motions that differed by `off` a time `tau` ago,
    with any events.
    """
    if not np.any(off):
        return np.zeros(2)
    x = off[..., 0]
    v = off[..., 1]
    square = float(p.k / p.m)
    damping = float(least_damping(p) / p.m)
    # Friction takes energy from the difference: v^2 + (k/m) x^2 does not grow.
    fastest = np.sqrt(v * v + square * x * x)
    farthest = x + tau * fastest
    if square > 0.0:
        farthest = np.minimum(farthest, np.sqrt(x * x + v * v / square))
    v = np.minimum(fastest, v + square * tau * farthest)
    if damping > 0.0:
        v = np.minimum(v, np.maximum(off[..., 1], square / damping * farthest))
    return np.stack([farthest, v], axis=-1)


def double_rounding(p: Model, t: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Bound the errors that rounding of doubles makes in x and v over steps.

    `scales` are the largest |x| and |v|.
    """
    largest_x, largest_v = scales
    ticks = 2.0 * np.spacing(np.maximum(np.abs(t[1:]), np.abs(t[:-1])))
    by_rounded_times = np.outer(ticks, [largest_v, float(push_bound(p, largest_x, largest_v))])
    return by_rounded_times + 8.0 * np.finfo(float).eps * scales


def push_bound(p: Model, x: float | np.ndarray, v: float | np.ndarray) -> Any:
    """Return the largest possible acceleration at given |x| and |v|, whatever the phase and the
    domain.

    Domains that no mass with the largest of the given |v| is in do not count.
    """
    fastest = float(np.max(v))
    forces = _largest_friction(p, fastest) + abs(p.B0)
    return float(forces / p.m) + float(p.k / p.m) * np.abs(x) + float(p.c / p.m) * np.abs(v)


def _largest_friction(p: Model, fastest: float) -> Any:
    """Return the largest size of A0 and friction together at velocities up to `fastest`."""
    if p.law.is_plain:
        walls = (-inf, *(float(belt.v) for belt in p.law.belts), inf)
        reached = [
            alpha
            for alpha in range(1, len(walls))
            if walls[alpha - 1] <= fastest and walls[alpha] >= -fastest
        ]
        return max(abs(p.A(alpha)) for alpha in reached)
    largest = 0.0
    for row in p.law.rows:
        low = max(-inf if row.below is None else float(row.below.v), -fastest)
        high = min(inf if row.above is None else float(row.above.v), fastest)
        _, force, _ = row.forces
        for v in (low, high) if low <= high else ():
            largest = max(largest, abs(float(p.A0 + force) - float(row.slope) * v))
    return largest


def sample_errors(p: Model, samples: Samples, rounding: np.ndarray) -> np.ndarray:
    """Bound the errors of x and v of each sample, (n, 2), given the rounding of its t, x and v, (3,
    n).
    """
    if samples.v_off is None and not np.any(rounding):
        return np.broadcast_to(0.0, (len(samples.t), 2))
    t, x, v = rounding
    if samples.v_off is not None:
        v = np.maximum(v, samples.v_off)
    # While the clock is off by t the velocity changes too.
    most_x = np.abs(samples.x) + x
    most_v = np.abs(samples.v) + v
    fastest = most_v + push_bound(p, most_x, most_v) * t
    error_x = x + fastest * t
    error_v = v + push_bound(p, most_x + fastest * t, fastest) * t
    return np.column_stack([error_x, error_v])


def has_static(p: Model) -> bool:
    """Return whether static friction of any belt exceeds its kinetic friction."""
    return any(p.law.excess(boundary) > 0 for boundary in range(1, len(p.law.belts) + 1))


def least_damping(p: Model) -> Any:
    """Return the least damping of all bands: c, and what friction that depends on the relative
    speed adds or takes.
    """
    return min(p.law.damping(p.c, row) for row in range(len(p.law.rows)))


def contracts(p: Model) -> bool:
    """Return whether no two motions move apart."""
    return not has_static(p) and bool(least_damping(p) >= 0)


# -- the exact motion over the steps ---------------------------------------------------------------


class StepEvents(NamedTuple):
    """Events of the exact motion inside steps, as columns in order of step and time.

    `kind` is a code of `engine.events.KIND_NAMES`, `boundary` is the number of a belt, and `target` is the mode
    after the event, a code of `friction.ALL_MODE_NAMES`.
    """

    step: np.ndarray
    t: np.ndarray
    x: np.ndarray
    theta: np.ndarray
    kind: np.ndarray
    boundary: np.ndarray
    target: np.ndarray

    def rows(self, first: int, last: int) -> slice:
        """Return the rows of the events of steps `first` to `last` (included)."""
        return slice(*np.searchsorted(self.step, [first, last + 1]))


#: The columns of `StepEvents` that are no floats.
INTEGER_COLUMNS = ("step", "kind", "boundary", "target")


@dataclass(frozen=True)
class ExactSteps:
    """The exact motion from each sample to the next one."""

    parameters: Model
    K: Constants  # of a plain law; of others those that no band changes, as the drive's
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    theta: np.ndarray  # phases
    defects: np.ndarray  # the exact motion over the step minus the next sample, (n - 1, 2)
    first: np.ndarray  # the mode (ALL_MODE_NAMES) just after the sample
    last: np.ndarray  # the mode at the end of the step
    on: np.ndarray  # the belt that the motion of the step begins on, 0 if none
    events: StepEvents

    @property
    def states(self) -> np.ndarray:
        """Samples x, v, shape (n, 2)."""
        return np.column_stack([self.x, self.v])

    @property
    def bands(self) -> Bands:
        """The constants of the law, by band."""
        return bands_of(self.parameters)

    @property
    def belts(self) -> np.ndarray:
        """Speeds of the belts that there are."""
        return self.bands.speeds

    def may_meet_belts(self, box: np.ndarray) -> np.ndarray:
        """Return which steps may have an event if they begin up to `box` from their samples."""
        ends = self.states[1:] + self.defects
        largest = np.max(np.abs(self.states), axis=0)
        reach = float(push_bound(self.parameters, *largest)) * np.diff(self.t) + box[:, 1]
        gaps = [np.min(np.abs(v[:, None] - self.belts), axis=1) for v in (self.v[:-1], ends[:, 1])]
        may_meet = np.minimum(*gaps) <= reach
        may_meet |= (self.on > 0) | (BELT_OF[self.first] > 0)
        may_meet[self.events.step] = True
        return may_meet

    def at(self, time: float, slack: float = 0.0) -> tuple[int, int]:
        """Return the first and the last step that come within `slack` of a time."""
        low, high = np.searchsorted(self.t, [time - slack, time + slack], "right") - 1
        last = len(self.first) - 1
        return min(max(int(low), 0), last), min(max(int(high), 0), last)

    def flight(self, domain: Any, since: Any, until: Any) -> np.ndarray:
        """Return x, v of flights from samples `since`, at the times of samples `until`, with the
        force of `domain`.
        """
        return self.fly(
            domain, self.x[since], self.v[since], self.theta[since], self.t[until] - self.t[since]
        )

    def fly(
        self, domain: Any, x: np.ndarray, v: np.ndarray, theta: np.ndarray, tau: np.ndarray
    ) -> np.ndarray:
        """Return x, v after flights over times `tau` with the force of `domain`, one number or an
        array.

        Where the law has bands it is that of the band of the velocity, or of the one next to it in
        the domain, all along the flight.
        """
        if self.bands.is_plain:
            K = self.K
            A = np.take([K.A1, K.A2, K.A3], domain - 1)
            return _flown(K, A, x, v, theta, tau)
        ends = np.empty((len(x), 2))
        for row, here in groups(self.bands.row_of(domain, v)):
            K = self.bands.rows[row]
            ends[here] = _flown(K, K.A2, x[here], v[here], theta[here], tau[here])
        return ends

    def acceleration(
        self, domain: np.ndarray, x: np.ndarray, v: np.ndarray, theta: np.ndarray
    ) -> np.ndarray:
        """Return the accelerations of the mass with the force of `domain`, of the same band as in
        `fly`.
        """
        a = np.empty(len(x))
        for row, here in groups(self.bands.row_of(domain, v)):
            K = self.bands.rows[row]
            A = K.A2 if K.banded else np.take([K.A1, K.A2, K.A3], domain[here] - 1)
            a[here] = acceleration(x[here], v[here], np.cos(theta[here]), A, K.cm, K.w0sq, K.f0)
        return a


def _flown(
    K: Constants, A: Any, x: np.ndarray, v: np.ndarray, theta: np.ndarray, tau: np.ndarray
) -> np.ndarray:
    """Return x, v after flights over times `tau` with the constant force `A`."""
    s = np.sin(theta)
    c = np.cos(theta)
    a = acceleration(x, v, c, A, K.cm, K.w0sq, K.f0)
    E0, E1, E2, R2, I2, _, _ = entire_array.basis(tau, K)
    dx, dv, _ = motion(v, a, s, c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    return np.stack([x + dx, v + dv], axis=-1)


def follow_steps(parameters: Model, t: Any, x: Any, v: Any, near: Any, scales: Any) -> ExactSteps:
    """Restart the exact motion from every sample and follow it to the time of the next one.

    A sample whose v differs from a belt's speed by at most `near`, a number or an array (n,), may
    be meant to be on the belt or beside it. Both are followed, and the one counts that is nearer to
    the next sample, in units of x and v `scales`, (2,) or (n - 1, 2). Where static friction may
    hold the mass it is beside the belt only if it was on that side at the end of the step before: a
    mass that is held does not leave by a rounding error.
    """
    # Where a time is repeated nothing moves: the defect is the jump.
    bands = bands_of(parameters)
    K = bands.rows[0]
    count = len(t) - 1
    near = np.broadcast_to(near, count + 1)
    scales = np.broadcast_to(scales, (count, 2))
    theta = np.empty(count + 1)
    defects = np.empty((count, 2))
    modes = np.zeros((2, count), np.int8)
    on = np.zeros(count, np.int8)
    before = 0
    parts_of_events = []
    for begin in range(0, count, STEPS_TOGETHER):
        end = min(begin + STEPS_TOGETHER, count)
        numbers = slice(begin, end + 1)  # of samples, one more than steps
        inner = slice(begin, end)
        theta[numbers] = phases(parameters, t[numbers])
        samples = np.array([t[numbers], x[numbers], v[numbers], theta[numbers]])
        followed = _follow_samples(bands, samples, near[inner], scales[inner], before)
        defects[inner] = followed.defects
        modes[:, inner] = followed.modes
        before = int(followed.modes[1, -1])
        on[inner] = followed.on
        events = followed.events
        parts_of_events.append(events._replace(step=events.step + begin))
    # A step in which no time passes has the mode in which the motion arrives, or leaves the first
    # sample.
    first_modes, last_modes = modes
    for i in np.flatnonzero(np.diff(t) == 0.0).tolist():
        if i:
            modes[:, i] = last_modes[i - 1]
        else:
            modes[:, i] = first_modes[int(np.argmax(np.diff(t) > 0.0))]
    events = StepEvents(*map(np.concatenate, zip(*parts_of_events, strict=True)))
    return ExactSteps(parameters, K, t, x, v, theta, defects, first_modes, last_modes, on, events)


class FollowedSteps(NamedTuple):
    """What the exact motion does in steps.

    `defects` has two columns, x and v: the end of the exact motion less the next sample. `modes`
    has two rows, the modes at the start and at the end of each step. `on` is the belt that a step
    begins on, 0 if none.
    """

    defects: np.ndarray
    modes: np.ndarray
    on: np.ndarray
    events: StepEvents

    @property
    def defects_of_v(self) -> np.ndarray:
        """By how much each step misses v of the next sample."""
        return self.defects[:, 1]


def _follow_samples(
    bands: Bands, samples: np.ndarray, near: np.ndarray, scales: np.ndarray, before: int
) -> FollowedSteps:
    """Follow all steps between samples, rows t, x, v, theta.

    `before` is the mode before the first sample, 0 if it is not known.
    """
    t, x, v, _ = samples
    gaps = np.abs(v[:-1, None] - bands.speeds)
    closest = np.argmin(gaps, axis=1) + 1
    beside = gaps.min(axis=1)
    moving = np.flatnonzero(np.diff(t) > 0.0)
    defects = np.column_stack([x[:-1] - x[1:], v[:-1] - v[1:]])
    modes = np.zeros((2, len(defects)), np.int8)
    on = np.where(beside == 0.0, closest, 0)  # the boundary of a sample that is exactly on a belt
    as_given = follow_from(bands, samples, moving, on[moving])
    defects[moving] = as_given.defects
    modes[:, moving] = as_given.modes
    events = as_given.events
    either = moving[(beside[moving] > 0.0) & (beside[moving] <= near[moving])]
    if len(either):
        size = np.max(np.abs(defects[either]) / scales[either], axis=1)
        on_belt = follow_from(bands, samples, either, closest[either])
        size_on_belt = np.max(np.abs(on_belt.defects) / scales[either], axis=1)
        # On a belt both agree up to rounding: then it is on the belt.
        better = ~(size_on_belt > size * (1.0 + 1e-6) + EPS)
        if has_static(bands.parameters):
            sizes = np.max(np.abs(defects) / scales, axis=1)
            _, last_modes = modes
            _, last_on_belt = on_belt.modes
            both_last = (last_modes, last_on_belt)
            _keep_held(bands, v, either, better, both_last, (sizes, size_on_belt), before)
        chosen = either[better]
        on[chosen] = closest[chosen]
        defects[chosen] = on_belt.defects[better]
        modes[:, chosen] = on_belt.modes[:, better]
        events = _merged(events, on_belt.events, chosen)
    return FollowedSteps(defects, modes, on.astype(np.int8), events)


def _keep_held(
    bands: Bands,
    v: np.ndarray,
    either: np.ndarray,
    on_belt: np.ndarray,
    last: tuple[np.ndarray, np.ndarray],
    sizes: tuple[np.ndarray, np.ndarray],
    before: int,
) -> None:
    """Mark in `on_belt` the steps `either` that begin on a belt because the step before ends there,
    or on its other side.

    `last` are the last modes of all steps if they begin as they are, and of the steps `either` if
    they begin on the belt; `sizes` are their defects, in units of the allowed ones.
    """
    side = DOMAIN_CODES[1 + np.sum(v[either, None] > bands.speeds, axis=1)]
    ends = last[0].copy()  # 0 in steps in which no time passes
    size = sizes[0].copy()
    for row, i in enumerate(either.tolist()):
        moving = np.flatnonzero(ends[max(0, i - 2) : i])
        known = before if i == 0 else 0
        if len(moving):
            j = max(0, i - 2) + int(moving[-1])
            known = int(ends[j]) if size[j] <= 1.0 else 0  # a wrong step shows nothing
        if known and known != side[row]:
            on_belt[row] = True
        if on_belt[row]:
            ends[i] = last[1][row]
            size[i] = sizes[1][row]


def spread_of_steps(steps: ExactSteps, chosen: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Return by how much exact motions differ at the ends of the steps `chosen`, in x and in v, if
    they begin anywhere in a box about the sample.

    `box` has the half-widths in x and v, a row for each of these steps. Motions from the corners
    and the middles of the edges are followed. They begin on the side of the belt on which the
    sample is, or on the belt; if the sample is on it, on the side on which the step before ends.
    """
    bands = steps.bands
    pairs = np.column_stack([chosen, chosen + 1]).ravel()
    samples = np.array([steps.t[pairs], steps.x[pairs], steps.v[pairs], steps.theta[pairs]])
    begins = np.arange(0, len(pairs), 2)
    at = steps.on[chosen].astype(int)
    speeds = bands.speeds
    walls = bands.walls
    v = np.where(at > 0, speeds[at - 1], steps.v[chosen])
    before = np.where(chosen > 0, DOMAIN_OF[steps.last[chosen - 1]], 0)
    domain = np.where(at > 0, before - 1, np.sum(v[:, None] > speeds, axis=1))
    is_free = (at == 0) | (before == at) | (before == at + 1)
    domain = np.where(is_free, domain, 0)
    largest = np.zeros((len(chosen), 2))
    for along_x, along_v in BOX_POINTS:
        moved = np.clip(v + along_v * box[:, 1], walls[domain], walls[domain + 1])
        moved = np.where(is_free, moved, v)
        samples[1, ::2] = steps.x[chosen] + along_x * box[:, 0]
        samples[2, ::2] = moved
        onto = np.where(np.isin(moved, speeds), 1 + np.searchsorted(speeds, moved), 0)
        defects = follow_from(bands, samples, begins, onto).defects
        largest = np.fmax(largest, np.abs(defects - steps.defects[chosen]))
    return largest


def follow_from(
    bands: Bands, samples: np.ndarray, steps: np.ndarray, on: np.ndarray
) -> FollowedSteps:
    """Follow the exact motion over the steps numbered `steps` of samples.

    `samples` has the rows t, x, v and theta. Where `on` is the number of a belt, v is first set to
    the speed of that belt, and the motion begins on it. The modes are those at the start and at the
    end of each step.
    """
    t, x, v, theta = samples
    tau = t[steps + 1] - t[steps]
    start_v = np.where(on > 0, bands.speeds[on - 1], v[steps])
    rows, sets = bands.begun(on, theta[steps], x[steps], start_v, tau)
    begins = bands.modes(sets, rows["mode"])
    modes = np.array([begins, begins]).astype(np.int8)
    ends = np.empty((len(rows), 2))
    is_quiet = np.zeros(len(rows), bool)
    for row, here in groups(sets):
        quiet, states = quiet_ends(rows[here], tau[here], bands.rows[row])
        is_quiet[here[quiet]] = True
        ends[here[quiet]] = states
    busy = np.flatnonzero(~is_quiet)
    followed = _follow(rows[busy], sets[busy], tau[busy], bands)
    _, last_modes = modes
    last_modes[busy] = followed.modes
    ends[busy] = followed.ends
    events = followed.events
    # From rows of `busy` and times since the start of a step to its number and times of samples.
    origin = steps[busy[events.step]]
    events = events._replace(step=origin, t=t[origin] + events.t)
    next_samples = np.column_stack([x[steps + 1], v[steps + 1]])
    return FollowedSteps(ends - next_samples, modes, on, events)


def phases(parameters: Model, t: Any) -> np.ndarray:
    """Return the phases Omega t modulo 2 pi of an array of times of any size."""
    context = mp_context(60)
    Om = parameters.Omega
    exact = context.mpf(Om.numerator) / Om.denominator / (2 * context.pi)  # turns per time
    # Turns of large times have no digits left in doubles: the product with the leading part of
    # `exact` is split into a double and its error, whole turns are taken off, and then what is
    # small is added.
    high = float(exact)
    turns, lost = two_product(t, high)
    fraction = (turns - np.floor(turns)) + (lost + t * float(exact - high))
    theta = (fraction - np.floor(fraction)) * (2.0 * pi)
    return np.asarray(np.where(theta >= TWO_PI, 0.0, theta))


# -- steps in which surely nothing happens ---------------------------------------------------------


def quiet_ends(rows: np.ndarray, left: np.ndarray, K: Constants) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers of starts that certainly have no event for a time `left` each, and their
    states [x, v] after it.

    `rows` are starts as `engine.start.start_rows` makes them.
    """
    numbers = np.flatnonzero(K.rate * left < 0.5)  # the bounds say nothing of longer steps
    tau = left[numbers]
    starts = rows[numbers]
    x = starts["x"]
    v = starts["v"]
    held = starts["mode"] > ON_BELT
    s = np.sin(starts["theta"])
    c = np.cos(starts["theta"])
    E0, E1, E2, R2, I2, s_tau, c_tau = entire_array.basis(tau, K)
    dx, dv, _ = motion(v, starts["Fb"], s, c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    ends = np.column_stack([x + np.where(held, v * tau, dx), v + np.where(held, 0.0, dv)])
    turned = (c * c_tau - s * s_tau) - c  # how much cos(theta) changes
    lasts = _sticks_last(starts, tau, turned, K)
    _, end_v = ends.T
    quiet = np.where(held, lasts, _flights_stay(starts, tau, end_v, K))
    return numbers[quiet], ends[quiet]


def _sticks_last(
    starts: np.ndarray, tau: np.ndarray, turned: np.ndarray, K: Constants
) -> np.ndarray:
    """Return which starts, if they stick, do so for the time tau, in which cos(theta) changes by
    `turned`: both forces keep their sign.
    """
    x = starts["x"]
    v = starts["v"]
    below = starts["Fb"]
    above = starts["Fa"]
    # They are off the chord between their values at the ends of the step by at most tau^2/8 times
    # their second derivative, and by rounding.
    off = 0.125 * tau * tau * abs(K.fB) * K.Om
    off += CLEARANCE * (
        np.abs(below) + np.abs(above) + K.w0sq * np.abs(x) + abs(K.cm) * np.abs(v) + 2.0 * abs(K.f0)
    )
    below_then, above_then = (
        stick_acceleration(force, v, tau, turned, K.w0sq, K.f0) for force in (below, above)
    )
    is_held_below = np.minimum(below, below_then) > off
    is_held_above = np.maximum(above, above_then) < -off
    return np.asarray(is_held_below & is_held_above)


def _flights_stay(
    starts: np.ndarray, tau: np.ndarray, end_v: np.ndarray, K: Constants
) -> np.ndarray:
    """Return which starts, if they fly, stay in their domain for the time tau, after which they
    have the velocity `end_v`: the chord of v, widened by what v may be off it, does.
    """
    v = starts["v"]
    most_a = np.hypot(starts["Fb"], K.w0 * v) + abs(K.fB) * tau
    if K.cm < 0.0:
        most_a = most_a * np.exp(-K.cm * tau)
    off = 0.125 * tau * tau * ((abs(K.cm) + K.w0) * most_a + abs(K.fB))
    off += CLEARANCE * (np.abs(v) + np.abs(end_v))
    lower_walls = np.array([-inf, _beside(K.belt1.v, 1.0), _beside(K.belt2.v, 1.0)])
    upper_walls = np.array([_beside(K.belt1.v, -1.0), _beside(K.belt2.v, -1.0), inf])
    domain = np.minimum(starts["mode"].astype(int), ON_BELT)  # a row on a belt is no flight
    stays = np.minimum(v, end_v) - off > lower_walls[domain - 1]
    stays &= np.maximum(v, end_v) + off < upper_walls[domain - 1]
    return np.asarray(stays)


def _beside(speed: float, side: float) -> float:
    """Return a velocity that is beyond an edge, above (`side` 1) or below (-1), by a small part."""
    if abs(speed) == inf:
        return speed
    return speed + side * CLEARANCE * abs(speed)


# -- steps that need the event search --------------------------------------------------------------


class FollowedStarts(NamedTuple):
    """The modes and states [x, v] in which starts end, and their events; `step` of an event is the
    row of its start, and its time counts from there.
    """

    modes: np.ndarray
    ends: np.ndarray
    events: StepEvents


def _follow(rows: np.ndarray, sets: np.ndarray, left: np.ndarray, bands: Bands) -> FollowedStarts:
    """Follow each start event by event for its time `left`; `sets` are the numbers of its
    constants.
    """
    batch = batch_of(rows.copy(), sets.copy())
    follow = _step_loop(len(rows))
    table = table_of(bands.rows)
    numbers, codes = joined(follow_batch(follow, batch, MOST_STEP_EVENTS, inf, table))
    if loaded_loop() is None:  # these were interpreted: `_step_loop` compiles after too many
        FEW_STEPS.events -= len(rows)
    t, x, _, theta, *_ = numbers
    step, kind, boundary, _, target, *_ = codes
    events = StepEvents(step.astype(int), t, x, theta, kind, boundary, target)
    undecided = np.flatnonzero((batch.codes != END) & (batch.codes != REST))
    if len(undecided):
        # Where doubles could not decide, the starts are followed one by one.
        singles = list[tuple[Any, ...]]()
        for i in undecided.tolist():
            singles += _follow_one(batch, rows, int(sets[i]), i, bands)
        columns = StepEvents(*np.array(singles, float).reshape(-1, len(StepEvents._fields)).T)
        integers = {name: getattr(columns, name).astype(int) for name in INTEGER_COLUMNS}
        events = _merged(events, columns._replace(**integers), undecided)
    modes = bands.modes(batch.sets, batch.states["mode"])
    ends = np.empty((len(rows), 2))
    for row, here in groups(batch.sets):
        ends[here] = _ends(batch.states[here], left[here], bands.rows[row])
    ends[batch.codes == FAILED] = np.nan
    return FollowedStarts(modes, ends, events)


def _step_loop(count: int) -> Callable[..., tuple[int, int, int]]:
    """Return the loop that follows `count` steps: interpreted, or compiled if that is quicker."""
    interpreted = INTERPRETED.follow
    # Compiling takes longer than a few steps; FEW_STEPS counts how many have been interpreted.
    if count < MANY_STEPS and FEW_STEPS.events > 0 and loaded_loop() is None:
        return interpreted
    try:
        loop = CHOICE.of_many(True).follow
    except MissingExtraError:
        return interpreted
    return loop if is_compiled(loop) or FEW_STEPS.events <= 0 else interpreted


def _ends(states: np.ndarray, left: np.ndarray, K: Constants) -> np.ndarray:
    """Return the states [x, v] at times `left` in closed form, from the last ones of the event
    search.
    """
    x = states["x"]
    v = states["v"]
    passed = states["t"] + (states["t_low"] + states["t"] * K.Om_gain)
    tau = np.maximum(left - passed, 0.0)
    a = states["Fb"]
    E0, E1, E2, R2, I2, _, _ = entire_array.basis(tau, K)
    dx, dv, _ = motion(v, a, states["s"], states["c"], K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    held = states["mode"] > ON_BELT
    return np.column_stack([x + np.where(held, v * tau, dx), v + np.where(held, 0.0, dv)])


def _follow_one(
    batch: Batch, rows: np.ndarray, first: int, i: int, bands: Bands
) -> list[tuple[Any, ...]]:
    """Follow the start in row `i`, which has the constants number `first`, event by event and
    return the events.

    Put its final state into the `batch`.

    This is for starts where doubles cannot decide whether a belt is met. Either answer is right
    within rounding, and that of `advance` is taken.
    """
    state = state_of(rows[i])
    t_end = float(rows[i].t_end)
    t_end_low = float(rows[i].t_end_low)
    events = list[tuple[Any, ...]]()
    code = MOVED
    number = first
    while code not in (END, REST, FAILED) and len(events) < MOST_STEP_EVENTS:
        K = bands.rows[number]
        event = advance(state, t_end, t_end_low, K)
        code = event.code
        if code <= GRAZE:
            kind, boundary, _, target = event_codes(state, event, K)
            of_event = event.state
            events.append((i, of_event.t, of_event.x, of_event.theta, kind, boundary, target))
        state = event.state
        way = band_beyond(state.mode, K)
        if way:
            state = entered(state, way)
            number += way
    if code in (END, REST):
        batch.codes[i] = code
    else:
        batch.codes[i] = FAILED
    keep_state(batch.states[i], state)
    batch.sets[i] = number
    return events


def _merged(events: StepEvents, others: StepEvents, steps: np.ndarray) -> StepEvents:
    """Return all events, in which those of `steps` are replaced by those in `others`."""
    is_kept = ~np.isin(events.step, steps)
    is_taken = np.isin(others.step, steps)
    merged = StepEvents(
        *(
            np.concatenate([column[is_kept], replacement[is_taken]])
            for column, replacement in zip(events, others, strict=True)
        )
    )
    order = np.lexsort((merged.t, merged.step))  # by step, then by time: lexsort's last key leads
    return StepEvents(*(column[order] for column in merged))
