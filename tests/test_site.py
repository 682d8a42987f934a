"""The documentation site.

Each task takes ten lines, each public name has a place, and no page is broken.

The site is built once, as `nox -s docs` does it; a warning is an error, and so is a page whose code
fails.
"""

from __future__ import annotations

import inspect
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from browsing import chromium
from once import alone
from printed import PRINTED, assert_as_printed

import symosc

DOCS = Path(__file__).parents[1] / "docs"
BLOCK = re.compile(
    r"^```\{(?:code-cell\} python|console\})\n((?::[^\n]*\n)*)(.*?)^```$", re.MULTILINE | re.DOTALL
)
#: What is wrong with a page as the browser shows it; links are looked at without a browser.
LOOK = """() => {
  const complaints = [], page = document.scrollingElement;
  if (page.scrollWidth > innerWidth) complaints.push(`the page is ${page.scrollWidth} wide`);
  for (const image of document.images) if (!image.naturalWidth) complaints.push(`no image ${image.src}`);
  for (const each of document.querySelectorAll('article p, article li, article h1, article h2, article dt')) {
    const box = each.getBoundingClientRect(), scroller = each.closest('table, pre, .formula, .cell_output');
    if (!scroller && box.right > innerWidth + 1) complaints.push(`beyond the edge: ${each.textContent.slice(0, 40)}`);
  }
  return complaints;
}"""


def tasks() -> dict[str, str]:
    """Return the tasks of `tasks.md`, and the page that does each."""
    first_table = (DOCS / "tasks.md").read_text(encoding="utf-8").split("## ")[0]
    return dict(
        re.findall(r"^\| (?!I want)([^|]+) \| \[.*?\]\((\S+?)\) \|$", first_table, re.MULTILINE)
    )


@pytest.mark.parametrize("page", tasks().values(), ids=str)
def test_a_task_takes_ten_lines_at_most(page: str) -> None:
    """The first block of its page does it; the build runs it first in a fresh process."""
    found = BLOCK.search((DOCS / page).read_text(encoding="utf-8"))
    assert found
    assert "remove-input" not in found[1]
    lines = [line for line in found[2].splitlines() if line.strip()]
    assert 1 <= len(lines) <= 10
    assert max(map(len, lines)) <= 88


def test_every_public_name_has_a_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    import api

    pages = "".join(
        path.read_text(encoding="utf-8") for path in (DOCS / "reference" / "api").glob("*.md")
    )
    assert sorted(re.findall(r"\{\{ (\w+) \}\}", pages)) == sorted(api.pages())
    entries = "\n".join(api.pages().values())
    for name in set(symosc.__all__) - {"plot", "__version__"}:
        assert len(re.findall(rf"^\.\. auto\w+:: symosc\.{name}$", entries, re.MULTILINE)) == 1, (
            name
        )


#: A line of a docstring's section that begins an entry: names, and mostly a type.
ENTRY = re.compile(r"\*{0,2}\w+(, \*{0,2}\w+)*( :.*)?")
SECTION = re.compile(r"^(?:Parameters|Attributes)\n-+\n(.*?)(?=^\S[^\n]*\n-{3,}$|\Z)", re.M | re.S)


def test_sections_of_docstrings_have_entries_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """What stands behind the entries would be shown as one more of them, in bold."""
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    import api

    found = []
    for name, subject in api.public().items():
        parts = [subject, *(vars(subject).values() if isinstance(subject, type) else ())]
        for part in parts:
            for section in SECTION.findall(inspect.getdoc(part) or ""):
                lines = [line for line in section.splitlines() if line and line[0] != " "]
                found += [f"{name}: {line}" for line in lines if not ENTRY.fullmatch(line)]
    assert found == []


@pytest.fixture(scope="module")
def site() -> Path:
    """Return the folder of the site, which one worker builds.

    SYMOSC_SITE names the folder; a site that is there was just built.
    """
    pytest.importorskip("sphinx_design", reason="the extra docs is not installed")
    with alone("site") as shared:
        folder = Path(os.environ.get("SYMOSC_SITE", shared))
        if not folder.exists():
            built = Path(f"{folder}-built")
            build = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2"]
            command = [*build, "-d", f"{folder}-trees", str(DOCS), str(built)]
            result = subprocess.run(command, capture_output=True, text=True, check=False)
            assert result.returncode == 0, result.stderr[-5000:]
            built.rename(folder)
    return folder


