"""How long files and functions may be, so that each has one subject."""

from __future__ import annotations

import ast
from pathlib import Path
from statistics import median

import symosc

ROOT = Path(symosc.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))
MOST_LINES, MOST_IN_A_FILE = 60, 400

PROOF = "a derivation that is read from its beginning to its end"
#: Functions that may be longer, and why they are left in one piece.
LONG = {
    "bench/peers_heyoka.py: at_its_best": "callbacks that share their state in the quickest way that Python has",
    "derive/chapters/events.py: _bounds": PROOF,
    "derive/chapters/grazing.py: _contact": PROOF,
    "derive/chapters/grazing.py: _equality": PROOF,
    "derive/chapters/orbits.py: _uniqueness": PROOF,
    "derive/chapters/sticks.py: _exits": PROOF,
}


def lines_of(path: Path) -> int:
    return len(path.read_text(encoding="utf-8").splitlines())


def test_a_function_is_longer_than_a_screen_only_where_it_says_why() -> None:
    """From `def` to its end, with its docstring."""
    found = set()
    for path in FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                assert node.end_lineno is not None
                if node.end_lineno - node.lineno + 1 > MOST_LINES:
                    found.add(f"{path.relative_to(ROOT).as_posix()}: {node.name}")
    assert found <= set(LONG)


def test_no_file_has_more_than_400_lines() -> None:
    long = {path: lines_of(path) for path in FILES if path.name != "_generated.py" and lines_of(path) > MOST_IN_A_FILE}
    assert long == {}


def test_half_of_the_files_have_at_most_200_lines() -> None:
    assert median(map(lines_of, FILES)) <= 200
