"""Calls with a limit of time: bounded, and what goes wrong in one is said."""

from __future__ import annotations

import os

import pytest
from bench_fakes import fail, loop_for_ever, talk
from effort import PATIENCE

from symosc.bench.time_limit import HANG, Worker


@pytest.mark.slow
def test_calls_are_bounded_and_what_goes_wrong_is_said(capfd: pytest.CaptureFixture[str]) -> None:
    with Worker() as worker:
        first = worker.call(PATIENCE, talk)
        assert (first.failure, first.warnings) == ("", ("careful",))
        assert first.value not in (None, os.getpid())
        raised = worker.call(PATIENCE, fail)
        assert (raised.failure, raised.value, raised.lost) == ("exception: ValueError: no", None, False)
        assert worker.call(PATIENCE, talk).value == first.value  # one process for all
        hanging = worker.call(0.5, loop_for_ever)
        assert (hanging.failure, hanging.lost) == (HANG, True)
        died = worker.call(PATIENCE, os.abort)
        assert (died.failure, died.lost) == ("crash: the process ended with exit code -6", True)
        assert worker.call(PATIENCE, divmod, 7, 2).value == (3, 1)
    assert capfd.readouterr() == ("", "")
