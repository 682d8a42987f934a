"""Follow the reference cases with scipy's solve_ivp (DOP853), and write the events that it finds.

python with_scipy.py cases/cases.csv mine.csv && symosc score cases mine.csv

A solver is a function `leave`: it follows one flight or stick to its end. The rules at the belts
are those of `symosc.bench.event_logic`. Steps are at most a twentieth of a period. Two roots inside
one step are not seen.
"""

from __future__ import annotations

import csv
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from scipy.integrate import solve_ivp

from symosc import load_scene
from symosc.bench.event_logic import PeerError, PeerProblem, force, margins, runner, with_solver
from symosc.bench.solvers import processor_limit

TOLERANCE = 1e-13
STEPS_PER_PERIOD = 20
#: Seconds of processor time for a case.
LIMIT = 5.0


def leave(
    q: PeerProblem, settings: None, mode: int, t: float, x: float, v: float, t_end: float
) -> tuple[int, float, float]:
    """Follow a flight (modes 1 to 3) or a stick (4 and 5).

    Return the side where it ends (-1 or 1; 0 where it lasts until t_end), and t and x there.
    """

    def rates(t: float, y: Any) -> tuple[float, float]:
        if mode > 3:
            return y[1], 0.0
        return y[1], force(q, mode, t, y[0], y[1])

    def margin(place: int, t: float, y: Any) -> float:
        return margins(q, mode, t, y[0], y[1])[place]

    ends: list[Any] = [partial(margin, 0), partial(margin, 1)]
    for end in ends:
        end.terminal = True
        end.direction = -1
    solution = solve_ivp(
        rates,
        (t, t_end),
        (x, v),
        method="DOP853",
        events=ends,
        rtol=TOLERANCE,
        atol=TOLERANCE,
        max_step=q.period / STEPS_PER_PERIOD,
    )
    if not solution.success:
        raise PeerError(solution.message)
    for side, times in zip((-1, 1), solution.t_events, strict=True):
        if len(times):
            return side, float(solution.t[-1]), float(solution.y[0, -1])
    return 0, t_end, float(solution.y[0, -1])


def rows_of(case: Path, follow: Callable[..., Any]) -> Iterator[tuple[Any, ...]]:
    """Yield the rows of results of a case: a row for each event, and one for the end."""
    scene = load_scene(case / "case.toml")
    begin = time.perf_counter()
    with processor_limit(LIMIT):
        events = list(follow(scene)())
    seconds = time.perf_counter() - begin
    for event in events:
        yield case.name, repr(event.t), repr(event.x), event.kind, event.boundary, ""
    yield case.name, repr(float(scene.t_end)), "", "end", "", f"{seconds:.3g}"


def main() -> None:
    """Follow the cases of a table, cases.csv, and write the events.

    Both files are named on the command line.
    """
    table, results = map(Path, sys.argv[1:])
    follow = partial(runner, functions=with_solver(leave), settings=None, offset=0.0)
    with table.open(newline="") as file, results.open("w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["case", "t", "x", "kind", "boundary", "seconds"])
        for row in csv.DictReader(file):
            if row["periods"] != "0":  # 1e5 periods take too long
                continue
            try:
                writer.writerows(list(rows_of(table.parent / row["name"], follow)))
            except (TimeoutError, PeerError) as error:
                print(f"{row['name']} is left out: {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
