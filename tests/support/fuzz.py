"""Attack the engine with random scenes and an independent oracle.

Python tests/support/fuzz.py --scenes 2000 --seed 1

Prints a table per family and every failing scene as a Python snippet. Exits 1 if a scene failed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from itertools import cycle, islice
from random import Random

import numpy as np
import scene_families as plain
import touching_families as touching
from fast_oracle import simulate_fast
from scene_families import FuzzScene
from tabulate import tabulate
from verdicts import DOUBTFUL, Verdict, judge, settled

NAMES = (
    "wide graze near approach limit creep settle aimed shallow digits late long coincide onbelt "
    "rest undriven extreme"
)
FAMILIES: dict[str, Callable[[Random, int], FuzzScene]] = {
    name: getattr(touching if hasattr(touching, name) else plain, name) for name in NAMES.split()
}
FAULTS = (
    "missed", "invented", "wrong kind", "undecidable", "status", "end", "exception", "disagree", "digits",
    "estimate", "slow",
)  # fmt: skip
DIGITS_EVERY = 5  # every so many scenes of a family are run with digits=20 too


def scene_of(family: str, seed: int, number: int) -> FuzzScene:
    """Return the scene with that number; the same arguments give the same scene."""
    return FAMILIES[family](Random(f"{family}:{seed}:{number}"), number)


def verdict_of(task: tuple[str, int, int], part: Fraction = Fraction(1)) -> Verdict:
    """Judge a scene, or the first part of it."""
    family, seed, number = task
    scene = scene_of(family, seed, number)
    if part != 1:
        scene = plain.shortened(scene, part)
    if number % DIGITS_EVERY == 0:
        digits = (20,)
    else:
        digits = ()
    numba = (number % 2 == 0,)
    try:
        verdict = judge(scene, simulate_fast, digits, numba)
        if scene.truth is None and any(fault in DOUBTFUL for fault, _ in verdict.faults):
            # Before the engine is blamed, the oracle is asked for more digits.
            verdict = judge(settled(scene), digits=digits, numba=numba)
    except Exception as error:  # the oracle's or the judge's own
        verdict = Verdict(scene)
        verdict.add("unjudged", f"{type(error).__name__}: {error}")
    verdict.scene = plain.with_digits(scene, truth=None)  # closures do not travel between processes
    return verdict


def verdicts(tasks: list[tuple[str, int, int]], jobs: int) -> Iterator[Verdict]:
    if jobs == 1:
        yield from map(verdict_of, tasks)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(verdict_of, tasks, chunksize=4)


def table(found: list[Verdict]) -> str:
    """Return one row per family: scenes with each fault, and quantiles of error over estimate."""
    rows = []
    for family in FAMILIES:
        mine = [verdict for verdict in found if verdict.scene.family == family]
        if not mine:
            continue
        faults = Counter(
            name for verdict in mine for name in {fault for fault, _ in verdict.faults}
        )
        ratios = [ratio for verdict in mine for ratio in verdict.ratios]
        if ratios:
            quantiles = [f"{value:.2g}" for value in np.quantile(ratios, [0.5, 0.99, 1])]
        else:
            quantiles = ["", "", ""]
        doubts = sum(verdict.status == "doubt" for verdict in mine)
        slowest = max(verdict.seconds for verdict in mine)
        events = sum(verdict.events for verdict in mine)
        counts = [faults[name] or "" for name in FAULTS]
        rows.append(
            [family, len(mine), events, doubts or "", *counts, *quantiles, f"{slowest:.2g} s"]
        )
    heads = ["family", "scenes", "events", "in doubt", *FAULTS, "50 %", "99 %", "worst", "slowest"]
    return tabulate(rows, heads)


def report(verdict: Verdict, seed: int) -> str:
    """Return a failing scene as a snippet, with what is wrong as comments."""
    faults: dict[str, list[str]] = {}
    for name, detail in verdict.faults:
        faults.setdefault(name, []).append(detail)
    lines = [f"# {verdict.scene.family} seed {seed} number {verdict.scene.number}"]
    for name, details in faults.items():
        lines.append(
            f"# {name}: {details[0]}"
            + (f" (and {len(details) - 1} more)" if len(details) > 1 else "")
        )
    return "\n".join([*lines, verdict.scene.snippet()])


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--first", type=int, default=0, help="number of the first scene of every family"
    )
    parser.add_argument("--family", choices=FAMILIES, action="append")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument(
        "--ignore", choices=FAULTS, action="append", default=[], help="faults that are not listed"
    )
    parser.add_argument("--show", type=int, default=20, help="snippets to print per family")
    options = parser.parse_args(arguments)
    families = options.family or list(FAMILIES)
    turns = islice(cycle(families), options.scenes)
    tasks = [
        (family, options.seed, options.first + i // len(families)) for i, family in enumerate(turns)
    ]
    found = []
    begin = time.perf_counter()
    shown = Counter[str]()
    for verdict in verdicts(tasks, options.jobs):
        found.append(verdict)
        verdict.faults = [fault for fault in verdict.faults if fault[0] not in options.ignore]
        shown[verdict.scene.family] += bool(verdict.faults)
        if verdict.faults and shown[verdict.scene.family] <= options.show:
            print(report(verdict, options.seed), flush=True)
    failed = sum(bool(verdict.faults) for verdict in found)
    print(
        f"\n{table(found)}\n{failed} of {len(found)} scenes failed, {time.perf_counter() - begin:.0f} s"
    )
    if failed:
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
