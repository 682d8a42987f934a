"""Run pdflatex and extract its error messages."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from symosc.errors import SymoscError

#: Overfull boxes up to this many points are below what the eye sees.
OVERFULL = 5.0


def has_latex() -> bool:
    """Return whether pdflatex is installed."""
    return shutil.which("pdflatex") is not None


def make_pdf(main: Path) -> Path:
    """Compile a document, which may read files in neighbouring folders, and return the PDF's path.

    SymoscError for an error, a warning, or a box that is overfull by more than `OVERFULL` points.
    """
    with tempfile.TemporaryDirectory() as scratch:
        work = Path(scratch)
        shutil.copy(main, work)
        for beside in main.parent.iterdir():
            if beside.is_dir() and beside.name in ("chapters", "figures"):
                shutil.copytree(beside, work / beside.name)
        command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", main.name]
        for _ in range(3):  # until references and the table of contents are right
            result = subprocess.run(command, cwd=work, capture_output=True, check=False, stdin=subprocess.DEVNULL)
            log = (work / main.name).with_suffix(".log").read_text(encoding="latin-1")
            if result.returncode:
                break
        complaints = complaints_of(log)
        if result.returncode and not complaints:
            complaints = ("it failed; see its log",)
        if complaints:
            more = f" and {len(complaints) - 1} more" if complaints[1:] else ""
            raise SymoscError(f"LaTeX: {complaints[0]}{more}")
        return Path(shutil.copy((work / main.name).with_suffix(".pdf"), main.parent))


def complaints_of(log: str) -> tuple[str, ...]:
    """Return the errors, the warnings and the overfull boxes of a LaTeX log."""
    found = []
    for line in log.splitlines():
        box = re.match(r"Overfull \\[hv]box \(([\d.]+)pt", line)
        if line.startswith("!") or "Warning" in line or (box and float(box[1]) > OVERFULL):
            found.append(line.strip())
    return tuple(found)
