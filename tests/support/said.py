"""What calls give, or say when they are refused, and a folder for what they write.

For stored outputs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import chdir, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from symosc import SymoscError


def outcome(call: Callable[[], object], *kinds: type[Exception], before: str = "") -> Any:
    """Return what a call gives, or what its error says.

    After its kind, or after `before` if kinds are given.
    """
    expected = kinds or (SymoscError, TypeError, AttributeError)
    try:
        return call()
    except expected as error:
        if kinds:
            return f"{before}{error}"
        return f"{type(error).__name__}: {error}"


def error_of(call: Callable[[], object]) -> str:
    """Return what the error of a call says, whatever the call gives if there is none."""
    return str(outcome(lambda: (call(), "no error")[1]))


@contextmanager
def empty_folder() -> Iterator[Path]:
    """Work beside an empty folder, whose name is FOLDER wherever it is."""
    with TemporaryDirectory() as top, chdir(top):
        folder = Path("FOLDER")
        folder.mkdir()
        yield folder


def written(write: Callable[[Path], object], name: str = "file") -> str:
    """Return what is in a file that is written."""
    with empty_folder() as folder:
        write(folder / name)
        return (folder / name).read_text(encoding="utf-8")
