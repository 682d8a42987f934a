"""Many motions: trajectories per second beside other people's ways to count events, and what cores and sets cost.

All are timed in processor time of one thread, in turns; so what else the machine does counts less. Only the gain of two
threads is of wall time.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from math import pi
from statistics import median
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.bench import peers_scan
from symosc.bench.event_logic import Motion
from symosc.bench.peers_heyoka_batch import count_by_heyoka
from symosc.bench.scalar_logic import scalars
from symosc.model import PARAMETER_NAMES
from symosc.scenes import load_scene
from symosc.simulation.ensemble import simulate_many

PHASES, QUICK_PHASES = 10_000, 2_000
#: Motions that heyoka is given, and periods of all motions.
HEYOKA_PHASES, BATCH_PERIODS = 160, 50
SCAN_POINTS, SCAN_ACCURACY = 20, 1e-13
#: What is recorded; the first is what all solvers are asked for.
COMPARED_RECORDS = {
    "counts": ("events",),
    "rows of events": "events",
    "words": ("events", "word", "multiplicity"),
    "all columns": "summary",
}


def run(quick: bool = False) -> Record:
    """Measure and return a plain dictionary.

    Notes
    -----
    Keys: motions, events; ns_per_event by what is recorded; per_s, trajectories whose events are counted per second of
    processor time; scan and heyoka, which count too, each with per_s, over_ours and missed (events that it has less
    than ours, motion by motion), None if it is not installed; sets_over_starts (time per event of as many values of
    Omega as there are starts); two_workers (gain in wall time).
    """
    p, count, repeats = load_scene("fig9").parameters, QUICK_PHASES if quick else PHASES, 3 if quick else 5
    rng = np.random.default_rng(1)
    period = 2 * pi / float(p.Omega)
    starts = np.column_stack([rng.uniform(0, period, count), rng.uniform(-5, 5, count), rng.uniform(-5, 5, count)])
    ends = starts[:, 0] + BATCH_PERIODS * period
    columns: Record = {name: float(getattr(p, name)) for name in PARAMETER_NAMES}
    columns["Omega"] = rng.uniform(0.9, 1.1, count) * float(p.Omega)
    follow = partial(simulate_many, p, starts, ends, use_numba=True, workers=1)
    count_events = partial(follow, record=COMPARED_RECORDS["counts"])
    sets_ends = BATCH_PERIODS * 2 * pi / columns["Omega"]
    actions: dict[str, Callable[[], Any]] = {
        name: partial(follow, record=record) for name, record in COMPARED_RECORDS.items()
    }
    actions["sets"] = partial(
        simulate_many, columns, (0, 0, 0), sets_ends, use_numba=True, workers=1, record=COMPARED_RECORDS["counts"]
    )
    scan, few = scan_of_starts(starts, ends - starts[:, 0]), slice(0, HEYOKA_PHASES)
    actions["scan"] = scan
    if find_spec("heyoka"):
        heyoka = count_by_heyoka(p, starts[few], BATCH_PERIODS * period)
        actions["heyoka"] = heyoka
    times = _in_turns(repeats, actions)
    counts = count_events().events
    events, ours = int(counts.sum()), times["counts"]
    result: Record = {"motions": count, "events": events, "per_s": count / min(ours)}
    result["ns_per_event"] = {name: min(times[name]) / events * 1e9 for name in COMPARED_RECORDS}
    set_events = int(actions["sets"]().events.sum())
    result["sets_over_starts"] = median(
        (a / set_events) / (b / events) for a, b in zip(times["sets"], ours, strict=True)
    )
    result["scan"] = _peer(times["scan"], count, scan(), counts, ours, count)
    result["heyoka"] = (
        _peer(times["heyoka"], HEYOKA_PHASES, heyoka(), counts, ours, count) if "heyoka" in times else None
    )
    walls = [[_wall(partial(count_events, workers=n)) for n in (1, 2)] for _ in range(repeats + 2)]
    return result | {"two_workers": max(one / two for one, two in walls)}


def _peer(
    times: list[float], motions: int, found: np.ndarray, counts: np.ndarray, ours: list[float], of: int
) -> Record:
    rate = [motions / seconds for seconds in times]
    over = median((of / a) / b for a, b in zip(ours, rate, strict=True))
    missed = np.maximum(counts[:motions] - found, 0)
    return {"per_s": max(rate), "over_ours": over, "missed": int(missed.sum()), "motions": int((missed > 0).sum())}


def _in_turns(repeats: int, actions: dict[str, Callable[[], Any]]) -> dict[str, list[float]]:
    times: dict[str, list[float]] = {name: [] for name in actions}
    for action in actions.values():
        action()
    for _ in range(repeats):
        for name, action in actions.items():
            begin = time.process_time()
            action()
            times[name].append(time.process_time() - begin)
    return times


def _wall(action: Callable[[], Any]) -> float:
    begin = time.perf_counter()
    action()
    return time.perf_counter() - begin


def scan_of_starts(starts: np.ndarray, durations: np.ndarray) -> Callable[[], np.ndarray]:
    """Return a function that counts events of fig9 by the closed form, a scan and a root finder, all compiled."""
    import numba

    motion = Motion(load_scene("fig9").parameters)
    q, s = scalars(motion), peers_scan.scan_of(motion, SCAN_POINTS, SCAN_ACCURACY)
    follow = peers_scan.compiled()["follow"]

    @numba.njit
    def count_all(q, s, starts, durations, counts):
        for i in range(len(starts)):
            t, x, v = starts[i]
            mode = 1 if v < q.v1 else 2 if v < q.v2 else 3
            counts[i] = follow(q, s, t, x, v, mode, 0, 0.0, t + durations[i])[1]

    def run() -> np.ndarray:
        counts = np.zeros(len(starts), np.int64)
        count_all(q, s, starts, durations, counts)
        return counts

    return run


def table(result: Record) -> str:
    """Return the result of `run` as text."""
    r = result
    kinds = ", ".join(f"{name} {ns:.0f}" for name, ns in r["ns_per_event"].items())
    lines = [
        f"{r['motions']:,} starts, {BATCH_PERIODS} periods of fig9, {r['events']:,} events counted, one core: "
        f"{r['per_s']:,.0f} trajectories per second; ns per event: {kinds}",
        f"as many values of Omega: {r['sets_over_starts']:.2f} times the time per event; "
        f"two workers: {r['two_workers']:.2f} times one",
    ]
    names = {"scan": f"closed form, scan {SCAN_POINTS}, numba", "heyoka": "heyoka, batch mode"}
    for key, name in names.items():
        peer = r[key]
        if peer is None:
            lines.append(f"{name}: not installed")
            continue
        missed = f"misses {peer['missed']:,} events of {peer['motions']:,} motions"
        lines.append(f"{name}: {peer['per_s']:,.0f} per second, symosc {peer['over_ours']:.1f} times that; {missed}")
    return "\n".join(lines)
