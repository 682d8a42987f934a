"""mpmath contexts of fixed precision, and interrupts while mpmath is loaded."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import random
import signal
import threading
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import mpmath
import pytest

from symosc import Parameters, Trajectory, find_orbit, grazing_start, grazing_window, load_scene, simulate, solve_map
from symosc.engine.arithmetic import MpArithmetic
from symosc.kernels.multiprecision import interrupts_held_back, mp_context

COPIES: dict[str, Callable[[Any], Any]] = {
    **{f"pickle {n}": lambda value, n=n: pickle.loads(pickle.dumps(value, n)) for n in range(2, 6)},
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


def random_trajectory(seed: int) -> Any:
    dice = random.Random(seed)
    numbers = {name: Fraction(dice.randint(10, 300), 100) for name in ("m", "c", "k", "A0", "B0", "Omega", "FN")}
    p = Parameters(v1=-1, v2=1, mu1="0.3", mu2="0.4", **numbers)
    return simulate(p, t0=0, x0=Fraction(dice.randint(-99, 99), 50), v0="0.37", t_end=4, digits=dice.randint(16, 60))


def orbit() -> Any:
    return find_orbit(load_scene("fig9-orbit").parameters, "P32", digits=30)


def next_point() -> Any:
    found, context = orbit(), mp_context(40)
    (t, x), Omega = found.points[0], found.parameters.Omega
    return solve_map(found.parameters, "P2", context.mpf(x), context.mpf(t) * Omega.numerator / Omega.denominator)


RESULTS: dict[str, Callable[[], Any]] = {
    **{f"trajectory {seed}": lambda seed=seed: random_trajectory(seed) for seed in range(6)},
    "orbit": orbit,
    "grazing start": lambda: grazing_start(load_scene("fig8").parameters, "P3", t_m="3.14159", t0="2.5", digits=30),
    "window": lambda: grazing_window(load_scene("fig8").parameters, "P3"),
    "critical phase": lambda: grazing_window(load_scene("fig8").parameters, "P3").critical_phase(),
    "map": next_point,
    "complex": lambda: mp_context(25).mpc(1, 2) / 3,
    "infinity": lambda: mp_context(25).inf,
}


def content(result: Any) -> Any:
    return (result.events, result.segments, result.status) if isinstance(result, Trajectory) else result


@pytest.mark.quick(6)
@pytest.mark.parametrize("name", RESULTS)
def test_results_stay_equal(name: str) -> None:
    result = RESULTS[name]()
    for how, again in ((how, copied(result)) for how, copied in COPIES.items()):
        assert content(again) == content(result), how
        assert repr(content(again)) == repr(content(result)), how


@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES)
def test_numbers_go_on_as_numbers(copied: Callable[[Any], Any]) -> None:
    first, second = (event.t for event in simulate(load_scene("fig5"), digits=40, max_events=2).events)
    t = copied(first)
    assert str(t) == str(first)
    assert len(str(t).lstrip("0.")) == 40
    assert mpmath.nstr(t, 25) == mpmath.nstr(first, 25)
    assert second - t == second - first
    assert t - second == first - second
    assert t.sqrt() ** 2 + 1 == first.sqrt() ** 2 + 1
    assert (hash(t), float(t), t.context.dps) == (hash(first), float(first), 40)
    assert str(mpmath.mpf(t)) == str(mpmath.mpf(first))


def test_arithmetics_keep_their_context() -> None:
    context = MpArithmetic(load_scene("fig5").parameters, 30).context
    assert copy.deepcopy(context) is context
    assert pickle.loads(pickle.dumps(context)) is context


@pytest.mark.slow
def test_spawned_processes_return_digits() -> None:
    scene = load_scene("fig5")
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        theirs = pool.apply(simulate, (scene,), {"digits": 25, "max_events": 3})
    ours = simulate(scene, digits=25, max_events=3)
    assert content(theirs) == content(ours)
    assert str(theirs.events[0].t) == str(ours.events[0].t)


@pytest.fixture(autouse=True)
def usual_handler() -> Iterator[None]:
    """A shell's background job ignores interrupts, and so would the tests that it runs."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interrupt_comes_at_the_end_of_the_block() -> None:
    usual = signal.getsignal(signal.SIGINT)
    reached = []

    def load() -> None:
        with interrupts_held_back():
            try:
                signal.raise_signal(signal.SIGINT)
            except BaseException:  # as a library may do
                reached.append("lost")
            reached.append("end")

    with pytest.raises(KeyboardInterrupt):
        load()
    assert reached == ["end"]
    assert signal.getsignal(signal.SIGINT) is usual


def test_an_error_of_the_block_is_its_error() -> None:
    usual = signal.getsignal(signal.SIGINT)
    with pytest.raises(ValueError, match="its own"), interrupts_held_back():
        raise ValueError("its own")
    assert signal.getsignal(signal.SIGINT) is usual


def test_other_threads_leave_the_handler_alone() -> None:
    seen = []

    def work() -> None:
        with interrupts_held_back():
            seen.append(signal.getsignal(signal.SIGINT))

    usual = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [usual]
