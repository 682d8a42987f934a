"""What CONTRIBUTING says of a new solver, done to the letter in a copy."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from project_files import ROOT

pytestmark = pytest.mark.slow

PEERS = """
from symosc import simulate
from symosc.bench.solvers import Solver
from symosc.bench.solvers import SolverEvent


def prepare(scene, tolerance):
    def run():
        return [SolverEvent(e.t + tolerance, e.x, e.kind, e.boundary) for e in simulate(scene).events]

    return run


SOLVERS = (
    Solver("late", prepare, (1e-3, 1e-6), note="all events are late"),
    Solver("absent", prepare, (1e-3,), needs="no_such_module"),
)
"""
USE = """
import json
from symosc.bench import work
from symosc.bench.solvers import all_solvers

if __name__ == "__main__":
    solvers = [solver for solver in all_solvers() if solver.name in ("late", "absent")]
    result = work.run(solvers=solvers, scenes={"fig9": (5, 5, 5)})
    print(work.table(result))
    print(json.dumps(result))
"""


def test_a_solver_is_added_as_contributing_says(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "symosc", tmp_path / "symosc")  # with what is compiled of it
    (tmp_path / "symosc" / "bench" / "peers_late.py").write_text(PEERS)
    (tmp_path / "use.py").write_text(USE)
    done = subprocess.run([sys.executable, "use.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    *table, plain = done.stdout.splitlines()
    rows = json.loads(plain)["rows"]
    assert [(row["solver"], row["tolerance"], row["missed"], row["failure"]) for row in rows] == [
        ("late", 1e-3, 0, ""),
        ("late", 1e-6, 0, ""),
    ]
    assert [row["error_t"] for row in rows] == pytest.approx([1e-3, 1e-6], rel=1e-3)
    assert "late: all events are late" in table
    assert "absent: skipped, no_such_module is not installed (extra `bench`)" in table
