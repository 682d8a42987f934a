"""check_grazing: right where the window is right, not blind where it is wrong, and each way as accurate as assumed."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from oracle import flow_oracle
from samples import sample_of

from symosc import ParameterError, Parameters, load_scene, scene_names, simulate
from symosc.friction import MAPS as MAPS_BY_NAME
from symosc.grazing import check
from symosc.grazing.check import DOP853, EXACT_FLOW, G_SIGNS, NO, YES, Ways, check_grazing
from symosc.grazing.exact_sine import sine_sign
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.kernels import theorem7_cases
from symosc.kernels.theorem7_cases import PLACES, Place

MAPS = ("P2", "P3", "P5", "P6")
BASE = Parameters(
    m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3
)


@pytest.mark.full(1)
@pytest.mark.slow
@pytest.mark.parametrize("mapping", MAPS)
@sample_of(100, 2000)
def test_no_mismatch_on_the_shipped_scenes(mapping: str, count: int) -> None:
    """Parameters that several scenes have are looked at once."""
    for p in dict.fromkeys(load_scene(scene).parameters for scene in scene_names()):
        report = check_grazing(p, mapping, n=count)
        assert report.ok, report.summary()
        assert report.mismatches == ()
        total = report.n_random + report.n_adversarial
        assert (
            report.agreements[G_SIGNS]
            == report.agreements[EXACT_FLOW]
            == sum(report.orders.values())
            == total
        )
        undecided = sum(report.undecided[DOP853].values())
        assert undecided + report.agreements[DOP853] == total
        assert undecided < 40


@pytest.mark.slow
def test_equality_is_met_exactly() -> None:
    # fig7: k v1 = B0 Omega; the quartic tangency at 3 pi/2 is sampled, and 1e-14 beside it
    report = check_grazing(load_scene("fig7").parameters, "P2", n=10)
    assert report.orders[3] == 1
    assert report.closest_phase == pytest.approx(
        1e-14, rel=1e-6, abs=0
    )  # by default, 1e-12 counts as nothing
    assert report.closest[EXACT_FLOW] < 1e-28
    # fig9: two inflections at the ends of the window
    report = check_grazing(load_scene("fig9").parameters, "P3", n=10)
    assert report.orders[2] == 2


ELSEWHERE: list[dict[str, Any]] = [
    {"B0": -4},
    {"B0": 0},
    {"v1": 0},
    {"c": 0, "k": "1.69"},
    {"c": 3},
]
ELSEWHERE += [{"k": "5.2", "Omega": "1.3"}, {"m": "1e-6"}, {"Omega": 1000}, {"k": "1e-9"}]


@pytest.mark.full(6)
@pytest.mark.slow
@pytest.mark.parametrize("changes", ELSEWHERE, ids=str)
@pytest.mark.parametrize("mapping", MAPS)
@sample_of(40, 500)
def test_no_mismatch_elsewhere(mapping: str, changes: dict[str, Any], count: int) -> None:
    report = check_grazing(BASE.replace(**changes), mapping, n=count)
    assert report.ok, report.summary()


class _Shifted(GrazingWindow):
    """A window that is wrong by a tiny shift of the phase."""

    shift = Fraction(0)

    def contains(self, theta: Any) -> Any:
        if isinstance(theta, np.ndarray):
            return super().contains(theta + float(self.shift))

        return super().contains(
            theta + sympy.Rational(self.shift.numerator, self.shift.denominator)
        )

    def contact(self, theta: Any) -> Any:
        return grazing_window(self.parameters, self.mapping).contact(theta)


def _replace_window(monkeypatch: pytest.MonkeyPatch, make: Any) -> None:
    monkeypatch.setattr(check, "grazing_window", make)


@pytest.mark.slow
@pytest.mark.parametrize("size", [8, 13])
def test_a_shifted_window_is_found_out(monkeypatch: pytest.MonkeyPatch, size: int) -> None:
    def shifted(p: Parameters, mapping: str) -> GrazingWindow:
        right = grazing_window(p, mapping)
        wrong = _Shifted(right.parameters, right.mapping, right.order, right.place)
        object.__setattr__(wrong, "shift", Fraction(2, 10**size))
        return wrong

    _replace_window(monkeypatch, shifted)
    report = check_grazing(load_scene("fig9").parameters, "P2", n=10)
    assert not report.ok
    ways = {item["way"] for item in report.mismatches}
    assert {G_SIGNS, EXACT_FLOW} <= ways
    assert (DOP853 in ways) == (size < 13)
    assert "FAILED" in report.summary()


@pytest.mark.full(2)
@pytest.mark.slow
@pytest.mark.parametrize("mapping", MAPS)
def test_ways_agree_with_the_oracles_flow(mapping: str) -> None:
    ways = Ways(grazing_window(BASE, mapping))
    place = ways.window.place
    theta = np.random.default_rng(4).uniform(0, 2 * np.pi, 25)
    signs = ways.verdicts_by_sign(theta)
    flow = ways.verdicts_by_flow(theta)
    solver = ways.verdicts_by_solver(theta)
    for i, phase in enumerate(theta):
        exact = ways.fine.context.mpf(float(phase))
        t_m = Fraction(float(phase)) / BASE.Omega
        rest = (BASE.A(place.domain) - BASE.c * ways.window.speed) / BASE.k
        x = Fraction(
            str(
                ways.fine.number(rest)
                + ways.fine.number(BASE.B0 / BASE.k) * ways.fine.context.cos(exact)
            )
        )
        gaps = []
        for tau in ("-1e-6", "1e-6"):
            v = flow_oracle(BASE, place.domain, t_m, x, ways.window.speed, tau, dps=40)[1]
            gaps.append(-place.side * float(ways.fine.context.convert(v) - ways.v_fine))
        if gaps[0] > 0 and gaps[1] > 0:
            expected = YES
        else:
            expected = NO
        assert signs[i] == flow[i] == solver[i] == expected
        assert ways.verdict_by_intervals(exact, False) == (expected, 1)
        assert ways.verdict_by_fine_flow(exact) == expected


# --- nothing is taken from the window that is judged ---


def _wrong_places() -> list[tuple[str, str, Place]]:
    """Return a map, what is wrong in its row of the table, and the wrong row."""
    rows = []
    for mapping, row in PLACES.items():
        rows.append((mapping, "side", row._replace(side=-row.side)))
        rows.append((mapping, "belt", row._replace(boundary=3 - row.boundary)))
        rows += [
            (mapping, f"domain {domain}", row._replace(domain=domain))
            for domain in (1, 2, 3)
            if domain != row.domain
        ]
    return rows


@pytest.mark.full(8)
@pytest.mark.parametrize(
    ("mapping", "what", "row"), _wrong_places(), ids=lambda each: str(each).replace(" ", "")
)
def test_a_wrong_row_of_the_table_is_found(
    monkeypatch: pytest.MonkeyPatch, mapping: str, what: str, row: Place
) -> None:
    """With windows that are arcs, all and nothing, for which the phases alone would tell nothing.

    Each row with arcs, and with one of the others in turn.
    """
    arcs = load_scene("fig9").parameters
    others = [arcs.replace(v1=0), BASE, BASE.replace(B0=0), BASE.replace(k=100)]
    number = _wrong_places().index((mapping, what, row))
    monkeypatch.setitem(PLACES, mapping, row)
    for p in (arcs, others[number % len(others)]):
        report = check_grazing(p, mapping, n=20)
        assert not report.ok, (what, report.summary())
        assert any("definition" in item["way"] for item in report.mismatches)
        if what == "side":  # then each phase of an arc is wrong
            assert any(item["way"] == EXACT_FLOW for item in report.mismatches)


@pytest.mark.parametrize(("changes", "name"), [({"k": 0}, "k"), ({"B0": 0, "v1": 0}, "B0")])
def test_without_isolated_contacts_the_number_that_is_0_is_named(
    changes: dict[str, int], name: str
) -> None:
    with pytest.raises(ParameterError, match=rf"^{name} = 0: must ") as caught:
        check_grazing(BASE.replace(**changes), "P2")
    assert caught.value.value == 0


@pytest.mark.parametrize("mapping", MAPS)
def test_the_ways_find_a_wrong_belt_by_its_speed(mapping: str) -> None:
    """The table's row is not compared here: phases and positions of the wrong window tell."""
    right = grazing_window(BASE, mapping)
    row = right.place._replace(boundary=3 - right.place.boundary)
    wrong = GrazingWindow(BASE, mapping, "full", row)
    theta = np.linspace(0.0, 2 * np.pi, 400)
    for way in ("verdicts_by_sign", "verdicts_by_flow", "verdicts_by_solver"):
        verdicts = getattr(Ways(wrong), way)(theta)
        assert np.array_equal(verdicts == YES, right.contains(theta)), way
        assert not np.array_equal(verdicts == YES, wrong.contains(theta)), way


