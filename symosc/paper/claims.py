"""The paper's statements as data (claims.toml), the evidence of their checks, and the numbered
parts of the paper.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection
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
#: Verdicts that say that something is wrong: they need a correction, and the erratum that it
#: belongs to.
FAULTY = (CORRECTED, NOT_AS_PRINTED)

CLAIMS_FILE = Path(__file__).with_name("claims.toml")
#: The parts of the report, in order; a claim `[figures.fig5-stick-appears]` is in the part
#: "figures".
PARTS = {
    "model": "The model and the friction law",
    "theorems": "Theorems 4 to 7",
    "mappings": "The mappings and their equations",
    "figures": "What is said about the figures",
}
REQUIRED = ("source", "says")
OPTIONAL = ("check", "see", "verdict", "correction", "remark")


@dataclass(frozen=True)
class Evidence:
    """The result of a check: a verdict computed from its numbers, one or two sentences, and the
    numbers as text.
    """

    verdict: str
    finding: str
    numbers: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise ValueError(f"verdict = {self.verdict!r}: must be one of {', '.join(VERDICTS)}")
        if not self.numbers:
            raise ValueError("numbers = {}: evidence needs at least one computed number")
        object.__setattr__(
            self, "numbers", {name: str(value) for name, value in self.numbers.items()}
        )


def verdict(as_printed: object, corrected: object = False) -> str:
    """Return CONFIRMED if a statement holds as printed, CORRECTED if it holds when corrected, else
    NOT_AS_PRINTED.
    """
    if as_printed:
        return CONFIRMED
    if corrected:
        return CORRECTED
    return NOT_AS_PRINTED


def evidence(
    right: object, finding: str, numbers: dict[str, Any], if_right: str = CONFIRMED
) -> Evidence:
    """Return evidence with the verdict `if_right` and this finding if `right` is true, else with
    NOT_AS_PRINTED.
    """
    if right:
        return Evidence(if_right, finding, numbers)
    return Evidence(NOT_AS_PRINTED, "Its numbers refute it.", numbers)


class Refuted(Exception):
    """The error that a check raises if the stick or orbit of its statement does not exist.

    Carries the evidence.
    """

    def __init__(self, finding: str, numbers: dict[str, Any]) -> None:
        self.evidence = Evidence(NOT_AS_PRINTED, finding, numbers)
        super().__init__(finding)


class Claim(NamedTuple):
    """A statement of the paper, where it stands there, and the check that judges it."""

    id: str
    part: str
    source: str
    says: str
    check: Callable[[], Evidence]
    verdict: str  # the expected one, from claims.toml
    figures: tuple[str, ...] = ()  # keys of pictures
    derivation: str | None = None  # the key of a chapter
    correction: str | None = None  # the statement that does hold, if this one does not
    errata: tuple[str, ...] = ()
    remark: str | None = None  # what there is to add to one that holds


class Unjudged(NamedTuple):
    """A part of the paper without a verdict: its place, its content, and why no verdict is
    possible.
    """

    source: str
    says: str
    why: str


def read_claims(
    pictures: Collection[str], path: Path = CLAIMS_FILE, checks: str = "symosc.paper.checks"
) -> tuple[tuple[Claim, ...], tuple[Unjudged, ...]]:
    """Read all claims of claims.toml, part by part, and the parts of the paper without a verdict.

    `pictures` has the keys of the pictures that claims may name; `checks` is the package of the
    check functions. A faulty file raises RecordsError.
    """
    data = read_toml(path)
    claims = dict[str, Claim]()
    unjudged = _read_unjudged(data.pop("unjudged", {}), f"{path.name}, [unjudged]")
    # What a claim may refer to: the kind of each target.
    kinds = dict.fromkeys(pictures, "figures") | dict.fromkeys(CHAPTERS, "derivation")
    kinds |= {erratum.id: "errata" for erratum in read_errata()}
    for part in data:
        one_of(path.name, "part", part, PARTS)
    for part in PARTS:
        for name, table in data.get(part, {}).items():
            location = f"{path.name}, claim {name}"
            kebab(location, name)
            if name in claims:
                raise RecordsError(location, f"is in {claims[name].part} already")
            _check_texts(location, table)
            see = table.pop("see", ())
            for target in see:
                one_of(location, "see", target, kinds)
            figures, chapters, errata = (
                tuple(target for target in see if kinds[target] == kind)
                for kind in ("figures", "derivation", "errata")
            )
            if len(chapters) > 1:
                raise RecordsError(
                    location, f"see: one chapter at most, not {' and '.join(chapters)}"
                )
            # A claim's check is the function of its name in its part's module, unless it names one.
            own_check = f"{part}.{name.replace('-', '_')}"
            check = _check_call(location, checks, table.pop("check", own_check))
            derivation = next(iter(chapters), None)
            has_correction = "correction" in table
            texts = {"verdict": CORRECTED if has_correction else CONFIRMED}  # unless it gives one
            texts |= {key: one_line(value) for key, value in table.items()}
            one_of(location, "verdict", texts["verdict"], VERDICTS)
            is_faulty = texts["verdict"] in FAULTY
            if not has_correction == bool(errata) == is_faulty:  # all three or none
                faulty = " or ".join(map(repr, FAULTY))
                raise RecordsError(
                    location,
                    f"must have a correction and see an erratum if its verdict is {faulty} only",
                )
            claims[name] = Claim(
                name,
                part,
                check=check,
                figures=figures,
                derivation=derivation,
                errata=errata,
                **texts,
            )
    return tuple(claims.values()), unjudged


def _read_unjudged(rows: dict[str, Any], location: str) -> tuple[Unjudged, ...]:
    """Return the parts of the paper without a verdict, from rows of statement, place and reason."""
    unjudged = []
    for statement, row in rows.items():
        if not isinstance(row, list) or [type(text) for text in row] != [str, str]:
            problem = f"{statement} = {row!r}: must be a place, and a reason"
            raise RecordsError(location, problem)
        place, reason = row
        unjudged.append(Unjudged(place, statement, reason))
    return tuple(unjudged)


def _check_texts(location: str, table: dict[str, Any]) -> None:
    """Raise RecordsError if a claim's table lacks a required entry, has an unknown one, or one that
    is not text.
    """
    if not set(REQUIRED) <= set(table) <= {*REQUIRED, *OPTIONAL}:
        rule = f"must have {', '.join(REQUIRED)}, and may have {', '.join(OPTIONAL)}"
        raise RecordsError(location, f"has {', '.join(table)}; {rule}")
    for key, value in table.items():
        if key == "see":
            texts = value
        else:
            texts = [value]
        if not isinstance(texts, list) or not all(
            isinstance(text, str) and text.strip() for text in texts
        ):
            raise RecordsError(
                location,
                f"{key} = {value!r}: must be {'a list of texts' if key == 'see' else 'text'}",
            )


def _check_call(location: str, package: str, text: str) -> Callable[[], Evidence]:
    """Return the function call that a text such as "motions.together(FIG5, 1)" describes, ready to
    be run.
    """
    name, _, arguments = text.partition("(")
    module, _, function = name.rpartition(".")
    try:
        names = vars(import_module(f"{package}.{module}"))
        call: Any = ast.parse(f"f({arguments or ')'}", mode="eval").body
        values = [
            names[arg.id] if isinstance(arg, ast.Name) else ast.literal_eval(arg)
            for arg in call.args
        ]
        return partial(names[function], *values)
    except (ModuleNotFoundError, KeyError, SyntaxError, ValueError) as error:
        raise RecordsError(
            location, f"check = {text!r}: there is no such function, or value, in {package}"
        ) from error


# --- which numbered equations, lemmas, theorems, figures and sections of the paper the claims are
# on ---


#: The kinds of numbered parts of the paper: pattern of the name in texts, name, plural, first and
#: last number.
KINDS = {
    "section": ("Sections?", "Section", "sections (with the abstract)", 0, 7),
    "equation": ("eqs?[.]", "eq.", "numbered equations", 1, 66),
    "lemma": ("Lemmas?", "Lemma", "lemmas", 1, 3),
    "theorem": ("Theorems?", "Theorem", "theorems", 4, 7),
    "figure": ("Figs?[.]", "Fig.", "figures", 1, 10),
}


def _label(kind: str, number: int) -> str:
    """Return the name of a numbered part of the paper, such as "(26)" or "Lemma 1".

    Section 0 is the abstract.
    """
    if kind == "equation":
        return f"({number})"
    if (kind, number) == ("section", 0):
        return "Abstract"
    _, name, *_ = KINDS[kind]
    return f"{name} {number}"


#: All numbered parts of the paper, in its order, and their kinds.
PAPER = {
    _label(kind, n): kind
    for kind, (*_, first, last) in KINDS.items()
    for n in range(first, last + 1)
}
# "after eq. (19)" is a place, and no statement on (19).
_PLACE = re.compile(
    rf"(?:before|after) (?:{'|'.join(pattern for pattern, *_ in KINDS.values())}) [(]?\d+[)]?"
)
# One number of a list, with what joins it to the one before: "(26)", ", (32)", " and 5", " to
# (48)", ", (55.2)".
_NUMBER = r"(,? and |, | to | )[(]?(\d+)(?:[.]\d+)?[)]?"


def items_of(source: str) -> list[str]:
    """Return the sections, equations, lemmas, theorems and figures that a text like "eqs. (26),
    (32) to (34)" names.
    """
    if "Abstract" in source:
        labels = ["Abstract"]
    else:
        labels = []
    source = _PLACE.sub("", source)
    for name, (pattern, *_) in KINDS.items():
        for numbers in re.finditer(rf"\b{pattern}((?:{_NUMBER})+)", source):
            last = 0
            for joint, digits in re.findall(_NUMBER, numbers[1]):
                if joint == " to ":
                    first = last + 1
                else:
                    first = int(digits)
                last = int(digits)
                labels += [_label(name, number) for number in range(first, last + 1)]
    return list(dict.fromkeys(labels))
