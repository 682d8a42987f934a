"""Finished chunks on disk, each written atomically, so that a sweep may be interrupted at any
moment.

A chunk is the result of successive cells of a sweep, from `begin` up to `end`. Its file ends with a
checksum over its content, its range and its plan: what was changed since is computed anew.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Collection, Iterator
from contextlib import closing, suppress
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import OutputError, SweepError
from symosc.base.files import DRAFT_PREFIX, write_text, write_whole

#: The folder of the chunks is beside the output, and has its name with this suffix.
FOLDER_SUFFIX = ".parts"
PLAN_FILE = "plan.json"
LOCK_FILE = "lock"
CHUNK_NAME = "{:012d}-{:012d}.npz"
#: The name, before its suffix, of a finished output until it is moved to its place.
DRAFT = "whole"
CHUNK_FORM = re.compile(r"(\d{12})-(\d{12})\.npz")
DRAFT_FORM = re.compile(rf"({re.escape(DRAFT_PREFIX)}|{DRAFT}\.).*")
PLAN_KEY_FORM = re.compile(r"[0-9a-f]{64}")

Columns = dict[str, np.ndarray]


class Store:
    """The saved chunks of one sweep, in a folder next to its `output` file."""

    def __init__(self, output: Path) -> None:
        self.output = output
        self.folder = output.with_name(output.name + FOLDER_SUFFIX)
        self._lock: Any = None
        self._key = ""

    def key(self) -> str | None:
        """Return the key of the plan to which the chunks belong; None if none is saved, "" if it
        cannot be read.
        """
        try:
            key = json.loads((self.folder / PLAN_FILE).read_text(encoding="utf-8"))["key"]
        except (FileNotFoundError, NotADirectoryError):
            return None
        except (OSError, ValueError, KeyError, TypeError):
            return ""
        if isinstance(key, str) and PLAN_KEY_FORM.fullmatch(key):
            return key
        return ""

    def open(self, key: str, content: Record, resume: bool = True) -> None:
        """Lock the chunks' folder for the plan with this key and content; without `resume`, remove
        its old chunks.
        """
        # SweepError if it belongs to another plan, is no folder of a sweep, or another program
        # works in it.
        try:
            self.folder.mkdir(exist_ok=True)
            is_ours = all(
                name in (PLAN_FILE, LOCK_FILE)
                or DRAFT_FORM.fullmatch(name)
                or CHUNK_FORM.fullmatch(name)
                for name in os.listdir(self.folder)
            )
            # "" is a plan that cannot be read; None is no plan, here among files of others.
            if self.key() == "" or (self.key() is None and not is_ours):
                raise SweepError(
                    f"{self.folder} is not the folder of a sweep, or is damaged: remove it, or "
                    "name another output"
                )
            self._take_lock()
        except OSError as error:
            raise OutputError(str(self.folder), error.strerror or str(error)) from None
        if not resume:
            self._clear(whole=True)
        saved_key = self.key()
        if saved_key not in (None, key):
            raise self.foreign_error()
        self._clear(whole=False)  # drafts of a program that was killed
        if saved_key is None:
            write_text(self.folder / PLAN_FILE, json.dumps({"key": key} | content, indent=1) + "\n")
        self._key = key

    def foreign_error(self) -> SweepError:
        """Return the error that the chunks in the folder belong to another sweep."""
        return SweepError(
            f"{self.folder} has the chunks of another sweep: name another output, or start anew"
        )

    def _clear(self, whole: bool) -> None:
        """Remove half-written files that a killed program has left; if `whole`, also the chunks and
        their plan.
        """
        for path in self.folder.iterdir():
            if DRAFT_FORM.fullmatch(path.name) or (
                whole and (path.name == PLAN_FILE or CHUNK_FORM.fullmatch(path.name))
            ):
                remove(path)

    def _take_lock(self) -> None:
        """Take the folder's lock, which the system releases when the program ends, however it ends."""
        path = self.folder / LOCK_FILE
        self._lock = path.open("a")
        in_use = SweepError(f"{self.folder} is in use: another program computes this sweep")
        try:
            import fcntl

            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.close()
            raise in_use from None
        except (ImportError, OSError):  # no such locks on this system, or on this file system
            return
        if not path.exists() or not os.path.samestat(os.fstat(self._lock.fileno()), path.stat()):
            self.close()  # the other program has just finished, and removed it
            raise in_use

    def close(self) -> None:
        """Release the folder's lock."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def write(self, begin: int, end: int, columns: Columns) -> None:
        """Save the columns of the cells from `begin` up to `end`."""
        file = BytesIO()
        np.savez(file, allow_pickle=False, **columns)
        content = file.getvalue() + self._checksum(begin, end, file.getvalue())
        write_whole(
            self.folder / CHUNK_NAME.format(begin, end), lambda draft: draft.write_bytes(content)
        )

    def _checksum(self, begin: int, end: int, content: bytes) -> bytes:
        """Return the checksum of a chunk's bytes, which depends on its cells and on the plan too."""
        return sha256(f"{self._key} {begin} {end}\n".encode() + content).digest()

    def ranges(self) -> list[tuple[int, int]]:
        """Return the ranges (begin, end) of the cells whose chunks are saved."""
        if self.folder.is_dir():
            names = os.listdir(self.folder)
        else:
            names = []
        return sorted(
            (int(match[1]), int(match[2]))
            for name in names
            if (match := CHUNK_FORM.fullmatch(name))
        )

    def chunks(self, names: Collection[str]) -> Iterator[tuple[int, int, Columns]]:
        """Yield begin, end and columns of each intact chunk that has the columns `names`.

        Delete all other chunks.
        """
        for begin, end in self.ranges():
            path = self.folder / CHUNK_NAME.format(begin, end)
            checksum_size = sha256().digest_size
            columns = Columns()  # none, unless the file is intact
            with suppress(OSError):
                file = path.read_bytes()
                content = file[:-checksum_size]
                checksum = file[-checksum_size:]
                if checksum == self._checksum(begin, end, content):
                    with np.load(BytesIO(content), allow_pickle=False) as archive:
                        columns = dict(archive)
            has_columns = columns.keys() == set(names)
            if has_columns and all(len(column) == end - begin for column in columns.values()):
                yield begin, end, columns
            else:
                with suppress(OSError):
                    path.unlink()

    def remove(self, key: str) -> None:
        """Remove the chunks of the plan `key`, unless another program works on them, and release
        the lock.
        """
        with closing(self), suppress(OSError, SweepError):
            if self.key() != key:
                return
            if self._lock is None:
                self._take_lock()
            self._clear(whole=True)
            lock = self.folder / LOCK_FILE
            try:
                lock.unlink()  # while no other program can take it
            except PermissionError:  # some systems do not remove a file that is open
                self.close()
                lock.unlink()
            self.folder.rmdir()  # fails, as it should, if the folder has other files


def remove(path: Path) -> None:
    """Remove a file, or a folder with its contents."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def missing(ranges: list[tuple[int, int]], count: int) -> list[tuple[int, int]]:
    """Return the ranges of the cells from 0 to `count` not covered by `ranges`, which may overlap."""
    gaps = []
    covered = 0  # all cells below are in a range or in a gap
    for begin, end in sorted([*ranges, (count, count)]):  # the empty range ends the last gap
        if begin > covered:
            gaps.append((covered, min(begin, count)))
        covered = max(covered, end)
    return gaps
