"""Which solutions on a grazing curve are looked for, and which are taken: on a curve that is a formula.

Newton's method is replaced by one that leads astray unless it begins near the root; the true one is tested by
`test_solve`, whose answers are judged by the flow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
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


# --- whole pieces of a curve ---


class Piece(SimpleNamespace):
    """A piece of the curve theta_i = f(theta_m) or x_i = f(theta_m), with its samples."""

    @classmethod
    def of(cls, curve: Formula, low: float, high: float, n: int, reason: str = "beyond, the flow ...") -> Any:
        points = [curve.at(theta) for theta in np.linspace(low + 0.01, high - 0.01, n).tolist()]
        columns = {name: np.array([getattr(point, name) for point in points]) for name in ("theta_m", "value", "slope")}
        theta = columns["theta_m"] - np.array([point.tau for point in points])
        ends = [SimpleNamespace(theta_m=each, reason=reason) for each in (low, high)]
        value, slope = columns["value"], columns["slope"]
        slopes = {"slope_x": slope, "slope_theta": slope}
        return cls(theta_m=columns["theta_m"], x=value, theta=theta, **slopes, low=ends[0], high=ends[1])


class Whole(Formula):
    """A formula whose roots Newton's method finds from 0.05 beside them."""

    roots: tuple[float, ...] = ()

    def _newton(self, theta_m: float, tau: float, target: Any) -> tuple[Any, Any] | None:
        near = min(self.roots, key=lambda root: abs(root - theta_m), default=9.9)
        found = near if abs(near - theta_m) < 0.05 else 5.5
        return mpmath.mpf(found), mpmath.mpf(1 + found / 10)


@pytest.mark.parametrize("seed", range(4))
def test_all_values_of_a_piece_are_found(seed: int) -> None:
    """Crossings, pairs of them between two samples, and touches of an extremum: of waves with known roots."""
    rng = np.random.default_rng(seed)
    for n in (7, 9, 12, 15, 40):
        shift, height = rng.uniform(0, 1.5), rng.choice([rng.uniform(0, 0.97), rng.uniform(0.99, 0.9999)])
        level = rng.choice([-1, 1]) * height  # near 1 both values lie between two samples
        target = 3.0 + level
        curve = Whole(lambda theta, shift=shift: 3.0 + math.sin(2 * theta + shift))
        curve.K = SimpleNamespace(rate=1.0, Om=1.0)
        low, high = 0.0, 2.9
        angles = [math.asin(level), math.pi - math.asin(level)]
        roots = [(angle + 2 * math.pi * turn - shift) / 2 for angle in angles for turn in range(-2, 4)]
        curve.roots = tuple(sorted(root for root in roots if low < root < high))
        curve.target = mpmath.mpf(target)
        curve._on_piece(Piece.of(curve, low, high, n))
        right = [root for root in curve.roots if low + 0.01 <= root <= high - 0.01]
        assert sorted(curve.found) == pytest.approx(right, abs=1e-12), (n, shift, level)


@pytest.mark.parametrize(("beyond", "taken"), [(0.0, True), (1e-12, True), (1e-11, False)])
def test_a_value_at_an_extremum_between_two_samples_is_found_once(beyond: float, taken: bool) -> None:
    """The wave comes to the value from below or above and turns there, within rounding."""
    for sign in (1, -1):
        curve = Whole(lambda theta, sign=sign: 3.0 + sign * math.sin(theta))
        curve.K, curve.target = SimpleNamespace(rate=1.0, Om=1.0), mpmath.mpf(3.0 + sign * (1 + beyond))
        curve.roots = (math.pi / 2,)
        curve._on_piece(Piece.of(curve, 0.2, 2.9, 10))
        assert curve.found == ([math.pi / 2] if taken else [])


def test_of_an_angle_all_turns_are_looked_for() -> None:
    """Every value that differs from the target by whole turns and lies in reach, and none beside it twice."""
    rng = np.random.default_rng(4)
    curve = Formula(abs)
    for _ in range(40):
        low = rng.uniform(-30, 10)
        high, wanted = low + rng.uniform(0, 20), rng.uniform(0, 2 * math.pi)
        curve.target = mpmath.mpf(wanted)
        curve.name = "theta_i"
        found = [float(each) for each in curve._targets(low, high, None)]  # type: ignore[arg-type]
        right = [wanted + 2 * math.pi * j for j in range(-9, 9) if low <= wanted + 2 * math.pi * j <= high]
        assert np.diff(found) == pytest.approx(2 * math.pi)
        assert all(min(abs(each - other) for other in found) < 1e-12 for each in right)
        assert low - 7 < found[0]
        assert found[-1] < high + 7
        curve.name = "x_i"
        assert curve._targets(low, high, None) == [curve.target]  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["x_i", "theta_i"])
