"""`symosc derive`: derivations, each step checked by machine, as LaTeX, PDF, Markdown or text."""

from __future__ import annotations

import json
import os
import sys
from os.path import exists
from pathlib import Path
from typing import Any

import click

from symosc.aliases import Record
from symosc.cli.settings import goes_to_stdout
from symosc.errors import OutputError, SymoscError

NO_LATEX = "symosc: no pdflatex here; install LaTeX (Debian: texlive-latex-base), then: cd {folder} && pdflatex {file}"

FILES = (".tex", ".pdf", ".md", ".txt", ".csv", ".json", ".html")


@click.command()
@click.argument("subject")
@click.option("--scene", metavar="SCENE", help="Put a scene's numbers in; only what the scene needs appears.")
@click.option(
    "-o", "--output", metavar="DIR", help="Folder for the files (made if needed); here by default. -: print them."
)
@click.option("--pdf", is_flag=True, help="Compile the LaTeX to derivations.pdf as well.")
@click.option(
    "--format", "form", type=click.Choice(["latex", "markdown", "text"]), default="latex", help="What to write."
)
@click.option("--json", "as_json", is_flag=True, help="Print every step's check (kind, margin, points) as JSON.")
def derive(subject: str, scene: str | None, output: str | None, pdf: bool, form: str, as_json: bool) -> int:
    """Derive SUBJECT step by step, checking each step before it is written.

    Subjects: motion, domains, sticks, switching, maps, jacobians, grazing, events, orbits, errata, or all. A step is
    checked exactly, by a sign, or with 50 digits at a root; a step that fails ends with exit code 1 and nothing
    is written.

    \b
    Examples:
      symosc derive all --pdf -o derived
      symosc derive maps --scene fig9 --format text -o fig9
    """
    printed = goes_to_stdout(output, "--output", as_json)
    from symosc.derive import document
    from symosc.derive.steps import StepError
    from symosc.scenes import load_scene

    if pdf and (form != "latex" or printed):
        raise click.BadParameter("needs --format latex and a folder", param_hint="--pdf")
    folder = Path(output or ".")
    _check_folder(folder)
    problem = None if scene is None else load_scene(scene)
    try:
        scope, chapters = document.build([subject], problem, _progress)
    except StepError as error:
        click.echo(f"\nsymosc: check failed: {error}", err=True)
        return 1
    if printed:
        click.echo("\n".join(document.FORMATS[form](chapter, scope) for chapter in chapters), nl=False)
        return 0
    paths = document.write_document(chapters, scope, folder, form)
    status = 0
    if pdf:
        status = _compile(document, folder, paths)
    if as_json:
        click.echo(json.dumps(_log(chapters, problem, paths), indent=1))
    else:
        click.echo(_summary(chapters))
        for path in paths:
            click.echo(str(path))
    return status


def _check_folder(folder: Path) -> None:
    """Refuse what is not a folder before the work, which may take minutes."""
    above = next(each for each in (folder, *folder.absolute().parents) if exists(each))
    if not above.is_dir():
        reason = f"{above} is a file, and --output names a folder"
    elif not os.access(above, os.W_OK):
        reason = "Permission denied"
    elif folder.suffix.lower() in FILES and not exists(folder):
        reason = "is named like a file, and --output names a folder"
    else:
        return
    raise OutputError(str(folder), reason)


def _compile(document: Any, folder: Path, paths: list[Path]) -> int:
    if not document.has_latex():
        click.echo(NO_LATEX.format(folder=folder, file=document.MAIN), err=True)
        return 0
    try:
        paths.insert(0, document.make_pdf(folder))
    except SymoscError as error:
        click.echo(f"symosc: {error}", err=True)
        return 1
    return 0


def _progress(subject: str, done: int, count: int) -> None:
    if sys.stderr.isatty():
        click.echo(f"\r{subject}: {done}/{count} steps\033[K", err=True, nl=done == count)
    elif done == count:
        click.echo(f"{subject}: {count} steps checked", err=True)


def _log(chapters: list[Any], scene: Any, paths: list[Path]) -> Record:
    steps = [{"subject": chapter.key, **row} for chapter in chapters for row in chapter.log()]
    return {"scene": scene.name if scene else None, "files": [str(path) for path in paths], "steps": steps}


def _summary(chapters: list[Any]) -> str:
    kinds = [evidence.kind for chapter in chapters for _, evidence in chapter.steps()]
    parts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in ("exact", "sign", "numeric") if kind in kinds)
    return f"{len(kinds)} steps checked: {parts}"
