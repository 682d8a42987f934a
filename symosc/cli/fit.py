"""`symosc fit`: parameters from measured events or samples."""

from __future__ import annotations

import csv
from typing import TextIO

import click

from symosc.cli import options, output
from symosc.cli.options import Settings, Text, option
from symosc.errors import ParameterError


def _columns(file: TextIO) -> dict[str, list[str]]:
    """Return the columns of a CSV file by the names in its first line."""
    try:
        rows = list(csv.DictReader(file, skipinitialspace=True, strict=True))
    except (csv.Error, UnicodeDecodeError) as error:
        raise click.BadParameter(
            f"{file.name} is no CSV file: {error}", param_hint="FILE"
        ) from None
    if not rows or any(None in row or None in row.values() for row in rows):
        needs = f"{file.name} needs a line of names, and as many entries in each row"
        raise click.BadParameter(needs, param_hint="FILE")
    return {name: [row[name] for row in rows] for name in rows[0]}


@click.command()
@options.scene_argument
@click.argument("file", type=options.TextFile(encoding="utf-8-sig"))
@option(
    "--free NAMES",
    "What to fit: names of parameters, and t0, x0, v0, such as mu1,c.",
    required=True,
)
@option(
    "--sigma S",
    "Standard deviation of the times, or of x and v: 1e-3 or 1e-3,1e-2. Default: estimated.",
)
@option("--start NAME=VALUE", "First value of a free number. Repeatable.", multiple=True)
@options.plot_option
@options.set_option
@options.json_option
def fit(
    scene: str,
    file: TextIO,
    free: str,
    sigma: Text,
    start: Settings,
    plot: Text,
    settings: Settings,
) -> int:
    """Fit parameters to measured events or samples in a CSV file.

    FILE has a line of names: t and kind (cross, stick, slip or graze) of events, some of which may
    be missing; or t and x, or t, x and v, of samples. Exit code 1 if the data do not determine all
    numbers.

    \b
    Examples:
      symosc fit fig5 stops.csv --free mu1 --sigma 1e-3
      symosc fit mine.toml samples.csv --free mu1,k,x0 --start mu1=0.7 --plot fit.png
    """
    from symosc.fit import fit as fit_parameters

    problem = options.scene_with(scene, settings)
    names = [name.strip() for name in free.split(",")]
    if sigma and "," in sigma:
        widths: list[str] | str | None = sigma.split(",")
    else:
        widths = sigma
    firsts = dict(each.partition("=")[::2] for each in start)
    try:
        found = fit_parameters(problem, _columns(file), names, sigma=widths, start=firsts)
    except ParameterError as error:
        if error.name.partition("[")[0] not in ("data", "t", "kind", "x", "v"):
            raise
        if "[" in error.name:
            rows = " (rows from 0, without the line of names)"
        else:
            rows = ""
        raise click.BadParameter(f"{file.name}: {error}{rows}", param_hint="FILE") from None
    output.draw(plot, found.plot)
    about = {
        "values": found.values,
        "errors": found.errors,
        "covariance": found.covariance.tolist(),
    }
    about |= {
        "success": found.success,
        "message": found.message,
        "residuals": found.residuals.tolist(),
    }
    table = [
        [name, f"{value:.10g}", f"{found.errors[name]:.2g}"] for name, value in found.values.items()
    ]
    text = f"{output.plain_table(['', 'value', 'error'], table)}\n\n{found.message}"
    output.report(lambda: about, lambda: output.write(text))
    if found.success:
        return 0
    return output.FAILED
