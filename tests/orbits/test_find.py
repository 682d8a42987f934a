"""Periodic orbits: the paper's two against 50 digits and the oracle, other words, inadmissible roots, bad input."""

from __future__ import annotations

import pickle
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from oracle import simulate_oracle
from paper_orbits import BOTH_BELTS, FIG9, FIG10, P32, P4645

from symosc import Parameters, load_scene
from symosc.errors import ParameterError
from symosc.mappings.equations import residual
from symosc.orbits import find
from symosc.orbits.admissibility import STICK_LASTS, Condition
from symosc.orbits.closing_equations import ClosingEquations, ConvergenceError
from symosc.orbits.find import find_orbit
from symosc.orbits.guesses import Guess
from symosc.orbits.newton import Solution, newton
from symosc.words import WordError, read_word

# Sticks on both belts; found by simulating random parameters.
MANY_SLIPS = Parameters(
    m=1, c="0.26", k="4.04", A0="3.53", B0="10.37", Omega="1.44", v1="-2.02", v2="1.02", mu1="0.68", mu2="0.71", FN=10
)
CROSSING_BOTH = FIG9.replace(Omega="5.1")

PAPER = [(FIG9, "P32", P32), (FIG10, "P4645", P4645)]


@pytest.mark.parametrize(("p", "word", "points"), PAPER)
def test_paper_orbits_in_double_precision(p, word, points):
    orbit = find_orbit(p, word)
    assert np.abs(np.array(orbit.points) - np.array(points, dtype=float)).max() < 1e-12
    assert orbit.word == word
    assert orbit.admissible
    assert orbit.stable
    assert orbit.failures == ()
    assert orbit.residual < 1e-12
    assert orbit.periods == 1
    assert orbit.period == pytest.approx(2 * np.pi / float(p.Omega), rel=1e-15)


@pytest.mark.parametrize(("p", "word", "points"), PAPER)
def test_paper_orbits_with_digits(p, word, points):
    orbit = find_orbit(p, word, digits=20)
    with mpmath.workdps(40):
        for (t, x), (t_known, x_known) in zip(orbit.points, points, strict=True):
            assert abs(mpmath.mpf(t) - mpmath.mpf(t_known)) < 1e-18 * abs(mpmath.mpf(t_known))
            assert abs(mpmath.mpf(x) - mpmath.mpf(x_known)) < 1e-18 * abs(mpmath.mpf(x_known))
    assert orbit.residual < 1e-30


def exact(value) -> Fraction:
    """Return an mpmath number as the Fraction that it is."""
    sign, mantissa, exponent, _ = value._mpf_
    return (-1) ** sign * int(mantissa) * Fraction(2) ** int(exponent)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748"), (CROSSING_BOTH, "P7482")]
)
def test_oracle_returns_to_the_orbit_and_has_its_multipliers(p, word):
    """The ODE alone, 50 digits: one period later the same state; the return map's differences have the multipliers."""
    orbit = find_orbit(p, word, digits=45)
    assert orbit.admissible
    with mpmath.workdps(60):
        # Start inside a flight, so that a push of the state stays a push of the state.
        i = next(i for i, piece in enumerate(orbit.equations().pieces) if not piece.sticks)
        (t, _), following = orbit.points[i], (*orbit.points[1:], (orbit.points[0][0] + orbit.period, None))[i][0]
        middle = (float(t) + float(following)) / 2
        t0 = exact(mpmath.mpf(middle))
        before = orbit.equations().pieces[i - 1]
        start = orbit.points[i - 1] if before.sticks else orbit.points[i]
        begin, v = exact(start[0]), p.belt((before if before.sticks else orbit.equations().pieces[i]).start)
        if before.sticks and i == 0:
            t0 += exact(orbit.period)
        here = simulate_oracle(p, begin, exact(start[1]), v, t0, 50)
        x0, v0, h = exact(here.x), exact(here.v), Fraction(1, 10**18)
        after = t0 + exact(orbit.period)
        back = simulate_oracle(p, t0, x0, v0, after, 50)
        assert abs(back.x - here.x) + abs(back.v - here.v) < 1e-30
        assert len(back.events) == len(orbit.labels)
        M = mpmath.matrix(2)
        for column, (dx, dv) in enumerate(((h, 0), (0, h))):
            plus = simulate_oracle(p, t0, x0 + dx, v0 + dv, after, 50)
            minus = simulate_oracle(p, t0, x0 - dx, v0 - dv, after, 50)
            M[0, column] = (plus.x - minus.x) / (2 * mpmath.mpf(h.numerator) / h.denominator)
            M[1, column] = (plus.v - minus.v) / (2 * mpmath.mpf(h.numerator) / h.denominator)
        trace, determinant = M[0, 0] + M[1, 1], M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0]
    ours = [complex(value) for value in orbit.multipliers]
    assert abs(sum(ours) - complex(trace)) < 1e-12
    assert abs(ours[0] * ours[1] - complex(determinant)) < 1e-12


