"""A solver that goes wrong as the scene's name says, in a module that a worker process imports fast."""

from __future__ import annotations

import os
from typing import Any

from symosc.bench import ours
from symosc.bench.event_logic import PeerError
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene


def moody(scene: Scene, tolerance: float) -> Any:
    """Prepare a solver that behaves as the scene's name says."""
    if scene.name == "refuses":
        raise ValueError("not this one")

    def run() -> list[FoundEvents]:
        found = ours.multiprecision(scene, 1e-20)()
        if scene.name == "dies":
            os._exit(3)
        if scene.name == "chatters":
            raise PeerError("chatters between Omega1 and belt1")
        if scene.name == "misses":
            del found[1]
        if scene.name == "invents":
            found.insert(1, found[0]._replace(t=found[0].t + 1e-3))
        return [event._replace(x=event.x + tolerance) for event in found]

    return run
