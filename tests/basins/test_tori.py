"""Quasi-periodic motions: frequencies against closed forms and scipy, and what is no torus."""

from __future__ import annotations

from functools import cache
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from symosc import (
    Belt,
    Chaotic,
    ConvergenceError,
    Oscillator,
    QuasiPeriodic,
    attractors,
    bifurcation,
    find_orbit,
    simulate,
)
from symosc.orbits.unsettled import averages_agree, sections_of, unsettled_at


def entrained(Omega: Any) -> Oscillator:
    """Return a self-excited oscillator under a small drive, with damping -0.7, -0.22 and 0.07."""
    belt = Belt("3/2", curve=[(0, 1), ("1/4", "4/5"), (1, "14/25"), (3, "1/2")])
    return Oscillator(m=1, c="1/10", k=1, B0="1/10", Omega=Omega, belts=[belt])


def damping(v: np.ndarray) -> np.ndarray:
    """Return c less the slope of the friction of the entrained oscillator below its belt."""
    return 0.1 - np.array([0.8, 0.32, 0.03])[np.searchsorted([0.25, 1], abs(1.5 - v))]


@cache
def torus() -> QuasiPeriodic:
    """Return the torus just beyond the Neimark-Sacker point, from two starts."""
    found = attractors(entrained("0.934"), [(0, 1, 0), (0, 0.7, 0.2)], t_end="1500T")
    assert found.basin.tolist() == [0, 0]
    (orbit,) = found.orbits
    assert isinstance(orbit, QuasiPeriodic)
    return orbit


@pytest.mark.compiled("doubles")
def test_a_free_oscillation_between_the_belts_has_its_own_frequency() -> None:
    """Undamped, and off the belts, motions are sums of two oscillations, with sqrt(k/m) and Omega."""
    law = Oscillator(m=1, c=0, k=2, B0="0.3", Omega="0.7", belts=[Belt(5, mu="0.3")])
    found = unsettled_at(law, 0.0, 1.0, 0.0)
    assert isinstance(found, QuasiPeriodic)
    assert found.frequency == pytest.approx(sqrt(2), abs=1e-12)
    assert found.rotation == pytest.approx(sqrt(2) / 0.7, abs=1e-12)
    assert abs(found.frequency - sqrt(2)) <= 2 * found.frequency_error < 1e-12
    assert not found.attracts
    assert attractors(law, [(0, 1, 0)], t_end="200T").basin.tolist() == [-1]
    with pytest.raises(
        ConvergenceError, match=r"quasi-periodic, with the second frequency 1\.41421"
    ):
        find_orbit(law, x0=1)


@pytest.mark.compiled("doubles")
def test_a_torus_is_born_with_the_angle_of_the_multipliers() -> None:
    """The orbit loses its stability at Omega = 0.93307446."""
    orbit = find_orbit(entrained("0.933"), x0=1)
    assert orbit.stable
    angle = np.angle(complex(orbit.multipliers[0])) / (2 * pi)
    assert torus().rotation % 1 == pytest.approx(abs(angle), abs=1.5e-3)
    assert torus().rotation_error < 1e-10
    assert torus().curves == 1


@pytest.mark.compiled("doubles")
def test_the_frequency_is_that_of_a_long_motion_of_scipy() -> None:
    """It is where the windowed Fourier transform of scipy's section points is largest."""

    def motion(t: float, y: np.ndarray) -> list[float]:
        x, v = y
        friction = np.interp(1.5 - v, [0, 0.25, 1, 3], [1, 0.8, 0.56, 0.5])
        return [v, 0.1 * np.cos(0.934 * t) - 0.1 * v - x + friction]

    count = 240
    times = 2 * pi / 0.934 * np.arange(count)
    path = solve_ivp(
        motion, (0, times[-1]), torus().points[-1], t_eval=times, rtol=1e-7, atol=1e-9,
        max_step=0.2,
    )  # fmt: skip
    assert path.y[1].max() < 1.5
    signal = (path.y[0] - path.y[0].mean()) * np.hanning(count)

    def size(part: float) -> float:
        return -abs((signal * np.exp(-2j * pi * part * np.arange(count))).sum())

    rotation = torus().rotation % 1
    peak = minimize_scalar(size, (rotation - 1e-3, rotation + 1e-3), tol=1e-9).x
    assert rotation == pytest.approx(peak, abs=1e-5)


@pytest.mark.compiled("doubles")
def test_exponents_of_a_torus_are_0_and_the_mean_damping() -> None:
    found = torus()
    first, second = found.exponents
    assert abs(first) < 3 * found.error
    x, v = found.points[-1]
    span = 1000 * 2 * pi / 0.934
    path = simulate(entrained("0.934"), x0=x, v0=v, t_end=span)
    speeds = path(np.linspace(0, span, 100_000))[1]
    assert first + second == pytest.approx(-damping(speeds).mean(), abs=3e-5)


@pytest.mark.compiled("doubles")
def test_a_stick_slip_motion_that_a_drive_does_not_entrain_is_quasi_periodic() -> None:
    found = attractors(entrained("0.945"), [(0, 2, 0)], t_end="300T")
    assert found.names == ("quasi-periodic, rotation 1.048",)
    assert found.orbits[0].exponents[1] == -np.inf


@pytest.mark.compiled("doubles")
@pytest.mark.parametrize(
    ("law", "x0"),
    [
        (entrained("0.9325"), 2.0),  # which comes to an orbit, slowly
        (entrained("0.94"), 1.0),  # locked to an orbit of 18 periods
        (entrained("1.04"), 1.0),  # of 137 periods
    ],
)
def test_transients_and_locked_orbits_are_no_tori(law: Oscillator, x0: float) -> None:
    assert unsettled_at(law, 0.0, x0, 0.0) is None


@pytest.mark.compiled("doubles")
def test_averages_in_chaos_do_not_agree() -> None:
    law = Oscillator(
        m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", "0.7", mu_s="1.26")]
    )
    points = sections_of(law, 0.0, 0.5, 0.0, 8192)
    assert points is not None
    assert not averages_agree(points)
    assert isinstance(unsettled_at(law, 0.0, 0.5, 0.0), Chaotic)


@pytest.mark.compiled("doubles")
def test_bifurcations_name_what_motions_settle_to() -> None:
    law = entrained(1)
    found = bifurcation(law, {"Omega": [0.92, 0.934, 0.94]}, starts=(0, 1, 0), skip=1500)
    names = [found.name_at(value, "start 1") for value in found.values]
    assert names == ["period 1", "quasi-periodic, rotation 1.0649", "period 18"]
    # Another torus is larger: upward and downward motions are on it.
    assert found.name_at(0.934) == "quasi-periodic, rotation 1.0636"
    assert found.attractor[1].tolist() == [0, 0, 2]
