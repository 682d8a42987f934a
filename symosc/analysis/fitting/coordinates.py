"""What the search for fitted numbers varies, so that numbers which must be in order stay so.

Where two free numbers have an order, such as mu1 <= mu_s1 or w1_1 < w1_2, the search varies the
lower one and the gap, which is not negative. A fixed neighbour is a bound.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from symosc.base.quantities import NumberOfBelt, least
from symosc.model import Model
from symosc.scenes import STARTS


def orders_of(model: Model) -> list[tuple[str, str]]:
    """Return the pairs of numbers of which the first must not exceed the second."""
    orders = list[tuple[str, str]]()
    for n, belt in enumerate(model.law.belts, 1):
        if belt.mu_s is not None and belt.mu_s > belt.mu:
            orders.append((str(NumberOfBelt("mu", n)), str(NumberOfBelt("mu_s", n))))
        points = [str(NumberOfBelt("w", n, i)) for i in range(1, len(belt.curve))]
        orders += pairwise(points)
    return orders


class Coordinates:
    """The numbers `names` of a model as the search varies them, with their bounds.

    Attributes
    ----------
    low, high : arrays
        The bounds in the coordinates of the search.
    """

    def __init__(self, names: tuple[str, ...], model: Model) -> None:
        numbers = model.numbers()
        count = len(names)
        self.low = np.full(count, -np.inf)
        self.high = np.full(count, np.inf)
        for n, name in enumerate(names):
            bound = None if name in STARTS else least(name)
            if bound is not None:
                self.low[n] = float(bound)
        #: For each number that is searched as a gap, the number below it, in order from below.
        self._below = list[tuple[int, int]]()
        for lower, upper in orders_of(model):
            if lower in names and upper in names:
                place = names.index(upper)
                self._below.append((place, names.index(lower)))
                self.low[place] = 0.0
        gaps = [place for place, _ in self._below]
        for lower, upper in orders_of(model):
            if lower in names and upper not in names and names.index(lower) not in gaps:
                self.high[names.index(lower)] = float(numbers[upper])
            elif upper in names and lower not in names:
                place = names.index(upper)
                self.low[place] = max(self.low[place], float(numbers[lower]))

    def of(self, values: np.ndarray) -> np.ndarray:
        """Return numbers, or rows of them, in the coordinates of the search."""
        places = np.array(values, dtype=float)
        for place, below in self._below:
            places[..., place] = values[..., place] - values[..., below]
        return places

    def back(self, places: np.ndarray) -> np.ndarray:
        """Return the numbers at coordinates of the search."""
        values = np.array(places, dtype=float)
        for place, below in self._below:
            values[..., place] = values[..., below] + places[..., place]
        return values

    def slopes(self, by_numbers: np.ndarray) -> np.ndarray:
        """Return derivatives by the coordinates of the search, from those by the numbers."""
        slopes = np.array(by_numbers, dtype=float)
        for place, below in reversed(self._below):
            slopes[:, below] += slopes[:, place]
        return slopes
