"""Which roots are orbits.

The margins of their inequalities, in any units, and whether the motion closes.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from branches import branch_of
from paper_orbits import BOTH_BELTS, FIG9, FIG10
from scipy.integrate import solve_ivp
from units import UNITS, Units

from symosc import Parameters, simulate
from symosc.base.errors import ParameterError
from symosc.orbits import admissibility
from symosc.orbits.admissibility import concerns_whole_piece, conditions, extrema
from symosc.orbits.closing_equations import ClosingEquations, ConvergenceError, polish, solve
from symosc.orbits.find import find_orbit, orbit_at
from symosc.orbits.floquet import rest_positions
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.words import WordError, read_word


def test_root_that_is_no_orbit_is_reported_with_where_and_by_how_much():
    """Below Omega = 3.2886 both crossings of P32 are stick conditions.

    The force says so by itself.
    """
    p = FIG9.replace(Omega=3)
    root = find_orbit(p, "P32")
    assert root.residual < 1e-11
    assert not root.admissible
    assert "settles to P3121" in root.message
    crossing = next(c for c in root.failures if "P3 crosses v1" in c.text)
    x = root.points[0].x
    cosine = np.cos(float(p.Omega) * root.points[0].t)
    F1 = float((p.A(1) - p.c * p.v1) / p.m) + float(p.B0 / p.m) * cosine - float(p.k / p.m) * x
    assert F1 > 0  # Theorem 5 needs F^(1) < 0 for a downward crossing
    assert -crossing.value == pytest.approx(F1, rel=1e-10)
    assert crossing.t == pytest.approx(root.points[0].t + root.period, rel=1e-10)
    gap = next(c for c in root.failures if "P2 stays in Omega1" in c.text)
    assert root(gap.t)[1] == pytest.approx(
        float(p.v1) - gap.value, abs=1e-9
    )  # how far above v1 it gets


#: Words with flights from belt to belt, back to their own belt, after sticks and between crossings.
WORDS = ["P32", "P12", "P312", "P4645", "P1748", "P7482", "P174648"]


def integrated(
    p: Parameters, v: float, a: float, theta: float, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return v and v' along a flight, from m v'' + c v' + k v = -B0 Omega sin(theta + Omega t) alone."""
    m, c, k, B0, Om = (float(getattr(p, name)) for name in ("m", "c", "k", "B0", "Omega"))

    def rhs(t: float, state: np.ndarray) -> list[float]:
        return [state[1], -(c * state[1] + k * state[0] + B0 * Om * np.sin(theta + Om * t)) / m]

    done = solve_ivp(
        rhs, (0, times[-1]), [v, a], method="DOP853", rtol=1e-11, atol=1e-11, t_eval=times
    )
    return done.y[0], done.y[1]


def acceleration(p: Parameters, domain: int, x: float, v: float, theta: float) -> float:
    return float(
        p.A(domain) + p.B0 * Fraction(np.cos(theta)) - p.k * Fraction(x) - p.c * Fraction(v)
    ) / float(p.m)


def drawn(
    rng: random.Random, word: str
) -> tuple[Parameters, ClosingEquations, list[tuple[float, float]]]:
    """Return random parameters and points.

    The inequalities are asked for any points, not only for roots.
    """
    p = Parameters(
        m=f"{rng.uniform(0.5, 2):.3f}", c=f"{rng.uniform(0, 1):.3f}", k=f"{rng.uniform(0.5, 4):.3f}",
        A0=f"{rng.uniform(-3, 3):.3f}", B0=f"{rng.choice([-1, 1]) * rng.uniform(1, 6):.3f}",
        Omega=f"{rng.uniform(0.3, 2):.3f}", v1=f"{rng.uniform(-2, 0.5):.3f}", v2=f"{rng.uniform(0.6, 3):.3f}",
        mu1="0.5", mu2="0.4", FN=f"{rng.uniform(2, 8):.3f}",
    )  # fmt: skip
    equations = ClosingEquations(p, read_word(word), rng.choice([1, 1, 3]))
    n = len(equations.pieces)
    begin = rng.uniform(-3, 9)
    cuts = sorted(float(equations.turn) * rng.random() ** rng.choice([1, 3]) for _ in range(n - 1))
    return p, equations, [(rng.uniform(-3, 3), begin + cut) for cut in (0.0, *cuts)]


