"""The oracle of general friction laws is checked before it judges.

Against reference values of another program, closed forms, the paper's oracle and scipy.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import law_oracle
import mpmath
import numpy as np
import pytest
from law_families import LawScene, scene_of
from law_oracle import LawBelt, LawRun, follow, friction_table
from law_reference import REFERENCES, Reference
from oracle import simulate_oracle
from scene_families import wide
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

DIGITS_KNOWN = 1e-24  # the printed values have 26 digits
SCIPY = 1e-8  # what rtol = 1e-12 leaves after some ten events


def label(event: Any) -> tuple[str, int, str, str]:
    return event.kind, event.boundary, event.source, event.target


def followed(reference: Reference, digits: int = 60) -> LawRun:
    run = follow(
        **reference.law,
        belts=reference.belts,
        t0=reference.start[0],
        x0=reference.start[1],
        v0=reference.start[2],
        t_end=reference.t_end,
        digits=digits,
    )
    return run


@pytest.mark.parametrize("reference", REFERENCES, ids=[case.name for case in REFERENCES])
def test_reference_values(reference: Reference) -> None:
    run = followed(reference)
    assert run.status == "t_end"
    assert [label(event) for event in run.events] == [label(event) for event in reference.events]
    with mpmath.workdps(60):
        for event, expected in zip(run.events, reference.events, strict=True):
            for name in ("t", "x"):
                true = mpmath.mpf(getattr(expected, name))
                assert abs(getattr(event, name) - true) < DIGITS_KNOWN * max(1, abs(true))
        if reference.mode:
            assert run.mode == reference.mode
            assert abs(run.x - mpmath.mpf(reference.x)) < DIGITS_KNOWN
            assert abs(run.v - mpmath.mpf(reference.v)) < DIGITS_KNOWN


def test_it_shares_nothing_with_the_package() -> None:
    assert "symosc" not in Path(law_oracle.__file__).read_text()


def test_what_equality_decides_is_said() -> None:
    ties = {case.name: [event.tie for event in followed(case).events] for case in REFERENCES}
    assert [name for name, said in ties.items() if any(said)] == ["S2", "S3"]
    assert ties["S2"] == [True] + 9 * [False]
    assert ties["S3"] == [True] + 9 * [False]


@pytest.mark.parametrize("reference", REFERENCES, ids=[case.name for case in REFERENCES])
def test_sixty_digits_and_ninety(reference: Reference) -> None:
    run = followed(reference)
    more = followed(reference, 90)
    assert [label(event) for event in run.events] == [label(event) for event in more.events]
    with mpmath.workdps(100):
        assert all(
            abs(here.t - there.t) + abs(here.x - there.x) < 1e-55
            for here, there in zip(run.events, more.events, strict=True)
        )
        assert abs(run.x - more.x) + abs(run.v - more.v) < 1e-55


def test_the_bands_of_a_curve() -> None:
    """Worked out by hand for S6."""
    belts = [LawBelt(3, curve=[(0, 2), (2, 1), (5, "2/5")])]
    edges, bands = friction_table(1, 0, 1, belts)
    assert [edge.V for edge in edges] == [-2, 1, 3, 5, 8]
    assert [edge.J for edge in edges] == [0, 0, 4, 0, 0]
    fifth = Fraction(1, 5)
    half = Fraction(1, 2)
    assert [(band.c, band.A) for band in bands] == [
        (1, 2 * fifth),
        (4 * fifth, 4 * fifth),
        (half, half),
        (half, -7 * half),
        (4 * fifth, -2),
        (1, -2 * fifth),
    ]
    assert [band.domain for band in bands] == [1, 1, 1, 2, 2, 2]


@pytest.mark.parametrize(
    ("m", "k", "V", "f", "s"), [(1, 1, "1/5", "1/2", 1), ("1/3", 5, "3/7", "2/9", "5/9")]
)
def test_the_cycle_without_damping(m: Any, k: Any, V: Any, f: Any, s: Any) -> None:
    """T = 2 a/V + (2/w)(pi - atan(a w/V)), a = (s - f)/k; the start is where the mass slips."""
    belts = [LawBelt(V, f, s)]
    run = follow(m, 0, k, 0, 0, None, 1, belts, 0, Fraction(s) / Fraction(k), V, 200, 8)
    assert [event.kind for event in run.events[:4]] == ["stick", "slip", "stick", "slip"]
    with mpmath.workdps(60):
        m, k, V, f, s = (
            mpmath.mpf(Fraction(value).numerator) / Fraction(value).denominator
            for value in (m, k, V, f, s)
        )
        a = (s - f) / k
        w = mpmath.sqrt(k / m)
        period = 2 * a / V + 2 / w * (mpmath.pi - mpmath.atan(a * w / V))
        for first, second in zip(run.events, run.events[2:], strict=False):
            assert abs(second.t - first.t - period) < 1e-57 * period


def test_where_the_cycle_with_damping_ends() -> None:
    """The slip returns to the belt by touching it: at a speed known from v = V, v' = 0."""
    speed = Fraction("0.54904631205793634574394182271822")
    for change, kinds in ((-1, ["stick", "slip"]), (1, [])):
        V = speed + change * Fraction(1, 10**20)
        belts = [LawBelt(V, "1/2", 1)]
        x0 = 1 - V / 10
        run = follow(1, "1/10", 1, 0, 0, None, 1, belts, 0, x0, V, 12, 2)
        assert [event.kind for event in run.events] == kinds


