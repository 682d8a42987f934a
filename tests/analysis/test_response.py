"""Frequency responses: against an integration of the equations, closed forms, and the balance of energies."""

from __future__ import annotations

from itertools import pairwise
from math import pi, sqrt

import numpy as np
import pytest
from other_models import KINDS, TURN, Original, drawn
from scipy.integrate import quad
from scipy.optimize import minimize_scalar
from stiction_solver import solved

from symosc import (
    Belt,
    Oscillator,
    OtherModel,
    ParameterError,
    Parameters,
    find_orbit,
    frequency_response,
    load_scene,
    simulate,
)
from symosc.analysis.response import settle
from symosc.analysis.response_cycle import cycle_response
from symosc.orbits import settling


def wall(F: float | str, **others: object) -> OtherModel:
    """Return the oscillator with Coulomb friction of the literature, m = k = P = 1."""
    return OtherModel(**{"m": 1, "k": 1, "Omega": 1, "FN": F, "B0": 1} | others)  # type: ignore[arg-type]


#: Models whose base is not pulled.
PERIODIC = [kind for kind in KINDS if "pull" not in kind]


def test_a_pulled_spring_has_no_response() -> None:
    model = drawn("pulled spring", 1)
    for over in ({"Omega": [1]}, {"pull": [1]}):
        with pytest.raises(ParameterError, match="motion of a pulled spring is not periodic"):
            frequency_response(model, over)


@pytest.mark.parametrize("kind", PERIODIC)
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.campaign)])
@pytest.mark.quick(2)
def test_it_is_that_of_the_models_own_equation(kind: str, seed: int) -> None:
    """Follow the equation by DOP853 until it has settled, and integrate over the last cycle by quad."""
    model = drawn(kind, 100 + seed).replace(c="4/5", m=1)
    Om = float(model.Omega)
    follow = Original(model)
    response = frequency_response(model, {"Omega": [Om]})
    n = follow.n
    period = TURN / Om
    end = 14 * period + 60  # exp(-0.4 * 60) is 4e-11; a motion with sticks may be slower
    begin = end - period
    events, state = follow.follow(0.0, 0.1, 0.2, end)
    cuts = [begin, *(t for t, _, _ in events if begin < t < end), end]

    def integral(function: object) -> float:
        spans = ((a, b) for a, b in pairwise(cuts) if b - a > 1e-12)
        return sum(quad(function, a, b, epsabs=1e-11, epsrel=1e-11, limit=200)[0] for a, b in spans)

    def slips(t: float, belt: int) -> float:
        return abs(float(state(t)[1]) - follow.belts(t)[0][belt])

    def extreme(sign: int) -> float:
        near = times[int(np.argmax(sign * x))]
        step = times[1] - times[0]
        bounds = (near - step, min(near + step, end))
        fine = {"xatol": 1e-9}
        best = minimize_scalar(
            lambda t: -sign * state(t)[0], bounds=bounds, method="bounded", options=fine
        )
        return float(-sign * best.fun)

    most = [n["mu1"] * n["FN"], n["mu2"] * n["FN"]]
    heat = sum(
        most[i] * integral(lambda t, i=i: slips(t, i)) for i in range(1 if follow.one_belt else 2)
    )
    damper = n["c"] * integral(lambda t: (state(t)[1] - follow.base(t)[1]) ** 2)
    parts = (integral(lambda t, f=f: state(t)[0] * f(Om * t)) for f in (np.cos, np.sin))
    first = 2 / period * (next(parts) - 1j * next(parts))
    times = np.linspace(begin, end, 2001)
    x = np.array([state(t)[0] for t in times])
    held = [
        (a, b)
        for (a, kind), (b, _) in pairwise([*((t, kind) for t, _, kind in events), (end, "")])
        if kind == "stick"
    ]
    stuck = sum(max(0.0, b - max(a, begin)) for a, b in held)
    assert response.status[0] in ("orbit", "rest")
    expected = {
        "amplitude": (extreme(1) - extreme(-1)) / 2,
        "harmonic": abs(first),
        "friction": heat,
        "damper": damper,
    }
    for name, value in (expected | {"work": heat + damper, "stuck": stuck / period}).items():
        assert getattr(response, name)[0] == pytest.approx(
            value, rel=1e-8, abs=1e-8 if name == "stuck" else 1e-9
        ), name
    if model.Y:
        excitation = model.base
    elif model.B0:
        excitation = model.force
    else:
        excitation = None
    if excitation is not None and response.harmonic[0] > 0:
        lag = np.angle(complex(float(excitation.C), -float(excitation.S)) / first)
        assert np.angle(np.exp(1j * (response.phase[0] - lag))) == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize("kind", PERIODIC)
