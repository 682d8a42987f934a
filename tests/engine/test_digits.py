"""Many digits: MPFR beside mpmath, and one precision for all threads."""

from __future__ import annotations

import importlib
import random
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from importlib.util import find_spec
from typing import Any

import mpmath
import pytest
from samples import sample_of

from symosc import (
    Parameters,
    find_orbit,
    grazing_start,
    grazing_window,
    jacobian,
    load_scene,
    simulate,
    solve_map,
)
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.start import Start
from symosc.kernels.multiprecision import mp_context
from symosc.simulation import motion

if find_spec("gmpy2"):
    gmpy2: Any = importlib.import_module("gmpy2")
else:
    gmpy2 = None
if gmpy2:
    mpfr: Any = importlib.import_module("symosc.kernels.mpfr")
else:
    mpfr = None
needs_gmpy2 = pytest.mark.skipif(gmpy2 is None, reason="needs gmpy2")


THREADS = 8
Job = Callable[[], Any]


@pytest.fixture(autouse=True)
def quick_switches() -> Iterator[None]:
    """Let threads take turns as often as Python can."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(usual)


def problem(seed: int) -> tuple[Parameters, dict[str, Any]]:
    """Return random parameters in all regimes of damping, and a start, some on a belt."""
    dice = random.Random(seed)
    numbers = {
        name: Fraction(dice.randint(10, 300), 100) for name in ("m", "k", "A0", "B0", "Omega", "FN")
    }
    c = dice.choice((Fraction(0), Fraction(dice.randint(1, 500), 100)))
    p = Parameters(v1=-1, v2=1, mu1="0.3", mu2="0.4", c=c, **numbers)
    start = {
        "t0": dice.randint(0, 50),
        "x0": Fraction(dice.randint(-99, 99), 50),
        "v0": dice.choice(("0.37", 1, -2)),
    }
    return p, {**start, "t_end": start["t0"] + 12}


def followed(start: Start, arithmetic: MpArithmetic) -> motion.Motion:
    path = motion.Motion(start, arithmetic)
    while not path.ended:
        path.step()
    return path


@needs_gmpy2
@sample_of(12, 300)
def test_the_events_are_those_of_mpmath(count: int) -> None:
    seen = 0
    for seed in range(count):
        p, arguments = problem(seed)
        start = Start(p, **{name: Fraction(value) for name, value in arguments.items()})
        digits = random.Random(seed).choice((20, 36, 60, 111))
        fast, plain = (MpArithmetic(p, digits, fast) for fast in (True, False))
        assert fast.following is not fast.namespace
        ours = followed(start, fast)
        theirs = followed(start, plain)
        assert (ours.code, ours.decided, ours.count) == (theirs.code, theirs.decided, theirs.count)
        for a, b in zip(ours.events(), theirs.events(), strict=True):
            assert (a.kind, a.boundary, a.source, a.target) == (
                b.kind,
                b.boundary,
                b.source,
                b.target,
            ), seed
            assert a.t.context is b.t.context is mp_context(digits)
            assert abs(a.t - b.t) <= 20 * b.t_error, seed
            assert abs(a.x - b.x) <= 20 * b.x_error, seed
            assert a.t_error == pytest.approx(b.t_error, rel=1e-3)
        assert ours.columns()[2].tolist() == theirs.columns()[2].tolist()
        seen += ours.count
    assert seen > 3 * count


@needs_gmpy2
def test_the_precision_of_others_is_left_alone() -> None:
    """Whatever precision a thread has for itself, and however many digits other threads ask for at the same time."""
    scene = load_scene("fig5")

    def told(digits: int) -> Any:
        trajectory = simulate(scene, digits=digits, t_end=8)
        return [(event.t, event.x, event.t_error) for event in trajectory.events], trajectory.status

    wanted = {digits: told(digits) for digits in (17, 20, 33, 50)}

    def job(n: int) -> None:
        own = gmpy2.context(precision=11 + 100 * n, round=gmpy2.RoundUp)
        gmpy2.set_context(own)
        third = gmpy2.mpfr(1) / 3
        for digits in random.Random(n).sample(sorted(wanted), 4):
            assert told(digits) == wanted[digits]
            assert gmpy2.get_context() is own
            assert gmpy2.mpfr(1) / 3 == third

    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(job, range(8)))


WITHOUT = """
import sys
sys.modules["gmpy2"] = None
from symosc import load_scene, simulate, solve_map
from symosc.engine.arithmetic import MpArithmetic
from symosc.kernels.multiprecision import mp_context
arithmetic = MpArithmetic(load_scene("fig5").parameters, 30)
assert arithmetic.following is arithmetic.namespace
for name in ("fig8", "fig8-exact"):
    print([(e.kind, str(e.t), str(e.x)) for e in simulate(name, digits=25, max_events=4).events])
    print([(e.kind, e.t, e.x, e.t_error) for e in simulate(name, max_events=4).events])
