"""Telling how far a sweep, or other long work, is: a bar on a terminal, with the rate and the time that is left."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from time import monotonic
from typing import Any

from symosc.errors import ParameterError

#: Gets the number of motions that are done, and of all.
Report = Callable[[int, int], Any]


@contextmanager
def reporting(progress: Any, there: int, total: int, label: str = "sweep", unit: str = "motions") -> Iterator[Report]:
    """Return what is called with the numbers of motions that are done and of all.

    Parameters
    ----------
    progress : bool or callable
        True: a bar on stderr, if that is a terminal.
    there : int
        Motions that an earlier run has done.
    total : int
    label, unit : str
        What is done, and what is counted.

    Raises
    ------
    ParameterError
        If `progress` is none of these.
    """
    if callable(progress):
        yield progress
    elif not isinstance(progress, bool):
        raise ParameterError("progress", progress, "must be True, False or a function of two numbers")
    elif not (progress and sys.stderr.isatty()):
        yield lambda done, total: None
    else:
        with _bar(there, total, label, unit) as report:
            yield report


@contextmanager
def _bar(there: int, total: int, label: str, unit: str) -> Iterator[Report]:
    import click

    begin = monotonic()
    options: dict[str, Any] = {"show_pos": True, "show_eta": False, "item_show_func": lambda text: text}
    with click.progressbar(length=total, label=label, file=sys.stderr, **options) as bar:
        bar.update(there)

        def report(done: int, _: int) -> None:
            bar.update(done - bar.pos, pace(done - there, total - done, monotonic() - begin, unit))

        yield report


def pace(done: int, left: int, seconds: float, unit: str = "motions") -> str:
    """Return the rate of motions and the time that is left.

    Parameters
    ----------
    done, left : int
        Motions since the program has begun, and to do.
    seconds : float
    unit : str
    """
    rate = done / max(seconds, 1e-9)
    shown = f"{rate:,.0f}" if rate >= 10 else f"{rate:.2g}"
    return f"{shown} {unit}/s, {timedelta(seconds=round(left / max(rate, 1e-9)))} left"
