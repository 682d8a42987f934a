"""Pages in other formats than LaTeX: HTML without a rest of LaTeX, text with words apart."""

from __future__ import annotations

import re
import shutil
from functools import cache
from io import BytesIO
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import chromium
from chapters import unchecked_items
from matplotlib import get_data_path
from matplotlib.image import imread
from samples import few

from symosc.derive import blocks, document
from symosc.derive.chapters import CHAPTERS
from symosc.derive.document import Checked, Part
from symosc.derive.html import STYLE
from symosc.derive.mathml import font_style, formula
from symosc.derive.scope import Scope
from symosc.derive.steps import StepEvidence

#: Some of these take a second to build, one that runs motions ten.
KEYS = few(CHAPTERS, "motion", "domains", "grazing", "events", "orbits", "errata", "literature")


@cache
def unchecked(key: str) -> Checked:
    """Return a chapter with evidence that is made up: only what is printed counts here."""
    title, items = unchecked_items(key)
    evidence = StepEvidence("exact", "0")
    return Checked(key, title, [Part(item, tuple(evidence for _ in blocks.steps_of(item))) for item in items])


@pytest.mark.quick(2)
@pytest.mark.parametrize("key", KEYS)
def test_html_has_no_rest_of_latex(key: str) -> None:
    html = document.as_html(unchecked(key), Scope())
    shown = re.sub(r"<[^>]*>", "", html)
    assert not re.findall(r"\\[a-zA-Z]|\$|align\b", shown)
    latex = document.as_latex(unchecked(key), Scope())
    assert html.count('id="step-') == latex.count(r"\markit{")
    assert html.count("<h2>") == latex.count(r"\subsection{")
    assert html.count('class="statement"') == len(
        re.findall(r"\\begin\{(?:theorem|lemma|definition|corollary|pr|r|e)", latex)
    ) - (latex.count(r"\begin{proof}") + latex.count(r"\begin{enumerate}"))
    assert html.count("<div") == html.count("</div>")
    targets = set(re.findall(r'href="#([^"]*)"', html))
    assert targets <= set(re.findall(r'id="([^"]*)"', html))


@pytest.mark.slow
def test_the_page_needs_no_other_file() -> None:
    html = document.as_page([unchecked(key) for key in CHAPTERS], Scope())
    assert html.startswith("<!DOCTYPE html>")
    assert not re.findall(r'(?:src|href)="(?!data:|#)', html)
    ids = re.findall(r' id="([^"]*)"', html)
    assert len(ids) == len(set(ids))
    assert html.count("<figure") == 4


@pytest.mark.parametrize("key", KEYS)
def test_text_is_readable(key: str) -> None:
    text = document.as_text(unchecked(key), Scope())
    assert not re.findall(r"\\|\$|costheta|sintheta|\)Omega|\{\{|eqref|emph", text)
    assert not re.findall(r"\b(?:cos|sin)(?:theta|tau|omega|Omega)", text)


@pytest.mark.parametrize("key", KEYS)
def test_markdown_is_complete(key: str) -> None:
    text = document.as_markdown(unchecked(key), Scope())
    assert text.startswith(f"# {list(CHAPTERS).index(key) + 1}. ")
    assert not re.findall(r"\\(?:eqref|ref|cite|emph|textbf|texttt|label|begin\{(?!aligned)(?!enumerate))", text)


@pytest.mark.slow
def test_formulas_are_read_where_no_font_for_them_is_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One dot over the letter of a velocity, two over that of an acceleration, at the size of text."""
    for name in ("DejaVuSans.ttf", "DejaVuSerif.ttf"):
        shutil.copy(Path(get_data_path()) / "fonts" / "ttf" / name, tmp_path)
    config = f"<fontconfig><dir>{tmp_path}</dir><cachedir>{tmp_path}</cachedir></fontconfig>"
    (tmp_path / "fonts.conf").write_text(f'<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd">{config}')
    monkeypatch.setenv("FONTCONFIG_FILE", str(tmp_path / "fonts.conf"))

    def dots(page: Any, latex: str) -> int:
        page.set_content(f"<style>{STYLE}{font_style()}</style><p>{formula(latex)}</p>")
        page.evaluate("document.fonts.ready")
        dark = imread(BytesIO(page.locator("math").screenshot()))[..., 0] < 0.5
        above = takewhile(np.any, dark[dark.any(axis=1).argmax() :])  # the letter begins after an empty row
        return max(int(np.diff(row, prepend=False, append=False).sum()) // 2 for row in above)

    with chromium() as browser:
        page = browser.new_page()
        assert [dots(page, latex) for latex in (r"\dot{x}", r"\ddot{x}")] == [1, 2]
