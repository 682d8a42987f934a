"""Branches of periodic orbits: pseudo-arclength continuation, and why a branch ends.

The closing equations plus one for the arclength are solved by Newton's method from a point on the
tangent. No general package is used. These branches end at inequalities (a graze, the birth of a
stick), which continuation codes for smooth systems do not know. The smooth part is Newton's method
on a small block system, which is there already.

The equations stay smooth where an orbit ceases to be one (the root goes on as an inadmissible one).
So every reason to end is a change of sign of a smooth function along the branch. A step is accepted
if the point halfway is where the cubic of its two ends says, and if no margin can reach 0 between
them. Otherwise it is halved. So a gap in a branch is found however narrow it is compared with the
steps, and its end is located by the same halving. Multipliers need no test: no multiplier of an
orbit is larger than 1 (`symosc.orbits.floquet`), so there are no folds, period doublings or
Neimark-Sacker bifurcations.

That nothing fails between two points of a branch: every margin is bounded there, not only compared
at its ends.

A flight of duration tau stays in its domain exactly if tau > 0 and, for each boundary of the
domain,

    q(u) = +-(v - v_lambda)/(time^j (1 - u)^e) > 0 on the whole of [0, 1].

Here time counts from its start, and u = time/tau. The known roots at its start are j (0 off the
boundary, 1 on it, 2 after a stick), those at its end e. A stick has F/((1 - u) tau) for the force
that ends it, and for the other force its distance from 0. These functions are smooth in u and along
the branch, ends included: q(0) and q(1) are accelerations. All other conditions are smooth numbers.

Three points of the branch and two on its cubic between them cut a piece of it into four. Take a
cell with the margins f0, f1 > 0 at its ends, and C = h^2 max|f''|/2. At the part r of the cell the
margin is at least (1 - r) f0 + r f1 - C r (1 - r). That is positive for all r in [0, 1] if and only
if

    sqrt(f0) + sqrt(f1) > sqrt(C).

h^2 f'' is taken from the second differences of the five values, times MARGIN_SAFETY. The bound
holds as long as a margin's second derivative is nowhere larger than MARGIN_SAFETY times its largest
value at the inner points (for the functions of u, also at the neighbouring u). Where it does not
suffice the piece is halved. It is a bound in this sense, not in the sense of interval arithmetic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import DataFrame, NumberLike, Points, Progress, Record
from symosc.base.arguments import (
    NUMBER,
    PROGRESS,
    TABLE_LIKE,
    TEXT,
    WHOLE,
    WORD,
    public,
    require,
    require_or_none,
    row_of,
)
from symosc.base.display.drawable import Drawable, Listing
from symosc.base.display.frames import imported
from symosc.base.display.progress import Advance, late_bar
from symosc.base.errors import ParameterError, SymoscError, meant
from symosc.base.exact import read_exact, show, whole_number
from symosc.engine.arithmetic import column_functions
from symosc.engine.flow import derivatives
from symosc.kernels import linear
from symosc.kernels._generated import motion
from symosc.kernels.entire import EPS
from symosc.model import PARAMETER_NAMES, Model, Parameters, some
from symosc.orbits import admissibility
from symosc.orbits.admissibility import (
    MARGINAL,
    SAMPLE,
    Condition,
    concerns_whole_piece,
    conditions,
    failing,
    failures,
)
from symosc.orbits.closing_equations import CONVERGING, ClosingEquations, solve
from symosc.orbits.find import (
    find_orbit,
    is_of_paper,
    largest_displacement,
    settling,
    switching_points,
)
from symosc.orbits.floquet import NEAR_ONE, multipliers_of
from symosc.orbits.followed_orbit import FollowedOrbit, is_undamped
from symosc.orbits.law_branch import end_of
from symosc.orbits.law_curve import CurvePoint, LawCurve
from symosc.orbits.periodic_orbit import PeriodicOrbit, SwitchingPoint
from symosc.orbits.shooting import orbit_near
from symosc.scenes import ParametersLike, belts_of, model_of
from symosc.words import WordLike, read_word

RANGE = "end of the range"
NO_CONVERGENCE = "no convergence"
MOST = "max_points"
# Positions are measured by the extent of the orbit, or by this part of the largest displacement.
LEAST_EXTENT = 0.1
# Lengths of steps, in the arclength of (x/size, phase, parameter/range).
FIRST_STEP = 0.02
LONGEST_STEP = 0.04
SHORTEST_STEP = 1e-10
# of the arclength, to which ends are located; closer by, rounding would decide what has happened
RESOLUTION = 1e-12
NO_GAP = 1e-7  # nearer to a change a gap before it cannot be seen, and nothing is proven on the way
# On a shorter piece a margin that cannot be bounded away from 0 touches it, unless the shortest
# stretch around it that ends at no orbit is no longer than BESIDE_CHANGE: there it is rounding.
SHORTEST_PROOF = 1e-9
BESIDE_CHANGE = 1e-4
MARGIN_SAFETY = 4.0
FEWEST_PARTS = 12
MOST_PARTS = 800
# A step is refused if the tangent turns by more than what this cosine says, or if the point halfway
# is farther from the cubic than this part of the chord.
LEAST_COSINE = 0.9
OFF_CUBIC = 1e-2
GROWTH = 1.5
# Newton's steps of a correction, at most, and the largest one, in arclength: farther off another
# root is found.
MOST_CORRECTIONS = 12
LONGEST_CORRECTION = 1.0
# The change of the parameter, as a part of its range, in the finite differences of the residuals:
# Newton's method needs no better ones.
DIFFERENCE = 1e-6
# Equations that are kept for further use.
MOST_KEPT = 32
# A first orbit with a margin below this part of its terms is at an end, and an orbit beside it is
# looked for at these arclengths.
AT_END = 1e-6
BESIDE_END = (1e-6, 1e-5, 1e-4)
# Which margins vanish at an end is seen from a point that is at least this far before it: those that
# have fallen to the first part of what they were there, or to the second one if doubles cannot
# decide on which side of 0 any of them is.
BEFORE_END = 1e-3
FALLEN = 1e-5
FALLEN_IF_UNDECIDED = 1e-3
# Distances beyond an end, as parts of the range, at which an orbit is looked for: the nearest counts.
BEYOND_END = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5)
# How often more is gone back, each time four times as far, to an orbit that more digits confirm.
MOST_BACK = 12
# Into how many each part of a piece is refined, and how often at most.
FINER = 8
DEEPEST = 30
# Samples of an orbit for the extent of its positions.
EXTENT_SAMPLES = 513
# Where mu FN differs from |B0| by less than this part flights are too short for steps.
BEGINS_TO_REST = 1e-6


class BranchError(SymoscError, ValueError):
    """Raised if a branch cannot be started because its first root is not an orbit.

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

    def __init__(self, orbit: PeriodicOrbit, hint: str = "") -> None:
        self.orbit = orbit
        if orbit.word:
            text = f"the branch of {orbit.word} has no first orbit: {orbit.message}"
        else:
            text = f"the branch has no first orbit: the motion settles to {orbit.message}"
        super().__init__(text + hint)


