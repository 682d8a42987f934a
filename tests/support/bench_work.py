"""What tests of the benchmark share: solvers that go wrong, rows of a run of them, and events to compare."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from bench_fakes import careless, failing_later, hanging

from symosc import Parameters
from symosc.bench.ours import SOLVERS as OURS
from symosc.bench.solvers import Solver
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene

FAKES = (
    OURS[0],
    Solver("careless", careless, (1e-3, 1e-6), note="looks away"),
    Solver("careless, raw", careless, (1e-2,), raw=True),
    Solver("hanging", hanging, (1e-3,)),  # type: ignore[arg-type]
    Solver("failing later", failing_later, (1e-3,)),
    Solver("absent", careless, (1e-3,), needs="no_such_module"),
)

SPEED: dict[str, Any] = {
    "machine": {"processor": "P", "cores": "2", "date": "today", "python": "3"},
    "floor_ns": 27.7,
    "rows": [
        {"scene": "fig5", "events": 200000, "evaluations_per_event": 9.1, "ns_per_event": 253.0}
        | {"python_us_per_event": 17.0, "max_error": 1.4e-15, "max_error_estimate": 1.2e-15}
    ],
    "cold_start": {"simulate_fig5_s": 0.24, "import_numpy_s": 0.14},
    "formulas": {"residuals": 1000, "numpy_s": 1.0, "numpy_speedup_over_lambdify": 4.2}
    | {"numpy_speedup_over_lambdify, cse": 1.1, "newton_P4645_ms": 2.9, "orbit_P4645_without_guess_ms": 12.0}
    | {"exact_window_ms": 0.11, "float_window_ns": 125.0},
}


def rows(work: dict[str, Any], solver: str, scene: str) -> list[dict[str, Any]]:
    return [row for row in work["rows"] if (row["solver"], row["scene"]) == (solver, scene)]


def scene_of(p: Parameters, t0: Any, x0: Any, v0: Any, t_end: Any) -> Scene:
    return Scene("test", p, Fraction(t0), Fraction(x0), Fraction(v0), Fraction(t_end))


def assert_same_events(found: list[FoundEvents], events: Any, tolerance: float) -> float:
    """Kinds and boundaries are equal; return the largest error of t and x, which is within `tolerance`."""
    assert [(event.kind, event.boundary) for event in found] == [(event.kind, event.boundary) for event in events]
    errors = [abs(float(b.t - a.t)) for a, b in zip(found, events, strict=True)]
    errors += [abs(float(b.x - a.x)) for a, b in zip(found, events, strict=True)]
    assert max(errors, default=0.0) <= tolerance
    return max(errors, default=0.0)
