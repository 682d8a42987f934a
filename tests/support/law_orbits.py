"""Oscillators with orbits of other laws than the paper's, and the oracle's word on an orbit."""

from __future__ import annotations

from typing import Any

import shooting_oracle

from symosc import Belt, Oscillator

FREE: Any = {"m": 1, "c": 0, "k": 1}
#: The stick-slip oscillator of the textbooks: its closed form is in the test.
STICK_SLIP = Oscillator(**FREE, belts=[Belt("1/5", mu="1/2", mu_s=1)])
#: Damping 1/10 below v = 1, and -3/10 above it.
TWO_BANDS = Oscillator(m=1, c="1/10", k=1, belts=[Belt(10, curve=[(0, 4), (9, "0.4")])])
DRIVEN: Any = {"m": 1, "c": "0.05", "k": 1, "B0": "0.6", "Omega": "1.4"}


def driven(mu_s: str) -> Oscillator:
    return Oscillator(**DRIVEN, belts=[Belt("0.1", mu="0.7", mu_s=mu_s)])


def as_oracle(p: Oscillator) -> dict[str, Any]:
    """Return a law as the oracle takes it."""
    names = ("m", "c", "k", "A0", "B0", "Omega", "FN")
    belts = []
    for belt in p.belts:
        numbers = {"v": belt.v, "mu_s": belt.mu_s}
        if belt.curve:
            numbers |= {"curve": belt.curve, "slope": belt.slope}
        else:
            numbers |= {"mu": belt.mu}
        belts.append(numbers)
    return {name: getattr(p, name) for name in names} | {"belts": belts}


def confirmed(orbit: Any, tolerance: float) -> float:
    """Assert that the oracle finds the same orbit; return its largest multiplier."""
    t, x, v = orbit.start
    truth = shooting_oracle.periodic_orbit(
        as_oracle(orbit.parameters), t, x, v, float(orbit.period)
    )
    for own, true in ((x, truth.x), (v, truth.v), (orbit.period, truth.period)):
        assert abs(shooting_oracle.exact(own) - shooting_oracle.exact(true)) < tolerance
    for own, true in zip(orbit.multipliers, truth.multipliers, strict=True):
        assert abs(complex(own) - complex(true)) < max(tolerance, 1e-9) * max(1.0, abs(true))
    return float(abs(truth.multipliers[0]))
