"""Other people's solvers: right where they can be, and each known trap where it is."""

from __future__ import annotations

import pickle
import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import cos, sin
from typing import Any

import mpmath
import numpy as np
import pytest
from parameter_sets import DIP, EASY

from symosc import Parameters, Scene, load_scene, simulate, simulate_many
from symosc.bench import peers_heyoka, peers_scan
from symosc.bench.event_logic import CHATTER, PeerError, problem, resolve, speed_scales
from symosc.bench.solvers import OURS, Solver, SolverEvent, all_solvers, multiprecision

SOLVERS = {solver.name: solver for solver in all_solvers()}
PEERS = [solver for solver in all_solvers() if solver not in OURS]
#: Those that take microseconds an event, and a minute to compile; and those that Python calls.
FAST = [solver for solver in PEERS if not solver.name.startswith("scipy")]
SLOW = [solver for solver in PEERS if solver not in FAST]
COMPILED = pytest.mark.slow  # compiles for half a minute


def found_by(solver: Solver, scene: Scene, tolerance: float | None = None) -> Sequence[SolverEvent]:
    if solver.missing:
        pytest.skip(solver.missing)
    return list(solver.prepare(scene, solver.tolerances[-1] if tolerance is None else tolerance)())


def words(events: Sequence[Any]) -> list[tuple[str, int]]:
    return [(event.kind, event.boundary) for event in events]


def error(found: Sequence[Any], exact: Sequence[Any]) -> float:
    """Return the largest error of a time or position, after the events have been found to be the
    same.
    """
    assert words(found) == words(exact)
    pairs = list(zip(found, exact, strict=True))
    return float(
        max((abs(a - b) for f, e in pairs for a, b in ((f.t, e.t), (f.x, e.x))), default=0)
    )


def test_solvers_say_what_they_are() -> None:
    assert len(SOLVERS) == len(all_solvers())
    assert all_solvers()[:2] == OURS
    for solver in all_solvers():
        assert list(solver.tolerances) == sorted(solver.tolerances, reverse=True), solver.name
        assert solver in OURS or solver.note
        assert pickle.loads(pickle.dumps(solver)).name == solver.name  # runs in another process


# -- the event logic -------------------------------------------------------------------------------


def test_the_phase_at_a_late_origin_has_all_digits() -> None:
    q = problem(load_scene("fig9").parameters, Fraction(10**12) + Fraction("0.1324"))
    with mpmath.workdps(50):
        assert abs(mpmath.sin(4 * (10**12 + mpmath.mpf("0.1324"))) - sin(q.theta)) < 1e-15


def test_what_follows_at_a_boundary() -> None:
    p = load_scene("fig8").parameters
    q = problem(p)
    places = {
        (1, -100.0): 2,
        (1, 100.0): 1,
        (2, -100.0): 3,
        (2, 100.0): 2,
    }  # both forces upward, or downward
    places[1, float((p.A(1) + p.A(2)) / 2 + p.B0 - p.c * p.v1) / float(p.k)] = (
        4  # half way between the two forces
    )
    assert {(boundary, x): resolve(q, boundary, 0.0, x) for boundary, x in places} == places


@pytest.mark.parametrize("seed", range(20))
def test_a_force_that_vanishes_up_to_rounding(seed: int) -> None:
    """On the set where F^(2) = 0 on belt 1 the motion leaves upward if F^(2) grows, else the belt
    takes it.
    """
    q = problem(load_scene("fig8").parameters.replace(v1="-3.7"))
    t = random.Random(seed).uniform(0, 20)
    x = (q.A2 + q.swing * cos(q.Omega * t) - q.damping * q.v1) / q.stiffness
    growing = -q.stiffness * q.v1 - q.swing * q.Omega * sin(q.Omega * t) > 0
    assert resolve(q, 1, t, x) == (2 if growing else 4)


# -- integrators called from Python ----------------------------------------------------------------


@pytest.mark.quick(4)
@pytest.mark.parametrize("name", ["fig9", "fig5", "fig10"])
@pytest.mark.parametrize("solver", SLOW, ids=lambda solver: solver.name)
def test_integrators_on_easy_scenes(solver: Solver, name: str) -> None:
    start = replace(load_scene(name), t_end=Fraction({"fig5": 13, "fig9": 4, "fig10": 8}[name]))
    exact = simulate(start, digits=30).events
    coarse, fine = (error(found_by(solver, start, tolerance), exact) for tolerance in (1e-5, 1e-8))
    assert coarse < 3e-4
    assert fine < min(1e-6, max(coarse / 5, 1e-9))


