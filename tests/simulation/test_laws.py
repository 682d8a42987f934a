"""Belts with static friction, against values of other programs, closed forms and differences."""

from __future__ import annotations

from fractions import Fraction
from math import atan, pi, sqrt
from typing import Any

import numpy as np
import pytest
from law_reference import REFERENCES, Reference
from mpmath import mp, mpf, workdps

from symosc import (
    Belt,
    Oscillator,
    Trajectory,
    sensitivities,
    simulate,
    simulate_many,
)

#: A chaotic motion: neighbouring ones move apart by exp(0.0213 t).
CHAOTIC = Oscillator(
    m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", "0.7", mu_s="1.26")]
)


def oscillator(case: Reference) -> Oscillator:
    return Oscillator(**case.law, belts=[Belt(**belt) for belt in case.belts])


def start(case: Reference) -> dict[str, Any]:
    return dict(zip(("t0", "x0", "v0"), case.start, strict=True)) | {"t_end": case.t_end}


def largest_error(motion: Trajectory, case: Reference) -> float:
    """Return the largest error of t and x, relative to max(1, |value|), over events of one kind."""
    labels = [(event.kind, event.source, event.target) for event in motion.events]
    assert labels == [(event.kind, event.source, event.target) for event in case.events]
    errors = [0.0]
    with workdps(40):
        for event, expected in zip(motion.events, case.events, strict=True):
            for name in ("t", "x"):
                true = mpf(getattr(expected, name))
                errors.append(float(abs(getattr(event, name) - true) / max(1, abs(true))))
    return max(errors)


@pytest.mark.parametrize("case", REFERENCES, ids=lambda case: case.name)
def test_reference_values(case: Reference) -> None:
    for digits, bound in ((None, 1e-12), (30, 1e-24)):
        motion = simulate(oscillator(case), **start(case), digits=digits)
        assert largest_error(motion, case) < bound
        assert motion.status in ("t_end", "equilibrium")


@pytest.mark.compiled("pairs")
@pytest.mark.parametrize("case", REFERENCES, ids=lambda case: case.name)
def test_reference_values_in_compiled_loops(case: Reference) -> None:
    """Of lanes, and of pairs where doubles leave the first contact open (S2)."""
    names = ("t0", "x0", "v0")
    starts = np.array([[float(Fraction(start(case)[name])) for name in names]] * 20)
    table = simulate_many(oscillator(case), starts, float(Fraction(case.t_end)), use_numba=True)
    alone = simulate(oscillator(case), **start(case))
    if case.name in ("S2-", "S3b-"):  # their starts are no doubles
        return
    assert table[7].t == pytest.approx([event.t for event in alone.events], rel=1e-13)
    assert list(table[7].kind) == [event.kind for event in alone.events]


def test_the_stick_slip_cycle_in_closed_form() -> None:
    """c = 0, no drive: period 2a/V + (2/w)(pi - atan(a w/V)), extremes f/k +- hypot(a, V/w)."""
    for m, k, V, f, s in ((1, 1, "1/5", "1/2", 1), (2, 3, "1/7", "1/3", "5/4"), (1, 9, 2, 1, 7)):
        belt = Belt(V, f, mu_s=s)
        moving = simulate(Oscillator(m=m, c=0, k=k, belts=[belt]), v0=V, t_end=60, digits=30)
        slips = [event.t for event in moving.events if event.kind == "slip"]
        with workdps(40):
            V, f, s = (
                mpf(number.numerator) / number.denominator
                for number in (belt.v, belt.mu, belt.mu_s)
            )
            a = (s - f) / k
            w = mp.sqrt(mpf(k) / m)
            period = 2 * a / V + 2 / w * (mp.pi - mp.atan(a * w / V))
            assert abs(slips[1] - slips[0] - period) < 1e-27
            highest = f / k + mp.hypot(a, V / w)
            x = moving(np.linspace(float(slips[0]), float(slips[1]), 20_001))[0]
            assert abs(x.max() - float(highest)) < 1e-6


def test_a_pulled_spring() -> None:
    """The mass waits for (s - f) 2/(k V), not for s/(k V) as a calculator on the web says."""
    model = Oscillator(m=1, c=0, k=2, belts=[Belt("-1/10", "1/2", mu_s="4/5")])
    events = simulate(model, v0="-1/10", t_end=24).events
    waits = [b.t - a.t for a, b in zip(events[1::2], events[2::2], strict=False)]
    assert waits == pytest.approx([2 * 0.3 / (2 * 0.1)] * len(waits), abs=1e-13)
    flight = (2 * pi - 2 * atan(0.15 * sqrt(2) / 0.1)) / sqrt(2)
    assert events[1].t - events[0].t == pytest.approx(flight, abs=1e-13)


