"""How a motion starts: exactly, however many digits the start has, or known to so much as it says (`start_error`)."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

import mpmath
import numpy as np
import pytest
from agreement import CONTACTS, NEAR, assert_agrees
from aimed import Aimed, aimed, text
from oracle import flow_oracle, simulate_oracle
from samples import few
from touches import tenths

from symosc import ParameterError, load_scene, simulate, simulate_many
from symosc.engine import batch, start
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.next_event import creeps_for_ever
from symosc.engine.start import Start, first_state

# -- exact starts ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "x0", ["0.123456789012345678", "0.12345678901234567890123456789", Fraction(1, 3**40)]
)
def test_digits_decide_from_a_long_start(x0: Any) -> None:
    scene = load_scene("fig5")
    trajectory = simulate(scene, x0=x0, digits=20)
    assert trajectory.status == "t_end"
    run = simulate_oracle(scene.parameters, scene.t0, x0, scene.v0, scene.t_end, 60)
    assert_agrees(trajectory, run, 1e-19)


# -- starts known to so much only --------------------------------------------------------------------------------------


def reach(a: Aimed, mapping: str, errors: tuple[Fraction, ...]) -> float:
    """Return how far the errors of t0, x0 and v0 can move the peak at t_m, from differences of the oracle's flow."""
    alpha = CONTACTS[mapping][0]
    push = Fraction(1, 10**30)
    t0 = a.t0
    x0 = Fraction(text(a.x0, 90))
    v0 = Fraction(text(a.v0, 90))

    def peak(dt: Fraction, dx: Fraction, dv: Fraction) -> Any:
        return flow_oracle(a.p, alpha, t0 + dt, x0 + dx, v0 + dv, a.t_m - t0 - dt, 90)[1]

    with mpmath.workdps(90):
        rest = peak(Fraction(0), Fraction(0), Fraction(0))
        slopes = [abs(peak(*(push * (i == j) for j in range(3))) - rest) * 10**30 for i in range(3)]
    return float(sum(slope * float(error) for slope, error in zip(slopes, errors, strict=True)))


ERRORS = {"t0": (1, 0, 0), "x0": (0, 1, 0), "v0": (0, 0, 1), "all": (1, 1, 1)}


@pytest.mark.full(3)
@pytest.mark.slow
@pytest.mark.parametrize("exponent", [5, 7, 12, 20, 40])
@pytest.mark.parametrize("which", ERRORS)
def test_a_contact_within_reach_of_the_error_is_a_graze(which: str, exponent: int) -> None:
    """A peak beyond the belt by 0.9 of what the error can do touches.

    By 2.5 times that it sticks, or misses.
    """
    mapping = list(CONTACTS)[(exponent + len(which)) % 4]
    errors = tuple(Fraction(part, 10**exponent) for part in ERRORS[which])
    plain = aimed(f"reach {which} {exponent}", mapping)
    within = reach(plain, mapping, errors)
    for part, kinds in ((0.9, ["graze"]), (-0.9, ["graze"]), (2.5, ["stick"]), (-2.5, [])):
        height = Fraction(part) * Fraction(within)
        a = aimed(f"reach {which} {exponent}", mapping, height)
        x0 = text(a.x0, 80)
        v0 = text(a.v0, 80)
        t_end = a.t_m + Fraction(1, 20)
        for digits in (None, 20):
            motion = simulate(
                a.p, t0=a.t0, x0=x0, v0=v0, t_end=t_end, digits=digits, start_error=errors
            )
            near = [event for event in motion.events if abs(float(event.t - float(a.t_m))) < 1e-2]
            assert [event.kind for event in near][:1] == kinds, (
                mapping,
                part,
                digits,
                motion.status,
            )
            assert motion.status == "t_end"
        if part == 0.9:
            table = simulate_many(a.p, [a.t0, x0, v0], t_end, start_error=errors, use_numba=False)
            assert table.kind.tolist()[:1] == kinds


