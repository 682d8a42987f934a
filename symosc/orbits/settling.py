"""The orbit that a motion under any friction law settles to, and orbits with a given word.

A motion is looked at once a forcing period, or without a drive whenever it turns back. What it
repeats is a candidate; `orbit_near` makes an orbit of it. That the motion settles there is said only
if the motion comes nearer to it, or is on it already. Of many motions under a drive
`symosc.basins.recurrence` decides, by neighbourhoods of orbits and without their multipliers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import inf, pi, sqrt

import numpy as np

from symosc.base.aliases import Number
from symosc.derivatives.sensitivities import sensitivities
from symosc.model import Model
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.followed_orbit import FollowedOrbit
from symosc.orbits.rests import rest_at, rest_reached
from symosc.orbits.return_maps import SpeedSection
from symosc.orbits.shooting import free_period, orbit_near
from symosc.orbits.unsettled import Chaotic, QuasiPeriodic, unsettled_at
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory
from symosc.words import Word, first_of_cycle

#: MotionLoops, which are forcing periods or turns, after which a motion may have settled.
SETTLING_LOOPS = (60, 600, 4_000)
#: Events of a motion that is followed, at most.
MOST_EVENTS = 400_000
#: The most loops of an orbit that a motion settles to.
LONGEST = 1_000
#: A motion that is this near to where it was, as parts of its size and speed, may repeat itself.
REPEATS = 1e-3
#: Candidates from one stretch of a motion, at most.
MOST_CANDIDATES = 3
#: The motion is on an orbit at this distance; if it is farther away it has to come nearer.
ON_ORBIT = 1e-9
#: How often as far as it came nearer per loop an orbit may be.
REACH = 10.0
#: MotionLoops for which a motion is followed that should come nearer, at most, and by what factor.
MOST_WATCHED = 4_000
NEARER = 0.5
#: MotionLoops at the end of a motion from which its exponent is computed.
LOOPS_OF_EXPONENT = 200
#: Starts of motions that may follow a word: positions, in parts of the size that forces cause, and
#: phases, in parts of a turn.
POSITIONS = (0.0, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0)
PHASES = (0.0, 0.25, 0.5, 0.75)
LOOPS_OF_START = 40
CANDIDATES_OF_START = 2


@dataclass(frozen=True)
class MotionLoops:
    """A motion, and its states (t, x, v) once in each loop, after its first ones."""

    motion: Trajectory
    states: np.ndarray

    @property
    def sizes(self) -> np.ndarray:
        """The extents of the positions and velocities of the motion's last part."""
        times = np.linspace(self.states[0, 0], float(self.motion.t_end), 513)
        x, v = self.motion(times)
        return np.maximum([np.ptp(x), np.ptp(v)], 1e-300)

    def distances(self, state: np.ndarray) -> np.ndarray:
        """Return how far all states are from one, in parts of the sizes."""
        return np.abs((self.states[:, 1:] - state[1:]) / self.sizes).max(axis=1)


def settled_orbit_of(
    model: Model, t0: Number, x0: Number, v0: Number, digits: int | None = None
) -> FollowedOrbit:
    """Return the orbit or the rest that the motion from a start settles to.

    Raises
    ------
    ConvergenceError
        If the motion does not settle, as far as it is followed; the exponent says whether it is
        chaotic.
    """
    rest = rest_at(model, t0, x0, v0, digits)
    if rest is not None:
        return rest
    loops = None
    for count in SETTLING_LOOPS:
        loops = _loops(model, t0, x0, v0, count)
        if loops is None:
            rest = rest_reached(_followed(model, t0, x0, v0, count), digits)
            if rest is None:
                raise _not_found("the motion from this start is not decided in doubles")
            return rest
        for orbit in _candidates(model, loops, digits):
            if _is_reached(model, loops, orbit):
                return orbit
        if loops.motion.status == "max_events":
            break
    assert loops is not None
    raise _not_found(_unsettled_text(model, loops))


def _not_found(reason: str, word: str = "", periods: int = 1) -> ConvergenceError:
    return ConvergenceError(word, (), periods, inf, reason)


