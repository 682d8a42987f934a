"""Names that a user chose: typeset letter by letter, and never read by TeX as commands or files."""

from __future__ import annotations

import contextlib
import html
import re
import shutil
import subprocess
import tempfile
import unicodedata
from contextlib import suppress
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from cli_runs import run

from symosc import load_scene
from symosc.base.display.latex import latex_text
from symosc.base.errors import SymoscError
from symosc.derive import document, front
from symosc.derive.mathml import words
from symosc.derive.scope import Scope
from symosc.plot.drawing import shown_name
from symosc.scenes import Scene

needs_latex = pytest.mark.skipif(not document.has_latex(), reason="no pdflatex")
P = load_scene("fig9").parameters
SPECIAL = r"_ & % # } { ^ ~ \ $ < > -- ``a'' \\ % comment"
#: Names, and what a PDF or a page shows of them.
NAMES = {
    SPECIAL: SPECIAL,
    r"x\input{FILE}": r"x\input{FILE}",
    r"}\input{FILE}{": r"}\input{FILE}{",
    r"\immediate\write18{touch pwned}": r"\immediate\write18{touch pwned}",
    r"\ref{eq:motion-newton} \cite{chen2016}": r"\ref{eq:motion-newton} \cite{chen2016}",
    "^^5cinput ^^M": "^^5cinput ^^M",
    "Größe": "Größe",
    "量 α": r"量 α",
    "a\nb\tc": "a b c",
    "half \ud800, null \0": r"half \ud800, null \x00",
    "$\\frac{1}{": "$\\frac{1}{",
}


def scope(name: str) -> Scope:
    return Scope(Scene(name, P, t0=0, x0=0, v0=0, t_end=3, structure="P32"))


def secret(folder: Path) -> Path:
    """Return the path of a file whose text may stand in no document."""
    path = folder / "secret.tex"
    path.write_text("SECRET")
    return path


def compiled(text: str, folder: Path) -> Path:
    main = folder / document.MAIN
    main.write_text(text, encoding="utf-8")
    return document.make_pdf(main)


@pytest.mark.parametrize("name", NAMES)
def test_no_letter_of_a_name_is_a_command(name: str) -> None:
    """What is left without the commands for single letters has no character that TeX reads as anything but a letter."""
    text = re.sub(r"\\symbol\{\d+\}|\\letter\{\d+\}\{\w+\}", "", latex_text(name))
    assert not re.search(r"[\\{}$&#^_%~<>`'\"]|--|[^\x20-\x7e\xc0-\xff]", text), text


@pytest.mark.parametrize("name", NAMES)
def test_a_page_shows_the_name(name: str) -> None:
    shown = words(rf"Scene \texttt{{{latex_text(name)}}}, with $m = 1$")
    assert f"<code>{html.escape(NAMES[name], quote=False)}</code>" in shown
    assert shown.startswith("Scene <code>")
    assert "<math" in shown


@needs_latex
@pytest.mark.slow
def test_a_document_shows_the_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names = [name.replace("FILE", secret(tmp_path).name) for name in NAMES]
    lines = [front.scene_numbers(scope(name)) for name in names]
    text = front.PREAMBLE + "\n\\begin{document}\n" + "\n\n".join(lines) + "\n\\end{document}\n"
    pdf = compiled(text, tmp_path)
    if reader := shutil.which("pdftotext"):
        shown = subprocess.run(
            [reader, "-raw", str(pdf), "-"], capture_output=True, text=True, check=True
        ).stdout
        # The font puts the dots above the letter, which a reader may say in two characters.
        shown = re.sub(r"\s", "", unicodedata.normalize("NFC", shown))
        assert "SECRET" not in shown
        for name in names:
            if name.isascii() and name.isprintable() and "`" not in name:
                assert re.sub(r"\s", "", name) in shown, name
        assert "Größe" in shown
        assert r"\u91cf\u03b1" in shown
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        document.MAIN[:-3] + "pdf",
        document.MAIN,
        "secret.tex",
    ]


