"""Derivations: every step passes, every changed sign fails, the committed LaTeX is current, and LaTeX takes it."""

from __future__ import annotations

import difflib
import json
import re
import runpy
from pathlib import Path
from typing import Any

import click
import pytest
import sympy as sp
from chapters import chapter, unchecked_items
from click.testing import CliRunner
from latex_reader import Reader
from sympy.core.function import AppliedUndef

from symosc.cli.derive import derive
from symosc.derive import displays, document, latex, line_breaks, pdf
from symosc.derive.blocks import Table, steps_of
from symosc.derive.chapters import CHAPTERS
from symosc.derive.mutations import mutations
from symosc.derive.numbering import Numbering
from symosc.derive.scope import Scope
from symosc.derive.steps import Exact, Step, StepError, StepEvidence, equation, points
from symosc.scenes import load_scene

COMMITTED = Path(__file__).parents[2] / "derivations"
#: The checks of the other chapters take a second each and more, those of the domains half a minute.
QUICK = ("switching",)
KEYS = [key if key in QUICK else pytest.param(key, marks=pytest.mark.slow) for key in CHAPTERS]
SCENES = ("fig5", "fig8", "fig9", "fig10")
ACCEPT = "accept it with: symosc derive all -o derivations"


class WholeDocument(Numbering):
    """Every reference is within the document; LaTeX knows the numbers."""

    def known(self, label: str) -> bool:
        return bool(label)


@pytest.mark.parametrize("key", KEYS)
def test_every_step_has_evidence(key: str) -> None:
    kinds = [evidence.kind for _, evidence in chapter(key).steps()]
    assert kinds
    assert set(kinds) <= {"exact", "sign", "numeric"}


#: Of each chapter every so-manieth step; the others are a campaign. Chapters of few steps are there as a whole.
PIECES = dict.fromkeys(CHAPTERS, 3) | {"domains": 8, "switching": 1, "sticks": 1, "certificates": 4, "events": 5}
PARTS = [(key, part) for key in CHAPTERS for part in range(PIECES[key])]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "part"), [pytest.param(*each, marks=[pytest.mark.campaign] * (each[1] > 0)) for each in PARTS]
)
def test_a_changed_sign_fails(key: str, part: int) -> None:
    _, items = unchecked_items(key)
    steps = [step for item in items for step in steps_of(item)][part :: PIECES[key]]
    untouched = []
    for step in steps:
        changed = list(mutations(step))
        if not changed:
            untouched.append(str(step.statement))
        for wrong in changed:
            with pytest.raises(StepError):
                wrong.verify()
    # What has no sign, such as E_0 = 1 or x' = E_1 of bare letters: a quarter of a chapter, more of a part.
    assert len(untouched) <= (0.25 if PIECES[key] == 1 else 0.4) * len(steps), untouched


@pytest.mark.parametrize("key", KEYS)
def test_committed_latex_is_current(key: str) -> None:
    found = chapter(key)
    path = COMMITTED / document.FRAGMENTS_FOLDER / f"{key}.tex"
    old, new = path.read_text(encoding="utf-8"), document.as_latex(found, Scope(), WholeDocument([]))
    lines = (text.splitlines(keepends=True) for text in (old, new))
    assert old == new, "".join(difflib.unified_diff(*lines, "committed", "printed now")) + ACCEPT


@pytest.mark.slow
def test_committed_document_is_current() -> None:
    chapters = [chapter(key) for key in CHAPTERS]
    assert (COMMITTED / document.MAIN).read_text(encoding="utf-8") == document.main_document(chapters, Scope()), ACCEPT


@pytest.mark.parametrize("key", KEYS)
def test_no_sympy_artefacts(key: str) -> None:
    text = document.as_latex(chapter(key), Scope())
    for artefact in (r"\left(1.0\right)", "1.0 ", r"\limits", "begin{cases}", "cm", "w0sq", "f0", "+ -", "- -", "--"):
        assert artefact not in text.replace("(55)--(58)", ""), artefact


def test_an_undecided_check_fails() -> None:
    x, y = sp.symbols("x y", real=True)
    with pytest.raises(StepError):
        equation(x, y, "", Exact({x: sp.Symbol("z", real=True)})).verify()


def test_each_chapter_has_one_name() -> None:
    assert {path.stem for path in COMMITTED.glob("*.py")} == set(CHAPTERS)
    assert {path.stem for path in (COMMITTED / document.FRAGMENTS_FOLDER).glob("*.tex")} == set(CHAPTERS)
    for key in CHAPTERS:
        assert f'run("{key}")' in (COMMITTED / f"{key}.py").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_script_runs(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(COMMITTED / "switching.py"), run_name="__main__")
    assert capsys.readouterr().out.startswith("4. What happens at a boundary")


@pytest.mark.campaign
@pytest.mark.parametrize("key", ["motion", "domains", "maps", "grazing"])
@pytest.mark.parametrize("scene", SCENES)
def test_every_step_of_a_scene_has_evidence(scene: str, key: str) -> None:
    assert document.check_chapter(key, Scope(load_scene(scene))).steps()


