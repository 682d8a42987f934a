"""Fit parameters and a start to measured events or samples, by least squares.

Each measured event is compared with the nearest one of its kind in the motion, so events may be
missing. The derivatives are exact. A fit says what the data do not
determine, and when no motion describes them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symosc.analysis.fitting.best import Minimum, Search
from symosc.analysis.fitting.judge import NAMED, FitVerdict, Outlier, outliers_of, strict, worst
from symosc.analysis.fitting.measured import Measured, read_measured
from symosc.analysis.fitting.problem import BEYOND, FitProblem, ModelFitProblem
from symosc.analysis.fitting.spread import Spread, spread_of
from symosc.base.aliases import NumberLike, SceneName, SolutionLike
from symosc.base.arguments import (
    FLAG,
    NAMES,
    NONE,
    NUMBER,
    SOLUTION,
    TEXT,
    mapping_of,
    public,
    require,
    require_or_none,
    sequence_of,
)
from symosc.base.display.drawable import Comparable, Drawable
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import read_exact
from symosc.base.quantities import NumberOfBelt, number_of_belt, read_number
from symosc.engine.start import Start
from symosc.model import Model, Oscillator
from symosc.reductions import OtherModel, numbers_of, with_numbers
from symosc.scenes import STARTS, Original, Scene, problem_of
from symosc.simulation.simulate import read_problem
from symosc.simulation.tables import counted
from symosc.simulation.tangents import names_of
from symosc.simulation.trajectory import Trajectory


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
        Motion minus data, divided by sigma: of each event in its order, or of all x, then of all
        v.
    success : bool
        Whether the fit converged, the data determine all numbers, and the motion describes them.
    message : str
        How much work it was; or why the fit is no success.
    trajectory : Trajectory
        The motion with the fitted numbers; of another model, in the coordinates of that model.
    outliers : tuple of Outlier
        Data that the motion does not describe although it describes the others, the worst first.

    Examples
    --------
    >>> from symosc import fit, simulate
    >>> data = [(event.t, event.kind) for event in simulate("fig5").events]
    >>> found = fit("fig5", data, ("mu1",), sigma=1e-3, start={"mu1": 0.75})
    >>> round(found.values["mu1"], 9), found.success
    (0.8, True)
    """

    _drawn_by = "fit_figure"

    values: dict[str, float]
    errors: dict[str, float]
    covariance: np.ndarray
    residuals: np.ndarray
    success: bool
    message: str
    trajectory: Trajectory
    outliers: tuple[Outlier, ...]
    _measured: Measured

    def __repr__(self) -> str:
        texts = [
            f"{name} = {value:.6g} ± {self.errors[name]:.2g}" for name, value in self.values.items()
        ]
        return f"<Fit {', '.join(texts)}: {self.message}>"


