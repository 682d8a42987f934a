"""`symosc reproduce`: the paper's claims judged, its figures drawn, and a report on both."""

from __future__ import annotations

from collections import Counter
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symosc.base.display.progress import bar
from symosc.base.files import check_new_folder
from symosc.cli import options, output

if TYPE_CHECKING:
    from symosc.paper.run import Plan, Results


@click.command()
@options.option(
    "-o, --output DIR", "Folder for the report; default: reproduced.", "name", default="reproduced"
)
@options.option(
    "--only ID", "Only claims whose id begins so, with their figures, without derivations."
)
@options.json_option
def reproduce(name: str, only: str | None) -> int:
    """Recompute what the paper states, judge each claim, draw all figures and write a report.

    The folder gets report.html (one file that needs no other), report.json, figures/ and
    derivations/. With --only it gets no derivations. The exit code is 1 if a verdict is not the
    committed one, or a figure or a derivation fails. Everything is written at the end; an interrupt
    leaves the folder as it was.

    \b
    Examples:
      symosc reproduce
      symosc reproduce --only fig8 -o fig8
    """
    folder = Path(options.folder_name(name))
    from symosc.derive.chapters import CHAPTERS
    from symosc.derive.errata import read_errata
    from symosc.paper.claims import read_claims
    from symosc.paper.pictures import PICTURES
    from symosc.paper.run import Plan

    errata = tuple(erratum.in_unicode() for erratum in read_errata())
    claims, unjudged = read_claims(PICTURES)
    plan = Plan(claims, PICTURES, tuple(CHAPTERS), errata, unjudged)
    return carry_out(plan if only is None else plan.only(only), folder, output.prints_json())


def carry_out(plan: Plan, folder: Path, as_json: bool = False, workers: int | None = None) -> int:
    """Judge the claims and draw the figures of a plan, write and print the report, and return the
    exit code.
    """
    from symosc.paper import report
    from symosc.paper.run import run

    check_new_folder(folder)
    output.note(f"reproduce {plan.about}")
    parts = count(1)
    with bar("reproducing", len(plan), "parts") as report_part:
        results = run(plan, lambda: report_part(next(parts), len(plan)), workers)
    report.write(folder, report.files(results))
    if as_json:
        output.write_json(report.data(results))
    else:
        _print_summary(results, folder)
    if results.ok:
        return 0
    return output.FAILED


def _print_summary(results: Results, folder: Path) -> None:
    """Print the verdicts as a table, what changed or failed, and the counts of everything."""
    from symosc.derive.errata import SEVERITIES

    heads = ["claim", "source", "verdict"]
    rows = [[judged.claim.id, judged.claim.source, judged.verdict] for judged in results.judged]
    if results.changed:
        heads.append("changed")
        for row, judged in zip(rows, results.judged, strict=True):
            if judged in results.changed:
                row.append(f"committed: {judged.claim.verdict}")
            else:
                row.append("")
    output.write_table(rows, heads)
    counts = ", ".join(f"{count} {verdict}" for verdict, count in results.counts.items() if count)
    checked = [done.value for done in results.chapters.values() if done.value]
    steps = sum(step_count for step_count, _ in checked)
    drawn = sum(done.value is not None for done in results.drawn.values())
    errata = Counter(
        erratum.severity for erratum in results.plan.errata if results.shown_by(erratum)
    )
    severities = ", ".join(
        f"{errata[severity]} {severity}" for severity in SEVERITIES if errata[severity]
    )
    lines = ["", *(f"CHANGED {judged.claim.id}: {judged.finding}" for judged in results.changed)]
    lines += [f"FAILED {name}: {error}" for name, error in results.failures.items()]
    lines.append(f"{len(results.judged)} claim{'s' if len(results.judged) > 1 else ''}: {counts}")
    if errata:
        lines.append(
            f"{errata.total()} distinct {'errata' if errata.total() > 1 else 'erratum'}: "
            f"{severities}"
        )
    figures = f"{drawn} figure{'s' if drawn != 1 else ''}"
    lines.append(f"{figures}, {steps} steps of derivations checked; {results.seconds:.0f} s")
    output.write("\n".join([*lines, f"report: {click.format_filename(folder / 'report.html')}"]))
