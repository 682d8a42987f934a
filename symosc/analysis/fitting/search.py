"""The search for the best numbers: from one start, and if that does not do, from many.

Nothing is random: the starts are the points of a Halton sequence, and candidates are ordered by
their costs, rounded, and then by their numbers, so that no last bit decides.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

import numpy as np

from symosc.analysis.fitting.problem import IMPOSSIBLE, FitProblem
from symosc.base.errors import ParameterError

#: A number is looked for between its first value divided by this and times this: 30 % above a first
#: value that is 30 % too small is 1.43 times that value.
REACH = 1.5
#: How many starts, by the number of free numbers (`test_a_family_of_fits`).
STARTS_TRIED = (40, 90, 150, 200)
#: Which first parts of the data choose starts: a short motion has fewer minima than a long one.
PARTS = (1.0, 0.5, 0.25, 0.12)
#: How many of the best starts are followed for each part.
FOLLOWED = 3
#: In the search a residual of this part of `Problem.sizes` is large: larger ones hardly count more.
LARGE = 0.05
#: In the search so many samples are enough.
MOST_SAMPLES = 300
#: The loss ln(1 + (r / c)^2) with this c, in standard deviations, needs 5 % more data than least
#: squares where errors are normal.
CAUCHY = 2.385


#: Evaluations that a fit to the beginning of the data may take: enough to come near a minimum.
ROUGH_STEPS = 20
#: A number below this says nothing of its own size.
NO_SIZE = 1e-9
#: A gradient below this is none: residuals that are in no units of sigma may have small ones.
NO_GRADIENT = float(np.finfo(float).eps)


def minimum(
    problem: FitProblem, first: np.ndarray, scale: np.ndarray | float = 1.0, loss: str = "linear",
    most: int = 200, precise: bool = True,
) -> tuple[np.ndarray, str]:  # fmt: skip
    """Return the numbers at the minimum next to `first`, and why it was not reached; "" if it was.

    Residuals are divided by `scale`; the loss is one of `scipy.optimize.least_squares`. Raises
    ParameterError if no motion has the first numbers.
    """
    from scipy.optimize import least_squares

    coordinates = problem.coordinates
    begin = np.clip(coordinates.of(first), coordinates.low * (1 + 1e-9), coordinates.high)
    begin_numbers = coordinates.back(begin)
    problem.evaluate(begin_numbers)  # raises the error of first numbers that no motion has
    sizes = np.abs(begin_numbers)  # of a gap that of the number above it

    def residuals(places: np.ndarray) -> np.ndarray:
        try:
            return problem.evaluate(coordinates.back(places)).residuals / scale
        except ParameterError:
            return IMPOSSIBLE * problem.sizes / scale

    def slopes(places: np.ndarray) -> np.ndarray:
        weights = np.broadcast_to(scale, problem.weights.shape)
        by_numbers = problem.evaluate(coordinates.back(places)).slopes
        return coordinates.slopes(by_numbers / weights[:, None])

    solution = least_squares(
        residuals,
        begin,
        jac=slopes,
        bounds=(coordinates.low, coordinates.high),
        x_scale=np.where(sizes > NO_SIZE, sizes, 1.0),
        loss=loss,
        max_nfev=most,
        gtol=NO_GRADIENT,
        ftol=1e-10 if precise else 1e-3,
        xtol=1e-12 if precise else 1e-4,
    )
    failure = "" if solution.success else str(solution.message)
    return coordinates.back(solution.x), failure


def starts(first: np.ndarray) -> np.ndarray:
    """Return first values for a search around `first`, which is the first of them."""
    from scipy.stats import qmc

    count = STARTS_TRIED[min(len(first), len(STARTS_TRIED)) - 1]
    points = qmc.Halton(len(first), scramble=False).random(count + 1)[1:]  # the first one is 0
    ratios = REACH ** (2.0 * points - 1.0)
    # A number that begins at 0 has no size to be multiplied: it is moved to both sides.
    spread = np.where(first == 0.0, np.log(ratios), first * ratios)
    return np.concatenate([[first], spread])


def candidates(problem: FitProblem, first: np.ndarray) -> Iterator[np.ndarray]:
    """Yield numbers near minima, the most promising ones first."""
    rough = problem.thinned(MOST_SAMPLES)
    large = LARGE * rough.sizes
    start_values = problem.coordinates.back(starts(problem.coordinates.of(first)))
    # One row per start, one column per residual; large residuals hardly count more than others.
    costs = np.log1p((np.array([rough.distances(values) for values in start_values]) / large) ** 2)
    times = np.sort(rough.measured.t)
    least_count = 3 * len(first) + 3  # times that a first part has, if there are so many
    followed = set()
    for part in PARTS:
        count = min(len(times), max(least_count, ceil(part * len(times))))
        is_in_part = rough.measured.times <= times[count - 1]
        cost = costs[:, is_in_part].mean(axis=1)
        # By rounded cost, then by number: no last bit decides.
        order = np.lexsort((np.arange(len(start_values)), np.round(cost, 6)))
        for number in order[:FOLLOWED].tolist():
            if (number, count) not in followed and np.isfinite(cost[number]):
                followed.add((number, count))
                yield _followed(rough, start_values[number], count)


def _followed(rough: FitProblem, values: np.ndarray, count: int) -> np.ndarray:
    """Return numbers fitted to the first `count` times, then to twice as many, up to all."""
    times = np.sort(rough.measured.t)
    while True:
        beginning = rough if count == len(times) else rough.until(float(times[count - 1]))
        # Where it stops need be no minimum: the longer beginning goes on from there.
        values, _ = minimum(
            beginning, values, LARGE * beginning.sizes, "cauchy", ROUGH_STEPS, precise=False
        )
        if count == len(times):
            return values
        count = min(len(times), 2 * count)