@pytest.mark.slow
@pytest.mark.full(2)
@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_shows_only_what_it_needs(scene: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Step, "verify", lambda step: StepEvidence("exact", "0"))  # only what is printed counts here
    scope = Scope(load_scene(scene))
    for key in ("motion", "domains", "maps", "grazing"):
        found = document.check_chapter(key, scope)
        text = document.as_latex(found, scope)
        if key == "domains":
            assert "tab:domains-regimes" not in text  # one regime
            assert r"\omega_0" not in text
        if key == "maps":
            (table,) = [item for item in found.items if isinstance(item, Table)]
            assert [row[0] for row in table.rows] == [f"$P_{label[1]}$" for label in scope.maps]
            assert "A_0" not in text
            assert "F_N" not in text


@pytest.mark.slow
@pytest.mark.skipif(not pdf.has_latex(), reason="no pdflatex")
def test_latex_takes_it_without_complaint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole command, on chapters that were checked before; a warning, or a box overfull by 5 pt, fails."""
    checked = {key: chapter(key) for key in CHAPTERS}
    monkeypatch.setattr(document, "check_chapter", lambda key, *rest: checked[key])
    result = run("all", "--pdf", "-o", str(tmp_path))
    assert (result.exit_code, result.return_value) == (0, 0), result.output
    assert (tmp_path / document.MAIN).with_suffix(".pdf").stat().st_size > 50_000


def test_complaints_are_found() -> None:
    log = "Overfull \\hbox (12.3pt too wide)\nOverfull \\hbox (1.0pt too wide)\nLaTeX Warning: x\n! Undefined"
    assert len(pdf.complaints_of(log)) == 3


def run(*arguments: str) -> Any:
    return CliRunner().invoke(derive, [*arguments], standalone_mode=False)


@pytest.mark.slow
def test_command(tmp_path: Path) -> None:
    result = run("motion", "-o", str(tmp_path / "new"), "--json")
    assert result.exit_code == 0, result.output
    data = json.loads(result.stdout)
    assert {row["kind"] for row in data["steps"]} == {"exact", "sign"}
    assert all(Path(path).is_file() for path in data["files"])
    for form, suffix in (("markdown", ".md"), ("text", ".txt")):
        assert run("sticks", "-o", str(tmp_path), "--format", form, "--scene", "fig9").exit_code == 0
        text = (tmp_path / f"sticks{suffix}").read_text(encoding="utf-8")
        assert "\\subsection" not in text


def test_without_latex_there_is_no_work_for_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    error = run("all", "--pdf", "-o", str(tmp_path / "derived")).exception
    assert isinstance(error, click.BadParameter)  # exit code 2
    assert "no pdflatex here" in error.message
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_formulas_fit_the_line() -> None:
    for key in CHAPTERS:
        for display in displays.grouped(chapter(key)):
            if not isinstance(display, displays.Display):
                continue
            for rows, _ in displays.rows(display, Scope()):
                assert all(line_breaks.width(row.replace("&", "")) < 1.12 * line_breaks.LINE_WIDTH for row in rows), (
                    rows
                )


@pytest.mark.parametrize("key", KEYS)
def test_what_is_printed_reads_back(key: str) -> None:
    for step, _ in chapter(key).steps():
        if step.statement.op == "in" or step.statement.right.atoms(AppliedUndef):
            continue
        shown = step.statement._replace(
            left=Scope().shown(step.statement.left), right=Scope().shown(step.statement.right)
        )
        left, right = " ".join(line_breaks.lines(shown, step.decimals)).split("&", 1)
        right = re.sub(r"^(?:=|>|<|\\ge|\\le)(?![a-z])", "", right)
        for text, side in ((left, shown.left), (right, shown.right)):
            point = next(points(side, count=1))
            values = {latex.latex(letter): complex(value) for letter, value in point.items()}
            expected = complex(sp.N(side.subs(point, simultaneous=True), 20))
            assert Reader(text, values).value() == pytest.approx(expected, rel=1e-9, abs=1e-9), text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["all", "-o", "file.csv"], "is a file"),
        (["all", "-o", "file.csv/deeper"], "is a file"),
        (["all", "-o", "new.tex"], "named like a file"),
        (["all", "-o", "new.csv"], "named like a file"),
        (["all", "-o", ""], "name of a file"),
        (["all", "-o", "-", "--json"], "standard output"),
        (["all", "-o", "-", "--pdf"], "--pdf"),
        (["all", "--scene", ""], "unknown"),
        (["none"], "none"),
        ([""], "one of"),
    ],
)
def test_bad_input_is_refused_before_the_work(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from symosc.cli.app import main

    monkeypatch.chdir(tmp_path)
    (tmp_path / "file.csv").touch()
    monkeypatch.setattr(Step, "verify", lambda step: pytest.fail("the work has begun"))
    run = CliRunner().invoke(main, ["derive", *arguments])
    assert (run.exit_code, run.stdout) == (2, ""), run.output
    assert message in run.stderr
    assert run.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["file.csv"]


@pytest.mark.slow
def test_a_chapter_goes_to_standard_output() -> None:
    run = CliRunner().invoke(derive, ["sticks", "--format", "text", "-o", "-"])
    assert run.stdout == document.as_text(chapter("sticks"), Scope())