class BranchEnd(NamedTuple):
    """Location and reason of a branch's end.

    Attributes
    ----------
    kind : str
        "grazing", "birth of a stick", "vanishing of a stick", "birth of a slip", "vanishing of a
        slip", "vanishing of a flight", "end of the range", "no convergence" or "max_points". Under
        other laws than the paper's also "onset at a corner" and "closed curve".
    value : float
        The last value of the parameter with an orbit, as far as doubles resolve it.
    message : str
        Which inequality fails at the end, and when in the orbit.
    points : tuple of SwitchingPoint
        The switching points of the orbit at the end.
    conditions : tuple of Condition
        The inequalities whose values pass 0 at the end; the first one explains the others.
    beyond : str or None
        The word of the orbit just beyond the end: one was found and verified there, as near as 1e-9
        of the range. None at the end of the range, where the motion has no word (the message says
        what it does), or if none was found.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> end = branch.ends[0]
    >>> end.kind, f"{end.value:.6f}", end.beyond
    ('birth of a stick', '3.288576', 'P321')
    """

    kind: str
    value: float
    message: str
    points: tuple[SwitchingPoint, ...]
    conditions: tuple[Condition, ...]
    beyond: str | None = None


class BranchSpecial(NamedTuple):
    """A place on a branch where a multiplier passes the unit circle.

    Attributes
    ----------
    kind : str
        "fold" (multiplier 1; the parameter turns back), "period doubling" (-1) or "Neimark-Sacker"
        (a complex pair).
    value : float
        The parameter there.
    start : tuple of t, x, v
        A state on the orbit there, in a flight.
    span : float
        Its period.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, continue_orbit
    >>> p = Oscillator(
    ...     m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s=1)]
    ... )
    >>> branch = continue_orbit(p, "S1 B1", "mu_s1", (1, "1.1"))
    >>> [(place.kind, f"{place.value:.9f}") for place in branch.special]
    [('period doubling', '1.075688088')]
    """

    kind: str
    value: float
    start: tuple[float, float, float]
    span: float


class BranchColumns(NamedTuple):
    """The orbits of a branch as columns, as `Branch` has them.

    `extents` are the least and largest positions (under the law of the paper, of the switchings), and
    `starts` states (t, x, v) on the orbits, None under the law of the paper.
    """

    values: np.ndarray
    points: np.ndarray
    spans: np.ndarray
    multipliers: np.ndarray
    stable: np.ndarray
    extents: np.ndarray
    starts: np.ndarray | None = None


