"""Benchmarks: run time and error of this package and of other solvers on the same scenes.

speed, work and error_map measure, cases scores on the reference cases, results writes README and docs/results.
"""

from __future__ import annotations

import os
import platform
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("numpy", "scipy", "mpmath", "numba", "heyoka", "scikit-sundae")


def machine() -> dict[str, str]:
    """Return the processor, its number of cores, the date, and the versions of symosc, Python and the solvers."""
    from symosc import __version__

    def installed(package: str) -> str:
        try:
            return version(package)
        except PackageNotFoundError:
            return "not installed"

    about = {"processor": _processor(), "cores": str(os.cpu_count()), "date": date.today().isoformat()}
    about |= {"symosc": __version__, "python": platform.python_version()}
    return about | {package: installed(package) for package in PACKAGES}


def sentence(about: dict[str, str]) -> str:
    """Return the result of `machine` as text."""
    versions = [f"{name} {value}" for name, value in about.items() if name not in ("processor", "cores", "date")]
    return f"{about['processor']}, {about['cores']} cores, {about['date']}; {', '.join(versions)}"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return next(filter(None, names), platform.processor() or platform.machine())
