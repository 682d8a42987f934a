"""How long files may be, so that each has one subject; `test_layers` says how long functions may be."""

from __future__ import annotations

from pathlib import Path
from statistics import median

import symosc

FILES = sorted(Path(symosc.__file__).parent.rglob("*.py"))


def lines_of(path: Path) -> int:
    return len(path.read_text(encoding="utf-8").splitlines())


def test_no_file_has_more_than_400_lines() -> None:
    long = {path: lines_of(path) for path in FILES if path.name != "_generated.py" and lines_of(path) > 400}
    assert long == {}


def test_half_of_the_files_have_at_most_200_lines() -> None:
    assert median(map(lines_of, FILES)) <= 200