@pytest.mark.quick(3)
def test_what_goes_in_is_what_is_lost(kind: str) -> None:
    """Over 16 frequencies and springs of random models, most of them with sticks.

    And the errors are what is said.
    """
    for seed in range(2):
        model = drawn(kind, seed)
        for name, values in (("Omega", "0.35:2.9:4"), ("k", "0.6:3.5:4")):
            response = frequency_response(model, {name: values})
            known = np.isfinite(response.amplitude)
            for status in response.status[~known]:
                assert model.c == 0
                assert "for ever" in status
            scale = np.maximum(
                np.abs(response.dissipated), float(model.FN or 1) * response.amplitude
            )[known]
            assert (np.abs(response.work - response.dissipated)[known] < 1e-11 * scale).all()
            assert (response.error[known] < 1e-10 * (1 + response.amplitude[known])).all()


def test_den_hartogs_amplitude_and_phase() -> None:
    """Trans. ASME 53 (1931): amplitudes and, for c = 0, the phase of the highest point."""
    for c, F, Omega, x0 in (("0", "0.4", 1.5, 0.6531972647421811), ("0.2", "0.4", 1.5, 0.5488324917917096),
                            ("0.1", "0.25", 0.6, 1.487067086810845)):  # fmt: skip
        response = frequency_response(wall(F, c=c), {"Omega": [Omega]})
        assert response.word.tolist() == ["B1∘A1"]
        assert response.amplitude[0] == pytest.approx(x0, rel=1e-13)
    # the drive does pi B0 X1 sin(lag) per cycle, and friction takes 4 F x0
    response = frequency_response(wall("0.4"), {"Omega": "1.3:2:5"})
    assert response.work == pytest.approx(
        pi * response.harmonic * np.sin(response.phase), rel=1e-12
    )
    assert response.dissipated == pytest.approx(1.6 * response.amplitude, rel=1e-12)
    assert (response.damper == 0).all()
    # what the ground feels: P cos(Omega t) - m x'', with a jump of 2 F at the highest point
    motion = simulate(wall("0.4").replace(Omega="1.5").parameters, t_end="60T")
    t = np.linspace(50, 60, 40_001) * TURN / 1.5
    x, v = motion(np.clip(t, 0, float(motion.t_end)))
    felt = x + 0.4 * np.sign(v)
    ranged = frequency_response(wall("0.4"), {"Omega": [1.5]})
    assert ranged.transmissibility[0] == pytest.approx(np.ptp(felt) / 2, rel=1e-5)


def test_motions_that_meet_no_belt_and_rests() -> None:
    p = Parameters(m=2, c=1, k=3, A0=1, B0=1, Omega=2, v1=-5, v2=5, mu1=1, mu2="1/2", FN=1)
    response = frequency_response(p, {"Omega": [0.5, 2.0]})
    assert response.status.tolist() == ["linear"] * 2
    exact = 1 / (3 - 2 * response.values**2 + 1j * response.values)
    assert response.amplitude == pytest.approx(abs(exact), rel=1e-13)
    assert response.balance == pytest.approx(abs(exact), rel=1e-13)
    assert response.phase == pytest.approx(-np.angle(exact), rel=1e-12)
    assert response.damper == pytest.approx(pi * response.values * abs(exact) ** 2, rel=1e-12)
    # both belts slip all the time, and their motors do that work: 2 mu FN |v| per unit of time
    assert response.friction == pytest.approx(TURN / response.values * 1.5 * 5, rel=1e-12)
    rest = frequency_response(wall("1.01", c="0.1"), {"Omega": [0.5, 1.0]})
    assert rest.status.tolist() == ["rest"] * 2
    assert (rest.amplitude.tolist(), rest.stuck.tolist(), rest.dissipated.tolist()) == (
        [0, 0],
        [1, 1],
        [0, 0],
    )
    assert np.isnan(rest.balance_error).all()  # harmonic balance rests too: 0/0
    ridden = frequency_response(
        OtherModel(m=1, k=1, Omega=1, FN=9, Y=2, joined=True), {"Omega": [0.5]}
    )
    assert ridden.transmissibility[0] == pytest.approx(1, abs=1e-14)
    assert ridden.balance_error[0] == pytest.approx(0, abs=1e-14)


