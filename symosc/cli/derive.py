"""`symosc derive`: derivations, each step checked by machine, as LaTeX, PDF or HTML."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from os.path import exists
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from symosc.aliases import Record
from symosc.cli.output import complain, tell, write_json
from symosc.cli.settings import WholeNumber, complete, complete_scene, goes_to_stdout, read_settings, set_option
from symosc.display.progress import VERBOSE, bar, level
from symosc.errors import OutputError, ParameterError, SymoscError, meant
from symosc.files import write_text

FILES = (".tex", ".pdf", ".txt", ".csv", ".json", ".html")


def _subjects(context: click.Context, argument: click.Parameter, begun: str) -> list[CompletionItem]:
    from symosc.derive.chapters import CHAPTERS
    from symosc.derive.fragments import FRAGMENTS

    return complete(["all", *CHAPTERS, *FRAGMENTS])(context, argument, begun)


@click.command()
@click.argument("subject", shell_complete=_subjects)
@click.option(
    "--scene",
    metavar="SCENE",
    shell_complete=complete_scene,
    help="Put a scene's numbers in; only what the scene needs appears.",
)
@set_option
@click.option(
    "-o",
    "--output",
    metavar="PATH",
    help="Chapters: folder for the files (made if needed), here by default. Fragments: a file. -: print.",
)
@click.option("--pdf", is_flag=True, help="Compile the LaTeX of chapters to derivations.pdf as well.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["latex", "html"]),
    default="latex",
    help="Chapters: LaTeX, or one HTML page. Fragments are LaTeX.",
)
@click.option(
    "--form",
    "motion",
    type=click.Choice(["entire", "paper"]),
    help="Fragments: the motion by functions for all regimes of damping, or by e^(-ct/2m) cos omega_d t.",
)
@click.option("--digits", type=WholeNumber(1, 50), help="Fragments: round numbers to so many digits.")
@click.option("--tags", type=click.Choice(["paper"]), help="Fragments: give equations the paper's numbers.")
@click.option("--prefix", metavar="TEXT", help="Fragments: what labels begin with (default: symosc).")
@click.option("--alone", is_flag=True, help="Fragments: a document of its own.")
@click.option("--json", "as_json", is_flag=True, help="Print every step's check (kind, margin, points) as JSON.")
def derive(subject: str, output: str | None, form: str, as_json: bool, **options: Any) -> int:
    """Derive SUBJECT step by step, checking each step before it is written.

    Chapters: motion, domains, sticks, switching, maps, jacobians, grazing, events, orbits, errata, literature,
    certificates, or all. Fragments for a paper of your own, printed unless -o names a file: P1 to P8, friction,
    flow, stick, gfunctions, saltation, theorem4 to theorem7. A step is checked exactly, by a sign, or with 50
    digits; a step that fails ends with exit code 1 and nothing is written.

    \b
    Examples:
      symosc derive all --pdf -o derived
      symosc derive maps --scene fig9 --format html -o fig9
      symosc derive P3 --form paper --set k=4 --set m=1 --set c=2/5 -o p3.tex
    """
    from symosc.derive.chapters import CHAPTERS
    from symosc.derive.fragments import FRAGMENTS
    from symosc.scenes import load_scene

    if subject != "all" and subject not in CHAPTERS and subject not in FRAGMENTS:
        raise ParameterError("subject", subject, _unknown(subject, ["all", *CHAPTERS], list(FRAGMENTS)))
    of_fragments = {"set": options["settings"], "form": options["motion"], "digits": options["digits"]}
    of_fragments |= {name: options[name] for name in ("tags", "prefix", "alone")}
    scene = options["scene"]
    if subject in FRAGMENTS:
        if options["pdf"] or form == "html":
            raise click.BadParameter("is for chapters", param_hint="--pdf" if options["pdf"] else "--format html")
        problem = None if scene is None else load_scene(scene)
        return _fragment(subject, problem, output, as_json, options)
    for name, value in of_fragments.items():
        if value:
            raise click.BadParameter(f"is for fragments ({', '.join(FRAGMENTS)})", param_hint=f"--{name}")
    return _chapters(subject, scene, output, form, as_json, options["pdf"])


def _unknown(subject: str, chapters: list[str], fragments: list[str]) -> str:
    known = f"must be one of {', '.join(chapters)} (chapters) or {', '.join(fragments)} (fragments)"
    return known + meant(subject, [*chapters, *fragments])


def _fragment(name: str, scene: Any, output: str | None, as_json: bool, options: dict[str, Any]) -> int:
    from symosc.derive import fragments
    from symosc.derive.scope import fragment_scope
    from symosc.derive.steps import StepError

    printed = goes_to_stdout(output, "--output", as_json) or output is None
    settings = read_settings(options["settings"])
    scope = fragment_scope(settings, scene, options["motion"] or "entire", options["digits"])
    try:
        fragment = fragments.check_fragment(name, scope)
    except StepError as error:
        complain(f"check failed: {error}")
        return 1
    prefix = fragments.PREFIX if options["prefix"] is None else options["prefix"]
    text = fragments.as_latex(fragment, scope, prefix, options["tags"] == "paper", options["alone"])
    if as_json:
        write_json({"fragment": name, "text": text, "steps": fragment.log()})
    elif printed:
        click.echo(text, nl=False)
    if output is not None and not printed:
        path = write_text(Path(output), text)
        if not as_json:
            click.echo(str(path))
    return 0


def _chapters(subject: str, scene: str | None, output: str | None, form: str, as_json: bool, pdf: bool) -> int:
    printed = goes_to_stdout(output, "--output", as_json)
    from symosc.derive import document
    from symosc.derive.steps import StepError
    from symosc.scenes import load_scene

    if pdf and (form != "latex" or printed):
        raise click.BadParameter("needs --format latex and a folder", param_hint="--pdf")
    if pdf and not _has_latex():
        raise click.BadParameter("there is no pdflatex here (Debian: texlive-latex-base)", param_hint="--pdf")
    folder = Path(output or ".")
    _check_folder(folder)
    problem = None if scene is None else load_scene(scene)
    try:
        with _bars() as progress:
            scope, chapters = document.build([subject], problem, progress)
    except StepError as error:
        complain(f"check failed: {error}")
        return 1
    if printed:
        click.echo(document.printed(chapters, scope, form), nl=False)
        return 0
    paths = document.write_document(chapters, scope, folder, form)
    status = 0
    if pdf:
        status = _compile(folder, paths)
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


def _has_latex() -> bool:
    from symosc.derive import pdf

    return pdf.has_latex()


def _compile(folder: Path, paths: list[Path]) -> int:
    from symosc.derive import pdf
    from symosc.derive.document import MAIN

    try:
        paths.insert(0, pdf.make_pdf(folder / MAIN))
    except SymoscError as error:
        complain(f"{error}")
        return 1
    return 0


@contextmanager
def _bars() -> Iterator[Callable[[str, int, int], None]]:
    """Show a bar for each subject, one after the other; yield what is told how far one is."""
    with ExitStack() as stack:
        shown: dict[str, Callable[[float, float], None]] = {}

        def progress(subject: str, done: int, count: int) -> None:
            if subject not in shown:
                stack.close()
                shown[subject] = stack.enter_context(bar(subject, count))
            shown[subject](done, count)
            if done == count and level() == VERBOSE:
                tell(f"{subject}: {count} steps checked")

        yield progress


def _log(chapters: list[Any], scene: Any, paths: list[Path]) -> Record:
    steps = [{"subject": chapter.key, **row} for chapter in chapters for row in chapter.log()]
    return {"scene": scene.name if scene else None, "files": [str(path) for path in paths], "steps": steps}


def _summary(chapters: list[Any]) -> str:
    kinds = [evidence.kind for chapter in chapters for _, evidence in chapter.steps()]
    parts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in ("exact", "sign", "numeric") if kind in kinds)
    return f"{len(kinds)} steps checked: {parts}"
