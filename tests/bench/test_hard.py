"""Our errors in the hard cases, the run of all solvers, and its table."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from math import inf
from typing import Any

import pytest
from bench_fakes import PatientWorker
from bench_moods import moody

from symosc import load_scene
from symosc.bench import hard, hard_table, ours
from symosc.bench.solvers import Solver
from symosc.reference.cases import (
    GROUPS,
    HardCase,
    hard_cases,
)

ONE_OF_EACH = {case.group: case for case in hard_cases() if case.quick}


# -- condition numbers -------------------------------------------------------------------------------------------------


# -- our errors --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.compiled("pairs")
@pytest.mark.parametrize("group", GROUPS)
def test_ours_keep_the_bound_in_every_group(group: str) -> None:
    case = ONE_OF_EACH[group]
    allowed = [hard.bound(condition) for condition in hard.conditions_of(case)]
    for solver in ours.SOLVERS:
        if solver.missing or (case.periods and "mpmath" in solver.name):
            continue
        cell = hard.judge(solver, case, allowed)
        assert (cell["missed"], cell["invented"], cell["undecidable"]) == (0, 0, None)
        assert cell["worst"] is not None
        assert cell["worst"] <= 1
        assert cell["error"] is None or 0 < cell["error"] < (1e-20 if "mpmath" in solver.name else 1e-12)


@pytest.mark.quick(4)
@pytest.mark.parametrize("group", GROUPS)
def test_a_proven_reference_is_that_of_40_digits(group: str) -> None:
    case = ONE_OF_EACH[group]
    known = hard.proof_of(case)
    assert known.reason == ""
    exact = case.reference()
    reference = hard.reference_of(case)
    assert [(e.kind, e.boundary) for e in reference] == [(e.kind, e.boundary) for e in exact]
    for event, other in zip(reference, exact, strict=True):
        assert max(hard.relative_error(event.t, other.t), hard.relative_error(event.x, other.x)) < 1e-24


def test_what_is_not_proven_is_named_with_the_reason() -> None:
    result = {"rows": [row(), row() | {"case": "b", "open": "it touches"}], "solvers": [], "skipped": {}}
    result |= {"limit_s": 2.0, "machine": {"processor": "P", "cores": "2", "date": "today"}, "violations": []}
    text = "\n".join(hard_table.legend(result))
    assert "proven (symosc.certify), in 1 of 2 cases" in text
    assert "Not proven: easy, b: it touches." in text


def test_the_bound() -> None:
    assert hard.bound(3.0) == 1e-12
    assert hard.bound(1e6) == pytest.approx(1e-8)
    assert hard.bound(inf) == inf


# -- the run and its table ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_failures_are_shown_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hard, "Worker", PatientWorker)
    monkeypatch.setattr(hard, "CASE_LIMIT", 1.5)
    scene = replace(load_scene("fig9"), t_end=Fraction(3))
    names = ("works", "misses", "invents", "refuses", "chatters", "dies", "sleeps")
    cases = [HardCase(name, "easy", replace(scene, name=name), name in ("works", "misses")) for name in names]
    solvers = [Solver("moody", moody, (1e-3, 1e-9)), Solver("as it comes", moody, (1e-6,), raw=True)]
    solvers += [Solver("absent", moody, (0.0,), needs="no_such_module"), ours.SOLVERS[1]]
    steps: list[Any] = []

    def progress(planned: Any) -> Any:
        for step in planned:
            steps.append(step)
            yield step

    result = hard.run(progress=progress, solvers=solvers, cases=cases)
    json.dumps(result)
    assert len(steps) == 7 + 7 + 2 + 7
    cells = {row["case"]: hard_table.cell_text(row["cells"]["moody"], 1.5) for row in result["rows"]}
    assert cells == {
        "works": "2e-10",
        "misses": "missed 1",
        "invents": "invented 1",
        "refuses": "exception: ValueError: not this one",
        "chatters": "chatters",
        "dies": "crash: the process ended with exit code 3",
        "sleeps": "> 1.5 s",
    }
    assert result["ok"]
    assert not result["violations"]
    text = hard.table(result)
    assert "ValueError [1]" in text
    assert "[1] exception: ValueError: not this one" in text
    assert "crash [2]" in text
    assert "2 of 7" not in text
    assert "1 of 7" in text
    raw = hard.table(result, "github", raw=True)
    assert "| `misses`" in raw
    assert "refuses" not in raw
    assert "1 of 2" in raw
    assert "1 of 7: 2e-10" in hard.summary(result)
    assert any("absent: no_such_module is not installed" in line for line in hard.legend(result))


def row(**cell: Any) -> dict[str, Any]:
    good = {"failure": "", "error": 1e-16, "missed": 0, "invented": 0, "found": 2, "worst": 0.1, "undecidable": None}
    cells = {solver.name: good | cell for solver in ours.SOLVERS[:1]}
    return {"group": "easy", "case": "a", "events": 2, "condition": 3.0, "open": "", "cells": cells}


@pytest.mark.parametrize(
    ("cell", "text"),
    [
        ({"worst": 1.5, "error": 2e-12}, "2e-12"),
        ({"worst": None, "missed": 2, "undecidable": 1}, "undecidable after 1"),
        ({"worst": None, "missed": 2, "invented": 1}, "missed 2, invented 1"),
        ({"worst": None, "failure": "exception: ZeroDivisionError"}, "exception: ZeroDivisionError"),
    ],
)
def test_what_ours_must_not_do(cell: dict[str, Any], text: str) -> None:
    assert hard.violations([row(), row(error=None), row(failure="hang", worst=None)]) == []
    assert hard.violations([row(), row(**cell)]) == [f"{ours.SOLVERS[0].name}: easy, a: {text}"]


def test_the_verdict_names_violations() -> None:
    name = ours.SOLVERS[0].name
    result = {"rows": [row(), row(error=3e-13)], "violations": [], "solvers": [{"name": name, "ours": True}]}
    assert f"{name} 2 of 2, largest error 3e-13" in hard_table.verdict(result)
    result["violations"] = [f"{name}: easy, a: 2e-12"]
    assert hard_table.verdict(result).startswith("Not within")
    assert "easy, a: 2e-12" in hard_table.verdict(result)
