"""The package's own ways to follow a scene, in the form of the other solvers."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from symosc.bench.solvers import Late, Solver
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.simulate import ACCURACY, simulate

#: One that doubles keep on all shipped scenes, and the default, for which fig8 is computed again with mpmath.
OUR_ACCURACIES = (1e-9, ACCURACY)


def compiled(scene: Scene, tolerance: float) -> Callable[[], Sequence[FoundEvents]]:
    """Prepare `simulate_many`; the tolerance is its `accuracy`, the estimated error that asks for a closer look."""
    start, known = [scene.t0, scene.x0, scene.v0], scene.start_error

    def run() -> Late:
        table = simulate_many(scene.parameters, start, scene.t_end, accuracy=tolerance, start_error=known)

        def rows() -> list[FoundEvents]:
            columns = (table.t, table.x, table.kind, table.boundary)
            return list(map(FoundEvents, *(column.tolist() for column in columns)))

        return Late(rows)

    return run


def multiprecision(scene: Scene, tolerance: float) -> Callable[[], Sequence[FoundEvents]]:
    """Prepare `simulate` with mpmath; the tolerance says how many digits."""
    digits = max(5, len(f"{1 / tolerance:.0f}") - 1)

    def run() -> list[FoundEvents]:
        events = simulate(scene, digits=digits).events
        return [FoundEvents(float(event.t), float(event.x), event.kind, event.boundary) for event in events]

    return run


SOLVERS = (
    Solver("symosc, compiled", compiled, OUR_ACCURACIES, needs="numba"),
    Solver("symosc, mpmath", multiprecision, (1e-20,)),
)
