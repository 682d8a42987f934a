"""Find periodic orbits of any word and any number of forcing periods."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain, islice, pairwise, product
from math import ceil, floor, inf, pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import DataFrame, Number, NumberLike, Points
from symosc.base.arguments import NUMBER, TABLE_LIKE, WORD, public, require_or_none
from symosc.base.arrays import real_array
from symosc.base.errors import ParameterError
from symosc.base.exact import read_digits, read_exact, unmasked, whole_number
from symosc.engine.arithmetic import column_functions, mp_context
from symosc.engine.start import belt_start, belt_state
from symosc.engine.state import CROSS, END, FAILED, ON_BELT, REST, SLIP, STICK, Covariance
from symosc.friction import MODE_NAMES
from symosc.model import Model, Parameters
from symosc.orbits.admissibility import (
    FLIGHT_LASTS,
    STICK_LASTS,
    Condition,
    failures,
    grazing_distance,
)
from symosc.orbits.closing_equations import (
    ClosingEquations,
    ConvergenceError,
    Orbit,
    Solution,
    polish,
    solve,
)
from symosc.orbits.floquet import multipliers_of, rest_positions, stability_margin
from symosc.orbits.periodic_orbit import (
    PeriodicOrbit,
    SwitchingPoint,
    counted_periods,
    multiplier_text,
)
from symosc.orbits.settling import orbit_of_labels, settled_orbit_of
from symosc.orbits.shooting import orbit_near
from symosc.reductions import OtherModel
from symosc.scenes import ParametersLike, Scene, load_scene, model_of
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.loops import CHOICE
from symosc.simulation.problems import named
from symosc.simulation.trajectory import map_labels
from symosc.words import (
    PAIRED,
    Word,
    WordError,
    WordLike,
    first_of_cycle,
    of_belts,
    read_word,
    written,
)

# All switchings are solved for at once: much longer words would take minutes.
MOST_MAPPINGS = 40
# Roots of a repeated word whose points repeat within this (relative) are one orbit, run through
# several times.
SAME_ORBIT = 1e-7
LEAST_RUN_EVENTS = 60
# Words that are taken from the end of a simulated motion: the longest, and how many at most.
LONGEST_SIMULATED = 24
MOST_SIMULATED = 6
# How many guesses, those that close best, are solved from.
BEST_GUESSES = 4
SETTLING_EVENTS = 400
# The most forcing periods of an orbit. The search tries evenly spaced points over all of them;
# beyond these it takes minutes.
MOST_PERIODS = 200
#: Forcing periods by which the motion from rest may have settled.
SETTLING_PERIODS = (50, 1_000, 20_000)
# A motion is followed for at most so many forcing periods, and so many searches for each event.
MOST_PERIODS_FOLLOWED = 1e6
SEARCHES_PER_EVENT = 20
# Events that are nearer to each other than this part of the time are one in doubles.
ONE_EVENT = 2.0**-50
# A piece of a guess may be shorter than nothing by so much of the orbit's periods: it is about to
# vanish.
ROUNDED_TIMES = 1e-8
# Digits beyond those wanted with which an orbit is refined.
SPARE_DIGITS = 15


@public
def find_orbit(
    parameters: ParametersLike,
    word: WordLike | None = None,
    guess: PeriodicOrbit | ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    digits: int | None = None,
    *,
    periods: int | None = None,
    t0: NumberLike | None = None,
    x0: NumberLike | None = None,
    v0: NumberLike | None = None,
) -> PeriodicOrbit:
    """Find the periodic orbit to which a motion settles, or that with a given mapping structure.

    Parameters
    ----------
    parameters : Parameters or Oscillator, or a Scene, its name or its file
        With any friction law, and k > 0: without a spring nothing fixes the position of an orbit.
    word : str or sequence of str, optional
        The mapping structure, read right to left: "P32" is P2 first, then P3. Where there are not
        two belts the mappings are S, B, A, U and D with the numbers of belts (P1, P2 and P3 are
        read as S1, B1 and A1). All rotations of a word are one orbit: its word is `Word.cycle`, and
        its points begin where that does. None: the orbit to which the motion from the start
        settles, which has no word if it meets no belt; with a `guess` under a law that is not the
        paper's, the orbit near it.
    guess : optional
        None: from simulations. Or n pairs (t, x), one for each switching in order of time, from
        where `word` begins, or `Word.cycle` does. Or one
        pair (t, x) on the belt on which the word begins; the guess is simulated from there. Or a
        PeriodicOrbit of the same word. Under another law than the paper's, also three numbers
        (t, x, v), a state near the orbit, which may be unstable.
    digits : int, optional
        None: double precision. An int: that many correct digits (mpmath).
    periods : int, optional
        After how many forcing periods the orbit closes. Default: as the guess says.
    t0, x0, v0 : number, optional
        Where the motion starts that settles. Default: at 0; of a Scene whose law is not the
        paper's, its own start. One attracting orbit is reached from all starts, if c > 0 and the law
        `contracts`.

    Returns
    -------
    PeriodicOrbit
        Its `admissible` says whether it is an orbit; if the guess led to a root that is not an
        orbit, `failures` says why.

    Raises
    ------
    WordError
        If it is not a word, or its mappings cannot follow each other.
    ParameterError
        If the guess has a wrong shape, its times do not increase, or k = 0.
    ConvergenceError
        If no orbit was found; it carries the best points. Without a word: if the motion does not
        settle to an orbit; where it is chaotic the reason has its exponent.

    Notes
    -----
    With c > 0 and under a law that `contracts`, an admissible orbit is the only periodic motion. It
    attracts every other motion and has the period of the excitation. Other words, and more periods,
    only have roots that are not orbits. There is no orbit where the mass may rest for ever on a belt
    with the speed 0: those motions have no word (`symosc.orbits.floquet` has the proof). With c = 0
    there may be many orbits, and they may be marginal.

    With static friction, or friction that falls with speed, there may be several attracting orbits,
    unstable ones between them, orbits of several periods, and chaos. Without a drive (B0 = 0)
    motions settle to a limit cycle, whose period is found, or to a rest (`is_rest`).

    Every orbit that is called admissible was simulated over its period by the engine
    (`symosc.orbits.admissibility`, `symosc.orbits.shooting`).

    Examples
    --------
    >>> from symosc import find_orbit, load_scene
    >>> orbit = find_orbit(load_scene("fig9").parameters, "P32")
    >>> orbit.stable, f"{orbit.period:.6f}", [f"{t:.6f}" for t, x in orbit.points]
    (True, '1.570796', ['0.181670', '0.992371'])

    A mass on a running belt sticks and slips. If s and f are static and kinetic friction, v the speed
    of the belt, m = k = 1 and a = s - f, the period is 2 a/v + 2 pi - 2 atan(a/v).

    >>> from symosc import Belt, Oscillator
    >>> stick_slip = Oscillator(m=1, c=0, k=1, belts=[Belt("1/5", mu="1/2", mu_s=1)])
    >>> cycle = find_orbit(stick_slip)
    >>> cycle.word, f"{cycle.period:.9f}", cycle.stable
    ('S1∘B1', '8.902605408', True)
    """
    model = model_of(parameters, "parameters")
    require_or_none(WORD, word=word)
    require_or_none(PeriodicOrbit, *TABLE_LIKE, guess=guess)
    require_or_none(NUMBER, t0=t0, x0=x0, v0=v0)
    if periods is not None:
        periods = whole_number("periods", periods, 1, MOST_PERIODS)
    given = {"t0": t0, "x0": x0, "v0": v0}
    start = {name: value for name, value in given.items() if value is not None}
    if start and (word is not None or guess is not None):
        name = next(iter(start))
        allowed = f"must be omitted with a word or a guess: without them {name} starts the motion"
        raise ParameterError(name, start[name], allowed)
    if is_of_paper(model) and not (start or (word is None and guess is None and model.B0 == 0)):
        return _orbit_of_paper(model, word, guess, digits, periods)
    if model.k == 0:
        raise ParameterError("k", 0, NEEDS_SPRING)
    digits = read_digits(digits)
    if word is not None or guess is not None:
        return orbit_of_law(model, word, guess, digits, periods)
    if periods is not None:
        raise ParameterError("periods", periods, _requires_word("periods"))
    if not isinstance(parameters, Scene | Model | OtherModel):
        parameters = load_scene(parameters)
    begin, x, v = [
        getattr(parameters, name, 0) if value is None else read_exact(name, value)
        for name, value in given.items()
    ]
    orbit = settled_orbit_of(model, begin, x, v, digits)
    if is_of_paper(model) and orbit.labels and model.B0 != 0:
        with suppress(ConvergenceError):
            found = _orbit_of_paper(model, orbit.word, orbit.points, digits, orbit.periods)
            if found.admissible:
                return found
    return orbit


#: What is said of an oscillator without a spring.
NEEDS_SPRING = "must be > 0: without a spring nothing fixes the position of an orbit"


def is_of_paper(model: Model) -> bool:
    """Return whether the law is that of the paper: at most two belts with Coulomb friction."""
    return model.law.is_plain and not any(model.law.excess(n) for n in model.law.boundaries)


def _requires_word(name: str) -> str:
    """Return what is said of an argument that only counts with a word."""
    return f"{name} requires a word: without one the orbit is that of the settled motion"


def _orbit_of_paper(
    model: Model, word: WordLike | None, guess: Any, digits: int | None, periods: int | None
) -> PeriodicOrbit:
    """Return the orbit that `find_orbit` is asked for, under the paper's law."""
    belts = len(model.law.belts)
    if belts > 1:
        model = model.parameters
    if word is None:
        for name, value in (("guess", guess), ("periods", periods)):
            if value is not None:
                raise ParameterError(name, value, _requires_word(name))
        if model.c == 0:
            raise ParameterError(
                "word",
                None,
                "word is required without a damper: for c = 0 a motion need not settle; or give a "
                "start, x0 and v0",
            )
        try:
            orbit = settled_orbit(model.parameters, digits, belts=belts)
        except ConvergenceError as error:
            # The motion may meet no belt any more, or only graze one: there is no word to solve for.
            try:
                return settled_orbit_of(model, 0, 0, 0, digits)
            except ConvergenceError:
                raise error from None
    else:
        read = of_belts(read_word(word), belts)
        orbit = orbit_of_word(model.parameters, read, guess, digits, periods)
    return replace(orbit, parameters=model)


