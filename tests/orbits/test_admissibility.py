"""What an orbit must satisfy, and where it does not."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise, product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from paper_orbits import BOTH_BELTS, FIG9, FIG10
from scipy.integrate import solve_ivp

from symosc import Parameters
from symosc.engine.state import Launch
from symosc.orbits import admissibility
from symosc.orbits.admissibility import Condition, conditions
from symosc.orbits.between import of_function
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.find import find_orbit
from symosc.words import read_word


def test_root_that_is_no_orbit_is_reported_with_where_and_by_how_much():
    """Below Omega = 3.2886 both crossings of P32 are stick conditions; the force says so by itself."""
    p = FIG9.replace(Omega=3)
    root = find_orbit(p, "P32")
    assert root.residual < 1e-11
    assert not root.admissible
    assert "settles to P1312" in root.message
    crossing = next(c for c in root.failures if "P3 crosses v1" in c.text)
    x, cosine = root.points[0].x, np.cos(float(p.Omega) * root.points[0].t)
    F1 = float((p.A(1) - p.c * p.v1) / p.m) + float(p.B0 / p.m) * cosine - float(p.k / p.m) * x
    assert F1 > 0  # Theorem 5 needs F^(1) < 0 for a downward crossing
    assert -crossing.value == pytest.approx(F1, rel=1e-10)
    assert crossing.t == pytest.approx(root.points[0].t + root.period, rel=1e-10)
    gap = next(c for c in root.failures if "P2 stays in Omega1" in c.text)
    assert root(gap.t)[1] == pytest.approx(float(p.v1) - gap.value, abs=1e-9)  # how far above v1 it gets


def test_conditions_come_in_the_same_order():
    orbit = find_orbit(FIG10, "P4645")
    texts = [c.text for c in orbit.conditions()]
    moved = orbit.phases() + np.array([0.0, 1e-3])
    assert texts == [c.text for c in conditions(orbit.equations(), moved)]
    assert all(c.value > 0 for c in orbit.conditions())


@pytest.mark.parametrize("word", ["P32", "P1748"])
@pytest.mark.parametrize("forces", [(0.3, 4.0, -7.0), (9.0, 0.2, 1.0), (0.1, -8.0, 0.5)])
def test_sizes_bound_all_terms_of_the_equation(forces: tuple[float, ...], word: str) -> None:
    """Whatever domain the orbit is in, on one belt or both: the sum of the sizes of the terms of its acceleration."""
    equations = ClosingEquations(FIG9, read_word(word), 1)
    equations.K = equations.K._replace(A1=forces[0], A2=forces[1], A3=forces[2])
    K, points = equations.K, [(4.0, 1.0), (-4.5, 3.0)]
    found = admissibility.scales(equations, points)
    speeds = [abs(equations.belt(piece.start).v) for piece in equations.pieces]
    terms = max(map(abs, forces)) + abs(K.f0) + K.cm * max(speeds) + K.w0sq * 4.5
    assert found.a == pytest.approx(terms, rel=1e-12)
    assert found.v == pytest.approx(terms / K.rate + max(speeds), rel=1e-12)
    assert found.t == 1 / K.rate


def test_the_nearest_graze_counts_all_flights(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least gap, of whichever flight: a smaller one elsewhere is not hidden by a larger one."""
    orbit = find_orbit(FIG9, "P32")
    equations = ClosingEquations(FIG9, read_word("P32"), 1)
    points = np.array([(point.x, float(FIG9.Omega) * point.t) for point in orbit.points])
    far = admissibility.grazing_distance(equations, points)
    gaps = [c.value for c in conditions(equations, points) if "stays in" in c.text]
    assert 0 < far <= min(gaps)
    for values in ((1e-9, 5.0), (5.0, 1e-9), (1e-9, 1e-3)):
        said = [SimpleNamespace(text="P3 stays in Omega2", value=value) for value in values]
        monkeypatch.setattr(admissibility, "conditions", lambda equations, points, said=said: said)
        assert admissibility.grazing_distance(equations, points) == 1e-9


