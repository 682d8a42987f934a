"""Theorem 6 at a state, against the oracle that knows only the ODE."""

from __future__ import annotations

import random
from fractions import Fraction
from math import cos

import mpmath
import pytest
import sympy
from grazing_starts import BELT, DOMAIN
from oracle import flow_oracle
from samples import sample_of

from symosc import ParameterError, Parameters, load_scene
from symosc.engine.arithmetic import mp_context
from symosc.grazing import state
from symosc.grazing.state import is_grazing
from symosc.mappings.theorem7_cases import place

BASE = Parameters(m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3)


def test_theorem_6_at_states() -> None:
    p = load_scene("fig7-exact").parameters
    x_m = Fraction("-0.5855")  # (A0 + 0.9 FN - B0 - c v1)/k
    verdict = is_grazing(p, "P2", x_m, sympy.pi)
    assert (verdict.grazing, verdict.order) == (True, 1)
    assert abs(verdict.values[1] + 10) < 1e-12  # -(k v1/m + (B0 Omega/m) sin)
    beside = is_grazing(p, "P2", x_m + Fraction(1, 1000), sympy.pi)
    assert (beside.grazing, beside.order) == (False, 0)
    assert abs(beside.values[0] + 0.002) < 1e-12
    assert is_grazing(p, "P2", x_m + Fraction(1, 1000), sympy.pi, tolerance=1e-2).grazing
    quartic = is_grazing(p, "P2", Fraction("4.4145"), 3 * sympy.pi / 2)
    assert (quartic.grazing, quartic.order) == (True, 3)


def test_theorem_6_at_an_inflection() -> None:
    p = load_scene("fig9").parameters  # k v1 = 3, B0 Omega = 36
    theta = -sympy.asin(sympy.Rational(1, 12))
    for mapping, A in (("P2", p.A(1)), ("P3", p.A(2))):
        x = sympy.Rational(A - p.c) / 3 + 3 * sympy.cos(theta)
        verdict = is_grazing(p, mapping, x, theta)
        assert (verdict.grazing, verdict.order) == (False, 2)


def test_each_g_function_comes_with_its_part_of_its_terms() -> None:
    """Values and margins go together: those before the deciding one count as 0, which one is by the tolerance."""
    p, x_m = load_scene("fig7-exact").parameters, Fraction("-0.5855")
    beside = x_m + Fraction(1, 1000)
    terms = abs(p.A(1)) + abs(p.B0) + abs(p.k * beside) + abs(p.c * p.v1)
    strict, mild = (is_grazing(p, "P2", beside, sympy.pi, tolerance=limit) for limit in (0, "1e-2"))
    assert strict.margins == pytest.approx([float(abs(Fraction("-0.002")) / terms)], rel=1e-6)
    assert len(mild.margins) == len(mild.values) == mild.order + 1 == 2
    assert mild.margins[0] == strict.margins[0] <= 1e-2 < mild.margins[1]
    nothing = is_grazing(p.replace(k=0, B0=0, c=0, A0=p.mu1 * p.FN), "P2", 0, 0)
    assert nothing.grazing is False
    assert len(nothing.margins) == len(nothing.values)


@pytest.mark.slow
@sample_of(12, 40)
def test_theorem_6_is_what_the_flow_does(count: int) -> None:
    rng = random.Random(3)
    for _ in range(count):
        theta = Fraction(rng.randrange(628), 100)
        for mapping, domain in DOMAIN.items():
            belt = BASE.belt(BELT[mapping])
            force = BASE.A(domain) - BASE.c * belt
            x = (float(force) + 4 * cos(theta)) / 2
            grazes = is_grazing(BASE, mapping, x, theta, tolerance=1e-10).grazing
            with mpmath.workdps(30):
                exact = (mpmath.mpf(force.numerator) / force.denominator + 4 * mpmath.cos(float(theta))) / 2
                x30 = Fraction(str(exact))
            t_m = theta / BASE.Omega
            flows = [flow_oracle(BASE, domain, t_m, x30, belt, tau, dps=30)[1] for tau in ("-1e-4", "1e-4")]
            gaps = [float(v - mpmath.mpf(belt.numerator) / belt.denominator) for v in flows]
            inward = 1 if domain > BELT[mapping] else -1
            assert grazes == all(inward * gap > 0 for gap in gaps), (mapping, theta, gaps)