def orbit_of_law(
    model: Model, word: WordLike | None, guess: Any, digits: int | None, periods: int | None
) -> PeriodicOrbit:
    """Return an orbit under any law with a word, or near a guess."""
    given = None if word is None else read_word(word)
    read = None if given is None else of_belts(given, len(model.law.belts))
    if guess is None:
        assert given is not None
        assert read is not None
        try:
            return orbit_of_labels(model, read, periods, digits)
        except ConvergenceError as error:
            written = str(given.cycle)
            if written == error.word:
                raise
            reason = f"{error.reason}; {written} is {error.word} here, where words name belts"
            raise ConvergenceError(error.word, (), error.periods, inf, reason) from None
    if isinstance(guess, PeriodicOrbit):
        state = guess.start
        if model.B0 != 0:
            periods = periods or guess.periods
    else:
        state = _state_of_guess(model, read, guess)
    try:
        orbit = orbit_near(model, *state, periods, digits)
    except ParameterError as error:
        if error.name != "belts":
            raise
        # The section, a transparent belt of the oscillator, is as fast as the motion.
        said = "must be nearer to the orbit: beside its speeds those of the law are too close"
        raise ParameterError("guess", guess, said) from None
    if read is not None and orbit.labels != read.cycle.labels:
        reason = f"the guess leads to the orbit {orbit.word or 'without a belt'}"
        raise ConvergenceError(str(read.cycle), orbit.points, orbit.periods, inf, reason)
    return orbit


