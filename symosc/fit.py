"""Fit parameters and a start to measured events or samples, by least squares with exact derivatives.

Each measured event is compared with the nearest one of its kind in the motion, so events may be
missing. The fit is that of scipy.optimize.least_squares; its Jacobian is `symosc.sensitivities`.
What the data do not determine is said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from symosc.aliases import NumberLike, SceneName
from symosc.arguments import public
from symosc.display.drawable import Comparable, Drawable
from symosc.engine.events import KIND_NAMES
from symosc.errors import ParameterError, brief, meant, shown
from symosc.exact import read_exact, unmasked
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.quantities import least, read_number
from symosc.scenes import STARTS, Scene
from symosc.sensitivities import Sensitivities, sensitivities
from symosc.simulation.simulate import read_start
from symosc.simulation.trajectory import Trajectory

#: A combination of numbers whose change by its own size changes the residuals by less than this is
#: not determined.
UNDETERMINED = 1e-8
KINDS = tuple(KIND_NAMES.values())


@dataclass(frozen=True)
class Measured:
    """Measured data: times, and either the kinds of events or positions, perhaps with velocities."""

    t: np.ndarray
    kinds: np.ndarray | None
    states: np.ndarray | None  # (1 or 2, n)
    weighted: bool = False  # whether their standard deviations are known


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Comparable, Drawable):
    """The result of a fit.

    Attributes
    ----------
    values, errors : dict
        The fitted numbers by name, and their standard errors; inf for what the data do not
        determine.
    covariance : array, (free, free)
    residuals : array
        Motion minus data, divided by sigma: of each event in its order, or of all x, then of all v.
    success : bool
        Whether the fit converged and the data determine all numbers.
    message : str
    trajectory : Trajectory
        The motion with the fitted numbers.

    Examples
    --------
    >>> from symosc import fit, simulate
    >>> data = {"t": [event.t for event in simulate("fig5").events], "kind": [e.kind for e in simulate("fig5").events]}
    >>> found = fit("fig5", data, ("mu1",), sigma=1e-3, start={"mu1": 0.75})
    >>> round(found.values["mu1"], 9), found.success
    (0.8, True)
    """

    values: dict[str, float]
    errors: dict[str, float]
    covariance: np.ndarray
    residuals: np.ndarray
    success: bool
    message: str
    trajectory: Trajectory
    _measured: Measured

    def __repr__(self) -> str:
        texts = [
            f"{name} = {value:.6g} ± {self.errors[name]:.2g}" for name, value in self.values.items()
        ]
        return f"<Fit {', '.join(texts)}: {self.message}>"


@public
def fit(
    what: Scene | Parameters | SceneName,
    data: Any,
    free: str | Sequence[str] = ("mu1", "c"),
    *,
    sigma: NumberLike | Sequence[NumberLike] | None = None,
    start: Mapping[str, NumberLike] | None = None,
) -> Fit:
    """Fit parameters, and numbers of the start, to measured events or samples.

    Parameters
    ----------
    what : Scene, or its name or its file
        The motion; what is not free is kept. Parameters begin at rest at t = 0.
    data : mapping, table or sequence of rows
        Columns t and kind ("cross", "stick", "slip" or "graze"), of events in any number; or t and
        x, or t, x and v, of samples. Rows are (t, kind) or (t, x) or (t, x, v).
    free : str or sequence of str
        Names of parameters, and t0, x0, v0.
    sigma : number, or two for x and v, optional
        Standard deviation of the times of events, or of the positions (and velocities). None: from
        the residuals.
    start : mapping, optional
        First values of free numbers, in place of those of `what`. They must be near enough for the
        events to be recognised.

    Returns
    -------
    Fit

    Raises
    ------
    ParameterError
        If a name is unknown, or the data have no such columns.

    Examples
    --------
    >>> from symosc import fit
    >>> found = fit("fig5", [(0.1223, "stick"), (1.2210, "slip"), (4.7586, "stick")], "mu1", sigma=1e-4)
    >>> abs(found.values["mu1"] - 0.8) < 3 * found.errors["mu1"]
    True
    """
    from scipy.optimize import least_squares

    if isinstance(free, str):
        names: tuple[str, ...] = (free,)
    else:
        names = tuple(free)
    known = (*PARAMETER_NAMES, *STARTS)
    for argument, given_names in (("free", names or ("",)), ("start", start or {})):
        for name in given_names:
            if name not in known:
                raise ParameterError(
                    argument, name, f"must be one of {', '.join(known)}{meant(str(name), known)}"
                )
    for name in start or {}:
        if name not in names:
            raise ParameterError(
                "start", name, f"is a first value of what is not free; free are {', '.join(names)}"
            )
    measured = replace(_read(data), weighted=sigma is not None)
    scale = _sigma(sigma)
    last = float(measured.t.max())
    given = {
        "t0": None,
        "x0": None,
        "v0": None,
        "t_end": last + 1.0 if isinstance(what, Parameters) else None,
    }
    scene = read_start(what, given, None)
    end = last + (0.05 * (last - float(scene.t0)) if measured.kinds is not None else 0.0)
    own = {
        name: getattr(scene.parameters if name in PARAMETER_NAMES else scene, name)
        for name in names
    }
    first = [float(read_number(name, (start or {}).get(name, own[name]))[0]) for name in names]

    @lru_cache(maxsize=1)
    def evaluated(*values: float) -> tuple[np.ndarray, np.ndarray, Trajectory]:
        new = dict(zip(names, map(repr, values), strict=True))
        p = scene.parameters.replace(
            **{name: new[name] for name in names if name in PARAMETER_NAMES}
        )
        begin = {name: new.get(name, getattr(scene, name)) for name in STARTS}
        return _residuals(sensitivities(p, names, **begin, t_end=end), measured, scale, end)

    bounds = [least(name) if name in PARAMETER_NAMES else None for name in names]
    low = np.array([-np.inf if bound is None else float(bound) for bound in bounds])
    steps = np.array([abs(value) or 1.0 for value in first])
    found = least_squares(
        lambda values: evaluated(*values.tolist())[0],
        np.clip(first, low * (1 + 1e-9), np.inf),
        jac=lambda values: evaluated(*values.tolist())[1],
        bounds=(low, np.inf),
        x_scale=steps,
        max_nfev=200,
    )
    residuals, slopes, trajectory = evaluated(*found.x.tolist())
    errors, covariance, unknown, undetermined = _spread(
        names, residuals, slopes, steps, sigma is None
    )
    message = f"converged: {found.nfev} motions, {len(residuals)} residuals"
    if unknown:
        message = (
            f"the data do not determine {unknown} (in units of their first values: {undetermined})"
        )
    elif sigma is None and len(residuals) <= len(names):
        errors = np.full(len(names), np.inf)
        message += "; from no more residuals than numbers no errors can be estimated: give sigma"
    elif not found.success:
        message = f"not converged: {found.message}"
    values, spread = (dict(zip(names, each.tolist(), strict=True)) for each in (found.x, errors))
    success = bool(found.success) and not unknown
    return Fit(values, spread, covariance, residuals, success, message, trajectory, measured)


def _spread(
    names: tuple[str, ...],
    residuals: np.ndarray,
    slopes: np.ndarray,
    steps: np.ndarray,
    estimated: bool,
) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Return standard errors and covariance of the fitted numbers, and two texts on those that are not determined.

    `slopes` is the Jacobian of `residuals`. The first text lists those of the `names` that the data
    do not determine, the second the undetermined combinations, each number in units of its entry in
    `steps`. If `estimated`, the variance is that of the residuals, else 1.
    """
    _, sizes, rows = np.linalg.svd(slopes * steps, full_matrices=len(residuals) < len(names))
    sizes = np.append(sizes, np.zeros(len(names) - len(sizes)))
    free = sizes <= UNDETERMINED * max(float(sizes.max(initial=0.0)), 1e-300)
    if estimated:
        variance = float(residuals @ residuals) / max(len(residuals) - len(names), 1)
    else:
        variance = 1.0
    inverse = np.where(free, 0.0, 1.0 / np.where(free, 1.0, sizes) ** 2)
    covariance = (rows.T * inverse) @ rows * variance * np.outer(steps, steps)
    combined = [
        {name: part for name, part in zip(names, row, strict=True) if abs(part) > 1e-6}
        for row in rows[free].tolist()
    ]
    unknown = [name for name in names if any(name in each for each in combined)]
    errors = np.where([name in unknown for name in names], np.inf, np.sqrt(np.diag(covariance)))
    texts = (" ".join(f"{part:+.3g} {name}" for name, part in each.items()) for each in combined)
    return errors, covariance, ", ".join(unknown), "; ".join(texts)


