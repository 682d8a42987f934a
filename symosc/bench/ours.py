"""This package's own ways to follow a scene, in the form of the other solvers."""

from __future__ import annotations

from collections.abc import Callable

from symosc.batch import simulate_many
from symosc.bench.solvers import Found, Solver
from symosc.scenes import Scene
from symosc.simulation import simulate


def compiled(scene: Scene, tolerance: float) -> Callable[[], list[Found]]:
    """Prepare `simulate_many`; there is no tolerance to choose."""
    start = [scene.t0, scene.x0, scene.v0]

    def run() -> list[Found]:
        table = simulate_many(scene.parameters, start, scene.t_end)
        columns = (table.t, table.x, table.kind, table.boundary)
        return [Found(*row) for row in zip(*(column.tolist() for column in columns), strict=True)]

    return run


def multiprecision(scene: Scene, tolerance: float) -> Callable[[], list[Found]]:
    """Prepare `simulate` with mpmath; the tolerance says how many digits."""
    digits = max(5, len(f"{1 / tolerance:.0f}") - 1)

    def run() -> list[Found]:
        events = simulate(scene, digits=digits).events
        return [Found(float(event.t), float(event.x), event.kind, event.boundary) for event in events]

    return run


SOLVERS = (
    Solver("symosc, compiled", compiled, (0.0,), needs="numba"),
    Solver("symosc, mpmath", multiprecision, (1e-20,)),
)
