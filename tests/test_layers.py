"""The layers: imports go one way, the kernels are arithmetic, only the symbolic side knows sympy."""

from __future__ import annotations

import ast
from pathlib import Path

import symosc

ROOT = Path(symosc.__file__).parent
#: A module may import those before it (and nothing else of symosc); what is not listed is a face and may import all.
ORDER = [
    "errors",
    "exact",
    "model",
    "words",
    "scenes",
    "multiprecision",
    "kernels._generated",
    "kernels.entire",
    "kernels.entire_mp",
    "flow",
    "switching",
    "bounds",
    "events",
    "rests",
    "sticks",
    "advance",
    "loop",
    "binding",
    "numerics",
    "start",
    "files",
    "trajectory",
    "path",
    "backup",
    "simulation",
    "batch",
]
SYMBOLIC_ONLY = {"sympy"}


def imports(path: Path) -> set[str]:
    """Return the modules that a file imports at its top level."""
    found = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def path_of(module: str) -> Path:
    path = ROOT / (module.replace(".", "/") + ".py")
    return path if path.is_file() else ROOT / module / "__init__.py"


def test_imports_go_one_way() -> None:
    for position, module in enumerate(ORDER):
        allowed = {f"symosc.{name}" for name in ORDER[:position]}
        own = {name for name in imports(path_of(module)) if path_of(name.removeprefix("symosc.")).is_file()}
        own = {name for name in own if name.startswith("symosc.") and name != "symosc.kernels"}
        assert own <= allowed, f"symosc.{module} imports {sorted(own - allowed)}"


def test_only_symbolic_and_derivation_import_sympy() -> None:
    for path in ROOT.rglob("*.py"):
        heads = {name.partition(".")[0] for name in imports(path)}
        if "symbolic" not in path.parts and "derivation" not in path.parts:
            assert not heads & SYMBOLIC_ONLY, path


def test_generated_kernels_are_arithmetic() -> None:
    tree = ast.parse((ROOT / "kernels" / "_generated.py").read_text(encoding="utf-8"))
    assert not [node for node in ast.walk(tree) if isinstance(node, (ast.Import, ast.ImportFrom, ast.Call, ast.If))]


def test_no_text_stands_alone() -> None:
    """A string that is no docstring does nothing: it was meant to be part of the line before."""
    for path in ROOT.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            body = getattr(node, "body", [])
            own = isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
            for statement in body[own:] if isinstance(body, list) else []:
                lone = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
                assert not (lone and isinstance(statement.value.value, str)), f"{path.name}, line {statement.lineno}"