def _residuals(
    moved: Sensitivities, measured: Measured, scale: np.ndarray, end: float
) -> tuple[np.ndarray, np.ndarray, Trajectory]:
    """Return (motion - data) / sigma, its derivatives with respect to the free numbers, and the motion.

    `moved` has the motion and its derivatives, and `scale` the sigmas. A measured event of a kind
    that the motion lacks is compared with the time `end`.
    """
    trajectory = moved.trajectory
    count = len(moved.wrt)
    if measured.kinds is None:
        assert measured.states is not None
        times = np.clip(measured.t, float(trajectory.t_start), float(trajectory.t_end))
        rows = len(measured.states)
        weights = scale[: len(measured.states), None]
        off = (np.asarray(trajectory(times))[:rows] - measured.states) / weights
        return (
            off.ravel(),
            (moved(times)[:rows] / weights[:, :, None]).reshape(-1, count),
            trajectory,
        )
    there = np.array([float(event.t) for event in trajectory.events])
    kinds = np.array([event.kind for event in trajectory.events], dtype=object)
    off = np.empty(len(measured.t))
    slopes = np.zeros((len(measured.t), count))
    for kind in dict.fromkeys(measured.kinds.tolist()):
        mine = np.flatnonzero(measured.kinds == kind)
        its = np.flatnonzero(kinds == kind)
        if not len(its):
            off[mine] = end - measured.t[mine]  # as if it came at the end
            continue
        nearest = its[np.argmin(abs(there[its][None, :] - measured.t[mine][:, None]), axis=1)]
        off[mine], slopes[mine] = there[nearest] - measured.t[mine], moved.dt[nearest]
    return off / scale[0], slopes / scale[0], trajectory


