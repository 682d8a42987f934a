"""The equations of borders of orbits under any friction law.

At a border an inequality of the orbit is 0. It is followed along an itinerary
(`symosc.orbits.itinerary`) that begins and ends where the inequality belongs, so that all equations
are smooth there:

    TOUCH, in a flight   its velocity turns at the speed of the belt: it grazes the belt
    FAR, at a contact    the force in the domain behind the belt is at the limit of friction
    HOLD, in a stick     an extremum of the force is at the limit of friction

or a multiplier of the orbit passes the unit circle, at a fold, a period doubling or a Neimark-Sacker
point; then the word does not change.

The unknowns are time and position at the beginning, and one parameter or two. Without a drive the
time does not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Number
from symosc.base.errors import ParameterError, SymoscError
from symosc.kernels import linear
from symosc.model import Model
from symosc.orbits import admissibility
from symosc.orbits.admissibility import Condition
from symosc.orbits.border_system import (
    AT_FAR,
    AT_HOLD,
    AT_TOUCH,
    REST,
    BorderPlane,
    BorderSystem,
    Node,
    Unknowns,
)
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.followed_orbit import FollowedOrbit, followed_orbit, numbers_of_points
from symosc.orbits.itinerary import (
    Itinerary,
    ItineraryLeg,
    LawInDoubles,
    LegEnd,
    MotionOnWay,
    PointOnWay,
    flown_in,
    itinerary_of,
    leg_end,
)
from symosc.orbits.law_margins import margins
from symosc.orbits.return_maps import SpeedSection
from symosc.orbits.settling import settled_orbit_of
from symosc.simulation.simulate import simulate
from symosc.words import Word

#: Borders at which a multiplier passes the unit circle.
FOLD = "fold"
PERIOD_DOUBLING = "period doubling"
NEIMARK_SACKER = "Neimark-Sacker"
MULTIPLIERS = (FOLD, PERIOD_DOUBLING, NEIMARK_SACKER)
#: The border at which a cycle is born at a corner of friction.
ONSET = "onset at a corner"
#: So far from a border, in parts of the ranges, is the orbit beside it; margins that are below the
#: second part of their like there are 0 on the border.
ASIDE = 1e-7
HIDDEN = 1e-2
#: The change of an unknown, in scaled units, in difference quotients.
DIFFERENCE = 1e-6
#: Newton's steps to the orbit beside a border, and the residual that is small enough.
MOST_STEPS = 12
MOST_ITINERARIES = 6
FOUND = 1e-12
#: Samples of a stick, and halvings between two of them, to an extremum of its force.
SAMPLES = 64
MOST_HALVINGS = 60
#: A passage belongs to a leg that it is outside of by at most this part of the leg.
WITHIN_LEG = 1e-9
#: How many laws in doubles are kept.
MOST_KEPT = 16


class LawZero(NamedTuple):
    """A margin that is 0 on a border: its kind, the edge, and the side of the force or of the flight:
    1 above the edge, -1 below.
    """

    kind: str
    edge: int
    side: int


class BorderBegun(NamedTuple):
    """The itinerary of a border with its zero, where it begins (time, position), the number of the
    leg that passes the section of the orbit, with the time from its beginning to there, and the
    stick of no length that is left out, if any.
    """

    itinerary: Itinerary
    zero: LawZero
    t: float
    x: float
    leg: int
    elapsed: float
    left_out: ItineraryLeg | None = None


class BorderAhead(NamedTuple):
    """A value of a parameter at which a border is, and where the orbit passes its section there:
    time, position.
    """

    value: float
    t: float
    x: float


class LawBorderSystem(BorderSystem):
    """The equations of a border under any law, for one parameter or two.

    `orbit` is near the border, `plane` has the ranges of two parameters, and `kind` is what happens
    there.
    """

    is_refined = False

    def __init__(
        self,
        model: Model,
        names: Sequence[str],
        widths: Sequence[float],
        orbit: FollowedOrbit,
        begun: BorderBegun,
        plane: BorderPlane | None = None,
        kind: str = "",
    ) -> None:
        self.model = model
        self.names = tuple(names)  # type: ignore[assignment]
        if plane is not None:
            self.plane = plane
        self.kind = kind
        self.word = Word(orbit.labels)
        self.periods = orbit.periods
        self.itinerary, self.zero, self.t, *_, self.left_out = begun
        self.zeros = ()
        assert orbit.motion is not None
        times = np.linspace(float(orbit.motion.t_start), float(orbit.motion.t_end), 513)
        x, v = orbit.motion(times)
        self.pace = float(orbit.period) / (2 * pi * max(1, self.periods))
        self.size = float(np.ptp(x))
        self.fastest = float(np.ptp(v))
        units = [self.pace, self.size] if self.periods else [self.size]
        self.scale = np.array([*units, *widths])
        self.sizes = np.ones(len(units) + 1)
        self._laws = dict[tuple[float, ...], LawInDoubles]()
        #: points of the border with their itineraries
        self.known = list[tuple[np.ndarray, Itinerary]]()
        #: 1 where the margin of the equations grows into the side of the orbit's word, or -1
        self.sense = 0.0
        self.hidden_texts: set[tuple[int, str]] = set()

    def unknowns(self, t: float, x: float, values: Sequence[float]) -> np.ndarray:
        """Return the scaled unknowns of a beginning at values of the parameters."""
        if self.periods:
            return np.array([t, x, *values]) / self.scale
        return np.array([x, *values]) / self.scale

    def law(self, values: Sequence[float]) -> LawInDoubles:
        """Return the law at values of the parameters."""
        key = tuple(values)
        if key not in self._laws:
            while len(self._laws) >= MOST_KEPT:  # the oldest goes
                del self._laws[next(iter(self._laws))]
            model = self.model.replace(**dict(zip(self.names, key, strict=True)))
            self._laws[key] = LawInDoubles(model)
        return self._laws[key]

    def begin(self, u: Unknowns) -> tuple[float, float]:
        """Return time and position of the beginning for unknowns."""
        if self.periods:
            return u[0], u[1]
        return self.t, u[0]

    def followed(self, u: Unknowns) -> tuple[LawInDoubles, MotionOnWay]:
        """Return the law for unknowns and its motion; raise ValueError if there is none."""
        try:
            law = self.law([float(value) for value in u[-len(self.names) :]])
        except ParameterError as error:
            raise ValueError(str(error)) from None
        followed = self.nearby(u).follow(law, *self.begin(u))
        if followed is None:
            raise ValueError("there is no such motion")
        return law, followed

    def nearby(self, u: Unknowns) -> Itinerary:
        """Return the itinerary of the nearest point of the border."""
        if not self.known:
            return self.itinerary
        away = np.array([z for z, _ in self.known]) - np.array(u, dtype=float) / self.scale
        nearest = int((away * away).sum(axis=1).argmin())
        return self.known[nearest][1]

    def residuals(self, u: Unknowns, digits: int | None = None) -> list[Number]:
        """Return what must be 0, scaled: by how much the motion misses its start, and the margin."""
        law, followed = self.followed(u)
        t, x = self.begin(u)
        values = [(followed.end.x - x) / self.size, self.margin(law, followed, t, x)]
        if self.periods:
            turn = 2 * pi * self.periods / law.numbers.Omega
            values.insert(0, (followed.end.t - t - turn) / self.pace)
        return values

    def margin(self, law: LawInDoubles, followed: MotionOnWay, t: float, x: float) -> float:
        """Return the margin that is 0 on the border, scaled."""
        edge = self.zero.edge
        end = followed.end
        if self.zero.kind in MULTIPLIERS:
            return self.multiplier_test(followed)
        if self.zero.kind == AT_TOUCH:
            return (end.v - law.speeds[edge]) / self.fastest
        if self.zero.kind == AT_FAR:
            value = law.holding(edge, self.zero.side, end.t, end.x)
        else:
            elapsed = self.extremum(law, t, followed.spans[0])
            value = law.holding(edge, self.zero.side, t + elapsed, x + law.speeds[edge] * elapsed)
        return value * self.pace / self.fastest

    def multiplier_test(self, followed: MotionOnWay) -> float:
        """Return what is 0 where a multiplier passes the unit circle."""
        (a, _), (_, d) = followed.changes.tolist()
        sign = 1.0 if self.zero.kind == PERIOD_DOUBLING else -1.0
        if not self.periods:
            return float(1 + sign * d)
        if self.zero.kind == NEIMARK_SACKER:
            return 1 - followed.growth
        return float(1 + sign * (a + d) + followed.growth)

    def extremum(self, law: LawInDoubles, t: float, span: float) -> float:
        """Return the time from the beginning of the first stick to the lowest margin of the force
        in it.
        """
        edge = self.zero.edge
        side = self.zero.side
        times = np.linspace(0.0, span, SAMPLES + 1)
        K, _ = law.band(edge)
        slopes = [law.holding_slope(edge, side, t + time) for time in times.tolist()]
        turns = [n for n in range(SAMPLES) if slopes[n] < 0.0 <= slopes[n + 1]]
        if not turns:
            raise ValueError("the force has no extremum in the stick")
        pull = side * K.w0sq * law.speeds[edge]
        lows = [law.holding(edge, side, t + times[n], 0.0) + pull * float(times[n]) for n in turns]
        n = turns[lows.index(min(lows))]
        low = float(times[n])
        high = float(times[n + 1])
        for _ in range(MOST_HALVINGS):
            middle = (low + high) / 2
            if law.holding_slope(edge, side, t + middle) < 0.0:
                low = middle
            else:
                high = middle
        return (low + high) / 2

    def _linearised(self, u: list[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the residuals and their difference quotients by the unknowns."""
        values = np.array(self.residuals(u))
        columns = []
        for j in range(len(u)):
            beside = list(u)
            shift = DIFFERENCE * self.scale[j]
            beside[j] += shift
            try:
                above = np.array(self.residuals(beside))
            except ValueError:  # the parameter may be at its least value
                shift = -shift
                beside[j] = u[j] + shift
                above = np.array(self.residuals(beside))
            columns.append((above - values) / shift)
        return values, np.array(columns).T

    def node(self, z: np.ndarray, along: np.ndarray, row: np.ndarray | None = None) -> Node | None:
        """Find the border's point, as `BorderSystem` does; its durations are the next guesses."""
        node = super().node(z, along, row)
        if node is None:
            return None
        _, followed = self.followed((node.z * self.scale).tolist())
        own = replace(self.itinerary, legs=followed.legs, spans=followed.spans)
        self.known.append((node.z, own))
        return node

    def polish(
        self, z: np.ndarray, fixed: tuple[int, Fraction] | None = None
    ) -> list[Number] | None:
        """Return the root in doubles; None if it is not found. `fixed` is as in `BorderSystem`."""
        row = None
        if fixed is not None:
            index, value = fixed
            row = np.eye(len(z))[index]
            z = z.copy()
            z[index] = float(value) / self.scale[index]
        found = self.correct(z, row)
        if found is None:
            return None
        root: list[Number] = (found.z * self.scale).tolist()
        if fixed is not None:
            root[index] = float(value)
        return root

    def fine_tangent(self, u: Sequence[Number]) -> np.ndarray:
        """Return the border's unit tangent in scaled unknowns."""
        _, matrix = self._linearised([float(value) for value in u])
        return linear.null_vector(matrix * self.scale)

    # -- the orbits on both sides ------------------------------------------------------------------

    def called(self) -> tuple[str, str]:
        """Return what happens at the border, and its name in the literature, for friction without
        static friction.
        """
        kind = self.zero.kind
        if kind in MULTIPLIERS or self.law_at_start().limits[self.zero.edge] != 0:
            return self.kind, ""
        names = {AT_TOUCH: "grazing-sliding", AT_HOLD: "adding-sliding"}
        if kind == AT_FAR and self.itinerary.legs[0].sticks:
            return self.kind, "switching-sliding"
        return self.kind, names.get(kind, "crossing-sliding")

    def law_at_start(self) -> LawInDoubles:
        """Return the law at which the border was found."""
        numbers = self.model.numbers()
        return self.law([float(numbers[name]) for name in self.names])

    def state(self, z: np.ndarray) -> tuple[float, float, float]:
        """Return a state (t, x, v) on the border's orbit, in the middle of its longest flight."""
        law, followed = self.followed((z * self.scale).tolist())
        flights = [i for i, leg in enumerate(followed.legs) if not leg.sticks]
        i = max(flights, key=lambda i: followed.spans[i])
        middle = flown_in(law, followed.legs[i], followed.starts[i], followed.spans[i] / 2)
        return middle.t, middle.x, middle.v

    def inward(self, z: np.ndarray) -> np.ndarray:
        """Return the direction, in parts of the ranges, in which the margin grows."""
        _, matrix = self._linearised((z * self.scale).tolist())
        matrix = matrix * self.scale
        count = len(matrix) - 1
        own = matrix[-1]
        closing = matrix[:-1]
        columns = [
            linear.solve(closing[:, :count], closing[:, count + j]) for j in range(len(self.names))
        ]
        gradient = np.array(
            [own[count + j] - linear.dot(own[:count], columns[j]) for j in range(len(self.names))]
        )
        return gradient / linear.norm(gradient)

    def begin_side(self, z: np.ndarray, direction: float) -> None:
        """Lay down on which side the word of the orbit is: in this direction of the first
        parameter.
        """
        along, _ = self.inward(z)
        self.sense = 1.0 if along * direction > 0 else -1.0
        orbit = self.orbit(z)
        self.hidden_texts = {
            (margin.piece, margin.text)
            for margin in margins(orbit)
            if margin.value < HIDDEN * margin.scale
        }

    def orbit(self, z: np.ndarray) -> Any:
        """Return the orbit with the word of the border beside it, or at a multiplier on it.

        Raise ConvergenceError if there is none.
        """
        values = np.array(self.values(z))
        if self.zero.kind not in MULTIPLIERS:
            values += ASIDE * self.sense * self.inward(z) * self.plane.widths
        orbit = self.orbit_for(z, values)
        if orbit is None:
            reason = "the orbit beside the border has another word"
            raise ConvergenceError(str(self.word), (), self.periods, inf, reason)
        return orbit

    def orbit_for(self, z: np.ndarray, values: np.ndarray) -> FollowedOrbit | None:
        """Return the orbit with the word of the border for parameters beside one of its points, None
        if none is found.
        """
        u = (z * self.scale).tolist()
        u[-2:] = values.tolist()
        law, followed = self.followed(u)
        itinerary, place = self.of_word(law, followed)
        t = place.t
        x = place.x
        model = self.plane.parameters(values)
        for _ in range(MOST_ITINERARIES):
            closed = self.closed(law, itinerary, t, x)
            if closed is None:
                return None
            t, x, span, changes = closed
            motion = simulate(model, t0=t, x0=x, v0=place.v, t_end=t + span, accuracy=inf)
            seen = itinerary_of(motion, itinerary.legs[-1].rises)
            is_seen = seen.legs == itinerary.legs
            itinerary = seen
            if is_seen:
                break
        section = SpeedSection(model, Fraction(place.v), itinerary.legs[-1].rises)
        orbit = followed_orbit(section, t, x, span, self.periods, changes, 0.0, 0, None, motion)
        if orbit is None or orbit.labels != self.word.labels:
            return None
        return orbit

    def closed(
        self, law: LawInDoubles, itinerary: Itinerary, t: float, x: float
    ) -> tuple[float, float, float, np.ndarray] | None:
        """Return where an orbit along an itinerary begins near a time and a position, its period,
        and the derivatives of its map; None if none is found.
        """
        turn = 2 * pi * self.periods / float(law.numbers.Omega)
        passage = itinerary.follow(law, t, x)
        for _ in range(MOST_STEPS):
            if passage is None:
                return None
            rows = passage.changes - np.eye(2)
            off = np.array([passage.end.t - t - turn, passage.end.x - x])
            if not self.periods:
                rows = np.array([[1.0, 0.0], [0.0, rows[1, 1]]])
                off[0] = 0.0
            # At a multiplier the equations are singular, and the orbit is there already.
            is_found = np.abs(off / (self.pace, self.size)).max() < FOUND
            if is_found or self.zero.kind in MULTIPLIERS:
                break
            try:
                late, away = linear.solve(rows, -off).tolist()
            except ZeroDivisionError:
                return None
            t += late
            x += away
            passage = itinerary.follow(law, t, x)
        if passage is None:
            return None
        return t, x, turn or passage.end.t - t, passage.changes

    def of_word(self, law: LawInDoubles, followed: MotionOnWay) -> tuple[Itinerary, PointOnWay]:
        """Return the itinerary of the orbit with the word of the border, from the middle of its
        longest flight, and where this begins in a motion along the border's itinerary.
        """
        legs = list(followed.legs)
        spans = list(followed.spans)
        starts = list(followed.starts)
        if self.zero.kind == AT_TOUCH and legs[0].sticks:
            legs[-1] = legs[-1]._replace(end=LegEnd.EDGE)
        elif self.zero.kind == AT_TOUCH:  # the flight only turns there
            if len(legs) > 1:
                legs[-1] = legs[0]
                spans[-1] += spans[0]
                del legs[0], spans[0], starts[0]
        elif self.left_out is not None:
            legs.insert(0, self.left_out)
            spans.insert(0, 0.0)
            starts.insert(0, starts[0])
        flights = [i for i, leg in enumerate(legs) if not leg.sticks]
        i = max(flights, key=lambda i: spans[i])
        half = spans[i] / 2
        middle = flown_in(law, legs[i], starts[i], half)
        closed = ItineraryLeg(legs[i].band, False, LegEnd.CLOSED, -1, middle.a > 0)
        if len(legs) == 1:
            return Itinerary((closed,), (2 * half,), -1, middle.v), middle
        order = [*range(i + 1, len(legs)), *range(i)]
        whole = Itinerary(
            (legs[i], *(legs[n] for n in order), closed),
            (half, *(spans[n] for n in order), half),
            -1,
            middle.v,
        )
        return whole, middle

    def margins(self, z: np.ndarray) -> list[Condition]:
        """Return the inequalities of the orbit beside the border, but for those that are 0 on it."""
        try:
            orbit = self.orbit(z)
        except (SymoscError, ValueError):
            text = f"there is an orbit with the word {self.word}"
            return [Condition(0, text, -1.0, 0.0, "", -1, 1.0)]
        found = margins(orbit, sticks=True)
        kept = [c for c in found if (c.piece, c.text) not in self.hidden_texts]
        return sorted(kept, key=lambda c: (c.piece, c.text))

    def same_words(self) -> tuple[str, str | None] | None:
        """Return the words on both sides where the orbit keeps its own, beyond a fold None; None
        where the word changes.
        """
        if self.zero.kind not in MULTIPLIERS:
            return None
        own = str(self.word.cycle)
        return own, None if self.zero.kind == FOLD else own

    def word_at(self, model: Model, z: np.ndarray) -> str | None:
        """Return the word of an orbit near the border for parameters beside it: the border's own, or
        that of the motion that settles; REST where it comes to rest, None without a word.
        """
        numbers = model.numbers()
        values = np.array([float(numbers[name]) for name in self.names])
        try:
            orbit = self.orbit_for(z, values)
        except (SymoscError, ValueError):
            orbit = None
        if orbit is not None:
            return str(self.word.cycle)
        t, x, v = self.state(z)
        try:
            orbit = settled_orbit_of(model, t, x, v)
        except SymoscError:
            return None
        if orbit.is_rest:
            return REST
        return orbit.word or None


