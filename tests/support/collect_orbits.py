"""How the list of orbits was made.

``python tests/support/collect_orbits.py COUNT SEED`` prints its lines.

Parameters are drawn with two digits, in turns for each damping regime. A motion is simulated until
it should repeat. If it does, with a word that is not yet frequent, and the orbit is proven, it goes
into the list.
"""

from __future__ import annotations

import math
import random
import sys
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction

from orbit_list import ListedOrbit

from symosc import Event, Parameters, simulate
from symosc.base.errors import SymoscError
from symosc.certificates.propose_orbits import certify_orbit
from symosc.friction import MAPS, MODE_NAMES
from symosc.words import Word

DAMPING = ("underdamped", "overdamped", "critically damped", "undamped")
#: Orbits of one word; mappings of a word; events that a simulation may have; periods it may take.
MOST_OF_A_WORD = 40
LONGEST_LISTED_WORD = 24
MOST_SIMULATED_EVENTS = 4000
MOST_SETTLING_PERIODS = 60
#: How near a motion must come to itself after a period, relatively.
NEAR_ITSELF = 1e-4
LABELS = {
    (row.start.boundary, MODE_NAMES[row.mode], row.end.boundary): row.label for row in MAPS.values()
}


def collect(count: int, seed: int) -> Iterator[ListedOrbit]:
    """Yield that many proven orbits."""
    rng = random.Random(seed)
    words = Counter[str]()
    seen = set[Parameters]()
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
        if (
            words[orbit.cycle] < MOST_OF_A_WORD
            and certify_orbit(p, labels, 1, points).proven
            and orbit.prove().proven
        ):
            words[orbit.cycle] += 1
            seen.add(p)
            yield orbit


def line(orbit: ListedOrbit) -> str:
    """Return an orbit as a line of the list."""
    return ",".join([*orbit.p.as_dict().values(), orbit.word, f"{orbit.t:.10g}", f"{orbit.x:.10g}"])


def _draw(rng: random.Random, regime: str) -> Parameters:
    """Draw parameters with a damping regime."""

    def between(low: float, high: float) -> Fraction:
        return Fraction(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.2g}")

    m = between(0.1, 3)
    k = between(0.3, 6)
    part = {
        "underdamped": rng.uniform(0.01, 0.6),
        "overdamped": rng.uniform(1.1, 3),
        "undamped": 0.0,
    }
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
        Omega=Fraction(
            f"{math.sqrt(k / m) * math.exp(rng.uniform(math.log(0.12), math.log(2.2))):.2g}"
        ),
        v1=v1,
        v2=v1 + between(0.3, 6),
        mu1=Fraction(rng.randint(1, 8), 10),
        mu2=Fraction(rng.randint(0, 8), 10),
        FN=between(0.5, 8),
    )


def _settled(p: Parameters) -> tuple[tuple[str, ...], list[tuple[float, float]]] | None:
    """Return labels and points of the last period of a motion that repeats, or None."""
    period = 2 * math.pi / float(p.Omega)
    if p.c:
        decay = 60 * float(p.m / p.c) / period
    else:
        decay = MOST_SETTLING_PERIODS
    last = math.ceil(min(MOST_SETTLING_PERIODS, max(8.0, decay)))
    middle = (p.v1 + p.v2) / 2
    motion = simulate(
        p,
        t0=0,
        x0=p.A0 / p.k,
        v0=middle,
        t_end=(last + 2) * period,
        max_events=MOST_SIMULATED_EVENTS,
    )
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
                if len(found) == len(labels) <= LONGEST_LISTED_WORD:
                    return (found, points)
                return None
    return None


def _same(a: Event, b: Event, period: float) -> bool:
    near = abs(b.t - a.t - period) < NEAR_ITSELF * period and abs(b.x - a.x) < NEAR_ITSELF * (
        1 + abs(a.x)
    )
    return bool(near and (a.boundary, a.kind, a.target) == (b.boundary, b.kind, b.target))


if __name__ == "__main__":
    for each in collect(int(sys.argv[1]), int(sys.argv[2])):
        print(line(each))
