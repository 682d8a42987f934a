"""Read scene files; errors state the line, the table, and the allowed values."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from contextlib import suppress
from decimal import Decimal
from typing import Any, NamedTuple, TypeAlias

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, SceneError, SymoscError, brief, meant, of_other_laws
from symosc.base.exact import show
from symosc.base.quantities import forcing_periods, is_quantity, read_number
from symosc.model import OSCILLATOR_NAMES, PARAMETER_NAMES
from symosc.reductions import MODEL_NAMES

#: The required keys of a table, and the optional ones.
Keys: TypeAlias = tuple[tuple[str, ...], tuple[str, ...]]
#: The tables of a scene file; "" is what stands outside of them.
TABLES: dict[str, Keys] = {
    "": (("start", "t_end", "parameters"), ("name", "structure", "source", "reference")),
    "parameters": (PARAMETER_NAMES, ()),
    "start": (("t0", "x0", "v0"), ("start_error",)),
}
#: The keys of a file with a table [model], which is about another model (`symosc.reductions`).
NEEDED = ("m", "k", "Omega")
MODEL_KEYS = tuple(name for name in MODEL_NAMES if name not in (*PARAMETER_NAMES, "belts"))
MODEL_TABLES = TABLES | {
    "": (TABLES[""][0], (*TABLES[""][1], "model", "belts")),
    "parameters": (NEEDED, tuple(name for name in PARAMETER_NAMES if name not in NEEDED)),
    "model": ((), MODEL_KEYS),
}
#: The keys of a file with tables [[belts]], which is about an `Oscillator`, and those of such a table.
BELTS_NEEDED = ("m", "c", "k")
BELTS_TABLES = TABLES | {
    "": (TABLES[""][0], (*TABLES[""][1], "belts")),
    "parameters": (
        BELTS_NEEDED,
        tuple(name for name in OSCILLATOR_NAMES if name not in BELTS_NEEDED),
    ),
}
BELT_KEYS: Keys = (("v", "mu"), ("curve", "slope", "mu_s"))
#: With a curve there is no mu: `Belt` says why it refuses both.
CURVE_KEYS: Keys = (("v", "curve"), ("mu", "slope", "mu_s"))
#: Names of belts' numbers in [parameters], which exclude tables [[belts]].
OF_NUMBERED_BELTS = tuple(name for name in PARAMETER_NAMES if name not in OSCILLATOR_NAMES)
#: How names begin that belong into tables [[belts]].
OF_BELTS = ("mu", "v", "w", "curve", "slope", "belt", "static")
#: Scene files have some 500 characters, more if numbers have thousands of digits.
MOST_CHARACTERS = 100_000
#: In a line: tomllib takes minutes and gigabytes for a key of ten thousand parts.
MOST_DOTS = 200
#: Characters that a note shows of a long number.
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
    def tables(self) -> dict[str, Keys]:
        """The tables that such a file may have, by name: their required keys, and their optional
        ones.
        """
        if "model" in self.data:
            return MODEL_TABLES
        if "belts" in self.data:
            return BELTS_TABLES
        return TABLES

    @property
    def has_units(self) -> bool:
        """Whether a number has a unit."""
        tables = [self.data[name] for name in ("parameters", "start", "model") if name in self.data]
        tables += self.data.get("belts", ())
        values = [self.data["t_end"], *(value for table in tables for value in table.values())]
        texts = [value for value in values if isinstance(value, str)]
        return any(is_quantity(text) and not text.strip().endswith(("%", "T")) for text in texts)

    def place(self, *path: str | int) -> str:
        """Return the line and the table of a key as text for a message."""
        line = line_of(self.text, path)
        table = ""
        if len(path) > 1 and isinstance(path[1], int):
            table = f"table {path[1] + 1} of [[{path[0]}]]"
        elif len(path) > 1:
            table = f"[{path[0]}]"
        return ", ".join(filter(None, [f"line {line}" if line else "", table]))

    def located(self, error: ParameterError, belt: int | None = None) -> SymoscError:
        """Return a copy of an error that also says where in the file the number is.

        `belt` is the index of the table [[belts]] that it is in.
        """
        where = self.where
        place = ""
        if belt is not None:
            place = self.place("belts", belt, error.name)
        else:
            for name, (required, optional) in self.tables.items():
                if error.name in (*required, *optional):
                    place = self.place(*filter(None, [name, error.name]))
                    break
        where = ", ".join(filter(None, [where, place]))
        return ParameterError(error.name, error.value, f"{error.allowed} ({where})")


def line_of(text: str, path: Sequence[str | int]) -> int | None:
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
            elif isinstance(data, list) and isinstance(key, int) and key < len(data):
                data = data[key]
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
    if "belts" in data:
        _check_belts(file)
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
    for n, belt in enumerate(data.get("belts", ())):
        for name in belt:
            if name == "curve":
                _note_curve(file, belt[name])
            else:
                _check_number(file, belt, name, n)
    return file


def _check_belts(file: SceneFile) -> None:
    """Raise SceneError for the form of the tables [[belts]], or for what excludes them."""
    belts = file.data["belts"]
    if not (isinstance(belts, list) and belts and all(isinstance(belt, dict) for belt in belts)):
        raise SceneError(
            file.where,
            f"{file.place('belts')}: belts must be tables: [[belts]] and below it v and mu (or a "
            "curve), for each belt",
        )
    parameters = file.data.get("parameters")
    if isinstance(parameters, dict):
        for name in OF_NUMBERED_BELTS:
            if name in parameters:
                raise SceneError(
                    file.where,
                    f"{file.place('parameters', name)}: parameters.{name} and [[belts]] exclude "
                    f"each other: give it as {name[:-1]} in a table [[belts]], or leave these out",
                )
    for n, belt in enumerate(belts):
        if "curve" in belt:
            keys = CURVE_KEYS
        else:
            keys = BELT_KEYS
        _check_table(file, belt, keys, ("belts", n))


def _check_keys(file: SceneFile, name: str) -> None:
    """Raise SceneError for missing or unknown keys of a table."""
    if name:
        table = file.data[name]
    else:
        table = file.data
    if not isinstance(table, dict):
        raise SceneError(file.where, f"{file.place(name)}: [{name}] must be a table")
    _check_table(file, table, file.tables[name], (name,) if name else ())


def _check_table(
    file: SceneFile,
    table: Record,
    keys: Keys,
    path: tuple[str | int, ...],
) -> None:
    """Raise SceneError unless the table at `path` has these required and optional keys."""
    required, optional = keys
    if path:
        prefix = f"{path[0]}."
    else:
        prefix = ""
    known = (*required, *optional)
    missing = [key for key in required if key not in table]
    for key in table:  # before what is missing: that may be what was meant
        if key not in known:
            location = file.place(*path, key)
            of_belts = of_other_laws(key, PARAMETER_NAMES) or key in OF_NUMBERED_BELTS
            if of_belts and prefix in ("", "parameters."):
                hint = ""  # no similar name is meant
            else:
                hint = meant(key, missing or known)
            unknown = f"{prefix}{brief(key)} is unknown{hint}; known are {', '.join(known)}"
            if prefix == "parameters." and key in MODEL_KEYS:
                unknown += (
                    "; a model other than that of symosc has a table [model], and this stands there"
                )
            elif prefix in ("", "parameters.") and key.startswith(OF_BELTS):
                unknown += "; tables [[belts]] have v, mu or curve, slope and mu_s of each belt"
            raise SceneError(file.where, f"{location}: {unknown}" if location else unknown)
    for key in missing:
        where = file.place(*path)
        begins = ""
        if len(path) == 1 and where:
            begins = f"; [{path[0]}] begins in {where}"
        elif path and where:
            begins = f"; it begins in {where}"
        if key in TABLES:
            advice = f": give it in a table [{key}]"
        else:
            advice = begins
        raise SceneError(file.where, f"{prefix}{key} is missing{advice}")


def _note_curve(file: SceneFile, curve: Any) -> None:
    """Add notes on the numbers of a curve that are read to 40 digits only.

    Whether they make a curve at all, `Belt` says.
    """
    if not isinstance(curve, list):
        return
    for point in curve:
        if isinstance(point, list):
            for name, value in zip(("w", "mu"), point, strict=False):
                with suppress(ParameterError):
                    _note_digits(file, name, value)


def _check_number(file: SceneFile, table: Record, name: str, belt: int | None = None) -> None:
    """Check a number that is given as text; if it is read to 40 digits only, add a note on it to
    `file.notes`.

    `belt` is the index of the table [[belts]] that it is in.
    """
    value = table[name]
    try:
        if name == "t_end" and forcing_periods(name, value) is not None:
            return  # a time that depends on Omega, see `symosc.scenes.end_time`
        _note_digits(file, name, value)
    except ParameterError as error:
        raise file.located(error, belt) from None


def _note_digits(file: SceneFile, name: str, value: Any) -> None:
    """Add a note to `file.notes` on a number that is given as text and is read to 40 digits only."""
    if not isinstance(value, str):
        return
    number, exact = read_number(name, value)
    if not exact:
        shown = show(number)
        if len(shown) > SHOWN_PART:
            shown = f"{shown[:SHOWN_PART]}…"
        file.notes.append(f"{name} = {value}: read to 40 digits, {shown}")
