"""Chapters of the derivations with their evidence.

The checks of a chapter are run once in a session. The environment variable SYMOSC_REPORT names a
report that was just made, whose run has checked each step: its evidence is taken.
"""

from __future__ import annotations

import json
import os
import pickle
import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

from once import SHARED, alone

from symosc.derive import document
from symosc.derive.chapters import CHAPTERS, borders
from symosc.derive.scope import Scope
from symosc.derive.steps import Step, StepEvidence, steps_of
from symosc.orbits.branch import continue_orbit


def branch(*given: Any) -> Any:
    """Return a branch of orbits of the chapter on borders, its ends only.

    The first worker follows it.
    """
    _, word, name, (first, last) = given
    with alone(f"branch-{word}-{name}-{first}-{last}") as path:
        if not path.exists():
            path.write_bytes(pickle.dumps(continue_orbit(*given).ends))
        return SimpleNamespace(ends=pickle.loads(path.read_bytes()))


@cache
def unchecked_items(key: str) -> tuple[str, list[Any]]:
    """Return the title and the items of a chapter; nobody changes them."""
    with patch.object(borders, "continue_orbit", branch):
        return document.chapter_items(key, Scope())


@cache
def unchecked(key: str) -> document.Checked:
    """Return a chapter with evidence that is made up: only what is printed counts."""
    with patch.object(Step, "verify", lambda step: StepEvidence("exact", "0")):
        return document.check(key, *unchecked_items(key))


#: What a report shows beside a displayed step, or after a sentence with steps: e, s and n for how
#: they were checked (`Part.marks`).
MARKS = re.compile(
    r'<td title="\w+">\([\d.]+&nbsp;([esn,]+)\)</td>|class="checked">([esn,]+)</sup>'
)
KINDS = {"e": "exact", "s": "sign", "n": "numeric"}


@cache
def reported_rows(folder: Path) -> dict[str, dict[str, Any]]:
    """Return the rows of a report about its chapters, each with the text of its page."""
    rows = json.loads((folder / "report.json").read_text(encoding="utf-8"))["derivations"]
    page = (folder / "report.html").read_text(encoding="utf-8")
    articles = page.split('<article class="derivation" id="derivation-')[1:]
    texts = dict(text.split('"', 1) for text in articles)
    return {row["subject"]: row | {"page": texts[str(row["number"])]} for row in rows}


def reported(key: str, folder: Path) -> document.Checked:
    """Return a chapter with the kinds of evidence that a report shows."""
    row = reported_rows(folder)[key]
    title, items = unchecked_items(key)
    marks = ["".join(found) for found in MARKS.findall(row["page"].partition("</article>")[0])]
    with_steps = [steps_of(item) for item in items if steps_of(item)]
    assert len(marks) == len(with_steps)
    assert row["steps"] == sum(map(len, with_steps))
    kinds = []
    for steps, letters in zip(with_steps, marks, strict=True):
        first = [KINDS[letter] for letter in letters.split(",")]
        kinds += first + first[-1:] * (len(steps) - len(first))
    ahead = iter(kinds)
    with patch.object(Step, "verify", lambda step: StepEvidence(next(ahead), "as reported")):
        return document.check(key, title, items)


@cache
def chapter(key: str) -> document.Checked:
    """Return a chapter; the first worker checks each step, the others take over what it found, step by step."""
    if made := os.environ.get("SYMOSC_REPORT"):
        return reported(key, Path(made))
    verify = Step.verify
    with alone(f"chapter-{key}") as path:
        if path.exists():
            found: list[tuple[str, StepEvidence]] = pickle.loads(path.read_bytes())
        else:
            found = []
        ahead = iter(found)

        def noted(step: Step) -> StepEvidence:
            # A step whose check verifies others is taken over as a whole.
            with patch.object(Step, "verify", verify):
                evidence = verify(step)
            found.append((str(step), evidence))
            return evidence

        def taken_over(step: Step) -> StepEvidence:
            statement, evidence = next(ahead)
            assert statement == str(step)
            return evidence

        title, items = unchecked_items(key)
        with patch.object(Step, "verify", taken_over if found else noted):
            checked = document.check(key, title, items)
        path.write_bytes(pickle.dumps(found))
    return checked


def numbers() -> str:
    """Return the numbers of all labels in the whole book as JSON."""
    found = document.numbers_of([unchecked(key) for key in CHAPTERS])
    return json.dumps(found, indent=0) + "\n"


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        os.environ[SHARED] = folder  # as in a test session
        text = numbers()
    document.NUMBERS_FILE.write_text(text, encoding="utf-8")