@pytest.mark.parametrize("mapping", MAPS)
def test_a_wrong_sign_of_the_condition_is_found(
    monkeypatch: pytest.MonkeyPatch, mapping: str
) -> None:
    true_kind = theorem7_cases.window_kind
    true_sign = sine_sign
    true_contains = GrazingWindow.contains

    def turned(window: GrazingWindow, theta: Any) -> Any:
        if np.ndim(theta):
            return ~np.asarray(true_contains(window, theta))
        return window._sign_at(theta) > 0

    monkeypatch.setattr(GrazingWindow, "contains", turned)
    monkeypatch.setattr(
        theorem7_cases, "window_kind", lambda side, *signs: true_kind(-side, *signs)
    )
    monkeypatch.setattr("symosc.grazing.window.sine_sign", lambda *given: -true_sign(*given))
    for p in (load_scene("fig9").parameters, BASE):
        assert not check_grazing(p, mapping, n=20).ok


@pytest.mark.parametrize("mapping", MAPS)
def test_the_definition_of_a_map_is_what_motions_do(mapping: str) -> None:
    """Follow motions that end in the plane of the map: which belt do they meet, from which side?

    `check_grazing` takes domain, belt and side from this definition.
    """
    row = MAPS_BY_NAME[mapping]
    result = set()
    for name in scene_names():
        motion = simulate(name, max_events=60)
        for segment, event in zip(motion.segments, motion.events, strict=False):
            if segment.label == mapping:
                speed = motion.parameters.belt(event.boundary)
                middle = (float(segment.t_start) + float(segment.t_end)) / 2
                below = motion(middle)[1] < speed
                domain = 1 + (motion(middle)[1] > motion.parameters.v1)
                domain += int(motion(middle)[1] > motion.parameters.v2)
                result.add((int(domain), event.boundary, 1 if below else -1))
    assert result == {(row.domain, row.end.boundary, row.side)}
