"""The command `symosc simulate`."""

from __future__ import annotations

import click

import symosc
from symosc.aliases import Record
from symosc.cli.output import FLOAT_FORMAT, counted, json_option, undecidable, write, write_json, write_table
from symosc.cli.settings import WholeNumber, goes_to_stdout, scene_argument, scene_with, set_option
from symosc.exact import read_start_error


@click.command()
@scene_argument
@click.option("--t-end", metavar="T", help="End time in place of the scene's; 10T: after 10 periods.")
@click.option("--t0", metavar="T", help="Start time in place of the scene's.")
@click.option("--x0", metavar="X", help="Start position in place of the scene's.")
@click.option("--v0", metavar="V", help="Start velocity in place of the scene's.")
@click.option("--start-error", metavar="E", help="How far t0, x0, v0 may be off: a number, or three with commas.")
@set_option
@click.option("--max-events", type=WholeNumber(), metavar="N", help="Stop after N events.")
@click.option(
    "--digits", type=WholeNumber(), metavar="N", help="N digits, relative to max(1, |value|); default: doubles."
)
@click.option("--csv", "csv_path", metavar="FILE", help="Write the events, all digits, as CSV as well. -: only that.")
@json_option
def simulate(
    scene: str,
    start_error: str | None,
    settings: tuple[str, ...],
    max_events: int | None,
    digits: int | None,
    csv_path: str | None,
    as_json: bool,
    **start: str | None,
) -> int:
    """Follow a scene and print its events.

    Columns: time, position, velocity and phase (Omega t mod 2 pi) of each event; what it is (cross a belt's speed,
    stick: onset, slip: end of a stick, graze); on which belt; the motion before and after it; estimated errors of t
    and x. A trajectory that this precision cannot decide ends there, with exit code 1.

    A start that is known to so much only says so by --start-error; a contact within its reach is then a graze. Without
    it the start is exact, or known as well as the scene says.

    With --digits the numbers of the motion are strings in JSON: a reader would round numbers to doubles.

    \b
    Examples:
      symosc simulate fig5
      symosc simulate fig8 --set c=3.9 --t-end 20 --digits 30 --csv events.csv
    """
    piped = goes_to_stdout(csv_path, "--csv", as_json)
    problem = scene_with(scene, settings, start)
    known: Record = {}
    if start_error is not None:
        parts = start_error.split(",")
        known["start_error"] = read_start_error(parts if len(parts) > 1 else start_error)
    trajectory = symosc.simulate(problem, max_events=max_events, digits=digits, progress=True, **known)
    if csv_path is not None:
        trajectory.to_csv(csv_path)
    if piped:
        pass
    elif as_json:
        write_json({"scene": problem.name, **trajectory.as_dict()})
    else:
        _print_events(trajectory)
    return int(undecidable(trajectory))


def _print_events(trajectory: symosc.Trajectory) -> None:
    rows = []
    for row in trajectory.table():
        numbers = [_number(row[name]) for name in ("t", "x", "v", "theta")]
        moves = f"{row['source']} -> {row['target']}"
        errors = [f"{row[name]:.0e}" for name in ("t_error", "x_error")]
        rows.append([*numbers, row["kind"], str(row["boundary"]), moves, *errors])
    if rows:
        write_table(rows, ["t", "x", "v", "theta", "kind", "belt", "from -> to", "t error", "x error"])
        write("")
    write(f"word, in order of time: {' '.join(trajectory.word) or 'none'}")
    if trajectory.status != "undecidable":
        write(f"{trajectory.status}: {trajectory.message}; {counted(rows)}")


def _number(value: float | str) -> str:
    return value if isinstance(value, str) else FLOAT_FORMAT.format(value)
