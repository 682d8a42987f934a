"""Grazing windows: exact decisions against signs of 50 digits, ends in double precision, contacts, sweeps, text."""

from __future__ import annotations

import functools
import math
import random
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from samples import sample_of
from sympy import Interval, Rational, S, asin, pi
from window_samples import exact_ends, parameters, ulps

from symosc import ParameterError, Parameters, grazing_window, load_scene, theorem7
from symosc.grazing.window import GrazingWindow, grazing_windows
from symosc.kernels.theorem7_cases import ALL_BUT_ONE, ARC, EMPTY, EVERYTHING, WRAPPED_ARC
from symosc.scenes import scene_names
from symosc.symbolic.theorem7 import CIRCLE

MAPS = ("P2", "P3", "P5", "P6")
ORDERS = ("paper", "full")
FIG9 = load_scene("fig9").parameters
NO_TOP = Interval.Ropen(0, pi / 2) + Interval.open(pi / 2, 2 * pi)
NO_BOTTOM = Interval.Ropen(0, 3 * pi / 2) + Interval.open(3 * pi / 2, 2 * pi)
mp = mpmath.mp.clone()
mp.dps = 50


def forces(p: Parameters, mapping: str, theta: Any) -> list[Any]:
    """Return G^(1) to G^(4) at a contact (F = 0, x' = v) by differentiating the equation of motion.

    50 digits.
    """
    domain_belt = {"P2": 1, "P3": 1, "P5": 2, "P6": 2}
    v = p.belt(domain_belt[mapping])
    m, c, k, Omega, B0 = (
        mp.mpf(x.numerator) / x.denominator for x in (p.m, p.c, p.k, p.Omega, p.B0)
    )
    before = mp.mpf(v.numerator) / v.denominator
    now = mp.mpf(0)
    results = []
    for order in range(1, 5):
        # (d/dt)^order of B0 cos(Omega t) is B0 Omega^order cos(theta + order pi/2)
        drive = B0 * Omega**order * mp.cos(theta + order * mp.pi / 2)
        before, now = now, (drive - c * now - k * before) / m
        results.append(now)
    return results


def grazes(p: Parameters, mapping: str, theta: Any, order: str) -> bool:
    """Decide by the sign of the first G-function that is not 0 (within 1e-40 of its scale).

    Odd and outward.
    """
    scale = (
        1
        + float(abs(p.B0))
        + float(p.Omega) ** 4
        + float(p.k + abs(p.v1) + abs(p.v2) + p.c + 1 / p.m) ** 2
    )
    if mapping in ("P2", "P5"):
        outward = -1
    else:
        outward = 1
    for number, value in enumerate(forces(p, mapping, theta), start=1):
        if abs(value) > mp.mpf(10) ** -38 * scale:
            return number % 2 == 1 and value * outward > 0
        if order == "paper":
            return False
    return False


@pytest.mark.slow
@sample_of(12, 200)
def test_500_random_parameter_sets_agree_with_the_signs_of_50_digits(count: int) -> None:
    rng = random.Random(20240914)
    seen = set()
    for _ in range(500):
        p = parameters(rng)
        phases = [0.0, math.pi / 2, 1.5 * math.pi] + [
            rng.uniform(0, 2 * math.pi) for _ in range(count - 3)
        ]
        sine = functools.cache(lambda theta: mp.sin(mp.mpf(theta)))  # of exactly this double
        for mapping in MAPS:
            window = grazing_window(p, mapping, rng.choice(ORDERS))
            seen.add(window.case)
            near = [end for low, high, *_ in window.intervals for end in (low, high)] or [
                math.pi / 2
            ]
            close = [
                end + rng.choice([-1, 1]) * 10.0 ** -rng.uniform(1, 16)
                for end in near
                for _ in range(6)
            ]
            tried = (near + close + phases)[:count]
            contained = window.contains(np.array(tried))
            v = p.belt(window.place.boundary)
            level, swing = (mp.mpf(x.numerator) / x.denominator for x in (p.k * v, p.B0 * p.Omega))
            if mapping in ("P2", "P5"):
                side = 1
            else:
                side = -1
            for theta, inside in zip(tried, contained, strict=True):
                sign = side * (level + swing * sine(theta))
                assert abs(sign) > mp.mpf(10) ** -45 or p.B0 == 0 or theta == 0, (
                    "not decided by 50 digits"
                )
                assert inside == (sign > 0), (p, mapping, theta)
    wanted = {f"({e}.{n})" for e in (55, 57) for n in "123456abc"} | {
        f"({e}.{n})" for e in (56, 58) for n in "123456bc"
    }
    wanted |= {f"{label} shifted by pi" for label in wanted if label[4] not in "bc"}
    assert seen == wanted