def flight_margins(
    p: Parameters, equations: ClosingEquations, i: int, points: Any
) -> tuple[list[float], float]:
    """Return duration, arrival, gap and what lies beyond, of a flight.

    And when the gap is least.
    """
    piece = equations.pieces[i]
    (x, theta) = points[i]
    (x_end, theta_end) = equations.ends(points)[i]
    v = float(p.belt(piece.start))
    v_end = float(p.belt(piece.end))
    tau = (theta_end - theta) / float(p.Omega)
    times = np.linspace(0, tau, 6000)
    speed, slope = integrated(
        p, v, 0.0 if piece.after_stick else acceleration(p, piece.mode, x, v, theta), theta, times
    )
    gap = np.inf
    nearest = theta_end / float(p.Omega)
    if piece.after_stick:
        first = 1
    else:
        first = 0
    for j in np.flatnonzero((slope[first:-1] > 0) != (slope[first + 1 :] > 0)) + first:
        part = slope[j] / (slope[j] - slope[j + 1])
        turn = speed[j] + 0.5 * part * (times[j + 1] - times[j]) * slope[j]
        # a minimum is turned to the belt below
        if slope[j] < 0:
            belt = piece.mode - 1
        else:
            belt = piece.mode
        if belt in (1, 2):
            away = abs(turn - float(p.belt(belt))) * np.sign(
                (turn - float(p.belt(belt))) * -np.sign(slope[j])
            )
        else:
            away = np.inf
        if away < gap:
            gap = away
            nearest = theta / float(p.Omega) + times[j] + part * (times[1] - times[0])
    if piece.zeros == 2:
        arrival = slope[-1]
    else:
        arrival = acceleration(p, piece.mode, x_end, v_end, theta_end)
    beyond = piece.side * acceleration(p, piece.mode + piece.side, x_end, v_end, theta_end)
    following = equations.pieces[(i + 1) % len(points)]
    return [tau, piece.side * arrival, gap, -beyond if following.sticks else beyond], nearest


def stick_margins(
    p: Parameters, equations: ClosingEquations, i: int, points: Any
) -> tuple[list[float], float]:
    """Return duration, the least force where the forces turn, and the slope of the one that ends a stick."""
    piece = equations.pieces[i]
    (x, theta) = points[i]
    (_, theta_end) = equations.ends(points)[i]
    v = float(p.belt(piece.start))
    tau = (theta_end - theta) / float(p.Omega)
    times = np.linspace(0, tau, 20001)
    m, c, k, B0 = (float(getattr(p, name)) for name in ("m", "c", "k", "B0"))
    drive = B0 * np.cos(theta + float(p.Omega) * times) - k * (x + v * times) - c * v
    below, above = ((float(p.A(domain)) + drive) / m for domain in (piece.start, piece.start + 1))
    turns = 1 + np.flatnonzero((np.diff(below)[:-1] > 0) != (np.diff(below)[1:] > 0))
    least = np.minimum(below, -above)[turns]
    slope = -piece.side * (k * v + B0 * float(p.Omega) * np.sin(theta_end)) / m
    if not len(turns):
        return [tau, np.inf, slope], theta_end / float(p.Omega)
    return [tau, float(least.min()), slope], theta / float(p.Omega) + times[
        turns[int(least.argmin())]
    ]


def said(equations: ClosingEquations, i: int) -> list[tuple[str, str, int]]:
    """Return what the inequalities of a piece are called, what their failing means, and what explains what."""
    piece = equations.pieces[i]
    following = equations.pieces[(i + 1) % len(equations.pieces)]
    name = piece.label
    low = piece.start
    high = piece.start + 1
    if piece.sticks:
        if piece.side > 0:
            ends = f"F^({high}) rises"
        else:
            ends = f"F^({low}) falls"
        return [
            (f"{name} has positive duration", "vanishing of a stick", 1),
            (f"F^({low}) > 0 > F^({high}) during {name} (Theorem 4)", "birth of a slip", 4),
            (f"{ends} where {name} ends", "vanishing of a slip", 2),
        ]
    sign, other, far = ("><" if piece.side > 0 else "<>") + str(piece.mode + piece.side)
    behind = (
        f"F^({far}) {sign} 0 where {name} crosses v{piece.end} (Theorem 5)",
        "birth of a stick",
        3,
    )
    if following.sticks:
        behind = (
            f"F^({far}) {other} 0 at the onset of {following.label} (Theorem 4)",
            "birth of a slip",
            4,
        )
    short = piece.after_stick and piece.start == piece.end
    return [
        (f"{name} has positive duration", "vanishing of a flight", 6),
        (f"{name} meets v{piece.end} with F^({piece.mode}) {sign} 0", "grazing", 5 if short else 0),
        (f"{name} stays in Omega{piece.mode}", "grazing", 5),
        behind,
    ]