# --- the margins against the equation of motion, integrated by other people's code ---

#: Words with flights from belt to belt, back to their own belt, after sticks and between crossings.
WORDS = ["P32", "P12", "P312", "P4645", "P1748", "P7482", "P174648"]


def integrated(p: Parameters, v: float, a: float, theta: float, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return v and v' along a flight, from m v'' + c v' + k v = -B0 Omega sin(theta + Omega t) alone."""
    m, c, k, B0, Om = (float(getattr(p, name)) for name in ("m", "c", "k", "B0", "Omega"))

    def rhs(t: float, state: np.ndarray) -> list[float]:
        return [state[1], -(c * state[1] + k * state[0] + B0 * Om * np.sin(theta + Om * t)) / m]

    done = solve_ivp(rhs, (0, times[-1]), [v, a], method="DOP853", rtol=1e-11, atol=1e-11, t_eval=times)
    return done.y[0], done.y[1]


def acceleration(p: Parameters, domain: int, x: float, v: float, theta: float) -> float:
    return float(p.A(domain) + p.B0 * Fraction(np.cos(theta)) - p.k * Fraction(x) - p.c * Fraction(v)) / float(p.m)


def drawn(rng: random.Random, word: str) -> tuple[Parameters, ClosingEquations, list[tuple[float, float]]]:
    """Return random parameters and points; the inequalities are asked for any points, not only for roots."""
    p = Parameters(
        m=f"{rng.uniform(0.5, 2):.3f}", c=f"{rng.uniform(0, 1):.3f}", k=f"{rng.uniform(0.5, 4):.3f}",
        A0=f"{rng.uniform(-3, 3):.3f}", B0=f"{rng.choice([-1, 1]) * rng.uniform(1, 6):.3f}",
        Omega=f"{rng.uniform(0.3, 2):.3f}", v1=f"{rng.uniform(-2, 0.5):.3f}", v2=f"{rng.uniform(0.6, 3):.3f}",
        mu1="0.5", mu2="0.4", FN=f"{rng.uniform(2, 8):.3f}",
    )  # fmt: skip
    equations = ClosingEquations(p, read_word(word), rng.choice([1, 1, 3]))
    n, begin = len(equations.pieces), rng.uniform(-3, 9)
    cuts = sorted(float(equations.turn) * rng.random() ** rng.choice([1, 3]) for _ in range(n - 1))
    return p, equations, [(rng.uniform(-3, 3), begin + cut) for cut in (0.0, *cuts)]


def flight_margins(p: Parameters, equations: ClosingEquations, i: int, points: Any) -> tuple[list[float], float]:
    """Return duration, arrival, gap and what lies beyond, of a flight; and when the gap is least."""
    piece, (x, theta), (x_end, theta_end) = equations.pieces[i], points[i], equations.ends(points)[i]
    v, v_end, tau = float(p.belt(piece.start)), float(p.belt(piece.end)), (theta_end - theta) / float(p.Omega)
    times = np.linspace(0, tau, 6000)
    speed, slope = integrated(
        p, v, 0.0 if piece.after_stick else acceleration(p, piece.mode, x, v, theta), theta, times
    )
    gap, nearest = np.inf, theta_end / float(p.Omega)
    first = 1 if piece.after_stick else 0
    for j in np.flatnonzero((slope[first:-1] > 0) != (slope[first + 1 :] > 0)) + first:
        part = slope[j] / (slope[j] - slope[j + 1])
        turn = speed[j] + 0.5 * part * (times[j + 1] - times[j]) * slope[j]
        belt = (piece.mode - 1) if slope[j] < 0 else piece.mode  # a minimum is turned to the belt below
        away = (
            abs(turn - float(p.belt(belt))) * np.sign((turn - float(p.belt(belt))) * -np.sign(slope[j]))
            if (belt in (1, 2))
            else np.inf
        )
        if away < gap:
            gap, nearest = away, theta / float(p.Omega) + times[j] + part * (times[1] - times[0])
    arrival = slope[-1] if piece.zeros == 2 else acceleration(p, piece.mode, x_end, v_end, theta_end)
    beyond = piece.side * acceleration(p, piece.mode + piece.side, x_end, v_end, theta_end)
    following = equations.pieces[(i + 1) % len(points)]
    return [tau, piece.side * arrival, gap, -beyond if following.sticks else beyond], nearest


def stick_margins(p: Parameters, equations: ClosingEquations, i: int, points: Any) -> tuple[list[float], float]:
    """Return duration, the least force where the forces turn, and the slope of the one that ends a stick."""
    piece, (x, theta), (_, theta_end) = equations.pieces[i], points[i], equations.ends(points)[i]
    v, tau = float(p.belt(piece.start)), (theta_end - theta) / float(p.Omega)
    times = np.linspace(0, tau, 20001)
    m, c, k, B0 = (float(getattr(p, name)) for name in ("m", "c", "k", "B0"))
    drive = B0 * np.cos(theta + float(p.Omega) * times) - k * (x + v * times) - c * v
    below, above = ((float(p.A(domain)) + drive) / m for domain in (piece.start, piece.start + 1))
    turns = 1 + np.flatnonzero((np.diff(below)[:-1] > 0) != (np.diff(below)[1:] > 0))
    least = np.minimum(below, -above)[turns]
    slope = -piece.side * (k * v + B0 * float(p.Omega) * np.sin(theta_end)) / m
    if not len(turns):
        return [tau, np.inf, slope], theta_end / float(p.Omega)
    return [tau, float(least.min()), slope], theta / float(p.Omega) + times[turns[int(least.argmin())]]


def said(equations: ClosingEquations, i: int) -> list[tuple[str, str, int]]:
    """Return what the inequalities of a piece are called, what their failing means, and what explains what."""
    piece, following = equations.pieces[i], equations.pieces[(i + 1) % len(equations.pieces)]
    name, low, high = piece.label, piece.start, piece.start + 1
    if piece.sticks:
        ends = f"F^({high}) rises" if piece.side > 0 else f"F^({low}) falls"
        return [
            (f"{name} lasts", "vanishing of a stick", 1),
            (f"F^({low}) > 0 > F^({high}) during {name} (Theorem 4)", "birth of a slip", 4),
            (f"{ends} where {name} ends", "vanishing of a slip", 2),
        ]
    sign, other, far = ("><" if piece.side > 0 else "<>") + str(piece.mode + piece.side)
    behind = (f"F^({far}) {sign} 0 where {name} crosses v{piece.end} (Theorem 5)", "birth of a stick", 3)
    if following.sticks:
        behind = (f"F^({far}) {other} 0 at the onset of {following.label} (Theorem 4)", "birth of a slip", 4)
    short = piece.after_stick and piece.start == piece.end
    return [
        (f"{name} lasts", "vanishing of a flight", 6),
        (f"{name} meets v{piece.end} with F^({piece.mode}) {sign} 0", "grazing", 5 if short else 0),
        (f"{name} stays in Omega{piece.mode}", "grazing", 5),
        behind,
    ]


def sizes(equations: ClosingEquations, i: int, points: Any, tau: float) -> list[float]:
    """Return the sizes that the margins of a piece are measured by: of short flights they are smaller."""
    piece, K, whole = equations.pieces[i], equations.K, admissibility.scales(equations, points)
    if piece.sticks:
        return [whole.t, whole.a, abs(equations.belt(piece.start).drift) + abs(K.fB)]
    part = min(1.0, tau * K.rate)
    return [whole.t, whole.a * (part if piece.zeros == 2 else 1), whole.v * part, whole.a]


@pytest.mark.parametrize("word", WORDS)
def test_margins_are_those_of_the_equation_of_motion(word: str) -> None:
    """Of random points of random systems: every inequality of every piece, and when it is closest to failing."""
    rng, turned = random.Random(f"margins {word}"), 0
    for _ in range(6):
        p, equations, points = drawn(rng, word)
        found = conditions(equations, points)
        for i, piece in enumerate(equations.pieces):
            mine = [c for c in found if c.piece == i]
            values, nearest = (stick_margins if piece.sticks else flight_margins)(p, equations, i, points)
            assert len(mine) == len(values)
            size = 1 + max(abs(value) for value in values if abs(value) < np.inf)
            for c, value in zip(mine, values, strict=True):
                assert c.value == pytest.approx(value, abs=2e-5 * size), (p, c)
            (gap,) = (c for c in mine if of_function(c))
            assert gap.t == pytest.approx(nearest, abs=1e-2) or gap.value == np.inf
            turned += gap.value < np.inf
            tau = values[0]
            assert [(c.text, c.event, c.rank) for c in mine] == said(equations, i)
            assert [c.scale for c in mine] == pytest.approx(sizes(equations, i, points, tau), rel=1e-12)
            end = equations.ends(points)[i][1] / float(p.Omega)
            assert all(c.t == pytest.approx(end, rel=1e-12) for c in mine if c is not gap)
    assert turned > 3


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748")])
def test_the_distance_from_grazing_is_that_of_the_nearest_turn(p: Parameters, word: str) -> None:
    """The turns before the end of each flight, and the first one that the flight would have behind its end."""
    orbit = find_orbit(p, word)
    equations, points = orbit.equations(), [tuple(point) for point in orbit.phases().tolist()]
    nearest = min(
        flight_margins(p, equations, i, points)[0][2] for i in range(len(points)) if not equations.pieces[i].sticks
    )
    for i, (piece, (x, theta)) in enumerate(zip(equations.pieces, points, strict=True)):
        if piece.sticks:
            continue
        tau = (equations.ends(points)[i][1] - theta) / float(p.Omega)
        times = np.linspace(0, tau + orbit.period, 12000)
        v = float(p.belt(piece.start))
        a = 0.0 if piece.after_stick else acceleration(p, piece.mode, x, v, theta)
        speed, slope = integrated(p, v, a, theta, times)
        turns = [j for j in np.flatnonzero((slope[:-1] > 0) != (slope[1:] > 0)) if times[j] > tau]
        nearest = min(nearest, *(abs(speed[j] - float(p.belt(piece.end))) for j in turns[:1]), np.inf)
    assert orbit.grazing_distance == pytest.approx(nearest, rel=1e-3)


def test_what_fails_first_is_what_explains_the_rest() -> None:
    """Failing is a value that is not positive, 0 and nan too; the lowest rank comes first, equals in their order."""
    rng = random.Random(5)
    for _ in range(20):
        values = [rng.choice([-1.0, 0.0, 1e-300, 2.0, np.nan]) for _ in range(9)]
        rows = [Condition(i, "", value, 0.0, "", rng.randrange(4), 1.0) for i, value in enumerate(values)]
        right = [c for rank in range(4) for c in rows if c.rank == rank and (c.value <= 0 or np.isnan(c.value))]
        assert [c.piece for c in admissibility.failing(rows)] == [c.piece for c in right]


def test_each_turn_is_found_once_also_just_on_a_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    """Signs of the acceleration at nine samples, made up: between neighbours apart from zeros that differ is a turn."""
    equations, rng = ClosingEquations(FIG9, read_word("P32"), 1), random.Random(7)
    monkeypatch.setattr(admissibility, "_extremum", lambda low, high, falls, *_: (low, high, bool(falls)))
    tau = 8.0 * admissibility.SAMPLE / equations.K.rate
    with_zeros = 0
    for _ in range(200):
        signs = [rng.choice([-1.0, 0.0, 1.0]) for _ in range(8)] + [rng.choice([-1.0, 1.0])]
        monkeypatch.setattr(admissibility, "motion", lambda *_, signs=signs: (None, None, np.array(signs)))
        found = admissibility.extrema(0.0, tau, (0.0, 1.0, 0.0, 1.0), False, equations)
        clear = [i for i, sign in enumerate(signs) if sign]
        turns = [(i, k) for i, k in pairwise(clear) if signs[i] != signs[k]]
        assert len(found) == len(turns)
        for (low, high, falls), (i, k) in zip(found, turns, strict=True):
            assert tau / 8 * i <= low < high <= tau / 8 * k
            assert falls == (signs[i] > 0)
            with_zeros += k > i + 1
    assert with_zeros > 100


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_turn_is_placed_in_a_few_steps_wherever_it_lies_in_its_bracket(sign: float) -> None:
    """Made-up accelerations: nearly straight, with a slope of 0 in the middle, and one that misleads Newton."""
    laws = {
        "straight": (lambda s, at: s - at + 0.1 * (s - at) ** 2, lambda s, at: 1 + 0.2 * (s - at), 9),
        "flat": (lambda s, at: (s - 0.5) ** 3 - (at - 0.5) ** 3, lambda s, at: 3 * (s - 0.5) ** 2, 60),
        "bent": (lambda s, at: np.arctan(50 * (s - at)), lambda s, at: 50 / (1 + (50 * (s - at)) ** 2), 15),
    }
    for (name, (law, slope, most)), at in product(laws.items(), (0.03, 0.3, 0.5, 0.77, 0.98)):
        looked: list[float] = []

        def state(tau: float, *_: object, law: Any = law, slope: Any = slope, at: float = at) -> SimpleNamespace:
            looked.append(tau)  # noqa: B023
            return SimpleNamespace(F=sign * law(tau, at), G1=sign * slope(tau, at), dv=7.0 * tau)

        names = {"state_at": state, "EPS": 2.0**-52}
        equations: Any = SimpleNamespace(arithmetic=SimpleNamespace(namespace=names), K=None, exact=None)
        found = admissibility._extremum(0.0, 1.0, sign < 0, Launch(2.0, 0.0, 0.0, 1.0), equations)
        assert found.tau == pytest.approx(at, abs=1e-5 if name == "flat" and at == 0.5 else 1e-13)
        assert found.v == pytest.approx(2.0 + 7.0 * found.tau)
        assert found.b == pytest.approx(sign * slope(found.tau, at), abs=1e-9)
        assert len(looked) <= most


def test_what_holds_a_stick_is_least_at_an_end_or_where_the_force_turns() -> None:
    """The turns inside a stick count, not one with which it begins or ends: these have conditions of their own."""
    equations = ClosingEquations(FIG10, read_word("P4645"), 1)
    piece = next(each for each in equations.pieces if each.sticks)
    K, belt, x = equations.K, equations.belt(piece.start), 1.5
    assert belt.turns
    forces = np.vectorize(
        lambda theta, since: equations.force(piece.start, x + belt.v * (theta - since) / K.Om, belt.v, theta)
    )
    angles = sorted((belt.angle % (2 * np.pi), (np.pi - belt.angle) % (2 * np.pi)))
    for begin, length, inside in (
        (angles[0] - 0.1, 0.3, 1), (angles[0], 0.3, 0), (angles[0] - 0.3, 0.2, 0), (angles[1] - 0.2, 0.5, 1),
        (angles[0] - 0.1, angles[1] - angles[0] + 0.2, 2), (angles[0] - 0.1, 2 * np.pi + 0.2, 3),
    ):  # fmt: skip
        conditions: dict[str, tuple[float, float]] = {}
        margins: Any = SimpleNamespace(
            add=lambda text, value, theta, *_: conditions.update({text: (value, theta)}),  # noqa: B023
            sizes=SimpleNamespace(t=1.0, a=1.0),
        )
        admissibility._of_stick(margins, piece, (x, begin), (x, begin + length), equations)
        hold, nearest = next(found for text, found in conditions.items() if "during" in text)
        if not inside:
            assert hold == np.inf
            continue
        phases = np.linspace(begin + 1e-6, begin + length - 1e-6, 200_001)
        force = forces(phases[::100], begin)
        room = np.minimum(force, belt.J - force)
        turns = [i for i in range(1, len(room) - 1) if (force[i] - force[i - 1]) * (force[i + 1] - force[i]) <= 0]
        assert len(turns) == inside
        least = min(turns, key=lambda i: room[i])
        assert hold == pytest.approx(room[least], abs=1e-4)
        assert nearest == pytest.approx(phases[::100][least], abs=0.01)
