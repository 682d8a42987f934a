"""Run pdflatex and extract its error messages."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from symosc.errors import SymoscError


def has_latex() -> bool:
    """Return whether pdflatex is installed."""
    return shutil.which("pdflatex") is not None


def make_pdf(main: Path) -> Path:
    """Compile a LaTeX document; return the PDF's path; SymoscError for errors, warnings, lines 5 pt too wide."""
    with tempfile.TemporaryDirectory() as scratch:
        work = Path(scratch)
        shutil.copy(main, work)
        for name in ("chapters", "figures"):
            if (main.parent / name).is_dir():
                shutil.copytree(main.parent / name, work / name)
        command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", main.name]
        for _ in range(3):  # until references and the table of contents are right
            result = subprocess.run(command, cwd=work, capture_output=True, check=False, stdin=subprocess.DEVNULL)
            log = (work / main.name).with_suffix(".log").read_text(encoding="latin-1")
            if result.returncode:
                break
        complaints = complaints_of(log) or (("it failed",) if result.returncode else ())
        if complaints:
            raise SymoscError(f"LaTeX: {complaints[0]}" + f" and {len(complaints) - 1} more" * bool(complaints[1:]))
        return Path(shutil.copy((work / main.name).with_suffix(".pdf"), main.parent))


def complaints_of(log: str) -> tuple[str, ...]:
    """Return the errors, warnings and overfull boxes reported in the text of a LaTeX log."""
    found = []
    for line in log.splitlines():
        box = re.match(r"Overfull \\[hv]box \(([\d.]+)pt", line)
        if line.startswith("!") or "Warning" in line or (box and float(box[1]) > 5):
            found.append(line.strip())
    return tuple(found)
