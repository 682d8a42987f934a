"""Finding periodic orbits of any mapping structure and any number of forcing periods."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, floor, inf, pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import DataFrame, Points
from symosc.arguments import public
from symosc.engine.arithmetic import mp_context
from symosc.errors import ParameterError
from symosc.exact import read_digits, unmasked, whole_number
from symosc.mappings.arguments import text_or_booleans
from symosc.model import Parameters
from symosc.orbits.admissibility import FLIGHT_LASTS, STICK_LASTS, Condition, grazing_distance
from symosc.orbits.closing_equations import ClosingEquations, ConvergenceError
from symosc.orbits.floquet import inside, monodromy, multipliers, rest_positions
from symosc.orbits.guesses import (
    LEAST_RUN_EVENTS,
    Guess,
    between,
    evenly_spaced,
    follow,
    from_simulations,
    largest_displacement,
    settles,
    windows,
)
from symosc.orbits.newton import Solution, polish, solve
from symosc.orbits.periodic_orbit import Approach, PeriodicOrbit, SwitchingPoint
from symosc.orbits.verification import failures
from symosc.simulation.problems import named
from symosc.words import Word, WordError, WordLike, read_word

__all__ = ["Approach", "PeriodicOrbit", "SwitchingPoint", "find_orbit"]

ORBIT_GUARD_DIGITS = 15
TRIES_PER_BATCH = 4
# The search tries evenly spaced points over all periods; beyond these it takes minutes.
MOST_ORBIT_PERIODS = 200
# All switchings are solved for at once: much longer words would take minutes.
MOST_MAPPINGS = 40
# Pieces of a guess that are shorter than this part of a period are taken to be about to vanish.
SHORTEST_PIECE = 1e-8
# Roots of a repeated word whose points repeat within this (relative) are one orbit, run through several times.
SAME_ORBIT = 1e-7


@public
def find_orbit(
    parameters: Parameters,
    word: WordLike,
    guess: PeriodicOrbit | ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    digits: int | None = None,
    *,
    periods: int | None = None,
) -> PeriodicOrbit:
    """Find the periodic orbit with a given mapping structure.

    Parameters
    ----------
    parameters : Parameters
        With k > 0: without a spring nothing fixes the position of an orbit.
    word : str or sequence of str
        The mapping structure, read right to left: "P32" is P2 first, then P3.
    guess : optional
        None: from simulations. Or n pairs (t, x), one for each switching in order of time. Or one pair (t, x) on the
        belt on which the word begins; the guess is simulated from there. Or a PeriodicOrbit of the same word.
    digits : int, optional
        None: double precision. An int: that many correct digits (mpmath).
    periods : int, optional
        After how many forcing periods the orbit closes. Default: as the guess says.

    Returns
    -------
    PeriodicOrbit
        Its `admissible` says whether it is an orbit; if the guess led to a root that is not an orbit, `failures` says
        why.

    Raises
    ------
    WordError
        If it is not a word, or its mappings cannot follow each other.
    ParameterError
        If the guess has a wrong shape, its times do not increase, or k = 0.
    ConvergenceError
        If no root was found; it carries the best points.

    Notes
    -----
    With c > 0 an admissible orbit is the only periodic motion. It attracts every other motion and has the period of the
    excitation. Other words, and more periods, only have roots that are not orbits. There is no orbit where the mass may
    rest for ever on a belt with the speed 0: those motions have no word (`symosc.orbits.floquet` has the proof). With c
    = 0 there may be many orbits, and they may be marginal.

    Every orbit that is called admissible was simulated over its period by the engine (`symosc.orbits.verification`).

    Examples
    --------
    >>> from symosc import find_orbit, load_scene
    >>> orbit = find_orbit(load_scene("fig9").parameters, "P32")
    >>> orbit.stable, f"{orbit.period:.6f}", [f"{t:.6f}" for t, x in orbit.points]
    (True, '1.570796', ['0.181670', '0.992371'])
    """
    found = _read_word(word)
    _check_parameters(parameters)
    periods = None if periods is None else whole_number("periods", periods, 1, MOST_ORBIT_PERIODS)
    digits = read_digits(digits)
    equations = ClosingEquations(parameters, found, periods or 1)
    batches = iter([[_read_guess(guess, equations, periods)]]) if guess is not None else _guesses(equations, periods)
    root = _best_root(equations, batches)
    return orbit_at(root[0], root[1], digits)


def _read_word(word: Any) -> Word:
    """Return a word that is short enough to look for its orbit."""
    found = read_word(word)
    if len(found.labels) > MOST_MAPPINGS:
        reason = f"has {len(found.labels)} mappings; orbits of at most {MOST_MAPPINGS} are looked for"
        raise WordError(f"{str(found)[:20]}...", reason)
    return found


def _check_parameters(parameters: Parameters) -> None:
    """Raise ParameterError unless these are Parameters with a spring."""
    if parameters.k == 0:
        raise ParameterError("k", 0, "must be > 0: without a spring nothing fixes the position of an orbit")


def _guesses(equations: ClosingEquations, periods: int | None) -> Iterator[list[Guess]]:
    for batch in from_simulations(equations, periods):
        yield batch[:TRIES_PER_BATCH]
    yield evenly_spaced(equations, periods or 1)


def _best_root(equations: ClosingEquations, batches: Iterator[list[Guess]]) -> tuple[ClosingEquations, Solution]:
    """Return the first admissible root, else the one that fails least, one that repeats a shorter word last."""
    roots: list[tuple[tuple[bool, bool, float], ClosingEquations, Solution]] = []
    best: Solution | None = None
    tried = equations
    for batch in batches:
        for guess in batch:
            tried = ClosingEquations(equations.parameters, equations.word, guess.periods)
            solution = solve(tried, guess.points)
            if not solution.converged:
                best = solution if best is None or solution.residual < best.residual else best
                continue
            if any(_same(tried, solution, others, other) for _, others, other in roots):
                continue
            failed = failures(tried, solution.points)
            repeats = repetitions(tried, solution.points) > 1
            if not failed and (not repeats or tried.parameters.c > 0):  # with damping there is no other
                return tried, solution
            rank = (bool(failed), repeats, max((-c.value for c in failed), default=0.0))
            roots.append((rank, tried, solution))
    if roots:
        return min(roots, key=lambda root: root[0])[1:]
    word = str(equations.word)
    if best is None:
        raise ConvergenceError(word, (), 0, inf, f"no guess was found{_instead(tried)}")
    points = tuple(switching_points(tried, best.points))
    raise ConvergenceError(word, points, tried.periods, float(best.residual), best.reason + _instead(tried))


def _same(equations: ClosingEquations, a: Solution, others: ClosingEquations, b: Solution) -> bool:
    """Return whether two roots are the same, apart from whole turns."""
    if equations.periods != others.periods:
        return False
    away = np.asarray(a.points) - np.asarray(b.points)
    away[:, 1] -= 2 * pi * np.round(away[0, 1] / (2 * pi))
    return bool((np.abs(away) < SAME_ORBIT * np.array([max(1.0, np.abs(a.points[:, 0]).max()), 1.0])).all())


def repetitions(equations: ClosingEquations, points: np.ndarray) -> int:
    """Return how often the root runs through one and the same shorter orbit."""
    n, labels = len(points), equations.word.labels
    points = np.asarray(points, dtype=float)
    size = np.array([max(1.0, np.abs(points[:, 0]).max()), 1.0])
    for times in range(n, 1, -1):
        if n % times or equations.periods % times or labels != labels[: n // times] * times:
            continue
        later = np.array(equations.ends(points))  # the points one piece later, with one more turn where that is due
        for _ in range(n // times - 1):
            later = np.vstack([later[1:], later[:1] + np.array([0.0, float(equations.turn)])])
        if (np.abs(later - points - [0.0, float(equations.turn) / times]) < SAME_ORBIT * size).all():
            return times
    return 1


def orbit_at(equations: ClosingEquations, solution: Solution, digits: int | None = None) -> PeriodicOrbit:
    """Return the orbit of a root in double precision, polished to `digits`."""
    turns = 2 * pi * floor(solution.points[0][1] / (2 * pi))
    solution.points = np.array(solution.points, dtype=float) - [0.0, turns]
    failed = tuple(failures(equations, solution.points))
    double = solution.points
    near = grazing_distance(equations, double)
    repeated = repetitions(equations, solution.points)
    final, steps = equations, solution.steps
    if digits is not None:
        final = ClosingEquations(equations.parameters, equations.word, equations.periods, digits + ORBIT_GUARD_DIGITS)
        solution = polish(final, solution.points)
        if not solution.converged:
            best = tuple(switching_points(equations, solution.points))
            raise ConvergenceError(
                str(equations.word), best, equations.periods, float(solution.residual), solution.reason
            )
        steps += solution.steps
    flow = monodromy(final, solution.points)
    values = multipliers(flow.trace, flow.determinant, final.complex_root)
    points: Sequence[SwitchingPoint] = switching_points(final, solution.points)
    period = final.turn / final.K.Om
    if digits is not None:
        context = mp_context(digits)
        points = [SwitchingPoint(*(+context.convert(value) for value in point)) for point in points]
        period = +context.convert(period)
        values = (+context.convert(values[0]), +context.convert(values[1]))
    else:
        values = (complex(values[0]), complex(values[1]))
    gap = inside(equations, double, values)
    stable = True if not failed and equations.parameters.c > 0 else None if gap is None else gap > 0
    word = str(equations.word)
    return PeriodicOrbit(
        parameters=equations.parameters,
        word=word,
        labels=equations.word.labels,
        points=tuple(points),
        period=period,
        periods=equations.periods,
        multipliers=values,
        stable=stable,
        residual=float(solution.residual),
        admissible=not failed,
        failures=failed,
        grazing_distance=near,
        message=_message(equations, stable, gap, failed, near, repeated),
        steps=steps,
        digits=digits,
    )


def _message(
    equations: ClosingEquations,
    stable: bool | None,
    gap: float | None,
    failed: tuple[Condition, ...],
    near: float,
    repeated: int,
) -> str:
    if failed:
        what = "; ".join(map(_failure, failed))
        zero = any(c.value == 0 and c.rank in (STICK_LASTS, FLIGHT_LASTS) for c in failed)
        return f"a root that is not an orbit ({what}){_instead(equations, zero)}"
    periods = equations.periods
    kind = {True: "a stable", False: "an unstable", None: "a marginal"}[stable]
    text = f"{kind} orbit of {periods} forcing period{'s' if periods > 1 else ''}"
    text += f", largest |multiplier| {_size(gap)}"
    text += " (no neighbour need come nearer)" if stable is None else ""
    if near < inf:
        text += f", {near:.3g} in velocity away from grazing"
    return text + (f"; it runs {repeated} times through a shorter orbit" if repeated > 1 else "")


def _failure(condition: Condition) -> str:
    if condition.value == 0:
        lasts = condition.rank in (STICK_LASTS, FLIGHT_LASTS)
        return f"{condition.text}: {'it has no length' if lasts else 'just fails'} at t = {condition.t:.6g}"
    return f"{condition.text}: fails by {-condition.value:.3g} at t = {condition.t:.6g}"


def _size(gap: float | None) -> str:
    """Return 1 - gap, written so that it differs from 1."""
    if gap is None:
        return "1"
    return f"{1 - gap:.6g}" if abs(gap) > 1e-5 else f"1 {'-' if gap > 0 else '+'} {abs(gap):.3g}"


def _instead(equations: ClosingEquations, resting: bool = False) -> str:
    """Say how the motion at these parameters ends; `resting`: the root is a stick that may last for ever."""
    for boundary in {piece.start for piece in equations.pieces if piece.sticks and resting}:
        positions = rest_positions(equations.parameters, boundary)
        if positions is not None:
            return f"; the mass stays on belt {boundary}, {between(positions)}"
    found = settles(equations, largest_displacement(equations)[0], 0.0, equations.pieces[0].start)
    return f"; {found}" if found else ""


def switching_points(equations: ClosingEquations, points: Points) -> list[SwitchingPoint]:
    """Return (t, x) from (x, theta)."""
    number = float if equations.exact is None else equations.exact
    return [SwitchingPoint(number(theta / equations.K.Om), number(x)) for x, theta in points]


def _read_guess(guess: Any, equations: ClosingEquations, periods: int | None) -> Guess:
    """Return a guess given as points, as a start or as an orbit."""
    n, Omega = len(equations.pieces), float(equations.parameters.Omega)
    if isinstance(guess, PeriodicOrbit):
        periods, guess = periods or guess.periods, guess.points
    guess = unmasked("guess", named("guess", guess, ("t", "x")))
    try:
        if isinstance(guess, Mapping):
            guess = np.column_stack([np.atleast_1d(unmasked("guess", column)) for column in guess.values()])
        if text_or_booleans(guess):
            raise TypeError
        rows = np.atleast_2d(np.array(guess, dtype=object))
        if rows.ndim > 2:
            raise TypeError
        values = np.array([[float(value) for value in unmasked("guess", list(row))] for row in rows])
    except (TypeError, ValueError, OverflowError):
        values = np.zeros((0, 0))
    if values.shape not in ((n, 2), (1, 2)) or not np.isfinite(values).all():
        shape = f"an array of shape {values.shape}" if values.size else guess
        raise ParameterError("guess", shape, f"must be {n} pairs (t, x), one for each switching, or one to start from")
    theta = Omega * values[:, 0]
    if len(values) == 1:
        run = follow(equations, values[0, 1], theta[0], equations.pieces[0].start, LEAST_RUN_EVENTS + n)
        found = windows(run.passages, equations.word.labels, periods, largest_displacement(equations)[1])
        if not found:
            raise ParameterError("guess", guess, "the motion from there never follows the word; give all switchings")
        return min(found, key=lambda each: each.defect)
    count = periods or max(1, ceil((theta[-1] - theta[0]) / (2 * pi)))
    short = 2 * pi * count * SHORTEST_PIECE
    if (np.diff(theta) > -short).all():  # a piece without length is one at whose birth the orbit is
        theta = np.maximum.accumulate(theta + short * np.arange(n)) if (np.diff(theta) <= 0).any() else theta
    if (np.diff(theta) < 0).any() or theta[-1] - theta[0] >= 2 * pi * count:
        raise ParameterError("guess", guess, f"its times must increase, and end within {count} forcing period(s)")
    return Guess(np.column_stack([values[:, 1], theta]), count, inf)
