"""`symosc check`: compare solutions in files, or of a solver, with the exact motion."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from symosc.aliases import Record
from symosc.cli.output import write
from symosc.cli.settings import WholeNumber, complete_scene, goes_to_stdout, scene_with, set_option
from symosc.exact import read_exact

if TYPE_CHECKING:
    from symosc.scenes import Scene

COLUMN_NAMES = ("t", "x", "v", "id")


def _columns(text: str | None) -> dict[str, str]:
    names: dict[str, str] = {}
    for part in () if text is None else text.split(","):
        name, equals, column = (piece.strip() for piece in part.partition("="))
        if not equals or name not in COLUMN_NAMES or not column:
            raise click.BadParameter(f"{part!r} is not t=NAME, x=NAME, v=NAME or id=NAME", param_hint="--columns")
        if name in names:
            raise click.BadParameter(f"{name} is given twice", param_hint="--columns")
        names[name] = column
    return names


def _check_page_name(report: str | None) -> None:
    if report is not None and not report.lower().endswith((".html", ".htm")):
        raise click.BadParameter(f"{report!r}: a page's name must end in .html", param_hint="--report")


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
@click.option("--json", "as_json", is_flag=True, help="Print JSON in place of the summary.")
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
    _check_page_name(report)
    scene, words = _scene_and_files(files, _named_scene(options), options["solver"])
    problem = scene_with(scene, options["settings"], {"t_end": options["t_end"]})
    if output is not None:
        from symosc import plot

        plot.check_suffix(output)  # before the work
    result = _checked(problem, words, options)
    if output is not None:
        from symosc.plot import crosscheck as drawing

        drawing.write(_only_one(result, "--output"), output)
    if report is not None:
        _only_one(result, "--report").to_html(report)
    if not piped:
        write(json.dumps(result.as_dict(), indent=1) if as_json else result.summary())
    return int(not result.ok)


def _named_scene(options: Record) -> str | Scene | None:
    """Return the scene or the reference case that an option names."""
    if options["case"] is None:
        name: str | None = options["scene"]
        return name
    if options["scene"] is not None:
        raise click.UsageError("give --scene or --case, not both")
    from symosc.reference.sets import reference_case

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
    from symosc.crosschecks.compare import STEP_TOLERANCE, crosscheck
    from symosc.crosschecks.objects import run_solver

    tolerance = options["tolerance"]
    limits: Record = {"tolerance": STEP_TOLERANCE if tolerance is None else float(read_exact("tolerance", tolerance))}
    if options["global_tolerance"] is not None:
        limits["global_tolerance"] = float(read_exact("global_tolerance", options["global_tolerance"]))
    workers = 1 if options["workers"] is None else options["workers"]
    limits |= {"own_start": options["own_start"], "partial": options["partial"]}
    limits |= {"columns": _columns(options["columns"]), "workers": workers}
    if options["solver"] is not None:
        source: Any = run_solver(options["solver"], problem)
    else:
        source = files[0] if len(files) == 1 else files
    return crosscheck(problem, source, progress=True, **limits)


def _only_one(result: Any, option: str) -> Any:
    if isinstance(result, list):
        raise click.BadParameter(f"shows one solution, and there are {len(result)}", param_hint=option)
    return result
