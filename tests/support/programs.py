"""C++ programs of the tests, compiled on first use with g++ where that is installed."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path


@cache
def built(source: Path, *flags: str) -> Path | None:
    """Return the compiled program, or None without a compiler or a library that it needs."""
    compiler = shutil.which("g++")
    if compiler is None:
        return None
    mark = hashlib.sha256(source.read_bytes()).hexdigest()[:16]
    path = Path(tempfile.gettempdir()) / f"symosc-{source.stem}-{mark}"
    if not path.exists():
        with tempfile.TemporaryDirectory(dir=path.parent) as folder:
            draft = Path(folder) / "program"
            if (
                subprocess.run(
                    [compiler, "-O2", "-o", draft, source, *flags], capture_output=True
                ).returncode
                != 0
            ):
                return None
            os.replace(draft, path)  # whole, also for other processes that compile it
    return path
