"""`symosc check`, `cases` and `score`.

Judge solutions of a scene, and solvers on all reference cases.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import symosc
from symosc.base.aliases import Record
from symosc.base.display.progress import bar
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, flag, option

if TYPE_CHECKING:
    from symosc.reference.case import ReferenceCase


@click.command()
@click.argument("files", nargs=-1, shell_complete=options.complete_scene)
@option("--scene SCENE", "Name of a scene or path of a TOML file, if it is not the first word.")
@option("--case NAME", "A reference case in place of a scene; `symosc cases` lists them.")
@options.set_option
@option("--solver MODULE:FUNCTION", "Run FUNCTION(parameters, t0, x0, v0, t_end) and check that.")
@option(
    "--t-end T", "Where the solution has to end, if not at the scene's end; 10T: after 10 periods."
)
@flag("--own-start", "Allow a solution that starts elsewhere than the scene.")
@flag("--partial", "Allow a solution that ends before the scene does.")
@option(
    "--columns t=…,x=…,v=…",
    "Which columns are meant: names, numbers or NAME[i]; v=none: no velocities.",
)
@option(
    "--tolerance E", "Allowed defect of a step, relative to the largest |x|, |v|; default 1e-8."
)
@option(
    "--global-tolerance E",
    "Allowed error since the start; default 1000 times the tolerance, of rounded samples 5 last places.",
)
@option(
    "--workers N", "Processes for several solutions; default 1.", type=options.WholeNumber(min=1)
)
@options.json_option
@option(
    "-o, --output FIGURE", "Draw the errors against time as well: .pdf, .svg or .png.", "picture"
)
@option("--report FILE.html", "Write a page with diagnosis, events and pictures as well.")
def check(
    files: Sequence[str],
    scene: Text,
    case: Text,
    settings: Settings,
    picture: Text,
    **check_options: Any,
) -> int:
    """Check somebody's solution against the exact motion.

    Give SCENE FILE, FILE --scene SCENE, or FILE --case NAME; FILE is - for standard input. It holds
    samples t, x, v in columns: .csv, .tsv, .txt (any delimiter, with a header or without), .npz,
    .json, .mat (also of Simulink, OpenModelica and Dymola), .parquet, .feather, .h5, what Octave
    saves, and .gz of them. Usual names of columns are known, such as time, pos and vel, x1 and x2,
    q and dq; --columns names others. Each step is compared
    with the exact motion over it: the difference is its defect. The whole is compared with the
    exact motion from the same start, and the switching events of the samples with the exact ones.
    Says which were missed or invented, and what is probably wrong: a coefficient, a sign, the
    clock, smoothed friction, late events, the method, ... Velocities that are not there are
    computed. A column of ids, or more than one FILE, is several solutions. A solution must cover
    the scene from start to end; --own-start and --partial relax this. A JSON or npz file may list
    the events that the solver reported, as "events": pairs of t and kind (cross, stick, slip,
    graze). Pieces joined at an event may repeat its time. Samples with few digits are judged at
    their precision.

    Exit codes: 0 the solution is right to the tolerance, 1 it is not, 2 bad input.

    \b
    Examples:
      symosc check run.csv --scene fig9
      symosc check fig5 run.csv --columns t=1,x=3,v=4 --tolerance 1e-6 -o errors.pdf
      symosc check fig5 run.mat --columns x=state[1],v=state[2]
      symosc check fig9 run.csv --report check.html
      symosc check run.csv --case late-start-t0-1e8-fig9
      symosc check fig9 --set k=3 --solver mysolver:solve
    """
    solver, t_end, report = (check_options.pop(name) for name in ("solver", "t_end", "report"))
    if report is not None and not report.lower().endswith((".html", ".htm")):
        reason = f"{report!r}: a page's name must end in .html"
        raise click.BadParameter(reason, param_hint="--report")
    least_words = 1 if solver else 2  # SCENE, or SCENE FILE
    if case is None and scene is None and len(files) >= least_words:
        scene, *files = files
        names = symosc.scene_names()
        behind = "".join(files[:1])
        is_swapped = scene not in names and behind in names
        options.refuse((is_swapped, f"give the scene first: symosc check {behind} {scene}"))
    lacks_scene = "give SCENE FILE, FILE --scene SCENE, or FILE --case NAME"
    options.refuse(
        (case is not None and scene is not None, "give --scene or --case, not both"),
        (case is None and scene is None, lacks_scene),
        (solver is not None and files, "give files or --solver, not both"),
        (solver is None and not files, "give a file of samples, or --solver MODULE:FUNCTION"),
    )
    problem = options.scene_with(_named(scene, case), settings, t_end=t_end)
    limits = {name: value for name, value in check_options.items() if value is not None}
    limits["columns"] = options.split_columns(limits.get("columns"), ("t", "x", "v", "id"))
    if solver is not None:  # it gets the numbers of the oscillator
        problem = options.reduced_scene(problem, any_law=True)
    source = _solutions(files, solver, problem)
    result = symosc.crosscheck(problem, source, progress=True, **limits)
    for path, hint in ((picture, "--output"), (report, "--report")):
        if path is not None and isinstance(result, list):
            reason = f"shows one solution, and there are {len(result)}"
            raise click.BadParameter(reason, param_hint=hint)
    output.draw(picture, lambda: result.plot())
    if report is not None:
        result.to_html(report)
    output.report(result.as_dict, lambda: output.write(result.summary()))
    return int(not result.ok)


def _named(scene: Text, case: Text) -> Any:
    """Return the name of the scene, or the scene of the reference case."""
    if case is None:
        return scene
    from symosc.reference.cases import reference_case

    return reference_case(case).scene


def _solutions(files: Sequence[str], solver: Text, problem: Any) -> Any:
    """Return what is to be checked: a file, several, or what a solver returns for the problem."""
    from symosc.crosschecks.solver_runs import run_solver

    if solver is not None:
        return run_solver(solver, problem)
    return files[0] if len(files) == 1 else files


@click.command()
@option("-o, --output DIR", "Write the cases into this folder: all files or none.", "folder")
@option("--group NAME", "Only the cases of one group, such as 'exact graze'.")
@flag("--events", "Count the events of each case as well, which takes up to a minute.")
@options.json_option
def cases(folder: Text, group: Text, events: bool) -> None:
    """List reference cases: motions whose events are known for certain, mostly with a proof.

    With -o they are written as files that any language reads: exact parameters, events between
    40-digit decimals, samples, certificates, checksums, and a README that says what the problem and
    the formats are. That takes half a minute. Running it again gives the same bytes. `symosc score`
    judges what a solver makes of them.

    \b
    Examples:
      symosc cases
      symosc cases --group "exact graze" --events --json
      symosc cases -o cases
    """
    from symosc.reference.case import PROVEN
    from symosc.reference.cases import chosen
    from symosc.reference.folder import write_cases

    in_group = chosen(group)
    total = len(in_group)
    if folder is not None:
        counter = count(1)
        folder = options.folder_name(folder)
        with bar("cases", total, "cases") as progress:
            path = write_cases(folder, in_group, progress=lambda _: progress(next(counter), total))
        text = f"wrote {total} cases into {click.format_filename(path)}"
        data = {"folder": str(path), "cases": [case.name for case in in_group]}
        output.report(lambda: data, lambda: output.write(text))
        return
    listed = [case_row(case, events) for case in in_group]

    def show() -> None:
        heads = [name for name in listed[0] if name != "hard"]
        output.write_table([[str(row[name]) for name in heads] for row in listed], heads)
        proven = sum(row["status"] == PROVEN for row in listed)
        output.write(f"\n{len(listed)} cases, {proven} of them proven")

    output.report(lambda: {"cases": listed}, show)


def case_row(case: ReferenceCase, events: bool) -> Record:
    """Return what the list of cases says of one; `events` asks for what takes a proof or a
    simulation.
    """
    row: Record = {"name": case.name, "group": case.group}
    if events:
        row["events"] = case.count
    return row | {"status": case.expected_status, "hard": case.hard}


@click.command()
@click.argument("folder", metavar="DIR")
@click.argument("results", metavar="THEIRS", nargs=-1, required=True)
@option("--tolerance E", "Allowed error, relative to max(1, t - t0), max(1, |x|); default 1e-9.")
@option("--plot FIGURE", "Draw all errors: .pdf, .svg or .png. -: SVG to stdout.")
@options.json_option
def score(folder: str, results: tuple[str, ...], tolerance: Text, plot: Text) -> int:
    """Judge the events that solvers have found in the reference cases.

    DIR is what `symosc cases -o DIR` has written. THEIRS is a table for all cases, in any format
    that `symosc check` reads, or a JSON file, or a folder with a table for each case; DIR/README.md
    says what is in them. Cases may be missing. Several THEIRS stand side by side.

    For each case and group: events missed, invented or of a wrong kind, and the largest error in
    units of what rounding the case's numbers to doubles does (condition * 1e-16). A case is right
    if it is followed to its end, all events are there with time and position, no others, and each
    error is at most the tolerance, or 100 units if that is more.

    Exit codes: 0 all results that are there are right, 1 they are not, 2 bad input.

    \b
    Examples:
      symosc score cases mine.csv
      symosc score cases mine.csv theirs --plot scores.svg
      symosc score cases mine.json --tolerance 1e-6 --json
    """
    from symosc.reference.folder import read_set
    from symosc.reference.results import read_results
    from symosc.reference.score import SCORE_TOLERANCE, as_text, read_tolerance
    from symosc.reference.score import score as judge

    limit = SCORE_TOLERANCE if tolerance is None else read_tolerance(tolerance)
    version, cases = read_set(folder)
    names = {case.name for case in cases}
    # A solver is called by the name of its file, or by the whole path where two have that name.
    stems = [Path(path).stem or path for path in results]
    titles = [
        stem if stems.count(stem) == 1 else path for stem, path in zip(stems, results, strict=True)
    ]
    scores = [
        judge(title, cases, read_results(path, names), limit)
        for title, path in zip(titles, results, strict=True)
    ]
    if plot is not None:
        output.draw(plot, symosc.plot.score_figure, scores)
    data = {"set_version": version, "scores": [result.as_dict() for result in scores]}
    output.report(lambda: data, lambda: output.write(as_text(scores)))
    return int(not all(result.ok for result in scores))
