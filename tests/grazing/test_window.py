"""Grazing windows: exact decisions against signs of 50 digits, ends in double precision, contacts, sweeps."""

from __future__ import annotations

import functools
import math
import pickle
import random
import subprocess
import sys
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from effort import at_most
from samples import sample_of
from sympy import Interval, Rational, S, asin, pi
from window_samples import parameters

from symosc.errors import ParameterError
from symosc.grazing.sweep import grazing_windows
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.model import Parameters
from symosc.scenes import load_scene, scene_names
from symosc.symbolic.theorem7 import CIRCLE, theorem7

MAPS = ("P2", "P3", "P5", "P6")
ORDERS = ("paper", "full")
FIG9 = load_scene("fig9").parameters
NO_TOP = Interval.Ropen(0, pi / 2) + Interval.open(pi / 2, 2 * pi)
NO_BOTTOM = Interval.Ropen(0, 3 * pi / 2) + Interval.open(3 * pi / 2, 2 * pi)

mp = mpmath.mp.clone()
mp.dps = 50


def forces(p: Parameters, mapping: str, theta: Any) -> list[Any]:
    """Return G^(1) to G^(4) at a contact (F = 0, x' = v) by differentiating the equation of motion; 50 digits."""
    domain_belt = {"P2": 1, "P3": 1, "P5": 2, "P6": 2}
    v = p.belt(domain_belt[mapping])
    m, c, k, Omega, B0 = (mp.mpf(x.numerator) / x.denominator for x in (p.m, p.c, p.k, p.Omega, p.B0))
    before, now, found = mp.mpf(v.numerator) / v.denominator, mp.mpf(0), []
    for order in range(1, 5):
        # (d/dt)^order of B0 cos(Omega t) is B0 Omega^order cos(theta + order pi/2)
        drive = B0 * Omega**order * mp.cos(theta + order * mp.pi / 2)
        before, now = now, (drive - c * now - k * before) / m
        found.append(now)
    return found


def grazes(p: Parameters, mapping: str, theta: Any, order: str) -> bool:
    """Decide by the sign of the first G-function that is not 0 (within 1e-40 of its scale): odd and outward."""
    scale = 1 + float(abs(p.B0)) + float(p.Omega) ** 4 + float(p.k + abs(p.v1) + abs(p.v2) + p.c + 1 / p.m) ** 2
    outward = -1 if mapping in ("P2", "P5") else 1
    for number, value in enumerate(forces(p, mapping, theta), start=1):
        if abs(value) > mp.mpf(10) ** -38 * scale:
            return number % 2 == 1 and value * outward > 0
        if order == "paper":
            return False
    return False


# -- decided exactly -------------------------------------------------------------------------------------------------


@pytest.mark.slow
@sample_of(24, 200)
def test_500_random_parameter_sets_agree_with_the_signs_of_50_digits(count: int) -> None:
    rng = random.Random(20240914)
    seen = set()
    for _ in range(500):
        p = parameters(rng)
        phases = [0.0, math.pi / 2, 1.5 * math.pi] + [rng.uniform(0, 2 * math.pi) for _ in range(count - 3)]
        sine = functools.cache(lambda theta: mp.sin(mp.mpf(theta)))  # of exactly this double
        for mapping in MAPS:
            window = grazing_window(p, mapping, rng.choice(ORDERS))
            seen.add(window.case)
            near = [end for low, high, *_ in window.intervals for end in (low, high)] or [math.pi / 2]
            close = [end + rng.choice([-1, 1]) * 10.0 ** -rng.uniform(1, 16) for end in near for _ in range(6)]
            tried = (near + close + phases)[:count]
            found = window.contains(np.array(tried))
            v = p.belt(window.place.boundary)
            level, swing = (mp.mpf(x.numerator) / x.denominator for x in (p.k * v, p.B0 * p.Omega))
            side = 1 if mapping in ("P2", "P5") else -1
            for theta, inside in zip(tried, found, strict=True):
                sign = side * (level + swing * sine(theta))
                assert abs(sign) > mp.mpf(10) ** -45 or p.B0 == 0 or theta == 0, "not decided by 50 digits"
                assert inside == (sign > 0), (p, mapping, theta)
    wanted = {f"({e}.{n})" for e in (55, 57) for n in "123456abc"} | {
        f"({e}.{n})" for e in (56, 58) for n in "123456bc"
    }
    wanted |= {f"{label} shifted by pi" for label in wanted if label[4] not in "bc"}
    assert seen == wanted


@pytest.mark.slow
@sample_of(12, 100)
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
                    graze_at_equality += order == "full" and expected != window_of(p, mapping).contains(theta)
    assert graze_at_equality > count / 4  # the tangencies of fourth order have been met


def window_of(p: Parameters, mapping: str) -> GrazingWindow:
    return grazing_window(p, mapping, "paper")


