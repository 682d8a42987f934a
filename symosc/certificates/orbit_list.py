"""A list of periodic orbits in all damping regimes, which ships as data, and the proof of all of them.

Each line of ``orbits.csv`` has the eleven parameters, the word, and t and x at its first event, the end of a flight.
The other points are simulated from there; the proof takes them as a guess. `symosc.certificates.collect` made it.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from importlib.resources import files
from math import pi
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from pebble import ProcessPool

from symosc.certificates.certificate import Certificate
from symosc.certificates.orbit import OrbitToProve, certify_orbit
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.simulation.simulate import simulate
from symosc.words import MAPS, read_word

ORBITS_PER_TASK = 25
#: A simulation from a listed start goes on for this part of a period after it.
BEYOND = 0.01


class ListedOrbit(NamedTuple):
    """A line of the list: parameters, word, t and x at its first event."""

    p: Parameters
    word: str
    t: float
    x: float

    @property
    def regime(self) -> str:
        """Its damping."""
        p = self.p
        square = p.c * p.c - 4 * p.k * p.m
        if p.c == 0:
            return "undamped"
        return "underdamped" if square < 0 else "overdamped" if square > 0 else "critically damped"

    @property
    def cycle(self) -> str:
        """Its word, begun so that it is the same for all that differ only in where they begin."""
        digits = self.word[1:]
        return "P" + min(digits[i:] + digits[:i] for i in range(len(digits)))


class Proven(NamedTuple):
    """What came of the list: how many orbits are proven, by damping and word, and what is open."""

    orbits: int
    regimes: dict[str, int]
    words: int
    open: tuple[str, ...]


@cache
def listed_orbits() -> tuple[ListedOrbit, ...]:
    """Return the list that ships."""
    text = (files("symosc.certificates") / "orbits.csv").read_text(encoding="utf-8")
    return tuple(_read(row) for row in csv.reader(text.splitlines()) if row and not row[0].startswith("#"))


def _read(row: Sequence[str]) -> ListedOrbit:
    *numbers, word, t, x = row
    return ListedOrbit(Parameters(**dict(zip(PARAMETER_NAMES, numbers, strict=True))), word, float(t), float(x))


def written(orbit: ListedOrbit) -> str:
    """Return the line of an orbit."""
    return ",".join([*orbit.p.as_dict().values(), orbit.word, f"{orbit.t:.10g}", f"{orbit.x:.10g}"])


def task_of(orbit: ListedOrbit) -> OrbitToProve:
    """Return what is to be proven of a listed orbit, with the points that a simulation from its start has."""
    labels, p = read_word(orbit.word).labels, orbit.p
    boundary, period = MAPS[labels[0]].start.boundary, 2 * pi / float(p.Omega)
    end = orbit.t + period * (1 + BEYOND)
    events = simulate(p, t0=orbit.t, x0=orbit.x, v0=p.belt(boundary), t_end=end, max_events=len(labels)).events
    points = [(orbit.t, orbit.x), *((event.t, event.x) for event in events)][: len(labels)]
    return OrbitToProve(p, labels, 1, tuple(points))


def prove_listed(orbit: ListedOrbit) -> Certificate:
    """Prove a listed orbit."""
    return certify_orbit(task_of(orbit))


def _prove_some(orbits: Sequence[ListedOrbit]) -> list[str]:
    """Return for each orbit "" if it is proven, else why not."""
    found = [prove_listed(orbit) for orbit in orbits]
    return ["" if each.proven else each.message for each in found]


def _verify_some(orbits: Sequence[ListedOrbit]) -> list[str]:
    """Return for each orbit "" if its certificate, written to a file, is proven again, else why not."""
    from symosc.certificates.verify_orbits import verify

    answers = []
    with TemporaryDirectory() as folder:
        path = Path(folder) / "orbit.json"
        for orbit in orbits:
            found = prove_listed(orbit)
            found.to_json(path)
            code, line = verify(str(path))
            answers.append(f"{orbit.word} at {orbit.p}: {line}" if code else "")
    return answers


def prove_list(
    orbits: Sequence[ListedOrbit] | None = None, workers: int = 2, progress: Callable[[int, int], None] | None = None
) -> Proven:
    """Prove all orbits of a list, in processes: the precision of balls is global to a process.

    Parameters
    ----------
    orbits : sequence of ListedOrbit, optional
        Default: the list that ships.
    workers : int
    progress : callable, optional
        Called with how many orbits are done, and how many there are.
    """
    orbits = listed_orbits() if orbits is None else orbits
    return summary(orbits, _of_each(_prove_some, orbits, workers, progress))


def verify_list(
    orbits: Sequence[ListedOrbit] | None = None, workers: int = 2, progress: Callable[[int, int], None] | None = None
) -> list[str]:
    """Certify all orbits of a list and prove each file once more; return for each "", or what is not proven.

    Parameters
    ----------
    orbits, workers, progress
        As for `prove_list`.
    """
    return _of_each(_verify_some, listed_orbits() if orbits is None else orbits, workers, progress)


def _of_each(
    work: Callable[[Sequence[ListedOrbit]], list[str]],
    orbits: Sequence[ListedOrbit],
    workers: int,
    progress: Callable[[int, int], None] | None,
) -> list[str]:
    """Return what `work` says of each orbit."""
    parts = [orbits[i : i + ORBITS_PER_TASK] for i in range(0, len(orbits), ORBITS_PER_TASK)]
    answers: list[str] = []
    with ProcessPool(max_workers=workers, context=get_context("spawn")) as pool:
        for answer in pool.map(work, parts).result():
            answers += answer
            if progress:
                progress(len(answers), len(orbits))
    return answers


def summary(orbits: Iterable[ListedOrbit], answers: Sequence[str]) -> Proven:
    """Return what came of a list."""
    pairs = list(zip(orbits, answers, strict=True))
    proven = [orbit for orbit, answer in pairs if not answer]
    regimes = dict(Counter(orbit.regime for orbit in proven))
    return Proven(len(proven), regimes, len({orbit.cycle for orbit in proven}), tuple(filter(None, answers)))
