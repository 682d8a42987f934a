"""Draw the picture of the page in docs/explore.md: `python docs/explore/draw.py [FILE]`."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "support"))

from browsing import chromium  # noqa: E402  it is in the folder that was just named
from exploring import served  # noqa: E402

WIDTH = 1400
HEIGHT = 1008  # the last panel ends here


def draw(path: Path) -> None:
    """Write the picture of a page near the scene of Fig. 5."""
    with served("fig5") as address, chromium() as browser:
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        page.goto(f"{address}?k=1.5&periods=6")
        page.locator("#settled", has_text="period").wait_for()
        page.wait_for_function("Bokeh.documents.length && Bokeh.documents[0].is_idle")
        page.wait_for_timeout(1000)  # the plots are drawn
        page.screenshot(path=path)


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "page.png")
