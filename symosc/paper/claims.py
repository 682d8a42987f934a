"""The claims files: what the paper states, as data, each statement with the function that checks it."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from symosc.derive.chapters import CHAPTERS
from symosc.derive.errata import read_errata
from symosc.derive.records import RecordsError, kebab, one_line, one_of, records, tables
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
UNJUDGED = "unjudged"


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
    RecordsError
        For a file that is no TOML or no part; a key that is unknown, missing or no text; an id twice; a verdict,
        figure, erratum, derivation or check function that does not exist; a correction too many or too few.
    """
    claims: dict[str, Claim] = {}
    for path in sorted(folder.glob("*.toml")):
        if path.stem not in (*PARTS, UNJUDGED):
            raise RecordsError(path.name, f"is no part; parts are {', '.join(PARTS)}")
    errata = {erratum.id for erratum in read_errata()}
    for part in PARTS:
        path = folder / f"{part}.toml"
        if not path.exists():
            continue
        for number, table in enumerate(tables(path, "claim"), 1):
            where = f"{path.name}, claim {table.get('id', number)}"
            claim = _claim(part, table, where, pictures, errata, checks)
            if claim.id in claims:
                raise RecordsError(path.name, f"id {claim.id!r} is there twice")
            claims[claim.id] = claim
    return tuple(claims.values())


def read_unjudged(folder: Path = CLAIMS_FOLDER) -> tuple[Unjudged, ...]:
    """Read what gets no verdict."""
    path = folder / f"{UNJUDGED}.toml"
    return tuple(Unjudged(**row) for row in records(path, "part", ("source", "says", "why"))) if path.exists() else ()


def _claim(
    part: str, table: dict[str, Any], where: str, pictures: Collection[str], errata: Collection[str], checks: str
) -> Claim:
    for key in REQUIRED:
        if key not in table:
            raise RecordsError(where, f"{key} is missing")
    for key, value in table.items():
        if key not in REQUIRED + OPTIONAL:
            raise RecordsError(where, f"{key} is unknown; known are {', '.join(REQUIRED + OPTIONAL)}")
        texts = value if key in LISTS else [value]
        if not isinstance(texts, list) or not all(isinstance(text, str) and text.strip() for text in texts):
            raise RecordsError(where, f"{key} = {value!r}: must be {'a list of texts' if key in LISTS else 'text'}")
    kebab(where, table["id"])
    one_of(where, "verdict", table["verdict"], VERDICTS)
    for key in table.get("figures", ()):
        one_of(where, "figure", key, pictures)
    for key in table.get("errata", ()):
        one_of(where, "erratum", key, errata)
    for key, why in (("correction", "what does hold?"), ("errata", "which erratum does it show?")):
        if table["verdict"] in FAULTY and key not in table:
            raise RecordsError(where, f"{key} {'is' if key == 'correction' else 'are'} missing: {why}")
        if table["verdict"] not in FAULTY and key in table:
            raise RecordsError(where, f"has {key} although its verdict is {table['verdict']!r}")
    return Claim(
        id=table["id"],
        part=part,
        source=table["source"],
        says=one_line(table["says"]),
        check=_function(where, checks, table["check"]),
        verdict=table["verdict"],
        figures=tuple(table.get("figures", ())),
        derivation=_subject(where, table["derivation"]) if "derivation" in table else None,
        correction=one_line(table["correction"]) if "correction" in table else None,
        errata=tuple(table.get("errata", ())),
        remark=one_line(table["remark"]) if "remark" in table else None,
    )


def _function(where: str, package: str, name: str) -> Callable[[], Evidence]:
    module, _, function = name.rpartition(".")
    try:
        found = getattr(import_module(f"{package}.{module}"), function, None)
    except ModuleNotFoundError as error:
        if error.name != f"{package}.{module}":
            raise
        found = None
    if not callable(found):
        raise RecordsError(where, f"check = {name!r}: there is no such function in {package}")
    check: Callable[[], Evidence] = found
    return check


def _subject(where: str, key: str) -> str:
    """Return the key of a chapter of the derivations."""
    if key not in CHAPTERS:
        raise RecordsError(where, f"derivation = {key!r}: must be one of {', '.join(CHAPTERS)}")
    return key
