"""How many random scenes `certify` proves, and why the others stay open.

Python tests/support/confirming.py 2000 --seed 1

Prints each scene that is not proven with its message, and how many are. A graze of an exact start
with damping or drive, and a force that is 0 on a belt, are never proven.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction

from fuzz import FAMILIES, scene_of

from symosc import Scene, certify
from symosc.certificates.certificate import Certificate

#: Periods of the drive that are proven; every third scene has a start that is known to an error.
MOST_PERIODS = 12
ERROR = Fraction(1, 10**20)


def certified(family: str, seed: int, number: int) -> Certificate:
    """Return the certificate of a random scene."""
    scene = scene_of(family, seed, number)
    t_end = min(scene.t_end, scene.t0 + Fraction(63, 10) * MOST_PERIODS / scene.p.Omega)
    on_belt = scene.v0 in (scene.p.v1, scene.p.v2)
    if number % 3 == 2:
        error = (ERROR, ERROR, 0 if on_belt else ERROR)
    else:
        error = None
    return certify(Scene(family, scene.p, scene.t0, scene.x0, scene.v0, t_end), start_error=error)


def numbered(count: int) -> Iterator[tuple[str, int]]:
    """Yield family and number of so many scenes, of each family in turn."""
    families = list(FAMILIES)
    return ((families[i % len(families)], i // len(families)) for i in range(count))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", type=int)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    proven = Counter[str]()
    events = 0
    begin = time.process_time()
    for family, number in numbered(options.scenes):
        found = certified(family, options.seed, number)
        proven[family] += found.proven
        if found.proven:
            events += len(found.events)
        else:
            print(f"{family} seed {options.seed} number {number}: {found.message}", flush=True)
    seconds = time.process_time() - begin
    print(f"{proven.total()} of {options.scenes} scenes proven, {events} events, {seconds:.0f} s")
    print(", ".join(f"{family} {proven[family]}" for family in FAMILIES))


if __name__ == "__main__":
    main()
