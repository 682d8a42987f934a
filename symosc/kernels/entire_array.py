"""The entire functions of `symosc.kernels.entire` for numpy arrays of times: each formula where it
is good.

This file is executed with other globals: see symosc/kernels/rebind.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from symosc.kernels._generated import basis_apart
from symosc.kernels.entire import APART_ABOVE, SERIES_BELOW

# Terms of the series: SERIES_BELOW^n / n! is below one ulp.
TERMS = 18


def basis(tau: np.ndarray, K: Any) -> tuple[np.ndarray, ...]:
    """Return the responses E0, E1, E2, R2, I2 (to impulse and drive) and sin, cos of Omega tau, for
    times tau >= 0.
    """
    return basis_with_drive(tau, np.sin(K.Om * tau), np.cos(K.Om * tau), K)


def basis_with_drive(
    tau: np.ndarray, s: np.ndarray, c: np.ndarray, K: Any
) -> tuple[np.ndarray, ...]:
    """Return what `basis` does, the responses E0 to I2 and s, c, with s, c = sin, cos(Omega tau)
    given.
    """
    short = K.rate * tau < SERIES_BELOW
    if K.apart:  # for all: most times are long, and picking them out would cost more
        columns = np.array(apart(tau, s, c, K))
        rest = ~short & (K.w0 * tau < APART_ABOVE)
    else:
        columns = np.empty((5, *np.shape(tau)))
        rest = ~short
    if short.any():
        columns[:, short] = series(tau[short], K.cm, K.w0sq, K.beat)
    if rest.any():
        columns[:, rest] = careful(tau[rest], s[rest], c[rest], K)
    return (*columns, s, c)


def apart(tau: np.ndarray, s: np.ndarray, c: np.ndarray, K: Any) -> Any:
    """Return the responses E0 to I2 of `basis` in closed form, if underdamped and far from
    resonance (K.apart).
    """
    decay = np.exp(-K.h * tau)
    w_tau = K.omega_d * tau
    return basis_apart(
        decay, np.sin(w_tau), np.cos(w_tau), s, c, K.h, K.omega_d, K.w0sq, K.Om, K.p, K.q
    )


def series(tau: np.ndarray, cm: float, w0sq: float, Om: float) -> tuple[np.ndarray, ...]:
    """Return the responses E0 to I2 of `basis` for short times by Taylor series.

    `cm` is c/m, `w0sq` k/m and `Om` Omega.
    """
    before = 0.0 * tau
    term = tau
    E0 = 1.0 + before
    E1 = tau
    E2 = 0.5 * tau * tau
    r = E2
    i = before
    R2 = r
    I2 = i
    for n in range(1, TERMS):
        slope = -cm * term - w0sq * tau * before / n
        before = term
        term = slope * tau / (n + 1)
        shorter = tau / (n + 2)
        r, i = (term - Om * i) * shorter, Om * r * shorter
        E0 = E0 + slope
        E1 = E1 + term
        E2 = E2 + term * shorter
        R2 = R2 + r
        I2 = I2 + i
    return E0, E1, E2, R2, I2


def careful(tau: np.ndarray, s: np.ndarray, c: np.ndarray, K: Any) -> tuple[np.ndarray, ...]:
    """Return the responses E0 to I2 of `basis` by divided differences, for times where the closed
    form cancels.
    """
    if K.under:
        l1 = complex(-K.h, K.omega_d)
        l2 = complex(-K.h, -K.omega_d)
        decay = np.exp(-K.h * tau)
        E1 = decay * np.sin(K.omega_d * tau) / K.omega_d
        E0 = decay * np.cos(K.omega_d * tau) - K.h * E1
    else:
        l1 = complex(K.l1)
        l2 = complex(K.l2)
        gap = 2.0 * K.omega_d
        if gap > 0.0:
            spread = -np.expm1(-gap * tau) / gap
        else:
            spread = tau
        decay = np.exp(K.l1 * tau)
        E1 = decay * spread
        E0 = decay * (K.l1 * spread + np.exp(-gap * tau))
    # With a fast drive on a slow oscillator only Z needs divided differences.
    slow = K.rate0 * tau < SERIES_BELOW
    if l2 != 0.0:
        E2 = ((expm1_over(l1, tau) - E1) / -l2).real
    else:
        E2 = 0.5 * tau * tau
    if slow.any():
        E0[slow], E1[slow], E2[slow], _, _ = series(tau[slow], K.cm, K.w0sq, 0.0)
    Z = ((c + 1j * s) * expm1_over(complex(l1.real, K.detuning), tau) - E1) / complex(
        -l2.real, K.Om - l2.imag
    )
    return E0, E1, E2, Z.real, Z.imag


def expm1_over(z: complex, tau: np.ndarray) -> np.ndarray:
    """Return (exp(z tau) - 1) / z for an array of times; `tau` if z = 0."""
    if z == 0.0:
        return tau
    half = np.sin(0.5 * z.imag * tau)
    growth = np.expm1(z.real * tau)
    return (
        growth * np.cos(z.imag * tau)
        - 2.0 * half * half
        + 1j * (growth + 1.0) * np.sin(z.imag * tau)
    ) / z
