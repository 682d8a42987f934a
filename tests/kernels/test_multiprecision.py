"""mpmath contexts of fixed precision, and interrupts while mpmath is loaded."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import signal
from collections.abc import Callable, Iterator
from typing import Any

import mpmath
import pytest

from symosc import Trajectory, load_scene, simulate
from symosc.kernels.multiprecision import interrupts_held_back

COPIES: dict[str, Callable[[Any], Any]] = {
    **{f"pickle {n}": lambda value, n=n: pickle.loads(pickle.dumps(value, n)) for n in range(2, 6)},
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


def content(result: Any) -> Any:
    if isinstance(result, Trajectory):
        return (result.events, result.segments, result.status)
    return result


@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES)
def test_numbers_go_on_as_numbers(copied: Callable[[Any], Any]) -> None:
    first, second = (
        event.t for event in simulate(load_scene("fig5"), digits=40, max_events=2).events
    )
    t = copied(first)
    assert str(t) == str(first)
    assert len(str(t).lstrip("0.")) == 40
    assert mpmath.nstr(t, 25) == mpmath.nstr(first, 25)
    assert second - t == second - first
    assert t - second == first - second
    assert t.sqrt() ** 2 + 1 == first.sqrt() ** 2 + 1
    assert (hash(t), float(t), t.context.dps) == (hash(first), float(first), 40)
    assert str(mpmath.mpf(t)) == str(mpmath.mpf(first))


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
