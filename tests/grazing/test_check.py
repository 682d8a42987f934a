"""check_grazing: right where the window is right, and not blind where it is wrong."""

from __future__ import annotations

import json
import operator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from samples import few, sample_of

from symosc import ParameterError, Parameters, load_scene, scene_names
from symosc.grazing import check
from symosc.grazing.check import DOP853, EXACT_FLOW, G_SIGNS, check_grazing
from symosc.grazing.deciders import NO, NOT_DECIDED, YES
from symosc.grazing.window import GrazingWindow, grazing_window

MAPS = ("P2", "P3", "P5", "P6")
BASE = Parameters(m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3)


PAPERS = ["fig5", "fig7", "fig8", "fig10"]


@pytest.mark.slow
@pytest.mark.parametrize("scene", PAPERS)
@sample_of(150, 2000)
def test_no_mismatch_on_the_papers_scenes(scene: str, count: int) -> None:
    p = load_scene(scene).parameters
    for mapping in MAPS:
        report = check_grazing(p, mapping, n=count)
        assert report.ok, report.summary()
        assert report.mismatches == ()
        assert report.agreements[G_SIGNS] == report.agreements[EXACT_FLOW] == report.n_random + report.n_adversarial
        open_ones = report.undecided[DOP853]
        assert sum(open_ones.values()) + report.agreements[DOP853] == report.n_random + report.n_adversarial
        assert sum(open_ones.values()) < 40
        assert sum(report.orders.values()) == report.n_random + report.n_adversarial


@pytest.mark.slow
def test_equality_is_met_exactly() -> None:
    # fig7: k v1 = B0 Omega; the quartic tangency at 3 pi/2 is sampled, and 1e-14 beside it
    report = check_grazing(load_scene("fig7").parameters, "P2", n=10)
    assert report.orders[3] == 1
    assert report.closest_phase == pytest.approx(1e-14, rel=1e-6, abs=0)  # by default, 1e-12 counts as nothing
    assert report.closest[EXACT_FLOW] < 1e-28
    # fig9: two inflections at the ends of the window
    report = check_grazing(load_scene("fig9").parameters, "P3", n=10)
    assert report.orders[2] == 2


@pytest.mark.full(3)
@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {"B0": -4},
        {"B0": 0},
        {"v1": 0},
        {"c": 0, "k": "1.69"},
        {"c": 3},
        {"k": "5.2", "Omega": "1.3"},
        {"m": "1e-6"},
        {"Omega": 1000},
        {"k": "1e-9"},
    ],
    ids=str,
)
@sample_of(40, 500)
def test_no_mismatch_elsewhere(changes: dict[str, Any], count: int) -> None:
    for mapping in MAPS:
        report = check_grazing(BASE.replace(**changes), mapping, n=count)
        assert report.ok, report.summary()


# -- a check that cannot fail checks nothing --------------------------------------------------------------------------


class _Shifted(GrazingWindow):
    """A window that is wrong by a tiny shift of the phase."""

    shift = Fraction(0)

    def contains(self, theta: Any) -> Any:
        if isinstance(theta, np.ndarray):
            return super().contains(theta + float(self.shift))
        import sympy

        return super().contains(theta + sympy.Rational(self.shift.numerator, self.shift.denominator))

    def contact(self, theta: Any) -> Any:
        return grazing_window(self.parameters, self.mapping).contact(theta)


def _replace_window(monkeypatch: pytest.MonkeyPatch, make: Any) -> None:
    monkeypatch.setattr(check, "grazing_window", make)


@pytest.mark.slow
@pytest.mark.parametrize("size", few([3, 8, 13], 3, 8))
def test_a_shifted_window_is_found_out(monkeypatch: pytest.MonkeyPatch, size: int) -> None:
    def shifted(p: Parameters, mapping: str) -> GrazingWindow:
        right = grazing_window(p, mapping)
        wrong = _Shifted(right.parameters, right.mapping, right.order, right.place)
        object.__setattr__(wrong, "shift", Fraction(2, 10**size))
        return wrong

    _replace_window(monkeypatch, shifted)
    report = check_grazing(load_scene("fig9").parameters, "P2", n=10)
    assert not report.ok
    ways = {each["way"] for each in report.mismatches}
    assert {G_SIGNS, EXACT_FLOW} <= ways
    assert (DOP853 in ways) == (size < 13)
    assert "FAILED" in report.summary()


