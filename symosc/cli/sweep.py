"""`symosc sweep`: motions over a grid of parameters and starts."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from symosc.aliases import Record
from symosc.cli.common import (
    WholeNumber,
    check_picture,
    complain,
    complete,
    goes_to_stdout,
    json_option,
    read_duration,
    scene_argument,
    scene_with,
    set_option,
    split_setting,
    write,
    write_json,
    wrote,
)
from symosc.model import PARAMETER_NAMES
from symosc.scenes import START_NAMES

if TYPE_CHECKING:
    import xarray


def _columns_begun(context: click.Context, option: click.Parameter, begun: str) -> list[CompletionItem]:
    from symosc.simulation.tables import SUMMARY_COLUMNS

    return complete(tuple(SUMMARY_COLUMNS))(context, option, begun)


@click.command()
@scene_argument
@click.option(
    "--over",
    "axes",
    multiple=True,
    metavar="NAME=LO:HI:N",
    shell_complete=complete((*PARAMETER_NAMES, *START_NAMES[:3]), "="),
    help="An axis: a parameter, or t0, x0 or v0. Repeatable.",
)
@set_option
@click.option(
    "--record",
    default="word",
    show_default=True,
    metavar="NAMES",
    shell_complete=_columns_begun,
    help="Columns, such as word,sticks,section:64.",
)
@click.option("--t-end", metavar="T", help="End of all motions; 60T: after 60 periods. Default: the scene's.")
@click.option("--skip", default="0", metavar="T", help="Leave out this time at the start; 40T: 40 periods.")
@click.option(
    "-o", "--output", metavar="FILE", help="Write it, and keep finished chunks beside it meanwhile: .nc, .zarr or .csv."
)
@click.option("--plot", "picture", metavar="FILE", help="Draw it: .pdf, .svg or .png. -: SVG to stdout.")
@click.option("--workers", type=WholeNumber(), metavar="N", help="Threads; with --executor chunks under way at a time.")
@click.option("--executor", metavar="dask:ADDRESS", help="Compute on a dask cluster, such as dask:tcp://host:8786.")
@click.option("--status", is_flag=True, help="Only tell how far it is.")
@click.option("--restart", is_flag=True, help="Use nothing that an earlier run has left.")
@json_option
def sweep(scene: str, axes: tuple[str, ...], settings: tuple[str, ...], picture: str | None, **options: Any) -> None:
    """Follow a motion for each cell of a grid of parameters and starts.

    Prints what was found, and how often. With -o a second run of the same command goes on where the first one was
    stopped, however it was stopped; the result is the same to the last bit.

    \b
    Examples:
      symosc sweep fig9 --over Omega=1:6:60 --over FN=1:20:40 --t-end 60T --skip 50T -o map.nc --plot map.png
      symosc sweep fig9 --over Omega=1:6:500 --record section:32 --t-end 100T --plot bifurcation.png
    """
    from symosc.sweeps.sweep import sweep_status

    output, as_json = options["output"], options["as_json"]
    piped = goes_to_stdout(picture, "--plot", as_json)
    goes_to_stdout(output, "--output")
    problem = scene_with(scene, settings, {})
    names = tuple(options["record"].split(","))
    over: dict[str, str] = {}
    for axis in axes:
        name, values = split_setting(axis, "--over", "NAME=LO:HI:N, such as Omega=1:6:500", over)
        over[name] = values
    times = {name: options[name] and read_duration(name, options[name]) for name in ("t_end", "skip")}
    asked: Record = {"record": names, **times, "path": output}
    if options["status"]:
        if output is None:
            raise click.UsageError("--status tells about the file of -o; name it")
        _show_status(sweep_status(problem, over, **asked)._asdict(), as_json)
        return
    check_picture(picture)
    dataset = _swept(problem, over, asked, options)
    if picture is not None:
        from symosc import plot

        plot.save(plot.swept_figure(dataset), picture)
    if as_json:
        about = {"output": output, "sizes": {str(name): size for name, size in dataset.sizes.items()}}
        about |= {"columns": _columns(dataset), **{str(name): value for name, value in dataset.attrs.items()}}
        write_json(about)
    elif not piped:
        write(_report_text(dataset, [path for path in (output, picture) if path is not None]))


def _swept(problem: Any, over: dict[str, str], asked: Record, options: Record) -> xarray.Dataset:
    """Run the sweep; an interrupt says what is done."""
    from symosc.sweeps.sweep import sweep as sweep_all
    from symosc.sweeps.sweep import sweep_status

    executor = None if options["executor"] is None else _executor(options["executor"])
    more = {"workers": options["workers"], "executor": executor, "resume": not options["restart"], "progress": True}
    try:
        return sweep_all(problem, over, **asked, **more)
    except KeyboardInterrupt:
        if asked["path"] is not None:
            about = sweep_status(problem, over, **asked)
            complain(f"interrupted: {about.done:,} of {about.total:,} motions are kept; the same command goes on")
        raise
    finally:
        if executor is not None:
            executor.close()


def _executor(text: str) -> Any:
    """Return a client of the cluster that is named."""
    kind, _, address = text.partition(":")
    if kind != "dask" or not address:
        raise click.BadParameter(f"{text!r} is not dask:ADDRESS, such as dask:tcp://host:8786", param_hint="--executor")
    from symosc.sweeps.sweep import dask_client

    return dask_client(address)


def _show_status(about: Record, as_json: bool) -> None:
    if as_json:
        write_json(about)
        return
    share = about["done"] / about["total"]
    end = "written" if about["written"] else "not yet written"
    write(f"{about['path']}: {about['done']:,} of {about['total']:,} motions ({share:.1%}), {end}")


def _columns(dataset: xarray.Dataset) -> Record:
    """Return for each column its values and how often they are there, or its smallest and largest number."""
    found: Record = {}
    for name, column in dataset.items():
        if column.dtype.kind in "UO":
            found[str(name)] = dict(Counter(map(str, column.values.ravel().tolist())).most_common())
        else:
            found[str(name)] = {"least": column.values.min().item(), "largest": column.values.max().item()}
    return found


def _report_text(dataset: xarray.Dataset, written: list[str]) -> str:
    total = dataset["status"].size
    sizes = " × ".join(f"{name} ({dataset.sizes[name]})" for name in map(str, dataset["status"].dims))
    lines = [f"{sizes}: {total:,} motions"]
    for name, found in _columns(dataset).items():
        if "least" in found and "largest" in found:
            lines.append(f"{name}: from {found['least']:.6g} to {found['largest']:.6g}")
            continue
        # Values of a column that are printed, the most frequent first.
        shown = [f"{value or 'no event'} {count / total:.1%}" for value, count in list(found.items())[:8]]
        more = len(found) - len(shown)
        lines.append(f"{name}: {', '.join(shown)}{f', and {more} more' if more else ''}")
    return "\n".join([*lines, *map(wrote, written)])