def test_a_curve_that_begins_in_a_tangency_itself_has_that_point_too(name: str) -> None:
    """Where the flight to the last sample is short compared with the way to the end of the window."""
    for flight, reason, added in (
        (0.05, "end of the window", True),
        (0.2, "end of the window", False),
        (0.05, "x", False),
    ):
        curve = Formula(lambda theta: 2 + theta)
        curve.name, curve.K = name, SimpleNamespace(rate=1.0, Om=2.0)
        curve.curve = SimpleNamespace(_source=SimpleNamespace(rest=7.0, gain=3.0))
        piece = Piece.of(curve, 0.5, 1.5, 5, reason)
        piece.theta = piece.theta_m - flight
        points = curve._points(piece)
        middle = points[1:-1] if added else points
        values = piece.x if name == "x_i" else piece.theta
        assert [point.theta_m for point in middle] == piece.theta_m.tolist()
        assert [point.value for point in middle] == values.tolist()
        assert [point.slope for point in middle] == piece.slope_x.tolist()
        assert [point.tau for point in middle] == pytest.approx([flight / 2] * 5)
        assert len(points) == 5 + 2 * added
        if added:
            for point, theta_m, near in ((points[0], 0.5, points[1]), (points[-1], 1.5, points[-2])):
                contact = 7 + 3 * math.cos(theta_m) if name == "x_i" else theta_m
                assert point == (theta_m, pytest.approx(contact), near.slope, 0.0)


@pytest.mark.parametrize("at_low", [True, False])
def test_what_goes_on_for_ever_is_noted(at_low: bool) -> None:
    """At an end that is steep to the last digit (x_i only for a value beyond it), or where the search was too short."""
    for name in ("x_i", "theta_i"):
        for reason, slope, target, noted in (
            ("end of the window", 1e9, 9.0, None),
            ("closed", 1e9, 9.0, None),
            ("beyond, the flow met no belt before", 1e9, 9.0, "goes on for ever"),
            ("beyond, the flow met no belt before", -1e9, -9.0, "goes on for ever"),
            ("beyond, the flow met no belt before", 1e9, 2.0, None if name == "x_i" else "goes on for ever"),
            ("beyond, the flow met no belt before", 1e-3, 9.0, None),
            ("beyond, the flow met no belt before (within the search)", 1e-3, 2.0, "longer than the search"),
        ):
            curve = Formula(lambda theta: 3.0)
            curve.name, curve.target = name, mpmath.mpf(target)
            piece = Piece.of(curve, 0.5, 1.5, 5, reason)
            piece.slope_theta = np.full(5, 1e-9)
            piece.slope_theta[0 if at_low else -1] = slope
            piece.theta[[0, -1]] = 11.0, 22.0
            point = curve.at(float(piece.theta_m[0 if at_low else -1]))
            curve._note_endless(piece.low if at_low else piece.high, point, piece)
            assert len(curve.notes) == (noted is not None)
            if noted:
                assert noted in curve.notes[0]
                assert f"theta_m = {0.5 if at_low else 1.5:.6g}" in curve.notes[0]
            if noted == "goes on for ever":
                assert f"theta = {11 if at_low else 22}, x = 3 " in curve.notes[0]


class Straight(SimpleNamespace):
    """Flights from places that are a multiple of the tangency's phase."""

    def __init__(self, slope: float) -> None:
        super().__init__(context=mpmath.mp, K=SimpleNamespace(Om=2.0), digits=40, slope=mpmath.mpf(slope))

    def number(self, value: Any) -> Any:
        return mpmath.mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else mpmath.mpf(value)

    def contact(self, theta: Any) -> Any:
        return mpmath.sin(theta) / 4

    def instant(self, theta: Any, tau: Any) -> Any:
        return SimpleNamespace(dx=self.slope * theta - self.contact(theta), x_theta=self.slope)


@pytest.mark.parametrize("kind", ["touch", "contact"])
@pytest.mark.parametrize("tau", [0.4, 2.5])
def test_on_a_curve_of_touches_the_time_is_that_of_the_search(kind: str, tau: float) -> None:
    """All flights take the same time there: only the phase is solved for, to all digits; a contact is no touch."""
    with mpmath.workdps(40):
        for name, slope in (("theta_i", 1.0), ("x_i", 3.0), ("x_i", -0.2), ("x_i", 0.0)):
            curve = Formula(abs)
            curve.name = name
            curve.flights = Straight(slope)
            arrival = SimpleNamespace(kind=kind, tau=mpmath.mpf(tau))
            exact = lambda phase, order, far, digits, arrival=arrival: (arrival, None)  # noqa: E731
            curve.curve = SimpleNamespace(origins=SimpleNamespace(exact=exact))
            target = mpmath.mpf(1) / 3
            found = curve._among_touches(0.7, target)
            if kind != "touch" or slope == 0:
                assert found is None
                continue
            right = target + 2 * mpmath.mpf(tau) if name == "theta_i" else target / mpmath.mpf(slope)
            assert found is not None
            assert found[1] == tau
            assert abs(found[0] - right) < mpmath.mpf(10) ** -36


def test_both_ends_of_a_piece_are_looked_at_from_the_sample_next_to_them() -> None:
    curve, asked = Whole(lambda theta: 3.0 + theta), []
    curve.K, curve.target = SimpleNamespace(rate=1.0, Om=1.0), mpmath.mpf(9)
    curve._at_end = lambda end, point, target: asked.append((end.theta_m, point.theta_m))  # type: ignore[method-assign]
    curve._note_endless = lambda end, point, piece: asked.append((end.theta_m, point.theta_m))  # type: ignore[method-assign]
    curve._on_piece(Piece.of(curve, 0.5, 1.5, 6))
    assert asked == [(0.5, 0.51), (1.5, 1.49)] * 2
