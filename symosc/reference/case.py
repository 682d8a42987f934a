"""A reference case: a scene, its known events (proven where possible), and their condition numbers.

The condition number of an event, with out its time or position and in each parameter and start
value, is

    condition = max over out of  sum over in of |d out/d in| |in| / max(1, |out|),

the amplification of relative errors of the input into errors of the output. A solver that works in
doubles rounds every input, so no solver can avoid an error of condition * 1e-16. A number that is 0
has no relative error and does not count. A start on a belt moves with the belt, because off it
there would be other events. The derivatives are differences of two runs with more digits; where the
difference changes the events themselves it is made smaller.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cached_property
from math import inf, pi, ulp
from typing import Any, NamedTuple

from symosc.base.aliases import Number
from symosc.certificates.certificate import Certificate, provable, proven_rows
from symosc.certificates.certify import certify
from symosc.derivatives.sensitivities import sensitivities
from symosc.engine.arithmetic import mp_context
from symosc.model import Model
from symosc.orbits.find import find_orbit, is_of_paper
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.tangents import names_of
from symosc.simulation.trajectory import Event, map_labels

#: Digits of the given events, and of the runs where there is no proof.
GIVEN_DIGITS = 40
COMPUTED_DIGITS = 60
PROVEN = "proven"
COMPUTED = "computed, not proven"
# Relative differences for conditions, and the digits of their runs. A start times (1 + 1/7^n) has
# no end as a decimal: one with an end and this many digits would be taken for a number that
# somebody cut off there.
INPUT_CHANGES = ((Fraction(1, 7**30), 60), (Fraction(1, 7**60), 120))


class KnownEvent(NamedTuple):
    """An event of a reference case.

    Attributes
    ----------
    t, x : tuple of str
        The two decimals between which the time, and the position, lies.
    kind, source, target : str
        What happens (cross, stick, slip or graze), and the modes before and after it, as in
        `symosc.Event`.
    boundary : int
        The belt, counted by speed from 1, at which it happens.
    word : str
        The mapping that ends with the event: "P1" to "P8", or with another number of belts than
        two "S1", "B1" and so on; "" for the way from a start between the belts.

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
        """Time and position in the middle of the known interval."""
        t, x = ((Fraction(low) + Fraction(high)) / 2 for low, high in (self.t, self.x))
        return t, x


class KnownChange(NamedTuple):
    """The derivatives of an event with respect to one parameter or start value.

    Attributes
    ----------
    dt, dx : tuple of str
        The two decimals between which the total derivative of the event's time, and of its
        position, lies.
    proven : bool
        Whether the certificate of the case proves them; if not, they were computed with 60 digits.

    Examples
    --------
    >>> from symosc import reference_cases
    >>> change = reference_cases()[1].derivatives[0]["mu2"]
    >>> change.dt[0][:12], change.proven
    ('1.9020471815', True)
    """

    dt: tuple[str, str]
    dx: tuple[str, str]
    proven: bool