def columns_of_paper(
    orbit: PeriodicOrbit, parameter: str, path: list[BranchPoint]
) -> BranchColumns:
    """Return the columns of a branch under the law of the paper."""
    values = np.array([point.value for point in path])
    if parameter == "Omega":
        Omega = values
    else:
        Omega = np.full(len(path), float(orbit.parameters.Omega))
    x, theta = np.moveaxis(np.array([point.points for point in path]), -1, 0)
    points = np.stack([theta / Omega[:, None], x], axis=-1)
    multipliers = np.array([point.multipliers for point in path])
    damping = [orbit.parameters.replace(**{parameter: float(value)}).c > 0 for value in values]
    stable = np.array(damping) | (np.abs(multipliers).max(axis=1) < 1 - NEAR_ONE)
    spans = 2 * pi * orbit.periods / Omega
    extents = np.stack([x.min(axis=1), x.max(axis=1)], axis=1)
    return BranchColumns(values, points, spans, multipliers, stable, extents)


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
        True where damping proves it, or the multipliers that decide are clearly inside the unit
        circle (`symosc.orbits.floquet`).
    spans : (m,) array
        The period of each orbit.
    extents : (m, 2) array
        The least and the largest position; under the law of the paper, of the switching points.
    periods : int
        Number of forcing periods; 0 without a drive.
    special : sequence of BranchSpecial
        Folds, period doublings and Neimark-Sacker points, along the branch. Under the law of the
        paper there are none.
    ends : tuple of two BranchEnd
        Why the branch ends at its first and its last point.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.9, 4.1))
    >>> branch.labels, bool(branch.stable.all())
    (('P2', 'P3'), True)
    """

    _drawn_by = "branch_figure"
    _made_by = "continue_orbit(...)"

    def __init__(
        self,
        orbit: PeriodicOrbit,
        parameter: str,
        columns: BranchColumns,
        ends: tuple[BranchEnd, BranchEnd],
        special: Sequence[BranchSpecial] = (),
    ) -> None:
        self._orbit = orbit
        self._starts = columns.starts
        self.extents = columns.extents
        self.word = orbit.word
        self.labels = orbit.labels
        self.periods = orbit.periods
        self.parameter = parameter
        self.ends = ends
        self.special = Listing(special)
        self.values = columns.values
        self.points = columns.points
        self.spans = columns.spans
        self.multipliers = columns.multipliers
        self.stable = columns.stable

    @public
    def parameters(self, i: int) -> Model:
        """Return the parameters of the branch's i-th point; -1 is the last one, as for a list."""
        i = whole_number("i", i, -len(self.values), len(self.values) - 1)
        return self._orbit.parameters.replace(**{self.parameter: float(self.values[i])})

    @public
    def orbit(self, i: int, digits: int | None = None) -> PeriodicOrbit:
        """Return the orbit at the branch's i-th point; `digits` as for `symosc.find_orbit`."""
        require(WHOLE, i=i)
        require_or_none(WHOLE, digits=digits)
        if self._starts is not None:
            t, x, v = self._starts[int(i)].tolist()
            return orbit_near(self.parameters(i), t, x, v, self.periods or None, digits)
        return find_orbit(
            self.parameters(i), self.word, self.points[int(i)], digits, periods=self.periods
        )

    def as_dict(self) -> Record:
        """Return the branch as a dict of plain values: numbers, text and lists."""
        ends = [end._asdict() for end in self.ends]
        for end in ends:
            end["points"] = [list(point) for point in end["points"]]
            end["conditions"] = [c._asdict() for c in end["conditions"]]
        return {
            "word": self.word,
            "parameters": self._orbit.parameters.as_dict(),
            "parameter": self.parameter,
            "periods": self.periods,
            "values": self.values.tolist(),
            "points": self.points.tolist(),
            "multipliers": [
                [[value.real, value.imag] for value in pair] for pair in self.multipliers.tolist()
            ],
            "stable": self.stable.tolist(),
            "ends": ends,
        } | self._of_any_law()

    def _of_any_law(self) -> Record:
        """Return as plain values what only branches of other laws than the paper's have."""
        if self._starts is None:
            return {}
        return {
            "spans": self.spans.tolist(),
            "extents": self.extents.tolist(),
            "starts": self._starts.tolist(),
            "special": [place._asdict() for place in self.special],
        }

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per point of the branch.

        MissingExtraError if pandas is not installed.
        """
        columns = {self.parameter: self.values}
        for i in range(self.points.shape[1]):
            columns |= {f"t{i}": self.points[:, i, 0], f"x{i}": self.points[:, i, 1]}
        columns |= {f"multiplier{i}": self.multipliers[:, i] for i in (0, 1)}
        return imported("pandas").DataFrame(columns | {"stable": self.stable})

    def to_xarray(self) -> Any:
        """Return a Dataset over `point`, `switching` and `which` (multiplier).

        MissingExtraError without xarray.
        """
        columns: Record = {
            name: (("point", "switching"), self.points[..., i]) for i, name in enumerate(("t", "x"))
        }
        # No file format has complex numbers.
        for name, part in (("re", self.multipliers.real), ("im", self.multipliers.imag)):
            columns[f"multiplier_{name}"] = (("point", "which"), part)
        columns["stable"] = ("point",), self.stable
        coordinates = {
            self.parameter: ("point", self.values),
            "map": ("switching", list(self.labels)),
        }
        about = {
            "word": self.word,
            "periods": self.periods,
            "ends": [end.kind for end in self.ends],
        }
        return imported("xarray").Dataset(columns, coords=coordinates, attrs=about)

    def __eq__(self, other: object) -> bool:
        """Whether both are the same branch: word, parameters, points, multipliers and ends."""
        if not isinstance(other, Branch):
            return NotImplemented
        return self.as_dict() == other.as_dict()

    def __hash__(self) -> int:
        return hash((self._orbit.parameters, self.word, self.parameter, len(self.values)))

    def __repr__(self) -> str:
        ends = ", ".join(f"{end.kind} at {end.value:.8g}" for end in self.ends)
        return f"<Branch of {self.word or 'no belt'} in {self.parameter}, {len(self.values)} points: {ends}>"


@public
def continue_orbit(
    parameters: ParametersLike,
    word: WordLike | None,
    parameter: str,
    range: tuple[NumberLike, NumberLike],
    guess: PeriodicOrbit | ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    *,
    periods: int | None = None,
    max_points: int = 2000,
    progress: Progress = False,
) -> Branch:
    """Follow a periodic orbit as one parameter changes, both ways, until it ends or leaves the
    range.

    Parameters
    ----------
    parameters : Parameters or Oscillator, or a Scene, its name or its file
        The point at which the branch is begun, with any friction law; its value of the parameter
        must lie in the range.
    word : str or sequence of str, or None
        The mapping structure, read right to left. None under another law than the paper's: that of
        the `guess`, or of the orbit that the motion from rest settles to; so are cycles followed
        that meet no belt.
    parameter : str
        "Omega", "A0", "FN", ...: any name of Parameters; under another law any name of its numbers,
        such as mu_s1, w1_1, slope1.
    range : (low, high)
        The range of the parameter, such as (3, 5), with its value at the beginning in it.
    guess, periods : optional
        As for `find_orbit`.
    max_points : int
        The most points in each of the two directions, at least 2.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a
        function of two numbers: the part of the range that is done, and 1.

    Returns
    -------
    Branch
        Under another law than the paper's it goes through folds, and has stable and unstable parts.
        It ends where the word changes, where the orbit is lost (with static friction at a graze),
        or where a cycle shrinks to a rest ("onset at a corner"). Ends are located to 1e-12 of the
        range.

    Raises
    ------
    WordError, ConvergenceError
        As raised by `find_orbit`.
    ParameterError
        If there is no such parameter, or the range is empty, not allowed or does not contain the
        parameter's value.
    BranchError
        If the first root is not an orbit.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> [end.kind for end in branch.ends]
    ['birth of a stick', 'end of the range']
    """
    model = model_of(parameters, "parameters")
    require_or_none(WORD, word=word)
    require(TEXT, parameter=parameter)
    require(row_of(2, NUMBER), range=range)
    require_or_none(PeriodicOrbit, *TABLE_LIKE, guess=guess)
    require_or_none(WHOLE, periods=periods)
    require(*PROGRESS, progress=progress)
    if not is_of_paper(model) or isinstance(guess, FollowedOrbit):
        most = whole_number("max_points", max_points, 2)
        return _branch_of_law(model, word, parameter, range, guess, periods, most, progress)
    if word is None:
        raise ParameterError("word", None, "a word is required under the law of two Coulomb belts")
    model = belts_of(parameters, "parameters")
    read_word(word)
    low, high = read_range(model, parameter, range)
    orbit = find_orbit(model, word, guess, periods=periods)
    if not orbit.admissible:
        raise BranchError(orbit)
    curve = Curve(orbit, parameter, low, high)
    most = whole_number("max_points", max_points, 2)
    with late_bar(progress, f"{orbit.word} over {parameter}", "orbits") as advance:
        down, first = curve.follow(-1.0, most, advance)
        up, last = curve.follow(1.0, most, advance, len(down))
    path = [*reversed(down[1:]), *up]
    return Branch(orbit, parameter, columns_of_paper(orbit, parameter, path), (first, last))


def _branch_of_law(
    model: Model,
    word: WordLike | None,
    parameter: str,
    limits: tuple[NumberLike, NumberLike],
    guess: Any,
    periods: int | None,
    most: int,
    progress: Progress,
) -> Branch:
    """Return the branch of an orbit under any law, with both its ends."""
    low, high = read_range(model, parameter, limits, tuple(model.numbers()))
    if guess is None and word is None:
        orbit = find_orbit(model)
    elif isinstance(guess, FollowedOrbit) and guess.parameters == model:
        orbit = guess
    else:
        orbit = find_orbit(model, word, guess, periods=periods)
    if not isinstance(orbit, FollowedOrbit):
        raise BranchError(orbit)
    if orbit.motion is None:
        raise BranchError(orbit, "; give a guess (t, x, v) near a cycle")
    if not orbit.labels and is_undamped(orbit.motion):
        raise BranchError(orbit, "; it is one of a family, and others lie beside it")
    name = orbit.word or "an orbit without a belt"
    with late_bar(progress, f"{name} over {parameter}", "orbits") as advance:
        ways = []
        for direction in (-1.0, 1.0):
            curve = LawCurve(orbit, parameter, low, high)
            path, events, end = curve.follow(direction, most, advance)
            if not path:
                raise BranchError(orbit, f"; it cannot be followed over {parameter} from here")
            ways.append((path, events, end_of(curve, path, end)))
            if end.why == "closed":
                break
    if len(ways) == 1:
        ways.append((ways[0][0][:1], [], ways[0][2]))
    (down, before, first), (up, after, last) = ways
    path = [*reversed(down[1:]), *up]
    ends = tuple(
        BranchEnd(
            end.kind, end.value, end.message, way[-1].orbit.points, end.conditions, end.beyond
        )
        for way, end in ((down, first), (up, last))
    )
    special = [
        BranchSpecial(
            event.kind,
            event.value,
            (event.point.t, event.point.x, float(event.point.section.speed)),
            event.point.span,
        )
        for event in [*reversed(before), *after]
    ]
    return Branch(orbit, parameter, _columns_of_law(path), (ends[0], ends[1]), special)


def _columns_of_law(path: list[CurvePoint]) -> BranchColumns:
    """Return the columns of a branch under any law."""
    orbits = [point.orbit for point in path]
    points = np.array([orbit.points for orbit in orbits], dtype=float)
    starts = [(point.t, point.x, float(point.section.speed)) for point in path]
    return BranchColumns(
        np.array([point.value for point in path]),
        points.reshape(len(path), -1, 2),
        np.array([point.span for point in path]),
        np.array([orbit.multipliers for orbit in orbits], dtype=complex),
        np.array([orbit.stable is True for orbit in orbits]),
        np.array([_extent(orbit) for orbit in orbits]),
        np.array(starts),
    )


def _extent(orbit: FollowedOrbit) -> tuple[float, float]:
    """Return the least and the largest position of an orbit, from samples."""
    begin = float(orbit.start[0])
    x, _ = orbit(np.linspace(begin, begin + float(orbit.period), EXTENT_SAMPLES))
    return float(x.min()), float(x.max())


def read_range(
    parameters: Model,
    parameter: str,
    limits: tuple[NumberLike, NumberLike] | None,
    known: Sequence[str] = PARAMETER_NAMES,
) -> tuple[float, float]:
    """Check the name `parameter`, one of those `known`, and the range `limits`; return the limits as
    floats.
    """
    names = [name for name in known if name in parameters.numbers()]
    if parameter not in names:
        allowed = f"must be one of {some(names)}"
        raise ParameterError("parameter", parameter, allowed + meant(parameter, names))
    if limits is None:
        raise ParameterError("range", limits, "must be a pair (low, high)")
    low, high = (read_exact("range", limit) for limit in limits)
    value = parameters.numbers()[parameter]
    if not low < high or not low <= value <= high:
        allowed = f"must be low < high, with the value {parameter} = {show(value)} in between"
        raise ParameterError("range", f"{show(low)}:{show(high)}", allowed)
    for limit in (low, high):
        parameters.replace(**{parameter: limit})
    return float(low), float(high)


# -- along the curve -------------------------------------------------------------------------------


@dataclass(frozen=True)
class BranchPoint:
    """An orbit of a branch at one `value` of the parameter, with its scaled unknowns `z` and
    tangent on the `Curve`.
    """

    value: float
    points: np.ndarray
    z: np.ndarray
    tangent: np.ndarray
    multipliers: tuple[complex, complex]
    conditions: tuple[Condition, ...]
    failures: tuple[Condition, ...]


class Scanned(NamedTuple):
    """A stretch of a branch: its orbits in order, and the point after them that is none, if any."""

    orbits: list[BranchPoint]
    failed: BranchPoint | None


class Curve:
    """The curve of roots of the closing equations over one parameter, in the scaled unknowns z.

    These are, weighted, x and theta of each switching point and the parameter; x is divided by the
    size of the motion, the parameter by its range.
    """

    # Arclength measures positions from their mean: a shift of the whole orbit, such as by A0/k,
    # changes nothing else and needs no steps. So lengths and angles are those of `level(z)`.

    def __init__(self, orbit: PeriodicOrbit, parameter: str, low: float, high: float) -> None:
        self.orbit = orbit
        self.parameter = parameter
        self.low = low
        self.high = high
        self.word = orbit.equations().word
        self.start = orbit.phases()
        self.value = float(orbit.parameters.numbers()[parameter])
        n = len(self.start)
        # Switching points may lie close together on an orbit that moves far.
        positions, _ = self.start.T
        _, largest = largest_displacement(orbit.equations())
        size = max(np.ptp(positions), LEAST_EXTENT * largest)
        # The points together weigh as much as the parameter.
        self.scale = np.append(np.tile([size, 1.0], n) * np.sqrt(n), high - low)
        self._equations: dict[float, ClosingEquations] = {}
        self._far = self._out_of_reach()

    def _out_of_reach(self) -> Fraction | None:
        """Return the speed of a second belt that no orbit of the branch meets; None if the
        oscillator has two.

        `Model.parameters` takes it farther away by leaps, which no curve can follow.
        """
        p = self.orbit.parameters
        if len(p.law.belts) > 1:
            return None
        values = self.low, self.value, self.high
        return max(p.replace(**{self.parameter: value}).parameters.v2 for value in values)

    # -- one point ---------------------------------------------------------------------------------

    def equations(self, value: float) -> ClosingEquations:
        """Return the closing equations for a value of the parameter."""
        if value not in self._equations:
            while len(self._equations) >= MOST_KEPT:  # the oldest goes
                del self._equations[next(iter(self._equations))]
            model = self.orbit.parameters.replace(**{self.parameter: value})
            parameters = model.parameters
            if self._far is not None:
                parameters = parameters.replace(v2=self._far)
            self._equations[value] = ClosingEquations(parameters, self.word, self.orbit.periods)
        return self._equations[value]

    def split(self, z: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the switching points (n, 2) and the parameter that belong to the scaled unknowns
        z.
        """
        unscaled = z * self.scale
        # An end of the range stays what it is: the product may miss it by an ulp.
        value = float(unscaled[-1])
        for bound in (self.low, self.high):
            if abs(value - bound) <= 4 * EPS * abs(bound):
                value = bound
        return unscaled[:-1].reshape(-1, 2), value

    def joined(self, points: np.ndarray, value: float) -> np.ndarray:
        """Return the scaled unknowns z for switching points (n, 2) and a value of the parameter."""
        return np.append(np.ravel(points), value) / self.scale

    @staticmethod
    def level(z: np.ndarray) -> np.ndarray:
        """Return z with positions counted from their mean: a shift of the whole orbit then has
        length 0.
        """
        levelled = z.copy()
        positions = levelled[:-1:2]  # a view: every second unknown but for the parameter at the end
        positions -= positions.mean()
        return levelled

    def distance(self, a: BranchPoint, b: BranchPoint) -> float:
        """Return the length of the chord between two points of the branch, in scaled unknowns."""
        return linear.norm(self.level(b.z - a.z))

    def slope(self, z: np.ndarray) -> np.ndarray:
        """Return the derivatives of the closing equations' residuals by the parameter, as finite
        differences.
        """
        points, value = self.split(z)
        change = DIFFERENCE * (self.high - self.low)
        # One-sided at the ends of the range: there may be no such system beyond.
        if value + change <= self.high:
            above = change
        else:
            above = 0.0
        if value - change >= self.low:
            below = change
        else:
            below = 0.0
        residuals_above, residuals_below = (
            np.array(self.equations(value + shift).residuals(points)) for shift in (above, -below)
        )
        return (residuals_above - residuals_below) / (above + below)

    def matrix(self, z: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Return the Jacobian (2n, 2n + 1) of the residuals by the scaled unknowns.

        `slope` comes from `slope(z)`.
        """
        points, value = self.split(z)
        return np.column_stack([self.equations(value).matrix(points), slope]) * self.scale

    def correct(self, guess: np.ndarray, normal: np.ndarray) -> np.ndarray | None:
        """Return the curve's point in the hyperplane through `guess` with that normal; None if it
        is not found.
        """
        z = guess
        before = np.inf
        row = self.level(normal)
        slope = None
        for _ in range(MOST_CORRECTIONS):
            try:
                # The first slope is good enough for all steps from a near guess.
                if slope is None:
                    slope = self.slope(z)
                points, value = self.split(z)
                residuals = np.array(self.equations(value).residuals(points))
                right = np.append(-residuals, -linear.dot(row, z - guess))
                step = linear.solve(np.vstack([self.matrix(z, slope), row]), right)
            except (ParameterError, ZeroDivisionError):
                return None
            size = np.abs(self.level(step)).max()
            largest = max(1.0, np.abs(z).max())
            if not np.isfinite(size) or size > LONGEST_CORRECTION:
                return None
            z = z + step
            if size <= 4 * EPS * largest or (size < CONVERGING and size > before / 4):
                return z
            before = size
        if size < CONVERGING:
            return z
        return None

    def point(self, z: np.ndarray, along: np.ndarray) -> BranchPoint:
        """Return the branch point at z; its tangent is oriented like `along`."""
        points, value = self.split(z)
        equations = self.equations(value)
        z = self.joined(points, value)
        matrix = np.vstack([self.matrix(z, self.slope(z)), self.level(along)])
        tangent = linear.solve(matrix, np.append(np.zeros(len(z) - 1), 1.0))
        tangent /= linear.norm(self.level(tangent))
        first, second = map(complex, multipliers_of(equations, points))
        margins = conditions(equations, points)
        return BranchPoint(
            value, points, z, tangent, (first, second), tuple(margins), tuple(failing(margins))
        )

    def accepted(self, z: np.ndarray | None, before: BranchPoint) -> BranchPoint | None:
        """Return the branch point at z; None if z is None or singular, or if the curve turns
        sharply after `before`.
        """
        if z is None:
            return None
        try:
            point = self.point(z, before.tangent)
        except (ParameterError, ZeroDivisionError):
            return None
        if linear.dot(point.tangent, self.level(before.tangent)) > LEAST_COSINE:
            return point
        return None

    def step(self, current: BranchPoint, length: float) -> BranchPoint | None:
        """Return the curve's point `length` further on, or at the end of the range if nearer; None
        if not found.
        """
        ahead = current.z + length * current.tangent
        _, value = self.split(ahead)
        if self.low < value < self.high:
            point = self.accepted(self.correct(ahead, current.tangent), current)
            if point is None or self.low <= point.value <= self.high:
                return point
            # The curve bends over the end of the range.
            ahead = point.z
            value = point.value
        if value >= self.high:
            value = self.high
        else:
            value = self.low
        # Where the chord from the current point reaches the end of the range.
        value_ahead = ahead[-1] * self.scale[-1]
        fraction = (value - current.value) / (value_ahead - current.value)
        guess, _ = self.split(current.z + fraction * (ahead - current.z))
        solution = solve(self.equations(value), guess)
        if solution.converged:
            return self.accepted(self.joined(solution.points, value), current)
        return None

    def halfway(self, a: BranchPoint, b: BranchPoint) -> np.ndarray:
        """Return the midpoint of the cubic through a and b with their tangents (Hermite's), which is
        near the curve.
        """
        return 0.5 * (a.z + b.z) + 0.125 * self.distance(a, b) * (a.tangent - b.tangent)

    def middle(self, a: BranchPoint, b: BranchPoint) -> BranchPoint | None:
        """Return the point of the curve midway between two of its points; None if it is not found."""
        return self.accepted(self.correct(self.halfway(a, b), b.z - a.z), a)

    # -- all points --------------------------------------------------------------------------------

    def follow(
        self, direction: float, most: int, advance: Advance, before: int = 0
    ) -> tuple[list[BranchPoint], BranchEnd]:
        """Follow the curve from the first orbit to its end or for `most` points.

        Return its points and the end.

        `advance` reports the progress; `before` is the number of points found in the other
        direction.
        """
        z = self.joined(self.start, self.value)
        length = FIRST_STEP
        reached = 0.0  # the farthest from the first value, for `advance`
        path = [self.point(z, np.append(np.zeros(len(z) - 1), direction))]
        beside = self._beside_an_end(path[0])
        if beside is not None:
            path.append(beside)
        # The other way is done, wherever it ended.
        if before:
            done = self.value - self.low
        else:
            done = 0.0

        def end(
            kind: str, message: str, *conditions: Condition
        ) -> tuple[list[BranchPoint], BranchEnd]:
            """Return the path and its end at the last point."""
            return path, BranchEnd(
                kind, path[-1].value, message, self._switchings(path[-1]), conditions
            )

        while True:
            current = path[-1]
            if current.value == (self.high if direction > 0 else self.low):
                return end(RANGE, "the orbit goes on")
            following = self.step(current, length)
            if following is None:
                scanned = None
            else:
                scanned = self._scan(current, following)
            if scanned is None:
                length /= 2
                if length >= SHORTEST_STEP:
                    continue
                return end(*self._reason_of_short_steps(current))
            path += scanned.orbits
            reached = max(reached, abs(path[-1].value - self.value))
            if advance:
                advance(min(1.0, (done + reached) / (self.high - self.low)), before + len(path))
            if len(path) > most:
                del path[most:]
                return end(MOST, f"stopped after {most} points")
            if scanned.failed is not None:
                return path, self._end_at(path, scanned.failed, direction)
            length = min(GROWTH * length, LONGEST_STEP)

    def _reason_of_short_steps(self, last: BranchPoint) -> tuple[str, str, Condition]:
        """Return why no step leads on from the last point: kind and message of the end, and the
        condition that is nearest to failing.
        """
        nearest = min(last.conditions, key=lambda condition: condition.value)
        belt = _begins_to_rest(self.equations(last.value).parameters)
        if belt is not None:
            message = (
                f"the flights vanish at mu{belt} FN = |B0|; beyond it the mass may rest on "
                f"belt {belt} for ever"
            )
            return admissibility.FLIGHT_VANISHING, message, nearest
        message = (
            f"the steps became too short; nearest to failing: {nearest.text} (by "
            f"{nearest.value:.3g})"
        )
        return NO_CONVERGENCE, message, nearest

    def _beside_an_end(self, first: BranchPoint) -> BranchPoint | None:
        """Return an orbit just after the first one if that is at an end, where margins are rounding
        noise; else None. Between the two nothing is proven.
        """
        if all(condition.value > AT_END * condition.scale for condition in first.conditions):
            return None
        for shift in BESIDE_END:
            point = self.step(first, shift)
            if point and not point.failures and not self._verified(point).failures:
                return point
        return None

    def _scan(self, a: BranchPoint, b: BranchPoint, around: float = np.inf) -> Scanned | None:
        """Search the stretch from a to b for a point that is no orbit; None if the points do not
        lie on one smooth curve: a shorter step is needed.

        `around` is the length of the shortest known stretch around a and b that ends at no orbit.
        """
        length = self.distance(a, b)
        changed = bool(b.failures)
        if changed:
            around = min(around, length)
        if changed and length < NO_GAP:
            return self._bisected(a, b)
        m = self.middle(a, b)
        if m is None:
            return None
        off = self.level(m.z - self.halfway(a, b))
        along = self.level(m.tangent)
        across = linear.norm(off - linear.dot(off, along) * along)
        if across > OFF_CUBIC * length + RESOLUTION:
            return None
        if not changed and not m.failures:
            if self._proven(a, m, b):
                b = self._verified(b)  # and so is m: between two orbits nothing has changed
                if not b.failures:
                    return Scanned([m, b], None)
            elif length < SHORTEST_PROOF:
                if around <= BESIDE_CHANGE:
                    return Scanned([m], None)
                # A margin is so small that doubles cannot tell whether it passes 0.
                smallest = min(m.conditions, key=lambda c: c.value / c.scale)
                return Scanned([], replace(m, failures=(smallest,)))
        first = self._scan(a, m, around)
        if first is None or first.failed is not None:
            return first
        second = self._scan(first.orbits[-1], b, around)
        if second is None:
            return None
        return Scanned(first.orbits + second.orbits, second.failed)

    def _bisected(self, good: BranchPoint, bad: BranchPoint) -> Scanned:
        """Return the last orbit before `bad`, if it is not `good`, and the first point that is
        none.
        """
        orbits = list[BranchPoint]()
        while self.distance(good, bad) > RESOLUTION:
            middle = self.middle(good, bad)
            if middle is None:
                break
            if middle.failures:
                bad = middle
            else:
                good = middle
                orbits = [good]
        return Scanned(orbits, bad)

    def _proven(self, a: BranchPoint, m: BranchPoint, b: BranchPoint) -> bool:
        """Return whether no margin can reach 0 between the points a and b of the branch.

        The point m lies halfway.
        """
        # Five points: the three, and two on the cubics between them.
        points_am, value_am = self.split(self.halfway(a, m))
        points_mb, value_mb = self.split(self.halfway(m, b))
        at_am = (self.equations(value_am), points_am)
        at_mb = (self.equations(value_mb), points_mb)
        at_a, at_m, at_b = ((self.equations(node.value), node.points) for node in (a, m, b))
        nodes = [at_a, at_am, at_m, at_mb, at_b]
        margins = [
            a.conditions,
            conditions(*at_am),
            m.conditions,
            conditions(*at_mb),
            b.conditions,
        ]
        # The margins that are smooth numbers; those of whole pieces are functions of u.
        values = np.array(
            [[c.value for c in row if not concerns_whole_piece(c)] for row in margins]
        )
        if not _proven_positive(values).all():
            return False
        equations, _ = at_m
        spans = equations.spans(m.points)
        rate = equations.K.rate
        parts = [min(MOST_PARTS, max(FEWEST_PARTS, span.tau * rate / SAMPLE)) for span in spans]
        counts = [1 + int(part) for part in parts]
        return all(
            _stay_positive(nodes, i, np.linspace(0.0, 1.0, count), DEEPEST)
            for i, count in enumerate(counts)
        )

    def _verified(self, point: BranchPoint) -> BranchPoint:
        """Return the point with its failing conditions decided anew, with more digits and by
        following the orbit.
        """
        return replace(point, failures=tuple(failures(self.equations(point.value), point.points)))

    # -- the end -----------------------------------------------------------------------------------

    def _end_at(self, path: list[BranchPoint], failed: BranchPoint, direction: float) -> BranchEnd:
        """Return the end of the branch before the point `failed`, and replace the last point of
        `path` by a sure orbit.
        """
        # Margins are compared with those at a point that is far enough before the end.
        before = next(
            (point for point in reversed(path) if self.distance(point, failed) > BEFORE_END),
            path[0],
        )
        # A margin counts as 0 if it has fallen to this part, or if doubles cannot decide on which
        # side of 0 it is.
        if any(condition.value > 0 for condition in failed.failures):
            part = FALLEN_IF_UNDECIDED
        else:
            part = FALLEN
        vanished = list[Condition]()
        for earlier, condition in zip(before.conditions, failed.conditions, strict=True):
            fallen = part * min(earlier.value, 1e300)  # a margin without an extremum is inf
            limit = max(fallen, MARGINAL * condition.scale)
            if condition.value < limit:
                vanished.append(condition)
        vanished = sorted(vanished, key=lambda condition: condition.rank) or list(failed.failures)
        event = vanished[0].event
        reasons = tuple(condition for condition in vanished if condition.event == event)
        message = "; ".join(f"the condition '{c.text}' fails at t = {c.t:.10g}" for c in reasons)
        last = self._inside(path[-1])
        path[-1] = last
        outward = float(np.sign(failed.value - before.value)) or direction
        word, instead = self._word_beyond(last, outward)
        if instead:
            message += f"; beyond it {instead}"
        return BranchEnd(event, last.value, message, self._switchings(last), reasons, word)

    def _inside(self, last: BranchPoint) -> BranchPoint:
        """Return the last point of a branch that more digits confirm as an orbit: `last`, or one
        just before it.
        """
        for back in (0.0, *(RESOLUTION * 4.0**j for j in range(MOST_BACK))):
            z = last.z - back * last.tangent
            if back == 0.0:
                point: BranchPoint | None = last
            else:
                point = self.accepted(self.correct(z, last.tangent), last)
            if point is not None:
                equations = self.equations(point.value)
                again = solve(equations, point.points)
                if again.converged and not failures(equations, again.points):
                    return point
        return last

    def _word_beyond(self, point: BranchPoint, direction: float) -> tuple[str | None, str]:
        """Return the word of the orbit just beyond an end and ""; without one, None and a text on
        the motion there.
        """
        # The motion is simulated there from the orbit at the end, and the words that it goes
        # through are solved for. One with an admissible orbit is the answer: with c > 0 there is no
        # second one (`symosc.orbits.floquet`).
        instead = ""
        for distance in BEYOND_END:
            value = point.value + direction * distance * (self.high - self.low)
            if value == point.value:
                continue
            try:
                equations = self.equations(value)
            except ParameterError:  # there is no such system
                break
            (x, theta) = point.points[0].tolist()
            positions, _ = point.points.T
            size = float(np.abs(positions).max())
            orbit, text = settling(equations, x, theta % (2 * pi), equations.pieces[0].start, size)
            if orbit is not None:
                return orbit.cycle, ""
            instead = instead or text
        return None, instead

    def _switchings(self, point: BranchPoint) -> tuple[SwitchingPoint, ...]:
        """Return the switching points of a branch point as (t, x)."""
        return switching_points(self.equations(point.value), point.points)


def _begins_to_rest(p: Parameters) -> int | None:
    """Return the belt with speed 0 and mu FN nearly |B0|, on which the mass can just rest; None if
    there is none.
    """
    near = BEGINS_TO_REST * abs(p.B0)
    return next(
        (
            belt
            for belt in p.law.boundaries
            if p.belt(belt) == 0 and abs(p.friction(belt) - abs(p.B0)) < near
        ),
        None,
    )


# -- between two points ----------------------------------------------------------------------------


Node = tuple[ClosingEquations, np.ndarray]


def _largest_bends(values: np.ndarray, axis: int) -> np.ndarray:
    """Return, for each column of (5, n) values, the largest second difference along `axis` in it or
    a neighbour.
    """
    bend = np.abs(np.diff(values, 2, axis=axis)).max(axis=0)
    if axis != 0:
        bend = np.concatenate([bend[:1], bend, bend[-1:]])
    bend[1:-1] = np.maximum(bend[1:-1], np.maximum(bend[:-2], bend[2:]))
    return bend


def _proven_positive(values: np.ndarray, deficit: float | np.ndarray = 0.0) -> np.ndarray:
    """Return, for each column of margins at five points of a branch, whether they stay > 0 between
    the points.

    The criterion is sqrt(f0) + sqrt(f1) > sqrt(C), as derived at the top of the module. `deficit`
    is by how much a margin may be smaller between neighbouring columns than in these.
    """
    bend = _largest_bends(values, axis=0)
    least = values - deficit
    roots = np.sqrt(np.maximum(least, 0.0))
    far = roots[:-1] + roots[1:] > np.sqrt(0.5 * MARGIN_SAFETY * bend)
    return np.asarray((least > 0).all(axis=0) & far.all(axis=0))


def _stay_positive(nodes: list[Node], i: int, u: np.ndarray, depth: int) -> bool:
    """Return whether the margins of piece i stay positive all through it and between five points of
    a branch.

    `nodes` has the equations and switching points at the five points, `u` the fractions (0 to 1) of
    the piece's duration at which margins are computed. Where these are not enough, `u` is refined,
    at most `depth` times.
    """
    margins_at_nodes = [piece_margins(equations, points, i, u) for equations, points in nodes]
    for rows in zip(*margins_at_nodes, strict=True):  # one margin at the five points
        values = np.array(rows)
        # Between neighbouring columns, h apart, a function is less than h^2 max|f''|/8 below its
        # chord. h^2 f'' comes from second differences, times MARGIN_SAFETY.
        good = _proven_positive(values, MARGIN_SAFETY / 8 * _largest_bends(values, axis=1))
        if good.all():
            continue
        # Finer fractions help only where the margins hold at the fractions themselves.
        if depth == 0 or not _proven_positive(values)[~good].all():
            return False
        # Only runs of neighbouring fractions whose margins are still open are refined. `edges`
        # alternate: the first fraction of a run, and the one after its last.
        edges = np.flatnonzero(np.diff(np.concatenate([[False], ~good, [False]]).astype(int)))
        for first, last in zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True):
            low = u[max(first - 1, 0)]
            high = u[min(last + 1, len(u) - 1)]
            finer = np.linspace(low, high, 1 + FINER * (last - first + 2))
            is_resolved = finer[1] > finer[0]  # else doubles end here
            if not is_resolved or len(finer) > MOST_PARTS:
                return False
            if not _stay_positive(nodes, i, finer, depth - 1):
                return False
    return True


def piece_margins(
    equations: ClosingEquations, points: Points, i: int, u: np.ndarray
) -> list[np.ndarray]:
    """Return the margins of piece i at the fractions u of its duration: gaps to belts in flights,
    forces in sticks.
    """
    piece, start, (_, end_theta), tau = equations.spans(points)[i]
    K = equations.K
    belt = equations.belt(piece.start)
    columns = column_functions()
    if piece.sticks:
        # Time counts from the end of the stick, where the force that ends it is 0.
        before = -(1 - u) * tau
        half = 0.5 * K.Om * before
        waves = columns["sin"](end_theta + half) * columns["sin"](half)
        force = -piece.side * (belt.drift * before - 2 * K.f0 * waves)
        slope = piece.side * (belt.drift - K.fB * equations.sin(end_theta))
        ratio = np.where(u == 1, slope, force / np.where(u == 1, 1.0, -before))
        return [ratio, belt.J - force]
    times = tau * u
    v, a, s, c = equations.start_of_flight(piece, start)
    basis = columns["basis"](times, K)[:5]
    _, dv, acceleration = motion(v, a, s, c, K.cm, K.w0sq, K.f0, K.Om, *basis)
    b, *_ = derivatives(v, a, s, c, K)
    functions = []
    for boundary, sign in ((piece.mode - 1, 1.0), (piece.mode, -1.0)):
        if boundary not in (1, 2):
            continue
        # q(u) of the module's docstring; where it is 0/0, at the ends, by accelerations.
        roots = piece.roots(boundary)
        gap = sign * ((v - equations.belt(boundary).v) + dv)
        if roots:
            inner = u > 0
        else:
            inner = np.ones(len(u), dtype=bool)
        q = np.empty(len(u))
        q[inner] = gap[inner] / times[inner] ** roots
        q[~inner] = sign * (0.5 * b if roots == 2 else a)
        if boundary == piece.end:
            ends = u == 1
            q[~ends] /= 1 - u[~ends]
            q[ends] = -sign * acceleration[ends] * tau ** (1 - roots)
        functions.append(q)
    return functions
