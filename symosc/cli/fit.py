"""`symosc fit`: parameters from measured events or samples."""

from __future__ import annotations

import csv
from typing import TextIO

import click

from symosc.cli.common import (
    FAILED,
    check_picture,
    complete,
    goes_to_stdout,
    json_option,
    scene_argument,
    scene_with,
    set_option,
    write,
    write_json,
)
from symosc.display.tables import plain_table
from symosc.errors import ParameterError
from symosc.model import PARAMETER_NAMES


def _columns(file: TextIO) -> dict[str, list[str]]:
    """Return the columns of a CSV file with a line of names."""
    try:
        rows = list(csv.DictReader(file, skipinitialspace=True, strict=True))
    except (csv.Error, UnicodeDecodeError) as error:
        raise click.BadParameter(f"{file.name} is no CSV file: {error}", param_hint="FILE") from None
    if not rows or any(None in row or None in row.values() for row in rows):
        raise click.BadParameter(
            f"{file.name} needs a line of names, and as many entries in each row", param_hint="FILE"
        )
    return {name: [row[name] for row in rows] for name in rows[0]}


@click.command()
@scene_argument
@click.argument("file", type=click.File(encoding="utf-8-sig"))
@click.option(
    "--free",
    required=True,
    metavar="NAMES",
    shell_complete=complete(PARAMETER_NAMES, ","),
    help="What to fit: names of parameters, and t0, x0, v0, such as mu1,c.",
)
@click.option(
    "--sigma",
    metavar="S",
    help="Standard deviation of the times, or of x and v: 1e-3 or 1e-3,1e-2. Default: estimated.",
)
@click.option("--start", "first", multiple=True, metavar="NAME=VALUE", help="First value of a free number. Repeatable.")
@click.option("--plot", "picture", metavar="FILE", help="Draw it: .pdf, .svg or .png. -: SVG to stdout.")
@set_option
@json_option
def fit(
    scene: str,
    file: TextIO,
    free: str,
    sigma: str | None,
    first: tuple[str, ...],
    picture: str | None,
    settings: tuple[str, ...],
    as_json: bool,
) -> int:
    """Fit parameters to measured events or samples in a CSV file.

    FILE has a line of names: t and kind (cross, stick, slip or graze) of events, some of which may be missing; or t and
    x, or t, x and v, of samples. Exit code 1 if the data do not determine all numbers.

    \b
    Examples:
      symosc fit fig5 stops.csv --free mu1 --sigma 1e-3
      symosc fit mine.toml samples.csv --free mu1,k,x0 --start mu1=0.7 --plot fit.png
    """
    from symosc.fit import fit as fitted

    piped = goes_to_stdout(picture, "--plot", as_json)
    check_picture(picture)
    problem = scene_with(scene, settings, {})
    widths = None if sigma is None else sigma.split(",") if "," in sigma else sigma
    names = [name.strip() for name in free.split(",")]
    starts = dict(each.partition("=")[::2] for each in first)
    try:
        found = fitted(problem, _columns(file), names, sigma=widths, start=starts)
    except ParameterError as error:
        if error.name.partition("[")[0] not in ("data", "t", "kind", "x", "v"):
            raise
        note = " (rows from 0, without the line of names)" if "[" in error.name else ""
        raise click.BadParameter(f"{file.name}: {error}{note}", param_hint="FILE") from None
    if picture is not None:
        from symosc import plot

        plot.save(plot.fit_figure(found), picture)
    if as_json:
        about = {"values": found.values, "errors": found.errors, "covariance": found.covariance.tolist()}
        write_json(about | {"success": found.success, "message": found.message, "residuals": found.residuals.tolist()})
    elif not piped:
        rows = [[name, f"{value:.10g}", f"{found.errors[name]:.2g}"] for name, value in found.values.items()]
        write(f"{plain_table(['', 'value', 'error'], rows)}\n\n{found.message}")
    return 0 if found.success else FAILED
