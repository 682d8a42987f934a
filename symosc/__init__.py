"""symosc: exact solutions of the double-belt friction oscillator.

The names below are loaded on first use: importing symosc loads neither sympy nor matplotlib nor numba.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from symosc.batch import EventTable, simulate_many
    from symosc.errors import MissingExtraError, OutputError, ParameterError, SceneError, SymoscError
    from symosc.model import Parameters
    from symosc.scenes import Scene, load_scene, scene_names
    from symosc.simulation import simulate
    from symosc.trajectory import Event, Segment, Trajectory

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
}

__all__ = [
    "Event",
    "EventTable",
    "MissingExtraError",
    "OutputError",
    "ParameterError",
    "Parameters",
    "Scene",
    "SceneError",
    "Segment",
    "SymoscError",
    "Trajectory",
    "load_scene",
    "scene_names",
    "simulate",
    "simulate_many",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'symosc' has no attribute {name!r}")
    value = getattr(import_module(f"symosc.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
