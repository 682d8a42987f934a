"""Calls with a limit of time: bounded, and what goes wrong in one is said."""

from __future__ import annotations

import os
import time

import pytest
from bench_fakes import fail, loop_for_ever, talk

from symosc.bench.time_limit import HANG, Worker


@pytest.mark.slow
def test_calls_are_bounded_and_what_goes_wrong_is_said(capfd: pytest.CaptureFixture[str]) -> None:
    with Worker() as worker:
        first = worker.call(20.0, talk)
        assert (first.failure, first.warnings) == ("", ("careful",))
        assert first.value not in (None, os.getpid())
        raised = worker.call(20.0, fail)
        assert (raised.failure, raised.value, raised.lost) == ("exception: ValueError: no", None, False)
        assert worker.call(20.0, talk).value == first.value  # one process for all
        begin = time.perf_counter()
        hanging = worker.call(0.5, loop_for_ever)
        assert time.perf_counter() - begin < 10
        assert (hanging.failure, hanging.lost) == (HANG, True)
        died = worker.call(20.0, os.abort)
        assert (died.failure, died.lost) == ("crash: the process ended with exit code -6", True)
        assert worker.call(20.0, divmod, 7, 2).value == (3, 1)
    assert capfd.readouterr() == ("", "")
