"""What can drift apart: version, citation, changelog, license, the commands that contributors are told."""

from __future__ import annotations

import ast
import re
import sys
from typing import Any

import click
import pytest
from project_files import PROJECT, PYPROJECT, ROOT, text
from sources import nodes

import symosc
from symosc.cli.app import main


def test_the_version_is_written_once() -> None:
    assert "version" not in PROJECT
    assert PROJECT["dynamic"] == ["version"]
    assert PYPROJECT["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "symosc.__version__"}
    assert re.fullmatch(r"\d+\.\d+\.\d+", symosc.__version__)
    for path in (ROOT / "symosc").rglob("*.py"):
        written = f'"{symosc.__version__}"' in path.read_text(encoding="utf-8")
        assert written == (path == ROOT / "symosc" / "__init__.py"), path


def session_commands() -> dict[str, list[str]]:
    """Return for each session of nox what it runs, without the arguments that are given on its command line."""
    found: dict[str, list[str]] = {}
    for function in ast.parse(text("noxfile.py")).body:
        if isinstance(function, ast.FunctionDef):
            calls = [node for node in ast.walk(function) if isinstance(node, ast.Call)]
            runs = [call for call in calls if ast.unparse(call.func) == "session.run"]
            found[function.name] = [
                " ".join(map(str, filter(None, map(_value, run.args)))) for run in runs
            ]
    return found


def _value(node: ast.expr) -> Any:
    if isinstance(node, ast.Constant):
        return node.value
    return None


def contributor_commands() -> list[str]:
    """Return the lines of CONTRIBUTING's first block."""
    (block,) = re.findall(r"^```bash\n(.*?)^```$", text("CONTRIBUTING.md"), re.M | re.S)
    return [line.partition("#")[0].strip() for line in block.splitlines()]


def test_contributing_opens_with_three_commands_that_others_use_too() -> None:
    sessions = session_commands()
    readme = text("README.md")
    quick, lint, regenerate = (
        [part.removeprefix(".venv/bin/").replace('"', "") for part in line.split(" && ")]
        for line in contributor_commands()
    )
    assert quick == sessions["quick"]
    assert lint == [*sessions["lint"][:2], *sessions["types"]]
    assert regenerate == ["symosc codegen --regenerate"]
    assert sessions["codegen"] == ["symosc codegen"]
    assert all(f".venv/bin/{command}\n" in text(".ci/run") for command in lint)
    assert f".venv/bin/{sessions['tests'][0]}\n" in readme
    options = {
        name
        for each in main.get_command(click.Context(main), "codegen").params
        for name in each.opts
    }  # type: ignore[union-attr]
    assert {"--check", "--regenerate"} <= options


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_files_that_a_page_names_exist(page: str) -> None:
    names = re.findall(r"`((?:symosc|tests|docs|derivations)/[\w./]*)`", text(page))
    # Links that leave the repository by ../../ lead to pages of its host, such as the issue tracker.
    links = re.findall(r"\]\(((?!https?:|\.\./\.\./)[^)#]+)\)", text(page))
    assert names or links
    for name in {*names, *links}:
        assert (ROOT / name).exists(), name


def test_every_dependency_has_a_lower_bound_and_no_upper_one() -> None:
    for part in (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()):
        for each in part:
            assert re.fullmatch(r"symosc\[[\w,]+\]|[\w-]+>=[\d.]+", each), each


def test_what_is_imported_is_declared() -> None:
    """Every package that a module needs is one of ours, of Python's or of the project's dependencies."""
    named = [
        each
        for part in (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values())
        for each in part
    ]
    declared = {re.split(r"[>\[]", each)[0].lower().replace("-", "_") for each in named} | {
        "symosc"
    }
    declared |= {"flint"}  # of python-flint
    for path in (ROOT / "symosc").rglob("*.py"):
        for node in nodes(path):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            else:
                names = []
            if isinstance(node, ast.ImportFrom) and node.module:
                names += [node.module]
            else:
                names += []
            for head in {name.partition(".")[0] for name in names}:
                assert head in declared or head in sys.stdlib_module_names, (
                    f"{path.name} imports {head}"
                )


def test_nox_has_a_session_for_every_python_and_every_extra() -> None:
    declared = [each.rpartition(" ")[2] for each in PROJECT["classifiers"] if ":: 3." in each]
    extras = [name for name in PROJECT["optional-dependencies"] if name not in ("test", "dev")]
    values = {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in ast.parse(text("noxfile.py")).body
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and node.targets[0].id in ("PYTHONS", "EXTRAS")
    }
    assert values == {"PYTHONS": declared, "EXTRAS": extras}
