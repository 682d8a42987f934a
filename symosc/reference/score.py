"""Score a solver's events: each case judged event by event, with an error unit set by the problem.

`formats.txt`, the README of a set of cases, has the rules. Events of one kind at one belt are
paired within a window of time, in order and as many as possible: so one missed event does not shift
all later ones, and of repeated reports the nearest counts. What is left over on both sides at one
time is an event of a wrong kind, or at another belt; the rest is missed, or invented. A derivative
has about the square of the condition of its event.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import inf, isfinite, pi, sqrt
from typing import NamedTuple

from tabulate import tabulate

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact
from symosc.crosschecks.events import RETURNS, WINDOW
from symosc.crosschecks.match import match_events
from symosc.reference.case import ReferenceCase, relative_error
from symosc.reference.results import CaseResult, GivenEvent, Results

#: The error that an event may have.
SCORE_TOLERANCE = 1e-9
#: The unit of errors, per condition; and how many units an error may have where that is more than
#: the tolerance.
ROUNDING_UNIT = 1e-16
UNITS_ALLOWED = 100.0
#: An event of a wrong kind stands for a missed one if it is nearer to it than this, in forcing
#: periods.
KIND_WINDOW = 0.005


class Wrong(NamedTuple):
    """A fault of a solver: its kind and time, the event wanted by the reference, and the one found
    ("": none).
    """

    fault: str
    t: float
    wanted: str
    found: str

    def __str__(self) -> str:
        """Return the fault in words."""
        if self.fault == "ends early":
            return f"ends at t = {self.t:.10g}, before t_end = {self.wanted}"
        if self.fault == "invented":
            event = self.found
        elif self.fault == "wrong kind":
            event = f"{self.found}, not {self.wanted}"
        else:
            event = self.wanted
        return f"{self.fault}: {event} at t = {self.t:.10g}"


@dataclass
class CaseScore:
    """The faults and errors in a solver's results for a case.

    `given` is false if the solver has no results for it.
    """

    name: str
    group: str
    events: int
    condition: float
    given: bool = True
    missed: int = 0  # events of the reference that were not found
    invented: int = 0  # found events that are none of the reference
    kinds: int = 0  # events of a wrong kind or at another belt
    late: int = 0  # events with too large an error
    without_x: int = 0  # events judged by their time alone
    stopped: float | None = None  # where the results end, if that is before the case does
    grazes: int = 0
    grazes_found: int = 0
    error_t: float | None = None
    error_x: float | None = None
    units: float | None = None  # largest error in units
    known_derivatives: int = 0  # of the case
    derivatives: int = 0  # of the known ones, those that were judged
    wrong_derivatives: int = 0
    error_d: float | None = None  # largest error of a derivative
    seconds: float | None = None
    note: str = ""
    wrong: list[Wrong] = field(default_factory=list)

    def note_missed(self, t: float, wanted: str, count: int = 1) -> None:
        """Note events of the reference that were not found, from the time t on."""
        self.missed += count
        self.wrong.append(Wrong("missed", t, wanted, ""))

    def note_invented(self, t: float, reported: str, count: int = 1) -> None:
        """Note events that the reference does not have, from the time t on."""
        self.invented += count
        self.wrong.append(Wrong("invented", t, "", reported))

    def note_kind(self, t: float, wanted: str, reported: str) -> None:
        """Note an event of a wrong kind, or at another belt."""
        self.kinds += 1
        self.wrong.append(Wrong("wrong kind", t, wanted, reported))

    def note_error(self, t: float, wanted: str, reported: str) -> None:
        """Note an event with too large an error."""
        self.late += 1
        self.wrong.append(Wrong("error", t, wanted, reported))

    @property
    def right(self) -> bool:
        """Whether the results are there and complete, with no fault."""
        return self.given and not self.wrong and not self.without_x

    def as_dict(self) -> Record:
        """Return plain data for JSON."""
        plain = {name: value for name, value in self.__dict__.items() if name != "wrong"}
        return plain | {"right": self.right, "wrong": [wrong._asdict() for wrong in self.wrong]}


@dataclass
class Score:
    """The scores of a solver, case by case."""

    _made_by = "symosc.reference.score.score(...)"

    name: str
    tolerance: float
    cases: list[CaseScore]

    @property
    def given(self) -> list[CaseScore]:
        """The cases for which the solver has results."""
        return [case for case in self.cases if case.given]

    @property
    def ok(self) -> bool:
        """Whether all results that are there are complete and right."""
        return all(case.right for case in self.given)

    def as_dict(self) -> Record:
        """Return plain data for JSON."""
        count = {
            "cases": len(self.cases),
            "given": len(self.given),
            "right": sum(case.right for case in self.cases),
        }
        about: Record = {"solver": self.name, "ok": self.ok, "tolerance": self.tolerance}
        return about | count | {"results": [case.as_dict() for case in self.cases]}


@dataclass(frozen=True)
class Totals:
    """What a solver's results for all cases count up to."""

    missed: int
    invented: int
    kinds: int
    late: int
    derivatives: int
    wrong_derivatives: int
    grazes: int
    grazes_found: int

    @classmethod
    def of(cls, score: Score) -> Totals:
        """Return the totals of a score."""
        cases = score.given
        return cls(
            missed=sum(case.missed for case in cases),
            invented=sum(case.invented for case in cases),
            kinds=sum(case.kinds for case in cases),
            late=sum(case.late for case in cases),
            derivatives=sum(case.derivatives for case in cases),
            wrong_derivatives=sum(case.wrong_derivatives for case in cases),
            grazes=sum(case.grazes for case in cases),
            grazes_found=sum(case.grazes_found for case in cases),
        )


