"""Events with many digits that doubles have searched for: those of a search with many digits, whatever doubles say."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import mpmath
import pytest

from symosc import Parameters, load_scene, simulate
from symosc.engine.arithmetic import Arithmetic, MpArithmetic
from symosc.engine.start import Start, rounded
from symosc.engine.state import CROSS, MOVED, SLIP, STICK, NextEvent, State
from symosc.simulation.motion import FinerMotion, Motion, last_time

DIGITS = 40
FINE = Fraction(1, 10**34)


def random_start(seed: int) -> Start:
    """Return a motion of any regime: with or without damping, spring and drive, stiff, resonant, from anywhere."""
    dice = random.Random(seed)
    c, k = dice.choice((0, 0.001, 0.1, 1, 4, 40)), dice.choice((0, 0.5, 4, 20, 80))
    p = Parameters(
        m=1,
        c=c,
        k=k,
        A0=dice.choice((0, dice.randint(-30, 30))),
        B0=dice.choice((0, dice.randint(1, 150))),
        Omega=dice.choice((2, Fraction(dice.randint(10, 800), 100))),
        v1=-Fraction(dice.randint(1, 40), 10),
        v2=Fraction(dice.randint(1, 40), 10),
        mu1=Fraction(dice.randint(0, 8), 10),
        mu2=Fraction(dice.randint(0, 8), 10),
        FN=dice.randint(0, 20),
    )
    v0 = dice.choice((p.v1, p.v2, Fraction(dice.randint(-60, 60), 10)))
    t0 = Fraction(dice.choice((0, dice.randint(0, 60))), 10)
    return Start(p, t0, Fraction(dice.randint(-30, 30), 10), v0, t0 + 9)


def pairs_of_steps(start: Start, most: int = 25) -> Iterator[tuple[Motion, Any, Any, State, NextEvent]]:
    """Yield what goes into a step with many digits, and take the step."""
    arithmetic, doubles = MpArithmetic(start.parameters, DIGITS), Arithmetic(start.parameters)
    path = Motion(start, arithmetic)
    end = last_time(start, doubles)
    for _ in range(most):
        rough = rounded(path.state, start)
        yield path, path._state, path._end, rough, doubles.paths.advance(rough, *end, doubles.K)
        path.step()
        if path.ended:
            return


def exact(number: Any) -> Fraction:
    """Return a number of any arithmetic as a fraction; mpmath's, where gmpy2 is missing, have no method for that."""
    if hasattr(number, "_mpf_"):
        return Fraction(*mpmath.libmp.to_rational(number._mpf_))
    return Fraction(*number.as_integer_ratio())


def assert_alike(near: NextEvent, full: NextEvent) -> None:
    assert near[:3] == full[:3]
    for a, b in zip(near.state[:8] + near.state[9:], full.state[:8] + full.state[9:], strict=True):
        assert abs(exact(a) - exact(b)) <= FINE * max(1, abs(int(b)))


def compared(path: Motion, state: Any, end: Any, rough: State, found: NextEvent) -> NextEvent:
    """Check a step against one that searches with many digits, and return it."""
    before = path._paths.enter()
    try:
        near: NextEvent = path._paths.advance_near(state, rough, found, *end, path.K)
        assert_alike(near, path._paths.advance(state, *end, path.K))
    finally:
        path._paths.leave(before)
    return near


@pytest.mark.parametrize("seed", range(60))
def test_steps_are_those_of_a_search_with_many_digits(seed: int) -> None:
    for step in pairs_of_steps(random_start(seed)):
        compared(*step)


