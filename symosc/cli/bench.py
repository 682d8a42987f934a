"""`symosc bench` and `symosc warm`: measure speed and error, and compile the loops ahead."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

import symosc
from symosc.base.aliases import Record
from symosc.base.display.progress import bar
from symosc.base.errors import MissingExtraError
from symosc.cli import options, output
from symosc.cli.options import Text, flag, option


@click.command()
@flag("--quick", "Fewer scenes, tolerances, cases and repeats: half a minute.")
@flag("--hard", "The hard cases in place of speed, work and precision.")
@options.json_option
@option(
    "-o, --output FIGURE",
    "Draw error against time per event: .pdf, .svg or .png. -: SVG to stdout.",
    "picture",
)
@option("--results README", "Run everything, and write it between the README's marks.", "readme")
@option("--scores FILE", "Score all solvers on the reference cases: a Markdown page.")
def bench(quick: bool, hard: bool, picture: Text, readme: Text, scores: Text) -> int:
    """Measure the speed and the error of symosc and of other solvers.

    Prints the time per event of symosc, and time and error of other solvers, on the shipped scenes;
    times are given as multiples of symosc's and of one closed-form evaluation. Solvers that are not
    installed are skipped, and named (extra bench); one that hangs or fails is shown as such. With
    --hard all solvers get the hard ones of the reference cases, and -o draws their errors. The exit
    code is 1 if symosc itself misses or invents an event, or has an error above 1e-12 (in
    ill-conditioned cases above 100 * condition * 1e-16).

    --scores lets all solvers follow all reference cases (`symosc cases`), which takes some minutes,
    and writes what `symosc score` says of them, with a picture beside it.

    --results writes into a README that has the lines '<!-- results: begin -->' and '<!-- results:
    end -->'. Pictures and full tables go to docs/results beside it.

    \b
    Examples:
      symosc bench --quick
      symosc bench -o work.svg --json > bench.json
      symosc bench --hard
      symosc bench --results README.md
      symosc bench --scores docs/results/scores.md
    """
    from symosc.bench import results

    if scores is not None:
        writes_more = picture is not None or readme is not None
        is_alone = not (quick or hard or output.prints_json() or writes_more)
        options.refuse((not is_alone, "--scores is a run of its own: leave out the other options"))
        return _score(scores)
    if readme is None:
        result = _measured(quick, hard)
        written = _drawn(result, picture)
    else:
        message = "--results runs everything and draws its own pictures: leave out --hard and -o"
        options.refuse((hard or picture is not None, message))
        results.check(readme)
        result = _measured(quick, hard=False) | {"scores": _scored()}
        written = results.write(readme, result)

    def show() -> None:
        if readme is None:
            output.write(_tables(result))
        output.name_files(*written)

    judged_parts = result.keys() & {"hard", "scores"}
    output.report(lambda: _plain(result), show)
    if all(result[part]["ok"] for part in judged_parts):
        return 0
    return output.FAILED


def _measured(quick: bool, hard: bool) -> Record:
    """Return the results of the hard cases or, unless `hard`, of speed, work and precision."""
    from symosc.bench import cases, speed, work

    result: Record = {"quick": quick}
    if hard:
        result["hard"] = cases.run(partial(_bar, "hard cases"), cases=cases.hard_ones(quick))
        return result
    if find_spec("numba") is None:
        raise MissingExtraError("symosc bench", "bench")
    result["speed"] = speed.run(quick=quick, progress=partial(_bar, "calls"))
    result["work_precision"] = work.run(quick=quick, progress=partial(_bar, "solvers"))
    return result


def _scored() -> Record:
    """Return the scores of all solvers on all reference cases."""
    from symosc.bench import cases

    return cases.run(partial(_bar, "reference cases"))


def _drawn(result: Record, picture: Text) -> list[Path]:
    """Draw a result of `_measured` into the file `picture`, if one is named; return its path."""
    from symosc.bench import work

    if picture is None:
        return []
    if "hard" in result:
        drawing = symosc.plot.score_figure(result["hard"]["scores"])
    else:
        drawing = work.figure(result["work_precision"])
    return [symosc.plot.save(drawing, picture)]


def _tables(result: Record) -> str:
    """Return a result of `_measured` as text."""
    from symosc.bench import cases, speed, work

    if "hard" in result:
        return cases.table(result["hard"])
    return f"{speed.table(result['speed'])}\n\n{work.table(result['work_precision'])}"


def _plain(result: Record) -> Record:
    """Return a result with its scores as plain data, as JSON needs them."""
    from symosc.bench import cases

    scored = result.keys() & {"hard", "scores"}
    return result | {key: cases.as_json(result[key]) for key in scored}


def _score(page: str) -> int:
    """Score all solvers and write the Markdown file `page`; return exit code 0."""
    from symosc.base.files import check_folder_of
    from symosc.bench import cases

    if not page.endswith(".md"):
        raise click.BadParameter(f"{page!r} must end in .md", param_hint="--scores")
    check_folder_of(page)  # before the work
    command = f"symosc bench --scores {Path(page).as_posix()}"
    output.name_files(*cases.write(page, _scored(), command))
    return 0


def _bar(label: str, steps: Sequence[Any]) -> Iterator[Any]:
    """Yield the steps one by one, and show a progress bar on stderr if that is a terminal."""
    with bar(label, len(steps)) as report:
        for done, step in enumerate(steps, 1):
            yield step
            report(done, len(steps))


@click.command()
@options.json_option
def warm() -> None:
    """Compile ahead what simulate_many needs, so that no later program waits for a compiler.

    Needs numba (extra fast), and takes a minute. What is compiled is kept on disk; it is made anew
    when symosc or numba changes. Without this command it is compiled when there is enough work for
    it, and smaller work is interpreted.

    \b
    Examples:
      symosc warm
    """
    from symosc.simulation.batch import warm as compile_all

    rows = compile_all()
    table = [
        [row.what, "loaded" if row.was_there else "compiled", f"{row.seconds:.1f}"] for row in rows
    ]
    heads = ["what", "how", "seconds"]
    output.report(lambda: [row._asdict() for row in rows], lambda: output.write_table(table, heads))
