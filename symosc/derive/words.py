"""LaTeX text as plain words: formulas between dollars become readable ASCII, commands of text disappear."""

from __future__ import annotations

import re

SWAPS = {
    r"\ge": ">=", r"\le": "<=", r"\ne": "!=", r"\to": "->", r"\mapsto": "->", r"\infty": "inf", r"\cdot": "*",
    r"\in": "in", r"\notin": "not in", r"\cup": "or", r"\times": "x", r"\varnothing": "nothing", r"\pm": "+-",
    r"\colon": ":", r"\ldots": "...", r"\dots": "...", r"\iff": "iff", r"\Rightarrow": "=>", r"\circ": "after",
    r"\subset": "in", r"\ast": "*", r"\approx": "~=", r"\mid": "|", r"\lVert": "||", r"\rVert": "||",
    r"\lvert": "|", r"\rvert": "|", r"\lceil": "ceil(", r"\rceil": ")", r"\prime": "'", r"\top": "T",
    r"\leftrightarrow": "<->", r"\max": "max", r"\min": "min", r"\equiv": "=",
}  # fmt: skip
#: Commands that print nothing of their own.
SILENT = re.compile(r"\\(?:left|right|[bB]igg?[lr]?|displaystyle|nonumber|notag|limits|quad|qquad|[,;!: ])(?![a-z])")
WRAPPERS = ("text", "mathrm", "operatorname", "emph", "textbf", "texttt", "textsc", "textit", "mathbb", "mathcal")
TOKEN = re.compile(r"\\[a-zA-Z]+|\\.|\d+(?:\.\d+)?|[a-zA-Z]|\s+|.", re.DOTALL)
#: A word that needs a space before a word or number that follows.
WORDY = re.compile(r"[\w')\]]$")


def plain_words(text: str) -> str:
    """Return LaTeX text, with formulas between dollars, as readable plain text."""
    parts = text.split("$")
    shown = [plain_math(part) if odd % 2 else _prose(part) for odd, part in enumerate(parts)]
    return "".join(shown)


def _prose(text: str) -> str:
    for wrapper in WRAPPERS:
        text = re.sub(rf"\\{wrapper}\{{([^{{}}]*)\}}", r"\1", text)
    text = text.replace(r"\'o", "o").replace(r"\'{o}", "o").replace("``", '"').replace("''", '"').replace("--", "-")
    text = re.sub(r"\\item(?:\[([^\]]*)\])?", r"\1", text)
    text = re.sub(r"\\(?:begin|end)\{\w+\}", "", text).replace("~", " ").replace(r"\ ", " ")
    return re.sub(r"\\[a-zA-Z]+|[{}]|\\", "", text)


def plain_math(text: str) -> str:
    """Return LaTeX mathematics as text: fractions as quotients, Greek letters by name, words kept apart."""
    text = SILENT.sub(" ", text).replace("~", " ").replace("&", "")
    tokens = [token for token in TOKEN.findall(text) if not token.isspace()]
    words, _ = _read(tokens, 0)
    words = re.sub(r"\s+", " ", words).strip()
    words = re.sub(r"([\[({]) ", r"\1", words)
    return re.sub(r"(^|[\[({]|[=<>,+*] ?)- ", r"\1-", words)


def _read(tokens: list[str], place: int) -> tuple[str, int]:
    out = ""
    while place < len(tokens) and tokens[place] != "}":
        word, place = _item(tokens, place)
        out = _joined(out, word)
    return out, place + 1


def _item(tokens: list[str], place: int) -> tuple[str, int]:
    token = tokens[place]
    if token == "{":
        return _read(tokens, place + 1)
    if token in (r"\frac", r"\tfrac", r"\dfrac"):
        above, place = _item(tokens, place + 1)
        below, place = _item(tokens, place)
        quotient = f"{_bracketed(above)}/{_bracketed(below, below=True)}"
        alone = place >= len(tokens) or tokens[place] in "=<>+-,.;:)]}" or tokens[place] in SWAPS
        return quotient if alone else f"({quotient})", place
    if token == r"\sqrt":
        inside, place = _item(tokens, place + 1)
        return f"sqrt({inside})", place
    if token in (r"\dot", r"\ddot"):
        inside, place = _item(tokens, place + 1)
        return inside + ("'" if token == r"\dot" else "''"), place
    if token in ("^", "_"):
        script, place = _item(tokens, place + 1)
        script = re.sub(r"^(\w) ([+-]) (\w)$", r"\1\2\3", script)
        plain = re.fullmatch(r"[\w.+']+|\(.*\)|\+|-", script)
        return token + (
            script if plain and ("+" not in script.strip("+") or script[0] == "(") else f"({script})"
        ), place
    if token[1:] in WRAPPERS and token[0] == "\\":
        inside, place = _item(tokens, place + 1)
        return inside.replace(" ", ""), place
    if token in SWAPS:
        return SWAPS[token] if token == r"\infty" else f" {SWAPS[token]} ", place + 1
    if token.startswith("\\"):
        return token[1:], place + 1
    if token in "=<>+-":
        return f" {token} ", place + 1
    return token + (" " if token in ",;" else ""), place + 1


def _joined(before: str, word: str) -> str:
    """Keep factors apart: letters, numbers and names that stand side by side are a product."""
    tight = word[:1] in "^_',.;:)]" or word[:1] == " "
    if before and not tight and WORDY.search(before) and re.match(r"[\w(]", word):
        call = word.startswith("(") and re.search(
            r"(?:^|\W)(?:[a-zA-Z]'{0,2}|sin|cos|sinh|cosh|arcsin|sqrt|Sgn|sgn|diag|det|mod)$", before
        )
        return before + word if call else f"{before} {word}"
    return before + word


def _bracketed(text: str, below: bool = False) -> str:
    simple = re.fullmatch(r"[\w.'^]+(?:_\w+)?", text)
    return text if simple or (not below and not re.search(r"[ +\-/]", text.strip("- "))) else f"({text})"