def sizes(equations: ClosingEquations, i: int, points: Any, tau: float) -> list[float]:
    """Return the sizes that the margins of a piece are measured by.

    Of short flights they are smaller.
    """
    piece = equations.pieces[i]
    K = equations.K
    whole = admissibility.scales(equations, points)
    if piece.sticks:
        return [whole.t, whole.a, abs(equations.belt(piece.start).drift) + abs(K.fB)]
    part = min(1.0, tau * K.rate)
    return [whole.t, whole.a * (part if piece.zeros == 2 else 1), whole.v * part, whole.a]


@pytest.mark.quick(3)
@pytest.mark.parametrize("word", WORDS)
def test_margins_are_those_of_the_equation_of_motion(word: str) -> None:
    """Of random points of random systems.

    Every inequality of every piece, and when it is closest to failing.
    """
    rng = random.Random(f"margins {word}")
    turned = 0
    for _ in range(6):
        p, equations, points = drawn(rng, word)
        tested = conditions(equations, points)
        for i, piece in enumerate(equations.pieces):
            mine = [c for c in tested if c.piece == i]
            values, nearest = (stick_margins if piece.sticks else flight_margins)(
                p, equations, i, points
            )
            assert len(mine) == len(values)
            size = 1 + max(abs(value) for value in values if abs(value) < np.inf)
            for c, value in zip(mine, values, strict=True):
                assert c.value == pytest.approx(value, abs=2e-5 * size), (p, c)
            (gap,) = (c for c in mine if concerns_whole_piece(c))
            assert gap.t == pytest.approx(nearest, abs=1e-2) or gap.value == np.inf
            turned += gap.value < np.inf
            tau = values[0]
            assert [(c.text, c.event, c.rank) for c in mine] == said(equations, i)
            assert [c.scale for c in mine] == pytest.approx(
                sizes(equations, i, points, tau), rel=1e-12
            )
            end = equations.ends(points)[i][1] / float(p.Omega)
            assert all(c.t == pytest.approx(end, rel=1e-12) for c in mine if c is not gap)
    assert turned > 3


@pytest.mark.parametrize(("p", "word"), [(FIG10, "P4645"), (BOTH_BELTS, "P1748")])
def test_the_distance_from_grazing_is_that_of_the_nearest_turn(p: Parameters, word: str) -> None:
    """The turns before the end of each flight, and the first one that the flight would have behind its end."""
    orbit = find_orbit(p, word)
    equations = orbit.equations()
    points = [tuple(point) for point in orbit.phases().tolist()]
    nearest = min(
        flight_margins(p, equations, i, points)[0][2]
        for i in range(len(points))
        if not equations.pieces[i].sticks
    )
    for i, (piece, (x, theta)) in enumerate(zip(equations.pieces, points, strict=True)):
        if piece.sticks:
            continue
        tau = (equations.ends(points)[i][1] - theta) / float(p.Omega)
        times = np.linspace(0, tau + orbit.period, 12000)
        v = float(p.belt(piece.start))
        if piece.after_stick:
            a = 0.0
        else:
            a = acceleration(p, piece.mode, x, v, theta)
        speed, slope = integrated(p, v, a, theta, times)
        turns = [j for j in np.flatnonzero((slope[:-1] > 0) != (slope[1:] > 0)) if times[j] > tau]
        nearest = min(
            nearest, *(abs(speed[j] - float(p.belt(piece.end))) for j in turns[:1]), np.inf
        )
    assert orbit.grazing_distance == pytest.approx(nearest, rel=1e-3)


RESTING = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=5, mu1=1, mu2=1, FN=1)
CRITICAL = Parameters(
    m=1,
    k=1,
    c=2,
    Omega=1,
    A0="36.68",
    B0=1,
    FN="18.89",
    mu1="0.2934",
    mu2="0.3",
    v1="-0.002295",
    v2=0,
)
UNDAMPED = Parameters(m=1, c=0, k=1, A0=0, B0=1, Omega="1/2", v1=0, v2=10, mu1="0.1", mu2=0, FN=1)


