"""`symosc attractors`: where many starts lead."""

from __future__ import annotations

import click

import symosc
from symosc.base.aliases import Record
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, option
from symosc.scenes import START_NAMES

AXES: Record = {
    "multiple": True,
    "shell_complete": options.complete(lambda: START_NAMES[:3], "="),
}


@click.command()
@options.scene_argument
@option("--over NAME=LO:HI:N", "An axis of the starts: x0, v0 or t0. Give two.", "axes", **AXES)
@options.set_option
@option("--t-end T", "How long a motion with a drive is followed at most. Default: 1000T.")
@option("--workers N", "Threads. Default: one for each core.")
@options.plot_option
@options.json_option
def attractors(
    scene: str,
    axes: tuple[str, ...],
    settings: Settings,
    t_end: Text,
    workers: Text,
    plot: Text,
) -> None:
    """Find the attractors of a grid of starts: orbits, rests and chaos, with their shares.

    \b
    Examples:
      symosc attractors fig9 --over x0=-2:2:9 --over v0=-2:2:9
      symosc attractors mine.toml --over x0=-2:2:300 --over v0=-2:2:300 --plot basins.png
    """
    problem = options.scene_with(scene, settings)
    over = dict[str, str]()
    for axis in axes:
        name, values = options.split_setting(
            axis, "--over", "NAME=LO:HI:N, such as x0=-2:2:9", over
        )
        over[name] = values
    options.refuse((len(over) != 2, "give --over twice, with two of x0, v0 and t0"))
    given: Record = {"workers": workers}
    if t_end is not None:
        given["t_end"] = options.read_duration("t_end", t_end)
    found = symosc.attractors(problem, over, **given)
    output.draw(plot, found.plot)
    output.report(lambda: _data(found), lambda: _print_attractors(found, plot))


def _data(found: symosc.Attractors) -> Record:
    """Return the answer as plain values."""
    rows = zip(found.names, found.orbits, found.share, found.share_error, strict=True)
    return {
        "attractors": [
            {
                "name": name,
                "about": repr(orbit),
                "share": float(share),
                "share_error": float(error),
            }
            for name, orbit, share, error in rows
        ],
        "undecided": found.undecided,
        "axes": {name: values.tolist() for name, values in found.axes.items()},
        "basin": found.basin.tolist(),
    }


def _print_attractors(found: symosc.Attractors, *files: Text) -> None:
    """Print attractors with their shares, and the files that were written."""
    rows = [
        [name, f"{share:.2%}", f"{error:.2%}", getattr(orbit, "message", repr(orbit))]
        for name, share, error, orbit in zip(
            found.names, found.share, found.share_error, found.orbits, strict=True
        )
    ]
    if found.undecided:
        rows.append(["undecided", f"{found.undecided:.2%}", "", ""])
    output.write_table(rows, ["attractor", "share", "+-", "what it is"])
    output.name_files(*files)
