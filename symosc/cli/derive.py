"""`symosc derive` and `symosc codegen`: derivations with every step checked, and code printed from
them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from os.path import exists
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from symosc.base.aliases import Record
from symosc.base.display.progress import VERBOSE, bar
from symosc.base.errors import OutputError, ParameterError, SymoscError, meant
from symosc.base.files import STDOUT, check_new_folder, write_text
from symosc.cli import options, output
from symosc.cli.options import Text, flag, option
from symosc.derive.chapters import CHAPTERS
from symosc.scenes import Scene, load_scene, parameters_of
from symosc.symbolic.export import LANGUAGES

FORMATS: Record = {"type": click.Choice(["latex", "html"]), "default": "latex"}
FILES = (".tex", ".pdf", ".txt", ".csv", ".json", ".html")


def subjects() -> list[str]:
    """Return the names of all chapters and fragments."""
    from symosc.derive.fragments import FRAGMENTS

    return ["all", *CHAPTERS, *FRAGMENTS]


HELP = f"""Derive SUBJECT step by step, checking each step before it is written.

Chapters: {", ".join(CHAPTERS)}, or all. Fragments for a paper of your own, printed unless -o names a file: P1 to P8,
friction, flow, stick, gfunctions, saltation, theorem4 to theorem7. A step is checked exactly, by a sign, or with 50
digits; a step that fails ends with exit code 1 and nothing is written.

\b
Examples:
  symosc derive all --pdf -o derived
  symosc derive maps --scene fig9 --format html -o fig9
  symosc derive P3 --form paper --set k=4 --set m=1 --set c=2/5 -o p3.tex
"""


@click.command(help=HELP)
@click.argument("subject", shell_complete=options.complete(subjects))
@option("--scene SCENE", "Put a scene's numbers in; only what the scene needs appears.")
@options.set_option
@option(
    "-o, --output PATH",
    "Chapters: folder for the files (made if needed), here by default. Fragments: a file. -: "
    "print.",
    "path",
)
@flag("--pdf", "Compile the LaTeX of chapters to derivations.pdf as well.")
@option("--format", "Chapters: LaTeX, or one HTML page. Fragments are LaTeX.", **FORMATS)
@option(
    "--form",
    "Fragments: the motion by functions for all regimes of damping, or by e^(-ct/2m) cos omega_d "
    "t.",
    type=click.Choice(["entire", "paper"]),
)
@option("--digits", "Fragments: round numbers to so many digits.", type=options.WholeNumber(1, 50))
@option("--tags", "Fragments: give equations the paper's numbers.", type=click.Choice(["paper"]))
@option("--prefix TEXT", "Fragments: what labels begin with (default: symosc).")
@flag("--alone", "Fragments: a document of its own.")
@options.json_option
def derive(
    subject: str, scene: Text, path: Text, pdf: bool, format: str, **of_fragments: Any
) -> int:
    """Derive a chapter, all chapters or a fragment, and write or print it.

    `of_fragments` are the options that only fragments have.
    """
    from symosc.derive.fragments import FRAGMENTS

    if subject not in subjects():
        allowed = (
            f'must be "all", a chapter ({", ".join(CHAPTERS)}) or a fragment '
            f"({', '.join(FRAGMENTS)})"
        )
        raise ParameterError("subject", subject, allowed + meant(subject, subjects()))
    if subject in FRAGMENTS:
        if pdf or format == "html":
            raise click.BadParameter(
                "is for chapters", param_hint="--pdf" if pdf else "--format html"
            )
        return _print_fragment(subject, scene, path, **of_fragments)
    for name, value in of_fragments.items():
        if value:
            if name == "settings":
                option_name = "--set"
            else:
                option_name = f"--{name}"
            raise click.BadParameter(
                f"is for fragments ({', '.join(FRAGMENTS)})", param_hint=option_name
            )
    return _write_chapters(subject, scene, path, format, pdf)


def _problem(scene: Text) -> Scene | None:
    """Return the scene with this name or file, as one of the paper's two belts."""
    if scene is None:
        return None
    problem = load_scene(scene)
    # Chapters and fragments have letters for two belts with kinetic friction.
    parameters = parameters_of(problem)
    if parameters == problem.parameters:
        return problem
    return replace(problem, parameters=parameters)


