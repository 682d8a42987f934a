"""The modes and the bands of a friction law, as cross-checks need them.

Modes are codes of `symosc.friction.ALL_MODE_NAMES`, as events have them. Where friction depends on
the relative speed, or there are more than two belts, each band between two edges has its own row of
constants. Laws without bands have one row.
"""

from __future__ import annotations

from functools import lru_cache
from math import inf
from typing import Any, NamedTuple

import numpy as np

from symosc.engine.arithmetic import Arithmetic, rows_in_doubles
from symosc.engine.events import mode_of_law
from symosc.engine.flow import Constants
from symosc.engine.start import belt_start, start_rows
from symosc.engine.state import MIDDLE, ON_BELT, STATE_ROW
from symosc.friction import ALL_MODE_NAMES, MOST_BELTS, domain_code, stick_code
from symosc.model import Model

#: The code of the mode in each domain, and on each belt, by its number; 0 for number 0.
DOMAIN_CODES = np.array([0, *map(domain_code, range(1, MOST_BELTS + 2))])
STICK_CODES = np.array([0, *map(stick_code, range(1, MOST_BELTS + 1))])
#: By the code of a mode: the number of its domain, 0 in a stick; and that of its belt, 0 in a
#: domain.
DOMAIN_OF = np.zeros(max(ALL_MODE_NAMES) + 1, int)
DOMAIN_OF[DOMAIN_CODES] = range(len(DOMAIN_CODES))
BELT_OF = np.zeros_like(DOMAIN_OF)
BELT_OF[STICK_CODES] = range(len(STICK_CODES))
#: The codes of all modes by their names.
MODES = {name: code for code, name in ALL_MODE_NAMES.items()}


class Begun(NamedTuple):
    """Starts of motions: rows of a batch (STATE_ROW), and for each the number of its constants."""

    rows: np.ndarray
    sets: np.ndarray


class Bands:
    """The constants of a law, row by row, and where velocities lie.

    Attributes
    ----------
    rows : tuple of Constants
    is_plain : bool
        Whether there is one row, with all domains.
    speeds : float array
        The speeds of the belts.
    walls : float array
        -inf, the speeds of the belts, inf: domain n lies between the entries n - 1 and n.
    """

    def __init__(self, parameters: Model) -> None:
        law = parameters.law
        self.parameters = parameters
        self.rows = tuple(K._replace(sigmas=0.0) for K in rows_in_doubles(parameters))
        self.is_plain = law.is_plain
        self.speeds = np.array([float(belt.v) for belt in law.belts])
        self.walls = np.array([-inf, *self.speeds, inf])
        # By number of the row, and the engine's mode in it: the mode of the law.
        local_modes = range(ON_BELT + 3)
        self._modes = np.array([[mode_of_law(mode, K) for mode in local_modes] for K in self.rows])
        if self.is_plain:
            return
        self._edges = np.array([float(edge.v) for edge in law.edges])
        numbers = [edge.belt for edge in law.edges]
        self._edge_of_belt = np.array([numbers.index(belt) for belt in law.boundaries])
        # The first and the last row of each domain.
        self._first = np.append(0, self._edge_of_belt + 1)
        self._last = np.append(self._edge_of_belt, len(self.rows) - 1)

    def modes(self, sets: np.ndarray, local: np.ndarray) -> np.ndarray:
        """Return the codes of modes, given as the engine's in the rows `sets` of constants."""
        return np.asarray(self._modes[sets, local.astype(int)])

    def belts_at(self, v: np.ndarray) -> np.ndarray:
        """Return the number of the belt that has each velocity, 0 where none has."""
        numbers = np.searchsorted(self.speeds, v)
        return np.where(np.append(self.speeds, inf)[numbers] == v, numbers + 1, 0)

    def row_of(self, domain: Any, v: Any) -> np.ndarray:
        """Return the number of the row of constants for a velocity in a domain.

        For a velocity that is not in the domain it is that of the domain's band next to it.
        """
        if self.is_plain:
            return np.zeros(np.broadcast(domain, v).shape, int)
        number = np.asarray(domain) - 1
        own = np.searchsorted(self._edges, v)
        return np.clip(own, self._first[number], self._last[number])

    def constants_at(self, domain: int, v: float) -> tuple[Constants, float]:
        """Return the constants for a velocity in a domain, as `row_of` does, and the constant force
        there.
        """
        K = self.rows[int(self.row_of(domain, v))]
        if K.banded:
            return K, float(K.A2)
        return K, float((K.A1, K.A2, K.A3)[domain - 1])

    def begun(
        self, on: np.ndarray, theta: np.ndarray, x: np.ndarray, v: np.ndarray, tau: np.ndarray
    ) -> Begun:
        """Return starts at time 0 of motions that go on for times `tau`.

        Where `on` is the number of a belt, the motion begins on it.
        """
        if self.is_plain:
            (K,) = self.rows
            rows, _ = start_rows(on, (theta, 0.0), x, v, (0.0, 0.0, tau, 0.0, 0.0), K)
            return Begun(rows, np.zeros(len(rows), np.int64))
        # A start on an edge is one on the upper edge of the band below it.
        sets = np.searchsorted(self._edges, v).astype(np.int64)
        at_edge = np.append(self._edges, inf)[sets] == v
        sets = np.where(on > 0, self._edge_of_belt[on - 1], sets)
        at = np.where(at_edge | (on > 0), MIDDLE, 0)
        rows = np.empty(len(x), STATE_ROW)
        for row, here in groups(sets):
            times = (0.0, 0.0, tau[here], 0.0, 0.0)
            phase = (theta[here], 0.0)
            rows[here], _ = start_rows(at[here], phase, x[here], v[here], times, self.rows[row])
        self._leave_corners(rows, sets)
        above = rows["mode"] == MIDDLE + 1
        rows["mode"][above] = MIDDLE
        rows["at"][above] = MIDDLE - 1
        sets[above] += 1
        return Begun(rows, sets)

    def _leave_corners(self, rows: np.ndarray, sets: np.ndarray) -> None:
        """Let starts on corners with no force at all, which hold nothing, fly below or above."""
        is_corner = np.array([K.belt2.is_corner for K in self.rows])
        for i in np.flatnonzero((rows["mode"] > ON_BELT) & is_corner[sets]).tolist():
            arithmetic = Arithmetic(self.parameters, int(sets[i]))
            row = rows[i]
            phase = float(row["s"]), float(row["c"])
            row["mode"] = belt_start(MIDDLE, float(row["x"]), phase, arithmetic).mode


def groups(sets: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Return the rows of constants that occur in `sets`, each with the places where it does."""
    if not len(sets):
        return [(0, np.arange(0))]
    if np.all(sets == sets[0]):
        return [(int(sets[0]), np.arange(len(sets)))]
    order = np.argsort(sets, kind="stable")
    begins = np.flatnonzero(np.diff(sets[order], prepend=-1))
    return [(int(sets[part[0]]), part) for part in np.split(order, begins[1:])]


@lru_cache(maxsize=64)
def bands_of(parameters: Model) -> Bands:
    """Return the `Bands` of a law, from a cache."""
    return Bands(parameters)
