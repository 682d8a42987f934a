"""Builds documents from chapters: checks every step, then writes LaTeX, HTML, Markdown or text."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from symosc.derive import front, html, latex_pages, text_pages
from symosc.derive.bibliography import source
from symosc.derive.blocks import Illustration, steps_of
from symosc.derive.chapters import CHAPTERS
from symosc.derive.figures import FIGURES, figure
from symosc.derive.latex import plain
from symosc.derive.numbering import Numbering, chapter_number
from symosc.derive.scope import Scope
from symosc.derive.steps import Step, StepError, StepEvidence
from symosc.errors import OutputError, ParameterError
from symosc.files import write_text
from symosc.scenes import Scene

#: Folders beside the main document: its chapters, and its figures.
FRAGMENTS_FOLDER, PICTURES = "chapters", "figures"
MAIN, BIBTEX, PAGE = "derivations.tex", "references.bib", "derivations.html"
PAGE_SUFFIXES = {"latex": ".tex", "html": ".html", "markdown": ".md", "text": ".txt"}


class Part(NamedTuple):
    """An item of a chapter with the evidence of its steps, in their order."""

    item: Any
    evidence: tuple[StepEvidence, ...]


class Checked:
    """A chapter whose steps have all passed."""

    def __init__(self, key: str, title: str, parts: list[Part]) -> None:
        self.key, self.title, self.number = key, title, chapter_number(key)
        self.parts = parts

    @property
    def items(self) -> list[Any]:
        """The items alone."""
        return [part.item for part in self.parts]

    def steps(self) -> list[tuple[Step, StepEvidence]]:
        """Return every step with its evidence, those behind sentences and tables included."""
        return [pair for part in self.parts for pair in zip(steps_of(part.item), part.evidence, strict=True)]

    def log(self) -> list[dict[str, Any]]:
        """Return what a program wants to know of each step; steps that are not displayed have no number."""
        rows, count = [], 0
        for part in self.parts:
            shown = isinstance(part.item, Step)
            count += shown
            for step, evidence in zip(steps_of(part.item), part.evidence, strict=True):
                statement = f"{plain(step.statement.left)} {step.statement.op} {plain(step.statement.right)}"
                number = f"{self.number}.{count}" if shown else ""
                rows.append({"step": number, "statement": statement, **evidence._asdict()})
        return rows


def chapter_items(key: str, scope: Scope) -> tuple[str, list[Any]]:
    """Return the title and the unchecked items of a chapter."""
    if key not in CHAPTERS:
        raise ParameterError("subject", key, f"must be all or one of {', '.join(CHAPTERS)}")
    module = import_module(f"symosc.derive.chapters.{key}")
    return module.TITLE, list(module.items(scope))


def check_chapter(key: str, scope: Scope, progress: Callable[[int, int], None] | None = None) -> Checked:
    """Build a chapter and check its steps.

    Raises
    ------
    StepError
        If a check fails or cannot be decided.
    """
    title, items = chapter_items(key, scope)
    count = sum(len(steps_of(item)) for item in items)
    parts: list[Part] = []
    done = 0
    for item in items:
        evidence = []
        for step in steps_of(item):
            try:
                evidence.append(step.verify())
            except StepError as error:
                raise StepError(f"{key}, step {done + 1}: {error.statement}", error.reason) from None
            done += 1
            if progress:
                progress(done, count)
        parts.append(Part(item, tuple(evidence)))
    return Checked(key, title, parts)


def numbers_of(chapters: list[Checked]) -> Numbering:
    """Return the numbers of everything in some chapters."""
    return Numbering((chapter.key, chapter.items) for chapter in chapters)


def as_latex(chapter: Checked, scope: Scope, numbers: Numbering | None = None) -> str:
    """Return a chapter as LaTeX, to be read in by the main document."""
    return latex_pages.chapter(chapter, scope, numbers or numbers_of([chapter]))


def as_html(chapter: Checked, scope: Scope, numbers: Numbering | None = None, level: int = 2) -> str:
    """Return a chapter as a piece of HTML; `level` is that of its headings."""
    return html.chapter(chapter, scope, numbers or numbers_of([chapter]), level)


def as_markdown(chapter: Checked, scope: Scope, numbers: Numbering | None = None) -> str:
    """Return a chapter as Markdown with formulas between double dollars."""
    return text_pages.markdown(chapter, scope, numbers or numbers_of([chapter]))


def as_text(chapter: Checked, scope: Scope, numbers: Numbering | None = None) -> str:
    """Return a chapter as plain text."""
    return text_pages.text(chapter, scope, numbers or numbers_of([chapter]))


def as_page(chapters: list[Checked], scope: Scope) -> str:
    """Return chapters as one HTML file that needs no other."""
    return html.page(chapters, scope, numbers_of(chapters))


FORMATS: dict[str, Callable[..., str]] = {
    "latex": as_latex,
    "html": as_html,
    "markdown": as_markdown,
    "text": as_text,
}


def main_document(chapters: list[Checked], scope: Scope) -> str:
    """Return the document that reads the chapters in."""
    body = "".join(as_latex(each, scope) for each in chapters)
    return front.document(chapters, scope, body, FRAGMENTS_FOLDER, numbers_of(chapters))


def write_document(chapters: list[Checked], scope: Scope, folder: Path, form: str = "latex") -> list[Path]:
    """Write the chapters into a folder (made if needed) and return the paths, the main file first.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    if form == "html":
        _make(folder)
        return [write_text(folder / PAGE, as_page(chapters, scope))]
    numbers = numbers_of(chapters)
    target = folder / FRAGMENTS_FOLDER if form == "latex" else folder
    _make(target)
    paths = [
        write_text(target / f"{chapter.key}{PAGE_SUFFIXES[form]}", FORMATS[form](chapter, scope, numbers))
        for chapter in chapters
    ]
    if form == "latex":
        paths.insert(0, write_text(folder / MAIN, main_document(chapters, scope)))
        paths.append(write_text(folder / BIBTEX, source()))
        paths += _draw(chapters, folder / PICTURES)
    return paths


def printed(chapters: list[Checked], scope: Scope, form: str) -> str:
    """Return what goes to standard output: the chapters, for HTML as one page."""
    if form == "html":
        return as_page(chapters, scope)
    numbers = numbers_of(chapters)
    return "\n".join(FORMATS[form](chapter, scope, numbers) for chapter in chapters)


def _draw(chapters: list[Checked], folder: Path) -> list[Path]:
    from symosc import plot

    keys = [item.key for chapter in chapters for item in chapter.items if isinstance(item, Illustration)]
    if keys:
        _make(folder)
    return [plot.save(figure(key), folder / f"{key}.pdf") for key in keys if key in FIGURES]


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(str(folder), error.strerror or str(error)) from None


def build(
    subjects: list[str], scene: Scene | None = None, progress: Callable[[str, int, int], None] | None = None
) -> tuple[Scope, list[Checked]]:
    """Check the chapters of some subjects ("all" for every one) and return them with their scope."""
    scope = Scope(scene)
    keys = list(CHAPTERS) if "all" in subjects else subjects
    chapters = []
    for key in keys:
        report = None if progress is None else (lambda done, count, key=key: progress(key, done, count))
        chapters.append(check_chapter(key, scope, report))
    return scope, chapters


def run(subject: str) -> None:
    """Check one subject and print it as text, for the scripts in derivations/."""
    scope, chapters = build([subject])
    print(as_text(chapters[0], scope))