def test_harmonic_balance_is_what_the_books_have() -> None:
    """One belt at rest and c = 0: (P^2 - (4 F/pi)^2)^(1/2)/|k - m Omega^2|.

    And its error shrinks with friction.
    """
    F = 0.3
    Om = np.array([0.7, 1.4, 2.0])
    response = frequency_response(wall("0.3"), {"Omega": Om})
    assert response.balance == pytest.approx(
        sqrt(1 - (4 * F / pi) ** 2) / abs(1 - Om**2), rel=1e-12
    )
    assert response.balance_error == pytest.approx(
        response.balance / response.amplitude - 1, rel=1e-12
    )
    errors = [
        abs(frequency_response(wall(F), {"Omega": [1.4]}).balance_error[0])
        for F in ("0.4", "0.2", "0.1")
    ]
    assert errors[0] > 3 * errors[1] > 9 * errors[2]
    # belts that move: the first harmonic of friction by quadrature
    p = load_scene("fig9").parameters
    response = frequency_response(p, {"Omega": [4.0]})
    m, c, k, B0, FN = (float(item) for item in (p.m, p.c, p.k, p.B0, p.FN))
    V = 4 * response.balance[0]
    a = (np.arange(400_000) + 0.5) * TURN / 400_000
    friction = -sum(
        float(mu) * FN * np.sign(-V * np.sin(a) - float(v))
        for mu, v in ((p.mu1, p.v1), (p.mu2, p.v2))
    )
    harmonic = 2 * float(np.mean(friction * np.sin(a)))
    assert np.hypot((k - 16 * m) * V / 4, c * V + harmonic) == pytest.approx(B0, rel=1e-5)


def test_the_error_says_how_far_a_motion_is_from_the_settled_one() -> None:
    """A start that is off by 1e-6 in x; differences shrink slowly here."""
    model = wall("0.1", c="0.05")
    _, (t, x, v), orbit = settle(model.parameters, (0.0, 1.0), None)
    assert orbit is not None
    assert max(map(abs, orbit.multipliers)) > 0.8
    assert 5e-7 < cycle_response(model, model.parameters, (t, x + 1e-6, v), orbit)["error"] < 1e-5


def test_marinos_inversion() -> None:
    """Beyond a frequency ratio near sqrt(2) friction on a wall that moves with the base amplifies its motion."""
    base = OtherModel(m=1, k=1, Omega=1, FN=1, Y=1, joined=True)
    swept = [
        frequency_response(base.replace(Omega=r), {"FN": [0.1, 0.3, 0.5]}) for r in ("1.35", "1.6")
    ]
    low, high = (result.transmissibility for result in swept)
    assert 1 / (1.35**2 - 1) > low[0] > low[1] > low[2]
    assert 1 / (1.6**2 - 1) < high[0] < high[1] < high[2]
    small = frequency_response(base.replace(FN="0.02"), {"Omega": [1.412, 1.4161]}).transmissibility
    assert np.sign(small * (np.array([1.412, 1.4161]) ** 2 - 1) - 1).tolist() == [
        -1,
        1,
    ]  # sqrt(2) = 1.41421


# -- laws with several settled motions -------------------------------------------------------------

#: A mass on a running belt with falling friction: a small oscillation is stable beside large ones.
FALLING = Oscillator(
    m=1, c="1/10", k=1, B0="1/10", Omega=1,
    belts=[Belt("3/2", curve=[(0, 1), ("1/4", "4/5"), (1, "14/25"), (3, "1/2")])],
)  # fmt: skip