@pytest.mark.slow
@sample_of(6, 100)
def test_random_rational_multiples_of_pi_agree_with_the_g_functions(count: int) -> None:
    rng = random.Random(7)
    graze_at_equality = 0
    for _ in range(count):
        p = parameters(rng)
        for mapping in MAPS:
            for order in ORDERS:
                window = grazing_window(p, mapping, order)
                for numerator in (0, 1, 3, 6, 9, 12, 13, 18, 20, 23, 24, 30):
                    theta = pi * Rational(numerator, 12)
                    expected = grazes(p, mapping, mp.pi * numerator / 12, order)
                    assert window.contains(theta) == expected, (p, mapping, theta)
                    assert (theta % (2 * pi) in window.phases) == expected
                    graze_at_equality += order == "full" and expected != window_of(
                        p, mapping
                    ).contains(theta)
    assert graze_at_equality > count / 4  # the tangencies of fourth order have been met


def window_of(p: Parameters, mapping: str) -> GrazingWindow:
    return grazing_window(p, mapping, "paper")


def test_fig7_and_fig8_sit_on_the_equality() -> None:
    fig7 = load_scene("fig7").parameters
    fig8 = load_scene("fig8").parameters
    assert (grazing_window(fig7, "P2").gamma, grazing_window(fig7, "P2").amplitude) == (10, 10)
    assert (grazing_window(fig8, "P3").gamma, grazing_window(fig8, "P3").amplitude) == (-16, 16)
    expected = [
        (fig7, "P2", "(55.2)", NO_BOTTOM, CIRCLE),
        (fig8, "P2", "(55.a)", S.EmptySet, S.EmptySet),
    ]
    expected += [(fig8, "P3", "(56.5)", NO_TOP, CIRCLE), (fig8, "P5", "(57.2)", NO_BOTTOM, CIRCLE)]
    expected += [
        (fig8, "P6", "(58.2)", S.EmptySet, S.EmptySet),
        (fig7, "P3", "(56.2)", S.EmptySet, S.EmptySet),
    ]
    for p, mapping, case, printed, full in expected:
        assert grazing_window(p, mapping, "paper").phases == printed
        assert grazing_window(p, mapping).phases == full
        assert grazing_window(p, mapping).case == case
    window = grazing_window(fig7, "P2", "paper")
    assert window.intervals == (
        (0.0, 1.5 * math.pi, True, False),
        (1.5 * math.pi, 2 * math.pi, False, False),
    )
    assert not window.contains(3 * pi / 2)
    assert not window.contains(-pi / 2)
    assert window.contains(1.5 * math.pi)  # a double that is not 3 pi/2
    assert grazing_window(fig7, "P2").contains(3 * pi / 2)
    assert window.theta_cr == -pi / 2


@pytest.mark.parametrize("name", scene_names())
@pytest.mark.parametrize("mapping", MAPS)
def test_window_is_the_theorem_at_the_scene(name: str, mapping: str) -> None:
    p = load_scene(name).parameters
    for order in ORDERS:
        window = grazing_window(p, mapping, order)
        if mapping in ("P2", "P3"):
            v = p.v1
        else:
            v = p.v2
        assert window.gamma == p.k * v / p.m
        assert window.phases == theorem7(mapping, p.k * v / p.m, p.B0 * p.Omega / p.m, order)
        ends = [
            (float(part.start), float(part.end), not part.left_open, not part.right_open)
            for part in (
                window.phases.args if isinstance(window.phases, sp.Union) else [window.phases]
            )
            if part is not S.EmptySet
        ]
        assert list(window.intervals) == ends