@pytest.mark.full(2)
@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", CONTACTS)
@pytest.mark.parametrize("digits", [None, 25])
def test_the_errors_of_events_cover_that_of_the_start(mapping: str, digits: int | None) -> None:
    """Compared with runs from all corners of what the start may be.

    Covered, and not by more than a few times.
    """
    a = aimed(f"corners {mapping}", mapping, Fraction(1, 10))
    errors = (Fraction(1, 10**9), Fraction(3, 10**9), Fraction(2, 10**9))
    t0 = a.t0
    x0 = Fraction(text(a.x0, 10))
    v0 = Fraction(text(a.v0, 10))
    t_end = a.t_m + 5
    motion = simulate(a.p, t0=t0, x0=x0, v0=v0, t_end=t_end, digits=digits, start_error=errors)
    plain = simulate(a.p, t0=t0, x0=x0, v0=v0, t_end=t_end, digits=25)
    assert len(motion.events) >= 2
    corners = []
    for signs in product((-1, 1), repeat=3):
        dt, dx, dv = (sign * error for sign, error in zip(signs, errors, strict=True))
        corners.append(
            simulate(a.p, t0=t0 + dt, x0=x0 + dx, v0=v0 + dv, t_end=t_end, digits=25).events
        )
    for i, (event, middle) in enumerate(zip(motion.events, plain.events, strict=True)):
        moved_t = max(float(abs(corner[i].t - middle.t)) for corner in corners)
        moved_x = max(float(abs(corner[i].x - middle.x)) for corner in corners)
        assert moved_t <= 1.001 * event.t_error <= 10 * moved_t + 1e-15 * event.t
        assert (
            moved_x
            <= 1.001 * event.x_error
            <= 10 * (moved_x + abs(float(event.v)) * moved_t) + 1e-14
        )


@pytest.mark.full(2)
@pytest.mark.quick(1)
@pytest.mark.parametrize("boundary", few([1, 2], 2))
@pytest.mark.parametrize("side", ["low", "high"])
@pytest.mark.parametrize("speeds", [("0.5", "0.8"), ("-0.8", "-0.5")], ids=["forward", "backward"])
def test_a_force_within_reach_of_the_error_is_zero(
    boundary: int, side: str, speeds: tuple[str, str]
) -> None:
    """Then the next G-function decides where a start on a belt goes, whatever the sign of the force."""
    alpha = boundary + (side == "high")
    p = NEAR.replace(
        v1=speeds[0], v2=speeds[1]
    )  # belts that run forward have G^(1) < 0, others > 0
    v = p.belt(boundary)
    for which, size in ((0, (abs(p.k * v) + p.B0 * p.Omega) / p.m), (1, p.k / p.m), (2, p.c / p.m)):
        for part in ("0.9", "-0.9", "3", "-3"):
            errors = tuple(Fraction(i == which, 10**7) for i in range(3))
            force = Fraction(part) * size / 10**7
            x0 = (p.A(alpha) + p.B0 - p.c * v - p.m * force) / p.k
            exactly = simulate(p, t0=0, x0=x0, v0=v, t_end=1)
            falling = simulate(p, t0=0, x0=(p.A(alpha) + p.B0 - p.c * v) / p.k, v0=v, t_end=1)
            for digits in (None, 20):
                motion = simulate(p, t0=0, x0=x0, v0=v, t_end=1, start_error=errors, digits=digits)
                if abs(Fraction(part)) < 1:
                    expected = falling
                else:
                    expected = exactly
                assert motion.mode(0.0) == expected.mode(0.0), (which, part)


@pytest.mark.slow
def test_shipped_scenes_say_how_well_their_starts_are_known() -> None:
    for name in ("fig7-exact", "fig8-exact", "fig9-orbit", "fig10-orbit"):
        scene = load_scene(name)
        assert scene.start_error is not None
        assert 0 < max(scene.start_error) < Fraction(1, 10**20)
    for name in ("fig7-exact", "fig8-exact"):
        scene = load_scene(name)
        for digits in (None, 25, 60):
            assert [event.kind for event in simulate(scene, t_end=4, digits=digits).events] == [
                "graze"
            ]
        exact = simulate(
            scene.parameters, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=4, digits=25
        )
        run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, 4, 150)
        assert "graze" not in {event.kind for event in run.events}
        assert_agrees(exact, run, 1e-24)


@pytest.mark.parametrize("error", ["x", -1, (1, 2), (0, 0, -1), float("nan")])
def test_a_start_error_is_a_number_or_three(error: Any) -> None:
    scene = load_scene("fig5")
    with pytest.raises(ParameterError, match="start_error"):
        simulate(scene, start_error=error)
    with pytest.raises(ParameterError, match="start_error"):
        simulate_many(scene.parameters, [0, 0, 0], 1, start_error=error)


# -- starts on a belt --------------------------------------------------------------------------------------------------