def _print_fragment(
    name: str,
    scene: Text,
    path: Text,
    settings: options.Settings,
    form: Text,
    digits: int | None,
    tags: Text,
    prefix: Text,
    alone: bool,
) -> int:
    """Check a fragment, then print it or write it to the file `path`; return the exit code."""
    from symosc.derive import fragments
    from symosc.derive.scope import fragment_scope
    from symosc.derive.steps import StepError

    numbers = options.read_settings(settings)
    problem = _problem(scene)
    scope = fragment_scope(numbers, problem, form or "entire", digits)
    with output.failing(StepError, "check failed: "):
        fragment = fragments.check_fragment(name, scope)
    if prefix is None:
        label = fragments.PREFIX
    else:
        label = prefix
    text = fragments.as_latex(fragment, scope, label, tags == "paper", alone)
    if path == STDOUT:
        output.write(text, end="")
    elif path is not None:
        write_text(Path(path), text)
    data = {"fragment": name, "text": text, "steps": fragment.log()}
    if path is None:
        show = partial(output.write, text, end="")
    else:  # the name of the file; nothing for standard output, see `output.report`
        show = partial(output.write, str(Path(path)))
    output.report(lambda: data, show)
    return 0


def _write_chapters(subject: str, scene: Text, path: Text, form: str, pdf: bool) -> int:
    """Check one chapter or all of them, then print them or write them to the folder `path`; return
    the exit code.
    """
    from symosc.derive import document
    from symosc.derive.scope import Scope
    from symosc.derive.steps import StepError

    if pdf and (form != "latex" or path == STDOUT):
        raise click.BadParameter("needs --format latex and a folder", param_hint="--pdf")
    if pdf and not document.has_latex():
        raise click.BadParameter(
            "there is no pdflatex here (Debian: texlive-latex-base)", param_hint="--pdf"
        )
    folder = Path(path or ".")
    check_new_folder(folder, "--output names a folder")  # before the work, which may take minutes
    if folder.suffix.lower() in FILES and not exists(folder):
        raise OutputError(str(folder), "is named like a file, and --output names a folder")
    problem = _problem(scene)
    if subject == "all":
        keys = [*CHAPTERS]
    else:
        keys = [subject]
    scope = Scope(problem)
    with output.failing(StepError, "check failed: "), _bars() as progress:
        chapters = [document.check_chapter(key, scope, progress) for key in keys]
    if path == STDOUT:
        output.write(document.printed(chapters, scope, form), end="")
        return 0
    paths = document.write_document(chapters, scope, folder, form)
    status = 0
    if pdf:  # if it fails, the LaTeX is there all the same
        try:
            paths.insert(0, document.make_pdf(folder / document.MAIN))
        except SymoscError as error:
            output.complain(f"{error}")
            status = output.FAILED
    kinds = [evidence.kind for chapter in chapters for _, evidence in chapter.steps()]
    counts = ", ".join(
        f"{kinds.count(kind)} {kind}" for kind in ("exact", "sign", "numeric") if kind in kinds
    )
    names = list(map(str, paths))
    steps = [{"subject": chapter.key, **row} for chapter in chapters for row in chapter.log()]
    data = {"scene": problem.name if problem else None, "files": names, "steps": steps}
    lines = [f"{len(kinds)} steps checked: {counts}", *names]
    output.report(lambda: data, lambda: output.write("\n".join(lines)))
    return status


