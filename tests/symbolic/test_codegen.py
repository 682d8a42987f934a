"""The generated kernels: what they are made of, and that they solve the equation of motion."""

from __future__ import annotations

import ast
import inspect
import math
import random
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

from symosc.kernels import _generated as kernels
from symosc.symbolic import codegen
from symosc.symbolic import solution as s

CASES = pytest.mark.parametrize(
    ("regime", "seed"),
    [(regime, seed) for regime in s.REGIMES.values() for seed in range(2)],
    ids=str,
)
NAMES = [
    node.name
    for node in ast.parse(codegen.PATH.read_text()).body
    if isinstance(node, ast.FunctionDef)
]
KERNELS = pytest.mark.parametrize("name", NAMES)


# --- what is committed ---


@pytest.mark.slow
def test_the_committed_module_is_what_codegen_prints() -> None:
    difference = codegen.check()
    assert not difference, f"run `symosc codegen --regenerate` to accept this change:\n{difference}"


# --- what it computes ---


class Case:
    """A random parameter set of a regime and a random flight, to 60 digits."""

    def __init__(self, regime: s.Regime, seed: int) -> None:
        draw = random.Random(f"{regime.name} {seed}").uniform
        letters = {
            letter: sp.Float(draw(0.2, 3), 60)
            for letter in (s.h, s.omega_d, s.omega_0, s.Omega, s.tau)
        }
        letters[s.eta] = letters[s.h] * sp.Float(draw(0.1, 0.9), 60)
        normalised = {symbol: expr.subs(letters) for symbol, expr in regime.parameters().items()}
        self.cm, self.w0sq = (self.mpf(normalised[symbol]) for symbol in (s.cm, s.w0sq))
        self.Om, self.tau = self.mpf(letters[s.Omega]), self.mpf(letters[s.tau])
        self.m, self.A, self.B0 = (mpmath.mpf(draw(low, 5)) for low in (0.1, -5, -5))
        self.x0, self.v0, self.t_i = (mpmath.mpf(draw(-5, 5)) for _ in range(3))
        self.f0, self.A_m = self.B0 / self.m, self.A / self.m
        self.basis = [
            self.mpf(closed.subs(letters).evalf(60)) for closed in regime.basis().values()
        ]
        theta = self.Om * self.t_i
        self.s0 = mpmath.sin(theta)
        self.c0 = mpmath.cos(theta)
        self.a0 = kernels.acceleration(
            self.x0, self.v0, self.c0, self.A_m, self.cm, self.w0sq, self.f0
        )

    @staticmethod
    def mpf(value: Any) -> Any:
        return mpmath.mpf(str(value))

    def motion_arguments(self) -> list[Any]:
        return [
            self.v0,
            self.a0,
            self.s0,
            self.c0,
            self.cm,
            self.w0sq,
            self.f0,
            self.Om,
            *self.basis,
        ]

    def apart_arguments(self) -> list[Any]:
        h = self.cm / 2
        Om = self.Om
        tau = self.tau
        w = mpmath.sqrt(self.w0sq - h * h)
        waves = [wave(rate * tau) for rate in (w, Om) for wave in (mpmath.sin, mpmath.cos)]
        return [
            mpmath.exp(-h * tau),
            *waves,
            h,
            w,
            self.w0sq,
            Om,
            self.w0sq - Om * Om,
            self.cm * Om,
        ]

    def system(self) -> Any:
        """The matrix of the linear system for (x, v, cos(Omega t), sin(Omega t), 1).

        The ODE as the paper has it.
        """
        k = self.m * self.w0sq
        c = self.m * self.cm
        m = self.m
        return mpmath.matrix(
            [
                [0, 1, 0, 0, 0],
                [-k / m, -c / m, self.B0 / m, 0, self.A / m],
                [0, 0, 0, -self.Om, 0],
                [0, 0, self.Om, 0, 0],
                [0, 0, 0, 0, 0],
            ]
        )

    def start(self) -> Any:
        return mpmath.matrix([self.x0, self.v0, self.c0, self.s0, 1])


@pytest.fixture(autouse=True)
def seventy_digits() -> Any:
    with mpmath.workdps(70):
        yield


