"""How a branch is followed, on curves that are a line: every margin is a formula, and its first root is known."""

from __future__ import annotations

import operator
import random
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from symosc.orbits import continuation
from symosc.orbits.admissibility import Condition, failing
from symosc.orbits.branch import BranchPoint

Margin = Callable[[float], float]
EVENTS = ("grazing", "birth of a stick", "vanishing of a slip")


class Line:
    """A curve whose points are the parameter alone, with margins that are formulas of it."""

    def __init__(self, margins: list[Margin], low: float, high: float, start: float, monkeypatch: Any) -> None:
        self.margins, self.low, self.high, self.start = margins, low, high, start
        self.orbit, self.parameter = SimpleNamespace(parameters=None), "Omega"
        self.asked = 0
        monkeypatch.setattr(continuation, "conditions", lambda equations, points: self.conditions(equations.value))
        monkeypatch.setattr(
            continuation, "failures", lambda equations, points: failing(self.conditions(equations.value))
        )
        monkeypatch.setattr(continuation, "clear", self.clear)
        monkeypatch.setattr(continuation, "look_behind", lambda *_: (None, ""))
        monkeypatch.setattr(continuation, "_is_found", lambda *_: True)
        monkeypatch.setattr(continuation, "times_of", lambda parameters, name, point: np.array([[point.value, 0.0]]))

    def conditions(self, value: float) -> list[Condition]:
        rows = enumerate(self.margins)
        return [Condition(0, f"margin {i}", margin(value), value, EVENTS[i], i, 1.0) for i, margin in rows]

    def clear(self, nodes: list[tuple[Any, np.ndarray]], margins: list[tuple[Condition, ...]]) -> bool:
        """Return whether no margin reaches 0 between the nodes, which are evenly spaced: by a finer grid."""
        values = [equations.value for equations, _ in nodes]
        assert np.diff(values) == pytest.approx([(values[-1] - values[0]) / 4] * 4, abs=1e-12)
        assert [c.value for c in margins[2]] == [c.value for c in self.conditions(values[2])]
        grid = np.linspace(values[0], values[-1], 65)
        return all(margin(value) > 0 for margin in self.margins for value in grid.tolist())

    def at(self, value: float, direction: float = 1.0) -> BranchPoint:
        self.asked += 1
        rows = tuple(self.conditions(value))
        failed = tuple(failing(list(rows)))
        points, tangent = np.array([[value, 0.0]]), np.array([direction])
        return BranchPoint(value, points, tangent, 0.0, 0.0, (0j, 0j), rows, failed)

    def first(self, direction: float) -> BranchPoint:
        return self.at(self.start, direction)

    def step(self, current: BranchPoint, length: float) -> BranchPoint:
        ahead = current.value + length * float(current.tangent[0])
        return self.at(min(max(ahead, self.low), self.high), float(current.tangent[0]))

    def middle(self, a: BranchPoint, b: BranchPoint) -> BranchPoint:
        return self.at(0.5 * (a.value + b.value), float(a.tangent[0]))

    def equations(self, value: float) -> Any:
        return SimpleNamespace(value=value, parameters=SimpleNamespace(c=1))

    def of(self, point: BranchPoint) -> np.ndarray:
        return np.array([point.value])

    def split(self, z: np.ndarray) -> tuple[np.ndarray, float]:
        return np.array([[z[0], 0.0]]), float(z[0])

    def halfway(self, a: BranchPoint, b: BranchPoint) -> np.ndarray:
        return np.array([0.5 * (a.value + b.value)])

    @staticmethod
    def level(z: np.ndarray) -> np.ndarray:
        return z

    @staticmethod
    def distance(a: BranchPoint, b: BranchPoint) -> float:
        return abs(b.value - a.value)


