"""Running the command line on a terminal of its own (a pty): what it shows there, and how it takes Ctrl-C."""

from __future__ import annotations

import os
import pty
import select
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from cli_runs import PROGRAM

import symosc

#: Seconds that a command may take.
LONGEST = 90.0
ROOT = Path(symosc.__file__).parents[1]


class Shown(NamedTuple):
    """What a terminal showed, and how the program ended, as a shell says it.

    Where an interrupt came while CPython ran a string (namedtuples are made so), it lets the signal end the program at
    its exit, whoever has handled it: to a shell that is 130 as well.
    """

    text: str
    code: int


def on_terminal(
    *arguments: str, folder: Path, interrupt: float | str | None = None, columns: int = 120, **environment: str
) -> Shown:
    """Run a command in a folder on a terminal; `interrupt`: Ctrl-C after these seconds, or when a text is shown."""
    process, master = pty.fork()
    if process == 0:  # pragma: no cover
        os.chdir(folder)
        size = {"COLUMNS": str(columns), "LINES": "30", "TERM": "xterm-256color", "PYTHONPATH": str(ROOT)}
        os.execve(PROGRAM[0], [*PROGRAM, *arguments], {**os.environ, **size, **environment})
    shown, begin = b"", time.monotonic()
    try:
        for piece in _pieces(master):
            shown += piece
            late = isinstance(interrupt, float) and time.monotonic() - begin > interrupt
            if late or (isinstance(interrupt, str) and interrupt.encode() in shown):
                os.write(master, b"\x03")
                interrupt = None
    finally:
        os.close(master)  # what still runs then is told that its terminal is gone
    _, status = os.waitpid(process, 0)
    code = os.waitstatus_to_exitcode(status)
    return Shown(shown.decode(errors="replace"), code if code >= 0 else 128 - code)


def _pieces(master: int) -> Iterator[bytes]:
    """Yield what is shown, or nothing for a moment, until the program ends."""
    begin = time.monotonic()
    while time.monotonic() - begin < LONGEST:
        piece = b""
        if select.select([master], [], [], 0.05)[0]:
            try:
                piece = os.read(master, 65536)
            except OSError:  # the program has closed its terminal
                return
            if not piece:
                return
        yield piece
    raise AssertionError(f"it takes more than {LONGEST} s")
