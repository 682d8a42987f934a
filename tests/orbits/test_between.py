"""Branches: nothing fails unseen between their points, and their ends say what is just behind them."""

from __future__ import annotations

import random

import numpy as np
import pytest
from branches import branch_of
from scipy.optimize import minimize_scalar

from symosc import Parameters, continue_orbit, find_orbit, load_scene, simulate
from symosc.errors import ParameterError
from symosc.orbits import between
from symosc.orbits.branch import Branch
from symosc.orbits.closing_equations import ClosingEquations, ConvergenceError
from symosc.words import read_word

FIG9, FIG10 = load_scene("fig9").parameters, load_scene("fig10").parameters
# v2 lies just below the greatest velocity that P32 has at any Omega; it does not act on P32 otherwise.
NARROW = Parameters(
    m=1, c="1/5", k=4, A0=0, B0=3, Omega="1.5", v1="1/10", v2="14.3633605", mu1="1/10", mu2="1/10", FN=1
)
SHRINKS = Parameters(
    m="0.774", c="1.682", k="2.765", A0="-0.236", B0="4.57", Omega="2.043", v1="-2.927", v2="2.681", mu1="0.38",
    mu2="0.247", FN="5.058",
)  # fmt: skip


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
    times = np.linspace(*[float(t) for t in (orbit.points[1].t, orbit.points[0].t + orbit.period)], 200)
    best = times[np.argmax(orbit(times)[1])]
    h = times[1] - times[0]
    return -minimize_scalar(lambda t: -orbit(t)[1], bounds=(best - h, best + h), options={"xatol": 1e-12}).fun


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "which", "value"),
    [(NARROW, 1, 1.9993345), pytest.param(NARROW.replace(Omega="2.5"), 0, 2.0006555, marks=pytest.mark.campaign)],
)
def test_a_gap_narrower_than_the_steps_is_found(p, which, value):
    """From below and from above."""
    end = continue_orbit(p, "P32", "Omega", ("1.2", 4)).ends[which]
    assert end.kind == "grazing"
    assert end.value == pytest.approx(value, abs=2e-7)
    assert end.beyond == "P7482"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.campaign) for seed in range(2, 9))])
@pytest.mark.parametrize("depth", [1e-8, pytest.param(1e-2, marks=pytest.mark.campaign)])
def test_gaps_of_any_width_are_found(depth, seed):
    """v2 a little below the maximum over Omega of the orbit's peak velocity: the branch must end before it."""
    rng = random.Random(seed)
    p, w0 = drawn(rng)
    low, high = 0.75 * w0, 1.5 * w0
    top = minimize_scalar(lambda Omega: -peak(p, Omega), bounds=(low, high), options={"xatol": 1e-9})
    q = p.replace(v2=float(-top.fun) - depth)
    end = continue_orbit(q, "P32", "Omega", (low, high)).ends[1]
    assert end.kind == "grazing"
    assert end.value < top.x
    assert peak(p, end.value) == pytest.approx(float(q.v2), abs=1e-10)
    assert all(abs(condition.value) < 1e-9 for condition in end.conditions)
    assert end.beyond in ("P7482", "P8274", "P4827", "P2748")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "word", "low", "high"),
    [(FIG9, "P32", -100, 100), (FIG9, "P32", -(10**5), 10**5), (FIG10, "P4645", -500, 500)],
)
def test_a_shift_of_the_whole_orbit_takes_no_steps(p, word, low, high):
    branch = continue_orbit(p, word, "A0", (low, high))
    assert [end.kind for end in branch.ends] == ["end of the range"] * 2
    assert (branch.values[0], branch.values[-1]) == (low, high)
    assert len(branch.values) < 120
    middle = branch.points[len(branch.values) // 2]
    np.testing.assert_allclose(np.diff(branch.points[0, :, 1]), np.diff(middle[:, 1]), atol=1e-9 * abs(low))


@pytest.mark.slow
def test_a_range_ends_where_it_was_asked_to_end():
    rng = random.Random(3)
    for _ in range(4):
        low, high = f"{rng.uniform(0.1, 6):.4g}", f"{rng.uniform(10.1, 13):.4g}"
        branch = continue_orbit(FIG9, "P32", "FN", (low, high))
        assert (branch.values[0], branch.values[-1]) == (float(low), float(high))


def word_just_behind(branch: Branch, which: int, distance: float) -> str | None:
    """Return the word of one period, as a simulation from the orbit at the end says; None if it does not settle."""
    i, outward = (-1, 1) if which else (0, -1)
    value = float(branch.values[i]) + outward * distance
    p = branch.parameters(i).replace(**{branch.parameter: value})
    orbit, T = branch.orbit(i), 2 * np.pi / float(p.Omega)
    n = max(range(len(orbit.points)), key=lambda j: not orbit.equations().pieces[j - 1].sticks)
    t0, x0 = orbit.points[n]
    path = simulate(p, t0=t0, x0=x0, v0=p.belt(orbit.equations().pieces[n].start), t_end=t0 + 60.3 * T, max_events=2000)
    if path.status != "t_end":
        return None
    words = []
    for k in (56, 57, 58):
        first, last = t0 + (k + 0.15) * T, t0 + (k + 1.15) * T
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


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.campaign) for seed in range(2, 13))])
def test_what_is_just_behind_an_end(seed):
    rng, judged = random.Random(100 + seed), 0
    while judged < 1:
        branch = random_branch(rng)
        for which in (0, 1) if branch else ():
            end = branch.ends[which]
            if end.kind == "end of the range":
                continue
            assert all(abs(c.value) < 1e-8 * c.scale for c in end.conditions), end
            found = word_just_behind(branch, which, 1e-7 * abs(branch.values).max())
            if end.beyond is None or found is None:
                continue
            judged += 1
            assert "".join(sorted(end.beyond[1:])) == found, (branch, end)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "word", "name", "limits"),
    [
        (SHRINKS, "P54", "m", ("0.05", 8)),
        pytest.param(FIG10, "P4645", "B0", (3, 15), marks=pytest.mark.campaign),
        pytest.param(FIG9, "P32", "Omega", (3, 6), marks=pytest.mark.campaign),
        pytest.param(FIG9.replace(Omega="3.25"), "P132", "Omega", (3, 4), marks=pytest.mark.campaign),
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


@pytest.mark.slow
def test_the_reason_of_an_end_is_0_there():
    end = branch_of(SHRINKS, "P54", "m", ("0.05", 8)).ends[1]
    assert end.kind == "vanishing of a stick"
    assert end.conditions
    # The stick lasts 0.3 sqrt(end - m): a few units of m's last place are 1e-8 of its duration.
    assert all(abs(condition.value) < 2e-8 for condition in end.conditions)
    assert end.beyond is None
    assert "ends up in Omega2 and meets no belt" in end.message
    p = SHRINKS.replace(m=end.value + 1e-6)
    assert len(simulate(p, t0=0, x0=0, v0=0, t_end=60).events) == len(simulate(p, t0=0, x0=0, v0=0, t_end=600).events)


def test_arguments_in_the_wrong_place_are_named():
    with pytest.raises(ParameterError, match="must be Parameters"):
        continue_orbit("fig9", "P32", "Omega", (3, 5))  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="pair"):
        continue_orbit(FIG9, "P32", "Omega", "35")  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="max_points"):
        continue_orbit(FIG9, "P32", "Omega", (3, 5), max_points=0)


