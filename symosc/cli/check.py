"""`symosc check`: compare a file of samples with the exact motion."""

from __future__ import annotations

import json

import click

from symosc.aliases import Record
from symosc.cli.settings import goes_to_stdout
from symosc.exact import read_exact


def _columns(text: str | None) -> dict[str, str]:
    names: dict[str, str] = {}
    for part in () if text is None else text.split(","):
        name, equals, column = (piece.strip() for piece in part.partition("="))
        if not equals or name not in ("t", "x", "v") or not column:
            raise click.BadParameter(f"{part!r} is not t=NAME, x=NAME or v=NAME", param_hint="--columns")
        if name in names:
            raise click.BadParameter(f"{name} is given twice", param_hint="--columns")
        names[name] = column
    return names


def _check_page_name(report: str | None) -> None:
    if report is not None and not report.lower().endswith((".html", ".htm")):
        raise click.BadParameter(f"{report!r}: a page's name must end in .html", param_hint="--report")


@click.command()
@click.argument("file")
@click.option("--scene", required=True, metavar="SCENE", help="Name of a scene or path of a TOML file.")
@click.option("--columns", metavar="t=…,x=…,v=…", help="What the columns are called; those left out are t, x, v.")
@click.option(
    "--tolerance", metavar="E", help="Allowed defect of a step, relative to the largest |x|, |v|; default 1e-8."
)
@click.option(
    "--global-tolerance", metavar="E", help="Allowed error since the start; default 1000 times the tolerance."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON in place of the summary.")
@click.option("-o", "--output", metavar="FIGURE", help="Draw the errors against time as well: .pdf, .svg or .png.")
@click.option("--report", metavar="FILE.html", help="Write a page with diagnosis, events and pictures as well.")
def check(
    file: str,
    scene: str,
    columns: str | None,
    tolerance: str | None,
    global_tolerance: str | None,
    as_json: bool,
    output: str | None,
    report: str | None,
) -> int:
    """Check somebody's solution against the exact motion.

    FILE holds samples t, x, v in columns: .csv with a header, .npz or .json. Each step is compared with the exact
    motion over it: the difference is its defect. The whole is compared with the exact motion from the same start, and
    the switching events of the samples with the exact ones. Says which were missed or invented, and what is probably
    wrong: a coefficient, a sign, the clock, smoothed friction, late events, the method, ... A JSON or npz file may list
    the events that the solver reported, as "events": pairs of t and kind (cross, stick, slip, graze). Pieces joined at
    an event may repeat its time. Samples with few digits are judged at their precision.

    Exit codes: 0 the solution is right to the tolerance, 1 it is not, 2 bad input.

    \b
    Examples:
      symosc check run.csv --scene fig9
      symosc check run.csv --scene fig5 --columns t=time,x=pos,v=vel --tolerance 1e-6 -o errors.pdf
      symosc check run.csv --scene fig9 --report check.html
    """
    piped = goes_to_stdout(output, "--output", as_json)
    from symosc.crosschecks.compare import STEP_TOLERANCE, crosscheck
    from symosc.crosschecks.files import read_samples

    _check_page_name(report)
    if output is not None:
        from symosc import plot

        plot.check_suffix(output)  # before the work
    limits: Record = {"tolerance": STEP_TOLERANCE if tolerance is None else float(read_exact("tolerance", tolerance))}
    if global_tolerance is not None:
        limits["global_tolerance"] = float(read_exact("global_tolerance", global_tolerance))
    samples = read_samples(file, _columns(columns))
    result = crosscheck(scene, samples.t, samples.x, samples.v, events=samples.events, **limits)
    if output is not None:
        from symosc.plot import crosscheck as crosscheck_module

        crosscheck_module.write(result, output)
    if report is not None:
        result.to_html(report)
    if piped:
        return int(not result.ok)
    click.echo(json.dumps(result.as_dict(), indent=1) if as_json else result.summary())
    return int(not result.ok)
