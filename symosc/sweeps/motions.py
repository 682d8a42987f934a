"""A chunk of a sweep: some of its motions, followed, and what is recorded of them."""

from __future__ import annotations

import hashlib
import os
from functools import cache
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, NamedTuple

import numpy as np

import symosc
from symosc.errors import SweepError
from symosc.scenes import START_NAMES
from symosc.simulation.ensemble import simulate_many

#: What decides the numbers of a motion: changed sources make another plan.
DECISIVE = ("kernels", "engine", "simulation", "exact.py", "model.py")
#: What can be recorded, by the names of `simulate_many`'s summaries.
RECORDED = (
    "word",
    "multiplicity",
    "events",
    "sticks",
    "stuck",
    "status",
    "t",
    "x",
    "v",
    "mode",
    "x_min",
    "x_max",
    "v_min",
    "v_max",
    "section",
)


class Share(NamedTuple):
    """What computes a chunk, wherever it is sent: plain numbers and arrays.

    Attributes
    ----------
    motions : int
    columns : dict of str to number or array
        All parameters.
    starts : tuple of three numbers or arrays
        t0, x0, v0.
    t_end, skip : number or array
    record : tuple of str
    sections : int
    start_error : tuple of three Fractions, or None
    kernels : str
        Hash of the sources that are to compute it.
    """

    motions: int
    columns: dict[str, Any]
    starts: tuple[Any, Any, Any]
    t_end: Any
    skip: Any
    record: tuple[str, ...]
    sections: int
    start_error: Any
    kernels: str


class Chunk(NamedTuple):
    """What a share gives: a column per name, with the statuses always, and the processor time that it took."""

    columns: dict[str, np.ndarray]
    seconds: float


def computed(share: Share, workers: int | None = 1) -> Chunk:
    """Follow the motions of a share.

    Raises
    ------
    SweepError
        If the sources here are not those that made the plan: a worker with another version of symosc.
    """
    if share.kernels != kernels_hash():
        raise SweepError("a worker has another version of symosc than this program")
    wall, processor = perf_counter(), process_time()
    columns = chunk_of_motions(share, workers)
    threads = workers or os.cpu_count() or 1
    # Other programs make the first too long, other threads of this one the second.
    return Chunk(columns, min((perf_counter() - wall) * threads, process_time() - processor))


def chunk_of_motions(share: Share, workers: int | None) -> dict[str, np.ndarray]:
    """Return what is recorded of each motion of a share."""
    names = tuple(dict.fromkeys((*share.record, "status")))
    starts = dict(zip(START_NAMES, share.starts, strict=False))
    found = simulate_many(
        share.columns,
        starts,
        share.t_end,
        record=names,
        skip=share.skip,
        sections=share.sections,
        start_error=share.start_error,
        workers=workers,
    )
    columns: dict[str, np.ndarray] = found.columns()
    if "word" in columns:
        columns["word"] = cycles(columns["word"])
    return columns


def cycles(words: np.ndarray) -> np.ndarray:
    """Return words so that all that are one cycle, such as P32 and P23, are the same: its rotation largest in text.

    Where a cycle is cut into periods depends on the phases of its events, and so on the parameters; a map over them
    shows borders only where the cycle itself changes.
    """
    texts, places = np.unique(words, return_inverse=True)
    return np.array([_largest_rotation(str(text)) for text in texts])[places]


def _largest_rotation(word: str) -> str:
    labels = word[1:]
    return word[:1] + max((labels[i:] + labels[:i] for i in range(len(labels))), default="")


@cache
def kernels_hash() -> str:
    """Return a hash of the sources that decide the numbers of a motion."""
    root, digest = Path(symosc.__file__).parent, hashlib.sha256()
    for name in DECISIVE:
        path = root / name
        for source in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
