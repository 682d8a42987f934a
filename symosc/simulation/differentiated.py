"""A motion in the columns that its derivatives are computed from, whatever its friction law is."""

from __future__ import annotations

from collections.abc import Callable

from symosc.engine.start import Start
from symosc.model import Model
from symosc.simulation.banded import BandedColumns
from symosc.simulation.law_gradients import law_gradients, with_all_points
from symosc.simulation.plain import PlainColumns
from symosc.simulation.trajectory import Trajectory


def columns_for(
    motion: Trajectory, start: Start, wrt: tuple[str, ...], follow: Callable[[Model], Trajectory]
) -> PlainColumns | BandedColumns:
    """Return a motion in columns for its derivatives by `wrt`.

    `follow` returns the motion from the same start with another model.
    """
    model = start.parameters
    if model.law.is_plain:
        return PlainColumns(motion, start)
    if law_gradients(model, wrt).bends_a_line:
        finer = follow(with_all_points(model))
        # If the kinds differ, one of them followed another motion, see `sensitivities`.
        if [event.kind for event in finer.events] == [event.kind for event in motion.events]:
            motion = finer
    return BandedColumns(motion, start)
