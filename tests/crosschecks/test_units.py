"""A cross-check says the same in any units."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from excerpts import crosscheck
from units import UNITS, Units

from symosc import CrossCheck, Parameters, load_scene, simulate


@cache
def samples(name: str) -> tuple[Parameters, np.ndarray, CrossCheck]:
    """Return a scene's parameters, samples of its motion with several faults, and what a cross-check says of them."""
    scene = load_scene(name)
    t = np.linspace(float(scene.t0), float(scene.t0) + 8, 97)
    x, v = simulate(scene, t_end=9)(t)
    x, v = x + 1e-10 * np.sin(9 * t), v + 1e-10 * np.cos(7 * t)
    x[20] += 0.01
    v[40:] += 1e-3
    v[70] = float(scene.parameters.v1) - 0.3
    return scene.parameters, np.array([t, x, v]), crosscheck(scene.parameters, t, x, v)


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", UNITS, ids=str)
@pytest.mark.parametrize("name", ["fig5", "fig9"])
def test_a_cross_check_is_the_same(units: Units, name: str) -> None:
    """Errors and what is allowed, step by step; events, reasons and words, for samples with several faults."""
    T, L, V = float(units.time), float(units.length), units.speed
    p, columns, one = samples(name)
    two = crosscheck(units.of(p), *(columns * np.array([[T], [L], [V]])))
    for kind in ("errors", "defects", "allowed"):
        found = getattr(two, kind) / [L, V]
        assert found == pytest.approx(getattr(one, kind), rel=1e-6, abs=1e-11 if kind != "allowed" else 0)
    assert two.scales == pytest.approx((one.scales[0] * L, one.scales[1] * V), rel=1e-9)
    assert two.wrong_steps.tolist() == one.wrong_steps.tolist()
    assert two.modes.tolist() == one.modes.tolist()
    said = [[(f.step, f.reason, f.expected, f.found) for f in each.faults] for each in (one, two)]
    assert said[0] == said[1]
    for name_of in ("missed", "invented", "unresolved"):
        found, right = ([(e.kind, e.boundary) for e in getattr(each, name_of)] for each in (two, one))
        assert found == right
    assert [float(m.t) for m in two.matched] == pytest.approx([float(m.t) * T for m in one.matched], rel=1e-9)
    assert len(one.faults) > 2