def read_tolerance(value: object) -> float:
    """Return a tolerance, a number > 0 and at most 1."""
    number = read_exact("tolerance", value)
    if not 0 < number <= 1:
        raise ParameterError("tolerance", value, "must be > 0 and at most 1")
    return float(number)


def score(
    name: str, cases: Sequence[ReferenceCase], results: Results, tolerance: float = SCORE_TOLERANCE
) -> Score:
    """Return the score of solver `name`.

    Errors up to `tolerance`, or 100 * condition * 1e-16 if more, are allowed.
    """
    return Score(
        name, tolerance, [judge_case(case, results.get(case.name), tolerance) for case in cases]
    )


def judge_case(case: ReferenceCase, result: CaseResult | None, tolerance: float) -> CaseScore:
    """Judge a solver's results for a case; `result` is None if there are none."""
    given = result is not None and not result.note
    judged = CaseScore(case.name, case.group, case.count, case.condition, given=given)
    judged.grazes = sum(event.kind == "graze" for event in case.events)
    regular = (
        row
        for row, condition in zip(case.derivatives, case.conditions, strict=True)
        if condition < inf
    )
    judged.known_derivatives = sum(2 * len(row) for row in regular)
    if result is None or result.note:
        judged.note = "" if result is None else result.note
        return judged
    judged.seconds = result.seconds
    _Judge(case, judged, tolerance).judge(result.events)
    end = result.end
    t_end = case.t_end
    if end is not None and end < t_end and relative_error(end, t_end, case.t0) > tolerance:
        judged.stopped = float(end)
        judged.wrong.append(
            Wrong("ends early", float(end), f"{float(t_end):.10g}", f"{float(end):.10g}")
        )
    judged.wrong.sort(key=lambda wrong: wrong.t)
    return judged


class MatchedEvent(NamedTuple):
    """What the matcher sees of an event: its time, kind and belt."""

    t: float
    kind: str
    boundary: int