@pytest.mark.full(6)
@pytest.mark.quick(2)
@CASES
def test_motion_agrees_with_the_matrix_exponential(regime: s.Regime, seed: int) -> None:
    case = Case(regime, seed)
    dx, dv, a = kernels.motion(*case.motion_arguments())
    end = mpmath.expm(case.system() * case.tau) * case.start()
    rate = case.system() * end
    size = 1 + abs(case.x0) + abs(case.v0) + abs(case.a0) + abs(case.f0)
    for value, truth in ((case.x0 + dx, end[0]), (case.v0 + dv, end[1]), (a, rate[1])):
        assert abs(value - truth) < mpmath.mpf("1e-50") * size


@pytest.mark.quick(4)
@CASES
def test_g_functions_agree_with_the_linear_system(regime: s.Regime, seed: int) -> None:
    case = Case(regime, seed)
    derivative = case.start()
    x_n = []
    for _ in range(6):
        x_n.append(derivative[0])
        derivative = case.system() * derivative
    before = case.v0
    G = case.a0
    assert abs(G - x_n[2]) < 1e-50
    sines = [case.s0, case.c0, -case.s0]
    for n, sine in enumerate(sines, start=1):
        before, G = (
            G,
            kernels.next_derivative(G, before, case.f0 * case.Om**n * sine, case.cm, case.w0sq),
        )
        assert abs(G - x_n[n + 2]) < 1e-50 * (1 + abs(G))


@pytest.mark.quick(4)
@CASES
def test_force_on_a_belt_agrees_with_the_equation_of_motion(regime: s.Regime, seed: int) -> None:
    case = Case(regime, seed)
    theta = case.Om * case.t_i
    dc = mpmath.cos(theta + case.Om * case.tau) - mpmath.cos(theta)
    held = kernels.stick_acceleration(case.a0, case.v0, case.tau, dc, case.w0sq, case.f0)
    there = case.system() * mpmath.matrix(
        [case.x0 + case.v0 * case.tau, case.v0, case.c0 + dc, 0, 1]
    )
    assert abs(held - there[1]) < 1e-50 * (1 + abs(case.a0))


@pytest.mark.quick(3)
@pytest.mark.parametrize("seed", range(14))
def test_double_precision_is_close_to_sixty_digits(seed: int) -> None:
    regimes = list(s.REGIMES.values())
    case = Case(regimes[seed % len(regimes)], seed)
    arguments = [float(value) for value in case.motion_arguments()]
    v0, a0, _, _, cm, w0sq, f0, Om, E0, E1, E2, R2, I2 = map(abs, arguments)
    sizes = (
        v0 * (E1 + cm * E2) + a0 * E2 + f0 * (R2 + E2 + I2),
        a0 * E1 + w0sq * v0 * E2 + f0 * Om * (R2 + I2),
        a0 * E0 + w0sq * v0 * E1 + f0 * Om * (E1 + Om * I2 + Om * R2),
    )
    exact = kernels.motion(*map(mpmath.mpf, arguments))
    for value, truth, size in zip(kernels.motion(*arguments), exact, sizes, strict=True):
        assert abs(value - truth) < 5 * 2.0**-53 * size


@pytest.mark.full(2)
@pytest.mark.quick(1)
@KERNELS
def test_same_results_on_every_kind_of_number(name: str) -> None:
    numba = pytest.importorskip("numba")
    kernel = getattr(kernels, name)
    rng = np.random.default_rng(5)
    compiled = numba.njit(kernel)
    count = len(inspect.signature(kernel).parameters)
    samples = rng.uniform(0.5, 2.0, (20, count))
    on_arrays = np.atleast_2d(np.asarray(kernel(*samples.T)))
    for i, sample in enumerate(samples.tolist()):
        on_floats = np.atleast_1d(kernel(*sample))
        assert np.all(on_floats == on_arrays[:, i])
        np.testing.assert_allclose(
            np.atleast_1d(compiled(*sample)), on_floats, rtol=1e-14, atol=1e-14
        )
        exact = kernel(*map(mpmath.mpf, sample))
        for on_mpf, on_float in zip(
            exact if isinstance(exact, tuple) else [exact], on_floats, strict=True
        ):
            assert isinstance(on_mpf, mpmath.mpf)
            assert math.isclose(float(on_mpf), on_float, rel_tol=1e-13, abs_tol=1e-13)
