"""Standard errors of fitted numbers: from the errors of the data, and from their rounding.

Rounding errors repeat where a motion repeats: all samples of a stick may share one, and so may the
samples of a settled motion one period apart. So the fitted motion and its neighbours are rounded as
the data were, and the fits to them spread as the errors say (`test_errors_of_samples`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symosc.analysis.fitting.measured import Measured
from symosc.analysis.fitting.problem import Evaluation, FitProblem
from symosc.crosschecks.rounding import Digits, find_digits
from symosc.simulation.simulate import ACCURACY

#: A combination of numbers whose change by its own size changes the residuals by less than this is
#: not determined.
UNDETERMINED = 1e-8
#: A number with a smaller factor than this in a combination of length 1 is not part of it.
NO_FACTOR = 1e-6
#: A row whose derivatives are smaller than this part of the largest ones tells nothing.
TELLS_NOTHING = 1e-12
#: So many neighbours of the fitted motion are rounded, whose samples move by about so many units.
NEIGHBOURS = 256
NEIGHBOURHOOD = 2.0
#: Where noise is added before rounding, less than this part of the errors that repeat is neglected.
NO_REPEATS = 1e-3


class Spread(NamedTuple):
    """Standard errors, covariance, and two texts on what is undetermined: names, combinations."""

    errors: np.ndarray
    covariance: np.ndarray
    unknown: str
    undetermined: str


def rounding(measured: Measured, speeds: list[float]) -> dict[str, Digits]:
    """Return the rounding of the measured columns that have fewer digits than doubles."""
    if measured.states is None:
        digits = {"t": find_digits(measured.t)}
    else:
        natural = {"x": measured.states[0, :1].tolist(), "v": speeds}
        columns = zip(measured.columns, measured.states, strict=True)
        digits = {name: find_digits(column, natural[name]) for name, column in columns}
    return {name: column for name, column in digits.items() if column is not None}


def units(problem: FitProblem, digits: dict[str, Digits]) -> np.ndarray:
    """Return for each residual a unit in the last place of its datum, 0 if that is a double."""
    measured = problem.measured
    none = np.zeros(len(measured.t))
    columns = [digits[name].units if name in digits else none for name in measured.columns]
    return np.concatenate(columns) / problem.weights


def informative(slopes: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return which rows of the derivatives tell something of the numbers."""
    sizes = np.max(np.abs(slopes * steps), axis=1, initial=0.0)
    return np.asarray(sizes > TELLS_NOTHING * np.max(sizes, initial=0.0))


def column_rows(problem: FitProblem) -> list[slice]:
    """Return the rows of residuals that belong to each measured column."""
    count = len(problem.measured.t)
    return [slice(i * count, (i + 1) * count) for i in range(len(problem.measured.columns))]


def spread_of(
    problem: FitProblem, at: Evaluation, steps: np.ndarray, is_kept: np.ndarray, last_places: np.ndarray,
    losses: float,
) -> Spread:  # fmt: skip
    """Return how far off the fitted numbers may be.

    `is_kept` marks the rows that are no outliers, `last_places` are the `units` of all, `losses` is by how
    much the loss makes the variance larger than least squares would. Numbers count in `steps`.
    """
    names = problem.names
    slopes = at.slopes * steps * is_kept[:, None]
    # Singular values and right singular vectors, the latter for as many combinations of numbers as
    # there are numbers. Combinations that the residuals do not feel have no error of their own.
    _, sizes, rows = np.linalg.svd(slopes, full_matrices=len(slopes) < len(names))
    sizes = np.append(sizes, np.zeros(len(names) - len(sizes)))
    free = sizes <= UNDETERMINED * max(float(sizes.max(initial=0.0)), 1e-300)
    inverse = np.where(free, 0.0, 1.0 / np.where(free, 1.0, sizes))
    root = rows.T * inverse  # root @ root.T is the covariance for residuals of variance 1
    variances, widening = _variances(problem, at, slopes, root, is_kept)
    weighted = problem.measured.weighted
    squares = np.ones(len(slopes)) if weighted else variances
    # The rounding that repeats is no independent error: its u^2/12 is taken out of the variances,
    # and what it does to the fit is found by rounding neighbours of the motion.
    repeating = _repeating(last_places, variances)
    effects = squares - repeating * last_places**2 / 12.0
    spreads = (slopes @ root) * np.sqrt(np.maximum(effects, 0.0))[:, None]
    inner = spreads.T @ spreads
    if repeating.any():
        inner += _rounded_spread(problem, at, slopes, root, last_places, repeating)
    covariance = root @ inner @ root.T * losses * widening * np.outer(steps, steps)
    unknown, undetermined = _undetermined(names, rows[free])
    is_unknown = [name in unknown for name in names]
    errors = np.where(is_unknown, np.inf, np.sqrt(np.diag(covariance)))
    return Spread(errors, covariance, ", ".join(unknown), undetermined)


