"""What `crosscheck` was given, as solutions: arrays, or one thing of any kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from symosc.crosschecks.files import read_solutions
from symosc.crosschecks.functions import of_function, solver_task
from symosc.crosschecks.samples import Samples, checked, checked_positions
from symosc.errors import ParameterError
from symosc.model import Parameters
from symosc.scenes import Scene


def given_solutions(
    scene: Scene | Parameters, given: tuple[Any, Any, Any], events: Any, columns: Mapping[str, str | None] | None
) -> list[Samples]:
    """Return the solutions in t, x and v as `crosscheck` takes them, with the events that were listed beside."""
    t, x, v = given
    problem = solver_task(scene)
    if x is None and v is None:
        found = read_solutions(t, columns, problem)
    elif callable(x) and not hasattr(x, "__array__"):
        found = [of_function(x, problem, t)]
    else:
        found = [checked(t, x, v, events) if v is not None else checked_positions(t, x, events)]
    if events is None:
        return found
    if len(found) > 1:
        raise ParameterError("events", "given", f"can be listed for one solution; there are {len(found)}")
    listed = checked(found[0].t, found[0].x, found[0].x, events).events
    return [replace(found[0], events=listed)]
