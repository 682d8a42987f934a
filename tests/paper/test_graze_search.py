"""Starts of grazing motions next to printed ones, and misprints that were put in."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest

from symosc import Parameters, Scene, grazing_start, grazing_window, load_scene
from symosc.mappings.theorem7_cases import PLACES
from symosc.paper.checks import dop853, grazing_starts
from symosc.paper.checks.linear_flow import flow
from symosc.paper.graze_search import FreeValue, nearest_graze, search, starts_that_graze

HALF_UNIT = 5e-5


def drawn(seed: int) -> Parameters:
    """Return random parameters, of few digits; one in four is critically damped."""
    draw = random.Random(seed)
    values = {name: Fraction(draw.randint(5, 40), 10) for name in ("m", "c", "k", "B0", "Omega", "FN")}
    if seed % 4 == 0:
        values |= {"m": Fraction(1), "c": Fraction(2), "k": Fraction(1)}
    v1 = Fraction(draw.randint(-10, 10), 10)
    return Parameters(A0=draw.randint(-9, 9), v1=v1, v2=v1 + 6, mu1="0.3", mu2="0.2", **values)


@pytest.mark.parametrize("seed", range(8))
def test_the_second_closed_form_is_the_flow(seed: int) -> None:
    p = drawn(seed)
    times, states = dop853.flight(p, p.A(2), (0.5, 6.0), (1.0, 2.0))
    x, v = flow(p, p.A(2), (0.5, 1.0, 2.0), times)
    assert np.abs(np.array([x, v]) - states).max() < 1e-7  # critical damping: 1e-8 of the roots apart


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(12))
def test_a_start_that_grazes_is_found_from_its_printed_digits(seed: int) -> None:
    """Whatever the phase of the contact is, the rounded start is recognised; a start off the curve is not."""
    draw = random.Random(seed)
    p = drawn(seed)
    for mapping in PLACES:
        window = grazing_window(p, mapping)
        phases = [phase for phase in (draw.uniform(0, 2 * pi) for _ in range(40)) if window.contains(phase)]
        for phase in phases[:2]:
            t_m = phase / float(p.Omega)
            found = grazing_start(p, mapping, t_m=t_m, t0=Fraction(t_m).limit_denominator(100) - Fraction(1, 2))
            if not found.found:
                continue
            x0, v0 = (round(Fraction(found.start[name]), 4) for name in ("x0", "v0"))
            scene = Scene("printed", p, Fraction(found.start["t0"]), x0, v0, Fraction(99))
            near = nearest_graze(scene, mapping, HALF_UNIT)
            assert near.rounds, (mapping, phase)
            assert near.t_low - 1e-6 <= t_m <= near.t_high + 1e-6
            assert max(abs(near.dx), abs(near.dv)) <= HALF_UNIT
            # Some step of a hundredth leads off the curve.
            steps = [replace(scene, x0=x0 + Fraction(sign, 100)) for sign in (1, -1)]
            steps += [replace(scene, v0=v0 + Fraction(sign, 100)) for sign in (1, -1)]
            assert not all(nearest_graze(step, mapping, HALF_UNIT).rounds for step in steps)


def test_the_print_of_fig8_is_right() -> None:
    near = nearest_graze(load_scene("fig8"), "P3", HALF_UNIT)
    assert near.rounds
    # Known to 50 digits: exactly the contacts between these times have starts that round to (5.8980, 2.2580).
    assert (near.t_low, near.t_high) == pytest.approx((3.1415787, 3.1415839), abs=1e-7)
    x, v = starts_that_graze(load_scene("fig8"), "P3", np.array([3.14158]))
    assert (x[0], v[0]) == pytest.approx((5.89795221480835613987, 2.257969994383412060), abs=1e-12)


@pytest.mark.slow
def test_both_explanations_of_fig7() -> None:
    scene = load_scene("fig7")
    found = search(scene, "P2", HALF_UNIT, ["A0", "mu1", "FN", "v1", "x0", "v0", "t0"])
    short = {each.name: each for each in found if grazing_starts.explains(scene, each)}
    assert short["A0"].shortest == "10"
    assert short["x0"].value == pytest.approx(-5.6049, abs=HALF_UNIT)
    assert short["A0"].t_m == pytest.approx(pi, abs=1e-5)
    assert short["x0"].t_m == pytest.approx(pi, abs=1e-5)
    assert set(short) == {"A0", "x0", "v0"}  # no other number is as short as it is printed
    said = grazing_starts.misprints(scene, found)
    assert said.startswith("A0 = 10 (at t = 3.14159) or x0 = -5.6049 (at t = 3.14159); also, ")


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "printed", "true"), [("A0", "7", 10.0), ("FN", "9.18", 9.81), ("k", "3", 2.0)])
def test_a_misprint_that_was_put_in_is_found(name: str, printed: str, true: float) -> None:
    right = load_scene("fig7-corrected")
    wrong = replace(right, parameters=right.parameters.replace(**{name: printed}))
    values = search(wrong, "P2", HALF_UNIT, [name])
    assert any(abs(each.value - true) <= 2 * each.uncertainty for each in values)
    assert any(float(each.shortest) == true and grazing_starts.explains(wrong, each) for each in values)


def test_the_shortest_number_within_the_uncertainty() -> None:
    assert FreeValue("A0", 9.99998, 1e-4, 3.0).shortest == "10"
    assert FreeValue("A0", 9.99998, 1e-4, 3.0).digits == 2
    assert FreeValue("mu1", 0.70968, 1e-6, 3.0).digits == 5
    assert FreeValue("x0", -5.6049, 5e-5, 3.0).shortest == "-5.6049"