def test_fig7_and_fig8_sit_on_the_equality() -> None:
    fig7, fig8 = load_scene("fig7").parameters, load_scene("fig8").parameters
    assert (grazing_window(fig7, "P2").gamma, grazing_window(fig7, "P2").amplitude) == (10, 10)
    assert (grazing_window(fig8, "P3").gamma, grazing_window(fig8, "P3").amplitude) == (-16, 16)
    expected = [(fig7, "P2", "(55.2)", NO_BOTTOM, CIRCLE), (fig8, "P2", "(55.a)", S.EmptySet, S.EmptySet)]
    expected += [(fig8, "P3", "(56.5)", NO_TOP, CIRCLE), (fig8, "P5", "(57.2)", NO_BOTTOM, CIRCLE)]
    expected += [(fig8, "P6", "(58.2)", S.EmptySet, S.EmptySet), (fig7, "P3", "(56.2)", S.EmptySet, S.EmptySet)]
    for p, mapping, case, printed, full in expected:
        assert grazing_window(p, mapping, "paper").phases == printed
        assert grazing_window(p, mapping).phases == full
        assert grazing_window(p, mapping).case == case
    window = grazing_window(fig7, "P2", "paper")
    assert window.intervals == ((0.0, 1.5 * math.pi, True, False), (1.5 * math.pi, 2 * math.pi, False, False))
    assert not window.contains(3 * pi / 2)
    assert not window.contains(-pi / 2)
    assert window.contains(1.5 * math.pi)  # a double that is not 3 pi/2
    assert grazing_window(fig7, "P2").contains(3 * pi / 2)
    assert window.theta_cr == -pi / 2


def test_equality_in_decimals_that_are_no_binary_numbers() -> None:
    p = FIG9.replace(k=0.1, v1=3, B0=-0.3, Omega=1)
    assert 0.1 * 3 != 0.3
    assert grazing_window(p, "P2", "paper").phases == NO_TOP


