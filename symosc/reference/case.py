"""A reference case: a scene, and its events as they are known, with proof where there is one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cache
from math import inf, pi
from typing import Any, NamedTuple

from symosc.certificates.certificate import Certificate, proven_rows
from symosc.certificates.certify import certify
from symosc.exact import show
from symosc.model import Parameters
from symosc.reference.condition import conditions, events_of
from symosc.reference.hard_cases import last_period
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import MAP_LABELS, Event

#: Digits of events that are given, and of the runs where there is no proof.
GIVEN_DIGITS, COMPUTED_DIGITS = 40, 60
#: A neighbour of a motion that grazes has a short contact or none, this near to the graze, in forcing periods.
NEAR_A_GRAZE = 1e-9
PROVEN, COMPUTED = "proven", "computed, not proven"


class KnownEvent(NamedTuple):
    """An event of a reference case.

    Attributes
    ----------
    t, x : tuple of str
        Between which decimals time and position are.
    kind, source, target : str
    boundary : int
        In the words of `symosc.Event`.
    word : str
        The mapping that ends with the event: "P1" to "P8", "" for the way from a start between the belts.

    Examples
    --------
    >>> from symosc import reference_cases
    >>> event = reference_cases()[1].events[0]
    >>> event.kind, event.word, event.t[0][:12], float(event.middle[1])
    ('slip', 'P4', '1.5826058214', 7.913029107052609)
    """

    t: tuple[str, str]
    x: tuple[str, str]
    kind: str
    boundary: int
    source: str
    target: str
    word: str

    @property
    def middle(self) -> tuple[Fraction, Fraction]:
        """Time and position in the middle of what is known."""
        t, x = ((Fraction(low) + Fraction(high)) / 2 for low, high in (self.t, self.x))
        return t, x


@dataclass(frozen=True, repr=False)
class ReferenceCase:
    """A motion whose events are known. Certificate, events and condition are computed when they are asked for.

    Attributes
    ----------
    name : str
        The case's only name: letters, digits and hyphens.
    group : str
    scene : Scene
        Parameters, start and end, all exact.
    hard : str
        What is hard about it.
    source : str
        Where the case or what is known of it comes from.
    closed_form : tuple of str
        Known values of events, such as "x[2] = 1/10 + 4/3": event numbers from 0, expressions with pi, sqrt and log.
    open : str
        Why its events are not proven; "" if they are.
    periods : int
        0; or the forcing periods of a run so long that the events of the last one only are given.

    Examples
    --------
    >>> from symosc import reference_cases
    >>> case = reference_cases()[0]
    >>> case
    <ReferenceCase paper-fig5: 16 events, proven>
    >>> case.parameters.mu1, case.t_end, f"{case.condition:.1f}"
    (Fraction(4, 5), Fraction(40, 1), '11.3')
    """

    name: str
    group: str
    scene: Scene
    hard: str
    source: str = ""
    closed_form: tuple[str, ...] = ()
    open: str = ""
    periods: int = 0

    @property
    def parameters(self) -> Parameters:
        """The parameters."""
        return self.scene.parameters

    @property
    def t0(self) -> Fraction:
        """Start time."""
        return self.scene.t0

    @property
    def x0(self) -> Fraction:
        """Start position."""
        return self.scene.x0

    @property
    def v0(self) -> Fraction:
        """Start velocity."""
        return self.scene.v0

    @property
    def t_end(self) -> Fraction:
        """End time."""
        return self.scene.t_end

    @property
    def certificate(self) -> Certificate:
        """The proof; or what says why there is none."""
        return _certificate(self)

    @property
    def proven(self) -> bool:
        """Whether all events are proven."""
        return not self.open and self.certificate.proven

    @property
    def status(self) -> str:
        """Whether its events are "proven", or "computed, not proven"."""
        return PROVEN if self.proven else COMPUTED

    @property
    def events(self) -> tuple[KnownEvent, ...]:
        """All events, in order of time; of a run with `periods` those of the last one."""
        return _events(self)

    @property
    def count(self) -> int:
        """How many events there are in all, if only the last ones are given; else how many are given."""
        return len(self.events) * max(self.periods, 1)

    @property
    def conditions(self) -> tuple[float, ...]:
        """The condition number of each event (`symosc.reference.condition`); infinite for a graze."""
        return _conditions(self)

    @property
    def condition(self) -> float:
        """The largest condition number of an event that is not a graze; 0 if there is none."""
        return max((each for each in self.conditions if each < inf), default=0.0)

    def __repr__(self) -> str:
        count = f"{len(self.events)} event{'' if len(self.events) == 1 else 's'}"
        return f"<ReferenceCase {self.name}: {count}, {self.status}>"


@cache
def _certificate(case: ReferenceCase) -> Certificate:
    return certify(case.scene, digits=GIVEN_DIGITS)


@cache
def _events(case: ReferenceCase) -> tuple[KnownEvent, ...]:
    if case.proven:
        rows = proven_rows(case.certificate)
        found = [((*row["t"],), (*row["x"],), *(row[name] for name in KnownEvent._fields[2:6])) for row in rows]
    else:
        found = [
            (_rounded(event.t), _rounded(event.x), event.kind, event.boundary, event.source, event.target)
            for event in simulate(case.scene, digits=COMPUTED_DIGITS).events
        ]
    return tuple(_with_words(case, found))


def _with_words(case: ReferenceCase, rows: Iterable[Any]) -> Iterable[KnownEvent]:
    p = case.parameters
    before = next((boundary for boundary in (1, 2) if p.belt(boundary) == case.v0), 0)
    for row in rows:
        boundary, source = row[3], row[4]
        yield KnownEvent._make((*row, MAP_LABELS.get((before, source, boundary), "")))
        before = boundary


def _rounded(value: Any) -> tuple[str, str]:
    """Return the two decimals with GIVEN_DIGITS digits that a number is between."""
    digits = Decimal(str(value.context.nstr(value, COMPUTED_DIGITS)))
    low, high = (Context(GIVEN_DIGITS, rounding=way).plus(digits) for way in (ROUND_FLOOR, ROUND_CEILING))
    return f"{low:f}", f"{high:f}"


@cache
def _conditions(case: ReferenceCase) -> tuple[float, ...]:
    """Return the condition of all events; of a neighbour, contacts beside a graze are left out with the graze."""
    near = NEAR_A_GRAZE * 2 * pi / float(case.parameters.Omega)
    grazes = [event.middle[0] for event in case.events if event.kind == "graze"]

    def apart(scene: Scene, digits: int) -> Sequence[Event]:
        found = last_period(scene, digits) if case.periods else events_of(scene, digits)
        return [each for each in found if all(abs(float(each.t) - float(t)) > near for t in grazes)]

    known = iter(conditions(case.scene, apart))
    return tuple(inf if event.kind == "graze" else next(known) for event in case.events)


def described(case: ReferenceCase) -> str:
    """Return start and end of a case in a line."""
    start = ", ".join(f"{name} = {show(getattr(case, name))}" for name in ("t0", "x0", "v0"))
    return f"{start}, t_end = {show(case.t_end)}"