@pytest.mark.parametrize(("scene", "word"), [("fig5", "P12"), ("fig10", "P4645")])
def test_the_forces_of_a_stick_are_those_of_the_belt(scene: str, word: str) -> None:
    """What both forces have gained since the stick's end, as a difference: over the time, and from the other force."""
    p = load_scene(scene).parameters
    orbit = find_orbit(p, word)
    equations = ClosingEquations(p, read_word(word), 1)
    points = [(point.x, float(p.Omega) * point.t) for point in orbit.points]
    u, sticks = np.linspace(0, 1, 21), 0
    for i, piece in enumerate(equations.pieces):
        if not piece.sticks:
            continue
        sticks += 1
        K, belt = equations.K, equations.belt(piece.start)
        end = equations.ends(points)[i][1]
        before = -(1 - u) * (end - points[i][1]) / K.Om
        force = -piece.side * (belt.drift * before + K.f0 * (np.cos(end + K.Om * before) - np.cos(end)))
        ratio, other = between.functions(equations, points, i, u)
        assert other == pytest.approx(belt.J - force, rel=1e-12)
        assert ratio[:-1] * -before[:-1] == pytest.approx(force[:-1], rel=1e-9, abs=1e-12)
        assert ratio[-1] == pytest.approx(ratio[-2], rel=0.3)
    assert sticks


@pytest.mark.parametrize("dip", [0.1, 0.37, 0.93])
@pytest.mark.parametrize(("least", "clear"), [(1e-3, True), (-1e-3, False)])
def test_a_narrow_dip_is_looked_at_closer_where_it_is(
    dip: float, least: float, clear: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only there; and whether the function goes below 0 is found."""
    grids: list[np.ndarray] = []

    def dipped(equations: object, points: object, i: int, u: np.ndarray) -> list[np.ndarray]:
        grids.append(u)
        return [1 + least - np.exp(-((u - dip) ** 2) / 2e-3)]

    monkeypatch.setattr(between, "functions", dipped)
    assert between._clear_over([(None, None)] * 3, 0, np.linspace(0, 1, 65), 4) is clear
    assert len(grids) > 3
    for u in grids[3:]:
        assert u[0] <= dip <= u[-1] < u[0] + 0.4
