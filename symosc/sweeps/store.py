"""Finished chunks on disk: each is a file that is written whole, so that a program may be killed at any moment."""

from __future__ import annotations

import json
import os
import re
import shutil
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.errors import OutputError, SweepError
from symosc.files import write_text, write_whole

#: The folder of the chunks is beside the output, and has its name with this behind it.
FOLDER_SUFFIX = ".parts"
PLAN_FILE, LOCK_FILE, CHUNK_NAME = "plan.json", "lock", "{begin:012d}-{end:012d}.npz"
CHUNK_FORM = re.compile(r"(\d{12})-(\d{12})\.npz")
#: What reading a damaged archive raises.
DAMAGED = (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)

Columns = dict[str, np.ndarray]


class Store:
    """The chunks of one sweep, in a folder beside its output.

    Parameters
    ----------
    output : Path
        The file that the sweep is to make.
    """

    def __init__(self, output: Path) -> None:
        self.output = output
        self.folder = output.with_name(output.name + FOLDER_SUFFIX)
        self._lock: Any = None

    def key(self) -> str | None:
        """Return the plan's name that the chunks belong to; None if there are none, "" if it cannot be read."""
        try:
            return str(json.loads((self.folder / PLAN_FILE).read_text(encoding="utf-8"))["key"])
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError):
            return ""

    def open(self, key: str, content: Record, resume: bool = True) -> None:
        """Make the folder or go on in it, alone; without `resume` take away what is in it.

        Raises
        ------
        SweepError
            If it belongs to another plan, or another program works in it.
        OutputError
            If it cannot be made.
        """
        try:
            self.folder.mkdir(exist_ok=True)
            self._take_lock()
        except OSError as error:
            raise OutputError(str(self.folder), error.strerror or str(error)) from None
        if not resume:
            self._clear()
        there = self.key()
        if there not in (None, key):
            raise self.strange()
        for draft in self.folder.glob(".symosc-*"):  # of a program that was killed while it wrote
            draft.unlink()
        if there is None:
            write_text(self.folder / PLAN_FILE, json.dumps({"key": key} | content, indent=1) + "\n")

    def strange(self) -> SweepError:
        """Return what is wrong if the chunks are another plan's."""
        return SweepError(f"{self.folder} has the chunks of another sweep: name another output, or start anew")

    def _clear(self) -> None:
        for path in self.folder.iterdir():
            if path.name == PLAN_FILE or CHUNK_FORM.fullmatch(path.name):
                path.unlink()

    def _take_lock(self) -> None:
        """Take the folder's lock, which the system releases when the program ends, however it ends."""
        self._lock = (self.folder / LOCK_FILE).open("w")
        try:
            import fcntl

            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise SweepError(f"{self.folder} is in use: another program computes this sweep") from None
        except (ImportError, OSError):  # no such locks on this system, or on this file system
            pass

    def close(self) -> None:
        """Let others work in the folder."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def write(self, begin: int, end: int, columns: Columns) -> None:
        """Keep a chunk."""

        def fill(draft: Path) -> None:
            with draft.open("wb") as file:
                np.savez(file, allow_pickle=False, **columns)

        write_whole(self.folder / CHUNK_NAME.format(begin=begin, end=end), fill)

    def ranges(self) -> list[tuple[int, int]]:
        """Return the ranges of cells that are there."""
        names = os.listdir(self.folder) if self.folder.is_dir() else []
        found = (CHUNK_FORM.fullmatch(name) for name in names)
        return sorted((int(match[1]), int(match[2])) for match in found if match)

    def chunks(self) -> Iterator[tuple[int, int, Columns]]:
        """Yield the chunks that can be read; one that a power failure has damaged is taken away."""
        for begin, end in self.ranges():
            path = self.folder / CHUNK_NAME.format(begin=begin, end=end)
            try:
                with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
                    columns = {name: archive[name] for name in archive.files}
                if any(len(column) != end - begin for column in columns.values()):
                    raise ValueError(path)
            except DAMAGED:
                with suppress(OSError):
                    path.unlink()
            else:
                yield begin, end, columns

    def remove(self, key: str) -> None:
        """Take the chunks of a plan away."""
        self.close()
        if self.key() == key:
            shutil.rmtree(self.folder, ignore_errors=True)


def missing(ranges: list[tuple[int, int]], count: int) -> list[tuple[int, int]]:
    """Return what `ranges`, which may overlap, leave of the cells from 0 to `count`."""
    gaps, here = [], 0
    for begin, end in sorted(ranges):
        if begin > here:
            gaps.append((here, min(begin, count)))
        here = max(here, end)
    if here < count:
        gaps.append((here, count))
    return gaps
