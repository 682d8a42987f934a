"""What a sweep costs beyond its motions: plan, chunks on disk, and the file of the result."""

from __future__ import annotations

from importlib.util import find_spec
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from symosc.model import PARAMETER_NAMES
from symosc.scenes import load_scene
from symosc.simulation.ensemble import simulate_many
from symosc.sweeps.sweep import sweep

FORCING_PERIODS = 50
SWEPT_COLUMNS = ("word", "events")
# A sweep costs some hundredths of a second once, and 2 percent: the former shows in what is done in a second.
SWEPT_MOTIONS, QUICK_SWEPT_MOTIONS = 300_000, 4_000


def run(quick: bool = False) -> dict[str, Any]:
    """Measure the processor time of a sweep beside that of the bare call with the same motions, in turns.

    An empty dictionary without the extra `sweep`.

    Notes
    -----
    Keys: motions, periods, motions_per_s (in the sweep, for each second of processor time), overhead (of the sweep over
    the bare call, each at its best of the turns).
    """
    if not find_spec("xarray"):
        return {}
    motions = QUICK_SWEPT_MOTIONS if quick else SWEPT_MOTIONS
    scene, values = load_scene("fig9"), np.linspace(-5, 5, motions)
    p: dict[str, Any] = {name: getattr(scene.parameters, name) for name in PARAMETER_NAMES}
    t_end = float(scene.t0) + FORCING_PERIODS * 2 * pi / float(p["Omega"])

    def bare() -> None:
        starts = {"t0": scene.t0, "x0": values, "v0": scene.v0}
        simulate_many(p, starts, t_end, record=(*SWEPT_COLUMNS, "status"))

    def swept(path: Path) -> None:
        sweep(scene, {"x0": values}, t_end=f"{FORCING_PERIODS}T", record=SWEPT_COLUMNS, path=path)

    columns: list[tuple[float, float]] = []
    with TemporaryDirectory() as folder:
        swept(Path(folder) / "first.nc")  # compiles and loads
        bare()
        for i in range(3):
            columns.append((_seconds(bare), _seconds(lambda i=i: swept(Path(folder) / f"{i}.nc"))))
    return {
        "motions": motions,
        "periods": FORCING_PERIODS,
        "motions_per_s": motions / min(b for _, b in columns),
        "overhead": min(b for _, b in columns) / min(a for a, _ in columns) - 1,
    }


def _seconds(action: Any) -> float:
    begin = process_time()
    action()
    return process_time() - begin


def table(result: dict[str, Any]) -> str:
    """Return the result of `run` as text."""
    r = result
    if not r:
        return "sweeps: they need the extra sweep"
    return (
        f"sweep of {r['motions']:,} motions × {r['periods']} periods of fig9, written as netCDF: "
        f"{r['motions_per_s']:,.0f} motions per second of processor time, "
        f"{100 * r['overhead']:+.1f} % over the bare call"
    )