class OnsetSystem(LawBorderSystem):
    """The border at which a cycle without a drive is born at a corner of friction: the corner has the
    speed 0, and damping changes its sign there. The unknowns are the two parameters.
    """

    def __init__(self, model: Model, plane: BorderPlane, labels: tuple[str, ...]) -> None:
        self.model = model
        self.plane = plane
        self.names = plane.names
        self.kind = ONSET
        self.word = Word(labels)
        self.periods = 0
        self.zeros = ()
        self.scale = plane.widths
        self.sizes = np.ones(1)
        self.known = []
        self._laws = dict[tuple[float, ...], LawInDoubles]()
        speeds = [abs(float(edge.v)) for edge in model.law.edges]
        self.edge = speeds.index(min(speeds))
        self.fastest = max(speeds)

    def law_at(self, u: Unknowns) -> LawInDoubles:
        """Return the law at two parameters; raise ValueError if there is none."""
        try:
            return self.law([float(value) for value in u])
        except ParameterError as error:
            raise ValueError(str(error)) from None

    def residuals(self, u: Unknowns, digits: int | None = None) -> list[Number]:
        """Return the speed of the corner, which must be 0, scaled."""
        return [self.law_at(u).speeds[self.edge] / self.fastest]

    def node(self, z: np.ndarray, along: np.ndarray, row: np.ndarray | None = None) -> Node | None:
        """Find the border's point, as `BorderSystem` does."""
        return BorderSystem.node(self, z, along, row)

    def called(self) -> tuple[str, str]:
        """Return what happens at the border, which has no name of its own."""
        return self.kind, ""

    def along(self, z: np.ndarray) -> np.ndarray | None:
        """Return the direction of the border at a point of it; None if no parameter moves the
        corner.
        """
        _, matrix = self._linearised((z * self.scale).tolist())
        (gradient,) = (matrix * self.scale).tolist()
        across, upward = gradient
        if across == upward == 0.0:
            return None
        direction = np.array([upward, -across])
        return direction / linear.norm(direction)

    def orbit(self, z: np.ndarray) -> Any:
        """Refuse: at its onset the cycle has no size."""
        raise ConvergenceError(str(self.word), (), 0, inf, "the cycle has no size at its onset")

    def margins(self, z: np.ndarray) -> list[Condition]:
        """Return the inequality that damping changes its sign at the corner."""
        law = self.law_at((z * self.scale).tolist())
        below, above = (law.band(self.edge + side)[0].cm for side in (0, 1))
        text = "damping changes its sign at the corner"
        value = min(abs(below), abs(above)) * (1.0 if below * above < 0 else -1.0)
        return [Condition(0, text, value, 0.0, "", -1, 1.0)]

    def same_words(self) -> tuple[str, str | None]:
        """Return the word of the cycle, and REST: beyond its onset there is a rest only."""
        return str(self.word.cycle), REST

    def word_at(self, model: Model, z: np.ndarray) -> str | None:
        """Refuse: motions beside an onset settle too slowly."""
        raise ConvergenceError(str(self.word), (), 0, inf, "motions settle too slowly at an onset")


