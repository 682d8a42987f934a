"""Periodic orbits and rests under any friction law, against closed forms, an oracle and literature."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import atan, exp, inf, pi
from typing import Any

import mpmath
import numpy as np
import pytest
from cli_runs import run
from law_orbits import DRIVEN, FREE, STICK_SLIP, TWO_BANDS, confirmed, driven
from scipy.integrate import solve_ivp

from symosc import (
    Belt,
    BranchError,
    ConvergenceError,
    Oscillator,
    ParameterError,
    Scene,
    WordError,
    continue_orbit,
    find_orbit,
    load_scene,
    plot,
    simulate,
)
from symosc.orbits.shooting import orbit_near
from symosc.scenes import as_toml

#: Friction 1/2 + 1/2 exp(-2 w), at a speed where a rest and a stick-slip cycle attract.
FALLING = Oscillator(
    m=1,
    c="0.1",
    k=1,
    belts=[Belt.from_function("1.5", lambda w: 0.5 + 0.5 * exp(-w / 0.5), 5, 16)],
)
THREE = Oscillator(
    m=1, c="0.2", k=1, B0=3, Omega=2,
    belts=[Belt(-1, mu="0.5"), Belt(0, mu="0.5", mu_s="0.829"), Belt(1, mu="0.3")],
)  # fmt: skip


def test_a_belt_that_is_never_reached_is_a_constant_force() -> None:
    """As the message says where it is too fast for orbits to be found."""
    slow = Belt("1/2", "0.3", mu_s="0.6")
    law: dict[str, Any] = {"m": 1, "c": "0.1", "k": 1, "B0": 1, "Omega": 2}
    far = find_orbit(Oscillator(**law, belts=[slow, Belt(1000, "0.1")]))
    without = find_orbit(Oscillator(**law, A0="0.1", belts=[slow]))
    assert far.multipliers == pytest.approx(without.multipliers, abs=1e-9)
    with pytest.raises(ParameterError, match=r"belt 2 is too fast.* as a constant force A0$"):
        find_orbit(Oscillator(**law, belts=[slow, Belt(10**12, "0.1")]))


def test_a_motion_that_sticks_throughout_is_not_one_of_a_belt_too_fast() -> None:
    slow = Oscillator(m=1, c="0.1", k=1, B0="0.1", Omega=2, belts=[Belt("0.1", 3, mu_s=4)])
    with pytest.raises(ConvergenceError, match="never flies"):
        orbit_near(slow, 0, 0, 0.1, 1)


def test_the_stick_slip_cycle_has_the_period_of_its_closed_form() -> None:
    a = Fraction(1, 2)
    period = 2 * float(a) / 0.2 + 2 * pi - 2 * atan(float(a) / 0.2)
    cycle = find_orbit(STICK_SLIP)
    assert cycle.period == pytest.approx(period, abs=1e-12)
    assert (cycle.word, cycle.stable, cycle.is_rest) == ("S1∘B1", True, False)
    assert cycle.multipliers == (1, 0)
    assert cycle.lyapunov.tolist() == [0.0, -inf]
    assert "1 (of its phase)" in cycle.message
    digits = find_orbit(STICK_SLIP, "S1 B1", digits=30)
    with mpmath.workdps(35):
        exact = 5 + 2 * mpmath.pi - 2 * mpmath.atan(mpmath.mpf(5) / 2)
        assert abs(digits.period - exact) < 1e-28
        assert abs(digits.period - mpmath.mpf("8.9026054078145230110698192169004")) < 1e-28
    slip, stick = cycle.points
    assert slip == pytest.approx((0, 1), abs=1e-12)
    assert stick == pytest.approx((period - 5, 0), abs=1e-12)


def test_the_text_of_a_long_orbit_counts_its_mappings() -> None:
    cycle = find_orbit(STICK_SLIP)
    assert repr(cycle).startswith("<PeriodicOrbit S1∘B1: a stable limit cycle")
    long = replace(cycle, labels=cycle.labels * 500)
    assert repr(long).startswith("<PeriodicOrbit of 1000 mappings: a stable limit cycle")


def test_the_largest_displacement_of_the_cycle() -> None:
    cycle = find_orbit(STICK_SLIP, digits=30)
    t, x, v = cycle.start
    p = STICK_SLIP.replace(belts=[*STICK_SLIP.belts, Belt(0, mu=0)])
    turns = [
        event.x for event in simulate(p, t0=t, x0=x, v0=v, t_end=t + 9, digits=30).events
        if event.boundary == 1 and event.target == "Omega1"
    ]  # fmt: skip
    with mpmath.workdps(40):
        assert abs(turns[0] - mpmath.mpf("1.038516480713450403125071049154")) < 1e-24


@pytest.mark.slow
def test_the_cycle_of_leine_has_its_period() -> None:
    """Numbers of Leine, van Campen, de Kraker and van den Steen 1998, by their closed law."""
    belt = Belt.from_function("1/5", lambda w: 1 / (1 + 3 * w), "1.5", 256)
    cycle = orbit_near(Oscillator(**FREE, belts=[belt]), 0, 1.13394467, 0)
    assert abs(cycle.period - 12.0010312948305786) < 3e-5
    assert cycle.word == "S1∘B1"


@pytest.mark.slow
def test_an_unstable_cycle_is_born_at_a_corner() -> None:
    cycle = find_orbit(TWO_BANDS, guess=(0, 1, 2))
    t = np.linspace(0, float(cycle.period), 20_001)
    assert cycle.period == pytest.approx(6.303840144088753120778267, abs=1e-12)
    assert max(abs(value) for value in cycle.multipliers) == pytest.approx(1.34838658643, abs=1e-10)
    assert float(cycle(t)[1].max()) == pytest.approx(2.483621185871505924630344, abs=1e-6)
    assert (cycle.stable, cycle.word, cycle.points) == (False, "", ())
    with pytest.raises(ConvergenceError):
        orbit_near(TWO_BANDS, 0, 0.001, 0.5)


def test_a_rest_and_a_stick_slip_cycle_attract_and_an_unstable_cycle_is_between_them() -> None:
    rest = find_orbit(FALLING, x0="0.7")
    cycle = find_orbit(FALLING, x0=2)
    between = find_orbit(FALLING, guess=(0, 1.5, 0))
    assert (rest.is_rest, rest.stable) == (True, True)
    assert (cycle.word, cycle.stable) == ("S1∘B1", True)
    assert (between.word, between.stable) == ("", False)
    assert confirmed(between, 1e-12) > 1.1
    inside = find_orbit(FALLING, x0=float(between(0.0)[0]) * 0.98, v0=float(between(0.0)[1]) * 0.98)
    assert inside.is_rest
    again = find_orbit(FALLING.replace(v1="1.49"), guess=between)
    assert not again.stable
    assert again.period != between.period


def test_rates_at_a_rest_are_the_roots_of_its_band() -> None:
    rest = find_orbit(FALLING, x0="0.7")
    c = float(
        FALLING.bands[
            [band.below < 0 < band.above for band in FALLING.bands[1:-1]].index(True) + 1
        ].c
    )
    assert rest.lyapunov == pytest.approx([-c / 2] * 2)
    assert rest([0.0, 5.0])[1].tolist() == [0, 0]


@pytest.mark.parametrize("x0", ["0.1", 5])
def test_a_mass_rests_on_a_wall_whatever_the_drive_does(x0: Any) -> None:
    p = Oscillator(m=1, c=0, k=1, B0="0.3", Omega="0.58", belts=[Belt(0, mu="0.5", mu_s="0.8")])
    rest = find_orbit(p, x0=x0)
    assert rest.is_rest
    assert rest.stable is None
    assert float(rest.start[1]) == pytest.approx(float(simulate(p, x0=x0, t_end=400)(400.0)[0]))
    assert "one of every x from -0.5 to 0.5" in rest.message


@pytest.mark.parametrize("mu_s", ["0.77", "0.98"])
def test_static_friction_keeps_the_period_of_the_drive(mu_s: str) -> None:
    orbit = find_orbit(driven(mu_s))
    assert (orbit.word, orbit.periods, orbit.stable) == ("S1∘B1", 1, True)
    assert confirmed(orbit, 1e-11) < 1
    assert orbit.multipliers[1] == 0
    motion = simulate(driven(mu_s), t_end=800)
    late = [event for event in motion.events if event.t > 750]
    period = float(orbit.period)
    first = next(event for event in late if event.kind == "slip")
    slip = orbit.points[orbit.labels.index("B1")]
    assert (first.t - slip.t + period / 2) % period == pytest.approx(period / 2, abs=1e-9)


def test_an_orbit_of_many_periods_closes_and_attracts() -> None:
    belt = Belt("-0.5", mu="0.32", mu_s="0.8")
    law = Oscillator(m="0.51", c="0.04", k="1.67", A0="0.19", B0="0.2", Omega="0.98", belts=[belt])
    orbit = find_orbit(law, x0="1.58", v0="-0.31")
    assert (orbit.periods, orbit.stable) == (45, True)
    turn = 2 * pi / 0.98
    motion = simulate(law, x0="1.58", v0="-0.31", t_end=2000 * turn, accuracy=inf)
    last = motion(turn * np.array([2000, 1955, 1985]))
    assert last[:, 0] == pytest.approx(last[:, 1], abs=1e-8)
    assert abs(last[:, 0] - last[:, 2]).max() > 1e-3  # not 15 periods


@pytest.mark.slow
def test_chaos_is_named_with_its_exponent() -> None:
    with pytest.raises(ConvergenceError, match=r"chaotic, with the exponent 0\.0[12]"):
        find_orbit(driven("1.26"))


@pytest.mark.parametrize("periods", [1, 2])
def test_unstable_orbits_in_chaos_are_those_of_the_oracle(periods: int) -> None:
    p = driven("1.26")
    motion = simulate(p, t_end="300T")
    turn = 2 * pi / 1.4
    times = turn * np.arange(50, 290)
    states = motion(times).T
    distances = np.abs(states[periods:] - states[:-periods]).max(axis=1)
    n = int(distances.argmin())
    orbit = orbit_near(p, times[n], *states[n].tolist(), periods)
    assert orbit.stable is False
    assert confirmed(orbit, 1e-10) > 1
    digits = orbit_near(p, *map(float, orbit.start), orbit.periods, 30)
    assert confirmed(digits, 1e-28) > 1


def test_three_belts_and_no_belt() -> None:
    orbit = find_orbit(THREE)
    assert orbit.labels == ("A3", "D32", "D21", "B1", "U12", "U23")
    assert confirmed(orbit, 1e-11) < 1
    assert np.allclose(find_orbit(THREE, orbit.word).points, orbit.points, rtol=0, atol=1e-9)
    far = Oscillator(**DRIVEN, belts=[Belt(30, mu="0.7", mu_s=1)])
    steady = find_orbit(far, x0=1)
    assert (steady.word, steady.stable, steady.periods) == ("", True, 1)
    determinant = abs(steady.multipliers[0] * steady.multipliers[1])
    assert determinant == pytest.approx(exp(-0.05 * float(steady.period)), rel=1e-12)


def test_a_motion_without_damping_and_belts_is_marginal() -> None:
    cycle = find_orbit(STICK_SLIP, x0="0.5", v0="0.1")
    assert cycle.stable is None
    assert cycle.period == pytest.approx(2 * pi, abs=1e-12)
    assert find_orbit(STICK_SLIP, x0="0.5").is_rest


@pytest.mark.parametrize("k", ["1.33", "1.32999", "1.4", "1.2"])
def test_an_undamped_motion_settles_to_the_circle_that_touches_its_belt(k: str) -> None:
    """A slip begins without a force, so the flight comes back without one: nothing decides in
    doubles whether the mass sticks there, and the orbit must not depend on rounding.
    """
    law = Oscillator(m="1.77", c=0, k=k, A0="0.56", belts=[Belt("0.7", mu="0.47")])
    cycle = find_orbit(law, x0="-0.56", v0="-1.91")
    assert (cycle.word, cycle.points, cycle.stable) == ("", (), None)
    assert cycle.multipliers == pytest.approx((1, 1), abs=1e-12)
    assert cycle.period == pytest.approx(2 * pi * (1.77 / float(k)) ** 0.5, rel=1e-9)
    assert cycle.grazing_distance < 1e-11
    with pytest.raises(BranchError, match="one of a family, and others lie beside it"):
        continue_orbit(law, None, "k", ("1.1", "1.5"), cycle)
    static = law.replace(mu_s1="0.6")
    assert find_orbit(static, x0="-0.56", v0="-1.91").word == "S1∘B1"


def test_the_paper_with_a_start_and_without_a_drive() -> None:
    p = load_scene("fig9").parameters
    assert np.allclose(find_orbit(p, x0=3).points, find_orbit(p).points, rtol=0, atol=1e-12)
    rest = find_orbit(p.replace(B0=0))
    assert rest.is_rest
    assert simulate(p.replace(B0=0), t_end=60)(60.0)[0] == pytest.approx(float(rest.start[1]))
    assert find_orbit(p.replace(c=0), x0=1).word == "P32"


def test_a_scene_starts_where_it_does() -> None:
    scene = Scene("mine", FALLING, t0=0, x0=2, v0=0, t_end=1)
    assert find_orbit(scene).word == "S1∘B1"
    assert find_orbit(scene, x0="0.7").is_rest


@pytest.mark.slow
def test_derivatives_are_those_of_neighbouring_orbits() -> None:
    for p in (STICK_SLIP, driven("0.98")):
        orbit = find_orbit(p)
        names = ("v1", "mu_s1", *(("Omega",) if p.B0 else ()))
        changes = orbit.sensitivities(names)
        for column, name in enumerate(names):
            h = Fraction(1, 10**6)
            value = p.numbers()[name]
            up, down = (
                find_orbit(p.replace(**{name: value + sign * h}), orbit.word, orbit, 30)
                for sign in (1, -1)
            )
            for i in range(len(orbit.points)):
                slopes = [
                    float(a - b) / 2e-6 for a, b in zip(up.points[i], down.points[i], strict=True)
                ]
                own = [changes.dt[i, column], changes.dx[i, column]]
                assert own == pytest.approx(slopes, abs=1e-8)
            slope = complex(up.multipliers[0] - down.multipliers[0]) / 2e-6
            assert complex(changes.dmultipliers[0, column]) == pytest.approx(slope, abs=1e-7)


def test_a_start_approaches_the_orbit() -> None:
    scene = Scene("mine", STICK_SLIP, t0=0, x0=0, v0=0, t_end=1)
    assert find_orbit(scene).approach(scene).periods in (1, 2)
    scene = Scene("mine", driven("0.98"), t0=0, x0=0, v0=0, t_end=1)
    approach = find_orbit(scene).approach(scene)
    assert approach.periods is not None
    assert approach.periods > 10


@pytest.mark.slow
def test_orbits_are_drawn_and_printed(tmp_path: Any, monkeypatch: Any) -> None:
    for orbit in (
        find_orbit(STICK_SLIP), find_orbit(FALLING, x0="0.7"), find_orbit(THREE),
        find_orbit(TWO_BANDS, guess=(0, 1, 2)),
    ):  # fmt: skip
        assert plot.orbit_figure(orbit).axes
        assert orbit._repr_html_()
        assert orbit._repr_latex_()
        assert orbit.as_dict()["is_rest"] == orbit.is_rest
        assert len(repr(orbit)) < 4000
    monkeypatch.chdir(tmp_path)
    scene = Scene("mine", STICK_SLIP, t0=0, x0=0, v0=0, t_end=1)
    (tmp_path / "mine.toml").write_text(as_toml(scene) + "\n", encoding="utf-8")
    for options in ([], ["--digits", "20"], ["--json"], ["-o", "orbit.svg"]):
        ended = run("orbit", "mine.toml", *options)
        assert ended.exit_code == 0, ended.stderr
    assert "8.9026" in run("orbit", "mine.toml").stdout


@pytest.mark.parametrize(
    ("call", "error", "part"),
    [
        (lambda: find_orbit(STICK_SLIP, periods=2), ParameterError, "periods requires a word"),
        (lambda: find_orbit(STICK_SLIP, "S1 B1", x0=2), ParameterError, "without them x0 starts"),
        (lambda: find_orbit(STICK_SLIP, guess=(0, 1)), ParameterError, "be an orbit, or a state (t,"),
        (lambda: find_orbit(FALLING, guess=(0, 1e9, 0)), ParameterError, "guess = (0, 1000000000.0"),
        (lambda: find_orbit(STICK_SLIP, "P32"), ConvergenceError, "P32 is B1∘A1 here"),
        (lambda: find_orbit(STICK_SLIP, "S2 B2"), WordError, "belt 2, and there is one belt"),
        (lambda: find_orbit(THREE, "S4 B4"), WordError, "belt 4, and there are 3 belts"),
        (lambda: find_orbit(FALLING, "S1 B1", (0, 1.5, 0)), ConvergenceError, "leads to the orbit"),
        (lambda: find_orbit(STICK_SLIP, "A1 B1"), ConvergenceError, "give a guess"),
        (lambda: find_orbit(STICK_SLIP.replace(k=0)), ParameterError, "without a spring"),
        (lambda: find_orbit(STICK_SLIP).equations(), ParameterError, "static friction of belt 1"),
        (lambda: find_orbit(STICK_SLIP).sensitivities("v2"), ParameterError, "must be different"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_in_one_line(call: Any, error: Any, part: str) -> None:
    with pytest.raises(error) as refused:
        call()
    assert part in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("V", [0.2, 0.549])
def test_how_far_a_slip_would_pass_the_belt_is_how_far_it_is_from_grazing(V: float) -> None:
    """The slip of the damped cycle by scipy, as if there were no belt where it arrives."""
    law = Oscillator(m=1, c="1/10", k=1, belts=[Belt(str(V), mu="1/2", mu_s=1)])
    cycle = find_orbit(law, x0=2)
    slip = solve_ivp(
        lambda t, y: [y[1], 0.5 - 0.1 * y[1] - y[0]], (0, 9), [1 - 0.1 * V, V],
        rtol=1e-12, atol=1e-13, dense_output=True,
    )  # fmt: skip
    speeds = slip.sol(np.linspace(3, 9, 60_001))[1]
    lowest = slip.sol(np.linspace(0, 5, 50_001))[1].min()
    expected = min(speeds.max() - V, V - lowest)
    assert cycle.grazing_distance == pytest.approx(expected, abs=1e-8)
