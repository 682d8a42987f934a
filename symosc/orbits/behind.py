"""Which word a motion has just beyond the end of a branch."""

from __future__ import annotations

from math import pi

import numpy as np

from symosc.engine.state import REST
from symosc.errors import ParameterError
from symosc.orbits.branch import BranchPoint
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.curve import Curve
from symosc.orbits.guesses import (
    SETTLING_EVENTS,
    Passage,
    WordRun,
    follow,
    followed,
    rotated,
    settled_word,
    windows,
    without_word,
)
from symosc.orbits.newton import solve
from symosc.orbits.verification import failures
from symosc.words import Word, WordError, read_word

# How far beyond an end the words are looked for, as parts of the range: the nearest that is found counts.
DISTANCES = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5)
MOST_WORDS, MOST_GUESSES = 6, 4
LONGEST_WORD = 24  # mappings of a word that is tried


def look_behind(curve: Curve, point: BranchPoint, direction: float) -> tuple[str | None, str]:
    """Return the word of the orbit just beyond an end; or None and what the motion does there, "" if that is not known.

    The motion is simulated there from the orbit at the end, and the words that it goes through are solved for. One with
    an admissible orbit is the answer: with c > 0 there is no second one (`symosc.orbits.floquet`).
    """
    instead = ""
    for distance in DISTANCES:
        value = point.value + direction * distance * (curve.high - curve.low)
        if value == point.value:
            continue
        try:
            equations = curve.equations(value)
        except ParameterError:
            break
        x, theta = (float(value) for value in point.points[0])
        run = follow(equations, x, theta % (2 * pi), equations.pieces[0].start, SETTLING_EVENTS)
        found = _orbit_of(equations, run, float(np.abs(point.points[:, 0]).max()))
        if found is not None:
            return str(found), ""
        instead = instead or (without_word(equations, run) if run.code == REST else "")
    return None, instead


def _orbit_of(equations: ClosingEquations, run: WordRun, size: float) -> Word | None:
    """Return the word of an admissible orbit that a simulation comes near to."""
    settled = settled_word(equations, run)
    words = ([settled] if settled else []) + _words_of_a_period(equations, run.passages)
    for word in dict.fromkeys(words):
        trial = ClosingEquations(equations.parameters, word, equations.periods)
        found = windows(run.passages, word.labels, equations.periods, max(size, 1e-300))
        for guess in sorted(found, key=lambda each: each.defect)[:MOST_GUESSES]:
            solution = solve(trial, guess.points)
            if solution.converged and not failures(trial, solution.points):
                return word
    return None


def _words_of_a_period(equations: ClosingEquations, passages: list[Passage]) -> list[Word]:
    """Return the words that the simulation goes through in one period, the last ones first."""
    labels, found = followed(passages), []
    phases = np.array([passage.theta for passage in passages])
    turn = 2 * pi * equations.periods
    for last in range(len(labels), 0, -1):
        first = int(np.argmin(np.abs(phases - (phases[last] - turn))))
        part = labels[first:last]
        if not 0 < len(part) <= LONGEST_WORD or None in part or phases[last] - turn < phases[0] - 1:
            continue
        try:
            word = read_word(rotated(tuple(label for label in part if label), equations))
        except WordError:
            continue
        if word not in found:
            found.append(word)
        if len(found) >= MOST_WORDS:
            break
    return found
