"""An interrupt that comes while a library is loaded is not lost."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator

import pytest

from symosc.kernels.interrupts import held_back


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
        with held_back():
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
    with pytest.raises(ValueError, match="its own"), held_back():
        raise ValueError("its own")
    assert signal.getsignal(signal.SIGINT) is usual


def test_other_threads_leave_the_handler_alone() -> None:
    seen = []

    def work() -> None:
        with held_back():
            seen.append(signal.getsignal(signal.SIGINT))

    usual = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [usual]
