"""The layers: packages use only those before them, no module is in a circle, only the symbolic side knows sympy."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

from sources import nodes

import symosc
from symosc.base.layers import LAYERS

ROOT = Path(symosc.__file__).parent
LEVEL = {name: i for i, names in enumerate(LAYERS) for name in names}


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


MODULES = {module_name(path): path for path in ROOT.rglob("*.py") if path != ROOT / "__init__.py"}


def body(path: Path) -> list[ast.stmt]:
    module = nodes(path)[0]
    assert isinstance(module, ast.Module)
    return module.body


@cache
def imports(path: Path) -> list[str]:
    """Return what a file imports, wherever in it."""
    found = []
    for node in nodes(path):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            found += [f"{node.module}.{alias.name}" for alias in node.names]
    return found


def used(path: Path) -> Iterator[str]:
    """Yield the modules of symosc that a file imports, late imports included."""
    for name in imports(path):
        if name.split(".")[0] == "symosc":
            parts = name.split(".")[1:]
        else:
            parts = []
        modules = [".".join(parts[: i + 1]) for i in range(len(parts))]
        found = [module for module in modules if module in MODULES]
        if found:
            yield found[-1]


def test_every_module_is_at_a_level() -> None:
    assert {name.split(".")[0] for name in MODULES} == set(LEVEL)


def test_packages_use_only_those_before_them() -> None:
    upward = []
    for name, path in MODULES.items():
        here = name.split(".")[0]
        for other in used(path):
            there = other.split(".")[0]
            if there != here and LEVEL[there] >= LEVEL[here]:
                upward.append(f"{name} uses {other}")
    assert upward == []


def test_no_module_is_in_a_circle() -> None:
    graph = {name: set(used(path)) - {name} for name, path in MODULES.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        raise AssertionError(" -> ".join(error.args[1])) from None


def test_only_symbolic_and_derivations_import_sympy() -> None:
    """At their top; a late import is one that a fast path never comes to."""
    for name, path in MODULES.items():
        heads = {
            alias.name.split(".")[0]
            for node in body(path)
            if isinstance(node, ast.Import)
            for alias in node.names
        }
        heads |= {
            (node.module or "").split(".")[0]
            for node in body(path)
            if isinstance(node, ast.ImportFrom)
        }
        if name.split(".")[0] not in ("symbolic", "derive"):
            assert "sympy" not in heads, name


def test_every_package_says_what_it_is_for() -> None:
    for path in ROOT.rglob("__init__.py"):
        assert ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))), path


def test_a_class_name_stands_for_one_class() -> None:
    homes: dict[str, list[str]] = {}
    for name, path in MODULES.items():
        for node in nodes(path):
            if isinstance(node, ast.ClassDef):
                homes.setdefault(node.name, []).append(name)
    assert {name: modules for name, modules in homes.items() if len(modules) > 1} == {}
