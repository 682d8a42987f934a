"""A list of periodic orbits in all damping regimes, which ships as data, how it was made, and the proof of all of them.

Each line of ``orbits.csv`` has the eleven parameters, the word, and t and x at its first event, the end of a flight.
The other points are simulated from there; the proof takes them as a guess.

``python -m symosc.certificates.orbit_list COUNT SEED`` made it, and prints its lines. Parameters are drawn with two
digits, in turns for each damping regime. A motion is simulated until it should repeat. If it does, with a word that is
not yet frequent, and the orbit is proven, it goes into the list.
"""

from __future__ import annotations

import csv
import math
import random
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from importlib.resources import files
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from pebble import ProcessPool

from symosc.certificates.certificate import Certificate
from symosc.certificates.orbit import certify_orbit
from symosc.errors import SymoscError
from symosc.model import MODE_NAMES, PARAMETER_NAMES, Parameters
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event
from symosc.words import MAPS, Word, read_word

ORBITS_PER_TASK = 25
#: A simulation from a listed start goes on for this part of a period after it.
BEYOND = 0.01
DAMPING = ("underdamped", "overdamped", "critically damped", "undamped")
#: Orbits of one word; mappings of a word; events that a simulation may have; periods it may take.
MOST_OF_A_WORD, LONGEST_LISTED_WORD, MOST_SIMULATED_EVENTS, MOST_SETTLING_PERIODS = 40, 24, 4000, 60
#: How near a motion must come to itself after a period, relatively.
NEAR_ITSELF = 1e-4
LABELS = {(row.start.boundary, MODE_NAMES[row.mode], row.end.boundary): row.label for row in MAPS.values()}


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

    def line(self) -> str:
        """Return its line of the list."""
        return ",".join([*self.p.as_dict().values(), self.word, f"{self.t:.10g}", f"{self.x:.10g}"])

    def points(self) -> list[tuple[float, float]]:
        """Return its switching points (t, x), nearly, by a simulation from the first one."""
        labels, p = read_word(self.word).labels, self.p
        start = {"t0": self.t, "x0": self.x, "v0": p.belt(MAPS[labels[0]].start.boundary)}
        end = self.t + 2 * math.pi / float(p.Omega) * (1 + BEYOND)
        events = simulate(p, **start, t_end=end, max_events=len(labels)).events
        return [(self.t, self.x), *((event.t, event.x) for event in events)][: len(labels)]

    def prove(self) -> Certificate:
        """Prove it."""
        return certify_orbit(self.p, read_word(self.word).labels, 1, self.points())


class Proven(NamedTuple):
    """The result of the list: how many orbits are proven, by damping and word, and which are undecided."""

    orbits: int
    regimes: dict[str, int]
    words: int
    undecided: tuple[str, ...]


@cache
def listed_orbits() -> tuple[ListedOrbit, ...]:
    """Return the list that ships."""
    text = (files("symosc.certificates") / "orbits.csv").read_text(encoding="utf-8")
    found = []
    for row in csv.reader(text.splitlines()):
        if row and not row[0].startswith("#"):
            *numbers, word, t, x = row
            p = Parameters(**dict(zip(PARAMETER_NAMES, numbers, strict=True)))
            found.append(ListedOrbit(p, word, float(t), float(x)))
    return tuple(found)


# -- the proof of all --------------------------------------------------------------------------------------------------


def prove_list(
    orbits: Sequence[ListedOrbit] | None = None, workers: int = 2, progress: Callable[[int, int], None] | None = None
) -> Proven:
    """Prove all orbits of a list (default: the one that ships), in processes: the precision of balls is global to one.

    `progress` is called with how many orbits are done, and how many there are.
    """
    orbits = listed_orbits() if orbits is None else orbits
    return summary(orbits, _of_each(_prove_some, orbits, workers, progress))


def verify_list(
    orbits: Sequence[ListedOrbit] | None = None, workers: int = 2, progress: Callable[[int, int], None] | None = None
) -> list[str]:
    """Certify all orbits of a list and check each file; return for each "", or what is not proven."""
    return _of_each(_verify_some, listed_orbits() if orbits is None else orbits, workers, progress)


def _prove_some(orbits: Sequence[ListedOrbit]) -> list[str]:
    found = [orbit.prove() for orbit in orbits]
    return ["" if each.proven else each.message for each in found]


def _verify_some(orbits: Sequence[ListedOrbit]) -> list[str]:
    from symosc.certificates.verify_orbits import verify

    answers = []
    with TemporaryDirectory() as folder:
        path = Path(folder) / "orbit.json"
        for orbit in orbits:
            orbit.prove().to_json(path)
            code, line = verify(str(path))
            answers.append(f"{orbit.word} at {orbit.p}: {line}" if code else "")
    return answers