def followed(line: Line, direction: float, most: int = 2000) -> tuple[list[BranchPoint], Any]:
    return continuation._follow(line, direction, most, lambda value, count: None)  # type: ignore[arg-type]


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_branch_ends_at_the_first_root_of_any_margin(direction: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """To 1e-12, on the side where it holds; of that margin, or at the end of the range if none comes before."""
    rng, kinds = random.Random(1), set()
    for _ in range(25):
        begin = rng.choice([0.05, 0.05, 0.05, 1.01])
        roots = [rng.uniform(begin, 1.3) for _ in range(3)]
        steep = [10 ** rng.uniform(-1, 1) for _ in range(3)]
        margins: list[Margin] = [
            lambda value, root=root, slope=slope: slope * (root - direction * value)  # type: ignore[misc]
            for root, slope in zip(roots, steep, strict=True)
        ]
        line = Line(margins, -1.0, 1.0, 0.0, monkeypatch)
        path, end = followed(line, direction)
        first = min(roots)
        values = [direction * point.value for point in path]
        assert values == sorted(values)
        assert values[0] == 0
        assert all(not point.failures for point in path)
        if first > 1:
            kinds.add(end.kind)
            assert (end.kind, end.value, end.conditions) == ("end of the range", direction, ())
            continue
        which = roots.index(first)
        kinds.add(EVENTS[which])
        assert end.kind == EVENTS[which]
        assert -1e-12 <= first - direction * end.value <= 3e-12
        assert end.value == path[-1].value
        assert [c.text for c in end.conditions][:1] == [f"margin {which}"]
        assert end.message.startswith(f"margin {which} no longer holds at t = ")
    assert kinds == {"end of the range", *EVENTS}


@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6])
def test_a_gap_narrower_than_the_steps_is_not_stepped_over(width: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bound between two points does not hold there; the branch ends before the gap."""
    for place in (0.0537, 0.31, 0.777):

        def dip(value: float, place: float = place) -> float:
            return min(1.0, abs(value - place) / width - 0.5)

        line = Line([dip, lambda value: 1.0], -1.0, 1.0, 0.0, monkeypatch)

        def careful(nodes: Any, margins: Any, place: float = place, line: Line = line) -> bool:
            beside = nodes[0][0].value - width / 2 < place < nodes[-1][0].value + width / 2
            return line.clear(nodes, margins) and not beside

        monkeypatch.setattr(continuation, "clear", careful)
        path, end = followed(line, 1.0)
        assert end.kind == "grazing"
        assert end.value == pytest.approx(place - width / 2, abs=1e-7)
        assert all(point.value < place for point in path)


@pytest.mark.parametrize("depth", [0.0, 1e-16])
def test_a_margin_that_only_comes_to_0_ends_a_branch(depth: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Doubles do not tell whether it passes: a touch is an end, with that margin as the reason."""
    line = Line([lambda value: (value - 0.4321) ** 2 + depth, lambda value: 1.0], -1.0, 1.0, 0.0, monkeypatch)

    def beside(nodes: Any, _: Any) -> bool:
        return not nodes[0][0].value <= 0.4321 <= nodes[-1][0].value

    monkeypatch.setattr(continuation, "clear", beside)
    path, end = followed(line, 1.0)
    assert end.kind == "grazing"
    assert end.value == pytest.approx(0.4321, abs=1e-6)
    assert len(path) > 5


def test_a_branch_stops_after_so_many_points(monkeypatch: pytest.MonkeyPatch) -> None:
    line = Line([lambda value: 1.0], -9.0, 9.0, 0.0, monkeypatch)
    whole, _ = followed(line, 1.0)
    for most in (2, 3, 10, 11):
        path, end = followed(line, 1.0, most)
        assert [point.value for point in path] == [point.value for point in whole[:most]]
        assert (end.kind, end.value, end.message) == ("max_points", path[-1].value, f"stopped after {most} points")


def test_a_step_that_fails_is_tried_shorter_until_it_is_too_short(monkeypatch: pytest.MonkeyPatch) -> None:
    line = Line([lambda value: 2.0 - value, lambda value: 1.25], -9.0, 9.0, 0.0, monkeypatch)
    real, lengths = line.step, []

    def step(current: BranchPoint, length: float) -> BranchPoint | None:
        lengths.append(length)
        return real(current, length) if current.value + length < 0.5 else None

    monkeypatch.setattr(line, "step", step)
    path, end = followed(line, 1.0)
    assert end.kind == "no convergence"
    assert end.value == path[-1].value == pytest.approx(0.5, abs=1e-9)
    assert end.message == "the steps became too short; nearest to failing: margin 1 (by 1.25)"
    assert min(lengths) < 2e-10


@pytest.mark.parametrize(("part", "smooth"), [(0.9, True), (1.1, False)])
def test_a_middle_off_its_cubic_is_not_smooth(part: float, smooth: bool) -> None:
    """By more than a hundredth of the distance, across the curve; along it does not count."""
    rng = np.random.default_rng(3)
    for length in (1e-3, 1.0):
        a, b, m = (SimpleNamespace(z=rng.uniform(-1, 1, 4)) for _ in range(3))
        along = rng.uniform(-1, 1, 4)
        m.tangent = along / np.linalg.norm(along)
        across = rng.uniform(-1, 1, 4)
        across -= (across @ m.tangent) * m.tangent
        off = part * (1e-2 * length + 1e-12) * across / np.linalg.norm(across) + 7.0 * m.tangent
        curve = SimpleNamespace(level=Line.level, of=operator.attrgetter("z"))
        curve.halfway, curve.distance = Mock(return_value=m.z - off), Mock(return_value=length)
        assert continuation._smooth(curve, a, m, b) is smooth  # type: ignore[arg-type]
