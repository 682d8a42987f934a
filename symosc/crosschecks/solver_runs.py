"""Run somebody's solver, which the command line names."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from inspect import iscoroutine
from pathlib import Path
from traceback import extract_tb
from typing import Any

from symosc.base.errors import ParameterError, brief
from symosc.scenes import STARTS, Scene


def run_solver(name: str, scene: Scene) -> Any:
    """Return what the solver "MODULE:FUNCTION" or "file.py:FUNCTION" returns for (parameters, t0,
    x0, v0, t_end).

    It prints to standard error. ParameterError if it does not exist, fails, or returns nothing.
    """
    module, colon, function = name.rpartition(":")
    if not (module and colon and function):
        raise ParameterError("solver", name, "must be MODULE:FUNCTION, such as mysolver:solve")
    with redirect_stdout(sys.stderr):
        try:
            solve = _imported(module)
        except (Exception, SystemExit) as error:
            what = f"cannot be imported: {_error_text(error)}"
            raise ParameterError("solver", name, what) from None
        for part in function.split("."):
            solve = getattr(solve, part, None)
        if not callable(solve):
            what = f"{brief(function)} is no function of {brief(module)}"
            raise ParameterError("solver", name, what)
        start = [float(getattr(scene, number)) for number in (*STARTS, "t_end")]
        try:
            solution = solve(scene.parameters, *start)
        except (Exception, SystemExit) as error:
            raise ParameterError("solver", name, f"failed: {_error_text(error)}") from None
    if iscoroutine(solution):
        solution.close()  # or Python warns on standard error that nobody waited for it
        raise ParameterError("solver", name, "is async; it must return a solution")
    if solution is None:
        raise ParameterError("solver", name, "returned None; it must return a solution")
    return solution


def _imported(name: str) -> Any:
    """Import a module, given its name or the name of its file."""
    if not name.endswith(".py"):
        if "" not in sys.path:
            sys.path.insert(0, "")  # the folder in which the command runs
        return import_module(name)
    spec = spec_from_file_location(Path(name).stem, name)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def _error_text(error: BaseException) -> str:
    """Return an error as one line, with the place where it was raised."""
    own = ("importlib", __file__)
    frames = [
        frame
        for frame in extract_tb(error.__traceback__)
        if not any(name in frame.filename for name in own)
    ]
    text = brief(f"{type(error).__name__}: {error}")
    if frames:
        return f"{text} (line {frames[-1].lineno} of {Path(frames[-1].filename).name})"
    return text