def _state_of_guess(model: Model, word: Word | None, guess: Any) -> tuple[Number, Number, Number]:
    """Return a state (t, x, v) from a guess: three numbers, or switching points of a word."""
    allowed = "must be an orbit, or a state (t, x, v) near the orbit"
    if word is not None:
        allowed += ", or pairs (t, x), the first where the word begins"
    if isinstance(guess, Mapping):
        guess = np.array([np.ravel(column) for column in guess.values()], dtype=object).T
    values = np.atleast_2d(real_array("guess", guess, allowed))
    if values.shape == (1, 3):
        t, x, v = values[0].tolist()
        return t, x, v
    if word is None or values.ndim != 2 or values.shape[1] != 2 or not len(values):
        shown = f"an array of shape {values.shape}" if values.size else guess
        raise ParameterError("guess", shown, allowed)
    t, x = values[0].tolist()
    return t, x, model.belt(word.maps[0].start.boundary)


def orbit_of_word(
    parameters: Parameters,
    word: WordLike,
    guess: PeriodicOrbit | ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    digits: int | None = None,
    periods: int | None = None,
) -> PeriodicOrbit:
    """Return the orbit with a word, or the root that is found in its place; see `find_orbit`."""
    own_word = read_word(word)
    cycle = own_word.cycle
    if len(cycle.labels) > MOST_MAPPINGS:
        reason = f"has {len(cycle.labels)} mappings; find_orbit accepts at most {MOST_MAPPINGS}"
        raise WordError(f"{str(cycle)[:20]}...", reason)
    if parameters.k == 0:
        raise ParameterError("k", 0, NEEDS_SPRING)
    digits = read_digits(digits)
    equations = ClosingEquations(parameters, cycle, periods or 1)
    if guess is None:
        guesses: Iterable[Guess] = chain(
            from_simulations(equations, periods), evenly_spaced(equations, periods or 1)
        )
    else:
        own = _read_guess(guess, ClosingEquations(parameters, own_word, periods or 1), periods)
        guesses = _rotations(own, own_word)
        if isinstance(guess, PeriodicOrbit):
            guesses.reverse()
    return orbit_at(*_best_root(equations, guesses), digits)


def _rotations(guess: Guess, word: Word) -> list[Guess]:
    """Return a guess with its points in the order of `word.cycle`, and as they are if `word` is
    another rotation: they may be those of an answer, in the order of its word.
    """
    first = first_of_cycle(word.labels)
    points = _begun_at(guess.points, first, 2 * pi * guess.periods)
    guesses = [guess._replace(points=points)]
    if first:
        guesses.append(guess)
    return guesses


