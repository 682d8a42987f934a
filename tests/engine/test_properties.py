"""Properties over random scenes of all regimes: symmetries and invariants.

Times and positions must agree to 1e-12, plus what a few units of rounding do to that event: the
oracle is run from pushed starts to see how much that is (`oracle_and_condition`). Events that a
push of 1e-10 changes are left out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from agreement import oracle_and_condition
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from samples import sample_of

from symosc import Parameters, simulate

REGIMES = [
    "underdamped",
    "critical",
    "overdamped",
    "undamped",
    "resonance",
    "near resonance",
    "no spring",
    "free",
]
ROUNDING = 2e-14  # about a hundred roundings
COMMON = settings(
    derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)


class Start(NamedTuple):
    p: Parameters
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction


def tenths(low: int, high: int) -> st.SearchStrategy[Fraction]:
    return st.integers(low, high).map(lambda n: Fraction(n, 10))


@st.composite
def starts(draw: Any) -> Start:
    """Return a scene whose numbers have a digit or two, so that exact coincidences happen too."""
    regime = draw(st.sampled_from(REGIMES))
    m = draw(tenths(2, 30))
    Omega = draw(tenths(3, 40))
    c = draw(tenths(1, 10))
    k = draw(tenths(5, 60))
    if regime == "critical":
        k = c * c / (4 * m)
    elif regime == "overdamped":
        c = c + 6
        k = k / 10
    elif regime == "undamped":
        c = Fraction(0)
    elif regime in ("resonance", "near resonance"):
        c = Fraction(0)
        k = m * Omega**2
        if regime == "near resonance":
            c = Fraction(1, 10 ** draw(st.integers(3, 12)))
    if regime in ("no spring", "free"):
        k = Fraction(0)
    if regime == "free":
        c = Fraction(0)
    v1 = draw(tenths(-30, 20))
    v2 = v1 + draw(tenths(1, 40))
    mu1 = draw(tenths(0, 10))
    mu2 = draw(tenths(0, 10))
    A0 = draw(tenths(-30, 30))
    B0 = draw(tenths(2, 100)) * draw(st.sampled_from([1, -1]))
    p = Parameters(
        m=m,
        c=c,
        k=k,
        A0=A0,
        B0=B0,
        Omega=Omega,
        v1=v1,
        v2=v2,
        mu1=mu1,
        mu2=mu2,
        FN=draw(tenths(1, 150)),
    )
    v0 = draw(st.one_of(tenths(-40, 70), st.sampled_from([v1, v2])))
    t0 = draw(tenths(-20, 100))
    return Start(p, t0, draw(tenths(-30, 30)), v0, t0 + draw(st.integers(8, 20)))


def for_all(count: int, check: Callable[..., None], *strategies: Any) -> None:
    """Run a check on so many examples."""
    settings(COMMON, max_examples=count)(given(*strategies)(check))()


def run(start: Start) -> Any:
    return simulate(start.p, t0=start.t0, x0=start.x0, v0=start.v0, t_end=start.t_end)


LABELS = {
    (1, "belt1", 1): "P1",
    (1, "Omega1", 1): "P2",
    (1, "Omega2", 1): "P3",
    (2, "belt2", 2): "P4",
    (2, "Omega2", 2): "P5",
    (2, "Omega3", 2): "P6",
    (2, "Omega2", 1): "P7",
    (1, "Omega2", 2): "P8",
}


@pytest.mark.slow
def test_words_name_the_mappings_between_events() -> None:
    seen: Counter[str] = Counter()

    @settings(COMMON, max_examples=40)
    @given(starts())
    def check(start: Start) -> None:
        trajectory = run(start)
        events = list(trajectory.events)
        between = [LABELS[a.boundary, a.target, b.boundary] for a, b in pairwise(events)]
        word = list(trajectory.word)
        if events and start.v0 in (
            start.p.v1,
            start.p.v2,
        ):  # the first motion, too, leads from a belt to a belt
            if start.v0 == start.p.v1:
                at = 1
            else:
                at = 2
            between.insert(0, LABELS[at, events[0].source, events[0].boundary])
        assert word == between
        seen.update(word)

    check()
    assert set(seen) == set(LABELS.values())


@pytest.mark.parametrize("count", [6, pytest.param(60, marks=pytest.mark.slow)])
def test_invariants(count: int) -> None:
    for_all(count, invariants, starts())


def invariants(start: Start) -> None:
    p = start.p
    trajectory = run(start)
    events = list(trajectory.events)
    times = [event.t for event in events]
    assert all(start.t0 < t <= start.t_end for t in times)
    assert all(a < b for a, b in pairwise(times))
    for event in events:
        low = f"Omega{event.boundary}"
        high = f"Omega{event.boundary + 1}"
        belt = f"belt{event.boundary}"
        assert event.v == float(p.belt(event.boundary))
        allowed = {
            "cross": [(low, high), (high, low)],
            "stick": [(low, belt), (high, belt)],
            "slip": [(belt, low), (belt, high)],
            "graze": [(low, low), (high, high)],
        }
        assert (event.source, event.target) in allowed[event.kind]
        assert 0 <= event.theta < 2 * np.pi
        turn = (float(event.theta) - float(p.Omega) * event.t) % (2 * np.pi)
        assert min(turn, 2 * np.pi - turn) < 1e-12 * max(1, abs(event.t)) * max(1, float(p.Omega))
        if event.kind == "slip":
            side = int(event.target[-1])
            terms = [
                p.A(side),
                p.B0 * Fraction(float(np.cos(event.theta))),
                -p.k * Fraction(event.x),
                -p.c * Fraction(event.v),
            ]
            assert abs(sum(terms)) <= 1e-11 * (1 + sum(map(abs, terms)))
    for before, after in pairwise(events):
        assert before.target == after.source
    borders = [float(start.t0), *times, float(start.t_end)]
    for i, (low_t, high_t) in enumerate(pairwise(borders)):
        if high_t - low_t < 1e-9:
            continue
        samples = low_t + (high_t - low_t) * np.array([0.01, 0.2, 0.5, 0.8, 0.99])
        modes = {str(trajectory.mode(t)) for t in samples}
        assert len(modes) == 1
        mode = modes.pop()
        if events:
            assert mode == (events[i - 1].target if i else events[0].source)
        states = trajectory(samples)
        assert states.shape == (2, 5)
        for t, (x, v) in zip(samples, states.T, strict=True):
            assert np.allclose(trajectory(t), (x, v), rtol=1e-14, atol=1e-14)
            assert_mode_holds(p, mode, t, x, v)


def assert_mode_holds(p: Parameters, mode: str, t: float, x: float, v: float) -> None:
    slack = 1e-11
    if mode.startswith("belt"):
        boundary = int(mode[-1])
        assert v == float(p.belt(boundary))
        below, above = (
            float(p.A(alpha))
            + float(p.B0) * np.cos(float(p.Omega) * t)
            - float(p.k) * x
            - float(p.c) * v
            for alpha in (boundary, boundary + 1)
        )
        size = (
            1
            + abs(float(p.A(boundary)))
            + abs(float(p.B0))
            + abs(float(p.k) * x)
            + abs(float(p.c) * v)
        )
        assert below >= -slack * size
        assert above <= slack * size
    else:
        lowest, highest = {"1": (-np.inf, p.v1), "2": (p.v1, p.v2), "3": (p.v2, np.inf)}[mode[-1]]
        assert float(lowest) - slack * (1 + abs(v)) <= v <= float(highest) + slack * (1 + abs(v))


@pytest.mark.slow
@sample_of(6, 200)
def test_a_restart_on_the_way_changes_nothing(count: int) -> None:
    for_all(count, a_restart_on_the_way_changes_nothing, starts(), st.integers(1, 9))


def a_restart_on_the_way_changes_nothing(start: Start, part: int) -> None:
    trajectory = run(start)
    t = start.t0 + (start.t_end - start.t0) * Fraction(part, 10)
    x, v = trajectory(float(t))
    again = Start(
        start.p,
        Fraction(str(float(t))),
        Fraction(str(float(x))),
        Fraction(str(float(v))),
        start.t_end,
    )
    _, conditions, determined = oracle_and_condition(*again)
    later = [event for event in trajectory.events if event.t > t]
    restarted = run(again)
    assert not determined or len(restarted.events) == len(later)
    for event, second, condition in zip(restarted.events, later, conditions, strict=False):
        assert (event.kind, event.source, event.target) == (
            second.kind,
            second.source,
            second.target,
        )
        # the state in between was rounded: 1e-12 of the first leg and the rounding of x, v and t
        slack = 1e-12 + 1e-12 * max(1, abs(x)) * condition
        assert abs(event.t - second.t) <= slack * max(1, abs(event.t))
        assert abs(event.x - second.x) <= slack * max(1, abs(event.x))


@pytest.mark.slow
@sample_of(6, 200)
def test_mirror_symmetry(count: int) -> None:
    for_all(count, mirror_symmetry, starts())


def mirror_symmetry(start: Start) -> None:
    p = start.p
    mirrored = p.replace(A0=-p.A0, B0=-p.B0, v1=-p.v2, v2=-p.v1, mu1=p.mu2, mu2=p.mu1)
    names = {
        "Omega1": "Omega3",
        "Omega2": "Omega2",
        "Omega3": "Omega1",
        "belt1": "belt2",
        "belt2": "belt1",
    }
    _, conditions, determined = oracle_and_condition(*start)
    here = run(start)
    there = run(Start(mirrored, start.t0, -start.x0, -start.v0, start.t_end))
    assert not determined or len(here.events) == len(there.events)
    for event, image, condition in zip(here.events, there.events, conditions, strict=False):
        assert (image.kind, image.boundary) == (event.kind, 3 - event.boundary)
        assert (image.source, image.target) == (names[event.source], names[event.target])
        assert abs(image.t - event.t) <= (1e-12 + ROUNDING * condition) * max(1, abs(event.t))
        assert abs(image.x + event.x) <= (1e-12 + ROUNDING * condition) * max(1, abs(event.x))


@pytest.mark.slow
@sample_of(6, 200)
def test_a_shift_by_whole_periods(count: int) -> None:
    for_all(
        count,
        a_shift_by_whole_periods,
        starts(),
        st.one_of(st.integers(-5, 5), st.integers(10**5, 10**8)),
    )


def a_shift_by_whole_periods(start: Start, periods: int) -> None:
    with mpmath.workdps(90):
        exactly = 2 * mpmath.pi * periods * start.p.Omega.denominator / start.p.Omega.numerator
        shift = Fraction(mpmath.nstr(exactly, 80))
    _, conditions, determined = oracle_and_condition(*start)
    moved = Start(start.p, start.t0 + shift, start.x0, start.v0, start.t_end + shift)
    here = run(start)
    there = run(moved)
    assert not determined or len(here.events) == len(there.events)
    for event, later, condition in zip(here.events, there.events, conditions, strict=False):
        assert (later.kind, later.source, later.target) == (event.kind, event.source, event.target)
        tolerance = 1e-12 + ROUNDING * condition
        assert abs(Fraction(later.t) - shift - Fraction(event.t)) <= tolerance * max(
            1, abs(event.t)
        ) + np.spacing(later.t)
        assert abs(later.x - event.x) <= tolerance * max(1, abs(event.x))
        turn = float(later.theta - event.theta) % (2 * np.pi)
        assert min(turn, 2 * np.pi - turn) <= tolerance * float(1 + start.p.Omega) * max(
            1, abs(event.t)
        )
