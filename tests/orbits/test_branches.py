"""Branches of orbits: where and why they end, seen from both sides and judged by the oracle.

Nothing fails unseen.
"""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from branches import branch_of
from oracle import simulate_oracle
from paper_orbits import BOTH_BELTS
from parameter_sets import SHRINKS
from scipy.optimize import minimize_scalar

from symosc import Parameters, load_scene, simulate
from symosc.engine.flow import state_at
from symosc.orbits import branch as branches
from symosc.orbits.branch import Branch, continue_orbit
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit

FIG9 = load_scene("fig9").parameters
FIG10 = load_scene("fig10").parameters


# One bifurcation, met from its two sides by the branches of two words: parameters, word, parameter,
# range, which end, kind there, part of the failed inequality, word behind.
NEIGHBOURS = {
    "stick": (
        (
            FIG9,
            "P32",
            "Omega",
            (3, 4),
            0,
            "birth of a stick",
            "F^(1) < 0 where P3 crosses v1",
            "P321",
        ),
        (
            FIG9.replace(Omega="3.25"),
            "P321",
            "Omega",
            (3, 4),
            1,
            "vanishing of a stick",
            "P1 has positive duration",
            "P32",
        ),
    ),
    "graze of v2": (
        (FIG9, "P32", "Omega", (4, 6), 1, "grazing", "P3 stays in Omega2", "P7482"),
        (
            FIG9.replace(Omega="5.1"),
            "P7482",
            "Omega",
            (5, "5.15"),
            0,
            "grazing",
            "P8 meets v2 with F^(2) > 0",
            "P32",
        ),
    ),
    "graze of v1": (
        (FIG10, "P6454", "Omega", ("1.7", 4), 1, "grazing", "P5 stays in Omega2", "P746481"),
        (
            FIG10.replace(Omega="2.7"),
            "P746481",
            "Omega",
            (2, 3),
            0,
            "grazing",
            "P7 meets v1 with F^(2) < 0",
            "P6454",
        ),
    ),
    "slip": (
        (
            FIG10,
            "P6454",
            "B0",
            (3, 15),
            0,
            "vanishing of a slip",
            "F^(3) rises where P4 ends",
            "P54",
        ),
        (
            FIG10.replace(B0="4.5"),
            "P54",
            "B0",
            (4, 7),
            1,
            "birth of a slip",
            "F^(2) > 0 > F^(3) during P4",
            "P6454",
        ),
    ),
}


@pytest.fixture(
    scope="module",
    params=[
        name if name == "graze of v2" else pytest.param(name, marks=pytest.mark.campaign)
        for name in NEIGHBOURS
    ],
)
def two_sides(request):
    """Return the two ends at one bifurcation, and how they were asked for."""
    results = []
    for row in NEIGHBOURS[request.param]:
        branch = branch_of(*row[:4])
        results.append((branch, branch.ends[row[4]], row))
    return results


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
    if row[4]:
        outward = 1
    else:
        outward = -1
    for shift, labels in ((-outward, branch.labels), (outward, other.labels)):
        value = Fraction(end.value) + Fraction(shift, 10**10)
        p = row[0].replace(**{row[2]: value})
        assert events_of_a_period(p, branch, -2 if row[4] else 1) == events_of(labels)


MODES = {"P1": "belt1", "P2": "Omega1", "P4": "belt2", "P6": "Omega3"}  # the others: Omega2


def events_of(labels) -> list[str]:
    """Return what the mappings move through, sorted.

    The rotation of a word does not matter here.
    """
    return sorted(MODES.get(label, "Omega2") for label in labels)


def events_of_a_period(p: Parameters, branch, at: int) -> list[str]:
    """Return the modes of the last of a few periods that the oracle simulates, begun on the orbit next to an end."""
    period = 2 * np.pi / float(p.Omega)
    orbit = branch.orbit(at)
    cycles = 25
    pieces = orbit.equations().pieces
    times = [point.t for point in orbit.points]
    ends = [*times[1:], times[0] + period]
    i = max(range(len(pieces)), key=lambda i: (not pieces[i].sticks) * (ends[i] - times[i]))
    t0 = (times[i] + ends[i]) / 2  # inside the longest flight
    x0, v0 = (float(value) for value in orbit(t0))
    run = simulate_oracle(p, t0, x0, v0, t0 + cycles * period, 35)
    return sorted(event.source for event in run.events if event.t > t0 + (cycles - 1) * period)


