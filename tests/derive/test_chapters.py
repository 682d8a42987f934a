"""Chapters: every step passes, the committed LaTeX is current, LaTeX and HTML take it."""

from __future__ import annotations

import difflib
import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sympy as sp
from chapters import chapter, numbers, unchecked
from click.testing import CliRunner
from latex_reader import Reader
from symbols import defined, listed, symbols
from sympy.core.function import AppliedUndef

from symosc.base.errors import OutputError
from symosc.cli.app import main
from symosc.cli.derive import derive
from symosc.derive import document
from symosc.derive.chapters import CHAPTERS
from symosc.derive.errata import read_errata
from symosc.derive.front import NOTATION
from symosc.derive.latex import lines
from symosc.derive.scope import Scope
from symosc.derive.steps import points
from symosc.scenes import as_toml, load_scene, load_template
from symosc.symbolic.latex import latex

COMMITTED = Path(__file__).parents[2] / "derivations"
TEXTS = {
    key: (COMMITTED / document.CHAPTER_FOLDER / f"{key}.tex").read_text(encoding="utf-8")
    for key in CHAPTERS
}
MAIN = (COMMITTED / document.MAIN).read_text(encoding="utf-8")
LABELS = [label for text in TEXTS.values() for label in re.findall(r"\\label\{([^{}]*)\}", text)]
#: The checks of the other chapters take a second each and more.
QUICK = ("switching",)
KEYS = [key if key in QUICK else pytest.param(key, marks=pytest.mark.slow) for key in CHAPTERS]
SCENES = ("fig5", "fig8", "fig9", "fig10")
ACCEPT = "accept it with: symosc derive all -o derivations"
needs_pdftotext = pytest.mark.skipif(shutil.which("pdftotext") is None, reason="no pdftotext")
needs_latex = pytest.mark.skipif(not document.has_latex(), reason="no pdflatex")


def run(*arguments: str) -> Any:
    return CliRunner().invoke(derive, [*arguments], standalone_mode=False)


# --- the checks ---


@pytest.mark.parametrize("key", KEYS)
def test_committed_latex_is_current_and_every_step_has_evidence(key: str) -> None:
    checked = chapter(key)
    assert {evidence.kind for _, evidence in checked.steps()} <= {"exact", "sign", "numeric"}
    old = TEXTS[key]
    new = document.as_latex(checked, Scope(), dict.fromkeys(LABELS, ""))
    lines = (text.splitlines(keepends=True) for text in (old, new))
    assert old == new, "".join(difflib.unified_diff(*lines, "committed", "printed now")) + ACCEPT


@pytest.mark.slow
def test_committed_document_is_current() -> None:
    assert document.main_document([unchecked(key) for key in CHAPTERS], Scope()) == MAIN, ACCEPT


@pytest.mark.full(4)
@pytest.mark.parametrize("key", KEYS)
def test_what_is_printed_reads_back(key: str) -> None:
    for step, _ in chapter(key).steps():
        if step.op == "in" or step.right.atoms(AppliedUndef):
            continue
        shown = document.shown(step, Scope())
        left, right = " ".join(lines(shown, step.decimals)).split("&", 1)
        right = re.sub(r"^(?:=|>|<|\\ge|\\le)(?![a-z])", "", right)
        for text, side in ((left, shown.left), (right, shown.right)):
            point = next(points(side, count=1))
            values = {latex(letter): complex(value) for letter, value in point.items()}
            expected = complex(sp.N(side.subs(point, simultaneous=True), 20))
            assert Reader(text, values).value() == pytest.approx(expected, rel=1e-9, abs=1e-9), text


@pytest.mark.campaign
@pytest.mark.parametrize("key", ["motion", "domains", "maps", "grazing"])
@pytest.mark.parametrize("scene", SCENES)
def test_every_step_of_a_scene_has_evidence(scene: str, key: str) -> None:
    assert document.check_chapter(key, Scope(load_scene(scene))).steps()


# --- LaTeX ---


@pytest.mark.slow
@needs_latex
def test_latex_takes_it_and_counts_like_html(tmp_path: Path) -> None:
    """A warning, or a box overfull by 5 pt, fails."""
    work = tmp_path / "derivations"
    shutil.copytree(COMMITTED, work)
    for _ in range(2):
        command = [
            "pdflatex",
            "-interaction=nonstopmode",
            "-halt-on-error",
            "-draftmode",
            document.MAIN,
        ]
        subprocess.run(command, cwd=work, capture_output=True, check=True)
    log = (work / document.MAIN).with_suffix(".log").read_text(encoding="latin-1")
    assert [
        complaint
        for complaint in document.complaints_of(log)
        if "Rerun" not in complaint and "may have changed" not in complaint
    ] == []
    aux = "".join(path.read_text(encoding="latin-1") for path in work.rglob("*.aux"))
    counted = dict(re.findall(r"\\newlabel\{([^{}]*)\}\{\{([\d.]*)\}", aux))
    numbers = document.numbers_of([unchecked(key) for key in CHAPTERS])
    assert {label: counted[label] for label in LABELS} == {
        label: numbers[label] for label in LABELS
    }


# --- one chapter alone ---


@pytest.mark.slow
def test_the_stored_numbers_are_those_of_the_whole_book() -> None:
    text = document.NUMBERS_FILE.read_text(encoding="utf-8")
    assert text == numbers(), "store them anew with: .venv/bin/python tests/support/chapters.py"


