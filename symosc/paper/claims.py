"""The claims files: what the paper states, as data, each statement with the function that checks it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Collection
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from symosc.derive.chapters import CHAPTERS
from symosc.errors import SymoscError
from symosc.paper.evidence import CONFIRMED, UNDECIDED, VERDICTS, Evidence

FOLDER = Path(__file__).parent / "claims"
CHECKS = "symosc.paper.checks"
#: The files, in the order in which they are read, and what each one is about.
PARTS = {
    "model": "The model and the friction law",
    "theorems": "Theorems 4 to 7",
    "mappings": "The mappings and their equations",
    "figures": "What is said about the figures",
}
REQUIRED = ("id", "source", "says", "check", "verdict")
LISTS = ("figures",)
OPTIONAL = (*LISTS, "derivation", "correction")


class ClaimsError(SymoscError, ValueError):
    """A claims file that cannot be used.

    Attributes
    ----------
    where : str
        The file, and the claim in it.
    """

    def __init__(self, where: str, reason: str) -> None:
        self.where, self.reason = where, reason
        super().__init__(f"{where}: {reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.where, self.reason)


@dataclass(frozen=True)
class Claim:
    """A statement of the paper.

    Attributes
    ----------
    id : str
        Unique, in kebab case.
    part : str
        Key of PARTS.
    source : str
        Where in the paper.
    says : str
        The statement, restored.
    check : callable
        Returns the evidence; a function of a module, so that a worker process can be told to call it.
    verdict : str
        The committed verdict, one of VERDICTS.
    figures : tuple of str
        Keys of the pictures that show it.
    derivation : str or None
        Subject of the chapter that derives it, a key of CHAPTERS.
    correction : str or None
        The statement that does hold, if this one does not as it stands.
    """

    id: str
    part: str
    source: str
    says: str
    check: Callable[[], Evidence]
    verdict: str
    figures: tuple[str, ...] = ()
    derivation: str | None = None
    correction: str | None = None


def read_claims(pictures: Collection[str], folder: Path = FOLDER, checks: str = CHECKS) -> tuple[Claim, ...]:
    """Read all claims, in the order of PARTS.

    Parameters
    ----------
    pictures : collection of str
        Keys of the pictures that there are.
    folder : Path
        With `<part>.toml` files; a part without a file has no claims.
    checks : str
        The package whose modules have the check functions.

    Raises
    ------
    ClaimsError
        For a file that is no TOML or no part; a key that is unknown, missing or no text; an id twice; a verdict,
        figure, derivation or check function that does not exist; a correction too many or too few.
    """
    claims: dict[str, Claim] = {}
    for path in sorted(folder.glob("*.toml")):
        if path.stem not in PARTS:
            raise ClaimsError(path.name, f"is no part; parts are {', '.join(PARTS)}")
    for part in PARTS:
        path = folder / f"{part}.toml"
        if not path.exists():
            continue
        for number, table in enumerate(_tables(path), 1):
            claim = _claim(part, table, f"{path.name}, claim {table.get('id', number)}", pictures, checks)
            if claim.id in claims:
                raise ClaimsError(path.name, f"id {claim.id!r} is there twice")
            claims[claim.id] = claim
    return tuple(claims.values())


def _tables(path: Path) -> list[dict[str, Any]]:
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ClaimsError(path.name, f"cannot be read: {error}") from None
    tables = data.pop("claim", [])
    if data or not isinstance(tables, list):
        raise ClaimsError(path.name, f"may only have [[claim]] tables, not {', '.join(data) or 'another claim'}")
    return tables


def _claim(part: str, table: dict[str, Any], where: str, pictures: Collection[str], checks: str) -> Claim:
    for key in REQUIRED:
        if key not in table:
            raise ClaimsError(where, f"{key} is missing")
    for key, value in table.items():
        if key not in REQUIRED + OPTIONAL:
            raise ClaimsError(where, f"{key} is unknown; known are {', '.join(REQUIRED + OPTIONAL)}")
        texts = value if key in LISTS else [value]
        if not isinstance(texts, list) or not all(isinstance(text, str) and text.strip() for text in texts):
            raise ClaimsError(where, f"{key} = {value!r}: must be {'a list of texts' if key in LISTS else 'text'}")
    if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", table["id"]):
        raise ClaimsError(where, f"id = {table['id']!r}: must be kebab case")
    _one_of(where, "verdict", table["verdict"], VERDICTS)
    for key in table.get("figures", ()):
        _one_of(where, "figure", key, pictures)
    if table["verdict"] == CONFIRMED and "correction" in table:
        raise ClaimsError(where, "has a correction although it is confirmed")
    if table["verdict"] not in (CONFIRMED, UNDECIDED) and "correction" not in table:
        raise ClaimsError(where, "correction is missing: what does hold?")
    return Claim(
        id=table["id"],
        part=part,
        source=table["source"],
        says=_one_line(table["says"]),
        check=_function(where, checks, table["check"]),
        verdict=table["verdict"],
        figures=tuple(table.get("figures", ())),
        derivation=_subject(where, table["derivation"]) if "derivation" in table else None,
        correction=_one_line(table["correction"]) if "correction" in table else None,
    )


def _one_of(where: str, what: str, value: str, allowed: Collection[str]) -> None:
    if value not in allowed:
        raise ClaimsError(where, f"{what} = {value!r}: must be one of {', '.join(allowed)}")


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _function(where: str, package: str, name: str) -> Callable[[], Evidence]:
    module, _, function = name.rpartition(".")
    try:
        found = getattr(import_module(f"{package}.{module}"), function, None)
    except ModuleNotFoundError as error:
        if error.name != f"{package}.{module}":
            raise
        found = None
    if not callable(found):
        raise ClaimsError(where, f"check = {name!r}: there is no such function in {package}")
    check: Callable[[], Evidence] = found
    return check


def _subject(where: str, stem: str) -> str:
    """Return the chapter of a script of derivations/, which has the chapter's number."""
    number = re.match(r"(\d\d)_[a-z0-9_]+$", stem)
    if not number or not 1 <= int(number[1]) <= len(CHAPTERS):
        raise ClaimsError(where, f"derivation = {stem!r}: must be the name of a script of derivations, without .py")
    return list(CHAPTERS)[int(number[1]) - 1]
