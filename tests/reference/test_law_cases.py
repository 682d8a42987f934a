"""Reference cases under other friction laws: by an oracle, from their files, and as scores."""

from __future__ import annotations

import csv
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest
from effort import PATIENCE
from law_oracle import LawBelt, follow

from symosc import Belt, Oscillator, ReferenceCase, load_scene, reference_cases, simulate
from symosc.model import OSCILLATOR_NAMES
from symosc.reference.folder import read_set, write_cases
from symosc.reference.law_cases import LAW_GROUPS
from symosc.reference.results import CaseResult, GivenEvent, read_results
from symosc.reference.score import judge_case, score
from symosc.simulation.tables import rows_of

CASES = [case for case in reference_cases() if case.group in LAW_GROUPS]


def oracle_run(case: ReferenceCase, digits: int = 45, **changes: Fraction) -> object:
    """Follow a case by the oracle, perhaps with another number of its oscillator."""
    model = case.parameters.replace(**changes) if changes else case.parameters
    belts = [
        LawBelt(belt.v, None if belt.curve else belt.mu, belt.mu_s, belt.curve or None, belt.slope)
        for belt in model.law.belts
    ]
    numbers = [getattr(model, name) for name in OSCILLATOR_NAMES]
    return follow(*numbers, belts, case.t0, case.x0, case.v0, case.t_end, digits=digits)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_events_are_those_of_the_oracle(case: ReferenceCase) -> None:
    found = oracle_run(case)
    assert len(found.events) == len(case.events) >= 5
    for own, other in zip(case.events, found.events, strict=True):
        assert (own.kind, own.boundary) == (other.kind, other.boundary)
        assert (own.source, own.target) == (other.source, other.target)
        for (low, high), exact in ((own.t, other.t), (own.x, other.x)):
            with mpmath.workdps(45):
                assert mpmath.mpf(low) - exact < mpmath.mpf(10) ** -35
                assert exact - mpmath.mpf(high) < mpmath.mpf(10) ** -35
    assert case.status == case.expected_status == "proven"
    assert 0 < case.condition < 1e3


def test_the_groups_have_what_they_say() -> None:
    for case in CASES:
        kinds = {event.kind for event in case.events}
        static = any(belt.mu_s > belt.mu for belt in case.parameters.law.belts)
        if case.group == "static friction":
            assert static
            assert {"stick", "slip"} <= kinds
        else:
            assert case.parameters.law.has_curves


def test_derivatives_are_those_of_differences_of_the_oracle() -> None:
    (case,) = [case for case in CASES if case.name == "curve-stribeck"]
    step = Fraction(1, 10**15)
    for name in ("mu_s1", "w1_1"):
        value = case.parameters.numbers()[name]
        ends = [oracle_run(case, **{name: value + by}).events for by in (step, -step)]
        for n, (ahead, behind) in enumerate(zip(*ends, strict=True)):
            change = case.derivatives[n][name]
            with mpmath.workdps(45):
                slope = (ahead.t - behind.t) / (2 * mpmath.mpf(10) ** -15)
                low, high = map(mpmath.mpf, change.dt)
                assert abs(slope - low) < 1e-12 * max(1, abs(low))
                assert low <= high
            assert not change.proven


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("laws") / "set"
    return write_cases(path, [*CASES, reference_cases()[1]], workers=1)


def test_the_adapter_with_scipy_follows_them(folder: Path, tmp_path: Path) -> None:
    """It has rules of its own."""
    results = tmp_path / "theirs.csv"
    program = Path(__file__).parents[2] / "docs" / "adapters" / "with_scipy.py"
    command = [sys.executable, str(program), str(folder / "cases.csv"), str(results)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stderr[-500:]
    _, cases = read_set(folder)
    found = score("theirs", cases, read_results(results, {case.name for case in cases}))
    assert [case.name for case in found.cases if not case.right] == []
    assert max(case.error_t for case in found.cases if case.error_t is not None) < 1e-10


def test_files_are_read_as_another_program_would(folder: Path) -> None:
    _, back = read_set(folder)
    assert [case.parameters for case in back][:-1] == [case.parameters for case in CASES]
    with (folder / "cases.csv").open(newline="") as file:
        assert [row["name"] for row in csv.DictReader(file)] == ["paper-fig6"]
    with (folder / "belts.csv").open(newline="") as file:
        points = list(csv.DictReader(file))
    with (folder / "laws.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == [case.name for case in CASES]
    for row, case in zip(rows, CASES, strict=True):
        belts = []
        for n in range(1, int(row["belts"]) + 1):
            own = [p for p in points if p["name"] == row["name"] and p["belt"] == str(n)]
            curve = [(p["w"], p["mu"]) for p in own]
            belts.append(Belt(own[0]["v"], curve=curve, slope=own[0]["slope"], mu_s=own[0]["mu_s"]))
        numbers = {name: row[name] for name in OSCILLATOR_NAMES}
        assert Oscillator(**numbers, belts=belts) == case.parameters
        scene = load_scene(folder / case.name / "case.toml")
        assert scene.parameters == case.parameters
        assert [Fraction(row[name]) for name in ("t0", "x0", "v0", "t_end")] == [
            getattr(scene, name) for name in ("t0", "x0", "v0", "t_end")
        ]


def result_of(model: object, case: ReferenceCase) -> CaseResult:
    """Return what a solver hands in that follows a model from the case's start."""
    start = {name: getattr(case, name) for name in ("t0", "x0", "v0", "t_end")}
    events = simulate(model, **start).events
    rows = rows_of(0, events)
    assert rows.floats.shape[1] == len(events)
    given = [
        GivenEvent(Fraction(event.t), Fraction(event.x), event.kind, event.boundary, {})
        for event in events
    ]
    return CaseResult(events=given, end=case.t_end)


def test_a_solver_without_static_friction_is_not_right() -> None:
    for case in CASES:
        assert judge_case(case, result_of(case.parameters, case), 1e-9).right, case.name
        if case.group != "static friction":
            continue
        numbers = case.parameters.numbers()
        equal = {f"mu_s{n}": numbers[f"mu{n}"] for n in case.parameters.law.boundaries}
        judged = judge_case(case, result_of(case.parameters.replace(**equal), case), 1e-9)
        assert not judged.right, case.name