@pytest.mark.slow
@pytest.mark.parametrize(("low", "high"), [("0.48", "0.52")])
def test_without_damping_no_multiplier_exceeds_1(low: str, high: str) -> None:
    """Friction never grows with the velocity.

    At Omega = 1/2 orbits are not isolated: the branch goes on.
    """
    p = Parameters(m=1, c=0, k=1, A0=0, B0=1, Omega=low, v1=0, v2=100, mu1="0.1", mu2=0, FN=1)
    branch = continue_orbit(p, "P32", "Omega", (low, high))
    assert [end.kind for end in branch.ends] == ["end of the range"] * 2
    sizes = np.abs(branch.multipliers).max(axis=1)
    assert sizes.max() < 1 + 1e-9
    assert np.array_equal(branch.stable, sizes < 1 - 1e-9)


@pytest.mark.slow
def test_points_of_a_branch_are_orbits():
    branch = branch_of(FIG9, "P32", "Omega", ("3.9", "4.2"))
    for i in range(1, len(branch.values), 7):
        orbit = find_orbit(branch.parameters(i), "P32")  # from scratch
        assert orbit.admissible
        np.testing.assert_allclose(np.array(orbit.points), branch.points[i], atol=1e-11)
        np.testing.assert_allclose(
            np.abs(orbit.multipliers), np.abs(branch.multipliers[i]), atol=1e-9
        )
    assert branch.orbit(3, digits=25).residual < 1e-30


@pytest.mark.slow
def test_a_range_may_end_where_no_system_is_beyond():
    """c = 0 is the least damping there is: the branch ends on it exactly."""
    branch = continue_orbit(FIG9, "P32", "c", (0, "0.3"))
    assert branch.values[0] == 0
    assert branch.ends[0].kind == "end of the range"
    assert abs(branch.multipliers[0]).max() < 1


def drawn(rng: random.Random) -> tuple[Parameters, float]:
    """Return parameters on whose branch in Omega P32 goes through a resonance, and the free frequency."""

    def q(low: float, high: float) -> str:
        return f"{rng.uniform(low, high):.3g}"

    k = q(2, 8)
    w0 = float(k) ** 0.5
    p = Parameters(
        m=1, c=q(0.3, 0.5), k=k, A0=q(-3, 3), B0=q(2, 6), Omega=f"{0.8 * w0:.3g}", v1=q(-0.2, 0.2), v2=1000,
        mu1=q(0.03, 0.1), mu2="0.1", FN=1,
    )  # fmt: skip
    return p, w0


def peak(p: Parameters, Omega: float) -> float:
    """Return the greatest velocity of P32 at a frequency."""
    orbit = find_orbit(p.replace(Omega=float(Omega)), "P32")
    times = np.linspace(
        *[float(t) for t in (orbit.points[1].t, orbit.points[0].t + orbit.period)], 200
    )
    best = times[np.argmax(orbit(times)[1])]
    h = times[1] - times[0]
    return -minimize_scalar(
        lambda t: -orbit(t)[1], bounds=(best - h, best + h), options={"xatol": 1e-12}
    ).fun


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed", [1, *(pytest.param(seed, marks=pytest.mark.campaign) for seed in range(2, 9))]
)
@pytest.mark.parametrize("depth", [1e-8, pytest.param(1e-2, marks=pytest.mark.campaign)])
def test_gaps_of_any_width_are_found(depth, seed):
    """v2 a little below the maximum over Omega of the orbit's peak velocity.

    The branch must end before it.
    """
    rng = random.Random(seed)
    p, w0 = drawn(rng)
    low = 0.75 * w0
    high = 1.5 * w0
    top = minimize_scalar(
        lambda Omega: -peak(p, Omega), bounds=(low, high), options={"xatol": 1e-9}
    )
    q = p.replace(v2=float(-top.fun) - depth)
    end = continue_orbit(q, "P32", "Omega", (low, high)).ends[1]
    assert end.kind == "grazing"
    assert end.value < top.x
    assert peak(p, end.value) == pytest.approx(float(q.v2), abs=1e-10)
    assert all(abs(condition.value) < 1e-9 for condition in end.conditions)
    assert end.beyond == "P7482"


