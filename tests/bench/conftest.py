"""One small run of the benchmark for all of its tests."""

from __future__ import annotations

import pickle
from typing import Any

import pytest
from bench_fakes import PatientWorker
from bench_work import FAKES
from effort import PATIENCE
from once import alone

from symosc.bench import work_precision


@pytest.fixture(scope="session")
def work() -> dict[str, Any]:
    with alone("work-precision") as path:
        if not path.exists():
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(work_precision, "Worker", PatientWorker)
                patch.setattr(work_precision, "SPAN_LIMIT", PATIENCE)
                patch.setattr(work_precision, "BUDGET", 0.01)
                made = work_precision.run(solvers=FAKES, scenes={"fig5": (6, 9, 12), "fig9": (5, 5, 5)})
            path.write_bytes(pickle.dumps(made))
        found: dict[str, Any] = pickle.loads(path.read_bytes())
    return found
