"""The ground truth of the checks, the second opinion on motions, and misprints that were put in are found."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from paper_motions import FIG5, FIG6, FIG9, FIG10, changed

from symosc import Parameters, Scene, find_orbit, load_scene, simulate
from symosc.kernels.theorem7_cases import PLACES
from symosc.paper.checks import exact, grazes, motions, orbits, theorem_7, theorems
from symosc.paper.checks.motions import Stretch, fly_again, stretches_of
from symosc.paper.claims import CONFIRMED, CORRECTED


def test_forces_are_looked_at_where_they_turn() -> None:
    """A stick over which both forces turn twice: samples at its ends alone would not do."""
    scene = changed(FIG5, A0=0, x0=8, v0="0.1", v1="0.1", B0=3, t_end=60)
    stick = next(each for each in motions.sticks(scene) if each.end is not None)
    along = motions.forces_along(scene.parameters, stick)
    assert len(along) > 6
    path = motions.motion(scene)
    start = float(stick.onset.t)
    for i, (before, after) in enumerate(pairwise(along)):
        times = [
            start + float(before.elapsed + (after.elapsed - before.elapsed) * j / 20)
            for j in range(21)
        ]
        values = [float(path.force(1, t)) for t in times[:-1]] + [float(after.below)]
        rises = [b > a for a, b in pairwise(values)]
        assert all(rises) or not any(rises), i


# --- the ground truth ---


def test_contacts_are_of_every_kind_and_turns_are_exact() -> None:
    angles = np.linspace(0, 2 * pi, 400, endpoint=False)
    turns = [theorem_7.quarter_turns(np.sin(angle), np.cos(angle)) for angle in angles]
    assert [theorem_7.quarter_turns(Fraction(s), Fraction(c)) for s, c in exact.QUARTER_POINTS] == [
        0,
        1,
        2,
        3,
    ]
    assert [theorem_7.angle(turn) for turn in turns] == pytest.approx(angles, abs=1e-14)
    assert all(s * s + c * c == 1 for s, c in exact.RATIONAL_PHASES)
    contacts = exact.contacts(2, 300, 5)
    assert {contact.next_mode for contact in contacts} == {"Omega2", "Omega3", "belt2"}
    for alpha in (2, 3):
        assert sum(contact.force(alpha) == 0 for contact in contacts) > 50
    assert (
        sum(any(contact.derivatives(a)[:3] == (0, 0, 0) for a in (2, 3)) for contact in contacts)
        > 5
    )


# --- the second opinion on motions ---


def stretches(name: str) -> tuple[Parameters, list[Stretch]]:
    path = simulate(load_scene(name))
    return path.parameters, stretches_of(path)


def test_a_second_opinion_finds_wrong_motions() -> None:
    p, found = stretches("fig10")
    t, x, v = found[2].end
    found[2] = found[2]._replace(end=(t + 1e-7, x, v))
    assert fly_again(p, found)[0] > 1e-9
    # A missed contact.
    p, found = stretches("fig9")
    long = found[0].start[0] + 2 * found[0].end[0]
    x, v = map(float, exact.flow(p, p.A(found[0].place), found[0].start, long))
    assert fly_again(p, [found[0]._replace(end=(long, x, v))])[1] == 1
    # A wrong mode, and a stick that is too long.
    p, found = stretches("fig5")
    at = next(i for i, each in enumerate(found) if each.place == -1)
    assert fly_again(p, found[: at + 1]) == (pytest.approx(0, abs=1e-9), 0)
    t, x, v = found[at].end
    assert fly_again(p, [*found[:at], found[at]._replace(place=1)])[1] >= 1
    assert fly_again(p, [found[at]._replace(end=(t + 1, x + 1, v))])[1] == 1


# --- starts of grazing and periodic motions, and misprints that were put in ---


@pytest.mark.quick(1)
@pytest.mark.full(4)
@pytest.mark.parametrize("seed", range(12))
def test_a_start_that_grazes_is_found_from_its_printed_digits(seed: int) -> None:
    """Whatever the phase of the contact is, the rounded start is recognised.

    A start off the curve is not.
    """
    from symosc import grazing_start, grazing_window

    rng = np.random.default_rng(seed)
    values = {
        name: str(value / 10) for name, value in zip("mck", rng.integers(5, 41, 3), strict=True)
    }
    p = FIG9.parameters.replace(**values, A0=int(rng.integers(-9, 10)), v1=-1, v2=5)
    for mapping in PLACES:
        window = grazing_window(p, mapping)
        for phase in [phase for phase in rng.uniform(0, 2 * pi, 40) if window.contains(phase)][:2]:
            t_m = phase / float(p.Omega)
            found = grazing_start(
                p, mapping, t_m=t_m, t0=Fraction(t_m).limit_denominator(100) - Fraction(1, 2)
            )
            if not found.found:
                continue
            x0, v0 = (round(Fraction(found.start[name]), 4) for name in ("x0", "v0"))
            scene = Scene("printed", p, Fraction(found.start["t0"]), x0, v0, Fraction(99))
            near = grazes.nearest_graze(scene, mapping)
            assert near.round_to_it, (mapping, phase)
            assert near.round_to_it[0] - 1e-6 <= t_m <= near.round_to_it[1] + 1e-6
            assert max(abs(near.dx), abs(near.dv)) <= 5e-5
            # Some step of a hundredth leads off the curve.
            steps = [
                {key: value + Fraction(s, 100)}
                for key, value in (("x0", x0), ("v0", v0))
                for s in (1, -1)
            ]
            assert not all(
                grazes.nearest_graze(replace(scene, **step), mapping).round_to_it for step in steps
            )


@pytest.mark.slow
@pytest.mark.parametrize(("name", "printed", "true"), [("A0", "7", 10.0), ("k", "3", 2.0)])
def test_a_misprint_that_was_put_into_a_graze_is_found(
    name: str, printed: str, true: float
) -> None:
    values = grazes.values_that_graze(
        changed(load_scene("fig7-corrected"), **{name: printed}), "P2", name
    )
    assert any(abs(each.value - true) <= 2 * each.uncertainty for each in values)
    assert any(float(each.shortest) == true and each.as_short_as_printed for each in values)


def printed_orbit(scene: Scene) -> Scene:
    """Return the scene with the start that a paper would print.

    The orbit's first switching to four decimals.
    """
    t, x = find_orbit(scene.parameters, scene.structure).points[0]
    return replace(scene, t0=f"{t:.4f}", x0=f"{x:.4f}")


@pytest.mark.slow
@pytest.mark.full(2)
@pytest.mark.parametrize(
    ("scene", "name", "true"),
    [(FIG9, "Omega", "3.9"), (FIG9, "c", "0.3"), (FIG9, "mu1", "0.25"), (FIG10, "mu2", "0.33")],
)
def test_a_misprinted_parameter_of_an_orbit_is_found(scene: Scene, name: str, true: str) -> None:
    right = printed_orbit(changed(scene, **{name: true}))
    found, other = orbits.search_parameters(
        replace(right, parameters=scene.parameters), (name, "m")
    )
    assert found.name == name
    assert found.explains
    assert found.value == pytest.approx(float(true), abs=2e-3)
    assert found.searched[0] < float(true) < found.searched[1]
    assert not other.explains


@pytest.mark.parametrize("name", ["t0", "x0"])
def test_a_misprinted_start_of_an_orbit_is_found(name: str) -> None:
    right = printed_orbit(FIG9)
    assert orbits.start_or_misprint(right).verdict == CONFIRMED
    assert all(each.explains for each in orbits.search_start(right)[:2])
    wrong = replace(right, **{name: getattr(right, name) + Fraction(1, 2)})
    found = {each.name: each for each in orbits.search_start(wrong)}
    assert found[name].explains
    assert found[name].value == pytest.approx(float(getattr(right, name)), abs=1e-4)
    assert not any(each.explains for other, each in found.items() if other != name)


def test_the_print_of_fig8_is_right() -> None:
    near = grazes.nearest_graze(load_scene("fig8"), "P3")
    assert near.round_to_it
    # Known to 50 digits: exactly the contacts between these times have starts that round to
    # (5.8980, 2.2580).
    assert near.round_to_it == pytest.approx([3.1415787, 3.1415839], abs=1e-7)
    found = grazes.starts_that_graze(load_scene("fig8"), "P3", np.array([3.14158]))
    assert found[:, 0] == pytest.approx((5.89795221480835613987, 2.257969994383412060), abs=1e-12)


# --- what a lemma supposes, and starts that are judged alike ---


def test_the_counterexample_to_lemma_1_meets_its_hypotheses() -> None:
    """Both flows come to the boundary, and the mass sticks, also in the simulation."""
    contact = theorems.HELD_WITHOUT_FORCE
    assert contact.forces == (0, Fraction(-1, 5))
    assert contact.derivatives(1)[:3] == (0, 0, 1)
    assert contact.side(1, after=False) < 0 < contact.side(2, after=False)
    assert contact.sticks
    p = contact.p
    onset = simulate(p, t0="pi", x0="-4/5", v0=0, t_end=3.5, digits=30).events[-1]
    assert (onset.kind, onset.boundary) == ("stick", 1)
    assert float(onset.t) == pytest.approx(pi, abs=1e-12)
    assert theorems.lemma(1).numbers["a contact that is left out"] == str(contact)


@pytest.mark.parametrize(("scene", "verdict"), [(FIG6, CONFIRMED), (FIG10, CORRECTED)])
def test_sticks_at_the_start_are_judged_alike(scene: Scene, verdict: str) -> None:
    assert motions.sticks_at_start(scene, 2).verdict == verdict
