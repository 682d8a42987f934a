"""Write files atomically."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Container, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex
from typing import IO

from symosc.base.errors import OutputError, ParameterError

#: The file name that means standard output.
STDOUT = "-"
#: What is said of standard input where there is none.
STDIN_CLOSED = "standard input is closed"
#: The beginning of the name of an unfinished file, or of a folder of such.
DRAFT_PREFIX = ".symosc-"


def write_whole(path: str | Path, write: Callable[[Path], object], suffix: str = "") -> Path:
    """Let `write` fill a draft file beside `path`, then move the draft there.

    After an error no file remains.

    If `path` is "-", the draft has a name that ends with `suffix`, and is copied to standard
    output.
    """
    # OutputError if the folder cannot be written to.
    name = read_path(path)
    target = Path(name).resolve()  # a link stays one
    try:
        if name == STDOUT:
            _to_stdout(write, suffix)
        elif target.is_dir():
            raise IsADirectoryError(None, "is a folder")
        elif target.exists() and not target.is_file():
            write(target)  # a device or a pipe cannot be replaced
        else:
            with draft_in(target.parent, target.suffix) as draft:
                write(draft)
                draft.replace(target)
    except OSError as error:
        raise OutputError(name, error.strerror or str(error)) from None
    return Path(name)


@contextmanager
def draft_in(folder: Path, suffix: str = "") -> Iterator[Path]:
    """Yield a path in `folder` where nothing is yet; what is there at the end is removed."""
    draft = folder / f"{DRAFT_PREFIX}{token_hex(8)}{suffix}"
    try:
        yield draft
    finally:
        with suppress(OSError):  # of an error before it, more is known
            _remove(draft)


def _remove(path: Path) -> None:
    """Remove a file or a folder, if it is there, with one open file at a time.

    Shutil needs three.
    """
    if path.is_dir() and not path.is_symlink():
        for name in os.listdir(path):
            _remove(path / name)
        path.rmdir()
    else:
        path.unlink(missing_ok=True)


def read_path(path: object) -> str:
    """Return the text of a file name.

    ParameterError if it is neither text nor a Path, or can name no file.
    """
    if isinstance(path, os.PathLike):
        text = os.fspath(path)
    else:
        text = path
    with suppress(UnicodeEncodeError):  # half of a surrogate pair
        if isinstance(text, str) and text and b"\0" not in os.fsencode(text):
            return text
    raise ParameterError("path", path, "must be the name of a file; '-' is standard output")


def check_folder_of(path: str | Path) -> None:
    """Raise OutputError unless the folder of the file `path` exists and is writable: a check before
    long work.
    """
    text = read_path(path)
    try:
        os.stat(text)
    except FileNotFoundError:
        pass
    except OSError as error:  # too long a name, or links in a circle
        raise OutputError(text, error.strerror or str(error)) from None
    folder = Path(text).resolve().parent
    if not folder.is_dir():
        raise OutputError(str(path), "No such file or directory")
    if not os.access(folder, os.W_OK):
        raise OutputError(str(path), "Permission denied")


def check_new_folder(folder: Path, wanted: str = "the output is a folder") -> None:
    """Raise OutputError unless `folder` is writable or can be made.

    `wanted` ends the message if it is a file.
    """
    existing = next(
        place for place in (folder, *folder.absolute().parents) if os.path.exists(place)
    )
    if not existing.is_dir():
        raise OutputError(str(folder), f"{existing} is a file, but {wanted}")
    if not os.access(existing, os.W_OK):
        raise OutputError(str(folder), "Permission denied")


def make_folder(folder: Path) -> Path:
    """Make a folder, and those above it, unless it is there; OutputError if that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(str(folder), error.strerror or str(error)) from None
    return folder


def _to_stdout(write: Callable[[Path], object], suffix: str) -> None:
    """Let `write` fill a draft file, whose name ends with `suffix`, and copy it to standard output."""
    with draft_in(Path(tempfile.gettempdir()), suffix) as draft:
        write(draft)
        content = draft.read_bytes()
    try:
        sys.stdout.flush()
        if hasattr(sys.stdout, "buffer"):
            sys.stdout.buffer.write(content)
        else:  # a notebook's has no bytes
            sys.stdout.write(content.decode("utf-8", "replace"))
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has closed the pipe, and wants no more
        drop(sys.stdout)


def drop(stream: IO[str]) -> None:
    """Send a stream to the null device, as flushing what it holds would raise one more error at
    exit.
    """
    with suppress(OSError):  # in a notebook or a test it may be something that is not a file
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def write_text(path: str | Path, text: str) -> Path:
    """Write text (UTF-8) whole or not at all, by a draft next to the file ("-": to standard
    output).
    """
    return write_whole(path, lambda draft: draft.write_text(text, encoding="utf-8"))


def write_folder(
    path: str | Path, texts: Mapping[str, str], earlier: Callable[[Path], Container[str]]
) -> Path:
    """Write a folder of text files whole or not at all.

    It may replace only a folder that an earlier run wrote.

    `texts` has the text of each file by its name. `earlier(folder)` returns the names of the files
    that an earlier run has written into an existing folder: a folder with any other file is left as
    it is.
    """
    # OutputError if it stays, and if it cannot be written.
    target = check_folder(path, earlier)
    try:
        with draft_in(target.parent) as folder:
            draft = folder / "new"
            away = folder / "old"
            for name, text in texts.items():
                (draft / name).parent.mkdir(parents=True, exist_ok=True)
                (draft / name).write_bytes(text.encode())
            if target.exists():
                target.rename(away)
            try:
                draft.rename(target)
            except OSError:
                if away.exists():
                    away.rename(target)
                raise
    except OSError as error:
        raise OutputError(str(path), error.strerror or str(error)) from None
    return Path(path)


def check_folder(path: str | Path, earlier: Callable[[Path], Container[str]]) -> Path:
    """Check, before long work, that `write_folder(path, ..., earlier)` may write.

    Return the path of the folder.
    """
    name = read_path(path)
    if name == STDOUT:
        raise ParameterError("path", name, "must be the name of a folder")
    check_folder_of(name)
    target = Path(name).resolve()
    if not target.exists():
        return target
    if not target.is_dir():
        raise OutputError(name, "it is not a folder")
    known = earlier(target)
    for entry in sorted(target.rglob("*")):
        inside = entry.relative_to(target).as_posix()
        if not entry.is_dir() and inside not in known:
            raise OutputError(name, f"its file {inside} would be lost; name another folder")
    return target
