"""The list of periodic orbits in all damping regimes that ships with the package, and the proof of all of them.

Each line of ``orbits.csv`` has the eleven parameters, the word, and t and x at its first event, the end of a flight.
The other points are simulated from there; the proof takes them as a guess.
"""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from importlib.resources import files
from multiprocessing import get_context
from typing import NamedTuple

from pebble import ProcessPool

from symosc.certificates.certificate import Certificate
from symosc.certificates.orbit import certify_orbit
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.simulation.simulate import simulate
from symosc.words import MAPS, read_word

ORBITS_PER_TASK = 25


class ListedOrbit(NamedTuple):
    """A line of the list: parameters, word, t and x at its first event."""

    p: Parameters
    word: str
    t: float
    x: float

    @property
    def regime(self) -> str:
        """The damping regime."""
        p = self.p
        square = p.c * p.c - 4 * p.k * p.m
        if p.c == 0:
            return "undamped"
        return "underdamped" if square < 0 else "overdamped" if square > 0 else "critically damped"

    @property
    def cycle(self) -> str:
        """The word, started so that rotated words are equal."""
        digits = self.word[1:]
        return "P" + min(digits[i:] + digits[:i] for i in range(len(digits)))

    def points(self) -> list[tuple[float, float]]:
        """Return approximate switching points (t, x), simulated from the first one."""
        labels, p = read_word(self.word).labels, self.p
        v0 = p.belt(MAPS[labels[0]].start.boundary)
        end = self.t + 2.02 * math.pi / float(p.Omega)  # a little more than a period
        events = simulate(p, t0=self.t, x0=self.x, v0=v0, t_end=end, max_events=len(labels)).events
        return [(self.t, self.x), *((event.t, event.x) for event in events)][: len(labels)]

    def prove(self) -> Certificate:
        """Prove the orbit."""
        return certify_orbit(self.p, read_word(self.word).labels, 1, self.points())


class Proven(NamedTuple):
    """The result for a list: the number of proven orbits by damping and word, and the undecided ones."""

    orbits: int
    regimes: dict[str, int]
    words: int
    undecided: tuple[str, ...]


@cache
def listed_orbits() -> tuple[ListedOrbit, ...]:
    """Return the list that ships with the package."""
    text = (files("symosc.certificates") / "orbits.csv").read_text(encoding="utf-8")
    found = []
    for row in csv.reader(text.splitlines()):
        if row and not row[0].startswith("#"):
            *numbers, word, t, x = row
            p = Parameters(**dict(zip(PARAMETER_NAMES, numbers, strict=True)))
            found.append(ListedOrbit(p, word, float(t), float(x)))
    return tuple(found)


def prove_list(
    orbits: Sequence[ListedOrbit] | None = None, workers: int = 2, progress: Callable[[int, int], None] | None = None
) -> Proven:
    """Prove all orbits of a list (default: the shipped one); `progress`: how many are done, and how many there are."""
    orbits = listed_orbits() if orbits is None else orbits
    answers = _in_processes(_prove_part, orbits, workers, progress)
    proven = [orbit for orbit, answer in zip(orbits, answers, strict=True) if not answer]
    regimes = dict(Counter(orbit.regime for orbit in proven))
    return Proven(len(proven), regimes, len({orbit.cycle for orbit in proven}), tuple(filter(None, answers)))


def verify_list(
    orbits: Sequence[ListedOrbit] | None = None, workers: int = 2, progress: Callable[[int, int], None] | None = None
) -> list[str]:
    """Prove all orbits of a list and what their files say; return for each "", or the reason of failure."""
    return _in_processes(_verify_part, listed_orbits() if orbits is None else orbits, workers, progress)


def _prove_part(orbits: Sequence[ListedOrbit]) -> list[str]:
    """Prove some orbits; return for each "" if it is proven, else the reason."""
    found = [orbit.prove() for orbit in orbits]
    return ["" if each.proven else each.message for each in found]


def _verify_part(orbits: Sequence[ListedOrbit]) -> list[str]:
    """Prove some orbits, and give the checker what their files say; return for each "" or the reason of failure."""
    from symosc.certificates.verify_orbits import judge

    answers = [(orbit, *judge(json.loads(json.dumps(orbit.prove().as_dict())))) for orbit in orbits]
    return [f"{orbit.word} at {orbit.p}: {line}" if code else "" for orbit, code, line in answers]


def _in_processes(
    work: Callable[[Sequence[ListedOrbit]], list[str]],
    orbits: Sequence[ListedOrbit],
    workers: int,
    progress: Callable[[int, int], None] | None,
) -> list[str]:
    """Return the result of `work` for each orbit; in processes, as the precision of balls is global to each."""
    parts = [orbits[i : i + ORBITS_PER_TASK] for i in range(0, len(orbits), ORBITS_PER_TASK)]
    answers: list[str] = []
    with ProcessPool(max_workers=workers, context=get_context("spawn")) as pool:
        for answer in pool.map(work, parts).result():
            answers += answer
            if progress:
                progress(len(answers), len(orbits))
    return answers
