"""The lines of the page about sweeps for SLURM and Kubernetes, as far as they run without either."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from effort import PATIENCE

PAGE = (Path(__file__).parents[2] / "docs" / "sweeps.md").read_text(encoding="utf-8")


def lines_of(package: str) -> str:
    """Return the lines of the page that import a package, up to where workers are asked for."""
    blocks = [block for block in re.findall(r"^```\n(.*?)^```$", PAGE, re.M | re.S) if package in block]
    assert len(blocks) == 1
    return blocks[0].partition("cluster.scale(")[0]


def test_a_job_of_slurm_has_a_worker_for_each_core() -> None:
    pytest.importorskip("dask_jobqueue")
    quiet = '"01:00:00", scheduler_options={"dashboard_address": None})'
    code = lines_of("dask_jobqueue").replace('"01:00:00")', quiet)
    assert quiet in code
    code += "if __name__ == '__main__':\n    print(cluster.job_script())\n    cluster.close()\n"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=PATIENCE)
    shown = re.search(r"job_script\(\)\)` shows(.*?)\.\n", PAGE, re.S)
    assert shown
    for option in re.findall(r"`(-.*?)`", shown[1]):
        assert f"#SBATCH {option}\n" in result.stdout, option
    assert re.search(r"--nthreads 1 .*--nworkers 32 ", result.stdout)


def test_the_operator_of_kubernetes_gets_workers_of_one_core() -> None:
    operator = pytest.importorskip("dask_kubernetes.operator")
    given: dict[str, Any] = {}

    class Told:
        def __init__(self, **options: Any) -> None:
            given.update(options)

    scope: dict[str, Any] = {}
    exec(lines_of("dask_kubernetes").replace("cluster = KubeCluster", "cluster = Told"), {"Told": Told}, scope)
    inspect.signature(operator.KubeCluster).bind(**given)
    spec = operator.make_cluster_spec(**given)["spec"]["worker"]["spec"]["containers"][0]
    assert spec["image"] == given["image"]
    assert spec["resources"]["limits"]["cpu"] == "1"
