"""`symosc check`, `cases` and `score`: judge solutions of a scene, and solvers on all reference cases."""

from __future__ import annotations

from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from symosc.aliases import Record
from symosc.cli.common import (
    WholeNumber,
    check_picture,
    complete_scene,
    folder_name,
    goes_to_stdout,
    json_option,
    scene_with,
    set_option,
    split_setting,
    write,
    write_json,
    write_table,
)
from symosc.display.progress import bar
from symosc.exact import read_exact

if TYPE_CHECKING:
    from symosc.scenes import Scene

COLUMN_NAMES = ("t", "x", "v", "id")


def _split_columns(text: str | None) -> dict[str, str]:
    names: dict[str, str] = {}
    for part in () if text is None else text.split(","):
        form = "t=NAME, x=NAME, v=NAME or id=NAME"
        name, column = (each.strip() for each in split_setting(part, "--columns", form))
        if name not in COLUMN_NAMES or not column:
            raise click.BadParameter(f"{part!r} is not {form}", param_hint="--columns")
        if name in names:
            raise click.BadParameter(f"{name} is given twice", param_hint="--columns")
        names[name] = column
    return names


@click.command()
@click.argument("files", nargs=-1, shell_complete=complete_scene)
@click.option(
    "--scene",
    metavar="SCENE",
    shell_complete=complete_scene,
    help="Name of a scene or path of a TOML file, if it is not the first word.",
)
@click.option("--case", metavar="NAME", help="A reference case in place of a scene; `symosc cases` lists them.")
@set_option
@click.option("--solver", metavar="MODULE:FUNCTION", help="Run FUNCTION(parameters, t0, x0, v0, t_end) and check that.")
@click.option(
    "--t-end", metavar="T", help="Where the solution has to end, if not at the scene's end; 10T: after 10 periods."
)
@click.option("--own-start", is_flag=True, help="Allow a solution that starts elsewhere than the scene.")
@click.option("--partial", is_flag=True, help="Allow a solution that ends before the scene does.")
@click.option(
    "--columns", metavar="t=…,x=…,v=…", help="What the columns are called, or their numbers; v=none: no velocities."
)
@click.option(
    "--tolerance", metavar="E", help="Allowed defect of a step, relative to the largest |x|, |v|; default 1e-8."
)
@click.option(
    "--global-tolerance",
    metavar="E",
    help="Allowed error since the start; default 1000 times the tolerance, of rounded samples 5 last places.",
)
@click.option("--workers", type=WholeNumber(min=1), metavar="N", help="Processes for several solutions; default 1.")
@json_option
@click.option("-o", "--output", metavar="FIGURE", help="Draw the errors against time as well: .pdf, .svg or .png.")
@click.option("--report", metavar="FILE.html", help="Write a page with diagnosis, events and pictures as well.")
def check(files: tuple[str, ...], output: str | None, report: str | None, as_json: bool, **options: Any) -> int:
    """Check somebody's solution against the exact motion.

    Give SCENE FILE, FILE --scene SCENE, or FILE --case NAME; FILE is - for standard input. It holds samples t, x, v in
    columns: .csv, .tsv, .txt (any delimiter, with a header or without), .npz, .json, .mat, .parquet, .feather, .h5,
    what Octave saves, and .gz of them. Each step is compared with the exact motion over it: the difference is its
    defect. The whole is compared with the exact motion from the same start, and the switching events of the samples
    with the exact ones. Says which were missed or invented, and what is probably wrong: a coefficient, a sign, the
    clock, smoothed friction, late events, the method, ... Velocities that are not there are computed. A column of ids,
    or more than one FILE, is several solutions. A solution has to start and to end where the scene does, unless
    --own-start and --partial allow another. A JSON or npz file may list the events that the solver reported, as
    "events": pairs of t and kind (cross, stick, slip, graze). Pieces joined at an event may repeat its time. Samples
    with few digits are judged at their precision.

    Exit codes: 0 the solution is right to the tolerance, 1 it is not, 2 bad input.

    \b
    Examples:
      symosc check run.csv --scene fig9
      symosc check fig5 run.csv --columns t=time,x=pos,v=vel --tolerance 1e-6 -o errors.pdf
      symosc check fig9 run.csv --report check.html
      symosc check run.csv --case late-start-t0-1e8-fig9
      symosc check fig9 --set k=3 --solver mysolver:solve
    """
    piped = goes_to_stdout(output, "--output", as_json)
    if report is not None and not report.lower().endswith((".html", ".htm")):
        raise click.BadParameter(f"{report!r}: a page's name must end in .html", param_hint="--report")
    scene, words = _scene_and_files(files, _named_scene(options), options["solver"])
    problem = scene_with(scene, options["settings"], {"t_end": options["t_end"]})
    check_picture(output)
    result = _checked(problem, words, options)
    if output is not None:
        from symosc import plot

        plot.save(plot.crosscheck_figure(_only_one(result, "--output")), output)
    if report is not None:
        _only_one(result, "--report").to_html(report)
    if not piped:
        write_json(result.as_dict()) if as_json else write(result.summary())
    return int(not result.ok)


