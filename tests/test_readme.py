"""The README and the page about answers are tests.

What they show is run, and must print what they say.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import click
import pytest

import symosc
from symosc.cli.app import main

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
ANSWERS = (ROOT / "docs" / "reference" / "answers.md").read_text(encoding="utf-8")


def blocks(language: str, text: str = README) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def assert_same_print(printed: str, expected: str) -> None:
    """Compare words; numbers may differ in the last digits, which depend on the machine."""
    assert len(printed.splitlines()) == len(expected.splitlines()), printed
    words, expected_words = (re.sub(r"-{3,}", "---", text).split() for text in (printed, expected))
    for word, expected_word in zip(words, expected_words, strict=True):
        try:
            number = float(expected_word)
        except ValueError:
            assert word == expected_word
        else:
            assert float(word) == pytest.approx(number, rel=1e-12, abs=1e-13)
            assert abs(len(word) - len(expected_word)) <= 2


@pytest.mark.slow
def test_the_python_example(tmp_path: Path) -> None:
    (code,) = blocks("python")
    (expected,) = blocks("text")
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert_same_print(result.stdout, expected)
    assert "<svg" in (tmp_path / "motion.svg").read_text(encoding="utf-8")
    assert (ROOT / "docs" / "motion.svg").is_file()


@pytest.mark.slow
def test_the_command_lines(tmp_path: Path) -> None:
    (session,) = blocks("console", ANSWERS)
    commands = re.split(r"^\$ ", session, flags=re.MULTILINE)[1:]
    assert len(commands) >= 5
    environment = {
        **os.environ,
        "PATH": os.pathsep.join([str(_program_folder(tmp_path)), os.environ["PATH"]]),
    }
    for entry in commands:
        command, _, expected = entry.partition("\n")
        result = subprocess.run(
            command, shell=True, cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert (result.returncode, result.stderr) == (0, ""), command
        if expected:
            assert_same_print(result.stdout, expected)
    assert {"events.csv", "fig8.svg", "mine.toml", "events.json"} <= {
        path.name for path in tmp_path.iterdir()
    }


def _program_folder(tmp_path: Path) -> Path:
    """Return a folder with a `symosc` that is the one under test, wherever it is installed."""
    program = tmp_path / "bin" / "symosc"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m symosc "$@"\n')
    program.chmod(0o755)
    return program.parent


def test_the_two_commands_install_what_they_say() -> None:
    run, test = blocks("bash")
    assert run.startswith("python3 -m venv .venv && .venv/bin/pip install")
    assert test.startswith("python3 -m venv .venv && .venv/bin/pip install")
    assert ".venv/bin/symosc reproduce -o reproduced" in run
    assert ".venv/bin/pytest" in test


def test_every_scene_and_status_is_explained() -> None:
    for word in [*symosc.scene_names(), "t_end", "max_events", "equilibrium", "undecidable"]:
        assert f"`{word}`" in ANSWERS, word


def test_commands_in_the_text_exist() -> None:
    commands = main.list_commands(click.Context(main))
    for text in (README, ANSWERS):
        for name in re.findall(r"`symosc\s([a-z]+)", text) + re.findall(
            r"^\$ symosc ([a-z]+)", text, re.MULTILINE
        ):
            assert name in commands
    assert all(f"symosc {name}" in " ".join(README.split()) for name in commands)


def test_the_readme_is_short() -> None:
    lines = README.splitlines()
    assert len(lines) <= 110
    assert max(map(len, lines)) <= 120
