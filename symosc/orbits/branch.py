"""Branches of periodic orbits: their points, and why they end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from symosc.aliases import Record
from symosc.arguments import public
from symosc.display.drawable import Drawable
from symosc.display.frames import imported
from symosc.errors import SymoscError
from symosc.exact import whole_number
from symosc.model import Parameters
from symosc.orbits.admissibility import Condition
from symosc.orbits.find import find_orbit
from symosc.orbits.floquet import NEAR_ONE
from symosc.orbits.periodic_orbit import PeriodicOrbit, SwitchingPoint


class BranchError(SymoscError, ValueError):
    """A branch that cannot be begun, because its first root is not an orbit.

    Attributes
    ----------
    orbit : PeriodicOrbit

    Examples
    --------
    >>> from symosc import BranchError, continue_orbit, load_scene
    >>> try:
    ...     continue_orbit(load_scene("fig5").parameters, "P32", "Omega", (0.9, 1.1))
    ... except BranchError as error:
    ...     print(error.orbit.failures[0].text)
    F^(2) > 0 where P2 crosses v1 (Theorem 5)
    """

    def __init__(self, orbit: PeriodicOrbit) -> None:
        self.orbit = orbit
        super().__init__(f"the branch of {orbit.word} has no first orbit: {orbit.message}")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.orbit,)


@dataclass(frozen=True)
class BranchPoint:
    """A point of a branch: value of the parameter, switching points (x, theta), multipliers, margins."""

    value: float
    points: np.ndarray
    tangent: np.ndarray
    trace: float
    determinant: float
    multipliers: tuple[complex, complex]
    conditions: tuple[Condition, ...]
    failures: tuple[Condition, ...]

    @property
    def stable(self) -> bool:
        """Whether both multipliers lie inside the unit circle by more than rounding."""
        return max(abs(value) for value in self.multipliers) < 1 - NEAR_ONE


class BranchEnd(NamedTuple):
    """Where and why a branch ends.

    Attributes
    ----------
    kind : str
        "grazing", "birth of a stick", "vanishing of a stick", "birth of a slip", "vanishing of a slip", "vanishing of a
        flight", "end of the range", "no convergence" or "max_points". For c = 0 also "fold", "period doubling" and
        "Neimark-Sacker", which damping excludes (`symosc.orbits.floquet`).
    value : float
        The parameter there: the last value with an orbit, to the resolution of doubles.
    message : str
        Which inequality or multiplier it is, and when in the orbit.
    points : tuple of SwitchingPoint
        The orbit there.
    conditions : tuple of Condition
        The inequalities that pass 0, the one that explains the others first, where they do.
    beyond : str or None
        The word of the orbit just beyond the end: one was found and verified there, as near as 1e-9 of the range. None
        at the end of the range, where the motion has no word (the message says what it does), or if none was found.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> end = branch.ends[0]
    >>> end.kind, f"{end.value:.6f}", end.beyond
    ('birth of a stick', '3.288576', 'P132')
    """

    kind: str
    value: float
    message: str
    points: tuple[SwitchingPoint, ...]
    conditions: tuple[Condition, ...]
    beyond: str | None = None


class Branch(Drawable):
    """A branch of periodic orbits over one parameter.

    Attributes
    ----------
    word : str
    labels : tuple of str
        Its mappings in order of time.
    parameter : str
    values : (m,) array
        The parameter, point by point along the branch.
    points : (m, n, 2) array
        (t, x) of the n switching points.
    multipliers : (m, 2) complex array
    stable : (m,) bool array
        True where damping proves it, or both multipliers are clearly inside the unit circle (`symosc.orbits.floquet`).
    periods : int
        Number of forcing periods.
    ends : tuple of two BranchEnd
        Why it ends at its first and its last point.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.9, 4.1))
    >>> branch.labels, bool(branch.stable.all())
    (('P2', 'P3'), True)
    """

    def __init__(
        self,
        orbit: PeriodicOrbit,
        parameter: str,
        path: list[BranchPoint],
        ends: tuple[BranchEnd, BranchEnd],
    ) -> None:
        self._orbit = orbit
        self.word, self.labels, self.periods, self.parameter = orbit.word, orbit.labels, orbit.periods, parameter
        self.ends = ends
        self.values = np.array([point.value for point in path])
        self.points = np.array([times_of(orbit.parameters, parameter, point) for point in path])
        self.multipliers = np.array([point.multipliers for point in path])
        self.stable = np.array([self.parameters(i).c > 0 or point.stable for i, point in enumerate(path)])

    @public
    def parameters(self, i: int) -> Parameters:
        """Return the parameters of the branch's i-th point; i as for a list, so that -1 is the last one."""
        return self._orbit.parameters.replace(**{self.parameter: float(self.values[self._index(i)])})

    @public
    def orbit(self, i: int, digits: int | None = None) -> PeriodicOrbit:
        """Return the orbit at the branch's i-th point; `digits` as for `symosc.find_orbit`."""
        return find_orbit(self.parameters(i), self.word, self.points[self._index(i)], digits, periods=self.periods)

    def _index(self, i: int) -> int:
        return whole_number("i", i, -len(self.values), len(self.values) - 1)

    def as_dict(self) -> Record:
        """Return everything as plain values."""

        def plain(end: BranchEnd) -> Record:
            points = [list(map(float, point)) for point in end.points]
            return end._asdict() | {"points": points, "conditions": [c._asdict() for c in end.conditions]}

        return {
            "word": self.word,
            "parameters": self._orbit.parameters.as_dict(),
            "parameter": self.parameter,
            "periods": self.periods,
            "values": self.values.tolist(),
            "points": self.points.tolist(),
            "multipliers": [[[value.real, value.imag] for value in pair] for pair in self.multipliers.tolist()],
            "stable": self.stable.tolist(),
            "ends": [plain(end) for end in self.ends],
        }

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per point of the branch; MissingExtraError if pandas is not installed."""
        columns = {self.parameter: self.values}
        for i in range(self.points.shape[1]):
            columns |= {f"t{i}": self.points[:, i, 0], f"x{i}": self.points[:, i, 1]}
        columns |= {f"multiplier{i}": self.multipliers[:, i] for i in (0, 1)}
        return imported("pandas").DataFrame(columns | {"stable": self.stable})

    def to_xarray(self) -> Any:
        """Return a Dataset over `point`, `switching` and `which`; MissingExtraError if xarray is not installed."""
        columns: Record = {name: (("point", "switching"), self.points[..., i]) for i, name in enumerate(("t", "x"))}
        for name, part in (("re", self.multipliers.real), ("im", self.multipliers.imag)):
            columns[f"multiplier_{name}"] = ("point", "which"), part  # no file format has complex numbers
        columns["stable"] = ("point",), self.stable
        places = {self.parameter: ("point", self.values), "map": ("switching", list(self.labels))}
        about = {"word": self.word, "periods": self.periods, "ends": [end.kind for end in self.ends]}
        return imported("xarray").Dataset(columns, coords=places, attrs=about)

    def __eq__(self, other: object) -> bool:
        """Whether both are the same branch: word, parameters, points, multipliers and ends."""
        if not isinstance(other, Branch):
            return NotImplemented
        return self.as_dict() == other.as_dict()

    def __hash__(self) -> int:
        return hash((self._orbit.parameters, self.word, self.parameter, len(self.values)))

    def __repr__(self) -> str:
        ends = ", ".join(f"{end.kind} at {end.value:.8g}" for end in self.ends)
        return f"<Branch of {self.word} in {self.parameter}, {len(self.values)} points: {ends}>"


def times_of(parameters: Parameters, name: str, point: BranchPoint) -> np.ndarray:
    """Return the (n, 2) array of (t, x) of a point."""
    Omega = point.value if name == "Omega" else float(parameters.Omega)
    return np.column_stack([point.points[:, 1] / Omega, point.points[:, 0]])
