"""One small run of the benchmark for all of its tests."""

from __future__ import annotations

from typing import Any

import pytest
from bench_work import FAKES

from symosc.bench import work_precision


@pytest.fixture(scope="session")
def work() -> dict[str, Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(work_precision, "SPAN_LIMIT", 1.0)
        patch.setattr(work_precision, "BUDGET", 0.01)
        return work_precision.run(solvers=FAKES, scenes={"fig5": (6, 9, 12), "fig9": (5, 5, 5)})