def settled_orbit(
    parameters: Parameters,
    digits: int | None = None,
    most: int = SETTLING_PERIODS[-1],
    belts: int = 2,
) -> PeriodicOrbit:
    """Return the orbit to which the motion from t = x = v = 0 settles in `most` periods, or raise
    ConvergenceError.

    Its word is that of a law with so many `belts`: with one, the second belt of the parameters is
    out of reach.
    """
    reason = f"the motion from rest does not settle within {most:,} forcing periods"
    tried = [""]  # words; the last one is named in the error
    for periods in SETTLING_PERIODS:
        if periods > most:
            break
        end = 2 * pi * periods / float(parameters.Omega)
        word, trouble = _word_from_rest(parameters, end)
        word = str(of_belts(written(word), belts))
        if not trouble and word not in tried:
            tried.append(word)
            trouble = _too_close_text(parameters, end, len(written(word).labels) + 1)
            if not trouble:
                orbit = orbit_of_word(parameters, word, digits=digits)
                if orbit.admissible:
                    return orbit
        if trouble:  # more periods would not help
            reason = f"the motion from rest {trouble}"
            break
    raise ConvergenceError(tried[-1], (), 1, inf, reason)


def _word_from_rest(parameters: Parameters, end: float) -> tuple[str, str]:
    """Return the word of the motion from rest if it has settled by a time, else "".

    The second text says why there is no such word, "" if the motion may settle later.
    """
    summary = simulate_many(
        parameters, (0, 0, 0), end, record=("status", "t", "word", "multiplicity")
    )
    if summary.status[0] == "undecidable":
        return "", f"comes too near to a graze for doubles, at t = {summary.t[0]:.6g}"
    if not summary.multiplicity[0]:
        return "", ""
    word = str(summary.word[0])
    if not word:
        return "", "settles without meeting a belt"
    if len(word) > MOST_MAPPINGS + 1:
        length = f"{len(word) - 1} mappings a cycle"
        return "", f"has {length}, more than the {MOST_MAPPINGS} of a search"
    return word, ""


def _too_close_text(parameters: Parameters, end: float, count: int) -> str:
    """Return "" if doubles tell the last events of the motion from rest apart, else what they do
    not tell.
    """
    last = simulate_many(parameters, (0, 0, 0), end).t[-count:]
    if np.diff(last).min(initial=inf) > ONE_EVENT * end:
        return ""
    return f"comes too near to a graze: no stick has a length from t = {last[0]:.6g}"


class Root(NamedTuple):
    """A root of the closing equations, and what keeps it from being an orbit.

    `failed` tells whether conditions fail, `worst` by how much at most, and `repeats` whether the
    root runs through a shorter orbit.
    """

    failed: bool
    repeats: bool
    worst: float
    equations: ClosingEquations
    solution: Solution


def _best_root(
    equations: ClosingEquations, guesses: Iterable[Guess]
) -> tuple[ClosingEquations, Solution]:
    """Solve from each guess, and return the first admissible root that repeats no shorter orbit,
    with its equations; without one, the root nearest to an orbit.
    """
    roots: list[Root] = []
    best = None
    tried = equations
    for guess in guesses:
        tried = ClosingEquations(equations.parameters, equations.word, guess.periods)
        solution = solve(tried, guess.points)
        if not solution.converged:
            if best is None or solution.residual < best.residual:
                best = solution
            continue
        of_same_period = [root for root in roots if root.equations.periods == tried.periods]
        if any(_is_same_root(solution, root.solution) for root in of_same_period):
            continue
        failed = failures(tried, solution.points)
        repeats = repetitions(tried, solution.points) > 1
        # With damping there is no other orbit than one that is admissible, repeated or not.
        if not failed and (not repeats or tried.parameters.c > 0):
            return tried, solution
        worst = max((-c.value for c in failed), default=0.0)
        roots.append(Root(bool(failed), repeats, worst, tried, solution))
    if roots:
        return _first_root(roots)
    word = str(equations.word)
    if best is None:
        reason = "no guess was found"
    else:
        reason = best.reason
    instead = motion_instead(tried)
    if instead:
        reason += f"; {instead}"
    if best is None:
        raise ConvergenceError(word, (), 0, inf, reason)
    raise ConvergenceError(
        word, switching_points(tried, best.points), tried.periods, float(best.residual), reason
    )


def _first_root(roots: Sequence[Root]) -> tuple[ClosingEquations, Solution]:
    """Return the root nearest to an orbit; of roots that are equally near, the one that begins
    first.
    """
    # A symmetric oscillator has roots in pairs, whose conditions fail by the same but for rounding.
    failed, repeats, worst = min((root.failed, root.repeats, root.worst) for root in roots)
    near = [root for root in roots if (root.failed, root.repeats) == (failed, repeats)]
    near = [root for root in near if root.worst <= worst + SAME_ORBIT * max(worst, 1.0)]
    first = min(near, key=lambda root: _rounded_point(root.solution.points[0]))
    return first.equations, first.solution


