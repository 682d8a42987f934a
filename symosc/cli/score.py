"""The command `symosc score`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from symosc.cli.output import json_option, write, write_json
from symosc.cli.settings import goes_to_stdout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symosc.reference.score import Score

PAGE_SUFFIXES = (".md", ".html")
TITLE = "Scores on the reference cases"


@click.command()
@click.argument("folder", metavar="DIR")
@click.argument("results", metavar="THEIRS", nargs=-1, required=True)
@click.option("--tolerance", metavar="E", help="Allowed error, relative to max(1, |value|); default 1e-9.")
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

    DIR is what `symosc cases -o DIR` has written. THEIRS is a folder with a CSV or JSON file per case, or one file for
    all; DIR/README.md says what is in them. Cases may be missing. Several THEIRS stand side by side.

    For each case and group: events missed, invented or of a wrong kind, and the largest error in units of what rounding
    the case's numbers to doubles does (condition * 1e-16). A case is right if all events are there, no others, and each
    error is at most the tolerance, or 100 units if that is more.

    Exit codes: 0 all results that are there are right, 1 they are not, 2 bad input.

    \b
    Examples:
      symosc score cases mine.csv
      symosc score cases mine theirs -o scores.html --plot scores.svg
      symosc score cases mine.json --tolerance 1e-6 --json
    """
    piped = goes_to_stdout(picture, "--plot", as_json)
    from symosc.reference.compare import SCORE_TOLERANCE
    from symosc.reference.results import read_results
    from symosc.reference.score import read_tolerance
    from symosc.reference.score import score as judged
    from symosc.reference.score_table import as_text
    from symosc.reference.stored import read_set

    _check_outputs(output, picture)
    limit = SCORE_TOLERANCE if tolerance is None else read_tolerance(tolerance)
    version, cases = read_set(folder)
    names = {case.name for case in cases}
    titles = _titles(results)
    scores = [
        judged(title, cases, read_results(each, names), limit) for title, each in zip(titles, results, strict=True)
    ]
    _write_files(scores, version, output, picture)
    if as_json:
        write_json({"set_version": version, "scores": [each.as_dict() for each in scores]})
    elif not piped:
        write(as_text(scores))
    return int(not all(each.ok for each in scores))


def _check_outputs(output: str | None, picture: str | None) -> None:
    """Refuse names of files that cannot be, before the work."""
    if output is not None and Path(output).suffix.lower() not in PAGE_SUFFIXES:
        raise click.BadParameter(f"{output!r} must end in {' or '.join(PAGE_SUFFIXES)}", param_hint="--output")
    if picture is not None:
        from symosc import plot

        plot.check_suffix(picture)


def _titles(results: Sequence[str]) -> list[str]:
    """Return short names of results: the last part of each path, or all of it where two are alike."""
    short = [Path(each).stem or each for each in results]
    return [name if short.count(name) == 1 else each for name, each in zip(short, results, strict=True)]


def _write_files(scores: Sequence[Score], version: int, output: str | None, picture: str | None) -> None:
    from symosc.files import write_text
    from symosc.reference.score_table import as_html, as_markdown

    if output is not None:
        page = as_html if Path(output).suffix.lower() == ".html" else as_markdown
        write_text(output, page(scores, TITLE, version))
    if picture is not None:
        from symosc import plot

        plot.save(plot.score_figure(scores), picture)
