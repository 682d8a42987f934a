"""Score a solver's events: each case judged event by event, with an error unit set by the problem.

`formats.txt`, the README of a set of cases, has the rules. Events of one kind at one belt are
paired within a window of time, in order and as many as possible: so one missed event does not shift
all later ones, and of repeated reports the nearest counts. What is left over on both sides at one
time is an event of a wrong kind, or at another belt; the rest is missed, or invented. A derivative
has about the square of the condition of its event.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import inf, isfinite, pi, sqrt
from typing import Any, NamedTuple

from tabulate import tabulate

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact
from symosc.crosschecks.events import RETURNS, WINDOW, in_order
from symosc.reference.case import KnownEvent, ReferenceCase, relative_error
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
        said = {
            "missed": self.wanted,
            "invented": self.found,
            "wrong kind": f"{self.found}, not {self.wanted}",
        }
        return f"{self.fault}: {said.get(self.fault, self.wanted)} at t = {self.t:.10g}"


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

    def note_invented(self, t: float, found: str, count: int = 1) -> None:
        """Note events that the reference does not have, from the time t on."""
        self.invented += count
        self.wrong.append(Wrong("invented", t, "", found))

    def note_kind(self, t: float, wanted: str, found: str) -> None:
        """Note an event of a wrong kind, or at another belt."""
        self.kinds += 1
        self.wrong.append(Wrong("wrong kind", t, wanted, found))

    def note_error(self, t: float, wanted: str, found: str) -> None:
        """Note an event with too large an error."""
        self.late += 1
        self.wrong.append(Wrong("error", t, wanted, found))

    @property
    def right(self) -> bool:
        """Whether the results are there and complete, with no fault."""
        return self.given and not self.wrong and not self.without_x

    def as_dict(self) -> Record:
        """Return plain data for JSON."""
        plain = {name: value for name, value in self.__dict__.items() if name != "wrong"}
        return plain | {"right": self.right, "wrong": [each._asdict() for each in self.wrong]}


@dataclass
class Score:
    """The scores of a solver, case by case."""

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
        if result is None:
            judged.note = ""
        else:
            judged.note = result.note
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


class _Judge:
    """Compares a solver's events with those of a case and writes errors and faults into the
    CaseScore `judged`.
    """

    def __init__(self, case: ReferenceCase, judged: CaseScore, tolerance: float) -> None:
        self.case = case
        self.judged = judged
        self.tolerance = tolerance
        self.times = [float(event.middle[0]) for event in case.events]
        self.period = 2 * pi / float(case.parameters.Omega)

    def judge(self, events: Sequence[GivenEvent]) -> None:
        """Pair a solver's events with the case's.

        Note too large errors, and missed, invented and wrong events.
        """
        case = self.case
        judged = self.judged
        found = self._of_last_period(events)
        placed = [event._replace(boundary=self._boundary(event)) for event in found]
        pairs = align(placed, case.events, self.times, WINDOW * self.period)
        for i, j in pairs:
            self._measure(i, found[j])
        lost = sorted(set(range(len(case.events))) - {i for i, _ in pairs})
        extra = sorted(set(range(len(found))) - {j for _, j in pairs})
        # Solvers list a start on a belt, which is no event.
        near = self.tolerance * self.period + ROUNDING_UNIT * UNITS_ALLOWED * abs(float(case.t0))
        on_belt = case.v0 in (case.parameters.v1, case.parameters.v2)
        if on_belt and extra and abs(float(found[extra[0]].t - case.t0)) <= near:
            extra = extra[1:]
        # A graze may be left out, or stand as two contacts.
        reach = sqrt(self.tolerance) / float(case.parameters.Omega)
        for i in [i for i in lost if case.events[i].kind == "graze"]:
            lost.remove(i)
            close = [j for j in extra if abs(float(found[j].t) - self.times[i]) <= reach]
            belts = {found[j].boundary for j in close} <= {0, case.events[i].boundary}
            if belts and tuple(found[j].kind for j in close) in RETURNS:
                extra = [j for j in extra if j not in close]
        # The others that are together are of a wrong kind.
        times = [self.times[i] for i in lost]
        other = [found[j]._replace(kind="", boundary=0) for j in extra]
        unknown = [GivenEvent(Fraction(0), None, "", 0)] * len(lost)
        wrong = [
            (lost[i], extra[j]) for i, j in align(other, unknown, times, KIND_WINDOW * self.period)
        ]
        for i, j in wrong:
            judged.note_kind(self.times[i], _event_text(case.events[i]), _event_text(found[j]))
        for i in sorted(set(lost) - {i for i, _ in wrong}):
            judged.note_missed(self.times[i], _event_text(case.events[i]))
        for j in sorted(set(extra) - {j for _, j in wrong}):
            judged.note_invented(float(found[j].t), _event_text(found[j]))

    def _of_last_period(self, events: Sequence[GivenEvent]) -> Sequence[GivenEvent]:
        """Return the events to judge one by one: all, or those of the last period if the case knows
        no others.
        """
        uncompared = self.case.count - len(self.case.events)
        if not uncompared:
            return events
        begin = self.times[0] - WINDOW * self.period
        last = [event for event in events if event.t > begin]
        before = len(events) - len(last)
        number = abs(before - uncompared)
        if number > 1:
            text = f"{number} events"
        else:
            text = "an event"
        if 0 < before < uncompared:
            self.judged.note_missed(begin, text, number)
        elif before > uncompared:
            self.judged.note_invented(begin, text, number)
        return last

    def _boundary(self, event: GivenEvent) -> int:
        """Return the belt of a solver's event or, if not given, of the case's nearest event of the
        same kind.
        """
        same = [i for i, known in enumerate(self.case.events) if known.kind == event.kind]
        if event.boundary or not same:
            return event.boundary
        return self.case.events[
            min(same, key=lambda i: abs(self.times[i] - float(event.t)))
        ].boundary

    def _measure(self, i: int, event: GivenEvent) -> None:
        """Measure the errors of a solver's event against the case's event i.

        Note a fault if one is too large.
        """
        known = self.case.events[i]
        judged = self.judged
        t, x = known.middle
        errors = [relative_error(event.t, t, self.case.t0)]
        if known.kind == "graze":
            judged.grazes_found += 1
            allowed = [sqrt(self.tolerance)]
        else:
            unit = max(1.0, self.case.conditions[i]) * ROUNDING_UNIT
            of_clock = ROUNDING_UNIT * float(abs(t)) / max(1.0, float(t - self.case.t0))
            units = [max(unit, of_clock), unit]
            judged.error_t = max(judged.error_t or 0.0, errors[0])
            if event.x is None:
                judged.without_x += 1
            else:
                errors.append(relative_error(event.x, x))
                judged.error_x = max(judged.error_x or 0.0, errors[1])
            judged.units = max(
                judged.units or 0.0, *(e / u for e, u in zip(errors, units, strict=False))
            )
            allowed = [max(self.tolerance, UNITS_ALLOWED * each) for each in units]
        self._derivatives(i, event)
        late = [pair for pair in zip(errors, allowed, strict=False) if pair[0] > pair[1]]
        if late:
            error, limit = max(late)
            what = f"{_event_text(known)}, error {error:.1e}, allowed {limit:.1e}"
            judged.note_error(float(t), what, _event_text(event))

    def _derivatives(self, i: int, event: GivenEvent) -> None:
        """Judge the derivatives that a solver gives of the case's event i, where the case has them
        too.
        """
        judged = self.judged
        known = self.case.events[i]
        condition = self.case.conditions[i]
        allowed = max(self.tolerance, UNITS_ALLOWED * ROUNDING_UNIT * max(1.0, condition) ** 2)
        worst = (0.0, "")
        for name, change in self.case.derivatives[i].items() if condition < inf else ():
            exact = float(change.dt[0]), float(change.dx[0])
            for of, value in zip("tx", exact, strict=True):
                found = event.changes.get(f"d{of}_{name}")
                if found is None:
                    continue
                if of == "t":
                    scale = max(1.0, abs(value))
                else:
                    scale = max(1.0, *map(abs, exact), abs(float(known.middle[1])))
                error = abs(found - value) / scale
                if not isfinite(error):
                    error = inf
                judged.derivatives += 1
                judged.wrong_derivatives += error > allowed
                judged.error_d = max(judged.error_d or 0.0, error)
                worst = max(worst, (error, f"d{of}/d{name}"))
        if worst[0] > allowed:
            what = (
                f"{worst[1]} of {_event_text(known)}, error {worst[0]:.1e}, allowed {allowed:.1e}"
            )
            judged.wrong.append(Wrong("derivative", self.times[i], what, ""))


def align(
    found: Sequence[Any], reference: Sequence[Any], times: Sequence[float], window: float
) -> list[tuple[int, int]]:
    """Pair events of the same kind and belt, at most `window` apart in time.

    Return pairs (reference, found).

    There are as many pairs as possible and, among such choices, the times are nearest. `times` are
    those of the reference.
    """
    # Those found are in order of time.
    found_times = [float(event.t) for event in found]
    pairs = []
    for i, (event, time) in enumerate(zip(reference, times, strict=True)):
        for j in range(
            bisect_left(found_times, time - window), bisect_right(found_times, time + window)
        ):
            if (found[j].kind, found[j].boundary) == (event.kind, event.boundary):
                pairs.append((i, j, abs(found_times[j] - time)))
    return in_order(pairs)


def _event_text(event: KnownEvent | GivenEvent) -> str:
    """Return an event as text, such as "stick at belt 1"."""
    return f"{event.kind}{f' at belt {event.boundary}' if event.boundary else ''}"


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
        faults = [short_number(case.units) if case.units is not None else "right"]
    return ", ".join(["no x"] * bool(case.without_x) + faults)


def group_cell(cases: Sequence[CaseScore]) -> str:
    """Return a solver's result for a group as text: how many cases are right, and their largest
    error.
    """
    given = [case for case in cases if case.given]
    right = [case for case in cases if case.right]
    if not given:
        return next((case.note for case in cases if case.note), NO_RESULT)
    units = [case.units for case in right if case.units is not None]
    if units:
        largest = f": {short_number(max(units))}"
    else:
        largest = ""
    absent = len(cases) - len(given)
    return f"{len(right)} of {len(cases)}{largest}{f' ({absent} without result)' if absent else ''}"


def short_number(value: float) -> str:
    """Return a number as short text: "12", or "3e+05" from 1000 on."""
    if value < 1000:
        return f"{value:.2g}"
    return f"{value:.0e}"


def group_table(scores: Sequence[Score], form: str = "simple") -> str:
    """Return a table with a row per group, one for all cases, and rows with the numbers of faults."""
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
    times = [[case.seconds for case in score.given if case.seconds is not None] for score in scores]
    if any(times):
        rows.append(["seconds", "", *(f"{sum(each):.3g}" if each else "" for each in times)])
    heads = ["group", "cases", *(score.name for score in scores)]
    return tabulate(rows, heads, tablefmt=form, disable_numparse=True)


def case_table(scores: Sequence[Score], form: str = "simple", with_absent: bool = True) -> str:
    """Return a table with a row per case.

    A single solver's table also has its errors and seconds.
    """
    heads = ["case", "events", "condition", *(score.name for score in scores)]
    rows = []
    alone = len(scores) == 1
    for i, case in enumerate(scores[0].cases):
        if not (
            with_absent or any(score.cases[i].given or score.cases[i].note for score in scores)
        ):
            continue
        row = [case.name, str(case.events), f"{case.condition:.0e}" if case.condition else ""]
        row += [case_cell(score.cases[i]) for score in scores]
        numbers = [
            "" if value is None else f"{value:.0e}"
            for value in (case.error_t, case.error_x, case.seconds)
        ]
        rows.append(row + numbers if alone else row)
    if alone:
        heads += ["error of t", "error of x", "seconds"]
    return tabulate(rows, heads, tablefmt=form, disable_numparse=True)


def faults(score: Score) -> list[str]:
    """Return the faults of a solver as lines: the first 40, and how many more there are."""
    found = [f"{case.name}: {wrong}" for case in score.given for wrong in case.wrong]
    if len(found) > MOST_LISTED_FAULTS:
        more = [f"and {len(found) - MOST_LISTED_FAULTS} more; --json has all"]
    else:
        more = []
    return [*found[:MOST_LISTED_FAULTS], *more]


def verdict(score: Score) -> str:
    """Return the result of all cases in one line."""
    given = score.given
    right = sum(case.right for case in given)
    wrong = sum(bool(case.wrong) for case in given)
    half = len(given) - right - wrong
    absent = len(score.cases) - len(given)
    parts = [f"right in {'all' if right == len(given) > 1 else f'{right} of'} {len(given)} cases"]
    parts += [f"wrong in {wrong}"] * bool(wrong)
    parts += [f"half judged in {half}, where x is not given"] * bool(half)
    if absent:
        rest = f"; {absent} case{'s' if absent > 1 else ''} without results"
    else:
        rest = ""
    return f"{score.name}: {', '.join(parts)}{rest}"


def legend(score: Score) -> list[str]:
    """Return lines that explain the numbers of a score."""
    return [
        "Numbers: the largest error of time, relative to max(1, t - t0), and of position, "
        "relative to max(1, |x|), in "
        "units of max(1, condition) * 1e-16, which is what rounding the problem's numbers to "
        "doubles does. 'right': "
        "nothing happens in the case, and nothing is reported. 'no x': positions are not given, "
        "and not judged.",
        "A case is right if no event is missed, invented or of a wrong kind, and no error is "
        f"above {score.tolerance:g}"
        f" or {UNITS_ALLOWED:g} units, if that is more; every event has its x, and the case is "
        "followed to its end. "
        "Grazes that are not reported are no faults.",
    ]


def as_text(scores: Sequence[Score]) -> str:
    """Return the whole score as text for the terminal."""
    found = [
        [f"{score.name}, faults:", *(f"  {line}" for line in lines)]
        for score in scores
        if (lines := faults(score))
    ]
    parts = [case_table(scores, with_absent=False), group_table(scores), *map("\n".join, found)]
    return "\n\n".join([*parts, "\n".join(legend(scores[0])), "\n".join(map(verdict, scores))])
