"""The margins of an orbit of any friction law, computed from its motion.

They are differences in velocity between the turns of flights and the belts, forces where belts are
met and during sticks, and the lengths of pieces.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from symosc.orbits.admissibility import (
    ARRIVAL,
    BIRTH,
    FLIGHT_LASTS,
    FLIGHT_VANISHING,
    GRAZING,
    HOLD,
    PASSING,
    SLIP_BIRTH,
    SLIP_VANISHING,
    STAYS_INSIDE,
    STICK_LASTS,
    VANISHING,
    Condition,
)
from symosc.orbits.followed_orbit import FollowedOrbit, points_of, vertex_of

#: Samples of each piece of an orbit.
SAMPLES = 256


def margins(orbit: FollowedOrbit, sticks: bool = True) -> list[Condition]:
    """Return the inequalities that make a motion the orbit, with their values and scales: those of
    the forces during sticks only if asked for.
    """
    found = _margins(orbit, sticks)
    return sorted(found, key=lambda condition: condition.value / condition.scale)


def _margins(orbit: FollowedOrbit, with_sticks: bool) -> Iterator[Condition]:
    motion = orbit.motion
    assert motion is not None
    law = motion.parameters.law
    m = float(motion.parameters.m)
    span = float(orbit.period)
    pieces = points_of(motion)
    begin = float(motion.t_start)

    def states(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        wrapped = begin + (times - begin) % span
        x, v = motion(wrapped)
        return x, v

    whole = begin + span * np.arange(4 * SAMPLES) / (4 * SAMPLES)
    _, v_whole = states(whole)
    speed = float(np.ptp(v_whole)) or 1.0
    pace = float(np.abs(np.diff(v_whole)).max()) / (span / len(whole)) or 1.0
    lag = float(orbit.start[0]) - begin  # from times of the motion to those of the orbit

    def forces(belt: int, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what pushes the mass up from the belt, and down: static friction included."""
        at = begin + (times - begin) % span
        excess = float(law.excess(belt)) / m
        return motion.force(belt + 1, at) - excess, -(motion.force(belt, at) + excess)

    if not pieces:
        yield from _turns(orbit, 0, whole[:-1], v_whole[:-1], speed, lag, None)
        return
    for i, (event, after) in enumerate(pieces):
        start = float(event.t)
        end = float(after.t)
        if end <= start:
            end += span
        length = end - start
        shown = start + lag
        sticks = event.target.startswith("belt")
        name = f"{orbit.labels[i]}" if i < len(orbit.labels) else ""
        if sticks:
            text, kind, rank = f"{name} lasts", VANISHING, STICK_LASTS
        elif event.source.startswith("belt") and after.boundary == event.boundary:
            text, kind, rank = f"{name} lasts", SLIP_VANISHING, FLIGHT_LASTS
        else:
            text, kind, rank = f"{name} lasts", FLIGHT_VANISHING, FLIGHT_LASTS
        yield Condition(i, text, length, shown, kind, rank, span)
        if sticks and not with_sticks:
            continue
        if sticks:
            times = start + length * np.arange(1, SAMPLES) / SAMPLES
            up, down = forces(event.boundary, times)
            leaves_up = after.target == f"Omega{event.boundary + 1}"
            exit_side, other = (up, down) if leaves_up else (down, up)
            text = f"{name} holds against the other side"
            worst = int(other.argmax())
            yield Condition(
                i, text, float(-other[worst]), float(times[worst]) + lag, SLIP_BIRTH, HOLD, pace
            )
            inner = [
                n for n in range(1, len(times) - 1)
                if exit_side[n] > exit_side[n - 1] and exit_side[n] >= exit_side[n + 1]
            ]  # fmt: skip
            for n in inner:
                text = f"{name} holds until its end"
                yield Condition(
                    i, text, float(-exit_side[n]), float(times[n]) + lag, SLIP_BIRTH, HOLD, pace
                )
            continue
        times = start + length * np.linspace(0.0, 1.0, SAMPLES)
        inside = np.clip(times, start + 1e-12 * span, end - 1e-12 * span)
        _, v = states(inside)
        domain = int(event.target.removeprefix("Omega"))
        yield from _turns(orbit, i, times, v, speed, lag, domain)
        pushes = forces(after.boundary, np.array([end]))
        push_up, push_down = (float(push[0]) for push in pushes)
        excess = float(law.excess(after.boundary)) / m
        from_below = after.source == f"Omega{after.boundary}"
        arrival = -push_down - excess if from_below else -push_up - excess
        yield Condition(
            i, f"{name} arrives at belt {after.boundary} with a force", arrival, end + lag, GRAZING,
            ARRIVAL, pace,
        )  # fmt: skip
        onward = push_up if from_below else push_down
        if after.kind == "cross":
            text = f"{name} passes belt {after.boundary} against static friction"
            yield Condition(i, text, onward, end + lag, BIRTH, PASSING, pace)
        elif after.kind == "stick":
            text = f"belt {after.boundary} holds the mass after {name}"
            yield Condition(i, text, -onward, end + lag, SLIP_BIRTH, PASSING, pace)


def _turns(
    orbit: FollowedOrbit, piece: int, times: np.ndarray, v: np.ndarray, speed: float, lag: float,
    domain: int | None,
) -> Iterator[Condition]:  # fmt: skip
    """Yield how far the turns of a flight are from the belts beside it."""
    belts = [float(belt.v) for belt in orbit.parameters.law.belts]
    if domain is None:
        domain = 1 + sum(float(v[0]) > belt for belt in belts)
    before, here, after = v[:-2], v[1:-1], v[2:]
    for n in np.flatnonzero((here - before) * (after - here) < 0).tolist():
        bend = before[n] - 2 * here[n] + after[n]
        vertex = float(vertex_of(before[n], here[n], after[n]))
        if bend < 0 and domain <= len(belts):
            number, distance = domain, belts[domain - 1] - vertex
        elif bend > 0 and domain > 1:
            number, distance = domain - 1, vertex - belts[domain - 2]
        else:
            continue
        name = orbit.labels[piece] if orbit.labels else "the flight"
        text = f"{name} turns before belt {number}"
        yield Condition(
            piece, text, distance, float(times[n + 1]) + lag, GRAZING, STAYS_INSIDE, speed
        )
