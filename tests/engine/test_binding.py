"""Functions bound to other globals: they say where they are written, and the compiled ones notice every change."""

from __future__ import annotations

import importlib
import inspect
import os
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from symosc import load_scene
from symosc.engine.arithmetic import SOURCES, MpArithmetic
from symosc.engine.binding import bind, compiled, functions_of, version

pytest.importorskip("numba")

SETS: dict[str, Callable[[], dict[str, Any]]] = {
    "fast paths": lambda: importlib.import_module("symosc.engine.arithmetic").compiled(),
    "mappings": lambda: {"flights": importlib.import_module("symosc.mappings.equations")._compiled_loop()},
    "windows": lambda: {"windows": importlib.import_module("symosc.grazing.sweep")._rows()},
    "peer by scanning": lambda: importlib.import_module("symosc.bench.peers_scan").compiled(),
    "peer by DOP853": lambda: importlib.import_module("symosc.bench.peers_numba").compiled(),
}


@pytest.mark.parametrize("name", SETS)
def test_compiled_functions_show_their_own_source(name: str) -> None:
    """numba asks for it; from Python 3.13 on `inspect` fails where file and line do not fit each other."""
    functions = {key: value.py_func for key, value in SETS[name]().items() if hasattr(value, "py_func")}
    assert functions
    for key, function in functions.items():
        original = getattr(sys.modules[function.__module__], key)
        assert inspect.getsource(function) == inspect.getsource(original)
        assert inspect.getsource(function).startswith((f"def {key}(", "@"))


def test_functions_in_many_digits_show_their_own_source() -> None:
    namespace = MpArithmetic(load_scene("fig5").parameters, 20).namespace
    for name, original in functions_of(SOURCES).items():
        if name != "basis":
            assert inspect.getsource(namespace[name]) == inspect.getsource(original)


@pytest.mark.parametrize("module", SOURCES, ids=lambda module: module.__name__)
def test_a_change_in_any_file_is_another_version(module: types.ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    before = version({}, SOURCES)
    usual = inspect.getsource

    def changed(asked: Any) -> str:
        return usual(asked) + (" " if asked is module else "")

    monkeypatch.setattr(inspect, "getsource", changed)
    assert version({}, SOURCES) != before


def test_a_constant_from_elsewhere_is_part_of_the_version() -> None:
    assert version({"EPS": 1e-16}, SOURCES) != version({"EPS": 2e-16}, SOURCES)
    assert version({"f": len}, SOURCES) == version({"f": print}, SOURCES)


CALLEE, CALLER = (
    "def inner(x):\n    return x + 1\n",
    "from callee import inner\n\n\ndef outer(x):\n    return inner(x)\n",
)
RUN = """
import sys
sys.path.insert(0, sys.argv[1])
import callee, caller
from symosc.engine.binding import compiled
together = compiled((callee, caller))["outer"]
apart = compiled((caller,), callees=compiled((callee,)))["outer"]
print(*((outer(1), sum(outer.stats.cache_hits.values())) for outer in (together, apart)))
"""


@pytest.mark.slow
def test_the_disk_cache_is_used_and_notices_what_is_called(tmp_path: Path) -> None:
    """Even if the file that changed looks older than the others."""

    def run() -> str:
        command = [sys.executable, "-c", RUN, str(tmp_path)]
        env = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        return subprocess.run(command, check=True, capture_output=True, text=True, env=env).stdout.strip()

    (tmp_path / "callee.py").write_text(CALLEE)
    (tmp_path / "caller.py").write_text(CALLER)
    assert run() == "(2, 0) (2, 0)"
    assert run() == "(2, 1) (2, 1)"
    (tmp_path / "callee.py").write_text(CALLEE.replace("+ 1", "+ 5"))
    os.utime(tmp_path / "callee.py", (1e9, 1e9))
    assert run() == "(6, 0) (6, 0)"


def module_of(name: str, source: str) -> types.ModuleType:
    module = types.ModuleType(name)
    exec(compile(source, name, "exec"), vars(module))
    return module


def test_names_that_do_not_fit_are_refused() -> None:
    """A constant that is no longer there would leave many digits with the one of doubles."""
    one, two = module_of("one", "A = 1\ndef f(): return A"), module_of("two", "def f(): return 2")
    assert bind((one,), {"A": 5})["f"]() == 5
    with pytest.raises(ValueError, match=r"\['B'\] are no names in \['one'\]"):
        bind((one,), {"B": 5})
    with pytest.raises(ValueError, match="f is written in one and in two"):
        bind((one, two), {})
    with pytest.raises(ValueError, match="f is written in one and in two"):
        compiled((one, two))