@pytest.mark.parametrize(
    ("p", "word", "sticks"), [(BOTH_BELTS, "P1748", {"P1", "P4"}), (MANY_SLIPS, "P174648", {"P1", "P4"})]
)
def test_words_with_sticks_on_both_belts(p, word, sticks):
    orbit = find_orbit(p, word)
    assert orbit.admissible
    assert sticks <= set(orbit.labels)
    assert orbit.multipliers[1] == 0
    assert abs(orbit.multipliers[0]) < 1
    assert orbit.residual < 1e-12


@pytest.mark.parametrize(
    ("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748"), (MANY_SLIPS, "P174648")]
)
def test_points_satisfy_the_maps(p, word):
    orbit = find_orbit(p, word)
    equations, points = orbit.equations(), orbit.phases()
    ends, exits = equations.ends(points), read_word(word).exits()
    for label, exit, start, end in zip(orbit.labels, exits, points, ends, strict=True):
        assert max(map(abs, residual(p, label, tuple(start), tuple(end), exit))) < 1e-12


def test_printed_starts_are_said_to_be_off_the_orbit():
    orbit = find_orbit(FIG9, "P32")
    near = orbit.approach("fig9")
    assert near.dt == pytest.approx(0.1324 - orbit.points[0].t, abs=1e-14)
    assert near.dx == pytest.approx(4.5447 - orbit.points[0].x, abs=1e-14)
    assert abs(near.offset_v) > 4
    assert near.periods == 6
    near = find_orbit(FIG10, "P4645").approach("fig10")
    assert abs(near.dt) < 0.02
    assert abs(near.dx) < 0.02
    assert near.periods == 2
    for name, word in (("fig9-orbit", "P32"), ("fig10-orbit", "P4645")):
        near = find_orbit(load_scene(name).parameters, word).approach(name)
        assert near.periods == 0
        assert abs(near.offset_x) + abs(near.offset_v) < 1e-12
    with pytest.raises(ParameterError, match="the orbit's parameters"):
        orbit.approach("fig10")


def test_other_bad_input():
    with pytest.raises(ParameterError, match="never follows the word"):
        find_orbit(FIG9, "P4645", (0.18, 4.15))
    with pytest.raises(WordError, match="P4 cannot follow P2"):
        find_orbit(FIG9, "P42")
    with pytest.raises(ParameterError, match="without a spring"):
        find_orbit(FIG9.replace(k=0), "P32")
    with pytest.raises(ParameterError, match="periods"):
        find_orbit(FIG9, "P32", periods=0)
    with pytest.raises(ParameterError, match="digits"):
        find_orbit(FIG9, "P32", digits=2.5)
    with pytest.raises(ParameterError, match="parameters"):
        find_orbit(load_scene("fig9"), "P32")


def test_no_convergence_carries_the_best_points():
    with pytest.raises(ConvergenceError, match="the motion settles to P5464") as caught:
        find_orbit(FIG10, "P32", [(0.2, 4.0), (1.0, -4.0)])
    error = caught.value
    assert len(error.best) == 2
    assert np.isfinite(np.array(error.best, dtype=float)).all()
    assert error.residual > 0
    assert error.periods == 1
    copy = pickle.loads(pickle.dumps(error))
    assert (copy.word, copy.best, copy.residual) == (error.word, error.best, error.residual)


def test_newton_converges_quadratically():
    """A damped method must not be a slow one: from two digits to all of them in five steps."""
    for p, word, points in PAPER:
        equations = ClosingEquations(p, read_word(word), 1)
        guess = np.array([(round(float(x), 2), float(p.Omega) * round(float(t), 2)) for t, x in points])
        solution = newton(equations, guess)
        assert solution.converged
        assert solution.steps <= 6


