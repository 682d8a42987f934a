"""The entire functions against the matrix exponential of their ODE, in every regime, and where each formula ends."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import mpmath
import pytest
from samples import sample_of

from symosc import Parameters
from symosc.engine.arithmetic import MpArithmetic, mp_context
from symosc.engine.flow import constants, state_at
from symosc.engine.state import Launch
from symosc.kernels import entire
from symosc.kernels._generated import basis_apart
from symosc.kernels.multiprecision import MP_SERIES_BELOW, BasisMP

try:
    from symosc.kernels import mpfr
except ImportError:
    mpfr = None  # type: ignore[assignment]

ULP = 2.0**-52
REGIMES = (
    "any",
    "near critical",
    "critical",
    "near resonance",
    "resonance",
    "no spring",
    "free",
    "stiff",
)
REGIMES += ("fast drive",)


def parameters(regime: str, rng: random.Random) -> Parameters:
    """Return random parameters of a regime, as exact decimals."""

    def number(low: float, high: float) -> Fraction:
        return Fraction(f"{10 ** rng.uniform(low, high):.6g}")

    m = number(-1, 1)
    c = number(-2, 1)
    k = number(-1, 1)
    Omega = number(-1, 1)
    tiny = Fraction(1, 10 ** rng.randint(3, 12))
    if "critical" in regime:
        c = number(-1, 1)
        k = c * c / (4 * m) * (1 if regime == "critical" else 1 + rng.choice((-1, 1)) * tiny)
    if "resonance" in regime:
        k = m * Omega * Omega
        if regime == "resonance":
            c = Fraction(0)
        else:
            c = tiny
    if regime in ("no spring", "free"):
        k = Fraction(0)
    if regime == "free":
        c = Fraction(0)
    if regime == "stiff":
        m = Fraction(1, 10**5)
    if regime == "fast drive":
        Omega = Fraction(1000)
    return Parameters(m=m, c=c, k=k, A0=0, B0=1, Omega=Omega, v1=0, v2=1, mu1=0, mu2=0, FN=0)


def oracle(p: Parameters, tau: Fraction, digits: int = 50) -> list[Any]:
    """Return E0, E1, E2, R2, I2 from the ODE of (S, S', int S, R2, I2, cos, sin).

    Exp of its matrix.
    """
    rates = [float(p.Omega), float(p.c / p.m), float(p.k / p.m) ** 0.5]
    with mpmath.workdps(digits + 15 + int(float(tau) * max(rates))):
        cm, w0sq, Om, t = (
            mpmath.mpf(q.numerator) / q.denominator for q in (p.c / p.m, p.k / p.m, p.Omega, tau)
        )
        M = mpmath.zeros(5)
        M[0, 1], M[1, 0], M[1, 1] = 1, -w0sq, -cm
        M[2, 0], M[3, 0], M[3, 4], M[4, 3] = 1, 1, -Om, Om
        column = mpmath.expm(M * t)[:, 1]  # S(0) = 0, S'(0) = 1
        return [column[1], column[0], column[2], column[3], column[4]]


def errors(values: tuple[Any, ...], truth: list[Any], exactness: float = ULP) -> list[float]:
    """Return errors in ulp; E0 relative to 1, E1 to the oscillation that it is part of, R2 and I2 to the size of Z."""
    Z = abs(truth[3]) + abs(truth[4])
    sizes = [1, abs(truth[1]) + abs(truth[0]) * abs(truth[2]) ** 0.5 / 2, truth[2], Z, Z]
    return [
        float(abs(a - b) / size) / exactness
        for a, b, size in zip(values, truth, sizes, strict=False)
    ]


@pytest.mark.full(3)
@pytest.mark.slow
@pytest.mark.parametrize("regime", REGIMES)
def test_double_precision_is_accurate_in_every_regime(regime: str) -> None:
    rng = random.Random(regime)
    for _ in range(20):
        p = parameters(regime, rng)
        longest = {"stiff": -3.0, "fast drive": -1.5}.get(regime, 0.8)
        tau = Fraction(10 ** rng.uniform(-6, longest))
        K = constants(p)
        computed = entire.basis(float(tau), K)[:5]
        # exp(-h tau) and sin(w tau) cannot be better than their rounded arguments.
        assert max(errors(computed, oracle(p, tau))) < 12 + K.rate * float(tau), (p, float(tau))


@pytest.mark.full(2)
@pytest.mark.quick(1)
@pytest.mark.parametrize("regime", REGIMES)
def test_any_number_of_digits_is_accurate_in_every_regime(regime: str) -> None:
    """Also just above and far below the time from which on the series is not used."""
    rng = random.Random(regime)
    context = mp_context(40)
    border = math.log10(MP_SERIES_BELOW)
    for n in range(9):
        p = parameters(regime, rng)
        K = MpArithmetic(p, 40).K
        longest = {"stiff": -3.0, "fast drive": -1.5}.get(regime, 0.8)
        beside = border - math.log10(K.rate) + rng.choice((0.01, 0.1, -0.01, -5.0))
        tau = Fraction(10 ** (rng.uniform(-6, longest) if n % 3 else beside))
        t = context.mpf(tau.numerator) / tau.denominator
        truth = oracle(p, tau, 60)
        computed = {"mpmath": BasisMP(context, p)(t, K)[:5]}
        if mpfr:
            inner = mpfr.mpfr_context(context.prec)
            before = inner.enter()
            values = BasisMP(inner, p, mpfr.mpfr_context)(
                mpfr.from_mpf(t), SimpleNamespace(rate=mpfr.from_mpf(K.rate))
            )
            inner.leave(before)
            computed["MPFR"] = tuple(mpfr.to_mpf(value, context) for value in values[:5])
        for kind, numbers in computed.items():
            assert max(errors(numbers, truth, 1e-40)) < 3, (kind, p, float(tau))


def cheap(tau: float, p: Parameters) -> tuple[float, ...]:
    """Return the entire functions by the closed form, wherever it may be."""
    K = constants(p)
    context = mpmath.fp
    arguments = (
        context.exp(-K.h * tau),
        *(f(a) for a in (K.omega_d * tau, K.Om * tau) for f in (context.sin, context.cos)),
    )
    return basis_apart(*arguments, K.h, K.omega_d, K.w0sq, K.Om, K.p, K.q)


@pytest.mark.slow
def test_the_closed_form_is_accurate_at_its_borders() -> None:
    rng = random.Random(7)
    tested = 0
    for _ in range(40):
        p = parameters("any", rng)
        K = constants(p)
        if not K.apart:
            continue
        tau = Fraction(entire.APART_ABOVE / K.w0 * 1.001)
        if K.rate * float(tau) < entire.SERIES_BELOW:
            continue
        tested += 1
        assert max(errors(cheap(float(tau), p), oracle(p, tau))) < 30, p
    assert tested > 10


@pytest.mark.slow
@sample_of(7, 20)
def test_no_cancellation_in_the_flow(count: int) -> None:
    """The error of x and v stays within 50 ulp of the sum of the sizes of their terms."""
    rng = random.Random(3)
    for regime in REGIMES:
        for _ in range(count):
            p = parameters(regime, rng)
            K = constants(p)
            longest = {"stiff": -3.0, "fast drive": -1.5}.get(regime, 0.8)
            tau = Fraction(10 ** rng.uniform(-6, longest))
            v0 = rng.uniform(-2, 2)
            a0 = rng.uniform(-9, 9)
            theta = rng.uniform(0, 6.28)
            s0 = mpmath.fp.sin(theta)
            c0 = mpmath.fp.cos(theta)
            _, E1, E2, R2, I2 = oracle(p, tau)
            x_terms = [
                v0 * E1,
                v0 * K.cm * E2,
                a0 * E2,
                K.f0 * c0 * R2,
                -K.f0 * c0 * E2,
                -K.f0 * s0 * I2,
            ]
            v_terms = [a0 * E1, -K.w0sq * v0 * E2, -K.fB * s0 * R2, -K.fB * c0 * I2]
            computed = state_at(float(tau), Launch(v0, a0, s0, c0), K)
            for value, terms in ((computed.dx, x_terms), (computed.dv, v_terms)):
                with mpmath.workdps(50):
                    assert abs(value - sum(terms)) <= 50 * ULP * sum(map(abs, terms)), (
                        p,
                        float(tau),
                    )


def test_a_term_that_vanishes_by_accident_does_not_end_the_series() -> None:
    p = Parameters(m=1, c=1, k=1, A0=0, B0=1, Omega=1, v1=0, v2=1, mu1=0, mu2=0, FN=0)
    for tau in (Fraction(1, 8), Fraction(1, 2), Fraction(3, 4)):
        assert max(errors(entire.series(float(tau), 1.0, 1.0, 1.0), oracle(p, tau))) < 12
        free = entire.series(float(tau), 0.0, 1.0, 0.0)
        assert max(errors(free[:3], oracle(p.replace(c=0), tau)[:5])) < 12
