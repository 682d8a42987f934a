"""Digests of what calls return, for tests that compare programs with other caches, clocks, workers and chunks.

As a program it prints them as JSON. Its first argument is the clock that it goes by, a second one a
sweep to begin.
"""

from __future__ import annotations

import hashlib
import json
import random
import sys
import time
from fractions import Fraction
from itertools import count
from typing import Any

#: A clock that stands still (an endlessly fast machine), and one that goes on by a day at each look
#: (a slow one).
CLOCKS: dict[str, Any] = {"standing": lambda: 0.0, "rushing": count(0.0, 86400.0).__next__}
SWEEP: dict[str, Any] = {
    "over": {"Omega": "3.9:4.5:12", "FN": [2, 10]},
    "record": ("word", "multiplicity", "x", "v", "stuck", "x_max", "section:2"),
    "t_end": "60T",
}


def digest(columns: Any) -> str:
    """Return a digest of arrays, byte by byte."""
    whole = hashlib.sha256()
    for column in columns:
        whole.update(f"{column.dtype} {column.shape}".encode() + column.tobytes())
    return whole.hexdigest()


def motions() -> list[tuple[str, Any, list[Any], Any, Any]]:
    """Return (name, parameters, starts, ends, accuracy) of motions of which doubles leave some in doubt."""
    from symosc import load_scene

    fig8 = load_scene("fig8")
    fig9 = load_scene("fig9")
    dice = random.Random(5)
    sets = [
        fig8.parameters.replace(A0=fig8.parameters.A0 + Fraction(dice.randint(-99, 99), 100))
        for _ in range(8)
    ]
    starts = [
        (Fraction(dice.randint(0, 50), 10), Fraction(dice.randint(-600, 600), 100), 0) for _ in sets
    ]
    locked = fig9.parameters.replace(Omega="4.247491638795987", FN=2)
    return [
        ("locked", locked, [(fig9.t0, fig9.x0, fig9.v0), (0, 0, 0)], 300, None),
        (
            "near a graze",
            fig8.parameters,
            [(fig8.t0, fig8.x0 + Fraction(n, 50), fig8.v0) for n in range(6)],
            12,
            5e-16,
        ),
        (
            "short sticks",
            fig8.parameters,
            [(fig8.t0, fig8.x0 + n, fig8.v0) for n in range(2)],
            70,
            None,
        ),
        ("many sets", sets, starts, [t0 + 12 for t0, _, _ in starts], 3e-16),
    ]


def digests(workers: int | None = None) -> dict[str, str]:
    """Return a digest of each call."""
    import numpy as np

    from symosc import Parameters, simulate, simulate_many, sweep

    found: dict[str, str] = {}
    for name, parameters, starts, ends, accuracy in motions():
        given: Any = {"accuracy": accuracy, "workers": workers}
        table = simulate_many(parameters, starts, ends, **given)
        found[f"events, {name}"] = digest(table.columns().values())
        summary = simulate_many(parameters, starts, ends, record="summary", sections=2, **given)
        found[f"summary, {name}"] = digest(summary.columns().values())
    dataset = sweep("fig9", **SWEEP, workers=workers)
    found["sweep"] = digest(
        dataset[name].values.astype(str).astype("S") for name in dataset.data_vars
    )
    lasting = Parameters(
        m="4.52", c="6.6e-10", k="3.2654289469", A0=0, B0="0.935", Omega="0.85", v1="-39.7", v2="-34.01", mu1="0.491",
        mu2="0.75", FN="0.909",
    )  # fmt: skip
    alone = {
        "fine": simulate("fig8", accuracy=1e-15),
        "short sticks": simulate("fig8", t_end=70),
        "long in doubt": simulate(lasting, x0="0.09724", v0="-39.7", t_end=900),
    }
    for name, trajectory in alone.items():
        rows = [(event.t, event.x, event.t_error, event.x_error) for event in trajectory.events]
        found[f"alone, {name}"] = digest([np.array(rows), trajectory._pieces])
    return found


def stop(path: str) -> Any:
    """Begin a sweep and stop it after its first chunk, of five motions.

    Return how many were done.
    """
    from symosc import sweep
    from symosc.sweeps import sweep as run

    run.FIRST_CHUNK = 5

    def interrupt(done: int, of: int) -> None:
        raise KeyboardInterrupt(done)

    try:
        sweep("fig9", **SWEEP, path=path, progress=interrupt)
    except KeyboardInterrupt as stopped:
        return {"done": stopped.args[0]}


def whole() -> Any:
    """Return the digests, and whether compiled loops for doubles and for pairs were loaded."""
    results = digests()
    from symosc.engine import arithmetic

    loops = arithmetic.compiled()["follow_all"], arithmetic.compiled_pairs().follow_pairs
    return {"digests": results, "loaded": [bool(loop.overloads) for loop in loops]}


if __name__ == "__main__":
    if clock := CLOCKS.get(sys.argv[1]):
        time.time = time.monotonic = time.perf_counter = time.process_time = clock
    print(json.dumps(stop(*sys.argv[2:]) if sys.argv[2:] else whole()))
