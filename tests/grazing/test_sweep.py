"""Sweeps of windows: many at once, as single ones are."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from window_samples import exact_ends, parameters, ulps

from symosc.errors import ParameterError
from symosc.grazing.sweep import grazing_windows
from symosc.grazing.window import grazing_window
from symosc.mappings.theorem7_cases import ALL_BUT_ONE, ARC, EMPTY, EVERYTHING, WRAPPED_ARC
from symosc.scenes import load_scene

MAPS = ("P2", "P3", "P5", "P6")

ORDERS = ("paper", "full")

FIG9 = load_scene("fig9").parameters

mp = mpmath.mp.clone()

mp.dps = 50


@pytest.mark.slow
@pytest.mark.parametrize("mapping", ["P2", "P6"])
def test_sweep_ends_are_within_one_unit_in_the_last_place(mapping: str) -> None:
    rng = np.random.default_rng(5)
    n = 800
    k, v, B0 = rng.uniform(0.1, 5, n), rng.uniform(-3, 3, n), rng.uniform(-9, 9, n)
    ratio = rng.choice([-1, 1], n) * (1 - 10.0 ** rng.uniform(-16, 0, n))
    ratio[:200] = 10.0 ** rng.uniform(-45, 0, 200)
    Omega = np.abs(k * v / B0 / ratio)
    name = "v1" if mapping == "P2" else "v2"
    p = FIG9.replace(v1=-100, v2=100)
    found = grazing_windows(p, mapping, k=k, B0=B0, Omega=Omega, **{name: v})
    worst, arcs = 0.0, 0
    for i in range(n):
        if found.kind[i] not in (ARC, WRAPPED_ARC):
            continue
        level, swing = Fraction(k[i]) * Fraction(v[i]), Fraction(B0[i]) * Fraction(Omega[i])
        ends = exact_ends(level, swing)
        worst = max([worst, *(ulps(float(x), ends) for x in (found.low[i], found.high[i], found.theta_cr[i]))])
        arcs += 1
    assert arcs > 700
    assert worst <= 0.501


@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("order", ORDERS)
def test_sweeps_agree_with_single_windows(mapping: str, order: str) -> None:
    rng = random.Random(mapping + order)
    for _ in range(25):
        p = parameters(rng)
        name = rng.choice(["k", "B0", "Omega"])
        values = [float(abs(getattr(p, name)))] + [rng.uniform(0.1, 9) for _ in range(6)]
        values = [value if value > 0 else 1.0 for value in values]
        found = grazing_windows(p, mapping, order, **{name: values})
        for i, value in enumerate(values):
            single = grazing_window(p.replace(**{name: Fraction(value)}), mapping, order)
            assert found.kind[i] == single.kind
            if single.kind in (ARC, WRAPPED_ARC, ALL_BUT_ONE):
                assert abs(found.low[i] - single.ends[0]) <= math.ulp(single.ends[0])
                assert abs(found.high[i] - single.ends[1]) <= math.ulp(single.ends[1])


def test_sweep_decides_equality_exactly_with_fractions() -> None:
    p = FIG9.replace(k="1/3", v1=1, Omega="1/3")  # equality at B0 = +-1, which no double of 1/3 would show
    values = np.array([-1.0, 1.0, 0.0, math.nextafter(1, 0), math.nextafter(1, 2)])
    assert list(grazing_windows(p, "P2", "paper", B0=values).kind) == [
        ALL_BUT_ONE,
        ALL_BUT_ONE,
        EVERYTHING,
        EVERYTHING,
        WRAPPED_ARC,
    ]
    assert list(grazing_windows(p, "P2", "full", B0=values).kind[:2]) == [EVERYTHING, EVERYTHING]
    assert list(grazing_windows(p, "P3", "full", B0=values).kind) == [EMPTY, EMPTY, EMPTY, EMPTY, ARC]
    near = FIG9.replace(k=Fraction(1, 3) * (1 - Fraction(1, 2**99)), v1=1, Omega="1/3")
    doubt = grazing_windows(near, "P2", B0=[1.0])
    ends = exact_ends(near.k, near.Omega)
    assert doubt.kind[0] == WRAPPED_ARC
    assert max(ulps(float(x[0]), ends) for x in (doubt.low, doubt.high, doubt.theta_cr)) <= 0.501


def test_sweep_shapes_and_bad_sweeps() -> None:
    found = grazing_windows(FIG9, "P2", Omega=np.linspace(1, 5, 3)[:, None], B0=np.linspace(-9, 9, 4))
    assert found.low.shape == found.kind.shape == (3, 4)
    assert grazing_windows(FIG9, "P2").kind.shape == ()
    assert grazing_windows(FIG9, "P2", Omega=np.array([])).kind.shape == (0,)
    bad: list[tuple[str, Any]] = [("c", [1.0]), ("v2", [30.0]), ("Omega", [1.0, 0.0]), ("Omega", "abc"), ("k", [-1.0])]
    bad += [("k", [math.nan]), ("B0", [math.inf]), ("v1", [26.0]), ("Omega", [[1], [2, 3]])]
    for name, values in bad:
        with pytest.raises(ParameterError, match=name):
            grazing_windows(FIG9, "P2", **{name: values})


def test_columns_are_equal_by_their_values() -> None:
    """Not a number equals itself here; what is no column of windows is never equal."""
    one, two, other = (grazing_windows(FIG9, "P2", Omega=[0.05, 1, last]) for last in (4, 4, 5))
    assert np.isnan(one.low).any()
    assert (one == two, one != two) == (True, False)
    assert (one == other, one != other) == (False, True)
    assert (one == tuple(one), one != tuple(one)) == (False, True)


@pytest.mark.parametrize("mapping", MAPS)
def test_at_equality_the_order_decides(mapping: str) -> None:
    """In a sweep as for one window: the tangency of fourth order belongs to the window in full order only."""
    kinds: dict[str, set[int]] = {order: set() for order in ORDERS}
    for B0 in (-6.0, 6.0):
        for v in (-3, 3):
            speeds = {"v1": v, "v2": v + 1} if mapping in ("P2", "P3") else {"v1": v - 1, "v2": v}
            p = FIG9.replace(k=2, Omega=1, **speeds)
            for order in ORDERS:
                found = grazing_windows(p, mapping, order, B0=[B0])
                assert found.kind.tolist() == [grazing_window(p.replace(B0=B0), mapping, order).kind]
                kinds[order] |= set(found.kind.tolist())
    assert ALL_BUT_ONE in kinds["paper"]
    assert ALL_BUT_ONE not in kinds["full"]
