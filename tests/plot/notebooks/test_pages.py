"""Pages of all answers: well-formed, short, quick, without matplotlib; and in a real browser."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from shutil import which
from xml.etree import ElementTree

import pytest
from answers import MAKERS, PROVEN, answer

from symosc.certificates.certificate import Certificate

KINDS = sorted(MAKERS)
#: Nothing wider than the window, and each picture has a size and words.
LOOK = """() => {
  const bad = [];
  if (document.scrollingElement.scrollWidth > innerWidth) bad.push(`page is ${document.scrollingElement.scrollWidth}`);
  for (const each of document.querySelectorAll('svg')) {
    const box = each.getBoundingClientRect(), inside = each.querySelector('path, g').getBoundingClientRect();
    if (box.width < 100 || box.height < 100 || !each.querySelector('title').textContent) bad.push(each.outerHTML);
    if (inside.left < box.left - 1 || inside.right > box.right + 1 || inside.bottom > box.bottom + 1)
      bad.push(`outside of ${each.outerHTML.slice(0, 99)}`);
  }
  return bad;
}"""


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_well_formed_and_short(kind: str) -> None:
    page = answer(kind)._repr_html_()
    root = ElementTree.fromstring(page)
    assert root.attrib["class"] == "symosc"
    assert root.find(".//strong").text == type(answer(kind)).__name__  # type: ignore[union-attr]
    assert len(page) < 40_000
    assert len(root.findall(".//tbody/tr")) < 30
    assert not {"nan", "None"} & set("".join(root.itertext()).split())


def test_what_is_put_in_is_escaped() -> None:
    hostile = '<script>alert("&amp;")</script>'
    proof = Certificate(hostile, True, hostile, ((hostile, hostile, hostile),), statement={"made_by": hostile})
    root = ElementTree.fromstring(proof._repr_html_() or "")
    assert root.findall(".//script") == []
    texts = "".join(root.itertext())
    assert texts.count(hostile) == 6


def test_completion_shows_what_is_for_users() -> None:
    for kind in KINDS:
        names = dir(answer(kind))
        assert "plot" in names, kind
        assert [name for name in names if name.startswith("_")] == []
        assert all(hasattr(answer(kind), name) for name in names), kind
    import symosc
    from symosc import plot

    assert dir(plot) == plot.__all__
    assert [name for name in dir(symosc) if name.startswith("_") and not name.startswith("__")] == []


@pytest.mark.slow
def test_no_page_loads_what_draws() -> None:
    code = (
        "import sys; from symosc import simulate, grazing_window, load_scene;"
        "pages = [simulate('fig5', t_end=3), grazing_window(load_scene('fig9').parameters, 'P2')];"
        "[page._repr_html_() for page in pages]; print({'matplotlib', 'sympy', 'numba'} & set(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout == "set()\n"


@pytest.mark.slow
@pytest.mark.parametrize("width", [400, 1100])
def test_pages_in_a_browser(width: int, tmp_path: Path) -> None:
    sync_api = pytest.importorskip("playwright.sync_api")
    program = which("chromium") or which("google-chrome")
    if program is None:
        pytest.skip("no browser is installed")
    pages = "<hr>".join(answer(kind)._repr_html_() for kind in KINDS)
    file = tmp_path / "pages.html"
    file.write_text(f"<!doctype html><meta charset=utf-8><body>{pages}", encoding="utf-8")
    complaints: list[str] = []
    with sync_api.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": width, "height": 800})
        page.on("console", lambda message: complaints.append(message.text))
        page.goto(file.as_uri())
        complaints += page.evaluate(LOOK)
        browser.close()
    assert complaints == []


def test_a_proof_shows_the_digits_that_are_proven() -> None:
    texts = [cell.text for cell in ElementTree.fromstring(PROVEN._repr_html_() or "").iter("td")]
    assert texts[3:7] == ["1.5826058214", "7.913029107", "2e-11", "1e-11"]
    assert texts[7] == "-0.017"
    assert texts[8] == "0.25 - 0.5 i"
