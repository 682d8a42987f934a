"""What holds for all tests, and what is made once for all of them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.hookimpl(tryfirst=True)  # before `-m` selects
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A campaign is slow as well, so that `-m "not slow"` leaves it out."""
    for item in items:
        if item.get_closest_marker("campaign"):
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """Return the folder of one run of `symosc reproduce`; workers wait for the one that makes it.

    The environment variable SYMOSC_REPORT names one that was just made.
    """
    import fcntl

    if made := os.environ.get("SYMOSC_REPORT"):
        assert (Path(made) / "report.json").is_file(), f"no report in SYMOSC_REPORT = {made}"
        return Path(made)

    base = tmp_path_factory.getbasetemp()
    shared = base.parent if hasattr(request.config, "workerinput") else base
    folder = shared / "whole-report"
    with open(shared / "whole-report.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not folder.exists():
            command = [sys.executable, "-m", "symosc", "reproduce", "-o", str(folder)]
            result = subprocess.run(command, capture_output=True, text=True, check=False)
            assert (result.returncode, result.stderr) == (0, ""), result.stdout
    return folder