@dataclass(frozen=True, repr=False)
class ReferenceCase:
    """A motion with known events. Certificate, events and condition are computed on first access.

    Attributes
    ----------
    name : str
        The case's unique name: letters, digits and hyphens.
    group : str
        The group of cases that it belongs to, such as "long run".
    scene : Scene
        Parameters, start and end, all exact.
    hard : str
        What is hard about it.
    source : str
        Where the case or what is known of it comes from.
    closed_form : tuple of str
        Known values of events, such as "x[2] = 1/10 + 4/3": event numbers from 0, expressions with
        pi, sqrt and log.
    open : str
        Why its events are not proven; "" if they are.
    periods : int
        0, or the number of forcing periods of a run that is so long that only the last one's events
        are given.
    quick : bool
        Whether it is one of the hard cases of `symosc bench --quick`.

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
    quick: bool = False

    @property
    def parameters(self) -> Model:
        """The parameters: an `Oscillator` where the friction law is not the paper's."""
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

    @cached_property
    def certificate(self) -> Certificate:
        """The certificate of the events and of all provable derivatives; if nothing is proven, it
        says why.
        """
        if self._may_prove_derivatives:
            wrt = provable(self.scene.parameters, self.v0)
            certificate = certify(self.scene, digits=GIVEN_DIGITS, wrt=wrt)
            if certificate.proven:
                return certificate
        # Events may be proven where derivatives are not.
        return certify(self.scene, digits=GIVEN_DIGITS)

    @property
    def _may_prove_derivatives(self) -> bool:
        """Whether the certificate can enclose derivatives too."""
        # Not where the events themselves are not proven, nor for a start that is not known exactly.
        # A long run is proven by the orbit on which it settles, without derivatives.
        # Nor where the friction law is another one than the paper's.
        is_known = not any(self.scene.start_error or ()) and is_of_paper(self.parameters)
        return is_known and not self.open and not self.periods

    @property
    def proven(self) -> bool:
        """Whether all events are proven."""
        return not self.open and self.certificate.proven

    @property
    def expected_status(self) -> str:
        """The status as it stands in the list of cases, without a proof.

        A test compares the two.
        """
        if self.open:
            return COMPUTED
        return PROVEN

    @property
    def status(self) -> str:
        """Whether the events are "proven", or "computed, not proven"."""
        if self.proven:
            return PROVEN
        return COMPUTED

    @cached_property
    def events(self) -> tuple[KnownEvent, ...]:
        """All events, in order of time; if `periods` is not 0, those of the last forcing period
        only.
        """
        names = [name for name in KnownEvent._fields if name != "word"]
        rows = list[dict[str, Any]]()
        if self.proven:
            for row in proven_rows(self.certificate.statement):
                # Enclosures come as lists from JSON.
                enclosed = {"t": tuple(row["t"]), "x": tuple(row["x"])}
                rows.append({name: row[name] for name in names} | enclosed)
        else:
            for event in simulate(self.scene, digits=COMPUTED_DIGITS).events:
                enclosed = {"t": _enclosed(event.t), "x": _enclosed(event.x)}
                rows.append({name: getattr(event, name) for name in names} | enclosed)
        # A word names the mapping from one boundary to the next; 0 is a start inside a domain.
        before = next(
            (
                boundary
                for boundary in self.parameters.law.boundaries
                if self.parameters.belt(boundary) == self.v0
            ),
            0,
        )
        labels = map_labels(len(self.parameters.law.belts))
        for row in rows:
            row["word"] = labels.get((before, row["source"], row["boundary"]), "")
            before = row["boundary"]
        return tuple(KnownEvent(**row) for row in rows)

    @cached_property
    def derivatives(self) -> tuple[dict[str, KnownChange], ...]:
        """For each event its existing derivatives, by the name of the parameter or start value;
        none in a long run.
        """
        if self.periods:
            return ({},) * len(self.events)
        names = names_of(self.parameters)
        proven_names = self.certificate.statement.get("wrt", ())
        stated = self.certificate.derivatives
        rows: list[dict[str, KnownChange]] = [{} for _ in self.events]
        for n, row in enumerate(rows):
            for j, name in enumerate(proven_names):
                dt_by_name, dx_by_name = stated[n]
                row[name] = KnownChange(dt_by_name[j], dx_by_name[j], proven=True)
        if len(proven_names) < len(names):
            s = sensitivities(self.scene, names, digits=COMPUTED_DIGITS)
            for n, row in enumerate(rows):
                for j, name in enumerate(names):
                    if name not in row and s.regular[n, j]:
                        row[name] = KnownChange(
                            _enclosed(s.dt[n, j]), _enclosed(s.dx[n, j]), proven=False
                        )
        return tuple({name: row[name] for name in names if name in row} for row in rows)

    @property
    def count(self) -> int:
        """The number of events of the whole motion, also where only those of its last period are
        given.
        """
        return len(self.events) * max(self.periods, 1)

    @cached_property
    def conditions(self) -> tuple[float, ...]:
        """The condition number of each event; infinite for a graze."""
        # A changed number turns a graze into two contacts or none: in changed and unchanged runs
        # alike, all contacts next to a graze are left out before events are compared.
        near = 1e-9 * 2 * pi / float(self.parameters.Omega)  # a billionth of a forcing period
        middles = [event.middle for event in self.events if event.kind == "graze"]
        graze_times = [float(t) for t, _ in middles]

        def events_apart(scene: Scene, digits: int) -> Sequence[Event]:
            if self.periods:
                events = last_period(scene, digits)
            else:
                events = simulate(scene, digits=digits).events
            return [
                event
                for event in events
                if all(abs(float(event.t) - t) > near for t in graze_times)
            ]

        regular = iter(conditions(self.scene, events_apart))
        numbers = []
        for event in self.events:
            if event.kind == "graze":
                numbers.append(inf)
            else:
                numbers.append(next(regular))
        return tuple(numbers)

    @property
    def condition(self) -> float:
        """The largest condition number of an event that is not a graze; 0 if there is none."""
        return max((number for number in self.conditions if number < inf), default=0.0)

    def __repr__(self) -> str:
        count = "1 event" if len(self.events) == 1 else f"{len(self.events)} events"
        return f"<ReferenceCase {self.name}: {count}, {self.status}>"


def with_known(case: ReferenceCase, **known: Any) -> ReferenceCase:
    """Return a copy of a case for which events, conditions or derivatives are known already and not
    computed.
    """
    changed = copy(case)
    vars(changed).update(known)
    return changed