def test_many_digits_do_not_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where doubles are sure, flights, sticks and flights without an event take no search of their own."""
    codes = set()
    for seed in range(60):
        for path, state, end, rough, found in pairs_of_steps(random_start(seed)):
            if found.decided and found.code in (CROSS, STICK, SLIP, MOVED) and not path.K.creeps:
                if found.code == MOVED and (state.mode > 3 or found.state.t - rough.t > 1.01 * path.K.chunk):
                    continue
                functions = path._paths.advance_near.__globals__
                with monkeypatch.context() as patch:
                    patch.setitem(functions, "advance", lambda *given: pytest.fail("a search with many digits"))
                    before = path._paths.enter()
                    codes.add(path._paths.advance_near(state, rough, found, *end, path.K).code)
                    path._paths.leave(before)
    assert codes >= {CROSS, STICK, SLIP, MOVED}


def shifted_by(found: NextEvent, part: float, rough: State) -> NextEvent:
    state = found.state
    return found._replace(state=state._replace(t=state.t + part * (state.t - rough.t)))


@pytest.mark.parametrize("seed", range(20))
def test_a_wrong_time_or_belt_is_not_believed(seed: int) -> None:
    for path, state, end, rough, found in pairs_of_steps(random_start(seed)):
        if found.code in (CROSS, STICK, SLIP):
            for part in (-0.3, -1e-6, 1e-6, 0.3):
                compared(path, state, end, rough, shifted_by(found, part, rough))
            compared(path, state, end, rough, found._replace(decided=False))
        if found.code in (CROSS, STICK):
            compared(path, state, end, rough, found._replace(boundary=3 - found.boundary))


def followed(monkeypatch: pytest.MonkeyPatch, start: Start, digits: int | None, searches: bool) -> Any:
    with monkeypatch.context() as patch:
        if not searches:
            patch.setattr(Motion, "_in_digits", lambda self, state: self._paths.advance(state, *self._end, self.K))
        times = {"t0": start.t0, "x0": start.x0, "v0": start.v0, "t_end": start.t_end}
        accuracy = {"accuracy": 1e-15} if digits is None else {"digits": digits}
        return simulate(start.parameters, max_events=25, **times, **accuracy)  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(30))
def test_motions_are_the_same_with_and_without(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    start = random_start(seed)
    near, alone = (followed(monkeypatch, start, None, searches) for searches in (True, False))
    assert (near.events, near.status) == (alone.events, alone.status)
    digits = 30 if seed % 3 else 120  # with so many one evaluation of the flow is not enough
    near, alone = followed(monkeypatch, start, digits, True), followed(monkeypatch, start, digits + 15, False)
    assert near.status == alone.status
    assert len(near.events) == len(alone.events)
    for a, b in zip(near.events, alone.events, strict=True):
        assert (a.kind, a.boundary, a.target) == (b.kind, b.boundary, b.target)
        assert abs(a.t - b.t) <= b.t.context.mpf(10) ** (1 - digits) * max(1, abs(b.t))
        assert abs(a.x - b.x) <= b.t.context.mpf(10) ** (1 - digits) * max(1, abs(b.x))


def test_only_a_root_where_it_is_expected_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """And nothing where doubles are in doubt, or a motion may creep for ever."""
    seen, scene = set(), load_scene("fig5")
    start = Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end)
    for path, state, end, rough, found in pairs_of_steps(start):
        if found.code not in (CROSS, STICK, SLIP):
            continue
        near, asked = path._paths.advance_near, []
        functions, before = near.__globals__, path._paths.enter()
        monkeypatch.setitem(functions, "advance", lambda *given: asked.append(given) or "searched")  # noqa: B023
        assert near(state, rough, found, *end, path.K) != "searched"
        for K, other in (
            (path.K, found._replace(decided=False)),
            (path.K._replace(creeps=True), found),
            (path.K, shifted_by(found, 1e-3, rough)),
            (path.K, shifted_by(found._replace(t_error=0.0), -1e-7, rough)),
        ):
            assert near(state, rough, other, *end, K) == "searched"
        assert len(asked) == 4
        seen.add(found.code)
        monkeypatch.undo()
        path._paths.leave(before)
    assert seen >= {STICK, SLIP}


def test_searches_of_another_motion_are_left_out() -> None:
    scene = load_scene("fig8")
    start = Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end)
    doubles = Motion(start)
    for _ in range(6):
        doubles.step()
    wanted = FinerMotion(start)
    assert wanted.reach(5, [])
    for searched in (doubles.searched, doubles.searched[1:], doubles.searched[::-1], [doubles.searched[1]] * 5):
        finer = FinerMotion(start)
        assert finer.reach(5, searched)
        assert finer.events == wanted.events