@public
def fit(
    what: Scene | Model | OtherModel | SceneName,
    data: SolutionLike,
    free: str | Sequence[str] = ("mu1", "c"),
    *,
    sigma: NumberLike | Sequence[NumberLike] | None = None,
    start: Mapping[str, NumberLike] | None = None,
    robust: bool = False,
    columns: Mapping[str, str | None] | None = None,
) -> Fit:
    """Fit parameters, and numbers of the start, to measured events or samples.

    Parameters
    ----------
    what : Scene, or its name or its file; Parameters, Oscillator or OtherModel
        The motion; what is not free is kept. Parameters and models begin at rest at t = 0. For
        another model data and fitted numbers are those of the model, in its coordinates.
    data : table, sequence of rows, solver result, or path of a file
        Columns t and kind ("cross", "stick", "slip" or "graze"), of events in any number; or t and
        x, or t, x and v, of samples. Rows are (t, kind) or (t, x) or (t, x, v). Files and names of
        columns such as time, pos and vel are read as `symosc.crosscheck` reads them.
    free : str or sequence of str
        Names of parameters, and t0, x0, v0. Those of an `Oscillator` are mu_s1, w1_1, mu1_1,
        slope1 and so on, those of an `OtherModel` its numbers and those of its belts: Y, pull,
        phase and so on. Numbers that must be in order, such as mu1 and mu_s1 or the points of a
        curve, stay in order.
    sigma : number, or two for x and v, optional
        Standard deviation of the times of events, or of the positions (and velocities). None: from
        the residuals.
    start : mapping, optional
        First values of free numbers, in place of those of `what`. A static coefficient of a belt
        that has none begins above the kinetic one: ``start={"mu_s1": 0.6}``. If the minimum next to them does
        not describe the data, the fit tries others that are up to 1.5 times as large or as small,
        always the same ones.
    robust : bool
        Whether to minimise the sum of ln(1 + (r / c)^2) of the residuals r, with c = 2.385 sigma,
        in place of that of r^2, so that outliers hardly count. Up to a tenth of the data may be
        outliers.
    columns : mapping, optional
        What the columns are called, such as {"t": "Time (s)", "x": "u"}; keys are t, kind, x and v.

    Returns
    -------
    Fit
        It is no success if the motion does not describe the data. With `sigma`, chi squared and
        the largest residual decide, each wrong about once in 10,000 good fits. Without it,
        residuals must not be like their neighbours in time, none far larger than the others, and
        events not off by more than a hundredth of the time between them.

    Raises
    ------
    ParameterError
        If a name is unknown, or the data have no such columns.

    Examples
    --------
    >>> from symosc import fit
    >>> data = [(0.1223, "stick"), (1.2210, "slip"), (4.7586, "stick")]
    >>> found = fit("fig5", data, "mu1", sigma=1e-4)
    >>> abs(found.values["mu1"] - 0.8) < 3 * found.errors["mu1"]
    True

    How fast the spring of a block is pulled, from when this slips and stops:

    >>> from symosc import Belt, OtherModel
    >>> block = OtherModel(m=1, k=2, Omega=1, FN=1, pull="1/9", belts=[Belt(0, "1/2", mu_s="4/5")])
    >>> found = fit(block, [(4.0, "slip"), (6.8444, "stick"), (9.8444, "slip")], "pull", sigma=1e-3)
    >>> round(found.values["pull"], 3), found.success
    (0.1, True)
    """
    scene = problem_of(what, "what", any_law=True)
    require(SOLUTION, data=data)
    require(*NAMES, free=free)
    require_or_none(NUMBER, sequence_of(NUMBER), sigma=sigma)
    require_or_none(mapping_of(NUMBER), start=start)
    require(FLAG, robust=robust)
    require_or_none(mapping_of(TEXT, NONE), columns=columns)
    if isinstance(free, str):
        names: tuple[str, ...] = (free,)
    else:
        names = tuple(free)
    _check_names(scene, names, start or {})
    sigmas = _sigma(sigma)
    measured = replace(read_measured(data, columns, scene), weighted=sigma is not None)
    problem = _problem(scene, names, measured, sigmas, start or {})
    search = Search(problem, problem.first_values())
    return _fit_of(search, robust)


def _check_names(
    scene: Scene | Model | OtherModel, names: tuple[str, ...], first: Mapping[str, NumberLike]
) -> None:
    """Raise ParameterError unless the free numbers `names`, and those with `first` values, are
    numbers of the motion, and the latter are free.
    """
    known = [*_all_names(scene), *STARTS]
    if not names:
        raise ParameterError("free", names, f"must be one or more of {', '.join(known)}")
    for argument, given_names in (("free", names), ("start", first)):
        for name in given_names:
            if name not in known:
                allowed = f"must be one of {', '.join(known)}{meant(str(name), known)}"
                raise ParameterError(argument, name, allowed)
    for name in first:
        if name not in names:
            allowed = f"must be one of the free numbers {', '.join(names)}"
            raise ParameterError("start", name, allowed)


