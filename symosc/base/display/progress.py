"""Progress of long work on a terminal: a bar with rate and time left, drawn by rich on stderr.

Nothing elsewhere.

A bar appears after two seconds, or after the seconds in the environment variable
SYMOSC_PROGRESS_DELAY.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from datetime import timedelta
from threading import Lock, Timer
from time import monotonic
from typing import Any

from symosc.base.aliases import Progress

#: Called with the amount done and the total.
Report = Callable[[float, float], Any]
#: Called with the part done, from 0 to 1, and the number of things done.
Advance = Callable[[float, int], Any] | None
#: Verbosity: results and errors only; notes and bars too; versions and times too.
QUIET = 0
NORMAL = 1
VERBOSE = 2
#: Seconds until a bar appears.
USUAL_DELAY = 2.0
#: Seconds between two drawings of a bar.
LEAST_PAUSE = 0.1

#: The verbosity of messages: QUIET, NORMAL or VERBOSE.
level = NORMAL


def shows_bars() -> bool:
    """Return whether progress bars are shown: on a terminal, unless quiet."""
    return level > QUIET and sys.stderr is not None and sys.stderr.isatty()


def delay() -> float:
    """Return after how many seconds a progress bar appears: by the environment variable
    SYMOSC_PROGRESS_DELAY.
    """
    try:
        seconds = float(os.environ.get("SYMOSC_PROGRESS_DELAY", USUAL_DELAY))
    except ValueError:
        return USUAL_DELAY
    if 0 <= seconds <= 86_400:
        return seconds
    return USUAL_DELAY


@contextmanager
def reporting(
    progress: Progress, there: float, total: float, label: str = "sweep", unit: str = "motions"
) -> Iterator[Report]:
    """Yield a function that reports progress; call it with the amount done and the total amount.

    It is `progress` itself if that is a function, else draws a bar if `progress` is true, or does
    nothing. `there` is the amount done before this run; without a `unit` the bar shows percents.
    """
    if callable(progress):
        yield progress
    elif not (progress and shows_bars()):
        yield lambda done, total: None
    else:
        with _bar_drawer(label, unit, total, there, counted=bool(unit)) as show:
            yield lambda done, of: show(done, of, done - there)


def bar(label: str, total: float, unit: str = "steps") -> AbstractContextManager[Report]:
    """Return a context that shows a progress bar, and gives a function to call with the amount done
    and the total.
    """
    return reporting(progress=True, there=0, total=total, label=label, unit=unit)


@contextmanager
def late_bar(progress: Progress, label: str, unit: str) -> Iterator[Advance]:
    """Yield a function to call with the fraction done (0 to 1) and the number of steps done; None
    if no bar is shown.

    It is for work whose number of steps is not known in advance; the bar calls the steps `unit`.
    """
    if callable(progress):
        yield lambda part, count: progress(part, 1.0)
    elif not (progress and shows_bars()):
        yield None
    else:
        with _bar_drawer(label, unit) as show:
            yield lambda part, count: show(part, 1.0, count)


def _rate_text(count: float, seconds: float) -> str:
    """Return `count` per second as text, with two digits at least."""
    if count >= 10 * seconds:
        return f"{count / seconds:,.0f}"
    return f"{count / seconds:.2g}"


@contextmanager
def _bar_drawer(
    label: str, unit: str, total: float = 1.0, there: float = 0.0, counted: bool = False
) -> Iterator[Callable[[float, float, float], None]]:
    """Yield show(done, total, count), which after some seconds draws a bar with the rate of `count`
    per second.
    """
    begin = monotonic()
    since = begin
    last = there
    drawn = -LEAST_PAUSE
    shown: Any = None
    with ExitStack() as stack:

        def show(done: float, total: float, count: float) -> None:
            nonlocal since, last, drawn, shown
            now = monotonic()
            if done < last:  # where work begins anew, rate and time left do too
                since = now
            last = done
            if now - begin < delay() or (done < total and now - drawn < LEAST_PAUSE):
                return
            if shown is None:
                from rich.console import Console
                from rich.progress import (
                    BarColumn,
                    MofNCompleteColumn,
                    Progress,
                    ProgressColumn,
                    TextColumn,
                )

                pause_working()
                if counted:
                    amount: ProgressColumn = MofNCompleteColumn()
                else:
                    amount = TextColumn("{task.percentage:.0f} %")
                columns = (
                    TextColumn("{task.description}"),
                    BarColumn(),
                    amount,
                    TextColumn("{task.fields[pace]}"),
                )
                # Without a thread of its own: processes that are forked meanwhile inherit no lock
                # of it.
                shown = stack.enter_context(
                    Progress(*columns, console=Console(file=sys.stderr), auto_refresh=False)
                )
                shown.add_task(label, total=total, pace="")
            drawn = now
            seconds = now - since
            pace = ""
            if seconds > 0:  # not where work has just begun anew
                gained = done - there
                left: timedelta | str = "?"
                if gained > 0:
                    left = timedelta(seconds=round(seconds * (total - done) / gained))
                pace = f"{left} left"
                if unit:
                    pace = f"{_rate_text(count, seconds)} {unit}/s, {pace}"
            shown.update(0, completed=done, total=total, pace=pace, refresh=True)

        yield show


#: The spinner that is shown, and the timer that is to show it.
_spinner = ExitStack()
_waiting = None
_lock = Lock()


@contextmanager
def working(label: str) -> Iterator[None]:
    """Show a spinner on a terminal if work takes longer than two seconds and no bar is shown."""
    global _waiting
    if shows_bars():
        _waiting = Timer(delay(), _show_spinner, [label])
        _waiting.daemon = True
        if delay() > 0:
            _waiting.start()
        else:
            _show_spinner(label)
    try:
        yield
    finally:
        pause_working()


def _show_spinner(label: str) -> None:
    """Show the spinner with `label`, unless the work that it stands for is over."""
    with _lock, suppress(ImportError):
        if _waiting is not None and shows_bars():
            from rich.console import Console
            from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

            columns = SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()
            spinner = Progress(*columns, console=Console(file=sys.stderr), transient=True)
            spinner.add_task(label, total=None)
            _spinner.enter_context(spinner)


def pause_working() -> None:
    """Remove the spinner, if one is shown: a bar takes its place, or a result is printed."""
    global _waiting
    if _waiting is not None:
        _waiting.cancel()
        with _lock:
            _waiting = None
            _spinner.close()
