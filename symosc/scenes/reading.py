"""Reading a scene file: what is wrong is said with its line, its table, and what is allowed."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

from symosc.aliases import Record
from symosc.errors import ParameterError, SceneError, SymoscError, brief, meant
from symosc.exact import NUMBER, show
from symosc.model import PARAMETER_NAMES
from symosc.scenes.positions import line_of

#: Keys of a scene file: table, those that are needed, and those that may be there.
TABLES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "": (("start", "t_end", "parameters"), ("name", "structure", "source", "reference")),
    "parameters": (PARAMETER_NAMES, ()),
    "start": (("t0", "x0", "v0"), ("start_error",)),
}
NUMBER_PLACES: list[tuple[str, ...]] = [("t_end",)]
NUMBER_PLACES += [(table, name) for table in ("parameters", "start") for name in TABLES[table][0]]
SHOWN_PART = 24
#: Scene files have some 500 characters, more if numbers have thousands of digits. tomllib takes minutes and gigabytes
#: for a key of ten thousand parts.
MOST_CHARACTERS, MOST_DOTS = 100_000, 200


class SceneFile(NamedTuple):
    """A scene file that was read: its text, what to call it, its values, and what of them is not exact.

    Attributes
    ----------
    text, where : str
    data : dict
    rounded : dict of str to str
        For each number that is known to 40 digits only, what the file says.
    """

    text: str
    where: str
    data: Record
    rounded: dict[str, str]

    def notes(self) -> tuple[str, ...]:
        """Return what is to be said of numbers that are not exact."""
        found = self.data["parameters"] | self.data["start"] | self.data
        return tuple(
            f"{name} = {text}: read to 40 digits, {_start_of(found[name])}" for name, text in self.rounded.items()
        )

    def place(self, *path: str) -> str:
        """Return where a key stands, in words."""
        line = line_of(self.text, path)
        table = f"[{path[0]}]" if len(path) > 1 else ""
        return ", ".join(filter(None, [f"line {line}" if line else "", table]))

    def located(self, error: ParameterError) -> SymoscError:
        """Return an error of a number with the place of that number."""
        tables = [name for name, (required, optional) in TABLES.items() if error.name in (*required, *optional)]
        place = self.place(*filter(None, [*tables[:1], error.name])) if tables else ""
        said = ", ".join(filter(None, [self.where, place]))
        return ParameterError(error.name, error.value, f"{error.allowed} ({said})")


def _start_of(value: Fraction) -> str:
    text = show(value)
    return f"{text[:SHOWN_PART]}…" if len(text) > SHOWN_PART else text


def read_scene_file(text: str, where: str) -> SceneFile:
    """Return a scene file with its numbers.

    Raises
    ------
    SceneError
        If the text is not TOML, or a key is missing, unknown or of a wrong type.
    ParameterError
        If a value is not a number.
    """
    if len(text) > MOST_CHARACTERS:
        raise SceneError(where, f"has more than {MOST_CHARACTERS} characters: it is no scene")
    for number, line in enumerate(text.split("\n"), 1):
        if line.count(".") > MOST_DOTS:
            raise SceneError(where, f"line {number}: has more than {MOST_DOTS} dots: it is no line of a scene")
    try:
        data = tomllib.loads(text, parse_float=Decimal)
    except RecursionError:
        raise SceneError(where, "is not valid TOML: nested too deeply") from None
    except ArithmeticError:  # of Decimal
        raise SceneError(where, "is not valid TOML: a number is too large") from None
    except ValueError as error:  # TOMLDecodeError, and an int of more digits than Python converts
        raise SceneError(where, f"is not valid TOML: {error}") from None
    if not data:
        raise SceneError(where, "is empty; `symosc scenes fig5` prints an example, `symosc new` writes one")
    file = SceneFile(text, where, data, {})
    for table in TABLES:
        _check_keys(file, table)
    for key in ("name", "structure", "source"):
        if key in data and not isinstance(data[key], str):
            raise SceneError(where, f"{file.place(key)}: {key} must be text")
    for path in NUMBER_PLACES:
        _read_number(file, path)
    _know_the_start(file)
    return file


def _check_keys(file: SceneFile, name: str) -> None:
    table = file.data[name] if name else file.data
    if not isinstance(table, dict):
        raise SceneError(file.where, f"{file.place(name)}: [{name}] must be a table")
    required, optional = TABLES[name]
    prefix, known = f"{name}." if name else "", (*required, *optional)
    strange = [key for key in table if key not in known]
    missing = [key for key in required if key not in table]
    for key in strange:  # before what is missing: that may be what was meant
        place = file.place(*filter(None, [name, key]))
        said = f"{place}: " if place else ""
        hint = meant(key, missing or known)
        raise SceneError(file.where, f"{said}{prefix}{brief(key)} is unknown{hint}; known are {', '.join(known)}")
    for key in missing:
        begins = f"; [{name}] begins in {file.place(name)}" if name and file.place(name) else ""
        advice = f": give it in a table [{key}]" if key in TABLES else begins
        raise SceneError(file.where, f"{prefix}{key} is missing{advice}")


def _read_number(file: SceneFile, path: Sequence[str]) -> None:
    """Replace the text of an expression or a quantity by its number; what is no text is read by who uses it."""
    table, name = (file.data[path[0]] if len(path) > 1 else file.data), path[-1]
    value = table[name]
    if not isinstance(value, str) or NUMBER.fullmatch(value.strip()):
        return
    try:
        table[name], exact = read_number(name, value)
    except ParameterError as error:
        raise file.located(error) from None
    if not exact:
        file.rounded[name] = value


def read_number(name: str, text: str) -> tuple[Fraction, bool]:
    """Return the number of an expression or a quantity, and whether it is exact."""
    from symosc.scenes.expressions import read_expression, rounded
    from symosc.scenes.units import is_quantity, read_quantity

    if not is_quantity(text):
        return read_expression(name, text)
    number, exact = read_quantity(name, text)
    return (number if exact else rounded(number)), exact


def _know_the_start(file: SceneFile) -> None:
    """Give a start that is not exact the error of its last digit, unless the file has one."""
    start, parameters = file.data["start"], file.data["parameters"]
    if "start_error" in start or not {"t0", "x0", "v0"} & set(file.rounded):
        return
    belts: list[Any] = [parameters["v1"], parameters["v2"]]
    errors = []
    for name in ("t0", "x0", "v0"):
        # A start on a belt has the belt's speed, however many digits that has.
        known = name not in file.rounded or (name == "v0" and start[name] in belts)
        errors.append(Fraction(0) if known else half_unit(start[name]))
    start["start_error"] = errors


def half_unit(value: Fraction) -> Fraction:
    """Return half a unit of the last of 40 digits of a number."""
    from symosc.scenes.expressions import KNOWN_DIGITS

    exponent = Decimal(value.numerator).adjusted() - Decimal(value.denominator).adjusted() + 1
    return Fraction(10) ** (exponent - KNOWN_DIGITS) / 2