def test_close_to_a_tie_is_undecided() -> None:
    """S2 missed by 1e-30 of its amplitude: too close for 60 digits, decided with 100."""
    change = Fraction(1, 10**30)
    runs = [
        follow(
            1, 0, 1, 0, Fraction(3, 2) * (1 - change), "1/2", 1, [LawBelt(1, "1/2", 1)],
            0, Fraction(5, 2) - 2 * change, 0, 20, digits=digits,
        )
        for digits in (60, 100)
    ]  # fmt: skip
    assert [run.status for run in runs] == ["undecided", "t_end"]
    assert "distance to a belt" in runs[0].message


#: Numbers of `wide` scenes, among them critical and near-critical damping, resonance, k = 0.
PAPER_SCENES = range(40)


@pytest.mark.full(20)
@pytest.mark.parametrize(
    "number", [pytest.param(n, marks=() if n < 10 else pytest.mark.slow) for n in PAPER_SCENES]
)
def test_the_papers_oracle(number: int) -> None:
    """Two Coulomb belts: another program answers too."""
    scene = wide(Random(f"laws:{number}"), number)
    p = scene.p
    t_end = min(scene.t_end, scene.t0 + 30)
    theirs = simulate_oracle(p, scene.t0, scene.x0, scene.v0, t_end, 50, 12)
    belts = [LawBelt(p.v1, p.mu1), LawBelt(p.v2, p.mu2)]
    ours = follow(
        p.m, p.c, p.k, p.A0, p.B0, p.Omega, p.FN, belts,
        scene.t0, scene.x0, scene.v0, t_end, 12, 50,
    )  # fmt: skip
    assert [label(event) for event in ours.events] == [label(event) for event in theirs.events]
    with mpmath.workdps(50):
        for here, there in zip(ours.events, theirs.events, strict=True):
            assert abs(here.t - there.t) < 1e-38 * max(1, abs(there.t))
            assert abs(here.x - there.x) < 1e-38 * max(1, abs(there.x))


def test_a_falling_curve_by_refinement() -> None:
    """Leine and others (1998): V = 0.2, f = 1/(1 + 3 w); the smooth law's period is known."""
    periods = []
    for pieces in (16, 64):
        places = [Fraction(3, 2) * Fraction(i * i, pieces * pieces) for i in range(pieces + 1)]
        belts = [LawBelt("1/5", curve=[(w, 1 / (1 + 3 * w)) for w in places])]
        run = follow(1, 0, 1, 0, 0, None, 1, belts, 0, 1, "1/5", 30, 3, digits=30)
        assert [event.kind for event in run.events] == ["stick", "slip", "stick"]
        periods.append(float(run.events[2].t - run.events[0].t))
    known = 12.0010312948305786469
    coarse, fine = (period - known for period in periods)
    assert abs(fine) < 2e-4
    # the error falls with the square of the pieces
    assert abs(fine - (coarse - fine) / 15) < 1e-5


def test_decay_onto_a_belt_without_friction() -> None:
    """What no digit tells from rest crosses nothing: m v' = A0 - c v ends at A0/c, a belt's speed."""
    run = follow(1, 2, 0, 1, 0, None, 1, [LawBelt("1/2", 0, 0)], 0, 0, 3, 100)
    assert (run.status, run.mode, run.events) == ("t_end", "Omega2", [])
    with mpmath.workdps(60):
        assert abs(run.x - mpmath.mpf("51.25")) < 1e-50  # 100/2 + (3 - 1/2)/2
    run = follow(1, 5, 4, 0, 0, None, 1, [LawBelt(0, 0, 0)], 0, 3, 1, 100)
    assert [event.kind for event in run.events] == ["cross"]


# -- scipy -----------------------------------------------------------------------------------------


