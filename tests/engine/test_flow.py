"""The flow within a domain, and the constants that it is computed from.

Against a matrix exponential and the roots.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from agreement import BASE
from touches import tenths

from symosc import Parameters
from symosc.engine.arithmetic import Arithmetic, MpArithmetic
from symosc.engine.flow import fifth_derivative
from symosc.engine.state import Launch


def random_parameters(rng: random.Random) -> Parameters:
    """Return random parameters.

    All dampings, with and without a spring, some near resonance, some stiff.
    """
    m = tenths(rng, 2, 30)
    Omega = tenths(rng, 3, 40)
    k = rng.choice([Fraction(0), tenths(rng, 1, 60), m * Omega**2])
    c = rng.choice([Fraction(0), tenths(rng, 0, 60), tenths(rng, 300, 900), Fraction(1, 1000)])
    return BASE.replace(
        m=m, c=c, k=k, Omega=Omega, B0=tenths(rng, -60, 60), A0=tenths(rng, -30, 30)
    )


def number(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def exact_flight(p: Parameters, start: Launch, tau: Any) -> list[Any]:
    """Return v and its first five derivatives at tau, from the exponential of the linear system (v, F, sin, cos)."""
    m, c, k, f, w = (number(value) for value in (p.m, p.c, p.k, p.B0 * p.Omega / p.m, p.Omega))
    M = mpmath.matrix([[0, 1, 0, 0], [-k / m, -c / m, -f, 0], [0, 0, 0, w], [0, 0, -w, 0]])
    z = mpmath.expm(M * tau, method="taylor") * mpmath.matrix(
        [mpmath.mpf(value) for value in start]
    )
    computed = [z[0]]
    for _ in range(5):
        z = M * z
        computed.append(z[0])
    return computed


@pytest.mark.parametrize("digits", [None, 30])
def test_a_flight_is_the_exponential_of_its_equation(digits: int | None) -> None:
    """Gains, acceleration and derivatives are right to rounding, whatever the damping and the drive are."""
    rng = random.Random(21)
    with mpmath.workdps(60):
        for _ in range(6 if digits else 40):
            p = random_parameters(rng)
            if digits:
                arithmetic = MpArithmetic(p, digits)
            else:
                arithmetic = Arithmetic(p)
            if digits:
                eps = 10.0**-digits
            else:
                eps = 2.0**-53
            K = arithmetic.K
            convert = arithmetic.rounded
            theta = rng.uniform(0, 6.28)
            tau = convert(mpmath.mpf(rng.uniform(0.01, 3.0)))
            start = Launch(
                *map(convert, map(mpmath.mpf, (rng.uniform(-3, 3), rng.uniform(-9, 9)))),
                *map(convert, (mpmath.sin(theta), mpmath.cos(theta))),
            )
            now = arithmetic.namespace["state_at"](tau, start, K)
            v, F, G1, G2, G3, fifth = exact_flight(p, start, tau)
            size = (
                1 + abs(start.v) + abs(start.F) / float(K.rate) + abs(float(K.f0)) / float(K.rate)
            )
            errors = [now.dv - (v - start.v), now.F - F, now.G1 - G1, now.G2 - G2, now.G3 - G3]
            for order, error in enumerate(errors):
                assert abs(error) < 200 * eps * size * float(K.rate) ** order, (p, order)
            next_one = fifth_derivative(now.G3, now.G2, now.c, K)
            assert abs(next_one - fifth) < 1e4 * eps * size * float(K.rate) ** 5
            # dx is the integral of v: m F + c v + k x - B0 cos keeps its value
            m, c, k, B0 = map(number, (p.m, p.c, p.k, p.B0))
            if k:
                angle = mpmath.atan2(start.s, start.c) + number(p.Omega) * tau
                dx = (
                    B0 * (mpmath.cos(angle) - start.c) - m * (F - start.F) - c * (v - start.v)
                ) / k
                assert abs(now.dx - dx) < 2e3 * eps * (size * (1 + float(tau)) + abs(dx))
