"""How far a sweep is: on a terminal a bar with rate and time left, elsewhere nothing."""

from __future__ import annotations

import io
import sys

import pytest

from symosc.display import progress as module
from symosc.display.progress import late_bar, pace, reporting


@pytest.mark.parametrize(
    ("done", "left", "seconds", "text"),
    [
        (5000, 10_000, 2.0, "2,500 motions/s, 0:00:04 left"),
        (3, 3600, 6.0, "0.5 motions/s, 2:00:00 left"),
        (10, 0, 1.0, "10 motions/s, 0:00:00 left"),
        (86_400, 864_000, 86_400.0, "1 motions/s, 10 days, 0:00:00 left"),
    ],
)
def test_rate_and_time_left(done: int, left: int, seconds: float, text: str) -> None:
    assert pace(done, left, seconds) == text


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", Terminal())
    with reporting(True, 40, 100) as report:  # 40 of an earlier run
        report(70, 100)
        report(100, 100)
    shown = sys.stderr.getvalue()  # type: ignore[attr-defined]
    assert all(text in shown for text in ("40/100", "70/100", "100/100", "motions/s", "left"))


def test_nothing_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    for progress in (True, False):
        with reporting(progress, 0, 100) as report:
            report(100, 100)
    assert sys.stderr.getvalue() == ""  # type: ignore[attr-defined]


def test_a_function_of_ones_own() -> None:
    calls: list[tuple[int, int]] = []
    with reporting(lambda done, total: calls.append((done, total)), 0, 9) as report:
        report(4, 9)
    assert calls == [(4, 9)]


class Clock:
    """A clock that is put forward by hand."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def on_terminal(monkeypatch: pytest.MonkeyPatch) -> tuple[Clock, Terminal]:
    clock, terminal = Clock(), Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(module, "monotonic", clock)
    monkeypatch.delenv("SYMOSC_PROGRESS_DELAY", raising=False)
    return clock, terminal


def test_a_bar_comes_after_two_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, terminal = on_terminal(monkeypatch)
    with late_bar(True, "simulate", "events") as advance:
        assert advance is not None
        for clock.now, part, count in ((1.0, 0.1, 10), (1.9, 0.2, 20)):
            advance(part, count)
        assert terminal.getvalue() == ""
        for clock.now, part, count in ((2.5, 0.25, 25), (4.0, 0.5, 400)):
            advance(part, count)
    shown = terminal.getvalue()
    assert all(text in shown for text in ("simulate", "50 %", "100 events/s, 0:00:04 left"))


@pytest.mark.parametrize(
    ("said", "shows"), [("0", (True, True)), ("100", (False, False)), ("x", (False, True)), ("nan", (False, True))]
)
def test_the_delay_is_a_setting(said: str, shows: tuple[bool, bool], monkeypatch: pytest.MonkeyPatch) -> None:
    """Seconds until work shows that it goes on; what is no number counts as the usual two."""
    clock, terminal = on_terminal(monkeypatch)
    monkeypatch.setenv("SYMOSC_PROGRESS_DELAY", said)
    with late_bar(True, "simulate", "events") as advance:
        assert advance is not None
        for clock.now, shown in zip((1.0, 3.0), shows, strict=True):
            advance(0.1, 1)
            assert ("simulate" in terminal.getvalue()) is shown
    if said == "0":
        with module.working("waits"):
            assert "waits" in terminal.getvalue()


def test_work_that_is_begun_anew_is_told_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, terminal = on_terminal(monkeypatch)
    with late_bar(True, "simulate", "events") as advance:
        assert advance is not None
        for clock.now, part, count in ((2.5, 0.5, 5), (10.0, 0.9, 9), (10.0, 0.0, 0), (14.0, 0.25, 48)):
            advance(part, count)
    assert "12 events/s, 0:00:12 left" in terminal.getvalue()


def test_short_work_and_a_pipe_have_no_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    _, terminal = on_terminal(monkeypatch)
    with late_bar(True, "simulate", "events") as advance:
        assert advance is not None
        advance(1.0, 10)
    assert terminal.getvalue() == ""
    with late_bar(False, "simulate", "events") as advance:
        assert advance is None
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with late_bar(True, "simulate", "events") as advance:
        assert advance is None


def test_a_part_goes_to_a_function_of_ones_own() -> None:
    calls: list[tuple[float, float]] = []
    with late_bar(lambda done, total: calls.append((done, total)), "simulate", "events") as advance:
        assert advance is not None
        advance(0.5, 7)
    assert calls == [(0.5, 1.0)]