def _of_each(
    work: Callable[[Sequence[ListedOrbit]], list[str]],
    orbits: Sequence[ListedOrbit],
    workers: int,
    progress: Callable[[int, int], None] | None,
) -> list[str]:
    """Return the answer of `work` for each orbit, "" if it is proven."""
    parts = [orbits[i : i + ORBITS_PER_TASK] for i in range(0, len(orbits), ORBITS_PER_TASK)]
    answers: list[str] = []
    with ProcessPool(max_workers=workers, context=get_context("spawn")) as pool:
        for answer in pool.map(work, parts).result():
            answers += answer
            if progress:
                progress(len(answers), len(orbits))
    return answers


def summary(orbits: Iterable[ListedOrbit], answers: Sequence[str]) -> Proven:
    """Return the result of a list."""
    proven = [orbit for orbit, answer in zip(orbits, answers, strict=True) if not answer]
    regimes = dict(Counter(orbit.regime for orbit in proven))
    return Proven(len(proven), regimes, len({orbit.cycle for orbit in proven}), tuple(filter(None, answers)))


# -- how the list was made ---------------------------------------------------------------------------------------------


def collect(count: int, seed: int) -> Iterator[ListedOrbit]:
    """Yield that many proven orbits."""
    rng, words, seen = random.Random(seed), Counter[str](), set[Parameters]()
    while len(seen) < count:
        try:
            p = _draw(rng, DAMPING[len(seen) % len(DAMPING)])
            found = _settled(p)
        except SymoscError:
            continue
        if found is None or p in seen:
            continue
        labels, points = found
        orbit = ListedOrbit(p, str(Word(labels)), *points[0])
        if words[orbit.cycle] < MOST_OF_A_WORD and certify_orbit(p, labels, 1, points).proven and orbit.prove().proven:
            words[orbit.cycle] += 1
            seen.add(p)
            yield orbit


def _draw(rng: random.Random, regime: str) -> Parameters:
    """Draw parameters with a damping regime."""

    def between(low: float, high: float) -> Fraction:
        return Fraction(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.2g}")

    m, k = between(0.1, 3), between(0.3, 6)
    part = {"underdamped": rng.uniform(0.01, 0.6), "overdamped": rng.uniform(1.1, 3), "undamped": 0.0}
    if regime == "critically damped":
        c = between(0.2, 4)
        k = c * c / (4 * m)
    else:
        c = Fraction(f"{2 * part[regime] * math.sqrt(k * m):.2g}")
    v1 = Fraction(f"{rng.uniform(-6, 3):.2g}")
    return Parameters(
        m=m,
        c=c,
        k=k,
        A0=Fraction(f"{rng.uniform(-6, 6):.2g}"),
        B0=between(1, 12),
        Omega=Fraction(f"{math.sqrt(k / m) * math.exp(rng.uniform(math.log(0.12), math.log(2.2))):.2g}"),
        v1=v1,
        v2=v1 + between(0.3, 6),
        mu1=Fraction(rng.randint(1, 8), 10),
        mu2=Fraction(rng.randint(0, 8), 10),
        FN=between(0.5, 8),
    )


def _settled(p: Parameters) -> tuple[tuple[str, ...], list[tuple[float, float]]] | None:
    """Return labels and points of the last period of a motion that repeats, or None."""
    period = 2 * math.pi / float(p.Omega)
    decay = 60 * float(p.m / p.c) / period if p.c else MOST_SETTLING_PERIODS
    last = math.ceil(min(MOST_SETTLING_PERIODS, max(8.0, decay)))
    middle = (p.v1 + p.v2) / 2
    motion = simulate(p, t0=0, x0=p.A0 / p.k, v0=middle, t_end=(last + 2) * period, max_events=MOST_SIMULATED_EVENTS)
    events = [event for event in motion.events if event.t > last * period]
    for i, first in enumerate(events):
        for j in range(i + 1, len(events)):
            if first.kind != "slip" and _same(first, events[j], period):
                shift = period * math.floor(float(first.t) / period)
                labels = [
                    LABELS.get((a.boundary, a.target, b.boundary))
                    for a, b in zip(events[i:j], events[i + 1 :], strict=False)
                ]
                found = tuple(label for label in labels if label)
                points = [(float(event.t) - shift, float(event.x)) for event in events[i:j]]
                return (found, points) if len(found) == len(labels) <= LONGEST_LISTED_WORD else None
    return None


def _same(a: Event, b: Event, period: float) -> bool:
    near = abs(b.t - a.t - period) < NEAR_ITSELF * period and abs(b.x - a.x) < NEAR_ITSELF * (1 + abs(a.x))
    return bool(near and (a.boundary, a.kind, a.target) == (b.boundary, b.kind, b.target))


if __name__ == "__main__":
    for each in collect(int(sys.argv[1]), int(sys.argv[2])):
        print(each.line())
