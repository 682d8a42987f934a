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
    if path.exists():
        return path
    import fcntl

    # Workers ask at the same time: one of them compiles, which takes some seconds.
    with open(f"{path}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        try:
            return path if path.exists() else _compiled(compiler, source, flags, path)
        finally:
            fcntl.flock(lock, fcntl.LOCK_UN)


def _compiled(compiler: str, source: Path, flags: tuple[str, ...], path: Path) -> Path | None:
    """Compile a program, and return its path, or None if the compiler refuses it."""
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        draft = Path(folder) / "program"
        command = [compiler, "-O2", "-o", str(draft), str(source), *flags]
        done = subprocess.run(command, capture_output=True, check=False)
        if done.returncode != 0:
            return None
        os.replace(draft, path)  # whole, whoever looks meanwhile
    return path