def test_the_papers_reading_fails_at_the_equality(monkeypatch: pytest.MonkeyPatch) -> None:
    _replace_window(monkeypatch, lambda p, mapping: grazing_window(p, mapping, "paper"))
    report = check_grazing(load_scene("fig8").parameters, "P3", n=100)
    assert {each["theta"] for each in report.mismatches} == {"pi/2"}
    assert len(report.mismatches) == 2  # DOP853 cannot tell


@pytest.mark.slow
def test_the_wrong_map_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def swapped(p: Parameters, mapping: str) -> GrazingWindow:
        right, other = grazing_window(p, mapping), grazing_window(p, "P3")
        wrong = _Shifted(p, mapping, "full", right.place)
        object.__setattr__(wrong, "contains", other.contains)
        return wrong

    _replace_window(monkeypatch, swapped)
    monkeypatch.setattr(check._Check, "_check_contacts", lambda *_: None)
    report = check_grazing(load_scene("fig5").parameters, "P2", n=100)
    assert len(report.mismatches) > 3 * 150


def test_a_wrong_contact_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    right = GrazingWindow.contact
    monkeypatch.setattr(GrazingWindow, "contact", lambda self, theta: right(self, theta) * (1 + 1e-12))
    report = check_grazing(load_scene("fig5").parameters, "P2", n=50)
    assert not report.ok
    assert {each["way"] for each in report.mismatches} == {"contact"}


# -- the ways, one by one ----------------------------------------------------------------------------------------------


# -- the report ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_report_is_plain_data() -> None:
    report = check_grazing(BASE, "P2", n=50, seed=3)
    data = json.loads(json.dumps(report.to_dict(), default=str))
    assert data["ok"] is True
    assert data["seed"] == 3
    assert data["n_random"] == 50
    text = report.summary()
    assert "0 mismatches" in text
    assert "cannot decide" in text
    assert "seed 3" in text


@pytest.mark.slow
def test_the_seed_decides_the_phases() -> None:
    first, second = (check_grazing(BASE, "P2", n=50, seed=1).n_grazing for _ in range(2))
    assert first == second


@pytest.mark.parametrize(
    ("changes", "mapping", "n", "name"),
    [
        ({}, "P4", 10, "mapping"),
        ({}, "P2", 0, "n"),
        ({}, "P2", 2.5, "n"),
        ({}, "P2", 1_000_001, "n"),
        ({"k": 0}, "P2", 5, "k"),
        ({"B0": 0, "v1": 0}, "P2", 5, "B0"),
    ],
)
def test_bad_input(changes: dict[str, Any], mapping: str, n: Any, name: str) -> None:
    with pytest.raises(ParameterError) as caught:
        check_grazing(BASE.replace(**changes), mapping, n=n)
    assert caught.value.name == name


@pytest.mark.slow
@sample_of(100, 4000)
def test_all_shipped_scenes(count: int) -> None:
    """Parameters that several scenes have are looked at once; the scenes above have a test of their own."""
    of_papers = [load_scene(scene).parameters for scene in PAPERS]
    others = [p for scene in scene_names() if (p := load_scene(scene).parameters) not in of_papers]
    for p in dict.fromkeys(others):
        for mapping in MAPS:
            report = check_grazing(p, mapping, n=count)
            assert report.ok, report.summary()


