"""Numbers and references: labels are unique and known, and LaTeX counts like the other formats."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from chapters import unchecked_items
from matplotlib.text import Text

from symosc.derive import document, pdf
from symosc.derive.blocks import Illustration
from symosc.derive.chapters import CHAPTERS
from symosc.derive.figures import figure
from symosc.derive.numbering import REFERENCE, Numbering, resolved

COMMITTED = Path(__file__).parents[2] / "derivations"
TEXTS = {key: (COMMITTED / document.FRAGMENTS_FOLDER / f"{key}.tex").read_text(encoding="utf-8") for key in CHAPTERS}
MAIN = (COMMITTED / document.MAIN).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def numbers() -> Numbering:
    return Numbering((key, unchecked_items(key)[1]) for key in CHAPTERS)


def test_every_equation_has_a_label() -> None:
    for text in TEXTS.values():
        rows = re.findall(r"\\markit\{\w\}(.*)", text)
        assert rows
        assert all(row.startswith(r"\label{eq:") for row in rows)


def test_labels_are_unique_and_references_known() -> None:
    labels = [label for text in TEXTS.values() for label in re.findall(r"\\label\{([^{}]*)\}", text)]
    assert len(labels) == len(set(labels))
    wanted = {label for text in [*TEXTS.values(), MAIN] for _, label in REFERENCE.findall(text)}
    wanted -= {"#1"}  # a macro
    assert len(wanted) > 60
    assert wanted <= set(labels)


@pytest.mark.slow
@pytest.mark.skipif(not pdf.has_latex(), reason="no pdflatex")
def test_latex_counts_like_the_other_formats(numbers: Numbering, tmp_path: Path) -> None:
    work = tmp_path / "derivations"
    shutil.copytree(COMMITTED, work)
    subprocess.run(["pdflatex", "-interaction=nonstopmode", document.MAIN], cwd=work, capture_output=True, check=True)
    aux = (work / document.MAIN).with_suffix(".aux").read_text(encoding="latin-1")
    for key in CHAPTERS:
        path = work / document.FRAGMENTS_FOLDER / f"{key}.aux"
        aux += path.read_text(encoding="latin-1") if path.is_file() else ""
    counted = dict(re.findall(r"\\newlabel\{([^{}]*)\}\{\{([\d.]*)\}", aux))
    assert {label: number for label, number in counted.items() if label in numbers.of} == {
        label: number for label, number in numbers.of.items() if label in counted
    }
    assert len(counted) > 150
    assert set(numbers.of) >= {label for text in TEXTS.values() for label in re.findall(r"\\label\{([^{}]*)\}", text)}


def test_references_to_other_documents_name_the_chapter() -> None:
    assert resolved(r"By Theorem~\ref{thm:domains-flow} and \eqref{eq:maps-f1}", None) == "By Chapter~2 and Chapter~5"


@pytest.mark.slow
@pytest.mark.skipif(not (pdf.has_latex() and shutil.which("pdftotext")), reason="needs pdflatex and pdftotext")
def test_tables_and_figures_stay_in_their_chapter(tmp_path: Path) -> None:
    work = tmp_path / "derivations"
    shutil.copytree(COMMITTED, work)
    made = pdf.make_pdf(work / document.MAIN)
    shown = subprocess.run(["pdftotext", "-layout", made, "-"], capture_output=True, text=True, check=True).stdout
    found = re.findall(r"^ {0,3}(\d{1,2})  +[A-Z]\w+|^ *(?:Table|Figure) (\d+)\.\d+:", shown.replace("\f", "\n"), re.M)
    begin = max(i for i, (title, _) in enumerate(found) if title == "1")  # behind the contents
    assert [int(title) for title, _ in found[begin:] if title] == list(range(1, len(CHAPTERS) + 1))
    chapter = ""
    for title, of in found[begin:]:
        chapter = title or chapter
        assert of in ("", chapter), f"a table or figure of chapter {of} stands in chapter {chapter}"


@pytest.mark.parametrize("key", ["motion", "sticks", "switching", "grazing"])
def test_letters_of_figures_are_as_large_in_print_as_in_a_paper(key: str) -> None:
    """At least 9 points: the line is 160 mm long, and a figure takes a part of it."""
    (picture,) = [item for item in unchecked_items(key)[1] if isinstance(item, Illustration)]
    drawing = figure(picture.key)
    scale = picture.width * (160 / 25.4) / drawing.get_figwidth()
    sizes = [text.get_fontsize() for text in drawing.findobj(Text) if text.get_text().strip()]
    assert min(sizes) * scale >= 9
