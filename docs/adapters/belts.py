"""What adapters in Python share.

Reading the table of cases, the rules at the belts, and writing events.

An adapter gives `fly(p, domain, t, x, v)`, which integrates in a domain up to the next belt and
returns (t, x, belt), and `ride(p, belt, t, x)`, which returns (t, x, domain) where a stick ends.
Both return None if t_end comes first.
"""

from __future__ import annotations

import csv
import math
import sys
import time
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

NAMES = (
    "m",
    "c",
    "k",
    "A0",
    "B0",
    "Omega",
    "v1",
    "v2",
    "mu1",
    "mu2",
    "FN",
    "t0",
    "x0",
    "v0",
    "t_end",
)
Problem = dict[str, float]
End = tuple[float, float, int] | None


def force(p: Problem, domain: int, t: float, x: float, v: float) -> float:
    """Return the acceleration that a domain gives."""
    return (constant(p, domain) + p["B0"] * math.cos(p["Omega"] * t) - p["k"] * x - p["c"] * v) / p[
        "m"
    ]


def constant(p: Problem, domain: int) -> float:
    """Return the constant force of a domain, A_1 to A_3."""
    friction = {1: p["mu1"] + p["mu2"], 2: p["mu2"] - p["mu1"], 3: -p["mu1"] - p["mu2"]}
    return p["A0"] + friction[domain] * p["FN"]


def follow(
    p: Problem, fly: Callable[..., End], ride: Callable[..., End]
) -> Iterator[tuple[float, float, str, int]]:
    """Yield the events of a case: t, x, kind, belt."""
    t = p["t0"]
    x = p["x0"]
    v = p["v0"]
    speeds = {1: p["v1"], 2: p["v2"]}
    belt = next((i for i in (1, 2) if v == speeds[i]), 0)
    domain = 1 + (v > speeds[1]) + (v > speeds[2])
    while t < p["t_end"]:
        if belt:
            v = speeds[belt]
            below = force(p, belt, t, x, v)
            above = force(p, belt + 1, t, x, v)
            if below > 0 > above:
                if t > p["t0"]:
                    yield t, x, "stick", belt
                end = ride(p, belt, t, x)
                if end is None:
                    return
                t, x, domain = end
                yield t, x, "slip", belt
            else:
                before = domain
                domain = belt + (above >= 0)
                if t > p["t0"] and before != domain:
                    yield t, x, "cross", belt
        end = fly(p, domain, t, x, v)
        if end is None:
            return
        t, x, belt = end


def main(fly: Callable[..., End], ride: Callable[..., End]) -> None:
    """Follow the cases of a table, cases.csv, and write the events.

    Both files are named on the command line.
    """
    table, results = sys.argv[1:]
    with open(table, newline="") as file, open(results, "w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["case", "t", "x", "kind", "boundary", "seconds"])
        for row in csv.DictReader(file):
            if row["periods"] == "0":  # not one of 1e5 periods
                writer.writerows(_rows(row, fly, ride))


def _rows(row: dict[str, str], fly: Any, ride: Any) -> list[tuple[Any, ...]]:
    p = {name: float(Fraction(row[name])) for name in NAMES}
    begin = time.perf_counter()
    p["stop at"] = time.process_time() + 5.0  # what takes longer raises TimeoutError
    try:
        events = list(follow(p, fly, ride))
    except (TimeoutError, ArithmeticError, ValueError) as error:
        print(f"{row['name']} is left out: {type(error).__name__} {error}", file=sys.stderr)
        return []
    rows: list[tuple[Any, ...]] = [
        (row["name"], repr(t), repr(x), kind, belt, "") for t, x, kind, belt in events
    ]
    return [
        *rows,
        (row["name"], repr(p["t_end"]), "", "end", "", f"{time.perf_counter() - begin:.3g}"),
    ]
