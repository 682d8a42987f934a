"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from symosc.errors import OutputError


def write_whole(path: str | Path, write: Callable[[Path], None]) -> Path:
    """Let `write` fill a draft beside `path`, then move it there; on an error nothing is left behind.

    Parameters
    ----------
    path : str or Path
    write : callable
        Gets the draft's path, which has the same suffix.

    Raises
    ------
    OutputError
        If the folder does not exist or cannot be written to.
    """
    path = Path(path)
    draft, target = None, path.resolve()  # a link stays one
    try:
        if target.exists() and not target.is_file() and not target.is_dir():
            write(target)  # a device or a pipe cannot be replaced
            return path
        if target.is_dir():
            raise IsADirectoryError(None, "is a folder")
        handle, name = tempfile.mkstemp(prefix=".symosc-", suffix=target.suffix, dir=target.parent)
        os.close(handle)
        draft = Path(name)
        write(draft)
        draft.chmod(0o666 & ~_umask())
        os.replace(draft, target)
        draft = None
    except OSError as error:
        raise OutputError(str(path), error.strerror or str(error)) from None
    finally:
        if draft is not None:
            draft.unlink(missing_ok=True)
    return path


def write_text(path: str | Path, text: str) -> Path:
    """Write text (UTF-8) whole or not at all; see `write_whole`."""
    return write_whole(path, partial(_fill, text))


def _fill(text: str, draft: Path) -> None:
    draft.write_text(text, encoding="utf-8")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