class _Judge:
    """Compares a solver's events with those of a case and writes errors and faults into the
    CaseScore `judged`.
    """

    def __init__(self, case: ReferenceCase, judged: CaseScore, tolerance: float) -> None:
        self.case = case
        self.judged = judged
        self.tolerance = tolerance
        self.known = [
            MatchedEvent(float(event.middle[0]), event.kind, event.boundary)
            for event in case.events
        ]
        self.period = 2 * pi / float(case.parameters.Omega)

    def judge(self, events: Sequence[GivenEvent]) -> None:
        """Pair a solver's events with the case's.

        Note too large errors, and missed, invented and wrong events.
        """
        compared = self._of_last_period(events)
        theirs = [MatchedEvent(float(event.t), event.kind, event.boundary) for event in compared]
        matching = match_events(theirs, self.known, WINDOW * self.period)
        for j, i in matching.matched:
            self._measure(i, compared[j])
        extra = self._without_start(compared, matching.invented)
        lost, extra = self._without_grazes(theirs, matching.missed, extra)
        # An extra event close to a lost one is that event, of a wrong kind.
        of_any_kind = [theirs[j]._replace(kind="", boundary=0) for j in extra]
        lost_events = [self.known[i] for i in lost]
        second_matching = match_events(of_any_kind, lost_events, KIND_WINDOW * self.period)
        for j, i in second_matching.matched:
            known = lost_events[i]
            self.judged.note_kind(known.t, _event_text(known), _event_text(theirs[extra[j]]))
        for i in second_matching.missed:
            self.judged.note_missed(lost_events[i].t, _event_text(lost_events[i]))
        for j in second_matching.invented:
            event = theirs[extra[j]]
            self.judged.note_invented(event.t, _event_text(event))

    def _without_start(self, events: Sequence[GivenEvent], extra: list[int]) -> list[int]:
        """Return which extra events are left without that of a start on a belt: solvers list it,
        but it is no event.
        """
        case = self.case
        if not extra or not case.parameters.law.boundary_of(case.v0):
            return extra
        reach = self.tolerance * self.period + ROUNDING_UNIT * UNITS_ALLOWED * abs(float(case.t0))
        if abs(float(events[extra[0]].t - case.t0)) <= reach:
            return extra[1:]
        return extra

    def _without_grazes(
        self, theirs: Sequence[MatchedEvent], lost: list[int], extra: list[int]
    ) -> tuple[list[int], list[int]]:
        """Return which events are lost and which are extra if a graze may be left out, or stand as
        two contacts.
        """
        # At a graze an error e of the gap moves contacts by about sqrt(e).
        reach = sqrt(self.tolerance) / float(self.case.parameters.Omega)
        for i in lost:
            graze = self.known[i]
            if graze.kind != "graze":
                continue
            close = [j for j in extra if abs(theirs[j].t - graze.t) <= reach]
            at_one_belt = {theirs[j].boundary for j in close} <= {0, graze.boundary}
            if at_one_belt and tuple(theirs[j].kind for j in close) in RETURNS:
                extra = [j for j in extra if j not in close]
        return [i for i in lost if self.known[i].kind != "graze"], extra

    def _of_last_period(self, events: Sequence[GivenEvent]) -> Sequence[GivenEvent]:
        """Return the events to judge one by one: all, or those of the last period if the case knows
        no others.
        """
        uncompared = self.case.count - len(self.case.events)
        if not uncompared:
            return events
        begin = self.known[0].t - WINDOW * self.period
        last = [event for event in events if event.t > begin]
        before = len(events) - len(last)
        lacking = uncompared - before
        if before == 0:
            return last  # a list may have the last period alone
        if lacking > 0:
            self.judged.note_missed(begin, _count_text(lacking), lacking)
        elif lacking < 0:
            self.judged.note_invented(begin, _count_text(-lacking), -lacking)
        return last

    def _measure(self, i: int, event: GivenEvent) -> None:
        """Measure the errors of a solver's event against the case's event i.

        Note a fault if one is too large.
        """
        known = self.case.events[i]
        judged = self.judged
        t, x = known.middle
        error_t = relative_error(event.t, t, self.case.t0)
        if known.kind == "graze":
            judged.grazes_found += 1
            errors = [(error_t, sqrt(self.tolerance))]
        else:
            unit = max(1.0, self.case.conditions[i]) * ROUNDING_UNIT
            # A time far from 0 is rounded by more than its condition says: by its own size.
            unit_of_clock = ROUNDING_UNIT * float(abs(t)) / max(1.0, float(t - self.case.t0))
            unit_t = max(unit, unit_of_clock)
            errors = [(error_t, self._allowed(unit_t))]
            judged.error_t = _larger(judged.error_t, error_t)
            judged.units = _larger(judged.units, error_t / unit_t)
            if event.x is None:
                judged.without_x += 1
            else:
                error_x = relative_error(event.x, x)
                errors.append((error_x, self._allowed(unit)))
                judged.error_x = _larger(judged.error_x, error_x)
                judged.units = _larger(judged.units, error_x / unit)
        self._judge_derivatives(i, event)
        too_large = [(error, allowed) for error, allowed in errors if error > allowed]
        if too_large:
            error, allowed = max(too_large)
            text = _event_text(self.known[i])
            wanted = f"{text}, error {error:.1e}, allowed {allowed:.1e}"
            judged.note_error(float(t), wanted, _event_text(event))

    def _allowed(self, unit: float) -> float:
        """Return the error that is allowed where the unit of errors is `unit`."""
        return max(self.tolerance, UNITS_ALLOWED * unit)

    def _judge_derivatives(self, i: int, event: GivenEvent) -> None:
        """Judge the derivatives that a solver gives of the case's event i, where the case has them
        too.
        """
        condition = self.case.conditions[i]
        if condition == inf:
            return
        judged = self.judged
        _, x_middle = self.case.events[i].middle
        x = float(x_middle)
        allowed = self._allowed(ROUNDING_UNIT * max(1.0, condition) ** 2)
        worst = (0.0, "")
        for name, change in self.case.derivatives[i].items():
            # The ends of an enclosure are much closer to each other than what is allowed.
            dt_low, _ = change.dt
            dx_low, _ = change.dx
            dt = float(dt_low)
            dx = float(dx_low)
            scale_t = max(1.0, abs(dt))
            scale_x = max(scale_t, abs(dx), abs(x))
            for coordinate, exact, scale in (("t", dt, scale_t), ("x", dx, scale_x)):
                derivative = event.changes.get(f"d{coordinate}_{name}")
                if derivative is None:
                    continue
                error = abs(derivative - exact) / scale
                if not isfinite(error):
                    error = inf
                judged.derivatives += 1
                judged.wrong_derivatives += error > allowed
                judged.error_d = _larger(judged.error_d, error)
                worst = max(worst, (error, f"d{coordinate}/d{name}"))
        error, symbol = worst
        if error > allowed:
            text = f"{symbol} of {_event_text(self.known[i])}"
            wanted = f"{text}, error {error:.1e}, allowed {allowed:.1e}"
            judged.wrong.append(Wrong("derivative", self.known[i].t, wanted, ""))