def test_open_and_closed_ends() -> None:
    window = grazing_window(FIG9, "P2")  # gamma = 30, amplitude = 360
    cut = asin(Rational(1, 12))
    assert window.theta_cr == -cut
    assert window.phases == Interval.Ropen(0, pi + cut) + Interval.open(2 * pi - cut, 2 * pi)
    for turns in (0, 2 * pi, -6 * pi):
        assert window.contains(0 + turns)
        assert not window.contains(pi + cut + turns)
        assert not window.contains(2 * pi - cut + turns)
        assert window.contains(pi + cut - Rational(1, 10**30) + turns)
        assert not window.contains(pi + cut + Rational(1, 10**30) + turns)
        assert grazing_window(FIG9, "P3").contains(pi + cut + Rational(1, 10**30) + turns)
    assert all(not closed for *_, closed in window.intervals)
    assert [low_closed for *_, low_closed, _ in window.intervals] == [True, False]


def test_float_phases_are_the_binary_numbers_that_they_are() -> None:
    for digits in range(
        12, 17
    ):  # windows whose end lies between the double and the decimal that it prints as
        cut = Fraction(round(10**digits * math.sin(0.25)), 10**digits)
        window = grazing_window(FIG9.replace(k=cut, v1=-1, B0=1, Omega=1), "P2")
        end = window.intervals[0][0]
        for theta in (end, math.nextafter(end, 0), math.nextafter(end, 1)):
            assert window.contains(theta) == (
                mp.sin(mp.mpf(theta)) > mp.mpf(cut.numerator) / cut.denominator
            )


def test_arrays() -> None:
    theta = np.linspace(-20, 20, 2000).reshape(40, 50)
    window = grazing_window(FIG9, "P5").contains(theta)
    assert window.shape == theta.shape
    assert window.all()
    inside = grazing_window(FIG9, "P3").contains(theta)
    assert inside.dtype == bool
    assert (
        inside == [[grazing_window(FIG9, "P3").contains(item) for item in row] for row in theta]
    ).all()
    assert 0.4 < inside.mean() < 0.55


def test_contacts_of_the_figures() -> None:
    fig7 = load_scene("fig7-corrected").parameters
    place = grazing_window(fig7, "P2").contact(pi)
    # (A0 + (mu1 + mu2) FN - B0 - c v1)/k = (10 + 8.829 - 10 - 10)/2
    assert place == Rational(-5855, 10000)
    fig8 = load_scene("fig8").parameters
    assert grazing_window(fig8, "P3").contact(2 * pi) == Rational(
        "4.51425"
    )  # theta = Omega pi = 2 pi
    with pytest.raises(ParameterError, match="must be inside the grazing window of P2"):
        grazing_window(fig8, "P2").contact(pi)


@pytest.mark.parametrize("mapping", MAPS)
def test_acceleration_vanishes_at_a_contact(mapping: str) -> None:
    domain, boundary = {"P2": (1, 1), "P3": (2, 1), "P5": (2, 2), "P6": (3, 2)}[mapping]
    rng = random.Random(3)
    tried = 0
    for _ in range(40):
        p = parameters(rng)
        window = grazing_window(p, mapping)
        theta = pi * Rational(rng.randrange(24), 12)
        if p.k == 0 or not window.contains(theta):
            continue
        tried += 1
        x = window.contact(theta)
        constant = Rational(p.A(domain) - p.c * p.belt(boundary))
        assert sp.expand(constant + Rational(p.B0) * sp.cos(theta) - Rational(p.k) * x) == 0
        phase = float(theta)
        assert window.contact(phase) == pytest.approx(
            float(x), rel=1e-13, abs=1e-13 * float(abs(p.B0 / p.k))
        )
        assert window.contact(np.array([phase]))[0] == pytest.approx(
            window.contact(phase), rel=1e-12, abs=1e-11
        )
    assert tried > 5