def test_equality_holds_as_long_as_it_can() -> None:
    """At the static limit the first derivative that is not 0 decides; a hair more slips."""
    waiting = Oscillator(m=1, c=0, k=1, B0="1/2", Omega=1, belts=[Belt(0, "1/2", mu_s=1)])
    assert len(simulate(waiting, x0="-1/2", t_end=60).events) == 0  # touches the limit each period
    moved = simulate(waiting, x0=Fraction(-1, 2) - Fraction(1, 10**20), t_end=60)
    assert [event.kind for event in moved.events] == ["stick"]
    arriving = Oscillator(m=1, c=0, k=1, belts=[Belt(2, "1/2", mu_s=1)])
    assert [event.kind for event in simulate(arriving, x0=3, t_end=5).events] == ["stick"]
    above = simulate(arriving, x0=Fraction(3) + Fraction(1, 10**12), t_end=5)
    assert [event.kind for event in above.events][:1] == ["cross"]


def test_a_graze_is_the_onset_of_a_stick() -> None:
    """And a motion that misses the belt by 1e-12 flies on, for ever."""
    kinds = {case.name: [event.kind for event in case.events] for case in REFERENCES}
    assert kinds["S2"][0] == "stick"
    assert kinds["S2-"] == []


@pytest.mark.slow
def test_chaos_is_carried_as_far_as_digits_promise() -> None:
    """Over 1,000 time units neighbouring motions move apart by 13 digits."""
    known = simulate(CHAOTIC, t_end=1000, digits=40)
    exact = simulate(CHAOTIC, t_end=1000, digits=60)
    assert known.status == exact.status == "t_end"
    assert len(known.events) == len(exact.events) > 150
    with workdps(70):
        for event, true in zip(known.events, exact.events, strict=True):
            assert event.kind == true.kind
            assert abs(event.t - true.t) < 1e-40 * max(1, true.t)
            assert abs(event.x - true.x) < 1e-40 * max(1, abs(true.x))
    in_double_precision = simulate(CHAOTIC, t_end=1000).events
    assert [event.t for event in in_double_precision] == pytest.approx(
        [float(event.t) for event in exact.events], abs=1e-10
    )


@pytest.mark.slow
def test_digits_that_chaos_eats_are_asked_for_again() -> None:
    """44 digits last for some 3,000 time units; from there on twice as many follow the motion."""
    span = 3600
    finer = simulate(CHAOTIC, t_end=span)
    assert max(event.t_error / event.t for event in finer.events) < 1e-13
    exact = simulate(CHAOTIC, t_end=span, digits=20)
    assert [event.t for event in finer.events] == pytest.approx(
        [float(event.t) for event in exact.events], abs=1e-11
    )


def test_errors_of_doubles_grow_with_the_motion() -> None:
    """Doubles alone lose the motion, and say so: their errors are within a few of their estimates."""
    alone = simulate(CHAOTIC, t_end=400, accuracy="1e-4")
    exact = simulate(CHAOTIC, t_end=400, digits=30)
    pairs = list(zip(alone.events, exact.events, strict=False))
    errors = [abs(event.t - float(true.t)) / event.t_error for event, true in pairs]
    assert max(errors) < 6
    estimates = [event.t_error for event, _ in pairs]
    assert max(estimates) > 1e4 * estimates[0]


@pytest.mark.slow
def test_lyapunov_exponents() -> None:
    """The values of a program with twin motions: +0.0213 per unit of time, within its scatter."""
    chaotic = sensitivities(CHAOTIC, "x0", t_end=8000)
    assert chaotic.lyapunov[0] == pytest.approx(0.02125, rel=0.2)
    assert 0 < chaotic.lyapunov_error < 0.2 * chaotic.lyapunov[0]
    assert chaotic.lyapunov[1] == -np.inf
    period = 2 * pi / 1.4
    for mu_s, per_period in (("0.7", -0.476), ("0.77", -0.465), ("0.98", -0.239)):
        regular = sensitivities(CHAOTIC.replace(mu_s1=mu_s), "x0", t_end=1500).lyapunov[0]
        assert regular * period == pytest.approx(per_period, abs=0.012)


DIFFERENTIATED = Oscillator(
    m="5/4", c="1/10", k=1, A0="1/20", B0="3/10", Omega="21/10", FN="8/9",
    belts=[Belt("1/10", "2/5", mu_s="7/10"), Belt("1/5", "1/10", mu_s="1/4")],
)  # fmt: skip
START = {"t0": Fraction(1, 10), "x0": Fraction(1, 3), "v0": Fraction(3, 2), "t_end": 14}