def orbit_through(
    model: Model, t: float, x: float, v: float, span: float, periods: int
) -> FollowedOrbit | None:
    """Return the orbit through a state in a flight, which closes after a time; None if it does not."""
    motion = simulate(model, t0=t, x0=x, v0=v, t_end=t + span, accuracy=inf)
    _, _, _, _, _, slope, *_ = motion._pieces[:, 0].tolist()
    section = SpeedSection(model, Fraction(v), slope > 0)
    followed = itinerary_of(motion, section.upwards).follow(LawInDoubles(model), t, x)
    if followed is None:
        return None
    return followed_orbit(section, t, x, span, periods, followed.changes, 0.0, 0, None, motion)


class Loop:
    """The legs of an orbit as a cycle, without the section: where each begins and how long it takes."""

    def __init__(self, orbit: FollowedOrbit, followed: MotionOnWay) -> None:
        self.span = float(orbit.period)
        self.section_time = followed.starts[0].t
        last = len(followed.legs) - 1
        self.legs = list(followed.legs[:last])
        self.spans = list(followed.spans[:last])
        self.starts = list(followed.starts[:last])
        #: the leg that passes the section, and how long it takes to there
        self.whole = followed.legs[last]
        self.before_section = followed.spans[last]
        before = followed.starts[last]
        if self.legs:
            self.spans[0] += followed.spans[last]
            self.starts[0] = before._replace(t=before.t - self.span)

    def turned(self, first: int) -> tuple[list[ItineraryLeg], list[float]]:
        """Return legs and durations from a leg on."""
        return (
            [*self.legs[first:], *self.legs[:first]],
            [*self.spans[first:], *self.spans[:first]],
        )

    def begun(
        self, legs: list[ItineraryLeg], spans: list[float], zero: LawZero, first: int
    ) -> BorderBegun:
        """Return the border with these legs, which begins where leg `first` of the cycle does."""
        start = self.starts[first]
        itinerary = Itinerary(tuple(legs), tuple(spans), zero.edge, 0.0)
        at_section = -first % len(self.legs)
        return BorderBegun(itinerary, zero, start.t, start.x, at_section, self.before_section)

    def at_contact(self, contact: int, kind: str) -> BorderBegun | None:
        """Return the border of a graze (TOUCH) at the end of a flight, or of a force (FAR) there."""
        count = len(self.legs)
        flight = self.legs[contact]
        first = (contact + 1) % count
        after = self.legs[first]
        side = flight.side
        if kind == AT_TOUCH:
            if not after.sticks:
                return None
            legs, spans = self.turned(first)
            legs[-1] = flight._replace(end=LegEnd.TURN)
            return self.begun(legs, spans, LawZero(kind, flight.edge, -side), first)
        legs, spans = self.turned(first)
        left_out = None
        if after.sticks and after.edge == side:  # a stick of no length
            first = (first + 1) % count
            left_out = legs[0]
            del legs[0], spans[0]
        begun = self.begun(legs, spans, LawZero(kind, flight.edge, side), first)
        return begun._replace(left_out=left_out)

    def in_stick(self, stick: int, against_other: bool) -> BorderBegun:
        """Return the border of a force during a stick, that at its end or the other one."""
        leg = self.legs[stick]
        side = -leg.edge if against_other else leg.edge
        legs, spans = self.turned(stick)
        return self.begun(legs, spans, LawZero(AT_HOLD, leg.band, side), stick)

    def at_turn(self, law: LawInDoubles, t: float, x: float, v: float) -> BorderBegun | None:
        """Return the border of a graze where the velocity of a flight turns, at a time."""
        if not self.legs:
            band = self.whole.band
            number = -1
        else:
            begins = np.array([start.t for start in self.starts])
            t = begins[0] + (t - begins[0]) % self.span
            number = int(np.searchsorted(begins, t, side="right")) - 1
            band = self.legs[number].band
        edges = [
            edge for edge in (band - 1, band) if 0 <= edge < len(law.edges) and law.edges[edge].belt
        ]
        if not edges:
            return None
        edge = min(edges, key=lambda edge: abs(law.speeds[edge] - v))
        zero = LawZero(AT_TOUCH, edge, 1 if edge < band else -1)
        before = ItineraryLeg(band, False, LegEnd.TURN, edge, edge == band)
        if number < 0:
            alone = Itinerary((before,), (self.span,), edge, 0.0)
            return BorderBegun(alone, zero, t, x, 0, (self.section_time - t) % self.span)
        legs, spans = self.turned(number)
        elapsed = t - self.starts[number].t
        at_section = -number % len(self.legs)
        to_section = self.before_section
        if number == 0 and to_section < elapsed:
            at_section = len(legs)
        elif number == 0:
            to_section -= elapsed
        divided = (spans[0] - elapsed, *spans[1:], elapsed)
        itinerary = Itinerary((*legs, before), divided, edge, 0.0)
        return BorderBegun(itinerary, zero, t, x, at_section, to_section)


