"""Many digits by MPFR: what comes out is what mpmath says, and nobody's precision is disturbed."""

from __future__ import annotations

import random
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from typing import Any

import pytest
from samples import sample_of

from symosc import Parameters, load_scene, simulate, solve_map
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.paths import Paths
from symosc.engine.start import Start
from symosc.kernels.multiprecision import mp_context
from symosc.simulation.motion import Motion

gmpy2 = pytest.importorskip("gmpy2")
mpfr = pytest.importorskip("symosc.kernels.mpfr")


def problem(seed: int) -> tuple[Parameters, dict[str, Any]]:
    """Return random parameters in all regimes of damping, and a start, some on a belt."""
    dice = random.Random(seed)
    numbers = {name: Fraction(dice.randint(10, 300), 100) for name in ("m", "k", "A0", "B0", "Omega", "FN")}
    c = dice.choice((Fraction(0), Fraction(dice.randint(1, 500), 100)))
    p = Parameters(v1=-1, v2=1, mu1="0.3", mu2="0.4", c=c, **numbers)
    start = {"t0": dice.randint(0, 50), "x0": Fraction(dice.randint(-99, 99), 50), "v0": dice.choice(("0.37", 1, -2))}
    return p, {**start, "t_end": start["t0"] + 12}


def followed(start: Start, arithmetic: MpArithmetic) -> Motion:
    path = Motion(start, arithmetic)
    while not path.ended:
        path.step()
    return path


@sample_of(12, 300)
def test_the_events_are_those_of_mpmath(count: int) -> None:
    seen = 0
    for seed in range(count):
        p, given = problem(seed)
        start = Start(p, **{name: Fraction(value) for name, value in given.items()})
        digits = random.Random(seed).choice((20, 36, 60, 111))
        fast, plain = MpArithmetic(p, digits), MpArithmetic(p, digits)
        plain.__dict__["paths"] = Paths(plain.namespace)
        assert type(fast.paths) is not Paths
        ours, theirs = followed(start, fast), followed(start, plain)
        assert (ours.code, ours.decided, len(ours.events)) == (theirs.code, theirs.decided, len(theirs.events))
        for a, b in zip(ours.events, theirs.events, strict=True):
            assert (a.kind, a.boundary, a.source, a.target) == (b.kind, b.boundary, b.source, b.target), seed
            assert a.t.context is b.t.context is mp_context(digits)
            assert abs(a.t - b.t) <= 20 * b.t_error, seed
            assert abs(a.x - b.x) <= 20 * b.x_error, seed
            assert a.t_error == pytest.approx(b.t_error, rel=1e-3)
        assert [piece.mode for piece in ours.pieces] == [piece.mode for piece in theirs.pieces]
        seen += len(ours.events)
    assert seen > 3 * count


@pytest.mark.parametrize("digits", [5, 17, 36, 400])
def test_numbers_cross_the_border_exactly(digits: int) -> None:
    context, inner = mp_context(digits), mpfr.mpfr_context(mp_context(digits).prec)
    dice = random.Random(digits)
    numbers = [context.mpf(dice.uniform(-1, 1)) / 3 * context.mpf(2) ** dice.randint(-5000, 5000) for _ in range(50)]
    before = inner.enter()
    try:
        for number in [*numbers, context.mpf(0), context.inf, -context.inf]:
            there = mpfr.from_mpf(number)
            assert there.precision == context.prec
            back = mpfr.to_mpf(there, context)
            assert back == number
            assert back.context is context
    finally:
        inner.leave(before)


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

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(8) as pool:
            list(pool.map(job, range(8)))
    finally:
        sys.setswitchinterval(interval)


def test_an_error_leaves_the_precision_as_it_was() -> None:
    p, given = problem(1)
    path, before = (
        Motion(Start(p, **{name: Fraction(value) for name, value in given.items()}), 30),
        gmpy2.get_context(),
    )
    path._end = None, None  # type: ignore[assignment]
    with pytest.raises(TypeError):
        path.step()
    assert gmpy2.get_context() is before


WITHOUT = """
import sys
sys.modules["gmpy2"] = None
from symosc import load_scene, simulate, solve_map
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.paths import Paths
from symosc.kernels.multiprecision import mp_context
assert type(MpArithmetic(load_scene("fig5").parameters, 30).paths) is Paths
for name in ("fig8", "fig8-exact"):
    print([(e.kind, str(e.t), str(e.x)) for e in simulate(name, digits=25, max_events=4).events])
    print([(e.kind, e.t, e.x, e.t_error) for e in simulate(name, max_events=4).events])
start = mp_context(25).mpf("4.5"), mp_context(25).mpf("0.5")
print(solve_map(load_scene("fig9").parameters, "P2", *start).x)
"""


@pytest.mark.slow
def test_without_gmpy2_the_results_are_the_same() -> None:
    without = subprocess.run([sys.executable, "-c", WITHOUT], check=True, capture_output=True, text=True).stdout
    lines = []
    for name in ("fig8", "fig8-exact"):
        lines.append([(e.kind, str(e.t), str(e.x)) for e in simulate(name, digits=25, max_events=4).events])
        lines.append([(e.kind, e.t, e.x, e.t_error) for e in simulate(name, max_events=4).events])
    start = mp_context(25).mpf("4.5"), mp_context(25).mpf("0.5")
    lines.append(solve_map(load_scene("fig9").parameters, "P2", *start).x)
    assert without.splitlines() == [str(line) for line in lines]