def _rounded_point(point: Sequence[float] | np.ndarray) -> tuple[float, float]:
    """Return the phase within a turn and x of a switching point, rounded beyond their errors."""
    x, theta = (float(value) for value in point)
    # SAME_ORBIT is added so that a phase just below a whole turn counts as 0.
    return round((theta + SAME_ORBIT) % (2 * pi), 6), round(x, 6)


def _is_same_root(a: Solution, b: Solution) -> bool:
    """Return whether two roots are equal, except for whole turns of the phase."""
    off_x, off_theta = (np.asarray(a.points) - np.asarray(b.points)).T
    off_theta = off_theta - 2 * pi * np.round(off_theta[0] / (2 * pi))
    x, _ = np.abs(a.points).T
    is_same_x = np.abs(off_x) < SAME_ORBIT * max(1.0, x.max())
    is_same_theta = np.abs(off_theta) < SAME_ORBIT
    return bool(is_same_x.all() and is_same_theta.all())


def repetitions(equations: ClosingEquations, points: np.ndarray) -> int:
    """Return how many times a root runs through one shorter orbit; 1 if it does not."""
    n = len(points)
    labels = equations.word.labels
    points = np.asarray(points, dtype=float)
    x, _ = np.abs(points).T
    sizes = np.array([max(1.0, x.max()), 1.0])  # of x and of theta
    turn = float(equations.turn)
    for times in range(n, 1, -1):
        count = n // times  # pieces of the shorter orbit
        if n % times or equations.periods % times or labels != labels[:count] * times:
            continue
        # The points `count` pieces later, with one more turn where that is due: first one piece
        # later, then further ones.
        later = np.array(equations.ends(points))
        for _ in range(count - 1):
            later = np.vstack([later[1:], later[:1] + np.array([0.0, turn])])
        off = np.abs(later - points - [0.0, turn / times])
        if (off < SAME_ORBIT * sizes).all():
            return times
    return 1


def orbit_at(
    equations: ClosingEquations, solution: Solution, digits: int | None = None
) -> PeriodicOrbit:
    """Return the orbit that a root in double precision describes, refined to `digits` if given."""
    equations, double = _canonical(equations, np.array(solution.points, dtype=float))
    solution = replace(solution, points=double)
    failed = tuple(failures(equations, double))
    near = grazing_distance(equations, double)
    repeated = repetitions(equations, double)
    final = equations
    steps = solution.steps
    if digits is not None:
        final = equations.with_digits(digits + SPARE_DIGITS)
        solution = _refined(final, equations, double)
        steps += solution.steps

    def rounded(value: Number) -> Number:
        """Return a number of the answer with its digits: a double, or `digits` of them."""
        if digits is None:
            return value
        return +mp_context(digits).convert(value)

    first, second = multipliers_of(final, solution.points)
    if digits is None:
        values = (complex(first), complex(second))
    else:
        values = (rounded(first), rounded(second))
    gap = stability_margin(equations, double, values)
    if not failed and equations.parameters.c > 0:  # by proof (`symosc.orbits.floquet`)
        stable = True
    elif gap is None:
        stable = None
    else:
        stable = gap > 0
    if failed:
        message = _message_of_root(failed, motion_instead(equations, failed))
    else:
        message = _message_of_orbit(equations.periods, stable, gap, near, repeated)
    return PeriodicOrbit(
        parameters=equations.parameters,
        word=str(equations.word),
        labels=equations.word.labels,
        points=tuple(
            SwitchingPoint(*map(rounded, point))
            for point in switching_points(final, solution.points)
        ),
        period=rounded(final.turn / final.K.Om),
        periods=equations.periods,
        multipliers=values,
        stable=stable,
        residual=float(solution.residual),
        admissible=not failed,
        failures=failed,
        grazing_distance=near,
        message=message,
        steps=steps,
        digits=digits,
    )


def _refined(final: ClosingEquations, equations: ClosingEquations, double: np.ndarray) -> Solution:
    """Refine a root of `equations` in doubles to the digits of the equations `final`, or raise
    ConvergenceError.
    """
    solution = polish(final, double)
    if solution.converged:
        return solution
    best = switching_points(equations, solution.points)
    raise ConvergenceError(
        str(equations.word), best, equations.periods, float(solution.residual), solution.reason
    )


def _message_of_root(failed: Sequence[Condition], instead: str) -> str:
    """Return the message of a root that is not an orbit: why, and what the motion does instead."""
    texts = []
    for condition in failed:
        if _has_no_length(condition):
            failure = "it has no length"
        elif condition.value == 0:
            failure = "just fails"
        else:
            failure = f"fails by {-condition.value:.3g}"
        texts.append(f"{condition.text}: {failure} at t = {condition.t:.6g}")
    message = f"a root that is not an orbit ({'; '.join(texts)})"
    if instead:
        message += f"; {instead}"
    return message


