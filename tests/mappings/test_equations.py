"""The mappings: residuals and derivatives against mpmath, where they lead against the ODE, and their errors."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from map_points import REGIMES, Size, draw, draw_points, sizes, truth
from mpmath import mp
from oracle import simulate_oracle
from samples import sample_of

from symosc import Parameters, load_scene, scene_names, simulate
from symosc.friction import MAPS
from symosc.mappings import equations as m
from symosc.mappings.equations import MapError, jacobian, solve_map
from symosc.model import PARAMETER_NAMES
from symosc.simulation.trajectory import map_labels

ACCURACY = 1e-13


@pytest.mark.full(3)
@pytest.mark.slow
@pytest.mark.parametrize("regime", REGIMES)
@sample_of(12, 100)
def test_residual_and_derivatives_agree_with_mpmath(regime: str, count: int) -> None:
    rng = random.Random(f"maps {regime}")
    step = mpmath.mpf("1e-22")
    for _ in range(count):
        p = draw(rng, regime)
        label = f"P{rng.randint(1, 8)}"
        equal_roots = p.c**2 == 4 * p.k * p.m or p.k == 0 or (p.c == 0 and p.k == p.m * p.Omega**2)
        if equal_roots:
            lift = mpmath.mpf("1e-25")
        else:
            lift = 0
        z = draw_points(rng, p)
        if label in ("P1", "P4"):
            exit = rng.choice(m.EXITS)
        else:
            exit = None
        ends = (z[:2], z[2:], exit)
        residuals = (
            m.residual(p, label, *ends),
            m.jacobian(p, label, *ends),
            m.parameter_jacobian(p, label, *ends),
        )
        size = sizes(p, label, z, exit)
        with mp.workdps(110):
            q = {
                name: mp.mpf(getattr(p, name).numerator) / getattr(p, name).denominator
                for name in PARAMETER_NAMES
            }
            exact = [mp.mpf(value) for value in z]

            def slope(
                name: str, n: int, case: Any = (label, exit, lift), q: Any = q, exact: Any = exact
            ) -> list[Any]:
                """Return the central differences of f1 and f2 by a parameter, or by the n-th coordinate."""
                sides = []
                for h in (step, -step):
                    moved = [value + h * (i == n) for i, value in enumerate(exact)]
                    changed = q | ({name: q[name] + h} if name else {})
                    sides.append(truth(changed, case[0], moved, *case[1:]))
                return [(up - down) / (2 * step) for up, down in zip(*sides, strict=True)]

            by_point = zip(*(slope("", n) for n in range(4)), strict=True)
            by_parameter = zip(*(slope(name, -1) for name in PARAMETER_NAMES), strict=True)
            expected = (truth(q, label, exact, exit, lift), list(by_point), list(by_parameter))
            for what, values, truths, allowed in zip("fJD", residuals, expected, size, strict=True):
                pairs = zip(np.ravel(values), np.ravel(truths), np.ravel(allowed), strict=True)
                for n, (value, true, scale) in enumerate(pairs):
                    bound = ACCURACY * Size(scale).value
                    assert abs(float(value) - true) <= bound + 1e-20, (
                        f"{what}[{n}] of {label}, {p}, {z}"
                    )


def test_mpmath_numbers_in_mpmath_numbers_out() -> None:
    rng = random.Random(5)
    for regime in REGIMES:
        p = draw(rng, regime)
        label = f"P{rng.randint(2, 3)}"
        with mp.workdps(40):
            z = [mp.mpf(value) for value in draw_points(rng, p)]
            f = m.residual(p, label, z[:2], z[2:])
            J = m.jacobian(p, label, z[:2], z[2:])
            D = m.parameter_jacobian(p, label, z[:2], z[2:])
            assert J.shape == (2, 4)
            assert D.shape == (2, 11)
            assert all(isinstance(value, mp.mpf) for value in [*f, *J.ravel(), *D.ravel()])
            q = {
                name: mp.mpf(getattr(p, name).numerator) / getattr(p, name).denominator
                for name in PARAMETER_NAMES
            }
            with mp.workdps(110):
                lift = mpmath.mpf("1e-50")
                exact = truth(q, label, z, None, lift)
                step = mpmath.mpf("1e-20")
                sides = [
                    truth(q | {"Omega": q["Omega"] + h}, label, z, None, lift)
                    for h in (step, -step)
                ]
            # p's decimal fractions are rounded to 40 digits in q: the result can be no better
            for value, true in zip(f, exact, strict=True):
                assert abs(value - true) < mp.mpf("1e-34") * (1 + abs(true))
            for value, up, down in zip(D[:, 5], *sides, strict=True):
                assert abs(value - (up - down) / (2 * step)) < mp.mpf("1e-30") * (1 + abs(value))


@pytest.mark.quick(2)
@pytest.mark.parametrize("regime", REGIMES)
def test_arrays_agree_with_floats(regime: str) -> None:
    rng = random.Random(f"arrays {regime}")
    p = draw(rng, regime)
    for label in ("P1", "P3", "P7"):
        z = np.array([draw_points(rng, p) for _ in range(30)]).T.reshape(4, 5, 6)
        f = m.residual(p, label, z[:2], z[2:])
        J = m.jacobian(p, label, z[:2], z[2:])
        D = m.parameter_jacobian(p, label, z[:2], z[2:])
        assert (f[0].shape, f[1].shape, J.shape, D.shape) == (
            (5, 6),
            (5, 6),
            (2, 4, 5, 6),
            (2, 11, 5, 6),
        )
        for i in np.ndindex(5, 6):
            point = z[(slice(None), *i)].tolist()
            for values, function in ((f, m.residual), (J, m.jacobian), (D, m.parameter_jacobian)):
                expected = np.array(function(p, label, point[:2], point[2:]))
                if values is f:
                    got = np.array([part[i] for part in values])
                else:
                    got = values[(..., *i)]
                np.testing.assert_allclose(
                    got, expected, rtol=0, atol=1e-12 * (1 + np.abs(expected).max())
                )


@pytest.mark.parametrize("name", scene_names())
def test_residuals_vanish_on_simulated_pieces(name: str) -> None:
    scene = load_scene(name)
    p = scene.parameters
    Omega = float(scene.parameters.Omega)
    traj = simulate(scene, max_events=60)
    events = list(traj.events)
    pieces = [piece for piece in traj.segments if piece.label]
    labels = [label for label in traj.word if label]
    assert labels == [piece.label for piece in pieces]
    scale = 1 + max((abs(event.x) for event in events), default=0)
    for piece in pieces:
        i = next(i for i, event in enumerate(events) if event.t == piece.t_end)
        start = (events[i - 1].x if i else float(scene.x0), Omega * float(piece.t_start))
        end = (events[i].x, Omega * float(piece.t_end))
        exit = None
        if events[i].kind == "slip":
            if int(events[i].target[-1]) == events[i].boundary:
                exit = "below"
            else:
                exit = "above"
        f1, f2 = m.residual(p, piece.label, start, end, exit)
        rate = 1 + Omega + float(p.k / p.m) ** 0.5 + float(p.c / p.m)
        assert abs(f1) < 2e-13 * scale * rate**2 * (1 + abs(end[1])), piece
        assert abs(f2) < 2e-13 * scale * rate**3 * (1 + abs(end[1])), piece


@pytest.mark.parametrize(
    ("label", "x", "theta"), [("P5", "4.0", "0.5"), ("P4", "-2.1", "3.38"), ("P6", "-2.0", "4.5")]
)
def test_derivative_of_a_map_is_its_difference(label: str, x: str, theta: str) -> None:
    p = load_scene("fig10").parameters
    with mp.workdps(30):
        z = [mp.mpf(x), mp.mpf(theta)]
        h = mp.mpf("1e-9")
        end = solve_map(p, label, *z)
        f = m.residual(p, label, z, (end.x, end.theta), end.exit)
        assert max(map(abs, f)) < mp.mpf("1e-26")
        assert end.derivative is not None
        for j in (0, 1):
            moved = ([value + s * h * (i == j) for i, value in enumerate(z)] for s in (1, -1))
            up, down = (solve_map(p, label, *start) for start in moved)
            assert abs((up.x - down.x) / (2 * h) - end.derivative[0, j]) < 1e-14
            assert abs((up.theta - down.theta) / (2 * h) - end.derivative[1, j]) < 1e-14


def test_a_graze_ends_a_map_and_has_no_derivative() -> None:
    # Without spring, damper and friction v - v1 = A0 theta + sin(theta), which touches 0 where
    # tan(theta) = theta.
    with mp.workdps(50):
        theta = mp.findroot(lambda angle: mp.sin(angle) - angle * mp.cos(angle), 4.4934)
        A0 = mp.nstr(-mp.cos(theta), 45)
    p = Parameters(m=1, c=0, k=0, A0=A0, B0=1, Omega=1, v1=0, v2=9, mu1=0, mu2=0, FN=0)
    end = solve_map(p, "P3", 2.0, 0.0)
    assert end.grazing
    assert end.derivative is None
    assert end.theta == pytest.approx(float(theta), abs=1e-6)
    assert not solve_map(p.replace(A0="0.21"), "P3", 2.0, 0.0).grazing


@pytest.fixture
def p() -> Parameters:
    return load_scene("fig10").parameters


def starts(rng: random.Random) -> Iterator[tuple[Parameters, Fraction, Fraction, str, Any]]:
    """Yield random starts on a belt with the map that the equation of motion follows there, and its end."""
    while True:
        p = draw(rng, rng.choice(["underdamped", "overdamped", "undamped", "critical"]))
        x = Fraction(f"{rng.uniform(-8, 8):.6g}")
        theta = Fraction(f"{rng.uniform(-40, 40):.6g}")
        belt = rng.choice([1, 2])
        # A time after which the clock of the oracle starts at a phase of this size.
        run = simulate_oracle(
            p, theta / p.Omega, x, p.belt(belt), theta / p.Omega + 30, 25, max_events=1
        )
        if run.events and run.events[0].kind != "graze":
            event = run.events[0]
            yield p, x, theta, map_labels(2)[belt, event.source, event.boundary], event


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [None, 25])
def test_a_map_is_what_the_equation_of_motion_does(digits: int | None) -> None:
    """From random points of both belts, at phases of many turns and below 0.

    The end, the exit, and other labels.
    """
    rng = random.Random(6)
    context = mpmath.mp.clone()
    context.dps = digits or 15
    source = starts(rng)
    said = set()
    for _ in range(25 if digits is None else 4):
        p, x, theta, label, event = next(source)

        def number(q):
            if digits is None:
                return float(q)
            return context.mpf(q.numerator) / q.denominator

        solved = solve_map(p, label, number(x), number(theta))
        if digits is None:
            allowed = 1e-9
        else:
            allowed = 1e-18
        with mpmath.workdps(40):
            assert abs(solved.x - event.x) < allowed * (1 + abs(float(event.x)))
            assert (
                abs(solved.theta - event.t * p.Omega.numerator / p.Omega.denominator)
                < allowed * 100
            )
        slips = event.kind == "slip"
        side = None
        if slips:
            side = "above" if int(event.target[-1]) > event.boundary else "below"
        assert solved.exit == side
        assert not solved.grazing
        said.add(label)
        right = MAPS[label]
        for row in (
            row
            for row in MAPS.values()
            if row.start.boundary == right.start.boundary and row != right
        ):
            with pytest.raises(MapError) as caught:
                solve_map(p, row.label, number(x), number(theta))
            error = caught.value
            assert error.label == row.label
            if row.mode == right.mode:
                assert error.actual == label
                assert f"ends on belt {event.boundary}: that is {label}" in str(error)
            else:
                goes = f"the motion {'stays on' if right.sticks else 'goes into'} {event.source} there, since F^("
                assert error.actual is None
                assert f"{goes}{row.start.boundary}) = " in str(error)
    assert len(said) >= (6 if digits is None else 2)


def test_derivatives_are_those_of_the_equation_of_motion() -> None:
    """By differences of the oracle's ends, in x and in the phase."""
    source = starts(random.Random(7))
    h = Fraction(1, 10**9)
    for _ in range(6):
        p, x, theta, label, _ = next(source)
        slopes = solve_map(p, label, float(x), float(theta)).derivative
        assert slopes is not None
        belt = MAPS[label].start.boundary
        columns = []
        for dx, dtheta in ((h, 0), (0, h)):
            ends = []
            for sign in (1, -1):
                t = (theta + sign * dtheta) / p.Omega
                run = simulate_oracle(p, t, x + sign * dx, p.belt(belt), t + 30, 30, max_events=1)
                ends.append(
                    (run.events[0].x, run.events[0].t * p.Omega.numerator / p.Omega.denominator)
                )
            columns.append(
                [float((a - b) / (2 * mpmath.mpf(10) ** -9)) for a, b in zip(*ends, strict=True)]
            )
        size = 1 + np.abs(slopes).max()
        assert slopes == pytest.approx(np.array(columns).T, abs=1e-5 * size)


