"""Numbers, points, words and tables as LaTeX, without sympy."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

# Digits of a float in print; an mpmath number has those that its digits= asked for.
FLOAT_DIGITS = 10


def number(value: Any) -> str:
    """Return a number as LaTeX: a decimal, with a power of ten where it is very large or small."""
    text = f"{value:.{FLOAT_DIGITS}g}" if isinstance(value, float) else str(value)
    mantissa, _, exponent = text.partition("e")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else mantissa


def point(letter: str, theta: Any, x: Any) -> str:
    """Return (Omega t, x) = (theta, x) with a letter as index."""
    return rf"(\Omega t_{letter}, x_{letter}) = ({number(theta)}, {number(x)})"


def words(text: str | None) -> str:
    """Return words inside a formula, with the signs escaped that LaTeX takes for commands."""
    escaped = re.sub(r"([_^%&#$])", r"\\\1", text or "")
    return rf"\text{{{escaped}}}"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return an array with a line below its heads."""
    lines = [" & ".join(heads) + r" \\ \hline", *(" & ".join(row) + r" \\" for row in rows)]
    return "\n".join([rf"\begin{{array}}{{{'l' * len(heads)}}}", *lines, r"\end{array}"])
