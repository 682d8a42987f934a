"""Numbers and references: labels are unique and known, and LaTeX counts like the other formats."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from chapters import unchecked_items

from symosc.derive import document, pdf
from symosc.derive.chapters import CHAPTERS
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
