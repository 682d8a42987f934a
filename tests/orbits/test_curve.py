"""Steps along a curve of orbits: where there is no point."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from symosc import ParameterError, find_orbit, load_scene
from symosc.orbits import curve as curves
from symosc.orbits.curve import CORRECTIONS, DIFFERENCE, Curve

FIG9 = load_scene("fig9").parameters

ORBIT = find_orbit(FIG9, "P32")


def curve() -> Curve:
    return Curve(ORBIT, "Omega", 3.0, 5.0)


@pytest.mark.parametrize(("distance", "found"), [(0.5, True), (1.5, False)])
def test_a_root_that_is_far_off_is_another_one(distance: float, found: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    along = curve()
    first = along.first(1.0)
    begin, normal = along.of(first), np.append(np.zeros(4), 1.0)
    target = begin + distance * np.array([0, 1.0, 0, 0, 0])
    monkeypatch.setattr(along, "linearised", lambda z, slope=None: ((z - target)[:4], np.eye(4, 5)))
    corrected = along.correct(begin, normal)
    assert (corrected is not None) is found
    if corrected is not None:
        assert corrected == pytest.approx(target)


def test_corrections_that_do_not_get_smaller_are_no_point(monkeypatch: pytest.MonkeyPatch) -> None:
    along, calls = curve(), []
    first = along.first(1.0)

    def forth_and_back(z: np.ndarray, slope: Any = None) -> tuple[np.ndarray, np.ndarray]:
        calls.append(z)
        return np.array([0, 0.3 * (-1) ** len(calls), 0, 0]), np.eye(4, 5)

    monkeypatch.setattr(along, "linearised", forth_and_back)
    assert along.correct(along.of(first), np.append(np.zeros(4), 1.0)) is None
    assert len(calls) == CORRECTIONS


@pytest.mark.parametrize("error", [np.linalg.LinAlgError(), ParameterError("k", 0, "must be > 0"), ZeroDivisionError()])
def test_what_cannot_be_evaluated_is_no_point(error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    """A parameter out of its range, a piece without length, a singular matrix."""
    along = curve()
    first = along.first(1.0)

    def fails(*_: Any, **__: Any) -> Any:
        raise error

    monkeypatch.setattr(along, "linearised", fails)
    assert along.correct(along.of(first), first.tangent) is None
    assert along.accepted(along.of(first), first) is None


def test_differences_by_the_parameter_stay_in_the_range(monkeypatch: pytest.MonkeyPatch) -> None:
    """On both sides where there is room, to the last step that fits; else on one. Either way it is the derivative."""
    along = Curve(ORBIT, "mu1", 0.0, 1.0)
    along.scale[:] = 1.0
    change, points, asked = DIFFERENCE, np.zeros((2, 2)), []

    class Linear:
        def __init__(self, value: float) -> None:
            asked.append(value)
            self.value = value

        def residuals(self, points: np.ndarray) -> list[float]:
            return [3.0 * self.value, -self.value]

    monkeypatch.setattr(along, "equations", Linear)
    for value, expected in [
        (0.5, (0.5 + change, 0.5 - change)),
        (change, (2 * change, 0.0)),
        (0.0, (change, 0.0)),
        (1.0, (1.0, 1.0 - change)),
        (1.0 - change, (1.0, 1.0 - 2 * change)),
    ]:
        asked.clear()
        assert along.slope(along.joined(points, value)) == pytest.approx([3.0, -1.0], rel=1e-6)
        assert asked == pytest.approx(expected, rel=0, abs=1e-15)
        assert all(0.0 <= each <= 1.0 for each in asked)


@pytest.mark.parametrize(("length", "direction", "beyond", "end"), [(0.02, 1.0, 5.01, 5.0), (0.02, -1.0, 2.9, 3.0)])
def test_a_curve_that_bends_over_the_end_of_the_range_ends_there(
    length: float, direction: float, beyond: float, end: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tangent stays inside, the point that is found from it does not."""
    along = Curve(find_orbit(FIG9.replace(Omega=end - 0.1 * direction), "P32"), "Omega", 3.0, 5.0)
    outside = find_orbit(FIG9.replace(Omega=beyond), "P32")
    points = np.array([(point.t * beyond, point.x) for point in outside.points])[:, ::-1]
    monkeypatch.setattr(along, "correct", lambda *_: along.joined(points, beyond))
    found = along.step(along.first(direction), length)
    assert found is not None
    assert found.value == end
    assert np.abs(along.equations(end).residuals(found.points)).max() < 1e-12


def test_a_curve_is_measured_by_the_spread_of_its_points_or_by_how_far_the_orbit_moves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The larger of both: points that lie close together would make each step of a curve a long one."""
    orbit = find_orbit(FIG9, "P32")
    spread, n = abs(orbit.points[0].x - orbit.points[1].x), 2
    for farthest in (0.0, 0.5 * spread, 2.0 * spread, 100.0 * spread):
        monkeypatch.setattr(curves, "largest_displacement", lambda _, far=farthest: (0.0, far / curves.LEAST_SIZE))
        scale = Curve(orbit, "Omega", 3.0, 4.5).scale
        assert scale == pytest.approx(np.append(np.sqrt(n) * np.array([max(spread, farthest), 1.0] * n), 1.5))
