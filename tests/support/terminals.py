"""Running the command line on a terminal of its own (a pty).

What it shows there, and how it takes Ctrl-C.
"""

from __future__ import annotations

import os
import pty
import re
import select
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from cli_runs import PROGRAM
from effort import PATIENCE

import symosc

ROOT = Path(symosc.__file__).parents[1]


class Shown(NamedTuple):
    """What a terminal showed, and how the program ended, as a shell says it.

    Where an interrupt came while CPython ran a string (namedtuples are made so), it lets the signal
    end the program at its exit, whoever has handled it: to a shell that is 130 as well.
    """

    text: str
    code: int


def on_terminal(
    *arguments: str, folder: Path, interrupt: str = "", columns: int = 120, **environment: str
) -> Shown:
    """Run a command in a folder on a terminal.

    interrupt : a pattern; when it is shown, Ctrl-C. Then late bars come at once, else never: on any machine alike.
    """
    process, master = pty.fork()
    if process == 0:  # pragma: no cover
        try:
            os.chdir(folder)
            settings = {
                "COLUMNS": str(columns),
                "LINES": "30",
                "TERM": "xterm-256color",
                "PYTHONPATH": str(ROOT),
            }
            settings |= {"SYMOSC_PROGRESS_DELAY": "0" if interrupt else "86400"}
            os.execve(PROGRAM[0], [*PROGRAM, *arguments], {**os.environ, **settings, **environment})
        finally:
            os._exit(127)
    shown = b""
    try:
        for piece in _pieces(master):
            shown += piece
            if interrupt and re.search(interrupt.encode(), shown):
                os.write(master, b"\x03")
                interrupt = ""
    finally:
        os.close(master)  # what still runs then is told that its terminal is gone
    _, status = os.waitpid(process, 0)
    code = os.waitstatus_to_exitcode(status)
    return Shown(shown.decode(errors="replace"), code if code >= 0 else 128 - code)


def _pieces(master: int) -> Iterator[bytes]:
    """Yield what is shown until the program ends."""
    while select.select([master], [], [], PATIENCE)[0]:
        try:
            piece = os.read(master, 65536)
        except OSError:  # the program has closed its terminal
            return
        if not piece:
            return
        yield piece
    raise AssertionError(f"it has shown nothing for {PATIENCE} s")
