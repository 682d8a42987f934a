"""`symosc simulate`, `figure` and `explore`: one motion as a table, a figure and an interactive
page.
"""

from __future__ import annotations

import webbrowser
from threading import Thread
from typing import Any

import click

import symosc
from symosc.base.aliases import Record
from symosc.base.files import STDOUT
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, WholeNumber, flag, option
from symosc.engine.events import EVENT_COLUMNS
from symosc.words import collapsed


@click.command()
@options.scene_argument
@option("--t-end T", "End time in place of the scene's; 10T: after 10 periods.")
@option("--t0 T", "Start time in place of the scene's.")
@option("--x0 X", "Start position in place of the scene's.")
@option("--v0 V", "Start velocity in place of the scene's.")
@options.start_error_option
@options.set_option
@option("--max-events N", "Stop after N events.")
@option("--digits N", "N digits, relative to max(1, |value|); default: doubles.")
@option("--csv FILE", "Write the events, all digits, as CSV as well. -: only that.")
@option(
    "--samples N",
    "Write t, x, v and mode at N evenly spaced times; needs --output.",
    type=WholeNumber(2, 10**8),
)
@option("-o, --output FILE", "The CSV file of the samples. -: only that.", "path")
@options.json_option
def simulate(
    scene: str,
    settings: Settings,
    csv: Text,
    samples: int | None,
    path: Text,
    **run_options: Any,
) -> int:
    """Follow a scene and print its events.

    Columns: time, position, velocity and phase (Omega t mod 2 pi) of each event; its kind (cross a
    belt's speed, stick: onset, slip: end of a stick, graze); its belt; the modes before and after
    it; estimated errors of t and x. A motion that this precision cannot decide ends there, with
    exit code 1.

    --start-error says how far a measured start may be off; a contact within its reach is then a
    graze. Without it the start is exact, or known as well as the scene says.

    With --digits the numbers of the motion are strings in JSON: a reader would round numbers to
    doubles.

    \b
    Examples:
      symosc simulate fig5
      symosc simulate fig8 --set c=3.9 --t-end 20 --digits 30 --csv events.csv
      symosc simulate fig5 --samples 500 -o motion.csv
    """
    options.refuse(
        (samples is None and path is not None, "--output needs --samples N; --csv has the events"),
        (samples is not None and path is None, "--samples needs --output FILE"),
    )
    start = {name: run_options.pop(name) for name in ("t_end", "t0", "x0", "v0")}
    problem = options.scene_with(scene, settings, **start)
    trajectory = symosc.simulate(problem, progress=True, **run_options)
    if csv is not None:
        trajectory.to_csv(csv)
    if samples is not None and path is not None:
        trajectory.samples(samples).to_csv(path)
    output.report(
        lambda: {"scene": problem.name, **trajectory.as_dict()}, lambda: _print_events(trajectory)
    )
    return int(output.undecidable(trajectory))


def _print_events(trajectory: symosc.Trajectory) -> None:
    """Print the table of a motion's events, its word and how it ended."""
    heads = {"boundary": "belt", "source": "from -> to"}
    names = [name for name in EVENT_COLUMNS if name != "target"]
    rows = [[_cell(name, row) for name in names] for row in trajectory.table()]
    if rows:
        output.write_table(rows, [heads.get(name, name.replace("_", " ")) for name in names])
        output.write("")
    output.write(f"word, in order of time: {collapsed(trajectory.word) or 'none'}")
    if trajectory.status != "undecidable":
        output.write(f"{trajectory.status}: {trajectory.message}; {output.count_events(rows)}")


def _cell(name: str, row: Record) -> str:
    """Return the text of an event in the column `name` of the table; in "source" it is both modes,
    as A -> B.
    """
    value = row[name]
    if name == "source":
        return f"{value} -> {row['target']}"
    if isinstance(value, float):
        if name.endswith("_error"):
            return f"{value:.0e}"
        return output.FLOAT_FORMAT.format(value)
    return str(value)


@click.command()
@options.scene_argument
@option(
    "-o, --output FIGURE", "The file: .pdf, .svg or .png. -: SVG to stdout.", "path", required=True
)
@option(
    "--t-end T",
    "End of the time axis; 10T: 10 periods. Default: what the paper shows, else the scene's.",
)
@options.set_option
@option(
    "--panels LETTERS",
    "a x(t), b v(t), c phase plane, forces: d (t), e (x), f (v), g their product (t).",
)
@option("--boundary", "Forces at belt 1 or 2. Default: of the first event.", type=WholeNumber(1, 2))
@option(
    "--columns", "2: as wide as a page. 1: as a column of it.", type=WholeNumber(1, 2), default=2
)
def figure(
    scene: str, path: str, settings: Settings, t_end: Text, panels: Text, **figure_options: Any
) -> int:
    """Draw a scene in panels like those of the paper's figures 5 to 10.

    \b
    Examples:
      symosc figure fig5 -o fig5.pdf
      symosc figure fig8 -o phase.svg --panels c --t-end 22
      symosc figure fig10 -o product.pdf --panels bdg --boundary 2
    """
    from symosc.plot import figures

    problem = options.scene_with(scene, settings)
    trajectory = figures.simulated(
        problem, None if t_end is None else options.read_duration("t_end", t_end)
    )
    if panels is None:
        panels = figures.default_panels(problem)
    symosc.plot.save(figures.figure(trajectory, panels=panels, **figure_options), path)
    span = f"t = {float(trajectory.t_start):.6g} to {float(trajectory.t_end):.6g}"
    if path != STDOUT:
        output.write(
            f"{click.format_filename(path)}: {span}, {output.count_events(trajectory.events)}"
        )
    return int(output.undecidable(trajectory))


@click.command()
@click.argument("scene", default="fig5", shell_complete=options.complete_scene)
@options.set_option
@option(
    "--port N", "The port of the page; 0: any free one. Default: 8519.", type=WholeNumber(0, 65_535)
)
@flag("--no-browser", "Only print the page's address.")
def explore(scene: str, settings: Settings, port: int | None, no_browser: bool) -> None:
    """Open a page in the browser with a slider for each number.

    It shows the motion as you move them.

    The page shows the phase plane, position, velocity and forces, the events and the grazing
    windows. Its link has all its numbers, and it saves and opens scene files. It is on this machine
    only. Ctrl-C ends it.

    \b
    Examples:
      symosc explore
      symosc explore fig9 --set Omega=3.5
    """
    problem = options.reduced_scene(options.scene_with(scene, settings), any_law=True)
    from symosc.plot.explorer.answers import notes_of, state_of
    from symosc.plot.explorer.server import PORT, ExplorerServer

    state_of(problem)  # a law that the page cannot show is refused before it is opened
    for text in notes_of(problem)[len(problem.notes) :]:
        output.note(text)
    with ExplorerServer(problem, PORT if port is None else port) as server:
        output.write(f"{server.address} (Ctrl-C ends it)")
        if not no_browser:  # in a thread: some browsers come back only when they are closed
            Thread(target=webbrowser.open, args=[server.address], daemon=True).start()
        server.serve_forever()
