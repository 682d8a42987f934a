"""Scores and the comparison of events: each fault is named, and nothing else."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from fractions import Fraction
from math import inf, nan, pi, sqrt
from pathlib import Path

import pytest
from small_set import NAMES, right, small_set

from symosc import ParameterError, simulate_many
from symosc.reference.case import ReferenceCase, with_known
from symosc.reference.results import CaseResult, GivenEvent, read_results
from symosc.reference.score import (
    KIND_WINDOW,
    SCORE_TOLERANCE,
    UNITS_ALLOWED,
    CaseScore,
    Score,
    as_text,
    case_cell,
    judge_case,
    read_tolerance,
    score,
    verdict,
)

# -- score -----------------------------------------------------------------------------------------


FAULTS = ("missed", "invented", "kinds", "late")


def case_of(name: str) -> ReferenceCase:
    return next(case for case in small_set() if case.name == name)


def judged(case: ReferenceCase, events: list[GivenEvent]) -> CaseScore:
    return judge_case(case, CaseResult(events), SCORE_TOLERANCE)


def counts(judgement: CaseScore) -> dict[str, int]:
    return {name: getattr(judgement, name) for name in FAULTS if getattr(judgement, name)}


@pytest.mark.parametrize("name", NAMES)
def test_right_results_are_right(name: str) -> None:
    judgement = judged(case_of(name), right(case_of(name)).events)
    assert judgement.right
    assert (judgement.units, judgement.grazes_found) == (
        0.0 if judgement.events else None,
        judgement.grazes,
    )
    assert judgement.wrong == []


def with_changes(case: ReferenceCase, factor: float = 1.0) -> list[GivenEvent]:
    """Return right results with right derivatives, but the last derivative times a factor."""
    events = []
    for event, row in zip(right(case).events, case.derivatives, strict=True):
        changes = {}
        for name, change in row.items():
            changes[f"dt_{name}"] = float(change.dt[0])
            changes[f"dx_{name}"] = float(change.dx[0])
        events.append(event._replace(changes=changes))
    last = dict(events[-1].changes)
    last[list(last)[-1]] *= factor
    return [*events[:-1], events[-1]._replace(changes=last)]


def test_derivatives_are_judged_where_they_exist() -> None:
    for name in ("paper-fig6", "free-decay-2"):
        case = case_of(name)
        judgement = judged(case, with_changes(case))
        plain = list(right(case).events)
        assert judgement.right
        assert (
            judgement.derivatives
            == judgement.known_derivatives
            == sum(2 * len(row) for row in case.derivatives)
            > 70
        )
        assert all(
            change.proven for row in case.derivatives for change in row.values()
        )  # the start is exact
        last = list(case.derivatives[-1].values())[-1]
        dt = float(last.dt[0])
        dx = float(last.dx[0])
        scale = max(1.0, abs(dt), abs(dx), abs(float(case.events[-1].middle[1])))
        for factor, error in ((1 + 1e-4, 1e-4 * abs(dx) / scale), (nan, inf)):
            wrong = judged(case, with_changes(case, factor))
            assert (wrong.right, wrong.wrong_derivatives) == (False, 1)
            assert wrong.error_d == pytest.approx(error, rel=1e-3)
            assert str(wrong.wrong[0]).startswith("derivative: dx/dx0 of ")
            scores = [
                Score("mine", SCORE_TOLERANCE, [wrong]),
                Score("none", SCORE_TOLERANCE, [judged(case, plain)]),
            ]
            rows = f"wrong derivatives  .*1 of {judgement.derivatives}"
            assert all(re.search(rows, as_text(scores[:count])) for count in (1, 2))
    graze = case_of("graze-overdamped-P3")
    assert [event.kind for event in graze.events] == ["graze", "stick", "slip"]
    assert [list(row) for row in graze.derivatives] == [["v2"]] * 3  # belt 2 is never reached


def test_a_table_of_derivatives_is_read_from_what_symosc_writes(tmp_path: Path) -> None:
    case = next(each for each in small_set() if each.name == "paper-fig6")
    start = case.t0, case.x0, case.v0
    simulate_many(case.parameters, start, case.t_end, wrt=("mu2", "Omega", "x0")).to_csv(
        tmp_path / "paper-fig6.csv"
    )
    results = read_results(tmp_path, NAMES)
    judgement = judge_case(case_of("paper-fig6"), results["paper-fig6"], SCORE_TOLERANCE)
    assert (judgement.right, judgement.derivatives) == (True, 3 * 3 * 2)


def changed(
    case: ReferenceCase, change: str, rng: random.Random
) -> tuple[list[GivenEvent], dict[str, int], float]:
    """Return results with a fault, what a score must say, and the time of the fault."""
    events = right(case).events
    i = rng.choice([i for i, event in enumerate(events) if event.kind != "graze"])
    event = events[i]
    period = 2 * pi / float(case.parameters.Omega)
    others = [float(each.t) for each in events[:i] + events[i + 1 :]]
    if change == "dropped":
        return events[:i] + events[i + 1 :], {"missed": 1}, float(event.t)
    if change == "added":
        free = [
            t
            for t in (rng.uniform(float(case.t0), others[-1]) for _ in range(300))
            if _far(t, events, period)
        ]
        new = GivenEvent(Fraction(free[0]), event.x, "cross", 2)
        return [*events, new], {"invented": 1}, free[0]
    if change == "shifted":
        by = Fraction(rng.choice([-1, 1]) * rng.uniform(1e-8, 1e-6) * max(1.0, float(event.t)))
        return (
            [*events[:i], event._replace(t=event.t + by), *events[i + 1 :]],
            {"late": 1},
            float(event.t),
        )
    if change == "moved":
        if event.x is None:
            x = None
        else:
            x = event.x + Fraction(rng.uniform(1e-8, 1e-6)) * max(1, abs(event.x))
        return [*events[:i], event._replace(x=x), *events[i + 1 :]], {"late": 1}, float(event.t)
    if change == "another kind":
        kind = rng.choice(
            [kind for kind in ("cross", "stick", "slip", "graze") if kind != event.kind]
        )
        return (
            [*events[:i], event._replace(kind=kind), *events[i + 1 :]],
            {"kinds": 1},
            float(event.t),
        )
    assert change == "another belt"
    return (
        [*events[:i], event._replace(boundary=3 - event.boundary), *events[i + 1 :]],
        {"kinds": 1},
        float(event.t),
    )


def _far(t: float, events: list[GivenEvent], period: float) -> bool:
    return all(abs(t - float(event.t)) > KIND_WINDOW * period for event in events)


@pytest.mark.parametrize(
    "change", ["dropped", "added", "shifted", "moved", "another kind", "another belt"]
)
@pytest.mark.parametrize(
    "name", ["paper-fig5", "graze-overdamped-P3", "free-decay-2", "continuum-1-2"]
)
def test_one_fault_is_named_and_only_that(name: str, change: str) -> None:
    rng = random.Random(f"{name} {change}")
    case = case_of(name)
    for _ in range(10):
        events, expected, t = changed(case, change, rng)
        rng.shuffle(events)
        judgement = judged(case, sorted(events, key=lambda event: event.t))
        assert counts(judgement) == expected
        assert not judgement.right
        assert [wrong.t for wrong in judgement.wrong] == [pytest.approx(t, rel=1e-12)]


def test_errors_are_measured_in_units_of_the_condition() -> None:
    case = case_of("paper-fig5")
    events = right(case).events
    i = 4
    events[i] = events[i]._replace(t=events[i].t * (1 + Fraction(1, 10**12)))
    judgement = judged(case, events)
    assert judgement.right
    assert judgement.error_t == pytest.approx(1e-12, rel=1e-9)
    assert judgement.units == pytest.approx(1e-12 / (max(1, case.conditions[i]) * 1e-16), rel=1e-9)
    by = Fraction(1, 10**10)
    events[i] = events[i]._replace(t=events[i].t * (1 + by))
    assert judge_case(case, CaseResult(events), 1e-11).late == 1
    ill = with_known(case, conditions=tuple(1e8 for _ in case.conditions))
    allowed = UNITS_ALLOWED * 1e8 * 1e-16
    assert allowed > 1e-10
    assert judge_case(ill, CaseResult(events), 1e-11).late == 0


@pytest.mark.parametrize(
    ("kinds", "apart", "expected"),
    [
        ((), 0.0, {}),
        (("stick", "slip"), 0.5, {}),
        (("cross", "cross"), 0.5, {}),
        (("stick", "slip"), 3.0, {"invented": 2}),
        (("stick",), 0.5, {"kinds": 0, "invented": 1}),
    ],
)
def test_a_graze_may_be_nothing_or_a_short_contact(
    kinds: tuple[str, ...], apart: float, expected: dict[str, int]
) -> None:
    case = case_of("graze-overdamped-P3")
    touch, *others = right(case).events
    half = Fraction(apart * sqrt(SCORE_TOLERANCE) / float(case.parameters.Omega))
    sides = (-half, half)
    contacts = [
        touch._replace(kind=kind, t=touch.t + side)
        for kind, side in zip(kinds, sides, strict=False)
    ]
    judgement = judged(case, [*contacts, *others])
    assert counts(judgement) == {name: count for name, count in expected.items() if count}
    assert (judgement.grazes, judgement.grazes_found) == (1, 0)


def test_an_event_at_a_start_on_a_belt_is_none() -> None:
    case = case_of("paper-fig6")  # starts in a stick on belt 2
    start = GivenEvent(case.t0, None, "stick", 2)
    assert judged(case, [start, *right(case).events]).right
    assert counts(judged(case, [start, start, *right(case).events])) == {"invented": 1}
    assert counts(judged(case_of("paper-fig5"), [start, *right(case_of("paper-fig5")).events])) == {
        "invented": 1
    }


def test_belts_may_be_left_out_and_without_positions_half_is_judged() -> None:
    case = case_of("paper-fig6")
    events = right(case).events
    assert judged(case, [event._replace(boundary=0) for event in events]).right
    judgement = judged(case, [event._replace(x=None) for event in events])
    assert (judgement.right, judgement.wrong, judgement.without_x) == (False, [], len(events))
    assert (judgement.error_t, judgement.error_x, case_cell(judgement)) == (0.0, None, "no x, 0")
    whole = score(
        "mine", [case], {case.name: CaseResult([events[0]._replace(x=None), *events[1:]])}
    )
    assert not whole.ok
    assert verdict(whole) == "mine: right in 0 of 1 cases, half judged in 1, where x is not given"


@pytest.mark.parametrize("t0", [0, 10**4, 10**8, 10**10])
def test_a_late_start_is_no_excuse_for_late_events(t0: int) -> None:
    """Each time as a double is right, and right events that are 1e-3 late are not.

    Of t0 = 1e8 that is 1e-11.
    """
    case = case_of("paper-fig5")
    events = tuple(event._replace(t=(str(Fraction(event.t[0]) + t0),) * 2) for event in case.events)
    scene = replace(case.scene, t0=case.t0 + t0, t_end=case.t_end + t0)
    late = with_known(
        replace(case, scene=scene),
        events=events,
        conditions=case.conditions,
        derivatives=case.derivatives,
    )
    rounded = [event._replace(t=Fraction(float(event.t))) for event in right(late).events]
    judgement = judged(late, rounded)
    assert judgement.right
    assert judgement.units is not None
    assert judgement.units < 2
    # Doubles round Omega t0, which shifts all events: 1e-16 t0 is a unit of their times.
    for units, wrong in ((50, 0), (300, len(events))):
        shift = Fraction(units * t0, 10**16)
        judgement = judged(late, [event._replace(t=event.t + shift) for event in rounded])
        assert judgement.late == (wrong if t0 > 10**6 else 0)
    judgement = judged(late, [event._replace(t=event.t + Fraction(1, 1000)) for event in rounded])
    assert counts(judgement) == {"late": len(events)}
    assert judgement.error_t is not None
    assert 1e-5 < judgement.error_t < 2e-3
    assert case_cell(judgement) == f"error {max(judgement.error_t, judgement.error_x or 0.0):.0e}"


def test_results_that_end_early_are_not_right() -> None:
    """Also where nothing more happens after their end."""
    case = case_of("paper-fig6")
    last = float(case.events[-1].middle[0])
    for end, ok in (
        (float(case.t_end), True),
        (100.0, True),
        ((last + float(case.t_end)) / 2, False),
        (3.0, False),
    ):
        given = [event for event in right(case).events if event.t < end]
        judgement = judge_case(case, CaseResult(given, end=Fraction(end)), SCORE_TOLERANCE)
        assert judgement.right == ok
        assert (judgement.stopped is None) == ok
        if not ok:
            assert f"ends at t = {end:.10g}, before t_end = 20" in [
                str(wrong) for wrong in judgement.wrong
            ]
            assert case_cell(judgement).endswith(f"ends at t = {end:g}")


@pytest.mark.parametrize("value", ["0", "2", "nan", None])
def test_a_tolerance_is_a_small_number(value: object) -> None:
    with pytest.raises(ParameterError, match="tolerance"):
        read_tolerance(value)