def test_up_and_down_differ_where_two_motions_are_stable(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(settling, "SETTLING_LOOPS", (60, 200))  # long enough here
    found = frequency_response(FALLING, {"Omega": [0.85, 1.0]})
    assert found.values.tolist() == [0.85, 1.0, 1.0, 0.85]
    assert found.direction.tolist() == ["up", "up", "down", "down"]
    assert found.status[:3].tolist() == ["linear", "orbit", "orbit"]
    assert found.word.tolist() == ["", "S1∘B1", "S1∘B1", ""]
    assert "does not settle" in found.status[3]
    # In the band of the relative speeds 1 to 3 friction takes 0.03 from the damping.
    linear = 0.1 / abs(1 - 0.85**2 + 0.07j * 0.85)
    assert found.amplitude[0] == pytest.approx(linear, rel=1e-12)
    assert found.amplitude[1] == pytest.approx(found.amplitude[2], rel=1e-12)
    assert found.work[:3] == pytest.approx(found.dissipated[:3], rel=1e-12)
    up = frequency_response(FALLING, {"Omega": [0.85]}, direction="up")
    assert up.amplitude[0] == found.amplitude[0]
    with pytest.raises(ParameterError, match=r'direction.*must be "up", "down" or "both"'):
        frequency_response(FALLING, {"Omega": [1]}, direction="left")
    with pytest.raises(ParameterError, match=r"direction.*must be omitted: under this law"):
        frequency_response("fig9", {"Omega": [4]}, direction="up")


@pytest.mark.parametrize(
    "model",
    [
        FALLING,
        FALLING.replace(belts=[Belt(0, "1/20", mu_s="1/10"), Belt(-1, "1/20")], Omega="4/5"),
    ],
    ids=["falling", "static"],
)
def test_other_laws_by_integration(model: Oscillator) -> None:
    """Amplitude, energies and time of sticking of an orbit, by a careful user of scipy."""
    Omega = float(model.Omega)
    found = frequency_response(model, {"Omega": [Omega]}, direction="up")
    assert found.status.tolist() == ["orbit"]
    period = TURN / Omega
    # Near the orbit, to which the motion by scipy comes by itself.
    x0, v0 = find_orbit(model)(0.0)
    run = solved(model, (0.0, x0 + 1e-5, v0), 25 * period)
    times = np.linspace(24 * period, 25 * period, 200_001)
    x, v = run(times)
    damper = float(model.c) * np.trapezoid(v * v, times)
    heat = np.zeros_like(v)
    stuck = np.zeros(len(v), bool)
    for belt in model.belts:
        w = np.abs(v - float(belt.v))
        points = np.array(belt.curve or [(0, belt.mu)], dtype=float)
        heat += w * np.interp(w, *points.T)
        stuck |= w < 1e-9
    assert found.stuck[0] == pytest.approx(stuck.mean(), abs=2e-5)
    assert found.amplitude[0] == pytest.approx(np.ptp(x) / 2, rel=1e-7)
    assert found.damper[0] == pytest.approx(damper, rel=1e-7)
    assert found.friction[0] == pytest.approx(np.trapezoid(heat, times), rel=1e-7)
    first = 2 / period * np.trapezoid(x * np.exp(-1j * Omega * times), times)
    assert found.harmonic[0] == pytest.approx(abs(first), rel=1e-7)
    assert found.phase[0] == pytest.approx(-np.angle(first), abs=1e-7)


def test_a_response_over_numbers_of_a_belt() -> None:
    over = {"mu1_1": [0.7, 0.8]}
    found = frequency_response(FALLING, over, direction="down")
    assert found.mu1_1 is found.values
    with pytest.raises(AttributeError, match="no column 'Omega'; it has mu1_1, status"):
        _ = found.Omega
    for value, amplitude in zip(found.values, found.amplitude, strict=True):
        alone = frequency_response(FALLING.replace(mu1_1=value), {"Omega": [1]}, direction="up")
        assert amplitude == pytest.approx(alone.amplitude[0], rel=1e-10)
    for change, message in (
        ({"B0": 0}, "B0.*must not be 0 under this law"),
        ({"k": 0}, "k.*must be > 0"),
    ):
        with pytest.raises(ParameterError, match=message):
            frequency_response(FALLING.replace(**change), {"Omega": [1]})
    with pytest.raises(ParameterError, match=r"over.*choose one of m, k, .*w1_1"):
        frequency_response(FALLING, {"w1_9": [1]})