def test_roots_are_one_but_for_whole_turns():
    """Shifted by whole turns of the phase a root is the same; by half a turn, or a little in x, it is another."""
    orbit = find_orbit(FIG9, "P32")
    equations = ClosingEquations(FIG9, read_word("P32"), 1)
    points = np.array([[x, float(FIG9.Omega) * t] for t, x in orbit.points], dtype=float)

    def same(shift, at=equations):
        one, other = (Solution(each, 0.0, 0, True, "") for each in (points + shift, points))
        return find._same(at, one, equations, other)

    for turns in (-3, -1, 0, 1, 2):
        assert same(np.array([0, 2 * np.pi * turns]))
        assert not same(np.array([0, 2 * np.pi * turns + np.pi]))
        assert not same(np.array([1e-5, 2 * np.pi * turns]))
    assert not same(0.0, ClosingEquations(FIG9, read_word("P32"), 2))


# --- which of several roots is taken ---


class Roots:
    """Guesses whose roots are told: by the number that stands for the points."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, told: dict[float, dict[str, Any]]) -> None:
        self.told, self.asked = told, []
        monkeypatch.setattr(find, "solve", self.solve)
        monkeypatch.setattr(find, "failures", lambda _, points: self.of(points).get("failed", []))
        monkeypatch.setattr(find, "repetitions", lambda _, points: self.of(points).get("repeats", 1))
        monkeypatch.setattr(find, "_instead", lambda *_: "; and so on")

    def of(self, points: np.ndarray) -> dict[str, Any]:
        return self.told[float(points[0, 0])]

    def solve(self, equations: ClosingEquations, points: np.ndarray) -> Solution:
        self.asked.append(float(points[0, 0]))
        known = self.of(points)
        return Solution(points, known.get("residual", 0.0), 1, known.get("converged", True), "why")

    def best(self, equations: ClosingEquations, batches: list[list[float]]) -> float:
        guesses = [[Guess(np.full((2, 2), float(name)), 1, 0.0) for name in batch] for batch in batches]
        tried, root = find._best_root(equations, iter(guesses))
        assert tried.word == equations.word
        return float(root.points[0, 0])


def fails(*values: float) -> list[Condition]:
    return [Condition(0, "", value, 0.0, "", 0, 1.0) for value in values]


def test_the_first_orbit_is_taken_and_else_the_root_that_fails_least(monkeypatch: pytest.MonkeyPatch) -> None:
    told: dict[float, dict[str, Any]] = {
        1: {"converged": False, "residual": 0.5},
        2: {"failed": fails(-0.3, -5.0)},
        3: {"failed": fails(-0.4)},
        4: {"failed": fails(-0.1), "repeats": 2},
        5: {},
        6: {"repeats": 3},
        7: {"converged": False, "residual": 0.2},
    }
    damped, free = (ClosingEquations(FIG9.replace(c=c), read_word("P32"), 1) for c in ("1/10", 0))
    for equations, batches, taken, asked in (
        (damped, [[1, 2, 5], [3]], 5, [1, 2, 5]),
        (damped, [[2, 6], [5]], 6, [2, 6]),  # with damping a repeated orbit is the only one
        (free, [[2, 6, 3], [5]], 5, [2, 6, 3, 5]),  # without, a shorter one may be meant
        (free, [[2, 6, 3]], 6, [2, 6, 3]),
        (free, [[2], [4, 3]], 3, [2, 4, 3]),  # -5 is worse than -0.4
        (damped, [[4, 3, 2]], 3, [4, 3, 2]),
        (damped, [[4]], 4, [4]),
        (damped, [[2, 2, 3, 3]], 3, [2, 2, 3, 3]),
    ):
        roots = Roots(monkeypatch, told)
        assert roots.best(equations, batches) == taken
        assert roots.asked == asked
    with pytest.raises(ConvergenceError, match="why; and so on") as caught:
        Roots(monkeypatch, told).best(damped, [[1], [7, 1]])
    assert (caught.value.residual, caught.value.periods) == (0.2, 1)
    assert [x for _, x in caught.value.best] == [7.0, 7.0]
    with pytest.raises(ConvergenceError, match="no guess was found; and so on") as caught:
        Roots(monkeypatch, told).best(damped, [])
    assert (caught.value.best, caught.value.periods, caught.value.residual) == ((), 0, np.inf)


@pytest.mark.parametrize("periods", [None, 3])
def test_what_is_said_of_an_orbit(periods: int | None) -> None:
    """Every part of the message: the kind, the periods, the multiplier, the graze, repetitions."""
    equations = ClosingEquations(FIG9, read_word("P32"), periods or 1)
    span = "3 forcing periods" if periods else "1 forcing period"
    for stable, kind in ((True, "a stable"), (False, "an unstable"), (None, "a marginal")):
        for gap, size in ((0.25, "0.75"), (-0.5, "1.5"), (1e-7, "1 - 1e-07"), (-2e-9, "1 + 2e-09"), (None, "1")):
            far = " (no neighbour need come nearer)" if stable is None else ""
            for near, graze in ((0.12345, ", 0.123 in velocity away from grazing"), (np.inf, "")):
                for repeated, shorter in ((1, ""), (2, "; it runs 2 times through a shorter orbit")):
                    text = f"{kind} orbit of {span}, largest |multiplier| {size}{far}{graze}{shorter}"
                    assert find._message(equations, stable, gap, (), near, repeated) == text


def test_what_is_said_of_a_root_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    equations = ClosingEquations(FIG9, read_word("P32"), 1)
    monkeypatch.setattr(find, "_instead", lambda _, resting: f"; resting: {resting}")
    for rank, value, what, resting in (
        (0, -0.5, "fails by 0.5", False), (0, 0.0, "just fails", False), (3, 0.0, "just fails", False),
        (1, 0.0, "it has no length", True), (6, 0.0, "it has no length", True), (1, -2.0, "fails by 2", False),
    ):  # fmt: skip
        failed = (Condition(0, "F > 0", value, 1.25, "", rank, 1.0),)
        text = f"a root that is not an orbit (F > 0: {what} at t = 1.25); resting: {resting}"
        assert find._message(equations, None, None, failed, 1.0, 1) == text


def test_how_often_a_root_runs_through_a_shorter_orbit() -> None:
    """A word that repeats with its points, moved on by the parts of the whole period; else it is one orbit."""
    rng = np.random.default_rng(6)
    for times in (1, 2, 3, 6):
        for pieces in (2, 4):
            word = "P" + ("32" if pieces == 2 else "3232") * times
            part = np.column_stack([rng.uniform(-3, 3, pieces), np.sort(rng.uniform(0, 2 * np.pi, pieces))])
            points = np.vstack([part + np.array([0, 2 * np.pi * i]) for i in range(times)])
            equations = ClosingEquations(FIG9, read_word(word), times)
            assert find.repetitions(equations, points) == times
            if times > 1:
                row = int(rng.integers(len(points)))
                for column in (0, 1):
                    moved = points.copy()
                    moved[row, column] += 1e-5
                    assert find.repetitions(equations, moved) == 1
                other = ClosingEquations(FIG9, read_word(word), times + 1)
                assert find.repetitions(other, points) == 1


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P23"), (FIG10, "P6454"), (FIG10, "P5464")])
def test_an_orbit_begins_in_the_first_period(p: Parameters, word: str) -> None:
    """Also where its second point is in the next one already."""
    times = [t for t, _ in find_orbit(p, word).points]
    T = 2 * np.pi / float(p.Omega)
    assert 0 <= times[0] < T
    assert times == sorted(times)
    assert times[-1] < times[0] + T


@pytest.mark.parametrize("digits", [None, 20])
@pytest.mark.parametrize("word", ["P32", "P3232"])
def test_the_two_multipliers_are_those_of_the_flow(word: str, digits: int | None) -> None:
    """Their sum and their product are the trace and the determinant of the flow's derivative over the orbit."""
    orbit = find_orbit(FIG9, word, periods=len(word) // 2, digits=digits)
    one, other = (complex(value) for value in orbit.multipliers)
    flow = find.monodromy(orbit.equations(), orbit.phases())
    assert one + other == pytest.approx(float(flow.trace), rel=1e-9)
    assert one * other == pytest.approx(float(flow.determinant), rel=1e-9)
    assert abs(one) < 1
    assert abs(other) < 1


@pytest.mark.parametrize(("values", "resting"), [((0.0, -0.5), True), ((-0.5, 0.0), True), ((-0.5, -0.1), False)])
def test_one_stick_without_end_is_enough_to_ask_for_rest(
    values: tuple[float, float], resting: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever else fails: a stick of length 0 at a root may stand for one that lasts for ever."""
    asked: list[bool] = []
    monkeypatch.setattr(find, "_instead", lambda _, zero: asked.append(zero) or "; asked")
    failed = tuple(Condition(0, "a stick", value, 1.5, "event", STICK_LASTS, 1.0) for value in values)
    message = find._message(None, None, None, failed, 0.0, 1)  # type: ignore[arg-type]
    assert asked == [resting]
    assert message.startswith("a root that is not an orbit (a stick: ")
    assert message.count("it has no length at t = 1.5") == values.count(0.0)
    assert message.endswith("; asked")
