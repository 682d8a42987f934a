"""Motions that are not the paper's, with the verdict that a check comes to for each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import pi
from typing import Any

from symosc import Parameters, Scene, load_scene, simulate
from symosc.paper.checks import grazes, motions, orbits
from symosc.paper.claims import CONFIRMED, CORRECTED, NOT_AS_PRINTED, UNDECIDED, Evidence

FIG5, FIG6, FIG7, FIG9, FIG10 = (load_scene(f"fig{number}") for number in (5, 6, 7, 9, 10))


def changed(scene: Scene, **numbers: Any) -> Scene:
    """Return a scene with other numbers of its start, and others of its parameters."""
    start: dict[str, Any] = {
        key: str(numbers.pop(key)) for key in ("t0", "x0", "v0", "t_end") if key in numbers
    }
    return replace(scene, parameters=scene.parameters.replace(**numbers), **start)


def sliding() -> Scene:
    """Return a motion that leaves belt 1 downwards and comes to rest without another contact."""
    p = Parameters(m=1, c=3, k=1, A0=0, B0=0, Omega=1, v1=1, v2=5, mu1=0.8, mu2=0.6, FN=9.81)
    return Scene("sliding", p, Fraction(0), Fraction(0), Fraction(1), Fraction(30))


def settled() -> Scene:
    """Return Fig. 7, printed parameters, started on the periodic motion."""
    later = simulate("fig7", t0=2.5, t_end=80)(2.5 + 2 * pi * 10)
    return replace(FIG7, x0=Fraction(str(later[0])), v0=Fraction(str(later[1])))


def graze7(printed: str) -> grazes.Graze:
    return replace(grazes.FIG7, printed=load_scene(printed), scene=load_scene(printed))


def graze8(start_error: Any = None, **start: str) -> grazes.Graze:
    scene = replace(changed(grazes.FIG8.scene, **start), start_error=start_error)
    return replace(grazes.FIG8, printed=scene, scene=scene)


def exact8() -> grazes.Graze:
    scene = load_scene("fig8-exact")
    return graze8(scene.start_error, x0=str(scene.x0), v0=str(scene.v0))


def rounded8() -> grazes.Graze:
    return graze8(x0="5.8979", v0="2.2582")


OTHER: dict[str, tuple[Callable[[], Evidence], str]] = {
    "mu1 < mu2": (lambda: motions.hypotheses((changed(FIG5, mu1="0.5"),)), NOT_AS_PRINTED),
    "no weight": (lambda: motions.weight((FIG9,)), NOT_AS_PRINTED),
    "no stick": (lambda: motions.force_products((FIG9,)), UNDECIDED),
    "stick at once": (lambda: motions.onset_later(FIG6, 2), NOT_AS_PRINTED),
    "never together": (lambda: motions.together(FIG9, 1), NOT_AS_PRINTED),
    "does not end below": (lambda: motions.ends_below(FIG10, 2), NOT_AS_PRINTED),
    "another domain": (lambda: motions.flight_after(FIG6, 2, 3), NOT_AS_PRINTED),
    "not followed": (lambda: motions.flight_after(changed(FIG6, t_end=2), 2, 2), UNDECIDED),
    "positive for ever": (lambda: motions.product_after(sliding(), 1), CONFIRMED),
    "passes at the start": (
        lambda: motions.sticks_at_start(changed(FIG6, x0=9), 2),
        NOT_AS_PRINTED,
    ),
    "sticks later": (lambda: motions.sticks_at_start(FIG10, 2), CORRECTED),
    "no stick appears": (lambda: motions.sticks_at_start(FIG9, 1), NOT_AS_PRINTED),
    "grazes as given": (lambda: grazes.reaches_belt(load_scene("fig7-exact"), 1), CONFIRMED),
    "sticks as given": (
        lambda: grazes.reaches_belt(load_scene("fig7-corrected"), 1),
        NOT_AS_PRINTED,
    ),
    # At resonance the velocity rises to the belt's for ever, and never is equal to it.
    "swings up to the belt": (lambda: grazes.reaches_belt(changed(FIG7, k=1, x0=20), 1), UNDECIDED),
    "exact start": (lambda: grazes.start_grazes(graze7("fig7-exact")), CONFIRMED),
    "start rounded": (lambda: grazes.start_grazes(rounded8()), CONFIRMED),
    "start off the curve": (lambda: grazes.start_grazes(graze8(x0="5.9")), NOT_AS_PRINTED),
    "contact off the curve": (lambda: grazes.tangential(graze8(x0="5.9")), CORRECTED),
    "grazes already": (lambda: grazes.contact_or_misprint(graze7("fig7-exact")), CONFIRMED),
    "touches as given": (lambda: grazes.tangential(graze7("fig7-exact")), CONFIRMED),
    "touches from above as given": (lambda: grazes.tangential(exact8()), CONFIRMED),
    "of the mapping as given": (lambda: grazes.of_mapping(graze7("fig7-exact")), CONFIRMED),
    "returns as given": (
        lambda: grazes.same_point(replace(grazes.FIG7, printed=settled())),
        CONFIRMED,
    ),
    "at the belt": (lambda: grazes.not_at_belt(replace(grazes.FIG7, printed=FIG9)), NOT_AS_PRINTED),
    "no graze before": (lambda: grazes.sticks_later(rounded8()), NOT_AS_PRINTED),
    "meets as given": (lambda: grazes.curves_meet(exact8()), CONFIRMED),
    "too much friction": (lambda: orbits.orbit_exists(changed(FIG9, mu1="0.9")), NOT_AS_PRINTED),
    "on the orbit": (
        lambda: orbits.start_on_orbit(changed(FIG9, t0="0.1817", x0="4.1549")),
        CONFIRMED,
    ),
    "on the stick orbit": (
        lambda: orbits.start_on_orbit(changed(FIG10, t0="0.4436", x0="3.0737")),
        CONFIRMED,
    ),
    "other order": (lambda: orbits.in_order(changed(FIG9, mu1="0.9")), NOT_AS_PRINTED),
    "products at sticks": (lambda: orbits.products_positive(FIG10, 2), NOT_AS_PRINTED),
    "no passages": (lambda: orbits.passes(FIG10, 2), NOT_AS_PRINTED),
    "it sticks": (lambda: orbits.never_sticks(FIG10), NOT_AS_PRINTED),
    "sticks at first": (lambda: orbits.never_sticks(changed(FIG9, x0="2.5")), NOT_AS_PRINTED),
    "three sticks": (lambda: orbits.stick_parts(FIG10, "P4", 3), NOT_AS_PRINTED),
    "no onsets": (lambda: orbits.onsets(FIG9, 2), NOT_AS_PRINTED),
    "no ends": (lambda: orbits.ends(FIG9, 2), NOT_AS_PRINTED),
    "conditions without closing": (lambda: orbits.closing_conditions(FIG10), CORRECTED),
    "conditions with closing": (lambda: orbits.closing_conditions(FIG9, True), CONFIRMED),
}
