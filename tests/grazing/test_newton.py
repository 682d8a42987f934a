"""Which solutions on a grazing curve are looked for, and which are taken: on a curve that is a formula.

Newton's method is replaced by one that leads astray unless it begins near the root; the true one is tested by
`test_solve`, whose answers are judged by the flow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import mpmath
import pytest

from symosc.grazing.newton import Candidates, Point


class Formula(Candidates):
    """Candidates on the curve x_i = f(theta_m), with the time of the flight 1 + theta_m/10."""

    def __init__(self, f: Callable[[float], float], root: float = math.nan, near: float = 0.05) -> None:
        self.f, self.root, self.near = f, root, near
        self.name, self.K, self.notes, self.asked = "x_i", SimpleNamespace(rate=1.0), [], []
        self.curve: Any = SimpleNamespace(sample=lambda theta: SimpleNamespace(slope_theta=0.5))
        self.flights: Any = SimpleNamespace(context=mpmath.mp)
        self._broken, self._solutions = set(), []

    def at(self, theta: float) -> Point:
        slope = (self.f(theta + 1e-6) - self.f(theta - 1e-6)) / 2e-6
        return Point(theta, self.f(theta), slope, 1 + theta / 10)

    def _sampled(self, theta_m: float) -> Point | None:
        return self.at(theta_m)

    def _newton(self, theta_m: float, tau: float, target: Any) -> tuple[Any, Any] | None:
        self.asked.append(theta_m)
        found = self.root if abs(theta_m - self.root) < self.near else 5.5
        return mpmath.mpf(found), mpmath.mpf(1 + found / 10)

    @property
    def found(self) -> list[float]:
        return [float(theta) for theta, _ in self._solutions]


@pytest.mark.parametrize("root", [0.31, 1.0, 1.9])
def test_a_root_is_taken_only_between_its_neighbours(root: float) -> None:
    """A Newton method that ends elsewhere is tried again on a shorter stretch, until it ends between the points."""
    curve = Formula(lambda theta: theta**7 - root**7, root)
    curve._between(curve.at(0.0), curve.at(2.0), mpmath.mpf(0))
    assert curve.found == [root]
    assert curve.notes == []
    falling = Formula(lambda theta: root**7 - theta**7, root)
    falling._between(falling.at(0.0), falling.at(2.0), mpmath.mpf(0))
    assert falling.found == [root]


def test_where_newton_never_ends_between_the_curve_is_broken() -> None:
    curve = Formula(lambda theta: theta**3 - 1, math.nan)
    first, last = curve.at(0.0), curve.at(2.0)
    curve._between(first, last, mpmath.mpf(0))
    assert curve.found == []
    assert len(curve.notes) == 1
    assert abs(float(curve.notes[0].split("theta_m = ")[1].split()[0]) - 1) < 1e-9


@pytest.mark.parametrize(("touch", "taken"), [(None, False), (5.5, False), (1.0, True)])
def test_among_touches_too_a_solution_lies_between(touch: float | None, taken: bool) -> None:
    curve = Formula(lambda theta: theta**3 - 1, math.nan)
    curve.curve = SimpleNamespace(sample=lambda theta: SimpleNamespace(slope_theta=1.0))
    found = touch and (mpmath.mpf(touch), mpmath.mpf(1 + touch / 10))
    curve._among_touches = lambda theta_m, target: found  # type: ignore[method-assign, assignment, return-value]
    curve._between(curve.at(0.0), curve.at(2.0), mpmath.mpf(0))
    assert curve.found == ([touch] if taken else [])
    assert bool(curve.notes) is not taken


@pytest.mark.parametrize("turn", [-0.6, 0.0, 0.8])
def test_an_extremum_is_found_to_the_rounding_of_its_value(turn: float) -> None:
    for sign in (1, -1):
        curve = Formula(lambda theta, sign=sign: 3 + sign * (theta - turn) ** 2)
        found = curve._extremum(curve.at(-1.3), curve.at(1.1))
        assert found is not None
        assert abs(found.value - 3) < 3e-15
        assert abs(found.theta_m - turn) < 1e-7


@pytest.mark.parametrize("value", [0.01, 1.0, 50.0, -50.0])
def test_a_value_at_an_extremum_is_looked_up_within_rounding(value: float) -> None:
    """Within 1e-12 of its size, and of 1 for a smaller one."""
    slack = 1e-12 * max(1.0, abs(value))
    for part, looked_up in ((0.5, True), (-0.5, True), (2.0, False), (-2.0, False)):
        curve = Formula(lambda theta: value + theta**2, 0.0)
        curve._touching(curve.at(-0.1), curve.at(0.0), curve.at(0.1), value + part * slack)
        assert (curve.found == [0.0]) == looked_up == bool(curve.asked)


@pytest.mark.parametrize("value", [0.3, 40.0])
def test_beside_an_end_a_value_is_looked_up_as_far_as_the_slope_leads(value: float) -> None:
    """Four times the slope times the gap, and a rounding part of the value."""
    for gap, slope in ((0.01, 2.0), (0.01, -2.0), (1e-12, 0.0)):
        reach = 4 * abs(slope) * gap + 1e-9 * max(1.0, abs(value))
        for part, looked_up in ((0.9, True), (-0.9, True), (1.1, False), (-1.1, False)):
            curve = Formula(lambda theta: value, 1.0 + gap / 2)
            point = Point(1.0, value, slope, 1.1)
            curve._at_end(SimpleNamespace(theta_m=1.0 + gap), point, value + part * reach)  # type: ignore[arg-type]
            assert bool(curve.asked) == looked_up
            assert bool(curve.found) == looked_up
    curve = Formula(lambda theta: value, 1.0)
    curve._at_end(SimpleNamespace(theta_m=1.0), Point(1.0, value, 2.0, 1.1), value)  # type: ignore[arg-type]
    assert curve.asked == []  # the end is the point


@pytest.mark.parametrize("theta", [0.2, 1.0, 6.0, -3.0])
def test_a_solution_lies_between_in_phase_and_in_time(theta: float) -> None:
    curve = Formula(abs)
    room = 1e-14 * max(1.0, abs(theta))
    first, last = Point(theta, 0.0, 1.0, 2.0), Point(theta + 0.5, 1.0, 1.0, 3.0)
    for beyond, inside in ((0.8, True), (1.4, False)):
        assert curve._lies_between((theta - beyond * room, 2.5), first, last) is inside
    for end, sign in ((first, -1), (last, 1)):
        late = 0.1 * (last.tau - first.tau)
        assert curve._lies_between((theta + 0.2, end.tau + 0.9 * sign * late), first, last)
        assert not curve._lies_between((theta + 0.2, end.tau + 1.1 * sign * late), first, last)
        assert curve._lies_between((end.theta_m + 0.1 * sign, end.tau), first, last, 0.11)
        assert not curve._lies_between((end.theta_m + 0.1 * sign, end.tau), first, last, 0.09)


def test_one_solution_is_kept_once_whatever_turn_it_is_on() -> None:
    curve = Formula(abs)
    turn = 2 * mpmath.pi
    with mpmath.workdps(60):
        turn = 2 * mpmath.pi
        for theta, tau in [
            (1, 2),
            (1 + turn, 2),
            (1 - 3 * turn, 2),
            (mpmath.mpf("1e-40"), 2),
            (-mpmath.mpf("1e-40"), 2),
        ]:
            curve._add(mpmath.mpf(theta), mpmath.mpf(tau))
        assert len(curve._solutions) == 2
        curve._add(mpmath.mpf(1), mpmath.mpf("2.001"))  # another flight to the same contact
        curve._add(mpmath.mpf("1.001"), mpmath.mpf(2))
        assert len(curve._solutions) == 4
        assert all(0 <= theta < turn for theta, _ in curve._solutions)
