"""Residuals of maps and words over arrays in SIMD loops, and for use in compiled user code."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.arguments import FLAG, TEXT, WORD, public, require, require_or_none
from symosc.base.errors import ParameterError
from symosc.base.exact import unmasked
from symosc.engine.arithmetic import compiled
from symosc.engine.flow import Constants, constants
from symosc.friction import MAPS, Map
from symosc.kernels import _generated, elementary, entire, entire_array, formulas, mapping
from symosc.kernels.compiling import compile_modules
from symosc.kernels.mapping import BACKWARD, CLOSED_FORM, KINDS, WIDE
from symosc.mappings.equations import EXITS, UNWRAPPED, flight_arguments, stick_arguments
from symosc.mappings.points import POINT_NAMES
from symosc.model import Parameters
from symosc.scenes import ParametersLike, parameters_for
from symosc.words import WordLike, read_word

FORMULAS = ("by_closed_form", "by_division", "by_division_and_series", "by_series")


@public
def compiled_residual(
    p: ParametersLike, label: WordLike, *, jacobian: bool = False, exit: str | None = None
) -> CompiledResidual:
    """Return a compiled function for the residuals of a map, or of a word, over arrays.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    label : str
        "P1" to "P8", or a word such as "P32", read right to left.
    jacobian : bool
        Whether it returns the derivatives too.
    exit : str, optional
        For sticks: the domain that they slip into, "below" or "above"; None: for each point the one
        in which the force f2 is nearer to 0.

    Raises
    ------
    MissingExtraError
        If numba is not installed.
    ParameterError
        For parameters that are none, and for an exit of a map that is no stick.
    WordError
        For a word that no motion can follow.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import compiled_residual, load_scene
    >>> f = compiled_residual(load_scene("fig9").parameters, "P2")
    >>> f1, f2 = f(np.array([4.5]), np.array([0.5]), np.array([-4.0]), np.array([4.0]))
    >>> f1.round(6), f2.round(6)
    (array([-0.146366]), array([1.642603]))
    """
    p = parameters_for(p, label=label)
    require(WORD, label=label)
    require(FLAG, jacobian=jacobian)
    require_or_none(TEXT, exit=exit)
    if isinstance(label, str) and label in MAPS:
        labels: tuple[str, ...] = (label,)
    else:
        labels = read_word(label).labels
    rows = tuple(MAPS[name] for name in labels)
    if exit is not None and not (exit in EXITS and any(row.sticks for row in rows)):
        raise ParameterError(
            "exit", exit, f'must be None, or "below" or "above" for a stick; the map is {label}'
        )
    _loops(WIDE)  # raises at once if numba is missing
    return CompiledResidual(p, rows, jacobian, exit)


class CompiledResidual:
    """The compiled residuals of a map or a word, made by `compiled_residual`.

    A map is called with four arrays x_i, theta_i, x_j, theta_j of one length n; phases are
    unwrapped. It returns f1 and f2, eq. (54), and with ``jacobian=True`` also an array (2, 4, n):
    the derivatives by the four.

    A word of N maps is called with two arrays x, theta of shape (N + 1, n): its switching points in
    order of time. It returns an array (2 N, n), and with ``jacobian=True`` also an array (N, 2, 4,
    n): the derivatives of the two equations of each map by x_i, theta_i, x_j, theta_j of that map.

    Attributes
    ----------
    maps : tuple of str
        The labels in order of time.
    scalar : numba function
        (x_i, theta_i, x_j, theta_j) -> (f1, f2), or (f1, f2, (8 derivatives by rows)): to be called
        from compiled code of your own. It uses the C library's functions and does not check its
        arguments. Of a map only.

    Examples
    --------
    >>> import numba
    >>> from symosc import compiled_residual, load_scene
    >>> f = compiled_residual(load_scene("fig9").parameters, "P2", jacobian=True).scalar
    >>> @numba.njit
    ... def newton_step(x_i, theta_i, x_j, theta_j):
    ...     f1, f2, (_, _, a, b, _, _, c, d) = f(x_i, theta_i, x_j, theta_j)
    ...     size = a * d - b * c
    ...     return x_j - (d * f1 - b * f2) / size, theta_j - (a * f2 - c * f1) / size
    >>> x_j, theta_j = newton_step(4.5, 0.5, -4.0, 4.0)
    >>> print(f"{x_j:.6f} {theta_j:.6f}")
    -4.194448 3.927220
    """

    def __init__(
        self, p: Parameters, rows: tuple[Map, ...], jacobian: bool, exit: str | None
    ) -> None:
        self.parameters = p
        self.maps = tuple(row.label for row in rows)
        self.jacobian = jacobian
        self.exit = exit
        self._rows = rows
        self._K = constants(p, driven=True)

    def __repr__(self) -> str:
        return f"CompiledResidual(maps={self.maps}, jacobian={self.jacobian})"

    @public
    def __call__(self, *columns: ArrayLike) -> Any:
        """Return the residuals, and the derivatives if they were asked for.

        Raises
        ------
        ParameterError
            For arrays of other shapes, and for a flight with theta_j < theta_i.
        """
        if len(self._rows) == 1:
            f, J = self._fill(self._rows[0], _read(columns, POINT_NAMES, 1))
            if self.jacobian:
                return (f[0], f[1], J)
            return (f[0], f[1])
        x, theta = _read(columns, ("x", "theta"), 2)
        if len(x) != len(self._rows) + 1:
            raise ParameterError(
                "x", x.shape, f"must have {len(self._rows) + 1} rows: a point more than maps"
            )
        results = [
            self._fill(row, (x[n], theta[n], x[n + 1], theta[n + 1]))
            for n, row in enumerate(self._rows)
        ]
        f = np.concatenate([f for f, _ in results])
        if self.jacobian:
            return (f, np.stack([J for _, J in results if J is not None]))
        return f

    @cached_property
    def scalar(self) -> Any:
        """The compiled function for the residual at one pair of points, which other compiled code
        can call.
        """
        if len(self._rows) > 1:
            raise ParameterError("map", self.maps, "must be a single map, not a word, for `scalar`")
        return _scalar(self._rows[0], self._K, self.jacobian, self.exit)

    def _fill(self, row: Map, points: Any) -> tuple[np.ndarray, np.ndarray | None]:
        """Compute the residuals (2, n) of the map `row` at n pairs of points, and its Jacobians (2,
        4, n) or None.
        """
        n = len(points[0])
        K = self._K
        f = np.empty((2, n))
        if self.jacobian:
            J = np.empty((2, 4, n))
        else:
            J = None
        if J is None:
            results: tuple[np.ndarray, ...] = (f,)
        else:
            results = (f, J)
        # the function of `symosc.kernels.mapping` that fills the results
        name = ("sticks" if row.sticks else "flights") + ("" if J is None else "_and_slopes")
        if row.sticks:
            # Only the C library's functions reduce angles as large as that.
            wide = n > 0 and max(points[3].max(), -points[3].min()) > elementary.WIDEST
            v, sides = stick_arguments(row, K, self.exit)
            _loops(WIDE if wide else CLOSED_FORM)[name](points, v, sides, K, *results)
            return f, J
        kinds = np.empty(n, dtype=np.uint8)
        counts = _loops(WIDE)["kinds_of"](points[1], points[3], K, kinds)
        if counts[BACKWARD]:
            raise ParameterError("theta_j", "array", UNWRAPPED)
        v_i, v_j, A = flight_arguments(row, K)
        arguments = (v_i, v_j), A, K
        # The most frequent formula runs over all points, without selecting them; the others then
        # overwrite theirs.
        order = sorted(
            (kind for kind in range(KINDS) if counts[kind]), key=lambda kind: -counts[kind]
        )
        for kind in order:
            if kind == order[0]:
                _loops(kind)[name](points, *arguments, *results)
                continue
            at = np.flatnonzero(kinds == kind)
            picked = tuple(np.empty((*result.shape[:-1], len(at))) for result in results)
            _loops(kind)[name](tuple(column[at] for column in points), *arguments, *picked)
            for result, part in zip(results, picked, strict=True):
                result[..., at] = part
        return f, J


def _read(
    columns: tuple[Any, ...], names: tuple[str, ...], dimensions: int
) -> tuple[np.ndarray, ...]:
    """Return the given columns as arrays of floats, checked for equal shapes but not for finite
    entries.
    """
    if len(columns) != len(names):
        raise ParameterError("points", f"{len(columns)} arrays", f"must be {', '.join(names)}")
    entries = [unmasked(name, column) for name, column in zip(names, columns, strict=True)]
    try:
        entries = [np.asarray(column) for column in entries]
        if any(column.dtype.kind not in "iufO" for column in entries):
            raise TypeError
        arrays = tuple(
            np.require(column, dtype=float, requirements=["C", "W"]) for column in entries
        )
    except (TypeError, ValueError, OverflowError):
        raise ParameterError("points", columns, "must be arrays of real numbers") from None
    shapes = [array.shape for array in arrays]
    if len(set(shapes)) > 1 or len(shapes[0]) != dimensions:
        if dimensions == 1:
            allowed = "one-dimensional arrays of one length"
        else:
            allowed = "two-dimensional arrays of one shape"
        raise ParameterError("points", shapes, f"must be {allowed}")
    return arrays


@lru_cache(maxsize=KINDS)
def _loops(kind: int) -> dict[str, Any]:
    """Return the compiled functions that evaluate maps for whole arrays.

    `kind` says by which formula for the basis.
    """
    outlined = {
        "flights",
        "flights_and_slopes",
        "sticks",
        "sticks_and_slopes",
        "load",
        "store",
        "kinds_of",
    }
    if kind == WIDE:
        return compile_modules((mapping,), outlined | {"flight", "flight_slopes"}, compiled())
    series = compile_modules((entire_array,), ())["series"]
    power = {"power_of_two": compiled()["power_of_two"]}
    short = compile_modules((elementary,), (), power, {"select": compiled()["select"]})
    plain = power | {name: short[name] for name in ("exp", "expm1")}
    plain |= {name: short[f"short_{name}"] for name in ("sin", "cos")}  # without a branch
    basis = compile_modules((_generated, entire, formulas), (), plain | {"all_terms": series})[
        FORMULAS[kind]
    ]
    return compile_modules((_generated, mapping), outlined, plain | {"basis": basis})


def _scalar(row: Map, K: Constants, jacobian: bool, exit: str | None) -> Any:
    """Return a compiled function for the residual (and Jacobian) of the map `row` at one pair of
    points.
    """
    import numba

    flight, flight_slopes, stick, stick_slopes = (
        _loops(WIDE)[name] for name in ("flight", "flight_slopes", "stick", "stick_slopes")
    )
    if row.sticks:
        v, (below, above) = stick_arguments(row, K, exit)

        def residual(x_i, theta_i, x_j, theta_j):
            f1, force_below = stick(x_i, theta_i, x_j, theta_j, v, below, K)
            _, force_above = stick(x_i, theta_i, x_j, theta_j, v, above, K)
            return f1, (force_below if abs(force_below) <= abs(force_above) else force_above)

        def slopes(x_i, theta_i, theta_j):
            x_th0, x_th1, v_x1, v_th1 = stick_slopes(theta_j, v, K)
            return 1.0, x_th0, -1.0, x_th1, 0.0, 0.0, v_x1, v_th1
    else:
        v_i, v_j, A = flight_arguments(row, K)

        def residual(x_i, theta_i, x_j, theta_j):
            return flight(x_i, theta_i, x_j, theta_j, v_i, v_j, A, K)

        def slopes(x_i, theta_i, theta_j):
            x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = flight_slopes(x_i, theta_i, theta_j, v_i, A, K)
            return x_x0, x_th0, -1.0, x_th1, v_x0, v_th0, 0.0, v_th1

    compile_ = numba.njit(error_model="numpy")
    residual = compile_(residual)
    slopes = compile_(slopes)

    def both(x_i, theta_i, x_j, theta_j):
        f1, f2 = residual(x_i, theta_i, x_j, theta_j)
        return f1, f2, slopes(x_i, theta_i, theta_j)

    if jacobian:
        return compile_(both)
    return residual