def test_special_phases_are_approached_from_both_sides_by_powers_of_ten(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each phase itself, and 1e-3 to 1e-14 before and behind it; where G^(1) = 0 too."""
    looked_at: list[Any] = []
    count = check._Check._count

    def counted(self: Any, phases: Any, *arguments: Any) -> None:
        looked_at.extend(phases)
        count(self, phases, *arguments)

    monkeypatch.setattr(check._Check, "_count", counted)
    p = load_scene("fig9").parameters  # k v1 = 3, B0 Omega = 36
    own = check._Check(grazing_window(p, "P2"))
    own.adversarial()
    angle = sympy.asin(sympy.Rational(1, 12))
    bases = [sympy.Integer(0), sympy.pi / 2, sympy.pi, 3 * sympy.pi / 2, sympy.pi + angle, 2 * sympy.pi - angle]
    sizes = [sympy.Rational(1, 10**k) for k in range(3, 15)]
    expected = {str((base + shift).evalf(30)) for base in bases for size in sizes for shift in (0, size, -size)}
    assert {str(phase.evalf(30)) for phase in looked_at} == expected
    assert own.n_adversarial == len(looked_at) == len(bases) * 25


def counted(rng: np.random.Generator, own: check._Check) -> dict[str, Any]:
    """Feed a check with verdicts that are drawn, and return what it has to say of them."""
    right: dict[str, Any] = {"agreements": {}, "undecided": {}, "closest": {}, "mismatches": [], "n_grazing": 0}
    for way in (G_SIGNS, EXACT_FLOW, DOP853):
        right["agreements"][way], right["undecided"][way], right["closest"][way] = 0, 0, np.inf
    for _ in range(4):
        n = int(rng.integers(1, 9))
        phases, inside = rng.uniform(0, 6, n), rng.random(n) < 0.5
        margins = rng.choice([0.0, 1e-9, 1e-3, 0.5], n)
        verdicts = rng.choice([YES, NO, NOT_DECIDED], (3, n))
        own._count(phases, inside, margins, *verdicts)
        right["n_grazing"] += int(inside.sum())
        for way, verdict in zip(right["closest"], verdicts, strict=True):
            for phase, grazes, margin, said in zip(phases, inside, margins, verdict, strict=True):
                if said == NOT_DECIDED:
                    right["undecided"][way] += 1
                elif (said == YES) == grazes:
                    right["agreements"][way] += 1
                    right["closest"][way] = min(right["closest"][way], margin or np.inf)
                else:
                    words = ("grazes", "does not graze")
                    window, found = words if grazes else words[::-1]
                    right["mismatches"].append({"theta": str(phase), "way": way, "window": window, "found": found})
    return right


def test_verdicts_are_counted_and_compared_with_the_window() -> None:
    """How many agree and are open, the closest of those that agree, and every contradiction with what both say."""
    rng, window = np.random.default_rng(4), grazing_window(BASE, "P2")
    for _ in range(5):
        own = check._Check(window)
        right = counted(rng, own)
        for name in ("agreements", "undecided", "closest", "n_grazing"):
            assert getattr(own, name) == right[name], name
        key = operator.itemgetter("theta", "way")
        assert sorted(own.mismatches, key=key) == sorted(right["mismatches"], key=key)


def test_random_phases_are_decided_in_doubles_and_else_with_more_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    """What one of the first two ways leaves open is looked at again; orders and the fine looks are counted."""
    own, rng = check._Check(grazing_window(BASE, "P2")), np.random.default_rng(5)
    theta = rng.uniform(0, 2 * np.pi, 40)
    signs, flow = (rng.choice([YES, NO, NOT_DECIDED], 40) for _ in range(2))
    asked: list[float] = []
    monkeypatch.setattr(own.ways, "signs", lambda _: signs.copy())
    monkeypatch.setattr(own.ways, "flow", lambda _: flow.copy())
    monkeypatch.setattr(own.ways, "solver", lambda _: np.full(40, NOT_DECIDED))
    order = iter(rng.integers(1, 4, 40).tolist())
    given: list[int] = []

    def fine_signs(phase: Any, zero: bool) -> tuple[int, int]:
        asked.append(float(phase))
        given.append(next(order))
        assert not zero
        return (NOT_DECIDED if len(asked) % 5 == 0 else YES), given[-1]

    monkeypatch.setattr(own.ways, "fine_signs", fine_signs)
    monkeypatch.setattr(own.ways, "fine_flow", lambda _: NO)
    own.random(theta)
    open_ones = (signs == NOT_DECIDED) | (flow == NOT_DECIDED)
    assert asked == theta[open_ones].tolist()
    assert own.finely == len(asked)
    decided = [each for i, each in enumerate(given, start=1) if i % 5]
    counts = {each: decided.count(each) + (each == 1) * int((~open_ones).sum()) for each in (1, 2, 3)}
    assert {each: own.orders[each] for each in (1, 2, 3)} == counts
    assert own.undecided == {G_SIGNS: len(asked) // 5, EXACT_FLOW: 0, DOP853: 40}
    inside = own.window.contains(theta)
    assert own.agreements[EXACT_FLOW] == int((np.where(open_ones, NO, flow) == np.where(inside, YES, NO)).sum())


def test_a_report_says_what_it_counted() -> None:
    """Each number is in the summary, and ok is what it says."""
    plain: dict[str, Any] = {
        "mapping": "P2", "window": "W", "case": "(55.1)", "seed": 7, "n_random": 30, "n_adversarial": 12,
        "n_grazing": 17, "agreements": {G_SIGNS: 42, EXACT_FLOW: 41, DOP853: 40},
        "undecided": {G_SIGNS: {}, EXACT_FLOW: {}, DOP853: {"too near": 2}}, "mismatches": (),
        "closest": {G_SIGNS: 1e-3, EXACT_FLOW: 2e-3, DOP853: 3e-3}, "closest_phase": 1e-9, "orders": {3: 1, 1: 41},
        "finely": 5, "seconds": 1.25,
    }  # fmt: skip
    report = check.GrazingReport(**plain)
    assert report.ok
    assert report.summary().splitlines() == [
        "P2 (55.1): W",
        "ok: 0 mismatches at 42 phases (30 random, seed 7; 12 adversarial); 17 graze",
        "  G-functions agrees at 42, down to |G1|/size = 1.0e-03",
        "  exact flow  agrees at 41, down to |G1|/size = 2.0e-03",
        "  DOP853      agrees at 40, down to |G1|/size = 3.0e-03; cannot decide 2: too near",
        "  decided by order 1: 41, order 3: 1; 5 phases needed intervals; 1.25 s",
    ]
    assert report == check.GrazingReport(**plain | {"seconds": 9.0})
    many = tuple({"theta": str(i)} for i in range(25))
    for change in (
        {"mismatches": many}, {"undecided": plain["undecided"] | {G_SIGNS: {"x": 1}}},
        {"undecided": plain["undecided"] | {EXACT_FLOW: {"x": 1}}},
    ):  # fmt: skip
        failed = check.GrazingReport(**plain | change)
        assert not failed.ok
        assert failed.to_dict() == {"ok": False, **plain, **change}
        assert failed.summary().splitlines()[1].startswith("FAILED: ")
    lines = check.GrazingReport(**plain | {"mismatches": many}).summary().splitlines()
    assert lines[6:] == [f"  mismatch: {each}" for each in many[:20]]


def test_many_phases_are_checked_in_parts_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    parts: list[float] = []
    p = load_scene("fig9").parameters
    whole = check_grazing(p, "P2", n=100)
    monkeypatch.setattr(check, "CHECK_PHASES", 40)
    assert check_grazing(p, "P2", n=100, progress=lambda part, all: parts.append(part / all)) == whole
    assert parts == [0.4, 0.8, 1.0]


def test_each_way_is_counted_for_itself_at_the_special_phases(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: the G-functions always say yes, the exact flow no, DOP853 nothing."""
    judge = check._Check(grazing_window(load_scene("fig9").parameters, "P2"))
    counted: list[Any] = []
    monkeypatch.setattr(check, "DECADES", (3, 14))
    monkeypatch.setattr(judge, "_fine", lambda value, zero: (YES, NO))
    monkeypatch.setattr(judge.ways, "solver", lambda theta: np.full(len(theta), NOT_DECIDED))
    monkeypatch.setattr(judge, "_count", lambda *columns: counted.extend(columns))
    judge.adversarial()
    phases, inside, margins, signs, flow, solver = counted
    assert {len(each) for each in counted} == {judge.n_adversarial}
    assert (set(signs), set(flow), set(solver)) == ({YES}, {NO}, {NOT_DECIDED})
    assert inside.tolist() == [bool(judge.window.contains(phase)) for phase in phases]
    zeros = [i for i, margin in enumerate(margins) if margin == 0.0]
    assert [abs(float(judge.ways.slope(np.array([float(phases[i])]))[0])) < 1e-15 for i in zeros] == [True, True]
    assert judge.closest_phase == pytest.approx(1e-14, abs=0)