def loop_of(orbit: FollowedOrbit) -> Loop | None:
    """Return the legs of an orbit as a cycle; None if its motion is not one along them."""
    motion = orbit.motion
    assert motion is not None
    assert orbit._section is not None
    own = itinerary_of(motion, orbit._section.upwards)
    _, _, _, x, *_ = motion._pieces[:, 0].tolist()
    followed = own.follow(LawInDoubles(orbit.parameters), float(motion.t_start), x)
    if followed is None:
        return None
    return Loop(orbit, followed)


def begun_at_multiplier(orbit: FollowedOrbit, kind: str) -> BorderBegun | None:
    """Return the itinerary of an orbit with a multiplier on the unit circle, which begins at an edge
    of the law; None if it meets none.
    """
    loop = loop_of(orbit)
    if loop is None:
        return None
    count = len(loop.legs)
    flights = [i for i, leg in enumerate(loop.legs) if leg.end is LegEnd.EDGE]
    if not flights:
        return None
    last = max(flights, key=lambda i: abs(loop.starts[(i + 1) % count].a))
    first = (last + 1) % count
    legs, spans = loop.turned(first)
    zero = LawZero(kind, loop.legs[last].edge, loop.legs[last].side)
    return loop.begun(legs, spans, zero, first)


def begun_at(orbit: FollowedOrbit, condition: Condition) -> BorderBegun | None:
    """Return the itinerary of the border at which a condition of an orbit is 0, from an orbit near
    it; None if it has no equation here.
    """
    motion = orbit.motion
    assert motion is not None
    law = LawInDoubles(orbit.parameters)
    begin = float(motion.t_start)
    loop = loop_of(orbit)
    if loop is None:
        return None
    if condition.rank == admissibility.STAYS_INSIDE:
        t = begin + (condition.t - float(orbit.start[0])) % loop.span
        x, v = motion(min(t, float(motion.t_end))).tolist()
        return loop.at_turn(law, t, x, v)
    contacts = [i for i, leg in enumerate(loop.legs) if leg.sticks or law.edges[leg.edge].belt]
    numbers = numbers_of_points(motion)
    begins = contacts[numbers[condition.piece]]
    ends = contacts[numbers[(condition.piece + 1) % len(numbers)]]
    if condition.rank == admissibility.ARRIVAL:
        return loop.at_contact(ends, AT_TOUCH)
    if condition.rank == admissibility.PASSING:
        return loop.at_contact(ends, AT_FAR)
    if condition.rank == admissibility.STICK_LASTS:
        return loop.at_contact(begins, AT_FAR)
    if condition.rank == admissibility.HOLD:
        stick = (begins + 1) % len(loop.legs)
        return loop.in_stick(stick, "other side" in condition.text)
    return None