class Page(HTMLParser):
    """The ids of a page, and what it refers to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        if found.get("id"):
            self.ids += [found["id"]]
        else:
            self.ids += []
        for name in ("href", "src"):
            if name in found:
                self.links += [found[name] or ""]
            else:
                self.links += []


def pages_of(site: Path) -> dict[Path, Page]:
    return {
        path.resolve(): Page(path)
        for path in sorted(site.rglob("*.html"))
        if "_static" not in path.parts
    }


def dangling(pages: dict[Path, Page]) -> Iterator[str]:
    """Find links to files and anchors that are not there."""
    for path, page in pages.items():
        for link in page.links:
            target = urlsplit(link)
            if target.scheme or link in ("", "#"):
                continue
            if target.path:
                file = (path.parent / unquote(target.path)).resolve()
            else:
                file = path
            if not file.is_file():
                yield f"{path.name}: {link} is not there"
            elif (
                target.fragment
                and file in pages
                and unquote(target.fragment) not in pages[file].ids
            ):
                yield f"{path.name}: {link} is no anchor"


@pytest.mark.slow
def test_internal_links_and_anchors(site: Path) -> None:
    pages = pages_of(site)
    assert len(pages) > 45
    assert list(dangling(pages)) == []


@pytest.mark.slow
def test_each_figure_says_what_it_shows(site: Path) -> None:
    """For readers who do not see it; without a text of its own a figure is called by its file.

    Figures that cells draw have it from `:mystnb: {image: {alt: "..."}}` below the cell's first line.
    """
    figures = 0
    for path in pages_of(site):
        for figure in re.findall(r"<img[^>]*>", path.read_text(encoding="utf-8")):
            figures += 1
            text = re.search(r'alt="([^"]*)"', figure)
            assert text, (path.name, figure[:100])
            assert len(text[1].split()) >= 4, (path.name, figure[:100])
            assert not text[1].endswith((".svg", ".png")), (path.name, text[1])
    assert figures > 60


@pytest.mark.slow
def test_nothing_is_loaded_from_elsewhere(site: Path) -> None:
    """The site can be read without a network.

    Its scripts, styles, fonts and pictures are its own.
    """
    for path in site.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert not re.findall(r"<(?:script|img|link)[^>]+(?:src|href)=\"https?:[^\"]*", text), path


@pytest.mark.slow
def test_scripts_of_the_literature_print_what_the_sources_have(site: Path) -> None:
    page = (site / "literature.html").read_text(encoding="utf-8")
    blocks = re.findall(r"<pre>(.*?)</pre>", page, re.DOTALL)
    texts = [unescape(re.sub(r"<[^>]+>", "", block)) for block in blocks]
    runs = [re.fullmatch(r"\$ python (\w+)\.py\n(.*)", text, re.DOTALL) for text in texts]
    shown = {run[1]: run[2] for run in runs if run}
    assert {name for name, _, _ in PRINTED} | {"hong_liu"} <= set(shown)
    for name, output in shown.items():
        assert_as_printed(name, output)


def look_at(browser: Any, paths: list[Path], width: int) -> list[str]:
    """Open pages one after the other, and return what is wrong with them."""
    page = browser.new_page(viewport={"width": width, "height": 800})
    complaints: list[str] = []
    page.on(
        "console",
        lambda message: complaints.append(message.text) if message.type == "error" else None,
    )
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("requestfailed", lambda request: complaints.append(f"not loaded: {request.url[:80]}"))
    found = []
    for path in paths:
        complaints.clear()
        page.goto(path.as_uri(), wait_until="load")
        found += [f"{path.name}: {each}" for each in [*complaints, *page.evaluate(LOOK)]]
    page.close()
    return found


@pytest.mark.slow
def test_all_pages_on_a_phone(site: Path) -> None:
    with chromium() as browser:
        assert look_at(browser, list(pages_of(site)), 360) == []


@pytest.mark.slow
def test_a_bad_page_is_noticed(tmp_path: Path) -> None:
    bad = tmp_path / "bad.html"
    bad.write_text(
        '<!DOCTYPE html><article><p style="width: 500px">wide</p><img src="none.png">'
        '<a href="gone.html">a</a><a href="#gone">b</a><a href="#">c</a></article><script>throw Error("oh")</script>'
    )
    assert len(list(dangling(pages_of(tmp_path)))) == 3
    with chromium() as browser:
        complaints = "\n".join(look_at(browser, [bad], 360))
    for word in ("the page is 5", "no image", "beyond the edge: wide", "not loaded", "oh"):
        assert word in complaints, word
