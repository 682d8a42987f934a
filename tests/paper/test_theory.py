"""The claims on Sections 2 to 5: their committed verdicts, what would change these, and Figs. 1 to 4."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from importlib import import_module
from math import pi
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from symosc import Parameters, load_scene, residual, simulate
from symosc.mappings.theorem7_cases import PLACES
from symosc.paper import drawings, oscillator
from symosc.paper.checks import (
    friction_model,
    lemmas,
    mapping_equations,
    printed_cases,
    rational_cases,
    section_6,
    theorem_7,
    theorem_7_proof,
    theorems,
)
from symosc.paper.claims import Claim, read_claims
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, UNDECIDED, Evidence
from symosc.paper.pictures import PICTURES
from symosc.plot.panels import ONSET_COLOR
from symosc.words import MAPS

pytestmark = pytest.mark.slow  # half a minute of computer algebra

CLAIMS = [claim for claim in read_claims(PICTURES) if claim.part in ("model", "theorems", "mappings")]


@pytest.mark.full(3)  # the whole run judges all of them (test_report_in_browser.py)
@pytest.mark.parametrize("claim", CLAIMS, ids=[claim.id for claim in CLAIMS])
def test_the_check_gives_the_committed_verdict(claim: Claim) -> None:
    evidence = claim.check()
    assert evidence.verdict == claim.verdict, (evidence.finding, evidence.numbers)
    assert any(character.isdigit() for value in evidence.numbers.values() for character in value)


# --- a paper that says something else gets another verdict ---


@pytest.fixture
def fresh() -> Iterator[None]:
    """Forget what was computed from the printed cases."""
    printed_cases.rows_of.cache_clear()
    yield
    printed_cases.rows_of.cache_clear()


def _added(p: Parameters, alpha: int) -> Fraction:
    return {1: p.mu1 + p.mu2, 2: p.mu1 - p.mu2, 3: -(p.mu1 + p.mu2)}[alpha] * p.FN


def _half_interval(p: Parameters, boundary: int) -> tuple[Fraction, Fraction]:
    low, high = TRUE_INTERVAL(p, boundary)
    return low, (low + high) / 2


def _repeated_field(p: Parameters, alpha: int, *state: Any) -> Fraction:
    return TRUE_FIELD(p, min(alpha, 2), *state)


def _both_exits(p: Parameters, boundary: int, x: Any, cosine: Any) -> Any:
    upper = TRUE_EXIT(p, boundary, x, cosine)
    lower = upper + 2 * (p.mu1 if boundary == 1 else p.mu2) * p.FN
    return min(upper, lower, key=abs)


TRUE_INTERVAL, TRUE_FIELD, TRUE_EXIT = (
    friction_model.friction_interval,
    friction_model.vector_field,
    mapping_equations.stick_exit,
)
WITHOUT_P8 = {label: planes for label, planes in mapping_equations.PLANES.items() if label != "P8"}
ON_ONE_SIDE = {label: ((start[0], 0), (end[0], 0)) for label, (start, end) in mapping_equations.PLANES.items()}

MUTATIONS: list[tuple[Any, str, Any, Callable[[], Evidence], str]] = [
    (
        friction_model,
        "friction_force",
        lambda p, alpha: -_added(p, alpha),
        friction_model.friction_levels,
        NOT_AS_PRINTED,
    ),
    (friction_model, "friction_interval", _half_interval, friction_model.friction_at_the_jumps, NOT_AS_PRINTED),
    (friction_model, "added_force", _added, friction_model.equations_of_motion, NOT_AS_PRINTED),
    (friction_model, "vector_field", _repeated_field, friction_model.vector_fields, NOT_AS_PRINTED),
    (friction_model, "stick_force", lambda p, b, x, c: p.A0 - p.k * x, friction_model.stick_condition, NOT_AS_PRINTED),
    (
        friction_model,
        "domain_of",
        lambda p, v: [1] if v <= p.v1 else [],
        friction_model.domains_and_boundaries,
        NOT_AS_PRINTED,
    ),
    (friction_model, "domain_of", lambda p, v: [1], friction_model.motion_states, NOT_AS_PRINTED),
    (friction_model, "friction_interval", _half_interval, friction_model.friction_characteristics, NOT_AS_PRINTED),
    (theorems, "stick_condition", lambda below, above: above < 0, theorems.theorem4_belt1, NOT_AS_PRINTED),
    (theorems, "stick_condition", lambda below, above: below > 0, theorems.theorem4_belt2, NOT_AS_PRINTED),
    (theorems, "passing_condition", lambda below, above: below > 0, theorems.theorem5_belt1, NOT_AS_PRINTED),
    (theorems, "passing_condition", lambda below, above: above < 0, theorems.no_third_way, NOT_AS_PRINTED),
    (theorems, "grazing_condition", lambda below, F, G: F == 0 and G < 0, theorems.theorem6_belt1, NOT_AS_PRINTED),
    (theorems, "grazing_condition", lambda below, F, G: F == 0, theorems.theorem6_belt2, NOT_AS_PRINTED),
    (theorems, "slope_of_field", lambda contact, alpha: contact.force(alpha), theorems.g_functions, NOT_AS_PRINTED),
    (theorems, "BEFORE", "tₘ₋", theorems.time_labels, CONFIRMED),
    (theorem_7_proof, "gamma_of", lambda p, a, v: p.c / p.m * v, theorem_7_proof.grazing_inequality, NOT_AS_PRINTED),
    (theorem_7_proof, "gamma_of", lambda p, a, v: p.k / p.m * v + 1, theorem_7_proof.gamma_is_fixed, NOT_AS_PRINTED),
    (theorem_7_proof, "printed_window", lambda *given: [], theorem_7_proof.without_force, CONFIRMED),
    (theorem_7_proof, "TRACED", {"fig5": ("P2",)}, theorem_7_proof.mappings_that_graze, UNDECIDED),
    (theorem_7_proof, "ENDS", dict.fromkeys(PLACES, ("P2",)), theorem_7_proof.mappings_that_graze, NOT_AS_PRINTED),
    (mapping_equations, "stick_exit", _both_exits, mapping_equations.stick_exit_belt1, CONFIRMED),
    (mapping_equations, "stick_exit", _both_exits, mapping_equations.stick_exit_belt2, CONFIRMED),
    (mapping_equations, "PLANES", WITHOUT_P8, mapping_equations.basic_mappings, NOT_AS_PRINTED),
    (mapping_equations, "residual", lambda *given: (1e-6, 0.0), mapping_equations.governing_equations, NOT_AS_PRINTED),
    (mapping_equations, "position_bound", lambda p: 1.0, mapping_equations.bounded_motions, NOT_AS_PRINTED),
    (mapping_equations, "PLANES", WITHOUT_P8, mapping_equations.trajectories_in_domains, NOT_AS_PRINTED),
    (mapping_equations, "PLANES", ON_ONE_SIDE, mapping_equations.switching_planes, NOT_AS_PRINTED),
    (mapping_equations, "printed_planes", lambda v, d: (v - 1, v + 1), mapping_equations.planes_as_limits, CONFIRMED),
    (lemmas, "sliding_condition", lambda towards, other: towards < 0, lemmas.lemma_1, NOT_AS_PRINTED),
    (lemmas, "passing_condition", lambda up, before, after: before > 0, lemmas.lemma_2, NOT_AS_PRINTED),
    (lemmas, "tangency_condition", lambda away, value, slope: value == 0, lemmas.lemma_3, NOT_AS_PRINTED),
    (lemmas, "sliding_condition", lambda a, b: a < 0, lemmas.necessary_and_sufficient, NOT_AS_PRINTED),
    (lemmas, "g_functions", lambda n, y, t: (y[0], y[0]), lemmas.general_g_functions, NOT_AS_PRINTED),
    (lemmas, "g_functions", lambda n, y, t: ((n.T * y)[0],) * 2, lemmas.reduction, NOT_AS_PRINTED),
    (lemmas, "along_boundary_flow", theorems.slope_of_field, lemmas.derivative_along_the_flow, CONFIRMED),
    (lemmas, "along_boundary_flow", lambda contact, a: Fraction(0), lemmas.derivative_along_the_flow, NOT_AS_PRINTED),
    (theorems, "slope_of_field", lambda contact, a: Fraction(0), theorems.both_sides_at_once, NOT_AS_PRINTED),
    (section_6, "vector_field", lambda *given: Fraction(0), section_6.forces_or_accelerations, NOT_AS_PRINTED),
]


@pytest.mark.parametrize(
    ("module", "name", "said", "check", "verdict"), MUTATIONS, ids=[f"{m[1]}-{m[3].__name__}" for m in MUTATIONS]
)
def test_another_statement_gets_another_verdict(
    module: Any, name: str, said: Any, check: Callable[[], Evidence], verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, name, said)
    assert check().verdict == verdict


def test_grazes_that_come_from_their_own_belt_would_confirm(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(theorem_7_proof, "TRACED", {"fig5": ("P2", "P6"), "fig9": ("P3",), "fig10": ("P5",)})
    monkeypatch.setattr(theorem_7_proof, "TRACED_PHASES", (0.3, 3.3, 4.4))
    assert theorem_7_proof.mappings_that_graze().verdict == CONFIRMED


def _with_printed(monkeypatch: pytest.MonkeyPatch, change: Callable[..., Any]) -> None:
    true = printed_cases.printed_window

    def printed(mapping: str, gamma: Any, amplitude: Any) -> Any:
        return change(true(mapping, gamma, amplitude), mapping, gamma, amplitude)

    for module in (printed_cases, theorem_7, theorem_7_proof):
        monkeypatch.setattr(module, "printed_window", printed)


@pytest.mark.usefixtures("fresh")
def test_a_window_with_a_wrong_end_is_refuted(monkeypatch: pytest.MonkeyPatch) -> None:
    def change(cases: Any, mapping: str, gamma: Any, amplitude: Any) -> Any:
        if not 0 < gamma < amplitude:
            return cases
        return [(number, [arcs[0]._replace(high=arcs[0].high + 1), *arcs[1:]]) for number, arcs in cases]

    _with_printed(monkeypatch, change)
    assert theorem_7.window_p6().verdict == NOT_AS_PRINTED


@pytest.mark.usefixtures("fresh")
def test_a_window_without_a_case_is_refuted(monkeypatch: pytest.MonkeyPatch) -> None:
    _with_printed(monkeypatch, lambda cases, *_: [case for case in cases if case[0] != 3])
    assert theorem_7.window_p5().verdict == NOT_AS_PRINTED
    assert theorem_7.cases_from_above().verdict == CORRECTED


@pytest.mark.usefixtures("fresh")
def test_the_missing_case_and_the_fourth_order_would_confirm(monkeypatch: pytest.MonkeyPatch) -> None:
    def change(cases: Any, mapping: str, gamma: Any, amplitude: Any) -> Any:
        whole = [printed_cases.Arc(Fraction(0), Fraction(4), True)]
        if abs(gamma) != abs(amplitude):
            return cases
        return [(2 if PLACES[mapping].side > 0 else 5, whole if gamma * PLACES[mapping].side > 0 else [])]

    _with_printed(monkeypatch, change)
    assert theorem_7.equality().verdict == CONFIRMED
    assert theorem_7.cases_from_below().verdict == CONFIRMED


@pytest.mark.usefixtures("fresh")
def test_cases_that_overlap_are_refuted(monkeypatch: pytest.MonkeyPatch) -> None:
    _with_printed(monkeypatch, lambda cases, *_: cases * 2)
    assert theorem_7.cases_from_above().verdict == NOT_AS_PRINTED


@pytest.mark.usefixtures("fresh")
def test_cases_that_know_the_sign_of_the_drive_would_confirm(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [printed_cases.Row(1, Fraction(1), Fraction(-1), True, True, False)]
    monkeypatch.setattr(theorem_7, "rows_of", lambda *_: rows)
    assert theorem_7.negative_drive().verdict == CONFIRMED


# --- the ground truth ---


def test_the_power_series_is_the_flow() -> None:
    scene = load_scene("fig9")
    p = scene.parameters
    motion = simulate(p, t0=0, x0="1/3", v0=-2, t_end="0.01")
    constant = p.A0 + rational_cases.friction_on_mass(p, 1)
    series = rational_cases.velocity_series(p, constant, Fraction(1, 3), Fraction(-2), Fraction(0), Fraction(1))
    for t in (0.0002, 0.0005, 0.001):
        assert motion(t)[1] == pytest.approx(sum(float(a) * t**n for n, a in enumerate(series)), abs=1e-12)


def test_contacts_are_of_every_kind() -> None:
    contacts = list(rational_cases.contacts(2, 300, seed=5))
    modes = [contact.next_mode for contact in contacts]
    assert set(modes) == {"Omega2", "Omega3", "belt2"}
    assert sum(contact.force(2) == 0 for contact in contacts) > 50
    assert sum(contact.force(3) == 0 for contact in contacts) > 50
    fourth = [c for c in contacts if c.derivatives(2)[:3] == (0, 0, 0) or c.derivatives(3)[:3] == (0, 0, 0)]
    assert len(fourth) > 5


def test_turn_grows_with_the_angle() -> None:
    angles = np.linspace(0, 2 * pi, 400, endpoint=False)
    turns = [printed_cases.turn(np.sin(angle), np.cos(angle)) for angle in angles]
    assert np.all(np.diff(turns) > 0)
    assert [printed_cases.turn(Fraction(s), Fraction(c)) for s, c in rational_cases.QUARTER_POINTS] == [0, 1, 2, 3]
    assert theorem_7._angle(printed_cases.turn(np.sin(4.0), np.cos(4.0))) == pytest.approx(4.0, abs=1e-14)


# --- Figs. 1 to 4 ---


LABELS = {
    "fig1": ["$k$", "$c$", "$m$", "$x$", "$v_1$", "$v_2$", "$F_N$", "belt 1", "belt 2", r"$A_0 + B_0\cos\Omega t$"],
    "fig2": [r"$\Omega_1$", r"$\Omega_2$", r"$\Omega_3$", "friction force $F_f$"],
    "fig3": [r"$\Omega_1$", r"$\Omega_2$", r"$\Omega_3$", r"$\partial\Omega_{12}$", r"$\partial\Omega_{23}$", "$v_1$"],
    "fig4": [f"$P_{number}$" for number in range(1, 9)],
}


@pytest.mark.parametrize("name", LABELS)
def test_drawings_have_their_labels_on_the_page_and_apart(name: str) -> None:
    drawing: Figure = getattr(oscillator if name == "fig1" else drawings, name)()
    drawing.draw_without_rendering()
    shown = [each for each in drawing.findobj(Text) if isinstance(each, Text) and each.get_visible()]
    boxes = [(each.get_text(), each.get_window_extent()) for each in shown if each.get_text()]
    assert set(LABELS[name]) <= {words for words, _ in boxes}
    page = drawing.bbox
    for number, (words, box) in enumerate(boxes):
        assert page.x0 <= box.x0 < box.x1 <= page.x1, words
        assert page.y0 <= box.y0 < box.y1 <= page.y1, words
        assert not [other for other, further in boxes[number + 1 :] if box.overlaps(further)], words


def test_fig2_has_the_levels_of_its_parameters() -> None:
    p = Parameters(m=1, c=1, k=1, A0=3, B0=1, Omega=1, v1=-2, v2=1, mu1="0.5", mu2="0.25", FN=8)
    ax = drawings.fig2(p).axes[0]
    curves = [(str(line.get_label()), *map(np.asarray, line.get_data())) for line in ax.lines]
    levels = {label: set(y) for label, _, y in curves if str(label).startswith("$")}
    assert levels == {r"$-(\mu_1+\mu_2)F_N$": {-6.0}, r"$(\mu_1-\mu_2)F_N$": {2.0}, r"$(\mu_1+\mu_2)F_N$": {6.0}}
    jumps = [(*x, *y) for line, (_, x, y) in zip(ax.lines, curves, strict=True) if line.get_color() == ONSET_COLOR]
    assert jumps == [(-2.0, -2.0, -6.0, 2.0), (1.0, 1.0, 2.0, 6.0)]


def test_fig3_marks_where_the_mass_sticks() -> None:
    p = load_scene("fig5").parameters
    for belt in (1, 2):
        low, high = drawings.stick_zone(p, belt)
        for x, sticks in ((low + 0.01, True), (high - 0.01, True), (low - 0.01, False), (high + 0.01, False)):
            motion = simulate(p, t0=0, x0=x, v0=p.belt(belt), t_end="1e-6", max_events=1)
            assert (motion.mode(0.0) == f"belt{belt}") == sticks


def test_fig4_shows_each_mapping() -> None:
    ax = drawings.fig4().axes[0]
    curves = {str(line.get_label()): line for line in ax.lines if str(line.get_label()) in MAPS}
    assert set(curves) == set(MAPS)
    p = drawings.MAPPING_PARAMETERS
    for label, curve in curves.items():
        x, v = np.asarray(curve.get_xdata(), dtype=float), np.asarray(curve.get_ydata(), dtype=float)
        start, end = (float(p.belt(plane.boundary)) for plane in (MAPS[label].start, MAPS[label].end))
        assert (v[0], v[-1]) == pytest.approx((start, end), abs=1e-12)
        edges = [-np.inf, float(p.v1), float(p.v2), np.inf]
        domain = MAPS[label].domain
        low, high = edges[domain - 1 : domain + 1] if domain else (start, start)
        assert np.all(v[1:-1] >= low - 1e-12)
        assert np.all(v[1:-1] <= high + 1e-12)
        motion = drawings.mapping_motion(label)
        event = motion.events[0]
        phases = float(p.Omega) * motion.t_start, float(p.Omega) * event.t
        assert (x[0], x[-1]) == pytest.approx((float(drawings.MAPPING_STARTS[label][0]), event.x))
        assert residual(p, label, (x[0], phases[0]), (event.x, phases[1])) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_no_mapping_of_fig4_is_a_needle() -> None:
    """Every flight is at least a quarter as wide as it is high, on the page."""
    drawing = drawings.fig4()
    drawing.draw_without_rendering()
    (ax,) = drawing.axes
    for line in ax.lines:
        label = str(line.get_label())
        if label in MAPS and MAPS[label].domain:
            size = np.ptp(ax.transData.transform(np.column_stack(line.get_data()).astype(float)), axis=0)
            assert size[0] > 0.25 * size[1], label


def test_checks_are_named_in_the_claims() -> None:
    """No check is left without a claim."""
    claimed = {claim.check for claim in CLAIMS}
    for name in ("friction_model", "lemmas", "theorems", "theorem_7", "theorem_7_proof", "mapping_equations"):
        module = import_module(f"symosc.paper.checks.{name}")
        for attribute, value in vars(module).items():
            ours = getattr(value, "__module__", "") == module.__name__ and not attribute.startswith("_")
            if ours and getattr(value, "__annotations__", {}).get("return") == "Evidence":
                assert value in claimed, attribute
