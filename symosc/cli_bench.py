"""The command `symosc bench`."""

from __future__ import annotations

import click

from symosc.cli import _print, _print_json, json_option


@click.command()
@click.option("--quick", is_flag=True, help="Fewer repeats.")
@json_option
def bench(quick: bool, as_json: bool) -> None:
    """Measure the time per event on the shipped scenes, and its error.

    \b
    Example:
      symosc bench --quick
    """
    from symosc.bench import speed

    result = speed.run(quick=quick)
    if as_json:
        _print_json(result)
    else:
        _print(speed.table(result))
