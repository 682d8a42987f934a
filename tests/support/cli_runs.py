"""Running the command line in tests: inside this process, and as the program."""

from __future__ import annotations

import subprocess
import sys

import click
from click.testing import CliRunner, Result

from symosc.cli.app import main

COMMANDS = main.list_commands(click.Context(main))
PROGRAM = [sys.executable, "-m", "symosc"]


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, prog_name="symosc")


def shell(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*PROGRAM, *arguments], capture_output=True, text=True, **options)  # type: ignore[call-overload]


def good(*arguments: str) -> str:
    result = run(*arguments)
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    return result.stdout