@pytest.mark.parametrize("name", scene_names())
@pytest.mark.parametrize("mapping", MAPS)
def test_window_is_the_theorem_at_the_scene(name: str, mapping: str) -> None:
    p = load_scene(name).parameters
    for order in ORDERS:
        window = grazing_window(p, mapping, order)
        v = p.v1 if mapping in ("P2", "P3") else p.v2
        assert window.gamma == p.k * v / p.m
        assert window.phases == theorem7(mapping, p.k * v / p.m, p.B0 * p.Omega / p.m, order)
        ends = [
            (float(part.start), float(part.end), not part.left_open, not part.right_open)
            for part in (window.phases.args if isinstance(window.phases, sp.Union) else [window.phases])
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


@pytest.mark.parametrize(
    "theta", [3, "3", Fraction(3), 3.0, np.float64(3), np.float32(3), np.array(3.0), mp.mpf(3), S(3)]
)
def test_phases_in_every_form(theta: Any) -> None:
    assert grazing_window(FIG9, "P2").contains(theta) is True
    assert grazing_window(FIG9, "P3").contains(theta) is False


def test_float_phases_are_the_binary_numbers_that_they_are() -> None:
    for digits in range(12, 17):  # windows whose end lies between the double and the decimal that it prints as
        cut = Fraction(round(10**digits * math.sin(0.25)), 10**digits)
        window = grazing_window(FIG9.replace(k=cut, v1=-1, B0=1, Omega=1), "P2")
        end = window.intervals[0][0]
        for theta in (end, math.nextafter(end, 0), math.nextafter(end, 1)):
            assert window.contains(theta) == (mp.sin(mp.mpf(theta)) > mp.mpf(cut.numerator) / cut.denominator)


def test_arrays() -> None:
    theta = np.linspace(-20, 20, 2000).reshape(40, 50)
    window = grazing_window(FIG9, "P5").contains(theta)
    assert window.shape == theta.shape
    assert window.all()
    inside = grazing_window(FIG9, "P3").contains(theta)
    assert inside.dtype == bool
    assert (inside == [[grazing_window(FIG9, "P3").contains(each) for each in row] for row in theta]).all()
    assert 0.4 < inside.mean() < 0.55


def test_arrays_do_not_rely_on_the_last_digits_of_sines(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(6)
    sine = np.sin
    misled = 0
    for _ in range(100):
        cut = Fraction(rng.randint(1, 10**6 - 1), 10**6)
        window = grazing_window(FIG9.replace(k=cut, v1=-1, B0=1, Omega=1), "P2")  # sin(theta) > cut
        wrong = rng.choice([-3e-16, 3e-16])
        for end in window.ends:
            theta = np.array([math.nextafter(end, 0), end, math.nextafter(end, 4)])
            exact = [mp.sin(mp.mpf(each)) > mp.mpf(cut.numerator) / cut.denominator for each in theta]
            with monkeypatch.context() as patched:
                patched.setattr(np, "sin", lambda theta, wrong=wrong: sine(theta) + wrong)
                assert list(window.contains(theta)) == exact
                misled += list(np.sin(theta) > float(cut)) != exact
    assert misled > 20


@pytest.mark.parametrize("theta", ["abc", None, math.nan, math.inf, sp.oo, sp.I, sp.Symbol("t"), [1.0], True, "pi*pi"])
def test_what_is_no_phase(theta: Any) -> None:
    for mapping in MAPS:
        with pytest.raises(ParameterError, match="theta"):
            grazing_window(FIG9, mapping).contains(theta)


def test_arrays_with_nan() -> None:
    with pytest.raises(ParameterError, match="theta"):
        grazing_window(FIG9, "P2").contains(np.array([1.0, math.nan]))


@pytest.mark.parametrize("mapping", ["P1", "P4", "P7", "P8", "P", "", "P23"])
def test_maps_without_grazing(mapping: Any) -> None:
    with pytest.raises(ParameterError, match="P2, P3, P5, P6"):
        grazing_window(FIG9, mapping)
    with pytest.raises(ParameterError, match="P2, P3, P5, P6"):
        grazing_windows(FIG9, mapping)


def test_bad_orders_and_parameters() -> None:
    for order in ("first", "", None, 1):
        with pytest.raises(ParameterError, match="'full' or 'paper'"):
            grazing_window(FIG9, "P2", order)  # type: ignore[arg-type]
    for name in ("Omega", "B0"):
        with pytest.raises(ParameterError, match=name):
            grazing_window(FIG9.replace(**{name: "abc"}), "P2")


# -- contacts --------------------------------------------------------------------------------------------------------


def test_contacts_of_the_figures() -> None:
    fig7 = load_scene("fig7-corrected").parameters
    place = grazing_window(fig7, "P2").contact(pi)
    # (A0 + (mu1 + mu2) FN - B0 - c v1)/k = (10 + 8.829 - 10 - 10)/2
    assert place == Rational(-5855, 10000)
    fig8 = load_scene("fig8").parameters
    assert grazing_window(fig8, "P3").contact(2 * pi) == Rational("4.51425")  # theta = Omega pi = 2 pi
    with pytest.raises(ParameterError, match="outside the grazing window of P2"):
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
        force = (
            Rational(p.A(domain))
            + Rational(p.B0) * sp.cos(theta)
            - Rational(p.k) * x
            - Rational(p.c * p.belt(boundary))
        )
        assert sp.expand(force) == 0
        phase = float(theta)
        assert window.contact(phase) == pytest.approx(float(x), rel=1e-13, abs=1e-13 * float(abs(p.B0 / p.k)))
        assert window.contact(np.array([phase]))[0] == pytest.approx(window.contact(phase), rel=1e-12, abs=1e-11)
    assert tried > 5


def test_a_phase_outside_names_the_window() -> None:
    window = grazing_window(FIG9, "P3")
    with pytest.raises(ParameterError, match=r"outside the grazing window of P3: \(3.22502, 6.19976\)") as error:
        window.contact(1.0)
    assert error.value.name == "theta"
    with pytest.raises(ParameterError, match=r"theta = .*1\.5.*outside"):
        window.contact(np.array([4.0, 1.5]))
    with pytest.raises(ParameterError, match="empty"):
        grazing_window(FIG9, "P6").contact(1.0)


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


# -- faces -----------------------------------------------------------------------------------------------------------


def test_latex_and_text() -> None:
    window = grazing_window(FIG9, "P2")
    latex = window.latex()
    for part in (
        r"\gamma_{2} = \frac{k}{m} v_{1} = 30",
        "30 < 360",
        r"\arcsin{\left(\frac{1}{12} \right)}",
    ):
        assert part in latex
    assert window._repr_latex_() == f"${latex}$"
    assert "10 = 10" in grazing_window(load_scene("fig7").parameters, "P2").latex()
    assert "750 > 360" in grazing_window(FIG9, "P5").latex()
    assert repr(window) == "GrazingWindow(P2, gamma=30, case=(55.1), [0, 3.22502) or (6.19976, 6.28319))"
    assert "empty" in repr(grazing_window(FIG9, "P6"))


def test_windows_are_values() -> None:
    window = grazing_window(FIG9, "P2")
    assert window == grazing_window(FIG9, "P2")
    assert window != grazing_window(FIG9, "P2", "paper")
    assert pickle.loads(pickle.dumps(window)) == window


def test_numbers_need_neither_sympy_nor_numba() -> None:
    code = (
        "import sys; from symosc.grazing.window import grazing_window; from symosc.scenes import load_scene;"
        "w = grazing_window(load_scene('fig9').parameters, 'P2');"
        "assert w.contains(1.0) and w.intervals and w.contact(1.0) and w.case and repr(w);"
        "assert not {'sympy', 'numba', 'matplotlib'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_exact_query_takes_milliseconds() -> None:
    rng = random.Random(11)
    calls = []
    for _ in range(60):
        p = FIG9.replace(B0=Fraction(rng.randint(200, 999), 7), k=Fraction(rng.randint(1, 99), rng.randint(1, 99)))
        with at_most(1_000_000) as effort:
            window = grazing_window(p, "P2")
            asked = window.phases, window.theta_cr, window.intervals
        calls.append(effort.calls)
        assert None not in asked
    assert sorted(calls)[30] < 20_000
