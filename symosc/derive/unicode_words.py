r"""LaTeX text as Unicode: what mails and tables take, such as F⁽¹⁾ > 0 for $F^{(1)} > 0$.

It reads what the list of errata is written in, and refuses everything else.
"""

from __future__ import annotations

import re

#: Commands with a letter or sign of their own.
LETTERS = {
    "alpha": "α", "gamma": "γ", "delta": "δ", "lambda": "λ", "mu": "μ", "pi": "π", "tau": "τ", "varphi": "φ",
    "Theta": "Θ", "Sigma": "Σ", "Omega": "Ω", "partial": "∂", "varepsilon": "ε", "infty": "∞", "ldots": "…",
}  # fmt: skip
SIGNS = {"le": "≤", "ge": "≥", "ne": "≠", "to": "→", "times": "×", "pm": "±"}
FUNCTIONS = ("sin", "cos", "arcsin")
ACCENTS = {r"\dot{x}": "ẋ", r"\ddot{x}": "ẍ", "F_N": "FN", r"\mathbb{R}": "R", r"_\pm": "±"}
RAISED = dict(zip("0123456789+-()niα", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁽⁾ⁿⁱᵅ", strict=True))
LOWERED = dict(zip("0123456789+-ijmns", "₀₁₂₃₄₅₆₇₈₉₊₋ᵢⱼₘₙₛ", strict=True))
TOKEN = re.compile(r"\\([a-zA-Z]+)( (?=[a-zA-Z]))?|(\\[, ])|([_^])|(.)", re.DOTALL)


def unicode_words(text: str) -> str:
    """Return LaTeX text, with formulas between dollars, as Unicode.

    Raises
    ------
    ValueError
        For a command that it does not know.
    """
    parts = text.split("$")
    return "".join(_formula(part) if odd % 2 else _prose(part) for odd, part in enumerate(parts))


def _prose(text: str) -> str:
    text = text.replace("~", " ").replace("--", "–")
    if "\\" in text:
        raise ValueError(f"{text!r}: only formulas may have commands")
    return text


def _formula(text: str) -> str:
    for latex, plain in ACCENTS.items():
        text = text.replace(latex, plain)
    out, place = "", 0
    while place < len(text):
        found = TOKEN.match(text, place)
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
    if name in FUNCTIONS:
        return f"{name} "
    if name in SIGNS:
        return SIGNS[name] + (space or "")
    if name in LETTERS:
        return LETTERS[name]  # a space behind it ends the command only
    raise ValueError(f"{text!r}: \\{name} is unknown")


def _sign(token: str) -> str:
    return {"-": "−", r"\,": " ", r"\ ": " ", "~": " "}.get(token, token)


def _root(inside: str) -> str:
    return f"√{inside}" if inside.isalnum() else f"√({inside})"


def _script(place: str, script: str) -> str:
    """Return an index or power by raised or lowered characters, or with its sign where Unicode lacks one."""
    table = RAISED if place == "^" else LOWERED
    if script == r"\mathrm{cr}":
        return "cr"
    letters = script.replace(r"\alpha", "α").replace(" ", "")
    if set(letters) <= set(table):
        return "".join(table[letter] for letter in letters)
    inside = _formula(script)
    return f"{place}{inside}" if len(inside) == 1 else f"{place}({inside})"
