"""The mappings P1 to P8: residuals f1, f2 (eq. (54)), their derivatives, and the next switching
point.

A map takes a switching point (x_i, theta_i) to the next one (x_j, theta_j), theta = Omega t. Phases
are *unwrapped*: the motion takes tau = (theta_j - theta_i)/Omega, so a return after a period and a
half has theta_j = theta_i + 3 pi. (Phases modulo 2 pi could not distinguish that from half a
period.) For a flight theta_j < theta_i is an error; the equations of a stick hold either way.
Adding 2 pi to both phases changes nothing.

    flight:  f1 = x(tau) - x_j,                  f2 = v(tau) - v_j
    stick:   f1 = x_i + v_lambda tau - x_j,      f2 = F^(alpha)(x_j, v_lambda, theta_j)

The maps differ by their row in `symosc.friction.MAPS` only. A stick ends where the force of the domain
below or that of the domain above vanishes: `exit` is "below", "above", or None for the one whose
|f2| is smaller at the given end.

Units are those of the parameters; f1 is a length, f2 a velocity (of a stick: an acceleration).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache, partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import Context, Number, Numbers
from symosc.base.arguments import POINT, REAL, TEXT, public, require, require_or_none
from symosc.base.errors import ParameterError, SymoscError
from symosc.base.phases import number_of
from symosc.engine import tangent
from symosc.engine.arithmetic import Arithmetic, MpArithmetic, column_functions, many_digits
from symosc.engine.first_exit import ROUNDING
from symosc.engine.flow import Constants, belt_at, constant_force, constants, drag
from symosc.engine.start import belt_start, belt_state, force_terms
from symosc.engine.state import (
    END,
    FAILED,
    GRAZE,
    MOVED,
    ON_BELT,
    REST,
    SLIP,
    Covariance,
    NextEvent,
)
from symosc.friction import MAPS, MODE_NAMES, NEIGHBOURS, Map
from symosc.kernels import mapping
from symosc.kernels.rebind import bind
from symosc.mappings.points import POINT_NAMES, is_array, point_columns, scalar
from symosc.model import PARAMETER_NAMES, Model, Parameters
from symosc.scenes import ParametersLike, parameters_for

EXITS = ("below", "above")
#: Points that are evaluated at once: the columns of a block stay in the cache of a core.
BLOCK = 16384
#: A switching point (x, theta), of numbers or of arrays that broadcast.
Pair: TypeAlias = "Sequence[Numbers | ArrayLike] | np.ndarray"


# --- residual and derivatives ---


@public
def residual(
    p: ParametersLike, label: str, start: Pair, end: Pair, exit: str | None = None
) -> tuple[Numbers, Numbers]:
    """Return (f1, f2) of a mapping between two switching points.

    Both vanish when the map leads from one to the other.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    label : str
        "P1" to "P8".
    start, end : pair
        (x_i, theta_i) and (x_j, theta_j), phases unwrapped: floats, arrays that broadcast, or
        mpmath numbers.
    exit : str, optional
        For a stick: the domain that it slips into, "below" or "above"; None: the one with the
        smaller |f2|.

    Returns
    -------
    (f1, f2)
        Of the kind that was given; mpmath numbers have the precision of their context.

    Raises
    ------
    ParameterError
        For an unknown map or exit, for numbers that are not finite, and for a flight with theta_j <
        theta_i.

    Examples
    --------
    >>> from symosc import load_scene, residual
    >>> f1, f2 = residual(load_scene("fig9").parameters, "P2", (4.5, 0.5), (-4, 4))
    >>> print(f"{f1:.6f} {f2:.6f}")
    -0.146366 1.642603
    """
    p = parameters_for(p, label=label)
    require(TEXT, label=label)
    require(POINT, start=start, end=end)
    require_or_none(TEXT, exit=exit)
    row, numbers, points, shape = read_points(p, label, start, end, exit)
    f1, f2 = _in_blocks(lambda block: _residual(row, numbers, block, exit), points, (2,), shape)
    return f1, f2


@public
def jacobian(
    p: ParametersLike, label: str, start: Pair, end: Pair, exit: str | None = None
) -> np.ndarray:
    """Return the derivatives of f1, f2 with respect to (x_i, theta_i, x_j, theta_j).

    Parameters and errors are those of `residual`.

    Returns
    -------
    array of shape (2, 4), or (2, 4) + the shape of arrays that were given
        Its entries are of the kind that was given (dtype object for mpmath numbers). Both exits of
        a stick have the same derivatives.

    Examples
    --------
    >>> from symosc import jacobian, load_scene
    >>> J = jacobian(load_scene("fig9").parameters, "P2", (4.5, 0.5), (-4, 4))
    >>> J.round(4).tolist()
    [[-0.0776, -0.5228, -1.0, 0.6607], [2.3223, -0.0394, 0.0, 22.5695]]
    """
    p = parameters_for(p, label=label)
    require(TEXT, label=label)
    require(POINT, start=start, end=end)
    require_or_none(TEXT, exit=exit)
    row, numbers, points, shape = read_points(p, label, start, end, exit)
    return np.asarray(
        _in_blocks(lambda block: _matrix(_jacobian(row, numbers, block)), points, (2, 4), shape)
    )


@public
def parameter_jacobian(
    p: ParametersLike, label: str, start: Pair, end: Pair, exit: str | None = None
) -> np.ndarray:
    """Return the derivatives of f1, f2 with respect to the parameters, at fixed x_i, theta_i, x_j
    and theta_j.

    The columns are those of `symosc.model.PARAMETER_NAMES`: m, c, k, A0, B0, Omega, v1, v2, mu1,
    mu2, FN. Arrays are done point by point (about 0.2 ms each). Parameters, shape and errors are
    those of `jacobian`.

    Examples
    --------
    >>> from symosc import load_scene, parameter_jacobian
    >>> J = parameter_jacobian(load_scene("fig9").parameters, "P2", (4.5, 0.5), (-4, 4))
    >>> J[:, 5].round(4).tolist()  # with respect to Omega
    [-0.7646, -9.5031]
    """
    p = parameters_for(p, label=label)
    require(TEXT, label=label)
    require(POINT, start=start, end=end)
    require_or_none(TEXT, exit=exit)
    row, numbers, points, shape = read_points(p, label, start, end, exit)
    if shape is None:
        return _matrix(_parameter_jacobian(p, row, numbers, points, exit))
    numbers = map_arithmetic(p)
    matrices = [
        _matrix(_parameter_jacobian(p, row, numbers, point, exit))
        for point in zip(*points, strict=True)
    ]
    return np.stack(matrices, axis=-1).reshape((2, 11, *shape))


class MapArithmetic(NamedTuple):
    """What maps need in one kind of numbers: constants `K`, kernel functions by name, and
    conversion from Fractions.
    """

    K: Constants
    of: dict[str, Any]
    number: Callable[[Fraction], Number]


def flight_arguments(row: Map, K: Constants) -> tuple[Number, Number, Number]:
    """Return the belt speeds at both ends of a flight, and the constant force A_alpha/m in its
    domain.
    """
    v_i, v_j = (belt_at(plane.boundary, K).v for plane in (row.start, row.end))
    return v_i, v_j, constant_force(row.domain, K)


def stick_arguments(
    row: Map, K: Constants, exit: str | None
) -> tuple[Number, tuple[Number, Number]]:
    """Return a stick's belt speed, and A_alpha/m of the domains below and above (both of `exit` if
    it is given).
    """
    below, above = (constant_force(domain, K) for domain in NEIGHBOURS[row.start.boundary])
    sides = {None: (below, above), "below": (below, below), "above": (above, above)}[exit]
    return belt_at(row.start.boundary, K).v, sides


def _residual(row: Map, numbers: MapArithmetic, points: Sequence[Numbers], exit: str | None) -> Any:
    """Return the residuals f1, f2 of a map for numbers or arrays x_i, theta_i, x_j, theta_j."""
    K = numbers.K
    if not row.sticks:
        return numbers.of["flight"](*points, *flight_arguments(row, K), K)
    v, sides = stick_arguments(row, K, exit)
    (f1, below), (_, above) = (numbers.of["stick"](*points, v, A, K) for A in sides)
    if exit is not None:  # they are one
        return f1, below
    nearer_below = abs(below) <= abs(above)
    if isinstance(nearer_below, np.ndarray):
        return f1, np.where(nearer_below, below, above)
    return f1, below if nearer_below else above


def _jacobian(row: Map, numbers: MapArithmetic, points: Sequence[Numbers]) -> Any:
    """Return the derivatives of f1 and f2 with respect to x_i, theta_i, x_j, theta_j, in two rows."""
    # In names such as x_th0 the first letter is the equation (x: f1, v: f2), then follows the
    # variable (x or th for theta) at the start (0) or the end (1).
    K = numbers.K
    (x_i, theta_i, _, theta_j) = points
    unit = 1 + 0 * x_i  # 1 and 0 of the kind and shape of x_i: float, array or mpmath number
    zero = 0 * x_i
    if row.sticks:
        v, _ = stick_arguments(row, K, None)
        x_th0, x_th1, v_x1, v_th1 = numbers.of["stick_slopes"](theta_j, v, K)
        return (unit, x_th0 * unit, -unit, x_th1 * unit), (zero, zero, v_x1 * unit, v_th1 * unit)
    v_i, _, A = flight_arguments(row, K)
    x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = numbers.of["flight_slopes"](
        x_i, theta_i, theta_j, v_i, A, K
    )
    return (x_x0, x_th0, -unit, x_th1), (v_x0, v_th0, zero, v_th1)


def _parameter_jacobian(
    p: Parameters, row: Map, numbers: MapArithmetic, points: Sequence[Numbers], exit: str | None
) -> Any:
    """Return the derivatives of f1 and f2 with respect to the parameters, in two rows."""
    K = numbers.K
    (x_i, theta_i, x_j, theta_j) = points
    m = numbers.number(p.m)
    zero = 0 * x_i
    domain = row.domain
    begin = f"v{row.start.boundary}"
    end = f"v{row.end.boundary}"
    if row.sticks:
        v_i, _ = stick_arguments(row, K, None)
        forces = [_residual(row, numbers, points, side)[1] for side in EXITS]
        below, above = forces
        if exit:
            i = EXITS.index(exit)
        else:  # the exit with the smaller force, as in `_residual`
            i = int(not abs(below) <= abs(above))
        domain = NEIGHBOURS[row.start.boundary][i]
        derivatives = numbers.of["stick_by_parameters"](x_j, theta_i, theta_j, v_i, forces[i], m, K)
        v_c, v_k, v_A, v_B, v_v0, v_m, x_Om, x_v0 = derivatives
        by_letter = [(zero, v_m), (zero, v_c), (zero, v_k), (zero, v_A), (zero, v_B), (x_Om, zero)]
    else:
        v_i, _, A = flight_arguments(row, K)
        *letters, x_v0, v_v0 = numbers.of["flight_by_parameters"](
            x_i, theta_i, theta_j, v_i, A, m, K
        )
        by_letter = list(zip(letters[::2], letters[1::2], strict=True))  # pairs (f1, f2)
    columns = dict(zip(("m", "c", "k", "A0", "B0", "Omega"), by_letter, strict=True))
    columns |= {"v1": (zero, zero), "v2": (zero, zero), begin: (x_v0, v_v0)}
    # Of a flight f2 = (v - v_i) + (v_i - v_j), whose last part vanishes if both are one belt.
    if end != begin:
        columns |= {begin: (x_v0, 1 + v_v0), end: (zero, zero - 1)}
    x_A, v_A = columns["A0"]
    drag1 = drag(1, domain)
    drag2 = drag(2, domain)
    (mu1, mu2, FN) = map(numbers.number, (p.mu1, p.mu2, p.FN))
    # Friction acts through A_alpha = A0 + FN (drag1 mu1 + drag2 mu2) alone: the chain rule.
    for name, weight in (
        ("mu1", drag1 * FN),
        ("mu2", drag2 * FN),
        ("FN", drag1 * mu1 + drag2 * mu2),
    ):
        columns[name] = x_A * weight, v_A * weight
    return tuple(tuple(columns[name][equation] for name in PARAMETER_NAMES) for equation in (0, 1))


# --- arithmetics ---


def map_arithmetic(p: Model, context: Context | None = None, row: int = 0) -> MapArithmetic:
    """Return constants and kernel functions for maps of single numbers: doubles, or numbers of an
    mpmath context.

    The constants are those of a row of the law (`symosc.friction.FrictionLaw.rows`).
    """
    if context is None:
        return _doubles(p, row=row)
    return _mp_numbers(p, context, context.prec, row)


@lru_cache(maxsize=128)
def _doubles(p: Model, arrays: bool = False, row: int = 0) -> MapArithmetic:
    """Return constants and kernel functions for maps in doubles, of single numbers or of numpy
    arrays.
    """
    if not arrays:
        K = constants(p, driven=True, row=row)
        return MapArithmetic(K, vars(mapping) | vars(tangent), float)
    names = {name: column_functions()[name] for name in ("sin", "cos", "basis")}
    return MapArithmetic(constants(p, driven=True), bind((mapping,), names), float)


@lru_cache(maxsize=64)
def _mp_numbers(p: Model, context: Context, precision: int, row: int = 0) -> MapArithmetic:
    """Return constants and kernel functions for maps of mpmath numbers with the context's
    `precision` in bits.
    """
    from symosc.kernels.multiprecision import BasisMP

    number = partial(number_of, context=context)
    K = constants(p, number, context.sqrt, context.atan2, +context.pi, driven=True, row=row)
    names = {
        "complex": context.mpc,
        "EPS": context.ldexp(1, -precision),
        "basis": BasisMP(context, p, row=row),
    }
    names |= {name: getattr(context, name) for name in ("exp", "sin", "cos", "floor")} | {
        "TWO_PI": 2 * context.pi
    }
    return MapArithmetic(K, bind((mapping, tangent), names), number)


# --- reading arguments ---

UNWRAPPED = "must be >= theta_i: give unwrapped phases, the flight takes (theta_j - theta_i)/Omega"


def read_points(
    p: Parameters, label: str, start: Pair, end: Pair, exit: str | None = None
) -> tuple[Map, MapArithmetic, list[Any], tuple[int, ...] | None]:
    """Check the arguments of a map.

    Return its entry in `MAPS`, the arithmetic, the points, and the shape of arrays.

    The points are four numbers or four flat arrays. The shape is the one that the arrays had, None
    for numbers.
    """
    if label not in MAPS:
        raise ParameterError("label", label, f"must be one of {', '.join(MAPS)}")
    row = MAPS[label]
    if exit is not None and not (row.sticks and exit in EXITS):
        if row.sticks:
            allowed = 'must be "below", "above" or None'
        else:
            allowed = f"must be None: {label} is a flight"
        raise ParameterError("exit", exit, allowed)
    coordinates = [*start, *end]
    shape = None
    points = list[Any]()
    context = next(
        (
            value.context
            for value in coordinates
            if hasattr(value, "_mpf_") and hasattr(value, "context")
        ),
        None,
    )
    if context is None and any(is_array(value) for value in coordinates):
        numbers: MapArithmetic = _doubles(p, arrays=True)
        columns = point_columns(coordinates)
        shape = columns[0].shape
        points = [column.ravel() for column in columns]
    else:
        numbers = map_arithmetic(p, context)
        if context is None:
            convert = float
        else:
            convert = context.convert
        points = [
            scalar(name, value, convert)
            for name, value in zip(POINT_NAMES, coordinates, strict=True)
        ]
    if not row.sticks and np.any(points[3] < points[1]):
        raise ParameterError("theta_j", end[1], UNWRAPPED)
    return row, numbers, points, shape


def _in_blocks(
    evaluate: Any, points: list[Any], head: tuple[int, ...], shape: tuple[int, ...] | None
) -> Any:
    """Return evaluate(points).

    Do arrays in small blocks, and return these with the shape `head` + `shape`.
    """
    if shape is None:
        return evaluate(points)
    results = np.empty((*head, len(points[0])))
    for begin in range(0, len(points[0]), BLOCK):
        block = slice(begin, begin + BLOCK)
        results[..., block] = evaluate([column[block] for column in points])
    return results.reshape((*head, *shape))


def _matrix(rows: Any) -> np.ndarray:
    """Return rows of numbers as an array of floats, or of mpmath numbers."""
    first_entry = rows[0][0]  # all are of one kind
    return np.array(rows, dtype=object if hasattr(first_entry, "_mpf_") else float)


# --- the next switching point ---

MOST_MAP_PERIODS = 1000  # for which a flight is followed
SPARE_DIGITS = 10  # of the search, beyond those of the numbers that are given


class MapError(SymoscError, ValueError):
    """Raised if the motion from a point does not follow the mapping.

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

    def __init__(
        self, label: str, x: Number, theta: Number, reason: str, actual: str | None = None
    ) -> None:
        self.label = label
        self.x = x
        self.theta = theta
        self.reason = reason
        self.actual = actual
        super().__init__(f"{label} from x = {float(x)!r}, theta = {float(theta)!r}: {reason}")