@contextmanager
def _bars() -> Iterator[Callable[[str, int, int], None]]:
    """Show a progress bar per subject.

    Yield the callback that takes a subject, the steps done and their total.
    """
    with ExitStack() as stack:
        shown: dict[str, Callable[[float, float], None]] = {}

        def progress(subject: str, done: int, count: int) -> None:
            if subject not in shown:
                stack.close()  # ends the bar of the subject before
                shown[subject] = stack.enter_context(bar(subject, count))
            shown[subject](done, count)
            if done == count:
                output.note(f"{subject}: {count} steps checked", VERBOSE)

        yield progress


@click.command()
@click.argument("word", required=False)
@flag("--check", "Without WORD: compare symosc's own kernels; exit code 1 if they differ.")
@flag("--regenerate", "Without WORD: write symosc's own kernels anew.")
@option(
    "-l, --language",
    "What to write.",
    type=click.Choice(LANGUAGES),
    default="python",
    show_default=True,
)
@option("--name", "Base of the file names, and of the names in C. Default: from the word.")
@option(
    "-o, --output FOLDER",
    "Where to write; made if needed. Default: here. '-': print.",
    "folder",
    default=".",
)
@flag("--force", "Replace files that have another content.")
@options.json_option
@click.pass_context
def codegen(
    ctx: click.Context, /, word: Text, check: bool, regenerate: bool, **of_word: Any
) -> int:
    """Write a mapping structure's residual and Jacobian for your own program.

    WORD is read right to left, like P32. The file needs nothing of symosc: Python with math, Python
    with NumPy, or C99 with a header. It has the maps of the word only. A file that is there with
    another content stays, unless --force is given.

    Without WORD it is about the kernels that symosc itself runs, symosc/kernels/_generated.py,
    which are printed from the formulas that sympy derives: --check compares them, --regenerate
    writes them.

    \b
    Examples:
      symosc codegen P32 --language c
      symosc codegen P4645 --language numpy -o - > p4645.py
      symosc codegen --check
    """
    if word is not None:
        if check:
            flag_name = "--check"
        else:
            flag_name = "--regenerate"
        options.refuse(
            (check or regenerate, f"{flag_name} is about symosc's own kernels; leave WORD out")
        )
        return _export_code(word, **of_word)
    # The options on the command line that only a word has.
    options_for_words = [
        max(parameter.opts, key=len)
        for parameter in ctx.command.params
        if parameter.name not in ("check", "regenerate")
        and ctx.get_parameter_source(str(parameter.name)) is ParameterSource.COMMANDLINE
    ]
    if check:
        advice = "not both"
    else:
        advice = "or a WORD, such as P32"
    options.refuse(
        (options_for_words, f"{', '.join(options_for_words)} needs a WORD, such as P32"),
        (check == regenerate, f"give --check or --regenerate, {advice}"),
    )
    return _kernels(regenerate)


def _export_code(word: str, language: str, name: Text, folder: str, force: bool) -> int:
    """Print the program of a word, or write it to a folder; return the exit code."""
    from symosc.symbolic.export import export, write_export

    options.refuse((folder == STDOUT and force, "--force is about files; leave it out with -o -"))
    if folder == STDOUT:
        output.write("\n".join(export(word, language, name).values()), end="")
        return 0
    paths = write_export(folder, word, language, name, force=force)
    output.report(lambda: list(map(str, paths)), lambda: output.name_files(*paths))
    return 0


def _kernels(regenerate: bool) -> int:
    """Write the file of symosc's own kernels (`regenerate`), or check that it is what sympy's
    formulas give.
    """
    from symosc.symbolic import codegen as generator

    if regenerate:
        output.name_files(generator.write())
        return 0
    difference = generator.check()
    if difference:
        output.write(difference)
        output.fail(
            "the committed kernels differ from the generated ones; accept: symosc codegen "
            "--regenerate"
        )
    output.write(f"{Path(generator.PATH).name} is what the formulas print")
    return 0
