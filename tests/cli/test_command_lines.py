"""Random command lines: no traceback, the exit code of what happened, one line for bad input, no drafts left."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
from cli_runs import PROGRAM
from click.testing import CliRunner
from command_lines import command_lines, write_files

from symosc.base.files import DRAFT_PREFIX
from symosc.cli.app import main

#: Seconds after which a command is given up; it is then neither right nor wrong.
GIVEN_UP = 20


class GivenUp(BaseException):
    """A command that takes too long."""


def give_up(*_: object) -> None:
    raise GivenUp


def fault(words: list[str], folder: Path) -> str:
    """Return what is wrong with what a command line does, "" if nothing is, "?" if it was given up."""
    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(GIVEN_UP)
    try:
        result = CliRunner().invoke(main, words, prog_name="symosc")
    except GivenUp:
        return "?"
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    left = [path.name for path in folder.rglob(f"{DRAFT_PREFIX}*")]
    return fault_of(result.exit_code, result.stdout, result.stderr, left, result.exception)


def fault_of(
    code: int, out: str, err: str, left: list[str], error: BaseException | None = None
) -> str:
    """Return what is wrong with the exit code, the outputs and the files that a command left; "" if nothing is."""
    if error is not None and not isinstance(error, SystemExit):
        return f"raises {error!r:.200}"
    if "Traceback" in out + err:
        return "prints a traceback"
    if code not in (0, 1, 2):
        return f"ends with {code}"
    lines = err.splitlines()
    if code == 2 and (not lines or "\n" in err.rstrip("\n") or len(err) > 1000 or out.strip()):
        return f"is bad input, and says {err[:300]!r} and {out[:100]!r}"
    if code == 1 and not out + err:
        return "fails, and says nothing"
    return f"leaves {left}" if left else ""


def faults(seed: int, count: int, folder: Path) -> tuple[list[str], int]:
    """Return the faults of random command lines, and how many of these were given up."""
    write_files(folder)
    found, slow = [], 0
    for words in command_lines(seed, count):
        reason = fault(words, folder)
        slow += reason == "?"
        found += [f"{words!r:.300} {reason}"] if reason not in ("", "?") else []
    return found, slow


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("count", [40, pytest.param(1000, marks=pytest.mark.campaign)])
def test_random_command_lines(count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    found, slow = faults(7, count, tmp_path)
    assert found == []
    assert slow <= count // 100


@pytest.mark.slow
def test_random_command_lines_of_the_program(tmp_path: Path) -> None:
    """What click's runner does not see: the entry point, the bytes of words, the end of the process."""
    write_files(tmp_path)
    found = []
    for words in command_lines(8, 8):
        given = [os.fsencode(word) for word in words if "\0" not in word]
        begin = time.monotonic()
        done = subprocess.run(
            [*PROGRAM, *given], cwd=tmp_path, capture_output=True, stdin=subprocess.DEVNULL
        )
        out, err = (text.decode("utf-8", "replace") for text in (done.stdout, done.stderr))
        left = [path.name for path in tmp_path.rglob(f"{DRAFT_PREFIX}*")]
        reason = fault_of(done.returncode, out, err, left)
        found += (
            [f"{words!r:.300} {reason} after {time.monotonic() - begin:.1f} s"] if reason else []
        )
    assert found == []
