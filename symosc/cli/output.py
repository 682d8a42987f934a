"""What commands print and write: answers as text or JSON, tables, notes and errors, and figures."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import click

from symosc.display.progress import QUIET, level, pause_working
from symosc.display.tables import plain_table, print_table
from symosc.files import STDOUT, drop_stdout

if TYPE_CHECKING:
    from symosc.simulation.trajectory import Trajectory

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130
FLOAT_FORMAT = "{:.14g}"  # one digit less than every double has; CSV and JSON have them all
#: Columns whose numbers are aligned at their points.
NUMBER_HEADS = ("t", "x", "v", "theta")
#: The key in a click context of the options that print to standard output, by name.
_PRINTING = f"{__name__}.printing"


def claim_stdout(context: click.Context, option: click.Parameter, value: Any) -> Any:
    """Note an option that prints to standard output; BadParameter if that is a file, and another one prints there."""
    if value is True or value == STDOUT:
        printing = context.meta.setdefault(_PRINTING, {})
        printing[option.name] = option
        files = [each for each in printing.values() if not getattr(each, "is_flag", False)]
        if files and len(printing) > 1:
            reason = "'-' is standard output, and something else prints there already; name a file"
            raise click.BadParameter(reason, param_hint=max(files[0].opts, key=len))
    return value


def prints_json() -> bool:
    """Return whether the command prints JSON."""
    return "json" in click.get_current_context().meta.get(_PRINTING, {})


def report(data: Callable[[], object], show: Callable[[], object]) -> None:
    """Print an answer: with --json its data, else by `show`, unless a file goes to standard output."""
    printing = click.get_current_context().meta.get(_PRINTING, {}).values()
    if prints_json():
        write_json(data())
    elif all(getattr(each, "is_flag", False) for each in printing):
        show()


def draw(path: str | None, plot: Callable[..., Any], *given: Any) -> None:
    """Write the figure that `plot` returns, if a file is named."""
    if path is not None:
        from symosc.plot.drawing import save

        save(plot(*given), path)


def write(text: str, end: str = "\n") -> None:
    """Print to stdout. A reader that closes the pipe is no error."""
    pause_working()
    try:
        click.echo(text + end, nl=False)
    except BrokenPipeError:
        drop_stdout()


def complain(text: str) -> None:
    """Print an error on stderr."""
    pause_working()
    click.echo(f"symosc: {text}", err=True)


def note(text: str) -> None:
    """Print a note on stderr, unless --quiet is given."""
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


def name_files(*paths: Any) -> None:
    """Print the names of the written files; None is none."""
    for path in paths:
        if path is not None:
            write(f"wrote {click.format_filename(path)}")


def undecidable(trajectory: Trajectory) -> bool:
    """Report a trajectory that ended because its precision did not suffice."""
    if trajectory.status == "undecidable":
        complain(f"undecidable: {trajectory.message}")
    return trajectory.status == "undecidable"


def count_events(events: Sequence[object]) -> str:
    """Return the number of events with its noun."""
    return f"{len(events)} event{'' if len(events) == 1 else 's'}"
