"""The page in a real browser: what is moved, typed, linked, saved and opened there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any

import pytest
from effort import PATIENCE

from symosc import Scene, find_orbit, load_scene, simulate

pytestmark = pytest.mark.slow

# -- support ----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from browsing import chromium

    with chromium() as result:
        yield result


# -- the page ---------------------------------------------------------------------------------------------------------


#: What is drawn: the points of the curves, and the ranges of the axes.
DRAWN = """() => {
  const model = name => Bokeh.documents[0].get_model_by_name(name);
  const range = name => [model(`range-${name}`).start, model(`range-${name}`).end];
  return {marks: model("marks").data.label, times: [...model("marks").data.t], t: range("t"), v: range("v")};
}"""
#: What is wider than the window, or lies outside of it; cells of tables scroll.
TOO_WIDE = """() => {
  const wide = [...document.body.querySelectorAll("*")].filter(each => !each.closest(".scroll") &&
    each.checkVisibility() && each.getBoundingClientRect().right > innerWidth + 1);
  const page = document.scrollingElement.scrollWidth > innerWidth ? ["the page"] : [];
  return [...wide.map(each => each.outerHTML.slice(0, 80)), ...page];
}"""
#: Move the start as the tool of the phase plane does.
DRAG = """([x, v]) => {
  const start = Bokeh.documents[0].get_model_by_name("start");
  start.data.x[0] = x;
  start.data.v[0] = v;
  start.change.emit();
}"""


@contextmanager
def opened(browser: Any, link: str) -> Iterator[Any]:
    """Open a page; nothing may be wrong in it at its end."""
    page = browser.new_page(viewport={"width": 1400, "height": 900}, accept_downloads=True)
    complaints: list[str] = []
    page.on(
        "console",
        lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None,
    )
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(link)
    page.locator("#status:not(:empty)").wait_for()
    yield page
    page.close()
    assert complaints == []


def eventually(page: Any, holds: Callable[[], bool]) -> None:
    """Wait until the page shows what it is to show."""
    until = monotonic() + PATIENCE
    while not holds():
        assert monotonic() < until, "the page does not come to show it"
        page.wait_for_timeout(50)


def word_in(page: Any) -> list[str]:
    return [item for item in page.locator("#word span").all_text_contents() if item.startswith("P")]


def agrees(page: Any, scene: Scene) -> bool:
    """Whether the page shows the motion of this scene: its word, its events, its marks."""
    trajectory = simulate(scene)
    drawn = page.evaluate(DRAWN)
    times = [
        float(text) for text in page.locator("#events tbody td:nth-child(3)").all_text_contents()
    ]
    expected = [event.t for event in trajectory.events]
    return (
        word_in(page) == trajectory.word
        and times == pytest.approx(expected, rel=1e-7)
        and drawn["times"][1:] == pytest.approx(expected, rel=1e-8)
        and drawn["t"] == pytest.approx([float(scene.t0), float(scene.t_end)])
    )


def test_a_move_of_a_slider_shows_the_motion_of_simulate(browser: Any, address: str) -> None:
    scene = load_scene("fig5")
    with opened(browser, address) as page:
        assert page.locator("#name").inner_text() == "fig5"
        assert agrees(page, scene)
        slider = page.locator("[data-name=FN] [type=range]")
        slider.focus()
        for _ in range(5):
            slider.press("ArrowLeft")
        page.locator("#name", has_text="changed").wait_for()
        value = page.locator("#FN").input_value()
        assert value == "9.3"
        eventually(
            page,
            lambda: agrees(page, replace(scene, parameters=scene.parameters.replace(FN=value))),
        )
        eventually(page, lambda: "FN=9.3" in page.url)
        shown = page.evaluate(DRAWN)
        word = word_in(page)
        page.reload()  # the link is the state
        page.locator("#status:not(:empty)").wait_for()
        assert page.locator("#FN").input_value() == value
        eventually(page, lambda: page.evaluate(DRAWN) == shown)
        assert word_in(page) == word


def test_what_is_typed_is_exact_and_what_is_wrong_is_said_beside_it(
    browser: Any, address: str
) -> None:
    scene = load_scene("fig5")
    with opened(browser, address) as page:
        page.locator("#k").fill("4/3")
        page.locator("#v2").fill("50")
        page.locator("#name", has_text="changed").wait_for()
        eventually(
            page,
            lambda: agrees(
                page, replace(scene, parameters=scene.parameters.replace(k="4/3", v2=50))
            ),
        )
        slider = page.locator("[data-name=v2] [type=range]")
        assert (slider.input_value(), slider.get_attribute("max")) == ("50", "50")
        before = page.evaluate(DRAWN)
        page.locator("#m").fill("-1")
        page.locator("#c").fill("much")
        page.locator("#v1").fill("60")
        page.locator("#v1-error:not(:empty)").wait_for()
        said = {
            "m": "must be > 0",
            "c": "is not a number; 0.8, 4/5, 8e-1 and 2*pi are",
            "v1": "must be less than v2 = 50",
            "k": "",
        }
        eventually(
            page,
            lambda: {name: page.locator(f"#{name}-error").inner_text() for name in said} == said,
        )
        assert page.locator("#m").get_attribute("aria-invalid") == "true"
        assert "See the numbers marked" in page.locator("#status").inner_text()
        assert page.evaluate(DRAWN) == before
        assert not page.evaluate(TOO_WIDE)
        for name, text in (("m", "1"), ("c", "1"), ("v1", "1")):
            page.locator(f"#{name}").fill(text)
        page.locator("#status", has_text="reached").wait_for()
        assert page.locator(".wrong").count() == 0


def test_a_scene_file_is_saved_and_opened(browser: Any, address: str, tmp_path: Path) -> None:
    orbit = load_scene("fig9-orbit")
    with opened(browser, address) as page:
        page.locator("#scene").select_option(label="fig9-orbit")
        page.locator("#name", has_text="fig9-orbit").wait_for()
        page.locator("#mu1").fill("1/3")
        page.locator("#name", has_text="changed").wait_for()
        changed = replace(orbit, parameters=orbit.parameters.replace(mu1="1/3"))
        eventually(page, lambda: word_in(page) == simulate(changed).word)
        with page.expect_download() as download:
            page.locator("#download").click()
        file = tmp_path / "mine.toml"
        download.value.save_as(file)
        saved = load_scene(file)
        assert (saved.parameters, saved.x0, saved.t_end) == (
            changed.parameters,
            changed.x0,
            changed.t_end,
        )
        assert saved.start_error == orbit.start_error
        word = word_in(page)
        page.locator("#scene").select_option(label="fig5")
        eventually(page, lambda: page.locator("#name").inner_text() == "fig5")
        page.locator("#upload").set_input_files(file)
        page.locator("#name", has_text="fig9-orbit, changed").wait_for()
        eventually(page, lambda: word_in(page) == word)
        page.locator("#x0").fill("4")  # what is typed is exact
        eventually(
            page, lambda: page.locator("#start_error").input_value().split(",")[1:] == ["0", "0"]
        )
        bad = tmp_path / "bad.toml"
        bad.write_text(file.read_text().replace("m = 0.1", 'm = "heavy"'))
        page.locator("#upload").set_input_files(bad)
        page.locator("#file", has_text="bad.toml").wait_for()
        assert "m = 'heavy'" in page.locator("#file").inner_text()
        assert word_in(page)


def test_the_start_is_dragged_undone_and_reset(browser: Any, address: str) -> None:
    """The selector says what is loaded, the settled orbit is that of `find_orbit`, and a motion is played."""
    with opened(browser, f"{address}?scene=fig9") as page:
        orbit = find_orbit("fig9")
        page.locator("#settled", has_text=f"{orbit.word}, period 1.5708 s").wait_for()
        assert page.locator("#settled").inner_text().endswith(orbit.message)
        assert page.locator("#scene option:checked").inner_text() == "fig9"
        sections = page.evaluate(
            "() => Bokeh.documents[0].get_model_by_name('section').data.x.length"
        )
        assert sections == 6  # t = 10 is in the seventh period
        page.evaluate(DRAG, [3.5, 8.25])
        page.locator("#name", has_text="changed").wait_for()
        assert (page.locator("#x0").input_value(), page.locator("#v0").input_value()) == (
            "3.5",
            "8.25",
        )
        assert page.locator("#scene option:checked").inner_text() == "fig9, changed"
        page.wait_for_timeout(700)
        page.locator("#undo").click()
        eventually(page, lambda: page.locator("#name").inner_text() == "fig9")
        page.locator("#k").fill("4")
        page.locator("#name", has_text="changed").wait_for()
        page.locator("#reset").click()
        eventually(page, lambda: page.locator("#name").inner_text() == "fig9")
        page.locator("#play").click()
        eventually(
            page,
            lambda: (
                page.evaluate("() => Bokeh.documents[0].get_model_by_name('now').data.t.length")
                == 1
            ),
        )
        page.locator("#play").click()
        page.locator("#play", has_text="Play").wait_for()