def _message_of_orbit(
    periods: int, stable: bool | None, gap: float | None, near: float, repeated: int
) -> str:
    """Return the message of an orbit: its kind, its largest multiplier 1 - gap, and how far from
    grazing it is.
    """
    kind = {True: "a stable", False: "an unstable", None: "a marginal"}[stable]
    message = (
        f"{kind} orbit of {counted_periods(periods)}, largest |multiplier| {multiplier_text(gap)}"
    )
    if stable is None:
        message += " (no neighbour need come nearer)"
    if near < inf:
        message += f", {near:.3g} in velocity away from grazing"
    if repeated > 1:
        message += f"; it runs {repeated} times through a shorter orbit"
    return message


def _has_no_length(condition: Condition) -> bool:
    """Return whether a condition fails because a piece of the motion has no length."""
    return condition.value == 0 and condition.rank in (STICK_LASTS, FLIGHT_LASTS)


def _canonical(
    equations: ClosingEquations, points: np.ndarray
) -> tuple[ClosingEquations, np.ndarray]:
    """Return a root in the order of `Word.cycle`, begun in the first turn of the drive."""
    labels = equations.word.labels
    least = equations.word.cycle.labels
    # Several if the word repeats itself.
    starts = [i for i in range(len(labels)) if labels[i:] + labels[:i] == least]
    first = min(starts, key=lambda i: _rounded_point(points[i]))
    points = _begun_at(points, first, float(equations.turn))
    if first:
        equations = ClosingEquations(equations.parameters, equations.word.cycle, equations.periods)
    return equations, points - [0.0, 2 * pi * floor(points[0, 1] / (2 * pi))]


def _begun_at(points: np.ndarray, first: int, turn: float) -> np.ndarray:
    """Return the points (x, theta) of an orbit from the one with index `first` on.

    `turn` is the phase of the orbit's period.
    """
    return np.concatenate([points[first:], points[:first] + np.array([0.0, turn])])


def motion_instead(equations: ClosingEquations, failed: Sequence[Condition] = ()) -> str:
    """Simulate the motion that exists instead of an orbit with the word of the equations, and
    describe it; "" if nothing is known of it.

    If a piece has no length, as the conditions `failed` say, the mass may rest: positions of rest
    are then described without a simulation.
    """
    if any(map(_has_no_length, failed)):
        for boundary in {piece.start for piece in equations.pieces if piece.sticks}:
            if rest_positions(equations.parameters, boundary) is not None:
                return resting_text(equations.parameters, ON_BELT + boundary, "the mass stays")
    centre, size = largest_displacement(equations)
    once = ClosingEquations(equations.parameters, equations.word, 1)
    # Only a damper makes motions from elsewhere settle.
    limit = size if equations.parameters.c > 0 else None
    orbit, text = settling(once, centre, 0.0, equations.pieces[0].start, limit)
    if orbit:
        return f"the motion settles to {orbit.cycle}"
    return text


def switching_points(equations: ClosingEquations, points: Points) -> tuple[SwitchingPoint, ...]:
    """Convert points (x, theta) to switching points (t, x), in the arithmetic of the equations."""
    return tuple(
        SwitchingPoint(equations.number(theta / equations.K.Om), equations.number(x))
        for x, theta in points
    )


def _read_guess(guess: Any, equations: ClosingEquations, periods: int | None) -> Guess:
    """Read a guess given as all switching points, as one point to simulate from, or as an orbit."""
    n = len(equations.pieces)
    Omega = float(equations.parameters.Omega)
    if isinstance(guess, PeriodicOrbit):
        periods = periods or guess.periods
        guess = guess.points
    guess = named("guess", guess, ("t", "x"))
    if isinstance(guess, Mapping):
        columns = [np.ravel(unmasked("guess", column)) for column in guess.values()]
        guess = np.array(columns, dtype=object).T
    if isinstance(guess, list | tuple):
        for row in guess:
            unmasked("guess", row)
    allowed = f"must be {n} pairs (t, x), one for each switching, or one to start from"
    values = np.atleast_2d(real_array("guess", guess, allowed))
    if values.shape not in ((n, 2), (1, 2)):
        shown = f"an array of shape {values.shape}" if values.size else guess
        raise ParameterError("guess", shown, allowed)
    t, x = values.T
    theta = Omega * t
    if len(values) == 1:
        best = _guess_from_point(equations, x[0], theta[0], periods)
        if best is None:
            what = "the motion from this point never follows the word; give all switching points"
            raise ParameterError("guess", guess, what)
        return best
    count = periods or max(1, ceil((theta[-1] - theta[0]) / (2 * pi)))
    short = 2 * pi * count * ROUNDED_TIMES
    # If a piece is about to vanish all are made longer by `short`, so that none is negative.
    durations = np.diff(theta)
    if (durations > -short).all() and (durations <= 0).any():
        theta = np.maximum.accumulate(theta + short * np.arange(n))
    if (np.diff(theta) < 0).any() or theta[-1] - theta[0] >= 2 * pi * count:
        raise ParameterError(
            "guess", guess, f"the times must increase, and end within {counted_periods(count)}"
        )
    return Guess(np.column_stack([x, theta]), count, inf)


