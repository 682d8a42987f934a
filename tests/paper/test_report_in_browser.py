"""The whole of `symosc reproduce`, and its report in a real browser.

Nothing missing, clipped or illegible.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from browsing import chromium

from symosc.derive.errata import read_errata
from symosc.paper.claims import CONFIRMED, CORRECTED, NOT_AS_PRINTED, read_claims
from symosc.paper.pictures import PICTURES
from symosc.paper.report import BADGES

#: What a page must not have; returns complaints. Boxes that scroll must show that they do, by their
#: shadows.
LOOK = """BESIDE => {
  const complaints = [], tell = (what, element) => complaints.push(
    `${what}: <${element.tagName} class="${element.className}"> ${element.textContent.trim().slice(0, 60)}`);
  document.querySelectorAll('details').forEach(each => each.open = true);
  const page = document.scrollingElement;
  if (page.scrollWidth > innerWidth) tell(`page is ${page.scrollWidth} wide, window ${innerWidth}`, page);
  for (const image of document.images) {
    const box = image.getBoundingClientRect();
    if (!image.naturalWidth || box.width < 100 || box.height < 50 || !image.checkVisibility()) tell('no image', image);
    if (!image.alt) tell('no alternative text', image);
    // The smallest letters of pictures have 8 of their points, each 4/3 of a pixel in the natural size.
    const letters = 8 * 4 / 3 * box.width / image.naturalWidth;
    if (letters < 10) tell(`picture with letters of ${letters.toFixed(1)}px`, image);
  }
  for (const link of document.querySelectorAll('a')) {
    const target = link.getAttribute('href');
    if (target.startsWith('#') ? !document.getElementById(target.slice(1)) : !BESIDE.includes(target))
      tell(`dangling link ${target}`, link);
  }
  const ids = [...document.querySelectorAll('[id]')].map(each => each.id);
  ids.filter((id, at) => ids.indexOf(id) !== at).forEach(id => complaints.push(`id twice: ${id}`));
  const brightness = color => {
    const linear = x => x <= .04045 ? x / 12.92 : ((x + .055) / 1.055) ** 2.4;
    const [r, g, b] = color.slice(0, 3).map(x => linear(x / 255));
    return .2126 * r + .7152 * g + .0722 * b;
  };
  const numbers = color => color.match(/[\\d.]+/g).map(Number);
  for (const element of document.body.querySelectorAll('*')) {
    const style = getComputedStyle(element), box = element.getBoundingClientRect();
    if (!element.checkVisibility()) continue;
    const clips = ['hidden', 'clip'].some(way => style.overflowX === way || style.overflowY === way);
    if (clips && (element.scrollWidth > element.clientWidth + 1 || element.scrollHeight > element.clientHeight + 1))
      tell('clipped', element);
    const scrolls = ['auto', 'scroll'].includes(style.overflowX) && element.scrollWidth > element.clientWidth + 1;
    if (scrolls && !style.backgroundAttachment.includes('local')) tell('scrolls without a sign of it', element);
    if (![...element.childNodes].some(node => node.nodeType === 3 && node.textContent.trim())) continue;
    const scroller = element.closest('.wide');
    if (box.width < 1) tell('text without room', element);
    if (!scroller && (box.right > innerWidth + 1 || box.left < -1)) tell('text outside of the window', element);
    let ground = element;
    while (ground && numbers(getComputedStyle(ground).backgroundColor)[3] === 0) ground = ground.parentElement;
    const [light, dark] = [style.color, ground ? getComputedStyle(ground).backgroundColor : 'rgb(255, 255, 255)']
      .map(color => brightness(numbers(color))).sort((one, other) => other - one);
    if ((light + .05) / (dark + .05) < 4.5) tell(`contrast ${((light + .05) / (dark + .05)).toFixed(2)}`, element);
    if (parseFloat(style.fontSize) < 8) tell(`letters of ${style.fontSize}`, element);
  }
  return complaints;
}"""


pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as browser:
        yield browser


def look_at(browser: Any, path: Path, width: int, scheme: str) -> list[str]:
    page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
    complaints: list[str] = []
    page.on(
        "console",
        lambda message: complaints.append(message.text) if message.type == "error" else None,
    )
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("requestfailed", lambda request: complaints.append(f"not loaded: {request.url[:80]}"))
    page.on(
        "request",
        lambda request: complaints.append(request.url) if request.url.startswith("http") else None,
    )
    page.goto(path.as_uri(), wait_until="load")
    complaints += page.evaluate(LOOK, sorted(file.name for file in path.parent.iterdir()))
    page.close()
    return complaints


def test_the_whole_run_agrees_with_the_committed_verdicts(report: Path) -> None:
    content = json.loads((report / "report.json").read_text(encoding="utf-8"))
    assert content["ok"] is True
    claims, _ = read_claims(PICTURES)
    assert [each["id"] for each in content["claims"]] == [claim.id for claim in claims]
    assert [each["verdict"] for each in content["claims"]] == [claim.verdict for claim in claims]
    for claim, each in zip(claims, content["claims"], strict=True):
        # No claim about a motion is judged by the simulator alone.
        assert (
            not claim.id.startswith("fig")
            or "flown again in another closed form" in each["numbers"]
        )
        assert any(
            character.isdigit() for value in each["numbers"].values() for character in value
        ), claim.id
        assert bool(claim.correction) == (each["verdict"] in (CORRECTED, NOT_AS_PRINTED)), claim.id
    assert [each["key"] for each in content["figures"]] == list(PICTURES)
    html = (report / "report.html").read_text(encoding="utf-8")
    for claim in claims:
        assert f'id="claim-{claim.id}">' in html
    assert len(html) < 8e6
    numbers = [str(erratum.number) for erratum in read_errata()]  # in the order of the page
    assert re.findall(r'id="erratum-[^"]*"><b>(\d+)\.', html) == numbers


# a fault of a colour scheme is there at every width, a fault of a width in both schemes
@pytest.mark.parametrize(
    ("width", "scheme"),
    [
        (360, "dark"),
        (1280, "light"),
        pytest.param(360, "light", marks=pytest.mark.campaign),
        pytest.param(1280, "dark", marks=pytest.mark.campaign),
    ],
)
def test_the_pages_in_a_browser(browser: Any, report: Path, width: int, scheme: str) -> None:
    assert look_at(browser, report / "report.html", width, scheme) == []


def test_the_filter_shows_one_verdict_and_what_a_link_leads_to(browser: Any, report: Path) -> None:
    claims = json.loads((report / "report.json").read_text(encoding="utf-8"))["claims"]
    page = browser.new_page(viewport={"width": 1280, "height": 800}, java_script_enabled=True)
    page.goto((report / "report.html").as_uri(), wait_until="load")
    assert "<script" not in page.content()
    seen = "[...document.querySelectorAll('.claim')].filter(each => each.checkVisibility()).map(each => each.id)"
    for verdict, (name, _) in BADGES.items():
        expected = [f"claim-{each['id']}" for each in claims if each["verdict"] == verdict]
        if expected:
            page.check(f"#show-{name}")
            assert page.evaluate(seen) == expected
            assert not page.is_visible("#figures")
            parts = "[...document.querySelectorAll('section.part')].filter(each => each.checkVisibility()).length"
            assert page.evaluate(parts) == len(
                {e["part"] for e in claims if e["verdict"] == verdict}
            )
    hidden = next(each["id"] for each in claims if each["verdict"] == CONFIRMED)
    page.evaluate(f"location.hash = 'claim-{hidden}'")
    assert page.is_visible(f"#claim-{hidden}")
    page.check("#show-all")
    assert len(page.evaluate(seen)) == len(claims)
    page.close()


NUMBER = re.compile(r"(?<![\w.^(])[−-]?\d+\.\d{3,}")


def test_numbers_in_errata_were_found_by_the_checks(report: Path) -> None:
    """A decimal number in an erratum is a number of the paper, or is in the evidence of its claims, rounded."""
    content = json.loads((report / "report.json").read_text(encoding="utf-8"))
    by_id = {each["id"]: each for each in content["claims"]}
    for erratum in content["errata"]:
        evidence = [by_id[name] for name in erratum["claims"]]
        words = " ".join(f"{e['finding']} {e['numbers']} {e['says']}" for e in evidence).replace(
            "−", "-"
        )
        known = [Decimal(number) for number in re.findall(r"-?\d+\.\d+", words)]
        for number in NUMBER.findall(f"{erratum['printed']} {erratum['holds']} {erratum['proof']}"):
            value = Decimal(number.replace("−", "-"))
            unit = Decimal(1).scaleb(int(value.as_tuple().exponent))
            assert any(abs(value - each) <= unit for each in known), (erratum["id"], number)


def test_a_bad_page_is_noticed(browser: Any, tmp_path: Path) -> None:
    page = tmp_path / "bad.html"
    page.write_text(
        '<!DOCTYPE html><p id="a">a</p><p id="a" style="color: #999">b</p><a href="#c">c</a>'
        '<img src="none.png" alt="d">'
        '<img width=300 alt="e" src="data:image/svg+xml,'
        "<svg xmlns='http://www.w3.org/2000/svg' width='400pt' height='99pt'/>\">"
        '<div style="overflow: hidden; width: 20px; white-space: nowrap">long text</div>'
        '<div style="overflow: auto; width: 20px; white-space: nowrap">long text</div>'
        '<p style="position: absolute; left: 3000px; font-size: 5px">e</p><script>throw Error("oh")</script>'
    )
    complaints = "\n".join(look_at(browser, page, 360, "light"))
    for word in (
        "page is 30", "no image", "dangling link #c", "id twice: a", "contrast 2.", "not loaded", "clipped",
        "scrolls without", "outside of the window", "letters of 5px", "letters of 6.0px", "oh", "ERR_FILE_NOT_FOUND",
    ):  # fmt: skip
        assert word in complaints, word


@pytest.mark.parametrize(("width", "height"), [(1280, 17_000), (360, 43_000)])
def test_what_a_reader_does_not_need_first_is_folded(
    browser: Any, report: Path, width: int, height: int
) -> None:
    """Statements and verdicts are there at once.

    How they were found, captions and derivations are a click away.
    """
    page = browser.new_page(viewport={"width": width, "height": 800})
    page.goto((report / "report.html").as_uri(), wait_until="load")
    assert page.evaluate("document.scrollingElement.scrollHeight") < height
    claims = page.locator(".claim")
    columns = page.evaluate(
        "new Set([...document.querySelectorAll('.claim')].map(e => e.offsetLeft)).size"
    )
    assert columns == (2 if width > 1000 else 1)
    assert page.locator(".claim summary").count() == claims.count()
    first = claims.first
    assert first.locator("summary .source").is_visible()
    assert not first.locator("details > p").first.is_visible()
    first.locator("summary").click()
    assert first.locator("details > p").first.is_visible()
    page.close()
