"""Steps of derivations as LaTeX, in lines that fit the page."""

from __future__ import annotations

import re
from itertools import takewhile

import sympy as sp

from symosc.base.aliases import Expr
from symosc.derive.steps import Step
from symosc.symbolic.latex import latex, terms

# Width of a line of mathematics, in units of a digit; the text is 16 cm wide, and a number follows
# the formula.
LINE_WIDTH = 70.0
#: Widths of tokens; other commands and small letters have 1.1, capital letters and m 1.7.
_WIDTHS = dict.fromkeys((r"\left", r"\right", r"\bigl", r"\bigr", r"\biggl", r"\biggr"), 0.3)
_WIDTHS |= {
    name: 1.0 * len(name)
    for name in (r"\sin", r"\cos", r"\arcsin", r"\sinh", r"\cosh", r"\coth", r"\lim")
}
_WIDTHS |= {
    r"\Omega": 1.5,
    r"\omega": 1.3,
    r"\theta": 1.0,
    r"\quad": 2.0,
    r"\qquad": 4.0,
    r"\,": 0.4,
    r"\;": 0.6,
}
_WIDTHS |= {"=": 2.7, "+": 2.5, "-": 2.5, "<": 2.7, ">": 2.7, "(": 0.8, ")": 0.8, "'": 0.5}
_WIDTHS |= dict.fromkeys(",.|[]", 0.6)
_TOKEN = re.compile(r"\\[a-zA-Z]+|\\.|[{}^_]|\S")
OPERATORS = {"=": "=", ">": ">", "<": "<", ">=": r"\ge", "<=": r"\le", "in": r"\in"}


def width(text: str) -> float:
    """Estimate the printed width of LaTeX mathematics in units of a digit."""
    tokens = iter(_TOKEN.findall(text))

    def item(token: str) -> float:
        if token == "{":
            return group()
        if token in (r"\frac", r"\tfrac"):
            above = item(next(tokens, ""))
            below = item(next(tokens, ""))
            scale = 0.8 if token == r"\tfrac" else 1.0
            return scale * max(above, below) + 0.5
        if token in ("^", "_", r"\operatorname", r"\mathrm", r"\text", r"\dot", r"\ddot"):
            scale = 0.75 if token in "^_" else 1.0
            return scale * item(next(tokens, ""))
        if token:
            return _WIDTHS.get(token, 1.7 if token.isupper() or token == "m" else 1.1)
        return 0.0

    def group() -> float:
        total = 0.0
        for token in takewhile("}".__ne__, tokens):
            total += item(token)
        return total

    return group()


def lines(statement: Step, decimals: bool = False, left_width: float | None = None) -> list[str]:
    """Return a statement as rows of an align environment: `left &= right`, broken before + and -
    where needed.

    `decimals` asks for decimals, not fractions; `left_width` is the left column's width if other
    statements share it.
    """
    left = latex(statement.left, decimals)
    right = latex(statement.right, decimals)
    if left_width is None:
        left_width = width(left)
    # What the left column, the sign and the number leave, but never less than a part of the line.
    room = max(LINE_WIDTH - 4.0 - left_width, 0.3 * LINE_WIDTH)
    rows = [right]
    if isinstance(statement.right, sp.Expr) and width(right) > room:
        first, *later_pieces = _pieces(statement.right, decimals, room)
        rows = [first]
        for piece in later_pieces:
            joined = f"{rows[-1]} {piece}"
            if width(joined) <= room:
                rows[-1] = joined
            else:
                rows.append(piece)
    first_row, *later_rows = rows
    first_line = f"{left} &{OPERATORS[statement.op]} {first_row}"
    return [first_line, *(rf"&\quad {row}" for row in later_rows)]


def _pieces(expr: Expr, decimals: bool, room: float) -> list[str]:
    """Return the LaTeX of a sum in pieces, between which a row may be broken.

    Terms wider than `room` are split.
    """
    pieces: list[str] = []
    for term in terms(expr):
        text = _signed(latex(term, decimals), not pieces)
        sums = [factor for factor in sp.Mul.make_args(term) if factor.is_Add]
        if width(text) <= room or not sums:
            pieces.append(text)
            continue
        # The widest sum is broken inside its parentheses; the other factors stand before it.
        longest = max(sums, key=lambda factor: width(latex(factor, decimals)))
        others = latex(term / longest, decimals)
        factor_text = {"1": "", "- 1": "- "}.get(others, others)
        if factor_text or pieces:
            head = _signed(factor_text, not pieces)
        else:
            head = ""
        inner = _pieces(longest, decimals, room)
        if any(r"\frac" in part for part in inner):
            size = "bigg"
        else:
            size = "big"
        inner[-1] += rf" \{size}r)"
        if width(f"{head} {inner[0]}") > room:  # the opening parenthesis ends its row
            inner.insert(0, rf"{head} \{size}l(")
        else:
            inner[0] = rf"{head} \{size}l( {inner[0]}"
        pieces += inner
    return pieces


def _signed(text: str, first: bool) -> str:
    """Return the LaTeX of a term with its sign in front, but no "+" if it is the first term."""
    if first or text.startswith("-"):
        return text
    return f"+ {text}"