start = mp_context(25).mpf("4.5"), mp_context(25).mpf("0.5")
print(solve_map(load_scene("fig9").parameters, "P2", *start).x)
"""


@needs_gmpy2
@pytest.mark.slow
def test_without_gmpy2_the_results_are_the_same() -> None:
    without = subprocess.run(
        [sys.executable, "-c", WITHOUT], check=True, capture_output=True, text=True
    ).stdout
    lines = []
    for name in ("fig8", "fig8-exact"):
        lines.append(
            [(e.kind, str(e.t), str(e.x)) for e in simulate(name, digits=25, max_events=4).events]
        )
        lines.append([(e.kind, e.t, e.x, e.t_error) for e in simulate(name, max_events=4).events])
    start = mp_context(25).mpf("4.5"), mp_context(25).mpf("0.5")
    lines.append(solve_map(load_scene("fig9").parameters, "P2", *start).x)
    assert without.splitlines() == [str(line) for line in lines]


def in_threads(jobs: list[Job], repeats: int = 3) -> None:
    """Run every job in several threads at once.

    Each must return what it does alone, before and after.
    """
    alone = [repr(job()) for job in jobs]
    order = [
        n
        for seed in range(repeats)
        for n in random.Random(seed).sample(range(len(jobs)), len(jobs))
    ]
    prec = mpmath.mp.prec
    with ThreadPoolExecutor(THREADS) as pool:
        together = list(pool.map(lambda n: (n, repr(jobs[n]()), mpmath.mp.prec), order))
    assert {seen for _, _, seen in together} == {prec}
    assert [n for n, computed, _ in together if computed != alone[n]] == []
    assert [repr(job()) for job in jobs] == alone


@pytest.mark.slow
def test_orbits_grazing_starts_and_windows() -> None:
    scene = load_scene("fig9-orbit")
    fig8 = load_scene("fig8").parameters
    orbit = find_orbit(scene.parameters, scene.structure)
    window = grazing_window(fig8, "P3")
    jobs: list[Job] = [
        lambda d=d: find_orbit(scene.parameters, "P32", orbit, digits=d).points
        for d in (20, 30, 45)
    ]
    jobs += [
        lambda d=d: grazing_start(fig8, "P3", t_m="3.14159", t0="2.5", digits=d)
        for d in (15, 25, 40)
    ]
    jobs += [lambda n=n: window.contains(Fraction(n, 1000)) for n in (1, 100, 3141, 12345)]
    in_threads(jobs)


@pytest.mark.slow
def test_maps_of_mpmath_numbers() -> None:
    """Also those of mpmath's own context, whose precision is the caller's."""
    scene = load_scene("fig9-orbit")
    p = scene.parameters
    points = find_orbit(scene.parameters, "P32").points

    def job(number: Any, i: int) -> Any:
        t, x = points[i]
        start = number(x), number(t * float(p.Omega))
        later = number(x) + number(1) / 3, start[1] + number(2)
        return jacobian(p, ("P2", "P3")[i], start, later)

    def solved(number: Any) -> Any:
        t, x = points[0]
        end = solve_map(p, "P2", number(x), number(t * float(p.Omega)))
        return end.x, end.theta, end.derivative

    kinds = [mpmath.mpf, mp_context(25).mpf, mp_context(40).mpf]
    jobs: list[Job] = [lambda kind=kind, i=i: job(kind, i) for kind in kinds for i in (0, 1)]
    in_threads(jobs + [lambda kind=kind: solved(kind) for kind in kinds], repeats=20)
