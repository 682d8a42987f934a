"""The README and the page about answers are tests.

What they show is run, and must print what they say.
"""

from __future__ import annotations

import importlib.util
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import click
import pytest

import symosc
from symosc import plot
from symosc.cli.app import main
from symosc.derive.citation import bibtex
from symosc.paper import figures

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
    assert len(lines) <= 120
    assert max(map(len, lines)) <= 120


def test_the_readme_begins_with_the_machine() -> None:
    """Before any letter is used the machine and the mappings are shown, and their letters said."""
    sketch, mappings, motion = re.findall(r"!\[[^\]]+\]\((docs/\w+\.svg)\)", README)
    for name in (sketch, mappings, motion):
        picture = (ROOT / name).read_text(encoding="utf-8")
        assert "<svg" in picture
        assert len(picture) < 60_000
    caption, _, rest = README.partition("\n\nsymosc computes")
    assert caption.index(sketch) < caption.index(mappings) < caption.index("*The machine:")
    for letter in ("m", "k", "c", "A0", "B0", "Ωt", "FN", "v1", "v2", *symosc.words.MAPS):
        assert re.search(rf"\b{letter}\b", caption), letter
    assert rest


def test_the_pictures_of_the_machine_are_the_papers_figures(tmp_path: Path) -> None:
    """Compare what is drawn, as far as it does not depend on the version of matplotlib."""
    for name, draw in (("machine", figures.fig1), ("mappings", figures.fig4)):
        drawn = plot.save(draw(), tmp_path / f"{name}.svg").read_text(encoding="utf-8")
        stored = (ROOT / "docs" / f"{name}.svg").read_text(encoding="utf-8")
        for part in ("<use ", "<path ", "#d7191c"):
            assert stored.count(part) == drawn.count(part), (name, part)


def test_the_readme_says_how_to_cite() -> None:
    (entries,) = blocks("bibtex")
    assert entries.strip() == bibtex().strip()


def test_links_on_a_package_index_are_absolute() -> None:
    noxfile = pytest.importorskip("nox") and _noxfile()
    address = noxfile.repository_address("git@example.org:somebody/symosc.git")
    assert address == noxfile.repository_address("https://example.org/somebody/symosc")
    text = noxfile.with_absolute_links(README, address, "v9.8.7")
    targets = re.findall(r"\]\(([^)\s]+)\)", text)
    assert len(targets) == len(re.findall(r"\]\(([^)\s]+)\)", README)) > 15
    assert all(target.startswith("https://") for target in targets)
    assert f"![The machine: {README.partition('![The machine: ')[2].partition(']')[0]}]" in text
    for part in ("raw/v9.8.7/docs/machine.svg", "blob/v9.8.7/CHANGELOG.md", "issues"):
        assert f"({address}/{part})" in text
    assert "[![license: BSD-3-Clause](https://img.shields.io" in text


def _noxfile() -> Any:
    specification = importlib.util.spec_from_file_location("noxfile", ROOT / "noxfile.py")
    assert specification
    module = importlib.util.module_from_spec(specification)
    assert specification.loader
    specification.loader.exec_module(module)
    return module
