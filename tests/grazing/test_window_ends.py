"""The ends of windows are the nearest doubles."""

from __future__ import annotations

import itertools
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
from symosc.mappings.theorem7_cases import ALL_BUT_ONE, ARC, EQUALITY_IN_DOUBT, EVERYTHING, WRAPPED_ARC, window_kind
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


def test_equality_is_decided_for_doubles_and_left_open_for_anything_else() -> None:
    """|k v| = |B0 Omega|: four doubles say so exactly; if one of them has more digits rational numbers must decide."""
    rng = random.Random(5)
    for _ in range(60):
        k, v, B, Omega = (float(rng.choice([-1, 1]) * rng.randint(1, 99)) for _ in range(4))
        k, Omega = abs(k), abs(Omega)
        v, B = v * B * Omega, B * abs(v) * k  # both products are k |v| |B| Omega
        side, full = rng.choice([-1, 1]), rng.random() < 0.5
        numbers = [k, v, B, Omega]
        kind, low, high, theta_cr = window_ends.window(*((each, 0.0) for each in numbers), side, full)
        p, q = (v > 0) - (v < 0), (B > 0) - (B < 0)
        assert kind == window_kind(side, p, q, 0, full)
        assert theta_cr == pytest.approx(-p * q * math.pi / 2)
        point = math.pi / 2 if p * q < 0 else 3 * math.pi / 2
        assert (low, high) == pytest.approx((point, point)) if kind == ALL_BUT_ONE else np.isnan([low, high]).all()
        for i, each in enumerate(numbers):
            rest = rng.choice([-1, 1]) * abs(each) * 2.0**-110
            pairs = [(other, rest if j == i else 0.0) for j, other in enumerate(numbers)]
            assert window_ends.window(*pairs, side, full)[0] == EQUALITY_IN_DOUBT
            rest = rng.choice([-1, 1]) * abs(each) * 2.0**-70  # clear enough for pairs
            pairs = [(other, rest if j == i else 0.0) for j, other in enumerate(numbers)]
            more = (1 if rest * each > 0 else -1) * (1 if i < 2 else -1)
            found = window_ends.window(*pairs, side, full)
            assert found[0] == window_kind(side, p, q, more, full)
            assert np.isnan(found[3]) == (more > 0)


def test_windows_of_random_magnitudes_are_those_of_many_digits() -> None:
    """Products of numbers from 1e-200 to 1e200, with all signs: the kind, and every end within an ulp."""
    rng = random.Random(6)
    for _ in range(150):
        k, Omega = 10 ** rng.uniform(-200, 200), 10 ** rng.uniform(-100, 100)
        v, ratio = rng.choice([-1, 1]) * 10 ** rng.uniform(-60, 60), 10 ** rng.uniform(-6, 2) * rng.choice([-1, 1])
        B = k / Omega * v / ratio
        if not 1e-300 < abs(B) < 1e300:
            continue
        side, full = rng.choice([-1, 1]), rng.random() < 0.5
        kind, low, high, theta_cr = window_ends.window((k, 0.0), (v, 0.0), (B, 0.0), (Omega, 0.0), side, full)
        level, swing = Fraction(k) * Fraction(v), Fraction(B) * Fraction(Omega)
        signs = [(each > 0) - (each < 0) for each in (level, swing, abs(level) - abs(swing))]
        assert kind == window_kind(side, *signs, full)
        if signs[2] > 0:
            assert np.isnan([low, high, theta_cr]).all()
            continue
        cut = mp.asin(-mp.mpf(level.numerator) / level.denominator * swing.denominator / mp.mpf(swing.numerator))
        ends = [mp.pi - cut, cut if cut > 0 else cut + 2 * mp.pi]
        right = ends if side * signs[1] < 0 else ends[::-1]
        assert abs(theta_cr - cut) <= math.ulp(float(cut))
        assert all(abs(a - b) <= math.ulp(float(b)) for a, b in zip((low, high), right, strict=True))
        assert kind == (ARC if right[0] < right[1] else WRAPPED_ARC)


@pytest.mark.parametrize("mapping", ["P2", "P3", "P5", "P6"])
def test_of_a_window_without_one_phase_both_ends_are_that_phase(mapping: str) -> None:
    """In the paper's order, at |k v| = |B0 Omega|: there G^(1) is 0, -(k v + B0 Omega sin) = 0."""
    kinds = []
    for v, B0 in itertools.product((-3, 3), (-6, 6)):
        belts = {"v1": v, "v2": 5} if mapping in ("P2", "P3") else {"v1": -5, "v2": v}
        p = FIG9.replace(k=4, Omega=2, B0=B0, **belts)
        window = grazing_window(p, mapping, "paper")
        kinds.append(window.kind)
        if window.kind == ALL_BUT_ONE:
            low, high = window.ends
            assert low == high
            assert 4 * v + 2 * B0 * math.sin(low) == pytest.approx(0.0, abs=1e-12)
            assert window.contains(low + 0.1)
            assert window.contains(low - 0.1)
    assert kinds.count(ALL_BUT_ONE) == 2
