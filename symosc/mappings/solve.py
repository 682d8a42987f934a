"""From a switching point to the next one along a mapping, by the engine's event search; and its derivative."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from symosc.aliases import Number
from symosc.arguments import public
from symosc.engine.arithmetic import Arithmetic, MpArithmetic, many_digits
from symosc.engine.first_exit import ROUNDING
from symosc.engine.start import BeltStart, belt_start, belt_state, force_terms, sine_and_cosine
from symosc.engine.state import END, FAILED, GRAZE, MOVED, ON_BELT, REST, SLIP, Covariance, NextEvent, State
from symosc.errors import ParameterError, SymoscError
from symosc.mappings.equations import EXITS, jacobian, read_points
from symosc.model import MODE_NAMES, NEIGHBOURS, Parameters
from symosc.words import MAPS, Map

# A flight is followed for this many forcing periods.
MOST_MAP_PERIODS = 1000
MAP_GUARD_DIGITS = 10


class MapError(SymoscError, ValueError):
    """A mapping that the motion does not follow from the given point.

    Attributes
    ----------
    label : str
    x, theta : number
        The start.
    actual : str or None
        The mapping that the motion does follow, where that is known.

    Examples
    --------
    >>> from symosc import MapError, load_scene, solve_map
    >>> try:
    ...     solve_map(load_scene("fig5").parameters, "P8", -9, 6)
    ... except MapError as error:
    ...     print(error.actual)
    P3
    """

    def __init__(self, label: str, x: Number, theta: Number, reason: str, actual: str | None = None) -> None:
        self.label, self.x, self.theta, self.reason, self.actual = label, x, theta, reason, actual
        super().__init__(f"{label} from x = {float(x)!r}, theta = {float(theta)!r}: {reason}")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.label, self.x, self.theta, self.reason, self.actual)


@dataclass(frozen=True, slots=True)
class MapPoint:
    """The switching point that a map leads to.

    Attributes
    ----------
    label : str
    x, theta : number
        Position and unwrapped phase Omega t, greater than that of the start.
    exit : str or None
        "below" or "above" for a stick.
    grazing : bool
        Whether a flight only touches the belt there (as far as this precision tells).
    derivative : array of shape (2, 2) or None
        d(x, theta)/d(x_i, theta_i). None at a graze: the end does not move smoothly there.

    Examples
    --------
    >>> from symosc import load_scene, solve_map
    >>> point = solve_map(load_scene("fig9").parameters, "P2", 4.5, 0.5)
    >>> point.grazing, point.derivative.round(4).tolist()
    (False, [[-0.1465, -0.5158], [-0.1049, 0.0148]])
    """

    label: str
    x: Number
    theta: Number
    exit: str | None
    grazing: bool
    derivative: np.ndarray | None = field(compare=False)  # follows from the rest; arrays have no single ==


@public
def solve_map(p: Parameters, label: str, x_i: Number, theta_i: Number) -> MapPoint:
    """Follow a mapping from a switching point to the next one, by the event search that simulations use.

    Parameters
    ----------
    p : Parameters
    label : str
        "P1" to "P8".
    x_i, theta_i : number
        The start: position and phase Omega t (any multiple of 2 pi may be added). Floats or mpmath numbers.

    Returns
    -------
    MapPoint

    Raises
    ------
    MapError
        If the motion from there does not follow the map (it says where it goes), comes to no belt within 1000 periods,
        or cannot be followed in this precision.

    Examples
    --------
    >>> from symosc import load_scene, solve_map
    >>> point = solve_map(load_scene("fig9").parameters, "P2", 4.5, 0.5)
    >>> f"{point.x:.6f}", f"{point.theta:.6f}"
    ('-4.179569', '3.927047')
    """
    row, _, points, shape = read_points(p, label, (x_i, theta_i), (x_i, theta_i))
    if shape is not None:
        raise ParameterError("x_i", x_i, "must be a number; maps are solved one by one")
    x, theta = points[:2]
    context = getattr(x, "context", None)
    arithmetic = _engine(p, context.dps + MAP_GUARD_DIGITS if context else None)
    convert = context.convert if context else float
    inner = arithmetic.context.convert if isinstance(arithmetic, MpArithmetic) else float
    event, gain = _next_event(row, arithmetic, inner(x), inner(theta))
    code, boundary, end = event.code, event.boundary, event.state
    begun = (other for other in MAPS.values() if (other.start, other.mode) == (row.start, row.mode))
    actual = next(other.label for other in begun if other.end.boundary == boundary)
    if actual != label:
        raise MapError(label, x, theta, f"the motion ends on belt {boundary}: that is {actual}", actual)
    exit = EXITS[end.mode - boundary] if code == SLIP else None
    x_j, theta_j = convert(end.x), theta + convert(gain)
    derivative = None
    if code != GRAZE:
        derivative = _solved(jacobian(p, label, (x, theta), (x_j, theta_j)))
    return MapPoint(label, x_j, theta_j, exit, code == GRAZE, derivative)


@lru_cache(maxsize=64)
def _engine(p: Parameters, digits: int | None) -> Arithmetic:
    return many_digits(p, digits) if digits else Arithmetic(p)


def _next_event(row: Map, arithmetic: Arithmetic, x: Number, theta: Number) -> tuple[NextEvent, Number]:
    """Return the next event, and its phase since the start."""
    K, names = arithmetic.K, arithmetic.namespace
    two_pi, rest, eps = names["TWO_PI"], names["TWO_PI_REST"], names["EPS"]
    turns = int(theta / two_pi) - (theta < 0)
    phase = (theta - turns * two_pi) - turns * rest
    begun = _begun(row, arithmetic, x, theta, phase)
    S = Covariance((eps * x) ** 2, 0 * x, 0 * x)
    state = belt_state(begun, (0, phase), sine_and_cosine(phase, arithmetic), x, S, K)
    event = _followed(state, arithmetic)
    if event.code in (END, REST):
        many = f"within {MOST_MAP_PERIODS} periods" if event.code == END else "ever"
        raise MapError(row.label, x, theta, f"the motion comes to no switching {many}")
    if event.code == FAILED:
        raise MapError(row.label, x, theta, "the next contact cannot be found in this precision; give mpmath numbers")
    return event, event.state.n * two_pi + (event.state.theta - phase)


def _begun(row: Map, arithmetic: Arithmetic, x: Number, theta: Number, phase: Number) -> BeltStart:
    """Return how the motion starts; MapError if that is not as the map does."""
    K, names, boundary = arithmetic.K, arithmetic.namespace, row.start.boundary
    # After a stick one force is 0, which its rounded end shows only to so much.
    allowed = ROUNDING * names["EPS"] * (force_terms(boundary, x, K) + abs(K.f0 * theta))
    begun = belt_start(boundary, x, (names["sin"](phase), names["cos"](phase)), arithmetic, allowed)
    if begun.mode != row.mode:
        goes = "stays on" if begun.mode > ON_BELT else "goes into"
        low, high = NEIGHBOURS[boundary]
        numbers = f"F^({low}) = {float(begun.below):.6g}, F^({high}) = {float(begun.above):.6g}"
        raise MapError(row.label, x, theta, f"the motion {goes} {MODE_NAMES[begun.mode]} there, since {numbers}")
    return begun


def _followed(state: State, arithmetic: Arithmetic) -> NextEvent:
    """Return the next event after a state."""
    advance, horizon = arithmetic.advance, MOST_MAP_PERIODS * arithmetic.K.period
    own, until = arithmetic.inward(state), arithmetic.inward((horizon, 0 * horizon))
    K = arithmetic.inner_K
    before = arithmetic.enter()
    try:
        event = advance(own, *until, K)
        while event.code == MOVED:
            event = advance(event.state, *until, K)
        return arithmetic.outward(event)
    finally:
        arithmetic.leave(before)


def _solved(J: np.ndarray) -> np.ndarray | None:
    """Return d(x_j, theta_j)/d(x_i, theta_i) = -(df/d end)^-1 df/d start; None if that does not exist."""
    (x_x0, x_th0, x_x1, x_th1), (v_x0, v_th0, v_x1, v_th1) = J
    determinant = x_x1 * v_th1 - x_th1 * v_x1
    if determinant == 0:
        return None
    return np.array(
        [
            [(x_th1 * v_x0 - v_th1 * x_x0) / determinant, (x_th1 * v_th0 - v_th1 * x_th0) / determinant],
            [(v_x1 * x_x0 - x_x1 * v_x0) / determinant, (v_x1 * x_th0 - x_x1 * v_th0) / determinant],
        ]
    )
