"""Running somebody's solver by its name."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from symosc import ParameterError, load_scene
from symosc.crosschecks.solver_runs import run_solver

SOURCE = """
print("loading")
def solve(p, t0, x0, v0, t_end):
    print("solving")
    return {"t": [t0, t_end], "x": [x0, x0], "v": [v0, float(p.k)]}
class Many:
    @staticmethod
    def solve(*start):
        return start
def none(*start): pass
def broken(*start):
    return 1 / 0
def leaves(*start):
    raise SystemExit(3)
number = 5
async def later(*start):
    return start
"""


def test_a_function_gets_the_problem(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "solver_of_a_test.py").write_text(SOURCE)
    scene = load_scene("fig9")
    start = [float(getattr(scene, name)) for name in ("t0", "x0", "v0", "t_end")]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    for module in ("solver_of_a_test", str(tmp_path / "solver_of_a_test.py")):
        found = run_solver(f"{module}:solve", scene)
        assert found == {"t": [start[0], start[3]], "x": [start[1]] * 2, "v": [start[2], float(scene.parameters.k)]}
        assert run_solver(f"{module}:Many.solve", scene) == (scene.parameters, *start)
    printed = capsys.readouterr()
    assert "solving" in printed.err
    assert printed.out == ""
    for name, words in (
        ("solver_of_a_test:none", "returned None"),
        ("solver_of_a_test:broken", r"failed: ZeroDivisionError: division by zero \(line 12 of solver_of_a_test.py\)"),
        ("solver_of_a_test:leaves", "failed: SystemExit: 3"),
        ("solver_of_a_test:number", "is no function of"),
        ("solver_of_a_test:later", "is async"),
        ("solver_of_a_test:other", "is no function of"),
        ("no_such_module:solve", "cannot be imported: ModuleNotFoundError"),
        ("no_such_file.py:solve", "cannot be imported: FileNotFoundError"),
        ("solver_of_a_test", "must be MODULE:FUNCTION"),
        (":solve", "must be MODULE:FUNCTION"),
    ):
        with pytest.raises(ParameterError, match=words) as caught:
            run_solver(name, scene)
        assert "\n" not in str(caught.value)
        assert "importlib" not in str(caught.value)  # a place is one in the solver's own files
        assert "solver_runs.py" not in str(caught.value)
