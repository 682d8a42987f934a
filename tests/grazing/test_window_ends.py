"""The ends of windows are the nearest doubles."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from window_samples import exact_ends, ulps

from symosc.grazing import window_ends
from symosc.grazing.sweep import grazing_windows
from symosc.grazing.window import grazing_window
from symosc.kernels import double_double
from symosc.mappings.theorem7_cases import EVERYTHING, WRAPPED_ARC
from symosc.scenes import load_scene

FIG9 = load_scene("fig9").parameters

mp = mpmath.mp.clone()

mp.dps = 50


def test_single_windows_have_the_nearest_doubles() -> None:
    rng = random.Random(4)
    for _ in range(200):
        ratio = rng.choice([1, -1]) * (1 - Fraction(rng.randint(1, 99), 10 ** rng.randint(2, 40)))
        window = grazing_window(FIG9.replace(k=abs(ratio), v1=1 if ratio > 0 else -1, B0=1, Omega=1), "P2")
        ends = exact_ends(ratio, Fraction(1))
        inner = [
            end for low, high, *_ in window.intervals for end in (low, high) if 0 < end < double_double.TWO_PI_PAIR[0]
        ]
        assert inner
        assert all(ulps(end, ends) <= 0.5001 for end in inner)


def test_extreme_magnitudes() -> None:
    # k v/(B0 Omega) = 0.3, of numbers whose products no double can hold
    values = np.array([1e-150, 1e-100, 1e40, 1e50])
    found = grazing_windows(FIG9, "P2", k=values, v1=3e-201, B0=values * 1e-150, Omega=1e-50)
    assert list(found.kind) == [WRAPPED_ARC] * 4
    assert found.theta_cr == pytest.approx([-math.asin(0.3)] * 4, rel=1e-14)
    assert list(grazing_windows(FIG9, "P2", k=1e50, v1=1e-300, Omega=1e-50, B0=1e-201).kind[None]) == [EVERYTHING]
    assert grazing_windows(FIG9, "P2", k=1e-300, v1=1e-300, Omega=1e50, B0=1e50).kind == WRAPPED_ARC


def test_compiled_and_interpreted_sources_agree_to_the_bit() -> None:
    rng = np.random.default_rng(8)
    k, B0 = rng.uniform(0, 5, 300), rng.uniform(-2, 2, 300)
    found = grazing_windows(FIG9, "P2", k=k, B0=B0)
    one, third = (1.0, 0.0), (4.0, 0.0)
    for i in range(300):
        row = window_ends.window((k[i], 0.0), one, (B0[i], 0.0), third, 1, True)
        assert tuple(float(column[i]) for column in found) == pytest.approx(row, abs=0, rel=0, nan_ok=True)