def place_on_section(
    law: LawInDoubles, followed: MotionOnWay, section: SpeedSection, expected: float
) -> PointOnWay | None:
    """Return the passage of a motion through a section that is nearest to a time; None if there is
    none.
    """
    places = list[PointOnWay]()
    speed = float(section.speed)
    for leg, start, span in zip(followed.legs, followed.starts, followed.spans, strict=True):
        if leg.sticks:
            continue
        passing = ItineraryLeg(leg.band, False, LegEnd.CLOSED, -1, section.upwards)
        guess = min(max(expected - start.t, 0.0), span)
        place = leg_end(law, passing, start, guess, speed)
        if place is None:
            continue
        slack = WITHIN_LEG * span
        if -slack <= place.t - start.t <= span + slack:
            places.append(place)
    return min(places, key=lambda place: abs(place.t - expected), default=None)


def border_ahead(
    orbit: FollowedOrbit, condition: Condition, name: str, width: float
) -> BorderAhead | None:
    """Return where a condition of an orbit is 0 for another value of a parameter, None if no such
    place is found near.
    """
    begun = begun_at(orbit, condition)
    section = orbit._section
    if begun is None or section is None:
        return None
    value = float(orbit.parameters.numbers()[name])
    system = LawBorderSystem(orbit.parameters, (name,), (width,), orbit, begun)
    found = system.correct(system.unknowns(begun.t, begun.x, [value]), None)
    if found is None:
        return None
    try:
        law, followed = system.followed((found.z * system.scale).tolist())
    except ValueError:
        return None
    expected = sum(begun.itinerary.spans[: begun.leg]) + begun.elapsed
    place = place_on_section(law, followed, section, followed.starts[0].t + expected)
    if place is None:
        return None
    assert orbit.motion is not None
    begin = float(orbit.motion.t_start)
    late = place.t - begin
    if system.periods:
        turn = 2 * pi * system.periods / law.numbers.Omega
        late -= turn * round(late / turn)
    else:
        late = 0.0
    return BorderAhead(float(found.z[-1] * width), begin + late, place.x)