def _larger(largest: float | None, error: float) -> float:
    """Return the larger of the largest error so far (None if there is none) and another one."""
    return max(largest or 0.0, error)


def _count_text(number: int) -> str:
    """Return how many events, such as "an event" or "3 events"."""
    if number == 1:
        return "an event"
    return f"{number} events"


def _event_text(event: MatchedEvent | GivenEvent) -> str:
    """Return an event as text, such as "stick at belt 1"."""
    if event.boundary:
        return f"{event.kind} at belt {event.boundary}"
    return event.kind


def by_group(cases: Sequence[CaseScore]) -> Iterator[tuple[str, list[CaseScore]]]:
    """Yield groups and their cases, in order."""
    for group in dict.fromkeys(case.group for case in cases):
        yield group, [case for case in cases if case.group == group]


# -- text: a row per group and a row per case, a column per solver ---------------------------------

#: Faults of a solver that are listed one by one.
MOST_LISTED_FAULTS = 40
NO_RESULT = "no result"


def case_cell(case: CaseScore) -> str:
    """Return a solver's result for a case as short text: its faults or, if there are none, its
    largest error.
    """
    if not case.given:
        return case.note or NO_RESULT
    counts = {"missed": case.missed, "invented": case.invented, "wrong kind": case.kinds}
    faults = [f"{name} {count}" for name, count in counts.items() if count]
    if case.late:
        faults.append(f"error {max(case.error_t or 0.0, case.error_x or 0.0):.0e}")
    if case.wrong_derivatives:
        count = f"{case.wrong_derivatives} of {case.derivatives}"
        faults.append(f"derivatives {count} wrong, {case.error_d:.0e}")
    if case.stopped is not None:
        faults.append(f"ends at t = {case.stopped:g}")
    if not faults:
        faults.append("right" if case.units is None else short_number(case.units))
    if case.without_x:
        faults.insert(0, "no x")
    return ", ".join(faults)


def group_cell(cases: Sequence[CaseScore]) -> str:
    """Return a solver's result for a group as text: how many cases are right, and their largest
    error.
    """
    given = [case for case in cases if case.given]
    right = [case for case in cases if case.right]
    if not given:
        return next((case.note for case in cases if case.note), NO_RESULT)
    text = f"{len(right)} of {len(cases)}"
    units = [case.units for case in right if case.units is not None]
    if units:
        text += f": {short_number(max(units))}"
    absent = len(cases) - len(given)
    if absent:
        text += f" ({absent} without result)"
    return text


def short_number(value: float) -> str:
    """Return a number as short text: "12", or "3e+05" from 1000 on."""
    if value < 1000:
        return f"{value:.2g}"
    return f"{value:.0e}"


