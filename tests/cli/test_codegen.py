"""The command `symosc codegen`: what it writes and prints, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli_runs import good, run
from click.testing import CliRunner

from symosc import load_scene
from symosc.cli.codegen import codegen
from symosc.symbolic.export import export


def test_command_writes_files(tmp_path: Path) -> None:
    result = CliRunner().invoke(codegen, ["P32", "-l", "c", "--fix", "fig9", "-o", str(tmp_path / "a" / "b"), "--json"])
    assert result.exit_code == 0
    assert [Path(path).name for path in json.loads(result.stdout)] == ["p32.h", "p32.c"]
    assert (tmp_path / "a" / "b" / "p32.c").read_text() == export("P32", "c", load_scene("fig9").parameters)["p32.c"]


@pytest.mark.slow
def test_command_prints() -> None:
    result = CliRunner().invoke(codegen, ["P32", "--language", "julia", "-o", "-"])
    assert result.stdout == export("P32", "julia")["p32.jl"]
    assert "is what the formulas print" in CliRunner().invoke(codegen, ["--check"]).stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give --check or --regenerate, or a WORD"),
        (["--check", "--regenerate"], "not both"),
        (["-l", "c"], "--language needs a WORD"),
        (["--language", "python"], "--language needs a WORD"),
        (["--check", "--fix", "fig9"], "--fix needs a WORD"),
        (["--regenerate", "--name", "a", "--json"], "--name, --json needs a WORD"),
        (["--check", "-o", "."], "--output needs a WORD"),
        (["--check", "--force"], "--force needs a WORD"),
        (["P32", "--check"], "leave WORD out"),
        (["P32", "--regenerate"], "leave WORD out"),
        (["P32", "-o", "-", "--json"], "standard output"),
        (["P32", "-o", "-", "--force"], "leave it out"),
        (["P32", "-o", ""], "name of a file"),
        (["P32", "--name", ""], "name = ''"),
        (["P32", "--name", "for"], "is a word"),
        (["P32", "--fix", ""], "unknown"),
        (["P33"], "P3 cannot follow P3"),
        ([""], "is empty"),
    ],
)
def test_the_command_never_ignores_an_option_and_never_touches_the_package(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from symosc.cli.app import main
    from symosc.symbolic import codegen as generator

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(generator, "PATH", tmp_path / "package" / "_generated.py")
    monkeypatch.setattr(generator, "generate", lambda: "pass")
    (tmp_path / "package").mkdir()
    result = CliRunner().invoke(main, ["codegen", *arguments])
    assert result.exit_code == 2, result.output
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.rglob("*")] == ["package"]


def test_codegen_check_prints_the_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    import symosc.symbolic.codegen as codegen

    monkeypatch.setattr(codegen, "check", lambda: "")
    assert "is what the formulas print" in good("codegen", "--check")
    monkeypatch.setattr(codegen, "check", lambda: "-committed\n+generated\n")
    result = run("codegen", "--check")
    assert (result.exit_code, result.stdout) == (1, "-committed\n+generated\n\n")
    assert "accept: symosc codegen --regenerate" in result.stderr


def test_codegen_writes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import symosc.symbolic.codegen as codegen

    monkeypatch.setattr(codegen, "PATH", tmp_path / "_generated.py")
    monkeypatch.setattr(codegen, "generate", lambda: "pass\n")
    assert run("codegen").exit_code == 2
    assert not (tmp_path / "_generated.py").exists()
    assert good("codegen", "--regenerate") == f"wrote {tmp_path / '_generated.py'}\n"
    assert (tmp_path / "_generated.py").read_text() == "pass\n"
