"""`symosc fit`: parameters from measured events or samples."""

from __future__ import annotations

import click

from symosc.base.errors import ParameterError
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, flag, option


@click.command()
@options.scene_argument
@click.argument("file")
@option(
    "--free NAMES",
    "What to fit: names of parameters, and t0, x0, v0, such as mu1,c; of the model in a file with "
    "[model], such as Y,pull.",
    required=True,
)
@option(
    "--sigma S",
    "Standard deviation of the times, or of x and v: 1e-3 or 1e-3,1e-2. Default: estimated.",
)
@option("--start NAME=VALUE", "First value of a free number. Repeatable.", multiple=True)
@flag("--robust", "Let outliers hardly count: up to a tenth of the data.")
@option(
    "--columns t=…,x=…",
    "Which columns are t, kind, x and v: names, numbers or NAME[i]; v=none: no velocities.",
)
@options.plot_option
@options.set_option
@options.json_option
def fit(
    scene: str,
    file: str,
    free: str,
    sigma: Text,
    start: Settings,
    robust: bool,
    columns: Text,
    plot: Text,
    settings: Settings,
) -> int:
    """Fit parameters to measured events or samples in a file.

    FILE has columns t and kind (cross, stick, slip or graze) of events, some of which may be
    missing; or t and x, or t, x and v, of samples. `symosc check` reads the same files, and knows
    the same names of columns, such as time, pos and vel.

    Exit codes: 0 success; 1 the data do not determine all numbers, or no motion describes the data;
    2 bad input.

    \b
    Examples:
      symosc fit fig5 stops.csv --free mu1 --sigma 1e-3
      symosc fit fig5 run.csv --free mu1,c --columns t=clock,x=u --robust
      symosc fit mine.toml samples.csv --free mu1,k,x0 --start mu1=0.7 --plot fit.png
    """
    from symosc.analysis.fitting.fit import fit as fit_parameters

    problem = options.scene_with(scene, settings)
    names = [name.strip() for name in free.split(",")]
    if sigma and "," in sigma:
        widths: list[str] | str | None = sigma.split(",")
    else:
        widths = sigma
    first_values = {}
    for setting in start:
        name, _, value = setting.partition("=")
        first_values[name] = value
    names_of_columns = options.split_columns(columns, ("t", "kind", "x", "v"))
    try:
        result = fit_parameters(
            problem,
            file,
            names,
            sigma=widths,
            start=first_values,
            robust=robust,
            columns=names_of_columns,
        )
    except ParameterError as error:
        # A fault in the file; its name may be that of a cell, such as "t[3]".
        argument, _, _ = error.name.partition("[")
        if argument not in ("data", "t", "kind", "x", "v"):
            raise
        raise click.BadParameter(f"{file}: {error}", param_hint="FILE") from None
    output.draw(plot, result.plot)
    about = {
        "values": result.values,
        "errors": result.errors,
        "covariance": result.covariance.tolist(),
    }
    about |= {
        "success": result.success,
        "message": result.message,
        "residuals": result.residuals.tolist(),
        "outliers": [outlier._asdict() for outlier in result.outliers],
    }
    table = [
        [name, f"{value:.10g}", f"{result.errors[name]:.2g}"]
        for name, value in result.values.items()
    ]
    text = f"{output.plain_table(['', 'value', 'error'], table)}\n\n{result.message}"
    output.report(lambda: about, lambda: output.write(text))
    if result.success:
        return 0
    return output.FAILED