def loop_time(model: Model) -> float:
    """Return the time of a loop: a forcing period, or what a turn hardly exceeds."""
    if model.B0 != 0:
        return 2 * pi / float(model.Omega)
    return free_period(model)


def _followed(model: Model, t0: Number, x0: Number, v0: Number, count: int) -> Trajectory:
    """Return the motion from a start for so many loops."""
    end = float(t0) + count * loop_time(model)
    return simulate(model, t0=t0, x0=x0, v0=v0, t_end=end, max_events=MOST_EVENTS, accuracy=inf)


def _loops(model: Model, t0: Number, x0: Number, v0: Number, count: int) -> MotionLoops | None:
    """Return the last half of the motion from a start for so many loops; None if it comes to rest or
    is not decided.
    """
    motion = _followed(model, t0, x0, v0, count)
    if motion.status == "undecidable" or rest_reached(motion) is not None:
        return None
    if model.B0 != 0:
        turn = loop_time(model)
        span = float(motion.t_end) - float(motion.t_start)
        whole = int(span / turn)
        times = float(motion.t_start) + turn * np.arange(whole // 2, whole)
        return MotionLoops(motion, np.column_stack([times, motion(times).T]))
    section = SpeedSection(model, Fraction(0), upwards=False)
    motion = section.motion(t0, x0, v0, count * loop_time(model), MOST_EVENTS)
    if motion.status == "undecidable":
        return None
    turns = section.passages(motion)[-count:]
    states = np.array([(motion.events[n].t, motion.events[n].x, 0.0) for n in turns], dtype=float)
    return MotionLoops(motion, states[len(states) // 2 :])


def _candidates(model: Model, loops: MotionLoops, digits: int | None) -> Iterator[FollowedOrbit]:
    """Yield the orbits near the end of a motion that nearly repeats itself there."""
    if len(loops.states) < 2:
        return
    last = loops.states[-1]
    distances = loops.distances(last)[-2 : -2 - LONGEST : -1]
    tried = 0
    best = inf
    for n, distance in enumerate(distances.tolist(), 1):
        # A longer loop has to close better than the shorter ones.
        if distance > REPEATS or distance > best / REACH:
            continue
        best = max(distance, ON_ORBIT)
        tried += 1
        t, x, v = last.tolist()
        try:
            yield orbit_near(model, t, x, v, n if model.B0 != 0 else None, digits)
        except ConvergenceError:
            continue
        if tried == MOST_CANDIDATES:
            return


def _distance(model: Model, loops: MotionLoops, state: np.ndarray, orbit: FollowedOrbit) -> float:
    """Return how far a state is from an orbit, in parts of the sizes of the motion."""
    if model.B0 != 0:
        turn = loop_time(model)
        states = orbit(state[0] + turn * np.arange(max(orbit.periods, 1))).T
    else:
        x = _turns_of(orbit)
        states = np.column_stack([x, np.zeros(len(x))])
    return float(np.abs((states - state[1:]) / loops.sizes).max(axis=1).min())


def _turns_of(orbit: FollowedOrbit) -> list[float]:
    """Return the positions at which a cycle without a drive turns back."""
    if orbit.is_rest:
        return [float(orbit.start[1])]
    assert orbit.motion is not None
    section = SpeedSection(orbit.parameters, Fraction(0), upwards=False)
    t, x, v = orbit.start
    motion = section.motion(t, x, v, 1.01 * float(orbit.period))
    return [float(motion.events[n].x) for n in section.passages(motion)]


def _is_reached(model: Model, loops: MotionLoops, orbit: FollowedOrbit) -> bool:
    """Return whether a motion is on an orbit, or comes nearer to it."""
    state = loops.states[-1]
    before = _distance(model, loops, state, orbit)
    if before < ON_ORBIT:
        return True
    if orbit.stable is False:
        return False
    sizes = sorted(abs(complex(value)) for value in orbit.multipliers)
    if model.B0 != 0:
        largest = sizes[-1]
    else:
        largest = sizes[0]
    count = 1
    while largest**count > NEARER / 2 and count < MOST_WATCHED:
        count *= 2
    t, x, v = state.tolist()
    # An orbit of several loops is compared after each of them.
    later = _loops(model, t, x, v, 2 * count * max(orbit.periods, 1) + 2)
    if later is None or not len(later.states):
        return False
    return _distance(model, loops, later.states[-1], orbit) < max(NEARER * before, ON_ORBIT)


def _unsettled_text(model: Model, loops: MotionLoops) -> str:
    """Return the reason why no orbit is found: how long the motion was followed, and what it is
    instead, or its exponent.
    """
    followed = float(loops.motion.t_end) - float(loops.motion.t_start)
    text = f"the motion from this start does not settle within a time of {followed:.6g}"
    found = None
    if model.B0 != 0:
        found = unsettled_at(model, *loops.states[-1].tolist())
    if isinstance(found, Chaotic):
        about = f"the exponent {found.exponent:.3g} (+- {found.error:.1g})"
        return f"{text}: it is chaotic, with {about}"
    if isinstance(found, QuasiPeriodic):
        about = f"the second frequency {found.frequency:.8g} (+- {found.frequency_error:.1g})"
        return f"{text}: it is quasi-periodic, with {about}"
    state = loops.states[max(0, len(loops.states) - LOOPS_OF_EXPONENT)]
    t, x, v = state.tolist()
    end = float(loops.motion.t_end)
    changes = sensitivities(model, ("x0", "v0"), t0=t, x0=x, v0=v, t_end=end)
    return f"{text}; its exponent is {float(changes.lyapunov[0]):.3g}"


def orbit_of_labels(
    model: Model, word: Word, periods: int | None = None, digits: int | None = None
) -> FollowedOrbit:
    """Return an orbit with a word, looked for near simulated motions.

    Raises
    ------
    ConvergenceError
        If none is found; the reason names words of orbits that are.
    """
    labels = word.cycle.labels
    seen = dict[str, None]()
    for t, x, v in _starts(model):
        motion = _followed(model, t, x, v, LOOPS_OF_START)
        for state in _parts_with(motion, labels):
            try:
                orbit = orbit_near(model, *state, periods, digits)
            except ConvergenceError:
                continue
            if orbit.labels == labels:
                return orbit
            seen[orbit.word or "no word"] = None
    if seen:
        reason = f"motions with this word lead to {', '.join(seen)}"
    else:
        reason = "no motion follows it from the starts that were tried; give a guess"
    raise _not_found(reason, str(word.cycle), periods or 1)


def _starts(model: Model) -> Iterator[tuple[float, float, float]]:
    """Yield starts of motions: at rest, at several positions and phases."""
    forces = float(abs(model.B0)) + sum(
        float(model.law.kinetic(n) + model.law.excess(n)) for n in model.law.boundaries
    )
    resonance = float(abs(model.B0)) / max(float(model.c * model.Omega), float(model.k))
    speed = max(abs(float(belt.v)) for belt in model.law.belts) / sqrt(model.k / model.m)
    size = max(forces / float(model.k), resonance, speed)
    centre = float(model.A0 / model.k)
    phases = PHASES if model.B0 != 0 else PHASES[:1]
    for position, phase in product(POSITIONS, phases):
        yield phase * loop_time(model), centre + position * size, 0.0


def _parts_with(
    motion: Trajectory, labels: tuple[str, ...]
) -> Iterator[tuple[float, float, float]]:
    """Yield states from which a motion follows labels in any rotation, those first from which it
    closes best.
    """
    segments = [segment for segment in motion.segments if segment.label]
    n = len(labels)
    found = list[tuple[float, float]]()
    for i in range(len(segments) - n):
        part = [str(segment.label) for segment in segments[i : i + n]]
        first = first_of_cycle(part)
        if tuple(part[first:] + part[:first]) != labels:
            continue
        begin = float(segments[i].t_start)
        end = float(segments[i + n - 1].t_end)
        states = motion([begin, end])
        found.append((float(np.abs(states[:, 1] - states[:, 0]).max()), begin))
    for _, begin in sorted(found)[:CANDIDATES_OF_START]:
        x, v = motion(begin)
        yield begin, float(x), float(v)
