"""The best minimum: the one next to the first values if it describes the data, else one of many."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symosc.analysis.fitting.judge import FitVerdict, judge, strict
from symosc.analysis.fitting.problem import Evaluation, FitProblem
from symosc.analysis.fitting.search import CAUCHY, candidates, minimum
from symosc.analysis.fitting.spread import rounding, units

#: How much larger the variance of a robust fit is than that of least squares if errors are normal:
#: what `CAUCHY` is chosen for.
NORMAL_LOSS = 1.0 / 0.95
#: Where all residuals are less than this part of the data's size no other minimum is looked for:
#: the errors are larger than was said, or not random.
CLOSE = 1e-3
#: Candidates that differ by less than this part are the same minimum.
SAME = 3e-3
#: The most motions that a minimum may take: next to the first values, and next to a candidate.
MOST_MOTIONS = (200, 40)
#: Rounds of estimating sigma and fitting robustly with it.
ROUNDS = 4
#: With more outliers than this other minima are tried first: one of them may describe all data.
MOST_AT_ONCE = 1
#: A minimum must be lower by this part to be preferred to an earlier one.
LOWER = 1e-6


class Minimum(NamedTuple):
    """Numbers at a minimum, with the motion there and a verdict that allows for a few outliers."""

    values: np.ndarray
    at: Evaluation
    verdict: FitVerdict
    failure: str  # why the minimum was not reached; "" if it was

    @property
    def cost(self) -> float:
        """A measure of how badly the motion describes the data, in which outliers hardly count."""
        return float(np.sum(np.log1p((self.at.residuals / CAUCHY) ** 2)))

    def losses(self, weighted: bool) -> float:
        """By how much a robust loss makes variances larger than least squares without outliers."""
        if weighted:
            return NORMAL_LOSS
        kept = self.verdict.kept
        squares = (self.at.residuals[kept] / self.verdict.scales[kept]) ** 2
        mean = float(np.mean(squares))
        if not mean:
            return 1.0
        # The variance of an M-estimate is that of psi over the square of the mean of psi'; here
        # psi = r / (1 + (r / c)^2).
        shrunk = 1.0 + squares / CAUCHY**2
        slope = max(float(np.mean((2.0 - shrunk) / shrunk**2)), 0.1)
        return float(np.mean(squares / shrunk**2)) / slope**2 / mean


class Search:
    """The search for the best minimum of a problem, from its first values on.

    Attributes
    ----------
    plain : Minimum
        The best minimum of the sum of squares.
    tolerant : Minimum or None
        A minimum that describes all data but a few, by a loss in which outliers hardly count; None
        if `plain` describes all, or nothing describes so many.
    is_wide : bool
        Whether many starts were tried.
    """

    def __init__(self, problem: FitProblem, first: np.ndarray) -> None:
        self.problem = problem
        self.first = first
        self.digits = rounding(problem.measured, problem.belt_speeds)
        self.places = units(problem, self.digits)
        self.is_wide = False
        self.tolerant: Minimum | None = None
        self.plain = self._least_squares(first)
        if not self._is_good(self.plain):
            self._try_more()

    def robust(self) -> Minimum:
        """Return the best minimum of a loss in which outliers hardly count."""
        if self.tolerant is not None:
            return self.tolerant
        return self._robust(self.plain.values, self.plain)

    def _try_more(self) -> None:
        """Look for a better minimum than the first one."""
        # The cheapest reasons first: outliers at the first minimum, and a first minimum that is
        # almost right, which no other one would better.
        tolerant = self._robust(self.plain.values, self.plain)
        if self._is_good(tolerant, with_outliers=True):
            self._accept(tolerant)
            return
        if np.all(np.abs(self.plain.at.residuals) <= CLOSE * self.problem.sizes):
            return
        self.is_wide = True
        tried: list[np.ndarray] = []
        for values in candidates(self.problem, self.first):
            if any(np.allclose(values, earlier, rtol=SAME, atol=0.0) for earlier in tried):
                continue
            tried.append(values)
            plain = self._least_squares(values)
            if plain.cost < (1.0 - LOWER) * self.plain.cost:
                self.plain = plain
            if self._is_good(plain):
                return
            robust = self._robust(values, plain)
            if self._is_good(robust, with_outliers=True):
                self._accept(robust)
                return
            if robust.cost < (1.0 - LOWER) * tolerant.cost:
                tolerant = robust
        if tolerant.verdict.is_described and not strict(self.plain.verdict).is_described:
            self._accept(tolerant)

    def _accept(self, tolerant: Minimum) -> None:
        """Take a minimum with outliers, and the minimum of the sum of squares next to it."""
        self.tolerant = tolerant
        self.plain = self._least_squares(tolerant.values)

    def _is_good(self, minimum: Minimum, with_outliers: bool = False) -> bool:
        """Return whether no other minimum need be looked for."""
        outliers = int(np.sum(~minimum.verdict.kept))
        most = MOST_AT_ONCE if with_outliers else 0
        return minimum.verdict.is_described and outliers <= most

    def _least_squares(self, first: np.ndarray) -> Minimum:
        """Return the minimum of the sum of squares next to the values `first`."""
        return self._minimum(first, 1.0, "linear")

    def _robust(self, values: np.ndarray, before: Minimum) -> Minimum:
        """Return the minimum of a loss in which outliers hardly count, from `values` on.

        The scale of its residuals is that of the minimum `before`; an unknown sigma then follows
        from its own ones.
        """
        rounds = 1 if self.problem.measured.weighted else ROUNDS
        for _ in range(rounds):
            before = self._minimum(values, CAUCHY * before.verdict.scales, "cauchy")
            values = before.values
        return before

    def _minimum(self, first: np.ndarray, scale: np.ndarray | float, loss: str) -> Minimum:
        """Return the minimum of a loss of residuals in units of `scale`."""
        values, failure = minimum(self.problem, first, scale, loss, MOST_MOTIONS[self.is_wide])
        at = self.problem.evaluate(values)
        return Minimum(values, at, judge(self.problem, at, self.digits, self.places), failure)
