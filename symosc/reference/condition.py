"""Condition numbers of events: how much errors of the numbers that a problem is made of move its events.

For each event, with out its time or position and in each parameter and start value,

    condition = max over out of  sum over in of |d out/d in| |in| / max(1, |out|),

the amplification of relative errors of the input into errors of the output as the benchmarks measure them. A solver
that works in doubles rounds every input, so no solver can avoid an error of condition * 1e-16.

A number that is 0 has no relative error and does not count. A start on a belt moves with the belt, because off it
there would be other events. The derivatives are differences of two runs with more digits; where the difference
changes the events themselves it is made smaller.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from math import inf

from symosc.model import PARAMETER_NAMES
from symosc.reference.compare import relative_error
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

# Relative differences, and the digits of the runs that they are made with. A start times (1 + 1/7^n) has no end as a
# decimal. One with an end and this many digits would be taken for a number that somebody cut off there.
INPUT_CHANGES = ((Fraction(1, 7**30), 60), (Fraction(1, 7**60), 120))

Events = Callable[[Scene, int], Sequence[Event]]


def events_of(scene: Scene, digits: int) -> Sequence[Event]:
    """Return the events of a scene with that many digits."""
    return simulate(scene, digits=digits).events


def conditions(scene: Scene, events: Events = events_of) -> list[float]:
    """Return the condition number of every event of a scene.

    Parameters
    ----------
    scene : Scene
    events : callable
        What the outputs are: ``events(scene, digits)``, called for the scene and its neighbours.

    Returns
    -------
    list of float
        Infinite from the first event on that changes of the input, however small, turn into others.

    Examples
    --------
    >>> from symosc import load_scene
    >>> f"{max(conditions(load_scene('fig5'))):.1f}"
    '11.3'
    """
    exact = {digits: events(scene, digits) for _, digits in INPUT_CHANGES[:1]}
    certain = len(exact[INPUT_CHANGES[0][1]])
    totals = [[0.0, 0.0] for _ in range(certain)]
    for name in (*PARAMETER_NAMES, "t0", "x0", "v0"):
        for step, digits in INPUT_CHANGES:
            neighbour = shifted(scene, name, step)
            if neighbour == scene:
                break
            if digits not in exact:
                exact[digits] = events(scene, digits)
            moved = events(neighbour, digits)
            same = _same(exact[digits], moved)
            if same == len(exact[digits]) == len(moved):
                break
        if neighbour == scene:
            continue
        certain = min(certain, same)
        for total, before, after in zip(totals, exact[digits][:same], moved, strict=False):
            total[0] += relative_error(after.t, before.t) / float(step)
            total[1] += relative_error(after.x, before.x) / float(step)
    return [max(total) for total in totals[:certain]] + [inf] * (len(totals) - certain)


def shifted(scene: Scene, name: str, step: Fraction) -> Scene:
    """Return a scene with a parameter or start value (t0, x0, v0) times 1 + step; on a belt the start stays on it."""
    p = scene.parameters
    on_belt = next((name for name in ("v1", "v2") if getattr(p, name) == scene.v0), "")
    if name in ("t0", "x0", "v0"):
        value = getattr(scene, name)
        return scene if name == "v0" and on_belt else replace(scene, **{name: value * (1 + step)})
    value = getattr(p, name) * (1 + step)
    start = {"v0": value} if name == on_belt else {}
    return replace(scene, parameters=p.replace(**{name: value}), **start)


def _same(events: Sequence[Event], others: Sequence[Event]) -> int:
    """Return how many events two lists begin with that are of the same kind at the same boundary."""
    for i, (event, other) in enumerate(zip(events, others, strict=False)):
        if (event.kind, event.boundary, event.target) != (other.kind, other.boundary, other.target):
            return i
    return min(len(events), len(others))
