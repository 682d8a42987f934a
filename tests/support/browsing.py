"""A real browser without a window, for tests that look at pages."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from effort import PATIENCE

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@contextmanager
def chromium() -> Iterator[Any]:
    """Open the browser that is here; skip the test if there is none."""
    found = [path for path in map(shutil.which, BROWSERS) if path]
    if not found:
        pytest.skip(f"no browser here; looked for {', '.join(BROWSERS)}")
    from playwright.sync_api import sync_playwright

    # Chromium's sandbox does not work for the superuser, who is who runs tests in containers.
    if os.geteuid() == 0:
        flags = ["--no-sandbox"]
    else:
        flags = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=found[0], args=flags, timeout=1000 * PATIENCE
        )
        new_page = browser.new_page

        def patient_page(**options: Any) -> Any:
            page = new_page(**options)
            page.set_default_timeout(1000 * PATIENCE)
            return page

        browser.new_page = patient_page
        yield browser
        browser.close()
