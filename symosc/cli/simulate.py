"""`symosc simulate`, `figure` and `explore`: one motion as a table, a figure and an interactive page."""

from __future__ import annotations

import webbrowser
from threading import Thread
from typing import Any

import click

import symosc
from symosc.aliases import Record
from symosc.cli.common import (
    FLOAT_FORMAT,
    WholeNumber,
    check_picture,
    complete_scene,
    count_events,
    goes_to_stdout,
    json_option,
    read_duration,
    read_error,
    reduced_scene,
    scene_argument,
    scene_with,
    set_option,
    start_error_option,
    undecidable,
    write,
    write_json,
    write_table,
)
from symosc.engine.events import EVENT_COLUMNS
from symosc.words import collapsed


@click.command()
@scene_argument
@click.option("--t-end", metavar="T", help="End time in place of the scene's; 10T: after 10 periods.")
@click.option("--t0", metavar="T", help="Start time in place of the scene's.")
@click.option("--x0", metavar="X", help="Start position in place of the scene's.")
@click.option("--v0", metavar="V", help="Start velocity in place of the scene's.")
@start_error_option
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

    Columns: time, position, velocity and phase (Omega t mod 2 pi) of each event; its kind (cross a belt's speed, stick:
    onset, slip: end of a stick, graze); its belt; the modes before and after it; estimated errors of t and x. A motion
    that this precision cannot decide ends there, with exit code 1.

    --start-error says how far a measured start may be off; a contact within its reach is then a graze. Without it the
    start is exact, or known as well as the scene says.

    With --digits the numbers of the motion are strings in JSON: a reader would round numbers to doubles.

    \b
    Examples:
      symosc simulate fig5
      symosc simulate fig8 --set c=3.9 --t-end 20 --digits 30 --csv events.csv
    """
    piped = goes_to_stdout(csv_path, "--csv", as_json)
    problem = scene_with(scene, settings, start)
    known: Record = {} if start_error is None else {"start_error": read_error(start_error)}
    trajectory = symosc.simulate(problem, max_events=max_events, digits=digits, progress=True, **known)
    if csv_path is not None:
        trajectory.to_csv(csv_path)
    if as_json:
        write_json({"scene": problem.name, **trajectory.as_dict()})
    elif not piped:
        _print_events(trajectory)
    return int(undecidable(trajectory))


def _print_events(trajectory: symosc.Trajectory) -> None:
    heads = {"boundary": "belt", "source": "from -> to"}
    rows = [[_cell(name, row) for name in row if name != "target"] for row in trajectory.table()]
    if rows:
        names = [name for name in EVENT_COLUMNS if name != "target"]
        write_table(rows, [heads.get(name, name.replace("_", " ")) for name in names])
        write("")
    write(f"word, in order of time: {collapsed(trajectory.word) or 'none'}")
    if trajectory.status != "undecidable":
        write(f"{trajectory.status}: {trajectory.message}; {count_events(rows)}")


def _cell(name: str, row: Record) -> str:
    """Return the text of a field of an event; source and target are one."""
    value = row[name]
    if name == "source":
        return f"{value} -> {row['target']}"
    if isinstance(value, float):
        return f"{value:.0e}" if name.endswith("_error") else FLOAT_FORMAT.format(value)
    return str(value)


@click.command()
@scene_argument
@click.option("-o", "--output", required=True, metavar="FILE", help="The file: .pdf, .svg or .png. -: SVG to stdout.")
@click.option(
    "--t-end",
    metavar="T",
    help="End of the time axis; 10T: 10 periods. Default: what the paper shows, else the scene's.",
)
@set_option
@click.option(
    "--panels",
    metavar="LETTERS",
    help="a x(t), b v(t), c phase plane, forces: d (t), e (x), f (v), g their product (t).",
)
@click.option("--boundary", type=WholeNumber(1, 2), help="Forces at belt 1 or 2. Default: of the first event.")
@click.option("--columns", type=WholeNumber(1, 2), default=2, help="2: as wide as a page. 1: as a column of it.")
def figure(
    scene: str, output: str, settings: tuple[str, ...], t_end: str | None, panels: str | None, **options: Any
) -> int:
    """Draw a scene in panels like those of the paper's figures 5 to 10.

    \b
    Examples:
      symosc figure fig5 -o fig5.pdf
      symosc figure fig8 -o phase.svg --panels c --t-end 22
      symosc figure fig10 -o product.pdf --panels bdg --boundary 2
    """
    piped = goes_to_stdout(output, "--output")
    problem = scene_with(scene, settings, {})
    end = None if t_end is None else read_duration("t_end", t_end)
    check_picture(output)
    from symosc import plot

    panels = plot.default_panels(problem) if panels is None else panels
    plot.check_panels(panels)
    trajectory = plot.simulated(problem, end)
    plot.save(plot.figure(trajectory, panels=panels, **options), output)
    if not piped:
        span = f"t = {float(trajectory.t_start):.6g} to {float(trajectory.t_end):.6g}"
        write(f"{click.format_filename(output)}: {span}, {count_events(trajectory.events)}")
    return int(undecidable(trajectory))


@click.command()
@click.argument("scene", default="fig5", shell_complete=complete_scene)
@set_option
@click.option(
    "--port", type=WholeNumber(0, 65_535), metavar="N", help="The port of the page; 0: any free one. Default: 8519."
)
@click.option("--no-browser", is_flag=True, help="Only print the page's address.")
def explore(scene: str, settings: tuple[str, ...], port: int | None, no_browser: bool) -> None:
    """Open a page in the browser with a slider for each number; it shows the motion as you move them.

    The page shows the phase plane, position, velocity and forces, the events and the grazing windows. Its link has all
    its numbers, and it saves and opens scene files. It is on this machine only. Ctrl-C ends it.

    \b
    Examples:
      symosc explore
      symosc explore fig9 --set Omega=3.5
    """
    problem = reduced_scene(scene_with(scene, settings, {}))
    from symosc.plot.explorer.server import PORT, ExplorerServer

    with ExplorerServer(problem, PORT if port is None else port) as server:
        write(f"{server.address} (Ctrl-C ends it)")
        if not no_browser:  # in a thread: some browsers come back only when they are closed
            Thread(target=webbrowser.open, args=[server.address], daemon=True).start()
        server.serve_forever()