@needs_latex
@pytest.mark.slow
@pytest.mark.parametrize(
    "command", [r"\input{FILE}", r"\openin5=FILE \read5 to\a \a", r"\input{../secret.tex}"]
)
def test_tex_reads_no_file_of_others(command: str, tmp_path: Path) -> None:
    folder = tmp_path / "document"
    folder.mkdir()
    command = command.replace("FILE", str(secret(tmp_path)))
    text = "\\documentclass{article}\\begin{document}x " + command + "\\end{document}"
    with suppress(SymoscError):
        pdf = compiled(text, folder)
        assert "SECRET" not in pdf.read_text("latin-1")
        if reader := shutil.which("pdftotext"):
            shown = subprocess.run(
                [reader, str(pdf), "-"], capture_output=True, text=True, check=True
            ).stdout
            assert "SECRET" not in shown


@needs_latex
@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        r"\immediate\write18{touch FILE}",
        r"\input{|touch FILE}",
        r"\immediate\openout5=FILE \immediate\write5{x}",
    ],
)
def test_tex_runs_no_shell_and_writes_no_file_of_others(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("shell_escape", "t")
    monkeypatch.setenv("openin_any", "a")
    monkeypatch.setenv("openout_any", "a")
    folder = tmp_path / "document"
    made = tmp_path / "made.txt"
    folder.mkdir()
    text = (
        "\\documentclass{article}\\begin{document}x "
        + command.replace("FILE", str(made))
        + "\\end{document}"
    )
    with contextlib.suppress(SymoscError):
        compiled(text, folder)
    assert not made.exists()


@needs_latex
@pytest.mark.slow
def test_a_scene_file_with_a_hostile_name(tmp_path: Path) -> None:
    """The example of an audit, from the scene's file to the PDF."""
    scene = run("scenes", "fig9").stdout
    folder = Path(tempfile.mkdtemp())  # with a short name: long ones are cut
    name = rf"x\input{{{secret(folder)}}} _&%#}}^~\\"
    scene = re.sub(r"(?m)^name = .*$", lambda _: f"name = '''{name}'''", scene)
    assert "'''" in scene
    (tmp_path / "hostile.toml").write_text(scene, encoding="utf-8")
    result = run(
        "derive",
        "orbits",
        "--scene",
        str(tmp_path / "hostile.toml"),
        "--pdf",
        "-o",
        str(tmp_path / "out"),
    )
    assert result.exit_code == 0, result.stderr
    texts = [path.read_text(encoding="utf-8") for path in (tmp_path / "out").rglob("*.tex")]
    assert not any(r"\input{" + str(folder) in text for text in texts)
    if reader := shutil.which("pdftotext"):
        pdf = tmp_path / "out" / "derivations.pdf"
        shown = subprocess.run(
            [reader, "-raw", str(pdf), "-"], capture_output=True, text=True, check=True
        ).stdout
        assert "SECRET" not in shown
        assert re.sub(r"\s", "", name) in re.sub(r"\s", "", shown)
    shutil.rmtree(folder)


@pytest.mark.parametrize("name", [*NAMES, "a$b$c", "$", "$x_{$"])
def test_a_name_in_a_figure_is_no_formula(name: str) -> None:
    drawing, ax = plt.subplots()
    text = ax.set_title(shown_name(name))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(text, "get_usetex", lambda: False)
        shown, is_formula = text._preprocess_math(text.get_text())
    plt.close(drawing)
    assert not is_formula
    assert shown == NAMES.get(name, name)


def test_a_name_in_a_figure_that_tex_draws() -> None:
    with plt.rc_context({"text.usetex": True}):
        assert shown_name(r"x\input{y}") == r"\texttt{" + latex_text(r"x\input{y}") + "}"
        assert shown_name("量") == r"\texttt{\symbol{92}{u91cf}}"
