"""The derivations of symosc.symbolic: each test asks sympy for an exact 0."""

from __future__ import annotations

import pytest
import sympy as sp

from symosc.symbolic import solution as s

REGIMES = pytest.mark.parametrize("regime", s.REGIMES.values(), ids=lambda regime: regime.name)


def test_friction_enters_only_through_the_acceleration_at_the_start() -> None:
    for expr in s.flow():
        assert not expr.has(s.A_m)
        assert expr.has(s.a_i)


@REGIMES
def test_the_letters_of_a_regime_mean_what_they_say(regime: s.Regime) -> None:
    # On the condition's equations (c^2 = 4 k m, k = 0, ...) the letters give back c/m and k/m.
    solved = {}
    for equation in regime.condition.atoms(sp.Eq):
        if equation.has(s.k):
            unknown = s.k
        else:
            unknown = s.c
        solved[unknown] = sp.solve(equation, unknown)[0]
    for symbol, meaning in ((s.cm, s.c / s.m), (s.w0sq, s.k / s.m)):
        in_letters = regime.parameters()[symbol].xreplace(regime.letters)
        assert sp.simplify((in_letters - meaning).xreplace(solved)) == 0


def test_every_parameter_set_belongs_to_one_regime() -> None:
    seen = set()
    for c in (0, 1, 2, 3):
        for k in (0, sp.Rational(1, 2), 1, 4):
            values = {
                s.m: sp.Integer(1),
                s.c: sp.Integer(c),
                s.k: sp.sympify(k),
                s.Omega: sp.Integer(2),
            }
            names = [
                regime.name
                for regime in s.REGIMES.values()
                if regime.condition.subs(values) == sp.true
            ]
            assert len(names) == 1, (c, k, names)
            seen.update(names)
    assert seen == set(s.REGIMES)


@pytest.mark.full(3)
@pytest.mark.slow
@REGIMES
def test_one_power_series_for_all_regimes(regime: s.Regime) -> None:
    # Repeated differentiation gives Taylor coefficients that are polynomials in cm, w0sq, Omega: no
    # regime in sight.
    for f in s.BASIS:
        derivative = f
        closed = regime.basis()[f]
        for order in range(5):
            universal = derivative.xreplace(s.start_values()).xreplace(regime.parameters())
            special = closed.diff(s.tau, order).xreplace({s.tau: sp.Integer(0)})
            assert sp.simplify(special - universal) == 0, (f, order)
            derivative = sp.expand(s.time_derivative(derivative))


def test_first_g_function_is_the_papers() -> None:
    # (47) with (9), as in (66): the derivative of the acceleration along the flow
    F = s.in_paper_letters(s.acceleration())
    sine = sp.sin(s.Omega * s.t)
    paper = -s.c / s.m * F - s.k / s.m * s.v - s.B0 * s.Omega / s.m * sine
    assert sp.expand(s.in_paper_letters(s.g_function(1)) - paper) == 0


@pytest.mark.parametrize("order", range(1, 7))
def test_g_functions_by_recurrence(order: int) -> None:
    if order > 1:
        before = s.g_function(order - 2)
    else:
        before = s.v
    derived = s.next_derivative(s.g_function(order - 1), before, s.forcing(order))
    assert sp.expand(derived - s.g_function(order)) == 0


def test_g_functions_are_the_derivatives_of_the_flow() -> None:
    start = s.start_values() | {s.tau: sp.Integer(0)}
    here = {s.x: s.x_i, s.v: s.v_i, s.theta: s.theta_i}
    F_i = s.acceleration(s.x_i, s.v_i, s.theta_i)
    derivative = s.flow().a
    for order in range(4):
        at_start = derivative.xreplace(start).xreplace({s.a_i: F_i})
        assert sp.expand(at_start - s.g_function(order).xreplace(here)) == 0
        derivative = s.time_derivative(derivative)


def test_force_on_a_belt() -> None:
    wave = sp.cos(s.theta_i + s.Omega * s.tau) - sp.cos(s.theta_i)
    F_i = s.acceleration(s.x_i, s.v, s.theta_i)
    on_belt = s.stick_acceleration(F_i, wave)
    assert (
        sp.expand(on_belt - s.acceleration(s.x_i + s.v * s.tau, s.v, s.theta_i + s.Omega * s.tau))
        == 0
    )
    # model: m dF/dt = -(k v_lambda + B0 Omega sin Omega t)
    rate = s.in_paper_letters(on_belt.diff(s.tau))
    paper = -(s.k * s.v + s.B0 * s.Omega * sp.sin(s.Omega * s.t_i + s.Omega * s.tau)) / s.m
    assert sp.expand(rate - paper) == 0
