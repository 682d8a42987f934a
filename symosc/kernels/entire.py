"""The entire functions that the generated kernels take as arguments, in double precision and in
every regime.

This file is executed with other globals: see symosc/kernels/rebind.py.

With the characteristic roots l1, l2 of D^2 + (c/m) D + k/m, and e[...] the divided differences of
exp,

    E1 = tau e[l1 tau, l2 tau]               the impulse response S
    E0 = dE1/dtau
    E2 = tau^2 e[0, l1 tau, l2 tau]          its integral
    Z  = tau^2 e[i Omega tau, l1 tau, l2 tau] = R2 + i I2

are entire in tau, the roots and Omega: nothing happens to them at critical damping, at resonance or
at k = 0. Only formulas fail there, by cancellation. Three are used, each where it loses less than a
digit or two:

- short times (rate * tau below SERIES_BELOW): the Taylor series in tau, whose coefficients obey the
  ODE;
- the closed form in sin, cos and exp (`basis_apart`, printed by sympy), if the system is
  underdamped, the roots are far from each other and from i Omega (`apart`), and tau is at least
  APART_ABOVE / w0;
- otherwise divided differences over the pair of nodes that are farthest apart. The inner ones are
  computed by expm1, so that no difference of neighbouring values is formed (McCurdy, Ng and
  Parlett, Math. Comp. 43 (1984)).

Time arguments are in the parameters' unit of time. The functions are scalar: CPython runs them,
numba compiles them.
"""

from __future__ import annotations

from symosc.kernels._generated import basis_apart
from symosc.kernels.elementary import cos, exp, expm1, sin
from symosc.kernels.rebind import outlined

SERIES_BELOW = 0.8
APART_ABOVE = 0.8
EPS = 2.0**-53
SIXTH = 1.0 / 6.0  # a product with it takes a third of the time of a division
INVERSES = (0.0, *(1.0 / n for n in range(1, 40)))


def basis(tau, K):
    """Return E0, E1, E2, R2, I2 (responses to an impulse and to the drive) and sin, cos of Omega
    tau, at tau >= 0.
    """
    if K.apart and K.rate * tau >= SERIES_BELOW and K.w0 * tau >= APART_ABOVE:
        # The drive comes last, since it is needed last: a processor goes on with the rest
        # meanwhile.
        w_tau = K.omega_d * tau
        decay = exp(-K.h * tau)
        s_w = sin(w_tau)
        c_w = cos(w_tau)
        s = sin(K.Om * tau)
        c = cos(K.Om * tau)
        E0, E1, E2, R2, I2 = basis_apart(
            decay, s_w, c_w, s, c, K.h, K.omega_d, K.w0sq, K.Om, K.p, K.q
        )
        return E0, E1, E2, R2, I2, s, c
    return basis_with_drive(tau, sin(K.Om * tau), cos(K.Om * tau), K)


def basis_with_drive(tau, s, c, K):
    """Return what `basis` does, the responses E0 to I2 and s, c, with s, c = sin, cos(Omega tau)
    given.
    """
    if K.rate * tau < SERIES_BELOW:
        E0, E1, E2, R2, I2 = series(tau, K.cm, K.w0sq, K.beat)
    elif K.apart and K.w0 * tau >= APART_ABOVE:
        E0, E1, E2, R2, I2 = closed_form(tau, s, c, K)
    else:
        E0, E1, E2, R2, I2 = careful(tau, s, c, K)
    return E0, E1, E2, R2, I2, s, c


def closed_form(tau, s, c, K):
    """Return the responses E0, E1, E2, R2, I2 of `basis` in closed form, for a system far from
    resonance.
    """
    w_tau = K.omega_d * tau
    return basis_apart(
        exp(-K.h * tau), sin(w_tau), cos(w_tau), s, c, K.h, K.omega_d, K.w0sq, K.Om, K.p, K.q
    )