def group_table(scores: Sequence[Score], form: str = "simple") -> str:
    """Return a table with a row per group, one for all cases, and rows of numbers of faults."""
    rows = []
    for group, cases in by_group(scores[0].cases):
        columns = [
            group_cell([case for case in score.cases if case.group == group]) for score in scores
        ]
        rows.append([group, str(len(cases)), *columns])
    right = [f"{sum(case.right for case in score.cases)} of {len(score.cases)}" for score in scores]
    rows.append(["all", str(len(scores[0].cases)), *right])
    totals = [Totals.of(score) for score in scores]
    rows.append(["events missed", "", *(str(total.missed) for total in totals)])
    rows.append(["events invented", "", *(str(total.invented) for total in totals)])
    rows.append(["wrong kinds", "", *(str(total.kinds) for total in totals)])
    rows.append(["large errors", "", *(str(total.late) for total in totals)])
    if any(total.derivatives for total in totals):
        wrong = [f"{total.wrong_derivatives:,} of {total.derivatives:,}" for total in totals]
        rows.append(["wrong derivatives", "", *wrong])
    grazes = [f"{total.grazes_found} of {total.grazes}" for total in totals]
    rows.append(["grazes reported", "", *grazes])
    times = [_seconds_text(score) for score in scores]
    if any(times):
        rows.append(["seconds", "", *times])
    heads = ["group", "cases", *(score.name for score in scores)]
    return tabulate(rows, heads, tablefmt=form, disable_numparse=True)


def _seconds_text(score: Score) -> str:
    """Return the seconds that a solver took for all cases; "" if it does not say."""
    seconds = [case.seconds for case in score.given if case.seconds is not None]
    if seconds:
        return f"{sum(seconds):.3g}"
    return ""


def case_table(scores: Sequence[Score], form: str = "simple", with_absent: bool = True) -> str:
    """Return a table with a row per case.

    A single solver's table also has its errors and seconds.
    """
    heads = ["case", "events", "condition", *(score.name for score in scores)]
    alone = len(scores) == 1
    if alone:
        heads += ["error of t", "error of x", "seconds"]
    rows = []
    for cases in zip(*(score.cases for score in scores), strict=True):
        if not with_absent and not any(case.given or case.note for case in cases):
            continue
        case = cases[0]
        condition = one_digit(case.condition or None)
        row = [case.name, str(case.events), condition, *map(case_cell, cases)]
        if alone:
            row += map(one_digit, (case.error_t, case.error_x, case.seconds))
        rows.append(row)
    return tabulate(rows, heads, tablefmt=form, disable_numparse=True)


def one_digit(value: float | None) -> str:
    """Return a number with one digit, such as "3e-12"; "" for None."""
    if value is None:
        return ""
    return f"{value:.0e}"


def faults(score: Score) -> list[str]:
    """Return the faults of a solver as lines: the first ones (MOST_LISTED_FAULTS at most), and how
    many more there are.
    """
    lines = [f"{case.name}: {wrong}" for case in score.given for wrong in case.wrong]
    more = len(lines) - MOST_LISTED_FAULTS
    if more > 0:
        lines[MOST_LISTED_FAULTS:] = [f"and {more} more; --json has all"]
    return lines


def verdict(score: Score) -> str:
    """Return the result of all cases in one line."""
    given = score.given
    right = sum(case.right for case in given)
    wrong = sum(bool(case.wrong) for case in given)
    half = len(given) - right - wrong
    absent = len(score.cases) - len(given)
    if right == len(given) > 1:
        parts = [f"right in all {right} cases"]
    else:
        parts = [f"right in {right} of {len(given)} cases"]
    if wrong:
        parts.append(f"wrong in {wrong}")
    if half:
        parts.append(f"half judged in {half}, where x is not given")
    text = f"{score.name}: {', '.join(parts)}"
    if absent == 1:
        text += "; 1 case without results"
    elif absent:
        text += f"; {absent} cases without results"
    return text


def legend(score: Score) -> list[str]:
    """Return lines that explain the numbers of a score."""
    return [
        "Numbers: the largest error of time, relative to max(1, t - t0), and of position, "
        "relative to max(1, |x|), in units of max(1, condition) * 1e-16, which is what rounding "
        "the problem's numbers to doubles does. 'right': nothing happens in the case, and nothing "
        "is reported. 'no x': positions are not given, and not judged.",
        "A case is right if no event is missed, invented or of a wrong kind, and no error is "
        f"above {score.tolerance:g} or {UNITS_ALLOWED:g} units, if that is more; every event has "
        "its x, and the case is followed to its end. Grazes that are not reported are no faults.",
    ]


def as_text(scores: Sequence[Score]) -> str:
    """Return the whole score as text for the terminal."""
    parts = [case_table(scores, with_absent=False), group_table(scores)]
    for score in scores:
        lines = faults(score)
        if lines:
            indented = [f"  {line}" for line in lines]
            parts.append("\n".join([f"{score.name}, faults:", *indented]))
    parts += ["\n".join(legend(scores[0])), "\n".join(map(verdict, scores))]
    return "\n\n".join(parts)
