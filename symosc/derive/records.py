"""Tables of a TOML file as records: complete, of text, with names in kebab case; or a line that says what is wrong."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection
from pathlib import Path
from typing import Any

from symosc.errors import SymoscError


class RecordsError(SymoscError, ValueError):
    """A file of records that cannot be used; `where` is the file, and the record in it."""

    def __init__(self, where: str, reason: str) -> None:
        self.where, self.reason = where, reason
        super().__init__(f"{where}: {reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.where, self.reason)


def tables(path: Path, name: str) -> list[dict[str, Any]]:
    """Return the tables `[[name]]` of a file, which may have no others."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise RecordsError(path.name, f"cannot be read: {error}") from None
    found = data.pop(name, [])
    if data or not isinstance(found, list):
        raise RecordsError(path.name, f"may only have [[{name}]] tables, not {', '.join(data) or f'another {name}'}")
    return found


def records(path: Path, name: str, needed: Collection[str], allowed: Collection[str] = ()) -> list[dict[str, str]]:
    """Return the tables of a file, each with the keys that are needed and perhaps those that are allowed, all text."""
    found = []
    for number, table in enumerate(tables(path, name), 1):
        where = f"{path.name}, {name} {table.get('id', number)}"
        if not set(needed) <= set(table) <= {*needed, *allowed}:
            raise RecordsError(where, f"has {', '.join(table)}; must have {', '.join(needed)}")
        for key, value in table.items():
            if not isinstance(value, str) or not value.strip():
                raise RecordsError(where, f"{key} = {value!r}: must be text")
        found.append({key: one_line(value) for key, value in table.items()})
    return found


def kebab(where: str, name: str) -> None:
    """Refuse a name that is not in kebab case."""
    if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name):
        raise RecordsError(where, f"id = {name!r}: must be kebab case")


def one_of(where: str, what: str, value: str, allowed: Collection[str]) -> None:
    """Refuse a value that is not allowed."""
    if value not in allowed:
        raise RecordsError(where, f"{what} = {value!r}: must be one of {', '.join(allowed)}")


def one_line(text: str) -> str:
    """Return a text with single spaces between its words."""
    return " ".join(text.split())
