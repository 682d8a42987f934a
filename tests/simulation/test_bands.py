"""Motions through the bands of friction curves: dense output, forces, summaries, words, rests."""

from __future__ import annotations

from fractions import Fraction
from math import inf
from typing import Any

import numpy as np
import pytest
from law_oracle import LawBelt, follow
from scipy.integrate import solve_ivp

from symosc import Belt, Oscillator, simulate, simulate_many
from symosc.engine.arithmetic import many_digits, rows_in_doubles
from symosc.kernels.entire import basis

LAW: dict[str, Any] = {"m": 1, "c": "1/5", "k": 1, "B0": 1, "Omega": 1}
#: The speeds of its edges: -3, -1, 2 (the belt), 5, 7.
FALLING = Belt(2, curve=[(0, 1), (3, "1/2"), (5, "2/5")], mu_s="6/5")


#: t0, x0, v0 of a motion that misses the speed 2/5 of a belt by 1e-18.
NEAR_TOUCH = (
    "6.34082617218144006126323449676026039295973851508700970521907",
    "-0.0427380582497395561956936006906575845624930606830406885332805",
    "0.399137439376410884170319355593146261504654155364551952323288",
)


def coefficient(w: float) -> float:
    return float(np.interp(w, [0, 3, 5], [1, 0.5, 0.4]))


def pull(v: float) -> float:
    """Return the friction of FALLING, which drags towards the speed 2."""
    return -np.sign(v - 2) * coefficient(abs(v - 2))


def test_dense_output_agrees_with_an_integrator_across_corners() -> None:
    """Up to the first contact with the belt no event comes, but three corners are crossed."""
    oscillator = Oscillator(**LAW, belts=[FALLING])
    motion = simulate(oscillator, x0=6, v0=-1, t_end=30)
    end = motion.events[0].t
    assert {event.boundary for event in motion.events} == {1}
    solved = solve_ivp(
        lambda t, y: [y[1], np.cos(t) - 0.2 * y[1] - y[0] + pull(y[1])],
        (0, end), [6, -1], rtol=1e-12, atol=1e-12, max_step=0.005, dense_output=True,
    )  # fmt: skip
    times = np.linspace(0, end * 0.999, 300)
    assert np.ptp(np.digitize(motion(times)[1], [-3, -1])) == 2
    # a step of 0.005 across a corner leaves an error of about its third power
    assert np.abs(motion(times) - solved.sol(times)).max() < 1e-7
    assert motion(times.tolist()[7]) == pytest.approx(motion(times)[:, 7], rel=1e-14)


def test_forces_are_those_of_the_band_beside_the_belt_or_of_the_velocity() -> None:
    oscillator = Oscillator(**LAW, belts=[FALLING])
    motion = simulate(oscillator, x0=6, v0=-1, t_end=30)
    times = np.linspace(0, 30, 400)
    x, v = motion(times)
    rest = np.cos(times) - 0.2 * v - x
    below = v <= 2
    expected = rest + np.array([coefficient(abs(speed - 2)) for speed in v])
    assert motion.force(1, times)[below] == pytest.approx(expected[below], abs=1e-12)
    # above the belt the line beside it goes on: 1 + (v - 2)/6
    expected = rest + 1 + (v - 2) / 6
    assert motion.force(1, times)[~below] == pytest.approx(expected[~below], abs=1e-12)
    with pytest.raises(ValueError, match="alpha = 3"):
        motion.force(3, 1)


def test_words_do_not_change_when_a_curve_is_refined() -> None:
    """Points on the lines are no corners, and words know of belts only."""
    coarse = [(0, 1), (3, Fraction(1, 2)), (5, Fraction(2, 5))]
    fine = [(w, 1 - Fraction(w) / 6) for w in range(4)] + [(4, Fraction(9, 20)), coarse[-1]]
    laws = [Oscillator(**LAW, belts=[Belt(2, curve=curve)]) for curve in (coarse, fine)]
    assert laws[0].edges == laws[1].edges
    motions = [simulate(law, x0=6, v0=-1, t_end=60) for law in laws]
    assert motions[0].events == motions[1].events
    assert len(motions[0].word) > 20
    smooth = Belt.from_function(2, lambda w: 1 / (1 + w), 9, pieces=8)
    smoother = Belt.from_function(2, lambda w: 1 / (1 + w), 9, pieces=64)
    words = [
        simulate(Oscillator(**LAW, belts=[belt]), t_end=60).word for belt in (smooth, smoother)
    ]
    assert words[0] == words[1]


