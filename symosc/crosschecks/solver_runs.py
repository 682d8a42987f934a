"""Running a solver of somebody else: a Python function, named on the command line."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from inspect import iscoroutine
from pathlib import Path
from traceback import extract_tb
from typing import Any

from symosc.errors import ParameterError, brief
from symosc.scenes import Scene


def run_solver(name: str, scene: Scene) -> Any:
    """Return what FUNCTION(parameters, t0, x0, v0, t_end) of a MODULE returns; the four numbers are floats.

    Parameters
    ----------
    name : str
        MODULE:FUNCTION, such as ``mysolver:solve`` or ``solvers/mine.py:solve``. What the function prints goes to
        standard error.
    scene : Scene

    Raises
    ------
    ParameterError
        If there is no such function, or it fails or returns nothing.
    """
    module, colon, function = name.rpartition(":")
    if not (module and colon and function):
        raise ParameterError("solver", name, "must be MODULE:FUNCTION, such as mysolver:solve")
    with redirect_stdout(sys.stderr):
        solve = _function(name, module, function)
        start = [float(getattr(scene, each)) for each in ("t0", "x0", "v0", "t_end")]
        try:
            solution = solve(scene.parameters, *start)
        except (Exception, SystemExit) as error:
            raise ParameterError("solver", name, f"failed: {_reason(error)}") from None
    if iscoroutine(solution):
        solution.close()  # or it says on standard error that nobody waited for it
        raise ParameterError("solver", name, "is async; it must return a solution")
    if solution is None:
        raise ParameterError("solver", name, "returned None; it must return a solution")
    return solution


def _function(name: str, module: str, function: str) -> Callable[..., Any]:
    try:
        found: Any = _module(module)
    except (Exception, SystemExit) as error:
        raise ParameterError("solver", name, f"cannot be imported: {_reason(error)}") from None
    for part in function.split("."):
        found = getattr(found, part, None)
    if not callable(found):
        raise ParameterError("solver", name, f"{brief(function)} is no function of {brief(module)}")
    solve: Callable[..., Any] = found
    return solve


def _module(name: str) -> Any:
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


def _reason(error: BaseException) -> str:
    """Return an error as one line, with the place where it was raised."""
    own = ("importlib", __file__)
    frames = [frame for frame in extract_tb(error.__traceback__) if not any(name in frame.filename for name in own)]
    place = f" (line {frames[-1].lineno} of {Path(frames[-1].filename).name})" if frames else ""
    return brief(f"{type(error).__name__}: {error}") + place
