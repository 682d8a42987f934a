"""The causes of wrong samples: their descriptions, and the samples to try them on."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from symosc.crosschecks.bands import DOMAIN_CODES
from symosc.crosschecks.steps import follow_steps
from symosc.crosschecks.verdict import Verdict
from symosc.engine.flow import Constants
from symosc.model import Model, Parameters

#: Causes by name, in words. The last five say what is wrong where no cause is.
CAUSES = {
    "coefficient": "a wrong coefficient",
    "sign": "a wrong sign",
    "swapped belts": "the belts' frictions are swapped",
    "static friction": "static friction is missing",
    "friction curve": "friction does not depend on the speed",
    "columns": "the columns are not what they are called",
    "time shift": "the clock is wrong",
    "phase": "another phase of the drive",
    "late events": "events are missed or late",
    "smoothed friction": "smoothed friction",
    "drift": "drift off a belt in a stick",
    "chatter": "chatter about a belt's speed",
    "steps too large": "the solver's steps are too large",
    "noise": "noise",
    "precision": "the samples have few digits",
    "missing events": "the list lacks events",
    "invented events": "the list has events that are none",
    "event times": "the list has events at wrong times",
    "start": "another start, or errors that add up",
    "unknown": "no known cause",
}


@dataclass(frozen=True)
class Diagnosis:
    """A probable cause of the errors in a solution.

    Attributes
    ----------
    cause : str
        One of CAUSES.
    subject : str
        What it is about: a parameter ("mu1"), a column ("x"), a curve ("tanh"); "" if nothing.
    words : str
        The diagnosis in a sentence.
    evidence : str
        What speaks for it.
    value, error : float or None
        The number that was estimated, and its standard deviation.
    share : float
        Part of the wrong steps that it explains, at most 1.
    alternatives : tuple of Diagnosis
        Other causes that explain the samples as well.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, load_scene, simulate
    >>> p = load_scene("fig5").parameters
    >>> t = np.linspace(0, 20, 400)
    >>> x, v = simulate(p.replace(B0=10.3), x0=0, v0=0, t_end=20)(t)
    >>> print(crosscheck("fig5", t, x, v).diagnosis[0].words)
    the solution has B0 = 10.3, which should be 10
    """

    cause: str
    subject: str
    words: str
    evidence: str
    value: float | None = None
    error: float | None = None
    share: float = 1.0
    alternatives: tuple[Diagnosis, ...] = ()


#: Make of the columns t, x, v others; v may then be None.
ChangeColumns = Callable[
    [np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray | None]
]


class Explanation(NamedTuple):
    """A diagnosis, and what shows that it is right: a change, or the defects that it leaves.

    With the change all steps should be right. Either the exact motion gets the changed
    `parameters`, or the function `columns` turns the samples t, x, v into others; `words` describe
    it, such as "with m = 2". A cause without a change says by `left` how large the defects of the
    steps of the `FaultySteps` are if it is assumed, NaN where that was not computed.
    """

    diagnosis: Diagnosis
    words: str = ""
    parameters: Model | None = None
    columns: ChangeColumns | None = None
    left: np.ndarray | None = None

    @property
    def name(self) -> tuple[str, str]:
        """Cause and subject."""
        return self.diagnosis.cause, self.diagnosis.subject


# -- causes tried on the wrong steps ---------------------------------------------------------------

# Number of steps on which causes are tried, and how many of them may come before the first wrong
# one.
MOST_TRIED_STEPS = 1_000
MOST_BEFORE = 200
# Wrong steps on which a cause is tried that is costly, and how many of them are the largest ones.
MOST_TELLING = 60
LARGEST = 10
# Telling steps on which other parameters are tried first.
FEW_TELLING = 12
# Samples on each side of the largest defect on which changes of columns are tried first.
FEW_MENDED = 30
# A cause may leave this part of a defect, or this part of the largest one, or what is allowed.
FITS = 1e-3
FITS_LARGEST = 1e-3
# A cause is named if it explains this part of the wrong steps, beside the first and the largest
# one.
ENOUGH = 0.9
# A fitted model is tried on all steps if it leaves this part of the defects.
LEFT_OVER = 0.1
# Rounds of Gauss-Newton.
FIT_ROUNDS = 8


class FittedNumber(NamedTuple):
    """Numbers fitted to the steps between samples, their standard deviations, and the defect left
    in each step.
    """

    value: np.ndarray
    error: np.ndarray
    sizes: np.ndarray


class FaultySteps:
    """Samples of a solution whose faults are to be explained, and the exact motion over each of
    their steps.
    """

    # `offset` is the number of the first of them among all samples of the `check`; `near` are
    # distances from a belt that count as on it; `sizes` the defects in units of the allowed ones;
    # `moving_wrong` the wrong steps in which time passes, `telling` some of them; `domain` that of
    # each sample, 0 at a belt; `inside` the steps in one domain, for the samples and the exact
    # motion, and `inside_wrong` and `flights_wrong` those of them that are wrong, and their
    # fraction.

    def __init__(self, check: Verdict, around: int) -> None:
        """Follow the exact motion over the samples of a `Verdict` around a wrong step."""
        low = max(0, min(around - MOST_BEFORE, len(check.t) - MOST_TRIED_STEPS - 1))
        numbers = slice(low, low + MOST_TRIED_STEPS + 1)  # of samples, one more than steps
        self.check = check
        self.offset = low
        self.parameters = check.trajectory.parameters
        self.allowed = check.allowed[low : low + MOST_TRIED_STEPS]
        self.scales = np.array(check.scales)
        # What is allowed for v in a step is the tolerance at its end; the first also at its start.
        _, allowed_v = self.allowed.T
        self.near = np.append(allowed_v[:1], allowed_v)
        samples = (check.t[numbers], check.x[numbers], check.v[numbers])
        s = follow_steps(self.parameters, *samples, self.near, self.scales)
        self.steps = s
        self.sizes = np.max(np.abs(s.defects) / self.allowed, axis=1)
        moving = np.diff(s.t) > 0.0
        self.wrong = ~(self.sizes <= 1.0)
        self.moving_wrong = np.flatnonzero(self.wrong & moving)
        at_belt = np.min(np.abs(s.v[:, None] - s.belts), axis=1) <= self.near
        self.domain = np.where(at_belt, 0, 1 + np.sum(s.v[:, None] > s.belts, axis=1))
        before = self.domain[:-1]
        after = self.domain[1:]
        code = DOMAIN_CODES[before]
        inside = (before > 0) & (before == after) & (s.first == code) & (s.last == code)
        inside[s.events.step] = False
        self.inside = np.flatnonzero(inside & moving & np.isfinite(self.sizes))
        self.inside_wrong = self.inside[self.wrong[self.inside]]
        self.flights_wrong = 0.0
        if len(self.inside):
            self.flights_wrong = float(np.mean(self.wrong[self.inside]))

    @property
    def paper(self) -> Parameters:
        """The parameters of the paper's oscillator; ParameterError if it is another one."""
        return self.parameters.parameters

    @cached_property
    def telling(self) -> np.ndarray:
        """Wrong steps that show whether a cause is right: the largest ones, the first one that
        `explained_share` asks for, and some of the others.
        """
        known = self.moving_wrong[np.isfinite(self.sizes[self.moving_wrong])]
        largest = known[np.argsort(-self.sizes[known])[:LARGEST]]
        chosen = np.union1d(largest, known[_are_not_tiny(self.sizes[known])][:1])
        others = self.thinned(np.setdiff1d(known, chosen), MOST_TELLING - LARGEST)
        return np.union1d(chosen, others)

    def leaving(self, sizes: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Return the defects left in all steps, given those left in some, divided by the allowed.

        NaN elsewhere.
        """
        left = np.full(len(self.sizes), np.nan)
        left[steps] = np.nan_to_num(sizes, nan=np.inf)
        return left

    def limits(self) -> np.ndarray:
        """Return for each step the defect that a cause may leave, in units of the allowed one."""
        return left_limits(self.sizes)

    def share(self, left: np.ndarray) -> float:
        """Return the `explained_share` of a cause, given the defects `left` that it leaves in all
        steps.
        """
        return explained_share(self.sizes, left)

    def misses(self, ends: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Return `ends`, computed states at the ends of `steps`, minus the samples there, divided
        by the allowed.
        """
        return np.asarray((ends - self.steps.states[steps + 1]) / self.allowed[steps])

    def miss_sizes(self, ends: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Return for each of `steps` the larger of its misses in x and in v, of `misses(ends,
        steps)`, without sign.
        """
        return larger(self.misses(ends, steps))

    def defects_with(self, p: Model, ahead: float = 0.0) -> np.ndarray:
        """Return all defects, divided by the allowed, for parameters `p` and with `ahead` added to
        all times.
        """
        s = self.steps
        return np.asarray(
            follow_steps(p, s.t + ahead, s.x, s.v, self.near, self.scales).defects / self.allowed
        )

    def share_mended_by(self, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> float:
        """Return the fraction of wrong steps that become right if t, x, v, perhaps fewer, are taken
        as the samples.
        """
        if len(t) < 2:
            return 0.0
        # Most changes are refused by a few steps about the largest defect.
        middle = int(np.argmax(np.where(np.isfinite(self.sizes), self.sizes, 0.0)))
        few = slice(max(0, middle - FEW_MENDED), middle + FEW_MENDED)
        if len(self.sizes) <= 4 * FEW_MENDED or middle >= len(t) - 1:
            return self._mended(self.sizes, t, x, v)
        if not self._mended(self.sizes[few], t[few], x[few], v[few]) > 0.5:
            return 0.0
        return self._mended(self.sizes, t, x, v)

    def _mended(self, before: np.ndarray, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> float:
        """Return the `mended_share` of other samples, given the defects `before`."""
        after = follow_steps(self.parameters, t, x, v, float(np.median(self.near)), self.scales)
        return mended_share(before, larger(after.defects / np.median(self.allowed, axis=0)))

    def thinned(self, chosen: np.ndarray, most: int) -> np.ndarray:
        """Return the step numbers `chosen` or, if these are more than `most`, so many of them,
        evenly selected.
        """
        if len(chosen) <= most:
            return chosen
        return chosen[np.linspace(0, len(chosen) - 1, most).astype(int)]

    def left_with(self, p: Model, ahead: float = 0.0) -> np.ndarray | None:
        """Return the sizes of all defects with other parameters or times.

        None if few telling steps refuse them.
        """
        few = self.thinned(self.telling, FEW_TELLING)
        fits = larger(self.some_defects_with(p, few, ahead)) <= self.limits()[few]
        if np.mean(fits) >= 0.5:
            return larger(self.defects_with(p, ahead))
        return None

    def some_defects_with(self, p: Model, chosen: np.ndarray, ahead: float = 0.0) -> np.ndarray:
        """Return the defects of the steps `chosen`, divided by the allowed, as rows x, v.

        They are for parameters `p` and with `ahead` added to all times.
        """
        s = self.steps
        pairs = np.column_stack([chosen, chosen + 1]).ravel()
        near = np.repeat(self.near[chosen], 2)
        ends = follow_steps(p, s.t[pairs] + ahead, s.x[pairs], s.v[pairs], near, self.scales)
        return np.asarray(ends.defects[::2] / self.allowed[chosen])

    def flight_misses(
        self, K: Constants, turn: float = 0.0, chosen: np.ndarray | None = None
    ) -> np.ndarray:
        """Return how far flights over steps miss the next samples in x and v, divided by the
        allowed defects.

        The steps are those numbered `chosen`, or else all that lie inside a domain. Each flight has
        the force of the domain of its first sample, the constants `K` of another system, and a
        drive ahead by the angle `turn`.
        """
        if chosen is None:
            chosen = self.inside
        s = self.steps
        shifted = replace(s, K=K, theta=s.theta + (K.Om - s.K.Om) * s.t + turn)
        return self.misses(shifted.flight(self.domain[chosen], chosen, chosen + 1), chosen)

    def integrated(
        self, force: Callable[[float, float, float], float], chosen: np.ndarray
    ) -> np.ndarray:
        """Return how far an equation with another `force` misses the ends of steps, in units of the
        allowed.

        `force(x, v, phase)` is the acceleration. The result has rows x, v.
        """
        from scipy.integrate import odeint

        s = self.steps
        tolerance = float(np.min(self.allowed[chosen]))

        def slopes(time: float, state: np.ndarray, theta: float) -> tuple[float, float]:
            x, v = state.tolist()
            return v, force(x, v, theta + s.K.Om * time)

        ends = np.empty((len(chosen), 2))
        for row, i in enumerate(chosen.tolist()):
            span = (0.0, float(s.t[i + 1] - s.t[i]))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                path = odeint(
                    slopes, s.states[i], span, (float(s.theta[i]),), tfirst=True,
                    rtol=1e-11, atol=0.01 * tolerance, mxstep=2000,
                )  # fmt: skip
            ends[row] = path[-1]
        return self.misses(ends, chosen)


def larger(misses: np.ndarray) -> np.ndarray:
    """Return for each step the larger of its misses in x and in v, without sign."""
    return np.asarray(np.max(np.abs(misses), axis=1))


def left_limits(before: np.ndarray) -> np.ndarray:
    """Return what a cause may leave of each of the defects `before`, in units of the allowed
    ones.
    """
    return np.maximum(1.0, FITS * np.nan_to_num(before, nan=0.0, posinf=0.0))


def _are_not_tiny(sizes: np.ndarray) -> np.ndarray:
    """Return which defects are not tiny beside the largest one."""
    return np.asarray(sizes > FITS_LARGEST * np.max(sizes, initial=0.0))


def explained_share(before: np.ndarray, left: np.ndarray) -> float:
    """Return (wrong steps that a cause explains - right steps that it makes wrong) / (all wrong
    steps).

    `before` and `left` are the sizes of the defects without and with the cause, in units of the
    allowed ones; steps in which `left` is NaN are not counted. The result is 0 if the step with the
    largest defect, or the first one with a defect that is not tiny beside that, is not explained:
    then it is not the cause.
    """
    wrong = ~(before <= 1.0)
    limits = left_limits(before)
    known = np.flatnonzero(wrong & np.isfinite(before))
    if not len(known):
        return 0.0
    largest = known[np.argmax(before[known])]
    first = known[_are_not_tiny(before[known])][0]
    if not np.all(left[[first, largest]] <= limits[[first, largest]]):
        return 0.0
    tried = ~np.isnan(left)
    limits_of_wrong = np.maximum(limits, FITS_LARGEST * before[largest])
    fits = left <= np.where(wrong, limits_of_wrong, 1.0)
    mended = int(np.sum(fits & wrong))
    spoiled = int(np.sum(~fits & ~wrong & tried))
    return (mended - spoiled) / int(np.sum(wrong & tried))


def mended_share(before: np.ndarray, after: np.ndarray) -> float:
    """Return the fraction of wrong steps that new samples mend, given the defects `before` and
    `after` the change; 0 if the largest defect stays.
    """
    # The new samples may be fewer: shares are compared, not steps.
    wrong = ~(before <= 1.0)
    known = before[wrong & np.isfinite(before)]
    if not len(known):
        return 0.0
    largest_is_mended = np.max(after, initial=0.0) <= max(1.0, FITS * float(np.max(known)))
    if not largest_is_mended:
        return 0.0
    limit = max(1.0, FITS * float(np.median(known)))
    still_wrong = float(np.mean(~(after <= limit)))
    return 1.0 - still_wrong / float(np.mean(wrong))


def fitted(
    misses: Callable[[np.ndarray], np.ndarray], start: np.ndarray, ticks: np.ndarray
) -> FittedNumber | None:
    """Return the `FittedNumber` of numbers to steps, from first values `start`.

    None if the steps do not determine them.

    `misses(numbers)` returns by how much each step then misses the next sample in x and v, shape
    (steps, 2). Derivatives are difference quotients over the small changes `ticks`. Steps that miss
    by far the most are left out.
    """
    value = np.array(start, dtype=float)
    kept = None
    error = np.zeros(len(value))
    for _ in range(FIT_ROUNDS):
        residuals = misses(value)
        slopes = [
            (misses(value + tick) - misses(value - tick)) / (2.0 * np.max(tick))
            for tick in np.diag(ticks)
        ]
        J = np.stack(slopes, axis=-1)
        finite = np.all(np.isfinite(residuals), axis=1) & np.all(np.isfinite(J), axis=(1, 2))
        solve = _least_squares
        if kept is None:
            kept = finite
            # All steps are used in the first round: a median is not moved by a few wild ones.
            if len(value) == 1:
                solve = _median_change
        else:
            kept = kept & finite
        solution = solve(residuals[kept], J[kept])
        if solution is None:
            return None
        change, error = solution
        value = value + change
        sizes = larger(misses(value))
        if np.all(np.isnan(sizes)):  # there is no such system
            return None
        # Steps that miss by much more than the others are left out of the next round: than others
        # that depend on the numbers.
        depends = np.any(J != 0.0, axis=(1, 2)) & np.isfinite(sizes)
        usual = float(np.median(sizes[depends])) if np.any(depends) else 0.0
        kept = sizes <= max(1.0, 5.0 * usual)
        if np.all(np.abs(change) <= 1e-3 * error):
            break
    # The deviations are those of misses of 1, the allowed ones: larger misses make larger ones.
    if np.any(kept):
        usual_miss = np.sqrt(np.mean(misses(value)[kept] ** 2))
    else:
        usual_miss = np.inf
    return FittedNumber(value, error * max(1.0, float(usual_miss)), sizes)


def _median_change(misses: np.ndarray, J: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return by how much to change a single fitted number, and the standard deviation of the
    number.

    It is the weighted median of the changes that the single steps ask for. `J` are the derivatives
    of the `misses` of the steps with respect to the number.
    """
    slopes = J[..., 0]  # rows x, v by the one number
    squares = np.sum(slopes**2, axis=1)
    used = squares > 0.0
    if not np.any(used):
        return None
    wanted = -np.sum(slopes * misses, axis=1)[used] / squares[used]
    weights = np.sqrt(squares[used])
    order = np.argsort(wanted)
    middle = np.searchsorted(np.cumsum(weights[order]), 0.5 * np.sum(weights))
    return wanted[order][[middle]], np.array([1.0 / np.sqrt(np.sum(weights**2))])


def _least_squares(misses: np.ndarray, J: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the change of numbers by least squares and its deviations; None if `misses` do not
    determine them. `J` are the derivatives of the misses.
    """
    matrix = J.reshape(-1, J.shape[-1])
    right = -misses.ravel()
    # Columns of the size 1: the numbers have different units.
    units = np.sqrt(np.sum(matrix**2, axis=0))
    if not len(right) or not np.all(units > 0.0):
        return None
    normal = (matrix / units).T @ (matrix / units)
    if np.linalg.cond(normal) > 1e10:
        return None
    change, *_ = np.linalg.lstsq(matrix / units, right, rcond=None)
    return change / units, np.sqrt(np.diag(np.linalg.inv(normal))) / units


def best_between(
    misses: Callable[[np.ndarray], np.ndarray],
    low: np.ndarray,
    high: np.ndarray,
    points: int,
    enough: np.ndarray,
    rounds: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Find for each step the number between its `low` and `high` at which it misses least.

    Return numbers and misses.

    `misses(numbers)` returns the miss of each step at its own number. It is tried at `points`
    numbers, then at as many around the best of these, and so on: at most `rounds` times, or until
    the miss of every step is at most its `enough`.
    """
    best = low
    least_misses = np.full(len(low), np.inf)
    begin = low
    end = high
    for _ in range(rounds):
        for share in np.linspace(0.0, 1.0, points):
            tried = begin + share * (end - begin)
            missed = misses(tried)
            better = missed < least_misses
            best = np.where(better, tried, best)
            least_misses = np.where(better, missed, least_misses)
        width = (end - begin) / (points - 1)
        begin = np.maximum(best - width, low)
        end = np.minimum(best + width, high)
        if np.all(least_misses <= enough):
            break
    return best, least_misses