def _enclosed(value: Any) -> tuple[str, str]:
    """Return the two decimals with GIVEN_DIGITS digits that enclose a number."""
    digits = Decimal(str(value.context.nstr(value, COMPUTED_DIGITS)))
    low = Context(GIVEN_DIGITS, rounding=ROUND_FLOOR).plus(digits)
    high = Context(GIVEN_DIGITS, rounding=ROUND_CEILING).plus(digits)
    return f"{low:f}", f"{high:f}"


def last_period(scene: Scene, digits: int) -> Sequence[Event]:
    """Return the events of the last forcing period before t_end on the orbit that attracts the
    scene's motion.
    """
    # They are those of a period on the orbit, a whole number of periods later. A long run must end
    # with them even if its start is not exactly on the orbit: every period multiplies the distance
    # by the orbit's multipliers, 0.56 and less.
    p = scene.parameters
    word = str(scene.structure)
    context = mp_context(digits + 10)
    # The orbit in doubles is the guess for the one with more digits.
    orbit = find_orbit(p, word, guess=find_orbit(p, word), digits=digits + 10)
    start = orbit.points[0]
    count = len(orbit.points)
    # Two periods, so that the event which closes the first one is not at the very end.
    motion = simulate(
        p, t0=start.t, x0=start.x, v0=scene.v0, t_end=start.t + 2 * orbit.period, digits=digits
    )
    t_end = context.mpf(scene.t_end.numerator) / scene.t_end.denominator
    period = 2 * context.pi * p.Omega.denominator / p.Omega.numerator
    events = [
        replace(event, t=event.t + period * context.floor((t_end - event.t) / period))
        for event in motion.events[:count]
    ]
    return sorted(events, key=lambda event: event.t)


# -- condition numbers -----------------------------------------------------------------------------


def conditions(scene: Scene, events: Callable[[Scene, int], Sequence[Event]]) -> list[float]:
    """Return the condition number of every event of a scene, with respect to all parameters and
    start values.

    ``events(scene, digits)`` has to return the events of a scene, computed with this number of
    digits.
    """
    # They are infinite from the first event on that the smallest change of the input turns into
    # another one.
    largest_step, least_digits = INPUT_CHANGES[0]
    exact = {least_digits: events(scene, least_digits)}
    count = len(exact[least_digits])
    certain = count  # events whose sequence no change alters
    totals_t = [0.0] * count
    totals_x = [0.0] * count
    for name in names_of(scene.parameters):
        if shifted(scene, name, largest_step) == scene:  # as 0 is, whose changes are relative
            continue
        # Smaller and smaller changes, until one leaves the sequence of events as it is.
        for step, digits in INPUT_CHANGES:
            if digits not in exact:
                exact[digits] = events(scene, digits)
            moved = events(shifted(scene, name, step), digits)
            same = _count_equal(exact[digits], moved)
            if same == len(exact[digits]) == len(moved):
                break
        certain = min(certain, same)
        for i, before, after in zip(range(count), exact[digits][:same], moved, strict=False):
            totals_t[i] += relative_error(after.t, before.t) / float(step)
            totals_x[i] += relative_error(after.x, before.x) / float(step)
    larger = [max(totals_t[i], totals_x[i]) for i in range(certain)]
    return larger + [inf] * (count - certain)


def relative_error(value: Number, exact: Number, start: Number = 0) -> float:
    """Return |value - exact| relative to max(1, |exact - start|)."""
    # For a time `start` is t0: a late start is no excuse for a late event. What rounding t0 to a
    # double does is no error.
    if start:
        rounding = ulp(float(start))
    else:
        rounding = 0
    return float(max(0, abs(exact - value) - rounding) / max(1, abs(exact - start)))


def shifted(scene: Scene, name: str, step: Fraction) -> Scene:
    """Return a scene with the parameter or start value `name` times 1 + step.

    A start on a belt stays on the belt.
    """
    p: Model = scene.parameters
    belt = p.law.boundary_of(scene.v0)
    on_belt = f"v{belt}" if belt else ""
    if name in ("t0", "x0", "v0"):
        value = getattr(scene, name)
        if name == "v0" and on_belt:
            return scene
        return replace(scene, **{name: value * (1 + step)})
    value = p.numbers()[name] * (1 + step)
    changes: dict[str, Any] = {"parameters": p.replace(**{name: value})}
    if name == on_belt:
        changes["v0"] = value
    return replace(scene, **changes)


def _count_equal(before: Sequence[Event], after: Sequence[Event]) -> int:
    """Return for how many events from the start two lists agree in kind, boundary and the mode that
    follows.
    """
    for i, (a, b) in enumerate(zip(before, after, strict=False)):
        if (a.kind, a.boundary, a.target) != (b.kind, b.boundary, b.target):
            return i
    return min(len(before), len(after))
