"""`atlas`: the plane of two parameters, as regions with words, their borders, and boxes in which a word is proven."""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache, partial
from math import log2, pi
from time import monotonic
from typing import Any, NamedTuple

import numpy as np

from symosc.errors import ParameterError
from symosc.model import Parameters
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit
from symosc.sweeps.plan import cycles
from symosc.words import read_word

#: The word of a region in which the mass may rest on a belt for ever.
REST = "rest"
#: Boxes that are tried between two looks at the clock, and in one call of a worker.
BATCH, CHUNK = 64, 8
#: Orbits of other words that are kept for the parts of a rectangle.
MOST_NEAR = 3
#: Boxes whose sides are a smaller part of the ranges are not divided further.
LEAST_SIDE = Fraction(1, 1 << 24)

Rectangle = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]
#: Labels of a word in order of time, and the unknowns of its orbit, nearly (`symosc.certificates.plane`).
Candidate = tuple[tuple[str, ...], tuple[float, ...]]


class Task(NamedTuple):
    """A rectangle to prove, and orbits that may be near, the more probable ones first; `divide`: it is too large."""

    box: Rectangle
    near: tuple[Candidate, ...]
    divide: int = 0


class Tried(NamedTuple):
    """What came of a task: the word, or "" and the parts to try; and the orbit at the middle as (phase, x)."""

    word: str
    points: tuple[tuple[float, float], ...]
    parts: tuple[Task, ...]


def area(box: Rectangle) -> Fraction:
    """Return the area of a rectangle."""
    (a, b), (c, d) = box
    return (b - a) * (d - c)


def divided(box: Rectangle, along: int) -> tuple[Rectangle, Rectangle]:
    """Return the halves of a rectangle."""
    (low, high), other = box[along], box[1 - along]
    middle = (low + high) / 2
    parts = (low, middle), (middle, high)
    first, second = ((part, other) if along == 0 else (other, part) for part in parts)
    return first, second


@lru_cache(maxsize=256)
def _flights(labels: tuple[str, ...], p: Parameters, names: tuple[str, str]) -> Any:
    from symosc.certificates.plane import Flights, mirrors

    return Flights(labels, mirrors(p, names))


def orbit_near(p: Parameters, names: tuple[str, str], box: Rectangle) -> Candidate | None:
    """Return the orbit to which the motion at the middle of a box settles; None if it is not found."""
    middle = p.replace(**{name: (low + high) / 2 for name, (low, high) in zip(names, box, strict=True)})
    try:
        orbit = find_orbit(middle)
    except ConvergenceError:
        return None
    if not orbit.admissible or orbit.periods != 1:
        return None
    labels, Omega = orbit.labels, float(middle.Omega)
    points = [(t * Omega, x) for t, x in orbit.points]
    first = next(i for i, label in enumerate(labels) if label not in ("P1", "P4"))
    labels, points = labels[first:] + labels[:first], points[first:] + points[:first]
    return labels, tuple(_flights(labels, p, names).unknowns(Omega, points))


def attempt(p: Parameters, names: tuple[str, str], task: Task) -> Tried:
    """Try to prove a rectangle with the orbits near its middle; divide it if that fails."""
    from symosc.certificates.plane import NotInBox, Surface, box_arithmetic

    box, along, found, surface = task.box, None, list(task.near), None
    candidates = iter(task.near)
    while surface is None:
        candidate = next(candidates, None)
        if candidate is None:
            if len(found) > len(task.near) or (candidate := orbit_near(p, names, box)) is None:
                break
            found.insert(0, candidate)
        labels, unknowns = candidate
        try:
            with box_arithmetic():
                surface = Surface(p, names, box, _flights(labels, p, names), unknowns)
        except NotInBox:
            continue
    if surface is None:
        return Tried("", (), tuple(Task(part, tuple(found[:MOST_NEAR])) for part in divided(box, _longer(box))))
    try:
        with box_arithmetic():
            if not task.divide:
                surface.prove()
                return Tried(canonical(labels), tuple(surface.points()), ())
            divide = task.divide - 1
    except NotInBox as reason:
        along, divide = reason.along, int(log2(max(reason.excess, 1)) / 2) if reason.excess < 1e6 else 3
    along = _longer(box) if along is None else along
    others = [each for each in found if each[0] != labels][: MOST_NEAR - 1]
    places = ((-0.5, 0), (0.5, 0)) if along == 0 else ((0, -0.5), (0, 0.5))
    near = [(labels, surface.near(*place)) for place in places]
    others.insert(0, (labels, surface.near(0, 0)))
    return Tried("", (), tuple(Task(part, (each, *others), divide) for part, each in zip(divided(box, along), near, strict=True)))


def canonical(labels: Sequence[str]) -> str:
    """Return the text of a word, the same for all its rotations."""
    return str(cycles(np.array([str(read_word(labels))]))[0])


def _longer(box: Rectangle) -> int:
    """Return the side of a box that is the longer part of its middle."""
    sizes = [(high - low) / max(abs(high), abs(low)) for low, high in box]
    return int(sizes[1] > sizes[0])