def test_derivatives_keep_all_digits() -> None:
    """Also those of sticks, whose matrix has whole numbers in it.

    They are not rounded to doubles.
    """
    context = mpmath.mp.clone()
    context.dps = 40
    p = load_scene("fig10").parameters
    for label in ("P1", "P4", "P2", "P6"):
        x = context.mpf(1) / 3
        theta = context.mpf(2) / 7
        matrix = jacobian(p, label, (x, theta), (context.mpf(-1) / 7, theta + context.mpf(1) / 3))
        assert matrix.dtype == object
        exact = [
            entry for entry in matrix.ravel() if hasattr(entry, "_mpf_") and entry != int(entry)
        ]
        assert len(exact) >= 3
        assert all(entry != float(entry) for entry in exact)


def test_the_multipliers_of_the_orbits() -> None:
    p = load_scene("fig9-orbit").parameters
    x = 4.154920661325319221515248
    theta = 4 * 0.1816703979243204630141381
    M = np.eye(2)
    for label in ("P2", "P3"):
        end = solve_map(p, label, x, theta)
        assert end.derivative is not None
        x = end.x
        theta = end.theta
        M = end.derivative @ M
    expected = [-0.016802303836361 - 0.069594338756153j, -0.016802303836361 + 0.069594338756153j]
    np.testing.assert_allclose(np.sort_complex(np.linalg.eigvals(M)), expected, atol=1e-12)