def test_the_reason_is_that_of_the_first_order_that_does_not_vanish(monkeypatch: pytest.MonkeyPatch) -> None:
    """Odd orders graze by the sign that leads back, even ones pass; in words, and on both sides of the belt."""
    told: list[tuple[float, float]] = []
    monkeypatch.setattr(state, "_g_functions", lambda *_: iter(told))
    for order in range(6):
        for sign in (1, -1):
            for mapping, side in (("P2", 1), ("P3", -1), ("P5", 1), ("P6", -1)):
                told[:] = [*[(1e-13, 1.0)] * order, (sign * 0.5, 2.0), (9.0, 9.0)]
                verdict = is_grazing(BASE, mapping, 0, 0)
                grazes = order % 2 == 1 and side * sign < 0
                assert (verdict.grazing, verdict.order) == (grazes, order)
                assert verdict.values == (*[1e-13] * order, sign * 0.5)
                assert verdict.margins == (*[1e-13] * order, 0.25)
                if order == 0:
                    words = "F does not vanish: the flow is transversal"
                elif order % 2 == 0:
                    words = f"the first G-function that does not vanish has even order {order}: the flow passes"
                else:
                    words = f"F = 0 and G^({order}) leads back" if grazes else f"G^({order}) leads out of the domain"
                assert verdict.reason.startswith(words)
    told[:] = [(0.0, 0.0)] * 6
    verdict = is_grazing(BASE, "P2", 0, 0)
    assert (verdict.grazing, verdict.order) == (False, 6)
    assert verdict.reason.startswith("F and all its derivatives vanish")


def test_g_functions_are_the_derivatives_of_the_force_along_the_flow() -> None:
    """At random states on the belt, each if those before it vanish, with the size of its terms."""
    rng = random.Random(8)
    for _ in range(40):
        mapping = rng.choice(list(DOMAIN))
        p, where = BASE.replace(B0=f"{rng.uniform(-5, 5):.4g}", c=f"{rng.uniform(0, 2):.4g}"), place(mapping)
        x, theta = mpmath.mpf(rng.uniform(-3, 3)), mpmath.mpf(rng.uniform(0, 6))
        found = list(state._g_functions(p, where, x, theta, mp_context(30)))
        m, c, k, B0, Om, A = (float(each) for each in (p.m, p.c, p.k, p.B0, p.Omega, p.A(where.domain)))
        v = float(p.belt(where.boundary))
        terms = [A / m, B0 / m * mpmath.cos(theta), -k / m * x, -c / m * v]
        assert float(found[0][0]) == pytest.approx(float(sum(terms)), rel=1e-9, abs=1e-12)
        assert float(found[0][1]) == pytest.approx(float(sum(map(abs, terms))), rel=1e-9)
        for order in range(1, 6):  # G^(n) = d^n/dt^n (B0 cos theta)/m - (k/m) v for n = 1, the rest of the terms vanish
            drive = B0 / m * Om**order * mpmath.cos(theta + order * mpmath.pi / 2)
            pull = -k / m * v if order == 1 else 0.0
            assert float(found[order][0]) == pytest.approx(float(drive + pull), rel=1e-9, abs=1e-12)
            size = abs(drive) + abs(pull) + abs(B0 / m) * Om**order
            assert float(found[order][1]) == pytest.approx(float(size), rel=1e-9)


def test_the_tolerance_is_a_part() -> None:
    for bad in (1, "1", -1e-9, 2.5):
        with pytest.raises(ParameterError, match="tolerance"):
            is_grazing(BASE, "P2", 0, 0, tolerance=bad)  # type: ignore[arg-type]
    assert is_grazing(BASE, "P2", 0, 0, tolerance=0).order == 0
    assert is_grazing(BASE, "P2", 0, 0, tolerance="0.999999").tolerance == 0.999999  # type: ignore[arg-type]
