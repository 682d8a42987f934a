"""The claims about Figs. 5 to 10: committed verdicts, and other verdicts for other motions."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Any

import pytest

from symosc import Parameters, Scene, load_scene, simulate
from symosc.paper.checks import (
    after_grazing,
    contacts,
    grazing_figures,
    grazing_starts,
    orbit_conditions,
    periodic_figures,
    section_6,
    stick_figures,
)
from symosc.paper.checks.contacts import SceneContact, Stick
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, UNDECIDED, Evidence

CLAIMS = tomllib.loads((Path(section_6.__file__).parents[1] / "claims" / "figures.toml").read_text(encoding="utf-8"))[
    "claim"
]
FIGURES = {f"fig{number}" for number in range(5, 11)} | {"theorem7", "force"}  # "force-product" of section 6
# The searches for misprints take long: the whole run judges them (test_report_in_browser.py).
QUICK = [each for each in CLAIMS if not each["check"].startswith("starts.")]


def check_of(claim: dict[str, Any]) -> Callable[[], Evidence]:
    module, function = claim["check"].split(".")
    return getattr(import_module(f"symosc.paper.checks.{module}"), function)


@pytest.mark.full(6)  # the whole run judges all of them
@pytest.mark.quick(6)
@pytest.mark.parametrize("claim", QUICK, ids=[each["id"] for each in QUICK])
def test_the_verdict_is_the_committed_one(claim: dict[str, Any]) -> None:
    evidence = check_of(claim)()
    assert evidence.verdict == claim["verdict"], evidence.finding
    assert ("correction" in claim) == (evidence.verdict in (CORRECTED, NOT_AS_PRINTED))
    assert any(character.isdigit() for value in evidence.numbers.values() for character in value)


def test_every_figure_and_every_check_has_a_claim() -> None:
    assert {figure.partition("-")[0] for claim in CLAIMS for figure in claim.get("figures", ())} == FIGURES
    used = {claim["check"] for claim in CLAIMS}
    for module in (stick_figures, grazing_figures, grazing_starts, after_grazing, periodic_figures, orbit_conditions):
        name = module.__name__.rpartition(".")[2]
        made = [
            n
            for n, f in vars(module).items()
            if n.startswith("fig") and getattr(f, "__module__", "") == module.__name__
        ]
        checks = {f"{name}.{n}" for n in made if vars(module)[n].__annotations__["return"] == "Evidence"}
        assert checks <= used


@pytest.mark.parametrize("name", [*section_6.PRINTED, "fig7-corrected", "fig8-exact", "fig7-exact"])
def test_motions_are_followed_to_their_ends(name: str) -> None:
    path = contacts.motion(load_scene(name))
    assert path.status == "t_end"
    assert all(max(event.t_error, event.x_error) < contacts.NO_FORCE for event in path.events)


# --- each check can come to another verdict ---


def changed(name: str, **numbers: Any) -> Scene:
    """Return a scene with other numbers of its start, and others of its parameters."""
    scene = load_scene(name)
    start: dict[str, Any] = {key: str(numbers.pop(key)) for key in ("t0", "x0", "v0", "t_end") if key in numbers}
    return replace(scene, parameters=scene.parameters.replace(**numbers), **start)


def sliding() -> Scene:
    """Return a motion that leaves belt 1 downwards and comes to rest without another contact."""
    p = Parameters(m=1, c=3, k=1, A0=0, B0=0, Omega=1, v1=1, v2=5, mu1=0.8, mu2=0.6, FN=9.81)
    return Scene("sliding", p, Fraction(0), Fraction(0), Fraction(1), Fraction(30))


def settled() -> Scene:
    """Return Fig. 7, printed parameters, started on the periodic motion."""
    later = simulate("fig7", t0=2.5, t_end=80)(2.5 + 2 * pi * 10)
    return replace(load_scene("fig7"), x0=Fraction(str(later[0])), v0=Fraction(str(later[1])))


def resonant() -> Scene:
    """Return Fig. 7 at resonance: a velocity that rises to the belt's for ever, and never is equal to it."""
    return changed("fig7", k=1, x0=20)


def fig7(printed: str) -> grazing_figures.Graze:
    scene = load_scene(printed)
    return replace(grazing_figures.fig7(), printed=scene, scene=scene)


def fig8(start_error: Any = None, **start: str) -> grazing_figures.Graze:
    scene = replace(changed("fig8", t_end=9, **start), start_error=start_error)
    return replace(grazing_figures.fig8(), printed=scene, scene=scene)


