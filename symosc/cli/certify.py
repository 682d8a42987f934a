"""The command `symosc certify`."""

from __future__ import annotations

from decimal import Decimal

import click

from symosc.cli.output import json_option, write, write_json, write_table
from symosc.cli.settings import goes_to_stdout, scene_argument, scene_with, set_option
from symosc.exact import read_start_error

NOT_PROVEN = 1
#: Digits of an enclosure's middle that the table shows.
SHOWN_DIGITS = 17


@click.command()
@scene_argument
@click.option("--t-end", metavar="T", help="End time in place of the scene's.")
@click.option("--start-error", metavar="E", help="How far t0, x0, v0 may be off: a number, or three with commas.")
@set_option
@click.option("-o", "--output", metavar="FILE", help="Write the certificate, a JSON file. -: to stdout, and only that.")
@json_option
def certify(
    scene: str,
    t_end: str | None,
    start_error: str | None,
    settings: tuple[str, ...],
    output: str | None,
    as_json: bool,
) -> int:
    """Prove all events of a scene: that each is the next one, of its kind, and between which times and positions.

    The table shows as many digits as both ends of an enclosure round to. `symosc verify` proves a
    certificate file again, by other means. If anything stays open, one line says what, and the exit code is 1.

    \b
    Examples:
      symosc certify fig5
      symosc certify fig8 --t-end 12 -o fig8.json
    """
    from symosc.certificates.certify import certify as prove

    piped = goes_to_stdout(output, "--output", as_json)
    problem = scene_with(scene, settings, {"t_end": t_end})
    parts = None if start_error is None else start_error.split(",")
    error = None if parts is None else read_start_error(parts if len(parts) > 1 else start_error)
    certificate = prove(problem, start_error=error)
    if output is not None:
        certificate.to_json(output)
    if as_json:
        write_json(certificate.as_dict())
    elif not piped:
        rows = [
            [common(*t), common(*x), kind, f"{source} -> {target}"] for kind, source, target, t, x in certificate.events
        ]
        if rows:
            write_table(rows, ["t", "x", "kind", "from -> to"])
            write("")
        if certificate.proven:
            write(f"proven: {certificate.message}")
    if not certificate.proven:
        click.echo(f"symosc: not proven: {certificate.message}", err=True)
    return 0 if certificate.proven else NOT_PROVEN


def common(low: str, high: str) -> str:
    """Return as many digits of a number as both ends of its enclosure round to."""
    for digits in range(SHOWN_DIGITS, 0, -1):
        shown = {f"{Decimal(end):.{digits}g}" for end in (low, high)}
        if len(shown) == 1:
            return shown.pop()
    return f"{low} … {high}"
