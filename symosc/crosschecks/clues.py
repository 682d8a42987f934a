"""What wrong samples tell: how well another model explains them, and numbers of it that are fitted to them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from symosc.crosschecks.faults import EXPLAINS
from symosc.crosschecks.steps import ExactSteps, follow_steps
from symosc.engine.flow import Constants
from symosc.model import Parameters

# So many steps are looked at, from shortly before the first wrong one.
MOST_CLUES, CLUES_BEFORE = 3_000, 300
# A fitted model is followed over all steps if it leaves this part of the defects; its numbers are named if it leaves
# this.
LEFT_OVER, FITS = 0.1, 1e-3
FIT_ROUNDS = 8
# Others that explain nearly as much as the best one cannot be told from it. What makes all steps right is preferred.
AS_GOOD = 0.02
SURE = 1.0 + AS_GOOD
# Steps that miss by this many times the median are left out of the next round.
TRIM = 5.0


class Fit(NamedTuple):
    """Numbers fitted to steps: `value` and `error` (standard deviations) as arrays, and what is left of the steps."""

    value: np.ndarray
    error: np.ndarray
    sizes: np.ndarray


def clue_samples(check: Any) -> slice:
    """Return which samples of a `CrossCheck` are looked at."""
    first = int(check.wrong_steps[0]) if len(check.wrong_steps) else 0
    low = max(0, min(first - CLUES_BEFORE, len(check.t) - MOST_CLUES - 1))
    return slice(low, low + MOST_CLUES + 1)


@dataclass(frozen=True)
class Clues:
    """Samples that do not agree with the exact motion, and the exact motion over their steps.

    Attributes
    ----------
    steps : ExactSteps
    offset : int
        Number of the first of these samples among all.
    allowed : (n - 1, 2) array
    scales : (2,) array
    near : (n,) array
        Distances from a belt that count as on it.
    motion_sticks : bool
        Whether the exact motion from the start sticks anywhere.
    """

    steps: ExactSteps
    offset: int
    allowed: np.ndarray
    scales: np.ndarray
    near: np.ndarray
    motion_sticks: bool = True

    @classmethod
    def of(cls, check: Any) -> Clues:
        """Return the clues of a `CrossCheck`: all samples, or many from shortly before the first wrong step."""
        part = clue_samples(check)
        low = part.start
        allowed, scales = check.allowed[low : low + MOST_CLUES], np.array(check.scales)
        near = np.append(allowed[:1, 1], allowed[:, 1])
        steps = follow_steps(check.trajectory.parameters, check.t[part], check.x[part], check.v[part], near, scales)
        held = any(part.mode.startswith("belt") and part.t_end > part.t_start for part in check.trajectory.segments)
        return cls(steps, low, allowed, scales, near, held)

    @property
    def parameters(self) -> Parameters:
        """The parameters of the exact motion."""
        return self.steps.parameters

    @cached_property
    def sizes(self) -> np.ndarray:
        """Defects in units of what is allowed, one for each step."""
        return np.max(np.abs(self.steps.defects) / self.allowed, axis=1)

    @cached_property
    def wrong(self) -> np.ndarray:
        """Which steps are wrong."""
        return np.asarray(~(self.sizes <= 1.0))

    @cached_property
    def label(self) -> np.ndarray:
        """The domain of each sample, 0 at a belt."""
        v, K = self.steps.v, self.steps.K
        at = np.minimum(np.abs(v - K.belt1.v), np.abs(v - K.belt2.v)) <= self.near
        return np.where(at, 0, 1 + (v > K.belt1.v) + (v > K.belt2.v))

    @cached_property
    def inside(self) -> np.ndarray:
        """Steps that lie in one domain, for the samples and for the exact motion."""
        before, after = self.label[:-1], self.label[1:]
        inside = (before > 0) & (before == after) & (self.steps.first == before) & (self.steps.last == before)
        inside[np.unique(self.steps.events.step)] = False
        return np.flatnonzero(inside & (np.diff(self.steps.t) > 0.0) & np.isfinite(self.sizes))

    @cached_property
    def stays(self) -> np.ndarray:
        """Steps over which the samples stay on a belt."""
        s, on = self.steps, self.label == 0
        same = np.abs(np.diff(s.v)) <= self.near[1:] + self.near[:-1]
        return np.flatnonzero(on[1:] & on[:-1] & same & (np.diff(s.t) > 0.0))

    @property
    def sticks(self) -> bool:
        """Whether there is any stick to be wrong about: of the exact motion, or of the samples."""
        return self.motion_sticks or bool(np.any(np.diff(self.stays) == 1))

    @property
    def flights_wrong(self) -> float:
        """Part of the steps inside a domain that are wrong; 0 if there is none."""
        return float(np.mean(self.wrong[self.inside])) if len(self.inside) else 0.0

    def limits(self, part: float = EXPLAINS) -> np.ndarray:
        """Return how large the defects may be, in units of what is allowed, if a model explains the steps."""
        return np.maximum(1.0, part * np.nan_to_num(self.sizes, nan=0.0, posinf=0.0))

    def share(self, sizes: np.ndarray, of: np.ndarray | None = None, part: float = EXPLAINS) -> float:
        """Return which part of the wrong steps another model explains, less the right ones that it makes wrong.

        Parameters
        ----------
        sizes : array
            Defects that it leaves, in units of what is allowed.
        of : int array, optional
            The steps that these are of. Default: all.
        part : float
            A step is explained if this part of its defect is left.
        """
        chosen = slice(None) if of is None else of
        wrong = self.wrong[chosen]
        fits = sizes <= self.limits(part)[chosen]
        return float((np.sum(fits & wrong) - np.sum(~fits & ~wrong)) / max(1, np.sum(wrong)))

    def followed(
        self, p: Parameters, ahead: float = 0.0, x: np.ndarray | None = None, v: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the sizes of the defects with other parameters, another clock, or other columns."""
        x, v = self.steps.x if x is None else x, self.steps.v if v is None else v
        found = follow_steps(p, self.steps.t + ahead, x, v, self.near, self.scales)
        return np.asarray(np.max(np.abs(found.defects) / self.allowed, axis=1))

    def share_of(self, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> float:
        """Return which part of the wrong steps other columns explain; they may have fewer rows."""
        near, allowed = float(np.median(self.near)), np.median(self.allowed, axis=0)
        found = follow_steps(self.parameters, t, x, v, near, self.scales)
        left, wrong = np.max(np.abs(found.defects) / allowed, axis=1), self.sizes[self.wrong]
        limit = max(1.0, EXPLAINS * float(np.median(wrong[np.isfinite(wrong)]))) if np.isfinite(wrong).any() else 1.0
        return float(1.0 - np.mean(~(left <= limit)) / max(np.mean(self.wrong), 1e-300))

    def some(self, chosen: np.ndarray, most: int) -> np.ndarray:
        """Return at most so many of the chosen steps, evenly spread."""
        if len(chosen) <= most:
            return chosen
        return chosen[np.linspace(0, len(chosen) - 1, most).astype(int)]

    def followed_some(self, p: Parameters, chosen: np.ndarray) -> np.ndarray:
        """Return the defects of a few steps with other parameters, in units of what is allowed, shape (steps, 2)."""
        begin = np.column_stack([self.steps.t, self.steps.x, self.steps.v])[chosen]
        return self.between(begin, chosen + 1, self.near[chosen], p) / self.allowed[chosen]

    def between(
        self, begin: np.ndarray, until: np.ndarray, near: np.ndarray, p: Parameters | None = None
    ) -> np.ndarray:
        """Return the exact motion from states t, x, v, one a row, minus the samples `until`; shape (rows, 2).

        No row may begin before the one before ends.
        """
        end = np.column_stack([self.steps.t, self.steps.x, self.steps.v])[until]
        found = begin[:, 1:] - end[:, 1:]
        moving = begin[:, 0] < end[:, 0]
        if np.any(moving):
            t, x, v = np.stack([begin, end], axis=1)[moving].reshape(-1, 3).T
            p = self.parameters if p is None else p
            found[moving] = follow_steps(p, t, x, v, np.repeat(near[moving], 2), self.scales).defects[::2]
        return np.asarray(found)

    def flown(self, K: Constants, turn: float = 0.0, chosen: np.ndarray | None = None) -> np.ndarray:
        """Return what flights inside domains miss with other constants or a turned phase of the drive.

        In units of what is allowed, shape (steps, 2), for the steps `inside` or those chosen from these.
        """
        chosen, s = self.inside if chosen is None else chosen, self.steps
        other = replace(s, K=K, theta=s.theta + (K.Om - s.K.Om) * s.t + turn)
        there = other.flight(self.label[chosen], chosen, chosen + 1)
        return np.asarray((there - np.column_stack([s.x, s.v])[chosen + 1]) / self.allowed[chosen])


def fitted(misses: Callable[[np.ndarray], np.ndarray], start: np.ndarray, ticks: np.ndarray) -> Fit | None:
    """Fit numbers to steps, of which some may be wrong for another reason.

    Parameters
    ----------
    misses : callable
        Returns what the steps miss with these numbers, in units of what is allowed, shape (steps, 2).
    start : array
    ticks : array
        Changes that make a difference, for the derivatives.

    Returns
    -------
    Fit or None
        None if the steps do not show the numbers.
    """
    value = np.array(start, dtype=float)
    kept, error = None, np.zeros(len(value))
    for _ in range(FIT_ROUNDS):
        here = misses(value)
        slopes = [(misses(value + tick) - misses(value - tick)) / (2.0 * np.max(tick)) for tick in np.diag(ticks)]
        J = np.stack(slopes, axis=-1)
        finite = np.all(np.isfinite(here), axis=1) & np.all(np.isfinite(J), axis=(1, 2))
        if kept is None:
            kept = finite
            change = _median_change(here[finite], J[finite])
        else:
            change = _least_squares(here[kept & finite], J[kept & finite])
        if change is None:
            return None
        value = value + change[0]
        error = change[1]
        sizes = np.max(np.abs(misses(value)), axis=1)
        if np.all(np.isnan(sizes)):  # there is no such system
            return None
        kept = sizes <= max(1.0, TRIM * float(np.nanmedian(sizes)))
        if np.all(np.abs(change[0]) <= 1e-3 * error):
            break
    rest = np.sqrt(np.mean(misses(value)[kept] ** 2)) if np.any(kept) else np.inf
    return Fit(value, error * max(1.0, float(rest)), sizes)


def _median_change(here: np.ndarray, J: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the change of one number that most steps ask for; of several numbers, that of least squares."""
    if J.shape[-1] > 1:
        return _least_squares(here, J)
    slopes = J[..., 0]
    weights = np.sum(slopes * slopes, axis=1)
    if not np.sum(weights) > 0.0:
        return None
    wanted = -np.sum(slopes * here, axis=1)[weights > 0.0] / weights[weights > 0.0]
    weights = np.sqrt(weights[weights > 0.0])
    order = np.argsort(wanted)
    middle = np.searchsorted(np.cumsum(weights[order]), 0.5 * np.sum(weights))
    return wanted[order][[middle]], np.array([1.0 / np.sqrt(np.sum(weights**2))])


def _least_squares(here: np.ndarray, J: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    matrix, right = J.reshape(-1, J.shape[-1]), -here.ravel()
    units = np.sqrt(np.sum(matrix**2, axis=0))
    if not len(right) or not np.all(units > 0.0):
        return None
    normal = (matrix / units).T @ (matrix / units)
    if np.linalg.cond(normal) > 1e10:
        return None
    change = np.linalg.lstsq(matrix / units, right, rcond=None)[0] / units
    return change, np.sqrt(np.diag(np.linalg.inv(normal))) / units
