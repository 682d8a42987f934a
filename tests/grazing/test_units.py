"""The way back from a tangency, windows and curves are the same in any units."""

from __future__ import annotations

import random

import numpy as np
import pytest
from agreement import BASE
from touches import tenths
from units import UNITS, Units

from symosc import Parameters, grazing_curve, grazing_start, grazing_window, load_scene
from symosc.engine.flow import constants
from symosc.grazing.backward_flow import Arrival, BackwardState, Search
from symosc.grazing.deciders import Ways
from symosc.grazing.flight import Flights
from symosc.mappings.theorem7_cases import PLACES

SCENES = [load_scene(name).parameters for name in ("fig5", "fig8", "fig9", "fig10")]


def systems(seed: int, count: int) -> list[Parameters]:
    rng = random.Random(seed)
    drawn = [
        BASE.replace(
            m=tenths(rng, 2, 30), c=tenths(rng, 0, 60), k=tenths(rng, 1, 60), Omega=tenths(rng, 3, 40),
            B0=tenths(rng, -60, 60), A0=tenths(rng, -30, 30),
        )
        for _ in range(count)
    ]  # fmt: skip
    return [*SCENES, *drawn]


def factors(units: Units) -> list[float]:
    """Return the factors of an arrival's numbers: tau, dx, v, a, and the errors of v and x."""
    return [float(units.time), float(units.length), units.speed, units.force, units.speed, float(units.length)]


def scaled(arrival: Arrival, units: Units) -> Arrival:
    numbers = (value * factor for value, factor in zip(arrival[2:], factors(units), strict=True))
    return Arrival(arrival.kind, arrival.boundary, *numbers)


@pytest.mark.quick(2)
@pytest.mark.parametrize("units", UNITS, ids=str)
def test_the_way_back_is_the_same(units: Units) -> None:
    """To the last bit, with the bounds of its errors: to the first contact, and step by step to any time."""
    rng, kinds = random.Random(3), set()
    for p in systems(4, 5):
        q = units.of(p)
        for mapping, place in PLACES.items():
            one, two = (Search(constants(each), place.boundary, place.domain) for each in (p, q))
            for _ in range(2):
                theta, far = rng.uniform(0, 6.28), rng.choice([0.3, 3.0, 20.0]) * one.K.period
                plain = one.run(theta, 1, far)
                kinds.add(plain.kind)
                assert two.run(theta, 1, far * float(units.time)) == scaled(plain, units), (p, mapping, theta)
    assert kinds >= {"contact", "reached"}


@pytest.mark.parametrize("units", UNITS[:5:2], ids=str)
def test_flights_with_many_digits_are_the_same(units: Units) -> None:
    """The closed form, its errors, how many digits an arrival lacks, and what is polished."""
    T, L, V, F = float(units.time), float(units.length), units.speed, units.force
    rng = random.Random(5)
    for p in systems(6, 4):
        one, two = (Flights(each, "P3", 30) for each in (p, units.of(p)))
        theta, tau = one.context.mpf(rng.uniform(0, 6)), one.context.mpf(rng.uniform(0.1, 3))
        a, b = one.instant(theta, tau), two.instant(theta, tau * T)
        sizes = [L, V, F, F / T, F / T**2, V, L, V, L]
        right = [float(v * size) for v, size in zip(a, sizes, strict=True)]
        assert [float(value) for value in b] == pytest.approx(right, rel=1e-12)
        state, other = one.state(theta, tau), two.state(theta, tau * T)
        errors = [T, L, V, F, F, V, L]
        right = [float(v * s) for v, s in zip(state, errors, strict=True)]
        assert [float(value) for value in BackwardState(*other)] == pytest.approx(right, rel=1e-12)


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", UNITS, ids=str)
@pytest.mark.parametrize(("p", "mapping"), [(SCENES[2], "P2"), (SCENES[3], "P5")], ids=["fig9", "fig10"])
def test_windows_curves_and_starts_are_the_same(units: Units, p: Parameters, mapping: str) -> None:
    q, L = units.of(p), float(units.length)
    one, two = grazing_window(p, mapping), grazing_window(q, mapping)
    assert (one.intervals, one.case, one.theta_cr) == (two.intervals, two.case, two.theta_cr)
    theta = np.linspace(*one.intervals[0][:2], 9)[1:-1]
    assert two.contact(theta) == pytest.approx(one.contact(theta) * L, rel=1e-12)
    assert Ways(two).slope(theta) == pytest.approx(Ways(one).slope(theta), rel=1e-12)
    (a, *_), (b, *_) = (grazing_curve(each, mapping, 24).pieces for each in (p, q))
    assert b.theta_m == pytest.approx(a.theta_m, rel=1e-12)
    assert b.theta == pytest.approx(a.theta, rel=1e-9)
    assert b.x == pytest.approx(a.x * L, rel=1e-9)
    assert b.slope_x == pytest.approx(a.slope_x * L, rel=1e-6)
    start, other = (grazing_start(each, mapping, float(theta[3])) for each in (p, q))
    assert other.x == pytest.approx(start.x * L, rel=1e-12)
    assert other.t == pytest.approx(start.t * float(units.time), rel=1e-12)
