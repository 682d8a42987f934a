"""The paper's statements as data (claims.toml), the evidence of their checks, and the coverage of the paper."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from symosc.derive.chapters import CHAPTERS
from symosc.derive.errata import RecordsError, kebab, one_line, one_of, read_errata, read_toml

CONFIRMED = "confirmed"
#: What the paper lays down, and this program with it: there is nothing to find out.
DEFINITION = "by definition"
CORRECTED = "confirmed with a correction"
NOT_AS_PRINTED = "not as printed"
UNDECIDED = "cannot be decided"
VERDICTS = (CONFIRMED, DEFINITION, CORRECTED, NOT_AS_PRINTED, UNDECIDED)
#: Verdicts that say that something is wrong: they need a correction, and the erratum that it belongs to.
FAULTY = (CORRECTED, NOT_AS_PRINTED)

CLAIMS_FILE = Path(__file__).with_name("claims.toml")
CHECKS = "symosc.paper.checks"
#: The parts of the report, in order; a claim `[figures.fig5-stick-appears]` is in the part "figures".
PARTS = {
    "model": "The model and the friction law",
    "theorems": "Theorems 4 to 7",
    "mappings": "The mappings and their equations",
    "figures": "What is said about the figures",
}
REQUIRED = ("source", "says", "check")
KEYS = (*REQUIRED, "see", "verdict", "correction", "remark")


@dataclass(frozen=True)
class Evidence:
    """The result of a check: a verdict computed from its numbers, one or two sentences, and the numbers as text."""

    verdict: str
    finding: str
    numbers: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise ValueError(f"verdict = {self.verdict!r}: must be one of {', '.join(VERDICTS)}")
        if not self.numbers:
            raise ValueError("numbers = {}: evidence needs at least one computed number")
        object.__setattr__(self, "numbers", {name: str(value) for name, value in self.numbers.items()})


def verdict(as_printed: object, corrected: object = False) -> str:
    """Return the verdict on a statement that holds as printed, or only when corrected."""
    return CONFIRMED if as_printed else CORRECTED if corrected else NOT_AS_PRINTED


class Claim(NamedTuple):
    """A statement of the paper, where it stands there, and the check that judges it."""

    id: str
    part: str
    source: str
    says: str
    check: Callable[[], Evidence]
    verdict: str  # the committed one
    figures: tuple[str, ...] = ()  # keys of pictures
    derivation: str | None = None  # the key of a chapter
    correction: str | None = None  # the statement that does hold, if this one does not
    errata: tuple[str, ...] = ()
    remark: str | None = None  # what there is to add to one that holds


class Unjudged(NamedTuple):
    """A part of the paper without a verdict: its place, its content, and why no verdict is possible."""

    source: str
    says: str
    why: str


def read_claims(
    pictures: Collection[str], path: Path = CLAIMS_FILE, checks: str = CHECKS
) -> tuple[tuple[Claim, ...], tuple[Unjudged, ...]]:
    """Read all claims, in the order of PARTS, and the parts of the paper without a verdict."""
    # `pictures` are the keys that claims may refer to, `checks` is the package with the check functions. RecordsError
    # says what is wrong with a file.
    data = read_toml(path)
    unjudged = data.pop("unjudged", [])
    for row in unjudged:
        if sorted(row) != ["says", "source", "why"]:
            raise RecordsError(path.name, f"[[unjudged]] has {', '.join(row)}; must have source, says, why")
    targets = dict.fromkeys(pictures, "figures") | dict.fromkeys(CHAPTERS, "derivation")
    targets |= {erratum.id: "errata" for erratum in read_errata()}
    claims: dict[str, Claim] = {}
    for part in data:
        one_of(path.name, "part", part, PARTS)
    for part in PARTS:
        for name, table in data.get(part, {}).items():
            where = f"{path.name}, claim {name}"
            kebab(where, name)
            if name in claims:
                raise RecordsError(where, f"is in {claims[name].part} already")
            claims[name] = _claim(name, part, table, where, targets, checks)
    return tuple(claims.values()), tuple(Unjudged(**row) for row in unjudged)


def _claim(name: str, part: str, table: dict[str, Any], where: str, targets: dict[str, str], checks: str) -> Claim:
    """Read and check a claim."""
    for key in REQUIRED:
        if key not in table:
            raise RecordsError(where, f"{key} is missing")
    for key, value in table.items():
        if key not in KEYS:
            raise RecordsError(where, f"{key} is unknown; known are {', '.join(KEYS)}")
        texts = value if key == "see" else [value]
        if not isinstance(texts, list) or not all(isinstance(text, str) and text.strip() for text in texts):
            raise RecordsError(where, f"{key} = {value!r}: must be {'a list of texts' if key == 'see' else 'text'}")
    seen: dict[str, list[str]] = {"figures": [], "derivation": [], "errata": []}
    for target in table.get("see", ()):
        one_of(where, "see", target, targets)
        seen[targets[target]].append(target)
    if len(seen["derivation"]) > 1:
        raise RecordsError(where, f"see: one chapter at most, not {' and '.join(seen['derivation'])}")
    said = {key: one_line(value) for key, value in table.items() if key not in ("see", "check")}
    said.setdefault("verdict", CORRECTED if "correction" in table else CONFIRMED)
    one_of(where, "verdict", said["verdict"], VERDICTS)
    for what, there in (("a correction", "correction" in table), ("an erratum", bool(seen["errata"]))):
        if there != (said["verdict"] in FAULTY):
            raise RecordsError(where, f"{'has' if there else 'needs'} {what}: its verdict is {said['verdict']!r}")
    return Claim(
        name,
        part,
        check=_check(where, checks, table["check"]),
        figures=tuple(seen["figures"]),
        derivation=next(iter(seen["derivation"]), None),
        errata=tuple(seen["errata"]),
        **said,
    )


def _check(where: str, package: str, text: str) -> Callable[[], Evidence]:
    """Return the call given by a text such as "motions.together(FIG5, 1)"; names are those of the module."""
    name, _, arguments = text.partition("(")
    module, _, function = name.rpartition(".")
    try:
        names = vars(import_module(f"{package}.{module}"))
        given = ast.parse(f"f({arguments}" if arguments else "f()", mode="eval").body
        values = [
            names[each.id] if isinstance(each, ast.Name) else ast.literal_eval(each)
            for each in given.args  # type: ignore[attr-defined]
        ]
        check: Callable[[], Evidence] = names[function]
    except (ModuleNotFoundError, KeyError, SyntaxError, ValueError) as error:
        if isinstance(error, ModuleNotFoundError) and error.name not in (f"{package}.{module}", f"{package}."):
            raise
        raise RecordsError(where, f"check = {text!r}: there is no such function, or value, in {package}") from None
    return partial(check, *values)


# --- which numbered equations, lemmas, theorems, figures and sections of the paper the claims are on ---


class Item(NamedTuple):
    """A numbered part of the paper, such as ("equation", 26); a section without a number has 0."""

    kind: str
    number: int

    @property
    def label(self) -> str:
        """Its name in the text, such as (26) or Lemma 1."""
        if self.kind == "equation":
            return f"({self.number})"
        return "Abstract" if self == ("section", 0) else f"{NAMES[self.kind]} {self.number}"


NAMES = {"section": "Section", "equation": "eq.", "lemma": "Lemma", "theorem": "Theorem", "figure": "Fig."}
#: The first and the last number of each kind, and all items of the paper.
EXTENT = {"section": (0, 7), "equation": (1, 66), "lemma": (1, 3), "theorem": (4, 7), "figure": (1, 10)}
PAPER = tuple(Item(kind, number) for kind, (first, last) in EXTENT.items() for number in range(first, last + 1))
_WORDS = {
    "Sections?": "section",
    "eqs?[.]": "equation",
    "Lemmas?": "lemma",
    "Theorems?": "theorem",
    "Figs?[.]": "figure",
}
# "after eq. (19)" is a place, and no statement on (19).
_PLACE = re.compile(rf"(?:before|after) (?:{'|'.join(_WORDS)}) [(]?\d+[)]?")
# One number of a list, with what joins it to the one before: "(26)", ", (32)", " and 5", " to (48)", ", (55.2)".
_NUMBER = re.compile(r"(?P<joint>,? and |, | to | )[(]?(?P<number>\d+)(?:[.]\d+)?[)]?")


def items_of(source: str) -> list[Item]:
    """Return the sections, equations, lemmas, theorems and figures that a source names: "eqs. (26), (32) to (34)"."""
    found = [Item("section", 0)] if "Abstract" in source else []
    source = _PLACE.sub("", source)
    for word, kind in _WORDS.items():
        for start in re.finditer(rf"\b{word}", source):
            found += [Item(kind, number) for number in _numbers(source, start.end())]
    return list(dict.fromkeys(found))


def _numbers(source: str, at: int) -> Iterator[int]:
    """Yield the numbers of a list such as "(26), (32) to (34)"."""
    last = 0
    while match := _NUMBER.match(source, at):
        number, at = int(match["number"]), match.end()
        yield from range(last + 1, number) if match["joint"] == " to " else ()
        yield number
        last = number


def coverage(entries: Iterable[Claim | Unjudged]) -> dict[Item, list[Any]]:
    """Return the entries on each item of the paper, in the paper's order."""
    found: dict[Item, list[Any]] = {item: [] for item in PAPER}
    for entry in entries:
        for item in items_of(entry.source):
            found[item].append(entry)
    return found
