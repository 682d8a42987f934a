"""The errors and gaps of the paper, each once: the list behind the supplement, the report and the
letter.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from symosc.base.errors import SymoscError

ERRATA_FILE = Path(__file__).with_name("errata.toml")
SEVERITIES = {
    "wrong": "a statement that does not hold",
    "gap": "something is left out that the statement needs",
    "typo": "a sign, word or number, without consequence once it is read right",
}
TEXTS = ("where", "printed", "holds", "proof")


@dataclass(frozen=True)
class Erratum:
    """An error or gap of the paper, counted once even if several claims of the paper show it."""

    number: int
    id: str  # how claims name it
    severity: str  # a key of SEVERITIES
    where: str  # its place in the paper
    printed: str  # what stands there
    holds: str
    proof: str
    shown: str = ""  # what of the supplement shows it (LaTeX, may be empty)

    def in_unicode(self) -> Erratum:
        """Return the erratum with its texts as Unicode instead of LaTeX, for the report and the
        letter.
        """
        texts: dict[str, Any] = {name: latex_to_unicode(getattr(self, name)) for name in TEXTS}
        return replace(self, **texts)


def read_errata(path: Path = ERRATA_FILE) -> tuple[Erratum, ...]:
    """Read the errata (texts are LaTeX) in the order of the paper.

    RecordsError if the file is incomplete.
    """
    errata = []
    needed = {"severity", *TEXTS}
    for number, (name, row) in enumerate(read_toml(path).items(), 1):
        where = f"{path.name}, {name}"
        kebab(path.name, name)
        if not isinstance(row, dict) or not needed <= set(row) <= needed | {"shown"}:
            raise RecordsError(
                where, f"must have {', '.join(('severity', *TEXTS))}, and may have shown"
            )
        for key, value in row.items():
            if not isinstance(value, str) or not value.strip():
                raise RecordsError(where, f"{key} = {value!r}: must be text")
        one_of(where, "severity", row["severity"], SEVERITIES)
        errata.append(Erratum(number, name, **{key: one_line(value) for key, value in row.items()}))
    return tuple(errata)


class RecordsError(SymoscError, ValueError):
    """Raised for a TOML file that cannot be used; `where` names the file, and the record in it."""

    def __init__(self, where: str, reason: str) -> None:
        self.where = where
        self.reason = reason
        super().__init__(f"{where}: {reason}")


def read_toml(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise RecordsError(path.name, f"cannot be read: {error}") from None


def kebab(where: str, name: str) -> None:
    """Raise RecordsError, with `where` for the place, unless a name is in kebab case, such as
    "wrong-sign".
    """
    if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name):
        raise RecordsError(where, f"id = {name!r}: must be kebab case")


def one_of(where: str, what: str, value: str, allowed: Collection[str]) -> None:
    """Raise RecordsError, with `where` for the place and `what` for the key, unless a value is one
    of those allowed.
    """
    if value not in allowed:
        raise RecordsError(where, f"{what} = {value!r}: must be one of {', '.join(allowed)}")


def one_line(text: str) -> str:
    """Return a text with single spaces between its words."""
    return " ".join(text.split())


# --- LaTeX as Unicode: what mails and tables take, such as F⁽¹⁾ > 0 for $F^{(1)} > 0$ ---

#: Commands with a letter or sign of their own.
_LETTERS = {
    "alpha": "α", "gamma": "γ", "delta": "δ", "lambda": "λ", "mu": "μ", "pi": "π", "tau": "τ", "varphi": "φ",
    "Theta": "Θ", "Sigma": "Σ", "Omega": "Ω", "partial": "∂", "varepsilon": "ε", "infty": "∞", "ldots": "…"
}  # fmt: skip
_SIGNS = {"le": "≤", "ge": "≥", "ne": "≠", "to": "→", "times": "×", "pm": "±"}
_FUNCTIONS = ("sin", "cos", "arcsin")
_ACCENTS = {r"\dot{x}": "ẋ", r"\ddot{x}": "ẍ", "F_N": "FN", r"\mathbb{R}": "R", r"_\pm": "±"}
_RAISED = str.maketrans("0123456789+-()niα", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁽⁾ⁿⁱᵅ")
_LOWERED = str.maketrans("0123456789+-ijmns", "₀₁₂₃₄₅₆₇₈₉₊₋ᵢⱼₘₙₛ")
_GROUP = r"(?:\{((?:[^{}]|\{[^{}]*\})*)\}|(\\[a-zA-Z]+|.))"
_TOKEN = re.compile(rf"(\\sqrt|[_^]){_GROUP}|\\([a-zA-Z]+)( (?=[a-zA-Z]))?|\\[, ]|.", re.DOTALL)


def latex_to_unicode(text: str) -> str:
    """Return LaTeX text, with formulas between dollars, as Unicode.

    ValueError for an unknown command.
    """
    parts = text.split("$")
    for prose in parts[::2]:
        if "\\" in prose:
            raise ValueError(f"{prose!r}: only formulas may have commands")
    return "".join(
        _unicode(p) if odd % 2 else p.replace("~", " ").replace("--", "–")
        for odd, p in enumerate(parts)
    )


def _unicode(text: str) -> str:
    """Return a LaTeX formula (without dollars) as Unicode."""

    def plain(match: re.Match[str]) -> str:
        sign, group, single, command, space = match.groups()
        if sign == r"\sqrt":
            root = _unicode(group or single)
            if root.isalnum():
                return f"√{root}"
            return f"√({root})"
        if sign:
            return _script(sign, group or single)
        if command in _FUNCTIONS:
            return f"{command} "
        if command in _SIGNS:
            return _SIGNS[command] + (space or "")
        if command and command not in _LETTERS:
            raise ValueError(f"{text!r}: \\{command} is unknown")
        if match[0] in ("_", "^"):
            raise ValueError(f"{text!r}: ends with {match[0]}")
        # A space behind a letter ends its command only.
        if command:
            return _LETTERS[command]
        return {"-": "−", r"\,": " ", r"\ ": " ", "~": " "}.get(match[0], match[0])

    for latex, letter in _ACCENTS.items():
        text = text.replace(latex, letter)
    return _TOKEN.sub(plain, text)


def _script(sign: str, script: str) -> str:
    """Return an index or power in lowered or raised characters or, if Unicode lacks one, behind "_"
    or "^".
    """
    if sign == "^":
        table = _RAISED
    else:
        table = _LOWERED
    if script == r"\mathrm{cr}":
        return "cr"
    letters = script.replace(r"\alpha", "α").replace(" ", "")
    if all(ord(letter) in table for letter in letters):
        return letters.translate(table)
    inside = _unicode(script)
    if len(inside) == 1:
        return f"{sign}{inside}"
    return f"{sign}({inside})"
