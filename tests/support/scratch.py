"""A copy of the project in which a test does what CONTRIBUTING says, to the letter."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from project_files import ROOT


class Scratch:
    """A copy of package, tests and pages in a folder, with the compiled code of what is unchanged."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for path in ROOT.iterdir():
            if path.name in ("symosc", "tests", "docs", "derivations", ".ci"):
                shutil.copytree(path, folder / path.name)
            elif path.is_file():
                shutil.copy(path, folder)

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text, encoding="utf-8")

    def replace(self, name: str, old: str, new: str) -> None:
        """Replace a text that is in a file once."""
        text = (self.folder / name).read_text(encoding="utf-8")
        assert text.count(old) == 1, (name, old, text.count(old))
        self.write(name, text.replace(old, new))

    def run(self, *module: str) -> str:
        """Return what ``python -m`` prints there; it must succeed."""
        done = subprocess.run(
            [sys.executable, "-m", *module], cwd=self.folder, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
        return done.stdout

    def pytest(self, *tests: str, only: str = "") -> str:
        """Run the quick tests of some files, those whose name fits `only`."""
        options = ("-q", "-m", "not slow and not campaign", "-p", "no:cacheprovider", "-k", only)
        return self.run("pytest", *options, *tests)
