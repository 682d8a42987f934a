"""The oracle is checked before it judges.

Against printed references, a matrix exponential, and scipy.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
from oracle import first_root, flow_oracle, simulate_oracle
from scipy.integrate import solve_ivp

from symosc.model import Parameters
from symosc.scenes import load_scene

REFERENCE = Path(__file__).parents[1] / "reference"
KINDS = {
    "stick onset": ("stick", "belt"),
    "stick end->1": ("slip", "Omega1"),
    "stick end->2": ("slip", "Omega2"),
}
KINDS["stick end->3"] = ("slip", "Omega3")


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("name", "digits"), [("fig5", 50), ("fig7-corrected", 50), ("fig8", 100), ("fig10", 60)]
)
def test_thirty_digits_of_the_references(name: str, digits: int) -> None:
    scene = load_scene(name)
    reference = json.loads((REFERENCE / f"{name}.json").read_text())
    t_end = Fraction(reference[-1][0]) + Fraction(1, 1000)
    run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, t_end, digits)
    assert len(run.events) == len(reference)
    with mpmath.workdps(50):
        for event, (t, kind, x, v) in zip(run.events, reference, strict=True):
            assert abs(event.t - mpmath.mpf(t)) < 1e-30 * max(1, abs(event.t))
            assert abs(event.x - mpmath.mpf(x)) < 1e-30 * max(1, abs(event.x))
            assert event.v == mpmath.mpf(v)
            assert event.kind == KINDS[kind][0]
            assert event.target.startswith(KINDS[kind][1])


@pytest.mark.parametrize(("name", "t_end"), [("fig7-exact", 9), ("fig8-exact", 4)])
def test_exact_starts_graze_at_pi(name: str, t_end: int) -> None:
    scene = load_scene(name)
    run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, t_end, 40)
    assert [event.kind for event in run.events] == ["graze"]
    assert run.events[0].source == run.events[0].target == run.mode
    with mpmath.workdps(40):
        assert abs(run.events[0].t - mpmath.pi) < 1e-20  # a touch is located to half the digits


MATRIX_CASES = {
    "underdamped": ({}, "0.7"),
    "critical": ({"c": 2}, "0.7"),
    "overdamped": ({"c": 5}, "0.7"),
    "resonance": ({"c": 0, "Omega": 1}, "5.3"),
    "no spring": ({"k": 0}, "0.7"),
    "free mass": ({"k": 0, "c": 0}, "0.7"),
    "stiff": ({"m": "1e-6", "Omega": 3}, "0.003"),
    "fast drive": ({"Omega": 1000}, "0.7"),
}


@pytest.mark.quick(2)
@pytest.mark.parametrize("case", MATRIX_CASES)
def test_the_series_agrees_with_the_matrix_exponential(case: str) -> None:
    changes, tau = MATRIX_CASES[case]
    p = Parameters(
        m=1,
        c="0.3",
        k=1,
        A0="0.4",
        B0="1.7",
        Omega="2.3",
        v1=-1000,
        v2=1000,
        mu1="0.3",
        mu2="0.2",
        FN=2,
    )
    p = p.replace(**changes)
    run = simulate_oracle(p, "1e6", "0.3", "-0.7", Fraction(10**6) + Fraction(tau), 50)
    x, v, acceleration = flow_oracle(p, 2, "1e6", "0.3", "-0.7", tau, 50)
    assert run.events == []
    with mpmath.workdps(60):
        assert abs(run.x - x) < 1e-45
        assert abs(run.v - v) < 1e-45 * max(1, abs(acceleration))
        A, B0, k, c, m, Omega = (
            mpmath.mpf(value.numerator) / value.denominator
            for value in (p.A(2), p.B0, p.k, p.c, p.m, p.Omega)
        )
        force = A + B0 * mpmath.cos(Omega * (10**6 + mpmath.mpf(tau))) - k * x - c * v
        assert abs(force / m - acceleration) < 1e-40 * max(1, abs(acceleration))


def test_the_matrix_exponential_runs_backwards() -> None:
    p = load_scene("fig9").parameters
    x, v, _ = flow_oracle(p, 2, "0.3", "0.4", "1.5", "-0.9", 70)
    start = [Fraction(mpmath.nstr(value, 65)) for value in (x, v)]
    forth = flow_oracle(p, 2, Fraction(3, 10) - Fraction(9, 10), *start, "0.9", 60)
    with mpmath.workdps(60):
        assert abs(forth[0] - mpmath.mpf("0.4")) < 1e-55
        assert abs(forth[1] - mpmath.mpf("1.5")) < 1e-55


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(3))
def test_scipy_finds_the_same_events(seed: int) -> None:
    """DOP853 between events, restarted in the domain or on the belt that the oracle names."""
    rng = np.random.default_rng(seed)
    low = [1, 0.1, 0.5, -2, 4, 0.7, -2, 1, 0.1, 0.1, 3]
    high = [2, 0.6, 3, 2, 9, 2, 0, 3, 0.5, 0.5, 6]
    names = ("m", "c", "k", "A0", "B0", "Omega", "v1", "v2", "mu1", "mu2", "FN")
    p = Parameters(
        **{name: round(value, 3) for name, value in zip(names, rng.uniform(low, high), strict=True)}
    )
    run = simulate_oracle(p, 0, 0, "0.5", 12, 50)
    assert len(run.events) >= 8
    m, c, k, B0, Omega = (float(value) for value in (p.m, p.c, p.k, p.B0, p.Omega))
    mode = run.events[0].source
    t = 0.0
    state = np.array([0.0, 0.5])
    for event in run.events:
        A = [float(p.A(int(mode[-1]))), float(p.A(int(mode[-1]) + mode.startswith("belt")))]
        belt = float(p.belt(event.boundary))

        def force(t: float, x: float, v: float, constant: float) -> float:
            return (constant + B0 * np.cos(Omega * t) - k * x - c * v) / m

        def flow(
            t: float, y: np.ndarray, constant: float = A[0], stuck: bool = mode.startswith("belt")
        ) -> list[float]:
            return [y[1], 0.0 if stuck else force(t, y[0], y[1], constant)]

        if mode.startswith("belt"):

            def contact(
                t: float, y: np.ndarray, ends: list[float] = A, belt: float = belt
            ) -> float:
                return min(force(t, y[0], belt, ends[0]), -force(t, y[0], belt, ends[1]))
        else:

            def contact(t: float, y: np.ndarray, belt: float = belt) -> float:
                return y[1] - belt

        contact.terminal = True  # type: ignore[attr-defined]
        nudge = 1e-9  # scipy reports the root at its own start
        first = solve_ivp(flow, (t, t + nudge), state, "DOP853", rtol=1e-13, atol=1e-13)
        rest = solve_ivp(
            flow,
            (t + nudge, 12),
            first.y[:, -1],
            "DOP853",
            events=contact,
            rtol=1e-13,
            atol=1e-13,
            max_step=0.02,
        )
        assert abs(rest.t_events[0][0] - float(event.t)) < 1e-9
        assert abs(rest.y_events[0][0][0] - float(event.x)) < 1e-9
        t = float(event.t)
        state = np.array([float(event.x), float(event.v)])
        mode = event.target


def test_roots_of_a_polynomial_with_known_ones() -> None:
    bits = 300
    first = 1 << bits

    def expand(roots: list[Fraction]) -> list[int]:
        series = [Fraction(1)]
        for root in roots:
            series = [
                a - root * b
                for a, b in zip([Fraction(0), *series], [*series, Fraction(0)], strict=True)
            ]
        return [round(coefficient * first) for coefficient in series]

    close = Fraction(1, 3) + Fraction(1, 10**40)
    cases = {
        (Fraction(1, 3), close, Fraction(4, 5)): (Fraction(1, 3), "contact"),
        (Fraction(1, 3), Fraction(1, 3), Fraction(4, 5)): (Fraction(1, 3), "graze"),
        (Fraction(2, 3), Fraction(2, 3), Fraction(2, 3)): (Fraction(2, 3), "contact"),
        (Fraction(-1, 3), Fraction(6, 5), Fraction(7, 9), Fraction(8, 9)): (
            Fraction(7, 9),
            "contact",
        ),
        (Fraction(-1), Fraction(2)): None,
    }
    for roots, expected in cases.items():
        computed = first_root(expand(list(roots)), bits, first >> 285)
        if expected is None:
            assert computed is None
        else:
            assert computed is not None
            assert computed[1] == expected[1]
            assert abs(Fraction(computed[0], first) - expected[0]) < Fraction(1, 10**41)
    many = [Fraction(n, 23) for n in range(3, 22)]
    computed = first_root(expand(many), bits, 0)
    assert computed is not None
    assert abs(Fraction(computed[0], first) - many[0]) < Fraction(1, 10**50)
