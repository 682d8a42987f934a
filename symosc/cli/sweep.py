"""`symosc sweep`: motions over a grid of parameters and starts."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import click

import symosc
from symosc.base.aliases import Record
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, flag, option
from symosc.model import PARAMETER_NAMES
from symosc.scenes import START_NAMES

if TYPE_CHECKING:
    import xarray


def _columns() -> list[str]:
    """Return the names of the columns that a sweep can record."""
    from symosc.simulation.tables import SUMMARY_COLUMNS

    return list(SUMMARY_COLUMNS)


#: How many different values of a column are printed with their shares.
MOST_VALUES = 8
AXES: Record = {
    "multiple": True,
    "shell_complete": options.complete(
        lambda: (*PARAMETER_NAMES, "mu_s1", "mu_s2", *START_NAMES[:3]), "="
    ),
}
COLUMNS: Record = {
    "default": "word",
    "show_default": True,
    "shell_complete": options.complete(_columns),
}


@click.command()
@options.scene_argument
@option(
    "--over NAME=LO:HI:N",
    "An axis: a parameter, mu_s1, mu_s2, t0, x0 or v0. Repeatable.",
    "axes",
    **AXES,
)
@options.set_option
@option("--record NAMES", "Columns, such as word,sticks,section:64.", **COLUMNS)
@option("--t-end T", "End of all motions; 60T: after 60 periods. Default: the scene's.")
@option("--skip T", "Leave out this time at the start; 40T: 40 periods.", default="0")
@option(
    "-o, --output FILE",
    "Write it, and keep finished chunks beside it meanwhile: .nc, .zarr or .csv.",
    "path",
)
@options.plot_option
@option("--workers N", "Threads; with --executor chunks under way at a time.")
@option("--executor dask:ADDRESS", "Compute on a dask cluster, such as dask:tcp://host:8786.")
@flag("--status", "Only tell how far it is.")
@flag("--restart", "Use nothing that an earlier run has left.")
@options.json_option
def sweep(
    scene: str,
    axes: tuple[str, ...],
    settings: Settings,
    record: str,
    path: Text,
    plot: Text,
    status: bool,
    **run_options: Any,
) -> None:
    """Follow a motion for each cell of a grid of parameters and starts.

    Prints what was found, and how often. With -o a second run of the same command goes on where the
    first one was stopped, however it was stopped; the result is the same to the last bit.

    \b
    Examples:
      symosc sweep fig9 --over Omega=1:6:60 --over FN=1:20:40 --t-end 60T -o map.nc --plot map.png
      symosc sweep fig9 --over Omega=1:6:500 --record section:32 --t-end 100T --plot bifurcation.png
    """
    problem = options.scene_with(scene, settings)
    over = dict[str, str]()
    for axis in axes:
        name, values = options.split_setting(
            axis, "--over", "NAME=LO:HI:N, such as Omega=1:6:500", over
        )
        over[name] = values
    options.refuse((not over, "give --over NAME=LO:HI:N, such as Omega=1:6:500"))
    time_texts = {name: run_options.pop(name) for name in ("t_end", "skip")}
    times = {name: options.read_duration(name, text) for name, text in time_texts.items() if text}
    request: Record = {"record": tuple(record.split(",")), **times, "path": path}
    if status:
        options.refuse((path is None, "--status tells about the file of -o; name it"))
        progress = symosc.sweep_status(problem, over, **request)
        share = progress.done / progress.total
        if progress.written:
            end = "written"
        else:
            end = "not yet written"
        line = (
            f"{progress.path}: {progress.done:,} of {progress.total:,} motions ({share:.1%}), {end}"
        )
        output.report(progress._asdict, lambda: output.write(line))
        return
    dataset = _swept(problem, over, request, **run_options)
    output.draw(plot, lambda: dataset.symosc.plot())
    sizes = {str(name): size for name, size in dataset.sizes.items()}
    summaries = {str(name): _summary(column) for name, column in dataset.items()}
    data: Record = {"output": path, "sizes": sizes, "columns": summaries}
    data |= {str(name): value for name, value in dataset.attrs.items()}
    output.report(lambda: data, lambda: _print_dataset(dataset["status"], summaries, path, plot))


def _swept(
    problem: Any, over: dict[str, str], request: Record, workers: Any, executor: Any, restart: bool
) -> Any:
    """Return the results of a sweep over the axes `over`.

    An interrupt prints how many motions are kept.
    """
    if executor is not None:
        from symosc.sweeps.sweep import dask_client

        kind, _, address = executor.partition(":")
        if kind != "dask" or not address:
            reason = f"{executor!r} is not dask:ADDRESS, such as dask:tcp://host:8786"
            raise click.BadParameter(reason, param_hint="--executor")
        executor = dask_client(address)
    try:
        run_options: Record = {
            "workers": workers,
            "executor": executor,
            "resume": not restart,
            "progress": True,
        }
        return symosc.sweep(problem, over, **request, **run_options)
    except KeyboardInterrupt:
        if request["path"] is not None:
            progress = symosc.sweep_status(problem, over, **request)
            kept = f"{progress.done:,} of {progress.total:,} motions are kept"
            output.complain(f"interrupted: {kept}; the same command goes on")
        raise
    finally:
        if executor is not None:
            executor.close()


def _summary(column: xarray.DataArray) -> Record:
    """Return the different texts of a column with their counts, or its smallest and largest number."""
    if column.dtype.kind in "UO":
        return dict(Counter(map(str, column.values.ravel().tolist())).most_common())
    return {"least": column.values.min().item(), "largest": column.values.max().item()}


def _print_dataset(status: xarray.DataArray, columns: Record, *files: Text) -> None:
    """Print the size of a sweep, a summary of each column, and the names of written files."""
    sizes = " × ".join(f"{name} ({size})" for name, size in status.sizes.items())
    output.write(f"{sizes}: {status.size:,} motions")
    for name, summary in columns.items():
        if "least" in summary and "largest" in summary:
            output.write(f"{name}: from {summary['least']:.6g} to {summary['largest']:.6g}")
            continue
        shares = [
            f"{value or 'no event'} {count / status.size:.1%}"
            for value, count in list(summary.items())[:MOST_VALUES]
        ]
        more = len(summary) - len(shares)
        if more:
            shares.append(f"and {more} more")
        output.write(f"{name}: {', '.join(shares)}")
    output.name_files(*files)
