"""`symosc derive` and `symosc codegen`: derivations with every step checked, and code printed from them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from os.path import exists
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource
from click.shell_completion import CompletionItem

from symosc.cli.common import (
    FAILED,
    WholeNumber,
    complain,
    complete,
    complete_scene,
    goes_to_stdout,
    json_option,
    note,
    read_settings,
    set_option,
    write,
    write_json,
    wrote,
)
from symosc.derive.chapters import CHAPTERS
from symosc.display.progress import VERBOSE, bar, level
from symosc.errors import OutputError, ParameterError, SymoscError, meant
from symosc.files import check_new_folder, write_text
from symosc.symbolic.export import LANGUAGES

FILES = (".tex", ".pdf", ".txt", ".csv", ".json", ".html")


def _subjects(context: click.Context, argument: click.Parameter, begun: str) -> list[CompletionItem]:
    from symosc.derive.fragments import FRAGMENTS

    return complete(["all", *CHAPTERS, *FRAGMENTS])(context, argument, begun)


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
@json_option
def derive(subject: str, output: str | None, form: str, as_json: bool, **options: Any) -> int:
    """Derive SUBJECT; see `HELP`."""
    from symosc.derive.fragments import FRAGMENTS
    from symosc.scenes import load_scene

    if subject != "all" and subject not in CHAPTERS and subject not in FRAGMENTS:
        known = f"must be one of all, {', '.join(CHAPTERS)} (chapters) or {', '.join(FRAGMENTS)} (fragments)"
        raise ParameterError("subject", subject, known + meant(subject, ["all", *CHAPTERS, *FRAGMENTS]))
    of_fragments = {"set": options["settings"], "form": options["motion"], "digits": options["digits"]}
    of_fragments |= {name: options[name] for name in ("tags", "prefix", "alone")}
    scene = options["scene"]
    if subject in FRAGMENTS:
        if options["pdf"] or form == "html":
            raise click.BadParameter("is for chapters", param_hint="--pdf" if options["pdf"] else "--format html")
        problem = None if scene is None else load_scene(scene)
        return _print_fragment(subject, problem, output, as_json, options)
    for name, value in of_fragments.items():
        if value:
            raise click.BadParameter(f"is for fragments ({', '.join(FRAGMENTS)})", param_hint=f"--{name}")
    return _write_chapters(subject, scene, output, form, as_json, options["pdf"])


def _print_fragment(name: str, scene: Any, output: str | None, as_json: bool, options: dict[str, Any]) -> int:
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
        return FAILED
    prefix = fragments.PREFIX if options["prefix"] is None else options["prefix"]
    text = fragments.as_latex(fragment, scope, prefix, options["tags"] == "paper", options["alone"])
    if as_json:
        write_json({"fragment": name, "text": text, "steps": fragment.log()})
    elif printed:
        write(text, end="")
    if output is not None and not printed:
        path = write_text(Path(output), text)
        if not as_json:
            write(str(path))
    return 0


def _write_chapters(subject: str, scene: str | None, output: str | None, form: str, as_json: bool, pdf: bool) -> int:
    printed = goes_to_stdout(output, "--output", as_json)
    from symosc.derive import document
    from symosc.derive.pdf import has_latex, make_pdf
    from symosc.derive.steps import StepError
    from symosc.scenes import load_scene

    if pdf and (form != "latex" or printed):
        raise click.BadParameter("needs --format latex and a folder", param_hint="--pdf")
    if pdf and not has_latex():
        raise click.BadParameter("there is no pdflatex here (Debian: texlive-latex-base)", param_hint="--pdf")
    folder = Path(output or ".")
    _check_folder(folder)
    problem = None if scene is None else load_scene(scene)
    try:
        with _bars() as progress:
            scope, chapters = document.build([subject], problem, progress)
    except StepError as error:
        complain(f"check failed: {error}")
        return FAILED
    if printed:
        write(document.printed(chapters, scope, form), end="")
        return 0
    paths = document.write_document(chapters, scope, folder, form)
    status = 0
    if pdf:
        try:
            paths.insert(0, make_pdf(folder / document.MAIN))
        except SymoscError as error:
            complain(f"{error}")
            status = FAILED
    if as_json:
        steps = [{"subject": chapter.key, **row} for chapter in chapters for row in chapter.log()]
        named = problem.name if problem else None
        write_json({"scene": named, "files": [str(path) for path in paths], "steps": steps})
    else:
        kinds = [evidence.kind for chapter in chapters for _, evidence in chapter.steps()]
        parts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in ("exact", "sign", "numeric") if kind in kinds)
        write(f"{len(kinds)} steps checked: {parts}")
        for path in paths:
            write(str(path))
    return status


def _check_folder(folder: Path) -> None:
    """Refuse what is not a folder before the work, which may take minutes."""
    check_new_folder(folder, "--output names a folder")
    if folder.suffix.lower() in FILES and not exists(folder):
        raise OutputError(str(folder), "is named like a file, and --output names a folder")


@contextmanager
def _bars() -> Iterator[Callable[[str, int, int], None]]:
    """Show a bar for each subject, one after the other; yield the progress callback."""
    with ExitStack() as stack:
        shown: dict[str, Callable[[float, float], None]] = {}

        def progress(subject: str, done: int, count: int) -> None:
            if subject not in shown:
                stack.close()
                shown[subject] = stack.enter_context(bar(subject, count))
            shown[subject](done, count)
            if done == count and level() == VERBOSE:
                note(f"{subject}: {count} steps checked")

        yield progress


@click.command()
@click.argument("word", required=False)
@click.option("--check", is_flag=True, help="Without WORD: compare symosc's own kernels; exit code 1 if they differ.")
@click.option("--regenerate", is_flag=True, help="Without WORD: write symosc's own kernels anew.")
@click.option(
    "--language", "-l", type=click.Choice(LANGUAGES), default="python", show_default=True, help="What to write."
)
@click.option(
    "--fix",
    metavar="SCENE",
    shell_complete=complete_scene,
    help="Fold the parameters of a scene in and drop what that leaves unused.",
)
@click.option("--name", help="Base of the file names, and of the names in C and Julia. Default: from the word.")
@click.option(
    "-o", "--output", metavar="FOLDER", default=".", help="Where to write; made if needed. Default: here. '-': print."
)
@click.option("--force", is_flag=True, help="Replace files that have another content.")
@json_option
@click.pass_context
def codegen(ctx: click.Context, /, word: str | None, check: bool, regenerate: bool, **options: Any) -> int:
    """Write a mapping structure's residual and Jacobian for your own program.

    WORD is read right to left, like P32. The file needs nothing of symosc: Python with math, Python with NumPy, C99
    with a header, or Julia. It has the maps of the word only. A file that is there with another content stays, unless
    --force is given.

    Without WORD it is about the kernels that symosc itself runs, symosc/kernels/_generated.py, which are printed from
    the formulas that sympy derives: --check compares them, --regenerate writes them.

    \b
    Examples:
      symosc codegen P32 --language c --fix fig9
      symosc codegen P4645 --language julia -o - > p4645.jl
      symosc codegen --check
    """
    if word is not None:
        if check or regenerate:
            flag = "--check" if check else "--regenerate"
            raise click.UsageError(f"{flag} is about symosc's own kernels; leave WORD out")
        return _export_code(word, **options)
    given = [name for name in options if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE]
    if given:
        names = {parameter.name: max(parameter.opts, key=len) for parameter in ctx.command.params}
        raise click.UsageError(f"{', '.join(names[name] for name in given)} needs a WORD, such as P32")
    if check == regenerate:
        either = "not both" if check else "or a WORD, such as P32"
        raise click.UsageError(f"give --check or --regenerate, {either}")
    return _kernels(regenerate)


def _export_code(
    word: str, language: str, fix: str | None, name: str | None, output: str, force: bool, as_json: bool
) -> int:
    from symosc.scenes import load_scene
    from symosc.symbolic.export import export, write_export

    printed = goes_to_stdout(output, "--output", as_json)
    if printed and force:
        raise click.UsageError("--force is about files; leave it out with -o -")
    parameters = None if fix is None else load_scene(fix).parameters
    if printed:
        write("\n".join(export(word, language, parameters, name).values()), end="")
        return 0
    paths = [str(path) for path in write_export(output, word, language, parameters, name, force=force)]
    if as_json:
        write_json(paths)
    else:
        write("\n".join(map(wrote, paths)))
    return 0


def _kernels(regenerate: bool) -> int:
    """Write symosc's own kernels, or compare them with what the formulas print."""
    from symosc.symbolic import codegen as generator

    if regenerate:
        write(wrote(generator.write()))
        return 0
    difference = generator.check()
    if difference:
        write(difference)
        complain("the committed kernels differ from the generated ones; accept: symosc codegen --regenerate")
        return FAILED
    write(f"{Path(generator.PATH).name} is what the formulas print")
    return 0
