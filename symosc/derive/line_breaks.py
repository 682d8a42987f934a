"""Lines of mathematics that fit the page: their width, and where a sum is broken."""

from __future__ import annotations

import re
from typing import Any

import sympy as sp

from symosc.derive.latex import latex, terms
from symosc.derive.steps import Relation

Expr = Any  # sympy ships no types

# Width of a line of mathematics, in units of a digit; the text is 16 cm wide and a number stands behind.
LINE_WIDTH = 70.0

_NARROW = {",": 0.6, ".": 0.6, "(": 0.8, ")": 0.8, "|": 0.6, "'": 0.5, "[": 0.6, "]": 0.6}
_WIDE = {r"\Omega": 1.5, r"\quad": 2.0, r"\qquad": 4.0, r"\,": 0.4, r"\;": 0.6, r"\omega": 1.3, r"\theta": 1.0}
_OPERATOR = {"=": 2.7, "+": 2.5, "-": 2.5, "<": 2.7, ">": 2.7}
_TOKEN = re.compile(r"\\[a-zA-Z]+|\\.|[{}^_]|\S")


def width(text: str) -> float:
    """Estimate how wide LaTeX mathematics prints, in units of a digit."""
    tokens = _TOKEN.findall(text)
    total, _ = _width(tokens, 0)
    return total


def _width(tokens: list[str], place: int) -> tuple[float, int]:
    total = 0.0
    while place < len(tokens) and tokens[place] != "}":
        token = tokens[place]
        if token in (r"\frac", r"\tfrac"):
            above, place = _group(tokens, place + 1)
            below, place = _group(tokens, place)
            total += (0.8 if token == r"\tfrac" else 1.0) * max(above, below) + 0.5
            continue
        if token in ("^", "_"):
            script, place = _group(tokens, place + 1)
            total += 0.75 * script
            continue
        if token in (r"\operatorname", r"\mathrm", r"\text", r"\dot", r"\ddot"):
            inner, place = _group(tokens, place + 1)
            total += inner
            continue
        if token == "{":
            inner, place = _width(tokens, place + 1)
            total += inner
            place += 1
            continue
        total += _single(token)
        place += 1
    return total, place


def _group(tokens: list[str], place: int) -> tuple[float, int]:
    if place < len(tokens) and tokens[place] == "{":
        inner, place = _width(tokens, place + 1)
        return inner, place + 1
    return (_single(tokens[place]), place + 1) if place < len(tokens) else (0.0, place)


def _single(token: str) -> float:
    if token in (r"\left", r"\right", r"\bigl", r"\bigr", r"\biggl", r"\biggr"):
        return 0.3
    if token in (r"\sin", r"\cos", r"\arcsin", r"\sinh", r"\cosh", r"\lim"):
        return len(token) * 1.0
    if token in _WIDE:
        return _WIDE[token]
    if token in _OPERATOR:
        return _OPERATOR[token]
    if token in _NARROW:
        return _NARROW[token]
    return 1.7 if token.isupper() or token == "m" else 1.1


OPERATORS = {"=": "=", ">": ">", "<": "<", ">=": r"\ge", "<=": r"\le", "in": r"\in"}


def lines(statement: Relation, decimals: bool = False, left_width: float | None = None) -> list[str]:
    """Return a statement as the rows of an align environment: `left &= right`, broken before + and - where needed.

    `left_width` is the width of the column left of the relation sign, if other statements share it.
    """
    left = latex(statement.left, decimals)
    taken = width(left) if left_width is None else left_width
    rows = _broken(statement.right, decimals, max(LINE_WIDTH - taken - 4.0, 0.3 * LINE_WIDTH))
    return [f"{left} &{OPERATORS[statement.op]} {rows[0]}", *(rf"&\quad {row}" for row in rows[1:])]


def _broken(expr: Expr, decimals: bool, room: float) -> list[str]:
    """Break a sum into rows before its terms; a product with a long sum is broken inside its parentheses."""
    whole = latex(expr, decimals)
    if not isinstance(expr, sp.Expr):
        return [whole]
    if width(whole) <= room:
        return [whole]
    pieces: list[str] = []
    for term in terms(expr):
        pieces += _pieces(term, decimals, room, first=not pieces)
    rows: list[str] = []
    for piece in pieces:
        if rows and width(f"{rows[-1]} {piece}") <= room:
            rows[-1] = f"{rows[-1]} {piece}"
        else:
            rows.append(piece)
    return rows


def _pieces(term: Expr, decimals: bool, room: float, first: bool) -> list[str]:
    text = _signed(latex(term, decimals), first)
    if width(text) <= room:
        return [text]
    sums = [factor for factor in sp.Mul.make_args(term) if factor.is_Add]
    if not sums:
        return [text]
    longest = max(sums, key=lambda factor: width(latex(factor, decimals)))
    rest = latex(term / longest, decimals)
    rest = {"1": "", "- 1": "- "}.get(rest, rest)
    inner: list[str] = []
    for part in terms(longest):
        inner += _pieces(part, decimals, room, first=not inner)
    head = _signed(rest, first) if rest else ("" if first else "+ ")
    tall = any(r"\frac" in part for part in inner)
    opening, closing = (r"\biggl(", r"\biggr)") if tall else (r"\bigl(", r"\bigr)")
    if width(f"{head} {inner[0]}") > room:  # the opening parenthesis ends its row
        return [f"{head} {opening}", *inner[:-1], f"{inner[-1]} {closing}"]
    return [f"{head} {opening} {inner[0]}", *inner[1:-1], f"{inner[-1]} {closing}"]


def _signed(text: str, first: bool) -> str:
    return text if first or text.startswith("-") else f"+ {text}"
