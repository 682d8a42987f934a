"""Without a drive (B0 = 0) nothing depends on Omega: neither events nor status, nor what is refused.

The oracle is theory: with c = 0 and one belt at rest the mass swings about ± mu m g/k, half a period
of the free motion each time, and stays where it turns within mu m g/k of 0.
"""

from __future__ import annotations

import random
from fractions import Fraction
from math import pi, sqrt
from typing import Any

import pytest

from symosc import OtherModel, ParameterError, Parameters, simulate, simulate_many
from symosc.engine.start import Start
from symosc.simulation.simulate import check_reached

OMEGAS = ("1e-6", "0.01", "1", "10", "12345.678", "1e8")
#: The example of a user: at rest on the ground from t = 7.98 on.
EXAMPLE = {"m": "1.52", "k": "2.12", "mu1": "0.1", "g": "9.81"}


def outcome(motion: Any) -> tuple[Any, ...]:
    """Return status, message and events of a motion, without their phases."""
    events = [(entry.kind, entry.boundary, entry.t, entry.x, entry.v) for entry in motion.events]
    return motion.status, motion.message, events


@pytest.mark.parametrize("t_end", ["2", "7.9", "7.99", "10", "1000"])
def test_a_mass_that_rests_rests_whatever_omega_is(t_end: str) -> None:
    m, k, mu, g = (float(EXAMPLE[name]) for name in ("m", "k", "mu1", "g"))
    swing = pi * sqrt(m / k)
    reach = mu * m * g / k
    turns = [4.0]
    while abs(turns[-1]) > reach:
        way = 1 if turns[-1] > 0 else -1
        turns.append(2 * way * reach - turns[-1])
    times = [swing * n for n in range(1, len(turns))]
    expected = [(t, x) for t, x in zip(times, turns[1:], strict=True) if t < float(t_end)]
    for Omega in OMEGAS:
        motion = simulate(OtherModel(**EXAMPLE, Omega=Omega), x0=4, t_end=t_end)
        assert motion.status == ("equilibrium" if times[-1] < float(t_end) else "t_end"), Omega
        computed = [(entry.t, entry.x) for entry in motion.events]
        assert len(computed) == len(expected)
        for event, theory in zip(computed, expected, strict=True):
            assert event == pytest.approx(theory, rel=1e-13, abs=1e-13)


