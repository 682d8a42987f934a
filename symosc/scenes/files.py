"""Read scene files; errors state the line, the table, and the allowed values."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from decimal import Decimal
from typing import Any, NamedTuple

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, SceneError, SymoscError, brief, meant
from symosc.base.exact import show
from symosc.base.quantities import forcing_periods, read_number
from symosc.model import PARAMETER_NAMES
from symosc.reductions import MODEL_NAMES

#: Keys of a scene file: table, those that are needed, and those that may be there.
TABLES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "": (("start", "t_end", "parameters"), ("name", "structure", "source", "reference")),
    "parameters": (PARAMETER_NAMES, ()),
    "start": (("t0", "x0", "v0"), ("start_error",)),
}
#: The keys of a file with a table [model], which is about another model (`symosc.reductions`).
NEEDED = ("m", "k", "Omega")
MODEL_KEYS = tuple(name for name in MODEL_NAMES if name not in PARAMETER_NAMES)
MODEL_TABLES = TABLES | {
    "": (TABLES[""][0], (*TABLES[""][1], "model")),
    "parameters": (NEEDED, tuple(name for name in PARAMETER_NAMES if name not in NEEDED)),
    "model": ((), MODEL_KEYS),
}
#: Scene files have some 500 characters, more if numbers have thousands of digits. tomllib takes
#: minutes and gigabytes for a key of ten thousand parts. The last number is how many characters a
#: note shows of a long number.
MOST_CHARACTERS = 100_000
MOST_DOTS = 200
SHOWN_PART = 24
#: Characters that may be read to find a line: a file that takes more is no scene that somebody
#: wrote.
MOST_READ = 1_000_000


class SceneFile(NamedTuple):
    """A parsed scene file: its text, its name in messages, its values, and notes on numbers that
    are not exact.
    """

    text: str
    where: str
    data: Record
    notes: list[str]

    @property
    def tables(self) -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
        """The tables that such a file may have, by name: their required keys, and their optional
        ones.
        """
        if "model" in self.data:
            return MODEL_TABLES
        return TABLES

    def place(self, *path: str) -> str:
        """Return the line and the table of a key as text for a message."""
        line = line_of(self.text, path)
        return ", ".join(
            filter(None, [f"line {line}" if line else "", f"[{path[0]}]" if len(path) > 1 else ""])
        )

    def located(self, error: ParameterError) -> SymoscError:
        """Return a copy of an error that also says where in the file the number is."""
        where = self.where
        for name, (required, optional) in self.tables.items():
            if error.name in (*required, *optional):
                where = ", ".join(
                    filter(None, [where, self.place(*filter(None, [name, error.name]))])
                )
                break
        return ParameterError(error.name, error.value, f"{error.allowed} ({where})")


def line_of(text: str, path: Sequence[str]) -> int | None:
    """Return the number of the last line of the value at a path of keys in a TOML text, None if it
    is not found.
    """
    # The lines up to it are the first ones that are TOML and have it: so strings of several lines,
    # inline tables and dotted keys are all read by the same rules as the file itself.
    begin = ""
    read = 0
    for n, line in enumerate(text.splitlines(keepends=True), 1):
        begin += line
        if not line.strip():
            continue
        read += len(begin)
        if read > MOST_READ:
            return None
        try:
            data: Any = tomllib.loads(begin)
        except (ValueError, RecursionError):
            continue
        for key in path:
            if isinstance(data, dict):
                data = data.get(key)
            else:
                data = None
        if data is not None:
            return n
    return None


def read_scene_file(text: str, where: str) -> SceneFile:
    """Return a scene file with its numbers.

    SceneError for its form, ParameterError for a value that is no number.
    """
    if len(text) > MOST_CHARACTERS:
        raise SceneError(where, f"a scene has at most {MOST_CHARACTERS} characters")
    for n, line in enumerate(text.split("\n"), 1):
        if line.count(".") > MOST_DOTS:
            raise SceneError(where, f"line {n}: a line has at most {MOST_DOTS} dots")
    try:
        data = tomllib.loads(text, parse_float=Decimal)
    except RecursionError:
        raise SceneError(where, "is not valid TOML: nested too deeply") from None
    except ArithmeticError:  # of Decimal
        raise SceneError(where, "is not valid TOML: a number is too large") from None
    except ValueError as error:  # TOMLDecodeError, and an int of more digits than Python converts
        raise SceneError(where, f"is not valid TOML: {error}") from None
    if not data:
        raise SceneError(
            where, "is empty; `symosc scenes fig5` prints an example, `symosc new` writes one"
        )
    file = SceneFile(text, where, data, [])
    for table in file.tables:
        _check_keys(file, table)
    for key in ("name", "structure", "source"):
        if key in data and not isinstance(data[key], str):
            raise SceneError(where, f"{file.place(key)}: {key} must be text")
    _check_number(file, data, "t_end")
    for table in ("parameters", "start", *(["model"] if "model" in data else [])):
        for name in data[table]:
            if name not in ("start_error", "joined"):
                _check_number(file, data[table], name)
    return file


def _check_keys(file: SceneFile, name: str) -> None:
    """Raise SceneError for missing or unknown keys of a table."""
    if name:
        table = file.data[name]
    else:
        table = file.data
    if not isinstance(table, dict):
        raise SceneError(file.where, f"{file.place(name)}: [{name}] must be a table")
    required, optional = file.tables[name]
    if name:
        prefix = f"{name}."
    else:
        prefix = ""
    known = (*required, *optional)
    missing = [key for key in required if key not in table]
    for key in table:  # before what is missing: that may be what was meant
        if key not in known:
            location = file.place(*filter(None, [name, key]))
            hint = meant(key, missing or known)
            unknown = f"{prefix}{brief(key)} is unknown{hint}; known are {', '.join(known)}"
            if name == "parameters" and key in MODEL_KEYS:
                unknown += (
                    "; a model other than that of symosc has a table [model], and this stands there"
                )
            raise SceneError(file.where, f"{location}: {unknown}" if location else unknown)
    for key in missing:
        if name and file.place(name):
            begins = f"; [{name}] begins in {file.place(name)}"
        else:
            begins = ""
        if key in TABLES:
            advice = f": give it in a table [{key}]"
        else:
            advice = begins
        raise SceneError(file.where, f"{prefix}{key} is missing{advice}")


def _check_number(file: SceneFile, table: Record, name: str) -> None:
    """Check a number that is given as text; if it is read to 40 digits only, add a note on it to
    `file.notes`.
    """
    if isinstance(table[name], str):
        try:
            if name == "t_end" and forcing_periods(name, table[name]) is not None:
                return  # a time that depends on Omega, see `symosc.scenes.end_time`
            number, exact = read_number(name, table[name])
        except ParameterError as error:
            raise file.located(error) from None
        if not exact:
            shown = show(number)
            if len(shown) > SHOWN_PART:
                shown = f"{shown[:SHOWN_PART]}…"
            file.notes.append(f"{name} = {table[name]}: read to 40 digits, {shown}")
