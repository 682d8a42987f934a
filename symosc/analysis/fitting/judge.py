"""The verdict on a fit: whether the motion describes the data, and which data are outliers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symosc.analysis.fitting.measured import Measured
from symosc.analysis.fitting.problem import Evaluation, FitProblem, spacing
from symosc.analysis.fitting.spread import column_rows, informative
from symosc.crosschecks.rounding import Digits
from symosc.simulation.tables import counted

#: How often data that are described may be said not to be, by each of the tests here.
LEVEL = 1e-4
#: With unknown sigma an outlier is off by more than so many standard deviations, which are
#: estimated from the median of n residuals, minus numbers: 6 + 70 / n. Normal errors are beyond
#: that once in 10,000 fits (`test_random_errors_are_no_misfit`).
OUTLYING = (6.0, 70.0)
#: Of fewer data than this no outliers are told without sigma: a median of few may be far too small.
FEW = 8
#: More than this part of the data are no outliers: the motion does not describe them.
MOST_OUTLIERS = 0.1
#: With unknown sigma events that are off by this part of the time between them are not recognised:
#: the events of another motion may come as near.
UNRECOGNISED = 0.01
#: Residuals of this part of the data's size are those of the arithmetic.
EXACT = 1e-10
#: How many of the worst residuals a message names.
NAMED = 3
#: No datum that is off by rounding alone is off by more units in its last place: half a unit, and
#: what the other ones do to the fit.
MOST_UNITS = 2.0
#: Data that are off by rounding alone are described if that makes errors of so many sigma.
ROUNDED = 1.1
#: The standard deviation of normal errors over the median of their sizes.
MEDIAN_SCALE = 1.4826


class Outlier(NamedTuple):
    """A measured number that the fitted motion does not describe, although it does the others.

    Attributes
    ----------
    row : int
        The row in the data, from 0.
    what : str
        The kind of the event, or "x" or "v".
    t : float
        The measured time.
    residual : float
        Motion minus data, in standard deviations; these are estimated if they were not given.

    Examples
    --------
    >>> from symosc import fit, simulate
    >>> data = [(event.t, event.kind) for event in simulate("fig5", t_end=20).events]
    >>> data[4] = (data[4][0] + 0.1, data[4][1])
    >>> found = fit("fig5", data, "mu1", sigma=1e-3, robust=True)
    >>> [(outlier.row, outlier.what, round(outlier.residual)) for outlier in found.outliers]
    [(4, 'stick', -100)]
    """

    row: int
    what: str
    t: float
    residual: float

    def __str__(self) -> str:
        return f"{self.what} at t = {self.t:.6g} (row {self.row}) by {abs(self.residual):.3g} sigma"


class FitVerdict(NamedTuple):
    """Whether a motion describes data, why not, which rows are no outliers, and the scales of all.

    `scales` are the standard deviations of the residuals: 1 if sigma is known.
    """

    is_described: bool
    text: str
    kept: np.ndarray
    scales: np.ndarray


def judge(
    problem: FitProblem, at: Evaluation, digits: dict[str, Digits], last_places: np.ndarray
) -> FitVerdict:
    """Return the verdict on residuals, where few outliers are allowed.

    `digits` is the rounding of the data, `last_places` a unit in the last place for each residual.
    """
    if problem.measured.weighted:
        return _with_sigma(problem, at, digits, last_places)
    return _without_sigma(problem, at, last_places)


def strict(verdict: FitVerdict) -> FitVerdict:
    """Return the verdict if no outliers are allowed."""
    count = int(np.sum(~verdict.kept))
    if not count or not verdict.is_described:
        return verdict
    return verdict._replace(is_described=False, text=f"{counted(count, 'outlier')}")


def outliers_of(
    measured: Measured, residuals: np.ndarray, verdict: FitVerdict
) -> tuple[Outlier, ...]:
    """Return the outliers of a verdict, the worst first."""
    sigmas_off = residuals / verdict.scales
    rows = np.flatnonzero(~verdict.kept)
    return tuple(_outlier(measured, sigmas_off, row) for row in _worst_first(rows, sigmas_off))


def worst(measured: Measured, residuals: np.ndarray, verdict: FitVerdict) -> str:
    """Return a text on the largest residuals."""
    sigmas_off = residuals / verdict.scales
    rows = _worst_first(np.arange(len(sigmas_off)), sigmas_off)[:NAMED]
    return ", ".join(str(_outlier(measured, sigmas_off, row)) for row in rows)


def _worst_first(rows: np.ndarray, sigmas_off: np.ndarray) -> list[int]:
    """Return rows in the order of their residuals, the largest first."""
    sizes = np.abs(sigmas_off[rows])
    return [int(row) for row in rows[np.lexsort((rows, -sizes.round(6)))]]


def _outlier(measured: Measured, sigmas_off: np.ndarray, row: int) -> Outlier:
    """Return a residual as an `Outlier`."""
    column, number = divmod(row, len(measured.t))
    if measured.kinds is None:
        name = measured.columns[column]
    else:
        name = str(measured.kinds[number])
    return Outlier(number, name, float(measured.t[number]), float(sigmas_off[row]))


def _with_sigma(
    problem: FitProblem, at: Evaluation, digits: dict[str, Digits], last_places: np.ndarray
) -> FitVerdict:
    """Return the verdict by the sum of squares, whose distribution is known."""
    from scipy.stats import chi2, norm

    residuals = at.residuals
    count = len(residuals)
    free = len(problem.names)
    scales = np.ones(count)
    # LEVEL is the probability that any of all `count` residuals, of either sign, is beyond this.
    is_kept = np.abs(residuals) <= norm.isf(LEVEL / (2 * count))
    are_rounded = _are_rounded(residuals, last_places)
    rounding_deviation = np.max(last_places) / np.sqrt(12.0)  # of errors uniform in one unit
    if are_rounded and rounding_deviation <= ROUNDED:
        return FitVerdict(
            is_described=True, text="", kept=np.ones(count, dtype=bool), scales=scales
        )
    squares_kept = float(residuals[is_kept] @ residuals[is_kept])
    is_likely = squares_kept <= chi2.isf(LEVEL, max(int(is_kept.sum()) - free, 1))
    # A fit passes through as many data as it has numbers: those alone show nothing.
    are_enough = is_kept.sum() > min(free, count - 1)
    if is_likely and _are_few(is_kept) and are_enough:
        return FitVerdict(is_described=True, text="", kept=is_kept, scales=scales)
    chi_squared = float(residuals @ residuals)
    text = f"chi² is {chi_squared:.4g}, and {max(count - free, 1)} was to be expected"
    if are_rounded:
        names = ", ".join(f"{name} to {column.text}" for name, column in digits.items())
        text += f"; sigma is smaller than the errors of rounding ({names})"
    return FitVerdict(is_described=False, text=text, kept=is_kept, scales=scales)


def _are_rounded(residuals: np.ndarray, last_places: np.ndarray) -> bool:
    """Return whether residuals are those of rounding alone.

    Each rounding error is at most half a unit, and a fit makes the sum of the squares smaller.
    """
    least_squares = float(residuals @ residuals) <= float(last_places @ last_places) / 4.0
    return least_squares and bool(np.all(np.abs(residuals) <= MOST_UNITS * last_places))


def _are_few(is_kept: np.ndarray) -> bool:
    """Return whether so few data are not `is_kept` that they may be outliers."""
    return len(is_kept) - int(is_kept.sum()) <= max(1, int(MOST_OUTLIERS * len(is_kept)))


def _without_sigma(problem: FitProblem, at: Evaluation, last_places: np.ndarray) -> FitVerdict:
    """Return the verdict by the structure of the residuals, whose size is unknown."""
    residuals = at.residuals
    count = len(residuals)
    free = len(problem.names)
    all_rows = np.ones(count, dtype=bool)
    is_telling = informative(at.slopes, np.ones(free))
    scales = _estimated_scales(problem, residuals, is_telling, last_places)
    relative_size = float(np.sqrt(np.mean((residuals / problem.sizes) ** 2)))
    if relative_size <= EXACT or _are_rounded(residuals, last_places):
        return FitVerdict(is_described=True, text="", kept=all_rows, scales=scales)
    if count <= free:
        text = "there are no more data than numbers, and yet it does not pass through them"
        return FitVerdict(relative_size <= np.sqrt(EXACT), text, all_rows, scales)
    limit, limit_for_few = OUTLYING
    is_kept = np.abs(residuals) <= (limit + limit_for_few / (count - free)) * scales
    if not _are_few(is_kept):
        text = "the residuals of many data are far larger than those of half of them"
        return FitVerdict(is_described=False, text=text, kept=is_kept, scales=scales)
    lateness = 0.0  # of events, as a part of the time between them; samples are not judged by it
    if problem.measured.states is None:
        lateness = float(np.sqrt(np.mean(residuals[is_kept] ** 2))) / _time_between(at)
    if lateness > UNRECOGNISED:
        off_by = f"events are off by {lateness:.1%} of the time between events of a kind"
        text = f"{off_by}, and no sigma says so"
        return FitVerdict(is_described=False, text=text, kept=is_kept, scales=scales)
    text = _structure(problem, residuals, is_kept & is_telling)
    return FitVerdict(not text, text, is_kept, scales)


def _time_between(at: Evaluation) -> float:
    """Return the usual time between events of one kind of a motion."""
    events = at.trajectory.events
    if not events:
        return float(at.trajectory.t_end - at.trajectory.t_start)
    kinds = np.array([event.kind for event in events], dtype=object)
    return spacing(np.array([float(event.t) for event in events]), kinds)


def _estimated_scales(
    problem: FitProblem, residuals: np.ndarray, telling: np.ndarray, last_places: np.ndarray
) -> np.ndarray:
    """Return the standard deviation of each residual, by the median of its column.

    Rows that are not `telling` do not count if others are: in a stick v is known without error.
    """
    # A fit of n numbers makes the residuals smaller than the errors, by this factor on average.
    growth = np.sqrt(len(residuals) / max(len(residuals) - len(problem.names), 1))
    scales = np.ones(len(residuals))
    for rows in column_rows(problem):
        sizes = np.abs(residuals[rows])
        sizes = sizes[telling[rows]] if telling[rows].any() else sizes
        if len(sizes) < FEW:
            scale = float(np.sqrt(np.mean(sizes**2)))
        else:
            scale = MEDIAN_SCALE * float(np.median(sizes))
        rounding = float(np.max(last_places[rows])) / np.sqrt(12.0)  # of errors uniform in one unit
        scales[rows] = max(growth * scale, rounding, EXACT * float(np.max(problem.sizes[rows])))
    return scales


def _structure(problem: FitProblem, residuals: np.ndarray, is_kept: np.ndarray) -> str:
    """Return a text on residuals that are like their neighbours in time; "" if they are not."""
    from scipy.stats import norm

    order = np.argsort(problem.measured.t, kind="stable")
    for name, rows in zip(problem.measured.columns, column_rows(problem), strict=True):
        series = residuals[rows][order][is_kept[rows][order]]
        if len(series) < 3 or not np.any(series):
            continue
        # Of independent errors the ratio of von Neumann is 2 ± 2 / sqrt(n); it is 2 minus twice the
        # correlation of neighbours.
        ratio = float(np.sum(np.diff(series) ** 2) / np.sum(series**2))
        deviation = 2.0 / np.sqrt(len(series))
        if ratio < 2.0 + norm.ppf(LEVEL) * deviation:
            correlation = 1.0 - ratio / 2.0
            return (
                f"neighbouring residuals of {name} are alike: their correlation is "
                f"{correlation:.2f}, that of independent errors 0 ± {deviation / 2.0:.2f}"
            )
    return ""
