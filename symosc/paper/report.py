"""The report on a run: as data for machines (JSON), as Markdown, and as one HTML file that needs nothing else."""

from __future__ import annotations

import json
import os
import signal
import threading
from base64 import b64encode
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict
from os.path import exists
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from markupsafe import Markup

from symosc.bench import machine
from symosc.derive.citation import paper_reference
from symosc.derive.errata import SEVERITIES, Erratum
from symosc.errors import OutputError
from symosc.paper import letter
from symosc.paper.claims import PARTS
from symosc.paper.coverage import NAMES, coverage
from symosc.paper.evidence import CONFIRMED, CORRECTED, DEFINITION, NOT_AS_PRINTED, UNDECIDED
from symosc.paper.rendering import render
from symosc.paper.run import ERROR, Judged, Results

#: A word of its own for each verdict (used as a class name), and its sign: colour is never alone.
BADGES = {
    CONFIRMED: ("confirmed", "✓"),
    DEFINITION: ("definition", "≡"),
    CORRECTED: ("corrected", "±"),
    NOT_AS_PRINTED: ("misprinted", "✗"),
    UNDECIDED: ("undecided", "?"),
    ERROR: ("failed", "!"),
}
#: Words and symbols that the findings use without explaining them each time.
NUMBER_MEANINGS = {
    "F(1), F(2), F(3)": "The acceleration in each domain, eq. (9); F⁽ˡᵒ⁾ and F⁽ʰⁱ⁾ are those below and above a belt.",
    "G⁽⁰⁾, G⁽¹⁾, G⁽²⁾, …": "F and its derivatives along the flow; G(1,2) is the first one in domain 2.",
    "P1 to P8": "The motions from one contact with a belt to the next, Fig. 4. P32 is P2, then P3.",
    "stick, slip, graze": "The mass begins to move with a belt; it leaves that belt; its velocity touches a belt's and "
    "returns.",
    "rational or exact contact": "Parameters, place and the sine and cosine of the phase are rational numbers: what "
    "happens there is decided exactly, without rounding.",
    "exact start": "A start with 40 digits from which the motion grazes at a round phase; it rounds to the printed one "
    "(in Fig. 8 up to the last digit).",
    "by definition": "The paper lays it down, and this program as well: there is nothing to find out.",
    "flown again": "Every stretch of a motion computed once more by another closed form in doubles, and what follows "
    "each contact decided by Theorems 4 and 5.",
    "residual": "What is left of an equation, 0 in theory, where computed numbers are put in.",
    "DOP853": "A Runge-Kutta method of order 8 in SciPy, as a second opinion.",
}
REPORTS = ("report.html", "report.md", "report.json")
FIGURES, DERIVATIONS = "figures", "derivations"


def data(results: Results) -> dict[str, Any]:
    """Return everything that a run found as plain data, the content of report.json."""
    return {
        "paper": paper_reference(),
        "ok": results.ok,
        "counts": results.counts,
        "errata": [asdict(erratum) | {"claims": _shown_by(erratum, results)} for erratum in results.errata],
        "coverage": _coverage(results),
        "unjudged": [asdict(part) for part in results.unjudged or ()],
        "changed": [each.claim.id for each in results.changed],
        "failures": results.failures,
        "made": {"seconds": round(results.seconds, 1), **machine()},
        "claims": [_claim(each) for each in results.judged],
        "figures": [_figure(key, results) for key in results.pictures],
        "derivations": [_derivation(subject, results) for subject in results.chapters],
    }


def _shown_by(erratum: Erratum, results: Results) -> list[str]:
    return [each.claim.id for each in results.shown_by(erratum)]


def _coverage(results: Results) -> list[dict[str, Any]]:
    """Return what there is on each numbered item of the paper; nothing if only a part of the claims was judged."""
    if results.unjudged is None:
        return []
    table = coverage((each.claim for each in results.judged), results.unjudged)
    return [
        {"item": item.label, "kind": item.kind, "claims": on.claims, "unjudged": [part.says for part in on.unjudged]}
        for item, on in table.items()
    ]


def _claim(each: Judged) -> dict[str, Any]:
    claim = each.claim
    return {
        "id": claim.id,
        "part": claim.part,
        "source": claim.source,
        "says": claim.says,
        "verdict": each.verdict,
        "committed": claim.verdict,
        "finding": each.finding,
        "numbers": each.numbers,
        "correction": claim.correction,
        "errata": list(claim.errata),
        "remark": claim.remark,
        "figures": list(claim.figures),
        "derivation": claim.derivation,
        "seconds": round(each.seconds, 3),
    }