EXACT8: dict[str, Any] = {name: str(getattr(load_scene("fig8-exact"), name)) for name in ("x0", "v0")}
EXACT8["start_error"] = load_scene("fig8-exact").start_error
ROUNDED8 = {"x0": "5.8979", "v0": "2.2582"}

OTHER: list[tuple[str, Callable[[], Evidence], str]] = [
    ("mu1 < mu2", lambda: section_6.hypotheses([changed("fig5", mu1="0.5")]), NOT_AS_PRINTED),
    ("weights only", lambda: section_6.weight([load_scene("fig5"), load_scene("fig8")]), CONFIRMED),
    ("no weight", lambda: section_6.weight([load_scene("fig9")]), NOT_AS_PRINTED),
    ("no stick", lambda: section_6.force_products([load_scene("fig9")]), UNDECIDED),
    ("stick at once", lambda: stick_figures.onset_later(load_scene("fig6"), 2), NOT_AS_PRINTED),
    ("never on the belt", lambda: stick_figures.onset_later(load_scene("fig7"), 1), NOT_AS_PRINTED),
    ("never together", lambda: stick_figures.together(load_scene("fig9"), 1), NOT_AS_PRINTED),
    ("no forces of a stick", lambda: stick_figures.forces_hold(load_scene("fig9"), 1), NOT_AS_PRINTED),
    ("does not end below", lambda: stick_figures.ends_below(load_scene("fig10"), 2), NOT_AS_PRINTED),
    ("another domain", lambda: stick_figures.flight_after(load_scene("fig6"), 2, (3,)), NOT_AS_PRINTED),
    ("not followed", lambda: stick_figures.flight_after(changed("fig6", t_end=2), 2, (2,)), UNDECIDED),
    ("positive for ever", lambda: stick_figures.product_after(sliding(), 1), CONFIRMED),
    ("passes at the start", lambda: stick_figures.sticks_at_start(changed("fig6", x0=9), 2), NOT_AS_PRINTED),
    ("sticks later", lambda: stick_figures.sticks_at_start(load_scene("fig10"), 2), CORRECTED),
    ("grazes as given", lambda: grazing_figures.reaches_belt(load_scene("fig7-exact"), 1), CONFIRMED),
    ("sticks as given", lambda: grazing_figures.reaches_belt(load_scene("fig7-corrected"), 1), NOT_AS_PRINTED),
    ("swings up to the belt", lambda: grazing_figures.reaches_belt(resonant(), 1), UNDECIDED),
    ("exact start", lambda: grazing_starts.start_grazes(fig7("fig7-exact")), CONFIRMED),
    ("start rounded", lambda: grazing_starts.start_grazes(fig8(**ROUNDED8)), CONFIRMED),
    ("start off the curve", lambda: grazing_starts.start_grazes(fig8(x0="5.9")), NOT_AS_PRINTED),
    ("contact off the curve", lambda: grazing_figures.tangential(fig8(x0="5.9")), CORRECTED),
    ("grazes already", lambda: grazing_starts.contact_or_misprint(load_scene("fig7-exact"), "P2"), CONFIRMED),
    ("touches as given", lambda: grazing_figures.tangential(fig7("fig7-exact")), CONFIRMED),
    ("touches from above as given", lambda: grazing_figures.tangential(fig8(**EXACT8)), CONFIRMED),
    ("touches once as given", lambda: grazing_figures.touches_once(fig7("fig7-exact")), CONFIRMED),
    ("of the mapping as given", lambda: grazing_figures.of_mapping(fig7("fig7-exact")), CONFIRMED),
    ("returns as given", lambda: after_grazing.same_point(replace(fig7("fig7"), printed=settled())), CONFIRMED),
    ("at the belt", lambda: after_grazing.not_at_belt([load_scene("fig9")], 1), NOT_AS_PRINTED),
    ("no graze before", lambda: after_grazing.sticks_later(fig8(**ROUNDED8)), NOT_AS_PRINTED),
    ("meets as given", lambda: after_grazing.curves_meet(fig8(**EXACT8)), CONFIRMED),
    ("too much friction", lambda: periodic_figures.orbit_exists(changed("fig9", mu1="0.9")), NOT_AS_PRINTED),
    ("on the orbit", lambda: periodic_figures.start_on_orbit(changed("fig9", t0="0.1817", x0="4.1549")), CONFIRMED),
    (
        "on the orbit with sticks",
        lambda: periodic_figures.start_on_orbit(changed("fig10", t0="0.4436", x0="3.0737")),
        CONFIRMED,
    ),
    ("other order", lambda: periodic_figures.in_order(changed("fig9", mu1="0.9")), NOT_AS_PRINTED),
    ("products at sticks", lambda: periodic_figures.products_positive(load_scene("fig10"), 2), NOT_AS_PRINTED),
    ("no passages", lambda: periodic_figures.passes(load_scene("fig10"), 2), NOT_AS_PRINTED),
    ("it sticks", lambda: periodic_figures.never_sticks(load_scene("fig10")), NOT_AS_PRINTED),
    ("three sticks", lambda: periodic_figures.stick_parts(load_scene("fig10"), "P4", 3), NOT_AS_PRINTED),
    ("no onsets", lambda: periodic_figures.onsets(load_scene("fig9"), 2), NOT_AS_PRINTED),
    ("a stick appears later", lambda: periodic_figures.stick_appears(load_scene("fig10"), 2), CONFIRMED),
    ("no stick appears", lambda: periodic_figures.stick_appears(load_scene("fig9"), 1), NOT_AS_PRINTED),
    ("conditions without closing", lambda: orbit_conditions.closing_conditions(load_scene("fig10")), CORRECTED),
    ("conditions with closing", lambda: orbit_conditions.closing_conditions(load_scene("fig9"), True), CONFIRMED),
    ("no ends", lambda: periodic_figures.ends(load_scene("fig9"), 2), NOT_AS_PRINTED),
]