def _all_names(scene: Scene | Model | OtherModel) -> list[str]:
    """Return the names of all numbers that a model may have; of belts also the slopes of curves
    that have none.
    """
    if isinstance(scene, OtherModel):
        model: Model | OtherModel = scene
    elif isinstance(scene, Model):
        model = scene
    elif scene.original is not None:
        model = scene.original.model
    else:
        model = scene.parameters
    if isinstance(model, OtherModel):
        names = list(numbers_of(model))
        belts = len(model.belts)
    else:
        names = list(model.numbers())
        belts = len(model.belts) if isinstance(model, Oscillator) else 0
    slopes = (str(NumberOfBelt("slope", n)) for n in range(1, belts + 1))
    return names + [name for name in slopes if name not in names]


def _problem(
    scene: Scene | Model | OtherModel,
    names: tuple[str, ...],
    measured: Measured,
    sigmas: np.ndarray,
    first: Mapping[str, NumberLike],
) -> FitProblem:
    """Return the problem of fitting the free numbers `names` of a motion to data.

    The motion of the problem has the `first` values.
    """
    last_time = float(measured.t.max())
    changes: dict[str, Any] = dict.fromkeys((*STARTS, "t_end"))
    if not isinstance(scene, Scene):
        # Parameters have no end, and `read_problem` wants one: any time after the data.
        changes["t_end"] = last_time + 1.0
    start, original = read_problem(scene, changes, None)
    if original is None:
        start = _started(start, first)
        t0 = start.t0
    else:
        original = _model_started(original, first)
        # Any end after the start: the fit has its own.
        original = original._replace(t_end=original.t0 + 1, start_error=None)
        t0 = original.t0
        start, _ = read_problem(_scene_of_model(original), {}, None)
    for name in names:
        is_of_belt = number_of_belt(name) is not None
        if is_of_belt and name not in names_of(start.parameters):
            raise ParameterError("free", name, _why_not_free(name))
    extra = 0.0
    if measured.kinds is not None:
        # The event nearest to the last measured one may come after it.
        extra = BEYOND * (last_time - float(t0))
    end = last_time + extra
    if original is None:
        return FitProblem(start, names, measured, sigmas, end)
    return ModelFitProblem(start, names, measured, sigmas, end, original=original)


def _scene_of_model(original: Original) -> Scene:
    """Return the scene of another model's problem."""
    numbers: dict[str, Any] = original._asdict()
    return Scene("fit", numbers.pop("model"), **numbers)


def _model_started(original: Original, first: Mapping[str, NumberLike]) -> Original:
    """Return the problem of another model with first values in place of its own numbers."""
    numbers = {name: value for name, value in first.items() if name not in STARTS}
    begin: dict[str, Any] = {
        name: read_number(name, first[name])[0] for name in STARTS if name in first
    }
    return original._replace(model=with_numbers(original.model, numbers), **begin)


def _started(start: Start, first: Mapping[str, NumberLike]) -> Start:
    """Return a motion with first values in place of its own numbers."""
    numbers = {name: value for name, value in first.items() if name not in STARTS}
    begin: dict[str, Any] = {
        name: read_number(name, first[name])[0] for name in STARTS if name in first
    }
    model = start.parameters
    if numbers:
        model = model.replace(**numbers)
    return replace(start, parameters=model, **begin)


def _why_not_free(name: str) -> str:
    """Return why a number that a model may have cannot be varied."""
    number = number_of_belt(name)
    if number is not None and number.quantity == "mu_s":
        return f'is equal to mu{number.belt}; begin above it with start={{"{name}": ...}}'
    return f'is 0, as friction does not depend on speed; begin with start={{"{name}": ...}}'