def _variances(
    problem: FitProblem, at: Evaluation, slopes: np.ndarray, root: np.ndarray, is_kept: np.ndarray
) -> tuple[np.ndarray, float]:
    """Return the variance of each residual as its column shows it, and how uncertain that is.

    The second is the factor that makes one standard error as likely as with a known variance.
    """
    from scipy.stats import norm, t

    is_telling = informative(slopes, np.ones(slopes.shape[1])) & is_kept
    variances = np.ones(len(slopes))
    freedom = 0.0
    floors = ACCURACY * np.maximum(1.0, np.abs(_data(problem))) / problem.weights
    # The diagonal of the hat matrix: how much of a degree of freedom each row takes for the fit.
    leverages = np.sum((slopes @ root) ** 2, axis=1)
    for rows in column_rows(problem):
        chosen = is_telling[rows] if is_telling[rows].any() else is_kept[rows]
        freedom_left = float(chosen.sum() - leverages[rows][chosen].sum())
        off = at.residuals[rows][chosen]
        variance = float(off @ off) / max(freedom_left, 1.0)
        variances[rows] = max(variance, float(floors[rows].max()) ** 2)
        freedom += freedom_left if is_telling[rows].any() else 0.0
    if problem.measured.weighted:
        return variances, 1.0
    one_sigma = norm.cdf(1.0)
    return variances, float(t.ppf(one_sigma, max(freedom, 1.0)) ** 2)


def _data(problem: FitProblem) -> np.ndarray:
    """Return the measured numbers in the order of the residuals."""
    measured = problem.measured
    return measured.t if measured.states is None else measured.states.ravel()


def _repeating(last_places: np.ndarray, variances: np.ndarray) -> np.ndarray:
    """Return which part of the variance of rounding is that of errors that repeat with the motion.

    Noise before the rounding makes the rounding errors independent: the covariance of those of two
    equal values, u^2/12, falls by exp(-(2 pi s / u)^2) with noise of standard deviation s.
    """
    squares = np.where(last_places > 0.0, last_places, 1.0) ** 2
    noise = np.maximum(variances - squares / 12.0, 0.0)
    exponents = (2.0 * np.pi) ** 2 * noise / squares
    share = np.exp(-np.minimum(exponents, 700.0))  # beyond that exp would underflow, with a warning
    return np.where((last_places > 0.0) & (share > NO_REPEATS), share, 0.0)


def _rounded_spread(
    problem: FitProblem, at: Evaluation, slopes: np.ndarray, root: np.ndarray, last_places: np.ndarray,
    repeating: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Return the covariance of fits, in the axes of `root`, to rounded neighbours of a motion."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    exact = at.residuals + _data(problem) / problem.weights
    rows = repeating > 0.0
    unit = last_places[rows]
    axes = slopes @ root
    numbers = slopes.shape[1]
    # The columns of `axes` have length 1: with the root each sample moves by about NEIGHBOURHOOD.
    moves = axes * np.median(unit) * NEIGHBOURHOOD * np.sqrt(len(slopes))
    # Normally distributed points; the first of Halton, 0, would become -inf.
    points = ndtri(qmc.Halton(numbers, scramble=False).random(NEIGHBOURS + 1)[1:])
    spread = np.zeros((numbers, numbers))
    for point in points:
        moved = (exact + moves @ point)[rows] / unit
        errors = (np.rint(moved) - moved) * unit * np.sqrt(repeating[rows])
        effect = axes[rows].T @ errors
        spread += np.outer(effect, effect) / NEIGHBOURS
    return spread


def _undetermined(names: tuple[str, ...], rows: np.ndarray) -> tuple[list[str], str]:
    """Return which of the `names` data do not determine, and a text on combinations in `rows`."""
    combinations = []
    for row in rows.tolist():
        factors = dict(zip(names, row, strict=True))
        combinations.append(
            {name: factor for name, factor in factors.items() if abs(factor) > NO_FACTOR}
        )
    unknown = [name for name in names if any(name in factors for factors in combinations)]
    texts = []
    for factors in combinations:
        texts.append(" ".join(f"{factor:+.3g} {name}" for name, factor in factors.items()))
    return unknown, "; ".join(texts)