@pytest.mark.quick(9)
@pytest.mark.parametrize(("check", "expected"), [row[1:] for row in OTHER], ids=[row[0] for row in OTHER])
def test_other_motions_have_other_verdicts(check: Callable[[], Evidence], expected: str) -> None:
    evidence = check()
    assert evidence.verdict == expected, evidence.finding


def test_periodic_start_is_found_periodic(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(after_grazing, "exact", lambda figure: settled())
    assert after_grazing.periodic(grazing_figures.fig7()).verdict == CONFIRMED


def test_window_without_a_graze(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grazing_figures, "exact", lambda figure: figure.scene)
    assert grazing_figures.in_window(grazing_figures.fig8()).verdict == NOT_AS_PRINTED


# --- sticks that are wrong are found out ---


@pytest.fixture
def wrong_stick(monkeypatch: pytest.MonkeyPatch) -> Callable[[Any, Any], None]:
    """Return a function that makes the checks see Fig. 5's first stick lasting longer, or ending elsewhere."""
    scene = load_scene("fig5")
    stick = contacts.sticks(scene)[0]

    def lengthen(longer: Any, further: Any) -> None:
        assert stick.end is not None
        end = SceneContact(1, stick.end.t + longer, stick.end.x + further, stick.end.theta + longer)
        for module in (section_6, stick_figures):
            monkeypatch.setattr(module, "sticks", lambda *_: [Stick(1, stick.onset, end, "Omega1")])

    return lengthen


def test_stick_beyond_its_end(wrong_stick: Callable[[Any, Any], None]) -> None:
    wrong_stick(0, 0)
    assert stick_figures.fig5_forces().verdict == CONFIRMED
    assert stick_figures.fig5_together().verdict == CONFIRMED
    assert section_6.force_products([load_scene("fig5")]).verdict == CONFIRMED
    wrong_stick(1e-12, 1e-12)
    assert stick_figures.fig5_forces().verdict == NOT_AS_PRINTED
    assert stick_figures.fig5_together().verdict == NOT_AS_PRINTED
    assert section_6.force_products([load_scene("fig5")]).verdict == NOT_AS_PRINTED


def test_stick_that_lags_behind_the_belt(wrong_stick: Callable[[Any, Any], None]) -> None:
    wrong_stick(0, -1e-15)
    assert stick_figures.fig5_together().verdict == NOT_AS_PRINTED


def test_forces_are_looked_at_where_they_turn() -> None:
    """A stick over which both forces turn twice: samples at its ends alone would not do."""
    scene = changed("fig5", A0=0, x0=8, v0="0.1", v1="0.1", B0=3, t_end=60)
    stick = next(each for each in contacts.sticks(scene) if each.end is not None)
    along = contacts.forces_along(scene.parameters, stick)
    assert stick.end is not None
    assert len(along) > 6
    path, start = contacts.motion(scene), float(stick.onset.t)
    for i, (before, after) in enumerate(pairwise(along)):
        times = [start + float(before.elapsed + (after.elapsed - before.elapsed) * j / 20) for j in range(21)]
        values = [float(path.force(1, t)) for t in times[:-1]] + [float(after.below)]
        rises = [b > a for a, b in pairwise(values)]
        assert all(rises) or not any(rises), i