def _guess_from_point(
    equations: ClosingEquations, x: float, theta: float, periods: int | None
) -> Guess | None:
    """Return the part of the motion from one point that follows the word and closes best; None if
    no part follows it.
    """
    labels = equations.word.labels
    run = follow(equations, x, theta, equations.pieces[0].start, LEAST_RUN_EVENTS + len(labels))
    _, size = largest_displacement(equations)
    guesses = guesses_of_word(run, labels, periods, size)
    return min(guesses, key=lambda item: item.defect, default=None)


# -- guesses ---------------------------------------------------------------------------------------


#: Where simulations for guesses start: positions from the centre, in units of the largest
#: displacement expected, and the number of phases.
OFFSETS = (0.0, -0.4, 0.4, -0.8, 0.8, -0.15, 0.15)
PHASES = 8
STARTS_AT_ONCE = 8
#: How many times a simulation may run through the word.
RUN_CYCLES = 8
#: Guesses without a simulation: the number of phases of their first points, and the amplitudes, in
#: units of the largest displacement expected.
EVEN_PHASES = 16
EVEN_AMPLITUDES = (0.2, 0.6)


class Run(NamedTuple):
    """A simulated motion: its switching points (x, theta) and the mappings between them.

    Phases are not wrapped.
    """

    points: np.ndarray
    labels: list[str | None]
    mode: int  # after the last point
    rests: bool


class Guess(NamedTuple):
    """A guess of an orbit: points (x, theta), the number of periods after which they close, and the
    closing error.
    """

    points: np.ndarray
    periods: int
    defect: float


