"""From one event to the next: where motions begin, and what happens at a contact."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from oracle import simulate_oracle
from problems import FAMILIES, ordinary

from symosc import Parameters, load_scene, simulate
from symosc.certificates.balls import Undecided, ball, exact_ends, working_bits
from symosc.certificates.motion import ON_A_BELT, Problem, begin, next_event
from symosc.model import MODE_NAMES

EXACT = (Fraction(0),) * 3


def test_a_motion_begins_as_the_engine_says() -> None:
    rng, modes = random.Random(5), set()
    with working_bits(128):
        for _ in range(200):
            p, start = ordinary(rng)
            t0, x0 = Fraction(start["t0"]), Fraction(start["x0"])
            v0 = rng.choice([p.v1, p.v2, Fraction(start["v0"])])
            mode = begin(Problem(p), (t0, x0, v0), EXACT).mode
            run = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t0 + Fraction(1, 10**6))
            assert MODE_NAMES[mode] == run.segments[0].mode
            modes.add(mode)
    assert modes == {1, 2, 3, 4, 5}


# On belt 1 at t0 = 0 with F^(1) = 0 or F^(2) = 0 exactly: what decides is the first derivative that is not 0.
BASE = {"m": 1, "c": 1, "A0": 0, "Omega": 1, "v2": 9, "mu1": "0.5", "mu2": "0.5", "FN": 2}


@pytest.mark.parametrize(
    ("k", "B0", "v1", "domain"),
    [(1, 3, 1, 1), (1, 3, -1, 1), (1, 3, 1, 2), (1, 3, -1, 2), (0, 3, 1, 1), (0, -3, 1, 1), (0, 3, 1, 2), (1, 0, 1, 1)],
)
def test_a_force_that_is_exactly_0_at_the_start(k: int, B0: int, v1: int, domain: int) -> None:
    p = Parameters(**BASE, k=k, B0=B0, v1=v1)
    x0 = Fraction(0)
    if k:
        x0 = p.A(domain) + p.B0 - p.c * p.v1
    else:
        p = p.replace(A0=p.A0 - (p.A(domain) + p.B0 - p.c * p.v1))
    with working_bits(128):
        state = begin(Problem(p), (Fraction(0), x0, p.v1), EXACT)
    run = simulate_oracle(p, 0, x0, p.v1, Fraction(1, 1000))
    first = run.events[0].source if run.events else run.mode
    assert MODE_NAMES[state.mode] == first


def test_a_belt_start_that_is_known_to_an_error_only_is_open() -> None:
    p, error = load_scene("fig5").parameters, Fraction(1, 100)
    problem = Problem(p)
    with pytest.raises(Undecided):
        begin(problem, (Fraction(0), Fraction(0), p.v1), (Fraction(0), Fraction(0), error))
    zero = p.A(1) + p.B0 - p.c * p.v1  # F^(1) = 0
    with pytest.raises(Undecided):
        begin(problem, (Fraction(0), zero, p.v1), (Fraction(0), error, Fraction(0)))
    assert begin(problem, (Fraction(0), zero - 1, p.v1), (Fraction(0), error, Fraction(0))).mode == ON_A_BELT + 1


@pytest.mark.parametrize("family", FAMILIES)
def test_sets_of_starts_contain_the_events_of_their_points(family: str) -> None:
    """Corners of the set of starts have the same events, each within the enclosure of it."""
    rng = random.Random(f"sets {family}")
    for _ in range(2):
        p, start = FAMILIES[family](rng)
        t0, x0, v0 = (Fraction(start[name]) for name in ("t0", "x0", "v0"))
        if v0 in (p.v1, p.v2):
            continue
        error, found = Fraction(1, 10**9), []
        with working_bits(192):
            problem = Problem(p)
            state = begin(problem, (t0, x0, v0), (error,) * 3)
            for _ in range(4):
                try:
                    after = next_event(problem, state, ball(start["t_end"]))
                except Undecided:
                    break
                if after is None:
                    break
                event, state = after
                found.append((event, exact_ends(event.t), exact_ends(event.x)))
        for signs in ((1, 1, 1), (-1, 1, -1), (1, -1, 0)):
            corner = [value + sign * error for value, sign in zip((t0, x0, v0), signs, strict=True)]
            run = simulate(p, t0=corner[0], x0=corner[1], v0=corner[2], t_end=start["t_end"], digits=25, max_events=4)
            for (event, t, x), other in zip(found, run.events, strict=False):
                assert (event.kind, event.source, event.target) == (other.kind, other.source, other.target)
                for (low, high), value in ((t, other.t), (x, other.x)):
                    rounding = max(1, abs(Fraction(str(value)))) / Fraction(10) ** 24
                    assert low - rounding <= Fraction(str(value)) <= high + rounding
