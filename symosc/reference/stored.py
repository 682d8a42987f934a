"""Reference cases read back from a folder that `symosc cases -o` has written."""

from __future__ import annotations

import csv
import io
import json
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path

from symosc.aliases import Record
from symosc.errors import ResultError
from symosc.exact import read_exact
from symosc.files import read_path
from symosc.reference.case import KnownEvent, ReferenceCase
from symosc.reference.folder import CASE_FILE, EVENT_FILE_COLUMNS, EVENTS_FILE, MANIFEST, SET_FORMAT, checksum


@dataclass(frozen=True)
class StoredCase:
    """A case as its files have it.

    Attributes
    ----------
    name, group : str
    Omega, t0, t_end : Fraction
    on_belt : bool
        Whether the start is on a belt.
    events : tuple of KnownEvent
    conditions : tuple of float
    count : int
        Of all events, if only those of the last period are given.
    """

    name: str
    group: str
    Omega: Fraction
    t0: Fraction
    t_end: Fraction
    on_belt: bool
    events: tuple[KnownEvent, ...]
    conditions: tuple[float, ...]
    count: int

    @cached_property
    def times(self) -> list[float]:
        """Times of the events."""
        return [float(event.middle[0]) for event in self.events]


def read_set(path: str | Path) -> tuple[int, Sequence[StoredCase]]:
    """Return version and cases of a folder.

    Raises
    ------
    ResultError
        If it is not such a folder, or a file is not the one that its manifest names.
    """
    folder = Path(read_path(path))
    manifest = _manifest(folder)
    try:
        names = [(entry["name"], manifest["files"]) for entry in manifest["cases"]]
        return int(manifest["set_version"]), [_case(folder, name, sums) for name, sums in names]
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise ResultError(str(folder), f"is not a set of reference cases: {type(error).__name__}, {error}") from None


def _manifest(folder: Path) -> Record:
    try:
        content = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except OSError:
        raise ResultError(str(folder), f"has no {MANIFEST}; `symosc cases -o {folder}` writes the cases") from None
    except (ValueError, RecursionError):
        raise ResultError(str(folder / MANIFEST), "is not JSON") from None
    if not isinstance(content, dict) or content.get("format") != SET_FORMAT:
        raise ResultError(str(folder / MANIFEST), f"is not of the format {SET_FORMAT!r}")
    return content


def _text(folder: Path, name: str, sums: Record) -> str:
    try:
        content = (folder / name).read_bytes()
    except OSError as error:
        raise ResultError(str(folder / name), f"cannot be read: {error.strerror or error}") from None
    if checksum(content) != sums[name]:
        raise ResultError(str(folder / name), "is not the file that was written: its checksum differs")
    return content.decode()


def _case(folder: Path, name: str, sums: Record) -> StoredCase:
    about = tomllib.loads(_text(folder, f"{name}/{CASE_FILE}", sums))
    rows = list(csv.DictReader(io.StringIO(_text(folder, f"{name}/{EVENTS_FILE}", sums))))
    t_low, t_high, x_low, x_high, kind, boundary, *words = EVENT_FILE_COLUMNS[:-1]
    events = tuple(
        KnownEvent(
            (row[t_low], row[t_high]),
            (row[x_low], row[x_high]),
            row[kind],
            int(row[boundary]),
            *(row[word] for word in words),
        )
        for row in rows
    )
    return StoredCase(
        name,
        about["reference"]["group"],
        read_exact("Omega", about["parameters"]["Omega"]),
        read_exact("t0", about["start"]["t0"]),
        read_exact("t_end", about["t_end"]),
        read_exact("v0", about["start"]["v0"])
        in (read_exact(name, about["parameters"][name]) for name in ("v1", "v2")),
        events,
        tuple(float(row["condition"]) for row in rows),
        about["reference"]["events"],
    )


def stored(case: ReferenceCase) -> StoredCase:
    """Return a case as its files would have it."""
    return StoredCase(
        case.name,
        case.group,
        case.parameters.Omega,
        case.t0,
        case.t_end,
        case.v0 in (case.parameters.v1, case.parameters.v2),
        case.events,
        case.conditions,
        case.count,
    )