def _figure(key: str, results: Results) -> dict[str, Any]:
    picture, done = results.pictures[key], results.drawn[key]
    return {
        "key": key,
        "title": picture.title,
        "caption": done.value.caption if done.value else "",
        "alt": picture.alt,
        "paper_figure": picture.paper_figure,
        "file": f"{FIGURES}/{key}.svg" if done.value else None,
        "claims": [each.claim.id for each in results.judged if key in each.claim.figures],
        "seconds": round(done.seconds, 3),
    }


def _derivation(subject: str, results: Results) -> dict[str, Any]:
    from symosc.derive.chapters import CHAPTERS

    done = results.chapters[subject]
    return {
        "subject": subject,
        "number": list(CHAPTERS).index(subject) + 1,
        "title": CHAPTERS[subject],
        "steps": done.value.steps if done.value else 0,
        "file": f"{DERIVATIONS}/{done.value.name}.md" if done.value else None,
        "claims": [each.claim.id for each in results.judged if each.claim.derivation == subject],
        "seconds": round(done.seconds, 3),
    }


def files(results: Results) -> dict[str, str]:
    """Return the text of every file of the report by its path in the folder."""
    content = data(results)
    drawn = {key: done.value for key, done in results.drawn.items() if done.value}
    chapters = {subject: done.value for subject, done in results.chapters.items() if done.value}
    found = {f"{FIGURES}/{key}.svg": each.svg for key, each in drawn.items()}
    found |= {f"{DERIVATIONS}/{each.name}.md": each.markdown for each in chapters.values()}
    parts = {part: title for part, title in PARTS.items() if any(each.claim.part == part for each in results.judged)}
    context = {
        **content,
        "parts": parts,
        "badges": BADGES,
        "groups": _groups(content["figures"]),
        "words": NUMBER_MEANINGS,
    }
    context |= {"severities": SEVERITIES, "kinds": NAMES}
    context["erratum_numbers"] = {erratum.id: erratum.number for erratum in results.errata}
    images = {key: _data_uri(each.svg) for key, each in drawn.items()}
    narrow = {key: _data_uri(each.narrow) for key, each in drawn.items() if each.narrow}
    proofs = {subject: Markup(each.html) for subject, each in chapters.items()}
    found["report.md"] = render("report.md.j2", context)
    found["report.html"] = render("report.html.j2", {**context, "images": images, "narrow": narrow, "proofs": proofs})
    if content["coverage"]:
        found |= letter.texts(results)
    found["report.json"] = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    return found


def _groups(figures: list[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """Put the pictures that belong to one figure of the paper together: fig7, fig7-corrected and fig7-exact."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for figure in figures:
        groups.setdefault(figure["key"].partition("-")[0].removeprefix("fig"), []).append(figure)
    return groups


def _data_uri(svg: str) -> str:
    return f"data:image/svg+xml;base64,{b64encode(svg.encode()).decode('ascii')}"


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Put an interrupt off to the end of the block."""
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread gets them
        return
    caught: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: caught.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if caught:
            signal.raise_signal(signal.SIGINT)


class Folder:
    """A folder for a report: made and tried out before the work, filled when all of it is done, else taken away again.

    Raises
    ------
    OutputError
        If it cannot be made or written to.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._made = [each for each in (self.path, *self.path.parents) if not exists(each)]
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._draft = TemporaryDirectory(prefix=".symosc-", dir=self.path)
        except OSError as error:
            raise OutputError(str(path), error.strerror or str(error)) from None

    def __enter__(self) -> Folder:
        return self

    def __exit__(self, *error: object) -> None:
        self._draft.cleanup()
        for made in self._made:
            with suppress(OSError):  # it is full
                made.rmdir()

    def write(self, texts: Mapping[str, str]) -> None:
        """Write the files; only when all are on the disk are they moved to their places."""
        draft = Path(self._draft.name)
        try:
            for name, text in texts.items():
                (draft / name).parent.mkdir(exist_ok=True)
                (draft / name).write_text(text, encoding="utf-8")
            with uninterrupted():
                for name in texts:
                    (self.path / name).parent.mkdir(exist_ok=True)
                    os.replace(draft / name, self.path / name)
        except OSError as error:
            raise OutputError(str(self.path), error.strerror or str(error)) from None
