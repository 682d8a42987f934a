"""The corners of friction curves that a motion passes, in many digits.

They are no events of a motion. But the checker, which follows a motion from band to band, is told
about each of them as about an event.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from symosc.base.aliases import Number
from symosc.certificates.certificate import CORNER
from symosc.engine.events import Event
from symosc.engine.start import Start
from symosc.friction import FrictionLaw
from symosc.simulation.banded import BandedColumns
from symosc.simulation.trajectory import Trajectory


class PassedCorner(NamedTuple):
    """A corner that a motion passes, with the attributes of an `Event` that a file needs.

    `boundary` is the number of the corner from 1 by speed; both modes are the domain around it.
    """

    kind: str
    boundary: int
    source: str
    target: str
    t: Number
    x: Number
    t_error: float
    x_error: float


Step = Event | PassedCorner


def corner_numbers(law: FrictionLaw) -> dict[int, int]:
    """Return the number of the corner above each row of a law, for the rows that have one.

    Where the corners of two belts make up for each other there is none.
    """
    numbers = dict[int, int]()
    for i, (below, above) in enumerate(zip(law.rows, law.rows[1:], strict=False)):
        is_corner = below.above is not None and not below.above.belt
        if is_corner and (below.slope, below.forces[1]) != (above.slope, above.forces[1]):
            numbers[i] = len(numbers) + 1
    return numbers


def corner_speed(law: FrictionLaw, number: int) -> Fraction:
    """Return the speed of a corner, given its number from 1 by speed."""
    row = next(row for row, corner in corner_numbers(law).items() if corner == number)
    edge = law.rows[row].above
    assert edge is not None
    return Fraction(edge.v)


def steps_of(run: Trajectory, start: Start) -> Sequence[Step]:
    """Return the events of a motion in many digits, and the corners that it passes between them, in
    order of time.
    """
    law = run.parameters.law
    if not law.has_curves:
        return list(run.events)
    numbers = corner_numbers(law)
    columns = BandedColumns(run, start)
    digits = columns.context.dps
    steps = list[Step]()
    before = 0
    for piece in range(1, len(columns.modes)):
        n = columns.events[piece]
        if n >= 0:
            steps.append(run.events[n])
            before = n
            continue
        lower, upper = sorted(columns.bands[piece - 1 : piece + 1].tolist())
        if lower == upper or lower not in numbers:
            continue
        # The errors of the events around it, and rounding, are about those of the corner.
        near = run.events[before : before + 2]
        t = columns.t0 + columns.since[piece]
        x = columns.xs[piece]
        rounding = 10.0 ** (4 - digits)
        t_error = max([float(event.t_error) for event in near], default=0.0)
        x_error = max([float(event.x_error) for event in near], default=0.0)
        domain = f"Omega{law.rows[lower].domain}"
        steps.append(
            PassedCorner(
                CORNER,
                numbers[lower],
                domain,
                domain,
                t,
                x,
                t_error + rounding * max(1.0, abs(float(t))),
                x_error + rounding * max(1.0, abs(float(x))),
            )
        )
    return steps
