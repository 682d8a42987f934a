"""Derivatives of the events of many motions: what the loop of `symosc.engine.tangent` needs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from symosc.base.errors import ParameterError, meant
from symosc.engine.batch import EventRows, large_array
from symosc.engine.events import CODE_COLUMNS, FLOAT_COLUMNS
from symosc.engine.tangent import K_, OMEGA, PARAMETERS, SIZE, C, M
from symosc.model import PARAMETER_NAMES, Model
from symosc.simulation.problems import START_COLUMNS

#: What a motion is differentiated by; and all names in the order of the codes of
#: `symosc.engine.tangent`.
STATIC_NAMES = ("mu_s1", "mu_s2")
NAMES = (*PARAMETER_NAMES, *START_COLUMNS)
CODED = (*PARAMETER_NAMES, *STATIC_NAMES, *START_COLUMNS)


def names_of(p: Model) -> tuple[str, ...]:
    """Return all names with respect to which a motion can be differentiated.

    A belt whose static coefficient equals the kinetic one has one coefficient, mu.
    """
    equal = [f"mu_s{n}" for n, belt in enumerate(p.law.belts, 1) if belt.mu_s in (None, belt.mu)]
    own = [name for name in p.numbers() if name not in equal]
    return (*own, *START_COLUMNS)


def read_wrt(wrt: Any, known: Sequence[str] = NAMES) -> tuple[str, ...]:
    """Return the names with respect to which to differentiate.

    ParameterError if one is not `known` or given twice.
    """
    if isinstance(wrt, str):
        names: tuple[str, ...] = (str(wrt),)
    elif hasattr(type(wrt), "dtype"):
        names = tuple(np.asarray(wrt).tolist())
    else:
        names = tuple(wrt)
    for name in names:
        if name not in known:
            raise ParameterError(
                "wrt", name, f"must be one of {', '.join(known)}{meant(str(name), known)}"
            )
    if not names or len(set(names)) < len(names):
        raise ParameterError("wrt", names, "must be one or more different names")
    return names


def codes_of(wrt: Sequence[str]) -> np.ndarray:
    """Return the engine's code for each name with respect to which to differentiate."""
    return np.array([CODED.index(name) for name in wrt], dtype=np.int64)


def is_deep(codes: np.ndarray) -> bool:
    """Return whether any code is that of m, c, k or Omega: derivatives by these take more work."""
    return bool(np.isin(codes, (M, C, K_, OMEGA)).any())


def work_space(codes: np.ndarray, kind: Any = float) -> np.ndarray:
    """Return scratch memory for derivatives by `codes`, for one motion at a time, with numbers of
    type `kind`.
    """
    return np.zeros((SIZE + 3, max(len(codes), PARAMETERS)), dtype=kind)


def event_changes(
    events: EventRows,
    launches: tuple[np.ndarray, ...],
    wrt: tuple[str, ...],
    loop: Callable[..., None],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return dt, dx and regular of `events` by each of `wrt`.

    `launches` is what `Chunk.launches` returns.
    """
    (starts, sets, letters, table) = launches
    codes = codes_of(wrt)
    shape = (events.floats.shape[1], len(wrt))
    cuts = np.searchsorted(events.ints[0], np.arange(len(starts) + 1))
    dt = large_array(shape)
    dx = large_array(shape)
    marks = np.zeros(shape, np.int8)
    why = np.zeros(shape[0], np.int8)
    motions = np.flatnonzero(np.diff(cuts))
    rows = columns_of(events)
    out = (dt, dx, marks, why, np.zeros((0, 2)))
    loop(
        motions,
        cuts,
        starts,
        sets,
        rows,
        codes,
        is_deep(codes),
        letters,
        table,
        out,
        work_space(codes),
    )
    return dt, dx, marks == 1


def columns_of(events: EventRows) -> tuple[np.ndarray, ...]:
    """Return t, theta, x, v, kind, boundary and target of events, each as an array."""
    floats = [events.floats[FLOAT_COLUMNS.index(name)] for name in ("t", "theta", "x", "v")]
    codes = [
        events.ints[1 + CODE_COLUMNS.index(name)].astype(np.int64)
        for name in ("kind", "boundary", "target")
    ]
    return *floats, *codes
