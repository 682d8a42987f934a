"""Progress of long work on a terminal: a bar with rate and time left, drawn by rich on stderr; nothing elsewhere.

A bar appears after two seconds, or after the seconds in the environment variable SYMOSC_PROGRESS_DELAY.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from datetime import timedelta
from threading import Lock, Timer
from time import monotonic
from typing import Any

#: Called with the amount done and the total.
Report = Callable[[float, float], Any]
#: Called with the part done, from 0 to 1, and the number of things done; None: there is no one to report to.
Advance = Callable[[float, int], Any] | None
#: Verbosity: results and errors only; notes and bars too; versions and times too.
QUIET, NORMAL, VERBOSE = 0, 1, 2
#: Seconds until a bar appears.
USUAL_DELAY = 2.0
#: Seconds between two drawings of a bar.
LEAST_PAUSE = 0.1

_level = NORMAL


def set_level(level: int) -> None:
    """Set the verbosity."""
    global _level
    _level = level


def level() -> int:
    """Return the verbosity."""
    return _level


def shows_bars() -> bool:
    """Return whether to show bars: on a terminal, unless quiet."""
    return _level > QUIET and sys.stderr is not None and sys.stderr.isatty()


def delay() -> float:
    """Return the seconds until a bar appears, at most a day."""
    try:
        seconds = float(os.environ.get("SYMOSC_PROGRESS_DELAY", USUAL_DELAY))
    except ValueError:
        return USUAL_DELAY
    return seconds if 0 <= seconds <= 86_400 else USUAL_DELAY


@contextmanager
def reporting(
    progress: Any, there: float, total: float, label: str = "sweep", unit: str = "motions"
) -> Iterator[Report]:
    """Yield a report function: `progress` itself if it is callable, else that of a bar, which begins at `there`."""
    if callable(progress):
        yield progress
    elif not (progress and shows_bars()):
        yield lambda done, total: None
    else:
        begin = monotonic()
        with _drawn(label, there, total, unit) as show:
            yield lambda done, of: show(done, of, pace(done - there, of - done, monotonic() - begin, unit))


@contextmanager
def bar(label: str, total: float, unit: str = "steps") -> Iterator[Report]:
    """Show a bar; yield its report function."""
    with reporting(True, 0, total, label, unit) as report:
        yield report


@contextmanager
def late_bar(progress: Any, label: str, unit: str) -> Iterator[Advance]:
    """Yield a function that takes the part done and a count of `unit`; a bar appears after two seconds."""
    # The part may fall back to 0 where work begins anew; rate and time left then begin anew.
    if callable(progress):
        yield lambda part, count: progress(part, 1.0)
        return
    if not (progress and shows_bars()):
        yield None
        return
    begin = since = monotonic()
    last, wait = 0.0, delay()
    show: Callable[[float, float, str], None] | None = None
    with ExitStack() as stack:

        def advance(part: float, count: int) -> None:
            nonlocal since, last, show
            now, again, last = monotonic(), part < last, part
            if again:
                since = now
            elif show is not None:
                seconds = now - since
                left = pace(part, 1 - part, seconds, "")
                show(part, 1.0, f"{_rate_text(count / max(seconds, 1e-9), unit)}, {left}")
            elif now - begin >= wait:
                show = stack.enter_context(_drawn(label, 0, 1.0, ""))

        yield advance


@contextmanager
def _drawn(label: str, there: float, total: float, unit: str) -> Iterator[Callable[[float, float, str], None]]:
    """Yield a function that draws a bar with the amount done, the total and a text, at a visible rate."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    pause_working()
    last = -LEAST_PAUSE
    counted = MofNCompleteColumn() if unit else TextColumn("{task.percentage:.0f} %")
    columns = TextColumn("{task.description}"), BarColumn(), counted, TextColumn("{task.fields[pace]}")
    # Without a thread of its own: processes that are forked meanwhile inherit no lock of it.
    with Progress(*columns, console=Console(file=sys.stderr), auto_refresh=False) as shown:
        task = shown.add_task(label, total=total, pace="")
        shown.update(task, completed=there)
        shown.refresh()

        def show(done: float, of: float, text: str) -> None:
            nonlocal last
            now = monotonic()
            if done >= of or now - last >= LEAST_PAUSE:
                last = now
                shown.update(task, completed=done, total=of, pace=text, refresh=True)

        yield show


def pace(done: float, left: float, seconds: float, unit: str = "motions") -> str:
    """Return the rate and the time left, of work done in some seconds; without a unit only the time."""
    rate = done / max(seconds, 1e-9)
    time = timedelta(seconds=round(left / max(rate, 1e-9))) if done > 0 or left == 0 else "?"
    return f"{_rate_text(rate, unit)}, {time} left" if unit else f"{time} left"


def _rate_text(rate: float, unit: str) -> str:
    return f"{rate:,.0f} {unit}/s" if rate >= 10 else f"{rate:.2g} {unit}/s"


class _Working:
    """A line with a spinner that appears after a while."""

    def __init__(self, label: str) -> None:
        self.label, self.lock, self.over, self.shown = label, Lock(), False, ExitStack()
        self.timer = Timer(delay(), self.begin)
        self.timer.daemon = True
        if self.timer.interval > 0:
            self.timer.start()
        else:
            self.begin()

    def begin(self) -> None:
        with self.lock, suppress(ImportError):
            if self.over or not shows_bars():
                return
            from rich.console import Console
            from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

            columns = SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()
            spinner = Progress(*columns, console=Console(file=sys.stderr), transient=True)
            spinner.add_task(self.label, total=None)
            self.shown.enter_context(spinner)

    def end(self) -> None:
        self.timer.cancel()
        with self.lock:
            self.over = True
            self.shown.close()


_working: _Working | None = None


@contextmanager
def working(label: str) -> Iterator[None]:
    """Show a spinner on a terminal if work takes longer than two seconds and no bar is shown."""
    global _working
    if shows_bars():
        _working = _Working(label)
    try:
        yield
    finally:
        pause_working()


def pause_working() -> None:
    """End the spinner: a bar takes its place, or a result is printed."""
    global _working
    if _working is not None:
        _working.end()
        _working = None