@pytest.mark.parametrize("key", KEYS)
def test_a_chapter_alone_has_no_reference_without_target(key: str) -> None:
    """Labels of other chapters have become their numbers in the whole book."""
    checked = unchecked(key)
    text = document.main_document([checked], Scope()) + document.as_latex(checked, Scope())
    named = re.findall(r"\\(?:eq)?ref\{([^{}#]*)\}", text)
    assert set(named) <= {*re.findall(r"\\label\{([^{}]*)\}", text)}
    assert not re.search(r"(?:Theorem|Lemma|Table|Eq\.|proof of)[~ ]Chapter~", text)
    assert "Chapter~0" not in text
    assert document.front.ALONE in text


@pytest.mark.parametrize(
    "key",
    [
        pytest.param(
            key, marks=[pytest.mark.slow] if key == "exponents" else [pytest.mark.campaign]
        )
        for key in CHAPTERS
    ],
)
@needs_latex
@needs_pdftotext
def test_the_pdf_of_a_chapter_alone_has_no_question_marks(key: str, tmp_path: Path) -> None:
    main, *_ = document.write_document([unchecked(key)], Scope(), tmp_path)
    text = subprocess.run(
        ["pdftotext", document.make_pdf(main), "-"], capture_output=True, text=True, check=True
    ).stdout
    assert "??" not in text
    assert len(text) > 1000


@pytest.mark.parametrize("key", KEYS)
def test_a_page_has_no_commands_of_latex(key: str) -> None:
    """Lists too that a display divides are read."""
    page = document.as_page([unchecked(key)], Scope())
    text = re.sub(r"<code>.*?</code>", "", page[page.index("<body") :], flags=re.DOTALL)
    assert re.findall(r"\\[a-zA-Z]+", text) == []


# --- notation and errata ---


def formulas(text: str) -> Iterator[str]:
    """Yield the mathematics of a chapter: its displays, and what stands between dollars."""
    displays = re.compile(r"\\begin\{align\}(.*?)\\end\{align\}", re.DOTALL)
    yield from displays.findall(text)
    yield from re.findall(r"\$(.*?)\$", displays.sub(" ", text), re.DOTALL)
    for display in displays.findall(text):
        yield from re.findall(r"\$(.*?)\$", display)


def test_every_symbol_is_in_the_table_of_notation() -> None:
    used = {
        symbol for text in TEXTS.values() for math in formulas(text) for symbol in symbols(math)
    }
    assert {symbol for symbol in used if not defined(symbol)} == set()
    assert len(listed() & used) > 0.8 * len(listed())
    assert {
        label for *_, where in NOTATION for label in re.findall(r"ref\{([^{}]*)\}", where)
    } <= set(LABELS)


def test_the_supplement_has_each_erratum_once_with_its_number_and_severity() -> None:
    errata = read_errata()
    printed = r"^\\textbf\{(\d+)\.\}~(.*?) \((\w+)\)\. \\emph\{Printed:\}"
    rows = re.findall(printed, TEXTS["errata"], re.MULTILINE)
    assert rows == [(str(erratum.number), erratum.where, erratum.severity) for erratum in errata]
    named = {label for erratum in errata for label in re.findall(r"ref\{([^{}]*)\}", erratum.shown)}
    assert len(named) > 10
    assert named <= set(LABELS)


# --- the command ---


@pytest.mark.slow
def test_a_pdf_that_fails_leaves_the_rest_and_says_why(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    checked = chapter("switching")

    def make_pdf(path: Path) -> Path:
        raise OutputError(str(path), "does not compile")

    for name, instead in {
        "has_latex": lambda: True,
        "check_chapter": lambda *_: checked,
        "make_pdf": make_pdf,
    }.items():
        monkeypatch.setattr(document, name, instead)
    result = run("switching", "-o", str(tmp_path / "new"), "--pdf")
    assert result.return_value == 1
    assert "does not compile" in result.stderr
    assert (tmp_path / "new" / document.MAIN).is_file()


@pytest.mark.slow
def test_command(tmp_path: Path) -> None:
    result = run("switching", "-o", str(tmp_path / "new"), "--json")
    assert result.exit_code == 0, result.output
    data = json.loads(result.stdout)
    assert {row["kind"] for row in data["steps"]} == {"exact"}
    assert all(Path(path).is_file() for path in data["files"])
    if document.has_latex():
        assert document.make_pdf(tmp_path / "new" / document.MAIN).stat().st_size > 10_000
    assert run("sticks", "-o", str(tmp_path), "--format", "html", "--scene", "fig9").exit_code == 0
    assert (tmp_path / document.PAGE).read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    printed = CliRunner().invoke(derive, ["sticks", "-o", "-"])
    assert printed.stdout == document.as_latex(chapter("sticks"), Scope())


@pytest.mark.parametrize("subject", ["static_friction", "friction_curves", "P1"])
def test_a_scene_with_static_friction_is_refused_in_one_line(subject: str, tmp_path: Path) -> None:
    """Chapters have letters for two belts with kinetic friction."""
    scene = tmp_path / "mine.toml"
    scene.write_text(as_toml(load_template("stick-slip")), encoding="utf-8")
    result = CliRunner().invoke(main, ["derive", subject, "--scene", str(scene), "-o", "-"])
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert (
        "static friction of belt 1 (mu_s = 1 > mu = 0.5) cannot be followed here" in result.stderr
    )