def random_undriven(rng: random.Random) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return parameters without B0 and Omega, and a start with an end."""
    v1 = rng.choice([0, -1, 1, rng.randint(-20, 20) / 10])
    values = {
        "m": rng.choice([1, rng.randint(1, 40) / 10]),
        "c": rng.choice([0, 0, 1, rng.randint(1, 90) / 10]),
        "k": rng.choice([0, 1, 1, rng.randint(1, 90) / 10]),
        "A0": rng.choice([0, 0, rng.randint(-30, 30) / 10]),
        "v1": v1,
        "v2": rng.choice([v1 + 1, 0 if v1 < 0 else v1 + 2, v1 + 50]),
        "mu1": rng.randint(0, 9) / 10,
        "mu2": rng.choice([0, rng.randint(0, 9) / 10]),
        "FN": rng.choice([1, rng.randint(1, 60) / 10]),
    }
    if values["c"] == values["k"] == 0:  # `test_a_mass_without_spring_and_damper`
        values["c"] = 1
    start = {"x0": rng.randint(-40, 40) / 10, "v0": rng.choice([0, rng.randint(-40, 40) / 10])}
    start |= {"t0": rng.choice([0, 0.5]), "t_end": rng.choice([3, 20, 300])}
    return values, start


def answers(count: int, seed: int) -> None:
    """Check that `count` random motions without a drive are the same for every Omega."""
    rng = random.Random(seed)
    for _ in range(count):
        values, start = random_undriven(rng)
        expected = None
        for Omega in rng.sample(OMEGAS, 3):
            p = Parameters(**values, B0=0, Omega=Omega)
            motion = simulate(p, **start, max_events=200)
            expected = expected or outcome(motion)
            assert outcome(motion) == expected, (values, start, Omega)
            row = [(start["t0"], start["x0"], start["v0"])]
            asked = {"max_events": 200, "use_numba": False}
            many = simulate_many(p, row, start["t_end"], record="summary", **asked)
            assert many.status[0] == motion.status, (values, start, Omega)
            assert many.events[0] == len(motion.events), (values, start, Omega)


def test_random_motions_do_not_depend_on_omega() -> None:
    answers(20, 1)


@pytest.mark.campaign
def test_many_random_motions_do_not_depend_on_omega() -> None:
    answers(500, 2)


@pytest.mark.compiled("doubles")
def test_compiled_motions_do_not_depend_on_omega_either() -> None:
    """All together, as a sweep over Omega, so that they are followed side by side."""
    rng = random.Random(3)
    for _ in range(30):
        values, start = random_undriven(rng)
        sets = [Parameters(**values, B0=0, Omega=Omega) for Omega in OMEGAS]
        rows = [(start["t0"], start["x0"], start["v0"])] * len(sets)
        summary = simulate_many(sets, rows, start["t_end"], record="summary", max_events=200)
        events = simulate_many(sets, rows, start["t_end"], max_events=200)
        motion = simulate(sets[0], **start, max_events=200)
        assert set(summary.status) == {motion.status}, (values, start)
        assert set(summary.events) == {len(motion.events)}, (values, start)
        for name in ("x", "v", "stuck", "x_min", "x_max", "v_min", "v_max"):
            column = getattr(summary, name)
            assert (column == column[0]).all() or (column != column).all(), (name, values, start)
        for i in range(len(sets)):
            own = events.t[events.trajectory == i]
            assert own.tolist() == events.t[events.trajectory == 0].tolist(), (values, start)


def test_with_digits_too() -> None:
    for Omega in OMEGAS:
        motion = simulate(OtherModel(**EXAMPLE, Omega=Omega), x0=4, t_end=10, digits=25)
        assert motion.status == "equilibrium"
        assert len(motion.events) == 3


@pytest.mark.parametrize("Omega", OMEGAS)
def test_a_mass_at_rest_has_come_to_rest(Omega: str) -> None:
    """Exactly at its equilibrium, without and with a damper, between the belts and on one."""
    values = {"m": 1, "k": 2, "B0": 0, "A0": 0, "v2": 5, "mu1": "0.1", "mu2": "0.1", "FN": 1}
    for c in (0, 1):
        free = Parameters(**values, c=c, v1=-5, Omega=Omega)
        on_belt = free.replace(v1=0)
        assert simulate(free, x0=0, v0=0, t_end="1e-3").status == "equilibrium"
        assert simulate(on_belt, x0="0.01", v0=0, t_end="1e-3").status == "equilibrium"
        for p in (free, on_belt):
            rows = simulate_many(p, [(0, 0, 0)], "1e-3", record=["status", "multiplicity"])
            assert rows.status.tolist() == ["equilibrium"]
            assert rows.multiplicity.tolist() == [1]


def test_how_long_a_motion_is_followed_does_not_depend_on_omega() -> None:
    """It swings for ever, with an event each time; 1.6e11 periods of a drive would be refused."""
    values = {"m": 1, "c": 0, "k": 1, "B0": 0, "A0": 0, "mu1": "0.1", "mu2": 0, "FN": 1}
    outcomes = []
    for Omega in (1, 10**9):
        p = Parameters(**values, Omega=Omega, v1=1, v2=90)
        outcomes.append(outcome(simulate(p, x0=0, v0="1.5", t_end=1000)))
    assert outcomes[0][0] == "t_end"
    assert outcomes[0] == outcomes[1]


def test_what_is_given_up_before_its_end_is_refused() -> None:
    """Events for more than 1e8 searches would take days: here the answer is asked directly."""
    p = Parameters(m=1, c=0, k=1, B0=0, A0=0, Omega=1, v1=1, v2=90, mu1=0, mu2=0, FN=1)
    numbers = Fraction(0), Fraction(0), Fraction(2)
    check_reached(Start(p, *numbers, Fraction(10**9)))
    with pytest.raises(ParameterError, match="is more than 5e\\+09 after t0 = 0, more than is"):
        check_reached(Start(p, *numbers, Fraction(10**10)))


def test_a_mass_without_spring_and_damper() -> None:
    """Nothing but Omega is a rate here: events are the same within the last digit."""
    values = {"m": "2.4", "c": 0, "k": 0, "A0": 0, "B0": 0, "v1": 0, "v2": 1, "mu1": "0.4"}
    for Omega in OMEGAS:
        p = Parameters(**values, mu2="0.5", FN=3, Omega=Omega)
        motion = simulate(p, t0="0.5", x0="2.9", v0=3, t_end=300)
        assert motion.status == "t_end"  # it goes on with belt 2
        (stick,) = motion.events
        assert stick.t == pytest.approx(0.5 + 2 * 2.4 / 2.7, rel=1e-15)
