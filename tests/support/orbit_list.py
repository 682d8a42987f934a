"""A list of periodic orbits in all damping regimes, and the proof of all of them.

Each line of ``orbits.csv`` has the eleven parameters, the word, and t and x at its first event, the
end of a flight. The other points are simulated from there; the proof takes them as a guess.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from symosc.certificates.certificate import Certificate
from symosc.certificates.propose_orbits import certify_orbit
from symosc.friction import MAPS
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.simulation.simulate import simulate
from symosc.words import cycle, read_word

ORBITS = Path(__file__).parents[1] / "certificates" / "orbits.csv"


class ListedOrbit(NamedTuple):
    """An orbit of the list in orbits.csv.

    Parameters, word, and approximate t and x of its first event.
    """

    p: Parameters
    word: str
    t: float
    x: float

    @property
    def regime(self) -> str:
        """The damping regime."""
        square = self.p.c * self.p.c - 4 * self.p.k * self.p.m
        if self.p.c == 0:
            return "undamped"
        if square < 0:
            return "underdamped"
        if square > 0:
            return "overdamped"
        return "critically damped"

    @property
    def cycle(self) -> str:
        """The word, rotated so that it does not depend on which event is the first."""
        return cycle(self.word)

    def points(self) -> list[tuple[float, float]]:
        """Return the approximate switching points (t, x) of one period, simulated from the first one."""
        labels = read_word(self.word).labels
        p = self.p
        v0 = p.belt(MAPS[labels[0]].start.boundary)
        end = self.t + 2.02 * math.pi / float(p.Omega)  # a little more than a period
        events = simulate(p, t0=self.t, x0=self.x, v0=v0, t_end=end, max_events=len(labels)).events
        return [(self.t, self.x), *((event.t, event.x) for event in events)][: len(labels)]

    def prove(self) -> Certificate:
        """Prove the orbit and return its certificate."""
        return certify_orbit(self.p, read_word(self.word).labels, 1, self.points())


@cache
def listed_orbits() -> tuple[ListedOrbit, ...]:
    """Return the orbits of orbits.csv, the list beside the tests of certificates."""
    text = ORBITS.read_text(encoding="utf-8")
    found = []
    for row in csv.reader(text.splitlines()):
        if row and not row[0].startswith("#"):
            *numbers, word, t, x = row
            p = Parameters(**dict(zip(PARAMETER_NAMES, numbers, strict=True)))
            found.append(ListedOrbit(p, word, float(t), float(x)))
    return tuple(found)


def prove_list(
    orbits: Sequence[ListedOrbit] | None = None,
    workers: int = 2,
    progress: Callable[[int, int], None] | None = None,
    *,
    again: bool = False,
) -> list[str]:
    """Prove all orbits of a list (default: all of it).

    Return for each "", or the reason of failure.

    With `again` the independent checker also proves the certificate of each orbit. `progress` is
    called with the number of orbits done and the number of all. The proofs run in processes, since
    the precision of balls is global to a process.
    """
    if orbits is None:
        orbits = listed_orbits()
    answers = list[str]()
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        for answer in pool.map(partial(_reason, again), orbits, chunksize=25):
            answers.append(answer)
            if progress:
                progress(len(answers), len(orbits))
    return answers


def _reason(again: bool, orbit: ListedOrbit) -> str:
    """Prove an orbit and, if `again`, let the checker prove its certificate.

    Return "" or why it is not proven.
    """
    proof = orbit.prove()
    if not again:
        if proof.proven:
            return ""
        return proof.message
    from symosc.certificates.verify_orbits import judge

    code, line = judge(json.loads(json.dumps(proof.as_dict())))
    if code:
        return f"{orbit.word} at {orbit.p}: {line}"
    return ""
