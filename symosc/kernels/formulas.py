"""The entire functions of `symosc.kernels.entire` without a branch: a function for each formula,
for SIMD loops.

This file is executed with other globals: see symosc/kernels/rebind.py.

Each is good where `symosc.kernels.entire.basis` uses it. `symosc.mappings.compiled` sorts the
points and compiles the loops of `symosc.kernels.mapping` once for each of the four, as their
`basis`.
"""

from __future__ import annotations

from symosc.kernels import entire_array
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import closed_form, impulse, impulse_integral, wave_integrals

all_terms = entire_array.series  # with a fixed number of terms


def by_closed_form(tau, K):
    """Return what `entire.basis` does (E0 to I2, sin, cos) in closed form: far from resonance, tau
    not short.
    """
    s = sin(K.Om * tau)
    c = cos(K.Om * tau)
    E0, E1, E2, R2, I2 = closed_form(tau, s, c, K)
    return E0, E1, E2, R2, I2, s, c


def by_division(tau, K):
    """Return what `entire.basis` does (E0 to I2, sin, cos) by divided differences, for a tau that
    is not short.
    """
    s = sin(K.Om * tau)
    c = cos(K.Om * tau)
    E0, E1 = impulse(tau, K)
    R2, I2 = wave_integrals(tau, s, c, E1, K)
    return E0, E1, impulse_integral(tau, E1, K), R2, I2, s, c


def by_division_and_series(tau, K):
    """Return what `entire.basis` does, for a tau that is short for the free oscillation, not for
    the drive.
    """
    s = sin(K.Om * tau)
    c = cos(K.Om * tau)
    E0, E1, E2, _, _ = all_terms(tau, K.cm, K.w0sq, 0.0)
    R2, I2 = wave_integrals(tau, s, c, E1, K)
    return E0, E1, E2, R2, I2, s, c


def by_series(tau, K):
    """Return what `entire.basis` does, by Taylor series, for a tau short for the free oscillation
    and for the drive.
    """
    E0, E1, E2, R2, I2 = all_terms(tau, K.cm, K.w0sq, K.beat)
    return E0, E1, E2, R2, I2, sin(K.Om * tau), cos(K.Om * tau)