def closes(orbit: PeriodicOrbit) -> bool:
    """Return whether a simulation from a switching that ends a flight follows the word and returns, by itself."""
    pieces = orbit.equations().pieces
    p = orbit.parameters
    i = next(j for j in range(len(pieces)) if not pieces[j - 1].sticks)
    t0, x0 = orbit.points[i]
    if orbit.digits is None:
        digits = None
    else:
        digits = orbit.digits - 5
    end = t0 + orbit.period * (1 + 1e-6)
    path = simulate(p, t0=t0, x0=x0, v0=p.belt(pieces[i].start), t_end=end, digits=digits)
    labels = [segment.label for segment in path.segments if segment.label]
    last = path.events[-1]
    near = abs(last.t - t0 - orbit.period) < 1e-6 * orbit.period and abs(last.x - x0) < 1e-6 * max(
        1, abs(x0)
    )
    return bool(near) and labels == [*orbit.labels[i:], *orbit.labels[:i]]


@pytest.mark.slow
@pytest.mark.parametrize(("p", "word", "belt"), [(RESTING, "P13", 1), (CRITICAL, "P45", 2)])
def test_a_mass_that_rests_for_ever_is_no_orbit_of_a_word(p, word, belt):
    root = find_orbit(p, word)
    assert not root.admissible
    assert "it has no length" in root.message
    low, high = rest_positions(p, belt)
    assert (
        f"stays on belt {belt}, where every x from {float(low):.6g} to {float(high):.6g}"
        in root.message
    )
    assert root.stable is None  # a multiplier is 1


def test_rest_positions():
    """The mass stays on a belt at rest from every x of the interval, and from none outside."""
    rng = random.Random(4)
    for _ in range(8):
        belt = rng.choice([1, 2])
        p = RESTING.replace(
            A0=f"{rng.uniform(-2, 2):.3g}", B0=f"{rng.uniform(-0.4, 0.4):.3g}", mu1="0.9", mu2="0.6",
            k=f"{rng.uniform(0.5, 3):.3g}", v1=0 if belt == 1 else -3, v2=0 if belt == 2 else 3,
        )  # fmt: skip
        low, high = rest_positions(p, belt)
        assert high - low == 2 * ((p.mu1 if belt == 1 else p.mu2) * p.FN - abs(p.B0)) / p.k
        part = (high - low) / 1000
        for x, stays in (
            (low + part, True),
            (high - part, True),
            (low - part, False),
            (high + part, False),
        ):
            path = simulate(p, t0=0, x0=x, v0=0, t_end=50)
            assert (path.status == "equilibrium" and not path.events) == stays
    assert rest_positions(FIG9, 1) is None
    assert rest_positions(RESTING.replace(B0=2), 1) is None


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(1, 7))
def test_other_systems_with_a_belt_at_rest(seed):
    """The family of the examples.

    Friction that holds the mass, and short words with a stick on that belt.
    """
    rng = random.Random(seed)
    for _ in range(1):
        belt = rng.choice([1, 2])
        p = Parameters(
            m=f"{rng.uniform(0.5, 2):.4g}", c=f"{rng.uniform(0.1, 2):.4g}", k=f"{rng.uniform(0.5, 3):.4g}",
            A0=f"{rng.uniform(-5, 5):.4g}", B0=f"{rng.uniform(0.1, 0.9):.4g}", Omega=f"{rng.uniform(0.5, 2):.4g}",
            v1=0 if belt == 1 else "-0.01", v2=0 if belt == 2 else "0.01", mu1="0.6", mu2="0.7", FN=2,
        )  # fmt: skip
        for word in ("P12", "P13") if belt == 1 else ("P45", "P46"):
            try:
                root = find_orbit(p, word)
            except ConvergenceError:
                continue
            assert not root.admissible, (p, word)


@pytest.mark.parametrize(
    "seed", [1, *(pytest.param(seed, marks=pytest.mark.campaign) for seed in range(2, 7))]
)
def test_admissible_orbits_close(seed):
    """What random systems do, solved for: each is an orbit, stable, and closes."""
    rng = random.Random(f"closing {seed}")
    result = 0
    while result < 4:
        p = FIG10.replace(
            Omega=f"{rng.uniform(0.7, 4):.4g}", c=rng.choice(["0.2", "1.5", "4"]), v1=f"{rng.uniform(-5, 0.5):.3g}",
            v2=f"{rng.uniform(0.6, 8):.3g}", FN=f"{rng.uniform(0.5, 12):.3g}", m=f"{rng.uniform(0.1, 1):.3g}",
        )  # fmt: skip
        T = 2 * np.pi / float(p.Omega)
        path = simulate(p, t0=0, x0=0, v0=0, t_end=15 * T)
        labels = [s.label for s in path.segments if s.label and float(s.t_end) > 14 * T]
        try:
            orbit = find_orbit(p, labels[::-1])
        except (ConvergenceError, WordError):  # it has not settled yet
            continue
        assert orbit.admissible == (not orbit.failures)
        if orbit.admissible:
            result += 1
            assert orbit.stable is True
            assert closes(orbit), p


