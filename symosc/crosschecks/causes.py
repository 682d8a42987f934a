"""Causes that a diagnosis names, what it says about one, and the change that tests it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from symosc.model import Parameters

#: Causes by name, in words.
CAUSES = {
    "coefficient": "a wrong coefficient",
    "sign": "a wrong sign",
    "swapped belts": "the belts' frictions are swapped",
    "columns": "the columns are not what they are called",
    "time shift": "the clock is shifted",
    "phase": "another phase of the drive",
    "forces": "wrong forces in the domains",
    "smoothed friction": "smoothed friction",
    "chatter": "chatter about a belt's speed",
    "drift": "drift off a belt in a stick",
    "late events": "events are not located, but happen late",
    "event interpolation": "events are located by linear interpolation",
    "resampling": "the samples are interpolated between others",
    "double root": "missed double roots",
    "stick left early": "sticks are left too early",
    "stick left late": "sticks are left too late",
    "truncation": "truncation error of the method",
    "noise": "noise",
    "outlier": "samples off by themselves",
    "precision": "the samples have few digits",
    "missing events": "the list lacks events",
    "invented events": "the list has events that are none",
    "event times": "the list has events at wrong times",
    "start": "another start, or errors that add up",
    "unknown": "no known cause",
}


@dataclass(frozen=True)
class Diagnosis:
    """What is probably wrong in a solution.

    Attributes
    ----------
    cause : str
        One of CAUSES.
    subject : str
        What it is about: a parameter ("mu1"), a column ("x"), a method ("euler"); "" if nothing.
    words : str
        The diagnosis in a sentence.
    evidence : str
        What speaks for it.
    value, error : float or None
        The number that was estimated, and its standard deviation.
    share : float
        Part of the wrong steps that it explains, at most 1.
    alternatives : tuple of Diagnosis
        What explains the samples as well: they cannot tell these apart.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, load_scene, simulate
    >>> p = load_scene("fig5").parameters
    >>> t = np.linspace(0, 20, 400)
    >>> x, v = simulate(p.replace(B0=10.3), x0=0, v0=0, t_end=20)(t)
    >>> print(crosscheck("fig5", t, x, v).diagnosis[0].words)
    the solution has B0 = 10.3, which should be 10
    """

    cause: str
    subject: str
    words: str
    evidence: str
    value: float | None = None
    error: float | None = None
    share: float = 1.0
    alternatives: tuple[Diagnosis, ...] = ()


class Change(NamedTuple):
    """What to change before a check is repeated: the system, or the columns t, x, v (v None: positions alone)."""

    words: str
    parameters: Parameters | None = None
    columns: Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray | None]] | None = (
        None
    )


class Candidate(NamedTuple):
    """A diagnosis, and the change with which the steps should be right, if it can be made."""

    diagnosis: Diagnosis
    change: Change | None = None