def test_summaries_are_those_of_the_motion() -> None:
    oscillator = Oscillator(**LAW, belts=[FALLING, Belt(4, mu="1/5")])
    starts = np.column_stack([np.zeros(30), np.linspace(-6, 6, 30), np.linspace(-4, 6, 30)])
    summary = simulate_many(oscillator, starts, 80, record="summary", use_numba=False)
    times = np.linspace(0, 80, 80_001)
    for n in (0, 11, 29):
        motion = simulate(oscillator, x0=float(starts[n, 1]), v0=float(starts[n, 2]), t_end=80)
        x, v = motion(times)
        for name, value in (
            ("x_min", x.min()),
            ("x_max", x.max()),
            ("v_min", v.min()),
            ("v_max", v.max()),
        ):
            assert summary.columns()[name][n] == pytest.approx(value, abs=1e-5)
        assert summary.events[n] == len(motion.events)
        assert summary.mode[n] == motion.mode(80)
        assert summary.section[n, -1] == pytest.approx(motion(2 * np.pi * 12), abs=1e-9)


@pytest.mark.compiled("pairs")
def test_double_double_numbers_follow_a_motion_from_band_to_band() -> None:
    """No double is accurate to 1e-17, so each event is found in pairs: to its last bit."""
    pytest.importorskip("numba")
    oscillator = Oscillator(**LAW, belts=[FALLING, Belt(4, mu="1/5")])
    # The second starts on the corner at the speed -1.
    starts = [(0, 6, -1), (0, "-3/2", -1), (0, 1, "9/2")]
    rough = simulate_many(oscillator, starts, 60, accuracy=1e-17)
    pairs = simulate_many(oscillator, starts, 60, accuracy=1e-17, use_numba=True)
    assert len(pairs) > 60
    assert np.abs(pairs.t - rough.t).max() <= 2**-52 * 60
    for n, (t0, x0, v0) in enumerate(starts):
        known = simulate(oscillator, t0=t0, x0=x0, v0=v0, t_end=60, digits=30).events
        assert pairs.kind[pairs.trajectory == n].tolist() == [event.kind for event in known]
        for name, values in (("t", pairs.t), ("x", pairs.x)):
            expected = np.array([float(getattr(event, name)) for event in known])
            assert np.abs(values[pairs.trajectory == n] - expected).max() <= 2**-52 * 60
    summaries = [
        simulate_many(oscillator, starts, 60, record="summary", use_numba=True, accuracy=accuracy)
        for accuracy in (1e-17, None)
    ]
    for name, column in summaries[0].columns().items():
        in_doubles = summaries[1].columns()[name]
        if column.dtype.kind == "f":
            assert column == pytest.approx(in_doubles, rel=1e-11, abs=1e-11), name
        else:
            assert (column == in_doubles).all(), name


def test_a_motion_that_dies_away_on_a_corner_comes_to_rest() -> None:
    """The belt's corner has the speed 0: every swing crosses it twice, until nothing is left."""
    law = Oscillator(m=1, c="1/5", k=1, belts=[Belt(2, curve=[(0, 1), (2, "4/5"), (5, "9/10")])])
    assert 0 in [edge.v for edge in law.edges]
    for digits in (None, 25):
        motion = simulate(law, x0="2", v0="-1/2", t_end=1000, digits=digits)
        assert motion.status == "equilibrium"
        x, v = motion(999)
        assert (x, v) == pytest.approx((0.8, 0), abs=1e-12)
    exactly = simulate(law, x0="4/5", v0=0, t_end=1000)
    assert (exactly.status, len(exactly.events)) == ("equilibrium", 0)


def test_a_motion_dies_away_on_a_corner_with_a_growing_side_if_it_shrinks_more_on_the_other() -> (
    None
):
    """In a turn it shrinks by exp(-pi (c_1/w_1 + c_2/w_2)), where w_j = sqrt(4 m k - c_j^2)."""

    def law(below: str, c: str = "1/4") -> Oscillator:
        belt = Belt("23/10", curve=[(0, "9/10"), ("23/10", "7/5"), ("46/10", below)])
        return Oscillator(m=2, c=c, k="12/5", A0="2/7", belts=[belt])

    start: dict[str, Any] = {"x0": "71/100", "v0": 0, "t_end": 20_000, "accuracy": inf}
    motion = simulate(law("2/5"), **start)
    c = [float(law("2/5").bands[n].c) for n in (1, 2)]
    assert motion.status == "equilibrium"
    centre = (2 / 7 + 7 / 5) / 2.4
    assert motion(19_999) == pytest.approx([centre, 0], abs=1e-12)
    assert max(c) > 0 > min(c)
    rates = [np.sqrt(4 * 2 * 2.4 - value**2) for value in c]
    turn = 2 * np.pi * 2 * (1 / rates[0] + 1 / rates[1])
    shrinking = np.exp(-np.pi * (c[0] / rates[0] + c[1] / rates[1]))
    first, later = motion([0, 10 * turn])[0] - centre
    assert later / first == pytest.approx(shrinking**10, rel=1e-9)
    # Where it grows more than it shrinks, it leaves.
    growing = simulate(law("1/10", c="1/10"), **(start | {"t_end": 500}))
    assert len(growing.events) > 10
    assert growing.status == "t_end"