@outlined
def series(tau, cm, w0sq, Om):
    """Return the responses E0, E1, E2, R2, I2 of `basis` by Taylor series.

    `cm` is c/m, `w0sq` k/m and `Om` Omega.
    """
    # The n-th derivatives at 0 obey s[n+1] = -cm s[n] - w0sq s[n-1] (for S) and z[n+1] = s[n] + i
    # Omega z[n] (for Z).
    # s[n] tau^n / n! for n = 0 and 1: the terms of E1
    before = 0.0
    term = tau
    E0 = 1.0
    E1 = tau
    E2 = 0.5 * tau * tau
    # z[n+1] tau^(n+1) / (n+1)!
    r = E2
    i = 0.0
    R2 = r
    I2 = i
    small_before = False
    for n in range(1, 38):  # as far as INVERSES go; it stops earlier
        slope = -cm * term - w0sq * tau * INVERSES[n] * before  # s[n+1] tau^n / n!: a term of E0
        before = term
        term = slope * tau * INVERSES[n + 1]
        shorter = tau * INVERSES[n + 2]
        r, i = (term - Om * i) * shorter, Om * r * shorter
        E0 += slope
        E1 += term
        E2 += term * shorter
        R2 += r
        I2 += i
        small = abs(slope) <= EPS
        # Single terms may be 0 by accident; two terms of S in a row and Z's make all later ones
        # small.
        if small and small_before and abs(r) <= EPS * R2 and abs(i) <= EPS * abs(I2):
            break
        small_before = small
    return E0, E1, E2, R2, I2


@outlined
def careful(tau, s, c, K):
    """Return the responses E0, E1, E2, R2, I2 of `basis` by divided differences, where others lose
    digits.
    """
    # With a fast drive on a slow oscillator only Z needs divided differences.
    if K.rate0 * tau < SERIES_BELOW:
        E0, E1, E2, _, _ = series(tau, K.cm, K.w0sq, 0.0)
    else:
        E0, E1 = impulse(tau, K)
        E2 = impulse_integral(tau, E1, K)
    R2, I2 = wave_integrals(tau, s, c, E1, K)
    return E0, E1, E2, R2, I2


def impulse(tau, K):
    """Return E1, the response at `tau` to a unit impulse, and its derivative E0, as (E0, E1)."""
    if K.under:
        decay = exp(-K.h * tau)
        E1 = decay * sin(K.omega_d * tau) / K.omega_d
        E0 = decay * cos(K.omega_d * tau) - K.h * E1
    else:
        gap = 2.0 * K.omega_d
        if gap > 0.0:
            spread = -expm1(-gap * tau) / gap
        else:
            spread = tau
        if K.l1 < K.l2:  # with negative damping the fast root is the larger one
            largest = K.l2
        else:
            largest = K.l1
        decay = exp(largest * tau)
        E1 = decay * spread
        E0 = decay * (largest * spread + exp(-gap * tau))
    return E0, E1


def impulse_integral(tau, E1, K):
    """Return E2, the integral of the impulse response E1.

    The system must have damping or a spring.
    """
    real1, imag1, real2, imag2 = roots(K)
    real, imag = expm1_over(real1, imag1, tau)
    # the real part of (E1 - (exp(l1 tau) - 1)/l1)/l2
    return -((real - E1) * real2 + imag * imag2) / (real2 * real2 + imag2 * imag2)


def wave_integrals(tau, s, c, E1, K):
    """Return R2 and I2: the response to the force exp(i Omega t) is R2 + i I2.

    `s` and `c` are sine and cosine of Omega tau.
    """
    real1, _, real2, imag2 = roots(K)
    real, imag = expm1_over(real1, K.detuning, tau)  # over l1 - i Om
    # The numerator: this quotient times exp(i Omega tau), less E1.
    top_real = c * real - s * imag - E1
    top_imag = c * imag + s * real
    # From here on these are the denominator, i Omega - l2.
    real2 = -real2
    imag2 = K.Om - imag2
    size = real2 * real2 + imag2 * imag2
    return (top_real * real2 + top_imag * imag2) / size, (
        top_imag * real2 - top_real * imag2
    ) / size


def roots(K):
    """Return real and imaginary parts of both characteristic roots, the slow (or upper complex) one
    first.
    """
    if K.under:
        return -K.h, K.omega_d, -K.h, -K.omega_d
    return K.l1, 0.0, K.l2, 0.0


def expm1_over(real, imag, tau):
    """Return the real and imaginary part of (exp(z tau) - 1) / z, z = real + i imag.

    `tau` at z = 0.
    """
    size = real * real + imag * imag
    if size == 0.0:
        return tau, 0.0
    half = sin(0.5 * imag * tau)
    growth = expm1(real * tau)
    top_real = growth * cos(imag * tau) - 2.0 * half * half
    top_imag = (growth + 1.0) * sin(imag * tau)
    return (top_real * real + top_imag * imag) / size, (top_imag * real - top_real * imag) / size