@pytest.mark.quick(3)
@pytest.mark.parametrize("solver", SLOW, ids=lambda solver: solver.name)
def test_integrators_in_their_traps(solver: Solver) -> None:
    """A stick of 2.6 ms, one of 0.9 ms, a flight that is back within a step, and a late start."""
    micro = replace(load_scene("fig8"), t_end=Fraction(5))
    exact = simulate(micro, digits=30).events
    assert [event.kind for event in exact] == ["stick", "slip"]
    assert exact[1].t - exact[0].t < 0.003
    assert error(found_by(solver, micro, 1e-8), exact) < 1e-4
    peak = load_scene("fig7-corrected")
    assert error(found_by(solver, peak, 1e-7), simulate(peak).events) < 1e-3
    for tolerance in (1e-4, 1e-8):
        assert error(found_by(solver, DIP, tolerance), simulate(DIP).events) < 500 * tolerance
    late = replace(load_scene("fig9"), t0=10**10 + Fraction("0.1324"), t_end=Fraction(10**10 + 4))
    assert (
        error(found_by(solver, late, 1e-8), simulate(late).events) < 1e-5
    )  # the last bit of 1e10 is 2e-6


@pytest.mark.parametrize(
    ("name", "tolerance", "allowed"),
    [("scipy DOP853", 1e-12, 1e-12), ("scipy LSODA", 1e-8, 5e-8), ("heyoka", 1e-16, 2e-14)],
)
def test_a_belt_that_is_never_met_costs_no_digits(
    name: str, tolerance: float, allowed: float
) -> None:
    """Flights start off a belt in proportion to its own speed, not to that of the other one."""
    scene = load_scene("fig5")
    for v2 in ("1e3", "1e9"):
        far = replace(scene, parameters=scene.parameters.replace(v2=v2), t_end=Fraction(8))
        exact = simulate(far, digits=30).events
        assert {event.boundary for event in exact} == {1}
        assert error(found_by(SOLVERS[name], far, tolerance), exact) < allowed


@pytest.mark.parametrize(
    ("motion", "expected"),
    [((0.5, 0.0), (1.0, 1e6)), ((10.0, 0.0), (5.0, 1e6)), ((0.0, 1e9), (1e6, 1e6))],
)
def test_the_speed_scale_of_a_belt(
    motion: tuple[float, float], expected: tuple[float, float]
) -> None:
    """The belt's own speed, or that of a faster motion, up to the speed of the other belt."""
    p = EASY.replace(B0=0, A0=0, mu1=0, mu2=0, m=1, k=1, c=0, Omega=2, v1=1, v2=1_000_000)
    assert speed_scales(problem(p), *motion) == expected
    rest = problem(p.replace(v1=0))
    assert speed_scales(rest, 0.0, 0.0) == (1e6, 1e6)  # nothing moves there: any offset will do


# -- compiled solvers ------------------------------------------------------------------------------

#: Scenes that compiled solvers follow to the last digits, at their finest tolerance.
EASY_SCENES = {name: load_scene(name) for name in ("fig5", "fig6", "fig9", "fig10")}
EASY_SCENES |= {
    name: Scene(name, EASY.replace(**changes), t0, "1/10", 3, t0 + 20)  # type: ignore[arg-type]
    for name, changes, t0 in (
        ("critical damping", {"c": 4}, 0),
        ("overdamped", {"c": 5}, 0),
        ("little damping", {"c": "1/100"}, 0),
        ("light mass", {"m": "1/1000"}, 0),
        ("belt at rest", {"v1": 0}, 0),
        ("no friction on one belt", {"mu2": 0}, 0),
        ("late", {}, 10**10),
    )
}
EASY_SCENES |= {
    f"from {x0} on a belt at {speed}": Scene("on a belt", EASY, 0, x0, speed, 5)  # type: ignore[arg-type]
    for x0 in (-6, -1, 0, 1, 6)
    for speed in (EASY.v1, EASY.v2)
}


@COMPILED
@pytest.mark.full(12)
@pytest.mark.parametrize("name", EASY_SCENES)
@pytest.mark.parametrize("solver", FAST, ids=lambda solver: solver.name)
def test_the_events_of_an_easy_scene(solver: Solver, name: str) -> None:
    scene = EASY_SCENES[name]
    exact = simulate(scene, digits=30).events
    assert len(exact) >= 2
    # Events that are late are known to the last bit of their time.
    if name.startswith("fig"):
        allowed = 2e-13
    elif "belt at" in name:
        allowed = 1e-12
    else:
        allowed = 1e-11 + 2.0**-53 * scene.t0
    assert error(found_by(solver, scene), exact) <= allowed
    if name == "fig10":
        errors = [error(found_by(solver, scene, tolerance), exact) for tolerance in (1e-4, 1e-10)]
        assert errors[0] > 1e-9 > errors[1]


