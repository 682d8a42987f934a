"""Notation: every symbol of the document is in the table, and an undefined one is found."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from symosc.derive import notation
from symosc.derive.chapters import CHAPTERS

CHAPTER_FILES = Path(__file__).parents[2] / "derivations" / "chapters"
DISPLAY = re.compile(r"\\begin\{align\}(.*?)\\end\{align\}", re.DOTALL)


def formulas(text: str) -> Iterator[str]:
    """Yield the mathematics of a chapter: its displays, and what stands between dollars."""
    yield from DISPLAY.findall(text)
    yield from re.findall(r"\$(.*?)\$", DISPLAY.sub(" ", text), re.DOTALL)
    for display in DISPLAY.findall(text):
        yield from re.findall(r"\$(.*?)\$", display)


@pytest.mark.quick(2)
@pytest.mark.parametrize("key", CHAPTERS)
def test_no_symbol_is_undefined(key: str) -> None:
    text = (CHAPTER_FILES / f"{key}.tex").read_text(encoding="utf-8")
    undefined = {s for math in formulas(text) for s in notation.symbols(math) if not notation.defined(s)}
    assert not undefined


@pytest.mark.parametrize(
    "symbol", [r"\xi", r"Q_7", r"\dot{z}_9", r"F^{(4)}", r"H^{(\alpha)}", r"\Theta_k", r"\omega_9"]
)
def test_an_undefined_symbol_is_found(symbol: str) -> None:
    math = rf"x_i + \frac{{{symbol}}}{{m}} \cos \theta"
    assert {s for s in notation.symbols(math) if not notation.defined(s)} == set(notation.symbols(symbol))


def test_every_row_is_used() -> None:
    text = "".join((CHAPTER_FILES / f"{key}.tex").read_text(encoding="utf-8") for key in CHAPTERS)
    used = {s for math in formulas(text) for s in notation.symbols(math)}
    for entry in notation.NOTATION:
        listed = {s for math in re.findall(r"\$(.*?)\$", entry.shown) for s in notation.symbols(math)}
        family = {s for s in used if entry.family and re.fullmatch(entry.family, s)}
        assert family or listed & used, entry.shown


def test_references_of_the_table_exist() -> None:
    text = "".join((CHAPTER_FILES / f"{key}.tex").read_text(encoding="utf-8") for key in CHAPTERS)
    labels = set(re.findall(r"\\label\{([^{}]*)\}", text))
    for entry in notation.NOTATION:
        assert set(re.findall(r"ref\{([^{}]*)\}", entry.where)) <= labels, entry.where