@pytest.mark.slow
def test_margins_are_decided_in_more_digits_where_doubles_cannot():
    """P32 of fig9 grazes v2 at one value of v2.

    A little above it is an orbit, a little below it is not.
    """
    orbit = find_orbit(FIG9, "P32", digits=40)
    fine = orbit.equations().with_digits(40)
    points = polish(fine, orbit.phases()).points
    gap = next(c for c in conditions(fine, points) if "P3 stays in" in c.text)
    i = gap.piece
    piece = fine.pieces[i]
    start = points[i]
    tau = (fine.ends(points)[i][1] - start[1]) / fine.K.Om
    top = max(e.v for e in extrema(0 * tau, tau, fine.start_of_flight(piece, start), False, fine))
    for shift, holds in (("1e-14", True), ("1e-17", True), ("-1e-17", False), ("-1e-14", False)):
        v2 = fine.number(top) + fine.number(shift)
        assert find_orbit(FIG9.replace(v2=v2), "P32").admissible == holds, shift


@pytest.mark.slow
def test_a_multiplier_of_1_is_marginal():
    """Omega = w0/2 without damping.

    Turning points x + 4/3 and x - 4/3 for every x of an interval.
    """
    orbit = find_orbit(UNDAMPED.replace(mu1="0.2"), "P32")
    assert (orbit.admissible, orbit.stable) == (True, None)
    assert "a marginal orbit" in orbit.message
    assert abs(orbit.points[0].x - orbit.points[1].x) == pytest.approx(8 / 3, rel=1e-9)
    assert closes(orbit)
    assert not find_orbit(UNDAMPED.replace(mu1="0.2"), "P132").admissible  # its stick has no length
    orbit = find_orbit(UNDAMPED.replace(Omega="1.5"), "P32")
    assert orbit.stable is True


def test_damping_however_weak_makes_an_orbit_stable():
    for c in ("1e-3", "1e-7", "1e-12"):
        orbit = find_orbit(UNDAMPED.replace(c=c), "P32")
        assert orbit.admissible
        assert orbit.stable is True
        assert "a stable orbit" in orbit.message
        assert "|multiplier| 1," not in orbit.message


@pytest.mark.slow
def test_rounding_noise_is_overcome_with_more_digits():
    """Near the birth of a slip doubles cannot improve on its duration.

    The root is found all the same.
    """
    branch = branch_of(FIG10.replace(B0="5.12"), "P4645", "B0", ("5", "5.17"))
    assert branch.ends[0].kind == "vanishing of a slip"
    for i in range(4):
        p = branch.parameters(i)
        equations = ClosingEquations(p, read_word("P6454"), 1)
        points = branch.points[i][:, ::-1] * np.array([1.0, float(p.Omega)])
        solution = solve(equations, points)
        assert solution.converged
        assert orbit_at(equations, solution).admissible


def test_a_guess_may_have_pieces_that_are_about_to_vanish():
    orbit = find_orbit(FIG10, "P4645")
    guess = np.array(orbit.points)
    assert np.allclose(np.array(find_orbit(FIG10, "P4645", guess).points), guess)
    with pytest.raises(ParameterError, match="times must increase"):
        find_orbit(FIG10, "P4645", guess[::-1])


ORBITS = [
    (p, word, find_orbit(p, word))
    for p, word in ((FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748"))
]


@pytest.mark.quick(2)
@pytest.mark.parametrize("units", UNITS, ids=str)
def test_an_orbit_is_found_in_any_units(units: Units) -> None:
    """Without a guess, to nearly all digits, with all that is said of it."""
    for p, word, orbit in ORBITS[:2]:
        result = find_orbit(units.of(p), word)
        assert (result.admissible, result.stable) == (True, True)
        assert result.multipliers == pytest.approx(orbit.multipliers, rel=1e-9, abs=1e-12)
        assert result.grazing_distance == pytest.approx(
            orbit.grazing_distance * units.speed, rel=1e-9
        )
        for (t, x), (t_found, x_found) in zip(orbit.points, result.points, strict=True):
            assert (t_found, x_found) == pytest.approx(
                (t * float(units.time), x * float(units.length)), rel=1e-10
            )
