"""All solvers of the benchmarks: the one list."""

from __future__ import annotations

from symosc.bench import ours, peers_cvode, peers_heyoka, peers_numba, peers_scan, peers_scipy

#: The solver whose time is the unit.
OURS = ours.SOLVERS[0]

SOLVERS = (
    *ours.SOLVERS,
    *peers_heyoka.SOLVERS,
    *peers_scan.SOLVERS,
    *peers_numba.SOLVERS,
    *peers_scipy.SOLVERS,
    *peers_cvode.SOLVERS,
)
