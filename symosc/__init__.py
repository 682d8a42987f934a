"""symosc: exact solutions of the double-belt friction oscillator.

The names below are loaded on first use: importing symosc loads neither sympy nor matplotlib nor numba.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from symosc.admissible import Condition
    from symosc.batch import EventTable, simulate_many
    from symosc.branches import Branch, BranchEnd, BranchError
    from symosc.closing import ConvergenceError
    from symosc.continuation import continue_orbit
    from symosc.crosschecks import CrossCheck, crosscheck
    from symosc.errors import MissingExtraError, OutputError, ParameterError, SceneError, SymoscError
    from symosc.grazing import GrazingWindow, grazing_window
    from symosc.grazing_check import GrazingReport, check_grazing
    from symosc.grazing_curves import CurveEnd, CurvePiece, GrazingCurve, grazing_curve
    from symosc.grazing_orbits import GrazingStart, grazing_start
    from symosc.grazing_solve import GrazingSolutions, solve_grazing
    from symosc.grazing_state import GrazingVerdict, is_grazing
    from symosc.grazing_sweep import WindowColumns, grazing_windows
    from symosc.maps import compiled_residual, jacobian, parameter_jacobian, residual
    from symosc.model import Parameters
    from symosc.orbits import find_orbit
    from symosc.passages import MapError, MapPoint, solve_map
    from symosc.periodic import Approach, PeriodicOrbit, SwitchingPoint
    from symosc.sample_events import FoundEvent
    from symosc.sample_matching import Match
    from symosc.scenes import Scene, load_scene, scene_names
    from symosc.simulation import simulate
    from symosc.step_faults import Fault
    from symosc.symbolic.grazing_queries import Answer, values_containing, values_empty, values_everything
    from symosc.symbolic.theorem7 import Case, theorem7
    from symosc.trajectory import Event, Segment, Trajectory
    from symosc.windows import Place
    from symosc.words import Word, WordError, read_word

__version__ = "0.1.0"

_HOMES = {
    "SymoscError": "errors",
    "ParameterError": "errors",
    "SceneError": "errors",
    "OutputError": "errors",
    "MissingExtraError": "errors",
    "Parameters": "model",
    "Scene": "scenes",
    "load_scene": "scenes",
    "scene_names": "scenes",
    "simulate": "simulation",
    "simulate_many": "batch",
    "EventTable": "batch",
    "Event": "trajectory",
    "Segment": "trajectory",
    "Trajectory": "trajectory",
    "residual": "maps",
    "jacobian": "maps",
    "parameter_jacobian": "maps",
    "compiled_residual": "maps",
    "solve_map": "passages",
    "MapPoint": "passages",
    "MapError": "passages",
    "read_word": "words",
    "Word": "words",
    "WordError": "words",
    "find_orbit": "orbits",
    "Approach": "periodic",
    "SwitchingPoint": "periodic",
    "Condition": "admissible",
    "PeriodicOrbit": "periodic",
    "continue_orbit": "continuation",
    "Branch": "branches",
    "BranchEnd": "branches",
    "BranchError": "branches",
    "ConvergenceError": "closing",
    "grazing_window": "grazing",
    "GrazingWindow": "grazing",
    "Place": "windows",
    "grazing_windows": "grazing_sweep",
    "WindowColumns": "grazing_sweep",
    "theorem7": "symbolic.theorem7",
    "Case": "symbolic.theorem7",
    "grazing_start": "grazing_orbits",
    "GrazingStart": "grazing_orbits",
    "grazing_curve": "grazing_curves",
    "GrazingCurve": "grazing_curves",
    "CurvePiece": "grazing_curves",
    "CurveEnd": "grazing_curves",
    "solve_grazing": "grazing_solve",
    "GrazingSolutions": "grazing_solve",
    "is_grazing": "grazing_state",
    "GrazingVerdict": "grazing_state",
    "check_grazing": "grazing_check",
    "GrazingReport": "grazing_check",
    "values_containing": "symbolic.grazing_queries",
    "values_empty": "symbolic.grazing_queries",
    "values_everything": "symbolic.grazing_queries",
    "Answer": "symbolic.grazing_queries",
    "crosscheck": "crosschecks",
    "CrossCheck": "crosschecks",
    "Match": "sample_matching",
    "FoundEvent": "sample_events",
    "Fault": "step_faults",
}

__all__ = [
    "Answer",
    "Approach",
    "Branch",
    "BranchEnd",
    "BranchError",
    "Case",
    "Condition",
    "ConvergenceError",
    "CrossCheck",
    "CurveEnd",
    "CurvePiece",
    "Event",
    "EventTable",
    "Fault",
    "FoundEvent",
    "GrazingCurve",
    "GrazingReport",
    "GrazingSolutions",
    "GrazingStart",
    "GrazingVerdict",
    "GrazingWindow",
    "MapError",
    "MapPoint",
    "Match",
    "MissingExtraError",
    "OutputError",
    "ParameterError",
    "Parameters",
    "PeriodicOrbit",
    "Place",
    "Scene",
    "SceneError",
    "Segment",
    "SwitchingPoint",
    "SymoscError",
    "Trajectory",
    "WindowColumns",
    "Word",
    "WordError",
    "check_grazing",
    "compiled_residual",
    "continue_orbit",
    "crosscheck",
    "find_orbit",
    "grazing_curve",
    "grazing_start",
    "grazing_window",
    "grazing_windows",
    "is_grazing",
    "jacobian",
    "load_scene",
    "parameter_jacobian",
    "read_word",
    "residual",
    "scene_names",
    "simulate",
    "simulate_many",
    "solve_grazing",
    "solve_map",
    "theorem7",
    "values_containing",
    "values_empty",
    "values_everything",
]


def __getattr__(name: str) -> Any:
    if name == "plot":
        return import_module("symosc.plot")
    if name not in _HOMES:
        raise AttributeError(f"module 'symosc' has no attribute {name!r}")
    value = getattr(import_module(f"symosc.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__", "plot"])
