"""First guesses for periodic orbits: what simulations do, and even spacing where they never do what the word says."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import cos, pi, sin
from typing import NamedTuple

import numpy as np

from symosc.aliases import Number
from symosc.engine.start import belt_start, belt_state
from symosc.engine.state import CROSS, END, FAILED, REST, SLIP, STICK, Covariance
from symosc.model import MODE_NAMES
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.floquet import rest_positions
from symosc.simulation.trajectory import MAP_LABELS
from symosc.words import Word

EVENTS_PER_PIECE, LEAST_RUN_EVENTS = 8, 60
MOST_GUESS_PERIODS = 1_000_000
SETTLING_EVENTS, SETTLED = 400, 1e-6
# Starts on each belt: fractions of a forcing period, and positions in units of the largest displacement expected.
START_PHASES, START_POSITIONS = 8, (0.0, -0.4, 0.4, -0.8, 0.8, -0.15, 0.15)
BATCH = 8


class Passage(NamedTuple):
    """An event of a simulation: position, phase (not wrapped), belt, and the mode after it."""

    x: float
    theta: float
    boundary: int
    mode: int


class Guess(NamedTuple):
    """Points (x, theta), after how many periods they are to close, and by how much they do not."""

    points: np.ndarray
    periods: int
    defect: float


class WordRun(NamedTuple):
    """A simulation from a start on a belt: the start and the events after it, and what the last step ended with."""

    passages: list[Passage]
    code: int


def follow(equations: ClosingEquations, x: float, theta: float, boundary: int, most: int) -> WordRun:
    """Follow the motion from a start on a belt for at most `most` events, in double precision."""
    K, turns = equations.K, int(theta // (2 * pi))
    start = belt_start(boundary, x, (sin(theta), cos(theta)), equations.arithmetic)
    angle = theta - 2 * pi * turns
    state = belt_state(start, (turns, angle), (sin(angle), cos(angle)), x, Covariance(0.0, 0.0, 0.0), K)
    passages, code = [Passage(x, theta, boundary, start.mode)], END
    for _ in range(20 * most):
        code, belt_met, _, _, state = equations.arithmetic.advance(state, MOST_GUESS_PERIODS * K.period, 0.0, K)
        if code in (CROSS, STICK, SLIP):
            passages.append(Passage(state.x, 2 * pi * state.n + state.theta, belt_met, state.mode))
        if code in (END, REST, FAILED) or len(passages) > most:
            break
    return WordRun(passages, code)


def followed(passages: list[Passage]) -> list[str | None]:
    """Return the mappings between the passages, in order of time."""
    return [MAP_LABELS.get((a.boundary, MODE_NAMES[a.mode], b.boundary)) for a, b in pairwise(passages)]


def settled_word(equations: ClosingEquations, run: WordRun) -> Word | None:
    """Return the word of the periodic motion that a simulation has settled to; None if it has not settled soon.

    It begins with the first mapping of the equations' word if it has that.
    """
    labels, last = followed(run.passages), run.passages[-1]
    for n in range(1, len(labels) // 2):
        before = run.passages[-1 - n]
        turn = last.theta - before.theta
        if turn > 2 * pi + SETTLED:
            break
        if abs(turn - 2 * pi) < SETTLED and labels[-n:] == labels[-2 * n : -n] and last.mode == before.mode:
            found = tuple(label for label in labels[-n:] if label)
            return rotated(found, equations) if len(found) == n else None
    return None


def rotated(labels: tuple[str, ...], equations: ClosingEquations) -> Word:
    """Return the word that repeats `labels`, begun with the first mapping of the equations' word if it has that."""
    first = equations.word.labels[0]
    begin = labels.index(first) if first in labels else 0
    return Word(labels[begin:] + labels[:begin])


def settles(equations: ClosingEquations, x: float, theta: float, boundary: int) -> str:
    """Say in words where the motion from a start on a belt settles; "" if it has not settled soon."""
    run = follow(equations, x, theta, boundary, SETTLING_EVENTS)
    word = settled_word(equations, run)
    if word is not None:
        return f"the motion settles to {word}"
    return without_word(equations, run) if run.code == REST else ""


def without_word(equations: ClosingEquations, run: WordRun) -> str:
    """Say in words where a motion without any further event ends up."""
    mode = run.passages[-1].mode
    if mode <= 3:
        return f"the motion ends up in Omega{mode} and meets no belt any more"
    positions = rest_positions(equations.parameters, mode - 3)
    if positions is None:
        return f"the motion ends up on belt {mode - 3} for ever"
    return f"the motion comes to rest on belt {mode - 3}, {between(positions)}"


def between(positions: tuple[Number, Number]) -> str:
    """Name an interval of positions of rest."""
    low, high = (f"{float(value):.6g}" for value in positions)
    return f"where every x from {low} to {high} is a position of rest"


def windows(passages: list[Passage], labels: tuple[str, ...], periods: int | None, size: float) -> list[Guess]:
    """Return every stretch of a simulation that follows the word, with how far it is from closing."""
    n = len(labels)
    done, found = followed(passages), []
    for k in range(len(done) - n + 1):
        if tuple(done[k : k + n]) != labels:
            continue
        first, last = passages[k], passages[k + n]
        turns = (last.theta - first.theta) / (2 * pi)
        count = periods or max(1, round(turns))
        shift = 2 * pi * (first.theta // (2 * pi))
        points = np.array([(p.x, p.theta - shift) for p in passages[k : k + n]])
        if points[-1, 1] - points[0, 1] < 2 * pi * count:
            defect = max(abs(last.x - first.x) / size, 2 * pi * abs(turns - count))
            found.append(Guess(points, count, float(defect)))
    return found


def largest_displacement(equations: ClosingEquations) -> tuple[float, float]:
    """Return the centre of the motion and the displacement from it that forces and resonance may bring (k > 0)."""
    K = equations.K
    reach = (abs(K.f0) + max(abs(K.A1 - K.A3), K.cm * max(abs(K.belt1.v), abs(K.belt2.v)))) / K.w0sq
    return 0.5 * (K.A1 + K.A3) / K.w0sq, float(max(reach, K.V0 / K.Om))


def from_simulations(equations: ClosingEquations, periods: int | None) -> Iterator[list[Guess]]:
    """Yield guesses from simulations that start on the word's belts, the most nearly closed first, batch by batch."""
    centre, size = largest_displacement(equations)
    boundaries = sorted({piece.start for piece in equations.pieces})
    most = max(LEAST_RUN_EVENTS, EVENTS_PER_PIECE * len(equations.pieces))
    starts = [
        (centre + offset * size, 2 * pi * j / START_PHASES, boundary)
        for offset in START_POSITIONS
        for j in range(START_PHASES)
        for boundary in boundaries
    ]
    for k in range(0, len(starts), BATCH):
        found: list[Guess] = []
        for x, theta, boundary in starts[k : k + BATCH]:
            run = follow(equations, x, theta, boundary, most)
            found += windows(run.passages, equations.word.labels, periods, size)
        yield sorted(found, key=lambda guess: guess.defect)


def evenly_spaced(equations: ClosingEquations, periods: int) -> list[Guess]:
    """Return guesses for a word that no simulation follows: even phases, positions of the steady motion."""
    centre, size = largest_displacement(equations)
    n = len(equations.pieces)
    found = []
    for j in range(2 * START_PHASES):
        theta = 2 * pi * (j / (2 * START_PHASES) + periods * np.arange(n) / n)
        for amplitude in (0.2, 0.6):
            points = np.column_stack([centre + amplitude * size * np.sin(theta), theta])
            found.append(Guess(points, periods, np.inf))
    return found