def word_just_behind(branch: Branch, which: int, distance: float) -> str | None:
    """Return the word of one period, as a simulation from the orbit at the end says.

    None if it does not settle.
    """
    if which:
        i, outward = (-1, 1)
    else:
        i, outward = (0, -1)
    value = float(branch.values[i]) + outward * distance
    p = branch.parameters(i).replace(**{branch.parameter: value})
    orbit = branch.orbit(i)
    T = 2 * np.pi / float(p.Omega)
    n = max(range(len(orbit.points)), key=lambda j: not orbit.equations().pieces[j - 1].sticks)
    t0, x0 = orbit.points[n]
    path = simulate(
        p,
        t0=t0,
        x0=x0,
        v0=p.belt(orbit.equations().pieces[n].start),
        t_end=t0 + 60.3 * T,
        max_events=2000,
    )
    if path.status != "t_end":
        return None
    words = []
    for k in (56, 57, 58):
        first = t0 + (k + 0.15) * T
        last = t0 + (k + 1.15) * T
        words.append([s.label for s in path.segments if first < float(s.t_end) <= last])
    if words[0] != words[1] or words[1] != words[2] or None in words[0]:
        return None
    return "".join(sorted(label[1] for label in words[0]))


def random_branch(rng: random.Random) -> Branch | None:
    """Return a branch of what a random system does, over a random parameter."""

    def q(low: float, high: float) -> str:
        return f"{rng.uniform(low, high):.4g}"

    p = Parameters(
        m=q(0.5, 2), c=q(0.3, 2), k=q(1, 5), A0=q(-3, 3), B0=q(4, 12), Omega=q(0.7, 3), v1=q(-3, 0), v2=q(0.5, 4),
        mu1=q(0.1, 0.6), mu2=q(0.1, 0.6), FN=q(2, 8),
    )  # fmt: skip
    path = simulate(p, t0=0, x0=0, v0=0, t_end=60 / float(p.Omega))
    since = (60 - 2 * np.pi) / float(p.Omega)
    labels = [s.label for s in path.segments if s.label and float(s.t_end) > since]
    name = rng.choice(["Omega", "B0", "FN", "v2", "k", "mu1", "c"])
    value = float(getattr(p, name))
    try:
        return continue_orbit(p, list(reversed(labels)), name, (0.6 * value, 1.6 * value))
    except (ValueError, ConvergenceError):
        return None


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(1, 13))
def test_what_is_just_behind_an_end(seed):
    rng = random.Random(100 + seed)
    judged = 0
    while judged < 1:
        branch = random_branch(rng)
        for which in (0, 1) if branch else ():
            end = branch.ends[which]
            if end.kind == "end of the range":
                continue
            assert all(abs(c.value) < 1e-8 * c.scale for c in end.conditions), end
            word = word_just_behind(branch, which, 1e-7 * abs(branch.values).max())
            if end.beyond is None or word is None:
                continue
            judged += 1
            assert "".join(sorted(end.beyond[1:])) == word, (branch, end)


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("p", "word", "name", "limits"),
    [
        (FIG9, "P32", "Omega", ("3.2", "4.2")),
        (SHRINKS, "P54", "m", ("0.05", 8)),
        (FIG10, "P4645", "B0", (3, 15)),
        (FIG9, "P32", "Omega", (3, 6)),
        (FIG9.replace(Omega="3.25"), "P132", "Omega", (3, 4)),
    ],
)
def test_orbits_at_the_ends_and_restarts_from_them(p, word, name, limits):
    branch = branch_of(p, word, name, limits)
    for i in (0, -1):
        orbit = branch.orbit(i)
        assert orbit.admissible
        away = np.array(orbit.points) - branch.points[i]
        away[:, 0] -= np.round(away[0, 0] / orbit.period) * orbit.period
        assert np.abs(away).max() < 2e-6
        again = continue_orbit(branch.parameters(i), word, name, limits, branch.points[i])
        assert [end.kind for end in again.ends] == [end.kind for end in branch.ends]
        for first, second in zip(again.ends, branch.ends, strict=True):
            assert first.value == pytest.approx(second.value, rel=1e-9)


