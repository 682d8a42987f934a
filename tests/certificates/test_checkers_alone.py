"""The checkers, copied out: alone, and with the files that they name beside them; nothing of symosc is there."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import symosc.certificates.verify as checker
from symosc import certify, continue_orbit, find_orbit, grazing_window, load_scene

FOLDER = Path(checker.__file__).parent
#: What each file needs beside it, and the kinds that it proves.
CHECKERS = {
    "verify.py": ((), {"trajectory", "settled", "window"}),
    "verify_orbits.py": (("verify.py",), {"trajectory", "settled", "window", "orbit", "branch"}),
}
KINDS = ("trajectory", "orbit", "window", "branch", "settled")

pytestmark = pytest.mark.slow


@cache
def document(kind: str) -> str:
    p = load_scene("fig9").parameters
    made = {
        "trajectory": lambda: certify("fig6"),
        "orbit": lambda: certify(find_orbit(p, "P32")),
        "window": lambda: certify(grazing_window(p, "P2")),
        "settled": lambda: certify("fig9-orbit", t_end=2000),
        "branch": lambda: certify(continue_orbit(p, "P32", "Omega", ("3.9", "4.1"))),
    }[kind]()
    assert made.proven, made.message
    return json.dumps(made.as_dict())


def run(folder: Path, name: str, *arguments: str) -> tuple[int, str, str]:
    """Run a copy by itself: no variable of the environment, and no folder but its own, leads to symosc."""
    line = "import sys; sys.path.insert(0, '.'); sys.argv = sys.argv[1:]; import runpy; runpy.run_path(sys.argv[0], "
    command = [sys.executable, "-I", "-c", line + "run_name='__main__')", name, *arguments]
    done = subprocess.run(command, cwd=folder, env={}, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def copied(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).write_bytes((FOLDER / name).read_bytes())


@pytest.mark.parametrize("name", CHECKERS)
def test_a_copy_proves_its_kinds_and_refuses_the_others(name: str, tmp_path: Path) -> None:
    beside, proves = CHECKERS[name]
    copied(tmp_path, name, *beside)
    for kind in KINDS:
        (tmp_path / "it.json").write_text(document(kind), encoding="utf-8")
        code, out, err = run(tmp_path, name, "it.json")
        if kind in proves:
            assert (code, err, out.startswith("proven: ")) == (0, "", True), (kind, out)
        else:
            assert (code, out) == (2, ""), kind
            assert (
                err == f"no certificate: {kind!r}: of that kind this checker proves none. verify_orbits.py proves it\n"
            )


@pytest.mark.parametrize("name", list(CHECKERS)[1:])
def test_a_copy_says_which_file_has_to_be_beside_it(name: str, tmp_path: Path) -> None:
    needed = CHECKERS[name][0]
    (tmp_path / "it.json").write_text(document("orbit"), encoding="utf-8")
    for there in [needed[:i] for i in range(len(needed))]:
        copied(tmp_path, name, *there)
        code, out, err = run(tmp_path, name, "it.json")
        assert (code, out, len(err.splitlines())) == (2, "", 1), err
        assert "has to be beside" in err


@pytest.mark.parametrize("name", CHECKERS)
def test_a_checker_needs_python_flint_and_nothing_of_symosc(name: str) -> None:
    nodes = list(ast.walk(ast.parse((FOLDER / name).read_text(encoding="utf-8"))))
    heads = {alias.name.split(".")[0] for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    heads |= {(node.module or "").split(".")[0] for node in nodes if isinstance(node, ast.ImportFrom)}
    assert heads <= {"flint", *sys.stdlib_module_names}


def test_the_limits_are_options_of_a_copy(tmp_path: Path) -> None:
    copied(tmp_path, "verify.py")
    (tmp_path / "it.json").write_text(document("settled"), encoding="utf-8")
    code, out, err = run(tmp_path, "verify.py", "it.json", "--steps", "20")
    assert (code, out, err) == (1, "", "not proven: more than 20 steps (--steps)\n")
