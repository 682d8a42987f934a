"""Compare external solutions with the exact motion: step by step, event by event, and globally."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial as partial_of
from typing import Any

from numpy.typing import ArrayLike

from symosc.base.aliases import NumberLike, Progress, SceneName, SolutionLike
from symosc.base.arguments import (
    ARRAY_LIKE,
    FLAG,
    NONE,
    NUMBER,
    PROGRESS,
    REAL,
    SOLUTION,
    TEXT,
    WHOLE,
    function_of,
    mapping_of,
    public,
    require,
    require_or_none,
    row_of,
    sequence_of,
)
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact
from symosc.crosschecks.events import FoundEvent, Match
from symosc.crosschecks.frames import in_oscillator, own_frame, reduced_problem
from symosc.crosschecks.reading.objects import of_function
from symosc.crosschecks.reading.solutions import read_solutions
from symosc.crosschecks.report import CrossCheck, CrossChecks, check_all, shown
from symosc.crosschecks.samples import Samples, checked, checked_events
from symosc.crosschecks.verdict import CheckTask, judge
from symosc.model import Model, Oscillator
from symosc.reductions import OtherModel
from symosc.scenes import Scene, model_of, problem_of, scene_of
from symosc.simulation.batch import read_workers

__all__ = ["CrossCheck", "CrossChecks", "FoundEvent", "Match", "crosscheck"]

STEP_TOLERANCE = 1e-8


@public
def crosscheck(
    scene: Scene | Model | OtherModel | SceneName,
    t: SolutionLike,
    x: ArrayLike | Callable[..., Any] | None = None,
    v: ArrayLike | None = None,
    *,
    events: Iterable[tuple[float, str]] | None = None,
    tolerance: NumberLike = STEP_TOLERANCE,
    global_tolerance: NumberLike | None = None,
    own_start: bool = False,
    partial: bool = False,
    columns: Mapping[str, str | None] | None = None,
    workers: int | None = 1,
    progress: Progress | None = None,
) -> Any:
    """Compare one or several external solutions with the exact motion.

    Parameters
    ----------
    scene : Scene, str, Parameters, Oscillator or OtherModel
        With a scene the solution has to start where the scene does, or on its motion later, and to
        go on to its `t_end`. With Parameters, or a model, it starts at the first sample and may end
        anywhere. A solution of another model, or of its scene, is given in that model's coordinates;
        the answer shows those of the oscillator that it is, with the same errors, and a note says
        how they differ.
    t, x, v : array_like, shape (n,)
        Times, which may come twice where two pieces are joined, positions and velocities. Without
        `v` it is computed from `x`, and a note says so. `x` may be a function t -> (x, v), or a
        matrix of states, (n, 2) or (2, n). Or give `t` alone: whatever `symosc check` reads (a file,
        an OdeResult, a DataFrame, a function, ...), or a list of such: pieces of one solution, each
        beginning where one ends, or several solutions.
    events : pairs (t, kind), optional
        What the solver reported, in order of time; kind "cross", "stick", "slip" or "graze". Each
        exact event must be there once, as near in time as the tolerance and the errors of the
        samples let it; a graze, or a start on a belt, may be left out. Default: the events that the
        samples show, and those inside steps that are right. Times without kinds in a solver's
        result (`t_events`, or te and ie) claim less: an event function that finds contacts with a
        belt must have all of them, or all from one side, but no slips. One that finds any time at
        which v is not a belt's speed (x = 0) is left out. An empty list beside one of a belt is
        that of the other belt.
    tolerance : float
        Allowed defect of a step, relative to the largest |x| and |v| of the exact motion; a belt
        that it never meets does not count. A sample
        whose v differs from a belt's speed by less is on the belt. Samples with few digits (3
        decimals, single precision) that fail are judged once more at that precision; `rounded` and
        a note say so. Then half a unit of the last place of each sample is allowed beside the
        tolerance, and what the exact motion makes of such an error of the sample before. Spans of
        4, 16, 64, ... steps are judged in the same way.
    global_tolerance : float, optional
        Allowed global error, relative to the same values. Default: 1000 times `tolerance`, at most
        0.01; of rounded samples at most 5 last places, or 100 times `tolerance` where that is more.
        The rounding of the sample is allowed beside it, and what the exact motion makes of the
        rounding of the first sample.
    own_start, partial : bool
        Allow a solution of a scene that starts elsewhere, and one that ends before the scene's
        `t_end`.
    columns : mapping, optional
        Which columns of a file or a table are t, x, v and id: names, numbers from 1, or "NAME[i]" for
        a row or column of a matrix; "none" for no v. Default: those with usual names.
    workers, progress : int, callable or True, optional
        Processes for several solutions (None: all cores); what is called with the numbers of those
        done and of all.

    Returns
    -------
    CrossCheck, or CrossChecks (a list of these) for several solutions

    Notes
    -----
    With static friction, or friction that falls with the speed more steeply than the damper grows,
    errors may grow, and no solver stays near a chaotic motion for long. Every
    step is judged, against the exact motion from its first sample; a mass that a belt holds may not
    leave it by an error that is within the tolerance. Events, and the global error, are judged
    against the exact motion from the start until the solution's own error has grown: where exact
    motions that begin as near to an earlier sample move apart as far as the solution does, the exact
    motion from that sample takes the place of the first one, and a note says so. Errors that add up
    without growing remain faults, and so does another decision at a contact that the solution met
    within the tolerance of a step, such as a flight that goes on where the exact motion touches a
    belt and sticks.

    Raises
    ------
    ParameterError
        If something is no solution, times are not sorted, or one is repeated with another state.

    Examples
    --------
    >>> from symosc import crosscheck, simulate
    >>> crosscheck("fig5", simulate("fig5")).ok
    True
    """
    problem = problem_of(scene, "scene", any_law=True)
    own, t0 = own_frame(problem)
    scene = reduced_problem(problem)
    model = model_of(scene)
    is_plain = model.law.is_plain and len(model.law.belts) != 1
    if isinstance(model, Oscillator) and is_plain and model.contracts:
        scene = scene_of(scene, "scene")  # the same law as Parameters
    require(SOLUTION, t=t)
    require_or_none(*ARRAY_LIKE, function_of(None), x=x)
    require_or_none(*ARRAY_LIKE, v=v)
    require_or_none(sequence_of(row_of(2, REAL, TEXT), once=True), events=events)
    require(NUMBER, tolerance=tolerance)
    require_or_none(NUMBER, global_tolerance=global_tolerance)
    require(FLAG, own_start=own_start, partial=partial)
    require_or_none(mapping_of(TEXT, NONE), columns=columns)
    require_or_none(WHOLE, workers=workers)
    require_or_none(*PROGRESS, progress=progress)
    limit = None
    if global_tolerance is not None:
        limit = _positive("global_tolerance", global_tolerance)
    task = partial_of(
        CheckTask,
        scene=scene,
        tolerance=_positive("tolerance", tolerance),
        given_limit=limit,
        own_start=own_start,
        partial=partial,
    )
    solutions = _solutions(problem, t, x, v, events, columns)
    if own is not None:
        solutions = [in_oscillator(solution, own, t0) for solution in solutions]
    count = read_workers(workers)
    if len(solutions) == 1:
        return shown(judge(task(solutions[0])))
    return check_all(task, solutions, count, progress)


def _solutions(
    problem: Scene | Model | OtherModel,
    t: SolutionLike,
    x: ArrayLike | Callable[..., Any] | None,
    v: ArrayLike | None,
    events: Iterable[tuple[float, str]] | None,
    columns: Mapping[str, str | None] | None,
) -> list[Samples]:
    """Return the solutions that `crosscheck` is given."""
    if x is None and v is None:
        solutions = read_solutions(t, columns, problem)
    elif callable(x) and not hasattr(x, "__array__"):
        solutions = read_solutions(of_function(x, problem, t))
    elif v is None and len(getattr(x, "shape", ())) == 2:  # states, as ode45 returns them
        solutions = read_solutions({"t": t, "x": x}, None, problem)
    else:
        return [checked(t, x, v, events)]
    if events is None:
        return solutions
    if len(solutions) > 1:
        what = f"can be listed for one solution; there are {len(solutions)}"
        raise ParameterError("events", "given", what)
    return [replace(solutions[0], events=checked_events(events), lists=None)]


def _positive(name: str, value: object) -> float:
    """Return a tolerance as a float; raise ParameterError unless it is positive."""
    number = float(read_exact(name, value))
    if not number > 0.0:
        raise ParameterError(name, value, "must be > 0")
    return number
