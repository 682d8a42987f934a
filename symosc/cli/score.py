"""The command `symosc score`."""

from __future__ import annotations

from pathlib import Path

import click

from symosc.cli.output import json_option, write, write_json
from symosc.cli.settings import goes_to_stdout

PAGE_SUFFIXES = (".md", ".html")
TITLE = "Scores on the reference cases"


@click.command()
@click.argument("folder", metavar="DIR")
@click.argument("results", metavar="THEIRS", nargs=-1, required=True)
@click.option("--tolerance", metavar="E", help="Allowed error, relative to max(1, t - t0), max(1, |x|); default 1e-9.")
@click.option("-o", "--output", metavar="FILE", help="Write a page: .md or .html.")
@click.option("--plot", "picture", metavar="FIGURE", help="Draw all errors: .pdf, .svg or .png. -: SVG to stdout.")
@json_option
def score(
    folder: str,
    results: tuple[str, ...],
    tolerance: str | None,
    output: str | None,
    picture: str | None,
    as_json: bool,
) -> int:
    """Judge the events that solvers have found in the reference cases.

    DIR is what `symosc cases -o DIR` has written. THEIRS is a folder with a file per case, or one file for all, of any
    kind that `symosc check` reads; DIR/README.md says what is in them. Cases may be missing. Several THEIRS stand side
    by side.

    For each case and group: events missed, invented or of a wrong kind, and the largest error in units of what rounding
    the case's numbers to doubles does (condition * 1e-16). A case is right if it is followed to its end, all events are
    there with time and position, no others, and each error is at most the tolerance, or 100 units if that is more.

    Exit codes: 0 all results that are there are right, 1 they are not, 2 bad input.

    \b
    Examples:
      symosc score cases mine.csv
      symosc score cases mine theirs -o scores.html --plot scores.svg
      symosc score cases mine.json --tolerance 1e-6 --json
    """
    piped = goes_to_stdout(picture, "--plot", as_json)
    from symosc.files import write_text
    from symosc.reference.compare import SCORE_TOLERANCE
    from symosc.reference.results import read_results
    from symosc.reference.score import read_tolerance
    from symosc.reference.score import score as judged
    from symosc.reference.score_table import as_html, as_markdown, as_text
    from symosc.reference.stored import read_set

    form = "" if output is None else Path(output).suffix.lower()
    if output is not None and form not in PAGE_SUFFIXES:  # before the work
        raise click.BadParameter(f"{output!r} must end in {' or '.join(PAGE_SUFFIXES)}", param_hint="--output")
    if picture is not None:
        from symosc import plot

        plot.check_suffix(picture)
    limit = SCORE_TOLERANCE if tolerance is None else read_tolerance(tolerance)
    version, cases = read_set(folder)
    names = {case.name for case in cases}
    short = [Path(each).stem or each for each in results]
    titles = [name if short.count(name) == 1 else each for name, each in zip(short, results, strict=True)]
    scores = [
        judged(title, cases, read_results(each, names), limit) for title, each in zip(titles, results, strict=True)
    ]
    if output is not None:
        write_text(output, (as_html if form == ".html" else as_markdown)(scores, TITLE, version))
    if picture is not None:
        plot.save(plot.score_figure(scores), picture)
    if as_json:
        write_json({"set_version": version, "scores": [each.as_dict() for each in scores]})
    elif not piped:
        write(as_text(scores))
    return int(not all(each.ok for each in scores))