@pytest.mark.parametrize("peer", ["heyoka", pytest.param("numba", marks=COMPILED)])
@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_batches_of_others_count_what_we_count(name: str, peer: str) -> None:
    pytest.importorskip(peer)
    scene = load_scene(name)
    rng = np.random.default_rng(1)
    starts = np.column_stack(
        [rng.uniform(0, 6, 21), rng.uniform(-5, 5, 21), rng.uniform(-5, 5, 21)]
    )
    ours = simulate_many(
        scene.parameters, starts, starts[:, 0] + 20, record=("events",), use_numba=False
    ).events
    durations = np.full(21, 20.0)
    if peer == "heyoka":
        run = peers_heyoka.count_many(scene.parameters, starts, durations, 2e-13)
    else:
        run = peers_scan.count_many(scene.parameters, starts, durations, 2000, 2e-13)
    for _ in range(2):
        assert run().tolist() == ours.tolist()


def test_simulate_with_digits_is_followed_as_far_as_asked() -> None:
    scene = replace(load_scene("fig9"), t_end=Fraction(90))
    assert words(multiprecision(scene, 1e-20)()) == words(simulate(scene).events)


@COMPILED
def test_random_motions() -> None:
    """No compiled solver is wrong in any of sixty motions but the coarse scan, which misses events
    of some.
    """
    rng = random.Random(5)

    def number(low: float, high: float) -> str:
        return f"{rng.uniform(low, high):.3f}"

    available = [solver for solver in FAST if not solver.missing]
    wrong = dict.fromkeys((solver.name for solver in available), 0)
    for index in range(60):
        c = rng.choice(["0.05", number(0, 3), number(0, 20)])
        v1 = Fraction(number(-10, 5))
        rest = {
            "m": number(0.1, 3),
            "k": number(0.5, 10),
            "A0": number(-15, 15),
            "B0": number(-20, 20),
        }
        rest |= {
            "Omega": number(0.2, 5),
            "mu1": number(0, 1),
            "mu2": number(0, 1),
            "FN": number(0, 20),
        }
        p = Parameters(c=c, v1=v1, v2=v1 + Fraction(number(0.5, 12)), **rest)  # type: ignore[arg-type]
        scene = Scene(f"random {index}", p, number(0, 10), number(-8, 8), number(-10, 10), 30)
        events = simulate(scene).events
        for solver in available:
            found = found_by(solver, scene)
            wrong[solver.name] += words(found) != words(events) or error(found, events) > 1e-9
    coarse = wrong.pop("closed form, scan 20, numba", 1)
    assert not any(wrong.values()), wrong
    assert coarse


@COMPILED
def test_a_scan_of_twenty_points_misses_the_micro_stick() -> None:
    """fig8's first stick lasts 2.6 ms.

    The flight that ends in it is out and back between two samples.
    """
    scene = load_scene("fig8")
    exact = simulate(scene, digits=30).events
    coarse = found_by(SOLVERS["closed form, scan 20, numba"], scene)
    assert coarse[0].t > exact[1].t + 1
    fine = found_by(SOLVERS["closed form, scan 200, numba"], scene)
    assert [event.t for event in fine[:2]] == pytest.approx(
        [float(event.t) for event in exact[:2]], abs=1e-10
    )
    if not SOLVERS["heyoka"].missing:
        assert error(found_by(SOLVERS["heyoka"], scene), exact) < 1e-9


@COMPILED
@pytest.mark.parametrize("change", [{"k": 0}, {"c": 0, "Omega": 2}], ids=["no spring", "resonance"])
def test_where_the_closed_form_divides_by_zero(change: dict[str, int]) -> None:
    scene = Scene("singular", EASY.replace(**change), 0, 0, 0, 5)
    with pytest.raises(PeerError, match="divides by zero"):
        found_by(SOLVERS["closed form, scan 20, numba"], scene)
    exact = simulate(scene, digits=30).events
    assert error(found_by(SOLVERS["scipy DOP853"], scene), exact) < 1e-9


@COMPILED
@pytest.mark.parametrize("name", ["heyoka", "closed form, scan 20, numba"])
def test_more_events_than_the_first_table_holds(name: str) -> None:
    scene = load_scene("fig9")
    long = replace(scene, t_end=scene.t0 + 250)
    events = simulate(long).events
    assert len(events) > max(300, CHATTER)
    assert error(found_by(SOLVERS[name], long), events) < 1e-11
