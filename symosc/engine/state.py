"""The engine's codes for modes and events, and its named tuples for states and search results.

This file is executed with other globals: see symosc/kernels/rebind.py.

Codes are plain integers and states are NamedTuples of numbers, whole numbers and flags, because
numba compiles both into registers; so they serve floats, pairs and mpmath numbers alike.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Iterator
from operator import attrgetter, itemgetter
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Number

# Modes are those of `symosc.friction.MODE_NAMES`: 1, 2, 3 a domain, ON_BELT + 1 and ON_BELT + 2 a
# stick on belt 1 and 2.
ON_BELT = 3
# Where a law has a row of constants for each band, a motion is in the middle domain of its row, and
# its modes are those of the paper, counted from there; `symosc.engine.events.mode_of_law` translates.
MIDDLE = 2
# What a step ends with; the first four are the kinds of events.
CROSS = 1
STICK = 2
SLIP = 3
GRAZE = 4
MOVED = 5
END = 6
REST = 7
FAILED = 8
# What a search along a flight or a stick ends with. STALLED: it is not sure; a step whose search
# ends so is FAILED, and more digits follow. LOST: the gap is, and stays, 0 within its error.
NOTHING = 0
HIT = 1
TANGENCY = 2
STALLED = 3
LOST = 4
# Where a motion goes from a point of a belt.
DOMAIN_BELOW = -1
DOMAIN_ABOVE = 1
BELT = 0
# What a trajectory of a batch ended with, beside the codes of a step. FULL: it has as many events
# as are wanted. UNDECIDED, INEXACT: its next event is to be found with more digits.
RUNNING = 0
FULL = -1
UNDECIDED = -2
INEXACT = -3
NEEDS_DIGITS = (UNDECIDED, INEXACT)


class Covariance(NamedTuple):
    """The covariance matrix (S11, S12, S22) of the errors of x and v at a fixed time."""

    S11: Number
    S12: Number
    S22: Number


class State(NamedTuple):
    """The state of a motion at an event or between events: mode, phase, x, v, accelerations, error
    and time.
    """

    # Phase and time are both carried, each in two parts: Omega t loses no digits however large t
    # becomes, and t none however slow the drive is. Sine and cosine of the phase come from the
    # search, and anew from theta in each forcing period, so that their rounding errors do not add
    # up.

    mode: int
    # 1, 2 if the state is on that belt at the beginning of a flight or during a stick, else 0
    at: int
    n: int  # forcing periods completed
    theta: Number  # Omega t mod 2 pi
    x: Number
    v: Number
    Fb: Number  # acceleration; on a belt F^(below) and F^(above), the accelerations of both sides
    Fa: Number
    S: Covariance
    t: Number  # time, in two parts whose sum is right to far below an ulp
    t_low: Number
    s: Number  # sine and cosine of theta
    c: Number
    theta_low: Number  # what rounding took from theta


class Followed(NamedTuple):
    """A motion that is being followed: its state, the end time in two parts, and t0.

    Tables of motions have these numbers in a row for each (`STATE_ROW`).
    """

    state: State
    t_end: Number
    t_end_low: Number
    t0: Number


class Row(np.void):  # type: ignore[misc]  # numpy's stubs call its base final; it is not
    """A row of a table of motions: interpreted code reads and writes its numbers as attributes, as
    compiled code does.
    """

    __slots__ = ()

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value


def names_of_numbers(kind: Any, nested: dict[str, Any]) -> Iterator[str]:
    """Yield the fields of a NamedTuple in order, in place of each one in `nested` those of that
    type.
    """
    for name in kind._fields:
        if name in nested:
            yield from names_of_numbers(nested[name], nested)
        else:
            yield name


TUPLES_IN_FOLLOWED = {"state": State, "S": Covariance}
NUMBERS_OF_STATE = tuple(names_of_numbers(State, TUPLES_IN_FOLLOWED))
NUMBERS_OF_FOLLOWED = tuple(names_of_numbers(Followed, TUPLES_IN_FOLLOWED))
# Properties, as `__getattr__` is called only after numpy has looked for an attribute in vain, which
# takes ten times as long.
for _name in NUMBERS_OF_FOLLOWED:
    setattr(Row, _name, property(itemgetter(_name)))
#: The numbers of a State as a tuple, by one call, and the numbers of a row as a named tuple.
numbers_of_state = attrgetter(
    *(f"S.{name}" if name in Covariance._fields else name for name in NUMBERS_OF_STATE)
)
RowNumbers: Any = namedtuple("RowNumbers", NUMBERS_OF_FOLLOWED)  # type: ignore[misc]
#: The row of a table of motions in doubles, and in pairs, stored as complex numbers hi + i lo.
STATE_ROW = np.dtype((Row, [(name, np.float64) for name in NUMBERS_OF_FOLLOWED]))
PAIR_ROW = np.dtype((Row, [(name, np.complex128) for name in NUMBERS_OF_FOLLOWED]))


class NextEvent(NamedTuple):
    """The result of one step: code (event, END, REST: none to come, MOVED: none yet, FAILED), belt
    or 0, new state.
    """

    code: int
    boundary: int
    decided: bool  # False where the outcome depends on less than the rounding error
    t_error: Number  # standard error of the event's time
    state: State


class Launch(NamedTuple):
    """The start of a flight: velocity v, acceleration F, and sine s and cosine c of the phase."""

    v: Number
    F: Number
    s: Number
    c: Number


class Flown(NamedTuple):
    """A point of a flight at `tau` after its launch: gains of x and v, derivatives of v, phase, and
    E0, E1, E2.
    """

    tau: Number
    dx: Number  # what x and v have gained
    dv: Number
    F: Number  # first to fourth derivative of v
    G1: Number
    G2: Number
    G3: Number
    s: Number  # sine and cosine of the phase
    c: Number
    E0: Number  # the entire functions of `symosc.kernels.entire`, which carry errors
    E1: Number
    E2: Number


class Walls(NamedTuple):
    """The gaps from a flight to the belts around its domain, at its launch."""

    below: Number  # v minus the lower belt's speed; exact 0 at a launch from it
    above: Number  # the upper belt's speed minus v
    has_below: bool
    has_above: bool
    on_below: bool  # whether the launch is on that belt
    on_above: bool


class FlightEnd(NamedTuple):
    """The result of a search along a flight: code (NOTHING, HIT, TANGENCY, STALLED), side of the
    wall, point.
    """

    code: int
    side: int
    now: Flown


class StickEnd(NamedTuple):
    """The result of a search along a stick: code (NOTHING, HIT, TANGENCY, STALLED), side of the
    slip, and time.
    """

    code: int
    side: int
    tau: Number
    Delta: Number  # what both forces have gained, and its first two derivatives
    slope: Number
    bend: Number
    s: Number  # sine and cosine of the phase, where its code is HIT
    c: Number