@pytest.mark.slow
def test_derivatives_against_differences() -> None:
    """By all numbers of the model and the start, through sticks, slips and crossings."""
    names = (*DIFFERENTIATED.numbers(), "t0", "x0", "v0")
    exact = sensitivities(DIFFERENTIATED, names, **START, digits=30)
    kinds = {event.kind for event in exact.trajectory.events}
    assert kinds == {"cross", "stick", "slip"}
    assert exact.regular.all()
    step = Fraction(1, 10**12)

    def moved(name: str, by: Fraction) -> np.ndarray:
        start = dict(START)
        model = DIFFERENTIATED
        if name in start:
            start[name] += by
        else:
            model = model.replace(**{name: model.numbers()[name] + by})
        motion = simulate(model, **start, digits=40)
        return np.array([[event.t, event.x] for event in motion.events])

    for n, name in enumerate(names):
        difference = (moved(name, step) - moved(name, -step)) / (
            2 * mpf(step.numerator) / step.denominator
        )
        found = np.stack([exact.dt[:, n], exact.dx[:, n]], axis=1)
        assert abs(difference - found).max() < 1e-14 * max(1, abs(found).max()), name
    rough = sensitivities(DIFFERENTIATED, names, **START)
    assert abs(rough.dt - exact.dt.astype(float)).max() < 1e-11
    rows = [[0.1, "1/3", 1.5]]
    table = simulate_many(DIFFERENTIATED, rows, 14, wrt=names, use_numba=False)
    assert abs(table.dt - rough.dt).max() < 1e-11


def test_the_saltation_of_a_slip() -> None:
    """dv+ = -+E (k/m) dx/slope; at the second slip of S1 a value of another program."""
    (case,) = [case for case in REFERENCES if case.name == "S1"]
    moved = sensitivities(oscillator(case), "x0", **start(case))
    slip = moved.trajectory.events[3]
    before = moved(slip.t - 1e-9)[0, 0]
    assert moved(slip.t)[1, 0] / before == pytest.approx(-0.597576679196972860, abs=1e-12)


def test_names_of_derivatives_are_those_of_the_law() -> None:
    coulomb = Oscillator(m=1, c=0, k=1, belts=[Belt(1, "1/2")])
    for name in ("mu_s1", "mu2", "v2", "mu_s2"):
        with pytest.raises(ValueError, match="must be one of m, c, k, A0, B0, FN, v1, mu1, t0"):
            sensitivities(coulomb, name, t_end=5)
    both = sensitivities(coulomb, "mu1", x0=4, t_end=9)
    assert both.regular.all()


def test_three_belts_have_their_own_words_and_numbers() -> None:
    """What the events are is a matter of `test_random_laws`."""
    law = {"m": 1, "c": "1/5", "k": 1, "B0": 1, "Omega": 1}
    three = Oscillator(**law, belts=[Belt(v, 1) for v in (1, 2, 3)])
    assert len(three.bands) == 4
    motion = simulate(three, x0=-8, v0=0, t_end=25)
    table = simulate_many(three, [(0, -8, 0)] * 2, 25, use_numba=False)
    second = table.trajectory == 1
    assert table.t[second].tolist() == [event.t for event in motion.events]
    assert table.boundary[second].tolist() == [event.boundary for event in motion.events]
    assert motion.word[:6] == ["U12", "U23", "A3", "D32", "D21", "B1"]
    summary = simulate_many(three, [(0, -8, 0)] * 2, 25, use_numba=False, record="summary")
    assert summary.mode[0] == motion.mode(25)


def test_an_uncertain_start_leaves_a_touch_open() -> None:
    """Some starts touch the belt and stick, others miss it for ever; without static friction both
    are one motion.
    """
    law = {"m": 1, "c": 0, "k": 1, "B0": "3/2", "Omega": "1/2"}
    start: dict[str, Any] = {"x0": "5/2", "t_end": 30, "start_error": ("0", "0", "1e-9")}
    fork = Oscillator(**law, belts=[Belt(1, "1/2", mu_s=1)])
    for digits in (None, 20):
        motion = simulate(fork, **start, digits=digits)
        assert (motion.status, len(motion.events)) == ("undecidable", 0)
        assert motion.t_end == pytest.approx(3 * pi, abs=1e-6)
    error = start["start_error"]
    table = simulate_many(fork, [(0, 2.5, 0)], 30, start_error=error, use_numba=False)
    assert list(table.status) == ["undecidable"]
    coulomb = simulate(fork.replace(mu_s1="1/2"), **start)
    assert [event.kind for event in coulomb.events] == ["graze", "graze"]
    ends = [len(simulate(fork, x0="5/2", v0=v0, t_end=30).events) for v0 in ("-1e-9", "1e-9")]
    assert sorted(ends)[0] == 0 < sorted(ends)[1]
