"""What commands print and write: answers as text or JSON, tables, notes and errors, and figures."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Collection, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any, NoReturn

import click

from symosc.display.progress import QUIET, level, pause_working
from symosc.files import STDOUT, drop_stdout

if TYPE_CHECKING:
    from symosc.simulation.trajectory import Trajectory

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130
FLOAT_FORMAT = "{:.14g}"  # one digit less than every double has; CSV and JSON have them all
#: Columns whose numbers are aligned at their points.
NUMBER_HEADS = ("t", "x", "v", "theta")
#: Colours of the cells that say what an event is, or how a judgement ended.
CELL_STYLES = {"stick": "blue", "slip": "green", "cross": "red", "graze": "magenta", "undecidable": "yellow"}
CELL_STYLES |= {"confirmed": "green", "refuted": "red", "not as printed": "red", "corrected": "yellow"}
#: The key in a click context of the options that print to standard output, by name.
_PRINTING = f"{__name__}.printing"


def claim_stdout(context: click.Context, option: click.Parameter, value: Any) -> Any:
    """Record that an option prints to standard output; BadParameter if a file and other output would mix there."""
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
    """Print an answer: its data with --json, else by `show`; nothing if a file goes to standard output."""
    printing = click.get_current_context().meta.get(_PRINTING, {}).values()
    if prints_json():
        write_json(data())
    elif all(getattr(each, "is_flag", False) for each in printing):
        show()


def draw(path: str | None, plot: Callable[..., Any], *given: Any) -> None:
    """Write the figure that `plot(*given)` returns to a file; do nothing if no file is named."""
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


def fail(text: str) -> NoReturn:
    """Print an error on stderr, and end the command with exit code 1."""
    complain(text)
    raise click.exceptions.Exit(FAILED)


def note(text: str) -> None:
    """Print a note on stderr, unless --quiet is given."""
    if level() > QUIET:
        complain(text)


def write_json(data: object) -> None:
    """Print plain data as JSON, with null for numbers that JSON lacks."""

    def known(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: known(each) for key, each in value.items()}
        if isinstance(value, list | tuple):
            return [known(each) for each in value]
        return None if isinstance(value, float) and not isfinite(value) else value

    write(json.dumps(known(data), indent=1))


def write_table(rows: Sequence[Sequence[str]], heads: Sequence[str]) -> None:
    """Print a table; numbers are aligned at their points. On a terminal with room for it rich draws it."""
    pause_working()
    if sys.stdout is None or not sys.stdout.isatty() or not _draw_table(rows, heads):
        write(plain_table(heads, rows, NUMBER_HEADS))


def _draw_table(rows: Sequence[Sequence[str]], heads: Sequence[str]) -> bool:
    """If a table fits the terminal with no number cut and no cell folded, draw it and return True."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console, shown = Console(file=sys.stdout), Table(box=SIMPLE_HEAD, header_style="bold", pad_edge=False)
    columns = []
    for i, head in enumerate(heads):
        shown.add_column(Text(head), justify="right" if head in NUMBER_HEADS else "left", no_wrap=True)
        cells = [row[i] for row in rows]
        columns.append(at_points(cells) if head in NUMBER_HEADS and cells else cells)
    for row in zip(*columns, strict=True):
        shown.add_row(*(Text(cell, style=CELL_STYLES.get(cell, "")) for cell in row))
    anything = console.options.update(max_width=10 * sum(map(len, rows[0] if rows else heads)) + 1000)
    fits = console.measure(shown, options=anything).maximum <= console.width
    if fits:
        console.print(shown)
    return fits


def plain_table(heads: Sequence[str], rows: Sequence[Sequence[str]], decimals: Collection[str] = ()) -> str:
    """Return a table as text; columns with heads in `decimals` are aligned at their points, others at the left."""
    # It looks like one of tabulate, which takes half as long to load as a simulation.
    columns = []
    for i, head in enumerate(heads):
        cells = [row[i].strip() for row in rows]
        aligned = head in decimals
        cells = at_points(cells) if aligned else cells
        width = max([len(head) + 2, *map(len, cells)])
        columns.append([cell.rjust(width) if aligned else cell.ljust(width) for cell in (head, *cells)])
        columns[-1].insert(1, "-" * width)
    return "\n".join("  ".join(line).rstrip() for line in zip(*columns, strict=True))


def at_points(cells: Sequence[str]) -> list[str]:
    """Append spaces to numbers so that their decimal points are below each other."""
    behind = [_behind_point(cell) for cell in cells]
    return [cell + " " * (max(behind) - each) for cell, each in zip(cells, behind, strict=True)]


def _behind_point(cell: str) -> int:
    """Return how many characters follow the decimal point of a number; -1 if it has no point."""
    try:
        float(cell)
    except ValueError:
        return -1
    point = cell.rfind(".")
    point = cell.lower().rfind("e") if point < 0 else point
    return len(cell) - point - 1 if point >= 0 else -1


def name_files(*paths: Any) -> None:
    """Print the names of the written files; None stands for no file."""
    for path in paths:
        if path is not None:
            write(f"wrote {click.format_filename(path)}")


def undecidable(trajectory: Trajectory) -> bool:
    """Print an error, and return True, if a trajectory ended because its precision did not suffice."""
    if trajectory.status == "undecidable":
        complain(f"undecidable: {trajectory.message}")
    return trajectory.status == "undecidable"


def count_events(events: Sequence[object]) -> str:
    """Return the number of events with its noun."""
    return f"{len(events)} event{'' if len(events) == 1 else 's'}"
