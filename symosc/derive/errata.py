"""The errors and gaps of the paper, each once: the list behind the supplement, the report and the letter."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from symosc.derive.records import RecordsError, kebab, one_of, records

ERRATA_FILE = Path(__file__).with_name("errata.toml")
SEVERITIES = {
    "wrong": "a statement that does not hold",
    "gap": "something is left out that the statement needs",
    "typo": "a sign, word or number, without consequence once it is read right",
}
TEXTS = ("where", "printed", "holds", "proof")


@dataclass(frozen=True)
class Erratum:
    """An error or gap of the paper, counted once however many claims it shows in.

    Its number in the list, its key of SEVERITIES, its place in the paper, what stands there and what holds, why in
    about two lines, and what of the supplement shows it (LaTeX, may be empty).
    """

    number: int
    id: str
    severity: str
    where: str
    printed: str
    holds: str
    proof: str
    shown: str = ""

    def in_unicode(self) -> Erratum:
        """Return the erratum with texts that need no LaTeX, for the report and the letter."""
        texts: dict[str, Any] = {name: latex_to_unicode(getattr(self, name)) for name in TEXTS}
        return replace(self, **texts)


def read_errata(path: Path = ERRATA_FILE) -> tuple[Erratum, ...]:
    """Read the errata, with texts in LaTeX, in the order of the paper; RecordsError for a file that is not complete."""
    rows = records(path, "erratum", ("id", "severity", *TEXTS), ("shown",))
    for row in rows:
        kebab(path.name, row["id"])
        one_of(f"{path.name}, erratum {row['id']}", "severity", row["severity"], SEVERITIES)
    if len({row["id"] for row in rows}) < len(rows):
        raise RecordsError(path.name, "an id is there twice")
    return tuple(Erratum(number, **row) for number, row in enumerate(rows, 1))


# --- LaTeX as Unicode: what mails and tables take, such as F⁽¹⁾ > 0 for $F^{(1)} > 0$ ---

#: Commands with a letter or sign of their own.
_LETTERS = {
    "alpha": "α", "gamma": "γ", "delta": "δ", "lambda": "λ", "mu": "μ", "pi": "π", "tau": "τ", "varphi": "φ",
    "Theta": "Θ", "Sigma": "Σ", "Omega": "Ω", "partial": "∂", "varepsilon": "ε", "infty": "∞", "ldots": "…",
}  # fmt: skip
_SIGNS = {"le": "≤", "ge": "≥", "ne": "≠", "to": "→", "times": "×", "pm": "±"}
_FUNCTIONS = ("sin", "cos", "arcsin")
_ACCENTS = {r"\dot{x}": "ẋ", r"\ddot{x}": "ẍ", "F_N": "FN", r"\mathbb{R}": "R", r"_\pm": "±"}
_RAISED = dict(zip("0123456789+-()niα", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁽⁾ⁿⁱᵅ", strict=True))
_LOWERED = dict(zip("0123456789+-ijmns", "₀₁₂₃₄₅₆₇₈₉₊₋ᵢⱼₘₙₛ", strict=True))
_TOKEN = re.compile(r"\\([a-zA-Z]+)( (?=[a-zA-Z]))?|(\\[, ])|([_^])|(.)", re.DOTALL)


def latex_to_unicode(text: str) -> str:
    """Return LaTeX text, with formulas between dollars, as Unicode; ValueError for a command that it does not know."""
    parts = text.split("$")
    return "".join(_formula(part) if odd % 2 else _prose(part) for odd, part in enumerate(parts))


def _prose(text: str) -> str:
    text = text.replace("~", " ").replace("--", "–")
    if "\\" in text:
        raise ValueError(f"{text!r}: only formulas may have commands")
    return text


def _formula(text: str) -> str:
    for latex, plain in _ACCENTS.items():
        text = text.replace(latex, plain)
    out, place = "", 0
    while place < len(text):
        found = _TOKEN.match(text, place)
        assert found is not None
        place = found.end()
        if found[1] == "sqrt" or found[4]:
            group = re.compile(r"\{((?:[^{}]|\{[^{}]*\})*)\}|(\\[a-zA-Z]+|.)").match(text, place)
            if group is None:
                raise ValueError(f"{text!r}: ends with {found[0]}")
            place = group.end()
            out += _root(_formula(group[1] or group[2])) if found[1] else _script(found[4], group[1] or group[2])
        else:
            out += _command(found[1], found[2], text) if found[1] else _sign(found[0])
    return out


def _command(name: str, space: str | None, text: str) -> str:
    if name in _FUNCTIONS:
        return f"{name} "
    if name in _SIGNS:
        return _SIGNS[name] + (space or "")
    if name in _LETTERS:
        return _LETTERS[name]  # a space behind it ends the command only
    raise ValueError(f"{text!r}: \\{name} is unknown")


def _sign(token: str) -> str:
    return {"-": "−", r"\,": " ", r"\ ": " ", "~": " "}.get(token, token)


def _root(inside: str) -> str:
    return f"√{inside}" if inside.isalnum() else f"√({inside})"


def _script(place: str, script: str) -> str:
    """Return an index or power by raised or lowered characters, or with its sign where Unicode lacks one."""
    table = _RAISED if place == "^" else _LOWERED
    if script == r"\mathrm{cr}":
        return "cr"
    letters = script.replace(r"\alpha", "α").replace(" ", "")
    if set(letters) <= set(table):
        return "".join(table[letter] for letter in letters)
    inside = _formula(script)
    return f"{place}{inside}" if len(inside) == 1 else f"{place}({inside})"