def test_all_who_start_on_a_belt_start_alike() -> None:
    """A single motion, a row of a batch, a map and an orbit.

    The same mode, the same accelerations.
    """
    rng = random.Random(12)
    seen = set()
    for _ in range(200):
        p = NEAR.replace(
            v1=tenths(rng, -20, 5),
            v2=tenths(rng, 6, 20),
            mu1=tenths(rng, 1, 9),
            mu2=tenths(rng, 1, 9),
        )
        boundary = rng.choice([1, 2])
        x0 = tenths(rng, -99, 99)
        arithmetic = Arithmetic(p)
        state = first_state(Start(p, Fraction(0), x0, p.belt(boundary), Fraction(1)), arithmetic)
        x = float(x0)
        phase = (0.0, 1.0)
        begun = start.belt_start(boundary, x, phase, arithmetic)
        again = start.belt_state(begun, (0, 0.0), phase, x, state.S, arithmetic.K)
        assert again == state
        at = np.array([boundary, 0])
        v = np.array([state.v, state.v + 1e-3])
        rows, _ = start.start_rows(
            at, np.zeros(2), np.full(2, x), v, (0.0, 0.0, 0.5, 0.0, 0.0), arithmetic.K
        )
        assert batch.state_of(rows[0]) == state
        assert rows[1].mode == boundary + 1  # beside the belt the speed says where it is
        assert batch.row_of(state, 0.5, 0.0) == rows[0].item()
        seen.add(state.mode)
    assert seen == {1, 2, 3, 4, 5}


@pytest.mark.parametrize("spring", [True, False])
def test_steady_starts_are_told_exactly(spring: bool) -> None:
    """On the steady motion of any of the three domains.

    Not a hair beside it, and not with another time or an error.
    """
    rng = random.Random(12)
    hair = Fraction(1, 10**40)
    for _ in range(40):
        if spring:
            k = tenths(rng, 1, 60)
        else:
            k = Fraction(0)
        p = NEAR.replace(
            m=tenths(rng, 2, 30),
            c=tenths(rng, 1, 60),
            k=k,
            Omega=tenths(rng, 3, 40),
            A0=tenths(rng, -40, 40),
        )
        pull = p.k - p.m * p.Omega**2
        drag = p.c * p.Omega
        # x = X cos t + Y sin t with (k - m Omega^2) X + c Omega Y = B0 and (k - m Omega^2) Y - c
        # Omega X = 0, at t = 0
        X = p.B0 * pull / (pull**2 + drag**2)
        Y = p.B0 * drag / (pull**2 + drag**2)
        assert pull * X + drag * Y == p.B0
        assert pull * Y == drag * X
        for domain in (1, 2, 3):
            mean = p.A(domain) / (p.k or p.c)
            if spring:
                x0, v0 = (X + mean, Y * p.Omega)
            else:
                x0, v0 = (tenths(rng, -9, 9), Y * p.Omega + mean)
            problem = Start(p, Fraction(0), x0, v0, Fraction(9))
            assert start.is_steady(problem)
            assert not start.is_steady(replace(problem, v0=v0 + hair))
            assert start.is_steady(replace(problem, x0=x0 + hair)) is not spring
            assert not start.is_steady(replace(problem, t0=hair))
            assert not start.is_steady(
                replace(problem, start_error=(Fraction(0), hair, Fraction(0)))
            )
            assert start.is_steady(replace(problem, start_error=(Fraction(0),) * 3))
    undamped = NEAR.replace(c=0, k=NEAR.m * NEAR.Omega**2)
    assert not start.is_steady(Start(undamped, Fraction(0), Fraction(0), Fraction(0), Fraction(9)))
    free = NEAR.replace(c=0, k=0)
    assert not start.is_steady(Start(free, Fraction(0), Fraction(0), Fraction(0), Fraction(9)))


def test_what_settles_creeps_for_ever_and_meets_no_belt() -> None:
    """Random starts of random systems without a drive.

    What rational numbers tell doubles see, and the oracle.
    """
    rng = random.Random(13)
    answers = {True: 0, False: 0}
    for _ in range(60):
        m = tenths(rng, 5, 20)
        h = tenths(rng, 5, 30)
        v1 = -tenths(rng, 0, 9)
        v2 = tenths(rng, 1, 20)
        k = m * h * h * rng.choice([1, Fraction(1, 2), Fraction(9, 10)])
        p = NEAR.replace(m=m, c=2 * m * h, k=k, B0=0, A0=tenths(rng, -40, 40), v1=v1, v2=v2)
        x0 = p.A(2) / p.k + tenths(rng, -9, 9) * rng.choice([Fraction(1, 10), 4])
        v0 = tenths(rng, -9, 20)
        if v0 in (p.v1, p.v2):
            continue
        problem = Start(p, Fraction(0), x0, v0, Fraction(40))
        settled = start.settles(problem)
        answers[settled] += 1
        arithmetic = Arithmetic(p)
        assert creeps_for_ever(first_state(problem, arithmetic), arithmetic.K) == settled
        if settled:
            assert simulate_oracle(p, 0, x0, v0, 40, 25, max_events=1).events == []
        assert not start.settles(replace(problem, start_error=(Fraction(1, 10**9),) * 3))
    assert min(answers.values()) > 10
