"""The page on a cross-check: whole, self-contained, and about the right things."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import OutputError, load_scene, simulate
from symosc.crosschecks.report import CrossCheck

T = np.linspace(0, 12, 120)


def wrong() -> CrossCheck:
    p = load_scene("fig5").parameters
    return crosscheck(p, T, *simulate(p.replace(B0=9), t0=0, x0=0, v0=0, t_end=12)(T))


class Reader(HTMLParser):
    """Says which tags are open, and what the page refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sources: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "img"):
            self.open.append(tag)
        self.sources += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.slow
def test_the_page_is_whole_and_needs_nothing_else(tmp_path: Path) -> None:
    check = wrong()
    text = check.to_html(tmp_path / "check.html").read_text(encoding="utf-8")
    reader = Reader()
    reader.feed(text)
    assert reader.open == []
    assert len(reader.sources) == 4
    assert all(source.startswith("data:image/svg+xml;base64,") for source in reader.sources)
    assert "width=device-width" in text
    said = re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", text))
    for words in ("Not right", check.diagnosis[0].words, "Explains", "First wrong step", "invented", "The system"):
        assert words in said
    for event in check.missed:
        assert f"{float(event.t):.10g}" in said


@pytest.mark.slow
def test_long_tables_are_folded(tmp_path: Path) -> None:
    """A reader sees the first wrong steps; the rest, a page of 15,000 pixels, is one click away."""
    check = wrong()
    assert len(check.wrong_steps) > 40
    text = check.to_html(tmp_path / "check.html").read_text(encoding="utf-8")
    unfolded = re.sub(r"<details>.*?</details>", "", text, flags=re.DOTALL)
    assert 4 <= unfolded.count('<td class="words">') <= 10
    assert text.count('<td class="words">') == len(check.wrong_steps)
    hidden = len(check.wrong_steps) - unfolded.count('<td class="words">')
    assert f"<summary>{hidden} more</summary>" in text


@pytest.mark.slow
def test_the_page_of_a_right_solution(tmp_path: Path) -> None:
    check = crosscheck("fig5", T, *simulate("fig5", t_end=12)(T))
    text = check.to_html(tmp_path / "check.html").read_text(encoding="utf-8")
    assert "Right: every step agrees" in text
    assert "Diagnosis" not in text
    assert "First wrong step" not in text
    with pytest.raises(OutputError):
        check.to_html(tmp_path / "nowhere" / "check.html")
    assert not (tmp_path / "nowhere").exists()
