"""Short formulas in running text, such as F(1) >= -mu1 FN or 1.2e-30, as HTML, which Markdown takes as well."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape
from unicodedata import normalize

Replacement = str | Callable[[re.Match[str]], str]
GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "theta": "θ", "lambda": "λ", "mu": "μ", "pi": "π",
    "tau": "τ", "omega": "ω", "Theta": "Θ", "Sigma": "Σ", "Omega": "Ω",
}  # fmt: skip
SIGNS = {">=": "≥", "<=": "≤", "!=": "≠", "->": "→", "+-": "±", "x'''": "x‴", "x''": "ẍ", "x'": "ẋ", " - ": " − "}
LETTER = r"(?<![^\W_\d])([A-Za-zα-ωΑ-Ωẋẍ])"  # alone, not the end of a word
RAISED, LOWERED = "[⁰¹²³⁴-⁹⁺⁻⁼⁽⁾ʰⁱˡⁿᵅᵒ]+", "[₀-₉₊₋₌₍₎ₐ-ₜᵢ-ᵥⱼ]+"
PLAIN: list[tuple[str, Replacement]] = [
    # Names that are for the command line.
    (r"\bfig(\d+)\b(?!-)", "Fig.\u00a0\\1"),
    (r"\bfig(\d+)-(\w+)", "Fig.\u00a0\\1 (\\2)"),
    (r"\bbelt([12])\b", "belt\u00a0\\1"),
    (rf"(?<![A-Za-z])({'|'.join(GREEK)})(?![A-Za-z])", lambda found: GREEK[found[1]]),
    (r"(?<![A-Za-z])oo\b", "∞"),
    (r" = (?=[\w.…−-]{1,16}(?![\w.…]))", "\u00a0=\u00a0"),  # a short equation stays on its line
    (r"(^|[\s(\[{=<>≤≥≠,;:|/·])-(?=[\w.(∞])", r"\1−"),
    (r"−(?=\()", "−\u2060"),  # no line ends with a sign
    (r"\|(\w[^|\s]{0,6})\|", "|\u2060\\1\u2060|"),  # nor with the first bar of an absolute value
]
MARKED: list[tuple[str, Replacement]] = [
    (r"\b(\d(?:\.\d+)?)e([+-]?)0*(\d+)\b", lambda found: _power_of_ten(*found.groups())),
    (LETTER + r"\^(?:\{([^{}]+)\}|\(([^()]+)\)|(\w))", lambda found: _raised(found[1], *found.groups()[1:])),
    (LETTER + r"((?:<sup>.*?</sup>)?)_(?:\{([^{}]+)\}|(\([^()]+\)|\w+))", lambda found: _lowered(*found.groups())),
    (r"\b(d?[FG])\((\d(?:, ?[\dα])?)\)", r"\1<sup>(\2)</sup>"),
    (LETTER + r"(\d+)(?!\w|\.\d|<)", r"\1<sub>\2</sub>"),
    (r"(?<![A-Za-z])FN\b", "F<sub>N</sub>"),
    # One look for all: the raised and lowered characters of Unicode too.
    (RAISED, lambda found: f"<sup>{normalize('NFKC', found[0]).replace('ɑ', 'α')}</sup>"),
    (LOWERED, lambda found: f"<sub>{normalize('NFKC', found[0])}</sub>"),
]


def typeset(text: str) -> str:
    """Return a text as HTML, its letters, signs, indices and powers as a printer would set them."""
    for sign, replacement in SIGNS.items():
        text = re.sub(rf"(?<![\w]){re.escape(sign)}" if sign[0] == "x" else re.escape(sign), replacement, text)
    for pattern, plain in PLAIN:
        text = re.sub(pattern, plain, text)
    text = escape(text, quote=False)
    for pattern, marked in MARKED:
        text = re.sub(pattern, marked, text)
    return text


def _power_of_ten(mantissa: str, sign: str, exponent: str) -> str:
    factor = "" if mantissa == "1" else f"{mantissa}·"
    return f"{factor}10<sup>{sign.replace('-', '−').replace('+', '')}{exponent}</sup>"


def _raised(base: str, *powers: str | None) -> str:
    braced, bracketed, single = powers
    power = braced or single or (f"({bracketed})" if base in "FG" else bracketed)
    return f"{base}<sup>{power}</sup>"


def _lowered(base: str, power: str, braced: str | None, other: str) -> str:
    return f"{base}{power}<sub>{braced or other}</sub>"