def _named_scene(options: Record) -> str | Scene | None:
    """Return the scene or the reference case named by an option."""
    if options["case"] is None:
        name: str | None = options["scene"]
        return name
    if options["scene"] is not None:
        raise click.UsageError("give --scene or --case, not both")
    from symosc.reference.cases import reference_case

    return reference_case(options["case"]).scene


def _scene_and_files(
    words: tuple[str, ...], scene: str | Scene | None, solver: str | None
) -> tuple[str | Scene, tuple[str, ...]]:
    """Return the scene, which may be the first word, and the files."""
    if scene is None:
        if len(words) < 1 + (solver is None):
            raise click.UsageError("give SCENE FILE, FILE --scene SCENE, or FILE --case NAME")
        scene, words = words[0], words[1:]
    if solver is not None and words:
        raise click.UsageError("give files or --solver, not both")
    if solver is None and not words:
        raise click.UsageError("give a file of samples, or --solver MODULE:FUNCTION")
    return scene, words


def _checked(problem: Scene, files: tuple[str, ...], options: Record) -> Any:
    """Check the solutions in files, or of a solver, as the options say."""
    from symosc.crosschecks.compare import STEP_TOLERANCE, crosscheck
    from symosc.crosschecks.objects import run_solver

    tolerance = options["tolerance"]
    limits: Record = {"tolerance": STEP_TOLERANCE if tolerance is None else float(read_exact("tolerance", tolerance))}
    if options["global_tolerance"] is not None:
        limits["global_tolerance"] = float(read_exact("global_tolerance", options["global_tolerance"]))
    workers = 1 if options["workers"] is None else options["workers"]
    limits |= {"own_start": options["own_start"], "partial": options["partial"]}
    limits |= {"columns": _split_columns(options["columns"]), "workers": workers}
    if options["solver"] is not None:
        source: Any = run_solver(options["solver"], problem)
    else:
        source = files[0] if len(files) == 1 else files
    return crosscheck(problem, source, progress=True, **limits)


def _only_one(result: Any, option: str) -> Any:
    """Return a result; raise BadParameter if it is a list of several."""
    if isinstance(result, list):
        raise click.BadParameter(f"shows one solution, and there are {len(result)}", param_hint=option)
    return result


