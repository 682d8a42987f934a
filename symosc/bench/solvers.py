"""What a solver is to the benchmarks: scene and tolerance in, switching events out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from typing import Any

from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene


class Late(Sequence[FoundEvents]):
    """Events that become Python objects when they are looked at: a solver that works in arrays is timed without that.

    Parameters
    ----------
    make : callable
        Returns the events.
    """

    def __init__(self, make: Callable[[], Sequence[FoundEvents]]) -> None:
        self._make = make

    @cached_property
    def events(self) -> Sequence[FoundEvents]:
        """The events."""
        return self._make()

    def __len__(self) -> int:
        return len(self.events)

    def __getitem__(self, index: Any) -> Any:
        return self.events[index]


@dataclass(frozen=True)
class Solver:
    """A way to follow a scene.

    Attributes
    ----------
    name : str
        What tables and plots call it.
    prepare : callable
        ``prepare(scene, tolerance)`` returns a function without arguments that follows the scene from its start to its
        end and returns its events, `Late` where they come in arrays. What a user would do once (compile, build the
        integrator) is done in `prepare`.
    tolerances : tuple of float
        What a work-precision curve runs through, coarse to fine; one entry 0.0 for a solver without a tolerance.
    needs : str
        The module that must be importable, "" if it comes with symosc.
    raw : bool
        True if the peer is used as it comes, without the precautions that its traps ask for.
    note : str
        What its precautions are, or what a user of the raw one would not have known.
    """

    name: str
    prepare: Callable[[Scene, float], Callable[[], Sequence[FoundEvents]]]
    tolerances: tuple[float, ...]
    needs: str = ""
    raw: bool = False
    note: str = ""

    @property
    def missing(self) -> str:
        """Say why the solver cannot run here; "" if it can."""
        if not self.needs or find_spec(self.needs) is not None:
            return ""
        return f"{self.needs} is not installed (extra `bench`)"
