"""Benchmarks: run time and error of this package and of other solvers on the same scenes.

speed and work measure, cases scores solvers on the reference cases, results writes README and
docs/results.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterable, Sequence
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, TypeAlias

from symosc.base.aliases import Record

#: Takes the steps of a run and returns them as an iterable that may show how far it is.
Progress: TypeAlias = Callable[[Sequence[Any]], Iterable[Any]]

PACKAGES = ("numpy", "scipy", "mpmath", "numba", "heyoka")


def machine() -> dict[str, str]:
    """Return the processor, its number of cores, the date, and the versions of symosc, Python and
    the solvers.
    """
    from symosc import __version__

    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    processor = next(filter(None, names), platform.processor() or platform.machine())
    about = {"processor": processor, "cores": str(os.cpu_count()), "date": date.today().isoformat()}
    about |= {"symosc": __version__, "python": platform.python_version()}
    for package in PACKAGES:
        try:
            about[package] = version(package)
        except PackageNotFoundError:
            about[package] = "not installed"
    return about


def sentence(about: dict[str, str]) -> str:
    """Return the description of a machine, `about` as `machine` returns it, in one line of text."""
    versions = [
        f"{name} {value}"
        for name, value in about.items()
        if name not in ("processor", "cores", "date")
    ]
    return f"{about['processor']}, {about['cores']} cores, {about['date']}; {', '.join(versions)}"


def not_run(result: Record) -> list[str]:
    """Return a sentence for each solver that could not run in a benchmark with the results
    `result`; it says why.
    """
    return [f"Not run: {name}: {reason}." for name, reason in result["skipped"].items()]
