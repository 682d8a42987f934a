"""Branches of orbits: where and why they end, seen from both sides and judged by the oracle."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from branches import branch_of
from click.testing import CliRunner
from oracle import simulate_oracle
from samples import few

from symosc import Parameters, load_scene
from symosc.cli.orbit import orbit as command
from symosc.errors import ParameterError
from symosc.orbits import continuation
from symosc.orbits.admissibility import ENGINE, Condition
from symosc.orbits.branch import BranchError, BranchPoint
from symosc.orbits.continuation import FOLD, NEIMARK_SACKER, PERIOD_DOUBLING, _changes, continue_orbit
from symosc.orbits.curve import Curve
from symosc.orbits.find import find_orbit
from symosc.plot import branch_figure

FIG9, FIG10 = load_scene("fig9").parameters, load_scene("fig10").parameters

# One bifurcation, met from its two sides by the branches of two words:
# parameters, word, parameter, range, which end, kind there, part of the failed inequality, word behind.
NEIGHBOURS = {
    "stick": (
        (FIG9, "P32", "Omega", (3, 4), 0, "birth of a stick", "F^(1) < 0 where P3 crosses v1", "P132"),
        (FIG9.replace(Omega="3.25"), "P132", "Omega", (3, 4), 1, "vanishing of a stick", "P1 lasts", "P32"),
    ),
    "graze of v2": (
        (FIG9, "P32", "Omega", (4, 6), 1, "grazing", "P3 stays in Omega2", "P7482"),
        (FIG9.replace(Omega="5.1"), "P7482", "Omega", (5, "5.15"), 0, "grazing", "P8 meets v2 with F^(2) > 0", "P32"),
    ),
    "graze of v1": (
        (FIG10, "P4645", "Omega", ("1.7", 4), 1, "grazing", "P5 stays in Omega2", "P481746"),
        (FIG10.replace(Omega="2.7"), "P481746", "Omega", (2, 3), 0, "grazing", "P7 meets v1 with F^(2) < 0", "P4546"),
    ),
    "slip": (
        (FIG10, "P4645", "B0", (3, 15), 0, "vanishing of a slip", "F^(3) rises where P4 ends", "P45"),
        (FIG10.replace(B0="4.5"), "P45", "B0", (4, 7), 1, "birth of a slip", "F^(2) > 0 > F^(3) during P4", "P4645"),
    ),
}


@pytest.fixture(scope="module", params=NEIGHBOURS)
def two_sides(request):
    """Return the two ends at one bifurcation, and how they were asked for."""
    found = []
    for row in NEIGHBOURS[request.param]:
        branch = branch_of(*row[:4])
        found.append((branch, branch.ends[row[4]], row))
    return found


@pytest.mark.slow
def test_reason_and_next_word(two_sides):
    for branch, end, (_, _, _, _, which, kind, inequality, beyond) in two_sides:
        assert end.kind == kind
        assert end.conditions[0].text.startswith(inequality)
        assert end.conditions[0].event == kind
        assert inequality in end.message
        assert sorted(end.beyond) == sorted(beyond)
        assert end.value == branch.values[0 if which == 0 else -1]
        np.testing.assert_allclose(branch.points[0 if which == 0 else -1], end.points, atol=1e-12)


@pytest.mark.slow
def test_both_sides_agree_on_the_place(two_sides):
    first, second = (end.value for _, end, _ in two_sides)
    assert abs(first - second) < 1e-10


@pytest.mark.slow
def test_oracle_sees_the_change_within_1e_10(two_sides):
    """Simulated from the ODE, the structure changes between value - 1e-10 and value + 1e-10."""
    (branch, end, row), (other, _, _) = two_sides
    outward = 1 if row[4] else -1
    for shift, labels in ((-outward, branch.labels), (outward, other.labels)):
        value = Fraction(end.value) + Fraction(shift, 10**10)
        p = row[0].replace(**{row[2]: value})
        assert events_of_a_period(p, branch, -2 if row[4] else 1) == events_of(labels)


MODES = {"P1": "belt1", "P2": "Omega1", "P4": "belt2", "P6": "Omega3"}  # the others: Omega2


def events_of(labels) -> list[str]:
    """Return what the mappings move through, sorted: the rotation of a word does not matter here."""
    return sorted(MODES.get(label, "Omega2") for label in labels)


def events_of_a_period(p: Parameters, branch, at: int) -> list[str]:
    """Return the modes of the last of a few periods that the oracle simulates, begun on the orbit next to an end."""
    period, orbit, cycles = 2 * np.pi / float(p.Omega), branch.orbit(at), 25
    pieces, times = orbit.equations().pieces, [point.t for point in orbit.points]
    ends = [*times[1:], times[0] + period]
    i = max(range(len(pieces)), key=lambda i: (not pieces[i].sticks) * (ends[i] - times[i]))
    t0 = (times[i] + ends[i]) / 2  # inside the longest flight
    x0, v0 = (float(value) for value in orbit(t0))
    run = simulate_oracle(p, t0, x0, v0, t0 + cycles * period, 35)
    return sorted(event.source for event in run.events if event.t > t0 + (cycles - 1) * period)


@pytest.mark.slow
def test_points_of_a_branch_are_orbits():
    branch = branch_of(FIG9, "P32", "Omega", (3, 5))
    assert branch.values[0] == pytest.approx(3.28857638277, abs=1e-10)
    assert branch.values[-1] == 5.0
    assert branch.ends[1].kind == "end of the range"
    assert branch.ends[1].beyond is None
    assert (np.diff(branch.values) > 0).all()
    assert branch.stable.all()
    assert branch.points.shape == (len(branch.values), 2, 2)
    assert branch.multipliers.shape == (len(branch.values), 2)
    for i in range(1, len(branch.values), 7):
        found = find_orbit(branch.parameters(i), "P32")  # from scratch
        assert found.admissible
        np.testing.assert_allclose(np.array(found.points), branch.points[i], atol=1e-11)
        np.testing.assert_allclose(np.abs(found.multipliers), np.abs(branch.multipliers[i]), atol=1e-9)
    assert branch.orbit(3, digits=25).residual < 1e-30


@pytest.mark.slow
def test_a_range_may_end_where_no_system_is_beyond():
    """c = 0 is the least damping there is: the branch ends on it exactly."""
    branch = continue_orbit(FIG9, "P32", "c", (0, "0.3"))
    assert branch.values[0] == 0
    assert branch.ends[0].kind == "end of the range"
    assert abs(branch.multipliers[0]).max() < 1


@pytest.mark.slow
def test_a_branch_that_begins_at_the_end_of_its_range():
    branch = continue_orbit(FIG9, "P32", "Omega", (4, "4.2"))
    assert branch.values[0] == 4
    assert branch.values[-1] == 4.2
    assert (np.diff(branch.values) > 0).all()


def test_max_points():
    branch = continue_orbit(FIG9, "P32", "Omega", (3, 5), max_points=5)
    assert [end.kind for end in branch.ends] == ["max_points"] * 2
    assert len(branch.values) == 9


def point(trace: float, determinant: float, direction: float = 1.0) -> BranchPoint:
    tangent = np.array([0.0, direction])
    return BranchPoint(0.0, np.zeros((1, 2)), tangent, trace, determinant, (0j, 0j), (), ())


@pytest.mark.parametrize(
    ("before", "after", "found"),
    [
        (point(1.4, 0.45), point(1.5, 0.45), [FOLD]),  # a multiplier passes +1
        (point(0.1, 0.2), point(0.1, 0.2, -1.0), [FOLD]),  # the branch turns back
        (point(-1.4, 0.45), point(-1.5, 0.45), [PERIOD_DOUBLING]),
        (point(0.3, 0.99), point(0.3, 1.01), [NEIMARK_SACKER]),
        (point(0.3, 0.98), point(0.4, 0.99), []),
    ],
)
def test_smooth_bifurcations_are_noticed(before, after, found):
    """Damping excludes them from real branches (symosc.orbits.floquet), so the tests are fed by hand."""
    assert _changes(None, before, after) == found


def test_steps_that_never_succeed_end_a_branch_with_what_is_nearest_to_failing(monkeypatch):
    monkeypatch.setattr(Curve, "step", lambda *_: None)
    branch = continue_orbit(FIG9, "P32", "Omega", (3, 5))
    for end in branch.ends:
        nearest = min(find_orbit(FIG9, "P32").conditions(), key=lambda condition: condition.value)
        assert end.kind == "no convergence"
        assert end.value == 4
        assert nearest.text in end.message
        assert f"{nearest.value:.3g}" in end.message
        assert end.conditions[0].text == nearest.text


@pytest.mark.slow
@pytest.mark.parametrize("limit", few([4.1, 3.9], 3.9))
def test_a_branch_ends_where_the_engine_contradicts_its_points(monkeypatch, limit):
    """The margins hold everywhere; beyond a value the simulated motion does not follow the word."""
    told = Condition(1, "P3 ends where it first can", -0.5, 1.25, "grazing", ENGINE, 1.0)
    outward = 1 if limit > 4 else -1

    def engine(equations, points):
        return [told] if outward * (float(equations.parameters.Omega) - limit) > 0 else []

    monkeypatch.setattr(continuation, "failures", engine)
    branch = continue_orbit(FIG9, "P32", "Omega", (3.8, 4.2))
    end, other = branch.ends[::-outward]
    assert abs(end.value - limit) < 1e-6
    assert outward * (end.value - limit) <= 0
    assert end.kind == "grazing"
    assert end.message.startswith("P3 ends where it first can no longer holds at t = 1.25")
    assert end.conditions == (told,)
    assert other.kind == "end of the range"
    assert (outward * (branch.values - limit) <= 0).all()


def test_a_curve_gives_no_point_where_it_cannot(monkeypatch):
    curve = Curve(find_orbit(FIG9, "P32"), "Omega", 3.0, 5.0)
    first = curve.first(1.0)
    assert curve.step(first, 0.01) is not None
    assert curve.correct(curve.of(first) + 100.0, first.tangent) is None  # far from any root
    assert curve.accepted(curve.of(first), replace(first, tangent=-first.tangent)) is not None
    sideways = np.zeros_like(first.tangent)
    sideways[1] = 1.0
    assert curve.accepted(curve.of(first), replace(first, tangent=sideways)) is None  # too sharp a turn
    assert curve.accepted(None, first) is None
    with monkeypatch.context() as patch:
        patch.setattr(curve, "linearised", lambda z, slope=None: (np.zeros(4), np.zeros((4, 5))))
        assert curve.correct(curve.of(first), first.tangent) is None  # singular
        assert curve.accepted(curve.of(first), first) is None
    with monkeypatch.context() as patch:
        patch.setattr(curve, "linearised", lambda z, slope=None: (np.full(4, np.nan), np.eye(4, 5)))
        assert curve.correct(curve.of(first), first.tangent) is None  # overflow


def test_bad_input():
    with pytest.raises(ParameterError, match="parameter"):
        continue_orbit(FIG9, "P32", "omega", (3, 5))
    for limits in ((5, 6), (4, 4), (5, 3)):
        with pytest.raises(ParameterError, match="in between"):
            continue_orbit(FIG9, "P32", "Omega", limits)
    with pytest.raises(ParameterError, match="pair"):
        continue_orbit(FIG9, "P32", "Omega", 5)
    with pytest.raises(ParameterError, match="mu1"):
        continue_orbit(FIG9, "P32", "mu1", (-1, 1))
    with pytest.raises(BranchError, match="no first orbit") as caught:
        continue_orbit(FIG9.replace(Omega=3), "P32", "Omega", (2, 4))
    assert not caught.value.orbit.admissible


@pytest.mark.slow
def test_plot(tmp_path):
    branch = branch_of(FIG10, "P4645", "B0", (3, 15))
    drawing = branch_figure(branch)
    left, right = drawing.axes
    # Four switchings, each one solid line; two ends with a mark on each line.
    assert sum(len(line.get_xdata()) > 2 for line in left.lines) == 4
    assert {text.get_text() for text in right.texts} >= {"P4645", branch.ends[0].beyond, branch.ends[1].beyond}
    labels = [text.get_text() for text in drawing.legends[0].get_texts()]
    starts = ["start of P5", "start of P4", "start of P6", "start of 2nd P4"]
    assert labels == [*starts, "vanishing of a slip", "grazing", "stable", "unit circle"]


@pytest.mark.slow
def test_command_line(tmp_path):
    run = CliRunner().invoke
    result = run(command, ["fig9"], standalone_mode=False)
    assert result.return_value == 0
    assert "0.18167039792432" in result.output
    assert "after 6 periods" in result.output
    result = run(command, ["fig10", "--digits", "25", "--json"], standalone_mode=False)
    assert result.return_value == 0
    data = json.loads(result.output)
    assert data["points"][0]["t"] == "0.4436449855574556494720909"
    assert data["start"]["periods"] == 2
    chart = tmp_path / "branch.svg"
    arguments = ["fig9", "--structure", "P32", "--continue", "Omega=3:5.5", "-o", str(chart)]
    result = run(command, arguments, standalone_mode=False)
    assert "birth of a stick, F^(1) < 0 where P3 crosses v1 (Theorem 5)" in result.output
    assert "beyond it P7482" in result.output
    assert chart.stat().st_size > 10_000
    result = run(command, ["fig9", "--set", "Omega=3"], standalone_mode=False)
    assert result.return_value == 1
    assert "a root that is not an orbit" in result.output
    assert "settles to P1312" in result.output
    result = run(command, ["fig9", "--structure", "P45"], standalone_mode=False)
    assert result.return_value == 1
    for bad in (["fig5"], ["fig9", "--continue", "Omega"], ["fig9", "--set", "k"]):
        assert run(command, bad).exit_code == 2
    orbit_figure = tmp_path / "orbit.png"
    assert run(command, ["fig10", "-o", str(orbit_figure)], standalone_mode=False).return_value == 0
    assert orbit_figure.stat().st_size > 10_000


@pytest.mark.slow
def test_steps_along_a_branch_grow_to_the_longest_and_no_further():
    """... on a branch that nothing bends: the first step, then half as long again each time, then the longest."""
    orbit = find_orbit(FIG9, "P32")
    curve = Curve(orbit, "Omega", 3.9, 4.4)
    path, end = continuation._follow(curve, 1.0, 200, lambda value, count: None)
    assert end.kind == "end of the range"
    lengths = [curve.distance(a, b) for a, b in pairwise(path)]
    steps = [a + b for a, b in zip(lengths[::2], lengths[1::2], strict=True)]  # each step has a point in its middle
    right = [min(0.04, 0.02 * 1.5**i) for i in range(len(steps))]
    assert steps[:-1] == pytest.approx(right[:-1], rel=0.05)
    assert len(steps) > 4
    assert steps[-1] <= 0.042


@pytest.mark.parametrize("small", [1e-5, 1e-8])
def test_a_start_where_a_margin_is_rounding_is_left_a_little(small, monkeypatch):
    """By the shortest way on which nothing changes and the engine follows; else it is where the branch begins."""
    curve = Curve(find_orbit(FIG9, "P32"), "Omega", 3.0, 5.0)
    first = curve.first(1.0)
    thin = tuple(c._replace(value=small * c.scale) if i == 2 else c for i, c in enumerate(first.conditions))
    begin, asked = replace(first, conditions=thin), []
    monkeypatch.setattr(curve, "first", lambda direction: begin)
    real = curve.step

    def step(current, length):
        asked.append(length)
        return real(current, length)

    monkeypatch.setattr(curve, "step", step)
    for good, lengths in ((0, [1e-6]), (1, [1e-6, 1e-5]), (2, [1e-6, 1e-5, 1e-4]), (9, [1e-6, 1e-5, 1e-4])):
        for way in ("change", "engine"):
            asked.clear()
            number = iter(range(9))
            bad = replace(first, failures=(first.conditions[0],))

            def changes(*_, way=way, good=good, number=number):
                return ["fold"] if way == "change" and next(number) < good else []

            def verified(_, point, way=way, good=good, number=number, bad=bad):
                return bad if way == "engine" and next(number) < good else point

            monkeypatch.setattr(continuation, "_changes", changes)
            monkeypatch.setattr(continuation, "_verified", verified)
            found = continuation._begun(curve, 1.0)
            if small > 1e-6:
                assert found == [begin]
                assert asked == []
                continue
            assert asked == lengths
            assert found[0] is begin
            assert len(found) == (2 if good < 3 else 1)
            if good < 3:
                assert curve.distance(begin, found[1]) == pytest.approx(lengths[-1], rel=1e-3)


def test_the_smooth_tests_are_those_of_the_characteristic_polynomial():
    """det(M - z) at z = 1 and z = -1, and what is 0 where two complex multipliers have the modulus 1."""
    rng = np.random.default_rng(9)
    for _ in range(50):
        M = rng.uniform(-1.5, 1.5, (2, 2))
        at = point(float(np.trace(M)), float(np.linalg.det(M)))
        plus, minus, one = continuation._multiplier_tests(at)
        assert plus == pytest.approx(np.linalg.det(M - np.eye(2)))
        assert minus == pytest.approx(np.linalg.det(M + np.eye(2)))
        assert one == pytest.approx(1 - np.prod(np.linalg.eigvals(M)).real)


def test_progress_tells_the_part_of_the_range_both_ways() -> None:
    parts: list[float] = []
    p = load_scene("fig9").parameters
    branch = continue_orbit(p, "P32", "Omega", (3.9, 4.1), progress=lambda part, all: parts.append(part / all))
    assert branch == continue_orbit(p, "P32", "Omega", (3.9, 4.1))
    assert parts == sorted(parts)
    assert 0 < parts[0] < 0.5 < parts[-1] == pytest.approx(1.0)


def test_the_end_of_a_branch_is_what_fails_or_what_its_multipliers_say(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: margins at three points and at the one that failed; those that have become small are the reasons."""
    made = [Condition(i, f"c{i}", 0.0, 2.0, event, rank, 1.0) for i, (event, rank) in enumerate(
        (("grazing", 3), ("birth", 2), ("grazing", 4)))]  # fmt: skip

    def at(value: float, trace: float, values: tuple[float, ...], failed: tuple[int, ...] = ()) -> BranchPoint:
        margins = tuple(each._replace(value=margin) for each, margin in zip(made, values, strict=True))
        return replace(point(trace, 0.45), value=value, conditions=margins, failures=tuple(margins[i] for i in failed))

    along = SimpleNamespace(
        distance=lambda a, b: abs(a.value - b.value),
        equations=lambda value: SimpleNamespace(parameters=FIG9.replace(c=0)),
    )
    monkeypatch.setattr(continuation, "_inside", lambda curve, last: last)
    monkeypatch.setattr(continuation, "_named", lambda curve, last: ())
    for instead in ("", "the motion stops"):
        monkeypatch.setattr(continuation, "look_behind", lambda *_, instead=instead: ("P7", instead))
        path = [at(1.0, 0.5, (1.0, 2.0, 3.0)), at(1.5, 1.6, (0.9, 1.0, 2.0)), at(1.6, 1.4, (0.5, 0.9, 1.0))]
        for failed, kind, reasons in (
            (at(1.6001, 1.4, (-1e-9, 0.9, 1.0), (0,)), "grazing", [0]),
            (at(1.6001, 1.4, (-1e-9, -1e-9, 1.0), (0, 1)), "birth", [1]),
            (at(1.6001, 1.4, (-1e-9, 0.9, -1e-9), (0, 2)), "grazing", [0, 2]),
            (at(1.6001, 1.5, (0.5, 0.9, 1.0)), FOLD, []),
        ):
            points, end = continuation._ended(along, list(path), failed, 1.0)  # type: ignore[arg-type]
            assert points[:2] == path[:2]
            assert (end.kind, end.value, end.beyond) == (kind, 1.6, "P7")
            assert [each.text for each in end.conditions] == [f"c{i}" for i in reasons]
            said = "a multiplier is +1" if kind == FOLD else "; ".join(
                f"c{i} no longer holds at t = 2" for i in reasons)  # fmt: skip
            assert end.message == said + (f"; beyond it {instead}" if instead else "")