def test_without_a_spring_the_force_fixes_the_phase() -> None:
    # F = A_1 + B0 cos(theta) - c v1 = 0 at cos(theta) = 1/2
    p = FIG9.replace(k=0, A0=0, mu1=0, mu2=0, c=1, v1=3, B0=6)
    window = grazing_window(p, "P2")
    assert (window.gamma, window.phases) == (0, Interval.open(0, pi))
    assert window.contact_phases == sp.FiniteSet(pi / 3)
    assert grazing_window(p, "P3").contact_phases == sp.FiniteSet(5 * pi / 3)
    assert grazing_window(p.replace(B0=-6), "P2").contact_phases == sp.FiniteSet(4 * pi / 3)
    assert grazing_window(p.replace(B0=3), "P2").contact_phases == S.EmptySet
    assert grazing_window(p.replace(B0=2), "P2").contact_phases == S.EmptySet
    assert grazing_window(p.replace(B0=0), "P2").contact_phases == S.EmptySet
    with pytest.raises(ParameterError, match=r"k = 0.*pi/3"):
        window.contact(pi / 3)
    assert grazing_window(FIG9, "P2").contact_phases == grazing_window(FIG9, "P2").phases


@pytest.mark.slow
@pytest.mark.parametrize("mapping", ["P2", pytest.param("P6", marks=pytest.mark.campaign)])
def test_sweep_ends_are_within_one_unit_in_the_last_place(mapping: str) -> None:
    rng = np.random.default_rng(5)
    n = 800
    k = rng.uniform(0.1, 5, n)
    v = rng.uniform(-3, 3, n)
    B0 = rng.uniform(-9, 9, n)
    ratio = rng.choice([-1, 1], n) * (1 - 10.0 ** rng.uniform(-16, 0, n))
    ratio[:200] = 10.0 ** rng.uniform(-45, 0, 200)
    Omega = np.abs(k * v / B0 / ratio)
    if mapping == "P2":
        name = "v1"
    else:
        name = "v2"
    p = FIG9.replace(v1=-100, v2=100)
    windows = grazing_windows(p, mapping, k=k, B0=B0, Omega=Omega, **{name: v})
    worst = 0.0
    arcs = 0
    for i in range(n):
        if windows.kind[i] not in (ARC, WRAPPED_ARC):
            continue
        level = Fraction(k[i]) * Fraction(v[i])
        swing = Fraction(B0[i]) * Fraction(Omega[i])
        ends = exact_ends(level, swing)
        worst = max(
            [
                worst,
                *(
                    ulps(float(x), ends)
                    for x in (windows.low[i], windows.high[i], windows.theta_cr[i])
                ),
            ]
        )
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
        windows = grazing_windows(p, mapping, order, **{name: values})
        for i, value in enumerate(values):
            single = grazing_window(p.replace(**{name: Fraction(value)}), mapping, order)
            assert windows.kind[i] == single.kind
            if single.kind in (ARC, WRAPPED_ARC, ALL_BUT_ONE):
                assert abs(windows.low[i] - single.ends[0]) <= math.ulp(single.ends[0])
                assert abs(windows.high[i] - single.ends[1]) <= math.ulp(single.ends[1])


def test_sweep_decides_equality_exactly_with_fractions() -> None:
    p = FIG9.replace(
        k="1/3", v1=1, Omega="1/3"
    )  # equality at B0 = +-1, which no double of 1/3 would show
    values = np.array([-1.0, 1.0, 0.0, math.nextafter(1, 0), math.nextafter(1, 2)])
    kinds = [ALL_BUT_ONE, ALL_BUT_ONE, EVERYTHING, EVERYTHING, WRAPPED_ARC]
    assert list(grazing_windows(p, "P2", "paper", B0=values).kind) == kinds
    assert list(grazing_windows(p, "P2", "full", B0=values).kind[:2]) == [EVERYTHING, EVERYTHING]
    assert list(grazing_windows(p, "P3", "full", B0=values).kind) == [
        EMPTY,
        EMPTY,
        EMPTY,
        EMPTY,
        ARC,
    ]
    near = FIG9.replace(k=Fraction(1, 3) * (1 - Fraction(1, 2**99)), v1=1, Omega="1/3")
    doubt = grazing_windows(near, "P2", B0=[1.0])
    ends = exact_ends(near.k, near.Omega)
    assert doubt.kind[0] == WRAPPED_ARC
    assert max(ulps(float(x[0]), ends) for x in (doubt.low, doubt.high, doubt.theta_cr)) <= 0.501
