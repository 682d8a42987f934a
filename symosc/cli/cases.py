"""The command `symosc cases`."""

from __future__ import annotations

from itertools import count

import click

from symosc.cli.output import json_option, write, write_json, write_table
from symosc.cli.settings import folder_name
from symosc.display.progress import bar


@click.command()
@click.option("-o", "--output", metavar="DIR", help="Write the cases into this folder: all files or none.")
@click.option("--group", metavar="NAME", help="Only the cases of one group, such as 'exact graze'.")
@json_option
def cases(output: str | None, group: str | None, as_json: bool) -> int:
    """List reference cases: motions whose events are known for certain, mostly with a proof.

    With -o they are written as files that any language reads: exact parameters, events between 40-digit decimals,
    samples, certificates, checksums, and a README that says what the problem and the formats are. That takes half a
    minute. Running it again gives the same bytes. `symosc score` judges what a solver makes of them.

    \b
    Examples:
      symosc cases
      symosc cases --group "exact graze" --json
      symosc cases -o cases
    """
    from symosc.reference.folder import write_cases
    from symosc.reference.sets import chosen

    wanted = chosen(group)
    if output is not None:
        folder = folder_name(output)
        written = count(1)
        with bar("cases", len(wanted), "cases") as report:
            path = write_cases(folder, wanted, progress=lambda _: report(next(written), len(wanted)))
        if as_json:
            write_json({"folder": str(path), "cases": [case.name for case in wanted]})
        else:
            write(f"wrote {len(wanted)} cases into {click.format_filename(path)}")
        return 0
    rows = [
        {"name": case.name, "group": case.group, "events": case.count, "status": case.status, "hard": case.hard}
        for case in wanted
    ]
    if as_json:
        write_json({"cases": rows})
        return 0
    write_table([[str(row[name]) for name in rows[0]][:-1] for row in rows], [*rows[0]][:-1])
    proven = sum(case.proven for case in wanted)
    write(f"\n{len(wanted)} cases, {proven} of them proven")
    return 0
