"""Every way in which Newton's methods, and steps along a curve, give up: each says why, and at once."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

from symosc import find_orbit, load_scene
from symosc.orbits import newton
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.curve import Curve
from symosc.orbits.newton import MOST_LINEAR, Solution, polish, solve
from symosc.words import read_word

FIG9 = load_scene("fig9").parameters
ORBIT = find_orbit(FIG9, "P32")


class Numbers:
    context = mpmath.MPContext()


class OnePiece:
    """Equations of one piece: f1(x) = 0 and theta = 0."""

    arithmetic = Numbers()

    def __init__(self, f: Any, slope: Any) -> None:
        self.f, self.slope = f, slope

    def residuals(self, points: Any) -> list[Any]:
        return [self.f(points[0][0]), points[0][1]]

    def blocks(self, points: Any) -> list[Any]:
        return [((self.slope(points[0][0]), 0, 0, 0), (0, 1, 0, 0))]

    def largest_residual(self, points: Any) -> Any:
        return max(map(abs, self.residuals(points)))


def polished(f: Any, slope: Any) -> Solution:
    with mpmath.workdps(15):
        OnePiece.arithmetic.context.dps = 30
        return polish(OnePiece(f, slope), [(1, 0)])  # type: ignore[arg-type]


def test_polishing_says_why_it_stops() -> None:
    root = polished(lambda x: x * x - 2, lambda x: 2 * x)
    assert root.converged
    assert abs(root.points[0][0] - mpmath.mpf(2) ** 0.5) < 1e-15
    singular = polished(lambda x: x * x + 1, lambda x: 0 * x)
    assert (singular.converged, singular.reason) == (False, "the Jacobian became singular")
    far = polished(lambda x: x - 1 + 1e-9, lambda x: x * 1e-12)
    assert (far.converged, far.reason, far.steps) == (False, "the corrections grow in more digits", 1)
    overflow = polished(lambda x: x * mpmath.inf, lambda x: x)
    assert (overflow.converged, overflow.reason, overflow.steps) == (False, "the corrections grow in more digits", 1)
    double = polished(lambda x: x * x, lambda x: 2 * x)
    assert (double.converged, double.reason) == (False, "a multiple root")
    assert double.steps <= MOST_LINEAR + 2


def test_a_step_that_never_helps_is_not_halved_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    equations, calls = ORBIT.equations(), []

    def residuals(points: Any) -> list[float]:
        calls.append(points)
        return [1.0 if len(calls) == 1 else 2.0] * 4

    monkeypatch.setattr(equations, "residuals", residuals)
    found = newton.newton(equations, ORBIT.phases())
    assert (found.converged, found.reason) == (False, "no step brings it nearer to a solution")
    assert len(calls) < 25


@pytest.mark.parametrize("error", [ZeroDivisionError(), ValueError()])
def test_more_digits_that_fail_leave_the_first_answer(error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    first = Solution(ORBIT.phases(), 1e-12, 3, False, "no step brings it nearer to a solution")

    def fails(*_: Any) -> Solution:
        raise error

    monkeypatch.setattr(newton, "newton", lambda *_: first)
    monkeypatch.setattr(newton, "polish", fails)
    assert solve(ORBIT.equations(), ORBIT.phases()) is first


# --- along a curve ---


def curve() -> Curve:
    return Curve(ORBIT, "Omega", 3.0, 5.0)


def test_a_correction_that_is_no_number_ends_it_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    along, calls = curve(), []
    first = along.first(1.0)

    def nothing(z: np.ndarray, slope: Any = None) -> tuple[np.ndarray, np.ndarray]:
        calls.append(z)
        return np.full(4, np.nan), np.eye(4, 5)

    monkeypatch.setattr(along, "linearised", nothing)
    assert along.correct(along.of(first), first.tangent) is None
    assert len(calls) == 1


@pytest.mark.parametrize("factor", [0.1, 0.5, 1.0, 2.0, 50.0])
def test_no_flight_loses_more_than_its_part(factor: float) -> None:
    """A step that would shorten a flight by more is cut to just that part; any other is taken whole."""
    equations, rng = ClosingEquations(FIG9, read_word("P32"), 1), np.random.default_rng(3)
    points = np.array([[x, float(FIG9.Omega) * t] for t, x in ORBIT.points])
    durations = equations.durations(points)
    for _ in range(20):
        step = factor * rng.uniform(-1, 1, points.shape)
        part = newton._longest(equations, points, step)
        assert 0 < part <= 1
        left = equations.durations(points + part * step) / durations
        assert left.min() >= 1 - newton.SHORTEN - 1e-9
        if part < 1:
            assert left.min() == pytest.approx(1 - newton.SHORTEN, abs=1e-9)
            assert equations.durations(points + step).min() < durations.min()
