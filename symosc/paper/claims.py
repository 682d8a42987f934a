"""The claims files: what the paper states, as data, each statement with the function that checks it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Collection
from dataclasses import dataclass, fields
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from symosc.derive.chapters import CHAPTERS
from symosc.errors import SymoscError
from symosc.paper.evidence import CORRECTED, NOT_AS_PRINTED, VERDICTS, Evidence

CLAIMS_FOLDER = Path(__file__).parent / "claims"
CHECKS = "symosc.paper.checks"
#: The files, in the order in which they are read, and what each one is about.
PARTS = {
    "model": "The model and the friction law",
    "theorems": "Theorems 4 to 7",
    "mappings": "The mappings and their equations",
    "figures": "What is said about the figures",
}
REQUIRED = ("id", "source", "says", "check", "verdict")
LISTS = ("figures", "errata")
OPTIONAL = (*LISTS, "derivation", "correction", "remark")
#: Verdicts that say that something is wrong: they need a correction, and the erratum that it belongs to.
FAULTY = (CORRECTED, NOT_AS_PRINTED)
ERRATA, UNJUDGED = "errata", "unjudged"
SEVERITIES = {
    "wrong": "a statement that does not hold",
    "gap": "something is left out that the statement needs",
    "typo": "a sign, word or number, without consequence once it is read right",
}


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
    errata : tuple of str
        Ids of the errata that it shows; several claims can show one erratum.
    remark : str or None
        What there is to add to a statement that holds.
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
    errata: tuple[str, ...] = ()
    remark: str | None = None


@dataclass(frozen=True)
class Erratum:
    """An error or gap of the paper, counted once however many claims it shows in.

    Attributes
    ----------
    id : str
    severity : str
        Key of SEVERITIES.
    where, printed, holds : str
        Place in the paper, what stands there, and what does hold.
    proof : str
        Why, in about two lines.
    """

    id: str
    severity: str
    where: str
    printed: str
    holds: str
    proof: str


@dataclass(frozen=True)
class Unjudged:
    """A part of the paper that gets no verdict.

    Attributes
    ----------
    source, says : str
        Where, and what stands there.
    why : str
        Why no verdict is possible.
    """

    source: str
    says: str
    why: str


Record = TypeVar("Record", Erratum, Unjudged)


def read_claims(pictures: Collection[str], folder: Path = CLAIMS_FOLDER, checks: str = CHECKS) -> tuple[Claim, ...]:
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
        figure, erratum, derivation or check function that does not exist; a correction too many or too few.
    """
    claims: dict[str, Claim] = {}
    for path in sorted(folder.glob("*.toml")):
        if path.stem not in (*PARTS, ERRATA, UNJUDGED):
            raise ClaimsError(path.name, f"is no part; parts are {', '.join(PARTS)}")
    errata = {erratum.id for erratum in read_errata(folder)}
    for part in PARTS:
        path = folder / f"{part}.toml"
        if not path.exists():
            continue
        for number, table in enumerate(_tables(path, "claim"), 1):
            where = f"{path.name}, claim {table.get('id', number)}"
            claim = _claim(part, table, where, pictures, errata, checks)
            if claim.id in claims:
                raise ClaimsError(path.name, f"id {claim.id!r} is there twice")
            claims[claim.id] = claim
    return tuple(claims.values())


def read_errata(folder: Path = CLAIMS_FOLDER) -> tuple[Erratum, ...]:
    """Read the errata, in the order in which the letter to the authors lists them: that of the paper."""
    found = _records(folder, ERRATA, "erratum", Erratum)
    for erratum in found:
        _kebab(f"{ERRATA}.toml", erratum.id)
        _one_of(f"{ERRATA}.toml, erratum {erratum.id}", "severity", erratum.severity, SEVERITIES)
    if len({erratum.id for erratum in found}) < len(found):
        raise ClaimsError(f"{ERRATA}.toml", "an id is there twice")
    return found


def read_unjudged(folder: Path = CLAIMS_FOLDER) -> tuple[Unjudged, ...]:
    """Read what gets no verdict."""
    return _records(folder, UNJUDGED, "part", Unjudged)


def _records(folder: Path, stem: str, name: str, kind: type[Record]) -> tuple[Record, ...]:
    """Read a file of tables that all have the fields of a dataclass, each of them text."""
    path = folder / f"{stem}.toml"
    if not path.exists():
        return ()
    names = [field.name for field in fields(kind)]
    found = []
    for number, table in enumerate(_tables(path, name), 1):
        where = f"{path.name}, {name} {table.get('id', number)}"
        if sorted(table) != sorted(names):
            raise ClaimsError(where, f"has {', '.join(table)}; must have {', '.join(names)}")
        for key, value in table.items():
            if not isinstance(value, str) or not value.strip():
                raise ClaimsError(where, f"{key} = {value!r}: must be text")
        found.append(kind(**{key: _one_line(value) for key, value in table.items()}))
    return tuple(found)


def _kebab(where: str, name: str) -> None:
    if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name):
        raise ClaimsError(where, f"id = {name!r}: must be kebab case")


def _tables(path: Path, name: str) -> list[dict[str, Any]]:
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ClaimsError(path.name, f"cannot be read: {error}") from None
    tables = data.pop(name, [])
    if data or not isinstance(tables, list):
        raise ClaimsError(path.name, f"may only have [[{name}]] tables, not {', '.join(data) or f'another {name}'}")
    return tables


def _claim(
    part: str, table: dict[str, Any], where: str, pictures: Collection[str], errata: Collection[str], checks: str
) -> Claim:
    for key in REQUIRED:
        if key not in table:
            raise ClaimsError(where, f"{key} is missing")
    for key, value in table.items():
        if key not in REQUIRED + OPTIONAL:
            raise ClaimsError(where, f"{key} is unknown; known are {', '.join(REQUIRED + OPTIONAL)}")
        texts = value if key in LISTS else [value]
        if not isinstance(texts, list) or not all(isinstance(text, str) and text.strip() for text in texts):
            raise ClaimsError(where, f"{key} = {value!r}: must be {'a list of texts' if key in LISTS else 'text'}")
    _kebab(where, table["id"])
    _one_of(where, "verdict", table["verdict"], VERDICTS)
    for key in table.get("figures", ()):
        _one_of(where, "figure", key, pictures)
    for key in table.get("errata", ()):
        _one_of(where, "erratum", key, errata)
    for key, why in (("correction", "what does hold?"), ("errata", "which erratum does it show?")):
        if table["verdict"] in FAULTY and key not in table:
            raise ClaimsError(where, f"{key} {'is' if key == 'correction' else 'are'} missing: {why}")
        if table["verdict"] not in FAULTY and key in table:
            raise ClaimsError(where, f"has {key} although its verdict is {table['verdict']!r}")
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
        errata=tuple(table.get("errata", ())),
        remark=_one_line(table["remark"]) if "remark" in table else None,
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


def _subject(where: str, key: str) -> str:
    """Return the key of a chapter of the derivations."""
    if key not in CHAPTERS:
        raise ClaimsError(where, f"derivation = {key!r}: must be one of {', '.join(CHAPTERS)}")
    return key