@click.command()
@click.option("-o", "--output", metavar="DIR", help="Write the cases into this folder: all files or none.")
@click.option("--group", metavar="NAME", help="Only the cases of one group, such as 'exact graze'.")
@json_option
def cases(output: str | None, group: str | None, as_json: bool) -> int:
    """List reference cases: motions whose events are known for certain, mostly with a proof.

    With -o they are written as files that any language reads: exact parameters, events between 40-digit decimals,
    samples, certificates, checksums, and a README that says what the problem and the formats are. That takes half a
    minute. Running it again gives the same bytes. `symosc score` judges what a solver makes of them.

    \b
    Examples:
      symosc cases
      symosc cases --group "exact graze" --json
      symosc cases -o cases
    """
    from symosc.reference.cases import chosen
    from symosc.reference.folder import write_cases

    wanted = chosen(group)
    if output is not None:
        folder = folder_name(output)
        written = count(1)
        with bar("cases", len(wanted), "cases") as report:
            path = write_cases(folder, wanted, progress=lambda _: report(next(written), len(wanted)))
        if as_json:
            write_json({"folder": str(path), "cases": [case.name for case in wanted]})
        else:
            write(f"wrote {len(wanted)} cases into {click.format_filename(path)}")
        return 0
    rows = [
        {"name": case.name, "group": case.group, "events": case.count, "status": case.status, "hard": case.hard}
        for case in wanted
    ]
    if as_json:
        write_json({"cases": rows})
        return 0
    write_table([[str(row[name]) for name in rows[0]][:-1] for row in rows], [*rows[0]][:-1])
    proven = sum(case.proven for case in wanted)
    write(f"\n{len(wanted)} cases, {proven} of them proven")
    return 0


@click.command()
@click.argument("folder", metavar="DIR")
@click.argument("results", metavar="THEIRS", nargs=-1, required=True)
@click.option("--tolerance", metavar="E", help="Allowed error, relative to max(1, t - t0), max(1, |x|); default 1e-9.")
@click.option("-o", "--output", metavar="FILE", help="Write a page: .md or .html.")
@click.option("--plot", "picture", metavar="FIGURE", help="Draw all errors: .pdf, .svg or .png. -: SVG to stdout.")
@json_option
def score(
    folder: str, results: tuple[str, ...], tolerance: str | None, output: str | None, picture: str | None, as_json: bool
) -> int:
    """Judge the events that solvers have found in the reference cases.

    DIR is what `symosc cases -o DIR` has written. THEIRS is a folder with a file per case, or one file for all, of any
    kind that `symosc check` reads; DIR/README.md says what is in them. Cases may be missing. Several THEIRS stand side
    by side.

    For each case and group: events missed, invented or of a wrong kind, and the largest error in units of what rounding
    the case's numbers to doubles does (condition * 1e-16). A case is right if it is followed to its end, all events are
    there with time and position, no others, and each error is at most the tolerance, or 100 units if that is more.

    Exit codes: 0 all results that are there are right, 1 they are not, 2 bad input.

    \b
    Examples:
      symosc score cases mine.csv
      symosc score cases mine theirs -o scores.html --plot scores.svg
      symosc score cases mine.json --tolerance 1e-6 --json
    """
    piped = goes_to_stdout(picture, "--plot", as_json)
    from symosc.files import write_text
    from symosc.reference.compare import SCORE_TOLERANCE
    from symosc.reference.folder import read_set
    from symosc.reference.results import read_results
    from symosc.reference.score import as_html, as_markdown, as_text, read_tolerance
    from symosc.reference.score import score as judged

    form = "" if output is None else Path(output).suffix.lower()
    if output is not None and form not in (".md", ".html"):  # before the work
        raise click.BadParameter(f"{output!r} must end in .md or .html", param_hint="--output")
    check_picture(picture)
    limit = SCORE_TOLERANCE if tolerance is None else read_tolerance(tolerance)
    version, cases = read_set(folder)
    names = {case.name for case in cases}
    short = [Path(each).stem or each for each in results]
    titles = [name if short.count(name) == 1 else each for name, each in zip(short, results, strict=True)]
    scores = [
        judged(title, cases, read_results(each, names), limit) for title, each in zip(titles, results, strict=True)
    ]
    if output is not None:
        write_text(
            output, (as_html if form == ".html" else as_markdown)(scores, "Scores on the reference cases", version)
        )
    if picture is not None:
        from symosc import plot

        plot.save(plot.score_figure(scores), picture)
    if as_json:
        write_json({"set_version": version, "scores": [each.as_dict() for each in scores]})
    elif not piped:
        write(as_text(scores))
    return int(not all(each.ok for each in scores))