def _sigma(sigma: Any) -> np.ndarray:
    """Return `sigma` as two standard deviations: of times or positions, and of velocities.

    None stands for 1.
    """
    if isinstance(sigma, Sequence) and not isinstance(sigma, str):
        given = sigma
    else:
        given = [1 if sigma is None else sigma] * 2
    found = [float(read_exact("sigma", each)) for each in given]
    if len(found) != 2 or min(found) <= 0:
        raise ParameterError("sigma", sigma, "must be a number > 0, or two: of x and v")
    return np.array(found)


def _read(data: Any) -> Measured:
    """Return measured data, given as a table or as rows, as `Measured`.

    Raise ParameterError if columns are missing.
    """
    try:
        columns = _columns(data)
    except (TypeError, ValueError, KeyError):  # of what is no table
        columns = {}
    if not columns.get("t") or not ("kind" in columns or "x" in columns):
        allowed = "must have the columns t and kind, or t and x, or t, x and v, or be rows of these"
        if isinstance(data, str):
            allowed += ", not the name of a file (the command symosc fit reads CSV files)"
        if isinstance(data, Mapping):
            names = list(data)
        else:
            names = list(getattr(data, "columns", ()))
        if names:
            about = brief(f"columns {', '.join(map(str, names))}")
        elif isinstance(data, str):
            about = brief(data)
        else:
            about = shown(data)
        raise ParameterError("data", about, allowed)
    if len({len(column) for column in columns.values()}) > 1:
        raise ParameterError("data", len(columns["t"]), "must have columns of one length")

    def numbers(name: str) -> list[float]:
        return [float(read_exact(f"{name}[{row}]", each)) for row, each in enumerate(columns[name])]

    t = np.array(numbers("t"))
    if "kind" not in columns:
        return Measured(
            t, None, np.array([numbers(name) for name in ("x", "v") if name in columns])
        )
    for row, kind in enumerate(columns["kind"]):
        if not isinstance(kind, str) or kind not in KINDS:
            raise ParameterError(
                f"kind[{row}]", kind, f"must be one of {', '.join(KINDS)}{meant(str(kind), KINDS)}"
            )
    return Measured(t, np.array(columns["kind"], dtype=object), None)


def _columns(data: Any) -> dict[str, list[Any]]:
    """Return the columns t, kind, x and v of a table or of rows, as far as the data have them."""
    if isinstance(data, Mapping) or hasattr(data, "columns"):
        return {
            name: list(unmasked(name, data[name]))
            for name in ("t", "kind", "x", "v")
            if name in data
        }
    if isinstance(data, str | bytes | bytearray):
        return {}
    rows = [tuple(row) for row in unmasked("data", data)]
    if {len(row) for row in rows} not in ({2}, {3}):
        return {}
    if isinstance(rows[0][1], str):
        names: tuple[str, ...] = ("t", "kind")
    else:
        names = ("t", "x", "v")
    return dict(zip(names, map(list, zip(*rows, strict=True)), strict=False))
