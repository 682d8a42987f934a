"""Completion in real shells.

Commands, options and scenes, as the page about answers installs it.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from shutil import which

import pytest
from click.shell_completion import ShellComplete
from terminals import ROOT

from symosc.cli.app import main

#: What each shell is told to complete a line, printing what it offers.
TRY = {
    "bash": 'eval "$(_SYMOSC_COMPLETE=bash_source symosc)"; COMP_WORDS=({line}); COMP_CWORD={last}; '
    '_symosc_completion symosc; printf "%s\\n" "${{COMPREPLY[@]}}"',
    "fish": '_SYMOSC_COMPLETE=fish_source symosc | source; complete -C "{line}"',
    "zsh": "autoload -Uz compinit; compinit -u -D; compdef() {{ }}; compadd() {{ print -lr -- $completions }}; "
    '_describe() {{ print -lr -- $completions_with_descriptions }}; eval "$(_SYMOSC_COMPLETE=zsh_source symosc)"; '
    "words=({line}); CURRENT={next}; _symosc_completion",
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("symosc sim", "simulate"),
        ("symosc simulate fig9-", "fig9-orbit"),
        ("symosc orbit --q", "--quiet"),
    ],
)
@pytest.mark.parametrize("shell", TRY)
def test_a_shell_completes(shell: str, line: str, offered: str, tmp_path: Path) -> None:
    if which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    program = tmp_path / "symosc"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m symosc "$@"\n')
    program.chmod(0o755)
    last = len(line.split()) - 1
    command = TRY[shell].format(line=line, last=last, next=last + 1)
    environment = {
        **os.environ,
        "PATH": f"{tmp_path}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "HOME": str(tmp_path),
    }
    run = subprocess.run(
        [shell, "-c", command], capture_output=True, text=True, env=environment, cwd=tmp_path
    )
    assert offered in {
        word for each in run.stdout.splitlines() for word in each.replace(":", " ").split()
    }, run


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("simulate fig9 --set Om", {"Omega="}),
        ("grazing --set v", {"v1=", "v2="}),
        ("sweep fig9 --over x", {"x0="}),
        ("sweep fig9 --record word,st", {"word,sticks", "word,stuck", "word,status"}),
        ("orbit fig9 --continue FN", {"FN="}),
        ("certify fig9 --branch FN", {"FN="}),
        ("certify fig9 --window P", {"P2", "P3", "P5", "P6"}),
        ("grazing fig9 --map P", {"P2", "P3", "P5", "P6"}),
        ("check fig9-", {"fig9-orbit"}),
        ("derive sticks --scene fig8-", {"fig8-exact"}),
        ("derive sw", {"switching"}),
        ("explore fig9-", {"fig9-orbit"}),
    ],
)
def test_names_are_completed(line: str, offered: set[str]) -> None:
    *before, begun = line.split()
    found = ShellComplete(main, {}, "symosc", "_SYMOSC_COMPLETE").get_completions(before, begun)
    assert {item.value for item in found} == offered
