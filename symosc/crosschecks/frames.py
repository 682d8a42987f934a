"""Samples of another model as samples of the oscillator that it is in other coordinates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.base.exact import show
from symosc.crosschecks.rounding import find_rounding
from symosc.crosschecks.samples import Samples
from symosc.model import Model
from symosc.reductions import OtherModel, motion_of_frame, reduced_model
from symosc.scenes import Scene

#: The problem that a function or a solver solves; None if it is not known.
Problem = Scene | Model | OtherModel | None


def own_frame(problem: Problem) -> tuple[OtherModel | None, float | None]:
    """Return the model in whose coordinates the solutions of a problem are, and the time at which
    its scene starts; None each where there is none.
    """
    if isinstance(problem, OtherModel):
        return problem, None
    if isinstance(problem, Scene) and problem.original is not None:
        return problem.original.model, float(problem.original.t0)
    return None, None


def reduced_problem(problem: Scene | Model | OtherModel) -> Scene | Model:
    """Return the problem of the oscillator that another model is; any other problem as it is."""
    if isinstance(problem, OtherModel):
        return reduced_model(problem)
    if isinstance(problem, Scene):
        return problem.reduced()
    return problem


def has_moving_frame(problem: Problem) -> bool:
    """Return whether velocities are others in the coordinates of a problem than in those of the
    oscillator.
    """
    model, _ = own_frame(problem)
    return model is not None and (model.pull != 0 or model.shift.bound() != 0)


def in_oscillator(samples: Samples, model: OtherModel, start: float | None) -> Samples:
    """Return samples in the coordinates of the oscillator to which a model reduces.

    Their numbers no longer show how they were rounded, so this is looked for before; `start` is the
    time at which the model's scene starts.
    """
    delay = float(model.delay)
    speeds = [float(belt.v) for belt in model.oscillator.belts]
    rounding = find_rounding(samples, speeds, start)
    w, rate = motion_of_frame(model, samples.t)
    events = samples.events
    if events is not None:
        events = tuple((t - delay, kind) for t, kind in events)
    lists = samples.lists
    if lists is not None:
        lists = tuple(tuple(t - delay for t in times) for times in lists)
    dense = samples.dense
    if dense is not None:
        dense = _dense_in_oscillator(dense, model)
    return replace(
        samples,
        t=samples.t - delay,
        x=samples.x - w,
        v=samples.v - rate,
        events=events,
        lists=lists,
        dense=dense,
        notes=(*samples.notes, *_notes(model)),
        rounding=rounding,
    )


def _dense_in_oscillator(
    dense: Callable[[np.ndarray], Any], model: OtherModel
) -> Callable[[np.ndarray], Any]:
    """Return a solver's own function in the coordinates of the oscillator."""

    def moved(t: np.ndarray) -> np.ndarray:
        times = t + float(model.delay)
        return np.asarray(dense(times)) - np.array(motion_of_frame(model, times))

    return moved


def _notes(model: OtherModel) -> list[str]:
    """Return what is said of the coordinates in which samples are compared."""
    moves = []
    if model.delay:
        moves.append(f"t less {float(model.delay):.10g}")
    if model.pull:
        moves.append(f"x less {show(model.pull)} t")
    if model.shift.bound():
        moves.append("x less the motion of the belts")
    if not moves:
        return []
    return [
        f"times and states are shown as those of the oscillator that the model is: "
        f"{', '.join(moves)}; errors are the same"
    ]