def _fit_of(search: Search, robust: bool) -> Fit:
    """Return the answer of `fit`, from the minima that a search has found."""
    problem = search.problem
    measured = problem.measured
    names = problem.names
    if robust:
        chosen = search.robust()
        verdict = chosen.verdict
        is_kept = verdict.kept
        losses = chosen.losses(measured.weighted)
    else:
        chosen = search.plain
        verdict = strict(chosen.verdict)
        is_kept = np.ones(len(chosen.at.residuals), dtype=bool)
        losses = 1.0
    # The size of each number, by which its changes are compared; 1 for a number that begins at 0.
    steps = np.array([abs(value) or 1.0 for value in search.first.tolist()])
    spread = spread_of(problem, chosen.at, steps, is_kept, search.places, losses)
    errors = spread.errors
    # Without sigma the residuals tell the errors, and as many data as numbers leave no residuals.
    if not measured.weighted and len(chosen.at.residuals) <= len(names):
        errors = np.full(len(names), np.inf)
    # The minimum that outliers hardly pull tells them best, even if it is not the one returned.
    source = search.tolerant or chosen
    outliers: tuple[Outlier, ...] = ()
    if source.verdict.is_described:
        outliers = outliers_of(measured, source.at.residuals, source.verdict)
    return Fit(
        values=dict(zip(names, chosen.values.tolist(), strict=True)),
        errors=dict(zip(names, errors.tolist(), strict=True)),
        covariance=spread.covariance,
        residuals=chosen.at.residuals,
        success=verdict.is_described and not chosen.failure and not spread.unknown,
        message=_message(search, chosen, verdict, spread, outliers),
        trajectory=chosen.at.trajectory,
        outliers=outliers,
        _measured=measured,
    )


def _message(
    search: Search,
    chosen: Minimum,
    verdict: FitVerdict,
    spread: Spread,
    outliers: tuple[Outlier, ...],
) -> str:
    """Return the message of a fit: why it is no success, or how it was found."""
    problem = search.problem
    count = len(chosen.at.residuals)
    if spread.unknown:
        units = f"in units of their first values: {spread.undetermined}"
        return f"the data do not determine {spread.unknown} ({units})"
    if chosen.failure:
        return f"not converged: {chosen.failure}"
    if not verdict.is_described and outliers:
        return (
            f"the data have {counted(len(outliers), 'outlier')}, which a fit with robust=True "
            f"leaves out: {_listed(outliers)}; the other {count - len(outliers)} are described"
        )
    if not verdict.is_described:
        tried = ", from many starts" if search.is_wide else ""
        farthest = worst(problem.measured, chosen.at.residuals, verdict)
        return f"no motion describes the data{tried}: {verdict.text}; farthest off are {farthest}"
    message = f"converged: {problem.effort.motions} motions, {count} residuals"
    if outliers:
        message += f"; {counted(len(outliers), 'outlier')}: {_listed(outliers)}"
    if not problem.measured.weighted and count <= len(problem.names):
        message += "; from no more residuals than numbers no errors can be estimated: give sigma"
    return message


def _listed(outliers: tuple[Outlier, ...]) -> str:
    """Return the worst outliers as a text."""
    more = f" and {len(outliers) - NAMED} more" if len(outliers) > NAMED else ""
    return ", ".join(map(str, outliers[:NAMED])) + more


def _sigma(sigma: Any) -> np.ndarray:
    """Return `sigma` as two standard deviations: of times or positions, and of velocities.

    None stands for 1.
    """
    if sigma is None:
        return np.ones(2)
    if isinstance(sigma, Sequence) and not isinstance(sigma, str):
        pair = sigma
    else:
        pair = [sigma] * 2
    try:
        deviations = [float(read_exact("sigma", number)) for number in pair]
    except ParameterError:
        deviations = []
    if len(deviations) != 2 or min(deviations) <= 0:
        allowed = (
            "must be the standard deviation of the data, a number > 0 such as 0.01, or two such "
            "numbers, for x and for v"
        )
        raise ParameterError("sigma", sigma, allowed)
    return np.array(deviations)