def test_a_mass_at_rest_in_a_growing_band_stays_however_long() -> None:
    """What would grow from there by exp(7000) is 0."""
    belt = Belt(2, curve=[(0, "3/5"), (2, "19/10"), (4, 0)], slope="2/5")
    law = Oscillator(m="9/5", c="7/10", k="2/5", A0="-6/7", belts=[belt])
    motion = simulate(law, x0="73/28", t_end=100_000)
    assert motion([99_999.0, 100_000.0]).tolist() == motion([0.0, 1.0]).tolist()
    assert motion(99_999).tolist() == [73 / 28, 0.0]


def test_the_band_behind_a_touch_that_more_digits_decide_is_not_lost() -> None:
    """The mass misses the belt by 1e-18 of its speed, then falls through the corner at v = 0.32."""
    belt = Belt("2/5", curve=[(0, "2/25"), ("2/25", "2/25")], slope="1/10")
    numbers: dict[str, Any] = {"m": "62/25", "c": "111/250", "k": "243/50", "B0": "-257/5000"}
    law = Oscillator(**numbers, Omega="97/100", FN="7/5", belts=[belt])
    start: dict[str, Any] = {
        "t0": Fraction(NEAR_TOUCH[0]), "x0": Fraction(NEAR_TOUCH[1]), "v0": Fraction(NEAR_TOUCH[2]),
    }  # fmt: skip
    end = start["t0"] + 30
    rough = simulate(law, **start, t_end=end)
    exact = simulate(law, **start, t_end=end, digits=40)
    assert len(rough.events) == len(exact.events) == 0
    times = np.linspace(float(rough.t_start), float(end), 50)
    assert np.abs(rough(times) - exact(times)).max() < 1e-12
    solved = solve_ivp(
        lambda t, y: [y[1], (-257 / 5000 * np.cos(0.97 * t) - 0.444 * y[1] - 4.86 * y[0]
            + 1.4 * (0.08 + 0.1 * max(0.0, 0.32 - y[1]))) / 2.48],
        times[[0, -1]], [float(start["x0"]), float(start["v0"])], rtol=1e-11, atol=1e-13, t_eval=times,
    )  # fmt: skip
    assert np.abs(rough(times) - solved.y).max() < 1e-8


def test_a_growing_band_is_left() -> None:
    """Its equilibrium is unstable: from beside it the mass swings out until it meets the belt."""
    curve = ((0, 1), ("3/2", "2/5"))
    law = Oscillator(m=1, c="1/10", k=1, belts=[Belt("1/2", curve=curve)])
    assert not law.contracts
    start: dict[str, Any] = {"x0": "4/5", "v0": "1/1000000", "t_end": 150}
    motion = simulate(law, **start, max_events=12)
    run = follow(
        m=1, c="1/10", k=1, A0=0, B0=0, Omega=None, FN=1, t0=0, **start, max_events=12,
        belts=[LawBelt("1/2", None, None, curve, 0)], digits=40,
    )  # fmt: skip
    assert len(motion.events) == 12
    for event, expected in zip(motion.events, run.events, strict=True):
        assert (event.kind, event.source, event.target) == (
            expected.kind, expected.source, expected.target,
        )  # fmt: skip
        assert event.t == pytest.approx(float(expected.t), abs=5 * event.t_error)
    for digits in (None, 30):
        exactly = simulate(law, x0="4/5", v0=0, t_end=150, digits=digits)
        assert (exactly.status, len(exactly.events)) == ("equilibrium", 0)
        assert tuple(exactly(149)) == pytest.approx((0.8, 0), abs=1e-12)


@pytest.mark.parametrize("digits", [30, 60])
def test_closed_forms_of_growing_bands_have_all_digits(digits: int) -> None:
    """The entire functions in doubles against those of many digits, for either sign of h."""
    for c, k in ((-3, 2), (-2, 1), ("-1/100", 4), (-3, 0), (-4, 4), ("-2000001/1000000", 1)):
        belt = Belt(0, curve=[(0, 10), (1, 10 + Fraction(c))])
        law = Oscillator(m=1, c=0, k=k, B0=1, Omega=2, belts=[belt])
        row = next(n for n, band in enumerate(law.bands) if band.c == Fraction(c))
        K = rows_in_doubles(law)[row]
        exact = many_digits(law, digits, row)
        # a search may go on for 5/8 of a chunk more, where the series is not used any more
        for tau in (1e-6, 0.01, 0.2, K.chunk, 1.6 * K.chunk):
            own = basis(tau, K)
            right = exact.namespace["basis"](exact.context.mpf(tau), exact.K)
            for value, true in zip(own, right, strict=True):
                assert abs(value - true) <= 4e-15 * max(abs(true), abs(tau) ** 3)
