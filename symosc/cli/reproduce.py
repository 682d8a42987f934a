"""`symosc reproduce`: the paper's claims judged, its figures drawn, and a report on both."""

from __future__ import annotations

from collections import Counter
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symosc.cli.common import FAILED, folder_name, json_option, write, write_json, write_table
from symosc.display.progress import bar
from symosc.files import check_new_folder

if TYPE_CHECKING:
    from symosc.paper.run import Plan, Results


@click.command()
@click.option("-o", "--output", default="reproduced", metavar="DIR", help="Folder for the report; default: reproduced.")
@click.option("--only", metavar="ID", help="Only claims whose id begins so, with their figures, without derivations.")
@json_option
def reproduce(output: str, only: str | None, as_json: bool) -> int:
    """Recompute what the paper states, judge each claim, draw all figures and write a report.

    The folder gets report.html (one file that needs no other), report.md, report.json, a letter to the authors
    (letter.html, letter.txt), figures/ and derivations/. With --only it gets no letter and no derivations. The
    exit code is 1 if a verdict is not the committed one, or a figure or a derivation fails. Everything is written at
    the end; an interrupt leaves the folder as it was.

    \b
    Examples:
      symosc reproduce
      symosc reproduce --only fig8 -o fig8
    """
    folder = Path(folder_name(output))
    from symosc.derive.chapters import CHAPTERS
    from symosc.derive.errata import read_errata
    from symosc.paper.claims import read_claims
    from symosc.paper.pictures import PICTURES
    from symosc.paper.run import Plan

    errata = tuple(erratum.in_unicode() for erratum in read_errata())
    claims, unjudged = read_claims(PICTURES)
    plan = Plan(claims, PICTURES, tuple(CHAPTERS), errata, unjudged)
    return carry_out(plan if only is None else plan.only(only), folder, as_json)


def carry_out(plan: Plan, output: Path, as_json: bool = False, workers: int | None = None) -> int:
    """Do everything in a plan, write and print the report, and return the exit code; `workers` as for `run`."""
    from symosc.paper import report
    from symosc.paper.run import run

    check_new_folder(output)
    parts = count(1)
    with bar("reproducing", len(plan), "parts") as report_part:
        results = run(plan, lambda: report_part(next(parts), len(plan)), workers)
    report.write(output, report.files(results))
    if as_json:
        write_json(report.data(results))
    else:
        _print_summary(results, output)
    return 0 if results.ok else FAILED


def _print_summary(results: Results, output: Path) -> None:
    from symosc.derive.errata import SEVERITIES

    rows = []
    for each in results.judged:
        mark = f"committed: {each.claim.verdict}" if each.changed else ""
        rows.append([each.claim.id, each.claim.source, each.verdict, mark])
    heads = ["claim", "source", "verdict", "changed"]
    if not results.changed:
        rows, heads = [row[:-1] for row in rows], heads[:-1]
    write_table(rows, heads)
    write("")
    for each in results.changed:
        write(f"CHANGED {each.claim.id}: {each.finding}")
    for name, error in results.failures.items():
        write(f"FAILED {name}: {error}")
    counts = ", ".join(f"{count} {verdict}" for verdict, count in results.counts.items() if count)
    steps = sum(done.value[0] for done in results.chapters.values() if done.value)
    drawn = sum(done.value is not None for done in results.drawn.values())
    write(f"{len(results.judged)} claim{'s' if len(results.judged) > 1 else ''}: {counts}")
    errata = Counter(erratum.severity for erratum in results.plan.errata if results.shown_by(erratum))
    severities = ", ".join(f"{errata[severity]} {severity}" for severity in SEVERITIES if errata[severity])
    if errata:
        write(f"{errata.total()} distinct {'errata' if errata.total() > 1 else 'erratum'}: {severities}")
    write(f"{drawn} figure{'s' if drawn != 1 else ''}, {steps} steps of derivations checked; {results.seconds:.0f} s")
    write(f"report: {click.format_filename(output / 'report.html')}")