@pytest.mark.campaign
def test_the_reason_of_an_end_is_0_there():
    end = branch_of(SHRINKS, "P54", "m", ("0.05", 8)).ends[1]
    assert end.kind == "vanishing of a stick"
    assert end.conditions
    # The stick lasts 0.3 sqrt(end - m): a few units of m's last place are 1e-8 of its duration.
    assert all(abs(condition.value) < 2e-8 for condition in end.conditions)
    assert end.beyond is None
    assert "ends up in Omega2 and meets no belt" in end.message
    p = SHRINKS.replace(m=end.value + 1e-6)
    assert len(simulate(p, t0=0, x0=0, v0=0, t_end=60).events) == len(
        simulate(p, t0=0, x0=0, v0=0, t_end=600).events
    )


@pytest.mark.parametrize(("scene", "word"), [("fig5", "P12"), ("fig10", "P4645")])
def test_the_forces_of_a_stick_are_those_of_the_belt(scene: str, word: str) -> None:
    """What both forces have gained since the stick's end, as a difference.

    Over the time, and from the other force.
    """
    p = load_scene(scene).parameters
    orbit = find_orbit(p, word)
    equations = orbit.equations()
    points = [(point.x, float(p.Omega) * point.t) for point in orbit.points]
    u = np.linspace(0, 1, 21)
    sticks = 0
    for i, piece in enumerate(equations.pieces):
        if not piece.sticks:
            continue
        sticks += 1
        K = equations.K
        belt = equations.belt(piece.start)
        end = equations.ends(points)[i][1]
        before = -(1 - u) * (end - points[i][1]) / K.Om
        force = -piece.side * (
            belt.drift * before + K.f0 * (np.cos(end + K.Om * before) - np.cos(end))
        )
        ratio, other = branches.piece_margins(equations, points, i, u)
        assert other == pytest.approx(belt.J - force, rel=1e-12)
        assert ratio[:-1] * -before[:-1] == pytest.approx(force[:-1], rel=1e-9, abs=1e-12)
        assert ratio[-1] == pytest.approx(ratio[-2], rel=0.3)
    assert sticks


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748")])
def test_functions_of_a_flight_are_its_gaps_without_their_known_roots(
    p: Parameters, word: str
) -> None:
    """Inside a flight the gap to each boundary over the time and the rest of it.

    At both ends the limit of that.
    """
    orbit = find_orbit(p, word)
    equations = orbit.equations()
    points = orbit.phases()
    u = np.array([0.0, 1e-5, 0.3, 0.77, 1 - 1e-5, 1.0])
    flights = 0
    for i, piece in enumerate(equations.pieces):
        if piece.sticks:
            continue
        flights += 1
        start = equations.start_of_flight(piece, tuple(points[i]))
        tau = (equations.ends(points)[i][1] - points[i][1]) / equations.K.Om
        margins = branches.piece_margins(equations, points, i, u)
        belts = [belt for belt in (piece.mode - 1, piece.mode) if belt in (1, 2)]
        assert len(margins) == len(belts)
        for belt, values in zip(belts, margins, strict=True):
            if belt != piece.start:
                roots = 0
            elif piece.after_stick:
                roots = 2
            else:
                roots = 1
            end = belt == piece.end
            for k in (1, 2, 3, 4):
                v = float(start.v + state_at(u[k] * tau, start, equations.K).dv)
                gap = (v - float(p.belt(belt))) * (1 if belt < piece.mode else -1)
                divisor = (u[k] * tau) ** roots * ((1 - u[k]) if end else 1.0)
                assert values[k] == pytest.approx(gap / divisor, rel=1e-5, abs=1e-5)
            assert values[0] == pytest.approx(values[1], rel=1e-3, abs=1e-3)
            assert values[5] == pytest.approx(values[4], rel=1e-3, abs=1e-3)
    assert flights > 1
