"""The recorded fields of an event: one schema for tables, files and the command line.

This file is executed with other globals: see symosc/kernels/rebind.py.

`Event` names the fields with their types, `event_numbers` and `event_codes` compute them. Nothing
else lists them.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

from symosc.base.aliases import Number
from symosc.engine.flow import belt_at
from symosc.engine.state import CROSS, GRAZE, ON_BELT, SLIP, STICK
from symosc.friction import ALL_MODE_NAMES, PAPER_BELTS

#: Kinds of events by code.
KIND_NAMES = {CROSS: "cross", STICK: "stick", SLIP: "slip", GRAZE: "graze"}


@dataclass(frozen=True, slots=True)
class Event:
    """A change of mode at a belt, or a graze.

    Attributes
    ----------
    t, x, v : number
        Time, position and velocity (that of the belt). Floats, or mpmath numbers from ``digits=``.
    theta : number
        Phase Omega t mod 2 pi, in [0, 2 pi).
    kind : str
        "cross", "stick" (onset), "slip" (end of a stick) or "graze".
    boundary : int
        The number of the belt: 1 (v = v1), 2 (v = v2) and so on.
    source, target : str
        "Omega1", "Omega2" and so on between the belts, "belt1", "belt2" and so on.
    t_error, x_error : float
        Estimated standard errors of t and x.

    Examples
    --------
    >>> from symosc import simulate
    >>> event = simulate("fig5").events[0]
    >>> f"{event.t:.6f}", event.kind, event.boundary, event.source, event.target
    ('0.122303', 'stick', 1, 'Omega1', 'belt1')
    """

    # A Number has the digits that are asked for, a float is a double always; an int and a name are
    # recorded as codes.
    t: Number
    x: Number
    v: Number
    theta: Number
    kind: str = field(metadata={"names": KIND_NAMES})
    boundary: int
    source: str = field(metadata={"names": ALL_MODE_NAMES})
    target: str = field(metadata={"names": ALL_MODE_NAMES})
    t_error: float
    x_error: float


def event_numbers(before, event, clock, K):
    """Return t, x, v, theta, t_error, x_error of an event, a NextEvent.

    `clock` is (t, t_error, x_error).
    """
    # From the state before the search, the NextEvent found, and (t, t_error, x_error) of
    # `time_with_errors`.
    state = event.state
    t, t_error, x_error = clock
    return t, state.x, state.v, state.theta, t_error, x_error


def event_codes(before, event, K):
    """Return kind, boundary, source and target of an event as codes, from the state before and the
    NextEvent found.
    """
    if not K.banded:
        return event.code, event.boundary, before.mode, event.state.mode
    source = mode_of_law(before.mode, K)
    target = mode_of_law(event.state.mode, K)
    return event.code, event.boundary + int(K.shift), source, target


def mode_of_law(mode, K):
    """Return the code that a mode of the row K has in the whole law (`symosc.friction`)."""
    shift = int(K.shift)
    if not K.banded:
        return mode
    if mode <= ON_BELT:
        domain = mode + shift
        if domain <= PAPER_BELTS + 1:
            return domain
        return 2 * domain - 2
    belt = mode - ON_BELT + shift
    if belt <= PAPER_BELTS:
        return PAPER_BELTS + 1 + belt
    return 2 * belt + 1


def belt_of_law(boundary, K):
    """Return the number in the whole law of the belt at a boundary of the row K; 0 for a corner, or
    for boundary 0.
    """
    if boundary == 0 or belt_at(boundary, K).is_corner:
        return 0
    return boundary + int(K.shift)


EVENT_COLUMNS = tuple(entry.name for entry in fields(Event))
#: Fields with the digits that are asked for, fields that are numbers, and fields that are codes.
EXACT_COLUMNS = tuple(entry.name for entry in fields(Event) if entry.type == "Number")
FLOAT_COLUMNS = tuple(entry.name for entry in fields(Event) if entry.type in ("Number", "float"))
CODE_COLUMNS = tuple(entry.name for entry in fields(Event) if entry.type in ("int", "str"))
#: Names by code of the fields that have some.
CODE_NAMES: dict[str, dict[int, str]] = {
    entry.name: entry.metadata["names"] for entry in fields(Event) if entry.metadata
}
#: Type of each field in a table of doubles.
COLUMN_TYPES = {
    entry.name: {"int": int, "str": str}.get(str(entry.type), float) for entry in fields(Event)
}


def events_from(rows: Any) -> list[Event]:
    """Return the events in an `EventRows` buffer as a list of `Event`."""
    columns = dict(
        zip(
            (*FLOAT_COLUMNS, *CODE_COLUMNS),
            (*rows.floats.tolist(), *rows.ints[1:].tolist()),
            strict=True,
        )
    )
    columns |= {name: [names[code] for code in columns[name]] for name, names in CODE_NAMES.items()}
    return list(map(Event, *(columns[name] for name in EVENT_COLUMNS)))
