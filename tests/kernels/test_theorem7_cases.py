"""Theorem 7's cases against the set of phases itself, and its ends in doubles against 50 digits."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from math import isclose, pi, sin
from typing import Any

import mpmath
import numpy as np
import pytest
from window_samples import exact_ends, ulps

from symosc import load_scene
from symosc.grazing.window import grazing_window, grazing_windows
from symosc.kernels import double_double, theorem7_cases
from symosc.kernels.theorem7_cases import (
    ALL_BUT_ONE,
    ARC,
    EMPTY,
    EQUALITY_UNDECIDED,
    EVERYTHING,
    WRAPPED_ARC,
    window_kind,
)

NUMBERS = [(gamma, amplitude) for gamma in (-3, -2, -1, 0, 1, 2, 3) for amplitude in (-2, 0, 2)]


def sign(value: Any) -> int:
    return (value > 0) - (value < 0)


def signs(gamma: int, amplitude: int) -> tuple[int, int, int]:
    return sign(gamma), sign(amplitude), sign(abs(gamma) - abs(amplitude))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("gamma", "amplitude"), NUMBERS)
def test_a_kind_is_what_the_set_of_phases_is(side: int, gamma: int, amplitude: int) -> None:
    """The phases with side (gamma + amplitude sin theta) > 0.

    None, all, all but one, an arc, or one through 0.
    """
    count = 360
    values = [side * (gamma + amplitude * sin(2 * pi * n / count)) for n in range(count)]
    inside = [value > 1e-12 for value in values]
    edges = sum(a != b for a, b in zip(inside, inside[1:] + inside[:1], strict=True))
    if not any(inside):
        expected = {EMPTY}
    elif all(inside):
        expected = {EVERYTHING}
    elif sum(inside) == count - 1:
        expected = {ALL_BUT_ONE}
    else:
        assert edges == 2
        # B0 < 0 is B0 > 0 half a period later: the kind is that of the window before the shift
        if amplitude > 0:
            start = inside[0]
        else:
            start = inside[count // 2]
        if start:
            expected = {WRAPPED_ARC}
        else:
            expected = {ARC}
        if isclose(values[0], 0, abs_tol=1e-12):  # gamma = 0: from 0 to pi, or the other half
            expected = {ARC}
    assert window_kind(side, *signs(gamma, amplitude), full=False) in expected


@pytest.mark.parametrize("side", [1, -1])
def test_at_equality_the_full_order_takes_the_last_phase_too(side: int) -> None:
    """There G^(3) = -gamma Omega^2 decides: for a flow from below a graze needs G^(3) < 0."""
    for gamma in (-2, 2):
        graze = side * gamma > 0
        assert window_kind(side, *signs(gamma, 2), full=True) == (EVERYTHING if graze else EMPTY)
        assert window_kind(side, *signs(gamma, 2), full=False) == (ALL_BUT_ONE if graze else EMPTY)


FIG9 = load_scene("fig9").parameters
mp = mpmath.mp.clone()
mp.dps = 50


def test_single_windows_have_the_nearest_doubles() -> None:
    rng = random.Random(4)
    for _ in range(200):
        ratio = rng.choice([1, -1]) * (1 - Fraction(rng.randint(1, 99), 10 ** rng.randint(2, 40)))
        window = grazing_window(
            FIG9.replace(k=abs(ratio), v1=1 if ratio > 0 else -1, B0=1, Omega=1), "P2"
        )
        ends = exact_ends(ratio, Fraction(1))
        inner = [
            end
            for low, high, *_ in window.intervals
            for end in (low, high)
            if 0 < end < double_double.TWO_PI_PAIR[0]
        ]
        assert inner
        assert all(ulps(end, ends) <= 0.5001 for end in inner)


def test_extreme_magnitudes() -> None:
    # k v/(B0 Omega) = 0.3, of numbers whose products no double can hold
    values = np.array([1e-150, 1e-100, 1e40, 1e50])
    windows = grazing_windows(FIG9, "P2", k=values, v1=3e-201, B0=values * 1e-150, Omega=1e-50)
    assert list(windows.kind) == [WRAPPED_ARC] * 4
    assert windows.theta_cr == pytest.approx([-math.asin(0.3)] * 4, rel=1e-14)
    assert list(
        grazing_windows(FIG9, "P2", k=1e50, v1=1e-300, Omega=1e-50, B0=1e-201).kind[None]
    ) == [EVERYTHING]
    assert grazing_windows(FIG9, "P2", k=1e-300, v1=1e-300, Omega=1e50, B0=1e50).kind == WRAPPED_ARC


def test_equality_is_decided_for_doubles_and_left_open_for_anything_else() -> None:
    """|k v| = |B0 Omega|: four doubles say so exactly.

    If one of them has more digits rational numbers must decide.
    """
    rng = random.Random(5)
    for _ in range(60):
        k, v, B, Omega = (float(rng.choice([-1, 1]) * rng.randint(1, 99)) for _ in range(4))
        k = abs(k)
        Omega = abs(Omega)
        v, B = v * B * Omega, B * abs(v) * k  # both products are k |v| |B| Omega
        side = rng.choice([-1, 1])
        full = rng.random() < 0.5
        numbers = [k, v, B, Omega]
        kind, low, high, theta_cr = theorem7_cases.window(
            *((value, 0.0) for value in numbers), side, full
        )
        p = (v > 0) - (v < 0)
        q = (B > 0) - (B < 0)
        assert kind == window_kind(side, p, q, 0, full)
        assert theta_cr == pytest.approx(-p * q * math.pi / 2)
        if p * q < 0:
            point = math.pi / 2
        else:
            point = 3 * math.pi / 2
        if kind == ALL_BUT_ONE:
            assert (low, high) == pytest.approx((point, point))
        else:
            assert np.isnan([low, high]).all()
        for i, value in enumerate(numbers):
            rest = rng.choice([-1, 1]) * abs(value) * 2.0**-110
            pairs = [(first, rest if j == i else 0.0) for j, first in enumerate(numbers)]
            assert theorem7_cases.window(*pairs, side, full)[0] == EQUALITY_UNDECIDED
            rest = rng.choice([-1, 1]) * abs(value) * 2.0**-70  # clear enough for pairs
            pairs = [(first, rest if j == i else 0.0) for j, first in enumerate(numbers)]
            more = (1 if rest * value > 0 else -1) * (1 if i < 2 else -1)
            result = theorem7_cases.window(*pairs, side, full)
            assert result[0] == window_kind(side, p, q, more, full)
            assert np.isnan(result[3]) == (more > 0)


def test_windows_of_random_magnitudes_are_those_of_many_digits() -> None:
    """Products of numbers from 1e-200 to 1e200, with all signs.

    The kind, and every end within an ulp.
    """
    rng = random.Random(6)
    for _ in range(150):
        k = 10 ** rng.uniform(-200, 200)
        Omega = 10 ** rng.uniform(-100, 100)
        v = rng.choice([-1, 1]) * 10 ** rng.uniform(-60, 60)
        ratio = 10 ** rng.uniform(-6, 2) * rng.choice([-1, 1])
        B = k / Omega * v / ratio
        if not 1e-300 < abs(B) < 1e300:
            continue
        side = rng.choice([-1, 1])
        full = rng.random() < 0.5
        kind, low, high, theta_cr = theorem7_cases.window(
            (k, 0.0), (v, 0.0), (B, 0.0), (Omega, 0.0), side, full
        )
        level = Fraction(k) * Fraction(v)
        swing = Fraction(B) * Fraction(Omega)
        signs = [(number > 0) - (number < 0) for number in (level, swing, abs(level) - abs(swing))]
        assert kind == window_kind(side, *signs, full)
        if signs[2] > 0:
            assert np.isnan([low, high, theta_cr]).all()
            continue
        cut = mp.asin(
            -mp.mpf(level.numerator)
            / level.denominator
            * swing.denominator
            / mp.mpf(swing.numerator)
        )
        ends = [mp.pi - cut, cut if cut > 0 else cut + 2 * mp.pi]
        if side * signs[1] < 0:
            right = ends
        else:
            right = ends[::-1]
        assert abs(theta_cr - cut) <= math.ulp(float(cut))
        assert all(
            abs(a - b) <= math.ulp(float(b)) for a, b in zip((low, high), right, strict=True)
        )
        assert kind == (ARC if right[0] < right[1] else WRAPPED_ARC)
