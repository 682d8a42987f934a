"""The equations of borders of orbits under any friction law.

At a border an inequality of the orbit is 0. It is followed along an itinerary
(`symosc.orbits.itinerary`) that begins and ends where the inequality belongs, so that all equations
are smooth there:

    TOUCH, in a flight   its velocity turns at the speed of the belt: it grazes the belt
    FAR, at a contact    the force in the domain behind the belt is at the limit of friction
    HOLD, in a stick     an extremum of the force is at the limit of friction

The unknowns are time and position at the beginning, and one parameter or two. Without a drive the
time does not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Number
from symosc.base.errors import ParameterError
from symosc.model import Model
from symosc.orbits import admissibility
from symosc.orbits.admissibility import Condition
from symosc.orbits.border_system import AT_FAR, AT_HOLD, AT_TOUCH, BorderSystem, Unknowns
from symosc.orbits.followed_orbit import FollowedOrbit, numbers_of_points
from symosc.orbits.itinerary import (
    Itinerary,
    ItineraryLeg,
    LawInDoubles,
    LegEnd,
    MotionOnWay,
    itinerary_of,
    leg_end,
)

#: The change of an unknown, in scaled units, in difference quotients.
DIFFERENCE = 1e-6
#: Samples of a stick, and halvings between two of them, to an extremum of its force.
SAMPLES = 64
MOST_HALVINGS = 60
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
    """The itinerary of a border with its zero, where it begins (time, position), and the number of
    the leg that passes the section of the orbit, with the time from its beginning to there.
    """

    itinerary: Itinerary
    zero: LawZero
    t: float
    x: float
    leg: int
    elapsed: float


class BorderAhead(NamedTuple):
    """A value of a parameter at which a border is, and where the orbit passes its section there:
    time, position.
    """

    value: float
    t: float
    x: float


class LawBorderSystem(BorderSystem):
    """The equations of a border under any law, for one parameter or two."""

    def __init__(
        self,
        model: Model,
        names: Sequence[str],
        widths: Sequence[float],
        orbit: FollowedOrbit,
        begun: BorderBegun,
    ) -> None:
        self.model = model
        self.names = tuple(names)  # type: ignore[assignment]
        self.periods = orbit.periods
        self.itinerary, self.zero, self.t, *_ = begun
        assert orbit.motion is not None
        times = np.linspace(float(orbit.motion.t_start), float(orbit.motion.t_end), 513)
        x, v = orbit.motion(times)
        self.pace = float(orbit.period) / (2 * pi * max(1, self.periods))
        self.size = float(np.ptp(x))
        self.fastest = float(np.ptp(v))
        units = [self.pace, self.size] if self.periods else [self.size]
        self.scale = np.array([*units, *widths])
        self.sizes = np.zeros(len(units) + 1)
        self._laws = dict[tuple[float, ...], LawInDoubles]()

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
        followed = self.itinerary.follow(law, *self.begin(u))
        if followed is None:
            raise ValueError("there is no such motion")
        return law, followed

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
        if self.zero.kind == AT_TOUCH:
            return (end.v - law.speeds[edge]) / self.fastest
        if self.zero.kind == AT_FAR:
            value = law.holding(edge, self.zero.side, end.t, end.x)
        else:
            elapsed = self.extremum(law, t, followed.spans[0])
            value = law.holding(edge, self.zero.side, t + elapsed, x + law.speeds[edge] * elapsed)
        return value * self.pace / self.fastest

    def extremum(self, law: LawInDoubles, t: float, span: float) -> float:
        """Return the time from the beginning of the first stick to the lowest margin of the force
        in it.
        """
        edge, side = self.zero.edge, self.zero.side
        times = np.linspace(0.0, span, SAMPLES + 1)
        K, _ = law.band(edge)
        slopes = [law.holding_slope(edge, side, t + time) for time in times.tolist()]
        turns = [n for n in range(SAMPLES) if slopes[n] < 0.0 <= slopes[n + 1]]
        if not turns:
            raise ValueError("the force has no extremum in the stick")
        pull = side * K.w0sq * law.speeds[edge]
        lows = [law.holding(edge, side, t + times[n], 0.0) + pull * float(times[n]) for n in turns]
        n = turns[lows.index(min(lows))]
        low, high = float(times[n]), float(times[n + 1])
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

    def _sizes(self, u: Sequence[float]) -> np.ndarray:
        """Return the sizes of the terms of the residuals: all are scaled."""
        return np.ones(len(self.sizes))


class Loop:
    """The legs of an orbit as a cycle, without the section: where each begins and how long it takes."""

    def __init__(self, orbit: FollowedOrbit, own: Itinerary, followed: MotionOnWay) -> None:
        self.span = float(orbit.period)
        self.section_time = followed.starts[0].t
        last = len(own.legs) - 1
        self.legs = list(own.legs[:last])
        self.spans = list(followed.spans[:last])
        self.starts = list(followed.starts[:last])
        #: the leg that passes the section, and how long it takes to there
        self.whole = own.legs[last]
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
        side = 1 if flight.rises else -1
        if kind == AT_TOUCH:
            if not after.sticks:
                return None
            legs, spans = self.turned(first)
            legs[-1] = flight._replace(end=LegEnd.TURN)
            return self.begun(legs, spans, LawZero(kind, flight.edge, -side), first)
        legs, spans = self.turned(first)
        if after.sticks and after.edge == side:  # a stick of no length
            first = (first + 1) % count
            legs, spans = legs[1:], spans[1:]
        return self.begun(legs, spans, LawZero(kind, flight.edge, side), first)

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


def begun_at(orbit: FollowedOrbit, condition: Condition) -> BorderBegun | None:
    """Return the itinerary of the border at which a condition of an orbit is 0, from an orbit near
    it; None if it has no equation here.
    """
    motion = orbit.motion
    assert motion is not None
    assert orbit._section is not None
    own = itinerary_of(motion, orbit._section.upwards)
    law = LawInDoubles(orbit.parameters)
    begin = float(motion.t_start)
    _, _, _, x, *_ = motion._pieces[:, 0].tolist()
    followed = own.follow(law, begin, x)
    if followed is None or len(followed.legs) < len(own.legs):
        return None
    loop = Loop(orbit, own, followed)
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
    if len(followed.legs) < len(system.itinerary.legs):
        return None
    band = followed.legs[begun.leg].band
    passing = ItineraryLeg(band, False, LegEnd.CLOSED, -1, section.upwards)
    start = followed.starts[begun.leg]
    place = leg_end(law, passing, start, begun.elapsed, float(section.speed))
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