def follow(equations: ClosingEquations, x: float, theta: float, boundary: int, most: int) -> Run:
    """Follow the motion from a belt in doubles through `most` events, or until it comes to rest."""
    K = equations.K
    wave = equations.sin(theta), equations.cos(theta)
    start = belt_start(boundary, x, wave, equations.arithmetic)
    # A state has its phase as whole turns and an angle within a turn.
    turns = int(theta // (2 * pi))
    angle = theta - 2 * pi * turns
    wave = equations.sin(angle), equations.cos(angle)
    state = belt_state(start, (turns, angle), wave, x, Covariance(0.0, 0.0, 0.0), K)
    points = [(x, theta)]
    planes = [(boundary, start.mode)]  # the belt at each point, and the mode after it
    code = END
    loops = CHOICE.of_searches()
    constants = loops.constants([K])
    t_end = MOST_PERIODS_FOLLOWED * K.period
    motion = loops.motion(t_end, 0.0, t_end)
    motion.put(state)
    for _ in range(SEARCHES_PER_EVENT * most):  # searches that end without an event count too
        CHOICE.searches.events -= 1
        code, belt_met, _, _, _ = loops.search(motion.table, constants, 0)
        state = motion.state()
        if code in (CROSS, STICK, SLIP):
            points.append((state.x, 2 * pi * state.n + state.theta))
            planes.append((belt_met, state.mode))
        if code in (END, REST, FAILED) or len(points) > most:
            break
    names = map_labels(1 if equations.word.labels[0] in PAIRED else 2)
    labels = [
        names.get((begin, MODE_NAMES[mode], end)) for (begin, mode), (end, _) in pairwise(planes)
    ]
    _, last_mode = planes[-1]
    return Run(np.array(points), labels, last_mode, code == REST)


def settling(
    equations: ClosingEquations, x: float, theta: float, boundary: int, size: float | None
) -> tuple[Orbit | None, str]:
    """Return the admissible orbit that the motion from a belt approaches and "", or None and a text
    that says where the motion comes to rest ("" if it does not).

    `size` is the magnitude of the positions on the orbit; if it is None, no orbit is looked for.
    """
    run = follow(equations, x, theta, boundary, SETTLING_EVENTS)
    words = [] if size is None else _words_of_a_period(equations, run)
    for word in words:
        trial = ClosingEquations(equations.parameters, word, equations.periods)
        guesses = guesses_of_word(run, word.labels, equations.periods, max(size or 0.0, 1e-300))
        for guess in sorted(guesses, key=lambda item: item.defect)[:BEST_GUESSES]:
            solution = solve(trial, guess.points)
            if solution.converged and not failures(trial, solution.points):
                return Orbit(word, equations.periods, solution.points), ""
    return None, resting_text(equations.parameters, run.mode) if run.rests else ""


def _words_of_a_period(equations: ClosingEquations, run: Run) -> list[Word]:
    """Return the words that a simulated motion runs through in one period of an orbit, the latest
    first.
    """
    begin = equations.word.labels[0]
    words = list[Word]()
    _, phases = run.points.T
    labels = run.labels
    turn = 2 * pi * equations.periods
    for last in range(len(labels), 0, -1):
        # The point one period before the last one.
        begins_at = phases[last] - turn
        first = int(np.argmin(np.abs(phases - begins_at)))
        of_period = tuple(label for label in labels[first:last] if label)
        if not 0 < len(of_period) <= LONGEST_SIMULATED:
            continue
        has_unknown = len(of_period) < last - first
        begins_too_early = begins_at < phases[0] - 1  # before the run, by more than this phase
        if has_unknown or begins_too_early:
            continue
        # Words begin as that of the equations does, if possible.
        if begin in of_period:
            i = of_period.index(begin)
        else:
            i = 0
        with suppress(WordError):
            word = read_word(Word(of_period[i:] + of_period[:i]))
            if word not in words:
                words += [word]
        if len(words) >= MOST_SIMULATED:
            break
    return words


def resting_text(
    parameters: Parameters, mode: int, beginning: str = "the motion comes to rest"
) -> str:
    """Describe where a motion ends that stays in `mode` for ever; if it can rest in an interval,
    with `beginning` as the first words.
    """
    if mode <= ON_BELT:
        return f"the motion ends up in Omega{mode} and meets no belt any more"
    belt = mode - ON_BELT
    positions = rest_positions(parameters, belt)
    if positions is None:
        return f"the motion ends up on belt {belt} for ever"
    low, high = (f"{float(value):.6g}" for value in positions)
    return f"{beginning} on belt {belt}, where every x from {low} to {high} is a position of rest"


def guesses_of_word(
    run: Run, labels: tuple[str, ...], periods: int | None, size: float
) -> list[Guess]:
    """Return a guess from each part of the motion `run` that follows the mappings `labels`, with
    its closing error.
    """
    n = len(labels)
    guesses = []
    for k in range(len(run.labels) - n + 1):
        if tuple(run.labels[k : k + n]) != labels:
            continue
        # How far the motion is, n mappings later, from where it was.
        dx, dtheta = (run.points[k + n] - run.points[k]).tolist()
        turns = dtheta / (2 * pi)
        count = periods or max(1, round(turns))
        x, theta = run.points[k : k + n].T
        theta = theta - 2 * pi * (theta[0] // (2 * pi))
        if theta[-1] - theta[0] < 2 * pi * count:
            defect = max(abs(dx) / size, 2 * pi * abs(turns - count))
            guesses.append(Guess(np.column_stack([x, theta]), count, defect))
    return guesses


def largest_displacement(equations: ClosingEquations) -> tuple[float, float]:
    """Return the centre of the motion, and the largest displacement that forces or resonance can
    cause (k > 0).
    """
    K = equations.K
    damping = K.cm * max(abs(K.belt1.v), abs(K.belt2.v))
    by_forces = (abs(K.f0) + max(abs(K.A1 - K.A3), damping)) / K.w0sq
    by_resonance = K.V0 / K.Om  # V0 is the velocity's amplitude in the steady motion
    centre = 0.5 * (K.A1 + K.A3) / K.w0sq
    return centre, float(max(by_forces, by_resonance))


def from_simulations(equations: ClosingEquations, periods: int | None) -> Iterator[Guess]:
    """Yield guesses from simulated motions that start on the word's belts: of every STARTS_AT_ONCE
    starts the BEST_GUESSES best.
    """
    centre, size = largest_displacement(equations)
    boundaries = sorted({piece.start for piece in equations.pieces})
    most = max(LEAST_RUN_EVENTS, RUN_CYCLES * len(equations.pieces))
    starts = product(OFFSETS, range(PHASES), boundaries)
    while batch := list(islice(starts, STARTS_AT_ONCE)):
        guesses: list[Guess] = []
        for offset, j, boundary in batch:
            run = follow(equations, centre + offset * size, 2 * pi * j / PHASES, boundary, most)
            guesses += guesses_of_word(run, equations.word.labels, periods, size)
        yield from sorted(guesses, key=lambda guess: guess.defect)[:BEST_GUESSES]


def evenly_spaced(equations: ClosingEquations, periods: int) -> Iterator[Guess]:
    """Yield guesses for a word that no simulation follows: equally spaced phases on a harmonic
    motion.
    """
    (centre, size) = largest_displacement(equations)
    n = len(equations.pieces)
    for j, amplitude in product(range(EVEN_PHASES), EVEN_AMPLITUDES):
        theta = 2 * pi * (j / EVEN_PHASES + periods * np.arange(n) / n)
        x = centre + amplitude * size * column_functions()["sin"](theta)
        yield Guess(np.column_stack([x, theta]), periods, inf)
