"""What commands print: text, JSON and tables on stdout, and a line on stderr where a motion could not be decided."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from symosc.display.progress import QUIET, level, pause_working
from symosc.display.tables import plain_table
from symosc.display.terminal import print_table
from symosc.files import drop_stdout

if TYPE_CHECKING:
    from symosc.simulation.trajectory import Trajectory

FLOAT_FORMAT = "{:.14g}"  # one digit less than every double has; CSV and JSON have them all
#: Columns whose numbers are aligned at their points.
NUMBER_HEADS = ("t", "x", "v", "theta")
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON in place of the table.")


def write(text: str) -> None:
    """Print to stdout. Nothing is wrong if the reader has closed the pipe."""
    pause_working()
    try:
        click.echo(text)
    except BrokenPipeError:
        drop_stdout()


def complain(text: str) -> None:
    """Say on stderr what did not work."""
    pause_working()
    click.echo(f"symosc: {text}", err=True)


def tell(text: str) -> None:
    """Say something on stderr that is no result and no error, unless all is to be quiet."""
    if level() > QUIET:
        complain(text)


def write_json(data: object) -> None:
    """Print plain data as JSON."""
    write(json.dumps(data, indent=1))


def write_table(rows: list[list[str]], heads: list[str]) -> None:
    """Print a table; numbers are aligned at their points."""
    pause_working()
    if not print_table(heads, rows, NUMBER_HEADS):
        write(plain_table(heads, rows, NUMBER_HEADS))


def undecidable(trajectory: Trajectory) -> bool:
    """Report a trajectory that ended because its precision did not suffice."""
    if trajectory.status != "undecidable":
        return False
    complain(f"undecidable: {trajectory.message}")
    return True


def counted(events: Sequence[object]) -> str:
    """Return how many events these are, in words."""
    return f"{len(events)} event{'' if len(events) == 1 else 's'}"
