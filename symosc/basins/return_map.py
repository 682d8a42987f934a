"""`return_map`: the one-dimensional section map of a motion that sticks, or of one without a drive.

With a drive: a stick on a belt ends when the force that it needs reaches the limit of friction. Then
x follows from the phase, and v is the belt's speed. So the phase theta of a slip decides all that
follows, and the phase of the next slip from this belt is a function of it. Where the force on a
belt rises, the mass slips upward, where it falls downward; the phase alone tells.

Without a drive: the position x where v falls through 0, and the next one (`symosc.basins.plane`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf, nan, pi
from typing import Any, NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import NumberLike
from symosc.base.arguments import (
    ARRAY_LIKE,
    NUMBER,
    WHOLE,
    public,
    require,
    require_or_none,
    row_of,
)
from symosc.base.arrays import real_array
from symosc.base.display.drawable import Comparable, Drawable
from symosc.base.errors import ParameterError
from symosc.base.exact import LARGEST, read_exact, whole_number
from symosc.basins.kinds import oscillator_of
from symosc.basins.plane import ACCURACY, PhasePlane, require_spring
from symosc.basins.recurrence import units_of
from symosc.engine.arithmetic import mp_context
from symosc.engine.state import SLIP
from symosc.kernels.elementary import cos, sin
from symosc.model import Model
from symosc.scenes import ParametersLike, model_of
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.tables import EventTable

TWO_PI = 2 * pi
#: How long before a slip its stick begins that is followed, as a phase, and how far from the phase
#: asked for the slip may then be.
BEFORE = 1e-6
SLIPS_AT = 1e-5
#: Forcing periods in which the next slip is looked for, one number after the other.
SEARCHED = (4, 32, 256)
MOST_EVENTS = 20_000
#: Steps that halve the interval around a jump, and that narrow one around a fixed point.
JUMP_STEPS = 44
ROOT_STEPS = 60
#: Changes of the events between two neighbouring points, at most.
MOST_CHANGES = 8
FOUND = 1e-13
#: Values on both sides of a place that differ by more, as a part of the range, are a jump.
JUMP = 1e-5
#: Neighbours that differ by more than this part of the range may have a jump between them, and how
#: far from a jump its sides are looked at.
LEAP = 0.05
APART = 1e-11
#: The step of difference quotients, as a part of the range.
STEP = 1e-6
MOST_POINTS = 1_000_000
LEAST_POINTS = 8
MOST_RETURNS = 100_000
#: Parts of an orbit whose means tell the error of an exponent.
PARTS = 16


class MapJump(NamedTuple):
    """A place where a section map jumps: its values just below and just above.

    Attributes
    ----------
    at, below, above : float

    Examples
    --------
    >>> from symosc import Belt, Oscillator, return_map
    >>> law = Oscillator(m=1, c="0.1", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
    >>> (jump,) = return_map(law, points=33).jumps
    >>> bool(jump.below < jump.at < jump.above)
    True
    """

    at: float
    below: float
    above: float


class FixedPoint(NamedTuple):
    """A fixed point of a section map, or of its n-th iterate.

    Attributes
    ----------
    at : float
        The phase of the slip, or x without a drive.
    slope : float
        That of the map there; the orbit is stable if it is less than 1 in size.
    span : float
        The time until the orbit closes.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, return_map
    >>> law = Oscillator(m=1, c="0.1", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
    >>> (point,) = return_map(law, points=33).fixed_points()
    >>> f"{point.at:.6f}", abs(point.slope) < 1e-6, point.stable
    ('1.161800', True, True)
    """

    at: float
    slope: float
    span: float

    @property
    def stable(self) -> bool:
        """Whether the slope is less than 1 in size."""
        return abs(self.slope) < 1


class Sampled(NamedTuple):
    """Values of a section map, the times until then, and a number for the events in between."""

    after: np.ndarray
    span: np.ndarray
    kind: np.ndarray


@dataclass(frozen=True, eq=False, repr=False)
class ReturnMap(Comparable, Drawable):
    """A section map of one dimension; call it for exact values: ``f(0.3)``, ``f([0.3, 0.4], n=2)``.

    Attributes
    ----------
    parameters : Parameters or Oscillator
    belt : int
        The belt from which the slips are; 0 without a drive.
    at : (n,) float array
        Phases of slips in [0, 2 pi) or, without a drive, positions x where v falls through 0; among
        them one on each side of each jump.
    after : (n,) float array
        The next ones; NaN where there is none: the mass does not stick to the belt again, or comes
        to rest.
    span : (n,) float array
        The times in between.
    jumps : tuple of MapJump
        Where the map jumps: a flight there touches a belt.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, return_map
    >>> law = Oscillator(m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.98")])
    >>> f = return_map(law, points=64)
    >>> [f"{point.at:.6f}" for point in f.fixed_points() if point.stable]
    ['2.018621', '2.468055']
    """

    _drawn_by = "return_map_figure"
    _made_by = "return_map(...)"

    parameters: Model
    belt: int
    at: np.ndarray
    after: np.ndarray
    span: np.ndarray
    jumps: tuple[MapJump, ...]
    _map: Any = field(repr=False)
    _kinds: np.ndarray = field(repr=False)

    def __repr__(self) -> str:
        if self.belt:
            about = f"phases of slips from belt {self.belt}"
        else:
            about = "positions where v falls through 0"
        return f"<ReturnMap of {about}: {len(self.at)} points, {len(self.jumps)} jumps>"

    @public
    def __call__(self, at: ArrayLike, n: int = 1) -> np.ndarray:
        """Return the values of the n-th iterate of the map, NaN where there is none."""
        require(*ARRAY_LIKE, at=at)
        require(WHOLE, n=n)
        places = real_array("at", at, "must be real numbers")
        if np.abs(places).max(initial=0.0) > LARGEST:
            raise ParameterError("at", at, f"must be at most {float(LARGEST):g} in size")
        count = whole_number("n", n, 1, MOST_RETURNS)
        return self._map.sample(places.ravel(), count).after.reshape(places.shape)

    @public
    def fixed_points(self, n: int = 1) -> tuple[FixedPoint, ...]:
        """Return the fixed points of the n-th iterate, stable or not, that lie between the points of
        the map.

        Examples
        --------
        >>> from symosc import Belt, Oscillator, return_map
        >>> law = Oscillator(m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.98")])
        >>> len(return_map(law, points=64).fixed_points(2)) >= 1
        True
        """
        require(WHOLE, n=n)
        count = whole_number("n", n, 1, MOST_RETURNS)
        if count == 1:
            sampled = Sampled(self.after, self.span, self._kinds)
        else:
            sampled = self._map.sample(self.at, count)
        gaps = self._map.difference(sampled.after, self.at)
        low = np.flatnonzero(
            (np.sign(gaps[:-1]) * np.sign(gaps[1:]) <= 0)
            & (sampled.kind[:-1] == sampled.kind[1:])
            & (np.abs(gaps[1:] - gaps[:-1]) < self._map.width / 2)
        )
        places = self._roots(low, gaps, count)
        return tuple(self._fixed(places, count))

    def _roots(self, low: np.ndarray, gaps: np.ndarray, n: int) -> np.ndarray:
        """Return where the map meets the diagonal, between the points `low` and the next ones."""
        a, b = self.at[low].copy(), self.at[low + 1].copy()
        fa, fb = gaps[low].copy(), gaps[low + 1].copy()
        for _ in range(ROOT_STEPS):
            open_ones = np.abs(b - a) > FOUND * self._map.width
            if not open_ones.any():
                break
            # The rule of false position, with the weight of an end that stays halved (Illinois).
            with np.errstate(all="ignore"):
                middle = np.where(fb != fa, b - fb * (b - a) / (fb - fa), (a + b) / 2)
            middle = np.clip(middle, np.minimum(a, b), np.maximum(a, b))
            value = self._map.difference(self._map.sample(middle, n).after, middle)
            crossed = value * fb < 0
            a, fa = np.where(crossed, b, a), np.where(crossed, fb, fa / 2)
            b, fb = middle, value
            if (np.abs(value) <= FOUND * self._map.width).all():
                break
        return b[np.isfinite(fb)]

    def _fixed(self, places: np.ndarray, n: int) -> Iterator[FixedPoint]:
        """Yield the fixed points at places of the section, each once."""
        if not len(places):
            return
        here = self._map.sample(places, n)
        slopes = self._slopes(places, n)
        gaps = np.abs(self._map.difference(here.after, places))
        last = -inf
        for at, slope, span, gap in zip(places, slopes, here.span, gaps, strict=True):
            if gap < JUMP * self._map.width and at - last > STEP * self._map.width:
                yield FixedPoint(float(at), float(slope), float(span))
                last = at

    def _slopes(self, at: np.ndarray, n: int = 1) -> np.ndarray:
        """Return the slopes of the n-th iterate, by differences; NaN beside a jump."""
        step = STEP * self._map.width
        count = len(at)
        both = self._map.sample(np.concatenate([at - step, at + step]), n)
        low, high = both.after[:count], both.after[count:]
        slopes = self._map.difference(high, low) / (2 * step)
        return np.where(both.kind[:count] == both.kind[count:], slopes, nan)

    @public
    def orbit(self, at: NumberLike, n: int = 100) -> np.ndarray:
        """Return `at` and its n images, fewer if the mass does not return."""
        require(NUMBER, at=at)
        require(WHOLE, n=n)
        count = whole_number("n", n, 1, MOST_RETURNS)
        return self._map.orbit(float(read_exact("at", at)), count)

    @public
    def exponent(self, at: NumberLike, n: int = 1000, skip: int = 100) -> tuple[float, float]:
        """Return the exponent of the map along an orbit, per return, and its standard error.

        It is the mean of log abs(slope), without the first `skip` returns: positive in chaos.

        Examples
        --------
        >>> from symosc import Belt, Oscillator, return_map
        >>> law = Oscillator(m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.77")])
        >>> mean, error = return_map(law, points=16).exponent(1, n=64)
        >>> round(mean, 3)
        -0.465
        """
        require(NUMBER, at=at)
        require(WHOLE, n=n, skip=skip)
        count = whole_number("n", n, 1, MOST_RETURNS)
        left_out = whole_number("skip", skip, 0, MOST_RETURNS)
        path = self._map.orbit(float(read_exact("at", at)), count + left_out)[left_out:-1]
        sizes = np.abs(self._slopes(path))
        sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
        if len(sizes) < 2 * PARTS:
            return nan, nan
        log = mp_context(25).log  # the C library's may have other last bits on other machines
        rates = np.array([float(log(size)) for size in sizes.tolist()])
        means = [float(part.mean()) for part in np.array_split(rates, PARTS)]
        return float(rates.mean()), float(np.std(means, ddof=1) / PARTS**0.5)


class SlipMap:
    """The map from the phase of a slip from a belt to that of the next one."""

    width = TWO_PI

    def __init__(self, model: Model, belt: int, workers: int | None) -> None:
        self.model = oscillator_of(model)
        self.belt = belt
        self.workers = workers
        law = self.model
        self.speed = law.belts[belt - 1].v
        below = next(band for band in law.bands if band.above == self.speed)
        above = next(band for band in law.bands if band.below == self.speed)
        excess = law.law.excess(belt)
        #: k x - B0 cos(theta) at a slip downward, and upward.
        self.downward = float(below.A - below.c * self.speed + excess)
        self.upward = float(above.A - above.c * self.speed - excess)

    def position(self, theta: float) -> float:
        """Return where the mass slips at a phase."""
        law = self.model
        rises = -(float(law.k * self.speed) + float(law.B0 * law.Omega) * sin(theta)) > 0
        force = self.upward if rises else self.downward
        return (force + float(law.B0) * cos(theta)) / float(law.k)

    def difference(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Return the differences of phases, from -pi to pi."""
        difference: np.ndarray = (first - second + pi) % TWO_PI - pi
        return difference

    def lifted(self, theta: np.ndarray, sampled: Sampled) -> np.ndarray:
        """Return the phases of the next slips with all turns, which are continuous where the map
        does not jump.
        """
        early: np.ndarray = theta + sampled.span * float(self.model.Omega)
        return early

    def folded(self, theta: np.ndarray) -> np.ndarray:
        """Return phases without turns."""
        return theta % TWO_PI

    def starts(self, theta: np.ndarray) -> np.ndarray:
        """Return starts in sticks that end at phases."""
        early = theta - BEFORE
        places = np.array([self.position(angle) for angle in theta.tolist()])
        Omega = float(self.model.Omega)
        x = places - float(self.speed) * BEFORE / Omega
        return np.column_stack([early / Omega, x, np.full(len(theta), float(self.speed))])

    def sample(self, theta: np.ndarray, n: int) -> Sampled:
        """Return the phases of the n-th slips after those at `theta`."""
        theta = np.asarray(theta, dtype=float) % TWO_PI
        out = Sampled(np.full(len(theta), nan), np.full(len(theta), nan), np.full(len(theta), -1))
        kinds = np.full(len(theta), -1, np.int64)
        out = Sampled(out.after, out.span, kinds)
        rows = np.arange(len(theta))
        starts = self.starts(theta)
        starts = np.where(np.isfinite(starts), starts, 0.0)
        rows = rows[np.isfinite(theta)]
        for periods in SEARCHED:
            if not len(rows):
                break
            table = simulate_many(
                self.model, starts[rows], f"{periods * n}T", accuracy=ACCURACY,
                workers=self.workers, max_events=MOST_EVENTS,
            )  # fmt: skip
            rows = self._keep(table, theta, rows, n, out)
        return out

    def _keep(
        self, table: EventTable, theta: np.ndarray, rows: np.ndarray, n: int, out: Sampled
    ) -> np.ndarray:
        """Fill `out` for motions of a table; return the rows that need a longer time."""
        slips = np.flatnonzero((table.kind_code == SLIP) & (table.boundary == self.belt))
        cuts = np.searchsorted(table.trajectory[slips], np.arange(len(rows) + 1))
        events = np.searchsorted(table.trajectory, np.arange(len(rows) + 1))
        codes = table.kind_code * 1000 + table.target_code
        later = []
        for i, row in enumerate(rows.tolist()):
            own = slips[cuts[i] : cuts[i + 1]]
            if not len(own) or abs(self.difference(table.theta[own[0]], theta[row])) > SLIPS_AT:
                continue
            if len(own) > n:
                last = int(own[n])
                out.after[row] = table.theta[last]
                out.span[row] = table.t[last] - theta[row] / float(self.model.Omega)
                between = codes[events[i] : last + 1]
                out.kind[row] = crc32(between.tobytes())
            elif table.status[i] == "t_end":
                later.append(row)
        return np.array(later, dtype=int)

    def orbit(self, theta: float, n: int) -> np.ndarray:
        """Return a phase and its images."""
        starts = self.starts(np.array([theta]))
        phases = np.zeros(0)
        for periods in SEARCHED:
            table = simulate_many(
                self.model, starts, f"{periods * n}T", accuracy=inf, max_events=1_000_000
            )
            slips = (table.kind_code == SLIP) & (table.boundary == self.belt)
            phases = table.theta[slips][: n + 1]
            if len(phases) > n:
                break
        return phases

    def grid(self, points: int, over: tuple[float, float] | None) -> np.ndarray:
        """Return evenly spaced phases."""
        low, high = over or (0.0, TWO_PI)
        return np.linspace(low, high, points, endpoint=over is not None)


class SectionMap:
    """The map of the positions where v falls through 0, without a drive."""

    belt = 0

    def __init__(self, model: Model, workers: int | None) -> None:
        self.plane = PhasePlane(model, workers)
        self.width = 2 * float(units_of(oscillator_of(model))[0])

    def difference(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Return the differences of positions."""
        return np.asarray(first) - np.asarray(second)

    def lifted(self, x: np.ndarray, sampled: Sampled) -> np.ndarray:
        """Return the next positions."""
        return sampled.after

    def folded(self, x: np.ndarray) -> np.ndarray:
        """Return positions as they are."""
        return x

    def sample(self, x: np.ndarray, n: int) -> Sampled:
        """Return the n-th next positions."""
        after = np.asarray(x, dtype=float)
        span = np.zeros(len(after))
        kind = np.zeros(len(after), np.int64)
        for _ in range(n):
            first = self.plane.first_points(after, np.zeros(len(after)))
            after = first.x
            span = span + first.t
            kind = kind * 64 + first.events
        return Sampled(after, span, kind)

    def orbit(self, x: float, n: int) -> np.ndarray:
        """Return a position and its images."""
        ((points, _),) = self.plane.paths(np.array([x]), n)
        return np.concatenate([[x], points])

    def grid(self, points: int, over: tuple[float, float] | None) -> np.ndarray:
        """Return evenly spaced positions beyond the rest."""
        rest = self.plane.rest.high
        low, high = over or (rest, rest + self.width)
        if over is None:
            return np.linspace(low, high, points + 1)[1:]
        return np.linspace(low, high, points)


@public
def return_map(
    what: ParametersLike,
    belt: int | None = None,
    *,
    points: int = 512,
    over: tuple[NumberLike, NumberLike] | None = None,
    workers: int | None = None,
) -> ReturnMap:
    """Compute the one-dimensional section map of motions that stick, or of those without a drive.

    With a drive it maps the phase Omega t mod 2 pi of a slip from a belt to that of the next slip
    from this belt: a stick forgets its velocity, and where it ends x follows from the phase. Without
    a drive it maps the position x where v falls through 0 to the next one; it never decreases.

    Parameters
    ----------
    what : Parameters or Oscillator, or a Scene, its name or its file
    belt : int, optional
        With a drive, the number of the belt. Default: the first one with friction.
    points : int, optional
        How many values are computed.
    over : pair of numbers, optional
        The range of phases or positions. Default: all phases, or the positions beyond the rest in
        which friction matters.
    workers : int, optional
        Threads; None: one for each core.

    Returns
    -------
    ReturnMap

    Raises
    ------
    ParameterError
        If a number is out of range, or there is no such belt, or no spring.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, return_map
    >>> law = Oscillator(m=1, c=0, k=1, belts=[Belt("1/5", mu="1/2", mu_s=1)])
    >>> f = return_map(law, points=32)
    >>> f"{f(2):.9f}"
    '1.038516481'
    """
    model = model_of(what, "what")
    require_or_none(WHOLE, belt=belt, workers=workers)
    require(WHOLE, points=points)
    require_or_none(row_of(2, NUMBER), over=over)
    require_spring(model)
    count = whole_number("points", points, LEAST_POINTS, MOST_POINTS)
    if over is None:
        span = None
    else:
        low, high = (float(read_exact("over", end)) for end in over)
        if not low < high:
            raise ParameterError("over", over, "must go from a lower to a higher value")
        span = (low, high)
    law: SlipMap | SectionMap
    if model.B0 == 0:
        if belt is not None:
            raise ParameterError("belt", belt, "must be omitted without a drive")
        law = SectionMap(model, workers)
    else:
        law = SlipMap(model, _belt_of(model, belt), workers)
    at = law.grid(count, span)
    sampled = law.sample(at, 1)
    jumps = _jumps(law, at, sampled)
    at, sampled = _with_ends(law, at, sampled, jumps)
    return ReturnMap(
        model, law.belt, at, sampled.after, sampled.span, tuple(jumps), law, sampled.kind
    )


def _belt_of(model: Model, belt: Any) -> int:
    """Return the number of a belt, by default the first one with friction."""
    law = oscillator_of(model)
    if belt is not None:
        return whole_number("belt", belt, 1, len(law.belts))
    for n in law.law.boundaries:
        if law.law.kinetic(n) or law.law.excess(n):
            return n
    raise ParameterError("belt", belt, "no belt has friction, so that nothing sticks")


def _jumps(law: SlipMap | SectionMap, at: np.ndarray, sampled: Sampled) -> list[MapJump]:
    """Return the jumps of a map between its points: where the events in between change, or the
    values differ much.
    """
    lifted = law.lifted(at, sampled)
    far = np.abs(np.diff(lifted)) > LEAP * law.width
    places = np.flatnonzero(
        ((sampled.kind[:-1] != sampled.kind[1:]) | far)
        & np.isfinite(lifted[:-1])
        & np.isfinite(lifted[1:])
    )
    left, right = at[places], at[places + 1]
    first, last = sampled.kind[places], sampled.kind[places + 1]
    below, beyond = lifted[places], lifted[places + 1]
    jumps = list[MapJump]()
    for _ in range(MOST_CHANGES):
        if not len(left):
            break
        # The end of the piece of the map that begins on the left.
        low, high, above, kind = left, right, beyond, last
        for _ in range(JUMP_STEPS):
            middle = (low + high) / 2
            found = law.sample(middle, 1)
            values = law.lifted(middle, found)
            is_near = np.abs(values - below) <= np.abs(values - above)
            is_low = np.where(first == kind, is_near, found.kind == first)
            low = np.where(is_low, middle, low)
            below = np.where(is_low, values, below)
            high = np.where(is_low, high, middle)
            above = np.where(is_low, above, values)
            kind = np.where(is_low, kind, found.kind)
        apart = np.abs(above - below) > JUMP * law.width
        ends = np.column_stack([high, law.folded(below), law.folded(above)])
        jumps += map(MapJump._make, ends[apart].tolist())
        # Another piece may end before the point on the right.
        more = (kind != last) & np.isfinite(above)
        left, right, first, last, below, beyond = (
            column[more] for column in (high, right, kind, last, above, beyond)
        )
    return sorted(jumps)


def _with_ends(
    law: SlipMap | SectionMap, at: np.ndarray, sampled: Sampled, jumps: list[MapJump]
) -> tuple[np.ndarray, Sampled]:
    """Return the points of a map together with one on each side of its jumps."""
    if not jumps:
        return at, sampled
    edges = np.array([jump.at for jump in jumps])
    sides = np.concatenate([edges - APART * law.width, edges + APART * law.width])
    beside = law.sample(sides, 1)
    places = np.concatenate([at, sides])
    order = np.argsort(places, kind="stable")
    columns = (
        np.concatenate([own, added])[order] for own, added in zip(sampled, beside, strict=True)
    )
    return places[order], Sampled(*columns)