def by_scipy(scene: LawScene, most: int) -> list[tuple[float, str, int, float]]:
    """Follow a scene with DOP853 and event functions, from the law as it is written: (t, kind, belt, x).

    Sides of belts are fixed during a flight, so corners are all that is not smooth in it.
    """
    m, c, k, A0, B0, FN, Omega = (
        float(value)
        for value in (scene.m, scene.c, scene.k, scene.A0, scene.B0, scene.FN, scene.Omega or 1)
    )
    belts = sorted(scene.belts, key=lambda belt: belt.v)
    speeds = [float(belt.v) for belt in belts]
    curves = [belt.curve or [(0, belt.mu)] for belt in belts]

    def kinetic(number: int, w: float) -> float:
        places = [float(place) for place, _ in curves[number]]
        values = [float(value) for _, value in curves[number]]
        beyond = float(belts[number].slope or 0) * max(0.0, w - places[-1])
        return FN * (float(np.interp(w, places, values)) + beyond)

    def drive(t: float, x: float, v: float) -> float:
        return A0 + B0 * np.cos(Omega * t) - c * v - k * x

    def acceleration(t: float, x: float, v: float, sides: list[int]) -> float:
        friction = sum(
            side * kinetic(number, abs(v - speeds[number])) for number, side in enumerate(sides)
        )
        return (drive(t, x, v) - friction) / m

    def needed(t: float, x: float, number: int) -> float:
        """Return the force that belt `number` must bring up to carry the mass."""
        v = speeds[number]
        others = sum(
            (1 if v > speeds[other] else -1) * kinetic(other, abs(v - speeds[other]))
            for other in range(len(belts))
            if other != number
        )
        return others - drive(t, x, v)

    def static(number: int) -> float:
        here = belts[number].mu_s
        return kinetic(number, 0.0) if here is None else FN * float(here)

    def fly(t: float, x: float, v: float, sides: list[int], span: float, skip: int | None) -> Any:
        events = []
        for number in range(len(belts)):
            if number != skip:
                event = lambda t, y, number=number: y[1] - speeds[number]  # noqa: E731
                event.terminal = True
                events.append(event)
        return solve_ivp(
            lambda t, y: (y[1], acceleration(t, y[0], y[1], sides)),
            (t, min(t + span, t_end)),
            (x, v),
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            events=events or None,
            max_step=0.05 / Omega,  # it misses what comes and goes within a step
        )

    t = float(scene.t0)
    x = float(scene.x0)
    v = float(scene.v0)
    t_end = float(scene.t_end)
    found: list[tuple[float, str, int, float]] = []
    on = next((n for n, belt in enumerate(belts) if belt.v == scene.v0), None)
    sides = [1 if v > speed else -1 for speed in speeds]
    stuck = False
    arrived = None  # kind of the last flight: None at the start
    while t < t_end and len(found) < most:
        if on is not None and not stuck:
            force = needed(t, x, on)
            stuck = abs(force) <= static(on)
            before = sides[on]
            if not stuck:
                sides[on] = -1 if force > 0 else 1
            if arrived is not None:
                kind = "stick" if stuck else "graze" if sides[on] == before else "cross"
                found.append((t, kind, on + 1, x))
        if stuck:
            assert on is not None
            number = on
            reach = lambda s, t=t, x=x, number=number: (  # noqa: E731
                abs(needed(t + s, x + speeds[number] * s, number)) - static(number)
            )
            step = 0.01 / Omega
            s = 0.0
            while t + s < t_end and reach(s + step) <= 0:
                s += step
            if t + s >= t_end:
                break
            s = brentq(reach, s, s + step, xtol=1e-15) if reach(s) < 0 else s
            t += s
            x += speeds[number] * s
            v = speeds[number]
            sides[number] = -1 if needed(t, x, number) > 0 else 1
            found.append((t, "slip", number + 1, x))
            stuck = False
        # away from the belt first, so that its own event does not fire at once
        if on is not None:
            away = fly(t, x, v, sides, 1e-3, on)
            t = float(away.t[-1])
            x, v = (float(value) for value in away.y[:, -1])
        rest = fly(t, x, v, sides, np.inf, None)
        t = float(rest.t[-1])
        x, v = (float(value) for value in rest.y[:, -1])
        if rest.status != 1:
            break
        on = next(n for n, times in enumerate(rest.t_events) if len(times))
        v = speeds[on]
        arrived = True
    return found[:most]


SCIPY_SCENES = [("plain", n) for n in range(6)] + [
    (family, 3)
    for family in ("onbelt", "still", "free", "undamped", "undriven", "overdamped", "chaotic")
] + [("curved", n) for n in range(4)]  # fmt: skip


@pytest.mark.full(9)
@pytest.mark.parametrize(("family", "number"), SCIPY_SCENES)
def test_scipy(family: str, number: int) -> None:
    scene = scene_of(family, 7, number, 3)
    ours = scene.truth(40)
    theirs = by_scipy(scene, 12)
    assert [(event.kind, event.boundary) for event in ours.events[:12]] == [
        (kind, belt) for _, kind, belt, _ in theirs
    ]
    for event, (t, _, _, x) in zip(ours.events, theirs, strict=False):
        assert abs(float(event.t) - t) < SCIPY * max(1, abs(t))
        assert abs(float(event.x) - x) < SCIPY * max(1, abs(x))