@dataclass(frozen=True, slots=True)
class MapPoint:
    """The switching point at the end of a map.

    Attributes
    ----------
    label : str
    x, theta : number
        Position and unwrapped phase Omega t, greater than that of the start.
    exit : str or None
        "below" or "above" for a stick.
    grazing : bool
        Whether a flight only touches the belt there (as far as this precision can decide).
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
    # It follows from the rest, and arrays have no single ==.
    derivative: np.ndarray | None = field(compare=False)


@public
def solve_map(p: ParametersLike, label: str, x_i: Number, theta_i: Number) -> MapPoint:
    """Follow a mapping from a switching point to the next one, by the event search that simulations
    use.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    label : str
        "P1" to "P8".
    x_i, theta_i : number
        The start: position and phase Omega t (any multiple of 2 pi may be added). Floats or mpmath
        numbers.

    Raises
    ------
    MapError
        If the motion from there does not follow the map (it says where it goes), comes to no belt
        within 1000 periods, or cannot be followed in this precision.

    Examples
    --------
    >>> from symosc import load_scene, solve_map
    >>> point = solve_map(load_scene("fig9").parameters, "P2", 4.5, 0.5)
    >>> f"{point.x:.6f}", f"{point.theta:.6f}"
    ('-4.179569', '3.927047')
    """
    p = parameters_for(p, label=label)
    require(TEXT, label=label)
    require(REAL, x_i=x_i, theta_i=theta_i)
    row, _, points, shape = read_points(p, label, (x_i, theta_i), (x_i, theta_i))
    if shape is not None:
        raise ParameterError("x_i", x_i, "must be a number; maps are solved one by one")
    x, theta = points[:2]
    context = getattr(x, "context", None)
    if context:
        digits = context.dps + SPARE_DIGITS
        convert = context.convert
    else:
        digits = None
        convert = float
    arithmetic = _search_arithmetic(p, digits)
    if isinstance(arithmetic, MpArithmetic):
        inner = arithmetic.context.convert
    else:
        inner = float
    event, gain = _next_event(row, arithmetic, inner(x), inner(theta))
    boundary = event.boundary
    end = event.state
    grazing = event.code == GRAZE
    # The map that the motion does follow: it starts alike, and ends on this belt.
    same_start = (
        candidate
        for candidate in MAPS.values()
        if (candidate.start, candidate.mode) == (row.start, row.mode)
    )
    actual = next(candidate.label for candidate in same_start if candidate.end.boundary == boundary)
    if actual != label:
        raise MapError(
            label, x, theta, f"the motion ends on belt {boundary}: that is {actual}", actual
        )
    if event.code == SLIP:
        exit = EXITS[end.mode - boundary]
    else:
        exit = None
    x_j = convert(end.x)
    theta_j = theta + convert(gain)
    if grazing:
        derivative = None
    else:
        derivative = _end_by_start(jacobian(p, label, (x, theta), (x_j, theta_j)))
    return MapPoint(label, x_j, theta_j, exit, grazing, derivative)


def _end_by_start(J: np.ndarray) -> np.ndarray | None:
    """Return the derivatives of a map's end by its start, from the Jacobian of f1 and f2; None where
    the end does not move smoothly.
    """
    # Implicit function theorem: minus the inverse of the block of the end, times that of the start,
    # by Cramer's rule.
    by_start_1, by_start_2 = J[:, :2]
    ((x_x1, x_th1), (v_x1, v_th1)) = J[:, 2:]
    determinant = x_x1 * v_th1 - x_th1 * v_x1
    if determinant == 0:
        return None
    rows = x_th1 * by_start_2 - v_th1 * by_start_1, v_x1 * by_start_1 - x_x1 * by_start_2
    return np.array(rows) / determinant


@lru_cache(maxsize=64)
def _search_arithmetic(p: Parameters, digits: int | None) -> Arithmetic:
    """Return the arithmetic in which to search events: with so many decimal `digits` or, for None,
    in doubles.
    """
    if digits:
        return many_digits(p, digits)
    return Arithmetic(p)


def _next_event(
    row: Map, arithmetic: Arithmetic, x: Number, theta: Number
) -> tuple[NextEvent, Number]:
    """Return the next event and the phase until it.

    MapError if the motion does not start in the map's mode.
    """
    K = arithmetic.K
    names = arithmetic.namespace
    belt = row.start.boundary
    two_pi = names["TWO_PI"]
    eps = names["EPS"]
    turns = int(theta / two_pi) - (theta < 0)  # int rounds to 0
    # 2 pi as a number of this arithmetic and what that lacks.
    phase = (theta - turns * two_pi) - turns * names["TWO_PI_REST"]
    # After a stick one force is 0, up to the rounding errors of its end.
    allowed = ROUNDING * eps * (force_terms(belt, x, K) + abs(K.f0 * theta))
    sine_and_cosine = names["sine_and_cosine"](phase, 0 * phase)
    start = belt_start(belt, x, sine_and_cosine, arithmetic, allowed)
    if start.mode != row.mode:
        if start.mode > ON_BELT:
            goes = "stays on"
        else:
            goes = "goes into"
        low, high = NEIGHBOURS[belt]
        forces = f"F^({low}) = {float(start.below):.6g}, F^({high}) = {float(start.above):.6g}"
        raise MapError(
            row.label, x, theta, f"the motion {goes} {MODE_NAMES[start.mode]} there, since {forces}"
        )
    error = Covariance((eps * x) ** 2, 0 * x, 0 * x)
    horizon = MOST_MAP_PERIODS * (K.period if K.driven else two_pi / K.beat)
    state = belt_state(start, (0, phase), sine_and_cosine, x, error, K)
    event = arithmetic.advance(state, horizon, 0 * horizon)
    while event.code == MOVED:
        event = arithmetic.advance(event.state, horizon, 0 * horizon)
    if event.code in (END, REST):
        if event.code == END:
            when = f"within {MOST_MAP_PERIODS} periods"
        else:
            when = "ever"
        raise MapError(row.label, x, theta, f"the motion comes to no switching {when}")
    if event.code == FAILED:
        raise MapError(
            row.label,
            x,
            theta,
            "the next contact cannot be found in this precision; give mpmath numbers",
        )
    return event, event.state.n * two_pi + (event.state.theta - phase)
