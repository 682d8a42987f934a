"""Numbers, texts and tables as LaTeX, and the base class of answers that notebooks show as formulas."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from symosc.base.errors import brief


def latex_number(value: Any) -> str:
    """Return a number as LaTeX: a decimal, with a power of ten where it is very large or small."""
    # Digits of a float in print; an mpmath number has those that its digits= asked for.
    if isinstance(value, float):
        text = f"{value:.10g}"
    else:
        text = str(value)
    mantissa, _, exponent = text.partition("e")
    if exponent:
        return rf"{mantissa} \cdot 10^{{{int(exponent)}}}"
    return mantissa


def latex_point(letter: str, theta: Any, x: Any) -> str:
    """Return the equation (Omega t, x)_letter = (theta, x) as LaTeX."""
    return rf"(\Omega t_{letter}, x_{letter}) = ({latex_number(theta)}, {latex_number(x)})"


#: What of a text LaTeX reads as something else than the letter that it is: commands, and signs
#: that it joins.
_NO_PLAIN_LETTER = re.compile(r"[^A-Za-z0-9 .,:;!?()\[\]/+*=@\-À-ÖØ-öø-ÿ]|-(?=-)|,(?=,)")


def latex_text(text: str) -> str:
    r"""Return a text of a user's, such as the name of a scene, for LaTeX to set letter by letter.

    It is set in ``\texttt``. The document needs a command ``\letter``: what has no place in fonts
    of LaTeX is printed by its number.
    """

    def plain(sign: re.Match[str]) -> str:
        number = ord(sign[0])
        if number < 128:
            return rf"\symbol{{{number}}}"
        escape = sign[0].encode("ascii", "backslashreplace").decode("ascii").removeprefix("\\")
        return rf"\letter{{{number}}}{{{escape}}}"

    return _NO_PLAIN_LETTER.sub(plain, brief(text).replace("…", "..."))


def latex_words(text: str | None) -> str:
    """Return a text of symosc's own for a LaTeX formula, with special characters escaped."""
    return r"\text{" + re.sub(r"([_%&#${}])", r"\\\1", text or "").replace("^", r"\^{}") + "}"


def latex_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a LaTeX array with a line below its column heads."""
    lines = [" & ".join(heads) + r" \\ \hline", *(" & ".join(row) + r" \\" for row in rows)]
    return "\n".join([rf"\begin{{array}}{{{'l' * len(heads)}}}", *lines, r"\end{array}"])


class LatexAnswer:
    """Base class of results that notebooks show as a formula.

    Each class writes its own in the method `latex`.
    """

    __slots__ = ()

    def latex(self) -> str:
        """Return the result as LaTeX (no dollar signs)."""
        raise NotImplementedError

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"
