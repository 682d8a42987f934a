"""Functions bound to other globals.

They say where they are written, and the compiled ones notice every change.
"""

from __future__ import annotations

import contextlib
import importlib
import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from symosc import load_scene
from symosc.base.errors import CodeCacheWarning
from symosc.engine import tangent
from symosc.engine.arithmetic import IN_DOUBLES_ONLY, SOURCES, MpArithmetic, column_functions
from symosc.kernels import elementary, entire_array, formulas, mapping
from symosc.kernels.compiling import compile_modules, is_compiled
from symosc.kernels.rebind import functions_of, outlined_in

pytest.importorskip("numba")

CALLEE = "def inner(x):\n    return x + 1\n"
CALLER = "from callee import inner\n\n\ndef outer(x):\n    return inner(x)\n"
RUN = """
import sys
sys.path.insert(0, sys.argv[1])
import callee, caller
from symosc.kernels.compiling import compile_modules, is_compiled
together = compile_modules((callee, caller))["outer"]
apart = compile_modules((caller,), callees=compile_modules((callee,)))["outer"]
before = is_compiled(together), is_compiled(apart)
print(before, *((outer(1), sum(outer.stats.cache_hits.values())) for outer in (together, apart)))
print(is_compiled(together), is_compiled(apart), is_compiled(caller.outer))
"""


