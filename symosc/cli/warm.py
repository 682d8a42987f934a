"""The command `symosc warm`."""

from __future__ import annotations

import click

from symosc.cli.output import json_option, write_json, write_table


@click.command()
@json_option
def warm(as_json: bool) -> None:
    """Compile ahead what simulate_many needs, so that no later program waits for a compiler.

    Needs numba (extra fast), and takes a minute. What is compiled is kept on disk; it is made anew when symosc or numba
    changes. Without this command it is compiled when there is enough work for it, and smaller work is interpreted.

    \b
    Examples:
      symosc warm
    """
    from symosc.simulation.batch import warm as compile_all

    rows = compile_all()
    if as_json:
        write_json([row._asdict() for row in rows])
        return
    table = [[row.what, "loaded" if row.was_there else "compiled", f"{row.seconds:.1f}"] for row in rows]
    write_table(table, ["what", "how", "seconds"])
