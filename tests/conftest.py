"""What holds for all tests, and what is made once for all of them."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Generator
from fnmatch import fnmatch
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import compiling
import pytest
from once import SHARED, alone

#: Files and folders of tests that need an optional package, and cases of others: left out where it
#: is not installed.
NEED = {
    "flint": "certificates cli/test_certify.py cli/test_score.py reference/test_folder.py reference/test_score.py "
    "reference/test_cases.py",
    "pyarrow": "crosschecks/test_objects.py",
    "h5netcdf": "sweeps/test_output.py sweeps/test_plan.py sweeps/test_sweep.py",
}
NEED_CASES = {
    "flint": "simulation/test_results_compare.py::"
    "test_what_a_public_function_returns_is_public_documented_and_comparable[certify]",
    "pyarrow": "crosschecks/test_files.py::*.parquet] crosschecks/test_files.py::*.pq] "
    "crosschecks/test_files.py::*.feather] crosschecks/test_files.py::*.arrow] "
    "crosschecks/test_files.py::test_wrong_columns_and_no_numbers_are_named",
    "h5netcdf": "crosschecks/test_files.py::*[xarray.nc]",
}
#: A run of so many slow tests has the loops compiled; a run of a few does not wait for that.
MANY_SLOW = 100
MISSING = [name for name in NEED if find_spec(name) is None]
collect_ignore = [path for name in MISSING for path in NEED[name].split()]


def pytest_configure(config: pytest.Config) -> None:
    """Make the folder that the workers share.

    Give each of them tests that stand together, which share the most.
    """
    if (
        signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    ):  # a shell's background job; tests send interrupts
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if getattr(config.option, "dist", "no") == "load":  # what pytest-xdist takes if nothing is said
        config.option.dist = "worksteal"
    if not hasattr(config, "workerinput"):  # the first process
        # Else each program that a test starts, and each worker, compiles the package and the tests
        # anew.
        if os.environ.pop("PYTHONDONTWRITEBYTECODE", None):
            sys.dont_write_bytecode = False
        os.environ[SHARED] = folder = tempfile.mkdtemp(prefix="symosc-tests-")
        config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Spare the garbage collector what stays to the end.

    Half a million objects of modules and tests.

    Later it looks at all others after millions of new ones, not after 70,000: that took a tenth of
    the time.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(5_000, 20, 25)
        gc.enable()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> Generator[None, object, object]:
    """Mark what is left out.

    Of a test with `full(n)` all but n cases are a campaign, and a campaign is slow as well.

    Of a test with `quick(n)` all but n cases of those that are left are slow. When `-m` has
    selected, the tests are put in order.
    """
    _leave_out_without_extras(items)
    _leave_out(items, "full", unless="campaign", mark="campaign")
    for item in items:
        if item.get_closest_marker("campaign"):
            item.add_marker("slow")
    _leave_out(items, "quick", unless="slow", mark="slow")
    result = yield
    workers = getattr(config, "workerinput", {"workercount": 1})["workercount"]
    items[:] = _in_order(items, workers)
    return result


def _in_order(items: list[pytest.Item], workers: int) -> list[pytest.Item]:
    """Return tests in an order in which few wait for compiled loops; those for pairs come last.

    Each of the workers begins with an equal part of them all: quick ones, and then those that need
    loops. Many slow ones need the loops as well: what follows long motions is ten times as fast.
    """
    slow = [item for item in items if item.get_closest_marker("slow")]
    if len(slow) >= MANY_SLOW:
        for item in slow:
            if not item.get_closest_marker("compiled"):
                item.add_marker(pytest.mark.compiled("doubles"))
    stages: dict[str, list[pytest.Item]] = {"": [], "doubles": [], "pairs": []}
    for item in items:
        stages[_loops(item)].append(item)
    last = stages.pop("pairs")
    ordered = []
    for worker in range(workers):
        for stage in stages.values():
            begin, end = (len(stage) * number // workers for number in (worker, worker + 1))
            ordered += stage[begin:end]
    return ordered + last


def _leave_out_without_extras(items: list[pytest.Item]) -> None:
    """Skip the cases that need a package that is not installed."""
    for name in MISSING:
        patterns = [f"*{each.replace('[', '[[]')}*" for each in NEED_CASES[name].split()]
        for item in items:
            if any(fnmatch(item.nodeid, pattern) for pattern in patterns):
                item.add_marker(pytest.mark.skip(reason=f"{name} is not installed"))


def _loops(item: pytest.Item) -> str:
    """Return which compiled loops a test needs: "" for none, then "doubles", then "pairs"."""
    marker = item.get_closest_marker("compiled")
    if marker:
        return str(marker.args[0])
    return ""


def pytest_collection_finish(session: pytest.Session) -> None:
    """Have the loops compiled if a test needs them; of several workers the first one sees to it."""
    worker = getattr(session.config, "workerinput", {"workerid": "gw0"})["workerid"]
    if session.config.option.collectonly:
        wanted = ""
    else:
        wanted = max(map(_loops, session.items), default="")
    if wanted and not compiling.is_there(wanted):
        compiling.leave_to_the_other()
    if worker == "gw0" and wanted and (process := compiling.begin(wanted)):
        others_wait = hasattr(session.config, "workerinput")
        session.config.add_cleanup(partial(compiling.end, process, others_wait))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Let a test that needs compiled loops begin when they are there."""
    if loops := _loops(item):
        compiling.wait(loops)
        compiling.load()


def _leave_out(items: list[pytest.Item], marker: str, unless: str, mark: str) -> None:
    """Mark all but n cases of each test with `marker(n)`; those that stay are evenly spread."""
    tests: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker(marker) and not item.get_closest_marker(unless):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in tests.values():
        (wanted,) = cases[0].get_closest_marker(marker).args  # type: ignore[union-attr]
        wanted = min(wanted, len(cases))
        kept = {(2 * i + 1) * len(cases) // (2 * wanted) for i in range(wanted)}
        for i in set(range(len(cases))) - kept:
            cases[i].add_marker(mark)


@pytest.fixture(scope="session")
def report() -> Path:
    """Return the folder of one run of `symosc reproduce`; workers wait for the one that makes it.

    It has the chapters from the tests of the derivations, or they have them from here: each step is
    checked once. The environment variable SYMOSC_REPORT names one that was just made.
    """
    if made := os.environ.get("SYMOSC_REPORT"):
        assert (Path(made) / "report.json").is_file(), f"no report in SYMOSC_REPORT = {made}"
        return Path(made)

    with alone("whole-report") as folder:
        if not folder.exists():
            program = str(Path(__file__).parent / "support" / "whole_report.py")
            command = [sys.executable, program, "reproduce", "-o", str(folder)]
            result = subprocess.run(command, capture_output=True, text=True, check=False)
            assert result.returncode == 0, result.stdout
            (said,) = result.stderr.splitlines()
            assert said.startswith("symosc: reproduce judges "), result.stderr
    return folder


@pytest.fixture
def interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let CPython follow single motions, whose functions a test replaces, whatever this process has compiled."""
    monkeypatch.setattr("symosc.simulation.loops.loaded_loop", lambda: None)
