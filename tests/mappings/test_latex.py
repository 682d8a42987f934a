"""What is printed as LaTeX: numbers, words with the signs that are commands, tables."""

from __future__ import annotations

import re

import mpmath
import pytest

from symosc.mappings import latex


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.5, "0.5"), (-2.0, "-2"), (1 / 3, "0.3333333333"), (1.5e-7, r"1.5 \cdot 10^{-7}"),
        (-2e20, r"-2 \cdot 10^{20}"),
        (7, "7"), (mpmath.mpf("1.25"), "1.25"), ("1.0e-12", r"1.0 \cdot 10^{-12}"),
    ],
)  # fmt: skip
def test_numbers_have_powers_of_ten_and_no_e(value: object, text: str) -> None:
    assert latex.number(value) == text


def test_words_are_text_and_their_signs_no_commands() -> None:
    for words in ("the belt moves away", "a_b ^2, 5 % & #1 $x", "", None):
        inner = re.fullmatch(r"\\text\{(.*)\}", latex.words(words))
        assert inner is not None
        assert re.search(r"(?<!\\)[_^%&#$]", inner[1]) is None
        assert inner[1].replace("\\", "") == (words or "")


def test_a_point_and_a_table() -> None:
    assert latex.point("m", 0.5, -1e-9) == r"(\Omega t_m, x_m) = (0.5, -1 \cdot 10^{-9})"
    begin, heads, *rows, end = latex.table(["a", "b", "c"], [["1", "2", "3"], ["4", "5", "6"]]).split("\n")
    assert (begin, end) == (r"\begin{array}{lll}", r"\end{array}")
    assert heads == r"a & b & c \\ \hline"
    assert rows == [r"1 & 2 & 3 \\", r"4 & 5 & 6 \\"]
