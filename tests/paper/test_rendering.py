"""Templates filled in: each kind of text keeps its meaning, and nothing is left out in silence."""

from __future__ import annotations

import random
import re

import pytest
from jinja2 import FunctionLoader, UndefinedError

from symosc.paper import rendering

SAMPLES = 200
SIGNS = "\\`*_|[]~<>&\"' ab"


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Return templates by name, which stand for those of the package; a test adds its own."""
    templates: dict[str, str] = {}
    monkeypatch.setattr(rendering, "PackageLoader", lambda package: FunctionLoader(templates.get))
    return templates


def random_text(rng: random.Random) -> str:
    return "w" + "".join(rng.choice(SIGNS) for _ in range(rng.randrange(30)))


def test_html_shows_a_text_as_it_is(written: dict[str, str]) -> None:
    """Characters that mean something in HTML are escaped once, in a template's own text and in formulas."""
    written |= {"a.html.j2": "<b>{{ text }}</b>", "b.html.j2": "{{ text | typeset }}", "a.txt.j2": "<b>{{ text }}</b>"}
    rng = random.Random(1)
    for _ in range(SAMPLES):
        text = random_text(rng)
        escaped = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
        quoted = escaped.replace('"', "&#34;").replace("'", "&#39;")
        assert rendering.render("a.html.j2", {"text": text}) == f"<b>{quoted}</b>"
        assert rendering.render("a.txt.j2", {"text": text}) == f"<b>{text}</b>"
    assert rendering.render("b.html.j2", {"text": "x0 < 1 & v1"}) == "x<sub>0</sub> &lt; 1 &amp; v<sub>1</sub>"


def test_markdown_shows_a_text_as_it_is(written: dict[str, str]) -> None:
    """Each character that means something in Markdown has one backslash, so a table keeps its cells."""
    written["a.md.j2"] = "{{ text | md }}"
    rng = random.Random(2)
    for _ in range(SAMPLES):
        text = random_text(rng).replace("<", "").replace(">", "").replace("&", "").replace("_", "")  # typeset has these
        found = rendering.render("a.md.j2", {"text": text}).replace("\u2060", "")  # typeset keeps |x| in one line by it
        assert not re.search(r"[`*_|\[\]~]", re.sub(r"\\.", "", found))
        assert re.sub(r"\\(.)", r"\1", found) == " ".join(text.split())
    assert rendering.render("a.md.j2", {"text": "one\n  |two"}) == r"one \|two"


def test_lines_of_a_mail_are_short_indented_and_complete(written: dict[str, str]) -> None:
    written["a.txt.j2"] = "{{ text | wrapped }}\n--\n{{ text | wrapped(0) }}\n"
    rng = random.Random(3)
    for _ in range(SAMPLES // 4):
        text = " ".join("w" * rng.randint(1, 12) for _ in range(rng.randint(1, 80)))
        parts = rendering.render("a.txt.j2", {"text": text}).removesuffix("\n").split("\n--\n")
        for part, indent in zip(parts, (4, 0), strict=True):
            lines = part.split("\n")
            assert " ".join(line[indent:] for line in lines) == text
            for line, following in zip(lines, [*lines[1:], None], strict=True):
                assert line[:indent] == " " * indent
                assert line[indent] != " "
                assert len(line) <= 78
                if following is not None:  # no shorter than it has to be
                    assert len(line) + 1 + len(following.split()[0]) > 78


def test_a_name_that_is_missing_is_an_error(written: dict[str, str]) -> None:
    written["a.txt.j2"] = "{{ there }}{{ missing }}"
    with pytest.raises(UndefinedError, match="missing"):
        rendering.render("a.txt.j2", {"there": "x"})


def test_blocks_leave_no_lines(written: dict[str, str]) -> None:
    written["a.txt.j2"] = "one\n  {% for each in texts %}\n{{ each }}\n  {% endfor %}\n"
    assert rendering.render("a.txt.j2", {"texts": ["two", "three"]}) == "one\ntwo\nthree\n"
    written["b.txt.j2"] = "one\n\n{# a remark #}\n{{ texts[0] }}\n"
    assert rendering.render("b.txt.j2", {"texts": ["two"]}) == "one\n\ntwo\n"