@pytest.mark.slow
def test_the_disk_cache_is_used_and_notices_what_is_called(tmp_path: Path) -> None:
    """Even if the file that changed looks older than the others.

    And what is on disk is known before it is called.
    """

    def run() -> str:
        command = [sys.executable, "-c", RUN, str(tmp_path)]
        env = {
            **os.environ,
            "PYTHONDONTWRITEBYTECODE": "1",
            "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
        }
        first, after = subprocess.run(
            command, check=True, capture_output=True, text=True, env=env
        ).stdout.splitlines()
        assert after == "True True True"  # what is not for numba needs no compiling
        return first

    (tmp_path / "callee.py").write_text(CALLEE)
    (tmp_path / "caller.py").write_text(CALLER)
    assert run() == "(False, False) (2, 0) (2, 0)"
    assert run() == "(True, True) (2, 1) (2, 1)"
    (tmp_path / "callee.py").write_text(CALLEE.replace("+ 1", "+ 5"))
    os.utime(tmp_path / "callee.py", (1e9, 1e9))
    assert run() == "(False, False) (6, 0) (6, 0)"


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], Any]]:
    """Return what compiles a function as a new program would, with the cache folder in `tmp_path`."""
    import numba

    from symosc.kernels import code_cache

    (tmp_path / "tiny.py").write_text("def twice(x): return 2 * x\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))

    def made() -> Any:
        monkeypatch.setattr(code_cache, "_warned", set())
        return compile_modules((importlib.import_module("tiny"),))["twice"]

    yield made
    sys.modules.pop("tiny", None)


def test_a_bar_says_that_functions_are_compiled_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import numba

    from symosc.kernels import code_cache

    source = """
def least(x): return x - 1
def inner(x): return 2 * least(x)
def outer(x): return inner(x) + least(x)
def unused(x): return x
"""
    (tmp_path / "several.py").write_text(source)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    reports: list[Any] = []

    @contextlib.contextmanager
    def bar(label: str, total: float, unit: str) -> Iterator[Any]:
        reports.append((label, total, unit))
        yield lambda done, total: reports.append((done, total))
        reports.append("closed")

    monkeypatch.setattr(code_cache, "bar", bar)
    module = importlib.import_module("several")
    assert compile_modules((module,))["outer"](3) == 6
    title = ("compiling, once for all programs", 4, "functions")
    assert reports == [title, (1, 4), (2, 4), (4, 4), "closed"]
    reports.clear()
    assert compile_modules((module,))["outer"](3) == 6  # as a later program does: from the disk
    assert reports == []
    sys.modules.pop("several", None)


COUNTING = """
def added(total, n, twice): return total + (2 * n if twice else n)
def outer(count):
    total = 0
    for n in range(count):
        total = added(total, n, True)
    return added(total, 1, False)
"""


def test_compiled_code_calls_one_version_for_all_numbers_that_are_written_down(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And Python cannot call what has no wrapper for it."""
    import numba

    (tmp_path / "counting.py").write_text(COUNTING)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    functions = compile_modules((importlib.import_module("counting"),), entries=("outer",))
    sys.modules.pop("counting", None)
    assert functions["outer"](3) == 7
    (version,) = functions["added"].nopython_signatures
    assert [str(kind) for kind in version.args] == ["int64", "int64", "bool"]
    with pytest.raises(TypeError, match="added was compiled for compiled code only"):
        functions["added"](1, 2, True)


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "cut": lambda content: content[: len(content) // 2],
    "flipped late": lambda content: content[:-40] + bytes([content[-40] ^ 16]) + content[-39:],
}


@pytest.mark.parametrize("kind", ["*.nbi", "*.nbc"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_compiled_code_is_compiled_anew(
    tiny: Callable[[], Any], kind: str, damage: str, tmp_path: Path
) -> None:
    """Nor is changed machine code ever run."""
    assert tiny()(3) == 6
    (path,) = (tmp_path / "cache").rglob(kind)
    path.write_bytes(DAMAGES[damage](path.read_bytes()))
    function = tiny()
    with pytest.warns(CodeCacheWarning, match="is damaged") as said:
        assert function(4) == 8
    assert len(said) == 1
    again = tiny()
    assert again(5) == 10
    assert sum(again.stats.cache_hits.values()) == 1


def test_an_error_that_is_no_damage_deletes_no_compiled_code(
    tiny: Callable[[], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Code that needs a module which cannot be imported just now is still good afterwards."""
    from symosc.kernels.code_cache import _CheckedFiles

    assert tiny()(3) == 6
    before = {path: path.read_bytes() for path in (tmp_path / "cache").rglob("*.nb?")}

    def failing(self: Any, name: str) -> Any:
        raise ImportError("no such library")

    with monkeypatch.context() as patched:
        patched.setattr(_CheckedFiles, "_load_data", failing)
        patched.setattr(_CheckedFiles, "save", lambda *entry: None)
        with pytest.warns(CodeCacheWarning, match="cannot be read: ImportError: no such library"):
            assert tiny()(4) == 8
    assert {path: path.read_bytes() for path in (tmp_path / "cache").rglob("*.nb?")} == before
    again = tiny()
    assert again(5) == 10
    assert sum(again.stats.cache_hits.values()) == 1


def test_without_a_folder_for_compiled_code_there_is_one_warning(
    tiny: Callable[[], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Files in place of folders: the administrator too can write nothing there."""
    for name in ("cache", "home", "__pycache__"):
        (tmp_path / name).write_text("")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    functions = [tiny(), compile_modules((sys.modules["tiny"],))["twice"]]
    assert not any(map(is_compiled, functions))
    with pytest.warns(CodeCacheWarning, match="cannot be kept.*NUMBA_CACHE_DIR") as said:
        assert [function(3) for function in functions] == [6, 6]
    assert len(said) == 1


def test_every_file_with_other_globals_says_so() -> None:
    """Where a name does not mean what the import above it says, the reader is told."""
    for module in (*SOURCES, *IN_DOUBLES_ONLY, mapping, tangent, entire_array, formulas):
        assert "This file is executed with other globals" in (module.__doc__ or ""), module


def test_a_mark_on_the_function_says_what_is_not_inlined() -> None:
    """The mark stays beside the function, so that renaming it loses nothing."""
    marked = outlined_in(SOURCES)
    assert {"stepped", "follow_one", "series"} <= marked
    assert "state_at" not in marked
    assert marked < functions_of(SOURCES).keys()


# -- one binder for all arithmetics ------------------------------------------------------------------------------------


def is_short(value: float) -> bool:
    """Whether a number is a limit that somebody chose (4e-3, 64) or a power of two, and no constant of mathematics."""
    return (
        value == float(f"{value:.2g}") or (1024 * value).is_integer() or math.frexp(value)[0] == 0.5
    )


def test_no_double_constant_gets_into_many_digits() -> None:
    """pi, 1/6 or the rounding unit of doubles would spoil every digit behind the 16th."""
    namespace = MpArithmetic(load_scene("fig5").parameters, 50).namespace
    used = set()
    literals = set()
    # What makes the constants is told which numbers to make, pi among them.
    makers = {"constants", "constant_table", "with_march", "_period_rest", "_belt_constants"}
    for name, original in functions_of(SOURCES).items():
        bound = getattr(namespace[name], "__code__", None)
        if bound and name not in makers:
            used |= set(bound.co_names)
            literals |= {value for value in original.__code__.co_consts if isinstance(value, float)}
            assert not [value for value in bound.co_consts if isinstance(value, float)], (
                name
            )  # they are made once
    assert {"EPS", "PI", "TWO_PI", "SIXTH", "ROUNDING"} <= used
    for name in used & set(namespace):
        value = namespace[name]
        if hasattr(value, "_mpf_"):
            assert value != float(value) or is_short(float(value)), (name, value)
        assert not isinstance(value, float), (name, value)
    assert all(is_short(value) for value in literals), literals
    for name in ("EPS", "PI", "TWO_PI", "SIXTH", "NEAR"):
        assert namespace[name].context.dps >= 50, name


def test_functions_of_columns_have_the_bits_of_single_numbers() -> None:
    """Numpy's own have those of the processor."""
    own = column_functions()
    x = np.random.default_rng(1).uniform(-700, 700, 20_000)
    for name in ("sin", "cos", "exp", "expm1"):
        assert own[name](x).tolist() == [getattr(elementary, name)(entry) for entry in x.tolist()]
        assert own["basis"].__globals__["np"].__dict__[name] is own[name]
    assert own["sin"](np.array([1e7])) == elementary.sin(1e7)
