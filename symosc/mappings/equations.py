"""The mappings P1 to P8: residuals f1, f2 (eq. (54)) and their derivatives.

A map takes a switching point (x_i, theta_i) to the next one (x_j, theta_j), theta = Omega t. Phases are *unwrapped*:
the motion takes tau = (theta_j - theta_i)/Omega, so a return after a period and a half has theta_j = theta_i + 3 pi.
(Phases modulo 2 pi could not tell that from half a period.) For a flight theta_j < theta_i is an error; the equations
of a stick hold either way. Adding 2 pi to both phases changes nothing.

    flight:  f1 = x(tau) - x_j,                  f2 = v(tau) - v_j
    stick:   f1 = x_i + v_lambda tau - x_j,      f2 = F^(alpha)(x_j, v_lambda, theta_j)

The maps differ by their row in `symosc.words.MAPS` only. A stick ends where the force of the domain below or that of
the domain above vanishes: `exit` is "below", "above", or None for the one whose |f2| is smaller at the given end.

Units are those of the parameters; f1 is a length, f2 a velocity (of a stick: an acceleration).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import Context, Number, Numbers
from symosc.arguments import public
from symosc.engine.arithmetic import bind
from symosc.engine.flow import BeltConstants, Constants, constants
from symosc.errors import ParameterError
from symosc.kernels import entire_array, mapping
from symosc.mappings.arguments import POINT_NAMES, columns_of, is_array, is_mp, scalar
from symosc.model import NEIGHBOURS, PARAMETER_NAMES, Parameters
from symosc.words import MAPS, Map

EXITS = ("below", "above")
#: A switching point (x, theta), of numbers or of arrays that broadcast.
Pair: TypeAlias = "Sequence[Numbers | ArrayLike] | np.ndarray"
# Arrays are evaluated in blocks of this many points: the temporaries then stay in the cache.
ARRAY_BLOCK = 16384


# --- residual and derivatives ---


@public
def residual(p: Parameters, label: str, start: Pair, end: Pair, exit: str | None = None) -> tuple[Numbers, Numbers]:
    """Return (f1, f2) of a mapping between two switching points; both vanish when the map leads from one to the other.

    Parameters
    ----------
    p : Parameters
    label : str
        "P1" to "P8".
    start, end : pair
        (x_i, theta_i) and (x_j, theta_j), phases unwrapped: floats, arrays that broadcast, or mpmath numbers.
    exit : str, optional
        For a stick: the domain that it slips into, "below" or "above"; None: the one with the smaller |f2|.

    Returns
    -------
    (f1, f2)
        Of the kind that was given; mpmath numbers have the precision of their context.

    Raises
    ------
    ParameterError
        For an unknown map or exit, for numbers that are not finite, and for a flight with theta_j < theta_i.

    Examples
    --------
    >>> from symosc import load_scene, residual
    >>> f1, f2 = residual(load_scene("fig9").parameters, "P2", (4.5, 0.5), (-4, 4))
    >>> print(f"{f1:.6f} {f2:.6f}")
    -0.146366 1.642603
    """
    row, numbers, points, shape = read_points(p, label, start, end, exit)
    if shape is None:
        return _residual(row, numbers, points, exit)
    found = _in_blocks(lambda block: np.stack(_residual(row, numbers, block, exit)), points, (2,))
    return found[0].reshape(shape), found[1].reshape(shape)


@public
def jacobian(p: Parameters, label: str, start: Pair, end: Pair, exit: str | None = None) -> np.ndarray:
    """Return the derivatives of f1, f2 with respect to (x_i, theta_i, x_j, theta_j).

    Parameters and errors are those of `residual`.

    Returns
    -------
    array of shape (2, 4), or (2, 4) + the shape of arrays that were given
        Its entries are of the kind that was given (dtype object for mpmath numbers). Both exits of a stick have the
        same derivatives.

    Examples
    --------
    >>> from symosc import jacobian, load_scene
    >>> J = jacobian(load_scene("fig9").parameters, "P2", (4.5, 0.5), (-4, 4))
    >>> J.round(4).tolist()
    [[-0.0776, -0.5228, -1.0, 0.6607], [2.3223, -0.0394, 0.0, 22.5695]]
    """
    row, numbers, points, shape = read_points(p, label, start, end, exit)
    if shape is None:
        return _matrix(_jacobian(row, numbers, points))
    return _in_blocks(lambda block: _matrix(_jacobian(row, numbers, block)), points, (2, 4)).reshape((2, 4, *shape))


@public
def parameter_jacobian(p: Parameters, label: str, start: Pair, end: Pair, exit: str | None = None) -> np.ndarray:
    """Return the derivatives of f1, f2 with respect to the parameters, at fixed x_i, theta_i, x_j and theta_j.

    The columns are those of `symosc.model.PARAMETER_NAMES`: m, c, k, A0, B0, Omega, v1, v2, mu1, mu2, FN. Arrays
    are done point by point (about 0.2 ms each). Parameters, shape and errors are those of `jacobian`.

    Examples
    --------
    >>> from symosc import load_scene, parameter_jacobian
    >>> J = parameter_jacobian(load_scene("fig9").parameters, "P2", (4.5, 0.5), (-4, 4))
    >>> J[:, 5].round(4).tolist()  # with respect to Omega
    [-0.7646, -9.5031]
    """
    row, numbers, points, shape = read_points(p, label, start, end, exit)
    if shape is None:
        return _matrix(_parameter_jacobian(p, row, numbers, points, exit))
    numbers = _floats(p)
    found = [_matrix(_parameter_jacobian(p, row, numbers, point, exit)) for point in zip(*points, strict=True)]
    return np.stack(found, axis=-1).reshape((2, 11, *shape))


class MapArithmetic(NamedTuple):
    """What evaluates a map in one arithmetic: the functions of `symosc.kernels.mapping`, and what they need."""

    K: Constants
    of: dict[str, Any]
    number: Callable[[Fraction], Number]


def _residual(row: Map, numbers: MapArithmetic, points: Sequence[Numbers], exit: str | None) -> Any:
    K, (x_i, theta_i, x_j, theta_j) = numbers.K, points
    A = (K.A1, K.A2, K.A3)
    v_i, v_j = _belt(K, row.start.boundary).v, _belt(K, row.end.boundary).v
    if not row.sticks:
        return numbers.of["flight"](x_i, theta_i, x_j, theta_j, v_i, v_j, A[row.domain - 1], K)
    beside = (A[domain - 1] for domain in NEIGHBOURS[row.start.boundary])
    (f1, below), (_, above) = (numbers.of["stick"](x_i, theta_i, x_j, theta_j, v_i, A, K) for A in beside)
    return f1, _chosen(exit, below, above, below, above)


def _jacobian(row: Map, numbers: MapArithmetic, points: Sequence[Numbers]) -> Any:
    K, (x_i, theta_i, _, theta_j) = numbers.K, points
    v_i, one, zero = _belt(K, row.start.boundary).v, 1 + 0 * x_i, 0 * x_i
    if row.sticks:
        x_th0, x_th1, v_x1, v_th1 = numbers.of["stick_slopes"](theta_j, v_i, K)
        return (one, x_th0 * one, -one, x_th1 * one), (zero, zero, v_x1 * one, v_th1 * one)
    A = (K.A1, K.A2, K.A3)[row.domain - 1]
    x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = numbers.of["flight_slopes"](x_i, theta_i, theta_j, v_i, A, K)
    return (x_x0, x_th0, -one, x_th1), (v_x0, v_th0, zero, v_th1)


def _parameter_jacobian(
    p: Parameters, row: Map, numbers: MapArithmetic, points: Sequence[Numbers], exit: str | None
) -> Any:
    K, (x_i, theta_i, x_j, theta_j) = numbers.K, points
    v_i, m, zero, domain = _belt(K, row.start.boundary).v, numbers.number(p.m), 0 * x_i, row.domain
    if row.sticks:
        below, above = (_residual(row, numbers, points, way)[1] for way in EXITS)
        domain = _chosen(exit, below, above, *NEIGHBOURS[row.start.boundary])
        F = _chosen(exit, below, above, below, above)
        found = numbers.of["stick_by_parameters"](x_j, theta_i, theta_j, v_i, F, m, K)
        v_c, v_k, v_A, v_B, v_v0, v_m, x_Om, x_v0 = found
        by_letter = [(zero, v_m), (zero, v_c), (zero, v_k), (zero, v_A), (zero, v_B), (x_Om, zero)]
    else:
        A = (K.A1, K.A2, K.A3)[domain - 1]
        found = numbers.of["flight_by_parameters"](x_i, theta_i, theta_j, v_i, A, m, K)
        *letters, x_v0, v_v0 = found
        by_letter = list(zip(letters[::2], letters[1::2], strict=True))
    columns = dict(zip(("m", "c", "k", "A0", "B0", "Omega"), by_letter, strict=True))
    columns |= {"v1": (zero, zero), "v2": (zero, zero)}
    begin, end = f"v{row.start.boundary}", f"v{row.end.boundary}"
    columns[begin] = x_v0, v_v0
    if end != begin:  # f2 = (v - v_i) + (v_i - v_j), whose last part vanishes when it is one belt
        columns[begin], columns[end] = (x_v0, 1 + v_v0), (zero, zero - 1)
    x_A, v_A = columns["A0"]
    drag1, drag2 = {1: (1, 1), 2: (-1, 1), 3: (-1, -1)}[domain]
    mu1, mu2, FN = (numbers.number(value) for value in (p.mu1, p.mu2, p.FN))
    for name, weight in (("mu1", drag1 * FN), ("mu2", drag2 * FN), ("FN", drag1 * mu1 + drag2 * mu2)):
        columns[name] = x_A * weight, v_A * weight
    return tuple(tuple(columns[name][equation] for name in PARAMETER_NAMES) for equation in (0, 1))


def _chosen(exit: str | None, force_below: Numbers, force_above: Numbers, below: Any, above: Any) -> Any:
    """Return `below` or `above`: what `exit` says, or what belongs to the smaller force."""
    if exit is not None:
        return below if exit == "below" else above
    nearer_below = abs(force_below) <= abs(force_above)
    if isinstance(nearer_below, np.ndarray):
        return np.where(nearer_below, below, above)
    return below if nearer_below else above


# --- arithmetics ---


@lru_cache(maxsize=64)
def _floats(p: Parameters) -> MapArithmetic:
    return MapArithmetic(constants(p), vars(mapping), float)


@lru_cache(maxsize=64)
def _arrays(p: Parameters) -> MapArithmetic:
    names = {"sin": np.sin, "cos": np.cos, "basis": entire_array.basis}
    return MapArithmetic(constants(p), bind((mapping,), names), float)


@lru_cache(maxsize=16)
def _mp_numbers(p: Parameters, context: Context, precision: int) -> MapArithmetic:
    """Return the arithmetic of an mpmath context; `precision` is its precision, which the cache needs as a key."""
    from symosc.kernels.multiprecision import BasisMP

    def number(value: Fraction) -> Number:
        return context.mpf(value.numerator) / value.denominator

    K = constants(p, number, context.sqrt, context.atan2, +context.pi)
    names = {"complex": context.mpc, "EPS": context.ldexp(1, -precision), "basis": BasisMP(context, p)}
    names |= {name: getattr(context, name) for name in ("exp", "sin", "cos")}
    return MapArithmetic(K, bind((mapping,), names), number)


# --- reading arguments ---

UNWRAPPED = "must be >= theta_i: give unwrapped phases, the flight takes (theta_j - theta_i)/Omega"


def _row(label: object) -> Map:
    if not isinstance(label, str) or label not in MAPS:
        raise ParameterError("label", label, f"must be one of {', '.join(MAPS)}")
    return MAPS[label]


def read_points(
    p: Parameters, label: object, start: Pair, end: Pair, exit: str | None = None
) -> tuple[Map, MapArithmetic, list[Any], tuple[int, ...] | None]:
    """Return the map's row, the arithmetic, the four numbers (flat arrays) and the arrays' shape (None for scalars)."""
    row = _row(label)
    if exit is not None and not (row.sticks and exit in EXITS):
        allowed = 'must be "below", "above" or None' if row.sticks else f"must be None: {label} is a flight"
        raise ParameterError("exit", exit, allowed)
    given = [*start, *end]
    context = next((value.context for value in given if is_mp(value)), None)
    shape = None
    if context is not None:
        numbers: MapArithmetic = _mp_numbers(p, context, context.prec)
        points = [scalar(name, value, context.convert) for name, value in zip(POINT_NAMES, given, strict=True)]
        backward = points[3] < points[1]
    elif any(is_array(value) for value in given):
        numbers = _arrays(p)
        columns = columns_of(given)
        shape, points = columns[0].shape, [column.ravel() for column in columns]
        backward = bool(np.any(points[3] < points[1]))
    else:
        numbers = _floats(p)
        points = [scalar(name, value, float) for name, value in zip(POINT_NAMES, given, strict=True)]
        backward = points[3] < points[1]
    if backward and not row.sticks:
        raise ParameterError("theta_j", end[1], UNWRAPPED)
    return row, numbers, points, shape


def _in_blocks(
    evaluate: Callable[[list[np.ndarray]], np.ndarray], points: list[np.ndarray], head: tuple[int, ...]
) -> np.ndarray:
    size = len(points[0])
    found = np.empty((*head, size))
    for begin in range(0, size, ARRAY_BLOCK):
        block = slice(begin, begin + ARRAY_BLOCK)
        found[..., block] = evaluate([column[block] for column in points])
    return found


def _matrix(rows: Any) -> np.ndarray:
    return np.array(rows, dtype=object if hasattr(rows[0][0], "_mpf_") else float)  # all are of one kind


def _belt(K: Constants, boundary: int) -> BeltConstants:
    return K.belt1 if boundary == 1 else K.belt2
