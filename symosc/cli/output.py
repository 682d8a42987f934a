"""What commands print and write: answers as text or JSON, tables, notes and errors, and figures."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from math import isfinite
from typing import Any, NoReturn

import click

import symosc
from symosc.base.display import progress
from symosc.base.files import STDOUT, drop

FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
FLOAT_FORMAT = "{:.14g}"  # one digit less than every double has; CSV and JSON have them all
#: Columns whose numbers are aligned at their points.
NUMBER_HEADS = ("t", "x", "v", "theta")
#: Colours of the cells that say what an event is, or how a judgement ended.
CELL_COLOURS = {
    "stick": "blue",
    "slip": "green",
    "cross": "red",
    "graze": "magenta",
    "undecidable": "yellow",
}
CELL_COLOURS |= {
    "confirmed": "green",
    "confirmed with a correction": "yellow",
    "not as printed": "red",
}
#: The key in a click context of the options that print to standard output, by name.
_PRINTING = f"{__name__}.printing"


def claim_stdout(context: click.Context, option: click.Parameter, value: Any) -> Any:
    """Return the value of an option, and record in the context if this option prints to standard
    output.

    Raise BadParameter if a file and other output would be mixed on standard output.
    """
    if value is True or value == STDOUT:
        printing = context.meta.setdefault(_PRINTING, {})
        printing[option.name] = option
        files = [printer for printer in printing.values() if not getattr(printer, "is_flag", False)]
        if files and len(printing) > 1:  # flags alone print one thing after the other
            reason = "'-' is standard output, and something else prints there already; name a file"
            raise click.BadParameter(reason, param_hint=max(files[0].opts, key=len))
    return value


def prints_json() -> bool:
    """Return whether the command prints JSON."""
    return "json" in click.get_current_context().meta.get(_PRINTING, {})


def report(data: Callable[[], object], show: Callable[[], object]) -> None:
    """Print an answer: its data with --json, else by `show`.

    Nothing if a file goes to standard output.
    """
    printing = click.get_current_context().meta.get(_PRINTING, {}).values()
    if prints_json():
        write_json(data())
    elif all(getattr(printer, "is_flag", False) for printer in printing):
        show()


def draw(path: str | None, plot: Callable[..., Any], *arguments: Any) -> None:
    """Write the figure that `plot(*given)` returns to a file; do nothing if no file is named."""
    if path is not None:
        symosc.plot.save(plot(*arguments), path)


def write(text: str, end: str = "\n") -> None:
    """Print to stdout. A reader that closes the pipe is no error."""
    progress.pause_working()
    try:
        click.echo(text + end, nl=False)
    except BrokenPipeError:
        drop(sys.stdout)


def complain(text: str) -> None:
    """Print an error on stderr; one that is closed or full changes nothing else."""
    progress.pause_working()
    try:
        click.echo(f"symosc: {text}", err=True)
    except OSError:
        drop(sys.stderr)


def fail(text: str) -> NoReturn:
    """Print an error on stderr, and end the command with exit code 1."""
    complain(text)
    raise click.exceptions.Exit(FAILED)


@contextmanager
def failing(kind: type[Exception], before: str = "") -> Iterator[None]:
    """End the command with exit code 1 at an error of this kind, and print `before` and the text of
    the error.
    """
    try:
        yield
    except kind as error:
        fail(f"{before}{error}")


def note(text: str, least: int = progress.NORMAL) -> None:
    """Print a note on stderr, unless --quiet is given.

    A note whose `least` is VERBOSE only with --verbose.
    """
    if progress.level >= least:
        complain(text)


def write_json(data: object) -> None:
    """Print plain data as JSON, with null for numbers that JSON lacks."""

    def without_infinities(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: without_infinities(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return [without_infinities(item) for item in value]
        if isinstance(value, float) and not isfinite(value):
            return None
        return value

    write(json.dumps(without_infinities(data), indent=1))


def write_table(rows: Sequence[Sequence[str]], heads: Sequence[str]) -> None:
    """Print a table; numbers are aligned at their points.

    On a terminal it has colours, unless NO_COLOR is set.
    """
    text = plain_table(heads, rows, NUMBER_HEADS)
    if sys.stdout is not None and sys.stdout.isatty() and not os.environ.get("NO_COLOR"):
        cell = rf"(?<=  )({'|'.join(CELL_COLOURS)})(?=  |$)"
        text = re.sub(
            cell,
            lambda match: click.style(match[0], fg=CELL_COLOURS[match[0]]),
            text,
            flags=re.MULTILINE,
        )
    write(text)


def plain_table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], decimals: Collection[str] = ()
) -> str:
    """Return a table as text.

    Columns with heads in `decimals` are aligned at their points, others at the left.
    """
    # It looks like one of tabulate, which would make a command a sixth slower to answer;
    # tests/cli/test_lazy.py holds that no command loads it.
    columns = []
    for i, head in enumerate(heads):
        cells = [row[i].strip() for row in rows]
        is_aligned = head in decimals
        if is_aligned:
            counts = [_behind_point(cell) for cell in cells]
            cells = [
                cell + " " * (max(counts) - count)
                for cell, count in zip(cells, counts, strict=True)
            ]
        width = max([len(head) + 2, *map(len, cells)])
        column = [cell.rjust(width) if is_aligned else cell.ljust(width) for cell in (head, *cells)]
        column.insert(1, "-" * width)  # under the head
        columns.append(column)
    return "\n".join("  ".join(line).rstrip() for line in zip(*columns, strict=True))


def _behind_point(cell: str) -> int:
    """Return how many characters follow the decimal point of a number; -1 if it has no point."""
    number = re.fullmatch(r"[^.e]*([.e].*)?", cell, re.IGNORECASE)
    if number is None or number[1] is None:
        return -1
    return len(number[1]) - 1


def name_files(*paths: Any) -> None:
    """Print the names of the written files; None stands for no file."""
    for path in paths:
        if path is not None:
            write(f"wrote {click.format_filename(path)}")


def undecidable(trajectory: symosc.Trajectory) -> bool:
    """Print an error, and return True, if a trajectory ended because its precision did not suffice."""
    if trajectory.status == "undecidable":
        complain(f"undecidable: {trajectory.message}")
    return trajectory.status == "undecidable"


def count_events(events: Sequence[object]) -> str:
    """Return how many events there are as a text for messages: "1 event", "3 events" and so on."""
    return f"{len(events)} event{'' if len(events) == 1 else 's'}"
