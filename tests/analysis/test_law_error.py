"""The error of laws of straight pieces: against known digits and integrations of the smooth law."""

from __future__ import annotations

from math import cos, exp, isnan
from typing import Any

import pytest
from scipy.integrate import solve_ivp

from symosc import Belt, Oscillator, ParameterError, Scene, law_error

#: The cycle of Leine, van Campen, de Kraker and van den Steen (1998), computed elsewhere.
PERIOD = 12.0010312948305786469
FARTHEST = 1.13394467644165683998
#: The relative speed at which the mass turns there.
TURNS = 1.0399022893


def falling(w: float) -> float:
    return 1 / (1 + 3 * w)


def leine(pieces: int, until: Any = (0.2, TURNS)) -> Scene:
    """Return the motion from the end of a stick; at the transparent belt the mass turns."""
    belts = [Belt(0, 0), Belt.from_function("1/5", falling, until, pieces)]
    return Scene("leine", Oscillator(m=1, c=0, k=1, belts=belts), 0, 1, "1/5", 13)


def test_the_known_digits_of_leines_cycle() -> None:
    for name, known, off in (("x[0]", FARTHEST, 2e-12), ("t[3]", PERIOD, 2e-11)):
        found = law_error(leine, name, 8, doublings=4)
        assert found.pieces == (8, 16, 32, 64, 128)
        assert found.order == pytest.approx(2, abs=0.01)
        assert abs(found.extrapolated - known) < off
        assert abs(found.extrapolated - known) < found.uncertainty < 1e-9
        assert found.error == found.values[0] - found.extrapolated
        assert abs(found.error - (found.values[0] - known)) < off


def test_pieces_that_do_not_end_where_the_motion_turns() -> None:
    """What is left after the first extrapolation is larger, and said."""
    found = law_error(lambda n: leine(n, "3/2"), "x[0]", 32)
    assert abs(found.extrapolated - FARTHEST) < found.uncertainty < 1e-6
    assert abs(found.error) > 1e-5
    with pytest.raises(ParameterError, match=r"pieces = 32: the errors do not fall as 1/n\^2"):
        law_error(lambda n: leine(n, "3/2"), "t[3]", 32)


def test_a_driven_motion_against_the_smooth_law() -> None:
    """Through a stick and a slip; the smooth law is integrated by scipy."""
    scene_of = lambda n: Scene(  # noqa: E731
        "made",
        Oscillator(
            m=1, c="1/10", k=1, B0="1/2", Omega="13/10",
            belts=[Belt.from_function(0, stribeck, [2], n)],
        ),
        0, "3/2", 0, 12,
    )  # fmt: skip

    def stribeck(w: float) -> float:
        return 0.15 + 0.1 * exp(-w / 0.4)

    def rates(t: float, y: Any, side: float) -> list[float]:
        friction = side * (0.15 + 0.1 * exp(-abs(y[1]) / 0.4))
        return [y[1], 0.5 * cos(1.3 * t) - 0.1 * y[1] - y[0] - friction]

    def turns(t: float, y: Any, side: float) -> float:
        return float(y[1])

    turns.terminal = True  # type: ignore[attr-defined]
    begin, state, side = 0.0, [1.5, 0.0], -1.0
    times = []
    for _ in range(3):
        turns.direction = -side  # type: ignore[attr-defined]
        run = solve_ivp(
            rates, (begin, 20), state, "DOP853", events=turns, args=(side,), rtol=1e-12, atol=1e-13
        )  # fmt: skip
        begin = float(run.t[-1])
        state = [float(run.y[0, -1]), 0.0]
        times.append(begin)
        # The mass turns at once where more force is needed to hold it than friction has.
        assert abs(0.5 * cos(1.3 * begin) - state[0]) > 0.25
        side = -side
    for number, exact in enumerate(times):
        found = law_error(scene_of, f"t[{number}]", 16)
        assert abs(found.extrapolated - exact) < found.uncertainty + 1e-10
        assert found.uncertainty < 1e-5
        assert abs(found.error) > 3 * found.uncertainty


def test_series_with_known_limits() -> None:
    """Columns of the table go on as long as the order is seen."""
    regular = law_error(lambda n: n, lambda n: 1 + 3 / n**2 - 5 / n**4 + 2 / n**6, 4, doublings=5)
    assert abs(regular.extrapolated - 1) < 1e-12
    half = law_error(lambda n: n, lambda n: 1 + 3 / n**2 + 1 / n**2.5, 64)
    assert 1e-8 < abs(half.extrapolated - 1) < half.uncertainty < 1e-4
    constant = law_error(lambda n: n, lambda n: 7.0)
    assert (constant.extrapolated, constant.error) == (7.0, 0.0)
    assert isnan(constant.order)
    for wrong in (
        lambda n: 1 / n,
        lambda n: n,
        lambda n: (-1.0) ** (n // 8),
        lambda n: 2.0**-n,
    ):
        with pytest.raises(ParameterError, match="do not fall as"):
            law_error(lambda n: n, wrong, 8)


def test_what_is_wrong_is_one_sentence() -> None:
    for law, quantity, message in (
        (leine, "t[99]", r"there are \d events"),
        (leine, "speed", "must be a function, one of period, x_min"),
        (lambda n: leine(n).parameters, "t[1]", "law must return a Scene"),
        (lambda n: n, "period", "must return an Oscillator or a Scene"),
        (lambda n: 1 / 0, "period", "fails with 64 pieces: ZeroDivisionError"),
        (leine, lambda scene: "x", "must return a finite number"),
    ):
        with pytest.raises(ParameterError, match=message) as refusal:
            law_error(law, quantity)
        assert "\n" not in str(refusal.value)
    for until in ([], [1, 1], [0, 1], [-1]):
        with pytest.raises(ParameterError, match="until"):
            Belt.from_function(0, falling, until)


def test_pieces_between_several_speeds() -> None:
    belt = Belt.from_function(0, falling, ["1/2", 2], 4)
    speeds = [w for w, _ in belt.curve]
    assert len(speeds) == 9
    assert [float(speeds[n]) for n in (0, 2, 4, 6, 8)] == [0, 0.25, 0.5, 1.25, 2]
    assert all(float(mu) == falling(float(w)) for w, mu in belt.curve)
